"""The timing chart of a shaft as numbers: one band a drive over the machine angle, and the table of events."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from core.design import Design, Motion, drive_names, events, machine_joins, milliseconds, moving
from core.frozen import frozen
from core.motion import program
from core.output.lines import text_cell

EVENTS = ("event", "machine_angle_deg", "time_ms")
"""Columns of the table of events."""
ENDINGS = (".pdf", ".svg", ".png", ".csv")
"""Files that the chart, or as .csv the table of events, can be written to."""
SAMPLES = 360


@frozen(eq=False)
class MotionBand:
    """The motion of a drive over the machine angle.

    angles   (n,) machine angles [deg], 0 ... 360, the joins among them
    level    (n,) displacement there over its stroke, 0 ... 1; 0 of a motion without a stroke, empty without a motion
    stroke   highest less lowest, in the motion's unit; joins: machine angles in the order of the segments
    moving   where it rises or returns, from - to, past 360 where it goes on over the start of the turn
    """

    name: str
    angles: np.ndarray
    level: np.ndarray
    stroke: float
    unit: str
    joins: tuple[float, ...]
    moving: tuple[tuple[float, float], ...]


def bands(design: Design) -> tuple[MotionBand, ...]:
    """Those of all drives, in their order."""
    return tuple(_band(design, index, name) for index, name in enumerate(drive_names(design)))


def _band(design: Design, index: int, name: str) -> MotionBand:
    drive = design.drives[index]
    if drive.motion is None:
        return MotionBand(name, np.empty(0), np.empty(0), 0.0, "", (), ())
    joins = machine_joins(design, index)
    angles, level, stroke = _curve(drive.motion, drive.phase_deg, joins)
    return MotionBand(name, angles, level, stroke, drive.motion.unit, joins, moving(design, index))


@lru_cache(maxsize=64)
def _curve(motion: Motion, phase: float, joins: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray, float]:
    """Angles, level and stroke of a band."""
    angles = np.unique(np.concatenate((np.linspace(0.0, 360.0, SAMPLES + 1), joins)))
    moved = program(motion)
    y = moved.state(moved.angles(np.deg2rad((angles - phase) % 360.0))).displacement[0]
    y = y + motion.gain * motion.scale * np.floor((angles - phase) / 360.0)
    low, stroke = float(y.min()), float(np.ptp(y))
    level = (y - low) / stroke if stroke > 1e-12 * max(abs(low), 1e-6) else np.zeros(y.size)
    for array in (angles, level):
        array.setflags(write=False)
    return angles, level, stroke / motion.scale


def event_rows(design: Design) -> list[tuple[str, float, float]]:
    """Event, its machine angle [deg], and the time [ms] since machine angle 0, in the order of the turn."""
    rows = sorted(events(design).items(), key=lambda row: row[1])
    return [(name, angle, milliseconds(design, angle)) for name, angle in rows]


def events_csv(design: Design) -> str:
    """The same as a table."""
    lines = [",".join(EVENTS), *(f"{text_cell(name)},{angle!r},{time!r}" for name, angle, time in event_rows(design))]
    return "\n".join(lines) + "\n"


__all__ = ["ENDINGS", "MotionBand", "bands", "event_rows", "events_csv"]
