#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Programs side by side on the tagged files of make_files.py: who gets the light that the tag states?

    /usr/bin/python3 tests/tags/peers.py build/release/bin/tonewright [--program NAME...] [--write docs/input_files.md] [NAME...]

Each program gets the command that its manual gives for linear Rec.709 in floats. A file is right if every channel is within
1 % of the derived value, or within 0.5 % of the largest channel. Missing programs are left out, and their columns stay as
they are in the page. TONEWRIGHT_NEWER_PROGRAMS names a program that runs what follows it with newer packages (oiiotool 3.1,
libvips, ffmpeg 8 or newer, ImageMagick 7, darktable).
"""

import argparse
import concurrent.futures
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity" / "clients"))
from file_bytes import SRGB_PARAMETRIC, icc_matrix  # noqa: E402
from make_files import IMPOSSIBLE, ROWS, Missing  # noqa: E402
from pictures import skip  # noqa: E402

try:
    import OpenImageIO as oiio
except ImportError:
    skip("OpenImageIO's Python module is missing (Debian: python3-openimageio)")

NEWER = os.environ.get("TONEWRIGHT_NEWER_PROGRAMS", "")
RELATIVE, OF_LARGEST = 0.01, 0.005
UNITS = (203, 1000, 10000)
ABSOLUTE = ("/16", "/18", "pq_", "hlg_", "over iCCP")
# Formats whose numbers are linear: a user of ffmpeg knows that much about an untagged file.
LINEAR = (".exr", ".hdr", ".pfm")


class Program:
    """commands: shell text with %RUN%, %IN%, %OUT% and %TMP%; the first that succeeds counts.

    linear_commands: more of them for files whose numbers are linear by definition; the best one counts."""

    def __init__(self, title, executable, version, commands, suffix, newer=False, linear_commands=None):
        self.title, self.executable, self.version_words, self.suffix, self.newer = title, executable, version, suffix, newer
        self.commands, self.linear_commands = commands, linear_commands or []

    def launcher(self):
        return f"{NEWER} " if self.newer else ""

    def version(self):
        """Empty if the program is not here."""
        if self.newer and not NEWER or not self.newer and not shutil.which(self.executable):
            return ""
        try:
            done = subprocess.run(f"{self.launcher()}{self.executable} {self.version_words}", shell=True, capture_output=True,
                                  text=True, timeout=60, check=False)
        except subprocess.TimeoutExpired:
            return ""
        found = re.search(r"\d+\.\d+(\.\d+)*(-\d+)?", done.stdout + done.stderr) if done.returncode == 0 else None
        return found.group() if found else ""

    def read(self, path, row, scratch):
        """The pixel of each command that writes a picture, and what the last one that fails says."""
        out, said, values = scratch / f"out{self.suffix}", "", []
        linear = path.suffix in LINEAR or "float" in row.name
        for command in dict.fromkeys(self.commands + self.linear_commands * linear):
            for old in scratch.glob("out*"):
                old.unlink()
            words = command
            for name, text in (("RUN", self.launcher() + self.executable), ("IN", f"'{path}'"), ("OUT", f"'{out}'"), ("TMP", f"'{scratch}'")):
                words = words.replace(f"%{name}%", text)
            try:
                done = subprocess.run(words, shell=True, capture_output=True, text=True, errors="replace", timeout=120, cwd=scratch, check=False)
            except subprocess.TimeoutExpired:
                return values, "no end after 120 s"
            if done.returncode == 0 and out.is_file():
                values.append(self.light(pixel(out)))
                if not linear:
                    break
            else:
                said = (done.stderr or done.stdout).strip()[:300].replace("\n", " ")
        return values, said

    def light(self, value):
        return value


def pixel(path):
    config = oiio.ImageSpec()
    config["oiio:UnassociatedAlpha"] = 1
    reader = oiio.ImageInput.open(str(path), config)
    spec = reader.spec()
    picture = np.asarray(reader.read_image(oiio.FLOAT), float).reshape(spec.height, spec.width, spec.nchannels)
    reader.close()
    value = picture[min(4, spec.height - 1), min(4, spec.width - 1)]
    return value[:3] if spec.nchannels >= 3 else np.repeat(value[:1], 3)


# zscale takes what ffmpeg read from the file. For a file without a tag a user states sRGB, or linear light.
ZSCALE = "zscale={}t=linear:p=709:npl=100,format=gbrpf32le"
FFMPEG = "%RUN% -v error -y -i %IN% -vf " + ZSCALE + " -frames:v 1 %OUT%"
# magick -profile converts if the file has a profile, and only says what the file is where it has none.
MAGICK = "%RUN% %IN% -auto-orient -profile %TMP%/srgb.icc -colorspace RGB -alpha off -depth 32 -define quantum:format=floating-point %OUT%"
PROGRAMS = [
    Program("oiiotool 2.4", "oiiotool", "--version", ["%RUN% %IN% --tocolorspace linear -d float -o %OUT%"], ".exr"),
    Program("oiiotool 3.1", "oiiotool", "--version",
            ["%RUN% %IN% --tocolorspace lin_rec709_scene -d float -o %OUT%",
             "%RUN% %IN% --iscolorspace srgb_rec709_scene --tocolorspace lin_rec709_scene -d float -o %OUT%"], ".exr", True,
            ["%RUN% %IN% --tocolorspace lin_rec709_scene -d float -o %OUT%", "%RUN% %IN% -d float -o %OUT%"]),
    Program("ImageMagick 7", "magick-im7.q16hdri", "-version", [MAGICK], ".tif", True,
            ["%RUN% %IN% -set colorspace RGB -alpha off -depth 32 -define quantum:format=floating-point %OUT%"]),
    Program("libvips", "vips", "--version",
            ["%RUN% icc_import %IN% %TMP%/pcs.v --embedded --pcs xyz && %RUN% colourspace %TMP%/pcs.v %OUT% scrgb", "%RUN% colourspace %IN% %OUT% scrgb"],
            ".tif", True, ["%RUN% colourspace %IN% %OUT% scrgb"]),
    Program("ffmpeg", "ffmpeg", "-version", [FFMPEG.format(""), FFMPEG.replace("zscale", "format=gbrp16le,zscale", 1).format("min=gbr:tin=iec61966-2-1:pin=709:rin=full:")], ".pfm", True,
            [FFMPEG.format(""), FFMPEG.format("min=gbr:tin=linear:pin=709:rin=full:")]),
    Program("darktable", "darktable-cli", "--version",
            ["%RUN% %IN% %OUT% --hq true --apply-custom-presets false --icc-type LIN_REC709 --core --configdir %TMP%/config --library :memory: "
             "--conf plugins/imageio/format/exr/bpp=32 --conf plugins/darkroom/workflow=none "
             "--conf plugins/darkroom/chromatic-adaptation=legacy --disable-opencl"], ".exr", True),
]


class Tonewright(Program):
    """The operator x/(x+1) is undone; its negatives are gone."""

    def __init__(self, command):
        super().__init__("Tonewright", str(command), "--version", ["%RUN% apply %IN% %OUT% --operator reinhard --display linear -d float -q"], ".exr")

    def light(self, value):
        return value / (1 - value)


def verdict(program, values, row):
    """Of the commands, the best one counts."""
    wants = [np.array(row.rgb), *(np.array(other) for other, _why in row.others)]
    if isinstance(program, Tonewright):
        wants = [np.maximum(want, 0) for want in wants]
    # Programs choose what 1.0 is for absolute luminance.
    absolute = any(word in row.tag for word in ABSOLUTE)
    for nits in (100, *(UNITS if absolute else ())):
        for value in values:
            for want in wants:
                if np.all(np.abs(value * nits / 100 - want) <= np.maximum(RELATIVE * np.abs(want), OF_LARGEST * np.abs(want).max())):
                    return "right" if nits == 100 else f"right (1.0 is {nits} cd/m2)"
    return " ".join(f"{v:.3f}" for v in values[0]) if values else "no picture"


def wanted_of(row):
    """The verdict on Tonewright: it refuses some files, and names the tag of others instead of using it."""
    if row.treatment == IMPOSSIBLE:
        return "no picture"
    return "right" if row.ignored is None else " ".join(f"{v:.3f}" for v in row.ignored)


def one(program, rows, files, scratch):
    folder = scratch / program.title.replace(" ", "_").replace(".", "_")
    folder.mkdir()
    (folder / "srgb.icc").write_bytes(icc_matrix("rec709", SRGB_PARAMETRIC, 4))
    results = {}
    for row in rows:
        values, said = program.read(files / row.name, row, folder)
        results[row.name] = verdict(program, values, row)
        if not values:
            print(f"{program.title}: {row.name}: {said}", flush=True)
    return results


def table(rows, programs, results):
    head = ["file", "tag", "linear Rec.709", *(program.title for program in programs)]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for row in rows:
        cells = [f"`{row.name}`", f"{row.format}: {row.tag}", " ".join(f"{v:.3f}" for v in row.rgb)]
        lines.append("| " + " | ".join([*cells, *(results[program.title].get(row.name, "") for program in programs)]) + " |")
    counts = [sum(v.startswith("right") for v in results[program.title].values()) for program in programs]
    lines.append("| | **right** | | " + " | ".join(f"**{n} of {len(rows)}**" for n in counts) + " |")
    return "\n".join(lines) + "\n"


def earlier(page, programs):
    """Columns of programs that are not here, from the page."""
    text = Path(page).read_text() if page and Path(page).is_file() else ""
    found = {program.title: {} for program in programs}
    titles = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if cells[:2] == ["file", "tag"]:
            titles = cells[3:]
        elif titles and cells[0].startswith("`"):
            for title, cell in zip(titles, cells[3:]):
                if title in found:
                    found[title][cells[0].strip("`")] = cell
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("command")
    parser.add_argument("--program", action="append", help="only this one; may be repeated")
    parser.add_argument("--write", help="the page whose table is replaced")
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    programs = [Tonewright(Path(options.command).resolve()), *PROGRAMS]
    rows = [row for row in ROWS if row.value and (not options.names or row.name in options.names)]
    results = earlier(options.write, programs)
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        files = scratch / "files"
        files.mkdir()
        for row in list(rows):
            try:
                (files / row.name).write_bytes(row.make())
            except Missing as error:
                print(f"skip {row.name}: {error}")
                rows.remove(row)
        chosen = [p for p in programs if not options.program or p.title in options.program]
        versions = {p.title: p.version() for p in chosen}
        here = [p for p in chosen if versions[p.title]]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for program, found in zip(here, pool.map(lambda p: one(p, rows, files, scratch), here)):
                results[program.title] = found
    shown = [p for p in programs if results[p.title]]
    text = table(rows, shown, results)
    print(text)
    for program in here:
        print(f"{program.title}: version {versions[program.title]}: {program.commands[0].replace(chr(37), str())}")
    if options.write:
        page = Path(options.write)
        page.write_text(re.sub(r"(?ms)^\| file \| tag \|.*?\n(?!\|)", lambda _: text, page.read_text() + "\n").rstrip("\n") + "\n")
    # Only Tonewright is tested here: it treats each tag as its row says.
    mine = results["Tonewright"] if any(p.title == "Tonewright" for p in here) else {}
    wanted = {row.name: wanted_of(row) for row in rows}
    wrong = [name for name, said in mine.items() if said != wanted[name]]
    for name in wrong:
        print(f"FAIL {name}: {mine[name]}; expected {wanted[name]}")
    print(f"{len(mine) - len(wrong)} passed, {len(wrong)} failed")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
