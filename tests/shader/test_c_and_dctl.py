#!/usr/bin/env python3
"""C, DCTL and BlinkScript that `tonewright shader` writes, compiled and run against `tonewright eval`.

C by every compiler there is, with -O2 and -ffast-math; DCTL as C++, with the words of DCTL defined, and with
-ffast-math, as Resolve compiles it; whole kernels for Nuke as C++, with the words of Blink defined, with a slider
at its default, and every second one with fitted curves. All operators, presets and looks with TONEWRIGHT_TEST_ALL=1, else a dozen.

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

# Words of Blink, for a C++ compiler; the functions are those of Foundry's page "Maths Functions", Blink 16.1.
BLINK = """
#include <cmath>
struct float3 { float x, y, z; float3(float a, float b, float c) : x(a), y(b), z(c) {} };
struct float4 { float x, y, z, w; float4(float a, float b, float c, float d) : x(a), y(b), z(c), w(d) {} };
enum Granularity { ePixelWise };
enum Access { eRead, eWrite, eAccessPoint, eEdgeClamped };
template <Granularity> struct ImageComputationKernel {
    template <class T> void defineParam(T& param, const char*, T value) { param = value; }
    void define() {}
};
template <Access, Access = eAccessPoint, Access = eEdgeClamped> struct Image {
    float4 pixel{0, 0, 0, 0};
    float4& operator()() { return pixel; }
};
static inline float min(float a, float b) { return b < a ? b : a; }
static inline float max(float a, float b) { return a < b ? b : a; }
#define kernel struct
#define param public
using std::fabs; using std::sqrt; using std::log2; using std::pow;
using std::sin; using std::cos; using std::atan2; using std::floor;
"""
# How a color in a[] becomes one in b[].
BODIES = {"c": "{function}(a, b);",
          "dctl": "float3 c = {function}(make_float3(a[0], a[1], a[2])); b[0] = c.x; b[1] = c.y; b[2] = c.z;",
          "blinkscript": "{function}_kernel k; k.define(); k.src() = float4(a[0], a[1], a[2], 0.5f); k.process(); "
                         "b[0] = k.dst().x; b[1] = k.dst().y; b[2] = k.dst().w == 0.5f ? k.dst().z : -1;"}


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
    runs += [("dctl", ["g++", "-x", "c++", "-O2", "-ffast-math"]), ("blinkscript", ["g++", "-x", "c++", "-O2"])]
    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        rows = write_shaders(tonewright, folder)
        for number, row in enumerate(rows["blinkscript"]):
            subprocess.run([tonewright, "shader", row["operator"], "--for", "nuke", "--display", "srgb", "--uniforms",
                            "exposure", "--curves", ("formula", "fitted")[number % 2], "-o", str(folder / row["path"]), "-q"],
                           check=True, capture_output=True)
        for number, (language, command) in enumerate(runs):
            source = {"dctl": DCTL, "blinkscript": BLINK}.get(language, "")
            for row in rows[language]:
                function = row["function"]
                source += f'#include "{folder}/{row["path"]}"\n'
                body = BODIES[language].format(function=function)
                linkage = 'extern "C" ' if language != "c" else ""
                source += (f"{linkage}void run_{function}(const float* a, float* b, long n) "
                           f"{{ for (; n > 0; --n, a += 3, b += 3) {{ {body} }} }}\n")
            (folder / "all.src").write_text(source)
            library = folder / f"all{number}.so"
            subprocess.run([*command, "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", str(folder / "all.src"), "-o",
                            str(library), "-lm"], check=True)
            for row in rows[language]:
                comparison.add(language, " ".join(command), row, run(library, row["function"], comparison.rgb),
                               is_as_written=language == "c" and "-ffast-math" not in command)
    return comparison.report(f"{len(runs)} compilers and settings", record_file)


if __name__ == "__main__":
    start(main)
