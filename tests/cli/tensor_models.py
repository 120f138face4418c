"""tensor_models.py: two bodies whose tensor is known: turned.hdf, slits across the diagonal of x and y; mirrored.hdf, a
cubic array of spheres. And zigzag.npy, labels: a slit that rises along x by a third of the body and is at another place where
the image begins again. tube.hdf: a tube along z beside a bubble, shut along x and y."""
import math

import h5py
import numpy as np

H = 10e-6


def write(path, distance):
    with h5py.File(path, "w") as file:
        file["model/solid"] = (distance <= 0).astype("u1")
        file["model"].attrs["spacing"] = [H, H, H]
        file["model/wall_distance"] = distance.astype("f4")


n = 16
z, y, x = np.meshgrid(np.arange(4), np.arange(n), np.arange(n), indexing="ij")
period = n * H / math.sqrt(2)  # across the plates
across = ((x + y + 0.3) * H / math.sqrt(2)) % period  # from the middle of a plate
write("turned.hdf", np.where(across < period / 2, across, period - across) - period / 4)

m = 32
z, y, x = (c - (m - 1) / 2 for c in np.meshgrid(*3 * [np.arange(m)], indexing="ij"))
write("mirrored.hdf", (np.sqrt(x * x + y * y + z * z) - 0.4 * m) * H)

n = 32
z, y, x = np.meshgrid(*3 * [np.arange(n)], indexing="ij")
np.save("zigzag.npy", (np.abs(y - 9 - 12 * x / (n - 1)) > 4.3).astype("u1"))

n = 24
z, y, x = np.meshgrid(*3 * [np.arange(n)], indexing="ij")
tube = 4.3 - np.hypot(x - 11.2, y - 12.7)
write("tube.hdf", np.maximum(tube, 3.3 - np.sqrt((x - 3) ** 2 + (y - 4.2) ** 2 + (z - 5.1) ** 2)) * H)
