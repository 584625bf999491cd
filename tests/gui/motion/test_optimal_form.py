"""The form of an optimal law: aim, ends, limits, cycles and obstacles are typed, and the law follows."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractItemView, QLabel
from window_user import Open, User, settle, wait_for

from core.design import CurveBound, CurveLimits, OptimalCurve, edited, require_motion
from kindyna_gui.forms.fields import WordBox
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import name_of
from kindyna_gui.motion.curve_lists import ListsTable

PATH = "motion.segments[1]"


@pytest.fixture
def user(same_window: Open) -> User:
    user = same_window()
    user.motion().choose(1)
    user.session.edit(f"{PATH}.law", "optimal", "Choose the optimal law")
    user.motion().choose(1)
    user.wait_for_laws()
    return user


def curve(user: User) -> OptimalCurve:
    result = require_motion(user.session.typed).segments[1].curve
    assert isinstance(result, OptimalCurve)
    return result


EDITING = QAbstractItemView.State.EditingState


def lists(user: User) -> ListsTable:
    table = user.motion().curve.points
    assert table is not None
    return table


def show(user: User, tab: str) -> ListsTable:
    """Click the tab of a list."""
    table = lists(user)
    titles = [table.tabs.tabText(i).partition(" (")[0] for i in range(table.tabs.count())]
    user.motion().curve.focus_field(f"{PATH}.points")
    settle()
    place = table.tabs.tabRect(titles.index(tab)).center()
    QTest.mouseClick(table.tabs, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, place)
    settle()
    return table


def type_into(user: User, row: int, column: int, text: str) -> None:
    table = lists(user).table
    table.setCurrentIndex(lists(user).model.index(row, column))
    table.setFocus()
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: table.state() == EDITING)
    user.type(text)
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: table.state() != EDITING)


def peak(user: User, order: int) -> float:
    """Largest derivative of the segment, for span 1 and rise 1."""
    user.wait_for_laws()
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


def test_cycles_are_rows_of_a_table(user: User) -> None:
    table = show(user, "Vibration-free")
    for _ in range(2):
        QTest.mouseClick(table.add_button, Qt.MouseButton.LeftButton)
    type_into(user, 0, 0, "1.4")
    type_into(user, 1, 0, "3.3")
    assert curve(user).vibration_free == (1.4, 3.3)
    assert user.steps[-1] == "Change segment 2, cycles 2 to 3.3"
    assert table.tabs.tabText(table.tabs.currentIndex()) == "Vibration-free (2)"
    table.table.setFocus()
    user.press(Qt.Key.Key_Delete)
    assert len(curve(user).vibration_free) == 1
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert curve(user).vibration_free == (1.4, 3.3)


def test_an_obstacle_is_added_where_the_law_touches_it_and_then_moved(user: User) -> None:
    user.window.player.step(35.0 + 0.4 * 41.5)
    before = user.session.study.motion.y[0].copy()
    table = show(user, "Below")
    QTest.mouseClick(table.add_button, Qt.MouseButton.LeftButton)
    (bound,) = curve(user).below
    assert (bound.start, bound.end) == (0.0, pytest.approx(0.4, abs=0.01))
    assert np.abs(user.session.study.motion.y[0] - before).max() < 1e-6, "the law does not change yet"
    type_into(user, 0, 2, "0.2")
    assert curve(user).below == (CurveBound(0.0, bound.end, 0.2),)
    compiled = user.session.study.program
    theta = np.deg2rad(35.0 + 41.5 * np.linspace(1e-9, bound.end, 501))
    fallen = 0.150 - compiled.state(compiled.angles(theta)).y[0]
    assert fallen.max() <= 0.2 * 0.150 + 1e-9
    table = show(user, "Above")
    QTest.mouseClick(table.add_button, Qt.MouseButton.LeftButton)
    assert [row.end for row in curve(user).above] == [1.0]
    QTest.mouseClick(table.remove_button, Qt.MouseButton.LeftButton)
    assert curve(user).above == ()
    assert not table.remove_button.isEnabled()


def test_a_number_outside_its_range_is_refused_in_its_cell(user: User) -> None:
    table = show(user, "Below")
    QTest.mouseClick(table.add_button, Qt.MouseButton.LeftButton)
    before = curve(user).below
    type_into(user, 0, 1, "1.5")
    assert curve(user).below == before
    assert "allowed: 0 ... 1" in table.refusal.text()
    type_into(user, 0, 1, "0.3")
    assert curve(user).below[0].end == 0.3
    assert table.refusal.text() == ""


def test_an_obstacle_that_no_law_passes_waits(user: User) -> None:
    show(user, "Below")
    lists(user).add()
    valid = user.design
    type_into(user, 0, 2, "-5")
    user.wait_for_laws()
    assert user.session.incomplete is not None
    assert user.design == valid, "the last valid law is drawn"
    assert lists(user).model.is_faulty(0, 2)
    assert "no law passes these bounds" in user.motion().incomplete_bar.trouble.text()
    type_into(user, 0, 2, "0.6")
    user.wait_for_laws()
    assert user.session.incomplete is None
    assert curve(user).below[0].rise == 0.6


def test_a_limit_that_no_law_keeps_waits_for_another_one(user: User) -> None:
    valid = user.design
    user.enter(f"{PATH}.limits.jerk", "20")
    user.wait_for_laws()
    assert user.design == valid, "the last valid design is drawn"
    assert "32.048" in user.field(f"{PATH}.limits.jerk").trouble
    user.enter(f"{PATH}.limits.jerk", "40")
    user.wait_for_laws()
    assert curve(user).limits.jerk == 40.0
    assert user.session.incomplete is None


def test_its_parameters_have_names(user: User) -> None:
    design = edited(user.design, f"{PATH}.below", (CurveBound(0.0, 0.3, 0.2),))
    for key, name in (
        ("minimise", "minimise"),
        ("limits.jerk", "jerk limit"),
        ("below[0].start", "obstacle below 1 from"),
        ("below", "below"),
        ("intervals", "intervals"),
    ):
        assert name_of(design, f"{PATH}.{key}") == f"Segment 2, {name}"


def test_a_law_of_least_torque_is_chosen_and_marked_local(user: User) -> None:
    def note() -> bool:
        return any(
            label.isVisible()
            for label in user.motion().curve.findChildren(QLabel)
            if label.text().startswith("Local: ")
        )

    assert not note()
    before = np.abs(user.session.study.dynamics.torque[175:382]).max()
    box = user.field(f"{PATH}.minimise").editor
    assert isinstance(box, WordBox)
    box.setCurrentIndex(box.findData("torque"))
    box.activated.emit(box.currentIndex())
    user.wait_for_laws()
    assert curve(user).minimise == "torque"
    assert np.abs(user.session.study.dynamics.torque[175:382]).max() < before
    assert note()
    box.setCurrentIndex(box.findData("motor_rms"))
    box.activated.emit(box.currentIndex())
    settle()
    assert user.design.drive.motion.segments[1].curve.minimise == "torque", "there is no servo"
    trouble = user.field(f"{PATH}.minimise").trouble
    assert "Needs [servo]" in trouble
    assert "rms of acceleration, rms of jerk, torque or contact force" in trouble, "the words of the field itself"
    assert "_" not in trouble


def test_a_refused_limit_reddens_its_own_field_alone(user: User) -> None:
    """The law falls below its end before an obstacle, so that the true stroke is larger than the rise."""
    user.session.edit(f"{PATH}.points", (), "No points")
    user.session.edit(f"{PATH}.below", (CurveBound(0.0, 0.4, 0.2),), "Add an obstacle")
    user.session.edit(f"{PATH}.limits.velocity", 1.9, "Limit the velocity")
    user.wait_for_laws()
    stroke = user.field("motion.stroke_mm").editor
    assert isinstance(stroke, NumberBox)
    shown = stroke.text()
    assert float(shown) > 150.001
    user.enter(f"{PATH}.limits.jerk", "20")
    user.wait_for_laws()
    assert "No law keeps this limit" in user.field(f"{PATH}.limits.jerk").trouble
    assert not stroke.is_waiting
    assert stroke.text() == shown
