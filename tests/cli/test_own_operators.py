# SPDX-License-Identifier: Apache-2.0
"""docs/own_operators.md: all commands, what they print, and the pictures of the page."""

import numpy as np
from docs_commands import ONE_CODE, check_page, read_rgb


def soft(x, k=0.55):
    """OpenColorIO issue 2320."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(x > 0, x / (x + np.maximum(x, 0)**k), 0)


def check(report, _, folder, said):
    printed = next(output.splitlines() for text, output in said if "tonewright eval" in text)
    numbers = next(line for line in printed if line.count(" ") == 2 and line.startswith("0."))
    # eval prints nine digits of sRGB code values (IEC 61966-2-1).
    code = 1.055 * soft(np.array(0.18)) ** (1 / 2.4) - 0.055
    report.bound("eval prints the curve at mid gray", max(abs(float(number) - code) for number in numbers.split()), 1e-9)
    light = np.maximum(read_rgb(folder / "render.exr", folder).astype(float), 0)
    shown = soft(light, 0.7)
    srgb = np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * np.maximum(shown, 0.0031308)**(1 / 2.4) - 0.055)
    report.compare("softer.png is the formula with k = 0.7", read_rgb(folder / "softer.png", folder), srgb, ONE_CODE)
    if (folder / "blender.png").exists():
        report.compare("Blender shows what apply writes", read_rgb(folder / "blender.png", folder),
                       read_rgb(folder / "apply.png", folder), ONE_CODE)


def test_page(report, command, scratch):
    check_page(report, "own_operators", command, scratch, check)
