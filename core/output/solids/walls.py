"""Walls of the grooves of a cam in space: flanks between its floor and its blank instead of the ends of the roller."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from core.errors import NoCam
from core.output.solids.patches import MM, ExactFlank, Run, motion_rows
from core.study import Study

if TYPE_CHECKING:
    from core.spatial import SpatialFlank

NEWTON = 12  # steps, more than convergence takes
CONVERGED = 1e-9  # last step relative to the size: the next one would be its square
REACHED = 1e-9  # relative difference of depths that counts as rounding
SAMPLES = 65  # of a piece of the motion


class GrooveWall(ExactFlank):
    """A flank as a function of the cam angle and of the depth in the groove.

    The depth is the distance from the axis of the cam; of a globoidal cam from the circle on which the axis of the turret moves around
    the cam, √((D - ρ)² + z²) at the distance ρ from the axis of the cam.
    """

    def __init__(self, study: Study, side: str, offset: float = 0.0, *, ends: tuple[float, float]) -> None:
        super().__init__(study, side, offset)
        self.ends = ends
        self._centre = 0.0 if study.machine.is_cylindrical else study.machine.lever

    def _depth(self, point: np.ndarray) -> np.ndarray:
        """Depth (m, n) [m] of points (3, m, n) [m]."""
        across = np.hypot(point[0], point[1])
        return np.asarray(np.hypot(self._centre - across, point[2]) if self._centre else across)

    def _slope(self, point: np.ndarray, tangent: np.ndarray) -> np.ndarray:
        """Derivative (m, n) of the depth along tangents (3, m, n)."""
        across = np.hypot(point[0], point[1])
        outwards = (point[0] * tangent[0] + point[1] * tangent[1]) / across
        if not self._centre:
            return np.asarray(outwards)
        return np.asarray(((across - self._centre) * outwards + point[2] * tangent[2]) / self._depth(point))

    def flank(self, theta: np.ndarray, piece: np.ndarray, u: np.ndarray) -> SpatialFlank:
        """Exact flank at depths, which Newton's method converts to distances along the roller.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
        piece : ndarray (n,), dimensionless
        u : ndarray (m,) [mm]
            Depths.

        Returns
        -------
        SpatialFlank
        """
        from core.spatial import flank

        machine, rows = self.study.machine, motion_rows(self.study, theta, piece).shifted(self.offset)
        depth = u[:, None] / MM + 0.0 * theta
        distance = depth
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # of a flank that does not reach a depth
            for _ in range(NEWTON):
                surface = flank(machine, rows, distance, self.study.sense, self.side)
                step = (self._depth(surface.point) - depth) / self._slope(surface.point, surface.by_u)
                distance = distance - step
                if np.abs(step).max() <= CONVERGED * self.ends[1] / MM:
                    break
            return flank(machine, rows, distance, self.study.sense, self.side)

    def by_theta(self, theta: float, piece: int, u: np.ndarray) -> np.ndarray:
        """Derivative of the point by cam angle at constant depth.

        Parameters
        ----------
        theta : float [rad]
        piece : int, dimensionless
        u : ndarray (m,) [mm]
            Depths.

        Returns
        -------
        ndarray (m, 3) [mm/rad]
        """
        surface = self.flank(np.array([theta]), np.array([piece]), u)
        by_theta, by_u = surface.by_theta, surface.by_u
        share = self._slope(surface.point, by_theta) / self._slope(surface.point, by_u)
        return MM * surface.in_cam(by_theta - share * by_u)[:, :, 0].T

    def rims(self, runs: Sequence[Run]) -> SpatialFlank:
        """Exact flank at both ends (2, n), at many cam angles. Raises NoCam where it does not extend from end to end."""
        theta = np.concatenate([np.linspace(low, high, SAMPLES) for run in runs for low, high, _ in run])
        piece = np.repeat([i for run in runs for _, _, i in run], SAMPLES)
        rims = self.flank(theta, piece, np.array(self.ends))
        reached = np.abs(MM * self._depth(rims.point) - np.array(self.ends)[:, None]) <= REACHED * self.ends[1]
        missed = ~(reached & (rims.u > 0.0)).all(axis=0)
        if missed.any():
            angle = float(np.rad2deg(theta[missed.argmax()]))
            gentler = "shorten the blank" if self.study.machine.is_turret else "swing the arm less"
            raise NoCam(
                f"the flank {self.side} does not extend from the floor of the groove to the blank",
                "cam.roller_inner_mm",
                f"enlarge it, or {gentler}",
                [(angle, angle)],
            )
        return rims

    def require_no_edge(self, runs: Sequence[Run]) -> None:
        """Raise NoCam where the flank does not extend from end to end, or is undercut at one of many samples."""
        if self.rims(runs).radius.min() <= 0.0:
            raise NoCam(
                f"{self.study.design.drive.cam.roller_taper_deg:g} deg: the cone of the roller ends in a point within the groove",
                "cam.roller_taper_deg",
                "choose a smaller angle, or a groove that is not deeper than the roller is long",
            )
        super().require_no_edge(runs)
