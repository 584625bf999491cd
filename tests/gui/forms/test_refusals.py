"""A refused entry stays as typed and framed; a sentence in sight says why, and a button does the remedy as one undo step."""

from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QCursor, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QLineEdit, QWidget
from shiboken6 import delete, isValid
from window_user import Alone, Open, User, answering, settle, wait_for

from core.design import Info
from core.number_text import NARROW_SPACE
from kindyna_gui import dialogs
from kindyna_gui.export_dialogs import TablesDialog
from kindyna_gui.forms.refusal import FloatingRefusal, RefusalLine
from kindyna_gui.forms.request_form import ScaleDialog
from kindyna_gui.linkage.underlay import UnderlayPanel
from kindyna_gui.motion.segments_table import RISE, SPAN, TO
from kindyna_gui.places import example
from kindyna_gui.studies.study_view import StudyView

ROD, FRICTION = "follower.rod_mm", "loads.friction"
ANGLE = "limits.pressure_angle_rise_deg"
BILLION = f"1{NARROW_SPACE}000{NARROW_SPACE}000{NARROW_SPACE}000"


@pytest.fixture
def user(open_user: Open) -> User:
    return open_user()


def click(line: RefusalLine, text: str) -> None:
    """Click a button of a refusal that is in sight."""
    assert line.isVisible()
    assert not line.visibleRegion().isEmpty()
    QTest.mouseClick(line.buttons[text], Qt.MouseButton.LeftButton)
    settle()


def place(widget: QWidget) -> QRect:
    """Where a widget is on the screen."""
    return QRect(widget.mapToGlobal(QPoint()), widget.size())


# -- rules ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("info", "value", "nearest"),
    [
        (Info("", low=0.0, high=90.0), 120.0, 90.0),
        (Info("", low=0.0, high=90.0), -3.0, 0.0),
        (Info("", low=0.0, open_low=True), -3.0, None),
        (Info("", low=0.0), 1e300, None),
        (Info("", low=0, high=9, whole=True), 12.4, 9),
        (Info("", low=0, high=9, whole=True), 3.4, 3),
        (Info("", numbers=(1, 5)), 4.0, 5),
        (Info("", choices=("a", "b")), 4.0, None),
    ],
)
def test_the_nearest_allowed_value(info: Info, value: float, nearest: float | None) -> None:
    assert info.nearest(value) == nearest


# -- fields -----------------------------------------------------------------------------------------------


def test_a_button_goes_back_to_the_last_valid_value(user: User) -> None:
    user.enter(ROD, "850")
    user.enter(ROD, "-5")
    line = user.field(ROD).message
    assert line.text().endswith("not −5 mm")
    assert list(line.buttons) == ["Back to 850 mm"]
    click(line, "Back to 850 mm")
    assert (user.number(ROD).text(), user.number(ROD).is_refused, line.isVisible()) == ("850", False, False)
    assert user.number(ROD).hasFocus()
    assert user.steps == ["Change rod L2 to 850 mm"]


def test_a_button_enters_the_nearest_allowed_value_as_one_step(user: User) -> None:
    user.enter(ANGLE, "120")
    line = user.field(ANGLE).message
    assert line.text() == "Outside its range; allowed: above 0 ... 90 °, not 120°"
    assert user.number(ANGLE).text() == "120"
    click(line, "Use 90°")
    assert user.steps == ["Change pressure angle, rise to 90°"]
    assert (user.number(ANGLE).text(), line.isVisible()) == ("90", False)
    user.press(Qt.Key.Key_Z, modifier=Qt.KeyboardModifier.ControlModifier)
    assert user.number(ANGLE).text() == ""


def test_two_buttons_are_below_their_sentence(user: User) -> None:
    user.enter(ANGLE, "30")
    user.enter(ANGLE, "120")
    line = user.field(ANGLE).message
    assert list(line.buttons) == ["Use 90°", "Back to 30°"]
    use, back = (place(button) for button in line.buttons.values())
    (label,) = line.findChildren(QLabel)
    assert use.top() == back.top() > place(label).bottom()
    assert use.right() < back.left()
    assert back.right() <= place(line).right()
    assert label.width() > 0.9 * line.width()
    assert label.height() <= 2 * label.fontMetrics().lineSpacing() + 4


def test_the_status_line_writes_a_range_as_the_field_does(user: User) -> None:
    user.enter(ROD, "-5")
    status = user.window.status.currentMessage()
    assert status.startswith(f"Refused: Rod L2: outside its range; allowed: above 0 ... {BILLION} mm")
    assert user.field(ROD).message.text() == f"Outside its range; allowed: above 0 ... {BILLION} mm, not −5 mm"


def test_the_remedy_is_reached_by_keys(user: User) -> None:
    user.enter(ROD, "-5")
    line = user.field(ROD).message
    line.buttons["Back to 845 mm"].setFocus(Qt.FocusReason.TabFocusReason)
    user.press(Qt.Key.Key_Space)
    assert (user.number(ROD).text(), line.isVisible()) == ("845", False)


def test_a_refusal_moves_nothing_and_covers_neither_mouse_nor_focus(user: User) -> None:
    fields = user.parameters().forms["follower"].fields
    rod, below = fields[ROD], fields["follower.guide_height_mm"]
    user.number(ROD)

    def positions() -> list[QPoint]:
        return [field.editor.mapTo(user.window, QPoint()) for field in fields.values()]

    before = positions()
    user.enter(ROD, "-5")
    assert positions() == before
    line = rod.message
    assert place(line).top() > place(rod.editor).bottom()
    below.focus()
    settle()

    assert QApplication.focusWidget() is below.editor
    assert not place(line).intersects(place(below.editor)), "it goes above"
    user.press(Qt.Key.Key_Tab)
    user.number(ROD)
    user.press(Qt.Key.Key_Escape)
    assert not line.isVisible()
    QCursor.setPos(place(below.editor).center())
    user.enter(ROD, "-5")
    assert line.isVisible()
    assert not place(line).contains(QCursor.pos())
    QCursor.setPos(5000, 5000)


def test_a_misfit_is_a_sentence_in_sight_with_a_button_back(user: User) -> None:
    user.enter("follower.roller_arm_mm", "100")
    bar = user.parameters().incomplete_bar
    assert "Roller arm Zl: the roller cannot reach" in bar.trouble.text()
    assert bar.drop_button.text() == "Back to 651.081 mm"
    before = user.steps
    QTest.mouseClick(bar.drop_button, Qt.MouseButton.LeftButton)
    settle()
    assert user.number("follower.roller_arm_mm").text() == "651.081"
    assert len(user.steps) == len(before) + 1


def test_a_misfit_offers_the_nearest_value_that_fits_as_one_step(user: User) -> None:
    """Pivot at 876.16 mm, base radius and roller 550 mm: no roller arm below the difference reaches the base circle."""
    user.enter("follower.roller_arm_mm", "100")
    bar = user.parameters().incomplete_bar
    wait_for(bar.use_button.isVisible)
    assert bar.use_button.text() == "Use 326.2 mm"
    before = user.steps
    QTest.mouseClick(bar.use_button, Qt.MouseButton.LeftButton)
    settle()
    assert user.number("follower.roller_arm_mm").text() == "326.2"
    assert not bar.isVisible()
    assert len(user.steps) == len(before) + 1
    user.press(Qt.Key.Key_Z, modifier=Qt.KeyboardModifier.ControlModifier)
    assert user.number("follower.roller_arm_mm").text() == "100"


def test_a_misfit_offers_a_value_of_the_field_that_its_reason_names(open_user: Open) -> None:
    """No speed, typed last, lets the roller reach the base circle: an arm of √(200² + 30²) − 57 mm does."""
    user = open_user(example("rocker_cam"))
    user.enter("follower.pivot_x_mm", "200")
    user.enter("shaft.speed_rpm", "90")
    bar = user.parameters().incomplete_bar
    wait_for(bar.use_button.isVisible)
    assert bar.use_button.text() == "Arm: use 145.3 mm"
    QTest.mouseClick(bar.use_button, Qt.MouseButton.LeftButton)
    settle()
    assert not bar.isVisible()
    assert user.steps[-1] == "Change arm to 145.3 mm"
    assert (user.number("shaft.speed_rpm").text(), user.number("follower.pivot_x_mm").text()) == ("90", "200")


def test_the_range_of_a_misfit_is_never_empty(user: User) -> None:
    user.enter("follower.pivot_x_mm", "1000000000")
    text = user.parameters().incomplete_bar.trouble.text()
    gap = NARROW_SPACE
    assert f"make the roller arm 999{gap}999{gap}500 ... {BILLION} mm long" in text


# -- cells of tables ---------------------------------------------------------------------------------------


def test_a_refused_cell_goes_back_by_a_button(user: User) -> None:
    user.enter_cell(1, SPAN, "400")
    view = user.motion()
    assert view.message.text().endswith("not 400°")
    click(view.message, "Back to 41.5°")
    assert (user.cell(1, SPAN), view.message.isVisible(), user.steps) == ("41.5", False, [])


def test_a_refused_end_stays_as_typed_in_its_cell(user: User) -> None:
    user.enter_cell(1, TO, "300")
    view = user.motion()
    assert (user.cell(1, TO), user.cell(1, SPAN)) == ("300", "41.5")
    assert view.model.is_refused(1, TO)
    assert not view.model.is_refused(1, SPAN)
    click(view.message, "Back to 76.5°")
    assert user.cell(1, TO) == "76.5"


def test_what_is_no_number_in_a_cell_goes_back_by_a_button(user: User) -> None:
    user.enter_cell(1, RISE, "much")
    view = user.motion()
    assert list(view.message.buttons) == ["Back to −150 mm"]


# -- other forms -------------------------------------------------------------------------------------------


def test_a_refused_bound_of_a_study_goes_back_by_a_button(user: User) -> None:
    user.session.vary(ROD)
    settle()
    view = user.window.view("study")
    assert isinstance(view, StudyView)
    box = view.rows.boxes[ROD, "low"]
    before = box.text()
    box.setFocus()
    box.selectAll()
    user.type("-3")
    user.press(Qt.Key.Key_Return)
    assert view.rows.message.text().endswith(f"outside its range; allowed: above 0 ... {BILLION} mm, not −3 mm")
    status = user.window.status.currentMessage()
    assert "1e+09" not in status
    assert (box.text(), box.is_refused) == ("-3", True)
    click(view.rows.message, f"Back to {before} mm")
    assert (box.text(), box.is_refused, view.rows.message.isVisible()) == (before, False, False)


@pytest.mark.parametrize(
    ("width", "buttons"), [(400, ("Use 90°", "Back to 30°")), (220, ("Back to 10.97669855613389",))]
)
def test_a_sentence_is_in_sight_above_its_buttons(alone: Alone, width: int, buttons: tuple[str, ...]) -> None:
    """After another refusal, whose button was beside its shorter sentence."""
    page = QWidget()
    editor = QLineEdit(page)
    alone(page, width, 300)
    refusal = FloatingRefusal(editor)
    refusal.show_refusal("Enter a number", {"Back to 5": bool})
    settle()
    long = f"Outside its range; allowed: above 0 ... {BILLION} mm, between its neighbours, not 120 mm"
    refusal.show_refusal(long, dict.fromkeys(buttons, bool))
    settle()
    (label,) = refusal.findChildren(QLabel)
    assert label.height() >= label.heightForWidth(label.width())
    assert label.width() > 0.9 * refusal.width()
    for button in refusal.buttons.values():
        assert place(button).top() > place(label).bottom()
        assert place(refusal).contains(place(button))


def test_a_refusal_ends_with_its_editor(alone: Alone) -> None:
    """A cell of a table is deleted while its refusal is shown, and the focus goes on."""
    page = QWidget()
    editor, other = QLineEdit(page), QLineEdit(page)
    other.move(0, 120)
    alone(page, 400, 200)
    editor.setFocus()
    refusal = FloatingRefusal(editor)
    refusal.show_refusal("outside its range")
    settle()
    assert refusal.isVisible()
    delete(editor)
    other.setFocus()
    settle()
    assert not isValid(refusal) or not refusal.isVisible()


# -- dialogs -----------------------------------------------------------------------------------------------


def refusals(dialog: QWidget) -> list[FloatingRefusal]:
    """Refusals in sight."""
    return [line for line in dialog.findChildren(FloatingRefusal) if line.isVisible()]


def type_over(box: QWidget, text: str) -> None:
    box.setFocus()
    box.selectAll()  # type: ignore[attr-defined]
    QTest.keyClicks(box, text)
    settle()


def test_a_refused_factor_has_a_button_and_gives_no_command(user: User) -> None:
    def act(dialog: ScaleDialog) -> None:
        type_over(dialog.factor, "2")
        QTest.keyClick(dialog.factor, Qt.Key.Key_Return)
        type_over(dialog.factor, "-1")
        (line,) = refusals(dialog)
        assert line.text().startswith("Outside its range; allowed: ")
        assert line.text().endswith("not −1")
        assert (dialog.factor.text(), dialog.factor.is_refused) == ("-1", True)
        assert not dialog.scale_button.isEnabled()
        assert not dialog.copy.isEnabled()
        click(line, "Back to 2")
        assert (dialog.factor.text(), dialog.factor.is_refused, refusals(dialog)) == ("2", False, [])
        assert dialog.scale_button.isEnabled()
        dialog.reject()

    with answering(ScaleDialog, act):
        user.choose("Edit", "Scale the design...")


def test_tables_without_a_folder_or_with_too_many_rows_are_refused(user: User) -> None:
    def act(dialog: TablesDialog) -> None:
        type_over(dialog.folder, "")
        QTest.keyClick(dialog.folder, Qt.Key.Key_Delete)
        (line,) = refusals(dialog)
        assert line.text() == "Enter the folder of the tables"
        assert (dialog.folder.is_refused, dialog.accept_button.isEnabled()) == (True, False)
        click(line, next(iter(line.buttons)))
        assert dialog.accept_button.isEnabled()
        samples = dialog.form.boxes["samples"]
        type_over(samples, "3.5")
        (line,) = refusals(dialog)
        assert line.text().startswith("Must be a whole number; allowed: 4 ... ")
        assert list(line.buttons) == ["Use 4", "Back to 3600"]
        type_over(samples, "many")
        (line,) = refusals(dialog)
        assert line.text() == "Enter a number, such as 12.5"
        assert list(line.buttons) == ["Back to 3600"]
        assert (dialog.accept_button.isEnabled(), dialog.copy.isEnabled()) == (False, False)
        QTest.keyClick(samples, Qt.Key.Key_Escape)
        assert (samples.text(), refusals(dialog), dialog.accept_button.isEnabled()) == ("3600", [], True)
        dialog.reject()

    with answering(TablesDialog, act):
        user.choose("File", "Export", "Tables...")


def test_a_refused_scale_of_an_underlay_goes_back_by_a_button(
    open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    image = QImage(20, 10, QImage.Format.Format_RGB32)
    image.save(str(tmp_path / "old.png"))
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: tmp_path / "old.png")
    user = open_user()
    user.choose("File", "New by type", "Linkage by drawing")
    user.choose("Compo", "Underlay...")
    (panel,) = (widget for widget in QApplication.topLevelWidgets() if isinstance(widget, UnderlayPanel))
    box = panel.boxes["scale_mm_per_unit"]
    before = box.text()
    type_over(box, "0")
    QTest.keyClick(box, Qt.Key.Key_Return)
    (line,) = refusals(panel)
    assert line.text() == "Outside its range; allowed: > 0, not 0"
    assert (box.text(), box.is_refused) == ("0", True)
    click(line, next(iter(line.buttons)))
    assert (box.text(), box.is_refused, refusals(panel)) == (before, False, [])
