# SPDX-License-Identifier: Apache-2.0
"""Files that define no operator: each gives one line with its place, and exit 3, in a second and 200 MB."""

import random
import re

from malformed import judge
from pictures import PROJECT

EXAMPLE = PROJECT / "docs" / "examples" / "reinhard_055.tone"
HEAD = 'tonewright = 1\nid = "my"\n'
STAGE = "[[stage]]\n"


def malformed():
    """(what, bytes) of files that define no operator."""
    cases = []

    def add(what, text):
        cases.append((what, text if isinstance(text, bytes) else text.encode()))

    def curve(what, formula, before=""):
        add("curve: " + what, f'{HEAD}{before}{STAGE}curve = """\n{formula}\n"""\n')

    # Files that are no text of TOML.
    good = (HEAD + STAGE + 'curve = "max(x, 0)"\n').encode()
    for encoding in ("utf-16", "utf-16-le", "utf-16-be", "utf-32"):
        add(encoding, good.decode().encode(encoding))
    add("empty", b"")
    add("NUL", good + b"\0")
    add("10 MB in a line", HEAD.encode() + b'title = "' + b"x" * 10_000_000 + b'"\n')
    add("10 MB of lines", HEAD.encode() + b"# comment\n" * 1_000_000)
    add("1 MB in a formula", HEAD + STAGE + 'curve = "' + "x + " * 250_000 + 'x"\n')
    add("1 MB of dots", HEAD + "a" + ".a" * 500_000 + " = 1\n")
    add("dots in a header", HEAD + "[a" + ".a" * 300_000 + "]\n")
    add("dots after a first =", HEAD + "a = {b" + ".b" * 300_000 + " = 1}\n")
    add("deep arrays", HEAD + "a = " + "[" * 500_000)
    add("deep tables", HEAD + "a = " + "{a = " * 100_000)
    add("10,000 presets", HEAD + "".join(f"[preset.a{i}]\nset = {{}}\n" for i in range(10_000)) + STAGE + 'curve = "x"\n')
    add("10,000 choices", HEAD + '[parameter.m]\ndefault = "a0"\nchoices = [' +
        ", ".join(f'"a{i}"' for i in range(10_000)) + "]\n" + STAGE + 'curve = "x"\n')
    sums = "max(x, 0)" + "".join(f" + max(x, {i})*0.001" for i in range(300))
    add("many operations in all", HEAD + (STAGE + f'curve = "{sums}"\n') * 60)
    add("80,000 stages", HEAD + STAGE * 80_000)
    add("no newline in a string", HEAD + 'title = "a\nb"\n')
    add("a BOM in the middle", good[:15] + b"\xEF\xBB\xBF@" + good[15:])
    add("CR alone", good.replace(b"\n", b"\r"))
    for byte in (0x80, 0xC0, 0xFE, 0xFF):
        add(f"byte {byte:#x}", HEAD.encode() + b'title = "' + bytes([byte]) + b'"\n' + STAGE.encode() + b'curve = "x"\n')
    # Cut at every place where that is wrong, and a byte changed.
    whole = EXAMPLE.read_bytes()
    for end in range(40, len(whole) - 30, 29):
        if b"curve" not in whole[:end]:
            add(f"cut at {end}", whole[:end])
    rng = random.Random(7)
    keys = [m.start() for m in re.finditer(rb"^[a-z]+ ?=", whole, re.M)]
    for start in keys:
        for _ in range(3):
            at = start + rng.randrange(3)
            add(f"a key changed at {at}", whole[:at] + b"Q" + whole[at + 1:])
    # Values of wrong types for every key.
    for key in ("title", "view", "character", "source", "license", "negatives", "warnings", "primaries", "output",
                "parameter", "preset", "look", "deviation", "bounds", "stage", "inverse"):
        for value in ("1", "true", "1979-05-27", "nan", "[1, 2]", '"x"', "{ a = 1 }"):
            is_right = (key in ("title", "view", "character", "source", "license", "negatives") and value == '"x"')
            if not is_right:
                add(f"{key} = {value}", HEAD + f"{key} = {value}\n" + (STAGE + 'curve = "x"\n' if key != "stage" else ""))
    for key in ("matrix", "curve", "tone_scale", "hue_preserving", "hexcone", "cross_talk", "clamp", "lut", "when",
                "temporaries", "name"):
        for value in ("1", "true", "nan", "[1, 2, 3, 4]", '"+"', "{ a = 1 }"):
            more = "" if key not in ("when", "temporaries", "name") else 'curve = "x"\n'
            add(f"stage {key} = {value}", HEAD + STAGE + f"{key} = {value}\n{more}")
    # Numbers.
    for n in (2, 4, 1000):
        row = "[" + ", ".join(["1"] * n) + "]"
        add(f"matrix of {n}", HEAD + STAGE + "matrix = [" + ", ".join([row] * n) + "]\n")
    for value in ("nan", "inf", "-inf", "-nan", "1e999", '"1/0"', '"0/0"', '"k"', "1e", "0x"):
        add(f"matrix entry {value}", HEAD + STAGE + f"matrix = [[{value}, 0, 0], [0, 1, 0], [0, 0, 1]]\n")
        if value != "-inf":
            add(f"clamp {value}", HEAD + STAGE + f"clamp = [{value}, -9]\n")
        for where in ("default", "min", "max"):
            numbers = {"default": "1", "min": "0", "max": "2", where: value}
            add(f"parameter {where} {value}", HEAD + "[parameter.k]\n" + "".join(f"{a} = {b}\n" for a, b in numbers.items()) +
                STAGE + 'curve = "max(x, 0)*k"\n')
    # Formulas.
    for nest in ("(", "-", "!", "sqrt(", "x ? ", "x ? 1 : ", "max(x, ", "1 + ("):
        curve(f"deep {nest}", nest * 50_000)
    curve("long sum", " + ".join(["x"] * 30_000))
    curve("many lines", "\n".join(f"a{i} = x*{i} + x*x + x/7" for i in range(9000)) + "\na1")
    curve("cycle", "a = b\nb = a\na")
    curve("cycle of three", "a = c\nb = a\nc = b\nc")
    curve("itself", "a = a + 1\na")
    for formula in ("", "#", "x^2", "x**2", "x % 2", "x & 1", "x | 1", "x = 1", "a = x", "x\nx", "x +", "(x", "x)", "x x",
                    "2x", "1..2", "1e999", "1/0", "0/0", "sqrt(-1)", "log(-1)", "pow(x)", "pow(x, 1, 2)", "foo(x)", "foo",
                    "lerp(x, 1, 2)", "x.r", "r", "x[0]", "{x}", "x ? 1", "x : 1", "1 < x < 2", "x @ 1", "x $ 1", "x ~ 1",
                    "x += 1\nx", "a = 1\na = 2\na", "x = x\nx", "min = x\nmin", "sqrt(x)", "log(x)", "1/x", "x/(x + pow(x, 0.55))",
                    "\u00b2", "x\u00b7x", "\u2212x", "exp(exp(x))", "x\n+ 1", "if (x) 1", "return x;", "float a = x; a", "x,",
                    ",x", "()", "x()", "?", "!", "1e+", "0x10", "1_000", "x ;; + x"):
        curve(repr(formula), formula)
    # Names.
    for name in ("x", "r", "look", "pow", '"a b"', '"a.b"', '""', '"1a"'):
        add(f"parameter {name}", HEAD + f"[parameter.{name}]\ndefault = 1\nmin = 0\nmax = 2\n" + STAGE + 'curve = "x"\n')
    for id_ in ("", "A", "a b", "1a", "a" * 64, "a/b", "../a", "a\\n"):
        add(f"id {id_}", f'tonewright = 1\nid = "{id_}"\n' + STAGE + 'curve = "x"\n')
    add("two ids", HEAD + 'id = "b"\n' + STAGE + 'curve = "x"\n')
    add("view of 64 bytes", HEAD + f'view = "{"v" * 64}"\n' + STAGE + 'curve = "x"\n')
    add("choices twice", HEAD + '[parameter.m]\ndefault = "a"\nchoices = ["a", "a"]\n' + STAGE + 'curve = "x"\n')
    add("preset of no parameter", HEAD + "[preset.p]\nset = { k = 1 }\n" + STAGE + 'curve = "x"\n')
    add("preset out of range", HEAD + "[parameter.k]\ndefault = 1\nmin = 0\nmax = 2\n[preset.p]\nset = { k = 3 }\n" + STAGE +
        'curve = "x*k"\n')
    add("primaries in a line", HEAD + "[primaries]\nworking = { red = [0, 0.1], green = [0, 0.2], blue = [0, 0.3], "
        "white = [0.3, 0.3] }\n" + STAGE + 'curve = "x"\n')
    add("peak 0", HEAD + "[output]\npeak = 0\n" + STAGE + 'curve = "x"\n')
    return cases


def test_files(report, command, scratch):
    cases = [(what, text, "") for what, text in malformed()]
    judge(report, lambda path, _: [command, "eval", path], scratch, cases, "bad.tone", 300)
