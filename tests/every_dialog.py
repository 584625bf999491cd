"""Every dialog that a menu of the window opens, each met once: for tests that look at all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from drawn_cams import NosedCam, drawn
from PySide6.QtCore import QTimer
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QApplication, QDialog, QMenu, QMessageBox, QWidget
from window_user import User, plain, settle

from core.__main__ import main
from kindyna_gui import dialogs
from kindyna_gui.background import Background
from kindyna_gui.places import example

NO_DIALOG = {"Find anything...", "New graph...", "Save this layout..."}
OTHERS = ("Welcome", "Figures of the papers...")
PATIENCE = 30


def entries(user: User) -> Iterator[QAction]:
    """Those that open something, submenus included."""

    def below(menu: QMenu) -> Iterator[QAction]:
        menu.aboutToShow.emit()
        for action in menu.actions():
            inner = action.menu()
            if isinstance(inner, QMenu):
                yield from below(inner)
            elif action.isVisible() and (action.text().endswith("...") or plain(action.text()) in OTHERS):
                yield action

    for top in user.window.menuBar().actions():
        menu = top.menu()
        if isinstance(menu, QMenu):
            yield from below(menu)


def samples(folder: Path) -> dict[str, Path]:
    """A file for each dialog that asks for one first, by words of that question's title."""
    rows = "\n".join(f"{angle},{10.0 - 10.0 * np.cos(np.deg2rad(angle)):.6f}" for angle in range(360))
    found = {
        "DXF": ("curve.dxf", drawn(*NosedCam().shapes, unit=0)),
        "easured motion": ("table.csv", f"angle,displacement mm\n{rows}\n".encode()),
        "egment": ("segment.csv", f"angle,displacement mm\n{rows}\n".encode()),
        "easured cam": ("cam.csv", b"angle,lift\n" + b"".join(b"%d,%.3f\n" % (i, 20.0) for i in range(0, 360, 5))),
    }
    for name, data in found.values():
        (folder / name).write_bytes(data)
    files = {words: folder / name for words, (name, _) in found.items()}
    files["controller"] = folder / "table.txt"
    asked = ["ecam", str(example("transfer_lift")), "--controller", "sew-tab", "--out", str(files["controller"])]
    assert main(asked) == 0
    return files


def each_dialog(
    user: User, patch: pytest.MonkeyPatch, folder: Path, look: Callable[[str, QWidget], None]
) -> dict[str, str]:
    """Open one dialog after the other and let ``look`` see it, before it is left. Entry of the menu -> class of what it opened."""
    files = samples(folder)

    def opened_file(_: QWidget, title: str, *__: object) -> tuple[Path, bytes] | None:
        path = next((path for words, path in files.items() if words in title), None)
        return None if path is None else (path, path.read_bytes())

    for name in dir(dialogs):
        if name.endswith(("_to_save", "_to_open")):
            patch.setattr(dialogs, name, lambda *_, **__: None)
    patch.setattr(dialogs, "opened_file", opened_file)
    seen: dict[str, str] = {}
    names = [plain(action.text()) for action in entries(user) if action.isEnabled()]
    for name in dict.fromkeys(names):
        if name not in NO_DIALOG:
            met = _meet(user, name, look)
            if met:
                seen[name] = met
    return seen


def _meet(user: User, name: str, look: Callable[[str, QWidget], None]) -> str:
    """Choose an entry; what opens is seen and left."""
    raised: list[BaseException] = []
    before = set(QApplication.topLevelWidgets())
    met: list[str] = []

    def at_work() -> None:
        front = QApplication.activeModalWidget()
        if front is None:
            opened = [
                each
                for each in QApplication.topLevelWidgets()
                if each not in before and each.isVisible() and each.isWindow() and not isinstance(each, QMenu)
            ]
            front = next((each for each in opened if each is not user.window), None)
        if front is not None and front.isModal() and any(each.busy for each in front.findChildren(Background)):
            timer.start(5)  # what it computes may enable more of it
        elif front is not None and front.isVisible():
            met.append(type(front).__name__)
            try:
                look(name, front)
            except BaseException as error:
                raised.append(error)
            leave(front)
        elif not done:
            timer.start()

    timer = QTimer(user.window, singleShot=True, interval=0)
    timer.timeout.connect(at_work)
    done = False
    timer.start()
    action = next(each for each in entries(user) if plain(each.text()) == name)
    action.trigger()
    for _ in range(PATIENCE):
        if met:
            break
        settle()
        if not timer.isActive():
            break
    done = True
    timer.stop()
    timer.deleteLater()
    settle()
    if raised:
        raise raised[0]
    user.window.activateWindow()
    settle()
    return met[0] if met else ""


def leave(front: QWidget) -> None:
    """As Esc would."""
    if isinstance(front, QMessageBox | QDialog):
        front.reject()
    else:
        front.close()


__all__ = ["each_dialog"]
