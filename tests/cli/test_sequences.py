# SPDX-License-Identifier: Apache-2.0
"""The frames of a shot: names, missing ones, those that are there already, full disks, and what is said of them."""

import contextlib
import os
import pty
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from pictures import skip
from shots import DATE, apply, contents, leftovers, make_shot, small_disk

OK, FAILED, USAGE = 0, 1, 2  # exit codes
HABLE = ["--operator", "hable", "--display", "linear"]  # a warning comes with EXR files of other displays


@pytest.fixture(scope="module")
def made(command, folder):
    """(what, exit code and lines) of commands that made frames 1 to 8 of a shot, PNG one by one; their files."""
    make_shot(folder, range(1, 9))
    results = [(f"apply {n}", apply(command, f"in.{n:04d}.exr", f"out.{n:04d}.png", *HABLE, folder=folder)) for n in range(1, 9)]
    for extension in ("exr", "tif"):  # of which starting takes the time; test_jobs has them one after the other
        results.append((f"apply 1-8 .{extension}", apply(command, "in.#.exr", f"out.#.{extension}", *HABLE, "--frames", "1-8",
                                                         folder=folder)))
    return results, contents(folder)


def test_made(report, made):
    for what, result in made[0]:
        report.check(what, result == (OK, []), result)


class Shots:
    """A command, a report, and a folder with frames 1 to 8 of a shot, and what the command makes of them."""

    def __init__(self, command, report, folder, truth):
        self.command, self.report, self.folder, self.truth = command, report, folder, truth

    def truths(self, numbers, extension="png"):
        return {f"out.{n:04d}.{extension}": self.truth[f"out.{n:04d}.{extension}"] for n in numbers}

    def clean(self):
        for path in self.folder.glob("out.*"):
            path.unlink()

    def apply(self, *arguments, keep=False, to="out.@@@@.png"):
        """Frames of in.@@@@.exr, into an empty folder or the given one."""
        if not keep:
            self.clean()
        return apply(self.command, "in.@@@@.exr", to, *HABLE, *arguments, folder=self.folder)

    def check(self, what, result, code, lines, expected):
        """lines: a text that each has, in order."""
        is_code, is_lines = result
        files = contents(self.folder)
        problems = []
        if is_code != code:
            problems.append(f"exit {is_code}, expected {code}")
        if len(is_lines) != len(lines) or any(
                not line.startswith("tonewright: ") or text not in line for line, text in zip(is_lines, lines)):
            problems.append(f"it said {is_lines}, expected {lines}")
        if files != expected:
            wrong = [name for name in files if name in expected and files[name] != expected[name]]
            problems.append(f"files {sorted(files)}, of which {wrong} are wrong; expected {sorted(expected)}")
        if leftovers(self.folder):
            problems.append(f"left {leftovers(self.folder)}")
        self.report.check(what, not problems, "; ".join(problems))


@pytest.fixture
def shots(command, report, folder, made):
    return Shots(command, report, folder, made[1])


@pytest.mark.share(3)
def test_names(shots):
    for to, frames, expected in (("out.@@@@.png", "2-4", ["out.0002.png", "out.0003.png", "out.0004.png"]),
                                 ("out.@.png", "2-8x3", ["out.2.png", "out.5.png", "out.8.png"]),
                                 ("out.@@.png", "8-6", ["out.06.png", "out.07.png", "out.08.png"]),
                                 ("out.%06d.png", "3", ["out.000003.png"]), ("out.#.png", "3", ["out.0003.png"]),
                                 ("out.##.png", "3", ["out.03.png"]), ("out.@2x.####.png", "3", ["out.@2x.0003.png"]),
                                 ("out.%d-@.png", "3", ["out.3-@.png"])):
        result = shots.apply("--frames", frames, to=to)
        numbers = [n for n in range(1, 9) if any(str(n) in name.replace("@2x", "") for name in expected)]
        shots.check(f"{to} {frames}", result, OK, [],
                    {name: shots.truth[f"out.{n:04d}.png"] for name, n in zip(sorted(expected), numbers)})
    folder = shots.folder / "me@host"
    folder.mkdir()
    make_shot(folder, [7, -7], name="in@{:04d}.exr", seed=1)
    code, lines = apply(shots.command, "me@host/in@@@@@.exr", "me@host/@@.png", *HABLE, "--frames", "7",
                        folder=shots.folder)
    shots.report.check("an @ of a folder's name stays", code != OK and "me@host/in00007.exr" in lines[0], lines)
    code, lines = apply(shots.command, "me@host/in@@@@.exr", "me@host/@@.png", *HABLE, "--frames", "-7", folder=shots.folder)
    shots.report.check("one @ is a digit, too: in@0007.exr is not in0007.exr", code == FAILED, lines)
    make_shot(folder, [-7], name="in.{:04d}.exr", seed=1)
    code, lines = apply(shots.command, "me@host/in.@@@@.exr", "me@host/out.@@.png", *HABLE, "--frames", "-7", folder=shots.folder)
    shots.report.check("negative numbers", (code, lines) == (OK, [])
                       and contents(folder) == {"out.-7.png": shots.truth["out.0007.png"]}, f"{lines} {list(contents(folder))}")
    code, lines = apply(shots.command, "in." + 100_000 * "#" + ".exr", "out.@@.png", *HABLE, "--frames", "7",
                        folder=shots.folder)
    shots.report.check("a pattern that is longer than any name",
                       code == FAILED and len(lines) == 2 and lines[0].startswith("tonewright: apply: in.000"),
                       f"{code} {[line[-100:] for line in lines]}")


@pytest.mark.share(3)
def test_jobs(shots):
    for extension, options in (("png", ["--jobs", 3, "--threads", 1]), ("exr", ["--jobs", 1, "--threads", 1]),
                               ("tif", ["--jobs", 2, "--threads", 5]), ("png", ["--jobs", 256, "--threads", 2]), ("png", [])):
        result = shots.apply("--frames", "1-8", *options, to=f"out.@@@@.{extension}")
        shots.check(f"{' '.join(map(str, options))} .{extension}: the same bytes", result, OK, [],
                    shots.truths(range(1, 9), extension))


@pytest.mark.share(3)
def test_missing(shots):
    away = [shots.folder / f"in.{number:04d}.exr" for number in (1, 4, 5)]
    for path in away:
        path.rename(path.with_suffix(".away"))
    there = shots.truths([2, 3, 6])
    failures = ["in.0001.exr: cannot read: No such file", "in.0004.exr: cannot read", "in.0005.exr: cannot read",
                "6 frames: 3 written, 3 failed: 1,4-5"]
    shots.check("--missing error", shots.apply("--frames", "1-6", "--missing", "error"), FAILED, failures, there)
    shots.check("the same by default", shots.apply("--frames", "1-6"), FAILED, failures, there)
    shots.check("--missing skip", shots.apply("--frames", "1-6", "--missing", "skip"), OK,
                ["6 frames: 3 written, 3 missing"], there)
    shots.check("--missing skip of all", shots.apply("--frames", "4,5", "--missing", "skip"), OK,
                ["2 frames: 0 written, 2 missing"], {})
    held = {**there, "out.0004.png": shots.truth["out.0003.png"], "out.0005.png": shots.truth["out.0003.png"]}
    shots.check("--missing hold, none earlier", shots.apply("--frames", "1-6", "--missing", "hold"), FAILED,
                ["in.0001.exr: cannot read: No such file", "6 frames: 5 written, 2 held for missing ones, 1 failed: 1"], held)
    for frames in ("5", "5-7x2", "7,5"):
        numbers = [5, 7] if "7" in frames else [5]
        expected = {"out.0005.png": shots.truth["out.0003.png"], **shots.truths(n for n in numbers if n != 5)}
        shots.check(f"--missing hold --frames {frames}: a frame that is not of these",
                    shots.apply("--frames", frames, "--missing", "hold"), OK, ["1 held for missing ones"], expected)
    result = shots.apply("--frames", "2-6", "--missing", "hold", "--skip-existing", keep=True)
    shots.check("--missing hold --skip-existing", result, OK, ["5 frames: 4 written, 1 skipped, 2 held for missing ones"],
                {name: held[name] for name in held} | shots.truths([7]))
    for path in away:
        path.with_suffix(".away").rename(path)


@pytest.mark.share(3)
def test_skip_existing(shots):
    """Of eight frames each is there in another way."""
    folder = shots.folder
    for extension, of_type in (("exr", ["-d", "float"]), ("tif", []), ("png", [])):
        name = lambda n: folder / f"out.{n:04d}.{extension}"  # noqa: E731
        all_of = shots.truths(range(1, 9), extension)
        arguments = ["--frames", "1-8", *of_type]
        shots.apply(*arguments, to=f"out.@@@@.{extension}")
        whole = name(1).read_bytes()
        name(1).write_bytes(whole[:len(whole) * 9 // 10])
        name(2).write_bytes(b"")
        os.utime(name(3), ns=(1, (folder / "in.0003.exr").stat().st_mtime_ns))
        os.utime(name(4), (DATE - 1, DATE - 1))
        small = folder / "small"
        small.mkdir(exist_ok=True)
        make_shot(small, [5], width=47)
        apply(shots.command, "small/in.0005.exr", name(5), *HABLE, folder=folder)
        name(6).unlink()
        before = {n: (name(n).stat().st_ino, name(n).stat().st_mtime_ns) for n in (7, 8)}
        result = shots.apply(*arguments, "--skip-existing", keep=True, to=f"out.@@@@.{extension}")
        what = f"--skip-existing .{extension} {' '.join(of_type)}"
        shots.check(f"{what}: truncated, empty, as old, older, smaller and missing ones are made", result, OK,
                    ["8 frames: 6 written, 2 skipped"], all_of)
        shots.report.check(f"{what}: the others stay", before == {
            n: (name(n).stat().st_ino, name(n).stat().st_mtime_ns) for n in (7, 8)})
        result = shots.apply(*arguments, "--skip-existing", keep=True, to=f"out.@@@@.{extension}")
        shots.check(f"{what}: once more", result, OK, ["8 frames: 0 written, 8 skipped"], all_of)
    # The pixel type is one that a file shows; an operator is not, as --help says.
    result = shots.apply("--frames", "1-8", "--skip-existing", "-d", "uint16", keep=True)
    shots.report.check("--skip-existing, another pixel type", result == (OK, []), result)
    result = shots.apply("--frames", "1-8", "--skip-existing", "-d", "uint16", "--exposure", "3", keep=True)
    shots.report.check("--skip-existing does not know the exposure", "8 skipped" in result[1][0], result)
    result = shots.apply("--frames", "1-8", keep=True)
    shots.check("without it they are made anew", result, OK, [], shots.truths(range(1, 9)))
    name = folder / "out.0002.png"
    name.unlink()
    name.mkdir()
    code, lines = shots.apply("--frames", "1-8", "--skip-existing", keep=True)
    shots.report.check("--skip-existing, a directory", code == FAILED and "out.0002.png: cannot write: is a folder"
                       in lines[0] and "8 frames: 0 written, 7 skipped, 1 failed: 2" in lines[1], lines)
    name.rmdir()
    results = [apply(shots.command, "in.@@@@.exr", "out.@@@@.png", "--operator", "drago", "--frames", "2",
                     "--skip-existing", folder=folder) for _ in range(2)]
    shots.report.check("--skip-existing of an operator with statistics", results[0] == (OK, []) and results[1] == (
        OK, ["tonewright: apply: 1 frame: 0 written, 1 skipped"]), results)


@pytest.mark.share(3)
def test_in_place(shots):
    folder = shots.folder / "place"
    folder.mkdir()
    make_shot(folder, range(1, 9))
    result = apply(shots.command, "in.#.exr", "in.#.exr", *HABLE, "--frames", "1-8", "--in-place", folder=folder)
    shots.report.check("in place", result == (OK, []) and sorted(contents(folder, "in.*").values())
                       == sorted(shots.truths(range(1, 9), "exr").values()), result)


@pytest.mark.share(3)
def test_summary(shots):
    """Many failures: some lines, and frames that --frames takes."""
    folder = shots.folder / "many"
    folder.mkdir()
    make_shot(folder, [1, 3, 4, 120])
    code, lines = apply(shots.command, "in.#.exr", "out.#.png", *HABLE, "--frames", "1-120", folder=folder)
    failed = lines[-1].rpartition(": ")[2]
    shots.report.check("116 failures: 50 lines, how many more, and which", code == FAILED and len(lines) == 52
                       and lines[50] == "tonewright: apply: and 66 more" and failed == "2,5-119"
                       and lines[-1].startswith("tonewright: apply: 120 frames: 4 written, 116 failed: "), lines[49:])
    code, lines = apply(shots.command, "in.#.exr", "out.#.png", *HABLE, "--frames", "5-99x3,-3,200,203,206", folder=folder)
    shots.report.check("steps", lines[-1].endswith(" failed: -3,5-98x3,200-206x3"), lines[-1])
    code, lines = apply(shots.command, "in.#.exr", "out.#.png", *HABLE, "--frames", failed, "--missing", "hold",
                        folder=folder)
    shots.report.check("which --frames takes", code == OK and lines == [
        "tonewright: apply: 116 frames: 116 written, 116 held for missing ones"] and len(contents(folder)) == 120, lines)


@pytest.mark.share(3)
def test_progress(shots):
    """On a terminal frames, rate and time left; the summary; and nothing elsewhere."""
    folder = shots.folder / "progress"
    folder.mkdir()
    make_shot(folder, [1])

    def run_on_terminal(*arguments):
        leader, follower = pty.openpty()
        process = subprocess.Popen([shots.command, "apply", "in.#.exr", "out.#.exr", *HABLE, *arguments], cwd=folder,
                                   stderr=follower)
        os.close(follower)
        shown = b""
        with contextlib.suppress(OSError):  # the other end is closed
            while part := os.read(leader, 4096):
                shown += part
        os.close(leader)
        text = shown.decode()
        return process.wait(), text, [part for part in text.split("\r") if part.startswith("[")]

    # More frames than a second takes, after which the bar appears.
    code, text, bars = run_on_terminal("--frames", "1-600", "--missing", "hold")
    shots.report.check("on a terminal: a bar with frames a second and the time left", code == OK and bars and all(
        "/600 frames, " in bar and " per second, " in bar and " s left" in bar for bar in bars), text[:500])
    shots.report.check("on a terminal: the bar goes away, the summary stays",
                       "\r\033[K" in text and "600 frames: 600 written, 599 held for missing ones" in text.rstrip().splitlines()[-1],
                       text[-300:])
    for number in range(2, 6001):
        (folder / f"in.{number:04d}.exr").hardlink_to(folder / "in.0001.exr")
    code, text, bars = run_on_terminal("--frames", "1-2", "--meter-frames", "1-6000", "--auto-exposure", "mean")
    shots.report.check("on a terminal: the bar counts all frames that are metered",
                       code == OK and bars and all("/6000 metered frames" in bar for bar in bars), text[:500])


def wait_for(process, folder, count):
    """Until there are as many files."""
    while process.poll() is None and len(list(folder.glob("out.*"))) < count:
        time.sleep(0.002)


@pytest.mark.share(3)
def test_vanishing(shots):
    """Inputs go, or are cut short, while a run is under way."""
    for what, spoil, message in (("vanish", Path.unlink, "No such file or directory"),
                                 ("are truncated", lambda path: os.truncate(path, 1000), "cannot read")):
        folder = shots.folder / what.replace(" ", "_")
        folder.mkdir()
        numbers = range(1, 81)
        make_shot(folder, numbers, width=24, height=16)
        apply(shots.command, "in.#.exr", "out.#.exr", *HABLE, "--frames", "1-80", folder=folder)
        truth = contents(folder)
        for path in folder.glob("out.*"):
            path.unlink()
        process = subprocess.Popen([shots.command, "apply", "in.#.exr", "out.#.exr", *HABLE, "--frames", "1-80", "--jobs",
                                    "2"], cwd=folder, stderr=subprocess.PIPE, text=True)
        wait_for(process, folder, 5)
        for number in range(80, 40, -1):
            spoil(folder / f"in.{number:04d}.exr")
        lines = process.communicate()[1].splitlines()
        made = contents(folder)
        shots.report.check(f"inputs {what} in a run: exit 1, a line for each, the others whole",
                           process.returncode == FAILED and 40 <= len(made) < 80
                           and all(truth[name] == made[name] for name in made) and not leftovers(folder)
                           and len(lines) == 81 - len(made) and all(message in line for line in lines[:-1])
                           and f"80 frames: {len(made)} written, {80 - len(made)} failed" in lines[-1],
                           f"exit {process.returncode}, {len(made)} files: {lines[-3:]}")


@pytest.mark.share(3)
def test_stopped(shots):
    folder = shots.folder / "stopped"
    folder.mkdir()
    make_shot(folder, [1])
    for end in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        arguments = ["in.#.exr", "out.#.exr", *HABLE, "--frames", "1-900", "--missing", "hold", "--jobs", "4"]
        process = subprocess.Popen([shots.command, "apply", *arguments], cwd=folder)
        wait_for(process, folder, 20)
        process.send_signal(end)
        made_code = process.wait()
        made = contents(folder)
        shots.report.check(f"{end.name}: whole files and nothing beside them", made_code == -end and 20 <= len(made) < 900
                           and len(set(made.values())) == 1 and not leftovers(folder), f"{made_code} {leftovers(folder)}")
        for path in folder.glob("out.*"):
            path.unlink()


@pytest.mark.share(3)
def test_disks(shots):
    if not shutil.which("mount"):
        skip("full and read-only disks (mount is not installed)")
    with small_disk(shots.folder / "disk", "64k") as disk:
        if disk is None:
            skip("full and read-only disks (mounting a tmpfs needs root)")
        for extension in ("exr", "tif"):
            everything = shots.truths(range(1, 9), extension)
            # Whole pages: room for two frames, and for the beginning of a third.
            pages = -(-len(everything[f"out.0001.{extension}"]) // 4096)
            (disk / "filler").write_bytes(b"x" * (64 * 1024 - 4096 * (2 * pages + 1)))
            arguments = ["in.@@@@.exr", f"disk/out.@@@@.{extension}", *HABLE, "--frames", "1-8", "--jobs", "1"]
            code, lines = apply(shots.command, *arguments, folder=shots.folder)
            made = contents(disk)
            # TIFF is written by libtiff itself, which does not say why; what is written is read back.
            why = "cannot be read back (disk full?)" if extension == "tif" else "No space left on device"
            shots.report.check(f"full disk, .{extension}: exit 1, why, nothing partial",
                               code == FAILED and 0 < len(made) < 8 and all(everything[n] == made[n] for n in made)
                               and not leftovers(disk) and len(lines) == 9 - len(made)
                               and all("cannot write: " in line for line in lines[:-1])
                               and any(why in line for line in lines[:-1])
                               and f"8 frames: {len(made)} written, {8 - len(made)} failed" in lines[-1],
                               f"exit {code}, {len(made)} files, {leftovers(disk)}: {lines}")
            (disk / "filler").unlink()
            subprocess.run(["mount", "-o", "remount,size=4m", disk], check=True)
            code, lines = apply(shots.command, *arguments, "--skip-existing", folder=shots.folder)
            shots.report.check(f"with room, .{extension}: --skip-existing makes the rest", code == OK and lines == [
                f"tonewright: apply: 8 frames: {8 - len(made)} written, {len(made)} skipped"]
                and contents(disk) == everything, lines)
            subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
            for options, code_expected, said in (([], FAILED, "cannot write: Read-only file system"),
                                                 (["--skip-existing"], OK, "8 frames: 0 written, 8 skipped")):
                code, lines = apply(shots.command, *arguments, *options, folder=shots.folder)
                shots.report.check(f"read-only disk, .{extension} {' '.join(options)}", code == code_expected
                                   and said in lines[0] and len(lines) == (1 if options else 9)
                                   and contents(disk) == everything, f"exit {code}: {lines}")
            code, lines = apply(shots.command, "in.@@@@.exr", f"disk/new.@@@@.{extension}", *HABLE, "--frames", "1-3",
                                folder=shots.folder)
            shots.report.check(f"read-only disk, .{extension}, new files", code == FAILED and len(lines) == 4
                               and all("cannot write: " in line for line in lines[:3])
                               and "3 frames: 0 written, 3 failed: 1-3" in lines[3], lines)
            subprocess.run(["mount", "-o", "remount,rw", disk], check=True)
            for path in disk.iterdir():
                path.unlink()
            subprocess.run(["mount", "-o", "remount,size=64k", disk], check=True)


@pytest.mark.share(3)
def test_unwritable(shots):
    """Files and folders that not even root may change, else those of others."""
    folder, locked = shots.folder, shots.folder / "out.0003.png"
    shots.clean()
    locked.write_bytes(b"old")
    is_root = os.geteuid() == 0
    if is_root:
        if subprocess.run(["chattr", "+i", locked], capture_output=True, check=False).returncode:
            skip("unwritable files (chattr +i does not work here)")
    else:
        locked.chmod(0o444)
    try:
        result = shots.apply("--frames", "1-8", keep=True)
        expected = {**shots.truths(range(1, 9)), "out.0003.png": b"old"}
        shots.check("an unwritable file stays, the others are made", result, FAILED,
                    ["out.0003.png: cannot write: " + ("Operation not permitted" if is_root else "Permission denied"),
                     "8 frames: 7 written, 1 failed: 3"], expected)
    finally:
        if is_root:
            subprocess.run(["chattr", "-i", locked], check=True)
        locked.unlink()
    target = folder / "shut"
    target.mkdir()
    if is_root:
        subprocess.run(["chattr", "+i", target], check=True)
    else:
        target.chmod(0o555)
    try:
        code, lines = apply(shots.command, "in.@@@@.exr", "shut/out.@@@@.png", *HABLE, "--frames", "1-3", folder=folder)
        why = "Operation not permitted" if is_root else "Permission denied"
        shots.report.check("an unwritable folder", code == FAILED and len(lines) == 4 and all(
            f"shut/out.000{n}.png: cannot write: {why}" in lines[n - 1] for n in (1, 2, 3)), lines)
    finally:
        if is_root:
            subprocess.run(["chattr", "-i", target], check=True)
    code, lines = apply(shots.command, "in.@@@@.exr", "none/out.@@@@.png", *HABLE, "--frames", "1-3", folder=folder)
    shots.report.check("no folder", code == FAILED and len(lines) == 4 and "No such file or directory" in lines[0], lines)
