"""Where the mouse means to be while something is drawn: points, lines and their feet, perpendiculars, steps of 15°, a grid."""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Iterator, Sequence

import numpy as np

from core.design.linkage import FRAME_LINK, Link, Linkage
from core.frozen import frozen
from core.mechanism.drawn import DrawingTarget, PointPositions, slider_line
from kindyna_gui.linkage.picking import foot

POINT, LINE, PERPENDICULAR, ANGLE, GRID, FREE = "point", "line", "perpendicular", "angle", "grid", ""
NEAR, ALONG, TURN = 10.0, 7.0, 6.0  # pixels from a point, a line, and a ray, within which it is meant
STEP_DEG = 15.0
CELL = 14.0  # pixels of a cell of the grid, at least
FACE = 7.0  # pixels from the line of a bar within which its face is


@frozen
class Snap:
    """Where the mouse is taken to be [mm], by which mark, and what stands there."""

    at: complex
    mark: str = FREE
    text: str = ""
    point: str = ""
    link: int | None = None

    @property
    def spot(self) -> DrawingTarget:
        return DrawingTarget(self.at, self.point, self.link)


def grid_step(scale: float) -> float:
    """The width of a cell [mm] at so many pixels per mm: 1, 2 or 5 times a power of ten."""
    least = CELL / scale
    power = 10.0 ** math.floor(math.log10(least))
    return next(k * power for k in (1.0, 2.0, 5.0, 10.0) if k * power >= least * (1.0 - 1e-9))


def on_grid(at: complex, scale: float) -> complex:
    """The nearest crossing of the grid."""
    step = grid_step(scale)
    digits = max(0, -math.floor(math.log10(step)))
    return complex(round(round(at.real / step) * step, digits) + 0.0, round(round(at.imag / step) * step, digits) + 0.0)


def outline(link: Link, places: PointPositions) -> list[complex]:
    """The corners of a link's face on the sheet: of a plate in order around it."""
    corners = [places[name] for name in link.places if name in places]
    if len(corners) < 3:
        return corners
    centre = sum(corners) / len(corners)
    return sorted(corners, key=lambda at: cmath.phase(at - centre) if at != centre else 0.0)


def edges(corners: Sequence[complex]) -> Iterator[tuple[complex, complex]]:
    """The lines of a face."""
    if len(corners) == 2:
        yield corners[0], corners[1]
    elif len(corners) > 2:
        yield from zip(corners, [*corners[1:], corners[0]], strict=True)


def inside(at: complex, corners: Sequence[complex]) -> bool:
    """Whether a place lies within a face."""
    odd = False
    for one, other in edges(corners) if len(corners) > 2 else ():
        if (one.imag > at.imag) != (other.imag > at.imag):
            odd ^= at.real < one.real + (at.imag - one.imag) * (other.real - one.real) / (other.imag - one.imag)
    return odd


def faces_at(linkage: Linkage, places: PointPositions, at: complex, scale: float) -> list[int]:
    """The links whose face is at a place, uppermost first."""
    found = []
    for link in reversed(linkage.links):
        corners = outline(link, places)
        near = any(abs(at - foot(at, one, other)) * scale <= FACE for one, other in edges(corners))
        if link.number != FRAME_LINK and (near or inside(at, corners)):
            found.append(link.number)
    return found


def point_at(places: PointPositions, at: complex, scale: float, without: Collection[str] = ()) -> str:
    """The point that is meant by a place; empty where none is near."""
    near = {name: abs(place - at) * scale for name, place in places.items() if name not in without}
    best = min(near, key=lambda name: near[name], default="")
    return best if best and near[best] <= NEAR else ""


def nearest_mark(marks: Sequence[complex], at: complex, scale: float) -> complex | None:
    """The place of the underlay that is meant; None where none is near."""
    if not len(marks):
        return None
    apart = np.abs(np.asarray(marks) - at)
    best = int(np.argmin(apart))
    return complex(marks[best]) if apart[best] * scale <= NEAR else None


def snapped(
    linkage: Linkage,
    places: PointPositions,
    at: complex,
    scale: float,
    start: complex | None = None,
    without: Collection[str] = (),
    free: bool = False,
    marks: Sequence[complex] = (),
) -> Snap:
    """What a place of the mouse [mm] means, at so many pixels per mm. start: where a line to it begins; without: points that are
    moved themselves; free: it is where it is; marks: places of what lies under the drawing."""
    if free:
        return Snap(at, link=_first(faces_at(linkage, places, at, scale)))
    if name := point_at(places, at, scale, without):
        return Snap(places[name], POINT, name, point=name)
    if (mark := nearest_mark(marks, at, scale)) is not None:
        return Snap(mark, POINT, "of the underlay", link=_first(faces_at(linkage, places, mark, scale)))
    moved = {link.number for link in linkage.links if set(link.places) & set(without)}
    lines = [
        (one, other, link.number)
        for link in linkage.links
        if link.number not in {*moved, FRAME_LINK}
        for one, other in edges(outline(link, places))
    ]
    for one, other, number in lines:
        on = foot(at, one, other)
        if abs(at - on) * scale <= ALONG:
            if start is not None:
                upright = foot(start, one, other)
                if abs(upright - at) * scale <= NEAR and upright not in (one, other, start):
                    return Snap(upright, PERPENDICULAR, "perpendicular", link=number)
            return Snap(on, LINE, f"on link {number}", link=number)
    face = _first([n for n in faces_at(linkage, places, at, scale) if n not in moved])
    for slider in linkage.sliders:
        if slider.on in linkage.by_number:
            through, along = slider_line(linkage, slider, places)
            on = through + along * ((at - through) * along.conjugate()).real
            if abs(at - on) * scale <= ALONG:
                return Snap(on, LINE, "on the line", link=face)
    grid = on_grid(at, scale)
    if start is None or abs(at - start) * scale < NEAR:
        return Snap(grid, GRID, link=face)
    if abs(grid - at) * scale <= 0.25 * CELL:  # a crossing of the grid is meant rather than a ray beside it
        return Snap(grid, GRID, link=face)
    turned = math.degrees(cmath.phase(at - start))
    step = round(turned / STEP_DEG) * STEP_DEG
    ray = cmath.rect(1.0, math.radians(step))
    on = start + ray * ((at - start) * ray.conjugate()).real
    if abs(on - at) * scale <= TURN:
        length = abs(on_grid(complex(abs(on - start), 0.0), scale))
        end = start + ray * length
        return Snap(complex(round(end.real, 9), round(end.imag, 9)), ANGLE, f"{step % 360.0:g}°", link=face)
    return Snap(grid, GRID, link=face)


def _first(numbers: Sequence[int]) -> int | None:
    return numbers[0] if numbers else None


__all__ = [
    "ANGLE", "FREE", "GRID", "LINE", "PERPENDICULAR", "POINT", "Snap", "edges", "faces_at", "grid_step", "inside",
    "nearest_mark", "on_grid", "outline", "point_at", "snapped",
]  # fmt: skip
