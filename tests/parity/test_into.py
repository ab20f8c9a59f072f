# SPDX-License-Identifier: Apache-2.0
"""`tonewright config --into`: somebody's config with our views, looks and output spaces, and all of theirs as it was.

    python3 -m pytest tests/parity/test_into.py --tonewright build/release/bin/tonewright

The configs are small stand-ins: one built as the ACES configs are, one with references of its own; ocio_config/ of the
working directory; and the ACES CG and Studio configs themselves where TONEWRIGHT_NEWER_OCIO runs an OpenColorIO that has
them.
"""

import os
import re
import shutil
import subprocess

import numpy as np
import pytest
from pictures import ALL, PROJECT

ocio = pytest.importorskip("PyOpenColorIO", reason="PyOpenColorIO is not installed (Debian: python3-pyopencolorio)")

# ACES2065-1 and CIE XYZ D65 are the references, displays and the rendering OpenColorIO's built-ins.
ACES = """ocio_profile_version: 2.1
environment: {}
search_path: luts
strictparsing: true
roles: {aces_interchange: ACES2065-1, cie_xyz_d65_interchange: CIE-XYZ-D65, data: Raw, scene_linear: ACEScg}
file_rules:
  - !<Rule> {name: Default, colorspace: ACEScg}
shared_views:
  - !<View> {name: SDR Video, view_transform: SDR Video, display_colorspace: <USE_DISPLAY_NAME>}
displays:
  sRGB - Display:
    - !<View> {name: Raw, colorspace: Raw}
    - !<Views> [SDR Video]
  P3-DCI - Display:
    - !<View> {name: Raw, colorspace: Raw}
    - !<Views> [SDR Video]
  PQ:
    - !<View> {name: SDR Video, view_transform: SDR Video, display_colorspace: Rec.2100-PQ}
active_displays: [sRGB - Display, P3-DCI - Display, PQ]
active_views: [SDR Video, Raw]
view_transforms:
  - !<ViewTransform>
    name: SDR Video
    from_scene_reference: !<BuiltinTransform> {style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0}
display_colorspaces:
  - !<ColorSpace> {name: CIE-XYZ-D65}
  - !<ColorSpace>
    name: sRGB - Display
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
  - !<ColorSpace>
    name: P3-DCI - Display
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_G2.6-P3-DCI-BFD}
  - !<ColorSpace>
    name: Rec.2100-PQ
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_REC.2100-PQ}
colorspaces:
  - !<ColorSpace> {name: ACES2065-1}
  - !<ColorSpace>
    name: ACEScg
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace> {name: Raw, isdata: true}
"""
# The scene reference is twice linear AP1 light, the display reference XYZ a third as large: nothing is where ours is.
OWN = """ocio_profile_version: 2.1
environment: {}
strictparsing: true
roles: {aces_interchange: aces, cie_xyz_d65_interchange: xyz, data: raw, scene_linear: working}
file_rules:
  - !<Rule> {name: Default, colorspace: working}
displays:
  Monitor:
    - !<View> {name: Plain, view_transform: plain, display_colorspace: monitor}
view_transforms:
  - !<ViewTransform>
    name: plain
    from_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
        - !<MatrixTransform> {matrix: [3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1], direction: inverse}
display_colorspaces:
  - !<ColorSpace>
    name: xyz
    from_display_reference: !<MatrixTransform> {matrix: [3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: monitor
    from_display_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: [3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1]}
        - !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
colorspaces:
  - !<ColorSpace> {name: working}
  - !<ColorSpace>
    name: aces
    from_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace> {name: raw, isdata: true}
"""
# As people write configs by hand: comments everywhere, an order of their own, both styles, quotes, tabs behind values,
# blanks at line ends, a list over several lines and a multi-line text with signs that mean something elsewhere.
BY_HAND = """# studio config, do not let a program sort it
ocio_profile_version: 2.1
environment: {}

colorspaces:   # before the displays, as we like it
# the working space
- !<ColorSpace>
  name: ACEScg
  description: |
    # not a comment
    looks: [none]

    two lines
  to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}   # ours
- !<ColorSpace> {name: ACES2065-1}
-   !<ColorSpace> {name: Raw, isdata: true}
    # deeper than the list

# ---- roles ----
roles: {aces_interchange: ACES2065-1, cie_xyz_d65_interchange: 'CIE-XYZ-D65', data: Raw,
        scene_linear: ACEScg}\t
file_rules:
  - !<Rule> {name: Default, colorspace: ACEScg}
search_path: "luts"  # where the LUTs are
active_displays: []
active_views: [Plain, "Raw",  # the usual ones
               'It''s',  # ] not the end
              ]
displays:
    Monitor:   # the one on the desk
        # first
        - !<View> {name: Plain, view_transform: plain, display_colorspace: sRGB}
        - !<View> {name: Raw, colorspace: Raw} \t

    Television: [!<View> {name: "It's", view_transform: plain, display_colorspace: tv}]  # flow
view_transforms:
  - !<ViewTransform>
    name: plain
    from_scene_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}

display_colorspaces: [
    !<ColorSpace> {name: CIE-XYZ-D65},
    !<ColorSpace> {name: sRGB, from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}},
    !<ColorSpace> {name: tv, from_display_reference:
      !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709}},
  ]
# the end"""
# Profile 2.5, as OpenColorIO's own configs: ids, mirrored displays, and transforms that 2.1 does not know.
NEWER = """# OpenColorIO 2.5
ocio_profile_version: 2.5

environment:
  {}
search_path: ""
strictparsing: true
name: newer
description: |
  Two lines
  -- of text

roles: {aces_interchange: ACES2065-1, cie_xyz_d65_interchange: CIE-XYZ-D65, data: Raw, scene_linear: ACEScg}
file_rules:
  - !<Rule> {name: Default, colorspace: ACEScg}
viewing_rules:
  - !<Rule> {name: Any Linear, encodings: [scene-linear]}
shared_views:
  - !<View> {name: ACES 2.0, view_transform: ACES 2.0, display_colorspace: <USE_DISPLAY_NAME>, rule: Any Linear}
displays:
  sRGB - Display:
    - !<Views> [ACES 2.0]
  Display P3 - Display:
    - !<Views> [ACES 2.0]
  Display P3 HDR - Display:
    - !<Views> [ACES 2.0]
  Rec.1886 Rec.709 - Display:
    - !<Views> [ACES 2.0]
active_displays: [sRGB - Display, Display P3 - Display, Display P3 HDR - Display, Rec.1886 Rec.709 - Display]
active_views: [ACES 2.0]
looks:
  - !<Look>
    name: hue
    process_space: ACEScg
    transform: !<GradingHueCurveTransform> {style: log}
view_transforms:
  - !<ViewTransform>
    name: ACES 2.0
    interchange:
      amf_transform_ids: |
        urn:ampas:aces:transformId:v2.0:Output.Academy.Rec709-D65_100nit_in_Rec709-D65_BT1886.a2.v1
    from_scene_reference: !<BuiltinTransform> {style: ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-100nit-REC709_2.0}

display_colorspaces:
  - !<ColorSpace> {name: CIE-XYZ-D65, encoding: display-linear}
  - !<ColorSpace>
    name: sRGB - Display
    aliases: [srgb_rec709_display]
    interop_id: srgb_rec709_display
    encoding: sdr-video
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB - MIRROR NEGS}
  - !<ColorSpace>
    name: Display P3 - Display
    aliases: [srgb_p3d65_display]
    interop_id: srgb_p3d65_display
    encoding: sdr-video
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_DisplayP3}
  - !<ColorSpace>
    name: Display P3 HDR - Display
    aliases: [srgbe_p3d65_display]
    interop_id: srgbe_p3d65_display
    encoding: edr-video
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_DisplayP3-HDR}
  - !<ColorSpace>
    name: Rec.1886 Rec.709 - Display
    aliases: [g24_rec709_display]
    interop_id: g24_rec709_display
    encoding: sdr-video
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709 - MIRROR NEGS}
colorspaces:
  - !<ColorSpace> {name: ACES2065-1, aliases: [lin_ap0_scene], interop_id: lin_ap0_scene, encoding: scene-linear}
  - !<ColorSpace>
    name: ACEScg
    aliases: [lin_ap1_scene]
    interop_id: lin_ap1_scene
    encoding: scene-linear
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace> {name: Raw, isdata: true}
"""
VERSION = tuple(int(n) for n in ocio.GetVersion().split(".")[:2])
# OpenColorIO's sRGB operation is 1e-5 from IEC 61966-2-1, its PQ 7e-5 near black; the rest is float32 in matrices.
BOUND = 1e-4


def numbers_of(path):
    """A config's output for some colors: every space in both directions, every view."""
    config = ocio.Config.CreateFromFile(str(path))
    config.setProcessorCacheFlags(ocio.PROCESSOR_CACHE_OFF)
    light = np.random.default_rng(2).uniform(0, 4, (256, 3)).astype(np.float32)

    def through(*arguments):
        image = light.copy()
        try:
            config.getProcessor(*arguments).getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(image)
        except ocio.Exception as error:  # such as no inverse
            return str(error)
        return image.tobytes()

    found = {}
    for space in config.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL):
        found[space.getName()] = [through(space.getName(), "aces_interchange"),
                                  through("aces_interchange", space.getName())]
    for display in config.getDisplays():
        for view in config.getViews(display):
            found[display, view] = through("aces_interchange", display, view, ocio.TRANSFORM_DIR_FORWARD)
    return found


def call(command, *arguments):
    return subprocess.run([command, "config", *map(str, arguments)], capture_output=True, text=True, check=False)


def check_picture(report, command, path, display, view, operator, option, space):
    """A view of the result against `tonewright eval`, in double."""
    config = ocio.Config.CreateFromFile(str(path))
    light = np.exp2(np.random.default_rng(4).uniform(-8, 5, (500, 3))).astype(np.float32)
    light = np.concatenate([light, [[0, 0, 0], [0.18, 0.18, 0.18], [9, 0, 0], [0, 5, 0], [0, 0, 20]]]).astype(np.float32)
    lines = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in light.tolist())
    done = subprocess.run([command, "eval", *operator, "--input", "lin_ap1", "--display", option], input=lines,
                          capture_output=True, text=True, check=True)
    truth = np.array([[float(v) for v in re.split("[ ,]+", line.strip())] for line in done.stdout.splitlines()])
    image = (light * space[1]).astype(np.float32)
    config.getProcessor(space[0], display, view, ocio.TRANSFORM_DIR_FORWARD).getDefaultCPUProcessor().applyRGB(image)
    report.compare(f"{path.parent.name}: {view} on {display}", image, truth, BOUND)
    image = (light * space[1]).astype(np.float32)
    name = f"Output - {view} - {display}"
    config.getProcessor(space[0], name).getDefaultCPUProcessor().applyRGB(image)
    report.compare(f"{path.parent.name}: {name}", image, truth, BOUND)


def lines_that_are_gone(before, after):
    """The lines of a text that are not in another, whole and in their order."""
    rest = iter(after)
    return [line for line in before if not any(line == other for other in rest)]


def test_text(report, command, scratch):
    """A config that is written by hand: all of it stays as it is, --update and --remove take out what is ours."""
    variants = {"by hand": BY_HAND, "Windows": BY_HAND.replace("\n", "\r\n"), "a line end": BY_HAND + "\n",
                "no search path": BY_HAND.replace('search_path: "luts"  # where the LUTs are\n', ""),
                "an empty search path": BY_HAND.replace('"luts"', '""'),
                "a list of paths": BY_HAND.replace('"luts"', "[luts, more]"),
                "with looks": BY_HAND.replace("view_transforms:", "looks: [!<Look> {name: dark, process_space: ACEScg}]\n"
                                              "view_transforms:"), "UTF-8": "\ufeff" + BY_HAND.replace("studio", "Süd-Studio")}
    for kind, text in variants.items():
        if kind not in ("by hand", "Windows") and not ALL:
            continue
        # Only AgX has looks, and it takes ten seconds.
        second = ("agx_blender", "AgX") if kind == "with looks" else ("clamp", "Standard")
        folder = scratch / kind
        folder.mkdir()
        path = folder / "mine.ocio"
        path.write_bytes(text.encode())
        before = numbers_of(path)
        done = call(command, "--into", path, "--views", f"hable,{second[0]}", "--backup")
        report.check(f"{kind}: --into", done.returncode == 0 and not done.stderr, done.stderr)
        after = path.read_bytes().decode()
        # Lists on one line have more in them: the flow display, the active views, the search path, the looks.
        longer = re.compile(r"search_path|    Television|looks|               'It''s'")
        # A last line without an end gets one, as the others have it.
        kept = [line for line in text.rstrip().split("\n") if not longer.match(line)]
        kept[-1] = next(line for line in after.split("\n") if line.rstrip("\r") == kept[-1])
        changed = lines_that_are_gone(kept, after.split("\n"))
        report.check(f"{kind}: all other {len(kept)} lines are as they were", len(kept) > 40 and not changed, changed)
        report.check(f"{kind}: line ends are the config's", ("\r" in text) == ("\r" in after)
                     and after.count("\r\n") in (0, after.count("\n")), "")
        report.check(f"{kind}: the backup is the config", (folder / "mine.ocio.bak").read_bytes() == text.encode())
        now = numbers_of(path)
        report.check(f"{kind}: all of theirs makes the same numbers", all(now.get(k) == before[k] for k in before))
        config = ocio.Config.CreateFromFile(str(path))
        config.validate()
        report.check(f"{kind}: views are in their order, ours behind",
                     [list(config.getViews(d)) for d in ("Monitor", "Television")]
                     == [["Plain", "Raw", "Hable", second[1]], ["It's", "Hable", second[1]]],
                     [list(config.getViews(d)) for d in ("Monitor", "Television")])
        report.check(f"{kind}: it says what was added", all(w in done.stdout for w in (
            "added 4 views: Hable on Monitor", f"2 view transforms: Hable, {second[1]}",
            "9 looks" if second[1] == "AgX" else "", "4 color spaces: Output - Hable - Monitor")), done.stdout)
        tables = {p.name for p in (folder / "tonewright").glob("*.clf")}
        # Users may change the rest between the two.
        path.write_bytes(path.read_bytes().replace(b"the one on the desk", b"the one on the wall"))
        done = call(command, "--into", path, "--update", "--views", "hable", "--looks", "none")
        left = {p.name for p in (folder / "tonewright").glob("*.clf")}
        report.check(f"{kind}: --update", done.returncode == 0 and not done.stderr and left <= tables and left, done.stderr)
        report.check(f"{kind}: --update replaces", list(ocio.Config.CreateFromFile(str(path)).getViews("Television"))
                     == ["It's", "Hable"])
        updated = path.read_bytes()
        done = call(command, "--into", path, "--update")
        report.check(f"{kind}: --update alone takes the same views", done.returncode == 0 and path.read_bytes() == updated,
                     done.stderr)
        done = call(command, "--into", path, "--remove")
        report.check(f"{kind}: --remove leaves the config byte for byte", done.returncode == 0 and not done.stderr
                     and path.read_bytes() == text.encode().replace(b"desk", b"wall"), done.stderr)
        report.check(f"{kind}: --remove leaves nothing behind", sorted(p.name for p in folder.iterdir())
                     == ["mine.ocio", "mine.ocio.bak"], list(folder.iterdir()))
        if kind != "by hand":
            continue
        done = call(command, "--into", path, "--remove")
        report.check("nothing to remove", done.returncode == 3 and "mine.ocio" in done.stderr
                     and done.stderr.count("\n") == 1, done.stderr)
        call(command, "--into", path, "--views", "clamp")
        call(command, "--into", path, "--views", "hable", "--looks", "none")
        path.write_bytes(path.read_bytes().replace(b"name: Output - Standard", b"name: Other - Standard"))
        edited = path.read_bytes()
        done = call(command, "--into", path, "--remove")
        report.check("what was added and then changed is not removed", done.returncode == 3 and path.read_bytes() == edited
                     and "changed since" in done.stderr, done.stderr)
        path.write_bytes(edited.replace(b"name: Other - Standard", b"name: Output - Standard"))
        done = call(command, "--into", path, "--remove")
        report.check("--remove takes out what was added twice", done.returncode == 0
                     and path.read_bytes() == text.encode().replace(b"desk", b"wall"), done.stderr)
        done = call(command, "-o", folder / "x", "--remove")
        report.check("--remove without --into", done.returncode == 2 and "--into" in done.stderr, done.stderr)


def test_edits(report, command, scratch):
    """Short texts of ours are found again: a word at the end of a line, the same view on two displays."""
    folder = scratch / "edits"
    folder.mkdir()
    path = folder / "s.ocio"
    raw = "    - !<View> {name: Raw, colorspace: Raw}\n"
    text = "# ours\n" + ACES.replace("active_displays: [sRGB - Display, P3-DCI - Display, PQ]\n", "").replace(
        "  P3-DCI - Display:\n" + raw, "  Second:\n    - !<View> {name: SDR Video, view_transform: SDR Video, "
        "display_colorspace: sRGB - Display}\n" + raw + "  P3-DCI - Display:\n" + raw)
    path.write_text(text)
    done = call(command, "--into", path, "--views", "clamp")
    after = path.read_text()
    report.check("--into: one of each", done.returncode == 0 and "added 1 view transform: " in done.stdout
                 and "luts:tonewright\n" in after, done.stdout + done.stderr)
    # Before ours in its neighborhood, and a text like ours elsewhere.
    edits = (("# ours\n", "# theirs, see luts:tonewright\n"), ("environment: {}\n", "environment: {A: b}\n"),
             ("  Second:\n", "  # the second\n  Second:\n"))
    edited, wanted = after, text
    for old, new in edits:
        edited, wanted = edited.replace(old, new), wanted.replace(old, new)
    path.write_text(edited)
    done = call(command, "--into", path, "--update")
    report.check("--update after an edit of another line", done.returncode == 0 and not done.stderr, done.stderr)
    done = call(command, "--into", path, "--remove")
    report.check("--remove after an edit of another line", done.returncode == 0 and path.read_text() == wanted, done.stderr)
    # Where the line itself was changed, nobody knows what is ours.
    path.write_text(text)
    call(command, "--into", path, "--views", "clamp")
    edited = path.read_text().replace("search_path: luts:", "search_path: more:")
    path.write_text(edited)
    done = call(command, "--into", path, "--remove")
    report.check("--remove after an edit of the line itself", done.returncode == 3 and "changed since: :tonewright" in done.stderr
                 and path.read_text() == edited, done.stderr)


def shows(path, view, display="sRGB - Display"):
    """Whether OpenColorIO finds the view and its tables."""
    config = ocio.Config.CreateFromFile(str(path))
    try:
        config.getProcessor("aces_interchange", display, view, ocio.TRANSFORM_DIR_FORWARD).getDefaultCPUProcessor()
    except ocio.Exception:
        return False
    return True


def test_links(report, command, scratch):
    """A config by the name of a link: the file itself is edited, and OpenColorIO finds the tables by both names."""
    studio, shot, other = scratch / "studio", scratch / "shot", scratch / "show" / "other"
    for folder in (studio, shot, other):
        folder.mkdir(parents=True)
    path, link, far = studio / "config.ocio", shot / "c.ocio", other / "config.ocio"
    path.write_text(ACES)
    link.symlink_to("../studio/config.ocio")
    far.symlink_to("../../shot/c.ocio")  # through another link
    (scratch / "mount").symlink_to("studio")  # a link above it
    done = call(command, "--into", link, "--views", "hable", "--backup")
    report.check("a link: --into", done.returncode == 0 and not done.stderr and f"edited {path.resolve()}" in done.stdout,
                 done.stdout + done.stderr)
    report.check("a link: the file is edited, the link stays", link.is_symlink() and "Hable" in path.read_text())
    report.check("a link: tables, record and backup are beside the file", sorted(p.name for p in studio.iterdir())
                 == ["config.ocio", "config.ocio.bak", "tonewright"] and (studio / "tonewright" / "config.ocio.yaml").exists())
    report.check("a link: beside it is a link to the folder of the tables",
                 sorted(p.name for p in shot.iterdir()) == ["c.ocio", "tonewright"]
                 and os.readlink(shot / "tonewright") == "../studio/tonewright")
    report.check("a link: OpenColorIO finds the tables by both names, and by a folder's link",
                 all(shows(p, "Hable") for p in (path, link, scratch / "mount" / "config.ocio")))
    done = call(command, "--into", scratch / "mount" / "config.ocio", "--update", "--views", "clamp")
    report.check("a link above the config: --update", done.returncode == 0 and shows(path, "Standard") and shows(link, "Standard"),
                 done.stderr)
    done = call(command, "--into", far, "--update")
    report.check("a link to a link: --update", done.returncode == 0 and all(shows(p, "Standard") for p in (path, link, far)),
                 done.stderr)
    done = call(command, "--into", path, "--views", "hable")
    report.check("the file: --into after a link's", done.returncode == 0 and all(shows(p, "Hable") for p in (path, link, far)),
                 done.stderr)
    done = call(command, "--into", link, "--remove")
    report.check("a link: --remove leaves the config byte for byte", done.returncode == 0 and path.read_text() == ACES
                 and link.is_symlink() and not (studio / "tonewright").exists() and not os.path.lexists(shot / "tonewright"),
                 done.stderr)
    # A link that leads to a folder that is gone is ours.
    done = call(command, "--into", far, "--views", "clamp")
    report.check("a link to a folder that is gone is used again", done.returncode == 0 and shows(far, "Standard"), done.stderr)
    call(command, "--into", far, "--remove")

    # What OpenColorIO would take for the folder of the tables.
    for what, make in (("a folder", lambda p: (p.mkdir(), (p / "mine.clf").write_text("x"))), ("a file", lambda p: p.write_text("x"))):
        place = shot / "tonewright"
        if os.path.lexists(place):
            place.unlink()
        make(place)
        done = call(command, "--into", link, "--views", "clamp")
        report.check(f"a link, and {what} of the name beside it: refused, with both names", done.returncode == 3
                     and str(link) in done.stderr and str(path.resolve()) in done.stderr and done.stderr.count("\n") == 1
                     and path.read_text() == ACES and not (studio / "tonewright").exists(), done.stderr)
        shutil.rmtree(place) if place.is_dir() else place.unlink()
    # In the folder of the config, nothing else is needed.
    (studio / "current.ocio").symlink_to("config.ocio")
    done = call(command, "--into", studio / "current.ocio", "--views", "clamp")
    report.check("a link in the same folder", done.returncode == 0 and shows(studio / "current.ocio", "Standard")
                 and (studio / "tonewright" / "config.ocio.yaml").exists(), done.stderr)
    done = call(command, "--into", path, "--remove")
    report.check("a link in the same folder: --remove by the other name", done.returncode == 0 and path.read_text() == ACES,
                 done.stderr)
    (studio / "gone.ocio").symlink_to("none.ocio")
    done = call(command, "--into", studio / "gone.ocio", "--views", "clamp")
    report.check("a link to nothing", done.returncode == 3 and "gone.ocio" in done.stderr and done.stderr.count("\n") == 1,
                 done.stderr)
    os.link(path, scratch / "hard.ocio")
    done = call(command, "--into", path, "--views", "clamp")
    report.check("a hard link: one line, and the other name keeps the old contents", done.returncode == 0
                 and "2 hard links" in done.stderr and done.stderr.count("\n") == 1 and (scratch / "hard.ocio").read_text() == ACES
                 and shows(path, "Standard"), done.stderr)


# An identity, where a test needs a table of this name but not its numbers.
TABLE = ('<?xml version="1.0" encoding="UTF-8"?>\n<ProcessList compCLFversion="3" id="x">\n<LUT1D inBitDepth="32f" '
         'outBitDepth="32f">\n<Array dim="2 1">\n0\n1\n</Array>\n</LUT1D>\n</ProcessList>\n')


def test_record(report, command, scratch):
    """What commit 57376a0 wrote, as stored in tests/data/into_record, without its tables."""
    stored = PROJECT / "tests/data/into_record"
    before = (stored / "before.ocio").read_text()
    tables = ("hable_curve_61ddf5e1.clf", "hable_inverse_curve_78754295.clf")
    for way in ("by its name", "by a link"):
        for action in ("--update", "--remove"):
            folder = scratch / f"record {way} {action}"
            shutil.copytree(stored, folder / "studio")
            (folder / "studio" / "before.ocio").unlink()
            path = real = folder / "studio" / "studio.ocio"
            for table in tables:
                (folder / "studio" / "tonewright" / table).write_text(TABLE)
            if way == "by a link":  # it wrote record and tables beside the link, under the link's name
                path = folder / "shot" / "s.ocio"
                path.parent.mkdir()
                path.symlink_to("../studio/studio.ocio")
                (folder / "studio" / "tonewright").rename(folder / "shot" / "tonewright")
                (folder / "shot" / "tonewright" / "studio.ocio.yaml").rename(folder / "shot" / "tonewright" / "s.ocio.yaml")
            done = call(command, "--into", path, action)
            report.check(f"57376a0's record {way}: {action}", done.returncode == 0 and not done.stderr, done.stderr)
            if action == "--remove":
                report.check(f"57376a0's record {way}: the config is as before", real.read_text() == before)
                left = [p for p in folder.rglob("*") if "tonewright" in p.parts[len(folder.parts):]]
                report.check(f"57376a0's record {way}: nothing is left", not left, left)
                continue
            report.check(f"57376a0's record {way}: the view is rebuilt, with its tables", shows(real, "Hable", "sRGB")
                         and shows(path, "Hable", "sRGB"))
            files = sorted(p.name for p in (folder / "studio" / "tonewright").iterdir())
            report.check(f"57376a0's record {way}: tables and record beside the file", "studio.ocio.yaml" in files
                         and len(files) == 3 and all("<Array dim=\"2 1\">" not in p.read_text()
                                                     for p in (folder / "studio" / "tonewright").glob("*.clf")), files)
            done = call(command, "--into", path, "--remove")
            report.check(f"57376a0's record {way}: --remove after --update", done.returncode == 0 and real.read_text() == before,
                         done.stderr)


def test_faults(report, command, scratch):
    """Configs that lack what they name, and damaged tables: one line with both names, exit code 3, nothing changed."""
    path = scratch / "faulty.ocio"
    for what, old, new, words in (
            ("a role that names no space", "aces_interchange: ACES2065-1", "aces_interchange: ACES2065",
             "role aces_interchange is ACES2065, which is no color space"),
            ("the other role", "cie_xyz_d65_interchange: CIE-XYZ-D65", "cie_xyz_d65_interchange: XYZ",
             "role cie_xyz_d65_interchange is XYZ, which is no color space"),
            ("a role of a data space", "aces_interchange: ACES2065-1", "aces_interchange: Raw", "which is a data space"),
            ("a view without its view transform", "{name: SDR Video, view_transform: SDR Video, display_colorspace: Rec",
             "{name: SDR Video, view_transform: SDR Vdeo, display_colorspace: Rec", "SDR Vdeo"),
            ("a view without its space", "display_colorspace: Rec.2100-PQ", "display_colorspace: Rec.2100", "Rec.2100"),
            ("a shared view that is missing", "!<Views> [SDR Video]", "!<Views> [Film]", "Film"),
            ("a view with a look that is missing", "view_transform: SDR Video, display_colorspace: Rec.2100-PQ",
             "view_transform: SDR Video, display_colorspace: Rec.2100-PQ, looks: none", "none")):
        text = ACES.replace(old, new)
        path.write_text(text)
        done = call(command, "--into", path, "--views", "clamp")
        report.check(f"{what}: one line with both names, exit code 3", done.returncode == 3 and done.stderr.count("\n") == 1
                     and words in done.stderr and "faulty.ocio" in done.stderr and text != ACES, (done.returncode, done.stderr))
        report.check(f"{what}: nothing has changed", path.read_text() == text and not (scratch / "tonewright").exists())
    # OpenColorIO ignores the case of views, and lists active ones only.
    for name in ("hable", "Hable"):
        text = ACES.replace("    - !<View> {name: SDR Video, view_transform: SDR Video, display_colorspace: Rec",
                            f"    - !<View> {{name: {name}, colorspace: Raw}}\n    - !<View> {{name: SDR Video, view_transform: "
                            "SDR Video, display_colorspace: Rec")
        path.write_text(text)
        done = call(command, "--into", path, "--views", "hable")
        report.check(f"an inactive view {name}: a name that is taken", done.returncode == 2 and path.read_text() == text
                     and "Hable already" in done.stderr, (done.returncode, done.stderr))
    path.write_text(ACES)
    call(command, "--into", path, "--views", "hable")
    table = next((scratch / "tonewright").glob("hable_curve*.clf"))
    whole = table.read_bytes()
    table.write_bytes(whole[:300])
    done = call(command, "--into", path, "--update")
    report.check("a damaged table: --update writes it again", done.returncode == 0 and table.read_bytes() == whole, done.stderr)
    record = scratch / "tonewright" / "faulty.ocio.yaml"
    outside = scratch / "outside.clf"
    outside.write_text("mine")
    for name in ("../outside.clf", "tonewright/../../outside.clf", str(outside), "tonewright/..", "tonewright/"):
        text = record.read_text()
        record.write_text(text.replace('files:\n', f'files:\n  - "{name}"\n'))
        done = call(command, "--into", path, "--remove")
        report.check(f"a record of the table {name}: refused", done.returncode == 3 and outside.read_text() == "mine"
                     and done.stderr.count("\n") == 1, (done.returncode, done.stderr))
        record.write_text(text)


def test_environment(report, command, scratch):
    """OpenColorIO's variables change neither the bytes of a config nor what is measured."""
    hostile = {"OCIO_OPTIMIZATION_FLAGS": "0", "OCIO_ACTIVE_DISPLAYS": "none", "OCIO_ACTIVE_VIEWS": "none",
               "OCIO_INACTIVE_COLORSPACES": "ACEScg", "OCIO_USER_CATEGORIES": "x", "OCIO": "/nowhere/config.ocio"}
    wanted = {}
    for kind, more in (("plain", {}), ("variables", hostile)):
        folder = scratch / f"environment {kind}"
        folder.mkdir()
        (folder / "mine.ocio").write_text(ACES)
        environment = dict({k: v for k, v in os.environ.items() if not k.startswith("OCIO")}, **more)
        for arguments in (["config", "-o", "new", "--views", "clamp,hable", "--displays", "sRGB"],
                          ["config", "--into", "mine.ocio", "--views", "hable"],
                          ["bake", "hable", "--format", "clf", "-o", "hable.clf", "--size", "17"],
                          ["verify", "--config", "new", "--quick", "--no-gpu", "--json"]):
            done = subprocess.run([command, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False)
            report.check(f"{kind}: {arguments[0]} {arguments[1]}", done.returncode == 0, done.stderr[-300:])
            if arguments[0] == "verify":
                (folder / "verify.json").write_text(done.stdout)
        found = {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
        wanted = wanted or found
        changed = [str(p) for p in {**wanted, **found} if wanted.get(p) != found.get(p)]
        report.check(f"{kind}: the same {len(found)} files", len(found) > 8 and not changed, changed)


def check_theirs(report, command, folder, path, views):
    """A config that people have: into it, and nothing of theirs is changed."""
    before = numbers_of(path)
    done = call(command, "--into", path, "--views", "AgX,hable", "--looks", "none", *views)
    # OpenColorIO's messages are of their config.
    errors = [line for line in done.stderr.splitlines() if not line.startswith("tonewright: OpenColorIO: ")]
    report.check(f"{folder}: --into", done.returncode == 0 and not errors, done.stderr)
    after = numbers_of(path)
    changed = [k for k in before if after.get(k) != before[k]]
    report.check(f"{folder}: all {len(before)} of theirs make the same numbers", not changed, changed)
    report.check(f"{folder}: has {len(after) - len(before)} more", len(after) > len(before))


# Prints what a config shows, as a hash for each space and view, in the OpenColorIO of the Python that runs it.
HASHES = """
import hashlib, sys
import numpy as np
import PyOpenColorIO as ocio
config = ocio.Config.CreateFromFile(sys.argv[1])
config.setProcessorCacheFlags(ocio.PROCESSOR_CACHE_OFF)
config.validate()
light = np.random.default_rng(2).uniform(-0.2, 4, (256, 3)).astype(np.float32)
def show(name, *arguments):
    image = light.copy()
    try:
        config.getProcessor(*arguments).getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(image)
        result = hashlib.sha256(image.tobytes()).hexdigest()
    except ocio.Exception as error:
        result = repr(str(error))
    print(name, result, sep="\\t")
for space in config.getColorSpaces(ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL):
    show(space.getName(), space.getName(), "aces_interchange")
    show("to " + space.getName(), "aces_interchange", space.getName())
for display in config.getDisplays():
    for view in config.getViews(display):
        show(f"{view} on {display}", "aces_interchange", display, view, ocio.TRANSFORM_DIR_FORWARD)
"""


def hashes_of(newer, path):
    done = subprocess.run([newer, "python3", "-c", HASHES, path], capture_output=True, text=True, check=True)
    return dict(line.split("\t") for line in done.stdout.splitlines())


def older(text):
    """A config of profile 2.5 for OpenColorIO 2.1, by hand: other numbers below 0, no ACES 2.0, no Display P3 HDR."""
    text = re.sub(r" - MIRROR NEGS|    interop_id: .*\n|, interop_id: \w+|    interchange:\n(      .*\n)+", "", text)
    text = text.replace("profile_version: 2.5", "profile_version: 2.1")
    for style in ("DISPLAY - CIE-XYZ-D65_to_DisplayP3-HDR", "ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-100nit-REC709_2.0"):
        text = text.replace(f"!<BuiltinTransform> {{style: {style}}}", "!<MatrixTransform> {}")
    text = text.replace("!<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_DisplayP3}", """!<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: [2.4934969119414, -0.93138361791912, -0.40271078445071, 0, -0.82948896956157,
            1.7626640603183, 0.023624685841943, 0, 0.035845830243784, -0.076172389268041, 0.95688452400768, 0, 0, 0, 0, 1]}
        - !<ExponentWithLinearTransform> {gamma: [2.4, 2.4, 2.4, 1], offset: [0.055, 0.055, 0.055, 0], direction: inverse}""")
    return text.replace("!<GradingHueCurveTransform> {style: log}", "!<MatrixTransform> {}")


def test_newer_text(report, command, scratch):
    """A config of profile 2.5, whatever OpenColorIO this is: its text is kept, and what cannot be run is named."""
    folder = scratch / "newer"
    folder.mkdir()
    path = folder / "c.ocio"
    path.write_text(NEWER)
    warnings = 1 if VERSION < (2, 5) else 0
    done = call(command, "--strict", "--into", path, "--views", "hable")
    report.check("profile 2.5: --strict", done.returncode == warnings and (not warnings or path.read_text() == NEWER), done.stderr)
    if not warnings:
        call(command, "--into", path, "--remove")
    done = call(command, "--into", path, "--views", "hable,AgX", "--looks", "none")
    report.check("profile 2.5: --into", done.returncode == 0 and done.stderr.count("\n") == warnings, done.stderr)
    if warnings:
        report.check("profile 2.5: one line of what is not checked", all(words in done.stderr for words in (
            "c.ocio has profile 2.5", "color space Display P3 HDR - Display", "view transform ACES 2.0", "look hue",
            "negative values not checked on sRGB - Display")), done.stderr)
    kept = [line for line in NEWER.splitlines() if not line.startswith(("search_path", "active_views"))]
    gone = lines_that_are_gone(kept, path.read_text().splitlines())
    report.check("profile 2.5: all other lines are as they were", not gone, gone)
    exact = re.search(r"^Rec.1886 Rec.709 - Display +Hable +(\S+)", done.stdout, re.M)
    report.check("profile 2.5: Hable on Rec.1886 is as exact as in our config", exact and float(exact[1]) < 1e-5, done.stdout)
    readable = folder / "older.ocio"
    readable.write_text(older(path.read_text()) if warnings else path.read_text())
    for display, option in (("sRGB - Display", "srgb"), ("Display P3 - Display", "display_p3"),
                            ("Rec.1886 Rec.709 - Display", "rec1886")):
        check_picture(report, command, readable, display, "Hable", ["hable"], option, ("ACEScg", 1))
        check_picture(report, command, readable, display, "AgX", ["agx_blender"], option, ("ACEScg", 1))
    if newer := os.environ.get("TONEWRIGHT_NEWER_OCIO"):
        hashes = hashes_of(newer, path)
        report.check("profile 2.5: the newer OpenColorIO shows it", len(hashes["Hable on sRGB - Display"]) == 64, hashes)
    once = path.read_text()
    done = call(command, "--into", path, "--update")
    report.check("profile 2.5: --update", done.returncode == 0 and path.read_text() == once, done.stderr)
    done = call(command, "--into", path, "--remove")
    report.check("profile 2.5: --remove leaves the config byte for byte", done.returncode == 0 and path.read_text() == NEWER
                 and not (folder / "tonewright").exists(), done.stderr)
    # What our views need cannot be left out.
    text = NEWER.replace("{name: CIE-XYZ-D65, encoding: display-linear}", "{name: CIE-XYZ-D65, from_display_reference: "
                         "!<GradingHueCurveTransform> {style: log}}")
    path.write_text(text)
    done = call(command, "--into", path, "--views", "hable")
    if warnings:
        report.check("profile 2.5: an interchange role that OpenColorIO does not know", done.returncode == 3
                     and "role cie_xyz_d65_interchange is CIE-XYZ-D65, whose transform" in done.stderr
                     and path.read_text() == text, done.stderr)
    for version in ("2.5x", "3", "[2]"):
        text = NEWER.replace("profile_version: 2.5", f"profile_version: {version}")
        path.write_text(text)
        done = call(command, "--into", path, "--views", "hable")
        report.check(f"profile {version}: refused in one line", done.returncode == 3 and path.read_text() == text
                     and done.stderr.count("\n") == 1 and "c.ocio" in done.stderr, done.stderr)


@pytest.fixture
def newer():
    """The program that runs a newer OpenColorIO."""
    if not os.environ.get("TONEWRIGHT_NEWER_OCIO"):
        pytest.skip("the ACES CG and Studio configs, TONEWRIGHT_NEWER_OCIO is not set")
    return os.environ["TONEWRIGHT_NEWER_OCIO"]


def test_newer_published(report, command, scratch, newer):
    """The ACES CG and Studio configs of profile 2.5, and our own: run in the newer OpenColorIO."""
    names = "import PyOpenColorIO as o; print(*(c[0] for c in o.BuiltinConfigRegistry().getBuiltinConfigs()), sep='\\n')"
    builtin = subprocess.run([newer, "python3", "-c", names], capture_output=True, text=True, check=True).stdout.split()
    configs = {}
    for name in builtin:
        if re.match(r"(cg|studio)-config-.*_ocio-v2\.5$", name):
            write = f"import PyOpenColorIO as o; print(o.Config.CreateFromBuiltinConfig({name!r}).serialize())"
            configs[name] = subprocess.run([newer, "python3", "-c", write], capture_output=True, text=True, check=True).stdout
    if not configs:
        pytest.skip("the newer OpenColorIO has no configs of profile 2.5")
    subprocess.run([command, "config", "-o", scratch / "ours 2.5", "--views", "clamp", "--profile", "2.5"], check=True)
    configs["ours 2.5"] = (scratch / "ours 2.5" / "config.ocio").read_text()
    for name, text in configs.items():
        folder = scratch / name
        folder.mkdir(exist_ok=True)
        path = folder / "config.ocio"
        path.write_text(text)
        before = hashes_of(newer, path)
        done = call(command, "--into", path, "--views", "AgX,hable,khronos_neutral")
        report.check(f"{name}: --into", done.returncode == 0, done.stderr)
        after = hashes_of(newer, path)
        changed = [key for key in before if after.get(key) != before[key]]
        report.check(f"{name}: all {len(before)} of theirs make the same numbers", not changed, changed)
        failed = [key for key in after if key not in before and len(after[key]) != 64]
        report.check(f"{name}: {len(after) - len(before)} more", len(after) > len(before) and not failed, failed)
        checked = subprocess.run([newer, "ociocheck", "--iconfig", path], capture_output=True, text=True, check=False)
        if "OpenColorIO" in checked.stdout:
            report.check(f"{name}: the newer ociocheck", checked.returncode == 0 and "warning" not in checked.stdout.lower(),
                         checked.stdout[-300:])
        done = call(command, "--into", path, "--remove")
        report.check(f"{name}: --remove leaves the config byte for byte", done.returncode == 0 and path.read_text() == text,
                     done.stderr)


def test_ours(report, command, scratch):
    """Our own config."""
    own = scratch / "ours"
    if ALL:
        shutil.copytree("ocio_config", own)
    else:  # all of its files, loaded three times, are ten seconds
        subprocess.run([command, "config", "-o", own, "--views", "clamp,khronos_neutral"], check=True)
    before = numbers_of(own / "config.ocio")
    done = call(command, "--into", own / "config.ocio", "--operator", "hable", "--name", "Mine", "--views", "reinhard",
                "--looks", "none")
    report.check("ours: --into", done.returncode == 0 and not done.stderr, done.stderr)
    after = numbers_of(own / "config.ocio")
    report.check(f"ours: all {len(before)} make the same numbers", all(after.get(k) == before[k] for k in before))


def test_published(report, command, scratch, newer):
    """The ACES CG and Studio configs of profile 2.1, which OpenColorIO 2.2 and newer have built in."""
    for name in ("cg-config-v1.0.0_aces-v1.3_ocio-v2.1", "studio-config-v1.0.0_aces-v1.3_ocio-v2.1"):
        folder = scratch / name
        folder.mkdir()
        path = folder / "config.ocio"
        write = f"import PyOpenColorIO as o; print(o.Config.CreateFromBuiltinConfig({name!r}).serialize())"
        path.write_text(subprocess.run([newer, "python3", "-c", write], capture_output=True, text=True, check=True).stdout)
        check_theirs(report, command, name, path, ["--operator", "reinhard_extended:white=6", "--name", "Studio"])
        read = f"import PyOpenColorIO as o; c = o.Config.CreateFromFile({str(path)!r}); c.validate(); " \
            "[c.getProcessor('ACEScg', d, v, o.TRANSFORM_DIR_FORWARD).getDefaultCPUProcessor() " \
            "for d in c.getDisplays() for v in c.getViews(d)]; print('loaded')"
        done = subprocess.run([newer, "python3", "-c", read], capture_output=True, text=True, check=False)
        report.check(f"{name}: the newer OpenColorIO takes the result", done.stdout.strip() == "loaded", done.stderr[-300:])


@pytest.mark.parametrize(("kind", "text", "displays", "space"), [
    ("aces", ACES, {"sRGB - Display": "srgb", "PQ": "rec2100_pq"}, ("ACEScg", 1)),
    ("own", OWN, {"Monitor": "srgb"}, ("working", 2))], ids=["aces", "own"])
def test_views(report, command, scratch, kind, text, displays, space):
    folder = scratch / kind
    folder.mkdir()
    path = folder / "mine.ocio"
    path.write_text(text)
    before = numbers_of(path)
    done = call(command, "--into", path, "--views", "AgX,hable", "--operator", "reinhard_extended:white=6",
                "--name", "Studio")
    report.check(f"{kind}: --into", done.returncode == 0 and not done.stderr, done.stderr)
    report.check(f"{kind}: the table of errors", all(d in done.stdout for d in displays), done.stdout)
    after = numbers_of(path)
    changed = [k for k in before if after.get(k) != before[k]]
    report.check(f"{kind}: all of theirs makes the same numbers", not changed, changed)
    report.check(f"{kind}: nothing is left behind", sorted(p.name for p in folder.iterdir())
                 == ["mine.ocio", "tonewright"], list(folder.iterdir()))
    tables = sorted(p.name for p in (folder / "tonewright").iterdir() if p.name != "mine.ocio.yaml")
    unhashed = [n for n in tables if not re.fullmatch(r"[a-z0-9_]+_[0-9a-f]{8}\.clf", n)]
    report.check(f"{kind}: {len(tables)} tables whose names have a hash", tables and not unhashed, unhashed)
    for display, option in displays.items():
        hdr = " - HDR 1000 nits" if option == "rec2100_pq" else ""
        check_picture(report, command, path, display, "AgX" + hdr, ["agx_blender"], option, space)
        check_picture(report, command, path, display, "Studio", ["reinhard_extended", "--set", "white=6"],
                      option, space)
    config = ocio.Config.CreateFromFile(str(path))
    report.check(f"{kind}: looks", "AgX - Punchy" in list(config.getLookNames()), list(config.getLookNames()))
    if shutil.which("ociocheck"):
        checked = subprocess.run(["ociocheck", "--iconfig", path], capture_output=True, text=True, check=False)
        report.check(f"{kind}: ociocheck", checked.returncode == 0, checked.stdout[-300:])

    whole = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    done = call(command, "--into", path, "--views", "hable")
    report.check(f"{kind}: a name that is taken", done.returncode == 2 and "Hable already" in done.stderr
                 and done.stderr.count("\n") == 1, done.stderr)
    report.check(f"{kind}: nothing has changed",
                 whole == {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()})
    done = call(command, "--into", path, "--operator", "hable", "--name", "Hable Two")
    report.check(f"{kind}: once more, an operator alone", done.returncode == 0 and "\nadded 1 view transform: Hable Two\n"
                 in f"\n{done.stdout}" and "look" not in done.stdout, done.stdout + done.stderr)
    moved = folder.parent / f"{kind} moved"
    shutil.move(folder, moved)
    report.check(f"{kind}: the folder can be moved", ("AgX" in {k[1] for k in numbers_of(moved / "mine.ocio")
                                                                if isinstance(k, tuple)}))


def test_refusals(report, command, scratch):
    bare = scratch / "bare.ocio"
    bare.write_text(ACES.replace("cie_xyz_d65_interchange: CIE-XYZ-D65, ", ""))
    done = call(command, "--into", bare, "--views", "hable")
    report.check("no interchange role", done.returncode == 3 and "bare.ocio has no role cie_xyz_d65_interchange"
                 in done.stderr, done.stderr)
    bare.write_text(ACES.replace("view_transform: SDR Video, display_colorspace: <USE_DISPLAY_NAME>", "colorspace: Raw")
                    .replace("view_transform: SDR Video, display_colorspace: Rec.2100-PQ", "colorspace: Raw"))
    done = call(command, "--into", bare, "--views", "hable")
    report.check("no display of ours", done.returncode == 3 and "bare.ocio has no display that" in done.stderr, done.stderr)
    for words, old, new in (("cannot insert into YAML", "search_path: luts", 'search_path: "l\\x75ts"'),
                            ("looks is empty; expected at least one", "view_transforms:", "looks:\nview_transforms:")):
        bare.write_text(ACES.replace(old, new, 1))
        done = call(command, "--into", bare, "--views", "AgX" if "looks" in new else "clamp")
        report.check(f"{words}: the config's fault", done.returncode == 3 and f"bare.ocio: {words}" in done.stderr,
                     done.stderr)
    done = call(command, "--into", scratch / "none.ocio")
    report.check("no file", done.returncode == 3 and "none.ocio" in done.stderr, done.stderr)
    done = call(command, "--into", bare, "-o", scratch)
    report.check("--into and -o", done.returncode == 2, done.stderr)
    done = call(command)
    report.check("neither", done.returncode == 2 and "-o" in done.stderr, done.stderr)
