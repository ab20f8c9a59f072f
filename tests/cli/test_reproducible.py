# SPDX-License-Identifier: Apache-2.0
"""The same bytes in another time zone, locale, umask, number of cores, and from another path of the program.

    python3 tests/cli/test_reproducible.py build/release/bin/tonewright [OTHER_COMMAND]

All shipped LUTs, the config, a shader, numbers, pictures and a page, each written twice without a cache. Pictures that no other
picture gives a date take that of SOURCE_DATE_EPOCH. OTHER_COMMAND is the command of another build: then that one writes the
second files. The last line is `N passed, M failed`.
"""

import argparse
import filecmp
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity" / "clients"))
from pictures import Report  # noqa: E402

# Both write decimal commas; Turkish has another lower case of I.
LOCALES = ("de_DE", "tr_TR")
JOBS = {
    "eval": "printf '0.18 1 2\\n' | tonewright eval agx_blender >numbers.txt",
    "shader": "tonewright shader aces_20 --language glsl -q -o shader.glsl",
    "bake": "tonewright bake agx_sobotka --format icc -q -o link.icc; tonewright bake hable --format hald -q -o hald.png",
    # The second time is seconds later: the time of writing would differ.
    "pictures": "for e in exr tif dpx png jpg; do tonewright chart -o chart.$e --width 320 --height 180 -q; done; "
                "tonewright apply chart.exr shown.tif --operator hable -q; tonewright compare chart.exr hable -o sheet.exr -q",
    "page": "tonewright report -o page.html --operators hable,reinhard_local -q",
    "config": "tonewright config -q -o config; tonewright config --archive config.ocioz --profile 2.5 -q",
    "bake --all": "tonewright bake --all luts -q",
}
SHORT_JOBS = {name: text for name, text in JOBS.items() if name not in ("config", "bake --all")}


def make_locales(folder):
    """Names of the locales that could be made below a folder, without the rights of root."""
    made = []
    for name in LOCALES:
        if shutil.which("localedef"):
            subprocess.run(["localedef", "-i", name, "-f", "UTF-8", folder / f"{name}.UTF-8"], capture_output=True, check=False)
        if (folder / f"{name}.UTF-8").is_dir():
            made.append(name)
    return made


def run_jobs(report, command, folder, locales, jobs, zone, locale, mask, cores):
    folder.mkdir(parents=True)
    program = folder / ".bin"
    program.mkdir()
    (program / "tonewright").write_text(f'#!/bin/sh\nexec "{command}" "$@"\n')
    (program / "tonewright").chmod(0o755)
    environment = {"PATH": f"{program}:/usr/bin:/bin", "HOME": str(folder), "XDG_CACHE_HOME": str(folder / ".cache"),
                   "TZ": zone, "SOURCE_DATE_EPOCH": "1700000000", "LC_ALL": locale, "LANG": locale, "LOCPATH": str(locales),
                   **{name: value for name, value in os.environ.items() if name.startswith("LD_LIBRARY")}}
    for name, text in jobs.items():
        line = ["taskset", "-c", ",".join(map(str, cores)), "sh", "-euc", f"umask {mask}; {text}"]
        done = subprocess.run(line, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        report.check(f"{name}: {locale}, {zone}, umask {mask}, {len(cores)} cores", done.returncode == 0, done.stderr)


def files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*")
            if path.is_file() and not str(path.relative_to(folder)).startswith(".")}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    parser.add_argument("other", type=Path, nargs="?")
    arguments = parser.parse_args()
    report = Report()
    with tempfile.TemporaryDirectory(prefix="tonewright-") as name:
        scratch = Path(name)
        locales = scratch / "locales"
        locales.mkdir()
        made = make_locales(locales)
        if not made:
            print("no locale could be made (Debian: locales); the second files are written in C.UTF-8")
        cores = sorted(os.sched_getaffinity(0))
        command = arguments.command.resolve()
        first = scratch / "first"
        run_jobs(report, command, first, locales, JOBS, "UTC", "C.UTF-8", "022", cores)
        # 1700000000 seconds after 1970, by `date -u -d @1700000000`.
        report.check("the date of a picture", b"2023:11:14 22:13:20" in (first / "chart.exr").read_bytes())
        wrong = subprocess.run([command, "chart", "-o", scratch / "wrong.exr", "-q"], capture_output=True, text=True, check=False,
                               env={**os.environ, "SOURCE_DATE_EPOCH": "today"})
        report.check("a wrong SOURCE_DATE_EPOCH", wrong.returncode == 2 and "SOURCE_DATE_EPOCH is today" in wrong.stderr
                     and not (scratch / "wrong.exr").exists(), wrong.stderr)
        for number, locale in enumerate(made or ["C"]):
            jobs = JOBS if number == 0 else SHORT_JOBS
            folder = scratch / "elsewhere" / f"with a blank {number}"
            run_jobs(report, (arguments.other or command).resolve(), folder, locales, jobs, "Asia/Kathmandu",
                     f"{locale}.UTF-8", "077", cores[:1])
            written = files(folder)
            missing = files(first) - written if jobs == JOBS else written - files(first)
            report.check(f"{locale}: {len(written)} files", written and not missing, missing)
            differ = [path for path in sorted(written)
                      if path not in missing and not filecmp.cmp(first / path, folder / path, shallow=False)]
            report.check(f"{locale}: the same bytes", not differ, f"{len(differ)}: {differ[:10]}")
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
