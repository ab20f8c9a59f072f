# SPDX-License-Identifier: Apache-2.0
"""Memory and disks that fail at one call: the command ends with one line and exit code 3, and leaves no partial file.

    python3 tests/faults/test_faults.py build/release/bin/tonewright build/release/tests/tonewright_faults.so [JOB...]
        [--points N] [--only FAULT]

For each job the shim counts the distinct call stacks of allocations and the calls on files, then one run for each of them makes
it fail: for all calls on files, and for N call stacks (default 60). A run may end well where the program goes on without the
memory, as a cache does: then its output is that of an unbroken run. The last line is `N passed, M failed`.
"""

import argparse
import errno
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity" / "clients"))
from pictures import Report  # noqa: E402

OK, NO_FILE = 0, 3
OLD = b"the old file"
TRIPLETS = b"0.18 0.18 0.18\n1 2 3\n"
# Name -> (arguments, the file that it writes). Pictures run on one thread, so that the order of calls is always the same.
JOBS = {
    "eval": (["eval", "hable"], None),
    "bake": (["bake", "hable", "--input", "lin_rec709", "--size", "17", "-q", "-o", "out.cube"], "out.cube"),
    "shader": (["shader", "hable", "--language", "glsl", "-q", "-o", "out.glsl"], "out.glsl"),
    "apply_png": (["apply", "in.exr", "out.png", "--operator", "hable", "--threads", "1"], "out.png"),
    "apply_exr": (["apply", "in.exr", "out.exr", "--operator", "hable", "--display", "linear", "--threads", "1"], "out.exr"),
}
POINTS = 60
SECONDS = 120  # a run takes less than one second


class Job:
    """A job in a folder of its own for each run, whose only other files are its inputs."""

    def __init__(self, command, shim, name, picture, scratch):
        self.command, self.shim, self.name, self.picture, self.scratch = command, shim, name, picture, scratch
        self.arguments, self.target = JOBS[name]

    def run(self, fault=None, log=None):
        """(exit code, lines of errors, the output or None, other files that are left)"""
        with tempfile.TemporaryDirectory(dir=self.scratch) as name:
            folder = Path(name)
            if "in.exr" in self.arguments:
                os.link(self.picture, folder / "in.exr")
            if self.target:
                (folder / self.target).write_bytes(OLD)
            # Without a cache of earlier runs, each run does the same.
            environment = {**os.environ, "LC_ALL": "C.UTF-8", "XDG_CACHE_HOME": str(folder / "cache"),
                           "LD_PRELOAD": str(self.shim), "OPENIMAGEIO_OPTIONS": "threads=1,exr_threads=-1"}
            if fault:
                environment["TONEWRIGHT_FAULT"] = fault
            if log:
                environment["TONEWRIGHT_FAULT_LOG"] = str(log)
            try:
                done = subprocess.run([self.command, *self.arguments], cwd=folder, env=environment, input=TRIPLETS,
                                      capture_output=True, check=False, timeout=SECONDS)
            except subprocess.TimeoutExpired:
                return "a hang", [], None, []
            shutil.rmtree(folder / "cache", ignore_errors=True)
            left = [path.name for path in folder.iterdir() if path.name not in ("in.exr", self.target)]
            output = (folder / self.target).read_bytes() if self.target else done.stdout
            return done.returncode, done.stderr.decode(errors="replace").splitlines(), output, left

    def count(self):
        """(numbers of allocations with a new call stack, [(number, name) of calls on files], the output)"""
        log = self.scratch / f"{self.name}.log"
        code, lines, output, _ = self.run(log=log)
        if code != OK or lines:
            raise RuntimeError(f"{self.name} without a fault: {code}, {lines}")
        entries = [line.split() for line in log.read_text().splitlines()]
        return ([int(words[1]) for words in entries if words[0] == "memory"],
                [(int(words[1]), words[2]) for words in entries if words[0] == "file"], output)

    def what_is_wrong(self, fault, whole):
        """None, or what is wrong with a run."""
        code, lines, output, left = self.run(fault)
        said = f"{self.name} {fault}: exit {code}, {lines}"
        if code not in (OK, NO_FILE):
            return f"{said}; expected 0 or 3"
        if left:
            return f"{said}; left {left}"
        if code == OK and (output != whole or lines):
            return f"{said}; the output is not that of an unbroken run"
        if code == OK:
            return None
        if len(lines) != 1 or not lines[0].startswith("tonewright: "):
            return f"{said}; expected one line"
        # The new file may be whole, where only the folder's sync failed.
        if self.target and output not in (OLD, whole):
            return f"{said}; a partial file"
        if re.search(r"bad_alloc|basic_string|vector::|std::", lines[0]):
            return f"{said}; expected words of people"
        return None


def spread(numbers, count):
    """`count` of them, over the whole range, or all."""
    if len(numbers) <= count:
        return numbers
    return [numbers[i * len(numbers) // count] for i in range(count)]


def faults_of(job, points):
    """Kind -> faults, and the output of an unbroken run."""
    memory, files, whole = job.count()
    total = max(memory)
    return {
        "memory": [f"memory:{number}" for number in spread(memory, points)],
        "memory from there on": [f"memory-from:{number}" for number in spread(memory, min(points, 500) // 4)],
        "disk full": [f"file:{number}:{errno.ENOSPC}" for number, _ in files],
        "quota": [f"file:{number}:{errno.EDQUOT}" for number, _ in spread(files, 10)],
        "I/O error": [f"file:{number}:{errno.EIO}" for number, _ in spread(files, 40)],
        "one byte written": [f"short:{number}" for number, name in files if "write" in name and name != "fwrite"],
    }, whole, total


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    parser.add_argument("shim", type=Path)
    parser.add_argument("jobs", nargs="*", default=list(JOBS), metavar="JOB")
    parser.add_argument("--points", type=int, metavar="N", default=POINTS, help="call stacks of allocations (default %(default)s)")
    parser.add_argument("--only", metavar="FAULT", help="run this one and show it, such as memory:120")
    arguments = parser.parse_args()
    report = Report()
    with tempfile.TemporaryDirectory(prefix="tonewright-") as name, ThreadPoolExecutor(os.cpu_count()) as pool:
        scratch = Path(name)
        picture = scratch / "in.exr"
        command = arguments.command.resolve()
        subprocess.run([command, "chart", "-o", picture, "--width", "320", "--height", "180"], check=True)
        for job_name in arguments.jobs:
            job = Job(command, arguments.shim.resolve(), job_name, picture, scratch)
            if arguments.only:
                code, lines, output, left = job.run(arguments.only)
                print(f"{job_name} {arguments.only}: exit {code}, {len(output or b'')} bytes, left {left}", *lines, sep="\n")
                continue
            faults, whole, total = faults_of(job, arguments.points)
            for kind, runs in faults.items():
                if not runs:
                    continue
                wrong = [text for text in pool.map(lambda fault: job.what_is_wrong(fault, whole), runs) if text]
                report.check(f"{job_name}: {kind}: {len(runs)} runs", not wrong,
                             f"{len(wrong)} are wrong:\n     " + "\n     ".join(wrong[:10]))
            print(f"     ({job_name} allocates {total} times)")
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
