# SPDX-License-Identifier: Apache-2.0
"""Runs WGSL and HLSL on Dawn and SwiftShader, without a browser. HLSL goes through SPIR-V."""
import json
import os
import pathlib
import shutil
import subprocess

from executed import npm_modules, skip

RUNNER = pathlib.Path(__file__).parent.parent.parent / "src/shader_runs/run_on_dawn.mjs"  # of `verify`
SWIFTSHADER = pathlib.Path("/usr/lib/chromium/vk_swiftshader_icd.json")


class Dawn:
    """Of the packages in the build folder. Skips the test where something is missing."""

    def __init__(self, tonewright: str):
        for program, package in (("node", "nodejs"), ("npm", "npm"), ("glslangValidator", "glslang-tools"),
                                 ("spirv-val", "spirv-tools")):
            if not shutil.which(program):
                skip(f"{program} is missing (Debian: {package})")
        if not SWIFTSHADER.is_file():
            skip("SwiftShader is missing (Debian: chromium-common)")
        self.modules = npm_modules(tonewright)

    def run(self, steps: list) -> str:
        """Steps of run_on_dawn.mjs; returns what ran them."""
        lines = "".join(json.dumps(step) + "\n" for step in steps)
        done = subprocess.run(["node", str(RUNNER), str(self.modules)], input=lines, capture_output=True, text=True,
                              env=os.environ | {"VK_ICD_FILENAMES": str(SWIFTSHADER)}, check=False)
        if done.returncode:
            raise SystemExit(f"run_on_dawn.mjs: status {done.returncode}: {done.stderr.strip()}")
        return done.stdout.splitlines()[0]


def spirv_of(hlsl: pathlib.Path, stage: str, entry: str, *options: str) -> pathlib.Path:
    """The file of SPIR-V, validated."""
    spirv = hlsl.with_suffix(f".{stage}.spv")
    subprocess.run(["glslangValidator", "-D", "-V", "--quiet", "--auto-map-bindings", "-S", stage, "-e", entry, *options,
                    str(hlsl), "-o", str(spirv)], check=True)
    subprocess.run(["spirv-val", "--target-env", "vulkan1.0", str(spirv)], check=True)
    return spirv
