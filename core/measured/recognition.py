"""Which law of the table, or which sequence of a blend's elementary curves, a measured stroke is; its span and rise are found with it.

A stroke goes from rest to rest. Its model is

    s = y₀ + (y₁ - y₀) S((θ - θ₀)/(θ₁ - θ₀)),   S the law, y = y₀ before θ₀ and y₁ behind θ₁ where a dwell stands there,

fitted by least squares with the angles θ₀, θ₁, the level of a reversal, and what the law leaves open. A law is taken where χ² is that of
the errors and no row is far off; among the named laws only where no other fits as well. A family is tried where no named law fits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from math import sqrt

import numpy as np

from core.design import Curve, NamedCurve, SccaCurve
from core.frozen import frozen
from core.laws import LAWS, Piece, PieceTable, scca
from core.laws.pieces import stretched
from core.measured.rows import EXACT
from core.measured.strokes import Rest, Turned, shortest
from core.numerics.cancellation import checkpoint

FAR = 5.0  # errors that a row may be off the law
WELL = 10.0  # of χ²: a law that fits worse by no more fits as well
MOST_TRIED, MOST_REFINED = 150, 20_000  # rows of a stroke that laws are tried on, and that the one taken is refined on
NEAR = 1e-5  # of χ², of a law that is tried on rows with errors
STEP = 1e-7  # of a fraction, by which slopes are taken
NEARLY = 0.02  # of an acceleration, by which the two sides of a join may differ that is meant to have none
FEWEST = 8  # rows of a stroke that a law is recognised by
_FACTOR = {"c1": 0.5, "c2": 0.5, "h1": 2.0 / np.pi, "h2": 2.0 / np.pi, "cv1": 1.0,
           "c3": 0.5, "c4": 0.5, "h3": 2.0 / np.pi, "h4": 2.0 / np.pi, "cv2": 1.0}  # fmt: skip
"""Rise of an elementary curve over span and velocity where it joins the next."""


@frozen
class Candidate:
    """A law, or a family of them.

    name    as the user reads it
    starts  where its open fractions are looked for from, each (k,); empty of a named law
    pieces  fractions -> s(u) from 0 to 1; None where they are none
    curves  fractions -> of each segment its share of the span, its share of the rise, and its curve
    """

    name: str
    starts: tuple[tuple[float, ...], ...]
    pieces: Callable[[Sequence[float]], tuple[Piece, ...] | None]
    curves: Callable[[Sequence[float]], list[tuple[float, float, Curve]]]


@frozen(eq=False)
class Stroke:
    """A stroke between two rests, and the law that it was recognised as.

    start, end    cam angles [deg], counted on beyond the turn; low, high: levels there
    fractions     what the law leaves open
    spread        standard errors of start and end [deg]
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


def _named(slug: str) -> Candidate:
    pieces = LAWS[slug].pieces
    return Candidate(slug, (), lambda _: pieces, lambda _: [(1.0, 1.0, NamedCurve(slug))])


def _sequence(slugs: tuple[str, ...]) -> Candidate:
    """Elementary curves that go on into each other with the same velocity: their shares of the span are open but the last."""
    factors = np.array([_FACTOR[slug] for slug in slugs])

    def shares(fractions: Sequence[float]) -> tuple[np.ndarray, np.ndarray] | None:
        spans = np.append(fractions, 1.0 - sum(fractions))
        if spans.min() < 1e-3:
            return None
        return spans, spans * factors / float(spans @ factors)

    def pieces(fractions: Sequence[float]) -> tuple[Piece, ...] | None:
        parts = shares(fractions)
        if parts is None:
            return None
        made: list[Piece] = []
        begin = height = 0.0
        for slug, span, rise in zip(slugs, *parts, strict=True):
            made += stretched(LAWS[slug].pieces, 0.0, span, begin, rise, height)
            begin, height = begin + span, height + rise
        return tuple(made)

    def curves(fractions: Sequence[float]) -> list[tuple[float, float, Curve]]:
        spans, rises = shares(fractions) or (np.ones(1), np.ones(1))
        return [(float(b), float(h), NamedCurve(slug)) for slug, b, h in zip(slugs, spans, rises, strict=True)]

    starts = {2: ((0.5,), (0.3,), (0.7,)), 3: ((0.33, 0.33), (0.15, 0.7), (0.5, 0.2), (0.2, 0.3))}[len(slugs)]
    return Candidate(" ".join(slugs), starts, pieces, curves)


def _scca() -> Candidate:
    def widths(fractions: Sequence[float]) -> tuple[float, float, float] | None:
        cv, ramp, flat = fractions
        return (
            (cv, ramp, flat) if cv >= 0.0 and ramp >= 0.0 and flat >= 0.0 and cv < 0.98 and ramp + flat <= 1.0 else None
        )

    def pieces(fractions: Sequence[float]) -> tuple[Piece, ...] | None:
        found = widths(fractions)
        if found is None:
            return None
        cv, ramp, flat = found
        rest = 1.0 - cv
        return scca(ramp * rest, flat * rest, max(rest - (ramp + flat) * rest, 0.0))

    def curves(fractions: Sequence[float]) -> list[tuple[float, float, Curve]]:
        return [(1.0, 1.0, SccaCurve(*(float(each) for each in fractions)))]

    return Candidate("scca", ((0.2, 0.25, 0.2), (0.1, 0.3, 0.4), (0.5, 0.4, 0.1)), pieces, curves)


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


def tiers(sign: float) -> Iterator[list[Candidate]]:
    """What a stroke of this sense may be: named laws, elementary curves and their sequences, the family that contains the rest."""
    others = (
        slug for slug, law in LAWS.items() if law.pieces and not law.is_dwell and not law.rises and slug not in _FIRST
    )
    yield [_named(slug) for slug in (*_FIRST, *others)]
    first, middle, last = _BLENDS[sign]
    yield [_named(slug) for slug in _SINGLE[sign]]
    yield [_sequence((a, b)) for a in first for b in last]
    yield [_sequence((a, middle, b)) for a in first for b in last]
    yield [_scca()]


# -- one stroke -------------------------------------------------------------------------------------------


class StrokeFit:
    """The rows of one stroke, or of several that follow on each other at reversals, and the models that are fitted to them.

    rests  in order, one more than there are strokes; those in the middle are reversals
    """

    def __init__(self, at: Turned, rests: Sequence[Rest]) -> None:
        self.at, self.rests = at, rests
        self.bounds = [self._bounds(a, b) for a, b in pairwise(rests)]

    def _bounds(self, left: Rest, right: Rest) -> np.ndarray:
        """The rows of a stroke: with some of the dwells beside it, without those next to a reversal."""
        first, last = left.last, right.first
        more = max(4, (last - first) // 4)
        # not the other half of a dwell: the stroke beyond it may leave it slowly
        first = max((left.first + left.last + 1) // 2, first - more) if left.level is not None else first + 1
        last = min((right.first + right.last) // 2, last + more) if right.level is not None else last - 1
        first = max(first, last - self.at.count + 1)
        return np.arange(first, last + 1)

    def rows(self, most: int) -> list[np.ndarray]:
        return [
            rows[np.unique(np.linspace(0, rows.size - 1, most).astype(int))] if rows.size > most else rows
            for rows in self.bounds
        ]

    def residuals(
        self, stroke: int, rows: np.ndarray, ends: tuple[float, float], levels: tuple[float, float], pieces: tuple[Piece, ...],
        orders: Sequence[int] = (0, 1), later: float = 0.0,
    ) -> np.ndarray:  # fmt: skip
        """Rows minus model of each column (k, n), in errors; later: degrees that the model is looked at beyond the row."""
        at, (start, end), (low, high) = self.at, ends, levels
        u = (at.x[rows] + later - start) / (end - start)
        inside = (u >= 0.0) & (u < 1.0)
        law = PieceTable(pieces).at(np.clip(u, 0.0, 1.0))
        made = []
        for order in orders:
            if order not in at.values:
                continue
            y = law[order] * (high - low) / (end - start) ** order
            y = np.where(inside, y, 0.0) if order else np.where(u < 0.0, low, np.where(u >= 1.0, high, y + low))
            made.append((at.values[order][rows] - y) / at.rows.errors[order])
        return np.array(made)

    def _slopes(
        self, rows: np.ndarray, ends: tuple[float, float], levels: tuple[float, float], pieces: tuple[Piece, ...]
    ) -> np.ndarray:
        """Derivatives of a stroke's residuals by its start and end, and by its lower and upper level (4, k n)."""
        at, (start, end), rise = self.at, ends, levels[1] - levels[0]
        span = end - start
        u = (at.x[rows] - start) / span
        inside = (u >= 0.0) & (u < 1.0)
        law = PieceTable(pieces).at(np.clip(u, 0.0, 1.0))
        begin, finish = (u - 1.0) / span, -u / span  # of u by start and end
        made = []
        for order in (0, 1):
            if order not in at.values:
                continue
            size, slope = np.where(inside, (law[order], law[order + 1]), 0.0) / span**order
            if order:
                by = (rise * (slope * begin + size / span), rise * (slope * finish - size / span), -size, size)
            else:
                size = np.where(u >= 1.0, 1.0, size)
                by = (rise * slope * begin, rise * slope * finish, 1.0 - size, size)
            known = np.isfinite(at.values[order][rows])  # a cell left out weighs nothing
            made.append(np.where(known, by, 0.0) / -at.rows.errors[order])
        return np.concatenate(made, axis=1)

    def solve(
        self,
        chosen: Sequence[Candidate],
        start: Sequence[float],
        most: int,
        steps: int = 60,
        within: float = 1e-15,
    ) -> tuple[np.ndarray, float, np.ndarray, int]:
        """Least squares over [angles of the rests, levels of the reversals, open fractions]: answer, χ², standard errors, rows.

        within  relative change of χ² at which it ends
        """
        from scipy.optimize import least_squares

        rows = self.rows(most)
        count = sum(each.size for each in rows) * sum(order in self.at.values for order in (0, 1))

        def missed(p: np.ndarray) -> np.ndarray:
            checkpoint()
            parts = []
            for i, (ends, levels, pieces) in enumerate(self.models(chosen, p.tolist())):
                if pieces is None or ends[1] - ends[0] < 1e-3:
                    return np.full(count, 1e12)
                parts.append(self.residuals(i, rows[i], ends, levels, pieces).ravel())
            left = np.concatenate(parts)
            return np.nan_to_num(left, nan=0.0)

        def slopes(p: np.ndarray) -> np.ndarray:
            """By the angles and levels in closed form, by the fractions as a difference."""
            n = len(self.rests)
            opened = [i for i, rest in enumerate(self.rests) if rest.level is None]
            places = {i: n + k for k, i in enumerate(opened)}
            made = np.zeros((count, len(p)))
            first = 0
            for i, (ends, levels, pieces) in enumerate(self.models(chosen, p.tolist())):
                by = self._slopes(rows[i], ends, levels, pieces or ())
                behind = first + by.shape[1]
                for column, of in zip((i, i + 1, places.get(i), places.get(i + 1)), by, strict=True):
                    if column is not None:
                        made[first:behind, column] += of
                first = behind
            here = missed(p) if len(p) > n + len(opened) else p
            for column in range(n + len(opened), len(p)):
                beside = p.copy()
                beside[column] += STEP
                there = missed(beside)
                if there[0] == 1e12:  # beyond what the fraction may be
                    beside[column] -= 2.0 * STEP
                    there = missed(beside)
                made[:, column] = (there - here) / (beside[column] - p[column])
            return np.nan_to_num(made, nan=0.0)

        scale = self._scale(chosen, start)
        found = least_squares(
            missed, start, slopes, x_scale=scale, method="trf", ftol=within, xtol=1e-15, gtol=1e-15, max_nfev=steps
        )
        chi2 = 2.0 * float(found.cost)
        return found.x, chi2, _spread(found.jac), count

    def _scale(self, chosen: Sequence[Candidate], start: Sequence[float]) -> np.ndarray:
        n = len(self.rests)
        span = max(abs(float(start[n - 1] - start[0])), 1.0)
        open_levels = sum(rest.level is None for rest in self.rests)
        fractions = len(start) - n - open_levels
        return np.array([span] * n + [self.at.rows.sizes[0]] * open_levels + [1.0] * fractions)

    def models(
        self, chosen: Sequence[Candidate], p: Sequence[float]
    ) -> Iterator[tuple[tuple[float, float], tuple[float, float], tuple[Piece, ...] | None]]:
        """Of each stroke its ends, its levels and its curve."""
        n = len(self.rests)
        angles, rest = list(p[:n]), list(p[n:])
        levels = [each.level if each.level is not None else rest.pop(0) for each in self.rests]
        for i, candidate in enumerate(chosen):
            k = len(candidate.starts[0]) if candidate.starts else 0
            fractions, rest = rest[:k], rest[k:]
            yield (angles[i], angles[i + 1]), (levels[i], levels[i + 1]), candidate.pieces(fractions)

    def fits(self, chosen: Sequence[Candidate], p: np.ndarray) -> tuple[bool, float]:
        """Whether all columns agree with the model within their errors, and χ² of all rows; at a jump a row may stand on either side."""
        whole, count = 0.0, 0
        for i, (ends, levels, pieces) in enumerate(self.models(chosen, p.tolist())):
            if pieces is None:
                return False, np.inf
            rows = self.bounds[i]
            two = [np.abs(self.residuals(i, rows, ends, levels, pieces, (0, 1, 2), by)) for by in (0.0, 1e-7, -1e-7)]
            left = np.fmin.reduce(two) if self.at.rows.exact else two[0]
            if (
                2 in self.at.values
            ):  # a row of a jump may stand on either side of it, as the place of the join is not known better
                near = np.abs(self.at.x[rows][:, None] - np.array(ends)).min(axis=1) < 3.0 * np.median(
                    np.diff(self.at.x[rows])
                )
                left[-1][near] = np.minimum(left[-1][near], 1.0) if not self.at.rows.exact else left[-1][near]
            left = np.nan_to_num(left, nan=0.0)
            if left.max() > FAR:
                return False, np.inf
            whole += float((left**2).sum())
            count += int(left.size)
        return whole <= count + 5.0 * sqrt(2.0 * count), whole


def _spread(jacobian: np.ndarray) -> np.ndarray:
    size = np.sqrt((jacobian**2).sum(axis=0))
    size[size == 0.0] = 1.0
    inverse = np.linalg.pinv((jacobian / size).T @ (jacobian / size))
    return np.sqrt(np.abs(np.diag(inverse))) / size


def _crossings(fit: StrokeFit, low: float, high: float) -> tuple[float, float]:
    """Cam angles [deg] at which a stroke has passed a quarter and three quarters of its rise."""
    rows = fit.bounds[0]
    share = (fit.at.values[0][rows] - low) / (high - low)
    x = fit.at.x[rows]
    first = int(np.argmax(share >= 0.25))
    third = share.size - 1 - int(np.argmax(share[::-1] <= 0.75))
    return float(x[first]), float(x[third])


def recognise(at: Turned, left: Rest, right: Rest, wanted: str = "") -> tuple[Stroke | None, list[str]]:
    """The law of the stroke between two rests; and, where several fit as well, their names. wanted: this law, however well it fits."""
    fit = StrokeFit(at, (left, right))
    if fit.bounds[0].size < FEWEST:
        return None, []
    y = at.values[0]
    low = left.level if left.level is not None else float(y[left.last])
    high = right.level if right.level is not None else float(y[right.first])
    if abs(high - low) < 20.0 * at.rows.errors[0]:
        return None, []
    quarter, third = _crossings(fit, low, high)
    inner = [level for rest, level in ((left, low), (right, high)) if rest.level is None]
    for tier in [[_named(wanted)]] if wanted else tiers(1.0 if high > low else -1.0):
        checkpoint()
        fitting: list[tuple[float, Candidate, np.ndarray, np.ndarray]] = []
        for candidate in tier:
            best = _best(fit, candidate, (quarter, third), inner, bool(wanted))
            if best is None:
                continue
            p, spread = best
            agrees, chi2 = fit.fits([candidate], p)
            if agrees or wanted:
                fitting.append((chi2, candidate, p, spread))
        fitting.sort(key=lambda each: each[0])
        if fitting:
            chi2, candidate, p, spread = fitting[0]
            rivals = [
                c.name for other, c, q, _ in fitting[1:] if other - chi2 <= WELL and not _same(candidate, c, p, q)
            ]
            if rivals:
                return None, [candidate.name, *rivals]
            return _stroke(fit, candidate, p, spread, chi2), []
    return None, []


def _same(one: Candidate, other: Candidate, p: np.ndarray, q: np.ndarray) -> bool:
    """Whether two are the same curve under two names."""
    u = np.linspace(0.0, 1.0, 33)
    first, second = one.pieces(p[len(p) - _open(one) :].tolist()), other.pieces(q[len(q) - _open(other) :].tolist())
    assert first is not None
    assert second is not None
    return bool(np.abs(PieceTable(first).at(u)[0] - PieceTable(second).at(u)[0]).max() < 1e-9)


def _open(candidate: Candidate) -> int:
    return len(candidate.starts[0]) if candidate.starts else 0


def _best(
    fit: StrokeFit, candidate: Candidate, crossings: tuple[float, float], levels: list[float], anyway: bool = False
) -> tuple[np.ndarray, np.ndarray] | None:
    """The best answer of a candidate; None where it is far off on the few rows that it is tried on, unless it is wanted anyway."""
    best: tuple[float, np.ndarray] | None = None
    count = 1
    within = NEAR
    for fractions in candidate.starts or ((),):
        pieces = candidate.pieces(fractions)
        assert pieces is not None
        u = np.linspace(0.0, 1.0, 201)
        s = PieceTable(pieces).at(u)[0]
        a, b = float(np.interp(0.25, s, u)), float(np.interp(0.75, s, u))
        span = max(crossings[1] - crossings[0], 1e-3) / (b - a)
        start = crossings[0] - a * span
        p, chi2, _, count = fit.solve(
            [candidate], [start, start + span, *levels, *fractions], MOST_TRIED, 60 if not fractions else 200, within
        )
        if best is None or chi2 < best[0]:
            best = chi2, p
        if chi2 < 2.0 * count:
            break
    assert best is not None
    if not anyway and best[0] > 4.0 * count and not (fit.at.rows.exact and best[0] < 1e12 * count):
        return None
    p, _, spread, _ = fit.solve([candidate], best[1].tolist(), MOST_REFINED, 60)
    return p, spread


def _stroke(fit: StrokeFit, candidate: Candidate, p: np.ndarray, spread: np.ndarray, chi2: float) -> Stroke:
    (ends, levels, _), *_ = fit.models([candidate], p.tolist())
    fractions = tuple(p[len(p) - _open(candidate) :].tolist()) if candidate.starts else ()
    return Stroke(
        fit.rests[0], fit.rests[1], candidate, *ends, *levels, fractions, (float(spread[0]), float(spread[1])), chi2
    )


# -- strokes that join at reversals -----------------------------------------------------------------------


def joined(at: Turned, strokes: Sequence[Stroke]) -> list[Stroke]:
    """Recognised strokes that follow on each other at reversals, fitted together; angles and levels rounded as far as their errors
    leave them open, where all rows agree with that."""
    fit = StrokeFit(at, (*(each.left for each in strokes), strokes[-1].right))
    chosen = [each.candidate for each in strokes]
    angles = [
        strokes[0].start,
        *(0.5 * (a.end + b.start) for a, b in pairwise(strokes)),
        strokes[-1].end,
    ]
    levels = [
        strokes[0].low,
        *(0.5 * (a.high + b.low) for a, b in pairwise(strokes)),
        strokes[-1].high,
    ]
    opened = [level for level, rest in zip(levels, fit.rests, strict=True) if rest.level is None]
    start = [*angles, *opened, *(f for each in strokes for f in each.fractions)]
    p, chi2, spread, _ = fit.solve(chosen, start, MOST_REFINED)
    rounded = p.copy()
    k = len(angles) + len(opened)
    for i in range(k):
        rounded[i] = shortest(float(p[i]), float(spread[i]))
    if k == len(p) and fit.fits(chosen, rounded)[0]:
        p = rounded
    if k < len(p):
        p = _without_jumps(fit, chosen, p)
    made = []
    place = k
    for i, ((ends, levels2, _), each) in enumerate(zip(fit.models(chosen, p.tolist()), strokes, strict=True)):
        count = _open(each.candidate)
        fractions = tuple(p[place : place + count].tolist())
        place += count
        errors = (float(spread[i]), float(spread[i + 1]))
        made.append(Stroke(each.left, each.right, each.candidate, *ends, *levels2, fractions, errors, chi2))
    return made


def _without_jumps(fit: StrokeFit, chosen: Sequence[Candidate], p: np.ndarray) -> np.ndarray:
    """The same with each reversal moved to where the accelerations of both sides are one, where they nearly are: a curve that joins has
    none that jumps by what its fit leaves open."""
    from scipy.optimize import brentq

    def apart(angle: float, place: int) -> tuple[float, float]:
        moved = p.copy()
        moved[place] = angle
        models = list(fit.models(chosen, moved.tolist()))[place - 1 : place + 1]
        before, behind = (
            float(PieceTable(pieces or ()).at(np.array([u]))[2][0]) * (levels[1] - levels[0]) / (ends[1] - ends[0]) ** 2
            for (ends, levels, pieces), u in zip(models, (1.0, 0.0), strict=True)
        )
        return behind - before, max(abs(before), abs(behind))

    for place in range(1, len(chosen)):
        off, size = apart(float(p[place]), place)
        if not off or abs(off) > NEARLY * size:
            continue
        reach = 0.5 * NEARLY * min(p[place] - p[place - 1], p[place + 1] - p[place])
        low, high = float(p[place] - reach), float(p[place] + reach)
        if apart(low, place)[0] * apart(high, place)[0] < 0.0:
            p = p.copy()
            p[place] = brentq(lambda angle, place=place: apart(angle, place)[0], low, high, xtol=1e-14, rtol=1e-15)
    return p


__all__ = ["EXACT", "Candidate", "Stroke", "joined", "recognise", "tiers"]
