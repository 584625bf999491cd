"""What quantities need of a design, beyond the kind of its mechanism."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

from core.cam import OUTER, SECOND, form_row, row_of
from core.design import Design
from core.design.parts import LINEAR, ROTARY
from core.frozen import frozen
from core.stress import load_ratings, pairings
from core.study.drive_forces import ROLLERS, has_servo
from core.study.piston import has_piston


def _is_rated(roller: str, design: Design) -> bool:
    return design.drive.cam is not None and roller in load_ratings(design.drive.face, design.drive.cam)


def _has_flank(name: str, design: Design) -> bool:
    return design.drive.cam is not None and name in form_row(design.drive.cam.form).flanks


def _has_stress(design: Design) -> bool:
    return design.drive.cam is not None and bool(pairings(design.drive.face, design.drive.cam))


def _has_elastic_follower(design: Design) -> bool:
    return design.drive.cam is not None and bool(design.drive.loads.follower_stiffness_n_per_mm)


def has_motor(design: Design) -> bool:
    """Whether the motor of a shaft turns its cam or crank."""
    return design.shaft is not None and (design.drive.cam is not None or design.by_crank)


@frozen
class Need:
    """What a design must have so that it has a quantity: in words, and whether a design has it."""

    words: str
    is_met: Callable[[Design], bool]


NEEDS: Mapping[str, Need] = MappingProxyType(
    {
        "": Need("", lambda design: True),
        "motion": Need("a motion", lambda design: design.drive.motion is not None),
        "slide": Need(
            "a motion in mm, with a mass or a force", lambda d: d.drive.loaded and d.drive.motion_unit == "mm"
        ),
        "turned": Need(
            "a motion in degrees, with an inertia or a torque",
            lambda design: design.drive.loaded and design.drive.motion_unit == "deg",
        ),
        "loaded": Need("a mass, an inertia or a force", lambda design: design.drive.loaded),
        "servo": Need("a table [servo]", has_servo),
        "rotary servo": Need("a rotary motor in [servo]", lambda design: has_servo(design, ROTARY)),
        "linear servo": Need("a linear motor in [servo]", lambda design: has_servo(design, LINEAR)),
        "valve": Need("a rocker, a pushrod train, or a table [valve]", lambda design: design.drive.has_valve),
        "piston": Need("[engine], and valve.angle_deg and valve.clearance_mm", has_piston),
        "valve springs": Need(
            "[[loads.valve_springs]]", lambda design: bool(getattr(design.drive.loads, "valve_springs", ()))
        ),
        "cam": Need("a cam", lambda design: design.drive.cam is not None),
        "pitch": Need(
            "a cam with a roller, a knife edge or a shoe",
            lambda design: design.drive.cam is not None and "pitch_curvature" in row_of(design.drive.face).limits,
        ),
        "straight": Need(
            "a cam with a flat face", lambda design: design.drive.cam is not None and design.drive.face.straight
        ),
        OUTER: Need("a cam with a groove", partial(_has_flank, OUTER)),
        SECOND: Need("a conjugate pair of cams", partial(_has_flank, SECOND)),
        "stress": Need("a cam with thickness and materials", _has_stress),
        "second stress": Need(
            "a conjugate pair of cams with thickness and materials",
            lambda design: _has_flank(SECOND, design) and _has_stress(design),
        ),
        **{f"{roller} rating": Need("a roller with a load rating", partial(_is_rated, roller)) for roller in ROLLERS},
        "elastic": Need("a cam, and loads.follower_stiffness_n_per_mm", _has_elastic_follower),
        "elastic open": Need(
            "an open cam, and loads.follower_stiffness_n_per_mm",
            lambda design: _has_elastic_follower(design) and not design.drive.cam.form.holds,
        ),
        "elastic shaft": Need(
            "a cam, and shaft.stiffness_nm_per_rad",
            lambda design: (
                design.drive.cam is not None and design.shaft is not None and design.shaft.elastic is not None
            ),
        ),
        "shaft": Need("a shaft that turns a cam or a crank", has_motor),
    }
)
"""What quantities need of a design, beyond the kind of its mechanism."""
