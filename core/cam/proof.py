"""Checks of a cam by other ways than the one it was computed: the instant centre, and brute force."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.cam.shape import CamShape
from core.findings import LEAST_BOUND, Residual


def centre_residual(shape: CamShape) -> np.ndarray:
    """t against i(φ'-d)(R-Q) (n,), relative to the terms of the latter: relative velocity and instant centre Q must
    say the same. The centre's weight is φ'-d, so that i(weight R - point) stands at infinity too."""
    by_place, by_centre = shape.centre.weight * shape.reference, shape.centre.point
    return np.abs(shape.relative_velocity - 1j * (by_place - by_centre)) / (np.abs(by_place) + np.abs(by_centre))


def gaps(shape: CamShape, radius: float, positions: int = 120) -> np.ndarray:
    """Least distance from the roller's centre to all profile points, less its radius [m], by brute force at ``positions``
    cam positions (m,): negative where the profile enters the roller, positive where it stays away from it."""
    flank = shape.flank
    step = max(1, flank.pitch.size // positions)
    # one by one, so that memory stays small for a million points
    return np.array([float(np.abs(flank.profile - centre).min()) - radius for centre in flank.pitch[::step]])


def tangency_residual(shape: CamShape, radius: float, reach: float, positions: int = 120) -> float:
    """The largest of the gaps, relative to ``reach``, the roller's distance on the base circle."""
    return float(np.abs(gaps(shape, radius, positions)).max()) / reach


def tangency(shape: CamShape, radius: float, reach: float, derived: float, undercut: Callable[[], bool]) -> Residual:
    """The proof that the profile touches the roller and enters it nowhere, against ``derived`` or the promised accuracy.

    At every angle the profile's own point must be the roller's radius away from its centre, and no other point nearer. Where
    the cam is undercut, which the pitch curve's curvature says, the profile crosses itself: what enters the roller there is
    cut away as the cam is made, and no roller touches it. Such positions are left out; the finding names the undercut.
    """
    flank = shape.flank
    own = float(np.abs(np.abs(flank.profile - flank.pitch) - radius).max())
    by_search = gaps(shape, radius)
    entered = -by_search > max(derived, LEAST_BOUND) * reach
    left_out = int(np.count_nonzero(entered)) if entered.any() and undercut() else 0
    held = by_search[~entered] if left_out else by_search
    worst = max(own, float(np.abs(held).max(initial=0.0)))
    return Residual(worst / reach, derived, left_out, f"{by_search.size} positions (undercut)")
