# SPDX-License-Identifier: Apache-2.0
"""The documentation site: it builds without a warning, all links and anchors lead somewhere, and no page asks another server.

    python3 -m pytest tests/docs/test_site.py --tonewright build/release/bin/tonewright [--site FOLDER] [--screenshots FOLDER]

Without --site, it builds the site first (two minutes). Chromium opens some pages on a screen of a desk and on one of a phone,
and searches. The spelling of the pages is checked with codespell.
"""
import functools
import html.parser
import http.server
import json
import re
import shutil
import subprocess
import sys
import threading
import time
import urllib.parse
from pathlib import Path

import pytest
from chromium import Page
from executed import skip

ROOT = Path(__file__).resolve().parents[2]

# Elements and attributes that a browser loads without a click.
LOADED = {("link", "href"), ("script", "src"), ("img", "src"), ("source", "src"), ("iframe", "src"), ("video", "src"), ("object", "data")}
# Links that a browser only follows.
NOT_LOADED = {"canonical", "next", "prev"}
# A format of pictures, and the name of a variable in a formula.
CORRECT_WORDS = "hald,fo"
SCREENS = {"desk": (1440, 900), "phone": (390, 844)}
SHOWN = ["index.html", "choosing.html", "operators/index.html", "operators/hable.html", "operators/agx_blender.html", "operators/dialects.html",
         "config.html", "shipped_luts.html", "cookbook.html", "shaders.html", "developing.html"]


class Reader(html.parser.HTMLParser):
    """Ids, links and loaded files of a page."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.links, self.loaded = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.ids.update(attributes[name] for name in ("id", "name") if attributes.get(name))
        for name, value in attributes.items():
            if not value:
                continue
            if (tag, name) in LOADED and not NOT_LOADED & set(attributes.get("rel", "").split()):
                self.loaded.append(value)
            elif name == "srcset":
                self.loaded += [part.split()[0] for part in value.split(",")]
            elif (tag, name) == ("a", "href"):
                self.links.append(value)
            elif name == "style":
                self.loaded += re.findall(r"url\(['\"]?([^'\")]+)", value)


def is_remote(address):
    return bool(urllib.parse.urlsplit(address).netloc)


def test_links(report, site):
    pages = {path: Reader(path.read_text()) for path in sorted(site.rglob("*.html"))}
    broken, remote, links = [], [], 0
    for path, page in pages.items():
        if path.name == "404.html":  # its addresses begin at the root of the server
            continue
        remote += [f"{path.relative_to(site)}: {address}" for address in page.loaded if is_remote(address)]
        for address in page.links + page.loaded:
            if urllib.parse.urlsplit(address).scheme or is_remote(address):
                continue
            links += 1
            name, _, anchor = urllib.parse.unquote(address).partition("#")
            target = (path.parent / name).resolve() if name else path
            if target.is_dir():
                target /= "index.html"
            if not target.is_file():
                broken.append(f"{path.relative_to(site)}: {address}: no such file")
            elif anchor and target in pages and anchor not in pages[target].ids:
                broken.append(f"{path.relative_to(site)}: {address}: no such anchor")
    for path in site.rglob("*.css"):
        remote += [f"{path.relative_to(site)}: {address}" for address in re.findall(r"(?:url\(|@import )['\"]?([^'\");]+)", path.read_text())
                   if is_remote(address)]
    report.check(f"{len(pages)} pages: {links} links and anchors lead somewhere", links > len(pages) and not broken, "\n     ".join(broken[:40]))
    report.check("no page loads anything from another server", not remote, "\n     ".join(remote[:40]))


def test_contents(report, site, command):
    """Every page of docs/ and every operator has a page, which the search finds."""
    listed = json.loads(subprocess.run([command, "list", "--json"], check=True, capture_output=True, text=True).stdout)
    found = {entry["location"].partition("#")[0] for entry in json.loads((site / "search/search_index.json").read_text())["docs"]}
    wanted = {str(path.relative_to(ROOT / "docs").with_suffix(".html")) for path in (ROOT / "docs").rglob("*.md")}
    wanted = {{"README.html": "guide.html", "operators.html": "operators/index.html",
               "applications/README.html": "applications/index.html"}.get(name, name) for name in wanted}
    report.check("every page of docs/ can be searched", wanted <= found, sorted(wanted - found))
    poor = []
    for op in listed["operators"] + listed["local_operators"]:
        name = f"operators/{op['id']}.html"
        text = (site / name).read_text() if name in found else ""
        needed = [f'src="{op["id"]}.png"', f"../curves/{op['id']}.svg", *(f">{p['name']}</code>" for p in op["parameters"])]
        if op["is_local"]:  # its result depends on the picture: it has no curve
            needed.pop(1)
        poor += [f"{name} lacks {what}" for what in needed if what not in text]
    report.check("every operator has a page with picture, curve and parameters", not poor, "\n     ".join(poor[:20]))


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def go(page, address):
    before = page.loads
    page.call("Page.navigate", url=address)
    end = time.monotonic() + 60
    while page.loads == before and time.monotonic() < end:
        page.receive(1)


def test_browser(request, report, site):
    folder = request.config.getoption("--screenshots")
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=site))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    root = f"http://127.0.0.1:{server.server_port}/"
    with Page() as page:
        for screen, (width, height) in SCREENS.items():
            page.resize(width, height, is_mobile=screen == "phone")
            wide = []
            for name in SHOWN:
                go(page, root + name)
                # Tables and code may scroll on their own, when the theme's script has wrapped them.
                page.wait("!document.querySelector('article table:not([class])') || !!document.querySelector('.md-typeset__scrollwrap')")
                is_width = page.run("document.documentElement.scrollWidth")
                if is_width > width:
                    wide.append(f"{name}: {is_width} pixels")
                if folder:
                    time.sleep(0.5)
                    page.screenshot(folder / f"{screen}_{name.replace('/', '_').removesuffix('.html')}.png")
            report.check(f"{len(SHOWN)} pages fit a {screen}'s screen, {width} pixels wide", not wide, "\n     ".join(wide))
        page.resize(*SCREENS["desk"])
        go(page, root + "index.html")
        # The theme's search never begins in some loads of a page, most often on a busy machine. A person loads it again.
        found = "[...document.querySelectorAll('.md-search-result__link')].some((link) => link.href.includes('operators/hable.html'))"
        for load in range(10):
            go(page, root + "index.html")
            page.run("document.querySelector('.md-search__input').focus()")
            for letter in "uncharted":
                page.press(letter)
            end = time.monotonic() + 10
            while not page.run(found) and time.monotonic() < end:
                page.receive(0.2)
            if page.run(found):
                break
            print(f"load {load + 1}: {page.run('document.querySelector(`.md-search-result__meta`)?.innerText')}")
        report.check("a search for a word of Hable's title finds its page", page.run(found))
        others = sorted({address for address in page.requests if not address.startswith((root, "about:", "data:", "blob:"))})
        report.check(f"{len(page.requests)} requests of the browser, all of them to this server", page.requests and not others, others)
        report.check("the console of the browser has no error", not page.errors, page.errors[:10])
    server.shutdown()


@pytest.fixture(scope="module")
def site(request, command, tmp_path_factory):
    """The folder of the site."""
    for tool, package in (("mkdocs", "mkdocs"), ("codespell", "codespell"), ("chromium", "chromium")):
        if not shutil.which(tool):
            skip(f"{tool} is missing (Debian: {package})")
    # Debian's package is a folder of mkdocs, not a Python module.
    if subprocess.run(["/usr/bin/python3", "-c", "from mkdocs.utils import get_theme_dir; get_theme_dir('material')"],
                      stderr=subprocess.DEVNULL, check=False).returncode:
        skip("the theme is missing (Debian: mkdocs-material)")
    if folder := request.config.getoption("--site"):
        return folder
    folder = tmp_path_factory.mktemp("site") / "site"
    done = subprocess.run([sys.executable, ROOT / "docs/site/build.py", command, folder], capture_output=True, text=True, check=False)
    assert done.returncode == 0, "mkdocs build --strict: " + done.stdout + done.stderr
    return folder


def test_spelling(report, site):
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    spelling = subprocess.run(["codespell", "--ignore-words-list", CORRECT_WORDS, *pages], capture_output=True, text=True, check=False)
    report.check(f"spelling of {len(pages)} pages", spelling.returncode == 0 and not spelling.stdout, spelling.stdout)
