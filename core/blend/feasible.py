"""Feasible ranges of settings, settings that others determine, and refusals of requests.

The text of a refusal is one line: the setting, its feasible range and the remedy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import combinations
from math import isfinite
from typing import NamedTuple

import numpy as np

from core.blend.equations import BlendTask, Family
from core.blend.evaluator import Evaluator
from core.blend.region import MIXES, SAME, Region
from core.blend.request import (
    FLATS,
    POINT,
    SETTINGS,
    SIZES,
    BlendError,
    Constraint,
    Request,
    SettingRange,
    hardest_first,
    height_of,
    infeasible,
    merged,
)
from core.blend.sequence import SequenceProblem, sequence_ranges
from core.blend.sequences import sequences
from core.blend.solver import BlendCandidate, candidates, flat_heights
from core.number_text import result_text
from core.numerics.lazy import checkpoint

_ZERO = 1e-9  # least length of a direction, and least singular value of independent ones
FLAT_SAMPLES, HALVINGS = 16, 34  # samples and bisections of the span of a constant acceleration with a given value


# -- ranges -----------------------------------------------------------------------------------------------


def feasible_ranges(request: Request, setting: str, at: float = 0.0) -> list[SettingRange]:
    """Feasible ranges of a setting under the other settings, as the request writes it; empty where there are none.

    The request may contain the setting; its value has no effect. A ``point`` has the cam angle ``at`` [deg]. Where the
    request with the setting is complete for some sequences, the ranges are those of these sequences; else missing
    settings are free. A setting that the others determine has one value. Raises BlendError for an invalid request.
    """
    request.validate()
    if setting not in (*request.names, *([POINT] if request.type else [])):
        raise BlendError(f"{setting}: unknown setting; allowed: {' | '.join(request.names)}")
    if not request.type:
        return sequence_ranges(request, setting)
    if setting in FLATS:
        return flat_ranges(request, setting)
    constraint = request.constraint(setting, 1.0, at)
    others = [c for c in request.constraints if (c.name, c.at) != (constraint.name, constraint.at)]
    accepting = [c for c in candidates(request) if c.accepts([*others, constraint])]
    complete = [c for c in accepting if c.freedom == len(others) + 1]
    return ranges_of(request, complete or accepting, others, constraint)


def ranges_of(
    request: Request, accepting: Iterable[BlendCandidate], others: Sequence[Constraint], constraint: Constraint
) -> list[SettingRange]:
    """Ranges of a setting under other constraints, for any of the candidates."""
    result = []
    for candidate in accepting:
        checkpoint()
        ranges = candidate.problem(request, [*others, constraint]).ranges(len(others))
        result += [_shown(r, request, candidate) for r in ranges] if constraint.name == "peak" else ranges
    return merged(result)


def flat_ranges(request: Request, setting: str) -> list[SettingRange]:
    """Ranges of the span of a constant acceleration [deg] under the other settings, its value among them.

    The span is positive and shorter than its curve.
    """
    name = request.standard_name(setting)
    sizes = {
        requested: value
        for requested, value in request.settings.items()
        if request.standard_name(requested) == f"a{name[-1]}"
    }
    other_settings = {
        requested: value
        for requested, value in request.settings.items()
        if request.standard_name(requested) != name and requested not in sizes
    }
    without = replace(request, settings=other_settings)
    span, constraints = Constraint(f"span{name[-1]}", 1.0), without.constraints
    rows = [c for c in candidates(without) if c.accepts(constraints) and height_of(name) in flat_heights(c.sequence)]
    complete = [c for c in rows if c.freedom == len(constraints) + len(sizes)] or rows
    longest = max((_longest(without, c, span, constraints) for c in complete), default=0.0)
    if not sizes or not longest:
        return [SettingRange(0.0, longest, True, True)] if longest else []
    return _ranges_of_condition(
        lambda flat: _is_met(replace(without, settings={**other_settings, setting: flat, **sizes})), longest
    )


def _longest(request: Request, candidate: BlendCandidate, span: Constraint, others: Sequence[Constraint]) -> float:
    """Largest span of a curve [deg]."""
    if candidate.freedom > len(others):
        return max((r.high for r in candidate.problem(request, [*others, span]).ranges(len(others))), default=0.0)
    solutions = candidate.problem(request, others).solutions()
    height = height_of(span.name)
    curves = candidate.sequence.curves
    index = curves.index(flat_heights(candidate.sequence)[height])
    spans = [solution.spans[::-1] if candidate.backwards else solution.spans for solution in solutions]
    return max((row[index] for row in spans), default=0.0)


def _is_met(request: Request) -> bool:
    """Whether a motion satisfies the settings of an incomplete or complete request."""
    constraints = request.constraints
    accepting = [c for c in candidates(request) if c.accepts(constraints)]
    complete = [c for c in accepting if c.freedom == len(constraints)]
    if complete:
        return any(c.problem(request, constraints).solutions() for c in complete)
    size = next(c for c in constraints if c.name in SIZES)
    rest = [c for c in constraints if c is not size]
    return any(r.low <= size.value <= r.high for r in ranges_of(request, accepting, rest, size))


def _ranges_of_condition(is_met: Callable[[float], bool], longest: float) -> list[SettingRange]:
    """Intervals between 0 and ``longest`` where a condition is satisfied, with ends exact to rounding."""
    samples = [longest * (i + 0.5) / FLAT_SAMPLES for i in range(FLAT_SAMPLES)]
    results = [is_met(sample) for sample in samples]
    result: list[SettingRange] = []
    for i, sample in enumerate(samples):
        if not results[i]:
            continue
        if i == 0 or not results[i - 1]:
            low = _edge(is_met, sample, samples[i - 1] if i else 0.0)
            result.append(SettingRange(low, sample, True, True))
        high = (
            sample
            if i + 1 < len(results) and results[i + 1]
            else _edge(is_met, sample, samples[i + 1] if i + 1 < len(results) else longest)
        )
        result[-1] = SettingRange(result[-1].low, high, True, True)
    return [SettingRange(0.0 if r.low <= _ZERO * longest else r.low, r.high, True, True) for r in result]


def _edge(is_met: Callable[[float], bool], inside: float, outside: float) -> float:
    """Position by bisection where a condition ceases to be satisfied."""
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if is_met(middle) else (inside, middle)
    return inside


def _shown(result: SettingRange, request: Request, candidate: BlendCandidate) -> SettingRange:
    """Range of the peak as cam angles."""
    if candidate.backwards:
        return SettingRange(request.end - result.high, request.end - result.low, result.high_open, result.low_open)
    return result.shifted(request.start)


# -- independent settings ---------------------------------------------------------------------------------


class OpenSettings(NamedTuple):
    """Number of settings that a sequence still requires, and names of those that are independent of the given ones."""

    missing: int
    settings: tuple[str, ...]


def open_settings(request: Request) -> list[OpenSettings]:
    """Open settings of every sequence that accepts the settings of a request, fewest curves first.

    Omitted are sequences with less freedom, without one of the curves, or in which a setting follows from the others. A
    return alone counts its settings from h4 and vcv2. Raises BlendError for an invalid request.
    """
    request.validate()
    if not request.type:
        problem = SequenceProblem(request, request.given)
        given = list(problem.settings)
        missing = problem.chain.freedom - len(given)
        return [OpenSettings(missing, problem.new_settings(given))] if problem.rank(given) == len(given) else []
    constraints = request.constraints
    result = []
    for candidate in candidates(request):
        if candidate.accepts(constraints) and not are_dependent(request, candidate, constraints):
            missing = candidate.freedom - len(constraints)
            result.append(OpenSettings(missing, new_settings(request, candidate, constraints) if missing else ()))
    return result


def are_dependent(request: Request, candidate: BlendCandidate, constraints: Sequence[Constraint]) -> bool:
    """Whether one of the constraints follows from the others, whatever their values."""
    return _rank(request, candidate, constraints) < len(constraints)


def determining(
    request: Request, candidate: BlendCandidate, constraint: Constraint, others: Sequence[Constraint]
) -> tuple[Constraint, ...] | None:
    """Smallest subset of other constraints that determines a setting; None where it is independent of them."""
    for count in range(len(others) + 1):
        for subset in combinations(others, count):
            if not are_dependent(request, candidate, subset) and are_dependent(
                request, candidate, [*subset, constraint]
            ):
                return subset
    return None


def new_settings(request: Request, candidate: BlendCandidate, constraints: Sequence[Constraint]) -> tuple[str, ...]:
    """Settings that the constraints do not determine, as the request may write them."""
    names = {c.name for c in constraints}
    available = [n for n in SETTINGS if n in candidate.names - names and request.standard_name(n) == n]
    return tuple(n for n in available if not are_dependent(request, candidate, [*constraints, Constraint(n, 1.0)]))


def _rank(request: Request, candidate: BlendCandidate, constraints: Sequence[Constraint]) -> int:
    """Number of independent constraints: the largest number of independent directions at any point."""
    if not constraints or not candidate.freedom:
        return 0
    problem = candidate.problem(request, constraints)
    strokes = problem.task.back / problem.task.rise
    rows = np.array([_directions(problem.family, strokes, c.name, c.at) for c in problem.constraints])
    ranks = (int(np.sum(np.linalg.svd(rows[:, i], compute_uv=False) > _ZERO)) for i in range(rows.shape[1]))
    return max(ranks, default=len(constraints))  # none depends on another where no motion exists


@lru_cache(maxsize=1024)
def _directions(family: Family, strokes: float, name: str, at: float) -> np.ndarray:
    """Relative gradients of a setting at sample points (points, variables), of length 1, or 0."""
    evaluator = Evaluator(family, BlendTask(1.0, strokes, 1.0))
    z = Region(evaluator, ()).sample()[:, :: 3 * MIXES]
    result = evaluator.setting(Constraint(name, 1.0, at), evaluator.forms(z[0], z[1:], slopes=True))
    slopes = (result[1:] * z).T
    sizes = np.linalg.norm(slopes, axis=1, keepdims=True)
    has_gradient = sizes > _ZERO * np.abs(result[0])[:, None]
    return np.where(has_gradient, slopes / np.where(has_gradient, sizes, 1.0), 0.0)


# -- refusals ---------------------------------------------------------------------------------------------


def refusal(request: Request, complete: Sequence[BlendCandidate], constraints: Sequence[Constraint]) -> BlendError:
    """Error where no sequence satisfies the constraints.

    Reports a setting that others determine; else the last one with a range under the others, nonlinear ones first; else
    the first one outside its range under the previous ones.
    """
    for name in (given for given in request.settings if given in FLATS):
        allowed = flat_ranges(request, name)
        value = request.settings[name]
        if allowed and not any(r.low < value < r.high for r in allowed):
            rest = ", ".join(f"{n} = {result_text(v, 6)}" for n, v in request.settings.items() if n != name)
            return infeasible(f"{name} = {result_text(value, 6)} deg", name, allowed, "deg", rest)
    independent = [c for c in complete if not are_dependent(request, c, constraints)]
    redundant = None if independent else _redundant(request, complete, constraints)
    if redundant is not None:
        return redundant
    for constraint in hardest_first(constraints) if independent else ():
        others = [c for c in constraints if c is not constraint]
        ranges = ranges_of(request, independent, others, constraint)
        if ranges:
            return _out_of_range(request, constraint, ranges, others)
    ordered = sorted(constraints, key=lambda c: not c.linear)
    for i, constraint in enumerate(ordered):
        ranges = ranges_of(request, complete, ordered[:i], constraint)
        value = _shown_value(request, constraint)
        if ranges and not any(r.low <= value <= r.high for r in ranges):
            return _out_of_range(request, constraint, ranges, ordered[:i])
    names = ", ".join(_text(request, c) for c in constraints)
    return BlendError(f"{names}: these settings have no solution; change one of them")


def _redundant(
    request: Request, complete: Sequence[BlendCandidate], constraints: Sequence[Constraint]
) -> BlendError | None:
    """Refusal of a setting that others determine; None where those others are infeasible themselves."""
    for candidate in complete:
        for constraint in hardest_first(constraints):
            others = [c for c in constraints if c is not constraint]
            causes = determining(request, candidate, constraint, others)
            ranges = ranges_of(request, [candidate], causes, constraint) if causes is not None else []
            if causes is not None and ranges and all(r.is_single for r in ranges):
                name, unit = request.requested_name(constraint.name), request.unit_of(constraint.name)
                allowed = ranges[0].low, ranges[-1].high
                cause = f" by {', '.join(_text(request, c) for c in causes)}" if causes else ""
                values = " or ".join(result_text(r.low, 6) for r in ranges)
                text = f"{_text(request, constraint)} {unit}: already determined{cause}: {name} = {values} {unit}"
                return BlendError(f"{text}; {_instead(request, candidate, others)}", name, allowed)
    return None


def _instead(request: Request, candidate: BlendCandidate, constraints: Sequence[Constraint]) -> str:
    """Remedy with an independent setting and its range: ``instead set h1 (0 < h1 < 15 mm), h3 or acceleration``."""
    independent = (
        new_settings(request, candidate, constraints) if not are_dependent(request, candidate, constraints) else ()
    )
    if not independent:
        return "remove it" if candidate.freedom < len(constraints) + 1 else "set another one"
    names = [request.requested_name(n) for n in independent]
    ranges = ranges_of(request, [candidate], constraints, request.constraint(independent[0], 1.0))
    if ranges:
        text = " or ".join(r.text(names[0]) for r in ranges)
        names[0] = f"{names[0]} ({text} {request.unit_of(independent[0])})"
    return f"instead set {', '.join(names[:-1])} or {names[-1]}" if len(names) > 1 else f"instead set {names[0]}"


def _without_half_cycloid(request: Request) -> BlendError:
    """Refusal of a constant acceleration inside a curve that is no half cycloid."""
    name = next(setting for setting in request.settings if setting in FLATS)
    rows = candidates(replace(request, settings={}))
    allowed = {
        f"{request.flat_name(height)} ({curve})" for row in rows for height, curve in flat_heights(row.sequence).items()
    }
    text = f"{name} = {request.settings[name]:g} deg: its curve is no half cycloid of these motions"
    return BlendError(
        f"{text}; allowed: {' | '.join(sorted(allowed)) or 'none, their curves contain no half cycloid C1 ... C4'}",
        name,
    )


def _out_of_range(
    request: Request, constraint: Constraint, ranges: Sequence[SettingRange], other_constraints: Sequence[Constraint]
) -> BlendError:
    """Refusal of a setting, with its feasible range."""
    unit, name = request.unit_of(constraint.name), request.requested_name(constraint.name)
    allowed = ranges[0].low, ranges[-1].high
    others = ", ".join(_text(request, c) for c in other_constraints)
    tail = f" with {others}" if others else ""
    text = f"{_text(request, constraint)} {unit}"
    if SettingRange(*allowed).is_single:
        return BlendError(
            f"{text}: already determined{tail}: {result_text(allowed[0], 6)} {unit}; set another one", name, allowed
        )
    if any(_is_well_within(r, _shown_value(request, constraint)) for r in ranges):
        shown = " or ".join(r.text(name) for r in ranges)
        text = f"{text}: many motions have this value{tail}, so it does not determine one"
        return BlendError(f"{text}; set another one, or one within {shown} {unit}", name, allowed, ranges)
    return infeasible(text, name, ranges, unit, others)


def wrong_number(request: Request) -> BlendError:
    """Refusal of a wrong number of settings: the number each sequence requires, and which settings are open."""
    rows = candidates(request)
    if not rows and request.flats:
        return _without_half_cycloid(request)
    if not rows:
        allowed = " | ".join(str(s) for s in sequences(request.type, request.constant))
        return BlendError(f"sequence {request.sequence!r}: no sequence of this motion; allowed: {allowed}")
    counts = sorted({(c.freedom, f"{c.sequence}{' (mirrored)' if c.family.mirrored else ''}") for c in rows})
    requirements = "; ".join(f"{name} requires {count} setting{'s' if count != 1 else ''}" for count, name in counts)
    given = (
        ", ".join([*(name for name in request.settings if name not in FLATS), *([POINT] * len(request.points))])
        or "none"
    )
    known = set().union(*(c.names for c in rows))
    unknown = [name for name in request.settings if request.standard_name(name) not in known and name not in FLATS]
    if unknown:
        allowed = " | ".join(request.requested_name(name) for name in SETTINGS if name in known)
        text = f"settings given: {given}; {requirements}; {', '.join(unknown)}: not a setting of these curves; allowed: {allowed}"
        return BlendError(text, unknown[0])
    independent = {name for opening in open_settings(request) for name in opening.settings}
    remedy = (
        f"; still open: {', '.join(request.requested_name(n) for n in SETTINGS if n in independent)}"
        if independent
        else ""
    )
    return BlendError(f"settings given: {given}; {requirements}{remedy}; or select a goal (best)")


# -- texts ------------------------------------------------------------------------------------------------


def _shown_value(request: Request, constraint: Constraint) -> float:
    return constraint.value + request.offset_of(constraint.name)


def _text(request: Request, constraint: Constraint) -> str:
    """Constraint as text: ``point at 120 deg = 5``."""
    at = f" at {result_text(constraint.at + request.start, 6)} deg" if constraint.name == POINT else ""
    return f"{request.requested_name(constraint.name)}{at} = {result_text(_shown_value(request, constraint), 6)}"


def _is_well_within(result: SettingRange, value: float) -> bool:
    room = SAME * (result.high - result.low) if isfinite(result.high) else SAME * abs(result.low)
    return result.low + room < value < result.high - room
