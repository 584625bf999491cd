"""What opening the window loads: a budget of modules by name. A module that is not needed for the first picture is
imported where it is used, so that nobody waits for it."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]

OPEN = """
import json, linecache, sys, time
from kindyna_gui.__main__ import window_module

main_window = window_module()
from PySide6.QtCore import QEvent, QObject

app = main_window.ensure_app()
window = main_window.open_window(app)
told = {}

class Watch(QObject):
    def eventFilter(self, watched, event):
        if event.type() == QEvent.Type.Paint and not told:
            view = window.view("mechanism")
            told["drawn"] = view.up_to_date and "cam" in view.scene.parts
            told["docks"] = sum(dock.view is not None for dock in window.docks.values())
            told["first"] = sorted(sys.modules)
        return False

watch = Watch()
window.view("mechanism").canvas.viewport().installEventFilter(watch)
window.show()
end = time.monotonic() + 60.0
shown = ("mechanism", "motion", "parameters", "findings")
while time.monotonic() < end:
    app.processEvents()
    views = {name: window.docks[name].view for name in shown if name in window.docks}
    if all(view is not None and view.up_to_date for view in views.values()):
        break
else:
    sys.exit("the window was never drawn")
told["last"] = sorted(sys.modules)
told["widgets"] = len(app.allWidgets())
told["sources"] = sorted(name for name in linecache.cache if name.endswith(".py"))
print(json.dumps(told))
"""

# Whoever comes here is loaded with every start: is it worth it?
PACKAGES = {
    "core", "kindyna_gui", "numpy", "PySide6", "shiboken6", "shibokensupport", "signature_bootstrap", "pyqtgraph", "colorama",
    "tomli_w",
}  # fmt: skip
QT = {
    "QtCore",
    "QtGui",
    "QtWidgets",
    "QtSvg",
    "QtOpenGL",
    "QtOpenGLWidgets",
    "QtTest",
    "support",
}  # OpenGL, QtTest: pyqtgraph's
NUMPY_NOT = {"fft", "random", "testing", "f2py", "ctypeslib", "distutils", "rec", "emath"}
PYQTGRAPH_NOT = {
    "opengl", "console", "flowchart", "canvas", "dockarea", "examples", "jupyter", "imageview", "multiprocess", "parametertree",
}  # fmt: skip
# of our own: views behind tabs or not open, what works headless, what a menu asks for later, what only linkages have
LATER = {
    "core.__main__", "core.blend", "core.commands", "core.output.texts", "core.output.export", "core.output.report",
    "core.measured",
    "core.stability", "core.design.valve_rules", "core.design.lobe", "core.laws.lobe", "core.valves",
    "core.project.writing", "core.study.certificate", "kindyna_gui.motion.obstacles",
    "kindyna_gui.graph.flywheel_view", "kindyna_gui.graph.graph_choice", "kindyna_gui.graph.graph_view",
    "kindyna_gui.headless", "kindyna_gui.help",
    "kindyna_gui.export_dialogs", "kindyna_gui.pictures.film",
    "kindyna_gui.window.linkage_menus", "kindyna_gui.pictures.drawing.centre_parts", "kindyna_gui.pictures.painter",
    "kindyna_gui.screenshots",
    "kindyna_gui.selftest", "kindyna_gui.stability_view", "kindyna_gui.graph.plots_view",
    "kindyna_gui.linkage.drawing_mode", "kindyna_gui.linkage.drawn_linkage",
}  # fmt: skip
# what new designs, recovered work, and links in messages need, and nothing that is painted first
NOT_FIRST = {"core.mechanism.drawing", "core.shaft.balancer", "html", "kindyna_gui.files.beginnings"}
FIRST = 174
"""So many modules of our own are there when the mechanism is painted, at most."""
ALL_FIRST, ALL_LAST = 438, 569
"""So many modules are loaded when the mechanism is painted, and once every dock is drawn, at most."""
WIDGETS = 575
"""So many widgets has the window once every dock in sight is drawn, at most."""
DOCKS_BRING = {
    "pyqtgraph",
    "kindyna_gui.graph.live_plot",
    "kindyna_gui.motion.segments_view",
    "kindyna_gui.forms.parameters_view",
}
STANDARD_NOT = {"difflib", "hashlib", "importlib.metadata", "hmac", "secrets", "unittest"}


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Of a process that has opened the window with the lift and drawn it, in the layout that it has at first."""
    settings = str(tmp_path_factory.mktemp("settings"))
    env = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "PYTHONPATH": str(ROOT), "XDG_CONFIG_HOME": settings}
    done = subprocess.run(
        [sys.executable, "-c", OPEN],
        cwd=ROOT,
        env=env,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        encoding="utf-8",
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture
def loaded(told: dict[str, Any]) -> set[str]:
    """Modules once every dock is drawn."""
    return set(told["last"])


def among(names: set[str], loaded: set[str]) -> set[str]:
    """Modules that are named, or in a package that is."""
    return {name for name in loaded if name in names or name.rpartition(".")[0] in names}


def parts_of(loaded: set[str], package: str) -> set[str]:
    """The names right below a package."""
    return {name.split(".")[1] for name in loaded if name.startswith(f"{package}.")}


def test_the_window_loads_no_package_that_its_first_picture_does_without(loaded: set[str]) -> None:
    theirs = {"__main__", "sitecustomize", "usercustomize"}  # what a system makes its Python load
    outside = {name.partition(".")[0] for name in loaded} - set(sys.stdlib_module_names) - theirs
    assert {name for name in outside if not name.startswith("_")} - PACKAGES == set()
    assert {"numpy", "PySide6", "pyqtgraph", "core", "kindyna_gui"} <= outside


@pytest.mark.parametrize("package", ["scipy", "PIL", "matplotlib", "pandas", "numba"])
def test_what_takes_long_to_load_is_loaded_where_it_is_used(package: str, loaded: set[str]) -> None:
    assert package not in loaded


def test_of_qt_numpy_and_pyqtgraph_only_what_draws_is_loaded(loaded: set[str]) -> None:
    assert parts_of(loaded, "PySide6") - QT == set()
    assert parts_of(loaded, "numpy") & NUMPY_NOT == set()
    assert parts_of(loaded, "pyqtgraph") & PYQTGRAPH_NOT == set()
    assert "pyqtgraph.graphicsItems.ROI" not in loaded


def test_of_the_standard_library_nothing_is_loaded_for_a_rare_need(loaded: set[str]) -> None:
    assert STANDARD_NOT & loaded == set()


def test_views_that_nobody_sees_yet_and_what_menus_bring_are_not_loaded(loaded: set[str]) -> None:
    assert among(LATER, loaded) == set()
    assert {"kindyna_gui.linkage.mechanism_view", "kindyna_gui.motion.segments_view", "core.study"} <= loaded
    # a name that does not exist guards nothing
    for name in LATER | DOCKS_BRING - {"pyqtgraph"}:
        path = ROOT.joinpath(*name.split("."))
        assert path.is_dir() or path.with_suffix(".py").is_file(), name


def test_the_mechanism_is_painted_first_and_little_is_imported_for_it(told: dict[str, Any]) -> None:
    assert told["drawn"]
    assert told["docks"] == 0, "the docks around it come next"
    first = set(told["first"])
    assert among(LATER | DOCKS_BRING | NOT_FIRST, first) == set()
    assert len([name for name in first if name.partition(".")[0] in ("core", "kindyna_gui")]) <= FIRST
    assert len(first) <= ALL_FIRST


def test_the_window_has_few_widgets_before_its_pages_are_shown(told: dict[str, Any]) -> None:
    assert told["widgets"] <= WIDGETS


def test_no_source_is_read(told: dict[str, Any]) -> None:
    """Qt for Python reads that of every module that is imported after it, unless its import is replaced."""
    places = (f"{ROOT}/core", f"{ROOT}/kindyna_gui")
    assert [name for name in told["sources"] if name.startswith(places) or "pyqtgraph" in name] == []


def test_the_docks_load_few_modules_more(loaded: set[str]) -> None:
    assert len(loaded) <= ALL_LAST
