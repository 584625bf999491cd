"""A follower rolled round a closed curve: which line or arc it is on at which cam angles, and where it stands there, in closed
form."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from core.contour.drawing import BREAK, JOIN_MM, Contour, DrawingError, at_text
from core.contour.elements import ContourElement, arc, area, distances, meetings, near_pairs
from core.design import Design
from core.errors import angle_list
from core.followers.touching import Touching, touching
from core.frozen import frozen
from core.numerics.derivatives import Taylor

# -- the path of a roller's centre round a closed curve of lines and arcs ---------------------------------------


INSIDE = 1e-7  # relative: how much nearer than the radius a centre may come
SHORT = 1e-7  # relative: a shorter piece is none


@frozen(eq=False)
class PathCorner:
    """Where an element of the path ends and the next one begins: the corner's turn [rad], positive where it is convex; 0
    where the tangent goes on."""

    place: complex
    turn: float


@frozen(eq=False)
class OffsetPath:
    """A closed chain counter-clockwise; joints[i] lies before elements[i]."""

    elements: tuple[ContourElement, ...]
    joints: tuple[PathCorner, ...]


def path_beside(elements: Sequence[ContourElement], radius: float, smooth: float = BREAK) -> OffsetPath:
    """The outer path at a distance [mm]; 0: the curve itself; smooth: as a contour has it. Raises DrawingError where nothing is left."""
    if radius == 0.0:
        return _joined(list(elements), smooth)
    raw = _raw(elements, radius, smooth)
    cuts = _cuts(raw)
    bridged = any(each is None for each, _ in raw) or any(cuts)
    pieces = [each for each, _ in raw if each is not None]
    return _joined(_outer(elements, radius, pieces, cuts) if bridged else pieces, smooth)


def turn_between(a: ContourElement, b: ContourElement, smooth: float) -> float:
    """The turn of the tangent from the end of one to the start of the next [rad]; 0 where it counts as going on."""
    turn = _bend(a, b)
    return turn if abs(turn) > smooth else 0.0


def _bend(a: ContourElement, b: ContourElement) -> float:
    """The same, however small."""
    return cmath.phase(complex(b.tangent(0.0)) / complex(a.tangent(1.0)))


def _raw(elements: Sequence[ContourElement], radius: float, smooth: float) -> list[tuple[ContourElement | None, float]]:
    """The elements beside the curve, with arcs about its convex corners; None of an arc that is hollower than the radius. With
    each, how far from its end it may cross the next one and still goes on into it [mm]; -1 where it does not.

    In a hollow corner they cross so far from their ends as the roller's radius times half the turn; where the roller would stand off
    the corner by no more than may be, they go on.
    """
    size = max(abs(each.start) for each in elements)
    made: list[tuple[ContourElement | None, float]] = []
    for a, b in zip(elements, [*elements[1:], elements[0]], strict=True):
        turn, bend = (0.0, 0.0) if len(elements) == 1 else (turn_between(a, b, smooth), _bend(a, b))
        beside = a.beside(radius)
        goes_on = beside is not None and (turn >= 0.0 or 0.125 * radius * turn * turn <= INSIDE * size)
        made.append((beside, 1e-5 * size + radius * abs(bend) if goes_on else -1.0))
        if turn > 0.0:
            made.append((arc(a.end, radius, cmath.phase(complex(a.normal(1.0))), turn), 1e-5 * size))
    return made


def _cuts(raw: Sequence[tuple[ContourElement | None, float]]) -> list[list[complex]]:
    """Where the elements that are left cross each other, for each of them."""
    kept = [(i, each) for i, (each, _) in enumerate(raw) if each is not None]
    cuts: list[list[complex]] = [[] for _ in kept]
    for i, j in near_pairs([each for _, each in kept]):
        (p, a), (q, b) = kept[i], kept[j]
        shared = []
        if q == p + 1:
            shared.append((a.end, raw[p][1]))
        if p == 0 and q == len(raw) - 1:
            shared.append((a.start, raw[q][1]))
        for z in meetings(a, b):
            if all(abs(z - end) > room for end, room in shared):
                cuts[i].append(z)
                cuts[j].append(z)
    return cuts


def _outer(
    curve: Sequence[ContourElement], radius: float, pieces: Sequence[ContourElement], cuts: Sequence[Sequence[complex]]
) -> list[ContourElement]:
    """The pieces between crossings where the roller does not enter the curve, in a chain: the outermost one."""
    size = max(abs(each.start) for each in curve)
    kept = []
    for each, places in zip(pieces, cuts, strict=True):
        parts = sorted((each.part_of(z), z) for z in places)
        stops = [(0.0, each.start), *((t, z) for t, z in parts if 0.0 < t < 1.0), (1.0, each.end)]
        for (low, start), (high, end) in pairwise(stops):
            if (high - low) * each.length <= SHORT * size:
                continue
            piece = each.piece(low, high)
            if float(distances(curve, complex(piece.at(0.5))).min()) >= radius - INSIDE * size:
                kept.append(piece.with_ends(start, end))
    chains = _chained(kept, 10.0 * SHORT * size)
    if not chains:
        raise DrawingError(f"a roller of radius {radius:g} mm finds no way round the curve; take a smaller one")
    return max(chains, key=area)


def _chained(pieces: Sequence[ContourElement], room: float) -> list[list[ContourElement]]:
    """Closed chains of pieces, each beginning where another ends."""
    left, chains = list(pieces), []
    while left:
        chain = [left.pop(0)]
        while abs(chain[-1].end - chain[0].start) > room or len(chain) == 1:
            if len(chain) == 1 and abs(chain[0].end - chain[0].start) <= room and chain[0].length > 2.0 * room:
                break
            after = next((i for i, each in enumerate(left) if abs(each.start - chain[-1].end) <= room), None)
            if after is None:
                chain = []
                break
            chain.append(left.pop(after))
        if chain:
            chains.append(chain)
    return chains


def _joined(elements: list[ContourElement], smooth: float) -> OffsetPath:
    if len(elements) == 1:
        return OffsetPath(tuple(elements), (PathCorner(elements[0].start, 0.0),))
    before = [elements[-1], *elements[:-1]]
    joints = [
        PathCorner(0.5 * (a.end + b.start), turn_between(a, b, smooth)) for a, b in zip(before, elements, strict=True)
    ]
    return OffsetPath(tuple(elements), tuple(joints))


def hollow(elements: Sequence[ContourElement], smooth: float = BREAK) -> complex | None:
    """Where a curve is hollow: the middle of its longest hollow arc, or a hollow corner; None where it is convex."""
    arcs = [each for each in elements if each.sweep < 0.0]
    if arcs:
        return complex(max(arcs, key=lambda each: each.length).at(0.5))
    pairs = zip(elements, [*elements[1:], elements[0]], strict=True) if len(elements) > 1 else ()
    corners = [(turn_between(a, b, smooth), a.end) for a, b in pairs]
    worst = min(corners, key=lambda corner: corner[0], default=(0.0, 0j))
    return worst[1] if worst[0] < 0.0 else None


def nearest(elements: Sequence[ContourElement], z: complex = 0j) -> float:
    """Least distance of a point from a curve [mm]."""
    return float(np.min(distances(elements, z)))


# -- A follower rolled round a closed curve ---------------------------------------------------------------------


TURN = 2.0 * math.pi
SAMPLES = 24  # of each line or arc, and so many more for each turn, at which it is seen to be followed
ROUND_OFF = 1e-12  # [rad]: an angle may go back by so much


@frozen(eq=False)
class RolledPart:
    """A stretch of the turn on one line or arc.

    low, high  cam angles [rad], low < high; the whole turn where it is a circle
    driver     cam angles (n,) [rad] -> the driver's position, in mm or radians, with two derivatives
    breaks     the tangent of the face's path breaks where it begins, so that the velocity jumps there
    corner     the face turns about a corner of the curve
    place      where it begins, as drawn at cam angle 0 [mm]: of a round's centre, of a flat face the middle of where it lies on
    """

    low: float
    high: float
    driver: Callable[[np.ndarray], Taylor]
    breaks: bool
    corner: bool = False
    place: complex = 0j


@frozen(eq=False)
class Rolled:
    """parts in the order of the cam angle, over one turn; reach [mm]: the face's reference at its nearest to the cam centre;
    path: of a round's centre, or the curve itself, as drawn at cam angle 0."""

    parts: tuple[RolledPart, ...]
    reach: float
    path: tuple[ContourElement, ...]


@frozen(eq=False)
class _Piece:
    """A line or arc that the face follows, counter-clockwise round the cam: angle: parts (n,) of it -> how far the cam is turned;
    driver: as in ``RolledPart``; breaks: where it begins; begin: where that is, as ``angle`` has it."""

    angle: Callable[[np.ndarray], np.ndarray]
    place: Callable[[np.ndarray], np.ndarray]
    driver: Callable[[np.ndarray], Taylor]
    breaks: bool
    begin: float
    samples: int
    start: complex
    corner: bool = False


def roll(contour: Contour, design: Design) -> Rolled:
    """The follower of a design on a curve. Raises DrawingError where it cannot follow it, and where a flat face meets a hollow;
    DesignError where the design has no follower on a cam."""
    follower: Any = design.drive.mechanism
    face, sense = design.drive.face, design.sense
    row = touching(follower)
    if face.straight:
        pieces, reach = list(_flat_pieces(contour, row, sense)), _least_support(contour)
        path = contour.elements
    else:
        beside = path_beside(contour.elements, face.radius_mm, contour.smooth)
        path, reach = beside.elements, nearest(beside.elements)
        pieces = [
            _round_piece(each, joint.place, joint.turn != 0.0, row, sense, face.radius_mm)
            for each, joint in zip(beside.elements, beside.joints, strict=True)
        ]
    return Rolled(tuple(_ordered(pieces, contour, face.noun, sense)), reach, tuple(path))


def _round_piece(
    each: ContourElement, begin: complex, breaks: bool, row: Touching, sense: float, radius: float
) -> _Piece:
    middle, normal, curvature = complex(each.at(0.5)), complex(each.normal(0.5)), each.curvature

    def driver(theta: np.ndarray) -> Taylor:
        turn = Taylor.turning(theta, sense)
        return row.position(turn * middle, turn * normal, curvature)

    def angle(part: np.ndarray) -> np.ndarray:
        return row.angle(each.at(part))

    corner = each.sweep > 0.0 and abs(each.radius - radius) <= 1e-9 * radius

    return _Piece(
        angle, each.at, driver, breaks, float(row.angle(np.array([begin]))[0]), _samples(each.sweep), begin, corner
    )


def _samples(sweep: float) -> int:
    return SAMPLES + math.ceil(SAMPLES * abs(sweep))


# -- a flat face ------------------------------------------------------------------------------------------


@frozen
class _Support:
    """An arc, or a corner of radius 0, that a flat face turns about: from a unit normal over an angle [rad]."""

    centre: complex
    radius: float
    normal: complex
    sweep: float

    def normals(self, part: np.ndarray) -> np.ndarray:
        return np.asarray(self.normal * np.exp(1j * self.sweep * np.asarray(part)))

    def contact(self, part: np.ndarray) -> np.ndarray:
        return self.centre + self.radius * self.normals(part)


def _supports(contour: Contour) -> list[_Support]:
    """What a flat face turns about, in order round a convex curve."""
    made, elements = [], contour.elements
    for a, b in zip(elements, [*elements[1:], elements[0]], strict=True):
        if not a.is_line:
            made.append(_Support(a.centre, a.radius, complex(a.normal(0.0)), a.sweep))
        turn = 0.0 if len(elements) == 1 else turn_between(a, b, contour.smooth)
        if turn > 0.0:
            made.append(_Support(a.end, 0.0, complex(a.normal(1.0)), turn))
    return made


def _flat_pieces(contour: Contour, row: Touching, sense: float) -> Iterator[_Piece]:
    where = hollow(contour.elements, contour.smooth)
    if where is not None:
        raise DrawingError(
            f"{contour.name}: the curve is hollow at {at_text(where)} from the cam centre, where a flat face "
            "does not reach it; choose a roller, or a convex curve"
        )
    supports = _supports(contour)
    for before, each in zip([supports[-1], *supports[:-1]], supports, strict=True):
        n = 0.5 * (complex(before.normals(np.array(1.0))) + each.normal)
        last, first = complex(before.contact(np.array(1.0))), complex(each.contact(np.array(0.0)))
        breaks = abs(first - last) > JOIN_MM
        begin = float(row.angle(np.array([0.5 * (first + last)]), np.array([n / abs(n)]))[0])
        yield _support_piece(each, breaks, begin, 0.5 * (first + last), row, sense)


def _support_piece(each: _Support, breaks: bool, begin: float, start: complex, row: Touching, sense: float) -> _Piece:
    return _Piece(
        lambda part: row.angle(each.contact(part), each.normals(part)),
        each.contact,
        lambda theta: row.position(Taylor.turning(theta, sense) * each.centre, each.radius),
        breaks,
        begin,
        _samples(each.sweep),
        start,
        each.radius == 0.0,
    )


def _least_support(contour: Contour) -> float:
    """Least distance of a flat face from the cam centre [mm]: on a line it lies on both ends, on an arc it is ρ + c·n."""
    chords = [each for each in contour.elements if each.is_line]
    least = [((each.start * complex(each.normal(0.0)).conjugate()).real) for each in chords]
    for support in _supports(contour):
        c = support.centre
        ends = [support.normal, complex(support.normals(np.array(1.0)))]
        if abs(c) > 0.0:
            turn = cmath.phase(-c / support.normal) % TURN
            if turn < support.sweep:
                ends.append(-c / abs(c))
        least += [support.radius + (c * n.conjugate()).real for n in ends]
    return min(least)


# -- in the order of the cam angle ------------------------------------------------------------------------


def _ordered(pieces: list[_Piece], contour: Contour, noun: str, sense: float) -> list[RolledPart]:
    """The pieces by cam angle θ, sense θ being how far the cam is turned: it goes back along the curve."""
    for each in pieces:
        _require_followed(each, contour, noun, sense)
    if len(pieces) == 1:
        return [RolledPart(0.0, TURN, pieces[0].driver, False)]
    ends = [*pieces[1:], pieces[0]]
    rows = [(a, b) for a, b in zip(pieces, ends, strict=True)]
    if sense > 0.0:  # the piece is left where it begins
        rows = [(piece, after) for piece, after in reversed(rows)]
    parts, at = [], None
    for piece, after in rows:
        low, high = (after.begin, piece.begin) if sense > 0.0 else (piece.begin, after.begin)
        first = after if sense > 0.0 else piece  # where it begins by cam angle
        start = sense * low if at is None else at
        span = (sense * (high - low)) % TURN
        if span > TURN - 1e-9:  # of no length
            span = 0.0
        parts.append(RolledPart(start, start + span, piece.driver, first.breaks, piece.corner, first.start))
        at = start + span
    total = parts[-1].high - parts[0].low
    if abs(total - TURN) > 1e-6:
        raise DrawingError(
            f"{contour.name}: the {noun} goes {total / TURN:.4g} times round the curve in one turn; it must be once"
        )
    return parts


def _require_followed(piece: _Piece, contour: Contour, noun: str, sense: float) -> None:
    """Raises DrawingError where the face does not reach a piece, or the cam would have to turn back."""
    part = np.linspace(0.0, 1.0, piece.samples)
    angle = piece.angle(part)
    lost = np.isnan(angle)
    if lost.any():
        z = complex(piece.place(part)[np.flatnonzero(lost)[0]])
        raise DrawingError(
            f"{contour.name}: the {noun} cannot reach the curve: its reference would have to come to {at_text(z)} from "
            "the cam centre; change the follower's lengths"
        )
    along = np.unwrap(angle)
    back = np.diff(along) >= ROUND_OFF
    if back.any():
        first, last = np.flatnonzero(back)[[0, -1]]
        ends = sorted(math.degrees(sense * along[i]) % 360.0 for i in (first, last + 1))
        raise DrawingError(
            f"{contour.name}: the {noun} cannot follow the curve about cam angle {angle_list([(ends[0], ends[1])])}: the pressure "
            "angle passes 90 deg; choose another follower or centre"
        )
