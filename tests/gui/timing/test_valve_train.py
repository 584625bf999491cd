"""File > New by type > Valve train and Compo > Valve train: a cam card typed by keys, followed by both valves."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from window_user import Open, User, answering, settle, wait_for

from core.valves import valve_data, valve_timings
from kindyna_gui.valves.train_dialog import CENTRES, GRID, RATIO, ValveTrainDialog

NEW = ("File", "New by type", "Valve train...")
EDIT = ("Compo", "Valve train...")
LEFT = Qt.MouseButton.LeftButton
EXAMPLE = Path(__file__).parents[3] / "resources" / "examples" / "valve_train.toml"


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window()


def enter(dialog: ValveTrainDialog, valve: str, name: str, text: str) -> None:
    """Click into a box, choose what it holds, and type."""
    box = dialog.boxes[valve, name]
    QTest.mouseClick(box.lineEdit(), LEFT, pos=QPoint(5, 5))
    QTest.keyClick(box, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    QTest.keyClicks(box, text)
    settle()


def number(dialog: ValveTrainDialog, valve: str, name: str) -> float | None:
    return dialog.boxes[valve, name].number


def figures(dialog: ValveTrainDialog) -> dict[str, str]:
    """Figures of the inlet in the table of the card, by their words."""
    rows = dialog.figures.rows
    return {str(rows.data(rows.index(k, 0))): str(rows.data(rows.index(k, 1))) for k in range(rows.rowCount())}


def tab(dialog: ValveTrainDialog, times: int = 1) -> None:
    for _ in range(times):
        QTest.keyClick(dialog.focusWidget(), Qt.Key.Key_Tab)


def test_a_printed_card_becomes_two_valves_in_fifteen_actions(user: User) -> None:
    """A card: lift 10 mm, 276° at 0.1524 mm, 230° at 1.27 mm, separation 108° advanced by 4°, by keys alone."""
    actions = ["File", "New by type", "Valve train..."]
    before = user.session.full_design

    def act(dialog: ValveTrainDialog) -> None:
        def key(text: str, tabs: int) -> None:
            tab(dialog, tabs)
            QTest.keyClicks(dialog.focusWidget(), text)
            settle()
            actions.append(text)

        key("10", 0)
        key("276", 4)
        key("230", 4)
        key("108", 4 + len(GRID))  # past the exhaust, which has the lobe of the inlet
        key("4", 1)
        assert number(dialog, "inlet", "centre_deg") == 104.0
        assert number(dialog, "exhaust", "centre_deg") == 112.0
        assert "Overlap 60° at 0.1524 mm, 14° at 1.27 mm" in dialog.facts.text()
        for plot in dialog.plots:
            assert len(plot.lines) == 2
        crank, lift = dialog.plots[0].lines[0]
        assert crank[np.argmax(lift)] == 104.0
        wait_for(lambda: figures(dialog).get("Duration, lobe, 0.050 in") == "230.0°")
        assert {"Duration, valve, 1 mm", "Left to coil bind", "Float speed, engine", "Piston clearance"} <= set(
            figures(dialog)
        )
        QTest.keyClick(dialog.focusWidget(), Qt.Key.Key_Return)
        actions.append("Enter")

    with answering(ValveTrainDialog, act):
        user.choose(*NEW)
    assert len(actions) <= 15
    data = valve_data(valve_timings(user.session.full_design), (0.1524, 1.27))
    assert [valve["drive"] for valve in data["valves"]] == ["Inlet", "Exhaust"]
    assert [valve["centre_deg"] for valve in data["valves"]] == [104.0, -112.0]
    assert data["valves"][1]["events"][0]["duration_deg"] == pytest.approx(276.0, abs=1e-9)
    assert data["pairs"][0]["overlap"][0]["deg"] == pytest.approx(60.0, abs=1e-9)
    assert user.session.path is None
    user.choose("Edit", "Undo Begin with Valve train")
    assert user.session.full_design == before


def test_what_was_typed_last_drives_and_the_others_follow(user: User) -> None:
    """The printed cards of Piper, 23/67 = 270° at 112°, and 277° at 106.5° = 32/65, each way."""

    def act(dialog: ValveTrainDialog) -> None:
        enter(dialog, "inlet", "first_deg", "320")
        enter(dialog, "inlet", "second_near_tdc", "23")
        enter(dialog, "inlet", "second_near_bdc", "67")
        assert (number(dialog, "inlet", "second_deg"), number(dialog, "inlet", "centre_deg")) == (270.0, 112.0)
        assert [number(dialog, *place) for place in CENTRES] == [110.0, -2.0]
        enter(dialog, "inlet", "second_deg", "277")
        enter(dialog, "inlet", "centre_deg", "106.5")
        assert (number(dialog, "inlet", "second_near_tdc"), number(dialog, "inlet", "second_near_bdc")) == (32.0, 65.0)
        assert number(dialog, "exhaust", "second_deg") == 277.0, "it has the lobe of the inlet"
        assert dialog.same.isChecked()
        enter(dialog, "exhaust", "second_near_bdc", "70")
        assert not dialog.same.isChecked()
        enter(dialog, "exhaust", "second_near_tdc", "30")
        assert (number(dialog, "exhaust", "second_deg"), number(dialog, "exhaust", "centre_deg")) == (280.0, 110.0)
        assert number(dialog, "inlet", "second_deg") == 277.0
        QTest.mouseClick(dialog.same, LEFT, pos=QPoint(8, dialog.same.height() // 2))
        assert number(dialog, "exhaust", "second_deg") == 277.0
        assert number(dialog, "exhaust", "centre_deg") == 110.0
        dialog.reject()

    before = user.session.full_design
    with answering(ValveTrainDialog, act):
        user.choose(*NEW)
    assert user.session.full_design == before


def test_lifts_are_typed_in_inches_and_thousandths(user: User) -> None:
    def act(dialog: ValveTrainDialog) -> None:
        dialog.unit.setFocus()
        QTest.keyClick(dialog.unit, Qt.Key.Key_Down)
        assert dialog.unit.currentText() == "in"
        assert number(dialog, "inlet", "second_at_mm") == 0.05
        enter(dialog, "inlet", "lift_mm", "0.36")
        enter(dialog, "inlet", "lash_mm", "0.1 mm")
        assert dialog.card.inlet.lash_mm == pytest.approx(0.1, abs=1e-12)
        dialog.unit.setFocus()
        QTest.keyClick(dialog.unit, Qt.Key.Key_Down)
        assert number(dialog, "inlet", "second_at_mm") == 50.0
        enter(dialog, "inlet", "lift_mm", "0")
        assert list(dialog.message.buttons) == ["Back to 360 thou"]
        QTest.mouseClick(dialog.message.buttons["Back to 360 thou"], LEFT)
        assert number(dialog, "inlet", "lift_mm") == 360.0
        enter(dialog, "inlet", "first_at_mm", "8")
        assert dialog.accept_button.isEnabled()
        dialog.accept_button.click()

    with answering(ValveTrainDialog, act):
        user.choose(*NEW)
    motion = user.session.full_design.drives[1].motion
    assert motion is not None
    assert motion.lobe is not None
    assert motion.lobe.lift_mm == 9.144
    assert [row.at_mm for row in motion.lobe.duration] == [0.2032, 1.27]
    assert motion.lobe.ramp_mm == 0.12, "above the lash"


def test_a_value_without_a_lobe_is_refused_with_its_remedies(user: User) -> None:
    def act(dialog: ValveTrainDialog) -> None:
        enter(dialog, "inlet", "second_deg", "262")
        assert not dialog.accept_button.isEnabled()
        assert dialog.boxes["inlet", "second_deg"].is_refused
        assert "no lobe has it with the other values; allowed: 168.577 ... 246.428" in dialog.message.text()
        assert "Exhaust" not in dialog.message.text()
        wait_for(lambda: "Use 246.4°" in dialog.message.buttons)
        QTest.mouseClick(dialog.message.buttons["Back to 218°"], LEFT)
        settle()
        assert number(dialog, "inlet", "second_deg") == 218.0
        assert dialog.message.text() == ""
        assert dialog.accept_button.isEnabled()
        enter(dialog, "inlet", "second_deg", "262")
        wait_for(lambda: "Use 246.4°" in dialog.message.buttons)
        QTest.mouseClick(dialog.message.buttons["Use 246.4°"], LEFT)
        settle()
        assert number(dialog, "exhaust", "second_deg") == 246.4
        assert not dialog.boxes["inlet", "second_deg"].is_refused
        enter(dialog, "inlet", "centre_deg", "400")
        assert not dialog.accept_button.isEnabled()
        assert "outside its range" in dialog.message.text()
        assert list(dialog.message.buttons) == ["Use 360°", "Back to 108°"]
        QTest.mouseClick(dialog.message.buttons["Back to 108°"], LEFT)
        settle()
        assert dialog.accept_button.isEnabled()
        dialog.accept_button.click()

    with answering(ValveTrainDialog, act):
        user.choose(*NEW)
    assert user.session.full_design.drives[0].motion.lobe.duration[1].crank_deg == 246.4  # type: ignore[union-attr]


def test_a_valve_train_is_edited_by_its_card_in_one_step(user: User) -> None:
    user.choose(*EDIT)
    assert "no inlet and exhaust valve" in user.window.status.currentMessage()
    with answering(ValveTrainDialog, lambda dialog: dialog.accept_button.click()):
        user.choose(*NEW)
    created = user.session.full_design
    steps = len(user.steps)

    def act(dialog: ValveTrainDialog) -> None:
        assert not dialog.pictures
        assert dialog.same.isChecked()
        dialog.boxes[CENTRES[0]].setFocus()
        dialog.boxes[CENTRES[0]].selectAll()
        QTest.keyClicks(dialog.boxes[CENTRES[0]], "110")
        QTest.keyClick(dialog.boxes[CENTRES[0]], Qt.Key.Key_Return)

    with answering(ValveTrainDialog, act):
        user.choose(*EDIT)
    assert [valve.centre for valve in valve_timings(user.session.full_design)] == [110.0, -110.0]
    assert len(user.steps) == steps + 1
    user.choose("Edit", "Undo Change the valve train")
    assert user.session.full_design == created


@pytest.mark.parametrize("section", ["engine", "valve", "motion"])
def test_a_button_of_the_form_opens_the_card(user: User, section: str) -> None:
    user.session.open(EXAMPLE)
    view = user.parameters()
    view.show_section(section)
    settle()
    page = view.pages[section]
    button = page.header.card_button if section == "motion" else page.button
    assert button.text() == "Edit valve train..."

    def act(dialog: ValveTrainDialog) -> None:
        enter(dialog, "inlet", "centre_deg", "105")
        assert dialog.accept_button.isEnabled()
        dialog.accept_button.click()

    with answering(ValveTrainDialog, act):
        QTest.mouseClick(button, LEFT)
    assert user.session.full_design.drives[0].valve.centre_deg == 105.0  # type: ignore[union-attr]
    assert user.steps[-1] == "Change the valve train"


def test_the_motion_table_of_a_lobe_opens_the_card(user: User) -> None:
    user.session.open(EXAMPLE)
    button = user.motion().header.card_button
    assert button.isVisible()
    with answering(ValveTrainDialog, lambda dialog: dialog.reject()):
        QTest.mouseClick(button, LEFT)


def test_a_pushrod_train_is_chosen_by_its_picture_and_opens_by_its_ratio(user: User) -> None:
    """A lobe of 7 mm and a ratio of 1.6 open the valve by about 11.2 mm; the arm of the pad is 1.6 times the push arm."""

    def act(dialog: ValveTrainDialog) -> None:
        assert [button.text() for button in dialog.pictures.values()] == ["Direct", "Finger", "Rocker", "Pushrod"]
        assert not dialog.boxes[RATIO].isVisible(), "a direct train has none"
        assert not any(button.icon().isNull() for button in dialog.pictures.values())
        QTest.mouseClick(dialog.pictures["finger"], LEFT)
        settle()
        assert dialog.of.currentText() == "valve"
        assert max(dialog.plots[0].lines[0][1]) == pytest.approx(9.0, abs=1e-9), "of the valve, whatever the ratio"
        QTest.mouseClick(dialog.pictures["pushrod"], LEFT)
        settle()
        assert dialog.of.currentText() == "lobe"
        assert dialog.boxes[RATIO].number == 1.5
        enter(dialog, "inlet", "lift_mm", "7")
        enter(dialog, *RATIO, "1.6")
        _, lift = dialog.plots[0].lines[0]
        assert lift.max() == pytest.approx(11.2, rel=0.02)
        enter(dialog, *RATIO, "0")
        assert dialog.cover.text == "The last valve train that was possible"
        assert list(dialog.message.buttons)[-1] == "Back to 1.5"
        QTest.mouseClick(dialog.message.buttons["Back to 1.5"], LEFT)
        settle()
        assert dialog.cover.text == ""
        enter(dialog, *RATIO, "1.6")
        QTest.mouseClick(dialog.accept_button, LEFT)

    with answering(ValveTrainDialog, act):
        user.choose(*NEW)
    followers: list[Any] = [drive.follower for drive in user.session.full_design.drives]
    assert [follower.pad_mm / follower.push_arm_mm for follower in followers] == pytest.approx([1.6, 1.6], rel=1e-9)
    assert [drive.motion.lobe.lift_mm for drive in user.session.full_design.drives] == [7.0, 7.0]  # type: ignore[union-attr]


# -- lobes by other values --------------------------------------------------------------------------------------


def test_a_velocity_typed_last_drives_and_a_duration_follows(user: User) -> None:
    def act(dialog: ValveTrainDialog) -> None:
        assert number(dialog, "inlet", "velocity_mm_per_deg") == pytest.approx(0.2100183, abs=1e-6)
        enter(dialog, "inlet", "velocity_mm_per_deg", "0.213")
        assert number(dialog, "inlet", "second_deg") == 218.0
        first = number(dialog, "inlet", "first_deg")
        assert first is not None
        assert first != 268.0
        near, far = (number(dialog, "inlet", f"first_near_{centre}") for centre in ("tdc", "bdc"))
        assert near is not None
        assert far is not None
        assert near + far + 180.0 == pytest.approx(first, abs=1e-6)
        assert number(dialog, "exhaust", "first_deg") == first, "it has the lobe of the inlet"
        assert max(dialog.plots[1].lines[0][1]) == pytest.approx(0.213, rel=1e-3)
        dialog.accept_button.click()

    with answering(ValveTrainDialog, act):
        user.choose(*NEW)
    lobe: Any = user.session.full_design.drives[1].motion.lobe  # type: ignore[union-attr]
    assert [(row.at_mm, row.crank_deg) for row in lobe.duration] == [(1.27, 218.0)]
    assert lobe.velocity_mm_per_deg == 0.213

    def again(dialog: ValveTrainDialog) -> None:
        assert number(dialog, "inlet", "velocity_mm_per_deg") == 0.213
        enter(dialog, "inlet", "centre_deg", "106")
        dialog.accept_button.click()

    with answering(ValveTrainDialog, again):
        user.choose(*EDIT)
    assert user.session.full_design.drives[0].motion.lobe == lobe  # type: ignore[union-attr]
    assert user.session.full_design.drives[0].valve.centre_deg == 106.0  # type: ignore[union-attr]


def test_a_lobe_with_another_closing_side_is_shown_and_kept(user: User, tmp_path: Path) -> None:
    text = EXAMPLE.read_text(encoding="utf-8")
    plain = "ramp_mm = 0.2, ramp_runup_deg = 8.0 }"
    closing = "ramp_mm = 0.2, ramp_runup_deg = 8.0, closing = { ramp_mm = 0.25, ramp_mm_per_deg = 0.007, to_nose = [[1.27, 108.0]] } }"
    (tmp_path / "closing.toml").write_text(text.replace(plain, closing, 1), encoding="utf-8")
    user.session.open(tmp_path / "closing.toml")
    before: Any = user.session.full_design.drives[0].motion

    def act(dialog: ValveTrainDialog) -> None:
        assert number(dialog, "inlet", "second_near_bdc") == pytest.approx(108.0 + 108.0 - 180.0, abs=1e-6)
        assert number(dialog, "inlet", "second_near_tdc") == pytest.approx(105.0 - 108.0, abs=1e-6)
        assert number(dialog, "inlet", "second_deg") == pytest.approx(213.0, abs=1e-6)
        assert not dialog.boxes["inlet", "second_deg"].isEnabled()
        assert "page Motion" in dialog.boxes["inlet", "second_deg"].toolTip()
        assert dialog.boxes["exhaust", "second_deg"].isEnabled()
        enter(dialog, "inlet", "centre_deg", "104")
        assert dialog.accept_button.isEnabled()
        dialog.accept_button.click()

    with answering(ValveTrainDialog, act):
        user.choose(*EDIT)
    assert user.session.full_design.drives[0].motion == before
    assert user.session.full_design.drives[0].valve.centre_deg == 104.0  # type: ignore[union-attr]


def test_a_refused_duration_is_said_in_the_numbers_of_the_card(user: User) -> None:
    """The lifts of the card are those of the lobe, in inches; the motion is the valve's, in mm."""

    def act(dialog: ValveTrainDialog) -> None:
        dialog.unit.setCurrentIndex(dialog.unit.findText("in"))
        shown = dialog.boxes["exhaust", "first_at_mm"].text()
        assert shown.startswith("0.0031")
        enter(dialog, "exhaust", "second_deg", "300")
        text = dialog.message.text()
        assert text == f"Exhaust, duration, second lift 300°: not less than at {shown} in; allowed: < 266°"
        dialog.reject()

    user.session.open(EXAMPLE)
    with answering(ValveTrainDialog, act):
        user.choose(*EDIT)


def test_the_texts_of_the_card_have_one_line_each_in_a_small_window(user: User) -> None:
    def act(dialog: ValveTrainDialog) -> None:
        dialog.resize(1000, 700)
        wait_for(lambda: dialog.figures.rows.rowCount() > 5)
        line = dialog.facts.fontMetrics().height()
        assert dialog.facts.height() < 2.9 * line, "overlap and its area"
        heights = {dialog.figures.rowHeight(k) for k in range(dialog.figures.rows.rowCount())}
        assert max(heights) < 1.9 * line
        dialog.reject()

    user.session.open(EXAMPLE)
    with answering(ValveTrainDialog, act):
        user.choose(*EDIT)
