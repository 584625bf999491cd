"""One real window on an X server without a screen: it opens, draws, obeys keys and mouse, and closes in silence."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

XVFB = shutil.which("Xvfb")
PATIENCE = 60

PROGRAM = """
import sys
from pathlib import Path
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from kindyna_gui.window import main_window
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.motion.segments_view import SegmentsView

open_window = main_window.open_window

def wait_for(condition):
    for _ in range(500):
        if condition():
            return True
        QTest.qWait(10)
    return False

def watched(app, path=None):
    window = open_window(app, path)
    QTimer.singleShot(0, lambda: use(app, window))
    return window

def use(app, window):
    try:
        window.activateWindow()
        assert app.platformName() == "xcb", app.platformName()
        assert QTest.qWaitForWindowExposed(window)
        assert wait_for(lambda: window.welcome is not None and window.welcome.isVisible()), "no welcome"
        QTest.keyClick(window.welcome, Qt.Key.Key_Escape)
        assert wait_for(lambda: not window.welcome.isVisible()), "the welcome page stays"
        window.activateWindow()
        wait_for(window.isActiveWindow)
        assert wait_for(lambda: isinstance(window.view("motion"), SegmentsView) and window.view("motion").up_to_date)
        assert window.width() > 1900 and window.height() > 1000, window.size()
        QTest.keyClick(window, Qt.Key.Key_3, Qt.KeyboardModifier.ControlModifier)
        window.show_view("displacement")
        assert wait_for(lambda: isinstance(window.view("displacement"), PlotView)
                              and bool(window.view("displacement").plot.readings())), "no displacement"
        window.show_view("torque")
        assert wait_for(lambda: window.view("torque") is not None and window.view("torque").up_to_date)
        QTest.keyClick(window, Qt.Key.Key_Space)
        assert window.player.playing
        assert wait_for(lambda: window.player.theta > 0.2), "nothing turns"
        QTest.keyClick(window, Qt.Key.Key_Space)
        plot = window.view("displacement").plot
        QTest.mouseClick(plot.viewport(), Qt.MouseButton.LeftButton, pos=plot.pixel_at(180.0).toPoint())
        assert abs(window.player.theta - 3.14159) < 0.03, window.player.theta
        assert window.session.edit("motion.stroke", 160.0, "Change stroke")
        QTest.qWait(50)
        window.grab().save(sys.argv[1])
        window.session.stack.undo()
        print("done", flush=True)
    except BaseException as error:
        print(repr(error), flush=True)
        window.session.stack.setClean()
    window.close()

main_window.open_window = watched
from kindyna_gui.__main__ import main
sys.exit(main([]))
"""


@pytest.fixture
def display() -> Iterator[str]:
    """An X server of our own."""
    if XVFB is None:
        pytest.skip("Xvfb is not installed")
    read, write = os.pipe()
    server = subprocess.Popen(
        [XVFB, "-displayfd", str(write), "-screen", "0", "1920x1080x24", "-nolisten", "tcp", "-noreset"],
        pass_fds=(write,),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    with os.fdopen(read, encoding="utf-8") as told:
        number = told.readline().strip()
    try:
        if not number:
            pytest.skip("Xvfb does not start")
        yield f":{number}"
    finally:
        server.terminate()
        server.wait(PATIENCE)


MANY_DESIGNS = """
from PySide6.QtTest import QTest
from kindyna_gui.window import main_window
from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.places import examples

app = ensure_app()
window = main_window.open_window(app)
window.show()
assert app.platformName() == "xcb", app.platformName()
assert QTest.qWaitForWindowExposed(window)
for number in range(208):
    window.documents.open_example(examples()[number % len(examples())][1])
    QTest.qWait(60)
window.close()
print("done", flush=True)
"""


def run(program: str, display: str, home: Path, patience: int) -> subprocess.CompletedProcess[str]:
    """Run a program on a display; skips the test where the libraries of X are missing."""
    environment = {name: value for name, value in os.environ.items() if name != "QT_QPA_PLATFORM"}
    environment |= {"DISPLAY": display, "KINDYNA_TEST_XVFB": "1", "XDG_RUNTIME_DIR": str(home)}
    environment.pop("WAYLAND_DISPLAY", None)
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", program, str(home / "window.png")],
        env=environment,
        capture_output=True,
        text=True,
        timeout=patience,
        encoding="utf-8",
    )
    if "could not load the Qt platform plugin" in done.stderr.lower() or "no window" in done.stdout:
        pytest.skip("the libraries of X are missing")
    return done


@pytest.mark.soak
def test_a_real_window_survives_any_number_of_designs(display: str, tmp_path: Path) -> None:
    done = run(MANY_DESIGNS, display, tmp_path, 600)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "done\n", done.stdout + done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.stress
def test_a_real_window(display: str, tmp_path: Path) -> None:
    done = run(PROGRAM, display, tmp_path, PATIENCE)
    assert done.stdout == "done\n", done.stdout + done.stderr
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert (tmp_path / "window.png").stat().st_size > 20_000
