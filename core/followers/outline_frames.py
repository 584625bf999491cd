"""Frames in which the outlines of bodies are given, at the positions of a mechanism."""

from __future__ import annotations

import numpy as np

from core.design import Design
from core.design.design import Drive
from core.design.outline_bodies import Body
from core.design.outlines import CAM, FRAME, ROLLER
from core.design.parts import SIDES
from core.mechanism.kinematics import Kinematics


def outline_axis(drive: Drive) -> complex:
    """Direction of the x axis of the outlines of an arm in the frame of its body: of a flat face it is along the arm.

    The x axis of such a body is the normal m of the face; the arm is along -i m with the contact on the left, along i m on the
    right.
    """
    side = getattr(drive.mechanism, "side", None)
    if side is None or drive.cam is None or not drive.face.straight:
        return 1.0 + 0j
    return -1j * SIDES[side]


def outline_frame(design: Design, kinematics: Kinematics, body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Origin and x axis of the frame in which the outlines of a body of the only drive are given.

    Parameters
    ----------
    design : Design
    kinematics : Kinematics
        Of n positions.
    body : Body

    Returns
    -------
    origin, axis : ndarray (n,) complex [m], ndarray (n,) complex, dimensionless
    """
    theta = kinematics.theta
    origin, axis = np.zeros(theta.size, dtype=complex), np.ones(theta.size, dtype=complex)
    if body.name == FRAME or body.drive is None:
        return origin, axis
    if body.name == CAM:
        return origin, np.exp(1j * design.sense * theta)
    pose = kinematics.follower if body.name == ROLLER else kinematics.bodies[body.name]
    unit = 1.0 if body.name == ROLLER else outline_axis(design.drive)
    return np.broadcast_to(pose.origin[0], theta.shape), np.broadcast_to(pose.unit * unit, theta.shape)
