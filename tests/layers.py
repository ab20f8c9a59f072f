#!/usr/bin/env python3
"""Dependencies between the folders of src/ run one way, and so do those between its files (a header and its source are one
unit); this reads the #include lines. No string literal below the front ends names an option or a command of tonewright: errors
and warnings there refer to parameters, `<<size=65>>` (error.h). Adjacent literals are one text, as for the compiler.

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
    "picture": ["lut"],  # files by their own libraries
    "image": ["picture"],
    "verify": ["ocio", "shader"],
    "report": ["base"],  # the page as a file
    "plot": ["engine"],
    "shader_runs": ["verify"],
    "tasks": ["report", "verify"],  # what the command and the Python module do
    "tasks/pictures": ["tasks", "image"],
    "cli": ["plot", "tasks", "shader_runs"],
    "cli/rows": ["cli", "picture"],  # the module that needs no OpenImageIO
    "cli/pictures": ["cli/rows", "tasks/pictures"],  # the module of all picture commands
    "tools": ["cli"],
    "plugin": ["image"],
    "python": ["tasks/pictures", "shader_runs"],
}.items():
    BELOW[folder] = sorted(set(direct).union(*(BELOW[d] for d in direct)))
# Public header -> the folder that it belongs to.
PUBLIC = {
    "version": "base", "error": "base", "span": "base", "generated_files": "base", "expr": "expr", "color": "color",
    "pipeline": "pipeline", "view": "pipeline", "input_encoding": "pipeline", "source_color": "pipeline", "format_color": "pipeline", "engine": "engine", "local": "local", "registry": "registry", "engines": "registry", "definition": "definition",
    "lut": "lut", "lut_applications": "lut", "ocio": "ocio", "lut_file": "ocio", "tonemap": "image", "tonemap_options": "picture", "picture_options": "picture",
    "image_io": "image", "chart": "image", "contact_sheet": "image", "sequence": "image", "meter": "image",
    "shader": "shader", "verify": "verify", "lint": "verify", "lut_match": "verify",
}
THIRD_PARTY = {
    "hwy": ["engine", "image", "picture"],
    "OpenColorIO": ["ocio", "verify"],
    "OpenEXR": ["picture", "image"],
    "libdeflate.h": ["picture"],
    "jpeglib.h": ["picture"],
    "png.h": ["picture"],
    "zlib.h": ["picture"],
    "OpenImageIO": ["picture", "image", "tasks/pictures", "cli/rows", "cli/pictures", "plugin", "python"],
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
    "fmt": ["base", "engine", "measure", "lut", "shader", "definition", "ocio", "picture", "image", "verify", "shader_runs", "plot", "tasks", "tasks/pictures", "cli", "cli/rows", "cli/pictures", "tools", "plugin", "python"],
}
# They have names of their own for the parameters of a request.
FRONT_ENDS = {"cli", "cli/rows", "cli/pictures", "tools", "python", "plugin", "definition"}
# A text that names one of them before an option is about theirs, which may have the same name.
OTHER_PROGRAMS = re.compile(r"\b(?:oiiotool|mpv|ffmpeg|gmic|tificc)\b")
# Lists of arguments of other programs are no texts.
ARGUMENTS = {("shader_runs/c_compiler.cpp", "-o"), ("shader_runs/dawn.cpp", "-o"), ("shader_runs/dawn.cpp", "--quiet")}
# File -> a file that the command writes for its users, and the options and commands that its text names.
GENERATED = {
    "lut/shipped_set.cpp": ("README of the shipped LUTs", ["-o", "tonewright bake", "tonewright chart", "tonewright shader"]),
    "ocio/added_record.cpp": ("comment of a changed config", ["--into", "--update", "--remove", "tonewright config"]),
    "ocio/config.cpp": ("README of a config", ["tonewright config"]),
    "ocio/operator_facts.cpp": ("description of a view in a config", ["--operator"]),
    "shader/shader.cpp": ("comment of a shader", ["tonewright verify"]),
}
# Headers whose types the parts behind them use: the files are one unit.
PARTS = {
    "engine/curve_fit": "engine/compiled_curve",
    "formula/glsl_cursor": "formula/glsl", "formula/glsl_frames": "formula/glsl", "formula/glsl_parser": "formula/glsl",
}
# It names the config that a row of the parity table is about.
NO_COMMAND = {("verify/verify.cpp", "config: ")}
# A quote after a digit separates thousands.
TOKEN = re.compile(r"""(?P<comment>//[^\n]*|/\*.*?\*/)|(?<![0-9a-fA-F])'(?:[^'\\\n]|\\.)+'
                   |(?<!\w)(?:u8|u|U|L)?R"(?P<mark>[^\s()\\]*)\((?P<raw>.*?)\)(?P=mark)"
                   |"(?P<plain>(?:[^"\\\n]|\\.)*)\"""", re.S | re.X)


def folder_of(parts):
    return "/".join(parts[:2]) if "/".join(parts[:2]) in BELOW else parts[0]


def unit_of(path):
    """A file's name without its ending; a public header has one of its own."""
    name = pathlib.PurePath(path).with_suffix("").as_posix().removeprefix("include/")
    return PARTS.get(name, name)


def own_words(src):
    """The options that the command declares, with their dashes, and its commands."""
    text = "".join(path.read_text() for path in sorted((src / "cli").rglob("*.cpp")))
    declared = re.findall(r'(?<!\{)"((?:-\w|--[a-z0-9-]+)(?:,--[a-z0-9-]+)*)"', text)
    return {name for names in declared for name in names.split(",")}, set(re.findall(r'\bprogram\s*\.add\(\s*"([a-z]+)"', text))


def texts(code):
    """String literals, adjacent ones joined, as lists of (line, contents); an escape sequence becomes two blanks."""
    joined, end = [], None
    for match in TOKEN.finditer(code):
        raw, plain = match["raw"], match["plain"]
        is_next = end is not None and not code[end:match.start()].strip()
        if raw is None and plain is None:
            end = match.end() if is_next and match["comment"] else None
            continue
        if not is_next:
            joined.append([])
        piece = raw if plain is None else re.sub(r"\\.", "  ", plain)
        line = code.count("\n", 0, match.start()) + 1
        joined[-1] += [(line + number, part) for number, part in enumerate(piece.splitlines(keepends=True))]
        end = match.end()
    return joined


def named(code, options, commands):
    """(line, word) for each own option, `tonewright COMMAND` and `COMMAND: ` at the beginning, of the texts of a file."""
    any_command = "|".join(sorted(commands))
    pattern = re.compile(rf"(?<![\w-])--?[a-z0-9][a-z0-9-]*|\btonewright\s+(?:{any_command})\b|\A(?:{any_command}): ")
    for pieces in texts(code):
        text = "".join(piece for _, piece in pieces)
        for match in pattern.finditer(text):
            word = re.sub(r"\s+", " ", match.group())
            if word.startswith("-") and (word not in options or OTHER_PROGRAMS.search(text, 0, match.start())):
                continue
            at = match.start()
            for line, piece in pieces:
                if at < len(piece):
                    break
                at -= len(piece)
            yield line, word


def main(src: pathlib.Path) -> int:
    failures, count = [], 0
    included = {}  # units by unit
    options, commands = own_words(src)
    if len(options) < 120 or len(commands) < 15:
        failures.append(f"only {len(options)} options and {len(commands)} commands are found in cli/")
    allowed = {*ARGUMENTS, *NO_COMMAND, *((file, word) for file, (_, words) in GENERATED.items() for word in words)}
    used = set()
    for path in sorted(src.rglob("*")):
        if path.suffix not in (".cpp", ".h"):
            continue
        parts = path.relative_to(src).parts
        folder = PUBLIC[path.stem] if parts[0] == "include" else folder_of(parts)
        code, file = path.read_text(), path.relative_to(src).as_posix()
        if folder not in FRONT_ENDS:
            for number, word in named(code, options, commands):
                used.add((file, word))
                if (file, word) not in allowed:
                    better = "front ends put it there" if word.endswith(": ") else "expected <<PARAMETER=VALUE>>"
                    failures.append(f"{file}:{number}: a text names `{word}`; {better}")
        for number, line in enumerate(code.splitlines(), 1):
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
    failures += [f"layers.py: nothing needs {entry}" for entry in sorted(allowed - used)]
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
