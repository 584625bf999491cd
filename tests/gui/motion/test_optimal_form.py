"""The form of an optimal law: aim, ends, limits, cycles and obstacles are typed, and the law follows."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLineEdit
from window_user import Open, User

from core.design import CurveBound, CurveLimits, OptimalCurve, edited, require_motion
from kindyna_gui.forms.fields import WordBox
from kindyna_gui.labels import name_of
from kindyna_gui.motion.optimal_form import ListLine

PATH = "motion.segments[1]"


@pytest.fixture
def user(same_window: Open) -> User:
    user = same_window()
    user.motion().choose(1)
    user.session.edit(f"{PATH}.law", "optimal", "Choose the optimal law")
    user.motion().choose(1)
    return user


def curve(user: User) -> OptimalCurve:
    result = require_motion(user.session.typed).segments[1].curve
    assert isinstance(result, OptimalCurve)
    return result


def line(user: User, name: str) -> QLineEdit:
    return next(
        box for box in user.motion().curve.findChildren(QLineEdit) if box.accessibleName() == name and box.isVisible()
    )


def type_into(user: User, name: str, text: str) -> None:
    box = line(user, name)
    box.setFocus()
    box.selectAll()
    user.type(text) if text else user.press(Qt.Key.Key_Delete)
    user.press(Qt.Key.Key_Return)


def box_refusal(user: User, name: str) -> str:
    box = line(user, name)
    assert isinstance(box, ListLine)
    return box.refusal.text()


def peak(user: User, order: int) -> float:
    """Largest derivative of the segment, for span 1 and rise 1."""
    compiled, segment = user.session.study.program, require_motion(user.design).segments[1]
    theta = np.deg2rad(np.linspace(35.0, 35.0 + segment.span_deg - 1e-9, 5001))
    y = compiled.state(compiled.angles(theta)).y[order]
    return float(np.abs(y).max() * np.deg2rad(segment.span_deg) ** order / abs(segment.rise * 1e-3))


def test_limits_are_typed_and_kept_by_the_law(user: User) -> None:
    before = peak(user, 2)
    assert before == pytest.approx(4.0015, abs=1e-3)
    user.enter(f"{PATH}.limits.jerk", "60")
    assert curve(user).limits == CurveLimits(jerk=60.0)
    assert peak(user, 3) == pytest.approx(60.0, rel=1e-6)
    assert peak(user, 2) == pytest.approx(4.77, abs=0.01)
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert peak(user, 2) == pytest.approx(before)


def test_the_aim_is_chosen(user: User) -> None:
    box = user.field(f"{PATH}.minimise").editor
    assert isinstance(box, WordBox)
    box.setFocus()
    user.press(Qt.Key.Key_Down)
    assert curve(user).minimise == "jerk"
    assert peak(user, 3) == pytest.approx(32.05, abs=0.01)


def test_cycles_and_obstacles_are_rows_of_numbers(user: User) -> None:
    type_into(user, "Vibration-free", "1.4; 3.3")
    assert curve(user).vibration_free == (1.4, 3.3)
    type_into(user, "Below", "0 0.3 0.2; 0.35 0.5 0.4")
    assert curve(user).below == (CurveBound(0.0, 0.3, 0.2), CurveBound(0.35, 0.5, 0.4))
    assert line(user, "Below").text() == "0 0.3 0.2; 0.35 0.5 0.4"
    type_into(user, "Below", "")
    assert curve(user).below == ()
    type_into(user, "Above", "0.7 1 0.6")
    assert curve(user).above == (CurveBound(0.7, 1.0, 0.6),)
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert curve(user).above == ()
    assert line(user, "Above").text() == ""


def test_a_row_of_other_numbers_is_refused_and_changes_nothing(user: User) -> None:
    before = user.design
    type_into(user, "Below", "0 0.3")
    assert "enter 3 numbers a row" in box_refusal(user, "Below")
    assert user.design == before
    assert line(user, "Below").text() == "0 0.3"


def test_a_limit_that_no_law_keeps_waits_for_another_one(user: User) -> None:
    valid = user.design
    user.enter(f"{PATH}.limits.jerk", "20")
    assert user.design == valid, "the last valid design is drawn"
    assert "32.048" in user.field(f"{PATH}.limits.jerk").trouble
    user.enter(f"{PATH}.limits.jerk", "40")
    assert curve(user).limits.jerk == 40.0
    assert user.session.incomplete is None


def test_its_parameters_have_names(user: User) -> None:
    design = edited(user.design, f"{PATH}.below", (CurveBound(0.0, 0.3, 0.2),))
    for key, name in (
        ("minimise", "minimise"),
        ("limits.jerk", "jerk limit"),
        ("intervals", "intervals"),
    ):
        assert name_of(design, f"{PATH}.{key}") == f"Segment 2, {name}"
