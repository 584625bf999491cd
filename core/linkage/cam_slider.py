"""The cam-driven slider: roller arm and slider arm on one pivot, rod, slider on a guide (Shin1995 §2)."""

from __future__ import annotations

import cmath
import math

import numpy as np

from core.derivatives import Derivatives, standing, turning
from core.design import SI, CamSlider, si
from core.errors import NoAssembly, angle_ranges
from core.linkage.base import BasePosition, base_position
from core.linkage.rod_and_arm import RodAndArm, rod_and_arm
from core.motion import MotionState
from core.train import FRAME, REVOLUTE, SLIDING, Dyad, Pair, Pose, Train
from core.vectors import unit


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
    slider, n = solved.slider, motion.theta.size
    pivot, along = complex(g.pivot_x, g.pivot_y), cmath.exp(1j * g.guide_angle)
    arm, rod = solved.arm * along, solved.rod * along
    ahead = cmath.exp(1j * g.fixed_angle)
    roller = arm * ahead
    swing = turning(arm, solved.phi)
    pin, centre = complex(g.slider_arm), _polar(g.roller_arm, g.fixed_angle)

    def carried(place: complex) -> Derivatives:
        """A point of the arm."""
        return Derivatives(lambda order: place * swing[order] if order else pivot + place * arm)

    def place() -> np.ndarray:
        return pivot + (slider + 1j * g.guide_height) * along

    fixed = standing(pivot).spread(n)
    bodies = {
        "arm": Pose(fixed, _ahead(solved.phi, g.guide_angle), {"pivot": 0j, "arm_pin": pin, "roller": centre}, arm),
        "rod": Pose(carried(pin), _ahead(solved.beta, g.guide_angle), {"arm_pin": 0j, "slider_pin": complex(g.rod)}, rod),
        "slider": Pose(
            Derivatives(lambda order: motion.y[order] * along if order else place()),
            standing(g.guide_angle).spread(n),
            {"slider_pin": 0j},
        ),
        "roller": Pose(
            carried(g.roller_arm * ahead), _ahead(solved.phi, g.fixed_angle + g.guide_angle), {"roller": 0j}, roller
        ),
    }
    pairs = {
        "pivot": Pair(REVOLUTE, FRAME, "arm", "pivot"),
        "arm_pin": Pair(REVOLUTE, "arm", "rod", "arm_pin"),
        "slider_pin": Pair(REVOLUTE, "rod", "slider", "slider_pin"),
        "guide": Pair(SLIDING, FRAME, "slider", "slider_pin", along),
    }

    def closure() -> np.ndarray:
        """By the angles, as they stand in tables: the triangle's own vectors close by themselves."""
        pin = pivot + g.slider_arm * unit(bodies["arm"].turn[0])
        size = g.slider_arm + g.rod + abs(g.guide_height)
        return np.abs(pin + g.rod * unit(bodies["rod"].turn[0]) - place()) / size

    return Train(
        motion=motion,
        bodies=bodies,
        pairs=pairs,
        dyads=(Dyad("RRP", ("rod", "slider"), ("arm_pin", "slider_pin", "guide")),),
        output="slider",
        follower_body="roller",
        ground="pivot",
        travel=lambda: 1j * roller,
        coordinates=lambda: {
            "slider_position": np.vstack([slider, motion.y[1:]]), "phi": solved.phi.all, "beta": solved.beta.all
        },
        base={
            "slider": (base.slider, "mm"),
            "phi": (base.phi, "deg"),
            "alpha": (base.alpha, "deg"),
            "beta": (base.beta, "deg"),
        },
        residual=closure,
        condition=lambda: 4.0 * (1.0 + (solved.square + g.slider_arm**2 + g.rod**2) / solved.area),
        singular=lambda: {
            "dead-centre": solved.area / (2.0 * g.slider_arm * g.rod),
            "rod-across-guide": np.abs(solved.rod.real),
        },
    )


def _ahead(angle: Derivatives, by: float) -> Derivatives:
    """An angle that is ahead by a fixed one."""
    return Derivatives(lambda order: angle[order] if order else angle[0] + by)


def _polar(radius: float, angle: float) -> complex:
    return complex(radius * math.cos(angle), radius * math.sin(angle))
