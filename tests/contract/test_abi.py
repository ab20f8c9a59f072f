# SPDX-License-Identifier: Apache-2.0
"""The libraries export what the last release exported: abidiff compares them with the baseline in tests/contract/abi/.

    python3 -m pytest tests/contract/test_abi.py --libraries build/release/lib [--record]

Only names of the public headers count. Files without debug information have symbols alone, with their mangled types: a
function that is gone or takes other types is found, another layout of a struct is not. New symbols are welcome. --record
writes the baseline of a release.
"""

import platform
import re
import subprocess
import tempfile
from pathlib import Path

import pytest
from pictures import PROJECT, need_program, skip

BASELINE = PROJECT / "tests" / "contract" / "abi"
HEADERS = PROJECT / "src" / "include" / "tonewright"
LIBRARIES = ("core", "ocio", "image")
# Bits of abidiff's exit status: an error, a wrong command line; a change, an incompatible change.
ERRORS, CHANGES = 1 | 2, 4 | 8
# Fewer means that the filter below lost the names.
LEAST_SYMBOLS = {"core": 150, "ocio": 20, "image": 30}


def public_symbols(names):
    """Those of the mangled names whose function, class or variable stands in a public header."""
    headers = "\n".join(path.read_text(encoding="utf-8") for path in sorted(HEADERS.glob("*.h")))
    words = set(re.findall(r"\w+", headers))
    done = subprocess.run(["c++filt"], input="\n".join(names), stdout=subprocess.PIPE, text=True, check=True)
    public = set()
    for name, text in zip(names, done.stdout.splitlines(), strict=True):
        # "vtable for tonewright::v0::Tonemapper", "tonewright::v0::meter(...)"; others only mention the namespace.
        found = re.match(r"(?:(?:vtable|typeinfo|typeinfo name) for )?tonewright::v\d+::(~?\w+)(?:\[abi:\w+\])?(?:::(~?\w+))?", text)
        if found and all(part.lstrip("~") in words for part in found.groups() if part and not part.startswith("operator")):
            public.add(name)
    return public


def record(library, baseline):
    """Writes the baseline of a library."""
    with tempfile.NamedTemporaryFile(suffix=".abi") as file:
        subprocess.run(["abidw", "--no-corpus-path", "--no-comp-dir-path", "--no-show-locs", "--out-file", file.name, library],
                       check=True)
        lines = Path(file.name).read_text(encoding="utf-8").splitlines(keepends=True)
    names = [found[1] for line in lines if (found := re.search(r"<elf-symbol name='([^']+)'", line))]
    public = public_symbols(names)
    kept = [line for line in lines if not (found := re.search(r"<elf-symbol name='([^']+)'", line)) or found[1] in public]
    # Which libraries it loads is the business of the packages.
    text = re.sub(r"  <elf-needed>.*</elf-needed>\n", "", "".join(kept), flags=re.DOTALL)
    baseline.parent.mkdir(exist_ok=True)
    baseline.write_text(text, encoding="utf-8")


@pytest.mark.parametrize("name", LIBRARIES)
def test_symbols(request, report, name):
    for program in ("abidiff", "abidw", "c++filt"):
        need_program(program, "abigail-tools")
    if platform.machine() != "x86_64":
        skip(f"the baseline is of x86_64, not of {platform.machine()}")
    library = request.config.getoption("--libraries") / f"libtonewright_{name}.so"
    baseline = BASELINE / f"libtonewright_{name}.abi"
    if request.config.getoption("--record"):
        record(library, baseline)
    count = baseline.read_text(encoding="utf-8").count("<elf-symbol ")
    done = subprocess.run(["abidiff", "--no-added-syms", baseline, library], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    report.check(f"{name}: {count} symbols of the baseline",
                 not done.returncode & (ERRORS | CHANGES) and count >= LEAST_SYMBOLS[name], done.stdout)
