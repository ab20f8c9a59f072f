# SPDX-License-Identifier: Apache-2.0
"""How many instructions the engine takes for a pixel, counted by callgrind: a number that no other load changes.

    python3 tests/bench/test_instructions.py build/release/bin/tonewright_instructions [--record]

Fails where an operator takes 1.2 times as many as instructions.csv says: compilers differ by a few per cent, and a
step that was lost costs more. Fewer are welcome: `--record` writes the new numbers.
"""

import argparse
import csv
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77  # exit status that ctest counts as skipped
TABLE = Path(__file__).with_name("instructions.csv")
PIXELS = 4096
SLACK = 1.2


def count(program, operators):
    """{operator: instructions of a pixel}, of the calls of the engine alone, one dump after each."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "calls"
        done = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", "--toggle-collect=counted_run",
             "--dump-after=counted_run", program, str(PIXELS), *operators], capture_output=True, text=True, check=False)
        if done.returncode == SKIPPED:
            print(done.stdout.strip())
            sys.exit(SKIPPED)
        if "Unrecognised instruction" in done.stderr:
            # Highway reads a clock with RDTSCP, which valgrind 3.19 offers on processors that lack it, too.
            place = re.search(r"Unrecognised instruction.*\n.* at \S+: (.*)", done.stderr)[1]
            print(f"skipped: valgrind does not run an instruction of {place} on this processor")
            sys.exit(SKIPPED)
        if done.returncode:
            sys.exit(done.stderr)
        totals = [int(re.search(r"^(?:totals|summary): (\d+)", dump.read_text(), re.MULTILINE)[1])
                  for dump in sorted(Path(folder).glob("calls.*"), key=lambda p: int(p.suffix[1:]))]
    if len(totals) < len(operators) or min(totals[:len(operators)]) < PIXELS:
        sys.exit(f"callgrind counted {totals} for {len(operators)} calls")
    return {name: total / PIXELS for name, total in zip(operators, totals)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--record", action="store_true", help="write what is counted to instructions.csv")
    arguments = parser.parse_args()
    if not shutil.which("valgrind"):
        print("skipped: valgrind is not installed (Debian: valgrind)")
        return SKIPPED
    with open(TABLE, newline="") as table:
        recorded = {row["operator"]: float(row["instructions_per_pixel"]) for row in csv.DictReader(table)}
    counted = count(arguments.program, list(recorded))
    if arguments.record:
        lines = ["operator,instructions_per_pixel", *(f"{name},{n:.1f}" for name, n in counted.items())]
        TABLE.write_text("\n".join(lines) + "\n")
        return 0
    failed = 0
    for name, n in counted.items():
        ok = n <= SLACK * recorded[name]
        failed += not ok
        print(f"{'ok  ' if ok else 'FAIL'} {name:20s} {n:8.1f} instructions a pixel, {n / recorded[name]:5.2f} of the "
              f"recorded {recorded[name]:.1f}, at most {SLACK}")
    print(f"{len(counted) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
