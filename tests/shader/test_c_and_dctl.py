#!/usr/bin/env python3
"""C and DCTL that `tonewright shader` writes, compiled and run against `tonewright eval`.

C by every compiler there is, with -O2 and -ffast-math; DCTL as C++, with the words of DCTL defined, and with
-ffast-math, as Resolve compiles it. All operators, presets and looks with TONEWRIGHT_TEST_ALL=1, else a dozen.

Usage: test_c_and_dctl.py TONEWRIGHT [--record FILE]
--record merges the largest errors into a JSON file: implementation -> function -> error.
"""
import csv
import ctypes
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

IS_FULL = os.environ.get("TONEWRIGHT_TEST_ALL") == "1"
# Words of DCTL, for a C++ compiler.
DCTL = """
#include <cmath>
struct float3 { float x, y, z; };
static inline float3 make_float3(float x, float y, float z) { return {x, y, z}; }
#define __DEVICE__ static inline
#define __CONSTANT__ static const
#define _powf powf
#define _log2f log2f
#define _exp2f exp2f
#define _fmaxf fmaxf
#define _fminf fminf
#define _fabs fabsf
#define _sqrtf sqrtf
#define _sinf sinf
#define _cosf cosf
#define _atan2f atan2f
#define _floor floorf
"""


def colors() -> np.ndarray:
    """Grays, saturated colors, negatives, and numbers that break shaders; no NaN."""
    rng = np.random.default_rng(5)
    gray = 0.18 * 2.0 ** np.linspace(-12, 12, 200)
    light = 2.0 ** rng.uniform(-16, 12, (1500, 3))
    light[::7, 0] = 0
    signed = 2.0 ** rng.uniform(-10, 10, (300, 3)) * rng.choice([-1, 1], (300, 3))
    hostile = np.array(np.meshgrid(*[[0, -1e-45, 1e-38, 1e-10, 1, 65504, 1e30, np.inf, -np.inf, -0.2]] * 3)).reshape(3, -1).T
    return np.concatenate([np.repeat(gray[:, None], 3, 1), light, signed, hostile]).astype(np.float32)


def run(library: pathlib.Path, function: str, rgb: np.ndarray) -> np.ndarray:
    out = np.empty_like(rgb)
    pointer = ctypes.POINTER(ctypes.c_float)
    ctypes.CDLL(str(library))[f"run_{function}"](rgb.ctypes.data_as(pointer), out.ctypes.data_as(pointer),
                                                  ctypes.c_long(len(rgb)))
    return out


def record(path: pathlib.Path, errors: dict) -> None:
    known = json.loads(path.read_text()) if path.exists() else {}
    path.write_text(json.dumps(known | errors, indent=1))


def main(tonewright: str, record_file: str = "") -> int:
    failures = []
    recorded = {"C": {}, "DCTL": {}}
    rgb = colors()
    text = "\n".join(" ".join(repr(float(x)) for x in row) for row in rgb) + "\n"
    c_compilers = [c for c in ("gcc", "clang") if shutil.which(c)]
    runs = [("c", [c, "-x", "c", "-std=c99", *flags]) for c in c_compilers for flags in (["-O2"], ["-O2", "-ffast-math"])]
    runs += [("dctl", ["g++", "-x", "c++", "-O2", "-ffast-math"])]
    if not c_compilers:
        print("no C compiler")
        return 77
    truth, worst_of = {}, {}
    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        rows = {}
        subprocess.run([tonewright, "shader", "--all", str(folder), "--display", "srgb", "-q"], check=True)
        manifest = list(csv.DictReader(open(folder / "MANIFEST.csv")))
        for language in ("c", "dctl"):
            rows[language] = [row for row in manifest if row["path"].startswith(language + "/")]
            if not IS_FULL:
                rows[language] = rows[language][3::8]
        for number, (language, command) in enumerate(runs):
            source = DCTL if language == "dctl" else ""
            for row in rows[language]:
                function = row["function"]
                source += f'#include "{folder}/{row["path"]}"\n'
                body = (f"float3 c = {function}(make_float3(a[0], a[1], a[2])); b[0] = c.x; b[1] = c.y; b[2] = c.z;"
                        if language == "dctl" else f"{function}(a, b);")
                linkage = 'extern "C" ' if language == "dctl" else ""
                source += (f"{linkage}void run_{function}(const float* a, float* b, long n) "
                           f"{{ for (; n > 0; --n, a += 3, b += 3) {{ {body} }} }}\n")
            (folder / "all.src").write_text(source)
            library = folder / f"all{number}.so"
            subprocess.run([*command, "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", str(folder / "all.src"), "-o",
                            str(library), "-lm"], check=True)
            for row in rows[language]:
                operator, function = row["operator"], row["function"]
                if operator not in truth:
                    lines = subprocess.run([tonewright, "eval", operator, "--digits", "12"], input=text, check=True,
                                           capture_output=True, text=True).stdout
                    truth[operator] = np.array([line.split() for line in lines.splitlines()], float)
                got = run(library, function, rgb).astype(float)
                what = f"{operator} by {' '.join(command)}"
                if not np.isfinite(got).all():
                    failures.append(f"{what}: not finite for {rgb[~np.isfinite(got).all(axis=1)][0]}")
                    continue
                error_of = np.abs(got - truth[operator])
                error = error_of.max()
                worst_of[operator] = max(error, worst_of.get(operator, 0))
                of_language = recorded[language.upper()]
                of_language[function] = max(error, of_language.get(function, 0))
                # The estimate of the text: Vulkan's errors, which a C library's are below; twice, because it is
                # computed over probe colors. Where first order says nothing: what float is enough for.
                bound = 2 * float(row["vulkan_estimate"])
                if not error <= (bound if np.isfinite(bound) else 2e-6):
                    failures.append(f"{what}: {error:.2g} off; expected at most {bound:.2g}")
                # The guaranteed bound is of operations as they are written. 1e-8: what the series of 1 - 2^x may be off.
                bounded = error_of[((rgb >= 0) & (rgb <= 65504)).all(axis=1)].max()
                if "-ffast-math" not in command and not bounded <= float(row["guaranteed"]) + 1e-8:
                    failures.append(f"{what}: {bounded:.2g} off; guaranteed are {row['guaranteed']}")
    within = sum(error <= 2e-6 for error in worst_of.values())
    print(f"{len(worst_of)} functions, {len(runs)} compilers and settings; {within} within 2e-6")
    if record_file:
        record(pathlib.Path(record_file), recorded)
    for failure in failures:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], *(sys.argv[3:] if sys.argv[2:3] == ["--record"] else [])))
