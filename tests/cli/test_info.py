# SPDX-License-Identifier: Apache-2.0
"""`tonewright info`, --layer and --subimage, --mix, and `-` as standard input and output.

Tags of all formats are in tests/tags.
"""

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.share(2)

oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO's Python module is missing (Debian: python3-openimageio)")

OK, USAGE, FILE = 0, 2, 3


def write(path, parts):
    """An EXR file with parts: name -> {channel: value}."""
    specs = []
    for name, channels in parts.items():
        spec = oiio.ImageSpec(8, 4, len(channels), oiio.FLOAT)
        spec.channelnames = tuple(channels)
        spec.attribute("oiio:subimagename", name)
        specs.append(spec)
    out = oiio.ImageOutput.create(str(path))
    out.open(str(path), tuple(specs)) if len(specs) > 1 else out.open(str(path), specs[0])
    for i, (spec, channels) in enumerate(zip(specs, parts.values())):
        if i:
            out.open(str(path), spec, "AppendSubimage")
        out.write_image(np.tile(np.array(list(channels.values()), np.float32), (4, 8, 1)))
    out.close()
    return path


def read(path):
    """The pixels, not those that a cache has of an older file; and the channels' names."""
    reader = oiio.ImageInput.open(str(path))
    pixels, names = reader.read_image("float"), reader.spec().channelnames
    reader.close()
    return np.asarray(pixels, float), list(names)


def pixel(path, layer=""):
    pixels, names = read(path)
    return pixels[1, 1, [names.index(layer + c) for c in "RGB"]]


class Command:
    def __init__(self, command, folder):
        self.command, self.folder = command, folder

    def __call__(self, *arguments, data=None):
        done = subprocess.run([self.command, *map(str, arguments)], cwd=self.folder, input=data, capture_output=True,
                              check=False)
        return done.returncode, done.stdout, done.stderr.decode()


def layer(name, red):
    return {f"{name}{c}": v for c, v in zip("RGB", (red, red / 2, red / 4))}


@pytest.fixture(scope="module")
def folder(folder):
    """With a file of parts, and a scene."""
    write(folder / "parts.exr", {"depth": {"Z": 2.0}, "normal": layer("", 0.2), "rgba": layer("", 0.6)})
    rng = np.random.default_rng(7)
    rgb = (2.0 ** rng.uniform(-8, 5, (16, 16, 3)) * rng.choice([-0.2, 1, 1], (16, 16, 3))).astype(np.float32)
    rgb[0, 0] = (np.nan, np.inf, 0)
    out = oiio.ImageOutput.create(str(folder / "scene.exr"))
    out.open(str(folder / "scene.exr"), oiio.ImageSpec(16, 16, 3, oiio.FLOAT))
    out.write_image(rgb)
    out.close()
    return folder


@pytest.fixture(scope="module")
def run(command, folder):
    return Command(command, folder)


def test_layers(report, run, folder):
    linear = ("--operator", "clamp", "--display", "linear", "-d", "float")
    write(folder / "layers.exr", {"": {**layer("AO.", 0.1), **layer("Emit.", 0.3), **layer("beauty.", 0.5)}})
    code, _out, said = run("apply", "layers.exr", "o.exr", *linear)
    report.check("the picture's layer comes first, and one line says so",
                 code == OK and np.allclose(pixel(folder / "o.exr", "beauty."), (0.5, 0.25, 0.125))
                 and said.splitlines() == ["tonewright: layers.exr: layer is beauty, of AO, Emit, beauty; --layer chooses another"], said)
    code, _out, said = run("apply", "layers.exr", "o.exr", *linear, "--layer", "emit", "--strict")
    report.check("--layer in any case, and no line", code == OK and said == ""
                 and np.allclose(pixel(folder / "o.exr"), (0.3, 0.15, 0.075)), (said, pixel(folder / "o.exr")))
    code, _out, said = run("apply", "layers.exr", "o.exr", "--layer", "diffuse")
    report.check("an unknown layer", code == FILE and "it has no layer diffuse; expected one of AO, Emit, beauty" in said, said)
    code, _out, said = run("apply", "parts.exr", "o.exr", *linear)
    report.check("the picture's part", code == OK and np.allclose(pixel(folder / "o.exr")[0], 0.6) and "subimage is 2 (rgba)" in said, said)
    for choice in ("1", "normal", "NORMAL"):
        code, _out, said = run("apply", "parts.exr", "o.exr", *linear, "--subimage", choice)
        report.check(f"--subimage {choice}", code == OK and np.allclose(pixel(folder / "o.exr")[0], 0.2) and said == "", said)
    for choice, expected in (("7", FILE), ("albedo", FILE), ("-1", USAGE)):
        code, _out, said = run("apply", "parts.exr", "o.exr", "--subimage", choice)
        report.check(f"--subimage {choice}: exit code {expected}", code == expected and len(said.splitlines()) == 1, (code, said))
    for command in (("meter", "parts.exr", "--json"), ("compare", "parts.exr", "hable", "-o", "sheet.png"),
                    ("info", "parts.exr", "--json")):
        code, _out, said = run(*command, "--subimage", "normal")
        report.check(f"{command[0]} --subimage", code == OK, said)


def test_info(report, run, folder):
    spec = oiio.ImageSpec(6, 4, 3, "uint8")
    spec.attribute("Orientation", 6)
    out = oiio.ImageOutput.create(str(folder / "side.jpg"))
    out.open(str(folder / "side.jpg"), spec)
    out.write_image(np.full((4, 6, 3), 0.5, np.float32))
    out.close()
    code, text, said = run("info", "side.jpg", "--json")
    told = json.loads(text)
    report.check("JSON has what the file says", code == OK and said == "" and told["space"] in ("sRGB", "sRGB - Texture")
                 and told["orientation"] == 6 and told["alpha"] == "none" and told["units"] == "relative"
                 and np.allclose(told["primaries"], (0.64, 0.33, 0.3, 0.6, 0.15, 0.06)) and told["ignored"] == [], told)
    code, text, said = run("info", "side.jpg", "parts.exr")
    report.check("text for two files", code == OK and text.count(b"\n  space ") == 2 and b"orientation  6" in text, text)
    report.check("no file", run("info", "nothing.exr")[0] == FILE)
    report.check("no picture", run("info", __file__)[0] == FILE)


def test_mix(report, run, folder):
    def shown(*options):
        run("apply", "scene.exr", "mix.exr", "-d", "float", "-q", "--exposure", "-1", *options)
        return read(folder / "mix.exr")[0]

    for op in ("agx_blender", "reinhard_extended"):  # a grid; and statistics of the picture
        full, plain = shown("--operator", op), shown("--operator", "clamp")
        for share in (0, 0.25, 1):
            # Both are floats, and so is the blend: three roundings of numbers up to 1.
            report.compare(f"--mix {share}, {op}", shown("--operator", op, "--mix", share), share * full + (1 - share) * plain, 2e-6)
    for options in (("--mix", "1.5"), ("--mix", "0.5", "--display", "native"), ("--mix", "0.5", "--operator", "local_laplacian")):
        code, _out, said = run("apply", "scene.exr", "o.exr", *options)
        report.check(f"{' '.join(options)} is refused", code == USAGE and "mix is" in said and len(said.splitlines()) == 1, said)


def test_streams(report, run, folder):
    code, _out, _said = run("apply", "scene.exr", "file.png", "--operator", "hable")
    wanted = (folder / "file.png").read_bytes()
    data = (folder / "scene.exr").read_bytes()
    code, out, said = run("apply", "-", "-", "--format", "png", "--operator", "hable", data=data)
    report.check("from standard input to standard output: the bytes of files", code == OK and out == wanted and said == "", (code, said))
    code, out, said = run("apply", "scene.exr", "-o", "-", "--format", "ppm", "--operator", "hable")
    report.check("to standard output", code == OK and out.startswith(b"P6"), said)
    code, out, said = run("apply", "-", "o.exr", "--operator", "hable", data=wanted)
    report.check("from standard input", code == OK and out == b"", said)
    for what, arguments, given, expected in (
            ("nothing", ("-", "o.png"), b"", FILE), ("no picture", ("-", "o.png"), b"text", FILE),
            ("half a picture", ("-", "o.png"), data[:len(data) // 2], FILE), ("no format", ("scene.exr", "-"), None, USAGE),
            ("two inputs", ("-", "scene.exr", "-o", "."), data, USAGE)):
        code, out, said = run("apply", *arguments, data=given)
        report.check(f"{what}: one line, exit code {expected}", code == expected and out == b"" and len(said.splitlines()) == 1
                     and "/tmp" not in said, (code, said))
    report.check("no temporary folder is left", not list(Path(tempfile.gettempdir()).glob("tonewright-??????/in.*")))


def test_hints(report, run):
    for option, words in (("--gamma", "--display"), ("--autoorient", "orientation"), ("--channels", "--layer"), ("--cdl", "--lut"),
                          ("-resize", "apply --resize SIZE")):
        code, _out, said = run("apply", "scene.exr", "o.png", option, "2")
        report.check(f"{option}: a hint", code == USAGE and words in said and len(said.splitlines()) == 1, said)
