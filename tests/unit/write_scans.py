"""write_scans.py FOLDER: scans as labs write them, byte by byte with struct and zlib alone, no image library.

Each holds (3x + 5y + 40z) % 200 times a factor plus an offset, in 37x21 pixels and 3 slices. One line a file on
stdout: NAME PIXEL_TYPE FACTOR OFFSET VOXEL_X VOXEL_Z (um; nan: the file does not say)."""
import gzip
import os
import struct
import sys
import zlib

NX, NY, NZ = 37, 21, 3
FOLDER = sys.argv[1]
CODES = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i", "f32": "f", "f64": "d"}


def pattern(x, y, z):
    return (3 * x + 5 * y + 40 * z) % 200


def plane(kind, order, factor, offset, z):
    values = [pattern(x, y, z) * factor + offset for y in range(NY) for x in range(NX)]
    return struct.pack(order + str(NX * NY) + CODES[kind], *values)


def say(name, kind, factor, offset, voxel=("nan", "nan")):
    print(name, kind, factor, offset, *voxel)


def lzw(data):
    """TIFF's LZW as literals alone, cleared before the codes grow to ten bits."""
    codes = []
    for i, byte in enumerate(data):
        if i % 200 == 0:
            codes.append(256)
        codes.append(byte)
    bits = "".join(format(c, "09b") for c in codes + [257])
    bits += "0" * (-len(bits) % 8)
    return int(bits, 2).to_bytes(len(bits) // 8, "big")


def packbits(data):
    out = b""
    i = 0
    while i < len(data):
        run = 1
        while i + run < len(data) and run < 128 and data[i + run] == data[i]:
            run += 1
        if run > 2:
            out += struct.pack("bB", 1 - run, data[i])
            i += run
        else:
            part = data[i:i + 5]
            out += struct.pack("b", len(part) - 1) + part
            i += len(part)
    return out


PACK = {1: lambda d: d, 5: lzw, 8: zlib.compress, 32773: packbits}


def difference(data, kind, order, width):
    """Predictor 2: each sample less the one before, in rows."""
    size = struct.calcsize(CODES[kind])
    code = {1: "B", 2: "H", 4: "I"}[size]
    out = b""
    for at in range(0, len(data), width * size):
        row = struct.unpack(order + str(width) + code, data[at:at + width * size])
        mask = (1 << 8 * size) - 1
        out += struct.pack(order + str(width) + code, *[(v - (row[i - 1] if i else 0)) & mask for i, v in enumerate(row)])
    return out


def ifd(entries, order, big, at):
    """A directory at offset `at` and what does not fit into it: (bytes, place of the next offset)."""
    width, count, each = (8, "Q", 20) if big else (4, "I", 12)
    head = struct.pack(order + ("Q" if big else "H"), len(entries))
    body, extra = b"", b""
    extra_at = at + len(head) + each * len(entries) + width
    for tag, kind, values in sorted(entries):
        if kind == 2:
            data = values.encode("utf-8") + b"\0"
            n = len(data)
        else:
            n = len(values) // (2 if kind == 5 else 1)
            data = struct.pack(order + str(len(values)) + {1: "B", 3: "H", 4: "I", 5: "I", 16: "Q"}[kind], *values)
        body += struct.pack(order + "HH" + count, tag, kind, n)
        if len(data) <= width:
            body += data.ljust(width, b"\0")
        else:
            body += struct.pack(order + count, extra_at + len(extra))
            extra += data + b"\0" * (len(data) % 2)
    return head + body, extra, at + len(head) + len(body)


def tiff(name, kind, order="<", big=False, compression=1, rows=8, tile=0, predictor=1, photometric=1, samples=1,
         factor=1, offset=0, description=None, resolution=None, unit=2, voxel=("nan", "nan"), expect=None,
         palette=257, beyond=()):
    size = struct.calcsize(CODES[kind])
    out = bytearray((b"II" if order == "<" else b"MM") + (struct.pack(order + "HHHQ", 43, 8, 0, 16) if big else
                                                          struct.pack(order + "HI", 42, 8)))
    link = 8 if big else 4
    for z in range(NZ):
        whole = plane(kind, order, factor, offset, z)
        pixel = [whole[i:i + size] * (samples - len(beyond)) + b"\xff" * (size * len(beyond))
                 for i in range(0, len(whole), size)]
        blocks = []
        if tile:
            for y0 in range(0, NY, tile):
                for x0 in range(0, NX, tile):
                    blocks.append((tile, b"".join(pixel[min(y, NY - 1) * NX + min(x, NX - 1)]
                                                  for y in range(y0, y0 + tile) for x in range(x0, x0 + tile))))
        else:
            for y0 in range(0, NY, rows):
                blocks.append((NX, b"".join(pixel[y0 * NX:min(NY, y0 + rows) * NX])))
        places, lengths = [], []
        for width, data in blocks:
            if predictor == 2:
                data = difference(data, kind, order, width)
            data = PACK[compression](data)
            places.append(len(out))
            lengths.append(len(data))
            out += data + b"\0" * (len(data) % 2)
        entries = [(256, 3, [NX]), (257, 3, [NY]), (258, 3, [8 * size] * samples), (259, 3, [compression]),
                   (262, 3, [photometric]), (277, 3, [samples]),
                   (339, 3, [{"u": 1, "i": 2, "f": 3}[kind[0]]] * samples), (317, 3, [predictor])]
        where, long = (16, 16) if big else (4, 4)
        if tile:
            entries += [(322, 3, [tile]), (323, 3, [tile]), (324, where, places), (325, long, lengths)]
        else:
            entries += [(273, where, places), (278, 3, [rows]), (279, long, lengths)]
        if photometric == 3:
            entries.append((320, 3, [i * palette for i in range(256)] * 3))
        if beyond:
            entries.append((338, 3, list(beyond)))
        if description and z == 0:
            entries.append((270, 2, description))
        if resolution:
            entries += [(282, 5, list(resolution)), (283, 5, list(resolution)), (296, 3, [unit])]
        at = len(out)
        directory, extra, next_link = ifd(entries, order, big, at)
        struct.pack_into(order + ("Q" if big else "I"), out, link, at)
        link = next_link
        out += directory + bytes(8 if big else 4) + extra
    with open(os.path.join(FOLDER, name), "wb") as file:
        file.write(out)
    say(name, kind, *(expect or (factor, offset)), voxel)


def imagej_large(name):
    """Over 4 GB with one directory: the pixels of slice z hold the pattern in their first row alone."""
    side, slices = 2048, 520
    text = "ImageJ=1.53t\nimages=%d\nslices=%d\nunit=micron\nspacing=2.5\n" % (slices, slices)
    entries = [(256, 4, [side]), (257, 4, [side]), (258, 3, [16]), (259, 3, [1]), (262, 3, [1]), (270, 2, text),
               (273, 4, [4096]), (277, 3, [1]), (278, 4, [side]), (279, 4, [2 * side * side]),
               (282, 5, [500000, 1000000]), (283, 5, [500000, 1000000]), (296, 3, [1])]
    directory, extra, _ = ifd(entries, ">", False, 8)
    with open(os.path.join(FOLDER, name), "wb") as file:
        file.write(b"MM" + struct.pack(">HI", 42, 8) + directory + bytes(4) + extra)
        for z in (0, 1, 519):
            file.seek(4096 + z * 2 * side * side)
            file.write(struct.pack(">%dH" % side, *[pattern(x, 0, z) for x in range(side)]))
        file.truncate(4096 + slices * 2 * side * side)


def together(name, kind, order, more, factor=1):
    """One directory, behind all slices."""
    size = struct.calcsize(CODES[kind])
    pixels = volume(kind, order, factor, 0)
    entries = [(256, 4, [NX]), (257, 4, [NY]), (258, 3, [8 * size]), (259, 3, [1]), (262, 3, [1]), (273, 4, [8]),
               (277, 3, [1]), (278, 4, [NY]), (279, 4, [NX * NY * size]), *more]
    at = 8 + len(pixels) + len(pixels) % 2
    directory, extra, _ = ifd(entries, order, False, at)
    with open(os.path.join(FOLDER, name), "wb") as file:
        file.write((b"II" if order == "<" else b"MM") + struct.pack(order + "HI", 42, at))
        file.write(pixels + b"\0" * (len(pixels) % 2) + directory + bytes(4) + extra)
    say(name, kind, factor, 0)


def png(name, bits, colour, interlace=0):
    """Filter 0 rows; colour 0 grey, 2 RGB, 3 palette, 4 grey with alpha. Pattern of slice 0."""
    size, channels = bits // 8, {0: 1, 2: 3, 3: 1, 4: 2}[colour]
    rows = b""
    for y in range(NY):
        rows += b"\0"
        for x in range(NX):
            grey = struct.pack(">H", 257 * pattern(x, y, 0))[:size]
            rows += grey * (3 if colour == 2 else 1) + (b"\xff" * size if colour == 4 else b"")

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    out = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", NX, NY, bits, colour, 0, 0, interlace))
    out += chunk(b"pHYs", struct.pack(">IIB", 171527, 171527, 1))
    if colour == 3:
        out += chunk(b"PLTE", b"".join(bytes([i] * 3) for i in range(256)))
    out += chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    with open(os.path.join(FOLDER, name), "wb") as file:
        file.write(out)
    say(name, "u%d" % bits, 1 if bits == 8 else 257, 0, ("5.83", "nan"))


def volume(kind, order, factor, offset):
    return b"".join(plane(kind, order, factor, offset, z) for z in range(NZ))


def headed(name, head, data, kind, factor, offset, voxel=("nan", "nan"), beside=None):
    with open(os.path.join(FOLDER, name), "wb") as file:
        file.write(head.encode() + (b"" if beside else data))
    if beside:
        with open(os.path.join(FOLDER, beside), "wb") as file:
            file.write(data)
    say(name, kind, factor, offset, voxel)


def main():
    tiff("plain8.tif", "u8")
    tiff("rows1_be16.tif", "u16", ">", rows=1, factor=300)
    tiff("signed8.tif", "i8", offset=-100, factor=1)
    tiff("signed16.tif", "i16", "<", factor=150, offset=-15000)
    tiff("signed16_be.tif", "i16", ">", factor=150, offset=-15000)
    tiff("signed32_be.tif", "i32", ">", factor=100000, offset=-10000000)
    tiff("unsigned32.tif", "u32", "<", factor=50000, offset=0)
    tiff("float.tif", "f32", "<", factor=0.5, offset=-3)
    tiff("float_be.tif", "f32", ">", factor=0.5, offset=-3)
    tiff("double.tif", "f64", "<", factor=0.25, offset=-3)
    tiff("double_be.tif", "f64", ">", factor=0.25, offset=-3)
    tiff("lzw.tif", "u16", compression=5, factor=256)
    tiff("lzw_predicted_be.tif", "u16", ">", compression=5, predictor=2, factor=256)
    tiff("deflate.tif", "u16", compression=8, factor=256)
    tiff("deflate_predicted.tif", "u32", compression=8, predictor=2, factor=1000)
    tiff("packbits.tif", "u8", compression=32773)
    tiff("tiled.tif", "u16", tile=16, factor=256)
    tiff("tiled_deflate_be.tif", "f32", ">", tile=32, compression=8, factor=0.5)
    tiff("big.tif", "u16", "<", big=True, factor=256)
    tiff("big_be_tiled_lzw.tif", "u16", ">", big=True, tile=16, compression=5, factor=256)
    tiff("white_is_zero8.tif", "u8", photometric=0, expect=(-1, 255))
    tiff("white_is_zero16.tif", "u16", ">", photometric=0, factor=256, expect=(-256, 65535))
    tiff("rgb.tif", "u8", samples=3, photometric=2)
    tiff("rgb16.tif", "u16", ">", samples=3, photometric=2, compression=5, factor=256)
    tiff("grey_alpha.tif", "u8", samples=2, beyond=[2])
    tiff("palette.tif", "u8", photometric=3)
    tiff("palette_shifted.tif", "u8", photometric=3, palette=256)
    tiff("palette_of_bytes.tif", "u8", photometric=3, palette=1)
    tiff("palette_fractions.tif", "u8", photometric=3, palette=131, expect=(131 / 257, 0))
    tiff("palette_tiled.tif", "u8", photometric=3, tile=16, compression=5)
    tiff("white_is_zero_signed.tif", "i16", photometric=0, factor=100, expect=(-100, -1))
    tiff("white_is_zero_float.tif", "f32", photometric=0, factor=0.5, expect=(-0.5, 0))
    tiff("centimetres.tif", "u8", resolution=(1715266, 1000), unit=3, voxel=("5.83", "nan"))
    tiff("page_dpi.tif", "u8", resolution=(600, 1))
    imagej = "ImageJ=1.53t\nimages=3\nslices=3\nunit=%s\nspacing=%s\n"
    tiff("imagej_units.tif", "u8", description="ImageJ=1.53t\nimages=3\nslices=3\nunit=micron\nyunit=mm\nzunit=nm\nspacing=7500\n",
         resolution=(200000, 1000000), unit=1, voxel=("5", "7.5"))
    for unit, text, factor in (("micron", "micron", 1), ("escaped", "\\u00B5m", 1), ("um", "um", 1), ("mm", "mm", 1e-3)):
        tiff("imagej_%s.tif" % unit, "u16", ">", rows=NY, description=imagej % (text, 7.5 * factor),
             resolution=(int(200000 / factor), 1000000), unit=1, voxel=("5", "7.5"))
    ome = ('<?xml version="1.0"?><OME><Image><Pixels SizeX="37" SizeY="21" SizeZ="3" SizeC="%s" SizeT="1" Type="uint16" '
           'PhysicalSizeX="%s" PhysicalSizeY="%s" PhysicalSizeZ="%s"%s/></Image></OME>')
    tiff("ome.ome.tif", "u16", description=ome % (1, 5, 5, 7.5, ""), voxel=("5", "7.5"))
    for name, unit in (("utf8", "\u00b5m"), ("entity", "&#181;m"), ("hex", "&#xB5;m")):
        tiff("ome_%s.tif" % name, "u16", ">", big=True,
             description=ome % (1, 5, 5, 7.5, "".join(' PhysicalSize%sUnit="%s"' % (a, unit) for a in "XYZ")),
             voxel=("5", "7.5"))
    tiff("ome_nm.tif", "u16", description=ome % (1, 5000, 5000, 7500, ' PhysicalSizeXUnit="nm" PhysicalSizeYUnit="nm" '
                                                 'PhysicalSizeZUnit="nm"'), voxel=("5", "7.5"))
    tiff("refuse_channels.tif", "u16", description=ome % (3, 5, 5, 7.5, ""))
    tiff("refuse_frames.tif", "u16", description="ImageJ=1.53t\nimages=3\nframes=3\n")
    for bits in (8, 16):
        png("grey%d.png" % bits, bits, 0)
        png("rgb%d.png" % bits, bits, 2)
        png("alpha%d.png" % bits, bits, 4)
    png("palette.png", 8, 3)
    meta = "ObjectType = Image\nNDims = 3\nBinaryData = True\n%sDimSize = 37 21 3\nElementType = %s\nElementDataFile = %s\n"
    headed("local.mha", meta % ("", "MET_UCHAR", "LOCAL"), volume("u8", "<", 1, 0), "u8", 1, 0)
    headed("beside.mhd", meta % ("BinaryDataByteOrderMSB = True\n", "MET_SHORT", "beside.img"),
           volume("i16", ">", 150, -15000), "i16", 150, -15000, beside="beside.img")
    headed("packed.mhd", meta % ("CompressedData = True\nCompressedDataSize = 99\n", "MET_USHORT", "packed.zraw"),
           zlib.compress(volume("u16", "<", 256, 0)), "u16", 256, 0, beside="packed.zraw")
    headed("float.mhd", meta % ("HeaderSize = 5\n", "MET_FLOAT", "float.img"),
           b"12345" + volume("f32", "<", 0.5, 0), "f32", 0.5, 0, beside="float.img")
    headed("last.mhd", meta % ("HeaderSize = -1\n", "MET_DOUBLE", "last.img"),
           b"any header" + volume("f64", "<", 0.5, 0), "f64", 0.5, 0, beside="last.img")
    nrrd = "NRRD0005\n# by hand\ntype: %s\ndimension: 3\nsizes: 37 21 3\nencoding: %s\n%s\n"
    headed("raw.nrrd", nrrd % ("uint8", "raw", ""), volume("u8", "<", 1, 0), "u8", 1, 0)
    headed("big.nrrd", nrrd % ("unsigned short", "raw", "endian: big\n"), volume("u16", ">", 256, 0), "u16", 256, 0)
    headed("little.nrrd", nrrd % ("int32", "raw", "endian: little\nspacings: 5 5 7.5\nspace units: \"um\" \"um\" \"um\"\n"),
           volume("i32", "<", 1000, -500), "i32", 1000, -500, ("5", "7.5"))
    headed("gzip.nrrd", nrrd % ("float", "gzip", "endian: big\n"), gzip.compress(volume("f32", ">", 0.5, 0)), "f32", 0.5, 0)
    headed("detached.nhdr", nrrd % ("short", "raw", "endian: little\nbyte skip: 7\ndata file: detached.img\n"),
           b"7 bytes" + volume("i16", "<", 150, -15000), "i16", 150, -15000, beside="detached.img")
    headed("packed.nhdr", nrrd % ("ushort", "gz", "endian: little\ndata file: ./packed.raw.gz\n"),
           gzip.compress(volume("u16", "<", 256, 0)), "u16", 256, 0, beside="packed.raw.gz")
    headed("last.nhdr", nrrd % ("double", "raw", "endian: big\nbyte skip: -1\ndata file: last2.img\n"),
           b"header" + volume("f64", ">", 0.5, 0), "f64", 0.5, 0, beside="last2.img")
    imagej_large("imagej_large.tif")
    together("tifffile_truncated.tif", "u16", "<", [(270, 2, '{"shape": [3, 21, 37], "truncated": true}')], 256)
    together("metamorph.stk.tif", "u16", ">", [(33629, 5, [1, 1] * 3)], 256)
    for name, text in (("shape", '{"shape": [3, 21, 37]}'), ("axes", '{"shape": [3, 21, 37], "axes": "ZYX"}'),
                       ("ones", '{"shape": [1, 3, 1, 21, 37], "axes": "TZCYX"}'), ("appended", '{"shape": [21, 37]}')):
        tiff("tifffile_%s.tif" % name, "u8", description=text)
    tiff("tifffile_rgb.tif", "u8", samples=3, photometric=2, description='{"shape": [3, 21, 37, 3]}')
    tiff("refuse_tifffile.tif", "u8", description='{"shape": [3, 21, 37], "axes": "CYX"}')
    tiff("refuse_shape.tif", "u8", description='{"shape": [3, 2, 21, 37]}')


main()
