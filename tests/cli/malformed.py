# SPDX-License-Identifier: Apache-2.0
"""Runs the command on malformed files: each gives one line with its place, and exit 3, in a second and 200 MB.

It imports no NumPy: what a process holds before exec counts as the memory of the program that it becomes.
"""

import os
import re
import subprocess
import tempfile
from pathlib import Path

from sanitizers import is_sanitized

LINES_WITH_CARET = 3  # the message, the line of the file, the caret


def judge(arguments, cases, name, at_least):
    """The exit code of the test.

    arguments(path, target): those of the command, which may write target.
    cases: (what, bytes of the file, words of the message). name: of the file. at_least: so many cases there are.
    """
    wrong, slowest, largest = [], 0.0, 0
    with tempfile.TemporaryDirectory() as folder:
        path, target = Path(folder) / name, Path(folder) / "target.tone"
        for what, text, message in cases:
            path.write_bytes(text)
            process = subprocess.Popen(arguments(path, target), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE)
            out, err = process.stdout.read(), process.stderr.read()
            process.stdout.close()
            process.stderr.close()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            slowest = max(slowest, usage.ru_utime + usage.ru_stime)  # of the processor: others may use it
            largest = max(largest, usage.ru_maxrss)
            lines = err.decode("ascii", "replace").splitlines() or [""]
            is_large = f"read: {path}: it has " in lines[0]
            has_place = re.match(rf"tonewright: {re.escape(str(path))}:\d+:\d+: \S", lines[0])
            # A line that is missing has no caret.
            has_caret = len(lines) == 1 or (len(lines) == LINES_WITH_CARET and set(lines[2]) <= {" ", "^"} and "^" in lines[2])
            ok = (process.returncode == 3 and not out and message in lines[0] and (is_large or (has_place and has_caret))
                  and not target.exists())
            if not ok:
                wrong.append(f"{what}: exit {process.returncode}: expected {message}: {err[:300]}")
    print(f"{len(cases)} files; at most {slowest:.3f} s of the processor, {largest / 1024:.0f} MB")
    print("\n".join(wrong))
    failures = len(wrong) + (len(cases) < at_least)
    if is_sanitized(arguments(path, target)[0]):
        print("skipped: limits of time and memory, sanitizers take more")
    else:
        failures += (slowest > 1) + (largest > 200 * 1024)
    print(f"{len(cases) - len(wrong)} passed, {failures} failed")
    return 1 if failures else 0
