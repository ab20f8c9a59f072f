#!/usr/bin/env python3
"""Instructions of shaders with curves as formulas and as fitted polynomials, as spirv-opt leaves them.

GLSL goes through glslangValidator -V and spirv-opt -O. A sampled table is a memory access on a GPU, a special
function (a logarithm, a power of 2, a root, a sine) takes four cycles of most GPUs, a power two of them, a quotient one.

Usage: shader_instructions.py TONEWRIGHT [OPERATOR...]
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

OPERATORS = ["agx_sobotka", "agx_minimal", "aces_hill", "uchimura", "hable_piecewise", "lottes", "ue3", "filament_generic",
             "aces_13", "agx_blender:formula", "agx_filament", "spline"]
MAIN = """
layout(location = 0) in vec3 scene;
layout(location = 0) out vec4 shown;
void main() { shown = vec4(FUNCTION(scene), 1.0); }
"""
SPECIAL = {"Log2": 4, "Exp2": 4, "Pow": 9, "Sqrt": 4, "Sin": 4, "Cos": 4, "Atan2": 20}
FREE = {"Constant", "CompositeConstruct", "CompositeExtract", "AccessChain", "Variable", "Label", "Return", "Function",
        "FunctionEnd", "Phi", "SelectionMerge", "LoopMerge", "Store"}


def count(tonewright, operator, curves, folder):
    """(all that computes, special functions, reads of tables, cycles)"""
    text, module = folder / "shader.frag", folder / "shader.spv"
    written = subprocess.run([tonewright, "shader", operator, "--language", "glsl", "--display", "srgb", "--curves", curves],
                             check=True, capture_output=True, text=True).stdout
    function = re.findall(r"^vec3 (\w+)\(vec3 scene\)", written, re.MULTILINE)[0]
    text.write_text("#version 450\n" + written + MAIN.replace("FUNCTION", function))
    subprocess.run(["glslangValidator", "-V", "--quiet", text, "-o", module], check=True)
    subprocess.run(["spirv-opt", "-O", module, "-o", module], check=True)
    lines = subprocess.run(["spirv-dis", "--no-color", "--no-header", module], check=True, capture_output=True, text=True).stdout
    body = lines[lines.index("OpFunction "):].splitlines()
    computing = special = cycles = 0
    reads = -1  # of the color
    for line in body:
        words = line.split("= ")[-1].split()
        operation = words[0].removeprefix("Op") if words else ""
        if operation in FREE or not operation:
            continue
        name = words[3] if operation == "ExtInst" else operation
        computing += 1
        special += name in SPECIAL or name == "FDiv"
        reads += operation == "Load"
        cycles += SPECIAL.get(name, 5 if name == "FDiv" else 1)
    return computing, special, reads, cycles


def main(tonewright, operators):
    print("| operator | formula: instructions | special | cycles | fitted: instructions | special | reads | cycles |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for operator in operators or OPERATORS:
            formula, fitted = (count(tonewright, operator, curves, Path(name)) for curves in ("formula", "fitted"))
            numbers = (formula[0], formula[1], formula[3], *fitted)
            print(f"| `{operator}` | " + " | ".join(map(str, numbers)) + " |")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
