"""The table of motion laws: s(u) rising from 0 to 1 while u goes from 0 to 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import pi
from types import MappingProxyType

import numpy as np

from core.laws.pieces import Acceleration, Piece, PieceTable, Sine, integrate


@dataclass(frozen=True)
class Law:
    """One row.

    slug     spelling in files; label, as shown
    pieces   s(u) as pieces; ``still`` marks the law that does not move
    source   where the formula stands
    """

    slug: str
    label: str
    pieces: tuple[Piece, ...]
    source: str
    still: bool = False

    @cached_property
    def _table(self) -> PieceTable:
        return PieceTable(self.pieces)

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """s, s', s'', s''' by u at ``u`` (n,) in 0...1: shape (4, n); at a join inside the law the right-hand limit."""
        u = np.atleast_1d(np.asarray(u, dtype=float))
        starts = np.array([p.start for p in self.pieces])
        index = np.clip(np.searchsorted(starts, u, side="right") - 1, 0, None)
        return self._table.evaluate(index, u - starts[index])


def _one(*polynomial: float, sines: tuple[Sine, ...] = ()) -> tuple[Piece, ...]:
    return (Piece(0.0, polynomial, sines),)


def scca(b: float, c: float, d: float) -> tuple[Piece, ...]:
    """Sine - constant - cosine acceleration (Norton, Cam Design and Manufacturing Handbook, ch. 3).

    Widths b, c, d of the ramps, the constant and the cosine part; what 1 - b - c - d leaves in the middle runs at
    constant velocity. b/2 sine ramp, c/2 constant, d/2 cosine, constant velocity, and the same mirrored.
    """
    ramp, fall = pi / b if b else 1.0, pi / d if d else 1.0
    return integrate(
        [
            Acceleration(b / 2, amplitude=1.0, frequency=ramp),
            Acceleration(c / 2, level=1.0),
            Acceleration(d / 2, amplitude=1.0, frequency=fall, phase=pi / 2),
            Acceleration(1.0 - b - c - d),
            Acceleration(d / 2, amplitude=-1.0, frequency=fall),
            Acceleration(c / 2, level=-1.0),
            Acceleration(b / 2, amplitude=-1.0, frequency=ramp, phase=pi / 2),
        ]
    )


_K = 1.0 / (4.0 + pi)  # of the modified sine

MODIFIED_SINE = (
    Piece(0.0, (0.0, pi * _K), (Sine(-_K / 4, 4 * pi),)),
    # written from u = 1/8, where 4 pi u / 3 + pi / 3 is pi / 2
    Piece(0.125, ((2 + pi / 8) * _K, pi * _K), (Sine(-2.25 * _K, 4 * pi / 3, pi / 2),)),
    Piece(0.875, ((4 + 7 * pi / 8) * _K, pi * _K), (Sine(_K / 4, 4 * pi, pi / 2),)),
)

_ROWS = (
    Law("dwell", "Dwell", _one(0.0), "s = 0", still=True),
    Law("constant-velocity", "Constant velocity", _one(0.0, 1.0), "Yang, CV1: s = u"),
    Law(
        "simple-harmonic",
        "Simple harmonic",
        _one(0.5, sines=(Sine(-0.5, pi, pi / 2),)),
        "Yang, H5: s = (1 - cos pi u)/2",
    ),
    Law(
        "cycloidal",
        "Cycloidal",
        _one(0.0, 1.0, sines=(Sine(-0.5 / pi, 2 * pi),)),
        "Yang, C5: s = u - sin(2 pi u)/(2 pi)",
    ),
    Law("modified-sine", "Modified sine", MODIFIED_SINE, "Neklutin; Norton ch. 3: k = 1/(4 + pi)"),
    Law(
        "modified-trapezoid", "Modified trapezoid", scca(0.25, 0.5, 0.25), "Neklutin; Norton ch. 3: SCCA 1/4, 1/2, 1/4"
    ),
    Law("3-4-5", "Polynomial 3-4-5", _one(0.0, 0.0, 0.0, 10.0, -15.0, 6.0), "s = 10u^3 - 15u^4 + 6u^5"),
    Law(
        "4-5-6-7",
        "Polynomial 4-5-6-7",
        _one(0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0),
        "s = 35u^4 - 84u^5 + 70u^6 - 20u^7",
    ),
)

LAWS: Mapping[str, Law] = MappingProxyType({row.slug: row for row in _ROWS})
ALIASES: Mapping[str, str] = MappingProxyType(
    {"harmonic": "simple-harmonic", "polynomial-3-4-5": "3-4-5", "polynomial-4-5-6-7": "4-5-6-7"}
)


def find_law(name: str) -> Law | None:
    """The law of that slug or alias, None where there is none."""
    return LAWS.get(ALIASES.get(name, name))
