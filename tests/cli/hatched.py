"""Whether the maps of a page have the colour of hatching in them, and about where the run has soil: PAGE SNAPSHOT."""
import base64
import re
import struct
import sys
import zlib

import h5py
import numpy as np

page = open(sys.argv[1], encoding="utf-8").read()
maps = re.findall(r'<svg class="map".*?base64,([^"]+)"', page, re.S)
points = h5py.File(sys.argv[2])["VTKHDF"]
x, soil = points["Points"][()], points["PointData/micro_porosity"][()] > 0
layers = np.unique(x[:, 0])
in_plane = np.isclose(x[:, 0], layers[len(layers) // 2])
lattice = len(layers) ** 2
for picture in maps:
    png = base64.b64decode(picture)
    at, data, palette = 8, b"", b""
    while at < len(png):
        (length,), kind = struct.unpack(">I", png[at : at + 4]), png[at + 4 : at + 8]
        body = png[at + 8 : at + 8 + length]
        data += body if kind == b"IDAT" else b""
        palette = body if kind == b"PLTE" else palette
        size = struct.unpack(">II", body[:8]) if kind == b"IHDR" else size
        at += length + 12
    rows = np.frombuffer(zlib.decompress(data), "u1").reshape(size[1], size[0] + 1)
    assert not rows[:, 0].any(), "the rows are filtered"
    assert palette[3 * 254 : 3 * 255] == bytes.fromhex("b08968"), palette[-6:]
    hatched = (rows[:, 1:] == 254).mean() * 14 / 2  # two of fourteen pixels of the soil
    there = (soil & in_plane).sum() / lattice
    assert abs(hatched - there) < 0.1 + 0.3 * there and there > 0.02, (hatched, there)
assert len(maps) == 2
