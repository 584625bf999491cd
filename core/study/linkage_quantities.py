"""The scalars of a linkage: their names say the link, slide, point or joint they are of, so they are made by name."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from core.design import CRANK, FRAME_LINK, Design
from core.design.topology import GROUP, driver_pair, is_pin, solving_order
from core.study.quantities import QUANTITIES, Quantity
from core.train import SLIDING, Train

if TYPE_CHECKING:
    from core.study.base import Study

_RATES = ("", "_velocity", "_acceleration")
_MOTION = ("displacement", "velocity", "acceleration", "jerk")
_CAM = ("profile_x", "profile_y", "pitch_x", "pitch_y", "pressure_angle", "pitch_curvature", "profile_curvature", "radius",
        "polar_angle")  # fmt: skip


def _coordinate(name: str, order: int) -> Callable[[Study], np.ndarray]:
    return lambda s: s.linkage.coordinates[name][order] * s.omega**order


def body_of(train: Train, point: str) -> str:
    """The body that a point is read from: the first that has it, but for one that slides, which keeps to its line."""
    having = [name for name, body in train.bodies.items() if point in body.points]
    sliding = [pair.body for pair in train.pairs.values() if pair.kind == SLIDING and pair.body in having]
    return (sliding or having)[0]


def _point(name: str, order: int) -> Callable[[Study], np.ndarray]:
    def value(study: Study) -> np.ndarray:
        train = study.linkage
        at: np.ndarray = train.bodies[body_of(train, name)].point(name)[order]
        return at * study.omega**order

    return value


Part = Callable[[np.ndarray], np.ndarray]
_OF_POINT: Mapping[str, tuple[int, Part]] = MappingProxyType(
    {"x": (0, np.real), "y": (0, np.imag), "vx": (1, np.real), "vy": (1, np.imag), "ax": (2, np.real), "ay": (2, np.imag),
     "speed": (1, np.abs)}
)  # fmt: skip
_OF_FORCE: Mapping[str, Part] = MappingProxyType({"x": np.real, "y": np.imag, "size": np.abs})


def _point_part(name: str, what: str) -> Callable[[Study], np.ndarray]:
    order, part = _OF_POINT[what]
    value = _point(name, order)
    return lambda s: part(value(s))


def _force_part(name: str, what: str) -> Callable[[Study], np.ndarray]:
    part = _OF_FORCE[what]
    return lambda s: part(s.dynamics.pairs[name])


# pattern of the name -> stage, and what gives the value for what the pattern catches
_PATTERNS: tuple[tuple[str, str, Callable[..., Callable[[Study], np.ndarray]]], ...] = (
    (r"(link|slide)\.(\d+)(|_velocity|_acceleration)", "linkage",
     lambda of, number, rate: _coordinate(f"{of}{number}", _RATES.index(rate))),
    (rf"point\.(\w+)_({'|'.join(_OF_POINT)})", "linkage", _point_part),
    (r"transmission\.(\w+)", "linkage", lambda joint: lambda s: np.arcsin(np.minimum(s.linkage.singular[joint], 1.0))),
    (rf"force\.(\w+)_({'|'.join(_OF_FORCE)})", "dynamics", _force_part),
    (r"couple\.(\w+)", "dynamics", lambda name: lambda s: s.dynamics.couples[name]),
)  # fmt: skip
_OWN: Mapping[str, Quantity] = MappingProxyType(
    {
        "driver_torque": Quantity("dynamics", lambda s: s.dynamics.driver),
        "driver_force": Quantity("dynamics", lambda s: s.dynamics.driver),
        "roller_force": Quantity("dynamics", lambda s: s.dynamics.contact),
        "camshaft_torque": Quantity("dynamics", lambda s: s.dynamics.torque),
    }
)


@lru_cache(maxsize=1024)
def quantity(name: str) -> Quantity:
    """The row of a quantity's name: of a follower's table, or ``link.3_velocity``, ``point.B_x``, ``transmission.B``.

    Raises KeyError.
    """
    if name in QUANTITIES:
        return QUANTITIES[name]
    if name in _OWN:
        return _OWN[name]
    for pattern, needed, make in _PATTERNS:
        match = re.fullmatch(pattern, name)
        if match:
            return Quantity(needed, make(*match.groups()))
    raise KeyError(name)


@lru_cache(maxsize=64)
def names_of(design: Design) -> tuple[str, ...]:
    """Every quantity of a design, in the order of the tables."""
    linkage = design.drive.linkage
    crank = linkage.driver.kind == CRANK
    moving = [n for n in sorted(linkage.by_number) if n != FRAME_LINK and not (crank and n == linkage.driver.link)]
    names = [] if crank else list(_MOTION)
    names += [f"link.{n}{rate}" for n in moving for rate in _RATES]
    names += [f"slide.{s.link}{rate}" for s in linkage.sliders for rate in _RATES]
    fixed = linkage.by_number[FRAME_LINK].places
    points = dict.fromkeys(p.name for link in linkage.links for p in link.points if p.name not in fixed)
    names += [f"point.{p}_{what}" for p in points for what in ("x", "y", "vx", "vy", "ax", "ay", "speed")]
    names += [f"transmission.{step.joint}" for step in solving_order(linkage).steps if step.kind != GROUP]
    if design.drive.cam is not None:
        names += _CAM
    names += _forces(design)
    return tuple(names)


def _forces(design: Design) -> list[str]:
    from core.mechanism import mechanism_of  # not before there is a linkage

    pair = driver_pair(design.drive.linkage)
    if design.drive.cam is not None:
        names = ["roller_force", "camshaft_torque"]
    else:
        names = ["driver_torque" if pair is not None and is_pin(pair) else "driver_force"]
    for joint, name in mechanism_of(design.drive.linkage).pair_names().items():
        names += [f"force.{name}_{what}" for what in ("x", "y", "size")]
        names += [] if joint.revolute else [f"couple.{name}"]
    return names
