"""How far what a controller runs is from the exact curve: of every piece, and the largest of the turn, refined."""

from __future__ import annotations

import numpy as np

from core.frozen import frozen
from core.motion import Angles
from core.motion.extremes import find_highest
from core.output.controllers.interpolation import KINDS, Table, evaluated
from core.output.controllers.slave import NEAR, TURN, Slave

SAMPLES = ((100, 17), (1000, 9), (10**9, 7))  # of a piece, its ends among them, where there are fewer rows than so many
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


def piece_errors(slave: Slave, kind: str, x: np.ndarray, orders: int = 1) -> np.ndarray:
    """Largest errors (orders, n - 1) of value and derivatives between rows at angles x (n,) [deg], by samples and a parabola through
    the highest of them. The first and the last sample of a piece are what its rows hold, so that the motion is evaluated once."""
    parts = _parts(next(count for rows, count in SAMPLES if x.size < rows))
    w = np.diff(x)[:, None] * parts
    at = x[:-1, None] + w  # in rising order, which is evaluated soonest
    at[:, -1] = x[1:]
    pieces = slave.piece_of(at.ravel()).reshape(at.shape)
    before, behind = slave.pieces_beside(x)
    pieces[:, 0], pieces[:, -1] = behind[:-1], before[1:]
    row = KINDS[kind]
    known = slave.state(at.ravel(), pieces.ravel(), max(orders, row.needs)).reshape(-1, *at.shape)
    starts, ends = known[:, :, 0], known[:, :, -1]
    table = _between(x, np.column_stack((starts[:, :1], ends)), np.column_stack((starts, ends[:, -1:])))
    made = evaluated(row.coefficients(table)[:, :, None], w, orders)
    return _peaks(np.abs(made - known[:orders]))


def _parts(count: int) -> np.ndarray:
    return np.asarray(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count)))


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
