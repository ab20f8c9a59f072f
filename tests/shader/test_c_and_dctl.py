#!/usr/bin/env python3
"""C and DCTL that `tonewright shader` writes, compiled and run against `tonewright eval`.

C by every compiler there is, with -O2 and -ffast-math; DCTL as C++, with the words of DCTL defined, and with
-ffast-math, as Resolve compiles it. All operators, presets and looks with TONEWRIGHT_TEST_ALL=1, else a dozen.

Usage: test_c_and_dctl.py TONEWRIGHT [--record FILE]
--record merges the largest errors into a JSON file: implementation -> function -> error.
"""
import ctypes
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

from executed import Comparison, skip, start, write_shaders

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


def run(library: pathlib.Path, function: str, rgb: np.ndarray) -> np.ndarray:
    out = np.empty_like(rgb)
    pointer = ctypes.POINTER(ctypes.c_float)
    ctypes.CDLL(str(library))[f"run_{function}"](rgb.ctypes.data_as(pointer), out.ctypes.data_as(pointer),
                                                  ctypes.c_long(len(rgb)))
    return out


def main(tonewright: str, record_file: str) -> int:
    comparison = Comparison(tonewright)
    c_compilers = [c for c in ("gcc", "clang") if shutil.which(c)]
    if not c_compilers:
        skip("no C compiler")
    runs = [("c", [c, "-x", "c", "-std=c99", *flags]) for c in c_compilers for flags in (["-O2"], ["-O2", "-ffast-math"])]
    runs += [("dctl", ["g++", "-x", "c++", "-O2", "-ffast-math"])]
    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        rows = write_shaders(tonewright, folder)
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
                comparison.add(language, " ".join(command), row, run(library, row["function"], comparison.rgb),
                               is_as_written="-ffast-math" not in command)
    return comparison.report(f"{len(runs)} compilers and settings", record_file)


if __name__ == "__main__":
    start(main)
