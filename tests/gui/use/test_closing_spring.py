"""A swinging roller is given its spring so that contact holds, and its rate is changed while pressure, life and vibration are watched."""

import math
import re

import numpy as np
import pytest
from plot_reading import curves
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QStyle, QStyleOptionSpinBox
from window_user import Open, settle, wait_for

from core.design import get
from core.find import find
from core.study import Study, roller_lives
from kindyna_gui.find import FindView
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.graph.flywheel_view import VibrationView
from kindyna_gui.pictures.units import measure

RATE, FORCE = "loads.spring_rate_nm_per_rad", "loads.least_contact_force_n"
TYPED = {
    "shaft.speed_rpm": "600", "loads.follower_stiffness_n_per_mm": "80", "loads.follower_damping_ratio": "0.03", "cam.thickness_mm": "15",
    "cam.youngs_modulus_gpa": "206", "cam.poisson_ratio": "0.3", "cam.roller_youngs_modulus_gpa": "206", "cam.roller_poisson_ratio": "0.3",
    "cam.roller_load_rating_n": "9000",
}  # fmt: skip


def rested(view: FindView | VibrationView) -> None:
    wait_for(lambda: view.up_to_date and not view.busy)


def ten_up(box: NumberBox) -> None:
    """A click on the field's upper arrow, and Page Up, which goes on by ten steps."""
    option = QStyleOptionSpinBox()
    box.initStyleOption(option)
    place = (
        box.style()
        .subControlRect(QStyle.ComplexControl.CC_SpinBox, option, QStyle.SubControl.SC_SpinBoxUp, box)
        .center()
    )
    QTest.mouseClick(box, Qt.MouseButton.LeftButton, pos=place)
    QTest.keyClick(box, Qt.Key.Key_PageUp)
    settle()


def type_limit(view: FindView, key: str, text: str) -> None:
    box = view.limits.boxes[key]
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, text)
    QTest.keyClick(box, Qt.Key.Key_Return)
    settle()
    rested(view)


@pytest.mark.stress
def test_a_swinging_roller_gets_its_spring_up_to_600_rpm_and_its_rate_is_changed_in_sight_of_what_it_costs(
    open_user: Open,
) -> None:
    user = open_user(whole=True)
    user.choose("File", "Examples", "Rocker cam")
    for path, text in TYPED.items():
        user.enter(path, text)

    user.choose("Dyna", "Find closing spring")
    view = user.window.view("find")
    assert isinstance(view, FindView)
    rested(view)
    assert view.what.currentData() == "spring"
    QTest.mouseClick(view.exact, Qt.MouseButton.LeftButton)  # else the rate is rounded
    assert view.limits.boxes["shaft.speed_rpm_max"].value == pytest.approx(660.0), (
        "a tenth more than the design's own speed"
    )
    assert view.limits.reasons[f"{FORCE}_min"].text() == "2 % of the largest contact force"
    before = user.design
    type_limit(view, f"{FORCE}_min", "100")
    wanted = find(before, "spring", {f"{FORCE}_min": 100.0})
    rate = wanted.answer[RATE]
    assert 0.0 < rate != get(before, RATE)
    assert wanted.reached[FORCE] == pytest.approx(100.0, rel=1e-9)
    answer = view.plot.dots[0]
    assert (answer.x[0], answer.y[0]) == pytest.approx((rate, 12.0), rel=1e-9), "traded for the preload"
    x, y = view.plot.lines[0]
    assert x.min() < rate < x.max()
    assert np.interp(rate, x, y) == pytest.approx(12.0, rel=0.05)
    steps = len(user.steps)
    QTest.mouseClick(view.take, Qt.MouseButton.LeftButton)
    settle()
    assert len(user.steps) == steps + 1
    assert get(user.design, RATE) == rate
    held = Study(user.design)
    assert held.lift_off is not None
    assert held.lift_off.omega * 30.0 / math.pi > 660.0
    user.session.stack.undo()
    assert user.design == before
    user.session.stack.redo()

    pressure, spectrum = user.see("contact_pressure"), user.see("vibration")
    assert isinstance(spectrum, VibrationView)
    box, seen = user.number(RATE), []
    for _ in range(3):
        ten_up(box)
        user.see("contact_pressure")
        text = pressure.note.text().replace("\u202f", "")  # type: ignore[attr-defined]
        (curve,) = curves(pressure.plot)  # type: ignore[attr-defined]
        user.see("vibration")
        rested(spectrum)
        study = Study(user.design)
        assert np.interp(np.rad2deg(study.theta), curve.x, curve.y) == pytest.approx(
            1e-6 * study.stress["inner"].pressure, rel=2e-3, abs=1e-6
        )
        (life,) = roller_lives(study)
        assert float(re.search(r"turns, (\S+) h", text)[1]) == pytest.approx(life.hours, rel=1e-2)  # type: ignore[index]
        residual = study.follower_response.residuals[0].from_rest * 90.0
        shown = spectrum.table.rows.rows[0].cells[1]
        assert shown == measure(residual, "mm", 3)
        seen.append((get(user.design, RATE), float(np.max(curve.y)), life.hours, residual, text, shown))
    for each in zip(*seen, strict=True):
        assert len(set(each)) == 3, each
    rates, peaks, hours = (list(each) for each in list(zip(*seen, strict=True))[:3])
    assert rates == sorted(rates)
    assert peaks == sorted(peaks), "a stiffer spring presses harder"
    assert hours == sorted(hours, reverse=True), "and shortens the roller's life"
