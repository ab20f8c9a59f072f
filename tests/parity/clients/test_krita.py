# SPDX-License-Identifier: Apache-2.0
"""Krita with the OpenColorIO config against `tonewright apply`: what its LUT docker lists, and what its canvas shows.

    python3 -m pytest tests/parity/clients/test_krita.py --tonewright build/release/bin/tonewright

Krita runs on a screen that nobody sees, with settings of its own in a folder that is deleted, and is driven by a plugin
in its Python (Debian: krita, python3-pyqt5, xvfb): the docker's lists are chosen from as a user does, and the canvas is
read back from Mesa's software renderer.
"""

import json
import os
import subprocess

import numpy as np

from pictures import PROJECT, nearest_of_bytes, need_program, read_rgb, run, screen, skip
from test_blender import DISPLAYS, HDR, OPERATORS
from test_ocioconvert import gpu_bound

WIDTH, HEIGHT = 512, 288
BACKGROUND = 128  # of the canvas around a picture
SECONDS = 240

CONFIG, ENVIRONMENT = "OCIO", "OCIO (environment)"
# (engine, display, view, look)
JOBS = [(CONFIG, "sRGB", view, "None") for view in OPERATORS] + [
    (CONFIG, "sRGB", "AgX", "AgX - Punchy"), (CONFIG, "Display P3", "AgX", "None"),
    (CONFIG, "Rec.1886", "Hable", "None"), (CONFIG, "Rec.2020", "AgX Sobotka", "None"),
    (CONFIG, "Gamma 2.2", "Standard", "None"),
    (CONFIG, "Rec.2100-PQ", "AgX" + HDR, "None"), (CONFIG, "Rec.2100-HLG", "Hable", "None"),
    (CONFIG, "P3-D65 PQ", "ACES 1.3" + HDR, "None"), (ENVIRONMENT, "sRGB", "AgX Sobotka", "None")]

# Filter mode 0: of the four, trilinear and the others mix 1e-5 of the next pixel into each, at 100 %, too.
SETTINGS = """Krita/Ocio/UseOcio=true
Krita/Ocio/OcioColorManagementMode=1
Krita/Ocio/OcioConfigPath={config}
Krita/Ocio/InputColorSpace=Linear Rec.709
Krita/Ocio/DisplayDevice=sRGB
Krita/Ocio/DisplayView=Hable
Krita/Ocio/DisplayLook=None
OpenGLFilterMode=0
useOpenGL=true

[python]
enable_tonewright=true
"""
PLUGIN = """[Desktop Entry]
Type=Service
ServiceTypes=Krita/PythonPlugin
X-KDE-Library=tonewright
X-Python-2-Compatible=false
X-Krita-Manual=
Name=tonewright
Comment=tonewright
"""
IN_KRITA = r"""
import json, os, traceback
from krita import Extension, Krita
from PyQt5.QtCore import QTimer
from PyQt5.QtGui import QCursor
from PyQt5.QtWidgets import QComboBox, QOpenGLWidget

request = json.load(open(os.environ["TONEWRIGHT_REQUEST"]))
found = {"version": Krita.instance().version(), "lists": {}}


def finish():
    json.dump(found, open(request["found"], "w"))
    os._exit(0)  # nothing to save, and nothing to ask


def later(step, milliseconds=200):
    def guarded():
        try:
            step()
        except Exception:
            found["error"] = traceback.format_exc()
            finish()
    QTimer.singleShot(milliseconds, guarded)


class Driver(Extension):
    def setup(self):
        self.jobs, self.last = list(request["jobs"]), None
        later(self.start)

    def createActions(self, window):
        pass

    def start(self):
        window = Krita.instance().activeWindow()
        if not window or not window.qwindow().isVisible():
            return later(self.start)
        QCursor.setPos(0, 0)
        picture = Krita.instance().openDocument(request["picture"])
        found["document"] = [picture.colorModel(), picture.colorDepth(), picture.width(), picture.height()]
        window.addView(picture)
        later(self.prepare, 1000)

    def prepare(self):
        self.dock = next(d for d in Krita.instance().dockers() if d.objectName() == "LutDocker")
        self.dock.setFloating(True)  # wide, so that no name is cut
        self.dock.setVisible(True)
        self.dock.resize(1000, 500)
        Krita.instance().activeWindow().activeView().canvas().setZoomLevel(1.0)
        Krita.instance().action("PanTool").trigger()  # whose cursor is no drawing on the canvas
        later(self.next, 1000)

    def names(self, box):
        box = self.dock.findChild(QComboBox, box)
        return [box.itemText(i) for i in range(box.count())]

    def choose(self, box, name):
        self.dock.findChild(QComboBox, box).setCurrentIndex(self.names(box).index(name))

    def next(self):
        if not self.jobs:
            return finish()
        engine, display, view, look, self.path = self.jobs.pop(0)
        self.choose("m_colorManagement", engine)
        self.choose("m_cmbInputColorSpace", "Linear Rec.709")
        self.choose("m_cmbDisplayDevice", display)
        found["lists"][engine + ", " + display] = {box: self.names("m_cmb" + box)
                                                   for box in ("DisplayDevice", "View", "Look")}
        self.choose("m_cmbView", view)
        self.choose("m_cmbLook", look)
        later(self.grab)

    def grab(self):
        canvases = [w for w in Krita.instance().activeWindow().qwindow().findChildren(QOpenGLWidget)
                    if w.metaObject().className() == "KisOpenGLCanvas2"]
        if not canvases:
            found["skipped"] = "Krita has no OpenGL canvas here"
            return finish()
        image = canvases[0].grabFramebuffer()
        if image != self.last:  # until it stands still
            self.last = image
            return later(self.grab)
        image.save(self.path)
        later(self.next, 0)


Krita.instance().addExtension(Driver(Krita.instance()))
"""


def install(home, config):
    """Krita's settings and the plugin, where Krita looks for them in a home."""
    plugins = home / "share" / "krita" / "pykrita"
    (plugins / "tonewright").mkdir(parents=True)
    (plugins / "tonewright.desktop").write_text(PLUGIN)
    (plugins / "tonewright" / "__init__.py").write_text(IN_KRITA)
    for folder in ("config", "cache", "runtime"):
        (home / folder).mkdir(mode=0o700)
    (home / "config" / "kritarc").write_text(SETTINGS.format(config=config))


def ask_krita(display, config, picture, jobs, scratch):
    """Runs IN_KRITA; what it found."""
    home, request, found = scratch / "home", scratch / "request.json", scratch / "found.json"
    install(home, config)
    request.write_text(json.dumps({"picture": str(picture), "jobs": jobs, "found": str(found)}))
    environment = {**os.environ, "DISPLAY": display, "OCIO": str(config), "TONEWRIGHT_REQUEST": str(request),
                   "HOME": str(home), "XDG_CONFIG_HOME": str(home / "config"), "XDG_DATA_HOME": str(home / "share"),
                   "XDG_CACHE_HOME": str(home / "cache"), "XDG_RUNTIME_DIR": str(home / "runtime"),
                   "LIBGL_ALWAYS_SOFTWARE": "1", "QT_QPA_PLATFORM": "xcb", "LC_ALL": "C.UTF-8"}
    try:
        done = subprocess.run(["krita", "--nosplash"], capture_output=True, text=True, check=False, env=environment,
                              timeout=SECONDS)
        said = done.stdout + done.stderr
    except subprocess.TimeoutExpired as error:
        said = (error.stderr or b"").decode(errors="replace")
    if not found.is_file():
        raise RuntimeError(f"krita answered nothing: {said[-2000:]}")
    found = json.loads(found.read_text())
    if "skipped" in found:
        skip(found["skipped"])
    if "error" in found:
        raise RuntimeError(found["error"])
    return found


def of_canvas(path, scratch):
    """The picture on the canvas: what is not its background."""
    shown = read_rgb(path, scratch)
    rows, columns = np.where((np.abs(shown - BACKGROUND / 255) > 0.5 / 255).any(axis=-1))
    return shown[rows.min():rows.max() + 1, columns.min():columns.max() + 1]


def check_lists(report, lists):
    """The choices of a user, in the order of the config, from its path and from $OCIO."""
    for engine in (CONFIG, ENVIRONMENT):
        listed = lists[f"{engine}, sRGB"]
        expected = {"DisplayDevice": list(DISPLAYS), "View": [*OPERATORS, "Un-tone-mapped", "Raw"]}
        report.check(f"{engine}: displays, and the views of sRGB",
                     all(listed[box] == names for box, names in expected.items()), listed)
        looks = listed["Look"]
        report.check(f"{engine}: looks, and none",
                     len(looks) == 10 and looks[0] == "AgX - Punchy" and looks[-1] == "None", looks)
    views = lists[f"{CONFIG}, Rec.2100-PQ"]["View"]
    report.check("the views of Rec.2100-PQ", "AgX" + HDR in views and "AgX" not in views and "Hable" in views, views)


def test_views(report, command, scratch):
    need_program("krita", "krita")
    qt = subprocess.run(["/usr/bin/python3", "-c", "import PyQt5.QtWidgets"], capture_output=True, check=False)
    if qt.returncode:  # Krita has the Python of the system
        skip("Krita's Python has no PyQt5 (Debian: python3-pyqt5)")
    config = PROJECT / "ocio_config/config.ocio"
    picture = scratch / "chart.exr"
    run(command, "chart", "-o", picture, "--width", WIDTH, "--height", HEIGHT)
    jobs = [(*job, str(scratch / f"{number}.png")) for number, job in enumerate(JOBS)]
    with screen("1600x1000") as display:
        if not display:
            skip("no X server without a screen: Xvfb (Debian: xvfb)")
        found = ask_krita(display, config, picture, jobs, scratch)
    print(f"Krita {found['version']}")
    document = found["document"]
    report.check("the picture is of floats", document == ["RGBA", "F32", WIDTH, HEIGHT], document)
    check_lists(report, found["lists"])
    for engine, display, view, look, path in jobs:
        operator = OPERATORS["AgX Punchy" if look != "None" else view.split(HDR)[0]]
        run(command, "apply", picture, scratch / "expected.exr", "--operator", *operator,
            "--statistics", "defaults", "--display", DISPLAYS[display], "-d", "float")
        expected = read_rgb(scratch / "expected.exr", scratch)
        shown = of_canvas(path, scratch)
        report.compare(f"{engine}, {display}, {view}{'' if look == 'None' else ', look ' + look}",
                       nearest_of_bytes(shown, expected), expected, gpu_bound(config, view))
