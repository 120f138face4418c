#!/usr/bin/python3
"""Reads Tosui's files from docs/formats.md alone (h5py), and checks what the page promises.
usage: independent_reader.py model|run|snapshot FILE"""
import sys

import h5py
import numpy as np


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def check_provenance(file):
    for name in "program version schema_version command_line host time".split():
        assert name in file["provenance"].attrs, name
    files, hashes = file["provenance/input_files"][()], file["provenance/input_hashes"][()]
    assert len(files) == len(hashes) and all(len(text(h)) == 16 for h in hashes)


def read_model(file):
    solid = file["model/solid"][()]
    spacing = file["model"].attrs["spacing"]
    assert solid.dtype == np.uint8 and solid.ndim == 3 and set(np.unique(solid)) <= {0, 1}
    assert len(spacing) == 3 and all(spacing > 0)
    grains = int(solid.sum())
    assert abs(file["model"].attrs["void_ratio"] - (solid.size - grains) / grains) < 1e-12
    for name in ("wall_distance", "grain_fraction"):
        values = file["model/" + name][()]
        assert values.dtype == np.float32 and values.shape == solid.shape and np.isfinite(values).all()
    assert ((file["model/wall_distance"][()] > 0) == (solid == 0)).all()
    threshold, void_ratio = file["calibration/threshold"][()], file["calibration/void_ratio"][()]
    assert len(threshold) == len(void_ratio) > 1 and "histogram" in file["calibration"]
    check_provenance(file)
    return f"{solid.shape} void ratio {(solid.size - grains) / grains:.4f}"


def read_run(file):
    run, history = file["run"], file["history"]
    n = len(history["time"])
    units = {"time": "s", "darcy_velocity": "m/s", "density_max": "kg/m^3", "kinetic_energy": "J", "mass": "kg"}
    for name, unit in units.items():
        assert len(history[name]) == n and text(history[name].attrs["unit"]) == unit, name
    assert history["darcy_velocity"].shape == (n, 3) and history["momentum"].shape == (n, 3)
    for name in ("method status k k_error intrinsic_permeability darcy_velocity hydraulic_gradient driving density viscosity "
                 "spacing size origin dimensions bulk_count fluid_count wall_count sound_speed support wall model_path "
                 "model_hash steps pair_interactions").split():
        assert name in run.attrs, name
    driving, v = run.attrs["driving"], run.attrs["darcy_velocity"]
    along = float(np.dot(driving, v) / np.linalg.norm(driving))
    assert abs(run.attrs["k"] * run.attrs["hydraulic_gradient"] - along) <= 1e-9 * abs(along)
    effects = run["effects"]
    assert all(text(s) in ("on", "off") for s in effects["state"][()]) and len(effects["name"]) == len(effects["reason"])
    size = tuple(int(s) for s in run.attrs["size"][::-1])
    assert run["solid"].shape == size and int(run["solid"][()].sum()) == run.attrs["wall_count"]
    assert len(run["timing/name"]) == len(run["timing/seconds"]) and "scene" in text(run["scene"][()])
    timing = run["timing"].attrs
    assert timing["wall_time"] > 0 and timing["threads"] > 0 and "pair_interactions_per_second" in timing
    assert len(run["snapshots/name"]) == len(run["snapshots/time"]) >= 1
    check_provenance(file)
    return f"{text(run.attrs['method'])}: k {run.attrs['k']:.4g} m/s, {n} rows"


def read_snapshot(file):
    vtk = file["VTKHDF"]
    assert list(vtk.attrs["Version"]) == [1, 0] and text(vtk.attrs["Type"]) == "UnstructuredGrid"
    points, velocity = vtk["Points"][()], vtk["PointData/velocity"][()]
    assert points.shape == velocity.shape and np.isfinite(points).all() and np.isfinite(velocity).all()
    assert vtk["NumberOfPoints"][0] == len(points) and (vtk["Types"][()] == 1).all()
    assert "time" in file.attrs and "step" in file.attrs
    for name in vtk["PointData"]:
        assert "unit" in vtk["PointData"][name].attrs and "description" in vtk["PointData"][name].attrs
    return f"{len(points)} particles at {file.attrs['time']:.4g} s"


with h5py.File(sys.argv[2], "r") as opened:
    print({"model": read_model, "run": read_run, "snapshot": read_snapshot}[sys.argv[1]](opened))
