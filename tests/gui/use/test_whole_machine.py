"""A whole machine typed value by value: no value is lost on the way, in whatever order it comes, and each is a step."""

import json
import random
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from sampled import spread, stressed
from window_user import Open, User, settle, wait_for

from core.design import (
    LAYOUTS,
    Design,
    NamedCurve,
    all_paths,
    curve_of,
    drive_at,
    edited,
    entries,
    get,
    motion_of,
    rescaled,
    stroke,
)
from core.followers.cam_slider import in_layout
from core.project import load
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.request_form import ScaleDialog
from kindyna_gui.motion.segments_table import SPAN
from kindyna_gui.places import example

LIFT = load(example("transfer_lift"))
UNDO = Qt.KeyboardModifier.ControlModifier
Values = dict[str, Any]
TENTH: Values = {
    "follower.slider_arm_mm": "130.2", "follower.roller_arm_mm": "65.1", "follower.pivot_y_mm": "-6.5", "cam.roller_radius_mm": "15",
    "follower.pivot_x_mm": "87.4", "cam.base_radius_mm": "40", "follower.guide_height_mm": "130", "follower.rod_mm": "84.5",
}  # fmt: skip
"""The paper's lift / 10, in an order in which all but the last value wait."""
FOUR_BAR: Values = {
    "linkage.links[3].points.B.x_mm": "400", "linkage.links[2].points.B.x_mm": "689.7", "linkage.links[1].points.A.x_mm": "200",
    "linkage.links[0].points.O4.x_mm": "600",
}  # fmt: skip
"""A four-bar of six times the size, in the order in which most values wait."""
LAWS = ("modified-sine", "cycloidal", "3-4-5")
STAGES = ("motion", "linkage", "cam", "dynamics")


def with_values(design: Design, values: Values) -> Design:
    for path, text in values.items():
        design = edited(design, path, float(text))
    return design


# -- by keys, in the window -------------------------------------------------------------------------------


def type_all(user: User, values: Values) -> list[bool]:
    """Type each value into its field; whether it, or one before it, waits then. What was typed stands in all of them."""
    waiting = []
    for number, (path, text) in enumerate(values.items(), 1):
        user.enter(path, text)
        waiting.append(user.session.incomplete is not None)
        boxes = {each: box(user, each) for each in values}
        assert {each: boxes[each].text() for each in list(values)[:number]} == dict(list(values.items())[:number])
        assert not any(each.is_refused for each in boxes.values())
        assert any(each.is_waiting for each in boxes.values()) == waiting[-1], "what waits is marked"
    return waiting


def box(user: User, path: str) -> NumberBox:
    """The field of a path, without bringing it before the reader."""
    field = user.parameters().field(path)
    assert field is not None
    assert isinstance(field.editor, NumberBox)
    return field.editor


def undo_all(user: User, steps: int) -> None:
    user.window.show_view("mechanism").setFocus()
    for _ in range(steps):
        user.press(Qt.Key.Key_Z, modifier=UNDO)


@pytest.mark.stress
@pytest.mark.parametrize(
    ("name", "values", "waits"),
    [stressed("transfer_lift", TENTH, 7), ("four_bar", FOUR_BAR, 2)],
    ids=["lift", "four-bar"],
)
def test_a_machine_of_another_size_is_typed(same_window: Open, name: str, values: Values, waits: int) -> None:
    user = same_window(example(name))
    first = user.design
    waiting = type_all(user, values)
    assert sum(waiting) == waits
    assert user.session.incomplete is None
    assert user.design == with_values(first, values)
    assert len(user.steps) == len(values)
    undo_all(user, len(values))
    assert (user.design, user.session.incomplete) == (first, None)
    assert not user.session.modified


@pytest.mark.stress
def test_the_last_machine_that_fits_is_pale_and_a_line_says_what_does_not(same_window: Open) -> None:
    user = same_window()
    view = user.drawing()
    before = darkest(view.canvas.grab().toImage())
    user.enter("follower.slider_arm_mm", "130.2")
    study = user.session.study
    assert study.design == LIFT, "plots and drawing keep the last that fitted"
    view.pull()
    settle()
    assert view.note.text().startswith(
        "Showing the last version that can be assembled. Rod L2: the rod does not reach the guide"
    )
    assert darkest(view.canvas.grab().toImage()) > before + 60
    assert user.window.status.misfit.text() == "Does not fit yet: Rod L2"
    user.window.status.misfit.click()
    assert QApplication.focusWidget() is user.number("follower.rod_mm"), "a click goes to the field"
    user.enter("follower.guide_height_mm", "130")
    user.enter("follower.rod_mm", "84.5")
    view.pull()
    settle()
    assert (view.note.isHidden(), user.window.status.misfit.isHidden()) == (True, True)
    assert darkest(view.canvas.grab().toImage()) < before + 20


def darkest(image: Any) -> int:
    return min(
        image.pixelColor(x, y).lightness() for x in range(0, image.width(), 2) for y in range(0, image.height(), 2)
    )


@pytest.mark.stress
def test_what_is_impossible_by_itself_is_refused_beside_what_waits(same_window: Open) -> None:
    user = same_window()
    user.enter("follower.slider_arm_mm", "130.2")
    draft, steps = user.session.incomplete, user.steps
    for text in ("-5", "8,5", "1e12"):
        user.enter("follower.rod_mm", text)
        assert (user.number("follower.rod_mm").text(), user.number("follower.rod_mm").is_refused) == (text, True)
    assert (user.session.incomplete, user.steps) == (draft, steps)


def test_the_button_drops_what_waits_and_undo_brings_it_back(same_window: Open) -> None:
    user = same_window()
    user.enter("follower.slider_arm_mm", "130.2")
    draft = user.session.incomplete
    user.parameters().incomplete_bar.drop_button.click()
    settle()
    assert (user.number("follower.slider_arm_mm").text(), user.session.incomplete) == ("1302.162", None)
    user.choose("Edit", "Undo Back to the last valid values")
    assert (user.number("follower.slider_arm_mm").text(), user.session.incomplete) == ("130.2", draft)


@pytest.mark.stress
def test_a_stroke_and_a_segment_wait_for_the_lengths(same_window: Open) -> None:
    """The motion is whole, but too long for the arm: its cells keep it, and the diagram shows the one before."""
    user = same_window()
    user.enter("motion.stroke_mm", "5000")
    motion = user.motion()
    assert user.session.incomplete is not None
    assert (user.cell(1, 4), stroke(motion.diagram.motion)) == ("-5000", 150.0)
    assert motion.incomplete_bar.isVisible()
    user.enter_cell(1, SPAN, "45")
    user.enter("follower.rod_mm", "2000")
    user.enter("follower.slider_arm_mm", "1700")
    assert user.session.incomplete is None
    assert [s.span_deg for s in motion_of(user.design).segments] == [35.0, 45.0, 203.5, 41.5, 35.0]
    assert stroke(motion_of(user.design)) == 5000.0


# -- layouts ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("letter", spread(list(LAYOUTS), 1))
def test_every_layout_is_chosen_from_the_papers_lift(same_window: Open, letter: str) -> None:
    """In the menu and in the field as in the pictures of mechanisms."""
    user = same_window()
    (entry,) = (text for text in user.entries("Compo", "Layout") if text[0] == letter)
    user.choose("Compo", "Layout", entry)
    assert user.session.incomplete is None
    assert user.design == in_layout(LIFT, letter)
    by_menu = user.design
    user.session.start(LIFT)
    box: Any = user.field("follower.layout").editor
    box.setCurrentIndex(box.findData(letter))
    box.activated.emit(box.currentIndex())
    settle()
    assert user.design == by_menu
    assert min(Study(user.design, 360).dynamics.contact) > 0.0


def test_a_layout_of_a_small_lift_keeps_its_size(app: object) -> None:
    session = Session(rescaled(LIFT, 0.1))
    session.stages_on_screen = lambda: STAGES
    for letter in (*LAYOUTS, *reversed(LAYOUTS)):
        assert session.edit("follower.layout", letter, letter)
        assert session.incomplete is None, letter
        assert abs(get(session.design, "follower.guide_height_mm")) == 130.0


# -- in any order -----------------------------------------------------------------------------------------


def other(first: Design, dice: random.Random) -> Design:
    """A design of another size, with other spans, and laws that are no less smooth."""
    drives = []
    for drive in rescaled(first, dice.choice((0.2, 3.0)), masses=dice.random() < 0.5).drives:
        motion = drive.motion
        if motion is not None and all(isinstance(segment.curve, NamedCurve) for segment in motion.segments[1:]):
            weights = [dice.uniform(0.7, 1.3) * segment.span_deg for segment in motion.segments]
            spans = [round(360.0 * weight / sum(weights), 1) for weight in weights[:-1]]
            spans.append(round(360.0 - sum(spans), 1))
            segments = tuple(
                replace(
                    each, span_deg=span, curve=curve_of(dice.choice(LAWS)) if each.curve.law in LAWS else each.curve
                )
                for each, span in zip(motion.segments, spans, strict=True)
            )
            drive = replace(drive, motion=replace(motion, segments=segments))
        drives.append(drive)
    return replace(rescaled(first, 0.5), drives=tuple(drives))


def paths_apart(first: Design, wanted: Design) -> dict[str, Any]:
    """Every value of a form or a table in which two designs differ, as it is in the second."""
    paths = [entry.path for name in first.tables for entry in entries(first, name)]
    paths += [path for path in all_paths(first) if path.endswith(".law")]
    return {path: get(wanted, path) for path in paths if get(first, path) != get(wanted, path)}


def type_in(session: Session, values: Values, order: Sequence[str]) -> int:
    """Type values in this order, of each drive in its own forms; how many of them had to wait. None is lost on the way."""
    waited = 0
    for number, path in enumerate(order, 1):
        own = drive_at(path)
        if own is not None:
            assert session.choose_drive(own[0])
        assert session.edit(path if own is None else own[1], values[path], path)
        session.end_gesture()
        waited += session.incomplete is not None
        assert {each: get(session.typed_full_design, each) for each in order[:number]} == {
            each: values[each] for each in order[:number]
        }
    return waited


@pytest.mark.parametrize("path", spread(sorted(example("").parent.glob("*.toml")), 2), ids=lambda path: path.stem)
def test_every_example_is_typed_into_another_design_in_any_order(app: object, path: Path) -> None:
    """Lengths, masses, points of links, spans, rises and laws of segments, of every drive."""
    first = load(path)
    dice = random.Random(path.stem)
    wanted = other(first, dice)
    session = Session(first)
    session.stages_on_screen = lambda: STAGES
    values = paths_apart(first, wanted)
    type_in(session, values, dice.sample(list(values), len(values)))
    assert session.typed_full_design == wanted
    wait_for(lambda: session.incomplete is None)  # once the laws that are calculated are known
    while session.stack.canUndo():
        session.stack.undo()
    wait_for(lambda: session.incomplete is None)
    assert session.full_design == first


@pytest.mark.stress
def test_a_lift_in_another_layout_is_typed_in_any_order(app: object) -> None:
    wanted = rescaled(in_layout(LIFT, "c"), 0.1)
    values = paths_apart(LIFT, wanted)
    for seed in range(4):
        order = random.Random(seed).sample(list(values), len(values))
        order.sort(key=lambda path: path == "follower.layout")  # before any other value it takes guide and angle along
        session = Session(LIFT)
        session.stages_on_screen = lambda: STAGES
        assert type_in(session, values, order) > 3
        assert (session.full_design, session.incomplete) == (wanted, None)


def test_drives_wait_beside_each_other(app: object) -> None:
    """What waits in one drive stays while another is chosen and edited, and both hold once they fit."""
    session = Session(load(example("transfer_unit")))
    session.stages_on_screen = lambda: STAGES
    first = session.full_design
    lift = next(i for i, drive in enumerate(first.drives) if drive.kind == "cam-slider")
    other = next(i for i, drive in enumerate(first.drives) if drive.kind == "translating")
    assert session.choose_drive(lift)
    assert session.edit("follower.roller_arm_mm", 65.1, "arm")
    assert session.misfit.reasons[0][:2] == ("follower.roller_arm_mm", "Roller arm Zl")
    assert session.choose_drive(other)
    assert session.misfit.reasons[0][1] == f"{first.drives[lift].name}: Roller arm Zl"
    assert session.edit("cam.base_radius_mm", 333.0, "base circle")
    assert session.edit("shaft.speed_rpm", 25.0, "speed")
    assert (session.design.drive.cam.base_radius_mm, session.full_design.shaft.speed_rpm) == (333.0, 25.0), (
        "what fits holds"
    )
    assert session.edit("motion.segments[0].span_deg", 300.0, "span")
    assert session.typed.drive.motion.segments[0].span_deg == 300.0
    assert session.choose_drive(lift)
    assert session.typed.drive.mechanism.roller_arm_mm == 65.1
    state = session.state()
    again = Session(LIFT)
    again.restore(json.loads(json.dumps(state)))
    assert again.typed_full_design == session.typed_full_design
    assert again.state() == state
    assert session.edit("follower.roller_arm_mm", 651.0, "arm")
    assert session.typed_full_design.drives[other].motion.segments[0].span_deg == 300.0
    assert session.choose_drive(other)
    span = first.drives[other].motion.segments[0].span_deg
    assert session.edit("motion.segments[0].span_deg", span, "span")
    assert session.incomplete is None
    assert (
        get(session.full_design, f"drives[{lift}].follower.roller_arm_mm"),
        session.full_design.shaft.speed_rpm,
    ) == (
        651.0,
        25.0,
    )
    while session.stack.canUndo():
        session.stack.undo()
    assert (session.full_design, session.incomplete) == (first, None)


def test_an_answer_of_another_view_leaves_what_waits(app: object) -> None:
    """A joint that is drawn, an answer taken over, a drive renamed: what is typed beside it goes on waiting."""
    session = Session(LIFT)
    session.stages_on_screen = lambda: STAGES
    session.edit("follower.roller_arm_mm", 65.1, "waits")
    assert session.put(edited(session.design, "cam.base_radius_mm", 410.0), "Take over")
    assert (session.design.drive.cam.base_radius_mm, session.typed.drive.cam.base_radius_mm) == (410.0, 410.0)
    assert (session.design.drive.mechanism.roller_arm_mm, session.typed.drive.mechanism.roller_arm_mm) == (
        651.081,
        65.1,
    )
    assert session.put(edited(session.design, "follower.roller_arm_mm", 660.0), "Move the roller")
    assert session.incomplete is None, "the later of two counts"


@pytest.mark.stress
def test_a_tab_is_marked_for_its_own_drive(same_window: Open) -> None:
    user = same_window(example("transfer_unit"))
    lift = next(i for i, drive in enumerate(user.session.full_design.drives) if drive.kind == "cam-slider")
    user.session.choose_drive(lift)
    settle()
    user.enter("follower.roller_arm_mm", "65.1")
    tabs, page = user.parameters().tabs, user.parameters().pages["follower"]
    assert not tabs.tabIcon(tabs.indexOf(page)).isNull()
    user.session.choose_drive(0)
    settle()
    user.parameters()
    assert tabs.tabIcon(tabs.indexOf(page)).isNull()
    name = user.session.names[lift]
    assert user.window.status.misfit.text() == f"Does not fit yet: {name}: Roller arm Zl"
    assert user.drawing().note.isHidden(), "this drive is as it is typed"
    user.window.status.misfit.click()
    settle()
    assert user.session.chosen == lift
    assert QApplication.focusWidget() is user.number("follower.roller_arm_mm")


# -- saving -----------------------------------------------------------------------------------------------


def test_save_keeps_what_is_typed(same_window: Open, tmp_path: Path) -> None:
    user = same_window()
    path = tmp_path / "own.toml"
    user.picks("design_to_save", path)
    user.enter("follower.slider_arm_mm", "130.2")
    asked = user.clicks("Save unfinished")
    user.choose("File", "Save")
    assert asked == ["The typed values do not fit together yet."]
    typed = edited(LIFT, "follower.slider_arm_mm", 130.2)
    assert load(path) == typed
    assert not user.session.modified
    user.session.edit("follower.roller_arm_mm", 65.1, "one value more")
    assert user.session.modified
    user.session.stack.undo()
    assert not user.session.modified
    user.clicks("Save the last valid version")
    user.choose("File", "Save")
    assert (load(path), user.session.modified) == (LIFT, True)
    assert user.number("follower.slider_arm_mm").text() == "130.2"
    user.clicks("Save unfinished")
    user.choose("File", "Save")
    user.session.open(path)
    assert user.design == typed, "it can be gone on with"


def test_opening_another_file_leaves_nothing_waiting(same_window: Open) -> None:
    user = same_window()
    user.enter("follower.slider_arm_mm", "130.2")
    user.session.open(example("four_bar"))
    settle()
    assert (
        user.session.incomplete,
        user.window.status.misfit.isHidden(),
        user.parameters().incomplete_bar.isHidden(),
    ) == (
        None,
        True,
        True,
    )
    assert not user.drawing().in_trouble


# -- another size at once ---------------------------------------------------------------------------------


def test_the_design_is_scaled_in_one_step(same_window: Open) -> None:
    user = same_window()
    seen: list[str] = []

    def fill(box: Any) -> None:
        assert isinstance(box, ScaleDialog)
        box.factor.selectAll()
        QTest.keyClicks(box.factor, "1/10")
        QTest.keyClick(box.factor, Qt.Key.Key_Return)
        seen.append(box.text.text())

    user.clicks("Scale", before=fill)
    user.choose("Edit", "Scale the design...")
    assert seen[0].startswith("Lengths × 0.1, masses × 0.001, moments of inertia × 1e\u22125. Angles, speeds, forces")
    assert user.design == rescaled(LIFT, 0.1)
    assert user.steps == ["Scale the design by 0.1"]
    user.choose("Edit", "Undo Scale the design by 0.1")
    assert user.design == LIFT
    user.clicks("Cancel")
    user.choose("Edit", "Scale the design...")
    assert user.steps == ["Scale the design by 0.1"]
