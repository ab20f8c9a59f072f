# SPDX-License-Identifier: Apache-2.0
"""The folder of published figures."""

import pytest


@pytest.fixture(scope="session")
def shared(shared_data):
    """The folder with reference/check_values.json."""
    if not (shared_data / "reference" / "check_values.json").is_file():
        pytest.skip("TONEWRIGHT_SHARED names no folder that holds reference/check_values.json")
    return shared_data
