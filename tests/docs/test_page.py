# SPDX-License-Identifier: Apache-2.0
"""Pages of docs/ whose commands, output and pictures are all that there is to test.

    python3 -m pytest tests/docs/test_page.py --tonewright build/release/bin/tonewright [-k gallery]
"""
import pytest
from docs_commands import check_page


@pytest.mark.parametrize("page", ["formula_to_picture", "gallery"])
def test_page(report, command, scratch, page):
    check_page(report, page, command, scratch)
