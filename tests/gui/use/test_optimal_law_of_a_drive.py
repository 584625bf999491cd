"""A drive of the transfer unit gets a law made to measure: chosen, limited and led past a tool by the mouse, saved and exported."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from window_user import Open, User, settle

from core.__main__ import main
from core.design import OptimalCurve, require_motion
from core.project import load
from kindyna_gui.motion.segments_table import LAW
from kindyna_gui.places import example

LEFT = Qt.MouseButton.LeftButton
NONE = Qt.KeyboardModifier.NoModifier


def pull(user: User, widget: QWidget, *way: QPoint) -> None:
    QTest.mouseMove(widget, way[0])
    QTest.mousePress(widget, LEFT, NONE, way[0])
    for at in way[1:]:
        QTest.mouseMove(widget, at)
        user.wait_for_laws()
    QTest.mouseRelease(widget, LEFT, NONE, way[-1])
    user.wait_for_laws()


def curve(user: User, segment: int) -> OptimalCurve:
    result = require_motion(user.session.typed).segments[segment].curve
    assert isinstance(result, OptimalCurve)
    return result


def test_a_drive_is_led_past_a_tool(open_user: Open, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    user = open_user(example("transfer_unit"), size=(1440, 900))
    user.choose("View", "Make")
    settle()
    motion = require_motion(user.design)
    segment = next(i for i, row in enumerate(motion.segments) if row.rise)
    view = user.motion()
    view.choose(segment, LAW)
    user.enter_cell(segment, LAW, "optimal")
    user.wait_for_laws()
    assert curve(user, segment) == OptimalCurve()
    begin = sum(row.span_deg for row in motion.segments[:segment])
    span, rise = motion.segments[segment].span_deg, motion.segments[segment].rise
    # a jerk limit by the offered line
    jerk = view.derivatives.plots[2]
    (line,) = jerk.limit_lines
    at = jerk.position_of_limit(line).toPoint()
    zero = jerk.to_pixel(jerk.getViewBox().viewRect().center()).toPoint()
    pull(
        user,
        jerk.viewport(),
        at,
        QPoint(at.x(), (2 * at.y() + zero.y()) // 3),
        QPoint(at.x(), (at.y() + zero.y()) // 2),
    )
    limited = curve(user, segment).limits.jerk
    assert limited is not None
    # a tool in the way, from the menu of the diagram, then dragged
    diagram = view.diagram
    diagram.menu_requested.emit(diagram.mapToGlobal(QPoint(50, 50)), begin + 0.4 * span)
    menus = [menu for menu in diagram.children() if getattr(menu, "isVisible", bool)() and hasattr(menu, "popup")]
    next(a for a in menus[0].actions() if a.text() == "Add obstacle below").trigger()
    menus[0].close()
    user.wait_for_laws()
    (bound,) = curve(user, segment).below
    level = motion.start + sum(row.rise for row in motion.segments[:segment])
    grip = diagram.position_of(begin + 0.2 * span, level + rise * bound.rise).toPoint()
    lower = diagram.position_of(begin + 0.2 * span, level + rise * bound.rise * 0.7).toPoint()
    pull(user, diagram.viewport(), grip, (grip + lower) / 2, lower)
    moved = curve(user, segment).below[0].rise
    assert moved < bound.rise
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert curve(user, segment).below == (bound,)
    user.choose("Edit", f"Redo {user.window.session.stack.redoText()}")
    assert curve(user, segment).below[0].rise == moved
    # saved, opened again, checked and exported
    path = tmp_path / "unit.toml"
    user.session.save(path)
    saved = user.session.full_design
    user.session.open(path)
    assert user.session.full_design == saved == load(path)
    assert not user.session.modified
    assert main(["check", str(path)]) in (0, 1)
    assert "no law" not in capsys.readouterr().err
    assert main(["export", str(path), "--out", str(tmp_path / "out"), "--samples", "720"]) in (0, 1)
    proof = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))["certificate"]
    name = next(name for name in proof if f"optimum_gap_{segment + 1}" in name)
    assert proof[name]["value"] <= proof[name]["bound"]
    table = next((tmp_path / "out").glob(f"{name.partition('.')[0]}/kinematics.csv"))
    with table.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    column = next(key for key in rows[0] if key.startswith("displacement"))
    angles = np.array([float(row["cam_angle_deg"]) for row in rows])
    values = np.array([float(row[column]) for row in rows])
    inside = (angles > begin) & (angles < begin + bound.end * span)
    assert ((values[inside] - level) / rise).max() <= moved + 1e-6
