"""Target of a drawing tool: the faces of the links of a drawing, and the point or the link that a position joins."""

from __future__ import annotations

import cmath
from collections.abc import Collection, Iterator, Sequence

from core.design.linkage import FRAME_LINK, Link, Linkage
from core.frozen import frozen
from core.mechanism.drawn import PointPositions, nearest_on_segment

JOINED = 1e-6
"""Distance [mm] within which a position is on a point, or on the line of a bar."""


@frozen
class DrawingTarget:
    """Target of a drawing tool: a position [mm], with the point or the link that is there."""

    at: complex
    point: str = ""
    link: int | None = None


def joined(
    linkage: Linkage, positions: PointPositions, target: DrawingTarget, barred: Collection[int] = ()
) -> DrawingTarget:
    """The target with what its position joins: a point there, else the bar, or the plate with an edge, on whose line it is.

    barred: links that are not joined, because they have a point of the new link already, and a second one would make them one body.
    """
    if target.point:
        return target
    if point := coincident_point(positions, target.at):
        return DrawingTarget(positions[point], point)
    if target.link is None:
        for link in reversed(linkage.links):
            if link.number != FRAME_LINK and link.number not in barred:
                for first, second in edges(outline(link, positions)):
                    on = nearest_on_segment(target.at, first, second)
                    if abs(on - target.at) <= JOINED:
                        return DrawingTarget(on, link=link.number)
    return target


def coincident_point(positions: PointPositions, at: complex, without: Collection[str] = ()) -> str:
    """Name of the point at a position; empty if there is none."""
    return next((n for n, point in positions.items() if abs(point - at) <= JOINED and n not in without), "")


def links_with(linkage: Linkage, names: Collection[str]) -> set[int]:
    """Moving links that have one of these points."""
    return {n for n, link in linkage.by_number.items() if n != FRAME_LINK and any(p.name in names for p in link.points)}


# -- faces of links ---------------------------------------------------------------------------------------------


def outline(link: Link, positions: PointPositions) -> list[complex]:
    """Corners of the face of a link [mm], for a plate in order around it."""
    corners = [positions[point.name] for point in link.points if point.name in positions]
    if len(corners) < 3:
        return corners
    centre = sum(corners) / len(corners)
    return sorted(corners, key=lambda at: cmath.phase(at - centre) if at != centre else 0.0)


def edges(corners: Sequence[complex]) -> Iterator[tuple[complex, complex]]:
    """Yield the edges of a face, one for a bar."""
    if len(corners) == 2:
        yield corners[0], corners[1]
    elif len(corners) > 2:
        yield from zip(corners, [*corners[1:], corners[0]], strict=True)


def is_inside(at: complex, corners: Sequence[complex]) -> bool:
    """Whether a position is inside a face."""
    odd = False
    for first, second in edges(corners) if len(corners) > 2 else ():
        if (first.imag > at.imag) != (second.imag > at.imag):
            odd ^= at.real < first.real + (at.imag - first.imag) * (second.real - first.real) / (
                second.imag - first.imag
            )
    return odd


def faces_at(linkage: Linkage, positions: PointPositions, at: complex, half_width_mm: float) -> list[int]:
    """Return the links whose face is at a position, uppermost first; a bar reaches to half its width [mm] from its line."""
    numbers = []
    for link in reversed(linkage.links):
        corners = outline(link, positions)
        near = any(abs(at - nearest_on_segment(at, *edge)) <= half_width_mm for edge in edges(corners))
        if link.number != FRAME_LINK and (near or is_inside(at, corners)):
            numbers.append(link.number)
    return numbers


def crossing(start: complex, along: complex, first: complex, second: complex) -> complex | None:
    """Point where a line through ``start`` crosses a line segment; None where it does not, or both are parallel."""
    segment = second - first
    across = (along.conjugate() * segment).imag
    if abs(across) <= 1e-9 * abs(along) * abs(segment):
        return None
    share = (along.conjugate() * (start - first)).imag / across
    return first + share * segment if 0.0 <= share <= 1.0 else None
