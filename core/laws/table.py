"""Table of motion laws s(u), which rise from 0 to 1 over u = 0 ... 1, and their peak coefficients.

Sources: R. L. Norton, *Cam Design and Manufacturing Handbook*; C. N. Neklutin; F. Freudenstein 1960; Yang, Table 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache
from itertools import pairwise
from math import pi
from types import MappingProxyType

import numpy as np

from core.frozen import frozen
from core.laws.pieces import Acceleration, Piece, PieceTable, Sine, integrate, shifted
from core.numerics.derivatives import Derivatives

# -- the table of motion laws -----------------------------------------------------------------------------------


STANDSTILL = "Standing still, constant velocity"
STANDARD = "Standard laws"
POLYNOMIALS = "Polynomials"
CONSTANT_VELOCITY = "With constant velocity in the middle"
SERIES = "Harmonic series"
BLENDING_RISE, BLENDING_RETURN = "Elementary curves for blending: rise", "Elementary curves for blending: return"
THROUGH_POINTS = "Through points"
MADE_TO_MEASURE = "Made to measure"
GROUPS = (
    STANDSTILL, STANDARD, POLYNOMIALS, CONSTANT_VELOCITY, SERIES, BLENDING_RISE, BLENDING_RETURN, THROUGH_POINTS, MADE_TO_MEASURE,
)  # fmt: skip
"""Groups in the order of the menus; further groups follow them."""


SHORT_LABEL = 9  # characters of a label that needs no shorter one


@frozen
class Law:
    """One row of the table of motion laws.

    Attributes
    ----------
    slug, label : spelling in files, and name as shown
    group : heading on the menus
    pieces : s(u); empty where further keys of a segment determine it
    formula : s(u) as printed, a line for each section; empty for the dwell
    source : publication of the formula; after a colon a short form of it
    abbreviation : of the handbooks, at most 5 characters; else the slug
    brief : at most 11 characters, for a cell of a table; else the label where it is short, or the abbreviation
    where : meaning of the symbols in the formula
    own : the keys that determine it, in words, in place of peak coefficients
    help : explanation of these keys
    later : order in its group
    is_dwell : whether the follower stands still
    rises : 1 for a rise, -1 for a return, which needs a negative rise, 0 for both
    flat : curve with constant acceleration in its middle over a fraction of the span, where there is one
    """

    slug: str
    label: str
    group: str
    pieces: tuple[Piece, ...]
    formula: tuple[str, ...]
    source: str
    abbreviation: str = ""
    brief: str = ""
    where: str = ""
    own: str = ""
    help: str = ""
    later: int = 0
    is_dwell: bool = False
    rises: int = 0
    flat: Callable[[float], tuple[Piece, ...]] | None = None

    @property
    def short_name(self) -> str:
        """Shortest name, for small plots."""
        return self.abbreviation or self.slug.upper()

    @property
    def short_label(self) -> str:
        """Short name, for a cell of a table."""
        return self.brief or (self.label if len(self.label) <= SHORT_LABEL else self.short_name)

    @cached_property
    def _table(self) -> PieceTable:
        return PieceTable(self.pieces)

    def at(self, u: np.ndarray) -> Derivatives:
        """Law s and its derivatives s', s'', s''' by u; at a join inside the law the right-hand limit.

        Parameters
        ----------
        u : ndarray (n,), dimensionless
            0...1.

        Returns
        -------
        Derivatives
        """
        return self._table.at(np.atleast_1d(np.asarray(u, dtype=float)))

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """Law and derivatives s, s', s'', s'''.

        Parameters
        ----------
        u : ndarray (n,), dimensionless

        Returns
        -------
        ndarray (4, n), dimensionless
        """
        return self.at(u).all

    @cached_property
    def is_symmetric(self) -> bool:
        """Whether s(u) + s(1-u) = 1, so that ``asymmetric`` may stretch its halves."""
        u = np.linspace(0.0, 1.0, 9)
        return not self.is_dwell and bool(np.abs(self(u)[0] + self(1.0 - u)[0] - 1.0).max() < 1e-12)


def _single_piece(*polynomial: float, sines: tuple[Sine, ...] = ()) -> tuple[Piece, ...]:
    return (Piece(0.0, polynomial, sines),)


def scca(b: float, c: float, d: float) -> tuple[Piece, ...]:
    """Sine - constant - cosine acceleration, with widths b, c, d of its sections.

    b/2 sine ramp, c/2 constant, d/2 cosine, constant velocity over 1 - b - c - d, and the same sections mirrored.

    References
    ----------
    R. L. Norton, *Cam Design and Manufacturing Handbook*, ch. 3.
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
    # w from u = 1/8, where 4 pi u / 3 + pi / 3 is pi / 2
    Piece(0.125, ((2 + pi / 8) * _K, pi * _K), (Sine(-2.25 * _K, 4 * pi / 3, pi / 2),)),
    Piece(0.875, ((4 + 7 * pi / 8) * _K, pi * _K), (Sine(_K / 4, 4 * pi, pi / 2),)),
)


_P1 = (0, 0, 0, 250, 0, -852, 1096, -558, 105)  # over 41; the decimals in the literature are rounded
C1 = _single_piece(0.0, 1.0, sines=(Sine(-1.0 / pi, pi),))
C2 = _single_piece(0.0, 1.0, sines=(Sine(1.0 / pi, pi),))
CYCLOIDAL = _single_piece(0.0, 1.0, sines=(Sine(-0.5 / pi, 2 * pi),))
H1 = _single_piece(1.0, sines=(Sine(-1.0, pi / 2, pi / 2),))
H2 = _single_piece(0.0, sines=(Sine(1.0, pi / 2),))
HARMONIC = _single_piece(0.5, sines=(Sine(-0.5, pi, pi / 2),))
P1 = _single_piece(*(c / 41 for c in _P1))
P2 = _single_piece(
    *(((41 if j == 0 else 0) - (-1) ** j * c) / 41 for j, c in enumerate(shifted(_P1, 1)))
)  # 1 - P1(1-u), exact in integers
LINE = _single_piece(0.0, 1.0)


def accelerating_half(flat: float) -> tuple[Piece, ...]:
    """Accelerating half of a modified trapezoid, from rest to the velocity 2, with constant acceleration over a fraction.

    Quarter sine, constant over the fraction ``flat`` of the span, quarter cosine. Fraction 0 is C1, 1 a parabola. The
    acceleration is symmetric, so that the end velocity is 2 for every fraction; its peak is 2/(flat + (1 - flat) 2/π).
    """
    ramp = 0.5 * (1.0 - flat)
    frequency = 0.5 * pi / ramp if ramp else 1.0
    return integrate(
        [
            Acceleration(ramp, amplitude=1.0, frequency=frequency),
            Acceleration(flat, level=1.0),
            Acceleration(ramp, amplitude=1.0, frequency=frequency, phase=pi / 2),
        ]
    )


def decelerating_half(flat: float) -> tuple[Piece, ...]:
    """Decelerating half from the velocity 2 to rest, 2u - ``accelerating_half``, which is its mirror image in time."""
    result = []
    for piece in accelerating_half(flat):
        c = (*piece.polynomial, 0.0, 0.0)
        sines = tuple(Sine(-wave.amplitude, wave.frequency, wave.phase) for wave in piece.sines)
        result.append(Piece(piece.start, (2.0 * piece.start - c[0], 2.0 - c[1], -c[2]), sines))
    return tuple(result)


def _sines(*terms: tuple[float, float]) -> tuple[Piece, ...]:
    """Harmonic series u + Σ A_k sin(2 π k u)."""
    return _single_piece(0.0, 1.0, sines=tuple(Sine(a, 2 * pi * k) for k, a in terms))


def modified_sine_with_cv(fraction: float) -> tuple[Piece, ...]:
    """Modified sine with constant velocity in its middle over a fraction of the span."""
    return scca(0.25 * (1 - fraction), 0.0, 0.75 * (1 - fraction))


_CYCLOID, _SIMPLE_HARMONIC = ("s = u - sin(2 π u)/(2 π)",), ("s = (1 - cos(π u))/2",)
_C1_FORMULA, _C2_FORMULA = ("s = u - sin(π u)/π",), ("s = u + sin(π u)/π",)
_H1_FORMULA, _H2_FORMULA = ("s = 1 - cos(π u/2)",), ("s = sin(π u/2)",)
_SCCA = (
    "s″ = C_a sin(π u/b), 0 ≤ u ≤ b/2",
    "s″ = C_a, b/2 ≤ u ≤ (b + c)/2",
    "s″ = C_a cos(π w/d), w = u - (b + c)/2 ≤ d/2",
)
_SCCA_WHERE = "b, c, d widths of ramp, constant and cosine, then constant velocity, and the same sections mirrored; C_a so that s(1) = 1"
_POINTS = ("min ∫ s‴² dθ",)
_POINTS_WHERE = (
    "the periodic spline through the points of the table with the least jerk, a polynomial between neighbours"
)
FLAT_FORMULA = (
    "s″ = C_a sin(π u/(2r)), 0 ≤ u ≤ r",
    "s″ = C_a, r ≤ u ≤ 1 - r",
    "s″ = C_a sin(π (1 - u)/(2r)), 1 - r ≤ u ≤ 1",
)
"""Formula of ``accelerating_half``, printed in place of a law's formula where a segment has a flat."""
FLAT_WHERE = "of C1 and C3; C2 and C4 have -s″; 1 - 2r the fraction of the span at constant acceleration, C_a = 2/(1 - 2r + 4r/π)"

_ROWS = (
    Law("dwell", "Dwell", STANDSTILL, _single_piece(0.0), (), "s = 0", "D", is_dwell=True),
    Law("constant-velocity", "Constant velocity", STANDSTILL, LINE, ("s = u",), "s = u", "CV", "Const. v."),
    Law("parabolic", "Parabolic", STANDARD, (Piece(0.0, (0.0, 0.0, 2.0)), Piece(0.5, (0.5, 2.0, -2.0))),
        ("s = 2 u², u ≤ 1/2", "s = 1 - 2 (1 - u)², u ≥ 1/2"), "constant acceleration: s = 2u^2, 1 - 2(1-u)^2", "CA", later=2),
    Law("simple-harmonic", "Simple harmonic", STANDARD, HARMONIC, _SIMPLE_HARMONIC, "s = (1 - cos pi u)/2", "SH", "Harmonic",
        later=1),
    Law("double-harmonic", "Double harmonic", STANDARD, _single_piece(0.375, sines=(Sine(-0.5, pi, pi / 2), Sine(0.125, 2 * pi, pi / 2))),
        ("s = (1 - cos(π u))/2 - (1 - cos(2 π u))/8",), "s = (1 - cos pi u)/2 - (1 - cos 2 pi u)/8", "DH", "Double h.", later=1),
    Law("cycloidal", "Cycloidal", STANDARD, CYCLOIDAL, _CYCLOID, "s = u - sin(2 pi u)/(2 pi)", "CYC"),
    Law("modified-sine", "Modified sine", STANDARD, MODIFIED_SINE,
        ("s = (π u - sin(4 π u)/4)/(4 + π), u ≤ 1/8",
         "s = (2 + π u - 9 sin(4 π u/3 + π/3)/4)/(4 + π), 1/8 ≤ u ≤ 7/8",
         "s = (4 + π u - sin(4 π u)/4)/(4 + π), u ≥ 7/8"), "Neklutin; Norton ch. 3: k = 1/(4 + pi)", "MS", "Mod. sine"),
    Law("modified-trapezoid", "Modified trapezoid", STANDARD, scca(0.25, 0.5, 0.25), _SCCA,
        "Neklutin; Norton ch. 3: SCCA 1/4, 1/2, 1/4", "MT", "Mod. trap.", where=_SCCA_WHERE),
    *(
        Law(slug, f"Modified constant velocity {percent} %", CONSTANT_VELOCITY, modified_sine_with_cv(share), _SCCA, f"SCCA; {source}",
            where=_SCCA_WHERE)
        for slug, percent, share, source in (("mcv20", 20, 0.2, "Norton ch. 3"), ("mcv33", 33, 1 / 3, "exactly 1/3"),
                                             ("mcv50", 50, 0.5, "Norton ch. 3"), ("mcv66", 66, 2 / 3, "exactly 2/3"))
    ),
    Law("2-3", "Polynomial 2-3", POLYNOMIALS, _single_piece(0.0, 0.0, 3.0, -2.0), ("s = 3 u² - 2 u³",), "s = 3u^2 - 2u^3", "23",
        "Poly. 2-3"),
    Law("3-4-5", "Polynomial 3-4-5", POLYNOMIALS, _single_piece(0.0, 0.0, 0.0, 10.0, -15.0, 6.0), ("s = 10 u³ - 15 u⁴ + 6 u⁵",),
        "s = 10u^3 - 15u^4 + 6u^5", "345", "Poly. 3-4-5"),
    Law("4-5-6-7", "Polynomial 4-5-6-7", POLYNOMIALS, _single_piece(0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0),
        ("s = 35 u⁴ - 84 u⁵ + 70 u⁶ - 20 u⁷",), "s = 35u^4 - 84u^5 + 70u^6 - 20u^7", "4567", "P. 4-5-6-7"),
    Law("5-6-7-8-9", "Polynomial 5-6-7-8-9", POLYNOMIALS, _single_piece(0.0, 0.0, 0.0, 0.0, 0.0, 126.0, -420.0, 540.0, -315.0, 70.0),
        ("s = 126 u⁵ - 420 u⁶ + 540 u⁷ - 315 u⁸ + 70 u⁹",), "s = 126u^5 - 420u^6 + 540u^7 - 315u^8 + 70u^9", "56789", "P. 5-...-9"),
    Law("freudenstein-1-3", "Freudenstein 1-3", SERIES, _sines((1, -27 / (56 * pi)), (3, -1 / (168 * pi))),
        ("s = u - 27 sin(2 π u)/(56 π) - sin(6 π u)/(168 π)",),
        "Freudenstein 1960: s = u - (27/28)[sin 2 pi u + sin(6 pi u)/81]/(2 pi)", "F1-3", "Freud. 1-3"),
    Law("freudenstein-1-3-5", "Freudenstein 1-3-5", SERIES,
        _sines(*((k, -1125 / (1192 * 2 * pi) * a) for k, a in ((1, 1.0), (3, 1 / 54), (5, 1 / 1250)))),
        ("s = u - 1125 sin(2 π u)/(2384 π) - 1125 sin(6 π u)/(128736 π) - 9 sin(10 π u)/(23840 π)",),
        "Freudenstein 1960: s = u - (1125/1192)[sin 2 pi u + sin(6 pi u)/54 + sin(10 pi u)/1250]/(2 pi)", "F1-5", "Freud. 1-5"),
    Law("gutman-1-3", "Gutman 1-3", SERIES, _sines((1, -15 / (32 * pi)), (3, -1 / (96 * pi))),
        ("s = u - 15 sin(2 π u)/(32 π) - sin(6 π u)/(96 π)",), "Gutman 1961: s = u - 15 sin(2 pi u)/(32 pi) - sin(6 pi u)/(96 pi)",
        "G1-3", "Gutman"),
    Law("c1", "C1 half cycloid", BLENDING_RISE, C1, _C1_FORMULA, "Yang Table 1: s = u - sin(pi u)/pi", rises=1, flat=accelerating_half),
    Law("c2", "C2 half cycloid", BLENDING_RISE, C2, _C2_FORMULA, "Yang Table 1: s = u + sin(pi u)/pi", rises=1, flat=decelerating_half),
    Law("c3", "C3 half cycloid, return", BLENDING_RETURN, C1, _C1_FORMULA, "Yang Table 1: 1 - C1", rises=-1,
        flat=accelerating_half),
    Law("c4", "C4 half cycloid, return", BLENDING_RETURN, C2, _C2_FORMULA, "Yang Table 1: 1 - C2", rises=-1,
        flat=decelerating_half),
    Law("c5", "C5 cycloid", BLENDING_RISE, CYCLOIDAL, _CYCLOID, "Yang Table 1: s = u - sin(2 pi u)/(2 pi)", rises=1),
    Law("c6", "C6 cycloid, return", BLENDING_RETURN, CYCLOIDAL, _CYCLOID, "Yang Table 1: 1 - C5", rises=-1),
    Law("h1", "H1 half harmonic", BLENDING_RISE, H1, _H1_FORMULA, "Yang Table 1: s = 1 - cos(pi u/2)", rises=1),
    Law("h2", "H2 half harmonic", BLENDING_RISE, H2, _H2_FORMULA, "Yang Table 1: s = sin(pi u/2)", rises=1),
    Law("h3", "H3 half harmonic, return", BLENDING_RETURN, H1, _H1_FORMULA, "Yang Table 1: 1 - H1", rises=-1),
    Law("h4", "H4 half harmonic, return", BLENDING_RETURN, H2, _H2_FORMULA, "Yang Table 1: 1 - H2", rises=-1),
    Law("h5", "H5 harmonic", BLENDING_RISE, HARMONIC, _SIMPLE_HARMONIC, "Yang Table 1: s = (1 - cos pi u)/2", rises=1),
    Law("h6", "H6 harmonic, return", BLENDING_RETURN, HARMONIC, _SIMPLE_HARMONIC, "Yang Table 1: 1 - H5", rises=-1),
    Law("p1", "P1 eighth degree", BLENDING_RISE, P1, ("s = (250 u³ - 852 u⁵ + 1096 u⁶ - 558 u⁷ + 105 u⁸)/41",),
        "Yang; (250u^3 - 852u^5 + 1096u^6 - 558u^7 + 105u^8)/41", rises=1),
    Law("p2", "P2 eighth degree, return", BLENDING_RETURN, P2,
        ("s = 1 - (250 (1 - u)³ - 852 (1 - u)⁵ + 1096 (1 - u)⁶ - 558 (1 - u)⁷ + 105 (1 - u)⁸)/41",), "Yang: P2(u) = P1(1-u)",
        rises=-1),
    Law("cv1", "CV1 constant velocity", BLENDING_RISE, LINE, ("s = u",), "Yang Table 1: s = u", rises=1),
    Law("cv2", "CV2 constant velocity, return", BLENDING_RETURN, LINE, ("s = u",), "Yang Table 1: 1 - CV1", rises=-1),
    # laws with further keys, which ``core.design.CURVES`` reads
    Law("scca", "SCCA", CONSTANT_VELOCITY, (), _SCCA, "Norton ch. 3", where=_SCCA_WHERE, own="widths to set",
        help="sine, constant and cosine acceleration with widths to choose, and constant velocity in the middle"),
    Law("polynomial", "Polynomial", POLYNOMIALS, (), ("s = Σ c_k u^k",), "conditions at both ends", "P", "Polynom.",
        where="c_k from the values, slopes and curvatures at the ends", own="ends to set",
        help="velocity, acceleration and jerk at both ends to choose"),
    Law("spline", "Spline", THROUGH_POINTS, (), _POINTS, "least jerk", "SP", where=_POINTS_WHERE, own="points to set",
        help="least jerk through points to choose; periodic where it takes the whole turn"),
    Law("table", "Table", THROUGH_POINTS, (), _POINTS, "least jerk", "TAB", where=_POINTS_WHERE, own="rows of a table",
        help="least jerk through rows of a table: measured, or rolled off a drawing"),
    Law("optimal", "Optimal", MADE_TO_MEASURE, (), ("min max |s⁽ᵏ⁾|",), "least peak or mean square", "OPT",
        where="s⁽ᵏ⁾ the derivative whose peak, or whose root mean square, is least within the limits on the others",
        own="aim and limits to set", help="least peak or root mean square of a derivative, within limits on the others"),
)  # fmt: skip

EVERY_LAW: Mapping[str, Law] = MappingProxyType({row.slug: row for row in _ROWS})
"""All laws, with those that further keys determine."""
LAWS: Mapping[str, Law] = MappingProxyType({row.slug: row for row in _ROWS if row.pieces})
ALIASES: Mapping[str, str] = MappingProxyType(
    {"harmonic": "simple-harmonic", "polynomial-3-4-5": "3-4-5", "polynomial-4-5-6-7": "4-5-6-7"}
)


def find_law(name: str) -> Law | None:
    """Law of a slug or alias; None where there is none."""
    return LAWS.get(ALIASES.get(name, name))


def named_law(name: str) -> Law:
    """Row of any law by slug or alias; for an unknown name a row with that name only.

    A name of several parts, such as ``run-up, ramp, flank, nose``, has its first and last part in cells of tables.
    """
    if (law := EVERY_LAW.get(ALIASES.get(name, name))) is not None:
        return law
    first, *others = name.split(", ")
    return Law(name, name, "", (), (), "", brief=f"{first} … {others[-1]}" if others else "")


def law_groups() -> dict[str, tuple[str, ...]]:
    """Heading -> slugs of its laws, in the order of the menus."""
    rows = sorted(EVERY_LAW.values(), key=lambda row: row.later)
    groups = {
        name: tuple(row.slug for row in rows if row.group == name) for name in (*GROUPS, *(row.group for row in rows))
    }
    return {name: slugs for name, slugs in groups.items() if slugs}


# -- peak coefficients of a law ---------------------------------------------------------------------------------


GRID = 257  # samples of a piece, whose waves are at most a few turns
NEAR = 0.99  # of the highest sample; a lower sampled peak cannot exceed it between samples
ROUNDING = 1e-12


@frozen
class Peaks:
    """Peak coefficients for unit rise and unit span; infinite where the lower derivative jumps inside the law.

    Attributes
    ----------
    cv, ca, cj : largest |s'|, |s''|, |s'''|
    cm : largest |s' s''|, of the inertia torque
    jumps_at_an_end : whether the acceleration at an end is not 0
    """

    cv: float
    ca: float
    cj: float
    cm: float
    jumps_at_an_end: bool


@lru_cache(maxsize=256)
def peaks(law: Law) -> Peaks:
    """Peak coefficients of a law; every piece is searched up to its ends, so that both sides of a jump count."""
    table = PieceTable(law.pieces)
    best, edges = np.zeros(4), []
    for i, width in enumerate(np.diff(table.starts, append=1.0)):
        best = np.maximum(best, _piece_peaks(table, i, width))
        edges.append(table.rows(np.full(2, i), np.array([0.0, width]))(2))
    jerk_is_infinite = any(
        not math.isclose(left[1], right[0], rel_tol=1e-9, abs_tol=1e-9 * best[1]) for left, right in pairwise(edges)
    )
    at_an_end = max(abs(edges[0][0]), abs(edges[-1][1])) > 1e-9 * max(best[1], 1.0)
    cv, ca, cj, cm = best.tolist()
    return Peaks(cv, ca, math.inf if jerk_is_infinite else cj, cm, at_an_end)


def _piece_peaks(table: PieceTable, i: int, width: float) -> np.ndarray:
    """Peaks (4,) of one piece: brackets of all sampled peaks near the highest, narrowed until rounding decides."""
    w = np.linspace(0.0, width, GRID)
    sampled = _magnitudes(table, i, np.repeat(w[:, None], 4, axis=1), np.arange(4))
    best = sampled.max(axis=0)
    up = np.diff(sampled, axis=0, prepend=-1.0) > ROUNDING * best
    down = np.diff(sampled, axis=0, append=-1.0) <= ROUNDING * best
    top, quantity = np.nonzero(up & down & (sampled >= NEAR * best))
    low, high = w[np.maximum(top - 1, 0)], w[np.minimum(top + 1, GRID - 1)]
    columns = np.arange(quantity.size)
    for _ in range(12):
        points = np.linspace(low, high, 17)
        values = _magnitudes(table, i, points, quantity)
        at = values.argmax(axis=0)
        np.maximum.at(best, quantity, values[at, columns])
        low, high = points[np.maximum(at - 1, 0), columns], points[np.minimum(at + 1, 16), columns]
    return best


def _magnitudes(table: PieceTable, i: int, points: np.ndarray, quantity: np.ndarray) -> np.ndarray:
    """|s'|, |s''|, |s'''| or |s' s''| (n, m) at points (n, m) of a piece, by the number of the quantity (m,)."""
    row = table.rows(np.full(points.size, i), points.ravel())
    v, a, j = (row(order).reshape(points.shape) for order in (1, 2, 3))
    return np.abs(np.select([quantity == 0, quantity == 1, quantity == 2], [v, a, j], v * a))
