"""Load of a camshaft over one turn, as polynomials on short panels that end where the load is not smooth.

Its integral, the response of the flywheel and their extremes are then exact to rounding for every flywheel, jumps of
the torque included; no harmonics are cut off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from math import pi
from typing import Any, NamedTuple

import numpy as np

from core.errors import NoSolution, angle_ranges
from core.frozen import frozen
from core.motion import TURN, Angles, CompiledMotion
from core.motion.extremes import Extreme, Extremes, crossings
from core.motion.program import CLOSEST, ShaftPosition
from core.numerics.roots import gauss_legendre

# -- load curve -------------------------------------------------------------------------------------------------


NODES = 10  # per panel; the polynomial has this many coefficients
PANEL = np.deg2rad(2.0)  # longest panel
LEAST_PANELS = 16  # of a piece, however short: it may contain a full sine wave


class PanelSize(NamedTuple):
    """Length of the longest panel [rad] and least number of panels of a piece, in moving pieces and in dwells."""

    longest: float
    least: int
    longest_at_rest: float
    least_at_rest: int


EVEN = PanelSize(PANEL, LEAST_PANELS, PANEL, LEAST_PANELS)
FEW_AT_REST = EVEN._replace(longest_at_rest=np.deg2rad(15.0), least_at_rest=2)
"""For loads that are constant or linear in a dwell."""

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


def fitted_loads(
    counts: np.ndarray, start: np.ndarray, width: np.ndarray, torque: np.ndarray, inertia: np.ndarray
) -> list[LoadCurve]:
    """Several loads with given values at the nodes of their panels, the panels of one load after those of the other.

    Parameters
    ----------
    counts : ndarray (k,), dimensionless
        Numbers of panels of the loads; their sum is m.
    start, width : ndarray (m,) [rad]
        Of the panels.
    torque : ndarray (m, NODES) [N m]
    inertia : ndarray (m, NODES) [kg m²]

    Returns
    -------
    list of LoadCurve
    """
    return _loads(counts, start, width, _fit(torque), _fit(inertia))


def _fit(values: np.ndarray) -> np.ndarray:
    """Coefficients of r**k (NODES, m) from values (m, NODES) at the nodes."""
    _, to_chebyshev = nodes()
    return by_panel(to_powers(NODES), by_panel(to_chebyshev, values.T))


def _loads(
    counts: np.ndarray, start: np.ndarray, width: np.ndarray, torque: np.ndarray, inertia: np.ndarray
) -> list[LoadCurve]:
    """Loads from the coefficients (NODES, m) on their panels."""
    if not counts.size:
        return []
    ends = np.cumsum(counts)
    work = width * (torque / np.arange(1, NODES + 1)[:, None]).sum(axis=0)
    means = (np.add.reduceat(work, ends - counts) / TURN).tolist()
    parts = zip((ends - counts).tolist(), ends.tolist(), means, strict=True)
    return [LoadCurve(start[a:b], width[a:b], torque[:, a:b], inertia[:, a:b], mean) for a, b, mean in parts]


def by_panel(matrix: np.ndarray, values: np.ndarray) -> np.ndarray:
    """A matrix times the values of every panel; unlike a product by BLAS, no last bit depends on the number of panels.

    Parameters
    ----------
    matrix : ndarray (j, k), dimensionless
    values : ndarray (k, m) [any unit]

    Returns
    -------
    ndarray (j, m) [unit of the values]
    """
    return np.asarray(np.einsum("jk,km->jm", matrix, values))


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
    size: PanelSize = EVEN,
) -> tuple[np.ndarray, np.ndarray, Angles]:
    """Panels that never contain a join of pieces or a cut inside, and the nodes of all of them.

    Parameters
    ----------
    program : CompiledMotion
    cuts : Angles, optional
        Further angles at which panels end.
    size : PanelSize

    Returns
    -------
    start, width : ndarray (m,) [rad]
    angles : Angles
        The nodes, (m NODES,).
    """
    starts, ends = program.starts, program.ends
    is_rest = getattr(program, "velocity_signs", 1.0) == np.zeros(starts.size)
    longest = np.where(is_rest, size.longest_at_rest, size.longest)
    counts = np.maximum(np.where(is_rest, size.least_at_rest, size.least), np.ceil((ends - starts) / longest)).astype(
        int
    )
    piece = np.repeat(np.arange(counts.size), counts)
    number = np.arange(piece.size) - np.repeat(np.cumsum(counts) - counts, counts)
    start = number * ((ends - starts) / counts)[piece] + starts[piece]
    if cuts is not None:
        start, piece = np.concatenate((start, cuts.theta)), np.concatenate((piece, cuts.piece))
        order = np.lexsort((start, piece))
        start, piece = start[order], piece[order]
        is_new = np.ones(start.size, dtype=bool)
        is_new[1:] = (start[1:] != start[:-1]) | (piece[1:] != piece[:-1])
        is_new &= start < ends[piece]
        start, piece = start[is_new], piece[is_new]
    end = np.append(start[1:], TURN)
    is_last = np.append(piece[1:] != piece[:-1], True)
    width = np.where(is_last, ends[piece], end) - start
    x, _ = nodes()
    theta = start[:, None] + width[:, None] * x
    return start, width, Angles(theta.ravel(), np.repeat(piece, NODES))


@lru_cache(maxsize=32)
def uncut_panels(program: CompiledMotion, size: PanelSize = EVEN) -> tuple[np.ndarray, np.ndarray, Angles]:
    """Panels without cuts inside the pieces; equal programs return the same nodes, whose results may be cached.

    Parameters
    ----------
    program : CompiledMotion
    size : PanelSize

    Returns
    -------
    start, width : ndarray (m,) [rad]
    angles : Angles
        The nodes, (m NODES,).
    """
    start, width, angles = panel_angles(program, size=size)
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
    size = FEW_AT_REST if even_at_rest else EVEN
    start, width, angles = uncut_panels(program, size)
    values = load(angles)
    cuts = [crossings(switch, angles, switch(angles)) for switch in switches if switch is not None]
    theta = np.concatenate([cut.theta for cut in cuts]) if cuts else np.zeros(0)
    if theta.size:  # most panels do not change
        old, old_values = (start, width), values.reshape(2, -1, NODES)
        start, width, angles = panel_angles(program, Angles(theta, np.concatenate([cut.piece for cut in cuts])), size)
        panel = np.minimum(np.searchsorted(old[0], start), old[0].size - 1)
        is_new = (old[0][panel] != start) | (old[1][panel] != width)
        new_nodes = np.repeat(is_new, NODES)
        values = old_values[:, panel].reshape(2, -1)
        values[:, new_nodes] = load(Angles(angles.theta[new_nodes], angles.piece[new_nodes]))
    infinite = np.any(~np.isfinite(values), axis=0)
    if infinite.any():
        raise NoSolution("the torque is infinite", "loads", "change them", angle_ranges(angles.theta, infinite))
    torque, inertia = (row.reshape(-1, NODES) for row in values)
    return fitted_loads(np.array([start.size]), start, width, torque, inertia)[0]


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
    if len(power) == 1:
        return power[0]
    value = power[-1] * r
    value += power[-2]
    for row in power[-3::-1]:
        value *= r
        value += row
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


def locate_in_turns(
    turn: np.ndarray, start: np.ndarray, width: np.ndarray, number: np.ndarray, theta: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Panel that contains an angle of one of several turns, and the angle's coordinate r in it.

    Parameters
    ----------
    turn : ndarray (m,), dimensionless
        Number of the turn of each panel.
    start, width : ndarray (m,) [rad]
        Of the panels, ascending in every turn.
    number : ndarray (n,), dimensionless
        Number of the turn of each angle.
    theta : ndarray (n,) [rad]

    Returns
    -------
    panel, r : ndarray (n,), dimensionless
    """
    is_start = np.arange(start.size + theta.size) < start.size
    order = np.lexsort((~is_start, np.concatenate((start, theta)), np.concatenate((turn, number))))
    panel = np.empty(order.size, dtype=int)
    panel[order] = np.cumsum(is_start[order]) - 1
    panel = panel[start.size :]
    return panel, (theta - start[panel]) / width[panel]


# -- total load of several drives on one shaft ------------------------------------------------------------------


ROUNDING = 1e-14  # [rad] of the ends of panels


def combined_load(loads: Sequence[tuple[LoadCurve, ShaftPosition]]) -> LoadCurve:
    """Total T_c and J_e of several loads by machine angle.

    The panels of each load are shifted by its phase and divided where another's end: the polynomials are the same on
    them, so that only rounding is lost.
    """
    return combined_loads([loads])[0]


def combined_loads(shafts: Sequence[Sequence[tuple[LoadCurve, ShaftPosition]]]) -> list[LoadCurve]:
    """Total loads of several shafts, each with as many loads in the same order, as by ``combined_load``."""
    if not shafts:
        return []
    drives = [_PositionedLoads(drive) for drive in zip(*shafts, strict=True)]
    shaft = np.concatenate([np.arange(len(shafts)), *(drive.shaft for drive in drives)])
    ends = np.concatenate([np.zeros(len(shafts)), *(drive.machine for drive in drives)])
    order = np.lexsort((ends, shaft))
    shaft, ends = shaft[order], ends[order]
    keep = (np.diff(ends, prepend=-1.0) > CLOSEST) | (np.diff(shaft, prepend=-1) > 0)
    keep &= ends < TURN - CLOSEST
    shaft, start = shaft[keep], ends[keep]
    is_last = np.diff(shaft, append=len(shafts)) > 0
    width = np.where(is_last, TURN, np.roll(start, -1)) - start
    rows = np.zeros((2, NODES, start.size))
    for drive in drives:
        drive.add(shaft, start, width, rows)
    return _loads(np.bincount(shaft, minlength=len(shafts)), start, width, *rows)


class _PositionedLoads:
    """One load of every shaft, with its position; shafts with the same load share its panels (m,).

    Attributes
    ----------
    shaft : ndarray (n,), dimensionless
        Number of the shaft, of the panels of all shafts.
    machine : ndarray (n,) [rad]
        Machine angles at the starts of these panels.
    """

    def __init__(self, loads: Sequence[tuple[LoadCurve, ShaftPosition]]) -> None:
        curves = list({id(curve): curve for curve, _ in loads}.values())
        numbers = {id(curve): number for number, curve in enumerate(curves)}
        counts = np.array([curve.start.size for curve in curves])
        self._curve_of = np.array([numbers[id(curve)] for curve, _ in loads])  # of a shaft
        self._phases = np.array([position.phase for _, position in loads])
        self._signs = np.array([position.rotation_sign for _, position in loads])
        self._curve = np.repeat(np.arange(len(curves)), counts)  # of a panel
        self._start = np.concatenate([curve.start for curve in curves])
        self._width = np.concatenate([curve.width for curve in curves])
        torque, inertia = ([getattr(curve, name) for curve in curves] for name in ("torque", "inertia"))
        self._rows = np.array((np.concatenate(torque, axis=1), np.concatenate(inertia, axis=1)))
        self._is_loaded: np.ndarray = (self._rows != 0.0).any(axis=(0, 1))
        of_shaft = counts[self._curve_of]
        self.shaft = np.repeat(np.arange(len(loads)), of_shaft)
        within = np.arange(self.shaft.size) - np.repeat(np.cumsum(of_shaft) - of_shaft, of_shaft)
        start = self._start[(np.cumsum(counts) - counts)[self._curve_of][self.shaft] + within]
        self.machine = np.mod(self._phases[self.shaft] + self._signs[self.shaft] * start, TURN)

    def add(self, shaft: np.ndarray, start: np.ndarray, width: np.ndarray, rows: np.ndarray) -> None:
        """Add coefficients of torque and inertia to ``rows`` (2, NODES, n), on parts (n,) of the panels of given shafts."""
        sign = self._signs[shaft]
        angle = np.mod(sign * (start + 0.5 * width - self._phases[shaft]), TURN)
        panel, r = locate_in_turns(self._curve, self._start, self._width, self._curve_of[shaft], angle)
        loaded = self._is_loaded[panel]
        is_same = loaded & (sign > 0.0)  # a complete panel, but for rounding
        is_same &= (np.abs(width - self._width[panel]) < ROUNDING) & (np.abs(r - 0.5) * width < ROUNDING)
        rows[:, :, is_same] += self._rows[:, :, panel[is_same]]
        part = np.flatnonzero(loaded & ~is_same)
        panel, r = panel[part], r[part, None]
        r = r + (sign[part] * width[part] / self._width[panel])[:, None] * (nodes()[0] - 0.5)
        for row, power in zip(rows, self._rows, strict=True):
            row[:, part] += _fit(polyval(r, power[:, panel, None]))


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
    """Lowest and highest T_c [N m], with both limits at its jumps."""
    found = load_extremes([curve])
    low, high = (
        (float(value[0]), float(at[0])) for value, at in ((found.low, found.low_at), (found.high, found.high_at))
    )
    return Extremes(Extreme(*low), Extreme(*high))


# -- extremes over the turn -------------------------------------------------------------------------------------


GRID = np.linspace(0.0, 1.0, 2 * NODES + 1)  # of a panel, on which extremes are bracketed
REFINEMENTS = 5  # steps of Newton's method from the grid to an extreme


class TurnExtremes(NamedTuple):
    """Extremes of a quantity over each of m turns.

    Attributes
    ----------
    low, high : ndarray (m,) [unit of the quantity]
        Least and greatest value.
    low_at, high_at : ndarray (m,) [rad]
        Their angles.
    """

    low: np.ndarray
    high: np.ndarray
    low_at: np.ndarray
    high_at: np.ndarray


def load_extremes(curves: Sequence[LoadCurve]) -> TurnExtremes:
    """Lowest and highest T_c [N m] of loads, with both limits at their jumps.

    Parameters
    ----------
    curves : sequence of LoadCurve
        m loads, at least one.

    Returns
    -------
    TurnExtremes
    """
    turn, start, width, torque = panels_of(curves, "torque")
    begin, reach = torque[0], np.abs(torque[1:]).sum(axis=0)  # the other panels are within the values at the begins
    first = first_panels(turn)
    near = (begin + reach >= np.maximum.reduceat(begin, first)[turn]) | (
        begin - reach <= np.minimum.reduceat(begin, first)[turn]
    )
    return ratio_extremes(turn[near], start[near], width[near], torque[:, near], np.ones((1, np.count_nonzero(near))))


def panels_of(curves: Sequence[Any], *names: str) -> list[np.ndarray]:
    """Panels of several turns, the panels of one turn after those of the other.

    Parameters
    ----------
    curves : sequence of LoadCurve or SpeedCurve
        At least one.
    *names : str
        Attributes with the coefficients on the panels.

    Returns
    -------
    list of ndarray
        Number of the turn (n,), dimensionless; start and width (n,) [rad]; the attributes (k, n).
    """
    turn = np.repeat(np.arange(len(curves)), [curve.start.size for curve in curves])
    rows = [[getattr(curve, name) for curve in curves] for name in ("start", "width", *names)]
    return [turn, *(np.concatenate(row, axis=-1) for row in rows)]


def first_panels(turn: np.ndarray) -> np.ndarray:
    """Index of the first panel of every turn.

    Parameters
    ----------
    turn : ndarray (n,), dimensionless
        Number of the turn of each panel, ascending.

    Returns
    -------
    ndarray (m,), dimensionless
    """
    is_first = np.ones(turn.size, dtype=bool)
    np.not_equal(turn[1:], turn[:-1], out=is_first[1:])
    return np.asarray(is_first.nonzero()[0])  # np.diff and np.flatnonzero take five times as long


def ratio_extremes(
    turn: np.ndarray, start: np.ndarray, width: np.ndarray, numerator: np.ndarray, denominator: np.ndarray
) -> TurnExtremes:
    """Extremes over every turn of the ratio of two polynomials on its panels, both limits at their ends included.

    The ratio is evaluated on a grid in every panel, and refined by Newton's method where its slope between neighbours
    may lead above the highest value of the turn.

    Parameters
    ----------
    turn : ndarray (n,), dimensionless
        Number of the turn of each panel, ascending.
    start, width : ndarray (n,) [rad]
        Of the panels.
    numerator : ndarray (k, n) [any unit]
        Coefficients of r**k.
    denominator : ndarray (l, n) [any unit]
        The same of a polynomial without zeros.

    Returns
    -------
    TurnExtremes
    """
    degree, count = max(numerator.shape[0], denominator.shape[0]), turn.size
    grid = powers(GRID, degree).T
    ratio = by_panel(grid[:, : numerator.shape[0]], numerator) / by_panel(grid[:, : denominator.shape[0]], denominator)
    # the least values are searched as the greatest of the negative ratio, both in one pass
    sign, panel = np.repeat((-1.0, 1.0), count), np.tile(np.arange(count), 2)
    search = np.concatenate((turn, turn + (turn[-1] + 1)))
    cell = np.concatenate((ratio.argmin(axis=0), ratio.argmax(axis=0)))
    low, high = np.maximum(cell - 1, 0), np.minimum(cell + 1, GRID.size - 1)
    top = sign * ratio[cell, panel]
    gain = top - np.minimum(sign * ratio[low, panel], sign * ratio[high, panel])
    first = first_panels(search)
    highest = np.repeat(np.maximum.reduceat(top, first), np.diff(first, append=2 * count))
    near = (top + gain >= highest).nonzero()[0]
    panel, sign, search = panel[near], sign[near], search[near]
    coefficients = np.zeros((degree, 6, near.size))  # of both polynomials, and of their first and second derivatives
    coefficients[: numerator.shape[0], 0] = numerator[:, panel]
    coefficients[: denominator.shape[0], 1] = denominator[:, panel]
    power = np.arange(1.0, degree)[:, None, None]
    for order in (2, 4):
        coefficients[:-1, order : order + 2] = power * coefficients[1:, order - 2 : order]
    begin, end, top = GRID[low[near]], GRID[high[near]], top[near]
    r = refined = GRID[cell[near]]
    for _ in range(REFINEMENTS):
        over, under, over1, under1, over2, under2 = polyval(refined, coefficients)
        slope, curvature = over1 * under - over * under1, over2 * under - over * under2
        is_convex = sign * curvature < 0.0
        step = np.where(is_convex, slope / np.where(is_convex, curvature, 1.0), 0.0)
        refined = np.minimum(np.maximum(refined - step, begin), end)
    over, under = polyval(refined, coefficients[:, :2])
    refined_value = sign * over / under
    better = refined_value > top
    r, top = np.where(better, refined, r), np.where(better, refined_value, top)
    rising = np.lexsort((top, search))
    best = rising[np.append(first_panels(search[rising])[1:], rising.size) - 1]
    at = np.mod(start[panel[best]] + r[best] * width[panel[best]], TURN)
    (low_at, high_at), (least, greatest) = np.split(at, 2), np.split(sign[best] * top[best], 2)
    return TurnExtremes(least, greatest, low_at, high_at)
