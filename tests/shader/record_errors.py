#!/usr/bin/env python3
"""Writes src/shader/measured_errors.inc: the largest errors of all shaders at their defaults, by implementation.

Run it when operators, the printer of shaders or a test of them change; a unit test says when a definition is missing.

Usage: record_errors.py TONEWRIGHT
"""
import csv
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
TABLE = HERE.parent.parent / "src/shader/measured_errors.inc"
# Tests that execute shaders, and what their implementations are called.
TESTS = {
    "test_wgsl_and_hlsl.py": {"wgsl": "WGSL (SwiftShader)", "hlsl": "HLSL (SwiftShader)"},
    "test_in_chromium.py": {"glsl-es": "GLSL ES (Chromium)", "wgsl (Chromium)": "WGSL (Chromium)"},
    "test_c_and_dctl.py": {"dctl": "DCTL (pocl)", "c": "C (GCC, Clang)"},
}


def main(tonewright: str) -> int:
    names = ["GLSL (llvmpipe)"]
    with tempfile.TemporaryDirectory() as folder_name:
        folder = pathlib.Path(folder_name)
        shaders = folder / "all"
        subprocess.run([tonewright, "shader", "--all", str(shaders), "--display", "srgb", "-q"], check=True)
        hashes, functions = {}, {}
        for row in csv.DictReader(open(shaders / "MANIFEST.csv")):
            text = (shaders / row["path"]).read_text()
            hashes[row["function"]] = re.search(r"definition (\w+)", text)[1]
            functions[row["operator"]] = row["function"]
        errors = {name: {} for name in names}
        verified = json.loads(subprocess.run([tonewright, "verify", "--quick", "--best-target", "--shaders", "glsl", "--json"],
                                             check=True, capture_output=True, text=True).stdout)
        for row in verified["rows"]:
            if row["backend"] == "glsl":
                errors[names[0]][functions[row["operator"].replace(" look=", ":look=")]] = row["max_all"]
        for test, implementations in TESTS.items():
            subprocess.run([sys.executable, "-m", "pytest", "-c", str(HERE.parent / "pytest.ini"), str(HERE / test),
                            "--tonewright", tonewright, "--shaders", str(shaders), "--errors", str(folder / "errors.json")],
                           check=True, env=os.environ | {"TONEWRIGHT_TEST_ALL": "1"})
            recorded = json.loads((folder / "errors.json").read_text())
            for key, name in implementations.items():
                names.append(name)
                errors[name] = recorded[key]
    lines = ["// Written by tests/shader/record_errors.py. Definition of the view on sRGB -> largest error of its code",
             "// values; below 0: not executed.",
             "constexpr std::array kImplementations = {" + ", ".join(f'"{name}"' for name in names) + "};",
             "constexpr MeasuredErrors kMeasured[] = {"]
    for function, definition in sorted(hashes.items()):
        values = ", ".join(f"{errors[name].get(function, -1):.2g}" for name in names)
        lines.append(f'    {{"{definition}", {{{values}}}}},  // {function}')
    TABLE.write_text("\n".join(lines + ["};"]) + "\n")
    print(f"{TABLE}: {len(hashes)} functions, {len(names)} implementations")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
