"""The timing chart of a shaft as numbers: a band of motion over the machine angle for each drive, and the table of events."""

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
"""Endings of files of the chart; .csv holds the table of events."""
SAMPLES = 360


@frozen(eq=False)
class MotionBand:
    """The motion of a drive over the machine angle.

    Attributes
    ----------
    angles : (n,) machine angles from 0 to 360, joins included [deg]
    level : (n,) displacement relative to the stroke, 0 ... 1; 0 without a stroke, empty without a motion
    stroke : highest less lowest displacement [unit]
    joins : machine angles of the joins in the order of the segments [deg]
    moving : ranges of rise and return, beyond 360 where they pass the start of the turn [deg]
    """

    name: str
    angles: np.ndarray
    level: np.ndarray
    stroke: float
    unit: str
    joins: tuple[float, ...]
    moving: tuple[tuple[float, float], ...]


def bands(design: Design) -> tuple[MotionBand, ...]:
    """Bands of all drives, in their order."""
    return tuple(_band(design, index, name) for index, name in enumerate(drive_names(design)))


def _band(design: Design, index: int, name: str) -> MotionBand:
    drive = design.drives[index]
    if drive.motion is None:
        return MotionBand(name, np.empty(0), np.empty(0), 0.0, "", (), ())
    joins = machine_joins(design, index)
    angles, level, stroke = _curve(drive.motion, drive.phase, joins)
    return MotionBand(name, angles, level, stroke, drive.motion.unit, joins, moving(design, index))


@lru_cache(maxsize=64)
def _curve(motion: Motion, phase: float, joins: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray, float]:
    """Angles, level and stroke of a band."""
    angles = np.unique(np.concatenate((np.linspace(0.0, 360.0, SAMPLES + 1), joins)))
    compiled = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad((angles - phase) % 360.0))).displacement[0]
    y = y + motion.gain * motion.scale * np.floor((angles - phase) / 360.0)
    low, stroke = float(y.min()), float(np.ptp(y))
    level = (y - low) / stroke if stroke > 1e-12 * max(abs(low), 1e-6) else np.zeros(y.size)
    for array in (angles, level):
        array.setflags(write=False)
    return angles, level, stroke / motion.scale


def event_rows(design: Design) -> list[tuple[str, float, float]]:
    """Events in the order of the turn: name, machine angle [deg], time [ms] since machine angle 0."""
    rows = sorted(events(design).items(), key=lambda row: row[1])
    return [(name, angle, milliseconds(design, angle)) for name, angle in rows]


def events_csv(design: Design) -> str:
    """Table of the events as CSV."""
    lines = [",".join(EVENTS), *(f"{text_cell(name)},{angle!r},{time!r}" for name, angle, time in event_rows(design))]
    return "\n".join(lines) + "\n"
