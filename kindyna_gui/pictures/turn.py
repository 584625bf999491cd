"""Samples over a turn: all the way round, or only where a crank that cannot turn fully is able to stand."""

from __future__ import annotations

from math import pi

import numpy as np

from core.frozen import frozen
from core.study import Study

TURN = 2.0 * pi


@frozen(eq=False)
class TurnSamples:
    """The points of a curve over the turn: angles (m,) [deg] and the sample of each (m,); -1 is a gap."""

    angles: np.ndarray
    samples: np.ndarray

    def of(self, values: np.ndarray, gain: float = 0.0) -> np.ndarray:
        """Values (n,) along the curve (m,), NaN in gaps; gain: what they grow by in a turn."""
        found = np.where(self.samples < 0, np.nan, values[self.samples])
        return found + gain * (self.angles >= 360.0) if gain else found

    def alike(self, other: TurnSamples | None) -> bool:
        """Whether others stand at the same angles."""
        return other is not None and np.array_equal(self.angles, other.angles)


def line_of(study: Study) -> TurnSamples:
    """Closed over the whole turn; with gaps where the mechanism cannot stand."""
    degrees, n = np.rad2deg(study.theta), study.theta.size
    if n == study.samples:
        return TurnSamples(np.append(degrees, 360.0), np.append(np.arange(n), 0))
    cuts = np.flatnonzero(np.diff(degrees) > 1.5 * 360.0 / study.samples) + 1
    angles, samples = degrees, np.arange(n)
    if n and degrees[0] == 0.0 and 360.0 - degrees[-1] < 1.5 * 360.0 / study.samples:
        angles, samples = np.append(angles, 360.0), np.append(samples, 0)
    return TurnSamples(np.insert(angles, cuts, degrees[cuts]), np.insert(samples, cuts, -1))


def nearest(theta: np.ndarray, angle: float) -> int:
    """The sample (of n angles in rising order [rad]) that is nearest to an angle, round the turn."""
    n = theta.size
    at = int(np.searchsorted(theta, angle))
    before, after = (at - 1) % n, at % n
    gaps = [abs((float(theta[i]) - angle + pi) % TURN - pi) for i in (before, after)]
    return before if gaps[0] < gaps[1] else after
