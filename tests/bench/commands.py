# SPDX-License-Identifier: Apache-2.0
"""Whole commands beside oiiotool, ffmpeg and vips, which do the same where they can. All programs of a row take turns, so that
a busy machine slows them alike; figures are medians."""

import os
import resource
import shlex
import shutil
import statistics
import subprocess
import sys
import time

WIDTH, HEIGHT = 3840, 2160
OPERATOR = "agx_blender"
# name, extension, oiiotool's and our output type, compression of the EXR file that is read, and of one that is written
JOBS = [
    ("16-bit PNG", "png", "uint16", "zip", None),
    ("8-bit PNG", "png", "uint8", "zip", None),
    ("half EXR, ZIP", "exr", "half", "zip", "zip"),
    ("half EXR, ZIPS, from ZIPS", "exr", "half", "zips", "zips"),
    ("half EXR, PIZ, from PIZ", "exr", "half", "piz", "piz"),
    ("half EXR, DWAA, from DWAA", "exr", "half", "dwaa", "dwaa"),
    ("half EXR, uncompressed, from uncompressed", "exr", "half", "none", "none"),
    ("JPEG", "jpg", "uint8", "zip", None),
]
COLUMNS = {"copy": "oiiotool, copy", "view": "oiiotool, view", "ffmpeg": "ffmpeg", "vips": "vips", "before": "before"}


def call(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"bench: {shlex.join(map(str, arguments))}: exit {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def run_once(arguments):
    """(wall seconds, processor seconds, peak memory in MB)"""
    begin = time.perf_counter()
    child = subprocess.Popen([str(a) for a in arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    errors = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - begin
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        sys.exit(f"bench: {shlex.join(map(str, arguments))}: exit {child.returncode}: {errors.decode().strip()}")
    return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000


def take_turns(lines, runs):
    """{name: {wall, processor, memory}}: medians; all lines run once before they count."""
    taken = {name: [] for name in lines}
    for turn in range(runs + 1):
        for name, line in lines.items():
            figures = run_once(line)
            if turn:
                taken[name].append(figures)
    return {name: dict(zip(("wall", "processor", "memory"), map(statistics.median, zip(*all_of))))
            for name, all_of in taken.items()}


def resized(picture, width, height, compression, path):
    call("oiiotool", picture, "--ch", "R,G,B", "--resize", f"{width}x{height}", "-d", "half", "--compression", compression,
         "-o", path)
    return path


class Bench:
    def __init__(self, command, before, picture, runs, scratch):
        self.command, self.before, self.runs, self.scratch = command, before, runs, scratch
        self.picture = picture
        views = dict(line.split("\t") for line in call(command, "list", "--views").splitlines())
        self.config, self.view = scratch / "config", views[OPERATOR]
        call(command, "config", "-o", self.config, "--views", OPERATOR)

    def apply(self, program, source, out, depth, compression=None, more=()):
        return [program, "apply", source, out, "--operator", OPERATOR, "-d", depth,
                *(["--compression", compression] if compression else []), *more]

    def oiiotool(self, source, out, depth, compression, with_view):
        view = ["--ociodisplay", "sRGB", self.view] if with_view else []
        return ["oiiotool", *(["--colorconfig", self.config / "config.ocio"] if view else []), source, *view, "-d", depth,
                *(["--compression", compression] if compression else []), "-o", out]

    def pictures(self):
        rows = []
        cube, log = self.scratch / "lut.cube", self.scratch / "log.exr"
        call(self.command, "bake", OPERATOR, "-o", cube, "--3d", "--size", 65, "--input-encoding", "acescct")
        for title, extension, depth, read, written in JOBS:
            source = self.scratch / f"in_{read}.exr"
            if not source.exists():
                resized(self.picture, WIDTH, HEIGHT, read, source)
            out = {name: self.scratch / f"{name}.{extension}" for name in ("apply", *COLUMNS)}
            lines = {"apply": self.apply(self.command, source, out["apply"], depth, written),
                     "copy": self.oiiotool(source, out["copy"], depth, written, False),
                     "view": self.oiiotool(source, out["view"], depth, written, True)}
            if self.before:
                lines["before"] = self.apply(self.before, source, out["before"], depth, written)
            if extension == "png" and shutil.which("ffmpeg"):
                if not log.exists():  # ffmpeg is given the encoding of the LUT
                    call("oiiotool", "--colorconfig", self.config / "config.ocio", source, "--colorconvert", "lin_rec709", "ACEScct",
                         "-d", "half", "-o", log)
                lines["ffmpeg"] = ["ffmpeg", "-v", "error", "-nostdin", "-y", "-i", log, "-vf",
                                   f"lut3d={cube}:interp=tetrahedral", "-pix_fmt", "rgb48be" if depth == "uint16" else "rgb24",
                                   out["ffmpeg"]]
            # It writes no EXR, and takes 1.0 for one code of 255.
            if extension != "exr" and depth == "uint8" and shutil.which("vips"):
                lines["vips"] = ["vips", "linear", source, out["vips"], "255", "0", "--uchar"]
            row = take_turns(lines, self.runs)
            for name in lines:
                row[name]["bytes"] = out[name].stat().st_size
            rows.append({"title": title, **row})
        return rows

    def frames(self, count=200):
        """A shot to 8-bit PNG by one command; oiiotool has --frames, too."""
        first = resized(self.picture, 1920, 1080, "zip", self.scratch / "shot.1001.exr")
        for i in range(1002, 1001 + count):
            shutil.copy(first, self.scratch / f"shot.{i}.exr")
        frames = f"1001-{1000 + count}"
        lines = {"apply": self.apply(self.command, self.scratch / "shot.####.exr", self.scratch / "out.####.png", "uint8",
                                     more=["--frames", frames]),
                 "view": ["oiiotool", "--frames", frames, *self.oiiotool(self.scratch / "shot.#.exr", self.scratch / "view.#.png",
                                                                         "uint8", None, True)[1:]]}
        if self.before:
            lines["before"] = self.apply(self.before, self.scratch / "shot.####.exr", self.scratch / "before.####.png", "uint8",
                                         more=["--frames", frames])
        return {"count": count, **take_turns(lines, max(self.runs // 3, 1))}

    def start(self):
        source, out = resized(self.picture, 16, 16, "zip", self.scratch / "small.exr"), self.scratch / "small.png"
        lines = {"apply": self.apply(self.command, source, out, "uint8"), "copy": ["oiiotool", source, "-d", "uint8", "-o", out],
                 "list": [self.command, "list", "hable"]}
        if self.before:
            lines["before"] = self.apply(self.before, source, out, "uint8")
        return take_turns(lines, 3 * self.runs)

    def memory(self):
        source = resized(self.picture, 8000, 6000, "zip", self.scratch / "large.exr")
        figures = {}
        for title, out, depth in (("16-bit PNG", "large.png", "uint16"), ("half EXR", "large_out.exr", "half")):
            lines = {"apply": self.apply(self.command, source, self.scratch / out, depth),
                     "copy": self.oiiotool(source, self.scratch / out, depth, None, False)}
            figures[title] = {name: run_once(line)[2] for name, line in lines.items()}
        return figures


def table(title, header, rows):
    print(f"\n{title}\n\n| {' | '.join(header)} |\n|{'---|' * len(header)}")
    for row in rows:
        print(f"| {' | '.join(row)} |")


def ratio(a, b):
    return f"{a / b:.2f}"


def print_figures(results):
    def shares(row, figure):
        return [ratio(row["apply"][figure], row[name][figure]) if name in row else "-" for name in COLUMNS]

    title = (f"`apply` of {WIDTH}x{HEIGHT}, half EXR in (ZIP unless said), divided by other programs: {{}}. `view`: the same view by "
             "--ociodisplay; `copy`: only reads and writes; ffmpeg: a 65^3 LUT on the picture in ACEScct; vips: only scales.")
    for figure, what, unit in (("wall", "wall time", "s"), ("processor", "processor time", "s"), ("bytes", "size of the file", "MB")):
        scale = 1e6 if figure == "bytes" else 1
        table(title.format(what), ["to", f"apply, {unit}", *COLUMNS.values()],
              [[row["title"], f"{row['apply'][figure] / scale:.2f}", *shares(row, figure)] for row in results["pictures"]])
    frames = results["frames"]
    table(f"{frames['count']} frames of 1920x1080 to 8-bit PNG, one command: seconds a frame",
          ["program", "wall", "processor", "peak memory, MB"],
          [[name, *(f"{frames[name][f] / frames['count']:.3f}" for f in ("wall", "processor")), f"{frames[name]['memory']:.0f}"]
           for name in frames if name != "count"])
    table("Start: 16x16 EXR to 8-bit PNG, and `list hable`", ["program", "wall, ms", "processor, ms", "peak memory, MB"],
          [[name, *(f"{1000 * of[f]:.0f}" for f in ("wall", "processor")), f"{of['memory']:.0f}"]
           for name, of in results["start"].items()])
    table("Peak memory of 8000x6000, MB", ["to", "apply", "oiiotool, copy"],
          [[title, *(f"{of[name]:.0f}" for name in ("apply", "copy"))] for title, of in results["memory"].items()])


def run(command, before, picture, runs, scratch):
    # A child's peak memory counts its parent's pages until it executes its program.
    if resource.getrusage(resource.RUSAGE_SELF).ru_maxrss > 60000:
        print("bench: this process is large; peak memory may be its own", file=sys.stderr)
    bench = Bench(command, before, picture, runs, scratch)
    results = {"start": bench.start(), "pictures": bench.pictures(), "frames": bench.frames(), "memory": bench.memory()}
    print_figures(results)
    return results
