"""report_pictures.py PAGE.html RUN.hdf MODEL.hdf SNAPSHOT.hdf: what the page's pictures show is in the files. The share of
the pores that carries half of the flow; outlines where the wall distance is 0; pictures that are sound PNGs."""
import base64
import json
import re
import struct
import sys
import zlib

import h5py
import numpy as np

with open(sys.argv[1]) as file:
    page = file.read()
data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.S)[1])
run, model, snapshot = (h5py.File(path) for path in sys.argv[2:5])

# Half of the flow: the fastest along the force, by a plain sum.
direction = run["run"].attrs["driving"] / np.linalg.norm(run["run"].attrs["driving"])
along = np.sort(snapshot["VTKHDF/PointData/velocity"][()] @ direction)[::-1]
carriers = np.searchsorted(np.cumsum(along), 0.5 * along.sum()) + 1
assert abs(data["flow"]["pore_share_of_half_the_flow"] / (carriers / along.size) - 1) < 1e-3, carriers / along.size

# Outlines of both maps: the wall distance there, interpolated between points, is nearly 0.
maps = re.findall(r'<svg class="map".*?</svg>', page, re.S)
assert len(maps) == 2, len(maps)
distance = model["model/wall_distance"][()] / model["model"].attrs["spacing"][0]
nz, ny, nx = distance.shape
plane = distance[:, :, nx // 2]
scale = 720 / max(ny, nz)
for svg in maps:
    path = re.search(r'<path fill="none" stroke="#5d564a".*?d="(.*?)"', svg)[1]
    points = np.array([list(map(float, p)) for p in re.findall(r"([\d.]+) ([\d.]+)", path)])
    assert len(points) > 100, len(points)
    x, z = points[:, 0] / scale - 0.5, (np.floor(scale * nz) - points[:, 1]) / scale - 0.5
    inside = (x > 0) & (x < ny - 1.001) & (z > 0) & (z < nz - 1.001)
    i, j = x[inside].astype(int), z[inside].astype(int)
    p, q = x[inside] - i, z[inside] - j
    at = (1 - q) * ((1 - p) * plane[j, i] + p * plane[j, i + 1]) + q * ((1 - p) * plane[j + 1, i] + p * plane[j + 1, i + 1])
    assert np.sqrt(np.mean(at**2)) < 0.15, np.sqrt(np.mean(at**2))
assert 'stroke="#fff"' in maps[0] and 'stroke="#fff"' not in maps[1]  # streamlines over the speed

# Every picture is a PNG whose chunks have their checksums and whose pixels are all there.
pictures = re.findall(r'<(?:img|image) [^>]*(?:src|href)="data:image/png;base64,([A-Za-z0-9+/=]+)"', page)
assert len(pictures) >= 4, len(pictures)
for text in pictures:
    png = base64.b64decode(text)
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, kinds, pixels = 8, [], b""
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at:at + 8])
        body = png[at + 8:at + 8 + size]
        assert struct.unpack(">I", png[at + 8 + size:at + 12 + size])[0] == zlib.crc32(kind + body)
        kinds.append(kind)
        if kind == b"IHDR":
            width, height, bits, colours = struct.unpack(">IIBB", body[:10])
        pixels += body if kind == b"IDAT" else b""
        at += 12 + size
    assert kinds[0] == b"IHDR" and kinds[-1] == b"IEND" and bits == 8
    assert len(zlib.decompress(pixels)) == height * (1 + width * (3 if colours == 2 else 1))
