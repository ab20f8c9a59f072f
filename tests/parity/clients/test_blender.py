# SPDX-License-Identifier: Apache-2.0
"""Blender with the OpenColorIO config against `tonewright apply`: what it finds at its start, and what it saves.

    python3 tests/parity/clients/test_blender.py build/release/bin/tonewright

Blender runs without a window, once. The config is ocio_config/ of the working directory. The last line is
`N passed, M failed`.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from pictures import Report, need_program, read_rgb, run, shared_picture, write_exr

# Half a step of 16 bits is 7.6e-6; OpenColorIO may be 3e-7 and the SIMD engine 1e-6 from the reference, and Blender
# rounds once more.
EXACT = 2e-5
# A cube is as far from its operator as the config's README says: of random colours, between which there are others.
BETWEEN_PROBES = 3
OPERATORS = {"AgX": ["agx_blender"], "AgX Punchy": ["agx_blender", "--look", "punchy"], "ACES 2.0": ["aces_20"],
             "ACES 1.3": ["aces_13"], "Khronos PBR Neutral": ["khronos_neutral"],
             "Reinhard Extended": ["reinhard_extended"], "Hable": ["hable"], "Gran Turismo": ["uchimura"],
             "ACES Narkowicz": ["aces_narkowicz"], "AgX Sobotka": ["agx_sobotka"], "Standard": ["clamp"],
             "False Color": ["false_color"]}
DISPLAYS = {"sRGB": "srgb", "Rec.1886": "rec1886"}
# Of Rec.1886: light below 1e-6 is a code of 3e-3, and float32 leaves 3e-8 of it.
DARK = 1e-6

IN_BLENDER = r"""
import bpy, json, sys
request = json.load(open(sys.argv[-1]))
scene = bpy.context.scene
scene.render.dither_intensity = 0
settings = scene.render.image_settings
settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "16"
linear = bpy.data.images.load(request["picture"])
byte = bpy.data.images.load(request["byte"])
found = {"display": scene.display_settings.display_device, "view": scene.view_settings.view_transform,
         "sequencer": scene.sequencer_colorspace_settings.name, "float": linear.colorspace_settings.name,
         "byte": byte.colorspace_settings.name, "pixel": byte.pixels[:3], "refused": []}
byte.is_float and found["refused"].append("the byte picture is float")
for display, view, look, path in request["jobs"]:
    try:
        scene.display_settings.display_device = display
        scene.view_settings.view_transform = view
        scene.view_settings.look = look
        linear.save_render(path, scene=scene)
    except TypeError as error:
        found["refused"].append(str(error))
try:
    scene.view_settings.view_transform = "Hable"
    scene.view_settings.look = "AgX - Punchy"
    found["look of another view"] = True
except TypeError:
    found["look of another view"] = False
for name in ("Non-Color", "Linear Rec.709", "sRGB", "ACEScg", "Output - AgX - sRGB"):
    try:
        linear.colorspace_settings.name = name
    except TypeError as error:
        found["refused"].append(str(error))
json.dump(found, open(request["found"], "w"))
"""


def published_error(config, view):
    row = next(line for line in (config.parent / "README.md").read_text().splitlines() if line.startswith(f"| {view} |"))
    return float(row.split("|")[4])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    command = parser.parse_args().command.resolve()
    need_program("blender", "blender")
    config = Path("ocio_config/config.ocio").resolve()
    report = Report()
    with tempfile.TemporaryDirectory(prefix="tonewright-") as folder:
        scratch = Path(folder)
        picture = shared_picture("memorial.hdr")
        if picture:  # a size that Blender saves 26 times in seconds
            run("oiiotool", picture, "--ch", "R,G,B", "--resize", "320x0", "-d", "float", "-o", scratch / "p.exr")
        else:
            run(command, "chart", "-o", scratch / "p.exr", "--width", 320, "--height", 180)
        picture = scratch / "p.exr"
        run("oiiotool", "--pattern", "constant:color=0.5,0.25,0.75", "16x16", "3", "-d", "uint8", "-o",
            scratch / "byte.png")
        jobs = [(display, view, "None", str(scratch / f"{d}.{view}.png")) for display, d in DISPLAYS.items()
                for view in OPERATORS]
        jobs.append(("sRGB", "AgX", "AgX - Punchy", str(scratch / "look.png")))
        request = scratch / "request.json"
        request.write_text(json.dumps({"picture": str(picture), "byte": str(scratch / "byte.png"), "jobs": jobs,
                                       "found": str(scratch / "found.json")}))
        (scratch / "in_blender.py").write_text(IN_BLENDER)
        done = subprocess.run(["blender", "-b", "--factory-startup", "-P", scratch / "in_blender.py", "--", request],
                              capture_output=True, text=True, env={**os.environ, "OCIO": str(config)}, check=False)
        output = done.stdout + done.stderr
        print(output.splitlines()[1] if "Blender" in output else output)
        # The scene of Blender's factory settings asks for Filmic, which is a table of Blender's own.
        complaints = [line for line in output.splitlines()
                      if any(word in line.lower() for word in ("not found", "could not", "error", "warn"))
                      and '"Filmic"' not in line]
        report.check("Blender finds roles, displays, views and spaces", not complaints, complaints[:3])
        found = json.loads((scratch / "found.json").read_text())
        report.check("nothing is refused", not found["refused"], found["refused"][:3])
        start = [found["display"], found["view"], found["sequencer"], found["float"], found["byte"]]
        report.check("what it starts with", start == ["sRGB", "AgX", "sRGB", "Linear Rec.709", "sRGB"], start)
        report.check("looks are those of the view", not found["look of another view"])
        for display, view, look, path in jobs:
            expected = scratch / "expected.exr"
            operator = OPERATORS["AgX Punchy" if look != "None" else view]
            run(command, "apply", picture, expected, "--operator", *operator, "--statistics", "defaults",
                "--display", DISPLAYS[display], "-d", "float")
            truth = read_rgb(expected, scratch)
            saved = read_rgb(path, scratch)
            if display == "Rec.1886":
                saved = np.where(truth**2.4 < DARK, np.maximum(saved, truth), saved)
                truth = np.where(truth**2.4 < DARK, saved, truth)
            error = published_error(config, view)
            bound = EXACT + (BETWEEN_PROBES if error > 1e-4 else 1) * error
            report.compare(f"{display}, {view}{'' if look == 'None' else ', look ' + look}", saved, truth, bound)
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
