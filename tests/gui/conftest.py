"""What every test of the window gets: one application, settings of its own, and no word from Qt left unheard."""

import gc
import sys
import threading
import traceback
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType

import pytest
from PySide6.QtCore import (
    QByteArray,
    QCoreApplication,
    QEvent,
    QMessageLogContext,
    QSettings,
    QtMsgType,
    qInstallMessageHandler,
)
from PySide6.QtGui import QCursor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from window_user import Alone, Open, Shown, User, settle, wait_for

from core.project import load
from kindyna_gui import dialogs
from kindyna_gui.background import PATIENCE, Worker
from kindyna_gui.dialogs import SaveAnswer
from kindyna_gui.look import apply_style
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.places import default_design, example
from kindyna_gui.window.layouts import first_task
from kindyna_gui.window.main_window import MainWindow, open_window
from kindyna_gui.window.tasks import TASKS

Kept = dict[MainWindow, dict[str, QByteArray]]
AWAY = 5000, 5000
"""Where the mouse rests at first: what comes to stand under it would speak in the status line."""
HARMLESS = (
    "This plugin does not support propagateSizeHints()",
    "This plugin does not support raise()",
    "This plugin does not support grabbing the keyboard",
)


@pytest.fixture(scope="session")
def app() -> Iterator[QApplication]:
    made = ensure_app()
    apply_style(made)
    yield made
    made.clipboard().clear()  # what Python put there, the offscreen platform takes away after Python has ended, and crashes


@pytest.fixture(autouse=True)
def settings_apart(own_settings: Path) -> None:
    """QSettings asks for the home directory once and then never again."""
    for format in (QSettings.Format.NativeFormat, QSettings.Format.IniFormat):
        QSettings.setPath(format, QSettings.Scope.UserScope, str(own_settings / ".config"))


@pytest.fixture(autouse=True)
def nothing_unheard() -> Iterator[None]:
    """A warning of Qt, or an exception inside a slot, fails the test."""
    heard: list[str] = []

    def listen(kind: QtMsgType, context: QMessageLogContext, text: str) -> None:
        if kind != QtMsgType.QtDebugMsg and not text.startswith(HARMLESS):
            heard.append(text)

    def caught(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        heard.append(repr(error))
        usual(kind, error, trace)

    usual, sys.excepthook = sys.excepthook, caught
    before = qInstallMessageHandler(listen)
    yield
    qInstallMessageHandler(before)
    sys.excepthook = usual
    assert heard == []


def close(users: Iterable[User]) -> None:
    """Close windows, and let them go with all that they have."""
    for user in users:
        user.session.drop_incomplete()
        user.session.stack.setClean()
        user.window.close()
        user.window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    settle()


@pytest.fixture
def open_user(app: QApplication, monkeypatch: pytest.MonkeyPatch, kept_windows: Kept) -> Iterator[Open]:
    """Opens windows, shown and active; at the end each is closed and gone."""
    users: list[User] = []
    before = set(QApplication.topLevelWidgets())

    def open(path: Path | None = None, size: tuple[int, int] | None = (1280, 800), whole: bool = False) -> User:
        """With the drawing alone, other views coming when they are asked for (``User.see``): the quicker way.

        whole   in the layout that a user finds at first
        size    None: in the layout and the size that the settings ask for
        """
        QCursor.setPos(*AWAY)
        window = open_window(app, path)
        users.append(User(window, monkeypatch))
        if size is not None:
            window.resize(*size)
        if not whole and size is not None:
            for dock in window.docks.values():
                dock.hide()
        window.show()
        window.activateWindow()
        assert QTest.qWaitForWindowActive(window)
        wait_for(lambda: not window.session.laws.busy)
        return users[-1]

    yield open
    monkeypatch.setattr(
        dialogs, "ask_to_save", lambda *_: SaveAnswer.DISCARD
    )  # of a file that the test has changed or removed
    close(users)
    users.clear()
    nothing_left(before, PATIENCE if kept_windows else 0.0)


def nothing_left(before: set[QWidget], patience: float = 0.0) -> None:
    """Closed windows are gone, with all that they had and did.

    patience   seconds that a window of the module, which is still open, may count its findings
    """
    # menus stay until Python's next great tidying
    now = (w for w in QApplication.topLevelWidgets() if not isinstance(w, QMenu))
    left = [type(w).__name__ for w in now if w not in before]
    assert left == [], "windows were left behind"
    assert still_computing(patience) == "", "a closed window goes on computing"


def still_computing(patience: float) -> str:
    """Return where the threads are that compute in the background."""
    for each in threading.enumerate():
        if isinstance(each, Worker) and patience:
            each.join(patience)
    frames = sys._current_frames()
    working = [each.ident for each in threading.enumerate() if isinstance(each, Worker)]
    return "\n".join("".join(traceback.format_stack(frames[each])) for each in working if each in frames)


@pytest.fixture(scope="module")
def kept_windows(app: QApplication) -> Iterator[Kept]:
    """The window that the tests of a module share, once there is one, with the first layouts of its tasks."""
    kept: Kept = {}
    before = set(QApplication.topLevelWidgets())
    yield kept
    with pytest.MonkeyPatch.context() as patch:
        close([User(window, patch) for window in kept])
    kept.clear()
    nothing_left(before)


@pytest.fixture
def same_window(kept_windows: Kept, app: QApplication, monkeypatch: pytest.MonkeyPatch) -> Iterator[Open]:
    """As ``open_user``, for tests that have no eyes for how a window is opened or closed: their module shares one, in which
    each begins with a design that is read anew, and with the drawing alone."""

    def open(path: Path | None = None, size: tuple[int, int] = (1280, 800), whole: bool = False) -> User:
        if not kept_windows:
            kept_windows[open_window(app)] = {}
        ((window, layouts),) = kept_windows.items()
        window.show()
        user = User(window, monkeypatch)
        begin_anew(user, path, layouts, size, whole)
        return user

    yield open
    for window in kept_windows:
        end(User(window, monkeypatch))


def begin_anew(
    user: User, path: Path | None, layouts: dict[str, QByteArray], size: tuple[int, int], whole: bool
) -> None:
    """A design, at cam angle 0, and the first layout of its task, without docks if not ``whole``."""
    window, session = user.window, user.session
    QCursor.setPos(*AWAY)
    if path is None:
        session.start(load(default_design()))
    else:
        session.open(path)
    user.window.player.set_theta(0.0)
    task = first_task(session.design)
    window.show_task(task)
    window.resize(*size)
    kept = f"{task} whole" if whole else task
    if kept in layouts:
        window.restoreState(layouts[kept])
        window.centre.set_pages(TASKS[task].pages, TASKS[task].pages[-1])
    else:
        window.reset_layout()
        for dock in window.docks.values():
            dock.setVisible(whole and not dock.isHidden())
        layouts[kept] = window.saveState()
    focus = window.focusWidget()
    if focus is None or not focus.isVisible():  # it was in a dock that is hidden now
        user.drawing().setFocus()
    window.activateWindow()
    assert QTest.qWaitForWindowActive(window)
    wait_for(lambda: not session.laws.busy)


def end(user: User) -> None:
    """Let go of everything that a test has begun."""
    window, session = user.window, user.session
    assert QApplication.activeModalWidget() is None, "a dialog was left behind"
    assert QApplication.activePopupWidget() is None, "a menu was left behind"
    window.player.play(False)
    window.player.set_forward(True)
    session.end_drag()
    session.stages_on_screen = window.stages_on_screen
    for dock in window.docks.values():
        dock.hide()
    session.choose_segment(0)
    session.choose_step(None)
    settle()


@pytest.fixture
def user(same_window: Open) -> User:
    """A user at a window that shows the lift example, its drawing alone."""
    return same_window()


@pytest.fixture
def whole(same_window: Open) -> User:
    """A user at a window that shows the lift example in the layout that it has at first."""
    return same_window(whole=True)


@pytest.fixture
def six_bar(same_window: Open) -> User:
    """A user at the lecture's six-bar, its crank at 45 degrees."""
    user: User = same_window(example("lecture_six_bar"))
    user.turn(45.0)
    return user


@pytest.fixture
def alone(app: QApplication) -> Iterator[Alone]:
    """Shows views in windows of their own; at the end each is closed and gone."""
    shown: list[QWidget] = []

    def show(view: Shown, width: int, height: int) -> Shown:
        shown.append(view)
        view.resize(width, height)
        view.show()
        assert QTest.qWaitForWindowExposed(view)
        settle()
        return view

    yield show
    for view in shown:
        view.close()
        view.deleteLater()


@pytest.fixture(scope="session", autouse=True)
def tidy() -> Iterator[None]:
    """Python's rubbish goes before Qt does."""
    yield
    gc.collect()
