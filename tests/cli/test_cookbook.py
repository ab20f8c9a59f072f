# SPDX-License-Identifier: Apache-2.0
"""docs/cookbook.md: all commands, what they print, and the pictures of the page."""

import re

import numpy as np
from docs_commands import DOCS, ONE_CODE, check_page, read_rgb

# A page loads slowly with more.
PICTURE_BYTES, PAGE_BYTES = 60_000, 250_000


def check(report, page, folder, _):
    jobs = [(title, text) for title, text in re.findall(r"(?ms)^## (.*?)$(.*?)(?=^## |\Z)", page) if "```sh" in text]
    report.check("twelve jobs", len(jobs) == 12, [title for title, _ in jobs])
    for title, text in jobs:
        report.check(f"{title}: an output or a picture", "```output" in text or "![" in text)
    sizes = [path.stat().st_size for path in (DOCS / "images" / "cookbook").iterdir()]
    report.check("the pictures are small", max(sizes) <= PICTURE_BYTES and sum(sizes) <= PAGE_BYTES, sizes)
    # The formula of the page, as sRGB code values (IEC 61966-2-1).
    light = 1 - np.exp(-np.maximum(read_rgb(folder / "render.exr", folder).astype(float), 0))
    srgb = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308)**(1 / 2.4) - 0.055)
    report.compare("film.png is the formula", read_rgb(folder / "film.png", folder), srgb, ONE_CODE)


def test_page(report, command, scratch):
    check_page(report, "cookbook", command, scratch, check)
