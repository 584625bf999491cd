"""Extremes over the turn of many designs at once: bracketed by the nodes that all share, refined design by design.

The result of a design does not depend on the other designs: every bracket is narrowed independently until it is done.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial
from itertools import pairwise
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from core.motion import EPS, TURN, Angles

DENSE, SPARSE = np.deg2rad(3.6), np.deg2rad(15.0)  # mean distance of nodes, in a dwell
MIN_NODES, MAX_NODES = 13, 129  # of a piece
PARTS = 8  # of a bracket in which the quantity is not smooth
PASSES = 16
SMOOTH_AFTER = 2  # passes: from then on a quartic gives the vertex where the quantity is smooth
VERTEX_STEP = 0.02  # of a bracket: distance from the forecast maximum at which slope and curvature are taken
CREASE = 0.03  # of the distance of samples: distance of a crease from the intersection of the lines on its two sides
CURVATURE_ERROR = 0.3  # of the quartic's curvature through the nodes: allowed difference from the sampled one
TOLERANCE = 1e-11  # of the largest value: possible gain that is not searched
SAME = 1e-9  # of an extreme: values that differ by less are equal, and the smallest cam angle is given

At = Callable[[np.ndarray, np.ndarray, np.ndarray], Mapping[str, np.ndarray]]
"""Cam angles [rad], pieces and designs, (n,) each -> name -> quantity (n,)."""


class Search(NamedTuple):
    """A quantity and the side of its extreme: 1 for the highest, -1 for the lowest value."""

    name: str
    side: float


@np.errstate(invalid="ignore", over="ignore")  # infinite values are not refined
def refined_extremes(
    searches: Sequence[Search], sampled: Mapping[str, np.ndarray], angles: Angles, at: At, polish: bool
) -> dict[Search, tuple[np.ndarray, np.ndarray]]:
    """Extremes of quantities over the turn, for m designs.

    Parameters
    ----------
    searches : sequence of Search
    sampled : mapping of str -> ndarray (m, n) [SI unit of the quantity]
        Quantity -> its values at the nodes; NaN is left out.
    angles : Angles (n,)
        The nodes, as by `clenshaw_curtis_nodes`.
    at : callable
        Quantities at further angles.
    polish : bool
        Refine the extremes; without it they are those of parabolas through the nodes.

    Returns
    -------
    dict of Search -> (value, theta)
        ndarray (m,) in the unit of the quantity, and ndarray (m,) [rad]; NaN for a design without any value.
    """
    if not searches:
        return {}
    rows = [-sampled[name] if side < 0.0 else sampled[name] for name, side in searches]
    tops = np.array([row.max(axis=1) for row in rows])
    for s in np.flatnonzero(np.isnan(tops).any(axis=1)).tolist():
        rows[s] = np.where(np.isnan(rows[s]), -np.inf, rows[s])
        tops[s] = rows[s].max(axis=1)
    node_tops = tops.copy()
    if not polish:
        return {
            search: (search.side * value, np.mod(theta, TURN))
            for search, (value, theta) in zip(searches, map(partial(_between_nodes, angles), rows, tops), strict=True)
        }
    brackets = _Brackets.from_nodes(rows, tops, angles)
    values = partial(_values, brackets, searches, at)
    _step_to_vertices(brackets, values)
    _narrow(brackets, tops, rows, values)
    node_angles = np.mod(angles.theta, TURN)
    order = np.argsort(node_angles, kind="stable")
    result = {}
    for s, (search, row) in enumerate(zip(searches, rows, strict=True)):
        selected = brackets.search == s
        design, value = brackets.design[selected], brackets.value[selected]
        np.maximum.at(tops[s], design, value)
        least = tops[s] - np.where(np.isfinite(tops[s]), SAME * np.abs(tops[s]), 0.0)
        theta = np.full(least.shape, np.inf)
        at_node = np.flatnonzero(node_tops[s] >= least)
        theta[at_node] = node_angles[order][(row[at_node] >= least[at_node, None])[:, order].argmax(axis=1)]
        near = value >= least[design]
        np.minimum.at(theta, design[near], np.mod(brackets.theta[selected], TURN)[near])
        has_none = np.isneginf(tops[s])
        has_none[has_none] = np.isnan(sampled[search.name][has_none]).all(axis=1)
        result[search] = np.where(has_none, np.nan, search.side * tops[s]), np.where(has_none, np.nan, theta)
    return result


def _between_nodes(angles: Angles, row: np.ndarray, highest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Highest value and its angle [rad], (m,) each, of values (m, n) at nodes (n,), of which the highest are known (m,).

    They are those of the parabola through the highest node and its neighbours, where the curvature of the neighbouring parabolas
    is similar, so that there is no kink.
    """
    theta, last = angles.theta, angles.theta.size - 1
    near = row >= (highest * (1.0 - np.sign(highest) * SAME))[:, None]
    top = near.argmax(axis=1)
    index = np.clip(top[:, None] + np.arange(-2, 3), 0, last)
    x, y = theta[index], np.take_along_axis(row, index, axis=1)
    inside = (angles.piece[index] == angles.piece[index[:, 2:3]]).all(axis=1) & (np.diff(index, axis=1) > 0).all(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = np.diff(y, axis=1) / np.diff(x, axis=1)
        curvatures = np.diff(slopes, axis=1) / (x[:, 2:] - x[:, :-2])
        first = slopes[:, 1] + curvatures[:, 1] * (x[:, 2] - x[:, 1])
        similar = np.maximum(curvatures[:, 0], curvatures[:, 2]) < 0.3 * curvatures[:, 1]
        smooth = inside & (curvatures[:, 1] < 0.0) & similar
        step = np.where(smooth, -0.5 * first / curvatures[:, 1], 0.0)
        value = y[:, 2] + np.where(smooth, 0.5 * first * step, 0.0)
    value = np.where(np.isneginf(value), np.nan, value)
    return value, np.where(np.isnan(value), np.nan, x[:, 2] + step)


class _Brackets:
    """Brackets of local maxima, each within a piece of a design.

    Attributes
    ----------
    search, design, piece : ndarray (b,)
        Numbers of the search, the design and the piece.
    left, right, at_left, at_right : ndarray (b,)
        Ends of the bracket [rad], and the quantity there.
    theta, value : ndarray (b,)
        Highest value so far, and its angle [rad].
    top : ndarray (b,) [rad]
        Angle at which the quartic through five nodes has its maximum.
    curvature, third : ndarray (b,)
        Second and third derivative of that quartic there, by part of the bracket.
    smooth, active : ndarray (b,)
        Whether the quartic has a maximum, and whether the bracket is still searched.
    """

    def __init__(self, **rows: np.ndarray) -> None:
        self.search, self.design, self.piece = rows["search"], rows["design"], rows["piece"]
        self.left, self.right = rows["left"], rows["right"]
        self.at_left, self.at_right = rows["at_left"], rows["at_right"]
        self.theta, self.value = rows["theta"], rows["value"]
        self.top, self.curvature, self.third = rows["top"], rows["curvature"], rows["third"]
        self.smooth, self.active = rows["smooth"], rows["active"]

    @classmethod
    def from_nodes(cls, rows: Sequence[np.ndarray], tops: np.ndarray, angles: Angles) -> _Brackets:
        """Brackets about nodes that are no lower than their neighbours and higher than one, where the highest value may be."""
        theta, piece, n, parts = angles.theta, angles.piece, angles.theta.size, []
        at = np.arange(n)
        ends = np.diff(piece) != 0
        starts, stops = np.append(True, ends), np.append(ends, True)
        first, last = (np.searchsorted(piece, piece, side=side) for side in ("left", "right"))
        lo, hi, inwards = np.where(starts, at, at - 1), np.where(stops, at, at + 1), np.where(starts, 1, -1)
        wider = np.where(stops, 1.0, theta[hi] - theta) / np.where(starts, 1.0, theta - theta[lo])
        weights = np.maximum(wider, 1.0), np.maximum(1.0 / wider, 1.0)
        gaps = np.array([theta[np.clip(at + k * inwards, 0, n - 1)] - theta for k in (1, 2)])  # at ends of pieces
        for s, row in enumerate(rows):
            flat, top = row.ravel(), tops[s]
            rises, falls = np.zeros((2, flat.size + 1), dtype=bool)  # up to a node, and from the last one on
            np.greater(flat[1:], flat[:-1], out=rises[1:-1])
            np.less(flat[1:], flat[:-1], out=falls[1:-1])
            for steps in (rises, falls):
                steps[:-1].reshape(row.shape)[:, starts] = False
            # higher than one neighbour, lower than none
            maxima = np.flatnonzero((rises[:-1] | falls[1:]) & ~(falls[:-1] | rises[1:]))
            at_end = (starts | stops)[maxima % n]
            inner, end = maxima[~at_end], maxima[at_end]
            k, value = inner % n, flat[inner]
            gain = np.maximum((value - flat[inner - 1]) * weights[0][k], (value - flat[inner + 1]) * weights[1][k])
            inner = inner[~(value + gain < top[inner // n]) & np.isfinite(value)]
            k, value = end % n, flat[end]
            first_in, second_in = flat[end + inwards[k]], flat[end + 2 * inwards[k]]
            may_be_top = ~(value + np.abs(value - 2.0 * first_in + second_in) < top[end // n]) & np.isfinite(value)
            end, k, value, first_in, second_in = (x[may_be_top] for x in (end, k, value, first_in, second_in))
            slope = (value - first_in) / gaps[0, k]
            next_slope = (first_in - second_in) / (gaps[1, k] - gaps[0, k])
            change = np.abs((next_slope - slope) * gaps[0, k] / gaps[1, k])
            # the slopes at the ends of the parabola differ by a factor of 2 at most
            falls_off = 3.0 * change < np.abs(slope)
            maxima = np.concatenate((inner, end[~falls_off]))
            k = maxima % n
            begin = maxima - k
            five = (begin + np.clip(k - 2, first[k], last[k] - 5))[:, None] + np.arange(5)
            ends = flat[begin + lo[k]], flat[begin + hi[k]]
            parts.append((np.full(k.size, s), begin // n, k, flat[maxima], *ends, flat[five]))
        every = [np.concatenate(rows) for rows in zip(*parts, strict=True)]
        order = np.argsort(piece[every[2]], kind="stable")
        search, design, k, value, at_left, at_right, five = (row[order] for row in every)
        left, right, at = theta[lo[k]], theta[hi[k]], theta[k]
        width = right - left
        around = theta[np.clip(k - 2, first[k], last[k] - 5)[:, None] + np.arange(5)]
        forecast = _forecast(
            (around - at[:, None]) / width[:, None], five - value[:, None], (left - at) / width, (right - at) / width
        )
        return cls(
            search=search,
            design=design,
            piece=piece[k],
            left=left,
            right=right,
            at_left=at_left,
            at_right=at_right,
            theta=at,
            value=value,
            top=at + width * forecast.position,
            curvature=forecast.curvature,
            third=forecast.third,
            smooth=forecast.smooth,
            active=~forecast.falls,
        )


class _Forecast(NamedTuple):
    """Highest position of quartics in their brackets (b,), with second and third derivative.

    ``smooth``: it is a maximum; ``falls``: the bracket has none, since the quartic falls off from the end of the piece.
    """

    position: np.ndarray
    curvature: np.ndarray
    third: np.ndarray
    smooth: np.ndarray
    falls: np.ndarray


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _forecast(x: np.ndarray, y: np.ndarray, low: np.ndarray, high: np.ndarray) -> _Forecast:
    """Forecast of the quartics through five nodes (b, 5), one of them at (0, 0), between low and high (b,)."""
    x, y = np.ascontiguousarray(x.T), np.ascontiguousarray(y.T)
    differences = [y]  # Newton's
    for order in range(1, 5):
        differences.append(np.diff(differences[-1], axis=0) / (x[order:] - x[:-order]))
    newton = [row[0] for row in differences]
    powers = [newton[4]]
    for order in (3, 2, 1, 0):  # ((n4 (t - x3) + n3)(t - x2) + n2) ...
        powers = [
            newton[order] - powers[0] * x[order],
            *(a - b * x[order] for a, b in pairwise(powers)),
            powers[-1],
        ]
    _, c1, c2, c3, c4 = powers

    def slope(t: np.ndarray) -> np.ndarray:
        return np.asarray(((4.0 * c4 * t + 3.0 * c3) * t + 2.0 * c2) * t + c1)

    position = np.zeros(low.shape)
    for _ in range(4):
        curvature = (12.0 * c4 * position + 6.0 * c3) * position + 2.0 * c2
        position = np.clip(position - np.where(curvature < 0.0, slope(position) / curvature, 0.0), low, high)
    curvature, third = (12.0 * c4 * position + 6.0 * c3) * position + 2.0 * c2, 24.0 * c4 * position + 6.0 * c3
    outwards = np.where(low == 0.0, -1.0, 1.0)  # for a bracket at an end of its piece
    steep = outwards * np.array([slope(low), slope(0.5 * (low + high)), slope(high)])
    falls = ((low == 0.0) | (high == 0.0)) & (steep.min(axis=0) > 0.5 * steep.max(axis=0))
    return _Forecast(position, curvature, third, (curvature < 0.0) & np.isfinite(position), falls)


Values = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Numbers of brackets (b,) and cam angles (b, k) [rad] -> quantity of every bracket, times its side (b, k)."""


def _values(
    brackets: _Brackets, searches: Sequence[Search], at: At, which: np.ndarray, theta: np.ndarray
) -> np.ndarray:
    if theta.size == 1:  # repeated, so that its bits are those of a single design
        return _values(brackets, searches, at, which.repeat(2), theta.repeat(2, axis=0))[:1]
    count = theta.shape[1]
    rows = at(theta.ravel(), np.repeat(brackets.piece[which], count), np.repeat(brackets.design[which], count))
    out = np.empty(theta.shape)
    for s, (name, side) in enumerate(searches):
        selected = brackets.search[which] == s
        if selected.any():
            out[selected] = side * np.asarray(rows[name]).reshape(theta.shape)[selected]
    return np.where(np.isnan(out), -np.inf, out)


def _step_to_vertices(brackets: _Brackets, values: Values) -> None:
    """One Newton step from the forecast maximum; it finishes brackets whose slope and curvature are as forecast."""
    which = np.flatnonzero(brackets.smooth & brackets.active)
    if not which.size:
        return
    left, right = brackets.left[which], brackets.right[which]
    step = VERTEX_STEP * (right - left)
    position = np.clip(brackets.top[which], left + step, right - step)
    theta = position[:, None] + step[:, None] * np.array([-1.0, 0.0, 1.0])
    value = values(which, theta)
    a, b, c = value.T
    slope, curvature = 0.5 * (c - a), a - 2.0 * b + c
    forecast = VERTEX_STEP * VERTEX_STEP * brackets.curvature[which]
    rounding = 1e2 * EPS * np.abs(b)
    good = np.abs(curvature - forecast) <= CURVATURE_ERROR * np.abs(forecast) + rounding
    good &= (np.abs(slope) <= np.abs(curvature) + rounding) & np.isfinite(curvature)
    _raise(brackets, which, theta, value)
    which, position, step, slope, curvature = (row[good] for row in (which, position, step, slope, curvature))
    brackets.active[which] = False
    part = np.where(curvature < 0.0, -slope / np.where(curvature < 0.0, curvature, 1.0), 0.0)
    part -= 0.5 * VERTEX_STEP * brackets.third[which] / brackets.curvature[which] * part * part
    position = position + step * np.clip(part, -1.5, 1.5)
    position = np.clip(position, brackets.left[which], brackets.right[which])[:, None]
    if which.size:
        _raise(brackets, which, position, values(which, position))


def _raise(brackets: _Brackets, which: np.ndarray, theta: np.ndarray, value: np.ndarray) -> None:
    """Update the highest values of brackets by values (b, k) at cam angles (b, k)."""
    row, top = np.arange(which.size), value.argmax(axis=1)
    more = value[row, top] > brackets.value[which]
    brackets.value[which] = np.where(more, value[row, top], brackets.value[which])
    brackets.theta[which] = np.where(more, theta[row, top], brackets.theta[which])


def _narrow(brackets: _Brackets, tops: np.ndarray, rows: Sequence[np.ndarray], values: Values) -> None:
    """Narrow every active bracket until its possible gain is too small, or cannot reach the highest value of its design."""
    if not brackets.active.any():
        return
    tops = tops.copy()
    np.maximum.at(tops, (brackets.search, brackets.design), brackets.value)
    sizes = np.array([np.abs(row).max(axis=1, where=np.isfinite(row), initial=0.0) for row in rows])
    steps = np.arange(PARTS + 1) / PARTS
    for number in range(PASSES):
        which = np.flatnonzero(brackets.active)
        if not which.size:
            return
        left, right = brackets.left[which], brackets.right[which]
        theta = left[:, None] + (right - left)[:, None] * steps
        value = np.empty(theta.shape)
        value[:, 0], value[:, -1] = brackets.at_left[which], brackets.at_right[which]
        value[:, 1:-1] = values(which, theta[:, 1:-1])
        row = np.arange(which.size)
        top = value.argmax(axis=1)
        low, high = np.maximum(top - 1, 0), np.minimum(top + 1, PARTS)
        _raise(brackets, which, theta, value)
        brackets.left[which], brackets.right[which] = theta[row, low], theta[row, high]
        brackets.at_left[which], brackets.at_right[which] = value[row, low], value[row, high]
        gain = _possible_gain(value, top)
        np.maximum.at(tops, (brackets.search[which], brackets.design[which]), brackets.value[which])
        design_top = tops[brackets.search[which], brackets.design[which]]
        tolerance = TOLERANCE * sizes[brackets.search[which], brackets.design[which]]
        active = (gain > tolerance) & (value[row, top] + gain >= design_top)
        if number + 1 >= SMOOTH_AFTER:
            smooth = active & (top >= 2) & (top <= PARTS - 2)
            has_vertex = _step_to_vertex(which[smooth], theta[smooth], value[smooth], top[smooth], values, brackets)
            active[np.flatnonzero(smooth)[has_vertex]] = False
            creased = smooth & active
            _narrow_to_crease(which[creased], theta[creased], value[creased], top[creased], values, brackets)
        brackets.active[which] = active


def _possible_gain(value: np.ndarray, top: np.ndarray) -> np.ndarray:
    """Possible height above the highest of equally spaced samples (b, k), between it and its neighbours."""
    row, last = np.arange(top.size), value.shape[1] - 1
    best = value[row, top]
    inside = best - np.minimum(value[row, np.maximum(top - 1, 0)], value[row, np.minimum(top + 1, last)])
    inwards = np.where(top == 0, 1, -1)
    at_end = np.abs(best - 2.0 * value[row, top + inwards] + value[row, top + 2 * inwards])
    gain = np.where((top == 0) | (top == last), at_end, inside)
    return np.where(np.isfinite(gain), gain, np.inf)


def _step_to_vertex(
    which: np.ndarray,
    theta: np.ndarray,
    value: np.ndarray,
    top: np.ndarray,
    values: Values,
    brackets: _Brackets,
) -> np.ndarray:
    """One Newton step to the vertex of the quartic through five samples; returns the mask (b,) of brackets that are smooth."""
    row = np.arange(which.size)
    around = value[row[:, None], top[:, None] + np.arange(-2, 3)]
    a, b, _, c, d = (around - around[:, 2:3]).T
    slope, curvature = (a - 8.0 * b + 8.0 * c - d) / 12.0, (-a + 16.0 * b + 16.0 * c - d) / 12.0
    kink = np.abs(a - 4.0 * b - 4.0 * c + d) > 0.1 * np.abs(curvature)
    kink &= np.abs(curvature) > 1e3 * EPS * np.abs(around[:, 2])
    good = ~kink & (curvature < 0.0) & (np.abs(slope) < np.abs(curvature))
    if good.any():
        step = theta[good, 1] - theta[good, 0]
        position = theta[row[good], top[good]] - step * slope[good] / curvature[good]
        _raise(brackets, which[good], position[:, None], values(which[good], position[:, None]))
    return good


def _narrow_to_crease(
    which: np.ndarray, theta: np.ndarray, value: np.ndarray, top: np.ndarray, values: Values, brackets: _Brackets
) -> None:
    """Narrow brackets to the intersection of the lines through two samples on either side, if the quantity is highest there."""
    if not which.size:
        return
    a, b, _, c, d = value[np.arange(which.size)[:, None], top[:, None] + np.arange(-2, 3)].T
    slope_change = (b - a) - (d - c)
    convex = slope_change > 0.0
    intersection = np.where(convex, (2.0 * c - d - 2.0 * b + a) / np.where(convex, slope_change, 1.0), 0.0)
    near = top[:, None] + np.clip(intersection, -1.0, 1.0)[:, None] + CREASE * np.array([-1.0, 0.0, 1.0])
    at = theta[:, :1] + (theta[:, 1:2] - theta[:, :1]) * near
    crease = values(which, at)
    _raise(brackets, which, at, crease)
    inside = (crease.argmax(axis=1) == 1) & (at[:, 0] > brackets.left[which]) & (at[:, 2] < brackets.right[which])
    selected = which[inside]
    brackets.left[selected], brackets.right[selected] = at[inside, 0], at[inside, 2]
    brackets.at_left[selected], brackets.at_right[selected] = crease[inside, 0], crease[inside, 2]


# -- nodes -------------------------------------------------------------------------------------------------


def clenshaw_curtis_nodes(program: Any) -> tuple[Angles, np.ndarray]:
    """Nodes and weights of Clenshaw and Curtis over one turn, piece by piece, with both ends of every piece.

    Parameters
    ----------
    program : CompiledMotion or CrankMotion
        Pieces of the turn; a dwell has fewer nodes.

    Returns
    -------
    angles : Angles (n,)
        The nodes, which bracket extremes.
    weights : ndarray (n,), dimensionless
        Weights of a mean over the turn; their sum is 1.

    References
    ----------
    Clenshaw and Curtis (1960), A method for numerical integration on an automatic computer.
    """
    theta, piece, weight = [], [], []
    is_moving = np.broadcast_to(getattr(program, "velocity_signs", 1.0), program.starts.shape) != 0.0
    for i, (a, b) in enumerate(zip(program.starts.tolist(), program.ends.tolist(), strict=True)):
        count = min(
            max(ceil((b - a) / (DENSE if is_moving[i] else SPARSE)) | 1, MIN_NODES if is_moving[i] else 5), MAX_NODES
        )
        x, w = _clenshaw_curtis(count)
        theta.append(a + (b - a) * x)
        theta[-1][-1] = b
        weight.append(w * ((b - a) / TURN))
        piece.append(np.full(count, i))
    return Angles(np.concatenate(theta), np.concatenate(piece)), np.concatenate(weight)


@lru_cache(maxsize=128)
def _clenshaw_curtis(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (count,) from 0 to 1, an odd number, and their weights (count,)."""
    n = count - 1
    k = np.arange(count)
    x = np.sin(0.5 * np.pi * k / n) ** 2
    j = np.arange(1, n // 2 + 1)
    b = np.where(2 * j == n, 1.0, 2.0) / (4.0 * j * j - 1.0)
    w = (1.0 - (np.cos(2.0 * np.pi * np.outer(k, j) / n) * b).sum(axis=1)) / n
    w[[0, -1]] *= 0.5
    return x, w
