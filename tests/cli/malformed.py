# SPDX-License-Identifier: Apache-2.0
"""Runs the command on malformed files: each gives one line with its place, and exit 3, in a second and 200 MB.

The memory includes this process's own: what it holds before exec counts as that of the program that it becomes.
"""

import os
import re
import subprocess

from sanitizers import is_sanitized

LINES_WITH_CARET = 3  # the message, the line of the file, the caret


def judge(report, arguments, folder, cases, name, at_least):
    """Checks all cases.

    arguments(path, target): those of the command, which may write target.
    cases: (what, bytes of the file, words of the message). name: of the file. at_least: so many cases there are.
    """
    slowest, largest = 0.0, 0
    path, target = folder / name, folder / "target.tone"
    for what, text, message in cases:
        path.write_bytes(text)
        process = subprocess.Popen(arguments(path, target), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
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
        report.check(what, process.returncode == 3 and not out and message in lines[0] and (is_large or (has_place and has_caret))
                     and not target.exists(), f"exit {process.returncode}: expected {message}: {err[:300]}")
    report.check(f"{len(cases)} files", len(cases) >= at_least)
    if is_sanitized(arguments(path, target)[0]):
        print("skipped: limits of time and memory, sanitizers take more")
        return
    report.bound("the slowest, seconds of the processor", slowest, 1)
    report.bound("the largest, MB", largest / 1024, 200)
