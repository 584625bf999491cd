"""Edit > Preferences: units and decimal sign on display, theme, letters, what reports say; files and values stay as they are."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QHelpEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QApplication,
    QComboBox,
    QDialogButtonBox,
    QLabel,
    QLineEdit,
    QPushButton,
    QToolTip,
    QWidget,
)
from sampled import stressed
from window_user import Open, User, answering, settle, wait_for

from core.project import dumps
from kindyna_gui import settings
from kindyna_gui.blend.wizard import BlendDialog
from kindyna_gui.cam_dialogs.profile_dialogs import DrawingDialog
from kindyna_gui.export import tables_of
from kindyna_gui.export_dialogs import HandoverDialog, ReportDialog
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import value_text
from kindyna_gui.linkage.centres_view import CentresView
from kindyna_gui.look import apply_preferences
from kindyna_gui.pictures.units import measure, readable
from kindyna_gui.places import example
from kindyna_gui.window.main_window import open_window
from kindyna_gui.window.preferences_dialog import PreferencesDialog

ROOT = Path(__file__).parents[3]


@pytest.fixture(autouse=True)
def usual_again(app: QApplication) -> Iterator[None]:
    yield
    apply_preferences(settings.Preferences(), app)
    settle()


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window()


def prefer(user: User, act: object) -> None:
    """Edit > Preferences, something in the dialog, OK."""

    def answer(dialog: PreferencesDialog) -> None:
        act(dialog)
        QTest.mouseClick(dialog.buttons.button(QDialogButtonBox.StandardButton.Ok), Qt.MouseButton.LeftButton)

    with answering(PreferencesDialog, answer):
        user.choose("Edit", "Preferences...")
    user.window.activateWindow()
    assert QTest.qWaitForWindowActive(user.window)
    settle()


def in_inches(dialog: PreferencesDialog) -> None:
    button = next(each for each in dialog.findChildren(QPushButton) if each.text() == "All in inches")
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)


def tip_of(editor: QWidget) -> str:
    """The tip at the mouse over an editor; "" where there is none but that of the editor."""
    QToolTip.hideText()
    QApplication.sendEvent(editor, QHelpEvent(QEvent.Type.ToolTip, QPoint(5, 5), editor.mapToGlobal(QPoint(5, 5))))
    text: str = QToolTip.text()
    QToolTip.hideText()
    return text


def test_a_field_shows_and_takes_the_unit_that_is_preferred(user: User) -> None:
    field = user.field("cam.base_radius_mm")
    assert (field.editor.text(), field.unit.text()) == ("400", "mm")
    prefer(user, in_inches)
    field = user.field("cam.base_radius_mm")
    assert (field.editor.text(), field.unit.text()) == ("15.748", "in")
    assert tip_of(field.editor).startswith("400 mm<br>"), "all digits are in the tip"
    user.press(Qt.Key.Key_Return)
    assert user.steps == [], "a number that was converted is not typed"
    user.enter("cam.base_radius_mm", "15.748031")
    assert field.editor.text() == "15.748031", "as typed"
    assert not tip_of(field.editor).startswith("400")
    user.press(Qt.Key.Key_Z, modifier=Qt.KeyboardModifier.ControlModifier)
    user.enter("cam.base_radius_mm", "16.5")
    assert user.design.drive.cam.base_radius_mm == 419.1
    assert user.steps == ["Change base radius Br to 16.5 in"]
    user.enter("cam.base_radius_mm", "420 mm")
    assert user.design.drive.cam.base_radius_mm == 420.0
    user.press(Qt.Key.Key_Up)  # a round step of what is shown
    assert user.design.drive.cam.base_radius_mm == pytest.approx(420.0 + 0.2 * 25.4, abs=1e-6)


def test_the_table_of_segments_follows(user: User) -> None:
    motion = user.motion()
    assert user.cell(1, 4) == "-150"
    prefer(user, in_inches)
    assert user.cell(1, 4) == "-5.9055"
    assert motion.model.headerData(4, Qt.Orientation.Horizontal) == "Rise in"
    user.enter_cell(1, 4, "-6")
    assert user.design.drive.motion.segments[1].rise == -152.4


def test_centres_and_values_typed_while_drawing_are_in_the_preferred_unit(open_user: Open) -> None:
    user = open_user(example("four_bar"))
    view = user.see("centres")
    assert isinstance(view, CentresView)
    settings.choose(settings.INCH, False)
    settle()
    wait_for(lambda: view.distance.text() == "3.937 in")
    user.choose("Compo", "Draw")
    drawing = user.drawing().drawing
    settle()
    drawing.typed.ask_length(4, "B", "O4")
    (box,) = (edit for edit in drawing.typed.boxes.findChildren(QLineEdit) if edit.isVisible())
    labels = [label.text() for label in drawing.typed.boxes.findChildren(QLabel) if label.isVisible()]
    assert (box.text(), labels) == ("2.75591", ["B-O4", "in"])
    box.setText("3")
    QTest.keyClick(box, Qt.Key.Key_Return)
    places = user.design.drive.linkage.by_number[4].places
    assert abs(places["B"] - places["O4"]) == pytest.approx(76.2)


@pytest.mark.parametrize("switches", [50, stressed(1000)])
def test_a_value_survives_many_switches_and_files_do_not_see_them(user: User, switches: int) -> None:
    before = dumps(user.session.full_design)
    design = user.design
    tables = dict(tables_of(design, 36))
    boxes = [field.editor for form in user.parameters().forms.values() for field in form.fields.values()]
    numbers = [box for box in boxes if isinstance(box, NumberBox)]
    assert len(numbers) > 40
    shown = [box.text() for box in numbers]
    user.window.hide()  # what is drawn of them need not follow each time
    for i in range(switches):
        settings.choose(
            {**settings.INCH, "angle": "rad", "angular velocity": "rad/s"} if i % 2 == 0 else {}, i % 2 == 0
        )
    assert [box.text() for box in numbers] == shown
    user.window.show()
    settings.choose(settings.INCH, True)
    assert [box.text() for box in numbers] != shown
    user.press(Qt.Key.Key_Tab) if QApplication.focusWidget() else None
    assert user.steps == []
    assert dumps(user.session.full_design) == before
    again = dict(tables_of(design, 36))
    assert again.keys() == tables.keys()
    assert [name for name in tables if isinstance(tables[name], str) and tables[name] != again[name]] == []


def test_plots_and_texts_follow_and_files_are_written_as_kept(user: User, tmp_path: Path) -> None:
    view = user.see("displacement")
    assert view.plot.display_unit.symbol == "mm"
    prefer(user, in_inches)
    wait_for(lambda: view.plot.display_unit.symbol == "in")
    force = readable("N", 20_000.0)
    assert measure(20_000.0 / force.size, force.symbol) == "4496 lbf"
    with settings.in_file_units():
        assert readable("N", 20_000.0).symbol == "kN"
    user.picks("picture_to_save", tmp_path / "curve.svg")
    user.choose("Graph", "Export picture", "Displacement...")
    text = (tmp_path / "curve.svg").read_text("utf-8")
    assert "Displacement, mm" in text
    assert "Displacement, in" not in text


def test_a_decimal_comma_is_shown_and_taken(user: User) -> None:
    prefer(user, lambda dialog: dialog.comma.setChecked(True))
    assert user.number("follower.fixed_angle_deg").text() == "43,637"
    user.enter("follower.fixed_angle_deg", "43,5")
    assert user.design.drive.mechanism.fixed_angle_deg == 43.5
    user.enter("follower.fixed_angle_deg", "43.25")
    assert user.design.drive.mechanism.fixed_angle_deg == 43.25
    assert value_text(0.5, units_mm()) == "0,5 mm"


def units_mm() -> object:
    from core.units import UNITS

    return UNITS["mm"]


def test_preferences_are_kept_and_reset(user: User) -> None:
    def fill(dialog: PreferencesDialog) -> None:
        dialog.show_units({"force": "lbf"})
        dialog.font_size.setCurrentIndex(dialog.font_size.findData(125))
        dialog.paper.setCurrentIndex(1)
        dialog.author.setText("A. Designer")
        dialog.company.setText("Cams & Sons")

    letters = QApplication.font().pixelSize()
    prefer(user, fill)
    found = settings.read()
    assert (dict(found.units), found.font, found.paper, found.author) == (
        {"force": "lbf"},
        125,
        "Letter",
        "A. Designer",
    )
    assert QApplication.font().pixelSize() == round(1.25 * letters)
    report = ReportDialog(user.window)
    assert (report.paper.currentText(), report.lines["author"].text()) == ("Letter", "A. Designer")
    report.deleteLater()
    handover = HandoverDialog(user.window)
    wanted = handover.request
    assert (wanted.author, wanted.company, wanted.paper) == ("A. Designer", "Cams & Sons", "Letter")
    handover.deleteLater()
    drawing = DrawingDialog(user.window, user.design)
    assert {"A. Designer", "Cams & Sons"} <= set(drawing.command_options()[1])
    drawing.reject()
    drawing.deleteLater()

    def reset(dialog: PreferencesDialog) -> None:
        assert dialog.preferences == found
        QTest.mouseClick(dialog.buttons.button(QDialogButtonBox.StandardButton.Reset), Qt.MouseButton.LeftButton)

    prefer(user, reset)
    assert settings.read() == settings.Preferences()
    assert QApplication.font().pixelSize() == letters


def test_broken_settings_and_a_logo_that_is_no_picture_stop_nothing(
    app: QApplication, user: User, tmp_path: Path
) -> None:
    store = settings.settings_file()
    for key, value in {
        "units/length": "furlong",
        "look/theme": "purple",
        "look/font": "huge",
        "report/paper": 7,
    }.items():
        store.setValue(key, value)
    store.sync()
    assert settings.read() == settings.Preferences()
    window = open_window(app)
    window.show()
    wait_for(lambda: "not understood" in window.status.currentMessage())
    said = window.status.currentMessage()
    assert all(
        each in said
        for each in ("units/length furlong (using mm)", "look/theme purple (using light)", "look/font huge")
    )
    window.close()
    window.deleteLater()
    (tmp_path / "logo.png").write_text("no picture", "utf-8")

    def name_logo(dialog: PreferencesDialog) -> None:
        dialog.logo.setText(str(tmp_path / "logo.png"))
        assert "cannot be read as an image" in dialog.message.text()
        assert dialog.logo.is_refused
        QTest.mouseClick(dialog.message.buttons["Leave it empty"], Qt.MouseButton.LeftButton)
        assert (dialog.logo.text(), dialog.logo.is_refused, dialog.message.isVisible()) == ("", False, False)
        dialog.logo.setText(str(tmp_path / "logo.png"))

    prefer(user, name_logo)


METRIC = re.compile(
    r"(?<![\w.])(mm|N|kg·m²|N·m/rad|N·m·s/rad|N·s/mm|N·m|kN·m|kN|MPa|kg|m/s|m/s²|mm/s|mm/°|mm/°²|N/mm|1/mm|1/m)(?![\w·/²³])"
)


def texts_of(widget: QWidget) -> Iterator[str]:
    """Every text in sight: of labels, buttons, lists, headings and cells."""
    for each in (widget, *widget.findChildren(QWidget)):
        if not each.isVisible():
            continue
        if isinstance(each, QLabel | QAbstractButton):
            yield each.text()
        elif isinstance(each, QComboBox):
            yield each.currentText()
        elif isinstance(each, QAbstractItemView) and each.model() is not None:
            model = each.model()
            for column in range(model.columnCount()):
                yield str(model.headerData(column, Qt.Orientation.Horizontal) or "")
                yield from (str(model.index(row, column).data() or "") for row in range(model.rowCount()))


@pytest.mark.stress
@pytest.mark.parametrize(
    ("name", "views"),
    [
        ("transfer_lift", ("find", "findings", "certificate", "flywheel", "motion", "laws", "parameters")),
        stressed("transfer_unit", ("timing", "drives", "shaft_figures", "findings", "find", "centres")),
    ],
)
def test_no_metric_unit_is_left_in_a_window_in_inches(same_window: Open, name: str, views: tuple[str, ...]) -> None:
    user = same_window(example(name))
    prefer(user, in_inches)
    left = {}
    for each in views:
        view = user.see(each)
        settle()
        if each == "find":
            wait_for(lambda view=view: view.solution is not None)
        left[each] = [text for text in texts_of(view) if METRIC.search(re.sub("<[^>]*>", "", text))]
    if name == "transfer_lift":
        user.window.designing.blend()
        dialog = user.window.findChild(BlendDialog)
        wait_for(lambda: not dialog.is_solving and dialog.panel.table.rows.rows)
        left["wizard"] = [text for text in texts_of(dialog) if METRIC.search(text)]
        assert any("in/°²" in text for text in texts_of(dialog))
        dialog.reject()
    left["status"] = [text for text in texts_of(user.window.statusBar()) if METRIC.search(text)]
    assert {each: texts for each, texts in left.items() if texts} == {}
