"""The motion that meets a request: ``blend`` where its settings determine it, ``best`` where they leave something free."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from math import log
from types import MappingProxyType

import numpy as np

from core.blend.equations import BlendSolution
from core.blend.evaluator import Evaluator, constant, law_of, logarithm
from core.blend.feasible import dependent, refusal, wrong_number
from core.blend.request import LENGTHS, BlendError, BlendResult, Constraint, Request
from core.blend.sequences import CONSTANT
from core.blend.solver import BlendCandidate, Problem, Quantity, candidates, least, log_accelerations
from core.design import Cam, Design, Motion, Segment, join_levels, mirrored, require_motion, with_motion
from core.design.edits import back_at_start, balance, is_dwell
from core.design.motion_edits import with_marks_of, without_marks
from core.design.rules import CLOSING
from core.errors import DesignError, Fault
from core.laws import peaks
from core.numerics.lazy import checkpoint

# -- A blended motion put into a design -------------------------------------------------------------------------


Numbered = tuple[Segment, int | None]
"""A segment, and its number in the motion it comes from; None where it is new."""


def with_blend(design: Design, blended: BlendResult) -> Design:
    """The design with a blended motion: over the whole turn where that comes back to where it starts, else in place of
    what the motion does between its angles. Raises DesignError."""
    whole = abs(blended.gain - require_motion(design).gain) <= CLOSING
    return with_blend_as_motion(design, blended) if whole else with_blend_between(design, blended)


def with_blend_as_motion(design: Design, blended: BlendResult) -> Design:
    """The design with its motion replaced by dwell - blended curves - dwell. Raises DesignError where the blended
    motion does not come back to where it starts, or is in another unit."""
    _require_unit(design, blended)
    total = blended.gain
    if abs(total - require_motion(design).gain) > CLOSING:
        value = f"rises add up to {total:.9g} {blended.request.unit}"
        raise _refused("motion.segments", value, "a rise or a return alone is no whole motion", "DRRD | RRR")
    request = blended.request
    return _turn(design, [(request.start, blended.segments)], 360.0 - request.end, blended.first_level)


def with_blend_between(design: Design, blended: BlendResult) -> Design:
    """The design with the blended curves in place of what its motion does between their angles; the rest stays, and
    dwells that reach over an end are cut there.

    Where the follower then ends at another level, the next segment that moves brings it back; where nothing else moves,
    the blended curves do so, run backwards. Raises DesignError where a segment that moves would have to be cut, the
    turn has no room left for the way back, or the units differ.
    """
    _require_unit(design, blended)
    motion, request = require_motion(design), blended.request
    before, after = _outside(motion, request.start, request.end)
    if not motion.gain and abs(blended.gain) > CLOSING and all(is_dwell(segment) for segment, _ in before + after):
        return _there_and_back(design, blended)
    rows: list[Numbered] = [*before, *((segment, None) for segment in blended.segments), *after]
    segments = [segment for segment, _ in rows]
    if abs(math.fsum(s.rise for s in segments) - motion.gain) > CLOSING:
        behind = len(rows) - len(after)
        segments = list(back_at_start(segments, [*range(behind, len(rows)), *range(len(before))], motion.gain))
    changed = with_motion(design, replace(motion, segments=tuple(segments)))
    return with_marks_of(changed, [number for _, number in rows])


def _refused(path: str, value: object, problem: str, allowed: str) -> DesignError:
    return DesignError([Fault(path, value, problem, allowed)])


def _require_unit(design: Design, blended: BlendResult) -> None:
    unit = require_motion(design).unit
    if blended.request.unit != unit:
        raise _refused("motion", f"a blend in {blended.request.unit}", "not the unit of this design's motion", unit)


def _turn(design: Design, runs: Sequence[tuple[float, Sequence[Segment]]], after: float, start: float) -> Design:
    """The design with a motion of its own: runs of curves, each behind a dwell of so many degrees, and a last dwell."""
    segments: list[Segment] = []
    for dwell, curves in runs:
        segments += [*([Segment(dwell, 0.0)] if dwell > 0.0 else []), *curves]
    segments += [Segment(after, 0.0)] if after > 0.0 else []
    start = balance(start, (-_lowest(design),))
    motion = replace(require_motion(design), start=start, segments=tuple(segments))
    return without_marks(with_motion(design, motion))


def _lowest(design: Design) -> float:
    """Where a motion over the whole turn has its lowest level: on a base circle that is typed, else where it was."""
    return 0.0 if isinstance(design.drive.cam, Cam) else min(join_levels(require_motion(design)))


def _there_and_back(design: Design, blended: BlendResult) -> Design:
    """The blended stroke and its mirror image, about 180 degrees where both fit so, else in what is left of the turn."""
    request, curves = blended.request, blended.segments
    start, end = request.start, request.end
    image = [mirrored(segment) for segment in reversed(curves)]
    if end <= 180.0:
        return _turn(design, [(start, curves), (360.0 - 2.0 * end, image)], start, blended.first_level)
    room = 360.0 - end if end < 360.0 else start
    if room <= 0.0:
        angles = f"{start:g} ... {end:g} deg"
        raise _refused("motion.segments", angles, "leaves no room for the way back", "less than the whole turn")
    image = [replace(s, span_deg=s.span_deg * room / (end - start)) for s in image]
    if end < 360.0:
        return _turn(design, [(start, curves), (0.0, image)], 0.0, blended.first_level)
    return _turn(design, [(0.0, image), (0.0, curves)], 0.0, blended.first_level + blended.gain)


def _outside(motion: Motion, start: float, end: float) -> tuple[list[Numbered], list[Numbered]]:
    """What the motion does before and after these cam angles [deg]. Raises DesignError where one of them lies inside a
    segment that moves."""
    before: list[Numbered] = []
    after: list[Numbered] = []
    at = 0.0
    for number, segment in enumerate(motion.segments):
        first, at = at, balance(at, (-segment.span_deg,))
        for angle in (start, end):
            if first + CLOSING < angle < at - CLOSING and not is_dwell(segment):
                angles, place = f"{first:g} ... {at:g} deg", f"a join, or an angle in a dwell; not {angle:g} deg"
                raise _refused(f"motion.segments[{number}]", angles, "moves, and would be cut", place)
        if first < start - CLOSING:
            span = segment.span_deg if at <= start + CLOSING else balance(start, (first,))
            before.append((replace(segment, span_deg=span), number))
        if at > end + CLOSING:
            span = segment.span_deg if first >= end - CLOSING else balance(at, (end,))
            after.append((replace(segment, span_deg=span), number))
    return before, after


# -- the motion that meets a request ----------------------------------------------------------------------------


MOST_NONLINEAR = 2  # acceleration and points that are solved for at once
NEGLIGIBLE = 1e-6  # a stretch of constant velocity shorter than this share of the stroke is none

FLAT_GOAL = "acceleration"  # what a constant acceleration of its own span can be found the best by

Goal = tuple[int, int, int]
"""Which peak coefficient c of a curve counts, and the powers of height and of span beside it: c h^i / β^k."""

GOALS: Mapping[str, Goal] = MappingProxyType({"acceleration": (0, 1, 2), "jerk": (1, 1, 3), "torque": (2, 2, 3)})
"""Largest |a| [per deg²], |jerk| inside the curves [per deg³] and |v a|, to which the inertia torque on the camshaft is
proportional."""


def blend(request: Request) -> BlendResult:
    """The motion of fewest curves that meets a request; where several do, the gentlest. Raises BlendError, which names
    what would be feasible."""
    request.validate()
    constraints = request.constraints
    fitting = [c for c in candidates(request) if c.freedom == len(constraints) and c.has(constraints)]
    if not fitting:
        raise wrong_number(request)
    if sum(not c.linear for c in constraints) > MOST_NONLINEAR:
        raise BlendError(
            f"more than {MOST_NONLINEAR} of acceleration and points: give a height, speed or length instead"
        )
    for candidate in fitting:
        solutions = candidate.problem(request, constraints).solutions()
        if solutions:
            return candidate.answer(request, solutions[0])
    raise refusal(request, fitting, constraints)


# -- the gentlest -----------------------------------------------------------------------------------------


def best(request: Request, goal: str) -> BlendResult:
    """The gentlest motion by a goal of ``GOALS`` among all sequences of the request, its settings kept; ``length`` and ``length2``
    are the least that the constant velocities may last.

    Raises BlendError; also where a constant velocity is wanted and the gentlest would have none.
    """
    if goal not in GOALS:
        raise BlendError(f"best {goal!r}: unknown; allowed: {' | '.join(GOALS)}")
    request.validate()
    if request.flats and goal != FLAT_GOAL:
        raise BlendError(f"best {goal}: not beside a constant acceleration of its own span; allowed: {FLAT_GOAL}")
    winner: tuple[float, BlendCandidate, BlendSolution] | None = None
    for candidate in candidates(request):
        checkpoint()
        solution = _best_of(request, candidate, GOALS[goal])
        if solution is not None:
            peak = _peak(solution, GOALS[goal])
            if winner is None or peak < winner[0] * (1.0 - 1e-9):
                winner = peak, candidate, solution
    if winner is None:
        raise _nothing(request)
    _, candidate, solution = winner
    heights = dict(zip(solution.sequence.curves, solution.heights, strict=True))
    for curve, length in _stretches(solution).items():
        if heights[curve] <= NEGLIGIBLE * max(solution.heights) and length not in request.settings:
            stroke, height = ("rise", "h2") if curve in solution.sequence.rise else ("return", request.spelled("h5"))
            missing = f"no constant velocity left on the {stroke}; give {length} or {height}"
            raise BlendError(f"best {goal}: the gentlest has {missing}")
    return candidate.answer(request, solution)


def _nothing(request: Request) -> BlendError:
    """Why no sequence does it: what the last setting may be while the others stay."""
    able = [c for c in candidates(request) if c.takes(request.constraints)]
    if not able:
        if not candidates(request) and request.flats:
            return wrong_number(request)
        return BlendError(f"no sequence of this motion takes these settings: {', '.join(request.settings)}")
    return refusal(request, able, request.constraints)


def _best_of(request: Request, candidate: BlendCandidate, goal: Goal) -> BlendSolution | None:
    """The best of a sequence; None where the settings leave nothing."""
    lengths = {name: request.settings[name] for name in LENGTHS if request.settings.get(name)}
    constraints = [c for c in request.constraints if c.name not in LENGTHS]
    if not (candidate.takes(constraints) and candidate.has(request.constraints)):
        return None
    problem = candidate.problem(request, constraints)
    is_complete = candidate.freedom == len(constraints)
    if lengths and not is_complete and not dependent(request, candidate, request.constraints):
        return _searched(problem, goal, lengths)
    able = problem.solutions() if is_complete else [_searched(problem, goal, {})]
    long_enough = [s for s in able if s is not None and _lasts(s, lengths)]
    return min(long_enough, key=partial(_peak, goal=goal), default=None)


def _searched(problem: Problem, goal: Goal, lengths: Mapping[str, float]) -> BlendSolution | None:
    """The best over the numbers that the constraints leave free. In logarithms: the same for slow and fast motions."""
    evaluator = problem.evaluator
    goals: list[Quantity] = [
        partial(_log_peak, evaluator, goal, row) for row in evaluator.curves if _coefficient(row[0], goal[0])
    ]
    if evaluator.family.flats:  # the only goal is the acceleration
        goals = log_accelerations(evaluator)
    limits = [partial(evaluator.missed, Constraint(name, each / problem.task.span)) for name, each in lengths.items()]
    result = least(evaluator, problem.constraints, goals, limits)
    if result is None:
        return None
    if (
        min(evaluator.at(evaluator.family.constant, result[1]), default=1.0) <= NEGLIGIBLE
    ):  # perhaps others are as gentle
        limits += [partial(_above, evaluator, name) for name in evaluator.family.constant]
        other = least(evaluator, problem.constraints, goals, limits)
        result = other if other is not None and other[0] <= result[0] + 1e-9 else result
    return problem.solution_at(result[1])


def _above(evaluator: Evaluator, name: str, forms: np.ndarray) -> np.ndarray:
    """By how much a constant velocity is higher than one that counts as none."""
    return evaluator.form(name, forms) - constant(1e3 * NEGLIGIBLE, forms)


def _log_peak(evaluator: Evaluator, goal: Goal, curve: tuple[str, str, str], forms: np.ndarray) -> np.ndarray:
    """Logarithm of c h^i / β^k with its derivatives."""
    which, power, root = goal
    height, span = evaluator.height_and_span(curve, forms)
    return power * logarithm(height) - root * logarithm(span) + constant(log(_coefficient(curve[0], which)), forms)


def _peak(solution: BlendSolution, goal: Goal) -> float:
    """The greatest c h^i / β^k of a solution."""
    which, power, root = goal
    if solution.flats:
        return solution.peak_acceleration
    rows = zip(solution.sequence.curves, solution.heights, solution.spans, strict=True)
    return max(c * h**power / b**root for name, h, b in rows if (c := _coefficient(name, which)))


@lru_cache(maxsize=64)
def _coefficient(curve: str, which: int) -> float:
    result = peaks(law_of(curve))
    return (result.ca, result.cj, result.cm)[which]


def _stretches(solution: BlendSolution) -> dict[str, str]:
    """Each constant velocity of a solution -> the setting of its span."""
    return dict(zip((name for name in solution.sequence.curves if name in CONSTANT), LENGTHS, strict=False))


def _lasts(solution: BlendSolution, lengths: Mapping[str, float]) -> bool:
    """Whether the constant velocities are as long as given [deg]."""
    spans = dict(zip(solution.sequence.curves, solution.spans, strict=True))
    return all(spans[curve] >= lengths.get(name, 0.0) * (1.0 - 1e-12) for curve, name in _stretches(solution).items())
