# SPDX-License-Identifier: Apache-2.0
"""Folders that are read-only, full devices, and pipes whose writer is slow: exit code 3, one line, no new file, and no wait.

test_sequences.py has full and read-only disks for frames, and inputs that vanish between frames.
"""

import contextlib
import os
import subprocess
import threading

import pytest
from pictures import skip
from shots import CONFIG, make_shot
from shots import small_disk

OK, FILE = 0, 3
RGB = ["--size", "17", "--input", "lin_rec709"]  # of which a LUT of hable has no warning
SECONDS = 60  # a command that waits for the pipe never ends


def run(command, arguments, folder, **streams):
    """(exit code, lines on standard error)"""
    streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, **streams}
    try:
        done = subprocess.run([command, *arguments], cwd=folder, stderr=subprocess.PIPE, text=True, check=False,
                              timeout=SECONDS, env={**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}, **streams)
    except subprocess.TimeoutExpired:
        return "none", ["it did not end"]
    return done.returncode, done.stderr.splitlines()


def check_error(report, what, result, words=""):
    code, lines = result
    report.check(what, code == FILE and len(lines) == 1 and lines[0].startswith("tonewright: ") and words in lines[0],
                 f"exit {code}: {lines}")


@contextlib.contextmanager
def read_only(folder, files):
    """A folder with these files that nobody can write to, not even root; None where root cannot make one."""
    is_root = os.geteuid() == 0
    with small_disk(folder, "1m") if is_root else contextlib.nullcontext(folder) as place:
        if place:
            place.mkdir(exist_ok=True)
            for name, contents in files.items():
                (place / name).write_bytes(contents)
            if is_root:
                subprocess.run(["mount", "-o", "remount,ro", place], check=True)
            else:
                place.chmod(0o555)
        yield place
        if place and not is_root:
            place.chmod(0o755)


@pytest.fixture(scope="module")
def folder(folder):
    """With a picture, and a file of colors."""
    make_shot(folder, [1])
    (folder / "colors").write_text("1 1 1\n")
    return folder


@pytest.fixture(autouse=True)
def no_new_files(folder):
    yield
    new = {path.name for path in folder.iterdir()} - {"in.0001.exr", "colors", "shut", "cache"}
    assert not new, f"no new files: {new}"


def test_read_only(report, command, folder):
    files = {"studio.ocio": CONFIG.encode(), "old.cube": b"old", "old.png": b"old", "old.glsl": b"old"}
    with read_only(folder / "shut", files) as shut:
        if not shut:
            skip("read-only folders (mounting a tmpfs needs root)")
        for arguments in (["apply", "in.0001.exr", "shut/old.png", "--operator", "hable"],
                          ["chart", "-o", "shut/new.exr"],
                          ["compare", "in.0001.exr", "hable", "-o", "shut/old.png"],
                          ["bake", "hable", *RGB, "-o", "shut/old.cube"],
                          ["bake", "hable", *RGB, "-o", "shut/new.cube"],
                          ["bake", "--all", "shut/luts"],
                          ["shader", "hable", "--language", "glsl", "-o", "shut/old.glsl"],
                          ["plot", "hable", "-o", "shut/new.svg"],
                          ["config", "-o", "shut", "--views", "clamp"],
                          ["config", "-o", "shut/new", "--views", "clamp"],
                          ["config", "--archive", "shut/own.ocioz", "--views", "clamp"],
                          ["config", "--into", "shut/studio.ocio", "--views", "clamp"],
                          ["config", "--into", "shut/studio.ocio", "--views", "clamp", "--backup"]):
            why = "Read-only file system" if os.geteuid() == 0 else "Permission denied"
            check_error(report, f"read-only: {' '.join(arguments)}", run(command, arguments, folder), why)
        report.check("read-only: the old files", files == {path.name: path.read_bytes() for path in shut.iterdir()})


def test_full(report, command, folder):
    """Standard output and output files that are full devices."""
    with open("/dev/full", "wb") as full:
        for arguments in (["list"], ["list", "--json"], ["eval", "hable"], ["meter", "in.0001.exr"],
                          ["shader", "hable", "--language", "glsl"], ["--help"]):
            with open(folder / "colors", "rb") as colors:
                check_error(report, f"{' '.join(arguments)} > /dev/full", run(command, arguments, folder, stdin=colors, stdout=full),
                            "standard output")
    for arguments in (["apply", "in.0001.exr", "/dev/full", "--operator", "hable"],
                      ["bake", "hable", "--format", "cube", "-o", "/dev/full"],
                      ["shader", "hable", "--language", "glsl", "-o", "/dev/full"]):
        check_error(report, " ".join(arguments), run(command, arguments, folder), "no regular file")


@contextlib.contextmanager
def slow_pipe(path, contents, pause):
    """A pipe whose writer takes a pause after each byte, until nobody reads it."""
    os.mkfifo(path)
    is_done = threading.Event()

    def write():
        with contextlib.suppress(BrokenPipeError), open(path, "wb", buffering=0) as pipe:
            for byte in contents:
                pipe.write(bytes([byte]))
                if is_done.wait(pause):
                    return

    writer = threading.Thread(target=write)
    writer.start()
    yield
    is_done.set()
    with contextlib.suppress(OSError):  # a writer that still waits for a reader
        os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))
    writer.join()
    path.unlink()


def test_slow_pipes(report, command, folder):
    for name, arguments in (("in.exr", ["apply", "in.exr", "out.png", "--operator", "hable"]), ("in.exr", ["meter", "in.exr"]),
                            ("list", ["apply", "@list", "-o", "new", "--operator", "hable"]),
                            ("in.cube", ["eval", "--lut", "in.cube"]), ("in.tone", ["eval", "in.tone"]),
                            ("in.glsl", ["import", "in.glsl", "-o", "out.tone"]),
                            ("in.ocio", ["config", "--into", "in.ocio", "--views", "clamp"])):
        with slow_pipe(folder / name, b"a pipe without an end" * 1000, 1):
            check_error(report, f"a slow pipe: {' '.join(arguments)}", run(command, arguments, folder), "no regular file")
    with slow_pipe(folder / "pipe", b"1 1 1\n3 3 3", 0.03), open(folder / "pipe", "rb") as pipe:
        done = subprocess.run([command, "eval", "reinhard", "--display", "native"], stdin=pipe, capture_output=True, check=False,
                              timeout=SECONDS)
        report.check("eval: a slow pipe as standard input", done.returncode == OK
                     and done.stdout == b"0.5 0.5 0.5\n0.75 0.75 0.75\n" and not done.stderr, done)
