# SPDX-License-Identifier: Apache-2.0
"""LUT files as operators, against NumPy and OpenColorIO's own reading of the same files."""

import json
import os
import struct
import subprocess
import time
import warnings

import numpy as np
import OpenImageIO as oiio
import PyOpenColorIO as ocio
import pytest
from pictures import ALL, acescct_encode, evaluate, read_rgb, run

pytestmark = pytest.mark.share(2)

# Linear Rec.709 to ACEScg, by the published conversion of both to XYZ with Bradford's adaptation (SMPTE RP 177, S-2014-004).
TO_AP1 = np.array([[0.613097402, 0.339523146, 0.047379451], [0.070193722, 0.916353879, 0.013452399],
                   [0.020615593, 0.109569773, 0.869814635]])
COUNT = 20000 if ALL else 1000
RNG = np.random.default_rng(3)
COLORS = np.concatenate([0.18 * np.exp2(RNG.uniform(-10, 8, (COUNT, 3))), np.repeat(np.linspace(0, 4, 50)[:, None], 3, 1)])
UNIT = RNG.uniform(-0.2, 1.2, (COUNT, 3))
# OpenColorIO computes in float32; eval prints nine digits.
OCIO_FLOAT = 1e-6


def film(rgb):
    """Something that mixes channels, from [0, 1] to [0, 1]."""
    mixed = rgb @ np.array([[0.8, 0.1, 0.1], [0.1, 0.85, 0.05], [0.05, 0.15, 0.8]]).T
    return np.clip(mixed**2 * (3 - 2 * mixed), 0, 1)


def nodes(n, function=film):
    """Red fastest."""
    blue, green, red = np.meshgrid(*[np.linspace(0, 1, n)] * 3, indexing="ij")
    return function(np.stack([red, green, blue], axis=-1).reshape(-1, 3))


def write_cube(path, n, head="", values=None):
    with open(path, "w") as file:
        file.write(f'TITLE "Film Print"\n{head}LUT_3D_SIZE {n}\n')
        np.savetxt(file, nodes(n) if values is None else values, "%.7f")


def write_dds(path, n, dxgi, texels):
    """A volume with the header of Direct3D 10 (Microsoft, Programming Guide for DDS)."""
    header = struct.pack("<4s7I44x", b"DDS ", 124, 0x801007, n, n, 0, n, 1)
    header += struct.pack("<2I4s5I", 32, 4, b"DX10", 0, 0, 0, 0, 0) + struct.pack("<5I", 0x1000, 0x200000, 0, 0, 0)
    path.write_bytes(header + struct.pack("<5I", dxgi, 4, 0, 1, 0) + texels)


def shared_exponent(rgb):
    """R9G9B9E5 (OpenGL, EXT_texture_shared_exponent), and the numbers that it holds."""
    exponent = np.clip(np.floor(np.log2(np.maximum(rgb.max(1), 1e-30))) + 16, 0, 31)
    unit = np.exp2(exponent - 24)[:, None]
    mantissa = np.minimum(np.floor(rgb / unit + 0.5), 511).astype(np.uint32)
    packed = mantissa[:, 0] | mantissa[:, 1] << 9 | mantissa[:, 2] << 18 | exponent.astype(np.uint32) << 27
    return packed.astype("<u4").tobytes(), mantissa * unit


def tetrahedral(values, n, at):
    """The LUT between its nodes, from its definition: from the corner along the largest fraction first."""
    place = np.clip(at, 0, 1) * (n - 1)
    cell = np.minimum(place.astype(int), n - 2)
    fraction = place - cell
    grid = values.reshape(n, n, n, 3)
    order = np.argsort(-fraction, axis=1, kind="stable")
    result = grid[cell[:, 2], cell[:, 1], cell[:, 0]].astype(float)
    corner, rows = cell.copy(), np.arange(len(at))
    for k in range(3):
        before = grid[corner[:, 2], corner[:, 1], corner[:, 0]]
        corner[rows, order[:, k]] += 1
        after = grid[corner[:, 2], corner[:, 1], corner[:, 0]]
        result += fraction[rows, order[:, k]][:, None] * (after - before)
    return result


def through_ocio(path, colors):
    # Tetrahedral in 3D LUTs, linear in 1D tables.
    transform = ocio.FileTransform(str(path), interpolation=ocio.INTERP_BEST)
    processor = ocio.Config.CreateRaw().getProcessor(transform).getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS)
    pixels = np.ascontiguousarray(colors, dtype=np.float32)
    processor.applyRGB(pixels)
    return pixels


def srgb(light):
    """IEC 61966-2-1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)


def write_picture(path, pixels, kind="float"):
    height, width, channels = pixels.shape
    out = oiio.ImageOutput.create(str(path))
    out.open(str(path), oiio.ImageSpec(width, height, channels, kind))
    out.write_image(np.ascontiguousarray(pixels, dtype=np.float32))
    out.close()


@pytest.fixture(scope="module")
def folder(command, folder):
    """LUT files of many formats, a picture, and a LUT that is cut."""
    write_cube(folder / "film.cube", 33)
    write_cube(folder / "domain.cube", 17, "DOMAIN_MIN -0.1 -0.1 -0.2\nDOMAIN_MAX 1.1 1 1.2\n")
    rows = "".join(f"{x ** 0.5:.7f} {x ** 0.6:.7f} {x * x:.7f}\n" for x in np.linspace(0, 1, 33))
    (folder / "one.cube").write_text("LUT_1D_SIZE 33\n" + rows)
    (folder / "x.spi1d").write_text("Version 1\nFrom -0.125 1.125\nLength 5\nComponents 1\n{\n0\n.2\n.5\n.8\n1\n}\n")
    (folder / "x.cc").write_text('<ColorCorrection id="a"><SOPNode><Slope>1.1 1 .9</Slope><Offset>.01 0 -.01</Offset>'
                                  "<Power>1.2 1 .8</Power></SOPNode><SATNode><Saturation>.8</Saturation></SATNode>"
                                  "</ColorCorrection>")
    halves = np.nan_to_num(np.arange(65536, dtype=np.uint16).view(np.float16).astype(float))
    (folder / "half.clf").write_text(
        '<?xml version="1.0" encoding="UTF-8"?>\n<ProcessList id="a" compCLFversion="3">'
        '<LUT1D inBitDepth="16f" outBitDepth="32f" halfDomain="true"><Array dim="65536 1">\n'
        + "".join(f"{x / (1 + abs(x)):.9g}\n" for x in halves) + "</Array></LUT1D></ProcessList>\n")
    for form in ("clf", "spi3d", "csp", "3dl", "lut"):
        run(command, "bake", "agx_sobotka", "--format", form, "--size", "17", "--3d", "--nodes", "sampled", "-q", "-o",
            folder / f"a.{form}")
    with_alpha = np.concatenate([nodes(16), np.ones((16**3, 1))], axis=1)
    write_dds(folder / "rgba16f.dds", 16, 10, with_alpha.astype("<f2").tobytes())
    (folder / "cut.cube").write_bytes((folder / "film.cube").read_bytes()[:3000])
    write_picture(folder / "scene.exr", COLORS[None])
    return folder


def test_formats(report, command, folder):
    for name in ("film.cube", "domain.cube", "one.cube", "x.spi1d", "x.cc", "half.clf", "a.clf", "a.spi3d", "a.csp", "a.3dl",
                 "a.lut"):
        shown = evaluate(command, UNIT, f"{folder / name}:input=none", "--display", "native")
        report.compare(f"{name}: as OpenColorIO reads it", shown, through_ocio(folder / name, UNIT), OCIO_FLOAT)
    shown = evaluate(command, UNIT, f"{folder / 'half.clf'}:input=none", "--display", "native", "--engine", "simd")
    report.compare("half.clf, --engine simd", shown, through_ocio(folder / "half.clf", UNIT), OCIO_FLOAT)
    done = subprocess.run([command, "verify", f"{folder / 'half.clf'}:input=none", "--quick"], capture_output=True, text=True,
                          check=False)
    report.check("half.clf: verify", done.returncode == 0 and "ocio cpu lossless" in done.stdout
                 and ("none: it cannot store the operator's tables" in done.stdout or " dctl " not in done.stdout),
                 done.stdout + done.stderr)
    raw = nodes(9).astype("<f4")
    (folder / "film.raw").write_bytes(raw.tobytes())
    report.compare("film.raw", evaluate(command, UNIT, f"{folder / 'film.raw'}:input=none", "--display", "native"),
                   tetrahedral(raw, 9, UNIT), 1e-8)

    n = 16
    cube = nodes(n)
    with_alpha = np.concatenate([cube, np.ones((n**3, 1))], axis=1)
    packed, held = shared_exponent(cube)
    for name, dxgi, texels, values in (("rgba32f", 2, with_alpha.astype("<f4").tobytes(), cube),
                                       ("rgba16f", 10, with_alpha.astype("<f2").tobytes(), cube.astype(np.float16)),
                                       ("rgb9e5", 67, packed, held)):
        path = folder / f"{name}.dds"
        write_dds(path, n, dxgi, texels)
        # Single floats of the file, nine digits.
        for what in (f"{path}:input=none", None):
            options = ("--display", "native") if what else ("--lut", path, "--input-encoding", "none")
            shown = evaluate(command, UNIT, *([what] if what else []), *options)
            report.compare(f"{name}.dds: {'operator' if what else '--lut'}", shown,
                           tetrahedral(values.astype(np.float32), n, UNIT), 2e-7)
    light = evaluate(command, COLORS, f"{folder / 'rgb9e5.dds'}:input=reinhard:output=linear")
    report.compare("DDS of light, x/(x + 1) in", light, srgb(tetrahedral(held, n, COLORS / (COLORS + 1))), 1e-8)

    strip = cube.reshape(n, n, n, 3).transpose(1, 0, 2, 3).reshape(n, n * n, 3)
    write_picture(folder / "strip.exr", strip)
    write_picture(folder / "strip.png", strip, "uint16")
    for name, bound in (("strip.exr", 1e-7), ("strip.png", 0.51 / 65535)):  # a float, and half a code of 16 bits
        shown = evaluate(command, UNIT, f"{folder / name}:input=none", "--display", "native")
        report.compare(f"{name}: Unreal's layout", shown, tetrahedral(cube, n, UNIT), bound)


def test_forms(report, command, folder):
    text = f"{folder / 'film.cube'}:input=acescct:output=srgb"
    wanted = tetrahedral(np.round(nodes(33), 7), 33, acescct_encode(COLORS @ TO_AP1.T))
    # The nodes are single floats (6e-8 between 0.5 and 1), and the matrix above has nine decimals.
    bound = 2e-7
    report.compare("eval: encoded, on its own display", evaluate(command, COLORS, text), wanted, bound)
    shown = evaluate(command, COLORS, folder / "film.cube", "--input-encoding", "acescct", "--set", "output=srgb")
    report.compare("eval --input-encoding", shown, wanted, bound)
    # engine.h: the SIMD engine is within 1e-6 of the reference.
    report.compare("eval --engine simd", evaluate(command, COLORS, text, "--engine", "simd"), wanted, 1.1e-6)
    shown = evaluate(command, COLORS, text, "--display", "rec1886")
    light = np.where(wanted <= 0.04045, wanted / 12.92, ((wanted + 0.055) / 1.055) ** 2.4)
    report.compare("eval: on another display", shown, light ** (1 / 2.4), 1e-6)

    (folder / "sub").mkdir()
    (folder / "sub" / "film.tone").write_text('tonewright = 1\nid = "print"\n[output]\nkind = "code_value"\ndisplay = "srgb"\n'
                                               '[[stage]]\nlut = "../film.cube"\ninput = "acescct"\n')
    tone = folder / "sub" / "film.tone"
    report.check("a lut stage equals the LUT", np.array_equal(evaluate(command, COLORS, tone), evaluate(command, COLORS, text)))
    (folder / "again.tone").write_text(run(command, "list", text, "--definition"))
    report.check("list --definition reads back",
                 np.array_equal(evaluate(command, COLORS, folder / "again.tone"), evaluate(command, COLORS, text)))
    # Stages around a LUT, one that is not there, a live parameter.
    between = folder / "sub" / "between.tone"
    between.write_text('tonewright = 1\nid = "between"\n[parameter.lift]\ndefault = 0.5\nmin = 0\nmax = 1\n'
                       '[parameter.kind]\nchoices = ["plain", "other"]\ndefault = "plain"\n'
                       '[[stage]]\nlut = "../film.cube"\ninput = "acescct"\nwhen = "kind == kind.other"\n'
                       '[[stage]]\ncurve = "x * lift"\n[[stage]]\nlut = "../film.cube"\ninput = "acescct"\n'
                       '[[stage]]\nclamp = [0.1, 0.9]\n')
    for setting in ("kind=plain", "kind=other"):
        printed = folder / "printed.tone"
        printed.write_text(run(command, "list", f"{between}:{setting}", "--definition"))
        for lift in ("lift=0.5", "lift=1"):
            report.check(f"list --definition with LUTs reads back, {setting}:{lift}", np.array_equal(
                evaluate(command, COLORS, f"{printed}:{lift}"), evaluate(command, COLORS, f"{between}:{setting}:{lift}")))
        luts = printed.read_text().count("lut = ")
        report.check(f"list --definition: {setting} names its LUTs", luts == 1 + (setting == "kind=other"), printed.read_text())
    listed = run(command, "list", text)
    report.check("list: title and size", "Film Print" in listed and "33 x 33 x 33" in listed, listed)

    scene = folder / "scene.exr"
    # Half a code value of 8 bits, and dither of as much.
    run(command, "apply", scene, folder / "out.png", "--operator", text)
    report.compare("apply: PNG", read_rgb(folder / "out.png", folder)[0], wanted, 1.01 / 255)
    run(command, "apply", scene, folder / "lut.exr", "--lut", folder / "film.cube", "--input-encoding", "acescct")
    report.compare("apply --lut", read_rgb(folder / "lut.exr", folder)[0], wanted, 1e-5)
    run(command, "plot", text, "-o", folder / "plot.svg")
    report.check("plot", "Film Print" in (folder / "plot.svg").read_text())
    run(command, "compare", scene, text, "hable", "-o", folder / "sheet.png")
    report.check("compare", (folder / "sheet.png").stat().st_size > 1000)

    # At its own nodes and encoding, a LUT of 33 is the same LUT.
    run(command, "bake", text, "--input-encoding", "acescct", "--size", "33", "--nodes", "sampled", "-o", folder / "b.cube")
    report.compare("bake: the same LUT", through_ocio(folder / "b.cube", UNIT), through_ocio(folder / "film.cube", UNIT), 1e-6)
    done = run(command, "shader", text, "--language", "glsl", "-o", folder / "film.glsl")
    report.check("shader: a texture beside it", any(folder.glob("*.rgba32f")) and
                 "texelFetch" in (folder / "film.glsl").read_text(), done)
    options = (folder / "film.cube", "--input-encoding", "acescct", "--set", "output=srgb")
    for name, *arguments in (("shader", "--language", "c"), ("check", "--json")):
        report.check(f"{name} --input-encoding", run(command, name, *options, *arguments) ==
                     run(command, name, folder / "film.cube", "--set", "input=acescct", "--set", "output=srgb", *arguments))
        done = subprocess.run([command, name, "hable", "--lut-space", "lin_ap1", *arguments], capture_output=True, text=True, check=False)
        report.check(f"{name} --lut-space: another operator", done.returncode == 2 and f"{name}: --lut-space is lin_ap1; expected a LUT "
                     "as the operator" in done.stderr, done.stderr)

    config = folder / "config"
    run(command, "config", "-o", config, "--operator", text, "--name", "Film", "--views", "hable", "--displays", "srgb",
        "--profile", "2.1")
    run("oiiotool", "--colorconfig", config / "config.ocio", scene, "--ociodisplay:from=lin_rec709", "sRGB", "Film", "-o",
        folder / "ocio.exr")
    # The half-LUTs of shaper and encodings: 3e-7 each, after a LUT whose slope is about 1.5.
    report.compare("config: the view through oiiotool", read_rgb(folder / "ocio.exr", folder)[0], wanted, 2e-6)

    # Every instruction set, OpenColorIO's CPU and GPU, llvmpipe's GLSL: verify holds each to its bound.
    done = subprocess.run([command, "verify", text, folder / "one.cube", "--json", *([] if ALL else ["--quick"])],
                          capture_output=True, text=True, check=False)
    report.check("verify: all within their bounds", done.returncode == 0, done.stdout[-600:] + done.stderr)
    forms = [row["backend"] for row in json.loads(done.stdout)["rows"]] if done.stdout else []
    report.check("verify: OpenColorIO and GLSL are rows", any("ocio cpu" in f for f in forms) and "glsl" in forms, str(forms))


def test_messages(report, command, folder):
    def message(*arguments):
        begin = time.monotonic()
        done = subprocess.run([command, *arguments], capture_output=True, text=True, input="", check=False, cwd=folder, timeout=20)
        return done.returncode, done.stderr.strip().splitlines(), time.monotonic() - begin

    code, lines, _ = message("eval", "film.cube")
    report.check("an unknown encoding is one warning", code == 0 and len(lines) == 1 and "warning" in lines[0] and
                 "none" in lines[0], str(lines))
    code, lines, _ = message("eval", "film.cube", "--strict")
    report.check("--strict makes it an error", code != 0 and len(lines) == 1, str(lines))
    code, lines, _ = message("eval", "a.clf")
    report.check("our own LUTs state their input and output", code == 0 and not lines, str(lines))

    film_bytes, dds = (folder / "film.cube").read_bytes(), (folder / "rgba16f.dds").read_bytes()
    (folder / "nan.cube").write_bytes(film_bytes.replace(b"0.0000000 0.0000000 0.0000000", b"nan 0 0", 1))
    (folder / "huge.cube").write_text("LUT_3D_SIZE 1000\n0 0 0\n")
    (folder / "huge.spi3d").write_text("SPILUT 1.0\n3 3\n1000 1000 1000\n0 0 0 0 0 0\n")
    (folder / "cut.dds").write_bytes(dds[:-1])
    (folder / "flat.dds").write_bytes(dds[:24] + struct.pack("<I", 1) + dds[28:])
    (folder / "huge.dds").write_bytes(dds[:12] + struct.pack("<2I", 10**9, 10**9) + dds[20:])
    (folder / "nan.dds").write_bytes(dds[:-8] + struct.pack("<4H", 0x7E00, 0, 0, 0))
    (folder / "bc7.dds").write_bytes(dds[:128] + struct.pack("<I", 98) + dds[132:])
    (folder / "dir.cube").mkdir()
    os.mkfifo(folder / "pipe.cube")
    names = ["cut.cube", "nan.cube", "huge.cube", "huge.spi3d", "cut.dds", "flat.dds", "huge.dds", "nan.dds", "bc7.dds",
             "dir.cube", "pipe.cube", "none.cube"]
    for name in names:
        code, lines, seconds = message("eval", name)
        report.check(f"{name}: one line", code == 3 and len(lines) == 1 and name in lines[0] and seconds < 5, f"{code} {lines}")
    for name in [*names, "self.tone", "../nowhere/x.cube"]:
        (folder / "self.tone").write_text(f'tonewright = 1\nid = "a"\n[[stage]]\nlut = "{name}"\ninput = "none"\n')
        code, lines, seconds = message("eval", "self.tone")
        report.check(f"lut = {name}: its line and a caret", code == 3 and len(lines) == 3 and "self.tone:4:7" in lines[0] and
                     lines[2].strip() == "^" and seconds < 5, f"{code} {lines}")
    for setting in ("input=acesct", "output=srbg", "space=lin_ap9:input=acescct"):
        code, lines, _ = message("eval", f"film.cube:{setting}")
        report.check(f"{setting}: one line", code == 2 and len(lines) == 1, f"{code} {lines}")
    code, lines, _ = message("eval", "hable", "--input-encoding", "acescct")
    report.check("--input-encoding needs a LUT", code == 2 and len(lines) == 1 and "LUT" in lines[0], str(lines))

    begin = time.monotonic()
    evaluate(command, UNIT[:1], f"{folder / 'film.cube'}:input=none")
    report.check("eval of 33^3 takes less than a second", time.monotonic() - begin < 1)
    if ALL:
        write_cube(folder / "big.cube", 129)
        shown = evaluate(command, UNIT, f"{folder / 'big.cube'}:input=none", "--display", "native")
        report.compare("129^3", shown, through_ocio(folder / "big.cube", UNIT), OCIO_FLOAT)


def test_python(report, tw, command, folder):
    text = f"{folder / 'film.cube'}:input=acescct:output=srgb"
    pixels = COLORS[None].astype(np.float32)
    report.compare("Python: tonemap", np.asarray(tw.tonemap(pixels, text))[0], evaluate(command, COLORS, text), 2e-6)
    report.compare("Python: a LUT of OpenColorIO's", tw.evaluate(str(folder / "a.clf"), COLORS),
                   evaluate(command, COLORS, folder / "a.clf"), 1e-9)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        tw.evaluate(str(folder / "film.cube"), COLORS)
    report.check("Python: an unknown encoding is a UserWarning", len(caught) == 1 and "encoding" in str(caught[0].message),
                 str([str(w.message) for w in caught]))
    for name, wanted in (("none.cube", FileNotFoundError), ("none.tone", FileNotFoundError), ("cut.cube", OSError)):
        for function in (lambda op: tw.tonemap(pixels, op), lambda op: tw.evaluate(op, COLORS),
                         lambda op: tw.bake(op, folder / "x.cube")):
            try:
                function(str(folder / name))
                report.check(f"Python: {name} raises", False)
            except wanted as e:
                report.check(f"Python: {name} raises {wanted.__name__}", name in str(e), str(e))


def test_plugin(report, plugin, command, folder):
    env = {**os.environ, "OIIO_LIBRARY_PATH": str(plugin)}
    name = "scene.exr.tonewright?op=film.cube&set.input=acescct&set.output=srgb"
    done = subprocess.run(["oiiotool", name, "-o", "plugin.exr"], cwd=folder, env=env, capture_output=True, text=True, check=False)
    if report.check("plugin: op=film.cube", done.returncode == 0, done.stdout + done.stderr):
        wanted = evaluate(command, COLORS, f"{folder / 'film.cube'}:input=acescct:output=srgb")
        report.compare("plugin: colors", read_rgb(folder / "plugin.exr", folder)[0], wanted, 2e-6)
