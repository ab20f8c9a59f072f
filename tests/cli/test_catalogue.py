# SPDX-License-Identifier: Apache-2.0
"""The operator catalogue of `tonewright_tools catalogue`: nothing is missing, and what it shows is so.

Plots are read back from their SVG files and held to `tonewright eval`, to formulas written here, and distances between
dialects to a recomputation in NumPy: samples, code values and dE ITP. The committed catalogue is the one that is
written here, as tests/parity/test_artifacts.py has it.
"""

import json
import re
import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from pictures import PROJECT, evaluate, run
from test_artifacts import compare_folder, page_differs

SVG = "{http://www.w3.org/2000/svg}"
MID_GRAY = 0.18
WEIGHTS = np.array([0.2126, 0.7152, 0.0722])
ORANGE, GREEN, BLUE = np.array([1, 0.25, 0.02]), np.array([0.05, 1, 0.1]), np.array([0.02, 0.06, 1])

WIDTH = 640
# Of a file, half of it the strokes of its words; more only for a plot of many variants.
BYTES, BYTES_A_VARIANT = 40 * 1024, 4000  # Hable has eight curves
# Pixels: points have two decimals; between them a line may be 0.2 off, and a point is 0.005 off itself.
POINT, LINE = 0.006, 0.21
# Code values of lines that count as one.
SAME = 0.001
# Half a unit of the last digit printed, and what nine digits of `eval` leave.
DIGITS = 1e-6


# --------------------------------------------------------------------------------------------------
# Light and color


def encode(light):
    """sRGB, IEC 61966-2-1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)


def decode(code):
    return np.where(code <= 0.04045, code / 12.92, ((np.maximum(code, 0) + 0.055) / 1.055) ** 2.4)


def gray_level(code):
    """Code value of the gray that has the luminance of each color."""
    return encode(decode(code) @ WEIGHTS)


def scene(stops):
    return MID_GRAY * 2.0 ** np.asarray(stops, float)


def to_xyz(red, green, blue, white):
    xyz = np.array([[x / y, 1, (1 - x - y) / y] for x, y in (red, green, blue)]).T
    wx, wy = white
    return xyz * np.linalg.solve(xyz, [wx / wy, 1, (1 - wx - wy) / wy])


D65, ACES_WHITE = (0.3127, 0.3290), (0.32168, 0.33767)
REC709 = to_xyz((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), D65)
REC2020 = to_xyz((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), D65)
AP1 = to_xyz((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), ACES_WHITE)
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def adaptation(source, target):
    cones = [BRADFORD @ [x / y, 1, (1 - x - y) / y] for x, y in (source, target)]
    return np.linalg.inv(BRADFORD) @ np.diag(cones[1] / cones[0]) @ BRADFORD


def pq_encode(nits):
    """SMPTE ST 2084."""
    m1, m2, c1, c2, c3 = 2610 / 16384, 2523 / 32, 3424 / 4096, 2413 / 128, 2392 / 128
    y = (np.maximum(nits, 0) / 10000) ** m1
    return ((c1 + c2 * y) / (1 + c3 * y)) ** m2


def itp(code, peak_nits=100):
    """ITU-R BT.2124 of sRGB code values; T is half of Ct."""
    light = decode(code) @ (np.linalg.inv(REC2020) @ REC709).T * peak_nits
    lms = light @ (np.array([[1688, 2146, 262], [683, 2951, 462], [99, 309, 3688]]) / 4096).T
    ictcp = np.array([[2048, 2048, 0], [6610, -13613, 7003], [17933, -17390, -543]]) / 4096
    return pq_encode(lms) @ ictcp.T * [1, 0.5, 1]


class SplitMix64:
    """Steele et al. 2014: the samples' random numbers, many at a time."""

    def __init__(self, seed):
        self.state = np.uint64(seed)

    def uniform(self, low, high, shape):
        count = int(np.prod(shape))
        step = np.uint64(0x9E3779B97F4A7C15)
        with np.errstate(over="ignore"):
            z = self.state + step * np.arange(1, count + 1, dtype=np.uint64)
            self.state = z[-1]
            z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
            z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
            z ^= z >> np.uint64(31)
        return (low + (high - low) * (z >> np.uint64(11)).astype(float) * 2.0**-53).reshape(shape)


def non_negative_samples():
    """The sample set of docs/conventions.md in linear Rec.709, without colors that have a negative channel."""
    grays = np.repeat(np.concatenate([[0], scene(np.arange(-768, 769) / 64)])[:, None], 3, axis=1)
    parts = [grays]
    for matrix in (np.eye(3), np.linalg.inv(REC709) @ REC2020,
                   np.linalg.inv(REC709) @ adaptation(ACES_WHITE, D65) @ AP1):
        for exposure in (-6, -2, 0, 3, 6):
            cube = np.stack(np.meshgrid(*[np.arange(33)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
            parts.append(cube * (2.0**exposure / 32) @ matrix.T)
    generator = SplitMix64(20021)
    colors = 2.0 ** generator.uniform(-16, 12, (100000, 3))
    tenth = np.arange(0, 100000, 10)
    colors[tenth, tenth // 10 % 3] = 0
    parts += [colors, 2.0 ** generator.uniform(-148, -10, (5000, 3))]
    rgb = np.concatenate(parts).astype(np.float32)
    return rgb[(rgb >= 0).all(axis=1)]


# --------------------------------------------------------------------------------------------------
# The page and the plots


class Plot:
    """An SVG file: its lines by id, in stops and values."""

    def __init__(self, path):
        self.root = ElementTree.parse(path).getroot()
        self.texts = [text.text for text in self.root.iter(SVG + "text")]
        numbers = [float(x) for x in re.findall(r"-?\d+\.?\d*", self.root.findtext(SVG + "desc") or "")]
        self.lines = {}
        if len(numbers) < 6:
            return
        self.left, self.stop, _, self.lowest = numbers[:4]
        scales = [numbers[4:6], numbers[6:8]]
        groups = [g for g in self.root.iter(SVG + "g") if g.find(SVG + "polyline") is not None]
        # Each line of a plot of many has a small graph, too.
        self.small = {line.get("id") for g in groups for line in g if line.get("id").startswith("small-")}
        for index, group in enumerate(g for g in groups if not g[0].get("id").startswith("small-")):
            zero, self_unit = scales[index]
            for line in group.iter(SVG + "polyline"):
                points = np.array([p.split(",") for p in line.get("points").split()], float)
                stops = (points[:, 0] - self.left) / self.stop - self.lowest
                self.lines[line.get("id")] = (stops, (zero - points[:, 1]) / self_unit, self_unit)

    def crossed_words(self):
        """Words that a curve goes through. A letter is about 5.5 pixels wide and 8 high."""
        curves = [np.array([p.split(",") for p in line.get("points").split()], float)
                  for line in self.root.iter(SVG + "polyline")]
        crossed = []
        for text in self.root.iter(SVG + "text"):
            width = 5.5 * len(text.text)
            left = float(text.get("x")) - width * {"c": 0.5, "e": 1}.get((text.get("class") or "-").split()[-1], 0)
            bottom = float(text.get("y"))
            at = np.linspace(left, left + width, 50)
            for curve in curves:
                y = np.interp(at, curve[:, 0], curve[:, 1], left=np.nan, right=np.nan)
                if ((y > bottom - 8) & (y < bottom)).any():
                    crossed.append(text.text)
                    break
        return crossed

    def patches(self):
        """Rows of (first, last, color)."""
        rows = []
        for group in self.root.iter(SVG + "g"):
            if group.get("transform"):
                row = []
                for patch in group.iter(SVG + "path"):
                    start, width = map(float, re.fullmatch(r"M([\d.]+) 0h([\d.]+)", patch.get("d")).groups())
                    color = [int(patch.get("stroke")[i:i + 2], 16) for i in (1, 3, 5)]
                    row.append((start, start + width, color))
                rows.append(row)
        return rows


def variants_of(operator):
    """(id of the line, arguments of eval, words that the page must have)."""
    name = operator["id"]
    yield "default", [name], f"(`{name}`)"
    for preset in operator["presets"]:
        yield preset["id"], [f"{name}:{preset['id']}"], f"`{name}:{preset['id']}`"
    for look in operator["looks"]:
        yield "look-" + look["id"], [name, "--look", look["id"]], f"* Look `{look['id']}`"


def read_pages(folder):
    """Texts by name: the index, each operator's page, and the part of each group of dialects."""
    pages = {path.stem: path.read_text() for path in (folder / "operators").glob("*.md")}
    parts = re.split(r'^<a id="(dialects_\w+)"></a>\n', pages.get("dialects", ""), flags=re.M)
    return {"index": (folder / "operators.md").read_text(), **pages, **dict(zip(parts[1::2], parts[2::2]))}


# A catalogue that the command writes anew: of an operator that is gone, and of somebody else.
OLD = {"curves/MANIFEST.csv": "path,shows\nold.svg,old\n", "curves/old.svg": "of an operator that is gone",
       "curves/own.txt": "of somebody else", "operators/MANIFEST.csv": "path,shows\nold.md,old\n",
       "operators/old.md": "of an operator that is gone", "MANIFEST.csv": "path\nown.md\n", "own.md": "of somebody else"}


def listed(config):
    return json.loads(run(config.getoption("--tonewright").resolve(), "list", "--json"))["operators"]


def groups_of(operators):
    """Name -> operators that are dialects of one."""
    groups = {}
    for op in operators:
        groups.setdefault(op["dialects"], []).append(op)
    return {name: members for name, members in groups.items() if name and len(members) > 1}


def pytest_generate_tests(metafunc):
    """A test for each operator, and for each group of dialects."""
    if "operator" in metafunc.fixturenames:
        metafunc.parametrize("operator", listed(metafunc.config), ids=lambda op: op["id"])
    if "group" in metafunc.fixturenames:
        metafunc.parametrize("group", groups_of(listed(metafunc.config)))


@pytest.fixture(scope="module")
def operators(request):
    return listed(request.config)


@pytest.fixture(scope="module")
def groups(operators):
    return groups_of(operators)


@pytest.fixture(scope="module")
def written(command, tmp_path_factory):
    """The folder of a fresh catalogue, and the files of OLD that are still there."""
    folder = tmp_path_factory.mktemp("catalogue").resolve() / "docs"
    for name, text in OLD.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    run(f"{command}_tools", "catalogue", "-o", folder)
    kept = {name for name in OLD if (folder / name).exists()}
    (folder / "curves" / "own.txt").unlink()
    return folder, kept


@pytest.fixture(scope="module")
def folder(written):
    return written[0]


@pytest.fixture(scope="module")
def pages(folder):
    return read_pages(folder)


def test_old_files(report, written):
    report.check("page and plot of an operator that is gone are removed, nothing else",
                 OLD.keys() - written[1] == {"curves/old.svg", "operators/old.md"}, sorted(written[1]))


def slug(name):
    return re.sub("[^a-z0-9]+", "_", name.lower()).strip("_")


def test_pages(report, folder, pages, operators, groups):
    index, bad = pages["index"], []
    for op in operators:
        name = op["id"]
        text = pages.get(name, "")
        wanted = [f"# {op['title']} (`{name}`)\n", op["character"][0].upper() + op["character"][1:], op["source"], op["license"], op["negatives"],
                  op["output"], op["working_primaries"], f"`{op['view']}`", f"(../curves/{name}.svg)",
                  "* Measured on sRGB", "(../operators.md)"]
        wanted += op["warnings"] + [f"| `{p['name']}` |" for p in op["parameters"]]
        wanted += [words for _, _, words in variants_of(op)]
        bad += [f"{name}: {words}" for words in wanted if words not in text]
        row = rf'^\| <a id="{name}"></a>\[[^\n]*\]\(operators/{name}\.md\)<br>`{name}` \| .* \| \d\.\d+ \| \d\.\d+ \|$'
        if not re.search(row, index, re.M):
            bad.append(f"{name}: its row of the index")
    report.check(f"the pages have all about {len(operators)} operators", not bad, bad[:5])
    bad = []
    for name, members in groups.items():
        text = pages.get(f"dialects_{slug(name)}", "")
        names = [words for op in members for words in [op["id"], *(f"{op['id']}:{p['id']}" for p in op["presets"])]]
        wanted = [f"## {name}\n", f"(../curves/dialects_{slug(name)}.svg)", f"(../curves/dialects_{slug(name)}_colors.svg)"]
        wanted += [f"[`{n}`]({n.split(':')[0]}.md)" for n in names]
        bad += [f"{name}: {words}" for words in wanted if words not in text]
        pairs = len(re.findall(r"^\| \w+ `[^`]+`, \w+ `[^`]+` \|", text, re.M))
        if pairs != len(names) * (len(names) - 1) // 2:
            bad.append(f"{name}: {pairs} pairs of {len(names)} dialects")
        anchor = f"dialects_{slug(name)}"
        if f'<a id="{anchor}"></a>**{name}** | [differences](operators/dialects.md#{anchor})' not in index:
            bad.append(f"{name}: its row of the index")
    report.check(f"the page has all about {len(groups)} groups of dialects", not bad, bad[:5])
    paths = [folder / "operators.md", *sorted((folder / "operators").glob("*.md"))]
    anchors = {path: {*re.findall(r'<a id="([^"]+)"', path.read_text()), *(
        heading.lower().replace(" ", "-") for heading in re.findall(r"^#+ ([\w ]+)$", path.read_text(), re.M))} for path in paths}
    links, lost, plots = 0, [], set((folder / "curves").glob("*.svg"))
    linked = set()
    for path in paths:
        for address in re.findall(r"\]\(([^):]+)\)", path.read_text()):
            name, _, anchor = address.partition("#")
            target = (path.parent / name).resolve() if name else path
            links += 1
            if target.suffix == ".svg":
                linked.add(target)
            elif target in anchors:
                lost += [f"{path.name}: {address}"] if anchor and anchor not in anchors[target] else []
            elif not (PROJECT / "docs" / target.relative_to(folder)).exists():  # a page that is not generated
                lost.append(f"{path.name}: {address}")
    report.check(f"{links} links of the pages lead somewhere", links > len(operators) and not lost, lost[:5])
    report.check("every plot is on a page, and no other", linked == plots, sorted(linked ^ plots)[:5])
    manifest = [line.split(",")[0] for line in (folder / "operators" / "MANIFEST.csv").read_text().splitlines()[1:]]
    report.check("the manifest names the pages", sorted(manifest) == sorted(path.name for path in paths[1:]))
    # Looks and presets that are meant to differ are not dialects, and an operator alone is none.
    report.check("as many groups as there are", len(re.findall('<a id="dialects_', pages["dialects"])) == len(groups))


def test_files(report, folder, operators, groups):
    expected = {f"{op['id']}.svg" for op in operators}
    for name in groups:
        expected |= {f"dialects_{slug(name)}.svg", f"dialects_{slug(name)}_colors.svg"}
    there = {path.name for path in (folder / "curves").glob("*.svg")}
    report.check(f"{len(expected)} plots", there == expected, sorted(there ^ expected)[:5])
    manifest = [line.split(",")[0] for line in (folder / "curves" / "MANIFEST.csv").read_text().splitlines()[1:]]
    report.check("the manifest names the plots", sorted(manifest) == sorted(there))
    counts = {op["id"]: len(list(variants_of(op))) for op in operators}
    for name, members in groups.items():
        count = sum(1 + len(op["presets"]) for op in members)
        counts |= {f"dialects_{slug(name)}": count, f"dialects_{slug(name)}_colors": count}
    bad = []
    for path in sorted((folder / "curves").glob("*.svg")):
        data = path.read_text()
        try:
            root = Plot(path).root
        except (ElementTree.ParseError, AttributeError, ValueError) as error:
            bad.append(f"{path.name}: {error}")
            continue
        box = [float(x) for x in root.get("viewBox").split()]
        if box[2] != WIDTH or [float(root.get("width")), float(root.get("height"))] != box[2:]:
            bad.append(f"{path.name}: is {box}")
        if len(data.encode()) > max(BYTES, BYTES_A_VARIANT * counts.get(path.stem, 0)):
            bad.append(f"{path.name}: has {len(data.encode())} bytes")
        if re.search(r"<script|href|url\(|@import|<image", data):
            bad.append(f"{path.name}: needs something from elsewhere")
        background = root.find(SVG + "rect")
        if background is None or (background.get("width"), background.get("fill")) != ("100%", "#fff"):
            bad.append(f"{path.name}: has no background")
        ids = re.findall(r' id="([^"]+)"', data)
        if len(ids) != len(set(ids)):
            bad.append(f"{path.name}: ids appear twice")
        for _, values, _ in Plot(path).lines.values():
            if not np.isfinite(values).all():
                bad.append(f"{path.name}: a value is not finite")
    report.check("plots are well-formed, 640 wide, small, complete in themselves", not bad, bad[:5])
    plots = {path.name: Plot(path) for path in sorted((folder / "curves").glob("*.svg"))}
    crossed = {name: words for name, plot in plots.items() if (words := plot.crossed_words())}
    # Both palettes of false color rise and fall over the whole plot, which leaves no free place.
    crossed.pop("false_color.svg", None)
    report.check("no curve goes through words", not crossed, crossed)
    blender = plots["agx_blender.svg"]
    report.check("AgX Blender's looks have small graphs",
                 {"small-look-punchy", "small-look-very_low_contrast"} <= blender.small, blender.small)


def evaluate_all(command, arguments, parts):
    """Code values of several sets of colors through one call of the command."""
    parts = [np.asarray(part, float).reshape(-1, 3) for part in parts]
    codes = evaluate(command, np.concatenate(parts), *arguments)
    return np.split(codes, np.cumsum([len(part) for part in parts])[:-1])


def of_scene(stops, color):
    return scene(stops)[:, None] * color


@pytest.mark.share(2)
def test_operator(report, command, folder, pages, operator):
    """Every line and patch of a plot, and the figures of its row and section."""
    name = operator["id"]
    plot = Plot(folder / "curves" / f"{name}.svg")
    text = pages[name]
    problems = [] if "default" in plot.lines else ["has no line `default`"]
    grid = np.linspace(-10, 10, 541)  # half a pixel apart, twice: what a line knows
    whole = np.arange(-10, 11)
    none = np.array([])

    def level_errors(line, codes_at_points, codes_at_grid):
        stops, values, unit = plot.lines[line]
        return (np.abs(values - codes_at_points).max() * unit,
                np.abs(np.interp(grid, stops, values) - codes_at_grid).max() * unit)

    # Everything that is asked of the operator with its defaults, in one call.
    measured = re.search(r"^\* Measured on sRGB: 0\.18 → (\S+), 1 → ([\d.]+);.*$", text, re.M)
    ends = [(found[0], float(found[1]), level)
            for pattern, level in ((r"black below (\S+) stops", 0.5 / 255), (r"white from (\S+) stops", 254.5 / 255))
            for found in re.finditer(pattern, measured[0])]
    channels = [(prefix + channel, i, color) for prefix, color in (("", ORANGE), ("gray-", np.ones(3)))
                for i, channel in enumerate(("red", "green", "blue"))]
    if not operator["is_diagnostic"]:
        problems += [f"has no line `{channel}`" for channel, _, _ in channels[:3] if channel not in plot.lines]
    channels = [channel for channel in channels if channel[0] in plot.lines]
    patch_colors = (np.ones(3), ORANGE, BLUE)
    first, levels, known, sides, *rest = evaluate_all(command, [name], [
        of_scene(plot.lines.get("default", (none,))[0], np.ones(3)), of_scene(grid, np.ones(3)),
        np.array([[MID_GRAY] * 3, [1] * 3]),
        # One digit after the point; where a curve jumps, only the sides are known.
        of_scene([stops + side for _, stops, _ in ends for side in (-0.051, 0.051)], np.ones(3)),
        *(of_scene(whole, color) for color in patch_colors),
        *(of_scene(plot.lines[channel][0], color) for channel, _, color in channels)])
    patches, channel_codes = rest[:3], rest[3:]

    drawn = {"default": gray_level(levels)}
    points = between = 0.0
    if "default" in plot.lines:
        points, between = level_errors("default", gray_level(first), drawn["default"])
    for (channel, i, _), codes in zip(channels, channel_codes):
        points = max(points, np.abs(plot.lines[channel][1] - codes[:, i]).max() * plot.lines[channel][2])
    apart = 0.0
    for line, arguments, _ in list(variants_of(operator))[1:]:
        at_points, at_grid = map(gray_level, evaluate_all(command, arguments, [
            of_scene(plot.lines.get(line, (none,))[0], np.ones(3)), of_scene(grid, np.ones(3))]))
        if line in plot.lines:
            errors = level_errors(line, at_points, at_grid)
            points, between = max(points, errors[0]), max(between, errors[1])
            drawn[line] = at_grid
        else:
            apart = max(apart, min(np.abs(at_grid - other).max() for other in drawn.values()))
        label = "look " + line[5:] if line.startswith("look-") else ":" + line
        if not any(label in (words or "") for words in plot.texts):
            problems.append(f"{label} is in no label")
    report.bound(f"{name}: points of the lines, in pixels", points, POINT)
    report.bound(f"{name}: between them", between, LINE)
    report.bound(f"{name}: lines left out lie on others, in code values", apart, SAME)
    report.check(f"{name}: every variant is in the plot", not problems, problems)

    off = 0.0
    for row, codes in zip(plot.patches(), patches):
        shown = np.zeros((21, 3))
        for start, end, rgb in row:
            shown[int(np.floor(start)):int(np.ceil(end))] = rgb
        off = max(off, np.abs(shown - 255 * codes).max())
    report.check(f"{name}: patches", len(plot.patches()) == 3 and off <= 0.5 + DIGITS, f"{off} codes of 8 bits")

    row = re.search(rf"^\|.*\(operators/{name}\.md\)<br>.* \| (\S+) \| (\S+) \|$", pages["index"], re.M)
    figures = np.array([*row.groups(), *measured.groups()], float)
    report.bound(f"{name}: figures of the text", np.abs(figures - [*gray_level(known)] * 2).max(), 5e-4 + DIGITS)
    for (words, _, level), (low, high) in zip(ends, gray_level(sides).reshape(-1, 2)):
        report.check(f"{name}: {words}", low <= level <= high, f"{low} and {high}, expected {level} between")


def test_formulas(report, folder):
    """Plots against formulas of the papers, not the program's own evaluation."""
    for name, line, formula in (("clamp", "default", lambda x: np.minimum(x, 1)),
                                ("reinhard", "default", lambda x: x / (1 + x)),
                                ("reinhard_extended", "default", lambda x: np.minimum(x * (1 + x / 16) / (1 + x), 1))):
        plot = Plot(folder / "curves" / f"{name}.svg")
        stops, values, unit = plot.lines[line]
        report.bound(f"{name}: the formula", np.abs(values - encode(formula(scene(stops)))).max() * unit, POINT)
        for i, channel in enumerate(("red", "green", "blue")):
            stops, values, unit = plot.lines[channel]
            shown = encode(formula(scene(stops) * ORANGE[i]))
            report.bound(f"{name}: the formula, {channel}", np.abs(values - shown).max() * unit, POINT)


@pytest.mark.share(2)
def test_group(report, command, folder, pages, groups, group):
    """Lines, patches, rows of one group of dialects."""
    names = [f"{op['id']}{preset}" for op in groups[group] for preset in ["", *(":" + p["id"] for p in op["presets"])]]
    text = pages[f"dialects_{slug(group)}"]
    plot = Plot(folder / "curves" / f"dialects_{slug(group)}.svg")
    chart = Plot(folder / "curves" / f"dialects_{slug(group)}_colors.svg")
    letters = dict(re.findall(r"^\| \*\*(\w+)\*\* \| \[`([^`]+)`\]", text, re.M))
    report.check(f"{group}: a letter for every dialect", sorted(letters.values()) == sorted(names), letters)
    stops = np.linspace(-10, 10, 541)
    colors = (ORANGE, GREEN, BLUE)
    gray, known, codes = {}, {}, {}
    for name in names:
        gray[name], known[name], *codes[name] = evaluate_all(command, [name], [
            of_scene(stops, np.ones(3)), np.array([MID_GRAY, 1, 4])[:, None] * np.ones(3),
            *(of_scene([-2, 0, 2, 4, 6], color) for color in colors)])
        gray[name] = gray_level(gray[name])
    mean = np.mean(list(gray.values()), axis=0)
    worst = difference = off = figures = 0.0
    rows = chart.patches()
    for number, (letter, name) in enumerate(letters.items()):
        if letter in plot.lines:
            at, values, unit = plot.lines[letter]
            worst = max(worst, np.abs(np.interp(stops, at, values) - gray[name]).max() * unit)
            at, values, unit = plot.lines[letter + "-difference"]
            shown = np.interp(stops, at, values)
            difference = max(difference, np.abs(shown - 255 * (gray[name] - mean)).max() * unit)
        else:
            report.check(f"{group}: {letter} lies on a line", min(
                np.abs(gray[name] - gray[letters[other]]).max() for other in letters if other in plot.lines) < SAME
                and any(re.search(rf"\b{letter}\b", words or "") for words in plot.texts))
        for block, expected in enumerate(codes[name]):
            for start, end, rgb in rows[block * len(letters) + number]:
                off = max(off, np.abs(255 * expected[int(start):int(end)] - rgb).max())
        found = re.search(rf"^\| \*\*{letter}\*\* .* \| (\S+) \| (\S+) \| (\S+) \|$", text, re.M)
        figures = max(figures, np.abs(np.array(found.groups(), float) - gray_level(known[name])).max())
    report.bound(f"{group}: figures of the rows", figures, 5e-4 + DIGITS)
    report.bound(f"{group}: lines, in pixels", worst, LINE)
    report.bound(f"{group}: differences, in pixels", difference, LINE)
    report.check(f"{group}: patches", off <= 0.5 + DIGITS, f"{off} codes of 8 bits")


@pytest.mark.share(3)
def test_distances(report, command, pages, groups):
    """Figures of a pair, recomputed: own samples, `tonewright eval`, own dE ITP.

    One pair is as good as all: what is measured does not know which operators it is of. Half a million colors through `eval` take
    seconds.
    """
    name = "AgX" if "AgX" in groups else next(iter(groups))
    a, b = [op["id"] for op in groups[name][:2]]
    samples = non_negative_samples()
    count = int(re.search(r"measured on the (\d+) colors", pages["dialects"])[1])
    # Colors on the hull of a wide gamut: rounding decides which have a channel below 0.
    report.bound("distances: as many samples", abs(count - len(samples)) / len(samples), 1e-4)
    code = [evaluate(command, samples, name) for name in (a, b)]
    difference = 255 * np.abs(code[0] - code[1]).max(axis=1)
    delta_e = 720 * np.linalg.norm(itp(code[0]) - itp(code[1]), axis=1)
    expected = [difference.max(), np.percentile(difference, 99.9), difference.mean(), delta_e.max(), delta_e.mean()]
    found = re.search(rf"^\| \w+ `{a}`, \w+ `{b}` \| (\S+) \| (\S+) \| (\S+) \| (\S+) \| (\S+) \|$",
                      pages[f"dialects_{slug(name)}"], re.M)
    for what, shown, value, digit in zip(("max", "99.9 %", "mean", "dE max", "dE mean"), map(float, found.groups()),
                                         expected, (0.1, 0.1, 0.01, 0.1, 0.01)):
        # Half of the last digit, and the few samples that may be others.
        report.bound(f"{a}, {b}: {what} {shown}, recomputed {value:.4f}", abs(shown - value),
                     0.5 * digit + 1e-3 * value)


def test_committed(report, folder):
    """The files of docs/ equal those that the command writes. `./run artifacts` writes them again."""
    committed = PROJECT / "docs"
    if not (committed / "curves").is_dir():
        pytest.skip("docs/curves is not in the source folder; `./run artifacts` writes it")
    compare_folder(report, committed / "curves", folder / "curves")
    names = {path.name for side in (committed, folder) for path in (side / "operators").iterdir()}
    for name in ["operators.md", *(f"operators/{name}" for name in sorted(names))]:
        texts = [(side / name).read_text() if (side / name).is_file() else "" for side in (committed, folder)]
        difference = page_differs(*texts) if all(texts) else f"is only in {'the command' if texts[1] else 'docs/'}"
        report.check(f"docs/{name}", difference is None, difference)


def test_errors(report, command, scratch):
    (scratch / "file").write_text("")
    for what, line, code, words in (
            ("the old option", [command, "list", "--catalogue", scratch / "new"], 2, "use build/release/bin/tonewright_tools catalogue -o"),
            ("a file as the folder", [f"{command}_tools", "catalogue", "-o", scratch / "file"], 3, str(scratch / "file")),
            ("no folder", [f"{command}_tools", "catalogue"], 2, "catalogue: -o is missing; expected -o FOLDER"),
            ("another tool", [f"{command}_tools", "catalog"], 2, "did you mean catalogue?"),
            ("the old command", [command, "manual"], 2, "use build/release/bin/tonewright_tools manual -o")):
        done = subprocess.run(line, capture_output=True, text=True, check=False)
        report.check(f"error: {what}", done.returncode == code and words in done.stderr
                     and done.stderr.startswith("tonewright: ") and done.stderr.count("\n") == 1
                     and not (scratch / "new").exists(), done.stderr)
