# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the Python tests.

    python3 -m pytest tests/report/test_page.py -k keyboard --tonewright build/release/bin/tonewright

A test asks for `report`, makes any number of checks, and fails at its end if one of them has failed. The summary counts checks as
the scripts do: `N passed, M failed`. A test that is skipped says why in a line `skipped: REASON`, which tests/skipped.py reads. If
all tests of a run are skipped, the exit status is 77, so that ctest shows the run as skipped.
"""

import importlib
import os
import shutil
import signal
import sys
from pathlib import Path

import pictures
import pytest

from pictures import ALL, SKIPPED, Report, share_of

PROJECT = Path(__file__).resolve().parents[1]


def pytest_addoption(parser):
    group = parser.getgroup("tonewright")
    group.addoption("--tonewright", type=Path, default=PROJECT / "build/release/bin/tonewright", metavar="COMMAND",
                    help="the command (default: build/release/bin/tonewright)")
    group.addoption("--python-module", type=Path, metavar="FOLDER", help="folder of the Python package (default: that of the command's build)")
    group.addoption("--plugin", type=Path, metavar="FOLDER", help="folder of the format plugin (default: that of the command's build)")
    group.addoption("--other", type=Path, metavar="COMMAND", help="the command of another build, which must write the same files")
    group.addoption("--site", type=Path, metavar="FOLDER", help="the documentation site; without it, its test builds one")
    group.addoption("--screenshots", type=Path, metavar="FOLDER", help="write pictures of pages here")
    group.addoption("--record", action="store_true", help="write the numbers that a test compares anew, where it has some")


def pytest_configure(config):
    os.environ.setdefault("LC_ALL", "C.UTF-8")
    # Configurations of the user must change no result.
    os.environ.pop("OCIO", None)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it, and so would their commands
    config.checks = Report()
    pictures.runs_in_pytest = True
    if folder := config.getoption("--screenshots"):
        folder.mkdir(parents=True, exist_ok=True)


# --------------------------------------------------------------------------------------------------
# Fixtures


@pytest.fixture(scope="session")
def command(request):
    """The command, as an absolute path."""
    path = request.config.getoption("--tonewright").resolve()
    if not path.exists():
        pytest.exit(f"--tonewright: {path} does not exist; build it with ./run build", returncode=2)
    return path


def built_folder(request, name, pattern):
    """A folder that an option names, else one of the command's build."""
    given = request.config.getoption(name)
    folders = [given] if given else sorted(request.getfixturevalue("command").parents[1].glob(pattern))
    if not folders:
        pytest.skip(f"{name} names no folder, and the build has no {pattern}")
    if len(folders) > 1:
        pytest.exit(f"{name} names no folder, and the build has {', '.join(f.name for f in folders)}; expected one", returncode=2)
    return folders[0].resolve()


@pytest.fixture(scope="session")
def python_module(request):
    """The folder of the Python package."""
    return built_folder(request, "--python-module", "python")


@pytest.fixture(scope="session")
def tw(python_module):
    """The Python package."""
    sys.path.insert(0, str(python_module))
    return importlib.import_module("tonewright")


@pytest.fixture(scope="session")
def plugin(request):
    """The folder of the format plugin of OpenImageIO."""
    return built_folder(request, "--plugin", "lib/OpenImageIO-*")


@pytest.fixture(scope="session")
def shared_data():
    """The folder of reference data that the repository does not have."""
    if not os.environ.get("TONEWRIGHT_SHARED"):
        pytest.skip("TONEWRIGHT_SHARED names no folder with reference data")
    return Path(os.environ["TONEWRIGHT_SHARED"])


@pytest.fixture
def scratch(tmp_path):
    """A folder of the test's own."""
    return tmp_path


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder that the tests of a file share. The file may fill it by a fixture of the same name."""
    return tmp_path_factory.mktemp("shared")


@pytest.fixture(scope="session", autouse=True)
def no_folders_left(request, tmp_path_factory):
    """Removes the folders of all tests, unless one of them has failed, or --basetemp names their place."""
    yield
    if not request.session.testsfailed and not request.config.option.basetemp:
        shutil.rmtree(tmp_path_factory.getbasetemp(), ignore_errors=True)


@pytest.fixture
def report(request):
    """Counts the checks of a test, and of the whole run."""
    return Report(request.config.checks)


# --------------------------------------------------------------------------------------------------
# Selection and results


def pytest_collection_modifyitems(config, items):
    """Leaves out what only full runs take, and shares that are not this commit's, unless someone asks for a test by its name."""
    if ALL or config.option.keyword or any("::" in argument for argument in config.args):
        return
    left_out = {item for item in items if item.get_closest_marker("full")}
    shares = {}
    for item in items:
        if mark := item.get_closest_marker("share"):
            shares.setdefault((item.path, *mark.args), []).append(item)
    for (_, parts), members in shares.items():
        with config.pluginmanager.getplugin("capturemanager").global_and_fixture_disabled():
            left_out |= set(members) - set(share_of(members, parts))
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if item not in left_out]


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem):
    """Runs a test; fails with its failed checks, and if it has made none."""
    arguments = {name: pyfuncitem.funcargs[name] for name in pyfuncitem._fixtureinfo.argnames}
    made = pyfuncitem.funcargs.get("report")
    try:
        pyfuncitem.obj(**arguments)
    except pytest.skip.Exception:
        if not (made and made.failures):
            raise
    if made is not None:
        if made.failures:
            pytest.fail("\n".join(made.failures), pytrace=False)
        if not made.passed:
            pytest.fail("the test has made no check", pytrace=False)
    return True


def reasons(reporter):
    """Why tests, or some of their checks, were skipped: each reason once, in order."""
    found = [report.longrepr[2].removeprefix("Skipped: ") for report in reporter.stats.get("skipped", [])]
    for report in [*reporter.stats.get("passed", []), *reporter.stats.get("failed", [])]:
        found += [line.split("skipped: ", 1)[1] for line in report.capstdout.splitlines() if line.lstrip().startswith("skipped: ")]
    return list(dict.fromkeys(found))


def pytest_terminal_summary(terminalreporter, config):
    for reason in reasons(terminalreporter):
        terminalreporter.line(f"skipped: {reason}")
    terminalreporter.line(f"{config.checks.passed} passed, {config.checks.failed} failed")


def pytest_sessionfinish(session, exitstatus):
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    has_not_failed = exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED)
    if has_not_failed and reporter.stats.get("skipped") and not reporter.stats.get("passed"):
        session.exitstatus = SKIPPED
