"""The instant centre of a follower and its cam, by Kennedy's theorem from the pole of the follower's link."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import numpy as np

from core.instant_centres.centre import Centres
from core.instant_centres.construction import construction, kennedy
from core.instant_centres.linkage import CentreTable, all_centres, primary_pairs
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics, Pair, Pose
from core.numerics.vectors import dot

CAM, CAMSHAFT = "cam", "camshaft"
"""The cam as a body, and the pin that holds it on the frame."""

_LARGEST_BOUND = 1e6


def cam_follower_centre(kinematics: Kinematics, sense: float) -> Centres:
    """Centre Q of the follower body relative to the cam (Shin1995 §3); sense: d = +1 for a cam turning counter-clockwise, -1
    clockwise.

    By the three-centres theorem on the line through the cam centre and the pole p/w of the follower's link on the frame, which
    is its pivot, infinitely far across its guide, or where the circle diagram finds it from the pairs. The reference point R
    moves by R' = ik(wR - p), which gives k, and Q = kp/(φ' - d), φ' = kw (Shin1995 (18) counts φ' against the cam). Where R is the
    pole, no two triangles reach the pole or rounding decides it, by the velocity of R: Q = (φ'R + iR')/(φ'-d).
    """
    follower = kinematics.follower
    turn, place, speed = follower.turn[1], follower.origin[0], follower.origin[1]
    point, weight = turn * place + 1j * speed, turn - sense
    pole = _pole(kinematics)
    if pole is None:
        return Centres(point, weight)
    arm = 1j * (pole.weight * place - pole.point)
    square = dot(arm, arm)
    with np.errstate(divide="ignore", invalid="ignore"):
        k = dot(arm, speed) / square
        # relative to the pole's distance from R, which the construction knows as a part of its size
        error_bound = pole.error_bound * np.abs(place).max() / np.sqrt(square)
    known = error_bound < _LARGEST_BOUND
    return Centres(np.where(known, k * pole.point, point), weight, np.where(known, np.maximum(error_bound, 1.0), 1.0))


def cam_centres(kinematics: Kinematics, sense: float) -> CentreTable:
    """All centres of the frame, the links that the cam drives and the cam itself, which stands last; sense as in
    ``cam_follower_centre``, which gives that of cam and follower: it counts as one that a pair shows, for the contact normal does.

    The cam always turns, so that each link has a centre on it in a dwell too; those of the links on each other are then found by
    Kennedy's construction.
    """
    theta = kinematics.theta
    row = np.zeros((4, theta.size))
    turn = row.copy()
    turn[0], turn[1] = sense * theta, sense
    cam, frame = Pose.of(row + 0j, turn, MappingProxyType({CAMSHAFT: 0j})), Pose.of(row + 0j, row)
    joined = {name for pair in kinematics.pairs.values() for name in (pair.on, pair.body)}
    names = (FRAME, *(name for name in kinematics.bodies if name in joined and name != FRAME), CAM)
    whole = replace(
        kinematics,
        bodies=MappingProxyType({FRAME: frame, **kinematics.bodies, CAM: cam}),
        pairs=MappingProxyType({**kinematics.pairs, CAMSHAFT: Pair(REVOLUTE, FRAME, CAM, CAMSHAFT)}),
    )
    size = float(np.abs(kinematics.follower.origin[0]).max())
    table = all_centres(whole, size, names)
    followed = {table.key(kinematics.carrier, CAM): cam_follower_centre(kinematics, sense).scaled(size)}
    return replace(
        table, centres=MappingProxyType({**table.centres, **followed}), primary=table.primary | frozenset(followed)
    )


def _pole(kinematics: Kinematics) -> Centres | None:
    """The centre of the follower's link on the frame from the places of the pairs, scaled; None where it is not reached."""
    names = tuple(
        dict.fromkeys(
            (FRAME, *(name for name in kinematics.bodies if name != kinematics.follower_body), kinematics.carrier)
        )
    )
    order = {name: i for i, name in enumerate(names)}
    size = float(np.abs(kinematics.follower.origin[0]).max())
    found = {key: centre.scaled(size) for key, centre in primary_pairs(kinematics, order).items()}
    wanted = (FRAME, kinematics.carrier)
    for step in () if wanted in found else construction(names, frozenset(found)).steps:
        found[step.key] = kennedy(found, step, size).scaled(size)
    return found.get(wanted)
