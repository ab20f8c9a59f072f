# SPDX-License-Identifier: Apache-2.0
"""Prints which tests were skipped and why, from the file that `ctest --output-junit` writes.

    python3 tests/skipped.py build/release/tests.xml

A test is skipped as a whole, or some of its checks are: those print a line that begins with `skipped:`.
"""

import re
import sys
from xml.etree import ElementTree

GTEST = re.compile(r"^.*: Skipped\n(.*)$", re.M)


def reasons(output):
    """The reasons in a test's output, each once and in order."""
    lines = re.findall(r"^\s*skipped: (.*)$", output, re.M) + [line.strip() for line in GTEST.findall(output)]
    return list(dict.fromkeys(lines))


def main(path):
    tests = ElementTree.parse(path).getroot().findall("testcase")
    whole, parts = [], []
    for test in tests:
        found = reasons(test.findtext("system-out") or "")
        if test.find("skipped") is not None:
            whole.append((test.get("name"), found[:1] or ["no reason given"]))
        elif found:
            parts.append((test.get("name"), found))
    for heading, entries in (("skipped", whole), ("passed without some of their checks", parts)):
        if entries:
            print(f"\n{len(entries)} of {len(tests)} tests were {heading}:" if entries is whole else
                  f"\n{len(entries)} of {len(tests)} tests {heading}:")
        for name, found in entries:
            for reason in found:
                print(f"  {name}: {reason}")


if __name__ == "__main__":
    main(sys.argv[1])
