"""Search from a single start: SLSQP in epigraph form (``epigraph``), in rounds, with the peaks over the turn of all solutions so far.

The largest value of a quantity over the turn is not smooth where one peak overtakes another. Therefore a bound t is minimised such
that f(θ_j; x) <= t at all peaks θ_j; a limit, too, holds at every peak. Peaks move with the design: those of the solution are added,
and the problem is solved again, until no peak of the solution exceeds t or a limit (exchange method, Hettich and Kortanek 1993).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from core.design import Design, get
from core.errors import KindynaError
from core.frozen import frozen
from core.study import many
from core.study.batch import design_block, is_batchable
from core.study.highest import clenshaw_curtis_nodes
from core.study.quantity_requests import QuantityRequest, quantity_request
from core.study.stages_of_many import DesignBlock
from core.varying.request import Goal, StudyOfMany, StudyQuantity
from core.varying.space import Axis, constant_column
from core.varying.tolerances import bounds_of

# -- minimax by SLSQP -------------------------------------------------------------------------------------------


MAX_STEPS = 30  # of SLSQP in a round
FINE, COARSE = 1e-13, 1e-4  # accuracy of SLSQP: of rounds that end the search, and of rounds far from the solution


def epigraph(
    rows: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], bound: np.ndarray, scale: np.ndarray, start: np.ndarray,
    low: np.ndarray, high: np.ndarray, inset: float = 0.0, accuracy: float = FINE,
) -> np.ndarray:  # fmt: skip
    """Minimax with bounds by SLSQP: minimise t subject to t - f_j(x) >= 0 and b_j - f_j(x) >= 0.

    Parameters
    ----------
    rows : callable
        Point (k,) -> values f (c,) and slopes (c, k) [unit of f].
    bound : ndarray (c,) [unit of f]
        Bounds b; NaN for the functions whose largest is minimised.
    scale : ndarray (c,) [unit of f]
        Scales of the bounds.
    start, low, high : ndarray (k,), dimensionless
        Start, and bounds of x.
    inset : float
        Distance below its bound, by its scale, that every bounded function must keep.
    accuracy : float
        Change of t, by its size, at which SLSQP ends.

    Returns
    -------
    ndarray (k,), dimensionless
        The solution; the start where the functions have no value there, or at the solution.

    References
    ----------
    Kraft (1988), A software package for sequential quadratic programming.
    """
    from scipy.optimize import minimize

    k, is_goal = start.size, np.isnan(bound)
    memory: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def cached_rows(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = z[:k].tobytes()
        if key not in memory:
            memory[key] = rows(z[:k])
        return memory[key]

    value, slope = cached_rows(start)
    if not np.isfinite(value).all():
        return start
    size = max(float(np.abs(value[is_goal]).max()), float(np.abs(slope[is_goal] * (high - low)).max())) or 1.0
    scale = np.where(is_goal, size, scale)

    def constraints(z: np.ndarray) -> np.ndarray:
        value, _ = cached_rows(z)
        margin = np.where(is_goal, z[k] - value / scale, (bound - value) / scale - inset)
        return np.where(np.isfinite(margin), margin, -1e2)

    def jacobian(z: np.ndarray) -> np.ndarray:
        slopes = np.hstack([-cached_rows(z)[1] / scale[:, None], is_goal[:, None].astype(float)])
        return np.where(np.isfinite(slopes), slopes, 0.0)

    t, gradient = float((value / scale)[is_goal].max()), np.append(np.zeros(k), 1.0)
    result = minimize(
        lambda z: float(z[k]), np.append(start, t), jac=lambda z: gradient, method="SLSQP",
        bounds=[*zip(low, high, strict=True), (None, None)],
        constraints=[{"type": "ineq", "fun": constraints, "jac": jacobian}], options={"maxiter": MAX_STEPS, "ftol": accuracy},
    )  # fmt: skip
    solution = np.clip(result.x[:k], low, high)
    return solution if np.isfinite(solution).all() and np.isfinite(cached_rows(solution)[0]).all() else start


# -- search from a single start ---------------------------------------------------------------------------------


ROUNDS = 25  # of adding peaks
STEP = 1e-5  # of the interval between the bounds: for slopes at fixed angles
SEARCH_STEP = 3e-4  # the same, where extremes are searched again
TRUST = 0.25  # of the bounds: longest step of a round
TRUST_FACTOR, MIN_TRUST = (
    0.1,
    1e-3,
)  # reduction where a round makes no progress, as at the edge of the buildable designs
TOLERANCE = 1e-9  # of the bounds: a round that moves less is the last
SLIGHT_EXCESS = 1e-5  # of a limit: a smaller excess is removed by a larger inset
INSET = 1e-9  # of a limit: solutions keep it by this margin
NEAR_TOP = 0.3  # of the range of a quantity: lower peaks are left out
MAX_PEAKS, PEAK_PASSES = 8, 5
NEAR_SOLUTION = 0.9  # of the longest step: a shorter one ends near the solution, so that the next rounds are accurate
SAME_PLACE = 1e-3  # of the bounds: nearer to a solution of another start a search ends there

ProgressCallback = Callable[[Mapping[str, Any], float, int], None]
"""Called with the fields of an intermediate design, its goal, and the number of its start; an exception stops the search."""


@frozen(eq=False)
class Term:
    """A figure with an upper bound, ``side`` times a quantity over the turn: a limit, or the goal, whose bound is t.

    Attributes
    ----------
    row : StudyQuantity
    request : QuantityRequest
    side : float
        +1 for an upper limit or a minimised goal, else -1.
    bound : float or None
        None for the goal.
    peaks : tuple of float
        Signs of the quantity whose peaks over the turn are all constrained; empty where a single value is.
    radius : float [mm]
        Roller radius r, for the curvature of a profile; else 0.
    """

    row: StudyQuantity
    request: QuantityRequest
    side: float
    bound: float | None
    peaks: tuple[float, ...]
    radius: float = 0.0

    def smoothed(self, value: Any) -> Any:
        """A value in a form without poles: of a profile's curvature κ that of the pitch curve, κ/(1 + κ r), 1/r at a cusp."""
        if not self.radius:
            return value
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(np.isinf(value), 1.0 / self.radius, value / (1.0 + value * self.radius))


Peaks = dict[int, list[tuple[float, int, float]]]
"""Number of a term with peaks -> its peaks: cam angle [rad], piece, sign."""


class _PeakSearch:
    """Brackets (b,) of the peaks of a term with one sign: cam angles from ``low`` to ``high`` [rad] in a piece.

    Every pass narrows them to a quarter; a kink, where friction reverses, has a peak on both sides.
    """

    def __init__(self, term: int, sign: float, low: np.ndarray, high: np.ndarray, piece: np.ndarray) -> None:
        self.term, self.sign, self.low, self.high, self.piece = term, sign, low, high, piece
        self._height, self._theta = np.empty(0), np.empty(0)

    def samples(self) -> np.ndarray:
        """Cam angles (b, 9) [rad] at which the term is evaluated."""
        return np.asarray(self.low[:, None] + (self.high - self.low)[:, None] * np.linspace(0.0, 1.0, 9))

    def narrow(self, samples: np.ndarray, values: np.ndarray) -> None:
        """Narrow the brackets to the neighbours of the peaks among the values (b, 9) at the samples."""
        g = np.pad(self.sign * values, ((0, 0), (1, 1)), constant_values=-np.inf)
        rows, top = np.nonzero((g[:, 1:-1] > g[:, :-2]) & (g[:, 1:-1] >= g[:, 2:]))
        self.low, self.high = samples[rows, np.maximum(top - 1, 0)], samples[rows, np.minimum(top + 1, 8)]
        self._height, self._theta, self.piece = g[rows, top + 1], samples[rows, top], self.piece[rows]

    def peaks(self) -> list[tuple[float, float, int, float]]:
        """Height, cam angle [rad], piece and sign of every peak."""
        rows = zip(self._height.tolist(), self._theta.tolist(), self.piece.tolist(), strict=True)
        return [(height, theta, piece, self.sign) for height, theta, piece in rows]


class Descent:
    """Local search over the numbers of a design with fixed words; coordinates u go from 0 to 1 between the bounds."""

    def __init__(
        self, study: StudyOfMany, design: Design, words: Mapping[str, Any], numbers: Sequence[Axis],
        margins: Mapping[str, float], progress: ProgressCallback | None, starts: int,
    ) -> None:  # fmt: skip
        self.study, self.design, self.words, self.progress, self.max_starts = study, design, words, progress, starts
        self._start_count = 0
        self.paths = tuple(axis.field for axis in numbers)
        ends = [(min(axis.listed), max(axis.listed)) if axis.listed else (axis.low, axis.high) for axis in numbers]
        self.low, self.high = (np.array([end[i] for end in ends], dtype=float) for i in (0, 1))
        self.terms = [self._term(row, side, bound) for row, side, bound in self._limits(margins)]
        goals = study.file.goals
        self.goals = [self._term(goal, goal_sign(goal), None) for goal in goals]
        self.nominal = (np.array([float(get(design, path)) for path in self.paths]) - self.low) / (self.high - self.low)

    def _limits(self, margins: Mapping[str, float]) -> Iterator[tuple[StudyQuantity, float, float]]:
        for limit, side, bound in bounds_of(self.study.file.limits):
            yield limit, side, side * bound - margins.get(limit.key, 0.0)

    def _term(self, row: StudyQuantity, side: float, bound: float | None) -> Term:
        request = quantity_request(self.design, row.key)
        signs = {("max", 1.0): (1.0,), ("min", -1.0): (-1.0,), ("abs", 1.0): (1.0, -1.0)}.get(
            (request.statistic, side), ()
        )
        if signs and not self._has_common_angles(request):
            signs = ()
        face = self.design.drives[request.drive or 0].face if request.name == "profile_curvature" else None
        return Term(row, request, side, bound, signs, float(getattr(face, "radius_mm", 0.0)))

    def _has_common_angles(self, request: QuantityRequest) -> bool:
        """Whether designs can be evaluated in a block, at common cam angles."""
        if request.drive is not None or not request.name or not is_batchable(self.design, self.paths, request):
            return False
        middle = self._numbers(np.full((len(self.paths), 1), 0.5))
        return not design_block(self.design, self.paths, middle).separate.any()

    def _numbers(self, u: np.ndarray) -> np.ndarray:
        """Numbers of the fields (k, m) at coordinates u (k, m)."""
        return self.low[:, None] + u * (self.high - self.low)[:, None]

    # -- values -------------------------------------------------------------------------------------------

    def values(self, u: np.ndarray, polish: bool = True) -> tuple[np.ndarray, np.ndarray]:
        """Values of all terms, the limits first, for several designs.

        Parameters
        ----------
        u : ndarray (k, m), dimensionless
            Coordinates of m designs.
        polish : bool
            Refine the extremes.

        Returns
        -------
        rows : ndarray (t, m) [unit of the figure]
            ``side`` times the figures of the t terms.
        good : ndarray (m,), dimensionless
            Mask of designs that can be built.
        """
        keys = list(dict.fromkeys(term.row.key for term in [*self.terms, *self.goals]))
        numbers = dict(zip(self.paths, self._numbers(u), strict=True)) or constant_column(self.design, u.shape[1])
        results = many(self.design, numbers, keys, polish=polish)
        rows = np.array([term.side * results.value[term.row.key] for term in [*self.terms, *self.goals]])
        return rows, np.asarray(results.reason == "")

    def excess(self, rows: np.ndarray, good: np.ndarray) -> np.ndarray:
        """Greatest excess over the limits, as a part of the limit.

        Parameters
        ----------
        rows : ndarray (t, m) [unit of the figure]
        good : ndarray (m,), dimensionless
            As returned by ``values``.

        Returns
        -------
        ndarray (m,), dimensionless
            Infinite where a goal has no value, above 1000 where a design cannot be built.
        """
        over = np.zeros(rows.shape[1])
        for term, row in zip(self.terms, rows, strict=False):
            assert term.bound is not None, "a limit"
            excess = (term.smoothed(term.side * row) * term.side - self._smoothed_bound(term)) / self._scale(term)
            over = np.maximum(over, excess)
        over = np.where(np.isfinite(rows[len(self.terms) :]).all(axis=0), over, np.inf)
        return np.where(good & np.isfinite(over), over, np.where(np.isfinite(over), 1e3 + over, np.inf))

    def _smoothed_bound(self, term: Term) -> float:
        assert term.bound is not None, "a limit"
        return float(term.side * term.smoothed(term.side * term.bound))

    def _scale(self, term: Term) -> float:
        return abs(self._smoothed_bound(term)) or 1.0

    def _block(self, u: np.ndarray) -> DesignBlock:
        """Block of the designs u (k, m)."""
        return design_block(self.design, self.paths, self._numbers(u))

    def _at(
        self, block: DesignBlock, angles: Sequence[tuple[np.ndarray, np.ndarray]], terms: Sequence[Term]
    ) -> list[np.ndarray]:
        """Quantities of terms (m, n), each at its angles (theta, piece), of m designs; NaN where a design fails."""
        theta, piece = (np.concatenate([at[i] for at in angles]) for i in (0, 1))
        n, m = theta.size, block.count
        owner = np.repeat(np.arange(m), n)
        names = list(dict.fromkeys(term.request.name for term in terms))
        state = block.state(np.tile(theta, m), np.tile(piece, m), owner)
        values = block.values(names, state, owner)
        failed = block.failed_at("dynamics" if any(_needs_forces(term) for term in terms) else "cam")
        rows, first = [], 0
        for term, (at, _) in zip(terms, angles, strict=True):
            row = values[term.request.name].reshape(m, n)[:, first : first + at.size] / term.request.unit
            rows.append(np.where(failed[:, None], np.nan, row))
            first += at.size
        return rows

    def peaks(self, u: np.ndarray, terms: Sequence[Term]) -> list[list[tuple[float, int, float]]]:
        """Highest peaks of every term over the turn of a design.

        Parameters
        ----------
        u : ndarray (k,), dimensionless
            Coordinates of the design.
        terms : sequence of Term

        Returns
        -------
        list of list of (float, int, float)
            Of every term: cam angle [rad], piece and sign of its peaks.
        """
        block = self._block(u[:, None])
        nodes, _ = clenshaw_curtis_nodes(block.program)
        theta, piece = nodes.theta, nodes.piece
        every = self._at(block, [(theta, piece)] * len(terms), terms)
        first = np.append(True, np.diff(piece) != 0)
        last = np.append(np.diff(piece) != 0, True)
        searches: list[_PeakSearch] = []
        for number, (term, row) in enumerate(zip(terms, every, strict=True)):
            values = term.smoothed(row[0])
            spread = float(np.ptp(values)) if np.isfinite(values).all() else np.inf
            for sign in term.peaks:
                f = sign * values
                left, right = np.where(first, -np.inf, np.roll(f, 1)), np.where(last, -np.inf, np.roll(f, -1))
                local = np.flatnonzero((f >= left) & (f >= right) & (f >= f.max() - NEAR_TOP * spread))
                lo, hi = theta[np.where(first[local], local, local - 1)], theta[np.where(last[local], local, local + 1)]
                searches.append(_PeakSearch(number, sign, lo, hi, piece[local]))
        searches = [search for search in searches if search.low.size]
        for _ in range(PEAK_PASSES if searches else 0):
            samples = [search.samples() for search in searches]
            angles = [(at.ravel(), np.repeat(s.piece, at.shape[1])) for s, at in zip(searches, samples, strict=True)]
            rows = self._at(block, angles, [terms[search.term] for search in searches])
            for search, at, row in zip(searches, samples, rows, strict=True):
                search.narrow(at, terms[search.term].smoothed(row[0]).reshape(at.shape))
        result: list[list[tuple[float, int, float]]] = []
        for number in range(len(terms)):
            peaks = [peak for search in searches if search.term == number for peak in search.peaks()]
            result.append([(theta, piece, sign) for _, theta, piece, sign in sorted(peaks, reverse=True)[:MAX_PEAKS]])
        return result

    # -- rounds -------------------------------------------------------------------------------------------

    def solve(
        self, start: np.ndarray, goal: Term, extra: Sequence[Term] = (), known: Sequence[np.ndarray] = ()
    ) -> np.ndarray:
        """Local solution by rounds of SLSQP, each with the peaks of all solutions so far.

        Parameters
        ----------
        start : ndarray (k,), dimensionless
            Coordinates of the start.
        goal : Term
        extra : sequence of Term
            Further limits.
        known : sequence of ndarray (k,), dimensionless
            Solutions of other starts; a search that comes near one of them ends there.

        Returns
        -------
        ndarray (k,), dimensionless
        """
        terms = [*self.terms, *extra, goal]
        peaked = [term for term in terms if term.peaks]
        u = np.clip(start, 0.0, 1.0)
        peaks: Peaks = {}
        inset, trust, is_far, accuracy = INSET, TRUST, True, COARSE
        self._start_count += 1
        for _ in range(ROUNDS):
            self._report(u, goal)
            if not self._add_peaks(peaks, peaked, u):
                return u
            solution = self._round(u, terms, peaked, peaks, goal, inset, trust, accuracy)
            step = float(np.abs(solution - u).max())
            u = solution
            for place in known:
                if np.abs(u - place).max() < SAME_PLACE:
                    return place
            if accuracy > FINE and step < NEAR_SOLUTION * trust:
                accuracy = FINE
            elif step < TOLERANCE and is_far and trust > MIN_TRUST:
                trust *= TRUST_FACTOR
            elif step >= TOLERANCE:
                is_far = step > 0.5 * trust
            else:
                over = float(self.excess(*self.values(u[:, None]))[0])
                if not 0.0 < over < SLIGHT_EXCESS:
                    break
                inset += 2.0 * over
        return u

    def _report(self, u: np.ndarray, goal: Term) -> None:
        """Report an intermediate design."""
        if self.progress is not None:
            rows, _ = self.values(u[:, None], polish=False)
            at = len(self.terms) + [other.row for other in self.goals].index(goal.row)
            self.progress(self._fields(u), float(goal.side * rows[at, 0]), self._start_count)

    def _add_peaks(self, peaks: Peaks, peaked: Sequence[Term], u: np.ndarray) -> bool:
        """Add the peaks of a design, in place of peaks near them; False where a term has none."""
        try:
            new = self.peaks(u, peaked) if peaked else []
        except (ValueError, KindynaError):
            return False
        for i, rows in enumerate(new):
            others = peaks.get(i, [])
            for theta, piece, sign in rows:
                others = [peak for peak in others if abs(peak[0] - theta) > 2e-3 or peak[1:] != (piece, sign)]
            peaks[i] = ([*rows, *others])[: 3 * MAX_PEAKS]
        return all(peaks.get(i) for i in range(len(peaked)))

    def _round(
        self, u: np.ndarray, terms: Sequence[Term], peaked: Sequence[Term], peaks: Peaks,
        goal: Term, inset: float, trust: float, accuracy: float,
    ) -> np.ndarray:  # fmt: skip
        """SLSQP at fixed angles: minimise t subject to t - f_goal(θ_j) >= 0 and bound - f(θ_j) >= 0."""

        def rows(point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            _, values, slopes = zip(*self._linear(point, terms, peaks), strict=True)
            return np.concatenate(values), np.concatenate(slopes)

        owners = [term for term, values, _ in self._linear(u, terms, peaks) for _ in values]
        bound = np.array([np.nan if term is goal else self._smoothed_bound(term) for term in owners])
        scale = np.array([1.0 if term is goal else self._scale(term) for term in owners])
        return epigraph(rows, bound, scale, u, np.maximum(u - trust, 0.0), np.minimum(u + trust, 1.0), inset, accuracy)

    def _linear(self, u: np.ndarray, terms: Sequence[Term], peaks: Peaks) -> list[tuple[Term, np.ndarray, np.ndarray]]:
        """Every term with its values (n,) at its peaks, or its single value, and their slopes (n, k)."""
        k, result = u.size, []
        peaked, rest = [term for term in terms if term.peaks], [term for term in terms if not term.peaks]
        if peaked:
            angles = [
                (np.array([peak[0] for peak in peaks[p]]), np.array([peak[1] for peak in peaks[p]]))
                for p in range(len(peaked))
            ]
            every = self._at(self._block(_neighbours(u, STEP)), angles, peaked)
            for p, (term, values) in enumerate(zip(peaked, every, strict=True)):
                f = np.array([sign for _, _, sign in peaks[p]]) * term.smoothed(values)
                result.append((term, f[0], (f[1 : k + 1] - f[k + 1 :]).T / (2.0 * STEP)))
        if rest:
            numbers = dict(zip(self.paths, self._numbers(_neighbours(u, SEARCH_STEP)), strict=True))
            figures = many(self.design, numbers, [term.row.key for term in rest]).value
            for term in rest:
                f = term.side * term.smoothed(figures[term.row.key])
                result.append((term, f[:1], (f[1 : k + 1] - f[k + 1 :])[None] / (2.0 * SEARCH_STEP)))
        return result

    def _fields(self, u: np.ndarray) -> dict[str, Any]:
        """Values of the varied fields at coordinates (k,), in the order of the study."""
        numbers = self._numbers(u[:, None])[:, 0].tolist()
        order = [row.field for row in self.study.file.vary]
        values = {**self.words, **dict(zip(self.paths, numbers, strict=True))}
        return {field: values[field] for field in order}


def goal_sign(goal: Goal) -> float:
    """1 for a goal to be minimised, -1 for one to be maximised."""
    return 1.0 if goal.minimise else -1.0


def _needs_forces(term: Term) -> bool:
    from core.study.quantities import quantity

    return quantity(term.request.name).stage == "dynamics"


def _neighbours(u: np.ndarray, step: float) -> np.ndarray:
    """A point (k,) and its neighbours (k, 1 + 2 k), first upwards, then downwards."""
    steps = step * np.eye(u.size)
    return np.hstack([u[:, None], u[:, None] + steps, u[:, None] - steps])
