"""What a command takes from its start to its end, as a process of its own: processor time, and memory at most."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
LIFT = str(ROOT / "resources" / "examples" / "transfer_lift.toml")
NUMPY = ("-c", "import numpy")
CHECK = ("-m", "core", "check", LIFT)
HEADLESS = ("-m", "kindyna_gui", "--headless")
DOCUMENTS = {
    "report as HTML": (*HEADLESS, "report", LIFT, "--out", "report.html"),
    "report as PDF": (*HEADLESS, "report", LIFT, "--out", "report.pdf"),
    "hand-over": (*HEADLESS, "handover", LIFT, "--out", "lift.zip"),
}
"""Document of the lift -> the command that writes it; the last word is its file."""
START = """
import time
from kindyna_gui.__main__ import window_module

main_window = window_module()
app = main_window.ensure_app(offscreen=True)
window = main_window.open_window(app)
window.show()
quiet = 0
while quiet < 3:
    app.processEvents()
    views = [window.view(name) for name in ("mechanism", "motion", "parameters", "findings")]
    settled = all(view is not None and view.up_to_date and not view.busy for view in views)
    quiet = quiet + 1 if settled and not views[0].canvas.rest.isActive() else 0
    time.sleep(0.0 if quiet else 0.005)
print(time.process_time())
"""
"""The window with the lift, in the layout of the first start, until nothing in sight waits for anything."""
EMPTY = """
import time
from PySide6.QtWidgets import QApplication, QMainWindow

app = QApplication([])
window = QMainWindow()
window.resize(1440, 900)
window.show()
for _ in range(4):
    app.processEvents()
print(time.process_time())
"""
STUDIES = ROOT / "resources" / "studies"
OPTIMA = {
    "smallest cam": ("-m", "core", "optimise", str(STUDIES / "lift_smallest_cam.toml")),
    "least torque": ("-m", "core", "optimise", str(STUDIES / "lift_least_torque.toml")),
}
"""Best design of the lift -> the command that searches it."""
# what a process holds at most includes what its parent held when it was made: so that has a small one of its own
BESIDE = """
import os, subprocess, sys
process = subprocess.Popen([sys.executable, *sys.argv[1:]], stdout=subprocess.DEVNULL)
_, status, spent = os.wait4(process.pid, 0)
print(os.waitstatus_to_exitcode(status), spent.ru_utime + spent.ru_stime, spent.ru_maxrss / 1024.0)
"""


@dataclass(frozen=True)
class Used:
    """Seconds of the processor, of all threads; MiB that the process held at most."""

    seconds: float
    peak_mib: float


@dataclass(frozen=True)
class Checked:
    """Seconds of ``check`` of the lift, and of Python with numpy alone."""

    whole: float
    bare: float


def _output(words: Sequence[str], **settings: str) -> list[str]:
    """The last line that Python prints with these words, its compiled modules kept from run to run."""
    env = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"} | settings
    told = subprocess.check_output([sys.executable, *words], cwd=ROOT, env=env, text=True, encoding="utf-8")
    return told.splitlines()[-1].split()


def used(words: Sequence[str]) -> Used:
    """By Python with these words. Raises RuntimeError where it fails."""
    code, seconds, peak = _output(("-c", BESIDE, *words))
    if code != "0":
        raise RuntimeError(f"{' '.join(words)}: exit code {code}")
    return Used(float(seconds), float(peak))


def check(times: int) -> Checked:
    """Least of several, in turn, the first of each not counted."""
    rows = [tuple(used(words).seconds for words in (CHECK, NUMPY)) for _ in range(times + 1)]
    return Checked(*map(min, zip(*rows[1:], strict=True)))


def start(times: int) -> float:
    """Seconds of the window with the lift by those of an empty window: the median of pairs, the first not counted."""
    with TemporaryDirectory() as folder:
        settings = {"QT_QPA_PLATFORM": "offscreen", "XDG_CONFIG_HOME": folder, "XDG_STATE_HOME": folder}
        settings["QT_LOGGING_RULES"] = "default.warning=false"  # sizes that no desktop takes
        rows = [[float(*_output(("-c", script), **settings)) for script in (START, EMPTY)] for _ in range(times + 1)]
    return statistics.median(ours / bare for ours, bare in rows[1:])


def export(angles: int) -> Used:
    """All tables of the lift at so many cam angles."""
    with TemporaryDirectory() as folder:
        return used(("-m", "core", "export", LIFT, "--out", folder, "--samples", str(angles)))


def document(name: str, times: int) -> float:
    """Of the command that writes a document, by Python with numpy alone."""
    with TemporaryDirectory() as folder:
        *words, file = DOCUMENTS[name]
        return by_numpy((*words, str(Path(folder, file))), times)


def by_numpy(command: Sequence[str], times: int) -> float:
    """Seconds of a command by those of Python with numpy alone: least of several, in turn.

    The first run, which typesets the equations of a document, is not counted.
    """
    rows = [tuple(used(run).seconds for run in (command, NUMPY)) for _ in range(times + 1)]
    ours, bare = map(min, zip(*rows[1:], strict=True))
    return ours / bare
