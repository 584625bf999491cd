"""What kind of four-bar it is (Grashof)."""

from __future__ import annotations

from core.frozen import frozen
from core.mechanism.plan import SolutionPlan

CHANGE = 1e-12  # relative: shortest + longest this near to the sum of the others is equality


@frozen
class FourBar:
    """Ground, crank (the driver), coupler and rocker lengths [m]; kind as a designer says it."""

    ground: float
    crank: float
    coupler: float
    rocker: float
    kind: str


_BY_SHORTEST = {"ground": "double crank", "crank": "crank-rocker", "coupler": "double rocker", "rocker": "rocker-crank"}


def four_bar(plan: SolutionPlan) -> FourBar | None:
    """The four-bar of the driver and a dyad RRR on it and the frame; None where the linkage holds none.

    Grashof: shortest + longest < the other two: the shortest link turns fully against its neighbours.
    """
    for step, joints in plan.steps:
        ends = (
            {joints[0].first.link: (joints[0], 0), joints[2].first.link: (joints[2], 1)} if step.kind == "RRR" else {}
        )
        driver = plan.driver
        if set(ends) != {driver.first.link, driver.second.link} or not driver.revolute:
            continue
        (on_frame, frame_side), (on_crank, _) = ends[driver.first.link], ends[driver.second.link]
        inner = joints[1]
        rods = (
            abs(inner.first.point - joints[0].second.point),
            abs(inner.second.point - joints[2].second.point),
        )
        lengths = {
            "ground": abs(on_frame.first.point - driver.first.point),
            "crank": abs(on_crank.first.point - driver.second.point),
            "coupler": rods[1 - frame_side],
            "rocker": rods[frame_side],
        }
        return FourBar(**lengths, kind=_kind(lengths))
    return None


def _kind(lengths: dict[str, float]) -> str:
    short, *others, long = sorted(lengths.values())
    surplus = short + long - sum(others)
    if abs(surplus) <= CHANGE * long:
        return "change point"
    if surplus > 0.0:
        return "triple rocker"
    return _BY_SHORTEST[next(name for name, length in lengths.items() if length == short)]
