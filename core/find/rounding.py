"""Results of searches as numbers that can be made: multiples of a step, with which every limit still holds."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from itertools import islice
from typing import Generic, NamedTuple, TypeVar

from core.design import Design, entry_at
from core.errors import KindynaError
from core.find.solution import Solution
from core.number_text import input_text, rounded_up
from core.study import Study, extremes_of
from core.units import split_unit

STEPS = {"mm": 0.1, "°": 0.1}  # by the unit of the field
DIGITS = 3  # of fields in other units
FINER = 3  # times a tenth of the step
MOST_TRIALS = 64  # of one step: of six numbers all that are rounded up or down
TORQUE = "drive_torque_nm"
NO_ROUNDING = "no rounded values satisfy every limit, so that the exact ones are used"

Result = TypeVar("Result")


class RoundedValues(NamedTuple, Generic[Result]):
    """Rounded values and their steps by their paths, and the result with them."""

    values: Mapping[str, float]
    steps: Mapping[str, float]
    result: Result


def step_of(path: str, value: float) -> float:
    """Step of a field: 0.1 mm, 0.1 deg, else the third significant digit of its value."""
    symbol = split_unit(path)[1].symbol
    return STEPS.get(symbol) or (float(f"1e{math.floor(math.log10(abs(value))) + 1 - DIGITS}") if value else 1.0)


def finer_step_text(path: str, exact: float, step: float, requested: float = 0.0) -> str:
    """Sentence about a value on multiples of a step that is finer than the requested one; empty where it is not.

    ``requested`` 0: the field's own step.
    """
    most = requested or step_of(path, exact)
    return (
        f"no multiple of {input_text(most)} satisfies every limit, so that it is one of {input_text(step)}"
        if step < most
        else ""
    )


def rounded_values(
    exact: Mapping[str, float], judged: Callable[[Mapping[str, float]], Result | None], step: float = 0.0
) -> RoundedValues[Result] | None:
    """Nearest multiples of the steps with which every limit holds, all numbers together; None where there are none.

    A step is divided by 10, up to three times, where none of its multiples next to the exact values satisfies the limits.

    Parameters
    ----------
    exact : dict
        Path -> exact value.
    judged : callable
        Values by their paths -> the result with them, None where a limit or the range of a field is violated. It may
        raise KindynaError.
    step : float
        Step of all values, each in its unit; 0: that of each field.
    """
    for tenths in range(FINER + 1):
        steps = {path: Decimal(repr(step or step_of(path, x))).scaleb(-tenths) for path, x in exact.items()}
        for values in islice(_multiples(exact, steps), MOST_TRIALS):
            try:
                result = judged(values)
            except KindynaError:
                continue
            if result is not None:
                return RoundedValues(values, {path: float(size) for path, size in steps.items()}, result)
    return None


def _multiples(exact: Mapping[str, float], steps: Mapping[str, Decimal]) -> Iterator[Mapping[str, float]]:
    """Multiples of the steps below and above the exact values in all combinations, the nearest first."""
    nearest, others = {}, []
    for path, value in exact.items():
        parts = Decimal(repr(float(value))) / steps[path]
        sides = {parts.to_integral_value(rounding) for rounding in (ROUND_FLOOR, ROUND_CEILING)}
        near, *far = sorted((abs(side - parts), float(side * steps[path]) + 0.0) for side in sides)
        nearest[path] = near[1]
        others += [(distance**2 - near[0] ** 2, path, end) for distance, end in far]
    others.sort()
    yield nearest
    heap = [(others[0][0], [0])] if others else []
    while heap:
        more, turned = heapq.heappop(heap)
        yield nearest | {others[k][1]: others[k][2] for k in turned}
        *before, last = turned
        if last + 1 < len(others):
            heapq.heappush(heap, (more + others[last + 1][0], [*turned, last + 1]))
            heapq.heappush(heap, (more + others[last + 1][0] - others[last][0], [*before, last + 1]))


def rounded(solution: Solution, step: float = 0.0) -> Solution:
    """Return the solution with rounded values, judged again, and their cost; with a note where none satisfies the limits."""
    if not solution.is_valid or solution.judge is None:
        return solution
    paths, at = solution.judge
    exact = {path: solution.answer[path] for path in paths}

    fields = {path: entry_at(solution.design, path) for path in exact}

    def judged(values: Mapping[str, float]) -> tuple[Design, Mapping[str, float], Mapping[str, float]] | None:
        if not all(field is None or field.info.admits(values[path]) for path, field in fields.items()):
            return None
        design, answer, reached, violations = at(values)
        return None if violations else (design, answer, reached)

    taken = rounded_values(exact, judged, step)
    if taken is None:
        return replace(solution, exact=exact, notes=(*solution.notes, NO_ROUNDING))
    design, answer, reached = taken.result
    return replace(
        solution,
        design=design,
        answer=answer,
        reached={**solution.reached, **reached},
        applied={path: value for path, value in taken.values.items() if path in solution.applied},
        exact=exact,
        rounding=taken.steps,
        cost=_cost(solution, design, reached),
    )


def _cost(solution: Solution, design: Design, reached: Mapping[str, float]) -> Mapping[str, tuple[float, float]]:
    """Values reached of the limits, and the largest torque of the cam, with the exact and with the rounded result."""
    cost = {key: (value, reached[key]) for key, value in solution.reached.items() if key in reached}
    torques = [cam_torque(made) for made in (solution.design, design)]
    if all(math.isfinite(torque) for torque in torques):
        cost[TORQUE] = (torques[0], torques[1])
    return cost


def cam_torque(design: Design) -> float:
    """Largest torque of the cam [N m]; NaN where the design has none, or several drives."""
    study = Study(design)
    if len(design.drives) > 1 or "dynamics" not in study.stages:
        return math.nan
    try:
        ends = extremes_of(study, "dynamics", ("drive_torque",)).get("drive_torque")
    except KindynaError:
        return math.nan
    return math.nan if ends is None else max(abs(ends.low.value), abs(ends.high.value))


def rounded_flywheel(inertia: float) -> float:
    """Inertia [kg m²] of a flywheel that a result makes necessary, rounded up."""
    return rounded_up(inertia, DIGITS)
