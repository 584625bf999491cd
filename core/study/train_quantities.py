"""Motion of a valve through its train, as functions of a study in SI units."""

from __future__ import annotations

import numpy as np

from core.design import Design, si
from core.numerics.derivatives import Derivatives
from core.study.study import Study

PUSHROD = frozenset({"pushrod"})
TRAINS = frozenset({"rocker"}) | PUSHROD
"""Kinds of followers that contain a valve."""
TRAIN_PAIRS = (
    ("pad", "Pad on the valve", "F_p", TRAINS), ("valve_guide", "Valve guide", "V", TRAINS),
    ("lower_ball", "Lower ball", "S", PUSHROD), ("upper_ball", "Upper ball", "U", PUSHROD),
)  # fmt: skip
"""Pairs of valve trains with their labels, symbols and kinds."""
TRAIN_NAMES = tuple(name for name, *_ in TRAIN_PAIRS)
"""Names of these pairs."""


def lash(design: Design) -> float:
    """Lash at the valve's tip [m], 0 without a table [valve]; with many designs a column."""
    valve = design.drive.valve
    return 0.0 if valve is None else si(valve).lash


def valve_motion(study: Study) -> Derivatives:
    """Motion of the valve by cam angle, with the lash not taken off; 0 where the train holds the valve closed.

    It is a coordinate of a pushrod train, and of any other train the motion of the drive.

    Parameters
    ----------
    study : Study

    Returns
    -------
    Derivatives
        (n,) [m] and its derivatives by cam angle.
    """
    return study.linkage.coordinates.get("valve_guide", study.motion.displacement)


def valve_lift(study: Study, order: int = 0) -> np.ndarray:
    """Lift of the valve, y_v = max(y_o - λ, 0) with the lash λ, or its derivative by time: ẏ_v = ω y′_v, ÿ_v = ω² y″_v.

    Parameters
    ----------
    study : Study
    order : int
        Order of the derivative, 0 to 2.

    Returns
    -------
    ndarray (n,) [m, per s^order]
    """
    motion, free = valve_motion(study), lash(study.design)
    if not order:
        return np.maximum(motion[0] - free, 0.0)
    rate = motion[order] * study.omega**order
    return np.where(motion[0] > free, rate, 0.0) if np.any(free) else rate


def levers(study: Study) -> tuple[np.ndarray, np.ndarray]:
    """Levers of a rocker: ∂y_v/∂φ of the valve at the pad, and the arm; of a pushrod train ∂y/∂φ of the tappet in place of the arm.

    Parameters
    ----------
    study : Study

    Returns
    -------
    valve, cam : ndarray (n,) [m]
    """
    turn = np.abs(study.linkage.slip("pivot"))
    arm = getattr(si(study.design.drive.follower), "arm", 1.0 / turn)
    return np.abs(study.linkage.slip("valve_guide")) / turn, np.broadcast_to(arm, turn.shape)


def rocker_ratio(study: Study) -> np.ndarray:
    """Ratio of a rocker, i = h/l: lever of the pad across the valve over the arm, or of valve over tappet, dy_v/dy.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,), dimensionless
    """
    valve, cam = levers(study)
    return valve / cam


def pad_angle(study: Study) -> np.ndarray:
    """Angle β of the pad's arm from the direction in which the valve opens.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [rad]
    """
    follower, rocker = si(study.design.drive.follower), study.linkage.bodies["rocker"]
    return np.angle(rocker.unit) + follower.pad_angle - follower.valve_direction


def closed_pad_angle(study: Study) -> float:
    """Angle β0 of the pad's arm from the direction of the valve [rad], with the valve closed."""
    follower = si(study.design.drive.follower)
    return float(study.linkage.base["rocker"][0] + follower.pad_angle - follower.valve_direction)
