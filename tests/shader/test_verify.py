#!/usr/bin/env python3
"""The rows that `tonewright verify` has of shaders, and what it says of those that it cannot run.

Usage: test_verify.py TONEWRIGHT
"""
import json
import os
import pathlib
import shutil
import stat
import subprocess
import sys
import tempfile

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


class Checks:
    def __init__(self, tonewright: str):
        self.tonewright = tonewright
        self.failures = 0
        self.count = 0

    def check(self, what: str, is_ok: bool, detail) -> None:
        self.count += 1
        if not is_ok:
            self.failures += 1
            print(f"{what}: {detail}")

    def verify(self, *arguments: str, **environment: str):
        """Exit code, rows of shaders, languages that were not executed with the reason, messages."""
        done = subprocess.run([self.tonewright, "verify", *(arguments or OPERATORS), "--quick", "--best-target", "--json"],
                              env=os.environ | environment, capture_output=True, text=True, check=False)
        found = json.loads(done.stdout) if done.stdout else {"rows": [], "not_executed": []}
        rows = [row for row in found["rows"] if not row["backend"].startswith(("simd", "ocio"))]
        return done.returncode, rows, {n["name"]: n["reason"] for n in found["not_executed"]}, done.stderr


def dawn_environment(tonewright: str) -> dict:
    """The environment that `verify` needs for WGSL and HLSL; empty if Dawn() reports that it is missing."""
    try:
        return {"TONEWRIGHT_NODE_MODULES": str(Dawn(tonewright).modules), "VK_ICD_FILENAMES": str(SWIFTSHADER)}
    except SystemExit:
        return {}


def script(folder: pathlib.Path, name: str, text: str) -> str:
    path = folder / name
    path.write_text(text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def main(tonewright: str) -> int:
    checks = Checks(tonewright)
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if not compiler:
        skip("no C compiler")
    cache = tempfile.TemporaryDirectory()  # else pocl fills the user's
    os.environ["POCL_CACHE_DIR"] = cache.name
    dawn = dawn_environment(tonewright)
    wanted = {"c"} | ({"wgsl", "hlsl"} if dawn else set())
    code, rows, not_executed, messages = checks.verify(**dawn)
    executed = {row["backend"] for row in rows}
    print("executed:", ", ".join(f"{row['backend']} {row['max']:.1e} ({row['lowering']})" for row in rows
                                 if row["operator"] == "hable"))
    checks.check("every language is executed, or has a reason", code == 0 and wanted <= executed
                 and not executed & set(not_executed)
                 and executed | {"msl", "osl", "godot", "reshade", "shadertoy", "gstreamer"} <= executed | set(not_executed)
                 and {"glsl", "glsl-es", "wgsl", "hlsl", "dctl", "c"} <= executed | set(not_executed),
                 (code, executed, not_executed, messages))
    checks.check("errors are within their bounds", all(row["ok"] and row["max_all"] <= row["bound"] for row in rows), rows)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        own = {"TMPDIR": name}
        # A missing program is reported, and is not an error.
        for environment, language, reason in (
                ({"CC": str(folder / "none")}, "c", "no C compiler"),
                ({"CC": "false"}, "c", "no C compiler"),
                ({"PATH": name}, "c", "no C compiler"),
                ({"OCL_ICD_VENDORS": str(folder / "none")}, "dctl", "no OpenCL"),
                ({"TONEWRIGHT_NODE_MODULES": ""}, "wgsl", "TONEWRIGHT_NODE_MODULES is not set"),
                ({"TONEWRIGHT_NODE_MODULES": name}, "hlsl", "TONEWRIGHT_NODE_MODULES has no webgpu"),
                (dawn | {"PATH": name}, "wgsl", "node: No such file" if dawn else "TONEWRIGHT_NODE_MODULES is not set")):
            code, rows, not_executed, messages = checks.verify("hable", "--shaders", language, **own | environment)
            checks.check(f"{language} with {environment}", code == 0 and not rows
                         and not_executed.get(language, "").startswith(reason), (code, rows, not_executed, messages))
        # Errors are found.
        for text, note in ((WRONG_CONSTANT, "worst at"), (NO_C, "error")):
            wrong = script(folder, "wrong_cc", text)
            code, rows, _, messages = checks.verify("hable", "--shaders", "c", CC=wrong, REAL_CC=compiler, **own)
            checks.check(f"a compiler that changes the text: {note}", code == 1 and len(rows) == 1 and not rows[0]["ok"]
                         and note in rows[0]["note"], (code, rows, messages))
        if dawn:
            glslang = shutil.which("glslangValidator")
            script(folder, "glslangValidator", WRONG_CONSTANT_HLSL)
            code, rows, _, messages = checks.verify("hable", "--shaders", "hlsl", REAL_GLSLANG=glslang,
                                                    PATH=f"{name}:{os.environ['PATH']}", **dawn | own)
            checks.check("a wrong text of HLSL", code == 1 and len(rows) == 1 and not rows[0]["ok"], (code, rows, messages))
        left = [path.name for path in folder.iterdir() if path.name.startswith("tonewright-")]
        checks.check("no temporary folder is left", not left, left)
    for arguments in (["--shaders", "none"], ["--no-gpu"]):
        code, rows, not_executed, messages = checks.verify("hable", *arguments)
        checks.check(f"verify {arguments}", code == 0 and not rows and not not_executed, (code, rows, not_executed, messages))
    done = subprocess.run([tonewright, "verify", "hable", "--shaders", "wgls"], capture_output=True, text=True, check=False)
    checks.check("an unknown language", done.returncode == 2 and done.stderr.count("\n") == 1
                 and "did you mean wgsl?" in done.stderr, done.stderr)
    print(f"{checks.count - checks.failures} passed, {checks.failures} failed")
    return 1 if checks.failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
