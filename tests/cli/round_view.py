"""round_view.py SLICE.tiff: what ct2model said of a round field of view, in the folder of its JSON, against the greys themselves."""
import json, struct, sys
import numpy as np
data = open(sys.argv[1], "rb").read() # one strip, or strips in a row
order = "<" if data[:2] == b"II" else ">"
ifd, = struct.unpack(order + "I", data[4:8])
tags = {}
for i in range(struct.unpack(order + "H", data[ifd:ifd + 2])[0]):
    tag, kind, n, value = struct.unpack(order + "HHII", data[ifd + 2 + 12 * i:ifd + 14 + 12 * i])
    tags[tag] = (n, value if order == "<" or kind == 4 or n > 1 else value >> 16)
start = tags[273][1] if tags[273][0] == 1 else struct.unpack(order + "I", data[tags[273][1]:tags[273][1] + 4])[0]
width, height = tags[256][1], tags[257][1]
grey = np.frombuffer(data, order + "u2", width * height, start).reshape(height, width).astype(float)
x, y, z, nx, ny, nz = (int(v) for v in open("box").read().split(","))
inside = grey[y:y + ny, x:x + nx]
assert inside.min() > 1000 and inside.size > 0.4 * (grey > 1).sum(), (inside.min(), inside.size)
for e in (0.2, 0.3):
    said = json.load(open(f"auto-{e}.json"))
    assert abs(said["threshold_original"] - np.quantile(inside, e / (1 + e))) < 5
    assert abs(said["void_ratio_original"] - e) < 1e-3
    # Where e holds for the round field of view, the threshold is that of its greys.
    yy, xx = np.mgrid[:grey.shape[0], :grey.shape[1]] + 0.5
    disc = grey[(xx - 496) ** 2 + (yy - 504) ** 2 < 470 ** 2]
    said = json.load(open(f"round-{e}.json"))
    assert disc.min() > 1 and abs(said["threshold_original"] - np.quantile(disc, e / (1 + e))) < 5
