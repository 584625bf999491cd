"""Which law of the table, or which sequence of a blend's elementary curves, a measured stroke is; its span and rise are found with it.

A stroke goes from rest to rest. Its model is

    s = y₀ + (y₁ - y₀) S((θ - θ₀)/(θ₁ - θ₀)),   S the law, y = y₀ before θ₀ and y₁ behind θ₁ where a dwell stands there,

fitted by least squares with the angles θ₀, θ₁, the level of a reversal, and what the law leaves open. A law is taken where χ² is that of
the errors and no row is far off; among the named laws only where no other fits as well. A family is tried where no named law fits.

First each law is estimated: turned round, u of a row's share of the rise, it is linear in θ₀ and θ₁ - θ₀, so that one linear regression
gives them and χ². Laws that are far off by that are not fitted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache, cached_property
from itertools import pairwise, product
from math import sqrt
from typing import NamedTuple

import numpy as np

from core.design import Curve, NamedCurve, SccaCurve
from core.frozen import frozen
from core.laws import LAWS, Piece, PieceTable, scca
from core.laws.pieces import stretched
from core.measured.rows import EXACT
from core.measured.strokes import Rest, Turned, shortest
from core.numerics.lazy import checkpoint

FAR = 5.0  # errors that a row may be off the law
HOPELESS = 25.0  # times the χ² that is refined: from another start no law comes as near
WELL = 10.0  # of χ²: a law that fits worse by no more fits as well
MOST_TRIED, MOST_COMPARED, MOST_REFINED = 150, 2000, 20_000
"""Rows of a stroke that laws are tried on, that those near enough are fitted to, and that the one taken is refined on."""
TRIED = 4.0  # χ² a row of a law that may be taken once it is refined
ESTIMATED, SOLVED = 1e-4, 1e-7  # of a rise: what an estimate, and a fit to few rows, may be off besides the errors
STARTS = 2  # estimates of a family that it is fitted from
APART = 0.05  # of a rise, that the level of a reversal may be off its row
ALIKE = 5e-4  # of a rise: what is nearer to a law than that is no other curve
SLOWEST = 1e-3  # s' of a law, at least, where it is turned round
INVERTED = 3  # steps of Newton's method from the nearest of ``SHARES``: rows of seven decimals are met too
PASSED = 0.03  # shares of the rise, below and above which rows tell little of a law
NEAR, CLOSE = 1e-3, 1e-10  # of χ², of a law that is tried, and of one that is refined on rows with errors
STEP = 1e-7  # of a fraction, by which slopes are taken
NEARLY = 0.02  # of an acceleration, by which the two sides of a join may differ that is meant to have none
STIFF = 1e6  # errors that such a difference counts for
FEWEST = 8  # rows of a stroke that a law is recognised by
_FACTOR = {"c1": 0.5, "c2": 0.5, "h1": 2.0 / np.pi, "h2": 2.0 / np.pi, "cv1": 1.0,
           "c3": 0.5, "c4": 0.5, "h3": 2.0 / np.pi, "h4": 2.0 / np.pi, "cv2": 1.0}  # fmt: skip
"""Rise of an elementary curve over span and velocity where it joins the next."""


_LEAST = (0.01, 0.05, 0.15, 0.3, 0.45)
_TRIED = {
    2: tuple((each,) for share in _LEAST for each in (share, 1.0 - share)),
    3: tuple(
        {(a, b): 0 for x, y in product(_LEAST, repeat=2) for a, b in ((x, y), (x, 1.0 - x - y), (1.0 - x - y, y))}
    ),
}
"""Shares of a span, all but the last, that a sequence of two or three curves is tried with: any of them may be short."""


@frozen
class Candidate:
    """A law, or a family of them.

    name    as the user reads it
    tried   its open fractions that are compared first, each (k,); of a named law the one without any
    table   fractions -> s(u) from 0 to 1; None where they are none
    curves  fractions -> of each segment its share of the span, its share of the rise, and its curve
    """

    name: str
    tried: tuple[tuple[float, ...], ...]
    table: Callable[[Sequence[float]], PieceTable | None]
    curves: Callable[[Sequence[float]], list[tuple[float, float, Curve]]]

    @property
    def open(self) -> int:
        """How many fractions it leaves open."""
        return len(self.tried[0])


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


@cache
def _named(slug: str) -> Candidate:
    table = PieceTable(LAWS[slug].pieces)
    return Candidate(slug, ((),), lambda _: table, lambda _: [(1.0, 1.0, NamedCurve(slug))])


def _sequence(slugs: tuple[str, ...]) -> Candidate:
    """Elementary curves that go on into each other with the same velocity: their shares of the span are open but the last."""
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
        made: list[Piece] = []
        begin = height = 0.0
        for slug, span, rise in zip(slugs, *parts, strict=True):
            made += stretched(LAWS[slug].pieces, 0.0, span, begin, rise, height)
            begin, height = begin + span, height + rise
        return PieceTable(made)

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
        found = widths(fractions)
        if found is None:
            return None
        cv, ramp, flat = found
        rest = 1.0 - cv
        return PieceTable(scca(ramp * rest, flat * rest, max(rest - (ramp + flat) * rest, 0.0)))

    def curves(fractions: Sequence[float]) -> list[tuple[float, float, Curve]]:
        return [(1.0, 1.0, SccaCurve(*(float(each) for each in fractions)))]

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
    """What a stroke of this sense may be: named laws, elementary curves and their sequences, the family that contains the rest."""
    others = (
        slug for slug, law in LAWS.items() if law.pieces and not law.is_dwell and not law.rises and slug not in _FIRST
    )
    first, middle, last = _BLENDS[sign]
    return (
        tuple(_named(slug) for slug in (*_FIRST, *others)),
        tuple(_named(slug) for slug in _SINGLE[sign]),
        tuple(_sequence((a, b)) for a in first for b in last),
        tuple(_sequence((a, middle, b)) for a in first for b in last),
        (_scca(),),
    )


SHARES = np.linspace(0.0, 1.0, 257)


@cache
def _turned_round(candidate: Candidate) -> tuple[np.ndarray, np.ndarray]:
    """u and s' at ``SHARES`` of the rise (m, 257), for each of the fractions that are tried."""
    u, tables = np.linspace(0.0, 1.0, 1025), [candidate.table(each) for each in candidate.tried]
    near = np.array([np.interp(SHARES, table.at(u)[0], u) for table in tables if table])
    return near, np.array([table.at(each)[1] for table, each in zip(tables, near, strict=True) if table])


def _inverse(candidate: Candidate, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """u and s' of a law at shares (n,) of its rise (m, n): of a family as near as its fractions are."""
    place = share * (SHARES.size - 1)
    first = place.astype(int)
    part = place - first
    near, slope = (each[:, first] * (1.0 - part) + each[:, first + 1] * part for each in _turned_round(candidate))
    if not candidate.open:
        table = _law(candidate, ())
        for _ in range(INVERTED):
            law = table.at(near[0])
            near[0] += (share - law[0]) / np.maximum(law[1], SLOWEST)
        slope[0] = table.at(near[0])[1]
    return near, np.maximum(slope, SLOWEST)


def _law(candidate: Candidate, fractions: Sequence[float]) -> PieceTable:
    table = candidate.table(fractions)
    assert table is not None
    return table


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

    def solve(
        self,
        chosen: Sequence[Candidate],
        start: Sequence[float],
        most: int,
        steps: int = 60,
        within: float = 1e-15,
        smooth: Sequence[int] = (),
    ) -> tuple[np.ndarray, float, np.ndarray, int]:
        """Least squares over [angles of the rests, levels of the reversals, open fractions]: answer, χ², standard errors, rows.

        within  relative change of χ² at which it ends
        smooth  reversals, by number, where the acceleration does not jump
        """
        from scipy.optimize import least_squares

        problem = _Problem(self, chosen, self.rows(most), smooth)
        found = least_squares(
            problem.residuals,
            start,
            problem.slopes,
            x_scale=self._scale(chosen, start),
            ftol=within,
            xtol=1e-15,
            gtol=1e-15,
            max_nfev=steps,
        )
        return found.x, 2.0 * float(found.cost), _spread(found.jac), problem.count

    def estimates(self, candidate: Candidate, levels: tuple[float, float]) -> list[tuple[float, list[float]]]:
        """Of each of a law's fractions that are tried χ² by the rows between the ends of the stroke, and where a fit of it starts from, the
        best first; none of a stroke of hardly any rows.

        Turned round, a row at x stands at u(share) of its law: x = θ₀ + (θ₁ - θ₀) u, and where the level of a reversal is off by d, u is by
        -d (1 - share)/s' at the lower end of it, by -d share/s' at the upper.
        """
        at, (low, high) = self.at, levels
        (rows,) = self.rows(MOST_TRIED)
        share = (at.values[0][rows] - low) / (high - low)
        least = max(PASSED, 3.0 * at.rows.errors[0] / abs(high - low))
        told = (share > least) & (share < 1.0 - least)
        x, share = at.x[rows][told], share[told]
        opened = [by for by, rest in zip((1.0 - share, share), self.rests, strict=True) if rest.level is None]
        if x.size < 2 + len(opened):
            return []
        u, slope = _inverse(candidate, share)
        columns = np.stack([slope, slope * u, *(np.broadcast_to(-by, u.shape) for by in opened)], axis=1)
        right = (slope * (x - x[0]))[:, :, None]
        square = columns @ columns.swapaxes(1, 2)
        ridge = np.diag([1e-13, 1e-13, *(1e-9 for _ in opened)])  # a straight line does not tell where it ends
        square += np.trace(square, axis1=1, axis2=2)[:, None, None] * ridge
        found = np.linalg.solve(square, columns @ right)
        left = ((right - columns.swapaxes(1, 2) @ found) ** 2).sum(axis=(1, 2))
        made = []
        for fractions, (begin, span, *moved), rest in zip(
            candidate.tried, found[:, :, 0].tolist(), left.tolist(), strict=True
        ):
            if span <= 0.0 or max(map(abs, moved), default=0.0) > APART * span:
                continue
            inner = iter(each * (high - low) / span for each in moved)
            off = [level + next(inner) for level, of in zip(levels, self.rests, strict=True) if of.level is None]
            start = float(x[0]) + begin
            made.append(
                (rest * ((high - low) / (span * at.rows.errors[0])) ** 2, [start, start + span, *off, *fractions])
            )
        return sorted(made)

    def nearly(self, chosen: Sequence[Candidate], p: np.ndarray) -> list[int]:
        """The reversals, by number, where the acceleration hardly jumps: of a curve that joins it jumps by what its fit leaves open."""
        models = [
            _Model(self.at, rows[:1], ends, levels, table)
            for rows, (ends, levels, table) in zip(self.bounds, self.models(chosen, p.tolist()), strict=True)
            if table
        ]
        return [i for i in range(1, len(models)) if abs(models[i].jump(models[i - 1])) < NEARLY]

    def _scale(self, chosen: Sequence[Candidate], start: Sequence[float]) -> np.ndarray:
        n = len(self.rests)
        span = max(abs(float(start[n - 1] - start[0])), 1.0)
        open_levels = sum(rest.level is None for rest in self.rests)
        fractions = len(start) - n - open_levels
        return np.array([span] * n + [self.at.rows.sizes[0]] * open_levels + [1.0] * fractions)

    def models(
        self, chosen: Sequence[Candidate], p: Sequence[float]
    ) -> Iterator[tuple[tuple[float, float], tuple[float, float], PieceTable | None]]:
        """Of each stroke its ends, its levels and its curve."""
        n = len(self.rests)
        angles, rest = list(p[:n]), list(p[n:])
        levels = [each.level if each.level is not None else rest.pop(0) for each in self.rests]
        for i, candidate in enumerate(chosen):
            fractions, rest = rest[: candidate.open], rest[candidate.open :]
            yield (angles[i], angles[i + 1]), (levels[i], levels[i + 1]), candidate.table(fractions)

    def fits(self, chosen: Sequence[Candidate], p: np.ndarray) -> tuple[bool, float]:
        """Whether all columns agree with the model within their errors, and χ² of all rows, those beyond a reversal and its neighbours too
        where the law reaches so far; at a jump a row may stand on either side."""
        whole, count = 0.0, 0
        for rows, (ends, levels, table) in zip(self.bounds, self.models(chosen, p.tolist()), strict=True):
            if table is None:
                return False, np.inf
            first, behind = np.searchsorted(self.at.x, ends)
            first, last = min(int(first), int(rows[0])), max(int(behind) - 1, int(rows[-1]))
            if last - first >= self.at.count:
                return False, np.inf
            rows = np.concatenate((np.arange(first, rows[0] - 2), rows, np.arange(rows[-1] + 3, last + 1)))
            two = [
                np.abs(_Model(self.at, rows, ends, levels, table, by).residuals((0, 1, 2)))
                for by in ((0.0, 1e-7, -1e-7) if self.at.rows.exact else (0.0,))
            ]
            left = np.fmin.reduce(two)
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


class _Problem:
    """Residuals of the rows of strokes (count,), of the angles of reversals, and of the jumps of the acceleration that shall not be, by
    [angles of the rests, levels of the reversals, open fractions].

    The angle of a reversal is that of its row within the distance of its neighbours, which counts where nothing else tells it.
    """

    def __init__(
        self, fit: StrokeFit, chosen: Sequence[Candidate], rows: Sequence[np.ndarray], smooth: Sequence[int]
    ) -> None:
        self.fit, self.chosen, self.rows, self.smooth = fit, chosen, rows, smooth
        self.count = sum(each.size for each in rows) * sum(order in fit.at.values for order in (0, 1))
        self.opened = [i for i, rest in enumerate(fit.rests) if rest.level is None]
        x, turning = fit.at.x, [fit.rests[i] for i in self.opened]
        self.turns = np.array([x[rest.last] for rest in turning])
        self.reach = np.array(
            [0.5 * (x[min(rest.last + 1, x.size - 1)] - x[max(rest.first - 1, 0)]) for rest in turning]
        )
        self.asked: tuple[bytes, list[_Model] | None] = b"", None  # slopes are wanted where residuals just were

    def models(self, p: np.ndarray) -> list[_Model] | None:
        """Of each stroke; None where one cannot be."""
        made = []
        for each, (ends, levels, table) in zip(self.rows, self.fit.models(self.chosen, p.tolist()), strict=True):
            if table is None or ends[1] - ends[0] < 1e-3:
                return None
            made.append(_Model(self.fit.at, each, ends, levels, table))
        return made

    def residuals(self, p: np.ndarray, keep: bool = True) -> np.ndarray:
        """(n,); 1e12 each where the models cannot be."""
        checkpoint()
        made = self.models(p)
        if keep:
            self.asked = p.tobytes(), made
        if made is None:
            return np.full(self.count + len(self.opened) + len(self.smooth), 1e12)
        left = np.nan_to_num(np.concatenate([each.residuals().ravel() for each in made]), nan=0.0)
        jumps = [STIFF * made[i].jump(made[i - 1]) for i in self.smooth]
        return np.concatenate((left, (p[self.opened] - self.turns) / self.reach, jumps))

    def slopes(self, p: np.ndarray) -> np.ndarray:
        """(n, parameters): by the angles and levels in closed form but of the jumps, by the fractions as a difference."""
        n, count = len(self.fit.rests), self.count
        places = {i: n + k for k, i in enumerate(self.opened)}
        made = np.zeros((count + len(self.opened) + len(self.smooth), len(p)))
        made[count + np.arange(len(self.opened)), self.opened] = 1.0 / self.reach
        first = 0
        for i, model in enumerate((self.asked[1] if self.asked[0] == p.tobytes() else self.models(p)) or ()):
            by = model.slopes()
            behind = first + by.shape[1]
            for column, of in zip((i, i + 1, places.get(i), places.get(i + 1)), by, strict=True):
                if column is not None:
                    made[first:behind, column] += of
            first = behind
        closed = n + len(self.opened)
        numeric = range(0 if self.smooth else closed, len(p))
        here = self.residuals(p, False) if numeric else p
        for column in numeric:
            beside = p.copy()
            beside[column] += STEP
            there = self.residuals(beside, False)
            if there[0] == 1e12:  # beyond what the fraction may be
                beside[column] -= 2.0 * STEP
                there = self.residuals(beside, False)
            told = 0 if column >= closed else count + len(self.opened)
            made[told:, column] = (there - here)[told:] / (beside[column] - p[column])
        return np.nan_to_num(made, nan=0.0)


class _Model:
    """A stroke's law at some rows (n,) of it; later: degrees that it is looked at beyond each."""

    def __init__(
        self, at: Turned, rows: np.ndarray, ends: tuple[float, float], levels: tuple[float, float], table: PieceTable, later: float = 0.0
    ) -> None:  # fmt: skip
        self.at, self.rows, self.levels, self.span, self.table = at, rows, levels, ends[1] - ends[0], table
        self.u = (at.x[rows] + later - ends[0]) / self.span
        self.inside = (self.u >= 0.0) & (self.u < 1.0)
        self.law = table.at(np.clip(self.u, 0.0, 1.0))

    @cached_property
    def _rise(self) -> float:
        return self.levels[1] - self.levels[0]

    def _acceleration(self, u: float) -> float:
        return float(self.table.at(np.array([u]))[2][0]) * self._rise / self.span**2

    def jump(self, before: _Model) -> float:
        """Of the acceleration from the end of the stroke before to the start of this, as a part of the larger one."""
        one, other = before._acceleration(1.0), self._acceleration(0.0)
        return (other - one) / (max(abs(one), abs(other)) or 1.0)

    def residuals(self, orders: Sequence[int] = (0, 1)) -> np.ndarray:
        """Rows minus model of each column (k, n), in errors."""
        at, u, (low, high), made = self.at, self.u, self.levels, []
        for order in orders:
            if order not in at.values:
                continue
            y = self.law[order] * self._rise / self.span**order
            y = np.where(self.inside, y, 0.0) if order else np.where(u < 0.0, low, np.where(u >= 1.0, high, y + low))
            made.append((at.values[order][self.rows] - y) / at.rows.errors[order])
        return np.array(made)

    def slopes(self) -> np.ndarray:
        """Derivatives of the residuals by its start and end, and by its lower and upper level (4, k n)."""
        at, u, span, rise = self.at, self.u, self.span, self._rise
        begin, finish = (u - 1.0) / span, -u / span  # of u by start and end
        made = []
        for order in (0, 1):
            if order not in at.values:
                continue
            size, slope = np.where(self.inside, (self.law[order], self.law[order + 1]), 0.0) / span**order
            if order:
                by = (rise * (slope * begin + size / span), rise * (slope * finish - size / span), -size, size)
            else:
                size = np.where(u >= 1.0, 1.0, size)
                by = (rise * slope * begin, rise * slope * finish, 1.0 - size, size)
            known = np.isfinite(at.values[order][self.rows])  # a cell left out weighs nothing
            made.append(np.where(known, by, 0.0) / -at.rows.errors[order])
        return np.concatenate(made, axis=1)


def _spread(jacobian: np.ndarray) -> np.ndarray:
    size = np.sqrt((jacobian**2).sum(axis=0))
    size[size == 0.0] = 1.0
    inverse = np.linalg.pinv((jacobian / size).T @ (jacobian / size))
    return np.sqrt(np.abs(np.diag(inverse))) / size


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
    coarse = at.rows.errors[0] > ALIKE * abs(high - low)  # then a curve of a family may be as near as a named law
    found: list[_Fitting] = []
    for tier in ((_named(wanted),),) if wanted else tiers(1.0 if high > low else -1.0):
        if found and not coarse:
            break
        checkpoint()
        fitting: list[_Fitting] = []
        for candidate in tier:
            best = _best(fit, candidate, (low, high), bool(wanted))
            if best is None:
                continue
            agrees, chi2 = fit.fits([candidate], best[0])
            if agrees or wanted:
                fitting.append(_Fitting(chi2, candidate, *best))
        fitting.sort(key=lambda each: each.chi2)
        if found:
            found += [each for each in fitting if not _alike(fit, found[0], each)]
        elif fitting:
            found = [fitting[0], *(each for each in fitting[1:] if not _same(fitting[0], each))]
    if not found:
        return None, []
    first, *others = found
    well = WELL * max(1.0, fit.bounds[0].size / MOST_COMPARED)  # of rows that they are not fitted to
    rivals = [each.candidate.name for each in others if each.chi2 - first.chi2 <= well]
    return (None, [first.candidate.name, *rivals]) if rivals else (_stroke(fit, first), [])


class _Fitting(NamedTuple):
    """A law that fits: χ², angles, levels and fractions, and their standard errors."""

    chi2: float
    candidate: Candidate
    p: np.ndarray
    spread: np.ndarray


def _same(one: _Fitting, other: _Fitting) -> bool:
    """Whether two are the same curve under two names."""
    u = np.linspace(0.0, 1.0, 33)
    first, second = (
        _law(each.candidate, each.p[len(each.p) - each.candidate.open :].tolist()).at(u)[0] for each in (one, other)
    )
    return bool(np.abs(first - second).max() < 1e-9)


def _alike(fit: StrokeFit, one: _Fitting, other: _Fitting) -> bool:
    """Whether two are the same within the error: a family comes as near to a law that it contains."""
    (rows,) = fit.rows(MOST_TRIED)
    first, second = (
        _Model(fit.at, rows, ends, levels, table).residuals((0,))
        for each in (one, other)
        for ends, levels, table in fit.models([each.candidate], each.p.tolist())
        if table
    )
    return bool(np.nanmax(np.abs(first - second)) <= 1.0)


def _best(
    fit: StrokeFit, candidate: Candidate, levels: tuple[float, float], anyway: bool = False
) -> tuple[np.ndarray, np.ndarray] | None:
    """The best answer of a candidate; None where it is far off by an estimate, or on the few rows that it is tried on, unless it is wanted
    anyway."""
    count, fineness = min(fit.bounds[0].size, MOST_TRIED), abs(levels[1] - levels[0]) / fit.at.rows.errors[0]
    estimated, most = (np.inf if anyway else (TRIED + (off * fineness) ** 2) * count for off in (ESTIMATED, SOLVED))
    estimates = fit.estimates(candidate, levels)
    if not estimates or (not candidate.open and estimates[0][0] > estimated):
        return None
    tried = []
    for _, each in estimates[: STARTS if candidate.open else 1]:
        p, chi2, _, count = fit.solve([candidate], each, MOST_TRIED, 200, NEAR)
        tried.append((chi2, p.tolist()))
        if chi2 < 2.0 * count or chi2 > HOPELESS * estimated:
            break
    chi2, start = min(tried)
    if chi2 > most:
        return None
    p, _, spread, _ = fit.solve([candidate], start, MOST_COMPARED, 60, 1e-15 if fit.at.rows.exact else CLOSE)
    return p, spread


def _stroke(fit: StrokeFit, found: _Fitting) -> Stroke:
    p, candidate = found.p.tolist(), found.candidate
    (ends, levels, _), *_ = fit.models([candidate], p)
    spread = (float(found.spread[0]), float(found.spread[1]))
    return Stroke(
        fit.rests[0], fit.rests[1], candidate, *ends, *levels, tuple(p[len(p) - candidate.open :]), spread, found.chi2
    )


# -- strokes that join at reversals -----------------------------------------------------------------------


def joined(at: Turned, strokes: Sequence[Stroke]) -> list[Stroke] | None:
    """Recognised strokes that follow on each other at reversals, fitted together; None where they do not fit so. Angles and levels are
    rounded as far as their errors leave them open, and of curves with open fractions the acceleration is that of both sides where they
    nearly join, where all rows agree with that."""
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
    k = len(angles) + len(opened)
    if k == len(p):
        rounded = np.array([shortest(float(each), float(by)) for each, by in zip(p, spread, strict=True)])
        p = rounded if fit.fits(chosen, rounded)[0] else p
    elif places := fit.nearly(chosen, p):
        smooth, _, by, _ = fit.solve(chosen, p.tolist(), MOST_REFINED, smooth=places)
        p, spread = (smooth, by) if fit.fits(chosen, smooth)[0] else (p, spread)
    if chi2 > 2.0 * sum(each.chi2 for each in strokes) and not fit.fits(chosen, p)[0]:
        return None
    made = []
    place = k
    for i, ((ends, levels2, _), each) in enumerate(zip(fit.models(chosen, p.tolist()), strokes, strict=True)):
        fractions = tuple(p[place : place + each.candidate.open].tolist())
        place += each.candidate.open
        errors = (float(spread[i]), float(spread[i + 1]))
        made.append(Stroke(each.left, each.right, each.candidate, *ends, *levels2, fractions, errors, chi2))
    return made


__all__ = ["EXACT", "Candidate", "Stroke", "joined", "recognise", "tiers"]
