"""How far what a controller runs is from the exact curve: of every piece, and the largest of the turn, refined."""

from __future__ import annotations

import numpy as np

from core.frozen import frozen
from core.motion import Angles
from core.motion.extremes import find_highest
from core.output.controllers.interpolation import KINDS, Table, evaluated
from core.output.controllers.slave import NEAR, TURN, Slave

INSIDE = 1e-9  # of a piece: so far from its ends its ends are sampled
SAMPLES, FEW, MANY = 9, 17, 100  # of a piece, its ends among them; more where there are not many pieces
QUANTITIES = ("deviation", "velocity", "acceleration")


@frozen
class Deviation:
    """Largest errors of value, velocity and acceleration [unit, per degree], and the angles of the master [deg] where they stand;
    as many as the interpolation has derivatives."""

    values: tuple[float, ...]
    at_deg: tuple[float, ...]


def table_at(slave: Slave, x: np.ndarray, orders: int = 3) -> Table:
    """The rows of a table at angles x (n,) [deg]; where something jumps the mean of both sides, which leaves the smaller error."""
    before, behind = slave.sides(x, orders)
    states = 0.5 * (before + behind)
    return Table(x, states, (float(states[1, 0]), float(states[1, -1])) if orders > 1 else (0.0, 0.0))


def piece_errors(slave: Slave, kind: str, table: Table, orders: int = 1) -> np.ndarray:
    """Largest errors (orders, n - 1) of value and derivatives between the rows of a table, by samples and a parabola through the
    highest of them."""
    parts = _parts(FEW if table.x.size < MANY else SAMPLES)
    w = np.diff(table.x)[:, None] * parts
    x = (table.x[:-1, None] + w).ravel()  # in rising order, which is evaluated soonest
    exact = slave.state(x, slave.piece_of(x), orders).reshape(orders, -1, parts.size)
    made = evaluated(KINDS[kind].coefficients(table)[:, :, None], w, orders)
    return _peaks(np.abs(made - exact))


def _parts(count: int) -> np.ndarray:
    return np.clip(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count)), INSIDE, 1.0 - INSIDE)


def _peaks(errors: np.ndarray) -> np.ndarray:
    """The largest of samples (orders, n, k), each with what a parabola through it and its neighbours adds."""
    top = errors.argmax(axis=2)
    highest = np.take_along_axis(errors, top[:, :, None], axis=2)[:, :, 0]
    last = errors.shape[2] - 1
    beside = np.clip(top, 1, last - 1)[:, :, None]
    left, right = (np.take_along_axis(errors, beside + k, axis=2)[:, :, 0] for k in (-1, 1))
    bend = np.maximum(2.0 * highest - left - right, 1e-300)
    added = np.minimum((left - right) ** 2 / (8.0 * bend), 0.25 * highest)
    return np.asarray(highest + np.where((top > 0) & (top < last), added, 0.0))


class _Merged:
    """The pieces [rad] within which both curves are smooth."""

    def __init__(self, slave: Slave, table: Table) -> None:
        near = np.abs(table.x[np.clip(np.searchsorted(table.x, slave.edges), 0, table.x.size - 1)] - slave.edges)
        below = np.abs(table.x[np.clip(np.searchsorted(table.x, slave.edges) - 1, 0, None)] - slave.edges)
        others = slave.edges[(near > NEAR) & (below > NEAR)]
        ends = np.sort(np.concatenate((table.x, others[(others > table.x[0]) & (others < table.x[-1])])))
        middle = 0.5 * (ends[:-1] + ends[1:])
        self.row = np.searchsorted(table.x, middle) - 1
        self.piece = slave.piece_of(middle)
        self.starts, self.ends = np.deg2rad(ends[:-1]), np.deg2rad(ends[1:])


def largest(slave: Slave, kind: str, table: Table) -> Deviation:
    """The certificate: the largest errors over the turn, refined, on both sides of every join and row."""
    merged, coefficients = _Merged(slave, table), KINDS[kind].coefficients(table)
    orders = KINDS[kind].derivatives
    names = QUANTITIES[:orders]

    def errors(angles: Angles) -> dict[str, np.ndarray]:
        row, x = merged.row[angles.piece], np.rad2deg(angles.theta)
        exact = slave.state(x, merged.piece[angles.piece], orders)
        made = evaluated(coefficients[:, row], x - table.x[row], orders)
        return dict(zip(names, np.abs(made - exact), strict=True))

    found = find_highest(errors, merged)  # type: ignore[arg-type]
    return Deviation(
        tuple(found[name].value for name in names),
        tuple(min(float(np.round(np.rad2deg(found[name].theta), 9)), TURN) for name in names),
    )


__all__ = ["QUANTITIES", "Deviation", "largest", "piece_errors", "table_at"]
