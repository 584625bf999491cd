"""Optimal laws take long: they are solved beside the window, which says so, stays usable, and then shows their results."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import scipy.optimize
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel
from window_user import Open, User, settle, wait_for

from core.design import CurveBound, Design, edited, put
from core.project import load, save
from kindyna_gui import dialogs
from kindyna_gui.documents.pins import Pins
from kindyna_gui.places import example

JERK = "motion.segments[1].limits.jerk"
MASS = "loads.follower_mass_kg"
CALCULATED = "its law is being calculated"


class Solver:
    """Solves linear programs, once the test opens the gate; notes those that the window's thread had to wait for."""

    def __init__(self) -> None:
        self.gate = threading.Event()
        self.gate.set()
        self.by_window = self.solved = 0
        self._solve = scipy.optimize.linprog

    def __call__(self, *arguments: object, **options: object) -> object:
        self.solved += 1
        if threading.current_thread() is threading.main_thread():
            self.by_window += 1
        else:
            assert self.gate.wait(40.0)
        return self._solve(*arguments, **options)


@pytest.fixture
def solver(monkeypatch: pytest.MonkeyPatch) -> Iterator[Solver]:
    solver = Solver()
    monkeypatch.setattr(scipy.optimize, "linprog", solver)
    yield solver
    solver.gate.set()
    assert solver.by_window == 0, "the window's thread solved a law"


_numbers = iter(range(1, 1000))


def new_design() -> Design:
    """A drive with a law of least torque that no test has solved yet, of few intervals."""
    design = load(example("slide_past_tool"))
    design = put(edited(design, "motion.segments[1].intervals", 12), "motion.segments[3].intervals", 12)
    return edited(design, MASS, 8.0 + 0.001 * next(_numbers))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    save(new_design(), tmp_path / "slide.toml")
    return tmp_path / "slide.toml"


@pytest.fixture
def user(same_window: Open, solver: Solver, path: Path) -> User:
    """A user at a design whose laws are solved."""
    user = same_window(path)
    assert user.session.has_laws
    return user


def opened(user: User, path: Path, solver: Solver) -> None:
    """Open a file whose laws are not solved before the gate is opened."""
    user.answers(dialogs.SaveAnswer.DISCARD)
    solver.gate.clear()
    assert user.window.documents.open_path(path)
    settle()


def texts(user: User) -> list[str]:
    labels = user.window.findChildren(QLabel)
    return [label.text() for label in labels if label.isVisible() and CALCULATED in label.text()]


def finish(user: User, solver: Solver) -> None:
    solver.gate.set()
    user.wait_for_laws()


def test_an_opened_design_is_shown_once_its_laws_are_known(same_window: Open, solver: Solver, path: Path) -> None:
    user = same_window()
    user.see("torque")
    opened(user, path, solver)
    assert user.session.path == path
    assert not user.session.modified
    assert len(texts(user)) >= 2, "drawing and plot say that the law is calculated"
    assert user.window.status.pending.text() == "Stop calculating the laws of the motion"
    assert not user.window.status.pending.isHidden()
    # the window can be used: a menu, a key, another view
    user.choose("View", "Dyna")
    user.press(Qt.Key.Key_F7)
    assert "slide.toml" in user.window.windowTitle()
    user.choose("Edit", "Pin this variant")
    assert "laws of the motion are being calculated" in user.window.status.currentMessage()
    finish(user, solver)
    settle()
    assert texts(user) == []
    assert user.session.full_design == load(path)
    assert not user.session.modified
    assert user.session.study.dynamics.torque.max() > 0.0
    assert user.window.status.pending.isHidden()
    assert solver.solved > 10


def test_what_is_typed_takes_effect_once_the_law_is_known(user: User, solver: Solver) -> None:
    before = user.design
    solver.gate.clear()
    user.enter(MASS, "9")
    assert user.design == before, "the last design stays on the screen"
    assert user.session.typed.drive.loads.follower_mass_kg == 9.0
    assert user.field(MASS).trouble == "", "nothing is wrong with it"
    # the next number is being typed while the law comes
    box = user.number("follower.offset_mm")
    box.selectAll()
    user.type("1.2")
    finish(user, solver)
    settle()
    assert user.design.drive.loads.follower_mass_kg == 9.0
    assert box.pending
    assert box.text() == "1.2"
    user.press(Qt.Key.Key_Escape)
    assert user.steps == ["Change follower mass to 9 kg"]
    # the laws of earlier steps are known
    solver.gate.clear()
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert user.design == before
    user.choose("Edit", f"Redo {user.steps[-1]}")
    assert user.design.drive.loads.follower_mass_kg == 9.0
    assert user.session.incomplete is None


def test_steps_taken_while_a_law_is_calculated_are_undone_one_by_one(user: User, solver: Solver) -> None:
    before = user.design
    solver.gate.clear()
    user.enter(MASS, "9.5")
    user.enter("loads.friction", "0.2")
    assert len(user.steps) == 2
    user.choose("Edit", f"Undo {user.steps[-1]}")
    assert user.design == before
    assert (user.session.typed.drive.loads.follower_mass_kg, user.session.typed.drive.loads.friction) == (9.5, 0.1)
    finish(user, solver)
    assert user.design == edited(before, MASS, 9.5)
    user.choose("Edit", f"Undo {user.steps[0]}")
    assert user.design == before
    assert not user.session.modified


def test_a_limit_that_no_law_keeps_is_said_once_that_is_known(user: User, solver: Solver) -> None:
    before = user.design
    solver.gate.clear()
    user.enter(JERK, "20")
    assert user.field(JERK).trouble == ""
    finish(user, solver)
    assert user.design == before
    assert "No law keeps this limit" in user.field(JERK).trouble
    user.enter(JERK, "90")
    wait_for(lambda: user.session.incomplete is None)
    assert user.design == edited(before, JERK, 90.0)


def test_the_calculation_is_stopped_and_begun_again(user: User, solver: Solver) -> None:
    button = user.window.status.pending
    solver.gate.clear()
    user.enter(MASS, "7")
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    assert button.text() == "Calculate again"
    solver.gate.set()
    settle()
    assert user.session.typed.drive.loads.follower_mass_kg == 7.0 != user.design.drive.loads.follower_mass_kg
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    wait_for(lambda: user.session.incomplete is None)
    assert user.design.drive.loads.follower_mass_kg == 7.0


def test_what_is_calculated_is_saved_without_a_question(user: User, solver: Solver, path: Path) -> None:
    solver.gate.clear()
    user.enter(MASS, "6.5")
    user.choose("File", "Save")
    assert load(path).drive.loads.follower_mass_kg == 6.5
    assert not user.session.modified
    finish(user, solver)
    assert user.design == load(path)
    assert not user.session.modified


def test_a_file_to_compare_with_is_drawn_once_its_laws_are_known(
    user: User, solver: Solver, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path / "other.toml"
    save(new_design(), other)
    monkeypatch.setattr(dialogs, "design_to_open", lambda *_: other)
    plot = user.see("torque")
    solver.gate.clear()
    user.choose("Edit", "Compare with another file...")
    assert plot.up_to_date
    assert not plot.in_trouble
    solver.gate.set()
    wait_for(lambda: Pins.of(user.session).study is not None)


def test_a_dragged_limit_waits_for_its_law(user: User, solver: Solver) -> None:
    """The limit of an obstacle is changed as by the mouse: the diagram keeps the last law meanwhile."""
    before = user.design
    solver.gate.clear()
    user.session.begin_drag(user.motion().diagram)
    for level in (0.26, 0.27, 0.28):
        below = (CurveBound(0.0, 0.4, level),)
        assert user.session.put(edited(before, "motion.segments[3].below", below), "Move obstacle", "motion.obstacle")
    user.session.end_drag()
    assert user.design == before
    finish(user, solver)
    assert user.design.drive.motion.segments[3].curve.below == below
    assert user.steps == ["Move obstacle"]
    user.choose("Edit", "Undo Move obstacle")
    assert user.design == before
