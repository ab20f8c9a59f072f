# SPDX-License-Identifier: Apache-2.0
"""The tonewright command, end to end: what every subcommand does, and what it says to bad input.

Bad input gives one line on standard error that begins with `tonewright: `, the right exit code, and no file.
"""

import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from pictures import (acescct_decode, evaluate, files_of, log2_decode, need_program, read_planes, read_rgb, run,
                      share_of_refusals, skip, stack, unstack, views, write_exr)
from sanitizers import is_sanitized

try:
    import PyOpenColorIO as ocio
except ImportError:
    ocio = None

SUBCOMMANDS = ["list", "eval", "apply", "meter", "bake", "shader", "config", "verify", "chart", "sheet", "compare", "plot",
               "import", "check"]
OK, CHECK_FAILED, USAGE, FILE = 0, 1, 2, 3  # exit codes

# Half of what OpenColorIO's chain for a tone scale may differ on the CPU; on the GPU it may differ by 5e-5.
ENGINE_BOUND = {"simd": 1e-5, "ocio": 1e-5, "ocio-gpu": 5e-5}
CUBE_BOUND = 1 / 1023  # one code of 10 bits
FLOAT32 = 1e-6  # the SIMD engine, and a file of floats


# A full disk: no file may be larger than 20 blocks of 512 bytes, and the signal that comes with it is ignored.
DISK_FULL = ["sh", "-c", 'trap "" XFSZ; ulimit -f 20; exec "$0" "$@"']


def call(command, arguments, stdin="", folder=None, prefix=(), timeout=None):
    """(exit code, standard output, standard error). @throws subprocess.TimeoutExpired  after timeout seconds"""
    done = subprocess.run([*prefix, str(command), *map(str, arguments)], input=stdin.encode(), cwd=folder,
                          capture_output=True, check=False, timeout=timeout)
    return done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")


@pytest.fixture(scope="module")
def picture(command, folder):
    need_program("oiiotool", "openimageio-tools")
    run(command, "chart", "-o", folder / "small.exr", "--width", 640, "--height", 360, "-d", "half")
    return folder / "small.exr"


# --------------------------------------------------------------------------------------------------
# Commands that work


def test_help(report, command):
    for arguments in ([], *([name] for name in SUBCOMMANDS)):
        code, out, err = call(command, [*arguments, "--help"])
        report.check(f"{' '.join(arguments)} --help", code == OK and not err and "Example" in out,
                     f"exit {code}: {out}{err}")
        if not arguments:
            missing = [name for name in SUBCOMMANDS if f"\n  {name} " not in out]
            report.check("--help names every subcommand", not missing, missing)
    code, out, _ = call(command, ["--version"])
    report.check("--version", code == OK and out[:1].isdigit(), out)


def test_list(report, command):
    overview = run(command, "list")
    text = run(command, "list", "--json")
    everything = json.loads(text, parse_constant=lambda name: report.check("list --json is JSON", False, name))
    ids = [op["id"] for op in everything["operators"]]
    report.check(f"list names {len(ids)} operators, the displays and the spaces",
                 all(name in overview for name in ids + ["srgb", "rec1886", "linear", "native", "lin_ap1"]))
    report.check("list --views", [op for op, _ in views(command)] == ids
                 and [v for _, v in views(command)] == [op["view"] for op in everything["operators"]])
    markdown = run(command, "list", "--markdown")
    report.check("list --markdown has a heading for each", all(f"(`{name}`)" in markdown for name in ids))
    report.check("list: lines of at most 100 columns", max(map(len, overview.splitlines())) <= 100)
    named = [f"{mark}{entry['id']}" for op in everything["operators"]
             for mark, kind in ((":", "presets"), ("--look ", "looks")) for entry in op[kind]]
    report.check("list names presets and looks", all(name in overview for name in named))
    keys = {"id", "title", "view", "source", "output", "parameters", "presets", "looks", "warnings", "deviations",
            "dialects", "is_diagnostic"}
    parameter_keys = {"name", "kind", "unit", "default", "choices", "help"}
    bad = [name for name in ("hable", "reinhard", "agx_sobotka")
           if json.loads(run(command, "list", name, "--json")) not in everything["operators"]]
    report.check("list OPERATOR --json is what list --json has", not bad, bad)
    for op in everything["operators"]:
        if not keys <= set(op) or not all(op[k] for k in ("id", "title", "view", "source", "output")):
            bad.append(op["id"])
        for p in op["parameters"]:
            is_good = {"number": lambda p: p["min"] <= p["default"] <= p["max"] and not p["choices"],
                       "choice": lambda p: p["default"] in p["choices"] and "statistic" not in p,
                       "text": lambda p: p["default"] == "" and not p["choices"] and "statistic" not in p}
            if not parameter_keys <= set(p) or not is_good[p["kind"]](p) or p.get("statistic") == "":
                bad.append(f"{op['id']} {p['name']}")
        for d in op["deviations"]:
            if set(d) != {"kind", "value", "when", "text"} or d["text"] not in op["warnings"] \
                    or d["when"] not in ["", *(entry["id"] for entry in op["presets"] + op["looks"])]:
                bad.append(f"{op['id']} {d}")
    report.check("list --json has every field", not bad, bad)
    ops = {op["id"]: op for op in everything["operators"]}
    report.check("list --json: a statistic",
                 [p.get("statistic") for p in ops["exponential"]["parameters"]][:2] == ["mean luminance", None])
    report.check("list --json: a deviation without end has no number", ops["reinhard_extended"]["deviations"] == [
        {"kind": "exceeds_white", "value": None, "when": "", "text": "exceeds white without limit; SDR displays clip it"}])
    report.check("list --json: dialects and diagnostics",
                 ops["agx_sobotka"]["dialects"] == ops["agx_minimal"]["dialects"] == "AgX"
                 and [name for name, op in ops.items() if op["is_diagnostic"]] == ["false_color"])
    for form in ([], ["--markdown"]):
        report.check(f"list OPERATOR {' '.join(form)}: statistics, deviations, dialects, diagnostics",
                     "takes it from the picture: mean luminance" in run(command, "list", "exponential", *form)
                     and "exceeds white without limit" in run(command, "list", "reinhard_extended", *form)
                     and "agx_minimal" in run(command, "list", "agx_sobotka", *form)
                     and "shows facts about a picture" in run(command, "list", "false_color", *form))
    text = run(command, "list", "hable")
    report.check("list OPERATOR", "Uncharted" in text and "--set white=11.2" in text, text)
    report.check("list OPERATOR --markdown", run(command, "list", "hable", "--markdown") in markdown)
    # Live are the numbers of a formula without branches on them: Hable's are the letters of one fraction. BT.2390 and
    # Unreal's curve solve for their segments first, aces_20 builds tables, and a local operator has no expression.
    for name, live in (("hable", "shoulder_strength, linear_strength, linear_angle, toe_strength, toe_numerator, "
                        "toe_denominator, white, exposure_bias, saturation"), ("frostbite", "linear_end"),
                       ("bt2390", "saturation"), ("unreal", None), ("aces_20", None), ("clamp", None),
                       ("exposure_fusion", None)):
        lines = [line for line in run(command, "list", name).splitlines() if line.split()[:1] == ["live"]]
        report.check(f"list {name}: live parameters", lines == (
            [f"  live        {live} (one expression serves all their values)"] if live else []), lines)
        said = [p["name"] for p in json.loads(run(command, "list", name, "--json"))["parameters"] if p.get("live")]
        report.check(f"list {name} --json: live parameters", said == (live.split(", ") if live else []), said)


def test_eval_text(report, command):
    """Layouts of numbers, and figures of the publications to nine digits."""
    expected = "0.128338449 0.128338449 0.128338449\n"  # Hable, GDC 2010: h(2 x 0.18) / h(11.2)
    layouts = {
        "spaces": "0.18 0.18 0.18\n", "commas": "0.18,0.18,0.18\n", "commas and spaces": " 0.18, 0.18 ,0.18 \n",
        "tabs": "\t0.18\t0.18\t0.18\t\n", "comment behind": "0.18 0.18 0.18 # mid gray\n",
        "comments and blank lines": "# a\n\n   \n#\n0.18 0.18 0.18\n", "CRLF": "\r\n# b\r\n0.18 0.18 0.18\r\n",
        "exponents": "1.8e-1 18E-2 +0.018e+1\n", "no newline at the end": "0.18 0.18 0.18",
    }
    out = run(command, "eval", "hable", "--display", "native", stdin="".join(layouts.values())).splitlines(True)
    for name, line in zip(layouts, out):
        report.check(f"eval: {name}", line == expected, f"is {line.strip()}, expected {expected.strip()}")
    report.check("eval: as many colors as lines that hold one", len(out) == len(layouts), len(out))
    for name, text in {"nothing": "", "only comments": "# a\n\n# b"}.items():
        report.check(f"eval: {name}", call(command, ["eval", "hable"], text) == (OK, "", ""))

    for operator, pairs in {
        # 9/59. NaN is 0, and infinities are the largest half float: 65504 / 65505.
        "reinhard": {"0.18 1 4": "0.152542373 0.5 0.8", "nan inf -inf": "0 0.999984734 0",
                     "NaN Infinity -1e999": "0 0.999984734 0", "1e-400 1e400 1e-5": "0 0.999984734 9.9999e-06"},
        "reinhard_extended": {"0.18 4 16": "0.154258475 1 1.88235294"},  # white 4: 32/17
        "hable": {"0.18 1 5.6": "0.128338449 0.492918546 1"},
        "aces_narkowicz": {"0.18 1 16": "0.26689892 0.803797468 1"},
        "clamp": {"-0.1 0.18 4": "0 0.18 1"},
    }.items():
        out = run(command, "eval", operator, "--display", "native", stdin="\n".join(pairs)).splitlines()
        for (text, expected), line in zip(pairs.items(), out):
            report.check(f"eval {operator}: {text}", line == expected, f"is {line}, expected {expected}")
    # IEC 61966-2-1 of 0.5; and one stop more is the same as twice the light.
    _, out, _ = call(command, ["eval", "clamp"], "0.5 0.25 1")
    report.check("eval clamp, srgb by default", out == "0.735356983 0.53709873 1\n", out)
    report.check("eval --exposure -1", run(command, "eval", "clamp", "--exposure", "-1", stdin="1 0.5 2") == out)
    report.check("eval operator:preset", run(command, "eval", "reinhard:luminance", stdin="1 0.2 0.1")
                 == run(command, "eval", "reinhard", "--set", "apply=luminance", stdin="1 0.2 0.1")
                 != run(command, "eval", "reinhard", stdin="1 0.2 0.1"))
    # Hable is 1 where bias x light is the white.
    report.check("eval --set, two of them",
                 run(command, "eval", "hable", "--set", "white=4", "--set", "exposure_bias=1", stdin="4 4 4")
                 == "1 1 1\n")
    report.check("eval --look", run(command, "eval", "agx_sobotka", "--look", "punchy", stdin="1 .5 .2")
                 != run(command, "eval", "agx_sobotka", stdin="1 .5 .2"))
    report.check("eval: display by title, input by alias",
                 run(command, "eval", "hable", "--display", "Display P3", "--input", "acescg", stdin="1 .5 .2")
                 == run(command, "eval", "hable", "--display", "display_p3", "--input", "lin_ap1", stdin="1 .5 .2"))
    # Report ITU-R BT.2408: 203 cd/m2 is a PQ signal of 0.58, and of 0.75 in HLG.
    for display, white, expected in (("rec2100_pq", 100, "0.508078422"), ("p3d65_pq", 203, "0.580688881"),
                                     ("rec2100_hlg", 100, "0.629620321"), ("Rec.2100-HLG", 203, "0.749877365"),
                                     ("srgb", 100, "1")):
        out = run(command, "eval", "clamp", "--display", display, "--reference-white", white, stdin="1 1 1")
        report.check(f"eval --display {display} --reference-white {white}", out.split() == [expected] * 3, out)
    for display, operator, decided in (
            ("rec2100_pq", "aces_20", ["peak=1000", "limit=rec2020"]), ("display_p3", "aces_20", ["limit=p3d65"]),
            ("p3d65_pq", "aces_13", ["output=hdr_1000", "limit=p3d65"]), ("rec2100_hlg", "agx_blender", ["range=hdr"]),
            ("rec2100_pq", "uchimura", ["max_brightness=10"]), ("rec2020", "agx_blender", ["limit=rec2020"]),
            ("rec2100_pq", "gt7", ["output=hdr", "peak=1000"]), ("rec2100_hlg", "gt7:hdr", ["peak=1000"]),
            ("rec2100_pq", "bt2390", ["target_peak=1000", "output=hdr"])):
        settings = [text for setting in decided for text in ("--set", setting)]
        told, left = (run(command, "eval", operator, "--display", display, *words, stdin="9 2 .5")
                      for words in (settings, []))
        report.check(f"eval: {display} decides {' '.join(decided)} of {operator}", told == left, f"{told}{left}")
    # aces2_inverse_100nit-REC709 of the reference collection: within 5e-7 of OpenColorIO 2.5.1's code in double.
    out = run(command, "eval", "aces_20", "--inverse", "--display", "native", "--input", "lin_ap0", stdin="0.2 0.1 0.8")
    report.check("eval --inverse", np.allclose([float(v) for v in out.split()], [0.481954734, 0.311477121, 1.324501466],
                                               rtol=2e-6, atol=0), out)
    there = run(command, "eval", "aces_20", "--display", "rec2100_pq", "--exposure", 1, stdin="0.3 0.2 0.05")
    out = run(command, "eval", "aces_20", "--display", "rec2100_pq", "--exposure", 1, "--inverse", stdin=there)
    report.check("eval --inverse of a display", np.allclose([float(v) for v in out.split()], [0.3, 0.2, 0.05],
                                                            rtol=1e-5), out)
    out = [run(command, "eval", "aces_20", "--display", "rec2100_pq", *words, stdin="50 50 50")
           for words in ([], ["--set", "peak=500"], ["--set", "peak=500", "--reference-white", "200"])]
    report.check("eval: a setting wins over the display", out[1] < out[0] and out[1] < out[2], out)
    # 9/59, the double nearest to which has 17 digits.
    for digits, text in ((1, "0.2"), (4, "0.1525"), (9, "0.152542373"), (17, repr(9 / 59))):
        out = run(command, "eval", "reinhard", "--display", "native", "--digits", digits, stdin="0.18 0.18 0.18")
        report.check(f"eval --digits {digits}", out == f"{text} {text} {text}\n" or
                     digits == 17 and np.allclose([float(x) for x in out.split()], 9 / 59, rtol=4e-16, atol=0), out)
    report.check("eval: parameters that a picture has are the defaults",
                 run(command, "eval", "exponential", stdin="1 .5 .2")
                 == run(command, "eval", "exponential", "--set", "average=1", stdin="1 .5 .2"))
    many = "".join(f"{i / 1000} {i % 7} {i % 11}\n" for i in range(5000))
    report.check("eval: 5000 lines", len(run(command, "eval", "hable", stdin=many).splitlines()) == 5000)


def test_names(report, command):
    """One grammar for all: what is typed in another way is the same operator, display, space, engine."""
    colors = "1 .5 .2"
    punchy = run(command, "eval", "agx_blender", "--look", "punchy", stdin=colors)
    for name in ("AgX Punchy", "agx-punchy", "AGX_PUNCHY", "agx_blender:look=punchy", "AgX:look=Punchy"):
        report.check(f"eval {name!r}", run(command, "eval", name, stdin=colors) == punchy)
    white = run(command, "eval", "hable", "--set", "white=4", stdin=colors)
    for words in (["hable:white=4"], ["Hable:WHITE=4"], ["hable", "--set", "White=4"], ["HABLE white=4"]):
        report.check(f"eval {' '.join(words)}", run(command, "eval", *words, stdin=colors) == white)
    report.check("eval: display, space and engine",
                 run(command, "eval", "hable", "--display", "DISPLAY-p3", "--input", "Lin_AP1", "--engine", "SIMD",
                     stdin=colors)
                 == run(command, "eval", "hable", "--display", "display_p3", "--input", "lin_ap1", "--engine", "simd",
                        stdin=colors))
    report.check("list of a view's name", run(command, "list", "agx") == run(command, "list", "agx_blender"))
    for arguments in (["help"], ["help", "eval"]):
        code, out, err = call(command, arguments)
        report.check(" ".join(arguments), code == OK and (out, err) == (run(command, *arguments[1:], "--help"), ""), err)


def test_coprocess(report, command):
    """`eval` answers a line before it reads the next; a line has a limit; what is wrong with the input is said of it."""
    with subprocess.Popen([command, "eval", "reinhard", "--display", "native"], stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE) as process:
        for text, expected in ((b"1 1 1\n", b"0.5 0.5 0.5\n"), (b"# no color\n3 3 3\n", b"0.75 0.75 0.75\n"),
                               (b"1 1", b""), (b" 3\n", b"0.5 0.5 0.75\n")):
            process.stdin.write(text)
            process.stdin.flush()
            if expected:
                # Without an answer this waits until the test's time is over.
                answer = process.stdout.readline()
                report.check(f"eval answers {text}", answer == expected, answer)
        process.stdin.close()
        report.check("eval ends with its input", process.wait() == OK and process.stdout.read() == b"")
    code, out, err = call(command, ["eval", "hable"], "1 1 1\n" + "1" * 100000)
    report.check("eval: a line without end", code == USAGE and out.count("\n") == 1 and "line 2" in err
                 and "65536 bytes" in err, err[:200])
    folder = os.open("/", os.O_RDONLY)
    done = subprocess.run([command, "eval", "hable"], stdin=folder, capture_output=True, check=False)
    os.close(folder)
    report.check("eval: standard input is a folder", done.returncode == FILE
                 and done.stderr.startswith(b"tonewright: read: standard input: "), done.stderr)


@pytest.mark.share(3)
def test_apply_many(report, command, scratch, picture):
    """Several pictures, folders and lists into a folder; -o; AgX where no operator is named."""
    def applied(*arguments):
        return call(command, ["apply", *arguments], folder=scratch)

    (scratch / "in").mkdir()
    for name in ("b.exr", "a.exr", "a*?[x].exr", ".hidden.exr"):
        shutil.copy(picture, scratch / "in" / name)
    (scratch / "in" / "readme.txt").write_text("no picture")
    (scratch / "list.txt").write_text("# the second\n\nin/b.exr\n")
    run(command, "apply", picture, scratch / "one.png", "--operator", "agx_blender")
    expected = (scratch / "one.png").read_bytes()
    code, _, err = applied(picture, "-o", "two.png")
    report.check("apply without an operator is AgX, and says so", code == OK and "agx_blender (AgX)" in err
                 and (scratch / "two.png").read_bytes() == expected, err)
    report.check("apply -q without an operator says nothing", applied(picture, "-o", "two.png", "-q") == (OK, "", ""))
    code, _, err = applied(picture, "-o", "two.png", "-v", "--operator", "agx_blender", "--exposure", "1")
    report.check("apply -v says what was done", code == OK and err.count("\n") == 1 and all(
        word in err for word in ("640 x 360 half", "lin_rec709", "two.png", "AgX (agx_blender)", "+1", "srgb")), err)
    for what, arguments, names in (
            ("two pictures", ["in/a.exr", "in/b.exr", "-o", "o1", "--format", "png"], ["a.png", "b.png"]),
            ("a folder", ["in", "-o", "o2/", "--format", ".png"], ["a*?[x].png", "a.png", "b.png"]),
            ("a list", ["@list.txt", "-o", "o3", "--format", "png"], ["b.png"]),
            ("one picture into a folder", ["in/a.exr", "-o", "o4/", "--format", "png"], ["a.png"]),
            ("a name with *?[]", ["in/a*?[x].exr", "-o", "o5/", "--format", "png"], ["a*?[x].png"])):
        code, out, err = applied(*arguments, "--operator", "agx_blender")
        made = scratch / arguments[arguments.index("-o") + 1]
        report.check(f"apply: {what}", (code, out, err) == (OK, "", "") and sorted(os.listdir(made)) == names
                     and all((made / name).read_bytes() == expected for name in names), err)
    (scratch / "in" / "b.exr").write_bytes(b"no picture")
    code, _, err = applied("in", "-o", "o6", "--format", "png", "--operator", "hable")
    report.check("apply: one of several fails", code == CHECK_FAILED and "in/b.exr: cannot read" in err
                 and "3 pictures: 2 written, 1 failed" in err
                 and sorted(os.listdir(scratch / "o6")) == ["a*?[x].png", "a.png"], err)
    run(command, "bake", "clamp", "--3d", "--size", "17", "-o", scratch / "x.cube")
    code, _, err = applied("in/a.exr", "@list.txt", "-o", "o7", "--lut", "x.cube", "--input-encoding", "acescct",
                           "--format", "png")
    report.check("apply --lut: several", code == CHECK_FAILED and os.listdir(scratch / "o7") == ["a.png"], err)
    (scratch / "y.cube").write_text("LUT_1D_SIZE 2\n0 0 0\n1 1 1\n")
    code, _, err = applied("in/a.exr", picture, "-o", "o8", "--lut", "y.cube", "--format", "png")
    report.check("apply --lut: an unknown encoding is told once", code == OK and len(os.listdir(scratch / "o8")) == 2
                 and err.count("y.cube: the file does not say which encoding it expects") == 1, err)


@pytest.mark.share(3)
def test_limits(report, command, scratch, picture):
    """Files with control characters in their names, a file that may not become larger, an interrupt while a config is made, memory that does not do."""
    code, _, err = call(command, ["bake", "agx_sobotka", "--nodes", "sampled", "-o", scratch / "x.cube"],
                        prefix=["sh", "-c", 'ulimit -f 20; exec "$0" "$@"'])
    report.check("SIGXFSZ ends nothing", code == FILE and "File too large" in err and not os.listdir(scratch), err)
    code, out, err = call(command, ["bake", "hable", "--input", "lin_rec709", "-o", "a\x1b[31m\n.cube"], folder=scratch)
    report.check("bake: a name with control characters", code == OK and "\x1b" not in err and err.count("\n") >= 1
                 and all(line.startswith("a?[31m .cube: ") for line in err.splitlines()), err)
    (scratch / "a\x1b[31m\n.cube").unlink()
    report.check("bake -q", call(command, ["bake", "hable", "--input", "lin_rec709", "-o", "x.cube", "-q"], folder=scratch) == (OK, "", ""))
    (scratch / "x.cube").unlink()
    if is_sanitized(command):
        print("skipped: memory that does not do, sanitizers take all addresses")
    else:
        code, _, err = call(command, ["compare", picture, "hable", "--cell-width", "12000", "-o", "x.png"], folder=scratch,
                            prefix=["sh", "-c", 'ulimit -v 1200000; exec "$0" "$@"'])
        report.check("memory that does not do", code == FILE and err == f"tonewright: {picture}: not enough memory\n", err)
        call(command, ["bake", "agx_sobotka", "--3d", "--size", "17", "--nodes", "sampled", "-o", "small.cube", "-q"], folder=scratch)
        # How many threads fit into what is left depends on when each one starts: 130 MB do, or do not.
        for limit in (50000, 90000, 130000):
            code, _, err = call(command, ["verify", "--lut", "small.cube"], folder=scratch,
                                prefix=["sh", "-c", f'ulimit -v {limit}; exec "$0" "$@"'])
            report.check(f"verify --lut: addresses limited to {limit} kB", (limit > 90000 and code == OK) or (
                code == FILE and err.count("\n") == 1 and "not enough memory" in err), f"exit {code}: {err}")
        (scratch / "small.cube").unlink()
        code, out, err = call(command, ["apply", picture, "x.png", "--operator", "hable"], folder=scratch,
                              prefix=["sh", "-c", 'ulimit -v 200000; exec "$0" "$@"'])
        report.check("without OpenImageIO, addresses limited to 200000 kB do", (code, out, err) == (OK, "", ""), err)
        (scratch / "x.png").unlink(missing_ok=True)
        # Where the loader gets no addresses, and where pictures can be read. In between, libraries below OpenImageIO that get
        # no memory or thread while they are loaded end the process in words of their own, or wait forever.
        for limit in (60000, 300000, 600000):
            code, out, err = call(command, ["apply", picture, "x.tif", "--operator", "hable"], folder=scratch,
                                  prefix=["sh", "-c", f'ulimit -v {limit}; exec "$0" "$@"'])
            (scratch / "x.tif").unlink(missing_ok=True)
            report.check(f"addresses limited to {limit} kB", not out and not os.listdir(scratch) and (
                (code, err) == (OK, "") if limit > 300000 else
                code == FILE and err.startswith("tonewright: ") and err.count("\n") == 1 and "not enough memory" in err),
                f"exit {code}: {err}")
        # Near the edge the command works, says in one line why it does not, or waits forever. It leaves no partial file.
        for limit in (410000, 485000):
            try:
                code, out, err = call(command, ["apply", picture, "x.tif", "--operator", "hable"], folder=scratch,
                                      prefix=["sh", "-c", f'ulimit -v {limit}; exec "$0" "$@"'], timeout=20)
            except subprocess.TimeoutExpired:
                code, out, err = None, "", ""
            if code == OK:
                (scratch / "x.tif").unlink(missing_ok=True)
            report.check(f"addresses limited to {limit} kB: no partial file", not out and not os.listdir(scratch) and (
                (code, err) in ((OK, ""), (None, "")) or
                code == FILE and err.startswith("tonewright: ") and err.count("\n") == 1), f"exit {code}: {err}{os.listdir(scratch)}")
    with subprocess.Popen([command, "config", "-o", scratch / "new" / "config", "--views", "all"],
                          stderr=subprocess.DEVNULL) as process:
        while not (scratch / "new" / "config").exists() and process.poll() is None:
            time.sleep(0.01)
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        report.check("SIGINT: ended by it", process.wait() == -signal.SIGINT)
    report.check("SIGINT leaves no empty folder", not os.listdir(scratch), os.listdir(scratch))


def test_engines(report, command):
    """One operator of each structure: curves, matrices and curves, a tone scale, a cube. `verify` has them all."""
    rng = np.random.default_rng(5)
    grays = np.repeat(0.18 * 2.0 ** np.arange(-10, 11)[:, None], 3, axis=1)
    rgb = np.concatenate([grays, 2.0 ** rng.uniform(-10, 8, (300, 3)), [[0, 0, 0], [-0.1, 0.2, 0.5], [1e9, 1, 0]]])
    rgb = rgb.astype(np.float32)  # what the other engines take
    for operator in ("hable", "agx_sobotka", "reinhard:luminance", "reinhard_jodie"):
        truth = evaluate(command, rgb, operator)
        for engine in ("simd", "ocio", "ocio-gpu"):
            what = f"eval {operator} --engine {engine}"
            try:
                shown = evaluate(command, rgb, operator, "--engine", engine)
            except RuntimeError as error:
                if engine != "ocio-gpu" or "gpu" not in str(error):
                    raise
                print(f"skipped: {what} ({error})")
                continue
            is_cube = operator == "reinhard_jodie" and engine != "simd"
            report.compare(what, shown, truth, CUBE_BOUND if is_cube else ENGINE_BOUND[engine])
    # Reads no colors. Two stops are a factor 4; a tape without it does not compute them.
    text = run(command, "eval", "reinhard_jodie", "--exposure", 2, "--explain")
    parts = re.split(r"\n(?=\S)", text)
    tape = next((part for part in parts if part.startswith("Tape: ")), "")
    report.check("eval --explain: tape", re.search(r"^  %\d+ = 4$", tape, re.M) and "outputs %" in tape, text[:2000])
    report.check("eval --explain: a line for each value",
                 tape.count(" = ") == int(re.search(r"Tape: (\d+)", tape)[1]), tape)
    for word in ("After rewriting", "Curves: ", "Program: ", "Machine code: "):
        report.check(f"eval --explain: {word}", any(part.lstrip().startswith(word) for part in parts), text[-2000:])


@pytest.mark.share(3)
def test_apply(report, command, scratch):
    """Pictures of every channel layout, and pixel types."""
    rng = np.random.default_rng(2)
    rgb = (2.0 ** rng.uniform(-8, 4, (24, 32, 3))).astype(np.float32)
    truth = evaluate(command, rgb.reshape(-1, 3), "hable").reshape(rgb.shape)
    source, out = scratch / "source.exr", scratch / "out.exr"
    write_exr(source, unstack(rgb))

    def applied(*options, to=out):
        run(command, "apply", source, to, "--operator", "hable", *options)
        return read_planes(to, scratch)

    report.compare("apply -d float", stack(applied("-d", "float")), truth, FLOAT32)
    report.check("apply --threads 1, the same bits", np.array_equal(
        stack(applied("-d", "float", "--threads", "1")), stack(applied("-d", "float", "--threads", "7"))))
    # Half an ulp of a half float below 1, and half a code.
    report.compare("apply -d half", stack(applied("-d", "half")), truth, 2.0**-12 + FLOAT32)
    for kind, top in (("uint8", 255), ("uint16", 65535)):
        shown = stack(applied("-d", kind, to=scratch / "out.png"))
        report.compare(f"apply -d {kind} to PNG", shown, truth, 0.5 / top + FLOAT32)
    dithered = stack(applied("-d", "uint8", "--dither", to=scratch / "dithered.png"))
    applied("-d", "float")
    # `--dither` of oiiotool takes another pattern for every file name.
    run("oiiotool", out, "--attrib:type=int", "oiio:dither", "1", "-d", "uint8", "-o", scratch / "by_oiiotool.png")
    report.check("apply --dither is oiiotool's", np.array_equal(
        dithered, read_rgb(scratch / "by_oiiotool.png", scratch)))
    report.check("apply --dither changes the picture", not np.array_equal(dithered, np.round(truth * 255) / 255))
    for kind, options, bound in (("tif", ["-d", "float"], FLOAT32), ("tif", [], 0.5 / 255 + FLOAT32),
                                 ("tga", [], 0.5 / 255 + FLOAT32), ("bmp", [], 0.5 / 255 + FLOAT32),
                                 ("dpx", ["-d", "uint16"], 0.5 / 65535 + FLOAT32),
                                 # 8 bits beside a common exponent, cut off: at 1 a step is 2^-7.
                                 ("hdr", [], 2.0**-7)):
        what = f"apply to .{kind} {' '.join(options)}"
        try:
            report.compare(what, stack(applied(*options, to=scratch / f"out.{kind}")), truth, bound)
        except RuntimeError as error:
            report.check(what, False, error)
    report.compare("apply --exposure --set --display --input",
                   stack(applied("-d", "float", "--exposure", "1.5", "--set", "white=6", "--display", "rec2020",
                                 "--input", "lin_ap1")),
                   evaluate(command, rgb.reshape(-1, 3), "hable", "--exposure", "1.5", "--set", "white=6", "--display",
                            "rec2020", "--input", "lin_ap1").reshape(rgb.shape), FLOAT32)

    write_exr(source, {**unstack(rgb), "Z": rgb[..., 0] * 100})
    planes = applied("-d", "float")
    report.check("apply: a fourth channel is copied", np.array_equal(planes["Z"], rgb[..., 0] * 100))
    report.compare("apply: beside a fourth channel", stack(planes), truth, FLOAT32)

    alpha = rng.random(rgb.shape[:2]).astype(np.float32)
    write_exr(source, {**unstack(rgb * alpha[..., None]), "A": alpha})
    planes = applied("-d", "float")
    report.check("apply: alpha is copied", np.array_equal(planes["A"], alpha))
    report.compare("apply: divides by alpha and multiplies", stack(planes), truth * alpha[..., None], FLOAT32)
    report.check("apply --unpremult is the same",
                 np.array_equal(stack(applied("-d", "float", "--unpremult")), stack(planes)))
    straight = evaluate(command, (rgb * alpha[..., None]).reshape(-1, 3), "hable").reshape(rgb.shape)
    report.compare("apply --no-unpremult", stack(applied("-d", "float", "--no-unpremult")), straight, FLOAT32)

    gray = rgb[..., 0]
    gray_truth = evaluate(command, np.repeat(gray.reshape(-1, 1), 3, axis=1), "hable")[:, 0].reshape(gray.shape)
    write_exr(source, {"Y": gray})
    planes = applied("-d", "float")
    report.check("apply: one channel stays one", list(planes) == ["Y"], list(planes))
    report.compare("apply: one channel is gray", planes["Y"][..., None], gray_truth[..., None], FLOAT32)
    write_exr(source, {"Y": gray * alpha, "A": alpha})
    planes = applied("-d", "float")
    report.check("apply: gray and alpha stay two", sorted(planes) == ["A", "Y"], list(planes))
    report.compare("apply: gray with alpha", planes["Y"][..., None], (gray_truth * alpha)[..., None], FLOAT32)

    write_exr(source, unstack(rgb))
    run(command, "apply", source, source, "--operator", "hable", "-d", "float", "--in-place")
    report.compare("apply onto itself", read_rgb(source, scratch), truth, FLOAT32)


@pytest.mark.share(3)
def test_statistics(report, command, scratch):
    """Parameters that a picture has: measured here with NumPy, in double."""
    rng = np.random.default_rng(8)
    rgb = (2.0 ** rng.uniform(-9, 5, (40, 50, 3))).astype(np.float32)
    rgb[:3] = 0  # black counts in the mean, not in the mean of logarithms
    source, out = scratch / "source.exr", scratch / "out.exr"
    write_exr(source, unstack(rgb))
    light = rgb.reshape(-1, 3).astype(float)
    luminance = light @ [0.2126, 0.7152, 0.0722]
    mean, maximum = luminance.mean(), luminance.max()
    log_average = np.exp(np.log(luminance[luminance > 0]).mean())

    def applied(*options):
        code, printed, errors = call(command, ["apply", source, out, "-d", "float", *options])
        # Code values of sRGB in a file that most applications read as linear light.
        warned = errors == f"tonewright: warning: {out}: most applications read OpenEXR as linear light, but the file " \
                           "holds code values of sRGB; for linear light, use --display linear\n"
        report.check(f"apply {' '.join(map(str, options))}: one warning", code == OK and not printed and warned,
                     printed + errors)
        return stack(read_planes(out, scratch))

    def evaluated(operator, *options):
        return evaluate(command, light, operator, *options).reshape(rgb.shape)

    for operator, settings in (("exponential", {"average": mean}), ("linear", {"divisor": maximum}),
                               ("drago", {"log_average": log_average, "maximum": maximum})):
        texts = [text for name, value in settings.items() for text in ("--set", f"{name}={float(value)!r}")]
        truth = evaluated(operator, *texts)
        shown = applied("--operator", operator)
        report.compare(f"apply {operator}: parameters from the picture", shown, truth, FLOAT32)
        report.check(f"apply {operator}: not the defaults", np.abs(shown - evaluated(operator)).max() > 0.01)
        report.check(f"apply {operator} --statistics picture is the default",
                     np.array_equal(applied("--operator", operator, "--statistics", "picture"), shown))
        report.compare(f"apply {operator} --statistics defaults",
                       applied("--operator", operator, "--statistics", "defaults"), evaluated(operator), FLOAT32)
    report.compare("apply --set wins over the picture", applied("--operator", "exponential", "--set", "average=3"),
                   evaluated("exponential", "--set", "average=3"), FLOAT32)
    report.compare("apply --set of one, the other from the picture",
                   applied("--operator", "drago", "--set", "maximum=50"),
                   evaluated("drago", "--set", "maximum=50", "--set", f"log_average={float(log_average)!r}"), FLOAT32)
    report.compare("apply --exposure comes on top of the statistics",
                   applied("--operator", "exponential", "--exposure", "1"),
                   evaluated("exponential", "--exposure", "1", "--set", f"average={float(mean)!r}"), FLOAT32)
    code, printed, errors = call(command, ["apply", source, out, "--operator", "drago", "--display", "linear", "--strict"])
    report.check("apply --display linear --strict to EXR: no warning", code == OK and not printed + errors, printed + errors)
    old = out.read_bytes()
    code, _, errors = call(command, ["apply", source, out, "--operator", "drago", "--strict"])
    report.check("apply --strict to EXR: an error, and the old file stays", code == CHECK_FAILED and "--strict" in errors
                 and errors.count("\n") == 1 and out.read_bytes() == old, errors)
    report.check("apply with statistics: --threads 1, the same bits", np.array_equal(
        applied("--operator", "drago", "--threads", "1"), applied("--operator", "drago", "--threads", "7")))


@pytest.mark.share(3)
def test_frames(report, command, scratch, picture):
    """The frames of a shot: the files that one call for each makes; the failure of one is not that of the others."""
    def names():
        return sorted(path.name for path in scratch.glob("out.*"))

    def applied(frames, *options, to="out.####.png", shot="shot.%04d.exr"):
        for path in scratch.glob("out.*"):
            path.unlink()
        return call(command, ["apply", shot, to, "--frames", frames, "--operator", "hable", *options], folder=scratch)

    for number in (998, 999, 1000, 1001, 1003, 10000):
        run("oiiotool", picture, "--mulc", 1 + number / 1000, "-d", "half", "-o", scratch / f"shot.{number:04d}.exr")
        run(command, "apply", scratch / f"shot.{number:04d}.exr", scratch / f"one.{number:04d}.png", "--operator",
            "hable")
    report.check("apply --frames 998-1001", applied("998-1001") == (OK, "", "")
                 and names() == ["out.0998.png", "out.0999.png", "out.1000.png", "out.1001.png"], names())
    report.check("apply --frames: the same files as one by one", all(
        (scratch / name).read_bytes() == (scratch / name.replace("out", "one")).read_bytes() for name in names()))
    for frames, to, expected in (("999-1003x2", "out.%04d.png", ["out.0999.png", "out.1001.png", "out.1003.png"]),
                                 ("1003-998x5", "out.%d.png", ["out.1003.png", "out.998.png"]),
                                 ("998,10000", "out.#.png", ["out.0998.png", "out.10000.png"]),
                                 ("10000,998", "out.######.png", ["out.000998.png", "out.010000.png"])):
        report.check(f"apply --frames {frames} {to}",
                     applied(frames, to=to) == (OK, "", "") and names() == expected, names())
    for threads in (1, 7):
        code, out, err = applied("1000-1003", "--threads", threads)
        lines = err.splitlines()
        report.check(f"apply --frames, one is missing, --threads {threads}", code == CHECK_FAILED and not out
                     and len(lines) == 2
                     and all(line.startswith("tonewright: apply: ") for line in lines)
                     and "shot.1002.exr: cannot read" in lines[0] and "4 frames: 3 written, 1 failed: 1002" in lines[1]
                     and names() == ["out.1000.png", "out.1001.png", "out.1003.png"], f"exit {code}, {names()}: {err}")
    large = scratch / "large.exr"
    run("oiiotool", "--pattern", "noise", "4096x4096", 3, "-d", "half", "-o", large)
    (scratch / "stopped.exr").write_text("the old file")
    for end in (signal.SIGINT, signal.SIGTERM):
        process = subprocess.Popen([command, "apply", large, scratch / "stopped.exr", "--operator", "aces_20"])
        while process.poll() is None and not list(scratch.glob(".stopped*")):
            time.sleep(0.002)
        process.send_signal(end)
        report.check(f"apply, {end.name}: the old file whole and nothing beside it", process.wait() == -end
                     and (scratch / "stopped.exr").read_text() == "the old file" and not list(scratch.glob(".stopped*")),
                     f"exit {process.returncode}, {list(scratch.glob('.stopped*'))}")
    write_exr(scratch / "shot.1002.exr", {"X": np.zeros((4, 4), np.float32), "Y": np.zeros((4, 4), np.float32)})
    code, _, err = applied("1001-1002")
    report.check("apply --frames, one has no color", code == CHECK_FAILED and "shot.1002.exr: " in err and "2 channels" in err
                 and names() == ["out.1001.png"], f"exit {code}: {err}")
    code, _, err = call(command, ["apply", "none.%04d.exr", "out.png", "--operator", "hable"], folder=scratch)
    report.check("apply of a pattern names --frames", code == FILE and "--frames" in err and err.count("\n") == 1, err)


def read_lut(path, codes):
    """Codes through a LUT file as OpenColorIO reads it."""
    image = np.array(codes, np.float32, order="C")
    transform = ocio.FileTransform(src=str(path), interpolation=ocio.INTERP_TETRAHEDRAL)
    processor = ocio.Config.CreateRaw().getProcessor(transform)
    processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(image)
    return image


@pytest.mark.share(3)
def test_bake_warnings(report, command, scratch):
    """One line for what a LUT cannot hold; none where it can."""
    path = scratch / "warned.cube"

    def warnings(*arguments):
        path.unlink(missing_ok=True)
        code, _, err = call(command, ["bake", *arguments, "-o", path])
        return code, [line for line in err.splitlines() if "warning: " in line], err

    curve = ("--input-encoding", "log2")
    code, lines, err = warnings("drago", *curve, "--input", "lin_rec709", "--set", "apply=channels")
    report.check("bake of an operator that measures: one line with the constants", code == OK and len(lines) == 1 and all(
        word in lines[0] for word in ("drago", "log_average 1 ", "maximum 100 ")), err)
    code, lines, err = warnings("drago", *curve, "--set", "apply=channels", "--set", "log_average=0.5", "--set",
                                "maximum=8")
    report.check("bake of an operator that measures, with its numbers: no warning", code == OK and not lines, err)
    ring = ("hable", "--3d", "--size", 17, "--nodes", "sampled")
    code, lines, err = warnings(*ring, "--input-encoding", "davinci")
    report.check("bake of a LUT that rings: one line says by how much and what helps",
                 code == OK and len(lines) == 1 and "rings" in lines[0] and "--input lin_rec709" in lines[0], err)
    report.check("bake of a LUT that rings: so does the file", "# RINGS, " in path.read_text())
    code, _, err = warnings(*ring, "--input-encoding", "davinci", "--strict")
    report.check("bake --strict of a LUT that rings: no file", code == 1 and not path.exists()
                 and len(err.splitlines()) == 1, err)
    code, lines, err = warnings(*ring, "--input-encoding", "log2")
    report.check("bake of a LUT that does not ring: no warning", code == OK and not lines, err)


@pytest.mark.share(3)
def test_bake_for(report, command, scratch):
    """The last lines of `bake --for` hold for the file: its size, its name, its input and its display."""
    path = scratch / "steps.cube"

    def steps(host, *arguments, operator="agx_blender", file=path):
        code, out, err = call(command, ["bake", operator, "--for", host, "--size", 17, "--nodes", "sampled", *arguments, "-o", file])
        return code, out, err.rstrip().rsplit("\n", 1)[-1]

    for host, size in (("resolve", 129), ("unity", 97)):
        code, _, err = call(command, ["bake", "agx_blender", "--for", host, "--size", size, "-o", path])
        report.check(f"bake --for {host}: a larger size than it reads is refused", code == USAGE and not path.exists()
                     and err.count("\n") == 1 and f"size is {size}; expected at most 65 for {host}" in err, err)
    code, _, err = call(command, ["bake", "agx_blender", "--for", "unity", "--max-error", "0.006", "--nodes", "sampled", "-o", path])
    report.check("bake --max-error: no size above that of the application", code == USAGE and not path.exists() and err.count("\n") == 1
                 and "which cube 65 has on photographs" in err, err)
    code, _, err = call(command, ["bake", "hable", "--for", "resolve", "--size", 8192, "-o", path])
    report.check("bake --for resolve: a table of one curve has entries, no grid points",
                 code == OK and "1D, 8192 entries" in err and "with Rec.709 as output color space" in err, err)
    code, _, line = steps("resolve", "--input", "lin_ap1")
    report.check("bake --for resolve: its steps take any primaries, and name those of the file",
                 code == OK and line.startswith("DaVinci Resolve: Project Settings") and "with AP1 as output color space" in line, line)
    for host, arguments, words in (
            ("resolve", ["--input-encoding", "logc3"], "convert scene-linear ARRI Wide Gamut 3 to ARRI LogC3"),
            ("premiere", ["--input", "lin_ap1"], "convert scene-linear ACEScg to ARRI LogC3"),
            ("photoshop", ["--input-encoding", "acescct"], "convert scene-linear ACEScg to ACEScct")):
        code, _, line = steps(host, *arguments)
        report.check(f"bake --for {host} {' '.join(arguments)}: what to convert to, not its steps",
                     code == OK and words in line and line.endswith("which does not take the application's usual input"), line)
    code, _, line = steps("premiere", "--input-encoding", "logc3", "--input", "lin_awg3")
    report.check("bake --for premiere with the input that it has anyway: its steps", code == OK and "Input LUT > Browse" in line, line)
    code, _, line = steps("mpv")
    report.check("bake --for mpv: the command has the file's name", code == OK and f"--lut={path} --lut-type" in line, line)
    code, _, line = steps("mpv", file=scratch / "two words.cube")
    report.check("bake --for mpv: but no name that a shell would divide", code == OK and "--lut=FILE --lut-type" in line, line)
    for host, arguments, is_told in (("ffmpeg", ["--display", "rec2100_pq"], True), ("ffmpeg", [], False),
                                     ("resolve", ["--display", "rec2100_pq"], False)):
        _, _, err = call(command, ["bake", "gt7", "--for", host, "--size", 17, "--nodes", "sampled", *arguments, "-o", path])
        report.check(f"bake --for {host} {' '.join(arguments)}: the display of the steps",
                     ("ffmpeg: these steps are for the display rec1886; the file is for rec2100_pq" in err) == is_told, err)


@pytest.mark.share(3)
def test_bake_progress(report, command, scratch):
    """A terminal shows the seconds of a long search for a size."""
    ours, theirs = os.openpty()
    run = subprocess.Popen([command, "bake", "agx_blender", "--max-error", "1e-9", "-o", scratch / "search.cube"],
                           stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=theirs)
    os.close(theirs)
    text = b""
    try:
        while b"bake: 2 s" not in text:
            text += os.read(ours, 4096)
    except OSError:  # the run ended
        pass
    run.kill()
    run.wait()
    os.close(ours)
    report.check("bake --max-error on a terminal: the seconds", b"\rbake: 2 s" in text, text)


@pytest.mark.share(3)
def test_exact_forms(report, command, scratch):
    """`bake --exact`: the most exact file first, by commands that run."""
    code, out, err = call(command, ["bake", "khronos_neutral", "--exact", "--for", "nuke", "--set", "start_compression=0.7"])
    lines = out.splitlines()
    rows = [(first.split()[0], second.strip()) for first, second in zip(lines, lines[1:]) if second.startswith("           ")]
    report.check("bake --exact: shader and ctf are exact, the cube has an error",
                 code == OK and not err and [row[0] for row in rows[:2]] == ["exact", "exact"] and float(rows[2][0]) > 1
                 and any("-o khronos_neutral.ctf" in row[1] for row in rows), out)
    for _, line in rows:
        words = line.split()
        code, _, err = call(command, [*words[1:-1], scratch / words[-1]])
        report.check(f"bake --exact: {line}", code == OK and "--set start_compression=0.7" in line and (scratch / words[-1]).is_file(), err)
    code, out, _ = call(command, ["bake", "agx_blender", "--exact", "--for", "resolve"])
    report.check("bake --exact of a grid: its formula in DCTL has an error",
                 code == OK and "shader agx_blender:formula --for resolve" in out and "exact  DaVinci" not in out, out)
    for arguments, word in ((["--exact"], "OPERATOR"), (["hable", "--exact", "-o", "x.cube"], "no -o"),
                            (["hable", "--exact", "--for", "nook"], "nuke")):
        code, out, err = call(command, ["bake", *arguments])
        report.check(f"bake {' '.join(arguments)} is refused", code == USAGE and not out and word in err
                     and len(err.splitlines()) == 1, err)
    path = scratch / "x"
    for arguments, word in ((["khronos_neutral", "--format", "clf", "-o", f"{path}.clf"], "expected ctf"),
                            (["gt7", "--format", "clf", "--size", "9", "-o", f"{path}.clf"], "[17, 129]"),
                            (["gt7", "--format", "clf", "--depth", "16", "-o", f"{path}.clf"], "depth"),
                            (["gt7", "--format", "clf", "--nodes", "smooth", "-o", f"{path}.clf"], "smooth"),
                            (["gt7", "--format", "clf", "--max-error", "1e-9", "-o", f"{path}.clf"], "--max-error is 1e-09; expected at least")):
        code, _, err = call(command, ["bake", *arguments, "--input-encoding", "linear"])
        report.check(f"bake {' '.join(arguments[:-2])} of scene-linear input is refused",
                     code == USAGE and word in err and len(err.splitlines()) == 1 and not list(scratch.glob("x.*")), err)


@pytest.mark.share(3)
def test_bake(report, command, scratch):
    """Every format, as OpenColorIO reads it: the nodes are the operator, between them the error is what bake says."""
    if ocio is None:
        skip("bake, read back (PyOpenColorIO is not installed; Debian: python3-pyopencolorio)")
    rng = np.random.default_rng(9)
    ap1, log2, curve = ("acescct", "lin_ap1", acescct_decode), ("log2", "lin_rec709", log2_decode), ["--1d"]
    linear = ("linear:0:8", "lin_rec709", lambda code: code)
    for operator, file, (encoding, space, decode), size, options in [
        ("agx_sobotka", "agx33.cube", ap1, 33, []),
        ("agx_sobotka", "agx17.clf", ap1, 17, ["--format", "clf", "--size", 17]),
        ("agx_sobotka", "agx20.spi3d", ap1, 20, ["--format", "spi3d", "--size", 20]),
        ("hable", "hable3d.cube", log2, 33, ["--3d"]),
        ("hable", "hable.cube", log2, 4096, curve),
        ("hable", "hable.clf", log2, 1024, ["--format", "clf", "--size", 1024]),
        ("hable", "hable.spi1d", log2, 4096, ["--format", "spi1d"]),
        ("hable", "half.clf", linear, None, ["--format", "clf"]),
        ("uchimura", "linear.spi1d", linear, 65536, ["--format", "spi1d", "--size", 65536]),
    ]:
        path = scratch / file
        code, out, err = call(command, ["bake", operator, "-o", path, "--nodes", "sampled", "--input-encoding", encoding, *options])
        if not report.check(f"bake {file}", code == OK and not out and path.is_file()
                            and all((" on photographs ", ": error max ", ": clips what")[min(i, 2)] in line for i, line in enumerate(
                                line for line in err.splitlines() if f"warning: {path} " not in line)), err):
            continue
        top = 8 if encoding.startswith("linear") else 1
        if size:
            nodes = top * rng.integers(0, size, (2000, 3)) / (size - 1)
        else:
            nodes = (top * rng.random((2000, 3))).astype(np.float16)
        if operator != "agx_sobotka" and "3d" not in file:
            nodes[:, 1:] = nodes[:, :1]
        arguments = (operator, "--input", space)
        nodes = nodes.astype(np.float32)
        codes = np.concatenate([nodes, (top * rng.random((4000, 3))).astype(np.float32)])
        truth, shown = evaluate(command, decode(codes.astype(float)), *arguments), read_lut(path, codes)
        # A code is a float, too: where the LUT is steep its rounding shows.
        report.compare(f"bake {file}: nodes", shown[:2000], truth[:2000], 2e-6)
        stated = float(err.split("error max ")[1].split(",")[0])
        report.compare(f"bake {file}: between them", shown[2000:], truth[2000:], stated + FLOAT32)
    first = (scratch / "agx33.cube").read_bytes()
    run(command, "bake", "agx_sobotka", "-o", scratch / "agx33.cube", "--nodes", "sampled")
    report.check("bake again: the same bytes, with the default encoding", (scratch / "agx33.cube").read_bytes() == first)
    report.check("bake: the file says input, output and error",
                 all(word in first[:1000].decode() for word in ("# Input: ACEScct", "# Output: sRGB", "# Error")))


@pytest.mark.share(3)
def test_chart(report, command, scratch, picture):
    chart = scratch / "chart.exr"
    run(command, "chart", "-o", chart)
    rgb = read_rgb(chart, scratch)
    report.check("chart: 1536 x 864, finite, with negatives and bright light",
                 rgb.shape == (864, 1536, 3) and np.isfinite(rgb).all() and rgb.min() < -0.1 and rgb.max() > 500)
    rgb = read_rgb(picture, scratch)
    report.check("chart --width --height -d half", rgb.shape == (360, 640, 3), rgb.shape)
    run(command, "chart", "-o", chart, "--width", 640, "--height", 360, "-d", "half")
    report.check("chart again: the same pixels", np.array_equal(read_rgb(chart, scratch), rgb))


@pytest.mark.share(3)
def test_sheet(report, command, scratch, picture):
    shown = scratch / "shown.png"
    run(command, "apply", picture, shown, "--operator", "hable")
    run(command, "sheet", f"a={shown}", f"b={shown}", shown, "-o", scratch / "sheet.png", "--columns", 2,
        "--cell-width", 100)
    height, width, _ = read_rgb(scratch / "sheet.png", scratch).shape
    report.check("sheet: 2 columns, 2 rows", 200 <= width <= 300 and 112 < height < 300, f"{width} x {height}")


@pytest.mark.share(3)
def test_archive(report, command, scratch):
    """The same files in one, in the same bytes each time."""
    path = scratch / "a.ocioz"
    run(command, "config", "--archive", path, "--views", "hable")
    first = path.read_bytes()
    subprocess.run([command, "config", "--archive", path, "-o", scratch / "folder", "--views", "hable"], check=True,
                   env={**os.environ, "TZ": "Pacific/Auckland"})
    report.check("config --archive: the same bytes, in another time zone too", path.read_bytes() == first)
    newer = scratch / "newer.ocioz"
    run(command, "config", "--archive", newer, "--profile", "2.5", "--views", "clamp", "--displays", "srgb")
    with zipfile.ZipFile(newer) as archive:
        report.check("config --archive --profile 2.5: of that version",
                     archive.read("config.ocio").startswith(b"ocio_profile_version: 2.5"))
    # drago and others take numbers from the picture, which a config does not see.
    code, _, err = call(command, ["config", "-o", scratch / "measuring", "--views", "drago", "--displays", "srgb"])
    text = (scratch / "measuring/config.ocio").read_text()
    report.check("config: constants that stand in for measured numbers", code == OK and err.count("\n") == 1
                 and "warning" in err and "Drago uses " in err and "Cannot measure pictures here" in text, err)
    code, _, err = call(command, ["config", "-o", scratch / "strict", "--views", "drago", "--strict"])
    report.check("config --strict: they are an error", code == 1 and not (scratch / "strict").exists(), err)
    with zipfile.ZipFile(path) as archive:
        inside = {n: archive.read(n) for n in archive.namelist()}
    beside = {n: c for n, c in files_of(scratch / "folder").items() if n == "config.ocio" or n.startswith("luts/")}
    report.check("config --archive: config.ocio and its tables", inside == beside, sorted(set(inside) ^ set(beside)))
    # A shell reads the command of the README as one view, and the config has it.
    for view in ("Hable", "ACES Narkowicz"):
        run(command, "config", "-o", scratch / "readme", "--views", view, "--displays", "srgb")
        shown = re.search(r"^oiiotool (?:.*\\\n)*.*", (scratch / "readme/README.md").read_text(), re.M).group(0)
        words = shlex.split(shown.replace("\\\n", " "))
        at = words.index("--ociodisplay")
        report.check(f"config: README.md shows {view}", words[at + 1:at + 4] == ["sRGB", view, "--iscolorspace"], shown)
    behind_empty_lines = (scratch / "readme/config-2.5.ocio").read_text().split("\n\n")[1:]
    odd = [text[:60] for text in behind_empty_lines if not re.match(r"\n?(\w+:\n|  - !<\w+>\n)", text)]
    report.check("config-2.5.ocio: empty lines before parts and spaces only", behind_empty_lines and not odd, odd[:3])


@pytest.mark.share(3)
def test_verify(report, command, scratch, picture):
    """Exit 1 when a form is beyond its bound: here a config whose table was made wrong."""
    folder = scratch / "config"
    run(command, "config", "-o", folder, "--views", "hable")
    arguments = ["verify", "hable", "--quick", "--no-gpu", "--config", folder]
    code, out, err = call(command, arguments)
    report.check("verify --config", code == OK and not err and out.splitlines()[-1].endswith(", 0 beyond their bound"),
                 out + err)
    rows = json.loads(run(command, *arguments, "--json"))["rows"]
    report.check("verify --json", rows and all(row["ok"] and 0 <= row["max"] <= row["bound"] for row in rows))
    code, out, err = call(command, ["verify", "hable", "reinhard:look=none", "--summary"])
    report.check("verify --summary: a bad operator", code == USAGE and "look is none" in err and not out, out + err)
    code, out, err = call(command, ["verify", "hable", "hable:white=4", "--quick", "--summary", "--config", folder])
    rows = [line.split() for line in out.splitlines() if line.startswith("hable")]
    report.check("verify --summary: a line for each operator, errors within the bounds", code == OK and not err
                 and [row[:-9] for row in rows] == [["hable"], ["hable", "white=4"]]
                 and all(row[-9:-3:2] == ["<0.0001"] * 3 and float(row[-3]) <= 1e-6 and float(row[-2]) <= 3e-7
                         for row in rows), out + err)
    table = next(folder.glob("luts/hable_curve*"))
    text = table.read_text()
    # 0.18 is no half float: this is the table's entry just below it.
    lines = text.splitlines()
    entry = lines.index(next(line for line in lines if line[:1].isdigit())) + 0x31c2
    lines[entry] = f"{float(lines[entry]) + 1e-3:.9f}"
    table.write_text("\n".join(lines))
    code, out, err = call(command, arguments)
    report.check("verify: a wrong entry of a table is found, exit 1", code == CHECK_FAILED and "FAILED" in out,
                 f"exit {code}: {out}{err}")
    table.write_text(text)
    code, out, err = call(command, [*arguments, "--picture", picture])
    report.check("verify --picture", code == OK, out + err)


# --------------------------------------------------------------------------------------------------
# Commands that fail


@pytest.fixture(scope="module")
def bad(folder, picture):
    """Files that `apply` must refuse, as {name: path}."""
    bad = {name: folder / f"bad.{name}" for name in ("missing.exr", "empty.exr", "text.exr", "deep.exr", "two.exr")}
    bad["empty.exr"].write_bytes(b"")
    bad["text.exr"].write_text("this is no picture\n" * 100)
    run("oiiotool", "--create", "16x16", 5, "--chnames", "R,G,B,A,Z", "-d", "float", "--deepen", "-o", bad["deep.exr"])
    rgb = read_rgb(picture, folder)
    write_exr(bad["two.exr"], {"X": rgb[..., 0], "Y": rgb[..., 1]})
    for kind in ("exr", "hdr", "png", "tif", "jpg"):
        path = bad[f"half.{kind}"] = folder / f"half.{kind}"
        run("oiiotool", picture, "--clamp:min=0:max=1", "-o", path)
        whole = path.read_bytes()
        path.write_bytes(whole[:len(whole) // 2])
    return bad


def command_line_errors(picture):
    """Errors of the command line parser: (arguments, words of the message)."""
    apply = ["apply", picture, "out.png"]
    return [
        ([*apply, "--max-pixels", "x"], "apply: --max-pixels is x; expected a number in [1, 1000000000000]"),
        ([*apply, "--max-pixels", "0"], "apply: --max-pixels is 0; expected a number in [1, 1000000000000]"),
        *(([*apply, "--exposure", text], f"apply: --exposure is {text or 'empty'}; expected a number")
          for text in ("", "1,5", "0x10", "nan", "inf", "1e999")),
        *(([*apply, "--threads", text], f"apply: --threads is {text}; expected a whole number in [0, 1024]")
          for text in ("1.5", "1025", "99999999999999")),
        (["bake", "hable", "-o", "out.cube", "--size", "99999999999"], "expected a whole number in [-2147483648, 2147483647]"),
        (["config", "-o", "new", "--exposure-views", "1,x"], "config: --exposure-views is x; expected a number in [-16, 16]"),
        # The value is missing: at the end, before another option, and where it is empty.
        ([*apply, "--exposure"], "apply: --exposure has no value; expected --exposure STOPS"),
        (["plot", "hable", "-o", "--dark"], "plot: -o has no value; expected -o FILE"),
        (["bake", "--all", "-q"], "bake: --all has no value; expected --all FOLDER"),
        (["bake", "--all"], "bake: --all has no value; expected --all FOLDER"),
        ([*apply, "--quality="], "apply: --quality has no value; expected --quality N"),
        ([*apply, "--quiet=no"], "apply: --quiet is no; expected no value"),
        ([*apply, "--exposure", "1", "--exposure", "2"], "apply: --exposure is 1 and 2; expected it once"),
        (["bake", "hable", "-o", "a.cube", "-o", "b.cube"], "bake: -o is a.cube and b.cube; expected it once"),
        (["compare"], "compare: IN is missing; expected a picture"), (["plot", "-o", "out.svg"], "plot: OPERATORS is missing"),
        (["compare", picture], "compare: -o is missing; expected -o FILE"),
        ([*apply, "--legend"], "apply: --legend is given; expected --false-color with it"),
        ([*apply, "--adapt"], "apply: --adapt is given; expected --auto-exposure METHOD and --frames RANGE with it"),
        ([*apply, "--adapt-up", "2"], "apply: --adapt-up is 2; expected --adapt with it"),
        ([*apply, "--input-encoding", "none"], "apply: --input-encoding is none; expected a LUT as the operator, or --lut"),
        ([*apply, "--operator", "hable", "--lut", "x.cube"], "apply: --operator and --lut are given; expected one of them"),
        (["apply", picture, picture, "-o", "o.png"], "apply: -o is o.png; expected a folder; --format"),
        (["eval", "hable", "--lut", "x.cube"], "eval: OPERATOR and --lut are given; expected one of them"),
        # An unknown option is reported before a missing one.
        (["chart", "--widht", "640"], "chart: there is no option --widht; `tonewright chart --help-all` lists all; did you mean --width?"),
        ([*apply, "-z"], "apply: there is no option -z; `tonewright apply --help-all` lists all"),
        (["list", "hable", "agx"], "list: argument is agx; expected one OPERATOR only"),
        (["chart", "out.exr", "-o", "out.exr"], "chart: argument is out.exr; expected options only"),
    ]


# Words of CLI11, whose sentences are not ours.
CLI11_WORDS = re.compile(r"required|requires|excludes|convert:|TEXT|FLOAT|INT|not expected|were not")


def usage_errors(bad, picture):
    """(arguments, words of the message, stdin) of calls that exit with 2."""
    cases = [
        ([], "command is missing; apply"), (["frobnicate"], "frobnicate"), (["--frobnicate"], "--frobnicate"),
        (["eval", "hable", "--frobnicate"], "--frobnicate"), *command_line_errors(picture),
        (["list", "--json", "--markdown"], "list: --json and --markdown are given; expected one of them"),
        (["list", "habel"], "operator is habel; did you mean hable?"), (["eval"], "eval: OPERATOR is missing; expected an id from `tonewright list`, or --lut FILE"),
        (["eval", "habel"], "did you mean hable?"), (["eval", "acess"], "operator is acess"),
        (["eval", "foo"], "operator is foo"), (["eval", "opendrt"], "OpenDRT cannot be derived from its description (docs/choosing.md)"),
        (["eval", "hable:white=4", "--set", "white=5"], "white is 4 and 5; expected it once"),
        (["eval", "hable", "--engin", "simd"], "there is no option --engin; did you mean --engine?"),
        (["bake", "hable", "-o", "out", "--nodes", "fited"], "--nodes; fited; did you mean fitted?"),
        (["help", "eval", "list"], "help: argument is list"),
        (["compare", picture, "habel", "-o", "out.png"], "did you mean hable?"),
        (["plot", "habel", "-o", "out.svg"], "did you mean hable?"),
        (["eval", ""], "eval: OPERATOR is missing"), (["eval", "ha\nble"], "did you mean hable?"),
        (["apply", picture, "out.png", "--operator", "habel"], "did you mean hable?"),
        (["bake", "habel", "-o", "out.cube"], "did you mean hable?"), (["verify", "habel"], "did you mean hable?"),
        (["eval", "hable", "--set", "wite=4"], "parameter is wite; did you mean white?"),
        (["eval", "agx_blender", "--set", "contrast=2"], "parameter is contrast; expected limit, method or range; looks for it: --look very_high_contrast, ; operators with it: agx_godot"),
        (["apply", picture, "out.png", "--operator", ""], "apply: --operator has no value; expected --operator NAME"),
        (["compare", picture, " ", "-o", "out.png"], "operator is empty; expected an id from"),
        (["apply", picture, "out.png", "--operator", "y = x"], "operator is y = x: column ; a formula is an expression of x, or of r, g and b, with steps before it: a = x*2; a/(1 + a)"),
        (["eval", "somewhat_boring", "--set", "white=4"], "white; no parameters"),
        (["eval", "hable", "--set", "white"], "--set is white; expected name=value"),
        (["eval", "hable", "--set", "=4"], "=4; name=value"),
        (["eval", "hable", "--set", "white=4", "--set", "white=5"], "white is 4 and 5; expected it once"),
        (["eval", "hable", "--set"], "eval: --set has no value; expected --set NAME=VALUE"),
        (["eval", "reinhard", "--set", "apply=lumnance"], "apply is lumnance; did you mean luminance?"),
        (["eval", "reinhard:lum"], "preset is lum; did you mean luminance?"), (["eval", "somewhat_boring:x"], "x; no presets"),
        (["eval", "reinhard", "--set", "color_correction=nonlinear"],
         "reinhard: color_correction is nonlinear; expected ratio with apply=channels"),
        (["eval", "hable", "--digits", "0"], "--digits; 0"), (["eval", "hable", "--digits", "18"], "--digits; 18"),
        (["eval", "agx_sobotka", "--look", "pnchy"], "look is pnchy; did you mean punchy?"),
        (["eval", "hable", "--look", "punchy"], "punchy; no looks"),
        (["eval", "hable", "--display", "srbg"], "display is srbg; did you mean srgb?"),
        (["eval", "hable", "--input", "lin_rec79"], "lin_rec79; did you mean lin_rec709?"),
        (["eval", "hable", "--engine", "smid"], "engine is smid; did you mean simd?"),
        (["eval", "hable", "--exposure", "bright"], "eval: --exposure is bright; expected a number"),
        (["eval", "hable", "--exposure", "65"], "exposure is 65; [-64, 64]"),
        (["eval", "hable", "--reference-white", "20"], "reference white is 20; [50, 1000]"),
        (["eval", "hable", "--reference-white", "203"], "reference white is 203; srgb, which is not an HDR display"),
        (["eval", "hable", "--reference-white", "203", "--display", "native"], "is 203; native, which"),
        (["eval", "agx_blender", "--inverse"], "agx_blender has no inverse; stage"),
        (["apply", picture, "out.png", "--operator", "hable", "--reference-white", "1001"], "is 1001; [50, 1000]"),
        (["bake", "hable", "-o", "out.cube", "--reference-white", "big"], "--reference-white; big"),
        (["eval", "hable", "--display", "rec2100"], "display is rec2100; did you mean rec2100_pq or rec2100_hlg?"),
        (["eval", "aces_13", "--set", "output=hdr_1000", "--set", "limit=none"],
         "aces_13: limit is none; expected rec709, p3d65 or rec2020 with output=hdr_1000"),
        (["eval", "aces_20", "--set", "primaries=0.64 0.33"], "aces_20: primaries is; eight numbers"),
        (["apply", picture], "-o is missing"), (["apply", picture, picture, picture], "-o is missing; FOLDER"),
        (["apply", picture, picture, "-o", "new"], "would both be written to new/small.exr"),
        (["apply", picture, "-o", "new/", "--format", "xyz"], "--format is xyz; png or exr"),
        (["apply", picture, "-o", picture.parent], "the same file as the input; small.exr; another file, or --in-place"),
        (["apply", picture, "-o", "out.png", "--format", "png"], "--format is png; a folder"),
        (["apply", picture, "out.png", "--operator", "hable", "-d", "unit8"], "unit8; did you mean uint8?"),
        (["apply", picture, "out.png", "--operator", "hable", "--threads", "-1"], "apply: --threads is -1; expected a whole number in [0, 1024]"),
        (["meter", picture, "--threads", "1025"], "--threads; 1025"),
        (["apply", picture, "out.png", "--operator", "hable", "--subimage", "-1"], "--subimage; -1"),
        (["apply", picture, "out.png", "--dither", "--lut", "x.cube"], "apply: --dither and --lut are given; expected one of them"),
        (["apply", picture, "out.png", "--operator", "hable", "--dither=much"], "dither; much"),
        (["apply", picture, "out.png", "--operator", "drago", "--statistics", "pictur"],
         "apply: --statistics is pictur; picture, sequence or defaults; did you mean picture?"),
        *((["apply", "in.%04d.exr", "out.%04d.png", "--operator", "hable", "--frames", frames], f"--frames is {frames.strip()}")
          for frames in ("abc", "1-", "1-5x", "1-5x0", "1..5", "1,,3", "0-1000000", "1-9999999999", "1.5", " 1")),
        (["apply", "in.%04d.exr", "out.%04d.png", "--operator", "hable", "--frames", "3,1-5"], "frame 3 twice"),
        (["apply", "in.exr", "out.%04d.png", "--operator", "hable", "--frames", "1-2"], "in is in.exr; a placeholder for the frame number; shot.%04d.exr"),
        (["apply", "in@2/a.exr", "out.@.png", "--operator", "hable", "--frames", "1-2"], "in is in@2/a.exr; shot.@@@@.exr"),
        (["apply", "in.#.exr", "out.#.png", "--operator", "hable", "--frames", "1", "--missing", "hol"],
         "apply: --missing is hol; error, skip or hold; did you mean hold?"),
        *((["apply", "in.#.exr", "out.#.png", "--operator", "hable", "--frames", "1", "--jobs", jobs], f"--jobs; {jobs}")
          for jobs in ("-1", "257", "many")),
        *((["apply", picture, "out.png", "--operator", "hable", *words], f"{words[0]} is; expected --frames RANGE with it")
          for words in (["--missing", "skip"], ["--skip-existing"], ["--jobs", "2"])),
        *((["apply", "in.#.exr", "./in.%04d.exr", "--operator", "hable", "--frames", "1", *words], f"in.%04d.exr; {words[0]}")
          for words in (["--missing", "hold"], ["--skip-existing"])),
        (["apply", "in.%s.exr", "out.%04d.png", "--operator", "hable", "--frames", "1-2"], "in is in.%s.exr"),
        (["apply", "in.####.exr", "out.png", "--operator", "hable", "--frames", "1-2"], "out is out.png; shot.####.exr"),
        # Other commands take the operator by its place.
        *((["apply", operator, picture, "-o", "out.png"], f"apply: IN is {operator}, an operator; --operator {operator}")
          for operator in ("hable", "AgX", "agx_blender:punchy")),
        # Told before the picture is read, although it decides on parameters.
        (["apply", bad["missing.exr"], "out.png", "--operator", "drago", "--set", "maximun=9"],
         "parameter is maximun; did you mean maximum?"),
        (["apply", bad["missing.exr"], "out.png", "--operator", "drago", "--set", "maximum=0"], "drago: maximum is 0"),
        (["apply", picture, "out.png", "--operator", "hable", "--unpremult", "--no-unpremult"], "--no-unpremult"),
        (["bake", "hable"], "bake: -o is missing; expected -o FILE"), (["bake", "-o", "out.cube"], "bake: OPERATOR is missing; --all FOLDER"),
        (["bake", "hable", "--all", "luts"], "hable; --all"),
        (["bake", "hable", "-o", "out", "--format", "cub"], "format is cub; did you mean cube?"),
        (["bake", "hable", "-o", "out"], "file is out; expected a name that ends in .cube, "),
        (["bake", "hable", "-o", "out.txt"], "file is out.txt; expected a name that ends in .cube, "),
        (["bake", "hable", "--for", "resolve", "-o", "out.txt"], "file is out.txt; .cube; DaVinci Resolve reads"),
        (["bake", "hable", "-o", "out.cub"], "file is out.cub; did you mean .cube?"),
        (["bake", "hable", "-o", "out.png"], "file is out.png; --format hald, strip or strip_up"),
        (["bake", "hable", "-o", "out.clf", "--format", "cube"], "file is out.clf; .cube; the format is cube"),
        (["bake", "hable", "-o", "out.3dl", "--format", "spi3d"], "file is out.3dl; .spi3d"),
        *((["bake", "hable", "-o", name, "--format", "cube"], f"file is {name}; expected .cube: the format is cube")
          for name in ("out", "out.txt", "out.cube.bak")),
        (["bake", "hable", "-o", "out.txt", "--format", "icc"], "file is out.txt; expected .icc or .icm: the format is icc"),
        (["bake", "hable", "-o", "out", "--for", "resolve"], "file is out; expected .cube: DaVinci Resolve reads cube"),
        (["bake", "hable", "-o", "out.CLF", "--for", "resolve"], "file is out.CLF; .cube; DaVinci Resolve reads cube"),
        (["bake", "hable", "-o", "out.cube", "--for", "unreal"], "file is out.cube; .png; Unreal Engine reads strip"),
        (["bake", "hable", "-o", "out.cube", "--input-encoding", "acesct"], "acesct; did you mean acescct?"),
        (["bake", "hable", "-o", "out.cube", "--input-encoding", "log2:1"], "log2:1; LO:HI"),
        (["bake", "hable", "-o", "out.cube", "--input-encoding", "log2:5:1"], "log2:5:1; LO < HI"),
        (["bake", "hable", "-o", "out.cube", "--input-encoding", "log2:-100:100"], "[-64, 64]"),
        (["bake", "--all", "new", "--for", "krita"], "--for is krita; resolve"),
        (["bake", "--all", "new", "--for", "unty"], "did you mean unity?"),
        (["bake", "agx_sobotka", "-o", "out.cube", "--input-encoding", "linear"], "linear; acescct or log2"),
        (["bake", "agx_sobotka", "-o", "out.cube", "--size", "16"], "size is 16; [17, 129]"),
        (["bake", "agx_sobotka", "-o", "out.cube", "--size", "130"], "size is 130; [17, 129]"),
        (["bake", "agx_sobotka", "-o", "out.cube", "--size", "big"], "bake: --size is big; expected a whole number"),
        (["bake", "hable", "-o", "out.cube", "--input-encoding", "log2", "--size", "65537"], "size is 65537; [2, 65536]"),
        (["bake", "agx_sobotka", "-o", "out.cube", "--1d"], "agx_sobotka; 3D"),
        (["bake", "hable", "-o", "out.cube", "--1d", "--3d"], "--1d"),
        (["bake", "agx_sobotka", "-o", "out.spi1d", "--format", "spi1d"], "agx_sobotka; 3D"),
        (["bake", "hable", "-o", "out.spi1d", "--format", "spi1d", "--3d"], "spi1d"),
        (["bake", "hable", "-o", "out.spi3d", "--format", "spi3d", "--1d", "--input-encoding", "log2"], "spi3d"),
        (["bake", "hable", "-o", "out.clf", "--format", "clf", "--input-encoding", "linear", "--size", "9"], "size is 9"),
        (["chart"], "chart: -o is missing; expected -o FILE"), (["chart", "-o", "out.exr", "--width", "10"], "10; 320"),
        (["chart", "-o", "out.exr", "--width", "2000000000", "--height", "2000000000"], "2000000000"),
        (["chart", "-o", "out.exr", "-d", "uint8"], "uint8; half or float"),
        (["config"], "config: -o is missing; expected -o FOLDER, --archive FILE or --into CONFIG"),
        (["config", "-o", "new", "--profile", "3.0"], "profile; 2.1"),
        (["config", "-o", "new", "--views", "AgY"], "AgY; did you mean AgX"),
        (["config", "-o", "new", "--views", "hable:nix"], "nix"),
        (["config", "-o", "new", "--looks", "AgX - Funky"], "AgX - Funky; AgX - Punchy"),
        (["config", "-o", "new", "--displays", "crt"], "crt"), (["config", "-o", "new", "--working", "xyz"], "xyz"),
        (["config", "-o", "new", "--operator", "hable"], "number of --name options is 0; expected 1, one for each --operator"),
        (["config", "-o", "new", "--operator", "hable", "--name", "AgX"], "AgX"),
        (["config", "-o", "new", "--operator", "hable", "--name", "n" * 64], "63 bytes"),
        (["config", "-o", "new", "--operator", "hable:white=red", "--name", "Red"], "white; red"),
        (["config", "-o", "new", "--exposure-views", "99"], "99"),
        (["config", "--archive", "new.zip"], "config: --archive is new.zip; .ocioz"), (["sheet", "-o", "out.png"], "sheet: PICTURES is missing; expected LABEL=FILE"), (["sheet", picture], "-o"),
        (["sheet", picture, "-o", "out.png", "--columns", "0"], "--columns; 0"),
        (["sheet", picture, "-o", "out.png", "--cell-width", "1"], "--cell-width; 1"),
        (["verify", "hable", "--display", "srbg"], "did you mean srgb?"),
        (["verify", "hable", "--input", "lin_rec79"], "did you mean lin_rec709?"),
    ]
    for line in ("1 2", "1 2 3 4", "1,2,", ",1,2,3", "1;2;3", "1 2 3x", "+-5 1 1", "0x10 1 1", "1 2 \xff"):
        cases.append((["eval", "hable"], "standard input: line 4; three numbers", f"# a comment\n\n1 1 1\n{line}\n2 2 2\n"))
    for value in ("0", "65505", "4x", "", "nan", "1e999"):
        cases.append((["eval", "hable", "--set", f"white={value}"], f"hable: white is {value}"))
    cases.append((["eval", "reinhard_extended", "--set", "white=0"], "reinhard_extended: white is 0"))
    return [(*case, "")[:3] for case in cases]


def file_errors(bad, picture, scratch):
    """(arguments, words of the message, stdin) of calls that exit with 3. They find a folder `there`, a file `file`."""
    apply = ["apply", picture, "--operator", "hable"]
    cases = [(["apply", bad[name], "out.png", "--operator", "hable"], f"cannot read; {bad[name]}") for name in bad
             if name != "two.exr"]
    pipe = scratch / "pipe.exr"
    os.mkfifo(pipe)
    (scratch / "empty").mkdir()
    no_file = "is no regular file"
    cases += [
        (["apply", bad["two.exr"], "out.png", "--operator", "hable"], f"{bad['two.exr']}: ; 2 channels"),
        (["compare", bad["two.exr"], "hable", "-o", "out.png"], f"{bad['two.exr']}: ; 2 channels"),
        (["compare", bad["two.exr"], "exponential", "hable", "--split", "0.5", "-o", "out.png"], str(bad["two.exr"])),
        (["meter", bad["two.exr"]], f"{bad['two.exr']}: ; 2 channels"),
        (["apply", pipe, "out.png"], no_file), (["apply", "/dev/zero", "out.png"], no_file),
        (["meter", pipe], no_file), (["compare", pipe, "hable", "-o", "out.png"], no_file),
        (["apply", picture, "out.png", "--lut", pipe.with_suffix(".cube")], no_file),
        (["eval", "--lut", pipe.with_suffix(".cube")], no_file), (["eval", "--lut", pipe], no_file),
        (["apply", picture, "out.png", "--lut", "there"], "there: is a folder"),
        (["eval", "--lut", "there"], "there: is a folder"),
        (["verify", "--lut", "there"], "there: is a folder"),
        (["apply", picture, "out.png", "--lut", pipe.with_suffix(".cube"), "--exposure", "1"], no_file),
        (["eval", "camera_response", "--set", f"file={pipe}"], no_file),
        (["verify", "hable", "--picture", pipe], no_file),
        (["apply", f"@{pipe}", "-o", "new"], no_file), (["apply", "@none", "-o", "new"], "none: cannot read"),
        (["apply", scratch / "empty", "-o", "new"], "the folder has no pictures"),
        (["bake", "hable", "--format", "cube", "-o", "/dev/null"], f"/dev/null: {no_file}"),
        (["bake", "hable", "--format", "cube", "-o", pipe.with_suffix(".cube")], no_file),
        (["plot", "hable", "-o", pipe.with_suffix(".svg")], no_file), (["plot", "hable", "-o", pipe], no_file),
        ([*apply, "-o", "/dev/null"], no_file), ([*apply, pipe], no_file),
        (["apply", scratch, "out.png", "--operator", "hable"], "is a folder"),
        (["apply", "", "out.png", "--operator", "hable"], "cannot read"),
        ([*apply, "out.xyz"], "out.xyz"), ([*apply, "out"], "out; extension"), ([*apply, "out."], "out."),
        ([*apply, "there"], "there"), ([*apply, "there.png/out.png"], "there.png"), ([*apply, "file/out.png"], "file"),
        ([*apply, "/proc/out.png"], "/proc/out.png"), ([*apply, "/dev/null"], "/dev/null"),
        (["bake", "hable", "--format", "cube", "-o", "there"], "there"), (["bake", "hable", "--input", "lin_rec709", "-o", "file/out.cube"], "file"),
        (["bake", "hable", "--input", "lin_rec709", "-o", "none/out.cube"], "none"), (["bake", "hable", "--input", "lin_rec709", "-o", "/proc/out.cube"], "/proc"),
        (["bake", "--all", "file/luts"], "file"),
        (["config", "-o", "file"], "file"), (["config", "-o", "file/config"], "file"),
        (["config", "-o", "/proc/x"], "/proc"),
        (["chart", "-o", "there"], "there"), (["chart", "-o", "none/out.exr"], "none"),
        (["chart", "-o", "out.xyz"], "xyz"), (["sheet", "a=none.png", "-o", "out.png"], "none.png"),
        (["sheet", bad["half.png"], "-o", "out.png"], "half.png"),
        (["sheet", picture, "-o", "file/out.png"], "file"),
        (["verify", "hable", "--config", "none"], "none"),
        (["verify", "--config", 300 * "a"], f"verify: {300 * 'a'}: File name too long"),
        (["verify", "hable", "--picture", "none.exr"], "none.exr"),
    ]
    for extension in (".cube", ".svg"):
        os.mkfifo(pipe.with_suffix(extension))
    return [(arguments, words, "") for arguments, words in cases]


def check_error(report, command, scratch, number, expected_code, arguments, words, stdin):
    """One call, in a folder of its own, which must look the same afterwards."""
    folder = scratch / f"error.{expected_code}.{number}"
    (folder / "there").mkdir(parents=True)
    (folder / "file").write_text("old")
    code, out, err = call(command, arguments, stdin, folder)
    changed = sorted(os.listdir(folder)) != ["file", "there"] or os.listdir(folder / "there") \
        or (folder / "file").read_text() != "old"
    lines = err.count("\n")
    problems = [f"does not say {word}" for word in map(str, words.split("; ")) if word not in err]
    for problem, is_so in [(f"exit {code}, expected {expected_code}", code != expected_code),
                           (f"{lines} lines of errors, expected 1", lines != 1 or not err.endswith("\n")),
                           ("does not begin with `tonewright: `", not err.startswith("tonewright: ")),
                           ("has words of CLI11", expected_code == USAGE and CLI11_WORDS.search(err)),
                           # `eval` answers the lines above the one that is wrong.
                           ("printed a result", out.count("\n") != (1 if stdin else 0)), (f"left {os.listdir(folder)}", changed)]:
        if is_so:
            problems.append(problem)
    shown = " ".join(Path(a).name if str(a).startswith(str(scratch)) else repr(str(a))[1:-1] or "''" for a in arguments)
    if stdin:
        shown += f" < {stdin.splitlines()[-2]!r}"
    report.check(f"exit {expected_code}: {shown}", not problems, f"{', '.join(problems)}; it said: {err.strip()[:300]}")


def test_usage_errors(report, command, folder, bad, picture):
    check_errors(report, command, folder, USAGE, usage_errors(bad, picture))


def test_file_errors(report, command, folder, bad, picture):
    check_errors(report, command, folder, FILE, file_errors(bad, picture, folder))


def check_errors(report, command, scratch, expected_code, cases):
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda case: check_error(report, command, scratch, case[0], expected_code, *case[1]),
                      enumerate(share_of_refusals(cases, lambda case: case[0], 4))))


def check_old_file(report, command, scratch, number, what, expected_code, arguments, prefix=()):
    """A run that fails before it writes, or while it does, leaves the file of its output's name, and no other."""
    folder = scratch / f"old.{number}"
    folder.mkdir()
    target = folder / next(a for a in map(str, arguments) if a.startswith("old."))
    target.write_bytes(b"the old file")
    code, _, err = call(command, arguments, folder=folder, prefix=prefix)
    report.check(f"old file survives: {what}", code == expected_code and err.count("\n") == 1
                 and os.listdir(folder) == [target.name] and target.read_bytes() == b"the old file",
                 f"exit {code}, files {os.listdir(folder)}: {err.strip()}")


def old_files(bad, picture):
    """Arguments of check_old_file."""
    apply = ["--operator", "hable", "-d", "float"]
    return [
        ("apply, truncated picture", FILE, ["apply", bad["half.exr"], "old.png", *apply]),
        ("apply, truncated picture, one thread", FILE, ["apply", bad["half.exr"], "old.png", *apply, "--threads", "1"]),
        ("apply, disk full", FILE, ["apply", picture, "old.exr", *apply], DISK_FULL),
        ("apply, disk full, PNG", FILE, ["apply", picture, "old.png", "--operator", "hable"], DISK_FULL),
        ("apply, disk full, TIFF", FILE, ["apply", picture, "old.tif", *apply], DISK_FULL),
        ("apply, disk full, DPX", FILE, ["apply", picture, "old.dpx", *apply], DISK_FULL),
        ("bake, disk full", FILE, ["bake", "agx_sobotka", "--input", "lin_rec709", "-o", "old.cube"], DISK_FULL),
        ("bake, bad size", USAGE, ["bake", "agx_sobotka", "-o", "old.cube", "--size", "7"]),
        ("chart, disk full", FILE, ["chart", "-o", "old.exr"], DISK_FULL),
        ("sheet, missing picture", FILE, ["sheet", "none.png", "-o", "old.png"]),
    ]


def test_old_files(report, command, scratch, bad, picture):
    for number, case in enumerate(old_files(bad, picture)):
        check_old_file(report, command, scratch, number, *case)


@pytest.mark.share(3)
def test_full_disks(report, command, scratch):
    (scratch / "config.ocio").write_text("the old file")
    code, _, err = call(command, ["config", "-o", scratch, "--views", "hable"], prefix=DISK_FULL)
    report.check("old file survives: config, disk full", code == FILE and err.count("\n") == 1
                 and (scratch / "config.ocio").read_text() == "the old file" and not list(scratch.rglob("*.tmp*")), err)
    with open("/dev/full", "w") as no_space:
        done = subprocess.run([command, "list"], stdout=no_space, stderr=subprocess.PIPE, check=False)
    report.check("list > /dev/full", done.returncode == FILE and done.stderr.startswith(b"tonewright: ")
                 and done.stderr.count(b"\n") == 1, f"exit {done.returncode}: {done.stderr.decode()}")


# Seconds of processor time. The program waits for nothing when it starts, so on a quiet machine this is the time that a
# user sees; unlike that time it does not grow with what runs beside the test. It takes 6 to 9 ms, most of them in the
# dynamic linker; loading OpenImageIO and its 250 libraries takes 200 ms. The best of several runs leaves out those whose
# files or processor cache were cold.
START_LIMIT = 0.020
START_RUNS = 10


def start_time(command, *arguments):
    times = []
    for _ in range(START_RUNS):
        with subprocess.Popen([command, *arguments], stdout=subprocess.DEVNULL) as process:
            _, process.returncode, used = os.wait4(process.pid, 0)
        times.append(used.ru_utime + used.ru_stime)
    return min(times)


def test_start(report, command):
    """Help, the version and commands without pictures start without OpenImageIO."""
    if not shutil.which("ldd"):
        skip("start, ldd is not here")
    libraries = subprocess.run(["ldd", command], capture_output=True, text=True, check=True).stdout
    report.check("the program is not linked with OpenImageIO",
                 "libOpenColorIO" in libraries and "OpenImageIO" not in libraries, libraries)
    if is_sanitized(command):
        print("skipped: start time, the sanitizer's own start takes longer")
        return
    # A slower machine has a higher limit: where the command took 30 ms, Python without modules took 36.
    limit = max(START_LIMIT, 1.3 * start_time(sys.executable, "-I", "-S", "-c", "pass"))
    for arguments in (["--version"], ["--help"], *([name, "--help"] for name in SUBCOMMANDS), ["list"]):
        took = start_time(command, *arguments)
        for _ in range(4):  # `list` took 17.5 ms alone, and 20.6 ms beside a compiler
            if took > limit:
                time.sleep(1)
                took = min(took, start_time(command, *arguments))
        report.bound(f"{' '.join(arguments)} starts, seconds", took, limit)


@pytest.mark.share(3)
def test_module(report, command, scratch):
    """A program without its picture commands: all help is there, and pictures are refused in one line."""
    alone = scratch / "bin" / "tonewright"
    alone.parent.mkdir()
    shutil.copy(command, alone)
    for arguments in (["--version"], ["--help"], *([name, "--help"] for name in SUBCOMMANDS)):
        report.check(f"{' '.join(arguments)} needs no picture commands",
                     call(alone, arguments) == call(command, arguments))
    module = scratch / "libexec" / "tonewright" / "picture_commands.so"
    for arguments in (["apply", "in.exr", "out.png", "--operator", "hable"], ["chart", "-o", "chart.exr"],
                      ["bake", "hable", "--input", "lin_rec709", "--format", "hald", "-o", "hald.png"], ["bake", "--all", "luts"],
                      ["eval", "--lut", "hald.png"], ["verify", "hable", "--picture", "in.exr"],
                      ["plot", "hable", "-o", "plot.png"]):
        code, out, err = call(alone, arguments, folder=scratch)
        first = module.with_name("row_commands.so") if arguments[0] == "apply" else module
        report.check(f"{' '.join(arguments)} without picture commands",
                     code == FILE and not out and err.count("\n") == 1
                     and err.startswith("tonewright: start: cannot load the picture commands: ")
                     and str(first) in err, f"exit {code}: {out}{err}")
    module.parent.mkdir(parents=True)
    module.write_bytes(b"not a library")
    code, _, err = call(alone, ["chart", "-o", "chart.exr"], folder=scratch)
    report.check("a damaged module", code == FILE and err.count("\n") == 1 and str(module) in err, err)
    # Any shared library without the entry point: it is of no build at all.
    libraries = subprocess.run(["ldd", command], capture_output=True, text=True, check=True).stdout
    shutil.copy(next(word for word in libraries.split() if word.startswith("/") and "libfmt" in word), module)
    code, _, err = call(alone, ["chart", "-o", "chart.exr"], folder=scratch)
    report.check("a module of another build", code == FILE and err.count("\n") == 1 and "another build" in err, err)
