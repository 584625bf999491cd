"""Forces as diagrams: the closed polygon of all that acts on a body, and the force in one pair over the whole turn."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from itertools import accumulate
from types import MappingProxyType

import numpy as np

from core.dynamics import (
    CONTACT,
    DRIVE,
    FRICTION,
    INERTIA,
    LOAD,
    MASS_KINDS,
    REACTION,
    SPRING,
    WEIGHT,
    ForceOnBody,
    imbalance,
)
from kindyna_gui.pictures.units import number, readable, short, with_unit
from kindyna_gui.pictures.vector_polygon.sheet import Kind, PolygonCorner, PolygonDiagram, PolygonVector, box_of

FORCES = Kind("force", "N", 1.0, "No force acts here at this angle.")
LETTERS: Mapping[str, str] = MappingProxyType(
    {REACTION: "F", CONTACT: "F", FRICTION: "R", DRIVE: "D", SPRING: "S", LOAD: "P", WEIGHT: "G", INERTIA: "\u2212ma"}
)
"""Kind of a force -> its letter; its index is the pair, the element or the body."""
DIGITS = 4
JAMS = "Friction jams here: the forces are infinite."
COUPLES: Mapping[str, str] = MappingProxyType({REACTION: "M", INERTIA: "\u2212Iα"})
"""Kind of a couple -> its letter, where that is not the force's."""
NO_COUPLE = 1e-9  # of the largest couple at this angle
NO_FORCE = 1e-9  # of the largest force on the body over the turn: what is less is left out


def body_label(body: str) -> str:
    """``link 3``, ``arm``, ``follower``."""
    return re.sub(r"(?<=[a-z])(?=\d)", " ", body).replace("_", " ")


def pair_label(name: str) -> str:
    """``A``, ``arm pin``, ``guide of link 4``."""
    return f"guide of link {name}" if name.isdecimal() else body_label(name)


def force_name(row: ForceOnBody) -> tuple[str, str]:
    """Letter and index: ``F`` and the pair, ``F`` and ``cam``, ``S`` and the number of the spring, ``torsion 1``."""
    if row.kind == CONTACT:
        return LETTERS[row.kind], "cam" if row.name == "inner" else row.name
    if row.kind == FRICTION and row.name in ("inner", "outer", "second"):
        return LETTERS[row.kind], "cam"
    words = body_label(row.name)
    return LETTERS[row.kind], re.sub(r"^(?:link|spring) (?=\d)|(?<=^torsion) spring", "", words)


def amount(value: float, unit: str = "N") -> str:
    """A force, a part of one or a couple with its unit."""
    rung = readable(unit, abs(value))
    return with_unit(short(value / rung.size, DIGITS), rung.symbol)


def force_box(rows: Sequence[ForceOnBody]) -> tuple[complex, complex]:
    """What a sheet must hold of a body's polygon over the turn [N]."""
    ends = (
        list(accumulate((row.force for row in rows), initial=np.zeros_like(rows[0].force)))
        if rows
        else [np.zeros(1, dtype=complex)]
    )
    return box_of(np.array(ends))


def force_diagram(rows: Sequence[ForceOnBody], largest: float) -> PolygonDiagram:
    """The polygon of one position, side by side in the order of the rows; largest: of the body's forces over the turn [N]."""
    if not all(np.isfinite(row.force[0]) for row in rows):
        return PolygonDiagram(FORCES, (), lines=(JAMS,))
    strokes: list[PolygonVector] = []
    place = 0j
    for row in rows:
        force = complex(row.force[0])
        if abs(force) > NO_FORCE * largest:
            strokes.append(
                PolygonVector(*force_name(row), place, force, dashed=row.kind in MASS_KINDS, value=amount(abs(force)))
            )
            place += force
    left, _ = imbalance(tuple(rows))
    closed = "closed" if left[0] == 0.0 else f"closed to {float(left[0]):.0e} N"
    text = f"{len(strokes)} forces, {closed}" if strokes else ""
    return PolygonDiagram(FORCES, tuple(strokes), lines=(text, _couples(rows), ""))


def _couples(rows: Sequence[ForceOnBody]) -> str:
    """The couples on the body, which no side of the polygon shows."""
    largest = max((abs(float(row.couple[0])) for row in rows), default=0.0)
    told = []
    for row in rows:
        couple = float(row.couple[0])
        if np.isfinite(couple) and abs(couple) > NO_COUPLE * largest:
            letter, index = force_name(row)
            letter = COUPLES.get(row.kind, letter)
            told.append(f"{letter} {index} {amount(couple, 'N·m')}")
    return f"Couples: {', '.join(told)}" if told else ""


def pair_box(force: np.ndarray) -> tuple[complex, complex]:
    """What a sheet must hold of one force over the turn [N]."""
    return box_of(np.array([np.zeros_like(force), force]))


def pair_diagram(name: str, force: complex, turn: np.ndarray) -> PolygonDiagram:
    """The force [N] in a pair from a pole, and the curve of its end over the turn (n,): what its bearing carries."""
    finite = turn[np.isfinite(turn)]
    if not np.isfinite(force):
        return PolygonDiagram(FORCES, (), curve=finite, lines=(JAMS,))
    text = f"x {amount(force.real)}, y {amount(force.imag)}: {amount(abs(force))} at {number(math.degrees(np.angle(force)), 1)}°"
    stroke = PolygonVector("F", body_label(name), 0j, force, value=amount(abs(force)))
    return PolygonDiagram(FORCES, (stroke,), (PolygonCorner("", "", 0j),), curve=finite, lines=(text,))
