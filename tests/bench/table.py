# SPDX-License-Identifier: Apache-2.0
"""The benchmark as tables: the engine (tonewright_bench) and whole commands (hyperfine), in Markdown, and as JSON.

    ./run bench [--operators hable,agx_blender] [--picture photo.exr] [--json bench.json]

Everything in one run on one machine: ratios are the figures to keep. On a machine that does other things, too, repeat.
"""

import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

OPERATORS = ("hable,uchimura,reinhard,reinhard:luminance,reinhard_extended,agx_sobotka,aces_hill,reinhard_jodie,"
             "khronos_neutral,agx_blender,aces_13,aces_20")
COMMAND_OPERATORS = "hable,agx_blender,aces_20"
FORMS = ["simd", "simd_two_threads", "simd_all_threads", "ocio_lossless", "ocio_default", "ocio_lut65"]
WIDTH, HEIGHT, FRAMES = 3840, 2160, 100


def call(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"bench: {shlex.join(map(str, arguments))}: exit {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def table(title, header, rows):
    print(f"\n{title}\n\n| {' | '.join(header)} |\n|{'---|' * len(header)}")
    for row in rows:
        print(f"| {' | '.join(row)} |")


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


# --------------------------------------------------------------------------------------------------
# Whole commands


def hyperfine(commands, runs, scratch):
    """[{median, mean, user, system}] in seconds"""
    out = scratch / "hyperfine.json"
    subprocess.run(["hyperfine", "--style", "basic", "--warmup", "1", "--runs", str(runs), "--export-json", out,
                    *commands], stdout=sys.stderr, stderr=sys.stderr, check=True)
    return json.loads(out.read_text())["results"]


def error_of(shown, truth):
    done = subprocess.run(["oiiotool", shown, truth, "--diff"], capture_output=True, text=True, check=False)
    found = re.search(r"Max error *= *(\S+)", done.stdout)
    return float(found[1]) if found else 0.0 if "PASS" in done.stdout else None


def make_picture(given, scratch):
    """A half float EXR of 4K, compressed with ZIP."""
    path = scratch / "in.exr"
    call("oiiotool", given, "--ch", "R,G,B", "--resize", f"{WIDTH}x{HEIGHT}", "-d", "half", "--compression", "zip",
         "-o", path)
    return path


def run_commands(command, operators, picture, runs, scratch):
    """One row for each operator and kind of output."""
    views = dict(line.split("\t") for line in call(command, "list", "--views").splitlines())
    config = scratch / "config"
    call(command, "config", "-o", config, "--views", ",".join(dict.fromkeys(o.partition(":")[0] for o in operators)))
    log = scratch / "log.exr"
    call("oiiotool", "--colorconfig", config / "config.ocio", picture, "--colorconvert", "lin_rec709", "ACEScct",
         "-d", "half", "-o", log)
    rows = []
    for name in operators:
        truth, cube = scratch / "truth.exr", scratch / "lut.cube"
        call(command, "apply", picture, truth, "--operator", name, "-d", "float")
        call(command, "bake", name, "-o", cube, "--3d", "--size", 65, "--input-encoding", "acescct")
        for kind, depth in (("exr", "half"), ("png", "uint16")):
            out = {what: scratch / f"{what}.{kind}" for what in ("io", "apply", "ociodisplay", "ffmpeg")}
            lines = {
                "io": f"oiiotool {picture} -d {depth} -o {out['io']}",
                "apply": f"{command} apply {picture} {out['apply']} --operator {name} -d {depth}",
                "ociodisplay": f"oiiotool --colorconfig {config}/config.ocio {picture} --ociodisplay sRGB "
                               f"{shlex.quote(views[name])} -d {depth} -o {out['ociodisplay']}",
            }
            if kind == "png" and shutil.which("ffmpeg"):
                lines["ffmpeg"] = (f"ffmpeg -v error -nostdin -y -i {log} -vf lut3d={cube}:interp=tetrahedral "
                                   f"-pix_fmt rgb48be {out['ffmpeg']}")
            row = {"operator": name, "output": f"{kind}, {depth}"}
            for what, result in zip(lines, hyperfine(list(lines.values()), runs, scratch)):
                row[what] = {"seconds": result["median"], "processor_seconds": result["user"] + result["system"],
                             "max_error": None if what == "io" else error_of(out[what], truth)}
            rows.append(row)
    return rows


def run_frames(command, picture, runs, scratch):
    """A shot of HD frames, as one command and as a loop."""
    call("oiiotool", picture, "--resize", "1920x1080", "-d", "half", "-o", scratch / "shot.1001.exr")
    for i in range(1002, 1001 + FRAMES):
        shutil.copy(scratch / "shot.1001.exr", scratch / f"shot.{i}.exr")
    rows = []
    for kind, depth in (("exr", "half"), ("png", "uint16")):
        options = f"--operator hable -d {depth}"
        numbers = f"1001 {1000 + FRAMES}"
        loop, frames = hyperfine(
            [f"for i in $(seq {numbers}); do {command} apply {scratch}/shot.$i.exr {scratch}/loop.$i.{kind} {options}; "
             "done",
             f"{command} apply {scratch}/shot.####.exr {scratch}/out.####.{kind} --frames {numbers.replace(' ', '-')} "
             f"{options}"], runs, scratch)
        rows.append({"output": f"{kind}, {depth}", "loop": FRAMES / loop["median"], "frames": FRAMES / frames["median"],
                     "processors": (frames["user"] + frames["system"]) / frames["mean"]})
    return rows


def print_commands(rows, frames, start):
    pixels = WIDTH * HEIGHT / 1e6
    shown = []
    for row in rows:
        seconds = {what: row.get(what, {}).get("seconds") for what in ("apply", "io", "ociodisplay", "ffmpeg")}
        shown.append([f"`{row['operator']}`", row["output"], *map(number, seconds.values()),
                      number(pixels / seconds["apply"]),
                      *(times(seconds["apply"], seconds[what]) for what in ("io", "ociodisplay", "ffmpeg")),
                      *(number(row.get(what, {}).get("max_error"), 2) for what in ("apply", "ociodisplay", "ffmpeg"))])
    table(f"Seconds of whole commands, {WIDTH}x{HEIGHT}, half EXR in; errors against `apply -d float`, the output's "
          "rounding included. ffmpeg is given the picture in ACEScct.",
          ["operator", "out", "apply", "oiiotool, only read and write", "oiiotool --ociodisplay", "ffmpeg lut3d",
           "apply, Mpix/s", "of read and write", "of --ociodisplay", "of ffmpeg", "error", "--ociodisplay", "ffmpeg"],
          shown)
    table(f"Frames per second, {FRAMES} of 1920x1080, `hable`",
          ["out", "a shell loop", "`--frames`", "times", "processors busy"],
          [[row["output"], number(row["loop"]), number(row["frames"]), times(row["frames"], row["loop"]),
            number(row["processors"])] for row in frames])
    print(f"\n`eval` of one color: {1000 * start:.0f} ms\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0],
                                     epilog="Further arguments go to the benchmark of the engine: --target=AVX2, or "
                                     "Google Benchmark's, as --benchmark_repetitions=5.")
    parser.add_argument("bench", type=Path)
    parser.add_argument("command", type=Path)
    parser.add_argument("--operators", default=OPERATORS)
    parser.add_argument("--command-operators", default=COMMAND_OPERATORS, help="for the whole commands")
    parser.add_argument("--picture", type=Path, help="for the whole commands (default: the chart)")
    parser.add_argument("--runs", type=int, default=5, help="of each whole command")
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
            picture = make_picture(picture, scratch)
            operators = arguments.command_operators.split(",")
            results["commands"] = run_commands(command, operators, picture, arguments.runs, scratch)
            results["frames"] = run_frames(command, picture, max(arguments.runs // 2, 1), scratch)
            start = hyperfine([f"echo 0.18 0.18 0.18 | {command} eval hable"], 20, scratch)[0]
            results["eval_seconds"] = start["median"]
            print_commands(results["commands"], results["frames"], start["median"])
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
