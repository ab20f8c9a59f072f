# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests of sequences: small shots, and what lies in their folders."""

import contextlib
import os
import subprocess

import numpy as np
from pictures import write_exr

# A config as a studio has one, with displays that Tonewright knows.
CONFIG = """ocio_profile_version: 2.1
environment: {}
search_path: luts
roles: {aces_interchange: ACES2065-1, cie_xyz_d65_interchange: CIE-XYZ-D65, data: Raw, scene_linear: ACES2065-1}
file_rules:
  - !<Rule> {name: Default, colorspace: ACES2065-1}
displays:
  sRGB:
    - !<View> {name: Raw, colorspace: Raw}
    - !<View> {name: Video, view_transform: Video, display_colorspace: sRGB}
active_displays: [sRGB]
active_views: [Video, Raw]
view_transforms:
  - !<ViewTransform>
    name: Video
    from_scene_reference: !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
display_colorspaces:
  - !<ColorSpace> {name: CIE-XYZ-D65}
  - !<ColorSpace>
    name: sRGB
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
colorspaces:
  - !<ColorSpace> {name: ACES2065-1}
  - !<ColorSpace> {name: Raw, isdata: true}
"""
DATE = 1_600_000_000  # of every input, because outputs without a date get it


def make_shot(folder, numbers, width=48, height=32, name="in.{:04d}.exr", seed=1):
    """Noise with saturated colors, black, negatives, light above white and alpha; of 2020, without a date in them."""
    for number in numbers:
        rng = np.random.default_rng([seed, abs(number)])
        rgb = (2.0 ** rng.uniform(-10, 6, (height, width, 3)) * rng.choice([-0.1, 0, 1, 1], (height, width, 3)))
        alpha = rng.choice([0, 0.25, 1], (height, width))[..., None]
        # No more than a surface of that alpha shows: else each command warns that PNG loses light.
        rgb = np.where(alpha < 1, np.minimum(rgb, 16 * alpha), rgb)
        path = folder / name.format(number)
        write_exr(path, {**{c: rgb[..., i].astype(np.float32) for i, c in enumerate("RGB")},
                         "A": alpha[..., 0].astype(np.float32)})
        os.utime(path, (DATE, DATE))


def contents(folder, pattern="out.*"):
    """name -> bytes"""
    return {path.name: path.read_bytes() for path in folder.glob(pattern)}


def leftovers(folder):
    return sorted(path.name for path in folder.glob(".*"))


def apply(command, *arguments, folder, environment=None):
    """(exit code, lines on standard error); what is written to standard output is one of these, too."""
    done = subprocess.run([str(command), "apply", *map(str, arguments)], cwd=folder, capture_output=True, text=True,
                          check=False, env=environment)
    return done.returncode, (done.stdout + done.stderr).splitlines()


@contextlib.contextmanager
def small_disk(folder, size):
    """A file system of its own at a folder; None where none can be made."""
    folder.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], capture_output=True, check=False,
                          text=True)
    try:
        yield None if done.returncode else folder
    finally:
        if done.returncode == 0:
            subprocess.run(["umount", folder], check=True)
