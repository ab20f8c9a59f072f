# SPDX-License-Identifier: Apache-2.0
"""Drives headless Chromium through the DevTools protocol, over a pipe: no package is needed."""
import base64
import contextlib
import json
import os
import pathlib
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "shader"))
from browser import FLAGS  # noqa: E402
from executed import skip  # noqa: E402

KEYS = {"ArrowUp": 38, "ArrowDown": 40, "ArrowLeft": 37, "ArrowRight": 39, "Tab": 9, "Enter": 13, "End": 35, "Home": 36, "Backspace": 8}


class Page:
    """One page in a browser of its own. `errors` has what the console and the page's own policy reported."""

    def __init__(self, width: int = 1440, height: int = 900, flags: tuple[str, ...] = ()):
        chromium = shutil.which("chromium")
        if not chromium:
            skip("Chromium is missing (Debian: chromium)")
        self.errors: list[str] = []
        self.loads = 0
        self.requests: list[str] = []
        self.number = 0
        self.answers: dict[int, dict] = {}
        self.rest = b""
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        theirs_in, self.out = os.pipe()
        self.inn, theirs_out = os.pipe()

        def take_pipes() -> None:  # Chromium reads 3 and writes 4
            copies = [os.dup(theirs_in), os.dup(theirs_out)]
            os.dup2(copies[0], 3)
            os.dup2(copies[1], 4)

        self.browser = subprocess.Popen(
            [chromium, *FLAGS, *flags, "--remote-debugging-pipe", "--enable-precise-memory-info", f"--user-data-dir={self.profile.name}",
             f"--window-size={width},{height}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=take_pipes, close_fds=False, start_new_session=True)
        os.close(theirs_in)
        os.close(theirs_out)
        self.session = None
        target = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network", "DOM"):
            self.call(domain + ".enable")
        self.resize(width, height)

    def __enter__(self) -> "Page":
        return self

    def __exit__(self, *_) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.browser.pid, signal.SIGKILL)
        self.browser.wait()
        os.close(self.out)
        os.close(self.inn)
        self.profile.cleanup()

    def receive(self, seconds: float) -> None:
        if not select.select([self.inn], [], [], seconds)[0]:
            return
        chunk = os.read(self.inn, 1 << 20)
        if not chunk:
            raise SystemExit("Chromium ended")
        *messages, self.rest = (self.rest + chunk).split(b"\0")
        for message in map(json.loads, messages):
            parameters = message.get("params", {})
            if "id" in message:
                self.answers[message["id"]] = message
            elif message["method"] == "Runtime.exceptionThrown":
                details = parameters["exceptionDetails"]
                self.errors.append(details.get("exception", {}).get("description", details["text"]))
            elif message["method"] == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
                self.errors.append(" ".join(str(a.get("value", a.get("description"))) for a in parameters["args"]))
            elif message["method"] == "Log.entryAdded" and parameters["entry"]["level"] == "error":
                self.errors.append(parameters["entry"]["text"])
            elif message["method"] == "Page.loadEventFired":
                self.loads += 1
            elif message["method"] == "Network.requestWillBeSent":
                self.requests.append(parameters["request"]["url"])

    def call(self, method: str, timeout: float = 120, **parameters) -> dict:
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.out, data):]
        end = time.monotonic() + timeout
        while self.number not in self.answers:
            if time.monotonic() > end:
                raise SystemExit(f"Chromium: {method} has no answer after {timeout} s")
            self.receive(1)
        answer = self.answers.pop(self.number)
        if "error" in answer:
            raise SystemExit(f"Chromium: {method}: {answer['error']['message']}")
        return answer["result"]

    def resize(self, width: int, height: int, scale: float = 1, is_mobile: bool = False) -> None:
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=is_mobile)

    def open(self, path: pathlib.Path, fragment: str = "") -> None:
        # A new hash alone would not load the page again.
        self.call("Page.navigate", url="about:blank")
        before = self.loads
        self.call("Page.navigate", url=path.resolve().as_uri() + fragment)
        end = time.monotonic() + 60
        while self.loads == before and time.monotonic() < end:
            self.receive(1)
        self.wait("document.documentElement?.dataset.ready === 'true'")

    def run(self, expression: str, timeout: float = 120):
        """The value of a JavaScript expression; promises are awaited."""
        result = self.call("Runtime.evaluate", timeout, expression=expression, returnByValue=True, awaitPromise=True, userGesture=True)
        if "exceptionDetails" in result:
            details = result["exceptionDetails"]
            raise SystemExit(f"page: {details.get('exception', {}).get('description', details['text'])}")
        return result["result"].get("value")

    def wait(self, condition: str, timeout: float = 60) -> None:
        end = time.monotonic() + timeout
        while not self.run(condition):
            if time.monotonic() > end:
                raise SystemExit(f"page: not after {timeout} s: {condition}")
            time.sleep(0.02)

    def give_file(self, selector: str, path: pathlib.Path) -> None:
        root = self.call("DOM.getDocument")["root"]["nodeId"]
        node = self.call("DOM.querySelector", nodeId=root, selector=selector)["nodeId"]
        self.call("DOM.setFileInputFiles", nodeId=node, files=[str(path.resolve())])

    def drop(self, path: pathlib.Path, x: int = 500, y: int = 400) -> None:
        """A file from the desktop onto the page."""
        data = {"items": [], "files": [str(path.resolve())], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.call("Input.dispatchDragEvent", type=kind, x=x, y=y, data=data)

    def press(self, key: str, shift: bool = False) -> None:
        code = KEYS.get(key)
        text = {} if code and key != "Enter" else {"text": "\r" if key == "Enter" else key}
        common = {"key": key, "modifiers": 8 if shift else 0, "windowsVirtualKeyCode": code or ord(key.upper())}
        self.call("Input.dispatchKeyEvent", type="keyDown", **common, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", **common)

    def screenshot(self, path: pathlib.Path) -> None:
        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))
