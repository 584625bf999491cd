"""Blended motions: ``blend`` where the settings determine the motion, ``best`` where they leave variables free."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import log

import numpy as np

from core.blend.equations import BlendSolution
from core.blend.evaluator import GOALS, Evaluator, constant, logarithm, peak_coefficient
from core.blend.feasible import are_dependent, refusal, wrong_number
from core.blend.request import LENGTHS, BlendError, BlendResult, Constraint, Request
from core.blend.sequence import best_of_sequence, blend_sequence
from core.blend.sequences import CONSTANT
from core.blend.solver import BlendCandidate, Problem, Quantity, candidates, least, log_accelerations
from core.design import Cam, Design, Motion, Segment, join_levels, mirrored, require_motion, with_motion
from core.design.edits import back_at_start, balance, is_dwell
from core.design.motion_edits import with_marks_of, without_marks
from core.design.rules import CLOSING
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.number_text import result_text
from core.numerics.lazy import checkpoint

# -- blended motion in a design ---------------------------------------------------------------------------------


Numbered = tuple[Segment, int | None]
"""A segment, and its number in the original motion; None where it is new."""


def with_blend(design: Design, blended: BlendResult) -> Design:
    """Design with a blended motion: as the motion of the full turn where it closes, else between its cam angles.

    Raises DesignError as ``with_blend_as_motion`` and ``with_blend_between`` do.
    """
    is_closed = abs(blended.gain - require_motion(design).gain) <= CLOSING
    return with_blend_as_motion(design, blended) if is_closed else with_blend_between(design, blended)


def with_blend_as_motion(design: Design, blended: BlendResult) -> Design:
    """Design whose motion is dwell - blended curves - dwell.

    Raises DesignError where the blended motion does not return to its start, or has another unit.
    """
    _require_unit(design, blended)
    gain = blended.gain
    if abs(gain - require_motion(design).gain) > CLOSING:
        value = f"rises add up to {result_text(gain, 6)} {blended.request.unit}"
        raise _refused("motion.segments", value, "a rise or a return alone does not close the motion", "DRRD | RRR")
    request = blended.request
    return _turn(design, [(request.start, blended.segments)], 360.0 - request.end, blended.first_level)


def with_blend_between(design: Design, blended: BlendResult) -> Design:
    """Design whose motion is replaced between the cam angles of the blended curves; dwells are shortened there.

    Where the curves end at another level, the next moving segment returns the follower; where no other segment moves,
    the blended curves do so, run backwards. Raises DesignError where a moving segment would be split, no angle is left
    for the return, or the units differ.
    """
    _require_unit(design, blended)
    motion, request = require_motion(design), blended.request
    before, after = _outside(motion, request.start, request.end)
    if not motion.gain and abs(blended.gain) > CLOSING and all(is_dwell(segment) for segment, _ in before + after):
        return _with_mirrored_return(design, blended)
    rows: list[Numbered] = [*before, *((segment, None) for segment in blended.segments), *after]
    segments = [segment for segment, _ in rows]
    if abs(math.fsum(s.rise for s in segments) - motion.gain) > CLOSING:
        first_after = len(rows) - len(after)
        segments = list(back_at_start(segments, [*range(first_after, len(rows)), *range(len(before))], motion.gain))
    changed = with_motion(design, replace(motion, segments=tuple(segments)))
    return with_marks_of(changed, [number for _, number in rows])


def _refused(path: str, value: object, problem: str, allowed: str) -> DesignError:
    return DesignError([Fault(path, value, problem, allowed)])


def _require_unit(design: Design, blended: BlendResult) -> None:
    unit = require_motion(design).unit
    if blended.request.unit != unit:
        raise _refused("motion", f"a blend in {blended.request.unit}", "not the unit of this design's motion", unit)


def _turn(design: Design, groups: Sequence[tuple[float, Sequence[Segment]]], after: float, start: float) -> Design:
    """Design with a motion of several groups of curves, each preceded by a dwell [deg], and a last dwell."""
    segments: list[Segment] = []
    for dwell, curves in groups:
        segments += [*([Segment(dwell, 0.0)] if dwell > 0.0 else []), *curves]
    segments += [Segment(after, 0.0)] if after > 0.0 else []
    start = balance(start, (-_lowest(design),))
    motion = replace(require_motion(design), start=start, segments=tuple(segments))
    return without_marks(with_motion(design, motion))


def _lowest(design: Design) -> float:
    """Lowest level of a motion over the full turn: 0 for a cam with a base circle, else that of the current motion."""
    return 0.0 if isinstance(design.drive.cam, Cam) else min(join_levels(require_motion(design)))


def _with_mirrored_return(design: Design, blended: BlendResult) -> Design:
    """Design with the blended stroke and its mirror image, symmetric about 180 degrees where possible."""
    request, curves = blended.request, blended.segments
    start, end = request.start, request.end
    image = [mirrored(segment) for segment in reversed(curves)]
    if end <= 180.0:
        return _turn(design, [(start, curves), (360.0 - 2.0 * end, image)], start, blended.first_level)
    room = 360.0 - end if end < 360.0 else start
    if room <= 0.0:
        angles = f"{start:g} ... {end:g} deg"
        raise _refused("motion.segments", angles, "leaves no angle for the return", "less than a full turn")
    image = [replace(s, span_deg=s.span_deg * room / (end - start)) for s in image]
    if end < 360.0:
        return _turn(design, [(start, curves), (0.0, image)], 0.0, blended.first_level)
    return _turn(design, [(0.0, image), (0.0, curves)], 0.0, blended.first_level + blended.gain)


@frozen
class SplitSegment:
    """A moving segment that a range of cam angles would split.

    Attributes
    ----------
    angle_deg : end of the range inside the segment [deg]
    number : index of the segment
    start_deg, end_deg : cam angles of the segment [deg]
    """

    angle_deg: float
    number: int
    start_deg: float
    end_deg: float


def split_segment(motion: Motion, start: float, end: float) -> SplitSegment | None:
    """First moving segment that a range of cam angles [deg] would split; None where its ends are joins or in dwells."""
    end_deg = 0.0
    for number, segment in enumerate(motion.segments):
        start_deg, end_deg = end_deg, balance(end_deg, (-segment.span_deg,))
        for angle in (start, end):
            if start_deg + CLOSING < angle < end_deg - CLOSING and not is_dwell(segment):
                return SplitSegment(angle, number, start_deg, end_deg)
    return None


def _outside(motion: Motion, start: float, end: float) -> tuple[list[Numbered], list[Numbered]]:
    """Segments before and after two cam angles [deg]. Raises DesignError where an angle is inside a moving segment."""
    before: list[Numbered] = []
    after: list[Numbered] = []
    if (split := split_segment(motion, start, end)) is not None:
        angles = f"{split.start_deg:g} ... {split.end_deg:g} deg"
        allowed = f"a join, or an angle in a dwell; not {split.angle_deg:g} deg"
        raise _refused(f"motion.segments[{split.number}]", angles, "moves, and would be split", allowed)
    end_deg = 0.0
    for number, segment in enumerate(motion.segments):
        start_deg, end_deg = end_deg, balance(end_deg, (-segment.span_deg,))
        if start_deg < start - CLOSING:
            span = segment.span_deg if end_deg <= start + CLOSING else balance(start, (start_deg,))
            before.append((replace(segment, span_deg=span), number))
        if end_deg > end + CLOSING:
            span = segment.span_deg if start_deg >= end - CLOSING else balance(end_deg, (end,))
            after.append((replace(segment, span_deg=span), number))
    return before, after


# -- motion determined by its settings --------------------------------------------------------------------------


MOST_NONLINEAR = 2  # greatest number of nonlinear constraints
NEGLIGIBLE = 1e-6  # least height of a constant velocity relative to the stroke

FLAT_GOAL = "acceleration"  # the only goal of motions with constant acceleration
Goal = tuple[str, int, int]


def blend(request: Request) -> BlendResult:
    """Motion of fewest curves that satisfies a request; of several the one with the smallest peak acceleration.

    Raises BlendError with the feasible range of a setting.
    """
    request.validate()
    if not request.type:
        return blend_sequence(request)
    constraints = request.constraints
    complete = [c for c in candidates(request) if c.freedom == len(constraints) and c.has_settings(constraints)]
    if not complete:
        raise wrong_number(request)
    if sum(not c.linear for c in constraints) > MOST_NONLINEAR:
        raise BlendError(f"more than {MOST_NONLINEAR} accelerations and points: give a height, speed or length instead")
    for candidate in complete:
        solutions = candidate.problem(request, constraints).solutions()
        if solutions:
            return candidate.result(request, solutions[0])
    raise refusal(request, complete, constraints)


# -- optimal motion ---------------------------------------------------------------------------------------


def best(request: Request, goal: str) -> BlendResult:
    """Optimal motion by a goal in ``GOALS`` among all sequences of the request, with its settings.

    ``length`` and ``length2`` are lower limits of the spans of constant velocity. Raises BlendError, also where a
    constant velocity is requested and the optimum has none.
    """
    if goal not in GOALS:
        raise BlendError(f"best {goal!r}: unknown; allowed: {' | '.join(GOALS)}")
    request.validate()
    if not request.type:
        return best_of_sequence(request, goal)
    if request.flats and goal != FLAT_GOAL:
        raise BlendError(f"best {goal}: cannot be combined with a constant acceleration; allowed: {FLAT_GOAL}")
    winner: tuple[float, BlendCandidate, BlendSolution] | None = None
    for candidate in candidates(request):
        checkpoint()
        solution = _best_of_candidate(request, candidate, GOALS[goal])
        if solution is not None:
            peak = _peak(solution, GOALS[goal])
            if winner is None or peak < winner[0] * (1.0 - 1e-9):
                winner = peak, candidate, solution
    if winner is None:
        raise _no_sequence(request)
    _, candidate, solution = winner
    heights = dict(zip(solution.sequence.curves, solution.heights, strict=True))
    for curve, length in _constant_velocities(solution).items():
        if heights[curve] <= NEGLIGIBLE * max(solution.heights) and length not in request.settings:
            stroke, height = (
                ("rise", "h2") if curve in solution.sequence.rise else ("return", request.requested_name("h5"))
            )
            missing = f"no constant velocity left on the {stroke}; give {length} or {height}"
            raise BlendError(f"best {goal}: the optimum has {missing}")
    return candidate.result(request, solution)


def _no_sequence(request: Request) -> BlendError:
    """Refusal where no sequence satisfies the settings: the range of the last setting under the others."""
    accepting = [c for c in candidates(request) if c.accepts(request.constraints)]
    if not accepting:
        if not candidates(request) and request.flats:
            return wrong_number(request)
        return BlendError(f"no sequence of this motion accepts these settings: {', '.join(request.settings)}")
    return refusal(request, accepting, request.constraints)


def _best_of_candidate(request: Request, candidate: BlendCandidate, goal: Goal) -> BlendSolution | None:
    """Optimum of one sequence; None where the settings are infeasible."""
    lengths = {name: request.settings[name] for name in LENGTHS if request.settings.get(name)}
    constraints = [c for c in request.constraints if c.name not in LENGTHS]
    if not (candidate.accepts(constraints) and candidate.has_settings(request.constraints)):
        return None
    problem = candidate.problem(request, constraints)
    is_complete = candidate.freedom == len(constraints)
    if lengths and not is_complete and not are_dependent(request, candidate, request.constraints):
        return _searched(problem, goal, lengths)
    solutions = problem.solutions() if is_complete else [_searched(problem, goal, {})]
    long_enough = [s for s in solutions if s is not None and _is_long_enough(s, lengths)]
    return min(long_enough, key=partial(_peak, goal=goal), default=None)


def _searched(problem: Problem, goal: Goal, lengths: Mapping[str, float]) -> BlendSolution | None:
    """Optimum over the variables that the constraints leave free, in logarithms."""
    evaluator = problem.evaluator
    goals: list[Quantity] = [
        partial(_log_peak, evaluator, goal, row) for row in evaluator.curves if peak_coefficient(row[0], goal[0])
    ]
    if evaluator.family.flats:  # the only goal is the acceleration
        goals = log_accelerations(evaluator)
    limits = [
        partial(evaluator.residual, Constraint(name, length / problem.task.span)) for name, length in lengths.items()
    ]
    result = least(evaluator, problem.constraints, goals, limits)
    if result is None:
        return None
    if (
        min(evaluator.at(evaluator.family.constant, result[1]), default=1.0) <= NEGLIGIBLE
    ):  # another optimum may be equal
        limits += [partial(_above, evaluator, name) for name in evaluator.family.constant]
        alternative = least(evaluator, problem.constraints, goals, limits)
        result = alternative if alternative is not None and alternative[0] <= result[0] + 1e-9 else result
    return problem.solution_at(result[1])


def _above(evaluator: Evaluator, name: str, forms: np.ndarray) -> np.ndarray:
    """Height of a constant velocity minus the least one."""
    return evaluator.form(name, forms) - constant(1e3 * NEGLIGIBLE, forms)


def _log_peak(evaluator: Evaluator, goal: Goal, curve: tuple[str, str, str], forms: np.ndarray) -> np.ndarray:
    """Logarithm of c h^i / β^k with its derivatives."""
    coefficient, height_power, span_power = goal
    height, span = evaluator.height_and_span(curve, forms)
    return (
        height_power * logarithm(height)
        - span_power * logarithm(span)
        + constant(log(peak_coefficient(curve[0], coefficient)), forms)
    )


def _peak(solution: BlendSolution, goal: Goal) -> float:
    """Largest c h^i / β^k of a solution."""
    coefficient, height_power, span_power = goal
    if solution.flats:
        return solution.peak_acceleration
    rows = zip(solution.sequence.curves, solution.heights, solution.spans, strict=True)
    return max(c * h**height_power / b**span_power for name, h, b in rows if (c := peak_coefficient(name, coefficient)))


def _constant_velocities(solution: BlendSolution) -> dict[str, str]:
    """Curve of constant velocity of a solution -> setting of its span."""
    return dict(zip((name for name in solution.sequence.curves if name in CONSTANT), LENGTHS, strict=False))


def _is_long_enough(solution: BlendSolution, lengths: Mapping[str, float]) -> bool:
    """Whether the constant velocities have at least the given spans [deg]."""
    spans = dict(zip(solution.sequence.curves, solution.spans, strict=True))
    return all(
        spans[curve] >= lengths.get(name, 0.0) * (1.0 - 1e-12) for curve, name in _constant_velocities(solution).items()
    )
