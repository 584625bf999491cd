"""Recognition of the law, or the sequence of elementary curves, of a measured stroke, with its span and rise.

A stroke goes from rest to rest. Its model is

    s = y₀ + (y₁ - y₀) S((θ - θ₀)/(θ₁ - θ₀)),   S the law, y = y₀ before θ₀ and y₁ after θ₁ where a dwell is there,

fitted by least squares in the angles θ₀, θ₁, the level of a reversal, and the open parameters of the law. A law is
accepted where χ² agrees with the errors and no row is far from it; a named law only where no other fits as well.
Families of laws are tried where no named law fits.

First every law is estimated: in the inverse function, u of a row's fraction of the rise, the model is linear in θ₀ and
θ₁ - θ₀, so that a linear regression gives both and χ². Laws with a large estimate of χ² are not fitted.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

import numpy as np

from core.laws import PieceTable
from core.measured.candidates import Candidate, Stroke, candidate_law, inverse_laws, named_candidate, tiers
from core.measured.strokes import Rest, UnrolledRows, shortest
from core.numerics.lazy import checkpoint

FAR = 5.0  # largest residual of a row, in errors
HOPELESS = 25.0  # multiple of the largest χ² of a trial, above which other starts are not tried
WELL = 10.0  # difference of χ², below which two laws fit equally well
MOST_TRIED, MOST_COMPARED, MOST_REFINED = 150, 2000, 20_000
TRIED = 4.0  # largest χ² per row of a trial
ESTIMATED, SOLVED = 1e-4, 1e-7  # error of an estimate, and of a fit to few rows, relative to the rise
STARTS = 2  # estimates of a family from which it is fitted
LEVEL_TOLERANCE = 0.05  # largest distance of the level of a reversal from its row, relative to the rise
SAME_CURVE = 5e-4  # distance of two curves relative to the rise, below which they are equal
PASSED = 0.03  # fractions of the rise next to its ends whose rows say little about the law
NEAR, CLOSE = 1e-3, 1e-10  # relative change of χ² at the end of a trial, and of a fit to rows with errors
STEP = 1e-7  # of a fraction, for difference quotients
NEARLY = 0.02  # relative jump of the acceleration at a reversal, below which it is removed
STIFF = 1e6  # weight of such a jump in errors
FEWEST = 8  # least number of rows of a recognised stroke

# -- single stroke ----------------------------------------------------------------------------------------


class StrokeFit:
    """Rows of one stroke, or of several between which are reversals, and the models fitted to them.

    Attributes
    ----------
    rests : rests in order, one more than strokes; the inner ones are reversals
    """

    def __init__(self, at: UnrolledRows, rests: Sequence[Rest]) -> None:
        self.at, self.rests = at, rests
        self.bounds = [self._bounds(a, b) for a, b in pairwise(rests)]

    def _bounds(self, left: Rest, right: Rest) -> np.ndarray:
        """Rows of a stroke: with a part of the dwells next to it, without those next to a reversal."""
        first, last = left.last, right.first
        more = max(4, (last - first) // 4)
        # half of a dwell only, because the next stroke may leave it slowly
        first = max((left.first + left.last + 1) // 2, first - more) if left.level is not None else first + 1
        last = min((right.first + right.last) // 2, last + more) if right.level is not None else last - 1
        first = max(first, last - self.at.count + 1)
        return np.arange(first, last + 1)

    def rows(self, most: int) -> list[np.ndarray]:
        """Row numbers of each stroke.

        Parameters
        ----------
        most : int
            Greatest number of rows per stroke.

        Returns
        -------
        list of ndarray (m,), dimensionless
        """
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
        """Least squares fit of [angles of the rests, levels of the reversals, open fractions].

        Parameters
        ----------
        chosen : sequence of Candidate
            Law of each stroke.
        start : sequence of float
            Initial parameters.
        most : int
            Greatest number of rows per stroke.
        steps : int
            Greatest number of evaluations.
        within : float
            Relative change of χ² at which the fit ends.
        smooth : sequence of int
            Numbers of the reversals where the acceleration is continuous.

        Returns
        -------
        parameters : ndarray (p,) [deg], [unit of the motion], dimensionless
        chi2 : float
        spread : ndarray (p,) [deg], [unit of the motion], dimensionless
            Standard errors.
        count : int
            Number of rows.
        """
        from scipy.optimize import least_squares

        problem = _Problem(self, chosen, self.rows(most), smooth)
        solution = least_squares(
            problem.residuals,
            start,
            problem.slopes,
            x_scale=self._scale(chosen, start),
            ftol=within,
            xtol=1e-15,
            gtol=1e-15,
            max_nfev=steps,
        )
        return solution.x, 2.0 * float(solution.cost), _spread(solution.jac), problem.count

    def estimates(self, candidate: Candidate, levels: tuple[float, float]) -> list[tuple[float, list[float]]]:
        """χ² and initial parameters for the tried fractions of a law, best first; empty for very few rows.

        In the inverse function a row at x has u(share) of its law: x = θ₀ + (θ₁ - θ₀) u. An error d in the level of a
        reversal changes u by -d (1 - share)/s' at the lower end, by -d share/s' at the upper end.
        """
        at, (low, high) = self.at, levels
        (rows,) = self.rows(MOST_TRIED)
        share = (at.values[0][rows] - low) / (high - low)
        least = max(PASSED, 3.0 * at.rows.errors[0] / abs(high - low))
        is_informative = (share > least) & (share < 1.0 - least)
        x, share = at.x[rows][is_informative], share[is_informative]
        level_effects = [
            effect for effect, rest in zip((1.0 - share, share), self.rests, strict=True) if rest.level is None
        ]
        if x.size < 2 + len(level_effects):
            return []
        u, slope = inverse_laws(candidate, share)
        columns = np.stack([slope, slope * u, *(np.broadcast_to(-effect, u.shape) for effect in level_effects)], axis=1)
        right = (slope * (x - x[0]))[:, :, None]
        square = columns @ columns.swapaxes(1, 2)
        ridge = np.diag([1e-13, 1e-13, *(1e-9 for _ in level_effects)])  # the ends of a straight line are undetermined
        square += np.trace(square, axis1=1, axis2=2)[:, None, None] * ridge
        solution = np.linalg.solve(square, columns @ right)
        residual = ((right - columns.swapaxes(1, 2) @ solution) ** 2).sum(axis=(1, 2))
        result = []
        for fractions, (begin, span, *level_errors), square_sum in zip(
            candidate.tried, solution[:, :, 0].tolist(), residual.tolist(), strict=True
        ):
            if span <= 0.0 or max(map(abs, level_errors), default=0.0) > LEVEL_TOLERANCE * span:
                continue
            inner = iter(error * (high - low) / span for error in level_errors)
            free_levels = [
                level + next(inner) for level, rest in zip(levels, self.rests, strict=True) if rest.level is None
            ]
            start = float(x[0]) + begin
            result.append(
                (
                    square_sum * ((high - low) / (span * at.rows.errors[0])) ** 2,
                    [start, start + span, *free_levels, *fractions],
                )
            )
        return sorted(result)

    def nearly_smooth(self, chosen: Sequence[Candidate], p: np.ndarray) -> list[int]:
        """Numbers of the reversals where the acceleration hardly jumps.

        Parameters
        ----------
        chosen : sequence of Candidate
        p : ndarray (p,) [deg], [unit of the motion], dimensionless
            Parameters as in `solve`.

        Returns
        -------
        list of int
        """
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
        """Ends, levels and curve of each stroke."""
        n = len(self.rests)
        angles, remaining = list(p[:n]), list(p[n:])
        levels = [rest.level if rest.level is not None else remaining.pop(0) for rest in self.rests]
        for i, candidate in enumerate(chosen):
            fractions, remaining = remaining[: candidate.open], remaining[candidate.open :]
            yield (angles[i], angles[i + 1]), (levels[i], levels[i + 1]), candidate.table(fractions)

    def fits(self, chosen: Sequence[Candidate], p: np.ndarray) -> tuple[bool, float]:
        """Whether all columns agree with the model within their errors, and χ² of all rows.

        Rows beyond a reversal are included as far as the law extends; at a jump a row may be on either side.

        Parameters
        ----------
        chosen : sequence of Candidate
        p : ndarray (p,) [deg], [unit of the motion], dimensionless
            Parameters as in `solve`.

        Returns
        -------
        tuple of bool and float
        """
        chi2, count = 0.0, 0
        for rows, (ends, levels, table) in zip(self.bounds, self.models(chosen, p.tolist()), strict=True):
            if table is None:
                return False, np.inf
            first, after = np.searchsorted(self.at.x, ends)
            first, last = min(int(first), int(rows[0])), max(int(after) - 1, int(rows[-1]))
            if last - first >= self.at.count:
                return False, np.inf
            rows = np.concatenate((np.arange(first, rows[0] - 2), rows, np.arange(rows[-1] + 3, last + 1)))
            sides = [
                np.abs(_Model(self.at, rows, ends, levels, table, shift).residuals((0, 1, 2)))
                for shift in ((0.0, 1e-7, -1e-7) if self.at.rows.exact else (0.0,))
            ]
            residuals = np.fmin.reduce(sides)
            if 2 in self.at.values:  # a row at a jump may be on either side of the join
                is_near_join = np.abs(self.at.x[rows][:, None] - np.array(ends)).min(axis=1) < 3.0 * np.median(
                    np.diff(self.at.x[rows])
                )
                residuals[-1][is_near_join] = (
                    np.minimum(residuals[-1][is_near_join], 1.0)
                    if not self.at.rows.exact
                    else residuals[-1][is_near_join]
                )
            residuals = np.nan_to_num(residuals, nan=0.0)
            if residuals.max() > FAR:
                return False, np.inf
            chi2 += float((residuals**2).sum())
            count += int(residuals.size)
        return chi2 <= count + 5.0 * sqrt(2.0 * count), chi2


class _Problem:
    """Residuals of the rows of strokes, of the angles of reversals, and of acceleration jumps that should be 0.

    Parameters are [angles of the rests, levels of the reversals, open fractions]. The angle of a reversal is that of
    its row within the distance of its neighbours, which matters where nothing else determines it.
    """

    def __init__(
        self, fit: StrokeFit, chosen: Sequence[Candidate], rows: Sequence[np.ndarray], smooth: Sequence[int]
    ) -> None:
        self.fit, self.chosen, self.rows, self.smooth = fit, chosen, rows, smooth
        self.count = sum(stroke_rows.size for stroke_rows in rows) * sum(order in fit.at.values for order in (0, 1))
        self.opened = [i for i, rest in enumerate(fit.rests) if rest.level is None]
        x, reversals = fit.at.x, [fit.rests[i] for i in self.opened]
        self.turns = np.array([x[rest.last] for rest in reversals])
        self.reach = np.array(
            [0.5 * (x[min(rest.last + 1, x.size - 1)] - x[max(rest.first - 1, 0)]) for rest in reversals]
        )
        self.last: tuple[bytes, list[_Model] | None] = b"", None  # slopes follow residuals at the same parameters

    def models(self, p: np.ndarray) -> list[_Model] | None:
        """Model of each stroke; None where one is invalid.

        Parameters
        ----------
        p : ndarray (p,) [deg], [unit of the motion], dimensionless

        Returns
        -------
        list of _Model, or None
        """
        result = []
        for stroke_rows, (ends, levels, table) in zip(self.rows, self.fit.models(self.chosen, p.tolist()), strict=True):
            if table is None or ends[1] - ends[0] < 1e-3:
                return None
            result.append(_Model(self.fit.at, stroke_rows, ends, levels, table))
        return result

    def residuals(self, p: np.ndarray, store: bool = True) -> np.ndarray:
        """Residuals (n,), 1e12 where the models are invalid."""
        checkpoint()
        models = self.models(p)
        if store:
            self.last = p.tobytes(), models
        if models is None:
            return np.full(self.count + len(self.opened) + len(self.smooth), 1e12)
        residuals = np.nan_to_num(np.concatenate([model.residuals().ravel() for model in models]), nan=0.0)
        jumps = [STIFF * models[i].jump(models[i - 1]) for i in self.smooth]
        return np.concatenate((residuals, (p[self.opened] - self.turns) / self.reach, jumps))

    def slopes(self, p: np.ndarray) -> np.ndarray:
        """Derivatives (n, parameters) of the residuals; by fractions, and of jumps, as difference quotients."""
        n, count = len(self.fit.rests), self.count
        columns = {i: n + k for k, i in enumerate(self.opened)}
        jacobian = np.zeros((count + len(self.opened) + len(self.smooth), len(p)))
        jacobian[count + np.arange(len(self.opened)), self.opened] = 1.0 / self.reach
        first = 0
        for i, model in enumerate((self.last[1] if self.last[0] == p.tobytes() else self.models(p)) or ()):
            model_slopes = model.slopes()
            end = first + model_slopes.shape[1]
            for column, values in zip((i, i + 1, columns.get(i), columns.get(i + 1)), model_slopes, strict=True):
                if column is not None:
                    jacobian[first:end, column] += values
            first = end
        closed = n + len(self.opened)
        numeric = range(0 if self.smooth else closed, len(p))
        residuals = self.residuals(p, False) if numeric else p
        for column in numeric:
            shifted = p.copy()
            shifted[column] += STEP
            shifted_residuals = self.residuals(shifted, False)
            if shifted_residuals[0] == 1e12:  # outside the range of the fraction
                shifted[column] -= 2.0 * STEP
                shifted_residuals = self.residuals(shifted, False)
            begin = 0 if column >= closed else count + len(self.opened)
            jacobian[begin:, column] = (shifted_residuals - residuals)[begin:] / (shifted[column] - p[column])
        return np.nan_to_num(jacobian, nan=0.0)


class _Model:
    """Law of a stroke at some rows (n,), evaluated ``later`` degrees after each."""

    def __init__(
        self,
        at: UnrolledRows,
        rows: np.ndarray,
        ends: tuple[float, float],
        levels: tuple[float, float],
        table: PieceTable,
        later: float = 0.0,
    ) -> None:
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
        """Jump of the acceleration from the previous stroke to this one, relative to the larger acceleration."""
        left, right = before._acceleration(1.0), self._acceleration(0.0)
        return (right - left) / (max(abs(left), abs(right)) or 1.0)

    def residuals(self, orders: Sequence[int] = (0, 1)) -> np.ndarray:
        """Rows minus model of each column (k, n), in errors."""
        at, u, (low, high), result = self.at, self.u, self.levels, []
        for order in orders:
            if order not in at.values:
                continue
            y = self.law[order] * self._rise / self.span**order
            y = np.where(self.inside, y, 0.0) if order else np.where(u < 0.0, low, np.where(u >= 1.0, high, y + low))
            result.append((at.values[order][self.rows] - y) / at.rows.errors[order])
        return np.array(result)

    def slopes(self) -> np.ndarray:
        """Derivatives (4, k n) of the residuals by start, end, lower and upper level."""
        at, u, span, rise = self.at, self.u, self.span, self._rise
        begin, finish = (u - 1.0) / span, -u / span  # derivatives of u by start and end
        result = []
        for order in (0, 1):
            if order not in at.values:
                continue
            size, slope = np.where(self.inside, (self.law[order], self.law[order + 1]), 0.0) / span**order
            if order:
                derivatives = (rise * (slope * begin + size / span), rise * (slope * finish - size / span), -size, size)
            else:
                size = np.where(u >= 1.0, 1.0, size)
                derivatives = (rise * slope * begin, rise * slope * finish, 1.0 - size, size)
            is_finite = np.isfinite(at.values[order][self.rows])  # a missing cell has no weight
            result.append(np.where(is_finite, derivatives, 0.0) / -at.rows.errors[order])
        return np.concatenate(result, axis=1)


def _spread(jacobian: np.ndarray) -> np.ndarray:
    scale = np.sqrt((jacobian**2).sum(axis=0))
    scale[scale == 0.0] = 1.0
    inverse = np.linalg.pinv((jacobian / scale).T @ (jacobian / scale))
    return np.sqrt(np.abs(np.diag(inverse))) / scale


def recognise(at: UnrolledRows, left: Rest, right: Rest, required: str = "") -> tuple[Stroke | None, list[str]]:
    """Law of the stroke between two rests; and the names of several laws that fit equally well.

    ``required``: use this law, however well it fits.
    """
    fit = StrokeFit(at, (left, right))
    if fit.bounds[0].size < FEWEST:
        return None, []
    y = at.values[0]
    low = left.level if left.level is not None else float(y[left.last])
    high = right.level if right.level is not None else float(y[right.first])
    if abs(high - low) < 20.0 * at.rows.errors[0]:
        return None, []
    is_coarse = at.rows.errors[0] > SAME_CURVE * abs(
        high - low
    )  # a curve of a family may then be as close as a named law
    matches: list[_LawFit] = []
    for tier in ((named_candidate(required),),) if required else tiers(1.0 if high > low else -1.0):
        if matches and not is_coarse:
            break
        checkpoint()
        accepted: list[_LawFit] = []
        for candidate in tier:
            best = _best(fit, candidate, (low, high), bool(required))
            if best is None:
                continue
            agrees, chi2 = fit.fits([candidate], best[0])
            if agrees or required:
                accepted.append(_LawFit(chi2, candidate, *best))
        accepted.sort(key=lambda match: match.chi2)
        if matches:
            matches += [match for match in accepted if not _is_same_within_error(fit, matches[0], match)]
        elif accepted:
            matches = [accepted[0], *(match for match in accepted[1:] if not _is_same_curve(accepted[0], match))]
    if not matches:
        return None, []
    first, *other_matches = matches
    tolerance = WELL * max(1.0, fit.bounds[0].size / MOST_COMPARED)  # for the rows that are not used in the fit
    rivals = [match.candidate.name for match in other_matches if match.chi2 - first.chi2 <= tolerance]
    return (None, [first.candidate.name, *rivals]) if rivals else (_stroke(fit, first), [])


class _LawFit(NamedTuple):
    """Fit of a law: χ², angles, levels and fractions, and their standard errors."""

    chi2: float
    candidate: Candidate
    p: np.ndarray
    spread: np.ndarray


def _is_same_curve(left: _LawFit, right: _LawFit) -> bool:
    """Whether two laws are the same curve under two names."""
    u = np.linspace(0.0, 1.0, 33)
    first, second = (
        candidate_law(fit.candidate, fit.p[len(fit.p) - fit.candidate.open :].tolist()).at(u)[0]
        for fit in (left, right)
    )
    return bool(np.abs(first - second).max() < 1e-9)


def _is_same_within_error(fit: StrokeFit, left: _LawFit, right: _LawFit) -> bool:
    """Whether two laws are equal within the error, as a family and a law that it contains."""
    (rows,) = fit.rows(MOST_TRIED)
    first, second = (
        _Model(fit.at, rows, ends, levels, table).residuals((0,))
        for law_fit in (left, right)
        for ends, levels, table in fit.models([law_fit.candidate], law_fit.p.tolist())
        if table
    )
    return bool(np.nanmax(np.abs(first - second)) <= 1.0)


def _best(
    fit: StrokeFit, candidate: Candidate, levels: tuple[float, float], is_required: bool = False
) -> tuple[np.ndarray, np.ndarray] | None:
    """Best fit of a candidate; None where it is far off by its estimate, or on few rows, unless it is required."""
    count, fineness = min(fit.bounds[0].size, MOST_TRIED), abs(levels[1] - levels[0]) / fit.at.rows.errors[0]
    estimated, most = (
        np.inf if is_required else (TRIED + (relative_error * fineness) ** 2) * count
        for relative_error in (ESTIMATED, SOLVED)
    )
    estimates = fit.estimates(candidate, levels)
    if not estimates or (not candidate.open and estimates[0][0] > estimated):
        return None
    tried = []
    for _, estimate in estimates[: STARTS if candidate.open else 1]:
        p, chi2, _, count = fit.solve([candidate], estimate, MOST_TRIED, 200, NEAR)
        tried.append((chi2, p.tolist()))
        if chi2 < 2.0 * count or chi2 > HOPELESS * estimated:
            break
    chi2, start = min(tried)
    if chi2 > most:
        return None
    p, _, spread, _ = fit.solve([candidate], start, MOST_COMPARED, 60, 1e-15 if fit.at.rows.exact else CLOSE)
    return p, spread


def _stroke(fit: StrokeFit, law_fit: _LawFit) -> Stroke:
    p, candidate = law_fit.p.tolist(), law_fit.candidate
    (ends, levels, _), *_ = fit.models([candidate], p)
    spread = (float(law_fit.spread[0]), float(law_fit.spread[1]))
    return Stroke(
        fit.rests[0], fit.rests[1], candidate, *ends, *levels, tuple(p[len(p) - candidate.open :]), spread, law_fit.chi2
    )


# -- strokes joined at reversals --------------------------------------------------------------------------


def fitted_together(at: UnrolledRows, strokes: Sequence[Stroke]) -> list[Stroke] | None:
    """Recognised strokes between which are reversals, fitted together; None where they do not fit.

    Angles and levels are rounded within their errors. Where the accelerations of curves with open fractions almost
    agree at a reversal, they are made equal if all rows agree.
    """
    fit = StrokeFit(at, (*(stroke.left for stroke in strokes), strokes[-1].right))
    chosen = [stroke.candidate for stroke in strokes]
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
    free_levels = [level for level, rest in zip(levels, fit.rests, strict=True) if rest.level is None]
    start = [*angles, *free_levels, *(f for stroke in strokes for f in stroke.fractions)]
    p, chi2, spread, _ = fit.solve(chosen, start, MOST_REFINED)
    k = len(angles) + len(free_levels)
    if k == len(p):
        rounded = np.array([shortest(float(value), float(error)) for value, error in zip(p, spread, strict=True)])
        p = rounded if fit.fits(chosen, rounded)[0] else p
    elif reversals := fit.nearly_smooth(chosen, p):
        smooth, _, smooth_spread, _ = fit.solve(chosen, p.tolist(), MOST_REFINED, smooth=reversals)
        p, spread = (smooth, smooth_spread) if fit.fits(chosen, smooth)[0] else (p, spread)
    if chi2 > 2.0 * sum(stroke.chi2 for stroke in strokes) and not fit.fits(chosen, p)[0]:
        return None
    result = []
    offset = k
    for i, ((ends, levels2, _), stroke) in enumerate(zip(fit.models(chosen, p.tolist()), strokes, strict=True)):
        fractions = tuple(p[offset : offset + stroke.candidate.open].tolist())
        offset += stroke.candidate.open
        errors = (float(spread[i]), float(spread[i + 1]))
        result.append(Stroke(stroke.left, stroke.right, stroke.candidate, *ends, *levels2, fractions, errors, chi2))
    return result
