# SPDX-License-Identifier: Apache-2.0
"""`--timeout`: a reader that hangs, crashes or ends its process costs one frame, not the shot.

tests/cli/hostile_reader is an OpenImageIO plugin that reads `.hostile` files, whose text says what their reader does.
"""

import os
import subprocess
import time
from pathlib import Path

import pytest
from pictures import share_of, skip
from shots import contents, leftovers, make_shot

pytestmark = pytest.mark.share(3)

OK, FAILED, FILE = 0, 1, 3  # exit codes
SHOT = {1: "good", 2: "hang", 3: "good", 4: "crash", 5: "exit", 6: "good"}
SECONDS = "1"


class Tool:
    def __init__(self, command, reader, folder):
        self.command, self.folder = command, folder
        self.environment = {**os.environ, "OIIO_LIBRARY_PATH": str(reader)}

    def __call__(self, *arguments):
        """(exit code, lines on standard error, seconds)"""
        start = time.monotonic()
        done = subprocess.run([str(self.command), *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              check=False, env=self.environment, timeout=120)
        return done.returncode, done.stderr.splitlines(), time.monotonic() - start

    def clean(self):
        for path in self.folder.glob("out.*"):
            path.unlink()


@pytest.fixture(scope="module")
def tool(command, folder):
    reader = command.parents[1] / "tests" / "hostile_reader"
    if not reader.is_dir():
        skip(f"there is no {reader}")
    for frame, text in SHOT.items():
        (folder / f"in.{frame}.hostile").write_text(text)
    make_shot(folder, range(1, 5))
    return Tool(command, reader, folder)


@pytest.mark.parametrize("arguments", [[], ["--jobs", "1"], ["--auto-exposure", "mean"]], ids=" ".join)
def test_shot(tool, report, arguments):
    tool.clean()
    code, lines, seconds = tool("apply", "in.@.hostile", "out.@.png", "--operator", "hable", "--frames", "1-6", "--timeout",
                                SECONDS, *arguments)
    what = f"a shot {' '.join(arguments)}:"
    files = contents(tool.folder)
    report.check(f"{what} exit code 1", code == FAILED, f"{code} {lines}")
    report.check(f"{what} the good frames, alike", sorted(files) == ["out.1.png", "out.3.png", "out.6.png"]
                 and len(set(files.values())) == 1, sorted(files))
    for frame, words in ((2, "no result after 1 s (--timeout)"), (4, "the process crashed (signal 11, Segmentation fault)"),
                         (5, "the process ended early (exit code 0)")):
        report.check(f"{what} one line for frame {frame}", sum(f"in.{frame}.hostile: {words}" in line for line in lines) == 1,
                     lines)
    report.check(f"{what} a summary", lines and "6 frames: 3 written, 3 failed: 2,4-5" in lines[-1] and len(lines) == 4, lines)
    report.check(f"{what} nothing is left of the killed ones", not leftovers(tool.folder), leftovers(tool.folder))
    report.check(f"{what} in time", seconds < 30, seconds)


def test_pictures(tool, report):
    tool.clean()
    hang, crash = (2, "no result after 1 s (--timeout)"), (4, "the process crashed (signal 11")
    for command, options in (("apply", ["out.png", "--operator", "hable"]), ("meter", []),
                             ("apply", ["out.png", "--operator", "hable", "--auto-exposure", "mean"])):
        for frame, words in (hang, crash):
            code, lines, _ = tool(command, f"in.{frame}.hostile", *options, "--timeout", SECONDS)
            report.check(f"{command} {SHOT[frame]} {' '.join(options[3:])}",
                         code == FILE and len(lines) == 1 and f"in.{frame}.hostile: {words}" in lines[0], f"{code} {lines}")
    code, lines, _ = tool("apply", "in.1.hostile", "in.4.hostile", "-o", ".", "--format", "png", "--operator", "hable",
                          "--timeout", SECONDS)
    report.check("two pictures, of which one crashes", code == FAILED and (tool.folder / "in.1.png").exists()
                 and not (tool.folder / "in.4.png").exists() and any("in.4.hostile: the process crashed" in l for l in lines),
                 f"{code} {lines}")
    report.check("nothing is left beside the pictures", not leftovers(tool.folder), leftovers(tool.folder))


def test_killed(tool, report):
    """SIGTERM to the command ends the processes of the pictures, too, and removes their temporary files."""
    tool.clean()
    with subprocess.Popen([str(tool.command), "apply", "in.2.hostile", "out.png", "--operator", "hable", "--timeout", "100"],
                          cwd=tool.folder, stderr=subprocess.DEVNULL, env=tool.environment) as process:
        deadline = time.monotonic() + 60
        while not leftovers(tool.folder) and time.monotonic() < deadline:  # the temporary file: the child reads
            time.sleep(0.01)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        process.terminate()
    while any(Path(f"/proc/{child}").exists() for child in children) and time.monotonic() < deadline:
        time.sleep(0.01)
    report.check("SIGTERM ends all processes", len(children) == 1 and not Path(f"/proc/{children[0]}").exists(), children)
    report.check("SIGTERM leaves nothing", not leftovers(tool.folder), leftovers(tool.folder))


def test_same(tool, report):
    """A process for each frame writes and meters the same as one process."""
    cases = [[], ["--auto-exposure", "histogram", "--adapt"], ["--auto-exposure", "log-average", "--threads", "3"],
             ["--operator", "drago", "--statistics", "sequence"], ["--jobs", "2"], ["--frames", "1-3", "--strict"]]
    for options in share_of(cases, 2):
        results = []
        for timeout in ([], ["--timeout", "100"]):
            tool.clean()
            frames = [] if "--frames" in options else ["--frames", "1-4"]
            operator = [] if "--operator" in options else ["--operator", "hable"]
            code, lines, _ = tool("apply", "in.####.exr", "out.####.png", *operator, *frames, *options, *timeout)
            results.append((code, lines, contents(tool.folder)))
        report.check(f"the same files {' '.join(options)}", results[0] == results[1] and results[0][0] == OK
                     and len(results[0][2]) >= 3, [(code, lines, sorted(files)) for code, lines, files in results])
    tool.clean()
    pq = ["--display", "rec2100_pq", "--operator", "hable"]
    said = [tool("apply", "in.0001.exr", "out.jpg", *pq, *timeout)[:2] for timeout in ([], ["--timeout", "100"])]
    report.check("the same warnings", said[0] == said[1] and any("warning: " in line for line in said[0][1]), said)
    code, lines, _ = tool("apply", "in.0001.exr", "out.jpg", *pq, "--timeout", "100", "--strict")
    report.check("--strict", code == FAILED and len(lines) == 1 and "--strict" in lines[0], f"{code} {lines}")
