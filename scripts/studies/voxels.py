"""k of a model by a solver on binary voxels, for comparison.

The solver is a program `SOLVER image.raw nx ny nz -d 2 -t 1e-5 -q` that prints JSON with kz (voxel^2); 1 is grain. The
model is sampled at fewer sites a side for it; a voxel is pore where the wall distance at its centre is positive."""
import json
import os
import subprocess
import tempfile

import h5py
import numpy as np


def processor_seconds(command):
    """What a command printed, and its processor time."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        text, errors = child.stdout.read(), child.stderr.read()
        _, code, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(code)
    if child.returncode:
        raise subprocess.CalledProcessError(child.returncode, command, text, errors)
    return text, usage.ru_utime + usage.ru_stime


def sample(distance, n):
    """Trilinear, at the centres of a lattice of n sites along x."""
    shape = distance.shape
    size = [max(1, round(m * n / shape[2])) for m in shape]
    for axis in range(3):
        at = (np.arange(size[axis]) + 0.5) * shape[axis] / size[axis] - 0.5
        low = np.floor(at).astype(int)
        weight = (at - low).reshape([-1 if a == axis else 1 for a in range(3)])
        distance = (1 - weight) * np.take(distance, low % shape[axis], axis) \
            + weight * np.take(distance, (low + 1) % shape[axis], axis)
    return distance


def permeability(solver, model, n):
    """k (m^2) along z and processor seconds, at n voxels along x."""
    with h5py.File(model) as file:
        distance = file["model/wall_distance"][...].astype(float)
        length = float(file["model"].attrs["spacing"][0]) * distance.shape[2]
    pores = (sample(distance, n) <= 0).astype("u1")
    with tempfile.NamedTemporaryFile(suffix=".raw") as image:
        pores.tofile(image.name)
        text, seconds = processor_seconds([solver, image.name, *map(str, pores.shape[::-1]), "-d", "2", "-t", "1e-5", "-q"])
    return json.loads(text)["kz"] * (length / n) ** 2, seconds
