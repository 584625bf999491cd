"""Arm and rod between a pivot and a slider at any place, solved as the mechanism they are."""

import numpy as np

from core.design import Driver, Link, Linkage, LinkPoint, Side, Slider
from core.mechanism import Mechanism, Names, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, MotionState
from core.numerics.derivatives import Derivatives

MM = 1e-3


def metres(length: float) -> float:
    """A length [m] as it is once it has been typed in mm."""
    return float(round(length * 1e3, 9) * MM)


def arm_and_rod(
    l1: float,
    l2: float,
    height: float,
    slider: float,
    side: float,
    phi: float,
    beta: float,
    rates: tuple[float, ...] = (1.0,),
) -> Kinematics:
    """Lengths [m], as ``metres`` gives them; the slider at ``slider`` [m] with its rates; angles [rad] that tell the whole
    turns. Coordinates ``phi`` and ``beta``."""
    linkage = Linkage(
        (
            Link(1, (LinkPoint("pivot", 0.0, 0.0),)),
            Link(2, (LinkPoint("pivot", 0.0, 0.0), LinkPoint("pin", round(l1 * 1e3, 9), 0.0))),
            Link(3, (LinkPoint("pin", 0.0, 0.0), LinkPoint("end", round(l2 * 1e3, 9), 0.0))),
            Link(4, (LinkPoint("end", 0.0, 0.0),)),
        ),
        (Slider(link=4, on=1, through_y_mm=round(height * 1e3, 9)),),
        Driver(4, "motion"),
        (Side("pin", round(side)),),
    )
    y = np.zeros((4, 1))
    y[1 : 1 + len(rates), 0] = rates
    mechanism = Mechanism(
        linkage,
        Names({2: "arm", 3: "rod", 4: "slider"}, coordinates={"phi": 2, "beta": 3}),
        start=slider,
        angles={2: phi, 3: beta},
    )
    angles = Angles(np.zeros(1), np.zeros(1, dtype=int))
    return solve_mechanism(mechanism, MotionState(angles, Derivatives.of(y), np.ones(1)))
