# SPDX-License-Identifier: Apache-2.0
"""The manual pages that the build wrote: readers have no warning, options and examples are those of the help."""

import os
import re
import subprocess

import pytest
from pictures import PROJECT, need_program
from test_help import entries_of, help_of, options_of

# Variables that libraries read for us.
OF_LIBRARIES = {"OIIO_LIBRARY_PATH", "TMPDIR"}
# So wide that no line of code wraps.
READER = {**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "200", "MANPAGER": "cat"}


def run(*command):
    done = subprocess.run(command, env=READER, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def sections_of(text):
    """Title -> lines."""
    parts = re.split(r"(?m)^([A-Z][^a-z\n]*)$", text)
    return {title: body.splitlines() for title, body in zip(parts[1::2], parts[2::2])}


@pytest.fixture(scope="module")
def commands(command):
    for tool, package in (("man", "man-db"), ("mandoc", "mandoc"), ("lexgrog", "man-db")):
        need_program(tool, package)
    return [name for name, _ in entries_of(help_of(command, "--help")) if not name.startswith("-")]


@pytest.fixture(scope="module")
def shown(command, commands):
    """Name of a page -> (its file, exit code of `man`, text, warnings)."""
    names = ["tonewright.1", "tonewright-tone.5", *(f"tonewright-{name}.1" for name in commands)]
    files = {name: command.parents[1] / "man" / f"man{name[-1]}" / name for name in names}
    return {name: (file, *run("man", "-l", "--warnings", file)) for name, file in files.items()}


@pytest.fixture(scope="module")
def pages(shown):
    """Name of a page -> its sections."""
    return {name: sections_of(text) for name, (_, _, text, _) in shown.items()}


def test_files(report, command, shown):
    written = [path.name for path in (command.parents[1] / "man").rglob("*.*")]
    report.check(f"{len(shown)} pages", sorted(written) == sorted(shown), set(written) ^ set(shown))


def test_readers(report, shown):
    for page, status, text, warnings in shown.values():
        report.check(f"{page.name}: man", status == 0 and not warnings, warnings)
        check_text(report, page, text)


def check_text(report, page, text):
    status, findings, _ = run("mandoc", "-T", "lint", "-W", "warning", page)
    report.check(f"{page.name}: mandoc", status == 0 and not findings, findings)
    status, name, _ = run("lexgrog", page)
    report.check(f"{page.name}: lexgrog finds its name", status == 0 and f'"{page.stem} - ' in name, name)
    left = re.findall(r".*(?:\\f|\]\(|`|\|---).*", text)
    report.check(f"{page.name}: no markup is left", not left, left)


def test_options(report, command, commands, pages):
    check_options(report, command, "tonewright", pages["tonewright.1"])
    for name in commands:
        check_options(report, command, name, pages[f"tonewright-{name}.1"])


def check_options(report, command, name, sections):
    arguments = [] if name == "tonewright" else [name]
    text = help_of(command, *arguments, *(["--help-all"] if arguments else ["--help"]))
    lines = [line for title in ("OPTIONS", "COMMANDS AND OPTIONS") for line in sections.get(title, [])]
    names = [found[1] for line in lines if (found := re.match(r" {7}(-[\w-]+(?:, -[\w-]+)*)", line))]
    options = {option for part in names for option in part.split(", ")}
    report.check(f"{name}: the {len(options)} options of its help", options == options_of(text), options ^ options_of(text))
    if not arguments:
        commands = {entry for entry, _ in entries_of(text) if not entry.startswith("-")}
        listed = set(re.findall(r"(?m)^ {7}tonewright-(\w+)\(1\)$", "\n".join(lines)))
        report.check(f"{name}: the {len(commands)} commands of its help", listed == commands, listed ^ commands)
    examples = re.findall(r"(?m)^  (\S.*)", re.split(r"\nExamples?:\n", text)[-1])
    shown = [line.strip() for line in sections.get("EXAMPLES", [])]
    report.check(f"{name}: the {len(examples)} examples of its help", examples and set(examples) <= set(shown), (examples, shown))


def test_environment(report, pages):
    """The pages explain the variables that the source reads, and no others."""
    used = set()
    for path in (PROJECT / "src").rglob("*.cpp"):
        text = path.read_text()
        if "getenv" in text:
            used |= set(re.findall(r'"([A-Z][A-Z_]*[A-Z])"', text))
    explained = set()
    for sections in pages.values():
        for line in sections.get("ENVIRONMENT", []):
            if found := re.match(r" {7}([A-Z_]+(?:, [A-Z_]+)*)(?: |$)", line):
                explained |= set(found[1].split(", "))
    report.check(f"{len(used)} environment variables", len(used) >= 7 and explained == used | OF_LIBRARIES,
                 explained ^ (used | OF_LIBRARIES))


def test_tone_files(report, pages):
    document = (PROJECT / "docs" / "tone_files.md").read_text()
    reference = document[document.index("## The file"):]
    shown = {line.strip() for lines in pages["tonewright-tone.5"].values() for line in lines}
    keys = re.findall(r"(?m)^\| `([^`]+)`", reference)
    missing = [key for key in keys if not any(line.startswith(key) for line in shown)]
    report.check(f"tonewright-tone: {len(keys)} keys and stages", len(keys) >= 20 and not missing, missing)
    code = [line.strip() for block in re.findall(r"(?ms)^```\w*\n(.*?)^```", reference)
            for paragraph in block.split("\n\n") if paragraph.isascii() for line in paragraph.splitlines()]
    missing = [line for line in code if line not in shown]
    report.check(f"tonewright-tone: {len(code)} lines of code", len(code) >= 30 and not missing, missing)


def test_installation(report, command, scratch, pages):
    status, _, errors = run("cmake", f"-DCMAKE_INSTALL_PREFIX={scratch}", "-P", command.parents[1] / "src" / "cmake_install.cmake")
    installed = sorted(path.name for path in (scratch / "share" / "man").rglob("*.[15]"))
    report.check(f"{len(pages)} pages are installed", status == 0 and installed == sorted(pages), (errors, installed))
