"""kindyna_gui.window.menus, submenus: every entry is there, does something, and has its own keys."""

from collections import Counter
from collections.abc import Iterator

import pytest
from PySide6.QtCore import QEvent, QObject, Qt, QUrl
from PySide6.QtGui import QAction, QKeySequence, QTextDocument
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QMenuBar, QToolButton, QWidget
from window_user import Open, User, end_pauses, plain, settle, wait_for

from core.design import FOLLOWER_KINDS, LAYOUTS, faults, kind_of, stroke
from core.study import findings_of
from kindyna_gui.help import HelpWindow
from kindyna_gui.linkage.draw_tools import TOOLS
from kindyna_gui.linkage.drawing_actions import ACTIONS
from kindyna_gui.places import example, examples
from kindyna_gui.window.docks import VIEWS
from kindyna_gui.window.menus import MENUS, TOOLBAR, Item

TITLES = ["File", "Edit", "Make", "Compo", "Kine", "Dyna", "Stability", "Graph", "View", "Help"]


def all_actions(place: QWidget) -> Iterator[QAction]:
    """Every entry of a menu and of the menus in it, each opened first."""
    for action in place.actions():
        menu = action.menu()
        if isinstance(menu, QMenu):
            menu.aboutToShow.emit()
            yield from all_actions(menu)
        elif not action.isSeparator():
            yield action


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window()


def test_the_menus_are_those_of_the_program_of_1995_and_every_entry_says_what_it_does(user: User) -> None:
    bar = user.window.menuBar()
    assert [plain(a.text()) for a in bar.actions()] == TITLES
    assert [a.text() for a in all_actions(bar) if not a.statusTip()] == []
    keys = Counter(key.toString() for a in all_actions(bar) for key in a.shortcuts() if not key.isEmpty())
    assert [key for key, number in keys.items() if number > 1] == []
    assert keys["Ctrl+S"] == keys["Ctrl+Z"] == 1
    # Qt's own key for it is Exit where it knows no desktop
    assert user.action("File", "Quit").shortcut() == QKeySequence("Ctrl+Q")
    for _, rows in MENUS:
        for row in rows:
            if isinstance(row, Item):
                place: object = user.window
                for name in row.slot.split("."):
                    place = getattr(place, name)
                assert callable(place)
                assert row.argument is None or row.slot != "show_view" or row.argument in VIEWS


def test_no_two_entries_of_a_menu_share_their_letter() -> None:
    for title, rows in MENUS:
        letters = Counter(row.text.replace("&&", "").partition("&")[2][:1].lower() for row in rows if row is not None)
        assert [x for x, number in letters.items() if number > 1 and x] == [], title
        assert "" not in letters, title


@pytest.mark.stress
def test_views_come_to_the_front_by_their_menus(user: User) -> None:
    for way, name in (
        (("Make", "Motion table"), "motion"),
        (("Compo", "Mechanism"), "mechanism"),
        (("Kine", "Velocity"), "velocity"),
        (("Kine", "Acceleration"), "acceleration"),
        (("Kine", "Jerk"), "jerk"),
        (("Kine", "Displacement"), "displacement"),
        (("Kine", "Curvature"), "curvature"),
        (("Kine", "Pressure angle"), "pressure_angle"),
        (("Dyna", "Contact force"), "contact_force"),
        (("Dyna", "Torque"), "torque"),
        (("Dyna", "Flywheel"), "flywheel"),
        (("Dyna", "Camshaft speed"), "camshaft_speed"),
        (("Graph", "New graph..."), "graph"),
    ):
        user.choose(*way)
        view = user.window.view(name)
        assert view is not None, name
        wait_for(view.on_screen)


def test_forms_come_to_the_front_by_their_menus(user: User) -> None:
    for way, path in (
        (("Compo", "Follower"), "follower.layout"),
        (("Compo", "Cam"), "cam.base_radius_mm"),
        (("Dyna", "Loads"), "loads.external_force_n"),
        (("Stability", "Camshaft data"), "shaft.speed_rpm"),
    ):
        user.window.docks["parameters"].hide()
        user.choose(*way)
        field = user.parameters().field(path)
        assert field is not None
        wait_for(field.editor.hasFocus)


# -- entries that depend on the state of things -----------------------------------------------------------


def test_examples_begin_without_a_file(user: User) -> None:
    names = [name for name, _ in examples()]
    assert user.entries("File", "Examples") == names
    for name, path in examples()[::4]:
        user.choose("File", "Examples", name)
        assert user.session.path is None
        assert not user.session.modified
        assert user.design.name in path.read_text(encoding="utf-8")


def test_a_design_of_each_kind_can_be_begun(user: User) -> None:
    assert user.entries("File", "New by type") == [
        *(row.label for row in FOLLOWER_KINDS.values()),
        "Barrel cam",
        "Globoidal cam",
        "Linkage by drawing",
        "Indexer...",
        "Flying shear...",
        "Camshaft...",
        "Valve train...",
    ]
    for slug, row in FOLLOWER_KINDS.items():
        user.choose("File", "New by type", row.label)
        assert kind_of(user.design.drive.mechanism) == slug
        assert user.design.name.lower() == f"new {row.label.lower()}"
        assert faults(user.design) == []
        levels = user.session.study.full_turn.motion.y[0]
        assert levels[0] == levels.min() == 0.0
        assert levels.max() == pytest.approx(
            stroke(user.design.drive.motion) * user.design.drive.motion.scale, rel=1e-15
        )
        assert [s.curve.law for s in user.design.drive.motion.segments] == ["modified-sine", "dwell"] * 2
        assert [s.span_deg for s in user.design.drive.motion.segments] == [120.0, 60.0] * 2
        assert findings_of(user.session.study) == ()
        assert not any(path.startswith("motion") for path in user.design.assumed)


def test_layouts_are_there_where_the_follower_has_any(user: User) -> None:
    entries = user.entries("Compo", "Layout")
    assert [text[0] for text in entries] == list(LAYOUTS)
    chosen = user.action("Compo", "Layout", entries[1])
    assert chosen.isChecked()
    user.choose("Compo", "Layout", entries[0])
    assert user.steps == ["Change layout to a"]
    user.choose("Edit", "Undo Change layout to a")
    user.choose("File", "Examples", "Card picker")
    assert "Layout" not in user.entries("Compo")


def test_docks_are_shown_and_hidden(whole: User) -> None:
    dock = whole.window.docks["motion"]
    whole.choose("View", "Docks", "Motion")
    assert dock.isHidden()
    whole.choose("View", "Docks", "Motion")
    assert not dock.isHidden()


@pytest.mark.stress
def test_pictures_on_screen_can_be_exported(whole: User) -> None:
    whole.choose("View", "Kine")
    shown = ["Mechanism...", "Displacement...", "Pressure angle..."]
    wait_for(lambda: whole.entries("Graph", "Export picture") == shown)
    whole.choose("Kine", "Velocity")
    wait_for(lambda: "Velocity..." in whole.entries("Graph", "Export picture"))
    assert "Displacement..." not in whole.entries("Graph", "Export picture")


# -- undo, player -----------------------------------------------------------------------------------------


def test_undo_and_redo_name_their_step(user: User) -> None:
    assert user.entries("Edit")[:2] == ["Undo", "Redo"]
    assert not user.action("Edit", "Undo").isEnabled()
    user.enter("follower.rod_mm", "850")
    assert user.entries("Edit")[:2] == ["Undo Change rod L2 to 850 mm", "Redo"]
    user.choose("Edit", "Undo Change rod L2 to 850 mm")
    assert user.entries("Edit")[:2] == ["Undo", "Redo Change rod L2 to 850 mm"]
    user.choose("Edit", "Redo Change rod L2 to 850 mm")
    assert user.entries("Edit")[0] == "Undo Change rod L2 to 850 mm"


class Layouts(QObject):
    """Number of times that the toolbar is laid out or painted."""

    count = 0

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        self.count += event.type() in (QEvent.Type.Paint, QEvent.Type.LayoutRequest)
        return False


def test_keys_in_a_field_do_not_lay_out_the_toolbar_and_the_menu_names_the_last_step(user: User) -> None:
    """Undo can be chosen at once; its entry has the step when the menu opens, or once editing pauses."""
    user.enter("follower.rod_mm", "850")
    box, bar = user.number("follower.rod_mm"), user.window.findChild(QWidget, "toolbar")
    assert bar is not None
    layouts = Layouts()
    bar.installEventFilter(layouts)
    for _ in range(3):
        QTest.keyClick(box, Qt.Key.Key_Up)
        QApplication.sendPostedEvents()
    assert layouts.count == 0
    undo = user.window.actions_by_key["undo"]
    assert undo.isEnabled()
    menu = next(widget for widget in undo.associatedObjects() if isinstance(widget, QMenu))
    menu.aboutToShow.emit()
    assert undo.text() == f"&Undo {user.steps[-1]}" == "&Undo Change rod L2 to 880 mm"
    QTest.keyClick(box, Qt.Key.Key_Up)
    end_pauses()
    assert undo.text() == "&Undo Change rod L2 to 890 mm"


def test_an_ampersand_in_a_name_stays(user: User) -> None:
    user.session.edit("name", "Cam & Co", "Change name to Cam & Co")
    assert user.entries("Edit")[0] == "Undo Change name to Cam & Co"


def test_the_player_obeys_the_menu(user: User) -> None:
    player = user.window.player
    user.choose("Kine", "Play")
    assert player.playing
    wait_for(lambda: player.theta > 0.0)
    user.choose("Kine", "Play")
    assert not player.playing
    player.set_theta(0.0)
    user.choose("Kine", "Step forward")
    assert user.window.status.angle.text() == "cam angle 1.0°"
    user.choose("Kine", "Step back")
    user.choose("Kine", "Play backwards")
    assert (player.theta, player.forward) == (0.0, False)
    assert user.action("Kine", "Play backwards").isChecked()
    player.play()
    assert user.action("Kine", "Play").isChecked()
    player.play(False)


def test_the_player_turns_as_fast_as_the_shaft(user: User) -> None:
    assert user.window.player.omega == user.session.study.omega
    user.enter("shaft.speed_rpm", "30")
    assert user.window.player.omega == user.session.study.omega


def test_the_toolbar_has_the_menus_actions(user: User) -> None:
    bar = user.window.findChild(QWidget, "toolbar")
    assert bar is not None
    shown = [a for a in bar.actions() if not a.isSeparator()]
    assert shown == [user.window.actions_by_key[key] for key in TOOLBAR if key is not None]
    assert all(not a.icon().isNull() for a in shown)
    assert all(button.toolTip() for button in bar.findChildren(QToolButton) if button.defaultAction() is not None)


# -- help -------------------------------------------------------------------------------------------------


def help_window(user: User) -> HelpWindow:
    found = user.window.findChild(HelpWindow)
    assert isinstance(found, HelpWindow)
    return found


def test_help_has_pages_that_lead_to_each_other(user: User) -> None:
    user.choose("Help", "Tour")
    pages = help_window(user)
    wait_for(pages.isVisible)
    assert pages.text.toPlainText().startswith("Tour")
    user.choose("Help", "Laws and conventions")
    text = pages.text.toPlainText()
    assert "Modified sine" in text
    assert "{laws}" not in text
    pages.list.setCurrentRow(0)
    assert "laws.md" in pages.text.toHtml()
    pages.text.anchorClicked.emit("laws.md")
    assert pages.list.currentItem().text() == "Laws and conventions"
    for page in ("Making a motion", "Blended motions", "The four papers"):
        user.choose("Help", page)
        assert pages.text.toPlainText().startswith(page)
    pages.close()


def test_a_page_of_the_help_is_laid_out_once(user: User) -> None:
    """Its tables have hundreds of cells, each of which has its room changed."""
    user.choose("Help", "Tour")
    pages = help_window(user)
    changes: list[int] = []
    pages.text.document().contentsChanged.connect(lambda: changes.append(1))
    user.choose("Help", "Laws and conventions")
    assert "Modified sine" in pages.text.toPlainText()
    assert len(changes) < 10
    pages.close()


def test_the_page_of_tutorials_shows_the_window_after_each_step(user: User) -> None:
    user.choose("Help", "Tour")
    pages = help_window(user)
    wait_for(pages.isVisible)
    (item,) = pages.list.findItems("Tutorials", Qt.MatchFlag.MatchExactly)
    QTest.mouseClick(pages.list.viewport(), Qt.MouseButton.LeftButton, pos=pages.list.visualItemRect(item).center())
    settle()
    assert pages.text.horizontalScrollBar().maximum() == 0
    for name, steps in {"lift": 10, "linkage": 8, "camshaft": 8, "valve_train": 9}.items():
        for step in range(1, steps + 1):
            address = QUrl(f"tutorial_{name}_{step:02}.webp")
            image = pages.text.document().resource(QTextDocument.ResourceType.ImageResource.value, address)
            assert 500 < image.width() / image.devicePixelRatio() < pages.text.viewport().width()
    shown = pages.text.viewport().grab().toImage()
    colours = {shown.pixelColor(x, y).name() for x in range(0, shown.width(), 2) for y in range(0, shown.height(), 2)}
    assert len(colours) > 100, "an image, not its placeholder"
    pages.close()


def test_keys_of_the_drawing_mode_have_no_other_meaning_in_the_window(user: User) -> None:
    """A key of a menu that works anywhere would do nothing in the drawing, where it would be ambiguous."""
    anywhere = {
        key.toString()
        for action in all_actions(user.window.menuBar())
        for key in action.shortcuts()
        if action.shortcutContext() == Qt.ShortcutContext.WindowShortcut
    }
    assert anywhere.isdisjoint({row.key for row in (*ACTIONS, *TOOLS.values()) if row.key})


def test_shortcuts_work_from_anywhere(user: User) -> None:
    user.number("follower.rod_mm")
    user.press(Qt.Key.Key_F5)
    assert user.window.player.playing
    user.press(Qt.Key.Key_F5)
    assert not user.window.player.playing
    assert QKeySequence("F5") in user.action("Kine", "Play").shortcuts()
    assert QApplication.focusWidget() is not None
    settle()


def test_an_entry_whose_menu_is_filled_anew_while_it_acts_is_still_told(user: User) -> None:
    """A view that says why it is empty asks the menus what helps, as soon as the design has changed."""
    user.window.documents.open_example(example("watt_six_bar"))
    settle()
    told: list[str] = []
    user.window.menuBar().triggered.connect(lambda action: told.append(action.text()))
    user.session.design_changed.connect(lambda: user.window.can("drivers"))
    place: QMenuBar | QMenu = user.window.menuBar()
    for way in (("Compo",), ("Compo", "Driver")):
        action = user.action(*way)
        QTest.mouseClick(place, Qt.MouseButton.LeftButton, pos=place.actionGeometry(action).center())
        menu = action.menu()
        assert isinstance(menu, QMenu)
        wait_for(menu.isVisible)
        place = menu
    entry = next(a for a in place.actions() if a.isEnabled() and not a.isChecked())
    text = entry.text()
    QTest.mouseClick(place, Qt.MouseButton.LeftButton, pos=place.actionGeometry(entry).center())
    settle()
    assert user.session.stack.count() == 1
    assert told == [text]
