"""The best design of a study: many designs by Sobol's points, then from the best of these SLSQP (Kraft 1988) in epigraph form.

The largest value of a quantity over the turn is not smooth where one peak takes over from another. So it is never minimised itself, but
a bound t: minimise t such that f(θ_j; x) <= t at all peaks θ_j, and a limit likewise is one of each peak. Peaks move with the design: those
of the answer are added, and it is solved again, until no peak of the answer lies above t, or above a limit (exchange method, Hettich and
Kortanek 1993).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import field, replace
from itertools import product
from typing import Any

import numpy as np

from core.design import Design, edited, get, row_at
from core.errors import KindynaError
from core.find.checked import FindingsCheck, uneven
from core.find.on_shaft import with_least_flywheel
from core.frozen import frozen
from core.study import many
from core.study.batches.asked import Asked, asked_of
from core.study.batches.batch import at_once, together
from core.study.highest import nodes_of
from core.study.limits import ANY_PRESSURE, CONVEX, LIMITS
from core.varying.request import AskedFor, Goal, StudyFile, StudyOfMany
from core.varying.space import FAULTY, Axis, Space, apart, as_it_is, none_built, sobol, with_words
from core.varying.tolerances import ONE_SIDED, Scatter, Share, bounds_of

FIRST, OF_NONE = 1024, 64  # designs by Sobol's points, at most; twice as many for each number that is varied
STARTS = 6  # from the best of these
APART = 0.1  # of the bounds, in the mean: how far starts lie from each other at least
MOST_STEPS = 30  # of SLSQP in a round
ROUNDS = 25  # of adding peaks
STEP = 1e-5  # of the way between the bounds: for slopes at fixed angles
COMPARED = 3e-4  # the same, where extremes are searched anew
TRUST = 0.25  # of the bounds: the longest way of a round
LESS, LEAST_TRUST = 0.1, 1e-3  # of that, where it leads nowhere, as beyond the last design that can be built
ENOUGH = 1e-9  # of the bounds: a round that moves less is the last
SLIGHT = 1e-5  # of a limit: what is missed by so little is held further inside
INSET = 1e-9  # of a limit: answers lie on its safe side
SAME = 1e-5  # of their size: goals of starts that met in the same place
BINDING = 1e-6  # of a limit
NEAR_TOP = 0.3  # of its range: peaks that low take part
MOST_PEAKS = 8
MOST_WORDS = 512  # combinations of words and whole numbers
FRONT = 24  # points of a front
BETTER = 1e-6  # of the goal: what is no better than that is no change
ROBUST_MACHINES = 2000
ROBUST_ROUNDS = 8

Tell = Callable[[Mapping[str, Any], float, int], None]
"""A design on the way, by its fields, its goal, and the number of the start that it comes from. What it raises stops the search."""


class NoneBuilt(KindynaError):
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


@frozen(eq=False)
class Term:
    """What is held below a bound, as ``side`` times a quantity over the turn: a limit, or the goal, whose bound is t.

    peaks  signs of the quantity whose peaks over the turn all count; none where one extreme or a mean is taken as it is
    """

    row: AskedFor
    asked: Asked
    side: float
    bound: float | None
    peaks: tuple[float, ...]
    bend: float = 0.0

    def shown(self, value: Any) -> Any:
        """A value in such a form that it passes infinity smoothly: of the curvature κ of a profile that beside it, κ/(1 + κ r), which at a
        cusp is 1/r."""
        if not self.bend:
            return value
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(np.isinf(value), 1.0 / self.bend, value / (1.0 + value * self.bend))


Held = dict[int, list[tuple[float, int, float]]]
"""Number of a term that has peaks -> these: cam angle, piece, sign."""


def optimise(study: StudyOfMany, tell: Tell | None = None, starts: int = STARTS) -> Optimum:
    """The best design of a study within its limits, from so many starts for each combination of words.

    Raises KindynaError where nothing is asked that could be best.
    """
    if not study.file.goals:
        raise KindynaError("goals: none is stated; state one [[goals]], or two for a front")
    space = Space(study)
    words = [axis for axis in space.axes if apart(axis.info)]
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
    tell: Tell | None,
    starts: int,
) -> Optimum:
    """Of all combinations of words. margins: limit -> by how much it is kept and more."""
    found: list[Optimum] = []
    none: NoneBuilt | None = None
    numbers = [axis for axis in space.axes if not apart(axis.info)]
    for chosen in sets:
        values = dict(zip((axis.field for axis in words), chosen, strict=True))
        design = with_words(study.base, values)
        if design is None:
            continue
        search = _Search(study, design, values, numbers, margins, tell, starts)
        try:
            found.append(search.front() if len(study.file.goals) == 2 else search.best())
        except NoneBuilt as error:
            none = error
    if not found:
        raise none or KindynaError(f"vary: none of these words go together in this design ({FAULTY})")
    side = _side(study.file.goals[0])
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


def _side(goal: Goal) -> float:
    return 1.0 if goal.minimise else -1.0


class _Search:
    """The numbers of a design with fixed words: u, each 0 ... 1 between its bounds."""

    def __init__(
        self, study: StudyOfMany, design: Design, words: Mapping[str, Any], numbers: Sequence[Axis],
        margins: Mapping[str, float], tell: Tell | None, starts: int,
    ) -> None:  # fmt: skip
        self.study, self.design, self.words, self.tell, self.most_starts = study, design, words, tell, starts
        self._started = 0
        self.paths = tuple(axis.field for axis in numbers)
        ends = [(min(axis.listed), max(axis.listed)) if axis.listed else (axis.low, axis.high) for axis in numbers]
        self.low, self.high = (np.array([end[i] for end in ends], dtype=float) for i in (0, 1))
        self.terms = [self._term(row, side, bound) for row, side, bound in self._limits(margins)]
        goals = study.file.goals
        self.goals = [self._term(goal, _side(goal), None) for goal in goals]
        self.own = (np.array([float(get(design, path)) for path in self.paths]) - self.low) / (self.high - self.low)

    def _limits(self, margins: Mapping[str, float]) -> Iterator[tuple[AskedFor, float, float]]:
        for limit, side, bound in bounds_of(self.study.file.limits):
            yield limit, side, side * bound - margins.get(limit.key, 0.0)

    def _term(self, row: AskedFor, side: float, bound: float | None) -> Term:
        asked = asked_of(self.design, row.key)
        signs = {("max", 1.0): (1.0,), ("min", -1.0): (-1.0,), ("abs", 1.0): (1.0, -1.0)}.get((asked.of, side), ())
        if signs and (asked.drive is not None or not asked.name or not together(self.design, self.paths, asked)):
            signs = ()
        if signs and at_once(self.design, self.paths, self._numbers(np.full((len(self.paths), 1), 0.5))).apart.any():
            signs = ()
        roller = float(getattr(self.design.drive.face, "radius_mm", 0.0)) if asked.name == "profile_curvature" else 0.0
        return Term(row, asked, side, bound, signs, roller)

    def _numbers(self, u: np.ndarray) -> np.ndarray:
        """Fields (k, m) at places u (k, m)."""
        return self.low[:, None] + u * (self.high - self.low)[:, None]

    # -- values -------------------------------------------------------------------------------------------

    def values(self, u: np.ndarray, polish: bool = True) -> tuple[np.ndarray, np.ndarray]:
        """side times what each term asks (t, m) of designs u (k, m), the limits first; and which can be built (m,)."""
        keys = list(dict.fromkeys(term.row.key for term in [*self.terms, *self.goals]))
        numbers = dict(zip(self.paths, self._numbers(u), strict=True)) or as_it_is(self.design, u.shape[1])
        found = many(self.design, numbers, keys, polish=polish)
        rows = np.array([term.side * found.value[term.row.key] for term in [*self.terms, *self.goals]])
        return rows, np.asarray(found.reason == "")

    def excess(self, rows: np.ndarray, good: np.ndarray) -> np.ndarray:
        """By how much the limits are missed (m,), each as a part of itself, from values of ``values``."""
        over = np.zeros(rows.shape[1])
        for term, row in zip(self.terms, rows, strict=False):
            assert term.bound is not None, "a limit"
            over = np.maximum(
                over, (term.shown(term.side * row) * term.side - self._shown_bound(term)) / self._scale(term)
            )
        over = np.where(np.isfinite(rows[len(self.terms) :]).all(axis=0), over, np.inf)
        return np.where(good & np.isfinite(over), over, np.where(np.isfinite(over), 1e3 + over, np.inf))

    def _shown_bound(self, term: Term) -> float:
        assert term.bound is not None, "a limit"
        return float(term.side * term.shown(term.side * term.bound))

    def _scale(self, term: Term) -> float:
        return abs(self._shown_bound(term)) or 1.0

    def _at(
        self, u: np.ndarray, angles: Sequence[tuple[np.ndarray, np.ndarray]], terms: Sequence[Term]
    ) -> list[np.ndarray]:
        """Quantities of terms (m, n) at angles of each (theta, piece), of designs u (k, m); NaN where there is none."""
        one = at_once(self.design, self.paths, self._numbers(u))
        theta, piece = (np.concatenate([each[i] for each in angles]) for i in (0, 1))
        n, m = theta.size, one.count
        owner = np.repeat(np.arange(m), n)
        names = list(dict.fromkeys(term.asked.name for term in terms))
        state = one.state(np.tile(theta, m), np.tile(piece, m), owner)
        found = one.values(names, state, owner)
        lost = one.lost_at("dynamics") if any(_of_forces(term) for term in terms) else one.lost_at("cam")
        rows, first = [], 0
        for term, (own, _) in zip(terms, angles, strict=True):
            row = found[term.asked.name].reshape(m, n)[:, first : first + own.size] / term.asked.unit
            rows.append(np.where(lost[:, None], np.nan, row))
            first += own.size
        return rows

    def peaks(self, u: np.ndarray, terms: Sequence[Term]) -> list[list[tuple[float, int, float]]]:
        """Of each term its highest local maxima at a design (k,): cam angle, piece, sign."""
        one = at_once(self.design, self.paths, self._numbers(u[:, None]))
        nodes, _ = nodes_of(one.program)
        theta, piece = nodes.theta, nodes.piece
        every = self._at(u[:, None], [(theta, piece)] * len(terms), terms)
        first = np.append(True, np.diff(piece) != 0)
        last = np.append(np.diff(piece) != 0, True)
        found = []
        for term, row in zip(terms, every, strict=True):
            mine: list[tuple[float, float, int, float]] = []
            shown = term.shown(row[0])
            spread = float(np.ptp(shown)) if np.isfinite(shown).all() else np.inf
            for sign in term.peaks:
                f = sign * shown
                left, right = np.where(first, -np.inf, np.roll(f, 1)), np.where(last, -np.inf, np.roll(f, -1))
                local = np.flatnonzero((f >= left) & (f >= right) & (f >= f.max() - NEAR_TOP * spread))
                if not local.size:
                    continue
                lo, hi = theta[np.where(first[local], local, local - 1)], theta[np.where(last[local], local, local + 1)]
                at = piece[local]
                for _ in range(
                    5
                ):  # each time to a quarter; on either side of a kink between, where friction turns, there is a peak
                    between = lo[:, None] + (hi - lo)[:, None] * np.linspace(0.0, 1.0, 9)
                    (values,) = self._at(u[:, None], [(between.ravel(), np.repeat(at, 9))], [term])
                    g = np.pad(sign * term.shown(values[0]).reshape(-1, 9), ((0, 0), (1, 1)), constant_values=-np.inf)
                    rows, top = np.nonzero((g[:, 1:-1] > g[:, :-2]) & (g[:, 1:-1] >= g[:, 2:]))
                    lo, hi = between[rows, np.maximum(top - 1, 0)], between[rows, np.minimum(top + 1, 8)]
                    best, place, at = g[rows, top + 1], between[rows, top], at[rows]
                mine += [(float(b), float(p), int(a), sign) for b, p, a in zip(best, place, at, strict=True)]
            mine.sort(reverse=True)
            found.append([(p, a, sign) for _, p, a, sign in mine[:MOST_PEAKS]])
        return found

    # -- from one start -----------------------------------------------------------------------------------

    def solved(self, start: np.ndarray, goal: Term, extra: Sequence[Term] = ()) -> np.ndarray:
        """The place (k,) to which SLSQP leads from a start (k,): rounds of it, each with the peaks of the answers before."""
        terms = [*self.terms, *extra, goal]
        peaked = [term for term in terms if term.peaks]
        u = np.clip(start, 0.0, 1.0)
        held: Held = {}
        inset, trust, far = INSET, TRUST, True
        self._started += 1
        for _ in range(ROUNDS):
            self._say(u, goal)
            if not self._add(held, peaked, u):
                return u
            new = self._round(u, terms, peaked, held, goal, inset, trust)
            moved = float(np.abs(new - u).max())
            u = new
            if moved < ENOUGH and far and trust > LEAST_TRUST:
                trust *= LESS
            elif moved >= ENOUGH:
                far = moved > 0.5 * trust
            else:
                over = float(self.excess(*self.values(u[:, None]))[0])
                if not 0.0 < over < SLIGHT:
                    break
                inset += 2.0 * over
        return u

    def _say(self, u: np.ndarray, goal: Term) -> None:
        """Where the search is."""
        if self.tell is not None:
            rows, _ = self.values(u[:, None], polish=False)
            at = len(self.terms) + [each.row for each in self.goals].index(goal.row)
            self.tell(self._fields(u), float(goal.side * rows[at, 0]), self._started)

    def _add(self, held: Held, peaked: Sequence[Term], u: np.ndarray) -> bool:
        """Add the peaks of a design to those that are held, in place of those close by; False where it has none."""
        try:
            found = self.peaks(u, peaked) if peaked else []
        except (ValueError, KindynaError):
            return False
        for i, rows in enumerate(found):
            kept = held.get(i, [])
            for place, piece, sign in rows:
                kept = [each for each in kept if abs(each[0] - place) > 2e-3 or each[1:] != (piece, sign)]
            held[i] = ([*rows, *kept])[: 3 * MOST_PEAKS]
        return all(held.get(i) for i in range(len(peaked)))

    def _round(
        self, u: np.ndarray, terms: Sequence[Term], peaked: Sequence[Term], held: Held,
        goal: Term, inset: float, trust: float,
    ) -> np.ndarray:  # fmt: skip
        """SLSQP at fixed angles: minimise t subject to t - f_goal(θ_j) >= 0 and bound - f(θ_j) >= 0."""

        def rows(place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            linear = self._linear(place, terms, held)
            return np.concatenate([each[1] for each in linear]), np.concatenate([each[2] for each in linear])

        owners = [term for term, each, _ in self._linear(u, terms, held) for _ in each]
        bound = np.array([np.nan if term is goal else self._shown_bound(term) for term in owners])
        scale = np.array([1.0 if term is goal else self._scale(term) for term in owners])
        return epigraph(rows, bound, scale, u, np.maximum(u - trust, 0.0), np.minimum(u + trust, 1.0), inset)

    def _linear(self, u: np.ndarray, terms: Sequence[Term], held: Held) -> list[tuple[Term, np.ndarray, np.ndarray]]:
        """Of each term the values (n,) at the peaks that are held, or its one value, and their slopes (n, k)."""
        k, found = u.size, []
        peaked, rest = [term for term in terms if term.peaks], [term for term in terms if not term.peaks]
        if peaked:
            angles = [
                (np.array([each[0] for each in held[p]]), np.array([each[1] for each in held[p]]))
                for p in range(len(peaked))
            ]
            every = self._at(_beside(u, STEP), angles, peaked)
            for p, (term, each) in enumerate(zip(peaked, every, strict=True)):
                f = np.array([sign for _, _, sign in held[p]]) * term.shown(each)
                found.append((term, f[0], (f[1 : k + 1] - f[k + 1 :]).T / (2.0 * STEP)))
        if rest:
            numbers = dict(zip(self.paths, self._numbers(_beside(u, COMPARED)), strict=True))
            values = many(self.design, numbers, [term.row.key for term in rest]).value
            for term in rest:
                f = term.side * term.shown(values[term.row.key])
                found.append((term, f[:1], (f[1 : k + 1] - f[k + 1 :])[None] / (2.0 * COMPARED)))
        return found

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
            raise NoneBuilt(self._why_none(u))
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
        return none_built(u.shape[1], code or "no value", often)

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

    def _fields(self, u: np.ndarray) -> dict[str, Any]:
        numbers = self._numbers(u[:, None])[:, 0].tolist()
        order = [row.field for row in self.study.file.vary]
        found = {**self.words, **dict(zip(self.paths, numbers, strict=True))}
        return {field: found[field] for field in order}

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


def epigraph(
    rows: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], bound: np.ndarray, scale: np.ndarray, start: np.ndarray,
    low: np.ndarray, high: np.ndarray, inset: float = 0.0,
) -> np.ndarray:  # fmt: skip
    """The place (k,) between low and high where the largest of the functions without a bound is least, while the others are below theirs:
    minimise t subject to t - f_j(x) >= 0 and b_j - f_j(x) >= 0, by SLSQP.

    rows: place -> values (c,) and slopes (c, k); bound (c,): NaN of those that are minimised; scale (c,): of each bound; inset: of its
    scale, how far below its bound each is to be. The start where nothing can be computed there, or at the end.
    """
    from scipy.optimize import minimize

    k, of_goal = start.size, np.isnan(bound)
    memory: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def known(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = z[:k].tobytes()
        if key not in memory:
            memory[key] = rows(z[:k])
        return memory[key]

    value, slope = known(start)
    if not np.isfinite(value).all():
        return start
    size = max(float(np.abs(value[of_goal]).max()), float(np.abs(slope[of_goal] * (high - low)).max())) or 1.0
    scale = np.where(of_goal, size, scale)

    def constraints(z: np.ndarray) -> np.ndarray:
        value, _ = known(z)
        room = np.where(of_goal, z[k] - value / scale, (bound - value) / scale - inset)
        return np.where(np.isfinite(room), room, -1e2)

    def jacobian(z: np.ndarray) -> np.ndarray:
        made = np.hstack([-known(z)[1] / scale[:, None], of_goal[:, None].astype(float)])
        return np.where(np.isfinite(made), made, 0.0)

    t, gradient = float((value / scale)[of_goal].max()), np.append(np.zeros(k), 1.0)
    found = minimize(
        lambda z: float(z[k]), np.append(start, t), jac=lambda z: gradient, method="SLSQP",
        bounds=[*zip(low, high, strict=True), (None, None)],
        constraints=[{"type": "ineq", "fun": constraints, "jac": jacobian}], options={"maxiter": MOST_STEPS, "ftol": 1e-13},
    )  # fmt: skip
    new = np.clip(found.x[:k], low, high)
    return new if np.isfinite(new).all() and np.isfinite(known(new)[0]).all() else start


def waived(file: StudyFile) -> set[str]:
    """Findings of limits for which a study states its own: of pressure angle, curvature, and transmission angles."""
    stated = {limit.quantity for limit in file.limits}
    keys = {"pressure_angle_deg": (ANY_PRESSURE,), "profile_curvature_per_mm": (CONVEX,)}
    found = {code for slug, rows in keys.items() if slug in stated for key in rows for code in LIMITS[key].findings}
    return found | {"transmission-angle" for slug in stated if slug.startswith("transmission_")}


def with_flywheel(design: Design, before: Design) -> tuple[Design, Mapping[str, float]]:
    """The design, with a flywheel that keeps the speed as even as is wanted where that of the design before did; and this."""
    if uneven(design) and not uneven(before):
        with suppress(KindynaError):
            return with_least_flywheel(design)
    return design, {}


def _of_forces(term: Term) -> bool:
    from core.study.quantities import quantity

    return quantity(term.asked.name).stage == "dynamics"


def _beside(u: np.ndarray, step: float) -> np.ndarray:
    """A place (k,) and those beside it (k, 1 + 2 k): upwards, then downwards."""
    steps = step * np.eye(u.size)
    return np.hstack([u[:, None], u[:, None] + steps, u[:, None] - steps])


def _own_goals(study: StudyOfMany) -> dict[str, float]:
    """Of the design as it is; NaN where it has none."""
    found = many(study.base, as_it_is(study.base, 1), [goal.key for goal in study.file.goals])
    return {goal.key: float(found.value[goal.key][0]) for goal in study.file.goals}


def _undominated(points: Sequence[Mapping[str, Any]], goals: Sequence[Goal]) -> list[Mapping[str, Any]]:
    """Points than which none is as good in both goals and better in one, by the first goal."""
    worth = np.array([[_side(goal) * point[goal.column] for goal in goals] for point in points]).reshape(-1, len(goals))
    kept = [
        i for i, own in enumerate(worth)
        if not any((other <= own).all() and (other < own).any() for other in worth) and not (worth[:i] == own).all(axis=1).any()
    ]  # fmt: skip
    return [points[i] for i in sorted(kept, key=lambda i: worth[i, 0])]


def _robust(
    study: StudyOfMany, space: Space, words: Sequence[Axis], sets: Sequence[Any], tell: Tell | None, starts: int
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


__all__ = ["Binding", "Optimum", "optimise"]
