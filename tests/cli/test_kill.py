# SPDX-License-Identifier: Apache-2.0
"""`apply --frames` killed (SIGKILL) at random moments, 45 times (`./run test --all`: 100), and gone on with each time.

    python3 tests/cli/test_kill.py build/release/bin/tonewright

After each kill every file under its final name has the bytes of an unbroken run; runs with --skip-existing, killed
themselves, come to the end with these bytes for all frames; and nothing is left of the killed ones. The last line is
`N passed, M failed`.
"""

import argparse
import random
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from shots import apply, contents, leftovers, make_shot  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity" / "clients"))
from pictures import ALL, Report  # noqa: E402

KILLS = {"exr": 34, "png": 33, "tif": 33} if ALL else {"exr": 15, "png": 15, "tif": 15}  # OpenImageIO writes TIFF by itself
FRAMES = 30
STARTS = 4  # kills of each that may hit before the first file


def finished_files(folder):
    return sum(1 for _ in folder.glob("out.*"))


def kill_runs(command, report, folder, extension):
    """Files of an extension; their part of the kills."""
    rng = random.Random(f"kill {extension}")
    make_shot(folder, range(1, FRAMES + 1), width=96, height=64)
    arguments = ["in.#.exr", f"out.#.{extension}", "--operator", "hable", "--display", "linear", "--frames", f"1-{FRAMES}", "--jobs", "3"]

    code, lines = apply(command, *arguments, folder=folder)
    truth = contents(folder)
    report.check(f".{extension}: an unbroken run", code == 0 and not lines and len(truth) == FRAMES, lines)

    kills = partly = in_writing = whole = 0
    broken = []
    made = truth
    while kills < KILLS[extension]:
        if len(made) == FRAMES:  # from the beginning again
            whole += 1
            for name in made:
                (folder / name).unlink()
            made = {}
        old = set(leftovers(folder))
        process = subprocess.Popen([command, "apply", *arguments, "--skip-existing"], cwd=folder,
                                   stderr=subprocess.DEVNULL)
        if kills < STARTS:
            time.sleep(rng.uniform(0, 0.3))
        else:
            # Counted in files, so that the moments are spread over the frames however fast the machine is.
            count = rng.randint(len(made), FRAMES - 1)
            while process.poll() is None and finished_files(folder) <= count and not (
                    count == len(made) and set(leftovers(folder)) - old):
                time.sleep(0.001)
            time.sleep(rng.uniform(0, 0.01))  # a few times what a frame takes
        process.kill()
        kills += process.wait() == -9
        made = contents(folder)
        broken += [f"{name} after {kills} kills" for name in made if made[name] != truth.get(name)]
        partly += 0 < len(made) < FRAMES
        in_writing += bool(set(leftovers(folder)) - old)
    code, lines = apply(command, *arguments, "--skip-existing", folder=folder)
    report.check(f".{extension}: {kills} kills, {partly} among the frames, {in_writing} in a file; {whole} shots from "
                 "the beginning: no broken file under a final name", not broken, broken)
    # Or it would prove nothing.
    report.check(f".{extension}: kills hit files that were being written, and runs that others went on with",
                 min(in_writing, partly) >= KILLS[extension] * 3 // 10, f"{in_writing} and {partly}")
    report.check(f".{extension}: at the end the bytes of the unbroken run", code == 0 and contents(folder) == truth, lines)
    report.check(f".{extension}: nothing is left of killed runs", not leftovers(folder), leftovers(folder))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", type=Path)
    command = parser.parse_args().command.resolve()
    report = Report()
    with tempfile.TemporaryDirectory(prefix="tonewright-") as name, ThreadPoolExecutor() as pool:
        runs = []
        for extension in KILLS:
            folder = Path(name) / extension
            folder.mkdir()
            runs.append(pool.submit(kill_runs, command, report, folder, extension))
        for run in runs:
            run.result()
    return report.finish()


if __name__ == "__main__":
    raise SystemExit(main())
