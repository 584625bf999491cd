"""The best design of a study: many designs by Sobol's points, then from the best of these SLSQP (Kraft 1988), round by round
(``descent``); of all combinations of words; of two goals a front; with a share of machines within the limits, where that is asked for."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import field, replace
from itertools import product
from typing import Any

import numpy as np

from core.design import Design, all_paths, edited, get, only, row_at
from core.errors import KindynaError
from core.find.shaft import with_least_flywheel
from core.find.trial import FindingsCheck, has_uneven_speed
from core.frozen import frozen
from core.laws import LAWS
from core.study import Study, many
from core.study.batch import FAULTY
from core.study.limits import ANY_PRESSURE, CONVEX, LIMITS
from core.study.quantities import quantity
from core.study.quantity_requests import quantity_request
from core.units import split_unit
from core.varying.descent import Descent, Held, ProgressCallback, Term, goal_sign
from core.varying.request import Goal, StudyFile, StudyOfMany
from core.varying.space import Axis, Space, constant_column, is_discrete, none_built_text, sobol, with_words
from core.varying.tolerances import ONE_SIDED, Scatter, Share, bounds_of

# -- the best design of a study ---------------------------------------------------------------------------------


FIRST, OF_NONE = 1024, 64  # designs by Sobol's points, at most; twice as many for each number that is varied
STARTS = 6  # from the best of these
APART = 0.1  # of the bounds, in the mean: how far starts lie from each other at least
SAME = 1e-5  # of their size: goals of starts that met in the same place
BINDING = 1e-6  # of a limit
MOST_WORDS = 512  # combinations of words and whole numbers
FRONT = 24  # points of a front
BETTER = 1e-6  # of the goal: what is no better than that is no change
ROBUST_MACHINES = 2000
ROBUST_ROUNDS = 8


class NoDesignBuilt(KindynaError):
    """None of many designs can be built."""


@frozen
class Binding:
    """A limit, or the bound of a field, at which the answer stands; by how much the goal changes for 1 % more of it."""

    limit: str
    per_percent: float


@frozen(eq=False)
class Optimum:
    """The best design. kept: whether it keeps the limits, else it is the one that misses them least; better: whether it is better than the
    design of the study; goals: of the answer and of that design; starts, and how many of them met in the same place; front: of two
    goals, points none of which is better in both; share: of random machines within the limits, where that is asked for; against:
    what a check has against a design that would be better still; taken: what else goes into the design, a flywheel."""

    design: Design
    answer: Mapping[str, Any]
    goals: Mapping[str, float]
    before: Mapping[str, float]
    kept: bool
    better: bool
    binding: tuple[Binding, ...] = ()
    starts: int = 0
    agreeing: int = 0
    front: tuple[Mapping[str, Any], ...] = ()
    share: Share | None = None
    against: str = ""
    taken: Mapping[str, float] = field(default_factory=dict)


def optimise(study: StudyOfMany, tell: ProgressCallback | None = None, starts: int = STARTS) -> Optimum:
    """The best design of a study within its limits, from so many starts for each combination of words.

    Raises KindynaError where nothing is asked that could be best.
    """
    if not study.file.goals:
        raise KindynaError("goals: none is stated; state one [[goals]], or two for a front")
    space = Space(study)
    words = [axis for axis in space.axes if is_discrete(axis.info)]
    sets = list(product(*(_choices(axis) for axis in words)))
    if len(sets) > MOST_WORDS:
        raise KindynaError(
            f"vary: {len(sets):,} combinations of words and whole numbers are too many; allowed: at most {MOST_WORDS}"
        )
    if study.file.robust is not None:
        return _robust(study, space, words, sets, tell, starts)
    return _best(study, space, words, sets, {}, tell, starts)


def _choices(axis: Axis) -> Sequence[Any]:
    if axis.count:
        column = axis.at(np.arange(axis.count))
        return [each if isinstance(each, str) else int(each) for each in column.tolist()]
    return range(int(axis.low), int(axis.high) + 1)


def _best(
    study: StudyOfMany,
    space: Space,
    words: Sequence[Axis],
    sets: Sequence[Any],
    margins: Mapping[str, float],
    tell: ProgressCallback | None,
    starts: int,
) -> Optimum:
    """Of all combinations of words. margins: limit -> by how much it is kept and more."""
    found: list[Optimum] = []
    none: NoDesignBuilt | None = None
    numbers = [axis for axis in space.axes if not is_discrete(axis.info)]
    for chosen in sets:
        values = dict(zip((axis.field for axis in words), chosen, strict=True))
        design = with_words(study.base, values)
        if design is None:
            continue
        search = _Search(study, design, values, numbers, margins, tell, starts)
        try:
            found.append(search.front() if len(study.file.goals) == 2 else search.best())
        except NoDesignBuilt as error:
            none = error
    if not found:
        raise none or KindynaError(f"vary: none of these words go together in this design ({FAULTY})")
    side = goal_sign(study.file.goals[0])
    key = study.file.goals[0].key
    best = min(found, key=lambda each: (not each.kept, side * each.goals[key] if each.kept else 0.0))
    for each in found:  # the design as it is, which other words do not better
        if (
            each.kept
            and not each.better
            and side * (each.goals[key] - best.goals[key]) <= BETTER * abs(each.goals[key])
        ):
            best = each
    if len(study.file.goals) == 2:
        front = _undominated([point for each in found for point in each.front], study.file.goals)
        return replace(best, front=tuple(front))
    return best


class _Search(Descent):
    """From all starts the best design, or the front of two goals."""

    # -- all starts ---------------------------------------------------------------------------------------

    def starts(self) -> list[np.ndarray]:
        """The design itself where it lies within the bounds, and the best of Sobol's points that lie apart from each other."""
        chosen = [self.own] if ((self.own >= 0.0) & (self.own <= 1.0)).all() else []
        if len(chosen) == self.most_starts:
            return chosen
        k = len(self.paths)
        u = sobol(k, self.study.file.seed, 0, min(FIRST, OF_NONE << k)).T
        rows, good = self.values(u, polish=False)
        over, goal = self.excess(rows, good), rows[-len(self.goals)]
        if not (good & np.isfinite(over)).any() and not (chosen and self.values(self.own[:, None])[1].any()):
            raise NoDesignBuilt(self._why_none(u))
        order = np.lexsort((goal, np.maximum(over, 0.0)))
        for i in order:
            if len(chosen) >= self.most_starts or not np.isfinite(over[i]):
                break
            if all(np.abs(u[:, i] - each).mean() > APART for each in chosen):
                chosen.append(u[:, i])
        return chosen

    def best(self) -> Optimum:
        """The best of all starts that a check has nothing against."""
        goal, starts = self.goals[0], self.starts() if self.paths else [np.zeros(0)]
        if not self.paths:
            return self._chosen(starts, goal)
        return self._chosen([self.solved(start, goal) for start in starts], goal)

    def _why_none(self, u: np.ndarray) -> str:
        """That none of these designs u (k, m) can be built, and the commonest reason."""
        keys = [goal.row.key for goal in self.goals]
        numbers = dict(zip(self.paths, self._numbers(u), strict=True))
        (code, often), *_ = Counter(many(self.design, numbers, keys, polish=False).reason.tolist()).most_common(1)
        return none_built_text(u.shape[1], code or "no value", often)

    def _chosen(self, places: Sequence[np.ndarray], goal: Term) -> Optimum:
        """The best place that keeps the limits and brings no new finding."""
        rows, good = self.values(np.array([*places, np.clip(self.own, 0.0, 1.0)]).T)
        over, goals = self.excess(rows, good), rows[len(self.terms) + self.goals.index(goal)]
        keeps = over <= 0.0
        inside = (
            bool(((self.own >= 0.0) & (self.own <= 1.0)).all()) and bool(keeps[-1]) and self.design == self.study.base
        )
        order = [int(i) for i in np.argsort(np.where(keeps[:-1], goals[:-1], np.inf)) if keeps[i]]
        if not order and not inside:
            return self._of(places[int(np.argmin(over[:-1]))], len(places), 0, kept=False)
        check = FindingsCheck(self.study.base, waived=waived(self.study.file))
        against = ""
        for i in order:
            if inside and goals[i] > goals[-1] - BETTER * abs(goals[-1]):
                break
            new = check.new(self._whole(places[i])[0])
            if not new:
                agreeing = int((np.abs(goals[order] - goals[i]) <= SAME * abs(goals[i])).sum())
                return self._of(places[i], len(places), agreeing, against=against)
            against = against or "; ".join(new)
        if not inside:
            return self._of(places[order[0]], len(places), 0, kept=False, against=against)
        if against:
            between = self._towards(places[order[0]], check)
            if between is not None:
                return self._of(between, len(places), 1, against=against)
        return self._of(self.own, len(places), 0, against=against, better=False)

    def _towards(self, place: np.ndarray, check: FindingsCheck) -> np.ndarray | None:
        """The design on the way to a place that is the last one to bring no finding."""
        part, step, found = 0.0, 0.5, None
        for _ in range(12):
            u = self.own + (part + step) * (place - self.own)
            if float(self.excess(*self.values(u[:, None]))[0]) <= 0.0 and not check.new(self._whole(u)[0]):
                part, found = part + step, u
            step *= 0.5
        return found

    def _design(self, u: np.ndarray) -> Design:
        design, kept = self.design, {row_at(path)[1] for path in self.paths if path.startswith("motion.")}
        for path, value in zip(self.paths, self._numbers(u[:, None])[:, 0].tolist(), strict=True):
            design = edited(design, path, value, kept)
        return design

    def _whole(self, u: np.ndarray) -> tuple[Design, Mapping[str, float]]:
        return with_flywheel(self._design(u), self.study.base)

    def _of(
        self, u: np.ndarray, starts: int, agreeing: int, *, kept: bool = True, better: bool = True, against: str = ""
    ) -> Optimum:
        rows, _ = self.values(u[:, None])
        first = len(self.terms)
        goals = {goal.row.key: float(goal.side * rows[first + i, 0]) for i, goal in enumerate(self.goals)}
        before = _own_goals(self.study)
        binding = self.binding(u, self.goals[0]) if kept and u.size else ()
        design, taken = self._whole(u)
        return Optimum(
            design,
            self._fields(u),
            goals,
            before,
            kept,
            kept and better,
            tuple(binding),
            starts,
            agreeing,
            (),
            None,
            against,
            taken,
        )

    def binding(self, u: np.ndarray, goal: Term) -> list[Binding]:
        """At an answer: multipliers λ >= 0 of t's gradient = Σ λ_j of those of the constraints that hold it (Karush 1939), by non-negative
        least squares; a limit L changes the goal by λ L/100 for 1 % of it."""
        from scipy.optimize import nnls

        terms = [*self.terms, goal]
        peaked = [term for term in terms if term.peaks]
        held: Held = {}
        if peaked and not self._add(held, peaked, u):
            return []
        k = u.size
        names: list[str] = []
        columns: list[np.ndarray] = []
        worth: list[float] = []
        found = [
            (term, float(value), slope)
            for term, values, slopes in self._linear(u, terms, held)
            for value, slope in zip(values, slopes, strict=True)
            if np.isfinite(slope).all()
        ]
        top = max((value for term, value, _ in found if term is goal), default=np.nan)
        if np.isnan(top):
            return []
        size = abs(top) or 1.0
        for term, value, slope in found:
            if term is goal:
                if top - value <= 1e-5 * size:
                    names.append("")
                    columns.append(np.append(slope / size, 1.0))
                    worth.append(0.0)
            elif self._shown_bound(term) - value <= BINDING * self._scale(term):
                b = term.bound or 0.0
                rate = abs(self._shown_bound(replace(term, bound=b * (1.0 + 1e-6))) - self._shown_bound(term)) / (
                    abs(b) * 1e-6 or 1.0
                )
                names.append(term.row.column)
                columns.append(np.append(slope / self._scale(term), 0.0))
                worth.append(abs(b) * rate / self._scale(term))
        for i, path in enumerate(self.paths):
            for at, way, end in ((0.0, -1.0, float(self.low[i])), (1.0, 1.0, float(self.high[i]))):
                if abs(u[i] - at) < 1e-7:
                    names.append(path)
                    columns.append(np.append(way * np.eye(k)[i], 0.0))
                    worth.append(abs(end) / (self.high[i] - self.low[i]))
        wanted = np.append(np.zeros(k), 1.0)
        weights, _ = nnls(np.array(columns).T, wanted)
        by_name: dict[str, float] = {}
        for name, weight, each in zip(names, weights, worth, strict=True):
            if name and weight > 1e-9:
                by_name[name] = by_name.get(name, 0.0) - 0.01 * weight * each * size * goal.side
        return [
            Binding(name, float(change)) for name, change in sorted(by_name.items(), key=lambda item: -abs(item[1]))
        ]

    # -- two goals ----------------------------------------------------------------------------------------

    def front(self) -> Optimum:
        """Of two goals: each by itself, then the first one with the second held below values between (ε-constraint, Haimes 1971)."""
        first, second = self.goals
        starts = self.starts()
        ends = []
        for i, goal in enumerate(self.goals):
            places = [self.solved(start, goal) for start in starts[:3]]
            ends.append(min(places, key=lambda u, i=i: self._merit(u, i)))  # type: ignore[misc]
        rows, _ = self.values(np.array(ends).T)
        levels = rows[len(self.terms) + 1]
        places, u = [ends[0]], ends[0]
        for level in np.linspace(levels[0], levels[1], FRONT)[1:-1]:
            held = replace(second, bound=float(level))
            u = self.solved(u, first, (held,))
            places.append(u)
        places.append(ends[1])
        rows, good = self.values(np.array(places).T)
        keeps = self.excess(rows, good) <= 0.0
        points: list[Mapping[str, Any]] = [
            {**self._fields(u), **{goal.row.column: float(goal.side * rows[len(self.terms) + i, j]) for i, goal in enumerate(self.goals)}}
            for j, u in enumerate(places) if keeps[j]
        ]  # fmt: skip
        points = _undominated(points, self.study.file.goals)
        return replace(
            self._chosen([u for u, keep in zip(places, keeps, strict=True) if keep] or places, first),
            front=tuple(points),
        )

    def _merit(self, u: np.ndarray, goal: int) -> tuple[float, float]:
        rows, good = self.values(u[:, None])
        return max(float(self.excess(rows, good)[0]), 0.0), float(rows[len(self.terms) + goal, 0])


def waived(file: StudyFile) -> set[str]:
    """Findings of limits for which a study states its own: of pressure angle, curvature, and transmission angles."""
    stated = {limit.quantity for limit in file.limits}
    keys = {"pressure_angle_deg": (ANY_PRESSURE,), "profile_curvature_per_mm": (CONVEX,)}
    found = {code for slug, rows in keys.items() if slug in stated for key in rows for code in LIMITS[key].findings}
    return found | {"transmission-angle" for slug in stated if slug.startswith("transmission_")}


def with_flywheel(design: Design, before: Design) -> tuple[Design, Mapping[str, float]]:
    """The design, with a flywheel that keeps the speed as even as is wanted where that of the design before did; and this."""
    if has_uneven_speed(design) and not has_uneven_speed(before):
        with suppress(KindynaError):
            return with_least_flywheel(design)
    return design, {}


def _own_goals(study: StudyOfMany) -> dict[str, float]:
    """Of the design as it is; NaN where it has none."""
    found = many(study.base, constant_column(study.base, 1), [goal.key for goal in study.file.goals])
    return {goal.key: float(found.value[goal.key][0]) for goal in study.file.goals}


def _undominated(points: Sequence[Mapping[str, Any]], goals: Sequence[Goal]) -> list[Mapping[str, Any]]:
    """Points than which none is as good in both goals and better in one, by the first goal."""
    worth = np.array([[goal_sign(goal) * point[goal.column] for goal in goals] for point in points]).reshape(
        -1, len(goals)
    )
    kept = [
        i for i, own in enumerate(worth)
        if not any((other <= own).all() and (other < own).any() for other in worth) and not (worth[:i] == own).all(axis=1).any()
    ]  # fmt: skip
    return [points[i] for i in sorted(kept, key=lambda i: worth[i, 0])]


def _robust(
    study: StudyOfMany,
    space: Space,
    words: Sequence[Axis],
    sets: Sequence[Any],
    tell: ProgressCallback | None,
    starts: int,
) -> Optimum:
    """With limits narrowed by z times the deviation that the tolerances make, by the sensitivities at the answer before; then random
    machines; z grows until the lower end of Wilson's interval is at the share that is asked for."""
    wanted = study.file.robust
    assert wanted is not None, "a robust study"
    margins: dict[str, float] = {}
    widened = ONE_SIDED
    best = _best(study, space, words, sets, margins, tell, starts)
    for _ in range(ROBUST_ROUNDS):
        if not best.kept:
            return best
        here = StudyOfMany(best.design, study.file, study.folder)
        scatter = Scatter(here)
        share = scatter.share(ROBUST_MACHINES, study.file.seed)
        best = replace(best, share=share)
        if share.interval[0] >= wanted:
            return best
        slopes = scatter.slopes()
        sigma = np.array([row.deviation for row in scatter.tolerances])
        deviation = np.sqrt(((slopes * sigma[:, None]) ** 2).sum(axis=0))
        margins = {limit.key: widened * float(deviation[scatter.keys.index(limit.key)]) for limit in study.file.limits}
        widened *= 1.15
        best = _best(study, space, words, sets, margins, tell, starts)
    return replace(best, kept=False)


# -- what is said of the best design of a study beside it -------------------------------------------------------


TORQUE, POWER = "drive_torque", "power.load"
PEAKS = ("max", "abs")
MORE = 0.01  # of the goal: a law that gives no more than that is not worth a word
WHOLE = 1000.0  # N·m, from which on a torque is said without decimals
DWELL = "dwell"


def remarks(study: StudyOfMany, found: Optimum) -> tuple[str, ...]:
    """Sentences about an answer that keeps the limits, which cost a design of each law; the limits missed by one that does not."""
    if not found.kept:
        return tuple(_missed(study, found))
    said = [_fixed(found, goal) for goal in study.file.goals]
    return tuple(each for each in (*said, _law(study, found)) if each)


def _missed(study: StudyOfMany, found: Optimum) -> Iterator[str]:
    """What the design reaches of each limit that it does not keep."""
    bounds = list(bounds_of(study.file.limits))
    reached = many(found.design, constant_column(found.design, 1), [limit.key for limit, _, _ in bounds]).value
    for limit, side, bound in bounds:
        value = float(reached[limit.key][0])
        if not side * value <= side * bound:
            yield f"{limit.key} = {value:.7g}, {'most' if side > 0.0 else 'least'} {bound:g}"


def _fixed(found: Optimum, goal: Goal) -> str:
    """Of a peak torque what a force on the follower takes: T_F = -F y', by the balance of power at constant speed."""
    asked = quantity_request(found.design, goal.key)
    if asked.name != TORQUE or asked.statistic not in PEAKS or not goal.minimise:
        return ""
    design = found.design if asked.drive is None else only(found.design, asked.drive)
    peak = many(found.design, constant_column(found.design, 1), [goal.key])
    there = Study(design).at_theta(np.deg2rad(peak.angle_deg[goal.key]))
    torque, power = (float(quantity(name).value(there)[0]) for name in (TORQUE, POWER))
    held = -power / there.omega
    if held * torque <= 0.0:
        return ""
    part = f"{_newton_metres(held)} of {_newton_metres(torque)} N·m are force times y'"
    if abs(held) > abs(torque):  # masses and friction take some off
        part = f"force times y' alone is {_newton_metres(held)} N·m, more than all {_newton_metres(torque)} N·m,"
    at = peak.angle_deg[goal.key][0]
    return f"{quantity(TORQUE).label}: {part} at {at:.2f}°, which motion and load fix, whatever the lengths"


def _newton_metres(torque: float) -> str:
    """Four digits of a small one, a large one to 1 N·m."""
    return f"{abs(torque):,.0f}" if abs(torque) >= WHOLE else f"{abs(torque):.4g}"


def _law(study: StudyOfMany, found: Optimum) -> str:
    """The law that, put in for those of all rises with the same numbers, makes the first goal best and brings no new finding."""
    goal, design = study.file.goals[0], found.design
    laws = [path for path in all_paths(design) if path.endswith(".law")]
    moved = [path for path in laws if get(design, path) != DWELL]
    if not moved or any(row.field in laws for row in study.file.vary):
        return ""
    side, own = 1.0 if goal.minimise else -1.0, found.goals[goal.key]
    check = FindingsCheck(design, waived=waived(study.file))
    for value, law, made in sorted(_others(study, design, moved), key=lambda row: side * row[0]):
        if side * (own - value) <= MORE * abs(own):
            break
        if not check.new(with_flywheel(made, design)[0]):
            label, unit = LAWS[law].label, split_unit(goal.quantity)[1].symbol
            return (
                f"Another law, {label} ({law}), with the same numbers brings the first goal to {value:.5g}"
                f"{f' {unit}' if unit else ''} ({100.0 * (value / own - 1.0):+.1f} %)"
            )
    return ""


def _others(study: StudyOfMany, design: Design, paths: Sequence[str]) -> Iterator[tuple[float, str, Design]]:
    """The first goal with each law that keeps the limits, the law, and the design."""
    keys = [row.key for row in study.quantities]
    for law in LAWS:
        made = with_words(design, dict.fromkeys(paths, law)) if law != DWELL else None
        if made is None:
            continue
        value = many(made, constant_column(made, 1), keys).value
        if all(side * value[limit.key][0] <= side * bound for limit, side, bound in bounds_of(study.file.limits)):
            goal = float(value[study.file.goals[0].key][0])
            if math.isfinite(goal):
                yield goal, law, made
