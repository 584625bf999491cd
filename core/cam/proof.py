"""Checks of a cam by other ways than the one it was computed: the instant centre, and brute force."""

from __future__ import annotations

import numpy as np

from core.cam.shape import CamShape
from core.train import Train


def centre_residual(train: Train, shape: CamShape) -> np.ndarray:
    """t against i(φ'-d)(R-Q) (n,), relative to the terms of the latter: relative velocity and instant centre Q must
    say the same. Written as i(weight R - point), it stands at infinity too."""
    centre, turn = shape.centre, train.follower.turn[1] - shape.sense
    # the centre's weight is φ'-d for a pivot and 1 for a guide, where the follower does not turn
    scale = turn / np.where(centre.weight == 0.0, 1.0, centre.weight)
    scale = np.where(centre.weight == 0.0, 1.0, scale)
    by_centre = 1j * scale * (centre.weight * shape.reference - centre.point)
    size = np.abs(scale) * (np.abs(centre.weight * shape.reference) + np.abs(centre.point))
    return np.abs(shape.relative_velocity - by_centre) / size


def tangency_residual(shape: CamShape, radius: float, reach: float, positions: int = 120) -> float:
    """How far the profile enters the roller or stays away from it at worst, by brute force, relative to ``reach``, the
    roller's distance on the base circle: at ``positions`` cam positions the least distance from roller centre to all
    profile points must be the roller's radius [m]."""
    flank = shape.flank
    step = max(1, flank.pitch.size // positions)
    # one by one, so that memory stays small for a million points
    worst = 0.0
    for centre in flank.pitch[::step]:
        worst = max(worst, abs(float(np.abs(flank.profile - centre).min()) - radius))
    return worst / reach
