"""The load of a camshaft over one turn, as polynomials on short panels that end where the load is not smooth.

Its integral, the flywheel's answer and their extremes are then exact to rounding for every flywheel, jumps of the torque
included; no harmonics are cut off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from math import pi
from typing import Any

import numpy as np

from core.errors import NoSolution, angle_ranges
from core.frozen import frozen
from core.motion import TURN, Angles, CompiledMotion
from core.motion.extremes import Extreme, Extremes, crossings
from core.motion.program import CLOSEST, ShaftPosition, piece_ends
from core.numerics.derivatives import distinct
from core.numerics.roots import gauss_legendre

# -- the load of a camshaft over one turn, as polynomials on short panels that end where the load is ------------


NODES = 10  # per panel; the polynomial has this many coefficients
PANEL = np.deg2rad(2.0)  # longest panel
LEAST_PANELS = 16  # of a piece, however short: it may hold a whole sine wave
REST, LEAST_AT_REST = np.deg2rad(15.0), 2  # the same of a dwell, in which loads are constant or straight lines

Load = Callable[[Angles], np.ndarray]
"""Torque at constant speed [N m] and inertia J_e [kg m²] of a load, (2, n) at any cam angles."""


@frozen(eq=False)
class LoadCurve:
    """What the camshaft has to drive, over one turn.

    start, width  (m,) of the panels [rad]
    torque        (NODES, m) coefficients of r**k, r = (θ - start)/width in 0...1, of the torque T_c that holds the
                  speed constant [N m]
    inertia       (NODES, m) the same of J_e(θ) = 2 KE/ω², what the moved bodies are worth at the camshaft [kg m²]
    mean          T̄, the mean of T_c [N m]
    """

    start: np.ndarray
    width: np.ndarray
    torque: np.ndarray
    inertia: np.ndarray
    mean: float


@lru_cache(maxsize=1)
def nodes() -> tuple[np.ndarray, np.ndarray]:
    """Chebyshev nodes of 0...1 and the matrix from values there to Chebyshev coefficients."""
    k = np.arange(NODES)
    angle = pi * (1.0 - (k + 0.5) / NODES)
    to_chebyshev = np.cos(np.outer(k, angle)) * (2.0 / NODES)
    to_chebyshev[0] /= 2.0
    return 0.5 + 0.5 * np.cos(angle), to_chebyshev


def fitted(start: np.ndarray, width: np.ndarray, torque: np.ndarray, inertia: np.ndarray) -> LoadCurve:
    """The load with these values (m, NODES) at the nodes of its panels (m,)."""
    _, to_chebyshev = nodes()
    rows = [to_powers(NODES) @ (to_chebyshev @ row.T) for row in (torque, inertia)]
    mean = float((width * (rows[0] / np.arange(1, NODES + 1)[:, None]).sum(axis=0)).sum() / TURN)
    return LoadCurve(start, width, rows[0], rows[1], mean)


@lru_cache(maxsize=4)
def to_powers(count: int) -> np.ndarray:
    """The matrix from so many Chebyshev coefficients on 0...1 to power coefficients.

    Values become powers in two steps, for the inverse of a Vandermonde matrix costs six digits: the first step has no
    large entry, the large ones of this second (whole numbers) meet coefficients that have died away.
    """
    out = np.zeros((count, count))
    out[0, 0], out[:2, 1] = 1.0, (-1.0, 2.0)
    for n in range(2, count):  # T_n(x) = 2x T_{n-1} - T_{n-2}, x = 2r - 1
        out[1:, n] = 4.0 * out[:-1, n - 1]
        out[:, n] -= 2.0 * out[:, n - 1] + out[:, n - 2]
    return out


def panel_angles(
    program: CompiledMotion,
    cuts: Angles | None = None,
    longest: float = PANEL,
    least: int = LEAST_PANELS,
    even_at_rest: bool = False,
) -> tuple[np.ndarray, np.ndarray, Angles]:
    """Panels (start, width) that never cross a join of pieces nor one of the cuts, and the nodes of all of them.

    longest: [rad] a panel; least: panels of a piece; even_at_rest: a dwell needs fewer
    """
    rests = np.broadcast_to(getattr(program, "velocity_signs", 1.0), program.starts.shape) == 0.0
    edges = []
    for i, (a, b) in enumerate(zip(program.starts, program.ends, strict=True)):
        width, few = (REST, LEAST_AT_REST) if even_at_rest and rests[i] else (longest, least)
        even = np.linspace(a, b, max(few, int(np.ceil((b - a) / width))) + 1)
        edges.append(even if cuts is None else distinct(np.append(even, cuts.theta[cuts.piece == i])))
    start, width = np.concatenate([e[:-1] for e in edges]), np.concatenate([np.diff(e) for e in edges])
    x, _ = nodes()
    theta = start[:, None] + width[:, None] * x
    return start, width, Angles(theta.ravel(), np.repeat(np.arange(len(edges)), [(e.size - 1) * NODES for e in edges]))


def load_curve(
    load: Load, program: CompiledMotion, *switches: Callable[[Angles], np.ndarray] | None, even_at_rest: bool = False
) -> LoadCurve:
    """The load fitted on panels. Raises NoSolution where its torque is infinite.

    switches  (n,) at any cam angles: where the sign of one changes, as that of the guide's force does, friction breaks the
              torque, and so panels end there
    even_at_rest  where the program says dwell the load is constant or a straight line
    """
    start, width, angles = panel_angles(program, even_at_rest=even_at_rest)
    values = load(angles)
    cuts = [crossings(switch, angles, switch(angles)) for switch in switches if switch is not None]
    theta = np.concatenate([cut.theta for cut in cuts]) if cuts else np.zeros(0)
    if theta.size:  # most panels stay as they are
        before, known = (start, width), values.reshape(2, -1, NODES)
        start, width, angles = panel_angles(
            program, Angles(theta, np.concatenate([cut.piece for cut in cuts])), even_at_rest=even_at_rest
        )
        at = np.minimum(np.searchsorted(before[0], start), before[0].size - 1)
        new = (before[0][at] != start) | (before[1][at] != width)
        fresh = np.repeat(new, NODES)
        values = known[:, at].reshape(2, -1)
        values[:, fresh] = load(Angles(angles.theta[fresh], angles.piece[fresh]))
    lost = np.any(~np.isfinite(values), axis=0)
    if lost.any():
        raise NoSolution("the torque is infinite", "loads", "change them", angle_ranges(angles.theta, lost))
    torque, inertia = (row.reshape(-1, NODES) for row in values)
    return fitted(start, width, torque, inertia)


def polyval(r: Any, power: np.ndarray) -> Any:
    """Σ c_k r^k (Horner) of coefficients (k, ...) at r, which are broadcast against each other. Not numpy's, whose import of all
    kinds of polynomials costs as much as a stage."""
    value = power[-1]
    for row in power[-2::-1]:
        value = row + value * r
    return value


def powers(r: np.ndarray, count: int = NODES) -> np.ndarray:
    """Powers 1, r, r², ... (count, n) of numbers r (n,)."""
    out = np.empty((count, r.size))
    out[0] = 1.0
    for k in range(1, count):
        np.multiply(out[k - 1], r, out=out[k])
    return out


BLOCK = 4096  # angles at a time: ten numbers an angle


def by_blocks(value: Callable[[np.ndarray], np.ndarray], theta: np.ndarray) -> np.ndarray:
    """A function of cam angles (n,) taken a block at a time, so that few numbers are held at once."""
    out = np.empty(theta.size)
    for part in range(0, theta.size, BLOCK):
        out[part : part + BLOCK] = value(theta[part : part + BLOCK])
    return out


def placed(start: np.ndarray, width: np.ndarray, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The panel of each angle (n,) and where in it the angle lies, r (n,)."""
    at = np.clip(np.searchsorted(start, theta, side="right") - 1, 0, None)
    return at, (theta - start[at]) / width[at]


# -- loads of several drives on one shaft as one ----------------------------------------------------------------


def combined(loads: Sequence[tuple[LoadCurve, ShaftPosition]]) -> LoadCurve:
    """T_c and J_e of all together by machine angle. The panels of each are shifted by its phase and cut where another's end: the
    polynomials of all are the same on them, so that nothing is lost but rounding."""
    ends = piece_ends([place.machine_angle(curve.start) for curve, place in loads])
    start, width = ends[:-1], np.diff(ends)
    inside = width[:, None] * (nodes()[0] - 0.5)
    torque, inertia = np.zeros_like(inside), np.zeros_like(inside)
    for curve, place in loads:
        middle = place.drive_angle(start + 0.5 * width)
        at, r = placed(curve.start, curve.width, middle)
        r = r[:, None] + place.rotation_sign * inside / curve.width[at][:, None]
        torque += polyval(r, curve.torque[:, at, None])
        inertia += polyval(r, curve.inertia[:, at, None])
    return fitted(start, width, torque, inertia)


def value(curve: LoadCurve, theta: np.ndarray) -> np.ndarray:
    """T_c (n,) at machine angles (n,) [rad]; where it jumps the right-hand limit."""
    theta = np.mod(theta, TURN)
    theta = np.where(theta >= TURN - CLOSEST, 0.0, theta)
    at = np.searchsorted(curve.start - CLOSEST, theta, side="right") - 1
    return np.asarray(polyval((theta - curve.start[at]) / curve.width[at], curve.torque[:, at]))


def rms(curve: LoadCurve) -> float:
    """√(mean of T_c²) [N m], exact on each panel by Gauss' rule."""
    x, weight = gauss_legendre(NODES)
    values = polyval(0.5 + 0.5 * x, curve.torque[:, :, None])
    return float(np.sqrt((curve.width[:, None] * 0.5 * weight * values**2).sum() / TURN))


def peaks(curve: LoadCurve) -> Extremes:
    """Lowest and highest T_c [N m], both sides of its jumps seen; between the panels' ends refined by Newton's method, in every panel:
    a sample may be the highest beside another peak."""
    r = np.linspace(0.0, 1.0, 2 * NODES + 1)
    values = polyval(r, curve.torque[:, :, None])
    slope = np.arange(1, NODES)[:, None] * curve.torque[1:]
    bend = np.arange(1, NODES - 1)[:, None] * slope[1:]

    every = np.arange(curve.start.size)

    def extreme(sign: float) -> Extreme:
        cell = (sign * values).argmax(axis=1)
        low, high, first = r[np.maximum(cell - 1, 0)], r[np.minimum(cell + 1, r.size - 1)], r[cell]
        at = first
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for _ in range(8):
                curvature = polyval(at, bend)
                step = polyval(at, slope) / curvature
                at = np.where(sign * curvature < 0.0, np.clip(at - step, low, high), at)
        there, sampled = polyval(at, curve.torque), values[every, cell]
        at = np.where(sign * there >= sign * sampled, at, first)
        panel = int((sign * polyval(at, curve.torque)).argmax())
        theta = float(np.mod(curve.start[panel] + at[panel] * curve.width[panel], TURN))
        return Extreme(float(polyval(at[panel], curve.torque[:, panel])), theta)

    return Extremes(extreme(-1.0), extreme(1.0))
