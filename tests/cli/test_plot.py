# SPDX-License-Identifier: Apache-2.0
"""`tonewright plot`: its lines are what `tonewright eval` gives, as SVG and as pixels."""

import re
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np
from pictures import evaluate, pq_light, read_rgb, run

SVG = "{http://www.w3.org/2000/svg}"
WEIGHTS = np.array([0.2126, 0.7152, 0.0722])
WEIGHTS_2020 = np.array([0.2627, 0.6780, 0.0593])
# Pixels: points have two decimals; between them a line may be 0.2 off.
POINT, LINE = 0.006, 0.21
USAGE, FILE = 2, 3


def decode(code):
    """sRGB, IEC 61966-2-1."""
    return np.where(code <= 0.04045, code / 12.92, ((np.maximum(code, 0) + 0.055) / 1.055) ** 2.4)


def encode(light):
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)


class Plot:
    """An SVG file: {id: (stops, values, pixels a unit)} of its lines, and the words that it shows."""

    def __init__(self, path):
        self.text = path.read_text()
        self.root = ElementTree.fromstring(self.text)
        self.words = [text.text for text in self.root.iter(SVG + "text")]
        scale = re.fullmatch(r"x = (\S+) \+ (\S+) \(stops from 0.18 \+ (\S+)\), y = (\S+) - (\S+) (.+)",
                             self.root.findtext(SVG + "desc"))
        self.left, self.stop, self.lowest, self.zero, self.unit = map(float, scale.groups()[:5])
        self.lines, self.colors, self.small = {}, {}, []
        for line in self.root.iter(SVG + "polyline"):
            points = np.array([p.split(",") for p in line.get("points").split()], float)
            if line.get("id").startswith("small-"):
                self.small.append(line.get("id"))
                continue
            self.lines[line.get("id")] = ((points[:, 0] - self.left) / self.stop - self.lowest,
                                          (self.zero - points[:, 1]) / self.unit)
            self.colors[line.get("id")] = line.get("stroke")

    def pixel(self, stops, value):
        return self.left + self.stop * (stops + self.lowest), self.zero - self.unit * value


def grays(command, stops, *arguments):
    return evaluate(command, np.repeat(0.18 * 2.0 ** np.asarray(stops)[:, None], 3, axis=1), *arguments)


def check_lines(report, command, what, plot, expected):
    """expected: {id: function of stops}"""
    report.check(f"{what}: lines {', '.join(expected)}", set(plot.lines) == set(expected), sorted(plot.lines))
    for name, function in expected.items():
        stops, values = plot.lines.get(name, (np.zeros(1), np.full(1, np.nan)))
        report.check(f"{what}: {name} goes from -10 to +10 stops", (stops[0], stops[-1]) == (-10, 10), list(stops[[0, -1]]))
        report.bound(f"{what}: points of {name}, pixels", plot.unit * np.abs(values - function(stops)).max(), POINT)
        between = np.linspace(-10, 10, 400)
        line = np.interp(between, stops, values)
        report.bound(f"{what}: {name} between them, pixels", plot.unit * np.abs(line - function(between)).max(), LINE)


def test_svg(report, command, scratch):
    operators = ["hable", "reinhard_extended:white=2.5", "agx_blender:look=punchy", "aces_hill:threejs"]
    arguments = {"hable": ["hable"], "reinhard_extended:white=2.5": ["reinhard_extended", "--set", "white=2.5"],
                 "agx_blender:look=punchy": ["agx_blender", "--look", "punchy"],
                 "aces_hill:threejs": ["aces_hill:threejs"], "no_tone_mapping": ["clamp"]}
    path = scratch / "curves.svg"
    options = ["--exposure", "0.5", "--input", "acescg"]

    def codes(name):
        return lambda stops: grays(command, stops, *arguments[name], *options)[:, 1]

    run(command, "plot", *operators, *options, "-o", path)
    plot = Plot(path)
    check_lines(report, command, "code", plot, {name: codes(name) for name in arguments})
    report.check("code: names, axes and marks", {"Hable (Uncharted 2)", "mid gray", "white", "code", "light", "0.18",
                                                 "+10", "100 %"} <= set(plot.words), plot.words)
    report.check("code: colors differ", len(set(plot.colors.values())) == len(plot.colors))
    report.check("code: nothing from elsewhere", not re.search(r"<script|href|url\(|@import|<image", plot.text))
    again = scratch / "again.svg"
    run(command, "plot", *operators, *options, "-o", again)
    report.check("the same bytes again", again.read_text() == plot.text)
    run(command, "plot", *operators, *options, "-o", path, "--y", "light", "--dark", "--width", "900", "--title", "A & B")
    plot = Plot(path)
    check_lines(report, command, "light", plot,
                {name: lambda stops, f=codes(name): 100 * decode(f(stops)) for name in arguments})
    report.check("light: title, width and a dark page", "A & B" in plot.words and plot.root.get("width") == "900" and
                 plot.root.find(SVG + "rect").get("fill") == "#1b1d20")
    run(command, "plot", *operators, *options, "-o", path, "--y", "log")
    check_lines(report, command, "log", Plot(path), {
        name: lambda stops, f=codes(name): np.maximum(np.log10(np.maximum(100 * decode(f(stops)), 1e-9)), -2)
        for name in arguments})


def test_hdr(report, command, scratch):
    path = scratch / "hdr.svg"
    arguments = ["--display", "rec2100_pq", "--reference-white", "203"]
    operators = ["aces_20", "gt7", "hable"]

    def codes(name):
        return lambda stops: grays(command, stops, name, *arguments)[:, 1]

    run(command, "plot", *operators, *arguments, "-o", path)
    plot = Plot(path)
    check_lines(report, command, "PQ code", plot, {name: codes(name) for name in operators})
    report.check("PQ code: cd/m2 at the right", {"cd/m2", "1", "100", "10000"} <= set(plot.words), plot.words)
    run(command, "plot", *operators, *arguments, "-o", path, "--y", "log")
    check_lines(report, command, "PQ log", Plot(path), {
        name: lambda stops, n=name: np.maximum(
            np.log10(np.maximum(100 * pq_light(grays(command, stops, n, *arguments)) @ WEIGHTS_2020, 1e-9)), -3)
        for name in operators})


def test_one(report, command, scratch):
    """What is said of one operator; grays that are shown in another color; lines that are the same."""
    path = scratch / "one.svg"
    run(command, "plot", "hable", "--set", "white=4", "-o", path)
    plot = Plot(path)
    value = grays(command, [0], "hable", "--set", "white=4")[0, 1]
    report.check("one: its name and where it has mid gray", {"Hable (Uncharted 2), white=4", f"0.18 → {value:.3f}"} <=
                 set(plot.words), plot.words)
    run(command, "plot", "durand_dorsey_rods", "-o", path)
    stops = np.linspace(-10, 10, 60)
    shown = grays(command, stops, "durand_dorsey_rods")
    report.check("this operator shows grays in another color", np.abs(shown - shown[:, :1]).max() > 0.01)
    check_lines(report, command, "tinted", Plot(path), {
        "durand_dorsey_rods": lambda s: encode(decode(grays(command, s, "durand_dorsey_rods")) @ WEIGHTS),
        "no_tone_mapping": lambda s: grays(command, s, "clamp")[:, 1]})
    run(command, "plot", "agx_minimal", "agx_threejs", "agx_minimal", "-o", path)
    plot = Plot(path)
    report.check("the same lines: one, with both names", set(plot.lines) == {"agx_minimal", "no_tone_mapping"}
                 and {"AgX (minimal, Wrensch), ", "AgX (three.js)"} <= set(plot.words), (list(plot.lines), plot.words))


def points_of_words(plot):
    """Points on the strokes of all words of an SVG file, in its pixels: ends of lines and arcs."""
    points = []
    for path in plot.root.iter(SVG + "path"):
        if "s" not in (path.get("class") or "").split():
            continue
        scale, _, _, flip, left, baseline = map(float, re.findall(r"-?[\d.]+", path.get("transform")))
        x = y = 0
        for letter, text in re.findall(r"([mlhva])([^mlhva]*)", path.get("d")):
            numbers = [int(n) for n in re.findall(r"-?\d+", text)]
            x += 0 if letter == "v" else numbers[0] if letter == "h" else numbers[-2]
            y += 0 if letter == "h" else numbers[-1]
            points.append((left + scale * x, baseline + flip * y))
    return np.array(points)


def test_font(report, command, scratch):
    """SVG files and pictures show the same letters at the same places: where the SVG has strokes, the picture has ink."""
    svg, png = scratch / "font.svg", scratch / "font.png"
    arguments = ["plot", "hable", "aces_13", "--title", "QWERTYUIOP asdfghjkl; (zxcvbnm) 1234567890"]
    run(command, *arguments, "-o", svg)
    run(command, *arguments, "-o", png, "--width", 1920)
    points = np.floor(points_of_words(Plot(svg)) * 3).astype(int)
    pixels = 255 * read_rgb(png, scratch)
    ink = np.array([0x24, 0x29, 0x2f])
    off = np.abs(pixels[points[:, 1], points[:, 0]] - ink).max(axis=1)
    report.check("font: letters of the SVG", len(points) > 800, len(points))
    report.bound("font: the picture has ink at the strokes of the SVG, share without", (off > 60).mean(), 0,
                 f"{points[off > 60][:5].tolist()}")
    report.check("font: and nothing at most other places", (np.abs(pixels - ink).max(axis=2) < 60).mean() < 0.05)
    run(command, "plot", "hable", "--title", "Été", "-o", svg)
    shown = [text.text for text in Plot(svg).root.iter(SVG + "text") if "v" in (text.get("class") or "").split()]
    report.check("font: words with other letters are text", shown == ["Été"], shown)


def test_pixels(report, command, scratch):
    svg, png = scratch / "same.svg", scratch / "same.png"
    operators = ["agx_sobotka", "hable", "aces_13"]
    run(command, "plot", *operators, "-o", svg)
    plot = Plot(svg)
    for width, arguments in [(1280, []), (700, ["--width", "700"])]:
        run(command, "plot", *operators, "-o", png, *arguments)
        pixels = np.round(255 * read_rgb(png, scratch)).astype(int)
        scale = width / 640
        height = round(float(plot.root.get("height")) * scale)
        report.check(f"png of {width}: {width} x {height}", pixels.shape == (height, width, 3), pixels.shape)
        for index, name in enumerate(operators):
            # Apart from the other lines and the grid.
            x, y = plot.pixel(-1.5, np.interp(-1.5, *plot.lines[name]))
            color = np.array([int(plot.colors[name][i:i + 2], 16) for i in (1, 3, 5)])
            at = pixels[int(y * scale), int(x * scale)]
            report.bound(f"png of {width}: {name} is where it is in the SVG, code values", np.abs(at - color).max(), 40,
                         f"{at}, expected {color}, {index}")
        report.check(f"png of {width}: the page is white", (pixels[-1, :, :] == 255).all())
    run(command, "plot", "hable", "-o", scratch / "same.jpg", "--dark")
    report.check("jpg: a JPEG file", (scratch / "same.jpg").read_bytes()[:3] == b"\xff\xd8\xff")


def test_many(report, command, scratch):
    """Too many lines for one graph: a small graph for each."""
    names = ["hable", "agx_sobotka", "aces_13", "reinhard", "lottes", "gt7", "uchimura", "khronos_neutral", "drago"]
    path = scratch / "many.svg"
    run(command, "plot", *names, "-o", path)
    plot = Plot(path)
    report.check("many: a small graph for each", {f"small-{n}" for n in names} <= set(plot.small), plot.small)
    run(command, "plot", *names[:4], "-o", path)
    report.check("a few: none", not Plot(path).small)


def test_pdf(report, command, scratch):
    """The words of the SVG file, which a reader finds, and its lines, as pixels."""
    svg, pdf = scratch / "same.svg", scratch / "same.pdf"
    names = ["hable", "agx_sobotka"]
    run(command, "plot", *names, "-o", svg, "--title", "A (B)")
    run(command, "plot", *names, "-o", pdf, "--title", "A (B)")
    plot = Plot(svg)
    again = scratch / "again.pdf"
    run(command, "plot", *names, "-o", again, "--title", "A (B)")
    report.check("pdf: the same bytes again", again.read_bytes() == pdf.read_bytes())
    facts = dict(re.findall(r"(?m)^([^:]+): +(.*)$", run("pdfinfo", pdf)))
    report.check("pdf: title, one page, no date", (facts["Title"], facts["Pages"]) == ("A (B)", "1") and
                 not any("Date" in name for name in facts), facts)
    size = tuple(map(float, re.findall(r"[\d.]+", facts["Page size"])))
    report.check("pdf: 640 pixels of 1/96 inch", np.allclose(size, (480, 0.75 * float(plot.root.get("height"))), atol=0.01), size)
    words = set(run("pdftotext", "-layout", pdf, "-").split())
    wanted = {word.replace("\N{MINUS SIGN}", "-") for text in plot.words for word in text.split()}
    report.check("pdf: the words of the SVG", wanted <= words, wanted - words)
    run("pdftoppm", "-png", "-r", "144", "-singlefile", pdf, scratch / "page")
    pixels = np.round(255 * read_rgb(scratch / "page.png", scratch)).astype(int)
    for name in names:
        x, y = plot.pixel(-1.5, np.interp(-1.5, *plot.lines[name]))
        color = np.array([int(plot.colors[name][i:i + 2], 16) for i in (1, 3, 5)])
        at = pixels[int(y * 1.5), int(x * 1.5)]
        report.bound(f"pdf: {name} is where it is in the SVG, code values", np.abs(at - color).max(), 60, f"{at}, expected {color}")


def test_program_alone(report, command, scratch):
    """SVG files need no OpenImageIO: the picture commands are not even there."""
    alone = scratch / "alone"
    alone.mkdir()
    shutil.copy(command, alone / "tonewright")
    done = subprocess.run([alone / "tonewright", "plot", "hable", "-o", scratch / "alone.svg"], capture_output=True,
                          text=True, check=False)
    report.check("the program alone writes SVG", done.returncode == 0 and (scratch / "alone.svg").exists(), done.stderr)
    done = subprocess.run([alone / "tonewright", "plot", "hable", "-o", scratch / "alone.png"], capture_output=True,
                          text=True, check=False)
    report.check("and needs its module for pixels", done.returncode == FILE and "picture_commands.so" in done.stderr,
                 done.stderr)


def test_errors(report, command, scratch):
    out = scratch / "bad.svg"
    (scratch / "file").write_text("")
    many = [f"reinhard_extended:white={white}" for white in range(1, 26)]
    cases = [
        (USAGE, ["hablee"], ["hablee", "did you mean hable?"]),
        (USAGE, ["hable:filmic"], ["preset is filmic"]),
        (USAGE, ["hable", "--set", "whit=4"], ["whit", "did you mean white?"]),
        (USAGE, ["hable", "aces_13", "--set", "white=4"], ["aces_13", "white"]),
        (USAGE, ["hable:white=0"], ["hable: white is 0"]),
        (USAGE, ["hable", "--look", "punchy"], ["look is punchy"]),
        (USAGE, ["hable", "--y", "lgo"], ["--y is lgo", "code, light or log"]),
        (USAGE, ["hable", "--display", "linear"], ["display is linear"]),
        (USAGE, ["hable", "--display", "native"], ["display is native"]),
        (USAGE, ["hable", "--display", "srbg"], ["did you mean srgb?"]),
        (USAGE, ["hable", "--exposure", "nan"], ["exposure is nan"]),
        (USAGE, ["hable", "--width", "10"], ["--width", "10"]),
        (USAGE, many, ["number of operators is 25", "24"]),
        (USAGE, [], ["OPERATORS is missing"]),
        (FILE, ["hable", "-o", scratch / "none" / "x.svg"], ["none"]),
        (FILE, ["hable", "-o", scratch / "file" / "x.png"], ["file"]),
        (FILE, ["hable", "-o", scratch / "x.xyz"], ["xyz"]),
        (FILE, ["hable", "-o", scratch], [str(scratch)]),
    ]
    for expected, arguments, words in cases:
        arguments = [str(a) for a in arguments]
        if "-o" not in arguments:
            arguments += ["-o", str(out)]
        done = subprocess.run([str(command), "plot", *arguments], capture_output=True, text=True, check=False)
        ok = done.returncode == expected and done.stderr.startswith("tonewright: ") and done.stderr.count("\n") == 1
        ok = ok and all(word in done.stderr for word in words) and not out.exists()
        report.check(f"error: {' '.join(arguments)[:60]}", ok, f"exit {done.returncode}: {done.stderr}")
    done = subprocess.run([str(command), "plot", "hable"], capture_output=True, text=True, check=False)
    report.check("error: no -o", done.returncode == USAGE and "-o" in done.stderr, done.stderr)
