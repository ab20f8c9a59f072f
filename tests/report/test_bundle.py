# SPDX-License-Identifier: Apache-2.0
"""The page's bundle, built again from npm packages; accessibility by axe-core; first paint, a 4K picture, and flipping.

    python3 -m pytest tests/report/test_bundle.py --tonewright build/release/bin/tonewright

src/report/viewer.html must be what src/report/web/build.mjs makes of the locked packages. axe-core, one of them, finds no
violation in any view, on a desktop and on a phone.
"""
import json
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from chromium import Page
from executed import skip

REPORT = Path(__file__).resolve().parents[2] / "src" / "report"


@pytest.fixture(scope="module")
def web(tmp_path_factory):
    """The sources of the page with their packages, in a folder of their own."""
    folder = tmp_path_factory.mktemp("web")
    for program, package in (("node", "nodejs"), ("npm", "npm")):
        if not shutil.which(program):
            skip(f"{program} is missing (Debian: {package})")
    web = folder / "web"
    shutil.copytree(REPORT / "web", web, ignore=shutil.ignore_patterns("node_modules"))
    done = subprocess.run(["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts", "--fetch-retries=1"], cwd=web, capture_output=True,
                          text=True, check=False)
    if done.returncode:
        skip(f"npm cannot install the packages of src/report/web ({(done.stderr.strip().splitlines() or ['no reason'])[0]})")
    return web


@pytest.fixture(scope="module")
def file(command, web, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "page.html"
    subprocess.run([command, "report", "-o", path, "--operators", "agx_blender,agx_threejs,aces_20,hable,khronos_neutral"], check=True)
    return path


@pytest.fixture(scope="module")
def page(file):
    """One browser for all tests: the last one looks at all that it has said."""
    with Page() as browser:
        yield browser


def test_bundle(report, web):
    subprocess.run(["node", "build.mjs", "viewer.html"], cwd=web, check=True)
    is_same = (web / "viewer.html").read_bytes() == (REPORT / "viewer.html").read_bytes()
    report.check("src/report/viewer.html is the bundle of src/report/web", is_same, "run `npm ci && npm run build` in src/report/web")


def test_axe(report, page, file, web):
    axe = (web / "node_modules" / "axe-core" / "axe.min.js").read_text() + "; undefined"
    for width, height, name in ((1440, 900, "desktop"), (390, 844, "phone"), (720, 450, "200 %")):
        page.resize(width, height, 2 if width < 1000 else 1, width < 500)
        for view in ("tab=picture&mode=grid", "tab=curves", "tab=parity", "tab=dialects"):
            page.open(file, f"#{view}")
            if "picture" in view:
                page.run("tonewright.view.probeAt(0, 30, 30)")
                page.wait("document.querySelector('#probe caption') !== null")
            page.run(axe)
            passed, found = page.run("axe.run().then(({ passes, violations }) => [passes.length, "
                                     "violations.map(({ id, nodes }) => [id, nodes[0].html.slice(0, 120)])])")
            report.check(f"axe-core, {name}, {view}: {passed} rules hold, {len(found)} do not", passed > 15 and not found, json.dumps(found))
        # A phone shows only a part of a page that is too wide.
        wide = page.run("document.documentElement.scrollWidth - innerWidth")
        report.check(f"{name}: no scrolling sideways", wide <= 0, f"{wide} pixels")


def test_speed(report, command, page, file, scratch):
    """Bounds are three times what two busy cores take with software rendering, so that only a real regression fails."""
    page.resize(1920, 1080)
    page.open(file)
    page.wait("performance.getEntriesByName('first-contentful-paint').length > 0")
    paint = page.run("performance.getEntriesByName('first-contentful-paint')[0].startTime")
    report.check(f"first paint after {paint:.0f} ms (bound 3000)", paint < 3000)
    large = scratch / "4k.exr"
    subprocess.run([command, "chart", "-o", large, "-d", "half", "--width", "3840", "--height", "2160"], check=True)
    start = time.monotonic()
    page.give_file("#open", large)
    page.wait("tonewright.view.picture?.name === '4k.exr'")
    seconds = time.monotonic() - start
    report.check(f"4K picture of half floats shown after {seconds:.2f} s (bound 9)", seconds < 9)
    check_flips(report, page)


# Milliseconds from the change of the operator to its pixels.
FLIP = """(async (name) => {
    const gl = tonewright.view.canvas.getContext('webgl2');
    const start = performance.now();
    tonewright.state.slots[0].op = name;
    tonewright.change({ mode: 'single', active: 0 });
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    return performance.now() - start;
})"""


def check_flips(report, page):
    """At 1920 x 1080, with software rendering, on the chart that fills the view."""
    page.run("document.getElementById('choose').value = '0'; document.getElementById('choose').dispatchEvent(new Event('change'))")
    size = page.run("`${tonewright.view.canvas.width} x ${tonewright.view.canvas.height}`")
    names = page.run("tonewright.operators.filter((op) => op.glsl && !op.facts.is_diagnostic).map((op) => op.name)")

    def flip(kind, bound, rounds):
        # The least of some rounds, because other programs use the machine, too.
        times = {name: min(page.run(f"{FLIP}({json.dumps(name)})") for _ in range(rounds)) for name in names}
        median = sorted(times.values())[len(times) // 2]
        print(f"     {kind}, canvas of {size} pixels: " + ", ".join(f"{name} {time:.0f} ms" for name, time in times.items()))
        report.check(f"flipping, {kind}: median {median:.0f} ms (bound {bound:.0f})", median < bound)
        return median

    # Half a million pixels through one operator, and its compilation, while other programs may use both cores.
    page.run("tonewright.change({ exposure: 0.3 })")
    first = flip("for the first time", 600, 1)
    # A change within 50 ms seems to come at once, and the copy of a kept view takes 17 ms on a quiet machine. Where it takes
    # longer, a third of the first time still shows that nothing was computed again: the copy is a fifth of it or less.
    bound = max(50, first / 3)
    flip("again", bound, 8)
    # The arrow keys show what was drawn ahead: the same copy.
    times = {name: [] for name in names[1:4]}
    for exposure in (0.7, 0.8, 0.9):
        page.run(f"tonewright.change({{ exposure: {exposure} }})")
        page.run(f"{FLIP}({json.dumps(names[0])})")
        for name in times:
            page.wait(f"tonewright.view.drawAhead([tonewright.findOperator({json.dumps(name)})]) === false")
            times[name].append(page.run(f"{FLIP}({json.dumps(name)})"))
    worst = max(map(min, times.values()))
    report.check(f"flipping, drawn ahead: {worst:.0f} ms at most (bound {bound:.0f})", worst < bound)


def test_gallery(report, command, page, scratch):
    """The pictures of `./run gallery`: OpenImageIO reads them, and the page shows each."""
    subprocess.run([sys.executable, REPORT / "gallery_pictures.py", scratch / "gallery"], check=True)
    pictures = sorted((scratch / "gallery").iterdir())
    subprocess.run([command, "report", "-o", scratch / "gallery.html", "--operators", "agx_blender", "--no-parity", *pictures], check=True)
    page.open(scratch / "gallery.html")
    for i, picture in enumerate(pictures):
        page.run(f"document.getElementById('choose').value = '{i}'; document.getElementById('choose').dispatchEvent(new Event('change'))")
        # Each has shadows and what is brighter than white.
        low, high = page.run("tonewright.view.picture.rgba.reduce(([a, b], x, i) => i % 4 === 3 ? [a, b] : [Math.min(a, x), Math.max(b, x)], [1, 0])")
        report.check(f"gallery: {picture.stem} from {low:.3g} to {high:.3g}", page.run("tonewright.view.picture.name") == picture.name
                     and low < 0.01 and high > 2, page.run("document.getElementById('message').textContent"))


def test_console(report, page):
    report.check("console: nothing", not page.errors, "\n".join(page.errors))
