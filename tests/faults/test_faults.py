# SPDX-License-Identifier: Apache-2.0
"""Memory and disks that fail at one call: the command ends with one line and exit code 3, and leaves no partial file.

    python3 -m pytest tests/faults/test_faults.py --tonewright build/release/bin/tonewright [-k JOB] [--points N] [--only FAULT]

For each job the shim counts the distinct call stacks of allocations and the calls on files, then one run for each of them makes
it fail: for all calls on files, and for N call stacks (default 60). A run may end well where the program goes on without the
memory, as a cache does: then its output is that of an unbroken run. Runs are also killed at their calls on files.

test_into does the same to `config --into`, --update and --remove. After a failure, the folder has the old files. After a kill, the
config is the old or the new one, and later runs update it and remove everything that was added.
"""

import errno
import os
import re
import shutil
import signal
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from shots import CONFIG

OK, NO_FILE = 0, 3
OLD = b"the old file"
TRIPLETS = b"0.18 0.18 0.18\n1 2 3\n"
# Name -> (arguments, the file that it writes). Pictures run on one thread, so that the order of calls is always the same.
JOBS = {
    "eval": (["eval", "hable"], None),
    "bake": (["bake", "hable", "--input", "lin_rec709", "--size", "17", "-q", "-o", "out.cube"], "out.cube"),
    "shader": (["shader", "hable", "--language", "glsl", "-q", "-o", "out.glsl"], "out.glsl"),
    "plot_pdf": (["plot", "hable", "-o", "out.pdf"], "out.pdf"),
    "plot_png": (["plot", "hable", "--width", "320", "-o", "out.png"], "out.png"),
    "apply_png": (["apply", "in.exr", "out.png", "--operator", "hable", "--threads", "1"], "out.png"),
    "apply_exr": (["apply", "in.exr", "out.exr", "--operator", "hable", "--display", "linear", "--threads", "1"], "out.exr"),
}
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
        if fault.startswith("kill"):
            is_whole = self.target is None or output in (OLD, whole)
            left = [name for name in left if not name.startswith(".")]
            return None if code == -signal.SIGKILL and is_whole and not left else f"{said}; left {left}, a whole file: {is_whole}"
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
        # Rows are compressed and written at the end, and libraries have lost such errors.
        "memory": [f"memory:{number}" for number in sorted({*spread(memory, points), *memory[-40:]})],
        "memory from there on": [f"memory-from:{number}" for number in spread(memory, min(points, 500) // 4)],
        "disk full": [f"file:{number}:{errno.ENOSPC}" for number, _ in files],
        "quota": [f"file:{number}:{errno.EDQUOT}" for number, _ in spread(files, 10)],
        "I/O error": [f"file:{number}:{errno.EIO}" for number, _ in spread(files, 40)],
        "one byte written": [f"short:{number}" for number, name in files if "write" in name and name != "fwrite"],
        "killed": [f"kill:{number}" for number, _ in spread(files, points)],
    }, whole, total


class Into:
    """`config --into` and what follows it, each in a folder of its own."""

    STEPS = (["--views", "hable,clamp", "--looks", "none", "--backup"], ["--update", "--views", "reinhard"], ["--remove"])

    def __init__(self, command, shim, scratch):
        self.command, self.shim, self.scratch = command, shim, scratch

    def run(self, folder, *arguments, **variables):
        environment = {**os.environ, "XDG_CACHE_HOME": str(self.scratch / "cache"), **variables}
        if variables:
            environment["LD_PRELOAD"] = str(self.shim)
        return subprocess.run([self.command, "config", "--into", "studio.ocio", "-q", *arguments], cwd=folder, env=environment,
                              capture_output=True, text=True, check=False, timeout=SECONDS)

    @staticmethod
    def files(folder):
        return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    def after_failure(self, number, step, old, new):
        """None, or what is wrong after a call on a file that fails."""
        with tempfile.TemporaryDirectory(dir=self.scratch) as name:
            folder = Path(name) / "config"
            shutil.copytree(old, folder)
            done = self.run(folder, *self.STEPS[step], TONEWRIGHT_FAULT=f"file:{number}:{errno.ENOSPC}")
            if done.returncode == OK and not done.stderr and self.files(folder) == self.files(new):
                return None
            found = {name: found for name, found in self.files(folder).items() if ".bak" not in name}
            is_said = done.returncode == NO_FILE and done.stderr.startswith("tonewright: ") and done.stderr.count("\n") == 1
            is_old = found == {name: found for name, found in self.files(old).items() if ".bak" not in name}
            # Where only the record's last name is missing, the next run finds it.
            is_new = found["studio.ocio"] == self.files(new)["studio.ocio"] and "tonewright/studio.ocio.yaml.new" in found
            return None if is_said and (is_old or is_new) else f"{number} fails: exit {done.returncode}: {done.stderr}; {sorted(found)}"

    def after_kill(self, number, step, old, new):
        """None, or what is wrong after a kill at a call on a file."""
        with tempfile.TemporaryDirectory(dir=self.scratch) as name:
            folder = Path(name) / "config"
            config = folder / "studio.ocio"
            shutil.copytree(old, folder)
            killed = self.run(folder, *self.STEPS[step], TONEWRIGHT_FAULT=f"kill:{number}")
            if killed.returncode != -signal.SIGKILL:
                return f"{number}: exit {killed.returncode}: {killed.stderr}"
            after, before = ((place / "studio.ocio").read_bytes() for place in (new, old))
            if config.read_bytes() not in (before, after):
                return f"{number}: neither the old config nor the new one"
            if any(path.read_text() != CONFIG for path in folder.glob("studio.ocio.bak*")):
                return f"{number}: a partial backup"
            rest = [] if config.read_bytes() == after else [self.STEPS[step]]
            rest += [["--views", "clamp"], ["--remove"]] if step == 2 else [["--update"], ["--remove"]]
            for arguments in rest:
                done = self.run(folder, *arguments)
                if done.returncode or done.stderr:
                    return f"{number}: then {' '.join(arguments)}: exit {done.returncode}: {done.stderr}"
                if arguments == ["--update"] and config.read_bytes() != after:
                    return f"{number}: --update makes another config"
            left = sorted(path.name for path in folder.rglob("*") if path.name != "studio.ocio" and ".bak" not in path.name)
            # A run that is killed after it replaced the config may leave tables that nothing uses.
            left = [name for name in left if name.startswith(".") or not name.endswith(".clf") and name != "tonewright"]
            return f"{number}: left {left}" if left or config.read_text() != CONFIG else None


@pytest.fixture(scope="module")
def pool():
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        yield pool


@pytest.fixture(scope="module")
def picture(command, tmp_path_factory):
    path = tmp_path_factory.mktemp("picture") / "in.exr"
    subprocess.run([command, "chart", "-o", path, "--width", "320", "--height", "180"], check=True)
    return path


@pytest.mark.parametrize("name", JOBS)
def test_job(request, report, command, shim, scratch, pool, picture, name):
    job = Job(command, shim, name, picture, scratch)
    if only := request.config.getoption("--only"):
        code, lines, output, left = job.run(only)
        report.check(f"{name} {only}: exit {code}, {len(output or b'')} bytes, left {left}", True)
        print(*lines, sep="\n")
        return
    faults, whole, total = faults_of(job, request.config.getoption("--points"))
    for kind, runs in faults.items():
        if not runs:
            continue
        wrong = [text for text in pool.map(lambda fault: job.what_is_wrong(fault, whole), runs) if text]
        report.check(f"{name}: {kind}: {len(runs)} runs", not wrong,
                     f"{len(wrong)} are wrong:\n     " + "\n     ".join(wrong[:10]))
    print(f"     ({name} allocates {total} times)")


def test_into(request, report, command, shim, scratch, pool):
    points, into = request.config.getoption("--points"), Into(command, shim, scratch)
    old = scratch / "into.0"
    old.mkdir()
    (old / "studio.ocio").write_text(CONFIG)
    for step, arguments in enumerate(into.STEPS):
        new = scratch / f"into.{step + 1}"
        shutil.copytree(old, new)
        log = scratch / f"into.{step}.log"
        done = into.run(new, *arguments, TONEWRIGHT_FAULT_LOG=str(log))
        calls = [line.split() for line in log.read_text().splitlines() if line.startswith("file")]
        numbers = [int(number) for _, number, name in calls if name not in ("fwrite", "fflush")]  # of messages
        moments = spread(numbers, points)
        for what, check in (("killed", into.after_kill), ("failures", into.after_failure)):
            wrong = [text for text in pool.map(lambda number: check(number, step, old, new), moments) if text]
            report.check(f"config --into {' '.join(arguments)}: {what} at {len(moments)} of {len(numbers)} calls on files",
                         done.returncode == OK and moments and not wrong, "\n     ".join([done.stderr, *wrong[:10]]))
        old = new
