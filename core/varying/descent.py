"""One search from one start: SLSQP in epigraph form (``epigraph``), round by round, with the peaks over the turn of the answers before.

The largest value of a quantity over the turn is not smooth where one peak takes over from another. So it is never minimised itself, but
a bound t: minimise t such that f(θ_j; x) <= t at all peaks θ_j, and a limit likewise is one of each peak. Peaks move with the design: those
of the answer are added, and it is solved again, until no peak of the answer lies above t, or above a limit (exchange method, Hettich and
Kortanek 1993).
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
from core.varying.request import Goal, StudyOfMany, StudyQuantity
from core.varying.space import Axis, constant_column
from core.varying.tolerances import bounds_of

# -- the least of the largest of several functions, below bounds of others --------------------------------------


MOST_STEPS = 30  # of SLSQP in a round


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


# -- one search from one start ----------------------------------------------------------------------------------


ROUNDS = 25  # of adding peaks
STEP = 1e-5  # of the way between the bounds: for slopes at fixed angles
COMPARED = 3e-4  # the same, where extremes are searched anew
TRUST = 0.25  # of the bounds: the longest way of a round
LESS, LEAST_TRUST = 0.1, 1e-3  # of that, where it leads nowhere, as beyond the last design that can be built
ENOUGH = 1e-9  # of the bounds: a round that moves less is the last
SLIGHT = 1e-5  # of a limit: what is missed by so little is held further inside
INSET = 1e-9  # of a limit: answers lie on its safe side
NEAR_TOP = 0.3  # of its range: peaks that low take part
MOST_PEAKS = 8

ProgressCallback = Callable[[Mapping[str, Any], float, int], None]
"""A design on the way, by its fields, its goal, and the number of the start that it comes from. What it raises stops the search."""


@frozen(eq=False)
class Term:
    """What is held below a bound, as ``side`` times a quantity over the turn: a limit, or the goal, whose bound is t.

    peaks  signs of the quantity whose peaks over the turn all count; none where one extreme or a mean is taken as it is
    """

    row: StudyQuantity
    asked: QuantityRequest
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


class Descent:
    """The numbers of a design with fixed words: u, each 0 ... 1 between its bounds; from a place to the best one near it."""

    def __init__(
        self, study: StudyOfMany, design: Design, words: Mapping[str, Any], numbers: Sequence[Axis],
        margins: Mapping[str, float], tell: ProgressCallback | None, starts: int,
    ) -> None:  # fmt: skip
        self.study, self.design, self.words, self.tell, self.most_starts = study, design, words, tell, starts
        self._started = 0
        self.paths = tuple(axis.field for axis in numbers)
        ends = [(min(axis.listed), max(axis.listed)) if axis.listed else (axis.low, axis.high) for axis in numbers]
        self.low, self.high = (np.array([end[i] for end in ends], dtype=float) for i in (0, 1))
        self.terms = [self._term(row, side, bound) for row, side, bound in self._limits(margins)]
        goals = study.file.goals
        self.goals = [self._term(goal, goal_sign(goal), None) for goal in goals]
        self.own = (np.array([float(get(design, path)) for path in self.paths]) - self.low) / (self.high - self.low)

    def _limits(self, margins: Mapping[str, float]) -> Iterator[tuple[StudyQuantity, float, float]]:
        for limit, side, bound in bounds_of(self.study.file.limits):
            yield limit, side, side * bound - margins.get(limit.key, 0.0)

    def _term(self, row: StudyQuantity, side: float, bound: float | None) -> Term:
        asked = quantity_request(self.design, row.key)
        signs = {("max", 1.0): (1.0,), ("min", -1.0): (-1.0,), ("abs", 1.0): (1.0, -1.0)}.get(
            (asked.statistic, side), ()
        )
        if signs and (asked.drive is not None or not asked.name or not is_batchable(self.design, self.paths, asked)):
            signs = ()
        if (
            signs
            and design_block(self.design, self.paths, self._numbers(np.full((len(self.paths), 1), 0.5))).separate.any()
        ):
            signs = ()
        face = self.design.drives[asked.drive or 0].face if asked.name == "profile_curvature" else None
        roller = float(getattr(face, "radius_mm", 0.0))
        return Term(row, asked, side, bound, signs, roller)

    def _numbers(self, u: np.ndarray) -> np.ndarray:
        """Fields (k, m) at places u (k, m)."""
        return self.low[:, None] + u * (self.high - self.low)[:, None]

    # -- values -------------------------------------------------------------------------------------------

    def values(self, u: np.ndarray, polish: bool = True) -> tuple[np.ndarray, np.ndarray]:
        """side times what each term asks (t, m) of designs u (k, m), the limits first; and which can be built (m,)."""
        keys = list(dict.fromkeys(term.row.key for term in [*self.terms, *self.goals]))
        numbers = dict(zip(self.paths, self._numbers(u), strict=True)) or constant_column(self.design, u.shape[1])
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
        one = design_block(self.design, self.paths, self._numbers(u))
        theta, piece = (np.concatenate([each[i] for each in angles]) for i in (0, 1))
        n, m = theta.size, one.count
        owner = np.repeat(np.arange(m), n)
        names = list(dict.fromkeys(term.asked.name for term in terms))
        state = one.state(np.tile(theta, m), np.tile(piece, m), owner)
        found = one.values(names, state, owner)
        lost = one.failed_at("dynamics") if any(_of_forces(term) for term in terms) else one.failed_at("cam")
        rows, first = [], 0
        for term, (own, _) in zip(terms, angles, strict=True):
            row = found[term.asked.name].reshape(m, n)[:, first : first + own.size] / term.asked.unit
            rows.append(np.where(lost[:, None], np.nan, row))
            first += own.size
        return rows

    def peaks(self, u: np.ndarray, terms: Sequence[Term]) -> list[list[tuple[float, int, float]]]:
        """Of each term its highest local maxima at a design (k,): cam angle, piece, sign."""
        one = design_block(self.design, self.paths, self._numbers(u[:, None]))
        nodes, _ = clenshaw_curtis_nodes(one.program)
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

    def _fields(self, u: np.ndarray) -> dict[str, Any]:
        numbers = self._numbers(u[:, None])[:, 0].tolist()
        order = [row.field for row in self.study.file.vary]
        found = {**self.words, **dict(zip(self.paths, numbers, strict=True))}
        return {field: found[field] for field in order}


def goal_sign(goal: Goal) -> float:
    return 1.0 if goal.minimise else -1.0


def _of_forces(term: Term) -> bool:
    from core.study.quantities import quantity

    return quantity(term.asked.name).stage == "dynamics"


def _beside(u: np.ndarray, step: float) -> np.ndarray:
    """A place (k,) and those beside it (k, 1 + 2 k): upwards, then downwards."""
    steps = step * np.eye(u.size)
    return np.hstack([u[:, None], u[:, None] + steps, u[:, None] - steps])
