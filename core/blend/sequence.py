"""A sequence of any number of curves of Yang's table: as many conditions as unknowns, solved all at once.

Unknown are height h and span β of every curve. Where curves meet while moving their speeds c h/β are equal, where they meet at
rest and accelerating their accelerations c h/β² are (Yang eqs. 1-4); both, and most of what can be set, are products of powers:
linear in the logarithms. Only sums are not: the whole span, the stroke of a rise or return, the cam angle of a join. Newton's
method solves these in logarithms, where every height and span is positive by itself, from many starts at once.
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
SOLVED, ROUNDED = 1e-12, 1e-15  # largest difference of logarithms that counts as met, and that is rounding
LEAST_SHARE = 1e-10  # of the whole span, or of the largest height: what is less is no curve
VANISHING = 1e-24  # the same where the end of a range is looked for: a span goes with the root of a height
NEW = 1e-9  # least singular value by which a condition says something new
ALIKE = 1e-8  # in logarithms: two motions that are one
FACTOR, PARTS, CUTS, ENDLESS = 2.0, 16, 11, 1e9
PATHS, PATH_STEPS = 24, 40  # of motions led to a setting that none of the starts meets
GRID, NEAREST = 48, 3  # values between the least and the greatest that are tried for gaps
PEAKS = {"acceleration": (1, 2), "jerk": (1, 3), "torque": (2, 3)}  # powers of height and of span
NEGLIGIBLE = 1e-6

_NAME = re.compile(rf"({'|'.join(KINDS)})([1-9]\d*)")


# -- conditions -------------------------------------------------------------------------------------------


@frozen
class Condition:
    """A function of the logarithms z (2n,) of heights and spans: powers·z + constant, or the logarithm of Σ exp(z) over some of
    them, and the value it shall have, a logarithm too.

    offset  what is added to the sum: the cam angle from which it counts
    """

    powers: np.ndarray
    constant: float = 0.0
    value: float | np.ndarray = 0.0
    is_sum: bool = False
    offset: float = 0.0

    def at(self, z: np.ndarray) -> np.ndarray:
        """Its values at z (k, 2n): (k,)."""
        if not self.is_sum:
            return z @ self.powers + self.constant
        part = z[:, self.powers > 0.0]
        most = part.max(axis=1)
        return most + np.log(np.exp(part - most[:, None]).sum(axis=1))

    def slopes(self, z: np.ndarray) -> np.ndarray:
        """Its derivatives by z (k, 2n)."""
        if not self.is_sum:
            return np.broadcast_to(self.powers, z.shape)
        return self.powers * np.exp(np.where(self.powers > 0.0, z, -inf) - self.at(z)[:, None])

    def with_value(self, value: float) -> Condition:
        """The same with the value [unit of the setting]."""
        return replace(self, value=log(value - self.offset))

    def shown(self, z: np.ndarray) -> np.ndarray:
        """What a setting is at z (k, 2n), in its unit."""
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
    """Equal speeds, or accelerations, where curves meet that do not dwell there."""
    n = len(request.curves)
    pairs = [(i, i + 1) for i in range(n - 1)] + ([(n - 1, 0)] if request.closes else [])
    result = []
    for i, k in pairs:
        state = ELEMENTS[request.curves[i]].end
        if state != DWELL:
            kind = "v" if state[0] else "a"
            one, other = (condition(request, f"{kind}{j + 1}") for j in (i, k))
            result.append(Condition(one.powers - other.powers, one.constant - other.constant))
    return result


class SequenceProblem:
    """The conditions of a request with some of its settings."""

    def __init__(self, request: SequenceRequest, settings: Mapping[str, float]) -> None:
        self.request, self.settings = request, dict(settings)
        n = len(request.curves)
        whole = Condition(np.repeat((0.0, 1.0), n), value=log(request.end - request.start), is_sum=True)
        self.always = [*_joins(request), whole]
        self.conditions = [*self.always, *(condition(request, k).with_value(v) for k, v in settings.items())]

    @cached_property
    def _starts(self) -> np.ndarray:
        """Logarithms of heights and spans about the usual (STARTS, 2n), always the same."""
        request, n = self.request, len(self.request.curves)
        heights = [v for k, v in self.settings.items() if k[0] == "h" or k.startswith(("ris", "ret"))]
        usual = np.repeat((log(max(heights, default=10.0) / n), log((request.end - request.start) / n)), n)
        return usual + np.random.default_rng(1).normal(0.0, 1.2, (STARTS, 2 * n))

    def solved(
        self, starts: np.ndarray, more: Sequence[Condition] = (), least_share: float = LEAST_SHARE
    ) -> np.ndarray:
        """Where all conditions are met, near each start; nan where they are not (k, 2n)."""
        conditions = [*self.conditions, *more]
        z = np.array(starts)
        values = np.stack([np.broadcast_to(c.value, len(z)) for c in conditions], axis=1)

        def missed(rows: np.ndarray) -> np.ndarray:
            return np.stack([c.at(z[rows]) for c in conditions], axis=1) - values[rows]

        waiting = np.arange(len(z))
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                by = missed(waiting)
                far = np.abs(by).max(axis=1) > ROUNDED
                waiting, by = waiting[far], by[far]
                if not waiting.size:
                    break
                slopes = np.stack([c.slopes(z[waiting]) for c in conditions], axis=1)
                z[waiting] -= _step(slopes, by)
            good = np.abs(missed(np.arange(len(z)))).max(axis=1) <= SOLVED
            good &= self.shares(z).min(axis=1) > least_share
        return np.where(good[:, None], z, np.nan)

    def shares(self, z: np.ndarray) -> np.ndarray:
        """Heights over the largest and spans over the whole (k, 2n)."""
        n = len(self.request.curves)
        spread = np.concatenate(
            [z[:, :n] - z[:, :n].max(axis=1)[:, None], z[:, n:] - log(self.request.end - self.request.start)], axis=1
        )
        return np.exp(spread)

    @cached_property
    def places(self) -> np.ndarray:
        """Points that meet all conditions, each once where they leave nothing free (k, 2n)."""
        checkpoint()
        found = self.solved(self._starts)
        found = found[np.isfinite(found).all(axis=1)]
        if not found.size and self.settings:
            found = self._reached
        result: list[np.ndarray] = []
        for z in found:
            if all(np.abs(z - other).max() > ALIKE for other in result):
                result.append(z)
        return np.array(result).reshape(-1, 2 * len(self.request.curves))

    @cached_property
    def _reached(self) -> np.ndarray:
        """The same from motions without the last setting, led to its value (k, 2n)."""
        *others, last = self.settings
        fewer = SequenceProblem(self.request, {name: self.settings[name] for name in others})
        setting = condition(self.request, last).with_value(self.settings[last])
        values = setting.at(fewer.places)
        z = fewer.places[np.argsort(np.abs(values - setting.value))[:PATHS]]
        begin = setting.at(z)
        for share in np.linspace(0.0, 1.0, PATH_STEPS + 1)[1:]:
            z = fewer.solved(z, [replace(setting, value=begin + share * (setting.value - begin))])
            z, begin = z[good := np.isfinite(z).all(axis=1)], begin[good]
            if not z.size:
                break
        return z

    # -- which settings say something new -----------------------------------------------------------------

    @cached_property
    def _directions(self) -> tuple[np.ndarray, np.ndarray]:
        """Some motions that join, and a basis of the changes that keep their joins and the whole span (k, 2n, freedom)."""
        joined = SequenceProblem(self.request, {})
        z = joined.places[:6]
        rows = np.stack([c.slopes(z) for c in self.always], axis=1)
        return z, np.linalg.svd(rows)[2][:, len(self.always) :].transpose(0, 2, 1)

    def rank(self, names: Sequence[str]) -> int:
        """How many of these settings say something new."""
        if not names:
            return 0
        z, basis = self._directions
        rows = np.stack([condition(self.request, name).slopes(z) for name in names], axis=1) @ basis
        return int((np.linalg.svd(rows, compute_uv=False) > NEW).sum(axis=1).max())

    def new_settings(self, names: Sequence[str]) -> tuple[str, ...]:
        """What says something new beside these."""
        known = self.rank(names)
        return tuple(n for n in self.request.names if n not in names and self.rank([*names, n]) > known)

    # -- motions ------------------------------------------------------------------------------------------

    def answer(self, z: np.ndarray) -> BlendResult:
        """A motion from its logarithms (2n,); what was set and is met but for rounding is as it was set."""
        request, n = self.request, len(self.request.curves)
        numbers = np.exp(z)
        for name, value in self.settings.items():
            i = int(name.lstrip("hspan")) - 1 if name[0] in "hs" else -1
            at = i if name[0] == "h" else n + i
            if i >= 0 and abs(numbers[at] - value) <= 1e-13 * value:
                numbers[at] = value
        heights, spans = tuple(map(float, numbers[:n])), tuple(map(float, numbers[n:]))
        rows = zip(request.curves, heights, spans, strict=True)
        segments = tuple(
            Segment(span, ELEMENTS[name].velocity_sign * height, NamedCurve(name.lower()))
            for name, height, span in rows
        )
        solution = BlendSolution(CurveSequence(request.curves, ()), heights, spans, 0.0, 0.0)
        return BlendResult(request, solution, segments)


def _step(slopes: np.ndarray, missed: np.ndarray) -> np.ndarray:
    """The shortest change that meets all conditions to first order (k, 2n), no longer than ``LONGEST_STEP``."""
    q, r = np.linalg.qr(np.where(np.isfinite(slopes), slopes, 0.0).transpose(0, 2, 1))
    along = np.zeros_like(missed)
    for j in range(r.shape[-1]):  # forward substitution; what depends on the others adds nothing
        pivot = r[:, j, j]
        rest = missed[:, j] - np.einsum("ki,ki->k", r[:, :j, j], along[:, :j])
        along[:, j] = np.where(pivot != 0.0, rest / pivot, 0.0)
    step = np.einsum("kij,kj->ki", q, along)
    longest = np.abs(step).max(axis=1, keepdims=True)
    return np.where(np.isfinite(longest), step * np.minimum(1.0, LONGEST_STEP / np.maximum(longest, 1e-300)), 0.0)


# -- answers ----------------------------------------------------------------------------------------------


def blend_sequence(request: SequenceRequest) -> BlendResult:
    """The motion of a sequence that its settings determine; of several the gentlest. Raises BlendError, which says what is missing,
    too much, or would be feasible."""
    problem = _sensible(request)
    if len(request.settings) != request.freedom:
        raise _wrong_number(problem)
    if not problem.places.size:
        raise _refusal(request)
    answers = [problem.answer(z) for z in problem.places]
    return min(answers, key=lambda each: float(f"{each.solution.peak_acceleration:.12g}"))


def best_of_sequence(request: SequenceRequest, goal: str) -> BlendResult:
    """The gentlest motion of a sequence by a goal of ``GOALS`` over what its settings leave free. Raises BlendError."""
    from scipy.optimize import minimize

    problem = _sensible(request)
    if len(request.settings) >= request.freedom:
        return blend_sequence(request)
    if not problem.places.size:
        raise _refusal(request)
    n, (height, root) = len(request.curves), PEAKS[goal]
    moving = [i for i, name in enumerate(request.curves) if name not in CONSTANT]
    goals = np.zeros((len(moving), 2 * n))
    goals[range(len(moving)), moving], goals[range(len(moving)), [n + i for i in moving]] = height, -root
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
    tallest = float(problem.places[:, :n].max(axis=1).min())
    floor = np.repeat((tallest, log(request.end - request.start)), n) + log(NEGLIGIBLE)
    bounds = [*((low, None) for low in floor), (None, None)]
    found = []
    for z in problem.places[np.argsort(peak(problem.places))[:4]]:
        checkpoint()
        begin = np.array([*np.maximum(z, floor), peak(z)])
        result = minimize(
            lambda x: x[-1], begin, jac=lambda x: np.eye(x.size)[-1], bounds=bounds, constraints=limits,
            method="SLSQP", options={"maxiter": 400, "ftol": 1e-15},
        )  # fmt: skip
        found.append(problem.solved(result.x[None, :-1])[0])
    able = [z for z in found if np.isfinite(z).all()] or [problem.places[np.argmin(peak(problem.places))]]
    winner = min(able, key=lambda z: float(peak(z)))
    least = int(np.argmin(winner - floor))
    if winner[least] - floor[least] <= log(2.0):
        none = f"the gentlest has no {request.curves[least % n]} left (curve {least % n + 1})"
        raise BlendError(f"best {goal}: {none}; give its height or span, or leave it out")
    return problem.answer(winner)


def _coefficient(curve: str, goal: str) -> float:
    result = peaks(law_of(curve))
    return {"acceleration": result.ca, "jerk": result.cj, "torque": result.cm}[goal]


def sequence_ranges(request: SequenceRequest, name: str) -> list[SettingRange]:
    """What a setting may be while the others stay; empty where they leave nothing, or determine it."""
    request.validate()
    problem = SequenceProblem(request, {k: v for k, v in request.settings.items() if k != name})
    if problem.rank(list(problem.settings)) == problem.rank([*problem.settings, name]):
        return []
    return _ranges(problem, name)


def _ranges(problem: SequenceProblem, name: str) -> list[SettingRange]:
    """From the least and greatest value among many motions outwards to where no motion is left, and the gaps between."""
    places = problem.places
    if not places.size:
        return []
    setting = condition(problem.request, name)
    values = setting.at(places)
    order = np.argsort(values)
    places, values = places[order], values[order]
    low, high = _edge(problem, setting, places[0], -1.0), _edge(problem, setting, places[-1], 1.0)
    edges = [low, high]
    if len(problem.settings) + 1 == problem.request.freedom:  # one number is free: there may be gaps
        edges = [low, *_gaps(problem, setting, places, values), high]
    result = []
    for a, b in zip(edges[::2], edges[1::2], strict=True):
        result.append(_as_range(problem, setting, a, b))
    return result


_End = tuple[float, np.ndarray]


def _gaps(problem: SequenceProblem, setting: Condition, places: np.ndarray, values: np.ndarray) -> list[_End]:
    """Ends of stretches that no motion has, in order."""
    grid = np.linspace(values[0], values[-1], GRID + 2)[1:-1]
    nearest = np.abs(values[None, :] - grid[:, None]).argsort(axis=1)[:, :NEAREST]
    wanted = np.repeat(grid, nearest.shape[1])
    found = problem.solved(places[nearest.ravel()], [replace(setting, value=wanted)])
    able = np.isfinite(found).all(axis=1).reshape(nearest.shape).any(axis=1)
    result: list[_End] = []
    stretches = [list(run) for ok, run in groupby(range(GRID), key=lambda i: able[i]) if not ok]
    for run in stretches:
        below, above = values < grid[run[0]], values > grid[run[-1]]
        if below.any() and above.any():
            result += [
                _bisected(problem, setting, places[below][-1], grid[run[0]]),
                _bisected(problem, setting, places[above][0], grid[run[-1]]),
            ]
    return result


def _edge(problem: SequenceProblem, setting: Condition, place: np.ndarray, sign: float) -> _End:
    """The last value of a setting in one direction, and the motion there; its logarithm is infinite where there is no end."""
    begin = float(setting.at(place[None])[0])
    while True:
        value = float(setting.at(place[None])[0])
        if abs(value - begin) > log(ENDLESS):
            return sign * inf, place
        further = problem.solved(place[None], [replace(setting, value=value + sign * log(FACTOR))], VANISHING)[0]
        if not np.isfinite(further).all():
            return _bisected(problem, setting, place, value + sign * log(FACTOR))
        place = further


def _bisected(problem: SequenceProblem, setting: Condition, place: np.ndarray, outside: float) -> _End:
    checkpoint()
    inside = float(setting.at(place[None])[0])
    for _ in range(CUTS):
        values = np.linspace(inside, outside, PARTS + 1)[1:-1]
        starts = np.broadcast_to(place, (values.size, place.size))
        further = problem.solved(starts, [replace(setting, value=values)], VANISHING)
        met = np.isfinite(further).all(axis=1)
        count = int(met.size if met.all() else np.argmin(met))  # those before the first that is not met
        if count:
            inside, place = float(values[count - 1]), further[count - 1]
        if count < met.size:
            outside = float(values[count])
    return inside, place


def _as_range(problem: SequenceProblem, setting: Condition, low: _End, high: _End) -> SettingRange:
    numbers = [setting.offset + (0.0 if t == -inf else float(np.exp(t))) for t, _ in (low, high)]
    open_ = [not isfinite(t) or bool(problem.shares(z[None]).min() <= LEAST_SHARE) for t, z in (low, high)]
    return SettingRange(numbers[0], numbers[1], *open_)


# -- refusals ---------------------------------------------------------------------------------------------


def _text(request: SequenceRequest, name: str) -> str:
    return f"{name} = {request.settings[name]:.9g} {request.unit_of(name)}"


def _sensible(request: SequenceRequest) -> SequenceProblem:
    """The problem of a request. Raises BlendError where it makes no sense, or one of its settings follows from others."""
    request.validate()
    problem, names = SequenceProblem(request, request.settings), list(request.settings)
    for i, name in enumerate(names):
        if problem.rank(names[: i + 1]) == i + 1:
            continue
        by = list(names[:i])
        for other in names[:i]:  # the fewest that determine it
            fewer = [each for each in by if each != other]
            if problem.rank(fewer) == problem.rank([*fewer, name]):
                by = fewer
        alone = SequenceProblem(request, {each: request.settings[each] for each in by})
        value = f": {name} = {condition(request, name).shown(alone.places[:1])[0]:.9g}" if alone.places.size else ""
        new = problem.new_settings([each for each in names if each != name])
        instead = f"instead set {', '.join(new)}" if new and len(names) <= request.freedom else "leave it out"
        beside = f" by {', '.join(by)}" if by else ""
        raise BlendError(f"{_text(request, name)}: determined already{beside}{value}; {instead}", name)
    return problem


def _wrong_number(problem: SequenceProblem) -> BlendError:
    request, given = problem.request, list(problem.settings)
    n, missing = len(request.curves), request.freedom - len(given)
    joins = 2 * n - 1 - request.freedom
    count = f"{request.sequence} takes {request.freedom} setting{'' if request.freedom == 1 else 's'}"
    why = f"{2 * n} heights and spans, {joins} join{'' if joins == 1 else 's'} and the whole span"
    text = f"settings given: {', '.join(given) or 'none'}; {count} ({why})"
    return BlendError(
        f"{text}: {missing} missing; still open: {', '.join(problem.new_settings(given))}; or ask for the best"
    )


def _refusal(request: SequenceRequest) -> BlendError:
    """The first setting out of what those before it leave, with what it may be."""
    names = list(request.settings)
    for name in reversed(names):
        others = [each for each in names if each != name]
        if ranges := sequence_ranges(request, name):
            return _out_of_range(request, name, ranges, others)
    for i, name in enumerate(names):
        fewer = replace(request, settings={each: request.settings[each] for each in names[: i + 1]})
        if not SequenceProblem(fewer, fewer.settings).places.size:
            return _out_of_range(request, name, sequence_ranges(fewer, name), names[:i])
    return BlendError(f"{', '.join(_text(request, name) for name in names)}: no such motion; change one of them")


def _out_of_range(
    request: SequenceRequest, name: str, ranges: Sequence[SettingRange], beside: Sequence[str]
) -> BlendError:
    tail = f" beside {', '.join(_text(request, other) for other in beside)}" if beside else ""
    shown = " or ".join(range_text(r, name) for r in ranges) or "none"
    allowed = (ranges[0].low, ranges[-1].high) if ranges else None
    return BlendError(
        f"{_text(request, name)} is not feasible{tail}; feasible: {shown} {request.unit_of(name)}", name, allowed
    )
