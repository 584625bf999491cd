"""Extremes over the turn of many designs at once: bracketed by the nodes that all share, refined design by design.

A design's answer does not depend on which others are searched with it: every bracket is narrowed by itself, and left when it is done.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from core.motion import EPS, TURN, Angles

DENSE, SPARSE = np.deg2rad(3.6), np.deg2rad(15.0)  # mean distance of nodes, in a dwell
LEAST, MOST = 13, 129  # nodes of a piece
PARTS = 8  # that a bracket is cut into
PASSES = 16
SMOOTH_AFTER = 2  # passes: then a parabola takes over where it is smooth
ENOUGH = 1e-9  # of the largest value: what may still be found above
SAME = 1e-9  # of an extreme: of values that are equal to that the smallest cam angle is named

At = Callable[[np.ndarray, np.ndarray, np.ndarray], Mapping[str, np.ndarray]]
"""Cam angles, pieces and designs, each (n,) -> the quantities (n,) by name."""


class Search(NamedTuple):
    """A quantity, and the side of its extreme: 1 the highest, -1 the lowest value."""

    name: str
    side: float


@np.errstate(invalid="ignore", over="ignore")  # infinite values, of which nothing is refined
def refined(
    searches: Sequence[Search], sampled: Mapping[str, np.ndarray], angles: Angles, at: At, polish: bool
) -> dict[Search, tuple[np.ndarray, np.ndarray]]:
    """Value and cam angle [rad] of each search, both (m,), from the quantities (m, n) at the nodes (n,) of m designs. NaN is left out;
    of a design that is NaN throughout the value is NaN."""
    if not searches:
        return {}
    rows = [side * sampled[name] for name, side in searches]
    rows = [np.where(np.isnan(row), -np.inf, row) for row in rows]
    tops = np.array([row.max(axis=1) for row in rows])
    if not polish:
        return {
            search: (search.side * value, np.mod(theta, TURN))
            for search, (value, theta) in zip(searches, (_between_nodes(row, angles) for row in rows), strict=True)
        }
    brackets = _Brackets.of(rows, tops, angles)
    _narrowed(
        brackets,
        searches,
        tops,
        np.array([np.abs(row).max(axis=1, where=np.isfinite(row), initial=0.0) for row in rows]),
        at,
    )
    found = {}
    for s, (search, row) in enumerate(zip(searches, rows, strict=True)):
        mine = brackets.search == s
        design, own, places = brackets.design[mine], brackets.value[mine], np.mod(brackets.theta[mine], TURN)
        np.maximum.at(tops[s], design, own)
        least = tops[s] - np.where(np.isfinite(tops[s]), SAME * np.abs(tops[s]), 0.0)
        theta = np.where(row >= least[:, None], np.mod(angles.theta, TURN), np.inf).min(axis=1)
        near = own >= least[design]
        np.minimum.at(theta, design[near], places[near])
        nothing = np.isnan(sampled[search.name]).all(axis=1)
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
    """Local maxima of searches in designs (b,): their ends with the values there, the highest place found, and what may stand above."""

    def __init__(self, **rows: np.ndarray) -> None:
        self.search, self.design, self.piece = rows["search"], rows["design"], rows["piece"]
        self.left, self.right = rows["left"], rows["right"]
        self.at_left, self.at_right = rows["at_left"], rows["at_right"]
        self.theta, self.value = rows["theta"], rows["value"]
        self.active = np.ones(self.search.size, dtype=bool)

    @classmethod
    def of(cls, rows: Sequence[np.ndarray], tops: np.ndarray, angles: Angles) -> _Brackets:
        """The nodes no lower than their neighbours, and higher than one, that may hold the highest value."""
        theta, parts = angles.theta, []
        ends = np.diff(angles.piece) != 0
        starts, stops = np.append(True, ends), np.append(ends, True)
        gap = np.abs(np.diff(theta, prepend=theta[-1], append=theta[0]))
        before_gap, after_gap = np.where(starts, 1.0, gap[:-1]), np.where(stops, 1.0, gap[1:])
        wider = after_gap / before_gap
        for s, row in enumerate(rows):
            before, after = np.roll(row, 1, axis=1), np.roll(row, -1, axis=1)
            left, right = np.where(starts, -np.inf, before), np.where(stops, -np.inf, after)
            higher = ((row > left) & ~starts) | ((row > right) & ~stops)
            local = (row >= left) & (row >= right) & higher & np.isfinite(row)
            inside = np.maximum((row - left) * np.maximum(wider, 1.0), (row - right) * np.maximum(1.0 / wider, 1.0))
            first = np.abs(row - 2.0 * after + np.roll(row, -2, axis=1))
            last = np.abs(row - 2.0 * before + np.roll(row, 2, axis=1))
            room = np.where(starts, first, np.where(stops, last, inside))
            room = np.where(np.isfinite(room), room, np.inf)
            d, k = np.nonzero(local & (row + room >= tops[s][:, None]))
            lo, hi = np.where(starts[k], k, k - 1), np.where(stops[k], k, k + 1)
            parts.append(
                (
                    np.full(d.size, s),
                    d,
                    angles.piece[k],
                    theta[lo],
                    theta[hi],
                    row[d, lo],
                    row[d, hi],
                    theta[k],
                    row[d, k],
                )
            )
        names = ("search", "design", "piece", "left", "right", "at_left", "at_right", "theta", "value")
        return cls(**{name: np.concatenate(each) for name, each in zip(names, zip(*parts, strict=True), strict=True)})


def _narrowed(brackets: _Brackets, searches: Sequence[Search], tops: np.ndarray, sizes: np.ndarray, at: At) -> None:
    """Narrow each bracket until what may stand above its highest value is too little, or cannot be the highest."""
    tops = tops.copy()

    def values(which: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Of the quantity of each bracket (b,), at cam angles (b, k)."""
        count = theta.shape[1]
        found = at(theta.ravel(), np.repeat(brackets.piece[which], count), np.repeat(brackets.design[which], count))
        out = np.empty(theta.shape)
        for s, (name, side) in enumerate(searches):
            mine = brackets.search[which] == s
            if mine.any():
                out[mine] = side * np.asarray(found[name]).reshape(theta.shape)[mine]
        return np.where(np.isnan(out), -np.inf, out)

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
        best = value[row, top]
        more = best > brackets.value[which]
        brackets.value[which] = np.where(more, best, brackets.value[which])
        brackets.theta[which] = np.where(more, theta[row, top], brackets.theta[which])
        brackets.left[which], brackets.right[which] = theta[row, low], theta[row, high]
        brackets.at_left[which], brackets.at_right[which] = value[row, low], value[row, high]
        room = _room(value, top)
        np.maximum.at(tops, (brackets.search[which], brackets.design[which]), brackets.value[which])
        own_top = tops[brackets.search[which], brackets.design[which]]
        enough = ENOUGH * sizes[brackets.search[which], brackets.design[which]]
        going = (room > enough) & (brackets.value[which] + room >= own_top)
        if turn + 1 >= SMOOTH_AFTER:
            smooth = going & (top >= 2) & (top <= PARTS - 2)
            vertex = _vertex(which[smooth], theta[smooth], value[smooth], top[smooth], values, brackets)
            going[np.flatnonzero(smooth)[vertex]] = False
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
    values: Callable[[np.ndarray, np.ndarray], np.ndarray],
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
        there = values(which[good], place[:, None])[:, 0]
        mine = which[good]
        more = there > brackets.value[mine]
        brackets.theta[mine] = np.where(more, place, brackets.theta[mine])
        brackets.value[mine] = np.where(more, there, brackets.value[mine])
    return good


# -- nodes -------------------------------------------------------------------------------------------------


def nodes_of(program: Any) -> tuple[Angles, np.ndarray]:
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
