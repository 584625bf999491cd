"""The drives of a design file on the shaft at hand."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

from core.errors import KindynaError
from core.project import load
from kindyna_gui import dialogs
from kindyna_gui.documents.session import Session
from kindyna_gui.drives import editing
from kindyna_gui.settings import Settings


def add_from_file(session: Session, parent: QWidget) -> bool:
    """Ask for a file, whose drives come behind those there are; False where none is added."""
    path = dialogs.design_to_open(parent, Settings().folder)
    if path is None:
        return False
    try:
        return editing.add(session, load(path))
    except KindynaError as error:
        dialogs.show_faults(parent, f"{path.name} cannot be read.", str(error).splitlines())
        return False
