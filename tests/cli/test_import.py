# SPDX-License-Identifier: Apache-2.0
"""`tonewright import`: well-known shaders become the operators that are built in."""

import os
import re
import shutil
import subprocess

import numpy as np
from executed import npm_modules
from pictures import PROJECT, need_program, run

SHADERS = PROJECT / "tests" / "data" / "glsl"
# Rounding of a few dozen operations in double precision; the sums of AgX' polynomial and matrices cancel a hundredfold.
# It is relative for numbers above 1.
ROUNDING = 1e-12
LOTTES = ["--parameter", "hdrMax=8", "--parameter", "midIn=0.18", "--parameter", "midOut=0.267"]
# (shader, options of import, operator that it must equal, stages)
BUILT_IN = [
    ("reinhard.glsl", [], "reinhard", "clamp, curve"),
    ("reinhard_extended_luminance.glsl", ["--parameter", "white=4"], "reinhard_extended:luminance", "clamp, cross-talk"),
    ("hable.glsl", [], "hable", "clamp, curve"),
    ("aces_narkowicz.hlsl", [], "aces_narkowicz", "clamp, curve, clamp"),
    ("aces_narkowicz_srgb.frag", ["--encoded", "srgb"], "aces_narkowicz", "clamp, curve, curve"),
    ("aces_narkowicz_srgb.frag", ["--function", "aces"], "aces_narkowicz", "clamp, curve, clamp"),
    ("aces_hill.hlsl", [], "aces_hill", "clamp, matrix, curve, matrix, clamp"),
    ("aces_hill.glsl", [], "aces_hill", "clamp, matrix, curve, matrix, clamp"),
    ("uchimura.frag", [], "uchimura", "clamp, curve"),
    ("lottes.glsl", LOTTES, "lottes", "clamp, curve"),
    ("agx_minimal.glsl", ["--encoded", "gamma22"], "agx_minimal", "clamp, matrix, clamp, curve, matrix"),
    ("khronos_neutral.glsl", [], "khronos_neutral", "clamp, cross-talk"),
    ("ue3.hlsl", ["--encoded", "gamma22"], "ue3", "clamp, curve, clamp"),
    ("hejl_burgess_dawson.glsl", ["--encoded", "gamma22"], "hejl_burgess_dawson", "clamp, curve"),
    ("hejl_2015.hlsl", [], "hejl_2015", "clamp, curve"),
    ("reinhard_jodie.glsl", [], "reinhard_jodie", "clamp, cross-talk"),
    ("reinhard_gamma.glsl", ["--encoded", "gamma22", "--parameter", "exposure=1,0.01,100"], "reinhard", "clamp, curve"),
]
# Functions of glsl-tone-map: (shader, options, operator, largest light that both show, why they may differ)
PACKAGE = [
    ("aces.glsl", [], "aces_narkowicz", np.inf, ""),
    ("agx.glsl", ["--function", "agx"], "agx_threejs", 1, "the package ends with a clamp to [0, 1]"),
    ("filmic.glsl", [], "hejl_burgess_dawson", np.inf, ""),
    ("lottes.glsl", [], "lottes", np.inf, ""),
    ("neutral.glsl", [], "khronos_neutral", np.inf, ""),
    ("reinhard.glsl", [], "reinhard", np.inf, ""),
    ("reinhard2.glsl", [], "reinhard_extended", np.inf, ""),
    ("uchimura.glsl", [], "uchimura", np.inf, ""),
    ("uncharted2.glsl", [], "hable", np.inf, ""),
    ("unreal.glsl", ["--encoded", "gamma22"], "ue3", 1, "the operator ends where the display does"),
]


def colors():
    rng = np.random.default_rng(3)
    gray = 0.18 * 2.0 ** np.linspace(-14, 14, 113)
    light = 2.0 ** rng.uniform(-16, 12, (600, 3))
    light[::9, 1] = 0
    return np.concatenate([[[0, 0, 0], [65504, 0, 1e-9]], np.repeat(gray[:, None], 3, 1), light])


def light_of(command, operator, rgb):
    """Display-linear colors of `tonewright eval`, with all digits of double precision."""
    text = "\n".join(" ".join(map(repr, row)) for row in rgb.tolist()) + "\n"
    return np.array(run(command, "eval", operator, "--digits", "17", "--display", "linear", stdin=text).split(),
                    float).reshape(-1, 3)


def imported(command, shader, options, to):
    done = subprocess.run([command, "import", shader, "-o", to, *options], capture_output=True, text=True, check=False)
    return done.returncode, done.stderr.strip()


def compare(report, command, what, file, operator, limit=np.inf, rgb=None):
    rgb = colors() if rgb is None else rgb
    expected = np.clip(light_of(command, operator, rgb), None if limit == np.inf else 0, limit)
    got = np.clip(light_of(command, file, rgb), None if limit == np.inf else 0, limit)
    size = np.maximum(np.abs(expected), 1)
    report.compare(what, got / size, expected / size, ROUNDING)


def test_built_in(report, command, folder):
    negatives = np.array([[-0.2, 0.5, 1], [-1, -2, -3], [0.3, -1e-3, 4]])
    for shader, options, operator, stages in BUILT_IN:
        to = folder / "my.tone"
        status, text = imported(command, SHADERS / shader, options, to)
        if report.check(f"{shader} {' '.join(options)}: {stages}", status == 0 and f" as {stages}" in text, text):
            compare(report, command, f"{shader} equals {operator}", to, operator, rgb=np.concatenate([colors(), negatives]))
            # A function whose result is not said to be encoded is compared as light.
            report.check(f"{shader}: the line says so", re.search(rf"; it equals (.*, )?{operator}([,;]|$)", text), text)
    names = {name for name, *_ in BUILT_IN}
    report.check("all shaders are compared", names == {path.name for path in SHADERS.iterdir()})


def test_parameters(report, command, folder):
    to = folder / "lottes.tone"
    imported(command, SHADERS / "lottes.glsl", [*LOTTES[:-1], "midOut=0.267,0.1,0.5"], to)
    compare(report, command, "a uniform is a parameter", f"{to}:hdrMax=16:midOut=0.2", "lottes:hdr_max=16:mid_out=0.2")
    done = subprocess.run([command, "eval", f"{to}:midOut=0.51"], capture_output=True, text=True, check=False)
    report.check("a parameter has the range that is given", done.returncode == 2 and "[0.1, 0.5]" in done.stderr, done.stderr)
    to = folder / "hejl.tone"
    imported(command, SHADERS / "hejl_2015.hlsl", [], to)
    compare(report, command, "a default argument is a parameter", f"{to}:whitePt=4", "hejl_2015:white=4")
    # The limit of a logarithm becomes a stage, unless it is 0 in float.
    for limit, stages in ((-12, "clamp, clamp, curve"), (-2000, "clamp, curve")):
        (folder / "log.glsl").write_text(f"float f(float x) {{ return max(log2(x), {limit}.0)/20.0 + 100.0; }}\n")
        _, text = imported(command, folder / "log.glsl", [], folder / "log.tone")
        report.check(f"log2 not below {limit}: {stages}", text.endswith(f"as {stages}"), text)
        got = light_of(command, folder / "log.tone", np.array([[0, 1, 4]]))
        report.compare(f"log2 not below {limit}", got, np.array([[limit / 20 + 100, 100, 100.1]]), 100 * ROUNDING)
    shader = run(command, "shader", to, "--language", "glsl", "--uniforms", "whitePt")
    report.check("the imported operator is a shader again", "vec3 tw_hejl(" in shader and "float whitePt" in shader, shader)
    text = to.read_text()
    report.check("temporaries have the names of variables", "\nva = " in text and "\nvf = " in text, text)


def test_command(report, command, folder):
    gamma, other = SHADERS / "reinhard_gamma.glsl", folder / "kept.tone"
    exposure = ["--parameter", "exposure=1"]
    _, text = imported(command, gamma, exposure, other)
    report.check("a result that looks encoded is a warning",
                 text.startswith("tonewright: warning: import: function tonemapReinhard ends with the power 1/2.2, "), text)
    _, text = imported(command, gamma, [*exposure, "--encoded", "linear"], other)
    report.check("--encoded linear: no warning", "warning" not in text, text)
    before = other.read_bytes()
    (folder / "bright.glsl").write_text("float f(float x) { float y = x/(x + 0.18); return y; }\n")
    _, text = imported(command, folder / "bright.glsl", [], folder / "bright.tone")
    # 0.5 is 0.735 in sRGB.
    report.check("a bright mid gray is a warning", "mid gray is shown as 0.74" in text and "--encoded" in text, text)
    _, text = imported(command, folder / "bright.glsl", ["--encoded", "linear"], folder / "bright.tone")
    report.check("--encoded: no such warning", "warning" not in text, text)
    punchy = "vec3 f(vec3 c) { c = c - 0.1; return pow(c, vec3(1.35)); }\n"
    (folder / "punchy.glsl").write_text(punchy)
    _, text = imported(command, folder / "punchy.glsl", [], folder / "punchy.tone")
    report.check("powers of negatives are a warning", "warning: import: function f has powers or square roots" in text, text)
    got = light_of(command, folder / "punchy.tone", np.array([[0, 0.1, 1.1]]))
    report.compare("powers of negatives are 0", got, np.array([[0, 0, 1.0]]), ROUNDING)

    page = (PROJECT / "docs" / "tone_files.md").read_text()
    example = re.search(r"```sh\n(cat >tonemap\.glsl .*?)```", page, re.S).group(1)
    environment = {**os.environ, "PATH": f"{command.parent}:{os.environ['PATH']}"}
    done = subprocess.run(["sh", "-ec", example], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    printed = re.search(r"It prints `(film\.tone: .*?)`", page).group(1)
    report.check("the example of the docs prints what they say", printed in done.stderr, done.stderr)
    compare(report, command, "the example of the docs is reinhard_extended", f"{folder / 'film.tone'}:white=8",
            "reinhard_extended:white=8")

    copy = folder / "shader.tone"  # a shader by another name
    shutil.copy(SHADERS / "reinhard.glsl", copy)
    link = folder / "link.tone"
    os.symlink(copy, link)
    cases = [
        ("--strict", [gamma, "-o", other, *exposure, "--strict"], 1, "(an error because of --strict)"),
        ("no --parameter", [gamma, "-o", other], 3, f"{gamma}:2:40: argument exposure has no value; expected one, as with"),
        ("another function", [gamma, "-o", other, "--function", "tonemapreinhard"], 2,
         "tonewright: import: --function is tonemapreinhard; expected "),
        ("another function: the nearest", [gamma, "-o", other, "--function", "tonemapreinhard"], 2,
         "did you mean tonemapReinhard?"),
        ("no parameter of it", [gamma, "-o", other, *exposure, "--parameter", "white=1"], 2,
         "import: --parameter is white; expected exposure"),
        ("no number", [gamma, "--parameter", "exposure=a"], 2, "expected NAME=NUMBER or NAME=NUMBER,MIN,MAX"),
        ("two numbers", [gamma, "--parameter", "exposure=1,2"], 2, "expected NAME=NUMBER or NAME=NUMBER,MIN,MAX"),
        ("out of its range", [gamma, "--parameter", "exposure=1,2,3"], 2, "parameter exposure is 1; expected [2, 3]"),
        ("an encoding", [gamma, *exposure, "--encoded", "gamma"], 2, "expected linear, srgb, gamma22 or gamma24"),
        ("primaries", [gamma, *exposure, "--primaries", "rec70"], 2, "did you mean rec709?"),
        ("not a .tone file", [gamma, *exposure, "-o", folder / "x.glsl"], 2, "expected a name that ends in .tone"),
        ("the input as output", [copy, "-o", copy], 2, "the shader itself"),
        ("a link to the input as output", [copy, "-o", link], 2, "the shader itself"),
        ("no such file", [folder / "none.glsl"], 3, "none.glsl: No such file"),
        ("a folder", [folder], 3, "is a folder"),
        ("no such folder", [gamma, *exposure, "--encoded", "linear", "-o", folder / "none" / "x.tone"], 3, "No such file"),
    ]
    for what, arguments, status, text in cases:
        done = subprocess.run([command, "import", *arguments], capture_output=True, text=True, check=False)
        report.check(f"import: {what}: exit {status}", done.returncode == status and text in done.stderr,
                     f"{done.returncode}: {done.stderr}")
    report.check("what failed left the old file", other.read_bytes() == before)
    report.check("the input is not written", copy.read_bytes() == (SHADERS / "reinhard.glsl").read_bytes())
    shown = run(command, "import", SHADERS / "reinhard.glsl", "-q")
    report.check("without -o: standard output", 'curve = "x/(1 + x)"' in shown and 'id = "reinhard"' in shown, shown)


def test_npm(report, command, folder):
    """The shaders of the npm package glsl-tone-map."""
    need_program("npm", "npm")
    package = npm_modules(command) / "glsl-tone-map"
    for shader, options, operator, limit, why in PACKAGE:
        to = folder / "my.tone"
        status, text = imported(command, package / shader, options, to)
        if report.check(f"{shader}: imported", status == 0, text):
            compare(report, command, f"{shader} equals {operator}{why and ', ' + why}", to, operator, limit)
    report.check("all shaders are compared", {name for name, *_ in PACKAGE} == {path.name for path in package.glob("*.glsl")})
