"""Edits that put several drives on one shaft: a new shaft, another drive, the current design on a shaft."""

from __future__ import annotations

from kindyna_gui import dialogs, drives
from kindyna_gui.dialogs import OnShaft
from kindyna_gui.drives_view import add_from_file
from kindyna_gui.settings import Settings
from kindyna_gui.window.base import Window

NEW_NAME = "New camshaft"


def new_shaft(window: Window) -> None:
    """Begin a shaft with one drive chosen from images."""
    from kindyna_gui.window.gallery import ask_new_mechanism

    if not window.documents.may_leave():
        return
    choice = ask_new_mechanism(window)
    if choice is not None:
        window.session.start(drives.listed(choice.with_motion(None), NEW_NAME))
        window.show_view("drives")


def add_by_picture(window: Window) -> None:
    """Add a drive chosen from images."""
    from kindyna_gui.window.gallery import ask_new_mechanism

    choice = ask_new_mechanism(window)
    if choice is not None:
        drives.add(window.session, choice.with_motion(None))


def add_to_shaft(window: Window) -> None:
    """Put the current design on a shaft, a new one or that of a file; to a shaft, add the drives of a file."""
    session = window.session
    window.documents.settle()
    if session.has_several_drives:
        if add_from_file(session, window):
            window.show_view("drives")
        return
    answer = dialogs.ask_on_shaft(window, session.full_design.name)
    if answer is OnShaft.NEW:
        drives.list_them(session)
    elif answer is OnShaft.FILE:
        added = session.full_design
        path = dialogs.design_to_open(window, Settings().folder)
        if path is None or not window.documents.open_path(path):
            return
        drives.add(session, added)
    else:
        return
    window.show_view("drives")


__all__ = ["add_by_picture", "add_to_shaft", "new_shaft"]
