"""What the drive is really given: the controller's path, sampled once a cycle."""

from __future__ import annotations

import math

import numpy as np

from core.frozen import frozen
from core.output.controllers.interpolation import KINDS, Table, evaluated
from core.output.controllers.slave import TURN, Slave

PARTS = np.clip(0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 9)), 1e-9, 1.0 - 1e-9)


@frozen
class Cycle:
    """acceleration_step  largest step of the acceleration from one cycle to the next, by second differences of the sampled path,
                          wherever the cycles fall [m/s², or deg/s²]
    at_deg             angle of the master where it stands
    dominates_above_rpm  from this speed on the straight line between two cycles errs by more than the table; None: at none
    """

    acceleration_step: float
    at_deg: float
    dominates_above_rpm: float | None


def cycle(slave: Slave, kind: str, table: Table, deviation: float, cycle_ms: float, speed_rpm: float) -> Cycle:
    """The path p(x) of a table in cycles of T = cycle_ms: steps of h = ω T degrees, accelerations Δ²p/T², their steps Δ³p/T².

    Between two cycles a straight line errs by h²/8 max|s''| (physics of linear interpolation), which passes the deviation of the table
    at h = √(8 deviation/max|s''|).
    """
    seconds, h = cycle_ms / 1e3, 6.0 * speed_rpm * cycle_ms / 1e3
    coefficients = KINDS[kind].coefficients(table)

    def path(x: np.ndarray) -> np.ndarray:
        turns = np.floor((x - table.x[0]) / TURN)
        x = x - TURN * turns
        piece = np.clip(np.searchsorted(table.x, x, side="right") - 1, 0, table.x.size - 2)
        return np.asarray(evaluated(coefficients[:, piece], x - table.x[piece], 1)[0] + slave.advance * turns)

    breaks = np.unique(np.mod((table.x[:, None] - h * np.arange(4)).ravel(), TURN))
    ends = np.append(breaks, breaks[0] + TURN)
    x = (ends[:-1, None] + np.diff(ends)[:, None] * PARTS).ravel()
    step = np.abs(path(x + 3.0 * h) - 3.0 * path(x + 2.0 * h) + 3.0 * path(x + h) - path(x)) / seconds**2
    top = int(np.argmax(step))
    bend = float(np.abs(slave.values[2]).max())
    limit = math.sqrt(8.0 * deviation / bend) / (6.0 * seconds) if bend > 0.0 and deviation > 0.0 else None
    scale = 1e-3 if slave.unit == "mm" else 1.0
    return Cycle(float(step[top]) * scale, float(np.mod(x[top] + 1.5 * h, TURN)), limit)


__all__ = ["Cycle", "cycle"]
