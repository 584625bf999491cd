"""The view of the cam along its shaft: edges, centre lines, circles, angle zero, sense of rotation, dimensions."""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from math import asin, degrees, radians

import numpy as np

from core.frozen import frozen
from core.output.drawing.callouts import Callout, Segment, Surroundings, callouts
from core.output.drawing.figures import EQUAL, Figures, ProfilePoint, extent
from core.output.drawing.paper import Box, PaperLayout, scale_for
from core.output.drawing.sheet import (
    CENTRE,
    DASHED,
    OUTLINE,
    THIN,
    ArrowHead,
    BezierLoop,
    Item,
    SheetCircle,
    SheetLine,
    SheetText,
)
from core.output.drawing.tables import LETTERS, number
from core.output.profile.drawing import LAYERS
from core.output.profile.drawing import LineShape as Edge

SIDE, BAND = 13.0, 23.0  # mm on A4: free beside the cam, and above and below it for texts
TEXTS_OFF = 25.0  # mm on A4: how far above and below the cam texts are at most
MARGIN = 3.0  # mm on A4: free along the edge of the field
BEYOND = 4.0  # mm on A4: how far centre lines run beyond what they halve
TURN_FROM, TURN_BY = 155.0, 50.0  # degrees: where the arrow of the rotation is
TURN_OFF = 6.5  # mm on A4: how far it is from the cam
STEP, OFF_AXES = 15.0, 9.0  # degrees between places at which a circle may be named, and from the centre lines
MOST_TIPS = 12
EDGES = 60  # of the outline that leaders shall not cross


@frozen
class ViewPlacement:
    """Where the cam is on the sheet: its centre [mm], millimetres of paper per millimetre."""

    centre: complex
    scale: float

    def __call__(self, z: complex) -> complex:
        return self.centre + self.scale * z


def view(values: Figures, layout: PaperLayout) -> tuple[tuple[int, int], list[Item]]:
    """The scale, paper : cam, and everything in the field of the view. Raises KindynaError for a cam too large for any scale."""
    unit, field = layout.unit, layout.view
    low, high = extent(values.chains)
    size = high - low
    scale = scale_for(size.real, size.imag, (field.width - 2.0 * SIDE * unit, field.height - 2.0 * BAND * unit))
    factor = scale[0] / scale[1]
    placing = ViewPlacement(field.middle - 0.5 * factor * (low + high), factor)
    corner, other = placing(low), placing(high)
    bounds = Box(corner.real, corner.imag, other.real, other.imag)
    items: list[Item] = [BezierLoop(placing.centre + factor * chain.points) for chain in values.chains]
    items += _circles(values, placing)
    items += _edges(values, placing)
    items += _axes(bounds, placing, BEYOND * unit)
    zero, label = _zero(values, bounds, placing, unit)
    turning, chord = _rotation(values, placing, unit)
    margin, off = MARGIN * unit, TEXTS_OFF * unit
    room = Box(
        field.left + margin,
        max(field.bottom + margin, bounds.bottom - off),
        field.right - margin,
        min(field.top - margin, bounds.top + off),
    )
    outline = max((chain.vertices for chain in values.chains), key=lambda z: float(np.abs(z).max()))
    edge = placing.centre + factor * outline[:: max(1, outline.size // EDGES)]
    named = callouts(
        _callouts(values, placing), Surroundings(room, placing.centre.imag, LETTERS * unit, [label, *chord], edge)
    )
    return scale, [*items, *zero, *turning, *named]


def _circles(values: Figures, placing: ViewPlacement) -> Iterator[Item]:
    known = values.cam
    if "base_radius_mm" in known:
        yield SheetCircle(placing.centre, known["base_radius_mm"] * placing.scale, DASHED)
    if "hub_mm" in known:
        yield SheetCircle(placing.centre, 0.5 * known["hub_mm"] * placing.scale, OUTLINE)
    if "bore_mm" in known:
        start, span = 0.0, 360.0
        if _keyway(values):  # where it opens the bore is no edge
            half = degrees(asin(known["keyway_width_mm"] / known["bore_mm"]))
            start, span = known["keyway_angle_deg"] + half, 360.0 - 2.0 * half
        yield SheetCircle(placing.centre, 0.5 * known["bore_mm"] * placing.scale, OUTLINE, start, span)


def _keyway(values: Figures) -> list[Edge]:
    """Its two sides and the bottom, none where it is not known."""
    return [shape for shape in LAYERS["KEYWAY"].shapes(values.job) if isinstance(shape, Edge)]


def _edges(values: Figures, placing: ViewPlacement) -> Iterator[Item]:
    for edge in _keyway(values):
        yield SheetLine((placing(edge.start), placing(edge.end)), OUTLINE)


def _axes(bounds: Box, placing: ViewPlacement, beyond: float) -> Iterator[Item]:
    centre = placing.centre
    yield SheetLine((complex(bounds.left - beyond, centre.imag), complex(bounds.right + beyond, centre.imag)), CENTRE)
    yield SheetLine((complex(centre.real, bounds.bottom - beyond), complex(centre.real, bounds.top + beyond)), CENTRE)


def _zero(values: Figures, bounds: Box, placing: ViewPlacement, unit: float) -> tuple[list[Item], Segment]:
    """The angle-zero mark with its text, and where that stands."""
    marks = [shape for shape in LAYERS["ZERO"].shapes(values.job) if isinstance(shape, Edge)]
    height = LETTERS * unit
    at = complex(bounds.right + (BEYOND + 1.0) * unit, placing.centre.imag - 0.5 * height)
    room = (SIDE - BEYOND - 2.0) * unit
    lines: list[Item] = [SheetLine((placing(mark.start), placing(mark.end)), OUTLINE) for mark in marks]
    return [*lines, SheetText(at, "0°", height, room)], (at, at + room)


def _rotation(values: Figures, placing: ViewPlacement, unit: float) -> tuple[list[Item], list[Segment]]:
    """An arc beside the cam with an arrow in the sense in which it turns, and its chord."""
    z = np.concatenate([chain.vertices for chain in values.chains])
    bearing = np.mod(np.degrees(np.angle(z)), 360.0)
    beside = np.abs(bearing - TURN_FROM - 0.5 * TURN_BY) <= 0.5 * TURN_BY
    radius = placing.scale * float(np.abs(z[beside]).max(initial=float(values.smallest.value))) + TURN_OFF * unit
    first, last = (cmath.rect(1.0, radians(angle)) for angle in (TURN_FROM, TURN_FROM + TURN_BY))
    sense = values.job.study.sense
    end = last if sense > 0.0 else first
    length = 1.6 * LETTERS * unit
    back = end * cmath.exp(-0.5j * sense * length / radius)  # along the chord of its own length
    arrow = ArrowHead(placing.centre + radius * end, 1j * sense * back, length)
    arc = SheetCircle(placing.centre, radius, THIN, TURN_FROM, TURN_BY)
    return [arc, arrow], [(placing.centre + radius * first, placing.centre + radius * last)]


# -- dimensions ------------------------------------------------------------------------------------------------


def _callouts(values: Figures, placing: ViewPlacement) -> list[Callout]:
    known, centre = values.cam, placing.centre
    base = known.get("base_radius_mm")
    least = values.smallest
    on_base = base is not None and abs(least.value - base) <= EQUAL * base

    def radial(place: ProfilePoint, text: str) -> Callout:
        return Callout((f"R {number(place.value)}", text), _tips(place.all, placing), centre)

    found = [
        radial(values.largest, f"largest, at {_angle(values.largest)}"),
        radial(least, "smallest = base circle" if on_base else f"smallest, at {_angle(least)}"),
    ]
    for place, text in ((values.convex, "convex"), (values.concave, "concave")):
        if place is not None:
            found.append(
                Callout((f"least {text} R {number(place.value)}", f"at {_angle(place)}"), _tips(place.all, placing))
            )
    circles = [] if base is None or on_base else [(base, f"R {number(base)}", "base circle")]
    for name, text in (("bore_mm", "bore"), ("hub_mm", "hub")):
        if name in known:
            circles.append((0.5 * known[name], f"⌀ {number(known[name])}", text))
    for radius, size, text in circles:
        around = _around(radius, values if text == "bore" else None)
        found.append(Callout((size, text), _tips(around, placing)))
    sides = _keyway(values)
    if sides:
        width, depth, angle = (
            number(known[name]) for name in ("keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg")
        )
        middles = [placing(0.5 * (side.start + side.end)) for side in (sides[0], sides[-1])]
        found.append(Callout((f"keyway {width} × {depth}", f"at {angle}°"), tuple(middles)))
    return found


def _angle(place: ProfilePoint) -> str:
    return f"cam {number(place.cam_angle_deg, 1)}°"


def _around(radius: float, without: Figures | None) -> np.ndarray:
    """Points of a circle about the cam centre, those of the keyway left out."""
    angles = np.arange(0.5 * STEP, 360.0, STEP)
    if without is not None and _keyway(without):
        known = without.cam
        half = degrees(asin(known["keyway_width_mm"] / known["bore_mm"])) + 0.5 * STEP
        angles = angles[np.abs(np.mod(angles - known["keyway_angle_deg"] + 180.0, 360.0) - 180.0) > half]
    return radius * np.exp(1j * np.radians(angles))


def _tips(z: np.ndarray, placing: ViewPlacement) -> tuple[complex, ...]:
    """Some of these points of the cam on the sheet, away from the centre lines where there is a choice."""
    bearing = np.mod(np.degrees(np.angle(z)) + 45.0, 90.0) - 45.0
    free = z[np.abs(bearing) >= OFF_AXES]
    chosen = free if free.size else z
    chosen = chosen[np.unique(np.linspace(0, chosen.size - 1, min(chosen.size, MOST_TIPS)).round().astype(int))]
    return tuple(placing(complex(each)) for each in chosen)


__all__ = ["view"]
