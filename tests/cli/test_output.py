# SPDX-License-Identifier: Apache-2.0
"""What `tonewright apply` writes, and what other programs find in it: chroma of JPEG, AVIF, tags, light levels, alpha.

    python3 tests/cli/test_output.py build/release/bin/tonewright

Pictures are made and read with OpenImageIO's Python. The last line is `N passed, M failed`.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from test_pictures import read, spec_of, write  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity" / "clients"))
from pictures import Report  # noqa: E402

OK, USAGE, FILE = 0, 2, 3


class Writer:
    def __init__(self, report, command, folder):
        self.report, self.command, self.folder = report, command, folder

    def apply(self, source, name, *options):
        """(exit code, standard error) of `apply` with the operator clamp."""
        done = subprocess.run([self.command, "apply", source, self.folder / name, "--operator", "clamp", *options],
                              capture_output=True, text=True, check=False)
        return done.returncode, done.stderr

    def written(self, source, name, *options):
        """Pixels and header of the file that `apply` must write."""
        code, said = self.apply(source, name, *options)
        if code:
            raise RuntimeError(f"exit {code}: {said}")
        return read(self.folder / name)

    def refuses(self, what, source, name, code, words, *options):
        is_code, said = self.apply(source, name, *options)
        lines = said.splitlines()
        left = [p.name for p in self.folder.iterdir() if p.name == name or ".tmp." in p.name]
        self.report.check(what, is_code == code and len(lines) == 1 and words in said and not left,
                          f"exit {is_code}: {said} {left}")


def png(folder, name, code):
    """Code values as an 8-bit PNG, which clamp maps to themselves."""
    return write(folder / name, spec_of(code, "uint8"), code.astype(np.float32))


def saturated_photograph(size=128):
    """Patches of saturated hues with edges at every angle, as of flowers or signs, and fine detail on them."""
    rng = np.random.default_rng(3)
    y, x = np.mgrid[:size, :size] / size
    hue = np.zeros((size, size), int)
    for k in range(1, 24):
        angle, offset, width = rng.uniform(0, np.pi), rng.uniform(-0.2, 1.2), rng.uniform(0.01, 0.08)
        hue[np.abs(x * np.cos(angle) + y * np.sin(angle) - offset) < width] = k
    colors = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1]])
    shade = 0.6 + 0.4 * rng.random((size, size, 1))
    return colors[hue % 6] * shade


def check_jpeg(to):
    lines = np.zeros((48, 48, 3))
    lines[:, 1::6, 0] = 1
    pictures = {"red lines of one pixel": lines, "a saturated photograph": saturated_photograph()}
    for what, code in pictures.items():
        source = png(to.folder, "in.png", code)
        code = read(source)[0]

        def error(*options):
            pixels, spec = to.written(source, "o.jpg", *options)
            return np.sqrt(np.mean((pixels - code) ** 2)), spec.getattribute("jpeg:subsampling")
        before, kind = error("--quality", "100", "--subsampling", "4:2:0")
        to.report.check(f"--subsampling 4:2:0 is 4:2:0: {what}", kind == "4:2:0", kind)
        for options in ([], ["--quality", "90"], ["--quality", "100"], ["--compression", "jpeg:95"],
                        ["--quality", "60", "--subsampling", "4:4:4"]):
            after, kind = error(*options)
            # Half the resolution of chroma loses most of a line at any quality; at 90, quantization costs a quarter of
            # that, so a third separates the two.
            limit = before / 3 if "60" not in options else before
            to.report.bound(f"{what}, {' '.join(options) or 'default'}: rms, 4:2:0 has {before:.3f}", after, limit)
            to.report.check("and the file says 4:4:4", kind == "4:4:4", kind)
        to.report.check(f"below quality 90: 4:2:0: {what}", error("--quality", "89")[1] == "4:2:0")
    pixels, _ = to.written(png(to.folder, "in.png", lines), "o.jpg", "--quality", "100")
    # 8-bit YCbCr rounds each channel by up to 1.4 code values; libjpeg's transform adds as much.
    to.report.bound("a red line stays red at quality 100", np.abs(pixels - lines).max(), 4 / 255)

    # The kind of the source is not that of the result.
    to.written(png(to.folder, "in.png", lines), "half.jpg", "--subsampling", "4:2:0")
    _, spec = to.written(to.folder / "half.jpg", "o.jpg")
    to.report.check("a source's own subsampling is not taken over", spec.getattribute("jpeg:subsampling") == "4:4:4")
    source = to.folder / "in.png"
    to.refuses("--subsampling of no such kind", source, "no.jpg", USAGE, "did you mean 4:2:0", "--subsampling", "4:20")
    to.refuses("--subsampling of WebP", source, "no.webp", USAGE, "one kind only", "--subsampling", "4:4:4")
    to.refuses("--subsampling of PNG", source, "no.png", USAGE, "only JPEG has it", "--subsampling", "4:4:4")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    command = parser.parse_args().command.resolve()
    report = Report()
    for part in (check_jpeg,):
        with tempfile.TemporaryDirectory(prefix="tonewright-") as folder:
            part(Writer(report, command, Path(folder)))
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
