# SPDX-License-Identifier: Apache-2.0
"""The committed luts/ and ocio_config/ against fresh ones: the same files, texts and numbers.

    python3 -m pytest tests/parity/test_artifacts.py --tonewright build/release/bin/tonewright

`./run artifacts` writes them anew. Bytes may differ between compilers, C libraries and versions of OpenColorIO, in
last digits and so in content hashes; names and numbers may not. Each run writes a share of them, picked by the commit: the LUTs
of one application, and a config of a sixth of the views other than AgX and ACES 2.0. `./run test
--all` writes everything. tests/cli/test_catalogue.py compares the catalogue in docs/ in the same way. These are golden
tests: they guard against change.
"""

import csv
import re
import shutil

import numpy as np
from pictures import ALL, PROJECT, files_of, read_exr, run, share_of, skip, stack

try:
    import PyOpenColorIO as ocio
except ImportError:
    ocio = None

# Tables hold floats of double results: one libm's last digit can move a float by a unit (6e-8 of it), and where the
# operator subtracts (Hable's toe), by some more. Relative above 1: decoding curves go on to 65504 and its powers, with
# three digits beyond it.
TABLE, BEYOND_HALVES = 2e-6, 1.1e-3
# The config's cubes are whole numbers of 1e-4, or have five decimals and more, the shipped ones four; a last digit of
# libm can decide how the last is rounded. In pictures of 8 bits, how a number is.
CUBE_FIVE_DECIMALS, CUBE_FOUR_DECIMALS, BYTE = 1.6e-5, 1.1e-4, 1.01 / 255
# Nine digits of double results, of code values.
PROBE = 1e-9
# Figures in texts are measured errors, two digits, rounded up; those of exact forms are float rounding.
FIGURE_RELATIVE, FIGURE_ABSOLUTE = 0.1, 1e-6
# Coefficients and limits of the config, 15 digits: other compilers multiply matrices with other last digits.
TRANSFORM = 1e-9
# Pixels of a plot have two decimals. Where one is rounded to the other side, a line may get along with other points:
# two lines that are within 0.2 of one curve.
PIXEL, LINE = 0.011, 0.41

NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w^])")


def without_hash(text):
    """Contents that may differ between compilers: content hashes, OpenColorIO's version."""
    text = re.sub(r"id=\"tonewright-[0-9a-f]{8}\"", "id=\"tonewright-HASH\"", text)
    return re.sub(r"OpenColorIO \d+\.\d+\.\d+", "OpenColorIO VERSION", text)


def first_difference(is_, expected):
    """The words about the first character that differs."""
    at = next((i for i, (x, y) in enumerate(zip(is_, expected)) if x != y), min(len(is_), len(expected)))
    shown = [text[max(0, at - 30):at + 50].replace("\n", " ") for text in (is_, expected)]
    return f"...{shown[0]}..., expected ...{shown[1]}..."


def figures_differ(is_, expected, relative=FIGURE_RELATIVE, absolute=FIGURE_ABSOLUTE):
    """None, or what differs between two texts: words exactly, numbers within a tolerance."""
    is_, expected = without_hash(is_), without_hash(expected)
    if NUMBER.sub("#", is_) != NUMBER.sub("#", expected):
        return first_difference(NUMBER.sub("#", is_), NUMBER.sub("#", expected))
    for x, y in zip(NUMBER.findall(is_), NUMBER.findall(expected)):
        if abs(float(x) - float(y)) > relative * abs(float(y)) + absolute:
            return f"{x}, expected {y}"
    return None


def split_table(text):
    """(the lines of numbers as an array, the rest): .cube."""
    lines = text.splitlines()
    is_row = [bool(re.fullmatch(r"[-+0-9.e ]+", line)) for line in lines]
    rows = " ".join(line for line, row in zip(lines, is_row) if row).split()
    return np.array(rows, float), "\n".join(line for line, row in zip(lines, is_row) if not row)


def compare_table(report, what, committed, fresh, tolerance):
    (old, old_text), (new, new_text) = split_table(committed), split_table(fresh)
    difference = figures_differ(old_text, new_text)
    if difference or old.shape != new.shape:
        report.check(what, False, difference or f"has {old.size} numbers, expected {new.size}")
        return
    error = np.abs(old - new) / np.maximum(np.abs(new), 1)
    report.bound(f"{what} ({new.size})", error.max(initial=0), tolerance)


def read_clf(text):
    """(numbers as the table means them, which of them have one digit, the rest). One digit: nothing looks them up, or a
    clamp is behind them."""
    head, array, rest = re.fullmatch(r"(.*?<Array dim=[^>]*>)(.*?)(</Array>.*)", text, re.S).groups()
    words = array.split()
    channels = 3 if "<LUT3D" in head else int(re.search(r"dim=\"\d+ (\d)\"", head)[1])
    numbers = np.array(words, float).reshape(-1, channels)
    matrix = re.search(r"<Matrix.*?<Array dim=\"3 3\">(.*?)</Array>", rest, re.S)
    if matrix:
        numbers = numbers * np.diag(np.array(matrix[1].split(), float).reshape(3, 3))[:channels]
        rest = rest.replace(matrix[1], "")
    if "outBitDepth=\"16i\"" in head:
        numbers = numbers / 65535
    is_short = np.array([bool(re.fullmatch(r"-?\.?0*\d(e-?\d+|0*)", word)) for word in words]).reshape(-1, channels)
    return numbers, is_short, head + rest


def compare_clf(report, what, committed, fresh, tolerance):
    (old, old_short, old_text), (new, new_short, new_text) = read_clf(committed), read_clf(fresh)
    difference = figures_differ(old_text, new_text)
    if difference or old.shape != new.shape:
        report.check(what, False, difference or f"has {old.size} numbers, expected {new.size}")
        return
    error = np.abs(old - new) / np.maximum(np.abs(new), 1)
    error[np.abs(new) > 65504] *= tolerance / BEYOND_HALVES
    error[old_short & new_short & (np.abs(old - new) <= 0.51 * np.maximum(np.abs(old), np.abs(new)))] = 0
    report.bound(f"{what} ({new.size})", error.max(initial=0), tolerance)


def compare_csv(report, what, committed, fresh, tolerance, is_part):
    """Row by row; the column of hashes does not count. A part has some of the committed rows."""
    old, new = (list(csv.DictReader(text.splitlines())) for text in (committed, fresh))
    if is_part:
        keys = [name for name in ("path", "view", "display", "space") if name in new[0]]
        there = {tuple(without_hash(row[name]) for name in keys) for row in new}
        old = [row for row in old if tuple(without_hash(row[name]) for name in keys) in there]
    if len(old) != len(new):
        report.check(what, False, f"has {len(old)} rows, expected {len(new)}")
        return
    for number, (row, expected) in enumerate(zip(old, new), 2):
        for name in expected:
            if name == "content_hash" or name.startswith("within_"):  # measured, as the README has it
                continue
            difference = figures_differ(row.get(name) or "", expected[name], *tolerance)
            if difference:
                report.check(what, False, f"line {number}, {name}: {difference}")
                return
    report.check(f"{what} ({len(new)} rows)", list(old[0]) == list(new[0]))


def describe_config(path):
    """Everything that a config says, as {what: text}."""
    config = ocio.Config.CreateFromFile(str(path))
    said = {"profile": f"{config.getMajorVersion()}.{config.getMinorVersion()}",
            "name": config.getName(), "description": config.getDescription(),
            "search path": " ".join(config.getSearchPaths()),
            "roles": " ".join(f"{role}={config.getColorSpace(role).getName()}" for role in config.getRoleNames()),
            "active": f"{config.getActiveDisplays()} / {config.getActiveViews()}",
            "default view transform": config.getDefaultViewTransformName()}
    for space in config.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL):
        said[f"space {space.getName()}"] = " | ".join([
            ", ".join(space.getAliases()), space.getFamily(), space.getEncoding(), space.getDescription(),
            ", ".join(space.getCategories()), str(space.getReferenceSpaceType()), str(space.isData()),
            str(space.getTransform(ocio.COLORSPACE_DIR_TO_REFERENCE)),
            str(space.getTransform(ocio.COLORSPACE_DIR_FROM_REFERENCE))])
    for name in config.getViewTransformNames():
        transform = config.getViewTransform(name)
        said[f"view transform {name}"] = " | ".join([
            transform.getDescription(), str(transform.getTransform(ocio.VIEWTRANSFORM_DIR_FROM_REFERENCE))])
    for display in config.getDisplays():
        for view in config.getViews(display):
            said[f"view {display}: {view}"] = " | ".join([
                config.getDisplayViewTransformName(display, view),
                config.getDisplayViewColorSpaceName(display, view), config.getDisplayViewLooks(display, view),
                config.getDisplayViewDescription(display, view)])
    rules = config.getFileRules()
    for i in range(rules.getNumEntries()):
        said[f"file rule {i}"] = " | ".join([rules.getName(i), rules.getPattern(i), rules.getExtension(i),
                                             rules.getColorSpace(i)])
    return said


def compare_config(report, what, committed, fresh, is_part):
    if ocio is None:
        print(f"skipped: {what} (PyOpenColorIO is not installed; Debian: python3-pyopencolorio)")
        return
    old, new = describe_config(committed), describe_config(fresh)
    if is_part:
        old = {key: said for key, said in old.items() if key in new}
        for name in ("active",):  # names all views
            del old[name], new[name]
    different = [f"{key} is there, expected none" for key in old if key not in new]
    for key, said in new.items():
        if key not in old:
            different.append(f"{key} is missing")
            continue
        description, _, transform = said.partition("<")
        old_description, _, old_transform = old[key].partition("<")
        difference = (figures_differ(old_description, description)
                      or figures_differ(old_transform, transform, TRANSFORM, TRANSFORM))
        if difference:
            different.append(f"{key}: {difference}")
    if list(old) != list(new) and not different:
        different.append("the order is another")
    report.check(f"{what} ({len(new)} entries)", not different, "; ".join(different[:3]))


def page_differs(is_, expected):
    """None, or what differs between two catalogue pages: words and parameters exactly, measured figures by a unit of
    their last digit."""
    is_, expected = is_.splitlines(), expected.splitlines()
    for number, (line, other) in enumerate(zip(is_, expected), 1):
        if line == other:
            continue
        if line.startswith("* Measured "):
            pieces, others = (re.split(r"([-+]?\d+(?:\.\d+)?)", text) for text in (line, other))
        else:
            pieces, others = (text.split(" | ") for text in (line.removesuffix(" |"), other.removesuffix(" |")))
        if len(pieces) != len(others):
            return f"line {number}: {first_difference(line, other)}"
        for piece, figure in zip(pieces, others):
            if piece == figure:
                continue
            decimals = re.fullmatch(r"[-+]?\d+\.(\d+)", figure)
            if not decimals or not re.fullmatch(r"[-+]?\d+\.\d+", piece) or line.startswith("| `") or abs(
                    float(piece) - float(figure)) > 1.01 * 10.0 ** -len(decimals[1]):
                return f"line {number}: {piece}, expected {figure}"
    if len(is_) != len(expected):
        return f"has {len(is_)} lines, expected {len(expected)}"
    return None


def plot_differs(is_, expected):
    """None, or what differs between two plots: words and colors exactly, points by what rounding may do."""
    points = re.compile(r' points="([^"]*)"')
    difference = figures_differ(points.sub("", is_), points.sub("", expected), 0, PIXEL)
    if difference:
        return difference
    for old, new in zip(points.findall(is_), points.findall(expected)):
        (x, y), (other_x, other_y) = (np.array([p.split(",") for p in line.split()], float).T for line in (old, new))
        bound = PIXEL if np.array_equal(x, other_x) else LINE
        at = np.union1d(x, other_x)
        apart = np.abs(np.interp(at, x, y) - np.interp(at, other_x, other_y)).max()
        if not apart <= bound:
            return f"a line is {apart:.2g} pixels off, expected {bound}"
    return None


def compare_folder(report, committed, fresh, is_part=False):
    """Every file of two folders. A part has some of the committed files and rows; texts about all of them are not
    compared."""
    old, new = ({str(p.relative_to(folder)): p for p in sorted(folder.rglob("*")) if p.is_file()}
                for folder in (committed, fresh))
    report.check(f"{committed.name}: {'has these' if is_part else 'the same'} {len(new)} files",
                 set(new) <= set(old) if is_part else set(old) == set(new),
                 f"missing {sorted(set(new) - set(old))[:3]}, too many {sorted(set(old) - set(new))[:3]}")
    for name in sorted(set(old) & set(new)):
        what = f"{committed.name}/{name}"
        if name == "config.ocio":
            compare_config(report, what, old[name], new[name], is_part)
            continue
        if name.endswith(".png") or (is_part and name.endswith((".md", ".ocio"))):
            continue
        texts = old[name].read_text(), new[name].read_text()
        if name.endswith(".cube"):
            compare_table(report, what, *texts, CUBE_FOUR_DECIMALS)
        elif name.endswith((".clf", ".ctf")):
            whole = "<Matrix" in texts[1] and "<LUT3D" in texts[1]
            cube = CUBE_FOUR_DECIMALS if whole else CUBE_FIVE_DECIMALS
            compare_clf(report, what, *texts, cube if "<LUT3D" in texts[1] else TABLE)
        elif name == "probe.csv":
            compare_csv(report, what, *texts, (PROBE, PROBE), is_part)
        elif name.endswith(".csv"):
            compare_csv(report, what, *texts, (FIGURE_RELATIVE, FIGURE_ABSOLUTE), is_part)
        elif name.endswith(".svg"):
            difference = plot_differs(*texts)
            report.check(what, difference is None, difference)
        else:
            difference = figures_differ(*texts)
            report.check(what, difference is None, difference)


def compare_pictures(report, committed, fresh, scratch):
    """The PNGs of both folders, number by number; one process makes floats of all."""
    paths = sorted(p.relative_to(committed) for p in committed.rglob("*.png"))
    paths, words = [path for path in paths if (fresh / path).is_file()], []
    for number, path in enumerate(paths):
        for side, folder in (("old", committed), ("new", fresh)):
            words += [folder / path, "-d", "float", "--compression", "none", "-o", scratch / f"{number}.{side}.exr",
                      "--pop"]
    run("oiiotool", *words)
    for number, path in enumerate(paths):
        old, new = (stack(read_exr(scratch / f"{number}.{side}.exr")) for side in ("old", "new"))
        depth = (fresh / path).read_bytes()[24]  # of its header
        report.compare(f"{committed.name}/{path}", old, new, BYTE if depth == 8 else CUBE_FOUR_DECIMALS)


def test_config_again(report, command, scratch):
    """A second run into the folder of the first, of one view: which it is makes no difference."""
    folder = scratch / "again"
    write = [command, "config", "-o", folder, "--views", "hable"]
    run(*write)
    first = files_of(folder)
    report.check("config writes its files and nothing else",
                 {"config.ocio", "probe.csv", "README.md", "MANIFEST.csv"} <= set(first)
                 and all(n.startswith("luts/") and n.endswith((".clf", ".ctf")) for n in first if "/" in n),
                 list(first))
    (folder / "luts" / "old_curve.clf").write_text("stale")
    (folder / "luts" / "mine.clf").write_text("of the user")
    with open(folder / "MANIFEST.csv", "a") as manifest:
        manifest.write("luts/old_curve.clf,00000000\n../outside.txt,00000000\n")
    outside = scratch / "outside.txt"
    outside.write_text("not ours")
    run(*write)
    again = files_of(folder)
    report.check("config again: the same bytes, what it wrote before is gone, what it did not write stays",
                 again.pop("luts/mine.clf", None) == b"of the user" and again == first and outside.is_file(),
                 sorted(set(again) ^ set(first)))


def write_luts(command, committed, folder):
    """The LUTs of one application."""
    rows = csv.DictReader((committed / "MANIFEST.csv").read_text().splitlines())
    applications = sorted({row["host"] for row in rows})
    run(command, "bake", "--all", folder, "--for", share_of(applications, len(applications))[0])


def write_config(command, committed, folder):
    """A config of a sixth of the views, without AgX and ACES 2.0, whose 3D LUTs take nine tenths of the time."""
    rows = re.findall(r"^\| ([^|]+) \| [^|]+ \| (?:exact|65\^3 3D LUT) \|", (committed / "README.md").read_text(), re.M)
    slow = {"AgX", "AgX Punchy", "ACES 2.0"}
    run(command, "config", "-o", folder, "--views", ",".join(share_of([name for name in rows if name not in slow], 6)))


def test_built_in(report, command, scratch):
    """ACES 2.0 on one display: a 3D LUT, and OpenColorIO's built-in transform where the profile has it."""
    run(command, "config", "-o", scratch, "--views", "ACES 2.0", "--displays", "srgb")
    style = "ACES2065-1_to_CIE-XYZ-D65 - SDR-100nit-REC709_2.0"
    found = [name for name in ("config.ocio", "config-2.5.ocio") if style in (scratch / name).read_text()]
    report.check("config-2.5.ocio alone: ACES 2.0 is OpenColorIO's built-in transform", found == ["config-2.5.ocio"], found)


def need_artifacts(folder):
    if not folder.is_dir():
        skip(f"{folder.name} not in the source folder; `./run artifacts` writes them")


def test_luts(report, command, scratch):
    luts = PROJECT / "luts"
    need_artifacts(luts)
    if ALL:
        run(command, "bake", "--all", scratch / "luts")
    else:
        write_luts(command, luts, scratch / "luts")
    compare_folder(report, luts, scratch / "luts", not ALL)
    if shutil.which("oiiotool"):
        compare_pictures(report, luts, scratch / "luts", scratch)
    else:
        print("skipped: the PNGs of luts (oiiotool is not installed; Debian: openimageio-tools)")


def test_config(report, command, scratch):
    config = PROJECT / "ocio_config"
    need_artifacts(config)
    if ALL:
        run(command, "config", "-o", scratch / "ocio_config")
    else:
        write_config(command, config, scratch / "ocio_config")
    compare_folder(report, config, scratch / "ocio_config", not ALL)
