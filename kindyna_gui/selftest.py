"""Self-test: edit, undo, one turn and export of every example in a hidden window, compared with the core."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from PySide6.QtWidgets import QApplication

from core.design import stroke
from core.errors import KindynaError
from core.output.export import as_texts
from core.project import load, save
from core.study import clear_caches, extremes_of
from kindyna_gui.export import tables_of, write_tables
from kindyna_gui.places import examples
from kindyna_gui.player import TURN
from kindyna_gui.screenshots import dismiss, hidden_window, rest
from kindyna_gui.view import View
from kindyna_gui.window.main_window import MainWindow

FRAMES = 360
SIZE = (1280, 720)
LONGER = 1.01  # factor on the stroke or speed


class _CheckFailed(Exception):
    """A check of the self-test has failed."""


def verdicts() -> Iterator[tuple[str, str, str]]:
    """Yield name, fault (empty where there is none) and summary of each example."""
    for _, path in examples():
        try:
            summary = _try(path)
        except (_CheckFailed, KindynaError) as error:
            yield path.stem, " ".join(str(error).split()), ""
        else:
            yield path.stem, "", summary


def _require(condition: bool, fault: str) -> None:
    if not condition:
        raise _CheckFailed(fault)


def _try(path: Path) -> str:
    design = load(path)
    window = hidden_window(design, SIZE)
    try:
        _edit_and_undo(window)
        _require(window.session.full_design == design, "undo did not restore the design")
        drawn = _turn(window)
        count = _export(window, path)
    finally:
        dismiss(window)
    return f"edited and undone, {drawn} frames, {count} files as the core writes them"


def _edit_and_undo(window: MainWindow) -> None:
    if window.session.study.by_crank:
        _speed_and_undo(window)
    else:
        _stroke_and_undo(window)


def _speed_and_undo(window: MainWindow) -> None:
    session = window.session
    before, target = session.study.omega, session.design.drive.mechanism.driver.speed_rpm * LONGER
    _require(session.edit("linkage.driver.speed_rpm", target, "Change speed"), "a higher speed was refused")
    rest(window)
    _require(abs(session.study.omega / before - LONGER) < 1e-12, "the driver does not turn at the speed")
    _require(session.modified, "the edit did not change the design")
    session.stack.undo()
    rest(window)
    _require(not session.modified, "undo left the design modified")


def _stroke_and_undo(window: MainWindow) -> None:
    session = window.session
    before, target = session.study, stroke(session.design.drive.motion) * LONGER
    _require(session.edit("motion.stroke", target, "Change stroke"), "a longer stroke was refused")
    rest(window)
    rise = stroke(session.design.drive.motion)
    _require(abs(rise - target) < 1e-9 * target, f"the stroke became {rise:g}, not {target:g}")
    extremes = extremes_of(session.study, "motion", ("displacement",))["displacement"]
    stroke_mm = extremes.high.value - extremes.low.value
    scale = session.design.drive.motion.scale
    _require(abs(stroke_mm / scale - target) < 1e-9 * target, "the motion does not follow the stroke")
    _require(session.study is not before and session.modified, "the edit did not change the design")
    session.stack.undo()
    rest(window)
    _require(not session.modified, "undo left the design modified")


def _turn(window: MainWindow) -> int:
    player = window.player
    player.set_theta(0.0)
    player.set_speed(1.0)
    shown: list[float] = []
    player.angle_changed.connect(shown.append)
    for _ in range(FRAMES):
        player.advance(TURN / FRAMES / player.omega)
        QApplication.processEvents()
    player.angle_changed.disconnect(shown.append)
    distance = min(player.theta, TURN - player.theta)
    _require(len(shown) == FRAMES and distance < 1e-9, "one turn does not end where it began")
    for view in window.findChildren(View):
        _require(
            not view.in_trouble or view.is_unavailable or not view.on_screen(),
            f"{type(view).__name__} has nothing to show",
        )
    return len(shown)


def _export(window: MainWindow, path: Path) -> int:
    with tempfile.TemporaryDirectory() as folder:
        written = write_tables(window.session.full_design, Path(folder))
        copy = Path(folder) / "copy.toml"
        save(window.session.full_design, copy)
        clear_caches()  # the core computes again
        expected = as_texts(tables_of(load(copy)))
        _require(set(written) == set(expected), "the files differ from those of the core")
        for name, text in expected.items():
            _require((Path(folder) / name).read_text(encoding="utf-8") == text, f"{name} differs from the core's")
    _require(load(path) == window.session.full_design, "the design is no longer the example")
    return len(expected)
