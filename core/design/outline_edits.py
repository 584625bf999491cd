"""Edits of outlines and clearances: functions from design to design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from core.design.camshaft import drive_names, slugs
from core.design.design import Design
from core.design.outline_bodies import Body, body_named, body_words, outlined_bodies
from core.design.outlines import CAM, CARRIED, FRAME, PLANES, ROLLER, ClearanceRow, Outline, OutlinePoint
from core.design.paths import followed

SIDE_MM = 20.0
"""Side of the square, or twice the growth, with which a new outline begins."""


def possible_bodies(design: Design) -> tuple[tuple[str, str | None], ...]:
    """Word and drive of every body that can have an outline; the drive is None where the design lists none."""
    rows: list[tuple[str, str | None]] = []
    for drive, name in zip(design.drives, drive_names(design), strict=True):
        rows += [(word, name if design.listed else None) for word in _distinct(body_words(drive))]
    carries = ((CARRIED, None),) if any(drive.carries for drive in design.drives) else ()
    return (*rows, (FRAME, None), *carries)


def _distinct(words: Mapping[str, str]) -> list[str]:
    """The first word of every body."""
    names: dict[str, str] = {}
    for word, name in words.items():
        names.setdefault(name, word)
    return list(names.values())


def new_outline(design: Design, word: str, drive: str | None) -> Outline:
    """Outline of a body to begin with: the circle of a roller, the profile of a cam, the points of a link, else a square."""
    plane = PLANES[1] if word == CARRIED else None
    number = drive_names(design).index(drive) if drive is not None else 0
    cam = design.drives[number].cam
    if word == ROLLER or (word == CAM and not getattr(cam.form, "play_mm", None) and cam.form.form != "groove"):
        return Outline(of=word, drive=drive)
    if word not in (CAM, FRAME, CARRIED) and _has_points(design, number, word):
        return Outline(of=word, drive=drive, round_mm=0.5 * SIDE_MM)
    half = 0.5 * SIDE_MM
    corners = ((-half, -half), (half, -half), (half, half), (-half, half))
    return Outline(of=word, drive=drive, plane=plane, points=tuple(OutlinePoint(x, y) for x, y in corners))


def _has_points(design: Design, number: int, word: str) -> bool:
    """Whether the points of a body make more than a circle: those of a link, and of the arms and rods of followers."""
    for link in design.drives[number].links:
        if word == f"link {link.number}":
            return len(link.points) > 1
    return word in ("arm", "rod", "rocker", "pushrod")


def add_outline(design: Design, word: str, drive: str | None = None) -> Design:
    """Design with an outline of a body added at the end."""
    return replace(design, outlines=(*design.outlines, new_outline(design, word, drive)))


def with_outline(design: Design, index: int, outline: Outline) -> Design:
    """Design with one outline replaced."""
    rows = list(design.outlines)
    rows[index] = outline
    return replace(design, outlines=tuple(rows))


def with_outline_order(design: Design, order: Sequence[int]) -> Design:
    """Design with the outlines of these numbers, in this order; without clearances of bodies that have no outline left."""
    marks = followed(design.assumed, "outlines", order)
    changed = replace(design, outlines=tuple(design.outlines[i] for i in order), assumed=marks)
    names = outlined_bodies(changed)
    kept = [
        i for i, row in enumerate(design.clearances) if all(body_named(changed, text) in names for text in row.between)
    ]
    marks = followed(marks, "clearances", kept)
    return replace(changed, clearances=tuple(design.clearances[i] for i in kept), assumed=marks)


def with_corner(design: Design, index: int, corner: int, x_mm: float, y_mm: float) -> Design:
    """Design with one corner of an outline at another position in the frame of its body."""
    points = list(design.outlines[index].points)
    points[corner] = OutlinePoint(x_mm, y_mm)
    return with_outline(design, index, replace(design.outlines[index], points=tuple(points)))


def with_clearance(design: Design, pair: tuple[Body, Body], least_mm: float | None) -> Design:
    """Design in which two bodies must keep a clearance; None: no clearance is stated."""
    names = outlined_bodies(design)
    rows = [row for row in design.clearances if {body_named(design, text) for text in row.between} != set(pair)]
    if least_mm is not None:
        number = next(
            (i for i, row in enumerate(design.clearances) if {body_named(design, t) for t in row.between} == set(pair)),
            len(rows),
        )
        rows.insert(number, ClearanceRow((names[pair[0]], names[pair[1]]), least_mm))
    return replace(design, clearances=tuple(rows))


def body_title(design: Design, word: str, drive: str | None) -> str:
    """Name of a body in texts: ``feed.arm``, ``link 3``."""
    if drive is None:
        return word
    return (
        f"{slugs(design)[drive_names(design).index(drive)]}.{word}"
        if drive in drive_names(design)
        else f"{drive}.{word}"
    )
