# SPDX-License-Identifier: Apache-2.0
"""Options and fixtures of the tests that run shaders."""

from pathlib import Path

import pytest
from executed import Comparison
from pictures import run


def pytest_addoption(parser):
    group = parser.getgroup("tonewright")
    group.addoption("--shaders", type=Path, metavar="FOLDER",
                    help="what `tonewright shader --all FOLDER --display srgb` wrote; without it, the tests write it")
    group.addoption("--errors", type=Path, metavar="FILE",
                    help="merge the largest errors of shaders into a JSON file: language -> function -> error")


@pytest.fixture(scope="session")
def shaders(request, command, tmp_path_factory):
    """The folder of all shaders."""
    folder = request.config.getoption("--shaders")
    if not folder:
        folder = tmp_path_factory.mktemp("shaders") / "all"
        run(command, "shader", "--all", folder, "--display", "srgb", "-q")
    return folder.resolve()


@pytest.fixture
def comparison(report, command, shaders):
    return Comparison(report, command, shaders)


@pytest.fixture
def errors_file(request):
    """The file that gets the largest errors, or None."""
    return request.config.getoption("--errors")
