# SPDX-License-Identifier: Apache-2.0
"""ICC device links of `tonewright bake` through LittleCMS's tificc, and through ImageMagick where it is installed.

    python3 tests/parity/clients/test_tificc.py build/release/bin/tonewright

Pictures of 16 bits, uncompressed; what comes out is compared with NumPy's tetrahedral interpolation of the nodes that
`bake --format raw` writes, and with the operator. The last line is `N passed, M failed`.
"""

import argparse
import json
import shutil
import struct
import tempfile
from pathlib import Path

import numpy as np

from pictures import Report, evaluate, need_program, run
from test_ffmpeg import tetrahedral

# LittleCMS interpolates in 16 bits: half a step of its own on top of the nodes' half.
SIXTEEN_BITS = 2.5e-5
OPERATOR = ("agx_blender", "--look", "punchy")  # no channel is like another


def write_tiff(path, codes):
    """An uncompressed RGB TIFF of 16 bits, (height, width, 3)."""
    height, width, _ = codes.shape
    data = codes.astype("<u2").tobytes()
    entries = [(256, 3, 1, width), (257, 3, 1, height), (258, 3, 3, 8), (259, 3, 1, 1), (262, 3, 1, 2), (273, 4, 1, 14),
               (277, 3, 1, 3), (278, 3, 1, height), (279, 4, 1, len(data)), (284, 3, 1, 1)]
    directory = struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *e) for e in entries) + bytes(4)
    Path(path).write_bytes(struct.pack("<2sHI", b"II", 42, 14 + len(data)) + struct.pack("<3H", 16, 16, 16) + data + directory)


def read_tiff(path):
    """What LittleCMS and ImageMagick write of it: strips, uncompressed, either byte order."""
    data = Path(path).read_bytes()
    order = "<" if data[:2] == b"II" else ">"
    at, = struct.unpack_from(order + "I", data, 4)
    count, = struct.unpack_from(order + "H", data, at)
    tags = {}
    for i in range(count):
        tag, kind, number = struct.unpack_from(order + "HHI", data, at + 2 + 12 * i)
        code = {1: "B", 3: "H", 4: "I"}.get(kind)
        if not code:
            continue
        size = struct.calcsize(code) * number
        where = at + 10 + 12 * i if size <= 4 else struct.unpack_from(order + "I", data, at + 10 + 12 * i)[0]
        tags[tag] = struct.unpack_from(f"{order}{number}{code}", data, where)
    if tags.get(259, (1,))[0] != 1 or tags[258][:3] != (16, 16, 16):
        raise ValueError(f"{path}: not 16 bits, uncompressed")
    pixels = b"".join(data[start:start + length] for start, length in zip(tags[273], tags[279]))
    # tificc's last strip is as long as the others, whatever is left.
    shape = tags[257][0], tags[256][0], tags[277][0]
    return np.frombuffer(pixels, order + "u2")[:np.prod(shape)].reshape(shape)[..., :3].astype(float)


def check_link(report, command, folder, version, encoding, space, picture):
    link, raw = folder / f"v{version}.icc", folder / "nodes.raw"
    bake = (command, "bake", *OPERATOR, "--nodes", "sampled", "--size", 33, "--3d", "--input-encoding", encoding)
    run(*bake, "--format", "icc", "--icc-version", version, "-o", link)
    run(*bake, "--format", "raw", "-o", raw)
    nodes = np.round(np.clip(np.fromfile(raw, "<f4").reshape(33, 33, 33, 3), 0, 1) * 65535.0) / 65535
    codes = picture.reshape(-1, 3) / 65535
    expected = tetrahedral(nodes, codes)
    write_tiff(folder / "in.tif", picture)
    clients = {"tificc": ("tificc", "-l", link, "-c", 0, "-w", 16, folder / "in.tif", folder / "out.tif")}
    if shutil.which("convert"):
        clients["ImageMagick"] = ("convert", folder / "in.tif", "-profile", link, "-depth", 16, "-compress", "none", "+profile",
                                  "*", folder / "out.tif")
    for client, arguments in clients.items():
        run(*arguments)
        shown = read_tiff(folder / "out.tif").reshape(-1, 3) / 65535
        report.compare(f"{client}: device link v{version}, {encoding}", shown, expected, SIXTEEN_BITS)
    # And the same as the program itself makes of it.
    text = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in codes[:2000].tolist())
    own = np.array(run(command, "eval", "--lut", link, stdin=text).split(), float).reshape(-1, 3)
    report.compare(f"eval --lut: device link v{version}, {encoding}", own, expected[:2000], SIXTEEN_BITS)
    return shown


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    command = parser.parse_args().command.resolve()
    need_program("tificc", "liblcms2-utils")
    report = Report()
    random = np.random.default_rng(3)
    picture = random.integers(0, 65536, (128, 256, 3))
    picture[0, :, :] = (np.arange(256) * 257)[:, None]  # greys
    with tempfile.TemporaryDirectory(prefix="tonewright-") as name:
        folder = Path(name)
        for version in (2, 4):
            for encoding, space in (("acescct", "lin_ap1"), ("srgb", "lin_rec709")):
                check_link(report, command, folder, version, encoding, space, picture)
        # The host's own form, against the operator: at the nodes, where no interpolation errs.
        host = next(h for h in json.loads(run(command, "list", "--hosts", "--json")) if h["id"] == "icc")
        run(command, "bake", *OPERATOR, "--for", "icc", "--nodes", "sampled", "-o", folder / "host.icc")
        axis = np.round(np.arange(host["size"]) / (host["size"] - 1) * 65535)
        r, g, b = np.meshgrid(axis[::4], axis[::8], axis[::2], indexing="ij")
        codes = np.stack([r, g, b], axis=-1).reshape(len(r), -1, 3)
        write_tiff(folder / "in.tif", codes)
        run("tificc", "-l", folder / "host.icc", "-c", 0, "-w", 16, folder / "in.tif", folder / "out.tif")
        # IEC 61966-2-1
        code = codes.reshape(-1, 3) / 65535
        light = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
        report.compare(f"bake --for icc: {host['size']} points, sRGB in and out, as tificc shows it",
                       read_tiff(folder / "out.tif").reshape(-1, 3) / 65535, np.clip(evaluate(command, light, *OPERATOR), 0, 1),
                       2 * SIXTEEN_BITS)  # nodes are half a 16-bit step beside the codes
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
