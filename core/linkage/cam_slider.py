"""The cam-driven slider: roller arm and slider arm on one pivot, rod, slider on a guide (Shin1995 §2)."""

from __future__ import annotations

import math

import numpy as np

from core.design import SI, CamSlider, si
from core.errors import NoAssembly, angle_ranges
from core.linkage.base import BasePosition, base_position
from core.linkage.rod_and_arm import RodAndArm, rod_and_arm
from core.motion import MotionState
from core.train import FRAME, REVOLUTE, SLIDING, Dyad, Pair, Pose, Train
from core.vectors import turning, unit


def cam_slider_train(follower: CamSlider, reach: float, motion: MotionState) -> Train:
    """Positions and three derivatives of the whole train; reach = Br + Rr [m].

    Raises NoAssembly, naming the cam angles, where arm and rod do not reach the slider or lie in line.
    """
    g = si(follower)
    base = base_position(follower, reach)
    solved = rod_and_arm(g, base, motion.y)
    _require_triangle(g, solved, motion)
    return _assemble(g, base, motion, solved)


def _require_triangle(g: SI, solved: RodAndArm, motion: MotionState) -> None:
    bad = ~(solved.area > 0.0)
    if not bad.any():
        return
    where = angle_ranges(motion.theta, bad)
    if np.isnan(solved.area[bad]).any():
        r = np.hypot(solved.slider[bad], g.guide_height) * 1e3
        low, high = abs(g.slider_arm - g.rod) * 1e3, (g.slider_arm + g.rod) * 1e3
        worst = r.max() if r.max() > high else r.min()
        raise NoAssembly(
            f"slider arm and rod cannot reach the slider, which comes to {worst:.9g} mm from the pivot,",
            "follower.rod_mm",
            f"that distance must stay within {low:.9g} ... {high:.9g} mm: change the lengths or the stroke",
            where,
        )
    raise NoAssembly(
        "rod and slider arm lie in line (dead centre): the slider cannot drive the arm",
        "follower.rod_mm",
        "change the lengths or the stroke",
        where,
    )


def _assemble(g: SI, base: BasePosition, motion: MotionState, solved: RodAndArm) -> Train:
    slider, phi, beta, n = solved.slider, solved.phi, solved.beta, motion.theta.size
    pivot, along = complex(g.pivot_x, g.pivot_y), np.exp(1j * g.guide_angle)
    still = np.zeros((4, n), dtype=complex)
    still[0] = pivot
    arm_angle, rod_angle, roller_angle = phi.copy(), beta.copy(), phi.copy()
    arm_angle[0] += g.guide_angle
    rod_angle[0] += g.guide_angle
    roller_angle[0] += g.fixed_angle + g.guide_angle
    pin = turning(g.slider_arm * unit(arm_angle[0]), arm_angle)
    pin[0] += pivot
    roller = turning(g.roller_arm * unit(roller_angle[0]), roller_angle)
    travel = 1j * roller[0] / g.roller_arm
    roller[0] += pivot
    place = motion.y * along
    place[0] = pivot + (slider + 1j * g.guide_height) * along
    guide_angle = np.zeros((4, n))
    guide_angle[0] = g.guide_angle
    bodies = {
        "arm": Pose(
            still,
            arm_angle,
            {"pivot": 0j, "arm_pin": complex(g.slider_arm), "roller": _polar(g.roller_arm, g.fixed_angle)},
        ),
        "rod": Pose(pin, rod_angle, {"arm_pin": 0j, "slider_pin": complex(g.rod)}),
        "slider": Pose(place, guide_angle, {"slider_pin": 0j}),
        "roller": Pose(roller, roller_angle, {"roller": 0j}),
    }
    pairs = {
        "pivot": Pair(REVOLUTE, FRAME, "arm", "pivot"),
        "arm_pin": Pair(REVOLUTE, "arm", "rod", "arm_pin"),
        "slider_pin": Pair(REVOLUTE, "rod", "slider", "slider_pin"),
        "guide": Pair(SLIDING, FRAME, "slider", "slider_pin", complex(along)),
    }
    size = g.slider_arm + g.rod + abs(g.guide_height)
    return Train(
        motion=motion,
        bodies=bodies,
        pairs=pairs,
        dyads=(Dyad("RRP", ("rod", "slider"), ("arm_pin", "slider_pin", "guide")),),
        output="slider",
        follower_body="roller",
        ground="pivot",
        travel=travel,
        coordinates={"slider_position": _shifted(motion.y, slider), "phi": phi, "beta": beta},
        base={
            "slider": (base.slider, "mm"),
            "phi": (base.phi, "deg"),
            "alpha": (base.alpha, "deg"),
            "beta": (base.beta, "deg"),
        },
        residual=np.abs(bodies["rod"].point("slider_pin")[0] - place[0]) / size,
        condition=4.0 * (1.0 + (solved.square + g.slider_arm**2 + g.rod**2) / solved.area),
        singular={
            "dead-centre": solved.area / (2.0 * g.slider_arm * g.rod),
            "rod-across-guide": np.abs(np.cos(beta[0])),
        },
    )


def _polar(radius: float, angle: float) -> complex:
    return complex(radius * math.cos(angle), radius * math.sin(angle))


def _shifted(y: np.ndarray, value: np.ndarray) -> np.ndarray:
    out = y.copy()
    out[0] = value
    return out
