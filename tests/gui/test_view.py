"""kindyna_gui.view, docks: a view computes when, and only when, it can be seen."""

from collections.abc import Callable, Iterator
from threading import Event, Thread, current_thread, main_thread

import pytest
from PySide6.QtCore import QCoreApplication, QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QHBoxLayout, QMainWindow, QWidget
from window_user import settle, wait_for

from core.project import load
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.places import example
from kindyna_gui.player import Player
from kindyna_gui.view import View
from kindyna_gui.window.docks import Dock, ViewRow

ROD = "follower.rod_mm"
RIGHT = Qt.DockWidgetArea.RightDockWidgetArea


class Recorder(View):
    """Counts what it is asked."""

    stages = ("motion", "linkage")

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.rods: list[float] = []
        self.angles: list[float] = []

    def refresh(self, study: Study) -> None:
        _ = study.linkage
        self.rods.append(study.design.drive.mechanism.rod_mm)  # type: ignore[union-attr]

    def follow(self, theta: float) -> None:
        self.angles.append(theta)


class Reader(Recorder):
    pause_ms = 30


class Prepared(Reader):
    """Its calculation takes until ``gate`` is set, for the rod that it was begun with."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.gates: dict[float, Event] = {}
        self.threads: list[Thread] = []

    def preparation(self) -> Callable[[], object]:
        rod = self.session.design.drive.mechanism.rod_mm
        gate, threads = self.gates.setdefault(rod, Event()), self.threads

        def compute() -> None:
            threads.append(current_thread())
            gate.wait(20.0)

        return compute


class Place:
    """A bare window with two docks behind each other."""

    def __init__(self) -> None:
        self.session, self.player = Session(load(example("transfer_lift"))), Player()
        self.window = QMainWindow()
        self.first, self.second = (self._dock(name) for name in ("first", "second"))
        self.window.tabifyDockWidget(self.first, self.second)
        self.first.raise_()
        self.window.resize(600, 400)
        self.window.show()
        assert QTest.qWaitForWindowExposed(self.window)
        settle()

    def _dock(self, name: str) -> Dock:
        row = ViewRow(name, Recorder, RIGHT)
        dock = Dock(name, row, lambda: Recorder(self.session, self.player), self.window)
        self.window.addDockWidget(RIGHT, dock, Qt.Orientation.Vertical)
        return dock

    def shown(self, dock: Dock) -> Recorder:
        assert isinstance(dock.view, Recorder)
        return dock.view

    def change(self, rod: float) -> None:
        assert self.session.edit(ROD, rod, "change")
        settle()


@pytest.fixture
def place(app: QApplication) -> Iterator[Place]:
    made = Place()
    yield made
    made.window.close()
    made.window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


@pytest.fixture
def reader(app: QApplication) -> Iterator[Reader]:
    made = Reader(Session(load(example("transfer_lift"))), Player())
    made.show()
    assert QTest.qWaitForWindowExposed(made)
    wait_for(lambda: made.up_to_date)
    yield made
    made.close()
    made.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


def test_a_view_is_made_when_it_is_first_seen(place: Place) -> None:
    assert place.first.view is not None
    assert place.second.view is None
    assert place.second.isVisible()  # as Qt sees it
    place.second.raise_()
    wait_for(lambda: place.second.view is not None and bool(place.shown(place.second).rods))
    assert place.shown(place.second).rods == [845.0]


def test_a_change_is_shown_at_once_where_it_is_seen(place: Place) -> None:
    place.session.edit(ROD, 850.0, "change")
    assert place.shown(place.first).rods == [845.0, 850.0]


def test_a_dock_behind_another_does_nothing(place: Place) -> None:
    place.second.raise_()
    wait_for(lambda: place.second.view is not None and not place.shown(place.first).on_screen())
    behind = place.shown(place.first)
    rods, angles = list(behind.rods), list(behind.angles)
    place.change(850.0)
    place.change(851.0)
    place.player.set_theta(1.0)
    settle()
    assert (behind.rods, behind.angles) == (rods, angles)
    place.first.raise_()
    wait_for(lambda: behind.rods[-1] == 851.0)
    assert behind.rods == [*rods, 851.0]
    assert behind.angles[-1] == 1.0


def test_a_hidden_dock_does_nothing(place: Place) -> None:
    view = place.shown(place.first)
    place.first.hide()
    settle()
    place.change(850.0)
    assert view.rods == [845.0]
    place.first.show()
    place.first.raise_()
    wait_for(lambda: view.rods == [845.0, 850.0])


def test_a_fresh_view_only_follows_when_it_comes_back(place: Place) -> None:
    view = place.shown(place.first)
    place.first.hide()
    settle()
    place.player.set_theta(2.0)
    assert view.angles[-1] != 2.0
    place.first.show()
    place.first.raise_()
    wait_for(lambda: view.angles[-1] == 2.0)
    assert view.rods == [845.0]


def test_the_angle_is_followed_frame_by_frame(place: Place) -> None:
    view = place.shown(place.first)
    for theta in (0.1, 0.2, 0.3):
        place.player.set_theta(theta)
    assert view.angles[-3:] == [0.1, 0.2, 0.3]


def test_where_there_is_no_answer_the_view_says_why(place: Place) -> None:
    view = place.shown(place.first)
    # nothing here tells the session which stages are on screen, so nothing refuses it
    assert place.session.edit("follower.roller_arm_mm", 10.0, "change")
    assert view.in_trouble
    told = view.no_picture
    assert told.startswith("Roller arm Zl: the roller cannot reach the base circle"), "not by its key in the file"
    assert "roller_arm_mm" not in told
    place.player.set_theta(1.0)
    assert view.angles[-1] != 1.0
    place.session.stack.undo()
    assert not view.in_trouble
    assert view.angles[-1] == 1.0


def test_a_view_that_is_read_waits_for_a_pause(reader: Reader) -> None:
    for rod in (850.0, 851.0, 852.0):
        reader.session.edit(ROD, rod, "change")
    assert reader.rods == [845.0]
    wait_for(lambda: reader.up_to_date)
    assert reader.rods == [845.0, 852.0]


def test_while_the_mouse_draws_in_one_view_the_others_follow_in_turn(
    app: QApplication, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between two of its moves one of them is read; a view keeps its place in the row, and once no move waits all have followed."""
    monkeypatch.setattr("kindyna_gui.view.FRAME_MS", 0)  # the moves of this hand are slower
    monkeypatch.setattr("kindyna_gui.view.TURN_MS", 0)
    session, player = Session(load(example("transfer_lift"))), Player()
    window = QWidget()
    row = QHBoxLayout(window)
    drawn, *others = views = [Recorder(session, player) for _ in range(4)]
    for view in views:
        row.addWidget(view)
    window.resize(600, 200)
    window.show()
    wait_for(lambda: all(view.up_to_date for view in views))
    settle()
    session.begin_drag(drawn.content)
    for move in range(1, 7):
        session.edit(ROD, 845.0 + move, "draw")
        assert len(drawn.rods) == 1 + move
        assert sum(len(view.rods) - 1 for view in others) == move - 1
        QCoreApplication.processEvents()
    assert [view.rods[1:] for view in others] == [[846.0, 849.0], [847.0, 850.0], [848.0, 851.0]]
    settle()
    assert all(view.rods[-1] == 851.0 for view in views)
    assert [len(view.rods) for view in others] == [4, 4, 3]
    session.edit(ROD, 860.0, "draw")
    session.end_drag()
    settle()
    assert all(view.rods[-1] == 860.0 for view in views)
    window.close()


def test_what_was_calculated_for_an_older_design_is_never_shown(app: QApplication) -> None:
    """A slow view calculates in another thread; where that is late, only the newest design is shown, and once."""
    view = Prepared(Session(load(example("transfer_lift"))), Player())
    view.show()
    wait_for(lambda: bool(view.threads))
    assert view.rods == []
    for rod in (850.0, 851.0):
        view.session.edit(ROD, rod, "change")
        wait_for(lambda rod=rod: rod in view.gates)
    first, second, third = view.gates.values()
    second.set()
    first.set()
    for _ in range(20):
        QTest.qWait(5)
    assert view.rods == []
    third.set()
    wait_for(lambda: view.up_to_date)
    settle()
    assert view.rods == [851.0]
    assert main_thread() not in view.threads
    view.session.edit(ROD, 852.0, "change")
    view.pull()  # who needs it at once does not wait for the other thread
    assert view.rods == [851.0, 852.0]
    view.leave()
    view.close()
    view.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


def test_a_view_that_is_read_waits_until_the_mouse_lets_go(reader: Reader) -> None:
    """Neither the end of its pause nor a paint brings it up to date while the mouse holds something; the release does."""
    mouse = QWidget()
    reader.session.begin_drag(mouse)
    for rod in (850.0, 851.0, 852.0):
        reader.session.edit(ROD, rod, "draw")
        reader.repaint()
        QTest.qWait(4 * reader.pause_ms)
    assert reader.rods == [845.0]
    reader.session.end_drag()
    wait_for(lambda: reader.up_to_date)
    assert reader.rods == [845.0, 852.0]
    mouse.deleteLater()


def test_a_view_is_a_picture(reader: Reader) -> None:
    assert reader.picture(".png").startswith(b"\x89PNG")
    assert b"<svg" in reader.picture(".svg")
