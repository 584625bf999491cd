"""A user who answers every dialog, menu and list that opens, with good values and bad ones, and leaves each in the end."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from random import Random

from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QApplication,
    QDialog,
    QFileDialog,
    QLineEdit,
    QMenu,
    QMessageBox,
    QProgressDialog,
    QPushButton,
    QWidget,
)
from shiboken6 import isValid

EVERY_MS = 10
STEPS = 14  # in one dialog before it is left
PATIENCE = 60  # steps after which a dialog that will not go counts as a fault


class Answers:
    """Acts on what stands in front of the window, every 10 ms, also while a dialog waits within an action.

    act     one random action on the widgets of a dialog
    held    whether the user is on the way through menus
    notes   takes a line for each action
    faults  takes a line where a dialog cannot be left
    """

    def __init__(
        self,
        files: list[Path],
        act: Callable[[QWidget], None],
        held: Callable[[], bool],
        notes: Callable[[str], None],
        faults: list[str],
    ) -> None:
        self.rng = Random(0)
        self._files, self._act, self._held, self._note, self._faults = files, act, held, notes, faults
        self._steps: dict[int, int] = {}
        self._timer = QTimer(singleShot=True, interval=EVERY_MS)
        self._timer.timeout.connect(self._look)
        self._timer.start()

    @property
    def waited_for(self) -> bool:
        """Something stands in front of the window."""
        return QApplication.activePopupWidget() is not None or QApplication.activeModalWidget() is not None

    def _look(self) -> None:
        self._timer.start()  # first: what follows may open a dialog and wait for it
        popup, modal = QApplication.activePopupWidget(), QApplication.activeModalWidget()
        if self._held():
            return
        if popup is not None:
            self._in_popup(popup)
        elif modal is not None and modal.isVisible():
            activate(modal)
            self._in_dialog(modal)

    # -- menus and lists ----------------------------------------------------------------------------------

    def _in_popup(self, popup: QWidget) -> None:
        if isinstance(popup, QMenu):
            self.in_menu(popup)
            return
        keys = (Qt.Key.Key_Down, Qt.Key.Key_Up, Qt.Key.Key_End, Qt.Key.Key_Return, Qt.Key.Key_Escape)
        key = self.rng.choice(keys)
        self._note(f"  list: {key.name}")
        QTest.keyClick(QApplication.focusWidget() or popup, key)

    def in_menu(self, menu: QMenu) -> None:
        """Choose an entry of an open menu, or leave it."""
        entries = [a for a in menu.actions() if a.isEnabled() and a.isVisible() and not a.isSeparator()]
        entry = self.rng.choice(entries) if entries and self.rng.random() < 0.85 else None
        if entry is None or entry.text().replace("&", "") == "Quit":
            self._note("  menu: Escape")
            QTest.keyClick(menu, Qt.Key.Key_Escape)
            return
        self._note(f"  menu: {entry.text()!r}")
        if entry.menu() is not None and entry.menu().isVisible():
            entry.menu().close()
        QTest.mouseClick(menu, Qt.MouseButton.LeftButton, pos=menu.actionGeometry(entry).center())

    # -- dialogs ------------------------------------------------------------------------------------------

    def _in_dialog(self, dialog: QWidget) -> None:
        key = id(dialog)
        steps = self._steps[key] = self._steps.get(key, 0) + 1
        if steps == 1:
            self._note(f"  dialog: {type(dialog).__name__} {dialog.windowTitle()!r} {said(dialog)!r}")
        if isinstance(dialog, QProgressDialog):  # it goes by itself
            if self.rng.random() < 0.03:
                self._note("  progress: cancelled")
                dialog.cancel()
        elif steps > PATIENCE:
            self._faults.append(f"cannot leave {type(dialog).__name__} {dialog.windowTitle()!r}")
            del self._steps[key]
            dialog.close()
        elif isinstance(dialog, QFileDialog):
            self._in_file_dialog(dialog, steps)
        elif isinstance(dialog, QMessageBox):
            self._press(dialog)
        elif steps <= STEPS and self.rng.random() < 0.9:
            self._act(dialog)
        elif self.rng.random() < 0.6 and steps <= 2 * STEPS:
            self._press(dialog)
        else:
            self._escape(dialog)
        if not isValid(dialog) or not dialog.isVisible():
            self._steps.pop(key, None)

    def _press(self, dialog: QWidget) -> None:
        buttons = [b for b in dialog.findChildren(QPushButton) if b.isVisible() and b.isEnabled()]
        if buttons:
            button = self.rng.choice(buttons)
            self._note(f"  button: {button.text()!r}")
            QTest.mouseClick(button, Qt.MouseButton.LeftButton, pos=QPoint(button.width() // 2, button.height() // 2))
        else:
            self._escape(dialog)

    def _escape(self, dialog: QWidget) -> None:
        self._note("  Escape")
        QTest.keyClick(dialog, Qt.Key.Key_Escape)
        if (
            isValid(dialog) and dialog.isVisible() and isinstance(dialog, QDialog)
        ):  # a key may have other uses in an editor
            dialog.reject()

    def _in_file_dialog(self, dialog: QFileDialog, steps: int) -> None:
        line = dialog.findChild(QLineEdit, "fileNameEdit")
        if line is None or steps > 3 or self.rng.random() < 0.1:
            self._escape(dialog)
            return
        path = self._chosen(dialog)
        self._note(f"  file: {path}")
        line.setText(str(path))
        QTest.keyClick(line, Qt.Key.Key_Return)

    def _chosen(self, dialog: QFileDialog) -> Path:
        """A file that fits the question, mostly."""
        path = self.rng.choice(self._files)
        if dialog.acceptMode() == QFileDialog.AcceptMode.AcceptSave:
            return self.rng.choice((path.with_name(f"made_{self.rng.randrange(5)}"), path.with_name("made.toml"), path))
        wanted = ".csv" if "measured" in dialog.windowTitle() else ".toml"
        fitting = [each for each in self._files if each.suffix == wanted]
        return self.rng.choice(fitting) if self.rng.random() < 0.9 else path


def activate(window: QWidget) -> None:
    """Give a window the keys, as a window manager does with what stands in front."""
    if QApplication.activeWindow() is not window:
        window.activateWindow()


def said(dialog: QWidget) -> str:
    """What a message box says."""
    return f"{dialog.text()} {dialog.informativeText()}"[:300] if isinstance(dialog, QMessageBox) else ""


__all__ = ["Answers", "activate"]
