#!/usr/bin/python3
"""ranks.py A.hdf B.hdf BOUND NAME...: exit 1 unless the datasets (or NAME@ATTRIBUTE) agree to BOUND of their largest value,
and both files hold the same things in the same shapes and chunks."""
import sys

import h5py
import numpy as np

a, b = (h5py.File(path, "r") for path in sys.argv[1:3])
bound = float(sys.argv[3])


def layout(file):
    found = {}
    file.visititems(lambda name, item: found.__setitem__(name, (getattr(item, "shape", None), getattr(item, "chunks", None),
                                                               str(getattr(item, "dtype", None)))))
    return {n: f for n, f in found.items() if not n.startswith(("run/timing", "provenance", "run/scene", "run/snapshots"))}


def value(file, name):
    path, _, attribute = name.partition("@")
    return np.asarray(file[path].attrs[attribute] if attribute else file[path][()], dtype=float)


of_a, of_b = layout(a), layout(b)
bad = [n for n in of_a.keys() | of_b.keys() if of_a.get(n) != of_b.get(n)]
assert not bad, f"laid out differently: {[(n, of_a.get(n), of_b.get(n)) for n in bad]}"
for name in sys.argv[4:]:
    x, y = value(a, name), value(b, name)
    largest, off = np.max(np.abs(x)), np.max(np.abs(x - y))
    assert largest > 0 and off <= bound * largest, f"{name} differs by {off / largest:.3g} of {largest:.6g}, more than {bound:g}"
