"""Each kind of dyad between two links that move in every way, and its fifty-digit values as power series of the angle."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from references import EPS, MP, Series, crossing, direction, exp, off, sqrt

from core.mechanism.dyads import DYADS
from core.mechanism.kinematics import Pose
from core.mechanism.linkage import Joint, JointEnd

STEP = MP.mpf(10) ** -25
DYAD_ROUNDINGS = 4
"""Of each number that goes in: on the way itself, its sine or product, and the sum and quotient it takes part in."""
PLACES = {
    2: (0.13 - 0.05j, 0.021 + 0.034j, -0.017 + 0.041j, 0.012 - 0.023j),
    3: (0.41 + 0.22j, -0.033 + 0.012j, 0.029 + 0.018j, 0.01j),
}
TURNS = {2: (0.7, 0.9, -0.4, 0.6), 3: (-1.1, -0.6, 0.5, -0.3)}
NUMBERS = tuple(v for k in (2, 3) for v in (*PLACES[k], *TURNS[k]))
"""z and angle of the known links 2 and 3 with three derivatives, one after the other."""

Link = tuple[Series, Series]
"""Place of a link's origin, and e^{iθ}, as series."""
Pin = tuple[complex, complex]
"""A point of a link in its own frame, and the line through it."""


def _links(numbers: Sequence[Any]) -> dict[int, Link]:
    found = {}
    for link, at in ((2, 0), (3, 8)):
        z, angle = (Series([v / MP.factorial(k) for k, v in enumerate(numbers[i : i + 4])]) for i in (at, at + 4))
        found[link] = z, exp(angle * Series([MP.mpc(0, 1), 0, 0, 0]))
    return found


def _on(link: Link, point: Any) -> Series:
    return link[0] + link[1] * Series([point, 0, 0, 0])


def _times(value: Any) -> Series:
    return Series([value, 0, 0, 0])


def _rrr(at: dict[int, Link], p: Sequence[Pin], side: int) -> tuple[Series, ...]:
    a, b = _on(at[2], p[0][0]), _on(at[3], p[4][0])
    rod_a, rod_b = p[2][0] - p[1][0], p[3][0] - p[5][0]
    d = b - a
    square = (d * d.conjugate()).real
    along = (square + (abs(rod_a) ** 2 - abs(rod_b) ** 2)) / (2 * square)
    across = sqrt(abs(rod_a) ** 2 / square - along * along)
    joint = a + d * (along + across * _times(MP.mpc(0, side)))
    return (joint - a) * _times(1 / rod_a), (joint - b) * _times(1 / rod_b), joint


def _rrp(at: dict[int, Link], p: Sequence[Pin], side: int) -> tuple[Series, ...]:
    pin, t = _on(at[2], p[0][0]), at[3][1] * _times(p[4][1])
    rod = p[2][0] - p[1][0]
    beside = ((p[3][0] - p[5][0]) / p[5][1]).imag
    rail = _on(at[3], p[4][0]) + t * _times(MP.mpc(0, beside))
    local = (pin - rail) * t.conjugate()
    joint = rail + t * (local.real + sqrt(abs(rod) ** 2 - local.imag * local.imag) * side)
    return (joint - pin) * _times(1 / rod), t * _times(1 / p[5][1]), joint


def _rpr(at: dict[int, Link], p: Sequence[Pin], side: int) -> tuple[Series, ...]:
    a, b = _on(at[2], p[0][0]), _on(at[3], p[4][0])
    offset = ((p[1][0] - p[2][0]) / p[2][1]).imag - ((p[5][0] - p[3][0]) / p[3][1]).imag
    d = a - b
    slide = sqrt((d * d.conjugate()).real - offset**2) * side
    t = d / (slide + _times(MP.mpc(0, offset)))
    heading_a = t * _times(1 / p[2][1])
    return heading_a, t * _times(1 / p[3][1]), a - heading_a * _times(p[1][0] - p[2][0])


def _prp(at: dict[int, Link], p: Sequence[Pin], side: int) -> tuple[Series, ...]:
    lines = []
    for link, known, own, held in ((2, p[0], p[1], p[2]), (3, p[4], p[5], p[3])):
        t = at[link][1] * _times(known[1])
        beside = ((held[0] - own[0]) / own[1]).imag
        lines.append((_on(at[link], known[0]) + t * _times(MP.mpc(0, beside)), t, t * _times(1 / own[1])))
    (g1, t1, one), (g2, t2, other) = lines
    joint = g1 + t1 * (crossing(g2 - g1, t2) / crossing(t1, t2))
    return one, other, joint


def _rpp(at: dict[int, Link], p: Sequence[Pin], side: int) -> tuple[Series, ...]:
    pin, t2 = _on(at[2], p[0][0]), at[3][1] * _times(p[4][1])
    heading_b = t2 * _times(1 / p[5][1])
    t1 = heading_b * _times(p[3][1])
    heading_a = t1 * _times(1 / p[2][1])
    g = _on(at[3], p[4][0])
    y = ((p[1][0] - p[2][0]) / p[2][1]).imag
    rest = pin - g - heading_b * _times(p[3][0] - p[5][0]) - t1 * _times(MP.mpc(0, y))
    own = g + t2 * (crossing(t1, rest) / crossing(t1, t2))  # where the second link has its point of the guide
    return heading_a, heading_b, own


@dataclass(frozen=True)
class DyadCase:
    """One dyad: its three pairs as six held points (known link's, link a's; a's, b's; ...), revolute or not; what solves it
    exactly: e^{iθ} of both links, and the joint that ``where`` names: of which link,
    and its held point."""

    kind: str
    pins: tuple[Pin, ...]
    revolute: tuple[bool, bool, bool]
    links: tuple[int, ...]
    exact: Callable[[dict[int, Link], Sequence[Pin], int], tuple[Series, ...]]
    where: tuple[int, int]
    side: int = 1
    numbers: tuple[complex, ...] = NUMBERS

    def joints(self) -> tuple[Joint, ...]:
        held = [JointEnd(link, *pin) for link, pin in zip(self.links, self.pins, strict=True)]
        return tuple(Joint(f"{i}", turns, *held[2 * i : 2 * i + 2]) for i, turns in enumerate(self.revolute))

    def solved(self) -> list[complex]:
        """Three derivatives of both angles, e^{iθ} of both, and the joint with three derivatives."""
        bodies = {}
        for link, i in ((2, 0), (3, 8)):
            z, angle = np.array(self.numbers[i : i + 4], dtype=complex), np.array(self.numbers[i + 4 : i + 8]).real
            bodies[link] = Pose.of(z[:, None], angle[:, None].copy())
        found = DYADS[self.kind](bodies, self.joints(), float(self.side)).poses
        which, held = self.where
        joint = found[which].fixed_point(self.pins[held][0]).all[:, 0]
        rates = [complex(pose.angle[k, 0]) for pose in found for k in (1, 2, 3)]
        headings = [complex(math.cos(pose.angle[0, 0]), math.sin(pose.angle[0, 0])) for pose in found]
        return [*rates, *headings, *map(complex, joint)]

    def exactly(self) -> list[Any]:
        """The same to fifty digits."""
        return self.figures(self.numbers, self._pins())

    def _pins(self) -> list[tuple[Any, Any]]:
        return [(MP.convert(point), MP.convert(along)) for point, along in self.pins]

    def figures(self, numbers: Sequence[Any], pins: Sequence[Pin]) -> list[Any]:
        """The same of exact numbers."""
        one, other, joint = self.exact(_links(numbers), pins, self.side)
        angles = [direction(one), direction(other)]
        return [
            *(a.derivative(k) for a in angles for k in (1, 2, 3)),
            *(MP.expj(a.c[0]) for a in angles),
            *joint.derivatives,
        ]

    def errors(self, roundings: int) -> list[tuple[float, float]]:
        """Of every figure its error, and so many times what one rounding of each number that goes in does to it."""
        pins, own = self._pins(), self.numbers
        exact = self.figures(own, pins)
        sizes = [abs(value) for value in exact]
        moved = [([*own[:i], MP.convert(v) * (1 + STEP), *own[i + 1 :]], pins) for i, v in enumerate(own) if v]
        moved += [(list(own), [*pins[:i], (p * (1 + STEP), t), *pins[i + 1 :]]) for i, (p, t) in enumerate(pins)]
        for numbers, places in moved:
            for i, value in enumerate(self.figures(numbers, places)):
                sizes[i] += abs(value - exact[i]) / STEP
        return [
            (off(got, right), roundings * EPS * float(size))
            for got, right, size in zip(self.solved(), exact, sizes, strict=True)
        ]


PIN = 1.0 + 0j
A, B = 4, 5
DYAD_CASES = {
    "rrr": DyadCase("RRR", ((0.02 + 0.01j, PIN), (0.01 - 0.02j, PIN), (0.31 + 0.04j, PIN), (0.24 - 0.03j, PIN), (0.02j, PIN),
                            (-0.01 + 0.03j, PIN)), (True, True, True), (2, A, A, B, 3, B), _rrr, (0, 2)),
    "rrp": DyadCase("RRP", ((0.02 + 0.01j, PIN), (0.01 - 0.02j, PIN), (0.45 + 0.04j, PIN), (0.05 + 0.03j, PIN), (0.04 - 0.03j, 1j),
                            (-0.01 + 0.03j, -1j)), (True, True, False), (2, A, A, B, 3, B), _rrp, (0, 2), -1),
    "rpr": DyadCase("RPR", ((0.02 + 0.01j, PIN), (0.01 - 0.02j, PIN), (0.05 + 0.04j, 1j), (0.06 - 0.03j, -1j), (0.02 + 0.01j, PIN),
                            (-0.01 + 0.03j, PIN)), (True, False, True), (2, A, A, B, 3, B), _rpr, (0, 2)),
    "prp": DyadCase("PRP", ((0.02 + 0.01j, 1j), (0.01 - 0.02j, PIN), (0.05 + 0.04j, PIN), (0.06 - 0.03j, PIN), (0.02 + 0.01j, 1j),
                            (-0.01 + 0.03j, -1j)), (False, True, False), (2, A, A, B, 3, B), _prp, (0, 2)),
    "rpp": DyadCase("RPP", ((0.02 + 0.01j, PIN), (0.01 - 0.02j, PIN), (0.05 + 0.04j, 1j), (0.06 - 0.03j, 1j), (0.02 + 0.01j, 1j),
                            (-0.01 + 0.03j, PIN)), (True, False, False), (2, A, A, B, 3, B), _rpp, (1, 5)),
}  # fmt: skip
