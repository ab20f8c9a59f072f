# SPDX-License-Identifier: Apache-2.0
"""Pictures that declare 100000 x 100000 pixels in a few bytes are refused before they take memory; 1 GiB is enough.

Every run has an address space of 1 GiB. A picture that is too large gives one line, exit 3, and no file. The memory includes
this process's own: what it holds before exec counts as that of the program that it becomes.
"""

import os
import resource
import struct
import subprocess
import zlib

import pytest

ADDRESS_SPACE = 1 << 30
# The libraries that readers of pictures need take 90 MB, the thread pools and the tables of a reader some more.
PEAK_BYTES = 300 << 20
SIDE = 100_000


def exr(side, tile=0):
    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    channels = b"".join(name + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, side - 1, side - 1)
    header = [attribute("channels", "chlist", channels), attribute("compression", "compression", b"\3"),
              attribute("dataWindow", "box2i", window), attribute("displayWindow", "box2i", window),
              attribute("lineOrder", "lineOrder", b"\0"), attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
              attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
              attribute("screenWindowWidth", "float", struct.pack("<f", 1))]
    if tile:
        header.append(attribute("tiles", "tiledesc", struct.pack("<IIB", tile, tile, 0)))
    version = 2 | (0x200 if tile else 0)
    return struct.pack("<ii", 20000630, version) + b"".join(header) + b"\0" + bytes(800)


def png(side, interlace=0):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, interlace)) +
            chunk(b"IDAT", zlib.compress(bytes(1000))) + chunk(b"IEND", b""))


def tiff(side, tile=0):
    entries = [(256, 4, 1, side), (257, 4, 1, side), (258, 3, 1, 8), (259, 3, 1, 8), (262, 3, 1, 1), (277, 3, 1, 1)]
    if tile:
        entries += [(322, 4, 1, tile), (323, 4, 1, tile), (324, 4, 1, 8), (325, 4, 1, 8)]
    else:
        entries += [(273, 4, 1, 8), (278, 4, 1, side), (279, 4, 1, 8)]
    directory = struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *e) for e in sorted(entries)) + bytes(4)
    return struct.pack("<2sHI", b"II", 42, 16) + zlib.compress(b"")[:8].ljust(8, b"\0") + directory + bytes(500)


def dpx(side):
    header = bytearray(2048)
    struct.pack_into(">4sI8sI", header, 0, b"SDPX", 2048, b"V1.0", 2048)
    struct.pack_into(">II", header, 24, 1664, 384)
    struct.pack_into(">HHII", header, 768, 0, 1, side, side)
    struct.pack_into(">BBBBHHII", header, 800, 50, 2, 2, 10, 1, 0, 2048, 0)
    return bytes(header)


def cineon(side):
    header = bytearray(1024)
    struct.pack_into(">IIIII", header, 0, 0x802A5FD7, 1024, 1024, 0, 1024)
    header[193] = 3
    for channel in range(3):
        struct.pack_into(">BBBBII", header, 196 + 28 * channel, 0, channel + 1, 10, 0, side, side)
    header[680:684] = bytes([0, 5, 0, 0])
    return bytes(header)


def dds(side, four_cc=b""):
    pixel_format = struct.pack("<II4s5I", 32, 4 if four_cc else 0x40, four_cc or bytes(4), 24, 0xFF0000, 0xFF00, 0xFF, 0)
    return (b"DDS " + struct.pack("<7I", 124, 0x1007, side, side, 0, 0, 0) + bytes(44) + pixel_format +
            struct.pack("<5I", 0x1000, 0, 0, 0, 0) + bytes(800))


def bmp(side):
    return struct.pack("<2sIHHI", b"BM", 1000, 0, 0, 54) + struct.pack("<IiiHHIIiiII", 40, side, side, 1, 24, 0, 0, 0, 0, 0, 0) + bytes(800)


def psb(side):
    return (struct.pack(">4sH6xHIIHH", b"8BPS", 2, 3, side, side, 8, 3) + struct.pack(">II", 0, 0) + struct.pack(">Q", 0) +
            struct.pack(">H", 1) + bytes(800))


def jpeg(side):
    tables = b"\xff\xdb" + struct.pack(">HB", 67, 0) + bytes([1] * 64)
    frame = b"\xff\xc0" + struct.pack(">HBHHB", 17, 8, side, side, 3) + bytes([1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0])
    codes = b"".join(b"\xff\xc4" + struct.pack(">HB", 20, kind) + bytes([1] + [0] * 15) + b"\0" for kind in (0, 0x10))
    scan = b"\xff\xda" + struct.pack(">HB", 12, 3) + bytes([1, 0, 2, 0, 3, 0, 0, 63, 0])
    return b"\xff\xd8" + tables + frame + codes + scan + bytes(300) + b"\xff\xd9"


def jpeg2000(side):
    size = struct.pack(">HIIIIIIIIH", 0, side, side, 0, 0, side, side, 0, 0, 3) + bytes([7, 1, 1]) * 3
    style = bytes([0, 0, 0, 1, 0, 5, 4, 4, 0, 1])
    steps = bytes([0x40]) + bytes([0x40] * 16)
    code = b"\xff\x4f" + b"".join(marker + struct.pack(">H", len(body) + 2) + body for marker, body in (
        (b"\xff\x51", size), (b"\xff\x52", style), (b"\xff\x5c", steps)))
    part = b"\xff\x90" + struct.pack(">HHIBB", 10, 0, 0, 0, 1) + b"\xff\x93" + bytes(300) + b"\xff\xd9"

    def box(kind, body):
        return struct.pack(">I", len(body) + 8) + kind + body

    image = box(b"ihdr", struct.pack(">IIHBBBB", side, side, 3, 7, 7, 0, 0)) + box(b"colr", struct.pack(">BBBI", 1, 0, 0, 16))
    return (box(b"jP  ", b"\r\n\x87\n") + box(b"ftyp", b"jp2 " + bytes(4) + b"jp2 ") + box(b"jp2h", image) +
            box(b"jp2c", code + part))


def fits(side):
    cards = ["SIMPLE  =                    T", "BITPIX  =                    8", "NAXIS   =                    2",
             f"NAXIS1  = {side:20d}", f"NAXIS2  = {side:20d}", "END"]
    return "".join(card.ljust(80) for card in cards).ljust(2880).encode()


def rla(side):
    header = bytearray(740)
    struct.pack_into(">4h4h", header, 0, 0, side - 1, side - 1, 0, 0, side - 1, side - 1, 0)
    struct.pack_into(">7h", header, 16, 0, 0, 3, 0, 0, 0, -2)
    struct.pack_into(">h", header, 656, 8)
    return bytes(header) + bytes(260)


def gif(side):
    return (struct.pack("<6sHHBBB", b"GIF89a", side, side, 0x80, 0, 0) + bytes(6) + b"," +
            struct.pack("<HHHHB", 0, 0, side, side, 0) + b"\2\2L\1\0;" + bytes(300))


def softimage(side):
    return (struct.pack(">If80s4sHHfHH", 0x5380F634, 3.71, b"", b"PICT", side, side, 1.0, 3, 0) +
            bytes([0, 8, 2, 0xE0]) + bytes(300))


def iff(side):
    head = struct.pack(">IIHHIHHIII", side, side, 1, 1, 0, 0, 1, 0, 0, 0)
    body = b"CIMG" + b"TBHD" + struct.pack(">I", len(head)) + head + b"FOR4" + struct.pack(">I", 300) + b"TBMP" + bytes(296)
    return b"FOR4" + struct.pack(">I", len(body)) + body


SHORT_SIDE = 65_535  # where a format has 16 bits for it
BOMBS = {
    "lines.exr": exr(SIDE),
    "tiles.exr": exr(SIDE, 64),
    "tiles_of_one_pixel.exr": exr(SIDE, 1),
    "one_tile.exr": exr(SIDE, SIDE),
    "lines.png": png(SIDE),
    "interlaced.png": png(SIDE, 1),
    "strip.tif": tiff(SIDE),
    "tile.tif": tiff(SIDE, 65_536),
    "lines.dpx": dpx(SIDE),
    "lines.cin": cineon(SIDE),
    "lines.hdr": f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {SIDE} +X {SIDE}\n".encode() + bytes(500),
    "plain.dds": dds(SIDE),
    "blocks.dds": dds(SIDE, b"DXT1"),
    "bytes.ppm": f"P6 {SIDE} {SIDE} 255\n".encode() + bytes(500),
    "text.ppm": f"P3 {SIDE} {SIDE} 255\n".encode() + b"0 " * 250,
    "floats.pfm": f"PF\n{SIDE} {SIDE}\n-1.0\n".encode() + bytes(500),
    "plain.tga": struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, SHORT_SIDE, SHORT_SIDE, 24, 0) + bytes(500),
    "runs.tga": struct.pack("<BBBHHBHHHHBB", 0, 0, 10, 0, 0, 0, 0, 0, SHORT_SIDE, SHORT_SIDE, 24, 0) + b"\xff" * 500,
    "lines.bmp": bmp(SIDE),
    "lines.sgi": struct.pack(">HBBHHHHII", 474, 0, 1, 3, SHORT_SIDE, SHORT_SIDE, 3, 0, 255).ljust(1000, b"\0"),
    "runs.sgi": struct.pack(">HBBHHHHII", 474, 1, 1, 3, SHORT_SIDE, SHORT_SIDE, 3, 0, 255).ljust(1000, b"\0"),
    "layers.psb": psb(SIDE),
    "baseline.jpg": jpeg(65_500),
    "plain.jp2": jpeg2000(SIDE),
    "plain.fits": fits(SIDE),
    "lines.rla": rla(32_767),
    "frame.gif": gif(SHORT_SIDE),
    "plain.pic": softimage(SHORT_SIDE),
    "tiles.iff": iff(SIDE),
}


class Limits:
    def __init__(self, report, command, folder):
        self.report, self.command, self.folder = report, command, folder

    def run(self, *arguments):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        process = subprocess.Popen([self.command, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, preexec_fn=limit)
        said = process.stderr.read().decode("utf-8", "replace")
        process.stderr.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        return process.returncode, said, usage.ru_maxrss * 1024

    def refused(self, what, arguments, words=""):
        """One line, exit 3, and no file."""
        code, said, peak = self.run(*arguments)
        new = [path.name for path in self.folder.glob("*out*")]
        self.report.check(what, code == 3 and said.count("\n") == 1 and words in said and not new and peak < PEAK_BYTES,
                   f"exit {code}, {peak >> 20} MiB, {new}: {said[:300]}")

    def accepted(self, what, *arguments):
        code, said, _ = self.run(*arguments)
        self.report.check(what, code == 0, f"exit {code}: {said[:300]}")


@pytest.fixture(scope="module")
def folder(folder):
    """With all bombs."""
    for name, contents in BOMBS.items():
        (folder / name).write_bytes(contents)
    return folder


@pytest.fixture
def limits(report, command, folder):
    made = Limits(report, command, folder)
    if not (folder / "good.cube").exists():
        made.accepted("chart", "chart", "-o", "good.exr", "--width", "320", "--height", "180")
        made.accepted("bake", "bake", "clamp", "--format", "cube", "-q", "-o", "good.cube")
    return made


@pytest.mark.parametrize("bomb", BOMBS)
def test_bomb(report, limits, bomb):
    report.check(f"{bomb} is small", len(BOMBS[bomb]) <= 3000, len(BOMBS[bomb]))
    limits.refused(f"meter {bomb}", ["meter", bomb], bomb)
    limits.refused(f"apply {bomb}", ["apply", bomb, "out.png", "--operator", "clamp", "-q"], bomb)


@pytest.mark.parametrize("bomb", ["lines.hdr", "lines.png", "strip.tif"])
def test_commands(limits, bomb):
    words = f"{bomb}: cannot read: it declares {SIDE} x {SIDE} pixels; expected at most 1000000000"
    limits.refused(f"{bomb}: the line", ["meter", bomb], words)
    for what, arguments in {
        "apply --lut": ["apply", bomb, "out.png", "--lut", "good.cube", "-q"],
        "apply of a local operator": ["apply", bomb, "out.png", "--operator", "reinhard_local", "-q"],
        "compare": ["compare", bomb, "clamp", "-o", "out.png", "-q"],
        "report": ["report", bomb, "--operators", "clamp", "--no-parity", "-o", "out.html", "-q"],
        "sheet": ["sheet", f"a={bomb}", "-o", "out.png", "-q"],
    }.items():
        limits.refused(f"{what} {bomb}", arguments, words)
    limits.refused(f"{bomb} as a LUT", ["apply", "good.exr", "out.png", "--lut", bomb, "-q"], bomb)


def test_max_pixels(report, limits):
    """The limit counts pixels: 320 x 180 = 57600."""
    for what, arguments in {
        "apply": ["apply", "good.exr", "kept.png", "--operator", "clamp", "-q"],
        "apply --lut": ["apply", "good.exr", "kept.png", "--lut", "good.cube", "--input-encoding", "none", "-q"],
        "meter": ["meter", "good.exr"],
        "compare": ["compare", "good.exr", "clamp", "-o", "kept.png", "-q"],
        "report": ["report", "good.exr", "--operators", "clamp", "--no-parity", "-o", "kept.html", "-q"],
        "sheet": ["sheet", "a=good.exr", "-o", "kept.png", "-q"],
    }.items():
        limits.accepted(f"{what} --max-pixels 57600", *arguments, "--max-pixels", "57600")
        refused = [argument.replace("kept", "out") for argument in arguments]
        limits.refused(f"{what} --max-pixels 57599", [*refused, "--max-pixels", "57599"], "expected at most 57599 in all")
    (limits.folder / "shot.0001.exr").write_bytes((limits.folder / "good.exr").read_bytes())
    code, said, _ = limits.run("apply", "shot.#.exr", "out.#.png", "--frames", "1", "--operator", "clamp", "-q", "--max-pixels", "57599")
    report.check("frames", code == 1 and "expected at most 57599" in said, said)


@pytest.mark.parametrize("extension", ["exr", "png", "tif", "dpx", "hdr", "jpg", "tga", "bmp", "sgi", "ppm", "webp", "jp2"])
def test_picture(limits, extension):
    """What is no bomb is read in 1 GiB."""
    limits.accepted(f"write {extension}", "apply", "good.exr", f"good.{extension}", "--operator", "clamp", "--alpha", "ignore", "-q",
                    "--in-place")
    limits.accepted(f"read {extension}", "meter", f"good.{extension}")


@pytest.mark.parametrize("extension", ["cube", "csp", "3dl", "spi3d", "clf", "ctf", "icc", "png"])
def test_lut(limits, extension):
    limits.accepted(f"bake {extension}", "bake", "clamp", "--format", "hald" if extension == "png" else extension, "-q", "-o",
                    f"lut.{extension}")
    if extension != "icc":
        limits.accepted(f"LUT {extension}", "apply", "good.exr", "kept.png", "--lut", f"lut.{extension}", "--input-encoding", "none",
                        "-q")
