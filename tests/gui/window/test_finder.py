"""Edit > Find anything, F1, buttons of empty views, Copy as command, Ctrl+C: what is wanted is reached without knowing its menu."""

import re
import shlex
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QDialog,
    QDialogButtonBox,
    QLabel,
    QMenu,
    QPushButton,
    QTableView,
)
from sampled import spread, stressed
from shiboken6 import delete
from window_user import Open, User, plain, settle, wait_for

from core.__main__ import parser
from core.commands import COMMANDS
from core.output.report.document import Cover
from core.study import names_of, quantity
from kindyna_gui.cam_dialogs.profile_dialogs import ControllerDialog, ProfileDialog
from kindyna_gui.export_dialogs import ReportDialog, TablesDialog
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.request_form import ScaleDialog
from kindyna_gui.help import PAGES, HelpWindow
from kindyna_gui.inspection import InspectionDialog
from kindyna_gui.places import example
from kindyna_gui.requirements import SUGGESTIONS
from kindyna_gui.view import ReasonPage
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.finder import Finder

MENU_WAY = re.compile(r"\b(File|Edit|Make|Compo|Kine|Dyna|Stability|Graph|View|Help) > ")
CTRL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window()


def find(user: User, text: str) -> Finder:
    """Ctrl+K and a text, typed."""
    QTest.keyClick(user.window, Qt.Key.Key_K, CTRL)
    finder = user.window.findChild(Finder)
    assert finder is not None
    assert finder.isVisible()
    assert finder.line.hasFocus()
    finder.line.insert(text)  # QTest types no Greek
    return finder


@pytest.mark.parametrize(
    ("typed", "path", "value"),
    [
        stressed("base radius 420", "cam.base_radius_mm", 420.0),
        ("base rad 16.5 in", "cam.base_radius_mm", 419.1),
        stressed("rod l2 84 cm", "follower.rod_mm", 840.0),
        stressed("speed 0.5 Hz", "shaft.speed_rpm", 30.0),
        stressed("rotation clockwise", "shaft.rotation", "cw"),
        stressed("segment 2 span 40", "motion.segments[1].span_deg", 40.0),
        stressed("stroke 160", "motion.segments[1].rise_mm", -160.0),
        stressed("H 1310", "follower.guide_height_mm", 1310.0),
    ],
)
def test_a_value_behind_a_name_sets_the_field_as_one_step(user: User, typed: str, path: str, value: object) -> None:
    from core.design import get

    before = get(user.session.typed, path)
    finder = find(user, typed)
    assert finder.shown[0].kind == "Set"
    user.press(Qt.Key.Key_Return)
    assert not finder.isVisible()
    assert get(user.session.typed, path) == value
    assert len(user.steps) == 1
    user.choose("Edit", f"Undo {user.steps[0]}")
    assert get(user.session.typed, path) == before


def test_a_value_that_cannot_be_says_what_is_allowed_and_changes_nothing(user: User) -> None:
    finder = find(user, "base radius -3")
    assert "allowed: above 0" in finder.shown[0].title
    user.press(Qt.Key.Key_Return)
    assert user.steps == []
    user.press(Qt.Key.Key_Escape)
    assert not finder.isVisible()


@pytest.mark.parametrize(
    ("typed", "path", "said"),
    spread(
        [
            (
                "base radius 420 kg",
                "cam.base_radius_mm",
                "420 kg is not a valid value; its units are mm, µm, cm, m, in",
            ),
            ("speed 3 mm", "shaft.speed_rpm", "3 mm is not a valid value; its units are °/s, rad/s, rpm, Hz"),
            ("base radius 412,5", "cam.base_radius_mm", "enter a number, with a decimal point and no comma"),
            ("rod centre 3 furlongs", "loads.rod_centre", "3 furlongs is not a valid value; it has no unit"),
        ],
        1,
    ),
)
def test_a_unit_that_the_field_lacks_gives_one_line_and_sets_nothing(
    user: User, typed: str, path: str, said: str
) -> None:
    finder = find(user, typed)
    assert finder.shown[0].kind == "Refused"
    assert said in finder.shown[0].title
    user.press(Qt.Key.Key_Return)
    assert finder.isVisible()
    assert user.steps == []
    QTest.mouseClick(
        finder.list.viewport(), Qt.MouseButton.LeftButton, pos=finder.list.visualRect(finder.rows.index(0, 0)).center()
    )
    assert not finder.isVisible()
    wait_for(lambda: user.parameters().field(path).editor.hasFocus())


def test_enter_on_a_refused_value_does_not_redo_what_was_undone(user: User) -> None:
    user.enter("cam.base_radius_mm", "420")
    user.choose("Edit", f"Undo {user.steps[0]}")
    finder = find(user, "base radius 420 N")
    assert [match.kind for match in finder.shown][:1] == ["Refused"]
    sentence = finder.rows.index(0, 1)
    assert finder.list.visualRect(sentence).width() >= finder.list.sizeHintForIndex(sentence).width(), "read in full"
    user.press(Qt.Key.Key_Return)
    assert user.session.stack.index() == 0
    user.press(Qt.Key.Key_Escape)


def test_what_cannot_be_done_now_and_what_is_nothing_is_told_in_a_line(user: User) -> None:
    """And nothing else is done in its place."""
    user.enter("cam.base_radius_mm", "410")
    for _ in range(2):
        finder = find(user, "undo")
        assert finder.shown[0].title.startswith("Undo")
        user.press(Qt.Key.Key_Return)
    assert user.window.status.currentMessage() == "Undo is not available now"
    assert (len(user.steps), user.session.stack.index()) == (1, 0)
    finder = find(user, "qwertz 3")
    assert [finder.rows.data(finder.rows.index(0, 1)), finder.shown] == ["No match for qwertz 3", []]
    user.press(Qt.Key.Key_Return)
    QTest.mouseClick(
        finder.list.viewport(), Qt.MouseButton.LeftButton, pos=finder.list.visualRect(finder.rows.index(0, 1)).center()
    )
    assert finder.isVisible()
    user.press(Qt.Key.Key_Escape)


def test_a_name_with_a_number_in_it_is_no_refused_value(user: User) -> None:
    finder = find(user, "segment 2 span")
    assert (finder.shown[0].kind, finder.shown[0].title) == ("Field", "Segment 2, span")
    user.press(Qt.Key.Key_Escape)


@pytest.mark.parametrize("key", [Qt.Key.Key_Escape, Qt.Key.Key_Return])
def test_an_empty_line_is_left_after_the_field_that_had_the_keys_has_gone(open_user: Open, key: Qt.Key) -> None:
    """As those of a form do that is made anew."""
    user = open_user(whole=True)
    user.window.focus_field("cam.base_radius_mm")
    settle()
    field = user.window.focusWidget()
    assert isinstance(field, NumberBox)
    finder = find(user, "")
    delete(field)
    QTest.keyClick(finder.line, key)
    settle()
    assert not finder.isVisible()


def test_another_drive_is_set_under_its_name(same_window: Open) -> None:
    user = same_window(example("transfer_unit"))
    find(user, "lift base radius 410")
    user.press(Qt.Key.Key_Return)
    drive = next(each for each in user.session.full_design.drives if each.name == "Lift")
    assert drive.cam.base_radius_mm == 410.0


@pytest.mark.parametrize(
    ("typed", "kind", "title"),
    spread(
        [
            ("ψ", "Channel", "Pressure angle"),
            ("psi", "Channel", "Pressure angle"),
            ("contact force", "Command", "Contact force"),
            ("card picker", "Example", "Card picker"),
            ("rolling life", "Help", "Followers: Contact pressure and rolling life"),
            ("α0", "Help", "The four papers: Shin, Kim and Ha 1995"),
            ("split", "Command", "Split segment"),
            ("thickness", "Field", "Thickness"),
            ("radius", "Field", "Base radius Br"),
        ],
        3,
    ),
)
def test_words_and_symbols_find_what_they_name(user: User, typed: str, kind: str, title: str) -> None:
    finder = find(user, typed)
    assert (finder.shown[0].kind, finder.shown[0].title) == (kind, title)
    user.press(Qt.Key.Key_Escape)
    assert not finder.isVisible()


def test_every_field_channel_and_page_is_found_by_its_own_name(user: User) -> None:
    finder = find(user, "")
    there = {(found.kind, found.title) for found in finder.all}
    assert {("Help", title) for title, _ in PAGES.values()} <= there
    channels = {quantity(name).label for name in names_of(user.design) if quantity(name).slug}
    assert {("Channel", label) for label in channels} <= there
    paths = {found.path for found in finder.all if found.kind == "Field"}
    assert set(user.parameters().forms["cam"].fields) <= paths
    user.press(Qt.Key.Key_Escape) if finder.line.hasFocus() else finder.leave()


def test_what_is_found_is_done(user: User) -> None:
    find(user, "keyway width")
    user.press(Qt.Key.Key_Return)
    wait_for(lambda: user.parameters().field("cam.keyway_width_mm").editor.hasFocus())
    find(user, "rod angle")
    user.press(Qt.Key.Key_Down, Qt.Key.Key_Up, Qt.Key.Key_Return)
    curves = user.window.view("curves")
    wait_for(curves.on_screen)
    assert curves.graph.curves[curves.row].y == "beta_deg"
    find(user, "rod angle")
    user.press(Qt.Key.Key_Return)
    assert [curve.y for curve in curves.graph.curves].count("beta_deg") == 1


# -- F1 ---------------------------------------------------------------------------------------------------


def test_f1_opens_the_page_of_view_and_field(user: User) -> None:
    editor = user.number("cam.base_radius_mm")
    QTest.keyClick(editor, Qt.Key.Key_F1)
    pages = user.window.findChild(HelpWindow)
    wait_for(pages.isVisible)
    assert pages.list.currentItem().text() == "Fields of this design"
    assert pages.text.textCursor().selectedText() == "cam.base_radius_mm"
    pages.close()
    user.window.activateWindow()
    user.choose("Kine", "Find")
    user.see("find").what.setFocus()
    user.press(Qt.Key.Key_F1)
    assert pages.list.currentItem().text() == "Finding dimensions"
    pages.close()


def test_all_keys_stand_on_one_page(user: User) -> None:
    user.choose("Help", "Shortcuts")
    pages = user.window.findChild(HelpWindow)
    text = pages.text.toPlainText()
    keys = [each.shortcut().toString() for each in user.window.actions_by_key.values() if not each.shortcut().isEmpty()]
    assert len(keys) > 25
    assert [key for key in keys if key not in text] == []
    pages.close()


# -- dialogs ----------------------------------------------------------------------------------------------


def click_copy(dialog: QDialog) -> list[str]:
    """The words of the command that a dialog copies."""
    box = dialog.findChild(QDialogButtonBox)
    button = next(each for each in box.buttons() if each.text() == "Copy as command")
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    return shlex.split(QApplication.clipboard().text())


def test_a_dialog_copies_the_command_that_asks_for_the_same(user: User, tmp_path: Path) -> None:
    window, design, study = user.window, user.design, user.session.full_study

    def profile(dialog: ProfileDialog) -> None:
        dialog.form.choose("Points", "samples")
        dialog.form.show_value("samples", 720)
        dialog.form.show_value("cutter_mm", 12.5)

    def report(dialog: ReportDialog) -> None:
        dialog.lines["customer"].setText("Kim & Co")
        dialog.parts["papers"].setChecked(False)

    for made, change, seen in (
        (ProfileDialog(window, design), profile, {"samples": 720, "cutter_mm": 12.5}),
        (ControllerDialog(window, design, ""), lambda dialog: None, {}),
        (InspectionDialog(window, design), lambda dialog: None, {}),
        (TablesDialog(window, tmp_path, study), lambda d: d.form.show_value("samples", 36), {"samples": 36}),
        (ReportDialog(window), report, {"customer": "Kim & Co", "without": ["papers"]}),
        (
            ScaleDialog(window, window.session.design),
            lambda dialog: dialog.masses.setChecked(False),
            {"masses": False, "factor": 1.0},
        ),
    ):
        change(made)
        program, headless, *words = click_copy(made)
        assert (program, headless) == ("kindyna", "--headless")
        asked = vars(parser("kindyna", COMMANDS).parse_args(words))
        assert {name: asked[name] for name in seen} == seen, words
        request = getattr(getattr(made, "form", None), "values", {})
        assert {name: asked[name] for name in request} == request, words
        made.reject()
        made.deleteLater()
    assert Cover().customer == ""


# -- tables, empty views ----------------------------------------------------------------------------------


def test_copy_takes_the_whole_table(user: User) -> None:
    table = user.motion().table
    table.setFocus()
    QTest.keySequence(table, QKeySequence(QKeySequence.StandardKey.Copy))
    lines = QApplication.clipboard().text().split("\n")
    assert len(lines) == 1 + len(user.design.drive.motion.segments)
    assert {line.count("\t") for line in lines} == {table.model().columnCount() - 1}
    assert lines[2].split("\t")[1:] == [user.cell(1, column) for column in range(1, table.model().columnCount())]


def test_every_table_is_copied_as_a_whole(same_window: Open) -> None:
    user = same_window(example("transfer_unit"))
    for name in ("drives", "shaft_figures", "certificate", "findings", "graph"):
        view = user.see(name)
        for table in view.findChildren(QAbstractItemView):
            if not table.isVisible() or isinstance(table.parent(), QMenu) or table.model().columnCount() < 2:
                continue
            QApplication.clipboard().setText("before")
            QTest.keySequence(table, QKeySequence(QKeySequence.StandardKey.Copy))
            rows, model = len(QApplication.clipboard().text().split("\n")) - 1, table.model()
            assert rows == model.rowCount() + sum(model.rowCount(model.index(i, 0)) for i in range(model.rowCount())), (
                name
            )


def buttons(user: User, name: str) -> dict[str, QPushButton]:
    view = user.see(name)
    assert view.in_trouble, name
    (page,) = (each for each in view.findChildren(ReasonPage) if each.isVisible())
    assert " > " not in page.label.text()
    return {each.text(): each for each in page.findChildren(QPushButton) if each.isVisible()}


def test_empty_views_do_the_next_thing_by_a_button(same_window: Open) -> None:
    user = same_window()
    ways = buttons(user, "stability")
    assert list(ways) == ["Make the shaft elastic"]
    QTest.mouseClick(ways["Make the shaft elastic"], Qt.MouseButton.LeftButton)
    wait_for(lambda: not user.window.view("stability").in_trouble)
    assert user.design.shaft.elastic is not None
    user = same_window(example("four_bar"))
    assert "Drive a link by a motion..." in buttons(user, "motion")
    assert "Drive a link by a motion..." in buttons(user, "contact")
    assert "Drive a link by a motion..." in buttons(user, "contact_pressure")
    assert "Begin with a cam..." in buttons(user, "find")
    way = buttons(user, "motion")["Drive a link by a motion..."]
    QTest.mouseClick(way, Qt.MouseButton.LeftButton)
    menu = QApplication.activePopupWidget()
    assert isinstance(menu, QMenu)
    choice = next(each for each in menu.actions() if "follows a motion" in plain(each.text()))
    menu.close()
    choice.trigger()
    settle()
    assert user.design.drive.motion is not None


def test_every_way_is_an_entry_of_the_menus(user: User) -> None:
    entries = {way.entry for ways in SUGGESTIONS.values() for way in ways}
    assert entries <= set(user.window.actions_by_key)
    assert [sentence for sentence in SUGGESTIONS if " > " in sentence] == []


@pytest.mark.stress
@pytest.mark.parametrize("name", ["four_bar", "four_bar_coupler_cam", "card_picker"])
def test_no_view_names_a_way_through_menus_and_every_table_is_copied(same_window: Open, name: str) -> None:
    """A reason says what is missing; the way there is a button."""
    user = same_window(example(name))
    ways, silent, pages = {}, [], {}
    for each in VIEWS:
        view = user.see(each)
        if view is None:
            continue
        settle()
        for page in view.findChildren(ReasonPage):
            if page.isVisible():
                pages[each] = [b.text() for b in page.findChildren(QPushButton) if b.isVisible()]
        texts = [label.text() for label in view.findChildren(QLabel) if label.isVisible()]
        if found := [text for text in texts if MENU_WAY.search(text)]:
            ways[each] = found
        for table in view.findChildren(QTableView):
            if not table.isVisible() or table.model() is None or not table.model().rowCount():
                continue
            QApplication.clipboard().setText("before")
            QTest.keySequence(table, QKeySequence(QKeySequence.StandardKey.Copy))
            lines = QApplication.clipboard().text().split("\n")
            if lines == ["before"] or len(lines) < table.model().rowCount():
                silent.append((each, type(table).__name__, len(lines), table.model().rowCount()))
    without = [name for name, ways in pages.items() if not ways and name != "circle"]
    assert without == ["space"], "what no entry mends"
    assert ways == {}
    assert silent == []
