"""An instant centre in homogeneous coordinates: at infinity is a value, not a division by zero."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from core.frozen import frozen

Key = tuple[str, str]
"""Two bodies, in the order of a mechanism's."""
FAR = 1e12  # sizes of the mechanism: beyond this a centre counts as at infinity


def key_of(a: str, b: str, order: Mapping[str, int]) -> Key:
    """The key of two bodies, given in either order; ``order``: body -> its place in the mechanism's order."""
    return (a, b) if order[a] < order[b] else (b, a)


@frozen(eq=False)
class Centres:
    """point (n,) complex and weight (n,): the centre is point/weight; weight 0 = at infinity in direction point.

    error_bound: how many times the rounding of the centres that it was constructed from it carries, as a vector (point/size,
    weight) of length 1; (n,) or one for all
    """

    point: np.ndarray
    weight: np.ndarray
    error_bound: np.ndarray | float = 1.0

    @property
    def finite(self) -> np.ndarray:
        """Places (n,) complex [m], inf where the centre is at infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.weight == 0.0, complex(np.inf, np.inf), self.point / self.weight)

    @property
    def homogeneous(self) -> np.ndarray:
        """(3, n): x, y [m] and weight."""
        return np.array([self.point.real, self.point.imag, self.weight])

    def far(self, size: float) -> np.ndarray:
        """(n,) where the centre is at infinity, or so far away that rounding cannot tell."""
        return np.abs(self.weight) * (FAR * size) <= np.abs(self.point)

    @property
    def direction(self) -> np.ndarray:
        """(n,) [rad] of a centre at infinity, 0 ... π."""
        angle = np.remainder(np.angle(self.point), np.pi)
        return np.where(angle >= np.pi, 0.0, angle)

    def scaled(self, size: float) -> Centres:
        """The same centres with |point|/size and weight on the unit circle."""
        length = np.hypot(np.abs(self.point) / size, self.weight)
        length = np.where(length == 0.0, 1.0, length)
        return Centres(self.point / length, self.weight / length, self.error_bound)
