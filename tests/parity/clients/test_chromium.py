# SPDX-License-Identifier: Apache-2.0
"""Pictures of every display in a browser: what Chromium reads in them is the light that was shown.

    python3 -m pytest tests/parity/clients/test_chromium.py --tonewright build/release/bin/tonewright

Patches of known light go through the operator `clamp`, which leaves them as they are, to PNG files for each display.
Chromium draws each file on canvases of sRGB and of Display P3, and reads them back: it has to follow the profile or the
code points of the file. Expected values are formulas of IEC 61966-2-1. An HDR picture is shown with its own scale, which
Chromium chooses: one factor for all patches, and absolute luminance (BT.2100: code values stand for cd/m2).
"""

import base64
import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from pictures import run, skip

oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO's Python module is missing (Debian: python3-openimageio)")

PATCH = 16
LIGHT = np.array([[0, 0, 0], [.18, .18, .18], [1, 1, 1], [.5, .05, .02], [.02, .5, .05], [.05, .02, .5],
                  [.02, .02, .02], [.8, .4, .1]], np.float32)
PAGE = """<body>%s<script>
window.onload = () => {
  const out = {};
  for (const image of document.images) {
    for (const space of ['srgb', 'display-p3']) {
      const canvas = document.createElement('canvas');
      canvas.width = image.naturalWidth;
      canvas.height = image.naturalHeight;
      const context = canvas.getContext('2d', {colorSpace: space, colorType: 'float16'});
      context.drawImage(image, 0, 0);
      const patches = [];
      for (let x = %d; x < canvas.width; x += %d)
        patches.push(Array.from(context.getImageData(
            x, 8, 1, 1, {colorSpace: space, pixelFormat: 'rgba-float16'}).data).slice(0, 3));
      out[image.id + ' ' + space] = patches;
    }
  }
  document.body.textContent = JSON.stringify(out);
};
</script></body>"""


def encode(light):
    """IEC 61966-2-1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)


def decode(code):
    return np.where(code <= 0.04045, code / 12.92, ((np.maximum(code, 0.04045) + 0.055) / 1.055) ** 2.4)


def rgb_to_xyz(red, green, blue):
    """SMPTE RP 177, white D65."""
    columns = np.array([[x, y, 1 - x - y] for x, y in (red, green, blue)]).T
    white = np.array([0.3127, 0.3290, 1 - 0.3127 - 0.3290]) / 0.3290
    return columns * np.linalg.solve(columns, white)


REC709 = rgb_to_xyz((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
P3 = rgb_to_xyz((0.680, 0.320), (0.265, 0.690), (0.150, 0.060))
TO = {"srgb": np.eye(3), "display-p3": np.linalg.inv(P3) @ REC709}


def write_scene(path):
    pixels = np.repeat(np.repeat(LIGHT[None], PATCH, 0), PATCH, 1)
    spec = oiio.ImageSpec(pixels.shape[1], PATCH, 3, "float")
    image = oiio.ImageBuf(spec)
    image.set_pixels(oiio.get_roi(spec), np.ascontiguousarray(pixels))
    if not image.write(str(path)):
        raise RuntimeError(image.geterror())


def read_back(chromium, folder, pictures):
    """Name and canvas -> codes of the patches, 0 to 1."""
    images = "".join(f'<img id="{name}" src="data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}">'
                     for name, path in pictures.items())
    page = folder / "page.html"
    page.write_text(PAGE % (images, PATCH // 2, PATCH))
    done = subprocess.run([chromium, "--headless", "--no-sandbox", "--disable-gpu", "--force-color-profile=srgb",
                           f"--user-data-dir={folder}/profile", "--dump-dom", page.as_uri()],
                          capture_output=True, text=True, timeout=300, check=False)
    if "getImageData" in done.stdout and "float16" in done.stdout:
        skip("this Chromium has no canvases of floats")
    found = re.search(r"<body>(\{.*\})</body>", done.stdout, re.S)
    if not found:
        raise RuntimeError(f"Chromium did not answer: {done.returncode} {done.stderr[-500:]}")
    return {key: np.array(value) for key, value in json.loads(found.group(1)).items()}


def test_displays(report, command, scratch):
    chromium = shutil.which("chromium")
    if not chromium:
        skip("Chromium is missing (Debian: chromium)")
    write_scene(scratch / "in.exr")
    pictures = {}
    for key, *options in (("srgb", "srgb"), ("display_p3", "display_p3"), ("rec1886", "rec1886"),
                          ("rec2020", "rec2020"), ("g22", "g22"), ("linear", "linear"),
                          ("rec2100_pq", "rec2100_pq"), ("rec2100_hlg", "rec2100_hlg"), ("p3d65_pq", "p3d65_pq"),
                          ("bright_pq", "rec2100_pq", "--reference-white", "203")):
        pictures[key] = scratch / f"{key}.png"
        run(command, "apply", scratch / "in.exr", pictures[key], "--operator", "clamp", "-d", "uint16",
            "--display", *options)
    codes = read_back(chromium, scratch, pictures)
    for canvas, matrix in TO.items():
        light = LIGHT.astype(float) @ matrix.T
        for key in ("srgb", "display_p3", "rec1886", "rec2020", "g22", "linear"):
            # Chromium's curves are approximations: half a code value of 8 bits. Bytes of a P3 picture that are
            # taken for sRGB are 53 code values off.
            report.compare(f"{key} on a canvas of {canvas}", codes[f"{key} {canvas}"], encode(light),
                           0.5 / 255)
        lit = LIGHT.min(axis=1) > 0.01
        scales = {}
        for key in ("rec2100_pq", "rec2100_hlg", "p3d65_pq", "bright_pq"):
            ratios = decode(codes[f"{key} {canvas}"][lit]) / light[lit]
            scales[key] = np.median(ratios)
            # The darkest channel is 0.02 of white; half floats and the curve leave a percent or two of it.
            report.bound(f"{key} on a canvas of {canvas}: one scale for all colors",
                         np.abs(ratios / scales[key] - 1).max(), 0.03)
        for key in ("rec2100_hlg", "p3d65_pq"):
            report.bound(f"{key} is as bright as rec2100_pq on {canvas}", abs(scales[key] / scales["rec2100_pq"] - 1),
                         0.02)
        report.bound(f"white of 203 cd/m2 is 2.03 times that of 100 on {canvas}",
                     abs(scales["bright_pq"] / scales["rec2100_pq"] / 2.03 - 1), 0.02)
