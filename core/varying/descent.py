"""Search from a single start: SLSQP in epigraph form (``epigraph``), in rounds, with the peaks over the turn of all solutions so far.

The largest value of a quantity over the turn is not smooth where one peak overtakes another. Therefore a bound t is minimised such
that f(θ_j; x) <= t at all peaks θ_j; a limit, too, holds at every peak. Peaks move with the design: those of the solution are added,
and the problem is solved again, until no peak of the solution exceeds t or a limit (exchange method, Hettich and Kortanek 1993).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property, partial
from typing import Any

import numpy as np

from core.design import Design, get, only
from core.errors import KindynaError
from core.motion import Angles
from core.numerics.lazy import checkpoint
from core.study import Study, many
from core.study.batch import design_block, is_batchable, paths_inside
from core.study.highest import clenshaw_curtis_nodes
from core.study.limits import SPEEDS
from core.study.quantity_requests import QuantityRequest, quantity_request, request_columns
from core.study.stages_of_many import DesignBlock
from core.varying.in_step import Ask, in_step
from core.varying.linear import LinearLimit, linear_limits
from core.varying.request import Goal, StudyLimit, StudyOfMany, StudyQuantity
from core.varying.space import Axis, constant_column
from core.varying.terms import Arrival, Figures, Peaks, PeakSearch, Samples, Term, goal_sign, needs_forces
from core.varying.tolerances import bounds_of

# -- minimax by SLSQP -------------------------------------------------------------------------------------------


MAX_STEPS = 30  # of SLSQP in a round
TOLERANCE = 1e-9  # of the bounds: a step of SLSQP, or a round, that moves less is the last
FINE, COARSE = 1e-13, 1e-4  # accuracy of SLSQP: of rounds that end the search, and of rounds far from the solution


class _NoProgress(Exception):
    """A step of SLSQP moves so little that the rounding of the slopes stops it, after a long line search each."""


def epigraph(
    rows: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], bound: np.ndarray, scale: np.ndarray, start: np.ndarray,
    low: np.ndarray, high: np.ndarray, inset: float = 0.0, accuracy: float = FINE,
) -> np.ndarray:  # fmt: skip
    """Minimax with bounds by SLSQP: minimise t subject to t - f_j(x) >= 0 and b_j - f_j(x) >= 0.

    Parameters
    ----------
    rows : callable
        Point (k,) -> values f (c,) and slopes (c, k) [unit of f]; called several times with the same point.
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
    value, slope = rows(start)
    if not np.isfinite(value).all():
        return start
    size = max(float(np.abs(value[is_goal]).max()), float(np.abs(slope[is_goal] * (high - low)).max())) or 1.0
    scale = np.where(is_goal, size, scale)

    def constraints(z: np.ndarray) -> np.ndarray:
        value, _ = rows(z[:k])
        margin = np.where(is_goal, z[k] - value / scale, (bound - value) / scale - inset)
        return np.where(np.isfinite(margin), margin, -1e2)

    def jacobian(z: np.ndarray) -> np.ndarray:
        slopes = np.hstack([-rows(z[:k])[1] / scale[:, None], is_goal[:, None].astype(float)])
        return np.where(np.isfinite(slopes), slopes, 0.0)

    iterates = [start]

    def check(z: np.ndarray) -> None:
        iterates.append(z[:k])
        if (np.abs(iterates[-1] - iterates[-2]) <= TOLERANCE * (high - low)).all():
            raise _NoProgress

    t, gradient = float((value / scale)[is_goal].max()), np.append(np.zeros(k), 1.0)
    try:
        point = minimize(
            lambda z: float(z[k]), np.append(start, t), jac=lambda z: gradient, method="SLSQP", callback=check,
            bounds=[*zip(low, high, strict=True), (None, None)],
            constraints=[{"type": "ineq", "fun": constraints, "jac": jacobian}], options={"maxiter": MAX_STEPS, "ftol": accuracy},
        ).x[:k]  # fmt: skip
    except _NoProgress:
        point = iterates[-1]
    solution = np.clip(point, low, high)
    return solution if np.isfinite(solution).all() and np.isfinite(rows(solution)[0]).all() else start


# -- search from a single start ---------------------------------------------------------------------------------


ROUNDS = 25  # of adding peaks
STEP = 1e-5  # of the interval between the bounds: for slopes at fixed angles
SEARCH_STEP = 3e-4  # the same, where extremes are searched again
TRUST = 0.25  # of the bounds: longest step of a round
TRUST_FACTOR, MIN_TRUST = (
    0.1,
    1e-3,
)  # reduction where a round makes no progress, as at the edge of the buildable designs
SLIGHT_EXCESS = 1e-5  # of a limit: a smaller excess is removed by a larger inset
INSET = 1e-9  # of a limit: solutions keep it by this margin
NEAR_TOP = 0.3  # of the range of a quantity: lower peaks are left out
MAX_PEAKS, PEAK_PASSES = 8, 5
NEAR_SOLUTION = 0.9  # of the longest step: a shorter one ends near the solution, so that the next rounds are accurate
FAR = 1.0  # of a limit: distance from which its slopes are not computed where they are slow
SAME_PLACE = 1e-3  # of the bounds: nearer to a solution of another start a search ends there

ProgressCallback = Callable[[Mapping[str, Any], float, int], None]
"""Called with the fields of an intermediate design, its goal, and the number of its start; an exception stops the search."""


class Descent:
    """Local search over the numbers of a design with fixed words; coordinates u go from 0 to 1 between the bounds."""

    def __init__(
        self, study: StudyOfMany, design: Design, words: Mapping[str, Any], numbers: Sequence[Axis],
        margins: Mapping[str, float], progress: ProgressCallback | None, starts: int, start_count: int = 0,
    ) -> None:  # fmt: skip
        self.study, self.design, self.words, self.progress, self.max_starts = study, design, words, progress, starts
        self.start_count = start_count
        self._places: list[tuple[int, np.ndarray]] = []  # number of a search, and where it was
        self.paths = tuple(axis.field for axis in numbers)
        ends = [(min(axis.listed), max(axis.listed)) if axis.listed else (axis.low, axis.high) for axis in numbers]
        self.low, self.high = (np.array([end[i] for end in ends], dtype=float) for i in (0, 1))
        self.nominal = (np.array([float(get(design, path)) for path in self.paths]) - self.low) / (self.high - self.low)
        self.terms = [self._term(row, side, bound) for row, side, bound in self._limits(margins)]
        self.terms += [self._linear_term(row) for row in linear_limits(design, self.paths, self.high - self.low)]
        self.goals = [
            self._field_term(goal) if goal.field else self._term(goal, goal_sign(goal), None)
            for goal in study.file.goals
        ]

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

    def _field_term(self, goal: Goal) -> Term:
        """Goal that is a varied number; a whole one is constant in this search."""
        request, side = QuantityRequest(goal.key, "", "", 1.0), goal_sign(goal)
        if goal.field in self.words:
            return Term(goal, request, side, None, line=(float(self.words[goal.field]), np.zeros(len(self.paths))))
        i = self.paths.index(goal.field)
        slopes = (self.high - self.low)[i] * np.eye(len(self.paths))[i]
        return Term(goal, request, side, None, line=(float(self.low[i]), slopes))

    def _linear_term(self, limit: LinearLimit) -> Term:
        """Least value of a linear function of the numbers."""
        row = StudyLimit(limit.name, min=limit.least)
        line = (limit.constant + float(limit.slopes @ self.low), limit.slopes * (self.high - self.low))
        return Term(row, QuantityRequest(limit.name, "", "", 1.0), -1.0, -limit.least, line=line)

    def _has_common_angles(self, request: QuantityRequest) -> bool:
        """Whether designs can be evaluated in a block, at common cam angles."""
        if not request.name or not is_batchable(self.design, self.paths, request):
            return False
        return not self._block(self.nominal[:, None], request.drive).separate.any()

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
            Refine the extremes; without it limits of clearances, which take long, count as kept.

        Returns
        -------
        rows : ndarray (t, m) [unit of the figure]
            ``side`` times the figures of the t terms.
        good : ndarray (m,), dimensionless
            Mask of designs that can be built.
        """
        terms = [*self.terms, *self.goals]
        if polish:
            return self._figures([Figures(u, terms)])[0]
        is_quick = np.array([term.row.quantity not in self.clearances for term in terms])
        values, good = self._figures([Figures(u, [terms[i] for i in np.flatnonzero(is_quick)])], polish=False)[0]
        rows = np.repeat(
            np.array([[np.nan if term.bound is None else term.bound] for term in terms]), u.shape[1], axis=1
        )
        rows[is_quick] = values
        return rows, good

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
            excess = (term.smoothed(term.side * row) * term.side - self.smoothed_bound(term)) / self.scale(term)
            over = np.maximum(over, excess)
        over = np.where(np.isfinite(rows[len(self.terms) :]).all(axis=0), over, np.inf)
        return np.where(good & np.isfinite(over), over, np.where(np.isfinite(over), 1e3 + over, np.inf))

    def smoothed_bound(self, term: Term) -> float:
        """``side`` times the bound of a limit, in the form without poles."""
        assert term.bound is not None, "a limit"
        return float(term.side * term.smoothed(term.side * term.bound))

    def scale(self, term: Term) -> float:
        """Size of the bound of a limit; of a bound of 0 the largest value of its quantity in the design of the study."""
        return abs(self.smoothed_bound(term)) or self._largest(term.request)

    @cache  # noqa: B019 - as long as the search
    def _largest(self, request: QuantityRequest) -> float:
        """Largest value over the turn of the quantity of a figure, before the search; 1 where it has none."""
        if not request.statistic:
            return 1.0
        key = request.key if not request.name else f"{request.key.partition(':')[0]}:abs"
        value = many(self.design, constant_column(self.design, 1), [key], polish=False).value[key][0]
        return abs(float(value)) if np.isfinite(value) and value else 1.0

    # -- answers to the questions of searches -------------------------------------------------------------

    def _block(self, u: np.ndarray, drive: int | None) -> DesignBlock:
        """Block of the designs u (k, m), or of one of their drives."""
        numbers = self._numbers(u)
        if drive is None:
            return design_block(self.design, self.paths, numbers)
        single, inside = only(self.design, drive), paths_inside(self.design, self.paths, drive)
        if not inside:  # the drive is the same in all designs
            return design_block(single, SPEEDS[:1], np.full((1, u.shape[1]), single.speed_rpm))
        return design_block(single, tuple(inside), numbers[[self.paths.index(path) for path in inside.values()]])

    @cache  # noqa: B019 - as long as the search
    def nodes(self, drive: int | None) -> Angles:
        """Cam angles (n,) over the turn that bracket the peaks of every design, or of one of its drives."""
        return clenshaw_curtis_nodes(self._block(self.nominal[:, None], drive).program)[0]

    def answers(self, questions: Mapping[int, Any]) -> Mapping[int, Any]:
        """Answers by number of the search: to all arrivals, which decide who goes on; where there is none, to all others."""
        checkpoint()
        arrivals = {number: q for number, q in questions.items() if type(q) is Arrival}
        if arrivals:
            return dict(zip(arrivals, self._arrivals(list(arrivals.values())), strict=True))
        result: dict[int, Any] = {}
        for kind, function in ((Samples, self._samples), (Figures, self._figures)):
            which: Any = {number: q for number, q in questions.items() if type(q) is kind}
            result |= dict(zip(which, function(list(which.values())) if which else (), strict=True))
        return result

    def _arrivals(self, arrivals: Sequence[Arrival]) -> list[int | None]:
        """Report intermediate designs, and return the number of another search that was there before."""
        result: list[int | None] = []
        for at in arrivals:
            if self.progress is not None:
                self.progress(self._fields(at.u), at.goal, self.start_count + at.number + 1)
            other = next((n for n, u in self._places if n != at.number and np.abs(u - at.u).max() < SAME_PLACE), None)
            if other is None:
                self._places.append((at.number, at.u))
            else:
                self._places = [place for place in self._places if place[0] != at.number]
            result.append(other)
        return result

    def _samples(self, questions: Sequence[Samples]) -> list[list[np.ndarray]]:
        """Quantities of the terms of every question (m, n); NaN where a design fails."""
        try:
            return self._joint_samples(questions)
        except (ValueError, KindynaError):
            if len(questions) > 1:
                return [self._samples([question])[0] for question in questions]
            return [[np.full((q.u.shape[1], theta.size), np.nan) for theta, _ in q.angles] for q in questions]

    def _joint_samples(self, questions: Sequence[Samples]) -> list[list[np.ndarray]]:
        u = np.hstack([q.u for q in questions])
        result: list[dict[int, np.ndarray]] = [{} for _ in questions]
        for drive in dict.fromkeys(term.request.drive for q in questions for term in q.terms):
            self._sample_drive(drive, u, questions, result)
        return [[row[i] for i in range(len(q.terms))] for q, row in zip(questions, result, strict=True)]

    def _sample_drive(
        self, drive: int | None, u: np.ndarray, questions: Sequence[Samples], result: list[dict[int, np.ndarray]]
    ) -> None:
        """Write the quantities of the terms of one drive into ``result``, by the numbers of the terms in their question."""
        which = [[i for i, term in enumerate(q.terms) if term.request.drive == drive] for q in questions]
        rows, first = [], 0
        for q, own in zip(questions, which, strict=True):
            m = q.u.shape[1]
            theta, piece = (
                np.concatenate(row) if row else np.zeros(0, int) for row in _columns(q.angles[i] for i in own)
            )
            rows.append((np.tile(theta, m), np.tile(piece, m), np.repeat(np.arange(first, first + m), theta.size)))
            first += m
        theta, piece, owner = (np.concatenate(row) for row in zip(*rows, strict=True))
        terms = [q.terms[i] for q, own in zip(questions, which, strict=True) for i in own]
        block = self._block(u, drive)
        names = list(dict.fromkeys(term.request.name for term in terms))
        values = block.values(names, block.state(theta, piece, owner), owner)
        failed = block.failed_at("dynamics" if any(needs_forces(term) for term in terms) else "cam")
        values = {name: np.where(failed[owner], np.nan, row) for name, row in values.items()}
        first = 0
        for q, own, (theta, _, _), every in zip(questions, which, rows, result, strict=True):
            start = 0
            for i in own:
                row = values[q.terms[i].request.name][first : first + theta.size].reshape(q.u.shape[1], -1)
                every[i] = row[:, start : start + q.angles[i][0].size] / q.terms[i].request.unit
                start += q.angles[i][0].size
            first += theta.size

    def _figures(self, questions: Sequence[Figures], polish: bool = True) -> list[tuple[np.ndarray, np.ndarray]]:
        """``side`` times the figures of the terms of every question (t, m), and the mask (m,) of designs that can be built."""
        result: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        keys = [tuple(dict.fromkeys(term.row.key for term in q.terms if term.line is None)) for q in questions]
        for group in dict.fromkeys(keys):
            which = [i for i, row in enumerate(keys) if row == group]
            u = np.hstack([questions[i].u for i in which])
            numbers = dict(zip(self.paths, self._numbers(u), strict=True)) or constant_column(self.design, u.shape[1])
            figures, last = many(self.design, numbers, group or self.any_figure, polish=polish), 0
            for i in which:
                part = slice(last, last + questions[i].u.shape[1])
                rows = np.array([
                    term.side * figures.value[term.row.key][part] if term.line is None else term.on_line(questions[i].u)
                    for term in questions[i].terms
                ])  # fmt: skip
                result[i], last = (rows, np.asarray(figures.reason[part] == "")), part.stop
        return [result[i] for i in range(len(questions))]

    @cached_property
    def clearances(self) -> frozenset[str]:
        """Columns of the clearances of bodies, which take long to compute."""
        return frozenset(Study(self.design).clearances.by_column) if self.design.outlines else frozenset()

    @cached_property
    def any_figure(self) -> tuple[str]:
        """A figure that tells whether designs can be built, where no figure is a goal or limited."""
        return (f"{request_columns(self.design)[int(self.design.listed)]}:max",)

    # -- several starts -----------------------------------------------------------------------------------

    def solve(self, starts: Sequence[np.ndarray], goal: Term, extra: Sequence[Term] = ()) -> list[np.ndarray]:
        """Local solutions from several starts, which advance in step; a search that comes near a place of another shares its solution.

        Parameters
        ----------
        starts : sequence of ndarray (k,), dimensionless
            Coordinates of the starts.
        goal : Term
        extra : sequence of Term
            Further limits.

        Returns
        -------
        list of ndarray (k,), dimensionless
        """
        terms = [*self.terms, *extra, goal]
        self._places = []

        def search(number: int, ask: Ask) -> np.ndarray | int:
            return LocalSearch(self, terms, goal, ask, number).solve(starts[number])

        results = in_step([partial(search, number) for number in range(len(starts))], self.answers)
        self.start_count += len(starts)
        return [self._shared(results, result) for result in results]

    def _shared(self, results: Sequence[np.ndarray | int], result: np.ndarray | int) -> np.ndarray:
        return self._shared(results, results[result]) if isinstance(result, int) else result

    def _fields(self, u: np.ndarray) -> dict[str, Any]:
        """Values of the varied fields at coordinates (k,), in the order of the study."""
        numbers = self._numbers(u[:, None])[:, 0].tolist()
        order = [row.field for row in self.study.file.vary]
        values = {**self.words, **dict(zip(self.paths, numbers, strict=True))}
        return {field: values[field] for field in order}


class LocalSearch:
    """Search from a single start, in rounds of SLSQP, each with the peaks of all solutions so far.

    Attributes
    ----------
    terms : sequence of Term
        The limits, and ``goal``.
    ask : callable
        Returns the answers to Samples, Figures and Arrivals.
    peaks : dict
        Peaks of all solutions so far.
    """

    def __init__(self, descent: Descent, terms: Sequence[Term], goal: Term, ask: Ask, number: int = 0) -> None:
        self.descent, self.terms, self.goal, self.ask, self.number = descent, terms, goal, ask, number
        self.peaked = [term for term in terms if term.peaks]
        slow = descent.clearances
        self.single = [term for term in terms if not term.peaks and term.line is None and term.row.quantity not in slow]
        self.slow = [term for term in terms if term.row.quantity in slow]
        self.lines = [term for term in terms if term.line is not None]
        self.peaks: Peaks = {}
        self._memory: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def solve(self, start: np.ndarray) -> np.ndarray | int:
        """Local solution, or the number of a search that was at a place of this one before.

        Parameters
        ----------
        start : ndarray (k,), dimensionless
            Coordinates of the start.

        Returns
        -------
        ndarray (k,), dimensionless
            Or int.
        """
        u = np.clip(start, 0.0, 1.0)
        inset, trust, is_far, accuracy = INSET, TRUST, True, COARSE
        if not self.add_peaks(u):
            return u
        self._arrive(u)
        for _ in range(ROUNDS):
            solution = self._round(u, inset, trust, accuracy)
            step = float(np.abs(solution - u).max())
            u = solution
            other = self._arrive(u)
            if other is not None:
                return other
            if accuracy > FINE and step < NEAR_SOLUTION * trust:
                accuracy = FINE
            elif step < TOLERANCE and is_far and trust > MIN_TRUST:
                trust *= TRUST_FACTOR
            elif step >= TOLERANCE:
                is_far = step > 0.5 * trust
            else:
                over = float(
                    self.descent.excess(*self.ask(Figures(u[:, None], [*self.descent.terms, *self.descent.goals])))[0]
                )
                if not 0.0 < over < SLIGHT_EXCESS:
                    break
                inset += 2.0 * over
            if not self.add_peaks(u):
                break
        return u

    def _arrive(self, u: np.ndarray) -> int | None:
        top = self._rows(u)[0][[term is self.goal for term in self._owners()]].max()
        goal = float(self.goal.original(self.goal.side * top))
        other: int | None = self.ask(Arrival(self.number, u, goal))
        return other

    def _round(self, u: np.ndarray, inset: float, trust: float, accuracy: float) -> np.ndarray:
        """SLSQP at fixed angles: minimise t subject to t - f_goal(θ_j) >= 0 and bound - f(θ_j) >= 0."""
        owners, descent = self._owners(), self.descent
        bound = np.array([np.nan if term is self.goal else descent.smoothed_bound(term) for term in owners])
        scale = np.array([1.0 if term is self.goal else descent.scale(term) for term in owners])
        low, high = np.maximum(u - trust, 0.0), np.minimum(u + trust, 1.0)
        return epigraph(self._rows, bound, scale, u, low, high, inset, accuracy)

    def _owners(self) -> list[Term]:
        """Term of every row: at each of its peaks, or of its single value."""
        return [
            *(term for p, term in enumerate(self.peaked) for _ in self.peaks[p]),
            *self.single,
            *self.slow,
            *self.lines,
        ]

    def _rows(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values (c,) of all terms at the peaks, or of their single values, and slopes (c, k), at a point (k,)."""
        key = point.tobytes()
        if key not in self._memory:
            _, values, slopes = zip(*self.linear(point), strict=True)
            self._memory[key] = np.concatenate(values), np.concatenate(slopes)
        return self._memory[key]

    def linear(self, u: np.ndarray) -> list[tuple[Term, np.ndarray, np.ndarray]]:
        """Every term with its values at its peaks, or its single value, and their slopes.

        Parameters
        ----------
        u : ndarray (k,), dimensionless
            Coordinates of a design.

        Returns
        -------
        list of (Term, ndarray (n,), ndarray (n, k)) [unit of the figure]
        """
        k, result = u.size, []
        if self.peaked:
            angles = [
                (np.array([peak[0] for peak in self.peaks[p]]), np.array([peak[1] for peak in self.peaks[p]]))
                for p in range(len(self.peaked))
            ]
            every = self.ask(Samples(_neighbours(u, STEP), angles, self.peaked))
            for p, (term, values) in enumerate(zip(self.peaked, every, strict=True)):
                f = np.array([sign for _, _, sign in self.peaks[p]]) * term.smoothed(values)
                result.append((term, f[0], (f[1 : k + 1] - f[k + 1 :]).T / (2.0 * STEP)))
        if self.single:
            figures, _ = self.ask(Figures(_neighbours(u, SEARCH_STEP), self.single))
            for term, row in zip(self.single, figures, strict=True):
                f = term.side * term.smoothed(term.side * row)
                result.append((term, f[:1], (f[1 : k + 1] - f[k + 1 :])[None] / (2.0 * SEARCH_STEP)))
        for term in self.slow:
            result.append(self._slow_value(u, term))
        for term in self.lines:
            assert term.line is not None, "a linear value"
            result.append((term, term.on_line(u[:, None]), term.side * term.line[1][None]))
        return result

    def _slow_value(self, u: np.ndarray, term: Term) -> tuple[Term, np.ndarray, np.ndarray]:
        """Value and slopes of a figure that is computed design by design; slopes 0 far from its bound, where they change nothing."""
        f = self.ask(Figures(u[:, None], [term]))[0][0]
        slopes = np.zeros((1, u.size))
        if term.bound is None or term.bound - f[0] < FAR * self.descent.scale(term):
            row = self.ask(Figures(_neighbours(u, SEARCH_STEP)[:, 1:], [term]))[0][0]
            slopes = (row[: u.size] - row[u.size :])[None] / (2.0 * SEARCH_STEP)
        return term, f, slopes

    # -- peaks --------------------------------------------------------------------------------------------

    def add_peaks(self, u: np.ndarray) -> bool:
        """Add the peaks of a design, in place of peaks near them; False where a term has none.

        Parameters
        ----------
        u : ndarray (k,), dimensionless
            Coordinates of the design.
        """
        self._memory.clear()
        for i, rows in enumerate(self._highest_peaks(u) if self.peaked else []):
            others = self.peaks.get(i, [])
            for theta, piece, sign in rows:
                others = [peak for peak in others if abs(peak[0] - theta) > 2e-3 or peak[1:] != (piece, sign)]
            self.peaks[i] = ([*rows, *others])[: 3 * MAX_PEAKS]
        return all(self.peaks.get(i) for i in range(len(self.peaked)))

    def _highest_peaks(self, u: np.ndarray) -> list[list[tuple[float, int, float]]]:
        """Cam angle [rad], piece and sign of the highest peaks of every term over the turn of a design (k,)."""
        nodes = [self.descent.nodes(term.request.drive) for term in self.peaked]
        every = self.ask(Samples(u[:, None], [(angles.theta, angles.piece) for angles in nodes], self.peaked))
        searches: list[PeakSearch] = []
        for number, (term, row, angles) in enumerate(zip(self.peaked, every, nodes, strict=True)):
            theta, piece = angles.theta, angles.piece
            first, last = np.append(True, np.diff(piece) != 0), np.append(np.diff(piece) != 0, True)
            values = term.smoothed(row[0])
            spread = float(np.ptp(values)) if np.isfinite(values).all() else np.inf
            for sign in term.peaks:
                f = sign * values
                left, right = np.where(first, -np.inf, np.roll(f, 1)), np.where(last, -np.inf, np.roll(f, -1))
                local = np.flatnonzero((f >= left) & (f >= right) & (f >= f.max() - NEAR_TOP * spread))
                lo, hi = theta[np.where(first[local], local, local - 1)], theta[np.where(last[local], local, local + 1)]
                searches.append(PeakSearch(number, sign, lo, hi, piece[local]))
        searches = [search for search in searches if search.low.size]
        for _ in range(PEAK_PASSES if searches else 0):
            samples = [search.samples() for search in searches]
            within = [(at.ravel(), np.repeat(s.piece, at.shape[1])) for s, at in zip(searches, samples, strict=True)]
            rows = self.ask(Samples(u[:, None], within, [self.peaked[search.term] for search in searches]))
            for search, at, row in zip(searches, samples, rows, strict=True):
                search.narrow(at, self.peaked[search.term].smoothed(row[0]).reshape(at.shape))
        result: list[list[tuple[float, int, float]]] = []
        for number in range(len(self.peaked)):
            peaks = [peak for search in searches if search.term == number for peak in search.peaks()]
            result.append([(theta, piece, sign) for _, theta, piece, sign in sorted(peaks, reverse=True)[:MAX_PEAKS]])
        return result


def _columns(rows: Iterable[tuple[np.ndarray, np.ndarray]]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Angles and pieces of several rows."""
    listed = list(rows)
    return [theta for theta, _ in listed], [piece for _, piece in listed]


def _neighbours(u: np.ndarray, step: float) -> np.ndarray:
    """A point (k,) and its neighbours (k, 1 + 2 k), first upwards, then downwards."""
    steps = step * np.eye(u.size)
    return np.hstack([u[:, None], u[:, None] + steps, u[:, None] - steps])
