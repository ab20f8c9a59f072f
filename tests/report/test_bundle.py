# SPDX-License-Identifier: Apache-2.0
"""The page's bundle, built anew from npm packages; accessibility by axe-core; first paint, a 4K picture, and flipping.

    python3 tests/report/test_bundle.py build/release/bin/tonewright

src/report/viewer.html must be what src/report/web/build.mjs makes of the locked packages. axe-core, one of them, finds no
violation in any view, on a desktop and on a phone. The last line is `N passed, M failed`.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "parity" / "clients"), str(TESTS / "shader")]
from chromium import Page  # noqa: E402
from executed import skip  # noqa: E402
from pictures import Report  # noqa: E402

REPORT = TESTS.parent / "src" / "report"


def install(folder):
    """The sources of the page with their packages, in a folder of their own."""
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


def check_bundle(report, web):
    subprocess.run(["node", "build.mjs", "viewer.html"], cwd=web, check=True)
    is_same = (web / "viewer.html").read_bytes() == (REPORT / "viewer.html").read_bytes()
    report.check("src/report/viewer.html is the bundle of src/report/web", is_same, "run `npm ci && npm run build` in src/report/web")


def check_axe(report, page, file, axe):
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
        # Of a page that is too wide, a phone shows a part.
        wide = page.run("document.documentElement.scrollWidth - innerWidth")
        report.check(f"{name}: no scrolling sideways", wide <= 0, f"{wide} pixels")


def check_speed(report, command, page, file, scratch):
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
    flips = page.run("""(() => {
        const { canvas } = tonewright.view;
        const gl = canvas.getContext('webgl2');
        const names = tonewright.operators.filter((op) => op.glsl && !op.facts.is_diagnostic).map((op) => op.name);
        const times = {};
        for (let round = 0; round < 3; round++) for (const name of names) {
            tonewright.state.slots[0].op = name;
            const start = performance.now();
            tonewright.change({ mode: 'single' });
            gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
            times[name] = performance.now() - start;
        }
        return [`${canvas.width} x ${canvas.height}`, times];
    })()""")
    times = sorted(flips[1].values())
    print(f"     flipping, canvas of {flips[0]} pixels: " + ", ".join(f"{k} {v:.0f} ms" for k, v in flips[1].items()))
    report.check(f"flipping: median {times[len(times) // 2]:.0f} ms (bound 600)", times[len(times) // 2] < 600)


def main() -> int:
    command = str(Path(sys.argv[1]).resolve())
    report = Report()
    with tempfile.TemporaryDirectory(prefix="tonewright-") as name:
        scratch = Path(name)
        web = install(scratch)
        check_bundle(report, web)
        file = scratch / "page.html"
        subprocess.run([command, "report", "-o", file, "--operators", "agx_blender,agx_threejs,aces_20,hable,khronos_neutral"], check=True)
        with Page() as page:
            axe = (web / "node_modules" / "axe-core" / "axe.min.js").read_text() + "; undefined"
            check_axe(report, page, file, axe)
            check_speed(report, command, page, file, scratch)
            report.check("console: nothing", not page.errors, "\n".join(page.errors))
    return report.finish()


if __name__ == "__main__":
    os.environ.setdefault("LC_ALL", "C.UTF-8")
    sys.exit(main())
