# SPDX-License-Identifier: Apache-2.0
"""How many instructions the engine takes for a pixel, counted by callgrind: a number that no other load changes.

    python3 -m pytest tests/bench/test_instructions.py [--program build/release/bin/tonewright_instructions] [--record]

Fails where an operator takes 1.2 times as many as instructions.csv says: compilers differ by a few per cent, and a
step that was lost costs more. Fewer are welcome: `--record` writes the new numbers.
"""

import csv
import re
import subprocess
from pathlib import Path

from pictures import SKIPPED, need_program, skip

TABLE = Path(__file__).with_name("instructions.csv")
PIXELS = 4096
SLACK = 1.2


def count(program, operators, scratch):
    """{operator: instructions of a pixel}, of the calls of the engine alone, one dump after each."""
    done = subprocess.run(
        ["valgrind", "--tool=callgrind", f"--callgrind-out-file={scratch / 'calls'}", "--toggle-collect=counted_run",
         "--dump-after=counted_run", program, str(PIXELS), *operators], capture_output=True, text=True, check=False)
    if done.returncode == SKIPPED:
        skip(done.stdout.strip().removeprefix("skipped: "))
    if "Unrecognised instruction" in done.stderr:
        # Highway reads a clock with RDTSCP, which valgrind 3.19 offers on processors that lack it, too.
        place = re.search(r"Unrecognised instruction.*\n.* at \S+: (.*)", done.stderr)[1]
        skip(f"valgrind does not run an instruction of {place} on this processor")
    assert done.returncode == 0, done.stderr
    totals = [int(re.search(r"^(?:totals|summary): (\d+)", dump.read_text(), re.MULTILINE)[1])
              for dump in sorted(scratch.glob("calls.*"), key=lambda p: int(p.suffix[1:]))]
    assert len(totals) >= len(operators) and min(totals[:len(operators)]) >= PIXELS, \
        f"callgrind counted {totals} for {len(operators)} calls"
    return {name: total / PIXELS for name, total in zip(operators, totals)}
def test_instructions(request, report, scratch):
    need_program("valgrind", "valgrind")
    with open(TABLE, newline="") as table:
        recorded = {row["operator"]: float(row["instructions_per_pixel"]) for row in csv.DictReader(table)}
    counted = count(request.config.getoption("--program"), list(recorded), scratch)
    if request.config.getoption("--record"):
        lines = ["operator,instructions_per_pixel", *(f"{name},{n:.1f}" for name, n in counted.items())]
        TABLE.write_text("\n".join(lines) + "\n")
        recorded = counted
    for name, n in counted.items():
        report.check(f"{name:20s} {n:8.1f} instructions a pixel, {n / recorded[name]:5.2f} of the recorded {recorded[name]:.1f}, "
                     f"at most {SLACK}", n <= SLACK * recorded[name])
