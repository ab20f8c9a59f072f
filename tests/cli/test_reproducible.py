# SPDX-License-Identifier: Apache-2.0
"""The same bytes in another time zone, locale, umask, number of cores, and from another path of the program.

All shipped LUTs, the config, a shader, numbers, pictures and a page, each written twice without a cache. Pictures that no other
picture gives a date take that of SOURCE_DATE_EPOCH. --other names the command of another build: that one writes the second
files.
"""

import filecmp
import os
import shutil
import subprocess

import pytest

# Both write decimal commas; Turkish has another lower case of I.
LOCALES = ("de_DE", "tr_TR")
CORES = sorted(os.sched_getaffinity(0))
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


@pytest.fixture(scope="module")
def locales(folder):
    """The folder of LOCALES, and those that could be made in it."""
    (folder / "locales").mkdir()
    return folder / "locales", make_locales(folder / "locales")


@pytest.fixture
def first(report, command, folder, locales):
    """Files of all JOBS."""
    if not (folder / "first").exists():
        run_jobs(report, command, folder / "first", locales[0], JOBS, "UTC", "C.UTF-8", "022", CORES)
    return folder / "first"


def test_date(report, command, first, scratch):
    # 1700000000 seconds after 1970, by `date -u -d @1700000000`.
    report.check("the date of a picture", b"2023:11:14 22:13:20" in (first / "chart.exr").read_bytes())
    wrong = subprocess.run([command, "chart", "-o", scratch / "wrong.exr", "-q"], capture_output=True, text=True, check=False,
                           env={**os.environ, "SOURCE_DATE_EPOCH": "today"})
    report.check("a wrong SOURCE_DATE_EPOCH", wrong.returncode == 2 and "SOURCE_DATE_EPOCH is today" in wrong.stderr
                 and not (scratch / "wrong.exr").exists(), wrong.stderr)


def test_elsewhere(request, report, command, folder, locales, first):
    other = request.config.getoption("--other") or command
    if not locales[1]:
        print("no locale could be made (Debian: locales); the second files are written in C.UTF-8")
    for number, locale in enumerate(locales[1] or ["C"]):
        jobs = JOBS if number == 0 else SHORT_JOBS
        place = folder / "elsewhere" / f"with a blank {number}"
        run_jobs(report, other.resolve(), place, locales[0], jobs, "Asia/Kathmandu", f"{locale}.UTF-8", "077", CORES[:1])
        written = files(place)
        missing = files(first) - written if jobs == JOBS else written - files(first)
        report.check(f"{locale}: {len(written)} files", written and not missing, missing)
        differ = [path for path in sorted(written)
                  if path not in missing and not filecmp.cmp(first / path, place / path, shallow=False)]
        report.check(f"{locale}: the same bytes", not differ, f"{len(differ)}: {differ[:10]}")
