# SPDX-License-Identifier: Apache-2.0
"""Every tag of every format that is read: used, named in one line, or refused with the reason.

    python3 -m pytest tests/tags/test_tags.py --tonewright build/release/bin/tonewright [--table FILE] [-k NAME]

The files and their light come from make_files.py: closed formulas of the standards, no picture of Tonewright. `apply` writes
x/(x+1) of linear Rec.709, which loses nothing but negatives, and `info --json` says what the file means. With TONEWRIGHT_TEST_ALL=1,
--table writes the table of docs/conventions.md: format, and its tags by what happened. A commit tests an eighth of the rows, `./run
test --all` every one. -k selects by format or name of a file; pytest keeps the files of the last runs in its --basetemp.
"""

import concurrent.futures
import json
import os
import re
import subprocess

import numpy as np
import pytest
from make_files import IMPOSSIBLE, NAMED, NO_EFFECT, ROWS, USED, Missing
from pictures import share_of, skip

pytestmark = pytest.mark.share(2)

oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO's Python module is missing (Debian: python3-openimageio)")

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


def light_at(picture, layer, x, y):
    """Color and alpha of a pixel of a layer: the operator is undone, and so is the alpha."""
    pixels, names, _origin = picture
    y, x = min(y, pixels.shape[0] - 1), min(x, pixels.shape[1] - 1)
    values = dict(zip(names, pixels[y, x]))
    prefix = f"{layer}." if layer and f"{layer}.R" in values else ""
    alpha = values.get(prefix + "A")
    color = np.array([values[prefix + n] for n in "RGB"]) if prefix + "R" in values else np.array([pixels[y, x][0]] * 3)
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

    def lines(self):
        """What was said about the header, without what was said about the output and the operator."""
        about_header = [line for line in self.applied.stderr.splitlines() if "finished for a display (" not in line]
        return [*about_header, *(json.dumps(line) for line in self.info.get("ignored") or [])]

    def names_it(self):
        said = "\n".join(self.lines()).lower()
        return any(word.lower() in said for word in self.row.word.split("|"))

    def light_fault(self, rgb):
        """Empty where every point has its value."""
        row = self.row
        points = row.points or (((4, 4), rgb),)
        height, width = self.picture[0].shape[:2]
        if row.size and (width, height) != row.size:
            return f"{width} x {height} pixels; expected {row.size[0]} x {row.size[1]}"
        for (x, y), want in points:
            got, alpha = light_at(self.picture, self.info.get("layer"), x, y)
            if not near(got, want, row.tolerance):
                return f"{text(got)} at {x} {y}; expected {text(want)}"
            if row.alpha is not None and (alpha is None or abs(alpha - row.alpha) > 0.002):
                return f"alpha {alpha}; expected {row.alpha:.4f}"
        return ""

    def judge(self):
        """What is wrong; empty if the row's treatment is what happens."""
        row, code = self.row, self.applied.returncode
        if code == REFUSED:
            if row.treatment != IMPOSSIBLE:
                return f"refused; expected {row.treatment}: {self.applied.stderr.strip()[:200]}"
            return "" if self.names_it() else f"refused without one of the words {row.word}: {self.applied.stderr.strip()[:200]}"
        if code != 0:
            return f"exit status {code}: {self.applied.stderr.strip()[:200]}"
        if row.treatment == IMPOSSIBLE:
            return "read; expected a refusal"
        lines = self.lines()
        if row.word and not self.names_it():
            return f"no line has one of the words {row.word}: {lines}"
        if not row.word and lines:
            return f"{row.treatment}, but a line says: {lines}"
        rgb = row.rgb if row.ignored is None else row.ignored
        return self.light_fault(rgb) if rgb is not None or row.points else ""

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
    return row, row.treatment, done.judge() or done.info_of_row(), ""


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


SHARE = {row.name for row in share_of(ROWS, 9)}


@pytest.fixture(scope="module")
def trials(request, command, tmp_path_factory):
    """{name of a file: its trial}, for all rows that run: as many at a time as there are processors."""
    folder = tmp_path_factory.mktemp("tags")
    rows = [item.callspec.params["row"] for item in request.session.items if item.path == request.path]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        trials = {row.name: pool.submit(trial, command, row, folder) for row in rows}
        yield trials
    if table := request.config.getoption("--table"):
        table.write_text(markdown([done.result() for done in trials.values()]))


@pytest.mark.parametrize("row", [pytest.param(row, id=f"{row.format} {row.name}", marks=() if row.name in SHARE else pytest.mark.full)
                                 for row in ROWS])
def test_row(report, trials, row):
    _row, seen, fault, why = trials[row.name].result()
    if seen == "skipped":
        skip(f"{row.format} {row.tag}: {why}")
    report.check(f"{row.format:10s} {row.tag}: {seen or 'fails'}  ({row.name})", not fault, fault)
