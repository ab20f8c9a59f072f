# SPDX-License-Identifier: Apache-2.0
"""Names of other programs' tone mappers as operators, `list --engines`, and which operators have an HDR version."""
import colorsys
import json
import os
import subprocess

import numpy as np
from pictures import run

# Name -> operator. The identities are those of docs/engines.md; tests/engines/ measures them.
NAMES = {
    "Babylon.js Standard": "exponential:babylon", "babylon aces": "aces_hill", "PlayCanvas ACES2": "aces_hill:threejs",
    "playcanvas_aces2 1.60": "aces_hill", "Unity Neutral": "hable:unity_neutral", "three.js ACESFilmic": "aces_hill:threejs",
    "threejs aces filmic": "aces_hill:threejs", "THREE AgX": "agx_threejs:r161", "Godot Filmic": "hable:godot",
    "cesium-filmic": "hable:gdc", "gainmap-js ACES": "aces_hill", "X3DOM filmic": "aces_narkowicz", "AgX": "agx_blender",
}


def eval_with(command, operator, *options):
    return subprocess.run([command, "eval", operator, "--display", "linear", *options], input="0.18 0.5 3\n", capture_output=True,
                          text=True, check=False)


def test_names(report, command, tw):
    for name, operator in NAMES.items():
        shown, expected = eval_with(command, name), eval_with(command, operator)
        report.check(f"{name}: {operator}", shown.returncode == 0 and shown.stdout == expected.stdout and not shown.stderr, shown.stderr)
        light = np.array([0.18, 0.5, 3])
        report.check(f"{name} in Python", (tw.evaluate(name, light) == tw.evaluate(operator, light)).all())
    # Hable: the scene value that becomes the white of 8 after the bias of 2 is shown as 1.
    shown = run(command, "eval", "Godot Filmic:white=8", "--display", "linear", stdin="4 4 4\n").split()
    report.check("settings follow the name", np.allclose(np.array(shown, float), 1, atol=1e-9), str(shown))


def test_refused_names(report, command, tw):
    for name, parts in {
        "ACES": ["operator is ACES; expected aces_hill", "aces_cesium", "aces_20", "list --engines", "mean difference in 8-bit steps",
                 "CesiumJS ACES"],
        "filmic": ["hable:no_bias", "Blender's Filmic is a table", "PlayCanvas TONEMAP_FILMIC"],
        "Hejl": ["hable_gdc:playcanvas", "hejl_2015", "PlayCanvas TONEMAP_HEJL"],
        "babylon": ["Babylon.js with Standard, ACES"],
        "Blender False Color": ["which no operator computes", "false_color has colors of its own"],
    }.items():
        shown = eval_with(command, name)
        first, *lines = shown.stderr.splitlines()
        report.check(f"{name}: exit status 2, one message, then lines",
                     shown.returncode == 2 and first.startswith("tonewright: ") and all(line.startswith(" ") for line in lines),
                     shown.stderr)
        for part in parts:
            report.check(f"{name}: {part}", part in shown.stderr, shown.stderr)
        try:
            tw.evaluate(name, [0.18, 0.18, 0.18])
            report.check(f"{name} in Python: an error", False)
        except ValueError as error:
            report.check(f"{name} in Python: one line", "\n" not in str(error) and name in str(error), str(error))


def test_meanings_of_every_command(report, command, scratch):
    chart = scratch / "chart.exr"
    run(command, "chart", "-o", chart, "--width", "320", "--height", "180", "-q")
    for arguments in (["apply", chart, scratch / "a.png", "--operator", "ACES"], ["compare", chart, "ACES", "aces_20", "-o", scratch / "b.png"],
                      ["bake", "ACES", "-o", scratch / "a.cube"], ["shader", "ACES", "--language", "c"],
                      ["conformance", "ACES", "-o", scratch / "kit"]):
        done = subprocess.run([command, *map(str, arguments)], capture_output=True, text=True, check=False)
        report.check(f"{arguments[0]} lists the meanings", done.returncode == 2 and "mean difference in 8-bit steps" in done.stderr, done.stderr)


def test_note(report, command):
    """Terminals see a note about AgX; files do not."""
    ours, theirs = os.openpty()
    subprocess.run([command, "eval", "AgX"], input="0.18 0.18 0.18\n", stdout=subprocess.DEVNULL, stderr=theirs, text=True, check=True)
    os.close(theirs)
    said = os.read(ours, 4000).decode()
    os.close(ours)
    report.check("a terminal: one line", said.count("\n") == 1 and "AgX is Blender's here" in said and "list --engines" in said, said)
    report.check("a pipe: nothing", not eval_with(command, "AgX").stderr)
    report.check("--verbose: the line", "AgX is Blender's here" in eval_with(command, "AgX", "-v").stderr)
    report.check("its id: nothing", "Blender's" not in eval_with(command, "agx_blender", "-v").stderr)
    report.check("the nearest operator", "nearest operator" in eval_with(command, "Filament ACES", "-v").stderr)


def test_list(report, command):
    rows = json.loads(run(command, "list", "--engines", "--json"))
    equal = [row for row in rows if row["verdict"] == "equal"]
    report.check("at least 90 rows of 24 programs, 70 of them equal",
                 len(rows) >= 90 and len({row["engine"] for row in rows}) >= 24 and len(equal) >= 70)
    text = run(command, "list", "--engines")
    report.check("at most 120 columns", max(map(len, text.splitlines())) <= 120)
    report.check("each name", all(row["name"] in text for row in rows))
    refused = subprocess.run([command, "list", "hable", "--engines"], capture_output=True, text=True, check=False)
    report.check("no operator with --engines", refused.returncode == 2 and "expected none with --engines" in refused.stderr, refused.stderr)


def test_distances(report, command):
    """Mean differences of sRGB code values in 8-bit steps, over grays and 12 hues of two saturations from -6 to 6 stops about 0.18."""
    colors = []
    for stops in range(-6, 7):
        for saturation in (0, 0.5, 0.9):
            for degrees in range(0, 360 if saturation else 30, 30):
                pure = np.array(colorsys.hsv_to_rgb(degrees / 360, 1, 1))
                colors.append(0.18 * 2.0**stops * (1 - saturation + saturation * pure))
    tables = run(command, "list", "--engines", "--markdown").split('### "Hejl"')[1].split("###")[0]
    rows = [line.split(" | ") for line in tables.splitlines() if line.startswith("| ") and "`" in line]
    text = "\n".join(" ".join(map(repr, color)) for color in np.array(colors).tolist()) + "\n"
    shown = [np.array(run(command, "eval", row[1].strip("`"), "--display", "srgb", stdin=text).split(), float) for row in rows]
    report.check("Hejl has at least four meanings", len(rows) >= 4)
    for i, row in enumerate(rows):
        for j, cell in enumerate(row[3:]):
            distance = 255 * np.abs(shown[i] - shown[j]).mean()
            printed = float(cell.strip(" |"))
            # Half a unit of the digit that is printed: one decimal below 10.
            report.check(f"{row[1]}, {rows[j][1]}: {printed}", abs(printed - distance) <= (0.051 if distance < 10 else 0.51), str(distance))


def test_hdr(report, command):
    """`hdr` is true where an HDR display of 1000 cd/m2 shows more than its white of 100."""
    catalogue = json.loads(run(command, "list", "--json"))
    for operator in catalogue["operators"]:
        shown = subprocess.run([command, "eval", operator["id"], "--display", "rec2100_pq"], input="60000 60000 60000\n",
                               capture_output=True, text=True, check=False)
        if shown.returncode:
            continue  # camera_response needs a file
        # SMPTE ST 2084: the code value of 100 cd/m2 is 0.508; a thousandth above, so that rounding is none.
        is_brighter = max(map(float, shown.stdout.split())) > 0.509
        report.check(f"{operator['id']}: hdr is {is_brighter}", operator["hdr"] == is_brighter, shown.stdout)
        report.check(f"{operator['id']}: its settings", (operator["hdr_settings"] is not None) == is_brighter)
        if preset := operator["hdr_preset"]:
            report.check(f"{operator['id']}: its preset", preset in [p["id"] for p in operator["presets"]])
    report.check("local operators have none", not any(operator["hdr"] for operator in catalogue["local_operators"]))
