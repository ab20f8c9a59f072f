# SPDX-License-Identifier: Apache-2.0
"""Commands in README and docs/ run as they stand there.

    python3 -m pytest tests/docs/test_commands.py --tonewright build/release/bin/tonewright [-k PAGE]

A page's commands run one after the other in a folder with the files that pages take for granted: render.exr, shot.1001.exr,
and others (see `Files`). A command of a transcript (`$ `) must print what the page shows; `...` stands for any text. What does
not run here has a reason in NOT_RUN, and its options must exist. Any other line in a block without a word behind its fence is an
error: text that is no command has the word `text`. docs_commands.py runs the blocks of `sh` on the pages in FOLLOWED.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from docs_commands import DOCS, blocks, missing, output_differs
from operators.defects import OPERATORS as DEFECTS
from pictures import PROJECT
from test_into import ACES

PROGRAMS = ("tonewright build/release/bin/tonewright_tools oiiotool ffmpeg ./run export echo python3 cmake ctest npm g++ ssh iinfo idiff maketx iv rv blender "
            "dpkg-buildpackage tests/install/release.sh tests/install/debian.sh").split()
COMMAND = re.compile(rf"(\$ )?((?:\w+=\S+ )?(?:{'|'.join(map(re.escape, PROGRAMS))})(?: .*)?)")
GENERATED = {DOCS / "operators.md", *(DOCS / "operators").glob("*.md")}
FOLLOWED = {"docs/cookbook.md", "docs/own_operators.md", "docs/formula_to_picture.md", "docs/gallery.md"}
# Beginning of a command -> why it does not run here. Every entry is needed.
NOT_RUN = {
    "./run": "builds, installs packages or runs tests",
    "ctest": "runs tests",
    "node neutral_kit/": "needs the functions of an engine; cli.conformance_docs runs it",
    "cmake --preset dev": "builds everything",
    "dpkg-buildpackage": "builds everything; `./run release` runs it",
    "tests/install/release.sh": "needs the files of a release",
    "tests/install/debian.sh": "needs a Debian mirror",
    "python3 -m pytest -c tests/pytest.ini tests/faults": "takes minutes; the test faults runs it with fewer points",
    "python3 tests/tags/peers.py": "needs every other program; it writes the table of its page",
    "ssh farm": "there is no farm; the test cli.output has its part after the pipe",
    "cmake --install": "the test install runs it",
    "g++ main.cpp": "the test install compiles and links programs so",
    "export OIIO_LIBRARY_PATH=": "a path of an installed plugin; the test clients.plugin runs the next commands",
    'oiiotool "shot.exr.tonewright': "needs that path",
    'oiiotool --colorconfig ocio_config/config.ocio in.exr --ociodisplay Rec.2100-PQ "AgX - HDR 1000 nits" --cicp':
        "needs oiiotool 3.1; the test clients.ocio_tools_newer runs it",
    "OCIO=ocio_config/config-2.5.ocio oiiotool": "needs OpenColorIO 2.5; the test clients.ocio_tools_newer runs it",
    "iinfo -v": "needs that path",
    "idiff": "needs that path",
    "maketx": "needs that path",
    "iv shot.tonewright": "opens a window",
    "GAMMA=2.2 iv": "opens a window",
    "OCIO=/path/to/ocio_config/config.ocio blender": "opens a window; the tests of Blender load the config",
    "OCIO=my_config/config.ocio blender": "opens a window",
    "rv ": "needs RV",
    "tonewright apply in.exr out.png --operator tony.dds": "needs that LUT of Tony McMapface; the test cli.lut_operators reads such files",
    "npm ": "the test shader.threejs packs and installs the package",
    "build/release/bin/tonewright_tools npm": "the test shader.threejs runs it",
    "tonewright config -o everything": "takes minutes; the test parity.artifacts compares such a config",
    "tonewright verify --config": "takes minutes; the test parity.verify_config runs it",
    "tonewright apply shot.%04d.exr out.%04d.png --operator agx_blender": "the test farm runs it",
    "tonewright apply shot.####.exr out.####.png --frames 1041-1050": "its end is left to the reader",
}


def commands(page, is_followed):
    """(command or line, what the page says that it prints or None, whether it is a command) of the blocks that run here."""
    for kind, text in blocks(page):
        if kind == "sh" and not is_followed:
            yield text.rstrip(), None, True
        if kind:
            continue
        transcript = None  # of the command whose output the lines are
        for line in text.replace("\\\n", "").splitlines():
            found = COMMAND.fullmatch(line)
            if found and transcript:
                yield transcript[0], " ".join(" ".join(transcript[1:]).split()), True
            if found:
                transcript = [found.group(2)] if found.group(1) else None
                if not transcript:
                    yield found.group(2), None, True
            elif transcript:
                transcript.append(line)
            elif line:
                yield line, None, False
        if transcript:
            yield transcript[0], " ".join(" ".join(transcript[1:]).split()), True


class Files:
    """The files that pages take for granted, small."""

    def __init__(self, command, folder):
        self.folder = folder
        self.environment = {**os.environ, "LC_ALL": "C.UTF-8",
                            "PATH": f"{command.parent}:{Path(sys.executable).parent}:{os.environ['PATH']}"}
        for name in ("ocio_config", "python_check", "src"):
            (folder / name).symlink_to(PROJECT / name)
        self.run("tonewright", "chart", "-q", "-o", "chart.exr")
        self.run("oiiotool", "chart.exr", "--resize", "192x108", "-o", "render.exr")
        for name in ("in", "photo", "a", "b", "plate"):
            shutil.copy(folder / "render.exr", folder / f"{name}.exr")
        (folder / "renders").mkdir()
        shutil.copy(folder / "render.exr", folder / "renders" / "one.exr")
        (folder / "list.txt").write_text("a.exr\nb.exr\n")
        (folder / "colors.txt").write_text("0.18 0.18 0.18\n4 0.5 0.1\n")
        self.run("oiiotool", "render.exr", "--ch", "R,G,B,A=0.5", "-o", "rgba.exr")
        self.run("oiiotool", "render.exr", "--clamp:min=0:max=1", "-d", "uint8", "-o", "logo.png")
        self.run("tonewright", "apply", "-q", "render.exr", "photo.png", "--operator", "hable")
        self.run("oiiotool", "--colorconfig", "ocio_config/config.ocio", "render.exr", "--colorconvert", "lin_rec709", "ACEScct",
                 "-o", "acescct.exr")
        self.run("oiiotool", "render.exr", "--resize", "32x18", "-o", "small.exr")
        for number in (1, 2, *range(1001, 1101)):
            shutil.copy(folder / "small.exr", folder / f"shot.{number:04d}.exr")
        (folder / "studio.ocio").write_text(ACES)
        self.run("oiiotool", "rgba.exr", "--dup", "--chnames", "diffuse.R,diffuse.G,diffuse.B,diffuse.A", "--chappend", "-o", "layers.exr")
        shutil.copy(folder / "rgba.exr", folder / "flame.exr")
        names = ("rgba.left", "rgba.right")
        parts = [word for name in names for word in ("render.exr", "--attrib", "oiio:subimagename", name)]
        self.run("oiiotool", *parts, "--siappendall", "-o", "stereo.exr")
        self.run("oiiotool", "logo.png", "--dup", "--siappend", "-o", "page.tif")

    def run(self, *command):
        subprocess.run(command, cwd=self.folder, check=True, env=self.environment)

    def before(self, command):
        """Files that one command needs, and whose making is not on the page."""
        def bake(name, *options):
            self.run("tonewright", "bake", *options, "-q", "-o", name)

        if "other.cube" in command:
            bake("other.cube", "agx_sobotka", "--input-encoding", "acescct")
        elif "film.cube" in command:
            bake("film.cube", "hable", "--input-encoding", "acescct")
        elif "AgX.cube" in command:
            bake("AgX.cube", "agx_sobotka", "--input-encoding", "log2:-10:6.5", "--display", "srgb", "--size", "33", "--format", "cube")
        elif "hald.png" in command:
            bake("hald.png", "hable", "--for", "imagemagick")
        elif "hdr10.mkv" in command:
            self.run("ffmpeg", "-y", "-v", "error", "-f", "lavfi", "-i", "testsrc2=size=192x108:rate=5:duration=0.4,format=yuv420p10le",
                     "-c:v", "libx265", "-color_primaries", "bt2020", "-color_trc", "smpte2084", "-colorspace", "bt2020nc",
                     "-color_range", "tv", "-x265-params", "log-level=error", "hdr10.mkv")
        elif "broken.cube" in command:
            lines = ["LUT_3D_SIZE 4", *["# a comment"] * 33, "0.2 0.3"]
            (self.folder / "broken.cube").write_text("\n".join(lines) + "\n")
        elif "unknown.cube" in command:
            self.write_defect()

    def write_defect(self):
        """A LUT with a published mistake, from its formula in NumPy."""
        size = 33
        axis = 0.18 * 2.0 ** np.linspace(-10, 6.5, size)
        blue, green, red = np.meshgrid(axis, axis, axis, indexing="ij")
        code = DEFECTS["agx_minimal_clamped"](np.stack([red, green, blue], -1).reshape(-1, 3))
        light = np.clip(code, 0, 1) ** 2.2  # the display decodes its code values
        srgb = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)
        rows = "".join("%.6f %.6f %.6f\n" % tuple(row) for row in srgb)
        (self.folder / "unknown.cube").write_text(f"LUT_3D_SIZE {size}\n{rows}")


def check_options(report, command, environment):
    """Options of a command that does not run."""
    words = shlex.split(command, comments=True)
    if words[0] != "tonewright":
        return
    known = subprocess.run(["tonewright", words[1], "--help-all"], capture_output=True, text=True, env=environment, check=True).stdout
    unknown = [word for word in words[2:] if word.startswith("--") and not re.search(rf"{re.escape(word.split('=')[0])}\b", known)]
    report.check(f"  {command}: its options exist", not unknown, unknown)


def check_page(report, path, binary, used):
    name = str(path.relative_to(PROJECT))
    found = list(commands(path.read_text(), name in FOLLOWED))
    if not found:
        return 0
    print(f"{name}:")
    with tempfile.TemporaryDirectory() as scratch:
        files = Files(binary, Path(scratch))
        for text, expected, is_command in found:
            if not is_command:
                report.check(f"  {text}: is a command", False, "expected a program of PROGRAMS, or `text` behind the fence")
                continue
            begin = next((begin for begin in NOT_RUN if text.startswith(begin)), None)
            if begin:
                used.add(begin)
                check_options(report, text, files.environment)
                continue
            lacks = text.startswith("ffmpeg") and missing("ffmpeg", binary.parents[1])
            if lacks:
                print(f"skipped: {text} ({lacks})")
                continue
            files.before(text)
            # A reader answers ffmpeg's question; and the config lies elsewhere.
            text = re.sub(r"^ffmpeg ", "ffmpeg -y ", text).replace("/path/to/", "")
            done = subprocess.run(["sh", "-ec", text], cwd=scratch, env=files.environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            if expected is None:
                report.check(f"  {text}", done.returncode == 0, done.stdout[-2000:])
            else:
                differs = output_differs(" ".join(done.stdout.split()) + "\n", expected + "\n")
                report.check(f"  $ {text}", differs is None, differs)
    return len(found)


PAGES = [path for path in (PROJECT / "README.md", *sorted(DOCS.rglob("*.md"))) if path not in GENERATED]
PAGES_WITH_COMMANDS = [path for path in PAGES if list(commands(path.read_text(), str(path.relative_to(PROJECT)) in FOLLOWED))]


@pytest.fixture(scope="module")
def used():
    """The beginnings in NOT_RUN that a page has; a page adds its name, too."""
    return set()


@pytest.mark.parametrize("path", PAGES_WITH_COMMANDS, ids=lambda path: str(path.relative_to(PROJECT)))
def test_page(report, command, used, path):
    report.check(f"{path}: its commands are counted", check_page(report, path, command, used))
    used.add(path)


def test_reasons(report, used):
    if not used.issuperset(PAGES_WITH_COMMANDS):
        pytest.skip("the reasons in NOT_RUN are compared with all pages")
    found = used - set(PAGES)
    report.check("every reason in NOT_RUN is needed", found == set(NOT_RUN), sorted(set(NOT_RUN) - found))
