# SPDX-License-Identifier: Apache-2.0
"""The option of test_abi.py."""

from pathlib import Path

from pictures import PROJECT


def pytest_addoption(parser):
    parser.getgroup("tonewright").addoption("--libraries", type=Path, metavar="FOLDER", default=PROJECT / "build/release/lib",
                                            help="folder of the libraries (default: build/release/lib)")
