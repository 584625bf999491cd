"""Dyna > Valve springs: the force over the turn without and with surge, and the harmonics over the engine speed."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton
from window_user import Open, User, settle, wait_for

from core.study import Study, extremes_of
from kindyna_gui.valves.spring_view import SpringView

EXAMPLE = Path(__file__).parents[3] / "resources" / "examples" / "valve_train.toml"


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window(EXAMPLE)


def opened(user: User) -> SpringView:
    user.choose("Dyna", "Valve springs")
    view = user.see("valve_springs")
    assert isinstance(view, SpringView)
    return view


def speeds_page(view: SpringView) -> None:
    view.page.setFocus()
    QTest.keyClick(view.page, Qt.Key.Key_Down)
    settle()
    assert view.page.currentText() == "Harmonics"


def test_the_force_has_both_curves_and_the_verdict_is_first(user: User) -> None:
    view = opened(user)
    assert view.text.text().startswith("The follower stays on the cam at 5000 rpm of the engine: at least ")
    assert [line.label for line in view.force.shown] == ["static", "true, with surge"]
    static, true = (line.y for line in view.force.shown)
    assert static.min() == pytest.approx(313.98, abs=0.01)
    force = extremes_of(Study(user.design), "dynamics", ("valve_spring_force",))["valve_spring_force"]
    assert (true.min(), true.max()) == pytest.approx((force.low.value, force.high.value), rel=2e-3)
    user.turn(126.0)
    wait_for(lambda: view.force.cursor_at == pytest.approx(126.0))
    assert len(view.force.readings()) == 2


def test_a_click_into_the_force_turns_the_cam(user: User) -> None:
    view = opened(user)
    area = view.force.viewport()
    QTest.mouseClick(area, Qt.MouseButton.LeftButton, pos=QPoint(area.width() // 2, area.height() // 2))
    settle()
    at = float(np.rad2deg(user.window.player.theta))
    assert at == pytest.approx(view.force.across_at(QPoint(area.width() // 2, area.height() // 2)), abs=0.5)


def test_harmonics_are_marked_over_the_engine_speed(user: User) -> None:
    view = opened(user)
    speeds_page(view)
    (stems,) = view.speeds.shown
    speeds, lifts = view.speeds.dots[0].x, view.speeds.dots[0].y
    by_number = dict(zip(view.speeds.dots[0].texts, zip(speeds, lifts, strict=True), strict=True))
    assert by_number["9"][0] == pytest.approx(56634.263 / 9.0, rel=1e-6)
    assert np.nanmax(stems.y) == lifts.max()
    assert [(rule.at, rule.text) for rule in view.speeds.rules] == [(5000.0, "now")]
    area, pixel = view.speeds.viewport(), view.speeds.to_pixel(QPointF(by_number["9"][0], 0.0)).toPoint()
    QTest.mouseMove(area, QPoint(pixel.x(), area.height() // 2))
    settle()
    assert view.text.text().startswith("Harmonic 9, ")
    assert "resonates at 6293 rpm with " in view.text.text()


def test_another_speed_moves_the_mark_and_the_verdict(user: User) -> None:
    view = opened(user)
    speeds_page(view)
    for rpm, first_words in ((4200.0, "Surge lifts the follower off the cam at 8400 rpm of the engine: it lacks "),
                             (5500.0, "The follower leaves the cam from ")):  # fmt: skip
        user.session.edit("shaft.speed_rpm", rpm, "Change speed")
        wait_for(lambda: view.up_to_date)
        assert view.speeds.rules[0].at == pytest.approx(2.0 * rpm)
        assert view.text.text().startswith(first_words)


def test_nested_springs_have_a_colour_each(same_window: Open, tmp_path: Path) -> None:
    text = EXAMPLE.read_text(encoding="utf-8")
    spring = text[text.index("[[drives.loads.valve_springs]]") : text.index('[[drives]]\nname = "Exhaust"')]
    inner = spring.replace("wire_mm = 3.8", "wire_mm = 2.6").replace("coil_mm = 24.0", "coil_mm = 16.0")
    (tmp_path / "nested.toml").write_text(text.replace(spring, spring + inner, 1), encoding="utf-8")
    view = opened(same_window(tmp_path / "nested.toml"))
    speeds_page(view)
    assert [line.label for line in view.speeds.shown] == ["valve spring 1", "valve spring 2"]
    assert len({line.colour for line in view.speeds.shown}) == 2


def test_a_drive_without_a_valve_spring_says_so_with_a_remedy(same_window: Open) -> None:
    view = opened(same_window())
    assert view.no_picture.startswith("This drive has no valve spring.")
    (button,) = [part for part in view.findChildren(QPushButton) if part.isVisible()]
    assert button.text() == "Type masses and forces"
