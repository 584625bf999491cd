"""How far what a controller runs is from the exact curve: of every piece, and the largest of the turn, refined."""

from __future__ import annotations

import numpy as np

from core.frozen import frozen
from core.motion import Angles
from core.motion.extremes import find_highest
from core.output.controllers.interpolation import KINDS, Table, evaluated
from core.output.controllers.slave import NEAR, TURN, Slave

SAMPLES = ((100, 17), (1000, 9), (10**9, 7))  # of a piece, its ends among them, where there are fewer rows than so many
MANY = 33  # of one within which the curve jumps
COARSE, COARSE_REACH = 5, 4  # samples, and rows on either side, where some per cent will do
FEW, TOPS = 1000, 64  # of more pieces than so many only those are refined that err most
QUANTITIES = ("deviation", "velocity", "acceleration")


@frozen
class Deviation:
    """Largest errors of value, velocity and acceleration [unit, per degree], and the angles of the master [deg] where they stand;
    as many as the interpolation has derivatives."""

    values: tuple[float, ...]
    at_deg: tuple[float, ...]


def table_at(slave: Slave, x: np.ndarray, orders: int = 3) -> Table:
    """The rows of a table at angles x (n,) [deg]; where something jumps the mean of both sides, which leaves the smaller error."""
    return _between(x, *slave.sides(x, orders))


def _between(x: np.ndarray, before: np.ndarray, behind: np.ndarray) -> Table:
    states = 0.5 * (before + behind)
    return Table(x, states, (float(states[1, 0]), float(states[1, -1])) if states.shape[0] > 1 else (0.0, 0.0))


class _Smooth:
    """The intervals within which both a table's pieces, from ``a`` to ``b`` (n,) [deg], and the exact curve are smooth.

    row     (m,) the piece that an interval is part of; first, last (n,) intervals of each piece
    piece   (m,) that of the exact curve
    starts, ends  (m,) [deg]
    """

    def __init__(self, slave: Slave, a: np.ndarray, b: np.ndarray) -> None:
        begin = np.searchsorted(slave.edges, a + NEAR, side="right")
        inside = np.maximum(np.searchsorted(slave.edges, b - NEAR) - begin, 0)
        self.row = np.repeat(np.arange(a.size), inside + 1)
        self.last = np.cumsum(inside + 1) - 1
        self.first = self.last - inside
        number = np.arange(self.row.size) - self.first[self.row]
        self.piece = np.clip(begin[self.row] + number - 1, 0, slave.edges.size - 2)
        self.starts = np.where(number == 0, a[self.row], slave.edges[self.piece])
        self.ends = np.where(number == inside[self.row], b[self.row], slave.edges[self.piece + 1])
        self._slave, self._a = slave, a

    def sampled(self, count: int, orders: int) -> tuple[np.ndarray, np.ndarray]:
        """So many angles of each interval, both ends among them, from the start of its row (m, count) [deg]; and the exact curve there
        (orders, m, count)."""
        w = (self.ends - self.starts)[:, None] * _parts(count)
        at = self.starts[:, None] + w  # in rising order, which is evaluated soonest
        at[:, -1] = self.ends
        piece, known = self.piece, np.empty((orders, *at.shape))
        order = np.argsort(piece, kind="stable")
        known[:, order] = self._slave.state(at[order].ravel(), np.repeat(piece[order], count), orders).reshape(
            known.shape
        )
        return at - self._a[self.row, None], known

    def errors(self, coefficients: np.ndarray, w: np.ndarray, known: np.ndarray, orders: int) -> np.ndarray:
        """The largest error of every interval (orders, m), by samples and a parabola through the highest of them."""
        return _peaks(np.abs(evaluated(coefficients[:, self.row, None], w, orders) - known[:orders]))

    def worst(
        self, coefficients: np.ndarray, w: np.ndarray, known: np.ndarray, orders: int, many: int = MANY
    ) -> np.ndarray:
        """The largest error of every piece (orders, n); many: samples of one within which the curve jumps."""
        made = np.maximum.reduceat(self.errors(coefficients, w, known, orders), self.first, axis=1)
        parted = self.last > self.first
        if w.shape[1] < many and parted.any():
            near = _Smooth(self._slave, self.starts[self.first[parted]], self.ends[self.last[parted]])
            made[:, parted] = near.worst(coefficients[:, parted], *near.sampled(many, orders), orders)
        return np.asarray(made)


def _samples(rows: int) -> int:
    return next(count for fewer, count in SAMPLES if rows < fewer)


def piece_errors(slave: Slave, kind: str, x: np.ndarray, orders: int = 1) -> np.ndarray:
    """Largest errors (orders, n - 1) of value and derivatives between rows at angles x (n,) [deg]. The first and the last sample of a
    piece are what its rows hold, so that the motion is evaluated once."""
    row, smooth = KINDS[kind], _Smooth(slave, x[:-1], x[1:])
    w, known = smooth.sampled(_samples(x.size), max(orders, row.needs))
    starts, ends = known[:, smooth.first, 0], known[:, smooth.last, -1]
    table = _between(x, np.column_stack((starts[:, :1], ends)), np.column_stack((starts, ends[:, -1:])))
    return smooth.worst(row.coefficients(table), w, known, orders)


def errors_near(
    slave: Slave, kind: str, steps: np.ndarray, place: float, orders: int = 1, coarse: bool = False
) -> np.ndarray:
    """The same (orders, k) in tables of so many equal steps (k,), of the piece in which an angle [deg] lies; coarse: to some per cent.

    What runs through all rows is solved for those near it, which hold nearly all of what it does there: of more than 2 reach steps.
    """
    row = KINDS[kind]
    reach = min(row.reach, COARSE_REACH) if coarse else row.reach
    at = np.floor(place / TURN * steps)
    first = np.clip(at - reach, 0, steps - 1 - 2 * reach)
    x = TURN * (first + np.arange(2 * reach + 2)[:, None]) / steps
    states = table_at(slave, x.ravel(), max(1, row.needs)).states.reshape(-1, *x.shape)
    if reach:
        coefficients = row.of_equal(TURN / steps, states)[:, (at - first).astype(int), np.arange(steps.size)]
    else:  # pieces that need not join, one behind the other: what runs from one to the next nobody looks at
        table = Table(x.T.ravel(), states.swapaxes(1, 2).reshape(states.shape[0], -1))
        coefficients = row.coefficients(table)[:, ::2]
    smooth = _Smooth(slave, TURN * at / steps, TURN * (at + 1.0) / steps)
    count = COARSE if coarse else _samples(int(steps.min()))
    return smooth.worst(coefficients, *smooth.sampled(count, orders), orders, COARSE if coarse else MANY)


def _parts(count: int) -> np.ndarray:
    return np.asarray(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count)))


def _peaks(errors: np.ndarray) -> np.ndarray:
    """The largest of samples (orders, n, k), each with what a parabola through it and its neighbours adds."""
    parts = _parts(errors.shape[2])
    top = errors.argmax(axis=2)
    beside = np.clip(top, 1, parts.size - 2)
    left, highest, right = (np.take_along_axis(errors, (beside + k)[:, :, None], axis=2)[:, :, 0] for k in (-1, 0, 1))
    before, behind = parts[beside] - parts[beside - 1], parts[beside + 1] - parts[beside]
    rise, fall = (highest - left) / before, (highest - right) / behind
    slope = (rise * behind - fall * before) / (before + behind)
    bend = np.maximum((rise + fall) / (before + behind), 1e-300)
    added = np.where(top == beside, np.minimum(slope**2 / (4.0 * bend), 0.25 * highest), 0.0)
    return np.asarray(errors.max(axis=2) + added)


class _Pieces:
    """Where the largest errors are looked for: ``starts``, ``ends`` (m,) [rad]."""

    def __init__(self, starts: np.ndarray, ends: np.ndarray) -> None:
        self.starts, self.ends = np.deg2rad(starts), np.deg2rad(ends)


def largest(slave: Slave, kind: str, table: Table) -> Deviation:
    """The certificate: the largest errors over the turn, refined, on both sides of every join and row."""
    smooth, coefficients = _Smooth(slave, table.x[:-1], table.x[1:]), KINDS[kind].coefficients(table)
    orders = KINDS[kind].derivatives
    names = QUANTITIES[:orders]
    kept = np.arange(smooth.row.size)
    if kept.size > FEW:
        sampled = smooth.errors(coefficients, *smooth.sampled(SAMPLES[1][1], orders), orders)
        kept = np.unique(np.argpartition(sampled, -TOPS, axis=1)[:, -TOPS:])
    rows, pieces = smooth.row[kept], smooth.piece[kept]

    def errors(angles: Angles) -> dict[str, np.ndarray]:
        row, x = rows[angles.piece], np.rad2deg(angles.theta)
        exact = slave.state(x, pieces[angles.piece], orders)
        made = evaluated(coefficients[:, row], x - table.x[row], orders)
        return dict(zip(names, np.abs(made - exact), strict=True))

    found = find_highest(errors, _Pieces(smooth.starts[kept], smooth.ends[kept]))  # type: ignore[arg-type]
    return Deviation(
        tuple(found[name].value for name in names),
        tuple(min(float(np.round(np.rad2deg(found[name].theta), 9)), TURN) for name in names),
    )


__all__ = ["QUANTITIES", "Deviation", "errors_near", "largest", "piece_errors", "table_at"]
