# SPDX-License-Identifier: Apache-2.0
"""`--progress`: lines on standard output for farms (Open Job Description) and programs (JSON), and the bar on a terminal.

Open Job Description takes `openjd_progress: PERCENT` from standard output, PERCENT a number from 0 to 100.
"""

import contextlib
import json
import os
import pty
import re
import subprocess

import pytest
from shots import contents, make_shot

pytestmark = pytest.mark.share(3)

OK, FAILED, USAGE, FILE = 0, 1, 2, 3
HABLE = ["--operator", "hable", "--display", "linear"]


class Tool:
    def __init__(self, command, folder):
        self.command, self.folder = command, folder

    def __call__(self, *arguments):
        """(exit code, lines on standard output, standard error)"""
        done = subprocess.run([str(self.command), *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              check=False)
        return done.returncode, done.stdout.splitlines(), done.stderr

    def on_terminal(self, *arguments):
        """(exit code, what the terminal shows)"""
        leader, follower = pty.openpty()
        process = subprocess.Popen([str(self.command), *map(str, arguments)], cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=follower)
        os.close(follower)
        shown = b""
        with contextlib.suppress(OSError):  # the other end is closed
            while part := os.read(leader, 4096):
                shown += part
        os.close(leader)
        return process.wait(), shown.decode()


@pytest.fixture(scope="module")
def tool(command, folder):
    make_shot(folder, range(1, 13))
    (folder / "many").mkdir()
    make_shot(folder / "many", range(1, 6))
    return Tool(command, folder)


def percents_of(lines):
    """Per cents of lines that are progress; those of JSON have their task."""
    openjd = [re.fullmatch(r"openjd_progress: (\d+)", line) for line in lines]
    return [int(match[1]) for match in openjd if match] or [
        json.loads(line)["progress"] for line in lines if line.startswith('{"progress"') and json.loads(line)["task"]]


def is_complete(percents):
    return (percents[:1] == [0] and percents[-1:] == [100] and percents == sorted(set(percents)))


FRAMES = ["apply", "in.#.exr", "out.#.exr", *HABLE, "--frames", "1-12"]
COMMANDS = {
    "apply": ["apply", "in.0001.exr", "out.exr", *HABLE],
    "apply, folder": ["apply", "many", "-o", "made/", "--format", "exr", *HABLE],
    "apply --frames": FRAMES,
    "apply --frames --auto-exposure": [*FRAMES, "--auto-exposure", "mean"],
    "apply --frames --timeout": [*FRAMES, "--timeout", "60"],
    "apply --auto-exposure": ["apply", "in.0001.exr", "out.exr", *HABLE, "--auto-exposure", "mean"],
    "apply, folder --auto-exposure": ["apply", "many", "-o", "made/", "--format", "exr", *HABLE, "--auto-exposure", "mean"],
    "apply --false-color --legend": ["apply", "in.0001.exr", "out.png", "--false-color", "--legend"],
    "meter --frames": ["meter", "in.#.exr", "--frames", "1-12"],
    "compare": ["compare", "in.0001.exr", "hable", "clamp", "-o", "sheet.png"],
    "bake": ["bake", "hable", "--size", "17", "-o", "hable.cube"],
    "config": ["config", "-o", "config", "--views", "hable", "--displays", "srgb"],
    "verify": ["verify", "hable", "--quick", "--best-target", "--shaders", "none"],
    "report": ["report", "-o", "page.html", "--operators", "hable", "--no-parity"],
}


@pytest.mark.parametrize("what, form", [(what, form) for what in COMMANDS for form in ("openjd", "json")
                                        if form == "openjd" or what.startswith("apply")])
def test_lines(tool, report, what, form):
    """From 0 to 100, each per cent at most once, also with --quiet, and no other form of line."""
    code, lines, said = tool(*COMMANDS[what], "--progress", form, "-q")
    percents = percents_of(lines)
    report.check(f"{what} --progress {form}", code == OK and is_complete(percents), f"{code} {lines[:20]} {said}")
    known = "openjd_" if form == "openjd" else '{"progress"'
    if what.startswith("apply"):
        report.check(f"{what} --progress {form}: nothing else on standard output",
                     all(line.startswith(known) for line in lines), lines[:20])


def test_counts(tool, report):
    """12 frames are 12 steps; with metering before them, frames are the last 70 %."""
    _, lines, _ = tool(*FRAMES, "--progress", "json")
    counted = [(each["done"], each["total"], each["unit"], each["progress"]) for each in map(json.loads, lines[1:-1])]
    report.check("frames are counted", counted == [(n, 12, "frames", 100 * n // 12) for n in range(1, 12)] + [(12, 12, "frames", 99)],
                 counted)
    report.check("the ends", json.loads(lines[0])["progress"] == 0 and json.loads(lines[-1]) == {"progress": 100, "task": "apply"},
                 lines)
    _, lines, _ = tool(*FRAMES, "--auto-exposure", "mean", "--progress", "json")
    units = [each.get("unit") for each in map(json.loads, lines)]
    writing = [each["progress"] for each in map(json.loads, lines) if each.get("unit") == "frames"]
    report.check("metered frames come first", units.index("metered frames") < units.index("frames") and writing
                 and min(writing) > 30, lines)
    _, lines, _ = tool(*FRAMES, "--progress", "openjd")
    report.check("a status for farms", lines[0] == "openjd_status: apply: 12 frames", lines[:2])


@pytest.mark.parametrize("what, code, arguments", [
    ("a missing frame", FAILED, [*FRAMES[:-1], "1-13"]),
    ("a missing picture", FILE, ["apply", "none.exr", "out.exr", *HABLE]),
    ("a warning with --strict", FAILED, ["apply", "in.0001.exr", "out.exr", "--operator", "hable", "--strict"]),
])
def test_failures(tool, report, what, code, arguments):
    """A failed command never says 100."""
    is_code, lines, said = tool(*arguments, "--progress", "openjd")
    percents = percents_of(lines)
    report.check(what, is_code == code and percents == sorted(set(percents)) and 100 not in percents, f"{is_code} {lines} {said}")


@pytest.mark.parametrize("what, arguments, words", [
    ("standard output is the picture", ["apply", "in.0001.exr", "-", "--format", "png", "--progress", "json"],
     "--progress is json; expected bar or none with - as the output"),
    ("standard output is JSON", ["meter", "in.0001.exr", "--json", "--progress", "openjd"], "--json and --progress are given; expected one of them"),
    ("another form", ["apply", "in.0001.exr", "out.exr", "--progress", "bars"], "--progress"),
])
def test_refused(tool, report, what, arguments, words):
    code, lines, said = tool(*arguments)
    report.check(what, code == USAGE and not lines and words in said and len(said.splitlines()) == 1, f"{code} {lines} {said}")


def test_files(tool, report):
    """The files are the same, and without the option standard output is empty."""
    tool(*FRAMES, "--progress", "openjd")
    told = contents(tool.folder)
    code, lines, _ = tool(*FRAMES)
    report.check("the same files", code == OK and not lines and len(told) >= 12 and told == contents(tool.folder), lines)


def test_terminal(tool, report):
    """The line of work that takes seconds; --progress none and --quiet leave it out."""
    slow = ["bake", "agx_blender", "--for", "resolve", "-o", "agx.cube"]
    code, text = tool.on_terminal(*slow)
    report.check("bake on a terminal: the seconds", code == OK and re.search(r"\rbake: [1-9]\d* s\x1b\[K", text)
                 and "\r\x1b[K" in text, text[:300])
    for option in (["--progress", "none"], ["-q"]):
        code, text = tool.on_terminal(*slow, *option)
        report.check(f"bake {' '.join(option)} on a terminal: no line", code == OK and "\r\x1b" not in text and " s\x1b" not in text,
                     text[:300])
