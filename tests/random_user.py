"""A user who does anything to the window, at random and repeatably: menus, keys, fields, tables, drags, wheel, undo and redo,
sizes, docks, dialogs with good and bad files, playing, designs of every kind in between.

    python tests/random_user.py SEED [--seconds 60 | --actions 300] [--warm 3000]

The exit code is 1 where anything was wrong: an exception that nothing caught, a warning of Qt, an event that took 2 s of the
processor, a dialog that cannot be left, a design at the end that does not come back from its file, or memory that grows once the
caches are filled. Then the seed, the last actions and what was wrong are printed.
"""

from __future__ import annotations

import argparse
import faulthandler
import gc
import os
import sys
import tempfile
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

if __name__ == "__main__":
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import pyqtgraph
from PySide6.QtCore import Qt, QTimer, QtMsgType, qInstallMessageHandler
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from random_choices import WEIGHTS
from random_dialogs import Answers, activate
from random_files import write_files
from random_visits import Visits

from core.project import load_drawing, save
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.places import examples
from kindyna_gui.window.main_window import MainWindow, open_window

STALL_S = 2.0
MOST_GROWTH = 60_000_000  # bytes, of a window that is warm
SHOWN = 60  # of the last actions, where something is wrong
HARMLESS = (
    "This plugin does not support propagateSizeHints()",  # of a display without a window manager
    "This plugin does not support raise()",
    "This plugin does not support grabbing the keyboard",
    "This plugin does not support grabbing the mouse",
)


class RandomUser(Visits):
    """One user at one window.

    actions  the last actions, a line each
    wrong    what was wrong, a text each
    """

    def __init__(
        self, window: MainWindow, seed: int, files: list[Path], notes: Callable[[str], None] | None = None
    ) -> None:
        super().__init__(window, files)
        self.seed = seed
        self.actions: deque[str] = deque(maxlen=SHOWN)
        self.wrong: list[str] = []
        self.number = 0
        self._notes = notes
        self.answers = Answers(files, self._in_dialog, lambda: self.on_the_way, self.note, self.wrong)
        self._pulse = QTimer(interval=20)
        self._pulse.timeout.connect(self._beat)
        self._pulse.start()
        self._last = time.thread_time()

    # -- what is wrong ------------------------------------------------------------------------------------

    def note(self, text: str) -> None:
        """Write an action down before it is done."""
        self.actions.append(text)
        if self._notes is not None:
            self._notes(text)

    def blame(self, what: str) -> None:
        """Something is wrong with the action at hand."""
        self.wrong.append(f"{what}\n    at action {self.number}: {self.actions[-1] if self.actions else ''}")

    def listen(self) -> None:
        """From now on nothing is lost that Python or Qt says."""
        sys.excepthook = lambda kind, error, trace: self.blame("".join(traceback.format_exception(kind, error, trace)))
        sys.unraisablehook = lambda told: self.blame(f"{told.err_msg}: {told.exc_value!r} in {told.object!r}")
        threading.excepthook = lambda told: self.blame(f"in a thread: {told.exc_value!r}")

        def hear(kind: QtMsgType, _: Any, text: str) -> None:
            if kind != QtMsgType.QtDebugMsg and not text.startswith(HARMLESS):
                self.blame(f"{''.join(traceback.format_stack(limit=8))}Qt: {text}")

        qInstallMessageHandler(hear)

    def _beat(self) -> None:
        now = time.thread_time()
        if now - self._last > STALL_S:
            self.blame(f"stall: events waited while {now - self._last:.1f} s were computed")
        self._last = now

    # -- the course ---------------------------------------------------------------------------------------

    def act(self) -> None:
        """One action, with all that it leads to; the number of the action and the seed say which."""
        self.number += 1
        self.rng = Random(f"{self.seed}:{self.number}")
        self.answers.rng = Random(f"{self.seed}:{self.number}:answers")
        (name,) = self.rng.choices(list(WEIGHTS), list(WEIGHTS.values()))
        self.note(f"{self.number} {name}")
        self._last = time.thread_time()
        self.attempt(getattr(self, name))

    def attempt(self, deed: Callable[[], object]) -> None:
        """Do it and settle; an exception is blamed on it."""
        try:
            deed()
            self.settle()
        except RuntimeError as error:
            own = traceback.extract_tb(error.__traceback__)[-1].filename.startswith(str(Path(__file__).parent))
            if not own or "already deleted" not in str(error):  # else a widget that the action itself has taken away
                self.blame(traceback.format_exc())
        except Exception:
            self.blame(traceback.format_exc())

    def _in_dialog(self, dialog: QWidget) -> None:
        self.in_dialog(dialog, self.answers.rng)

    def settle(self) -> None:
        """Let the window do what there is to do; what has opened is answered."""
        QTest.qWait(5)
        while self.answers.waited_for:
            QTest.qWait(10)
        active = QApplication.activeWindow()
        if active is None or not active.isVisible():
            activate(self.window)
            QTest.qWait(1)
        self._beat()

    def finish(self, folder: Path) -> None:
        """The design at the end comes back from its file, and the window closes in silence."""
        self.note("the end: save, load, close")
        self.window.player.play(False)
        self.settle()
        path = folder / "at the end.toml"
        save(self.window.session.design, path)
        if load_drawing(path) != self.window.session.design:
            self.blame("the design at the end comes back from its file as another one")
        self.window.session.stack.setClean()
        self.window.close()
        self.settle()


def resident() -> int:
    """Memory of this process [bytes], without Python's rubbish; 0 where the system does not tell."""
    gc.collect()
    status = Path("/proc/self/statm")
    return int(status.read_text("utf-8").split()[1]) * 4096 if status.is_file() else 0


def use(seed: int, seconds: float, actions: int, warm: int, notes: Callable[[str], None]) -> list[str]:
    """Use a window of this process for so long, or for so many actions; what was wrong. warm: of the actions those after which
    memory counts."""
    home = Path(tempfile.mkdtemp(prefix="kindyna-user-"))
    for variable in ("HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME"):
        os.environ[variable] = str(home)
    os.chdir(home)
    designs = [path for _, path in examples()]
    files = write_files(home / "files", designs, Random(seed))
    app = ensure_app()
    app.setAttribute(Qt.ApplicationAttribute.AA_DontUseNativeDialogs)
    pyqtgraph.setConfigOption("mouseRateLimit", -1)
    window = open_window(app)
    user = RandomUser(window, seed, files, notes)
    user.listen()
    window.show()
    window.activateWindow()
    user.settle()
    end = time.monotonic() + seconds - time.process_time()  # starting counts
    while not user.wrong and user.number < actions and time.monotonic() < end:
        user.act()
        if user.number == warm:
            before = resident()
    if user.number > warm and (grown := resident() - before) > MOST_GROWTH:
        user.blame(f"memory: {grown / 1e6:.0f} MB more after {user.number} actions than after {warm}")
    if not user.wrong:
        user.attempt(lambda: user.finish(home))
    if user.wrong:
        lines = (
            f"seed {seed}: wrong at action {user.number}. The last actions:",
            *user.actions,
            *user.wrong,
            f"Again: python tests/random_user.py {seed} --actions {user.number}",
        )
        print("\n".join(lines), flush=True)
    else:
        print(f"seed {seed}: {user.number} actions, nothing wrong", flush=True)
    return user.wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seed", type=int)
    parser.add_argument("--seconds", type=float, default=1e9)
    parser.add_argument("--actions", type=int, default=10**9)
    parser.add_argument("--warm", type=int, default=10**9, help="so many actions until the memory may grow no more")
    parser.add_argument("--notes", type=Path, help="a file that takes each action before it is done")
    asked = parser.parse_args()
    faulthandler.enable()
    if asked.notes is None:
        return bool(use(asked.seed, asked.seconds, asked.actions, asked.warm, lambda _: None))
    with asked.notes.open("w", encoding="utf-8", buffering=1) as file:
        return bool(use(asked.seed, asked.seconds, asked.actions, asked.warm, lambda text: print(text, file=file)))


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # what is wrong has been said; no module is to be taken apart under Qt
