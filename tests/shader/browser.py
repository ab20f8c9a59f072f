# SPDX-License-Identifier: Apache-2.0
"""A page in headless Chromium, without a GPU: files that it may fetch, and what it posts."""
import contextlib
import http.server
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import time

from executed import skip

# SwiftShader is the renderer of WebGL and WebGPU.
FLAGS = ["--headless=new", "--no-sandbox", "--no-first-run", "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader",
         "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--force-color-profile=srgb"]
TYPES = {".html": "text/html", ".js": "text/javascript", ".mjs": "text/javascript", ".json": "application/json"}
# An error ends the page; the test prints it.
PRELUDE = """<!doctype html><meta charset="utf-8"><script>
const post = async (name, body) => { await fetch('/' + name, { method: 'POST', body }); };
const fail = (...what) => post('failed', what.map((w) => w?.stack ? `${w} ${w.stack}` : String(w)).join(' '));
addEventListener('error', (event) => fail(event.message, event.error));
addEventListener('unhandledrejection', (event) => fail(event.reason));
console.error = fail;
const floats = async (url) => {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status}`);
    return new Float32Array(await response.arrayBuffer());
};
</script>
"""


def run_page(page: str, files: dict, timeout: float = 900) -> dict:
    """The texts that the page posts by `post(name, body)`, up to `post('finished')`.

    files: URL -> bytes, or a path; a URL that ends in a slash is a folder.
    """
    chromium = shutil.which("chromium")
    if not chromium:
        skip("Chromium is missing (Debian: chromium)")
    posted = {}
    is_over = threading.Event()

    class Handler(http.server.BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def answer(self, code: int, body: bytes = b"", url: str = "") -> None:
            self.send_response(code)
            self.send_header("Content-Type", TYPES.get(pathlib.PurePath(url).suffix, "application/octet-stream"))
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def do_GET(self) -> None:  # the name that http.server wants
            url = self.path.split("?")[0]
            if url == "/":
                return self.answer(200, (PRELUDE + page).encode(), "page.html")
            found = files.get(url)
            for folder, path in files.items():
                if folder.endswith("/") and url.startswith(folder):
                    found = pathlib.Path(path) / url[len(folder):]
            if isinstance(found, pathlib.Path):
                found = found.read_bytes() if found.is_file() else None
            return self.answer(404, url=url) if found is None else self.answer(200, found, url)

        def do_POST(self) -> None:
            posted[self.path[1:]] = self.rfile.read(int(self.headers["Content-Length"]))
            self.answer(200)
            if self.path in ("/finished", "/failed"):
                is_over.set()

        def log_message(self, *_) -> None:
            pass

    class Server(http.server.ThreadingHTTPServer):
        def handle_error(self, *_) -> None:
            pass  # the browser ends with connections open

    server = Server(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = subprocess.Popen([chromium, *FLAGS, f"--user-data-dir={profile}", f"http://127.0.0.1:{server.server_port}/"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            end = time.monotonic() + timeout
            while not is_over.wait(1):
                if browser.poll() is not None:
                    raise SystemExit(f"Chromium ended with {browser.returncode} before the page was finished")
                if time.monotonic() > end:
                    raise SystemExit(f"Chromium: the page is not finished after {timeout} s")
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(browser.pid, signal.SIGKILL)
            browser.wait()
            server.shutdown()
    if "failed" in posted:
        raise SystemExit(f"Chromium: {posted['failed'].decode()}")
    return posted
