# SPDX-License-Identifier: Apache-2.0
"""The fixture of tests of programs that read lookup tables."""

import pytest
from lut_client import LutTest


@pytest.fixture
def test(client, report, command, scratch):
    """A program, its LUTs and its picture. `-s` prints the rows of docs/clients.md at its end."""
    test = LutTest(report, command, scratch, client)
    yield test
    print(*test.rows, sep="\n")
