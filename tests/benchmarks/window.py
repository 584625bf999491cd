"""The window's frame budget: edit, drag and frame of the animation until all is painted, by a bare repaint; the start.

    .venv/bin/python tests/benchmarks/window.py

The lift at 1440 x 900, offscreen, 1800 cam angles, forms and motion on the left of the mechanism, findings below it, and on
its right six plots or, with all docks open, twelve; a six-bar beside lengths, centres and three plots, its frames at
1920 x 1080 too; several drives on one shaft beside three plots. What is drawn with the mouse stands beside twelve plots at
1920 x 1080, as does a length stepped by key; a pose of a task is drawn on its sheet over its cards. A move counts until the next
one is taken up, as of a hand that goes on. Times are processor time of the window's thread, the median of rounds in which
everything is measured in turn, so that what slows the
machine slows all of them; each edit has a value that was never there before. The yardstick is a bare repaint of the same
plots and drawings in the same run. Tables that are read rather than watched follow when editing pauses: they are a row of
their own, painted into pictures, beside the same pictures without news. The start is measured from the process to the first
paint of the lift, warm, beside an empty window's, in the same time.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

if __name__ == "__main__":
    sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parents[2])]
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from linkages import chain
from PySide6.QtCore import QCoreApplication, QEvent, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from core.design import Design, get, put
from core.project import load
from core.study import names_of
from kindyna_gui.documents.pins import Pins
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.headless import quiet
from kindyna_gui.linkage.canvas import draggable_joints
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.look import apply_preferences
from kindyna_gui.motion.segments_view import SegmentsView
from kindyna_gui.places import example
from kindyna_gui.screenshots import dismiss, hidden_window, rest
from kindyna_gui.settings import Preferences
from kindyna_gui.synthesis.find_linkage_view import FindLinkageView
from kindyna_gui.view import View
from kindyna_gui.window.docks import LEFT, RIGHT, VIEWS, Dock, ViewRow, lazily
from kindyna_gui.window.main_window import MainWindow

ROOT = Path(__file__).parents[2]
SIZE = (1440, 900)
ROWS = 4  # plots one below the other, at most
COLUMN, HEIGHT = 260, 220  # of a plot, pixels
MORE = ("guide_force", "slider_position", "phi", "beta")  # to twelve
FEW, SOME, MANY = 3, 6, 12
LAYOUTS = (SOME, MANY)
"""Plots beside the mechanism: as many as the target of an edit asks, and with all docks open."""
EDITS = (
    ("edit of a length", "follower.rod_mm", 0.037),
    ("edit of the cam", "cam.base_radius_mm", 0.011),
    ("edit of the motion", "motion.start_mm", 0.013),
    ("edit of the speed", "shaft.speed_rpm", 0.003),
)
BARE, FRAME, DRAG, TABLES = "bare repaint", "frame", "a join in the motion editor", "findings, certificate, flywheel"
EDIT_KERNEL, DRAG_KERNEL, FRAME_KERNEL, START_KERNEL = "edit to paint", "drag to paint", "animation", "start"
TABLE_KERNEL = "tables to paint, after a pause"
KEY_KERNEL, KEY = "edit to paint, by key", "a step of a length"
THEME_KERNEL, THEME = "theme to paint, by every widget", "light and dark"
PIN_KERNEL, PINNED = "edit to paint, by one without a pin", "a variant pinned"
SIX_BAR, LINK, JOINT = "lecture_six_bar", "edit of a link", "a joint"
EIGHT_BAR_KERNEL = "drag to paint, eight-bar"
TASK_KERNEL, POSE = "drag to paint, a task", "a pose"
SIX_BAR_KERNELS = tuple(f"{kernel}, six-bar" for kernel in (EDIT_KERNEL, DRAG_KERNEL, FRAME_KERNEL))
UNIT, DRIVES_KERNEL = "transfer_unit", "animation, several drives"
WIDE, WIDE_KERNEL = (1920, 1080), "animation, six-bar at 1920 x 1080"
SIX_BAR_EDIT = ("linkage.links[4].points.D", 0.013)
STEP = 0.0371  # of the animation [rad]
JOIN = 2  # that is drawn
PAUSING = ("findings", "certificate", "flywheel")
ROUNDS = 25
WARM = 3  # rounds that do not count
STARTS = 5
MOVES = 4  # with the mouse, of one round


class Row(NamedTuple):
    """kernel, method, how many plots beside the mechanism, seconds."""

    kernel: str
    method: str
    n: int
    seconds: float


@dataclass(frozen=True)
class Run:
    """What is measured, and what goes before it, outside the clock."""

    before: Callable[[int], None] | None
    run: Callable[[int], None]

    def __call__(self, count: int) -> None:
        self.run(count)


def names() -> tuple[str, ...]:
    """What is measured with all docks open, ``edit to paint: edit of a length``."""
    edits = [f"{EDIT_KERNEL}: {name}" for name, _, _ in EDITS]
    linkage = [f"{kernel}: {name}" for kernel, name in zip(SIX_BAR_KERNELS, (LINK, JOINT, FRAME), strict=True)]
    return (
        *edits,
        f"{PIN_KERNEL}: {PINNED}",
        f"{FRAME_KERNEL}: {FRAME}",
        f"{DRAG_KERNEL}: {DRAG}",
        f"{TABLE_KERNEL}: {TABLES}",
        f"{KEY_KERNEL}: {KEY}",
        f"{THEME_KERNEL}: {THEME}",
        *linkage,
        f"{EIGHT_BAR_KERNEL}: {JOINT}",
        f"{TASK_KERNEL}: {POSE}",
    )


def measure(rounds: int = ROUNDS, layouts: Iterable[int] = LAYOUTS, more: bool = True) -> list[Row]:
    """Seconds of every method in each layout; ``bare repaint`` is the yardstick of its kernel and number of plots. more: a
    larger window and several drives too."""
    with quiet():
        rows = [row for plots in layouts for row in _measured(plots, rounds)] + _stepped(rounds)
        rows += _six_bar(rounds, more)
        rows += _joint_drawn(rounds, SIX_BAR_KERNELS[1], load(example(SIX_BAR)))
        rows += _joint_drawn(rounds, EIGHT_BAR_KERNEL, chain(8)) + _pose_drawn(rounds)
        return rows + _drives(rounds) if more else rows


def _measured(plots: int, rounds: int) -> list[Row]:
    window = hidden_window(load(example("transfer_lift")), SIZE)
    try:
        window.show_task("graph")
        window.show_view("mechanism")
        motion = window.docks["motion"]
        window.removeDockWidget(motion)
        window.addDockWidget(LEFT, motion, Qt.Orientation.Vertical)  # not behind the forms
        for name in ("parameters", "motion", "findings"):
            window.show_view(name)
        docks = _open_plots(window, plots)
        if plots == MANY:
            _open_tables(window)
        seen = _seen(window, docks)
        assert len(seen) == plots + 2, "every plot, the mechanism and the motion are on screen"
        runs = _runs(window, seen)
        found = _timed(window, runs, rounds)
        rows = [Row(EDIT_KERNEL, name, plots, found[name]) for name in runs if name != FRAME]
        rows += [Row(FRAME_KERNEL, name, plots, found[name]) for name in (FRAME, BARE)]
        rows += _rows(PIN_KERNEL, plots, _timed(window, _pinned(window, runs[EDITS[0][0]]), rounds))
        if plots == MANY:
            rows += _rows(TABLE_KERNEL, plots, _timed(window, _tables(window), rounds))
            window.resize(*WIDE)
            rest(window)
            with _drawing(window) as drag:
                rows += _rows(DRAG_KERNEL, plots, _drawn(window, {DRAG: drag, BARE: runs[BARE]}, rounds))
            rows += _rows(THEME_KERNEL, plots, _timed(window, _themes(window), rounds))
        return rows
    finally:
        dismiss(window)


def _rows(kernel: str, plots: int, found: Mapping[str, float]) -> list[Row]:
    return [Row(kernel, name, plots, seconds) for name, seconds in found.items()]


def _six_bar(rounds: int, wide: bool) -> list[Row]:
    """A linkage beside its lengths, its table of centres and three plots: a link made longer, a joint drawn, a frame; that in a
    larger window too."""
    window = hidden_window(load(example(SIX_BAR)), SIZE)
    try:
        window.show_task("graph")
        for name in ("mechanism", "parameters", "centres"):
            window.show_view(name)
        docks = _open_plots(window, FEW)
        seen, session = _seen(window, docks), window.session
        centres = window.docks["centres"].view
        assert len(seen) == FEW + 1, "every plot and the mechanism are on screen"
        assert centres is not None
        assert centres.on_screen()
        path, step = SIX_BAR_EDIT
        start = get(session.design, path)

        def edit(count: int) -> None:
            assert session.edit(path, (start[0] + step * (count + 1), start[1]), "Benchmark")

        def frame(count: int) -> None:
            window.player.set_theta(STEP * (count + 1))

        plots = FEW
        bare = _bare(seen)
        edits, _, frames = SIX_BAR_KERNELS
        rows = _rows(edits, plots, _timed(window, {LINK: edit, BARE: bare}, rounds))
        rows += _rows(frames, plots, _timed(window, {FRAME: frame, BARE: bare}, rounds))
        if wide:
            window.resize(*WIDE)
            rest(window)
            rows += _rows(WIDE_KERNEL, plots, _timed(window, {FRAME: frame, BARE: bare}, rounds))
        return rows
    finally:
        dismiss(window)


def _stepped(rounds: int) -> list[Row]:
    """A length of the lift stepped by the arrow key, beside twelve plots; what waits until the keys rest is not included."""
    window = hidden_window(load(example("transfer_lift")), WIDE)
    try:
        window.show_task("graph")
        for name in ("mechanism", "parameters"):
            window.show_view(name)
        docks = _open_plots(window, MANY)
        seen = _seen(window, docks)
        assert len(seen) == MANY + 1, "every plot and the mechanism are on screen"
        window.focus_field(EDITS[0][1])
        rest(window)

        def step(count: int) -> None:
            before, field = window.session.design, window.focusWidget()
            assert field is not None
            QTest.keyClick(field, Qt.Key.Key_Up)
            assert window.session.design is not before, "each step is another design"

        return _rows(KEY_KERNEL, MANY, _timed(window, {KEY: step, BARE: _bare(seen)}, rounds))
    finally:
        dismiss(window)


def _joint_drawn(rounds: int, kernel: str, linkage: Design) -> list[Row]:
    """A joint of a linkage beside its lengths, its table of centres and twelve plots."""
    window = hidden_window(linkage, WIDE)
    try:
        window.show_task("graph")
        for name in ("mechanism", "parameters", "centres"):
            window.show_view(name)
        docks = _open_plots(window, MANY, names_of(window.session.design)[:MANY])
        seen = _seen(window, docks)
        assert len(seen) == MANY + 1, "every plot and the mechanism are on screen"
        with _drawing_a_joint(window) as drag:
            return _rows(kernel, MANY, _drawn(window, {JOINT: drag, BARE: _bare(seen)}, rounds))
    finally:
        dismiss(window)


def _pose_drawn(rounds: int) -> list[Row]:
    """A pose of a task on its sheet, with the cards of the linkages found for it meanwhile by another thread."""
    window = hidden_window(load(example("four_bar")), WIDE)
    try:
        window.show_task("compo")
        view = window.show_view("find_linkage")
        assert isinstance(view, FindLinkageView)
        rest(window)
        assert view.sheet.canvas is not None
        paper, cards = view.sheet.canvas.viewport(), view.strip.board.list.viewport()
        assert cards.isVisible(), "there are linkages"
        start = view.sheet.pixel(view.task.poses[1].z)
        none, left = Qt.KeyboardModifier.NoModifier, Qt.MouseButton.LeftButton

        def move(count: int) -> None:
            before = view.task
            at = start + QPointF(20.0 + 20.0 * (count % 7), 20.0 * (count % 2))
            event = QMouseEvent(QEvent.Type.MouseMove, at, paper.mapToGlobal(at), left, left, none)
            QApplication.sendEvent(paper, event)
            assert view.task != before, "each move is another task"

        QTest.mousePress(paper, left, none, start.toPoint())
        rows = _rows(TASK_KERNEL, 0, _drawn(window, {POSE: move, BARE: _bare([paper, cards])}, rounds))
        QTest.mouseRelease(paper, left, none, start.toPoint())
        return rows
    finally:
        dismiss(window)


def _drives(rounds: int) -> list[Row]:
    """A frame of several drives on one shaft beside three plots."""
    window = hidden_window(load(example(UNIT)), SIZE)
    try:
        window.show_task("graph")
        window.show_view("mechanism")
        seen = _seen(window, _open_plots(window, FEW))
        assert len(seen) == FEW + 1, "every plot and the mechanism are on screen"

        def frame(count: int) -> None:
            window.player.set_theta(STEP * (count + 1))

        return _rows(DRIVES_KERNEL, FEW, _timed(window, {FRAME: frame, BARE: _bare(seen)}, rounds))
    finally:
        dismiss(window)


def _bare(seen: list[QWidget]) -> Callable[[int], None]:
    def bare(count: int) -> None:
        for widget in seen:
            widget.update()

    return bare


def _pinned(window: MainWindow, edit: Callable[[int], None]) -> dict[str, Callable[[int], None]]:
    """The same edit beside a pinned variant, and without one, which is its yardstick."""
    pins, path = Pins.of(window.session), EDITS[0][1]
    variant = put(window.session.full_design, path, 1.01 * get(window.session.design, path))

    def pin(count: int) -> None:
        pins.pin(variant)
        _process()

    def unpin(count: int) -> None:
        while pins.front is not None:
            pins.unpin()
        _process()

    return {PINNED: Run(pin, lambda count: edit(2 * count)), BARE: Run(unpin, lambda count: edit(2 * count + 1))}


def _tables(window: MainWindow) -> dict[str, Callable[[int], None]]:
    """The tables after an edit, whose own repaint does not count; and with nothing new. Both painted into pictures."""
    path, start, step = EDITS[0][1], get(window.session.design, EDITS[0][1]), EDITS[0][2]
    views = [window.docks[name].view for name in PAUSING]

    def painted(count: int) -> None:
        for view in views:
            assert view is not None
            view.pull()
            assert not view.grab().isNull()

    def edited(count: int) -> None:
        assert window.session.edit(path, start + step * (count + 1001), "Benchmark")
        for view in window.findChildren(View):
            if view not in views and view.on_screen():
                view.pull()
        QCoreApplication.sendPostedEvents()  # paints, but lets no pause end
        assert not any(view is not None and view.up_to_date for view in views)

    return {TABLES: Run(edited, painted), BARE: Run(None, painted)}


def _themes(window: MainWindow) -> dict[str, Callable[[int], None]]:
    """A change of the theme, and a bare repaint of every widget in sight. An even number of rounds ends in the light."""
    app = QApplication.instance()
    assert isinstance(app, QApplication)
    seen = [widget for widget in window.findChildren(QWidget) if not widget.visibleRegion().isEmpty()]

    def change(count: int) -> None:
        apply_preferences(Preferences(theme=("dark", "light")[count % 2]), app)

    return {THEME: change, BARE: _bare(seen)}


def _timed(window: MainWindow, runs: Mapping[str, Callable[[int], None]], rounds: int) -> dict[str, float]:
    """Median seconds of each until all is painted, run in turn. What follows when editing pauses is done between them, outside
    the clock: else it falls to whichever runs when the pause is over."""
    times: dict[str, list[float]] = {name: [] for name in runs}
    for count in range(rounds + WARM):
        for name, run in runs.items():
            if isinstance(run, Run) and run.before:
                run.before(count)
            start = time.thread_time()
            run(count)
            _process()
            if count >= WARM:
                times[name].append(time.thread_time() - start)
            for view in window.findChildren(View):
                if view.on_screen():
                    view.pull()
            window.titles.name_steps()
            _process()
    return {name: statistics.median(taken) for name, taken in times.items()}


def _drawn(window: MainWindow, runs: Mapping[str, Callable[[int], None]], rounds: int) -> dict[str, float]:
    """Mean seconds of a move until the next one is taken up, and of a bare repaint; after the last move all follows."""
    times: dict[str, float] = {}
    for name, run in runs.items():
        for count in range(MOVES * rounds + WARM):
            if count == WARM:
                start = time.thread_time()
            run(count)
            QApplication.processEvents()
        times[name] = (time.thread_time() - start) / (MOVES * rounds)
        rest(window, 0.0)  # extremes wait until the mouse lets go
    assert all(view.up_to_date for view in window.findChildren(View) if view.on_screen())
    return times


def _runs(window: MainWindow, seen: list[QWidget]) -> dict[str, Callable[[int], None]]:
    """What is measured, by name; each is told how often it has been run."""

    def edit(path: str, start: float, step: float) -> Callable[[int], None]:
        def run(count: int) -> None:
            assert window.session.edit(path, start + step * (count + 1), "Benchmark")

        return run

    def frame(count: int) -> None:
        window.player.set_theta(STEP * (count + 1))

    made = {name: edit(path, get(window.session.design, path), step) for name, path, step in EDITS}
    return {**made, BARE: _bare(seen), FRAME: frame}


@contextmanager
def _drawing(window: MainWindow) -> Iterator[Callable[[int], None]]:
    """A join is held with the mouse and drawn a little farther each time."""
    view = window.docks["motion"].view
    assert isinstance(view, SegmentsView)
    diagram, paper = view.diagram, view.diagram.viewport()
    start = diagram.position_of_join(JOIN)
    none, left = Qt.KeyboardModifier.NoModifier, Qt.MouseButton.LeftButton

    def move(count: int) -> None:
        before = window.session.design
        at = start + QPointF(6.0 + 1.3 * count, 0.0)  # beyond what a hand trembles, and a step of its grid each time
        buttons = Qt.MouseButton.NoButton, left
        event = QMouseEvent(QEvent.Type.MouseMove, at, paper.mapToGlobal(at), *buttons, none)
        QApplication.sendEvent(paper, event)
        assert window.session.design is not before, "each move is another design"

    QTest.mousePress(paper, left, none, start.toPoint())
    yield move
    QTest.mouseRelease(paper, left, none, start.toPoint())


@contextmanager
def _drawing_a_joint(window: MainWindow) -> Iterator[Callable[[int], None]]:
    """A joint is held with the mouse and drawn a little farther each time, to and fro."""
    view = window.view("mechanism")
    assert isinstance(view, MechanismView)
    paper = view.canvas.viewport()
    start = _place_of_a_joint(view)
    none, left = Qt.KeyboardModifier.NoModifier, Qt.MouseButton.LeftButton

    def move(count: int) -> None:
        before = window.session.design
        at = start + QPointF(4.0 + 0.25 * count, 3.0 if count % 2 else -3.0)
        event = QMouseEvent(QEvent.Type.MouseMove, at, paper.mapToGlobal(at), Qt.MouseButton.NoButton, left, none)
        QApplication.sendEvent(paper, event)
        assert window.session.design is not before, "each move is another design"

    QTest.mousePress(paper, left, none, start.toPoint())
    yield move
    QTest.mouseRelease(paper, left, none, start.toPoint())


def _place_of_a_joint(view: MechanismView) -> QPointF:
    """Where in the drawing the first joint stands that can be drawn elsewhere."""
    canvas = view.canvas
    place = next(iter(draggable_joints(view.scene).values()))
    at = canvas.viewportTransform().map(QPointF(place.real, place.imag))
    assert canvas.joint_at(at), "a joint is under the mouse"
    return at


def _open_tables(window: MainWindow) -> None:
    """The tables as windows of their own: next to so many plots they have no room, and would be behind each other."""
    docks = [window.docks[name] for name in PAUSING]
    for i, dock in enumerate(docks):
        dock.setFloating(True)
        dock.setGeometry(320 * i, 0, 300, 200)
        dock.show()
    for _ in range(2):
        rest(window)
    assert all(dock.view is not None and dock.view.on_screen() for dock in docks)


def _open_plots(window: MainWindow, plots: int, names: Sequence[str] = ()) -> list[Dock]:
    """So many plots next to each other, and no others; their docks. names: one of each of these."""
    usual = [window.docks[name] for name, row in VIEWS.items() if row.quantities]
    docks = [] if names else list(usual)
    for name in names or MORE[: max(0, plots - len(docks))]:
        make = lazily("graph.plots_view", "PlotView", quantities=(name,))
        dock = Dock(
            name,
            ViewRow(name, make, RIGHT),
            lambda make=make: make(window.session, window.player),  # type: ignore[misc]
            window,
        )
        docks.append(dock)
    for dock in {*usual, *docks}:
        window.removeDockWidget(dock)
    rest(window)
    docks = docks[:plots]
    for i, dock in enumerate(docks):  # windows of their own: in the window some would be tabs behind others
        window.addDockWidget(RIGHT, dock)
        dock.setFloating(True)
        dock.setGeometry(COLUMN * (i // ROWS), HEIGHT * (i % ROWS), COLUMN, HEIGHT)
        dock.show()
    for _ in range(2):
        rest(window)
    return docks


def _seen(window: MainWindow, plots: Iterable[Dock]) -> list[QWidget]:
    """What is painted: the drawing of the mechanism and of the motion, and the plots that are on screen."""
    views = [window.view("mechanism"), *(dock.view for dock in {*window.docks.values(), *plots})]
    made: list[QWidget] = []
    for view in views:
        if isinstance(view, PlotView) and view.on_screen():
            made.append(view.plot.viewport())
        elif isinstance(view, MechanismView) and view.on_screen():
            made.append(view.canvas.viewport())
        elif isinstance(view, SegmentsView) and view.on_screen():
            made.append(view.diagram.viewport())
    return made


def _process() -> None:
    """Until nothing is left to be painted."""
    for _ in range(4):
        QApplication.processEvents()


# -- the start --------------------------------------------------------------------------------------------

FIRST_PAINT = """
import sys, time
{imports}
from PySide6.QtCore import QEvent, QObject

class Watch(QObject):
    def eventFilter(self, watched, event):
        if event.type() == QEvent.Type.Paint:
            self.painted = True
        return False

watch = Watch()
watch.painted = False
{made}
paper.installEventFilter(watch)
window.show()
while not watch.painted:
    app.processEvents()
print(time.process_time())
"""
OURS = FIRST_PAINT.format(
    imports="from kindyna_gui.__main__ import window_module\nmain_window = window_module()",
    made="app = main_window.ensure_app(offscreen=True)\nwindow = main_window.open_window(app)\n"
    'paper = window.view("mechanism").canvas.viewport()',
)
EMPTY = FIRST_PAINT.format(
    imports="from PySide6.QtWidgets import QApplication, QMainWindow",
    made="app = QApplication([])\npaper = window = QMainWindow()\nwindow.resize(1440, 900)",
)


def starts(times: int = STARTS) -> list[Row]:
    """Seconds of the processor, on a quiet machine nearly all that pass, from a new process to the first paint of the lift,
    and of an empty window; the median, in turn. Warm: the compiled modules are kept, whatever this process was told to do
    with its own. In the layout of the first start."""
    scripts = {"the lift drawn": OURS, BARE: EMPTY}
    taken: dict[str, list[float]] = {name: [] for name in scripts}
    with TemporaryDirectory() as own:
        env = {**os.environ, "PYTHONPYCACHEPREFIX": f"{own}/compiled", "XDG_CONFIG_HOME": f"{own}/settings"}
        env.pop("PYTHONDONTWRITEBYTECODE", None)
        for count in range(times + 1):
            for name, script in scripts.items():
                told = subprocess.check_output(
                    [sys.executable, "-c", script], stderr=subprocess.DEVNULL, cwd=ROOT, env=env
                )
                if count:  # the first one warms up
                    taken[name].append(float(told.split()[-1]))
    return [Row(START_KERNEL, name, 0, statistics.median(told)) for name, told in taken.items()]


def main() -> None:
    rows = measure() + starts()
    bare = {(row.kernel, row.n): row.seconds for row in rows if row.method == BARE}
    for row in rows:
        ratio = row.seconds / bare[row.kernel, row.n]
        print(
            f"{row.kernel:14} {row.method:28} {row.n:3} plots {1e3 * row.seconds:8.2f} ms {ratio:6.2f} by a bare repaint"
        )


if __name__ == "__main__":
    main()
