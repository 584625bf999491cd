"""A motion that does not come back yet: what was typed stays, and the last whole one is shown."""

import json
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from sampled import spread
from window_user import Open, User

from core.design import Motion, NamedCurve, edited, faults, insert_segment, rise_gap, span_gap, stroke
from core.errors import DesignError
from core.project import dumps, load
from kindyna_gui.documents.session import Session
from kindyna_gui.motion.segments_table import JOIN, LAW, RISE, SPAN
from kindyna_gui.places import example

LIFT = load(example("transfer_lift"))
AT_REST = edited(LIFT, "motion.segments[1].law", "dwell")
"""The lift with five dwells."""


@pytest.fixture
def session(app: object) -> Session:
    return Session(AT_REST)


def typed(session: Session) -> Motion:
    motion: Motion = session.typed.drive.motion
    return motion


def lay_out(session: Session) -> None:
    """A law and 40 mm for segment 2, of which no other brings the follower back."""
    session.edit("motion.segments[1].law", "cycloidal", "a law")
    assert session.edit("motion.segments[1].rise_mm", 40.0, "a rise")


# -- what is typed ----------------------------------------------------------------------------------------


def test_a_rise_without_a_return_stays_beside_the_last_whole_motion(session: Session) -> None:
    session.edit("motion.segments[3].law", "dwell", "no return")
    session.edit("motion.segments[1].law", "cycloidal", "a law")
    whole = session.design
    assert session.edit("motion.segments[1].rise_mm", 40.0, "a rise")
    assert session.design is whole
    assert session.incomplete is not None
    assert [s.rise for s in typed(session).segments] == [0.0, 40.0, 0.0, 0.0, 0.0]
    assert rise_gap(typed(session)) == 40.0


def test_a_dwell_that_is_given_a_law_is_the_return_that_closes_it(session: Session) -> None:
    session.edit("motion.segments[3].law", "dwell", "no return")
    lay_out(session)
    assert session.incomplete is not None
    assert session.edit("motion.segments[3].law", "cycloidal", "another law")
    assert session.incomplete is None
    assert [s.rise for s in session.design.drive.motion.segments] == [0.0, 40.0, 0.0, -40.0, 0.0]


def test_undo_and_redo_go_through_it_step_by_step(session: Session) -> None:
    session.edit("motion.segments[3].law", "dwell", "no return")
    states = [(session.design, session.incomplete)]
    for path, value in (("law", "cycloidal"), ("rise_mm", 40.0), ("span_deg", 300.0)):
        session.edit(f"motion.segments[1].{path}", value, path)
        session.end_gesture()
        states.append((session.design, session.incomplete))
    session.edit("follower.rod_mm", 846.0, "the rod")
    states.append((session.design, session.incomplete))
    assert states[-1][1] is not None
    for state in reversed(states[:-1]):
        session.stack.undo()
        assert (session.design, session.incomplete) == state
    for state in states[1:]:
        session.stack.redo()
        assert (session.design, session.incomplete) == state


def test_spans_that_make_no_turn_stay(session: Session) -> None:
    assert session.edit("motion.segments[1].span_deg", 300.0, "too long")
    assert session.design is AT_REST
    assert [s.span_deg for s in typed(session).segments] == [35.0, 300.0, 207.0, 41.5, 35.0]
    assert span_gap(typed(session)) == 258.5
    assert session.edit("motion.segments[2].span_deg", 5.0, "shorter")
    assert span_gap(typed(session)) == 56.5
    assert session.edit("motion.segments[1].span_deg", 243.5, "shorter")
    assert session.incomplete is None
    assert [s.span_deg for s in session.design.drive.motion.segments] == [35.0, 243.5, 5.0, 41.5, 35.0]


def test_a_value_typed_anew_is_balanced_as_ever(session: Session) -> None:
    session.edit("motion.segments[1].span_deg", 300.0, "too long")
    session.edit("motion.segments[1].span_deg", 45.0, "right")
    assert session.incomplete is None
    assert [s.span_deg for s in session.design.drive.motion.segments] == [35.0, 45.0, 203.5, 41.5, 35.0]


def test_what_no_other_value_can_mend_is_refused(session: Session) -> None:
    heard: list[object] = []
    session.refused.connect(heard.append)
    assert not session.edit("motion.segments[1].span_deg", 400.0, "longer than a turn")
    assert session.incomplete is None
    assert len(heard) == 1


def test_a_law_that_only_returns_waits_for_its_rise(session: Session) -> None:
    assert session.edit("motion.segments[3].law", "c6", "a return")
    assert session.incomplete is not None
    assert session.edit("motion.segments[1].law", "c5", "a rise")
    assert session.edit("motion.segments[1].rise_mm", 40.0, "of 40")
    assert session.incomplete is None
    assert [s.rise for s in session.design.drive.motion.segments] == [0.0, 40.0, 0.0, -40.0, 0.0]


def test_a_whole_motion_without_an_answer_stays_until_it_has_one(session: Session) -> None:
    session.stages_on_screen = lambda: ("motion", "linkage")
    session.edit("motion.segments[3].law", "dwell", "no return")
    session.edit("motion.segments[1].law", "cycloidal", "a law")
    session.edit("motion.segments[1].rise_mm", 2500.0, "too far for the rod")
    session.edit("motion.segments[3].law", "cycloidal", "a law")
    session.edit("motion.segments[3].rise_mm", -2500.0, "and back")
    assert session.incomplete is not None
    assert "cannot reach the slider" in session.misfit.reasons[0][2]
    assert session.edit("follower.rod_mm", 900.0, "a longer rod")
    assert session.incomplete is None
    assert session.design.drive.motion.segments[1].rise == 2500.0


# -- other changes ----------------------------------------------------------------------------------------


def test_other_values_change_beside_it(session: Session) -> None:
    session.edit("motion.segments[1].span_deg", 300.0, "too long")
    unfinished = typed(session)
    assert session.edit("shaft.speed_rpm", 30.0, "faster")
    assert typed(session) == unfinished
    assert session.design.shaft.speed_rpm == session.typed.shaft.speed_rpm == 30.0


def test_another_motion_takes_its_place_and_undo_brings_it_back(session: Session) -> None:
    session.edit("motion.segments[1].span_deg", 300.0, "too long")
    draft = session.incomplete
    assert session.put(insert_segment(session.design, 2), "another motion")
    assert session.incomplete is None
    session.stack.undo()
    assert session.incomplete == draft


def test_another_design_leaves_it_behind_and_undo_brings_it_back(session: Session) -> None:
    session.edit("motion.segments[1].span_deg", 300.0, "too long")
    draft = session.incomplete
    session.begin(load(example("card_picker")), "another")
    assert session.incomplete is None
    session.stack.undo()
    assert session.incomplete == draft


def test_views_hear_of_it(session: Session) -> None:
    heard: list[str] = []
    session.incomplete_changed.connect(lambda: heard.append("draft"))
    session.design_changed.connect(lambda: heard.append("design"))
    session.edit("motion.segments[1].span_deg", 300.0, "too long")
    session.edit("motion.segments[1].span_deg", 45.0, "right")
    session.stack.undo()
    assert heard == ["draft", "draft", "design", "design"]


# -- closing ----------------------------------------------------------------------------------------------


def test_it_is_closed_by_a_return(session: Session) -> None:
    session.edit("motion.segments[3].law", "dwell", "no return")
    lay_out(session)
    assert session.close_motion()
    assert session.incomplete is None
    assert faults(session.design) == []
    assert session.design.drive.motion.segments[1].rise == 40.0
    session.stack.undo()
    assert rise_gap(typed(session)) == 40.0


def test_it_is_dropped_and_undo_brings_it_back(session: Session) -> None:
    session.edit("motion.segments[1].span_deg", 300.0, "too long")
    draft = session.incomplete
    session.drop_incomplete()
    assert (session.design, session.incomplete) == (AT_REST, None)
    assert session.stack.undoText() == "Back to the last valid values"
    session.stack.undo()
    assert session.incomplete == draft


# -- files and recovery -----------------------------------------------------------------------------------


def test_it_counts_as_unsaved_and_stays_out_of_the_file(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    session.edit("motion.segments[1].span_deg", 300.0, "too long")
    with pytest.raises(DesignError):
        session.save(path)
    session.save(path, last_valid=True)
    assert load(path) == AT_REST
    assert session.modified
    assert session.incomplete is not None
    session.stack.undo()
    assert not session.modified


def test_its_state_goes_through_text_and_back(session: Session, app: object) -> None:
    session.edit("motion.segments[3].law", "dwell", "no return")
    lay_out(session)
    session.mark_assumed("motion.segments[1].rise_mm", True, "a guess")
    state = json.loads(json.dumps(session.state()))
    other = Session(LIFT)
    other.restore(state)
    assert (other.design, other.incomplete) == (session.design, session.incomplete)
    assert other.typed == session.typed
    assert other.modified
    assert not other.stack.canUndo()
    assert other.state() == state


def test_a_saved_design_is_restored_as_saved(session: Session) -> None:
    state = session.state()
    other = Session(LIFT)
    other.restore(state)
    assert (other.design, other.path, other.modified) == (AT_REST, None, False)


@pytest.mark.parametrize(
    "wrong",
    [
        {},
        {"design": "format = 1", "path": None, "modified": True, "draft": None},
        {"design": dumps(LIFT), "path": None, "modified": True, "draft": {}},
        {"design": dumps(LIFT), "path": 3, "modified": True, "draft": None},
        {"design": dumps(LIFT), "path": None, "modified": True, "draft":
            {"design": dumps(LIFT).replace("rod_mm = 845.0", "rod_mm = -845.0"), "path": "", "reasons": []}},
    ],
)  # fmt: skip
def test_a_state_that_cannot_be_read_changes_nothing(session: Session, wrong: dict[str, object]) -> None:
    with pytest.raises(DesignError):
        session.restore(wrong)
    assert session.design is AT_REST


# -- in the window ----------------------------------------------------------------------------------------


def column(user: User, number: int) -> list[str]:
    return [user.cell(row, number) for row in range(user.motion().model.rowCount())]


def choose_law(user: User, row: int, slug: str) -> None:
    view = user.motion()
    view.choose(row, LAW)
    view.model.setData(view.model.index(row, LAW), slug)
    user.session.end_gesture()


def rise_alone(user: User) -> None:
    """A new design left with dwells; by keys, a law and 40 mm for its second segment."""
    user.choose("File", "New by type", "Translating follower")
    view = user.motion()
    for row in (2, 0):
        view.choose(row)
        view.table.setFocus()
        user.press(Qt.Key.Key_Delete)
    for _ in range(3):
        view.choose(0)
        view.table.setFocus()
        user.press(Qt.Key.Key_Insert)
    choose_law(user, 1, "cycloidal")
    user.enter_cell(1, RISE, "40")


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window()


@pytest.mark.stress
def test_a_new_design_to_which_segments_are_added_keeps_what_is_typed(user: User) -> None:
    """As the program begins it: insert three times, a law and 40 mm for segment 2."""
    user.choose("File", "New by type", "Translating follower")
    user.choose("Make", "Motion table")
    for _ in range(3):
        user.motion().choose(0)
        user.choose("Make", "Insert segment")
    choose_law(user, 1, "cycloidal")
    user.enter_cell(1, RISE, "40")
    assert column(user, RISE)[1] == "40"
    assert user.session.typed.drive.motion.segments[1].rise == 40.0


def test_a_rise_alone_is_marked_with_what_it_misses_and_what_would_close_it(user: User) -> None:
    rise_alone(user)
    view, whole = user.motion(), user.design.drive.motion
    assert stroke(whole) == 0.0
    assert view.diagram.motion == whole, "drawings keep the last whole motion"
    assert view.model.is_faulty(1, RISE)
    assert view.incomplete_bar.isVisible()
    assert view.incomplete_bar.trouble.text() == "Segment 2, rise: the follower ends 40 mm above its start"
    assert "\u221240 mm" in view.incomplete_bar.remedy.text()
    assert user.cell(view.model.rowCount() - 1, JOIN).startswith("Δs")
    assert user.number("motion.stroke_mm").value == 40.0
    assert user.window.isWindowModified()


def test_the_button_closes_it_and_undo_opens_it_again(user: User) -> None:
    rise_alone(user)
    view = user.motion()
    QTest.mouseClick(view.incomplete_bar.close_button, Qt.MouseButton.LeftButton)
    assert faults(user.design) == []
    assert stroke(user.design.drive.motion) == 40.0
    assert not view.incomplete_bar.isVisible()
    user.choose("Edit", "Undo Close the motion")
    assert view.incomplete_bar.isVisible()
    assert column(user, RISE)[1] == "40"


def test_the_diagram_of_the_last_whole_motion_cannot_be_drawn_at(user: User) -> None:
    user.enter_cell(1, SPAN, "300")
    view, draft = user.motion(), user.session.incomplete
    place = view.diagram.position_of_join(1).toPoint()
    QTest.mousePress(view.diagram.viewport(), Qt.MouseButton.LeftButton, pos=place)
    QTest.mouseMove(view.diagram.viewport(), place + QPoint(30, 0))
    QTest.mouseRelease(view.diagram.viewport(), Qt.MouseButton.LeftButton, pos=place + QPoint(30, 0))
    view.table.setFocus()
    user.press(Qt.Key.Key_Right, modifier=Qt.KeyboardModifier.AltModifier)
    assert user.session.incomplete == draft
    assert user.steps == ["Change span of segment 2 to 300°"]


def test_segments_come_and_go_in_it(user: User) -> None:
    user.enter_cell(1, SPAN, "300")
    view = user.motion()
    enabled = [name for name, button in view.bar.buttons.items() if button.isEnabled()]
    assert enabled == ["insert", "delete"], "the others take a whole turn"
    view.choose(2)
    QTest.mouseClick(view.bar.buttons["insert"], Qt.MouseButton.LeftButton)
    assert column(user, SPAN) == ["35", "300", "103.5", "103.5", "41.5", "35"]
    view.choose(3)
    QTest.mouseClick(view.bar.buttons["delete"], Qt.MouseButton.LeftButton)
    assert column(user, SPAN) == ["35", "300", "207", "41.5", "35"]
    user.enter_cell(1, SPAN, "41.5")
    assert user.design == LIFT
    assert user.session.incomplete is None


def test_the_curve_of_a_segment_that_only_the_draft_has_is_edited(user: User) -> None:
    view = user.motion()
    view.choose(4)
    user.enter_cell(1, SPAN, "300")
    for _ in range(2):
        view.choose(view.model.rowCount() - 1)
        QTest.mouseClick(view.bar.buttons["insert"], Qt.MouseButton.LeftButton)
    choose_law(user, 6, "cycloidal")
    view.choose(6)
    user.enter("motion.segments[6].crossover", "0.4")
    assert user.session.typed.drive.motion.segments[6].curve == NamedCurve("cycloidal", 0.4)


@pytest.mark.parametrize(
    ("button", "height", "left"),
    spread([("Close the motion and save", 40.0, False), ("Save the last valid version", 0.0, True)], 1),
)
def test_save_offers_to_close_it_or_to_save_the_last_whole_motion(
    user: User, tmp_path: Path, button: str, height: float, left: bool
) -> None:
    path = tmp_path / "own.toml"
    user.picks("design_to_save", path)
    rise_alone(user)
    asked = user.clicks(button)
    user.choose("File", "Save")
    assert asked == ["The typed values do not fit together yet."]
    assert stroke(load(path).drive.motion) == height
    assert (user.session.incomplete is not None) is left
    assert user.window.isWindowModified() is left
    assert column(user, RISE)[1] == "40"


@pytest.mark.stress
def test_save_may_be_called_off(user: User, tmp_path: Path) -> None:
    user.picks("design_to_save", tmp_path / "own.toml")
    rise_alone(user)
    user.clicks("Cancel")
    user.choose("File", "Save as...")
    assert list(tmp_path.iterdir()) == []
    assert column(user, RISE)[1] == "40"


@pytest.mark.stress
def test_a_linkage_has_drafts_too(same_window: Open) -> None:
    user = same_window(example("four_bar_coupler_cam"))
    before, spans = user.design, column(user, SPAN)
    user.enter_cell(1, SPAN, "300")
    assert user.design == before
    assert column(user, SPAN) == [spans[0], "300", *spans[2:]]
    user.window.show_view("parameters")
    user.choose("Edit", "Undo Change span of segment 2 to 300°")
    assert column(user, SPAN) == spans
