# SPDX-License-Identifier: Apache-2.0
"""Findings of `tonewright verify --config`: each fault that a config can have, in one that has no other."""

import json
import os
import subprocess

import pytest
from pictures import PROJECT

# Without a fault: what the lint asks for and nothing else.
GOOD = (PROJECT / "tests" / "data" / "good_config.ocio").read_text(encoding="utf-8")
LONG = "n" * 64
CUBE = "LUT_3D_SIZE 2\n" + "".join(f"{i & 1} {i >> 1 & 1} {i >> 2}\n" for i in range(8))
# name -> (what is replaced, by what, level, where, words of what is said)
FAULTS = {
    "a long name": ("name: aces,", f"name: aces, aliases: [{LONG}],", "warning", "space aces", "64 bytes"),
    "a name that is not ASCII": ("name: aces,", "name: aces, aliases: [Süd],", "warning", "space aces", "ASCII"),
    "no encoding": (", encoding: display-linear", "", "note", "space xyz", "encoding"),
    "no scene_linear": ("scene_linear: lin, ", "", "error", "role scene_linear", "missing"),
    "no aces_interchange": ("aces_interchange: aces, ", "", "warning", "role aces_interchange", "missing"),
    "no display interchange": ("cie_xyz_d65_interchange: xyz, ", "", "warning", "role cie_xyz_d65_interchange",
                               "missing"),
    "no data": (" data: raw,", "", "warning", "role data", "Blender 4"),
    "no default_byte": (" default_byte: sRGB,", "", "warning", "role default_byte", "8-bit"),
    "no Linear": ("[Linear]", "[Linehar]", "note", "config", "Linear"),
    "an inactive space that is none": ("inactive_colorspaces: []", "inactive_colorspaces: [gone]", "warning",
                                       "inactive_colorspaces", "gone"),
    "an active view that is none": ("[Plain, Raw]", "[Plain, Raw, Gone]", "warning", "active_views", "Gone"),
    "an absolute path": ("search_path: luts", "search_path: /luts", "warning", "config", "absolute"),
    "parsing": ("strictparsing: true", "strictparsing: false", "note", "config", "strictparsing"),
    "a view without a view transform": ("{name: Plain, view_transform: plain, display_colorspace: sRGB}",
                                        "{name: Plain, colorspace: lin}", "warning", "view sRGB / Plain",
                                        "no view transform"),
    "NaN comes through": (
        "from_scene_reference: !<RangeTransform> {min_in_value: 0, min_out_value: 0, max_in_value: 1, "
        "max_out_value: 1}",
        "from_scene_reference: !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}",
        "warning", "view sRGB / Plain", "NaN"),
    "a table that is not there": ("{name: aces, encoding: scene-linear}",
                                  "{name: aces, encoding: log, to_scene_reference: !<FileTransform> "
                                  "{src: gone.clf, interpolation: linear}}", "error", "space aces", "gone.clf"),
    "a cube that bands": ("{name: aces, encoding: scene-linear}",
                          "{name: aces, encoding: log, to_scene_reference: !<FileTransform> "
                          "{src: t.cube, interpolation: linear}}", "note", "space aces", "tetrahedra"),
}

LAST = "  - !<ColorSpace> {name: raw, isdata: true, encoding: data}\n"
RAW_VIEW = "    - !<View> {name: Raw, colorspace: raw}\n"


def space(name, transform):
    """Adds a color space after the others."""
    return f"  - !<ColorSpace> {{name: {name}, encoding: log, {transform}}}\n"


def through(name, other):
    return space(name, f"to_scene_reference: !<ColorSpaceTransform> {{src: {other}, dst: lin}}")


# name -> (what is put behind what, words of the one line that is said): what OpenColorIO does not survive, or takes
# minutes for.
REFUSED = {
    "color spaces in a circle": ([(LAST, through("c1", "c2") + through("c2", "c1"))],
                                 "color space c1 -> color space c2 -> color space c1"),
    "a color space that is itself": ([(LAST, space("c1", "to_scene_reference: !<LookTransform> {src: c1, dst: lin, looks: ''}"))], "c1 -> color space c1"),
    "looks in a circle": ([("default_view_transform: plain\n", """looks:
  - !<Look> {name: l1, process_space: lin, transform: !<LookTransform> {src: lin, dst: lin, looks: "+l2"}}
  - !<Look> {name: l2, process_space: lin, transform: !<LookTransform> {src: lin, dst: lin, looks: "-L1"}}
""")], "look l1 -> look l2 -> look L1"),
    "two spaces of which each needs the other in one direction": (
        [(LAST, space("c1", "to_scene_reference: !<ColorSpaceTransform> {src: lin, dst: c2}")
          + space("c2", "to_scene_reference: !<ColorSpaceTransform> {src: c1, dst: lin}"))], "color space c1"),
    "a view of a space that is the view": (
        [(RAW_VIEW, "    - !<View> {name: Mine, colorspace: mine}\n"),
         (LAST, space("mine", "from_scene_reference: !<DisplayViewTransform> {src: lin, display: sRGB, view: Mine}"))],
        "view sRGB / Mine -> color space mine"),
    "references 200 deep": ([(LAST, "".join(through(f"d{i}", f"d{i + 1}") for i in range(200)) + space("d200", "isdata: no"))],
                            "100 deep"),
    "a LUT that is a pipe": ([(LAST, space("m", "to_scene_reference: !<FileTransform> {src: pipe.cube}"))],
                             "pipe.cube: is no regular file"),
    "an alias inside its own node": ([(LAST, space("m", "to_scene_reference: &a !<GroupTransform> {children: [*a]}"))],
                                     ": the alias is inside its own node"),
    "a million copies by aliases": (
        [(LAST, space("m", "to_scene_reference: !<GroupTransform> {children: [&a0 !<MatrixTransform> {}"
                      + "".join(f", &a{i + 1} !<GroupTransform> {{children: [{', '.join(10 * [f'*a{i}'])}]}}" for i in range(6))
                      + "]}"))], ": aliases make more than 1000000 nodes"),
    "20,000 color spaces": ([(LAST, "".join(f"  - !<ColorSpace> {{name: s{i}}}\n" for i in range(20000)))],
                            "has 20005 color spaces; expected at most 4000"),
    "5,000 views": ([(RAW_VIEW, "".join(f"    - !<View> {{name: v{i}, colorspace: raw}}\n" for i in range(5000)))],
                    "has 5002 views; expected at most 4000"),
}


def lint(command, folder, text):
    (folder / "luts").mkdir(exist_ok=True)
    (folder / "luts" / "t.cube").write_text(CUBE)
    if not (folder / "luts" / "pipe.cube").exists():
        os.mkfifo(folder / "luts" / "pipe.cube")
    path = folder / "config.ocio"
    path.write_text(text, encoding="utf-8")
    done = subprocess.run([command, "verify", "--no-gpu", "--json", "--config", path], capture_output=True, text=True,
                          check=False)
    found = json.loads(done.stdout)["lint"] if done.stdout else []
    return done.returncode, found, done.stderr


def test_good(report, command, scratch):
    code, found, err = lint(command, scratch, GOOD)
    report.check("a config without a fault", code == 0 and not found, f"{code} {found} {err}")


@pytest.mark.parametrize("what", FAULTS)
def test_fault(report, command, scratch, what):
    old, new, level, where, words = FAULTS[what]
    report.check(f"{what}: the fault is in the file", GOOD.count(old) == 1, old)
    code, found, err = lint(command, scratch, GOOD.replace(old, new))
    hit = [f for f in found if f["level"] == level and f["where"] == where and words in f["what"]]
    report.check(what, hit and code == (1 if level == "error" else 0), f"{code} {found} {err}")


@pytest.mark.parametrize("what", REFUSED)
def test_refused(report, command, scratch, what):
    changes, words = REFUSED[what]
    text = GOOD
    for place, more in changes:
        report.check(f"{what}: the place is in the file", text.count(place) == 1, place)
        text = text.replace(place, place + more)
    code, _, err = lint(command, scratch, text)
    path = scratch / "config.ocio"
    report.check(what, code == 3 and words in err and str(path) in err and err.count("\n") == 1, f"{code} {err}")
    done = subprocess.run([command, "config", "--into", path, "--views", "clamp"], capture_output=True, text=True, check=False,
                          timeout=60)
    report.check(f"{what}: --into", done.returncode == 3 and done.stderr == err and path.read_text() == text,
                 f"{done.returncode} {done.stderr}")


def test_shared(report, command, scratch):
    """A view may be a space's, and spaces may share others, as long as none leads back."""
    shared = GOOD.replace(LAST, LAST + through("a", "aces") + through("b", "a") + through("c", "a") + space(
        "shown", "from_scene_reference: !<DisplayViewTransform> {src: aces, display: sRGB, view: Plain}"))
    code, found, err = lint(command, scratch, shared)
    errors = [f for f in found if f["level"] != "note"]
    report.check("spaces that share others", code == 0 and not errors, f"{code} {found} {err}")


def test_messages_of_opencolorio(report, command, scratch):
    """OpenColorIO's own messages appear once, as messages of the command."""
    text = GOOD.replace(LAST, LAST.replace("encoding: data", "encoding: data, surprise: 1") + through("a", "aces"))
    code, _, err = lint(command, scratch, text)
    report.check("OpenColorIO's own warning", code == 0 and err.count("\n") == 1 and "surprise" in err
                 and err.startswith("tonewright: OpenColorIO: "), err)


def test_long_word(report, command, scratch):
    """OpenColorIO 2.1 copies some words of a LUT into small buffers, whatever the length."""
    text = GOOD.replace(LAST, LAST + space("table", "to_scene_reference: !<FileTransform> {src: long.lut}"))
    (scratch / "luts").mkdir()
    (scratch / "luts" / "long.lut").write_text(f"LUT: 1 2 {'1' * 16}\n0\n255\n")
    code, _, err = lint(command, scratch, text)
    report.check("a LUT with a long word", code == 3 and err.count("\n") == 1 and "long.lut: line 1: a word after two sizes"
                 in err and "uses it as a LUT" in err, f"{code} {err}")


def test_no_config(report, command, scratch):
    code, _, err = lint(command, scratch, "not a config")
    report.check("no config", code == 3 and err.count("\n") >= 1 and str(scratch) in err, f"{code} {err}")
    done = subprocess.run([command, "verify", "--no-gpu", "--config", scratch / "none.ocio"], capture_output=True, text=True,
                          check=False)
    report.check("no file", done.returncode == 3 and "none.ocio" in done.stderr, done.stderr)
