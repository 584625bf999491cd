"""Least squares of many four-bars to the points of a path at once, by the method of Levenberg and Marquardt.

The unknowns are crank, coupler, rocker, frame, the tracer, the crank's pivot and the frame's direction, and an angle of the crank for
each point, which is eliminated from the normal equations; where the driver's angles at the points are given, only their start.

Source: K. Levenberg, Quart. Appl. Math. 2 (1944) 164-168; D. W. Marquardt, J. SIAM 11 (1963) 431-441; the elimination is that of
orthogonal distance regression, P. T. Boggs, R. H. Byrd, R. B. Schnabel, SIAM J. Sci. Stat. Comput. 8 (1987) 1052-1078.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.synthesis.curves import Bars, trace

TINY, INSIDE = 1e-12, 0.98  # a length that is 0; the part of the ratio that costs nothing
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING, LESS = 1e-3, 1e-12, 1e12, 0.2
CONVERGED = 1e-10  # of the sum of squares: a step that decreases it by less is the last
EXACT = 1e-24  # mean square, of the size of the path squared, that is rounding
LONGEST_TURN = 0.5  # of the crank at a point in a step [rad]
SAME = 1e-2  # of the largest length: four-bars that differ by less, or their cognates, are one


@frozen(eq=False)
class PlacedBars:
    """Four-bars in the plane, each with an angle of the crank for each point of a path.

    Attributes
    ----------
    bars : Bars
        Arrays (m, 1) [mm].
    pivot : ndarray (m, 1) complex [mm]
        Pivots of the cranks.
    direction : ndarray (m, 1) [rad]
        Directions of the frames.
    angles : ndarray (m, n) [rad]
        Angles of the cranks from their frames.
    """

    bars: Bars
    pivot: np.ndarray
    direction: np.ndarray
    angles: np.ndarray

    def at(self, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Tracer, its derivative and the coupler's direction in the plane, as of ``trace``.

        Parameters
        ----------
        angles : ndarray (m, n) [rad]
            Angles of the cranks.

        Returns
        -------
        tuple of ndarray (m, n) complex [mm], [mm/rad], dimensionless
        """
        turn = np.exp(1j * self.direction)
        point, slope, coupler = trace(self.bars, angles)
        return self.pivot + turn * point, turn * slope, turn * coupler

    def rows(self, index: Sequence[int]) -> PlacedBars:
        """Some of the four-bars, by their indices."""
        index = list(index)
        bars = Bars(*(values[index] for values in self.bars))
        return PlacedBars(bars, self.pivot[index], self.direction[index], self.angles[index])

    def with_angles(self, angles: np.ndarray) -> PlacedBars:
        """The four-bars with other angles at the points.

        Parameters
        ----------
        angles : ndarray (m, n) [rad]
        """
        return PlacedBars(self.bars, self.pivot, self.direction, angles)


class _Values(NamedTuple):
    """Residuals (m, 2n + 1), their slopes (m, 2n + 1, k) by the unknowns and (m, n) complex by the angles, sums of squares (m,)."""

    residuals: np.ndarray
    slopes: np.ndarray
    by_angle: np.ndarray
    squares: np.ndarray


@frozen(eq=False)
class PathFit:
    """Least squares of the distances at the points of a path, in units of its size.

    Attributes
    ----------
    points : ndarray (n,) complex [mm]
    weights : ndarray (n,), dimensionless
        Factors of the distances.
    timing : ndarray (n,) [rad], or None
        Angles of the driver at the points, from an unknown start.
    ratio : float
        Ratio of the longest to the shortest link; a larger one costs as much as a distance. Without it, some four-bars grow without
        end.
    """

    points: np.ndarray
    weights: np.ndarray
    timing: np.ndarray | None
    ratio: float

    @property
    def unit(self) -> float:
        """Size of the path [mm]."""
        return float(np.abs(self.points - self.points.mean()).max())

    def refined(self, starts: PlacedBars, steps: int) -> tuple[PlacedBars, np.ndarray]:
        """Four-bars after some steps of the least squares.

        Parameters
        ----------
        starts : PlacedBars
        steps : int

        Returns
        -------
        PlacedBars
        ndarray (m,), dimensionless
            Sums of squares; infinite where the links do not meet.
        """
        x, angles, side = self._unknowns(starts), starts.angles.copy(), starts.bars.side
        values = self._values(x, angles, side)
        damping, growth = np.full(len(x), FIRST_DAMPING), np.full(len(x), 2.0)
        active = np.isfinite(values.squares)
        for _ in range(steps):
            checkpoint()
            index = np.flatnonzero(active)
            if not index.size:
                break
            step, turn = self._step(_Values(*(array[index] for array in values)), damping[index])
            new_x, new_angles, before = x[index] + step, angles[index] + turn, values.squares[index]
            trial = self._values(new_x, new_angles, side[index])
            is_better = trial.squares < before
            better, worse = index[is_better], index[~is_better]
            x[better], angles[better] = new_x[is_better], new_angles[is_better]
            for array, new in zip(values, trial, strict=True):
                array[better] = new[is_better]
            damping[better], growth[better] = np.maximum(LESS * damping[better], LEAST_DAMPING), 2.0
            damping[worse] *= growth[worse]
            growth[worse] *= 2.0
            active[index[is_better & (before - trial.squares <= CONVERGED * before)]] = False
            active &= (damping <= MOST_DAMPING) & (values.squares > EXACT * self.points.size)
        return self._placed(x, angles, side, self.unit), values.squares

    def _unknowns(self, placed: PlacedBars) -> np.ndarray:
        """Unknowns (m, k): lengths, tracer and pivot by their parts in units, the direction, and the start of the angles."""
        bars, pivot = placed.bars, placed.pivot
        lengths = np.hstack((*bars[:4], bars.tracer.real, bars.tracer.imag, pivot.real, pivot.imag)) / self.unit
        if self.timing is None:
            return np.hstack((lengths, placed.direction))
        start = np.angle(np.exp(1j * (placed.angles - self.timing)).sum(axis=1, keepdims=True))
        return np.hstack((lengths, placed.direction, start))

    def _placed(self, x: np.ndarray, angles: np.ndarray, side: np.ndarray, unit: float) -> PlacedBars:
        crank, coupler, rocker, frame, u, v, px, py, direction, *start = x.T[:, :, None]
        bars = Bars(unit * crank, unit * coupler, unit * rocker, unit * frame, unit * (u + 1j * v), side)
        at = angles if self.timing is None else self.timing + start[0]
        return PlacedBars(bars, unit * (px + 1j * py), direction, at)

    def _values(self, x: np.ndarray, angles: np.ndarray, side: np.ndarray) -> _Values:
        placed = self._placed(x, angles, side, 1.0)
        z, slope, coupler = placed.at(placed.angles)
        turn = np.exp(1j * placed.direction)
        columns = [turn * column for column in _slopes_by_lengths(placed.bars, placed.angles)]
        columns += [coupler, 1j * coupler, np.ones_like(z), 1j * np.ones_like(z), 1j * (z - placed.pivot)]
        if self.timing is not None:
            columns.append(slope)
        slopes = self.weights[:, None] * np.stack(columns, axis=-1)
        errors = self.weights * (z - self.points / self.unit)
        excess, by_length = self._excess(x)
        residuals = np.concatenate((errors.real, errors.imag, excess), axis=1)
        squares = (residuals**2).sum(axis=1)
        is_valid = np.isfinite(squares) & np.isfinite(slopes).all(axis=(1, 2))
        return _Values(
            residuals,
            np.concatenate((slopes.real, slopes.imag, by_length), axis=1),
            self.weights * slope,
            np.where(is_valid, squares, np.inf),
        )

    def _excess(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Logarithm (m, 1) by which the ratio of the lengths is too large, 0 where it is not, and its slopes (m, 1, k)."""
        lengths, row = np.abs(x[:, :4]), np.arange(len(x))
        longest, shortest = lengths.argmax(axis=1), lengths.argmin(axis=1)
        excess = np.log(lengths[row, longest] / (lengths[row, shortest] + TINY)) - np.log(INSIDE * self.ratio)
        slopes = np.zeros((len(x), 1, x.shape[1]))
        slopes[row, 0, longest] = 1.0 / x[row, longest]
        slopes[row, 0, shortest] -= 1.0 / (x[row, shortest] + np.copysign(TINY, x[row, shortest]))
        slopes[excess <= 0.0] = 0.0
        return np.maximum(excess, 0.0)[:, None], slopes

    def _step(self, values: _Values, damping: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Damped step of the unknowns (m, k), and of the angles at the points (m, n) where these are unknown too."""
        n, damping = self.points.size, damping[:, None]
        transposed = np.swapaxes(values.slopes, 1, 2)
        normal = transposed @ values.slopes
        right = transposed @ values.residuals[..., None]
        diagonal = np.einsum("mii->mi", normal)
        added = damping * diagonal + TINY * diagonal.max(axis=1, keepdims=True)
        if self.timing is None:
            real, imag = values.by_angle.real, values.by_angle.imag
            squares = (1.0 + damping) * np.abs(values.by_angle) ** 2 + TINY
            mixed = real[..., None] * values.slopes[:, :n] + imag[..., None] * values.slopes[:, n : 2 * n]
            by_angles = real * values.residuals[:, :n] + imag * values.residuals[:, n : 2 * n]
            shares = np.swapaxes(mixed / squares[..., None], 1, 2)
            normal = normal - shares @ mixed
            right = right - shares @ by_angles[..., None]
        k = np.arange(values.slopes.shape[2])
        normal[:, k, k] += added
        step = -np.linalg.solve(normal, right)
        if self.timing is not None:
            return step[..., 0], np.zeros_like(values.by_angle.real)
        turn = -(by_angles + (mixed @ step)[..., 0]) / squares
        return step[..., 0], np.clip(turn, -LONGEST_TURN, LONGEST_TURN)


def _slopes_by_lengths(bars: Bars, angle: np.ndarray) -> list[np.ndarray]:
    """Derivatives (m, n) of the tracer of ``trace`` by crank, coupler, rocker and frame."""
    unit = np.exp(1j * angle)
    _, _, direction = trace(bars, angle)
    rocker = np.conj(bars.crank * unit + bars.coupler * direction - bars.frame)
    with np.errstate(invalid="ignore", divide="ignore"):
        lever = 1j * bars.tracer * direction / (rocker * 1j * bars.coupler * direction).real
        return [
            unit - (rocker * unit).real * lever,
            -(rocker * direction).real * lever,
            bars.rocker * lever,
            rocker.real * lever,
        ]


def distinct(placed: PlacedBars, count: int) -> list[int]:
    """Indices of the first four-bars that differ from each other and from each other's cognates, at most a number of them.

    With k = tracer/coupler the cognates of pivots O₂, O₄ and links a, b, c have the pivots O₂ and C = O₂ + k(O₄ - O₂) with the links
    |k|b, |k|a, |k|c, and O₄ and C with |1 - k|b, |1 - k|c, |1 - k|a.
    """
    lengths = np.abs(np.hstack(placed.bars[:4])).T
    crank, coupler, rocker = lengths[:3]
    first = placed.pivot[:, 0]
    second = (placed.pivot + placed.bars.frame * np.exp(1j * placed.direction))[:, 0]
    k = (placed.bars.tracer / placed.bars.coupler)[:, 0]
    third, near, far = first + k * (second - first), np.abs(k), np.abs(1.0 - k)
    linkages = (
        (first, second, crank, coupler, rocker),
        (first, third, near * coupler, near * crank, near * rocker),
        (second, third, far * coupler, far * rocker, far * crank),
    )
    both_ways = [row for a, b, *links in linkages for row in ((a, b, *links), (b, a, *links[::-1]))]
    numbers = np.stack([np.stack((a, b, *links), axis=-1) for a, b, *links in both_ways], axis=1)  # (m, 6, 5)
    chosen: list[int] = []
    for i, longest in enumerate(lengths.max(axis=0)):
        differences = np.abs(numbers[chosen] - numbers[i, 0]).max(axis=2)
        if len(chosen) < count and (differences > SAME * longest).all():
            chosen.append(i)
    return chosen
