"""write_hostile_images.py: a TIFF whose directories lead in a circle, one of 300 small pages, a PNG that claims 2 GB of text,
a TIFF of pages whose bytes no number of 64 bits counts, and a scene of 20001 settings."""
import struct, zlib
tags = [(256, 4, 16), (257, 4, 16), (258, 3, 8), (259, 3, 1), (262, 3, 1), (273, 4, 512), (277, 3, 1), (278, 4, 16), (279, 4, 256)]
page = struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", t, k, 1, v) for t, k, v in tags)
def tiff(name, follows): open(name, "wb").write(b"II*\0" + struct.pack("<I", 8) + page + struct.pack("<I", follows) + bytes(range(256)) * 4)
tiff("circle.tif", 8)
# ImageJ's stack with one directory: 2^31 x 2^30 doubles a page are 2^64 bytes.
image = b"ImageJ=1.53\nimages=3\n\0"
huge = [(256, 4, 1, 2**31), (257, 4, 1, 2**30), (258, 3, 1, 64), (259, 3, 1, 1), (262, 3, 1, 1), (270, 2, len(image), 400),
        (273, 4, 4, 512), (277, 3, 1, 1), (278, 4, 1, 2**28), (279, 4, 4, 512), (339, 3, 1, 3)]
huge = struct.pack("<H", len(huge)) + b"".join(struct.pack("<HHII", *tag) for tag in huge) + bytes(4)
open("huge.tif", "wb").write((b"II*\0" + struct.pack("<I", 8) + huge).ljust(400, b"\0") + image.ljust(112, b"\0") + struct.pack("<4I", 600, 600, 600, 600) + bytes(256))
# Many pages, each found at once: the chain leads from one to the next; each has its own grey.
n, size = 300, len(page) + 4
with open("pages.tif", "wb") as file:
    file.write(b"II*\0" + struct.pack("<I", 8))
    for i in range(n):
        own = [(t, k, 4 if t in (256, 257, 278) else 16 if t == 279 else 8 + n * size + 16 * i if t == 273 else v) for t, k, v in tags]
        file.write(struct.pack("<H", len(own)) + b"".join(struct.pack("<HHII", t, k, 1, v) for t, k, v in own))
        file.write(struct.pack("<I", 8 + (i + 1) * size if i < n - 1 else 0))
    file.write(bytes(200 if (i + x) % 3 else 10 + i % 7 for i in range(n) for x in range(16)))
open("pages.raw", "wb").write(bytes(200 if (i + x) % 3 else 10 + i % 7 for i in range(n) for x in range(16)))
def chunk(kind, data): return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
head = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 0, 0, 0, 0))
open("text.png", "wb").write(head + struct.pack(">I", 2**31 - 1) + b"tEXtlong")
open("many.cfg", "w").write("".join(f"k{i} = 1;\n" for i in range(20001)))
