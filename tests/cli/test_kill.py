# SPDX-License-Identifier: Apache-2.0
"""Commands that SIGKILL, SIGINT and SIGTERM end at random moments: no partial file, and the next run is as any other.

`apply --frames` is killed 45 times (`./run test --all`: 100), and continued with --skip-existing. Every other command of JOBS is
ended once with each signal (`./run test --all`: 10 times), and then runs again. After each signal, every final name has the bytes
of an unbroken run, or the old ones; SIGINT and SIGTERM leave no temporary file. At the end, all files have the bytes of an
unbroken run, and no temporary file is left.
"""

import os
import random
import shutil
import signal
import subprocess
import time

import pytest
from pictures import ALL
from shots import CONFIG, apply, contents, leftovers, make_shot

KILLS = {"exr": 34, "png": 33, "tif": 33} if ALL else {"exr": 15, "png": 15, "tif": 15}  # OpenImageIO writes TIFF by itself
FRAMES = 30
STARTS = 4  # kills of each that may hit before the first file

SIGNALS = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM)
MOMENTS = 10 if ALL else 1  # of each signal
OWN = ["--displays", "srgb", "--looks", "none"]
# Name -> (what makes the old files, the command). Each overwrites at least one file.
JOBS = {
    "apply": ([["chart", "-o", "in.exr", "--width", "640", "--height", "360"], ["chart", "-o", "out.exr"]],
              ["apply", "in.exr", "out.exr", "--operator", "hable", "--display", "linear", "-q"]),
    "apply --frames": ([["chart", "-o", f"in.{n:04d}.exr", "--width", "320", "--height", "180"] for n in range(1, 7)],
                       ["apply", "in.#.exr", "out.#.png", "--operator", "hable", "--frames", "1-6", "--jobs", "2", "-q"]),
    "bake": ([["bake", "hable", "--input", "lin_rec709", "--size", "17", "--3d", "-q", "-o", "out.cube"]],
             ["bake", "hable", "--input", "lin_rec709", "--size", "65", "--3d", "--nodes", "sampled", "-q", "-o",
              "out.cube"]),
    "config": ([["config", "-o", "own", "--views", "clamp", *OWN, "-q"]],
               ["config", "-o", "own", "--views", "hable,reinhard", *OWN, "-q"]),
    "config --archive": ([["config", "--archive", "own.ocioz", "--views", "clamp", *OWN, "-q"]],
                         ["config", "--archive", "own.ocioz", "--views", "hable", *OWN, "-q"]),
    "config --into": ([], ["config", "--into", "studio.ocio", "--views", "hable,clamp", "--looks", "none", "-q"]),
    "config --update": ([["config", "--into", "studio.ocio", "--views", "hable", "--looks", "none", "-q"]],
                        ["config", "--into", "studio.ocio", "--update", "--views", "reinhard", "--looks", "none", "-q"]),
}


def finished_files(folder):
    return sum(1 for _ in folder.glob("out.*"))


@pytest.mark.parametrize("extension", KILLS)
def test_frames(report, command, scratch, extension):
    """Files of an extension; their part of the kills."""
    rng = random.Random(f"kill {extension}")
    make_shot(scratch, range(1, FRAMES + 1), width=96, height=64)
    arguments = ["in.#.exr", f"out.#.{extension}", "--operator", "hable", "--display", "linear", "--frames", f"1-{FRAMES}", "--jobs", "3"]

    code, lines = apply(command, *arguments, folder=scratch)
    truth = contents(scratch)
    report.check(f".{extension}: an unbroken run", code == 0 and not lines and len(truth) == FRAMES, lines)

    kills = partly = in_writing = whole = 0
    broken = []
    made = truth
    while kills < KILLS[extension]:
        if len(made) == FRAMES:  # from the beginning again
            whole += 1
            for name in made:
                (scratch / name).unlink()
            made = {}
        old = set(leftovers(scratch))
        process = subprocess.Popen([command, "apply", *arguments, "--skip-existing"], cwd=scratch,
                                   stderr=subprocess.DEVNULL)
        if kills < STARTS:
            time.sleep(rng.uniform(0, 0.3))
        else:
            # Counted in files, so that the moments are spread over the frames however fast the machine is.
            count = rng.randint(len(made), FRAMES - 1)
            while process.poll() is None and finished_files(scratch) <= count and not (
                    count == len(made) and set(leftovers(scratch)) - old):
                time.sleep(0.001)
            time.sleep(rng.uniform(0, 0.01))  # a few times what a frame takes
        process.kill()
        kills += process.wait() == -9
        made = contents(scratch)
        broken += [f"{name} after {kills} kills" for name in made if made[name] != truth.get(name)]
        partly += 0 < len(made) < FRAMES
        in_writing += bool(set(leftovers(scratch)) - old)
    code, lines = apply(command, *arguments, "--skip-existing", folder=scratch)
    report.check(f".{extension}: {kills} kills, {partly} among the frames, {in_writing} in a file; {whole} shots from "
                 "the beginning: no broken file under a final name", not broken, broken)
    # Or it would prove nothing.
    report.check(f".{extension}: kills hit files that were being written, and runs that others went on with",
                 min(in_writing, partly) >= KILLS[extension] * 3 // 10, f"{in_writing} and {partly}")
    report.check(f".{extension}: at the end the bytes of the unbroken run", code == 0 and contents(scratch) == truth, lines)
    report.check(f".{extension}: nothing is left of killed runs", not leftovers(scratch), leftovers(scratch))


class Job:
    """A command in a folder of its own, which begins with the old files each time."""

    def __init__(self, command, scratch, name):
        self.folder, self.old_folder = scratch / "now", scratch / "old"
        preparations, arguments = JOBS[name]
        self.arguments = [command, *arguments]
        self.environment = {**os.environ, "XDG_CACHE_HOME": str(scratch / "cache")}
        self.old_folder.mkdir(parents=True)
        (self.old_folder / "studio.ocio").write_text(CONFIG)
        for preparation in preparations:
            subprocess.run([command, *preparation], cwd=self.old_folder, env=self.environment, check=True,
                           stdout=subprocess.DEVNULL)
        self.old = self.files(self.old_folder)
        self.restore()
        began = time.monotonic()
        self.again()
        self.seconds = time.monotonic() - began
        self.whole = self.files(self.folder)

    @staticmethod
    def files(folder):
        """path -> bytes, without temporary files"""
        return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*"))
                if path.is_file() and not path.name.startswith(".")}

    def temporary(self):
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob(".*"))

    def restore(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(self.old_folder, self.folder)

    def start(self, *more):
        return subprocess.Popen([*self.arguments, *more], cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True)

    def again(self, *more):
        """(exit code, what it said)"""
        process = self.start(*more)
        said = process.communicate()[1]
        return process.returncode, said

    def end(self, number, rng, is_writing, share):
        """What is wrong after a signal at a moment of the whole run, or of its writing; None if it came too late."""
        self.restore()
        process = self.start()
        if is_writing:  # Its first file, even a temporary one, tells that it writes.
            while process.poll() is None and not self.temporary() and len(self.files(self.folder)) == len(self.old):
                time.sleep(0.001)
            time.sleep(rng.uniform(0, share * self.seconds / 4))
        else:
            time.sleep(rng.uniform(0, share * self.seconds))
        process.send_signal(number)
        said = process.communicate()[1]
        if process.returncode == 0:
            return None
        wrong = [] if process.returncode == -number and not said else [f"exit {process.returncode}: {said}"]
        found = self.files(self.folder)
        # The new record of --into, until the config is replaced.
        wrong += [f"{name} is not whole" for name in found if not name.endswith(".yaml.new")
                  and found[name] not in (self.old.get(name), self.whole.get(name))]
        wrong += [f"{name} is gone" for name in self.old if name in self.whole and name not in found]
        if number != signal.SIGKILL and self.temporary():
            wrong.append(f"left {self.temporary()}")
        code, said = self.again()
        # The config was replaced before the signal: its views are taken, and --update repeats them.
        if code == 2 and "already; expected another name" in said and found.get("studio.ocio") == self.whole["studio.ocio"]:
            code, said = self.again("--update")
        # What an update no longer needs may stay where a killed run had come to its end but for that.
        found = {name: found for name, found in self.files(self.folder).items() if name in self.whole or name not in self.old}
        if code != 0 or said or found != self.whole:
            different = sorted(name for name in {*found, *self.whole} if found.get(name) != self.whole.get(name))
            wrong.append(f"again: exit {code}: {said}; {different}")
        if self.temporary():
            wrong.append(f"again: left {self.temporary()}")
        return wrong


@pytest.mark.parametrize("name", JOBS)
def test_command(report, command, scratch, name):
    job = Job(command, scratch, name)
    changed = [path for path in job.whole if job.whole[path] != job.old.get(path)]
    report.check(f"{name}: writes files", changed)
    for number in SIGNALS:
        rng = random.Random(f"{name} {number}")
        wrong = []
        moments = late = 0
        while moments < MOMENTS and late < 20:
            found = job.end(number, rng, is_writing=(moments + late) % 2 == 0, share=0.7 ** late)
            if found is None:
                late += 1
                continue
            moments += 1
            late = 0
            wrong += [f"moment {moments}: {text}" for text in found]
        report.check(f"{name}: {number.name} at {moments} moments", moments == MOMENTS and not wrong, "\n     ".join(wrong[:10]))
