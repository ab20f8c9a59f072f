# SPDX-License-Identifier: Apache-2.0
"""What `tonewright apply` writes, and what other programs find in it: chroma of JPEG, AVIF, tags, light levels, alpha.

Pictures are made and read with OpenImageIO's Python.
"""

import json
import subprocess
import zlib

import numpy as np
import pytest
from pictures import share_of
from test_pictures import oiio, read, spec_of, write

pytestmark = pytest.mark.share(2)

OK, USAGE, FILE = 0, 2, 3


class Writer:
    def __init__(self, report, command, folder):
        self.report, self.command, self.folder = report, command, folder

    def apply(self, source, name, *options):
        """(exit code, standard error) of `apply` with the operator clamp, unless the options name another."""
        operator = [] if {"--operator", "--lut"} & set(options) else ["--operator", "clamp"]
        done = subprocess.run([self.command, "apply", source, self.folder / name, *operator, *options],
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


@pytest.fixture
def to(report, command, scratch):
    return Writer(report, command, scratch)


def png(folder, name, code):
    """Code values as an 8-bit PNG, which clamp maps to themselves."""
    return write(folder / name, spec_of(code, "uint8"), code.astype(np.float32))


@pytest.mark.parametrize("kind, written, words", [
    ("half", "half", "(half, as the input; -d float for 32 bits)"),
    ("float", "float", "(float, as the input; -d half for 16 bits)"),
    ("uint8", "half", "(half, which holds uint8; -d float for 32 bits)"),
    ("uint16", "float", "(float, which holds uint16; -d half for 16 bits)"),
])
def test_pixel_type(to, report, scratch, kind, written, words):
    """EXR keeps the type of the input, and the line says so; -d decides otherwise, and other formats do not follow.

    Half has 11 significant bits (IEEE 754, binary16): it tells all codes of 8 bits apart, not those of 16.
    """
    code = np.linspace(0, 1, 256, dtype=np.float32).reshape(16, 16, 1).repeat(3, axis=2)
    source = write(scratch / ("in.tif" if kind.startswith("uint") else "in.exr"), spec_of(code, kind), code)
    linear = ["--display", "linear"]
    exit_code, said = to.apply(source, "out.exr", *linear, "-v")
    is_kind = str(oiio.ImageInput.open(str(scratch / "out.exr")).spec().format)
    report.check(f"{kind} to EXR", exit_code == 0 and is_kind == written and words in said, f"{is_kind} {said}")
    other = "float" if written == "half" else "half"
    exit_code, said = to.apply(source, "out.exr", *linear, "-v", "-d", other)
    is_kind = str(oiio.ImageInput.open(str(scratch / "out.exr")).spec().format)
    report.check(f"{kind} to EXR, -d {other}", exit_code == 0 and is_kind == other and "-d " not in said, f"{is_kind} {said}")
    exit_code, said = to.apply(source, "out.png", "-v")
    report.check(f"{kind} to PNG: 8 bits, and no word of it", exit_code == 0 and "-d " not in said
                 and str(oiio.ImageInput.open(str(scratch / "out.png")).spec().format) == "uint8", said)


def test_beyond_half(to, report, scratch):
    """Half ends at 65504, and an operator may make a sun brighter. 1 of 32 pixels is 3.125 %, which is rounded up."""
    light = np.full((4, 8, 3), 0.5, np.float32)
    light[0, 0] = (65504, 0, 0)
    source = write(scratch / "sun.exr", spec_of(light, "half"), light)
    options = ["--display", "linear"]
    exit_code, said = to.apply(source, "out.exr", "--operator", "2*x", *options)
    report.check("a sun beyond half: a warning with its share", exit_code == 0 and "warning: " in said
                 and "3.2 % of the pixels are infinite, because half ends at 65504; -d float keeps them" in said, said)
    exit_code, said = to.apply(source, "out.exr", "--operator", "2*x", *options, "-d", "float")
    report.check("-d float keeps it, without a warning", exit_code == 0 and not said, said)


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


def test_jpeg(to):
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


def scene(height=24, width=32, peak=20.0):
    """Scene-linear colors of many stops, the same on every machine."""
    rng = np.random.default_rng(5)
    return (0.18 * 2.0 ** rng.uniform(-8, np.log2(peak / 0.18), (height, width, 3))).astype(np.float32)


# Color Interop Forum, "Color Space Encodings for Interchange".
INTEROP_IDS = {"srgb": "srgb_rec709_display", "display_p3": "srgb_p3d65_display", "rec1886": "g24_rec709_display",
               "g22": "g22_rec709_display", "rec2100_pq": "pq_rec2020_display", "rec2100_hlg": "hlg_rec2020_display",
               "p3d65_pq": "pq_p3d65_display", "linear": "lin_rec709_scene"}


def test_exr_tags(to):
    source = write(to.folder / "in.exr", spec_of(scene()), scene())

    def tags(*options, source=source):
        _, spec = to.written(source, "o.exr", *options)
        return {name: spec.getattribute(name) for name in ("colorInteropID", "tonewright:display", "tonewright:operator")}
    for display, wanted in INTEROP_IDS.items():
        for options in ([], ["--no-metadata"]):
            found = tags("--display", display, *options)
            to.report.check(f"EXR of {display} {' '.join(options)}: {wanted}", found["colorInteropID"] == wanted, found)
            to.report.check("provenance is there only if wanted",
                            (found["tonewright:display"] is None) == bool(options), found)
    found = tags("--display", "rec2020", "--no-metadata")
    to.report.check("EXR of rec2020, of which the forum has no identifier: tonewright:display, always",
                    found["colorInteropID"] is None and found["tonewright:display"] == "rec2020"
                    and found["tonewright:operator"] is None, found)
    for operator, wanted in (("agx_sobotka", "g22_rec709_display"), ("hable", "lin_rec709_scene")):
        found = tags("--operator", operator, "--display", "native")
        to.report.check(f"native output of {operator}: {wanted}", found["colorInteropID"] == wanted, found)

    # What described the source does not describe the result.
    stale = {"tonewright:display": "rec2020", "colorInteropID": "lin_ap1_scene", "hdrgm:Version": "1.0",
             "Container:Directory": "GainMap", "Item:Semantic": "GainMap", "GContainer:X": "1", "rdf:parseType": "Resource"}
    source = write(to.folder / "stale.exr", spec_of(scene(), attributes=stale), scene())
    for name in ("o.exr", "o.png", "o.tif"):
        _, spec = to.written(source, name, "--no-metadata")
        left = [a.name for a in spec.extra_attribs
                if a.name.startswith(("hdrgm", "Container", "Item:", "GContainer", "rdf:", "tonewright"))]
        to.report.check(f"{name}: nothing of a gain map, or of the source's display, is left", not left, left)
    _, spec = to.written(source, "o.exr")
    to.report.check("the color tag is that of the result", spec.getattribute("colorInteropID") == "srgb_rec709_display")


def pq_light(code):
    """SMPTE ST 2084, equation 4: cd/m2."""
    m1, m2, c1, c2, c3 = 2610 / 16384, 2523 / 32, 3424 / 4096, 2413 / 128, 2392 / 128
    p = code ** (1 / m2)
    return 10000 * (np.maximum(p - c1, 0) / (c2 - c3 * p)) ** (1 / m1)


def hlg_light(code):
    """ITU-R BT.2100-2, table 5, on a display of 1000 cd/m2."""
    a, b, c = 0.17883277, 0.28466892, 0.55991073
    light = np.where(code <= 0.5, code ** 2 / 3, (np.exp((np.maximum(code, 0.5) - c) / a) + b) / 12)
    luminance = light @ [0.2627, 0.6780, 0.0593]
    return 1000 * light * luminance[..., None] ** 0.2


def chunks(path):
    """Type and data of a PNG file's chunks; raises ValueError for a wrong check sum."""
    data = path.read_bytes()[8:]
    found = []
    while data:
        size = int.from_bytes(data[:4], "big")
        kind, content = data[4:8].decode(), data[8:8 + size]
        if zlib.crc32(data[4:8 + size]) != int.from_bytes(data[8 + size:12 + size], "big"):
            raise ValueError(f"check sum of {kind}")
        found.append((kind, content))
        data = data[12 + size:]
    return found


def test_light_levels(to):
    rgb = scene()
    pictures = {"rgb": write(to.folder / "rgb.exr", spec_of(rgb), rgb),
                "gray": write(to.folder / "gray.exr", spec_of(rgb[..., :1]), rgb[..., :1]),
                "black": write(to.folder / "black.exr", spec_of(rgb * 0), rgb * 0),
                # More rows than one batch has, so that the levels are those of all batches.
                "tall": write(to.folder / "tall.exr", spec_of(np.tile(rgb, (60, 1, 1))), np.tile(rgb, (60, 1, 1)))}
    for display, light in share_of((("rec2100_pq", pq_light), ("p3d65_pq", pq_light), ("rec2100_hlg", hlg_light)), 3):
        for what, source in pictures.items():
            for options in ([], ["-d", "uint8"]):
                code, _ = to.written(source, "o.png", "--display", display, "--reference-white", "203", *options)
                found = chunks(to.folder / "o.png")
                kinds = [kind for kind, _ in found]
                name = f"{display}, {what} {' '.join(options)}"
                to.report.check(f"{name}: IHDR, cICP, cLLI, and later IDAT",
                                kinds[:3] == ["IHDR", "cICP", "cLLI"] and "IDAT" in kinds[3:] and kinds.count("cLLI") == 1,
                                kinds)
                largest = light(np.repeat(code, 3 // code.shape[2], 2).astype(float)).max(-1)
                is_levels = np.frombuffer(dict(found)["cLLI"], ">u4") * 1e-4
                levels = np.array([largest.max(), largest.mean()])
                # The engine decodes in single precision: 1e-6 of a code value, where PQ changes by a 20th of its light
                # in 1/400. The chunk counts in 0.0001.
                to.report.bound(f"{name}: MaxCLL {levels[0]:.1f}, MaxFALL {levels[1]:.1f}",
                                (np.abs(is_levels - levels) - 1e-4).max(), 1e-4 * levels.max())
    to.written(pictures["rgb"], "o.png")
    to.report.check("no light levels of an SDR display", "cLLI" not in dict(chunks(to.folder / "o.png")))


def srgb(light):
    light = np.clip(light, 0, 1)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def test_alpha(to):
    # A surface, its edge, a flame without alpha, and glass: more light than its alpha carries.
    pixels = np.zeros((4, 8, 4), np.float32)
    pixels[:, :4] = (0.2, 0.1, 0.05, 1)
    pixels[:, 4] = (0.1, 0.05, 0.025, 0.5)
    pixels[:, 5] = (0.6, 0.3, 0.1, 0)
    pixels[:, 6:] = (0.6, 0.3, 0.1, 1e-4)
    source = write(to.folder / "flame.exr", spec_of(pixels, alpha=True), pixels)
    alpha = pixels[..., 3:].astype(float)
    # tonemap.h, point 3: the divisor between alpha and 1.
    share = np.clip(1 - 16 * alpha / np.maximum(pixels[..., :3].max(-1, keepdims=True), 1e-9), 0, 1)
    divisor = np.where(alpha > 0, alpha + (1 - alpha) * share, 1)
    code = srgb(pixels[..., :3] / divisor) * divisor

    # OpenImageIO's JPEG of quality 100 with all chroma: 2 code values.
    got, _ = to.written(source, "o.jpg", "--quality", "100")
    to.report.bound("flames and glass shine in a JPEG", np.abs(got - code).max(), 2.5 / 255)
    got, _ = to.written(source, "o.jpg", "--quality", "100", "--unpremult")
    to.report.check("--unpremult divides emission, too, as before", got[0, 7].max() < 0.01, str(got[0, 7]))
    got, spec = to.written(source, "o.png", "--alpha", "over:0.25,0.5,1", "-d", "uint16")
    over = np.clip(code + (1 - alpha) * [0.25, 0.5, 1], 0, 1)
    # 16 bits, and the engine's 1e-6.
    to.report.bound("--alpha over composites in code values", np.abs(got - over).max(), 1e-5)
    to.report.check("and writes no alpha", spec.nchannels == 3, spec.channelnames)
    for wrong in ("over", "over:", "over:1,2,3", "over:0,0", "over:0,0,0,0", "over:a,b,c", "over:nan,0,0", "ovr"):
        to.refuses(f"--alpha {wrong}", source, "no.png", USAGE, "alpha is ", "--alpha", wrong)
    gray = pixels[..., 2:]
    path = write(to.folder / "gray.exr", spec_of(gray, alpha=True), gray)
    got, spec = to.written(path, "o.png", "--alpha", "over:0.5,0.5,0.5", "-d", "uint16")
    to.report.bound("a gray picture over gray", abs(got[0, 0, 0] - srgb(0.05)), 1e-5)
    to.refuses("a gray picture over a color", path, "no.png", FILE, "equal", "--alpha", "over:1,0,0")

    for name in ("o.png", "o.tga", "o.webp", "o.jp2"):
        big = np.tile(pixels, (16, 8, 1))  # JPEG 2000 takes 32 pixels and more
        path = write(to.folder / "big.exr", spec_of(big, alpha=True), big)
        code_, said = to.apply(path, name)
        to.report.check(f"{name}: one warning of the light that straight alpha loses, with its share",
                        code_ == OK and said.count("more light than their alpha carries") == 1 and "37.5 %" in said
                        and "--alpha opaque" in said, said)
    for frame, flames in enumerate((1, 5, 3)):
        shot = np.zeros((4, 8, 4), np.float32)
        shot[..., :3], shot[:, flames:, 3] = (0.6, 0.3, 0.1), 1
        write(to.folder / f"shot.{frame}.exr", spec_of(shot, alpha=True), shot)
    for jobs in (1, 3):
        _, said = to.apply(to.folder / "shot.@.exr", "shot.@.png", "--frames", "0-2", "--jobs", str(jobs))
        to.report.check(f"one warning for a shot, of the worst frame, --jobs {jobs}",
                        said.count("carries") == 1 and "62.5 %" in said, said)
    for name in ("o.exr", "o.jpg", "o.tif"):
        _, said = to.apply(source, name)
        to.report.check(f"{name}: no such warning", "carries" not in said, said)
    solid = write(to.folder / "solid.exr", spec_of(pixels[:, :5], alpha=True), pixels[:, :5])
    to.report.check("no warning of surfaces and their edges", to.apply(solid, "o.png")[1] == "")


def test_straight(to):
    """8-bit files with low alpha: their color is not multiplied in 8 bits while it is read."""
    color = np.array([200, 100, 50]) / 255
    code = np.zeros((4, 16, 4))
    code[..., :3] = color
    code[..., 3] = np.arange(1, 17) / 255
    straight = {"oiio:UnassociatedAlpha": 1}
    for name in ("in.png", "in.tga", "in.tif"):
        spec = spec_of(code, "uint8", alpha=True, attributes=straight)
        source = write(to.folder / name, spec, code.astype(np.float32))
        for out in ("o.png", "o.tga", "o.tif", "o.exr"):
            to.written(source, out, "--input", "srgb")
            image = oiio.ImageInput.open(str(to.folder / out), spec_of(code, attributes=straight))
            got, spec = image.read_image("float"), image.spec()
            image.close()
            if out == "o.exr":
                to.report.check("EXR has associated alpha", spec.getattribute("oiio:UnassociatedAlpha") is None)
                got[..., :3] /= got[..., 3:]
            # Half floats have 11 bits, alpha and color each; 8 bits are exact.
            to.report.bound(f"{name} -> {out}: color at alpha 1/255 and more", np.abs(got[..., :3] - color).max(), 1.1e-3)
            to.report.bound("and alpha", np.abs(got[..., 3] - code[..., 3]).max(), 1e-4)
        lit = subprocess.run([to.command, "meter", source, "--input", "srgb", "--json"], capture_output=True, text=True,
                             check=True)
        light = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4) @ [0.2126, 0.7152, 0.0722]
        mean = json.loads(lit.stdout)["pictures"][0]["luminance"]["mean"]
        to.report.bound(f"meter {name}", abs(mean - light), 1e-4 * light)


FORMATS = "png jpg webp tga bmp gif ico iff sgi dpx hdr ppm rla fits jp2 heic tif exr".split()


def test_formats(to):
    """Every layout, in every format: written, and read back as what was to be written."""
    names = {1: ["Y"], 2: ["Y", "A"], 3: list("RGB"), 4: list("RGBA"), 5: [*"RGBA", "Z"]}
    for count, channels in names.items():
        code = np.tile(scene(40, 36)[..., :1], (1, 1, count)) * np.linspace(0.02, 0.05, count)
        code[..., channels.index("A") if "A" in channels else count:] = 1
        spec = spec_of(code.astype(np.float32), alpha="A" in channels, names=channels)
        source = write(to.folder / "in.exr", spec, code.astype(np.float32))
        for name in share_of(FORMATS, 5):
            code_, said = to.apply(source, f"o.{name}", "--verify-output", "--display",
                                   "linear" if name in ("hdr", "exr") else "srgb")
            to.report.check(f"{''.join(channels)} as {name}", code_ == OK, f"exit {code_}: {said}")
    small = scene(16, 16)
    source = write(to.folder / "in.exr", spec_of(small), small)
    to.refuses("JPEG 2000 below 32 pixels", source, "no.jp2", FILE, "expected at least 32")
    wide = np.zeros((1, 300, 3), np.float32)
    to.refuses("ICO above 256 pixels", write(to.folder / "wide.exr", spec_of(wide), wide), "no.ico", FILE, "at most 256")
    code_, said = to.apply(source, "o.avif")
    if code_ == OK:  # where libheif has an encoder of AV1
        brand = (to.folder / "o.avif").read_bytes()[8:12]
        to.report.check("AVIF is AV1, also from a file with another compression", brand == b"avif", brand)
    else:
        to.report.check("AVIF without an encoder is refused", code_ == FILE and said.count("\n") == 1, said)
    spec = spec_of(small)
    spec.x, spec.y, spec.full_width, spec.full_height = -4, -2, 24, 20
    source = write(to.folder / "window.exr", spec, small)
    got, spec = to.written(source, "o.tif", "--verify-output")
    to.report.check("TIFF has no windows with negative origin: it shows the display window",
                    (spec.x, spec.y, spec.width, spec.height) == (0, 0, 24, 20), got.shape)
    for bits in (10, 12):
        _, spec = to.written(source, "o.dpx", "-d", f"uint{bits}", "--verify-output")
        to.report.check(f"DPX of {bits} bits", spec.getattribute("oiio:BitsPerSample") == bits)
    to.refuses("10 bits as PNG", source, "no.png", USAGE, "only DPX", "-d", "uint10")
    for option, words in (("--gamma", "--display"), ("--cdl", "--lut"), ("--channels", "oiiotool"), ("-pix_fmt", "-d uint8")):
        code_, said = to.apply(source, "no.png", option, "x")
        to.report.check(f"a hint for {option}", code_ == USAGE and words in said, said)
