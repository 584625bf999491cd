"""Limits that are linear in the varied numbers: sequence conditions of a shaft, and what varied spans leave of the turn."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from core.design import Design, distances, drive_in, get, only, path_in, phase_path, varied
from core.design.edits import balance
from core.frozen import frozen

LEAST_LEFT = 1e-3  # [deg] that varied spans leave to the segments that make up for them
MOST_STEP = 90.0  # [deg]: a longer step could turn an event past the other event of its condition
SPANS = "spans"

_SPAN = re.compile(r"motion\.segments\[(\d+)\]\.span_deg")


@frozen(eq=False)
class LinearLimit:
    """A least value of a linear function of the varied numbers, constant + slopes · numbers.

    Attributes
    ----------
    name : str
        Path of the limit in the design, or ``SPANS``.
    least : float [deg]
        Least allowed value.
    constant : float [deg]
    slopes : ndarray (k,) [deg per unit of the number]
    """

    name: str
    least: float
    constant: float
    slopes: np.ndarray


def linear_limits(design: Design, paths: Sequence[str], width: np.ndarray) -> list[LinearLimit]:
    """Satisfied sequence conditions that the numbers change, and of every motion the rest of the turn for spans not varied.

    Parameters
    ----------
    design : Design
    paths : sequence of str
        Paths of k varied numbers.
    width : ndarray (k,) [unit of the number]
        Widths of their ranges.

    Returns
    -------
    list of LinearLimit
    """
    return [*_sequence_limits(design, paths, width), *_span_limits(design, paths)]


def _sequence_limits(design: Design, paths: Sequence[str], width: np.ndarray) -> Iterator[LinearLimit]:
    turning = {phase_path(design, i) for i in range(len(design.drives))} if design.timing else set()
    at = [i for i, path in enumerate(paths) if path in turning or _span_at(design, path)] if design.timing else []
    if not at:
        return
    numbers = np.array([float(get(design, path)) for path in paths])
    present = distances(design)
    slopes = np.zeros((len(present), len(paths)))
    for i in at:
        step = min(float(width[i]), MOST_STEP)
        values = dict(zip(paths, (float(x) for x in numbers + step * (np.arange(len(paths)) == i)), strict=True))
        changed = distances(varied(design, values))
        for k, (before, after) in enumerate(zip(present, changed, strict=True)):
            slopes[k, i] = ((after.after_deg - before.after_deg + 180.0) % 360.0 - 180.0) / step
    for number, (row, distance) in enumerate(zip(design.timing, present, strict=True)):
        if distance.kept and slopes[number].any():
            name = f"timing[{number}].least_deg"
            yield LinearLimit(name, row.least_deg, distance.after_deg - float(slopes[number] @ numbers), slopes[number])


def _span_limits(design: Design, paths: Sequence[str]) -> Iterator[LinearLimit]:
    spans = [_span_at(design, path) for path in paths]
    for drive in dict.fromkeys(at[0] for at in spans if at):
        motion = only(design, drive).drive.motion
        assert motion is not None, "it has spans"
        is_varied = {at[1] for at in spans if at and at[0] == drive}
        rows = [(i, segment) for i, segment in enumerate(motion.segments) if i not in is_varied]
        if any(not segment.fixed for _, segment in rows):
            left = balance(360.0, (segment.span_deg for _, segment in rows if segment.fixed))
            slopes = np.array([-1.0 if at and at[0] == drive else 0.0 for at in spans])
            yield LinearLimit(path_in(design, drive, SPANS), LEAST_LEFT, left, slopes)


def _span_at(design: Design, path: str) -> tuple[int, int] | None:
    """Number of the drive and of the segment whose span a path is; None for other paths."""
    drive, inside = drive_in(design, path) or (0, "")
    match = _SPAN.fullmatch(inside)
    return (drive, int(match[1])) if match else None
