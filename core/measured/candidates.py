"""Candidate curves of a stroke: laws of the table, sequences of elementary curves, SCCA with free widths."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import product

import numpy as np

from core.design import Curve, NamedCurve, SccaCurve
from core.frozen import frozen
from core.laws import LAWS, Piece, PieceTable, scca
from core.laws.pieces import stretched
from core.measured.strokes import Rest

"""Rows of a stroke on which laws are tried, compared, and refined at last."""
SLOWEST = 1e-3  # least s' of a law in its inverse function
INVERTED = 3  # steps of Newton's method from the nearest of ``SHARES``, enough for rows of seven decimals
_FACTOR = {"c1": 0.5, "c2": 0.5, "h1": 2.0 / np.pi, "h2": 2.0 / np.pi, "cv1": 1.0,
           "c3": 0.5, "c4": 0.5, "h3": 2.0 / np.pi, "h4": 2.0 / np.pi, "cv2": 1.0}  # fmt: skip
"""Rise of an elementary curve divided by its span and by its velocity at the join."""


_LEAST = (0.01, 0.05, 0.15, 0.3, 0.45)
_TRIED = {
    2: tuple((fraction,) for share in _LEAST for fraction in (share, 1.0 - share)),
    3: tuple(
        {(a, b): 0 for x, y in product(_LEAST, repeat=2) for a, b in ((x, y), (x, 1.0 - x - y), (1.0 - x - y, y))}
    ),
}
"""Fractions of the span, without the last one, with which sequences of two and three curves are tried."""


@frozen
class Candidate:
    """A law, or a family of laws.

    Attributes
    ----------
    name : name for the user
    tried : values (k,) of its open fractions for the first comparison; a named law has one without any
    table : from fractions to s(u), 0 ... 1; None where the fractions are invalid
    curves : from fractions to the span fraction, rise fraction and curve of each segment
    """

    name: str
    tried: tuple[tuple[float, ...], ...]
    table: Callable[[Sequence[float]], PieceTable | None]
    curves: Callable[[Sequence[float]], list[tuple[float, float, Curve]]]

    @property
    def open(self) -> int:
        """Number of open fractions."""
        return len(self.tried[0])


@frozen(eq=False)
class Stroke:
    """Stroke between two rests with its recognised law.

    Attributes
    ----------
    start, end : cam angles [deg], which may exceed the turn
    low, high : levels there [unit of the motion]
    fractions : values of the open fractions
    spread : standard errors of start and end [deg]
    chi2 : χ² of the fit
    """

    left: Rest
    right: Rest
    candidate: Candidate
    start: float
    end: float
    low: float
    high: float
    fractions: tuple[float, ...]
    spread: tuple[float, float]
    chi2: float


@cache
def named_candidate(slug: str) -> Candidate:
    """Candidate of a law of the table."""
    table = PieceTable(LAWS[slug].pieces)
    return Candidate(slug, ((),), lambda _: table, lambda _: [(1.0, 1.0, NamedCurve(slug))])


def _sequence(slugs: tuple[str, ...]) -> Candidate:
    """Elementary curves with equal velocity at their joins; the open fractions are the spans without the last one."""
    factors = np.array([_FACTOR[slug] for slug in slugs])

    def shares(fractions: Sequence[float]) -> tuple[np.ndarray, np.ndarray] | None:
        spans = np.append(fractions, 1.0 - sum(fractions))
        if spans.min() < 1e-3:
            return None
        return spans, spans * factors / float(spans @ factors)

    def table(fractions: Sequence[float]) -> PieceTable | None:
        parts = shares(fractions)
        if parts is None:
            return None
        pieces: list[Piece] = []
        begin = height = 0.0
        for slug, span, rise in zip(slugs, *parts, strict=True):
            pieces += stretched(LAWS[slug].pieces, 0.0, span, begin, rise, height)
            begin, height = begin + span, height + rise
        return PieceTable(pieces)

    def curves(fractions: Sequence[float]) -> list[tuple[float, float, Curve]]:
        spans, rises = shares(fractions) or (np.ones(1), np.ones(1))
        return [(float(b), float(h), NamedCurve(slug)) for slug, b, h in zip(slugs, spans, rises, strict=True)]

    return Candidate(" ".join(slugs), _TRIED[len(slugs)], table, curves)


def _scca() -> Candidate:
    def widths(fractions: Sequence[float]) -> tuple[float, float, float] | None:
        cv, ramp, flat = fractions
        return (
            (cv, ramp, flat) if cv >= 0.0 and ramp >= 0.0 and flat >= 0.0 and cv < 0.98 and ramp + flat <= 1.0 else None
        )

    def table(fractions: Sequence[float]) -> PieceTable | None:
        valid = widths(fractions)
        if valid is None:
            return None
        cv, ramp, flat = valid
        accelerated = 1.0 - cv
        return PieceTable(
            scca(ramp * accelerated, flat * accelerated, max(accelerated - (ramp + flat) * accelerated, 0.0))
        )

    def curves(fractions: Sequence[float]) -> list[tuple[float, float, Curve]]:
        return [(1.0, 1.0, SccaCurve(*(float(fraction) for fraction in fractions)))]

    widths_tried = product((0.05, 0.2, 0.4, 0.65), (0.1, 0.25, 0.4), (0.1, 0.25, 0.45))
    return Candidate("scca", tuple(widths_tried), table, curves)


_FIRST = (
    "constant-velocity",
    "3-4-5",
    "4-5-6-7",
    "cycloidal",
    "modified-sine",
    "modified-trapezoid",
    "simple-harmonic",
)
_BLENDS = {1.0: (("c1", "h1"), "cv1", ("c2", "h2")), -1.0: (("c3", "h3"), "cv2", ("c4", "h4"))}
_SINGLE = {1.0: ("p1", "c1", "c2", "h1", "h2"), -1.0: ("p2", "c3", "c4", "h3", "h4")}


@cache
def tiers(sign: float) -> tuple[tuple[Candidate, ...], ...]:
    """Candidates for a stroke of this sign: named laws; elementary curves; their sequences; the general family."""
    others = (
        slug for slug, law in LAWS.items() if law.pieces and not law.is_dwell and not law.rises and slug not in _FIRST
    )
    first, middle, last = _BLENDS[sign]
    return (
        tuple(named_candidate(slug) for slug in (*_FIRST, *others)),
        tuple(named_candidate(slug) for slug in _SINGLE[sign]),
        tuple(_sequence((a, b)) for a in first for b in last),
        tuple(_sequence((a, middle, b)) for a in first for b in last),
        (_scca(),),
    )


SHARES = np.linspace(0.0, 1.0, 257)


@cache
def _inverse_tables(candidate: Candidate) -> tuple[np.ndarray, np.ndarray]:
    """U and s' at ``SHARES`` of the rise (m, 257), for the tried fractions."""
    u, tables = np.linspace(0.0, 1.0, 1025), [candidate.table(position) for position in candidate.tried]
    positions = np.array([np.interp(SHARES, table.at(u)[0], u) for table in tables if table])
    return positions, np.array(
        [table.at(position)[1] for table, position in zip(tables, positions, strict=True) if table]
    )


def inverse_laws(candidate: Candidate, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inverse function u of a law, and its slope s', for the tried fractions of a family.

    Parameters
    ----------
    candidate : Candidate
        The law, or the family of m laws.
    share : ndarray (n,), dimensionless
        Fractions of the rise, 0 ... 1.

    Returns
    -------
    u, slope : ndarray (m, n), dimensionless
    """
    index = share * (SHARES.size - 1)
    first = index.astype(int)
    weight = index - first
    u, slope = (table[:, first] * (1.0 - weight) + table[:, first + 1] * weight for table in _inverse_tables(candidate))
    if not candidate.open:
        table = candidate_law(candidate, ())
        for _ in range(INVERTED):
            law = table.at(u[0])
            u[0] += (share - law[0]) / np.maximum(law[1], SLOWEST)
        slope[0] = table.at(u[0])[1]
    return u, np.maximum(slope, SLOWEST)


def candidate_law(candidate: Candidate, fractions: Sequence[float]) -> PieceTable:
    """Law of a candidate with the given fractions of its span."""
    table = candidate.table(fractions)
    assert table is not None
    return table
