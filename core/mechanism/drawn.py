"""A linkage as it is drawn: where the driver stands there, which assembly is nearest, and the same told by signs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import degrees, inf, radians

import numpy as np

from core.design import FRAME_LINK, Drawn, Linkage, LinkPoint
from core.design.topology import SolutionStep, driver_turns, is_pin
from core.errors import NoPosition
from core.mechanism.change_points import Branch
from core.mechanism.kinematics import Pose
from core.mechanism.plan import SolutionPlan
from core.mechanism.solving import at_driver, solve

_MM = 1e-3
_TIE = 1e-9  # of the size: assemblies that miss what is drawn by as much
_DIGITS = 6  # of a millimetre, and of a degree, that are drawn


def drawn_place(drawn: Drawn) -> float:
    """Where the driver stands in the drawn pose [rad or m]."""
    if drawn.driver_mm is not None:
        return drawn.driver_mm * _MM
    return radians(drawn.driver_deg or 0.0)


def as_drawn(linkage: Linkage, place: float, poses: Mapping[int, Pose]) -> Linkage:
    """The linkage with what stands in these poses (n = 1) as drawn, instead of its signs; place: of its driver [rad or m]."""
    drawn: dict[str, LinkPoint] = {}
    for link in linkage.links:
        for name, at in link.places.items() if link.number != FRAME_LINK else ():
            z = complex(poses[link.number].carried(at * _MM)[0][0]) / _MM
            drawn.setdefault(name, LinkPoint(name, round(z.real, _DIGITS) + 0.0, round(z.imag, _DIGITS) + 0.0))
    fixed = linkage.by_number[FRAME_LINK].places
    points = tuple(point for name, point in drawn.items() if name not in fixed)
    if driver_turns(linkage):
        return replace(linkage, branch=(), drawn=Drawn(round(degrees(place), _DIGITS) + 0.0, None, points))
    return replace(linkage, branch=(), drawn=Drawn(None, round(place / _MM, _DIGITS) + 0.0, points))


def misses(plan: SolutionPlan, poses: Mapping[int, Pose], links: Iterable[int]) -> np.ndarray:
    """How far the drawn points of these links are from where they stand in the poses (n,) [m]: root of the sum of squares."""
    assert plan.linkage.drawn is not None
    places = plan.linkage.drawn.places
    squares = [
        np.abs(poses[link].carried(at)[0] - places[name] * _MM) ** 2
        for link in links
        for name, at in plan.points[link].items()
        if name in places
    ]
    return np.sqrt(sum(squares, np.zeros(1)))


def choose_side(plan: SolutionPlan, index: int, branch: Branch, place: float) -> None:
    """Let the dyad be assembled as is nearest to what is drawn, with the driver at ``place``. Raises NoPosition where both ways are as
    near."""
    step, _ = plan.steps[index]
    missed = []
    for side in (1.0, -1.0):
        branch.chosen[index] = (side, place)
        poses = solve(plan, at_driver(np.array([place])), branch, index + 1).poses
        missed.append(float(misses(plan, poses, step.links)[0]))
    if abs(missed[0] - missed[1]) <= _TIE * plan.size:
        raise _tie(step)
    branch.chosen[index] = (1.0 if missed[0] < missed[1] else -1.0, place)


def nearest(plan: SolutionPlan, step: SolutionStep, poses: Mapping[int, Pose]) -> int:
    """Which of the assemblies (n,) of a group is nearest to what is drawn. Raises NoPosition where two are as near."""
    missed = misses(plan, poses, step.links)
    order = np.argsort(missed)
    apart = inf if order.size < 2 else missed[order[1]] - missed[order[0]]
    if apart <= _TIE * plan.size:
        raise _tie(step)
    return int(order[0])


def _tie(step: SolutionStep) -> NoPosition:
    links = ", ".join(map(str, step.links))
    where = f" at {step.joint}" if len(step.links) == 2 and is_pin(step.joint) else ""
    return NoPosition(
        f"two ways to assemble links {links}{where} are as near to what is drawn",
        "linkage.drawn",
        "draw a point of theirs that tells them apart, or another position of the driver",
    )
