# SPDX-License-Identifier: Apache-2.0
"""docs/own_operators.md as a reader follows it: all commands in their order, what they print, and the pictures of the page.

    python3 tests/cli/test_own_operators.py build/release/bin/tonewright [--record]

--record writes the pictures of the page; `./run artifacts` does. The last line is `N passed, M failed`.
"""

import argparse
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
from pictures import PROJECT, Report, read_rgb, run  # noqa: E402
from test_artifacts import LINE, figures_differ  # noqa: E402

DOCS = PROJECT / "docs"
SHOWN = DOCS / "images" / "own"
# Two roundings to 8 bits of values that differ by float32 may be neighbors.
ONE_CODE = 1.01 / 255
# Another version of libjpeg may write other bits: one code on average. Another curve moves most grays by more.
JPEG_MEAN = 1 / 255


def blocks(page):
    """(words behind the fence, the text) of each block of code."""
    return re.findall(r"^```([a-z ]*)\n(.*?)^```$", page, re.S | re.M)


def follow(report, command, folder, page):
    environment = {**os.environ, "PATH": f"{command.parent}:{os.environ['PATH']}", "LC_ALL": "C.UTF-8",
                   "EXAMPLES": str(DOCS / "examples")}
    has_blender = bool(shutil.which("blender"))
    said = []
    for kind, text in blocks(page):
        if kind == "sh blender" and not has_blender:
            print("skipped: the view in Blender (blender is not installed; `./run packages --applications`)")
            continue
        if kind.startswith("sh"):
            done = subprocess.run(["sh", "-ec", text], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, check=False)
            output = done.stdout + done.stderr
            report.check(text.splitlines()[-1], done.returncode == 0, output)
            said.append(output)
    return has_blender, said


def soft(x, k=0.55):
    """OpenColorIO issue 2320."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(x > 0, x / (x + np.maximum(x, 0)**k), 0)


def check_numbers(report, folder, said):
    printed = [text for text in said if re.fullmatch(r"[\d. ]+\n", text.split("\n")[0] + "\n")]
    # eval prints nine digits of sRGB code values (IEC 61966-2-1).
    code = 1.055 * soft(np.array(0.18)) ** (1 / 2.4) - 0.055
    numbers = [float(number) for number in printed[0].split()[:3]] if printed else [np.nan]
    report.bound("eval prints the curve at mid gray", max(abs(number - code) for number in numbers), 1e-9)
    light = np.maximum(read_rgb(folder / "render.exr", folder).astype(float), 0)
    shown = soft(light, 0.7)
    srgb = np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * np.maximum(shown, 0.0031308)**(1 / 2.4) - 0.055)
    report.compare("softer.png is the formula with k = 0.7", read_rgb(folder / "softer.png", folder), srgb, ONE_CODE)


def check_pictures(report, folder, has_blender):
    differs = figures_differ((SHOWN / "curve.svg").read_text(), (folder / "curve.svg").read_text(), 0, LINE)
    report.check("images/own/curve.svg is what the page's command writes", differs is None, differs)
    old, new = (read_rgb(path / "compare.jpg", folder).astype(float) for path in (SHOWN, folder))
    if report.check("images/own/compare.jpg has the size of what the page's command writes", old.shape == new.shape,
                    f"{old.shape}, expected {new.shape}"):
        report.bound("images/own/compare.jpg shows the same", np.abs(old - new).mean(), JPEG_MEAN)
    if has_blender:
        saved = read_rgb(folder / "blender.png", folder)
        report.compare("Blender shows what apply writes", saved, read_rgb(folder / "apply.png", folder), ONE_CODE)
        report.compare("images/own/blender.png is what Blender saves", read_rgb(SHOWN / "blender.png", folder), saved, ONE_CODE)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("command", type=Path)
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    report = Report()
    page = (DOCS / "own_operators.md").read_text()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        has_blender, said = follow(report, arguments.command.resolve(), folder, page)
        if report.failed:
            return report.finish()
        if arguments.record:
            SHOWN.mkdir(parents=True, exist_ok=True)
            for path in ("curve.svg", "compare.jpg", *(["blender.png"] if has_blender else [])):
                shutil.copy(folder / path, SHOWN / path)
            return report.finish()
        laws = next(text for kind, text in blocks(page) if not kind and text.startswith("finite "))
        report.check("check prints what the page says", said[0].endswith("\n" + laws), said[0])
        names = re.findall(r"!\[.*?\]\(images/own/(.*?)\)", page)
        report.check("all pictures of the page are compared", names == ["curve.svg", "compare.jpg", "blender.png"], names)
        check_numbers(report, folder, said)
        check_pictures(report, folder, has_blender)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
