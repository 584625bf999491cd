"""Edits of the list of drives, each one step of the undo stack."""

from __future__ import annotations

from dataclasses import replace

from core.design import (
    RESERVED,
    Design,
    add_drive,
    as_list,
    copy_drive,
    edited,
    move_drive,
    only,
    remove_drive,
    slug,
    with_only,
    with_shaft,
)
from core.errors import KindynaError
from kindyna_gui.documents.session import BALANCER, Session
from kindyna_gui.labels import reason


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
        session.refuse("drives", reason(whole, error))
        return False
    return _done(session, whole, f"Add {', '.join(names)}", first)


def listed(design: Design, name: str) -> Design:
    """A design of one drive as a shaft of this name with it as the first of a list."""
    return replace(as_list(_with_shaft(design), free_slug(design.name)), name=name)


def list_them(session: Session) -> bool:
    """The session's design, of one drive, as the first of a list."""
    whole = listed(session.whole, session.whole.name)
    return _done(session, whole, f"Put {session.whole.name} on a shaft of several", 0)


def free_slug(name: str) -> str:
    """The name, where a drive may be called so; else one that it may be called."""
    wanted = slug(name).strip("_")
    return name if wanted and slug(name) not in RESERVED else "Drive"


def add_balancer(session: Session) -> bool:
    """A balance cam to begin with, which is then chosen. False where there is one, or nothing can be balanced."""
    from core.shaft import with_balancer

    whole = session.whole
    try:
        made = with_balancer(whole, session.shaft.flywheel.energy_swing)
    except KindynaError as error:
        session.refuse(BALANCER, reason(whole, error))
        return False
    return whole.balancer is None and _done(session, made, "Add a balance cam", len(whole.drives))


def _with_shaft(design: Design) -> Design:
    """A linkage alone says by its driver how fast it turns; on a shaft with others the shaft does."""
    return with_shaft(design) if design.shaft is None else design


def copy(session: Session) -> bool:
    """The chosen drive once more, behind it."""
    index = session.chosen
    return _done(session, copy_drive(session.whole, index), f"Copy {session.names[index]}", index + 1)


def replace_chosen(session: Session, design: Design, label: str) -> bool:
    """Another mechanism in place of the chosen drive's, which keeps its name and its place on the shaft."""
    alone = replace(design, name=session.design.name, shaft=session.design.shaft)
    whole = with_only(session.whole, session.chosen, alone)
    whole = edited(
        whole, "shaft.speed_rpm", session.whole.camshaft.speed_rpm
    )  # a linkage's driver turns as the shaft does
    return _done(session, whole, label, session.chosen)


def remove(session: Session) -> bool:
    """The chosen drive, or the balance cam, taken away; the last drive stays."""
    index, name = session.chosen, session.names[session.chosen]
    if session.on_balancer:
        kept = tuple(path for path in session.whole.assumed if not path.startswith(f"{BALANCER}."))
        return _done(session, replace(session.whole, balancer=None, assumed=kept), f"Remove {name}", 0)
    return _done(
        session, remove_drive(session.whole, index), f"Remove {name}", min(index, len(session.whole.drives) - 2)
    )


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


__all__ = ["add", "add_balancer", "copy", "list_them", "listed", "move", "remove", "rename", "replace_chosen"]
