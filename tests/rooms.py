#!/usr/bin/env python3
"""Every function of the public headers is named in a C++ test, and every long source file has a test file of its name.

A reader finds the test of src/FOLDER/NAME.cpp in tests/unit/FOLDER/NAME_test.cpp.

Usage: rooms.py REPOSITORY
"""
import pathlib
import re
import sys

LONG = 150  # lines: shorter files may share a test file with their neighbors
# Folders whose files need no unit test of their name.
FOLDERS = {
    "cli": "programs: tests/cli runs the command",
    "plot": "plots: tests/unit/plot draws each kind, tests/cli/test_plot.py looks at the files",
    "tools": "programs: tests/cli runs what maintainers run",
    "plugin": "a module that OpenImageIO loads: tests/parity/clients/test_plugin.py",
    "python": "a module that Python loads: tests/cli/test_python.py",
    "report": "pages: tests/report looks at them in a browser",
    "operators": "formulas: tests/laws, tests/data/operators.csv and python_check test each by its name",
    "shader_runs": "drivers that may be missing: tests/unit/shader_runs/shader_run_test.cpp, tests/shader",
}
# Files, in the same way.
FILES = {
    "base/stroke_font": "the strokes of letters, a table: contact_sheet_test reads its letters back",
    "engine/assemble": "a step of compilation: simd_program_test compares its programs with the reference",
    "engine/curve_rows": "a form of curves: compiled_curve_test runs all its tests with both",
    "engine/curve_segments": "a form of curves: compiled_curve_test runs all its tests with both",
    "engine/machine_registers": "registers of machine code: machine_code_test compares the bits of all operations",
    "engine/select": "a step of compilation: simd_program_test compares its programs with the reference",
    "formula/glsl_expressions": "a part of the parser: glsl_test gives it shaders",
    "formula/glsl_statements": "a part of the parser: glsl_test gives it shaders",
    "engine/simd_kernels": "compiled once for each instruction set: simd_program_test and probe_block_test compare every kernel",
    "engine/vector_code": "writes machine code: machine_code_test and simd_program_test compare its bits with the interpreter's",
    "picture/jpeg_metadata": "segments of JPEG files: jpeg_writer_test compares whole files with those of OpenImageIO",
}
DECLARED = re.compile(r"\bTONEWRIGHT_API\s+(?!__attribute__)([^;{]*?)\b(operator\W+|\w+)\s*\(", re.S)
CLASS = re.compile(r"^\s*(?:class|struct|enum)\b")


def code_of(text):
    """C++ without comments and strings, which may name a function that no one calls."""
    text = re.sub(r'R"(\w*)\(.*?\)\1"', '""', text, flags=re.S)
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:[^"\\\n]|\\.)*"', " ", text, flags=re.S)


def exported_functions(folder):
    """(name, header) of each function of the public headers, once. Signs (operator+) are used, not named."""
    found = {}
    for header in sorted(folder.glob("*.h")):
        for line in re.split(r"(?=\bTONEWRIGHT_API\b)", re.sub(r"^\s*#.*$", "", code_of(header.read_text()), flags=re.M))[1:]:
            declaration = line.split(";")[0]
            if CLASS.match(declaration.removeprefix("TONEWRIGHT_API")) or not (match := DECLARED.match(declaration)):
                continue
            if not match[2].startswith("operator"):
                found.setdefault(match[2], header.name)
    return found


def without_test_file(root):
    for path in sorted((root / "src").rglob("*.cpp")):
        name = path.relative_to(root / "src").with_suffix("").as_posix()
        lines = path.read_text().count("\n")
        if lines <= LONG or name in FILES or any(name.startswith(f"{folder}/") for folder in FOLDERS):
            continue
        test = f"tests/unit/{name}_test.cpp"
        if not (root / test).exists():
            yield f"src/{name}.cpp has {lines} lines and no {test}"


def main(root: pathlib.Path) -> int:
    functions = exported_functions(root / "src" / "include" / "tonewright")
    words = set()
    for folder in ("unit", "laws"):
        for test in (root / "tests" / folder).rglob("*.cpp"):
            words |= set(re.findall(r"\w+", code_of(test.read_text())))
    failures = [f"{header}: no C++ test names {name}()" for name, header in functions.items() if name not in words]
    failures += without_test_file(root)
    # A row of a file that is gone or short by now excuses nothing.
    failures += [f"rooms.py: src/{name}.cpp needs no exception" for name in FILES
                 if not (path := root / "src" / f"{name}.cpp").exists() or path.read_text().count("\n") <= LONG]
    if len(functions) < 150:
        failures.append(f"only {len(functions)} exported functions are found")
    for failure in failures:
        print(failure)
    print(f"rooms: {len(functions)} exported functions")
    print(f"{int(not failures)} passed, {len(failures)} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
