# SPDX-License-Identifier: Apache-2.0
"""`tonewright check`: .tone files that break each law, at places that follow from their formulas; the catalogue, which
breaks none; and the numeric inverses of .tone files, against closed forms.
"""

import json
import os
import re
import subprocess
import time
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from pictures import ALL, PROJECT, evaluate, run

LAWS = ["finite", "monotone", "bounded", "white", "black", "gray", "continuous", "inverse"]
OK, CHECK_FAILED, USAGE, FILE = 0, 1, 2, 3
CLAMP = "[[stage]]\nclamp = [0, inf]\n"
REINHARD = 'curve = "max(x, 0)/(max(x, 0) + 1)"\n'

# name: (stages, the law that breaks, its x or none, words). White is reached by none but the last ones: its law is not
# looked at unless it is named.
BROKEN = {
    # x/(x^2 + 1) has its maximum 1/2 at 1.
    "hill": ('[[stage]]\ncurve = "max(x, 0)/(x*x + 1)"\n', "monotone", 1, "fall from 0.5 at x = 1 to"),
    # r/(1 + r + (r - b)^2): of grays x/(x + 1); of red r/(1 + r + r^2), whose maximum 1/3 is at 1.
    "red": (CLAMP + '[[stage]]\ncross_talk = ["r/(1 + r + (r - b)*(r - b))", "g/(g + 1)", "b/(b + 1)"]\n', "monotone", 1,
            "red falls from"),
    "flat": (f'{CLAMP}[[stage]]\ncurve = "x < 0.02 ? 25*x : x < 2 ? 0.5 : 1 - 1/x"\n', "monotone", 0.0225, "do not get"),
    # 1.5 x/(x + 1) is 1 at 2.
    "bright": ('[[stage]]\ncurve = "1.5*max(x, 0)/(max(x, 0) + 1)"\n', "bounded", 2, "and go up to 1.5;"),
    "dim": ('[[stage]]\ncurve = "0.9*max(x, 0)/(max(x, 0) + 1)"\n', "white", 65504, "0.9 of display white"),
    "lifted": (f'[[stage]]\n{REINHARD}[[stage]]\ncurve = "0.01 + 0.99*x"\n', "black", 0, "black becomes 0.01"),
    "crushed": ('[[stage]]\ncurve = "clamp(x - 0.01, 0, 1)"\n', "black", 0.01, "grays up to"),
    # 1.055 (x/(x + 1))^(1/2.4) (1 - 0.9^(1/2.4)) in the sRGB code; half a code of 10 bits is in its straight part:
    # 12.92 * 0.1 x = 0.5/1023.
    "tinted": ('[[stage]]\ncurve = ["x/(x + 1)", "x/(x + 1)", "0.9*x/(x + 1)"]\n'.replace("x/", "max(x, 0)/")
               .replace("(x +", "(max(x, 0) +"), "gray", 0.5 / 1023 / 1.292, "grays get a tint"),
    "step": ('[[stage]]\ncurve = "clamp(x < 0.5 ? x/2 : x/2 + 0.1, 0, 1)"\n', "continuous", 0.5, "grays jump from 0.25 to 0.35"),
    "floor": (CLAMP + '[[stage]]\ncurve = "min(floor(x*2)/2 + x, 1)"\n', "continuous", 0.5, "from 0.5 to 1"),
    # Between green, 0 1 0, and yellow, 1 1 0, at level 1/2, where red is half of green.
    "hue": (CLAMP + '[[stage]]\ncross_talk = ["r > 0.5*g ? r/(r + 1) : 0.9*r/(r + 1)", "g/(g + 1)", "b/(b + 1)"]\n',
            "continuous", None, "colors between yellow and green jump"),
    # 1.1 x: the curve makes 1.1 x/(1.1 x + 1) of it.
    "lost": ('[[stage]]\ncurve = "max(x, 0)/(max(x, 0) + 1)"\ninverse = "1.1*x/(1 - x)"\n', "inverse", None,
             "the inverse of"),
    # (r - 2 g)^2 - r b/10 is negative for many colors, but for no gray and no primary.
    "imaginary": (CLAMP + '[[stage]]\ncross_talk = ["sqrt((r - 2*g)*(r - 2*g) - 0.1*r*b)", "g", "b"]\n', "finite", None,
                  "no finite number"),
}


def write(folder, name, stages, head=""):
    path = folder / f"{name}.tone"
    path.write_text(f'tonewright = 1\nid = "{name}"\n{head}{stages}')
    return path


def call(command, *arguments, **environment):
    done = subprocess.run([command, *map(str, arguments)], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})
    return done.returncode, done.stdout, done.stderr


def laws_of(command, *arguments):
    return {law["law"]: law for law in json.loads(run(command, "check", *arguments, "--json"))["laws"]}


@pytest.fixture(scope="module")
def folder(folder):
    """With a file for each entry of BROKEN."""
    for name, (stages, *_) in BROKEN.items():
        write(folder, name, stages)
    return folder


def test_broken(report, command, folder):
    for name, (_, law, x, words) in BROKEN.items():
        path = folder / f"{name}.tone"
        found = laws_of(command, path)
        report.check(f"{name}: {law} breaks", found[law]["verdict"] == "breaks" and words in found[law]["text"], found[law])
        if x is not None:
            # Places are found in steps of 1/64 stop, which is 1.1 %, or bisected.
            at = found[law]["x"]
            report.check(f"{name}: at x = {x}", at == x or (at and abs(at / x - 1) < 0.012), at)
        code, out, err = call(command, "check", path)
        report.check(f"{name}: a warning", code == OK and f"tonewright: warning: check: {path}: {law}: " in err
                     and all(line.startswith("tonewright: warning: ") for line in err.splitlines()), err)
        report.check(f"{name}: a line each", [line.split()[0] for line in out.splitlines()[-len(LAWS):]] == LAWS, out)
        code, _, err = call(command, "check", path, "--strict")
        report.check(f"{name}: --strict", code == CHECK_FAILED and len(err.splitlines()) == 1, f"{code} {err}")
    others = {name: [law for law, r in laws_of(command, folder / f"{name}.tone").items()
                     if r["verdict"] == "breaks" and law not in (BROKEN[name][1], "white")] for name in BROKEN}
    # For grays, the last one has sqrt(0.9) x beside x, without a limit.
    report.check("no other law breaks", {k: v for k, v in others.items() if v} == {"imaginary": ["bounded", "gray"]}, others)
    step = laws_of(command, folder / "step.tone")["continuous"]
    report.check("a jump is bisected to the last bits", abs(step["x"] - 0.5) < 1e-15, step["x"])


def test_declared(report, command, folder):
    declared = '[[deviation]]\nkind = "black"\nvalue = 0.01\n'
    lifted = write(folder, "declared", BROKEN["lifted"][0], declared)
    found = laws_of(command, lifted)["black"]
    report.check("declared: no warning", found["verdict"] == "as declared" and "lifts black to 0.01" in found["text"], found)
    report.check("declared: exit 0 with --strict", call(command, "check", lifted, "--strict")[::2] == (OK, ""))
    untrue = write(folder, "untrue", BROKEN["step"][0], declared)
    found = laws_of(command, untrue)["black"]
    report.check("declared, but not true", found["verdict"] == "breaks" and "remove the deviation" in found["text"], found)
    wrong = write(folder, "wrong", BROKEN["lifted"][0], declared.replace("0.01", "0.02"))
    found = laws_of(command, wrong)["black"]
    report.check("declared with another value", found["verdict"] == "breaks" and "declares 0.02" in found["text"], found)
    jump = write(folder, "jump", BROKEN["step"][0], '[[deviation]]\nkind = "jumps"\nvalue = 0.1\n')
    report.check("a jump is declared", laws_of(command, jump)["continuous"]["verdict"] == "as declared")
    peak = write(folder, "peak", BROKEN["bright"][0], "[output]\npeak = 1.5\n")
    report.check("a peak is a declaration", laws_of(command, peak)["bounded"]["verdict"] == "as declared")
    # White of 8 moves what hable's file declares for the default of 11.2.
    report.check("settings", call(command, "check", "hable:white=8", "--strict")[::2] == (OK, ""))
    report.check("--set", call(command, "check", "hable", "--set", "white=8", "--strict")[::2] == (OK, ""))


def test_catalogue(report, command):
    operators = json.loads(run(command, "list", "--json"))["operators"]
    variants = [[op["id"]] for op in operators]
    variants += [[f"{op['id']}:{preset['id']}"] for op in operators for preset in op["presets"]]
    variants += [[op["id"], "--look", look["id"]] for op in operators for look in op["looks"]]
    if not ALL:
        variants = variants[::len(variants) // 12]
    failed = {" ".join(v): call(command, "check", *v, "-q", "--strict")[2] for v in variants}
    report.check(f"{len(variants)} of the catalogue break no law", not any(failed.values()),
                 [text for text in failed.values() if text])


def test_output(report, command, folder):
    path = write(folder, "plain", f"[[stage]]\n{REINHARD}")
    start = time.perf_counter()
    _, out, err = call(command, "check", path, LC_ALL="C.UTF-8")
    report.check("below a second", time.perf_counter() - start < 1)
    lines = out.splitlines()
    plot = lines[2:22]
    report.check("a plot of at most 80 columns and 20 lines", max(map(len, plot)) <= 80 and lines[22] == "", out)
    report.check("Braille", any("\u2800" <= c <= "\u28ff" for c in out) and not err, err)
    _, ascii_plot, _ = call(command, "check", path, "--ascii", LC_ALL="C.UTF-8")
    report.check("--ascii", ascii_plot.isascii() and "*" in ascii_plot, ascii_plot)
    report.check("ASCII without UTF-8", call(command, "check", path, LC_ALL="C")[1] == ascii_plot)
    # The rows of the plot are 1/15 apart, the columns 20/72 stops: reinhard's code at each column.
    stops = -10 + 20 * np.arange(73) / 72
    light = 0.18 * 2**stops / (0.18 * 2**stops + 1)
    codes = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    rows = ascii_plot.splitlines()[3:19]
    drawn = [[row for row in range(16) if rows[row][5 + column:6 + column] == "*"] for column in range(73)]
    far = [abs(np.array(r) - 15 * (1 - c)).min() if r else 99 for r, c in zip(drawn, codes)]
    report.bound("the curve, rows", max(far), 0.5 + 1e-9)
    # Code values of mid gray and white: sRGB of 0.18/1.18 and of 1/2.
    report.check("mid gray and white", "mid gray 0.427" in ascii_plot and "white 0.735" in ascii_plot, ascii_plot)
    quiet = call(command, "check", path, "-q")[1]
    report.check("-q: no plot", [line.split()[0] for line in quiet.splitlines()] == LAWS, quiet)
    svg = folder / "plain.svg"
    code, _, _ = call(command, "check", path, "-o", svg)
    run(command, "plot", path, "-o", folder / "plot.svg")
    report.check("-o", code == OK and svg.read_text() == (folder / "plot.svg").read_text()
                 and ElementTree.fromstring(svg.read_text()).tag.endswith("svg"))
    report.check("broken places are marked", "!" in call(command, "check", folder / "step.tone", "--ascii")[1].splitlines()[19])


def test_page(report, command, folder):
    """The example of docs/tone_files.md, and what the page says that it prints."""
    page = (PROJECT / "docs" / "tone_files.md").read_text()
    definition, shown = re.search(r"cat >jump.tone <<'END'\n(.*?)END\n.*?```\n\n```text\n(.*?)```\n", page, re.S).groups()
    (folder / "jump.tone").write_text(definition)
    done = [subprocess.run([command, *arguments, "jump.tone"], cwd=folder, env={**os.environ, "LC_ALL": "C.UTF-8"},
                           stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
            for arguments in (["check"], ["eval", "--inverse"])]
    report.check("docs: check", done[0].stdout + done[0].stderr == shown, done[0].stdout)
    report.check("docs: no inverse", done[1].stderr in page, done[1].stderr)


def test_errors(report, command, folder):
    for arguments, code, words in [
        (["none.tone"], FILE, "none.tone: no such file"),
        (["habel"], USAGE, "did you mean hable?"),
        (["reinhard_local"], USAGE, "reinhard_local"),
        ([], USAGE, "operator"),
        (["hable", "--set", "white=x"], USAGE, "white is x"),
        (["hable", "-o", folder / "none" / "x.svg"], FILE, "x.svg"),
    ]:
        found, _, err = call(command, "check", *arguments)
        report.check(f"check {' '.join(map(str, arguments))}", found == code and len(err.splitlines()) == 1
                     and words.lower() in err.lower(), f"{found}: {err}")


def test_inverses(report, command, folder):
    """Operators without a formula for their inverse: eval --inverse is the inverse all the same."""
    light = np.geomspace(1e-4, 0.999, 300)
    colors = np.stack([light, light[::-1], light / 2], axis=1)

    def numeric(name, stages):
        path = write(folder, name, stages)
        return evaluate(command, colors, path, "--inverse", "--display", "native", "--digits", "17")

    # y/(1 - y), whose condition at 0.999 is 1000 times the rounding of y.
    expected = colors / (1 - colors)
    report.bound("inverse of a curve, relative", np.abs(numeric("curve", f"[[stage]]\n{REINHARD}") / expected - 1).max(), 1e-12)
    # sqrt(x): infinitely steep at black.
    report.bound("of a curve that is steep at black",
                 np.abs(numeric("root", '[[stage]]\ncurve = "sqrt(max(x, 0))"\n') / colors**2 - 1).max(), 1e-12)
    # The largest channel is the norm, and the ratios stay.
    norm = colors.max(axis=1, keepdims=True)
    scaled = numeric("scale", CLAMP + '[[stage]]\ntone_scale = "x/(x + 1)"\nnorm = "max"\n')
    report.bound("of a tone scale", np.abs(scaled / (colors / (1 - norm)) - 1).max(), 1e-12)
    weights = np.array([0.2126390058715102, 0.7151686787677559, 0.0721923153607337])
    luminance = (colors @ weights)[:, None]
    scaled = numeric("luminance", CLAMP + '[[stage]]\ntone_scale = "x/(x + 1)"\n')
    # Where the luminance is below white.
    report.bound("of a tone scale on luminance", np.abs(scaled / (colors / (1 - luminance)) - 1).max(), 1e-6)
    hue = numeric("hue", CLAMP + '[[stage]]\nhue_preserving = "x/(x + 1)"\n')
    lo, hi = colors.min(axis=1, keepdims=True), norm
    ends = [lo / (1 - lo), hi / (1 - hi)]
    report.bound("of a hue-preserving curve",
                 np.abs(hue / (ends[0] + (ends[1] - ends[0]) * (colors - lo) / (hi - lo)) - 1).max(), 1e-9)
    # Two segments that meet in a kink, and a matrix.
    matrix = np.array([[0.8, 0.1, 0.1], [0.2, 0.7, 0.1], [0.1, 0.1, 0.8]])
    kinked = numeric("kinked", f'[[stage]]\nmatrix = {matrix.tolist()}\n[[stage]]\ncurve = "min(x, x/4 + 0.3)"\n')
    back = np.maximum(colors, (colors - 0.3) * 4) @ np.linalg.inv(matrix).T
    report.bound("of a matrix and a curve with a kink", np.abs(kinked - back).max(), 1e-12)
    # A negative film: what falls is inverted as well.
    negative = numeric("negative", '[[stage]]\nclamp = [0.001, 1000]\n[[stage]]\ncurve = "1/(1 + x)"\n')
    report.bound("of a curve that falls", np.abs(negative / np.clip(1 / colors - 1, 0.001, 1000) - 1).max(), 1e-11)
    # simd: floats near 1 are 6e-8 apart, which y/(1 - y) multiplies by 1000 at 0.999. ocio: a table over half floats, which
    # are h = 2^-11 apart there; straight lines err by h^2/8 f'' = h^2/4/(1 - y)^3, relative to 9 at 0.9: 7e-6.
    for engine, highest, bound in (("simd", 1, 1000 * 6e-8), ("ocio", 0.9, 1e-5)):
        shown = evaluate(command, colors, folder / "curve.tone", "--inverse", "--display", "native", "--engine", engine)
        error = np.abs(shown / expected - 1)[colors < highest].max()
        report.bound(f"--engine {engine}, relative", error, bound)

    code, _, err = call(command, "eval", folder / "hill.tone", "--inverse")
    report.check("no inverse: the place", code == USAGE and len(err.splitlines()) == 1
                 and re.search(r"hill\.tone has no inverse: stage 1, a curve, falls from 0.5 at x = (1|0.99\d|1.00\d*) to", err), err)
    valley = write(folder, "valley", CLAMP + '[[stage]]\ncurve = "1/(1 + x) + 0.2*smoothstep(1, 1.1, x)"\n')
    code, _, err = call(command, "eval", valley, "--inverse")
    report.check("no inverse: a curve that falls, and rises at 1", code == USAGE and len(err.splitlines()) == 1
                 and re.search(r"stage 2, a curve, falls, but also rises from 0\.5\S* at x = 1\S* to 0\.6", err), err)
    code, _, err = call(command, "eval", "agx_blender", "--inverse")
    report.check("no inverse: the stage", code == USAGE and "agx_blender has no inverse: stage" in err, err)


def test_config(report, command, folder):
    """The inverse view transform of a config."""
    ocio = pytest.importorskip("PyOpenColorIO", reason="The inverse in a config is not checked: PyOpenColorIO is missing")
    path = write(folder, "curve", f"[[stage]]\n{REINHARD}")
    run(command, "config", "-o", folder / "config", "--views", path, "--displays", "srgb", "-q")
    config = ocio.Config.CreateFromFile(str(folder / "config" / "config.ocio"))
    view = ocio.DisplayViewTransform(src="lin_rec709", display="sRGB", view="curve",
                                    direction=ocio.TRANSFORM_DIR_INVERSE)
    processor = config.getProcessor(view).getDefaultCPUProcessor()
    codes = np.repeat(np.linspace(0.02, 0.98, 50)[:, None], 3, axis=1).astype(np.float32)
    light = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    scene = np.array([processor.applyRGB(c.tolist()) for c in codes])
    # docs/config.md: tables of inverses lead back within 1e-3 of the code value.
    again = scene / (scene + 1)
    shown = np.where(again <= 0.0031308, 12.92 * again, 1.055 * np.maximum(again, 1e-9) ** (1 / 2.4) - 0.055)
    report.bound("inverse view of a config, code values", np.abs(shown - codes).max(), 1e-3)
    report.check("it is not the identity", np.abs(scene - light).max() > 0.1)
