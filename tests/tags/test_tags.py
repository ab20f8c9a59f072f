# SPDX-License-Identifier: Apache-2.0
"""Every tag of every format that is read: used, named in one line, or refused with the reason.

    python3 tests/tags/test_tags.py build/release/bin/tonewright [--table FILE] [--keep FOLDER] [NAME...]

The files and their light come from make_files.py: closed formulas of the standards, no picture of Tonewright. `apply` writes
x/(x+1) of linear Rec.709, which loses nothing but negatives, and `info --json` says what the file means. --table writes
the table of docs/conventions.md from all rows: format, and its tags by what happened. A commit tests an eighth of the rows, `./run test
--all` every one. The last line is `N passed, M failed`.
"""

import argparse
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity" / "clients"))
from make_files import IMPOSSIBLE, NAMED, NO_EFFECT, ROWS, USED, Missing  # noqa: E402
from pictures import Report, share_of, skip  # noqa: E402

try:
    import OpenImageIO as oiio
except ImportError:
    skip("OpenImageIO's Python module is missing (Debian: python3-openimageio)")

REFUSED = 3
# Below this share of the largest channel, 1 % is less than a code of 16 bits.
FLOOR = 2e-4
FIELDS = ("space", "transfer", "primaries", "white", "orientation", "layer", "subimage", "units", "alpha", "rule", "ignored")


def read_exr(path):
    reader = oiio.ImageInput.open(str(path))
    spec = reader.spec()
    pixels = np.asarray(reader.read_image(oiio.FLOAT), float).reshape(spec.height, spec.width, spec.nchannels)
    names, origin = list(spec.channelnames), (spec.x, spec.y)
    reader.close()
    return pixels, names, origin


def light_at(picture, x, y):
    """Color and alpha of a pixel: the operator is undone, and so is the alpha."""
    pixels, names, _origin = picture
    y, x = min(y, pixels.shape[0] - 1), min(x, pixels.shape[1] - 1)
    values = dict(zip(names, pixels[y, x]))
    alpha = values.get("A")
    color = np.array([values[n] for n in "RGB"]) if "R" in values else np.array([pixels[y, x][0]] * 3)
    if alpha is not None and alpha > 0:
        color = color / alpha
    with np.errstate(divide="ignore"):
        return color / (1 - color), alpha


def near(got, want, tolerance):
    want = np.maximum(np.asarray(want, float), 0)  # the operator has no negatives
    return bool(np.all(np.abs(got - want) <= tolerance * want + FLOOR * want.max()))


def text(values):
    return " ".join(f"{v:.4f}" for v in values)


class Trial:
    """One file through `apply` and `info`."""

    def __init__(self, program, row, folder):
        self.row = row
        source = folder / row.name
        source.write_bytes(row.make())
        target = folder / (row.name + ".out.exr")
        self.applied = self.run(program, "apply", source, target, "--operator", "reinhard", "--display", "linear", "-d", "float", *row.options)
        self.picture = read_exr(target) if self.applied.returncode == 0 else None
        told = self.run(program, "info", source, "--json")
        self.info, self.info_fault = {}, ""
        if told.returncode == 0:
            try:
                self.info = json.loads(told.stdout)
                self.info = self.info[0] if isinstance(self.info, list) else self.info
                missing = [field for field in FIELDS if field not in self.info]
                self.info_fault = f"info --json lacks {', '.join(missing)}" if missing else ""
            except ValueError as error:
                self.info_fault = f"info --json is no JSON: {error}"
        elif told.returncode != REFUSED:
            self.info_fault = f"info --json ended with {told.returncode}: {told.stderr.strip()}"

    @staticmethod
    def run(*command):
        return subprocess.run([str(word) for word in command], capture_output=True, text=True, errors="replace", timeout=120, check=False)

    def said(self):
        return self.applied.stderr + "\n" + "\n".join(json.dumps(line) for line in self.info.get("ignored") or [])

    def names_it(self):
        return any(word.lower() in self.said().lower() for word in self.row.word.split("|")) if self.row.word else False

    def light_fault(self, rgb):
        """Empty where every point has its value."""
        row = self.row
        points = row.points or (((4, 4), rgb),)
        height, width = self.picture[0].shape[:2]
        if row.size and (width, height) != row.size:
            return f"{width} x {height} pixels; expected {row.size[0]} x {row.size[1]}"
        for (x, y), want in points:
            got, alpha = light_at(self.picture, x, y)
            if not near(got, want, row.tolerance):
                return f"{text(got)} at {x} {y}; expected {text(want)}"
            if row.alpha is not None and (alpha is None or abs(alpha - row.alpha) > 0.002):
                return f"alpha {alpha}; expected {row.alpha:.4f}"
        return ""

    def judge(self):
        """The treatment, and a fault."""
        row, code = self.row, self.applied.returncode
        if code == REFUSED:
            if IMPOSSIBLE in row.allow and self.names_it():
                return IMPOSSIBLE, ""
            wanted = f"with one of these words: {row.word}" if IMPOSSIBLE in row.allow else "expected a picture"
            return IMPOSSIBLE, f"refused, {wanted}: {self.applied.stderr.strip()[:200]}"
        if code != 0:
            return "", f"exit status {code}: {self.applied.stderr.strip()[:200]}"
        if NAMED in row.allow and self.names_it() and not (USED in row.allow and self.has_light() and not self.light_fault(row.rgb)):
            # The value without the tag is the reader's own; only rows that say nothing else check it.
            plain = self.light_fault(row.rgb) if self.has_light() and USED not in row.allow and NO_EFFECT not in row.allow else ""
            return NAMED, plain
        if not self.has_light():
            return "", f"read without a word; expected {' or '.join(row.allow)} ({row.word})"
        faults = [self.light_fault(rgb) for rgb in [row.rgb, *(rgb for rgb, _why in row.others)]]
        if all(faults):
            named = f", and no line has {row.word}" if NAMED in row.allow else ""
            return "", faults[0] + named
        if NAMED in row.allow and USED not in row.allow and NO_EFFECT not in row.allow:
            return "", f"read without a word; expected one of {row.word}"
        seen = NO_EFFECT if NO_EFFECT in row.allow and USED not in row.allow else USED
        if seen not in row.allow:
            return "", f"read; expected {' or '.join(row.allow)} ({row.word})"
        return seen, ""

    def has_light(self):
        return self.row.rgb is not None or bool(self.row.points)

    def info_of_row(self):
        for field, value in self.row.info.items():
            if str(value).lower() not in str(self.info.get(field)).lower():
                return f"info: {field} is {self.info.get(field)}; expected {value}"
        return self.info_fault


def trial(program, row, folder):
    try:
        done = Trial(program, row, folder)
    except Missing as error:
        return row, "skipped", "", str(error)
    except subprocess.TimeoutExpired:
        return row, "", "no end after 120 seconds", ""
    seen, fault = done.judge()
    return row, seen, fault or done.info_of_row(), ""


def markdown(results):
    """A row for each format: its tags by what happens to them."""
    kinds = (("used", (USED, NO_EFFECT)), ("named", (NAMED,)), ("impossible", (IMPOSSIBLE,)))
    lines = ["| format | " + " | ".join(kind for kind, _seen in kinds) + " |", "|---" * (len(kinds) + 1) + "|"]
    for form in dict.fromkeys(row.format for row, *_rest in results):
        cells = []
        for _kind, wanted in kinds:
            tags = [row.tag for row, seen, fault, _why in results if row.format == form and seen in wanted and not fault]
            pairs = [tag[5:] for tag in tags if re.fullmatch(r"cICP \d+/\d+", tag)]
            tags = [tag for tag in tags if not re.fullmatch(r"cICP \d+/\d+", tag)]
            if pairs:
                tags.insert(0, "cICP " + " ".join(pairs))
            cells.append("; ".join(tags).replace("|", "\\|"))
        lines.append(f"| {form} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--table", help="write the table as Markdown")
    parser.add_argument("--keep", help="write the files into this folder and keep them")
    parser.add_argument("names", nargs="*", help="names of files, or formats")
    options = parser.parse_args()
    rows = [row for row in ROWS if not options.names or row.name in options.names or row.format in options.names]
    if not options.names and not options.table:
        rows = share_of(rows, 8)
    report = Report()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(options.keep or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(lambda row: trial(options.program, row, folder), rows))
    skipped = 0
    for row, seen, fault, why in results:
        if seen == "skipped":
            skipped += 1
            print(f"skip {row.format:10s} {row.tag}: {why}")
            continue
        report.check(f"{row.format:10s} {row.tag}: {seen or 'fails'}  ({row.name})", not fault, fault)
    if options.table:
        Path(options.table).write_text(markdown(results))
    if skipped:
        print(f"{skipped} skipped")
    print(f"{report.passed} passed, {report.failed} failed")
    return 1 if report.failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
