# SPDX-License-Identifier: Apache-2.0
"""The page of `tonewright report` in headless Chromium, opened from a file as users open it.

    python3 -m pytest tests/report/test_page.py --tonewright build/release/bin/tonewright [-k keyboard] [--screenshots FOLDER]

The 64-bit reference of the page against `tonewright eval`, the picture against `tonewright apply`, the pixel probe, keyboard,
links, damaged files. With TONEWRIGHT_TEST_ALL=1 all operators, else ten, and the HDR view, .tone files and more kinds of
EXR files.
"""
import base64
import json
import re
import struct
import subprocess
import time

import numpy as np
import pytest
from chromium import Page
from executed import IS_FULL, colors, pick, reference

pytestmark = pytest.mark.share(3)

# A grid, tables, a table in steps, branches, a hue structure, a measuring operator, a local one.
OPERATORS = ["agx_blender", "aces_20", "camera_response", "hable", "khronos_neutral", "gt7", "reinhard:luminance", "uchimura", "drago",
             "exposure_fusion"]
MOST_BYTES = 3_000_000  # without pictures; the embedded chart is part of it here


def tonewright_run(command, *arguments):
    return subprocess.run([command, *map(str, arguments)], check=True, capture_output=True, text=True)


@pytest.fixture(scope="module")
def file(command, tmp_path_factory):
    """The page, as users open it."""
    path = tmp_path_factory.mktemp("page") / "page.html"
    tonewright_run(command, "report", "-o", path, "--operators", "all" if IS_FULL else ",".join(OPERATORS), "--no-parity")
    return path


@pytest.fixture(scope="module")
def browser():
    """One for all tests: the last one looks at all that it has said."""
    with Page() as page:
        yield page


@pytest.fixture
def page(browser, file):
    """The page, freshly opened on a screen of a desk."""
    browser.resize(1440, 900)
    browser.open(file)
    return browser


def test_contents(report, file):
    report.check(f"size: {file.stat().st_size} bytes (bound {MOST_BYTES})", file.stat().st_size < MOST_BYTES)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', file.read_text())[1]
    report.check("policy: no script but these two", "unsafe" not in policy and policy.count("sha256-") == 3, policy)


def check_reference(report, command, page):
    """The functions that JavaScript runs in 64-bit float, and the double reference."""
    rgb = np.array(pick(list(colors()), 120), np.float32)
    names = page.run("tonewright.operators.filter((op) => op.glsl).map((op) => op.name)")
    for name in names:
        for exposure, setting in ((0, {}), (1.5, {"white": 4} if name == "hable" else {})):
            got = np.array(page.run(f"""(() => {{
                const op = tonewright.operators.find((op) => op.name === {json.dumps(name)});
                const numbers = {json.dumps([[str(x) for x in row] for row in rgb.astype(float).tolist()])};
                const number = (x) => x === 'inf' ? Infinity : x === '-inf' ? -Infinity : Number(x);
                return numbers.map((color) => tonewright.reference(op, color.map(number), {exposure},
                    {{ ...op.values, ...{json.dumps(setting)} }}));
            }})()"""), float)
            options = [f"--set={key}={value}" for key, value in setting.items()]
            want = reference(command, name, rgb, f"--exposure={exposure}", *options)
            # eval prints 12 digits. Formulas are written as shaders need them: where the reference subtracts numbers that are
            # nearly equal, a series of a few terms is up to 3e-10 off. The page has nodes of a LUT file as floats, rounded by
            # 6e-8 of a code at most. Nodes of the guard rail of looks are decimals with seven digits, whose last one may be
            # another where two logarithms differ; looks steepen either up to 4 times.
            is_rounded = page.run(f"tonewright.findOperator({json.dumps(name)}).textures.some((t) => !t.has_formula || t.size[0] === 37)")
            bound = 4e-7 if is_rounded else 1e-9
            error = float(np.max(np.abs(got - want)))
            report.check(f"{name} {exposure:+g} {setting or ''}: reference {error:.1e} (bound {bound:g})", error <= bound,
                         f"worst at {rgb[np.argmax(np.max(np.abs(got - want), axis=1))]}")


PIXELS = """(() => {
    const { canvas } = tonewright.view;
    const gl = canvas.getContext('webgl2');
    const all = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, all);
    let text = '';
    for (let i = 0; i < all.length; i += 8192) text += String.fromCharCode(...all.subarray(i, i + 8192));
    return JSON.stringify([canvas.width, canvas.height, btoa(text)]);
})()"""


def test_reference(report, command, page):
    check_reference(report, command, page)


def canvas_of(page, width, height):
    """The picture, which is shown at 1:1 in the middle of the canvas; top row first."""
    w, h, data = json.loads(page.run(PIXELS))
    rgba = np.frombuffer(base64.b64decode(data), np.uint8).reshape(h, w, 4)[::-1, :, :3]
    return rgba[(h - height) // 2:(h - height) // 2 + height, (w - width) // 2:(w - width) // 2 + width].astype(int)


def ppm(path):
    """Pixels of the PPM that apply writes."""
    data = path.read_bytes()
    magic, size, most, pixels = data.split(b"\n", 3)
    assert (magic, most) == (b"P6", b"255"), (magic, most)
    width, height = map(int, size.split())
    return np.frombuffer(pixels, np.uint8).reshape(height, width, 3).astype(int)


def drop_chart(command, page, scratch, width, height):
    exr = scratch / "dropped.exr"
    tonewright_run(command, "chart", "-o", exr, "-d", "half", "--width", width, "--height", height)
    page.give_file("#open", exr)
    page.wait("tonewright.view.picture?.name === 'dropped.exr'")
    return exr


def test_picture(report, command, page, scratch):
    """A picture that is dropped, through several operators and exposures, and what `apply` writes."""
    width, height = 640, 360
    exr = drop_chart(command, page, scratch, width, height)
    for name, exposure in (("hable", 0), ("agx_blender", 1.5), ("aces_20", -1), ("drago", 0)):
        page.run(f"""tonewright.state.slots[0].op = {json.dumps(name)};
            tonewright.change({{ exposure: {exposure}, mode: 'single', zoom: 1, x: {width / 2}, y: {height / 2} }})""")
        got = canvas_of(page, width, height)
        out = scratch / "applied.ppm"
        tonewright_run(command, "apply", exr, out, "--operator", name, f"--exposure={exposure}")
        difference = np.abs(got - ppm(out))
        # Values next to the middle between two codes may round either way; drago also takes the page's own statistics.
        report.check(f"{name} {exposure:+g}: picture within 1 of 255", difference.max() <= 1, f"{difference.max()} off")
        report.check(f"{name} {exposure:+g}: 99 % of the numbers equal", np.mean(difference == 0) > 0.99, f"{np.mean(difference == 0)}")


def test_small_view(report, command, page, scratch):
    """A view of every fourth pixel, whose smaller pictures the first panel makes: all panels show the same."""
    exr = scratch / "small_view.exr"
    tonewright_run(command, "chart", "-o", exr, "-d", "half", "--width", 1536, "--height", 864)
    page.run("for (const slot of tonewright.state.slots) slot.op = 'hable'; tonewright.change({ mode: 'grid', exposure: 0, zoom: 0 })")
    page.drop(exr)
    page.wait("tonewright.view.picture?.name === 'small_view.exr'")
    page.run("tonewright.change({ zoom: 0.25, x: 768, y: 432 })")
    w, h, data = json.loads(page.run(PIXELS))
    rgba = np.frombuffer(base64.b64decode(data), np.uint8).reshape(h, w, 4)
    half = w // 2
    top = rgba[h - h // 2:]
    report.check("zoom 25 %: both panels show the same picture", len(np.unique(top)) > 50 and np.array_equal(top[:, :half], top[:, half:2 * half]))


def test_real_pictures(report, command, page, scratch, shared_data):
    """Photographs and a picture in XYZ, half floats in PIZ, as others wrote them."""
    for name in ("Desk.exr", "XYZ.exr", "t05.exr", "Tree.exr", "memorial.hdr") if IS_FULL else ("Desk.exr", "XYZ.exr"):
        page.give_file("#open", shared_data / "data" / "hdr" / name)
        page.wait(f"tonewright.view.picture?.name === {json.dumps(name)}")
        width, height = page.run("[tonewright.view.picture.width, tonewright.view.picture.height]")
        page.run("tonewright.state.slots[0].op = 'hable'; tonewright.change({ exposure: 0, mode: 'single', "
                 f"zoom: 1, x: {width / 2}, y: {height / 2} }})")
        page.resize(width + 400, height + 700)
        page.wait(f"tonewright.view.canvas.height >= {height}")
        out = scratch / "applied.ppm"
        # The page shows the color as it is in the file.
        tonewright_run(command, "apply", shared_data / "data" / "hdr" / name, out, "--operator", "hable", "--no-unpremult")
        difference = np.abs(canvas_of(page, width, height) - ppm(out))
        report.check(f"{name}: picture within 1 of 255", difference.max() <= 1, f"{difference.max()} off")
    page.resize(1440, 900)


def test_probe(report, command, page, scratch):
    drop_chart(command, page, scratch, 640, 360)
    page.run("tonewright.state.slots[0].op = 'hable'; tonewright.change({ exposure: 0.5 })")
    probe = page.run("tonewright.probe(0, 400, 180)")
    want = reference(command, "hable", np.array([probe["scene"]], np.float32), "--exposure=0.5")[0]
    by_name = {row["name"]: row for row in probe["rows"]}
    error = np.max(np.abs(np.array(by_name["Reference, 64-bit float"]["shown"]) - want))
    report.check("probe: the reference's numbers", error <= 1e-9, f"{error}")
    error = np.max(np.abs(np.array(by_name["Shader, on this machine"]["shown"]) - want))
    # The float error that `tonewright shader hable` measures is below 1e-6; drivers may be some times as far off.
    report.check("probe: the shader's numbers", error <= 1e-5, f"{error}")
    report.check("probe: a dropped picture has no other backends",
                 all("dropped" in row["why"] for row in probe["measured"]) and probe["measured"], str(probe["measured"]))
    page.run("document.getElementById('choose').value = '0'; document.getElementById('choose').dispatchEvent(new Event('change'))")
    page.run("tonewright.change({ exposure: 0 })")
    probe = page.run("tonewright.probe(0, 0, 0)")
    worst = {row["name"]: max(map(abs, row["difference"])) for row in probe["measured"]}
    report.check("probe: backends of an embedded picture", len(worst) >= 3, str(probe["measured"]))
    # OpenColorIO's bounds are below 0.002 of an 8-bit code for a curve, which is what the page stores in units of 1/1024.
    report.check("probe: engine and OpenColorIO are exact", all(v <= 0.002 for k, v in worst.items() if "LUT" not in k), str(worst))


def test_files(request, report, command, page, scratch):
    """The .cube and the .tone file that the page saves, read by the command."""
    slot = "{ op: 'hable', values: { white: 5.5, exposure_bias: 3 } }"
    page.run("tonewright.change({ exposure: 0.5 })")
    settings = ["--set=white=5.5", "--set=exposure_bias=3"]
    cube, tone = scratch / "page.cube", scratch / "page.tone"
    cube.write_text(page.run(f"tonewright.cubeOf({slot})"))
    tone.write_text(page.run(f"tonewright.toneOf({slot})"))
    page.run("tonewright.change({ exposure: 0 })")
    # Nodes of the LUT: ACEScct (Academy S-2016-001) at multiples of 1/32.
    code = np.array([[6, 20, 11], [15, 15, 15], [24, 2, 30]]) / 32
    light = np.where(code <= 0.155251141552511, (code - 0.0729055341958355) / 10.5402377416545, 2 ** (code * 17.52 - 9.72)).astype(np.float32)
    want = reference(command, "hable", light, "--exposure=0.5", *settings)
    lines = subprocess.run([command, "eval", "--lut", cube, "--input-encoding", "none", "-q"], input="\n".join(" ".join(map(str, row)) for row in code),
                           check=True, capture_output=True, text=True).stdout
    error = np.max(np.abs(np.array(lines.split(), float).reshape(-1, 3) - want))
    # 7 decimals in the file, and floats on the way.
    report.check(f"Save .cube: nodes {error:.1e} (bound 5e-7)", error <= 5e-7)
    rgb = np.array(pick(list(colors()), 40), np.float32)
    error = np.max(np.abs(reference(command, str(tone), rgb) - reference(command, "hable", rgb, *settings)))
    report.check(f"Save .tone: {error:.1e}", error <= 1e-12)
    page.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(scratch))
    page.run("[...document.querySelectorAll('button')].find((b) => b.textContent === 'Save PNG').click()")
    png = scratch / f"{page.run('tonewright.state.slots[0].op')}.png"
    end = time.monotonic() + 20
    while not png.is_file() and time.monotonic() < end:
        page.receive(0.1)
    data = png.read_bytes() if png.is_file() else bytes(24)
    width, height = struct.unpack(">II", data[16:24])
    size = page.run("[tonewright.view.canvas.width, tonewright.view.canvas.height]")
    report.check("Save PNG: the view with a caption below it", data[1:4] == b"PNG" and width == size[0] and size[1] < height < 1.3 * size[1],
                 f"{width} x {height}, {size}")
    if folder := request.config.getoption("--screenshots"):
        png.replace(folder / "saved.png")


def test_keyboard(report, page):
    """Without a pointer: an operator, the exposure, the probe, another tab."""
    page.run("document.getElementById('operators').focus()")
    before = page.run("tonewright.state.slots[0].op")
    page.press("ArrowDown")
    report.check("keyboard: the next operator", page.run("tonewright.state.slots[0].op") != before, before)
    page.run("document.querySelector('[type=search]').focus()")
    for key in "khronos":
        page.press(key)
    page.press("ArrowDown")
    report.check("keyboard: search", page.run("tonewright.state.slots[0].op") == "khronos_neutral", page.run("tonewright.state.slots[0].op"))
    page.run("document.getElementById('exposure').focus()")
    page.press("ArrowRight")
    report.check("keyboard: exposure", abs(page.run("tonewright.state.exposure") - 0.05) < 1e-9, page.run("tonewright.state.exposure"))
    page.run("document.getElementById('stage').focus()")
    page.press("ArrowRight")
    page.wait("document.querySelector('#probe caption') !== null")
    report.check("keyboard: probe", "Khronos" in page.run("document.querySelector('#probe caption').textContent"), "")
    page.run("document.getElementById('tab_picture').focus()")
    page.press("ArrowRight")
    report.check("keyboard: tabs", page.run("tonewright.state.tab") == "curves", page.run("tonewright.state.tab"))
    stops = set()
    page.run("tonewright.change({ tab: 'picture' }); document.activeElement.blur()")
    for _ in range(60):
        page.press("Tab")
        stops.add(page.run("document.activeElement.id || document.activeElement.textContent.slice(0, 20)"))
    report.check("keyboard: Tab reaches everything", {"exposure", "stage", "operators", "probe", "Save PNG", "Wipe"} <= stops, str(stops))


def test_link(report, page, file):
    page.run("""tonewright.state.slots[1].op = 'hable'; tonewright.state.slots[1].values = { white: 5 };
        tonewright.change({ tab: 'picture', mode: 'wipe', exposure: -1.25, wipe: 0.25, clipping: true })""")
    # The address follows 250 ms after the last change; on a busy machine, later.
    page.wait("location.hash.includes('clipping=1')")
    fragment = page.run("location.hash")
    page.open(file, fragment)
    got = page.run("""(({ mode, exposure, wipe, clipping, slots }) => ({ mode, exposure, wipe, clipping, b: slots[1] }))(tonewright.state)""")
    want = {"mode": "wipe", "exposure": -1.25, "wipe": 0.25, "clipping": True, "b": {"op": "hable", "values": {"white": 5}}}
    report.check("link: it restores the view", got == want, f"{fragment} {got}")
    page.open(file, "#a=<img src=x onerror=alert(1)>&exposure=1e9&mode=x&a.white=no&picture=77&tab=__proto__")
    got = page.run("[tonewright.state.exposure, tonewright.state.mode, tonewright.state.picture, tonewright.state.tab]")
    report.check("link: what is no value is left out", got == [0, "single", 0, "picture"], str(got))


def test_damaged(report, command, page, scratch):
    """Each file: one clear message in the page, which goes on."""
    whole = scratch / "whole.exr"
    tonewright_run(command, "chart", "-o", whole, "-d", "half", "--width", 320, "--height", 180)
    good = whole.read_bytes()
    window = good.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
    files = {
        "empty": b"",
        "text": b"hello, world",
        "header cut": good[:60],
        "cut in half": good[:len(good) // 2],
        "cut at the end": good[:-1],
        "huge": good[:window] + struct.pack("<4i", 0, 0, 200000, 200000) + good[window + 16:],
        "negative size": good[:window] + struct.pack("<4i", 0, 0, -5, -5) + good[window + 16:],
        "deep": good[:4] + struct.pack("<i", 2 | 0x800) + good[8:],
        "multi-part": good[:4] + struct.pack("<i", 2 | 0x1000) + good[8:],
        "damaged pixels": good[:-4000] + bytes(4000),
        "HDR cut": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100 +X 100\n\2\2\0",
        "HDR huge": b"#?RADIANCE\n\n-Y 99999999 +X 99999999\n",
    }
    for name, contents in files.items():
        file = scratch / f"{name}.exr"
        file.write_bytes(contents)
        page.run("document.getElementById('message').textContent = ''")
        start = time.monotonic()
        page.give_file("#open", file)
        page.wait("document.getElementById('message').textContent !== ''", 20)
        message = page.run("document.getElementById('message').textContent")
        report.check(f"{name}: {message}", message.startswith(f"{name}.exr: ") and time.monotonic() - start < 5, f"{time.monotonic() - start:.1f} s")
    report.check("damaged files: the picture stays", page.run("tonewright.view.picture.name") == "chart", "")


def test_command(report, command, scratch):
    """Errors of the command: one line, the right exit code, no file."""
    file = scratch / "no.html"
    for arguments, code, words in (
            ([], 2, "-o is missing"),
            (["-o", file, "--operators", "habel"], 2, "did you mean hable?"),
            (["-o", file, "--width", "10"], 2, "expected"),
            (["-o", scratch / "no.txt"], 2, "expected a name that ends in .html"),
            (["-o", file, "--operators", scratch / "missing.cube"], 3, "missing.cube"),
            (["-o", file, scratch / "missing.exr"], 3, "missing.exr"),
            (["-o", scratch / "no" / "page.html"], 3, "write: ")):
        done = subprocess.run([command, "report", *map(str, arguments)], capture_output=True, text=True, check=False)
        is_one_line = done.stderr.count("\n") == 1 and done.stdout == ""
        report.check(f"report {' '.join(map(str, arguments))}: exit code {code}",
                     done.returncode == code and words in done.stderr and is_one_line, f"{done.returncode} {done.stderr}")
    report.check("report: no file after an error", not file.exists())


@pytest.mark.full
def test_own(report, command, page, scratch):
    """A .tone file and a LUT as operators of the page: its reference against `eval`."""
    (scratch / "own.tone").write_text('tonewright = 1\nid = "own"\n[[stage]]\ncurve = "max(x, 0)/(max(x, 0) + 1)"\n')
    tonewright_run(command, "bake", "hable", "--input", "lin_rec709", "--3d", "-o", scratch / "film.cube", "-q")
    file = scratch / "own.html"
    tonewright_run(command, "report", "-o", file, "--operators", f"{scratch}/own.tone,{scratch}/film.cube")
    page.open(file)
    check_reference(report, command, page)
    named = page.run("tonewright.operators.map((op) => op.name).join(' ')")
    report.check("report: operators from files", "own.tone" in named and "film.cube" in named, named)


@pytest.mark.full
def test_kinds(report, command, page, scratch):
    """Every compression and kind of OpenEXR file, as OpenImageIO writes them."""
    plain = scratch / "none.exr"
    tonewright_run(command, "chart", "-o", scratch / "kinds.exr", "-d", "half", "--width", 320, "--height", 180)

    def write(name, *arguments, source=None):
        file = scratch / f"{name}.exr"
        subprocess.run(["oiiotool", source or plain, *arguments, "-o", file], check=True)
        return file

    def shown(file):
        page.run("document.getElementById('message').textContent = ''")
        page.give_file("#open", file)
        page.wait(f"tonewright.view.picture?.name === {json.dumps(file.name)} || document.getElementById('message').textContent !== ''", 20)
        message = page.run("document.getElementById('message').textContent")
        return message, np.array(page.run("[...tonewright.view.picture.rgba.filter((_, i) => i % 4 < 3 && i % 7 === 0)]"))

    write("none", "--compression", "none", source=scratch / "kinds.exr")
    want = shown(plain)[1]
    for name, arguments in (("rle", ()), ("zips", ()), ("zip", ()), ("piz", ()), ("pxr24", ()), ("tiles", ("--tile", 64, 64))):
        file = write(name, *map(str, arguments or ("--compression", name)))
        message, got = shown(file)
        report.check(f"OpenEXR, {name}: the same numbers", message == "" and np.array_equal(got, want), message)
    for name in ("dwaa", "dwab"):
        # With losses: against what OpenImageIO reads, whose transform rounds at another place. parse-exr is off by more in
        # blocks with channels far below 0, which are 0.3 % of the chart.
        read = write(name + "_read", "--compression", "none", source=write(name, "--compression", name))
        theirs, (message, got) = shown(read)[1], shown(scratch / f"{name}.exr")
        share = np.mean(np.abs(got - theirs) <= 0.01 * (np.abs(theirs) + 0.01))
        report.check(f"OpenEXR, {name}: {100 * share:.2f} % of the numbers within 1 %", message == "" and share > 0.995, message)
    for name, words, arguments in (("b44", "B44", ("--compression", "b44")), ("real_deep", "deep", ("--ch", "A=1,R,G,B,Z=1", "--deepen")),
                                   ("parts", "several parts", (plain, "--siappend"))):
        message = shown(write(name, *map(str, arguments)))[0]
        report.check(f"OpenEXR, {name}: {message}", words in message and message.startswith(f"{name}.exr: "))


def test_not_finite(report, command, page, scratch):
    """NaN and infinities are shown as `apply` shows them: NaN as black."""
    file = scratch / "nan.hdr.exr"
    tonewright_run(command, "chart", "-o", file, "-d", "float", "--width", 320, "--height", 180)
    page.give_file("#open", file)
    page.wait("tonewright.view.picture?.name === 'nan.hdr.exr'")
    page.run("""(() => {
        const picture = tonewright.view.picture;
        picture.rgba.set([NaN, NaN, NaN, 1, Infinity, -Infinity, NaN, 1]);
        tonewright.view.setPicture(picture);
        tonewright.state.slots[0].op = 'hable';
        tonewright.change({ exposure: 0 });
    })()""")
    shown = [page.run(f"tonewright.probe(0, {x}, 0).rows.map((row) => row.shown)") for x in (0, 1)]
    want = reference(command, "hable", np.array([[0, 0, 0], [np.inf, -np.inf, 0]], np.float32))
    error = max(np.max(np.abs(np.array(row) - want[i])) for i in (0, 1) for row in shown[i])
    report.check("NaN and infinities: reference and shader", error <= 1e-5, str(shown))


def test_silence(report, page):
    report.check("console: nothing", not page.errors, "\n".join(page.errors))
    foreign = {url.split("/")[0] for url in page.requests} - {"file:", "blob:", "data:", "about:blank"}
    report.check("network: nothing", not foreign, str(foreign))
    blocked = page.run("""new Promise((resolve) => {
        addEventListener('securitypolicyviolation', (event) => resolve(event.violatedDirective));
        fetch('http://127.0.0.1:9/').catch(() => {});
        setTimeout(() => resolve(''), 60000);
    })""")
    report.check("policy: the page cannot fetch", blocked in ("connect-src", "default-src"), blocked)


@pytest.mark.full
def test_hdr(report, command, page, file):
    """The HDR version of operators on WebGPU if the display is HDR; otherwise one line with the reason."""
    page.open(file)
    note = "document.querySelector('.tools > .note').textContent"
    report.check("HDR: the page says that the display is not HDR", "not HDR" in page.run(note), page.run(note))
    # Chromium's DevTools do not emulate an HDR display, and only with Vulkan has it canvases of WebGPU without a GPU.
    with Page(flags=("--use-vulkan=swiftshader", "--enable-features=Vulkan")) as hdr:
        hdr.call("Page.addScriptToEvaluateOnNewDocument", source="""const original = matchMedia;
            globalThis.matchMedia = (query) => query.includes('dynamic-range') ? { matches: true, addEventListener() {} } : original(query);""")
        check_hdr_forms(report, command, hdr, file)
        report.check("HDR: console: nothing", not hdr.errors, "\n".join(hdr.errors))


def extended_srgb(light):
    """IEC 61966-2-1 beyond [0, 1], as CSS Color 4 extends it."""
    size = np.abs(np.array(light))
    return np.sign(light) * np.where(size <= 0.0031308, 12.92 * size, 1.055 * size ** (1 / 2.4) - 0.055)


def check_hdr_forms(report, command, page, file):
    note = "document.querySelector('.tools > .note').textContent"
    page.open(file, "#a=agx_blender&hdr=1")
    page.wait("!document.getElementById('hdr_canvas').hidden")
    names = page.run("tonewright.operators.filter((op) => op.hdr).map((op) => op.name)")
    report.check("HDR: operators that have it", {"agx_blender", "aces_20", "gt7"} <= set(names), str(names))
    for name in names:
        # A lit sphere, a light of 60, and a hue sweep of the chart.
        for x, y in ((520, 240), (553, 203), (100, 200))[:3 if IS_FULL else 1]:
            got = page.run(f"""(async () => {{
                const op = tonewright.findOperator({json.dumps(name)});
                const hdr = await tonewright.view.hdrRenderer();
                const picture = tonewright.view.picture;
                hdr.setPicture(picture);
                const values = tonewright.hdrValuesOf({{ op: op.name, values: {{}} }});
                const at = 4 * (picture.width * {y} + {x});
                const scene = [...picture.rgba.subarray(at, at + 3)];
                return {{ scene, settings: op.hdr.settings, error: op.hdr.error, light: await hdr.probe(op, values, 1, {x}, {y}, true),
                    code: await hdr.probe(op, values, 1, {x}, {y}, false), exact: tonewright.reference(op.hdr, scene, 1, values) }};
            }})()""")
            settings = [f"--set={setting}" for setting in got["settings"]]
            want = reference(command, name, np.array([got["scene"]], np.float32), "--exposure=1", "--display=linear", *settings)[0]
            error = np.max(np.abs(np.array(got["exact"]) - want))
            # As check_reference(), of light up to 10.
            report.check(f"HDR: {name}, pixel {x}, {y}: reference {error:.1e} (bound 1e-8)", error <= 1e-8, f"{got} {want}")
            # The error that the shader's text states, in sRGB code values that go on above 1, is of operations rounded once;
            # SwiftShader is up to three times as far off (measured_errors.inc).
            bound = max(3 * got["error"], 1e-5)
            error = np.max(np.abs(extended_srgb(got["light"]) - extended_srgb(want))) / max(1, np.max(extended_srgb(want)))
            report.check(f"HDR: {name}, pixel {x}, {y}: WGSL {error:.1e} (bound {bound:.1e})", error <= bound, f"{got} {want}")
            # WGSL allows pow an error of some 1e-5 of codes up to 3.
            error = np.max(np.abs(extended_srgb(got["light"]) - got["code"]))
            report.check(f"HDR: {name}, pixel {x}, {y}: extended sRGB {error:.1e} (bound 6e-5)", error <= 6e-5, str(got))
    bright = page.run("""(async () => {
        const hdr = await tonewright.view.hdrRenderer();
        return hdr.probe(tonewright.findOperator('agx_blender'), tonewright.hdrValuesOf({ op: 'agx_blender', values: {} }), 6, 553, 203, false);
    })()""")
    report.check("HDR: lights are brighter than white", max(bright) > 1.5, str(bright))
    page.run("tonewright.state.slots[0].op = 'hable'; tonewright.state.hdr = true; tonewright.change()")
    report.check("HDR: an operator without it says so", "no HDR version" in page.run(note), page.run(note))


def test_names(report, page, file):
    """The tables of names that other programs use, below the dialects."""
    page.open(file, "#tab=dialects")
    heads = page.run("[...document.querySelectorAll('#dialects h3')].map((head) => head.textContent)")
    report.check("names of other programs", '"ACES"' in heads and '"Filmic"' in heads, str(heads))
    rows = page.run("[...document.querySelectorAll('#dialects .names th[scope=row]')].map((head) => head.textContent)")
    report.check("an operator and its uses", any(row.endswith("hejl_burgess_dawson: three.js CineonToneMapping, postprocessing CINEON, "
                                                              "model-viewer cineon, gainmap-js CineonToneMapping, "
                                                              "ray-tracing-renderer CineonToneMapping") for row in rows), str(rows))


def test_screenshots(request, page, file):
    """No test: with --screenshots, pictures for people to look at."""
    folder = request.config.getoption("--screenshots")
    if not folder:
        return
    for width, height, scale in ((1440, 900, 1), (1920, 1080, 1), (390, 844, 2), (720, 450, 2)):
        page.resize(width, height, scale, width < 500)
        for tab in ("picture", "curves", "parity", "dialects"):
            page.open(file, f"#tab={tab}&mode=wipe")
            time.sleep(0.5)
            page.screenshot(folder / f"{tab}_{width}x{height}.png")
