"""What a dialog asks for, as a line for the command line."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from PySide6.QtWidgets import QApplication, QDialogButtonBox, QPushButton, QWidget

UNSAVED = Path("DESIGN.toml")

Asked = Callable[[], tuple[str, Sequence[str]]]
"""The file, or the folder, that a command writes, the ending of a file alone where that is called as the design; and its options."""


def command_line(name: str, design: Path | None, out: str, words: Sequence[str], drive: str = "") -> str:
    """A command on a design's file, if on any, of one drive where one is named."""
    read = [] if design is None else [str(design)]
    file = f"{design.stem}{out}" if design is not None and out.startswith(".") and "/" not in out else out
    of_drive = ["--drive", drive] if drive else []
    return shlex.join(["kindyna", "--headless", name, *read, *words, *of_drive, "--out", file])


def add_copy(
    buttons: QDialogButtonBox, parent: QWidget, name: str, asked: Asked, *, of_drive: bool = False, reads: bool = True
) -> None:
    """A button of a dialog over the window that puts its command into the clipboard; of_drive: the command takes one of several;
    reads: it is on a design."""

    def line() -> str:
        session: Any = getattr(parent, "session", None)
        drive = session.design.name if session is not None and session.several and of_drive else ""
        design = session.path if session is not None and session.path is not None else UNSAVED
        return command_line(name, design if reads else None, *asked(), drive)

    add_copy_of(buttons, line)


def spelled(name: str, words: Sequence[str]) -> str:
    """A command with these words."""
    return shlex.join(["kindyna", "--headless", name, *words])


def of_session(session: Any) -> dict[str, Any]:
    """The file of the design at hand, and which drive of a shaft it is, as commands name them."""
    return {"into": session.path or UNSAVED, "drive": session.design.name if session.several else ""}


def add_copy_of(buttons: QDialogButtonBox, line: Callable[[], str]) -> None:
    """The same button, of a command that is spelled otherwise."""
    buttons.addButton(copy_button(line), QDialogButtonBox.ButtonRole.ActionRole)


def copy_button(line: Callable[[], str]) -> QPushButton:
    """It by itself, for a window."""

    def copy() -> None:
        QApplication.clipboard().setText(line())
        button.setText("Copied")

    button = QPushButton("Copy as command")
    button.setToolTip("The same for the command line, into the clipboard")
    button.setAutoDefault(False)
    button.clicked.connect(lambda: copy())
    return button


__all__ = ["UNSAVED", "add_copy", "add_copy_of", "command_line", "copy_button", "of_session", "spelled"]
