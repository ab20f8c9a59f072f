# SPDX-License-Identifier: Apache-2.0
"""Local operators on the command line: what lists say of them, who refuses them and why, and whole commands.

Their numbers: python_check/local_operators.py.
"""

import json
import subprocess
from pathlib import Path

import numpy as np
from pictures import read_rgb, write_exr

IDS = ["exposure_fusion", "local_laplacian", "reinhard_local"]


def call(command, *arguments, stdin=""):
    done = subprocess.run([command, *map(str, arguments)], capture_output=True, text=True, input=stdin, check=False)
    return done.returncode, done.stdout, done.stderr


def test_lists(report, command):
    _, overview, _ = call(command, "list")
    part = overview.split("local: pictures only")
    report.check("the overview has a part of its own", len(part) == 2)
    report.check("which names all", all(f"\n  {i} " in part[-1].split("displays")[0] for i in IDS))
    report.check("and nothing else does", not any(f"\n  {i} " in part[0] for i in IDS))
    listed = json.loads(call(command, "list", "--json")[1])
    report.check("local_operators of --json", [o["id"] for o in listed["local_operators"]] == IDS)
    report.check("operators of --json are not local", not any(o["is_local"] for o in listed["operators"]))
    views = call(command, "list", "--views")[1]
    markdown = call(command, "list", "--markdown")[1]
    for i in IDS:
        one = json.loads(call(command, "list", i, "--json")[1])
        report.check(f"{i} --json", one["is_local"] and one["id"] == i and one["parameters"])
        text = call(command, "list", i)[1]
        report.check(f"{i} says what it is", "local       pictures only" in text and "OpenColorIO" not in text, text)
        report.check(f"{i} is in --markdown", f"(`{i}`)" in markdown and "* Local: pictures only" in markdown)
        report.check(f"{i} is no view", i not in views)


def test_refusals(report, command, scratch):
    for i in IDS:
        for arguments, stdin in [(["bake", i, "--format", "cube", "-o", f"{scratch}/x.cube"], ""),
                                 (["bake", i, "--for", "resolve", "-o", f"{scratch}/x.cube"], ""),
                                 (["config", "-o", f"{scratch}/config", "--operator", i, "--name", "X"], ""),
                                 (["eval", i], "0.1 0.1 0.1"), (["verify", i], "")]:
            code, out, error = call(command, *arguments, stdin=stdin)
            report.check(f"{arguments[0]} {i}",
                         code == 2 and not out and error.count("\n") == 1 and
                         error.startswith(f"tonewright: operator is {i}, a local operator, which needs a picture; ") and
                         "`tonewright apply`" in error, f"{code} {error}")
    report.check("nothing was written", not list(scratch.iterdir()))
    for arguments, message in [
            (["list", "reinhard_locl"], "did you mean reinhard_local?"),
            (["apply", "a", "b.png", "--operator", "local_laplacian", "--set", "detial=2"], "did you mean detail?"),
            (["apply", "a", "b.png", "--operator", "local_laplacian", "--set", "detail=9"], "detail is 9; expected [0, 4]"),
            (["apply", "a", "b.png", "--operator", "exposure_fusion", "--set", "boost_local_contrast=maybe"],
             "expected no or yes"),
            (["apply", "a", "b.png", "--operator", "exposure_fusion", "--set", "mip=1.5"], "expected a whole number"),
            (["apply", "a", "b.png", "--operator", "reinhard_local", "--look", "x"], "look is x; expected none")]:
        code, _, error = call(command, *arguments)
        report.check(message, code == 2 and error.count("\n") == 1 and message in error, error)


def test_pictures(report, command, scratch):
    rng = np.random.default_rng(5)
    light = 0.18 * 2 ** rng.uniform(-6, 6, (37, 53, 3)).astype(np.float32)
    for n in (1, 2):
        write_exr(f"{scratch}/in.{n:04d}.exr", {c: light[..., i] for i, c in enumerate("RGB")})
    source = f"{scratch}/in.0001.exr"
    for i in IDS:
        out = f"{scratch}/{i}.exr"
        code, _, error = call(command, "apply", source, out, "--operator", i, "--display", "linear", "-d", "float")
        report.check(f"apply {i}", code == 0 and not error, error)
        linear = read_rgb(out, scratch)
        report.check(f"{i} is a picture", np.isfinite(linear).all() and linear.min() >= 0 and linear.std() > 0.05)
        # The display is that of any operator: IEC 61966-2-1 of what `linear` shows. 1e-6 is the engine's bound.
        call(command, "apply", source, out, "--operator", i, "-d", "float")
        clipped = np.clip(linear.astype(float), 0, 1)
        encoded = np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
        report.bound(f"{i} on sRGB", abs(read_rgb(out, scratch) - encoded).max(), 3e-6)
        code, _, error = call(command, "apply", f"{scratch}/in.%04d.exr", f"{scratch}/{i}.%04d.exr", "--frames", "1-2",
                              "--operator", i, "--display", "linear", "-d", "float")
        frames = [read_rgb(f"{scratch}/{i}.{n:04d}.exr", scratch) for n in (1, 2)]
        report.check(f"frames of {i}", code == 0 and all((f == linear).all() for f in frames), error)
        threads = f"{scratch}/one.exr"
        call(command, "apply", source, threads, "--operator", i, "--display", "linear", "-d", "float", "--threads", "1")
        report.check(f"{i} on one thread", (read_rgb(threads, scratch) == linear).all())
    whole = Path(source).read_bytes()
    Path(f"{scratch}/cut.exr").write_bytes(whole[: len(whole) // 2])
    code, _, error = call(command, "apply", f"{scratch}/cut.exr", f"{scratch}/x.png", "--operator", IDS[0])
    report.check("a damaged picture", code == 3 and error.count("\n") == 1 and not Path(f"{scratch}/x.png").exists(), error)
    code, _, error = call(command, "apply", source, f"{scratch}/none/x.png", "--operator", IDS[0])
    report.check("a folder that is not there", code == 3 and error.count("\n") == 1, error)
