"""A table as the curve of one segment: its first two columns, scaled to the segment's span and rise, or as they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.design import Design, SplinePoint, TableCurve, laid_out, require_motion, with_motion
from core.design.rules import MOST_OF_LIST
from core.measured.sheet import RowFault, TableError, Worksheet, number
from core.motion import Angles, program

ORDERS = np.arange(4)
MOST_FAULTS = 100  # that are named
RETURNS = 0.01  # of all that it rises: a measured table ends no nearer to where it began


def rows_of(sheet: Worksheet) -> tuple[np.ndarray, np.ndarray]:
    """Angles and values (n,) of the first two columns, from those of the first row. Raises TableError for a cell that is no number,
    angles that do not rise, or too few rows."""
    faults: list[RowFault] = []
    found: list[tuple[float, float]] = []
    for row in sheet.rows:
        if len(faults) >= MOST_FAULTS:
            break
        cells = [number(cell, sheet.decimal) for cell in row.cells[:2]]
        if len(cells) < 2 or cells[0] is None or cells[1] is None:
            faults.append(RowFault(row.line, f"{' '.join(row.cells)!r}: no angle and value; correct it"))
        elif found and cells[0] <= found[-1][0]:
            faults.append(
                RowFault(row.line, f"angle {cells[0]:g} after {found[-1][0]:g}; sort the rows, each angle once")
            )
        else:
            found.append((cells[0], cells[1]))
    if not faults and not 2 <= len(found) <= MOST_OF_LIST:
        faults.append(RowFault(0, f"{len(found)} rows; allowed: 2 ... {MOST_OF_LIST}"))
    if faults:
        raise TableError(sheet.name, faults)
    x, y = np.array(found).T
    return x - x[0], y - y[0]


def segment_from_table(
    design: Design, index: int, sheet: Worksheet, *, as_is: bool = False, joined: bool = False
) -> Design:
    """The design whose segment follows the table, which need not be whole then. as_is: the table's own span [deg] and rise [the motion's
    unit], for which the next segments give or take; else it is stretched to the segment's. joined: velocity and acceleration at its ends
    are those of its neighbours; else it begins and ends at rest. Raises TableError, also where a table without a rise is to be stretched
    to one."""
    x, y = rows_of(sheet)
    segment, at = require_motion(design).segments[index], f"motion.segments[{index}]"
    if as_is:
        for key, value in (("law", TableCurve.law), ("span_deg", float(x[-1])), ("rise", float(y[-1]))):
            design = laid_out(design, f"{at}.{key}", value)
    elif abs(y[-1]) <= RETURNS * np.ptp(y) and segment.rise:
        raise TableError(
            sheet.name,
            [
                RowFault(
                    0,
                    f"ends where it begins, and the segment rises by {segment.rise:g}; take it as it is, or a whole "
                    "turn as a measured motion",
                )
            ],
        )
    else:
        x, y = x * (segment.span_deg / x[-1]), y * (segment.rise / y[-1] if y[-1] else 1.0)
    motion = require_motion(design)
    x[-1], y[-1] = motion.segments[index].span_deg, motion.segments[index].rise
    points = [SplinePoint(a, b) for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    if joined:
        for end, (velocity, acceleration) in zip((0, -1), _neighbours(design, index), strict=True):
            points[end] = replace(points[end], velocity=velocity, acceleration=acceleration)
    changed = replace(motion.segments[index], curve=TableCurve(tuple(points)))
    return with_motion(
        design, replace(motion, segments=(*motion.segments[:index], changed, *motion.segments[index + 1 :]))
    )


def _neighbours(design: Design, index: int) -> list[tuple[float, float]]:
    """Velocity and acceleration [unit per degree, per degree²] where the segment before ends and the one behind begins."""
    motion = require_motion(design)
    compiled = program(motion)
    before, behind = (index - 1) % len(motion.segments), (index + 1) % len(motion.segments)
    last = int(np.flatnonzero(compiled.segment == before)[-1])
    first = int(np.flatnonzero(compiled.segment == behind)[0])
    found = []
    for piece, theta in ((last, compiled.ends[last]), (first, compiled.starts[first])):
        y = compiled.state(Angles(np.array([theta]), np.array([piece]))).y[:, 0]
        per_degree = y / motion.scale * np.deg2rad(1.0) ** ORDERS
        found.append((float(per_degree[1]), float(per_degree[2])))
    return found


__all__ = ["rows_of", "segment_from_table"]
