"""Dyna > Response spectrum: curves and figures are the core's, follow an edit, and are computed only while they can be seen."""

import math

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from window_user import Open, User, settle, wait_for

from core.project import load
from core.study import Study
from core.study.stages import memory
from kindyna_gui.graph.flywheel_view import VibrationView
from kindyna_gui.pictures.units import measure
from kindyna_gui.places import example

STIFFNESS, RATIO = "loads.follower_stiffness_n_per_mm", "loads.follower_damping_ratio"


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


def see(user: User) -> VibrationView:
    user.choose("Dyna", "Response spectrum")
    view = user.window.view("vibration")
    assert isinstance(view, VibrationView)
    return rested(view)


def rested(view: VibrationView) -> VibrationView:
    wait_for(lambda: view.up_to_date and not view.busy)
    return view


def edit(user: User, path: str, value: float) -> None:
    user.session.edit(path, value, "Value")
    user.session.end_gesture()


def figures(view: VibrationView) -> list[tuple[str, ...]]:
    return [row.cells for row in view.table.rows.rows]


def test_the_spectrum_follows_what_is_typed_and_is_read_under_the_mouse(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    view = see(user)
    assert view.is_unavailable, "rigid"
    user.enter(STIFFNESS, "60")
    user.enter(RATIO, "0.03")
    rested(view)
    study = Study(user.design)
    one, two = study.follower_response.residuals
    assert figures(view)[0] == (
        "0–60°",
        f"{90.0 * one.from_rest:.3f} mm",
        f"{math.degrees(one.from_rest):.3f}°",
        f"{90.0 * one.steady:.3f} mm",
        f"{math.degrees(one.steady):.3f}°",
    )
    assert view.text.text().startswith("At 300.0 rpm the follower vibrates by ")
    assert view.text.text().endswith("Natural frequency 59.94 Hz, 11.99 periods a turn, damping ratio 0.03")
    (rpm, first), (_, second) = view.plot.lines
    assert view.page.currentText() == "Residual, from rest"
    view.plot.setFixedHeight(90)
    settle()
    assert view.plot.getAxis("left").labelText == "mm", "too low for the whole title"
    view.plot.setFixedHeight(300)
    settle()
    assert view.plot.getAxis("left").labelText == "Residual, mm"
    assert np.interp(300.0, rpm, first) == pytest.approx(90.0 * one.from_rest, rel=1e-2)
    assert np.interp(300.0, rpm, second) == pytest.approx(90.0 * two.from_rest, rel=1e-2)

    plots = [user.see(name) for name in ("contact_force", "acceleration")]
    labels = [row.label for plot in plots for row in plot.rows]  # type: ignore[attr-defined]
    assert labels == [
        "Contact force",
        "Contact force, elastic follower",
        "Acceleration",
        "Elastic follower, acceleration",
    ]
    see(user)

    before = figures(view)
    user.enter("loads.spring_rate_nm_per_rad", "90")
    rested(view)
    assert figures(view) != before
    assert figures(view)[1][1] == measure(90.0 * Study(user.design).follower_response.residuals[1].from_rest, "mm", 3)

    steps, frame = list(user.steps), view.plot.frame()
    left = view.plot.getViewBox().sceneBoundingRect()
    at = view.plot.mapFromScene(left.left() + left.width() * 0.5, left.center().y())
    QTest.mouseMove(view.plot.viewport(), QPoint(at))
    settle()
    half = 0.5 * (frame.first + frame.last)
    wait_for(lambda: view.plot.cursor_at is not None)
    assert view.plot.cursor_at == pytest.approx(half, abs=(frame.last - frame.first) / left.width() * 2.0)
    assert "rpm, 0–60°: " in view.text.text()
    QTest.mouseClick(view.plot.viewport(), Qt.MouseButton.LeftButton, pos=QPoint(at))
    assert user.steps == steps, "a click sets nothing"

    view.page.setFocus()
    for label in ("steady", "Largest acceleration"):
        QTest.keyClick(view.page, Qt.Key.Key_Down)
        rested(view)
        assert label in view.page.currentText()
    assert len(view.plot.lines) == 2
    assert view.plot.getAxis("left").labelText.startswith("Acceleration, ")

    user.session.begin_drag(user.window)
    seen = set()
    for rate in (45.0, 55.0, 65.0):
        user.session.edit("loads.spring_rate_nm_per_rad", rate, "Spring rate")
        wait_for(lambda: view.up_to_date and not view.busy)
        seen.add(figures(view)[0][1])
    user.session.end_drag()
    assert len(seen) == 3, "while the mouse is down"

    user.window.docks["vibration"].hide()
    settle()
    made = memory.computed["spectrum"]
    edit(user, "loads.spring_rate_nm_per_rad", 95.0)
    settle()
    assert memory.computed["spectrum"] == made, "nobody sees it"
    user.session.put(load(example("four_bar")), "Take the four-bar")
    entry = user.action("Dyna", "Response spectrum")
    assert not entry.isEnabled()
    assert "cam" in entry.statusTip()


def test_a_pinned_variant_is_in_the_spectrum(open_user: Open) -> None:
    """Dashed, by its name; a variant with a rigid follower has no curve."""
    user = open_user(example("rocker_cam"))
    user.choose("Edit", "Pin this variant")
    edit(user, STIFFNESS, 60.0)
    edit(user, RATIO, 0.03)
    view = see(user)
    QTest.keyClick(view.page, Qt.Key.Key_Home)
    rested(view)
    assert len(view.plot.lines) == 2
    user.choose("Edit", "Unpin")
    user.choose("Edit", "Pin this variant")
    before = user.design
    edit(user, STIFFNESS, 90.0)
    rested(view)
    pinned = [line for line in view.plot.shown if line.reference]
    assert {line.reference for line in pinned} == {"variant 2"}
    assert "variant 2" in view.plot.legend.text
    own = Study(before).follower_response.residuals
    for line, residual in zip(pinned, own, strict=True):
        assert np.interp(300.0, line.x, line.y) == pytest.approx(90.0 * residual.from_rest, rel=1e-2)
    user.choose("Edit", "Unpin")
    rested(view)
    assert [line for line in view.plot.shown if line.reference] == []
