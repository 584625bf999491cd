"""The path of a roller's centre round a closed curve of lines and arcs: lines and arcs beside it, and arcs about its convex
corners; where the roller bridges a hollow, the two paths meet in a corner."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from core.contour.drawing import BREAK, DrawingError
from core.contour.elements import ContourElement, arc, area, distances, meetings, near_pairs
from core.frozen import frozen

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
