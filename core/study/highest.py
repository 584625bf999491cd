"""Extremes over the turn of many designs at once: bracketed by the nodes that all share, refined design by design.

A design's answer does not depend on which others are searched with it: every bracket is narrowed by itself, and left when it is done.
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
LEAST, MOST = 13, 129  # nodes of a piece
PARTS = 8  # that a bracket is cut into where its quantity is not smooth
PASSES = 16
SMOOTH_AFTER = 2  # passes: then a parabola takes over where it is smooth
BESIDE = 0.02  # of a bracket: how far from a foreseen maximum slope and bend are taken
CREASE = 0.03  # of the distance of samples: how near a crease is to where the lines on its two sides meet
ALIKE = 0.3  # of the bend of the quartic through the nodes: what that found there may differ by
ENOUGH = 1e-11  # of the largest value: what may still be found above
SAME = 1e-9  # of an extreme: of values that are equal to that the smallest cam angle is named

At = Callable[[np.ndarray, np.ndarray, np.ndarray], Mapping[str, np.ndarray]]
"""Cam angles, pieces and designs, each (n,) -> the quantities (n,) by name."""


class Search(NamedTuple):
    """A quantity, and the side of its extreme: 1 the highest, -1 the lowest value."""

    name: str
    side: float


@np.errstate(invalid="ignore", over="ignore")  # infinite values, of which nothing is refined
def refined_extremes(
    searches: Sequence[Search], sampled: Mapping[str, np.ndarray], angles: Angles, at: At, polish: bool
) -> dict[Search, tuple[np.ndarray, np.ndarray]]:
    """Value and cam angle [rad] of each search, both (m,), from the quantities (m, n) at the nodes (n,) of m designs. NaN is left out;
    of a design that is NaN throughout the value is NaN."""
    if not searches:
        return {}
    rows = [-sampled[name] if side < 0.0 else sampled[name] for name, side in searches]
    tops = np.array([row.max(axis=1) for row in rows])
    for s in np.flatnonzero(np.isnan(tops).any(axis=1)).tolist():
        rows[s] = np.where(np.isnan(rows[s]), -np.inf, rows[s])
        tops[s] = rows[s].max(axis=1)
    of_nodes = tops.copy()
    if not polish:
        return {
            search: (search.side * value, np.mod(theta, TURN))
            for search, (value, theta) in zip(searches, (_between_nodes(row, angles) for row in rows), strict=True)
        }
    brackets = _Brackets.of(rows, tops, angles)
    values = partial(_values, brackets, searches, at)
    _at_vertices(brackets, values)
    _narrowed(brackets, tops, rows, values)
    places = np.mod(angles.theta, TURN)
    order = np.argsort(places, kind="stable")
    found = {}
    for s, (search, row) in enumerate(zip(searches, rows, strict=True)):
        mine = brackets.search == s
        design, own, own_places = brackets.design[mine], brackets.value[mine], np.mod(brackets.theta[mine], TURN)
        np.maximum.at(tops[s], design, own)
        least = tops[s] - np.where(np.isfinite(tops[s]), SAME * np.abs(tops[s]), 0.0)
        theta = np.full(least.shape, np.inf)
        there = np.flatnonzero(of_nodes[s] >= least)
        theta[there] = places[order][(row[there] >= least[there, None])[:, order].argmax(axis=1)]
        near = own >= least[design]
        np.minimum.at(theta, design[near], own_places[near])
        nothing = np.isneginf(tops[s])
        nothing[nothing] = np.isnan(sampled[search.name][nothing]).all(axis=1)
        found[search] = np.where(nothing, np.nan, search.side * tops[s]), np.where(nothing, np.nan, theta)
    return found


def _between_nodes(row: np.ndarray, angles: Angles) -> tuple[np.ndarray, np.ndarray]:
    """The highest of values (m, n) at nodes (n,) and where [rad], both (m,): at the vertex of the parabola through it and its
    neighbours, where those beside are bent alike, so that there is no kink."""
    theta, last = angles.theta, angles.theta.size - 1
    near = row >= (row.max(axis=1) * (1.0 - np.sign(row.max(axis=1)) * SAME))[:, None]
    top = near.argmax(axis=1)
    index = np.clip(top[:, None] + np.arange(-2, 3), 0, last)
    x, y = theta[index], np.take_along_axis(row, index, axis=1)
    inside = (angles.piece[index] == angles.piece[index[:, 2:3]]).all(axis=1) & (np.diff(index, axis=1) > 0).all(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = np.diff(y, axis=1) / np.diff(x, axis=1)
        bends = np.diff(slopes, axis=1) / (x[:, 2:] - x[:, :-2])
        first = slopes[:, 1] + bends[:, 1] * (x[:, 2] - x[:, 1])
        alike = inside & (bends[:, 1] < 0.0) & (np.maximum(bends[:, 0], bends[:, 2]) < 0.3 * bends[:, 1])
        step = np.where(alike, -0.5 * first / bends[:, 1], 0.0)
        value = y[:, 2] + np.where(alike, 0.5 * first * step, 0.0)
    value = np.where(np.isneginf(value), np.nan, value)
    return value, np.where(np.isnan(value), np.nan, x[:, 2] + step)


class _Brackets:
    """Local maxima of searches in designs (b,), piece by piece: their ends with the values there, the highest place found, and whether
    it is still looked for.

    top    (b,) where the quartic through five nodes has its maximum; bend and third: its derivatives there by part of the bracket
    smooth (b,) whether it has one there
    """

    def __init__(self, **rows: np.ndarray) -> None:
        self.search, self.design, self.piece = rows["search"], rows["design"], rows["piece"]
        self.left, self.right = rows["left"], rows["right"]
        self.at_left, self.at_right = rows["at_left"], rows["at_right"]
        self.theta, self.value = rows["theta"], rows["value"]
        self.top, self.bend, self.third = rows["top"], rows["bend"], rows["third"]
        self.smooth, self.active = rows["smooth"], rows["active"]

    @classmethod
    def of(cls, rows: Sequence[np.ndarray], tops: np.ndarray, angles: Angles) -> _Brackets:
        """The nodes no lower than their neighbours, and higher than one, that may hold the highest value."""
        theta, piece, n, parts = angles.theta, angles.piece, angles.theta.size, []
        at = np.arange(n)
        ends = np.diff(piece) != 0
        starts, stops = np.append(True, ends), np.append(ends, True)
        first, last = (np.searchsorted(piece, piece, side=side) for side in ("left", "right"))
        lo, hi, inwards = np.where(starts, at, at - 1), np.where(stops, at, at + 1), np.where(starts, 1, -1)
        wider = np.where(stops, 1.0, theta[hi] - theta) / np.where(starts, 1.0, theta - theta[lo])
        weights = np.maximum(wider, 1.0), np.maximum(1.0 / wider, 1.0)
        gaps = np.array([theta[np.clip(at + k * inwards, 0, n - 1)] - theta for k in (1, 2)])  # of ends of pieces
        for s, row in enumerate(rows):
            flat, top = row.ravel(), tops[s]
            rises, falls = np.zeros((2, flat.size + 1), dtype=bool)  # up to each node, and on from the last one
            np.greater(flat[1:], flat[:-1], out=rises[1:-1])
            np.less(flat[1:], flat[:-1], out=falls[1:-1])
            for each in (rises, falls):
                each[:-1].reshape(row.shape)[:, starts] = False
            found = np.flatnonzero(
                (rises[:-1] | falls[1:]) & ~(falls[:-1] | rises[1:])
            )  # higher than one, lower than none
            at_end = (starts | stops)[found % n]
            some, end = found[~at_end], found[at_end]
            k, own = some % n, flat[some]
            room = np.maximum((own - flat[some - 1]) * weights[0][k], (own - flat[some + 1]) * weights[1][k])
            some = some[~(own + room < top[some // n]) & np.isfinite(own)]
            k, own = end % n, flat[end]
            one, two = flat[end + inwards[k]], flat[end + 2 * inwards[k]]
            steep, then = (own - one) / gaps[0, k], (one - two) / (gaps[1, k] - gaps[0, k])
            turn = np.abs((then - steep) * gaps[0, k] / gaps[1, k])
            falls_off = 3.0 * turn < np.abs(steep)  # of the parabola both ends are at least half as steep as the other
            keep = ~(own + np.abs(own - 2.0 * one + two) < top[end // n]) & np.isfinite(own) & ~falls_off
            found = np.concatenate((some, end[keep]))
            d, k = found // n, found % n
            own, low, high = flat[found], lo[k], hi[k]
            five = np.clip(k - 2, first[k], last[k] - 5)[:, None] + np.arange(5)
            width = theta[high] - theta[low]
            forecast = _forecast(
                (theta[five] - theta[k][:, None]) / width[:, None], row[d[:, None], five] - own[:, None],
                (theta[low] - theta[k]) / width, (theta[high] - theta[k]) / width,
            )  # fmt: skip
            parts.append(
                {
                    "search": np.full(d.size, s),
                    "design": d,
                    "piece": piece[k],
                    "left": theta[low],
                    "right": theta[high],
                    "at_left": row[d, low],
                    "at_right": row[d, high],
                    "theta": theta[k],
                    "value": own,
                    "top": theta[k] + width * forecast.place,
                    "bend": forecast.bend,
                    "third": forecast.third,
                    "smooth": forecast.smooth,
                    "active": ~forecast.falls,
                }
            )
        every = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        order = np.argsort(every["piece"], kind="stable")
        return cls(**{name: row[order] for name, row in every.items()})


class _Forecast(NamedTuple):
    """The highest place of quartics in their brackets (b,), with second and third derivative; smooth: it is a maximum; falls: the
    bracket has none, as it falls off from the end of the piece."""

    place: np.ndarray
    bend: np.ndarray
    third: np.ndarray
    smooth: np.ndarray
    falls: np.ndarray


@np.errstate(divide="ignore", invalid="ignore", over="ignore")
def _forecast(x: np.ndarray, y: np.ndarray, low: np.ndarray, high: np.ndarray) -> _Forecast:
    """Of the quartics through five nodes (b, 5), of which one is (0, 0), between low and high (b,)."""
    x, y = np.ascontiguousarray(x.T), np.ascontiguousarray(y.T)
    differences = [y]  # Newton's
    for order in range(1, 5):
        differences.append(np.diff(differences[-1], axis=0) / (x[order:] - x[:-order]))
    newton = [each[0] for each in differences]
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

    place = np.zeros(low.shape)
    for _ in range(4):
        bend = (12.0 * c4 * place + 6.0 * c3) * place + 2.0 * c2
        place = np.clip(place - np.where(bend < 0.0, slope(place) / bend, 0.0), low, high)
    bend, third = (12.0 * c4 * place + 6.0 * c3) * place + 2.0 * c2, 24.0 * c4 * place + 6.0 * c3
    outwards = np.where(low == 0.0, -1.0, 1.0)  # of a bracket at one end of its piece
    steep = outwards * np.array([slope(low), slope(0.5 * (low + high)), slope(high)])
    falls = ((low == 0.0) | (high == 0.0)) & (steep.min(axis=0) > 0.5 * steep.max(axis=0))
    return _Forecast(place, bend, third, (bend < 0.0) & np.isfinite(place), falls)


Values = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Numbers of brackets (b,) and cam angles (b, k) -> the quantity of each, on its side, (b, k)."""


def _values(
    brackets: _Brackets, searches: Sequence[Search], at: At, which: np.ndarray, theta: np.ndarray
) -> np.ndarray:
    if theta.size == 1:  # as of a single design: with a neighbour it keeps its bits
        return _values(brackets, searches, at, which.repeat(2), theta.repeat(2, axis=0))[:1]
    count = theta.shape[1]
    found = at(theta.ravel(), np.repeat(brackets.piece[which], count), np.repeat(brackets.design[which], count))
    out = np.empty(theta.shape)
    for s, (name, side) in enumerate(searches):
        mine = brackets.search[which] == s
        if mine.any():
            out[mine] = side * np.asarray(found[name]).reshape(theta.shape)[mine]
    return np.where(np.isnan(out), -np.inf, out)


def _at_vertices(brackets: _Brackets, values: Values) -> None:
    """Brackets with a smooth maximum are done by one step of Newton's from where the nodes foresee it; those whose slope and bend are
    others than foreseen stay."""
    which = np.flatnonzero(brackets.smooth & brackets.active)
    if not which.size:
        return
    left, right = brackets.left[which], brackets.right[which]
    step = BESIDE * (right - left)
    place = np.clip(brackets.top[which], left + step, right - step)
    theta = place[:, None] + step[:, None] * np.array([-1.0, 0.0, 1.0])
    value = values(which, theta)
    a, b, c = value.T
    slope, bend, foreseen = 0.5 * (c - a), a - 2.0 * b + c, BESIDE * BESIDE * brackets.bend[which]
    rounding = 1e2 * EPS * np.abs(b)
    good = np.abs(bend - foreseen) <= ALIKE * np.abs(foreseen) + rounding
    good &= (np.abs(slope) <= np.abs(bend) + rounding) & np.isfinite(bend)
    _raise(brackets, which, theta, value)
    which, place, step, slope, bend = (each[good] for each in (which, place, step, slope, bend))
    brackets.active[which] = False
    part = np.where(bend < 0.0, -slope / np.where(bend < 0.0, bend, 1.0), 0.0)
    part -= 0.5 * BESIDE * brackets.third[which] / brackets.bend[which] * part * part
    place = np.clip(place + step * np.clip(part, -1.5, 1.5), brackets.left[which], brackets.right[which])[:, None]
    if which.size:
        _raise(brackets, which, place, values(which, place))


def _raise(brackets: _Brackets, which: np.ndarray, theta: np.ndarray, value: np.ndarray) -> None:
    """Take note of what stands higher: values (b, k) at cam angles (b, k)."""
    row, top = np.arange(which.size), value.argmax(axis=1)
    more = value[row, top] > brackets.value[which]
    brackets.value[which] = np.where(more, value[row, top], brackets.value[which])
    brackets.theta[which] = np.where(more, theta[row, top], brackets.theta[which])


def _narrowed(brackets: _Brackets, tops: np.ndarray, rows: Sequence[np.ndarray], values: Values) -> None:
    """Narrow each bracket that is left until what may stand above its highest value is too little, or cannot be the highest."""
    if not brackets.active.any():
        return
    tops = tops.copy()
    np.maximum.at(tops, (brackets.search, brackets.design), brackets.value)
    sizes = np.array([np.abs(row).max(axis=1, where=np.isfinite(row), initial=0.0) for row in rows])
    steps = np.arange(PARTS + 1) / PARTS
    for turn in range(PASSES):
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
        room = _room(value, top)
        np.maximum.at(tops, (brackets.search[which], brackets.design[which]), brackets.value[which])
        own_top = tops[brackets.search[which], brackets.design[which]]
        enough = ENOUGH * sizes[brackets.search[which], brackets.design[which]]
        going = (room > enough) & (value[row, top] + room >= own_top)
        if turn + 1 >= SMOOTH_AFTER:
            smooth = going & (top >= 2) & (top <= PARTS - 2)
            vertex = _vertex(which[smooth], theta[smooth], value[smooth], top[smooth], values, brackets)
            going[np.flatnonzero(smooth)[vertex]] = False
            creased = smooth & going
            _to_crease(which[creased], theta[creased], value[creased], top[creased], values, brackets)
        brackets.active[which] = going


def _room(value: np.ndarray, top: np.ndarray) -> np.ndarray:
    """What may stand above the highest of equally spaced samples (b, k), between it and its neighbours: as in ``motion.extremes``."""
    row, last = np.arange(top.size), value.shape[1] - 1
    best = value[row, top]
    inside = best - np.minimum(value[row, np.maximum(top - 1, 0)], value[row, np.minimum(top + 1, last)])
    inwards = np.where(top == 0, 1, -1)
    at_end = np.abs(best - 2.0 * value[row, top + inwards] + value[row, top + 2 * inwards])
    room = np.where((top == 0) | (top == last), at_end, inside)
    return np.where(np.isfinite(room), room, np.inf)


def _vertex(
    which: np.ndarray,
    theta: np.ndarray,
    value: np.ndarray,
    top: np.ndarray,
    values: Values,
    brackets: _Brackets,
) -> np.ndarray:
    """Of brackets that are smooth the value at the vertex of the quartic through five samples, by one Newton step; gives which were
    (b,)."""
    row = np.arange(which.size)
    around = value[row[:, None], top[:, None] + np.arange(-2, 3)]
    a, b, _, c, d = (around - around[:, 2:3]).T
    slope, bend = (a - 8.0 * b + 8.0 * c - d) / 12.0, (-a + 16.0 * b + 16.0 * c - d) / 12.0
    kink = (np.abs(a - 4.0 * b - 4.0 * c + d) > 0.1 * np.abs(bend)) & (np.abs(bend) > 1e3 * EPS * np.abs(around[:, 2]))
    good = ~kink & (bend < 0.0) & (np.abs(slope) < np.abs(bend))
    if good.any():
        step = theta[good, 1] - theta[good, 0]
        place = theta[row[good], top[good]] - step * slope[good] / bend[good]
        _raise(brackets, which[good], place[:, None], values(which[good], place[:, None]))
    return good


def _to_crease(
    which: np.ndarray, theta: np.ndarray, value: np.ndarray, top: np.ndarray, values: Values, brackets: _Brackets
) -> None:
    """Narrow brackets to where the lines through two samples on either side meet, if the quantity is highest there."""
    if not which.size:
        return
    a, b, _, c, d = value[np.arange(which.size)[:, None], top[:, None] + np.arange(-2, 3)].T
    bend = (b - a) - (d - c)
    meet = np.where(bend > 0.0, (2.0 * c - d - 2.0 * b + a) / np.where(bend > 0.0, bend, 1.0), 0.0)
    near = top[:, None] + np.clip(meet, -1.0, 1.0)[:, None] + CREASE * np.array([-1.0, 0.0, 1.0])
    place = theta[:, :1] + (theta[:, 1:2] - theta[:, :1]) * near
    found = values(which, place)
    _raise(brackets, which, place, found)
    inside = (found.argmax(axis=1) == 1) & (place[:, 0] > brackets.left[which]) & (place[:, 2] < brackets.right[which])
    mine = which[inside]
    brackets.left[mine], brackets.right[mine] = place[inside, 0], place[inside, 2]
    brackets.at_left[mine], brackets.at_right[mine] = found[inside, 0], found[inside, 2]


# -- nodes -------------------------------------------------------------------------------------------------


def clenshaw_curtis_nodes(program: Any) -> tuple[Angles, np.ndarray]:
    """Nodes (n,) of one turn by which extremes are bracketed, and the weights (n,) of a mean: of every piece those of Clenshaw and
    Curtis, both its ends among them."""
    theta, piece, weight = [], [], []
    moves = np.broadcast_to(getattr(program, "velocity_signs", 1.0), program.starts.shape) != 0.0
    for i, (a, b) in enumerate(zip(program.starts.tolist(), program.ends.tolist(), strict=True)):
        count = min(max(ceil((b - a) / (DENSE if moves[i] else SPARSE)) | 1, LEAST if moves[i] else 5), MOST)
        x, w = _clenshaw_curtis(count)
        theta.append(a + (b - a) * x)
        theta[-1][-1] = b
        weight.append(w * ((b - a) / TURN))
        piece.append(np.full(count, i))
    return Angles(np.concatenate(theta), np.concatenate(piece)), np.concatenate(weight)


@lru_cache(maxsize=128)
def _clenshaw_curtis(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes 0 ... 1 (count,), an odd number of them, and their weights."""
    n = count - 1
    k = np.arange(count)
    x = np.sin(0.5 * np.pi * k / n) ** 2
    j = np.arange(1, n // 2 + 1)
    b = np.where(2 * j == n, 1.0, 2.0) / (4.0 * j * j - 1.0)
    w = (1.0 - (np.cos(2.0 * np.pi * np.outer(k, j) / n) * b).sum(axis=1)) / n
    w[[0, -1]] *= 0.5
    return x, w
