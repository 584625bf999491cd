"""Which settings a request may still take, within which ranges, which of its settings others determine; and why a request
is refused: one line that names the setting, what it may be and what to do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context
from functools import lru_cache
from itertools import combinations
from math import inf, isfinite
from typing import NamedTuple

import numpy as np

from core.blend.equations import BlendTask, Family
from core.blend.evaluator import ROUNDING, Evaluator
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
    merged,
)
from core.blend.sequences import sequences
from core.blend.solver import BlendCandidate, candidates, flat_heights
from core.numerics.lazy import checkpoint

_ZERO = 1e-9  # a direction shorter than this is none
FLAT_SAMPLES, HALVINGS = 16, 34  # of spans of a constant acceleration beside its size


# -- ranges -----------------------------------------------------------------------------------------------


def feasible_ranges(request: Request, setting: str, at: float = 0.0) -> list[SettingRange]:
    """What a setting may be while the others stay, as the request spells it; empty where they leave nothing.

    The setting need not be among the request's own: its value does not matter. A ``point`` lies at a cam angle ``at``.
    Where the request with the setting is complete for a sequence, the ranges are those of such sequences; else what is
    still to come is free. One that the others determine has one value. Raises BlendError for a request without sense.
    """
    request.validate()
    if setting not in (*SETTINGS, POINT):
        raise BlendError(f"{setting}: unknown setting; allowed: {' | '.join(SETTINGS)}")
    if setting in FLATS:
        return flat_ranges(request, setting)
    mine = request.constraint(setting, 1.0, at)
    others = [c for c in request.constraints if (c.name, c.at) != (mine.name, mine.at)]
    able = [c for c in candidates(request) if c.takes([*others, mine])]
    complete = [c for c in able if c.freedom == len(others) + 1]
    return ranges_by(request, complete or able, others, mine)


def ranges_by(
    request: Request, rows: Iterable[BlendCandidate], others: Sequence[Constraint], mine: Constraint
) -> list[SettingRange]:
    """What a setting may be beside other constraints by any of the candidates."""
    result = []
    for candidate in rows:
        checkpoint()
        ranges = candidate.problem(request, [*others, mine]).ranges(len(others))
        result += [_shown(r, request, candidate) for r in ranges] if mine.name == "peak" else ranges
    return merged(result)


def flat_ranges(request: Request, setting: str) -> list[SettingRange]:
    """What the span of a constant acceleration may be [deg] beside the other settings, its size among them: above 0, and
    shorter than its curve."""
    name = request.renamed(setting)
    sizes = {given: value for given, value in request.settings.items() if request.renamed(given) == f"a{name[-1]}"}
    rest = {
        given: value
        for given, value in request.settings.items()
        if request.renamed(given) != name and given not in sizes
    }
    without = replace(request, settings=rest)
    mine, others = Constraint(f"span{name[-1]}", 1.0), without.constraints
    rows = [c for c in candidates(without) if c.takes(others) and height_of(name) in flat_heights(c.sequence)]
    complete = [c for c in rows if c.freedom == len(others) + len(sizes)] or rows
    longest = max((_longest(without, c, mine, others) for c in complete), default=0.0)
    if not sizes or not longest:
        return [SettingRange(0.0, longest, True, True)] if longest else []
    return _where(lambda flat: _is_met(replace(without, settings={**rest, setting: flat, **sizes})), longest)


def _longest(request: Request, candidate: BlendCandidate, mine: Constraint, others: Sequence[Constraint]) -> float:
    """The longest that a curve may be [deg]."""
    if candidate.freedom > len(others):
        return max((r.high for r in candidate.problem(request, [*others, mine]).ranges(len(others))), default=0.0)
    solutions = candidate.problem(request, others).solutions()
    height = height_of(mine.name)
    curves = candidate.sequence.curves
    at = curves.index(flat_heights(candidate.sequence)[height])
    spans = [solution.spans[::-1] if candidate.backwards else solution.spans for solution in solutions]
    return max((each[at] for each in spans), default=0.0)


def _is_met(request: Request) -> bool:
    """Whether a motion meets the settings, as far as they go."""
    given = request.constraints
    rows = [c for c in candidates(request) if c.takes(given)]
    complete = [c for c in rows if c.freedom == len(given)]
    if complete:
        return any(c.problem(request, given).solutions() for c in complete)
    size = next(c for c in given if c.name in SIZES)
    others = [c for c in given if c is not size]
    return any(r.low <= size.value <= r.high for r in ranges_by(request, rows, others, size))


def _where(met: Callable[[float], bool], longest: float) -> list[SettingRange]:
    """The stretches between 0 and longest where it is met, each end to a rounding."""
    places = [longest * (i + 0.5) / FLAT_SAMPLES for i in range(FLAT_SAMPLES)]
    able = [met(place) for place in places]
    result: list[SettingRange] = []
    for i, place in enumerate(places):
        if not able[i]:
            continue
        if i == 0 or not able[i - 1]:
            low = _edge(met, place, places[i - 1] if i else 0.0)
            result.append(SettingRange(low, place, True, True))
        high = (
            place
            if i + 1 < len(able) and able[i + 1]
            else _edge(met, place, places[i + 1] if i + 1 < len(able) else longest)
        )
        result[-1] = SettingRange(result[-1].low, high, True, True)
    return [SettingRange(0.0 if r.low <= _ZERO * longest else r.low, r.high, True, True) for r in result]


def _edge(met: Callable[[float], bool], inside: float, outside: float) -> float:
    """Where it ceases to be met, by bisection."""
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if met(middle) else (inside, middle)
    return inside


def _shown(result: SettingRange, request: Request, candidate: BlendCandidate) -> SettingRange:
    """A range of the peak as cam angles."""
    if candidate.backwards:
        return SettingRange(request.end - result.high, request.end - result.low, result.high_open, result.low_open)
    return SettingRange(request.start + result.low, request.start + result.high, result.low_open, result.high_open)


# -- which settings are new -------------------------------------------------------------------------------


class OpenSettings(NamedTuple):
    """How many settings a sequence still takes, and which say something new."""

    missing: int
    settings: tuple[str, ...]


def open_settings(request: Request) -> list[OpenSettings]:
    """The sequences that take the settings of a request, fewest curves first; none that these settings overfill, or whose
    curves lack one of them, or in which one of them follows from the others. Of a return alone the settings are counted
    from h4 and vcv2. Raises BlendError for a request without sense."""
    request.validate()
    given = request.constraints
    result = []
    for candidate in candidates(request):
        if candidate.takes(given) and not dependent(request, candidate, given):
            missing = candidate.freedom - len(given)
            result.append(OpenSettings(missing, new_settings(request, candidate, given) if missing else ()))
    return result


def dependent(request: Request, candidate: BlendCandidate, constraints: Sequence[Constraint]) -> bool:
    """Whether one of the constraints follows from the others, whatever their values."""
    return _rank(request, candidate, constraints) < len(constraints)


def determining(
    request: Request, candidate: BlendCandidate, mine: Constraint, others: Sequence[Constraint]
) -> tuple[Constraint, ...] | None:
    """The fewest of the others that determine a setting; None where it says something new beside all of them."""
    for count in range(len(others) + 1):
        for few in combinations(others, count):
            if not dependent(request, candidate, few) and dependent(request, candidate, [*few, mine]):
                return few
    return None


def new_settings(request: Request, candidate: BlendCandidate, constraints: Sequence[Constraint]) -> tuple[str, ...]:
    """Settings that the constraints do not determine, as the request may spell them."""
    given = {c.name for c in constraints}
    able = [n for n in SETTINGS if n in candidate.names - given and request.renamed(n) == n]
    return tuple(n for n in able if not dependent(request, candidate, [*constraints, Constraint(n, 1.0)]))


def _rank(request: Request, candidate: BlendCandidate, constraints: Sequence[Constraint]) -> int:
    """How many of the constraints say something new: the greatest number of independent directions at any point."""
    if not constraints or not candidate.freedom:
        return 0
    problem = candidate.problem(request, constraints)
    strokes = problem.task.back / problem.task.rise
    rows = np.array([_directions(problem.family, strokes, c.name, c.at) for c in problem.constraints])
    return max(int(np.sum(np.linalg.svd(rows[:, i], compute_uv=False) > _ZERO)) for i in range(rows.shape[1]))


@lru_cache(maxsize=1024)
def _directions(family: Family, strokes: float, name: str, at: float) -> np.ndarray:
    """In which direction a setting grows, at some points (points, free numbers): of length 1, or 0."""
    evaluator = Evaluator(family, BlendTask(1.0, strokes, 1.0))
    z = Region(evaluator, ()).sample()[:, :: 3 * MIXES]
    result = evaluator.setting(Constraint(name, 1.0, at), evaluator.forms(z[0], z[1:], slopes=True))
    slopes = (result[1:] * z).T
    sizes = np.linalg.norm(slopes, axis=1, keepdims=True)
    grows = sizes > _ZERO * np.abs(result[0])[:, None]
    return np.where(grows, slopes / np.where(grows, sizes, 1.0), 0.0)


# -- why a request is refused -----------------------------------------------------------------------------


def refusal(request: Request, fitting: Sequence[BlendCandidate], constraints: Sequence[Constraint]) -> BlendError:
    """The error where no sequence meets the constraints: a setting that others determine; else the last to which the others
    leave something, one that is not linear before all others; else the first that is out of what those before it leave."""
    for name in (given for given in request.settings if given in FLATS):
        allowed = flat_ranges(request, name)
        value = request.settings[name]
        if allowed and not any(r.low < value < r.high for r in allowed):
            return _flat_out_of_range(request, name, allowed)
    able = [c for c in fitting if not dependent(request, c, constraints)]
    redundant = None if able else _redundant(request, fitting, constraints)
    if redundant is not None:
        return redundant
    for constraint in hardest_first(constraints) if able else ():
        others = [c for c in constraints if c is not constraint]
        ranges = ranges_by(request, able, others, constraint)
        if ranges:
            return _out_of_range(request, constraint, ranges, others)
    ordered = sorted(constraints, key=lambda c: not c.linear)
    for i, constraint in enumerate(ordered):
        ranges = ranges_by(request, fitting, ordered[:i], constraint)
        value = _shown_value(request, constraint)
        if ranges and not any(r.low <= value <= r.high for r in ranges):
            return _out_of_range(request, constraint, ranges, ordered[:i])
    names = ", ".join(_text(request, c) for c in constraints)
    return BlendError(f"{names}: these settings leave no range; change one of them")


def _redundant(
    request: Request, fitting: Sequence[BlendCandidate], constraints: Sequence[Constraint]
) -> BlendError | None:
    """The refusal of a setting that others determine, with its value, and what may be set instead; None where those others
    are not feasible themselves."""
    for candidate in fitting:
        for constraint in hardest_first(constraints):
            others = [c for c in constraints if c is not constraint]
            by = determining(request, candidate, constraint, others)
            ranges = ranges_by(request, [candidate], by, constraint) if by is not None else []
            if by is not None and ranges and all(_is_one(r.low, r.high) for r in ranges):
                name, unit = request.spelled(constraint.name), request.unit_of(constraint.name)
                allowed = ranges[0].low, ranges[-1].high
                cause = f" by {', '.join(_text(request, c) for c in by)}" if by else ""
                values = " or ".join(f"{r.low:.9g}" for r in ranges)
                text = f"{_text(request, constraint)} {unit}: determined already{cause}: {name} = {values} {unit}"
                return BlendError(f"{text}; {_instead(request, candidate, others)}", name, allowed)
    return None


def _instead(request: Request, candidate: BlendCandidate, constraints: Sequence[Constraint]) -> str:
    """``instead set h1 (0 < h1 < 15 mm), h3 or acceleration``: what says something new, and a range."""
    new = new_settings(request, candidate, constraints) if not dependent(request, candidate, constraints) else ()
    if not new:
        return "leave it out" if candidate.freedom < len(constraints) + 1 else "set another one"
    names = [request.spelled(n) for n in new]
    ranges = ranges_by(request, [candidate], constraints, request.constraint(new[0], 1.0))
    if ranges:
        text = " or ".join(range_text(r, names[0]) for r in ranges)
        names[0] = f"{names[0]} ({text} {request.unit_of(new[0])})"
    return f"instead set {', '.join(names[:-1])} or {names[-1]}" if len(names) > 1 else f"instead set {names[0]}"


def _flat_out_of_range(request: Request, name: str, allowed: Sequence[SettingRange]) -> BlendError:
    """The refusal of a span of constant acceleration, with what it may be."""
    others = ", ".join(f"{given} = {value:.9g}" for given, value in request.settings.items() if given != name)
    tail = f" beside {others}" if others else ""
    shown = " or ".join(range_text(r, name) for r in allowed)
    text = f"{name} = {request.settings[name]:.9g} deg is not feasible{tail}; feasible: {shown} deg"
    return BlendError(text, name, (allowed[0].low, allowed[-1].high))


def _without_half_cycloid(request: Request) -> BlendError:
    """The refusal of a constant acceleration inside a curve that cannot have one."""
    name = next(given for given in request.settings if given in FLATS)
    rows = candidates(replace(request, settings={}))
    able = {
        f"{request.spelled_flat(height)} ({curve})"
        for row in rows
        for height, curve in flat_heights(row.sequence).items()
    }
    text = f"{name} = {request.settings[name]:g} deg: of no half cycloid of one of these motions"
    return BlendError(
        f"{text}; allowed: {' | '.join(sorted(able)) or 'none, for no half cycloid C1 ... C4 is among their curves'}",
        name,
    )


def _out_of_range(
    request: Request, constraint: Constraint, ranges: Sequence[SettingRange], beside: Sequence[Constraint]
) -> BlendError:
    """The refusal of a setting, with what it may be."""
    unit, name, allowed = (
        request.unit_of(constraint.name),
        request.spelled(constraint.name),
        (ranges[0].low, ranges[-1].high),
    )
    others = ", ".join(_text(request, c) for c in beside)
    tail = f" beside {others}" if others else ""
    text = f"{_text(request, constraint)} {unit}"
    if _is_one(*allowed):
        return BlendError(f"{text}: determined already{tail}: {allowed[0]:.9g} {unit}; set another one", name, allowed)
    shown = " or ".join(range_text(r, name) for r in ranges)
    if any(_is_well_within(r, _shown_value(request, constraint)) for r in ranges):
        text = f"{text}: many motions have it{tail}: it leaves them undetermined"
        return BlendError(f"{text}; set another one, or one within {shown} {unit}", name, allowed)
    return BlendError(f"{text} is not feasible{tail}; feasible: {shown} {unit}", name, allowed)


def wrong_number(request: Request) -> BlendError:
    """How many settings each sequence takes and which of them are still open, or which sequences there are."""
    rows = candidates(request)
    if not rows and request.flats:
        return _without_half_cycloid(request)
    if not rows:
        allowed = " | ".join(str(s) for s in sequences(request.type, request.constant))
        return BlendError(f"sequence {request.sequence!r}: not of this motion; allowed: {allowed}")
    counts = sorted({(c.freedom, f"{c.sequence}{' (mirrored)' if c.family.mirrored else ''}") for c in rows})
    wants = "; ".join(f"{name} takes {count} setting{'s' if count != 1 else ''}" for count, name in counts)
    given = (
        ", ".join([*(name for name in request.settings if name not in FLATS), *([POINT] * len(request.points))])
        or "none"
    )
    known = set().union(*(c.names for c in rows))
    strange = [name for name in request.settings if request.renamed(name) not in known and name not in FLATS]
    if strange:
        allowed = " | ".join(request.spelled(name) for name in SETTINGS if name in known)
        text = f"settings given: {given}; {wants}; {', '.join(strange)}: of no curve here; allowed: {allowed}"
        return BlendError(text, strange[0])
    new = {name for opening in open_settings(request) for name in opening.settings}
    more = f"; still open: {', '.join(request.spelled(n) for n in SETTINGS if n in new)}" if new else ""
    return BlendError(f"settings given: {given}; {wants}{more}; or ask for the best")


# -- words and numbers ------------------------------------------------------------------------------------


def _shown_value(request: Request, constraint: Constraint) -> float:
    return constraint.value + request.start if constraint.name == "peak" else constraint.value


def _text(request: Request, constraint: Constraint) -> str:
    """``point at 120 deg = 5``."""
    at = f" at {constraint.at + request.start:.9g} deg" if constraint.name == POINT else ""
    return f"{request.spelled(constraint.name)}{at} = {_shown_value(request, constraint):.9g}"


def _is_one(low: float, high: float) -> bool:
    """Whether there is but one value."""
    return isfinite(high) and high - low <= SAME * max(abs(low), abs(high))


def _is_well_within(result: SettingRange, value: float) -> bool:
    room = SAME * (result.high - result.low) if isfinite(result.high) else SAME * abs(result.low)
    return result.low + room < value < result.high - room


def range_text(result: SettingRange, name: str) -> str:
    """``0.1 < vcv <= 0.2``; ends that are reached are rounded inwards, so that they can be typed."""
    low = _nine_digits(result.low, ROUND_HALF_EVEN if result.low_open else ROUND_CEILING)
    high = _nine_digits(result.high, ROUND_HALF_EVEN if result.high_open else ROUND_FLOOR)
    if result.high == inf:
        return f"{name} {'>' if result.low_open else '>='} {low:.9g}"
    return f"{low:.9g} {'<' if result.low_open else '<='} {name} {'<' if result.high_open else '<='} {high:.9g}"


def _nine_digits(value: float, rounding: str) -> float:
    """Rounded so, but to the nearest where that is the same but for rounding in the computation."""
    nearest, made = (float(Context(prec=9, rounding=r).create_decimal(value)) for r in (ROUND_HALF_EVEN, rounding))
    return nearest if abs(nearest - value) <= ROUNDING * abs(value) else made
