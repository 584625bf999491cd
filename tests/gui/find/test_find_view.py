"""Kine > Find: what is shown is what the core finds; it is taken over as one step; nothing is sought while nobody sees it."""

import math
import re
from contextlib import suppress
from html import unescape
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton
from window_user import Open, User, end_pauses, settle, wait_for

from core.design import distances, edited, get
from core.find import CAM_SEARCHES, find
from core.project import load, save
from core.study import Study, extremes_of, findings_of
from core.varying import find_top_speed
from kindyna_gui.documents.pins import Pins
from kindyna_gui.find import FindView
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.pictures.units import readable_text
from kindyna_gui.places import example


def see(user: User) -> FindView:
    user.choose("Kine", "Find")
    view = user.window.view("find")
    assert isinstance(view, FindView)
    return rested(view)


def rested(view: FindView) -> FindView:
    wait_for(lambda: view.up_to_date and not view.busy)
    return view


def seek(view: FindView, what: str) -> FindView:
    """Choose what is wanted from the list."""
    row = view.what.findData(what)
    assert row >= 0, f"{what}: not among {[view.what.itemData(i) for i in range(view.what.count())]}"
    view.what.setFocus()
    QTest.keyClick(view.what, Qt.Key.Key_Home)
    for _ in range(row):
        QTest.keyClick(view.what, Qt.Key.Key_Down)
    settle()
    return rested(view)


def press(button: QPushButton) -> None:
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    settle()


def type_limit(view: FindView, key: str, text: str) -> None:
    box = view.limits.boxes[key]
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, text)
    QTest.keyClick(box, Qt.Key.Key_Return)
    settle()


def text_of(view: FindView) -> str:
    return unescape(re.sub(r"<[^>]*>", "", view.answer.text().replace("<br>", "\n")))


RISE, RETURN, CONVEX = "pressure_angle_rise_deg", "pressure_angle_return_deg", "convex_radius_mm"
USUAL = [
    RISE,
    RETURN,
    CONVEX,
    "polar_radius_mm",
    "loads.least_contact_force_n_min",
    "shaft.speed_rpm_max",
    "cam.base_radius_mm_min",
]


def test_the_answer_is_the_cores_and_is_taken_over_as_one_step(open_user: Open) -> None:
    user = open_user(example("card_picker"))
    view, before = see(user), user.design
    held = ("preload", "spring", "lift-off-speed")
    titles = [view.what.itemText(i) for i in range(view.what.count())]
    assert titles == [
        *(CAM_SEARCHES[what].title for what in ("base-radius", "offset", "roller-radius", "span", *held)),
        "Least flywheel",
        "Top speed",
    ]
    type_limit(view, RETURN, "2*11 + 3")
    rested(view)
    exact = find(before, "base-radius", {RETURN: 25.0})
    wanted = find(before, "base-radius", {RETURN: 25.0}, rounding=0.0)
    radius, given = exact.answer["cam.base_radius_mm"], wanted.answer["cam.base_radius_mm"]
    assert given == pytest.approx(math.ceil(radius * 10.0) / 10.0) == 26.3
    lines = text_of(view).splitlines()
    assert lines[:2] == [
        f"Base radius Br 26.3 mm, exact {radius:.8g} mm: pressure angle, return 24.97° now 50 mm",
        "Pressure angle, return 24.974°, limit 25° now 16.91°",
    ]
    assert lines[2].startswith("Also met: ")
    assert "Convex radius" in lines[2]
    assert [rule.at for rule in view.plot.rules if rule.level] == [25.0]
    answer, now = view.plot.dots
    assert (answer.x[0], answer.y[0]) == pytest.approx((26.3, wanted.reached[RETURN]), abs=1e-6)
    assert (now.x[0], now.y[0]) == pytest.approx((50.0, 16.9141), abs=1e-4)
    x, y = view.plot.lines[0]
    assert x.min() < radius < 50.0 < x.max()
    assert set(zip(x.tolist(), y.tolist(), strict=True)) <= set(wanted.curve)
    press(view.take)
    assert user.design == wanted.design
    assert user.steps == ["Take over base radius Br 26.3 mm"]
    rested(view)
    assert (view.take.text(), view.take.isEnabled()) == ("Taken over", False)
    user.session.stack.undo()
    assert user.design == before
    assert rested(view).take.isEnabled()
    searches = view.searches
    QTest.mouseClick(view.exact, Qt.MouseButton.LeftButton)
    assert text_of(view).splitlines()[0] == f"Base radius Br {radius:.8g} mm now 50 mm"
    press(view.take)
    assert user.design == exact.design
    user.session.stack.undo()
    rested(view)
    QTest.mouseClick(view.exact, Qt.MouseButton.LeftButton)
    assert "exact" in text_of(view), "the switch searches nothing"
    assert view.searches - searches <= 2, "for the design with the result, and for the one before"
    # what is no limit stays as typed, and says so
    type_limit(view, RETURN, "95")
    assert view.limits.message.text() == "Pressure angle, return: outside its range; allowed: above 0 ... 90 °, not 95°"
    assert view.limits.boxes[RETURN].is_refused
    QTest.mouseClick(view.limits.message.buttons["Use 90°"], Qt.MouseButton.LeftButton)
    assert rested(view).limits.boxes[RETURN].value == 90.0
    assert (view.limits.message.isVisible(), view.take.isEnabled()) == (False, True), "a limit that the search accepts"


@pytest.mark.stress
def test_usual_limits_stand_in_grey_with_their_reasons_and_what_is_typed_takes_the_place_of_its_own(
    open_user: Open,
) -> None:
    user = open_user(example("card_picker"))
    view, before = see(user), user.design

    def grey(key: str) -> bool:
        box = view.limits.boxes[key]
        return box.lineEdit().palette().text().color() == QColor(LIGHT.quiet)

    assert list(view.limits.boxes) == USUAL
    assert all(grey(key) for key in USUAL)
    assert [view.limits.boxes[key].value for key in (RISE, RETURN, CONVEX, "cam.base_radius_mm_min")] == [
        30.0,
        30.0,
        5.0,
        20.0,
    ]
    assert view.limits.reasons[CONVEX].text() == "half the roller's radius"
    assert "at 25 MPa (assumed)" in view.limits.boxes["polar_radius_mm"].toolTip()
    assert text_of(view).endswith("Limited by the search range only: twice the roller's radius.")
    type_limit(view, CONVEX, "30")
    rested(view)
    assert [grey(key) for key in USUAL] == [key != CONVEX for key in USUAL]
    assert view.solution is not None
    assert view.solution.answer == find(before, "base-radius", {CONVEX: 30.0}, rounding=0.0).answer
    press(view.limits.removers[CONVEX])  # type: ignore[arg-type]
    assert rested(view).limits.boxes[CONVEX].value == 5.0, "the usual one is back"
    assert grey(CONVEX)
    press(view.limits.removers["cam.base_radius_mm_min"])  # type: ignore[arg-type]
    assert list(rested(view).limits.boxes) == USUAL[:-1], "a usual one can be taken away"
    assert view.solution is not None
    assert view.solution.answer == find(before, "base-radius", {"cam.base_radius_mm_min": None}, rounding=0.0).answer
    # the design's own limit comes in place of the usual one, but not of what was typed
    user.session.put(edited(before, f"limits.{RISE}", 20.0), "Limit")
    assert rested(view).limits.boxes[RISE].value == 20.0
    assert view.solution is not None
    assert view.solution.limits[RISE] == 20.0
    type_limit(view, RISE, "22")
    user.session.put(edited(before, f"limits.{RISE}", 18.0), "Limit")
    assert rested(view).limits.boxes[RISE].value == 22.0
    # the pressure angle over the whole turn stands for that of rise and return
    view.limits.added.emit("pressure_angle_deg")
    type_limit(rested(view), "pressure_angle_deg", "40")
    assert RETURN not in rested(view).limits.boxes
    assert view.solution is not None
    assert view.solution.limits["pressure_angle_deg"] == 40.0


@pytest.mark.stress
def test_a_speed_just_below_that_of_lift_off_is_taken_over(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    view, before = see(user), user.design
    seek(view, "lift-off-speed")
    fact = find(before, "lift-off-speed", {}).answer["shaft.speed_rpm"]
    assert text_of(view).splitlines()[0].startswith(f"Speed 1130 rpm, exact {fact:.8g} rpm: torque ")
    assert "% by rounding" in text_of(view).splitlines()[0], "not the change from the present design"
    torques = next(line for line in text_of(view).splitlines() if line.startswith("Torque "))
    ends = extremes_of(Study(before), "dynamics", ("drive_torque",))["drive_torque"]
    assert torques.endswith(f" now {readable_text(max(abs(ends.low.value), abs(ends.high.value)), 'N·m')}")
    QTest.mouseClick(view.exact, Qt.MouseButton.LeftButton)
    assert text_of(view).splitlines()[0] == f"Speed {fact:.8g} rpm now 300 rpm"
    assert text_of(view).endswith("Applied just below this value, so that the limit is met.")
    press(view.take)
    assert get(user.design, "shaft.speed_rpm") == pytest.approx(fact, rel=1e-8)
    assert get(user.design, "shaft.speed_rpm") < fact
    findings = user.see("findings")
    assert findings.findings == ()  # type: ignore[attr-defined]
    assert (rested(view).take.text(), view.take.isEnabled()) == ("Taken over", False)


def test_a_flywheel_that_is_not_needed_says_what_is_reached_without_and_what_is_assumed(open_user: Open) -> None:
    view = see(open_user(example("card_picker")))
    view.search_for("flywheel")
    rested(view)
    assert "Speed fluctuation C<sub>s</sub> 0.00309" in view.answer.text()
    assert text_of(view).splitlines() == [
        "Flywheel inertia 0 kg·m² now 0 kg·m²",
        "Speed fluctuation Cs 0.003095, limit 0.02 now 0.003095",
        "With an assumed motor slope of 50 N·m·s/rad.",
        "Limited by the search range only.",
    ]


@pytest.mark.stress
def test_where_no_value_serves_the_best_is_shown_with_what_stands_against_it(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    view = see(user)
    view.limits.added.emit("cam.base_radius_mm_max")
    rested(view)
    assert view.limits.boxes["cam.base_radius_mm_max"].value == get(user.design, "cam.base_radius_mm"), (
        "begins with the present one"
    )
    assert view.limits.boxes["cam.base_radius_mm_max"].hasFocus()
    type_limit(view, "cam.base_radius_mm_max", "20")
    type_limit(rested(view), RISE, "10")
    rested(view)
    assert "cam.base_radius_mm_min" in view.limits.boxes, "of 24 mm, which leaves nothing: what is typed holds"
    solution = find(user.design, "base-radius", {RISE: 10.0, "cam.base_radius_mm_max": 20.0})
    assert not solution.is_valid
    text = text_of(view)
    assert text.startswith("No value meets all limits. The closest:\nBase radius")
    assert "Violated: Pressure angle" in text
    assert LIGHT.limit in view.answer.text()
    assert not view.take.isEnabled()
    assert len(view.plot.lines[0][0]) > 10, "the curve all the same"
    seek(view, "arm")
    assert view.limits.boxes[RISE].value == 10.0
    assert "No value meets all limits" in text_of(view), "what was typed holds for it too"


@pytest.mark.stress
def test_a_search_is_cancelled_and_begun_again(open_user: Open) -> None:
    user = open_user(example("transfer_lift"))
    view = see(user)
    view.what.setCurrentIndex(view.what.findData("pivot"))
    view.what.activated.emit(view.what.currentIndex())
    wait_for(view.cancel.isVisible)
    assert not view.take.isVisible()
    assert (view.plot.message, text_of(view)) == ("Searching …", ""), "what stood there answers another question"
    wait_for(lambda: re.fullmatch(r"\d+ designs tried", view.counted.text()) is not None)
    press(view.cancel)
    wait_for(lambda: not view.busy)
    assert view.plot.message == "The search was cancelled."
    assert view.again.isVisible()
    view.what.setCurrentIndex(view.what.findData("base-radius"))
    press(view.again)
    assert rested(view).take.isEnabled()


def test_nothing_is_sought_while_it_is_hidden_or_the_design_has_no_cam(open_user: Open) -> None:
    user = open_user(example("tappet_flat"))
    view = see(user)
    seek(view, "face-width")
    assert list(view.limits.boxes) == []
    assert "Face centre 0 mm" in text_of(view)
    seek(view, "offset")
    assert "does not depend on" in text_of(view)
    before = view.searches
    user.window.docks["find"].hide()
    for radius in (23.0, 24.0):
        user.session.edit("cam.base_radius_mm", radius, "Base radius")
        user.session.end_gesture()
    end_pauses()
    assert view.searches == before
    assert not view.busy
    see(user)
    assert view.searches == before + 1, "once, for the design that is there"
    user.session.put(load(example("four_bar")), "Take the four-bar")
    wait_for(lambda: view.in_trouble)
    assert view.is_unavailable
    assert not view.busy
    user.session.stack.undo()
    assert not rested(view).in_trouble


@pytest.mark.stress
def test_the_list_of_the_design_before_asks_nothing_of_the_next(open_user: Open) -> None:
    user = open_user(example("card_picker"))
    view = see(user)
    user.window.documents.open_example(example("cam_slider_linkage"))
    view.what.setFocus()
    QTest.keyClick(view.what, Qt.Key.Key_End)  # before the view has paused: Least flywheel, and there is no shaft
    settle()
    rested(view)
    assert "flywheel" not in [view.what.itemData(i) for i in range(view.what.count())]
    assert view.answer.text()


@pytest.mark.stress
@pytest.mark.parametrize("name", ["rocker_cam", "four_bar_coupler_cam"])
def test_a_small_window_keeps_its_size_when_find_opens(open_user: Open, name: str) -> None:
    """The reasons of the limits would not fit."""
    user = open_user(example(name), (1280, 720), True)
    user.window.show_task("compo")
    settle()
    sizes = {user.window.size().toTuple()}
    view = see(user)
    for what in ("span", "roller-radius"):
        sizes.add(user.window.size().toTuple())
        seek(view, what)
    assert sizes | {user.window.size().toTuple()} == {(1280, 720)}


@pytest.mark.stress
def test_many_values_are_taken_over_under_the_name_of_what_was_sought(open_user: Open) -> None:
    """Four segments of the card picker go on into each other without rest."""
    user = open_user(example("card_picker"))
    view = see(user)
    press(seek(view, "span").take)
    assert user.steps == ["Take over shortest span of a rise"]


@pytest.mark.stress
def test_the_closing_spring_of_a_valve_is_sought_by_its_wire_and_its_installed_length(open_user: Open) -> None:
    user = open_user()
    user.choose("File", "Examples", "Valve train")
    user.choose("Dyna", "Find closing spring")
    view = user.window.view("find")
    assert isinstance(view, FindView)
    rested(view)
    assert view.what.currentData() == "spring"
    before = user.design
    for what, path in (
        ("spring", "loads.valve_springs[0].wire_mm"),
        ("preload", "loads.valve_springs[0].installed_mm"),
    ):
        seek(view, what)
        solution = find(before, what, {}, rounding=0.0)
        assert set(solution.answer) == {path}
        assert (view.plot.dots[0].x[0], view.plot.dots[0].y[0]) == pytest.approx(
            (solution.answer[path], solution.reached["loads.least_contact_force_n"]), rel=1e-9
        )
    press(view.take)
    assert get(user.design, path) == solution.answer[path]
    user.session.stack.undo()
    assert user.design == before


def lift_with_windows(tmp_path: Path) -> Path:
    """The lift, none of whose strokes may change."""
    design = load(example("transfer_lift"))
    for i in (0, 1, 2, 3):
        design = edited(design, f"motion.segments[{i}].fixed", True)
    save(design, tmp_path / "lift.toml")
    return tmp_path / "lift.toml"


def test_the_top_speed_is_taken_over_and_compared_with_the_design_before(open_user: Open, tmp_path: Path) -> None:
    user = open_user(lift_with_windows(tmp_path))
    view, before = see(user), user.design
    seek(view, "top-speed")
    type_limit_of(view, "contact_force_n", "50000")
    speed = find_top_speed(before, {"contact_force_n": 50000.0}).answer["shaft.speed_rpm"]
    lines = text_of(view).splitlines()
    assert lines[0].startswith("Speed "), lines
    assert "now 20 rpm" in lines[0]
    assert any(line.startswith("Held by contact force: 1 % of relief gives ") for line in lines), lines
    x, y = view.plot.lines[0]
    assert x.tolist() == list(range(1, x.size + 1))
    assert y[-1] == pytest.approx(speed, rel=1e-6)
    press(view.take)
    assert 0.99 * speed < get(user.design, "shaft.speed_rpm") <= speed
    assert len(user.steps) == 1
    pins = Pins.of(user.session)
    assert [row.name for row in pins.rows] == ["top speed", "before top speed"]
    assert pins.front is not None
    assert pins.front.design == before
    user.session.stack.undo()
    assert user.design == before


def type_limit_of(view: FindView, key: str, text: str) -> None:
    """Add a limit from the menu, and type its value."""
    action = next(action for action in view.limits.menu.actions() if action.data() == key)
    action.trigger()
    settle()
    type_limit(view, key, text)
    rested(view)


@pytest.mark.stress
def test_the_transfer_unit_with_outlines_runs_faster_after_one_step(open_user: Open) -> None:
    """Speed, spans and phases change together; nothing meets, and no error or warning is new."""
    user = open_user(example("transfer_unit_outlines"))
    before = user.session.full_design
    view = see(user)
    view.what.setCurrentIndex(view.what.findData("top-speed"))
    view.what.activated.emit(view.what.currentIndex())
    for _ in range(10):  # it takes longer than the patience of a user at the window
        with suppress(AssertionError):
            rested(view)
            break
    lines = text_of(view).splitlines()
    assert "other numbers and laws change" in lines[1]
    assert sum(line.startswith("Held by ") for line in lines) == 3
    assert view.answer.toolTip().count("\n") > 10
    press(view.take)
    machine = user.session.full_design
    assert machine.shaft.speed_rpm > 5.0 * before.shaft.speed_rpm
    assert user.steps == ["Take over top speed"]
    assert all(row.kept for row in distances(machine))
    clearances = Study(machine).clearances
    assert [clearances.required(pair) for pair in clearances.pairs] == [20.0, 20.0, 0.0]
    assert all(clearances.keeps(pair, 1e-3 * clearances.required(pair)) for pair in clearances.pairs)
    assert {finding.severity for finding in findings_of(Study(machine))} <= {"note"}
    user.session.stack.undo()
    assert user.session.full_design == before
