#!/usr/bin/env python3
"""Folders of src/ depend on each other in one direction by linkage, too: reads the compiled symbols.

An object file may leave a symbol of Tonewright undefined only if an object of its own folder or of a
folder below it (layers.py) defines the symbol. No library that is installed starts a process. picture/ uses headers of
OpenImageIO, but none of its libraries.

Usage: symbols.py BUILD
"""
import json
import pathlib
import re
import subprocess
import sys

from layers import BELOW, folder_of

# They start processes.
STARTERS = {"fork", "vfork", "clone", "posix_spawn", "posix_spawnp", "execl", "execle", "execlp", "execv", "execve", "execvp",
            "execvpe", "fexecve", "popen", "system"}
INSTALLED = {f"tonewright_{name}.dir" for name in ("core", "ocio", "picture", "image")}
NAMESPACE = "10tonewright"  # as it is mangled


def main(build: pathlib.Path) -> int:
    # Only what the build is made of now: the folder may hold objects of files that have moved.
    commands = json.loads((build / "compile_commands.json").read_text())
    outputs = (re.search(r" -o (\S+)", command["command"]).group(1) for command in commands)
    objects = sorted({build / output for output in outputs if output.startswith("src/") and output.endswith(".o")})
    missing = [path for path in objects if not path.exists()]
    if missing:
        print(f"symbols: {missing[0]} is not built")
        return 1
    defined, wanted, starters, libraries = {}, [], [], []
    listing = subprocess.run(["nm", "--print-file-name", *map(str, objects)], capture_output=True, text=True,
                             check=True).stdout
    for line in listing.splitlines():
        name, _, rest = line.partition(":")
        kind, symbol = rest.split()[-2:]
        path = pathlib.Path(name)
        if kind == "U" and symbol in STARTERS and INSTALLED & set(path.parts):
            starters.append(f"{path}: a library calls {symbol}()")
        if kind == "U" and "tonewright_picture.dir" in path.parts and re.match(r"_ZN?K?\d+OpenImageIO", symbol):
            libraries.append(f"{path}: needs {symbol}, of OpenImageIO")
        if NAMESPACE not in symbol:
            continue
        library = next(i for i, part in enumerate(path.parts) if part.endswith(".dir"))
        folder = folder_of(path.parts[library + 1:])
        if kind == "U":
            wanted.append((path.name, folder, symbol))
        else:
            defined.setdefault(symbol, set()).add(folder)
    failures = starters + libraries
    for name, folder, symbol in wanted:
        homes = defined.get(symbol, set())
        if not homes & {folder, *BELOW[folder]}:
            readable = subprocess.run(["c++filt", symbol], capture_output=True, text=True).stdout.strip()
            failures.append(f"{folder}/{name}: needs {readable}, of {', '.join(sorted(homes)) or 'no folder'}")
    for failure in sorted(set(failures)):
        print(failure)
    print(f"symbols: {len(objects)} objects, {len(wanted)} symbols of other files read")
    passed = bool(wanted) and not failures
    print(f"{int(passed)} passed, {len(set(failures)) if failures else int(not passed)} failed")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
