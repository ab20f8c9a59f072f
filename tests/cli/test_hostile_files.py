# SPDX-License-Identifier: Apache-2.0
"""Links, private files, access lists, windows and names that an attacker or an accident can make."""

import json
import os
import stat
import subprocess

import numpy as np
import pytest
from shots import make_shot

pytestmark = pytest.mark.share(2)


OK, FAILED, USAGE, FILE = 0, 1, 2, 3
CLAMP = ["--operator", "clamp"]
BAKE = ["bake", "hable", "--format", "cube", "--input-encoding", "log2", "--size", "5", "-q", "-o"]


@pytest.fixture
def folder(scratch):
    """With a shot of two frames."""
    make_shot(scratch, [1, 2])
    return scratch


def run(command, folder, *arguments):
    """(exit code, standard output, lines on standard error)"""
    done = subprocess.run([command, *arguments], cwd=folder, capture_output=True, check=False, timeout=300,
                          env={**os.environ, "XDG_CACHE_HOME": str(folder / "cache")})
    return done.returncode, done.stdout, done.stderr.decode(errors="replace").splitlines()


def test_outputs(report, command, folder):
    """Two outputs that are one file are refused before anything is written."""
    out = folder / "o"
    out.mkdir()
    for kind in ("symbolic", "hard"):
        for name in ("in.0001.png", "in.0002.png"):
            (out / name).unlink(missing_ok=True)
        target = folder / "same.png"
        target.write_bytes(b"old")
        for name in ("in.0001.png", "in.0002.png"):
            if kind == "hard":
                os.link(target, out / name)
            else:
                (out / name).symlink_to(target)
        for arguments in (["in.0001.exr", "in.0002.exr", "-o", "o/", "--format", "png"],
                          ["in.####.exr", "o/in.####.png", "--frames", "1-2"]):
            code, _, lines = run(command, folder, "apply", *arguments, *CLAMP)
            report.check(f"{kind} links: apply {' '.join(arguments)}",
                         code == USAGE and len(lines) == 1 and "in.0001.png" in lines[0] and "in.0002.png" in lines[0], lines)
        report.check(f"{kind} links: the old file", target.read_bytes() == b"old")
    code, _, lines = run(command, folder, "compare", "in.0001.exr", "clamp", "-o", "p/clamp.png", "--pictures", "p")
    report.check("compare: the sheet is one of the pictures", code == USAGE and len(lines) == 1, lines)


def test_access(report, command, folder):
    name = folder / "o.cube"
    name.write_text("old")
    name.chmod(0o4755)
    report.check("bake", run(command, folder, *BAKE, name)[0] == OK)
    report.check("setuid goes, other permissions stay", stat.S_IMODE(name.stat().st_mode) == 0o755, oct(name.stat().st_mode))
    name.unlink()
    before = os.umask(0o027)
    run(command, folder, *BAKE, name)
    os.umask(before)
    report.check("a new file has what the umask says", stat.S_IMODE(name.stat().st_mode) == 0o640, oct(name.stat().st_mode))
    if os.geteuid() == 0:
        os.chown(name, 12345, 23456)
        run(command, folder, *BAKE, name)
        report.check("owner and group stay", (name.stat().st_uid, name.stat().st_gid) == (12345, 23456))
    else:
        print("skipped: owner and group (needs root)")


def test_windows(report, command, folder):
    oiio = pytest.importorskip("OpenImageIO", reason="data windows (OpenImageIO's Python module is missing; Debian: python3-openimageio)")
    for at, share in ((100, "all"), (44, "43.8 %"), (42, "")):  # 8 x 8 pixels: of 6 x 6 in the window, 1 - 36/64 is lost
        spec = oiio.ImageSpec(8, 8, 3, oiio.HALF)
        spec.x = spec.y = at
        spec.full_width = spec.full_height = 50
        out = oiio.ImageOutput.create(str(folder / "w.exr"))
        out.open(str(folder / "w.exr"), spec)
        out.write_image(np.full((8, 8, 3), .5, np.float32))
        out.close()
        for name, expected in (("w.png", share), ("w2.exr", "")):
            code, _, lines = run(command, folder, "apply", "w.exr", name, *CLAMP)
            said = [line for line in lines if "window" in line]
            report.check(f"data window at {at}, {name}", code == OK and len(said) == (1 if expected else 0)
                         and all(expected in line for line in said), lines)


def test_names(report, command, folder):
    name = os.fsencode(folder) + b"/a\xe9.exr"
    os.link(os.fsencode(folder / "in.0001.exr"), name)
    code, out, lines = run(command, folder, "meter", name, "--json")
    report.check("meter --json of a name that is not UTF-8", code == OK and b"a\\\\xe9.exr" in out and json.loads(out), lines)
    os.unlink(name)


def test_frames(report, command, folder):
    code, _, lines = run(command, folder, "apply", "none.#######.exr", "x.#######.png", "--frames", "1-1000000", *CLAMP)
    report.check("a million missing frames", code == FAILED and len(lines) < 60 and "1000000 failed: 1-1000000" in lines[-1], lines[-2:])
    run(command, folder, "apply", "in.####.exr", "f.####.png", "--frames", "1-2", *CLAMP)
    whole = (folder / "f.0001.png").read_bytes()
    (folder / "f.0001.png").write_bytes(whole[:-12])  # without IEND
    code, _, lines = run(command, folder, "apply", "in.####.exr", "f.####.png", "--frames", "1-2", "--skip-existing", *CLAMP)
    report.check("a PNG without its end is made again", code == OK and (folder / "f.0001.png").read_bytes() == whole
                 and "1 skipped" in lines[-1], lines)
