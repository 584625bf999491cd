"""Real processes with a real window, killed at random moments while somebody works: nothing is lost."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from sampled import stressed

from core.project import load
from core.project.recovery import find
from kindyna_gui.places import example

if sys.platform == "win32":
    pytest.skip("POSIX only: signals", allow_module_level=True)

PROGRAM = Path(__file__).parents[2] / "working_window.py"
AT_ONCE = (signal.SIGTERM, signal.SIGHUP)
SIGNALS = (signal.SIGKILL, *AT_ONCE, signal.SIGSEGV)
KILLS = 3  # one of each way but a crash, which leaves what SIGKILL does; make fuzz has all
MOST_KILLS = 200
KILLS_OF_FUZZ = MOST_KILLS / 600  # a second
SIDE_BY_SIDE = 4
ON_DISK_AFTER = 2.0  # seconds
WORKING = (0.1, 3.5)  # seconds from the first change to the kill
PATIENCE = 60.0


@dataclass
class Worker:
    """A process that works in a folder of its own, which is also its home."""

    home: Path
    process: "subprocess.Popen[bytes]"
    by: signal.Signals
    seconds: float
    until: float = float("inf")

    @classmethod
    def start(cls, home: Path, seed: int, dice: random.Random) -> "Worker":
        home.mkdir()
        path = home / "mine.toml"
        path.write_bytes(example("transfer_lift").read_bytes())
        with open(home / "stdout", "wb") as said, open(home / "stderr", "wb") as wrong:
            process = subprocess.Popen(
                [sys.executable, str(PROGRAM), str(seed), *[str(path)][: seed % 2]],
                env=environment(home),
                cwd=home,
                stdout=said,
                stderr=wrong,
            )
        return cls(home, process, SIGNALS[seed % len(SIGNALS)], dice.uniform(*WORKING))

    def is_due(self) -> bool:
        """Whether it has worked long enough."""
        if self.until == float("inf") and (self.home / "stdout").stat().st_size:
            self.until = time.monotonic() + self.seconds
        return time.monotonic() >= self.until or self.process.poll() is not None

    def kill(self) -> float:
        """Kill it; when."""
        at = time.monotonic()
        assert self.process.poll() is None, (self.home / "stderr").read_text("utf-8")
        self.process.send_signal(self.by)
        assert self.process.wait(PATIENCE) == -self.by
        return at


def environment(home: Path) -> dict[str, str]:
    folders = {"HOME": home, "XDG_CONFIG_HOME": home / "config", "XDG_STATE_HOME": home / "state"}
    paths = (Path(example("").parents[2]), os.environ.get("PYTHONPATH", ""))
    own = {name: str(path) for name, path in folders.items()}
    return os.environ | own | {"PYTHONPATH": os.pathsep.join(map(str, paths))}


def lost(home: Path, killed_at: float, by: signal.Signals) -> str:
    """What of a killed process is lost; empty where nothing is.

    What it had announced 2 s before, or before a signal that it can answer, must be in its recovery file, or in the design's
    own; or what came after that. Of the change that the kill cut off either side may be there.
    """
    lines = [line for line in (home / "stdout").read_bytes().split(b"\n")[:-1] if line.startswith(b"{")]
    said = [json.loads(line) for line in lines]
    states = [each for each in said if "time" in each]
    if not states:
        return ""
    certain = killed_at - (0.0 if by in AT_ONCE else ON_DISK_AFTER)
    first = max((i for i, each in enumerate(states) if each["time"] <= certain), default=0)
    cut_off = "begin" in said[-1]
    found = find(home / "state" / "kindyna" / "recovery")
    for each in found:
        each.release()
    if len(found) > 1:
        return f"{len(found)} recovery files of one window"
    if not found:
        # the change that was cut off may have saved, or gone back to what is saved
        saved = any(map(is_saved, states if cut_off else states[first:])) or (
            cut_off and is_in_a_file(home, states[-1])
        )
        return "" if saved else f"nothing recovered of {len(states)} states"
    unsaved = found[0].unsaved
    path = None if unsaved.path is None else str(unsaved.path)
    there = {"design": unsaved.design, "path": path, "draft": unsaved.draft}
    if unsaved.draft is not None:
        there["drive"] = unsaved.drive
    same = [i for i, each in enumerate(states) if {key: each[key] for key in there} == there]
    if cut_off and unsaved.time >= states[-1]["clock"]:
        load(found[0].file)
        return ""
    if same and same[-1] >= first:
        return ""
    return f"recovered state {same or 'unknown'} of {len(states)}, {first} was certain"


def is_saved(state: dict[str, Any]) -> bool:
    """Whether a state asks for no saving: as its file has it, or as it was begun."""
    if state["modified"]:
        return False
    return state["path"] is None or Path(state["path"]).read_text("utf-8") == state["design"]


def is_in_a_file(home: Path, state: dict[str, Any]) -> bool:
    return state["draft"] is None and any(path.read_text("utf-8") == state["design"] for path in home.glob("*.toml"))


def kill_many(folder: Path, number: int, seed: int) -> list[str]:
    """What is lost of so many processes."""
    dice = random.Random(seed)
    waiting = [(folder / str(i), seed + i) for i in range(number)]
    running: list[Worker] = []
    failures = []
    try:
        while waiting or running:
            while waiting and len(running) < SIDE_BY_SIDE:
                running.append(Worker.start(*waiting.pop(0), dice))
            time.sleep(0.01)
            for worker in [each for each in running if each.is_due()]:
                loss = lost(worker.home, worker.kill(), worker.by)
                running.remove(worker)
                if loss:
                    failures.append(f"{worker.home.name}, {worker.by.name}: {loss}")
    finally:
        for worker in running:
            worker.process.kill()
            worker.process.wait()
    return failures


@pytest.mark.parametrize("kills", [1, stressed(KILLS)])
def test_nothing_is_lost_by_a_kill(tmp_path: Path, kills: int) -> None:
    """SIGKILL first."""
    assert kill_many(tmp_path, kills, 20) == []


@pytest.mark.fuzz
def test_nothing_is_lost_by_many_kills(tmp_path: Path) -> None:
    seconds = float(os.environ.get("KINDYNA_FUZZ_SECONDS", "600"))
    seed = random.SystemRandom().randrange(10**6)
    failures = kill_many(tmp_path, min(max(round(KILLS_OF_FUZZ * seconds), 1), MOST_KILLS), seed)
    assert failures == [], f"seed {seed}"


RECOVERING = """
import json, sys
from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton
from kindyna_gui.window import main_window
from kindyna_gui.__main__ import main

open_window = main_window.open_window

def watched(*arguments):
    window = open_window(*arguments)
    def look():
        box = QApplication.activeModalWidget()
        if box is None:
            return
        timer.stop()
        button = next(b for b in box.findChildren(QPushButton) if b.text().replace("&", "") == "Recover")
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)
        QTimer.singleShot(0, end)
    def end():
        print(json.dumps(window.session.state()), flush=True)
        window.session.stack.setClean()
        window.session.drop_incomplete()
        window.session.stack.setClean()
        window.close()
    timer = QTimer(window, interval=10)
    timer.timeout.connect(look)
    timer.start()
    return window

main_window.open_window = watched
sys.exit(main([]))
"""


@pytest.mark.stress
def test_the_next_start_offers_it(tmp_path: Path) -> None:
    worker = Worker.start(tmp_path / "home", 1, random.Random(1))
    assert worker.by is signal.SIGTERM
    states: list[dict[str, Any]] = []
    while not states or not states[-1]["modified"]:
        time.sleep(0.02)
        lines = (worker.home / "stdout").read_bytes().split(b"\n")[:-1]
        states = [json.loads(line) for line in lines if b'"time"' in line]
        assert worker.process.poll() is None
    worker.kill()
    folder = worker.home / "state" / "kindyna" / "recovery"
    (found,) = find(folder)
    found.release()
    done = subprocess.run(
        [sys.executable, "-c", RECOVERING],
        env=environment(worker.home),
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
        encoding="utf-8",
    )
    assert done.returncode == 0, done.stderr
    shown = json.loads(done.stdout.splitlines()[-1])
    assert (shown["design"], shown["draft"]) == (found.unsaved.design, found.unsaved.draft)
    assert shown["path"] == (None if found.unsaved.path is None else str(found.unsaved.path))
    assert shown["modified"] is True
    assert list(folder.iterdir()) == [], "closed in order"
