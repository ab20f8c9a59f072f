# SPDX-License-Identifier: Apache-2.0
"""The option of test_tags.py."""

from pathlib import Path


def pytest_addoption(parser):
    parser.getgroup("tonewright").addoption("--table", type=Path, metavar="FILE", help="write the table of tags as Markdown")
