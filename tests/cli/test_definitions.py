# SPDX-License-Identifier: Apache-2.0
"""Operators of .tone files: the examples of docs/ from the file to every form."""

import json
import os
import re
import shutil
import subprocess

import numpy as np
import OpenImageIO as oiio
import pytest
from pictures import PROJECT, evaluate, read_rgb, run, skip

EXAMPLES = PROJECT / "docs" / "examples"
SOFT, WITH_E = EXAMPLES / "reinhard_055.tone", EXAMPLES / "reinhard_e.tone"
STOPS = np.concatenate([[0.0], 0.18 * np.exp2(np.linspace(-10, 9, 400))])
GRAYS = np.stack([STOPS, STOPS[::-1], STOPS / 2], axis=1)


def soft(x, k=0.55):
    """OpenColorIO issue 2320."""
    with np.errstate(invalid="ignore"):
        return np.where(x > 0, x / (x + x**k), 0)


def with_e(x):
    """OpenColorIO issue 2321."""
    return x / (x + np.exp(x / (x + 1)))


def srgb(light):
    """IEC 61966-2-1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)


def write_picture(path, pixels):
    height, width, _ = pixels.shape
    spec = oiio.ImageSpec(width, height, 3, "float")
    out = oiio.ImageOutput.create(str(path))
    out.open(str(path), spec)
    out.write_image(pixels.astype(np.float32))
    out.close()


@pytest.fixture(scope="module")
def folder(folder):
    """With a picture."""
    write_picture(folder / "scene.exr", np.tile(GRAYS[None], (4, 1, 1)))
    return folder


@pytest.fixture(scope="module")
def config(command, folder):
    run(command, "config", "-o", folder / "config", "--views", SOFT)
    return folder / "config" / "config.ocio"


def test_examples(report, command, folder):
    # eval prints nine digits.
    report.compare("eval: issue 2320", evaluate(command, GRAYS, SOFT, "--display", "linear"), soft(GRAYS), 1e-9)
    report.compare("eval: issue 2321", evaluate(command, GRAYS, WITH_E, "--display", "linear"), with_e(GRAYS), 1e-9)
    for text in (f"{SOFT}:k=0.3", f"{SOFT}:firm", f"{SOFT}:Firm", f"{SOFT} k=0.3"):
        report.compare(f"eval: {text[len(str(SOFT)):]}", evaluate(command, GRAYS, text, "--display", "linear"),
                       soft(GRAYS, 0.3), 1e-9)
    # engine.h: the SIMD engine is within 1e-6 of the reference.
    report.compare("eval --engine simd", evaluate(command, GRAYS, SOFT, "--engine", "simd"), srgb(soft(GRAYS)), 1.1e-6)

    # The name of a file, relative, with blanks and colons.
    odd = folder / "my ops" / "a:b c.tone"
    odd.parent.mkdir()
    shutil.copy(SOFT, odd)
    for place, name in ((odd.parent, "./a:b c.tone"), (odd.parent, "a:b c.tone"), (folder, "my ops/a:b c.tone:k=0.55"),
                        (folder, odd)):
        shown = run(command, "eval", name, "--display", "linear", folder=place, stdin="1 1 1\n")
        report.check(f"eval: path {name}", shown.split() == ["0.5"] * 3, shown)

    scene = folder / "scene.exr"
    run(command, "apply", scene, folder / "out.png", "--operator", f"{SOFT}:k=0.4")
    # Half a code value of 8 bits, and dither of as much.
    report.compare("apply: PNG", read_rgb(folder / "out.png", folder)[1], srgb(soft(GRAYS, 0.4)), 1.01 / 255)
    text = run("oiiotool", "--info", "-v", folder / "out.png")
    report.check("apply: the picture names the file", "reinhard_055.tone" in text and "k=0.4" in text, text)

    listed = json.loads(run(command, "list", SOFT, "--json"))
    report.check("list: JSON", listed["id"] == "reinhard_055" and listed["view"] == "Reinhard 0.55", str(listed)[:300])
    again = run(command, "list", f"{SOFT}:firm", "--definition")
    (folder / "again.tone").write_text(again)
    report.compare("list --definition reads back", evaluate(command, GRAYS, folder / "again.tone", "--display", "linear"),
                   soft(GRAYS, 0.3), 1e-9)
    hable = run(command, "list", "hable", "--definition")
    (folder / "hable.tone").write_text(hable)
    report.check("list --definition: hable reads back as hable",
                 np.array_equal(evaluate(command, GRAYS, folder / "hable.tone"), evaluate(command, GRAYS, "hable")))

    run(command, "plot", SOFT, "agx_blender", "-o", folder / "plot.svg")
    report.check("plot: SVG names the operator", "Reinhard, exponent 0.55" in (folder / "plot.svg").read_text())
    run(command, "compare", scene, SOFT, "agx_blender", "-o", folder / "sheet.png")
    report.check("compare: sheet", (folder / "sheet.png").stat().st_size > 1000)

    glsl = run(command, "shader", SOFT, "--language", "glsl", "-o", folder / "soft.glsl")
    text = (folder / "soft.glsl").read_text()
    report.check("shader: GLSL", "vec3 tw_reinhard_055(vec3" in text and "issues/2320" in text, glsl + text)
    run(command, "shader", SOFT, "--language", "glsl", "--uniforms", "k", "-o", folder / "live.glsl")
    text = (folder / "live.glsl").read_text()
    report.check("shader: k is an argument", re.search(r"float k\b", text) is not None, text)

    # llvmpipe's GLSL, OpenColorIO's CPU and GPU, every instruction set: verify holds each to its bound.
    done = subprocess.run([command, "verify", SOFT, "--json"], capture_output=True, text=True, check=False)
    report.check("verify: all within their bounds", done.returncode == 0, done.stdout[-600:] + done.stderr)
    rows = json.loads(done.stdout) if done.returncode == 0 else []
    forms = {str(row.get("backend", row)): row for row in (rows if isinstance(rows, list) else rows.get("rows", []))}
    report.check("verify: OpenColorIO's CPU and GLSL are rows",
                 any("ocio" in f for f in forms) and any("glsl" in f for f in forms), str(forms)[:500])

    run(command, "bake", SOFT, "--input", "lin_rec709", "-o", folder / "soft.cube")


def test_plugin(report, plugin, folder):
    shutil.copy(SOFT, folder / "soft.tone")
    done = subprocess.run(["oiiotool", "scene.exr.tonewright?op=soft.tone:k=0.4&display=linear", "-o", "plugin.exr"],
                          cwd=folder, env={**os.environ, "OIIO_LIBRARY_PATH": str(plugin)}, capture_output=True, text=True,
                          check=False)
    if report.check("plugin: op=soft.tone", done.returncode == 0, done.stdout + done.stderr):
        report.compare("plugin: colors", read_rgb(folder / "plugin.exr", folder)[1], soft(GRAYS, 0.4), 2e-6)


def test_ffmpeg(report, command, scratch, config):
    if not shutil.which("ffmpeg") or " exr " not in run("ffmpeg", "-v", "error", "-encoders"):
        skip("a LUT through ffmpeg (it is not installed, or has no EXR encoder)")
    run(command, "bake", SOFT, "--for", "ffmpeg", "--input", "lin_rec709", "--nodes", "sampled", "-o", scratch / "f.cube")
    header = (scratch / "f.cube").read_text()[:3000]
    codes = np.random.default_rng(1).uniform(0, 1, (8, 64, 3)).astype(np.float32)
    write_picture(scratch / "codes.exr", codes)
    filter_ = "lut3d" if "LUT_3D_SIZE" in header else "lut1d"
    run("ffmpeg", "-v", "error", "-nostdin", "-y", "-i", "codes.exr", "-vf", f"{filter_}=f.cube", "-pix_fmt", "gbrpf32le",
        "graded.exr", folder=scratch)
    # Independent of our own reading: oiiotool's OpenColorIO applies the same file.
    run("oiiotool", "--colorconfig", config, "codes.exr", "--ociofiletransform", scratch / "f.cube", "-o", "ocio.exr", folder=scratch)
    # Both interpolate in tetrahedra or along lines, in single precision.
    report.compare("ffmpeg: the LUT", read_rgb(scratch / "graded.exr", scratch), read_rgb(scratch / "ocio.exr", scratch), 2e-5)
    report.check("ffmpeg: the LUT's header names the operator", "reinhard_055" in header, header[:400])


def test_config(report, command, folder, scratch, config):
    run("oiiotool", "--colorconfig", config, folder / "scene.exr", "--ociodisplay:from=lin_rec709", "sRGB", "Reinhard 0.55", "-o",
        scratch / "ocio.exr")
    # One half-domain table: 3e-7 of the encoded value; float32 of the picture itself beside it.
    report.compare("config: the view through oiiotool", read_rgb(scratch / "ocio.exr", scratch)[1], srgb(soft(GRAYS)), 1e-6)
    done = subprocess.run([command, "config", "-o", scratch / "c2", "--views", "agx_minimal", scratch / "clash.tone"],
                          capture_output=True, text=True, check=False)
    report.check("config: a file that is not there is exit 3", done.returncode == 3, done.stderr)


def test_python(report, tw):
    shown = tw.tonemap(GRAYS[None].astype(np.float32), str(SOFT), display="linear")
    report.compare("Python: tonemap(a, 'my.tone')", np.asarray(shown)[0], soft(GRAYS), 2e-6)
    try:
        tw.tonemap(GRAYS[None].astype(np.float32), "none.tone")
        report.check("Python: a missing file raises", False)
    except FileNotFoundError as e:
        report.check("Python: a missing file raises", "none.tone: No such file" in str(e), str(e))
