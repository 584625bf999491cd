"""kindyna_gui.motion.segments_view, segments_model: the motion as a table that keeps itself whole."""

import pytest
from mechanisms import levels, with_drive
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractItemView, QApplication, QMenu
from window_user import Open, User, plain, settle, wait_for

from core.design import CURVES, Motion, edited
from core.laws import LAWS
from core.project import load
from core.study import Study
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.motion.diagram import join_help, join_text
from kindyna_gui.motion.law_picker import LawPicker
from kindyna_gui.motion.segments_table import FROM, JOIN, LAW, RISE, SPAN, TO, difference, readable
from kindyna_gui.pictures.units import digits
from kindyna_gui.places import example

LIFT = load(example("transfer_lift"))
EDITING = QAbstractItemView.State.EditingState


@pytest.fixture
def user(same_window: Open) -> User:
    """Without plots, for which no test here has eyes."""
    return same_window()


def motion(user: User) -> Motion:
    return user.design.drive.motion


def spans(user: User) -> list[float]:
    return [s.span_deg for s in motion(user).segments]


def column(user: User, number: int) -> list[str]:
    return [user.cell(row, number).strip() for row in range(user.motion().model.rowCount())]


def open_picker(user: User, row: int) -> LawPicker:
    """Open the pictures of the laws in a cell."""
    view = user.motion()
    view.choose(row, LAW)
    view.table.setFocus()
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: isinstance(QApplication.activePopupWidget(), LawPicker))
    picker = QApplication.activePopupWidget()
    assert isinstance(picker, LawPicker)
    return picker


def choose_law(user: User, row: int, slug: str) -> None:
    """Open the pictures of a cell and click on a law."""
    picker = open_picker(user, row)
    QTest.mouseClick(picker.grid, Qt.MouseButton.LeftButton, pos=picker.grid.box(slug).center())
    wait_for(lambda: user.motion().table.state() != EDITING)


# -- what is shown ----------------------------------------------------------------------------------------


def test_the_table_shows_the_motion_and_what_of_it_can_be_edited(user: User) -> None:
    assert column(user, LAW) == ["Dwell", "Modified sine", "Dwell", "Modified sine", "Dwell"]
    assert column(user, FROM) == ["0", "35", "76.5", "283.5", "325"]
    assert column(user, TO) == ["35", "76.5", "283.5", "325", "360"]
    assert column(user, SPAN) == ["35", "41.5", "207", "41.5", "35"]
    assert column(user, RISE) == ["0", "-150", "0", "150", "0"]
    assert column(user, JOIN) == ["s v a Δj", "s v a Δj", "s v a Δj", "s v a Δj", "s v a j"]
    # numbers are flush right
    model = user.motion().model
    for number in (FROM, TO, SPAN, RISE):
        for place in (model.index(0, number), None):
            align = (
                model.data(place, Qt.ItemDataRole.TextAlignmentRole)
                if place is not None
                else model.headerData(number, Qt.Orientation.Horizontal, Qt.ItemDataRole.TextAlignmentRole)
            )
            assert align & Qt.AlignmentFlag.AlignRight
    # what cannot change cannot be edited
    fixed = {
        (row, number)
        for row in range(5)
        for number in range(6)
        if not model.flags(model.index(row, number)) & Qt.ItemFlag.ItemIsEditable
    }
    assert fixed == {*((row, JOIN) for row in range(5)), (0, FROM), (4, TO), (0, RISE), (2, RISE), (4, RISE)}


def test_joins_say_what_jumps() -> None:
    design = edited(LIFT, "motion.segments[1].law", "constant-velocity")
    drive = design.drive.motion
    joins = Study(design).program.joins
    assert join_text(joins[0], drive) == "s Δv\u00a0207.1 a j"
    assert join_help(joins[0], drive).splitlines()[:2] == [
        "Continuous in displacement, acceleration, jerk",
        "Velocity jumps by \u2212207.1 mm/rad",
    ]
    design = edited(LIFT, "motion.segments[1].law", "simple-harmonic")
    assert join_text(Study(design).program.joins[0], design.drive.motion).startswith("s v Δa\u00a01411")
    assert join_text(joins[4], drive) == "s v a j"


def test_differences_are_reckoned_in_decimals() -> None:
    assert difference(76.5, 35.0) == 41.5
    assert difference(0.3, 0.1) == 0.2


def test_numbers_are_as_short_as_a_narrow_column_asks() -> None:
    for value, text in (
        (0.0, "0"),
        (-150.0, "-150"),
        (283.5, "283.5"),
        (18.846835393579, "18.847"),
        (1e-5, "0.00001"),
        (1.0 / 3.0, "0.33333"),
        (-1234.5678, "-1234.6"),
    ):
        assert readable(value) == text


def test_a_zero_has_no_digits_to_show() -> None:
    for value, text in ((0.0, "0"), (-0.0, "0"), (1e-30, "0"), (-1e-30, "0"), (-1e-3, "\u22120.00100")):
        assert digits(value, 3) == text


# -- typing -----------------------------------------------------------------------------------------------


def test_angles_are_typed(user: User) -> None:
    for row, number, text, step in (
        (1, SPAN, "45", "Change span of segment 2 to 45°"),
        (1, TO, "80", "Move start of segment 3 to 80°"),
        (2, FROM, "80 °", "Move start of segment 3 to 80°"),
    ):
        user.enter_cell(row, number, text)
        assert spans(user) == [35.0, 45.0, 203.5, 41.5, 35.0]
        assert user.steps == [step]
        user.choose("Edit", f"Undo {step}")
        assert user.design == LIFT


def test_rises_are_typed_and_balanced(user: User) -> None:
    user.enter_cell(1, RISE, "-120")
    assert column(user, RISE) == ["0", "-120", "0", "120", "0"]
    assert user.steps == ["Change rise of segment 2 to \u2212120 mm"]


def test_a_key_begins_to_type(user: User) -> None:
    view = user.motion()
    view.choose(1, SPAN)
    view.table.setFocus()
    QTest.keyClick(view.table, Qt.Key.Key_5)
    wait_for(lambda: view.table.state() == EDITING)
    user.type("0")
    user.press(Qt.Key.Key_Tab)
    wait_for(lambda: spans(user)[1] == 50.0)


def test_a_law_is_chosen_from_the_list(user: User) -> None:
    choose_law(user, 1, "cycloidal")
    assert motion(user).segments[1].curve.law == "cycloidal"
    assert user.steps == ["Change law of segment 2 to Cycloidal"]
    assert column(user, LAW)[1] == "Cycloidal"


def test_all_laws_are_offered(user: User) -> None:
    picker = open_picker(user, 1)
    assert sorted(cell.slug for cell in picker.grid.cells) == sorted((*LAWS, *CURVES))
    assert picker.grid.current == "modified-sine"
    user.press(Qt.Key.Key_Escape)
    wait_for(lambda: user.motion().table.state() != EDITING)
    assert user.design == LIFT


def test_what_becomes_a_dwell_leaves_the_way_back_its_rise(user: User) -> None:
    choose_law(user, 1, "dwell")
    assert column(user, RISE) == ["0", "0", "0", "150", "0"]
    user.choose("Edit", "Undo Change law of segment 2 to Dwell")
    assert user.design == LIFT


def test_steps_in_a_cell_are_live_and_one_step_back(user: User) -> None:
    view = user.motion()
    view.choose(1, SPAN)
    view.table.setFocus()
    user.press(Qt.Key.Key_F2)
    wait_for(lambda: isinstance(QApplication.focusWidget(), NumberBox))
    user.press(Qt.Key.Key_Up)
    assert spans(user)[1] == 42.5
    user.press(Qt.Key.Key_Up, Qt.Key.Key_Up)
    assert spans(user)[1:3] == [44.5, 204.0]
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: view.table.state() != EDITING)
    assert user.steps == ["Change span of segment 2 to 44.5°"]


# -- refusing ---------------------------------------------------------------------------------------------


def test_a_wrong_span_stays_in_its_cell_in_red(user: User) -> None:
    user.enter_cell(1, SPAN, "400")
    view = user.motion()
    assert user.design == LIFT
    assert user.cell(1, SPAN) == "400"
    assert view.model.is_refused(1, SPAN)
    assert view.message.isVisible()
    assert view.message.text().startswith("Outside its range; allowed: ")
    view.table.setFocus()
    user.press(Qt.Key.Key_Escape)
    assert (user.cell(1, SPAN), view.message.isVisible()) == ("41.5", False)
    assert user.window.status.currentMessage() == ""


def test_a_span_its_neighbour_cannot_give_stays_until_it_is_mended(user: User) -> None:
    user.enter_cell(1, SPAN, "300")
    view = user.motion()
    assert user.design == LIFT
    assert column(user, SPAN) == ["35", "300", "207", "41.5", "35"]
    assert view.model.is_faulty(1, SPAN)
    assert "258.5° more than a turn" in view.incomplete_bar.trouble.text()
    user.enter_cell(1, SPAN, "45")
    assert spans(user) == [35.0, 45.0, 203.5, 41.5, 35.0]
    assert not view.incomplete_bar.isVisible()


def test_what_is_no_number_is_refused(user: User) -> None:
    user.enter_cell(1, RISE, "much")
    assert user.cell(1, RISE) == "much"
    assert user.motion().message.text() == "Enter a number, such as 12.5"


def test_a_decimal_comma_is_told_apart_and_the_number_in_place_takes_it_back(user: User) -> None:
    user.enter_cell(1, SPAN, "41,5")
    view = user.motion()
    assert "with a decimal point and no comma" in view.message.text()
    assert "Refused: Segment 2, span" in user.window.status.currentMessage()
    user.enter_cell(1, SPAN, "41.5")
    assert (user.cell(1, SPAN), view.model.is_refused(1, SPAN), view.message.isVisible()) == ("41.5", False, False)
    assert user.window.status.currentMessage() == ""
    assert user.design == LIFT


@pytest.mark.parametrize("text", ["34", "283.5", "-5", "1e9"])
def test_an_end_beyond_a_neighbour_is_told_with_what_is_allowed(user: User, text: str) -> None:
    user.enter_cell(1, TO, text)
    assert user.design == LIFT
    told = user.motion().message.text()
    assert "is outside the neighbouring segments" in told
    assert "allowed: above 35° ... below 283.5°" in told


def test_a_refused_cell_is_forgotten_when_segments_come_or_go(user: User) -> None:
    """Its number may be another segment's then."""
    user.enter_cell(1, SPAN, "400")
    view = user.motion()
    assert view.message.isVisible()
    view.choose(0)
    user.choose("Make", "Insert segment")
    assert column(user, SPAN) == ["17.5", "17.5", "41.5", "207", "41.5", "35"]
    assert not any(view.model.is_refused(row, SPAN) for row in range(6))
    assert (view.message.text(), view.message.isVisible()) == ("", False)


def test_undo_takes_a_refused_cell_back(user: User) -> None:
    user.enter_cell(1, SPAN, "45")
    user.enter_cell(1, SPAN, "400")
    user.choose("Edit", "Undo Change span of segment 2 to 45°")
    assert user.cell(1, SPAN) == "41.5"
    assert not user.motion().message.isVisible()


# -- start and stroke -------------------------------------------------------------------------------------


def test_the_stroke_is_changed_by_the_menu(user: User) -> None:
    view = user.motion()
    user.choose("Make", "Stroke")
    assert QApplication.focusWidget() is view.fields["motion.stroke_mm"].editor
    user.type("160")
    user.press(Qt.Key.Key_Return)
    assert column(user, RISE) == ["0", "-160", "0", "160", "0"]
    assert motion(user).start == 160.0
    assert user.steps == ["Change stroke to 160 mm"]


def test_an_absurd_stroke_is_refused(user: User) -> None:
    for text in ("0", "-150", "1e300"):
        user.enter("motion.stroke_mm", text)
        assert user.design == LIFT
        assert user.motion().fields["motion.stroke_mm"].message.text().startswith("Outside its range")


def test_where_nothing_moves_there_is_no_stroke_to_change(user: User) -> None:
    user.window.session.stages_on_screen = tuple
    user.enter_cell(1, RISE, "0")
    editor = user.motion().fields["motion.stroke_mm"].editor
    assert not editor.isEnabled()
    user.choose("Make", "Stroke")
    assert "give a segment a law and a rise" in user.window.status.currentMessage()
    assert "give a segment a law and a rise" in editor.toolTip()
    user.choose("Edit", "Undo Change rise of segment 2 to 0 mm")
    assert "highest minus lowest" in editor.toolTip()


def test_the_start_is_a_field(user: User) -> None:
    user.choose("Make", "Start")
    user.type("140")
    user.press(Qt.Key.Key_Return)
    assert motion(user).start == 140.0


# -- segments come and go ---------------------------------------------------------------------------------


def test_insert_and_delete_by_the_menu(user: User) -> None:
    user.choose("Make", "Motion table")
    user.motion().choose(2)
    user.choose("Make", "Insert segment")
    assert spans(user) == [35.0, 41.5, 103.5, 103.5, 41.5, 35.0]
    assert user.motion().chosen == 3
    user.choose("Make", "Delete segment")
    assert user.design == LIFT
    assert user.steps == ["Insert segment after segment 3", "Delete segment 4"]


def test_insert_and_delete_by_keys_and_buttons(user: User) -> None:
    view = user.motion()
    view.choose(1)
    view.table.setFocus()
    user.press(Qt.Key.Key_Insert)
    assert column(user, LAW)[:3] == ["Dwell", "Modified sine", "Dwell"]
    assert len(spans(user)) == 6
    user.press(Qt.Key.Key_Delete)
    assert user.design == LIFT
    QTest.mouseClick(view.bar.buttons["insert"], Qt.MouseButton.LeftButton)
    QTest.mouseClick(view.bar.buttons["delete"], Qt.MouseButton.LeftButton)
    assert user.design == LIFT


def test_the_last_segment_stays(user: User) -> None:
    user.window.session.stages_on_screen = tuple
    view = user.motion()
    for _ in range(10):
        view.act("delete")
        settle()
    assert len(spans(user)) == 1
    assert not view.bar.buttons["delete"].isEnabled()


# -- assumption -------------------------------------------------------------------------------------------


def test_a_cell_is_marked_as_assumed_by_its_menu(user: User) -> None:
    view = user.motion()
    place = view.table.visualRect(view.model.index(1, LAW)).center()
    view.table.customContextMenuRequested.emit(QPoint(place))
    menu = view.table.findChild(QMenu)
    assert menu is not None
    action = next(a for a in menu.actions() if plain(a.text()).startswith("Assumed"))
    assert not action.isChecked()
    action.trigger()
    menu.close()
    assert user.design.assumed == ("motion.segments[1].law", *LIFT.assumed)
    assert user.steps == ["Mark law of segment 2 as assumed"]
    assert view.model.is_assumed(1, LAW)
    assert not view.model.is_assumed(1, SPAN)


def test_the_motion_of_another_file_takes_the_place(user: User) -> None:
    user.motion()
    user.choose("File", "Examples", "Card picker")
    assert column(user, LAW) == ["Dwell", *(LAWS[slug].label for slug in ("c1", "cv1", "h2", "p2")), "Dwell"]
    assert not user.motion().model.is_assumed(1, LAW)


def test_enter_in_a_cell_that_cannot_be_edited_does_nothing(user: User) -> None:
    view = user.motion()
    view.choose(0, FROM)
    before = user.design
    view.table.setFocus()
    user.press(Qt.Key.Key_Return)
    assert view.table.state() != EDITING
    assert user.design is before


def test_a_wrong_number_that_the_focus_leaves_is_entered_once(user: User) -> None:
    """The editor closes at that; its number stays in the cell, in red."""
    view = user.motion()
    view.choose(1, SPAN)
    view.table.setFocus()
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: view.table.state() == EDITING)
    user.type("4000")
    user.window.bar.setFocus()
    settle()
    assert view.table.state() != EDITING
    assert view.model.is_refused(1, SPAN)
    assert user.cell(1, SPAN).strip() == "4000"


def test_enter_in_a_cell_that_the_table_gives_up_before_it_counts_is_quiet(user: User) -> None:
    """Enter counts a moment later; an undo, or another file, may come first and take the cell away."""
    view = user.motion()
    view.choose(4, SPAN)
    view.table.setFocus()
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: view.table.state() == QAbstractItemView.State.EditingState)
    QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Return)
    other = levels(150.0, (180.0, 0.0, "cycloidal"), (180.0, 150.0, "cycloidal"))
    user.session.put(with_drive(user.design, motion=other), "Another motion")
    settle()
    assert view.table.model().rowCount() == 2
    assert view.table.state() != QAbstractItemView.State.EditingState
