# SPDX-License-Identifier: Apache-2.0
"""tonewright.imageio.so in OpenImageIO's programs: the bits of `tonewright apply`, and never an abort of the host.

    python3 -m pytest tests/parity/clients/test_plugin.py --tonewright build/release/bin/tonewright --plugin build/release/lib/OpenImageIO-2.4

Real pictures join where they are found, see pictures.shared_picture.
"""

import os
import subprocess
import threading

import numpy as np
import pytest
from pictures import need_program, run, share_of, shared_picture, write_exr

oiio = pytest.importorskip("OpenImageIO", reason="OpenImageIO's Python module is missing (Debian: python3-openimageio)")
need_program("oiiotool", "openimageio-tools")

OPTIONS = {"op": "agx_sobotka", "exposure": "1", "display": "display_p3"}


def name(path, **arguments):
    text = "&".join(f"{key}={value}" for key, value in arguments.items())
    return f"{path}.tonewright?{text}" if text else f"{path}.tonewright"


def call(*arguments, folder=None):
    return subprocess.run([str(a) for a in arguments], cwd=folder, capture_output=True, text=True, check=False)


def pixels_of(path, subimage=0, level=0):
    """All channels as floats, which hold every half and every integer of 16 bits; through OpenImageIO's cache."""
    # The cache takes a file that was written again within a second for the old one.
    oiio.ImageCache(True).invalidate(str(path), True)
    image = oiio.ImageBuf(str(path), subimage, level)
    pixels = image.get_pixels("float")
    if pixels is None or image.has_error:
        raise RuntimeError(f"{path}: {image.geterror()}")
    return pixels


def is_same(a, b):
    """To the last bit."""
    for path in (a, b):
        oiio.ImageCache().invalidate(str(path))
    return pixels_of(a).tobytes() == pixels_of(b).tobytes()


def apply(command, path, out, kind, *options, **arguments):
    """`tonewright apply` with the plugin's arguments."""
    words = []
    for key, value in arguments.items():
        if key.startswith("set."):
            words += ["--set", f"{key[4:]}={value}"]
        else:
            words += ["--operator" if key == "op" else f"--{key.replace('_', '-')}", value]
    run(command, "apply", path, out, *words, "-d", kind, *options)


def check_same(report, command, path, scratch, arguments):
    """The reader itself: floats."""
    ours = scratch / "ours.exr"
    apply(command, path, ours, "float", **arguments)
    report.check(f"{path.name} {' '.join(arguments.values())}: the bits of apply", is_same(ours, name(path, **arguments)))


def check_through_oiiotool(report, command, path, scratch, arguments, kind, extension="exr"):
    ours, theirs = scratch / f"ours.{extension}", scratch / f"theirs.{extension}"
    apply(command, path, ours, kind, **arguments)
    run("oiiotool", name(path, **arguments), "-d", kind, "-o", theirs)
    report.check(f"oiiotool, {path.name} {kind} {extension} {' '.join(arguments.values())}: the bits of apply",
                 is_same(ours, theirs))


@pytest.fixture(scope="module")
def scratch(plugin, tmp_path_factory):
    """A folder for all tests. OpenImageIO finds the plugin."""
    os.environ["OIIO_LIBRARY_PATH"] = str(plugin)
    return tmp_path_factory.mktemp("plugin")


@pytest.fixture(scope="module")
def made(scratch):
    """Small ones of every layout."""
    rng = np.random.default_rng(5)

    def planes(names, height=70, width=90):
        return {n: (0.18 * 2.0 ** rng.uniform(-8, 5, (height, width)) * rng.choice([-1, 1], (height, width), p=[0.1, 0.9])
                    ).astype(np.float32) for n in names}
    rgb, rgba = planes("RGB"), {**planes("RGB"), "A": np.linspace(0, 1, 6300, dtype=np.float32).reshape(70, 90)}
    rgb["R"][0, :4] = [np.nan, np.inf, -np.inf, 1e30]
    made = {}
    for key, planes_of in (("rgb", rgb), ("alpha", rgba), ("five", {**planes("RGB"), "Z": rgb["G"], "id": rgb["B"]}),
                           ("gray", planes("Y")), ("pixel", planes("RGB", 1, 1))):
        made[key] = scratch / f"{key}.exr"
        write_exr(made[key], planes_of)
    variants = {"tiled": ["--tile", "32", "16"], "half": ["-d", "half", "--compression", "piz"],
                "over": ["--origin", "-7+5", "--fullsize", "60x50+0+0"], "crop": ["--fullsize", "400x300-20-30"]}
    for key, words in variants.items():
        made[key] = scratch / f"{key}.exr"
        run("oiiotool", made["rgb"], *words, "-o", made[key])
    made["mip"] = scratch / "mip.exr"
    run("oiiotool", made["rgb"], "-d", "half", "-otex", made["mip"])
    for key in ("png", "tif"):
        made[key] = scratch / f"rgb.{key}"
        run("oiiotool", made["pixel"], "--resize", "31x17", "-d", "uint16", "-o", made[key])
    return made


def check_bits(report, command, scratch, made):
    for path in share_of(made.values(), 3):
        check_same(report, command, path, scratch, OPTIONS)
    fits = scratch / "nameless.fits"  # its reader gives channels no names
    run("oiiotool", made["rgb"], "-o", fits)
    check_same(report, command, fits, scratch, OPTIONS)
    check_same(report, command, made["rgb"], scratch, {"op": "drago"})  # measures the picture
    check_same(report, command, made["alpha"], scratch, {"op": "drago", "exposure": "-1"})
    check_same(report, command, made["rgb"], scratch, {"op": "drago", "statistics": "defaults"})
    check_same(report, command, made["rgb"], scratch, {"op": "reinhard_extended", "set.white": "8", "input": "lin_ap1"})
    check_same(report, command, made["rgb"], scratch, {"op": "aces_13", "display": "rec2100_pq", "reference_white": "203"})
    check_through_oiiotool(report, command, made["rgb"], scratch, OPTIONS, "float")
    check_through_oiiotool(report, command, made["mip"], scratch, OPTIONS, "half")
    check_through_oiiotool(report, command, made["rgb"], scratch, OPTIONS, "uint8", "png")
    check_through_oiiotool(report, command, made["rgb"], scratch, OPTIONS, "uint16", "png")
    check_through_oiiotool(report, command, made["alpha"], scratch, OPTIONS, "uint16", "tif")
    apply(command, made["alpha"], scratch / "ours.exr", "float", "--no-unpremult", op="hable")
    report.check("unpremult=no", is_same(scratch / "ours.exr", name(made["alpha"], op="hable", unpremult="no")))
    for picture in share_of(("Desk.exr", "XYZ.exr", "Tree.exr", "StageEnvLatLong.exr", "composited.exr", "t05.exr",
                             "memorial.hdr"), 3):
        path = shared_picture(picture)
        if path:
            check_same(report, command, path, scratch, {"op": "hable"})


def check_structure(report, command, scratch, made):
    """Subimages, levels, tiles, metadata."""
    parts = scratch / "parts.exr"
    run("oiiotool", made["half"], made["half"], "--mulc", "0.25", "--siappendall", "-o", parts)
    run("oiiotool", "-a", name(parts, op="drago"), "-d", "float", "-o", scratch / "both.exr")
    for number in (0, 1):
        apply(command, parts, scratch / "ours.exr", "float", "--subimage", str(number), op="drago")
        oiio.ImageCache().invalidate(str(scratch / "ours.exr"))
        report.check(f"subimage {number}, with statistics of its own", np.array_equal(
            pixels_of(scratch / "ours.exr"), pixels_of(scratch / "both.exr", number)))
    info = run("iinfo", "-v", "-a", name(made["mip"], op="hable"))
    report.check("iinfo: levels and tiles", "MIP-map levels: 90x70 45x35" in info and "tile size: 64 x 64" in info, info)
    run("oiiotool", made["mip"], "--selectmip", "1", "-d", "float", "-o", scratch / "level.exr")
    apply(command, scratch / "level.exr", scratch / "ours.exr", "float", op="hable")
    oiio.ImageCache().invalidate(str(scratch / "ours.exr"))
    report.check("a level", np.array_equal(pixels_of(scratch / "ours.exr"), pixels_of(name(made["mip"], op="hable"), 0, 1)))
    info = run("iinfo", "-v", name(made["five"], op="hable"))
    report.check("iinfo: channels and color space", "R, G, B, Z, id" in info and 'oiio:ColorSpace: "sRGB"' in info, info)
    info = run("iinfo", "-v", name(made["over"], op="hable", display="display_p3"))
    report.check("iinfo: windows and primaries", "pixel data origin: x=-7, y=5" in info and "chromaticities: 0.68" in info,
                 info)
    report.check("idiff", call("idiff", name(made["rgb"], op="clamp"), name(made["rgb"], op="clamp")).returncode == 0)
    report.check("idiff finds a difference", call("idiff", name(made["half"], op="hable"), made["half"]).returncode == 2)
    recipe = scratch / "shot.tonewright"
    recipe.write_text(f"# what the shot looks like\nfile = {made['half'].name}\nop=hable\nset.white=6\n")
    apply(command, made["half"], scratch / "ours.exr", "float", op="hable", **{"set.white": "6"})
    report.check("a file of arguments", is_same(scratch / "ours.exr", recipe))
    apply(command, made["half"], scratch / "ours.exr", "float", op="hable", exposure="1", **{"set.white": "4"})
    report.check("and more of them", is_same(scratch / "ours.exr", f"{recipe}?exposure=1&set.white=4"))
    run("maketx", recipe, "-o", scratch / "a.tx")
    report.check("maketx", "90x70 45x35" in run("iinfo", "-v", scratch / "a.tx"))
    run("oiiotool", "--iconfig", "tonewright:op", "hable", name(made["half"]), "-o", scratch / "theirs.exr")
    apply(command, made["half"], scratch / "ours.exr", "float", op="hable")
    report.check("--iconfig tonewright:op", is_same(scratch / "ours.exr", scratch / "theirs.exr"))


@pytest.mark.parametrize("check", share_of([check_bits, check_structure], 2))
def test_pictures(report, command, scratch, made, check):
    check(report, command, scratch, made)


def test_errors(report, scratch, made, monkeypatch):
    """Each program says what is wrong and exits by itself: no signal, no abort."""
    half = made["half"].read_bytes()
    (scratch / "cut.exr").write_bytes(half[:len(half) // 2])
    (scratch / "empty.exr").write_bytes(b"")
    (scratch / "text.exr").write_bytes(b"no picture")
    for bad, text in (("a", "file=half.exr\nop=habel\n"), ("b", "op=hable\n"), ("c", "what\n"), ("d", "file=gone.exr\nop=hable"),
                      ("e", "file=e.tonewright\nop=hable\n"), ("f", "\0\xff" * 9), ("g", "#" * 70000),
                      ("rec", "file = rec.tonewright?op=hable\nop = hable\n"), ("one", "file=other.TONEWRIGHT?op=hable\nop=hable\n"),
                      ("other", "file=one.tonewright?op=hable\nop=hable\n"), ("secret", "s3cret_key=hunter2\n"),
                      ("words", "s3cret hunter2\n")):
        (scratch / f"{bad}.tonewright").write_text(text, "latin-1")
    good = made["half"].name
    faults = {name("gone.exr", op="hable"): "gone.exr: cannot read: No such file or directory",
              name("empty.exr", op="hable"): "empty.exr: cannot read: the file is empty",
              name("text.exr", op="hable"): "text.exr: cannot read",
              name("cut.exr", op="hable"): "cut.exr: cannot read",
              name("cut.exr", op="drago"): "cut.exr: cannot read",
              name(good): "op is missing; expected ?op=OPERATOR",
              name(good, op="habel"): "did you mean hable?",
              name(good, op="hable", exposur="1"): "did you mean exposure?",
              name(good, op="hable", white="8"): "argument is white; expected op,",
              name(good, op="hable", exposure="much"): "exposure is much; expected a number",
              name(good, op="hable", exposure="99"): "exposure is 99; expected [-64, 64] stops",
              name(good, op="hable", unpremult="maybe"): "expected auto, yes or no",
              name(good, op="hable", **{"set.whit": "3"}): "did you mean white?",
              name(good, op="hable", input="lin_rec708"): "did you mean lin_rec709?",
              name(good, op="hable", display="native", look="x"): "look is x",
              name(good + ".tonewright", op="hable"): "expected one that is not tone mapped yet",
              "a.tonewright": "did you mean hable?", "b.tonewright": "file is missing", "c.tonewright": "line 1 is not a setting",
              "rec.tonewright": "not tone mapped yet", "rec.tonewright?op=hable": "not tone mapped yet",
              "one.tonewright": "not tone mapped yet",
              "secret.tonewright": "line 1 has an unknown name", "words.tonewright": "line 1 is not a setting",
              "d.tonewright": "gone.exr: cannot read", "e.tonewright": "not tone mapped yet",
              "f.tonewright": "expected name=value", "g.tonewright": "it has 70000 bytes; expected at most 65536"}
    monkeypatch.chdir(scratch)
    for bad, words in faults.items():
        image = oiio.ImageBuf(bad)
        image.read(force=True)
        said = image.geterror()
        report.check(f"{bad}: {words}", words in said and "s3cret" not in said and "hunter2" not in said, said)
    (scratch / "bom.tonewright").write_bytes(b"\xef\xbb\xbffile=" + made["half"].name.encode() + b"\nop=hable\n")
    report.check("a text with a byte order mark", is_same("bom.tonewright", name(made["half"], op="hable")))
    programs = ((("oiiotool", "-o", "never.exr"), ("gone.exr", "cut.exr", "habel", "rec.")),
                (("iinfo", "-v"), ("gone.exr", "habel", "rec.")), (("idiff", "rgb.exr"), ("gone.exr", "cut.exr")),
                (("maketx", "-o", "never.tx"), ("gone.exr", "a.tonewright", "d.tonewright", "rec.")))
    for (program, *words), parts in programs:
        for bad in (next(n for n in faults if part in n) for part in parts):
            done = call(program, bad, *words)
            said = done.stdout + done.stderr
            report.check(f"{program} {bad}: exits by itself", 0 < done.returncode < 100 and said, f"{done.returncode}: {said}")
    report.check("and no file is left", not (scratch / "never.exr").exists() and not (scratch / "never.tx").exists())


def test_threads(report, command, scratch, made):
    for key in ("rgb", "tiled", "mip"):
        apply(command, made[key], scratch / "ours.exr", "float", **OPTIONS)
        oiio.ImageCache().invalidate(str(scratch / "ours.exr"))
        expected = pixels_of(scratch / "ours.exr")
        results = []

        def work(path=made[key]):
            # One cache for all: threads share the reader.
            image = oiio.ImageBuf(name(path, **OPTIONS))
            results.append(image.get_pixels("float"))
        threads = [threading.Thread(target=work) for _ in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        report.check(f"Python, six threads, {key}", len(results) == 6 and all(
            r is not None and r.tobytes() == expected.tobytes() for r in results))
    reader = oiio.ImageInput.open(name(made["tiled"], **OPTIONS))
    corner = reader.read_tile(64, 64, 0, "float")  # beyond the edges of the picture
    reader.close()
    apply(command, made["tiled"], scratch / "ours.exr", "float", **OPTIONS)
    oiio.ImageCache().invalidate(str(scratch / "ours.exr"))
    expected = pixels_of(scratch / "ours.exr")
    report.check("Python, a tile at the corner", corner is not None and np.array_equal(corner[:6, :26], expected[64:, 64:]))


def test_exports(report, plugin):
    """Nothing but what OpenImageIO asks for."""
    library = plugin / "tonewright.imageio.so"
    symbols = {line.split()[-1] for line in run("nm", "-D", "--defined-only", library).splitlines()}
    report.check("exports", symbols == {"tonewright_imageio_version", "tonewright_imageio_library_version",
                                        "tonewright_input_imageio_create", "tonewright_input_extensions"}, str(symbols))
