#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation testing: changes one place of src/ at a time, and runs tests until one fails.

    python3 tests/mutants.py --list                  the drawn mutants, without a build
    python3 tests/mutants.py                         test all of them
    python3 tests/mutants.py --only 12,40            test two of them

Works on a copy of the repository in --build FOLDER, never in the repository. The copy is built once (Release, with
ccache where it is installed), then incrementally for each mutant. Prints one line for each mutant:

    12 src/lut/bake.cpp:31 sign: a + b -> a - b: killed by unit_tests Bake.RoundTrip (41 s)

The last word is `killed by TEST`, `lives`, `equivalent` (listed in tests/mutants_equivalent.csv with the reason) or
`not tested: REASON`. Exits with 1 if a mutant lives. With TONEWRIGHT_TEST_ALL=1, tests take full sample sets.

The draw depends on --seed and on the text of each line alone: a changed line changes the draw of its own mutants and
of no others. Every folder gets a share by its lines of code, and every kind of change gets the same share of a folder.
A mutant that does not compile is redrawn.
"""

import argparse
import csv
import hashlib
import os
import re
import resource
import shutil
import subprocess
import sys
import time
from collections import namedtuple
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]
FOLDERS = ["operators", "engine", "color", "ocio", "lut", "picture", "image"]
LEAST = 4  # mutants of each folder
KINDS = ["constant", "sign", "comparison", "order", "channel", "logic"]
MEMORY = 12 << 30  # bytes that a test may take
# Some of the machine code runs on processors with AVX-512 only.
NEEDS_AVX512 = ("src/engine/machine_code", "src/engine/vector_")

Mutant = namedtuple("Mutant", "path line kind before after text")  # text: of the whole changed file


# ---- What may be changed ----

def masked(source):
    """The source with strings, comments, preprocessor lines and messages as blanks: same length, same lines."""
    def blank(match):
        text = match.group(0)
        if text[0] in "\"'":
            return text[0] + re.sub(r"[^\n]", "`", text[1:-1]) + text[-1]
        return re.sub(r"[^\n]", " ", text)

    token = r'R"\((?:.|\n)*?\)"|//[^\n]*|/\*(?:.|\n)*?\*/|"(?:\\.|[^"\\\n])*"|(?<![0-9a-zA-Z])\'(?:\\.|[^\'\\\n])*\''
    code = re.sub(token, blank, source)
    code = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", blank, code, flags=re.M)
    # Statements whose only result is a text, and those that the compiler checks.
    words = r"throw|static_assert|Error|template|using|namespace|friend|note|progress|fmt::\w+|\w*warn\w*|\w*message\w*"
    code = re.sub(rf"(?<![\w.:])(?:{words})(?!\w)[^;{{}}]*", blank, code)
    # Arguments of templates.
    return re.sub(r"(?<=\w)<[\w:,\s*&]*>", blank, code)


def other_number(text, random):
    """The number with another last digit or larger by a few percent; None for what is no plain number."""
    match = re.fullmatch(r"([\d.]+)([eE][-+]?\d+)?([fFuUlLzZ]*)", text)
    if not match or text.startswith("0x"):
        return None
    digits, exponent, suffix = match.group(1), match.group(2) or "", match.group(3)
    if "." not in digits and not exponent:
        value = int(digits)
        return str(value + 1 if value < 100 else round(value * 1.03)) + suffix
    if len(digits.replace(".", "").strip("0")) in (2, 3, 4, 5) and random[0] % 2:
        last = digits[-1]
        if last != ".":
            return digits[:-1] + ("8" if last == "9" else str(int(last) + 1)) + exponent + suffix
    value = float(digits) * 1.03 or 0.03
    result = f"{value:.{max(3, len(digits) - 1)}g}"
    if "e" in result:
        return None
    return (result if "." in result else result + ".0") + exponent + suffix


SWAPS = {
    "sign": {" + ": " - ", " - ": " + ", " += ": " -= ", " -= ": " += ", "Add(": "Sub(", "Sub(": "Add("},
    "comparison": {" < ": [" <= ", " > "], " > ": [" >= ", " < "], " <= ": [" < ", " >= "], " >= ": [" > ", " <= "],
                   " == ": " != ", " != ": " == ", "less(": ["less_equal(", "!less("], "less_equal(": "less(",
                   "Lt(": ["Le(", "Gt("], "Le(": "Lt(", "Gt(": ["Ge(", "Lt("], "Ge(": "Gt("},
    "logic": {" && ": " || ", " || ": " && ", "min(": "max(", "max(": "min(", "Min(": "Max(", "Max(": "Min(",
              "min_element(": "max_element(", "max_element(": "min_element("},
    "channel": {"[0]": "[1]", "[1]": "[2]", "[2]": "[0]", "input(0)": "input(1)", "input(1)": "input(2)",
                "input(2)": "input(0)", ".x": ".y", ".y": ".z"},
}
NAMES = {"r": "g", "g": "b", "b": "r", "x": "y", "y": "x"}  # of channels and of chromaticities


def pattern_of(swaps):
    words = [re.escape(word) + (r"(?!\w)" if word[0] == "." else "") for word in swaps]
    return re.compile("|".join((r"(?<!\w)" if word[0].isalpha() else "") + word for word in words))


PATTERNS = {kind: pattern_of(swaps) for kind, swaps in SWAPS.items()}


def changes_of_line(code, near, kind, random):
    """(start, end, replacement) for every place of this kind in a line of masked code; near: the lines around it."""
    if kind == "constant":
        for match in re.finditer(r"(?<![\w.\[])\d[\w.]*(?:(?<=e)[-+]\d+)?(?![\w.\]])", code):
            after = other_number(match.group(0), random)
            if after and not code.lstrip().startswith("case "):
                yield match.start(), match.end(), after
        return
    if kind == "sign":
        if '"' in code:  # texts put together
            return
        for match in re.finditer(r"(?<=[(,=?:{] )-(?=[\w(])|(?<=\()-(?=[\w(])|(?<=return )-(?=[\w(])", code):
            yield match.start(), match.end(), ""
    for match in PATTERNS[kind].finditer(code):
        after = SWAPS[kind][match.group(0)]
        if isinstance(after, list):
            after = after[random[1] % len(after)]
        if after == "!less(":  # the other way around
            after = "greater(" if "::" in code[:match.start()] else "less_equal("
        yield match.start(), match.end(), after
    if kind == "channel":
        for match in re.finditer(r"(?<![\w.>])[rgbxy](?![\w(])", code):
            is_declared = re.search(r"\b(?!return\b)\w+[&*>]*\s+$", code[:match.start()])
            name = NAMES[match.group(0)]
            if not is_declared and re.search(rf"(?<![\w.]){name}(?!\w)", near):
                yield match.start(), match.end(), name


def is_whole(text):
    return all(text.count(a) == text.count(b) for a, b in ("()", "[]", "{}"))


def order_changes(code, lines, i):
    """The line with two of its elements swapped, or None for the next line before this one."""
    first, second = code[i], code[i + 1] if i + 1 < len(code) else ""
    for match in re.finditer(r"(?<=\{)([\w.][^{}(),;]*), ([^{}(),;]+)(?=[,}])", first):
        if match.group(1) != match.group(2) and match.group(1)[0].isdigit() == match.group(2)[0].isdigit() \
                and '"' not in match.group(0) and not match.group(1).startswith("."):
            a, b = (lines[i][match.start(k):match.end(k)] for k in (1, 2))
            yield lines[i][:match.start()] + f"{b}, {a}" + lines[i][match.end():]
    indent = len(first) - len(first.lstrip())
    if not first.strip() or not second.strip() or len(second) - len(second.lstrip()) != indent or first == second:
        return
    if not is_whole(first) or not is_whole(second):
        return
    previous = next((c.rstrip() for c in reversed(code[:i]) if c.strip()), "")
    a, b = first.strip(), second.strip()
    if a.endswith(",") and b.endswith(",") and previous.endswith((",", "{", "(")):
        # No rows that begin with a name, no initializers of members.
        if not re.search(r"^\w+,$|^\w+_\(|^\{?[\".]", a):
            yield None
    # Two statements, unless they may stand in any order: they use nothing of each other, or set what they belong to.
    statement = re.compile(r"(?!if\b|for\b|while\b|switch\b|return\b)(\w[\w.\[\]>:-]*)(\s[-+*/|&]?=\s|\()(.*);$")
    found = [statement.match(a), statement.match(b)]
    if all(found) and previous.endswith((";", "{", "}", ":")) and not ("set" in a and "set" in b):
        # What each changes: a variable or the object of a call; nothing where a function is called.
        objects = [m.group(1) if "=" in m.group(2) else re.sub(r"(^|\.|->)\w+$", "", m.group(1)) for m in found]
        if objects[0].startswith(objects[1]) or objects[1].startswith(objects[0]) or any(
                changed in m.group(3) for changed, m in zip(objects, reversed(found))):
            yield None


def random_numbers(*key):
    digest = hashlib.sha256("|".join(map(str, key)).encode()).digest()
    return [int.from_bytes(digest[i:i + 8], "big") for i in (0, 8, 16)]


def candidates(path, seed):
    """One possible mutant for each line and kind of change, with the number that decides when it is drawn."""
    source = (PROJECT / path).read_text()
    lines, code = source.split("\n"), masked(source).split("\n")
    seen = {}
    for i, text in enumerate(code):
        if not text.strip():
            continue
        key = lines[i].strip()
        seen[key] = seen.get(key, 0) + 1
        for kind in KINDS:
            random = random_numbers(seed, path, key, seen[key], kind)
            if kind == "order":
                changes = list(order_changes(code, lines, i))
            else:
                changes = list(changes_of_line(text, "\n".join(code[max(0, i - 8):i + 1]), kind, random))
            if not changes:
                continue
            change = changes[random[0] // 2 % len(changes)]
            before, new = lines[i], list(lines)
            if change is None:
                before = f"{lines[i].strip()} {lines[i + 1].strip()}"
                new[i], new[i + 1] = lines[i + 1], lines[i]
                after = f"{new[i].strip()} {new[i + 1].strip()}"
            else:
                new[i] = after = change if kind == "order" else before[:change[0]] + change[2] + before[change[1]:]
            yield random[2], kind, Mutant(path, i + 1, kind, before.strip(), after.strip(), "\n".join(new))


def draw(seed, count):
    """For each number a list of mutants: the first is tested; if it does not compile, the next."""
    pools, sizes = {}, {}
    for folder in FOLDERS:
        sizes[folder], pools[folder] = 0, {kind: [] for kind in KINDS}
        for file in sorted((PROJECT / "src" / folder).rglob("*")):
            if file.suffix not in (".cpp", ".h"):
                continue
            path = str(file.relative_to(PROJECT))
            sizes[folder] += sum(1 for line in masked(file.read_text()).split("\n") if line.strip(" {}();"))
            for priority, kind, mutant in candidates(path, seed):
                pools[folder][kind].append((priority, mutant))
    least = min(LEAST, count // len(FOLDERS))
    left, total = count - least * len(FOLDERS), sum(sizes.values())
    exact = {folder: left * size / total for folder, size in sizes.items()}
    share = {folder: int(exact[folder]) for folder in FOLDERS}
    for folder in sorted(FOLDERS, key=lambda f: share[f] - exact[f])[:left - sum(share.values())]:
        share[folder] += 1
    result = []
    for folder in FOLDERS:
        kinds = [kind for kind in KINDS if pools[folder][kind]]
        start = random_numbers(seed, folder)[0]
        chosen = [kinds[(start + i) % len(kinds)] for i in range(share[folder] + least)]
        for i, kind in enumerate(chosen):
            pool = [mutant for _, mutant in sorted(pools[folder][kind], key=lambda item: item[0])]
            result.append(pool[chosen[:i].count(kind)::chosen.count(kind)])
    return result


# ---- Tests ----

# The scripts that most probably notice a change of a folder, before all others.
SCRIPTS = {
    "operators": ["python_check.eval"],
    "color": ["python_check.eval"],
    "engine": ["python_check.eval", "bench.instructions"],
    "ocio": ["parity.into", "cli", "parity.artifacts", "parity.verify_config", "cli.lut_files"],
    "lut": ["cli.lut_files", "parity.luts", "parity.artifacts", "cli", "clients.tificc"],
    "picture": ["cli.tags", "cli.pictures", "cli.output"],
    "image": ["cli.pictures", "cli.meter", "cli.compare", "cli.plot", "cli.sequences", "clients.plugin"],
}
# The targets that a script needs, if it needs fewer than all.
TARGETS = {"python_check.eval": "tonewright-cli", "bench.instructions": "tonewright_instructions"}
# Files with the unit tests of a folder.
UNITS = {
    "operators": ["operators/*", "engine/operators_csv*", "pipeline/*"],
    "color": ["color/*", "engine/operators_csv*", "pipeline/*", "lut/sample_test*"],
    "engine": ["engine/*"],
    "ocio": ["ocio/*"],
    "lut": ["lut/*"],
    "picture": ["picture/*", "image/*"],
    "image": ["image/*"],
}


def unit_filter(folder):
    """A filter of Google Test for the unit tests of a folder."""
    suites = set()
    for pattern in UNITS[folder]:
        for file in (PROJECT / "tests/unit").glob(pattern):
            suites |= set(re.findall(r"^TEST(?:_[FP])?\((\w+),", file.read_text(), flags=re.M))
    return ":".join(f"{suite}.*:*/{suite}.*" for suite in sorted(suites))


class Tree:
    """A copy of the repository and its build."""

    def __init__(self, folder, jobs):
        self.root, self.jobs = folder / "tree", jobs
        self.build_folder = self.root / "build/release"
        self.root.mkdir(parents=True, exist_ok=True)

    def update(self):
        """Copies what differs, so that Ninja rebuilds only that."""
        names = subprocess.run(["git", "-C", PROJECT, "ls-files", "-z", "-co", "--exclude-standard"],
                               capture_output=True, text=True, check=True).stdout.split("\0")
        for name in filter(None, names):
            source, target = PROJECT / name, self.root / name
            if not source.is_file():
                target.unlink(missing_ok=True)
            elif not target.is_file() or source.read_bytes() != target.read_bytes():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(source, target)
        if not (self.build_folder / "build.ninja").exists():
            options = ["-DCMAKE_BUILD_TYPE=Release", "-DTONEWRIGHT_BUILD_TESTS=ON", "-DTONEWRIGHT_BUILD_BENCH=OFF"]
            if shutil.which("ccache"):
                options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
            subprocess.run(["cmake", "-S", self.root, "-B", self.build_folder, "-G", "Ninja", *options], check=True,
                           stdout=subprocess.DEVNULL)

    def build(self, target):
        """None, or what the compiler said."""
        done = subprocess.run(["cmake", "--build", self.build_folder, "-j", str(self.jobs), "--target", target],
                              capture_output=True, text=True)
        return None if done.returncode == 0 else done.stdout[-2000:]

    def run(self, command, limit):
        """None if the test passes, else what failed."""
        def limit_memory():
            resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))

        process = subprocess.Popen(command, cwd=self.root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True, errors="replace", preexec_fn=limit_memory, start_new_session=True)
        try:
            output, _ = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            process.wait()
            return f"no end after {limit} s"
        if process.returncode == 0:
            return None
        failed = re.search(r"\[  FAILED  \] ([\w/]+\.[\w/]+)|^\s*\d+ - (\S+) \((?:Failed|Timeout|.*)\)", output, re.M)
        if failed:
            return failed.group(1) or failed.group(2)
        running = re.findall(r"\[ RUN      \] (\S+)", output)
        return f"{running[-1]} (a crash)" if running else "a crash"

    def steps(self, folder):
        """(name, target, command, seconds that it may take), the cheapest and most probable first."""
        bin_folder = self.build_folder / "bin"

        def gtest(name, tests):
            return [str(bin_folder / name), "--gtest_fail_fast", f"--gtest_filter={tests}"]

        def ctest(*arguments):
            return ["ctest", "--test-dir", str(self.build_folder), "--stop-on-failure", *arguments]

        own = unit_filter(folder)
        scripts = [f"^{re.escape(name)}$" for name in SCRIPTS[folder]]
        yield "unit_tests", "unit_tests", gtest("unit_tests", own), 600
        for name, script in zip(SCRIPTS[folder], scripts):
            yield name, TARGETS.get(name, "all"), ctest("-R", script), 900
        others = [("law_tests", gtest("law_tests", "*")), ("unit_tests", gtest("unit_tests", f"-{own}"))]
        for name, command in others if folder in ("operators", "color", "engine") else reversed(others):
            yield name, name, command, 1200
        done = "|".join(["^unit_tests", "^law_tests", *scripts])
        yield "ctest", "all", ctest("-j", str(self.jobs), "-E", done), 5400


def has_avx512():
    try:
        return "avx512f" in Path("/proc/cpuinfo").read_text()
    except OSError:
        return False


def test(tree, options, known):
    """The mutant of a number that compiles, what became of it, and a remark.

    known: reasons of equivalent mutants, which no test has to kill
    """
    skipped = ""
    for mutant in options:
        if mutant.path.startswith(NEEDS_AVX512) and not has_avx512():
            skipped = "machine code needs AVX-512; redrawn"
            continue
        reason = known.get((mutant.path, mutant.before, mutant.after))
        if reason:
            return mutant, f"equivalent: {reason}", skipped
        target = tree.root / mutant.path
        original = target.read_text()
        target.write_text(mutant.text)
        try:
            built = set()
            for name, needed, command, limit in tree.steps(mutant.path.split("/")[1]):
                if needed not in built and tree.build(needed) is not None:
                    break
                built.add(needed)
                failed = tree.run(command, limit)
                if failed:
                    return mutant, f"killed by {failed if name in ('ctest', failed) else f'{name} {failed}'}", skipped
            else:
                return mutant, "lives", skipped
        finally:
            target.write_text(original)
    return None, "lives", skipped


def equivalents():
    with open(PROJECT / "tests/mutants_equivalent.csv", newline="") as file:
        return {(row["file"], row["before"], row["after"]): row["reason"] for row in csv.DictReader(file)}


def shown(mutant):
    before, after = mutant.before, mutant.after
    start = os.path.commonprefix([before, after])
    if mutant.kind != "order" and len(before) > 60:  # only the place
        at = max(0, len(start) - 30)
        before, after = before[at:at + 60], after[at:at + 60]
    return f"{mutant.path}:{mutant.line} {mutant.kind}: {before} -> {after}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=17, help="another draw (default 17)")
    parser.add_argument("--count", type=int, default=60, help="how many mutants to draw (default 60)")
    parser.add_argument("--list", action="store_true", help="print the drawn mutants and stop")
    parser.add_argument("--only", help="numbers of mutants to test, with commas between")
    parser.add_argument("--build", type=Path, default=PROJECT / "build/mutants", metavar="FOLDER",
                        help="folder of the copy and its build (default build/mutants)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes of compiler and ctest")
    arguments = parser.parse_args()

    drawn = draw(arguments.seed, arguments.count)
    if arguments.list:
        for number, options in enumerate(drawn, 1):
            print(number, shown(options[0]))
        return 0
    numbers = [int(n) for n in arguments.only.split(",")] if arguments.only else range(1, len(drawn) + 1)
    known = equivalents()
    tree = Tree(arguments.build.resolve(), arguments.jobs)
    tree.update()
    failed = tree.build("all")
    if failed:
        print(f"The unchanged tree does not build:\n{failed}")
        return 1
    totals = {}
    for number in numbers:
        begin = time.monotonic()
        mutant, result, remark = test(tree, drawn[number - 1], known)
        if mutant is None:
            print(number, "no mutant that compiles", flush=True)
            continue
        totals[result.split()[0]] = totals.get(result.split()[0], 0) + 1
        remark = f" ({remark})" if remark else ""
        print(f"{number} {shown(mutant)}: {result}{remark} ({time.monotonic() - begin:.0f} s)", flush=True)
    print(", ".join(f"{count} {what.strip(':')}" for what, count in sorted(totals.items())))
    return 1 if totals.get("lives") else 0


if __name__ == "__main__":
    sys.exit(main())
