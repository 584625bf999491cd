"""The solution of a search: a bracketed root of the least margin, or an optimum that is checked on both sides."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import inf

import numpy as np

from core.design import Design, get, require_motion, with_motion
from core.errors import KindynaError, NoSolution
from core.find.goals import (
    CAM_SEARCHES,
    ENDS,
    LARGEST,
    LEAST_PRESSURE,
    MOST,
    NARROWEST,
    SMALLEST,
    Box,
    LimitReading,
    SearchRow,
    has,
    trial_values,
)
from core.find.offer import SearchRequest, StatedLimits, available_searches, search_request
from core.find.solution import ROOT_DIGITS, Judge, Judgement, Solution, out_of_bounds, search_with_findings
from core.find.trial import (
    PRESSURE_ANGLES,
    FindingsCheck,
    MachineOf,
    Outcome,
    TrialDesigns,
    nearest_accepted,
    same_design,
)
from core.motion.extremes import find_extremes
from core.number_text import result_text
from core.numerics.roots import EPS, BracketEnds, bounded_minimum, bracketed_root
from core.study import Study
from core.study.limits import ANY_PRESSURE, CONVEX, LIMITS
from core.study.machine_laws import with_fixed_laws

NEARER = 1e-3  # tolerance of a solution by samples, relative to the distance of two trial values
BEST = 1e-5  # the same where no value satisfies every limit
FINEST = 1e-9  # the same of a refined optimum
LAST = 1e-13  # tolerance of a refined root, relative to the value
CHECKED_AT = 1e-4  # distance at which an optimum is checked, relative to the distance of two trial values
NEXT_TO = 1e-3  # of the step to the next trial value: a design that does not exist there limits the search
EXCLUDED = 1e3  # [deg] merit of a design that violates a limit, more than any pressure angle
AT_LIMIT = 1e-6  # margin below which a limit determines the solution
SAME = 1e-9  # [deg] pressure angles that differ by less are equal
ALIKE = 1e-5  # [deg] the same for samples
OPTIMUM_DIGITS = 6  # the position of a flat minimum has half the digits of its value
BEST_DIGITS = 4  # of the best value by samples, where none satisfies every limit
CLOSE = 17  # values of the curve near the solution
BEYOND, LEAST_BEYOND = 0.5, 0.3  # margin of the curve: of the distance to the present value, at least of the solution
LAW_ROUNDS, SETTLED = (
    6,
    1e-9,
)  # of searches with the laws of the last solution; change of the result, relative to its size
OPEN_PRESSURE = 90.0  # [deg] no limit

At = Callable[[float], Outcome]
"""A value -> its outcome."""


def find(
    design: Design,
    what: str,
    stated: StatedLimits,
    *,
    choice: str = "",
    machine: MachineOf = same_design,
    notify: Callable[[int], object] = lambda count: None,
) -> Solution:
    """Solve a search of ``CAM_SEARCHES`` under the stated limits, else the design's own and the typical ones.

    The cam of a solution is not undercut, and the machine has no new finding. Where no value satisfies every limit: the
    best
    value, and the limits it violates.

    Parameters
    ----------
    design : Design
    what : str
        Key of ``CAM_SEARCHES``.
    stated : dict
        Key of a limit, or path of a field with _min or _max -> value; None removes the limit.
    choice : str
        Path of the varied field, where the search has a choice.
    machine : callable
        Design -> the machine that contains it.
    notify : callable
        Called with the number of evaluated designs after each of them.

    Returns
    -------
    Solution

    Raises
    ------
    KindynaError
        Where the search or a limit does not exist, or no value gives a cam.
    """
    if what not in CAM_SEARCHES:
        raise KindynaError(f"find {what!r}: unknown; allowed: {' | '.join(CAM_SEARCHES)}")

    def search(held: Design) -> Solution:
        return _find(held, what, stated, choice, machine, notify)

    motion = design.drive.motion
    return search(design) if motion is None or not motion.needs_machine else _with_laws(search, design)


def _with_laws(search: Callable[[Design], Solution], design: Design) -> Solution:
    """Solution of a search in a design whose laws are optimal in their machine.

    Every round keeps the laws of the last solution, which change little, until the result no longer changes.
    """
    typed, current = require_motion(design), design
    answer: Mapping[str, float] = {}
    for _ in range(LAW_ROUNDS):
        held = with_motion(design, require_motion(with_fixed_laws(current)))
        solution = search(held)
        if any(path.startswith("motion.") for path in solution.answer):
            return search(design)

        def with_typed(result: Design, held: Design = held) -> Design:
            drives = (
                replace(drive, motion=typed) if drive.motion == held.drive.motion else drive for drive in result.drives
            )
            return replace(result, drives=tuple(drives))

        current, before, answer = with_typed(solution.design), answer, solution.answer
        if all(abs(value - before.get(path, inf)) <= SETTLED * abs(value) for path, value in answer.items()):
            break
    complete = None if solution.complete is None else with_typed(solution.complete)
    return replace(solution, design=current, complete=complete)


def _find(
    design: Design,
    what: str,
    stated: StatedLimits,
    choice: str,
    machine: MachineOf,
    notify: Callable[[int], object],
) -> Solution:
    row = CAM_SEARCHES[what]
    if design.drive.cam is None:
        raise KindynaError(f"find {what}: this design has no cam; allowed: one with [cam]")
    if design.drive.has_surface and what not in (known := available_searches(design)):
        raise KindynaError(f"find {what}: this design has a cam in space; allowed: {' | '.join(known)}")
    request = search_request(design, what, stated, choice)
    paths = row.fields(design, request.bounds)
    _require(design, what, paths, request.bounds)
    if row.target == NARROWEST:
        return _narrowest_face(design, paths, request.bounds)
    study = Study(design)
    for key in stated:
        if key in request.limits and (lacking := LIMITS[key].missing(study)):
            raise KindynaError(f"limit {key}: this design has no such figure yet; give it {lacking}")
    request.limits.setdefault(CONVEX, 0.0)
    solver = _SOLVERS[len(paths), row.target]

    def search(checked: FindingsCheck) -> Solution:
        trials = TrialDesigns(design, paths, request.limits, notify, request.contact, checked, row.put)
        return replace(solver(row, trials, request), judge=_judge(row, trials, request))

    try:
        return search_with_findings(search, design, machine, request.waived)
    except KindynaError as error:
        _require_cam(design, what, error)
        raise


# -- requirements ------------------------------------------------------------------------------------------


def _require_cam(design: Design, what: str, cause: KindynaError) -> None:
    """Raise the reason where the search failed because the present design has no cam."""
    try:
        _ = Study(design).cam
    except NoSolution as error:
        problem = f"find {what} has no solution: the current design cannot be assembled: {error.problem}"
        raise type(error)(problem, error.field, error.hint, error.cam_angles) from cause


def _require(design: Design, what: str, paths: tuple[str, ...], box: Box) -> None:
    """Require that the design has the fields, and that the bounds are in order and of these fields."""
    if missing := [path for path in paths if not has(design, path)]:
        raise KindynaError(f"find {what}: this design has no {', '.join(missing)}")
    for path, (low, high) in box.items():
        if path not in paths:
            raise KindynaError(f"limit of {path}: {what} does not vary it; it varies {', '.join(paths)}")
        if low is not None and high is not None and low >= high:
            raise KindynaError(f"limit {path}_min = {low:g}: is not below {path}_max = {high:g}")


# -- smallest, largest -------------------------------------------------------------------------------------


def _outermost(row: SearchRow, trials: TrialDesigns, request: SearchRequest) -> Solution:
    """Smallest or largest value that satisfies every limit.

    A scan brackets the outermost valid value, and the root of the least margin is refined. Where the machine has new
    findings with this value, the next one without.
    """
    path = trials.paths[0]
    low, high = request.bounds.get(path, (None, None))
    values = trial_values(row.values(trials.design, path), low, high)
    order = values if row.target == SMALLEST else values[::-1]
    trials.scan((x,) for x in order.tolist())
    sampled = np.array([_or_least(trials.at(x, refined=False).margin) for x in order.tolist()])
    first = next((i for i in np.flatnonzero(sampled >= 0.0).tolist() if trials.at(float(order[i])).is_valid), None)
    if first is None:
        best = _best(trials, values)
        if not trials.at(best).is_valid:
            return _solution(row, trials, (best,), values, _edge_of_search(trials, best, values))
        first = int(np.searchsorted(values, best))  # between two trial values
        first = first if row.target == SMALLEST else values.size - first
        order = np.insert(order, first, best)
    end = ""
    solution = float(order[first])
    if first:
        solution = _valid_side(trials, float(order[first - 1]), solution)
        beyond_it = trials.at(float(order[first - 1])).problem if trials.at(solution).margin > AT_LIMIT else ""
        end = f"{path} = {solution:.9g} (beyond it: {beyond_it})" if beyond_it else ""
    else:
        bound = low if row.target == SMALLEST else high
        default_bound = request.default_bounds.get(f"{path}{ENDS[0] if row.target == SMALLEST else ENDS[1]}")
        why = f" ({default_bound.reason})" if default_bound else "" if bound is not None else ", the last trial value"
        end = f"{path} = {solution:.9g}{why}"
    if new := trials.new(solution):
        present = float(get(trials.design, path))
        others = (present,) if trials.checked.has_notes else (present, *order[first:].tolist())
        inward = order[-1] - solution
        good = next((x for x in others if (x - solution) * inward > 0.0 and trials.is_accepted(x)), None)
        if good is None:
            return _solution(row, trials, (solution,), values, violations=new)
        solution, beyond = nearest_accepted(
            lambda x, quick: trials.is_accepted(x, quick=quick), solution, good, trials.checked.tolerance
        )
        return _solution(row, trials, (solution,), values, next_findings=trials.new(beyond))
    return _solution(row, trials, (solution,), values, end)


def _or_least(margin: float) -> float:
    return margin if margin == margin else -np.inf


def _valid_side(trials: TrialDesigns, bad: float, good: float) -> float:
    """Valid value next to the root of the least margin, by samples first, then refined."""

    def margin(x: float, refined: bool) -> float:
        return trials.at(x, refined=refined).margin

    sampled = partial(margin, refined=False)
    near = bracketed_root(sampled, BracketEnds(bad, sampled(bad), good, sampled(good)), NEARER * abs(good - bad)).b
    bad = _towards(bad, near, lambda x: not margin(x, True) > 0.0)
    beyond = _towards(good, near, lambda x: margin(x, True) > 0.0)
    root = bracketed_root(
        partial(margin, refined=True),
        BracketEnds(bad, margin(bad, True), beyond, margin(beyond, True)),
        LAST * abs(beyond),
    )
    value, step = root.b, np.copysign(EPS * abs(root.b), good - root.a)
    while not trials.at(value).is_valid and (good - value) * step > 0.0:
        value, step = value + step, 2.0 * step
    return float(value)


def _edge_of_search(trials: TrialDesigns, best: float, values: np.ndarray) -> str:
    """Value next to which no design exists, and the reason; empty where there are designs on both sides."""
    if trials.at(best).problem:
        return ""
    sides = [float(side) for part in (values[values < best][-1:], values[values > best][:1]) for side in part]
    near = [best + NEXT_TO * (side - best) for side in sides]
    problem = next((problem for problem in (trials.at(x).problem for x in near) if problem), "")
    return f"{trials.paths[0]} = {best:.9g} (beyond it: {problem})" if problem else ""


def _towards(end: float, near: float, condition: Callable[[float], bool]) -> float:
    """First value that satisfies the condition, from ``near`` towards ``end`` in growing steps; else the end."""
    step = (end - near) * NEARER
    while not condition(near) and abs(end - near) > abs(step):
        near, step = near + step, 4.0 * step
    return near if condition(near) else end


def _best(trials: TrialDesigns, values: np.ndarray) -> float:
    """Value with the greatest least margin, where none is positive. Raises KindynaError where no value gives a cam."""
    margins = np.array([_or_least(trials.at(x, refined=False).margin) for x in values.tolist()])
    if not (margins > -np.inf).any():
        problem = trials.at(float(values[-1])).problem
        values_text = f"{trials.paths[0]} from {result_text(values[0])} to {result_text(values[-1])}"
        raise KindynaError(f"no value of {values_text} satisfies every limit: {problem}")
    top = int(np.argmax(margins))
    low, high = values[max(top - 1, 0)], values[min(top + 1, values.size - 1)]
    finest = BEST * float(high - low)
    best, _ = bounded_minimum(lambda x: -_or_least(trials.at(x, refined=False).margin), float(low), float(high), finest)
    return max((best, float(values[top])), key=lambda x: _or_least(trials.at(x).margin))


def _most(row: SearchRow, trials: TrialDesigns, request: SearchRequest) -> Solution:
    """Greatest of the trial values that satisfies every limit without a new finding."""
    values = row.values(trials.design, trials.paths[0])
    accepted = (value for value in values[::-1].tolist() if trials.is_accepted(value))
    best = next(accepted, None)
    if best is None:
        return _solution(row, trials, (float(get(trials.design, trials.paths[0])),), values)
    return _solution(row, trials, (best,), values)


# -- least pressure angle ----------------------------------------------------------------------------------


def _merit(outcome: Outcome) -> float:
    """Greatest pressure angle [deg]; above ``EXCLUDED`` by the violation of a limit; infinite without a cam."""
    if not outcome.readings:
        return np.inf
    return outcome.pressures[-1] if outcome.is_valid else EXCLUDED * (1.0 - outcome.margin)


def _least_pressure(row: SearchRow, trials: TrialDesigns, request: SearchRequest) -> Solution:
    """Value of least pressure angle that satisfies every limit."""
    path = trials.paths[0]
    values = trial_values(row.values(trials.design, path), *request.bounds.get(path, (None, None)))
    at = trials.at
    trials.scan((x,) for x in values.tolist())
    merits = np.array([_merit(at(x, refined=False)) for x in values.tolist()])
    _require_effect(trials, merits)
    if not (merits < EXCLUDED).any():
        return _solution(row, trials, (_best(trials, values),), values)
    top = int(np.argmin(merits))
    first, last = float(values[max(top - 1, 0)]), float(values[min(top + 1, values.size - 1)])
    best = _or_zero(optimum(partial(at, refined=True), partial(at, refined=False), first, last), last - first)
    points = [(x,) for x in values.tolist()]
    return _optimum_solution(row, trials, (best,), points, values, _end_text(path, best, values))


def _optimum_solution(
    row: SearchRow,
    trials: TrialDesigns,
    best: tuple[float, ...],
    points: Sequence[tuple[float, ...]],
    values: np.ndarray,
    end: str,
) -> Solution:
    """Solution at an optimum.

    Where the machine has new findings there, at the nearest point without, on the line to the present values, else to
    the best of the trial points.
    """
    new = trials.new(*best)
    if not new or not trials.at(*best).is_valid:
        return _solution(row, trials, best, values, end)
    present = tuple(float(get(trials.design, path)) for path in trials.paths)
    others = [] if trials.checked.has_notes else sorted(points, key=lambda p: _merit(trials.at(*p, refined=False)))
    good = next(
        (point for point in (present, *others) if _merit(trials.at(*point)) < EXCLUDED and trials.is_accepted(*point)),
        None,
    )
    if good is None:
        return _solution(row, trials, best, values, end, violations=new)

    def between(part: float) -> tuple[float, ...]:
        return tuple(a + part * (b - a) for a, b in zip(best, good, strict=True)) if part < 1.0 else good

    part, beyond = nearest_accepted(
        lambda part, quick: trials.is_accepted(*between(part), quick=quick), 0.0, 1.0, trials.checked.tolerance
    )
    return _solution(row, trials, between(part), values, next_findings=trials.new(*between(beyond)))


def _require_effect(trials: TrialDesigns, merits: np.ndarray) -> None:
    """Require that the pressure angle depends on the varied fields."""
    valid = merits[merits < EXCLUDED]
    if valid.size > 1 and np.ptp(valid) < SAME:
        raise KindynaError(
            f"the pressure angle of a {trials.design.drive.face.noun} does not depend on {', '.join(trials.paths)}"
        )


def _end_text(path: str, value: float, values: np.ndarray) -> str:
    """Text of a bound of the trial values, where the solution is there."""
    return f"{path} = {value:.9g}" if value in (values[0], values[-1]) else ""


def _or_zero(value: float, size: float) -> float:
    """Value, or 0 where it is rounding."""
    return 0.0 if abs(value) < FINEST * size else value


def optimum(at: At, rough: At, first: float, last: float) -> float:
    """Value from first to last with the least greatest pressure angle within every limit.

    The optimum is a flat minimum, a corner between two ranges of the motion with the same pressure angle, a limit, or
    an end
    of the values: each is searched in the bracket that the rough outcomes leave, and the best is checked on both sides.
    """
    width = last - first

    def merit(x: float) -> float:
        return _merit(at(x))

    near, least = bounded_minimum(lambda x: _merit(rough(x)), first, last, NEARER * width)
    near = min((x for x in (first, last) if _merit(rough(x)) <= least), key=lambda x: _merit(rough(x)), default=near)
    low, near = _downhill(merit, near, first, 2.0 * NEARER * width)
    high, near = _downhill(merit, near, last, 2.0 * NEARER * width)
    best = min((near, low, high, *_corners(at, low, near, high)), key=merit)
    neighbours = [x for x in (best - CHECKED_AT * width, best + CHECKED_AT * width) if first <= x <= last]
    if low < best < high and (best == near or any(merit(x) < merit(best) for x in neighbours)):
        flat, _ = bounded_minimum(merit, low, high, FINEST * width)
        best = min((best, flat), key=merit)
    return best


def _downhill(merit: Callable[[float], float], near: float, end: float, step: float) -> tuple[float, float]:
    """Walk from ``near`` towards ``end`` in growing steps while the merit falls.

    Returns the first value that is no better, or the end, and the best value before it.
    """
    low = near
    while low != end:
        low = max(low - step, end) if end < near else min(low + step, end)
        if merit(low) >= merit(near):
            break
        near, step = low, 2.0 * step
    return low, near


def _corners(at: At, low: float, near: float, high: float) -> list[float]:
    """Values between three others at which rise and return have the same pressure angle, or a limit is reached."""
    corners = []

    def difference(x: float) -> float:
        outcome = at(x)
        return outcome.pressures[0] - outcome.pressures[1] if outcome.pressures else np.nan

    def margin(x: float) -> float:
        return at(x).margin

    for a, b in ((low, near), (high, near)):
        if a == b:
            continue
        if at(a).is_valid != at(b).is_valid:
            good, bad = (a, b) if at(a).is_valid else (b, a)
            root = bracketed_root(margin, BracketEnds(bad, margin(bad), good, margin(good)), LAST * abs(good - bad))
            corners.append(root.b)
        elif difference(a) * difference(b) < 0.0:
            ends = BracketEnds(a, difference(a), b, difference(b))
            root = bracketed_root(difference, ends, LAST * max(abs(a), abs(b)))
            corners += [root.a, root.b]
    return corners


def _least_pressure_of_two(row: SearchRow, trials: TrialDesigns, request: SearchRequest) -> Solution:
    """Values of two fields with the least pressure angle: for each second value the best first value."""
    first, second = (
        trial_values(row.values(trials.design, path), *request.bounds.get(path, (None, None)), (9,))
        for path in trials.paths
    )
    points = [(x, y) for x in first.tolist() for y in second.tolist()]
    trials.scan(points)
    merits = np.array([_merit(trials.at(*point, refined=False)) for point in points]).reshape(first.size, -1).T
    _require_effect(trials, merits)
    if not np.isfinite(merits).any():
        problem = trials.at(float(first[0]), float(second[0])).problem
        raise KindynaError(f"no pivot in the box satisfies every limit: {problem}")

    def best_at(y: float, refined: bool, low: float, high: float) -> float:
        exact, rough = (partial(lambda x, how: trials.at(x, y, refined=how), how=how) for how in (refined, False))
        return optimum(exact, rough, low, high)

    def along(y: float, refined: bool) -> tuple[float, float]:
        """Merit of the best first value, and this value."""
        x = best_at(y, refined, *_bracket(first, line[-1], refined))
        line.append(x)
        return _merit(trials.at(x, y, refined=refined)), x

    j, i = divmod(int(np.argmin(merits)), first.size)
    line = [float(first[i])]
    low, high = float(second[max(j - 1, 0)]), float(second[min(j + 1, second.size - 1)])
    y, least = bounded_minimum(lambda y: along(y, False)[0], low, high, NEARER * (high - low))
    y = min((end for end in (low, high) if along(end, False)[0] <= least), default=y)
    present = get(trials.design, trials.paths[1])
    if second[0] <= present <= second[-1] and along(present, False)[0] <= least + ALIKE:
        y = present  # only the distance of a pivot from the cam centre counts
    y = _vertex(lambda y: along(y, True)[0], y, float(second[0]), float(second[-1]))
    x = along(y, True)[1]
    ends_text = [text for text in (_end_text(trials.paths[0], x, first), _end_text(trials.paths[1], y, second)) if text]
    return _optimum_solution(row, trials, (x, y), points, first, " and ".join(ends_text))


def _bracket(values: np.ndarray, near: float, refined: bool) -> tuple[float, float]:
    """Bracket about a value: to the next trial values, or to a tenth of that after the search by samples."""
    step = float(values[1] - values[0]) * (0.1 if refined else 1.0)
    return max(near - step, float(values[0])), min(near + step, float(values[-1]))


def _vertex(value: Callable[[float], float], near: float, low: float, high: float) -> float:
    """Position of the minimum of a function near a point found by samples.

    It is the vertex of the parabola through the point and its neighbours, which move as long as one of them is better.
    """
    step = 0.005 * (high - low)
    known = {near: value(near)}
    while step > FINEST * (high - low):
        points = [min(max(near + shift, low), high) for shift in (-step, 0.0, step)]
        known |= {point: value(point) for point in points if point not in known}
        left, middle, right = (known[point] for point in points)
        same = SAME * max(1.0, abs(middle))  # the merit of an invalid design is larger by far
        if points[0] < points[1] < points[2] and middle <= min(left, right) + same:
            curvature = left - 2.0 * middle + right
            vertex = near + 0.5 * step * (left - right) / curvature if curvature > same else near
            known |= {vertex: value(vertex)}
            return min((near, vertex), key=known.__getitem__)
        better = min(points, key=known.__getitem__)
        near, step = (better, 2.0 * step) if better != near else (near, 0.25 * step)
    return near


# -- flat face ---------------------------------------------------------------------------------------------


def _narrowest_face(design: Design, paths: tuple[str, ...], box: Box) -> Solution:
    """Narrowest face that contains the range of the contact, centred on it as far as the bounds allow."""
    study = Study(design)
    if not design.drive.face.straight:
        raise KindynaError(f"find face-width: a {design.drive.face.noun} has no width; allowed: a flat face")
    contact = find_extremes(lambda angles: {"": study.at(angles).cam.flank.on_face}, study.program)[""]
    span = (1e3 * contact.low.value, 1e3 * contact.high.value)
    (half_low, half_high), (low, high) = (box.get(path, (None, None)) for path in paths)

    def needed(centre: float) -> float:
        return max(abs(end - centre) for end in span)

    middle = _or_zero(0.5 * (span[0] + span[1]), span[1] - span[0])
    centre = max(middle if high is None else min(middle, high), -np.inf if low is None else low)
    half = max(needed(centre), half_low or 0.0)
    violations: tuple[str, ...] = ()
    if half_high is not None and half > half_high:
        violations = (
            f"the contact runs from {result_text(span[0])} to {result_text(span[1])} mm: half a width of {result_text(half, 6)} mm, "
            f"limit {half_high:g} mm",
        )
    values = dict(zip(paths, (half, centre), strict=True))
    trials = TrialDesigns(design, paths, {})
    reached = {"contact_on_face_min_mm": span[0], "contact_on_face_max_mm": span[1]}

    def at(values: Mapping[str, float]) -> Judgement:
        half, centre = (values[path] for path in paths)
        narrow = () if half >= needed(centre) else (f"half a width of {result_text(needed(centre), 6)} mm is needed",)
        texts = (*out_of_bounds(values, box), *narrow)
        return Judgement(trials.with_values((half, centre)), values, reached, texts)

    centres = np.linspace(span[0], span[1], 49).tolist()
    present = {path: get(design, path) for path in paths}
    widest = max(needed(centres[0]), half, present[paths[0]] or 0.0)
    return Solution(
        NARROWEST,
        trials.with_values((half, centre)),
        values,
        reached,
        {},
        tuple((needed(at), at) for at in centres),
        paths[1],
        (0.0, widest),
        present,
        {},
        violations,
        judge=Judge(paths, at),
    )


# -- the solution ------------------------------------------------------------------------------------------


def _solution(
    row: SearchRow,
    trials: TrialDesigns,
    point: tuple[float, ...],
    values: np.ndarray,
    end: str = "",
    next_findings: tuple[str, ...] = (),
    violations: tuple[str, ...] = (),
) -> Solution:
    """Solution with these values of the fields, its readings and its curve."""
    outcome = trials.at(*point)
    readings = (*outcome.readings, *(trials.forces(*point) if outcome.readings else ()))
    design, answer, reached = _values(row, trials, point)
    shown = ANY_PRESSURE if row.target == LEAST_PRESSURE else outcome.readings[0].key
    present = {path: get(trials.design, path) for path in answer}
    near = _near(point[0], present[trials.paths[0]], values)
    curve = []
    shown_at = sorted({*values.tolist(), *np.linspace(*near, CLOSE).tolist(), point[0]})
    trials.scan((x, *point[1:]) for x in shown_at if x != point[0])
    for x in shown_at:
        trial = trials.at(x, *point[1:], refined=x == point[0])
        if trial.readings:
            curve.append((x, _shown(trial, shown)))
    violations = (*(reading.text for reading in outcome.readings if not reading.is_satisfied), *violations)
    digits = OPTIMUM_DIGITS if row.target == LEAST_PRESSURE else ROOT_DIGITS
    if violations or (next_findings and trials.checked.has_notes):
        digits = BEST_DIGITS
    return Solution(
        row.target,
        design,
        answer,
        reached,
        {reading.key: reading.limit for reading in readings},
        tuple(curve),
        shown,
        near,
        present,
        _reached_before(trials),
        violations,
        end,
        digits,
        {reading.key: reading.reason for reading in readings if reading.reason},
        next_findings,
    )


def _values(
    row: SearchRow, trials: TrialDesigns, point: tuple[float, ...]
) -> tuple[Design, dict[str, float], dict[str, float]]:
    """The design with these values of the fields, all fields that change, and the values reached of the limits."""
    outcome, design = trials.at(*point), trials.with_values(point)
    readings = (*outcome.readings, *(trials.forces(*point) if outcome.readings else ()))
    reached = outcome.reached(row.target == LEAST_PRESSURE) | {reading.key: reading.reached for reading in readings}
    if readings and (row.target == LEAST_PRESSURE or outcome.readings[0].key in PRESSURE_ANGLES):
        reached.setdefault(ANY_PRESSURE, outcome.pressures[-1])
    return design, {**dict(zip(trials.paths, point, strict=True)), **row.also_changed(design, trials.paths[0])}, reached


def _judge(row: SearchRow, trials: TrialDesigns, request: SearchRequest) -> Judge:
    """Judgement of values of the fields by the limits and bounds of the search."""

    def at(values: Mapping[str, float]) -> Judgement:
        point = tuple(values[path] for path in trials.paths)
        outcome = trials.at(*point)
        if not outcome.readings:
            return Judgement(trials.design, values, {}, (outcome.problem,))
        texts = (*out_of_bounds(values, request.bounds), *(r.text for r in outcome.readings if not r.is_satisfied))
        return Judgement(*_values(row, trials, point), texts or trials.new(*point))

    return Judge(trials.paths, at)


def _near(value: float, present: float, values: np.ndarray) -> tuple[float, float]:
    """Range of the solution and the present value with a margin on both sides, within the trial values."""
    margin = max(BEYOND * abs(value - present), min(LEAST_BEYOND * abs(value), LEAST_BEYOND * float(np.ptp(values))))
    low = max(min(value, present) - margin, float(values[0]))
    high = min(max(value, present) + margin, float(values[-1]))
    return min(low, value), max(high, value)


def _reached_before(trials: TrialDesigns) -> Mapping[str, float]:
    """Values that the present design reaches of every limit of the cam's shape, and of the stated limits of forces."""
    open_limits = {key: OPEN_PRESSURE if row.is_upper else 0.0 for key, row in LIMITS.items() if not row.needs_forces}
    present = TrialDesigns(trials.design, (), open_limits | trials.limits, contact=trials.contact)
    readings = present.at().readings
    return {reading.key: reading.reached for reading in (*readings, *(present.forces() if readings else ()))}


def _shown(outcome: Outcome, key: str) -> float:
    """Value reached of a limit, or the pressure angle; NaN where a limit does not apply."""
    readings: dict[str, LimitReading] = {reading.key: reading for reading in outcome.readings}
    return (
        readings[key].reached
        if key in readings
        else outcome.pressures[PRESSURE_ANGLES.index(key)]
        if key in PRESSURE_ANGLES
        else np.nan
    )


_SOLVERS: Mapping[tuple[int, str], Callable[[SearchRow, TrialDesigns, SearchRequest], Solution]] = {
    (1, SMALLEST): _outermost,
    (1, LARGEST): _outermost,
    (1, MOST): _most,
    (1, LEAST_PRESSURE): _least_pressure,
    (2, LEAST_PRESSURE): _least_pressure_of_two,
}
"""By the number of varied fields and the target."""
