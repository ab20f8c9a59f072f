# SPDX-License-Identifier: Apache-2.0
"""The Python module `tonewright`: pictures of OpenImageIO and NumPy, colors, operators, LUTs, errors."""

import ast
import json
import os
import shutil
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
from pictures import evaluate, run, share_of, skip
from sanitizers import is_sanitized
from shots import make_shot

pytestmark = pytest.mark.share(2)

# The SIMD engine is within 1e-6 of the reference (engine.h); float32 rounds by 6e-8.
FLOAT32 = 1.1e-6


def srgb(light):
    """IEC 61966-2-1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 0.0031308) ** (1 / 2.4) - 0.055)


def light(shape, peak=1.0):
    return np.random.default_rng(3).uniform(0, peak, shape)


def raises(report, what, error, words, function):
    try:
        function()
    except Exception as e:  # noqa: BLE001: which one it is, is the check
        text = str(e)
        report.check(f"{what}: {error.__name__}", type(e) is error and words in text and "\n" not in text, repr(e))
        return
    report.check(f"{what}: {error.__name__}", False, "nothing was raised")


@pytest.fixture(autouse=True)
def no_warnings():
    """Checks of warnings collect them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def test_colors(report, tw, command):
    for shape in ((3,), (1, 3), (7, 3), (4, 5, 3), (0, 3)):
        colors = light(shape)
        shown = tw.evaluate("clamp", colors)
        report.check(f"evaluate {shape}: float64 of its shape", shown.dtype == np.float64 and shown.shape == shape)
        # The closed form of what a clamp on an sRGB display shows.
        report.bound(f"evaluate {shape}", np.abs(shown - srgb(colors)).max(initial=0), 1e-14)
        shown = tw.evaluate("clamp", colors.astype(np.float32))
        report.check(f"evaluate {shape}: float32 of its shape", shown.dtype == np.float32 and shown.shape == shape)
        report.bound(f"evaluate {shape}, float32", np.abs(shown - srgb(colors)).max(initial=0), FLOAT32)
    wide = light((64, 3), 8.0)
    report.compare("evaluate with options", tw.evaluate(
        "reinhard_extended", wide, settings={"white": 8}, exposure=0.5, input="acescg", display="display_p3"),
        evaluate(command, wide, "reinhard_extended", "--set", "white=8", "--exposure", "0.5", "--input", "acescg",
                 "--display", "display_p3", "--engine", "reference", "--digits", "17"), 1e-15)
    strided = light((8, 8, 6))[:, ::2, ::2]
    report.compare("evaluate of a view of an array", tw.evaluate("clamp", strided), srgb(strided), 1e-14)
    report.compare("evaluate of a formula", tw.evaluate("x/(1+x)", np.array([[1.0, 3, -2]]), display="linear"), np.array([[0.5, 0.75, 0]]), 1e-15)
    report.check("evaluate: NaN and infinities", np.isfinite(tw.evaluate("hable", [[np.nan, np.inf, -np.inf]])).all())
    report.compare("evaluate, input sRGB", tw.evaluate("clamp", [[0.5, 0.01, 1]], input="sRGB"),
                   np.array([[0.5, 0.01, 1]]), 1e-12)


def test_arrays(report, tw):
    rgb = light((9, 7, 3))
    for kind in ("float16", "float32", "float64", "uint8", "uint16"):
        top = {"uint8": 255, "uint16": 65535}.get(kind, 1)
        stored = np.round(rgb * top).astype(kind) if top > 1 else rgb.astype(kind)
        expected = srgb(stored.astype(float) / top)
        shown = tw.tonemap(stored, "clamp")
        report.check(f"tonemap of {kind}: float32", shown.dtype == np.float32 and shown.shape == rgb.shape)
        report.bound(f"tonemap of {kind}", np.abs(shown - expected).max(), FLOAT32)
    rgba = np.concatenate([rgb * 0.5, np.full((9, 7, 1), 0.5)], axis=-1)
    shown = tw.tonemap(rgba, "clamp")
    report.compare("tonemap divides by alpha", shown[..., :3], srgb(rgb) * 0.5, FLOAT32)
    report.check("and keeps it", (shown[..., 3] == 0.5).all())
    report.compare("unpremult='no'", tw.tonemap(rgba, "clamp", unpremult="no")[..., :3], srgb(rgba[..., :3]), FLOAT32)
    report.compare("unpremult=False", tw.tonemap(rgba, "clamp", unpremult=False)[..., :3], srgb(rgba[..., :3]), FLOAT32)
    gray = rgb[..., 0]
    report.compare("gray stays gray", tw.tonemap(gray, "clamp")[..., None], srgb(gray)[..., None], FLOAT32)
    report.check("and of its shape", tw.tonemap(gray[..., None], "clamp").shape == (9, 7, 1))
    parts = []
    tw.tonemap(light((500, 8, 3)), "hable", progress=lambda part: parts.append(part))
    report.check("progress", len(parts) > 50 and parts == sorted(parts) and parts[-1] == 1, parts[-3:])
    raises(report, "progress that stops", ValueError, "canceled",
           lambda: tw.tonemap(rgb, "hable", progress=lambda part: True))
    raises(report, "progress that raises", ZeroDivisionError, "division",
           lambda: tw.tonemap(rgb, "hable", progress=lambda part: 1 / 0))
    results = [None] * 8

    def work(i):
        results[i] = tw.tonemap(rgb, "agx_sobotka")
    threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    report.check("eight threads, the same bits", all(np.array_equal(r, results[0]) for r in results))


def test_errors(report, tw):
    rgb = light((2, 2, 3))
    report.check("one grammar", np.array_equal(tw.evaluate("AgX Punchy", [1, .5, .2]),
                                               tw.evaluate("agx_blender", [1, .5, .2], look="punchy"))
                 and np.array_equal(tw.tonemap(rgb, "Hable:WHITE=4"), tw.tonemap(rgb, "hable", settings={"white": 4})))
    raises(report, "an unknown operator with NUL", ValueError, "embedded null character",
           lambda: tw.tonemap(rgb, "hable\0x"))
    raises(report, "unknown operator", ValueError, "did you mean hable?", lambda: tw.tonemap(rgb, "habel"))
    # As Python says it of its own functions.
    raises(report, "unknown option", TypeError, "tonemap() got an unexpected keyword argument 'exposur'",
           lambda: tw.tonemap(rgb, "hable", exposur=1))
    raises(report, "too few arguments", TypeError, "tonemap() missing 1 required positional argument: 'op'",
           lambda: tw.tonemap(rgb))
    raises(report, "option of the wrong kind", TypeError, "exposure must be a number, not str",
           lambda: tw.tonemap(rgb, "hable", exposure="bright"))
    raises(report, "threads", TypeError, "'float' object cannot be interpreted as an integer",
           lambda: tw.tonemap(rgb, "hable", nthreads=1.5))
    raises(report, "operator of the wrong kind", TypeError, "op must be str, not int", lambda: tw.tonemap(rgb, 5))
    raises(report, "settings of the wrong kind", TypeError, "settings must be a mapping, not list",
           lambda: tw.evaluate("hable", [1, 1, 1], settings=[1]))
    raises(report, "one text for many", TypeError, "displays must be a sequence of str, not str",
           lambda: tw.verify(["hable"], displays="srgb"))
    raises(report, "NUL in a name", ValueError, "embedded null character", lambda: tw.bake("hable", "a\0b.cube"))
    raises(report, "no operator of that kind", ValueError, "expected an id from operators()", lambda: tw.tonemap(rgb, "xyzzyx"))
    for shape in ((3, 20, 30), (4, 20, 30)):
        raises(report, f"channels first {shape}", ValueError, "or axis=0", lambda s=shape: tw.tonemap(np.zeros(s), "hable"))
        raises(report, f"channels first {shape}", ValueError, "or axis=0", lambda s=shape: tw.meter(np.zeros(s)))
    planes = light((3, 9, 7)).astype(np.float32)
    shown = tw.tonemap(planes, "agx_sobotka", axis=0)
    report.check("axis=0", shown.shape == planes.shape and np.array_equal(
        np.moveaxis(shown, 0, -1), tw.tonemap(np.moveaxis(planes, 0, -1), "agx_sobotka")))
    raises(report, "unknown parameter", ValueError, "did you mean white?",
           lambda: tw.tonemap(rgb, "hable", settings={"whit": 1}))
    raises(report, "parameter out of range", ValueError, "white is -2",
           lambda: tw.tonemap(rgb, "hable", settings={"white": -2}))
    raises(report, "integers of 64 bits", ValueError, "array is of int64", lambda: tw.tonemap(np.ones((2, 2, 3), int), "hable"))
    raises(report, "foreign byte order", ValueError, "array is of >f4", lambda: tw.tonemap(rgb.astype(">f4"), "hable"))
    for shape in ((3,), (2, 2, 2, 3), (0, 2, 3)):
        raises(report, f"shape {shape}", ValueError, "array has the shape", lambda s=shape: tw.tonemap(np.zeros(s), "hable"))
    raises(report, "no picture", TypeError, "image is a list; expected a numpy array or an OpenImageIO.ImageBuf",
           lambda: tw.tonemap([1, 2, 3], "hable"))
    raises(report, "colors of two numbers", ValueError, "expected (..., 3)", lambda: tw.evaluate("hable", [1, 2]))
    raises(report, "a number alone", ValueError, "expected (..., 3)", lambda: tw.evaluate("hable", 1.0))


# Room for what a call needs besides its data: stacks and arenas of threads.
ROOM = 16 << 20
WITHOUT_MEMORY = """
import resource, sys
import numpy as np, tonewright as tw
array = np.zeros((4000, 4000, 3), np.float32)
tw.evaluate("hable", [1, 1, 1])
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + int(sys.argv[1]),) * 2)
try:
    exec(sys.argv[2])
except BaseException as e:
    print(type(e).__name__, "|", e)
"""


def test_memory(report, command, python_module, scratch):
    """Too little memory is a MemoryError that says for what."""
    if is_sanitized(command):
        skip("memory that does not do, sanitizers take more")
    environment = {**os.environ, "PYTHONPATH": str(python_module)}
    big = scratch / "big.tif"
    run("oiiotool", "--pattern", "constant:color=.2,.2,.2", "4000x4000", "3", "-d", "float", "-o", big)
    for what, call, name in (
            ("tonemap", 'tw.tonemap(array, "reinhard_local")', "tonemap"), ("meter", f'tw.meter("{big}")', str(big)),
            ("tonemap_file", f'tw.tonemap_file("{big}", "{scratch}/big.png", "reinhard_local")', str(big)),
            ("bake", f'tw.bake("agx_sobotka", "{scratch}/big.cube", size=129)', f"{scratch}/big.cube"),
            ("make_config", f'tw.make_config("{scratch}/big", views=["aces_20"])', f"{scratch}/big"),
            ("verify", 'tw.verify(["hable"], gpu=False)', "verify")):
        done = subprocess.run([sys.executable, "-c", WITHOUT_MEMORY, str(ROOM), call], env=environment, capture_output=True,
                              text=True, check=False)
        report.check(f"{what}() without memory: MemoryError", done.stdout == f"MemoryError | {name}: not enough memory\n",
                     (done.returncode, done.stdout, done.stderr[-300:]))


def test_without_numpy(report, python_module):
    environment = {**os.environ, "PYTHONPATH": str(python_module)}
    done = subprocess.run([sys.executable, "-c", "import sys; sys.modules['numpy'] = None; import tonewright"],
                          env=environment, capture_output=True, text=True, check=False)
    report.check("no NumPy: the package of Debian is named", done.returncode == 1
                 and done.stderr.endswith("ImportError: tonewright needs NumPy (Debian: python3-numpy)\n"), done.stderr)


def warned(report, what, words, function, count=1):
    """UserWarnings of the caller's line in Python's own words; as an error, it stops the function."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        function()
    text = "; ".join(str(w.message) for w in heard)
    report.check(f"{what}: {count} warnings", len(heard) == count
                 and all(word in text for word in words) and "--" not in text
                 and all(w.category is UserWarning and w.filename == __file__ for w in heard), text)
    if words:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            raises(report, f"{what}: as an error", UserWarning, words[0], function)


def test_lists(report, tw, command):
    expected = {op["id"]: op for op in json.loads(run(command, "list", "--json"))["operators"]}
    ours = {op["id"]: op for op in tw.operators()}
    report.check("operators(): those of `list`", ours.keys() == expected.keys())
    report.check("operators(): with parameters", all(
        [p["name"] for p in ours[i]["parameters"]] == [p["name"] for p in expected[i]["parameters"]]
        and [p["default"] for p in ours[i]["parameters"]] == [p["default"] for p in expected[i]["parameters"]]
        for i in expected))


    spaces = json.loads(run(command, "list", "--json"))["displays"]
    report.check("displays(): those of `list`", [d["id"] for d in tw.displays()] == [d["id"] for d in spaces])
    report.check("displays(): HDR", {d["id"] for d in tw.displays() if d["hdr"]} == {"rec2100_pq", "rec2100_hlg", "p3d65_pq"})
    report.check("__version__: that of the command", tw.__version__ == run(command, "--version").strip())
    rows = tw.verify(["linear"], displays=["srgb"], quick=True, gpu=False)
    report.check("verify()", rows and all(row["ok"] and row["operator"] == "linear" for row in rows), rows)


def test_types(report, tw):
    """Every public function is documented and has types; a type checker finds them."""
    import inspect
    folder = Path(tw.__file__).parent
    stub = ast.parse((folder / "_tonewright.pyi").read_text())
    compiled = {name for name in dir(tw._tonewright) if not name.startswith("__")} | {"__version__"}
    stubs = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)} \
        | {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
    report.check("py.typed, and a stub of all that is compiled", (folder / "py.typed").exists() and stubs == compiled,
                 stubs ^ compiled)
    functions = [getattr(tw, name) for name in tw.__all__ if callable(getattr(tw, name))]
    bare = [f.__name__ for f in functions if not f.__doc__ or set(inspect.signature(f).parameters) - set(f.__annotations__)
            or "return" not in f.__annotations__]
    report.check(f"{len(functions)} functions with types and a docstring", len(functions) == 13 and not bare, bare)


def check_change(report, tw, command, scratch):
    """change_config() does what `config --into` does to a config of another studio."""
    text = (scratch / "ours" / "config.ocio").read_text().replace("name: tonewright", "name: studio")
    ours, theirs = scratch / "change" / "ours", scratch / "change" / "theirs"
    for folder in (ours, theirs):
        shutil.copytree(scratch / "ours", folder)
        (folder / "config.ocio").write_text(text)

    def same():
        files = [{p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()} for folder in (ours, theirs)]
        return files[0] == files[1]

    config = ours / "config.ocio"
    changed = tw.change_config(config, views=["AgX"], custom={"Seven": "hable:white=7"}, backup=True)
    run(command, "config", "--into", theirs / "config.ocio", "--views", "AgX", "--operator", "hable:white=7", "--name", "Seven",
        "--backup")
    report.check("change_config(): the files of `config --into`", same() and config.read_text() != text, changed)
    report.check("change_config(): its result", changed["path"] == str(config) and changed["backup"] == f"{config}.bak"
                 and changed["added"]["view"] == ["AgX on sRGB", "Seven on sRGB"]
                 and [view["view"] for view in changed["views"]] == ["AgX", "Seven"]
                 and all(view["p999"] <= view["max"] < 0.01 for view in changed["views"]), changed)
    changed = tw.change_config(config, "update", views=["drago"])
    run(command, "config", "--into", theirs / "config.ocio", "--update", "--views", "drago")
    report.check("change_config(): the files of --update", same() and changed["removed_tables"] > 0, changed)
    raises(report, "change_config of a name that is taken", ValueError, "already; expected another name (custom=",
           lambda: tw.change_config(config, views=["drago"]))
    raises(report, "change_config: one view is removed", ValueError, "expected none, because everything",
           lambda: tw.change_config(config, "remove", views=["drago"]))
    tw.change_config(config, "remove")
    report.check("change_config(): the old text after its removal", config.read_text() == text)
    raises(report, "change_config without views to remove", OSError, "", lambda: tw.change_config(config, "remove"))
    raises(report, "change_config of a kind", ValueError, "change is ad; expected add", lambda: tw.change_config(config, "ad"))
    raises(report, "change_config of no file", FileNotFoundError, "none.ocio", lambda: tw.change_config(scratch / "none.ocio"))


def test_config(report, tw, command, scratch):
    tw.make_config(scratch / "ours", views=["reinhard", "hable"], displays=["srgb"], profiles=["2.1"],
                   custom={"Mine": "hable:white=4"})
    run(command, "config", "-o", scratch / "theirs", "--views", "reinhard,hable", "--displays", "srgb", "--profile", "2.1",
        "--operator", "hable:white=4", "--name", "Mine")
    same = [(scratch / "ours" / p.relative_to(scratch / "theirs")).read_bytes() == p.read_bytes()
            for p in (scratch / "theirs").rglob("*") if p.is_file()]
    report.check(f"make_config(): the {len(same)} files of `config`", len(same) > 3 and all(same))
    warned(report, "make_config of an operator that measures",
           ["Drago uses log_average 1", 'custom={VIEW: "ID:PARAMETER=VALUE"}'],
           lambda: tw.make_config(scratch / "drago", views=["drago"], displays=["srgb"], profiles=["2.1"]))
    cache = scratch / "cache"
    tw.bake("agx_blender:formula", scratch / "linear.clf", input_encoding="linear", cache=cache)
    report.check("bake keeps its fit in the cache", len(list(cache.glob("cube_*.numbers"))) == 1)
    tw.make_config(None, archive=scratch / "ours.ocioz", views=["hable"], displays=["srgb"])
    run(command, "config", "--archive", scratch / "theirs.ocioz", "--views", "hable", "--displays", "srgb")
    report.check("make_config(): the archive of `config`",
                 (scratch / "ours.ocioz").read_bytes() == (scratch / "theirs.ocioz").read_bytes())
    raises(report, "make_config of a ZIP", ValueError, f"archive is {scratch}/x.zip; expected a name that ends in .ocioz",
           lambda: tw.make_config(None, archive=scratch / "x.zip", views=["hable"]))
    raises(report, "make_config into nothing", ValueError, "no folder and no archive; expected one of them", lambda: tw.make_config(None))
    raises(report, "make_config of an empty name", ValueError, "folder is empty; expected a name", lambda: tw.make_config(""))
    raises(report, "make_config of a list of views", TypeError, "custom must be a mapping",
           lambda: tw.make_config(scratch / "x", custom=[("A", "hable")]))
    odd = os.fsencode(scratch) + b"/\xff.ocioz"
    tw.make_config(None, archive=odd, views=["hable"], displays=["srgb"])
    report.check("make_config(): a name that is no UTF-8", os.path.getsize(odd) == (scratch / "ours.ocioz").stat().st_size)
    raises(report, "change_config of a name that is no UTF-8", FileNotFoundError, "none?.ocio",
           lambda: tw.change_config(os.fsencode(scratch) + b"/none\xff.ocio"))
    check_change(report, tw, command, scratch)
    raises(report, "make_config of no view", ValueError, "hablex", lambda: tw.make_config(scratch / "x", views=["hablex"]))


def test_luts(report, tw, command, scratch):
    options_and_words = [({"size": 17}, ["--size", "17"]),
                         ({"host": "resolve"}, ["--for", "resolve"]),
                         ({"format": "spi3d", "size": 17, "exposure": 1}, ["--format", "spi3d", "--size", "17",
                                                                           "--exposure", "1"]),
                         ({"dimension": 3, "size": 17, "nodes": "sampled", "decimals": 5},
                          ["--3d", "--size", "17", "--nodes", "sampled", "--decimals", "5"]),
                         ({"dimension": 1, "input_encoding": "linear"}, ["--1d", "--input-encoding", "linear"]),
                         ({"dimension": 3, "max_error": 0.1, "nodes": "sampled"},
                          ["--3d", "--max-error", "0.1", "--nodes", "sampled"]),
                         ({"host": "photoshop", "format": "icc", "icc_version": 4, "size": 17},
                          ["--for", "photoshop", "--format", "icc", "--icc-version", "4", "--size", "17"]),
                         ({"host": "unity", "depth": 8, "format": "strip"},
                          ["--for", "unity", "--depth", "8", "--format", "strip"])]
    for options, words in share_of(options_and_words, 3):
        extension = options.get("format", "cube").replace("strip", "png")
        a, b = (scratch / f"{name}.{extension}" for name in "ab")
        result = tw.bake("hable", str(a), **options)
        said = subprocess.run([command, "bake", "hable", "-o", b, *words], capture_output=True, text=True, check=True).stderr
        report.check(f"bake {options}: the file of `bake`", a.read_bytes() == b.read_bytes(), str(result))
        steps = [step.replace(str(a), str(b)).replace("size=", "--size") for step in result["steps"]]
        report.check(f"bake {options}: the steps of `bake`", len(steps) == ("host" in options) and all(
            step in said for step in steps) and result["clipped"] in said, (steps, said))
    raises(report, "bake of another dimension", ValueError, "dimension is 2; expected 1 or 3",
           lambda: tw.bake("hable", str(scratch / "a.cube"), dimension=2))
    raises(report, "bake of a version without a link", ValueError, "icc_version= is given for cube",
           lambda: tw.bake("hable", str(scratch / "a.cube"), icc_version=4))
    raises(report, "bake of a size and an error", ValueError, "size is 17; expected no size with max_error",
           lambda: tw.bake("agx_sobotka", str(scratch / "a.cube"), size=17, max_error=0.1))
    raises(report, "bake of a format without tables", ValueError, "dimension=1",
           lambda: tw.bake("hable", str(scratch / "a.spi3d"), dimension=1))
    raises(report, "bake under another format's name", ValueError, "expected .cube",
           lambda: tw.bake("hable", str(scratch / "a.clf"), host="resolve"))
    raises(report, "bake under no format's name", ValueError, "expected .cube: the format is cube",
           lambda: tw.bake("hable", str(scratch / "a.txt"), format="cube"))
    raises(report, "bake under a picture's name", ValueError,
           'expected format="hald", strip or strip_up with a picture, or host=',
           lambda: tw.bake("hable", str(scratch / "a.png")))
    ringing = scratch / "ringing.cube"
    warned(report, "bake that is off on photographs", [f"{ringing} is more than one code of 255 off on", 'input="lin_rec2020"'],
           lambda: tw.bake("agx_blender", ringing, size=17))
    ringing.unlink()
    warned(report, "bake of an operator that measures", ["drago measures each picture, which a LUT cannot do",
                                                         "settings={\"log_average\": ...} changes it",
                                                         "is more than one code of 255 off", "size=65"],
           lambda: tw.bake("drago", scratch / "drago.cube", size=17, input="lin_rec709"), 2)
    warned(report, "bake of one that does not", [], lambda: tw.bake("clamp", ringing, size=17, input="lin_rec709"), 0)
    raises(report, "bake into no folder", FileNotFoundError, f"{scratch}/none/a.cube",
           lambda: tw.bake("hable", scratch / "none" / "a.cube"))
    for path in (scratch / "path.cube", bytes(scratch / "bytes.cube")):
        tw.bake("hable", path, size=17)
        report.check(f"bake into a {type(path).__name__}", Path(os.fsdecode(path)).stat().st_size > 10000)
    raises(report, "bake onto a device", OSError, "is no regular file", lambda: tw.bake("hable", "/dev/null", format="cube", size=17))
    raises(report, "bake into a folder with control characters", FileNotFoundError, "a?[31mb c",
           lambda: tw.bake("hable", "a\x1b[31mb\nc/x.cube"))
    raises(report, "bake for nobody", ValueError, "did you mean resolve?", lambda: tw.bake("hable", "a.cube", host="resolv"))
    raises(report, "bake of a kind", ValueError, "format is", lambda: tw.bake("hable", "a.cube", format="cub"))


def check_info(report, tw, command, path, scratch):
    """info() says what `info --json` says; mix is the option of `apply`."""
    said = json.loads(subprocess.run([command, "info", path, "--json"], capture_output=True, text=True, check=True).stdout)
    told = tw.info(path)
    report.check("info(): the fields of `info --json`", all(
        (list(value) if isinstance(value, tuple) else value) == said[name] for name, value in told.items()), (told, said))
    raises(report, "info() of no file", FileNotFoundError, "no.exr", lambda: tw.info(scratch / "no.exr"))
    target = scratch / "mixed.exr"
    tw.tonemap_file(path, target, "hable", display="linear", mix=0.25)
    run(command, "apply", path, scratch / "said.mixed.exr", "--operator", "hable", "--display", "linear", "--mix", "0.25")
    report.check("mix: the bytes of `apply`", target.read_bytes() == (scratch / "said.mixed.exr").read_bytes())
    raises(report, "mix out of range", ValueError, "mix is 2; expected [0, 1]", lambda: tw.tonemap_file(path, target, "hable", mix=2))


def check_warnings(report, tw, command, path, scratch):
    """tonemap_file() warns where `apply` does, in Python's words; as an error, no file is written."""
    blank = scratch / "blank.exr"
    run("oiiotool", path, "--mulc", "1,1,1,0", "-o", blank)
    for what, source, name, options, arguments, words in (
            ("alpha is 0", blank, "blank.png", {}, [],
             'alpha is 0 everywhere, so viewers show nothing; alpha="ignore" leaves it out, alpha="opaque" makes it 1'),
            ("PQ in a JPEG", path, "pq.jpg", {"display": "rec2100_pq", "alpha": "ignore"},
             ["--display", "rec2100_pq", "--alpha", "ignore"], "JPEG does not say that its colors are "),
            ("code values in an EXR", path, "code.exr", {}, [], 'for linear light, use display="linear"'),
            ("opaque", blank, "opaque.png", {"alpha": "opaque"}, ["--alpha", "opaque"], None),
            ("no cause", path, "plain.exr", {"display": "linear"}, ["--display", "linear"], None)):
        target = scratch / name
        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always")
            tw.tonemap_file(source, target, "hable", **options)
        said = subprocess.run([command, "apply", source, scratch / f"said.{name}", "--operator", "hable", *arguments],
                              capture_output=True, text=True, check=True).stderr
        expected = 1 if words else 0
        report.check(f"tonemap_file: {what}: {expected} warnings, as of `apply`",
                     len(heard) == expected == said.count("warning: "), (heard, said))
        report.check(f"tonemap_file: {what}: the bytes of `apply`",
                     target.read_bytes() == (scratch / f"said.{name}").read_bytes())
        for warning in heard:
            text = str(warning.message)
            report.check(f"tonemap_file: {what}: a UserWarning of the caller's line", warning.category is UserWarning
                         and warning.filename == __file__ and text.startswith(f"{target}: ") and words in text
                         and "--" not in text, warning)
            target.unlink()
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                raises(report, f"tonemap_file: {what}: as an error", UserWarning, words,
                       lambda: tw.tonemap_file(source, target, "hable", **options))  # noqa: B023
            report.check(f"tonemap_file: {what}: no file then", not target.exists() and not list(scratch.glob(".*")))
    raises(report, "tonemap_file: alpha", ValueError, "expected keep, ignore, opaque or over:R,G,B",
           lambda: tw.tonemap_file(path, scratch / "d.exr", "hable", alpha="drop"))
    raises(report, "tonemap_file: alpha that divides", ValueError, "alpha is opaque; expected keep",
           lambda: tw.tonemap_file(path, scratch / "d.exr", "hable", alpha="opaque", unpremult="yes"))


def test_frames(report, tw, command, scratch):
    """tonemap_frames() writes the frames of `apply --frames`."""
    folder = scratch / "shot"
    folder.mkdir()
    make_shot(folder, [1, 2, 3, 5])
    pattern = folder / "in.####.exr"
    options = {"alpha": "ignore", "auto_exposure": "mean", "missing": "skip", "statistics": "sequence"}
    run(command, "apply", pattern, folder / "said.####.png", "--operator", "drago", "--frames", "1-5", "--missing", "skip",
        "--statistics", "sequence", "--auto-exposure", "mean", "--adapt", "--alpha", "ignore")
    for frames in ("1-5", [1, 2, 3, 4, 5]):
        told = tw.tonemap_frames(pattern, folder / "out.####.png", "drago", frames, adapt=True,
                                 meter_cache=folder / "cache.json", **options)
        report.check(f"tonemap_frames {frames}: the frames that exist", [t["frame"] for t in told] == [1, 2, 3, 5], told)
        report.check(f"tonemap_frames {frames}: the bytes of `apply`", all(
            Path(t["target"]).read_bytes() == (folder / Path(t["target"]).name.replace("out", "said")).read_bytes()
            and t["error"] is None and not t["skipped"] for t in told), told)
    report.check("tonemap_frames: a cache of `apply`", "tonewright_meter_cache" in (folder / "cache.json").read_text())
    again = tw.tonemap_frames(pattern, folder / "out.####.png", "drago", "1-4", skip_existing=True, alpha="ignore")
    report.check("tonemap_frames: those that exist are skipped", [t["skipped"] for t in again] == [True, True, True, False])
    report.check("tonemap_frames: a frame that is missing", "in.0004.exr: cannot read: No such file" in again[3]["error"], again)
    raises(report, "tonemap_frames: adaptation of nothing", ValueError, "expected auto_exposure",
           lambda: tw.tonemap_frames(pattern, folder / "x.####.png", "hable", "1-2", adapt=True))
    raises(report, "tonemap_frames: frames", ValueError, "frames is 1-x; expected frames such as",
           lambda: tw.tonemap_frames(pattern, folder / "x.####.png", "hable", "1-x"))
    raises(report, "tonemap_frames: what missing frames do", ValueError, "missing is x; expected error, skip or hold",
           lambda: tw.tonemap_frames(pattern, folder / "x.####.png", "hable", "1-2", missing="x"))
    def refused(what, error, words, *, frames="1-2", target="x.####.png", **arguments):
        raises(report, f"tonemap_frames: {what}", error, words,
               lambda: tw.tonemap_frames(pattern, folder / target, "hable", frames, **arguments))

    for name, value in (("key", 0.3), ("compensation", 1), ("fps", 30)):
        refused(f"{name} of nothing", ValueError, f"{name} is {value}; expected auto_exposure with it", **{name: value})
    for name, value in (("meter_frames", "1-5"), ("meter_cache", folder / "c.json")):
        refused(f"{name} of nothing", ValueError, f'{name} is given; expected auto_exposure or statistics="sequence"', **{name: value})
    refused("no frames to meter", ValueError, "meter_frames is empty", auto_exposure="mean", meter_frames=[])
    refused("frames to meter", ValueError, "meter_frames is x; expected frames such as", auto_exposure="mean", meter_frames="x")
    refused("a method", ValueError, "auto_exposure is bogus; expected log-average", auto_exposure="bogus")
    refused("statistics", ValueError, "statistics is all; expected picture, sequence or defaults", statistics="all")
    refused("a pixel type", ValueError, "dtype is bogus", dtype="bogus")
    refused("a compression", ValueError, "compression", compression="bogus", target="x.####.exr")
    refused("a target without a number", ValueError, "target is ", target="x.png")
    refused("bytes as frames", TypeError, "frames must be str or a sequence of int", frames=b"1-2")
    refused("large frames", ValueError, "frames is 1099511627776; expected a number of 32 bits", frames=[2 ** 40])
    refused("large jobs", ValueError, "jobs is 1099511627776; expected a number of 32 bits", jobs=2 ** 40)
    refused("negative jobs", ValueError, "jobs is -1; expected 0 or more", jobs=-1)
    report.check("tonemap_frames: refused calls write nothing", not list(folder.glob("x.*")), list(folder.glob("x.*")))
    again = tw.tonemap_frames(pattern, folder / "any.####.png", "drago", [1], statistics="Sequence")
    report.check("tonemap_frames: statistics in any case", again[0]["error"] is None, again)
    odd = os.fsencode(folder) + b"/\xff.####.png"
    again = tw.tonemap_frames(pattern, odd, "hable", [1])
    report.check("tonemap_frames: a name that is no UTF-8", os.path.exists(again[0]["target"]) and again[0]["error"] is None, again)
    raises(report, "tonemap_frames: an option of nothing", TypeError, "sharpen",
           lambda: tw.tonemap_frames(pattern, folder / "x.####.png", "hable", "1-2", sharpen=1))


def test_pictures(report, tw, command, scratch):
    oiio = pytest.importorskip("OpenImageIO", reason="ImageBuf (OpenImageIO's Python module is missing; Debian: python3-openimageio)")
    path = scratch / "a.exr"
    spec = oiio.ImageSpec(40, 30, 4, "half")
    spec.attribute("chromaticities", "float[8]", (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767))
    image = oiio.ImageBuf(spec)
    image.set_pixels(oiio.get_roi(spec), light((30, 40, 4), 4).astype(np.float32))
    image.write(str(path))
    run(command, "apply", path, scratch / "b.exr", "--operator", "hable", "--exposure", "1", "-d", "float")
    applied = oiio.ImageBuf(str(scratch / "b.exr")).get_pixels("float")
    result = tw.tonemap(oiio.ImageBuf(str(path)), "hable", exposure=1)
    report.check("ImageBuf in, ImageBuf out", isinstance(result, oiio.ImageBuf))
    report.check("the bits of `apply`", np.array_equal(result.get_pixels("float"), applied))
    report.check("its color space is said", result.spec().getattribute("oiio:ColorSpace") == "sRGB")
    part = tw.tonemap(oiio.ImageBuf(str(path)), "hable", exposure=1, roi=oiio.ROI(3, 9, 5, 8, 0, 1, 0, 4))
    report.check("roi", np.array_equal(part.get_pixels("float"), applied[5:8, 3:9]))
    tw.tonemap_file(path, scratch / "c.exr", "hable", exposure=1, dtype="float")
    written = {"compression": ("--compression", "zips"), "quality": ("--quality", 50), "subsampling": ("--subsampling", "4:4:4")}
    for name, (option, value) in written.items():
        ends = "exr" if name == "compression" else "jpg"
        run(command, "apply", path, scratch / f"w.{ends}", "--operator", "hable", "--alpha", "ignore", option, str(value))
        tw.tonemap_file(path, scratch / f"v.{ends}", "hable", alpha="ignore", verify_output=True, **{name: value})
        report.check(f"tonemap_file({name}={value!r}): the bytes of `apply {option}`",
                     (scratch / f"v.{ends}").read_bytes() == (scratch / f"w.{ends}").read_bytes())
    report.check("tonemap_file(): the bytes of `apply`", (scratch / "c.exr").read_bytes() == (scratch / "b.exr").read_bytes())
    original = path.read_bytes()
    (scratch / "symbolic.exr").symlink_to(path)
    (scratch / "hard.exr").hardlink_to(path)
    for target in (path, scratch / "symbolic.exr", scratch / "hard.exr"):
        raises(report, f"tonemap_file onto {target.name}", ValueError, "the same file as the input",
               lambda t=target: tw.tonemap_file(path, t, "hable"))
    raises(report, "tonemap_file onto its source", ValueError, "expected another file, or in_place=True",
           lambda: tw.tonemap_file(path, path, "hable"))
    report.check("tonemap_file onto its source: nothing has changed", path.read_bytes() == original)
    (scratch / "own.exr").write_bytes(original)
    tw.tonemap_file(scratch / "own.exr", scratch / "own.exr", "hable", display="linear", in_place=True)
    report.check("tonemap_file with in_place=True", (scratch / "own.exr").read_bytes() != original)
    raises(report, "tonemap_file with max_pixels", OSError, "expected at most 10 in all",
           lambda: tw.tonemap_file(path, scratch / "d.exr", "hable", max_pixels=10))
    raises(report, "meter with max_pixels", OSError, "expected at most 10 in all", lambda: tw.meter(path, max_pixels=10))
    raises(report, "tonemap_file: a missing file", FileNotFoundError, "gone.exr",
           lambda: tw.tonemap_file(scratch / "gone.exr", scratch / "d.exr", "hable"))
    raises(report, "tonemap_file: a pixel type", ValueError, "expected uint8, uint16, half or float",
           lambda: tw.tonemap_file(path, scratch / "d.exr", "hable", dtype="int"))
    check_warnings(report, tw, command, path, scratch)
    check_info(report, tw, command, path, scratch)
    metered = tw.meter(path)
    said = json.loads(run(command, "meter", path, "--json"))["pictures"][0]
    report.check("meter(): the exposure of `meter`", abs(metered["exposure"] - said["exposure"]) < 1e-12
                 and abs(metered["luminance"] - said["suggested"]["log-average"]["luminance"]) < 1e-12, (metered, said))
    report.check("meter() of an ImageBuf", tw.meter(oiio.ImageBuf(str(path))) == metered)
    # Reinhard 2002, eq. 1, of one luminance: 0.18/(0.5 + 0.001).
    report.bound("meter() of an array", abs(tw.meter(np.full((4, 5, 3), 0.5))["exposure"] - np.log2(0.18 / 0.501)), 1e-6)
    raises(report, "meter of a list", TypeError, "expected a path, a numpy array", lambda: tw.meter([1, 2]))
    raises(report, "meter by no method", ValueError, "did you mean mean?", lambda: tw.meter(path, method="meen"))
    raises(report, "a missing file", OSError, "/nonexistent/a.exr",
           lambda: tw.tonemap(oiio.ImageBuf("/nonexistent/a.exr"), "hable"))
    deep = oiio.ImageSpec(2, 2, 3, "float")
    deep.deep = True
    raises(report, "a deep picture", ValueError, "source is deep", lambda: tw.tonemap(oiio.ImageBuf(deep), "hable"))
