"""kindyna_gui.measured: a measured table is read, corrected, fitted and put into the design the way a user does it."""

import math
import shlex
from collections.abc import Callable
from pathlib import Path
from time import sleep

import numpy as np
import pytest
from measured_tables import position, workbook
from mechanisms import levels
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QComboBox,
    QFormLayout,
    QLabel,
    QPushButton,
    QStyle,
    QStyleOptionViewItem,
    QWidget,
)
from shiboken6 import isValid
from window_user import Open, User, settle, wait_for

from core.__main__ import main
from core.design import SplineCurve
from core.measured import MotionFit
from core.numerics.lazy import checkpoint
from core.project import load
from kindyna_gui import dialogs
from kindyna_gui.measured import form
from kindyna_gui.measured.dialog import COMPUTING, MeasuredDialog
from kindyna_gui.measured.form import symbol, with_symbols
from kindyna_gui.places import example

CHANCE = np.random.default_rng(8)
ANGLES = np.arange(0.0, 360.0, 2.0)
LIFT = 75.0 - 75.0 * np.cos(np.deg2rad(ANGLES)) + 0.05 * CHANCE.normal(size=ANGLES.size)
HEADER = "cam_angle_deg,displacement_mm"

Import = Callable[[str], MeasuredDialog]
"""Opens a file of this content through the menu."""


def table(header: str = HEADER, values: np.ndarray = LIFT, mark: str = ",") -> str:
    return header + "\n" + "".join(f"{a:g}{mark}{v:.3f}\n" for a, v in zip(ANGLES, values, strict=True))


@pytest.fixture
def lift(open_user: Callable[..., User]) -> User:
    """A user at the lift example, without plots."""
    return open_user()


@pytest.fixture
def imports(lift: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Import:
    path = tmp_path / "lift.csv"
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: path)

    def choose(text: str) -> MeasuredDialog:
        path.write_text(text, encoding="utf-8")
        lift.choose("File", "Import measured motion...")
        dialog = lift.window.findChild(MeasuredDialog)
        assert isinstance(dialog, MeasuredDialog)
        wait_for(lambda: dialog.isVisible() and not dialog.busy)
        return dialog

    return choose


def figure(dialog: MeasuredDialog, name: str) -> str:
    """A line of the result."""
    rows = dialog.figures
    shown = {}
    for i in range(rows.rowCount()):
        label, value = (
            rows.itemAt(i, role).widget() for role in (QFormLayout.ItemRole.LabelRole, QFormLayout.ItemRole.FieldRole)
        )
        assert isinstance(label, QLabel)
        assert isinstance(value, QLabel)
        shown[label.text()] = value.text()
    return shown[name]


def rested(widget: QWidget) -> None:
    """What the dialog of a widget computes is there, unless it has closed."""
    wait_for(lambda: not (isValid(widget) and isinstance(dialog := widget.window(), MeasuredDialog) and dialog.busy))


def unit_of(dialog: MeasuredDialog) -> str:
    """Beside the error of the motion's column."""
    assert dialog.reading.layout is not None
    return dialog.units[dialog.reading.layout.quantity].text()


def click(widget: QWidget) -> None:
    assert widget.isEnabled()
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton)
    settle()
    rested(widget)


def enter(user: User, box: QWidget, text: str) -> None:
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    user.type(text)
    user.press(Qt.Key.Key_Return)
    rested(box)


def pick(box: QComboBox, text: str) -> None:
    """Walk to an entry with the arrow keys."""
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_Home)
    for _ in range(box.count()):
        if box.currentText() == text:
            break
        QTest.keyClick(box, Qt.Key.Key_Down)
        rested(box)
    settle()
    assert box.currentText() == text


def pick_at_once(box: QComboBox) -> None:
    """The next entry, by its arrow key."""
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_Down)


def found(dialog: MeasuredDialog) -> list[tuple[str, ...]]:
    return [row.cells for row in dialog.entries.rows.rows]


def shown(dialog: MeasuredDialog) -> dict[str, str]:
    return {name: box.currentText() for name, box in dialog.form.boxes.items() if box.isVisible()}


# -- the way through --------------------------------------------------------------------------------------


def test_a_table_becomes_the_motion_as_one_step_that_can_be_undone(lift: User, imports: Import, tmp_path: Path) -> None:
    before = lift.design
    dialog = imports(table())
    assert shown(dialog) == {
        "delimiter": "Comma",
        "decimal": "Point  ( . )",
        "angle_column": "1  cam_angle_deg",
        "angle_unit": "degrees",
        "column": "2  displacement_mm",
        "quantity": "displacements",
        "value_unit": "mm",
    }
    assert dialog.error.value == pytest.approx(0.05, rel=0.2), "as the rows scatter"
    click(dialog.laws)
    click(dialog.dwells)
    enter(lift, dialog.error, "0.05")
    assert dialog.isVisible(), "Enter confirms the number, not the dialog"
    fit = dialog.reading.fit
    assert fit is not None
    assert (fit.error, fit.rms) == (0.05, pytest.approx(0.05))
    assert lift.design == before, "nothing happens before it is put"
    click(dialog.put_button)
    assert lift.design.drive.motion == fit.motion
    assert lift.steps == ["Import lift.csv"]
    lift.choose("Edit", "Undo Import lift.csv")
    assert lift.design == before
    lift.choose("Edit", "Redo Import lift.csv")
    lift.session.save(tmp_path / "d.toml")
    assert load(tmp_path / "d.toml").drive.motion == fit.motion
    assert isinstance(lift.design.drive.motion.segments[0].curve, SplineCurve)


def rise_and_return() -> np.ndarray:
    """60 mm within 110° and 120°, cycloidal, with noise."""
    rise = np.clip((ANGLES - 60.0) / 110.0, 0.0, 1.0) - np.clip((ANGLES - 220.0) / 120.0, 0.0, 1.0)
    noise = 0.004 * np.random.default_rng(5).normal(size=ANGLES.size)
    return 60.0 * (rise - np.sin(2.0 * np.pi * rise) / (2.0 * np.pi)) + noise


@pytest.mark.stress
def test_dwells_and_laws_are_listed_and_become_the_segments(lift: User, imports: Import) -> None:
    """Of a lift with noise: click on a line to see where it is."""
    dialog = imports(table(values=rise_and_return()))
    rows = [row.cells for row in dialog.segments.rows.rows]
    assert [cells[:2] for cells in rows[:3]] == [("60°", "170°"), ("170°", "220°"), ("220°", "340°")]
    assert [cells[3] for cells in rows] == ["60 mm", "0 mm", "\N{MINUS SIGN}60 mm", "0 mm"]
    assert segments(dialog) == ["Cycloidal", "Dwell"] * 2
    at = dialog.segments.visualRect(dialog.segments.rows.index(0, 3)).center()
    QTest.mouseClick(dialog.segments.viewport(), Qt.MouseButton.LeftButton, pos=at)
    assert dialog.rows_plot.cursor_at == pytest.approx(60.0, abs=0.5)
    click(dialog.put_button)
    laws = [segment.curve.law for segment in lift.design.drive.motion.segments]
    assert laws == ["dwell", "cycloidal", "dwell", "cycloidal", "dwell"]


def segments(dialog: MeasuredDialog) -> list[str]:
    """What each segment is."""
    return [box.currentText() for box in dialog.segments.boxes]


def pop_up(box: QComboBox, text: str) -> None:
    """Choose an entry of a box that is opened by a click."""
    QTest.mouseClick(box, Qt.MouseButton.LeftButton)
    wait_for(box.view().isVisible)
    for key in (Qt.Key.Key_Home, *[Qt.Key.Key_Down] * box.findText(text), Qt.Key.Key_Return):
        QTest.keyClick(box.view(), key)
    settle()
    rested(box)


def choose(dialog: MeasuredDialog, row: int, text: str) -> None:
    """Make a segment something else."""
    pop_up(dialog.segments.boxes[row], text)
    rested(dialog)


@pytest.mark.stress
def test_segments_are_switched_before_they_are_taken(lift: User, imports: Import, tmp_path: Path) -> None:
    before = lift.design
    dialog = imports(table(values=rise_and_return()))
    assert segments(dialog) == ["Cycloidal", "Dwell"] * 2
    choose(dialog, 1, "Table")
    choose(dialog, 2, "Modified sine")
    assert segments(dialog) == ["Cycloidal", "Table", "Modified sine", "Dwell"]
    off_by = float(dialog.segments.rows.rows[2].cells[4].split()[0])
    assert off_by > 0.2, "it is no modified sine, and that is told"
    assert lift.design is before, "nothing happens before it is taken"
    lift.session.save(tmp_path / "d.toml")
    click(copy_button(dialog))
    assert main(shlex.split(QApplication.clipboard().text())[2:]) == 0
    assert dialog.reading.fit is not None
    assert load(tmp_path / "d.toml").drive.motion == dialog.reading.fit.motion
    choose(dialog, 2, "As detected")
    assert segments(dialog) == ["Cycloidal", "Table", "Cycloidal", "Dwell"]
    choose(dialog, 0, "Table")
    assert segments(dialog) == ["Table", "Cycloidal", "Dwell"], "what follows on each other as a table is one"
    click(dialog.put_button)
    laws = [segment.curve.law for segment in lift.design.drive.motion.segments]
    assert laws == ["dwell", "table", "cycloidal", "dwell"]


@pytest.mark.stress
def test_what_a_segment_cannot_be_is_told_and_the_last_motion_stays(lift: User, imports: Import) -> None:
    """A rise within two rows: no law is fitted to so few."""
    values = 60.0 * (np.clip((ANGLES - 60.0) / 4.0, 0.0, 1.0) ** 2 - np.clip((ANGLES - 220.0) / 120.0, 0.0, 1.0))
    dialog = imports(table(values=values))
    click(dialog.keep_all)
    enter(lift, dialog.error, "0.01")
    assert segments(dialog)[0] == "Table"
    curve = dialog.rows_plot.lines[0][1]
    choose(dialog, 0, "Cycloidal")
    assert "too short or too low to be cycloidal" in dialog.message.text()
    assert dialog.segments.boxes[0].is_refused
    assert not dialog.error.is_refused
    assert not dialog.put_button.isEnabled()
    assert dialog.rows_plot.lines[0][1] is curve
    choose(dialog, 0, "Table")
    assert dialog.put_button.isEnabled()
    assert segments(dialog)[0] == "Table"


def test_cancel_leaves_the_design_alone(lift: User, imports: Import) -> None:
    before = lift.design
    dialog = imports(table())
    dialog.error.setFocus()
    lift.press(Qt.Key.Key_Escape)
    assert lift.design is before
    assert lift.steps == []
    settle()
    assert lift.window.findChild(MeasuredDialog) is None or not dialog.isVisible()


def test_without_a_file_nothing_opens(lift: User, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: None)
    lift.choose("File", "Import measured motion...")
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: tmp_path / "gone.csv")
    lift.choose("File", "Import measured motion...")
    assert lift.window.findChild(MeasuredDialog) is None
    assert lift.faults == [
        (
            "gone.csv cannot be read.",
            [f"{tmp_path / 'gone.csv'}: cannot be read: no such file or folder; check the spelling"],
        )
    ]


def test_the_file_is_asked_for_where_the_last_one_was(
    lift: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.txt").write_text(table(), "utf-8")
    asked: list[tuple[str, str]] = []

    def pick(parent: QWidget, title: str, folder: str, filters: str) -> tuple[str, str]:
        asked.append((folder, filters))
        return (str(tmp_path / "a.txt"), filters) if len(asked) == 1 else ("", "")

    monkeypatch.setattr(dialogs.QFileDialog, "getOpenFileName", pick)
    lift.choose("File", "Import measured motion...")
    dialog = lift.window.findChild(MeasuredDialog)
    assert dialog is not None
    rested(dialog.put_button)
    dialog.reject()
    lift.choose("File", "Import measured motion...")
    assert "*.csv *.txt" in asked[0][1]
    assert asked[1][0] == str(tmp_path)


# -- the error, live --------------------------------------------------------------------------------------


@pytest.mark.stress
def test_every_step_of_the_error_is_fitted_and_drawn_at_once(lift: User, imports: Import) -> None:
    dialog = imports(table())
    click(dialog.laws)
    click(dialog.dwells)
    enter(lift, dialog.error, "0.05")
    for error in ("0.08", "0.2", "0"):
        enter(lift, dialog.error, error)
        fit = dialog.reading.fit
        assert fit is not None
        assert fit.rms == pytest.approx(float(error), abs=1e-9)
        _, curve = dialog.rows_plot.lines[0]
        assert curve[:-1:8] == pytest.approx(fit.curve(ANGLES), abs=1e-9)
        lines = [rule.at for rule in dialog.residual_plot.rules]
        assert lines == pytest.approx([float(error), -float(error)] if float(error) else [], rel=1e-12)
        assert figure(dialog, "Rms residual") == f"{float(error):g} mm"
    before = dialog.error.value
    enter(lift, dialog.error, "0.1")
    dialog.error.setFocus()
    QTest.keyClick(dialog.error, Qt.Key.Key_Up)
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.error == dialog.error.value > 0.1 > before
    click(dialog.estimate)
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.is_guessed
    assert dialog.error.value == pytest.approx(0.05, rel=0.2)


@pytest.mark.stress
@pytest.mark.parametrize(
    ("text", "words"), [("99", "allowed: 0 ... 53."), ("-1", "allowed: ≥ 0, not \N{MINUS SIGN}1"), ("much", "")]
)
def test_an_error_that_cannot_be_is_told_and_the_last_curve_stays(
    text: str, words: str, lift: User, imports: Import
) -> None:
    dialog = imports(table())
    last = dialog.rows_plot.lines[0][1]
    enter(lift, dialog.error, text)
    assert dialog.error.is_refused
    assert words in dialog.message.text()
    assert dialog.rows_plot.lines[0][1] is last
    assert not dialog.put_button.isEnabled(), "what stands there is not what would be put"
    enter(lift, dialog.error, "0.1")
    assert not dialog.error.is_refused
    assert dialog.put_button.isEnabled()


@pytest.mark.stress
def test_the_lowest_position_moves_the_motion(lift: User, imports: Import) -> None:
    dialog = imports(table())
    assert abs(dialog.lowest.value) < 0.1
    enter(lift, dialog.lowest, "12.5")
    enter(lift, dialog.error, "0.06")
    click(dialog.put_button)
    y = lift.session.study.motion.y[0]
    assert y.min() == pytest.approx(0.0125, abs=1e-6)
    assert y.max() - y.min() == pytest.approx(0.15, abs=5e-4)


@pytest.mark.stress
def test_the_stroke_of_an_imported_motion_is_that_of_its_curve(lift: User, imports: Import) -> None:
    """One spline over the whole turn begins and ends at one level; its stroke lies between."""
    dialog = imports(table())
    click(dialog.put_button)
    lift.window.activateWindow()  # which a desktop does by itself
    assert QTest.qWaitForWindowActive(lift.window)
    y = lift.session.study.motion.y[0]
    box = lift.number("motion.stroke_mm")
    assert box.isEnabled()
    assert box.value == pytest.approx((y.max() - y.min()) * 1e3, rel=1e-6)
    lift.enter("motion.stroke_mm", "100")
    y = lift.session.study.motion.y[0]
    assert y.max() - y.min() == pytest.approx(0.1, rel=1e-6)
    assert box.value == 100.0
    assert lift.steps[-1] == "Change stroke to 100 mm"


# -- corrections ------------------------------------------------------------------------------------------


@pytest.mark.stress
def test_units_and_columns_can_be_corrected(lift: User, imports: Import) -> None:
    other = np.rad2deg(np.deg2rad(ANGLES))
    text = "a,b,c\n" + "".join(f"{a:g},{i},{v / 25.4:.5f}\n" for i, (a, v) in enumerate(zip(other, LIFT, strict=True)))
    dialog = imports(text)
    assert any("column 2 (b) is assumed to be the values" in cells[1].lower() for cells in found(dialog))
    pick(dialog.form.boxes["column"], "3  c")
    pick(dialog.form.boxes["value_unit"], "in")
    assert unit_of(dialog) == "in"
    fit = dialog.reading.fit
    assert fit is not None
    assert fit.stroke == pytest.approx(150.0, abs=0.5)
    pick(dialog.form.boxes["quantity"], "velocities")
    assert dialog.form.boxes["value_unit"].currentText() == "mm/s", "another quantity, another unit"
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.table.layout.quantity == "velocity"
    pick(dialog.form.boxes["value_unit"], "in/°")
    assert unit_of(dialog) == "in/°"
    assert any("does not determine the position of the follower" in cells[1] for cells in found(dialog))


@pytest.mark.stress
def test_another_delimiter_can_be_tried_and_taken_back(lift: User, imports: Import) -> None:
    dialog = imports(table())
    stroke = dialog.reading.fit.stroke if dialog.reading.fit else 0.0
    pick(dialog.form.boxes["delimiter"], "Semicolon")
    assert dialog.reading.fit is None
    assert not dialog.put_button.isEnabled()
    assert "No row contains two numbers" in dialog.message.text()
    pick(dialog.form.boxes["delimiter"], "Comma")
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.stroke == stroke


@pytest.mark.stress
def test_a_table_of_a_follower_that_swings_needs_a_unit(lift: User, imports: Import) -> None:
    dialog = imports(table("cam_angle_deg,arm_angle_deg"))
    assert "the follower slides: lengths are required" in dialog.message.text()
    pick(dialog.form.boxes["value_unit"], "cm")
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.stroke == pytest.approx(1500.0, abs=5.0)


# -- what is wrong ----------------------------------------------------------------------------------------


@pytest.mark.stress
def test_wrong_rows_are_listed_by_line_and_the_mended_file_is_read_again(
    lift: User, imports: Import, tmp_path: Path
) -> None:
    wrong = table().replace("\n20,", "\n2O,").replace("\n40,", "\n40;")
    dialog = imports(wrong)
    assert [cells[0] for cells in found(dialog)] == ["12", "22"]
    assert found(dialog)[0][1].startswith("'2O' in column 1 (cam_angle_deg): required: a number")
    assert dialog.message.text().startswith("2 rows are wrong")
    assert not dialog.put_button.isEnabled()
    assert dialog.rows_plot.lines == []
    click(dialog.leave)
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.residuals.size == ANGLES.size - 2
    assert dialog.put_button.isEnabled()
    assert not dialog.leave.isVisible()
    (tmp_path / "lift.csv").write_text(table(), "utf-8")
    click(dialog.again)
    assert dialog.reading.fit is not None
    assert dialog.put_button.isEnabled()
    (tmp_path / "lift.csv").unlink()
    click(dialog.again)
    assert [what for what, _ in lift.faults] == ["lift.csv cannot be read."]


def test_a_typing_error_is_listed_and_a_click_shows_where(lift: User, imports: Import) -> None:
    values = LIFT.copy()
    values[30] += 4.0
    dialog = imports(table(values=values))
    line, told = found(dialog)[0]
    assert line == "32"
    assert told.startswith("60°: ")
    assert told.endswith("mm from the curve, left out")
    assert dialog.rows_plot.dots[1].x == pytest.approx([60.0])
    assert dialog.rows_plot.cursor_at is None
    at = dialog.entries.visualRect(dialog.entries.rows.index(0, 1)).center()
    QTest.mouseClick(dialog.entries.viewport(), Qt.MouseButton.LeftButton, pos=at)
    for plot in (dialog.rows_plot, dialog.residual_plot):
        assert plot.cursor_at == 60.0
    click(dialog.keep_all)
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.left_out == ()
    assert abs(dialog.reading.fit.residuals[30]) < 1.0, "the curve bends to it"


def test_a_wrong_run_is_listed_row_by_row_and_left_out(lift: User, imports: Import) -> None:
    values = LIFT.copy()
    values[30:34] = 0.0
    dialog = imports(table(values=values))
    assert sorted(cells[0] for cells in found(dialog)[:4]) == ["32", "33", "34", "35"]
    assert any("Lines 32-35: wrong, " in cells[1] for cells in found(dialog))
    assert dialog.rows_plot.dots[1].x == pytest.approx([60.0, 62.0, 64.0, 66.0])
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.stroke == pytest.approx(150.0, abs=0.2)


@pytest.mark.stress
def test_rows_that_contradict_each_other_are_shown_but_not_put(lift: User, imports: Import) -> None:
    """A third of the table stands 4 mm high: either side may be the wrong one."""
    before = lift.design
    values = LIFT + np.where((ANGLES > 100.0) & (ANGLES < 220.0), 4.0, 0.0)
    dialog = imports(table(values=values))
    enter(lift, dialog.error, "0.05")
    assert "they contradict each other, and it cannot be decided which of them are wrong" in dialog.message.text()
    assert not dialog.put_button.isEnabled()
    assert not dialog.error.is_refused
    marked = dialog.rows_plot.dots[1].x
    assert any(abs(marked - 101.0) < 4.0)
    assert any(abs(marked - 219.0) < 4.0)
    assert dialog.reading.fit is not None
    dialog.accept()
    assert lift.design is before
    click(dialog.keep_all)
    assert dialog.put_button.isEnabled()
    click(dialog.put_button)
    assert lift.steps == ["Import lift.csv"]


@pytest.mark.stress
def test_a_motion_that_the_mechanism_cannot_follow_is_refused_and_the_dialog_stays(lift: User, imports: Import) -> None:
    before = lift.design
    dialog = imports(table(values=1500.0 - 1500.0 * np.cos(np.deg2rad(ANGLES))))
    click(dialog.put_button)
    assert dialog.isVisible()
    assert lift.design is before
    assert "cam angle" in dialog.message.text()
    click(dialog.buttons.button(dialog.buttons.StandardButton.Cancel))
    assert lift.steps == []


@pytest.mark.stress
def test_a_column_that_scatters_more_than_it_moves_is_told_in_a_line(
    open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a swinging follower, and of its force sensor besides, which fails now and then."""
    angles = np.arange(0.0, 360.0, 3.0)
    force = np.where(np.random.default_rng(4).random(angles.size) > 0.9, 99.0, np.sin(np.deg2rad(angles)))
    rows = zip(angles, 10.0 - 10.0 * np.cos(np.deg2rad(angles)), force, strict=True)
    path = tmp_path / "arm.csv"
    path.write_text("angle_deg,arm_deg,force\n" + "".join(f"{a:g},{arm:.4f},{f:.4f}\n" for a, arm, f in rows), "utf-8")
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: path)
    user = open_user(example("rocker_cam"))
    user.choose("File", "Import measured motion...")
    dialog = user.window.findChild(MeasuredDialog)
    assert isinstance(dialog, MeasuredDialog)
    rested(dialog.put_button)
    assert dialog.put_button.isEnabled()
    pick(dialog.form.boxes["column"], "3  force")
    pick(dialog.form.boxes["value_unit"], "°")
    assert "they contradict each other, and it cannot be decided which of them are wrong" in dialog.message.text()
    assert not dialog.put_button.isEnabled()
    pick(dialog.form.boxes["column"], "2  arm_deg")
    assert dialog.put_button.isEnabled()


@pytest.mark.stress
def test_what_takes_long_is_computed_beside_the_window_and_given_up_by_cancel(
    lift: User, imports: Import, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[str] = []
    ended: list[str] = []

    def endless(*_: object) -> MotionFit:
        begun.append("")
        try:
            while True:
                checkpoint()
                sleep(0.001)
        finally:
            ended.append("")

    dialog = imports(table())
    fit, curve = dialog.reading.fit, dialog.rows_plot.lines[0][1]
    with monkeypatch.context() as patch:
        patch.setattr(form, "fit", endless)
        QTest.mouseClick(dialog.keep_all, Qt.MouseButton.LeftButton)
        wait_for(lambda: dialog.message.text() == COMPUTING)
        assert dialog.rows_plot.lines[0][1] is curve, "the last curve stays"
        assert not dialog.put_button.isEnabled()
        dialog.accept()
        assert lift.steps == [], "it is not put in place of what is asked for"
        pick_at_once(dialog.form.boxes["quantity"])
        wait_for(lambda: len(begun) == 2 and len(ended) == 1)
    QTest.keyClick(dialog.form.boxes["quantity"], Qt.Key.Key_Home)
    rested(dialog)
    assert len(ended) == 2
    assert dialog.reading.fit is not fit
    assert dialog.put_button.isEnabled()
    monkeypatch.setattr(form, "fit", endless)
    QTest.mouseClick(dialog.keep_all, Qt.MouseButton.LeftButton)
    wait_for(lambda: len(begun) == 3)
    click(dialog.buttons.button(dialog.buttons.StandardButton.Cancel))
    wait_for(lambda: len(ended) == 3)
    assert lift.steps == []


# -- what the tables of an engine and of a design become --------------------------------------------------


@pytest.mark.stress
def test_a_grinders_lift_table_becomes_a_cam_whose_dwell_stands_still(
    open_user: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A row a degree in 1e-4 in, as no header says: unit and step are guessed, and confirmed by a click."""
    wanted = levels(0.0, (110.0, 0.0, "dwell"), (66.25, 9.4, "4-5-6-7"), (73.75, 0.0, "4-5-6-7"), (110.0, 0.0, "dwell"))
    angles = np.arange(0.0, 360.0)
    lifts = np.round(position(wanted, angles) / 25.4e-4)
    path = tmp_path / "lobe.txt"
    rows = "".join(f"{a:.0f}   {y:.0f}\n" for a, y in zip(angles, lifts, strict=True))
    path.write_text(f"INTAKE LOBE 3, GRIND 276\nBase circle 34.0, checked 12/03\n\n{rows}", "utf-8")
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: path)
    user = open_user(example("tappet_flat"))
    user.choose("File", "Import measured motion...")
    dialog = user.window.findChild(MeasuredDialog)
    assert isinstance(dialog, MeasuredDialog)
    wait_for(lambda: dialog.isVisible() and not dialog.busy)
    box = dialog.form.boxes["value_unit"]
    assert box.currentData() == "1e-4in"
    assert box.is_waiting
    assert "angles from 0 to 359 are assumed to be in deg, a row every 1" in dialog.message.text()
    assert "as mm it is 3701 mm" in dialog.message.text()
    QTest.mouseClick(dialog.laws, Qt.MouseButton.LeftButton)
    pop_up(box, "10⁻⁴ in")
    assert box.currentText() == "10⁻⁴ in"
    assert not box.is_waiting
    assert "as mm it is" not in dialog.message.text()
    assert set(segments(dialog)) == {"Table", "Dwell"}
    click(dialog.put_button)
    study = user.session.study
    at = np.deg2rad(np.concatenate((np.arange(0.0, 106.0, 0.5), np.arange(255.0, 360.0, 0.5))))
    compiled = study.program
    y = compiled.state(compiled.angles(at)).y
    assert np.ptp(y[0]) == 0.0
    assert not y[1:3].any(), "it does not move"
    jerk = compiled.state(compiled.angles(np.deg2rad(np.arange(120.0, 240.0, 0.25)))).y[3]
    assert np.count_nonzero(np.diff(np.sign(jerk))) <= 7, "no ripple"
    assert np.isfinite(study.shape.flanks[0].profile).all()


@pytest.mark.stress
def test_the_lifts_own_kinematics_come_back_as_five_segments(
    lift: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["export", str(example("transfer_lift")), "--out", str(tmp_path), "--samples", "360"]) == 0
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: tmp_path / "kinematics.csv")
    lift.choose("File", "Import measured motion...")
    dialog = lift.window.findChild(MeasuredDialog)
    assert isinstance(dialog, MeasuredDialog)
    wait_for(lambda: dialog.isVisible() and not dialog.busy)
    assert segments(dialog) == ["Modified sine", "Dwell"] * 2
    click(dialog.put_button)
    made = lift.design.drive.motion.segments
    assert [each.curve.law for each in made] == ["dwell", "modified-sine", "dwell", "modified-sine", "dwell"]
    assert [each.span_deg for each in made] == pytest.approx([35.0, 41.5, 207.0, 41.5, 35.0], abs=1e-6)
    assert [each.rise for each in made] == pytest.approx([0.0, -150.0, 0.0, 150.0, 0.0], abs=1e-9)


# -- the sheet --------------------------------------------------------------------------------------------


def check_of(dialog: MeasuredDialog, line: int) -> QPoint:
    """Where the check of a line stands in the sheet, which is brought into sight."""
    row = dialog.sheet.cells.row_of(line)
    assert row is not None
    index = dialog.sheet.cells.index(row, 0)
    dialog.sheet.scrollTo(index)
    option = QStyleOptionViewItem()
    dialog.sheet.initViewItemOption(option)
    option.rect = dialog.sheet.visualRect(index)
    option.features |= QStyleOptionViewItem.ViewItemFeature.HasCheckIndicator
    return dialog.sheet.style().subElementRect(QStyle.SubElement.SE_ItemViewItemCheckIndicator, option).center()


@pytest.mark.stress
def test_a_row_is_marked_in_the_sheet_and_left_out_at_a_click(lift: User, imports: Import) -> None:
    values = LIFT.copy()
    values[30] += 4.0
    dialog = imports(table(values=values))
    cells = dialog.sheet.cells
    row = cells.row_of(32)
    assert row is not None
    cell = cells.index(row, 2)
    assert cell.data() == f"{values[30]:.3f}"
    expected = 75.0 - 75.0 * np.cos(np.deg2rad(60.0))
    told = cell.data(Qt.ItemDataRole.ToolTipRole)
    assert float(told.partition(": ")[2].split()[0]) == pytest.approx(expected, abs=0.1)
    assert told.endswith("mm expected, left out")
    assert (
        cell.data(Qt.ItemDataRole.BackgroundRole).hue()
        != cells.index(row, 1).data(Qt.ItemDataRole.BackgroundRole).hue()
    )
    assert cells.index(row + 1, 2).data(Qt.ItemDataRole.ToolTipRole) is None
    QTest.mouseClick(dialog.sheet.viewport(), Qt.MouseButton.LeftButton, pos=check_of(dialog, 32))
    rested(dialog)
    fit = dialog.reading.fit
    assert fit is not None
    assert (fit.residuals.size, fit.left_out) == (ANGLES.size - 1, ())
    assert not any("from the curve" in cells[1] for cells in found(dialog)), "the wrong row is gone"
    place = dialog.sheet.visualRect(cells.index(row + 4, 1)).center()
    QTest.mouseClick(dialog.sheet.viewport(), Qt.MouseButton.LeftButton, pos=place)
    assert dialog.rows_plot.cursor_at == pytest.approx(68.0)
    lift.press(Qt.Key.Key_Down)
    assert dialog.rows_plot.cursor_at == pytest.approx(70.0)
    lift.press(Qt.Key.Key_Up, modifier=Qt.KeyboardModifier.ShiftModifier)
    lift.press(Qt.Key.Key_Space)
    rested(dialog)
    assert dialog.reading.table is not None
    assert {36, 37, 32}.isdisjoint(dialog.reading.table.lines.tolist())
    QTest.mouseClick(dialog.sheet.viewport(), Qt.MouseButton.LeftButton, pos=check_of(dialog, 32))
    rested(dialog)
    assert found(dialog)[0][0] == "32", "it is taken back"


@pytest.mark.stress
def test_of_columns_that_contradict_each_other_one_is_chosen(lift: User, imports: Import) -> None:
    """A gauge of lift that reads twice too much beside a right velocity: said with its rows, marked in the sheet."""
    rise = 0.5 * (1.0 - np.cos(np.deg2rad(ANGLES)))
    slope = 75.0 * np.sin(np.deg2rad(ANGLES)) * np.deg2rad(1.0)
    text = "angle [deg],lift [mm],velocity [mm/deg]\n"
    text += "".join(f"{a:g},{300.0 * y:.5f},{v:.7f}\n" for a, y, v in zip(ANGLES, rise, slope, strict=True))
    dialog = imports(text)
    box = dialog.form.boxes["trust"]
    assert box.isVisible()
    assert box.is_waiting
    assert "contradicts column 2 (lift [mm])" in found(dialog)[0][1]
    row = dialog.sheet.cells.row_of(47)
    assert row is not None
    cell = dialog.sheet.cells.index(row, 3)
    assert cell.data(Qt.ItemDataRole.ToolTipRole) == "Contradicts column 2 (lift [mm])"
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.stroke == pytest.approx(300.0, abs=0.1)
    pop_up(box, "Velocity")
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.stroke == pytest.approx(150.0, abs=0.1)
    assert box.isVisible()
    assert not box.is_waiting
    click(copy_button(dialog))
    assert "--trust v" in QApplication.clipboard().text()
    pop_up(box, "Displacement")
    assert dialog.reading.fit.stroke == pytest.approx(300.0, abs=0.1)


def test_each_column_has_its_error_its_band_and_its_residuals(lift: User, imports: Import) -> None:
    slope = 75.0 * np.sin(np.deg2rad(ANGLES)) * np.deg2rad(1.0) + 0.004 * CHANCE.normal(size=ANGLES.size)
    text = "angle [deg],lift [mm],velocity [mm/deg]\n"
    text += "".join(f"{a:g},{y:.4f},{v:.5f}\n" for a, y, v in zip(ANGLES, LIFT, slope, strict=True))
    dialog = imports(text)
    assert [dialog.errors[each].isVisible() for each in ("displacement", "velocity", "acceleration")] == [
        True,
        True,
        False,
    ]
    enter(lift, dialog.error, "0.06")
    enter(lift, dialog.errors["velocity"], "0.005")
    fit = dialog.reading.fit
    assert fit is not None
    assert [(each.error, each.is_guessed) for each in fit.columns] == [(0.06, False), (0.005, False)]
    for plot, error in ((dialog.rows_plot, 0.06), (dialog.derivative_plots[0], 0.005)):
        (line,) = plot.shown
        assert line.band is not None
        assert line.band[1] - line.y == pytest.approx(
            error * np.array([-3.0, -1.0, 0.0, 1.0, 3.0])[:, None] * np.ones(line.y.size)
        )
    assert dialog.derivative_plots[1].shown[0].band is None, "of an acceleration that was not measured"
    pick(dialog.residual_of, "Velocity")
    assert dialog.residual_plot.dots[0].y == pytest.approx(fit.columns[1].residuals, rel=1e-9)
    assert [rule.at for rule in dialog.residual_plot.rules] == pytest.approx([0.005, -0.005])


def test_a_sheet_and_cells_of_a_workbook_are_chosen(
    lift: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("python_calamine")
    path = tmp_path / "lift.xlsx"
    rows: list[list[object]] = [
        ["Angle [deg]", "Lift [mm]"],
        *([float(a), float(y)] for a, y in zip(ANGLES, LIFT, strict=True)),
    ]
    workbook(path, {"Notes": [["by Kim"]], "Lift": [*rows, ["end", "of table"]]})
    monkeypatch.setattr(dialogs, "file_to_open", lambda *_: path)
    lift.choose("File", "Import measured motion...")
    dialog = lift.window.findChild(MeasuredDialog)
    assert isinstance(dialog, MeasuredDialog)
    wait_for(lambda: dialog.isVisible() and not dialog.busy)
    assert not dialog.put_button.isEnabled(), "notes are no table"
    dialog.pages.setFocus()
    lift.press(Qt.Key.Key_Down)
    rested(dialog)
    assert "'end' in column 1" in found(dialog)[0][1]
    enter(lift, dialog.cells, "A1:B")
    assert "required: two corners, as A1:C400" in found(dialog)[0][1]
    enter(lift, dialog.cells, "A1:B181")
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.residuals.size == ANGLES.size
    assert dialog.put_button.isEnabled()
    click(copy_button(dialog))
    assert "--sheet Lift --range A1:B181" in QApplication.clipboard().text()


def copy_button(dialog: MeasuredDialog) -> QPushButton:
    return next(each for each in dialog.findChildren(QPushButton) if each.text() == "Copy as command")


@pytest.mark.stress
def test_copy_as_command_gives_the_command_that_does_the_same(lift: User, imports: Import, tmp_path: Path) -> None:
    dialog = imports(table().replace("\n20,", "\n2O,"))
    click(dialog.leave)
    enter(lift, dialog.error, "0.07")
    enter(lift, dialog.lowest, "12.5")
    click(dialog.laws)
    pick(dialog.form.boxes["value_unit"], "cm")
    enter(lift, dialog.error, "0.08")
    pick(dialog.form.boxes["value_unit"], "mm")
    QTest.mouseClick(dialog.sheet.viewport(), Qt.MouseButton.LeftButton, pos=check_of(dialog, 12))
    rested(dialog)
    enter(lift, dialog.error, "0.08")
    lift.session.save(tmp_path / "d.toml")
    click(copy_button(dialog))
    words = shlex.split(QApplication.clipboard().text())
    assert words[:3] == ["kindyna", "--headless", "measured"]
    assert main(words[2:]) == 0
    assert dialog.reading.fit is not None
    assert load(tmp_path / "d.toml").drive.motion == dialog.reading.fit.motion


@pytest.mark.stress
def test_all_of_the_dialog_is_reached_by_keys(lift: User, imports: Import) -> None:
    """Tab goes from the reading over the fit, the sheet and the segments to Take, in the order that the eye does."""
    dialog = imports(table(values=rise_and_return()))
    dialog.again.setFocus()
    met: list[QWidget | None] = []
    while dialog.put_button not in met and len(met) < 40:
        QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Tab)
        met.append(QApplication.focusWidget())
    boxes = dialog.form.boxes
    way = [
        *(boxes[name] for name in ("delimiter", "decimal", "angle_column", "angle_unit", "column", "value_unit", "quantity")),
        dialog.estimate, dialog.error, dialog.lowest, dialog.laws, dialog.dwells, dialog.keep_all, dialog.mirror, dialog.sheet,
        dialog.segments, *dialog.segments.boxes, dialog.entries, dialog.put_button,
    ]  # fmt: skip
    places = [met.index(widget) for widget in way]
    assert places == sorted(places), [type(widget).__name__ for widget in met]
    dialog.segments.boxes[1].setFocus()
    lift.press(Qt.Key.Key_Down)
    rested(dialog)
    assert segments(dialog)[1] == "Table"
    assert dialog.segments.boxes[1].hasFocus(), "it keeps the keys"
    dialog.put_button.setFocus()
    lift.press(Qt.Key.Key_Space)
    assert lift.steps == ["Import lift.csv"]


def test_half_a_lobe_is_refused_until_it_is_mirrored(lift: User, imports: Import, tmp_path: Path) -> None:
    motion = levels(0.0, (40.0, 0.0, "dwell"), (140.0, 25.0, "modified-sine"), (180.0, 0.0, "cycloidal"))
    rows = np.arange(0.0, 181.0)
    text = "".join(f"{a:g},{s:.5f}\n" for a, s in zip(rows, position(motion, rows), strict=True))
    dialog = imports("cam angle [deg],lift [mm]\n" + text)
    assert not dialog.put_button.isEnabled()
    assert "--mirror" in dialog.message.text()
    click(dialog.mirror)
    assert dialog.put_button.isEnabled()
    lift.session.save(tmp_path / "d.toml")
    click(copy_button(dialog))
    click(dialog.put_button)
    made = lift.design.drive.motion
    assert made is not None
    assert [s.curve.law for s in made.segments] == ["dwell", "modified-sine", "modified-sine", "dwell"]
    assert main(shlex.split(QApplication.clipboard().text())[2:]) == 0
    assert load(tmp_path / "d.toml").drive.motion == made


# -- looks ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("unit", "sign"),
    [
        ("mm", "mm"),
        ("um", "µm"),
        ("deg", "°"),
        ("mm/s2", "mm/s²"),
        ("mm/deg2", "mm/°²"),
        ("rad/s", "rad/s"),
        ("in/deg", "in/°"),
        ("g", "g"),
        ("1e-4in", "10⁻⁴ in"),
    ],
)
def test_units_are_written_as_printers_do(unit: str, sign: str) -> None:
    assert symbol(unit) == sign


def test_sentences_of_the_core_are_written_so_too() -> None:
    told = "line 3 (120 deg): 1 mm/deg2, 2 um/s off; smoothing 3 deg^5; from deg to deg"
    assert with_symbols(told) == "line 3 (120°): 1 mm/°², 2 µm/s off; smoothing 3 °⁵; from deg to deg"


def test_nothing_is_cut_off_at_the_smallest_size(lift: User, imports: Import) -> None:
    dialog = imports(table())
    dialog.resize(dialog.minimumSize())
    settle()
    for widget in (
        dialog.again,
        dialog.estimate,
        dialog.keep_all,
        dialog.mirror,
        dialog.put_button,
        dialog.error,
        *dialog.units.values(),
    ):
        assert widget.width() >= widget.minimumSizeHint().width(), widget
        assert dialog.rect().contains(
            widget.geometry().translated(widget.parentWidget().mapTo(dialog, widget.rect().topLeft()))
        )
    assert dialog.rows_plot.height() > 120
    assert dialog.residual_plot.height() > 80
    assert math.isclose(dialog.rows_plot.getViewBox().width(), dialog.residual_plot.getViewBox().width()), (
        "one cam angle above the other"
    )
    assert QApplication.focusWidget() is not None


@pytest.mark.stress
def test_of_two_readings_of_the_rows_one_is_chosen(imports: Import) -> None:
    """Twenty rows lie half a millimetre high, or all others low: the table does not say which, the user does."""
    values = 4.5 * (1.0 - np.cos(np.deg2rad(ANGLES))) + 0.003 * np.random.default_rng(4).normal(size=ANGLES.size)
    values[120:140] += 0.5
    dialog = imports(
        "angle [deg],lift [mm]\n" + "".join(f"{a:g},{v:.5f}\n" for a, v in zip(ANGLES, values, strict=True))
    )
    box = dialog.alternatives
    assert box.isVisible()
    assert box.is_waiting
    assert not dialog.put_button.isEnabled()
    assert [box.itemText(i) for i in range(1, box.count())] == [
        "lines 122-141 (20 rows)", "lines 2-121, 142-181 (160 rows)",
    ]  # fmt: skip
    pop_up(box, "lines 122-141 (20 rows)")
    assert dialog.put_button.isEnabled()
    assert not box.isVisible()
    assert dialog.reading.fit is not None
    assert dialog.reading.fit.stroke == pytest.approx(9.0, abs=0.02)
    click(copy_button(dialog))
    assert "--leave-out 122,123," in QApplication.clipboard().text()
