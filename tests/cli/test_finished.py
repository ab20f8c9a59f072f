# SPDX-License-Identifier: Apache-2.0
"""`tonewright apply` warns of pictures that are made for a display already, and tone mapped a second time."""

import shutil
import subprocess
import warnings

import numpy as np
import pytest
from pictures import share_of

pytestmark = pytest.mark.share(2)

oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO's Python module is missing (Debian: python3-openimageio)")

REST = "; the operator clamp keeps the colors, --input lin_rec709 takes the numbers as scene-linear"


def write(path, kind, attributes=None):
    spec = oiio.ImageSpec(8, 8, 3, kind)
    for name, value in (attributes or {}).items():
        spec.attribute(name, value)
    picture = oiio.ImageBuf(spec)
    picture.set_pixels(picture.roi, np.linspace(0, 1, 192, dtype=np.float32).reshape(8, 8, 3))
    if not picture.write(str(path)):
        raise RuntimeError(picture.geterror())
    return path


@pytest.fixture(scope="module")
def folder(folder):
    """With a picture for a display, and one of a scene."""
    write(folder / "a.png", "uint8")
    write(folder / "a.exr", "half")
    return folder


class Check:
    def __init__(self, report, command, folder):
        self.report, self.command, self.folder = report, command, folder

    def run(self, *arguments, code=0, data=None):
        """Lines about finished pictures, without `tonewright: warning: `."""
        done = subprocess.run([self.command, "apply", *map(str, arguments)], cwd=self.folder, input=data, capture_output=True,
                              check=False)
        said = done.stderr.decode()
        if done.returncode != code:
            raise RuntimeError(f"exit {done.returncode}: {arguments}: {said}")
        lines = [line for line in said.splitlines() if "finished for a display" in line]
        for line in lines:
            if not line.startswith("tonewright: warning: ") and code == 0:
                raise RuntimeError(f"no warning: {line}")
        return [line.removeprefix("tonewright: ").removeprefix("warning: ") for line in lines]

    def says(self, what, lines, expected):
        self.report.check(what, lines == expected, f"{lines}; expected {expected}")


@pytest.fixture
def c(report, command, folder):
    return Check(report, command, folder)


def test_formats(c):
    finished = [
        ("a.png", "uint8", {}, "sRGB by default of PNG with integer pixels"),
        ("b.png", "uint16", {}, "sRGB by default of PNG with integer pixels"),
        ("c.jpg", "uint8", {}, None),
        ("d.tif", "uint8", {}, None),
        ("e.tif", "uint16", {}, None),
        ("f.tga", "uint8", {}, None),
        ("g.bmp", "uint8", {}, None),
        ("h.ppm", "uint8", {}, None),
        ("i.exr", "half", {"colorInteropID": "srgb_rec709_display"}, "sRGB by colorInteropID"),
    ]
    for name, kind, attributes, why in share_of(finished, 3):
        write(c.folder / name, kind, attributes)
        lines = c.run(name, "out.png", "--operator", "hable")
        begin = f"{name}: finished for a display ({why or ''}"
        c.report.check(f"{name}: {kind} {attributes or ''}", len(lines) == 1 and lines[0].startswith(begin)
                       and lines[0].endswith(f"), so hable tone maps it a second time{REST}"), lines)
        c.says(f"{name}: stated", c.run(name, "out.png", "--operator", "hable", "--input", "sRGB"), [])
    # Light, logs, textures and HDR pictures are what operators expect.
    scenes = [("a.exr", "half", {}), ("b.hdr", "float", {}), ("c.tif", "float", {}), ("d.dpx", "uint16", {"oiio:BitsPerSample": 10}),
              ("f.exr", "half", {"colorInteropID": "srgb_rec709_scene"}),
              ("g.exr", "half", {"colorInteropID": "pq_rec2020_display"}), ("h.exr", "half", {"colorInteropID": "lin_ap1_scene"})]
    for name, kind, attributes in share_of(scenes, 3):
        write(c.folder / name, kind, attributes)
        c.says(f"{name}: {kind} {attributes or ''}: a scene", c.run(name, "out.png", "--operator", "hable"), [])
    for display in ("rec2100_pq", "rec2100_hlg"):
        c.run("a.exr", "hdr.png", "--operator", "hable", "--display", display)
        c.says(f"{display}: HDR", c.run("hdr.png", "out.png", "--operator", "hable"), [])
    for display in ("srgb", "rec1886", "display_p3"):
        c.run("a.exr", "sdr.png", "--operator", "hable", "--display", display)
        c.report.check(f"{display}: a result of apply", len(c.run("sdr.png", "out.png", "--operator", "hable")) == 1)


def test_operators(c):
    for options in (["--operator", "clamp"], ["--false-color"], ["--operator", "hable", "--mix", "0"], ["-q", "--operator", "hable"]):
        c.says(f"no warning: {' '.join(options)}", c.run("a.png", "out.png", *options), [])
    c.report.check("the default operator, too", "so agx_blender tone maps" in c.run("a.png", "out.png")[0])
    c.report.check("a formula, too", "so the formula tone maps" in c.run("a.png", "out.png", "--operator", "x/(x+1)")[0])
    c.report.check("a local operator, too", "so reinhard_local tone" in c.run("a.png", "out.png", "--operator", "reinhard_local")[0])
    # The advice is right.
    c.run("a.png", "same.png", "--operator", "clamp")
    pixels = [oiio.ImageInput.open(str(c.folder / name)).read_image(oiio.UINT8) for name in ("a.png", "same.png")]
    c.report.check("clamp keeps the colors", (pixels[0] == pixels[1]).all())
    c.says("--input lin_rec709", c.run("a.png", "out.png", "--operator", "hable", "--input", "lin_rec709"), [])
    (c.folder / "lut.cube").write_text("LUT_1D_SIZE 2\n0 0 0\n1 1 1\n")
    for options in (["--lut", "lut.cube"], ["--operator", "lut.cube"]):
        c.says(f"a LUT decides: {' '.join(options)}", c.run("a.png", "out.png", *options), [])
    lines = c.run("a.png", "strict.png", "--operator", "hable", "--strict", code=1)
    c.report.check("--strict", len(lines) == 1 and lines[0].endswith("(an error because of --strict)")
                   and not (c.folder / "strict.png").exists(), lines)


def test_many(c):
    (c.folder / "many").mkdir()
    for i in range(1, 5):
        shutil.copy(c.folder / "a.png", c.folder / "many" / f"f.{i:04d}.png")
    shutil.copy(c.folder / "a.exr", c.folder / "many" / "light.exr")
    reason = f"finished for a display (sRGB by default of PNG with integer pixels), so hable tone maps it a second time{REST}"
    c.says("a folder: one line", c.run("many", "-o", "out", "--format", "tif", "--operator", "hable"),
           [f"many/f.0001.png and 3 more: {reason}"])
    c.says("a shot: one line", c.run("many/f.####.png", "out/g.####.tif", "--frames", "1-4", "--operator", "hable"),
           [f"many/f.####.png: {reason}"])
    c.says("with a time limit", c.run("many", "-o", "out", "--format", "tif", "--operator", "hable", "--timeout", "60"),
           [f"many/f.0001.png and 3 more: {reason}"])
    c.says("a pipe", c.run("-", "-", "--format", "png", "--operator", "hable", data=(c.folder / "a.png").read_bytes()),
           [f"-: {reason}"])


def test_python(c, tw):
    for name, options, count in (("a.png", {}, 1), ("a.png", {"input": "sRGB"}, 0), ("a.exr", {}, 0)):
        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always")
            tw.tonemap_file(c.folder / name, c.folder / "python.png", "hable", **options)
        c.report.check(f"Python: {name} {options or ''}", len(heard) == count and all(
            str(w.message).endswith('input="lin_rec709" takes the numbers as scene-linear') for w in heard),
            [str(w.message) for w in heard])
