#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares tone mappers of the newest releases of npm packages with the pinned ones, which tests/engines/ compares with our operators.

Prints a line for each tone mapper that changed, with the largest difference over 242 colors, and for each package whose source
moved. Exit status 1 if there is one.

Usage: releases.py FOLDER
"""
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "shader"), str(HERE.parent / "parity/clients"), str(HERE.parents[1] / "python_check")]

import numpy as np  # noqa: E402
from engines import ENGINES, colors, execute, fetch, tone_mappers_of  # noqa: E402

# Both releases run on one machine with one compiler, so that the same operations give the same numbers.
SAME = 1e-7


def name_of(package: str) -> str:
    return package[:package.rindex("@")]


def newest_of(engines: list) -> list:
    """An engine for each package, without its older versions."""
    return list({name_of(engine.packages[0]): engine for engine in reversed(engines) if engine.packages}.values())[::-1]


def main(folder: pathlib.Path) -> int:
    changes = 0
    mappers = {}
    for engine in newest_of(ENGINES):
        # The newest of the program's own package; what it stands on stays.
        latest = f"{name_of(engine.packages[0])}@latest"
        try:
            packages = {package: fetch(package, folder) for package in engine.packages}
            packages[latest] = fetch(latest, folder / "latest")
        except RuntimeError as error:
            print(f"{engine.title}: npm cannot load it ({error})")
            changes += 1
            continue
        version = json.loads((packages[latest] / "package.json").read_text())["version"]
        is_new = version != engine.packages[0].rsplit("@", 1)[1]
        print(f"{engine.title}: {engine.packages[0]}, newest {version}", flush=True)
        if not is_new:
            continue
        mappers |= {(engine.title, name, "pinned"): mapper for name, mapper in tone_mappers_of(engine, packages).items()}
        try:
            newest = engine.tone_mappers(packages[latest], *(packages[package] for package in engine.packages[1:]))
        except (LookupError, OSError, ValueError, StopIteration, TypeError) as error:
            print(f"changed: {engine.title} {version}: its source moved ({error})")
            changes += 1
            continue
        mappers |= {(engine.title, name, version): mapper for name, mapper in newest.items()}
    shown = execute(mappers, colors()) if mappers else {}
    for (title, name, version), values in shown.items():
        if version == "pinned":
            continue
        pinned = shown[title, name, "pinned"]
        same_nan = np.isnan(values) == np.isnan(pinned)
        difference = np.nanmax(np.abs(values.astype(float) - pinned)) if same_nan.all() else np.inf
        if difference > SAME:
            print(f"changed: {title} {name} in {version}: {difference:.2g}")
            changes += 1
    print(f"{len(shown) // 2} tone mappers of newer releases compared, {changes} changes")
    return 1 if changes else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(pathlib.Path(sys.argv[1])))
