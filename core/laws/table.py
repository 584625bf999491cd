"""The table of motion laws: s(u) rising from 0 to 1 while u goes from 0 to 1."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from math import pi
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.laws.pieces import Acceleration, Piece, PieceTable, Sine, integrate, moved
from core.numerics.derivatives import Derivatives


@frozen
class Law:
    """One row.

    slug     spelling in files; label, as shown
    pieces   s(u) as pieces; ``is_dwell`` marks the law that does not move
    source   where the formula stands
    flat     the same curve with a stretch of constant acceleration in its middle over a fraction of the span, where there is one
    rises    1 where the curve is meant for a rise, -1 where it is a return and needs a rise below 0, 0 for both
    """

    slug: str
    label: str
    pieces: tuple[Piece, ...]
    source: str
    is_dwell: bool = False
    rises: int = 0
    flat: Callable[[float], tuple[Piece, ...]] | None = None

    @cached_property
    def _table(self) -> PieceTable:
        return PieceTable(self.pieces)

    def at(self, u: np.ndarray) -> Derivatives:
        """s, s', s'', s''' by u at ``u`` (n,) in 0...1, each made when it is read; at a join inside the law the right-hand
        limit."""
        return self._table.at(np.atleast_1d(np.asarray(u, dtype=float)))

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """All four (4, n)."""
        return self.at(u).all

    @cached_property
    def symmetric(self) -> bool:
        """Whether s(u) + s(1-u) = 1, so that its two halves may be stretched: an asymmetric law is made of such."""
        u = np.linspace(0.0, 1.0, 9)
        return not self.is_dwell and bool(np.abs(self(u)[0] + self(1.0 - u)[0] - 1.0).max() < 1e-12)


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


_P1 = (0, 0, 0, 250, 0, -852, 1096, -558, 105)  # over 41; the literature's decimals are these fractions rounded
C1 = _one(0.0, 1.0, sines=(Sine(-1.0 / pi, pi),))
C2 = _one(0.0, 1.0, sines=(Sine(1.0 / pi, pi),))
CYCLOIDAL = _one(0.0, 1.0, sines=(Sine(-0.5 / pi, 2 * pi),))
H1 = _one(1.0, sines=(Sine(-1.0, pi / 2, pi / 2),))
H2 = _one(0.0, sines=(Sine(1.0, pi / 2),))
HARMONIC = _one(0.5, sines=(Sine(-0.5, pi, pi / 2),))
P1 = _one(*(c / 41 for c in _P1))
P2 = _one(
    *(((41 if j == 0 else 0) - (-1) ** j * c) / 41 for j, c in enumerate(moved(_P1, 1)))
)  # 1 - P1(1-u), exact in integers
LINE = _one(0.0, 1.0)


def speeding(flat: float) -> tuple[Piece, ...]:
    """Half a cycloid from rest to the velocity 2 whose acceleration stays constant over a fraction of the span, in its middle:
    quarter sine, constant, quarter cosine (the accelerating half of a modified trapezoid). Fraction 0 is C1, 1 a parabola.
    Its acceleration is symmetric, so that the velocity at its end is 2 for every fraction; its peak is
    2 / (flat + (1 - flat) 2/pi)."""
    ramp = 0.5 * (1.0 - flat)
    frequency = 0.5 * pi / ramp if ramp else 1.0
    return integrate(
        [
            Acceleration(ramp, amplitude=1.0, frequency=frequency),
            Acceleration(flat, level=1.0),
            Acceleration(ramp, amplitude=1.0, frequency=frequency, phase=pi / 2),
        ]
    )


def slowing(flat: float) -> tuple[Piece, ...]:
    """The same from the velocity 2 to rest: 2u - ``speeding``, which is ``speeding`` run backwards."""
    made = []
    for piece in speeding(flat):
        c = (*piece.polynomial, 0.0, 0.0)
        sines = tuple(Sine(-wave.amplitude, wave.frequency, wave.phase) for wave in piece.sines)
        made.append(Piece(piece.start, (2.0 * piece.start - c[0], 2.0 - c[1], -c[2]), sines))
    return tuple(made)


def _sines(*terms: tuple[float, float]) -> tuple[Piece, ...]:
    """u + sum A_k sin(2 pi k u)."""
    return _one(0.0, 1.0, sines=tuple(Sine(a, 2 * pi * k) for k, a in terms))


def modified_sine_with_cv(fraction: float) -> tuple[Piece, ...]:
    """Modified sine whose middle runs at constant velocity over this fraction of the span."""
    return scca(0.25 * (1 - fraction), 0.0, 0.75 * (1 - fraction))


_ROWS = (
    Law("dwell", "Dwell", _one(0.0), "s = 0", is_dwell=True),
    Law("constant-velocity", "Constant velocity", LINE, "s = u"),
    Law(
        "parabolic",
        "Parabolic",
        (Piece(0.0, (0.0, 0.0, 2.0)), Piece(0.5, (0.5, 2.0, -2.0))),
        "constant acceleration: s = 2u^2, 1 - 2(1-u)^2",
    ),
    Law("simple-harmonic", "Simple harmonic", HARMONIC, "s = (1 - cos pi u)/2"),
    Law(
        "double-harmonic",
        "Double harmonic",
        _one(0.375, sines=(Sine(-0.5, pi, pi / 2), Sine(0.125, 2 * pi, pi / 2))),
        "s = (1 - cos pi u)/2 - (1 - cos 2 pi u)/8",
    ),
    Law("cycloidal", "Cycloidal", CYCLOIDAL, "s = u - sin(2 pi u)/(2 pi)"),
    Law("modified-sine", "Modified sine", MODIFIED_SINE, "Neklutin; Norton ch. 3: k = 1/(4 + pi)"),
    Law(
        "modified-trapezoid", "Modified trapezoid", scca(0.25, 0.5, 0.25), "Neklutin; Norton ch. 3: SCCA 1/4, 1/2, 1/4"
    ),
    Law("mcv20", "Modified constant velocity 20 %", modified_sine_with_cv(0.2), "SCCA; Norton ch. 3"),
    Law("mcv33", "Modified constant velocity 33 %", modified_sine_with_cv(1 / 3), "SCCA; exactly 1/3"),
    Law("mcv50", "Modified constant velocity 50 %", modified_sine_with_cv(0.5), "SCCA; Norton ch. 3"),
    Law("mcv66", "Modified constant velocity 66 %", modified_sine_with_cv(2 / 3), "SCCA; exactly 2/3"),
    Law("2-3", "Polynomial 2-3", _one(0.0, 0.0, 3.0, -2.0), "s = 3u^2 - 2u^3"),
    Law("3-4-5", "Polynomial 3-4-5", _one(0.0, 0.0, 0.0, 10.0, -15.0, 6.0), "s = 10u^3 - 15u^4 + 6u^5"),
    Law(
        "4-5-6-7",
        "Polynomial 4-5-6-7",
        _one(0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0),
        "s = 35u^4 - 84u^5 + 70u^6 - 20u^7",
    ),
    Law(
        "5-6-7-8-9",
        "Polynomial 5-6-7-8-9",
        _one(0.0, 0.0, 0.0, 0.0, 0.0, 126.0, -420.0, 540.0, -315.0, 70.0),
        "s = 126u^5 - 420u^6 + 540u^7 - 315u^8 + 70u^9",
    ),
    Law(
        "freudenstein-1-3",
        "Freudenstein 1-3",
        _sines((1, -27 / (56 * pi)), (3, -1 / (168 * pi))),
        "Freudenstein 1960: s = u - (27/28)[sin 2 pi u + sin(6 pi u)/81]/(2 pi)",
    ),
    Law(
        "freudenstein-1-3-5",
        "Freudenstein 1-3-5",
        _sines(*((k, -1125 / (1192 * 2 * pi) * a) for k, a in ((1, 1.0), (3, 1 / 54), (5, 1 / 1250)))),
        "Freudenstein 1960: s = u - (1125/1192)[sin 2 pi u + sin(6 pi u)/54 + sin(10 pi u)/1250]/(2 pi)",
    ),
    Law(
        "gutman-1-3",
        "Gutman 1-3",
        _sines((1, -15 / (32 * pi)), (3, -1 / (96 * pi))),
        "Gutman 1961: s = u - 15 sin(2 pi u)/(32 pi) - sin(6 pi u)/(96 pi)",
    ),
    Law("c1", "C1 half cycloid", C1, "Yang Table 1: s = u - sin(pi u)/pi", rises=1, flat=speeding),
    Law("c2", "C2 half cycloid", C2, "Yang Table 1: s = u + sin(pi u)/pi", rises=1, flat=slowing),
    Law("c3", "C3 half cycloid, return", C1, "Yang Table 1: 1 - C1", rises=-1, flat=speeding),
    Law("c4", "C4 half cycloid, return", C2, "Yang Table 1: 1 - C2", rises=-1, flat=slowing),
    Law("c5", "C5 cycloid", CYCLOIDAL, "Yang Table 1: s = u - sin(2 pi u)/(2 pi)", rises=1),
    Law("c6", "C6 cycloid, return", CYCLOIDAL, "Yang Table 1: 1 - C5", rises=-1),
    Law("h1", "H1 half harmonic", H1, "Yang Table 1: s = 1 - cos(pi u/2)", rises=1),
    Law("h2", "H2 half harmonic", H2, "Yang Table 1: s = sin(pi u/2)", rises=1),
    Law("h3", "H3 half harmonic, return", H1, "Yang Table 1: 1 - H1", rises=-1),
    Law("h4", "H4 half harmonic, return", H2, "Yang Table 1: 1 - H2", rises=-1),
    Law("h5", "H5 harmonic", HARMONIC, "Yang Table 1: s = (1 - cos pi u)/2", rises=1),
    Law("h6", "H6 harmonic, return", HARMONIC, "Yang Table 1: 1 - H5", rises=-1),
    Law("p1", "P1 eighth degree", P1, "Yang; (250u^3 - 852u^5 + 1096u^6 - 558u^7 + 105u^8)/41", rises=1),
    Law("p2", "P2 eighth degree, return", P2, "Yang: P2(u) = P1(1-u)", rises=-1),
    Law("cv1", "CV1 constant velocity", LINE, "Yang Table 1: s = u", rises=1),
    Law("cv2", "CV2 constant velocity, return", LINE, "Yang Table 1: 1 - CV1", rises=-1),
)

LAWS: Mapping[str, Law] = MappingProxyType({row.slug: row for row in _ROWS})
ALIASES: Mapping[str, str] = MappingProxyType(
    {"harmonic": "simple-harmonic", "polynomial-3-4-5": "3-4-5", "polynomial-4-5-6-7": "4-5-6-7"}
)


SHORT: Mapping[str, str] = MappingProxyType(
    {
        "dwell": "D", "constant-velocity": "CV", "parabolic": "CA", "simple-harmonic": "SH", "double-harmonic": "DH",
        "cycloidal": "CYC", "modified-sine": "MS", "modified-trapezoid": "MT", "mcv20": "MCV20", "mcv33": "MCV33",
        "mcv50": "MCV50", "mcv66": "MCV66", "2-3": "23", "3-4-5": "345", "4-5-6-7": "4567",
        "5-6-7-8-9": "56789", "freudenstein-1-3": "F1-3", "freudenstein-1-3-5": "F1-5", "gutman-1-3": "G1-3",
        "scca": "SCCA", "polynomial": "P", "spline": "SP", "table": "TAB",
    }
)  # fmt: skip
"""Slug -> the handbooks' abbreviation, for where there is little room; Yang's curves go by their slugs."""


def short_name(slug: str) -> str:
    """The shortest name of a law or of a curve with keys of its own."""
    return SHORT.get(ALIASES.get(slug, slug), slug.upper())


def find_law(name: str) -> Law | None:
    """The law of that slug or alias, None where there is none."""
    return LAWS.get(ALIASES.get(name, name))
