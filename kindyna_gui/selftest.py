"""Every example through the window, as a user would: edit, undo, one turn, export; compared with the core."""

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
LONGER = 1.01  # by which the stroke is changed


class _Wrong(Exception):
    """Something is not as it should be."""


def verdicts() -> Iterator[tuple[str, str, str]]:
    """For each example its name, what is wrong (empty where nothing is), and what was done."""
    for _, path in examples():
        try:
            summary = _try(path)
        except (_Wrong, KindynaError) as error:
            yield path.stem, " ".join(str(error).split()), ""
        else:
            yield path.stem, "", summary


def _must(so: bool, what: str) -> None:
    if not so:
        raise _Wrong(what)


def _try(path: Path) -> str:
    design = load(path)
    window = hidden_window(design, SIZE)
    try:
        _edit_and_undo(window)
        _must(window.session.full_design == design, "undo did not bring the design back")
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
    before, wanted = session.study.omega, session.design.drive.mechanism.driver.speed_rpm * LONGER
    _must(session.edit("linkage.driver.speed_rpm", wanted, "Change speed"), "a higher speed was refused")
    rest(window)
    _must(abs(session.study.omega / before - LONGER) < 1e-12, "the driver does not turn at the speed")
    _must(session.modified, "the edit has left no trace")
    session.stack.undo()
    rest(window)
    _must(not session.modified, "undo left the design modified")


def _stroke_and_undo(window: MainWindow) -> None:
    session = window.session
    before, wanted = session.study, stroke(session.design.drive.motion) * LONGER
    _must(session.edit("motion.stroke", wanted, "Change stroke"), "a longer stroke was refused")
    rest(window)
    rise = stroke(session.design.drive.motion)
    _must(abs(rise - wanted) < 1e-9 * wanted, f"the stroke became {rise:g}, not {wanted:g}")
    reached = extremes_of(session.study, "motion", ("displacement",))["displacement"]
    stroke_mm = reached.high.value - reached.low.value
    scale = session.design.drive.motion.scale
    _must(abs(stroke_mm / scale - wanted) < 1e-9 * wanted, "the motion does not follow the stroke")
    _must(session.study is not before and session.modified, "the edit has left no trace")
    session.stack.undo()
    rest(window)
    _must(not session.modified, "undo left the design modified")


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
    away = min(player.theta, TURN - player.theta)
    _must(len(shown) == FRAMES and away < 1e-9, "one turn does not end where it began")
    for view in window.findChildren(View):
        _must(
            not view.in_trouble or view.is_unavailable or not view.on_screen(),
            f"{type(view).__name__} has nothing to show",
        )
    return len(shown)


def _export(window: MainWindow, path: Path) -> int:
    with tempfile.TemporaryDirectory() as folder:
        written = write_tables(window.session.full_design, Path(folder))
        copy = Path(folder) / "copy.toml"
        save(window.session.full_design, copy)
        clear_caches()  # the core computes anew
        wanted = as_texts(tables_of(load(copy)))
        _must(set(written) == set(wanted), "other files than the core writes")
        for name, text in wanted.items():
            _must((Path(folder) / name).read_text(encoding="utf-8") == text, f"{name} differs from the core's")
    _must(load(path) == window.session.full_design, "the design is no longer the example")
    return len(wanted)
