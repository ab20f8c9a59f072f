# SPDX-License-Identifier: Apache-2.0
"""`tonewright conformance`: the kit tests engines, and fails for the function of another operator.

    python3 -m pytest -c tests/pytest.ini tests/cli/test_conformance.py -k threejs
"""

import csv
import json
import os
import re
import shutil
import subprocess

import pytest
from executed import IS_FULL, npm_modules, pick
from pictures import PROJECT, need_program, run, skip

AGX = ["--uniform", "toneMappingExposure=1"]  # of three.js, whose exposure is a factor
LAST_LINE = re.compile(r"(\d+) colors, (\d+) failures, largest error (\S+?)(?:, line \d+)?$")


class Kits:
    """Kits by the text of their operator."""

    def __init__(self, command, folder):
        self.command, self.folder = command, folder

    def of(self, operator, *options):
        kit = self.folder / re.sub(r"\W", "_", " ".join([operator, *options]))
        if not kit.exists():
            run(self.command, "conformance", operator, *options, "-o", kit)
        return kit

    def shader(self, operator, language, name):
        """The file of Tonewright's own function, and its name."""
        path = self.folder / name
        run(self.command, "shader", operator, "--language", language, "-o", path)
        return path, "tw_" + re.sub(r"\W|look=", "_", operator).replace("__", "_")


@pytest.fixture(scope="module")
def kits(command, folder):
    return Kits(command, folder)


def rows_of(table):
    lines = [line for line in table.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def runs(*words, cwd=None, **environment):
    """Exit status and output of a runner."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, cwd=cwd,
                          env=os.environ | environment)
    return done.returncode, done.stdout + done.stderr


def node(kit, runner, *words, **environment):
    return runs("node", kit / runner, *words, **environment)


def need_browser():
    need_program("node", "nodejs")
    if not shutil.which("chromium"):
        skip("Chromium is missing (Debian: chromium)")


def passes(report, what, result):
    status, output = result
    end = LAST_LINE.search(output.strip())
    report.check(f"{what}: {end.group(0) if end else 'no result'}", status == 0 and end and end[2] == "0" and int(end[1]) > 200,
                 output[-2000:])


def fails(report, what, result):
    """The kit finds the wrong operator: it prints rows."""
    status, output = result
    end = LAST_LINE.search(output.strip())
    report.check(f"{what} fails: {end.group(0) if end else 'no result'}",
                 status == 1 and end and int(end[2]) == len(re.findall(r"(?m)^line \d+, \w+: ", output)) > 50, output[-2000:])


# --------------------------------------------------------------------------------------------------
# Engines


def three_chunk(command, folder):
    """The tone mapping functions of three.js, as its package has them."""
    chunk = npm_modules(command) / "three/src/renderers/shaders/ShaderChunk/tonemapping_pars_fragment.glsl.js"
    path = folder / "three.glsl"
    path.write_text(re.search(r"`(.*)`", chunk.read_text(), re.DOTALL)[1])
    return path


def test_threejs(report, command, kits, folder):
    """GLSL of three.js in Chromium."""
    need_browser()
    chunk = three_chunk(command, folder)
    for operator, function in (("khronos_neutral", "NeutralToneMapping"), ("aces_hill:threejs", "ACESFilmicToneMapping"),
                               ("hejl_burgess_dawson", "CineonToneMapping")):
        passes(report, f"{operator}, three.js {function}", node(kits.of(operator), "run_glsl.mjs", chunk, function, *AGX))
    # Since r161, three.js limits the result to [0, 1], which --codes does, too.
    agx = node(kits.of("agx_threejs"), "run_glsl.mjs", chunk, "AgXToneMapping", *AGX)
    beyond = [row for row in rows_of(kits.of("agx_threejs") / "colors.csv")
              if not all(-1e-6 < float(row[f"display_{c}"]) < 1 + 1e-6 for c in "rgb")]
    report.check(f"agx_threejs, three.js AgXToneMapping: fails for the {len(beyond)} colors that it clamps",
                 agx[0] == 1 and 0 < len(re.findall("(?m)^line", agx[1])) <= len(beyond), agx[1][-2000:])
    passes(report, "agx_threejs, three.js AgXToneMapping, --codes",
           node(kits.of("agx_threejs"), "run_glsl.mjs", chunk, "AgXToneMapping", *AGX, "--codes"))
    for options in ([], ["--codes"]):
        fails(report, f"agx_blender:formula, three.js AgXToneMapping {' '.join(options)}",
              node(kits.of("agx_blender:formula"), "run_glsl.mjs", chunk, "AgXToneMapping", *AGX, *options))
    fails(report, "aces_hill, three.js ACESFilmicToneMapping",
          node(kits.of("aces_hill"), "run_glsl.mjs", chunk, "ACESFilmicToneMapping", *AGX))
    fails(report, "khronos_neutral, three.js NeutralToneMapping without its exposure",
          node(kits.of("khronos_neutral"), "run_glsl.mjs", chunk, "NeutralToneMapping"))


def test_hdrify(report, command, kits, folder):
    """JavaScript of hdrify in Node.js. Its functions map whole pictures."""
    need_program("node", "nodejs")
    mappers = npm_modules(command) / "hdrify/dist/tonemapping/mappers.js"
    engine = folder / "engine.mjs"
    engine.write_text(f"import {{ getToneMapping }} from {json.dumps(mappers.as_uri())};\n" + "".join(
        f"export const {name} = (color) => {{ getToneMapping('{name}')(color, color, 1); return color; }};\n"
        for name in ("aces", "neutral", "reinhard")))
    hill = kits.of("aces_hill", "--set", "clamp=no")
    passes(report, "aces_hill without its clamp, hdrify aces", node(hill, "run_js.mjs", engine, "aces"))
    passes(report, "khronos_neutral, hdrify neutral", node(kits.of("khronos_neutral"), "run_js.mjs", engine, "neutral"))
    passes(report, "reinhard, hdrify reinhard", node(kits.of("reinhard"), "run_js.mjs", engine, "reinhard"))
    fails(report, "aces_hill:threejs, hdrify aces", node(kits.of("aces_hill:threejs"), "run_js.mjs", engine, "aces"))
    fails(report, "khronos_neutral, hdrify reinhard", node(kits.of("khronos_neutral"), "run_js.mjs", engine, "reinhard"))


# --------------------------------------------------------------------------------------------------
# Tonewright's own functions


def test_c(report, command, kits, folder):
    """All operators in full runs, else a dozen; C++ for one of them."""
    need_program("cc", "gcc")
    names = [op["id"] for op in json.loads(run(command, "list", "--json"))["operators"]]
    if not IS_FULL:
        names = dict.fromkeys([*pick(names, 10), "agx_blender", "khronos_neutral"])
    for name in names:
        kit = kits.of(name)
        header, function = kits.shader(name, "c", f"{name}.h")
        build = ["-Wall", "-Wextra", "-Werror", "-pedantic", f"-DFUNCTION={function}", "-include", header]
        run("cc", *build, kit / "run.c", "-lm", "-o", folder / f"{name}.out")
        for table in ("colors.csv", "negative.csv"):
            status, output = runs(folder / f"{name}.out", kit / table)
            report.check(f"{name} in C, {table}: {output.splitlines()[-1]}", status == 0, output[-2000:])
    build[-1], function = kits.shader("khronos_neutral", "c", "neutral.h")
    build[-3] = f"-DFUNCTION={function}"
    run("c++", "-x", "c++", *build, kits.of("khronos_neutral") / "run.c", "-lm", "-o", folder / "cpp")
    passes(report, "khronos_neutral in C++", runs(folder / "cpp", kits.of("khronos_neutral") / "colors.csv"))
    fails(report, "reinhard, khronos_neutral in C++", runs(folder / "cpp", kits.of("reinhard") / "colors.csv"))
    fails(report, "reinhard, khronos_neutral in C++, --codes",
          runs(folder / "cpp", kits.of("reinhard") / "colors.csv", "--codes"))


def check_shader(report, kits, language):
    need_browser()
    source, function = kits.shader("agx_blender:formula", language, f"agx.{language}")
    runner = f"run_{language}.mjs"
    passes(report, f"agx_blender:formula in {language}", node(kits.of("agx_blender:formula"), runner, source, function))
    fails(report, f"agx_threejs, agx_blender:formula in {language}", node(kits.of("agx_threejs"), runner, source, function))
    status, output = node(kits.of("agx_threejs"), runner, source, "missing")
    report.check(f"{language}: status 2 for an unknown function", status == 2 and "missing" in output, output)


def test_wgsl(report, kits):
    check_shader(report, kits, "wgsl")


def test_hlsl(report, kits):
    need_program("glslangValidator", "glslang-tools")
    need_program("spirv-cross", "spirv-cross")
    check_shader(report, kits, "hlsl")


def test_docs(report, command, folder):
    """The commands of docs/shaders.md, with the functions that the page takes for granted."""
    need_browser()
    page = (PROJECT / "docs/shaders.md").read_text().split("## Test your engine")[1]
    example = re.search(r"```sh\n(.*?)```", page, re.DOTALL)[1]
    printed = re.search(r"```text\n(.*?)\n```", page, re.DOTALL)[1]
    place = folder / "docs"
    place.mkdir()
    run(command, "conformance", "khronos_neutral", "-o", place / "neutral_kit")
    three_chunk(command, place).rename(place / "tonemapping.glsl")
    for language, name in (("c", "engine.h"), ("js", "engine.mjs")):
        run(command, "shader", "khronos_neutral", "--language", language, "-o", place / name)
    with (place / "engine.mjs").open("a") as module:
        module.write("\nexport { tw_khronos_neutral as toneMap };\n")
    with (place / "engine.h").open("a") as header:
        header.write("\n#define tonemap tw_khronos_neutral\n")
    for line in example.splitlines():
        status, output = runs("sh", "-ec", line, cwd=place)
        report.check(f"{line}: {output.splitlines()[-1]}", status == 0 and "286 colors, 0 failures" in output, output[-2000:])
        if "run_glsl" in line:
            # The figure is that of SwiftShader; another renderer may differ in the last place.
            report.check("the line of the docs", LAST_LINE.search(output)[0].split(",")[:2] == printed.split(",")[:2], output)


# --------------------------------------------------------------------------------------------------
# The runners and the command


def test_forms_of_functions(report, kits, folder):
    need_program("node", "nodejs")
    kit = kits.of("reinhard")
    engine = folder / "forms.mjs"
    # Reinhard et al. 2002, equation 3.
    engine.write_text("const f = (x) => x / (1 + x);\n"
                      "export const list = ([r, g, b]) => [f(r), f(g), f(b)];\n"
                      "export const numbers = (r, g, b) => Float32Array.of(f(r), f(g), f(b));\n"
                      "export const object = ([r, g, b]) => ({ r: f(r), g: f(g), b: f(b) });\n"
                      "export default { inside: list };\n"
                      "export const nothing = () => undefined;\n")
    for name in ("list", "numbers", "object", "inside"):
        passes(report, f"JavaScript, {name}", node(kit, "run_js.mjs", engine, name))
    status, output = node(kit, "run_js.mjs", engine, "nothing")
    report.check("a function without a result fails in all rows", status == 1 and "largest error Infinity" in output, output[-300:])
    results = folder / "results.csv"
    rows = rows_of(kit / "colors.csv")
    shown = [[float(row[f"scene_{c}"]) / (1 + float(row[f"scene_{c}"])) for c in "rgb"] for row in rows]
    results.write_text("# of an engine\n" + "".join(f"{r:.9g},{g:.9g},{b:.9g}\n" for r, g, b in shown))
    passes(report, "results in a file", node(kit, "run_results.mjs", results))
    shown[3][1] += 0.003  # less than a code value of 8 bits in the dark, where the table has 0.0003
    results.write_text("".join(f"{r} {g} {b}\n" for r, g, b in shown))
    status, output = node(kit, "run_results.mjs", results, "--codes")
    report.check("one wrong channel: one failure", status == 1 and "286 colors, 1 failures" in output, output)


def test_misuse(report, kits, folder):
    need_program("node", "nodejs")
    need_program("cc", "gcc")
    kit = kits.of("reinhard")
    engine = folder / "one.mjs"
    engine.write_text("export const one = () => [1, 1, 1];\nexport const throws = () => { throw new Error('no'); };\n")
    damaged = folder / "damaged.csv"
    damaged.write_text("gray,1,2,3\n")
    empty = folder / "empty.csv"
    empty.write_text("# nothing\n")
    short = folder / "short.csv"
    short.write_text("1,1,1\n")
    glsl = folder / "one.glsl"
    glsl.write_text("vec3 one(vec3 c) { return vec3(1.0); }\n")
    header = folder / "one.h"
    header.write_text("static void one(const float in[3], float out[3]) { (void)in; out[0] = out[1] = out[2] = 1; }\n")
    run("cc", "-DFUNCTION=one", "-include", header, kit / "run.c", "-lm", "-o", folder / "one")
    program = folder / "one"
    cases = [("run_js.mjs", []), ("run_js.mjs", [engine]), ("run_js.mjs", [engine, "two"]), ("run_js.mjs", [engine, "throws"]), ("run_js.mjs", [engine, "one", "--no"]),
             ("run_js.mjs", [folder / "none.mjs", "one"]), ("run_js.mjs", [engine, "one", "--table", damaged]),
             ("run_js.mjs", [engine, "one", "--table", empty]), ("run_js.mjs", [engine, "one", "--uniform", "a=1"]),
             ("run_results.mjs", [short]), ("run_results.mjs", [folder / "none.csv"]),
             ("run_glsl.mjs", [folder / "none.glsl", "one"]), ("run_glsl.mjs", [glsl, "one", "--uniform", "a=b"])]
    for runner, words in cases:
        status, output = node(kit, runner, *words)
        report.check(f"{runner} {' '.join(str(w) for w in words)}: status 2 and a reason", status == 2 and output.strip(), output)
    status, output = node(kit, "run_glsl.mjs", glsl, "one", BROWSER="no-such-browser")
    report.check("no browser: status 2, and names BROWSER", status == 2 and "BROWSER" in output, output)
    for words in ([], [folder / "none.csv"], [damaged], [empty], [kit / "colors.csv", "--code"]):
        status, output = runs(program, *words)
        report.check(f"run {' '.join(str(w) for w in words)}: status 2 and a reason", status == 2 and output.strip(), output)


def test_command(report, command, folder):
    for words, status, text in (
            (["hable"], 2, "-o"), (["-o", folder / "kit"], 2, "operator"), (["habel", "-o", folder / "kit"], 2, "hable"),
            (["reinhard_local", "-o", folder / "kit"], 2, "reinhard_local"),
            (["hable", "--display", "nix", "-o", folder / "kit"], 2, "display"),
            (["hable", "-o", "/dev/null/kit"], 3, "/dev/null/kit")):
        found, output = runs(command, "conformance", *words)
        report.check(f"conformance {' '.join(str(w) for w in words)}: status {status}", found == status and text in output, output)
    report.check("an error leaves no folder", not (folder / "kit").exists())
    found, output = runs(command, "conformance", "hable", "--set", "white=4", "--exposure", "1", "--display", "srgb", "-o", folder / "kit")
    readme = (folder / "kit/README.md").read_text()
    report.check("settings, exposure and display are in the README",
                 found == 0 and all(text in readme for text in ("white 4", "exposure 1 stops", "sRGB")), readme[:1500])
    # Decimal digits of the table, and those that `eval` prints.
    row = next(row for row in rows_of(folder / "kit/colors.csv") if row["group"] == "random")
    shown = run(command, "eval", "hable", "--set", "white=4", "--exposure", "1", "--digits", "12",
                stdin=" ".join(row[f"scene_{c}"] for c in "rgb"))
    report.check("the table has what eval prints", all(abs(float(a) - float(row[f"display_{c}"])) < 1e-11
                                                      for a, c in zip(shown.split(), "rgb")), shown)
