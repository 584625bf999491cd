"""Sequences of any number of Yang's curves: as many conditions as unknowns, solved simultaneously.

Unknowns are height h and span β of every curve. Where curves meet while moving, their speeds c h/β are equal; where
they meet at rest with acceleration, their accelerations c h/β² are (Yang eqs. 1-4). These, and most settings, are
products of powers, which are linear in the logarithms; the total span, the stroke of a rise or return and the cam angle
of a join are sums. Newton's method solves the conditions in logarithms, where heights and spans are positive, from many
starts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import groupby
from math import inf, isfinite, log

import numpy as np

from core.blend.equations import BlendSolution
from core.blend.evaluator import GOALS, peak_coefficient
from core.blend.request import BlendError, BlendResult, Request, SettingRange, infeasible, kind_of
from core.blend.sequences import CONSTANT, ELEMENTS, CurveChain, CurveSequence
from core.design import NamedCurve, Segment
from core.frozen import frozen
from core.number_text import result_text
from core.numerics.lazy import checkpoint

STARTS, STEPS, LONGEST_STEP = 160, 80, 2.0
SOLVED, ROUNDED = 1e-12, 1e-15  # largest residual, in logarithms, of a solution; residual that is rounding
LEAST_SHARE = 1e-10  # least height and span of a curve relative to the largest height and the total span
VANISHING = 1e-24  # the same for the end of a range, where a span is proportional to the root of a height
INDEPENDENT = 1e-9  # least singular value of independent conditions
SAME_MOTION = 1e-8  # largest difference of logarithms of equal motions
FACTOR, PARTS, CUTS, ENDLESS = 2.0, 16, 11, 1e9
PATHS, PATH_STEPS = 24, 40  # continuation to a setting that no start reaches
GRID, NEAREST = 48, 3  # samples of a range, and starts for each, to find gaps
NEGLIGIBLE = 1e-6


# -- heights and spans ------------------------------------------------------------------------------------


@frozen(eq=False)
class LogFunction:
    """Logarithm of a setting over the logarithms z (2n,) of heights and spans: powers·z + constant, or log Σ exp(z).

    Attributes
    ----------
    powers : ndarray (2n,), dimensionless
        Powers of heights and spans; of a sum 1 for its terms.
    constant : float
    is_sum : bool
    """

    powers: np.ndarray
    constant: float = 0.0
    is_sum: bool = False

    def at(self, z: np.ndarray) -> np.ndarray:
        """Value of the function.

        Parameters
        ----------
        z : ndarray (k, 2n), dimensionless
            Logarithms of heights and spans.

        Returns
        -------
        ndarray (k,), dimensionless
        """
        if not self.is_sum:
            return z @ self.powers + self.constant
        terms = z[:, self.powers > 0.0]
        greatest = terms.max(axis=1)
        return greatest + np.log(np.exp(terms - greatest[:, None]).sum(axis=1))

    def slopes(self, z: np.ndarray) -> np.ndarray:
        """Derivatives of the function by z.

        Parameters
        ----------
        z : ndarray (k, 2n), dimensionless
            Logarithms of heights and spans.

        Returns
        -------
        ndarray (k, 2n), dimensionless
        """
        if not self.is_sum:
            return np.broadcast_to(self.powers, z.shape)
        return self.powers * np.exp(np.where(self.powers > 0.0, z, -inf) - self.at(z)[:, None])


def log_function(chain: CurveChain, name: str) -> LogFunction:
    """Logarithm of a setting, without its offset."""
    kind, curves = kind_of(name), list(chain.indices_of(name))
    powers = np.zeros((2, len(chain.curves)))
    powers[:, curves] = [[kind.height], [kind.span]]
    return LogFunction(powers.ravel(), log(kind.factor(ELEMENTS[chain.curves[curves[0]]])), kind.is_sum)


def _joins(chain: CurveChain) -> list[LogFunction]:
    """Ratios of the speeds, or of the accelerations, where curves meet without dwell."""
    result = []
    for join in chain.joins:
        kind = "v" if ELEMENTS[chain.curves[join[0]]].end[0] else "a"
        first, second = (log_function(chain, f"{kind}{i + 1}") for i in join)
        result.append(LogFunction(first.powers - second.powers, first.constant - second.constant))
    return result


class SequenceProblem:
    """Equations of a sequence with some of the settings of a request: each function has its target."""

    def __init__(self, request: Request, settings: Mapping[str, float]) -> None:
        self.request, self.settings, self.chain = request, dict(settings), request.chain
        self._span = log(request.end - request.start)
        joins = _joins(self.chain)
        self.always = [*joins, log_function(self.chain, f"end{len(self.chain.curves)}")]
        self.functions = [*self.always, *(log_function(self.chain, name) for name in self.settings)]
        values = [request.constraint(name, value).value for name, value in self.settings.items()]
        self.targets = np.array([*(0.0 for _ in joins), self._span, *map(log, values)])

    def restricted(self, names: Iterable[str]) -> SequenceProblem:
        """Problem with only some of the settings."""
        return SequenceProblem(self.request, {name: self.settings[name] for name in names})

    @cached_property
    def _starts(self) -> np.ndarray:
        """Logarithms of heights and spans around typical values (STARTS, 2n), always the same."""
        n = len(self.chain.curves)
        heights = [v for k, v in self.settings.items() if kind_of(k)[:2] == (1, 0)]
        span = self.request.end - self.request.start
        typical = np.repeat((log(max(heights, default=10.0) / n), log(span / n)), n)
        return typical + np.random.default_rng(1).normal(0.0, 1.2, (STARTS, 2 * n))

    def solve(
        self,
        starts: np.ndarray,
        setting: LogFunction | None = None,
        values: np.ndarray | float = 0.0,
        least_share: float = LEAST_SHARE,
    ) -> np.ndarray:
        """Solutions of all equations by Newton's method.

        Parameters
        ----------
        starts : ndarray (k, 2n), dimensionless
            Logarithms of heights and spans.
        setting : LogFunction
            An additional setting.
        values : ndarray (k,) or float, dimensionless
            Its target for each start.
        least_share : float
            Least relative height and span of a solution.

        Returns
        -------
        ndarray (k, 2n), dimensionless
            Solution near each start, NaN where there is none.
        """
        functions, z = [*self.functions, *([setting] if setting else [])], np.array(starts)
        targets = np.empty((len(z), len(functions)))
        targets[:, : self.targets.size] = self.targets
        targets[:, self.targets.size :] = np.reshape(values, (-1, 1))

        def residuals(rows: np.ndarray) -> np.ndarray:
            return np.stack([f.at(z[rows]) for f in functions], axis=1) - targets[rows]

        active = np.arange(len(z))
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                residual = residuals(active)
                is_active = np.abs(residual).max(axis=1) > ROUNDED
                active, residual = active[is_active], residual[is_active]
                if not active.size:
                    break
                slopes = np.stack([f.slopes(z[active]) for f in functions], axis=1)
                z[active] -= _step(slopes, residual)
            is_solved = np.abs(residuals(np.arange(len(z)))).max(axis=1) <= SOLVED
            is_solved &= self.shares(z).min(axis=1) > least_share
        return np.where(is_solved[:, None], z, np.nan)

    def shares(self, z: np.ndarray) -> np.ndarray:
        """Heights relative to the largest one, and spans relative to the total span.

        Parameters
        ----------
        z : ndarray (k, 2n), dimensionless
            Logarithms of heights and spans.

        Returns
        -------
        ndarray (k, 2n), dimensionless
        """
        n = len(self.chain.curves)
        return np.exp(np.hstack([z[:, :n] - z[:, :n].max(axis=1, keepdims=True), z[:, n:] - self._span]))

    @cached_property
    def motions(self) -> np.ndarray:
        """Motions (k, 2n) that satisfy all conditions, as logarithms of heights and spans, each once."""
        checkpoint()
        solutions = self.solve(self._starts)
        solutions = solutions[np.isfinite(solutions).all(axis=1)]
        if not solutions.size and self.settings:
            solutions = self._continued
        result: list[np.ndarray] = []
        for z in solutions:
            if all(np.abs(z - known).max() > SAME_MOTION for known in result):
                result.append(z)
        return np.array(result).reshape(-1, self._starts.shape[1])

    @cached_property
    def _continued(self) -> np.ndarray:
        """Motions (k, 2n) continued from those without the last setting to its value."""
        fewer = self.restricted(list(self.settings)[:-1])
        setting, target = self.functions[-1], self.targets[-1]
        z = fewer.motions[np.argsort(np.abs(setting.at(fewer.motions) - target))[:PATHS]]
        begin = setting.at(z)
        for share in np.linspace(0.0, 1.0, PATH_STEPS + 1)[1:]:
            z = fewer.solve(z, setting, begin + share * (target - begin))
            z, begin = z[is_finite := np.isfinite(z).all(axis=1)], begin[is_finite]
            if not z.size:
                break
        return z

    # -- independent settings -----------------------------------------------------------------------------

    @cached_property
    def _directions(self) -> tuple[np.ndarray, np.ndarray]:
        """Some motions, and a basis (k, 2n, freedom) of the changes that preserve joins and total span."""
        z = self.restricted([]).motions[:6]
        rows = np.stack([f.slopes(z) for f in self.always], axis=1)
        return z, np.linalg.svd(rows)[2][:, len(self.always) :].transpose(0, 2, 1)

    def rank(self, names: Sequence[str]) -> int:
        """Number of independent settings among these."""
        if not names:
            return 0
        z, basis = self._directions
        rows = np.stack([log_function(self.chain, name).slopes(z) for name in names], axis=1) @ basis
        return int((np.linalg.svd(rows, compute_uv=False) > INDEPENDENT).sum(axis=1).max())

    def new_settings(self, names: Sequence[str]) -> tuple[str, ...]:
        """Names of the settings that are independent of these."""
        rank = self.rank(names)
        return tuple(n for n in self.request.names if n not in names and self.rank([*names, n]) > rank)

    # -- result -------------------------------------------------------------------------------------------

    def result(self, z: np.ndarray) -> BlendResult:
        """Motion from its logarithms; settings that it satisfies to rounding have exactly the given values.

        Parameters
        ----------
        z : ndarray (2n,), dimensionless
            Logarithms of heights and spans.

        Returns
        -------
        BlendResult
        """
        n, numbers = len(self.chain.curves), np.exp(z)
        for name, value in self.settings.items():
            if name.startswith(("h", "span")):
                index = self.chain.indices_of(name)[0] + n * kind_of(name).span
                if abs(numbers[index] - value) <= 1e-13 * value:
                    numbers[index] = value
        heights, spans = tuple(map(float, numbers[:n])), tuple(map(float, numbers[n:]))
        segments = tuple(
            Segment(span, ELEMENTS[name].velocity_sign * height, NamedCurve(name.lower()))
            for name, height, span in zip(self.chain.curves, heights, spans, strict=True)
        )
        solution = BlendSolution(CurveSequence(self.chain.curves, ()), heights, spans, 0.0, 0.0)
        return BlendResult(self.request, solution, segments)


def _step(slopes: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Shortest change (k, 2n) that satisfies all conditions to first order, no longer than ``LONGEST_STEP``."""
    q, r = np.linalg.qr(np.where(np.isfinite(slopes), slopes, 0.0).transpose(0, 2, 1))
    components = np.zeros_like(residual)
    for j in range(r.shape[-1]):  # forward substitution; a dependent condition adds nothing
        pivot = r[:, j, j]
        remainder = residual[:, j] - np.einsum("ki,ki->k", r[:, :j, j], components[:, :j])
        components[:, j] = np.where(pivot != 0.0, remainder / pivot, 0.0)
    step = np.einsum("kij,kj->ki", q, components)
    longest = np.abs(step).max(axis=1, keepdims=True)
    return np.where(np.isfinite(longest), step * np.minimum(1.0, LONGEST_STEP / np.maximum(longest, 1e-300)), 0.0)


# -- motions and ranges -----------------------------------------------------------------------------------


def blend_sequence(request: Request) -> BlendResult:
    """Motion of a valid request for a sequence, which its settings determine.

    Of several the one with the smallest peak acceleration. Raises BlendError with the number of missing settings, a
    superfluous one, or a feasible range.
    """
    problem = _independent_problem(request)
    if len(problem.settings) != problem.chain.freedom:
        raise _wrong_number(problem)
    if not problem.motions.size:
        raise _refusal(problem)
    results = [problem.result(z) for z in problem.motions]
    return min(results, key=lambda result: float(f"{result.solution.peak_acceleration:.12g}"))


def best_of_sequence(request: Request, goal: str) -> BlendResult:
    """Optimal motion of a valid request for a sequence by a goal in ``GOALS``. Raises BlendError."""
    from scipy.optimize import minimize

    problem = _independent_problem(request)
    if len(problem.settings) >= problem.chain.freedom:
        return blend_sequence(request)
    if not problem.motions.size:
        raise _refusal(problem)
    curves, (coefficient, height_power, span_power) = problem.chain.curves, GOALS[goal]
    n, moving = len(curves), [i for i, name in enumerate(curves) if name not in CONSTANT]
    goals = np.zeros((len(moving), 2 * n))
    goals[range(len(moving)), moving], goals[range(len(moving)), [n + i for i in moving]] = height_power, -span_power
    constants = np.log([peak_coefficient(curves[i], coefficient) for i in moving])

    def peak(z: np.ndarray) -> np.ndarray:
        return (z @ goals.T + constants).max(axis=-1)

    functions, targets = problem.functions, problem.targets
    limits = [
        {"type": "eq", "fun": lambda x: np.array([f.at(x[None, :-1])[0] for f in functions]) - targets,
         "jac": lambda x: np.array([[*f.slopes(x[None, :-1])[0], 0.0] for f in functions])},
        {"type": "ineq", "fun": lambda x: x[-1] - goals @ x[:-1] - constants,
         "jac": lambda x: np.hstack([-goals, np.ones((len(moving), 1))])},
    ]  # fmt: skip
    tallest = float(problem.motions[:, :n].max(axis=1).min())
    floor = np.repeat((tallest, log(request.end - request.start)), n) + log(NEGLIGIBLE)
    bounds = [*((low, None) for low in floor), (None, None)]
    optima = []
    for z in problem.motions[np.argsort(peak(problem.motions))[:4]]:
        checkpoint()
        begin = np.array([*np.maximum(z, floor), peak(z)])
        result = minimize(
            lambda x: x[-1], begin, jac=lambda x: np.eye(x.size)[-1], bounds=bounds, constraints=limits,
            method="SLSQP", options={"maxiter": 400, "ftol": 1e-15},
        )  # fmt: skip
        optima.append(problem.solve(result.x[None, :-1])[0])
    finite = [z for z in optima if np.isfinite(z).all()] or [problem.motions[np.argmin(peak(problem.motions))]]
    optimum = min(finite, key=lambda z: float(peak(z)))
    least = int(np.argmin(optimum - floor))
    if optimum[least] - floor[least] <= log(2.0):
        missing = f"no {curves[least % n]} left (curve {least % n + 1})"
        raise BlendError(f"best {goal}: the optimum has {missing}; give its height or span, or remove the curve")
    return problem.result(optimum)


def sequence_ranges(request: Request, name: str) -> list[SettingRange]:
    """Ranges of a setting of a valid request under the others; empty where there are none, or these determine it."""
    return _ranges(SequenceProblem(request, {k: v for k, v in request.given.items() if k != name}), name)


def _ranges(problem: SequenceProblem, name: str) -> list[SettingRange]:
    """Ranges from the least and greatest value of many motions outwards to where no motion exists, without the gaps."""
    names = list(problem.settings)
    if problem.rank(names) == problem.rank([*names, name]) or not problem.motions.size:
        return []
    motions = problem.motions
    setting = log_function(problem.chain, name)
    values = setting.at(motions)
    order = np.argsort(values)
    motions, values = motions[order], values[order]
    low, high = _edge(problem, setting, motions[0], -1.0), _edge(problem, setting, motions[-1], 1.0)
    edges = [low, high]
    if len(problem.settings) + 1 == problem.chain.freedom:  # one number is free: there may be gaps
        edges = [low, *_gaps(problem, setting, motions, values), high]
    offset = problem.request.offset_of(name)
    return [_as_range(problem, a, b).shifted(offset) for a, b in zip(edges[::2], edges[1::2], strict=True)]


_End = tuple[float, np.ndarray]


def _gaps(problem: SequenceProblem, setting: LogFunction, motions: np.ndarray, values: np.ndarray) -> list[_End]:
    """Ends of the intervals in which no motion exists, in ascending order."""
    grid = np.linspace(values[0], values[-1], GRID + 2)[1:-1]
    nearest = np.abs(values[None, :] - grid[:, None]).argsort(axis=1)[:, :NEAREST]
    targets = np.repeat(grid, nearest.shape[1])
    solutions = problem.solve(motions[nearest.ravel()], setting, targets)
    exists = np.isfinite(solutions).all(axis=1).reshape(nearest.shape).any(axis=1)
    result: list[_End] = []
    missing = [list(run) for ok, run in groupby(range(GRID), key=lambda i: exists[i]) if not ok]
    for run in missing:
        below, above = values < grid[run[0]], values > grid[run[-1]]
        if below.any() and above.any():
            result += [
                _bisected(problem, setting, motions[below][-1], grid[run[0]]),
                _bisected(problem, setting, motions[above][0], grid[run[-1]]),
            ]
    return result


def _edge(problem: SequenceProblem, setting: LogFunction, motion: np.ndarray, sign: float) -> _End:
    """Last value of a setting in one direction, as a logarithm, and its motion; infinite where there is no limit."""
    begin = float(setting.at(motion[None])[0])
    while True:
        value = float(setting.at(motion[None])[0])
        if abs(value - begin) > log(ENDLESS):
            return sign * inf, motion
        next_motion = problem.solve(motion[None], setting, value + sign * log(FACTOR), VANISHING)[0]
        if not np.isfinite(next_motion).all():
            return _bisected(problem, setting, motion, value + sign * log(FACTOR))
        motion = next_motion


def _bisected(problem: SequenceProblem, setting: LogFunction, motion: np.ndarray, outside: float) -> _End:
    """Limit of a setting between that of a motion and a value that no motion has, and its motion."""
    checkpoint()
    inside = float(setting.at(motion[None])[0])
    for _ in range(CUTS):
        values = np.linspace(inside, outside, PARTS + 1)[1:-1]
        starts = np.broadcast_to(motion, (values.size, motion.size))
        solutions = problem.solve(starts, setting, values, VANISHING)
        exists = np.isfinite(solutions).all(axis=1)
        count = int(exists.size if exists.all() else np.argmin(exists))  # values before the first one without a motion
        if count:
            inside, motion = float(values[count - 1]), solutions[count - 1]
        if count < exists.size:
            outside = float(values[count])
    return inside, motion


def _as_range(problem: SequenceProblem, low: _End, high: _End) -> SettingRange:
    numbers = [0.0 if t == -inf else float(np.exp(t)) for t, _ in (low, high)]
    open_ = [not isfinite(t) or bool(problem.shares(z[None]).min() <= LEAST_SHARE) for t, z in (low, high)]
    return SettingRange(numbers[0], numbers[1], *open_)


# -- refusals ---------------------------------------------------------------------------------------------


def _texts(problem: SequenceProblem, names: Sequence[str]) -> str:
    """Settings with their values: ``rise1 = 20 mm, h2 = 8 mm``."""
    return ", ".join(f"{n} = {result_text(problem.settings[n], 6)} {problem.request.unit_of(n)}" for n in names)


def _independent_problem(request: Request) -> SequenceProblem:
    """Problem of a request. Raises BlendError where a setting follows from others."""
    problem = SequenceProblem(request, request.given)
    names = list(problem.settings)
    for i, name in enumerate(names):
        if problem.rank(names[: i + 1]) == i + 1:
            continue
        causes = list(names[:i])
        for cause in names[:i]:  # smallest subset that determines it
            subset = [setting for setting in causes if setting != cause]
            if problem.rank(subset) == problem.rank([*subset, name]):
                causes = subset
        text = f"{_texts(problem, [name])}: already determined{' by ' if causes else ''}{', '.join(causes)}"
        motions = problem.restricted(causes).motions[:1]
        if motions.size:
            value = request.offset_of(name) + float(np.exp(log_function(problem.chain, name).at(motions)[0]))
            text = f"{text}: {name} = {result_text(value, 6)}"
        independent = problem.new_settings([setting for setting in names if setting != name])
        has_other = independent and len(names) <= problem.chain.freedom
        remedy = f"instead set {', '.join(independent)}" if has_other else "remove it"
        raise BlendError(f"{text}; {remedy}", name)
    return problem


def _wrong_number(problem: SequenceProblem) -> BlendError:
    """Refusal of a wrong number of settings, with the open ones."""
    chain, settings = problem.chain, list(problem.settings)
    n, missing, joins = len(chain.curves), chain.freedom - len(settings), len(chain.joins)
    count = f"{chain} requires {chain.freedom} setting{'' if chain.freedom == 1 else 's'}"
    why = f"{2 * n} heights and spans, {joins} join{'' if joins == 1 else 's'} and the total span"
    text = f"settings given: {', '.join(settings) or 'none'}; {count} ({why})"
    return BlendError(
        f"{text}: {missing} missing; still open: {', '.join(problem.new_settings(settings))}; or select a goal (best)"
    )


def _refusal(problem: SequenceProblem) -> BlendError:
    """Refusal of the last setting with a range under all others; else of the first outside its range."""
    request, names = problem.request, list(problem.settings)
    for name in reversed(names):
        if ranges := sequence_ranges(request, name):
            others = _texts(problem, [setting for setting in names if setting != name])
            return infeasible(_texts(problem, [name]), name, ranges, request.unit_of(name), others)
    for i, name in enumerate(names):
        if not problem.restricted(names[: i + 1]).motions.size:
            ranges, others = _ranges(problem.restricted(names[:i]), name), _texts(problem, names[:i])
            return infeasible(_texts(problem, [name]), name, ranges, request.unit_of(name), others)
    return BlendError(f"{_texts(problem, names)}: no such motion; change one of these settings")
