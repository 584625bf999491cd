"""Mechanisms that can be built: drawn backwards from a pose, so that they close whatever the numbers are."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from core.design import (
    CamSlider,
    CamSliderLoads,
    Design,
    Drive,
    Motion,
    NamedCurve,
    RollerCam,
    Segment,
    Shaft,
    Translating,
    TranslatingLoads,
    with_drive,
)

SMOOTH = ("simple-harmonic", "cycloidal", "modified-sine", "modified-trapezoid", "3-4-5", "4-5-6-7")

# The lift of Shin1995, Tables 2 and 3; masses as in the example, what the paper does not give being assumed.
LIFT = Design(
    "lift",
    Shaft("ccw", 20.0),
    (
        Drive(
            Motion(
                150.0,
                (
                    Segment(35.0, 0.0),
                    Segment(41.5, -150.0, NamedCurve("modified-sine")),
                    Segment(207.0, 0.0),
                    Segment(41.5, 150.0, NamedCurve("modified-sine")),
                    Segment(35.0, 0.0),
                ),
            ),
            CamSlider(
                layout="b",
                slider_arm_mm=1302.162,
                rod_mm=845.0,
                guide_height_mm=1300.0,
                guide_angle_deg=0.0,
                roller_arm_mm=651.081,
                fixed_angle_deg=43.637,
                pivot_x_mm=873.746,
                pivot_y_mm=-65.0,
            ),
            RollerCam(400.0, 150.0),
            CamSliderLoads(
                slider_mass_kg=200.0,
                rod_mass_kg=125.0,
                rod_inertia_kg_m2=7.44,
                arm_mass_kg=664.0,
                arm_inertia_kg_m2=16.588,
                roller_mass_kg=50.0,
                roller_inertia_kg_m2=0.5625,
                friction=0.1,
                external_force_n=-20000.0,
            ),
        ),
    ),
)

# A translating follower with an offset, off the vertical.
PUSHER = Design(
    "pusher",
    Shaft("ccw", 300.0),
    (
        Drive(
            Motion(
                0.0,
                (
                    Segment(60.0, 0.0),
                    Segment(100.0, 20.0, NamedCurve("cycloidal")),
                    Segment(50.0, 0.0),
                    Segment(150.0, -20.0, NamedCurve("3-4-5")),
                ),
            ),
            Translating(offset_mm=7.0, direction_deg=70.0),
            RollerCam(45.0, 12.0),
            TranslatingLoads(follower_mass_kg=1.5, spring_rate_n_per_mm=4.0, preload_n=120.0, friction=0.12),
        ),
    ),
)


def levels(start: float, *steps: tuple[float, float, str]) -> Motion:
    """A motion by (span, level at its end, law)."""
    segments, at = [], start
    for span, end, law in steps:
        segments.append(Segment(span, end - at, NamedCurve(law)))
        at = end
    return Motion(start, tuple(segments))


def with_loads(design: Design, **values: float) -> Design:
    return with_drive(design, loads=replace(design.drive.loads, **values))


def with_follower(design: Design, **values: Any) -> Design:
    return with_drive(design, mechanism=replace(design.drive.mechanism, **values))


def with_cam(design: Design, **values: Any) -> Design:
    return with_drive(design, cam=replace(design.drive.cam, **values))


def with_shaft(design: Design, **values: Any) -> Design:
    return replace(design, shaft=replace(design.shaft, **values))


def _degrees(angle: float) -> float:
    """[rad] as -180 ... 180 [deg]."""
    return math.degrees(math.remainder(angle, math.tau))


def posed(
    layout: str,
    *,
    slider_arm: float,
    rod: float,
    arm_angle: float,
    rod_angle: float,
    guide: float,
    pivot: complex,
    roller_arm: float,
    spread: float,
    roller_share: float,
) -> tuple[CamSlider, RollerCam]:
    """A cam-driven slider by its base pose [mm, rad].

    arm_angle and rod_angle (-π/2 ... π/2, the rod's slope) in the guide's frame; pivot with positive x, mirrored where
    the letter asks for it; spread the angle at the pivot between cam centre and roller; roller_share of the distance
    cam centre to roller that is roller.
    """
    cam_left, above, right = layout in "abef", layout in "abcd", layout in "aceg"
    pivot = pivot if cam_left else -pivot.conjugate()
    beta = rod_angle if right else math.pi - rod_angle
    to_cam = cmath.phase(-pivot)
    alpha = to_cam - spread if above == cam_left else to_cam + spread
    reach = abs(pivot + cmath.rect(roller_arm, alpha))
    follower = CamSlider(
        layout=layout,
        slider_arm_mm=slider_arm,
        rod_mm=rod,
        guide_height_mm=slider_arm * math.sin(arm_angle) + rod * math.sin(beta),
        guide_angle_deg=_degrees(guide),
        roller_arm_mm=roller_arm,
        fixed_angle_deg=_degrees(alpha - guide - arm_angle),
        pivot_x_mm=pivot.real,
        pivot_y_mm=pivot.imag,
    )
    return follower, RollerCam(reach * (1.0 - roller_share), reach * roller_share)


# One of each letter, no two alike.
LAYOUT_DESIGNS = {}
for _i, _letter in enumerate("abcdefgh"):
    _follower, _cam = posed(
        _letter,
        slider_arm=300.0 + 10.0 * _i,
        rod=260.0 - 7.0 * _i,
        arm_angle=1.3 + 0.06 * _i,
        rod_angle=0.3 - 0.05 * _i,
        guide=-0.9 + 0.31 * _i,
        pivot=complex(210.0 - 3.0 * _i, -40.0 + 9.0 * _i),
        roller_arm=180.0 + 5.0 * _i,
        spread=0.6 + 0.02 * _i,
        roller_share=0.2,
    )
    LAYOUT_DESIGNS[_letter] = Design(
        f"layout {_letter}",
        Shaft("ccw" if _i % 3 else "cw", 90.0),
        (
            Drive(
                levels(
                    5.0,
                    (40.0, 5.0, "dwell"),
                    (110.0, 45.0, SMOOTH[_i % 6]),
                    (60.0, 20.0, SMOOTH[(_i + 3) % 6]),
                    (150.0, 5.0, SMOOTH[(_i + 1) % 6]),
                ),
                _follower,
                _cam,
                CamSliderLoads(
                    slider_mass_kg=3.0,
                    rod_mass_kg=1.2,
                    rod_inertia_kg_m2=0.009,
                    rod_centre=0.4,
                    arm_mass_kg=2.5,
                    arm_inertia_kg_m2=0.03,
                    arm_centre_mm=60.0,
                    arm_centre_angle_deg=25.0,
                    roller_mass_kg=0.7,
                    roller_inertia_kg_m2=4e-4,
                    friction=0.15,
                    external_force_n=-200.0,
                    spring_rate_n_per_mm=1.5,
                    gravity_angle_deg=-75.0,
                ),
            ),
        ),
    )


def mirrored(design: Design) -> Design:
    """What a mirror standing on the y axis shows of a design: left for right, clockwise for counter-clockwise.

    The mirrored guide points backwards, so the same slider moves against it: the signs of motion and force along the
    guide change.
    """
    drive, flip = design.drive, {"ccw": "cw", "cw": "ccw"}
    g, loads, motion = drive.mechanism, drive.loads, drive.motion
    gravity = replace(loads, gravity_angle_deg=_degrees(math.pi - math.radians(loads.gravity_angle_deg)))
    shaft = replace(design.shaft, rotation=flip[design.shaft.rotation])
    if isinstance(g, Translating):
        follower: Any = replace(g, offset_mm=-g.offset_mm, direction_deg=180.0 - g.direction_deg)
        return with_drive(replace(design, shaft=shaft), mechanism=follower, loads=gravity)
    follower = replace(
        g,
        layout=dict(zip("abcdefgh", "dcbahgfe", strict=True))[g.layout],
        guide_angle_deg=-g.guide_angle_deg,
        fixed_angle_deg=-g.fixed_angle_deg,
        pivot_x_mm=-g.pivot_x_mm,
    )
    segments = tuple(replace(s, rise=-s.rise) for s in motion.segments)
    gravity = replace(
        gravity, external_force_n=-loads.external_force_n, arm_centre_angle_deg=-loads.arm_centre_angle_deg
    )
    return with_drive(
        replace(design, shaft=shaft),
        motion=replace(motion, start=-motion.start, segments=segments),
        mechanism=follower,
        loads=gravity,
    )


# -- random ones ------------------------------------------------------------------------------------------


def between(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False)


@st.composite
def motions(draw: st.DrawFn, low: float, high: float) -> Motion:
    """One turn of two to five segments between levels low ... high, each segment with its own law."""
    count = draw(st.integers(2, 5))
    weights = [draw(between(1.0, 4.0)) for _ in range(count)]
    spans = [360.0 * w / math.fsum(weights) for w in weights]
    spans[-1] = 360.0 - math.fsum(spans[:-1])
    begin = at = low + (high - low) * draw(between(0.0, 1.0))
    steps = []
    for i, span in enumerate(spans):
        end = begin if i == count - 1 else low + (high - low) * draw(between(0.0, 1.0))
        if abs(end - at) < 1e-3 * (high - low) and i < count - 1:
            end = at
        steps.append((span, end, draw(st.sampled_from(SMOOTH)) if end != at else "dwell"))
        at = end
    return levels(begin, *steps)


def _shafts() -> st.SearchStrategy[Shaft]:
    return st.builds(Shaft, st.sampled_from(("ccw", "cw")), between(1.0, 600.0))


@st.composite
def cam_sliders(draw: st.DrawFn) -> Design:
    """A cam-driven slider well away from its dead centres over the whole motion, with any loads."""
    arm = 10.0 ** draw(between(1.5, 3.2))
    rod = arm * draw(between(0.5, 2.0))
    arm_angle, rod_angle = draw(between(-math.pi, math.pi)), draw(between(-1.0, 1.0))
    layout = draw(st.sampled_from("abcdefgh"))
    beta = rod_angle if layout in "aceg" else math.pi - rod_angle
    assume(abs(math.sin(arm_angle - beta)) > 0.35)
    follower, cam = posed(
        layout,
        slider_arm=arm,
        rod=rod,
        arm_angle=arm_angle,
        rod_angle=rod_angle,
        guide=draw(between(-math.pi, math.pi)),
        pivot=cmath.rect(arm * draw(between(0.5, 1.5)), draw(between(-1.4, 1.4))),
        roller_arm=arm * draw(between(0.4, 1.2)),
        spread=draw(between(0.4, 1.6)),
        roller_share=draw(between(0.05, 0.4)),
    )
    stroke = 0.15 * min(arm, rod)
    _assume_clear(follower, cam, arm * math.cos(arm_angle) + rod * math.cos(beta), beta, stroke)
    motion = draw(motions(-0.2 * stroke, stroke))
    loads = CamSliderLoads(
        slider_mass_kg=draw(between(0.0, 50.0)),
        rod_mass_kg=draw(between(0.0, 20.0)),
        rod_inertia_kg_m2=draw(between(0.0, 0.5)),
        rod_centre=draw(between(0.0, 1.0)),
        arm_mass_kg=draw(between(0.0, 50.0)),
        arm_inertia_kg_m2=draw(between(0.0, 0.5)),
        arm_centre_mm=arm * draw(between(-1.0, 1.0)),
        arm_centre_angle_deg=draw(between(-180.0, 180.0)),
        roller_mass_kg=draw(between(0.1, 10.0)),
        roller_inertia_kg_m2=draw(between(0.0, 0.1)),
        friction=draw(between(0.0, 0.4)),
        external_force_n=draw(between(-5000.0, 5000.0)),
        spring_rate_n_per_mm=draw(between(0.0, 20.0)),
        gravity_angle_deg=draw(between(-180.0, 180.0)),
    )
    return Design("drawn", draw(_shafts()), (Drive(motion, follower, cam, loads),))


def _assume_clear(follower: CamSlider, cam: RollerCam, at_base: float, beta: float, stroke: float) -> None:
    """Arm and rod keep 10 degrees from one line, the rod 10 degrees from across, and the roller off the cam centre."""
    l1, l2, h = follower.slider_arm_mm, follower.rod_mm, follower.guide_height_mm
    slider = at_base + stroke * np.linspace(-0.2, 1.0, 13)
    cosine = (slider**2 + h * h - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)  # of the angle between them
    assume(np.abs(cosine).max() < math.cos(math.radians(10.0)))
    # of two mirror positions of the arm's pin about the line to the slider, the one it has at the base
    side = math.copysign(1.0, (at_base * (h - l2 * math.sin(beta)) - h * (at_base - l2 * math.cos(beta))))
    along = (slider**2 + h * h + l1 * l1 - l2 * l2) / (2.0 * l1 * np.hypot(slider, h))
    phi = np.arctan2(h, slider) + side * np.arccos(np.clip(along, -1.0, 1.0))
    assume(np.abs(slider - l1 * np.cos(phi)).min() > l2 * math.sin(math.radians(10.0)))
    angle = phi + math.radians(follower.fixed_angle_deg + follower.guide_angle_deg)
    roller = complex(follower.pivot_x_mm, follower.pivot_y_mm) + follower.roller_arm_mm * np.exp(1j * angle)
    assume(np.abs(roller).min() > 1.2 * cam.roller_radius_mm)


@st.composite
def pushers(draw: st.DrawFn) -> Design:
    """A translating follower, with any loads."""
    reach = 10.0 ** draw(between(1.0, 3.0))
    share = draw(between(0.05, 0.4))
    motion = draw(motions(-0.1 * reach, 0.5 * reach))
    follower = Translating(offset_mm=reach * draw(between(-0.4, 0.4)), direction_deg=draw(between(-180.0, 180.0)))
    loads = TranslatingLoads(
        follower_mass_kg=draw(between(0.1, 20.0)),
        spring_rate_n_per_mm=draw(between(0.0, 20.0)),
        preload_n=draw(between(-100.0, 2000.0)),
        friction=draw(between(0.0, 0.3)),
        gravity_angle_deg=draw(between(-180.0, 180.0)),
    )
    cam = RollerCam(reach * (1.0 - share), reach * share)
    return Design("drawn", draw(_shafts()), (Drive(motion, follower, cam, loads),))


# Nobody asks for an angle that is not a normal number, and there relative errors mean nothing.
ANGLES = st.one_of(st.just(0.0), between(1e-9, 6.28))


def buildable() -> st.SearchStrategy[Design]:
    """A design of either kind that has an answer at every cam angle."""
    return st.one_of(cam_sliders(), pushers())
