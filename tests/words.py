#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""README, docs/, all help texts and identifiers of public headers use one vocabulary and American spelling.

Comments in the .h and .cpp files of src/ and tests/ say what a thing is or why: after `//` or `/*`, also in text that a program
writes, stands none of BEGINNINGS. Later lines of a block comment, and comments in other languages, are not read.

Usage: words.py TONEWRIGHT

The phrases below have a better word, which the message names. Words that are right elsewhere (form, light, part, place, row)
are left to reviewers. Fenced code, code spans and link addresses hold names and are not read; neither is quoted text,
which keeps its spelling.
"""
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]

# Regular expression, ignoring case -> what to say instead.
PHRASES = {
    r"ways? back|and back": "inverse, round trip",
    r"forms? of (an|the) operator|operator's forms?|in every form": "backend, representation",
    r"(?<![.\w])cubes?": "3D LUT, grid, node",
    r"lattices?": "grid, gray ramp, sample set",
    r"Map3": "channel-mixing stage",
    r"probes": "samples, sample set",
    r"influences?": "sensitivity",
    r"fold(s|ed|ing)? (the )?curves?|restarts": "curve fitting, segment",
    r"(narrow|wide) lanes?": "single or double precision",
    r"keep_index": "gather, permute, expand",
    r"lookup_at|positioned tables?": "non-uniform 1D LUT",
    r"light pictures?": "luminance plane",
    r"whole programs?": "launcher, picture commands",
    r"shel(f|ves)": "preset set, shipped LUTs",
    r"deviations?": "documented difference",
    r"tak(e|es|ing) (\w+ )?apart|divid(e|es|ed|ing) colors? by alpha": "un-premultiply",
    r"what the numbers are": "scene-linear, display-linear, encoded, code value",
    r"what (an )?applications? starts? with": "default view",
    r"(noise )?against bands": "dither by half a code value",
    r"what the light suggests": "exposure metering, eye adaptation",
}

BRITISH = {
    r"\w*colour\w*": "color",
    r"grey\w*": "gray",
    r"licen[c]e[ds]?": "license",
    r"(behavi|fav|hon|neighb|vap|lab)our\w*": "-or",
    r"(cent|fib|lit|lust)re[ds]?": "-er",
    r"\w*(normal|optim|recogn|organ|initial|minim|maxim|synthes|summar|serial|linear|quant|visual|emphas|real|character|util"
    r"|equal|standard|special|general|local|memor|random|vector|parallel|author|custom|categor|prior|external)"
    r"is(e|es|ed|er|ers|ing|ation|ations)": "-ize",
    r"(anal|catal|paral)ys(e|es|ed|ing)": "-yze",
    r"(defen|offen|preten)ce": "-se",
    r"(label|model|travel|cancel|level|channel|signal)l(ed|ing)": "one l",
    r"artefacts?": "artifact",
    r"programmes?": "program",
    r"whilst|amongst": "while, among",
}

# Where, what stands in the lines of a phrase, and why it stays. Every entry is needed.
ALLOWED = [
    ("bake --help-all", "Formats: cube,", "the name of a format"),
    ("--help-all", "unpremult", "the one explanation of un-premultiply"),
    ("docs/operators/agx_blender.md", "lattice or formula", "the values of a parameter"),
    ("tonewright/lut.h", "cube,", "the name of a format"),
    ("tonewright/lut.h", "Lut Format::cube", "the name of a format"),
]

# Words at the start of a comment that hide its subject.
# Texts of generated files begin with a quotation mark.
BEGINNINGS = re.compile(r"(?<!\")(?://[/!]?|/\*+!?)<?\s*(Of|What|Where|Whether|As|How)\b")


def prose(text):
    """Markdown without code, addresses and quotations; lines stay where they are."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group())

    text = re.sub(r"(?ms)^ *```.*?^ *```", blank, text)
    text = re.sub(r"`[^`]*`", blank, text)
    return re.sub(r"\]\([^)]*\)|<a [^>]*>|https?://\S+", blank, text)


def identifiers(text):
    """C++ without comments and strings, identifiers as words; lines stay where they are."""
    code = re.sub(r'//[^\n]*|"(?:[^"\\\n]|\\.)*"', "", text)
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|_", " ", code)


def beginnings():
    for folder in ("src", "tests"):
        for path in sorted(path for path in (ROOT / folder).rglob("*") if path.suffix in (".h", ".cpp")):
            for number, line in enumerate(path.read_text().splitlines(), 1):
                if match := BEGINNINGS.search(line):
                    yield f"{path.relative_to(ROOT)}:{number}: comment begins with {match[1]}; say what the thing is"


def help_texts(command):
    def run(*arguments):
        environment = {**os.environ, "COLUMNS": "80"}
        return subprocess.run([command, *arguments], env=environment, capture_output=True, check=True, text=True).stdout

    text = run("--help")
    yield "tonewright --help", text
    for name in re.findall(r"(?m)^  ([a-z]+) {2,}\S", text):
        yield f"tonewright {name} --help-all", run(name, "--help-all")


def findings(where, text, used):
    unquoted = re.sub(r'"[^"\n]*"', lambda match: " " * len(match.group()), text)
    for words, searched in ((PHRASES, text), (BRITISH, unquoted)):
        for pattern, better in words.items():
            # A phrase may continue on the next line.
            for match in re.finditer(rf"(?i)\b(?:{pattern})\b".replace(" ", r"\s+"), searched):
                line = searched.count("\n", 0, match.start())
                around = " ".join(text.splitlines()[line:line + 2])
                reasons = [entry for entry in ALLOWED if entry[0] in where and entry[1] in around]
                used.update(reasons)
                if not reasons:
                    yield f"{where}:{line + 1}: {' '.join(match.group().split())}; say {better}"


def main():
    texts = [(str(page.relative_to(ROOT)), prose(page.read_text()))
             for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]]
    texts += help_texts(sys.argv[1])
    texts += [(str(header.relative_to(ROOT)), identifiers(header.read_text()))
              for header in sorted((ROOT / "src/include/tonewright").glob("*.h"))]
    used = set()
    found = [finding for where, text in texts for finding in findings(where, text, used)]
    found += beginnings()
    found += [f"tests/words.py: nothing needs {entry}" for entry in ALLOWED if entry not in used]
    print("\n".join(found + [f"{len(texts)} texts, {len(found)} findings"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
