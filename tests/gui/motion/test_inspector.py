"""The motion in the inspector: in every task the chosen segment's law, span and rise, wherever it was chosen."""

from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, settle, wait_for

from core.design import get
from core.project import load
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.forms.parameters_view import ParametersView
from kindyna_gui.motion.inspector import MotionPage
from kindyna_gui.motion.law_picker import LawBox
from kindyna_gui.motion.segments_table import LAW
from kindyna_gui.places import example


@pytest.fixture
def user(same_window: Open) -> User:
    """Without the motion editor, until a test asks for it."""
    return same_window(example("rocker_cam"))


def page_of(view: ParametersView) -> MotionPage:
    page = view.pages["motion"]
    assert isinstance(page, MotionPage)
    return page


def page(user: User) -> MotionPage:
    view = user.parameters()
    view.show_section("motion")
    settle()
    return page_of(view)


def type_into(user: User, path: str, text: str) -> None:
    editor = page(user).fields[path].editor
    assert isinstance(editor, NumberBox)
    QTest.mouseClick(editor, Qt.MouseButton.LeftButton, pos=QPoint(10, editor.height() // 2))
    editor.selectAll()
    user.type(text)
    user.press(Qt.Key.Key_Return)


def test_law_span_and_rise_of_a_chosen_segment_are_typed_there(user: User) -> None:
    shown = page(user)
    shown.segment.setFocus()
    user.press(Qt.Key.Key_Down)  # the second
    assert user.session.segment == 1
    assert shown.segment.currentText() == "2  Modified sine, 110°"
    type_into(user, "motion.segments[1].span_deg", "100")
    type_into(user, "motion.segments[1].rise_deg", "20")
    assert [s.span_deg for s in user.design.drive.motion.segments] == [60.0, 100.0, 70.0, 130.0]
    assert user.steps == ["Change span of segment 2 to 100°", "Change rise of segment 2 to 20°"]
    laws = shown.fields["motion.segments[1].law"].editor
    assert isinstance(laws, LawBox)
    QTest.mouseClick(laws, Qt.MouseButton.LeftButton)
    wait_for(lambda: laws.picker is not None and laws.picker.isVisible())
    user.type("cycl")
    user.press(Qt.Key.Key_Return)
    assert get(user.design, "motion.segments[1].law") == "cycloidal"
    assert user.steps[-1] == "Change law of segment 2 to Cycloidal"
    assert "motion.segments[1].crossover" in shown.fields


def test_the_law_that_is_there_keeps_what_is_set_of_it(user: User) -> None:
    user.session.choose_segment(1)
    type_into(user, "motion.segments[1].crossover", "0.4")
    laws = page(user).fields["motion.segments[1].law"].editor
    assert isinstance(laws, LawBox)
    laws.activated.emit(laws.currentIndex())
    assert get(user.design, "motion.segments[1].crossover") == 0.4
    assert len(user.steps) == 1


def test_a_dwell_has_no_rise_to_type_and_buttons_act_on_the_chosen_segment(user: User) -> None:
    user.session.choose_segment(2)
    shown = page(user)
    assert not shown.fields["motion.segments[2].rise_deg"].editor.isEnabled()
    QTest.mouseClick(shown.bar.buttons["insert"], Qt.MouseButton.LeftButton)
    assert len(user.design.drive.motion.segments) == 5
    assert user.session.segment == 3
    QTest.mouseClick(shown.bar.buttons["delete"], Qt.MouseButton.LeftButton)
    assert len(user.design.drive.motion.segments) == 4
    assert user.steps == ["Insert segment after segment 3", "Delete segment 4"]


def test_a_refused_value_marks_the_page_and_stays(user: User) -> None:
    user.session.choose_segment(1)
    type_into(user, "motion.segments[1].span_deg", "400")
    view, before = user.parameters(), user.design
    field = page(user).fields["motion.segments[1].span_deg"]
    assert field.message.isVisible()
    assert not view.tabs.tabIcon(view.tabs.indexOf(view.pages["motion"])).isNull()
    assert user.design == before
    user.press(Qt.Key.Key_Escape)
    assert view.tabs.tabIcon(view.tabs.indexOf(view.pages["motion"])).isNull()


def test_what_is_asked_for_of_the_motion_opens_there_and_moves_no_dock(user: User) -> None:
    user.window.focus_field("motion.segments[3].rise_deg")
    settle()
    shown = page_of(user.parameters())
    assert QApplication.focusWidget() is shown.fields["motion.segments[3].rise_deg"].editor
    assert user.window.docks["motion"].isHidden()
    user.parameters().filter.setText("cam base")
    user.parameters().filter.setText("span")
    assert user.parameters().tabs.currentWidget() is shown
    user.parameters().filter.clear()


def test_a_click_on_a_segment_brings_its_fields_to_the_front(user: User) -> None:
    view, table = user.parameters(), user.motion().table
    view.show_section("cam")
    settle()
    QTest.mouseClick(
        table.viewport(), Qt.MouseButton.LeftButton, pos=table.visualRect(user.motion().model.index(3, LAW)).center()
    )
    settle()
    shown = page_of(view)
    assert view.tabs.currentWidget() is shown
    assert "motion.segments[3].span_deg" in shown.fields
    view.show_section("cam")
    diagram = user.motion().diagram
    QTest.mouseClick(diagram.viewport(), Qt.MouseButton.LeftButton, pos=diagram.position_of(110.0, 3.0).toPoint())
    settle()
    assert view.tabs.currentWidget() is shown
    assert "motion.segments[1].span_deg" in shown.fields


@pytest.mark.stress
def test_motions_that_cannot_be_typed_and_designs_without_one(same_window: Open) -> None:
    user = same_window(example("four_bar"))
    view = user.parameters()
    assert not view.tabs.isTabVisible(view.tabs.indexOf(view.pages["motion"]))
    user = same_window(example("transfer_unit"))
    shown = page(user)
    unit = next(iter(shown.fields)).rpartition("_")[2]
    assert unit == "deg"
    assert user.session.choose_drive(2)
    settle()
    assert next(iter(page(user).fields)) == "motion.start_mm"


def test_a_process_window_is_marked_in_the_form_and_undone(user: User, tmp_path: Path) -> None:
    user.session.choose_segment(1)
    path = "motion.segments[1].fixed"
    box = page(user).fields[path].editor
    assert isinstance(box, WordBox)
    assert [box.itemText(i) for i in range(box.count())] == ["no", "yes"]
    box.setFocus()
    user.press(Qt.Key.Key_Down)
    assert [s.fixed for s in user.design.drive.motion.segments] == [False, True, False, False]
    assert user.steps == ["Make segment 2 a process window"]
    user.session.save(tmp_path / "window.toml")
    assert (tmp_path / "window.toml").read_text("utf-8").count("fixed = true\n") == 1
    assert "fixed = false" not in (tmp_path / "window.toml").read_text("utf-8")
    assert load(tmp_path / "window.toml").drive.motion.segments[1].fixed
    user.session.stack.undo()
    assert not get(user.design, path)
    assert box.currentText() == "no"
