"""Sequences of any number of Yang's curves: as many conditions as unknowns, solved simultaneously.

Unknowns are height h and span β of every curve. Where curves meet while moving, their speeds c h/β are equal; where
they meet at rest with acceleration, their accelerations c h/β² are (Yang eqs. 1-4). These, and most settings, are
products of powers, which are linear in the logarithms; the total span, the stroke of a rise or return and the cam angle
of a join are sums. Newton's method solves the conditions in logarithms, where heights and spans are positive, from many
starts.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import groupby
from math import inf, isfinite, log

import numpy as np

from core.blend.equations import BlendSolution
from core.blend.evaluator import law_of
from core.blend.feasible import range_text
from core.blend.request import KINDS, BlendError, BlendResult, SequenceRequest, SettingRange
from core.blend.sequences import CONSTANT, DWELL, ELEMENTS, CurveSequence
from core.design import NamedCurve, Segment
from core.frozen import frozen
from core.laws import peaks
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
PEAKS = {"acceleration": (1, 2), "jerk": (1, 3), "torque": (2, 3)}  # powers of height and of span
NEGLIGIBLE = 1e-6

_NAME = re.compile(rf"({'|'.join(KINDS)})([1-9]\d*)")


# -- conditions -------------------------------------------------------------------------------------------


@frozen
class Condition:
    """Condition on the logarithms z (2n,) of heights and spans: powers·z + constant, or log Σ exp(z), equals ``value``.

    Attributes
    ----------
    powers : ndarray (2n,), dimensionless
        Powers of heights and spans; of a sum 1 for its terms.
    constant : float
    value : float or ndarray (k,), dimensionless
        Target, a logarithm.
    is_sum : bool
    offset : float
        Cam angle [deg] added to a sum.
    """

    powers: np.ndarray
    constant: float = 0.0
    value: float | np.ndarray = 0.0
    is_sum: bool = False
    offset: float = 0.0

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

    def with_value(self, value: float) -> Condition:
        """Condition with a value in the unit of the setting."""
        return replace(self, value=log(value - self.offset))

    def setting_value(self, z: np.ndarray) -> np.ndarray:
        """Value of the setting.

        Parameters
        ----------
        z : ndarray (k, 2n), dimensionless
            Logarithms of heights and spans.

        Returns
        -------
        ndarray (k,) [unit of the setting]
        """
        return self.offset + np.exp(self.at(z))


def condition(request: SequenceRequest, name: str) -> Condition:
    """A setting as a function of heights and spans."""
    match = _NAME.fullmatch(name)
    assert match is not None
    kind, i, n = match[1], int(match[2]) - 1, len(request.curves)
    powers = np.zeros(2 * n)
    if kind in ("rise", "return"):
        powers[list(request.strokes[name])] = 1.0
        return Condition(powers, is_sum=True)
    if kind == "end":
        powers[n : n + i + 1] = 1.0
        return Condition(powers, is_sum=True, offset=request.start)
    row = ELEMENTS[request.curves[i]]
    height, span, factor = {"h": (1, 0, 1.0), "span": (0, 1, 1.0), "v": (1, -1, row.speed), "a": (1, -2, row.peak)}[
        kind
    ]
    powers[[i, n + i]] = height, span
    return Condition(powers, log(factor))


def _joins(request: SequenceRequest) -> list[Condition]:
    """Equal speeds, or accelerations, where curves meet without dwell."""
    n = len(request.curves)
    pairs = [(i, i + 1) for i in range(n - 1)] + ([(n - 1, 0)] if request.is_closed else [])
    result = []
    for i, k in pairs:
        state = ELEMENTS[request.curves[i]].end
        if state != DWELL:
            kind = "v" if state[0] else "a"
            first, second = (condition(request, f"{kind}{j + 1}") for j in (i, k))
            result.append(Condition(first.powers - second.powers, first.constant - second.constant))
    return result


class SequenceProblem:
    """Conditions of a request with some of its settings."""

    def __init__(self, request: SequenceRequest, settings: Mapping[str, float]) -> None:
        self.request, self.settings = request, dict(settings)
        n = len(request.curves)
        total_span = Condition(np.repeat((0.0, 1.0), n), value=log(request.end - request.start), is_sum=True)
        self.always = [*_joins(request), total_span]
        self.conditions = [*self.always, *(condition(request, k).with_value(v) for k, v in settings.items())]

    @cached_property
    def _starts(self) -> np.ndarray:
        """Logarithms of heights and spans around typical values (STARTS, 2n), always the same."""
        request, n = self.request, len(self.request.curves)
        heights = [v for k, v in self.settings.items() if k[0] == "h" or k.startswith(("ris", "ret"))]
        typical = np.repeat((log(max(heights, default=10.0) / n), log((request.end - request.start) / n)), n)
        return typical + np.random.default_rng(1).normal(0.0, 1.2, (STARTS, 2 * n))

    def solve(self, starts: np.ndarray, more: Sequence[Condition] = (), least_share: float = LEAST_SHARE) -> np.ndarray:
        """Solutions of all conditions by Newton's method.

        Parameters
        ----------
        starts : ndarray (k, 2n), dimensionless
            Logarithms of heights and spans.
        more : sequence of Condition
            Additional conditions.
        least_share : float
            Least relative height and span of a solution.

        Returns
        -------
        ndarray (k, 2n), dimensionless
            Solution near each start, NaN where there is none.
        """
        conditions = [*self.conditions, *more]
        z = np.array(starts)
        values = np.stack([np.broadcast_to(c.value, len(z)) for c in conditions], axis=1)

        def residuals(rows: np.ndarray) -> np.ndarray:
            return np.stack([c.at(z[rows]) for c in conditions], axis=1) - values[rows]

        active = np.arange(len(z))
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                residual = residuals(active)
                is_active = np.abs(residual).max(axis=1) > ROUNDED
                active, residual = active[is_active], residual[is_active]
                if not active.size:
                    break
                slopes = np.stack([c.slopes(z[active]) for c in conditions], axis=1)
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
        n = len(self.request.curves)
        logarithms = np.concatenate(
            [z[:, :n] - z[:, :n].max(axis=1)[:, None], z[:, n:] - log(self.request.end - self.request.start)], axis=1
        )
        return np.exp(logarithms)

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
        return np.array(result).reshape(-1, 2 * len(self.request.curves))

    @cached_property
    def _continued(self) -> np.ndarray:
        """Motions (k, 2n) continued from those without the last setting to its value."""
        *previous, last = self.settings
        fewer = SequenceProblem(self.request, {name: self.settings[name] for name in previous})
        setting = condition(self.request, last).with_value(self.settings[last])
        values = setting.at(fewer.motions)
        z = fewer.motions[np.argsort(np.abs(values - setting.value))[:PATHS]]
        begin = setting.at(z)
        for share in np.linspace(0.0, 1.0, PATH_STEPS + 1)[1:]:
            z = fewer.solve(z, [replace(setting, value=begin + share * (setting.value - begin))])
            z, begin = z[is_finite := np.isfinite(z).all(axis=1)], begin[is_finite]
            if not z.size:
                break
        return z

    # -- independent settings -----------------------------------------------------------------------------

    @cached_property
    def _directions(self) -> tuple[np.ndarray, np.ndarray]:
        """Some motions, and a basis (k, 2n, freedom) of the changes that preserve joins and total span."""
        unconstrained = SequenceProblem(self.request, {})
        z = unconstrained.motions[:6]
        rows = np.stack([c.slopes(z) for c in self.always], axis=1)
        return z, np.linalg.svd(rows)[2][:, len(self.always) :].transpose(0, 2, 1)

    def rank(self, names: Sequence[str]) -> int:
        """Number of independent settings among these."""
        if not names:
            return 0
        z, basis = self._directions
        rows = np.stack([condition(self.request, name).slopes(z) for name in names], axis=1) @ basis
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
        request, n = self.request, len(self.request.curves)
        numbers = np.exp(z)
        for name, value in self.settings.items():
            i = int(name.lstrip("hspan")) - 1 if name[0] in "hs" else -1
            index = i if name[0] == "h" else n + i
            if i >= 0 and abs(numbers[index] - value) <= 1e-13 * value:
                numbers[index] = value
        heights, spans = tuple(map(float, numbers[:n])), tuple(map(float, numbers[n:]))
        rows = zip(request.curves, heights, spans, strict=True)
        segments = tuple(
            Segment(span, ELEMENTS[name].velocity_sign * height, NamedCurve(name.lower()))
            for name, height, span in rows
        )
        solution = BlendSolution(CurveSequence(request.curves, ()), heights, spans, 0.0, 0.0)
        return BlendResult(request, solution, segments)


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


def blend_sequence(request: SequenceRequest) -> BlendResult:
    """Motion of a sequence that its settings determine; of several the one with the smallest peak acceleration.

    Raises BlendError with the number of missing settings, a superfluous one, or a feasible range.
    """
    problem = _valid_problem(request)
    if len(request.settings) != request.freedom:
        raise _wrong_number(problem)
    if not problem.motions.size:
        raise _refusal(request)
    results = [problem.result(z) for z in problem.motions]
    return min(results, key=lambda result: float(f"{result.solution.peak_acceleration:.12g}"))


def best_of_sequence(request: SequenceRequest, goal: str) -> BlendResult:
    """Optimal motion of a sequence by a goal in ``GOALS``, over its free variables. Raises BlendError."""
    from scipy.optimize import minimize

    problem = _valid_problem(request)
    if len(request.settings) >= request.freedom:
        return blend_sequence(request)
    if not problem.motions.size:
        raise _refusal(request)
    n, (height_power, span_power) = len(request.curves), PEAKS[goal]
    moving = [i for i, name in enumerate(request.curves) if name not in CONSTANT]
    goals = np.zeros((len(moving), 2 * n))
    goals[range(len(moving)), moving], goals[range(len(moving)), [n + i for i in moving]] = height_power, -span_power
    constants = np.log([_coefficient(request.curves[i], goal) for i in moving])

    def peak(z: np.ndarray) -> np.ndarray:
        return (z @ goals.T + constants).max(axis=-1)

    conditions = problem.conditions
    limits = [
        {"type": "eq", "fun": lambda x: np.array([c.at(x[None, :-1])[0] - c.value for c in conditions]),
         "jac": lambda x: np.array([[*c.slopes(x[None, :-1])[0], 0.0] for c in conditions])},
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
        problem_text = f"the optimum has no {request.curves[least % n]} left (curve {least % n + 1})"
        raise BlendError(f"best {goal}: {problem_text}; give its height or span, or remove the curve")
    return problem.result(optimum)


def _coefficient(curve: str, goal: str) -> float:
    result = peaks(law_of(curve))
    return {"acceleration": result.ca, "jerk": result.cj, "torque": result.cm}[goal]


def sequence_ranges(request: SequenceRequest, name: str) -> list[SettingRange]:
    """Feasible ranges of a setting under the other settings; empty where there are none, or these determine it."""
    request.validate()
    problem = SequenceProblem(request, {k: v for k, v in request.settings.items() if k != name})
    if problem.rank(list(problem.settings)) == problem.rank([*problem.settings, name]):
        return []
    return _ranges(problem, name)


def _ranges(problem: SequenceProblem, name: str) -> list[SettingRange]:
    """Ranges from the least and greatest value of many motions outwards to where no motion exists, without the gaps."""
    motions = problem.motions
    if not motions.size:
        return []
    setting = condition(problem.request, name)
    values = setting.at(motions)
    order = np.argsort(values)
    motions, values = motions[order], values[order]
    low, high = _edge(problem, setting, motions[0], -1.0), _edge(problem, setting, motions[-1], 1.0)
    edges = [low, high]
    if len(problem.settings) + 1 == problem.request.freedom:  # one number is free: there may be gaps
        edges = [low, *_gaps(problem, setting, motions, values), high]
    result = []
    for a, b in zip(edges[::2], edges[1::2], strict=True):
        result.append(_as_range(problem, setting, a, b))
    return result


_End = tuple[float, np.ndarray]


def _gaps(problem: SequenceProblem, setting: Condition, motions: np.ndarray, values: np.ndarray) -> list[_End]:
    """Ends of the intervals in which no motion exists, in ascending order."""
    grid = np.linspace(values[0], values[-1], GRID + 2)[1:-1]
    nearest = np.abs(values[None, :] - grid[:, None]).argsort(axis=1)[:, :NEAREST]
    targets = np.repeat(grid, nearest.shape[1])
    solutions = problem.solve(motions[nearest.ravel()], [replace(setting, value=targets)])
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


def _edge(problem: SequenceProblem, setting: Condition, motion: np.ndarray, sign: float) -> _End:
    """Last value of a setting in one direction, as a logarithm, and its motion; infinite where there is no limit."""
    begin = float(setting.at(motion[None])[0])
    while True:
        value = float(setting.at(motion[None])[0])
        if abs(value - begin) > log(ENDLESS):
            return sign * inf, motion
        next_motion = problem.solve(motion[None], [replace(setting, value=value + sign * log(FACTOR))], VANISHING)[0]
        if not np.isfinite(next_motion).all():
            return _bisected(problem, setting, motion, value + sign * log(FACTOR))
        motion = next_motion


def _bisected(problem: SequenceProblem, setting: Condition, motion: np.ndarray, outside: float) -> _End:
    """Limit of a setting between that of a motion and a value that no motion has, and its motion."""
    checkpoint()
    inside = float(setting.at(motion[None])[0])
    for _ in range(CUTS):
        values = np.linspace(inside, outside, PARTS + 1)[1:-1]
        starts = np.broadcast_to(motion, (values.size, motion.size))
        solutions = problem.solve(starts, [replace(setting, value=values)], VANISHING)
        exists = np.isfinite(solutions).all(axis=1)
        count = int(exists.size if exists.all() else np.argmin(exists))  # values before the first one without a motion
        if count:
            inside, motion = float(values[count - 1]), solutions[count - 1]
        if count < exists.size:
            outside = float(values[count])
    return inside, motion


def _as_range(problem: SequenceProblem, setting: Condition, low: _End, high: _End) -> SettingRange:
    numbers = [setting.offset + (0.0 if t == -inf else float(np.exp(t))) for t, _ in (low, high)]
    open_ = [not isfinite(t) or bool(problem.shares(z[None]).min() <= LEAST_SHARE) for t, z in (low, high)]
    return SettingRange(numbers[0], numbers[1], *open_)


# -- refusals ---------------------------------------------------------------------------------------------


def _text(request: SequenceRequest, name: str) -> str:
    return f"{name} = {request.settings[name]:.9g} {request.unit_of(name)}"


def _valid_problem(request: SequenceRequest) -> SequenceProblem:
    """Problem of a request. Raises BlendError where it is invalid, or a setting follows from others."""
    request.validate()
    problem, names = SequenceProblem(request, request.settings), list(request.settings)
    for i, name in enumerate(names):
        if problem.rank(names[: i + 1]) == i + 1:
            continue
        causes = list(names[:i])
        for cause in names[:i]:  # smallest subset that determines it
            subset = [setting for setting in causes if setting != cause]
            if problem.rank(subset) == problem.rank([*subset, name]):
                causes = subset
        partial_problem = SequenceProblem(request, {setting: request.settings[setting] for setting in causes})
        value = (
            f": {name} = {condition(request, name).setting_value(partial_problem.motions[:1])[0]:.9g}"
            if partial_problem.motions.size
            else ""
        )
        independent = problem.new_settings([setting for setting in names if setting != name])
        instead = (
            f"instead set {', '.join(independent)}" if independent and len(names) <= request.freedom else "remove it"
        )
        cause_text = f" by {', '.join(causes)}" if causes else ""
        raise BlendError(f"{_text(request, name)}: already determined{cause_text}{value}; {instead}", name)
    return problem


def _wrong_number(problem: SequenceProblem) -> BlendError:
    """Refusal of a wrong number of settings, with the open ones."""
    request, settings = problem.request, list(problem.settings)
    n, missing = len(request.curves), request.freedom - len(settings)
    joins = 2 * n - 1 - request.freedom
    count = f"{request.sequence} requires {request.freedom} setting{'' if request.freedom == 1 else 's'}"
    why = f"{2 * n} heights and spans, {joins} join{'' if joins == 1 else 's'} and the total span"
    text = f"settings given: {', '.join(settings) or 'none'}; {count} ({why})"
    return BlendError(
        f"{text}: {missing} missing; still open: {', '.join(problem.new_settings(settings))}; or select a goal (best)"
    )


def _refusal(request: SequenceRequest) -> BlendError:
    """Refusal of the last setting with a range under all others; else of the first outside its range."""
    names = list(request.settings)
    for name in reversed(names):
        others = [setting for setting in names if setting != name]
        if ranges := sequence_ranges(request, name):
            return _out_of_range(request, name, ranges, others)
    for i, name in enumerate(names):
        partial_request = replace(request, settings={setting: request.settings[setting] for setting in names[: i + 1]})
        if not SequenceProblem(partial_request, partial_request.settings).motions.size:
            return _out_of_range(request, name, sequence_ranges(partial_request, name), names[:i])
    return BlendError(
        f"{', '.join(_text(request, name) for name in names)}: no such motion; change one of these settings"
    )


def _out_of_range(
    request: SequenceRequest, name: str, ranges: Sequence[SettingRange], other_settings: Sequence[str]
) -> BlendError:
    tail = f" with {', '.join(_text(request, setting) for setting in other_settings)}" if other_settings else ""
    shown = " or ".join(range_text(r, name) for r in ranges) or "none"
    allowed = (ranges[0].low, ranges[-1].high) if ranges else None
    return BlendError(
        f"{_text(request, name)} is not feasible{tail}; feasible: {shown} {request.unit_of(name)}", name, allowed
    )
