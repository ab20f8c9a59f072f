# SPDX-License-Identifier: Apache-2.0
"""Tone mappers of other programs, executed, against the operators that `tonewright list --engines` names for them.

Light engines in each run; all of them with TONEWRIGHT_TEST_ALL=1. Expected values are those of the programs.

    python3 -m pytest -s tests/engines/test_engines.py -k light --tonewright build/release/bin/tonewright
"""
import json
import pathlib
import subprocess

import numpy as np
import pytest
from engines import ENGINES, Engine, colors, execute, packages_of, tone_mappers_of
from executed import reference
from pictures import PROJECT

# Float compilers of other processors contract and order operations otherwise: twice the recorded difference, and half a unit in
# the last place of a float near 1.
FACTOR, LEAST = 2, 6e-8


def table(command: pathlib.Path) -> dict:
    """The rows by program, version and name."""
    done = subprocess.run([command, "list", "--engines", "--json"], capture_output=True, text=True, check=True)
    return {(row["engine"], row["version"], row["name"]): row for row in json.loads(done.stdout)}


def difference(row: dict, shown: np.ndarray, expected: np.ndarray) -> float:
    if row["compared"].startswith("clamped"):
        shown, expected = np.clip(shown, 0, 1), np.clip(expected, 0, 1)
    if "NaN" in row["note"]:  # at black, which the operator maps to black
        shown = np.where(np.isnan(shown) & (expected == 0), 0, shown)
    return float(np.abs(shown - expected).max())


def operator_of(command: pathlib.Path, row: dict, settings, rgb: np.ndarray) -> str:
    """The row's operator, with what the program measures in the picture."""
    text = row["operator"]
    if settings is None:
        return text
    text += "".join(f":{name}={value!r}" for name, value in settings(row["name"], rgb).items())
    if row["operator"].startswith("opencv_"):  # it stretches its result, too, which is here without the stretch
        result = reference(command, f"{text}:output_minimum=0:output_maximum=1", rgb, "--display", "linear")
        text += f":output_minimum={max(result.min(), 0)!r}:output_maximum={result.max()!r}"
    return text


def compare(report, command: pathlib.Path, engines: list[Engine]) -> None:
    packages = packages_of(engines, command.parents[1] / "npm-engines")
    mappers = {(engine.program, engine.version, name): mapper
               for engine in engines for name, mapper in tone_mappers_of(engine, packages).items()}
    settings = {(engine.program, engine.version): engine.settings for engine in engines}
    rgb = colors()
    rows = table(command)
    for key, shown in execute(mappers, rgb).items():
        what = ", ".join(key)
        if not (row := rows.get(key)):
            report.check(f"{what}: the table has a row", False, "no such row")
            continue
        expected = reference(command, operator_of(command, row, settings.get(key[:2]), rgb), rgb, "--display", row["display"])
        found = difference(row, shown.astype(float), expected)
        report.check(f"{what}: {row['operator']} {found:.2g} ({row['verdict']}, {row['difference']:.2g} recorded)",
                     found <= FACTOR * row["difference"] + LEAST and row["difference"] <= FACTOR * found + LEAST)


def test_light(report, command):
    compare(report, command, [engine for engine in ENGINES if engine.is_light])


@pytest.mark.full
def test_heavy(report, command):
    compare(report, command, [engine for engine in ENGINES if not engine.is_light])


def test_rows_are_executed(report, command):
    """Each row whose package the tests can load has an engine here."""
    executed = {(engine.program, engine.version) for engine in ENGINES}
    for (program, version, name), row in table(command).items():
        if row["package"] and row["operator"]:
            report.check(f"{program} {version}, {name}", (program, version) in executed)


def test_page(request, report, command):
    """The tables of docs/engines.md are those of the command."""
    tables = subprocess.run([command, "list", "--engines", "--markdown"], capture_output=True, text=True, check=True).stdout
    page = PROJECT / "docs/engines.md"
    written, mark, generated = page.read_text().partition("--record -->\n\n")
    if request.config.getoption("--record"):
        page.write_text(written + mark + tables)
        generated = tables
    report.check("docs/engines.md has the tables of `list --engines --markdown`", generated == tables,
                 "write them with --record")
    rows = table(command).values()
    programs = len({row["engine"] for row in rows})
    report.check("docs/engines.md states the number of programs", f"the tone mappers of {programs} programs" in written, str(programs))
