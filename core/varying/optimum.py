"""Best design of a study: many designs of a Latin hypercube, then SLSQP (Kraft 1988) from the best, in rounds (``descent``).

All combinations of words are searched. Two goals give a front; limits can hold for a share of the machines built.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import field, replace
from itertools import product
from typing import Any

import numpy as np

from core.design import Design, all_paths, get, only, varied
from core.errors import KindynaError
from core.find.shaft import with_least_flywheel
from core.find.trial import FindingsCheck, has_uneven_speed
from core.frozen import frozen
from core.laws import LAWS
from core.number_text import count_text, result_text, signed_text
from core.study import Study, many
from core.study.batch import FAULTY
from core.study.limits import ANY_PRESSURE, CONVEX, LIMITS
from core.study.quantities import quantity
from core.study.quantity_requests import quantity_request
from core.units import split_unit
from core.varying.descent import Descent, LocalSearch, ProgressCallback
from core.varying.request import Goal, StudyFile, StudyOfMany
from core.varying.space import Axis, Space, constant_column, is_discrete, none_built_text, with_words
from core.varying.terms import Term, goal_sign
from core.varying.tolerances import ONE_SIDED, Scatter, Share, bounds_of

# -- the best design of a study ---------------------------------------------------------------------------------


MAX_SAMPLES, BASE_SAMPLES = 1024, 64  # designs of the Latin hypercube; twice as many for every varied number
STARTS = 6  # from the best of these
START_DISTANCE = 0.1  # of the bounds, in the mean: least distance of starts
SAME = 1e-5  # of their size: goals of starts that reached the same solution
EQUAL = 1e-10  # of the best goal: of equally good solutions that of the first start is chosen, not that of the last bit
BINDING = 1e-6  # of a limit
HOLDS = 1e-3  # of its greatest slope by a varied field: a limit with a smaller slope does not hold the field
MAX_COMBINATIONS = 512  # of words and whole numbers
FRONT = 24  # points of a front
BETTER = 1e-6  # of the goal: a smaller improvement is no change
ROBUST_MACHINES = 2000
ROBUST_ROUNDS = 8


class NoDesignBuilt(KindynaError):
    """No design of a study can be built."""


@frozen
class Binding:
    """A limit, or the bound of a field, that is active at the solution.

    Attributes
    ----------
    limit : str
        Column of the limit, or path of the field.
    per_percent : float
        Change of the goal for 1 % more of it.
    fields : tuple of str
        Varied fields that it holds.
    """

    limit: str
    per_percent: float
    fields: tuple[str, ...] = ()


@frozen(eq=False)
class Optimum:
    """The best design of a study.

    Attributes
    ----------
    design : Design
    answer : mapping of str -> value
        Values of the varied fields.
    goals, before : mapping of str -> float
        Goals of this design, and of the design of the study.
    is_feasible : bool
        Whether it keeps the limits; else it violates them least.
    is_better : bool
        Whether it is better than the design of the study.
    binding : tuple of Binding
    starts, agreeing : int
        Number of starts, and of those that reached the same solution.
    front : tuple of mapping
        Of two goals the points of which none is better in both.
    share : Share or None
        Of random machines that keep the limits, where the study requires one.
    rejection : str
        Findings because of which a better design was rejected.
    also_set : mapping of str -> float
        Further fields that the design needs, of a flywheel.
    exact, rounding : mapping of str -> float
        Exact values of rounded numbers, and their steps.
    cost : mapping of str -> (float, float)
        Goal or limit -> its figure with the exact and with the rounded numbers.
    note : str
        Why the numbers are not rounded.
    """

    design: Design
    answer: Mapping[str, Any]
    goals: Mapping[str, float]
    before: Mapping[str, float]
    is_feasible: bool
    is_better: bool
    binding: tuple[Binding, ...] = ()
    starts: int = 0
    agreeing: int = 0
    front: tuple[Mapping[str, Any], ...] = ()
    share: Share | None = None
    rejection: str = ""
    also_set: Mapping[str, float] = field(default_factory=dict)
    exact: Mapping[str, float] = field(default_factory=dict)
    rounding: Mapping[str, float] = field(default_factory=dict)
    cost: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    note: str = ""


def optimise(study: StudyOfMany, progress: ProgressCallback | None = None, starts: int = STARTS) -> Optimum:
    """Best design of a study within its limits, from this number of starts for every combination of words.

    Raises KindynaError where the study has no goal, or none of its designs can be built.
    """
    if not study.file.goals:
        raise KindynaError("goals: missing; give one [[goals]], or two for a front")
    space = Space(study)
    words = [axis for axis in space.axes if is_discrete(axis.info)]
    sets = list(product(*(_choices(axis) for axis in words)))
    if len(sets) > MAX_COMBINATIONS:
        raise KindynaError(
            f"vary: {count_text(len(sets))} combinations of words and whole numbers are too many; allowed: at most {MAX_COMBINATIONS}"
        )
    if study.file.robust is not None:
        return _robust(study, space, words, sets, progress, starts)
    return _best(study, space, words, sets, {}, progress, starts)


def _choices(axis: Axis) -> Sequence[Any]:
    if axis.count:
        column = axis.at(np.arange(axis.count))
        return [value if isinstance(value, str) else int(value) for value in column.tolist()]
    return range(int(axis.low), int(axis.high) + 1)


def _best(
    study: StudyOfMany,
    space: Space,
    words: Sequence[Axis],
    sets: Sequence[Any],
    margins: Mapping[str, float],
    progress: ProgressCallback | None,
    starts: int,
) -> Optimum:
    """Best design of all combinations of words; ``margins`` maps limits to the distance that is kept from them."""
    optima: list[Optimum] = []
    start_count = 0
    error: NoDesignBuilt | None = None
    numbers = [axis for axis in space.axes if not is_discrete(axis.info)]
    for chosen in sets:
        values = dict(zip((axis.field for axis in words), chosen, strict=True))
        design = with_words(study.base, values)
        if design is None:
            continue
        search = _Search(study, design, values, numbers, margins, progress, starts, start_count)
        try:
            optima.append(search.front() if len(study.file.goals) == 2 else search.best())
        except NoDesignBuilt as failure:
            error = failure
        start_count = search.start_count
    if not optima:
        raise error or KindynaError(
            f"vary: all combinations of these words exclude each other in this design ({FAULTY})"
        )
    side = goal_sign(study.file.goals[0])
    key = study.file.goals[0].key
    best = min(optima, key=lambda o: (not o.is_feasible, side * o.goals[key] if o.is_feasible else 0.0))
    for optimum in optima:  # the design of the study, where other words do not improve it
        goal = optimum.goals[key]
        if optimum.is_feasible and not optimum.is_better and side * (goal - best.goals[key]) <= BETTER * abs(goal):
            best = optimum
    if len(study.file.goals) == 2:
        front = _undominated([point for optimum in optima for point in optimum.front], study.file.goals)
        return replace(best, front=tuple(front))
    return best


def latin_hypercube(dimensions: int, seed: int, count: int) -> np.ndarray:
    """Random points, one in each of ``count`` equal layers along every axis; without the import of ``scipy.stats``.

    Parameters
    ----------
    dimensions : int
        Number k of dimensions.
    seed : int
    count : int

    Returns
    -------
    ndarray (k, count), dimensionless
        From 0 to 1.

    References
    ----------
    McKay, Beckman and Conover (1979), A comparison of three methods for selecting values of input variables.
    """
    rng = np.random.default_rng(seed)
    layers = rng.permuted(np.tile(np.arange(count), (dimensions, 1)), axis=1)
    return np.asarray((layers + rng.random((dimensions, count))) / count)


class _Search(Descent):
    """Search from all starts for the best design, or for the front of two goals."""

    # -- all starts ---------------------------------------------------------------------------------------

    def starts(self) -> list[np.ndarray]:
        """Coordinates of the starts: the design where it is within the bounds, and the best of random points at a distance.

        Returns
        -------
        list of ndarray (k,), dimensionless
        """
        chosen = [self.nominal] if ((self.nominal >= 0.0) & (self.nominal <= 1.0)).all() else []
        if len(chosen) == self.max_starts:
            return chosen
        k = len(self.paths)
        u = latin_hypercube(k, self.study.file.seed, min(MAX_SAMPLES, BASE_SAMPLES << k))
        rows, good = self.values(u, polish=False)
        over, goal = self.excess(rows, good), rows[-len(self.goals)]
        if not (good & np.isfinite(over)).any() and not (chosen and self.values(self.nominal[:, None])[1].any()):
            raise NoDesignBuilt(self._none_built(u))
        order = np.lexsort((goal, np.maximum(over, 0.0)))
        for i in order:
            if len(chosen) >= self.max_starts or not np.isfinite(over[i]):
                break
            if all(np.abs(u[:, i] - start).mean() > START_DISTANCE for start in chosen):
                chosen.append(u[:, i])
        return chosen

    def best(self) -> Optimum:
        """Best design from all starts that brings no new finding."""
        goal, starts = self.goals[0], self.starts() if self.paths else [np.zeros(0)]
        if not self.paths:
            return self._chosen(starts, goal)
        return self._chosen(self.solve(starts, goal), goal)

    def _none_built(self, u: np.ndarray) -> str:
        """Message that no design u (k, m) can be built, with the most frequent reason."""
        keys = [goal.row.key for goal in self.goals if goal.line is None] or self.any_figure
        numbers = dict(zip(self.paths, self._numbers(u), strict=True))
        (code, often), *_ = Counter(many(self.design, numbers, keys, polish=False).reason.tolist()).most_common(1)
        return none_built_text(u.shape[1], code or "no value", often)

    def _chosen(self, points: Sequence[np.ndarray], goal: Term) -> Optimum:
        """Optimum at the best point that keeps the limits and brings no new finding."""
        rows, good = self.values(np.array([*points, np.clip(self.nominal, 0.0, 1.0)]).T)
        over, goals = self.excess(rows, good), rows[len(self.terms) + self.goals.index(goal)]
        keeps = over <= 0.0
        is_inside = bool(((self.nominal >= 0.0) & (self.nominal <= 1.0)).all())
        nominal_is_feasible = is_inside and bool(keeps[-1]) and self.design == self.study.base
        worth = np.where(keeps[:-1], goals[:-1], np.inf)
        equal = worth <= worth.min() + EQUAL * np.abs(worth.min())
        order = [int(i) for i in np.argsort(np.where(equal, worth.min(), worth), kind="stable") if keeps[i]]
        if not order and not nominal_is_feasible:
            return self._optimum(points[int(np.argmin(over[:-1]))], len(points), 0, is_feasible=False)
        is_field = any(goal.line is not None for goal in self.goals)  # no note stops it: it has limits
        check = FindingsCheck(self.study.base, waived=waived(self.study.file), notes=not is_field)
        rejection = ""
        for i in order:
            if nominal_is_feasible and goals[i] > goals[-1] - BETTER * abs(goals[-1]):
                break
            new = check.new(self._with_flywheel(points[i])[0])
            if not new:
                agreeing = int((np.abs(goals[order] - goals[i]) <= SAME * abs(goals[i])).sum())
                return self._optimum(points[i], len(points), agreeing, rejection=rejection)
            rejection = rejection or "; ".join(new)
        if not nominal_is_feasible:
            return self._optimum(points[order[0]], len(points), 0, is_feasible=False, rejection=rejection)
        if rejection:
            between = self._towards(points[order[0]], check)
            if between is not None:
                return self._optimum(between, len(points), 1, rejection=rejection)
        return self._optimum(self.nominal, len(points), 0, rejection=rejection, is_better=False)

    def _towards(self, point: np.ndarray, check: FindingsCheck) -> np.ndarray | None:
        """Last point on the line from the design of the study to a point that brings no new finding; None where there is none."""
        part, step, last = 0.0, 0.5, None
        for _ in range(12):
            u = self.nominal + (part + step) * (point - self.nominal)
            if float(self.excess(*self.values(u[:, None]))[0]) <= 0.0 and not check.new(self._with_flywheel(u)[0]):
                part, last = part + step, u
            step *= 0.5
        return last

    def _with_flywheel(self, u: np.ndarray) -> tuple[Design, Mapping[str, float]]:
        """Design at coordinates (k,), with the flywheel it needs, and the fields of the flywheel."""
        numbers = self._numbers(u[:, None])[:, 0].tolist()
        return with_flywheel(varied(self.design, dict(zip(self.paths, numbers, strict=True))), self.study.base)

    def _optimum(
        self,
        u: np.ndarray,
        starts: int,
        agreeing: int,
        *,
        is_feasible: bool = True,
        is_better: bool = True,
        rejection: str = "",
    ) -> Optimum:
        rows, _ = self.values(u[:, None])
        first = len(self.terms)
        design, also_set = self._with_flywheel(u)
        return Optimum(
            design,
            answer=self._fields(u),
            goals={goal.row.key: float(goal.side * rows[first + i, 0]) for i, goal in enumerate(self.goals)},
            before=_nominal_goals(self.study),
            is_feasible=is_feasible,
            is_better=is_feasible and is_better,
            binding=tuple(self.binding(u, self.goals[0])) if is_feasible and u.size else (),
            starts=starts,
            agreeing=agreeing,
            rejection=rejection,
            also_set=also_set,
        )

    def binding(self, u: np.ndarray, goal: Term) -> list[Binding]:
        """Active limits at a solution, with the change λ L/100 of the goal for 1 % of a limit L.

        The multipliers λ_j >= 0 satisfy ∇t = Σ λ_j ∇g_j over the active constraints g_j, by non-negative least squares. Where
        several sets of multipliers do, the gain of a limit is that of the set with its least multiplier: it is 0 for each of two
        limits that have to be relieved together.

        Parameters
        ----------
        u : ndarray (k,), dimensionless
            Coordinates of the solution.
        goal : Term

        Returns
        -------
        list of Binding
            The strongest first.

        References
        ----------
        Karush (1939), Minima of functions of several variables with inequalities as side constraints.
        """
        from scipy.optimize import nnls

        search = LocalSearch(self, [*self.terms, goal], goal, lambda question: self.answers({0: question})[0])
        if not search.add_peaks(u):
            return []
        k = u.size
        names: list[str] = []
        columns: list[np.ndarray] = []
        weights_of_limits: list[float] = []
        rows = [
            (term, float(value), slope)
            for term, values, slopes in search.linear(u)
            for value, slope in zip(values, slopes, strict=True)
            if np.isfinite(slope).all()
        ]
        top = max((value for term, value, _ in rows if term is goal), default=np.nan)
        if np.isnan(top):
            return []
        size = abs(top) or 1.0
        for term, value, slope in rows:
            if term is goal:
                if top - value <= 1e-5 * size:
                    names.append("")
                    columns.append(np.append(slope / size, 1.0))
                    weights_of_limits.append(0.0)
            elif self.smoothed_bound(term) - value <= BINDING * self.scale(term):
                b = term.bound or 0.0
                step = self.smoothed_bound(replace(term, bound=b * (1.0 + 1e-6))) - self.smoothed_bound(term)
                names.append(term.row.column)
                columns.append(np.append(slope / self.scale(term), 0.0))
                weights_of_limits.append(abs(step) * 1e6 / self.scale(term) if b else 1.0)
        for i, path in enumerate(self.paths):
            for at, sign, end in ((0.0, -1.0, float(self.low[i])), (1.0, 1.0, float(self.high[i]))):
                if abs(u[i] - at) < 1e-7:
                    names.append(path)
                    columns.append(np.append(sign * np.eye(k)[i], 0.0))
                    weights_of_limits.append(abs(end) / (self.high[i] - self.low[i]))
        balance = np.array(columns).T
        multipliers, _ = nnls(balance, np.append(np.zeros(k), 1.0))
        held: dict[str, set[str]] = {}
        for name, multiplier, column in zip(names, multipliers, columns, strict=True):
            if name and multiplier > 1e-9:
                slopes = np.abs(column[:k])
                fields = np.flatnonzero(slopes > HOLDS * slopes.max())
                held.setdefault(name, set()).update(self.paths[i] for i in fields.tolist())
        by_name: dict[str, float] = {}
        for name in held:
            weights = np.where(np.array(names) == name, weights_of_limits, 0.0)
            by_name[name] = -0.01 * size * goal.side * _least_weighted(weights, balance, multipliers)
        return [
            Binding(name, float(change), tuple(path for path in self.paths if path in held[name]))
            for name, change in sorted(by_name.items(), key=lambda item: -abs(item[1]))
        ]

    # -- two goals ----------------------------------------------------------------------------------------

    def front(self) -> Optimum:
        """Front of two goals: each goal alone, then the first with a bound of the second (ε-constraint method).

        References
        ----------
        Haimes, Lasdon and Wismer (1971), On a bicriterion formulation of the problems of integrated system identification.
        """
        first, second = self.goals
        starts = self.starts()
        ends = []
        for i, goal in enumerate(self.goals):
            points = self.solve(starts[:3], goal)
            ends.append(min(points, key=lambda u, i=i: self._merit(u, i)))  # type: ignore[misc]
        rows, _ = self.values(np.array(ends).T)
        levels = rows[len(self.terms) + 1]
        points, u = [ends[0]], ends[0]
        for level in np.linspace(levels[0], levels[1], FRONT)[1:-1]:
            (u,) = self.solve([u], first, (replace(second, bound=float(level)),))
            points.append(u)
        points.append(ends[1])
        rows, good = self.values(np.array(points).T)
        keeps = self.excess(rows, good) <= 0.0
        front: list[Mapping[str, Any]] = [
            {**self._fields(u), **{goal.row.column: float(goal.side * rows[len(self.terms) + i, j]) for i, goal in enumerate(self.goals)}}
            for j, u in enumerate(points) if keeps[j]
        ]  # fmt: skip
        best = self._chosen([u for u, keep in zip(points, keeps, strict=True) if keep] or points, first)
        return replace(best, front=tuple(_undominated(front, self.study.file.goals)))

    def _merit(self, u: np.ndarray, goal: int) -> tuple[float, float]:
        rows, good = self.values(u[:, None])
        return max(float(self.excess(rows, good)[0]), 0.0), float(rows[len(self.terms) + goal, 0])


def _least_weighted(weights: np.ndarray, balance: np.ndarray, multipliers: np.ndarray) -> float:
    """Least Σ w_j λ_j of all multipliers λ_j >= 0 with the same balance: the gain by relief of one limit alone.

    Parameters
    ----------
    weights : ndarray (n,), dimensionless
        0 for the constraints of other limits.
    balance : ndarray (m, n), dimensionless
        Slopes of the constraints.
    multipliers : ndarray (n,), dimensionless
        One set of multipliers.

    References
    ----------
    Gauvin (1980), Shadow prices in nonconvex mathematical programming, Mathematical Programming 19.
    """
    from scipy.optimize import linprog

    present = float(weights @ multipliers)
    result = linprog(weights, A_eq=balance, b_eq=balance @ multipliers, method="highs-ds")
    return max(0.0, min(present, float(result.fun))) if result.success else present


def waived(file: StudyFile) -> set[str]:
    """Codes of findings that the limits of a study replace: of pressure angle, curvature, and transmission angles."""
    limited = {limit.quantity for limit in file.limits}
    keys = {"pressure_angle_deg": (ANY_PRESSURE,), "profile_curvature_per_mm": (CONVEX,)}
    codes = {code for slug, rows in keys.items() if slug in limited for key in rows for code in LIMITS[key].findings}
    return codes | {"transmission-angle" for slug in limited if slug.startswith("transmission_")}


def with_flywheel(
    design: Design, before: Design, rounded: Callable[[float], float] | None = None
) -> tuple[Design, Mapping[str, float]]:
    """The design, with a flywheel where its speed fluctuates beyond the target and that of the design before does not.

    ``rounded`` rounds its inertia up.
    """
    if has_uneven_speed(design) and not has_uneven_speed(before):
        with suppress(KindynaError):
            return with_least_flywheel(design, rounded)
    return design, {}


def _nominal_goals(study: StudyOfMany) -> dict[str, float]:
    """Goals of the design of the study; NaN where it has none."""
    keys = [goal.key for goal in study.file.goals if not goal.field]
    values = many(study.base, constant_column(study.base, 1), keys).value if keys else {}
    return {
        goal.key: float(get(study.base, goal.field) if goal.field else values[goal.key][0]) for goal in study.file.goals
    }


def _undominated(points: Sequence[Mapping[str, Any]], goals: Sequence[Goal]) -> list[Mapping[str, Any]]:
    """Points that no other point dominates (as good in both goals, better in one), in the order of the first goal."""
    worth = np.array([[goal_sign(goal) * point[goal.column] for goal in goals] for point in points]).reshape(
        -1, len(goals)
    )
    chosen = [
        i for i, goal in enumerate(worth)
        if not any((g <= goal).all() and (g < goal).any() for g in worth) and not (worth[:i] == goal).all(axis=1).any()
    ]  # fmt: skip
    return [points[i] for i in sorted(chosen, key=lambda i: worth[i, 0])]


def _robust(
    study: StudyOfMany,
    space: Space,
    words: Sequence[Axis],
    sets: Sequence[Any],
    progress: ProgressCallback | None,
    starts: int,
) -> Optimum:
    """Best design whose limits a share of the machines keeps.

    Limits are narrowed by z times the deviation by the tolerances, from the sensitivities at the last solution; z grows until the
    lower end of Wilson's interval, by random machines, reaches the required share.
    """
    required = study.file.robust
    assert required is not None, "a robust study"
    margins: dict[str, float] = {}
    z = ONE_SIDED
    best = _best(study, space, words, sets, margins, progress, starts)
    for _ in range(ROBUST_ROUNDS):
        if not best.is_feasible:
            return best
        scatter = Scatter(StudyOfMany(best.design, study.file, study.folder))
        share = scatter.share(ROBUST_MACHINES, study.file.seed)
        best = replace(best, share=share)
        if share.interval[0] >= required:
            return best
        slopes = scatter.slopes()
        sigma = np.array([row.deviation for row in scatter.tolerances])
        deviation = np.sqrt(((slopes * sigma[:, None]) ** 2).sum(axis=0))
        margins = {limit.key: z * float(deviation[scatter.keys.index(limit.key)]) for limit in study.file.limits}
        z *= 1.15
        best = _best(study, space, words, sets, margins, progress, starts)
    return replace(best, is_feasible=False)


# -- remarks on the best design ---------------------------------------------------------------------------------


TORQUE, POWER = "drive_torque", "power.load"
PEAKS = ("max", "abs")
MIN_GAIN = 0.01  # of the goal: by which another law must improve it to be mentioned
AT_NODES = 0.01  # of the goal: more than the error of a goal that is not refined
DWELL = "dwell"


def remarks(study: StudyOfMany, optimum: Optimum) -> tuple[str, ...]:
    """Remarks on the best design: the limits it violates; else the fixed part of a peak torque, and a better motion law.

    One design is computed for every motion law, and refined where it may be the best.
    """
    if not optimum.is_feasible:
        return tuple(_violated_limits(study, optimum))
    sentences = [*(_fixed_torque(optimum, goal) for goal in study.file.goals), _better_law(study, optimum)]
    return tuple(sentence for sentence in sentences if sentence)


def _violated_limits(study: StudyOfMany, optimum: Optimum) -> Iterator[str]:
    """Values of the limits that the design violates."""
    bounds = list(bounds_of(study.file.limits))
    reached = many(optimum.design, constant_column(optimum.design, 1), [limit.key for limit, _, _ in bounds]).value
    for limit, side, bound in bounds:
        value = float(reached[limit.key][0])
        if not side * value <= side * bound:
            yield f"{limit.key} = {result_text(value, 5)}, {'most' if side > 0.0 else 'least'} {bound:g}"


def _fixed_torque(optimum: Optimum, goal: Goal) -> str:
    """Sentence about the part of a peak torque by the force on the follower, T_F = -F y', which no length changes."""
    if goal.field:
        return ""
    request = quantity_request(optimum.design, goal.key)
    if request.name != TORQUE or request.statistic not in PEAKS or not goal.minimise:
        return ""
    design = optimum.design if request.drive is None else only(optimum.design, request.drive)
    peak = many(optimum.design, constant_column(optimum.design, 1), [goal.key])
    study = Study(design).at_theta(np.deg2rad(peak.angle_deg[goal.key]))
    torque, power = (float(quantity(name).value(study)[0]) for name in (TORQUE, POWER))
    force_torque = -power / study.omega
    if force_torque * torque <= 0.0:
        return ""
    part = f"{_newton_metres(force_torque)} of {_newton_metres(torque)} N·m are force times y'"
    if abs(force_torque) > abs(torque):  # masses and friction reduce it
        part = (
            f"force times y' alone is {_newton_metres(force_torque)} N·m, more than all {_newton_metres(torque)} N·m,"
        )
    at = peak.angle_deg[goal.key][0]
    return f"{quantity(TORQUE).label}: {part} at {result_text(at)}°, which motion and load determine, for any lengths"


def _newton_metres(torque: float) -> str:
    """Size of a torque."""
    return result_text(abs(torque))


def _better_law(study: StudyOfMany, optimum: Optimum) -> str:
    """Sentence about the motion law with which the first goal is best, for all rises and with the same numbers."""
    goal, design = study.file.goals[0], optimum.design
    laws = [path for path in all_paths(design) if path.endswith(".law")]
    moving = [path for path in laws if get(design, path) != DWELL]
    if goal.field or not moving or any(row.field in laws for row in study.file.vary):
        return ""
    side, best = goal_sign(goal), optimum.goals[goal.key]
    check, least = FindingsCheck(design, waived=waived(study.file)), side * best - MIN_GAIN * abs(best)
    better = ""
    for value, law, variant in sorted(_law_variants(study, design, moving), key=lambda row: side * row[0]):
        if side * value >= least + AT_NODES * abs(best):
            break
        value = _kept_goal(study, variant)
        if side * value < least and not check.new(with_flywheel(variant, design)[0]):
            label, unit, least = LAWS[law].label, split_unit(goal.quantity)[1].symbol, side * value
            better = (
                f"Another law, {label} ({law}), with the same numbers brings the first goal to {result_text(value)}"
                f"{f' {unit}' if unit else ''} ({signed_text(100.0 * (value / best - 1.0), 3)} %)"
            )
    return better


def _law_variants(study: StudyOfMany, design: Design, paths: Sequence[str]) -> Iterator[tuple[float, str, Design]]:
    """First goal between the nodes, law and design of every motion law."""
    for law in LAWS:
        variant = with_words(design, dict.fromkeys(paths, law)) if law != DWELL else None
        if variant is None:
            continue
        goal = study.file.goals[0].key
        value = float(many(variant, constant_column(variant, 1), [goal], polish=False).value[goal][0])
        if math.isfinite(value):
            yield value, law, variant


def _kept_goal(study: StudyOfMany, design: Design) -> float:
    """First goal of a design; NaN where it violates a limit."""
    value = many(design, constant_column(design, 1), [row.key for row in study.quantities]).value
    keeps = all(side * value[limit.key][0] <= side * bound for limit, side, bound in bounds_of(study.file.limits))
    return float(value[study.file.goals[0].key][0]) if keeps else math.nan
