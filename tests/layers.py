#!/usr/bin/env python3
"""Dependencies between the folders of src/ run one way, and so do those between its files (a header and its source are one
unit); this reads the #include lines. No text below the front ends has an option of the command: errors and warnings there
refer to parameters, `<<size=65>>` (error.h).

Usage: layers.py SRC
"""
import graphlib
import pathlib
import re
import sys

# Folders in the order of the floors, lowest first. A folder includes itself and what stands here.
BELOW = {"base": []}
for folder, direct in {
    "expr": ["base"],
    "formula": ["expr"],  # text -> expressions
    "color": ["expr"],
    "pipeline": ["color"],
    "operators": ["pipeline"],
    "definition": ["pipeline", "formula"],  # .tone files
    "engine": ["operators"],
    "measure": ["engine"],
    "local": ["measure"],
    "registry": ["local", "definition"],
    "lut": ["registry"],
    "shader": ["registry"],
    "ocio": ["lut"],
    "image": ["lut"],
    "verify": ["ocio", "shader"],
    "report": ["base"],  # the page as a file
    "plot": ["engine"],
    "shader_runs": ["verify"],
    "tasks": ["report", "verify"],  # what the command and the Python module do
    "tasks/pictures": ["tasks", "image"],
    "cli": ["plot", "tasks", "shader_runs"],
    "cli/pictures": ["cli", "tasks/pictures"],  # the module that the program loads
    "tools": ["cli"],
    "plugin": ["image"],
    "python": ["tasks/pictures", "shader_runs"],
}.items():
    BELOW[folder] = sorted(set(direct).union(*(BELOW[d] for d in direct)))
# Public header -> the folder that it belongs to.
PUBLIC = {
    "version": "base", "error": "base", "span": "base", "generated_files": "base", "expr": "expr", "color": "color",
    "pipeline": "pipeline", "view": "pipeline", "input_encoding": "pipeline", "source_color": "pipeline", "format_color": "pipeline", "engine": "engine", "local": "local", "registry": "registry", "definition": "definition",
    "lut": "lut", "lut_applications": "lut", "ocio": "ocio", "lut_file": "ocio", "tonemap": "image",
    "image_io": "image", "chart": "image", "contact_sheet": "image", "sequence": "image", "meter": "image",
    "shader": "shader", "verify": "verify", "lint": "verify", "lut_match": "verify",
}
THIRD_PARTY = {
    "hwy": ["engine", "image"],
    "OpenColorIO": ["ocio", "verify"],
    "OpenImageIO": ["image", "tasks/pictures", "cli/pictures", "plugin", "python"],
    "EGL": ["ocio"],
    "yaml-cpp": ["ocio"],
    "lcms2.h": ["lut"],
    "expat.h": ["lut/formats/xml.cpp"],
    "GL": ["ocio"],
    "cairo-pdf.h": ["plot/cairo_surface.cpp"],
    "xbyak": ["engine"],
    "CLI": ["cli/options.cpp"],  # one file each: they take seconds to compile
    "nlohmann": ["tasks/json.cpp"],
    "toml++": ["definition/toml_text.cpp"],
    "pybind11": ["python"],
    "fmt": ["base", "engine", "measure", "lut", "shader", "definition", "ocio", "image", "verify", "shader_runs", "plot", "tasks", "tasks/pictures", "cli", "cli/pictures", "tools", "plugin", "python"],
}
# They have names of their own for the parameters of a request.
FRONT_ENDS = {"cli", "cli/pictures", "tools", "python", "plugin", "definition"}
# Their options may have the same names as ours.
OTHER_PROGRAMS = re.compile(r"oiiotool|mpv|glslangValidator|iscolorspace")
# Text of the files that the command writes, for its users.
GENERATED = {("ocio/operator_facts.cpp", "operator"), ("ocio/added_record.cpp", "into"),
             ("ocio/added_record.cpp", "update"), ("ocio/added_record.cpp", "remove")}
# Headers whose types the parts behind them use: the files are one unit.
PARTS = {
    "engine/curve_fit": "engine/compiled_curve",
    "formula/glsl_cursor": "formula/glsl", "formula/glsl_frames": "formula/glsl", "formula/glsl_parser": "formula/glsl",
}
# Front ends put the command's name before a message.
COMMAND = re.compile(r'"(?:apply|bake|chart|check|compare|config|eval|import|info|list|meter|plot|report|shader|sheet|verify): ')
# It names the config that a row of the parity table is about.
NO_COMMAND = {"verify/verify.cpp"}
LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"')


def folder_of(parts):
    return "/".join(parts[:2]) if "/".join(parts[:2]) in BELOW else parts[0]


def unit_of(path):
    """A file's name without its ending; a public header has one of its own."""
    name = pathlib.PurePath(path).with_suffix("").as_posix().removeprefix("include/")
    return PARTS.get(name, name)


def own_options(src):
    """The names of the options that the command declares, without --."""
    text = "".join(path.read_text() for path in (src / "cli").glob("*.cpp"))
    declared = re.findall(r'"(?:-\w,)?((?:--[a-z0-9-]+,?)+)"', text)
    return {name for names in declared for name in re.findall(r"--([a-z0-9-]+)", names)}


def options_in(line, options):
    if OTHER_PROGRAMS.search(line):
        return []
    words = [word for literal in LITERAL.findall(line) for word in re.findall(r"--([a-z0-9][a-z0-9-]*)", literal)]
    return [word for word in words if word in options]


def main(src: pathlib.Path) -> int:
    failures, count = [], 0
    included = {}  # units by unit
    options = own_options(src)
    if len(options) < 100:
        failures.append(f"only {len(options)} options are found in cli/")
    for path in sorted(src.rglob("*")):
        if path.suffix not in (".cpp", ".h"):
            continue
        parts = path.relative_to(src).parts
        folder = PUBLIC[path.stem] if parts[0] == "include" else folder_of(parts)
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if folder not in FRONT_ENDS:
                file = path.relative_to(src).as_posix()
                failures += [f"{file}:{number}: a text has the option --{option}; expected <<PARAMETER=VALUE>>"
                             for option in options_in(line, options) if (file, option) not in GENERATED]
                if COMMAND.search(line) and file not in NO_COMMAND:
                    failures.append(f"{file}:{number}: a text begins with a command's name; front ends put it there")
            match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
            if not match:
                continue
            count += 1
            target = match.group(2)
            first = target.split("/")[0]
            if match.group(1) == '"' and (one := unit_of(path.relative_to(src))) != (other := unit_of(target)):
                included.setdefault(one, set()).add(other)
            where = f"{path.relative_to(src)}:{number}: {folder} includes {target}"
            if first == "tonewright":
                owner = PUBLIC.get(pathlib.Path(target).stem)
                if owner is None:
                    failures.append(where + ": unknown public header")
                elif owner != folder and owner not in BELOW[folder]:
                    failures.append(where + f", of {owner}")
            elif match.group(1) == '"' and first in BELOW:
                owner = folder_of(target.split("/"))
                if owner != folder and owner not in BELOW[folder]:
                    failures.append(where)
            elif first in THIRD_PARTY and not {folder, "/".join(parts)} & set(THIRD_PARTY[first]):
                failures.append(where)
    try:
        graphlib.TopologicalSorter(included).prepare()
    except graphlib.CycleError as e:
        failures.append("a circle: " + " <- ".join(e.args[1]))
    for failure in failures:
        print(failure)
    print(f"layers: {count} includes read")
    print(f"{1 if not failures else 0} passed, {len(failures)} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
