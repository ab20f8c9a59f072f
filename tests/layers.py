#!/usr/bin/env python3
"""Dependencies between the folders of src/ run one way; this reads the #include lines.

Usage: layers.py SRC
"""
import pathlib
import re
import sys

# Each folder may include itself and the folders named here; third-party headers only where listed.
BELOW = {
    "expr": [],
    "color": ["expr"],
    "pipeline": ["color", "expr"],
    "operators": ["pipeline", "color", "expr"],
    "engine": ["operators", "pipeline", "color", "expr"],
    "lut": ["engine", "operators", "pipeline", "color", "expr"],
    "ocio": ["lut", "engine", "operators", "pipeline", "color", "expr"],
    "image": ["lut", "engine", "operators", "pipeline", "color", "expr"],
    "verify": ["image", "ocio", "lut", "engine", "operators", "pipeline", "color", "expr"],
    "cli": ["verify", "image", "ocio", "lut", "engine", "operators", "pipeline", "color", "expr"],
}
# Public header -> the folder that it belongs to.
PUBLIC = {
    "error": "expr", "expr": "expr", "color": "color", "pipeline": "pipeline", "view": "pipeline",
    "engine": "engine", "lut": "lut", "ocio": "ocio", "image": "image", "meter": "image", "verify": "verify",
    "lint": "verify", "lut_match": "verify", "lut_file": "ocio",
}
THIRD_PARTY = {
    "hwy": ["engine"],
    "OpenColorIO": ["ocio", "verify"],
    "OpenImageIO": ["image", "cli", "verify"],
    "EGL": ["ocio"],
    "yaml-cpp": ["ocio"],
    "lcms2.h": ["lut"],
    "GL": ["ocio"],
    "xbyak": ["engine"],
    "CLI": ["cli"],
    "nlohmann": ["cli"],
    "fmt": ["lut", "ocio", "image", "verify", "cli"],
}


def main(src: pathlib.Path) -> int:
    failures, count = [], 0
    for path in sorted(src.rglob("*")):
        if path.suffix not in (".cpp", ".h"):
            continue
        parts = path.relative_to(src).parts
        folder = PUBLIC[path.stem] if parts[0] == "include" else parts[0]
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
            if not match:
                continue
            count += 1
            target = match.group(2)
            first = target.split("/")[0]
            where = f"{path.relative_to(src)}:{number}: {folder} includes {target}"
            if first == "tonewright":
                owner = PUBLIC.get(pathlib.Path(target).stem)
                if owner is None:
                    failures.append(where + ": unknown public header")
                elif owner != folder and owner not in BELOW[folder]:
                    failures.append(where + f", of {owner}")
            elif match.group(1) == '"' and first in BELOW:
                if first != folder and first not in BELOW[folder]:
                    failures.append(where)
            elif first in THIRD_PARTY and folder not in THIRD_PARTY[first]:
                failures.append(where)
    for failure in failures:
        print(failure)
    print(f"layers: {count} includes read")
    print(f"{1 if not failures else 0} passed, {len(failures)} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
