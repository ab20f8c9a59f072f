# SPDX-License-Identifier: Apache-2.0
"""ociobakelut, ociomergeconfigs and oiiotool 3.1 with the OpenColorIO config: the limits that docs/config.md names.

    python3 -m pytest tests/parity/clients/test_ocio_tools.py --tonewright build/release/bin/tonewright

Tests named newer run the programs of TONEWRIGHT_NEWER_OCIO (`PROGRAM ociobakelut ...`), others the installed ones.
"""

import os
import re
import struct
import subprocess

import numpy as np
import pytest
from pictures import PROJECT, evaluate, need_program, run, skip, unstack, write_exr

ocio = pytest.importorskip("PyOpenColorIO", reason="PyOpenColorIO is not installed (Debian: python3-pyopencolorio)")

FOLDER = PROJECT / "ocio_config"
CLF = "Academy/ASC Common LUT Format"
GRAYS = np.array([0.05, 0.18, 0.5, 1, 2, 4, 16], np.float32)
# ITU-T H.273: primaries, transfer, matrix, range; of the displays that have an interop id with code points.
CICP = {"Display P3": "12/13/0/1", "Rec.1886": "1/1/0/1", "Rec.2100-PQ": "9/16/0/1", "Rec.2100-HLG": "9/18/0/1",
        "P3-D65 PQ": "12/16/0/1"}


def through_lut(path):
    image = np.repeat(GRAYS[:, None], 3, axis=1)
    transform = ocio.FileTransform(str(path), interpolation=ocio.INTERP_LINEAR)
    ocio.Config.CreateRaw().getProcessor(transform).getDefaultCPUProcessor().applyRGB(image)
    return image[:, 0]


def cicp_of(path):
    """The cICP chunk of a PNG, or "none"."""
    data = path.read_bytes()
    at = 8
    while at < len(data):
        size, = struct.unpack(">I", data[at:at + 4])
        if data[at + 4:at + 8] == b"cICP":
            return "/".join(map(str, data[at + 8:at + 8 + size]))
        at += 12 + size
    return "none"


def runner_of(program, is_newer=True):
    """The words before a program's name. Skips the test where it is missing."""
    if not is_newer:
        need_program(program, "opencolorio-tools")
        return []
    if not os.environ.get("TONEWRIGHT_NEWER_OCIO"):
        skip("TONEWRIGHT_NEWER_OCIO is not set")
    runner = [os.environ["TONEWRIGHT_NEWER_OCIO"]]
    done = subprocess.run([*runner, program, "--help"], capture_output=True, text=True, check=False)
    if not done.stdout and not done.stderr.startswith(program):
        skip(f"{program}: {done.stderr.strip()[-80:]}")
    return runner


@pytest.mark.parametrize("is_newer", [False, True], ids=["installed", "newer"])
def test_bake(report, command, scratch, is_newer):
    """ociobakelut ends at scene-linear 1, without a word; `tonewright bake` has every half float."""
    runner = runner_of("ociobakelut", is_newer)
    theirs, ours = scratch / "theirs.clf", scratch / "ours.clf"
    done = subprocess.run([*runner, "ociobakelut", "--iconfig", FOLDER / "config.ocio", "--inputspace", "Linear Rec.709",
                           "--outputspace", "Output - Hable - sRGB", "--format", CLF, theirs], capture_output=True, text=True,
                          check=True)
    run(command, "bake", "hable", "--input-encoding", "linear", "-o", ours)
    truth = evaluate(command, np.repeat(GRAYS[:, None], 3, axis=1), "hable")[:, 0]
    report.compare("tonewright bake: the view", through_lut(ours), truth, 1e-6)
    shown = through_lut(theirs)
    report.compare("ociobakelut: from 0.18 to 1, the view", shown[1:4], truth[1:4], 1e-3)
    report.check(f"ociobakelut: above 1, the value at 1, {abs(shown - truth).max():.2f} from the view, without a message",
                 (shown[4:] == shown[3]).all() and truth[-1] > shown[-1] + 0.2 and not done.stderr, (shown, done.stderr))
    said = run(command, "verify", "--lut", theirs, "hable", "agx_sobotka").splitlines()[0]
    report.check("verify --lut names what ociobakelut wrote", "is hable with linear:0:1 input" in said, said)


def test_merge_newer(report, scratch):
    """Merged by default, textures of other spaces are replaced by views that are equal to them up to white."""
    runner = runner_of("ociomergeconfigs")
    for options, is_complete in (("{}", False), ("{avoid_duplicates: false}", True)):
        (scratch / "m.ociom").write_text(
            "ociom_version: 1.0\nsearch_path: [.]\nmerge:\n  Merged:\n    base: ocio://cg-config-latest\n"
            f"    input: {FOLDER / 'config.ocio'}\n    options: {options}\n")
        done = subprocess.run([*runner, "ociomergeconfigs", scratch / "m.ociom", "--out", scratch / "merged.ocio"],
                              capture_output=True, text=True, check=True)
        text = (scratch / "merged.ocio").read_text()
        lost = [name for name in ("sRGB - Texture", "Gamma 2.4 Rec.709 - Texture") if f"    name: {name}\n" not in text]
        replaced = re.findall(r"color space '(Output - Standard - [^']*)' replaces '([^']* - Texture)'", done.stdout + done.stderr)
        report.check(f"ociomergeconfigs with options {options}: {'all textures' if is_complete else 'textures are lost'}",
                     (not lost and not replaced) if is_complete else (lost and replaced), (lost, replaced))


def test_tags_newer(report, scratch):
    """oiiotool 3.1 tags a PNG by the config of OCIO alone."""
    runner = runner_of("oiiotool")
    write_exr(scratch / "in.exr", unstack(np.full((8, 8, 3), 0.18, np.float32)))

    def tag_of(display, *options, config="config-2.5.ocio", variable=True):
        place = {"OCIO": str(FOLDER / config)} if variable else {}
        chosen = [] if variable else ["--colorconfig", FOLDER / config]
        environment = {**{k: v for k, v in os.environ.items() if k != "OCIO"}, **place}
        subprocess.run([*runner, "oiiotool", *chosen, scratch / "in.exr", "--ociodisplay", display, "Hable", *options, "-d",
                        "uint16", "-o", scratch / "out.png"], capture_output=True, check=True, env=environment)
        return cicp_of(scratch / "out.png")

    found = {display: tag_of(display) for display in CICP}
    report.check("oiiotool 3.1: OCIO=config-2.5.ocio writes cICP", found == CICP, found)
    found = {tag_of("Rec.2100-PQ", variable=False), tag_of("Rec.2100-PQ", config="config.ocio"), tag_of("Rec.2020")}
    report.check("oiiotool 3.1: --colorconfig, config.ocio and Rec.2020 do not", found == {"none"}, found)
    found = {tag_of("Rec.2100-PQ", "--cicp", "9,16,0,1", variable=False, config=name)
             for name in ("config.ocio", "config-2.5.ocio")}
    report.check("oiiotool 3.1: --cicp writes it with both", found == {"9/16/0/1"}, found)
