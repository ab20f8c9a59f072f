# SPDX-License-Identifier: Apache-2.0
"""The OpenColorIO config of `tonewright config`: what applications demand of it, and its numbers.

    python3 -m pytest tests/parity/test_config.py --tonewright build/release/bin/tonewright

The views' own numbers are `tonewright verify`; here they go through check_config.py, the script for users.
"""

import re
import subprocess

import check_config
import lut_encodings
import numpy as np
import operators
import pytest
from pictures import PROJECT, need_program, run

ocio = pytest.importorskip("PyOpenColorIO", reason="PyOpenColorIO is not installed (Debian: python3-pyopencolorio)")

# Roles that applications look up: OCIO itself and the two interchange spaces, Blender, Nuke and Natron, RV.
ROLES = ["aces_interchange", "cie_xyz_d65_interchange", "default", "reference", "scene_linear", "rendering", "data",
         "color_picking", "color_timing", "compositing_log", "matte_paint", "texture_paint", "default_byte",
         "default_float", "default_sequencer"]
# Names that scripts and files use, and the space that each must find: what OpenImageIO calls every EXR and every HDR,
# the names of Blender 3 and of the ACES configs, the ids of the color interop forum.
ALIASES = {"Linear": "Linear Rec.709", "linear": "Linear Rec.709", "lin_srgb": "Linear Rec.709",
           "Linear Rec.709 (sRGB)": "Linear Rec.709", "lin_rec709_scene": "Linear Rec.709",
           "Utility - Linear - sRGB": "Linear Rec.709", "lin_ap1": "ACEScg", "ACES - ACEScg": "ACEScg",
           "lin_ap0": "ACES2065-1", "lin_rec2020": "Linear Rec.2020", "lin_p3d65": "Linear P3-D65",
           "srgb_tx": "sRGB - Texture", "Raw": "Non-Color", "Utility - Raw": "Non-Color", "sRGB - Display": "sRGB",
           "Rec.1886 - Display": "Rec.1886", "g22_ap1_tx": "Gamma 2.2 AP1 - Texture",
           "arri_logc3_ei800": "ARRI LogC3 (EI800)", "arri_logc4": "ARRI LogC4", "KodakLog": "Cineon", "acescct_ap1": "ACEScct", "displayp3_display": "Display P3",
           "rec2100_pq_display": "Rec.2100-PQ", "out_agx_srgb": "Output - AgX - sRGB"}
# space of the config -> primaries in python_check/operators/spaces.py
LINEAR = {"Linear Rec.709": "rec709", "ACEScg": "ap1", "ACES2065-1": "ap0", "Linear Rec.2020": "rec2020",
          "Linear P3-D65": "p3d65", "Linear FilmLight E-Gamut": "egamut"}
# FilmLight E-Gamut, 2018: the one space that no operator there needs.
EGAMUT = ((0.8, 0.3177), (0.18, 0.9), (0.065, -0.0805), (0.3127, 0.3290))
# Views that artists look for, in the order of menus; the first is the default view.
VIEWS = ["AgX", "AgX Punchy", "ACES 2.0", "ACES 1.3", "Khronos PBR Neutral", "Reinhard Extended", "Hable", "Gran Turismo",
         "ACES Narkowicz", "AgX Sobotka", "Standard", "False Color", "Un-tone-mapped", "Raw"]
DISPLAYS = ["sRGB", "Display P3", "Rec.1886", "Rec.2020", "Gamma 2.2", "Rec.2100-PQ", "Rec.2100-HLG", "P3-D65 PQ"]
# Names of pictures, and the space that they are read in.
FILES = {"shot.exr": "Linear Rec.709", "light.hdr": "Linear Rec.709", "logo.png": "sRGB - Texture",
         "photo.jpg": "sRGB - Texture", "scan.tif": "sRGB - Texture", "/plates/shot_acescg.0001.exr": "ACEScg",
         "/plates/shot_lin_ap0_v2.exr": "ACES2065-1", "a.LogC3.dpx": "ARRI LogC3 (EI800)",
         "wood_raw.png": "Non-Color", "/raw/wood.png": "sRGB - Texture", "/acescg/data/sky.exr": "Linear Rec.709",
         "rawhide.png": "sRGB - Texture", "shot_srgb.exr": "sRGB - Texture",
         "clip_S-Log3_S-Gamut3.Cine.mov": "S-Log3 S-Gamut3.Cine", "slog3_sgamut3cine": "S-Log3 S-Gamut3.Cine",
         "clip_S-Log3_S-Gamut3.mov": "S-Log3 S-Gamut3", "A003_LogC4.mxf": "ARRI LogC4",
         "M001_Log3G10.mov": "Log3G10 REDWideGamutRGB", "x_DWG_DI.mov": "DaVinci Intermediate WideGamut", "scan.0001.dpx": "Cineon", "scan.cin": "Cineon",
         "plate_rec709.0001.dpx": "Gamma 2.4 Rec.709 - Texture", "photo.jxl": "sRGB - Texture",
         "photo.heic": "sRGB - Texture", "photo.avif": "sRGB - Texture", "photo.jp2": "sRGB - Texture",
         "wood.tx": "sRGB - Texture", "sky.exr.tx": "Linear Rec.709", "wood_sRGB - Texture_ACEScg.png.tx": "ACEScg"}
# ARRI prints LogC3's constants with six digits, OpenColorIO derives them: 3e-5 of code values. The rest is float32.
CAMERA = 5e-5
# Bytes of the folder, which people clone.
LARGEST = 51e6
NAME_BYTES = 63  # Blender's limit
# Float32: one product of matrices with entries up to 2.
MATRIX = 1e-6
# Two half-domain tables and two matrices in float32.
ROUND_TRIP = 1e-6
# The same of codes of HDR displays, as light: near the peak its logarithm grows by 9 (PQ) or 7 (HLG) over a code of 1.
HDR_ROUND_TRIP = 9 * ROUND_TRIP


@pytest.fixture(scope="module")
def folder(command, tmp_path_factory):
    """The folder of the config. test_artifacts.py holds the committed one to be what the command writes."""
    folder = PROJECT / "ocio_config"
    if not folder.is_dir():
        folder = tmp_path_factory.mktemp("config")
        run(command, "config", "-o", folder)
    return folder


@pytest.fixture(scope="module")
def config(folder):
    return ocio.Config.CreateFromFile(str(folder / "config.ocio"))


def test_ociocheck(report, folder):
    need_program("ociocheck", "opencolorio-tools")
    done = subprocess.run(["ociocheck", "--iconfig", folder / "config.ocio"], capture_output=True, text=True, check=False)
    lines = (done.stdout + done.stderr).splitlines()
    bad = [line for line in lines if re.search("warn|error|fail", line, re.I)]
    report.check("ociocheck passes", done.returncode == 0 and ("passed" in lines or "Tests complete." in lines),
                 lines[-3:])
    report.check("ociocheck has no warning", not bad, bad[:3])


def test_profile(report, config):
    report.check("profile 2.1", (config.getMajorVersion(), config.getMinorVersion()) == (2, 1))


def test_names(report, config):
    spaces = list(config.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL))
    view_names = [view for display in config.getDisplays() for view in config.getViews(display)]
    names = [n for s in spaces for n in [s.getName(), *s.getAliases()]]
    all_names = [*names, *view_names, *config.getDisplays(), *config.getRoleNames(), *config.getViewTransformNames()]
    long = [n for n in all_names if len(n.encode()) > NAME_BYTES]
    report.check(f"names have at most {NAME_BYTES} bytes", not long, long[:3])
    twice = {n for n in names if [m.lower() for m in names].count(n.lower()) > 1}
    report.check("no name of a space is there twice", not twice, sorted(twice)[:3])
    roles = {r.lower() for r in config.getRoleNames()}
    shadowed = [n for n in names if n.lower() in roles]
    report.check("no name of a space is a role", not shadowed, shadowed)
    missing = [r for r in ROLES if not config.hasRole(r)]
    report.check(f"{len(ROLES)} roles of applications", not missing, missing)
    wrong = [n for n in ALIASES if config.getCanonicalName(n) != ALIASES[n]]
    report.check(f"{len(ALIASES)} names of others are found", not wrong,
                 [f"{n} is {config.getCanonicalName(n) or 'unknown'}, expected {ALIASES[n]}" for n in wrong])
    no_text = [s.getName() for s in spaces if not s.getDescription() or not s.getEncoding() or not s.getFamily()]
    report.check("spaces have description, encoding and family", not no_text, no_text)


def test_views(report, config):
    """Views and displays in their order, shown through view transforms, and every processor can be built."""
    displays = list(config.getDisplays())
    report.check("displays", displays == DISPLAYS and config.getDefaultDisplay() == "sRGB", displays)
    shown_views = list(config.getViews("sRGB"))
    report.check("views", shown_views == VIEWS, shown_views)
    missing, direct, broken, differ, count = [], [], [], [], 0
    gray = [0.18, 0.18, 0.18]
    names = {s.getName() for s in config.getColorSpaces()}
    for display in displays:
        plain = {view.split(" - HDR ")[0] for view in config.getViews(display)}
        # The HDR forms of ACES 2.0 are large: `tonewright config --views`.
        left_out = {"ACES 2.0"} if "2100" in display or "PQ" in display else set()
        missing += [f"{display}: {v}" for v in VIEWS if v not in plain | left_out]
        for view in config.getViews(display):
            count += 1
            if not config.getDisplayViewTransformName(display, view) and view != "Raw":
                direct.append(f"{display}: {view}")
            try:
                processor = config.getProcessor("Linear Rec.709", display, view, ocio.TRANSFORM_DIR_FORWARD)
                shown = processor.getDefaultCPUProcessor().applyRGB(gray)
                if not all(0 <= v <= 1 for v in shown):
                    broken.append(f"{display}: {view}: gray is {shown}")
                space = f"Output - {view} - {display}"
                if view in ("Raw", "Un-tone-mapped"):
                    continue
                if space not in names:
                    missing.append(space)
                    continue
                same = config.getProcessor("Linear Rec.709", space).getDefaultCPUProcessor().applyRGB(gray)
                if same != shown:
                    differ.append(f"{space}: gray is {same}, of the view {shown}")
            except ocio.Exception as error:
                broken.append(f"{display}: {view}: {error}")
    report.check("every view is on every display, and is a space", not missing, missing[:3])
    report.check("every view but Raw has a view transform", not direct, direct[:3])
    report.check(f"{count} processors, all display-referred gray", not broken, broken[:3])
    report.check("output spaces show what views show", not differ, differ[:3])


def test_looks(report, config):
    """A look of its own before the view, for hosts that know looks, and the view that has it built in."""
    looks = list(config.getLookNames())
    report.check("looks", len(looks) == 9 and "AgX - Punchy" in looks and
                 all(n.split(" - ")[0] in VIEWS for n in looks), looks)
    rng = np.random.default_rng(3)
    light = np.exp2(rng.uniform(-10, 5, (4096, 3))).astype(np.float32)
    look = ocio.LookTransform(src="Linear Rec.709", dst="Linear Rec.709", looks="AgX - Punchy")
    for display in ("sRGB", "Rec.2020"):
        shown = []
        for transforms in ([look, ocio.DisplayViewTransform("Linear Rec.709", display, "AgX")],
                           [ocio.DisplayViewTransform("Linear Rec.709", display, "AgX Punchy")]):
            image = light.copy()
            for transform in transforms:
                config.getProcessor(transform).getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(image)
            shown.append(image)
        # Two matrices and float32 more, before the logarithm of a cube's axes.
        report.compare(f"the look Punchy is the view AgX Punchy on {display}", *shown, 2e-5)


def test_rules(report, config):
    wrong = [(name, config.getColorSpaceFromFilepath(name)) for name in FILES]
    wrong = [f"{name}: {space}, expected {FILES[name]}" for name, (space, _) in wrong if space != FILES[name]]
    report.check(f"{len(FILES)} names of pictures", not wrong, wrong)


def slog3_decode(code):
    """Sony, "Technical Summary for S-Gamut3.Cine/S-Log3 and S-Gamut3/S-Log3"."""
    return np.where(code >= 171.2102946929 / 1023, 10 ** ((code * 1023 - 420) / 261.5) * 0.19 - 0.01,
                    (code * 1023 - 95) * 0.01125 / (171.2102946929 - 95))


def test_cameras(report, config, command):
    """The makers' matrices, and one gamut of a camera in `--input` and in the config."""
    codes = np.concatenate([np.repeat(np.arange(33)[:, None] / 32, 3, axis=1),
                            np.random.default_rng(8).uniform(0.2, 0.8, (2000, 3))])
    # ARRI, "LogC4 Logarithmic Color Space, Specification", 2022, 4.1.
    a, b, c = (2**18 - 16) / 117.45, (1023 - 95) / 1023, 95 / 1023
    logc4 = (2 ** (14 * (codes - c) / b + 6) - 64) / a
    light = logc4 @ operators.spaces.rgb_to_rgb(operators.spaces.CAMERAS["awg4"], "ap0").T
    shown = apply(config, "ARRI LogC4", "ACES2065-1", codes)
    scale = np.abs(light).max(axis=1, keepdims=True) + 0.01
    report.compare("ARRI LogC4 is ARRI's", shown / scale, light / scale, 1e-5)
    # Blackmagic Design, "DaVinci Resolve 17 Wide Gamut Intermediate", 2021.
    davinci = lut_encodings.ENCODINGS["davinci"]
    light = davinci.decode(codes) @ operators.spaces.rgb_to_rgb(davinci.primaries, "ap0").T
    shown = apply(config, "DaVinci Intermediate WideGamut", "ACES2065-1", codes)
    scale = np.abs(light).max(axis=1, keepdims=True) + 0.01
    report.compare("DaVinci Intermediate is Blackmagic Design's", shown / scale, light / scale, 1e-5)
    # Kodak's published aims: black at code 95, white at 685, 0.002 density a code, gamma 0.6.
    black = 10 ** ((95 - 685) * 0.002 / 0.6)
    film = (10 ** ((codes * 1023 - 685) * 0.002 / 0.6) - black) / (1 - black)
    shown = apply(config, "Cineon", "Linear Rec.709", codes)
    scale = np.abs(film).max(axis=1, keepdims=True) + 0.01
    report.compare("Cineon is Kodak's", shown / scale, film / scale, 1e-5)
    for name, space, decode in (("ARRI LogC3 (EI800)", "lin_awg3", lut_encodings.logc3_decode),
                                ("S-Log3 S-Gamut3", "lin_sgamut3", slog3_decode),
                                ("S-Log3 S-Gamut3.Cine", "lin_sgamut3cine", slog3_decode)):
        image = codes.astype(np.float32)
        processor = config.getProcessor(name, "sRGB", "Standard", ocio.TRANSFORM_DIR_FORWARD)
        processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(image)
        lines = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in decode(codes).tolist())
        done = run(command, "eval", "clamp", "--input", space, stdin=lines)
        truth = np.array([[float(v) for v in re.split("[ ,]+", line.strip())] for line in done.splitlines()])
        report.compare(f"{space} is the config's {name}", image, truth, CAMERA)


def test_round_trips(report, config, folder):
    """The README's figures for the inverse, for colors of its kind, without loss and by default."""
    stated = {}
    for line in (folder / "README.md").read_text().splitlines():
        cells = [c.strip() for c in line.split("|")]
        if len(cells) > 8 and cells[1] in VIEWS:
            stated[cells[1]] = None if cells[7] == "none" else (float(cells[7]), float(cells[8]))
    report.check("every view but False Color has an inverse",
                 [view for view, bounds in stated.items() if bounds is None] == ["False Color"], stated)
    rng = np.random.default_rng(21)
    light = np.exp2(rng.uniform(-12, 12, (4000, 3))).astype(np.float32)
    for view, bounds in stated.items():
        if bounds is None:
            continue
        space = f"Output - {view} - sRGB"
        there = apply(config, "Linear Rec.709", space, light)
        for bound, form in zip(bounds, (ocio.OPTIMIZATION_LOSSLESS, ocio.OPTIMIZATION_DEFAULT)):
            again = apply(config, "Linear Rec.709", space, apply(config, space, "Linear Rec.709", there, form))
            # Other colors than those that the README's figure is of, and float32 each way.
            report.bound(f"{space}: and back, {form.name}, 99.9 %",
                         np.quantile(np.abs(again - there).max(1), 0.999), 3 * bound + 1e-6)


def test_inverses(report, config):
    """Cubes that lead back are tables of their own: OpenColorIO's inversion of a cube is coarse on the GPU."""
    inverted, silent, dark, count = [], [], [], 0
    for space in config.getColorSpaces():
        name = space.getName()
        if not name.startswith("Output - "):
            continue
        try:
            processor = config.getProcessor(name, "Linear Rec.709")
        except ocio.Exception as error:
            if "False Color" not in name or "Singular Matrix" not in str(error):
                silent.append(f"{name}: {error}")
            continue
        count += 1
        if "False Color" in name:
            silent.append(f"{name} is inverted")
        inverted += [name for part in processor.createGroupTransform() if isinstance(part, ocio.Lut3DTransform)
                     and part.getDirection() == ocio.TRANSFORM_DIR_INVERSE]
        # Black codes of logos and frames: no light that is seen. Half a code of 16 bits on sRGB is 6e-7. The
        # Academy's own inverse of ACES 1.3, OpenColorIO's built-in, has 0.002 for black.
        black = np.abs(apply(config, name, "Linear Rec.709", [[0, 0, 0]], ocio.OPTIMIZATION_DEFAULT)).max()
        if not black <= 6e-7 and "ACES 1.3" not in name:
            dark.append(f"{name}: {black}")
    report.check(f"no cube of {count} output spaces is inverted by OpenColorIO", count > 50 and not inverted,
                 inverted[:3])
    report.check("OpenColorIO refuses the inverse of False Color, and of nothing else", not silent, silent[:3])
    report.check("black comes back as black", not dark, dark[:5])


def test_files(report, folder):
    names = sorted(p.name for p in (folder / "luts").iterdir())
    odd = [n for n in names if not re.fullmatch(r"[a-z0-9_]+\.(clf|ctf)", n) or re.search(r"_[0-9a-f]{8}\.", n)]
    report.check(f"{len(names)} LUT files have plain ASCII names without a hash", names and not odd, odd)
    tables = [re.sub(r"^.*?<LUT", "<LUT", (folder / "luts" / n).read_text(), flags=re.S) for n in names]
    report.check("every table is there once", len(set(tables)) == len(tables))
    bad = [n for n in names if re.search(r"\b(nan|inf)\b", (folder / "luts" / n).read_text(), re.I)]
    report.check("no table has NaN or infinities", not bad, bad)
    text = (folder / "config.ocio").read_text()
    used = set(re.findall(r"src: (\w+\.c[lt]f)", text))
    report.check("the config names these files and no others", used == set(names), used ^ set(names))
    report.check("every interpolation is linear or tetrahedral",
                 set(re.findall(r"interpolation: (\w+)", text)) <= {"linear", "tetrahedral"})
    cubes = {m for m in re.findall(r"src: (\w*_cube\w*\.clf), interpolation: (\w+)", text) if m[1] != "tetrahedral"}
    report.check("cubes are tetrahedral", not cubes, cubes)
    size = sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())
    report.bound("bytes", size, LARGEST)
    listed = [line.split(",")[0] for line in (folder / "MANIFEST.csv").read_text().splitlines()[1:]]
    report.check("MANIFEST.csv lists them", sorted(listed) == sorted("luts/" + n for n in names))


def apply(config, source, target, rgb, form=ocio.OPTIMIZATION_LOSSLESS):
    image = np.array(rgb, np.float32, order="C")  # a copy: OCIO works in place
    config.getProcessor(source, target).getOptimizedCPUProcessor(form).applyRGB(image)
    return image


def test_spaces(report, config):
    operators.PRIMARIES["egamut"] = EGAMUT
    linear = {s.getName() for s in config.getColorSpaces() if s.getEncoding() == "scene-linear"}
    report.check("linear spaces", linear == set(LINEAR), linear ^ set(LINEAR))
    unit = np.eye(3)
    for space, primaries in LINEAR.items():
        matrix = apply(config, space, "aces_interchange", unit).T
        report.bound(f"{space} to ACES2065-1", np.abs(matrix - operators.rgb_to_rgb(primaries, "ap0")).max(), MATRIX)
    rng = np.random.default_rng(11)
    grays = np.repeat(np.arange(256)[:, None] / 255, 3, axis=1)
    colors = rng.random((4096, 3))
    spaces = [(display, "cie_xyz_d65_interchange") for display in config.getDisplays()]
    for space, reference in [*spaces, ("sRGB - Texture", "aces_interchange")]:
        back = apply(config, reference, space, apply(config, space, reference, grays))
        report.compare(f"{space}: gray codes to the reference and back", back, grays, ROUND_TRIP)
        # A dark channel of a bright color is what the matrix leaves of numbers near 1, and its code, where the
        # display's curve is steep, shows that: such colors come back as the same light.
        light = apply(config, space, reference, colors)
        again = apply(config, space, reference, apply(config, reference, space, light))
        # Relative to the color's brightest light, where that is above 1: on HDR displays.
        scale = np.maximum(np.abs(light).max(axis=1, keepdims=True), 1)
        report.compare(f"{space}: light of colors to codes and back", again / scale, light / scale,
                       HDR_ROUND_TRIP if scale.max() > 2 else ROUND_TRIP)
    # Without an operator sRGB is what IEC 61966-2-1 says, not OCIO's own curve, which is 1e-5 off.
    light = operators.sanitize(rng.random((4096, 3)))
    encoded = apply(config, "Linear Rec.709", "sRGB - Texture", light)
    report.compare("sRGB - Texture of linear light", encoded, operators.srgb_encode(light.astype(np.float32)),
                   ROUND_TRIP)


def test_check_config(report, folder):
    report.check("check_config.py", check_config.main([str(folder / "config.ocio")]) == 0)
    report.check("check_config.py without a config", check_config.main([str(folder / "none.ocio")]) == 2)
