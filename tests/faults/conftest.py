# SPDX-License-Identifier: Apache-2.0
"""Options of test_faults.py."""

import pytest


def pytest_addoption(parser):
    group = parser.getgroup("tonewright")
    group.addoption("--points", type=int, metavar="N", default=60, help="call stacks of allocations (default: 60)")
    group.addoption("--only", metavar="FAULT", help="run this one and show it, such as memory:120")


@pytest.fixture(scope="session")
def shim(command):
    """The library that fails."""
    return command.parents[1] / "tests/tonewright_faults.so"
