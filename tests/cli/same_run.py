#!/usr/bin/python3
"""same_run.py A.hdf B.hdf [C.hdf D.hdf ...] [NAME...]: exit 1 unless A and B, C and D, ... hold the same bytes in every
dataset but timings, provenance and those whose names begin with NAME."""
import sys

import h5py

paths = [argument for argument in sys.argv[1:] if argument.endswith(".hdf")]
free = ("run/timing", "run/effects/share", "provenance", "run/snapshots/name", "run/scene", *sys.argv[len(paths) + 1:])


def plain(dataset):
    value = dataset[()]
    return value.tobytes() if getattr(value, "dtype", None) is not None and value.dtype.kind in "iuf" else str(value)


def different(a, b):
    found = []

    def visit(name, item):
        if isinstance(item, h5py.Dataset) and not name.startswith(free) and plain(item) != plain(b[name]):
            found.append(name)

    a.visititems(visit)
    return found


if len(paths) % 2 or not paths:
    sys.exit("same_run.py: files come in pairs")
for a, b in zip(paths[::2], paths[1::2]):
    found = different(h5py.File(a, "r"), h5py.File(b, "r"))
    if found:
        sys.exit(f"{a} and {b} differ: {found}")
