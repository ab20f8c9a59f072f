# SPDX-License-Identifier: Apache-2.0
"""`tonewright apply` on pictures of every kind: each pixel is what `tonewright eval` makes of its color.

Pictures are made and read with OpenImageIO's Python; real ones join where they are found, see
pictures.shared_picture.
"""

import os
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from pictures import evaluate, run, share_of, shared_picture, skip

pytestmark = pytest.mark.share(2)

oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO's Python module is missing (Debian: python3-openimageio)")

# Both run the SIMD engine, but on other rows of matrices: what is decoded or converted here in double is one float
# away from what the engine computes inside, and the engine is within 1e-6 of the reference (engine.h).
EXACT = 2e-6
# `eval` prints 9 digits: every float. Where the picture's numbers go in as they are, the same float comes out.
SAME = 0
NAN, INF = float("nan"), float("inf")


def picture(height, width, channels, peak=6.0):
    """Light of all kinds, the same on every machine."""
    rng = np.random.default_rng(11)
    light = 0.18 * 2.0 ** rng.uniform(-8, np.log2(peak / 0.18), (height, width, channels))
    flat = light.reshape(-1, channels)
    flat[::7] *= rng.choice([-1, 0, 1], (len(flat[::7]), channels))
    return light.astype(np.float32)


def names_of(count, alpha):
    names = ["Y"] if count - alpha == 1 else ["R", "G", "B"]
    names += ["A"] * alpha
    return names + [f"extra{i}" for i in range(count - len(names))]


def spec_of(pixels, kind="float", alpha=False, attributes=None, names=None):
    height, width, count = pixels.shape
    spec = oiio.ImageSpec(width, height, count, kind)
    spec.channelnames = names or names_of(count, alpha)
    spec.alpha_channel = spec.channelnames.index("A") if "A" in spec.channelnames else -1
    for name, value in (attributes or {}).items():
        if isinstance(value, tuple):
            spec.attribute(name, f"float[{len(value)}]", value)
        else:
            spec.attribute(name, value)
    return spec


def write(path, spec, pixels):
    image = oiio.ImageBuf(spec)
    image.set_pixels(oiio.get_roi(spec), np.ascontiguousarray(pixels))
    if not image.write(str(path)):
        raise RuntimeError(f"{path}: {image.geterror()}")
    return path


def read(path, subimage=0, level=0):
    # The cache takes a file that was written again within a second for the old one.
    oiio.ImageCache(True).invalidate(str(path), True)
    image = oiio.ImageBuf(str(path), subimage, level)
    pixels = image.get_pixels("float")
    if pixels is not None and str(path).endswith(".png") and pixels.shape[-1] == 4:
        # As stored: OpenImageIO multiplies by alpha in the file's 8 bits.
        straight = oiio.ImageSpec()
        straight.attribute("oiio:UnassociatedAlpha", 1)
        stored = oiio.ImageInput.open(str(path), straight).read_image("float").astype(np.float32)
        pixels = np.concatenate([stored[..., :3] * stored[..., 3:], stored[..., 3:]], axis=-1)
    if pixels is None or image.has_error:
        raise RuntimeError(f"{path}: {image.geterror()}")
    return pixels, image.spec()


def srgb_decode(code):
    return np.where(code <= 0.04045, code / 12.92, ((np.maximum(code, 0.04045) + 0.055) / 1.055) ** 2.4)


def rgb_to_xyz(primaries):
    """SMPTE RP 177; primaries are x, y of red, green, blue and white. A primary may have y = 0."""
    xy = np.asarray(primaries, float).reshape(4, 2)
    columns = np.stack([xy[:, 0], xy[:, 1], 1 - xy.sum(1)])
    white = columns[:, 3] / xy[3, 1]
    return columns[:, :3] * np.linalg.solve(columns[:, :3], white)


BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
REC709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)


def to_rec709(primaries):
    """Light of some primaries -> linear Rec.709, Bradford-adapted."""
    def white(p):
        return BRADFORD @ np.array([p[6] / p[7], 1, (1 - p[6] - p[7]) / p[7]])
    adapt = np.linalg.inv(BRADFORD) @ np.diag(white(REC709) / white(primaries)) @ BRADFORD
    return np.linalg.inv(rgb_to_xyz(REC709)) @ adapt @ rgb_to_xyz(primaries)


def sanitized(rgb):
    return np.clip(np.nan_to_num(rgb.astype(float), nan=0, posinf=65504, neginf=-65504), -65504, 65504)


def divisor(color, alpha, most=16):
    """The rule of tonemap.h: alpha, or more where light is far above what alpha carries. `most` is the light of a surface."""
    cover = np.where((alpha == 0) | ~np.isfinite(alpha), 1, alpha).astype(float)
    largest = np.nan_to_num(np.nanmax(np.where(np.isnan(color), -np.inf, color), axis=-1).astype(float), posinf=np.inf)
    emits = (cover < 1) & (cover > 0) & (largest > most * cover)
    with np.errstate(invalid="ignore", divide="ignore"):
        blended = cover + (1 - cover) * (1 - most * cover / largest)
    return np.where(emits, blended, cover)


class Check:
    def __init__(self, report, command, scratch):
        self.report, self.command, self.scratch = report, command, scratch

    def apply(self, path, *options):
        out = self.scratch / "out.exr"
        run(self.command, "apply", path, out, "--operator", "agx_sobotka", "-d", "float", *options)
        return read(out)

    def expected(self, pixels, alpha=None, decode=None, matrix=None, divides=True):
        """Of colors by `eval`; pixels that the picture says to be coded or of other primaries are brought to Rec.709.

        --engine simd: the numbers of `apply`.
        """
        color = pixels[..., :3].astype(np.float32) if pixels.shape[-1] >= 3 else np.repeat(pixels[..., :1], 3, axis=-1)
        cover = None
        if alpha is not None and divides:
            cover = divisor(color, alpha).astype(np.float32)[..., None]
            color = color / cover
        if decode or matrix is not None:
            color = sanitized(color)
        if decode:
            color = decode(color)
        if matrix is not None:
            color = color @ matrix.T
        shown = evaluate(self.command, color.reshape(-1, 3), "agx_sobotka", "--engine", "simd").reshape(color.shape)
        return shown * cover if cover is not None else shown

    def same(self, what, path, bound=SAME, alpha=None, options=(), **kinds):
        """The file, pixel by pixel."""
        pixels, spec = read(path)
        cover = pixels[..., alpha] if alpha is not None else None
        shown, result = self.apply(path, *options)
        expected = self.expected(pixels, cover, **kinds)
        colors = 1 if pixels.shape[-1] < 3 else 3
        if shown.shape[-1] >= 3 and colors == 1:
            colors = 3
        first = 1 if colors == 1 else 0  # a gray result is the green of the view
        self.report.compare(f"{what}: color", shown[..., :colors],
                            expected[..., first:first + colors].astype(np.float32), bound)
        rest = 1 if pixels.shape[-1] < 3 else 3
        self.report.check(f"{what}: other channels are copied", np.array_equal(
            shown[..., colors:], pixels[..., rest:], equal_nan=True))
        self.report.check(f"{what}: windows and names", (spec.x, spec.y, spec.full_x, spec.full_y, spec.full_width,
                                                         spec.full_height, tuple(spec.channelnames))
                          == (result.x, result.y, result.full_x, result.full_y, result.full_width, result.full_height,
                              tuple(result.channelnames)))
        return shown


@pytest.fixture
def check(report, command, scratch):
    return Check(report, command, scratch)


def test_files(check, scratch):
    """Formats, layouts, sizes."""
    rgb, rgba, five = picture(37, 53, 3), picture(37, 53, 4), picture(20, 30, 5)
    rgba[..., 3] = np.linspace(0, 1, rgba[..., 3].size).reshape(rgba.shape[:2])
    special = rgb.copy()
    special[0, :6] = [(NAN, 1, 0.2), (INF, -INF, 0.5), (-0.1, 0.18, -7), (1e30, 1e-30, 0), (0, 0, 0), (-0.0, NAN, INF)]
    check.same("float EXR with NaN, infinities, negatives", write(scratch / "special.exr", spec_of(special), special))
    check.same("half EXR", write(scratch / "half.exr", spec_of(rgb, "half"), rgb))
    tiled = spec_of(rgb, "half")
    tiled.tile_width, tiled.tile_height = 16, 16
    check.same("tiled EXR", write(scratch / "tiled.exr", tiled, rgb))
    window = spec_of(rgb, "half")
    window.x, window.y, window.full_x, window.full_y, window.full_width, window.full_height = -5, 7, 0, 0, 40, 30
    check.same("data window larger than the display's", write(scratch / "over.exr", window, rgb))
    window.x, window.y, window.full_width, window.full_height = 10, 12, 200, 100
    check.same("data window smaller than the display's", write(scratch / "crop.exr", window, rgb))
    # Division by alpha is by float on both sides; multiplied once more.
    check.same("EXR with alpha", write(scratch / "alpha.exr", spec_of(rgba, alpha=True), rgba), 1e-7, alpha=3)
    straight = rgba.copy()
    path = write(scratch / "alpha2.exr", spec_of(straight, alpha=True), straight)
    check.same("--no-unpremult", path, alpha=3, divides=False, options=("--no-unpremult",))
    check.same("five channels", write(scratch / "five.exr", spec_of(five), five))
    check.same("one channel", write(scratch / "gray.exr", spec_of(rgb[..., :1]), rgb[..., :1]))
    gray = np.abs(rgba[..., [0, 3]])
    check.same("gray and alpha", write(scratch / "gray2.exr", spec_of(gray, alpha=True), gray), 1e-7, alpha=1)
    for height, width in ((1, 1), (1, 100000), (100000, 1)):
        line = picture(height, width, 3)
        check.same(f"{width} x {height}", write(scratch / "line.exr", spec_of(line, "half"), line))
    check.same("RGBE", write(scratch / "rgbe.hdr", spec_of(np.abs(rgb)), np.abs(rgb)))
    unit = np.clip(rgb, 0, 1)
    check.same("16-bit TIFF", write(scratch / "a.tif", spec_of(unit, "uint16"), unit), options=("--input", "lin_rec709"))
    check.same("16-bit TIFF without a tag is sRGB", scratch / "a.tif", 2e-7, decode=srgb_decode)
    check.same("float TIFF", write(scratch / "f.tif", spec_of(rgb), rgb))


def test_color(check, scratch):
    """The picture's metadata about its color."""
    rgb = np.clip(picture(24, 24, 3), 0, 1)
    check.same("16-bit PNG, sRGB", write(scratch / "a.png", spec_of(rgb, "uint16"), rgb), EXACT, decode=srgb_decode)
    check.same("the same, --input lin_rec709", scratch / "a.png", options=("--input", "lin_rec709"))
    check.same("TIFF, --input sRGB", write(scratch / "b.tif", spec_of(rgb, "uint16"), rgb), EXACT, decode=srgb_decode,
               options=("--input", "sRGB"))
    rgba = np.concatenate([rgb * 0.5, np.full((24, 24, 1), 0.5, np.float32)], axis=-1)
    check.same("PNG with alpha", write(scratch / "c.png", spec_of(rgba, "uint8", alpha=True), rgba), EXACT, alpha=3,
               decode=srgb_decode)
    wide = picture(24, 24, 3)
    ap1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
    ap0 = (0.7347, 0.2653, 0, 1, 0.0001, -0.077, 0.32168, 0.33767)
    xyz = (1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3)
    for name, primaries in (("ACEScg", ap1), ("CIE XYZ", xyz), ("Rec.709 itself", REC709)):
        path = write(scratch / "w.exr", spec_of(wide, attributes={"chromaticities": primaries}), wide)
        # Saturated colors leave Rec.709: a matrix that is one with the operator's loses less than two in a row do.
        check.same(f"chromaticities of {name}", path, 2e-6, matrix=to_rec709(primaries))
        check.same(f"the same, --input lin_rec709 ({name})", path, options=("--input", "lin_rec709"))
    # OpenImageIO 3.1 sets the flag in half-float files that are all that ACES asks for, and in no others.
    path = write(scratch / "aces.exr", spec_of(wide, attributes={"acesImageContainerFlaX": 1}), wide)
    path.write_bytes(path.read_bytes().replace(b"acesImageContainerFlaX", b"acesImageContainerFlag"))
    check.same("acesImageContainerFlag", path, 2e-6, matrix=to_rec709(ap0))
    report = check.report
    luma = picture(8, 8, 3)
    path = write(scratch / "yc.exr", spec_of(luma, "half", names=["Y", "RY", "BY"]), luma)
    fails(check, "luminance and chroma", path, 3, "channels are Y, RY, BY: luminance and chroma; expected R, G, B")
    # Luminance and chroma as OpenEXR writes them are read (cli.tags); other subsampled channels are not.
    (scratch / "sub.exr").write_bytes(subsampled_exr())
    fails(check, "subsampled R, G, B", scratch / "sub.exr", 3, "Subsampled channels")
    log = write(scratch / "log.tif", spec_of(rgb, attributes={"oiio:ColorSpace": "PanaLog"}), rgb)
    _, spec = read(log)
    if spec.getattribute("oiio:ColorSpace") == "PanaLog":
        fails(check, "an unknown color space", log, 3, "oiio:ColorSpace of the picture")
    fails(check, "--input of no space", log, 2, "--input is lin_rec708", "--input", "lin_rec708")
    # The second is what OpenImageIO 3.1 calls it.
    report.check("a result in sRGB says so", read_tag(check, scratch) in ("sRGB", "srgb_rec709_scene"))


def read_tag(check, scratch):
    run(check.command, "apply", scratch / "w.exr", scratch / "tag.png", "--operator", "hable")
    return read(scratch / "tag.png")[1].getattribute("oiio:ColorSpace")


def fails(check, what, path, code, words, *options):
    """One line, the exit code, and no file."""
    out = check.scratch / "never.exr"
    done = subprocess.run([check.command, "apply", path, out, "--operator", "hable", *options], capture_output=True,
                          text=True, check=False)
    check.report.check(f"{what} is refused in one line", done.returncode == code and words in done.stderr
                       and done.stderr.count("\n") == 1 and not out.exists(), f"{done.returncode}: {done.stderr}")


def subsampled_exr():
    """2 x 2 pixels, G of full resolution, R and B of half."""
    channels = b"".join(name + b"\0" + struct.pack("<iiii", 1, 0, step, step)
                        for name, step in ((b"B", 2), (b"G", 1), (b"R", 2))) + b"\0"
    box = struct.pack("<iiii", 0, 0, 1, 1)
    header = struct.pack("<ii", 20000630, 2)
    for name, kind, value in ((b"channels", b"chlist", channels), (b"compression", b"compression", b"\0"),
                              (b"dataWindow", b"box2i", box), (b"displayWindow", b"box2i", box),
                              (b"lineOrder", b"lineOrder", b"\0"), (b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
                              (b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)),
                              (b"screenWindowWidth", b"float", struct.pack("<f", 1))):
        header += name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    first = np.array([0.1, 0.5, 0.5, 0.2], "<f2").tobytes()  # B, G, G, R
    second = np.array([0.5, 0.5], "<f2").tobytes()
    start = len(header) + 16
    return (header + struct.pack("<QQ", start, start + 8 + len(first))
            + struct.pack("<ii", 0, len(first)) + first + struct.pack("<ii", 1, len(second)) + second)


def test_parts(check, scratch):
    """Multi-part and multi-view files, and levels: --subimage, the first by default."""
    parts = [picture(12, 16, 3), picture(9, 7, 3), picture(12, 16, 3)]
    specs = []
    for name, view, pixels in zip(("beauty", "light", "beauty.right"), ("left", "left", "right"), parts):
        specs.append(spec_of(pixels, "half", attributes={"oiio:subimagename": name, "view": view}))
        specs[-1].full_width, specs[-1].full_height = 16, 12  # one display window for all parts
    path = str(scratch / "parts.exr")
    out = oiio.ImageOutput.create(path)
    if not out.open(path, tuple(specs)):
        raise RuntimeError(out.geterror())
    for number, (spec, pixels) in enumerate(zip(specs, parts)):
        if number:
            out.open(path, spec, "AppendSubimage")
        out.write_image(pixels)
    out.close()
    for number in range(3):
        options = ("--subimage", str(number)) if number else ()
        shown, _ = check.apply(path, *options)
        pixels, _ = read(path, number)
        check.report.compare(f"part {number} of a multi-part file", shown, check.expected(pixels).astype(np.float32),
                             SAME)
    fails(check, "a part that is not there", path, 3, "it has no subimage 3; the first is 0", "--subimage", "3")


def test_real(check):
    """Whole pictures of every kind that OpenEXR's collection has, half of them by the commit."""
    kinds = {"Desk.exr": {"alpha": 3, "bound": 1e-7}, "CandleGlass.exr": {"alpha": 3, "bound": 1e-6}, "t05.exr": {},
             "StageEnvLatLong.exr": {}, "memorial.hdr": {}, "composited.exr": {"alpha": 3, "bound": 1e-7},
             "XYZ.exr": {"matrix": to_rec709((1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3)), "bound": EXACT},
             "Tree.exr": {"alpha": 3, "bound": EXACT, "matrix": to_rec709(
                 (0.62955, 0.341, 0.2867, 0.6108, 0.1489, 0.07125, 0.3155, 0.33165))}}
    found = [(path, kind) for name, kind in share_of(kinds.items(), 3) if (path := shared_picture(name))]
    for path, kind in found:
        check.same(path.name, path, **kind)
    if not found:
        skip("real pictures (TONEWRIGHT_SHARED)")


def test_writing(check, scratch):
    """Where the result goes, what it says, and what the user hears of it."""
    report = check.report

    def run_apply(path, out, *options):
        done = subprocess.run([check.command, "apply", path, out, "--operator", "hable", *options], capture_output=True,
                              text=True, check=False)
        return done.returncode, done.stderr

    folder = scratch / "writing"
    folder.mkdir()
    rgb = np.clip(picture(16, 24, 3), 0, 4)
    source = write(folder / "in.exr", spec_of(rgb), rgb)
    original = source.read_bytes()
    (folder / "symbolic.exr").symlink_to("in.exr")
    (folder / "hard.exr").hardlink_to(source)
    for name in ("in.exr", "symbolic.exr", "hard.exr"):
        code, said = run_apply(source, folder / name)
        report.check(f"apply in.exr {name} is refused", code == 2 and "--in-place" in said
                     and said.count("\n") == 1 and source.read_bytes() == original, said)
    for number in (1, 2):
        write(folder / f"f.{number}.exr", spec_of(rgb), rgb)
    (folder / "g.1.exr").symlink_to("f.2.exr")
    before = (folder / "f.1.exr").read_bytes()
    code, said = run_apply(folder / "f.%d.exr", folder / "f.%d.exr", "--frames", "1-2")
    report.check("frames over themselves are refused", code == 2 and "--in-place" in said
                 and (folder / "f.1.exr").read_bytes() == before, said)
    code, said = run_apply(folder / "f.%d.exr", folder / "g.%d.exr", "--frames", "1-2", "--in-place")
    report.check("a frame over another is refused, --in-place or not", code == 2 and "f.2.exr" in said
                 and (folder / "f.1.exr").read_bytes() == before, said)
    code, said = run_apply(folder / "f.%d.exr", folder / "f.%d.exr", "--frames", "1-2", "--in-place")
    report.check("frames over themselves with --in-place", code == 0
                 and (folder / "f.1.exr").read_bytes() != before, said)
    code, said = run_apply(source, source, "--in-place")
    report.check("--in-place", code == 0 and source.read_bytes() != original, said)

    blank = np.concatenate([rgb, np.zeros((16, 24, 1), np.float32)], axis=-1)
    path = write(folder / "blank.exr", spec_of(blank, alpha=True), blank)
    code, said = run_apply(path, folder / "blank.png")
    report.check("alpha 0 everywhere is one warning", code == 0 and said.count("\n") == 1
                 and "alpha is 0 everywhere" in said and "--alpha" in said, said)
    code, said = run_apply(path, folder / "strict.png", "--strict")
    report.check("with --strict it is an error and no file", code == 1 and not (folder / "strict.png").exists(), said)
    code, said = run_apply(path, folder / "seen.png", "--alpha", "opaque")
    pixels, _ = read(folder / "seen.png")
    report.check("--alpha opaque", (code, said) == (0, "") and pixels.shape[-1] == 4 and pixels[..., 3].min() == 1, said)
    shot = [folder / f"blank.{n}.exr" for n in (1, 2)]
    for name in shot:
        name.write_bytes(path.read_bytes())
    code, said = run_apply(folder / "blank.%d.exr", folder / "blank.%d.png", "--frames", "1-2")
    report.check("frames warn once", code == 0 and said.count("alpha is 0") == 1, said)

    code, said = run_apply(path, folder / "pq.jpg", "--display", "rec2100_pq", "--alpha", "ignore")
    report.check("PQ in a JPEG is one warning", code == 0 and said.count("\n") == 1
                 and "warning: " in said and "pq.jpg: JPEG does not say" in said, said)
    code, said = run_apply(path, folder / "p3.jpg", "--display", "display_p3", "--strict")
    report.check("Display P3 in a JPEG is none", (code, said) == (0, ""), said)

    source = write(folder / "in.exr", spec_of(rgb), rgb)
    options = ("--set", "white=9", "--exposure", "0.5", "--display", "display_p3")
    for name in ("a.exr", "a.png", "a.jpg", "a.tif"):
        run_apply(source, folder / name, *options)
        _, spec = read(folder / name)
        software = spec.get_string_attribute("Software")
        report.check(f"{name} says how it was made", software.startswith("Tonewright ") and
                     "hable:white=9, exposure 0.5, display display_p3" in software, software)
    _, spec = read(folder / "a.exr")
    report.check("attributes of an EXR file", [spec.get_string_attribute(f"tonewright:{name}") for name in
                 ("operator", "exposure", "display")] == ["hable:white=9", "0.5", "display_p3"])
    run_apply(source, folder / "b.exr", *options)
    report.check("the same bytes again", (folder / "a.exr").read_bytes() == (folder / "b.exr").read_bytes())
    run_apply(source, folder / "c.exr", *options, "--no-metadata", "--compression", "dwaa", "--quality", "30")
    _, spec = read(folder / "c.exr")
    report.check("--no-metadata", "Tonewright" not in spec.get_string_attribute("Software")
                 and not spec.get_string_attribute("tonewright:operator"))
    report.check("--compression and --quality", spec.get_string_attribute("compression").startswith("dwaa")
                 and (folder / "c.exr").stat().st_size < (folder / "a.exr").stat().st_size)
    code, said = run_apply(source, folder / "d.exr", "--compression", "pizz")
    report.check("--compression of no such name", code == 2 and "did you mean piz" in said
                 and not (folder / "d.exr").exists(), said)

    two = picture(8, 8, 2)
    path = write(folder / "two.exr", spec_of(two, names=["X", "Y"]), two)
    fails(check, "two channels that are no color", path, 3, f"{path}: picture has 2 channels (X, Y)")
    done = subprocess.run([check.command, "meter", path], capture_output=True, text=True, check=False)
    report.check("and in meter", done.returncode == 3 and "2 channels (X, Y)" in done.stderr, done.stderr)
    window = spec_of(rgb)
    window.full_width = window.full_height = 1000000
    path = write(folder / "window.exr", window, rgb)
    code, said = run_apply(path, folder / "window.png")
    report.check("a display window of 10^12 pixels is refused", code == 3 and "--max-pixels" in said
                 and not list(folder.glob(".window*")), said)


def test_hostile(check):
    """Files that were made to break readers, where they are found."""
    folder = os.environ.get("TONEWRIGHT_SHARED")
    folder = Path(folder) / "data" / "hostile" if folder else None
    if not folder or not folder.is_dir():
        skip("hostile files (TONEWRIGHT_SHARED)")
    path = folder / "fits.fits"
    pixels, _ = read(path)
    shown, _ = check.apply(path, "--input", "lin_rec709")
    # Division by alpha is by float on both sides.
    check.report.compare("FITS whose channels have no names", shown[..., :3],
                         check.expected(pixels, pixels[..., 3]).astype(np.float32), 1e-7)
    fails(check, "half a DPX file", folder / "half.dpx", 3, "the file is truncated")
    fails(check, "93 bytes that declare a row of millions", folder / "wide_93_bytes.exr", 3, "in 93 bytes")
