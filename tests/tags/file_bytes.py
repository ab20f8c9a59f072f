# SPDX-License-Identifier: Apache-2.0
"""Picture files byte by byte, with the header fields that a test asks for.

Pixels are NumPy arrays of height x width x channels. Codes are integers where the format stores integers. Nothing here
reads a file of Tonewright.
"""

import struct
import zlib

import numpy as np
from color_math import ICC_D50, PRIMARIES, bradford, rgb_to_xyz, white_xyz


def pixels(values, width=8, height=8, dtype=np.uint16):
    """One color everywhere."""
    return np.tile(np.array(values, dtype), (height, width, 1))


def codes(values, bits):
    """0..1 -> integers; the nearest."""
    return [round(v * (2**bits - 1)) for v in values]


# --------------------------------------------------------------------------------------------------
# ICC profiles (ICC.1:2001-04 and ICC.1:2022)


def s15(value):
    return struct.pack(">i", round(value * 65536))


def icc_curve(gamma):
    """gamma: a power, a list of 16-bit numbers, or None for a line."""
    if gamma is None:
        return b"curv\0\0\0\0" + struct.pack(">I", 0)
    if isinstance(gamma, (int, float)):
        return b"curv\0\0\0\0" + struct.pack(">IH", 1, round(gamma * 256))
    return b"curv\0\0\0\0" + struct.pack(f">I{len(gamma)}H", len(gamma), *gamma)


def icc_parametric(kind, *values):
    return b"para\0\0\0\0" + struct.pack(">HH", kind, 0) + b"".join(s15(v) for v in values)


SRGB_PARAMETRIC = icc_parametric(3, 2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)


def icc_xyz(xyz):
    return b"XYZ \0\0\0\0" + b"".join(s15(v) for v in xyz)


def icc_text(text, version):
    data = text.encode("ascii")
    if version >= 4:
        wide = text.encode("utf-16-be")
        return b"mluc\0\0\0\0" + struct.pack(">II2s2sII", 1, 12, b"en", b"US", len(wide), 28) + wide
    return b"desc\0\0\0\0" + struct.pack(">I", len(data) + 1) + data + b"\0" + bytes(8 + 3 + 67)


def icc_profile(tags, version=2, space=b"RGB ", connection=b"XYZ ", kind=b"mntr"):
    """tags: name -> data. Equal data are stored once, as most writers do."""
    tags = {b"desc": icc_text("a test profile", version), b"wtpt": icc_xyz(ICC_D50),
            b"cprt": b"text\0\0\0\0none\0" if version < 4 else icc_text("none", 4), **tags}
    table, data, seen = struct.pack(">I", len(tags)), b"", {}
    start = 128 + 4 + 12 * len(tags)
    for name, content in tags.items():
        if content not in seen:
            seen[content] = start + len(data)
            data += content + bytes(-len(content) % 4)
        table += name + struct.pack(">II", seen[content], len(content))
    header = struct.pack(">I4sI4s4s4s", start + len(data), bytes(4), {2: 0x02100000, 4: 0x04400000}[version],
                         kind, space, connection)
    header += struct.pack(">6H", 2026, 1, 1, 0, 0, 0) + b"acsp" + bytes(4 + 4 + 4 + 4 + 8 + 4)
    header += b"".join(s15(v) for v in ICC_D50)
    return header.ljust(128, b"\0") + table + data


def icc_columns(primaries):
    """RGB -> XYZ of the connection space (D50), by Bradford as ICC.1 asks."""
    if isinstance(primaries, str):
        primaries = PRIMARIES[primaries]
    return bradford(white_xyz(primaries[3]), ICC_D50) @ rgb_to_xyz(primaries)


def icc_matrix(primaries, curve, version=2, more=None):
    """A display profile of a matrix and one curve (bytes of the tag)."""
    columns = icc_columns(primaries)
    tags = {name: icc_xyz(columns[:, i]) for i, name in enumerate((b"rXYZ", b"gXYZ", b"bXYZ"))}
    tags |= {b"rTRC": curve, b"gTRC": curve, b"bTRC": curve}
    if version == 4:
        chad = bradford(white_xyz(PRIMARIES[primaries][3]), ICC_D50)
        tags[b"chad"] = b"sf32\0\0\0\0" + b"".join(s15(v) for v in chad.ravel())
    return icc_profile({**tags, **(more or {})}, version)


def icc_lut16(primaries, gamma):
    """Version 2, AToB0 of type lut16: curves, then 2 x 2 x 2 nodes of XYZ, which hold a matrix exactly."""
    columns = icc_columns(primaries)
    nodes = [columns @ np.array([r, g, b]) for r in (0, 1) for g in (0, 1) for b in (0, 1)]
    grid = [round(v * 32768) for node in nodes for v in node]
    steps = 4096
    curve = [round((i / (steps - 1)) ** gamma * 65535) for i in range(steps)]
    data = b"mft2\0\0\0\0" + bytes([3, 3, 2, 0])
    data += b"".join(s15(v) for v in np.eye(3).ravel()) + struct.pack(">HH", steps, 2)
    data += struct.pack(f">{3 * steps}H", *(curve * 3)) + struct.pack(">24H", *grid)
    data += struct.pack(">6H", 0, 65535, 0, 65535, 0, 65535)
    return icc_profile({b"A2B0": data}, 2)


def icc_lut_ab(primaries, curve):
    """Version 4, AToB0 of type lutAToB: M curves, matrix, B curves that do nothing."""
    # Numbers of the connection space are XYZ * 32768 / 65535.
    matrix = icc_columns(primaries) * 32768 / 65535
    data = b"".join(s15(v) for v in matrix.ravel()) + b"".join(s15(0) for _ in range(3))
    line = icc_curve(None)
    b_at, matrix_at = 32, 32 + 3 * len(line)
    m_at = matrix_at + len(data)
    padded = curve + bytes(-len(curve) % 4)
    body = b"mAB \0\0\0\0" + bytes([3, 3, 0, 0]) + struct.pack(">5I", b_at, matrix_at, m_at, 0, 0)
    return icc_profile({b"A2B0": body + line * 3 + data + padded * 3}, 4)


def icc_cmyk(xyz_of):
    """Version 2, AToB0 of type lut16 from CMYK: 2^4 nodes. xyz_of: (c, m, y, k) -> XYZ, linear in each."""
    grid = [round(v * 32768) for c in (0, 1) for m in (0, 1) for y in (0, 1) for k in (0, 1) for v in xyz_of(c, m, y, k)]
    data = b"mft2\0\0\0\0" + bytes([4, 3, 2, 0])
    data += b"".join(s15(v) for v in np.eye(3).ravel()) + struct.pack(">HH", 2, 2)
    data += struct.pack(">8H", *((0, 65535) * 4)) + struct.pack(f">{len(grid)}H", *grid)
    data += struct.pack(">6H", *((0, 65535) * 3))
    return icc_profile({b"A2B0": data}, 2, b"CMYK", b"XYZ ", b"prtr")


def icc_gray(curve, version=2):
    return icc_profile({b"kTRC": curve}, version, b"GRAY")


def icc_cicp(primaries, curve, numbers):
    """Version 4.4 with the tag cicp."""
    return icc_matrix(primaries, curve, 4, {b"cicp": b"cicp\0\0\0\0" + bytes(numbers)})


# --------------------------------------------------------------------------------------------------
# PNG


def png_chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def packed_rows(array, bits):
    rows = []
    for row in array.reshape(array.shape[0], -1):
        if bits == 16:
            rows.append(row.astype(">u2").tobytes())
        elif bits == 8:
            rows.append(row.astype(np.uint8).tobytes())
        else:
            flat = "".join(f"{int(v):0{bits}b}" for v in row)
            flat += "0" * (-len(flat) % 8)
            rows.append(int(flat, 2).to_bytes(len(flat) // 8, "big"))
    return rows


def png_data(array, bits):
    return zlib.compress(b"".join(b"\0" + row for row in packed_rows(array, bits)))


def png_interlaced(array, bits):
    passes = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))
    parts = [array[y::dy, x::dx] for x, y, dx, dy in passes]
    return zlib.compress(b"".join(b"\0" + row for part in parts if part.size for row in packed_rows(part, bits)))


def png(array, bits=16, chunks=(), kind=None, interlaced=False, after=()):
    """chunks: (name, data) before the pixels; kind: the color type, by the channels where it is None."""
    height, width, channels = array.shape
    kind = {1: 0, 2: 4, 3: 2, 4: 6}[channels] if kind is None else kind
    data = png_interlaced(array, bits) if interlaced else png_data(array, bits)
    out = b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, interlaced))
    for name, content in chunks:
        out += png_chunk(name, content)
    out += png_chunk(b"IDAT", data)
    for name, content in after:
        out += png_chunk(name, content)
    return out + png_chunk(b"IEND", b"")


def cicp(primaries, transfer, matrix=0, full=1):
    return b"cICP", bytes([primaries, transfer, matrix, full])


def iccp(profile):
    return b"iCCP", b"test\0\0" + zlib.compress(profile)


def gama(exponent):
    """exponent: of the encoding, 1/2.2 = 0.45455."""
    return b"gAMA", struct.pack(">I", round(exponent * 100000))


def chrm(primaries):
    red, green, blue, white = PRIMARIES[primaries] if isinstance(primaries, str) else primaries
    return b"cHRM", struct.pack(">8I", *(round(v * 100000) for xy in (white, red, green, blue) for v in xy))


# --------------------------------------------------------------------------------------------------
# TIFF 6.0


SHORT, LONG, RATIONAL, UNDEFINED, ASCII, BYTE, SRATIONAL, FLOAT = 3, 4, 5, 7, 2, 1, 10, 11
_TIFF_CODES = {BYTE: "B", ASCII: "s", SHORT: "H", LONG: "I", RATIONAL: "II", UNDEFINED: "s", SRATIONAL: "ii", FLOAT: "f"}


def tiff_value(kind, value, order="<"):
    if kind in (ASCII, UNDEFINED):
        return len(value), bytes(value)
    values = list(value) if isinstance(value, (list, tuple)) else [value]
    if kind in (RATIONAL, SRATIONAL):
        return len(values), b"".join(struct.pack(order + _TIFF_CODES[kind], round(v * 1000000), 1000000) for v in values)
    return len(values), struct.pack(order + _TIFF_CODES[kind] * len(values), *values)


def ifd(tags, at, following=0, order="<"):
    """tags: number -> (kind, value). Returns the directory that stands at an offset, and its data after it."""
    entries, data = b"", b""
    start = at + 2 + 12 * len(tags) + 4
    for number, (kind, value) in sorted(tags.items()):
        count, content = tiff_value(kind, value, order)
        if len(content) <= 4:
            field = content.ljust(4, b"\0")
        else:
            field = struct.pack(order + "I", start + len(data))
            data += content + bytes(len(content) % 2)
        entries += struct.pack(order + "HHI", number, kind, count) + field
    return struct.pack(order + "H", len(tags)) + entries + struct.pack(order + "I", following) + data


def tiff(pages, order="<"):
    """pages: (array, photometric, tags) each, or one array. uint8, uint16, int8, int16, float16, float32."""
    out = (b"II" if order == "<" else b"MM") + struct.pack(order + "HI", 42, 8)
    for i, (array, photometric, more) in enumerate(pages):
        height, width, channels = array.shape
        bits = array.dtype.itemsize * 8
        planar = more.get(284, (SHORT, 1))[1] == 2
        data = array.astype(array.dtype.newbyteorder(order))
        strips = [data[:, :, c].tobytes() for c in range(channels)] if planar else [data.tobytes()]
        tags = {256: (LONG, width), 257: (LONG, height), 258: (SHORT, [bits] * channels), 259: (SHORT, 1),
                262: (SHORT, photometric), 277: (SHORT, channels), 278: (LONG, height),
                279: (LONG, [len(strip) for strip in strips]), 273: (LONG, [0] * len(strips)), 284: (SHORT, 1),
                339: (SHORT, [{"u": 1, "i": 2, "f": 3}[array.dtype.kind]] * channels), **more}
        size = len(ifd(tags, len(out), 0, order))
        offset = len(out) + size
        tags[273] = (LONG, [offset + sum(map(len, strips[:n])) for n in range(len(strips))])
        following = offset + sum(map(len, strips)) if i + 1 < len(pages) else 0
        out += ifd(tags, len(out), following, order) + b"".join(strips)
    return out


def exif_block(tags, order="<", interoperability=None):
    """A TIFF structure with tags of IFD 0; 0xA001 and the like belong into the Exif IFD, which `tags["exif"]` holds."""
    main, sub = {k: v for k, v in tags.items() if k != "exif"}, dict(tags.get("exif", {}))
    head = (b"II" if order == "<" else b"MM") + struct.pack(order + "HI", 42, 8)
    if not sub:
        return head + ifd(main, 8, 0, order)
    main[0x8769] = (LONG, 0)
    size = len(ifd(main, 8, 0, order))
    main[0x8769] = (LONG, 8 + size)
    if interoperability:
        sub[0xA005] = (LONG, 0)
        sub[0xA005] = (LONG, 8 + size + len(ifd(sub, 8 + size, 0, order)))
    out = head + ifd(main, 8, 0, order) + ifd(sub, 8 + size, 0, order)
    if interoperability:
        out += ifd({1: (ASCII, interoperability + b"\0"), 2: (UNDEFINED, b"0100")}, len(out), 0, order)
    return out


# --------------------------------------------------------------------------------------------------
# JPEG: segments behind SOI of a file that another program has compressed


def jpeg_segment(marker, data):
    return bytes([0xFF, marker]) + struct.pack(">H", len(data) + 2) + data


def jpeg_parts(data):
    """The segments before the scan, and the rest."""
    at, parts = 2, []
    while data[at + 1] != 0xDA:
        size = struct.unpack(">H", data[at + 2:at + 4])[0]
        parts.append((data[at + 1], data[at + 4:at + 2 + size]))
        at += 2 + size
    return parts, data[at:]


def jpeg_with(data, segments, keep=lambda marker: not 0xE0 <= marker <= 0xEF):
    parts, rest = jpeg_parts(data)
    kept = [jpeg_segment(marker, content) for marker, content in parts if keep(marker)]
    return b"\xff\xd8" + b"".join(jpeg_segment(marker, content) for marker, content in segments) + b"".join(kept) + rest


JFIF = (0xE0, b"JFIF\0\x01\x01\0\0\x01\0\x01\0\0")


def jpeg_icc(profile, parts=1):
    size = -(-len(profile) // parts)
    return [(0xE2, b"ICC_PROFILE\0" + bytes([i + 1, parts]) + profile[i * size:(i + 1) * size]) for i in range(parts)]


# --------------------------------------------------------------------------------------------------
# OpenEXR, scan lines without compression


def exr_attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def exr_string(name, text):
    return exr_attribute(name, "string", text.encode())


def exr_chromaticities(primaries):
    xy = PRIMARIES[primaries] if isinstance(primaries, str) else primaries
    return exr_attribute("chromaticities", "chromaticities", struct.pack("<8f", *(v for pair in xy for v in pair)))


def exr_header(channels, window, display, attributes, part_name=None, pixel_aspect=1.0, screen=((0, 0), 1.0)):
    """channels: name -> (dtype, x sampling, y sampling)."""
    kinds = {np.dtype(np.uint32): 0, np.dtype(np.float16): 1, np.dtype(np.float32): 2}
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", kinds[np.dtype(kind)], 0, sx, sy)
                      for name, (kind, sx, sy) in sorted(channels.items())) + b"\0"
    out = exr_attribute("channels", "chlist", listed)
    out += exr_attribute("compression", "compression", b"\0")
    out += exr_attribute("dataWindow", "box2i", struct.pack("<4i", *window))
    out += exr_attribute("displayWindow", "box2i", struct.pack("<4i", *display))
    out += exr_attribute("lineOrder", "lineOrder", b"\0")
    out += exr_attribute("pixelAspectRatio", "float", struct.pack("<f", pixel_aspect))
    out += exr_attribute("screenWindowCenter", "v2f", struct.pack("<2f", *screen[0]))
    out += exr_attribute("screenWindowWidth", "float", struct.pack("<f", screen[1]))
    if part_name is not None:
        out += exr_string("name", part_name) + exr_string("type", "scanlineimage")
        out += exr_attribute("chunkCount", "int", struct.pack("<i", window[3] - window[1] + 1))
    return out + b"".join(attributes) + b"\0"


def exr_lines(planes, window):
    """One block of bytes for each row; sub-sampled channels have rows in some of them only."""
    lines = []
    for y in range(window[1], window[3] + 1):
        line = b""
        for _name, (array, step) in sorted(planes.items()):
            if y % step == 0:
                line += array[(y - window[1]) // step].tobytes()
        lines.append(line)
    return lines


def exr(parts, display=None, long_names=False):
    """parts: one or more of {planes: name -> array (or (array, step)), window, attributes, name, more of exr_header}."""
    several = len(parts) > 1
    version = 2 | (0x1000 if several else 0) | (0x400 if long_names else 0)
    out = struct.pack("<II", 20000630, version)
    described = []
    for part in parts:
        planes = {name: value if isinstance(value, tuple) else (value, 1) for name, value in part["planes"].items()}
        height, width = max((array.shape for array, step in planes.values() if step == 1))
        window = part.get("window") or (0, 0, width - 1, height - 1)
        channels = {name: (array.dtype, step, step) for name, (array, step) in planes.items()}
        out += exr_header(channels, window, display or window, part.get("attributes", ()),
                          part.get("name", "part") if several else None, part.get("pixel_aspect", 1.0),
                          part.get("screen", ((0, 0), 1.0)))
        described.append((exr_lines(planes, window), window))
    if several:
        out += b"\0"
    at = len(out) + 8 * sum(len(lines) for lines, _window in described)
    tables, data = b"", b""
    for number, (lines, window) in enumerate(described):
        for i, line in enumerate(lines):
            tables += struct.pack("<Q", at + len(data))
            data += (struct.pack("<i", number) if several else b"") + struct.pack("<ii", window[1] + i, len(line)) + line
    return out + tables + data


def exr_rgb(rgb, attributes=(), dtype=np.float32, width=8, height=8, alpha=None, **more):
    planes = {name: np.full((height, width), value, dtype) for name, value in zip("RGB", rgb)}
    if alpha is not None:
        planes["A"] = np.full((height, width), alpha, dtype)
    return exr([{"planes": planes, "attributes": attributes, **more}])


# --------------------------------------------------------------------------------------------------
# Radiance


def rgbe(rgb):
    """Four bytes of a color: the value that they hold is (m / 256) * 2^(e - 128)."""
    largest = max(rgb)
    if largest < 1e-32:
        return bytes(4)
    exponent = int(np.floor(np.log2(largest))) + 1
    scale = 256 / 2.0**exponent
    return bytes([min(int(v * scale), 255) for v in rgb] + [exponent + 128])


def rgbe_value(data):
    return np.array([m / 256 * 2.0 ** (data[3] - 128) for m in data[:3]])


def radiance(rows, header=(), orientation=None, kind="rgbe", old_rle=False):
    """rows: lists of four bytes, as they stand in the file; header: lines."""
    height, width = len(rows), len(rows[0])
    orientation = orientation or f"-Y {height} +X {width}"
    head = "".join(f"{line}\n" for line in ("#?RADIANCE", *header, f"FORMAT=32-bit_rle_{kind}", "", orientation))
    if not old_rle:
        return head.encode("latin-1") + b"".join(b"".join(row) for row in rows)
    body = b""
    for row in rows:  # one pixel, and then runs of it: the form before 1991
        body += row[0] + bytes([1, 1, 1, width - 1])
    return head.encode("latin-1") + body


# --------------------------------------------------------------------------------------------------
# DPX (SMPTE ST 268-1) and Cineon


def dpx_samples(array, bits, packing="A"):
    """Rows of RGB as 8, 16 or 10 bits in 32-bit words, big endian."""
    if bits == 8:
        return b"".join(row.astype(np.uint8).tobytes().ljust(-(-row.size // 4) * 4, b"\0") for row in array)
    if bits == 16:
        return b"".join(row.astype(">u2").tobytes().ljust(-(-row.size * 2 // 4) * 4, b"\0") for row in array)
    shifts = (22, 12, 2) if packing == "A" else (20, 10, 0)
    out = b""
    for row in array:
        for pixel in row:
            out += struct.pack(">I", sum(int(v) << s for v, s in zip(pixel, shifts)))
    return out


def dpx(array, bits=10, transfer=0, colorimetric=0, reference=None, orientation=0, packing="A", descriptor=50, gamma=None,
        magic=b"SDPX"):
    """reference: (low data, low quantity, high data, high quantity) or None for undefined."""
    height, width = array.shape[:2]
    data = dpx_samples(array, bits, packing)
    undefined = 0xFFFFFFFF
    head = bytearray(b"\xff" * 2048)
    struct.pack_into(">4sI8sIIIII", head, 0, magic, 2048, b"V1.0\0\0\0\0", 2048 + len(data), 1, 1664, 384, 0)
    head[36:660 + 104] = bytes(660 + 104 - 36)
    struct.pack_into(">I", head, 660, undefined)  # not encrypted
    struct.pack_into(">HHII", head, 768, orientation, 1, width, height)
    low, low_quantity, high, high_quantity = reference or (undefined, None, undefined, None)
    element = struct.pack(">II", 0, low)
    element += struct.pack(">f", low_quantity) if low_quantity is not None else struct.pack(">I", undefined)
    element += struct.pack(">I", high)
    element += struct.pack(">f", high_quantity) if high_quantity is not None else struct.pack(">I", undefined)
    method = {"A": 1, "B": 2}[packing] if bits == 10 else 0
    element += struct.pack(">BBBBHHIII", descriptor, transfer, colorimetric, bits, method, 0, 2048, 0, 0)
    head[780:780 + 72] = element.ljust(72, b"\0")
    for i in range(1, 8):
        head[780 + 72 * i:780 + 72 * (i + 1)] = b"\xff" * 40 + bytes(32)
    # Orientation and file information: offsets, sizes and texts that are not given.
    head[1432:1664] = bytes(100 + 24 + 32 + 32).rjust(232, b"\0")
    head[1664:1920] = b"\xff" * 256
    head[1920:2048] = b"\xff" * 128
    for start, size in ((1664, 48), (1732, 132), (1920, 8)):
        head[start:start + size] = bytes(size)
    if gamma is not None:
        struct.pack_into(">f", head, 1920 + 28, gamma)
    if magic == b"XPDS":
        raise ValueError("little endian is not written here")
    return bytes(head) + data


def cineon(array):
    """10 bits, RGB, printing density; Kodak's Cineon format 4.5."""
    height, width = array.shape[:2]
    head = bytearray(2048)
    data = dpx_samples(array, 10)
    struct.pack_into(">IIIIII8s", head, 0, 0x802A5FD7, 1024 + 1024, 1024, 1024, 0, 2048 + len(data), b"V4.5\0\0\0\0")
    struct.pack_into(">BBxx", head, 192, 0, 3)
    for i in range(3):
        struct.pack_into(">BBBxIIffff", head, 196 + 28 * i, 0, i + 1, 10, width, height, 0.0, 0.0, 1023.0, 2.046)
    undefined = 0x7F800000
    for at in range(420, 420 + 32, 4):  # white point and primaries
        struct.pack_into(">I", head, at, undefined)
    struct.pack_into(">BBBBII", head, 680, 0, 5, 0, 0, 0, 0)
    return bytes(head) + data


# --------------------------------------------------------------------------------------------------
# TGA, BMP, SGI, PNM, PFM, PSD, FITS, ICO, DDS, GIF


def tga(array, gamma=None, attributes=None, descriptor=0x20, kind=2):
    """8 bits; gamma: (numerator, denominator) of the extension area; attributes: type of its alpha."""
    height, width, channels = array.shape
    alpha = 8 if channels == 4 else 0
    order = [2, 1, 0, 3][:channels] if channels > 2 else [0]
    out = struct.pack("<BBBHHBHHHHBB", 0, 0, kind, 0, 0, 0, 0, 0, width, height, 8 * channels, descriptor | alpha)
    out += array[:, :, order].astype(np.uint8).tobytes()
    if gamma is not None or attributes is not None:
        at = len(out)
        area = bytearray(495)
        struct.pack_into("<H", area, 0, 495)
        struct.pack_into("<HH", area, 478, *(gamma or (0, 0)))
        area[494] = attributes or 0
        out += bytes(area) + struct.pack("<II", at, 0) + b"TRUEVISION-XFILE.\0"
    return out


def bmp(array, version=3, primaries=None, gammas=None, profile=None, space=None, intent=4, down=False):
    """24 bits. version 3, 4 or 5 of the header; space: bV5CSType."""
    height, width = array.shape[:2]
    rows = array[:, :, ::-1].astype(np.uint8)
    data = b"".join(row.tobytes() + bytes(-row.size % 4) for row in (rows if down else rows[::-1]))
    size = {3: 40, 4: 108, 5: 124}[version]
    head = struct.pack("<IiiHHIIiiII", size, width, -height if down else height, 1, 24, 0, len(data), 2835, 2835, 0, 0)
    if version > 3:
        ends = b""
        if primaries:
            *colors, white = PRIMARIES[primaries]
            matrix = rgb_to_xyz(PRIMARIES[primaries])
            ends = b"".join(struct.pack("<i", round(v * 2**30)) for v in matrix.T.ravel())
        head += bytes(16) + struct.pack("<I", space) + ends.ljust(36, b"\0")
        head += struct.pack("<3I", *(round(g * 65536) for g in gammas)) if gammas else bytes(12)
    if version == 5:
        head += struct.pack("<IIII", intent, size + len(data) if profile else 0, len(profile or b""), 0)
    start = 14 + size
    return b"BM" + struct.pack("<IHHI", start + len(data) + len(profile or b""), 0, 0, start) + head + data + (profile or b"")


def sgi(array, bytes_per_channel=1):
    height, width, channels = array.shape
    head = struct.pack(">HBBHHHHIII80sI", 474, 0, bytes_per_channel, 3, width, height, channels, 0,
                       256**bytes_per_channel - 1, 0, b"", 0).ljust(512, b"\0")
    kind = np.uint8 if bytes_per_channel == 1 else np.dtype(">u2")
    return head + b"".join(array[::-1, :, c].astype(kind).tobytes() for c in range(channels))


def pnm(kind, array, largest=255, text=False):
    height, width = array.shape[:2]
    head = f"P{kind}\n{width} {height}\n" + ("" if kind in (1, 4) else f"{largest}\n")
    if text:
        return (head + "\n".join(" ".join(str(int(v)) for v in row.ravel()) for row in array) + "\n").encode()
    if kind == 4:
        return head.encode() + b"".join(packed_rows(array, 1))
    return head.encode() + array.astype(">u2" if largest > 255 else np.uint8).tobytes()


def pam(array, largest=255, tuple_type="RGB"):
    height, width, channels = array.shape
    head = f"P7\nWIDTH {width}\nHEIGHT {height}\nDEPTH {channels}\nMAXVAL {largest}\nTUPLTYPE {tuple_type}\nENDHDR\n"
    return head.encode() + array.astype(">u2" if largest > 255 else np.uint8).tobytes()


def pfm(array, scale=-1.0, order=None):
    """Rows from bottom to top; the sign of the scale says the order of bytes."""
    height, width, channels = array.shape
    head = f"{'PF' if channels == 3 else 'Pf'}\n{width} {height}\n{scale}\n"
    return head.encode() + array[::-1].astype(("<" if scale < 0 else ">") + "f4").tobytes()


def psd(array, mode=3, bits=8, resources=()):
    """mode: 1 gray, 3 RGB, 4 CMYK (inverted), 9 Lab; resources: (number, data)."""
    height, width, channels = array.shape
    block = b""
    for number, data in resources:
        block += b"8BIM" + struct.pack(">H", number) + b"\0\0" + struct.pack(">I", len(data)) + data + bytes(len(data) % 2)
    out = struct.pack(">4sH6xHIIHH", b"8BPS", 1, channels, height, width, bits, mode)
    out += struct.pack(">I", 0) + struct.pack(">I", len(block)) + block + struct.pack(">I", 0) + struct.pack(">H", 0)
    kind = {8: ">u1", 16: ">u2", 32: ">f4"}[bits]
    return out + b"".join(array[:, :, c].astype(kind).tobytes() for c in range(channels))


def fits(array, cards=(), kind=">f4", bitpix=-32):
    """Planes; the first row is the bottom one."""
    height, width, channels = array.shape
    listed = [("SIMPLE", "T"), ("BITPIX", bitpix), ("NAXIS", 3 if channels > 1 else 2), ("NAXIS1", width), ("NAXIS2", height)]
    if channels > 1:
        listed.append(("NAXIS3", channels))
    text = "".join(f"{name:8}= {value!s:>20}".ljust(80) for name, value in [*listed, *cards]) + "END".ljust(80)
    data = b"".join(array[::-1, :, c].astype(kind).tobytes() for c in range(channels))
    return text.ljust(-(-len(text) // 2880) * 2880).encode() + data + bytes(-len(data) % 2880)


def ico(pictures):
    """pictures: (width, height, PNG data)."""
    out, at = struct.pack("<HHH", 0, 1, len(pictures)), 6 + 16 * len(pictures)
    for width, height, data in pictures:
        out += struct.pack("<BBBBHHII", width % 256, height % 256, 0, 0, 1, 32, len(data), at)
        at += len(data)
    return out + b"".join(data for _width, _height, data in pictures)


def dds(array, dxgi=None, data=None, flags=0x40, pitch_bits=32):
    """8-bit RGBA, or data of a DXGI format; other headers have no field of color."""
    height, width = array.shape[:2]
    masks = (0xFF, 0xFF00, 0xFF0000, 0xFF000000)
    if dxgi is None:
        form = struct.pack("<II4sI4I", 32, 0x41, b"\0\0\0\0", 32, *masks)
    else:
        form = struct.pack("<II4sI4I", 32, 4, b"DX10", 0, 0, 0, 0, 0)
    head = struct.pack("<4sIIIIIII44s", b"DDS ", 124, 0x1007, height, width, 0, 0, 0, b"") + form
    head += struct.pack("<5I", 0x1000, 0, 0, 0, 0)
    if dxgi is not None:
        head += struct.pack("<5I", dxgi, 3, 0, 1, 0)
    return head + (array.astype(np.uint8).tobytes() if data is None else data)


def gif(frames, colors, width=8, height=8, delay=10):
    """frames: indices (0..3), each filling the picture; colors: up to four of 8 bits. Codes are not compressed."""
    table = b"".join(bytes(c) for c in colors).ljust(12, b"\0")
    out = b"GIF89a" + struct.pack("<HHBBB", width, height, 0xF1, 0, 0) + table
    if len(frames) > 1:
        out += b"\x21\xff\x0bNETSCAPE2.0\x03\x01\0\0\0"
    for index in frames:
        if len(frames) > 1:
            out += b"\x21\xf9\x04\x04" + struct.pack("<H", delay) + b"\0\0"
        out += b"\x2c" + struct.pack("<HHHHB", 0, 0, width, height, 0) + b"\x02"
        # A clear code before every second pixel keeps all codes at three bits.
        bits, count = "", 0
        for n in range(width * height):
            if n % 2 == 0:
                bits = "100" + bits
            bits = f"{index:03b}" + bits
            count += 1
        bits = "101" + bits
        bits = "0" * (-len(bits) % 8) + bits
        data = int(bits, 2).to_bytes(len(bits) // 8, "little")
        for i in range(0, len(data), 255):
            out += bytes([len(data[i:i + 255])]) + data[i:i + 255]
        out += b"\0"
    return out + b"\x3b"


# --------------------------------------------------------------------------------------------------
# WebP: a container around a lossless stream that another program has compressed


def webp_chunks(data):
    at, parts = 12, []
    while at + 8 <= len(data):
        name, size = data[at:at + 4], struct.unpack("<I", data[at + 4:at + 8])[0]
        parts.append((name, data[at + 8:at + 8 + size]))
        at += 8 + size + size % 2
    return parts


def riff(parts):
    body = b"WEBP" + b"".join(name + struct.pack("<I", len(data)) + data + bytes(len(data) % 2) for name, data in parts)
    return b"RIFF" + struct.pack("<I", len(body)) + body


def webp_with(data, width, height, profile=None, exif=None, animated=False):
    stream = [part for part in webp_chunks(data) if part[0] in (b"VP8L", b"VP8 ")]
    flags = (0x20 if profile else 0) | (0x08 if exif else 0) | (0x02 if animated else 0)
    size = (width - 1).to_bytes(3, "little") + (height - 1).to_bytes(3, "little")
    parts = [(b"VP8X", bytes([flags, 0, 0, 0]) + size)]
    if profile:
        parts.append((b"ICCP", profile))
    if animated:
        frame = bytes(6) + size + (100).to_bytes(3, "little") + b"\x02"
        name, content = stream[0]
        inner = name + struct.pack("<I", len(content)) + content + bytes(len(content) % 2)
        parts += [(b"ANIM", bytes(6)), (b"ANMF", frame + inner), (b"ANMF", frame + inner)]
    else:
        parts += stream
    if exif:
        parts.append((b"EXIF", exif))
    return riff(parts)


# --------------------------------------------------------------------------------------------------
# Boxes of JPEG 2000, HEIF and AVIF


def replace_box(data, name, content):
    """The first box of a name, with other content of any size if it is the box of a JP2 header; else of equal size."""
    at = data.index(name) - 4
    size = struct.unpack(">I", data[at:at + 4])[0]
    box = struct.pack(">I", 8 + len(content)) + name + content
    out = bytearray(data[:at] + box + data[at + size:])
    grown = len(box) - size
    if grown:
        for outer in (b"jp2h",):
            start = out.index(outer) - 4
            struct.pack_into(">I", out, start, struct.unpack(">I", out[start:start + 4])[0] + grown)
    return bytes(out)


def nclx(primaries, transfer, matrix, full):
    return b"nclx" + struct.pack(">HHHB", primaries, transfer, matrix, 0x80 if full else 0)
