# SPDX-License-Identifier: Apache-2.0
"""oiiotool with the OpenColorIO config against `tonewright apply`: the same picture from both, for every operator.

    python3 tests/parity/clients/test_oiiotool.py build/release/bin/tonewright

Real pictures join the test chart where they are found, see pictures.shared_picture; the config is a fresh one of all
operators. The last line is `N passed, M failed`.
"""

import argparse
import os
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from pictures import (Report, need_program, read_exr, read_planes, read_rgb, run, shared_picture, skip,
                      stack, unstack, views, write_exr)

# `apply` runs the SIMD engine, which may be 1e-6 from the double reference, and a chain of matrices, ranges and
# half-domain curves in OpenColorIO may be 3e-7 from it: code values, on the other side of the reference at worst.
EXACT = 3e-7 + 1e-6
# Where a chain is not that exact, the config says by how much: the largest error of its README, which is that of
# random colours. A picture may find more between them.
BETWEEN_PROBES = 3


def bound_of(config, view):
    """The error that the config's README publishes for a view, in code values of sRGB."""
    view = view.split(" - HDR ")[0]
    rows = [[cell.strip() for cell in line.split("|")] for line in
            (config.parent / "README.md").read_text().splitlines() if line.startswith(f"| {view} |")]
    if len(rows) != 1:
        raise ValueError(f"{config.parent}/README.md: {len(rows)} rows of {view}; expected 1")
    return max(EXACT, BETWEEN_PROBES * float(rows[0][4]) + 1e-6)


def through_oiiotool(config, picture, display, view, out):
    """The command that users type. No `from=`: the picture's own space is found by the name that OIIO gives it.

    --ch R,G,B first: oiiotool converts colour that is multiplied by alpha as if it were not, and OIIO changes channels
    behind alpha (0.5 + 10 v).
    """
    run("oiiotool", picture, "--ch", "R,G,B", "--colorconfig", config, "--ociodisplay", display, view,
        "-d", "float", "--compression", "none", "-o", out)
    return stack(read_exr(out))


def through_apply(command, picture, operator, out, *options):
    run(command, "apply", picture, out, "--operator", operator, "--statistics", "defaults", "-d", "float", *options)
    return read_rgb(out, Path(out).parent)


def compare_views(report, command, config, picture, scratch, jobs, what=""):
    """Each of jobs, (operator, view, display option, display name); as many at a time as there are cores."""

    def both(job):
        operator, view, option, display = job
        out = scratch / f"{picture.stem}.{operator}.{option}"
        shown = through_oiiotool(config, picture, display, view, f"{out}.oiiotool.exr")
        # --no-unpremult: what oiiotool does, see above.
        return shown, through_apply(command, picture, operator, f"{out}.apply.exr", "--no-unpremult",
                                    "--display", option)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for (operator, view, option, _), (shown, applied) in zip(jobs, pool.map(both, jobs)):
            report.compare(f"{what or picture.name} {option} {operator}", shown, applied, bound_of(config, view))


def check_alpha(report, command, config, picture, scratch):
    """Premultiplied colour: `--ociodisplay:unpremult=1` divides by alpha, and `apply` does it on its own."""
    out = scratch / "alpha.exr"
    run("oiiotool", picture, "--colorconfig", config, "--ociodisplay:unpremult=1", "sRGB", "Hable",
        "-d", "float", "--compression", "none", "-o", out)
    shown = read_exr(out)
    run(command, "apply", picture, out, "--operator", "hable", "-d", "float")
    applied = read_planes(out, scratch)
    report.compare(f"{picture.name} with alpha", stack(shown, "RGBA"), stack(applied, "RGBA"), EXACT)


def check_output_spaces(report, command, config, picture, scratch):
    """What write nodes and `--colorconvert` have instead of views: the same pixels, and back."""
    for view in ("AgX", "ACES 2.0", "Reinhard Extended"):
        shown = through_oiiotool(config, picture, "sRGB", view, scratch / "view.exr")
        run("oiiotool", picture, "--ch", "R,G,B", "--colorconfig", config, "--colorconvert", "Linear Rec.709",
            f"Output - {view} - sRGB", "-d", "float", "--compression", "none", "-o", scratch / "space.exr")
        report.compare(f"--colorconvert to Output - {view} - sRGB", stack(read_exr(scratch / "space.exr")), shown, 0)
    run("oiiotool", scratch / "space.exr", "--colorconfig", config, "--colorconvert", "out_reinhard_extended_srgb",
        "lin_rec709", "--colorconvert", "lin_rec709", "out_reinhard_extended_srgb", "-d", "float", "--compression",
        "none", "-o", scratch / "again.exr")
    report.compare("and back, and there again", stack(read_exr(scratch / "again.exr")), shown, EXACT)


def check_negatives(report, command, config, scratch):
    """Colours outside the display's gamut, NaN and infinities: both forms give the same finite picture."""
    rng = np.random.default_rng(7)
    rgb = (0.18 * 2.0 ** rng.uniform(-8, 8, (64, 64, 3)) * rng.choice([-1, 1], (64, 64, 3), p=[0.2, 0.8]))
    rgb = rgb.astype(np.float32)
    rgb[0, 0], rgb[0, 1], rgb[0, 2] = (np.nan, 0.18, 1), (np.inf, 0.18, -np.inf), (0.18, np.nan, np.inf)
    write_exr(scratch / "special.exr", unstack(rgb))
    for operator, view in (("hable", "Hable"), ("agx_sobotka", "AgX Sobotka")):
        shown = through_oiiotool(config, scratch / "special.exr", "sRGB", view, scratch / "s.exr")
        applied = through_apply(command, scratch / "special.exr", operator, scratch / "a.exr")
        report.compare(f"negatives, NaN, infinities {operator}", shown, applied, EXACT)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    command = parser.parse_args().command.resolve()
    need_program("oiiotool", "openimageio-tools")
    if "OpenColorIO" not in run("oiiotool", "--help"):
        skip("oiiotool was built without OpenColorIO")
    report = Report()
    with tempfile.TemporaryDirectory(prefix="tonewright-") as folder:
        scratch = Path(folder)
        # Every operator, without the looks of each: oiiotool reads the whole config for every picture.
        run(command, "config", "-o", scratch / "config", "--views", ",".join(operator for operator, _ in views(command)),
            "--displays", "srgb,display_p3,rec2100_pq,rec2100_hlg,p3d65_pq")
        config = scratch / "config" / "config.ocio"
        chart = scratch / "chart.exr"
        run(command, "chart", "-o", chart, "--width", 768, "--height", 432)
        jobs = [(operator, view, "srgb", "sRGB") for operator, view in views(command)]
        extra = [("agx_sobotka", "AgX Sobotka", "display_p3", "Display P3"),
                 ("aces_13", "ACES 1.3 - HDR 1000 nits", "rec2100_pq", "Rec.2100-PQ"), ("hable", "Hable", "p3d65_pq", "P3-D65 PQ"),
                 ("uchimura", "Gran Turismo - HDR 1000 nits", "rec2100_hlg", "Rec.2100-HLG")]
        compare_views(report, command, config, chart, scratch, jobs + extra)
        for name in ("memorial.hdr", "Desk.exr"):
            picture = shared_picture(name)
            if picture:
                compare_views(report, command, config, picture, scratch, jobs)
        check_negatives(report, command, config, scratch)
        check_output_spaces(report, command, config, chart, scratch)

        alpha = np.linspace(0, 1, 256, dtype=np.float32).reshape(16, 16)
        ramp = alpha[..., None] * np.array([0.18, 1, 6], np.float32)
        write_exr(scratch / "ramp.exr", {**unstack(ramp), "A": alpha})
        check_alpha(report, command, config, scratch / "ramp.exr", scratch)
        glow = shared_picture("CandleGlass.exr")  # light where alpha is 0: a flame
        if glow:
            check_alpha(report, command, config, glow, scratch)
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
