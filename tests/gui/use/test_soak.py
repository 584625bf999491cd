"""The window in motion for long: no reference is lost, no memory is kept. Some versions of Qt's bindings lost a
reference to None in each frame and ended the interpreter with it."""

import gc
import sys
from pathlib import Path

import pytest
from PySide6.QtCore import QCoreApplication, QEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User

from kindyna_gui.places import example, examples

LOST = 40  # references to None that may come and go by chance
WARM = 40  # frames until caches are filled
EDIT_EVERY = 25  # frames


@pytest.fixture
def whole(open_user: Open) -> User:
    """Nothing has been done in it before."""
    return open_user(whole=True)


@pytest.fixture
def user(whole: User) -> User:
    return whole


def memory() -> int:
    """Resident memory of this process [bytes]; 0 where the system does not tell."""
    status = Path("/proc/self/statm")
    return int(status.read_text("utf-8").split()[1]) * 4096 if status.is_file() else 0


def turn(user: User, frames: int, first: int = 0) -> None:
    """Play so many frames, editing now and then."""
    player = user.window.player
    for frame in range(first, first + frames):
        player.advance(0.016)
        if frame % EDIT_EVERY == 0:
            # few values, so that caches of results do not count as growth
            user.session.edit("motion.stroke", 150.0 + frame // EDIT_EVERY % 3, "Change stroke")
        QApplication.processEvents()
    user.session.stack.undo()
    QApplication.processEvents()


def watch(user: User, frames: int, most_growth: int) -> None:
    for name in ("velocity", "curvature", "contact_force", "certificate"):
        user.window.show_view(name)
    user.window.view("mechanism").show_layer("forces", True)  # type: ignore[union-attr]
    turn(user, WARM)
    gc.collect()
    references, bytes_before = sys.getrefcount(None), memory()
    turn(user, frames, WARM)
    gc.collect()
    assert sys.getrefcount(None) > references - LOST
    assert memory() - bytes_before < most_growth


@pytest.mark.stress
def test_some_frames_lose_nothing(user: User) -> None:
    watch(user, 60, 12_000_000)


@pytest.mark.soak
def test_two_thousand_frames_lose_nothing(user: User) -> None:
    watch(user, 2000, 24_000_000)


@pytest.mark.soak
def test_views_that_come_and_go_are_freed(user: User) -> None:
    """The graph makes its plots anew; the drawing makes its parts anew with each edit."""
    view = user.window.show_view("graph")
    for round_ in range(60):
        for form in ("polar", "straight"):
            view.set_form(form)  # type: ignore[attr-defined]
            QApplication.processEvents()
            QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        if round_ == 10:
            gc.collect()
            before, references = memory(), sys.getrefcount(None)
    gc.collect()
    assert memory() - before < 16_000_000
    assert sys.getrefcount(None) > references - LOST


@pytest.mark.soak
@pytest.mark.parametrize(
    "names", [("transfer_lift", "four_bar_coupler_cam"), tuple(path.stem for _, path in examples())]
)
def test_a_window_survives_any_number_of_designs(user: User, names: tuple[str, ...]) -> None:
    for number in range(364):
        user.session.stack.setClean()
        user.window.documents.open_example(example(names[number % len(names)]))
        QTest.qWait(60)
