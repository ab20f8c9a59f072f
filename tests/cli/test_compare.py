# SPDX-License-Identifier: Apache-2.0
"""`tonewright compare` and `apply --false-color`: the pixels of sheets and splits are those of `tonewright apply`."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from pictures import PROJECT, read_rgb, run, share_of_refusals, unstack, views, write_exr

USAGE, FILE = 2, 3
WIDTH, HEIGHT = 48, 32


def scene():
    """Saturated colors over many stops, black, negatives, NaN and infinities."""
    random = np.random.default_rng(7)
    rgb = (0.18 * 2.0 ** random.uniform(-10, 8, (HEIGHT, WIDTH, 3))).astype(np.float32)
    rgb[0, :12] = 0
    rgb[1, :6] *= -1
    rgb[2, 0], rgb[2, 1, 0], rgb[2, 2], rgb[2, 3, 2] = np.nan, np.inf, np.inf, -np.inf
    return rgb


class Bench:
    """Data of all checks: the command, a folder, a picture in it, and the output of `apply`."""

    def __init__(self, command, folder):
        self.command, self.folder = command, folder
        self.picture = folder / "scene.exr"
        write_exr(self.picture, unstack(scene()))
        self.results = {}

    def bytes_of(self, path):
        return np.round(255 * read_rgb(path, self.folder)).astype(int)

    def applied(self, *arguments, picture=None):
        key = (picture, *arguments)
        if key not in self.results:
            out = self.folder / "applied.png"
            run(self.command, "apply", picture or self.picture, out, "-d", "uint8", *arguments)
            self.results[key] = self.bytes_of(out)
        return self.results[key]

    def compared(self, *arguments, picture=None, name="compared.png"):
        out = self.folder / name
        run(self.command, "compare", picture or self.picture, "-o", out, *arguments)
        return self.bytes_of(out)

    def sheet(self, *arguments, **options):
        return self.compared("--cell-width", WIDTH, *arguments, **options)


@pytest.fixture(scope="module")
def bench(command, folder):
    return Bench(command, folder)


def places(sheet, cell):
    """(row, column) of each place where the sheet has these pixels."""
    height, width, _ = cell.shape
    rows, columns = sheet.shape[0] - height + 1, sheet.shape[1] - width + 1
    probes = [(0, -1), (height // 2, width // 2), (-1, 0), (5, 17)]
    possible = np.ones((max(rows, 0), max(columns, 0)), bool)
    for y, x in probes:
        y, x = y % height, x % width
        possible &= (sheet[y:y + rows, x:x + columns] == cell[y, x]).all(axis=-1)
    return [(y, x) for y, x in np.argwhere(possible) if (sheet[y:y + height, x:x + width] == cell).all()]


@pytest.mark.share(2)
def test_sheet(report, bench):
    """Each cell at its own size is what `apply` writes, in the order of the operators."""
    cells = {"hable": ["hable"], "reinhard_extended:white=2.5": ["reinhard_extended", "--set", "white=2.5"],
             "agx_blender:look=punchy": ["agx_blender", "--look", "punchy"], "aces_hill:threejs": ["aces_hill:threejs"],
             "drago": ["drago"]}  # measures the picture
    for options in ([], ["--exposure", "1.5", "--input", "acescg"]):
        sheet = bench.sheet(*cells, *options, "--columns", 3)
        found = [places(sheet, bench.applied("--operator", *arguments, *options)) for arguments in cells.values()]
        what = " ".join(options) or "as it is"
        if report.check(f"sheet, {what}: each cell is what apply writes", all(len(f) == 1 for f in found), found):
            at = np.array(found)[:, 0]
            report.check(f"sheet, {what}: in order, in three columns",
                               (at[[0, 3], 1] == at[0, 1]).all() and (at[:3, 0] == at[0, 0]).all() and
                               at[0, 1] < at[1, 1] < at[2, 1] and at[3, 0] > at[0, 0] + HEIGHT, at.tolist())
    statistics = bench.applied("--operator", "drago", "--statistics", "defaults")
    report.check("drago without statistics is another picture", not places(bench.sheet("drago"), statistics))


@pytest.mark.share(2)
def test_titles(report, bench):
    """Below a cell stands the operator's title; of a look, the name of its view in the config. Both can be typed."""
    width, margin, line = 200, 10, 15  # of a sheet of such cells: make_contact_sheet()
    below = margin + round(width * HEIGHT / WIDTH)
    titles = {"agx_blender": "AgX (Blender)", "agx_blender:look=punchy": "AgX Punchy",
              "agx_sobotka:look=golden": "AgX Sobotka Golden"}
    shown = bench.folder / "shown.png"
    run(bench.command, "apply", bench.picture, shown, "--operator", "hable")
    strips = {}
    for title in (*titles.values(), "AgX (Sobotka)"):
        out = bench.folder / "titled.png"
        run(bench.command, "sheet", f"{title}={shown}", "-o", out, "--cell-width", width)
        strips[title] = bench.bytes_of(out)[below:below + line, margin:margin + width]
    for operator, title in titles.items():
        sheet = bench.compared(operator, "--cell-width", width)
        found = [other for other, strip in strips.items() if places(sheet, strip)]
        report.check(f"sheet: the title of {operator} is {title}", found == [title], found)
        same = bench.applied("--operator", title) == bench.applied("--operator", operator)
        report.check(f"{title} can be typed", same.all())


@pytest.mark.share(2)
def test_pictures(report, bench):
    """Full size for any size of cells; the files are those of `apply`."""
    cells = {"hable": ["hable"], "agx_blender:look=punchy": ["agx_blender", "--look", "punchy"], "drago": ["drago"]}
    folder = bench.folder / "whole"
    bench.compared("--cell-width", 16, *cells, "--pictures", folder, "--exposure", "1")
    names = ["agx_blender_look_punchy.png", "drago.png", "hable.png"]
    report.check("--pictures: a file for each operator", sorted(p.name for p in folder.iterdir()) == names)
    for (operator, arguments), name in zip(cells.items(), ("hable.png", "agx_blender_look_punchy.png", "drago.png")):
        expected = bench.applied("--operator", *arguments, "--exposure", "1")
        report.check(f"--pictures: {operator} is what apply writes", (bench.bytes_of(folder / name) == expected).all())


@pytest.mark.share(2)
def test_scaled(report, bench):
    """A wide picture of one color with one light: the operator that measures takes the light of the whole picture."""
    rgb = np.full((64, 192, 3), 0.3, np.float32) * [1, 0.5, 0.25]
    rgb[0, 0] = 500
    path = bench.folder / "wide.exr"
    write_exr(path, unstack(rgb))
    sheet = bench.sheet("drago", picture=path)
    whole = bench.applied("--operator", "drago", picture=path)
    report.check("a small cell has the statistics of the whole picture", bool(places(sheet, whole[40:52, 40:80])))


@pytest.mark.share(2)
def test_default(report, bench):
    """Without operators: the active views of the config that are not for HDR, in its order."""
    config = (PROJECT / "ocio_config" / "config.ocio").read_text()
    line = next(line for line in config.splitlines() if line.startswith("active_views: ["))
    names = {view: [operator] for operator, view in views(bench.command)}
    names["AgX Punchy"] = ["agx_blender", "--look", "punchy"]
    active = [view for view in line[len("active_views: ["):-1].split(", ") if view in names and view != "False Color"]
    report.check(f"the config has {len(active)} views with operators", len(active) >= 10, line)
    sheet = bench.sheet()
    found = [places(sheet, bench.applied("--operator", *names[view])) for view in active]
    report.check("default: one cell for each of them", all(len(f) == 1 for f in found), list(zip(active, found)))
    order = [tuple(f[0]) for f in found if f]
    report.check("default: in their order", order == sorted(order), order)


@pytest.mark.share(2)
def test_false_color(report, bench):
    for options in ([], ["--exposure", "-2", "--input", "lin_rec2020"]):
        expected = bench.applied("--operator", "false_color", *options)
        report.check(f"apply --false-color {' '.join(options)}",
                           (bench.applied("--false-color", *options) == expected).all())
        sheet = bench.sheet("hable", "--false-color", "--columns", 1, *options)
        report.check(f"sheet --false-color {' '.join(options)}", len(places(sheet, expected)) == 1)
    # The legend has the color of every stop from -7 to +7, from left to right.
    stops = 0.18 * 2.0 ** np.arange(-7, 8)
    ramp = bench.folder / "ramp.exr"
    write_exr(ramp, unstack(np.repeat(stops[None, :, None], 3, axis=2).astype(np.float32)))
    colors = bench.applied("--false-color", picture=ramp)[0]
    sheet = bench.compared("hable", "--false-color", "--cell-width", 200)
    rows = []
    for row in sheet:
        changes = row[np.flatnonzero(np.r_[True, (row[1:] != row[:-1]).any(axis=1)])]
        rows.append(len(changes) == 17 and (changes[1:-1] == colors).all())
    report.check("the legend has the colors of 15 stops", sum(rows) >= 8, sum(rows))
    # `apply --legend` draws it below the picture, whose pixels stay.
    with_legend = bench.applied("--false-color", "--legend")
    report.check("apply --legend: the picture", len(places(with_legend, bench.applied("--false-color"))) == 1)
    rows = [row[np.flatnonzero(np.r_[True, (row[1:] != row[:-1]).any(axis=1)])] for row in with_legend]
    rows = sum(len(row) == 17 and (row[1:-1] == colors).all() for row in rows)
    report.check("apply --legend: the colors of 15 stops", rows >= 8, rows)
    plain = bench.compared("hable", "--cell-width", 200)
    report.check("and is not there without", plain.shape[0] < sheet.shape[0])


@pytest.mark.share(2)
def test_difference(report, bench):
    planes = []
    for name in ("hable", "aces_13"):
        out = bench.folder / "shown.exr"
        run(bench.command, "apply", bench.picture, out, "-d", "float", "--operator", name)
        planes.append(read_rgb(out, bench.folder).astype(float))
    expected = np.clip(5 * np.abs(planes[0] - planes[1]), 0, 1)
    sheet = bench.sheet("hable", "aces_13", "--difference", 5, "--columns", 3)
    (y, x), = places(sheet, bench.applied("--operator", "aces_13"))
    margin = x - places(sheet, bench.applied("--operator", "hable"))[0][1]
    cell = sheet[y:y + HEIGHT, x + margin:x + margin + WIDTH]
    report.bound("the difference, times 5, in codes", np.abs(cell - 255 * expected).max(), 0.51)


@pytest.mark.share(2)
def test_split(report, bench):
    left, right = bench.applied("--operator", "clamp"), bench.applied("--operator", "agx_sobotka")
    for position in (0, 0.3, 1):
        at = round(position * WIDTH)
        shown = bench.compared("clamp", "agx_sobotka", "--split", position, "--no-labels")
        expected = np.concatenate([left[:, :at], right[:, at:]], axis=1)
        report.check(f"split at {position}", shown.shape == expected.shape and (shown == expected).all())
    for position in (0.3, 1):
        at = round(position * HEIGHT)
        shown = bench.compared("clamp", "agx_sobotka", "--split", position, "--no-labels", "--horizontal")
        expected = np.concatenate([left[:at], right[at:]])
        report.check(f"split at {position}, horizontal", shown.shape == expected.shape and (shown == expected).all())
    shown = bench.compared("clamp", "agx_sobotka", "--split", 0.5)
    around = places(shown, left[:, :22]), places(shown, right[:, 26:])
    report.check("labels: the pixels beside the line", all(len(p) == 1 for p in around), around)
    report.check("labels: stand below", shown.shape[0] > HEIGHT + 10 and around[0][0][0] == 0)
    measured = bench.compared("drago", "hable", "--split", 1, "--no-labels")
    report.check("split: statistics", (measured == bench.applied("--operator", "drago")).all())


@pytest.mark.share(2)
def test_other_pictures(report, bench):
    rgb = np.abs(np.nan_to_num(scene(), nan=0, posinf=9, neginf=0))
    alpha = np.full(rgb.shape[:2], 0.5, np.float32)
    path = bench.folder / "alpha.exr"
    write_exr(path, {**unstack(rgb * 0.5), "A": alpha})
    out = bench.folder / "alpha_shown.exr"
    run(bench.command, "apply", path, out, "--operator", "hable", "-d", "float")
    expected = 255 * read_rgb(out, bench.folder)
    shown = bench.compared("hable", "clamp", "--split", 1, "--no-labels", picture=path)
    report.bound("alpha: color is shown on black", np.abs(shown - expected).max(), 0.51)
    gray = bench.folder / "gray.exr"
    write_exr(gray, {"Y": rgb[..., 0]})
    shown = bench.sheet("hable", picture=gray)
    same = (shown == shown[..., :1]).all(axis=-1)
    report.check("gray stays gray", same.all() and len(np.unique(shown)) > 50)
    tiny = bench.folder / "tiny.exr"
    write_exr(tiny, unstack(rgb[:2, :2]))
    shown = bench.sheet("clamp", picture=tiny)
    blocks = np.repeat(np.repeat(bench.applied("--operator", "clamp", picture=tiny), 24, axis=0), 24, axis=1)
    report.check("tiny pictures: pixels are repeated", len(places(shown, blocks)) == 1)
    out = bench.folder / "sheet.jpg"
    run(bench.command, "compare", bench.picture, "-o", out, "hable", "aces_13")
    report.check("jpg: a JPEG file", out.read_bytes()[:3] == b"\xff\xd8\xff")
    first = bench.folder / "compared.png"
    bench.sheet("hable", "drago")
    once = first.read_bytes()
    bench.sheet("hable", "drago")
    report.check("the same bytes again", first.read_bytes() == once)


def test_errors(report, bench):
    folder, picture = bench.folder, str(bench.picture)
    out = folder / "bad.png"
    (folder / "broken.exr").write_bytes(bench.picture.read_bytes()[:500])
    (folder / "file").write_text("")
    write_exr(folder / "thin.exr", unstack(np.ones((5000, 1, 3), np.float32)))
    cases = [
        (USAGE, ["compare", picture, "hablee"], ["hablee", "did you mean hable?"]),
        (USAGE, ["compare", picture, "hable:white=0"], ["hable: white is 0"]),
        (USAGE, ["compare", picture, "hable:look=punchy"], ["look is punchy"]),
        (USAGE, ["compare", picture, "--input", "lin_rec79"], ["did you mean lin_rec709?"]),
        (USAGE, ["compare", picture, "--exposure", "65"], ["exposure is 65"]),
        (USAGE, ["compare", picture, "--exposure", "nan"], ["exposure is nan"]),
        (USAGE, ["compare", picture, "--columns", "0"], ["--columns", "0"]),
        (USAGE, ["compare", picture, "--cell-width", "1"], ["--cell-width", "1"]),
        (USAGE, ["compare", picture, "hable", "clamp", "--split", "1.1"], ["--split", "1.1"]),
        (USAGE, ["compare", picture, "hable", "clamp", "--split", "nan"], ["--split", "nan"]),
        (USAGE, ["compare", picture, "hable", "--split", "0.5"], ["--split", "1 operator", "two"]),
        (USAGE, ["compare", picture, "--split", "0.5"], ["--split", "0 operators", "two"]),
        (USAGE, ["compare", picture, "hable", "clamp", "--split", "0.5", "--false-color"], ["--false-color"]),
        (USAGE, ["apply", picture, out, "--operator", "hable", "--legend"], ["--false-color"]),
        (USAGE, ["apply", picture, out, "--false-color", "--legend", "--display", "display_p3"], ["expected srgb"]),
        (USAGE, ["compare", picture, "hable", "clamp", "--horizontal"], ["--split"]),
        (USAGE, ["compare", picture, "hable", "--difference", "4"], ["--difference", "1 operator", "two"]),
        (USAGE, ["compare", picture, "hable", "clamp", "--difference", "0"], ["--difference", "0"]),
        (USAGE, ["compare"], ["IN is missing", "expected a picture"]),
        (FILE, ["compare", folder / "none.exr"], ["none.exr"]),
        (FILE, ["compare", folder / "broken.exr", "hable"], ["broken.exr"]),
        (FILE, ["compare", folder / "thin.exr", "hable"], ["thin.exr", "1 x 5000 pixels"]),
        (USAGE, ["compare", folder / "thin.exr", "hable", "-o", folder / "thin.exr"], ["thin.exr"]),
        (FILE, ["compare", picture, "hable", "-o", folder / "none" / "x.png"], ["none"]),
        (FILE, ["compare", picture, "hable", "-o", folder / "file" / "x.png"], ["file"]),
        (FILE, ["compare", picture, "hable", "-o", folder / "x.xyz"], ["xyz"]),
        (USAGE, ["apply", picture, out, "--false-color", "--operator", "hable"], ["--false-color"]),
        (USAGE, ["apply", picture, out, "--false-color", "--lut", "x.cube"], ["--false-color"]),
        (USAGE, ["apply", picture, out, "--false-color", "--look", "punchy"], ["look is punchy"]),
    ]
    for expected, arguments, words in share_of_refusals(cases, lambda case: case[1]):
        arguments = [str(a) for a in arguments]
        if arguments[0] == "compare" and "-o" not in arguments:
            arguments += ["-o", str(out)]
        done = subprocess.run([str(bench.command), *arguments], capture_output=True, text=True, check=False)
        ok = done.returncode == expected and done.stderr.startswith("tonewright: ") and done.stderr.count("\n") == 1
        ok = ok and all(word in done.stderr for word in words) and not out.exists()
        report.check(f"error: {' '.join(Path(a).name for a in arguments)}", ok,
                           f"exit {done.returncode}: {done.stderr}")
