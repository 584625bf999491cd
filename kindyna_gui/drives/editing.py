"""Edits of the list of drives, each one step of the undo stack."""

from __future__ import annotations

from dataclasses import replace

from core.design import Design, add_drive, copy_drive, move_drive, only, remove_drive, with_shaft
from core.errors import KindynaError
from kindyna_gui.documents.session import Session


def add(session: Session, design: Design, name: str = "") -> bool:
    """The drives of a design behind those that there are; the first of them is chosen. Where the session's design is of one
    drive, it becomes the first of a list. False where it is refused."""
    whole, first = _with_shaft(session.whole), len(session.whole.drives)
    names = []
    try:
        for index in range(len(design.drives)):
            whole = add_drive(whole, only(design, index), name)
            names.append(whole.drives[-1].name or "")
    except KindynaError as error:
        session.refuse("drives", str(error))
        return False
    return _done(session, whole, f"Add {', '.join(names)}", first)


def _with_shaft(design: Design) -> Design:
    """A linkage alone says by its driver how fast it turns; on a shaft with others the shaft does."""
    return with_shaft(design) if design.shaft is None else design


def copy(session: Session) -> bool:
    """The chosen drive once more, behind it."""
    index = session.chosen
    return _done(session, copy_drive(session.whole, index), f"Copy {session.names[index]}", index + 1)


def remove(session: Session) -> bool:
    """The chosen drive, or the balance cam, taken away; the last drive stays."""
    index, name = session.chosen, session.names[session.chosen]
    if session.on_balancer:
        return _done(session, replace(session.whole, balancer=None), f"Remove {name}", 0)
    return _done(session, remove_drive(session.whole, index), f"Remove {name}", min(index, len(session.whole.drives) - 2))


def move(session: Session, by: int) -> bool:
    """The chosen drive further up or down in the list."""
    index, to = session.chosen, session.chosen + by
    if session.on_balancer or not 0 <= to < len(session.whole.drives):
        return False
    way = "up" if by < 0 else "down"
    return _done(session, move_drive(session.whole, index, to), f"Move {session.names[index]} {way}", to)


def rename(session: Session, index: int, name: str) -> bool:
    """Another name of a drive, in the timing too."""
    session.end_gesture()
    return session.edit(f"drives[{index}].name", name, f"Rename {session.names[index]} to {name}")


def _done(session: Session, whole: Design, label: str, chosen: int) -> bool:
    session.end_gesture()
    done = session.put_whole(whole, label, chosen=max(chosen, 0))
    session.end_gesture()
    return done


__all__ = ["add", "copy", "move", "remove", "rename"]
