"""What is tabled of a flexible shaft: names of the columns, and the columns (n,)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.stability.hill.coefficients import Coefficients
from core.stability.windup import Averages, History

SAMPLES_PER_TURN = 100
COEFFICIENT_ROWS = 720

Columns = tuple[list[str], list[np.ndarray]]


def windup_columns(runs: Sequence[History]) -> Columns:
    """Histories from rest, one below the other: time in turns of the input, wind-up β and its slope β', contact force as a
    multiple of M X''m ω² where there is a cam."""
    parts = []
    for each in runs:
        y = np.arange(int(each.ended * SAMPLES_PER_TURN) + 1) / SAMPLES_PER_TURN
        beta, slope = each.at(y)
        parts.append([np.full(y.size, each.eta), np.full(y.size, each.q), y, beta, slope, each.force(y)])
    names = ["eta", "q", "input_turns", "wind_up", "wind_up_slope", "contact_force_ratio"]
    table = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return (names[:-1], table[:-1]) if runs[0].contact is None else (names, table)


def averages_columns(means: Averages) -> Columns:
    """Means of |β| and |β'| by η (Kim1990 Figs. 6, 7), and 1 where the follower leaves the cam within the turn; what cannot
    be followed is left out."""
    there = np.isfinite(means.wind_up).ravel()
    columns = [
        np.repeat(means.q, means.eta.size),
        np.tile(means.eta, means.q.size),
        means.wind_up.ravel(),
        means.slope.ravel(),
    ]
    names = ["q", "eta", "mean_wind_up", "mean_wind_up_slope"]
    if means.lost is not None:
        names.append("leaves_cam")
        columns.append(means.lost.ravel().astype(float))
    return names, [column[there] for column in columns]


def coefficients_columns(coefficients: Coefficients) -> Columns:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ): inertia share d, C, U, κ, ψ."""
    degrees = 360.0 * np.arange(COEFFICIENT_ROWS) / COEFFICIENT_ROWS
    rows = coefficients.panels.at(np.deg2rad(degrees), 5)
    return ["cam_angle_deg", "inertia", "centripetal", "load", "curvature", "psi"], [degrees, *rows]
