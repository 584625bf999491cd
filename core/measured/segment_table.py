"""A measured table as the curve of one segment."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.design import (
    Design,
    SplinePoint,
    TableCurve,
    require_motion,
    with_motion,
    with_value,
)
from core.design.rules import MOST_OF_LIST
from core.measured.sheet import RowFault, TableError, Worksheet, number
from core.motion import Angles, program

# -- table as the curve of one segment --------------------------------------------------------------------------


ORDERS = np.arange(4)
MOST_FAULTS = 100  # greatest number of reported faults
RETURNS = 0.01  # least total rise of a table relative to its range


def rows_of(sheet: Worksheet) -> tuple[np.ndarray, np.ndarray]:
    """Angles and values of the first two columns, relative to the first row.

    Parameters
    ----------
    sheet : Worksheet

    Returns
    -------
    x : ndarray (n,) [unit of the angles]
    y : ndarray (n,) [unit of the values]

    Raises
    ------
    TableError
        Where a cell is no number, angles do not ascend, or the number of rows is outside its range.
    """
    faults: list[RowFault] = []
    pairs: list[tuple[float, float]] = []
    for row in sheet.rows:
        if len(faults) >= MOST_FAULTS:
            break
        cells = [number(cell, sheet.decimal) for cell in row.cells[:2]]
        if len(cells) < 2 or cells[0] is None or cells[1] is None:
            faults.append(RowFault(row.line, f"{' '.join(row.cells)!r}: no angle and value; correct it"))
        elif pairs and cells[0] <= pairs[-1][0]:
            faults.append(
                RowFault(row.line, f"angle {cells[0]:g} after {pairs[-1][0]:g}; sort the rows, each angle once")
            )
        else:
            pairs.append((cells[0], cells[1]))
    if not faults and not 2 <= len(pairs) <= MOST_OF_LIST:
        faults.append(RowFault(0, f"{len(pairs)} rows; allowed: 2 ... {MOST_OF_LIST}"))
    if faults:
        raise TableError(sheet.name, faults)
    x, y = np.array(pairs).T
    return x - x[0], y - y[0]


def segment_from_table(
    design: Design, index: int, sheet: Worksheet, *, as_is: bool = False, joined: bool = False
) -> Design:
    """Design whose segment follows a table; the motion may then be incomplete.

    Parameters
    ----------
    design : Design
    index : int
        Number of the segment, from 0.
    sheet : Worksheet
    as_is : bool
        Give the segment the span [deg] and rise [unit of the motion] of the table, which the next segments compensate;
        else the table is scaled to the segment.
    joined : bool
        Give its ends velocity and acceleration of the neighbouring segments; else the table starts and ends at rest.

    Returns
    -------
    Design

    Raises
    ------
    TableError
        Also where a table without rise would be scaled to a segment with a rise.
    """
    x, y = rows_of(sheet)
    segment, at = require_motion(design).segments[index], f"motion.segments[{index}]"
    if as_is:
        for key, value in (("law", TableCurve.law), ("span_deg", float(x[-1])), ("rise", float(y[-1]))):
            design = with_value(design, f"{at}.{key}", value)
    elif abs(y[-1]) <= RETURNS * np.ptp(y) and segment.rise:
        raise TableError(
            sheet.name,
            [
                RowFault(
                    0,
                    f"ends where it starts, but the segment rises by {segment.rise:g}; import it unscaled, or import a full "
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
    """Velocity and acceleration [per deg, per deg²] at the end of the previous and the start of the next segment."""
    motion = require_motion(design)
    compiled = program(motion)
    before, after = (index - 1) % len(motion.segments), (index + 1) % len(motion.segments)
    last = int(np.flatnonzero(compiled.segment == before)[-1])
    first = int(np.flatnonzero(compiled.segment == after)[0])
    states = []
    for piece, theta in ((last, compiled.ends[last]), (first, compiled.starts[first])):
        y = compiled.state(Angles(np.array([theta]), np.array([piece]))).y[:, 0]
        per_degree = y / motion.scale * np.deg2rad(1.0) ** ORDERS
        states.append((float(per_degree[1]), float(per_degree[2])))
    return states
