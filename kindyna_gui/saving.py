"""One file, asked for and written whole or not at all: the picture of a view, the numbers of a plot, what a dialog has made."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from PySide6.QtCore import Qt
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QWidget

from core.design import Design
from core.errors import KindynaError
from core.project.files import write
from core.study import Quantity, Study
from kindyna_gui import background, dialogs
from kindyna_gui.labels import reason
from kindyna_gui.settings import Settings, in_file_units
from kindyna_gui.view import View

Content = bytes | str
Made = TypeVar("Made")


def numbers(design: Design, rows: Sequence[Quantity]) -> str:
    """The channels as a table at the full resolution of the core, as the core writes them."""
    from core.output.export import csv

    study = Study(design)
    names = [study.angle_column, *(row.slug for row in rows)]
    return csv(names, [study.angle_degrees, *(row.values(study) for row in rows)])


def written(parent: QWidget, path: Path | None, make: Callable[[], Content], *, paints: bool = False) -> str:
    """Write one file; returns what has been done, empty where nothing was: no path, or a fault, which is then shown.

    paints: what makes it paints, which only the window's own thread may; anything else is made beside the window.
    """
    if path is None:
        return ""
    try:
        made = _patiently(make) if paints else background.beside(parent, f"Writing {path.name}", make)
        if made is None:
            return f"{path.name} was cancelled; nothing is written"
        write(path, made)
    except KindynaError as error:
        dialogs.show_faults(parent, f"{path.name} cannot be written.", str(error).splitlines())
        return ""
    Settings().folder = path.parent
    return f"Wrote {path}"


def _patiently(make: Callable[[], Made]) -> Made:
    """Do something under the waiting cursor, in the units of files."""
    QApplication.setOverrideCursor(Qt.CursorShape.WaitCursor)
    try:
        with in_file_units():
            return make()
    finally:
        QApplication.restoreOverrideCursor()


def save_picture(view: View, name: str, ask: Callable[[QWidget, Path], Path | None] | None = None) -> None:
    """Ask for a file and write a view's picture there; where the view has nothing to show, a dialog gives the reason."""
    view.pull()
    if view.no_picture:
        dialogs.show_faults(view, "There is no picture to export.", view.no_picture.splitlines())
        return
    path = (ask or dialogs.picture_to_save)(view, Settings().folder / f"{name}.png")
    text = "" if path is None else written(view, path, lambda: view.picture(path.suffix.lower()), paints=True)
    if text:
        view.status_message.emit(text)


def copy_picture(view: View) -> None:
    """A view's picture to the clipboard, twice as fine as the screen; where it has nothing to show, the status line says why."""
    view.pull()
    if view.no_picture:
        view.status_message.emit(f"Nothing is copied. {view.no_picture}")
        return
    try:
        with in_file_units():
            image = QImage.fromData(view.picture(".png"))
    except KindynaError as error:  # a drawing that cannot be put together yet
        view.status_message.emit(f"Nothing is copied. {reason(view.session.design, error)}")
        return
    QApplication.clipboard().setImage(image)
    view.status_message.emit(f"The picture is in the clipboard, {image.width()} × {image.height()} pixels")


def save_numbers(view: View, rows: Sequence[Quantity], name: str) -> None:
    """Ask for a file and write the channels' numbers there; where there are none, a dialog gives the reason."""
    if not rows:
        dialogs.show_faults(view, "There are no numbers to export.", view.no_picture.splitlines())
        return
    design = view.session.design
    path = dialogs.table_to_save(view, Settings().folder / f"{name}.csv")
    text = written(view, path, lambda: numbers(design, rows))
    if text:
        view.status_message.emit(text)
