# SPDX-License-Identifier: Apache-2.0
"""A page of docs/ as a reader follows it: all commands in their order, what they print, and the pictures that they write.

Fences of a page say what their text is:

    sh            commands, which must succeed
    sh NAME       commands that are skipped where NAME is missing
    output        what the commands above print, errors and warnings included
    (nothing)     text that is not run

In an output, `...` stands for any text, or as a line of its own for any lines.

    /usr/bin/python3 tests/cli/docs_commands.py build/release/bin/tonewright PAGE...

writes the pictures of pages; `./run artifacts` does. A command without a build beside it is an installed one.
"""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "parity"), str(TESTS / "parity" / "clients")]
from pictures import PROJECT, Report, read_rgb  # noqa: E402
from test_artifacts import FIGURE_ABSOLUTE, FIGURE_RELATIVE, LINE, NUMBER, figures_differ  # noqa: E402

DOCS = PROJECT / "docs"
# Two roundings to 8 bits of values that differ by float32 may be neighbors.
ONE_CODE = 1.01 / 255
# Another version of libjpeg may write other bits: one code on average. x265 and x264 choose other blocks with another
# number of threads: two codes, measured with one thread and two. Another curve moves most grays by more.
JPEG_MEAN = 3 / 255


def blocks(page):
    """(words after the fence, the text) of each block of code."""
    return re.findall(r"^```([^`\n]*)\n(.*?)^```$", page, re.S | re.M)


def output_differs(output, expected):
    """None, or what differs. Whole numbers are counts and names; others are measured and may differ by a tenth."""
    def pattern(text):
        words = NUMBER.split(text)
        return r"([-+.\de]+)".join(re.escape(word) for word in words)

    lines = [r"(?:.*\n)*" if line == "..." else ".*".join(map(pattern, line.split("..."))) + "\n"
             for line in expected.splitlines()]
    found = re.fullmatch("".join(lines), output)
    if not found:
        return f"printed:\n{output}expected:\n{expected}"
    for is_, number in zip(found.groups(), NUMBER.findall(expected)):
        tolerance = 0 if number.lstrip("+-").isdigit() else FIGURE_RELATIVE * abs(float(number)) + FIGURE_ABSOLUTE
        if not NUMBER.fullmatch(is_) or abs(float(is_) - float(number)) > tolerance:
            return f"{is_}, expected {number}"
    return None


def installed(build, folder):
    """pkg-config finds the build's libraries as it would find installed ones."""
    library = folder / "lib"
    (library / "pkgconfig").mkdir(parents=True)
    for path in (build / "lib").glob("libtonewright_*"):
        (library / path.name).symlink_to(path)
    for path in (build / "src").glob("*.pc"):
        shutil.copy(path, library / "pkgconfig")
    (folder / "include").symlink_to(PROJECT / "src" / "include")
    return library


def says(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout


def missing(name, build):
    """None, or why commands that need NAME cannot run. Without a build, packages have the module and the libraries."""
    if name == "python" and not build:
        return None if importlib.util.find_spec("tonewright") else "python3-tonewright is not installed"
    if name == "python":
        return None if (build / "python" / "tonewright").is_dir() else "the build has no Python module"
    if name == "photographs":
        return None if os.environ.get("TONEWRIGHT_SHARED") else "TONEWRIGHT_SHARED is not set"
    if not shutil.which(name):
        return f"{name} is not installed; `./run packages --all`"
    if name == "ffmpeg" and ("libx265" not in says(name, "-v", "error", "-encoders")
                             or "zscale" not in says(name, "-v", "error", "-filters")):
        return "ffmpeg has no libx265 or no zscale"
    if name == "g++" and not build:
        return None if says("pkg-config", "--libs", "tonewright-core") else "libtonewright-dev is not installed"
    if name == "g++" and ("-fsanitize" in (build / "CMakeCache.txt").read_text() or not shutil.which("pkg-config")
                          or not (build / "lib" / "libtonewright_core.so").exists()):
        return "needs pkg-config and shared libraries without sanitizers"
    return None


def follow(report, page, command, folder):
    """Returns (commands, what they print) of each block that ran, and the names that are missing."""
    build = command.parents[1] if (command.parents[1] / "CMakeCache.txt").exists() else None
    for name in ("src", "tests"):  # pages for developers show files
        (folder / name).symlink_to(PROJECT / name)
    environment = {**os.environ, "LC_ALL": "C.UTF-8", "EXAMPLES": str(DOCS / "examples"),
                   "PHOTOGRAPHS": f"{os.environ.get('TONEWRIGHT_SHARED')}/data/hdr",
                   "PATH": f"{command.parent}:{Path(sys.executable).parent}:{os.environ['PATH']}"}
    if build:
        library = installed(build, folder / ".installed")
        environment |= {"PYTHONPATH": str(build / "python"), "PKG_CONFIG_PATH": str(library / "pkgconfig"),
                        "LD_LIBRARY_PATH": str(library)}
    said, lacking, ran = [], set(), None
    for kind, text in blocks(page):
        name = kind[3:] if kind.startswith("sh ") else None
        if kind == "sh" or name:
            ran = None
            reason = name and missing(name, build)
            if reason:
                print(f"skipped: {text.splitlines()[0]} ({reason})")
                lacking.add(name)
                continue
            done = subprocess.run(["sh", "-ec", text], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            ran = text, done.stdout
            report.check(text.splitlines()[-1], done.returncode == 0, ran[1])
            said.append(ran)
        elif kind == "output" and ran:
            differs = output_differs(ran[1], text)
            report.check("  prints what the page says", differs is None, differs)
    return said, lacking


def check_picture(report, shown, written, folder):
    name = f"{shown.parent.name}/{shown.name}"
    if shown.suffix == ".svg":
        differs = figures_differ(shown.read_text(), written.read_text(), 0, LINE)
        report.check(f"images/{name} is what the page's commands write", differs is None, differs)
        return
    old, new = (read_rgb(path, folder).astype(float) for path in (shown, written))
    if shown.suffix == ".png":
        report.compare(f"images/{name} is what the page's commands write", old, new, ONE_CODE)
    elif report.check(f"images/{name} has the size of what the page's commands write", old.shape == new.shape,
                      f"{old.shape}, expected {new.shape}"):
        report.bound(f"images/{name} shows the same", np.abs(old - new).mean(), JPEG_MEAN)


def is_same(shown, written, folder):
    """Pictures with equal pixels may state different times."""
    return shown.exists() and shown.suffix != ".svg" and np.array_equal(*(read_rgb(path, folder) for path in (shown, written)))


def check_page(report, name, command, folder, check=None, is_recording=False):
    """Follows docs/NAME.md in a folder; check(report, page, folder, said) tests what only this page has."""
    page = (DOCS / f"{name}.md").read_text()
    said, lacking = follow(report, page, command.resolve(), folder)
    if report.failed:
        return
    for path in re.findall(r"!\[.*?\]\((images/.*?)\)", page):
        written = next(folder.rglob(Path(path).name), None)
        if written and is_recording:
            if not is_same(DOCS / path, written, folder):
                (DOCS / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(written, DOCS / path)
        elif written:
            check_picture(report, DOCS / path, written, folder)
        else:
            report.check(f"the commands write {path}", lacking)
    if check and not is_recording:
        check(report, page, folder, said)


def main(command, *pages):
    report = Report()
    for name in pages:
        with tempfile.TemporaryDirectory() as scratch:
            check_page(report, name, Path(command), Path(scratch), is_recording=True)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 2 else __doc__)
