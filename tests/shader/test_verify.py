# SPDX-License-Identifier: Apache-2.0
"""The rows that `tonewright verify` has of shaders, and what it says of those that it cannot run.

    python3 -m pytest tests/shader/test_verify.py --tonewright build/release/bin/tonewright
"""

import json
import os
import pathlib
import shutil
import stat
import subprocess

import pytest
from dawn import SWIFTSHADER, Dawn
from executed import IS_FULL, skip

OPERATORS = ["hable", "agx_blender", "aces_13"] if IS_FULL else ["hable"]
# A compiler that changes a constant of what it is given, or adds what is not C.
WRONG_CONSTANT = """#!/bin/sh
for word; do
    case $word in *.c) sed -i 's/ + 0\\.05f/ + 0.06f/' "$word" ;; esac
done
exec "$REAL_CC" "$@"
"""
NO_C = """#!/bin/sh
for word; do
    case $word in *.c) grep -q tw_hable "$word" && echo '#error broken' >>"$word" ;; esac
done
exec "$REAL_CC" "$@"
"""
WRONG_CONSTANT_HLSL = """#!/bin/sh
for word; do
    case $word in *.hlsl) sed -i 's/ + 0\\.05)/ + 0.06)/' "$word" ;; esac
done
exec "$REAL_GLSLANG" "$@"
"""


def verify(command, *arguments, **environment):
    """Exit code, rows of shaders, languages that were not executed with the reason, messages."""
    done = subprocess.run([command, "verify", *(arguments or OPERATORS), "--quick", "--best-target", "--json"],
                          env=os.environ | environment, capture_output=True, text=True, check=False)
    found = json.loads(done.stdout) if done.stdout else {"rows": [], "not_executed": []}
    rows = [row for row in found["rows"] if not row["backend"].startswith(("simd", "ocio"))]
    return done.returncode, rows, {n["name"]: n["reason"] for n in found["not_executed"]}, done.stderr


def script(folder: pathlib.Path, name: str, text: str) -> str:
    path = folder / name
    path.write_text(text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


@pytest.fixture(scope="module")
def dawn(command):
    """The environment that `verify` needs for WGSL and HLSL; empty if Dawn() reports that it is missing."""
    try:
        return {"TONEWRIGHT_NODE_MODULES": str(Dawn(command).modules), "VK_ICD_FILENAMES": str(SWIFTSHADER)}
    except pytest.skip.Exception:
        return {}


@pytest.fixture(autouse=True)
def compiler(monkeypatch, tmp_path_factory):
    """A C compiler. pocl gets a cache of its own, or it fills the user's."""
    monkeypatch.setenv("POCL_CACHE_DIR", str(tmp_path_factory.mktemp("pocl")))
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if not compiler:
        skip("no C compiler")
    return compiler


def test_languages(report, command, dawn):
    wanted = {"c"} | ({"wgsl", "hlsl"} if dawn else set())
    code, rows, not_executed, messages = verify(command, **dawn)
    executed = {row["backend"] for row in rows}
    print("executed:", ", ".join(f"{row['backend']} {row['max']:.1e} ({row['lowering']})" for row in rows
                                 if row["operator"] == "hable"))
    report.check("every language is executed, or has a reason", code == 0 and wanted <= executed
                 and not executed & set(not_executed)
                 and executed | {"msl", "osl", "godot", "reshade", "shadertoy", "gstreamer"} <= executed | set(not_executed)
                 and {"glsl", "glsl-es", "wgsl", "hlsl", "dctl", "c"} <= executed | set(not_executed),
                 (code, executed, not_executed, messages))
    report.check("errors are within their bounds", all(row["ok"] and row["max_all"] <= row["bound"] for row in rows), rows)


def test_faults(report, command, scratch, dawn, compiler):
    own = {"TMPDIR": str(scratch)}
    # A missing program is reported, and is not an error.
    for environment, language, reason in (
            ({"CC": str(scratch / "none")}, "c", "no C compiler"),
            ({"CC": "false"}, "c", "no C compiler"),
            ({"PATH": str(scratch)}, "c", "no C compiler"),
            ({"OCL_ICD_VENDORS": str(scratch / "none")}, "dctl", "no OpenCL"),
            ({"TONEWRIGHT_NODE_MODULES": ""}, "wgsl", "TONEWRIGHT_NODE_MODULES is not set"),
            ({"TONEWRIGHT_NODE_MODULES": str(scratch)}, "hlsl", "TONEWRIGHT_NODE_MODULES has no webgpu"),
            (dawn | {"PATH": str(scratch)}, "wgsl", "node: No such file" if dawn else "TONEWRIGHT_NODE_MODULES is not set")):
        code, rows, not_executed, messages = verify(command, "hable", "--shaders", language, **own | environment)
        report.check(f"{language} with {environment}", code == 0 and not rows
                     and not_executed.get(language, "").startswith(reason), (code, rows, not_executed, messages))
    # Errors are found.
    for text, note in ((WRONG_CONSTANT, "worst at"), (NO_C, "error")):
        wrong = script(scratch, "wrong_cc", text)
        code, rows, _, messages = verify(command, "hable", "--shaders", "c", CC=wrong, REAL_CC=compiler, **own)
        report.check(f"a compiler that changes the text: {note}", code == 1 and len(rows) == 1 and not rows[0]["ok"]
                     and note in rows[0]["note"], (code, rows, messages))
    if dawn:
        glslang = shutil.which("glslangValidator")
        script(scratch, "glslangValidator", WRONG_CONSTANT_HLSL)
        code, rows, _, messages = verify(command, "hable", "--shaders", "hlsl", REAL_GLSLANG=glslang,
                                         PATH=f"{scratch}:{os.environ['PATH']}", **dawn | own)
        report.check("a wrong text of HLSL", code == 1 and len(rows) == 1 and not rows[0]["ok"], (code, rows, messages))
    left = [path.name for path in scratch.iterdir() if path.name.startswith("tonewright-")]
    report.check("no temporary folder is left", not left, left)


def test_no_languages(report, command):
    for arguments in (["--shaders", "none"], ["--no-gpu"]):
        code, rows, not_executed, messages = verify(command, "hable", *arguments)
        report.check(f"verify {arguments}", code == 0 and not rows and not not_executed, (code, rows, not_executed, messages))
    done = subprocess.run([command, "verify", "hable", "--shaders", "wgls"], capture_output=True, text=True, check=False)
    report.check("an unknown language", done.returncode == 2 and done.stderr.count("\n") == 1
                 and "did you mean wgsl?" in done.stderr, done.stderr)
