# SPDX-License-Identifier: Apache-2.0
"""Blender with the OpenColorIO config against `tonewright apply`: what it finds at its start, and what it saves.

    python3 tests/parity/clients/test_blender.py build/release/bin/tonewright
    TONEWRIGHT_NEWER_BLENDER=/opt/blender-5.2/blender \\
        python3 tests/parity/clients/test_blender.py build/release/bin/tonewright --newer

Blender runs without a window, once, and python_check/check_config.py in its Python. --newer: the command line that
TONEWRIGHT_NEWER_BLENDER holds, in place of the installed Blender. The config is ocio_config/config.ocio of the working
directory, and, once more, config-2.5.ocio beside it where Blender has that OpenColorIO. The last line is
`N passed, M failed`.
"""

import argparse
import json
import os
import shlex
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from pictures import (LIGHT, PROJECT, Report, hlg_code, hlg_light, need_program, pq_code, pq_light, read_rgb, run,
                      shared_picture, skip)

# Half a step of 16 bits is 7.6e-6; OpenColorIO may be 3e-7 and the SIMD engine 1e-6 from the reference, and Blender
# rounds once more.
EXACT = 2e-5
# A cube is as far from its operator as the config's README says: of random colors, between which there are others.
BETWEEN_PROBES = 3
# Profile 2.5 has OpenColorIO's own ACES 2.0 in place of a cube, whose float32 is as far from its double.
BUILT_IN = {"ACES 2.0": 4e-5}
OPERATORS = {"AgX": ["agx_blender"], "AgX Punchy": ["agx_blender", "--look", "punchy"], "ACES 2.0": ["aces_20"],
             "ACES 1.3": ["aces_13"], "Khronos PBR Neutral": ["khronos_neutral"],
             "Reinhard Extended": ["reinhard_extended"], "Hable": ["hable"], "Gran Turismo": ["uchimura"],
             "ACES Narkowicz": ["aces_narkowicz"], "AgX Sobotka": ["agx_sobotka"], "Standard": ["clamp"],
             "False Color": ["false_color"]}
DISPLAYS = {"sRGB": "srgb", "Display P3": "display_p3", "Rec.1886": "rec1886", "Rec.2020": "rec2020",
            "Gamma 2.2": "g22", "Rec.2100-PQ": "rec2100_pq", "Rec.2100-HLG": "rec2100_hlg", "P3-D65 PQ": "p3d65_pq"}
HDR = " - HDR 1000 nits"
JOBS = [(display, view, "None") for display in ("sRGB", "Rec.1886") for view in OPERATORS] + [
    ("sRGB", "AgX", "AgX - Punchy"), ("Display P3", "AgX", "None"), ("Rec.2020", "AgX Punchy", "None"),
    ("Gamma 2.2", "Hable", "None")] + [
    (display, view, "None") for display in ("Rec.2100-PQ", "Rec.2100-HLG", "P3-D65 PQ")
    for view in ("AgX" + HDR, "ACES 1.3" + HDR, "Gran Turismo" + HDR, "Hable")]

# Blender 5.2 saves what is 100 cd/m2 in a config as 203 (ITU-R BT.2408), in pictures of these two displays, whatever
# the config: it multiplies the display's light.
WHITE = 2.03


def brighter_pq(code):
    return pq_code(WHITE * pq_light(code))


def brighter_hlg(code):
    """Through the display's light, whose luminance is the scene's to the power 1.2: straight in OpenColorIO's dark."""
    straight, gamma = 1e-4 / 3**1.2, 1.2
    light = hlg_light(code)
    scene = np.maximum(light @ [0.2627, 0.678, 0.0593], 1e-12)
    shown = WHITE * scene * np.maximum(scene, straight ** (1 / gamma)) ** (gamma - 1)
    gain = shown * np.maximum(shown, straight) ** (1 / gamma - 1) / scene
    return np.minimum(hlg_code(light * gain[..., None]), 1)


BRIGHTER = {"Rec.2100-PQ": brighter_pq, "Rec.2100-HLG": brighter_hlg}

IN_BLENDER = r"""
import bpy, contextlib, io, json, sys
request = json.load(open(sys.argv[-1]))
scene = bpy.context.scene
scene.render.dither_intensity = 0
settings = scene.render.image_settings
settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "16"
linear = bpy.data.images.load(request["picture"])
byte = bpy.data.images.load(request["byte"])
named = bpy.data.images.load(request["named"])
found = {"display": scene.display_settings.display_device, "view": scene.view_settings.view_transform,
         "sequencer": scene.sequencer_colorspace_settings.name, "float": linear.colorspace_settings.name,
         "byte": byte.colorspace_settings.name, "named": named.colorspace_settings.name, "pixel": byte.pixels[:3],
         "refused": [], "version": bpy.app.version, "name": bpy.app.version_string,
         "ocio": bpy.app.ocio.version_string, "hdr": []}
byte.is_float and found["refused"].append("the byte picture is float")
for display, view, look, path in request["jobs"]:
    try:
        scene.display_settings.display_device = display
        scene.view_settings.view_transform = view
        scene.view_settings.look = look
        linear.save_render(path, scene=scene)
    except TypeError as error:
        found["refused"].append(str(error))
    if getattr(scene.view_settings, "is_hdr", False) and display not in found["hdr"]:
        found["hdr"].append(display)
scene.display_settings.display_device = "sRGB"
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
with contextlib.redirect_stdout(io.StringIO()) as said:
    exec(open(request["check_config"]).read(), {"__name__": "__main__"})  # as the script editor does
found["check_config"] = said.getvalue().splitlines()
json.dump(found, open(request["found"], "w"))
"""


def the_blender(is_newer):
    """The command line of the Blender to test, as words."""
    if not is_newer:
        need_program("blender", "blender")
        return ["blender"]
    command = os.environ.get("TONEWRIGHT_NEWER_BLENDER")
    if not command:
        skip("TONEWRIGHT_NEWER_BLENDER is not set")
    return shlex.split(command)


def published_error(config, view):
    lines = (config.parent / "README.md").read_text().splitlines()
    row = next(line for line in lines if line.startswith(f"| {view} |"))
    return float(row.split("|")[4])


def check_start(report, output, found):
    """Its messages and its selections at the start."""
    # The scene of the factory settings of Blender 3 asks for Filmic, which is a table of Blender's own.
    complaints = [line for line in output.splitlines()
                  if any(word in line.lower() for word in ("not found", "could not", "error", "warn"))
                  and '"Filmic"' not in line]
    report.check("Blender finds roles, displays, views and spaces", not complaints, complaints[:3])
    report.check("nothing is refused", not found["refused"], found["refused"][:3])
    # Blender 5 asks the file rules, which know names and extensions; before, pictures have the space of a role.
    has_rules = found["version"] >= [5]
    start = [found[what] for what in ("display", "view", "sequencer", "float", "byte", "named")]
    expected = ["sRGB", "AgX", "sRGB", "Linear Rec.709", "sRGB - Texture" if has_rules else "sRGB",
                "ACEScg" if has_rules else "Linear Rec.709"]
    report.check("what it starts with", start == expected, f"{start}, expected {expected}")
    report.check("looks are those of the view", not found["look of another view"])
    if found["version"] >= [5]:
        expected = ["Rec.2100-PQ", "Rec.2100-HLG", "P3-D65 PQ"]
        report.check("HDR displays are known as such", found["hdr"] == expected, found["hdr"])


def check_its_python(report, lines):
    """check_config.py in Blender's Python, with the OpenColorIO that this imports."""
    if "PyOpenColorIO is missing" in "".join(lines):
        print(f"skipped: check_config.py in Blender ({lines[0]})")
        return
    detail = [line for line in lines if "FAILED" in line][:3] or lines[-1:]
    report.check(f"check_config.py, {lines[0]}: {lines[-1]}", lines[-1].endswith(" passed, 0 failed"), detail)


def in_parallel(function, things):
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(function, things))


def expected_picture(command, picture, display, view, look, scratch):
    operator = OPERATORS["AgX Punchy" if look != "None" else view.split(HDR)[0]]
    out = scratch / f"{display}.{view}.{look}.exr"
    run(command, "apply", picture, out, "--operator", *operator, "--statistics", "defaults",
        "--display", DISPLAYS[display], "-d", "float")
    return read_rgb(out, scratch)


def check_saved(report, config, jobs, expected, brighter, scratch):
    for (display, view, look, _), saved, truth in zip(
            jobs, in_parallel(lambda job: read_rgb(job[-1], scratch), jobs), expected):
        if display in brighter:
            inside = truth.max(axis=-1) < 0.999  # what light a clipped color had is not known
            saved, truth = saved[inside], brighter[display](truth[inside].astype(float))
        error = published_error(config, view.split(HDR)[0])
        bound = EXACT + (BETWEEN_PROBES if error > 1e-4 else 1) * error
        if config.name == "config-2.5.ocio" and view in BUILT_IN:
            bound = EXACT + BUILT_IN[view]
        report.compare(f"{display}, {view}{'' if look == 'None' else ', look ' + look}", saved, truth, bound,
                       LIGHT.get(DISPLAYS[display]))


def ask_blender(blender, config, picture, jobs, scratch):
    """Runs IN_BLENDER; what it printed, and what it found."""
    request, found = scratch / "request.json", scratch / "found.json"
    request.write_text(json.dumps({"picture": str(picture), "byte": str(scratch / "byte.png"), "jobs": jobs,
                                   "named": str(scratch / "plate_acescg.0001.exr"), "found": str(found),
                                   "check_config": str(PROJECT / "python_check" / "check_config.py")}))
    found.unlink(missing_ok=True)
    (scratch / "in_blender.py").write_text(IN_BLENDER)
    done = subprocess.run([*blender, "-b", "--factory-startup", "-P", scratch / "in_blender.py", "--", request],
                          capture_output=True, text=True, env={**os.environ, "OCIO": str(config)}, check=False)
    output = done.stdout + done.stderr
    if not found.is_file():
        raise RuntimeError(f"exit {done.returncode}: {' '.join(blender)}: {output.strip()}")
    return output, json.loads(found.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    parser.add_argument("--newer", action="store_true")
    arguments = parser.parse_args()
    command = arguments.command.resolve()
    blender = the_blender(arguments.newer)
    config = Path("ocio_config/config.ocio").resolve()
    report = Report()
    with tempfile.TemporaryDirectory(prefix="tonewright-") as folder:
        scratch = Path(folder)
        picture = shared_picture("memorial.hdr")
        if picture:  # a size that Blender saves 40 times in seconds
            run("oiiotool", picture, "--ch", "R,G,B", "--resize", "320x0", "-d", "float", "-o", scratch / "p.exr")
        else:
            run(command, "chart", "-o", scratch / "p.exr", "--width", 320, "--height", 180)
        picture = scratch / "p.exr"
        for name, depth in (("byte.png", "uint8"), ("plate_acescg.0001.exr", "float")):
            run("oiiotool", "--pattern", "constant:color=0.5,0.25,0.75", "16x16", "3", "-d", depth,
                "-o", scratch / name)
        jobs = [(*job, str(scratch / f"{number}.png")) for number, job in enumerate(JOBS)]
        expected = in_parallel(lambda job: expected_picture(command, picture, *job, scratch), JOBS)
        configs = [config]
        while configs:
            config = configs.pop()
            output, found = ask_blender(blender, config, picture, jobs, scratch)
            version = [int(number) for number in found["ocio"].split(",")]
            print(f"Blender {found['name']}, OpenColorIO {'.'.join(map(str, version))}, {config.name}")
            check_start(report, output, found)
            check_its_python(report, found["check_config"])
            check_saved(report, config, jobs, expected, BRIGHTER if found["version"] >= [5, 2] else {}, scratch)
            if config.name == "config.ocio" and version >= [2, 5]:
                configs.append(config.parent / "config-2.5.ocio")
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
