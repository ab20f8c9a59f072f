#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds docs/ as a static site with search, and adds a page for each operator.

Usage: build.py TONEWRIGHT SITE

The site is a folder of files, which any web server can serve. It requests nothing from other servers. The pages are those of
docs/, the README of the project, of luts/ and of ocio_config/. A page of an operator has its picture, curve, formula,
parameters, the differences from its dialects, and its errors. All of its figures come from the committed files and from the
command.
"""
import concurrent.futures
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
# Pages of the project -> pages of the site. Other pages of docs/ keep their names.
MOVED = {
    "README.md": "index.md",
    "docs/README.md": "guide.md",
    "docs/operators.md": "operators/index.md",
    "luts/README.md": "shipped_luts.md",
    "ocio_config/README.md": "ocio_config.md",
}


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def outside_code(text, change):
    """Changes the text between fenced blocks."""
    pieces = re.split(r"(?ms)^( *```.*?^ *```[^\n]*\n)", text)
    return "".join(piece if i % 2 else change(piece) for i, piece in enumerate(pieces))


def as_python_markdown(text):
    """The Markdown of GitHub, changed where Python-Markdown reads it differently."""
    def prose(piece):
        # A list begins after an empty line.
        piece = re.sub(r"(?m)^(?!\s*(?:[*-]|\d+\.) |\s*$|\s*\||#)(.*\S.*)\n(?=(?:[*-]|1\.) )", r"\1\n\n", piece)
        # Names, options and short commands do not break at their hyphens.
        piece = re.sub(r"(?<!`)`[^`]+`(?!`)", lambda code: code.group() + "{.whole}" * (len(code.group()) <= 34), piece)
        return piece.replace("<details>", '<details markdown="1">')

    # Words behind the language tell tests what a block is.
    text = re.sub(r"(?m)^( *```)output$", r"\1text", text)
    text = re.sub(r"(?m)^( *```\w+) .*$", r"\1", text)
    return outside_code(text, prose)


class Site:
    """Writes the pages into a folder, as mkdocs reads them."""

    def __init__(self, command, folder):
        self.command = command
        self.folder = folder
        listed = json.loads(run(command, "list", "--json"))
        self.operators = {op["id"]: op for op in listed["operators"] + listed["local_operators"]}
        self.dialects = (ROOT / "docs/operators/dialects.md").read_text()
        pages = {path.stem for path in (ROOT / "docs/operators").glob("*.md")} - {"dialects"}
        if pages != set(self.operators):
            raise SystemExit(f"docs/operators/ and the command differ in {sorted(pages ^ set(self.operators))}; "
                             "`./run artifacts` writes the pages")

    def target(self, path, anchor):
        """Page or file of the site for a path of the project; None if the site does not have it."""
        if path in MOVED:
            return MOVED[path], anchor
        if path.startswith("docs/") and (ROOT / path).is_file():
            return path.removeprefix("docs/"), anchor
        if path == "LICENSE" or re.fullmatch(r"luts/\w+/thumbnails/\w+\.png", path):
            return path, anchor
        return None

    def relink(self, text, source, page):
        """Links of a file of the project, for the page of the site that has its text."""
        def link(match):
            image, label, address = match.groups()
            if re.match(r"\w+:", address):
                return match.group()
            name, _, anchor = address.partition("#")
            path = os.path.normpath(os.path.join(os.path.dirname(source), name)) if name else source
            found = self.target(path, anchor)
            if not found:
                if not (ROOT / path).exists():
                    raise SystemExit(f"{source}: {address} does not exist")
                return label  # a file that the site leaves out
            to, anchor = found
            if not to.endswith(".md"):
                self.copy(path, to)
            relative = "" if to == page and anchor else os.path.relpath(to, os.path.dirname(page) or ".")
            return f"{image}[{label}]({relative}{'#' + anchor if anchor else ''})"

        # A picture may stand in a link.
        picture = r"(!)\[([^\]]*)\]\(([^)\s]+)\)"
        around = r"(?<!!)()\[((?:!\[[^\]]*\]\([^)]*\)|[^\[\]])*)\]\(([^)\s]+)\)"

        def prose(piece):
            return re.sub(around, link, re.sub(picture, link, piece))

        return outside_code(text, prose)

    def copy(self, path, to):
        target = self.folder / to
        if not target.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, target)

    def write(self, page, text):
        path = self.folder / page
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(as_python_markdown(text))

    def write_pages(self):
        sources = ["README.md", "luts/README.md", "ocio_config/README.md",
                   *(str(path.relative_to(ROOT)) for path in sorted((ROOT / "docs").rglob("*.md")))]
        for source in sources:
            if pathlib.Path(source).parent == pathlib.Path("docs/operators") and pathlib.Path(source).stem in self.operators:
                continue  # write_operator() has more
            page = MOVED.get(source, source.removeprefix("docs/"))
            text = (ROOT / source).read_text()
            if source == "luts/README.md":
                # The files are too large for the site.
                text = text.replace("# LUTs", "# Shipped LUTs", 1).replace(
                    "Click the picture in your application's column.", "The files are in the folder `luts/` of the project.", 1)
            self.write(page, self.relink(text, source, page))
        shutil.copy(HERE / "site.css", self.folder / "site.css")

    def write_operators(self):
        with tempfile.TemporaryDirectory() as scratch:
            chart = pathlib.Path(scratch) / "chart.exr"
            run(self.command, "chart", "-o", chart)
            run(self.command, "compare", chart, *self.operators, "--pictures", self.folder / "operators", "-o", f"{scratch}/sheet.png",
                "--cell-width", 16, "-q")
        errors = Errors()
        with concurrent.futures.ThreadPoolExecutor() as pool:
            list(pool.map(lambda op: self.write_operator(op, errors), self.operators.values()))

    def write_operator(self, op, errors):
        page = f"operators/{op['id']}.md"
        source = "docs/" + page
        self.write(page, "\n\n".join(part for part in (
            f"# {op['title']}",
            f"`{op['id']}`: {op['character']}.",
            f"![Test chart with {op['title']}]({op['id']}.png)",
            commands(op),
            self.relink(self.curve(op), source, page),
            parameters(op),
            self.formula(op),
            self.relink(self.differences(op), source, page),
            errors.of(op),
        ) if part) + "\n")

    def curve(self, op):
        """Plot and facts of the catalogue's page, without its heading, parameters and links."""
        section = (ROOT / f"docs/operators/{op['id']}.md").read_text().split("\nMore: ")[0]
        section = section[section.index("!["):] if "![" in section else section[section.index("\n* ") + 1:]
        return "## Curve and facts\n\n" + section.split("\n| parameter |")[0].strip()

    def formula(self, op):
        parts = ["## Formula"]
        definition = subprocess.run([self.command, "list", op["id"], "--definition"], capture_output=True, text=True, check=False)
        stages = re.findall(r"(?ms)^\[\[stage\]\].*?(?=^\[\[|\Z)", definition.stdout)
        if stages:
            parts.append("Stages of the [.tone file](../tone_files.md), with the default parameters. "
                         f"`tonewright list {op['id']} --definition` prints the whole file.")
            parts.append("```toml\n" + "".join(stages).rstrip() + "\n```")
        else:
            reason = definition.stderr.strip().removeprefix("tonewright: ")
            parts.append(f"No .tone file: {reason}.")
        if not op["is_local"]:
            code = self.glsl(op)
            parts.append(f'??? note "GLSL"\n\n    `tonewright shader {op["id"]} --language glsl -o {op["id"]}.glsl` writes it with its '
                         "header.\n\n"
                         + "\n".join("    " + line if line else "" for line in f"```glsl\n{code}\n```".splitlines()))
        return "\n\n".join(parts)

    def glsl(self, op):
        """The functions, without their header. A texture would be a file beside them."""
        with tempfile.TemporaryDirectory() as scratch:
            path = pathlib.Path(scratch) / "operator.glsl"
            run(self.command, "shader", op["id"], "--language", "glsl", "-o", path, "-q")
            return re.sub(r"^(//[^\n]*\n)+\n?", "", path.read_text()).rstrip()

    def differences(self, op):
        """Rows of the tables of dialects for the default of this operator and the defaults of others."""
        rows = []
        for pair in re.findall(r"(?m)^\| \w+ `[^|]*\|.*$", self.dialects):
            names, *figures = (cell.strip() for cell in pair.strip("|").split("|"))
            names = re.findall(r"`([^`]+)`", names)
            if op["id"] in names and len(names) == 2:
                other = names[1 - names.index(op["id"])]
                if ":" not in other:
                    rows.append((float(figures[-1]), other, figures))
        if not rows:
            return ""
        text = [f"## Differences from other {op['dialects']} operators", "",
                "Differences in 8-bit code values and in ΔE ITP, over the sample set. "
                "[Dialects](dialects.md) has presets, too, and explains the figures.", "",
                "| operator | max | 99.9 % | mean | ΔE ITP max | ΔE ITP mean |", "|---|---|---|---|---|---|"]
        for _, other, figures in sorted(rows):
            text.append(f"| [{self.operators[other]['title']}]({other}.md) | {' | '.join(figures)} |")
        return "\n".join(text)


def commands(op):
    """How to use it, for operators of all pictures and for local ones."""
    lines = [f"tonewright apply render.exr out.png --operator {op['id']}"]
    if not op["is_local"]:
        lines.append(f"tonewright bake {op['id']} -o {op['id']}.cube")
    return "```\n" + "\n".join(lines) + "\n```"


def cell(text):
    return str(text).replace("|", "\\|")


def number(value):
    return f"{value:g}" if isinstance(value, (int, float)) else str(value)


def parameters(op):
    parts = []
    if op["parameters"]:
        parts += ["## Parameters", "", "| parameter | default | range | |", "|---|---|---|---|"]
        for p in op["parameters"]:
            values = ", ".join(p["choices"]) if p["choices"] else (
                f"{number(p['min'])} to {number(p['max'])} {p['unit']}".strip() if p["kind"] == "number" else "")
            default = number(p["default"])
            parts.append(f"| `{p['name']}` | {f'`{default}`' if default else ''} | {cell(values)} | {cell(p['help'])} |")
        parts.append("")
    named = op["presets"] + op["looks"]
    if named:
        parts += ["## Presets and looks", "", "| name | |", "|---|---|"]
        parts += [f"| `{op['id']}:{p['id']}` | {cell(p['title'])} |" for p in named]
    return "\n".join(parts)


class Errors:
    """Measured errors of the committed config and LUTs."""

    def __init__(self):
        rows = re.findall(r"(?m)^\| ([^|]+) \| [^|]+ \| ([^|]+) \| ([^|]+) \| ([^|]+) \| ([^|]+) \|",
                          (ROOT / "ocio_config/README.md").read_text())
        self.views = {name: figures for name, *figures in rows}
        with open(ROOT / "luts/MANIFEST.csv", newline="") as file:
            self.luts = list(csv.DictReader(file))

    def of(self, op):
        rows = []
        if op["view"] in self.views:
            method, *figures = self.views[op["view"]]
            rows.append(["shipped config, CPU", method, *figures])
        for lut in self.luts:
            if lut["operator"] == op["id"]:
                way = lut["host_interpolation"]
                # A 1D LUT has only one column of figures.
                figures = [lut[f"{way if way == 'trilinear' else 'tetrahedral'}_{figure}"] for figure in ("max", "p999", "mean")]
                rows.append([f"`luts/{lut['path']}`", f"{lut['size']} {lut['nodes']} nodes, {way}", *figures])
        if not rows:
            return ""
        return "\n".join(["## Errors", "",
                          "Differences of code values (0 to 1) from the double-precision reference. "
                          f"`tonewright verify {op['id']}` measures every backend.", "",
                          "| file | method | max | 99.9 % | mean |", "|---|---|---|---|---|",
                          *(f"| {' | '.join(row)} |" for row in rows)])


def configuration(site, folder, target):
    config = yaml.safe_load((HERE / "mkdocs.yml").read_text())
    choose = next(entry["Choose"] for entry in config["nav"] if "Choose" in entry)
    at = next(i for i, entry in enumerate(choose) if "Operators" in entry)
    pages = [{op["title"]: f"operators/{op['id']}.md"} for op in sorted(site.operators.values(), key=lambda op: op["title"].lower())]
    choose[at] = {"Operators": [{"Index": "operators/index.md"}, *pages]}
    config.update(docs_dir=str(folder), site_dir=str(target))
    return yaml.safe_dump(config, sort_keys=False)


def main():
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    command, target = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "docs"
        folder.mkdir()
        site = Site(command, folder)
        site.write_pages()
        site.write_operators()
        config = pathlib.Path(scratch) / "mkdocs.yml"
        config.write_text(configuration(site, folder, target))
        done = subprocess.run(["mkdocs", "build", "--strict", "--quiet", "--clean", "--config-file", str(config)], check=False)
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
