# SPDX-License-Identifier: Apache-2.0
"""The promises of a release: names in the configs stay, and no operator's numbers change without a line in CHANGELOG.md.

    python3 -m pytest tests/contract/test_contract.py --tonewright build/release/bin/tonewright [--record]

names.txt has every name of the committed config that a project file or a script may hold; parity.profiles compares the names of its
other versions. numbers.csv has the colors that every
operator shows, with its presets and looks. --record writes both anew, after the change has its line in CHANGELOG.md.
"""

import json
from pathlib import Path

import pytest
from pictures import PROJECT, run

ocio = pytest.importorskip("PyOpenColorIO", reason="PyOpenColorIO is missing (Debian: python3-opencolorio)")

HERE = Path(__file__).resolve().parent
NAMES = HERE / "names.txt"
NUMBERS = HERE / "numbers.csv"
CHANGELOG = "expected a line in CHANGELOG.md, then `python3 -m pytest -c tests/pytest.ini tests/contract/test_contract.py --record`"
# Black, mid gray, white, above white, and saturated colors dark and bright, one with a negative channel.
COLORS = ((0, 0, 0), (0.18, 0.18, 0.18), (1, 1, 1), (20, 20, 20), (0.8, 0.1, 0.05), (0.02, 0.3, 0.04), (0.01, 0.02, 6), (40, 2, 30),
          (-0.1, 0.4, 0.9))
# numbers.csv has 9 decimals of values up to about 1; two processors' logarithms and powers differ in the sixteenth digit.
NUMBERS_BOUND = 2e-9


def all_names():
    """{"view sRGB: AgX"}"""
    config = ocio.Config.CreateFromFile(str(PROJECT / "ocio_config" / "config.ocio"))
    names = {f"role {name}" for name, _ in config.getRoles()}
    names |= {f"look {name}" for name in config.getLookNames()}
    names |= {f"view transform {name}" for name in config.getViewTransformNames()}
    for display in config.getDisplays():
        names |= {f"display {display}"} | {f"view {display}: {view}" for view in config.getViews(display)}
    everything = (ocio.SearchReferenceSpaceType.SEARCH_REFERENCE_SPACE_ALL, ocio.ColorSpaceVisibility.COLORSPACE_ALL)
    for space in config.getColorSpaceNames(*everything):
        names |= {f"space {space}"} | {f"alias {alias}" for alias in config.getColorSpace(space).getAliases()}
    return names


def operators(command):
    """`id`, `id:preset` and `id:look=name` of every operator; local ones need a picture."""
    for op in json.loads(run(command, "list", "--json"))["operators"]:
        if op["is_local"] or op["id"] == "camera_response":  # which needs a file
            continue
        yield op["id"]
        for preset in op["presets"]:
            yield f"{op['id']}:{preset['id']}"
        for look in op["looks"]:
            yield f"{op['id']}:look={look['id']}"


def all_numbers(command):
    """{operator: its colors as sRGB code values}."""
    colors = "".join("{} {} {}\n".format(*color) for color in COLORS)
    return {name: [float(x) for x in run(command, "eval", name, "--display", "srgb", stdin=colors).split()]
            for name in operators(command)}


def test_names(request, report):
    names = all_names()
    if request.config.getoption("--record"):
        NAMES.write_text("".join(f"{name}\n" for name in sorted(names)))
    promised = set(NAMES.read_text().splitlines())
    report.check(f"{len(promised)} names are there", promised <= names, f"gone: {sorted(promised - names)}; files that name it break")
    report.check("no name is new", names <= promised, f"new: {sorted(names - promised)}; {CHANGELOG}")


def test_numbers(request, report, command):
    numbers = all_numbers(command)
    if request.config.getoption("--record"):
        NUMBERS.write_text("".join(f"{name},{','.join(f'{x:.9f}' for x in values)}\n" for name, values in sorted(numbers.items())))
    recorded = dict(line.split(",", 1) for line in NUMBERS.read_text().splitlines())
    report.check(f"{len(recorded)} operators, presets and looks are the same ones", recorded.keys() == numbers.keys(),
                 f"{sorted(recorded.keys() ^ numbers.keys())}; {CHANGELOG}")
    changed = {}
    for name, values in recorded.items():
        difference = max(abs(a - b) for a, b in zip(map(float, values.split(",")), numbers.get(name, []), strict=True))
        if not difference <= NUMBERS_BOUND:
            changed[name] = difference
    report.check("their numbers are the same", not changed, f"{changed}; {CHANGELOG}")
