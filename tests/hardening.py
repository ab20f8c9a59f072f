#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command, its libraries, the plugin and the Python module are hardened: reads their ELF files.

BIND_NOW and RELRO, stack protectors, checked calls of _FORTIFY_SOURCE, and on x86-64 objects that are marked for
indirect branch tracking. The linker marks a whole file only where the system's own start files are marked, too, so the
objects count.

Usage: hardening.py BUILD
"""
import json
import pathlib
import platform
import re
import subprocess
import sys


def readelf(*arguments):
    return subprocess.run(["readelf", "-W", *map(str, arguments)], capture_output=True, text=True, check=True).stdout


def undefined(path):
    listing = subprocess.run(["nm", "-D", "--undefined-only", path], capture_output=True, text=True, check=True).stdout
    return {line.split()[-1].split("@")[0] for line in listing.splitlines()}


def main(build: pathlib.Path) -> int:
    commands = [c for c in json.loads((build / "compile_commands.json").read_text())
                if re.search(r" -o src/\S+\.o\b", c["command"]) and "cmake_pch" not in c["command"]]
    if any("-fsanitize" in c["command"] for c in commands):
        print("skipped: a build with sanitizers")
        return 77
    failed = []

    def check(what, ok):
        print("ok  " if ok else "FAIL", what)
        if not ok:
            failed.append(what)

    files = sorted({*build.glob("lib/libtonewright_*.so"), *build.glob("lib/OpenImageIO-*/*.so"), build / "bin/tonewright",
                    *build.glob("libexec/tonewright/*.so"), *build.glob("python/tonewright/*.so")})
    check(f"{len(files)} files", len(files) >= 5)
    checked = set()
    for path in files:
        name = path.relative_to(build)
        check(f"{name}: BIND_NOW", re.search(r"\(FLAGS(_1)?\).*\b(BIND_)?NOW\b", readelf("-d", path)))
        check(f"{name}: RELRO", "GNU_RELRO" in readelf("-l", path))
        symbols = undefined(path)
        check(f"{name}: stack protector", "__stack_chk_fail" in symbols)
        checked |= {s for s in symbols if s.endswith("_chk")}
    if "-D_FORTIFY_SOURCE" in commands[0]["command"]:
        check(f"checked calls: {', '.join(sorted(checked))}", checked)
    if platform.machine() == "x86_64":
        objects = [build / re.search(r" -o (\S+)", c["command"]).group(1) for c in commands]
        objects = [o for o in objects if o.exists()]
        bare = [o.name for o in objects if not re.search(r"x86 feature: .*IBT.*SHSTK", readelf("-n", o))]
        check(f"{len(objects)} objects marked for CET", objects and not bare)
        print("\n".join(bare))
    print(f"{int(not failed)} passed, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
