# SPDX-License-Identifier: Apache-2.0
"""`--resize` of `tonewright apply` and `compare`: the expected pixels are those of `oiiotool --resize`, executed on the same linear picture.

The test makes its pictures with OpenImageIO's Python.
"""

import subprocess

import numpy as np
import pytest
from pictures import need_program, run, share_of

pytestmark = pytest.mark.share(4)

oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO's Python module is missing (Debian: python3-openimageio)")

# The filter adds floats in the same order in both programs. The engine of `clamp` and of matrices is within 1e-6 of the
# reference (engine.h); light of this test is at most 1000.
NEAR = 2e-6
LINEAR = ["--operator", "clamp", "--display", "linear", "-d", "float", "-q"]


def write(path, pixels, names=None, kind="float", full=None, at=(0, 0), attributes=None):
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, kind)
    spec.channelnames = names or ["R", "G", "B", "A"][:count]
    spec.alpha_channel = spec.channelnames.index("A") if "A" in spec.channelnames else -1
    spec.x, spec.y = at
    if full:
        spec.full_x, spec.full_y, spec.full_width, spec.full_height = full
    for name, value in (attributes or {}).items():
        spec.attribute(name, value)
    picture = oiio.ImageBuf(spec)
    picture.set_pixels(picture.roi, np.ascontiguousarray(pixels, dtype=np.float32))
    if not picture.write(str(path)):
        raise RuntimeError(picture.geterror())
    return path


def read(path):
    """Pixels, the data window, the display window."""
    source = oiio.ImageInput.open(str(path))  # no ImageBuf: OpenImageIO's cache may hold an older file of this name
    if source is None:
        raise RuntimeError(oiio.geterror())
    pixels = source.read_image(oiio.FLOAT)
    spec = source.spec()
    source.close()
    return (pixels.reshape(spec.height, spec.width, spec.nchannels),
            (spec.x, spec.y, spec.width, spec.height), (spec.full_x, spec.full_y, spec.full_width, spec.full_height))


def header(path):
    source = oiio.ImageInput.open(str(path))
    spec = source.spec()
    source.close()
    return spec


def scene(height, width, channels=3, most=1.0):
    """Edges and noise, the same on every machine."""
    rng = np.random.default_rng(5)
    light = rng.uniform(0, most, (height, width, channels))
    light[height // 3:, width // 4:width // 2] = 0.9 * most
    light[:height // 4] *= 0.05
    return light.astype(np.float32)


class Check:
    def __init__(self, report, command, scratch):
        self.report, self.command, self.scratch = report, command, scratch

    def path(self, name):
        return self.scratch / name

    def apply(self, path, size, *options, out="result.exr"):
        run(self.command, "apply", path, self.path(out), "--resize", size, *options)
        return self.path(out)

    def oiiotool(self, path, size, *more, before=(), filter_="lanczos3"):
        run("oiiotool", path, *before, f"--resize:filter={filter_}", size, *more, "-d", "float", "-o", self.path("expected.exr"))
        return self.path("expected.exr")

    def same(self, what, is_, expected, bound=NEAR):
        """Windows, and pixels where the picture has some."""
        pixels, data, full = read(is_)
        wanted, wanted_data, wanted_full = read(expected)
        self.report.check(f"{what}: windows", (data, full) == (wanted_data, wanted_full),
                          f"is {data}, {full}; expected {wanted_data}, {wanted_full}")
        self.report.compare(what, pixels, wanted, bound)


@pytest.fixture
def c(report, command, scratch):
    need_program("oiiotool", "openimageio-tools")
    return Check(report, command, scratch)


def test_sizes(c):
    sizes = (("50x20", "50x20"), ("50", "50x0"), ("100", "100x0"), ("50%", "50%"), ("150%", "150%"), ("33.3%", "33.3%"),
             ("1", "1x1"), ("300x10", "300x10"), ("1x1", "1x1"))
    cases = [(shape, size) for shape in ((101, 67), (200, 67), (64, 64)) for size in sizes]
    for (width, height), (size, theirs) in share_of(cases, 3):
        path = write(c.path(f"scene{width}.exr"), scene(height, width))
        is_ = c.apply(path, size, *LINEAR)
        expected = c.oiiotool(path, theirs, "--clamp:min=0:max=1")
        _, data, full = read(expected)
        if data != full:  # OpenImageIO 2.4 makes the data window of 50% of 101 pixels 52 wide, the display window 51
            run("oiiotool", expected, "--crop", f"{full[2]}x{full[3]}+0+0", "-o", c.path("cut.exr"))
            expected = c.path("cut.exr")
        c.same(f"{width}x{height} to {size}", is_, expected)
    path = write(c.path("scene.exr"), scene(64, 64))
    c.apply(path, "0.001%", *LINEAR)
    c.report.check("a picture has a pixel at least", read(c.path("result.exr"))[0].shape == (1, 1, 3))


def test_operators(c):
    """The operator runs on the resized picture: also what measures it, meters it, or looks at neighborhoods."""
    path = write(c.path("scene.exr"), scene(90, 120, most=0.99))
    small = c.oiiotool(path, "40x30")
    for options in (["--operator", "hable"], ["--operator", "reinhard_extended"], ["--operator", "aces_20"],
                    ["--operator", "reinhard_local"], ["--auto-exposure", "log-average", "--operator", "hable"],
                    ["--auto-exposure", "histogram", "--operator", "hable", "--meter-region", "3,4,20,10"]):
        run(c.command, "apply", small, c.path("wanted.exr"), *options, "-d", "float", "-q")
        is_ = c.apply(path, "40x30", *options, "-d", "float", "-q")
        c.same(f"operator: {' '.join(options)}", is_, c.path("wanted.exr"), 2e-5)


def test_windows(c):
    light = scene(40, 60)
    # Inside of the display window: the rest is black, as in the padded picture.
    path = write(c.path("crop.exr"), light, at=(30, 20), full=(0, 0, 120, 100))
    for size in ("60x50", "240x200", "37x90"):
        padded = c.oiiotool(path, size, "--clamp:min=0:max=1", before=["--croptofull"])
        is_ = c.apply(path, size, *LINEAR)
        pixels, data, full = read(is_)
        wanted, _, wanted_full = read(padded)
        whole = np.zeros_like(wanted)
        whole[data[1]:data[1] + data[3], data[0]:data[0] + data[2]] = pixels
        c.report.check(f"crop to {size}: display window", full == wanted_full, f"is {full}")
        c.report.check(f"crop to {size}: data window inside", data[2] < full[2] and data[3] <= full[3], f"is {data}")
        c.report.compare(f"crop to {size}: the padded picture", whole, wanted, NEAR)
    # Beyond it: overscan stays.
    path = write(c.path("overscan.exr"), light, at=(-10, -5), full=(0, 0, 40, 30))
    is_ = c.apply(path, "50%", *LINEAR)
    pixels, data, full = read(is_)
    c.report.check("overscan stays", (data, full) == ((-5, -3, 30, 21), (0, 0, 20, 15)), f"is {data}, {full}")
    wanted, wanted_data, _ = read(c.oiiotool(write(c.path("all.exr"), light), "50%", "--clamp:min=0:max=1"))
    # The rows of this picture begin half a pixel elsewhere; columns are those of the whole picture.
    shown = c.apply(path, "50%", *LINEAR, out="result.tif")
    c.report.check("a format without overscan has the display window", read(shown)[0].shape == (15, 20, 3))
    inside = write(c.path("even.exr"), light, at=(-10, -6), full=(0, 0, 40, 28))
    c.report.compare("overscan is resized with the picture", read(c.apply(inside, "50%", *LINEAR))[0], wanted, NEAR)
    c.report.check("and has its place", read(c.path("result.exr"))[1] == (-5, -3, 30, 20), f"is {read(c.path('result.exr'))[1]}")


def test_alpha(c):
    light = scene(60, 80, 4)
    light[..., 3] = 0
    light[10:40, 20:60, 3] = 1
    light[45:50, 5:70, 3] = 0.4
    light[..., :3] *= light[..., 3:]
    path = write(c.path("alpha.exr"), light)
    pixels = read(c.apply(path, "40", *LINEAR))[0]
    wanted = read(c.oiiotool(path, "40x0"))[0]
    alpha = wanted[..., 3]
    scale = np.where(alpha > 1, 1 / np.maximum(alpha, 1), 1)[..., None]
    # Tone mapping divides by alpha, clamps to [0, 1] and multiplies.
    limited = np.clip(alpha, 0, 1)[..., None]
    color = np.clip(wanted[..., :3] * scale, 0, np.where(limited > 0, limited, 1))
    c.report.compare("associated alpha: oiiotool's, limited to [0, 1]", pixels[..., 3], limited[..., 0], NEAR)
    c.report.compare("color is filtered with its alpha", pixels[..., :3], color, NEAR)
    # Straight alpha of PNG: color that alpha hides does not bleed.
    hidden = np.zeros((32, 32, 4), np.float32)
    hidden[..., 0] = 1
    hidden[:, :15] = (0, 1, 0, 1)
    path = write(c.path("straight.png"), hidden, kind="uint16", attributes={"oiio:UnassociatedAlpha": 1})
    pixels = read(c.apply(path, "16", *LINEAR))[0]
    c.report.check("straight alpha hides its color", pixels[..., 0].max() <= NEAR, f"red is {pixels[..., 0].max()}")
    c.report.check("and what it shows stays", abs(pixels[..., 1] - pixels[..., 3]).max() <= NEAR and pixels[:, :5, 3].min() > 0.9)
    # Without alpha, color is taken as it is.
    pixels = read(c.apply(path, "16", *LINEAR, "--alpha", "ignore"))[0]
    c.report.check("--alpha ignore: hidden color is shown", pixels.shape[2] == 3 and pixels[:, 10:, 0].min() > 0.99)


def test_light(c):
    """Encoded pictures are decoded first: the mean of black and white is light 0.5, not code 0.5."""
    lines = np.zeros((64, 64, 3), np.float32)
    lines[:, ::2] = 1
    path = write(c.path("lines.png"), lines, kind="uint8")
    pixels = read(c.apply(path, "25%", *LINEAR))[0]
    linear = write(c.path("lines.exr"), lines)
    c.report.compare("sRGB is decoded before", pixels, read(c.oiiotool(linear, "25%", "--clamp:min=0:max=1"))[0], NEAR)
    # Primaries, a log and absolute light stay what they are: tone mapped in both orders.
    code = np.repeat(np.linspace(0.2, 0.6, 8, dtype=np.float32)[:, None, None], 8, axis=1) * np.float32([1, 0.9, 0.8])
    code = np.kron(code, np.ones((8, 8, 1), np.float32))
    path = write(c.path("code.exr"), code)
    for options in (["--input", "logc3"], ["--input", "lin_ap1"], ["--input", "rec2100_pq", "--reference-white", "203"],
                    ["--input", "lin_rec709", "--input-units", "cd/m2"]):
        run(c.command, "apply", path, c.path("whole.exr"), *options, "--operator", "hable", "--display", "linear",
            "-d", "float", "-q")
        is_ = read(c.apply(path, "100%", *options, "--operator", "hable", "--display", "linear", "-d", "float", "-q"))[0]
        # At its own size, Lanczos is the picture.
        c.report.compare(f"the same color: {' '.join(options)}", is_, read(c.path("whole.exr"))[0], 2e-5)


def test_lamps(c):
    """Light above 1 takes another filter: no rings, and the picture keeps its light."""
    lamp = np.full((64, 64, 3), 0.18, np.float32)
    lamp[30:34, 30:34] = 1000
    path = write(c.path("lamp.exr"), lamp)
    native = ["--operator", "reinhard", "--display", "linear", "-d", "float", "-q"]
    pixels = read(c.apply(path, "50%", *native))[0].astype(np.float64)
    light = pixels / (1 - pixels)  # of Reinhard's x/(x + 1), per channel
    run("oiiotool", path, "--minc", "1,1,1", "--resize:filter=lanczos3", "50%", path, "--subc", "1,1,1", "--maxc", "0,0,0",
        "--resize:filter=triangle", "50%", "--add", "-d", "float", "-o", c.path("expected.exr"))
    wanted = read(c.path("expected.exr"))[0]
    c.report.compare("a lamp: Lanczos to 1, a triangle beyond", pixels, wanted / (1 + wanted), NEAR)
    plain = read(c.oiiotool(path, "50%"))[0]
    c.report.check("Lanczos alone is below 0 beside it", plain.min() < -10, f"is {plain.min()}")
    c.report.check("this is not", light.min() > 0.05, f"is {light.min()}")
    far = np.ones((32, 32), bool)
    far[14:18, 14:18] = False
    c.report.check("nor brighter than the wall", light[far].max() < 0.2, f"is {light[far].max()}")
    c.report.check("Lanczos alone is", plain[far].max() > 3, f"is {plain[far].max()}")
    # x/(x + 1) in floats near 1 loses digits: 1000 has 6e-5 of itself.
    mean, whole = light.mean(), float(lamp.mean())
    c.report.check("the mean light stays", abs(mean / whole - 1) < 1e-3, f"is {mean}, expected {whole}")
    squeezed = read(c.oiiotool(path, "50%", filter_="lanczos3:highlightcomp=1"))[0]
    c.report.check("oiiotool's highlightcomp loses light", squeezed.mean() < 0.7 * whole, f"is {squeezed.mean()}")
    # The limit is the operator's 1: with the exposure, and in its units.
    dim = write(c.path("dim.exr"), lamp / 64)
    pixels = read(c.apply(dim, "50%", *native, "--exposure", "6"))[0]
    c.report.compare("a dark picture at +6 stops", pixels, wanted / (1 + wanted), NEAR)
    absolute = write(c.path("absolute.exr"), lamp * 100)
    pixels = read(c.apply(absolute, "50%", *native, "--input-units", "cd/m2"))[0]
    c.report.compare("cd/m2", pixels, wanted / (1 + wanted), NEAR)
    # One bad pixel does not spread.
    lamp[10, 10] = np.nan
    lamp[50, 50] = np.inf
    pixels = read(c.apply(write(c.path("bad.exr"), lamp), "50%", *native))[0]
    c.report.check("NaN and infinity", np.isfinite(pixels).all() and pixels[25, 25].min() > 0.99)


def test_other_channels(c):
    light = scene(20, 20, 5)
    light[..., 3] = np.arange(20)[:, None]
    light[..., 4] = 7e8  # an id
    path = write(c.path("more.exr"), light, names=["R", "G", "B", "Z", "id"])
    pixels = read(c.apply(path, "10", *LINEAR))[0]
    c.report.check("depth and ids take the nearest pixel",
                   set(np.unique(pixels[..., 3])) <= set(range(20)) and (pixels[..., 4] == np.float32(7e8)).all())
    gray = write(c.path("gray.exr"), scene(20, 30, 1), names=["Y"])
    c.same("gray", c.apply(gray, "15", *LINEAR), c.oiiotool(gray, "15x0", "--clamp:min=0:max=1"))


def test_shape(c):
    light = scene(40, 60)
    path = write(c.path("wide.exr"), light, attributes={"PixelAspectRatio": np.float32(2).item()})
    for size, ratio in (("50%", 2), ("30", 2), ("60x20", 1), ("120x40", 1)):
        is_ = header(c.apply(path, size, *LINEAR)).getattribute("PixelAspectRatio")
        c.report.check(f"pixels of shape 2, {size}", abs(is_ - ratio) < 1e-6, f"is {is_}, expected {ratio}")
    # Square pixels stay square.
    path = write(c.path("square.exr"), light)
    spec = header(c.apply(path, "60x20", *LINEAR))
    c.report.check("square pixels stay square", spec.getattribute("PixelAspectRatio") in (None, 1.0))
    # The size is that of the upright picture.
    path = write(c.path("lies.jpg"), light, kind="uint8", attributes={"Orientation": 6})
    shape = read(c.apply(path, "20x30", *LINEAR))[0].shape
    c.report.check("a picture on its side: upright", shape == (30, 20, 3), f"is {shape}")
    shape = read(c.apply(path, "20", *LINEAR))[0].shape
    c.report.check("a picture on its side: width", shape == (30, 20, 3), f"is {shape}")
    stored = read(c.apply(path, "20x30", "--operator", "hable", "-q", out="result.jpg"))[0].shape
    c.report.check("a picture on its side: JPEG keeps the tag", stored == (20, 30, 3), f"is {stored}")


def test_many(c):
    """Folders, shots, pipes."""
    folder = c.path("shot")
    folder.mkdir()
    for frame in (1, 2):
        write(folder / f"f.{frame:04d}.exr", scene(40, 60) * np.float32(frame / 2))
    wanted = []
    for frame in (1, 2):
        run(c.command, "apply", folder / f"f.{frame:04d}.exr", c.path(f"one.{frame:04d}.exr"), "--resize", "50%", "-q",
            "--operator", "hable")
        wanted.append(c.path(f"one.{frame:04d}.exr").read_bytes())
    run(c.command, "apply", folder, "-o", c.path("out"), "--resize", "50%", "-q", "--operator", "hable")
    c.report.check("a folder", [p.read_bytes() for p in sorted(c.path("out").iterdir())] == wanted)
    frames = [folder / "f.####.exr", c.path("out") / "g.####.exr", "--frames", "1-2", "--resize", "50%", "-q", "--operator",
              "hable"]
    run(c.command, "apply", *frames)
    c.report.check("a shot", [(c.path("out") / f"g.000{i}.exr").read_bytes() for i in (1, 2)] == wanted)
    before = (c.path("out") / "g.0001.exr").stat().st_mtime_ns
    run(c.command, "apply", *frames, "--skip-existing")
    c.report.check("--skip-existing keeps frames of this size", (c.path("out") / "g.0001.exr").stat().st_mtime_ns == before)
    frames[frames.index("50%")] = "25%"
    run(c.command, "apply", *frames, "--skip-existing")
    c.report.check("and replaces those of another", read(c.path("out") / "g.0001.exr")[0].shape == (10, 15, 3))
    with open(folder / "f.0001.exr", "rb") as stream:
        done = subprocess.run([c.command, "apply", "-", "-", "--format", "exr", "--resize", "50%", "-q", "--operator", "hable"],
                              stdin=stream, capture_output=True, check=True)
    c.path("piped.exr").write_bytes(done.stdout)
    c.same("a pipe", c.path("piped.exr"), c.path("one.0001.exr"), 0)
    run(c.command, "apply", folder / "f.0001.exr", c.path("timed.exr"), "--resize", "50%", "-q", "--operator", "hable",
        "--timeout", "60")
    c.report.check("--timeout", c.path("timed.exr").read_bytes() == wanted[0])
    # The cache knows the size that was metered.
    cache = c.path("cache.json")
    metered = [folder / "f.####.exr", c.path("m.####.exr"), "--frames", "1-2", "-q", "--operator", "hable", "--auto-exposure",
               "max", "--meter-cache", cache]
    pixels = []
    for size in ("100%", "10%", "100%"):
        run(c.command, "apply", *metered, "--resize", size)
        pixels.append(c.path("m.0001.exr").read_bytes())
    run(c.command, "apply", *metered[:-2], "--resize", "10%")
    c.report.check("--meter-cache", pixels[0] == pixels[2] != pixels[1] == c.path("m.0001.exr").read_bytes())


def test_refusals(c):
    path = write(c.path("scene.exr"), scene(20, 20))
    expected = "expected WxH, W or P%, such as 1920x1080, 1920 or 50%"
    cases = [([f"--resize={text}"], 2, f"tonewright: apply: --resize is {text}; {expected}")
             for text in ("0", "-5", "abc", "1e9", "50 %", "0%", "-1%", "1e2%", "x", "10x", "x10", "0x5", "5x0", "10x10x10",
                          "50%%", "nan%", "99999999999")]
    cases += [
        (["--resize=20000x20000", "--max-pixels=1e6"], 2,
         "tonewright: apply: --resize is 20000x20000; expected at most 1000000 pixels (--max-pixels)"),
        (["--resize=5000%", "--max-pixels=1e5"], 3,
         f"tonewright: {path}: cannot read: resize is 5000%: 1000 x 1000 pixels; expected at most 100000 in all (--max-pixels)"),
        (["--resize="], 2, "tonewright: apply: --resize has no value; expected --resize SIZE"),
    ]
    for options, code, message in share_of(cases, 3):
        done = subprocess.run([c.command, "apply", path, c.path("no.exr"), *options], capture_output=True, text=True, check=False)
        said = done.stderr.strip()
        c.report.check(f"refused: {' '.join(options)}", done.returncode == code and len(said.splitlines()) == 1
                       and (said == message or message.startswith("--") and "--resize" in said), f"{done.returncode}: {said}")
    c.report.check("and writes nothing", not c.path("no.exr").exists())
    for words, message in (
            (["sheet", f"A={path}", "-o", c.path("no.png"), "--resize", "50%"], "only `apply` and `compare` resize, before the operator"),
            (["compare", path, "hable", "-o", c.path("no.png"), "--resize", "5x"], f"compare: --resize is 5x; {expected}"),
            (["compare", path, "hable", "-o", c.path("no.png"), "--resize", "9x9", "--max-pixels", "400", "--split", "0.5"],
             "compare: --split is given with 1 operators"),
            (["compare", path, "hable", "-o", c.path("no.png"), "--resize", "99x99", "--max-pixels", "400"],
             "compare: --resize is 99x99; expected at most 400 pixels (--max-pixels)")):
        done = subprocess.run([c.command, *words], capture_output=True, text=True, check=False)
        c.report.check(f"refused: {words[0]} {' '.join(map(str, words[-4:]))}", done.returncode == 2 and message in done.stderr
                       and len(done.stderr.splitlines()) == 1, done.stderr)


def test_luts(c):
    """`apply --lut`: light is resized before the LUT's encoding."""
    run(c.command, "bake", "hable", "--input-encoding", "log2", "--size", "4096", "-o", c.path("hable.cube"), "-q")
    path = write(c.path("scene.exr"), scene(40, 60))
    small = c.oiiotool(path, "30x20")
    with_lut = ["--lut", c.path("hable.cube"), "-d", "float", "-q"]
    run(c.command, "apply", small, c.path("wanted.exr"), *with_lut)
    c.same("a LUT gets the resized picture", c.apply(path, "30x20", *with_lut), c.path("wanted.exr"))
    lines = np.zeros((32, 32, 3), np.float32)
    lines[:, ::2] = 1
    coded = write(c.path("lines.png"), lines, kind="uint8")
    run(c.command, "apply", c.oiiotool(write(c.path("lines.exr"), lines), "25%"), c.path("wanted.exr"), *with_lut)
    c.same("codes are decoded before", c.apply(coded, "25%", *with_lut), c.path("wanted.exr"), 1e-5)
    spaces = ["--input", "ARRI LogC4", *with_lut]  # which OpenColorIO decodes
    path = write(c.path("dark.exr"), scene(40, 60, most=0.4))  # LogC4 of light below 1
    run(c.command, "apply", path, c.path("wanted.exr"), *spaces)
    c.same("a space of the config is decoded once", c.apply(path, "100%", *spaces), c.path("wanted.exr"), 1e-4)
    done = subprocess.run([c.command, "apply", path, c.path("no.exr"), "--resize", "50%", *with_lut, "--input-encoding", "none"],
                          capture_output=True, text=True, check=False)
    c.report.check("colors that pass unchanged are not resized", done.returncode == 2 and not c.path("no.exr").exists() and
                   done.stderr.strip().endswith("expected --input-encoding with it: without it, colors are passed unchanged"), done.stderr)


def test_comparisons(c):
    """The pixels of `compare` are those of `apply`."""
    for path, options in ((write(c.path("scene.exr"), scene(80, 120, most=30.0)), []),
                          (write(c.path("code.exr"), scene(80, 120)), ["--input", "logc3"]),
                          (write(c.path("code.exr"), scene(80, 120)), ["--input", "ARRI LogC4", "--exposure", "-2"])):
        said = " ".join(options)
        for op in ("hable", "reinhard_extended"):
            run(c.command, "apply", path, c.path(f"{op}.png"), "--resize", "60x40", "--operator", op, *options, "-q")
        hable, extended = (read(c.path(f"{op}.png"))[0] for op in ("hable", "reinhard_extended"))
        common = [path, "hable", "reinhard_extended", "--resize", "60x40", *options, "-q"]
        run(c.command, "compare", *common, "--split", "0.5", "--no-labels", "-o", c.path("split.png"))
        split = read(c.path("split.png"))[0]
        c.report.compare(f"compare --split {said}", split, np.concatenate([hable[:, :30], extended[:, 30:]], axis=1), 0.51 / 255)
        run(c.command, "compare", *common, "-o", c.path("sheet.png"), "--pictures", c.path("all"))
        c.report.compare(f"compare --pictures {said}", read(c.path("all") / "hable.png")[0], hable, 0.51 / 255)
        c.report.check(f"compare --pictures {said}: a measured operator", np.abs(
            read(c.path("all") / "reinhard_extended.png")[0] - extended).max() < 0.51 / 255)
    path = write(c.path("scene.exr"), scene(80, 120))
    run(c.command, "apply", path, c.path("legend.png"), "--false-color", "--legend", "--resize", "240", "-q")
    run(c.command, "apply", path, c.path("plain.png"), "--false-color", "--resize", "240", "-q")
    shown, plain = read(c.path("legend.png"))[0], read(c.path("plain.png"))[0]
    left = (shown.shape[1] - 240) // 2
    c.report.check("--legend: the picture is resized, the legend is not", shown.shape[0] > 160 and any(
        np.array_equal(shown[y:y + 160, left:left + 240], plain) for y in range(shown.shape[0] - 159)), f"{shown.shape}")


def test_provenance(c):
    """The file says its size, and the next run does not repeat it."""
    path = write(c.path("scene.exr"), scene(40, 60))
    run(c.command, "apply", path, c.path("small.exr"), "--resize", "50%", "--operator", "hable", "--mix", "0.5", "-q")
    spec = header(c.path("small.exr"))
    c.report.check("Software has the size", ": hable, exposure 0, mix 0.5, resize 50%, display srgb" in spec.getattribute("Software"),
                   spec.getattribute("Software"))
    c.report.check("so has a tag of its own", spec.getattribute("tonewright:resize") == "50%")
    run(c.command, "apply", path, c.path("none.exr"), "--resize", "50%", "--operator", "hable", "-q", "--no-metadata")
    c.report.check("--no-metadata: no size", header(c.path("none.exr")).getattribute("tonewright:resize") is None)
    run(c.command, "apply", c.path("small.exr"), c.path("again.exr"), "--operator", "clamp", "-q")
    spec = header(c.path("again.exr"))
    c.report.check("a later run at full size has none", spec.getattribute("tonewright:resize") is None
                   and "resize" not in spec.getattribute("Software"), spec.getattribute("Software"))
    run(c.command, "apply", path, c.path("small.tif"), "--resize", "30x20", "--operator", "reinhard_local", "-q")
    spec = header(c.path("small.tif"))
    c.report.check("also of local operators, in other formats", "resize 30x20" in spec.getattribute("Software"))


def test_python(c, tw):
    path = write(c.path("scene.exr"), scene(40, 60))
    for size in ("30x20", 30, "50%"):
        tw.tonemap_file(path, c.path("python.exr"), "hable", display="linear", resize=size)
        run(c.command, "apply", path, c.path("one.exr"), "--resize", size, "-q", "--operator", "hable",
            "--display", "linear")
        c.report.check(f"Python: {size!r}", c.path("python.exr").read_bytes() == c.path("one.exr").read_bytes())
    try:
        tw.tonemap_file(path, c.path("python.exr"), "hable", resize=0)
        said = ""
    except ValueError as error:
        said = str(error)
    light = scene(40, 60, most=30.0)
    path = write(c.path("scene.exr"), light)
    run(c.command, "apply", path, c.path("one.exr"), "--resize", "30x20", "-q", "-d", "float", "--operator", "reinhard_extended")
    wanted = read(c.path("one.exr"))[0]
    for name, image, options in (("array", light, {}), ("array, channels first", np.moveaxis(light, -1, 0), {"axis": 0}),
                                 ("ImageBuf", oiio.ImageBuf(str(path)), {})):
        shown = tw.tonemap(image, "reinhard_extended", resize="30x20", **options)
        if name == "ImageBuf":
            shown = shown.get_pixels(oiio.FLOAT)
        c.report.compare(f"Python: tonemap of an {name}", np.moveaxis(shown, 0, -1) if options else shown, wanted, NEAR)
    flat = tw.tonemap(light[..., 0], "hable", resize=30)
    c.report.check("Python: tonemap of a gray array", flat.shape == (20, 30), f"is {flat.shape}")
    for options, message in (({"resize": "9999999x9999"}, "pixels; expected at most 1000000000 in all"),
                             ({"resize": "50%", "roi": oiio.ROI(0, 9, 0, 9)}, "roi is given with resize; expected one of them")):
        try:
            tw.tonemap(oiio.ImageBuf(str(path)), "hable", **options)
            raised = ""
        except ValueError as error:
            raised = str(error)
        c.report.check(f"Python: tonemap refuses {options}", message in raised, raised)
    c.report.check("Python: refused", said == "resize is 0; expected WxH, W or P%, such as 1920x1080, 1920 or 50%", said)
