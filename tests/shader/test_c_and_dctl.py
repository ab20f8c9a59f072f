#!/usr/bin/env python3
"""C and DCTL that `tonewright shader` writes, compiled and run against `tonewright eval`.

C by every compiler there is, with -O2 and -ffast-math; DCTL by pocl, as OpenCL with Resolve's flags and without. All
operators, presets and looks with TONEWRIGHT_TEST_ALL=1, and a million hostile colors through ten of them; else a dozen.

Usage: test_c_and_dctl.py TONEWRIGHT SHADERS [--record FILE]
SHADERS is the folder that `tonewright shader --all SHADERS --display srgb` wrote.
--record merges the largest errors into a JSON file: language -> function -> error.
"""
import ctypes
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

from executed import Comparison, skip, start
from opencl import RESOLVE, OpenCl, device


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


def run(library: ctypes.CDLL, function: str, rgb: np.ndarray) -> np.ndarray:
    out = np.empty_like(rgb)
    pointer = ctypes.POINTER(ctypes.c_float)
    library[f"run_{function}"](rgb.ctypes.data_as(pointer), out.ctypes.data_as(pointer), ctypes.c_long(len(rgb)))
    return out


def main(tonewright: str, shaders: pathlib.Path, record_file: str) -> int:
    device()
    comparison = Comparison(tonewright, shaders)
    compilers = [c for c in ("gcc", "clang") if shutil.which(c)]
    if not compilers:
        skip("no C compiler")
    commands = [[c, *flags] for c in compilers for flags in (["-O2"], ["-O2", "-ffast-math"])]
    with tempfile.TemporaryDirectory() as folder_name:
        for command in commands:
            library = compiled(command, comparison.rows["c"], shaders, pathlib.Path(folder_name))
            for row in comparison.rows["c"]:
                comparison.add("c", " ".join(command), row, run(library, row["function"], comparison.colors_of(row)),
                               is_as_written="-ffast-math" not in command)
    rows = comparison.rows["dctl"]
    texts = {row["function"]: (shaders / row["path"]).read_text() for row in rows}
    calls = {function: f"{function}(vload3(0, a + i))" for function in texts}
    for flags in ((), RESOLVE):
        opencl = OpenCl(texts, calls, flags)
        for row in rows:
            comparison.add("dctl", " ".join(["pocl", *flags]), row, opencl.run(row["function"], comparison.colors_of(row)),
                           is_as_written=not flags)
    return comparison.report(f"{', '.join(map(' '.join, commands))}; pocl", record_file)


if __name__ == "__main__":
    start(main)
