"""Writing one file, completely or not at all: the picture of a view, the numbers of a plot, the result of a dialog."""

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
Result = TypeVar("Result")


def numbers(design: Design, rows: Sequence[Quantity]) -> str:
    """Return channels as a CSV table, with the resolution and format of the command line."""
    from core.output.export import csv

    study = Study(design)
    names = [study.angle_column, *(row.slug for row in rows)]
    return csv(names, [study.angle_degrees, *(row.values(study) for row in rows)])


def written(parent: QWidget, path: Path | None, make: Callable[[], Content], *, paints: bool = False) -> str:
    """Write one file and return what was done; empty where there is no path, or after showing a fault.

    ``paints`` says that ``make`` paints, which only the window's thread may do; else it runs in the background.
    """
    if path is None:
        return ""
    try:
        content = _with_wait_cursor(make) if paints else background.in_background(parent, f"Writing {path.name}", make)
        if content is None:
            return f"Cancelled; {path.name} was not written"
        write(path, content)
    except KindynaError as error:
        dialogs.show_faults(parent, f"{path.name} cannot be written.", str(error).splitlines())
        return ""
    Settings().folder = path.parent
    return f"Wrote {path}"


def _with_wait_cursor(make: Callable[[], Result]) -> Result:
    """Compute a content under the wait cursor, in the units of files."""
    QApplication.setOverrideCursor(Qt.CursorShape.WaitCursor)
    try:
        with in_file_units():
            return make()
    finally:
        QApplication.restoreOverrideCursor()


def save_picture(view: View, name: str, ask: Callable[[QWidget, Path], Path | None] | None = None) -> None:
    """Ask for a file and write a view's picture to it; where the view is empty, a dialog gives the reason."""
    view.pull()
    if view.no_picture:
        dialogs.show_faults(view, "There is no picture to export.", view.no_picture.splitlines())
        return
    path = (ask or dialogs.picture_to_save)(view, Settings().folder / f"{name}.png")
    text = "" if path is None else written(view, path, lambda: view.picture(path.suffix.lower()), paints=True)
    if text:
        view.status_message.emit(text)


def copy_picture(view: View) -> None:
    """Copy a view's picture to the clipboard, at twice the resolution; where it is empty, the status line says why."""
    view.pull()
    if view.no_picture:
        view.status_message.emit(f"Nothing was copied. {view.no_picture}")
        return
    try:
        with in_file_units():
            image = QImage.fromData(view.picture(".png"))
    except KindynaError as error:  # a linkage that cannot be assembled
        view.status_message.emit(f"Nothing was copied. {reason(view.session.design, error)}")
        return
    QApplication.clipboard().setImage(image)
    view.status_message.emit(f"Picture copied to the clipboard, {image.width()} × {image.height()} pixels")


def save_numbers(view: View, rows: Sequence[Quantity], name: str) -> None:
    """Ask for a file and write the numbers of channels to it; where there are none, a dialog gives the reason."""
    if not rows:
        dialogs.show_faults(view, "There are no numbers to export.", view.no_picture.splitlines())
        return
    design = view.session.design
    path = dialogs.table_to_save(view, Settings().folder / f"{name}.csv")
    text = written(view, path, lambda: numbers(design, rows))
    if text:
        view.status_message.emit(text)
