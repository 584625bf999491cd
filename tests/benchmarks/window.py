"""The window's frame budget: an edit until every view is painted, and a frame of the animation, by a bare repaint.

    .venv/bin/python tests/benchmarks/window.py

The lift at 1440 x 900, offscreen, 1800 cam angles. Times are processor time of the window's thread, the median of
rounds in which everything is measured in turn, so that what slows the machine slows all of them; each edit has a value
that was never there before. The yardstick is a bare repaint of the same plots and the same drawing in the same round.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[2]))
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QWidget

from core.design import get
from core.project import load
from kindyna_gui.docks import RIGHT, VIEWS, Dock, ViewRow, lazily
from kindyna_gui.headless import quiet
from kindyna_gui.main_window import MainWindow
from kindyna_gui.mechanism_view import MechanismView
from kindyna_gui.places import example
from kindyna_gui.plots_view import PlotView
from kindyna_gui.screenshots import dismiss, hidden_window, rest

SIZE = (1440, 900)
ROWS = 4  # plots one below the other
MORE = ("guide_force", "slider_position", "phi", "beta")  # to twelve
FEW, MANY = 8, 12
EDITS = (
    ("edit of a length", "follower.rod_mm", 0.037),
    ("edit of the cam", "cam.base_radius_mm", 0.011),
    ("edit of the motion", "motion.start_mm", 0.013),
    ("edit of the speed", "shaft.speed_rpm", 0.003),
)
BARE, FRAME = "bare repaint", "frame"
EDIT_KERNEL, FRAME_KERNEL = "edit to paint", "animation"
STEP = 0.0371  # of the animation [rad]
ROUNDS = 25
WARM = 3  # rounds that do not count


class Row(NamedTuple):
    """kernel, method, how many plots beside the mechanism, seconds."""

    kernel: str
    method: str
    n: int
    seconds: float


def measure(rounds: int = ROUNDS) -> list[Row]:
    """Seconds of every method with eight plots and with twelve; per kernel the last row is its yardstick."""
    with quiet():
        return [row for plots in (FEW, MANY) for row in _measured(plots, rounds)]


def _measured(plots: int, rounds: int) -> list[Row]:
    window = hidden_window(load(example("transfer_lift")), SIZE)
    try:
        _open_plots(window, plots)
        seen = _seen(window)
        assert len(seen) == plots + 1, "every plot and the mechanism are on screen"
        runs = _runs(window, seen)
        times: dict[str, list[float]] = {name: [] for name in runs}
        for count in range(rounds + WARM):
            for name, run in runs.items():
                start = time.thread_time()
                run(count)
                _process()
                if count >= WARM:
                    times[name].append(time.thread_time() - start)
    finally:
        dismiss(window)
    median = {name: statistics.median(taken) for name, taken in times.items()}
    rows = [Row(EDIT_KERNEL, name, plots, median[name]) for name, _, _ in EDITS]
    rows.append(Row(EDIT_KERNEL, BARE, plots, median[BARE]))
    rows += [Row(FRAME_KERNEL, name, plots, median[name]) for name in (FRAME, BARE)]
    return rows


def _runs(window: MainWindow, seen: list[QWidget]) -> dict[str, Callable[[int], None]]:
    """What is measured, by name; each is told how often it has been run."""

    def edit(path: str, start: float, step: float) -> Callable[[int], None]:
        def run(count: int) -> None:
            assert window.session.edit(path, start + step * (count + 1), "Benchmark")

        return run

    def bare(count: int) -> None:
        for widget in seen:
            widget.update()

    def frame(count: int) -> None:
        window.player.set_theta(STEP * (count + 1))

    made = {name: edit(path, get(window.session.design, path), step) for name, path, step in EDITS}
    return {**made, BARE: bare, FRAME: frame}


def _open_plots(window: MainWindow, plots: int) -> None:
    """All plots beside each other instead of behind each other, and more until there are enough."""
    names = [name for name, row in VIEWS.items() if row.area == RIGHT]
    for name in MORE[: max(0, plots - len(names))]:
        make = lazily("plots_view", "PlotView", quantities=(name,))
        window.docks[name] = Dock(
            name,
            ViewRow(name, make, RIGHT),
            lambda make=make: make(window.session, window.player),  # type: ignore[misc]
        )
        names.append(name)
    docks = [window.docks[name] for name in names[:plots]]
    for dock in docks:
        window.removeDockWidget(dock)
    rest(window)
    columns = len(docks) // ROWS
    for i, dock in enumerate(docks):
        dock.setGeometry(0, 0, 300, 200)  # behind a tab it had none
        if i < columns:
            window.addDockWidget(RIGHT, dock, Qt.Orientation.Horizontal)
        else:
            window.splitDockWidget(docks[i - columns], dock, Qt.Orientation.Vertical)
        dock.show()
    for column in range(columns):
        window.resizeDocks(docks[column::columns], [100] * ROWS, Qt.Orientation.Vertical)
    for _ in range(2):
        rest(window)


def _seen(window: MainWindow) -> list[QWidget]:
    """What is painted: the plots and the drawing that are on screen."""
    views = [window.view("mechanism"), *(dock.view for dock in window.docks.values())]
    made: list[QWidget] = []
    for view in views:
        if isinstance(view, PlotView) and view.on_screen():
            made.append(view.plot.viewport())
        elif isinstance(view, MechanismView) and view.on_screen():
            made.append(view.canvas.viewport())
    return made


def _process() -> None:
    """Until nothing is left to be painted."""
    for _ in range(4):
        QApplication.processEvents()


def main() -> None:
    rows = measure()
    bare = {row.n: row.seconds for row in rows if row.method == BARE}
    for row in rows:
        ratio = row.seconds / bare[row.n]
        print(f"{row.kernel:14} {row.method:20} {row.n:3} plots {1e3 * row.seconds:8.2f} ms {ratio:6.2f} bare repaints")


if __name__ == "__main__":
    main()
