# SPDX-License-Identifier: Apache-2.0
"""Shared by the test scripts: pictures as NumPy arrays, programs, the report, the codes of displays and LUTs.

Pixels travel through uncompressed float EXR, which is a header, a table and rows of numbers: oiiotool turns any
picture into one, ffmpeg and tonewright read and write it, and every float survives, NaN and negatives included.
"""

import contextlib
import os
import shutil
import struct
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np

SKIPPED = 77  # exit status that ctest counts as skipped
runs_in_pytest = False  # conftest.py sets it
ALL = os.environ.get("TONEWRIGHT_TEST_ALL") == "1"  # `./run test --all`: full sample sets
PROJECT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(PROJECT / "python_check"))
from lut_encodings import acescct_decode, acescct_encode  # noqa: E402, F401  (with the other codes below)

# --------------------------------------------------------------------------------------------------
# Report


class Report:
    """Prints one line per check and counts them; from any thread. Errors are compared with a bound; NaN fails."""

    def __init__(self, whole=None):
        """whole: the report of the run that a test belongs to, which counts its checks, too."""
        self.passed = self.failed = 0
        self.failures, self.whole = [], whole
        self.lock = threading.Lock()

    def count(self, ok):
        with self.lock:
            self.passed += bool(ok)
            self.failed += not ok

    def check(self, what, ok, detail=""):
        self.count(ok)
        if self.whole:
            self.whole.count(ok)
        said = f"{'ok  ' if ok else 'FAIL'} {what}" + (f"\n     {detail}" if detail and not ok else "")
        with self.lock:
            if not ok:
                self.failures.append(said)
            print(said, flush=True)
        return bool(ok)

    def bound(self, what, error, bound, detail=""):
        ok = bool(error <= bound)
        times = error / bound if bound else error
        return self.check(f"{what:72s} max {error:8.2g}  bound {bound:8.2g}  {times:6.2f} x", ok, detail)

    def compare(self, what, actual, expected, bound, light=None):
        """Arrays of colors; a failure prints the worst one.

        light: the light of a code value, see LIGHT: near black, where codes are steep, the errors of light count.
        """
        if actual.shape != expected.shape:
            return self.check(what, False, f"shape is {actual.shape}, expected {expected.shape}")
        difference = np.abs(actual.astype(float) - expected)
        if light:
            of_light = np.abs(light(actual.astype(float)) - light(expected.astype(float)))
            difference = np.minimum(difference, SRGB_SLOPE * of_light)
        error = difference.max(initial=0)
        if error <= bound:
            return self.bound(what, error, bound)
        at = np.unravel_index(np.argmax(np.where(np.isnan(difference), np.inf, difference)), difference.shape)[:-1]
        return self.bound(what, error, bound, f"at {tuple(map(int, at))}: is {actual[at]}, expected {expected[at]}")

    def finish(self):
        """The last line; returns the exit status."""
        print(f"{self.passed} passed, {self.failed} failed")
        return 1 if self.failed else 0


def skip(reason):
    """Ends the script, or the test or the file of pytest, as skipped."""
    if runs_in_pytest:
        sys.modules["pytest"].skip(reason, allow_module_level=True)
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def share_of(items, parts):
    """Every parts-th of the items, by the commit's hash: a few commits test all of them. All with `./run test --all`.

    By other digits of the hash than CI's slices. A share within a share needs another number of parts.

    TONEWRIGHT_TEST_SHARE=N selects a share by hand.
    """
    if ALL:
        return list(items)
    number = os.environ.get("TONEWRIGHT_TEST_SHARE")
    if number is None:
        done = subprocess.run(["git", "-C", str(PROJECT), "rev-parse", "HEAD"], capture_output=True, text=True, check=False)
        number = int(done.stdout[8:16] or "0", 16)
    number = int(number) % parts
    print(f"share {number} of {parts} (TONEWRIGHT_TEST_SHARE={number}; `./run test --all` takes all)")
    return list(items)[number::parts]


def share_of_refusals(cases, arguments_of, parts=3):
    """All calls that fail before OpenImageIO is loaded, which takes 0.3 s, and a share of the others.

    @param arguments_of  of a case, those of the command
    """
    load = {"apply", "chart", "compare", "meter", "sheet"}
    slow = [case for case in cases if arguments_of(case) and arguments_of(case)[0] in load]
    return [case for case in cases if case not in slow] + share_of(slow, parts)


def need_program(name, package):
    if not shutil.which(name):
        skip(f"{name} is not installed (Debian: {package})")


# --------------------------------------------------------------------------------------------------
# Programs


def run(*arguments, folder=None, stdin=None):
    """Output of a program that must succeed; raises RuntimeError with what it said."""
    arguments = [str(a) for a in arguments]
    done = subprocess.run(arguments, cwd=folder, input=stdin, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"exit {done.returncode}: {' '.join(arguments)}: {(done.stderr or done.stdout).strip()}")
    return done.stdout


@contextlib.contextmanager
def screen(size="640x480"):
    """An X server without a screen, and its number as DISPLAY; None where there is no such server."""
    if not shutil.which("Xvfb"):
        yield None
        return
    reading, writing = os.pipe()
    # Without -noreset it starts anew after its last client, and refuses those that come meanwhile.
    server = subprocess.Popen(["Xvfb", "-noreset", "-displayfd", str(writing), "-screen", "0", f"{size}x24"],
                              pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(writing)
    try:
        with os.fdopen(reading) as number:
            display = number.readline().strip()
        yield f":{display}" if display else None
    finally:
        server.terminate()
        server.wait()


def evaluate(command, rgb, *arguments):
    """Colors (n, 3) through `tonewright eval`."""
    text = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in np.asarray(rgb, float).tolist())
    out = run(command, "eval", *arguments, stdin=text)
    return np.array(out.split(), float).reshape(-1, 3)


def views(command):
    """(operator, its view in the config) of every operator."""
    return [tuple(line.split("\t")) for line in run(command, "list", "--views").splitlines()]


def files_of(folder):
    """{path in it: bytes} of every file of a folder."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def shared_picture(name):
    """A picture of the project's collection of real HDR pictures, or None: it is not part of the sources.

    The folder is $TONEWRIGHT_SHARED, or ../shared beside the project.
    """
    folder = Path(os.environ.get("TONEWRIGHT_SHARED") or PROJECT.parent / "shared")
    path = folder / "data" / "hdr" / name
    if path.is_file():
        return path
    print(f"skipped: {name} (TONEWRIGHT_SHARED names no folder that holds data/hdr/{name})")
    return None


# --------------------------------------------------------------------------------------------------
# Pictures

EXR_MAGIC = struct.pack("<ii", 20000630, 2)  # version 2, one part, scanlines
EXR_FLOAT = 2


def write_exr(path, planes):
    """An uncompressed float EXR of named planes: {"R": (height, width) array, ...}."""
    names = sorted(planes)  # the order that the format demands
    height, width = planes[names[0]].shape
    channels = b"".join(n.encode() + b"\0" + struct.pack("<iiii", EXR_FLOAT, 0, 1, 1) for n in names) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    header = b""
    for name, kind, value in [("channels", "chlist", channels), ("compression", "compression", b"\0"),
                              ("dataWindow", "box2i", window), ("displayWindow", "box2i", window),
                              ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                              ("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
                              ("screenWindowWidth", "float", struct.pack("<f", 1))]:
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    rows = np.zeros(height, exr_row(len(names), width))
    rows["y"] = np.arange(height)
    rows["size"] = rows.dtype.itemsize - 8
    for i, name in enumerate(names):
        rows["pixels"][:, i] = planes[name]
    start = len(EXR_MAGIC) + len(header) + 1 + 8 * height
    offsets = start + np.arange(height, dtype="<u8") * rows.dtype.itemsize
    Path(path).write_bytes(EXR_MAGIC + header + b"\0" + offsets.tobytes() + rows.tobytes())


def exr_row(channels, width):
    return np.dtype([("y", "<i4"), ("size", "<i4"), ("pixels", "<f4", (channels, width))])


def read_exr(path):
    """Planes of an uncompressed float scanline EXR, as write_exr takes them."""
    data = Path(path).read_bytes()
    if data[:8] != EXR_MAGIC:
        raise ValueError(f"{path}: no EXR of one part and scanlines")
    at, header = 8, {}

    def text(at):
        end = data.index(b"\0", at)
        return data[at:end].decode(), end + 1

    while data[at]:
        name, at = text(at)
        _, at = text(at)
        size, = struct.unpack_from("<i", data, at)
        header[name] = at + 4
        at += 4 + size
    names, entry = [], header["channels"]
    while data[entry]:
        name, entry = text(entry)
        if struct.unpack_from("<iiii", data, entry)[::2] != (EXR_FLOAT, 1):
            raise ValueError(f"{path}: channel {name} is no float of full resolution")
        names.append(name)
        entry += 16
    if data[header["compression"]]:
        raise ValueError(f"{path}: compressed")
    x0, y0, x1, y1 = struct.unpack_from("<iiii", data, header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    rows = np.frombuffer(data, exr_row(len(names), width), height, at + 1 + 8 * height)
    if not (rows["y"] == np.arange(y0, y1 + 1)).all():
        raise ValueError(f"{path}: rows are not in order")
    return {name: rows["pixels"][:, i] for i, name in enumerate(names)}


def read_planes(path, scratch):
    """Planes of any picture that OpenImageIO reads; integers become 0..1. No color conversion takes place."""
    try:
        return read_exr(path)
    except ValueError:
        pass
    try:
        import OpenImageIO as oiio  # here, because it takes as long to load as oiiotool
    except ImportError:
        plain = Path(scratch) / (Path(path).name + ".plain.exr")
        run("oiiotool", path, "-d", "float", "--compression", "none", "-o", plain)
        planes = read_exr(plain)
        plain.unlink()
        return planes
    file = oiio.ImageInput.open(str(path))
    if file is None:
        raise ValueError(oiio.geterror())
    pixels = file.read_image("float")
    if pixels is None:
        raise ValueError(f"{path}: {file.geterror()}")
    return {name: pixels[:, :, i] for i, name in enumerate(file.spec().channelnames)}


def stack(planes, names="RGB"):
    """(height, width, 3) of planes R, G, B."""
    return np.stack([planes[n] for n in names], axis=-1)


def read_rgb(path, scratch):
    return stack(read_planes(path, scratch))


def nearest_of_bytes(shown, expected):
    """Of the numbers that 8 bits stand for, the nearest to the expected: what is left beside the rounding."""
    if shown.shape != expected.shape:
        return shown
    half = 0.5 / 255
    return np.clip(expected, shown.astype(float) - half, shown.astype(float) + half)


def unstack(rgb, names="RGB"):
    return {name: rgb[..., i] for i, name in enumerate(names)}


# --------------------------------------------------------------------------------------------------
# Codes of displays

SRGB_SLOPE = 12.92  # the steepest that sRGB is: so much of a code is an error of light, at most


def pq_light(code):
    """SMPTE ST 2084: 1 is 100 cd/m2."""
    root = np.maximum(code, 0) ** (32 / 2523)
    return 100 * (np.maximum(root - 107 / 128, 0) / (2413 / 128 - 2392 / 128 * root)) ** (16384 / 2610)


def pq_code(light):
    power = (np.maximum(light, 0) / 100) ** (2610 / 16384)
    return ((107 / 128 + 2413 / 128 * power) / (1 + 2392 / 128 * power)) ** (2523 / 32)


HLG_A = 0.17883277
HLG_B, HLG_C = 1 - 4 * HLG_A, 0.5 - HLG_A * np.log(4 * HLG_A)


def hlg_light(code):
    """The inverse OETF of ITU-R BT.2100: light of the scene, 1 at code 1."""
    return np.where(code <= 0.5, code**2 / 3, (np.exp((code - HLG_C) / HLG_A) + HLG_B) / 12)


def hlg_code(light):
    bright = HLG_A * np.log(np.maximum(12 * light - HLG_B, 1e-9)) + HLG_C
    return np.where(light <= 1 / 12, np.sqrt(3 * np.maximum(light, 0)), bright)


# By the names that `--display` takes: those that are infinitely steep, or nearly, at black.
LIGHT = {"rec1886": lambda code: np.maximum(code, 0) ** 2.4, "rec2020": lambda code: np.maximum(code, 0) ** 2.4,
         "g22": lambda code: np.maximum(code, 0) ** 2.2, "rec2100_pq": pq_light, "p3d65_pq": pq_light,
         "rec2100_hlg": hlg_light}

# --------------------------------------------------------------------------------------------------
# Codes that lookup tables take

def log2_encode(light, low=-10, high=6.5):
    """Stops from 0.18, as `--input-encoding log2` counts them."""
    stops = np.log2(np.maximum(light, 0.18 * 2.0**low) / 0.18)
    return (stops - low) / (high - low)


def log2_decode(code, low=-10, high=6.5):
    return 0.18 * 2.0 ** (code * (high - low) + low)
