"""Checks of a cam by other ways than the one it was computed: the instant centre, and brute force."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from core.cam.faces import row_of
from core.cam.shape import CamShape
from core.findings import LEAST_BOUND, Residual

POSITIONS = 120  # of the cam at which its profile is searched


def centre_residual(shape: CamShape) -> np.ndarray:
    """t against i(φ'-d)(R-Q) (n,), relative to the terms of the latter: relative velocity and instant centre Q must
    say the same. The centre's weight is φ'-d, so that i(weight R - point) stands at infinity too."""
    by_place, by_centre = shape.centre.weight * shape.reference, shape.centre.point
    return np.abs(shape.relative_velocity - 1j * (by_place - by_centre)) / (np.abs(by_place) + np.abs(by_centre))


def gaps(shape: CamShape, face: Any, positions: int = POSITIONS) -> np.ndarray:
    """Least distance of any profile point from the face [m], by brute force at ``positions`` cam positions (m,): negative where
    the profile enters it, positive where it stays away from it."""
    return row_of(face).gaps(shape, face, positions)


def tangency_residual(shape: CamShape, face: Any, reach: float, positions: int = POSITIONS) -> float:
    """The largest of the gaps, relative to ``reach``, the distance of the face's reference on the base circle."""
    return float(np.abs(gaps(shape, face, positions)).max()) / reach


def tangency(shape: CamShape, face: Any, reach: float, derived: float, undercut: Callable[[], bool]) -> Residual:
    """The proof that the profile touches the face and enters it nowhere, against ``derived`` or the promised accuracy.

    At every angle the profile's own point must lie on the face, and no other point beyond it. Where the cam is undercut, which
    its curvature says, the profile crosses itself: what enters the face there is cut away as the cam is made, and nothing
    touches it. Such positions are left out; the finding names the undercut.
    """
    own = float(row_of(face).own_distance(shape, face).max())
    by_search = gaps(shape, face)
    entered = -by_search > max(derived, LEAST_BOUND) * reach
    left_out = int(np.count_nonzero(entered)) if entered.any() and undercut() else 0
    held = by_search[~entered] if left_out else by_search
    worst = max(own, float(np.abs(held).max(initial=0.0)))
    return Residual(worst / reach, derived, left_out, f"{by_search.size} positions (undercut)")
