# SPDX-License-Identifier: Apache-2.0
"""oiiotool with the OpenColorIO config against `tonewright apply`: the same picture from both, for every operator.

    python3 -m pytest tests/parity/clients/test_oiiotool.py --tonewright build/release/bin/tonewright

Real pictures join the test chart where they are found, see pictures.shared_picture. The views are those of ocio_config/
and, in a fresh config, a share of all operators.
"""

import os
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from pictures import (PROJECT, need_program, read_exr, read_planes, read_rgb, run, share_of, shared_picture, skip, stack, unstack, views,
                      write_exr)

SHIPPED = PROJECT / "ocio_config" / "config.ocio"
# `apply` runs the SIMD engine, which may be 1e-6 from the double reference, and a chain of matrices, ranges and
# half-domain curves in OpenColorIO may be 3e-7 from it: code values, on the other side of the reference at worst.
EXACT = 3e-7 + 1e-6
# Where a chain is not that exact, the config says by how much: the largest error of its README, which is that of
# random colors. A picture may find more between them.
BETWEEN_PROBES = 4


@pytest.fixture(scope="module")
def chart(command, tmp_path_factory):
    """The test chart. Skips where oiiotool lacks OpenColorIO."""
    need_program("oiiotool", "openimageio-tools")
    if "OpenColorIO" not in run("oiiotool", "--help"):
        skip("oiiotool was built without OpenColorIO")
    path = tmp_path_factory.mktemp("chart") / "chart.exr"
    run(command, "chart", "-o", path, "--width", 768, "--height", 432)
    return path


def bound_of(config, view):
    """The error that the config's README publishes for a view, in code values of sRGB."""
    view = view.split(" - HDR ")[0]
    rows = [[cell.strip() for cell in line.split("|")] for line in
            (config.parent / "README.md").read_text().splitlines() if line.startswith(f"| {view} |")]
    if len(rows) != 1:
        raise ValueError(f"{config.parent}/README.md: {len(rows)} rows of {view}; expected 1")
    return max(EXACT, BETWEEN_PROBES * float(rows[0][4]) + 1e-6)


def through_oiiotool(config, picture, scratch, *conversions):
    """[pixels] of `oiiotool PICTURE CONVERSION -o`, for many conversions: one process, which reads the config once.

    No `from=`: the picture's own space is found by the name that OIIO gives it. --ch R,G,B first: oiiotool converts
    color that is multiplied by alpha as if it were not, and OIIO changes channels behind alpha (0.5 + 10 v).
    """
    with tempfile.TemporaryDirectory(dir=scratch) as folder:
        outs = [f"{folder}/{number}.exr" for number in range(len(conversions))]
        run("oiiotool", "--colorconfig", config, "-d", "float", "--compression", "none", picture, "--ch", "R,G,B",
            *(word for words, out in zip(conversions, outs) for word in ("--dup", *words, "-o", out, "--pop")))
        return [stack(read_exr(out)) for out in outs]


def through_apply(command, picture, scratch, operator, *options):
    with tempfile.TemporaryDirectory(dir=scratch) as folder:
        out = Path(folder) / "out.exr"
        run(command, "apply", picture, out, "--operator", operator, "--statistics", "defaults", "-d", "float", *options)
        return read_rgb(out, folder)


def compare_views(report, command, config, path, parts, scratch, jobs):
    """Each of jobs, (operator, view, display option, display name), of a picture.

    parts are the checks: (name, its pixels in the picture: a slice of them all, and the shape that they have).
    """

    def both(jobs):
        shown = through_oiiotool(config, path, scratch,
                                 *(("--ociodisplay", display, view) for _, view, _, display in jobs))
        for (operator, view, option, _), colors in zip(jobs, shown):
            # --no-unpremult: what oiiotool does, see above.
            applied = through_apply(command, path, scratch, operator, "--no-unpremult", "--display", option)
            for name, where, shape in parts:
                report.compare(f"{name} {option} {operator}", colors.reshape(-1, 3)[where].reshape(shape),
                               applied.reshape(-1, 3)[where].reshape(shape), bound_of(config, view))

    # Eight views a process: what it reads for all of them is then little, and so is what lies on the disk.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(both, (jobs[i:i + 8] for i in range(0, len(jobs), 8))))


def whole(path, scratch):
    """The picture as one part."""
    return [(path.name, slice(None), read_rgb(path, scratch).shape)]


def join(pictures, path, scratch):
    """Writes the pixels of all pictures into one, so that they are read once; returns its parts."""
    pixels, parts, start = [], [], 0
    for picture in pictures:
        rgb = read_rgb(picture, scratch)
        pixels.append(rgb.reshape(-1, 3))
        parts.append((picture.name, slice(start, start + len(pixels[-1])), rgb.shape))
        start += len(pixels[-1])
    pixels.append(np.zeros((-start % 1024, 3), np.float32))
    write_exr(path, unstack(np.concatenate(pixels).reshape(-1, 1024, 3)))
    return parts


def test_output_spaces(report, scratch, chart):
    """Color spaces for write nodes and `--colorconvert` instead of views: the same pixels, and the inverse."""
    names = ("AgX", "ACES 2.0", "Reinhard Extended")
    spaces = [("--colorconvert", "Linear Rec.709", f"Output - {view} - sRGB") for view in names]
    again = (*spaces[-1], "--colorconvert", "out_reinhard_extended_srgb", "lin_rec709",
             "--colorconvert", "lin_rec709", "out_reinhard_extended_srgb")
    *shown, there = through_oiiotool(SHIPPED, chart, scratch, *(("--ociodisplay", "sRGB", view) for view in names),
                                     *spaces, again)
    for view, displayed, converted in zip(names, shown, shown[len(names):]):
        report.compare(f"--colorconvert to Output - {view} - sRGB", converted, displayed, 0)
    report.compare("and back, and there again", there, shown[len(names) - 1], EXACT)


@pytest.mark.usefixtures("chart")
def test_negatives(report, command, scratch):
    """Colors outside the display's gamut, NaN and infinities: both forms give the same finite picture."""
    rng = np.random.default_rng(7)
    rgb = (0.18 * 2.0 ** rng.uniform(-8, 8, (64, 64, 3)) * rng.choice([-1, 1], (64, 64, 3), p=[0.2, 0.8]))
    rgb = rgb.astype(np.float32)
    rgb[0, 0], rgb[0, 1], rgb[0, 2] = (np.nan, 0.18, 1), (np.inf, 0.18, -np.inf), (0.18, np.nan, np.inf)
    write_exr(scratch / "special.exr", unstack(rgb))
    for operator, view in (("hable", "Hable"), ("agx_sobotka", "AgX Sobotka")):
        shown, = through_oiiotool(SHIPPED, scratch / "special.exr", scratch, ("--ociodisplay", "sRGB", view))
        applied = through_apply(command, scratch / "special.exr", scratch, operator)
        report.compare(f"negatives, NaN, infinities {operator}", shown, applied, EXACT)


def check_alpha(report, command, picture, scratch):
    """Premultiplied color: `--ociodisplay:unpremult=1` divides by alpha, and `apply` does it on its own."""
    out = scratch / "alpha.exr"
    run("oiiotool", picture, "--colorconfig", SHIPPED, "--ociodisplay:unpremult=1", "sRGB", "Hable",
        "-d", "float", "--compression", "none", "-o", out)
    shown = read_exr(out)
    # oiiotool divides emission by its alpha, too.
    run(command, "apply", picture, out, "--operator", "hable", "-d", "float", "--unpremult")
    applied = read_planes(out, scratch)
    report.compare(f"{picture.name} with alpha", stack(shown, "RGBA"), stack(applied, "RGBA"), EXACT)


@pytest.mark.usefixtures("chart")
def test_alpha(report, command, scratch):
    alpha = np.linspace(0, 1, 256, dtype=np.float32).reshape(16, 16)
    ramp = alpha[..., None] * np.array([0.18, 1, 6], np.float32)
    write_exr(scratch / "ramp.exr", {**unstack(ramp), "A": alpha})
    check_alpha(report, command, scratch / "ramp.exr", scratch)
    glow = shared_picture("CandleGlass.exr")  # light where alpha is 0: a flame
    if glow:
        check_alpha(report, command, glow, scratch)


def test_views(report, command, scratch, chart):
    # Views of the shipped config on one display, a few on others; a share of all others in a config of their own.
    fresh, joined = scratch / "config" / "config.ocio", scratch / "joined.exr"
    readme = (SHIPPED.parent / "README.md").read_text()
    jobs = [(operator, view, "srgb", "sRGB") for operator, view in views(command)]
    jobs, others = ([job for job in jobs if (f"\n| {job[1]} |" in readme) == is_shipped] for is_shipped in (True, False))
    others = share_of(others, 6)
    extra = [("agx_sobotka", "AgX Sobotka", "display_p3", "Display P3"),
             ("aces_13", "ACES 1.3 - HDR 1000 nits", "rec2100_pq", "Rec.2100-PQ"),
             ("hable", "Hable", "p3d65_pq", "P3-D65 PQ"),
             ("uchimura", "Gran Turismo - HDR 1000 nits", "rec2100_hlg", "Rec.2100-HLG")]
    run(command, "config", "-o", fresh.parent, "--views", ",".join(operator for operator, *_ in others),
        "--displays", "srgb", "--looks", "none")
    pictures = list(filter(None, map(shared_picture, ("memorial.hdr", "Desk.exr"))))
    parts = join([chart, *pictures], joined, scratch)
    compare_views(report, command, SHIPPED, joined, parts, scratch, jobs)
    compare_views(report, command, fresh, joined, parts, scratch, others)
    compare_views(report, command, SHIPPED, chart, whole(chart, scratch), scratch, extra)
    for picture in pictures:  # the files themselves: a space of their own, halfs, alpha
        compare_views(report, command, SHIPPED, picture, whole(picture, scratch), scratch, [
            ("hable", "Hable", "display_p3", "Display P3")])
