# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests that execute shaders: colors, what the operators show of them, and the comparison."""
import csv
import json
import os
import pathlib
import subprocess
import sys

import numpy as np

IS_FULL = os.environ.get("TONEWRIGHT_TEST_ALL") == "1"
SKIPPED = 77  # exit status that ctest counts as skipped
# npm packages: Dawn for Node, a translator of SPIR-V, three.js, and what drives a browser.
PACKAGES = ["webgpu@0.6.2", "naga-wasm@30.1.0", "three@0.187.0", "playwright-core@1.65.1"]


def skip(reason: str):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def npm_modules(tonewright: str) -> pathlib.Path:
    """Their folder in the build folder. `./run test --all` installs them, 60 MB; else they are there or not."""
    folder = pathlib.Path(tonewright).resolve().parent.parent / "npm-shaders"
    wanted = folder / "packages.txt"
    if not wanted.is_file() or wanted.read_text().split() != PACKAGES:
        if not IS_FULL:
            skip("packages of npm are missing; `./run test --all` installs them")
        folder.mkdir(exist_ok=True)
        done = subprocess.run(["npm", "install", "--prefix", str(folder), "--no-audit", "--no-fund", *PACKAGES],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            skip(f"npm cannot install {' '.join(PACKAGES)} ({(done.stderr.strip().splitlines() or ['no reason'])[-1]})")
        wanted.write_text("\n".join(PACKAGES))
    return folder / "node_modules"


def colors() -> np.ndarray:
    """Grays, saturated colors, negatives, and numbers that break shaders; no NaN."""
    rng = np.random.default_rng(5)
    gray = 0.18 * 2.0 ** np.linspace(-12, 12, 200)
    light = 2.0 ** rng.uniform(-16, 12, (1500, 3))
    light[::7, 0] = 0
    signed = 2.0 ** rng.uniform(-10, 10, (300, 3)) * rng.choice([-1, 1], (300, 3))
    hostile = np.array(np.meshgrid(*[[0, -1e-45, 1e-38, 1e-10, 1, 65504, 1e30, np.inf, -np.inf, -0.2]] * 3)).reshape(3, -1).T
    return np.concatenate([np.repeat(gray[:, None], 3, 1), light, signed, hostile]).astype(np.float32)


def hostile_colors(count: int) -> np.ndarray:
    """Numbers of all sizes that a float has, and the first ones of all combinations of special ones."""
    rng = np.random.default_rng(6)
    special = np.array([0, -0.0, 1e-45, -1e-40, 1e-38, 65504, -65504, 1e30, -1e30, np.inf, -np.inf, 0.18, 1])
    first = np.array(np.meshgrid(*[special] * 3)).reshape(3, -1).T
    rest = 2.0 ** rng.uniform(-149, 127, (count - len(first), 3)) * rng.choice([-1, 1], (count - len(first), 3))
    return np.concatenate([first, rest]).astype(np.float32)


def write_shaders(tonewright: str, folder: pathlib.Path) -> dict:
    """All shaders in all languages, code values of sRGB; language -> rows of the manifest, a dozen unless in full."""
    subprocess.run([tonewright, "shader", "--all", str(folder), "--display", "srgb", "-q"], check=True)
    rows = {}
    for row in csv.DictReader(open(folder / "MANIFEST.csv")):
        rows.setdefault(row["path"].split("/")[0], []).append(row)
    return rows if IS_FULL else {language: some[3::8] for language, some in rows.items()}


class Comparison:
    """Of what implementations of shaders show with what the double reference does."""

    def __init__(self, tonewright: str):
        self.tonewright = tonewright
        self.rgb = colors()
        self.truth = {}
        self.failures = []
        self.recorded = {}  # language -> function -> largest error

    def expected(self, operator: str) -> np.ndarray:
        if operator not in self.truth:
            text = "\n".join(" ".join(repr(float(x)) for x in row) for row in self.rgb) + "\n"
            lines = subprocess.run([self.tonewright, "eval", operator, "--digits", "12"], input=text, check=True,
                                   capture_output=True, text=True).stdout
            self.truth[operator] = np.array([line.split() for line in lines.splitlines()], float)
        return self.truth[operator]

    def add(self, language: str, what: str, row: dict, got: np.ndarray, is_as_written: bool) -> None:
        """is_as_written: no compiler may have rearranged operations; the guaranteed bound then has to hold."""
        what = f"{row['operator']} by {what}"
        got = got.astype(float)
        if not np.isfinite(got).all():
            self.failures.append(f"{what}: not finite for {self.rgb[~np.isfinite(got).all(axis=1)][0]}")
            return
        error_of = np.abs(got - self.expected(row["operator"]))
        error = error_of.max()
        known = self.recorded.setdefault(language, {})
        known[row["function"]] = max(error, known.get(row["function"], 0))
        # The estimate of the text: Vulkan's errors. Twice, because it is computed over probe colors. Where first order
        # says nothing: what float is enough for.
        bound = 2 * float(row["vulkan_estimate"])
        if not error <= (bound if np.isfinite(bound) else 2e-6):
            at = self.rgb[np.unravel_index(error_of.argmax(), error_of.shape)[0]]
            self.failures.append(f"{what}: {error:.2g} off at {at}; expected at most {bound:.2g}")
        # 1e-8: what the series of 1 - 2^x may be off.
        bounded = error_of[((self.rgb >= 0) & (self.rgb <= 65504)).all(axis=1)].max()
        if is_as_written and not bounded <= float(row["guaranteed"]) + 1e-8:
            self.failures.append(f"{what}: {bounded:.2g} off; guaranteed are {row['guaranteed']}")

    def report(self, implementations: str, record_file: str) -> int:
        for language, errors in self.recorded.items():
            within = sum(error <= 2e-6 for error in errors.values())
            worst = max(errors, key=errors.get)
            print(f"{language}: {len(errors)} functions, {within} within 2e-6, worst {errors[worst]:.2g} ({worst}); "
                  f"{implementations}")
        if record_file:
            path = pathlib.Path(record_file)
            known = json.loads(path.read_text()) if path.exists() else {}
            path.write_text(json.dumps(known | self.recorded, indent=1))
        for failure in self.failures:
            print(failure)
        return 1 if self.failures else 0


def start(main) -> None:
    """main(tonewright, record_file), with the arguments of the command line."""
    sys.exit(main(sys.argv[1], sys.argv[3] if sys.argv[2:3] == ["--record"] else ""))
