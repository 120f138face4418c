#!/usr/bin/python3
"""same_run.py A.hdf B.hdf [NAME...]: exit 1 unless both hold the same bytes in every dataset but timings, provenance and
those whose names begin with NAME."""
import sys

import h5py

free = ("run/timing", "run/effects/share", "provenance", "run/snapshots/name", "run/scene", *sys.argv[3:])
files = [h5py.File(path, "r") for path in sys.argv[1:3]]
different = []


def plain(dataset):
    value = dataset[()]
    return value.tobytes() if getattr(value, "dtype", None) is not None and value.dtype.kind in "iuf" else str(value)


def visit(name, item):
    if isinstance(item, h5py.Dataset) and not name.startswith(free):
        if plain(item) != plain(files[1][name]):
            different.append(name)


files[0].visititems(visit)
if different:
    sys.exit(f"differ: {different}")
