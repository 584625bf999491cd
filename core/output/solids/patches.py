"""B-spline surfaces of flanks in space, quintic by cam angle and cubic along the roller, within a tolerance of the exact flank."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.motion import Angles
from core.numerics.derivatives import spread
from core.numerics.lazy import checkpoint
from core.output.solids.body import KnotVector
from core.study import Study

if TYPE_CHECKING:
    from core.spatial import MotionRows, SpatialFlank

MM = 1e3
BY_ANGLE, ALONG = 5, 3  # degrees
WIDEST = float(np.deg2rad(12.0))  # cam angle of a span at first
NARROWEST = 1e-6  # [rad] span of a flank that is smooth
MOST_SPANS = 1000  # of a patch, which limits memory
ALONG_SPANS = (1, 2, 4, 8, 16, 32)
ALONG_PART = 0.25  # of the tolerance, for the direction along the roller
SMOOTH = 4  # multiplicity of a knot where the third derivative of the motion jumps
SAME = 1e-9  # relative: difference of accelerations and jerks that counts as rounding
GRID, ACROSS = 12, 5  # samples of a span by cam angle and along the roller
PEAKS, LEVELS, FINE = 8, 2, 7  # samples about which the deviation is refined; how often; points of a finer grid
REFINED = 1.005  # what refining may leave, relative
BETWEEN = 1.1  # second derivatives between the samples of a patch, relative to the largest sample
MOST_ACROSS, MOST_TRIANGLES = 200, 1_000_000  # of a patch


@frozen(eq=False)
class Patch:
    """One B-spline surface of a strip, its control points (m, k, 3) [mm], and whether its normal points out of the cam."""

    by_angle: KnotVector
    along: KnotVector
    points: np.ndarray
    is_along: bool


# -- the exact flank ----------------------------------------------------------------------------------------------


def motion_rows(study: Study, theta: np.ndarray, piece: np.ndarray) -> MotionRows:
    """Motion at given cam angles.

    Parameters
    ----------
    theta : ndarray (n,) [rad]
    piece : ndarray (n,), dimensionless
        Pieces of the motion to which the angles belong.

    Returns
    -------
    MotionRows
    """
    from core.spatial import MotionRows

    state = study.program.state(Angles(theta, piece))
    return MotionRows(theta, *(spread(state.displacement[order], theta.size) for order in range(3)))


Run: TypeAlias = list[tuple[float, float, int]]
"""Consecutive parts of the motion under one patch: their cam angles [rad] and the index of their piece."""


class ExactFlank:
    """A flank under one roller as functions of the cam angle and of the distance along the roller, in mm."""

    def __init__(self, study: Study, side: str, offset: float = 0.0) -> None:
        self.study, self.side = study, side
        self.offset = offset  # of the roller's motion [m or rad]
        self.ends = MM * study.machine.inner, MM * study.machine.outer

    def flank(self, theta: np.ndarray, piece: np.ndarray, u: np.ndarray) -> SpatialFlank:
        """Exact flank at n cam angles and m distances.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
        piece : ndarray (n,), dimensionless
        u : ndarray (m,) [mm]
            Distances along the roller.

        Returns
        -------
        SpatialFlank
        """
        from core.spatial import flank

        rows = motion_rows(self.study, theta, piece).shifted(self.offset)
        return flank(self.study.machine, rows, u[:, None] / MM, self.study.sense, self.side)

    def require_no_edge(self, runs: Sequence[Run]) -> None:
        """Raise NoCam where the flank is undercut at one of many samples."""
        parts = np.linspace(0.0, 1.0, 33)
        theta = np.concatenate([low + (high - low) * parts for run in runs for low, high, _ in run])
        piece = np.repeat([i for run in runs for _, _, i in run], parts.size)
        margin = self.flank(theta, piece, np.linspace(*self.ends, 9)).margin.min(axis=0)
        if margin.min() <= 0.0:
            raise self.edge(float(theta[margin.argmin()]), "is undercut: it has an edge")

    def edge(self, theta: float, problem: str) -> NoCam:
        """Error of a flank with an edge at a cam angle [rad]."""
        from core.spatial import KINDS

        angle, gentler = float(np.rad2deg(theta)), KINDS[self.study.machine.kind].gentler
        remedy = f"use a smaller roller, or {gentler}"
        return NoCam(f"the flank {self.side} {problem}", "cam.roller_radius_mm", remedy, [(angle, angle)])

    def has_kink(self, before: int, after: int) -> bool:
        """Whether the third derivative of the motion jumps between two pieces."""
        return _jumps(self.study, before, after, 3)

    def points(self, theta: np.ndarray, piece: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Points of the flank.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
        piece : ndarray (n,), dimensionless
        u : ndarray (m,) [mm]
            Distances of the second parameter.

        Returns
        -------
        ndarray (n, m, 3) [mm]
        """
        return MM * self.flank(theta, piece, u).cam_point.transpose(2, 1, 0)

    def by_theta(self, theta: float, piece: int, u: np.ndarray) -> np.ndarray:
        """Derivative of the point by cam angle.

        Parameters
        ----------
        theta : float [rad]
        piece : int
        u : ndarray (m,) [mm]
            Distances of the second parameter.

        Returns
        -------
        ndarray (m, 3) [mm/rad]
        """
        flank = self.flank(np.array([theta]), np.array([piece]), u)
        return MM * flank.in_cam(flank.by_theta)[:, :, 0].T


def is_cut(study: Study, before: int, after: int) -> bool:
    """Whether segments of the motion join between two pieces, or its acceleration jumps there."""
    theta = study.program.starts[after]
    is_join = any(abs(join.theta - theta) <= SAME for join in study.program.joins)
    return is_join or _jumps(study, before, after, 2)


def _jumps(study: Study, before: int, after: int, order: int) -> bool:
    """Whether a derivative of the motion differs between the end of one piece and the start of the next."""
    theta = study.program.starts[after]
    state = study.program.state(Angles(np.array([theta, theta]), np.array([before, after])))
    rows = [spread(state.displacement[k], 2) for k in range(1, order + 1)]
    return bool(abs(np.diff(rows[-1])[0]) > SAME * sum(np.abs(row).sum() for row in rows))


# -- fit ----------------------------------------------------------------------------------------------------------


def _along_basis(exact: ExactFlank, runs: Sequence[Run], tolerance: float) -> KnotVector:
    """Equal spans along the roller, so many that the cubic keeps its part of the tolerance."""
    parts = np.linspace(0.02, 0.98, 9)
    theta = np.concatenate([low + (high - low) * parts for run in runs for low, high, _ in run])
    piece = np.repeat([i for run in runs for _, _, i in run], parts.size)
    for count in ALONG_SPANS:
        basis = KnotVector(ALONG, np.linspace(*exact.ends, count + 1), (ALONG + 1, *(1,) * (count - 1), ALONG + 1))
        sites = greville(basis)
        u = np.linspace(*exact.ends, 4 * ACROSS * count + 1)
        fitted = spline_value(
            basis, spline_through(basis, sites, exact.points(theta, piece, sites).transpose(1, 0, 2)), u
        )
        if np.abs(fitted.transpose(1, 0, 2) - exact.points(theta, piece, u)).max() <= ALONG_PART * tolerance:
            return basis
    raise TooFine(tolerance, TOO_MANY_SPANS)


class TooFine(KindynaError):
    """A tolerance [mm] requires more of a file than its limits allow."""

    def __init__(self, tolerance: float, requirement: str, remedy: str = "choose a larger tolerance") -> None:
        super().__init__(f"tolerance {tolerance:g} mm: {requirement}; {remedy}")
        self.requirement, self.remedy = requirement, remedy


OR_STEP = "choose a larger tolerance, or write a STEP file"
TOO_MANY_SPANS = "it requires too many spans of the surface"


def fit_patches(
    exact: ExactFlank, runs: Sequence[Run], tolerance: float, widest: float = WIDEST
) -> tuple[tuple[Patch, ...], float]:
    """Surfaces over parts of the motion, with spans up to a cam angle [rad], and the largest distance [mm] of the exact flank from them.

    Raises
    ------
    NoCam
        The flank has an edge.
    TooFine
        The tolerance requires too many spans.
    """
    exact.require_no_edge(runs)
    along = _along_basis(exact, runs, tolerance)
    fits = [_fit_patch(exact, run, along, tolerance, widest) for run in runs]
    return tuple(patch for patch, _ in fits), max(deviation for _, deviation in fits)


def _fit_patch(
    exact: ExactFlank, pieces: Run, along: KnotVector, tolerance: float, widest: float
) -> tuple[Patch, float]:
    """Surface over consecutive pieces of the motion; spans are halved where it misses the tolerance."""
    edges = [np.linspace(a, b, int(np.ceil((b - a) / widest)) + 1) for a, b, _ in pieces]
    while True:
        checkpoint()
        nodes = np.concatenate([edges[0], *(edge[1:] for edge in edges[1:])])
        owner = np.repeat([i for _, _, i in pieces], [edge.size - 1 for edge in edges])
        points, basis = _interpolate(exact, nodes, owner, along)
        patch = Patch(basis, along, points, True)
        error, worst = _span_errors(exact, patch, nodes, owner)
        bad = error > tolerance / REFINED
        if not bad.any():
            deviation = _refined(exact, patch, nodes, owner, worst) * REFINED
            if deviation <= tolerance:
                break
            bad = error >= error.max() * 0.95
        if nodes.size > MOST_SPANS:
            raise TooFine(tolerance, TOO_MANY_SPANS)
        if np.diff(nodes).min() < NARROWEST:
            raise exact.edge(float(nodes[np.diff(nodes).argmin()]), "has an edge")
        middles = 0.5 * (nodes[:-1] + nodes[1:])[bad]
        edges = [np.sort(np.append(e, middles[(middles > e[0]) & (middles < e[-1])])) for e in edges]
    return Patch(basis, along, points, _is_outward(exact, patch, nodes, owner)), deviation


def _interpolate(
    exact: ExactFlank, nodes: np.ndarray, owner: np.ndarray, along: KnotVector
) -> tuple[np.ndarray, KnotVector]:
    """Control points of the surface with the flank's points at the Greville abscissae, and its tangents at both ends."""
    inner = [SMOOTH if a != b and exact.has_kink(a, b) else 1 for a, b in pairwise(owner.tolist())]
    basis = KnotVector(BY_ANGLE, nodes, (BY_ANGLE + 1, *inner, BY_ANGLE + 1))
    sites, u = greville(basis), greville(along)
    sites = np.concatenate((sites[:1], sites[2:-2], sites[-1:]))  # the tangents replace two of them
    at = owner[np.clip(np.searchsorted(nodes, sites, side="right") - 1, 0, owner.size - 1)]
    slopes = exact.by_theta(nodes[0], owner[0], u), exact.by_theta(nodes[-1], owner[-1], u)
    rows = spline_through(basis, sites, exact.points(sites, at, u), slopes)
    return spline_through(along, u, rows.transpose(1, 0, 2)).transpose(1, 0, 2), basis


def greville(basis: KnotVector) -> np.ndarray:
    """Greville abscissae: means of neighbouring knots, at which a B-spline of m control points is interpolated.

    Returns
    -------
    ndarray (m,) [as the knots]
    """
    knots = np.repeat(basis.knots, basis.multiplicities)
    return np.convolve(knots[1:-1], np.ones(basis.degree) / basis.degree, mode="valid").clip(knots[0], knots[-1])


def spline_through(
    basis: KnotVector, sites: np.ndarray, values: np.ndarray, slopes: tuple[np.ndarray, ...] = ()
) -> np.ndarray:
    """Control points of the B-spline through given points.

    Parameters
    ----------
    basis : KnotVector
    sites : ndarray (n,) [as the knots]
        Parameters of the points.
    values : ndarray (n, ...) [mm]
    slopes : tuple of ndarray (...) [mm per parameter]
        Derivatives at both ends; without them n = m.

    Returns
    -------
    ndarray (m, ...) [mm]
    """
    from scipy.interpolate import make_interp_spline  # imported here to save start-up time

    knots = np.repeat(basis.knots, basis.multiplicities)
    ends = tuple([(1, slope)] for slope in slopes) or None
    sites = sites.copy()
    sites[0], sites[-1] = knots[0], knots[-1]
    return np.asarray(make_interp_spline(sites, values, basis.degree, knots, bc_type=ends).c)


def spline_value(basis: KnotVector, points: np.ndarray, at: np.ndarray, order: int = 0) -> np.ndarray:
    """Points of a B-spline, or their derivative by its parameter.

    Parameters
    ----------
    basis : KnotVector
    points : ndarray (m, ...) [mm]
        Control points.
    at : ndarray (n,) [rad or mm]
        Parameters.
    order : int
        Order of the derivative.

    Returns
    -------
    ndarray (n, ...) [mm per parameter to that order]
    """
    from scipy.interpolate import BSpline  # as above

    spline = BSpline(np.repeat(basis.knots, basis.multiplicities), points, basis.degree)
    return np.asarray((spline.derivative(order) if order else spline)(at))


def patch_points(patch: Patch, theta: np.ndarray, u: np.ndarray, orders: tuple[int, int] = (0, 0)) -> np.ndarray:
    """Points of a patch on a grid, or a derivative of them.

    Parameters
    ----------
    patch : Patch
    theta : ndarray (n,) [rad]
    u : ndarray (m,) [mm]
    orders : tuple of int
        Orders of the derivative by both parameters.

    Returns
    -------
    ndarray (n, m, 3) [mm per parameters to their orders]
    """
    rows = spline_value(patch.by_angle, patch.points, theta, orders[0])
    return spline_value(patch.along, rows.transpose(1, 0, 2), u, orders[1]).transpose(1, 0, 2)


# -- deviation --------------------------------------------------------------------------------------------------


def _normal_distance(
    exact: ExactFlank, patch: Patch, theta: np.ndarray, piece: np.ndarray, u: np.ndarray
) -> np.ndarray:
    """Upper bound (n, m) [mm] of the distance of the exact points from the patch: |n · d| + κ d²/2 for the difference d.

    The curvature κ of the roller exceeds those of the flank but near an edge, where the flank's own is taken.
    """
    flank = exact.flank(theta, piece, u)
    gap = patch_points(patch, theta, u) - MM * flank.cam_point.transpose(2, 1, 0)
    normal = flank.in_cam(flank.normal).transpose(2, 1, 0)
    curvature = np.maximum(np.abs(flank.curvature.T), 1.0 / np.asarray(flank.radius).min()) / MM
    return np.asarray(np.abs((gap * normal).sum(axis=-1)) + 0.5 * curvature * (gap * gap).sum(axis=-1))


Peaks: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Cam angles (p,) [rad], pieces of the motion (p,) and distances (p,) [mm] of the largest samples."""


def _span_errors(exact: ExactFlank, patch: Patch, nodes: np.ndarray, owner: np.ndarray) -> tuple[np.ndarray, Peaks]:
    """Largest sampled distance (m,) [mm] of every span, and the largest samples."""
    parts = (np.arange(GRID) + 0.5) / GRID
    theta = (nodes[:-1, None] + np.diff(nodes)[:, None] * parts).ravel()
    piece = np.repeat(owner, GRID)
    u = np.linspace(*exact.ends, (patch.along.knots.size - 1) * ACROSS + 1)
    error = _normal_distance(exact, patch, theta, piece, u)
    rows, columns = np.unravel_index(np.argsort(-error, axis=None)[:PEAKS], error.shape)
    return error.reshape(owner.size, -1).max(axis=1), (theta[rows], piece[rows], u[columns])


def _refined(exact: ExactFlank, patch: Patch, nodes: np.ndarray, owner: np.ndarray, peaks: Peaks) -> float:
    """Largest distance [mm] near the largest samples, on grids that get finer; angles and distances of all are combined."""
    theta, piece, u = peaks
    rows, steps, result = np.arange(theta.size), np.linspace(-1.0, 1.0, FINE), 0.0
    span = np.clip(np.searchsorted(nodes, theta) - 1, 0, owner.size - 1)
    low, high = nodes[span, None], nodes[span + 1, None]
    width, height = (high - low) / GRID, np.ptp(exact.ends) / (ACROSS * (patch.along.knots.size - 1))
    for _ in range(LEVELS):
        angles = np.clip(theta[:, None] + width * steps, low, high)
        distances = np.clip(u[:, None] + height * steps, *exact.ends)
        error = _normal_distance(exact, patch, angles.ravel(), np.repeat(piece, FINE), distances.ravel())
        result = max(result, float(error.max()))
        at_nodes = error.reshape(rows.size, FINE, rows.size, FINE)[rows, :, rows].reshape(rows.size, -1)
        i, j = np.divmod(at_nodes.argmax(axis=1), FINE)
        theta, u = angles[rows, i], distances[rows, j]
        width, height = 2.0 * width / (FINE - 1), 2.0 * height / (FINE - 1)
    return result


def _is_outward(exact: ExactFlank, patch: Patch, nodes: np.ndarray, owner: np.ndarray) -> bool:
    """Whether ∂θ × ∂u points out of the cam."""
    middle, theta = owner.size // 2, 0.5 * (nodes[owner.size // 2] + nodes[owner.size // 2 + 1])
    flank = exact.flank(np.array([theta]), owner[middle : middle + 1], np.array([0.5 * sum(exact.ends)]))
    across = np.cross(flank.by_theta[:, 0, 0], flank.by_u[:, 0, 0])
    return float(across @ flank.normal[:, 0, 0]) < 0.0


# -- triangles ----------------------------------------------------------------------------------------------------


def patch_triangles(patch: Patch, tolerance: float) -> np.ndarray:
    """Triangles of a patch, counter-clockwise seen from outside the cam.

    Parameters
    ----------
    patch : Patch
    tolerance : float [mm]
        Largest distance of the patch from the triangles.

    Returns
    -------
    ndarray (n, 3, 3) [mm]
    """
    grid = patch_grid(patch, *grid_steps(patch, tolerance))
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    corners = np.concatenate([np.stack(three, axis=2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))])
    return corners if patch.is_along else corners[:, ::-1]


def patch_grid(patch: Patch, by_angle: int, along: int) -> np.ndarray:
    """Points of a patch at the ends of n and m equal steps.

    Returns
    -------
    ndarray (n + 1, m + 1, 3) [mm]
    """
    (first, *_, last), (low, *_, high) = patch.by_angle.knots, patch.along.knots
    return patch_points(patch, np.linspace(first, last, by_angle + 1), np.linspace(low, high, along + 1))


def grid_steps(patch: Patch, tolerance: float) -> tuple[int, int]:
    """Fewest steps by cam angle and along the roller whose triangles keep a tolerance [mm]; more steps keep it too.

    Triangles of equal steps h, k are within (h²|∂θθ| + 2hk|∂θu| + k²|∂uu|)/8 of the patch. Of ∂θu only the part along the
    normal counts, of ∂θθ and ∂uu that across the line: chords of the patch's rim deviate in its plane too.
    """
    theta, u = (np.linspace(basis.knots[0], basis.knots[-1], 65) for basis in (patch.by_angle, patch.along))
    by_theta, by_u = patch_points(patch, theta, u, (1, 0)), patch_points(patch, theta, u, (0, 1))
    normal = np.cross(by_theta, by_u)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    length, width = np.ptp(patch.by_angle.knots), np.ptp(patch.along.knots)

    def across_line(second: np.ndarray, first: np.ndarray) -> float:
        along = (second * first).sum(axis=-1, keepdims=True) / (first * first).sum(axis=-1, keepdims=True)
        return float(np.linalg.norm(second - along * first, axis=-1).max())

    bend = BETWEEN * length**2 / 8.0 * across_line(patch_points(patch, theta, u, (2, 0)), by_theta)
    mixed = np.abs((patch_points(patch, theta, u, (1, 1)) * normal).sum(axis=-1)).max()
    twist = BETWEEN * length * width / 4.0 * float(mixed)
    arch = BETWEEN * width**2 / 8.0 * across_line(patch_points(patch, theta, u, (0, 2)), by_u)
    m = np.arange(1, MOST_ACROSS + 1)
    rest = tolerance - arch / m**2
    with np.errstate(divide="ignore", invalid="ignore"):
        n = np.where(rest > 0.0, (twist / m + np.sqrt((twist / m) ** 2 + 4.0 * bend * rest)) / (2.0 * rest), np.inf)
    best = int(np.argmin(n * m))
    if not n[best] * m[best] <= MOST_TRIANGLES:
        raise TooFine(tolerance, "it requires too many triangles", OR_STEP)
    return int(np.ceil(n[best])) + 1, int(m[best])
