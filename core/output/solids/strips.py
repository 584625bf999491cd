"""Flanks of a cam in space as B-spline surfaces, quintic by cam angle and cubic along the roller, within a tolerance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from core.errors import KindynaError, NoCam
from core.frozen import frozen
from core.motion import TURN, Angles
from core.numerics.derivatives import spread
from core.numerics.lazy import checkpoint
from core.output.solids.body import Body, Edge, Face, KnotVector, SplineCurve, SplineSurface
from core.study import Study

if TYPE_CHECKING:
    from core.spatial import MotionRows, SpatialFlank

MM = 1e3
BY_ANGLE, ALONG = 5, 3  # degrees
WIDEST = np.deg2rad(12.0)  # cam angle of a span at first
MOST_SPANS = 1000  # of a patch, which limits memory
ALONG_SPANS = (1, 2, 4, 8, 16, 32)
ALONG_PART = 0.25  # of the tolerance, for the direction along the roller
SMOOTH = 4  # multiplicity of a knot where the third derivative of the motion jumps
SAME = 1e-9  # relative: difference of accelerations and jerks that counts as rounding
SHORTEST = 1e-6  # [rad] a shorter part of a piece of the motion is left out
GRID, ACROSS = 12, 5  # samples of a span by cam angle and along the roller
PEAKS, LEVELS, FINE = 8, 2, 7  # samples about which the deviation is refined; how often; points of a finer grid
REFINED = 1.005  # what refining may leave, relative
BISECTIONS = 60
BETWEEN = 1.1  # second derivatives between the samples of a patch, relative to the largest sample
MOST_ACROSS, MOST_TRIANGLES = 200, 1_000_000  # of a patch


@frozen
class Strip:
    """Part of a flank: the side, the number and the offset [m or rad] of its roller, and its cam angles [rad].

    ``is_closed``: it runs around the cam and ends where it begins.
    """

    side: str
    roller: int
    offset: float
    low: float
    high: float
    is_closed: bool


@frozen(eq=False)
class Patch:
    """One B-spline surface of a strip, its control points (m, k, 3) [mm], and whether its normal points out of the cam."""

    by_angle: KnotVector
    along: KnotVector
    points: np.ndarray
    is_along: bool


@frozen(eq=False)
class Strips:
    """Flanks of a cam in space, and the largest distance [mm] of the exact flanks from them."""

    strips: tuple[Strip, ...]
    patches: tuple[tuple[Patch, ...], ...]
    deviation: float
    volume: None = None
    points: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def bodies(self) -> tuple[Body, ...]:
        """An open sheet for each strip, named by its side and roller."""
        return tuple(
            strip_body(f"{strip.side} {strip.roller}", patches, strip.is_closed)
            for strip, patches in zip(self.strips, self.patches, strict=True)
        )

    def triangles(self, tolerance: float) -> np.ndarray:
        """Triangles of all sheets, counter-clockwise seen from outside the cam.

        Parameters
        ----------
        tolerance : float [mm]
            Largest distance of the B-spline surfaces from the triangles.

        Returns
        -------
        ndarray (n, 3, 3) [mm]
        """
        return np.concatenate([_triangles(patch, tolerance) for patches in self.patches for patch in patches])


def spatial_strips(study: Study, sides: tuple[str, ...], tolerance: float) -> Strips:
    """Flanks of a cam in space.

    Raises
    ------
    NoCam
        The velocity of the motion jumps, or the roller is too large, so that a flank has an edge; or no roller is in the blank.
    KindynaError
        The tolerance requires too many spans.
    """
    study.surface  # noqa: B018 - raises where no roller is in the blank, or one has no line of contact
    require_smooth(study)
    strips = [strip for strip in flank_strips(study) if strip.side in sides]
    fits = [_fit_strip(study, strip, tolerance) for strip in strips]
    patches = tuple(fit[0] for fit in fits)
    return Strips(tuple(strips), patches, max(deviation for _, deviation in fits))


def require_smooth(study: Study) -> None:
    """Raises NoCam where the velocity of the motion jumps."""
    for i, join in enumerate(study.program.joins):
        if join.jumps[1]:
            angle = float(np.rad2deg(join.theta))
            raise NoCam(
                "the velocity jumps, so the flank has an edge",
                f"motion.segments[{(i + 1) % len(study.program.joins)}]",
                "choose a law, or an end condition, without a jump of velocity",
                [(angle, angle)],
            )


# -- strips -----------------------------------------------------------------------------------------------------


def flank_strips(study: Study) -> Iterator[Strip]:
    """Parts of the flanks that the cam has: around the cam, of a turret from where a roller enters to where it leaves the blank.

    A strip ends at cam angle 0 too; the next roller continues it there.
    """
    from core.spatial import AHEAD, BEHIND, SIDES, rollers_at

    machine = study.machine
    if not machine.is_turret:
        rollers = rollers_at(machine, np.zeros(1))
        sides = ((AHEAD,), (BEHIND,)) if len(rollers) == 2 else (SIDES,)
        for roller, touched in zip(rollers, sides, strict=True):
            for side in touched:
                yield Strip(side, int(roller.number[0]), float(roller.offset[0]), 0.0, TURN, True)
        return
    motion = study.design.drive.motion
    comes_back = motion is not None and not motion.gain
    for number, offset, low, high in _turret_ranges(study):
        for side in SIDES:
            yield Strip(side, number, offset, low, high, comes_back and high - low >= TURN)


def _turret_ranges(study: Study) -> Iterator[tuple[int, float, float, float]]:
    """Number and offset [rad] of each roller, and the cam angles [rad] between which it is in the blank."""
    from core.spatial import turret_limit

    machine, program = study.machine, study.program
    limit = min(turret_limit(machine) * (1.0 + SAME), 0.5 * np.pi * (1.0 - SAME))
    grid = [np.linspace(low, high, 33) for low, high in zip(program.starts, program.ends, strict=True)]
    theta = np.concatenate(grid)
    piece = np.repeat(np.arange(len(grid)), 33)
    y = motion_rows(study, theta, piece).y
    least, most = np.ceil((-limit - y.max()) / machine.pitch), np.floor((limit - y.min()) / machine.pitch)
    for step in range(int(least), int(most) + 1):
        offset = step * machine.pitch
        inside = np.abs(y + offset) <= limit
        edges = np.flatnonzero(np.diff(np.concatenate(([0], inside.astype(int), [0]))))
        for first, after in edges.reshape(-1, 2).tolist():
            low = (
                theta[first]
                if first == 0
                else _crossing(study, offset, limit, theta[first], theta[first - 1], piece[first])
            )
            last = after - 1
            high = (
                theta[last]
                if after == y.size
                else _crossing(study, offset, limit, theta[last], theta[after], piece[last])
            )
            if high - low > SHORTEST:
                yield step % machine.rollers + 1, offset, float(low), float(high)


def _crossing(study: Study, offset: float, limit: float, inside: float, outside: float, piece: int) -> float:
    """Cam angle [rad] at which a roller enters or leaves, by bisection."""
    for _ in range(BISECTIONS):
        middle = 0.5 * (inside + outside)
        y = motion_rows(study, np.array([middle]), np.array([piece])).y[0] + offset
        inside, outside = (middle, outside) if abs(y) <= limit else (inside, middle)
    return inside


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


def strip_flank(study: Study, strip: Strip, theta: np.ndarray, piece: np.ndarray, u: np.ndarray) -> SpatialFlank:
    """Exact flank at n cam angles and m distances along the roller.

    Parameters
    ----------
    theta : ndarray (n,) [rad]
    piece : ndarray (n,), dimensionless
    u : ndarray (m,) [mm]

    Returns
    -------
    SpatialFlank
        Its arrays are (m, n).
    """
    from core.spatial import flank

    rows = motion_rows(study, theta, piece).shifted(strip.offset)
    return flank(study.machine, rows, u[:, None] / MM, study.sense, strip.side)


# -- fit --------------------------------------------------------------------------------------------------------


class ExactFlank:
    """A strip as functions of the cam angle and of the distance along the roller, in mm."""

    def __init__(self, study: Study, strip: Strip) -> None:
        self.study, self.strip = study, strip
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
        return strip_flank(self.study, self.strip, theta, piece, u)

    def require_no_edge(self, runs: list[list[tuple[float, float, int]]]) -> None:
        """Raise NoCam where the flank is undercut at one of many samples."""
        from core.spatial import KINDS

        parts = np.linspace(0.0, 1.0, 33)
        theta = np.concatenate([low + (high - low) * parts for run in runs for low, high, _ in run])
        piece = np.repeat([i for run in runs for _, _, i in run], parts.size)
        margin = self.flank(theta, piece, np.linspace(*self.ends, 9)).margin.min(axis=0)
        if margin.min() <= 0.0:
            angle = float(np.rad2deg(theta[margin.argmin()]))
            gentler = KINDS[self.study.machine.kind].gentler
            raise NoCam(
                f"the flank {self.strip.side} is undercut: it has an edge",
                "cam.roller_radius_mm",
                f"use a smaller roller, or {gentler}",
                [(angle, angle)],
            )

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


def _fit_strip(study: Study, strip: Strip, tolerance: float) -> tuple[tuple[Patch, ...], float]:
    """Patches of a strip, and its deviation [mm]."""
    exact, program = ExactFlank(study, strip), study.program
    low, high = np.maximum(program.starts, strip.low), np.minimum(program.ends, strip.high)
    pieces = np.flatnonzero(high - low > SHORTEST)
    runs = np.split(pieces, 1 + np.flatnonzero([is_cut(study, a, b) for a, b in pairwise(pieces.tolist())]))
    spans = [[(low[i], high[i], int(i)) for i in run] for run in runs]
    if strip.is_closed and len(spans) == 1:  # a surface does not end where it begins
        *before, (first, last, piece) = spans[0]
        middle = 0.5 * (first + last)
        spans = [[*before, (first, middle, piece)], [(middle, last, piece)]]
    exact.require_no_edge(spans)
    along = along_basis(exact, spans, tolerance)
    fits = [fit_patch(exact, run, along, tolerance) for run in spans]
    return tuple(patch for patch, _ in fits), max(deviation for _, deviation in fits)


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


def along_basis(exact: ExactFlank, runs: list[list[tuple[float, float, int]]], tolerance: float) -> KnotVector:
    """Equal spans along the roller, so many that the cubic keeps its part of the tolerance."""
    parts = np.linspace(0.02, 0.98, 9)
    theta = np.concatenate([low + (high - low) * parts for run in runs for low, high, _ in run])
    piece = np.repeat([i for run in runs for _, _, i in run], parts.size)
    for count in ALONG_SPANS:
        basis = KnotVector(ALONG, np.linspace(*exact.ends, count + 1), (ALONG + 1, *(1,) * (count - 1), ALONG + 1))
        sites = _greville(basis)
        u = np.linspace(*exact.ends, 4 * ACROSS * count + 1)
        fitted = spline_value(basis, _solve(basis, sites, exact.points(theta, piece, sites).transpose(1, 0, 2)), u)
        if np.abs(fitted.transpose(1, 0, 2) - exact.points(theta, piece, u)).max() <= ALONG_PART * tolerance:
            return basis
    raise KindynaError(_too_fine(tolerance))


def _too_fine(tolerance: float) -> str:
    return f"tolerance {tolerance:g} mm: it requires too many spans of the surface; choose a larger tolerance"


def fit_patch(
    exact: ExactFlank, pieces: list[tuple[float, float, int]], along: KnotVector, tolerance: float
) -> tuple[Patch, float]:
    """Surface over consecutive pieces of the motion; spans are halved where it misses the tolerance."""
    edges = [np.linspace(a, b, int(np.ceil((b - a) / WIDEST)) + 1) for a, b, _ in pieces]
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
            raise KindynaError(_too_fine(tolerance))
        middles = 0.5 * (nodes[:-1] + nodes[1:])[bad]
        edges = [np.sort(np.append(e, middles[(middles > e[0]) & (middles < e[-1])])) for e in edges]
    return Patch(basis, along, points, _is_outward(exact, patch, nodes, owner)), deviation


def _interpolate(
    exact: ExactFlank, nodes: np.ndarray, owner: np.ndarray, along: KnotVector
) -> tuple[np.ndarray, KnotVector]:
    """Control points of the surface with the flank's points at the Greville abscissae, and its tangents at both ends."""
    inner = [SMOOTH if a != b and exact.has_kink(a, b) else 1 for a, b in pairwise(owner.tolist())]
    basis = KnotVector(BY_ANGLE, nodes, (BY_ANGLE + 1, *inner, BY_ANGLE + 1))
    sites, u = _greville(basis), _greville(along)
    sites = np.concatenate((sites[:1], sites[2:-2], sites[-1:]))  # the tangents replace two of them
    at = owner[np.clip(np.searchsorted(nodes, sites, side="right") - 1, 0, owner.size - 1)]
    slopes = exact.by_theta(nodes[0], owner[0], u), exact.by_theta(nodes[-1], owner[-1], u)
    rows = _solve(basis, sites, exact.points(sites, at, u), slopes)
    return _solve(along, u, rows.transpose(1, 0, 2)).transpose(1, 0, 2), basis


def _greville(basis: KnotVector) -> np.ndarray:
    knots = np.repeat(basis.knots, basis.multiplicities)
    return np.convolve(knots[1:-1], np.ones(basis.degree) / basis.degree, mode="valid").clip(knots[0], knots[-1])


def _solve(basis: KnotVector, sites: np.ndarray, values: np.ndarray, slopes: tuple[Any, ...] = ()) -> np.ndarray:
    """Control points (m, ...) of the B-spline with these values at its sites and slopes at its ends."""
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


def patch_points(patch: Patch, theta: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Points of a patch on a grid.

    Parameters
    ----------
    patch : Patch
    theta : ndarray (n,) [rad]
    u : ndarray (m,) [mm]

    Returns
    -------
    ndarray (n, m, 3) [mm]
    """
    rows = spline_value(patch.by_angle, patch.points, theta)
    return spline_value(patch.along, rows.transpose(1, 0, 2), u).transpose(1, 0, 2)


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


def _span_errors(
    exact: ExactFlank, patch: Patch, nodes: np.ndarray, owner: np.ndarray
) -> tuple[np.ndarray, list[tuple[float, int, float]]]:
    """Largest sampled distance (m,) [mm] of every span, and the angle, piece and u of the largest samples."""
    parts = (np.arange(GRID) + 0.5) / GRID
    theta = (nodes[:-1, None] + np.diff(nodes)[:, None] * parts).ravel()
    piece = np.repeat(owner, GRID)
    u = np.linspace(*exact.ends, (patch.along.knots.size - 1) * ACROSS + 1)
    error = _normal_distance(exact, patch, theta, piece, u)
    largest = np.argsort(-error, axis=None)[:PEAKS]
    rows, columns = np.unravel_index(largest, error.shape)
    peaks = [(float(theta[i]), int(piece[i]), float(u[j])) for i, j in zip(rows, columns, strict=True)]
    return error.reshape(owner.size, -1).max(axis=1), peaks


def _refined(
    exact: ExactFlank, patch: Patch, nodes: np.ndarray, owner: np.ndarray, peaks: list[tuple[float, int, float]]
) -> float:
    """Largest distance [mm] near the largest samples, on grids that get finer."""
    result = 0.0
    for theta, piece, u in peaks:
        span = int(np.clip(np.searchsorted(nodes, theta) - 1, 0, owner.size - 1))
        width, height = (
            (nodes[span + 1] - nodes[span]) / GRID,
            np.ptp(exact.ends) / (ACROSS * (patch.along.knots.size - 1)),
        )
        for _ in range(LEVELS):
            steps = np.linspace(-1.0, 1.0, FINE)
            angles = np.clip(theta + width * steps, nodes[span], nodes[span + 1])
            distances = np.clip(u + height * steps, *exact.ends)
            error = _normal_distance(exact, patch, angles, np.full(FINE, piece), distances)
            i, j = np.unravel_index(int(np.argmax(error)), error.shape)
            result, theta, u = max(result, float(error[i, j])), float(angles[i]), float(distances[j])
            width, height = 2.0 * width / (FINE - 1), 2.0 * height / (FINE - 1)
    return result


def _is_outward(exact: ExactFlank, patch: Patch, nodes: np.ndarray, owner: np.ndarray) -> bool:
    """Whether ∂θ × ∂u points out of the cam."""
    middle, theta = owner.size // 2, 0.5 * (nodes[owner.size // 2] + nodes[owner.size // 2 + 1])
    flank = exact.flank(np.array([theta]), owner[middle : middle + 1], np.array([0.5 * sum(exact.ends)]))
    across = np.cross(flank.by_theta[:, 0, 0], flank.by_u[:, 0, 0])
    return float(across @ flank.normal[:, 0, 0]) < 0.0


# -- bodies -----------------------------------------------------------------------------------------------------


def strip_body(name: str, patches: tuple[Patch, ...], is_closed: bool) -> Body:
    """Sheet of consecutive patches, whose common edges are single."""
    lines = [patch.points[0] for patch in patches] + ([] if is_closed else [patches[-1].points[-1]])
    vertices = np.array([line[end] for line in lines for end in (0, -1)])
    edges = [Edge(SplineCurve(patches[0].along, line), 2 * i, 2 * i + 1) for i, line in enumerate(lines)]
    faces = []
    for i, patch in enumerate(patches):
        after = (i + 1) % len(lines)
        first = len(edges)
        edges += [
            Edge(SplineCurve(patch.by_angle, patch.points[:, end]), 2 * i + side, 2 * after + side)
            for side, end in ((0, 0), (1, -1))
        ]
        loop = ((first, True), (after, True), (first + 1, False), (i, False))
        if not patch.is_along:
            loop = tuple((edge, not forward) for edge, forward in reversed(loop))  # type: ignore[assignment]
        surface = SplineSurface(patch.by_angle, patch.along, patch.points)
        faces.append(Face(surface, (loop,), patch.is_along))
    return Body(name, vertices, tuple(edges), tuple(faces), False)


def _triangles(patch: Patch, tolerance: float) -> np.ndarray:
    """Triangles (n, 3, 3) [mm] of equal steps h, k: within (h²|∂θθ| + 2hk|∂θu| + k²|∂uu|)/8 of the patch.

    Of ∂θu only the part along the normal counts, of ∂θθ and ∂uu that across the line: chords of the patch's rim deviate in
    its plane too.
    """
    theta, u = (np.linspace(basis.knots[0], basis.knots[-1], 65) for basis in (patch.by_angle, patch.along))

    def derivative(by_theta: int, by_u: int) -> np.ndarray:
        rows = spline_value(patch.by_angle, patch.points, theta, by_theta)
        return spline_value(patch.along, rows.transpose(1, 0, 2), u, by_u)

    normal = np.cross(derivative(1, 0), derivative(0, 1))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    length, width = np.ptp(patch.by_angle.knots), np.ptp(patch.along.knots)

    def across_line(second: np.ndarray, first: np.ndarray) -> float:
        along = (second * first).sum(axis=-1, keepdims=True) / (first * first).sum(axis=-1, keepdims=True)
        return float(np.linalg.norm(second - along * first, axis=-1).max())

    bend = BETWEEN * length**2 / 8.0 * across_line(derivative(2, 0), derivative(1, 0))
    twist = BETWEEN * length * width / 4.0 * float(np.abs((derivative(1, 1) * normal).sum(axis=-1)).max())
    arch = BETWEEN * width**2 / 8.0 * across_line(derivative(0, 2), derivative(0, 1))
    m = np.arange(1, MOST_ACROSS + 1)
    rest = tolerance - arch / m**2
    with np.errstate(divide="ignore", invalid="ignore"):
        n = np.where(rest > 0.0, (twist / m + np.sqrt((twist / m) ** 2 + 4.0 * bend * rest)) / (2.0 * rest), np.inf)
    best = int(np.argmin(n * m))
    if not n[best] * m[best] <= MOST_TRIANGLES:
        raise KindynaError(
            f"tolerance {tolerance:g} mm: it requires too many triangles; choose a larger tolerance, or write a STEP file"
        )
    grid = patch_points(
        patch,
        np.linspace(theta[0], theta[-1], int(np.ceil(n[best])) + 2),
        np.linspace(u[0], u[-1], int(m[best]) + 1),
    )
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    corners = np.concatenate([np.stack(three, axis=2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))])
    return corners if patch.is_along else corners[:, ::-1]


# -- tables -----------------------------------------------------------------------------------------------------


def spatial_rows(
    study: Study, side: str, blocks: list[np.ndarray], along: int
) -> Iterator[tuple[int, list[np.ndarray]]]:
    """Points of a flank under each roller, as columns of a table: of a turret only those whose axis point is in the blank.

    Parameters
    ----------
    study : Study
    side : str
        ``ahead`` or ``behind``.
    blocks : list of ndarray (n,) [deg]
        Cam angles.
    along : int
        Number of points along the roller, from end to end.

    Returns
    -------
    iterator of int, list of ndarray (m,) [deg], [mm], [1/mm]
        Number of the roller; cam angle, u, x, y, z, normal, pressure angle, curvature.
    """
    from core.spatial import flank

    machine, program = study.machine, study.program
    u = np.linspace(machine.inner, machine.outer, along)
    for angles in blocks:
        at = program.angles(np.deg2rad(angles))
        motion = motion_rows(study, at.theta, at.piece)
        for number, offset in _rollers(machine, motion.y, side):
            surface = flank(machine, motion.shifted(offset), u[:, None], study.sense, side)
            points, normal = MM * surface.cam_point, surface.in_cam(surface.normal)
            inside = _in_blank(machine, motion.y + offset, surface).T
            columns = [
                np.broadcast_to(column, (along, angles.size)).T[inside] + 0.0
                for column in (
                    angles, MM * u[:, None], *points, *normal, np.rad2deg(surface.pressure_angle), surface.curvature / MM
                )
            ]  # fmt: skip
            yield number, columns


def _rollers(machine: Any, y: np.ndarray, side: str) -> Iterator[tuple[int, np.ndarray | float]]:
    """Number of every roller that this side touches, and its motion less that of the design, of a turret within half a turn."""
    from core.spatial import AHEAD, rollers_at

    if machine.is_turret:
        for k in range(machine.rollers):
            angle = np.mod(y + k * machine.pitch + 0.5 * TURN, TURN) - 0.5 * TURN
            yield k + 1, angle - y
        return
    rollers = rollers_at(machine, y)
    for roller in rollers if len(rollers) == 1 else rollers[:1] if side == AHEAD else rollers[1:]:
        yield int(roller.number[0]), float(roller.offset[0])


def _in_blank(machine: Any, angle: np.ndarray, surface: SpatialFlank) -> np.ndarray:
    """Whether points of the roller's axis (m, n) are in the blank; always where the roller is not on a turret."""
    z = surface.axis[2] + 0.0 * surface.e_t
    if not machine.is_turret:
        return np.ones(z.shape, dtype=bool)
    limit = np.inf if machine.length is None else 0.5 * machine.length * (1.0 + SAME)
    widest = machine.pitch * (1.0 + SAME) if machine.length is None else np.inf
    near = (np.abs(angle) <= widest) & (np.abs(angle) < 0.5 * np.pi * (1.0 - SAME))
    return np.asarray((np.abs(z) <= limit) & near)
