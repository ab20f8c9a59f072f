# SPDX-License-Identifier: Apache-2.0
"""Configs with one thing wrong: `config --into`, `--update`, `--remove` and `verify --config` end with one line.

The script makes valid configs of several profiles, changes one thing in each, and runs the commands. A mutant may stay
valid, so success (0) and a file that is wrong (3) are right. Wrong usage (2) is right only for a name that is taken, and
a failed check (1) only for findings that `verify` prints. A failure prints one line and leaves every file as it was.
TONEWRIGHT_MUTANTS=FIRST-LAST selects others than the first ones.
"""

import concurrent.futures
import os
import random
import re
import shutil
import subprocess

import pytest
from pictures import ALL
from test_into import ACES, BY_HAND, OWN

# Everything that a config refers to by name: looks, named transforms, files, variables, rules, aliases.
RICH = """ocio_profile_version: 2.1
name: rich
environment: {SHOT: a}
search_path: luts
strictparsing: true
luma: [0.2126, 0.7152, 0.0722]
roles: {aces_interchange: aces, cie_xyz_d65_interchange: xyz, data: raw, scene_linear: lin, compositing_log: log}
file_rules:
  - !<Rule> {name: Movies, extension: mov, pattern: "*", colorspace: log}
  - !<Rule> {name: Default, colorspace: lin}
viewing_rules:
  - !<Rule> {name: Any, colorspaces: [lin]}
shared_views:
  - !<View> {name: Film, view_transform: film, display_colorspace: <USE_DISPLAY_NAME>, looks: "+warm"}
displays:
  sRGB:
    - !<View> {name: Plain, view_transform: plain, display_colorspace: sRGB, looks: warm, rule: Any}
    - !<View> {name: Raw, colorspace: raw}
    - !<Views> [Film]
active_displays: [sRGB]
active_views: [Plain, Film, Raw]
inactive_colorspaces: [log]
default_view_transform: plain
looks:
  - !<Look> {name: warm, process_space: log, transform: !<CDLTransform> {slope: [1.1, 1, 0.9]}}
  - !<Look> {name: cool, process_space: lin, transform: !<LookTransform> {src: lin, dst: lin, looks: warm}}
view_transforms:
  - !<ViewTransform>
    name: plain
    from_scene_reference: !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
  - !<ViewTransform>
    name: film
    from_scene_reference: !<GroupTransform>
      children:
        - !<ColorSpaceTransform> {src: aces, dst: log}
        - !<FileTransform> {src: film.cube, interpolation: tetrahedral}
        - !<ColorSpaceTransform> {src: log, dst: aces}
        - !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}
display_colorspaces:
  - !<ColorSpace> {name: xyz}
  - !<ColorSpace>
    name: sRGB
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
colorspaces:
  - !<ColorSpace> {name: aces, aliases: [ap0]}
  - !<ColorSpace>
    name: lin
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: log
    to_scene_reference: !<GroupTransform>
      children:
        - !<FileTransform> {src: "log_${SHOT}.spi1d", interpolation: linear}
        - !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1], offset: [0, 0, 0, 0]}
  - !<ColorSpace> {name: raw, isdata: true}
named_transforms:
  - !<NamedTransform> {name: brighter, transform: !<ExposureContrastTransform> {exposure: 1, style: linear}}
"""
BASES = {"aces": ACES, "own": OWN, "by hand": BY_HAND, "rich": RICH,
         "profile 2.0": ACES.replace("2.1", "2", 1), "profile 2.2": RICH.replace("2.1", "2.2", 1)}
FILM = "LUT_3D_SIZE 2\n" + "".join(f"{i & 1} {i >> 1 & 1} {i >> 2}\n" for i in range(8))
LOG = "Version 1\nFrom 0 1\nLength 3\nComponents 1\n{\n0\n0.2\n1\n}\n"
TAGS = ("ColorSpace", "View", "Views", "Look", "ViewTransform", "Rule", "NamedTransform", "BuiltinTransform",
        "MatrixTransform", "FileTransform", "GroupTransform", "ColorSpaceTransform", "LookTransform", "CDLTransform")
VALUES = ('""', "[]", "{}", "[a, b]", "{a: b}", "~", "-1", "nan", "1e999", "99999999999", "true", "x" * 300, "${SHOT}",
          '"a\\nb"', '"\\u00fc"')
NAMES = re.compile(r"[A-Za-z][\w.-]*(?: - [\w.-]+)*")


class Mutator:
    """Changes of a text, each with a few words of what it did."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def name(self, text):
        """Another name, or none, in one place of many."""
        at = self.random.choice(list(NAMES.finditer(text)))
        old = at.group()
        new = self.random.choice((old[:-1], old + "x", old.swapcase(), self.random.choice(NAMES.findall(text)), '""'))
        return text[:at.start()] + new + text[at.end():], f"{old} is {new} at {at.start()}"

    def role(self, text):
        """A role that names another thing."""
        at = self.random.choice(list(re.finditer(r"(?<=_interchange: )['\w.-]+|(?<=scene_linear: )[\w.-]+|(?<=data: )[\w.-]+",
                                                 text)))
        new = self.random.choice((at.group() + "x", self.random.choice(NAMES.findall(text)), '""'))
        return text[:at.start()] + new + text[at.end():], f"role {at.group()} is {new}"

    def item(self, text):
        """One item less, or one twice."""
        lines = text.split("\n")
        at = self.random.choice([i for i, line in enumerate(lines) if line.lstrip().startswith("- ")])
        indent = len(lines[at]) - len(lines[at].lstrip())
        end = at + 1
        while end < len(lines) and lines[end].strip() and len(lines[end]) - len(lines[end].lstrip()) > indent:
            end += 1
        item = lines[at:end]
        if self.random.random() < 0.3:
            return "\n".join(lines[:end] + item + lines[end:]), f"twice: {item[0]}"
        return "\n".join(lines[:at] + lines[end:]), f"without {item[0]}"

    def section(self, text):
        """A list of the file less."""
        keys = re.findall(r"(?m)^\w+(?=:)", text)
        key = self.random.choice(keys)
        after = re.sub(rf"(?ms)^{key}:.*?(?=^\w|\Z)", "", text, count=1)
        return after, f"without {key}"

    def tag(self, text):
        """Another type."""
        at = self.random.choice(list(re.finditer(r"!<(\w+)>", text)))
        new = self.random.choice(TAGS)
        return text[:at.start(1)] + new + text[at.end(1):], f"{at.group(1)} is a {new}"

    def value(self, text):
        """Another kind of value."""
        at = self.random.choice(list(re.finditer(r"(?<=: )[^\s{\[,}\]#|][^\n,}\]#]*|\[[^\[\]\n]*\]", text)))
        new = self.random.choice(VALUES)
        return text[:at.start()] + new + text[at.end():], f"{at.group()} is {new[:20]}"

    def number(self, text):
        """Another number."""
        at = self.random.choice(list(re.finditer(r"-?\d+(?:\.\d+)?", text)))
        new = self.random.choice(("0", "-1", "1e30", "nan", "inf", "999999999", ""))
        return text[:at.start()] + new + text[at.end():], f"{at.group()} is {new or 'gone'}"

    def cut(self, text):
        """The file ends early."""
        at = self.random.randrange(len(text))
        return text[:at], f"ends at {at}"

    def key(self, text):
        """A misspelled key."""
        at = self.random.choice(list(re.finditer(r"\w+(?=: )", text)))
        return text[:at.start()] + at.group()[1:] + text[at.end():], f"key {at.group()} without its first letter"

    def byte(self, text):
        """A sign that is no text, or has a meaning in YAML."""
        at = self.random.randrange(len(text))
        new = self.random.choice(("\0", "\t", "\xff", "&a ", "*a ", "'", '"', "}", "]", "- ", ": ", "#", "%", "|\n"))
        return text[:at] + new + text[at:], f"{new!r} at {at}"

    def text(self, text):
        change = self.random.choice((self.name, self.name, self.role, self.item, self.item, self.section, self.tag, self.value,
                                     self.value, self.number, self.cut, self.key, self.byte))
        return change(text)

    def table(self, path):
        """A table that is damaged."""
        kind = self.random.choice(("short", "empty", "missing", "folder", "text"))
        data = path.read_bytes()
        path.unlink()
        if kind == "folder":
            path.mkdir()
        elif kind != "missing":
            path.write_bytes({"short": data[:self.random.randrange(len(data))], "empty": b"",
                              "text": data.replace(b"1", b"x", 1)}[kind])
        return f"{path.name} is {kind}"


FIRST, LAST = map(int, os.environ.get("TONEWRIGHT_MUTANTS", "0-399" if ALL else "0-29").split("-"))


def files_of(folder):
    return {path.relative_to(folder): path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


def run(command, arguments, home):
    environment = dict(os.environ, XDG_CACHE_HOME=str(home))
    try:
        # A record without its views means a dozen.
        return subprocess.run(["prlimit", "--core=0", str(command), *map(str, arguments)], capture_output=True, text=True,
                              errors="replace", check=False, timeout=300, env=environment)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(arguments, "a timeout", "", "")


def is_right(done, is_verify):
    lines = [line for line in done.stderr.splitlines() if not re.search("warning: |OpenColorIO: ", line)]
    if done.returncode == 0:
        return not lines
    if done.returncode == 1 and is_verify:
        return not lines and ("error: " in done.stdout or "FAILED" in done.stdout)
    if done.returncode == 2:
        return len(lines) == 1 and re.search("already; expected another name|display is ", lines[0])
    return done.returncode == 3 and len(lines) == 1 and done.stdout.count("added") == 0


def try_one(command, bases, root, home, seed):
    """The mutant's description and what went wrong, for each command."""
    mutator = Mutator(seed)
    kind = mutator.random.choice(sorted(bases))
    action = mutator.random.choice(("into", "into", "update", "remove", "verify"))
    folder = root / str(seed)
    shutil.copytree(bases[kind][action in ("update", "remove") or mutator.random.random() < 0.2], folder)
    config = folder / "c.ocio"
    tables = sorted(path for path in folder.rglob("*") if path.is_file() and path != config)
    if tables and mutator.random.random() < 0.15:
        table = mutator.random.choice(tables)
        if table.suffix == ".yaml":
            text, what = mutator.text(table.read_text())
            table.write_bytes(text.encode(errors="surrogateescape"))
            what = f"record: {what}"
        else:
            what = mutator.table(table)
    else:
        text, what = mutator.text(config.read_text())
        config.write_bytes(text.encode("latin-1" if "\xff" in text and text.isascii() else "utf-8"))
    before = files_of(folder)
    arguments = {"into": ["config", "--into", config, "--views", "clamp", "-q"],
                 "update": ["config", "--into", config, "--update", "-q"],
                 "remove": ["config", "--into", config, "--remove", "-q"],
                 "verify": ["verify", "--config", config, "--quick", "--no-gpu"]}[action]
    done = run(command, arguments, home)
    wrong = ""
    if not is_right(done, action == "verify"):
        wrong = f"exit code {done.returncode}: {done.stderr[:400]}"
    elif done.returncode != 0 and files_of(folder) != before:
        changed = [str(k) for k in {**before, **files_of(folder)} if before.get(k) != files_of(folder).get(k)]
        wrong = f"exit code {done.returncode}, but files have changed: {changed[:5]}"
    shutil.rmtree(folder)
    return f"{seed}: {kind}, {action}: {what[:100]!r}", wrong, done


@pytest.fixture(scope="module")
def bases(command, folder):
    """Kind -> folders of a plain and of an extended config, and what extended it."""
    made = {}
    for kind, text in BASES.items():
        for state in ("plain", "extended"):
            place = folder / f"{kind} {state}"
            (place / "luts").mkdir(parents=True)
            (place / "luts" / "film.cube").write_text(FILM)
            (place / "luts" / "log_a.spi1d").write_text(LOG)
            (place / "c.ocio").write_bytes(text.encode())
        done = run(command, ["config", "--into", place / "c.ocio", "--views", "hable", "-q"], folder / "cache")
        # The installed OpenColorIO may be older than the profile.
        if not ("2.2" in kind and done.returncode == 3):
            made[kind] = [folder / f"{kind} plain", place], done
    return made


def test_bases(report, bases):
    for kind, (_, done) in bases.items():
        report.check(f"{kind}: the config without a mutation", done.returncode == 0, done.stderr)


def test_mutants(report, command, folder, bases):
    folders, count = {kind: folders for kind, (folders, _) in bases.items()}, {}
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        seeds = range(FIRST, LAST + 1)
        for what, wrong, done in pool.map(lambda seed: try_one(command, folders, folder, folder / "cache", seed), seeds):
            count[done.returncode] = count.get(done.returncode, 0) + 1
            if wrong:
                report.check(what, False, wrong)
            print(what, "->", done.returncode, done.stderr.strip()[:200])
    report.check(f"{len(seeds)} mutants; exit codes: {count}", count.get(0, 0) and count.get(3, 0))
