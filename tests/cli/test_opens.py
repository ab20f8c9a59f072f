# SPDX-License-Identifier: Apache-2.0
"""How often commands open their files, by strace: the file of an operator, a LUT and a config once, a picture at most
twice. The numbers that it keeps. And a shot whose operator's file disappears while its frames are tone mapped.

A picture is opened twice where its pixels decide how it is tone mapped: they are measured first, and read again, so that
memory does not grow with the picture. With --lut, the file's first lines are read for the input that it states, and
OpenColorIO opens the file for the table. Opening one picture makes several system calls in OpenImageIO, which
`tonewright info` counts.
"""

import os
import re
import subprocess
import sys
import time

import numpy as np
import pytest
from pictures import ALL, need_program, run, skip, write_exr
from sanitizers import is_sanitized

pytestmark = pytest.mark.share(3)

# KiB that a program has at most, of a process that has run no other.
MEMORY = """import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"""
OPENED = re.compile(r'open(?:at)?\([^"]*"(?:[^"]*/)?([^"/]+)", [^)]*\) = \d+')


@pytest.fixture(scope="module")
def folder(command, folder):
    """With a picture, a shot of it, a .tone file and a LUT."""
    run(command, "chart", "-o", folder / "scene.hdr", "--width", "640", "--height", "360", "-q")
    (folder / "mine.tone").write_text(run(command, "list", "hable", "--definition").replace('id = "hable"', 'id = "mine"')
                                      .replace('view = "Hable"', 'view = "Mine"').replace("Hable (Uncharted 2)", "Mine"))
    run(command, "bake", "hable", "--format", "cube", "--size", "17", "-o", folder / "film.cube", "-q")
    for number in range(1, 7):
        (folder / f"frame.{number:04d}.hdr").hardlink_to(folder / "scene.hdr")
    return folder


@pytest.fixture
def c(report, command, folder):
    need_program("strace", "strace")
    if subprocess.run(["strace", "-o", os.devnull, "true"], capture_output=True, check=False).returncode:
        skip("this machine does not allow strace to trace processes")
    return Opens(report, command, folder)


class Opens:
    def __init__(self, report, command, folder):
        self.report, self.command, self.folder = report, command, folder

    def count(self, arguments, stdin=b""):
        """(file name -> successful opens, exit code)"""
        log = self.folder / "strace.log"
        done = subprocess.run(["strace", "-f", "-e", "trace=open,openat", "-o", log, self.command, *arguments],
                              cwd=self.folder, input=stdin, capture_output=True, check=False)
        counts = {}
        for line in log.read_text(errors="replace").splitlines():
            if match := OPENED.search(line):
                counts[match[1]] = counts.get(match[1], 0) + ("O_DIRECTORY" not in line and "O_WRONLY" not in line)
        return counts, done

    def bytes_read(self, name, out):
        """By `apply`, of the picture."""
        log = self.folder / "strace.log"
        run("strace", "-f", "-y", "-e", "trace=read,pread64,readv,preadv", "-s", "0", "-o", log, self.command, "apply", name, out, "-q",
            folder=self.folder)
        total, unfinished = 0, set()  # of threads that wait for bytes of the picture
        for line in log.read_text(errors="replace").splitlines():
            thread = line.split()[0]
            of_picture = f"/{name}>" in line or (" resumed>" in line and thread in unfinished)
            if of_picture and line.endswith("<unfinished ...>"):
                unfinished.add(thread)
            elif of_picture:
                unfinished.discard(thread)
                total += int(line.rsplit(" = ", 1)[1])
        return total

    def memory(self, name, out):
        """The most that `apply` has, in bytes."""
        return 1024 * int(run(sys.executable, "-c", MEMORY, self.command, "apply", name, out, "-q", folder=self.folder))

    def check(self, text, wanted, stdin=b""):
        """wanted: file name -> most opens, at least one"""
        counts, done = self.count(text.split(), stdin)
        self.report.check(f"{text}: exit code", done.returncode in (0, 1), done.stderr.decode(errors="replace"))
        for name, most in wanted.items():
            found = counts.get(name, 0)
            self.report.check(f"{text}: opens {name}", 1 <= found <= most, f"{found} times; expected 1 to {most}")


def test_operators(c):
    color = b"0.18 0.18 0.18\n"
    for name in ("mine.tone", "film.cube"):
        c.check(f"eval {name}", {name: 1}, color)
        c.check(f"plot {name} -o out.svg", {name: 1})
        c.check(f"config --operator {name} --name Mine --views none --profile 2.1 --displays srgb -o config", {name: 1})
        c.check(f"apply scene.hdr out.png --operator {name}", {name: 1})
        c.check(f"compare scene.hdr {name} hable -o out.png", {name: 1})
    c.check("shader mine.tone --language glsl -o out.glsl", {"mine.tone": 1})
    c.check("verify mine.tone --quick --no-gpu --shaders none", {"mine.tone": 1})
    c.check("bake film.cube --for unity_urp -o out.png", {"film.cube": 1})
    if ALL:  # seconds of fits and of measuring
        c.check("bake mine.tone --for mpv --exact", {"mine.tone": 1})
    c.check("check mine.tone", {"mine.tone": 1})
    c.check("list mine.tone", {"mine.tone": 1})
    c.check("apply frame.####.hdr out.####.png --frames 1-6 --operator mine.tone", {"mine.tone": 1})
    c.check("apply frame.####.hdr out.####.png --frames 1-6 --operator mine.tone --auto-exposure mean", {"mine.tone": 1})
    c.check("verify --lut film.cube", {"film.cube": 1})
    c.check("eval --lut film.cube", {"film.cube": 2}, color)
    c.check("apply scene.hdr out.png --lut film.cube", {"film.cube": 2})


def test_configs(c):
    run(c.command, "config", "-o", c.folder / "own", "--views", "hable", "--profile", "2.1", "-q")
    c.check("verify --config own/config.ocio hable --no-gpu --quick --shaders none", {"config.ocio": 1})


def test_pictures(c):
    once = c.count(["info", "scene.hdr"])[0].get("scene.hdr", 0)
    c.report.check("info opens the picture", once > 0, f"{once} times")

    def looks(text):
        """Without OpenImageIO, `apply` looks first whether it is an OpenEXR file."""
        return text.startswith("apply")

    for text in ("apply scene.hdr out.png", "apply scene.hdr out.png --verbose", "apply scene.hdr out.exr --operator local_laplacian",
                 "compare scene.hdr hable -o out.png"):
        c.check(text, {"scene.hdr": once + looks(text)})
    for text in ("apply scene.hdr out.png --operator drago", "apply scene.hdr out.png --auto-exposure mean --verbose",
                 "meter scene.hdr"):
        c.check(text, {"scene.hdr": 2 * once + looks(text)})


def test_cache(c):
    """The second run reads the numbers of the first. A relative XDG_CACHE_HOME is ignored."""
    def kept_by(**variables):
        environment = {name: value for name, value in os.environ.items() if name not in ("HOME", "XDG_CACHE_HOME")}
        subprocess.run([c.command, "shader", "hable", "--language", "glsl", "-o", "out.glsl", "-q"], cwd=c.folder, check=True,
                       env={**environment, **variables})
        return {str(path.relative_to(c.folder)): path.stat().st_ino for path in c.folder.rglob("*.numbers")}  # new if written again

    c.report.check("cache: without a home, nothing is kept", not kept_by() and not kept_by(XDG_CACHE_HOME="relative"))
    for folder, variables in (("home/.cache", {"HOME": str(c.folder / "home"), "XDG_CACHE_HOME": "relative"}),
                              ("cache", {"HOME": str(c.folder / "home"), "XDG_CACHE_HOME": str(c.folder / "cache")})):
        before = kept_by()
        first, second = kept_by(**variables), kept_by(**variables)
        new = first.keys() - before
        c.report.check(f"cache: one new file in {folder}", len(new) == 1 and next(iter(new)).startswith(folder + "/tonewright/"),
                       first)
        c.report.check(f"cache: the second run uses that of {folder}", second == first, f"{first} {second}")


def test_libraries(c):
    """OpenEXR to PNG, JPEG and OpenEXR loads none of OpenImageIO's libraries, and little memory."""
    write_exr(c.folder / "small.exr", {name: np.full((16, 16), 0.18, np.float32) for name in "RGB"})
    compressions = ("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab")
    runs = [(["small.exr", out], needs)
            for out, needs in (("out.png", False), ("out.jpg", False), ("out.exr", False), ("out.tif", True))]
    for compression in compressions:
        runs += [(["small.exr", f"{compression}.exr", "--compression", compression], False),
                 ([f"{compression}.exr", "out.png", "--input", "sRGB"], False)]
    for arguments, needs in runs:
        out = " ".join(arguments[1:])
        counts, done = c.count(["apply", *arguments, "-q"])
        found = [name for name in counts if name.startswith("libOpenImageIO")]
        c.report.check(f"{arguments[0]} to {out}: exit code", done.returncode == 0, done.stderr.decode(errors="replace"))
        c.report.check(f"{arguments[0]} to {out}: {'needs' if needs else 'does without'} OpenImageIO", bool(found) == needs,
                       found)
        # Its pixels, and its color profile.
        c.report.check(f"{arguments[0]} to {out}: opens it twice at most", needs or 1 <= counts.get(arguments[0], 0) <= 2,
                       counts.get(arguments[0]))
    if not is_sanitized(c.command):
        # The limit is 60 MB; oiiotool takes 136 MB for this.
        c.report.check("small.exr to out.png: memory", c.memory("small.exr", "out.png") < 60e6)


@pytest.mark.parametrize("compression", ["zip", "piz", "dwaa", "none"])
def test_bytes(c, compression):
    """The bytes of a picture are read once."""
    name = f"noise_{compression}.exr"
    run("oiiotool", "--pattern", "noise:type=uniform:min=0:max=4", "1200x900", "3", "-d", "half", "--compression", compression, "-o",
        c.folder / name)
    size = (c.folder / name).stat().st_size
    for out in ("out.png", "out.exr"):
        read = c.bytes_read(name, out)
        # The header and the table of blocks are read more than once, in pieces of 4 KiB.
        c.report.check(f"{name} to {out}: reads {read} of {size} bytes", 0.99 * size < read < 1.01 * size + 200_000)


@pytest.mark.parametrize("compression", ["zip", "piz", "dwaa", "none"] if ALL else ["zip"])
def test_memory(c, compression):
    """Memory does not grow with the picture, whose pixels are 288 MB here."""
    if is_sanitized(c.command):
        return
    name = f"wide_{compression}.exr"
    run("oiiotool", "--pattern", "fill:topleft=0,1,4:bottomright=2,1,0.1", "8000x6000", "3", "-d", "half", "--compression",
        compression, "-o", c.folder / name)
    for out in ("out.png", "out.exr"):
        # The limit for ZIP is 120 MB; blocks of PIZ and DWAA have twice as many rows.
        memory = c.memory(name, out)
        c.report.check(f"{name} to {out}: {memory / 1e6:.0f} MB of memory", memory < (120e6 if compression == "zip" else 150e6))


def test_two_modules(c):
    """A picture that needs OpenImageIO after all: nothing is said twice, and both modules count threads alike."""
    write_exr(c.folder / "up.exr", {name: np.full((16, 16), 0.18, np.float32) for name in "RGB"})
    run("oiiotool", c.folder / "up.exr", "--attrib", "Orientation", "6", "-o", c.folder / "turned.exr")
    run("oiiotool", c.folder / "up.exr", "-o", c.folder / "up.tif")
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_THREADS")}
    for name in ("up.exr", "turned.exr", "up.tif"):
        for threads in ({}, {"CUE_THREADS": "1"}, {"OPENIMAGEIO_THREADS": "3", "CUE_THREADS": "1"}):
            done = subprocess.run([c.command, "apply", name, "out.png", "--operator", "AgX", "-v"], cwd=c.folder,
                                  env=environment | threads, capture_output=True, text=True, check=False)
            c.report.check(f"{name}, {threads}: the note on the name is said once", done.stderr.count("AgX is Blender's here") == 1,
                           done.stderr)
            wanted = {0: os.cpu_count(), 1: 1, 2: 3}[len(threads)]
            c.report.check(f"{name}, {threads}: {wanted} threads", f" {wanted} threads" in done.stderr, done.stderr)


def test_shots(c):
    """Every frame is that of the file at the start, also after it was replaced, half saved or deleted."""
    count = 30
    for number in range(1, count + 1):
        link = c.folder / f"shot.{number:04d}.hdr"
        if not link.exists():
            link.hardlink_to(c.folder / "scene.hdr")
    wanted = c.folder / "wanted.png"
    run(c.command, "apply", c.folder / "scene.hdr", wanted, "--operator", c.folder / "mine.tone", "-q", "--no-metadata")
    text = (c.folder / "mine.tone").read_text()
    changes = {"deleted": lambda path: path.unlink(), "half saved": lambda path: path.write_text(text[:100]),
               "replaced": lambda path: path.write_text(run(c.command, "list", "reinhard", "--definition"))}
    for how, change in changes.items():
        path = c.folder / "shot.tone"
        path.write_text(text)
        for old in c.folder.glob("graded.*.png"):
            old.unlink()
        job = subprocess.Popen([c.command, "apply", "shot.####.hdr", "graded.####.png", "--frames", f"1-{count}", "--operator",
                                "shot.tone", "--jobs", "1", "--no-metadata"], cwd=c.folder, stderr=subprocess.PIPE)
        while not (c.folder / "graded.0001.png").exists() and job.poll() is None:
            time.sleep(0.001)
        change(path)
        in_time = not (c.folder / f"graded.{count:04d}.png").exists()
        said = job.communicate()[1].decode(errors="replace")
        frames = [c.folder / f"graded.{number:04d}.png" for number in range(1, count + 1)]
        c.report.check(f"operator's file {how} in a shot: before the last frame", in_time)
        c.report.check(f"operator's file {how} in a shot: exit code", job.returncode == 0, said)
        pictures = {frame.read_bytes() if frame.exists() else b"" for frame in frames}
        c.report.check(f"operator's file {how} in a shot: all frames are the same picture", len(pictures) == 1 and b"" not in pictures)
        c.report.check(f"operator's file {how} in a shot: the picture of the file at the start",
                       wanted.read_bytes() in pictures)
