# SPDX-License-Identifier: Apache-2.0
"""ffmpeg's lut3d, lut1d and haldclut with LUTs of `tonewright bake`, against the file itself and against the operator.

    python3 -m pytest tests/parity/clients/test_ffmpeg.py --tonewright build/release/bin/tonewright

ffmpeg reads float EXR, whose pixels are the codes that the LUT takes, and writes float EXR: no 8-bit step, no swscale.
Real pictures join the test chart where they are found, see pictures.shared_picture.
"""

import json
import shlex
import subprocess

import numpy as np
import pytest
from lut_client import BITS16, FLOAT32, HEIGHT, WIDTH, Client
from lut_encodings import acescct_decode, acescct_encode
from lut_tables import hald_cube, linear, read_cube, stated_errors, tetrahedral, trilinear
from operators import rgb_to_rgb  # from the chromaticities, a second opinion on the program's
from pictures import evaluate, log2_decode, log2_encode, read_exr, read_rgb, run, shared_picture, skip, stack, unstack, write_exr

FFMPEG = Client("ffmpeg", "ffmpeg", "ffmpeg", "ffmpeg -version")
BOTH = pytest.mark.parametrize("client", [FFMPEG, FFMPEG._replace(newer=True)], ids=str)
# Colors compared with the operator; `eval` reads text, a million lines would take longer than they tell.
SAMPLES = 20000


@pytest.fixture(autouse=True)
def needs_exr(test):
    if " exr " not in run(*test.program, "-v", "error", "-encoders"):
        skip("ffmpeg has no EXR encoder (older than 5.0)")


def through_ffmpeg(test, codes, filter_):
    """Codes (height, width, 3) through a filter. ffmpeg runs in the folder: its filter syntax cannot quote any path."""
    scratch = test.scratch
    write_exr(scratch / "codes.exr", unstack(codes))
    run(*test.program, "-v", "error", "-nostdin", "-y", "-i", "codes.exr", "-vf", filter_, "-pix_fmt", "gbrpf32le",
        "-update", 1, "-frames:v", 1, "graded.exr", folder=scratch)
    return stack(read_exr(scratch / "graded.exr"))


def compare(test, what, codes, graded, table, stated, interpolate, decode, arguments):
    """Graded codes against the file's numbers, and those inside the LUT's domain against the operator."""
    codes, graded = codes.reshape(-1, 3), graded.reshape(-1, 3)
    predicted = interpolate(table, codes.astype(float))
    test.report.compare(f"{what}, against the file", graded, predicted, FLOAT32)
    inside = np.flatnonzero(((codes >= 0) & (codes <= 1)).all(axis=1))
    chosen = np.random.default_rng(3).permutation(inside)[:SAMPLES]
    truth = evaluate(test.command, decode(codes[chosen].astype(float)), *arguments)
    test.report.compare(f"{what}, against the operator ({len(chosen)})", graded[chosen], truth, stated + FLOAT32)
    test.row(what, graded - predicted, FLOAT32, graded[chosen] - truth, stated + FLOAT32)


def through_haldclut(test, codes, hald, interpolation, form):
    """form: of the pixels of both pictures, rgb48le or gbrpf32le. ffmpeg itself would choose 8 bits, and it takes the
    channels of planar integers for each other."""
    graph = f"[0]format={form}[a];[1]format={form}[b];[a][b]haldclut=interp={interpolation}"
    arguments = [*test.program, "-v", "error", "-nostdin", "-y", "-i", codes.name, "-i", hald.name, "-lavfi", graph,
                 "-pix_fmt", form, "-update", 1, "-frames:v", 1]
    if form == "gbrpf32le":
        run(*arguments, "graded.exr", folder=test.scratch)
        return stack(read_exr(test.scratch / "graded.exr"))
    run(*arguments, "-f", "rawvideo", "graded.raw", folder=test.scratch)
    return np.fromfile(test.scratch / "graded.raw", "<u2").reshape(HEIGHT, WIDTH, 3) / 65535


@BOTH
def test_modes(test):
    """Both interpolations of lut3d and haldclut, with numbers of 32 and of 16 bits."""
    for name, interpolate, host in (("tetrahedral", tetrahedral, "ffmpeg"), ("trilinear", trilinear, "gmic")):
        cube, table, stated = test.cube(host)
        shown = through_ffmpeg(test, test.codes, f"lut3d={cube.name}:interp={name}")
        test.compare(f"lut3d, .cube 33, {name}, float", shown, interpolate(table, test.flat), stated, FLOAT32, False)
        path, stated = test.bake(host, "hald.exr", "--format", "hald", "--size", 36, "--depth", 32)
        table = hald_cube(read_rgb(path, test.scratch))
        shown = through_haldclut(test, test.picture("codes.exr"), path, name, "gbrpf32le")
        test.compare(f"haldclut of 36, {name}, float", shown, interpolate(table, test.flat), stated, FLOAT32, False)
        path, stated = test.bake(host, "hald.png", "--format", "hald", "--size", 36, "--depth", 16)
        table = hald_cube(read_rgb(path, test.scratch))
        shown = through_haldclut(test, test.picture("codes.png"), path, name, "rgb48le")
        test.compare(f"haldclut of 36, {name}, 16 bits", shown, interpolate(table, test.flat), stated, BITS16)


@BOTH
def test_limits(test):
    """What ffmpeg does not read in a .cube: both tables of resolve_cube, and domains that do not start at 0 or end below 1."""
    report, scratch = test.report, test.scratch
    run(test.command, "bake", "agx_sobotka", "--format", "resolve_cube", "--size", 17, "--nodes", "sampled", "-o",
        scratch / "resolve.cube")
    write_exr(scratch / "codes.exr", unstack(test.codes))
    done = subprocess.run([*test.program, "-v", "error", "-nostdin", "-y", "-i", "codes.exr", "-vf", "lut3d=resolve.cube",
                           "-pix_fmt", "gbrpf32le", "-update", "1", "-frames:v", "1", "refused.exr"],
                          cwd=scratch, capture_output=True, text=True, check=False)
    report.check("resolve_cube is refused", done.returncode != 0 and "Error initializing filter" in done.stderr, done.stderr)
    light = np.repeat(np.linspace(0, 1, 64, dtype=np.float32)[None, :, None], 3, axis=2).repeat(8, axis=0)
    truth = evaluate(test.command, light.reshape(-1, 3).astype(float), "hable").reshape(light.shape)
    for lo, hi, is_read in ((0, 1, True), (0, 16, True), (-1, 1, False), (0, 0.5, False), (0.001, 16, False)):
        what = f"lut1d, .cube of linear:{lo}:{hi}"
        done = subprocess.run([test.command, "bake", "hable", "--1d", "--format", "cube", f"--input-encoding=linear:{lo}:{hi}",
                               "-o", scratch / "linear.cube"], capture_output=True, text=True, check=True)
        report.check(f"{what}: {'no warning' if is_read else 'one warning'}", done.stderr.count("warning: ") == (not is_read)
                     and (is_read or f"linear.cube has the domain {lo} to {hi}, and ffmpeg" in done.stderr), done.stderr)
        shown = through_ffmpeg(test, light, "lut1d=linear.cube:interp=linear")
        inside = (light >= max(lo, 0.05)) & (light <= hi)
        error = abs(shown - truth)[inside].max()
        report.check(f"{what}: {'read' if is_read else 'misread'}, {error:.1e} from the operator", (error < 5e-4) == is_read)


@BOTH
def test_bits(test):
    """16-bit results are cut off, not rounded: half a code too dark. And 16 bits as float: swscale is off, zscale is not."""
    codes = np.random.default_rng(7).integers(0, 65536, (64, 64, 3)).astype("<u2")
    (test.scratch / "codes.raw").write_bytes(codes.tobytes())
    (test.scratch / "darker.cube").write_text("LUT_3D_SIZE 2\n" + "".join(
        f"{0.9 * r} {0.9 * g} {0.9 * b}\n" for b in (0, 1) for g in (0, 1) for r in (0, 1)))

    def through(filter_, form):
        run(*test.program, "-v", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt", "rgb48le", "-s", "64x64", "-i",
            "codes.raw", "-vf", filter_, "-pix_fmt", form, "-f", "rawvideo", "out.raw", folder=test.scratch)
        return (test.scratch / "out.raw").read_bytes()

    shown = np.frombuffer(through("lut3d=darker.cube", "rgb48le"), "<u2").reshape(codes.shape)
    error = shown - 0.9 * codes.astype(float)
    test.report.check(f"lut3d, 16 bits: from {error.min():.2f} to {error.max():.2f} of a code, mean {error.mean():.2f}",
                      -1.01 < error.min() < -0.9 and error.max() < 0.01 and abs(error.mean() + 0.5) < 0.05)
    for filter_, least, most in (("format=gbrpf32le", 1e-5, 1e-3), ("zscale,format=gbrpf32le", 0, 1e-7)):
        if "zscale" in filter_ and "zscale" not in run(*test.program, "-v", "error", "-filters"):
            print("skipped: zscale (ffmpeg has none)")
            continue
        g, b, r = np.frombuffer(through(filter_, "gbrpf32le"), "<f4").reshape(3, *codes.shape[:2])
        error = abs(np.stack([r, g, b], axis=-1) - codes / 65535).max()
        test.report.check(f"{filter_} of 16 bits: {error:.1e}", least <= error <= most)


# ITU-R BT.2020-2, table 4, and BT.709-6, item 3.2: weights of R, G, B in luma. Limited range: item 3.5 of both.
LUMA = {"bt2020": np.array([0.2627, 0.6780, 0.0593]), "bt709": np.array([0.2126, 0.7152, 0.0722])}
HDR10 = ("colorprim=bt2020:transfer=smpte2084:colormatrix=bt2020nc:hdr10=1:max-cll=1000,400:master-display="
         "G(8500,39850)B(6550,2300)R(35400,14600)WP(15635,16450)L(10000000,1):lossless=1:log-level=error")


def ycc_of(rgb, standard, bits):
    """Whole codes of limited range, of R'G'B' in 0..1."""
    r, _, b = rgb.T
    y = rgb @ LUMA[standard]
    red, _, blue = LUMA[standard]
    c = np.stack([219 * y + 16, 224 * (b - y) / (2 - 2 * blue) + 128, 224 * (r - y) / (2 - 2 * red) + 128], axis=-1)
    return np.round(c * 2 ** (bits - 8))


def rgb_of(ycc, standard, bits):
    y, cb, cr = ((ycc / 2 ** (bits - 8) - [16, 128, 128]) / [219, 224, 224]).T
    red, green, blue = LUMA[standard]
    r, b = y + (2 - 2 * red) * cr, y + (2 - 2 * blue) * cb
    return np.stack([r, (y - red * r - blue * b) / green, b], axis=-1)


def planes_420(ycc, side):
    """Square patches in a row, as planes of 4:2:0."""
    shape = (side, side * len(ycc))
    y, cb, cr = (np.broadcast_to(np.repeat(c, side), shape) for c in ycc.T)
    return [y, cb[::2, ::2], cr[::2, ::2]]


@pytest.mark.parametrize("client", [FFMPEG], ids=str)  # with ffprobe, and the command of `list --hosts`
def test_hdr10(test):
    """The line that `list --hosts` prints, on an HDR10 clip: SDR that says that it is SDR."""
    scratch, report = test.scratch, test.report
    if "libx265" not in run("ffmpeg", "-v", "error", "-encoders") or "zscale" not in run("ffmpeg", "-v", "error", "-filters"):
        skip("HDR10 video (ffmpeg has no libx265 or no zscale)")
    hosts = json.loads(run(test.command, "list", "--hosts", "--json"))
    steps = next(host["steps"] for host in hosts if host["id"] == "ffmpeg")
    run(test.command, "bake", "agx_sobotka", "--for", "ffmpeg", "--nodes", "sampled", "-o", scratch / "sdr.cube")
    # PQ codes of the eight corners of a cube, two grays and two skins, light of up to some 1000 cd/m2.
    corners = np.array([[r, g, b] for r in (0.1, 0.7) for g in (0.1, 0.7) for b in (0.1, 0.7)])
    patches = np.concatenate([corners, [[0.3] * 3, [0.58] * 3, [0.5, 0.42, 0.37], [0.62, 0.53, 0.47]]])
    side, ycc = 32, ycc_of(patches, "bt2020", 10)
    planes = planes_420(ycc, side)
    (scratch / "hdr10.yuv").write_bytes(b"".join(plane.astype("<u2").tobytes() for plane in planes) * 3)
    tags = ("-color_primaries", "bt2020", "-color_trc", "smpte2084", "-colorspace", "bt2020nc", "-color_range", "tv")
    run("ffmpeg", "-v", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt", "yuv420p10le", "-s",
        f"{side * len(patches)}x{side}", *tags, "-i", "hdr10.yuv", "-c:v", "libx265", "-x265-params", HDR10, *tags,
        "hdr10.mkv", folder=scratch)
    line = shlex.split(steps.split(": HDR10")[0].replace("FILE", "sdr.cube"))
    run(line[0], "-v", "error", "-nostdin", "-y", *line[1:], folder=scratch)

    def fields(name):
        text = run("ffprobe", "-v", "error", "-show_streams", "-show_frames", "-read_intervals", "%+#1", "-of", "json",
                   scratch / name)
        return json.loads(text)

    want = {"pix_fmt": "yuv420p", "color_space": "bt709", "color_transfer": "bt709", "color_primaries": "bt709",
            "color_range": "tv"}
    for what, found in (("stream", fields("out.mkv")["streams"][0]), ("frame", fields("out.mkv")["frames"][0])):
        report.check(f"HDR10 to SDR: the {what}'s tags", {key: found.get(key) for key in want} == want, found)
        sides = [one["side_data_type"] for one in found.get("side_data_list", [])]
        report.check(f"HDR10 to SDR: the {what} says nothing of HDR",
                     not any("Mastering" in one or "Content light" in one for one in sides), sides)
    report.check("HDR10 to SDR: the clip itself was HDR10",
                 fields("hdr10.mkv")["streams"][0].get("color_transfer") == "smpte2084")
    run("ffmpeg", "-v", "error", "-nostdin", "-y", "-i", "out.mkv", "-frames:v", 1, "-f", "rawvideo", "-pix_fmt", "yuv420p",
        "out.yuv", folder=scratch)
    y, cb, cr = np.split(np.fromfile(scratch / "out.yuv", np.uint8)[:side * side * len(patches) * 3 // 2].astype(float),
                         [side * side * len(patches), side * side * len(patches) * 5 // 4])
    middle = side * np.arange(len(patches)) + side // 2
    shown = np.stack([y.reshape(side, -1)[side // 2, middle], cb.reshape(side // 2, -1)[side // 4, middle // 2],
                      cr.reshape(side // 2, -1)[side // 4, middle // 2]], axis=-1)
    table = read_cube(scratch / "sdr.cube")[0]
    wanted = ycc_of(tetrahedral(table, np.clip(rgb_of(ycc, "bt2020", 10), 0, 1)), "bt709", 8)
    # The encoder's own loss, at the quality that it takes by default, in flat patches.
    report.compare("HDR10 to SDR: the pixels, in codes of 8 bits", shown, wanted, 2.5)


@BOTH
def test_picture(test):
    command, scratch = test.command, test.scratch
    run(command, "chart", "-o", scratch / "chart.exr", "--width", 768, "--height", 432)
    memorial = shared_picture("memorial.hdr")
    pictures = [scratch / "chart.exr"] + ([memorial] if memorial else [])
    to_ap1 = rgb_to_rgb("rec709", "ap1").T

    run(command, "bake", "agx_sobotka", "--format", "cube", "--size", 33, "--input-encoding", "acescct",
        "--nodes", "sampled", "-o", scratch / "agx.cube")
    cube, lines = read_cube(scratch / "agx.cube")
    stated = stated_errors(lines)["tetrahedral"][0]
    test.report.bound("agx.cube: entries, as 33^3", abs(cube.size - 3 * 33**3), 0.5)
    # Uniform random codes reach every cell of the cube, and -0.1 and 1.1 what is outside.
    random = np.random.default_rng(1).uniform(-0.1, 1.1, (128, 128, 3))
    run(command, "bake", "hable", "--format", "cube", "--input-encoding", "log2", "-o", scratch / "hable.cube")
    curve, lines = read_cube(scratch / "hable.cube")
    curve_stated = stated_errors(lines)["linear"][0]
    for name, rgb in [(p.name, read_rgb(p, scratch).astype(float)) for p in pictures] + [("random", None)]:
        codes = (random if rgb is None else acescct_encode(rgb @ to_ap1)).astype(np.float32)
        graded = through_ffmpeg(test, codes, "lut3d=agx.cube:interp=tetrahedral")
        compare(test, f"lut3d, .cube 33 of ACEScct, {name}", codes, graded, cube, stated, tetrahedral,
                acescct_decode, ("agx_sobotka", "--input", "lin_ap1"))
        codes = (random if rgb is None else log2_encode(rgb)).astype(np.float32)
        graded = through_ffmpeg(test, codes, "lut1d=hable.cube:interp=linear")
        compare(test, f"lut1d, .cube 4096 of Hable, {name}", codes, graded, curve, curve_stated, linear,
                log2_decode, ("hable",))
