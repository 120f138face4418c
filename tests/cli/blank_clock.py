#!/usr/bin/python3
"""blank_clock.py FILE...: puts zeros in place of all that a clock measured in models and runs: the time of their provenance
and /run/timing. What then still differs between files of the same inputs should not."""
import sys

import h5py
import numpy as np


def blank(item, name):
    attribute = h5py.h5a.open(item.id, name if isinstance(name, bytes) else name.encode())
    attribute.write(np.zeros(attribute.shape, attribute.dtype))


for path in sys.argv[1:]:
    with h5py.File(path, "r+") as file:
        blank(file["provenance"], "time")
        if "run" in file:
            file["run/timing/seconds"][...] = 0
            if "levels" in file["run/timing"]:
                file["run/timing/levels/seconds"][...] = 0
            for name in file["run/timing"].attrs:
                blank(file["run/timing"], name)
