"""Load of a camshaft over one turn, as polynomials on short panels that end where the load is not smooth.

Its integral, the response of the flywheel and their extremes are then exact to rounding for every flywheel, jumps of
the torque included; no harmonics are cut off.
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

# -- load curve -------------------------------------------------------------------------------------------------


NODES = 10  # per panel; the polynomial has this many coefficients
PANEL = np.deg2rad(2.0)  # longest panel
LEAST_PANELS = 16  # of a piece, however short: it may contain a full sine wave
REST, LEAST_AT_REST = np.deg2rad(15.0), 2  # of a dwell, in which loads are constant or linear

Load = Callable[[Angles], np.ndarray]
"""Torque at constant speed [N m] and inertia J_e [kg m²] of a load, (2, n) at any cam angles."""


@frozen(eq=False)
class LoadCurve:
    """Load of the camshaft over one turn.

    Attributes
    ----------
    start, width : ndarray (m,) [rad]
        Of the panels.
    torque : ndarray (NODES, m) [N m]
        Coefficients of r**k, r = (θ - start)/width in 0...1, of the torque T_c at constant speed.
    inertia : ndarray (NODES, m) [kg m²]
        Coefficients of J_e(θ) = 2 KE/ω², the inertia of the moved bodies reduced to the camshaft.
    mean : float
        T̄, the mean of T_c [N m].
    """

    start: np.ndarray
    width: np.ndarray
    torque: np.ndarray
    inertia: np.ndarray
    mean: float


@lru_cache(maxsize=1)
def nodes() -> tuple[np.ndarray, np.ndarray]:
    """Chebyshev nodes of 0...1 and the matrix from values at them to Chebyshev coefficients.

    Returns
    -------
    nodes, to_chebyshev : ndarray (NODES,), (NODES, NODES), dimensionless
    """
    k = np.arange(NODES)
    angle = pi * (1.0 - (k + 0.5) / NODES)
    to_chebyshev = np.cos(np.outer(k, angle)) * (2.0 / NODES)
    to_chebyshev[0] /= 2.0
    return 0.5 + 0.5 * np.cos(angle), to_chebyshev


def fitted(start: np.ndarray, width: np.ndarray, torque: np.ndarray, inertia: np.ndarray) -> LoadCurve:
    """The load with given values at the nodes of its panels.

    Parameters
    ----------
    start, width : ndarray (m,) [rad]
        Of the panels.
    torque : ndarray (m, NODES) [N m]
    inertia : ndarray (m, NODES) [kg m²]

    Returns
    -------
    LoadCurve
    """
    _, to_chebyshev = nodes()
    rows = [to_powers(NODES) @ (to_chebyshev @ row.T) for row in (torque, inertia)]
    mean = float((width * (rows[0] / np.arange(1, NODES + 1)[:, None]).sum(axis=0)).sum() / TURN)
    return LoadCurve(start, width, rows[0], rows[1], mean)


@lru_cache(maxsize=4)
def to_powers(count: int) -> np.ndarray:
    """Matrix from Chebyshev coefficients on 0...1 to power coefficients.

    The inverse of a Vandermonde matrix would cost six digits. In two steps values become powers without that loss: the
    first step has no large entry, and the large entries of this second one (integers) meet coefficients that have
    decayed.

    Parameters
    ----------
    count : int
        Number of coefficients.

    Returns
    -------
    ndarray (count, count), dimensionless
    """
    matrix = np.zeros((count, count))
    matrix[0, 0], matrix[:2, 1] = 1.0, (-1.0, 2.0)
    for n in range(2, count):  # T_n(x) = 2x T_{n-1} - T_{n-2}, x = 2r - 1
        matrix[1:, n] = 4.0 * matrix[:-1, n - 1]
        matrix[:, n] -= 2.0 * matrix[:, n - 1] + matrix[:, n - 2]
    return matrix


def panel_angles(
    program: CompiledMotion,
    cuts: Angles | None = None,
    longest: float = PANEL,
    least: int = LEAST_PANELS,
    even_at_rest: bool = False,
) -> tuple[np.ndarray, np.ndarray, Angles]:
    """Panels that never contain a join of pieces or a cut inside, and the nodes of all of them.

    Parameters
    ----------
    program : CompiledMotion
    cuts : Angles, optional
        Further angles at which panels end.
    longest : float
        Length of the longest panel [rad].
    least : int
        Least number of panels of a piece.
    even_at_rest : bool
        Whether a dwell needs fewer panels.

    Returns
    -------
    start, width : ndarray (m,) [rad]
    angles : Angles
        The nodes, (m NODES,).
    """
    is_rest = np.broadcast_to(getattr(program, "velocity_signs", 1.0), program.starts.shape) == 0.0
    edges = []
    for i, (a, b) in enumerate(zip(program.starts, program.ends, strict=True)):
        width, least_panels = (REST, LEAST_AT_REST) if even_at_rest and is_rest[i] else (longest, least)
        even = np.linspace(a, b, max(least_panels, int(np.ceil((b - a) / width))) + 1)
        edges.append(even if cuts is None else distinct(np.append(even, cuts.theta[cuts.piece == i])))
    start, width = np.concatenate([e[:-1] for e in edges]), np.concatenate([np.diff(e) for e in edges])
    x, _ = nodes()
    theta = start[:, None] + width[:, None] * x
    return start, width, Angles(theta.ravel(), np.repeat(np.arange(len(edges)), [(e.size - 1) * NODES for e in edges]))


@lru_cache(maxsize=32)
def uncut_panels(program: CompiledMotion, even_at_rest: bool = False) -> tuple[np.ndarray, np.ndarray, Angles]:
    """Panels without cuts inside the pieces; equal programs return the same nodes, whose results may be cached.

    Parameters
    ----------
    program : CompiledMotion
    even_at_rest : bool
        Whether a dwell needs fewer panels.

    Returns
    -------
    start, width : ndarray (m,) [rad]
    angles : Angles
        The nodes, (m NODES,).
    """
    start, width, angles = panel_angles(program, even_at_rest=even_at_rest)
    return start, width, Angles(angles.theta, angles.piece, cached=True, search=True)


def load_curve(
    load: Load, program: CompiledMotion, *switches: Callable[[Angles], np.ndarray] | None, even_at_rest: bool = False
) -> LoadCurve:
    """The load fitted on panels.

    Parameters
    ----------
    load : function
        Angles (n,) -> torque [N m] and inertia [kg m²], (2, n).
    program : CompiledMotion
    *switches : function or None
        Angles (n,) -> (n,): friction makes the torque jump where one changes its sign, so that panels end there.
    even_at_rest : bool
        Whether the load is constant or linear in the dwells of the motion.

    Returns
    -------
    LoadCurve

    Raises
    ------
    NoSolution
        Where the torque is infinite.
    """
    start, width, angles = uncut_panels(program, even_at_rest)
    values = load(angles)
    cuts = [crossings(switch, angles, switch(angles)) for switch in switches if switch is not None]
    theta = np.concatenate([cut.theta for cut in cuts]) if cuts else np.zeros(0)
    if theta.size:  # most panels do not change
        old, old_values = (start, width), values.reshape(2, -1, NODES)
        start, width, angles = panel_angles(
            program, Angles(theta, np.concatenate([cut.piece for cut in cuts])), even_at_rest=even_at_rest
        )
        panel = np.minimum(np.searchsorted(old[0], start), old[0].size - 1)
        is_new = (old[0][panel] != start) | (old[1][panel] != width)
        new_nodes = np.repeat(is_new, NODES)
        values = old_values[:, panel].reshape(2, -1)
        values[:, new_nodes] = load(Angles(angles.theta[new_nodes], angles.piece[new_nodes]))
    infinite = np.any(~np.isfinite(values), axis=0)
    if infinite.any():
        raise NoSolution("the torque is infinite", "loads", "change them", angle_ranges(angles.theta, infinite))
    torque, inertia = (row.reshape(-1, NODES) for row in values)
    return fitted(start, width, torque, inertia)


def polyval(r: Any, power: np.ndarray) -> Any:
    """Polynomial Σ c_k r^k by Horner's scheme; numpy's function would cost its import of all kinds of polynomials.

    Parameters
    ----------
    r : float or ndarray (...), dimensionless
    power : ndarray (k, ...) [any unit]
        Coefficients, broadcast against r.

    Returns
    -------
    ndarray (...) [unit of the coefficients]
    """
    value = power[-1]
    for row in power[-2::-1]:
        value = row + value * r
    return value


def powers(r: np.ndarray, count: int = NODES) -> np.ndarray:
    """Powers 1, r, r², ... of numbers.

    Parameters
    ----------
    r : ndarray (n,), dimensionless
    count : int

    Returns
    -------
    ndarray (count, n), dimensionless
    """
    result = np.empty((count, r.size))
    result[0] = 1.0
    for k in range(1, count):
        np.multiply(result[k - 1], r, out=result[k])
    return result


BLOCK = 4096  # angles evaluated together


def by_blocks(function: Callable[[np.ndarray], np.ndarray], theta: np.ndarray) -> np.ndarray:
    """A function of cam angles evaluated in blocks, so that little memory is used.

    Parameters
    ----------
    function : function ndarray (n,) [rad] -> ndarray (n,)
    theta : ndarray (n,) [rad]

    Returns
    -------
    ndarray (n,) [unit of the function]
    """
    result = np.empty(theta.size)
    for part in range(0, theta.size, BLOCK):
        result[part : part + BLOCK] = function(theta[part : part + BLOCK])
    return result


def locate(start: np.ndarray, width: np.ndarray, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Index of the panel that contains an angle, and the angle's coordinate r in it.

    Parameters
    ----------
    start, width : ndarray (m,) [rad]
        Of the panels.
    theta : ndarray (n,) [rad]

    Returns
    -------
    panel, r : ndarray (n,), dimensionless
    """
    panel = np.clip(np.searchsorted(start, theta, side="right") - 1, 0, None)
    return panel, (theta - start[panel]) / width[panel]


# -- total load of several drives on one shaft ------------------------------------------------------------------


def combined_load(loads: Sequence[tuple[LoadCurve, ShaftPosition]]) -> LoadCurve:
    """Total T_c and J_e of several loads by machine angle.

    The panels of each load are shifted by its phase and divided where another's end: the polynomials are the same on
    them, so that only rounding is lost.
    """
    ends = piece_ends([position.machine_angle(curve.start) for curve, position in loads])
    start, width = ends[:-1], np.diff(ends)
    inside = width[:, None] * (nodes()[0] - 0.5)
    torque, inertia = np.zeros_like(inside), np.zeros_like(inside)
    for curve, position in loads:
        middle = position.drive_angle(start + 0.5 * width)
        panel, r = locate(curve.start, curve.width, middle)
        r = r[:, None] + position.rotation_sign * inside / curve.width[panel][:, None]
        torque += polyval(r, curve.torque[:, panel, None])
        inertia += polyval(r, curve.inertia[:, panel, None])
    return fitted(start, width, torque, inertia)


def torque_at(curve: LoadCurve, theta: np.ndarray) -> np.ndarray:
    """Torque T_c at machine angles; the right-hand limit where it jumps.

    Parameters
    ----------
    curve : LoadCurve
    theta : ndarray (n,) [rad]

    Returns
    -------
    ndarray (n,) [N m]
    """
    theta = np.mod(theta, TURN)
    theta = np.where(theta >= TURN - CLOSEST, 0.0, theta)
    panel = np.searchsorted(curve.start - CLOSEST, theta, side="right") - 1
    return np.asarray(polyval((theta - curve.start[panel]) / curve.width[panel], curve.torque[:, panel]))


def rms(curve: LoadCurve) -> float:
    """Root mean square √(mean of T_c²) [N m], exact on each panel by Gauss' rule."""
    x, weight = gauss_legendre(NODES)
    values = polyval(0.5 + 0.5 * x, curve.torque[:, :, None])
    return float(np.sqrt((curve.width[:, None] * 0.5 * weight * values**2).sum() / TURN))


def peaks(curve: LoadCurve) -> Extremes:
    """Lowest and highest T_c [N m], with both limits at its jumps.

    Newton's method refines the extremes between the ends of every panel: the highest sample may be next to a lower
    peak.
    """
    r = np.linspace(0.0, 1.0, 2 * NODES + 1)
    values = polyval(r, curve.torque[:, :, None])
    slope = np.arange(1, NODES)[:, None] * curve.torque[1:]
    curvature_powers = np.arange(1, NODES - 1)[:, None] * slope[1:]

    panels = np.arange(curve.start.size)

    def extreme(sign: float) -> Extreme:
        cell = (sign * values).argmax(axis=1)
        low, high, first = r[np.maximum(cell - 1, 0)], r[np.minimum(cell + 1, r.size - 1)], r[cell]
        r_top = first
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for _ in range(8):
                curvature = polyval(r_top, curvature_powers)
                step = polyval(r_top, slope) / curvature
                r_top = np.where(sign * curvature < 0.0, np.clip(r_top - step, low, high), r_top)
        refined, sampled = polyval(r_top, curve.torque), values[panels, cell]
        r_top = np.where(sign * refined >= sign * sampled, r_top, first)
        panel = int((sign * polyval(r_top, curve.torque)).argmax())
        theta = float(np.mod(curve.start[panel] + r_top[panel] * curve.width[panel], TURN))
        return Extreme(float(polyval(r_top[panel], curve.torque[:, panel])), theta)

    return Extremes(extreme(-1.0), extreme(1.0))
