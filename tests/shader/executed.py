# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests that execute shaders: colors, what the operators show of them, and the comparison."""
import csv
import fcntl
import json
import pathlib
import subprocess

import numpy as np
from pictures import ALL as IS_FULL
from pictures import skip

# npm packages: Dawn for Node, a translator of SPIR-V, three.js, what drives a browser, and tone mappers in GLSL and JavaScript.
PACKAGES = ["webgpu@0.6.2", "naga-wasm@30.1.0", "three@0.187.0", "playwright-core@1.65.1", "glsl-tone-map@2.2.0",
            "hdrify@1.2.1"]


def npm_modules(tonewright: str, name: str = "npm-shaders", packages: list = PACKAGES) -> pathlib.Path:
    """Installs the packages (60 MB, these) into a folder of the build, unless they are there; returns their folder."""
    folder = pathlib.Path(tonewright).resolve().parent.parent / name
    wanted = folder / "packages.txt"
    folder.mkdir(exist_ok=True)
    with open(folder / "lock", "w") as lock:  # tests run at the same time
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not wanted.is_file() or wanted.read_text().split() != packages:
            options = ["--no-audit", "--no-fund", "--ignore-scripts", "--fetch-retries=1", "--fetch-retry-mintimeout=1000"]
            done = subprocess.run(["npm", "install", "--prefix", str(folder), *options, *packages], capture_output=True,
                                  text=True, check=False)
            if done.returncode:
                reason = (done.stderr.strip().splitlines() or ["no reason"])[0]
                skip(f"npm cannot install {' '.join(packages)} ({reason})")
            wanted.write_text("\n".join(packages))
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


def pick(rows: list, count: int) -> list:
    """That many of them, evenly."""
    return [rows[i * len(rows) // count] for i in range(count)]


class Comparison:
    """Of what implementations of shaders show with what the double reference does."""

    def __init__(self, report, tonewright: pathlib.Path, shaders: pathlib.Path):
        """shaders: the folder that `tonewright shader --all FOLDER --display srgb` wrote."""
        self.check, self.tonewright = report.check, tonewright
        self.rows = {}  # language -> rows of the manifest, of a dozen operators unless in full
        for row in csv.DictReader(open(shaders / "MANIFEST.csv")):
            self.rows.setdefault(row["path"].split("/")[0], []).append(row)
        names = [row["operator"] for row in self.rows["dctl"]]  # DCTL holds no grids
        dozen = pick(names, 11) + ["agx_blender"]
        if not IS_FULL:
            self.rows = {key: [row for row in rows if row["operator"] in dozen] for key, rows in self.rows.items()}
        self.rgb = colors()
        # Ten operators have to be right for a million hostile colors as well; in the quick run, a dozen for fewer.
        self.hostile = pick(names, 10) if IS_FULL else dozen
        self.all_rgb = np.concatenate([self.rgb, hostile_colors(1_000_000 if IS_FULL else 3_000)])
        self.truth = {}
        self.failures = {}  # language -> texts
        self.recorded = {}  # language -> function -> largest error

    def colors_of(self, row: dict) -> np.ndarray:
        """The colors for the function of this row."""
        return self.all_rgb if row["operator"] in self.hostile else self.rgb

    def expected(self, operator: str, rgb: np.ndarray) -> np.ndarray:
        if operator not in self.truth:
            self.truth[operator] = reference(self.tonewright, operator, rgb)
        return self.truth[operator]

    def add(self, language: str, what: str, row: dict, got: np.ndarray, is_as_written: bool) -> None:
        """got: of colors_of(row). is_as_written: no compiler may have rearranged operations; the guaranteed bound then
        has to hold."""
        what = f"{row['operator']} by {what}"
        known, failures = self.recorded.setdefault(language, {}), self.failures.setdefault(language, [])
        rgb = self.colors_of(row)
        got = got.astype(float)
        if not np.isfinite(got).all():
            failures.append(f"{what}: not finite for {rgb[~np.isfinite(got).all(axis=1)][0]}")
            return
        error_of = np.abs(got - self.expected(row["operator"], rgb))
        known[row["function"]] = max(error_of[:len(self.rgb)].max(), known.get(row["function"], 0))
        # The estimate of the text: Vulkan's errors. Twice, because it is computed over probe colors. Where first order
        # says nothing: what float is enough for. Hostile colors, whose channels cancel, may be a code of 10 bits off:
        # nobody sees such a speckle.
        bound = 2 * float(row["vulkan_estimate"])
        bound = np.full(len(rgb), bound if np.isfinite(bound) else 2e-6)
        bound[len(self.rgb):] = np.maximum(bound[len(self.rgb):], 1 / 1023)
        far = ~(error_of.max(axis=1) <= bound)
        if far.any():
            failures.append(f"{what}: {error_of[far].max():.2g} off at {rgb[far][0]}; expected at most "
                            f"{bound[far][0]:.2g} ({far.sum()} colors)")
        # 1e-8: what the series of 1 - 2^x may be off.
        bounded = error_of[((rgb >= 0) & (rgb <= 65504)).all(axis=1)].max()
        if is_as_written and not bounded <= float(row["guaranteed"]) + 1e-8:
            failures.append(f"{what}: {bounded:.2g} off; guaranteed are {row['guaranteed']}")

    def finish(self, implementations: str, errors_file: pathlib.Path) -> None:
        """A check for each language. errors_file: where the largest errors go, or None."""
        for language, errors in self.recorded.items():
            within = sum(error <= 2e-6 for error in errors.values())
            worst = max(errors, key=errors.get, default="none")
            self.check(f"{language}: {len(errors)} functions, {within} within 2e-6, worst {errors.get(worst, np.inf):.2g} ({worst}); "
                       f"{implementations}", not self.failures[language], "\n     ".join(self.failures[language]))
        if errors_file:
            known = json.loads(errors_file.read_text()) if errors_file.exists() else {}
            errors_file.write_text(json.dumps(known | self.recorded, indent=1))


def bound_in_application(operator: str) -> float:
    """Largest error of code values in a file for an application. Nodes in half floats are 2^-12 off, which a power of 2.4
    and sRGB's curve enlarge a little; PQ curves need more than 32 bits; others are within 4.2e-5 on llvmpipe (docs/shaders.md,
    "Errors")."""
    return {"agx_blender": 1.2 * 2**-12, "gt7": 3.5e-3}.get(operator, 4.2e-5)


def reference(tonewright: str, operator: str, rgb: np.ndarray, *options: str) -> np.ndarray:
    """The answer of `tonewright eval`."""
    text = "\n".join(" ".join(map(repr, row)) for row in rgb.astype(float).tolist()) + "\n"
    lines = subprocess.run([tonewright, "eval", operator, "--digits", "12", *options], input=text, check=True,
                           capture_output=True, text=True).stdout
    return np.array(lines.split(), float).reshape(-1, 3)
