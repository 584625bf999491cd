"""kindyna_gui.forms.parameters_view, fields: parameters are made from metadata, typed, stepped, refused and taken back."""

from html import escape
from math import radians
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu
from room import unreadable
from sampled import spread
from window_user import Open, User, settle, wait_for

from core.design import CamSlider, entries, get
from core.number_text import shortest, typeset
from core.project import load, save
from kindyna_gui.export import Exports
from kindyna_gui.files.beginnings import beginning
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.forms.parameters_view import SECTIONS
from kindyna_gui.forms.tab_bars import TabList
from kindyna_gui.places import example
from kindyna_gui.screenshots import rest

ROD, ARM, X = "follower.rod_mm", "follower.roller_arm_mm", "follower.pivot_x_mm"
LIFT = load(example("transfer_lift"))


@pytest.fixture
def user(same_window: Open) -> User:
    """Without plots, for which no test here has eyes."""
    return same_window()


def follower(user: User) -> CamSlider:
    made = user.design.drive.mechanism
    assert isinstance(made, CamSlider)
    return made


# -- what is shown ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", spread(["transfer_lift", "card_picker"], 1))
def test_every_entry_has_its_row_what_matters_most_first_else_in_the_order_of_the_file(
    open_user: Open, name: str
) -> None:
    user = open_user()
    user.window.documents.open_example(example(name))
    shown = user.parameters()
    for section in SECTIONS:
        rows = {entry.path: entry for entry in entries(user.design, section)}
        order = [*rows]
        ranks = [(-rows[p].info.weight, rows[p].info.order, order.index(p)) for p in shown.forms[section].fields]
        assert ranks == sorted(ranks)
        assert set(shown.forms[section].fields) == set(rows)
        for path, field in shown.forms[section].fields.items():
            entry = rows[path]
            assert field.unit is None or field.unit.text() == entry.unit.symbol
            assert entry.info.label.partition("_")[0] in field.label.text()
            for part in (entry.path, entry.info.help, typeset(entry.info.allowed(entry.unit))):
                assert escape(part.replace(">=", "≥")) in field.label.toolTip()
            if isinstance(field.editor, NumberBox):
                assert field.editor.text() == ("" if entry.value is None else shortest(entry.value))
            else:
                assert field.editor.currentData() == entry.value
            assert field.mark is not None
            assert field.mark.isChecked() == (path in user.design.assumed)


def test_a_page_has_fields_from_when_it_is_shown_or_refuses_a_value(open_user: Open) -> None:
    user = open_user()
    shown = user.parameters()
    shown.show_section("follower")
    settle()

    def boxes() -> dict[str, int]:
        return {section: len(shown.pages[section].findChildren(NumberBox)) for section in ("cam", "shaft", "loads")}

    assert boxes() == {"cam": 0, "shaft": 0, "loads": 0}
    shown.show_section("loads")
    settle()
    after = boxes()
    assert after == {"cam": 0, "shaft": 0, "loads": after["loads"]}
    assert after["loads"] > 5
    user.window.session.edit("cam.base_radius_mm", -1.0, "Change base radius")
    settle()
    assert boxes()["cam"] > 3
    assert not shown.tabs.tabIcon(shown.tabs.indexOf(shown.pages["cam"])).isNull(), "the page is marked"
    assert shown.forms["cam"].fields["cam.base_radius_mm"].trouble
    assert boxes()["shaft"] == 0


def test_all_tabs_can_be_read_and_those_without_room_are_in_a_list(open_user: Open) -> None:
    """A valve train has eight sections; wrong values make tabs wider by a sign."""
    user = open_user(example("valve_train"), (1440, 900), whole=True)
    window, shown = user.window, user.parameters()
    rest(window, 1.0)
    tabs, bar = shown.tabs, shown.tabs.tabBar()
    present = [i for i in range(tabs.count()) if tabs.is_present(i)]
    assert [i for i in present if tabs.isTabVisible(i)] == present
    assert len(present) == 8
    assert unreadable(window) == []
    for path in ("cam.base_radius_mm", "engine.stroke_mm"):
        user.enter(path, "-5")
    settle()
    hidden = [i for i in present if not tabs.isTabVisible(i)]
    assert hidden == present[-len(hidden) :] != []
    assert unreadable(window) == []
    assert max(bar.tabRect(i).right() for i in present if i not in hidden) < tabs.findChild(TabList).x()
    menu = tabs.findChild(TabList).menu()
    menu.aboutToShow.emit()
    assert [entry.text() for entry in menu.actions()] == [tabs.tabText(i) for i in hidden]
    menu.actions()[-1].trigger()
    settle()
    assert tabs.currentIndex() == hidden[-1]
    assert tabs.isTabVisible(hidden[-1])
    assert unreadable(window) == []
    for path in ("engine.stroke_mm", "cam.base_radius_mm"):
        shown.field(path).editor.withdraw()
    settle()
    assert [i for i in present if tabs.isTabVisible(i)] == present


def test_a_linkage_opens_on_its_own_page(user: User) -> None:
    tabs = user.parameters().tabs
    assert tabs.tabText(tabs.currentIndex()) == "Follower"
    user.session.open(example("four_bar"))
    user.parameters()
    assert tabs.tabText(tabs.currentIndex()) == "Linkage"


def test_fields_follow_undo_and_other_files(user: User) -> None:
    user.enter(ROD, "850")
    user.choose("Edit", "Undo Change rod L2 to 850 mm")
    assert user.number(ROD).text() == "845"
    user.choose("File", "Examples", "Card picker")
    assert user.parameters().field(ROD) is None
    assert user.number("follower.offset_mm").text() == "0"


# -- typing -----------------------------------------------------------------------------------------------


def test_keys_of_the_window_act_in_a_field_and_those_of_the_motion_do_not(
    user: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On X11 a line of text would take Ctrl+E for its own end."""
    asked: list[str] = []
    monkeypatch.setattr(Exports, "tables", lambda _: asked.append("tables"))
    before = user.design
    user.number(ROD).setFocus()
    split = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    user.press(Qt.Key.Key_I, modifier=split)
    for key in (Qt.Key.Key_D, Qt.Key.Key_I, Qt.Key.Key_E):
        user.press(key, modifier=Qt.KeyboardModifier.ControlModifier)
    user.press(Qt.Key.Key_F7)
    assert user.design == before
    assert user.steps == []
    assert asked == ["tables"]
    assert user.window.player.theta == pytest.approx(radians(1.0))
    view = user.motion()
    view.choose(2)
    for key, held, many in ((Qt.Key.Key_I, split, 6), (Qt.Key.Key_D, Qt.KeyboardModifier.ControlModifier, 5)):
        view.table.setFocus()
        user.press(key, modifier=held)
        assert view.model.rowCount() == many
    view.fields["motion.start_mm"].focus()
    user.press(Qt.Key.Key_D, modifier=Qt.KeyboardModifier.ControlModifier)
    assert view.model.rowCount() == 5, "in a field of the motion neither"


def test_typed_and_entered(user: User) -> None:
    user.enter(ROD, "850")
    assert follower(user).rod_mm == 850.0
    assert user.steps == ["Change rod L2 to 850 mm"]
    assert user.session.stack.undoText() == "Change rod L2 to 850 mm"


def test_typed_and_left_by_tab(user: User) -> None:
    box = user.number(ROD)
    user.type("850")
    assert follower(user).rod_mm == 845.0
    user.press(Qt.Key.Key_Tab)
    assert follower(user).rod_mm == 850.0
    assert not box.hasFocus()


def test_a_number_that_is_only_looked_at_stays(user: User) -> None:
    for path in user.parameters().forms["follower"].fields:
        user.field(path)
        user.press(Qt.Key.Key_Tab)
    assert user.design == LIFT
    assert user.steps == []


def test_each_entry_is_a_step(user: User) -> None:
    user.enter(ROD, "850")
    user.enter(ROD, "851")
    assert user.steps == ["Change rod L2 to 850 mm", "Change rod L2 to 851 mm"]


def test_undo_by_key_while_the_field_has_the_focus(user: User) -> None:
    user.enter(ROD, "850")
    assert user.number(ROD).hasFocus()
    user.press(Qt.Key.Key_Z, modifier=Qt.KeyboardModifier.ControlModifier)
    assert follower(user).rod_mm == 845.0
    assert user.number(ROD).text() == "845"


def test_words_are_chosen_from_a_list(user: User) -> None:
    box = user.field("shaft.rotation").editor
    assert isinstance(box, WordBox)
    box.setFocus()
    user.press(Qt.Key.Key_Down)
    assert user.design.shaft.rotation == "cw"
    assert user.steps == ["Change rotation to clockwise"]


def test_the_name_is_typed_above(user: User) -> None:
    name = user.parameters().name
    name.setFocus()
    name.selectAll()
    user.type("Mine")
    user.press(Qt.Key.Key_Return)
    assert user.design.name == "Mine"
    name.selectAll()
    user.type("  ")
    user.press(Qt.Key.Key_Return)
    assert (user.design.name, name.is_refused) == ("Mine", True)
    user.choose("Edit", "Undo Change name to Mine")
    assert (name.text(), name.is_refused) == (LIFT.name, False)


# -- stepping ---------------------------------------------------------------------------------------------


def test_keys_step_live_and_are_one_step_back(open_user: Open) -> None:
    user = open_user()
    box = user.number(ROD)
    rods = []
    user.session.design_changed.connect(lambda: rods.append(follower(user).rod_mm))
    for _ in range(3):
        QTest.keyClick(box, Qt.Key.Key_Up)
    assert rods == [855.0, 865.0, 875.0]
    assert user.steps == ["Change rod L2 to 875 mm"]
    user.press(Qt.Key.Key_Return, Qt.Key.Key_Up)
    assert user.steps == ["Change rod L2 to 875 mm", "Change rod L2 to 885 mm"]


def test_dragging_the_name_is_one_step(open_user: Open) -> None:
    user = open_user()
    label = user.field(ROD).label
    start = QPoint(5, 5)
    rods = []
    user.session.design_changed.connect(lambda: rods.append(follower(user).rod_mm))
    for gesture in range(2):
        QTest.mousePress(label, Qt.MouseButton.LeftButton, pos=start)
        for x in range(1, 31):
            QTest.mouseMove(label, start + QPoint(x, 0))
            QApplication.processEvents()
        QTest.mouseRelease(label, Qt.MouseButton.LeftButton, pos=start + QPoint(30, 0))
        assert len(user.steps) == gesture + 1
    assert rods == [846.0 + i for i in range(10)]
    assert user.steps == ["Change rod L2 to 850 mm", "Change rod L2 to 855 mm"]
    assert user.number(ROD).hasFocus()


# -- refusing ---------------------------------------------------------------------------------------------


def test_a_wrong_value_is_told_and_the_last_good_design_stays(user: User) -> None:
    field, before = user.field(ROD), user.session.study
    user.enter(ROD, "-5")
    assert user.session.study is before
    assert user.steps == []
    assert field.editor.is_refused
    assert field.message.isVisible()
    assert field.message.text().startswith("Outside its range; allowed: ")
    assert user.number(ROD).text() == "-5"
    view = user.parameters()
    tab = view.tabs.indexOf(view.pages["follower"])
    assert not view.tabs.tabIcon(tab).isNull()
    assert view.tabs.tabIcon(tab + 1).isNull()
    user.enter(ROD, "850")
    assert (field.editor.is_refused, field.message.isVisible()) == (False, False)
    assert follower(user).rod_mm == 850.0
    assert view.tabs.tabIcon(tab).isNull()


def test_what_is_no_number_is_told(user: User) -> None:
    field = user.field(ROD)
    user.enter(ROD, "8,5")
    assert field.message.text() == "Enter a number, with a decimal point and no comma, such as 12.5"
    assert user.number(ROD).text() == "8,5"
    user.press(Qt.Key.Key_Escape)
    assert (user.number(ROD).text(), field.message.isVisible(), field.editor.is_refused) == ("845", False, False)


def test_undo_takes_a_refused_text_back(user: User) -> None:
    user.enter(ROD, "850")
    user.enter(X, "1e12")
    assert user.field(X).editor.is_refused
    user.choose("Edit", "Undo Change rod L2 to 850 mm")
    field = user.field(X)
    assert (user.number(X).text(), field.editor.is_refused, field.trouble) == ("873.746", False, "")


def test_a_refused_text_outlives_other_edits(user: User) -> None:
    user.enter(X, "1e12")
    user.enter("follower.pivot_y_mm", "-60")
    assert user.number(X).text() == "1e12"
    assert user.field(X).editor.is_refused
    assert follower(user).pivot_y_mm == -60.0


def test_a_fault_shows_at_the_other_field_too(user: User) -> None:
    user.enter(X, "-900")
    layout = user.field("follower.layout")
    assert "Layout: has the cam left of the pivot" in user.field(X).trouble
    assert layout.trouble.startswith("Has the cam left of the pivot, but pivot x = \u2212900; allowed: ")
    assert (user.field(X).editor.is_waiting, layout.editor.is_waiting) == (True, False)
    user.enter(X, "870")
    assert layout.trouble == ""


def test_what_has_no_answer_on_screen_waits(user: User) -> None:
    assert "linkage" in user.window.stages_on_screen()
    user.enter(ARM, "10")
    assert follower(user).roller_arm_mm == 651.081
    assert "make the roller arm" in user.field(ARM).trouble
    assert user.window.status.misfit.text() == "Does not fit yet: Roller arm Zl"
    bar = user.parameters().incomplete_bar
    assert bar.trouble.text().startswith("Roller arm Zl: the roller cannot reach")
    assert bar.trouble.text() in bar.trouble.toolTip()
    user.enter(ARM, "651.081")
    assert user.field(ARM).trouble == ""
    assert user.window.status.misfit.isHidden()
    assert user.parameters().incomplete_bar.isHidden()


def test_a_radius_out_of_reach_is_told_with_the_radii_that_are_not(user: User) -> None:
    """Whoever edits the base radius need not change the roller arm."""
    user.enter("cam.base_radius_mm", "50")
    told = user.field("cam.base_radius_mm").trouble
    assert "pivot 876.16 mm from the cam centre" in told
    assert (
        "make the roller arm 676.161 ... 1076.16 mm long, or base radius + roller radius 225.08 ... 1527.24 mm" in told
    )
    user.enter("cam.base_radius_mm", "75.08")
    assert user.design.drive.cam.base_radius_mm == 75.08


def test_a_step_into_the_wrong_is_refused_and_back_is_right(user: User) -> None:
    user.enter("cam.base_radius_mm", "1")
    user.enter("follower.fixed_angle_deg", "360")
    box = user.number("follower.fixed_angle_deg")
    QTest.keyClick(box, Qt.Key.Key_Up)
    assert box.text() == "360"  # the range ends here


def test_a_layout_takes_its_pivot_and_its_guide_along(user: User) -> None:
    box = user.field("follower.layout").editor
    assert isinstance(box, WordBox)
    box.setCurrentIndex(box.findData("c"))
    box.activated.emit(box.currentIndex())
    settle()
    assert (follower(user).layout, follower(user).pivot_x_mm) == ("c", -873.746)
    assert (user.number(X).text(), user.number("follower.guide_height_mm").text()) == ("-873.746", "-1300")
    assert user.steps == ["Change layout to c, with guide height and fixed angle"]


def test_a_word_waits_for_the_values_that_fit_to_it(user: User) -> None:
    user.enter(ARM, "10")  # so that guide and angle stay as they are
    field = user.field("follower.layout")
    box = field.editor
    assert isinstance(box, WordBox)
    box.setCurrentIndex(box.findData("c"))
    box.activated.emit(box.currentIndex())
    settle()
    assert (box.currentData(), box.is_waiting, follower(user).layout) == ("c", True, "b")
    assert user.session.typed.drive.mechanism.guide_height_mm == 1300.0
    user.choose("Edit", "Undo Change layout to c")
    assert (box.currentData(), box.is_waiting, field.trouble) == ("b", False, "")


def test_the_message_below_the_last_field_comes_into_sight(user: User) -> None:
    form = user.parameters().forms["loads"]
    path = list(form.fields)[-1]
    field = user.field(path)
    user.enter(path, "x")
    wait_for(lambda: not field.message.visibleRegion().isEmpty())
    middle = field.message.mapTo(form.viewport(), field.message.rect().center())
    assert form.viewport().rect().contains(middle)


# -- assumption -------------------------------------------------------------------------------------------


def test_a_click_on_the_asterisk_marks_as_assumed(user: User, tmp_path: Path) -> None:
    mark = user.field(ROD).mark
    assert mark is not None
    QTest.mouseClick(mark, Qt.MouseButton.LeftButton)
    assert user.design.assumed == (ROD, *LIFT.assumed)
    assert user.steps == ["Mark rod L2 as assumed"]
    save(user.design, tmp_path / "mine.toml")
    assert ROD in load(tmp_path / "mine.toml").assumed
    QTest.mouseClick(mark, Qt.MouseButton.LeftButton)
    assert user.design == LIFT
    assert user.steps[1] == "Mark rod L2 as known"
    user.choose("Edit", "Undo Mark rod L2 as known")
    assert mark.isChecked()


FACE_FIELDS = {
    "roller": {"cam.roller_radius_mm"},
    "flat": {"follower.face_half_width_mm", "follower.face_centre_mm", "loads.contact_friction"},
    "knife": {"loads.contact_friction"},
    "shoe": {"follower.shoe_radius_mm", "loads.contact_friction"},
}
FORM_FIELDS = {"open": set(), "groove": {"cam.play_mm"}, "conjugate": {"cam.play_mm", "cam.second.roller_radius_mm"}}
OWN_FIELDS = {
    ("translating", "flat"): {"follower.face_tilt_deg"},
    ("translating", "conjugate"): {"follower.second.distance_mm"},
    ("oscillating", "flat"): {"follower.face_offset_mm"},
    ("oscillating", "conjugate"): {"follower.second.arm_mm", "follower.second.angle_deg"},
}
"""Kind and face or form -> the fields that no other face or form has."""


@pytest.mark.parametrize("kind", spread(["translating", "oscillating"], 1))
def test_the_form_has_the_fields_of_its_face_and_form_and_no_others(kind: str, user: User) -> None:
    known = set().union(*FACE_FIELDS.values(), *FORM_FIELDS.values(), *OWN_FIELDS.values())
    choices = [("roller", form) for form in FORM_FIELDS] + [(face, "open") for face in FACE_FIELDS if face != "roller"]
    for face, form in choices:
        user.session.start(beginning(kind, {"follower.face": face, **({"cam.form": form} if form != "open" else {})}))
        shown = {
            path
            for each in user.parameters().forms.values()
            for path in each.fields
            if path.split(".")[0] in user.design.tables
        }
        wanted = (
            FACE_FIELDS[face]
            | FORM_FIELDS[form]
            | OWN_FIELDS.get((kind, face), set())
            | OWN_FIELDS.get((kind, form), set())
        )
        assert shown & known == wanted, (face, form)
        assert ("follower.arm_mm" in shown) == (kind == "oscillating" and face != "flat")


@pytest.mark.parametrize("path", spread([ROD, "follower.layout"], 1))
def test_the_keys_mark_as_assumed_by_the_menu_of_a_field(user: User, path: str) -> None:
    box = user.field(path).editor
    before = path in user.design.assumed
    for after in (not before, before):
        at = box.rect().center()
        QApplication.sendEvent(box, QContextMenuEvent(QContextMenuEvent.Reason.Keyboard, at, box.mapToGlobal(at)))
        menu = QApplication.activePopupWidget()
        assert isinstance(menu, QMenu)
        QTest.keyClick(menu, Qt.Key.Key_A)
        assert (path in user.design.assumed) == after
    assert len(user.steps) == 2


def test_an_assumed_value_stays_assumed_when_changed(user: User) -> None:
    user.enter("loads.friction", "0.2")
    assert user.design.assumed == LIFT.assumed
    assert get(user.design, "loads.friction") == 0.2


def test_a_name_that_is_dragged_while_another_design_takes_its_field_away_changes_nothing(user: User) -> None:
    user.window.documents.new("translating")
    begun = user.design
    user.window.documents.begin(LIFT, "lift")
    user.session.stack.undo()
    field = user.field("follower.direction_deg")
    label = field.label
    start = label.rect().center()
    QTest.mousePress(label, Qt.MouseButton.LeftButton, pos=start)
    user.window.documents.begin(load(example("four_bar")), "four-bar")  # whose window has no page for a follower
    QTest.mouseMove(label, start + QPoint(60, 0))
    field.editor.stepUp()
    QTest.mouseRelease(label, Qt.MouseButton.LeftButton, pos=start)
    settle()
    assert user.design == load(example("four_bar"))
    user.session.stack.undo()
    assert user.design == begun


@pytest.mark.parametrize("name", spread(["card_picker", "rocker_cam"], 1))
def test_another_face_brings_its_own_fields(user: User, name: str) -> None:
    user.window.documents.open_example(example(name))
    before = user.design
    for word, there, gone in (
        ("shoe", "follower.shoe_radius_mm", "cam.roller_radius_mm"),
        ("flat", "follower.face_half_width_mm", "follower.shoe_radius_mm"),
        ("knife", "loads.contact_friction", "follower.face_half_width_mm"),
        ("roller", "cam.roller_radius_mm", "loads.contact_friction"),
    ):
        box = user.field("follower.face").editor
        assert isinstance(box, WordBox)
        box.setCurrentIndex(box.findData(word))
        box.activated.emit(box.currentIndex())
        settle()
        assert user.design.drive.face.face == word
        assert user.field(there)
        with pytest.raises(AssertionError):
            user.field(gone)
        user.turn(90.0)
    while user.design != before:
        user.choose("Edit", *[entry for entry in user.entries("Edit") if entry.startswith("Undo")])


def test_a_number_that_may_be_absent_is_typed_and_cleared(user: User) -> None:
    user.window.documents.open_example(example("tappet_flat"))
    user.enter("follower.face_half_width_mm", "9.5")
    assert get(user.design, "follower.face_half_width_mm") == 9.5
    user.enter("follower.face_half_width_mm", "")
    assert get(user.design, "follower.face_half_width_mm") is None
    assert user.steps[-1] == "Clear face half width"
    user.choose("Edit", "Undo Clear face half width")
    assert user.number("follower.face_half_width_mm").text() == "9.5"
    user.enter("follower.face_half_width_mm", "")
    user.number("follower.face_half_width_mm").step_by(1)
    assert get(user.design, "follower.face_half_width_mm") == 1.0


def test_fields_that_are_left_open_are_folded_with_their_count_and_found_by_the_filter(user: User) -> None:
    view = user.parameters()
    user.field("cam.base_radius_mm")
    form = view.forms["cam"]
    folded = [path for path, field in form.fields.items() if not field.editor.isVisible()]
    assert "cam.keyway_angle_deg" in folded
    assert "cam.base_radius_mm" not in folded
    assert form.more.text() == f"{len(folded)} more"
    QTest.mouseClick(form.more, Qt.MouseButton.LeftButton)
    assert all(field.editor.isVisible() for field in form.fields.values())
    QTest.mouseClick(form.more, Qt.MouseButton.LeftButton)
    assert not form.fields["cam.keyway_angle_deg"].editor.isVisible()
    view.filter.setFocus()
    user.type("keyway")
    shown = [path for path, field in form.fields.items() if field.editor.isVisible()]
    assert shown == ["cam.keyway_width_mm", "cam.keyway_depth_mm", "cam.keyway_angle_deg"]
    user.enter("cam.base_radius_mm", "410")  # what is asked for by its path comes into sight
    assert user.design.drive.cam.base_radius_mm == 410.0
    assert form.fields["cam.base_radius_mm"].editor.isVisible()
    view.filter.clear()
    user.enter("cam.thickness_mm", "20")
    assert form.fields["cam.thickness_mm"].editor.isVisible()


def test_the_important_fields_come_first_and_what_is_seldom_needed_once_it_is_given(user: User) -> None:
    cam = list(user.parameters().forms["cam"].fields)
    assert cam[:3] == ["cam.base_radius_mm", "cam.roller_radius_mm", "cam.form"]
    assert cam.index("cam.material") < cam.index("cam.bore_mm") < cam.index("cam.keyway_angle_deg")
    user.field("loads.slider_mass_kg")
    form = user.parameters().forms["loads"]
    assert list(form.fields)[:2] == ["loads.external_force_n", "loads.spring_rate_n_per_mm"]
    gravity = form.fields["loads.gravity_m_s2"].editor
    assert not gravity.isVisible()
    before = int(form.more.text().partition(" ")[0])
    assert user.session.edit("loads.gravity_m_s2", 0.0, "No gravity")
    settle()
    assert gravity.isVisible()
    assert form.more.text() == f"{before - 1} more"
    user.session.stack.undo()
    settle()
    assert gravity.isVisible(), "nothing moves under the mouse"
    user.session.start(load(example("transfer_lift")))
    settle()
    assert not gravity.isVisible()
    assert form.more.text() == f"{before} more"
    user.enter("limits.pressure_angle_rise_deg", "30")
    rows = user.parameters().forms["limits"].fields.values()
    assert all(field.editor.isVisible() for field in rows), "what is given folds nothing away"


# -- limits in force --------------------------------------------------------------------------------------


def shown_limits(user: User) -> dict[str, tuple[str, str, str]]:
    """Label of each limit -> its text, the text in grey, and the reason in sight below it."""
    form = user.parameters().forms["limits"]
    return {
        field.spec.info.label: (
            field.editor.text(),
            field.editor.lineEdit().placeholderText(),
            field.reason.text() if field.reason is not None and field.reason.isVisible() else "",
        )
        for field in form.fields.values()
        if isinstance(field.editor, NumberBox)
    }


def test_limits_in_force_by_default_are_in_grey_with_their_reason(user: User) -> None:
    user.parameters().show_section("limits")
    settle()
    rise = "Pressure angle, rise"
    rows = shown_limits(user)
    assert rows[rise] == ("", "45", "typical where the follower swings")
    assert rows["Convex radius"] == ("", "75", "half the roller's radius")
    assert rows["Polar radius"][1:] == (
        "103.7",
        "a shaft of 115 mm transmits 7511 N·m at 25 MPa (assumed), and its hub is 1.8 times as wide",
    )
    assert rows["Concave radius"] == rows["Contact force"] == rows["Contact pressure"] == ("", "", "")
    user.enter("limits.pressure_angle_rise_deg", "30")
    settle()
    assert shown_limits(user)[rise] == ("30", "", "")
    user.enter("limits.pressure_angle_rise_deg", "")
    user.enter("cam.roller_radius_mm", "120")
    user.parameters().show_section("limits")
    settle()
    assert shown_limits(user)[rise] == ("", "45", "typical where the follower swings")
    assert shown_limits(user)["Convex radius"] == ("", "60", "half the roller's radius")
