# SPDX-License-Identifier: Apache-2.0
"""The help of every command: width, two lines an option, all options in --help-all. The commands of the README run."""

import fcntl
import os
import pty
import re
import shutil
import struct
import subprocess
import termios

import pytest
from pictures import PROJECT

APPLY_LINES = 50  # a page of a large terminal
OPTION = r"--?[a-zA-Z0-9][a-z0-9-]*"


def help_of(command, *arguments, columns=None):
    environment = {k: v for k, v in os.environ.items() if k != "COLUMNS"}
    if columns:
        environment["COLUMNS"] = str(columns)
    return subprocess.run([command, *arguments], env=environment, capture_output=True, check=True).stdout.decode()


def on_terminal(command, *arguments, columns):
    """The command's output on a terminal of this width."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    environment = {k: v for k, v in os.environ.items() if k != "COLUMNS"}
    with subprocess.Popen([command, *arguments], env=environment, stdout=theirs) as process:
        os.close(theirs)
        text = b""
        while True:
            try:
                part = os.read(ours, 65536)
            except OSError:  # Linux's end of a terminal
                break
            if not part:
                break
            text += part
        process.wait()
    os.close(ours)
    return text.decode().replace("\r\n", "\n")


def entries_of(text):
    """(names, number of lines) of every option and argument."""
    entries = []
    for block in text.split("\n\n"):
        lines = block.splitlines()
        if not re.fullmatch(r"[A-Z][^.]*:", lines[0]) or lines[0].startswith("Example"):
            continue
        for line in lines[1:]:
            if re.match(r"  \S", line):
                entries.append([re.split(r"  +", line.strip())[0], 1])
            else:
                entries[-1][1] += 1
    return entries


def options_of(text):
    return {name for names, _ in entries_of(text) for name in re.findall(rf"(?<![\w-]){OPTION}", names)}


@pytest.fixture(scope="module")
def commands(command):
    """Names of all commands."""
    return [name for name, _ in entries_of(help_of(command, "--help")) if not name.startswith("-")]


def test_overview(report, command, commands):
    report.check(f"{len(commands)} commands", {"apply", "bake", "config", "verify"} <= set(commands), commands)
    wide = [line for line in help_of(command, "--help").splitlines() if len(line) > 80]
    report.check("--help: at most 80 columns", not wide, wide)
    whole = help_of(command, "--help-all")
    report.check("--help-all has the help of every command",
                 all(help_of(command, name, "--help-all") in whole for name in commands))


def test_pages(report, command, commands):
    for name in commands:
        for flag in ("--help", "--help-all"):
            text = help_of(command, name, flag)
            wide = [line for line in text.splitlines() if len(line) > 80]
            report.check(f"{name} {flag}: at most 80 columns", not wide, wide)
            long = [names for names, lines in entries_of(text) if lines > 2]
            report.check(f"{name} {flag}: at most two lines an option", not long, long)
            dumps = re.findall(r"Excludes:|Needs:|\bTEXT:|(?<!-)\bhosts?\b|REQUIRED", text)
            report.check(f"{name} {flag}: no words of the parser", not dumps, dumps)
            groups = re.findall(r"(?m)^[A-Z][A-Za-z ]*:$", text)
            report.check(f"{name} {flag}: in groups", len(groups) >= 2, groups)
        common, everything = (options_of(help_of(command, name, flag)) for flag in ("--help", "--help-all"))
        report.check(f"{name} --help-all has what --help has", common <= everything, common - everything)
    lines = len(help_of(command, "apply", "--help").splitlines())
    report.check(f"apply --help has {lines} lines, at most {APPLY_LINES}", lines <= APPLY_LINES)


def test_all_options(report, command, commands):
    """Options that the sources add, and those that the documents use."""
    everything = {name: options_of(help_of(command, name, "--help-all")) for name in commands}
    shown = set().union(*everything.values())
    added = set()
    for source in (PROJECT / "src" / "cli").glob("*.cpp"):
        for names in re.findall(r'\badd(?:_flag)?\(\s*"(-[^"]+)"', source.read_text()):
            added |= set(names.split(","))
    report.check(f"--help-all shows the {len(added)} options of src/cli", len(added) > 60 and added <= shown,
                 added - shown)
    unknown = []
    for page in [PROJECT / "README.md", *sorted((PROJECT / "docs").rglob("*.md"))]:
        text = page.read_text().replace("\\\n", " ")
        for name, rest in re.findall(r"(?m)^(?:\$ )?tonewright (\w+)\b([^|\n]*)", text):
            if name in everything:
                used = set(re.findall(rf"(?<=\s){OPTION}", rest.split("#")[0]))
                used = {option for option in used if not re.fullmatch(r"-\d+", option)}
                unknown += [f"{page.name}: {name} {option}" for option in used - everything[name]]
    report.check("documents use options that the help has", not unknown, unknown)


def test_width(report, command):
    def widest(text):
        return max(map(len, text.split("\nExample")[0].splitlines()))

    report.check("COLUMNS=100", 80 < widest(help_of(command, "bake", "--help", columns=100)) <= 100)
    report.check("COLUMNS=50", widest(help_of(command, "chart", "--help", columns=50)) <= 50)
    report.check("COLUMNS=none of a number", widest(help_of(command, "bake", "--help", columns="x")) <= 80)
    report.check("a terminal of 100 columns", 80 < widest(on_terminal(command, "bake", "--help", columns=100)) <= 100)
    report.check("a terminal of 60 columns", widest(on_terminal(command, "chart", "--help", columns=60)) <= 60)


def test_readme(report, command, scratch):
    """The commands of Quick start, as they are printed, where the repository's files are."""
    section = re.search(r"## Quick start\n(.*?)\n## ", (PROJECT / "README.md").read_text(), re.S)[1]
    lines = [line for block in re.findall(r"```\n(.*?)```", section, re.S) for line in block.splitlines()]
    report.check(f"README: {len(lines)} commands", len(lines) >= 6, lines)
    if shutil.which("oiiotool") is None:
        lines = [line for line in lines if not line.startswith("oiiotool")]
    (scratch / "ocio_config").symlink_to(PROJECT / "ocio_config")
    binaries = scratch / "build" / "release" / "bin"
    binaries.parent.mkdir(parents=True)
    binaries.symlink_to(command.parent)
    done = subprocess.run(["bash", "-e", "-c", "\n".join(lines)], cwd=scratch, capture_output=True, text=True, check=False)
    written = {path.name for path in scratch.iterdir()}
    wanted = {name for line in lines for name in re.findall(r"\S+\.(?:exr|png|cube)\b", line)}
    report.check(f"README: they run, and write {', '.join(sorted(wanted))}",
                 done.returncode == 0 and len(wanted) >= 4 and wanted <= written, (done.stderr, wanted - written))
