# SPDX-License-Identifier: Apache-2.0
"""C, DCTL and BlinkScript that `tonewright shader` writes, compiled and run against `tonewright eval`.

C by GCC and Clang, one with -ffast-math (the commit says which); DCTL by pocl, as OpenCL with Resolve's flags and without; whole
kernels for Nuke as C++, with the words of Blink defined, with a slider at its default, and every second one with fitted
curves. All operators, presets and looks with TONEWRIGHT_TEST_ALL=1, and a million hostile colors through ten of them; else
a dozen.

    python3 -m pytest tests/shader/test_c_and_dctl.py --tonewright build/release/bin/tonewright
"""

import ctypes
import pathlib
import shutil
import subprocess

import numpy as np
from opencl import RESOLVE, OpenCl, device
from pictures import ALL, share_of, skip

# Words of Blink, for a C++ compiler; the functions are those of Foundry's page "Maths Functions", Blink 16.1.
BLINK = """
#include <cmath>
struct float3 { float x, y, z; float3(float a, float b, float c) : x(a), y(b), z(c) {} };
struct float4 { float x, y, z, w; float4(float a, float b, float c, float d) : x(a), y(b), z(c), w(d) {} };
enum Granularity { ePixelWise };
enum Access { eRead, eWrite, eAccessPoint, eAccessRandom, eEdgeClamped };
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


def compiled(command: list, rows: list, shaders: pathlib.Path, folder: pathlib.Path) -> ctypes.CDLL:
    """A library with run_FUNCTION of each row."""
    source = folder / "all.c"
    source.write_text("".join(f'#include "{shaders.resolve()}/{row["path"]}"\n'
                              f"void run_{row['function']}(const float* a, float* b, long n) "
                              f"{{ for (; n > 0; --n, a += 3, b += 3) {row['function']}(a, b); }}\n" for row in rows))
    library = folder / ("_".join(command).replace("/", "") + ".so")
    subprocess.run([*command, "-std=c99", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", str(source), "-o", str(library),
                    "-lm"], check=True)
    return ctypes.CDLL(str(library))


def compiled_kernels(tonewright: str, rows: list, folder: pathlib.Path) -> ctypes.CDLL:
    """A library with run_FUNCTION of the kernel that Nuke takes, for each row. Alpha stays as it is."""
    text = BLINK
    for number, row in enumerate(rows):
        function = row["function"]
        path = folder / f"{function}.blink"
        subprocess.run([tonewright, "shader", row["operator"], "--for", "nuke", "--display", "srgb", "--uniforms", "exposure",
                        "--curves", ("formula", "fitted")[number % 2], "-o", str(path), "-q"], check=True, capture_output=True)
        text += (f'#include "{path}"\n'
                 f'extern "C" void run_{function}(const float* a, float* b, long n) {{\n'
                 f"    for (; n > 0; --n, a += 3, b += 3) {{ {function}_kernel k; k.define();\n"
                 "        k.src() = float4(a[0], a[1], a[2], 0.5f); k.process();\n"
                 "        b[0] = k.dst().x; b[1] = k.dst().y; b[2] = k.dst().w == 0.5f ? k.dst().z : -1; }\n}\n")
    (folder / "all.cpp").write_text(text)
    library = folder / "kernels.so"
    subprocess.run(["g++", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", str(folder / "all.cpp"), "-o", str(library)],
                   check=True)
    return ctypes.CDLL(str(library))


def run(library: ctypes.CDLL, function: str, rgb: np.ndarray) -> np.ndarray:
    out = np.empty_like(rgb)
    pointer = ctypes.POINTER(ctypes.c_float)
    library[f"run_{function}"](rgb.ctypes.data_as(pointer), out.ctypes.data_as(pointer), ctypes.c_long(len(rgb)))
    return out


def test_functions(comparison, command, shaders, scratch, errors_file):
    device()
    compilers = [c for c in ("gcc", "clang") if shutil.which(c)]
    if not compilers:
        skip("no C compiler")
    flags = [["-O2"], ["-O2", "-ffast-math"]]
    if ALL:
        commands = [[c, *words] for c in compilers for words in flags]
    else:
        first = share_of(range(2), 2)[0]
        commands = [[c, *flags[(first + i) % 2]] for i, c in enumerate(compilers)]
    runs = [("c", words, compiled(words, comparison.rows["c"], shaders, scratch)) for words in commands]
    runs.append(("blinkscript", ["g++", "-O2"], compiled_kernels(command, comparison.rows["blinkscript"], scratch)))
    for language, words, library in runs:
        for row in comparison.rows[language]:
            comparison.add(language, " ".join(words), row, run(library, row["function"], comparison.colors_of(row)),
                           is_as_written=language == "c" and "-ffast-math" not in words)
    rows = comparison.rows["dctl"]
    texts = {row["function"]: (shaders / row["path"]).read_text() for row in rows}
    calls = {function: f"{function}(vload3(0, a + i))" for function in texts}
    for flags in ((), RESOLVE):
        opencl = OpenCl(texts, calls, flags)
        for row in rows:
            comparison.add("dctl", " ".join(["pocl", *flags]), row, opencl.run(row["function"], comparison.colors_of(row)),
                           is_as_written=not flags)
    comparison.finish(f"{', '.join(map(' '.join, commands))}; pocl", errors_file)
