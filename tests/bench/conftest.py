# SPDX-License-Identifier: Apache-2.0
"""The option of test_instructions.py."""

from pathlib import Path

from pictures import PROJECT


def pytest_addoption(parser):
    program = "build/release/bin/tonewright_instructions"
    parser.getgroup("tonewright").addoption("--program", type=Path, metavar="FILE", default=PROJECT / program,
                                            help=f"the program that runs operators (default: {program})")
