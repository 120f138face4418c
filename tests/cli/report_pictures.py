"""report_pictures.py PAGE.html RUN.hdf MODEL.hdf SNAPSHOT.hdf: what the page's pictures are drawn from is in the files.
The share of the pores that carries half of the flow; the wall distance in the plane and over the grey slice; speeds."""
import base64
import sys

import h5py
import numpy as np

from page import field, read

data = read(sys.argv[1])
run, model, snapshot = (h5py.File(path) for path in sys.argv[2:5])
plane, flow, grey = (data["pictures"][name] for name in ("plane", "flow", "slice"))

# Half of the flow: the fastest along the force, by a plain sum.
direction = run["run"].attrs["driving"] / np.linalg.norm(run["run"].attrs["driving"])
velocity, points = snapshot["VTKHDF/PointData/velocity"][()], snapshot["VTKHDF/Points"][()]
along = np.sort(velocity @ direction)[::-1]
carriers = np.searchsorted(np.cumsum(along), 0.5 * along.sum()) + 1
assert abs(flow["pore_share_of_half_the_flow"] / (carriers / along.size) - 1) < 1e-3, carriers / along.size
assert len(base64.b64decode(flow["grains"])) == (np.prod(flow["size"]) + 1) // 2

# The plane across x through the middle: its walls are the model's, its speeds the snapshot's.
spacing = model["model"].attrs["spacing"][0]
distance = model["model/wall_distance"][()]
assert plane["normal"] == "x" and plane["up"] == "z", plane
ny, nz = plane["size"]
shown = field(plane["distance"]).reshape(nz, ny)
i = int(plane["at_m"] / spacing)
assert (shown.shape[0], shown.shape[1]) == distance.shape[:2] and abs(plane["spacing_m"][0] / spacing - 1) < 1e-6
there = np.clip(distance[:, :, i] / spacing, -2, 2)
assert np.abs(shown - there).max() < 0.02, np.abs(shown - there).max()
speed = np.zeros((nz, ny))
in_plane = np.abs(points[:, 0] - plane["at_m"]) < 0.5 * spacing
site = np.round(points[in_plane] / spacing - 0.5).astype(int)
speed[site[:, 2], site[:, 1]] = np.linalg.norm(velocity[in_plane], axis=1)
high = plane["speed"]["high"]
assert np.abs(field(plane["speed"]).reshape(nz, ny) - np.minimum(speed, high)).max() < 0.01 * high
assert abs(np.sort(speed[speed > 0])[int(0.98 * (speed > 0).sum())] / high - 1) < 0.1

# The grey slice is the file's, and the walls over it lie between its pores and grains.
slice_ = model["calibration/slice"][()]
nx, ny = grey["size"]
assert (ny, nx) == slice_.shape
g = grey["grey"]
assert np.abs(field(g).reshape(ny, nx) - np.clip(slice_, g["low"], g["high"])).max() < 0.01 * (g["high"] - g["low"])
walls, c = field(grey["distance"]), model["calibration"].attrs
pore, grain = (field(g)[side].mean() for side in (walls > 1.9, walls < -1.9))
assert abs(pore - c["pore_peak"]) < 0.25 * (c["grain_peak"] - c["pore_peak"]) and abs(grain - c["grain_peak"]) < 0.25 * (
    c["grain_peak"] - c["pore_peak"]), (pore, grain, dict(c))
at_wall = field(g)[np.abs(walls) < 0.3].mean()
assert abs(at_wall - 0.5 * (pore + grain)) < 0.12 * (grain - pore), (at_wall, pore, grain)
