# SPDX-License-Identifier: Apache-2.0
"""A page of docs/ whose commands, output and pictures are all that there is to test.

    /usr/bin/python3 tests/docs/test_page.py PAGE build/release/bin/tonewright [--record]

--record writes the pictures of the page; `./run artifacts` does. The last line is `N passed, M failed`.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
from docs_commands import main  # noqa: E402

if __name__ == "__main__":
    page = sys.argv.pop(1)
    sys.exit(main(page, lambda *_: None))
