# SPDX-License-Identifier: Apache-2.0
"""`tonewright bake --for HOST`: every application's file has the right numbers in the right places; `verify --lut`.

    python3 -m pytest tests/parity/test_luts.py --tonewright build/release/bin/tonewright

Each file is read by another program than wrote it (OpenColorIO, OpenImageIO, NumPy for raw floats) and compared, node by
node, with `tonewright eval` of the light that the node stands for; what light that is comes from the formulas of the
encodings' makers, written down here once more.
"""

import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from lut_encodings import acescct_decode, davinci_decode, srgb_decode, unity_logc_decode
from lut_encodings import logc3_decode as logc3
from pictures import evaluate, log2_encode, need_program, pq_light, read_rgb, run, share_of

ocio = pytest.importorskip("PyOpenColorIO", reason="PyOpenColorIO is not installed (Debian: python3-pyopencolorio)")
need_program("oiiotool", "openimageio-tools")

# A view whose picture of every color is another one, so that no axis can be taken for another.
OPERATOR = ("agx_sobotka", "--look", "punchy")
# Half a unit of the last of 9 digits, in float32.
EXACT = 1e-7
# OpenColorIO's tetrahedra, in float32, at the nodes themselves.
READ = 2e-6

# encoding of `list --hosts` -> (code -> scene-linear light, the space that it is in)
ENCODINGS = {"acescct": (acescct_decode, "lin_ap1"), "logc3": (logc3, "lin_awg3"),
             "davinci": (davinci_decode, "lin_davinci_wg"), "unity_logc": (unity_logc_decode, "lin_rec709"),
             "srgb": (srgb_decode, "lin_rec709"), "pq": (pq_light, "lin_rec2020")}


def nodes_of(size):
    """Codes of the nodes, red fastest."""
    axis = np.arange(size) / (size - 1)
    b, g, r = np.meshgrid(axis, axis, axis, indexing="ij")
    return np.stack([r, g, b], axis=-1).reshape(-1, 3)


def through_ocio(path, rgb):
    """OpenColorIO's output for the file, in tetrahedra."""
    config = ocio.Config.CreateRaw()
    config.setProcessorCacheFlags(ocio.PROCESSOR_CACHE_OFF)
    transform = ocio.FileTransform(str(path), interpolation=ocio.INTERP_TETRAHEDRAL)
    image = np.array(rgb, np.float32, order="C")  # applyRGB() writes into it
    config.getProcessor(transform).getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(image)
    return image


def nodes_in_picture(path, layout, size, scratch):
    """The nodes of a Hald CLUT or a strip, red fastest."""
    picture = read_rgb(path, scratch)
    if layout == "strip_up":
        picture = picture[::-1]
    if layout == "hald":
        return picture.reshape(-1, 3)
    # Row g, slice b, column r.
    return picture.reshape(size, size, size, 3).transpose(1, 0, 2, 3).reshape(-1, 3)


def expected_of(command, codes, encoding, display, own_space=None):
    decode, space = ENCODINGS[encoding]
    space = own_space or space
    return evaluate(command, decode(codes), *OPERATOR, "--input", space, "--display", display)


def check_host(report, command, host, folder):
    if host["format"] == "icc":
        return  # clients/test_tificc.py
    if host["input_encoding"] == "linear":
        check_chains(report, command, host["id"], folder)
        return
    is_picture = host["format"] in ("hald", "strip", "strip_up")
    path = folder / f"{host['id']}.{'png' if is_picture else host['format']}"
    run(command, "bake", *OPERATOR, "--nodes", "sampled", "--for", host["id"], "-o", path)
    size, codes = host["size"], nodes_of(host["size"])
    # All nodes of a large one are a quarter of a million lines: every 29th, which meets all of all axes.
    step = 29 if size > 33 else 1
    # AgX (Sobotka) works in Rec.709.
    truth = expected_of(command, codes[::step], host["input_encoding"], host["display"],
                        "lin_rec709" if host["takes_any_primaries"] else None)
    if host["bits"]:
        truth = np.clip(truth, 0, 1)
        bound = 0.5 / (2 ** host["bits"] - 1) + EXACT  # rounded once
    else:
        bound = EXACT if is_picture else READ
    if is_picture:
        shown = nodes_in_picture(path, host["format"], size, folder)
        report.check(f"{host['id']}: {size}^3 nodes", len(shown) == size ** 3, len(shown))
        shown = shown[::step]
    else:
        shown = through_ocio(path, codes[::step])
        # A 3dl's own input has 10 bits, which the nodes of 33 are not on.
        bound += READ if host["format"] == "3dl" else 0
    report.compare(f"{host['id']}: {host['format']} {size}, {host['input_encoding']} to {host['display']}",
                   np.asarray(shown), truth, bound)
    if host["format"] == "cube":
        lines = path.read_text().splitlines()
        numbers = [line for line in lines if line and line[0] in "-0123456789"]
        words = [line.split()[0] for line in lines if line and line[0].isalpha()]
        report.check(f"{host['id']}: the file is what Adobe's specification says",
                     words == ["TITLE", "LUT_3D_SIZE", "DOMAIN_MIN", "DOMAIN_MAX"] and len(numbers) == size ** 3
                     and all("e" not in n for n in numbers) and len(lines[0]) < 250, words)


def scene_colors():
    """Scene-linear Rec.709: grays and saturated colors of -10 to 10 stops, black, white lights, negatives."""
    rng = np.random.default_rng(3)
    light = 0.18 * 2 ** rng.uniform(-10, 10, (4000, 3))
    gray = np.repeat(0.18 * 2 ** np.linspace(-10, 10, 200)[:, None], 3, axis=1)
    lamps = np.vstack([np.eye(3), 1 - np.eye(3)])[:, None, :] * 2.0 ** np.arange(-4, 11)[None, :, None]
    return np.vstack([light, gray, lamps.reshape(-1, 3), np.zeros((1, 3)), -lamps.reshape(-1, 3) / 100]).astype(np.float32)


# operator, format, largest error and 99.9 % that a chain may have: float32 and half floats for all but what has a sampled
# 3D LUT. ACES 2.0's ends at 1024 and its cells are a few codes wide there; its 99.9 % is half a code.
CHAINS = (("agx_blender", "clf", 1e-5, 1e-5), ("agx_sobotka", "clf", 1e-5, 1e-5), ("hable", "clf", 1e-5, 1e-6),
          ("khronos_neutral", "ctf", 2e-5, 2e-5), ("reinhard_extended:luminance", "ctf", 5e-5, 5e-5), ("aces_13", "ctf", 1e-5, 5e-6),
          ("aces_20", "ctf", 1e-2, 4e-3))


def check_chains(report, command, host, folder):
    """clf and ctf files of scene-linear input have every operation of the view, so they are nearly exact."""
    colors = scene_colors()
    for op, form, largest, most in CHAINS:
        path = folder / f"{op.replace(chr(58), chr(95))}.{form}"
        run(command, "bake", op, "--for", host, "-o", path)
        errors = np.abs(through_ocio(path, colors) - evaluate(command, colors, op)).max(axis=1)
        report.check(f"{host}: {op} as {form} of scene-linear input: largest error {errors.max():.1g}, 99.9 % {np.percentile(errors, 99.9):.1g}",
                     errors.max() <= largest and np.percentile(errors, 99.9) <= most, errors.max())
        head = path.read_text(errors="replace")[:3000]
        report.check(f"{op}: the header says what it takes", "Input: scene-linear Linear Rec.709" in head, head)
    # `eval --lut` follows the header, and another space has a matrix.
    ap1 = folder / "ap1.clf"
    run(command, "bake", "agx_blender", "--format", "clf", "--input-encoding", "linear", "--input", "lin_ap1", "-o", ap1)
    report.compare("agx_blender of AP1", through_ocio(ap1, colors), evaluate(command, colors, "agx_blender", "--input", "lin_ap1"), 1e-5)
    report.compare("eval --lut of it", evaluate(command, colors[::40], "--lut", ap1),
                   evaluate(command, colors[::40], "agx_blender"), 1e-5)


def test_applications(report, command, scratch):
    hosts = json.loads(run(command, "list", "--hosts", "--json"))
    report.check("hosts", len(hosts) >= 18, len(hosts))
    for host in share_of(hosts, 3):
        check_host(report, command, host, scratch)


def test_formats(report, command, scratch):
    """Options that no application has by default."""
    codes = nodes_of(17)
    truth = expected_of(command, codes, "acescct", "srgb")
    path = scratch / "x.raw"
    run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", "raw", "--size", 17, "--3d", "-o", path)
    report.compare("raw: float32, red fastest", np.fromfile(path, "<f4").reshape(-1, 3), truth, EXACT)
    path = scratch / "x.csp"
    run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", "csp", "--size", 17, "-o", path)
    # Its readers resample the prelut to 65536 equal steps of light: 3.4e-3 up to 222.9, where steps at black are some
    # stops. From mid gray on they are less than a fiftieth of a stop.
    light = acescct_decode(codes)
    shown, bright = through_ocio(path, light), (light >= 0.18).all(axis=1)
    report.compare("csp: scene-linear in, from mid gray on", shown[bright], truth[bright], 2e-5)
    report.compare("csp: all light", shown, truth, 2e-3)
    path = scratch / "logc3.csp"  # OpenColorIO keeps tables by their files' names
    run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", "csp", "--size", 17, "--input-encoding", "logc3",
        "-o", path)
    light = logc3(codes)
    shown, bright = through_ocio(path, light), (light >= 0.18).all(axis=1)
    report.compare("csp: LogC3, from mid gray on", shown[bright],
                   expected_of(command, codes[bright], "logc3", "srgb"), 2e-5)
    path = scratch / "shaper.cube"
    run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", "resolve_cube", "--size", 17, "--input-encoding",
        "logc3", "-o", path)
    shown = through_ocio(path, light)
    report.compare("resolve_cube: LogC3, from mid gray on", shown[bright],
                   expected_of(command, codes[bright], "logc3", "srgb"), 2e-5)
    report.compare("resolve_cube: all light", shown, expected_of(command, codes, "logc3", "srgb"), 2e-3)
    # What the header says of it has the 1D LUT before the 3D LUT in it: colors between the nodes, by OpenColorIO.
    light = np.random.default_rng(4).uniform(-0.017, 1, (20000, 3)).astype(np.float32).astype(float) ** 3
    error = np.abs(through_ocio(path, light) - evaluate(command, light, *OPERATOR, "--input", "lin_awg3")).max()
    stated = float(re.search(r"tetrahedral.* max ([-0-9.e]+),", path.read_text(errors="replace")[:4000]).group(1))
    report.check(f"resolve_cube: error {error:.2g}, stated {stated:.2g}", error <= stated, (error, stated))
    path = scratch / "x.ctf"
    run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", "ctf", "--size", 17, "-o", path)
    report.compare("ctf", through_ocio(path, codes), truth, READ)
    path = scratch / "linear.cube"
    run(command, "bake", "gt7", "--3d", "--display", "linear", "--input-encoding", "unity_logc", "--nodes", "fitted",
        "--size", 17, "-o", path)
    lowest = through_ocio(path, codes).min()
    wanted = evaluate(command, unity_logc_decode(codes), "gt7", "--display", "linear").min()
    report.check(f"fitted nodes keep what is below 0 in linear output: {lowest:.2g} of {wanted:.2g}",
                 wanted - 1e-6 <= lowest <= wanted / 2 < 0, (lowest, wanted))
    path = scratch / "x.exr"
    run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", "strip", "--size", 16, "--depth", 32, "-o", path)
    truth_16 = expected_of(command, nodes_of(16), "acescct", "srgb")
    report.compare("strip: float", nodes_in_picture(path, "strip", 16, scratch), truth_16, EXACT)
    # 8 bits would be coarser than a code of 10 bits: who wants them says so.
    for layout in ("strip", "strip_up", "hald"):
        path = scratch / f"default_{layout}.png"
        run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", layout, "--size", 16, "-o", path)
        report.compare(f"{layout}: 16 bits by default", nodes_in_picture(path, layout, 16, scratch), truth_16,
                       0.5 / 65535 + EXACT)
    # A saturated code through the file, whichever way up it stands: `eval --lut` knows from the file.
    for layout, suffix in (("strip", "png"), ("strip_up", "png"), ("strip_up", "tif"), ("strip_up", "exr")):
        path = scratch / f"way_up_{layout}.{suffix}"
        depth = 32 if suffix == "exr" else 16
        run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", layout, "--size", 16, "--depth", depth, "-o", path)
        got = [float(v) for v in run(command, "eval", "--lut", path, "--input-encoding", "none", stdin="0.8 0.2 0.4\n").split()]
        report.compare(f"eval --lut of {layout} in .{suffix}", np.array([got]), truth_16[[12 + 16 * 3 + 256 * 6]], 0.5 / 65535 + EXACT)
    for bits in (10, 12, 16):
        path = scratch / f"x{bits}.3dl"
        run(command, "bake", *OPERATOR, "--nodes", "sampled", "--format", "3dl", "--size", 17, "--depth", bits, "-o", path)
        report.compare(f"3dl: {bits} bits", through_ocio(path, codes), truth, 0.5 / (2 ** bits - 1) + READ)


def test_fit(report, command, scratch):
    """A fitted cube is nearer between its nodes, by OpenColorIO's interpolation of colors it was not fitted to; and
    --max-error takes the smallest size that keeps to it on photographs."""
    codes = np.random.default_rng(8).uniform(0, 1, (20000, 3)).astype(np.float32).astype(float)
    truth = expected_of(command, codes, "unity_logc", "linear")
    means = {}
    for nodes in ("sampled", "fitted", "auto"):
        path = scratch / f"{nodes}.cube"
        run(command, "bake", *OPERATOR, "--for", "unity", "--nodes", nodes, "-o", path)
        means[nodes] = np.abs(through_ocio(path, codes) - truth).max(axis=1).mean()
    # A fifth of the colors that `auto` is fitted to are no photographs', so it gains elsewhere, too.
    report.check(f"fitted nodes: mean error {means['fitted']:.1e}, by photographs {means['auto']:.1e}, sampled {means['sampled']:.1e}",
                 means["fitted"] < 0.9 * means["sampled"] and means["auto"] < 0.9 * means["sampled"], means)
    light = photograph_colors(20000)
    light = light[light.max(1) <= 0.18 * 2**6.5]  # what the encoding holds
    codes = np.clip(log2_encode(light), 0, 1).astype(np.float32).astype(float)
    truth = evaluate(command, light, "agx_sobotka")

    def error_of(path):
        return np.percentile(np.abs(through_ocio(path, codes) - truth).max(axis=1), 99.9)

    sizes = []
    # Another sample of the same histogram has another percentile: 20,000 colors, twenty of them beyond it.
    sampling = 1.3
    for wanted in (0.02, 0.002):
        path = scratch / f"{wanted}.cube"
        run(command, "bake", "agx_sobotka", "--3d", "--input-encoding", "log2", "--max-error", wanted, "-o", path)
        lines = path.read_text().splitlines()
        sizes.append(int(next(line for line in lines if line.startswith("LUT_3D_SIZE")).split()[1]))
        error = error_of(path)
        report.check(f"--max-error {wanted} takes {sizes[-1]} points: {error:.2g} on photographs", error <= wanted * sampling, error)
    report.check("a smaller --max-error takes more points", sizes[0] == 17 < sizes[1], sizes)
    smaller = {25: 17, 33: 25, 49: 33, 65: 49}[sizes[1]]
    path = scratch / "smaller.cube"
    run(command, "bake", "agx_sobotka", "--3d", "--input-encoding", "log2", "--size", smaller, "-o", path)
    error = error_of(path)
    report.check(f"{smaller} points are too few for 0.002: {error:.2g}", error > 0.002 / sampling, error)


def photograph_colors(count):
    """Colors drawn from the histogram of src/measure/photograph_density.py, linear Rec.709."""
    density = Path(__file__).resolve().parents[2] / "src" / "measure" / "photograph_density"
    axes = dict(re.findall(r"^(DARKEST, STEP|SATURATIONS|HUES) = (.*)$", density.with_suffix(".py").read_text(), re.M))
    darkest, step = (float(v) for v in axes["DARKEST, STEP"].split(","))
    saturations, hues = np.array(eval(axes["SATURATIONS"])), float(axes["HUES"])  # noqa: S307
    bins = np.array(re.findall(r"\{(\d+),(\d+),(\d+),(\d+)\}", density.with_suffix(".inc").read_text()), int)
    rng = np.random.default_rng(11)
    stops, saturation, hue, _count = bins[rng.choice(len(bins), count, p=bins[:, 3] / bins[:, 3].sum())].T
    u = rng.uniform(size=(3, count))
    largest = 0.18 * 2 ** (darkest + step * (stops + u[0]))
    smallest = largest * (1 - (saturations[saturation] + (saturations[saturation + 1] - saturations[saturation]) * u[1]))
    place = (hue + u[2]) * 6 / hues
    # The hexcone: a channel is largest within a sixth of its own hue, and smallest two sixths away.
    apart = np.abs((place[:, None] - np.array([0, 2, 4]) + 3) % 6 - 3)
    return smallest[:, None] + (largest - smallest)[:, None] * np.clip(2 - apart, 0, 1)


def test_clipping(report, command, scratch):
    """`bake` says which stops an encoding clips, of what the operator would show: by eval, on grays."""
    ends = [(name, 0, float(ENCODINGS[name][0](np.array(1.0))))
            for name in ("acescct", "logc3", "davinci", "unity_logc", "srgb", "pq")]
    ends += [(f"log2:{low}:{high}", 0.18 * 2.0 ** low, 0.18 * 2.0 ** high) for low, high in ((-10, 6.5), (-4, 2), (-20, 18))]
    for encoding, low, high in ends:
        # Per channel and of Rec.709: a saturated color clips as a gray does.
        done = subprocess.run([command, "bake", "hable", "--3d", "--size", "17", "--nodes", "sampled", "--input", "lin_rec709",
                               "--input-encoding", encoding, "-o", scratch / "clip.cube"], capture_output=True, text=True,
                              check=True)
        above = re.search(r"above \+?([-.0-9]+) stops from 0.18, (?:up to \+([.0-9]+)|without end), by up to ([-.0-9e]+)", done.stderr)
        below = re.search(r"below \+?([-.0-9]+) stops(?: from 0.18)?, down to (?:([-+.0-9]+)|black), by up to ([-.0-9e]+)", done.stderr)
        for side, said, end, beyond in (("above", above, high, high * 2.0 ** np.arange(0, 18.5, 1 / 16)),
                                        ("below", below, low, low * 2.0 ** -np.arange(0, 24, 1 / 16))):
            light = np.minimum(beyond, 65504)
            light = light[light >= 2.0 ** -24]
            gray = evaluate(command, np.repeat(np.append(light, end)[:, None], 3, axis=1), "hable")[:, 0]
            difference = np.abs(gray[:-1] - gray[-1])
            seen = difference > 1 / 1023
            if not seen.any():
                report.check(f"clipping, {encoding}: nothing {side}", said is None, done.stderr)
                continue
            wanted = np.log2(end / 0.18), np.log2(light[seen][-1] / 0.18), difference.max()
            # The ends of half floats are as good as none.
            last = np.log2((65504 if side == "above" else 2.0 ** -24) / 0.18)
            found = [last if number is None else float(number) for number in said.groups()] if said else [np.nan] * 3
            # Stops have two decimals and steps of 1/16; the difference two digits, rounded up.
            report.check(f"clipping, {encoding}: {side} {wanted[0]:.2f} to {wanted[1]:.2f}, {wanted[2]:.2g}",
                         abs(found[0] - wanted[0]) < 0.006 and abs(found[1] - wanted[1]) < 1 / 16 + 0.006
                         and wanted[2] * 0.98 <= found[2] <= wanted[2] * 1.1, done.stderr)
            text = (scratch / "clip.cube").read_text()
            report.check(f"clipping, {encoding}: the file says so, too", f"{side} {said[1] if side == 'below' else '+' + said[1]} "
                         "stops" in text[:2000] if said else False, text[:1500])


def test_match(report, command, scratch):
    """`verify --lut` tells what a file is, by what it does; also of a file whose text says nothing of it."""
    for op, arguments, expected in (
            ("agx_sobotka", ["--3d", "--input-encoding", "log2"], ("log2:-10:6.5", "lin_rec709", "srgb")),
            ("hable", ["--3d", "--input-encoding", "slog3", "--display", "rec1886"], ("slog3", "lin_sgamut3", "rec1886")),
            ("khronos_neutral", ["--for", "unity"], ("unity_logc", "lin_rec709", "linear")),
            ("reinhard", ["--format", "csp"], ("scene-linear", "lin_ap1", "srgb"))):
        path = scratch / f"{op}.{'csp' if 'csp' in arguments else 'cube'}"
        run(command, "bake", op, "--nodes", "sampled", *arguments, "-o", path)
        lines = path.read_text().splitlines()
        path.write_text("\n".join(line for line in lines if not line.startswith(("#", "TITLE"))) + "\n")
        found = json.loads(run(command, "verify", "--json", "--lut", path, "hable", "agx_sobotka", "khronos_neutral",
                               "reinhard"))
        best = found[0]
        report.check(f"verify --lut: {op}, {expected}",
                     (best["operator"], best["input_encoding"], best["input"], best["display"]) == (op, *expected),
                     found[:2])
        report.check("verify --lut: the nearest come first", [m["mean"] for m in found] == sorted(m["mean"] for m in found)
                     and best["mean"] < 1e-2 < found[-1]["mean"], found)
    broken = scratch / "broken.cube"
    for text in ("", "LUT_3D_SIZE 2\n0 0 0\n", "LUT_3D_SIZE 2\n" + "0 0 x\n" * 8, "LUT_3D_SIZE 100000\n0 0 0\n"):
        broken.write_text(text)
        done = subprocess.run([command, "verify", "--lut", broken], capture_output=True, text=True, check=False)
        report.check(f"verify --lut of {text[:22]!r}", done.returncode == 3 and done.stderr.count("\n") == 1
                     and "broken.cube" in done.stderr, done.stderr)


def test_errors(report, command, scratch):
    """One line that names what is wrong, exit status 2, and no file."""
    for arguments, words in ((["--for", "reslove"], "--for is reslove; did you mean resolve?"),
                             (["--format", "3dl", "--depth", "8"], "depth is 8; expected 12, 10 or 16 for 3dl"),
                             (["--format", "cube", "--depth", "16"], "depth is 16; expected 32 for cube"),
                             (["--format", "hald", "--size", "33"], "size is 33; a square"),
                             (["--format", "strip", "--size", "65"], "size is 65; [2, 64]"),
                             (["--size", "33", "--max-error", "0.1"], "size is 33; no size with --max-error"),
                             (["--format", "strip", "--max-error", "1e-9"], "--max-error is 1e-09; at least"),
                             (["--depth", "0"], "depth is 0; expected 32 for cube"),
                             (["--format", "icc", "--depth", "8"], "depth is 8; expected 16 for icc"),
                             (["--format", "icc", "--icc-version", "3"], "--icc-version; 3"),
                             (["--icc-version", "4"], "--icc-version is given for cube; expected format icc with it"),
                             (["--format", "lut", "--1d"], "format is lut; a 1D format"),
                             (["--format", "resolve_cube", "--input-encoding", "pq:10"], "pq:10; up to 223"),
                             (["--format", "3dl", "--size", "20"], "size is 20; 17, 33 or 65"),
                             (["--format", "csp", "--input-encoding", "log2:-10:15"], "log2:-10:15; up to 223"),
                             (["--for", "unreal", "--depth", "8"], "none.exr; .png or .tif for 8 bits"),
                             (["--format", "hald", "--depth", "32"], "none.png; .exr or .tif for 32 bits"),
                             (["--for", "unreal", "--max-error", "0.1"], "--max-error is given for unreal; its size is 16"),
                             (["--format", "3dl", "--1d"], "format is 3dl; a 1D format"),
                             (["--for", "resolve", "--3d", "--input-encoding", "linear"], "linear; another for a 3D table")):
        form = arguments[arguments.index("--format") + 1] if "--format" in arguments else "cube"
        extension = {"hald": "png", "strip": "png", "resolve_cube": "cube"}.get(form, form)
        if "unreal" in arguments:
            extension = "exr" if "none.exr" in words else "png"
        path = scratch / f"none.{extension}"
        done = subprocess.run([command, "bake", "hable", *arguments, "-o", path], capture_output=True, text=True,
                              check=False)
        report.check(f"bake hable {' '.join(arguments)}: {words}",
                     done.returncode == 2 and done.stderr.count("\n") == 1 and not path.exists()
                     and all(word in done.stderr for word in words.split("; ")), done.stderr)
