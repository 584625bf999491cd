"""The instant centre of a follower and its cam, by Kennedy's theorem from the pair that holds the follower."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from core.instant_centres.centre import Centres
from core.instant_centres.construction import construction, kennedy
from core.instant_centres.linkage import primary_pairs
from core.mechanism.kinematics import FRAME, REVOLUTE, SLIDING, Kinematics


def _through_pivot(kinematics: Kinematics, sense: float) -> Centres:
    """Kennedy: on the line cam centre - pivot P; q = Zxy φ'/(φ'-d) (Shin1995 (18) counts φ' against the cam)."""
    pair = kinematics.pairs[kinematics.ground]
    pivot, turn = kinematics.bodies[pair.body].place(pair.point), kinematics.bodies[pair.body].turn[1]
    return Centres(pivot * turn, turn - sense)


def _across_guide(kinematics: Kinematics, sense: float) -> Centres:
    """Kennedy: the follower turns about infinity across its guide e, so Q = -i d s' e."""
    pair = kinematics.pairs[kinematics.ground]
    speed = (kinematics.bodies[pair.body].origin[1] / pair.axis).real
    return Centres(-1j * sense * speed * pair.axis, np.ones_like(speed))


def _through_pole(kinematics: Kinematics, sense: float) -> Centres:
    """Kennedy: on the line cam centre - pole I of the roller's link on the frame, which the circle diagram finds from
    the pairs: Q = φ'I/(φ'-d). Where the link does not turn, where no two triangles reach the pole or rounding decides
    it, by the velocity of the roller's centre: Q = (φ'R + iR')/(φ'-d)."""
    follower = kinematics.follower
    turn = follower.turn[1]
    point, weight = turn * follower.origin[0] + 1j * follower.origin[1], turn - sense
    pole = _pole(kinematics)
    if pole is None:
        return Centres(point, weight)
    with np.errstate(divide="ignore", invalid="ignore"):
        error_bound = pole.error_bound / np.abs(pole.weight)  # relative to the pole's distance: the farther, the larger
        told = error_bound < _LARGEST_BOUND
        point = np.where(told, turn * pole.point / pole.weight, point)
    return Centres(point, weight, np.where(told, np.maximum(error_bound, 1.0), 1.0))


_LARGEST_BOUND = 1e6


def _pole(kinematics: Kinematics) -> Centres | None:
    """The centre of the roller's link on the frame by construction, scaled; None where it is not reached."""
    names = tuple(name for name in kinematics.bodies if name != kinematics.follower_body)
    order = {name: i for i, name in enumerate(names)}
    size = float(np.abs(kinematics.follower.origin[0]).max())
    found = {key: centre.scaled(size) for key, centre in primary_pairs(kinematics, order).items()}
    for wanted in construction(names, frozenset(found)).steps:
        found[wanted.key] = kennedy(found, wanted, size).scaled(size)
    return found.get((FRAME, kinematics.carrier))


CAM_CENTRES: Mapping[str, Callable[[Kinematics, float], Centres]] = MappingProxyType(
    {REVOLUTE: _through_pivot, SLIDING: _across_guide, "": _through_pole}
)


def cam_follower_centre(kinematics: Kinematics, sense: float) -> Centres:
    """Centre of the follower body relative to the cam (Shin1995 §3), by the three-centres theorem from the pair
    that holds the follower on the frame, or from its link's pole; sense: d = +1 for a cam turning counter-clockwise,
    -1 clockwise."""
    return CAM_CENTRES[kinematics.pairs[kinematics.ground].kind if kinematics.ground else ""](kinematics, sense)
