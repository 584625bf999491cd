"""What the window imports before the mechanism stands on the screen, and what it never imports by itself."""

import json
import subprocess
import sys

SCRIPT = """
import json, sys
from PySide6.QtCore import QEvent, QObject
from kindyna_gui import __main__
from kindyna_gui.window import main_window
from kindyna_gui.pictures.app import ensure_app

app = ensure_app(offscreen=True)
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
for _ in range(30):
    app.processEvents()
told["plots"] = window.view("torque") is not None and window.view("torque").up_to_date
told["last"] = sorted(sys.modules)
window.close()
print(json.dumps(told))
"""

LATE = ("pyqtgraph", "kindyna_gui.graph.plots_view", "kindyna_gui.forms.parameters_view", "core.__main__", "kindyna_gui.headless")
NEVER = (
    "scipy",
    "PIL",
    "difflib",
    "secrets",
    "core.blend",
    "core.mechanism.drivers",
    "core.mechanism.grashof",
    "core.output.export",
    "core.output.report",
    "importlib.metadata",
    "kindyna_gui.documents.export_dialogs",
    "kindyna_gui.graph.graph_view",
    "kindyna_gui.linkage.menus",
    "kindyna_gui.pictures.drawing.construct",
    "kindyna_gui.pictures.film",
)


def loaded(modules: list[str], names: tuple[str, ...]) -> list[str]:
    return [name for name in names if any(m == name or m.startswith(f"{name}.") for m in modules)]


def test_the_mechanism_is_painted_first_and_little_is_imported_for_it() -> None:
    run = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stderr
    told = json.loads(run.stdout.splitlines()[-1])
    assert told["drawn"]
    assert told["docks"] == 0, "the docks around it come next"
    assert loaded(told["first"], LATE + NEVER) == []
    assert told["plots"], "and do come"
    assert loaded(told["last"], NEVER) == []
