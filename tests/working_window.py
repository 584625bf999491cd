"""A user who works at a real window until the process dies: ``python working_window.py SEED [DESIGN]``.

Each line on stdout is a JSON object: what would be lost if the process ended, after each change, with the time by the clock
that all processes of the machine share, and by that of files. The line before it, ``{"begin": n}``, says that the n-th change
comes.
"""

import json
import random
import signal
import sys
import time
from pathlib import Path
from typing import Any

from PySide6.QtCore import QTimer
from PySide6.QtTest import QTest

from core.design import entries, motion_of
from core.project import load
from kindyna_gui import dialogs
from kindyna_gui.__main__ import main
from kindyna_gui.documents.session import Session
from kindyna_gui.places import example
from kindyna_gui.window import main_window
from kindyna_gui.window.main_window import MainWindow

DESIGNS = ("transfer_lift", "card_picker", "four_bar_coupler_cam", "lecture_six_bar", "transfer_unit")


def say(line: dict[str, Any]) -> None:
    print(json.dumps(line), flush=True)


def edit_a_number(window: MainWindow, dice: random.Random) -> None:
    design = window.session.typed
    rows = [each for name in design.tables if name not in ("motion", "linkage") for each in entries(design, name)]
    numbers = [each for each in rows if isinstance(each.value, float) and each.value]
    row = dice.choice(numbers)
    by = dice.choice((dice.uniform(0.98, 1.02), dice.uniform(0.2, 5.0)))  # the lengths need not fit together then
    window.session.edit(row.path, row.value * by, f"Change {row.path}")
    window.session.end_gesture()


def drag(window: MainWindow, dice: random.Random) -> None:
    """One number, many times in a row."""
    name = window.session.design.name
    for number in range(dice.randint(5, 15)):
        window.session.edit("name", f"{name[:20]} {number}", "Change name")
        say(state(window.session))
        say({"begin": number})
        QTest.qWait(20)
    window.session.end_gesture()


def draw(window: MainWindow, dice: random.Random) -> None:
    """A number by the mouse: held, views follow in their turn."""
    window.session.begin_drag(window)
    drag(window, dice)
    window.session.end_drag()


def choose_drive(window: MainWindow, dice: random.Random) -> None:
    window.session.choose_drive(dice.randrange(len(window.session.full_design.drives)))


def leave_the_motion_unfinished(window: MainWindow, dice: random.Random) -> None:
    motion = motion_of(window.session.typed)
    if motion is not None:
        path = f"motion.segments[{dice.randrange(len(motion.segments))}].span_deg"
        window.session.edit(path, dice.uniform(5.0, 300.0), "Change span")
        window.session.end_gesture()


def segment(window: MainWindow, dice: random.Random) -> None:
    if motion_of(window.session.design) is not None:
        window.designing.segment(dice.choice(("insert", "split", "duplicate")))


def undo(window: MainWindow, dice: random.Random) -> None:
    window.session.stack.undo()


def redo(window: MainWindow, dice: random.Random) -> None:
    window.session.stack.redo()


def save(window: MainWindow, dice: random.Random) -> None:
    if window.session.incomplete is None:
        window.documents.save()


def begin(window: MainWindow, dice: random.Random) -> None:
    window.documents.begin(load(example(dice.choice(DESIGNS))), "another")


ACTIONS = (
    *(edit_a_number,) * 8, drag, draw, *(leave_the_motion_unfinished,) * 3,
    segment, undo, undo, redo, save, begin, choose_drive, choose_drive,
)  # fmt: skip


def state(session: Session) -> dict[str, Any]:
    return session.state() | {"time": time.monotonic(), "clock": time.time()}


def work(window: MainWindow, seed: int) -> None:
    dice = random.Random(seed)
    say(state(window.session))
    number = 0
    while True:
        number += 1
        say({"begin": number})
        dice.choice(ACTIONS)(window, dice)
        say(state(window.session))
        QTest.qWait(dice.choice((20, 50, 100, 200, 400)))


def run(seed: int, path: str = "") -> int:
    """As the program is started, with somebody at its window."""
    if hasattr(signal, "SIGHUP"):
        signal.signal(signal.SIGHUP, signal.SIG_DFL)  # ignored where the tests were started by nohup
    open_window = main_window.open_window
    saved_as = Path(f"saved_{seed}.toml").absolute()
    dialogs.design_to_save = lambda *_: saved_as
    dialogs.show_faults = lambda *_: None

    def watched(*arguments: Any) -> MainWindow:
        window = open_window(*arguments)
        window.furnished.connect(lambda: QTimer.singleShot(0, window, lambda: work(window, seed)))
        return window

    main_window.open_window = watched
    return main([path] if path else [])


if __name__ == "__main__":
    sys.exit(run(int(sys.argv[1]), *sys.argv[2:]))
