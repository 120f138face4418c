#!/usr/bin/python3
"""same_run.py A.hdf B.hdf [C.hdf D.hdf ...] [NAME...]: exit 1 unless A and B, C and D, ... hold the same bytes in every
dataset and attribute but what was measured on the machine, the time and the command line, and those whose names
(GROUP/NAME, GROUP@ATTRIBUTE) begin with NAME; with @ attributes are left out, as those of runs on other ranks, whose error
is of other sums."""
import sys

import h5py

paths = [argument for argument in sys.argv[1:] if argument.endswith(".hdf")]
# What a clock or this machine's memory gave, and what the user typed.
free = ("run/timing", "provenance@time", "provenance@command_line", *sys.argv[len(paths) + 1:])


def plain(value):
    return value.tobytes() if getattr(value, "dtype", None) is not None and value.dtype.kind in "iuf" else str(value)


def contents(file):
    """Every dataset and attribute, by name; the run's own name, with which those of its snapshots begin, left out."""
    found, own = {}, file.filename.rpartition("/")[2][:-len(".hdf")]

    def visit(name, item):
        if isinstance(item, h5py.Dataset) and not name.startswith(free):
            found[name] = plain(item[()])
            if name == "run/snapshots/name":
                found[name] = found[name].replace(f"b'{own}-", "b'-").split()
        for attribute, value in item.attrs.items():
            if "@" not in free and not name.startswith(free) and not f"{name}@{attribute}".startswith(free):
                found[f"{name}@{attribute}"] = plain(value)

    visit("", file)
    file.visititems(visit)
    return found


def different(a, b):
    a, b = contents(a), contents(b)
    return sorted(name for name in a.keys() | b.keys() if a.get(name) != b.get(name))


if len(paths) % 2 or not paths:
    sys.exit("same_run.py: files come in pairs")
for a, b in zip(paths[::2], paths[1::2]):
    found = different(h5py.File(a, "r"), h5py.File(b, "r"))
    if found:
        sys.exit(f"{a} and {b} differ: {found}")
