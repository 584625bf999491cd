"""What a drawing of a cam states in figures: its radii and their places, the points of its profile, its dimensions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from core.cam import OUTER, form_row
from core.frozen import frozen
from core.motion import Angles, degrees
from core.motion.extremes import Extreme, find_extremes
from core.output.profile.curve import Exact
from core.output.profile.drawing import ProfileDrawing
from core.output.profile.fits import Cubics
from core.output.profile.made import FittedCurve, exact_curve, fitted
from core.output.profile.request import Request
from core.study import Study

BLANK = (
    "base_radius_mm", "thickness_mm", "bore_mm", "hub_mm", "keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg",
)  # fmt: skip
POINTS = 36  # rows of the table of points
SEARCHED = 720  # angles at which a stretch of constant radius is looked for
EQUAL = 1e-9  # relative: radii that are one
SPANS, MOST_SPANS = 360, 23_040  # of the curve as drawn, at first and at most
DRAWN = 1e-5  # of the cam's size: how far the curve as drawn may be off
STRAIGHT = 1e-9  # of 1/size: what is less curved is straight


@frozen(eq=False)
class ProfilePoint:
    """A value, the cam angle [deg] where it stands, the point of the profile there [mm], and all points that have the value."""

    value: float
    cam_angle_deg: float
    z: complex
    all: np.ndarray


@frozen(eq=False)
class Figures:
    """
    job       the chosen flank, its curve as drawn and exactly; ``others`` are the curves of the other flanks of this body
    smallest  radius from the cam centre [mm], and ``largest``
    convex    least radius of curvature [mm] where the profile is convex, and ``concave``; None where it is so nowhere
    table     (36, 3): cam angle [deg], radius [mm], polar angle [deg]
    """

    job: ProfileDrawing
    others: tuple[Cubics, ...]
    smallest: ProfilePoint
    largest: ProfilePoint
    convex: ProfilePoint | None
    concave: ProfilePoint | None
    table: np.ndarray

    @property
    def chains(self) -> tuple[Cubics, ...]:
        """All curves as drawn, the chosen flank's first."""
        return _cubics(self.job.main), *self.others

    @property
    def cam(self) -> Mapping[str, float]:
        """What is known of the blank, by the fields' names [mm, deg]."""
        cam = self.job.study.design.drive.cam
        values = {name: getattr(cam, name, None) for name in BLANK}
        if self.job.request.flank != form_row(cam.form).flanks[0]:
            values["base_radius_mm"] = None  # it is that of the first flank
        return {name: value for name, value in values.items() if value is not None}


def figures(study: Study, flank: str) -> Figures:
    """The figures of one flank.

    Raises as ``core.output.profile.job_of`` does: NoSuchStage, NoCam, KindynaError.
    """
    first = exact_curve(study, Request(flank, samples=POINTS, fit="spline"))
    around = study.program.angles(np.deg2rad(degrees(SEARCHED)))
    z = first(around).z
    job = _job(study, first, Request(flank, samples=SPANS, fit="spline"))
    there = form_row(study.design.drive.cam.form).flanks
    walls = [
        replace(job.request, flank=name) for name in there if name != flank and OUTER in there
    ]  # of a groove, in the same body
    others = tuple(_cubics(_job(study, exact_curve(study, wall), wall).main) for wall in walls)

    def quantities(angles: Angles) -> dict[str, np.ndarray]:
        samples = first(angles)
        return {"radius": np.abs(samples.z), "curvature": -study.sense * samples.curvature}

    found = find_extremes(quantities, study.program)
    size = found["radius"].high.value
    bend, hollow = found["curvature"].high, found["curvature"].low
    sampled = quantities(around)

    def place(name: str, extreme: Extreme, value: float) -> ProfilePoint:
        same = z[np.abs(sampled[name] - extreme.value) <= EQUAL * abs(extreme.value)]
        at = complex(first(study.program.angles(np.array([extreme.theta]))).z[0])
        return ProfilePoint(value, float(np.rad2deg(extreme.theta)), at, np.append(same, at))

    return Figures(
        job,
        others,
        place("radius", found["radius"].low, found["radius"].low.value),
        place("radius", found["radius"].high, size),
        place("curvature", bend, 1.0 / bend.value) if bend.value * size > STRAIGHT else None,
        place("curvature", hollow, -1.0 / hollow.value) if hollow.value * size < -STRAIGHT else None,
        _table(study, first),
    )


def _job(study: Study, exact: Exact, request: Request) -> ProfileDrawing:
    """The curve of a flank, of as many points as it takes."""
    while True:
        main = fitted(study, exact, request)
        if main.deviation <= DRAWN * main.curve.size or request.value >= MOST_SPANS:
            return ProfileDrawing(study, request, main)
        request = replace(request, samples=4 * int(request.value))


def _cubics(drawn: FittedCurve) -> Cubics:
    assert isinstance(drawn.chain, Cubics)
    return drawn.chain


def _table(study: Study, exact: Exact) -> np.ndarray:
    angles = degrees(POINTS)
    z = exact(study.program.angles(np.deg2rad(angles))).z
    return np.column_stack((angles, np.abs(z), np.mod(np.rad2deg(np.angle(z)), 360.0)))


def extent(chains: tuple[Cubics, ...]) -> tuple[complex, complex]:
    """Lower left and upper right corner [mm] of closed chains of cubics, the cam centre included; by points close to each other."""
    t = np.linspace(0.0, 1.0, 9)
    weights = np.stack(((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3))
    z = np.append(np.concatenate([(chain.points @ weights).ravel() for chain in chains]), 0j)
    return complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())


__all__ = ["Figures", "ProfilePoint", "extent", "figures"]
