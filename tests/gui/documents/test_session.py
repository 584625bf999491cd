"""kindyna_gui.documents.session: one design, one undo stack; what is wrong changes nothing."""

from pathlib import Path

import pytest

from core.design import edited, get
from core.errors import DesignError, FileError, KindynaError
from core.project import dumps, load
from core.study import evaluations
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.places import example

LIFT = example("transfer_lift")
ROD, ARM = "follower.rod_mm", "follower.roller_arm_mm"


@pytest.fixture
def session(app: object) -> Session:
    return Session(load(LIFT))


def steps(session: Session) -> list[str]:
    return [session.stack.text(i) for i in range(session.stack.count())]


def refusals(session: Session) -> list[Refusal]:
    heard: list[Refusal] = []
    session.refused.connect(heard.append)
    return heard


# -- steps ------------------------------------------------------------------------------------------------


def test_an_edit_is_a_step_with_a_name(session: Session) -> None:
    before = session.design
    assert session.edit(ROD, 850.0, "Change rod L2 to 850 mm")
    assert get(session.design, ROD) == 850.0
    assert session.stack.undoText() == "Change rod L2 to 850 mm"
    session.stack.undo()
    assert session.design == before
    assert session.stack.redoText() == "Change rod L2 to 850 mm"
    session.stack.redo()
    assert get(session.design, ROD) == 850.0


def test_a_clearance_between_bodies_of_two_drives_is_edited_from_any_drive(app: object) -> None:
    session = Session(load(example("transfer_unit_outlines")))
    path, before = "clearances[1].least_mm", session.full_design
    for drive in (0, 1):
        assert session.choose_drive(drive)
        assert session.edit(path, 21.0 + drive, "Change least clearance")
        assert get(session.full_design, path) == 21.0 + drive
        assert session.mark_assumed(path, True, "Mark least clearance as assumed")
        assert path in session.full_design.assumed
        session.stack.undo()
        session.stack.undo()
    assert session.full_design == before


def test_one_gesture_is_one_step(session: Session) -> None:
    for value in (846.0, 847.0, 848.0):
        session.edit(ROD, value, f"to {value:g}")
    assert steps(session) == ["to 848"]
    session.stack.undo()
    assert get(session.design, ROD) == 845.0


def test_a_gesture_that_comes_back_leaves_no_step(session: Session) -> None:
    for value in (846.0, 847.0, 845.0):
        session.edit(ROD, value, f"to {value:g}")
    assert steps(session) == []
    assert not session.modified
    session.edit(ROD, 846.0, "to 846")
    assert steps(session) == ["to 846"]


def test_gestures_and_paths_are_apart(session: Session) -> None:
    session.edit(ROD, 846.0, "a")
    session.end_gesture()
    session.edit(ROD, 847.0, "b")
    session.edit("follower.pivot_y_mm", -60.0, "c")
    session.edit(ROD, 848.0, "d")
    assert steps(session) == ["a", "b", "c", "d"]


def test_undo_ends_a_gesture(session: Session) -> None:
    session.edit(ROD, 846.0, "a")
    session.stack.undo()
    session.stack.redo()
    session.edit(ROD, 847.0, "b")
    assert steps(session) == ["a", "b"]


def test_the_same_value_is_no_step(session: Session) -> None:
    assert session.edit(ROD, 845.0, "nothing")
    assert steps(session) == []


def test_what_goes_with_a_change_goes_in_the_same_step(session: Session) -> None:
    before = session.design
    session.edit("motion.segments[1].rise_mm", -120.0, "a")
    assert [s.rise for s in session.design.drive.motion.segments] == [0.0, -120.0, 0.0, 120.0, 0.0]
    session.stack.undo()
    assert session.design == before


def test_typed_and_restored_changes_are_told_apart(session: Session) -> None:
    told: list[str] = []
    session.design_changed.connect(lambda: told.append("changed"))
    session.restored.connect(lambda: told.append("restored"))
    session.edit(ROD, 846.0, "a")
    assert told == ["changed"]
    session.stack.undo()
    session.stack.redo()
    session.start(load(LIFT))
    assert told == ["changed", *["restored", "changed"] * 3]


# -- what is wrong ----------------------------------------------------------------------------------------


def test_a_wrong_value_changes_nothing(session: Session) -> None:
    heard, before, study = refusals(session), session.design, session.study
    assert not session.edit(ROD, -1.0, "a")
    assert (session.design, session.study) == (before, study)
    assert steps(session) == []
    assert [r.path for r in heard] == [ROD]
    assert heard[0].at(ROD).startswith("Outside its range; allowed: ")
    assert heard[0].at("cam.base_radius_mm") == ""


def test_a_fault_elsewhere_is_told_at_both_fields(session: Session) -> None:
    heard = refusals(session)
    assert not session.put(
        edited(session.design, "motion.segments[1].span_deg", 300.0), "a", "motion.segments[1].span_deg"
    )
    own, other = heard[0].at("motion.segments[1].span_deg"), heard[0].at("motion.segments[2].span_deg")
    assert own.startswith("Segment 3, span: outside its range")
    assert other.startswith("Outside its range")


def test_a_value_without_answer_waits_where_the_answer_is_on_screen(session: Session) -> None:
    assert session.edit(ARM, 10.0, "unseen")
    assert session.incomplete is None
    session.stack.undo()
    session.stages_on_screen = lambda: ("motion", "linkage")
    assert session.edit(ARM, 10.0, "seen")
    assert session.misfit.at(ARM).startswith("The roller cannot reach the base circle")
    assert (get(session.design, ARM), get(session.typed, ARM)) == (651.081, 10.0)
    session.stack.undo()
    assert session.edit("follower.pivot_x_mm", 2900.0, "seen")
    assert "make the roller arm" in session.misfit.at(ARM)
    assert session.misfit.at("follower.pivot_x_mm").startswith("Roller arm Zl: the roller cannot reach")


def test_what_is_put_in_place_whole_is_refused_where_it_has_no_answer(session: Session) -> None:
    heard = refusals(session)
    session.stages_on_screen = lambda: ("motion", "linkage")
    assert not session.put(edited(session.design, ARM, 10.0), "an answer of another view", ARM)
    assert heard[0].at(ARM).startswith("The roller cannot reach the base circle")
    assert (session.incomplete, steps(session)) == (None, [])


def test_only_stages_on_screen_are_computed(session: Session) -> None:
    session.edit(ROD, 846.0, "a")
    assert not evaluations
    session.stages_on_screen = lambda: ("motion", "linkage")
    session.edit(ROD, 847.0, "b")
    assert dict(evaluations) == {"motion": 1, "linkage": 1}


def test_what_cannot_be_tried_is_refused_too(session: Session) -> None:
    heard: list[object] = refusals(session)
    session.accepted.connect(heard.append)
    session.refuse(ROD, "enter a number")
    assert heard == [Refusal(ROD, ((ROD, "Rod L2", "enter a number"),))]
    session.withdraw(ROD)
    assert heard[1] == ROD


# -- files ------------------------------------------------------------------------------------------------


def test_saved_file_is_the_design_as_typed(session: Session, tmp_path: Path) -> None:
    expected = LIFT.read_text(encoding="utf-8").replace("rod_mm = 845.0", "rod_mm = 850.0")
    session.edit(ROD, 850.0, "a")
    session.save(tmp_path / "mine.toml")
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8") == expected
    assert (session.path, session.modified) == (tmp_path / "mine.toml", False)


def test_saving_ends_a_gesture_and_undo_knows_it(session: Session, tmp_path: Path) -> None:
    session.edit(ROD, 850.0, "a")
    session.save(tmp_path / "mine.toml")
    session.edit(ROD, 851.0, "b")
    assert steps(session) == ["a", "b"]
    assert session.modified
    session.stack.undo()
    assert not session.modified
    session.stack.undo()
    assert session.modified


def test_a_design_without_file_asks_for_one(session: Session) -> None:
    with pytest.raises(KindynaError, match="no file name"):
        session.save()


def test_a_file_that_cannot_be_written_changes_nothing(session: Session, tmp_path: Path) -> None:
    session.edit(ROD, 850.0, "a")
    with pytest.raises(FileError):
        session.save(tmp_path)
    assert (session.path, session.modified) == (None, True)


def test_opening_begins_anew(session: Session) -> None:
    session.edit(ROD, 850.0, "a")
    session.open(LIFT)
    assert (session.path, session.modified, steps(session)) == (LIFT, False, [])
    assert get(session.design, ROD) == 845.0


@pytest.mark.parametrize("text", ["", "format = 1\n", "not toml"])
def test_a_bad_file_changes_nothing(session: Session, tmp_path: Path, text: str) -> None:
    session.edit(ROD, 850.0, "a")
    before = session.design
    (tmp_path / "bad.toml").write_text(text, encoding="utf-8")
    with pytest.raises(DesignError):
        session.open(tmp_path / "bad.toml")
    assert (session.design, session.path, steps(session)) == (before, None, ["a"])


def test_every_step_can_be_taken_back_and_made_again(session: Session) -> None:
    texts = [dumps(session.design)]
    for path, value in ((ROD, 850.0), ("follower.layout", "c"), ("motion.stroke_mm", 140.0), ("name", "Mine")):
        assert session.edit(path, value, path)
        texts.append(dumps(session.design))
    for text in reversed(texts[:-1]):
        session.stack.undo()
        assert dumps(session.design) == text
    for text in texts[1:]:
        session.stack.redo()
        assert dumps(session.design) == text
