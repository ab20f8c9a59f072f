# SPDX-License-Identifier: Apache-2.0
"""`tonewright meter` and the exposures of `apply`: figures against NumPy in double, shots against the closed form."""

import json
import os
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from pictures import read_exr, read_planes, share_of, share_of_refusals, shared_picture, skip, write_exr

pytestmark = pytest.mark.share(2)

WEIGHTS = np.array([0.2126, 0.7152, 0.0722])
FPS, UP, DOWN = 12, 3.0, 0.8
# A shot: dark, then the sun, then dark again.
LIGHT = {n: 0.05 if n < 1004 or n > 1008 else 6.0 for n in range(1001, 1013)}
EVERY = ["--frames", "1001-1012"]
METERED = ["--auto-exposure", "log-average", "--set", "divisor=1000"]
ADAPT = [*METERED, "--adapt", "--adapt-up", UP, "--adapt-down", DOWN, "--fps", FPS]


class Tool:
    def __init__(self, command, report, folder):
        self.command, self.report, self.folder = command, report, folder

    def run(self, *arguments, env=None):
        return subprocess.run([self.command, *map(str, arguments)], capture_output=True, text=True, check=False,
                              cwd=self.folder, env={**os.environ, **(env or {})})

    def meter(self, *arguments):
        done = self.run("meter", *arguments, "--json")
        if done.returncode or done.stderr:
            raise RuntimeError(f"{arguments}: {done.returncode} {done.stderr}")
        return json.loads(done.stdout)["pictures"]

    def refused(self, what, code, words, *arguments):
        done = self.run(*arguments)
        line = done.stderr
        self.report.check(what, done.returncode == code and line.count("\n") == 1 and line.startswith("tonewright: ")
                          and words in line, f"{done.returncode} {line}")


def write_shot(folder):
    for number, light in LIGHT.items():
        write_exr(folder / f"shot.{number}.exr", {c: np.full((3, 5), light, np.float32) for c in "RGB"})


@pytest.fixture(scope="module")
def folder(folder):
    """With a picture whose pixels do not all count, and a shot."""
    rgb = np.full((4, 6, 3), 0.5)
    rgb[0, 0, 1], rgb[0, 1, 2], rgb[0, 2, 0] = np.nan, np.inf, -np.inf
    rgb[1] = 8
    alpha = np.ones((4, 6))
    alpha[3], rgb[3] = 0.5, 1  # 2 when divided
    alpha[2, 5] = 0
    write_exr(folder / "a.exr", {**{c: rgb[..., i] for i, c in enumerate("RGB")}, "A": alpha})
    write_shot(folder)
    return folder.resolve()


@pytest.fixture
def tool(command, report, folder):
    return Tool(command, report, folder)


def relative(actual, expected):
    return abs(actual - expected) / abs(expected)


def luminance(planes):
    rgb = np.stack([planes[c].astype(np.float64) for c in "RGB"], -1)
    return (np.clip(rgb, 0, np.finfo(np.float32).max) @ WEIGHTS).ravel()


def check_figures(tool, report, path, name):
    """A picture's figures by their definitions, in double."""
    light = luminance(read_planes(path, tool.folder))
    lit = light[light > 0]
    found = tool.meter(path)[0]
    of = found["luminance"]
    expected = {"log_average": np.exp(np.log(1e-3 + light).mean()), "geometric_mean": np.exp(np.log(lit).mean()),
                "mean": light.mean(), "minimum": lit.min(), "maximum": light.max()}
    for figure, value in expected.items():
        report.bound(f"{name}: {figure}", relative(of[figure], value), 1e-9)
    # Bins 1 to 254 are the range, 255 is above it. More are added until at most 0.05 % lie beyond either end.
    place = np.floor((np.log2(light[light >= 1e-6]) + 8) / 11.5 * 254).astype(int) + 1
    first, last, allowed = 1, 255, 5e-4 * place.size
    lowest = 1 - int((-8 - np.log2(1e-6)) * 254 / 11.5)
    while first > lowest and (place < first).sum() > allowed:
        first -= 1
    while (place >= last).sum() > allowed:
        last += 1
    outside = ((place < first) | (place >= last)).sum()
    place = np.clip(place, first, last)
    counts = [light.size - place.size, *np.bincount(place - first, minlength=last - first + 1).tolist()]
    report.check(f"{name}: histogram", found["histogram"] == counts)
    told = found["histogram_range"]
    report.bound(f"{name}: its range", max(abs(told["low"] - ((first - 1) / 254 * 11.5 - 8)),
                                           abs(told["high"] - ((last - 1) / 254 * 11.5 - 8))), 1e-12)
    report.check(f"{name}: pixels outside", told["below"] + told["above"] == outside)
    report.bound(f"{name}: average of the histogram",
                 relative(of["histogram_average"], 2 ** ((place.mean() - 1) / 254 * 11.5 - 8)), 1e-12)
    exact = tool.meter(path, "--exact", "--percentiles", "40,95", "--method", "histogram")[0]
    by_size = np.sort(light[light >= 1e-6])
    for percent, value in exact["luminance"]["percentiles"].items():
        report.bound(f"{name}: {percent} %", relative(value, by_size[int(by_size.size * float(percent) / 100)]), 1e-15)
    rank = np.arange(by_size.size)
    low, high = 0.4 * by_size.size, 0.95 * by_size.size
    part = np.clip(np.minimum(rank + 1, high) - np.maximum(rank, low), 0, 1)
    trimmed = np.exp2((part @ np.log2(by_size)) / part.sum())
    report.bound(f"{name}: exact average between percentiles",
                 relative(exact["luminance"]["histogram_average"], trimmed), 1e-9)
    report.bound(f"{name}: its exposure", abs(exact["exposure"] - np.log2(0.18 / trimmed)), 1e-9)
    one, three = (tool.run("meter", path, "--json", "--exact", "--threads", n) for n in (1, 3))
    report.check(f"{name}: the same for any number of threads", one.stdout and one.stdout == three.stdout)
    table = tool.run("meter", path, env={"LC_ALL": "C.UTF-8"})
    report.check(f"{name}: the table fits a terminal",
                 table.returncode == 0 and all(len(line) <= 80 for line in table.stdout.splitlines()[1:])
                 and "█" in table.stdout, table.stdout)
    plain = tool.run("meter", path, env={"LC_ALL": "C"})
    report.check(f"{name}: in ASCII where the terminal has no more", plain.stdout.isascii() and "#" in plain.stdout)


def test_figures(tool, report):
    tool.run("chart", "-o", "chart.exr", "--width", "640", "--height", "360")
    check_figures(tool, report, tool.folder / "chart.exr", "chart")


def test_figures_of_a_photograph(tool, report):
    memorial = shared_picture("memorial.hdr") or skip("memorial.hdr (TONEWRIGHT_SHARED)")
    check_figures(tool, report, memorial, "memorial.hdr")


def test_pixels(tool, report):
    """Which pixels count."""
    found = tool.meter("a.exr")[0]
    report.check("NaN, infinities and pixels without cover are counted apart",
                 found["pixels"] == {"counted": 20, "black": 0, "nan": 1, "infinite": 2, "uncovered": 1},
                 found["pixels"])
    report.bound("the mean of what counts", relative(found["luminance"]["mean"], (8 * 0.5 + 6 * 8 + 6 * 2) / 20), 1e-15)
    found = tool.meter("a.exr", "--region", "1,1,3,2")[0]
    report.check("a region", found["pixels"]["counted"] == 6 and found["luminance"]["maximum"] == 8)
    report.bound("its mean", relative(found["luminance"]["mean"], 4.25), 1e-15)
    found = tool.meter("a.exr", "--no-unpremult", "--meter-region", "0,3,6,1")[0]
    report.bound("without division", relative(found["luminance"]["mean"], 1), 1e-15)


def test_ranges(tool, report):
    """A render in cd/m2, far above the usual range of the histogram, and a sun."""
    gray = np.linspace(2000, 5000, 4096, dtype=np.float32).reshape(64, 64)
    write_exr(tool.folder / "nits.exr", {c: gray for c in "RGB"})
    mean = np.log2(gray.astype(float)).mean()
    found = tool.meter("nits.exr")[0]
    # A bin counts as its lower end: 0 to 11.5/254 stops less.
    report.bound("a bright picture: average of a histogram that grows",
                 abs(np.log2(found["luminance"]["histogram_average"]) - mean + 11.5 / 508), 11.5 / 508)
    report.check("and its range", found["histogram_range"]["high"] > np.log2(4900) and found["histogram_range"]["outside"] < 1e-3)
    for command in (("meter", "nits.exr", "--json"),
                    ("apply", "nits.exr", "nits.png", "--operator", "hable", "--auto-exposure", "histogram")):
        done = tool.run(*command, "--histogram-range=-8,3.5")
        report.check(f"{command[0]}: a range that holds nothing is said", done.returncode == 0 and done.stderr.count("\n") == 1
                     and "nits.exr: 100 % of the picture lies outside the histogram's range, -8,3.5" in done.stderr,
                     done.stderr)
        done = tool.run(*command, "--histogram-range=-8,13")
        report.check(f"{command[0]}: one that holds all is not", done.returncode == 0 and not done.stderr, done.stderr)
    one, two = (tool.meter("nits.exr", "--input-units", "cd/m2", *white)[0]["luminance"]["mean"] / gray.mean(dtype=float)
                for white in ((), ("--reference-white", 203)))
    report.bound("cd/m2: 100 of them are 1", relative(one, 1 / 100), 1e-12)
    report.bound("or the reference white", relative(two, 1 / 203), 1e-12)
    tool.run("apply", "nits.exr", "white.exr", "--operator", "linear:divisor=100", "--display", "linear", "-d", "float",
             "--input-units", "cd/m2", "--reference-white", 203)
    shown = read_planes(tool.folder / "white.exr", tool.folder)["R"]
    report.bound("apply: cd/m2", np.abs(shown / (gray / 203 / 100) - 1).max(), 3e-7)  # three roundings of floats
    tool.refused("a white that nothing has", 2, "reference white is 203; expected 100", "apply", "nits.exr", "bad.png",
                 "--operator", "hable", "--input", "lin_rec709", "--reference-white", 203)
    tool.refused("units that do not exist", 2, "--input-units is nits; expected relative or cd/m2", "meter", "nits.exr",
                 "--input-units", "nits")
    # A sun of 300,000: limited after the exposure, it is as bright as it is.
    write_exr(tool.folder / "sun.exr", {c: np.full((8, 8), x, np.float32) for c, x in zip("RGB", (3e5, 2e5, 8e4))})
    mean = float(np.array((3e5, 2e5, 8e4)) @ WEIGHTS)
    for method in ("log-average", "mean", "max"):
        found = tool.meter("sun.exr", "--method", method, "--exposure-limits=-30,30")[0]
        report.bound(f"a sun: {method}", abs(found["exposure"] - np.log2((1 if method == "max" else 0.18) / mean)), 1e-8)
    tool.run("apply", "sun.exr", "shown.exr", "--operator", "reinhard", "--display", "linear", "-d", "float", "--exposure", "-17")
    shown = read_planes(tool.folder / "shown.exr", tool.folder)
    for channel, x in zip("RGB", (3e5, 2e5, 8e4)):
        x /= 2**17
        report.bound(f"a sun at -17 stops: {channel}", np.abs(shown[channel] - x / (x + 1)).max(), 1e-6)  # the engine's bound


def test_single(tool, report):
    """A picture is that of the exposure that meter names."""
    for arguments in share_of((["log-average"], ["mean", "--compensation", "-0.5"], ["histogram", "--percentiles", "10,90"],
                               ["max", "--meter-region", "0,1,6,1"]), 3):
        metering = ["--method", arguments[0], *arguments[1:]]
        stops = tool.meter("a.exr", *metering)[0]["exposure"]
        tool.run("apply", "a.exr", "auto.exr", "--operator", "hable", "-d", "float", "--exposure", "0.25",
                 "--auto-exposure", *arguments)
        tool.run("apply", "a.exr", "by_hand.exr", "--operator", "hable", "-d", "float", "--exposure", repr(stops + 0.25))
        same = all(np.array_equal(a, b, equal_nan=True) for a, b in
                   zip(read_planes(tool.folder / "auto.exr", tool.folder).values(),
                       read_planes(tool.folder / "by_hand.exr", tool.folder).values()))
        report.check(f"apply --auto-exposure {' '.join(arguments)}", same)


def render(tool, out, *arguments):
    """Frames through the plainest operator: what comes out is the exposure. Returns the bytes of the pixels by frame."""
    (tool.folder / out).mkdir()
    done = tool.run("apply", "shot.####.exr", f"{out}/f.####.exr", "--operator", "linear", "--display", "linear", "-d",
                    "float", *arguments)
    files = {int(p.name[2:6]): p for p in sorted((tool.folder / out).glob("f.*.exr"))}
    return done, {n: pixel_bytes(p) for n, p in files.items()}


def pixel_bytes(path):
    """Without the header, in which OpenImageIO notes the time."""
    return b"".join(plane.tobytes() for plane in read_exr(path).values())


def stops_of(tool, out, number):
    shown = read_planes(tool.folder / out / f"f.{number}.exr", tool.folder)["G"].astype(np.float64)
    return np.log2(shown[0, 0] * 1000 / LIGHT[number])


def closed_form(frames, start=None):
    """A(t) = T + (A0 - T) e^(-speed t), from light to light."""
    adapted, stops, before = None, {}, None
    for number in frames:
        target = (LIGHT[number] + 1e-3) / 0.18
        if adapted is None:
            adapted = target if start is None else 2.0 ** -start
        else:
            speed = UP if target > adapted else DOWN
            adapted = target + (adapted - target) * np.exp(-speed * (number - before) / FPS)
        stops[number], before = -np.log2(adapted), number
    return stops


def test_shots(tool, report):
    bound = 3e-7  # floats of 24 bits, twice rounded, as stops

    done, _ = render(tool, "each", *EVERY, *METERED)
    report.check("frames by themselves", done.returncode == 0, done.stderr)
    error = max(abs(stops_of(tool, "each", n) - np.log2(0.18 / (light + 1e-3))) for n, light in LIGHT.items())
    report.bound("each frame has the exposure of its own light", error, bound)

    done, whole = render(tool, "whole", *EVERY, *ADAPT)
    report.check("frames that adapt", done.returncode == 0 and len(whole) == 12, done.stderr)
    expected = closed_form(sorted(LIGHT))
    error = max(abs(stops_of(tool, "whole", n) - stops) for n, stops in expected.items())
    report.bound("adaptation is the closed form", error, bound)
    report.check("towards more light it is faster", abs(expected[1007] - expected[1003]) > 3)
    told = tool.meter("shot.####.exr", *EVERY, *ADAPT[4:])
    error = max(abs(p["adapted_exposure"] - expected[p["frame"]]) for p in told)
    report.bound("meter tells the same", error, 1e-6)  # 0.05 is a float in the file

    _, mixed = render(tool, "mixed", "--frames", "1009,1003,1012,1001,1005,1002,1004,1007,1006,1011,1008,1010", *ADAPT,
                      "--threads", 3)
    report.check("out of order: the same bytes", mixed == whole)
    parts = {}
    for i, part in enumerate(("1001-1004", "1005-1009", "1012-1010")):
        parts.update(render(tool, f"part{i}", "--frames", part, "--meter-frames", "1001-1012", "--meter-cache",
                            "cache.json", *ADAPT)[1])
    report.check("in parts, as on several machines: the same bytes", parts == whole)

    start = render(tool, "start", *EVERY, *ADAPT, "--adapt-start", "2", "--compensation", "-1", "--exposure", "0.5")[0]
    error = max(abs(stops_of(tool, "start", n) - (stops - 0.5)) for n, stops in closed_form(sorted(LIGHT), 2).items())
    report.bound(f"from a start, with corrections on top ({start.returncode})", error, bound)
    error = 0
    render(tool, "steps", "--frames", "1001-1012x3", *ADAPT)
    for n, stops in closed_form(range(1001, 1013, 3)).items():
        error = max(error, abs(stops_of(tool, "steps", n) - stops))
    report.bound("every third frame: three times the time", error, bound)
    render(tool, "other", *EVERY, *METERED, "--adapt", "--adapt-form", "0.98", "--fps", "30")
    adapted, error = (0.05 + 1e-3) / 0.18, 0
    for n, light in LIGHT.items():
        if n > 1001:
            adapted += ((light + 1e-3) / 0.18 - adapted) * (1 - 0.98)
        error = max(error, abs(stops_of(tool, "other", n) + np.log2(adapted)))
    report.bound("0.98^(30 dt) at 30 frames a second", error, bound)

    # Operators that take a statistic: `linear` divides by the largest luminance.
    render(tool, "picture", *EVERY)
    render(tool, "sequence", *EVERY, "--statistics", "sequence")
    render(tool, "defaults", *EVERY, "--statistics", "defaults")
    for out, divisor in (("picture", LIGHT), ("sequence", dict.fromkeys(LIGHT, 6.0)), ("defaults", dict.fromkeys(LIGHT, 4.0))):
        error = 0
        for n, light in LIGHT.items():
            shown = read_planes(tool.folder / out / f"f.{n}.exr", tool.folder)["R"][0, 0]
            error = max(error, abs(shown - min(light / divisor[n], 1)))
        report.bound(f"statistics of {out}", error, 1e-6)
    _, part = render(tool, "sequence2", "--frames", "1002", "--statistics", "sequence", "--meter-frames", "1001-1012")
    report.check("statistics of the whole shot for a part of it",
                 part[1002] == pixel_bytes(tool.folder / "sequence" / "f.1002.exr"))


def test_cache(command, report, scratch):
    tool = Tool(command, report, scratch.resolve())
    write_shot(tool.folder)
    path = tool.folder / "cache.json"
    tool.meter("shot.####.exr", *EVERY, "--meter-cache", path)
    before = path.read_bytes()
    kept = tool.meter("shot.####.exr", *EVERY, "--meter-cache", path)
    report.check("a cache that knows all stays as it is", path.read_bytes() == before)
    # A figure that no picture has: who reads it has it from the cache.
    known = json.loads(before)
    entry = known["pictures"][str(tool.folder / "shot.1003.exr")]
    entry["metering"]["luminance"]["log_average"] = 123.0
    path.write_text(json.dumps(known))
    told = tool.meter("shot.####.exr", *EVERY, "--meter-cache", path)
    report.check("what the cache has is not metered", told[2]["luminance"]["log_average"] == 123)
    told = tool.meter("shot.####.exr", *EVERY, "--meter-cache", path, "--delta", "1e-4")
    report.bound("but with other options it is", relative(told[2]["luminance"]["log_average"], 0.05 + 1e-4), 1e-7)
    path.write_text(json.dumps(known))
    os.utime(tool.folder / "shot.1003.exr", (1, 1))
    told = tool.meter("shot.####.exr", *EVERY, "--meter-cache", path)
    report.check("and so is a file of another time", told == kept)
    report.check("and the cache has it then", tool.meter("shot.1003.exr", "--meter-cache", path)[0]["luminance"]
                 == kept[2]["luminance"] and b"123.0" not in path.read_bytes())

    first = known["pictures"][str(tool.folder / "shot.1001.exr")]
    first["metering"]["luminance"]["percentiles"]["2"] = first["metering"]["luminance"]["percentiles"].pop("1")
    other_percentiles = json.dumps(known)
    for what, text in (("no JSON", "shot"), ("other JSON", "[1]"), ("another program's", '{"a": 1}'), ("cut", before[:999]),
                       ("100,000 levels deep", "[" * 100000 + "]" * 100000), ("of other percentiles", other_percentiles),
                       ("of a file with -1 bytes", re.sub(rb'"bytes": ?\d+', b'"bytes":-1', before))):
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        tool.refused(f"a cache that is {what}", 3, "is not a meter cache", "meter", "shot.1003.exr", "--meter-cache", path)
        report.check("stays", path.read_bytes() == (text if isinstance(text, bytes) else text.encode()))
    tool.refused("a cache in no folder", 3, "gone/cache.json", "meter", "shot.1003.exr", "--meter-cache", "gone/cache.json")
    tool.refused("a cache that is a folder", 3, "is a folder", "meter", "shot.1003.exr", "--meter-cache", ".")

    (tool.folder / "shot.1006.exr").unlink()
    (tool.folder / "lost").mkdir()
    tool.refused("a shot that adapts needs all its frames", 3, "shot.1006.exr", "apply", "shot.####.exr", "lost/f.####.exr",
                 "--operator", "hable", "--frames", "1010", "--meter-frames", "1001-1012", *ADAPT[:2], *ADAPT[4:])
    report.check("and writes none without", not list((tool.folder / "lost").iterdir()))
    done, files = render(tool, "without", *EVERY, *ADAPT[:4])
    report.check("without adaptation the others are made", done.returncode == 1 and len(files) == 11, done.stderr)
    for policy, count in (("skip", 11), ("hold", 12)):
        done, files = render(tool, policy, *EVERY, "--missing", policy, *ADAPT)
        report.check(f"--adapt --missing {policy}", done.returncode == 0 and len(files) == count, done.stderr)
    report.check("a held frame has the exposure of the one before", files.get(1006) == files[1005])


def test_refusals(tool, report):
    def apply(*arguments):
        return "apply", "a.exr", "bad.exr", "--operator", "hable", "--auto-exposure", "log-average", *arguments

    refused = {
        "did you mean log-average?": ("apply", "a.exr", "bad.exr", "--operator", "hable", "--auto-exposure", "log-averge"),
        "delta is 0; expected [1e-10, 1]": apply("--delta", "0"),
        "delta is nan": apply("--delta", "nan"),
        "--percentiles is 40; expected two percentages": apply("--percentiles", "40"),
        "--percentiles is 95": apply("--percentiles", "95,40"),
        "--percentiles is 101": apply("--percentiles", "0,101"),
        "--key is bright": apply("--key", "bright"),
        "key is -1": apply("--key=-1"),
        "--calibration is 9.5; expected key or 9.6": apply("--calibration", "9.5"),
        "expected none with --calibration 9.6": apply("--calibration", "9.6", "--key", "0.2"),
        "compensation is 99": apply("--compensation", "99"),
        "--exposure-limits is 5": apply("--exposure-limits", "5,-5"),
        "--meter-region is 0,0,0,5": apply("--meter-region", "0,0,0,5"),
        "--meter-region is 1,2,3,4,5": apply("--meter-region", "1,2,3,4,5"),
        "region is 90,90,5,5": apply("--meter-region", "90,90,5,5"),
        "bins is 2": apply("--histogram-bins", "2"),
        "--histogram-range is 4": apply("--histogram-range", "4,1"),
        "--auto-exposure": ("apply", "a.exr", "bad.exr", "--operator", "hable", "--delta", "0.1"),
        "--adapt is given; expected --frames RANGE with it": apply("--adapt"),
        "--adapt is given; expected --auto-exposure METHOD with it": ("apply", "shot.####.exr", "bad.####.exr", "--operator",
                                                                      "hable", "--frames", "1001", "--adapt"),
        "expected --auto-exposure or": ("apply", "a.exr", "bad.exr", "--operator", "hable", "--meter-cache", "c.json"),
        "--auto-exposure and --lut are given; expected one of them": ("apply", "a.exr", "bad.exr", "--lut", "a.cube", "--auto-exposure", "mean"),
        "expected --frames": ("apply", "a.exr", "bad.exr", "--operator", "drago", "--statistics", "sequence"),
        "did you mean sequence?": ("apply", "a.exr", "bad.exr", "--operator", "drago", "--statistics", "sequenc"),
        "expected frame 1010 of --frames": ("apply", "shot.####.exr", "bad.####.exr", "--operator", "hable", "--frames",
                                            "1009-1010", "--meter-frames", "1001-1009", "--auto-exposure", "mean"),
        "--adapt-form is fast": ("meter", "shot.####.exr", "--frames", "1-2", "--adapt", "--adapt-form", "fast"),
        "adaptation speed up is -1": ("meter", "shot.####.exr", "--frames", "1-2", "--adapt", "--adapt-up=-1"),
        "frames per second is 0": ("meter", "shot.####.exr", "--frames", "1-2", "--adapt", "--fps", "0"),
        "starting exposure is 99": ("meter", "shot.####.exr", "--frames", "1-2", "--adapt", "--adapt-start", "99"),
        "expected one name": ("meter", "a.exr", "shot.####.exr", "--frames", "1-2"),
        "lin_rec709": ("meter", "a.exr", "--input", "lin_rec708"),
    }
    with ThreadPoolExecutor(4) as pool:  # starting a program is all that takes time here
        list(pool.map(lambda item: tool.refused(f"refused: {item[0]}", 2, item[0], *item[1]),
                      share_of_refusals(refused.items(), lambda item: item[1])))
    report.check("nothing was written", not list(tool.folder.glob("bad*")))
    tool.refused("no picture", 3, "none.exr", "meter", "none.exr")
    (tool.folder / "cut.exr").write_bytes((tool.folder / "a.exr").read_bytes()[:-20])
    tool.refused("a picture that is cut", 3, "cut.exr", "meter", "cut.exr")
    done = tool.run("meter", "a.exr", "none.exr", "shot.1001.exr")
    report.check("one that is missing among others", done.returncode == 3 and "shot.1001.exr" in done.stdout
                 and done.stderr.count("\n") == 1, done.stdout + done.stderr)
