# SPDX-License-Identifier: Apache-2.0
"""The benchmark as tables: the engine (tonewright_bench) and whole commands (commands.py), in Markdown, and as JSON.

    ./run bench [--operators hable,agx_blender] [--picture photo.exr] [--json bench.json]

Everything in one run on one machine: ratios are the figures to keep. On a machine that does other things, too, repeat.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import commands
from commands import call, table

OPERATORS = ("hable,uchimura,reinhard,reinhard:luminance,reinhard_extended,agx_sobotka,aces_hill,reinhard_jodie,"
             "khronos_neutral,agx_blender,aces_13,aces_20")
FORMS = ["simd", "simd_two_threads", "simd_all_threads", "ocio_lossless", "ocio_default", "ocio_lut65"]
WIDTH, HEIGHT = 3840, 2160


def number(x, digits=3):
    return "-" if x is None else f"{x:.{digits}g}" if x < 100 else f"{x:.0f}"


def times(a, b):
    return "-" if a is None or not b else f"{a / b:.2f}" if a < 10 * b else f"{a / b:.0f}"


# --------------------------------------------------------------------------------------------------
# The engine


def run_engine(bench, operators, scratch, extra):
    """{form: {operator: {mpix, of_memcpy, max_error}}}, ns per pixel by size"""
    out = scratch / "engine.json"
    names = "|".join(map(re.escape, operators))
    subprocess.run([bench, f"--benchmark_filter=^(memcpy|({'|'.join(FORMS)})/({names})|size/hable/[0-9]+)/real_time$",
                    f"--benchmark_out={out}", "--benchmark_out_format=json", *extra], stdout=sys.stderr, check=True)
    forms, sizes = {}, {}
    for row in json.loads(out.read_text())["benchmarks"]:
        if row.get("error_occurred") or row.get("run_type") == "aggregate" and row["aggregate_name"] != "median":
            continue
        form, _, operator = row["run_name"].removesuffix("/real_time").partition("/")
        if form == "size":
            sizes[int(operator.split("/")[1])] = 1e9 / row["items_per_second"]
        else:
            forms.setdefault(form, {})[operator] = {"mpix": row["items_per_second"] / 1e6,
                                                    "of_memcpy": row["of_memcpy"], "max_error": row.get("max_error")}
    return forms, sizes


def print_engine(forms, sizes, operators):
    copied = forms["memcpy"][""]["mpix"] / forms["memcpy"][""]["of_memcpy"]  # the best of some, as in all ratios
    rows = []
    for name in operators:
        of = {form: forms.get(form, {}).get(name, {}) for form in FORMS}
        mpix = {form: of[form].get("mpix") for form in FORMS}
        rows.append([f"`{name}`", number(mpix["simd"]), number(of["simd"].get("of_memcpy"), 2),
                     number(mpix["simd_all_threads"]), times(mpix["simd_two_threads"], mpix["simd"]),
                     *(number(mpix[form]) for form in FORMS[3:]),
                     *(times(mpix["simd"], mpix[form]) for form in FORMS[3:]),
                     *(number(of[form].get("max_error"), 2) for form in ["simd"] + FORMS[3:])])
    table(f"Mpix/s, {WIDTH}x{HEIGHT} RGBA float32, sRGB view, one thread unless said; memcpy of the same picture: "
          f"{copied:.0f}. Errors: the largest, in code values.",
          ["operator", "ours", "of memcpy", f"{os.cpu_count()} threads", "two threads, times one", "OCIO lossless",
           "OCIO default", "65^3 LUT in OCIO", "times lossless", "times default", "times LUT", "error", "lossless",
           "default", "LUT"], rows)
    table("`hable`, RGB, one thread: cost of a pixel in pictures of all sizes", ["pixels", "ns a pixel"],
          [[f"{n:.0e}", number(ns)] for n, ns in sorted(sizes.items())])


def run_newer(program, command, operators, scratch):
    """The version of another OpenColorIO, and its Mpix/s of each operator that is a view by itself."""
    views = dict(line.split("\t") for line in call(command, "list", "--views").splitlines())
    chosen = [o for o in operators if o in views]
    call(command, "config", "-o", scratch / "newer", "--views", ",".join(chosen))
    found = json.loads(call(program, "python3", Path(__file__).with_name("newer_ocio.py").resolve(),
                            scratch / "newer" / "config.ocio", *(views[o] for o in chosen)))
    return {"version": found["version"], "operators": {o: found["views"][views[o]] for o in chosen}}


def print_newer(newer, forms):
    rows = []
    for name, of in newer["operators"].items():
        ours = forms["simd"][name]["mpix"]
        rows.append([f"`{name}`", number(ours), number(of["lossless"]), number(of["default"]),
                     times(ours, of["lossless"]), times(ours, of["default"])])
    table(f"The same views in OpenColorIO {newer['version']}, one thread, in place",
          ["operator", "ours, Mpix/s", "without loss", "default", "times without loss", "times default"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0],
                                     epilog="Further arguments go to the benchmark of the engine: --target=AVX2, or "
                                     "Google Benchmark's, as --benchmark_repetitions=5.")
    parser.add_argument("bench", type=Path)
    parser.add_argument("command", type=Path)
    parser.add_argument("--operators", default=OPERATORS)
    parser.add_argument("--picture", type=Path, help="for the whole commands (default: the chart)")
    parser.add_argument("--runs", type=int, default=7, help="of each whole command")
    parser.add_argument("--before", type=Path, help="another build of the command, which takes turns with it")
    parser.add_argument("--only", choices=["engine", "commands"])
    parser.add_argument("--newer-ocio", type=Path, default=os.environ.get("TONEWRIGHT_NEWER_OCIO"),
                        help="a program that runs what follows it with another OpenColorIO's Python")
    parser.add_argument("--json", type=Path, help="write all figures there, too")
    arguments, extra = parser.parse_known_args()
    if arguments.newer_ocio and not shutil.which(arguments.newer_ocio):
        parser.error(f"--newer-ocio is {arguments.newer_ocio}; expected a program")
    os.environ.pop("OCIO", None)
    command = arguments.command.resolve()
    results = {"processors": os.cpu_count()}
    with tempfile.TemporaryDirectory(prefix="tonewright-bench-") as folder:
        scratch = Path(folder)
        if arguments.only != "commands":
            operators = arguments.operators.split(",")
            forms, sizes = run_engine(arguments.bench.resolve(), operators, scratch, extra)
            print_engine(forms, sizes, operators)
            results.update(engine=forms, ns_per_pixel=sizes)
            if arguments.newer_ocio:
                results["newer_ocio"] = run_newer(arguments.newer_ocio, command, operators, scratch)
                print_newer(results["newer_ocio"], forms)
        if arguments.only != "engine":
            picture = arguments.picture
            if not picture:
                picture = scratch / "chart.exr"
                call(command, "chart", "-o", picture, "--width", WIDTH, "--height", HEIGHT, "-d", "half")
            before = arguments.before.resolve() if arguments.before else None
            results["commands"] = commands.run(command, before, picture, arguments.runs, scratch)
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
