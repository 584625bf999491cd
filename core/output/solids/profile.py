"""The profile of a disk cam as an outline of quintic B-splines and arcs, within a tolerance of the exact curve."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen
from core.motion import Angles
from core.motion.extremes import find_extremes
from core.number_text import rounded_up
from core.numerics.lazy import checkpoint
from core.output.files.fewest import ROUNDING, piece_deviation
from core.output.files.fitted_curve import CERTAIN, exact_curve
from core.output.files.profile_curve import ProfileCurve
from core.output.files.profile_fit import CurveChain, polynomial_distance
from core.output.files.profile_request import ProfileRequest
from core.output.solids.outline import Arc, Outline, Spline, area, hermite_spline, reversed_outline
from core.study import Study

WIDEST = np.deg2rad(30.0)  # cam angle of a span
MOST_SPANS = 20_000
SAME = 1e-9  # relative: difference of curvatures that counts as rounding
PARTS = np.linspace(0.0, 1.0, 7)  # positions in a piece of the motion at which it is compared with a circle


@frozen(eq=False)
class FittedOutline:
    """A profile as an outline.

    Attributes
    ----------
    outline : Outline
        Counter-clockwise, whatever the sense of rotation.
    deviation : float [mm]
        Largest distance of the exact curve from the outline.
    least_radius, largest_radius : float [mm]
        Distances of the nearest and the farthest point of the exact curve from the cam centre.
    """

    outline: Outline
    deviation: float
    least_radius: float
    largest_radius: float


@frozen(eq=False)
class _Nodes:
    """n nodes on the curve: cam angles [rad], points [mm], tangents, curvatures [1/mm], arc lengths [mm]."""

    theta: np.ndarray
    z: np.ndarray
    tangent: np.ndarray
    curvature: np.ndarray
    s: np.ndarray


@frozen(eq=False)
class _Quintics(CurveChain):
    """Quintics over m spans that have point, tangent and curvature of the curve at both ends.

    Attributes
    ----------
    powers : (m, 6) complex coefficients in x = 0 ... 1, lowest order first [mm]
    """

    powers: np.ndarray

    def distance(self, span: np.ndarray, z: np.ndarray, part: np.ndarray) -> np.ndarray:
        return polynomial_distance(self.powers[span], z, part)


# z, dz/dx, d²z/dx² at x = 0 and x = 1 -> coefficients of the quintic
_QUINTIC = np.linalg.inv(
    np.array([[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 2, 0, 0, 0],
              [1, 1, 1, 1, 1, 1], [0, 1, 2, 3, 4, 5], [0, 0, 2, 6, 12, 20]], dtype=float)
).T  # fmt: skip


def fit_profile(study: Study, flank: str, tolerance: float) -> FittedOutline:
    """Outline of a flank of a disk cam: quintics with point, tangent and curvature of the exact curve at their nodes.

    The outline is cut into edges where segments of the motion join and where the curvature jumps; a dwell is an arc. Spans
    are halved until each of them keeps the tolerance.

    Raises
    ------
    NoSuchStage
        The design has no cam.
    KindynaError
        The cam does not have this flank, or the tolerance is below the accuracy of the curve.
    NoCam
        The profile has corners or cusps, or crosses itself.
    """
    program = study.program
    curve = ProfileCurve(exact_curve(study, ProfileRequest(flank=flank)), program.starts, program.ends)
    least = 100.0 * CERTAIN * curve.size
    if not tolerance >= least:
        raise KindynaError(
            f"tolerance {tolerance:g} mm: below the accuracy of such a file; allowed: {rounded_up(least, 1):g} mm and more"
        )
    is_arc = _circular_pieces(curve, program)
    low, high, piece = _first_spans(program.starts, program.ends)
    accepted: list[tuple[np.ndarray, ...]] = []
    deviation = 0.0
    while low.size:
        checkpoint()
        start, end = _nodes(curve, low, piece), _nodes(curve, high, piece)
        length = end.s - start.s
        error = piece_deviation(curve, _quintics(start, end, length), np.arange(low.size), start.s, length)
        error = np.where(is_arc[piece], CERTAIN * curve.size, error * (1.0 + ROUNDING)) + curve.error
        good = error <= tolerance
        deviation = max(deviation, float(error[good].max(initial=0.0)))
        accepted.append((low[good], high[good], piece[good]))
        middle = 0.5 * (low[~good] + high[~good])
        low, high = np.concatenate((low[~good], middle)), np.concatenate((middle, high[~good]))
        piece = np.tile(piece[~good], 2)
        if sum(part[0].size for part in accepted) + low.size > MOST_SPANS:
            raise KindynaError(
                f"tolerance {tolerance:g} mm: it requires more than {MOST_SPANS} spans; choose a larger tolerance"
            )
    low, high, piece = (np.concatenate(parts) for parts in zip(*accepted, strict=True))
    order = np.argsort(low, kind="stable")
    low, high, piece = low[order], high[order], piece[order]
    joins = np.array([join.theta for join in program.joins])
    outline = _outline(curve, joins, _nodes(curve, low, piece), _nodes(curve, high, piece), is_arc[piece])
    radius = find_extremes(lambda angles: {"": np.abs(curve.exact(angles).z)}, program)[""]
    return FittedOutline(
        outline if area(outline) > 0.0 else reversed_outline(outline), deviation, radius.low.value, radius.high.value
    )


def _circular_pieces(curve: ProfileCurve, program: Any) -> np.ndarray:
    """Whether the curve over each piece of the motion (p,) is an arc about the cam centre."""
    theta = program.starts[:, None] + (program.ends - program.starts)[:, None] * PARTS
    samples = curve.exact(Angles(theta.ravel(), np.repeat(np.arange(program.starts.size), PARTS.size)))
    radius, curvature = np.abs(samples.z).reshape(theta.shape), np.abs(samples.curvature).reshape(theta.shape)
    is_round = np.abs(radius - radius[:, :1]) <= CERTAIN * curve.size
    return np.asarray((is_round & (np.abs(radius * curvature - 1.0) <= SAME)).all(axis=1))


def _first_spans(starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cam angles of both ends [rad] and piece of the motion (m,) of equal spans, at most ``WIDEST`` wide."""
    counts = np.ceil((ends - starts) / WIDEST * (1.0 - SAME)).astype(int)
    edges = [np.linspace(start, end, count + 1) for start, end, count in zip(starts, ends, counts, strict=True)]
    low, high = (np.concatenate([edge[part] for edge in edges]) for part in (slice(None, -1), slice(1, None)))
    return low, high, np.repeat(np.arange(starts.size), counts)


def _nodes(curve: ProfileCurve, theta: np.ndarray, piece: np.ndarray) -> _Nodes:
    samples = curve.exact(Angles(theta, piece))
    return _Nodes(theta, samples.z, samples.tangent, samples.curvature, curve.arc_length(theta))


def _quintics(start: _Nodes, end: _Nodes, length: np.ndarray) -> _Quintics:
    sides = [
        side
        for at in (start, end)
        for side in (at.z, at.tangent * length, 1j * at.curvature * at.tangent * length * length)
    ]
    return _Quintics(np.stack(sides, axis=1) @ _QUINTIC)


def _outline(curve: ProfileCurve, joins: np.ndarray, start: _Nodes, end: _Nodes, is_arc: np.ndarray) -> Outline:
    """Edges through the nodes of m spans, in the order of cam angles; is_arc (m,) marks the spans of dwells.

    A new edge starts at a join, where the curvature jumps, and where an arc begins or ends.
    """
    jump = np.abs(start.curvature[1:] - end.curvature[:-1])
    rounding = SAME * (np.abs(start.curvature[1:]) + np.abs(end.curvature[:-1]) + 1.0 / curve.size)
    is_join = (np.abs(start.theta[1:, None] - joins) <= SAME).any(axis=1)
    first = 1 + np.flatnonzero(is_join | (jump > rounding) | (is_arc[1:] != is_arc[:-1]))
    if not first.size:  # an edge ends at another point than that where it begins
        first = np.array([start.s.size // 2])
    return tuple(
        _arc(start.z[run], end.z[run]) if is_arc[run[0]] else _spline(start, end, run)
        for run in np.split(np.arange(start.s.size), first)
    )


def _arc(start: np.ndarray, end: np.ndarray) -> Arc:
    """Arc about the cam centre over several spans."""
    return Arc(0j, float(np.abs(start[0])), float(np.angle(start[0])), float(np.angle(end / start).sum()))


def _spline(start: _Nodes, end: _Nodes, run: np.ndarray) -> Spline:
    last = run[-1]
    return hermite_spline(*(
        np.append(low[run], high[last])
        for low, high in ((start.s, end.s), (start.z, end.z), (start.tangent, end.tangent), (start.curvature, end.curvature))
    ))  # fmt: skip
