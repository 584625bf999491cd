"""Every scalar a study can be asked for, as one table: which stage it needs and where it stands there (SI)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from core.design import FOLLOWER_KINDS
from core.motion import Angles
from core.shaft import Flywheel

if TYPE_CHECKING:
    from core.study.base import Study

ALL_KINDS = frozenset(FOLLOWER_KINDS)
SLIDER = frozenset({"cam-slider"})


def _always(study: Study) -> bool:
    return True


def _motor_runs(study: Study) -> bool:
    """Not where the guide jams, nor where the motor stalls."""
    return study.jam is None and (not study.levelled or study.flywheel.runs)


def _by_motor(torque: Callable[[Flywheel, Angles], np.ndarray]) -> Callable[[Study], np.ndarray]:
    """That of the cam where no flywheel levels it. Raises NoAnswer where the guide jams or the motor stalls."""
    return lambda s: torque(s.flywheel, s.angles) if s.levelled or s.jam is not None else s.dynamics.torque


def _speed(study: Study) -> np.ndarray:
    """Constant where no flywheel lets it change."""
    if study.levelled or study.jam is not None:
        return study.flywheel.speed(study.angles)
    return np.full(study.theta.size, study.omega)


@dataclass(frozen=True)
class Quantity:
    """stage it needs; value (n,) in SI by time where it is a rate; kinds of follower that have it; ``turns`` marks an
    angle that goes round, which has no extremes; ``exists`` tells whether a design that could have it does."""

    stage: str
    value: Callable[[Study], np.ndarray]
    kinds: frozenset[str] = ALL_KINDS
    turns: bool = False
    exists: Callable[[Study], bool] = _always


def _motion(order: int) -> Quantity:
    return Quantity("motion", lambda s: s.motion.y[order] * s.omega**order)


def _coordinate(name: str, order: int) -> Quantity:
    return Quantity("linkage", lambda s: s.linkage.coordinates[name][order] * s.omega**order, SLIDER)


def _singular(code: str) -> Quantity:
    return Quantity("linkage", lambda s: s.linkage.singular[code], SLIDER)


def _pair_x(name: str, kinds: frozenset[str]) -> Quantity:
    return Quantity("dynamics", lambda s: s.dynamics.pairs[name].real, kinds)


def _pair_y(name: str, kinds: frozenset[str]) -> Quantity:
    return Quantity("dynamics", lambda s: s.dynamics.pairs[name].imag, kinds)


def _size(name: str, kinds: frozenset[str]) -> Quantity:
    return Quantity("dynamics", lambda s: np.abs(s.dynamics.pairs[name]), kinds)


def _polar_angle(study: Study) -> np.ndarray:
    """0 ... 2π, 2π itself never."""
    angle = np.mod(np.angle(study.cam.flank.profile), 2.0 * np.pi)
    return np.where(angle >= 2.0 * np.pi, 0.0, angle)


QUANTITIES: Mapping[str, Quantity] = MappingProxyType(
    {
        "displacement": _motion(0),
        "velocity": _motion(1),
        "acceleration": _motion(2),
        "jerk": _motion(3),
        "slider_position": _coordinate("slider_position", 0),
        "phi": _coordinate("phi", 0),
        "phi_velocity": _coordinate("phi", 1),
        "phi_acceleration": _coordinate("phi", 2),
        "beta": _coordinate("beta", 0),
        "beta_velocity": _coordinate("beta", 1),
        "beta_acceleration": _coordinate("beta", 2),
        "dead-centre": _singular("dead-centre"),
        "rod-across-guide": _singular("rod-across-guide"),
        "profile_x": Quantity("cam", lambda s: s.cam.flank.profile.real),
        "profile_y": Quantity("cam", lambda s: s.cam.flank.profile.imag),
        "pitch_x": Quantity("cam", lambda s: s.cam.flank.pitch.real),
        "pitch_y": Quantity("cam", lambda s: s.cam.flank.pitch.imag),
        "pressure_angle": Quantity("cam", lambda s: s.cam.flank.pressure_angle),
        "pitch_curvature": Quantity("cam", lambda s: s.cam.flank.pitch_curvature),
        "profile_curvature": Quantity("cam", lambda s: s.cam.flank.profile_curvature),
        "radius": Quantity("cam", lambda s: np.abs(s.cam.flank.profile)),
        "polar_angle": Quantity("cam", _polar_angle, turns=True),
        "contact_force": Quantity("dynamics", lambda s: s.dynamics.contact),
        "drive_torque": Quantity("dynamics", lambda s: s.dynamics.torque),
        "motor_torque": Quantity("dynamics", _by_motor(Flywheel.motor_torque), exists=_motor_runs),
        "linear_motor_torque": Quantity(
            "dynamics", _by_motor(Flywheel.linear_motor_torque), exists=lambda s: s.levelled and _motor_runs(s)
        ),
        "camshaft_speed": Quantity("dynamics", _speed, exists=_motor_runs),
        "follower_torque": Quantity("dynamics", lambda s: s.dynamics.follower_torque, SLIDER),
        "guide_force": Quantity("dynamics", lambda s: s.dynamics.guide.normal),
        "jam_factor": Quantity("dynamics", lambda s: s.dynamics.guide.jam),
        "slider_pin_x": _pair_x("slider_pin", SLIDER),
        "slider_pin_y": _pair_y("slider_pin", SLIDER),
        "arm_pin_x": _pair_x("arm_pin", SLIDER),
        "arm_pin_y": _pair_y("arm_pin", SLIDER),
        "pivot_x": _pair_x("pivot", SLIDER),
        "pivot_y": _pair_y("pivot", SLIDER),
        "bearing_x": _pair_x("bearing", ALL_KINDS),
        "bearing_y": _pair_y("bearing", ALL_KINDS),
        "slider_pin": _size("slider_pin", SLIDER),
        "arm_pin": _size("arm_pin", SLIDER),
        "pivot": _size("pivot", SLIDER),
        "bearing": _size("bearing", ALL_KINDS),
    }
)

OF_MOTOR = frozenset({"motor_torque", "linear_motor_torque", "camshaft_speed"})
"""Those of the stage ``dynamics`` that flywheel and motor change; forces are those of a constant speed."""


def quantities_of(kind: str, stage: str | None = None) -> dict[str, Quantity]:
    """The quantities that this kind of follower has, of one stage or of all."""
    return {n: q for n, q in QUANTITIES.items() if kind in q.kinds and stage in (None, q.stage)}
