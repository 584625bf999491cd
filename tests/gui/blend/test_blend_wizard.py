"""kindyna_gui.blend: Yang's questions in a window, answered while they are typed."""

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import fsum
from typing import Any

import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, with_drive
from plot_reading import curves
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QStyle, QStyleOptionSpinBox, QWidget
from sampled import spread
from window_user import Open, User, settle, wait_for

from core.blend import BlendError, Request, SettingRange, best, blend, feasible_ranges
from core.blend.best import with_blend
from core.design import Design, Motion, NamedCurve, Segment, edited, faults, require_motion, with_motion
from core.number_text import NARROW_SPACE
from core.output.drawing.palette import FAMILIES
from core.project import load
from core.study import Study
from kindyna_gui.blend import wizard as blend_wizard
from kindyna_gui.blend.questions import GOAL_TEXTS, Questions
from kindyna_gui.blend.request import (
    constants,
    count_text,
    first_request,
    initial_value,
    open_candidates,
    plan,
    range_request,
    range_text,
    shown_names,
)
from kindyna_gui.blend.settings import LiveBox, curve_of
from kindyna_gui.blend.wizard import BlendDialog
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.places import example

PICKER_SPANS = (18.8468353936, 169.621518543, 14.8022699040, 96.7293761598)
STANDING = with_drive(PUSHER, motion=Motion(0.0, (Segment(360.0, 0.0),)))
PICKER = load(example("card_picker"))


def wish(kind: str = "DRRD", constant: str = "none", **more: Any) -> Request:
    """A request over the angles of the card picker."""
    return Request(kind, 20.0, 30.0, 330.0, constant, **more)


class Wizard:
    """A user of the wizard."""

    def __init__(self, dialog: BlendDialog, session: Session) -> None:
        self.dialog, self.session, self.questions = dialog, session, dialog.questions
        self.rows = dialog.questions.settings.rows

    def answered(self) -> None:
        """Wait for the motion; ranges may still be missing."""
        QApplication.processEvents()
        wait_for(lambda: not self.dialog.is_solving)

    def ranged(self, *names: str) -> None:
        """Wait for the ranges of these settings."""
        QApplication.processEvents()
        wait_for(lambda: not self.dialog.ranges.busy)

    def click(self, widget: QWidget, where: QPoint | None = None) -> None:
        QTest.mouseClick(widget, Qt.MouseButton.LeftButton, pos=widget.rect().center() if where is None else where)
        QApplication.processEvents()

    def tick(self, name: str) -> None:
        """Click the box of a setting."""
        self.click(self.rows[name].check, QPoint(8, self.rows[name].check.height() // 2))

    def arrow(self, box: LiveBox, up: bool, times: int = 1) -> None:
        """Click one of the arrows of a box."""
        option = QStyleOptionSpinBox()
        box.initStyleOption(option)
        part = QStyle.SubControl.SC_SpinBoxUp if up else QStyle.SubControl.SC_SpinBoxDown
        where = box.style().subControlRect(QStyle.ComplexControl.CC_SpinBox, option, part, box).center()
        for _ in range(times):
            self.click(box, where)

    def type(self, box: LiveBox, text: str) -> None:
        """Type over what stands in a box, without Enter."""
        box.setFocus()
        box.selectAll()
        QTest.keyClicks(box, text)
        QApplication.processEvents()

    def give(self, **settings: str) -> None:
        """Tick and type these settings and wait for the motion."""
        for name, text in settings.items():
            if not self.rows[name].is_used:
                self.tick(name)
            self.type(self.rows[name].box, text)
        self.answered()

    def choose(self, box: WordBox, text: str) -> None:
        """Walk down the list of a box with the keys."""
        box.setFocus()
        QTest.keyClick(box, Qt.Key.Key_Home)
        for _ in range(box.count()):
            if box.currentText() == text:
                break
            QTest.keyClick(box, Qt.Key.Key_Down)
        assert box.currentText() == text
        self.answered()

    @property
    def curves(self) -> str:
        return self.dialog.panel.headline.text()

    @property
    def veiled(self) -> str:
        return self.dialog.panel.cover.text if self.dialog.panel.cover.isVisible() else ""

    @property
    def can_put(self) -> bool:
        return self.dialog.put_button.isEnabled()

    @property
    def table(self) -> list[tuple[str, ...]]:
        return [row.cells for row in self.dialog.panel.table.rows.rows]

    @property
    def titles(self) -> list[str]:
        """Of the table's columns."""
        rows = self.dialog.panel.table.rows
        return [rows.headerData(i, Qt.Orientation.Horizontal) for i in range(rows.columnCount())]

    def put(self) -> Motion:
        """Click the button and return the motion of the design."""
        assert self.can_put
        self.click(self.dialog.put_button)
        assert self.dialog.result() == BlendDialog.DialogCode.Accepted
        return self.session.design.drive.motion


Ask = Callable[..., Wizard]


@pytest.fixture
def ask(app: QApplication, monkeypatch: pytest.MonkeyPatch) -> Iterator[Ask]:
    """Opens the wizard over a design, without a window. ranges False: without them, where a test has no eyes for them."""
    opened: list[BlendDialog] = []

    def open(design: Design = STANDING, segment: int = 0, ranges: bool = False) -> Wizard:
        if not ranges:
            monkeypatch.setattr(blend_wizard, "feasible_ranges", lambda *_: [])
        session = Session(design)
        session.choose_segment(segment)
        dialog = BlendDialog(session)
        dialog.resize(1180, 740)
        opened.append(dialog)
        dialog.show()
        dialog.activateWindow()
        assert QTest.qWaitForWindowActive(dialog)
        wizard = Wizard(dialog, session)
        wizard.answered()
        return wizard

    yield open
    for dialog in opened:
        dialog.reject()
        dialog.deleteLater()
    settle()


# -- what is asked, without a window ----------------------------------------------------------------------


def test_a_motion_that_stands_still_is_asked_for_the_card_pickers_angles() -> None:
    asked = first_request(STANDING.drive.motion, 0)
    assert (asked.type, asked.stroke, asked.start, asked.end, asked.constant) == ("DRRD", 20.0, 30.0, 330.0, "none")
    assert asked == Request("DRRD", 20.0, 30.0, 330.0, settings={})


@pytest.mark.parametrize("name", ["card_picker", "card_picker_peak_250"])
def test_a_blend_is_asked_for_as_it_is(name: str) -> None:
    """Requested anew, the same curves come out."""
    motion = load(example(name)).drive.motion
    for chosen in range(len(motion.segments)):
        asked = first_request(motion, chosen)
        assert (asked.type, asked.constant, asked.sequence) == ("DRRD", "rise", "")
        made = blend(asked).segments
        assert [s.curve for s in made] == [s.curve for s in motion.segments[1:-1]]
        for one, other in zip(made, motion.segments[1:-1], strict=True):
            assert one.span_deg == pytest.approx(other.span_deg, abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "constant", "given", "mirrored"),
    [
        ("DRD", "rise", {"h1": 2.0, "h3": 7.0}, None),
        ("DRD-return", "return", {"h1": 2.0, "h3": 7.0}, None),
        ("DRRD", "rise", {"h1": 2.0, "h3": 3.0, "h4": 5.0}, None),
        ("DRRD", "both", {"h1": 2.0, "h3": 3.0, "h4": 4.0, "h6": 1.0}, False),
        ("DRRD", "return", {"h4": 2.0, "h6": 3.0}, None),
        ("RRR", "none", {"h1": 4.0}, None),
    ],
)
def test_every_kind_of_blend_is_asked_for_as_it_is(
    kind: str, constant: str, given: dict[str, float], mirrored: bool | None
) -> None:
    whole = (0.0, 360.0) if kind == "RRR" else (30.0, 300.0)
    made = blend(Request(kind, 20.0, *whole, constant, given, mirrored=mirrored))
    design = with_blend(STANDING, made)
    first = next(i for i, s in enumerate(design.drive.motion.segments) if s in made.segments)
    asked = first_request(design.drive.motion, first)
    assert (asked.type, asked.constant, asked.start, asked.end) == (kind, constant, *whole)
    again = blend(asked)
    assert again.curves == made.curves
    assert [s.span_deg for s in again.segments] == pytest.approx([s.span_deg for s in made.segments], abs=1e-6)


def test_of_several_strokes_the_chosen_one_is_asked_for() -> None:
    motion = LIFT.drive.motion
    rise = first_request(motion, 3)
    assert (rise.type, rise.stroke, rise.start, rise.end) == ("DRD", 150.0, 283.5, 325.0)
    for chosen in (0, 1, 4):
        fall = first_request(motion, chosen)
        assert (fall.type, fall.stroke, fall.start, fall.end) == ("DRD-return", 150.0, 35.0, 76.5)
    up_down_up = Motion(
        0.0,
        tuple(Segment(b, h, NamedCurve("cycloidal")) for b, h in ((90.0, 10.0), (90.0, -20.0), (180.0, 10.0))),
    )
    asked = first_request(up_down_up, 1)
    assert (asked.type, asked.stroke, asked.start, asked.end) == ("DRD-return", 20.0, 90.0, 180.0)
    unequal = Motion(0.0, (*(Segment(90.0, h, NamedCurve("cycloidal")) for h in (20.0, -15.0)), Segment(180.0, -5.0)))
    unequal = replace(
        unequal, segments=(*unequal.segments[:2], Segment(90.0, 0.0), Segment(90.0, -5.0, NamedCurve("3-4-5")))
    )
    asked = first_request(unequal, 0)
    assert (asked.type, asked.stroke, asked.return_stroke) == ("DRRD", 20.0, 15.0)


MORE = "tick one more, or optimise the rest"


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        (wish(), "P1-P2 requires no setting; tick any for other curves"),
        (wish(constant="rise"), "C1-CV1-H2-P2 requires 2 settings, 0 given: tick two, or optimise the rest"),
        (wish(constant="rise", settings={"h1": 1.0}), "C1-CV1-H2-P2 requires 2 settings, 1 given: " + MORE),
        (wish(constant="rise", settings={"h1": 1.0, "h3": 1.0}), "C1-CV1-H2-P2 requires 2 settings: given"),
        (wish(constant="rise", settings={"h1": 1.0, "h4": 1.0}), "C1-CV1-H2-H3-C4 requires 3 settings, 2 given: " + MORE),
        (
            wish(constant="rise", settings=dict.fromkeys(("h1", "h2", "h3", "h4"), 1.0)),
            "4 settings given, 3 possible: untick one",
        ),
        (
            wish(constant="rise", settings={"length": 150.0}),
            "1 setting given; the rest is optimised for the least jerk",
        ),
        (wish(constant="rise", settings={"h1": 1.0}, points=((90.0, 5.0),)), "C1-CV1-H2-P2 requires 2 settings: given"),
    ],
)  # fmt: skip
def test_how_many_settings_are_missing(asked: Request, told: str) -> None:
    assert count_text(asked, "jerk" if told.endswith("jerk") else "") == told


def test_settings_that_mean_nothing_are_not_asked_for() -> None:
    rise = ["h1", "h2", "h3", "vcv", "length", "flat1", "flat3", "acceleration", "point"]
    assert shown_names(wish("DRD", "rise")) == rise
    assert shown_names(wish("DRD-return", "return")) == rise, "a return alone counts from 1"
    assert shown_names(wish("DRD", "none")) == ["h1", "h3", "vcv", "flat1", "flat3", "acceleration", "point"]
    assert "peak" in shown_names(wish("DRRD", "rise"))
    assert "a1" in shown_names(wish("DRD", "rise", settings={"flat1": 10.0})), "its size once there is a span"
    assert "h4" not in shown_names(wish("DRRD", "rise", sequence="C1-CV1-H2-P2"))
    assert shown_names(wish("DRRD", "none", sequence="P1-P2")) == []
    for kind in ("DRD", "DRD-return", "DRRD", "RRR"):
        for constant in constants(kind):
            for row in open_candidates(wish(kind, constant)):
                names = shown_names(wish(kind, constant, sequence=str(row.sequence), mirrored=row.family.mirrored))
                assert bool(names) == bool(row.freedom)


def test_ranges_are_those_of_the_sequence_that_is_meant() -> None:
    asked = wish(constant="rise", settings={"h1": 1.0})
    assert range_request(asked).sequence == "C1-CV1-H2-P2"
    assert range_request(replace(asked, settings={"h1": 1.0, "h3": 1.0})).sequence == ""
    target = plan(asked).target
    assert target is not None
    assert (str(target.sequence), target.freedom) == ("C1-CV1-H2-P2", 2)


def test_ranges_as_text() -> None:
    assert range_text([SettingRange(0.0, 19.0, True, False)], "h1") == "0 < h1 ≤ 19"
    assert range_text([SettingRange(-4e-15, 20.0, True, True)], "h2") == "0 < h2 < 20"
    assert range_text([SettingRange(0.0114386640233, np.inf, False, True)], "a") == "a ≥ 0.011439"
    assert range_text([SettingRange(0.0, 18.999999999999, True, False)], "h1") == "0 < h1 ≤ 19"
    assert range_text([SettingRange(0.0, 18.99999, True, False)], "h1") == "0 < h1 ≤ 18.999"
    assert range_text([SettingRange(1.0, 2.0), SettingRange(3.0, 4.0)], "h1") == "1 ≤ h1 ≤ 2 or 3 ≤ h1 ≤ 4"
    assert range_text([SettingRange(18.0, 18.0)], "h2") == "= 18, determined by the other settings"
    assert range_text([], "h2") == "no feasible value"


@pytest.mark.parametrize("name", ["h3", "vcv", "length", "peak", "acceleration"])
def test_an_end_that_belongs_to_the_range_can_be_typed(name: str) -> None:
    request = wish(constant="rise", settings={"h1": 1.3}, sequence="C1-CV1-H2-P2")
    ranges = feasible_ranges(request, name)
    words = range_text(ranges, "x").split()
    reached = [words[i + (1 if words[i - 1] == "x" else -1)] for i, word in enumerate(words) if word in ("≤", "≥")]
    for text in reached:
        assert blend(replace(request, settings={"h1": 1.3, name: float(text)}))


def test_a_setting_begins_inside_of_its_range() -> None:
    assert initial_value([SettingRange(0.0, 20.0, True, True)], 0.1) == 2.0
    assert initial_value([SettingRange(0.0, 300.0, True, True)], 0.5) == pytest.approx(200.0, abs=50.0)
    assert initial_value([SettingRange(151.9, 154.1)], 0.5) == 153.0
    assert initial_value([SettingRange(5.0, 5.0)], 0.5) == 5.0
    assert initial_value([SettingRange(0.01, np.inf, False, True)], 0.3) == pytest.approx(0.03)
    assert initial_value([], 0.3) is None


def test_settings_are_named_after_their_curve() -> None:
    rise, back = ("C1", "CV1", "H2"), ("H3", "C4")
    assert [curve_of(n, rise, back) for n in ("h1", "h2", "h3", "h4", "h5", "h6", "vcv")] == [
        "C1",
        "CV1",
        "H2",
        "H3",
        "",
        "C4",
        "rise",
    ]
    assert [curve_of(n, (), ("C3", "CV2", "C4")) for n in ("h1", "h2", "h3", "vcv")] == ["C3", "CV2", "C4", ""]


# -- the card picker --------------------------------------------------------------------------------------


def check_picker(motion: Motion) -> None:
    assert [s.curve.law for s in motion.segments] == ["dwell", "c1", "cv1", "h2", "p2", "dwell"]
    assert [s.span_deg for s in motion.segments] == pytest.approx([30.0, *PICKER_SPANS, 30.0], abs=1e-9)
    assert [s.rise for s in motion.segments] == pytest.approx([0.0, 1.0, 18.0, 1.0, -20.0, 0.0], abs=1e-12)


@pytest.mark.stress
def test_the_card_picker_is_designed_with_the_keys_alone(ask: Ask) -> None:
    wizard = ask()
    dialog = wizard.dialog

    def press(key: Qt.Key, modifier: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier) -> None:
        target = QApplication.focusWidget()
        assert target is not None
        QTest.keyClick(target, key, modifier)
        QApplication.processEvents()

    def tab_to(widget: QWidget) -> None:
        for _ in range(60):
            if QApplication.focusWidget() is widget:
                return
            press(Qt.Key.Key_Tab)
        raise AssertionError("the keys do not lead there")

    assert QApplication.focusWidget() is wizard.questions.kind.types["DRRD"]
    tab_to(wizard.questions.kind.constants["none"])
    press(Qt.Key.Key_Right)
    assert wizard.questions.kind.constant == "rise"
    for name in ("h1", "h3"):
        tab_to(wizard.rows[name].check)
        press(Qt.Key.Key_Space)
        assert QApplication.focusWidget() is wizard.rows[name].box, "what is ticked can be typed at once"
        QTest.keyClicks(QApplication.focusWidget(), "1")
        press(Qt.Key.Key_Return)
        assert dialog.isVisible(), "Enter confirms the number, not the motion"
    wizard.answered()
    press(Qt.Key.Key_P, Qt.KeyboardModifier.AltModifier)  # the button is seen to go down
    wait_for(lambda: dialog.result() == BlendDialog.DialogCode.Accepted)
    check_picker(wizard.session.design.drive.motion)


def test_the_peak_at_250_degrees(ask: Ask) -> None:
    wizard = ask(PICKER)
    assert wizard.rows["h1"].is_used
    assert wizard.rows["h3"].is_used, "the motion in place is asked anew"
    wizard.tick("h3")
    wizard.give(peak="250")
    assert [row[2] for row in wizard.table] == ["20.6323", "190.1190", "9.2487", "80.0000"]
    motion = wizard.put()
    assert fsum(s.span_deg for s in motion.segments[:4]) == pytest.approx(250.0, abs=1e-9)


# -- live -------------------------------------------------------------------------------------------------


def test_every_keystroke_is_answered(ask: Ask) -> None:
    wizard = ask(PICKER)
    box = wizard.rows["h1"].box
    seen = []
    box.setFocus()
    box.selectAll()
    for key in "2.5":
        QTest.keyClicks(box, key)
        wizard.answered()
        seen.append(wizard.table[0][1])
    assert seen == ["2.0000", "2.0000", "2.5000"]
    assert box.is_typing, "without Enter"
    asked = wizard.questions.request()
    assert list(asked.settings.items()) == [("h1", 2.5), ("h3", 1.0)]
    expected = blend(asked)
    assert [float(row[2]) for row in wizard.table] == pytest.approx([s.span_deg for s in expected.segments], abs=6e-5)
    QTest.keyClick(box, Qt.Key.Key_Escape)
    wizard.answered()
    assert wizard.dialog.isVisible(), "Escape takes back what was typed first"
    assert wizard.table[0][1] == "1.0000"


def test_only_the_last_of_several_keystrokes_counts(ask: Ask) -> None:
    wizard = ask(PICKER)
    box = wizard.rows["h3"].box
    wizard.type(box, "12.34")
    wizard.answered()
    assert wizard.table[2][1] == "12.3400"


def test_the_ranges_follow_what_is_typed(ask: Ask) -> None:
    wizard = ask(PICKER, ranges=True)
    wizard.ranged("h1", "h3")
    assert wizard.rows["h1"].range.text() == "0 < h1 ≤ 19"
    wizard.type(wizard.rows["h3"].box, "5")
    wizard.ranged("h1", "h3")
    assert wizard.rows["h1"].range.text() == "0 < h1 ≤ 15"
    assert wizard.rows["h3"].range.text() == "0 < h3 ≤ 19"
    wizard.tick("h3")
    wizard.ranged("h3", "vcv", "length", "peak")
    told = {name: wizard.rows[name].range.text() for name in ("h3", "vcv", "length", "peak")}
    assert told == {
        "h3": "0 < h3 ≤ 19",
        "vcv": "0.07 < Vcv ≤ 0.25529",
        "length": "0 ≤ length < 271.43",
        "peak": "154.74 ≤ peak < 330",
    }


def test_a_wish_that_cannot_be_met_says_what_could_be(ask: Ask) -> None:
    wizard = ask(PICKER, ranges=True)
    before, row = wizard.table, wizard.rows["h3"]
    wizard.type(row.box, "25")
    wizard.answered()
    assert row.message.isVisible()
    assert row.message.text() == "h3 = 25 mm is not feasible with h1 = 1; feasible: 0 < h3 ≤ 19 mm"
    assert row.box.is_refused
    wizard.ranged("h3")
    assert list(row.message.buttons) == ["Use 19 mm", "Back to 1 mm", "Leave it open"]
    assert not wizard.rows["h1"].message.isVisible()
    assert not wizard.can_put
    assert not wizard.dialog.copy.isEnabled()
    assert wizard.veiled == "The last feasible motion"
    assert wizard.table == before, "the last good answer stays"
    wizard.dialog.accept()
    assert wizard.session.design == PICKER
    wizard.click(row.message.buttons["Use 19 mm"])
    wizard.answered()
    assert row.box.number == 19.0
    assert not row.message.isVisible()
    assert not row.box.is_refused
    assert wizard.veiled == ""
    assert wizard.can_put
    assert wizard.dialog.copy.isEnabled()


def test_what_is_no_number_or_out_of_range_is_told_beside_it(ask: Ask) -> None:
    wizard = ask(PICKER)
    questions, rows = wizard.questions, wizard.rows
    wizard.type(rows["h1"].box, "-2")
    assert rows["h1"].message.text() == "Outside its range; allowed: > 0 mm, not −2 mm"
    wizard.type(rows["h1"].box, "two")
    assert rows["h1"].message.text() == "Enter a number, such as 12.5"
    assert not wizard.can_put
    wizard.type(rows["h1"].box, "1")
    wizard.type(questions.stroke, "0")
    assert questions.size_faults[0].text() == (
        f"Outside its range; allowed: above 0 ... 1{NARROW_SPACE}000{NARROW_SPACE}000{NARROW_SPACE}000 mm, not 0 mm"
    )
    assert questions.stroke.is_refused
    wizard.type(questions.stroke, "20")
    wizard.type(questions.end, "20")
    assert questions.size_faults[1].text() == "The end must be at least 0.001° after the start, not at 20°"
    wizard.type(questions.end, "400")
    assert questions.size_faults[1].text() == "Outside its range; allowed: 0 ... 360 °, not 400°"
    for beyond_any_step in ("1e-200", "1e200"):
        wizard.type(questions.stroke, beyond_any_step)
        wizard.type(questions.end, "1e200")
        assert questions.size_faults[1].text().startswith("Outside its range; allowed: 0 ... 360 °, not 1")
    wizard.type(questions.stroke, "20")
    wizard.type(questions.end, "330")
    wizard.answered()
    assert not any(words.isVisible() for words in questions.size_faults)
    assert wizard.can_put


def test_a_refused_size_has_buttons_and_gives_no_command(ask: Ask) -> None:
    wizard = ask(PICKER)
    questions, copy = wizard.questions, wizard.dialog.copy
    strokes, angles = questions.size_faults
    stroke, end = questions.stroke.number, questions.end.number
    assert copy.isEnabled()
    for box, line, text, remedies, number in (
        (questions.stroke, strokes, "0", ["Back to 20 mm"], stroke),
        (questions.end, angles, "400", ["Use 360°", f"Back to {end:g}°"], 360.0),
        (questions.end, angles, "5e", [f"Back to {end:g}°"], end),
        (questions.start, angles, "-1", ["Use 0°", "Back to 30°"], 0.0),
        (questions.end, angles, "0", ["Use 30.001°", f"Back to {end:g}°"], 30.001),
    ):
        before = box.text()
        wizard.type(box, text)
        assert list(line.buttons) == remedies
        assert (box.text(), box.is_refused, copy.isEnabled(), wizard.can_put) == (text, True, False, False)
        wizard.click(line.buttons[remedies[0]])
        wizard.answered()
        assert (box.number, line.isVisible(), box.is_refused) == (number, False, False)
        wizard.type(box, before)
        QTest.keyClick(box, Qt.Key.Key_Return)
        wizard.answered()
        assert (copy.isEnabled(), wizard.can_put) == (True, True)


def test_no_constant_velocity_is_the_end_of_its_range(ask: Ask) -> None:
    wizard = ask(PICKER, ranges=True)
    wizard.tick("h1")
    wizard.tick("h2")
    wizard.ranged("h2")
    assert wizard.rows["h2"].range.text() == "0 ≤ h2 < 19"
    wizard.type(wizard.rows["h2"].box, "0")
    wizard.answered()
    assert [cells[0] for cells in wizard.table] == ["C1", "H2", "P2"]
    assert wizard.can_put
    wizard.type(wizard.rows["h2"].box, "-1")
    assert wizard.rows["h2"].message.text() == "Outside its range; allowed: ≥ 0 mm, not −1 mm"
    assert not wizard.can_put


def test_missing_and_surplus_settings_are_counted(ask: Ask) -> None:
    wizard = ask()
    wizard.click(wizard.questions.kind.constants["rise"], QPoint(8, 8))
    wizard.answered()
    assert wizard.questions.count.text().startswith("C1-CV1-H2-P2 requires 2 settings, 0 given")
    assert wizard.veiled == "2 more to set"
    assert not wizard.can_put
    wizard.give(h1="1")
    assert wizard.veiled == "1 more to set"
    wizard.give(h3="1")
    assert wizard.veiled == ""
    assert wizard.can_put
    wizard.choose(wizard.questions.sequence, "C1-CV1-H2-P2   2 settings")
    wizard.give(length="100")
    assert wizard.questions.count.text() == "3 settings given, 2 possible: untick one"
    assert wizard.veiled == "1 too many set"
    wizard.choose(wizard.questions.sequence, "C1-CV1-H2-H3-C4   3 settings")
    assert wizard.curves == "C1–CV1–H2–H3–C4"
    assert wizard.veiled == ""


def test_the_curves_can_be_chosen(ask: Ask) -> None:
    wizard = ask()
    box = wizard.questions.sequence
    texts = [box.itemText(i) for i in range(box.count())]
    assert texts[0] == "selected by the settings"
    assert texts[1:] == [
        "P1-P2   no settings",
        "C1-H2-P2   1 setting",
        "P1-H3-C4   1 setting",
        "C1-H2-H3-C4, return mirrored   1 setting",
        "C1-H2-H3-C4   2 settings",
    ]
    wizard.give(h1="4")
    assert wizard.curves == "C1–H2–P2"
    wizard.choose(box, "C1-H2-H3-C4, return mirrored   1 setting")
    assert wizard.curves == "C1–H2–H3–C4"
    assert wizard.table[0][2] == wizard.table[3][2], "mirrored"
    wizard.click(wizard.questions.kind.types["RRR"])
    wizard.answered()
    assert box.currentIndex() == 0, "which RRR does not know"


@pytest.mark.parametrize("goal", spread(["acceleration", "torque"], 1))
def test_what_is_left_is_chosen_by_a_goal(goal: str, ask: Ask) -> None:
    wizard = ask()
    wizard.click(wizard.questions.kind.types["DRD"])
    wizard.click(wizard.questions.kind.constants["rise"], QPoint(8, 8))
    wizard.give(length="150")
    wizard.choose(wizard.questions.goal, GOAL_TEXTS[goal])
    assert wizard.questions.count.text() == f"1 setting given; the rest is optimised for the least {goal}"
    found = best(Request("DRD", 20.0, 30.0, 330.0, "rise", {"length": 150.0}), goal)
    assert [float(row[2]) for row in wizard.table] == pytest.approx([s.span_deg for s in found.segments], abs=6e-5)
    assert wizard.can_put


def test_the_best_that_would_lose_its_constant_velocity_is_told(ask: Ask) -> None:
    wizard = ask()
    wizard.click(wizard.questions.kind.types["DRD"])
    wizard.click(wizard.questions.kind.constants["rise"], QPoint(8, 8))
    wizard.choose(wizard.questions.goal, GOAL_TEXTS["acceleration"])
    assert "no constant velocity left" in wizard.questions.general.text()
    assert not wizard.can_put
    wizard.give(length="50")
    assert not wizard.questions.general.isVisible()
    assert wizard.can_put


# -- the questions ----------------------------------------------------------------------------------------


def test_the_type_says_what_can_be_asked(ask: Ask) -> None:
    wizard = ask()
    questions, kind = wizard.questions, wizard.questions.kind
    wizard.click(kind.types["DRD"])
    assert kind.label.text() == "Dwell - rise - dwell"
    assert [name for name, button in kind.constants.items() if button.isEnabled()] == ["none", "rise"]
    assert not questions.unequal.isVisible()
    wizard.click(kind.constants["rise"], QPoint(8, 8))
    wizard.click(kind.types["DRD-return"])
    assert kind.constant == "return", "of the one stroke there is"
    wizard.click(kind.types["RRR"])
    assert (questions.start.number, questions.end.number) == (0.0, 360.0), "without a dwell it takes the turn"
    assert kind.constant == "return"
    wizard.click(kind.constants["none"], QPoint(8, 8))
    wizard.answered()
    assert wizard.curves == "H5–H6"
    assert [s.curve.law for s in wizard.put().segments] == ["h5", "h6"]


def test_settings_that_no_longer_mean_anything_are_dropped(ask: Ask) -> None:
    wizard = ask(PICKER)
    wizard.give(peak="200")
    assert wizard.rows["peak"].is_used
    wizard.click(wizard.questions.kind.types["DRD"])
    wizard.answered()
    assert not wizard.rows["peak"].is_used
    assert not wizard.rows["peak"].check.isVisible()
    assert list(wizard.questions.request().settings) == ["h1", "h3"]
    assert wizard.curves == "C1–CV1–C2"


def test_a_value_comes_back_with_its_tick(ask: Ask) -> None:
    wizard = ask(PICKER)
    wizard.type(wizard.rows["h3"].box, "3.25")
    wizard.tick("h3")
    assert not wizard.rows["h3"].box.isEnabled()
    assert wizard.rows["h3"].box.text() == ""
    wizard.tick("h3")
    assert wizard.rows["h3"].box.number == 3.25


@pytest.mark.stress
def test_a_new_setting_begins_where_it_is_feasible(ask: Ask) -> None:
    wizard = ask(PICKER, ranges=True)
    wizard.tick("h3")
    for name in ("vcv", "peak", "length"):
        wizard.ranged(name)
        wizard.tick(name)
        wizard.answered()
        assert wizard.can_put, name
        wizard.tick(name)
        wizard.answered()


def test_the_return_may_differ(ask: Ask) -> None:
    wizard = ask()
    questions = wizard.questions
    assert not questions.back.isEnabled()
    wizard.click(questions.unequal, QPoint(8, 8))
    assert questions.back.number == 20.0
    wizard.type(questions.back, "15")
    wizard.answered()
    assert [row[1] for row in wizard.table] == ["20.0000", "15.0000"]
    assert not wizard.dialog.replaced["turn"].isEnabled(), "it does not come back to where it starts"
    wizard.click(questions.unequal, QPoint(8, 8))
    wizard.answered()
    assert [row[1] for row in wizard.table] == ["20.0000", "20.0000"]


@pytest.mark.stress
def test_precision_points(ask: Ask) -> None:
    wizard = ask(PICKER, ranges=True)
    settings = wizard.questions.settings
    wizard.tick("h3")
    wizard.click(settings.add_point)
    (row,) = settings.points
    wizard.type(row.at, "120")
    wizard.type(row.level, "8")
    wizard.answered()
    wait_for(lambda: not wizard.dialog.ranges.busy)
    assert row.range.text() == range_text(feasible_ranges(wizard.questions.request(), "point", 120.0), "level")
    made = wizard.dialog.design
    assert made is not None
    study = Study(made, 360)
    assert study.motion.y[0, 120] * 1e3 == pytest.approx(8.0, abs=1e-9)
    wizard.type(row.level, "19.9")
    wizard.answered()
    assert row.message.text().startswith("point at 120° = 19.9 mm is not feasible with h1 = 1; feasible: ")
    assert row.level.is_refused
    wizard.click(row.close)
    wait_for(lambda: not wizard.dialog.ranges.busy)
    assert settings.points == []
    assert wizard.veiled == "1 more to set"


def test_labels_have_the_unit_of_the_motion(app: QApplication) -> None:
    questions = Questions("deg")
    questions.set_request(wish(constant="rise", settings={"h1": 1.0}, unit="deg"))
    assert questions.request() == wish(constant="rise", settings={"h1": 1.0}, unit="deg")
    assert questions.settings.rows["vcv"].unit.text() == "°/°"
    assert questions.settings.rows["length"].unit.text() == "°"
    questions.deleteLater()


def test_answers_are_read_back_as_they_are_shown(app: QApplication) -> None:
    questions = Questions("mm")
    for asked, goal in (
        (Request("DRD", 12.0, 10.0, 100.0, "rise", {"vcv": 0.2, "h1": 1.5}), "jerk"),
        (
            wish(
                "DRRD",
                "both",
                settings={"h1": 1.0},
                points=((90.0, 5.0),),
                sequence="C1-CV1-H2-H3-CV2-C4",
                mirrored=True,
            ),
            "",
        ),
        (Request("DRRD", 20.0, 0.0, 200.0, return_stroke=15.0), ""),
        (Request("DRD-return", 20.0, 0.0, 200.0, "return", {"h3": 2.0}), ""),
    ):
        questions.set_request(asked, goal)
        assert (questions.request(), questions.chosen_goal) == (asked, goal)
        assert list(questions.request().settings) == list(asked.settings)
    questions.deleteLater()


# -- into the design --------------------------------------------------------------------------------------


def test_a_rise_takes_the_place_of_the_chosen_one(ask: Ask) -> None:
    wizard = ask(LIFT, 3)
    dialog = wizard.dialog
    assert dialog.replaced["range"].isChecked()
    assert not dialog.replaced["turn"].isEnabled(), "a rise alone is no whole motion"
    assert dialog.replaced["range"].text() == "only 283.5° … 325°"
    assert dialog.message.text() == "The rest of the motion does not change."
    motion = wizard.put()
    assert [s.curve.law for s in motion.segments] == ["dwell", "modified-sine", "dwell", "c5", "dwell"]
    assert motion.segments[:3] == LIFT.drive.motion.segments[:3]
    assert motion.start == 150.0
    stack = wizard.session.stack
    assert [stack.text(i) for i in range(stack.count())] == ["Blend C5"]


def test_what_else_will_move_otherwise_is_told(ask: Ask) -> None:
    wizard = ask(LIFT, 3)
    wizard.type(wizard.questions.stroke, "120")
    wizard.answered()
    told = "Segment 2, Modified sine, then rises by −120 mm to close the motion; the rest does not change."
    assert wizard.dialog.message.text() == told
    assert [s.rise for s in wizard.put().segments] == [0.0, -120.0, 0.0, 120.0, 0.0]


def test_a_rise_into_a_standing_motion_comes_back(ask: Ask) -> None:
    wizard = ask()
    wizard.click(wizard.questions.kind.types["DRD"])
    wizard.type(wizard.questions.end, "120")
    wizard.answered()
    assert (
        wizard.dialog.message.text()
        == "The motion has no return, so the same curves in reverse bring the follower back."
    )
    motion = wizard.put()
    assert [s.curve.law for s in motion.segments] == ["dwell", "c5", "dwell", "c6", "dwell"]
    assert faults(wizard.session.design) == []


def test_a_segment_that_would_be_cut_is_told(ask: Ask) -> None:
    wizard = ask(LIFT, 3)
    wizard.type(wizard.questions.start, "60")
    wizard.answered()
    wanted = "60° lies inside the moving segment 2 (35 … 76.5°). Start at 35° or 76.5°."
    assert wizard.dialog.message.text() == wanted
    assert not wizard.can_put
    assert wizard.table, "the curves are shown all the same"
    assert [len(curves(plot)) for plot in wizard.dialog.panel.plots] == [2, 2, 2], "and drawn, over those of the design"
    line = wizard.dialog.message
    assert list(line.buttons) == ["Start at 35°", "Start at 76.5°"]
    wizard.click(line.buttons["Start at 76.5°"])
    wizard.answered()
    assert wizard.questions.start.number == 76.5
    assert (wizard.can_put, list(line.buttons)) == (True, [])
    wizard.type(wizard.questions.start, "250")
    wizard.answered()
    assert [s.span_deg for s in wizard.put().segments] == [35.0, 41.5, 173.5, 75.0, 35.0]


def test_a_button_replaces_the_whole_turn_where_a_part_is_refused(ask: Ask) -> None:
    wizard = ask(LIFT, 3)
    wizard.click(wizard.questions.kind.types["DRRD"])
    wizard.answered()
    wizard.type(wizard.questions.start, "60")
    wizard.answered()
    assert wizard.dialog.replaced["range"].isChecked()
    assert wizard.dialog.message.text().endswith("Start at 35° or 76.5°, or replace the whole turn.")
    wizard.click(wizard.dialog.message.buttons["Whole turn"])
    assert wizard.dialog.replaced["turn"].isChecked()
    assert wizard.can_put


def test_another_type_takes_the_part_that_the_motion_accepts(ask: Ask) -> None:
    wizard = ask(LIFT, 3)
    wizard.click(wizard.questions.kind.types["DRRD"])
    wizard.type(wizard.questions.start, "60")
    wizard.answered()
    assert wizard.dialog.replaced["turn"].isChecked()
    assert wizard.can_put


@pytest.mark.parametrize("segment", range(4))
@pytest.mark.parametrize("rises", [(20.0, -10.0, 0.0, -10.0), (-10.0, 0.0, 20.0, -10.0), (20.0, 0.0, -20.0, 0.0)])
def test_it_opens_with_a_part_that_the_motion_accepts(ask: Ask, rises: tuple[float, ...], segment: int) -> None:
    segments = tuple(Segment(90.0, rise, NamedCurve("modified-sine" if rise else "dwell")) for rise in rises)
    motion = replace(require_motion(PICKER), start=10.0, segments=segments)
    wizard = ask(with_motion(PICKER, motion), segment)
    assert wizard.can_put, wizard.dialog.message.text()
    wizard.click(wizard.questions.kind.types["DRRD"])
    wizard.answered()
    assert wizard.can_put, wizard.dialog.message.text()


def test_settings_are_named_in_words_with_the_letter_behind(ask: Ask) -> None:
    rows = ask(PICKER).rows
    labels = {name: rows[name].check.text() for name in ("h1", "h3", "vcv")}
    assert labels == {
        "h1": "Height of the first curve, h1",
        "h3": "Height of the last curve, h3",
        "vcv": "Constant velocity, Vcv",
    }


def test_a_motion_with_faults_is_not_put_in(ask: Ask) -> None:
    """A curve that is meant for a return cannot bring the follower up again."""
    wizard = ask(edited(LIFT, "motion.segments[1].law", "c6"), 3)
    wizard.click(wizard.questions.kind.types["DRD-return"])
    wizard.answered()
    assert wizard.curves == "C6"
    assert (
        wizard.dialog.message.text() == "Segment 2, rise 150 mm: c6 is a return; allowed: < 0 mm, or a law that rises"
    )
    assert not wizard.can_put
    wizard.click(wizard.questions.kind.types["DRD"])
    wizard.answered()
    assert wizard.can_put


def test_the_whole_turn_or_only_a_part(ask: Ask) -> None:
    wizard = ask(LIFT, 3)
    wizard.click(wizard.questions.kind.types["DRRD"])
    wizard.type(wizard.questions.start, "100")
    wizard.type(wizard.questions.end, "200")
    wizard.answered()
    assert wizard.dialog.message.text() == "The rest of the motion does not change."
    assert wizard.dialog.design is not None
    assert len(wizard.dialog.design.drive.motion.segments) == 8
    wizard.click(wizard.dialog.replaced["turn"], QPoint(8, 8))
    assert wizard.dialog.message.text() == "The motion consists of these curves and the dwells before and after them."
    assert [s.curve.law for s in wizard.put().segments] == ["dwell", "p1", "p2", "dwell"]


def test_the_motion_as_it_is_stands_dashed_behind(ask: Ask) -> None:
    wizard = ask(LIFT, 3)
    for plot, order in zip(wizard.dialog.panel.plots, range(3), strict=True):
        was, now = curves(plot)
        assert was.pen().dashPattern()
        assert not now.pen().dashPattern()
        assert wizard.dialog.design is not None
        study = Study(wizard.dialog.design, 720)
        omega = study.omega
        values = study.motion.y[order] * omega**order / plot.display_unit.size * (1e3 if order < 3 else 1.0)
        assert now.y[:-1] == pytest.approx(values, rel=1e-9, abs=1e-9 * np.abs(values).max())


@pytest.mark.stress
def test_a_motion_that_the_design_refuses_is_told(open_user: Open) -> None:
    """The linkage of the lift does not reach three metres."""
    user: User = open_user()
    before = user.design
    user.window.designing.blend()
    dialog = user.window.findChild(BlendDialog)
    assert isinstance(dialog, BlendDialog)
    wizard = Wizard(dialog, user.session)
    wizard.answered()
    wizard.type(wizard.questions.stroke, "3000")
    wizard.answered()
    assert wizard.can_put
    wizard.click(dialog.put_button)
    assert dialog.isVisible()
    assert "Rod" in dialog.message.text()
    assert user.design == before
    dialog.reject()
    settle()
    assert user.steps == []


def test_cancelling_leaves_nothing_behind(ask: Ask) -> None:
    before = threading.active_count()
    wizard = ask(PICKER)
    wizard.type(wizard.rows["h1"].box, "2")
    wizard.dialog.reject()
    assert not wizard.dialog.isVisible()
    assert not wizard.dialog.busy
    assert wizard.session.design == PICKER
    assert wizard.session.stack.count() == 0
    wait_for(lambda: threading.active_count() <= before)


def test_a_refusal_without_a_field_is_told_below(ask: Ask) -> None:
    wizard = ask(PICKER)
    wizard.questions.show_error(BlendError("these settings have no solution; change one of them"))
    assert wizard.questions.general.isVisible()
    assert wizard.questions.general.text() == "these settings have no solution; change one of them"


def test_no_heading_is_cut_off_at_the_least_size(ask: Ask) -> None:
    wizard = ask(PICKER, 1)
    wizard.dialog.resize(wizard.dialog.minimumSize())
    settle()
    head = wizard.dialog.panel.table.horizontalHeader()
    for column, title in enumerate(wizard.titles):
        assert head.fontMetrics().horizontalAdvance(title) + 8 <= head.sectionSize(column), title
    assert sum(head.sectionSize(i) for i in range(head.count())) <= wizard.dialog.panel.table.viewport().width()


def test_a_range_of_two_parts_is_read_whole_at_the_least_size(ask: Ask) -> None:
    wizard = ask(PICKER, 1)
    wizard.dialog.resize(wizard.dialog.minimumSize())
    row = next(row for row in wizard.rows.values() if row.shown)
    row.show_ranges([SettingRange(0.00338035, 0.00892857, high_open=True), SettingRange(0.0112233, 0.0223344)])
    settle()
    assert row.range.fontMetrics().horizontalAdvance(row.range.text()) > row.range.width()
    assert row.range.height() >= row.range.heightForWidth(row.range.width())


@pytest.mark.stress
def test_a_point_that_is_taken_away_while_its_range_is_computed_is_forgotten(ask: Ask) -> None:
    wizard = ask(PICKER, ranges=True)
    settings = wizard.questions.settings
    wizard.give(h1="1", h3="1")
    wizard.click(settings.add_point)
    wizard.type(settings.points[0].at, "90")
    wait_for(lambda: wizard.dialog.ranges.busy)
    settings.set_request(replace(wizard.questions.request(), points=()))
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    wait_for(lambda: not wizard.dialog.ranges.busy)
    assert settings.points == []


def test_what_may_follow_a_step_of_the_sequence(ask: Ask) -> None:
    """Yang Table 1 and Fig. 1: green where a curve may follow, the reason where it may not."""
    wizard = ask(PICKER, 1)
    page = wizard.dialog.succession
    wizard.dialog.pages.setCurrentWidget(page)
    settle()
    assert [button.text() for button in page.steps] == ["C1", "CV1", "H2", "P2"]
    wizard.click(page.steps[2])
    rows = {row.cells[0]: row for row in page.table.rows.rows}
    assert rows["P2"].cells[1:] == ("+, 0", "0, 0", "−, 0", "May follow H2")
    assert rows["H6"].cells[-1] == "May follow H2, but not at this position of DRRD"
    assert rows["C4"].cells[-1] == "Velocity would jump from rest to falling"
    assert {name for name, row in rows.items() if row.colour == LIGHT.good} == {"H3", "P2"}
    assert page.verdict.text().endswith("May follow: <b>H3, H6, P2</b>")
    QTest.mouseClick(
        page.table.viewport(),
        Qt.MouseButton.LeftButton,
        pos=page.table.visualRect(page.table.rows.index(0, 0)).center(),
    )
    assert page.curve == "C1"
    assert {row.cells[0] for row in page.table.rows.rows if row.colour == LIGHT.good} == {"H2", "CV1"}, "in this motion"
    wizard.click(wizard.questions.kind.types["RRR"])
    wizard.answered()
    assert [button.text() for button in page.steps] == ["H1", "CV1", "H2", "H3", "H4"]
    assert page.curve == "H1"
    wizard.click(page.steps[-1])
    turn = {row.cells[0]: row.cells[-1] for row in page.table.rows.rows}
    assert (turn["H1"], turn["H5"]) == ("May follow H4", "May follow H4, but not at this position of RRR"), (
        "the next turn begins"
    )


def test_the_pictures_of_motions_show_velocity_and_acceleration_too(ask: Ask) -> None:
    for button in ask().questions.kind.types.values():
        picture = button.icon().pixmap(button.iconSize()).toImage()
        seen = {
            picture.pixelColor(x, y).name().upper() for x in range(picture.width()) for y in range(picture.height())
        }
        assert {FAMILIES[name] for name in ("displacement", "velocity", "acceleration")} <= seen


def test_angles_are_typed_anew_beside_a_constant_acceleration(ask: Ask) -> None:
    """From 0, the end cleared on the way to another one: the settings stay as they were."""
    wizard = ask(load(example("dwell_rise_dwell")), 1)
    questions = wizard.questions
    wizard.type(questions.start, "0")
    wizard.give(h1="6", flat1="20")
    shown = [name for name, row in wizard.rows.items() if row.shown]
    questions.end.setFocus()
    questions.end.selectAll()
    for key in (Qt.Key.Key_Backspace, Qt.Key.Key_0, Qt.Key.Key_Backspace):
        QTest.keyClick(questions.end, key)
        wizard.answered()
        assert [name for name, row in wizard.rows.items() if row.shown] == shown
        assert questions.size_faults[1].text()
        assert not wizard.can_put
    wizard.type(questions.end, "100")
    wizard.answered()
    assert questions.size_faults[1].text() == ""
    assert questions.request().settings["flat1"] == 20.0


def test_a_constant_acceleration_of_a_size_over_a_span(ask: Ask) -> None:
    wizard = ask(load(example("dwell_rise_dwell")), 1, ranges=True)
    wizard.tick("h1")
    wizard.answered()
    assert not wizard.rows["a1"].shown
    assert wizard.questions.settings.add_point.isVisible()
    wizard.give(flat1="60")
    assert not wizard.questions.settings.add_point.isVisible()
    wizard.give(a1="0.003")
    names = [row.check.text() for row in wizard.rows.values() if row.shown]
    assert {
        "Span of the constant acceleration a1",
        "Constant acceleration, a1",
        "Span of the constant acceleration a3",
    } <= set(names)
    assert len(set(names)) == len(names), "no two settings of one name"
    assert wizard.curves == "C1–CV1–C2"
    lines = wizard.dialog.panel.figures.text().splitlines()
    assert any(line.startswith("C1: constant acceleration 0.003 mm/°²") and "over 60°" in line for line in lines)
    wizard.ranged()
    assert wizard.rows["flat1"].range.text() == "47.524 < span a1 < 73.624"
    wizard.give(flat1="80")
    assert "feasible: 47.524" in wizard.rows["flat1"].message.text()
    wizard.give(flat1="60")
    made = wizard.put().segments
    assert made[1].curve.flat_fraction * made[1].span_deg == pytest.approx(60.0, rel=1e-12)
    again = first_request(wizard.session.design.drive.motion, 1)
    assert again.settings["flat1"] == pytest.approx(60.0, rel=1e-12)
    assert [s.span_deg for s in blend(again).segments] == pytest.approx([s.span_deg for s in made[1:4]], rel=1e-12)
