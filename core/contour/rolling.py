"""A follower that rolls round a closed curve: its line or arc and its position at every cam angle, in closed form."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from core.contour.drawing import BREAK, JOIN_MM, Contour, DrawingError, at_text
from core.contour.elements import ContourElement, arc, area, distances, intersections, near_pairs
from core.design import Design
from core.errors import angle_list
from core.followers.touching import Touching, touching
from core.frozen import frozen
from core.number_text import result_text
from core.numerics.derivatives import Taylor

# -- path of a roller's centre round a closed curve of lines and arcs -------------------------------------------


INSIDE = 1e-7  # relative: tolerance of the distance of a centre from the curve
SHORT = 1e-7  # relative: a shorter piece is omitted


@frozen(eq=False)
class PathCorner:
    """Joint between two elements of the path, with the turn of the tangent [rad], positive where convex."""

    point: complex
    turn: float


@frozen(eq=False)
class OffsetPath:
    """A closed chain of elements counter-clockwise; joints[i] is before elements[i]."""

    elements: tuple[ContourElement, ...]
    joints: tuple[PathCorner, ...]


def offset_path(elements: Sequence[ContourElement], radius: float, smooth: float = BREAK) -> OffsetPath:
    """The outer path at a distance [mm]; at 0 the curve itself. Raises DrawingError where none remains.

    smooth: smaller turns of the tangent [rad] count as smooth.
    """
    if radius == 0.0:
        return _with_joints(list(elements), smooth)
    parallels = _offset_elements(elements, radius, smooth)
    cuts = _cuts(parallels)
    is_cut = any(element is None for element, _ in parallels) or any(cuts)
    pieces = [element for element, _ in parallels if element is not None]
    return _with_joints(_outer_chain(elements, radius, pieces, cuts) if is_cut else pieces, smooth)


def turn_between(a: ContourElement, b: ContourElement, smooth: float) -> float:
    """Turn of the tangent from the end of one element to the start of the next [rad]; 0 where it counts as smooth."""
    turn = _tangent_turn(a, b)
    return turn if abs(turn) > smooth else 0.0


def _tangent_turn(a: ContourElement, b: ContourElement) -> float:
    """Turn of the tangent from the end of one element to the start of the next [rad]."""
    return cmath.phase(complex(b.tangent(0.0)) / complex(a.tangent(1.0)))


def _offset_elements(
    elements: Sequence[ContourElement], radius: float, smooth: float
) -> list[tuple[ContourElement | None, float]]:
    """Parallel elements of the curve, with arcs about its convex corners; None for an arc smaller than the roller.

    With each element the distance [mm] from its end within which it may cross the next one and still counts as
    connected; -1 where it is not connected. In a concave corner the crossing has the distance radius times half the
    turn from the ends; where the gap between roller and corner is negligible, the elements are connected.
    """
    size = max(abs(element.start) for element in elements)
    result: list[tuple[ContourElement | None, float]] = []
    for a, b in zip(elements, [*elements[1:], elements[0]], strict=True):
        turn, tangent_turn = (0.0, 0.0) if len(elements) == 1 else (turn_between(a, b, smooth), _tangent_turn(a, b))
        parallel = a.offset(radius)
        is_connected = parallel is not None and (turn >= 0.0 or 0.125 * radius * turn * turn <= INSIDE * size)
        result.append((parallel, 1e-5 * size + radius * abs(tangent_turn) if is_connected else -1.0))
        if turn > 0.0:
            result.append((arc(a.end, radius, cmath.phase(complex(a.normal(1.0))), turn), 1e-5 * size))
    return result


def _cuts(raw: Sequence[tuple[ContourElement | None, float]]) -> list[list[complex]]:
    """Points at which the remaining elements cross each other, for each of them."""
    remaining = [(i, element) for i, (element, _) in enumerate(raw) if element is not None]
    cuts: list[list[complex]] = [[] for _ in remaining]
    for i, j in near_pairs([element for _, element in remaining]):
        (p, a), (q, b) = remaining[i], remaining[j]
        shared = []
        if q == p + 1:
            shared.append((a.end, raw[p][1]))
        if p == 0 and q == len(raw) - 1:
            shared.append((a.start, raw[q][1]))
        for z in intersections(a, b):
            if all(abs(z - end) > tolerance for end, tolerance in shared):
                cuts[i].append(z)
                cuts[j].append(z)
    return cuts


def _outer_chain(
    curve: Sequence[ContourElement], radius: float, pieces: Sequence[ContourElement], cuts: Sequence[Sequence[complex]]
) -> list[ContourElement]:
    """The outermost chain of the pieces between crossings on which the roller does not enter the curve."""
    size = max(abs(element.start) for element in curve)
    valid = []
    for element, points in zip(pieces, cuts, strict=True):
        fractions = sorted((element.fraction_at(z), z) for z in points)
        stops = [(0.0, element.start), *((t, z) for t, z in fractions if 0.0 < t < 1.0), (1.0, element.end)]
        for (low, start), (high, end) in pairwise(stops):
            if (high - low) * element.length <= SHORT * size:
                continue
            piece = element.piece(low, high)
            if float(distances(curve, complex(piece.at(0.5))).min()) >= radius - INSIDE * size:
                valid.append(piece.with_ends(start, end))
    chains = _chains(valid, 10.0 * SHORT * size)
    if not chains:
        raise DrawingError(f"a roller of radius {radius:g} mm has no path around the curve; use a smaller one")
    return max(chains, key=area)


def _chains(pieces: Sequence[ContourElement], tolerance: float) -> list[list[ContourElement]]:
    """Closed chains of pieces."""
    remaining, chains = list(pieces), []
    while remaining:
        chain = [remaining.pop(0)]
        while abs(chain[-1].end - chain[0].start) > tolerance or len(chain) == 1:
            if (
                len(chain) == 1
                and abs(chain[0].end - chain[0].start) <= tolerance
                and chain[0].length > 2.0 * tolerance
            ):
                break
            following = next(
                (i for i, piece in enumerate(remaining) if abs(piece.start - chain[-1].end) <= tolerance), None
            )
            if following is None:
                chain = []
                break
            chain.append(remaining.pop(following))
        if chain:
            chains.append(chain)
    return chains


def _with_joints(elements: list[ContourElement], smooth: float) -> OffsetPath:
    if len(elements) == 1:
        return OffsetPath(tuple(elements), (PathCorner(elements[0].start, 0.0),))
    before = [elements[-1], *elements[:-1]]
    joints = [
        PathCorner(0.5 * (a.end + b.start), turn_between(a, b, smooth)) for a, b in zip(before, elements, strict=True)
    ]
    return OffsetPath(tuple(elements), tuple(joints))


def concave_point(elements: Sequence[ContourElement], smooth: float = BREAK) -> complex | None:
    """Middle of the longest concave arc of a curve, or a concave corner; None where it is convex."""
    arcs = [element for element in elements if element.sweep < 0.0]
    if arcs:
        return complex(max(arcs, key=lambda element: element.length).at(0.5))
    pairs = zip(elements, [*elements[1:], elements[0]], strict=True) if len(elements) > 1 else ()
    corners = [(turn_between(a, b, smooth), a.end) for a, b in pairs]
    worst = min(corners, key=lambda corner: corner[0], default=(0.0, 0j))
    return worst[1] if worst[0] < 0.0 else None


def nearest(elements: Sequence[ContourElement], z: complex = 0j) -> float:
    """Least distance of a point from a curve [mm]."""
    return float(np.min(distances(elements, z)))


# -- follower that rolls round a closed curve -------------------------------------------------------------------


TURN = 2.0 * math.pi
SAMPLES = 24  # of each line or arc, and per radian of its sweep, at which the contact is checked
ROUND_OFF = 1e-12  # [rad] tolerance of a decreasing angle


@frozen(eq=False)
class RolledPart:
    """Part of the turn on one line or arc.

    Attributes
    ----------
    low, high : cam angles [rad], low < high; the full turn on a circle
    driver : cam angles (n,) [rad] -> the driver's position [mm or rad] with two derivatives
    breaks : the tangent of the face's path breaks at the begin, so that the velocity jumps
    corner : the face turns about a corner of the curve
    place : begin, as drawn at cam angle 0 [mm]: of a round's centre, or the middle of a flat face's contact
    """

    low: float
    high: float
    driver: Callable[[np.ndarray], Taylor]
    breaks: bool
    corner: bool = False
    place: complex = 0j


@frozen(eq=False)
class Rolled:
    """Rolling of a follower over one turn.

    Attributes
    ----------
    parts : in the order of the cam angle
    reach : least distance of the face's reference from the cam centre [mm]
    path : of a round's centre, or the curve itself, as drawn at cam angle 0
    """

    parts: tuple[RolledPart, ...]
    reach: float
    path: tuple[ContourElement, ...]


@frozen(eq=False)
class _Piece:
    """A line or arc that the face follows, counter-clockwise round the cam.

    angle: fractions (n,) of it -> rotation of the cam; place: fractions -> points; driver: as in ``RolledPart``;
    breaks: at the begin; begin: rotation of the cam at the begin; start: the point there.
    """

    angle: Callable[[np.ndarray], np.ndarray]
    place: Callable[[np.ndarray], np.ndarray]
    driver: Callable[[np.ndarray], Taylor]
    breaks: bool
    begin: float
    samples: int
    start: complex
    corner: bool = False


def roll(contour: Contour, design: Design) -> Rolled:
    """Rolling of the follower of a design on a curve.

    Raises DrawingError where it cannot follow the curve, and where a flat face meets a concave part; DesignError where
    the design has no follower on a cam.
    """
    follower: Any = design.drive.mechanism
    face, sign = design.drive.face, design.sense
    row = touching(follower)
    if face.straight:
        pieces, reach = list(_flat_pieces(contour, row, sign)), _least_support(contour)
        path = contour.elements
    else:
        roller_path = offset_path(contour.elements, face.radius_mm, contour.smooth)
        path, reach = roller_path.elements, nearest(roller_path.elements)
        pieces = [
            _round_piece(element, joint.point, joint.turn != 0.0, row, sign, face.radius_mm)
            for element, joint in zip(roller_path.elements, roller_path.joints, strict=True)
        ]
    return Rolled(tuple(_ordered(pieces, contour, face.noun, sign)), reach, tuple(path))


def _round_piece(
    element: ContourElement, begin: complex, breaks: bool, row: Touching, sign: float, radius: float
) -> _Piece:
    middle, normal, curvature = complex(element.at(0.5)), complex(element.normal(0.5)), element.curvature

    def driver(theta: np.ndarray) -> Taylor:
        turn = Taylor.turning(theta, sign)
        return row.position(turn * middle, turn * normal, curvature)

    def angle(part: np.ndarray) -> np.ndarray:
        return row.angle(element.at(part))

    corner = element.sweep > 0.0 and abs(element.radius - radius) <= 1e-9 * radius

    return _Piece(
        angle,
        element.at,
        driver,
        breaks,
        float(row.angle(np.array([begin]))[0]),
        _samples(element.sweep),
        begin,
        corner,
    )


def _samples(sweep: float) -> int:
    return SAMPLES + math.ceil(SAMPLES * abs(sweep))


# -- a flat face ------------------------------------------------------------------------------------------


@frozen
class _Support:
    """An arc, or a corner of radius 0, about which a flat face turns: from a unit normal over an angle [rad]."""

    centre: complex
    radius: float
    normal: complex
    sweep: float

    def normals(self, part: np.ndarray) -> np.ndarray:
        return np.asarray(self.normal * np.exp(1j * self.sweep * np.asarray(part)))

    def contact(self, part: np.ndarray) -> np.ndarray:
        return self.centre + self.radius * self.normals(part)


def _supports(contour: Contour) -> list[_Support]:
    """Arcs and corners about which a flat face turns, in order round a convex curve."""
    supports, elements = [], contour.elements
    for a, b in zip(elements, [*elements[1:], elements[0]], strict=True):
        if not a.is_line:
            supports.append(_Support(a.centre, a.radius, complex(a.normal(0.0)), a.sweep))
        turn = 0.0 if len(elements) == 1 else turn_between(a, b, contour.smooth)
        if turn > 0.0:
            supports.append(_Support(a.end, 0.0, complex(a.normal(1.0)), turn))
    return supports


def _flat_pieces(contour: Contour, row: Touching, sign: float) -> Iterator[_Piece]:
    point = concave_point(contour.elements, contour.smooth)
    if point is not None:
        raise DrawingError(
            f"{contour.name}: the curve is hollow at {at_text(point)} from the cam centre, where a flat face "
            "does not reach it; choose a roller, or a convex curve"
        )
    supports = _supports(contour)
    for before, support in zip([supports[-1], *supports[:-1]], supports, strict=True):
        n = 0.5 * (complex(before.normals(np.array(1.0))) + support.normal)
        last, first = complex(before.contact(np.array(1.0))), complex(support.contact(np.array(0.0)))
        breaks = abs(first - last) > JOIN_MM
        begin = float(row.angle(np.array([0.5 * (first + last)]), np.array([n / abs(n)]))[0])
        yield _support_piece(support, breaks, begin, 0.5 * (first + last), row, sign)


def _support_piece(support: _Support, breaks: bool, begin: float, start: complex, row: Touching, sign: float) -> _Piece:
    return _Piece(
        lambda part: row.angle(support.contact(part), support.normals(part)),
        support.contact,
        lambda theta: row.position(Taylor.turning(theta, sign) * support.centre, support.radius),
        breaks,
        begin,
        _samples(support.sweep),
        start,
        support.radius == 0.0,
    )


def _least_support(contour: Contour) -> float:
    """Least distance of a flat face from the cam centre [mm]: at the ends of a line, or ρ + c·n on an arc."""
    chords = [element for element in contour.elements if element.is_line]
    least = [((element.start * complex(element.normal(0.0)).conjugate()).real) for element in chords]
    for support in _supports(contour):
        c = support.centre
        ends = [support.normal, complex(support.normals(np.array(1.0)))]
        if abs(c) > 0.0:
            turn = cmath.phase(-c / support.normal) % TURN
            if turn < support.sweep:
                ends.append(-c / abs(c))
        least += [support.radius + (c * n.conjugate()).real for n in ends]
    return min(least)


# -- order by cam angle ------------------------------------------------------------------------------------


def _ordered(pieces: list[_Piece], contour: Contour, noun: str, sign: float) -> list[RolledPart]:
    """The pieces by cam angle θ; sign θ is the rotation of the cam, which goes backwards along the curve."""
    for piece in pieces:
        _require_followed(piece, contour, noun, sign)
    if len(pieces) == 1:
        return [RolledPart(0.0, TURN, pieces[0].driver, False)]
    ends = [*pieces[1:], pieces[0]]
    rows = [(a, b) for a, b in zip(pieces, ends, strict=True)]
    if sign > 0.0:  # a piece ends at its begin
        rows = [(piece, after) for piece, after in reversed(rows)]
    parts, end = [], None
    for piece, after in rows:
        low, high = (after.begin, piece.begin) if sign > 0.0 else (piece.begin, after.begin)
        first = after if sign > 0.0 else piece  # where it begins by cam angle
        start = sign * low if end is None else end
        span = (sign * (high - low)) % TURN
        if span > TURN - 1e-9:  # zero length
            span = 0.0
        parts.append(RolledPart(start, start + span, piece.driver, first.breaks, piece.corner, first.start))
        end = start + span
    total = parts[-1].high - parts[0].low
    if abs(total - TURN) > 1e-6:
        raise DrawingError(
            f"{contour.name}: the {noun} goes {result_text(total / TURN)} times round the curve in one turn; it must be once"
        )
    return parts


def _require_followed(piece: _Piece, contour: Contour, noun: str, sign: float) -> None:
    """Raise DrawingError where the face does not reach a piece, or the cam would have to turn back."""
    fractions = np.linspace(0.0, 1.0, piece.samples)
    angle = piece.angle(fractions)
    unreachable = np.isnan(angle)
    if unreachable.any():
        z = complex(piece.place(fractions)[np.flatnonzero(unreachable)[0]])
        raise DrawingError(
            f"{contour.name}: the {noun} cannot reach the curve: its reference would have to come to {at_text(z)} from "
            "the cam centre; change the follower's lengths"
        )
    unwrapped = np.unwrap(angle)
    is_backward = np.diff(unwrapped) >= ROUND_OFF
    if is_backward.any():
        first, last = np.flatnonzero(is_backward)[[0, -1]]
        ends = sorted(math.degrees(sign * unwrapped[i]) % 360.0 for i in (first, last + 1))
        raise DrawingError(
            f"{contour.name}: the {noun} cannot follow the curve about cam angle {angle_list([(ends[0], ends[1])])}: the pressure "
            "angle passes 90 deg; choose another follower or centre"
        )
