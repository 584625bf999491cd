"""How large the wind-up is on the whole: its means over the first turn from rest by η, for some rows of Q (Kim1990 Figs. 6, 7)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.stability.chart import ETA_MAX
from core.stability.coefficients import Coefficients
from core.stability.contact import Contact
from core.stability.windup import histories

FIRST_ETA, STEP, MOST = 0.5, 0.05, 102
TIMES = (1.0, 2.0, 4.0, 10.0, 20.0)
"""Rows of Q as multiples of the machine's: 0.05, 0.1, 0.2, 0.5, 1 of Kim1990 where that is 0.05."""


@dataclass(frozen=True, eq=False)
class Averages:
    """Means from rest.

    eta       (n,) rising
    q         (rows,)
    wind_up   (rows, n) mean |β| [turns]; nan where the equation could not be followed
    slope     (rows, n) mean |β'|
    lost      (rows, n) True where the follower leaves the cam within that time; None where no contact is known
    turned    (rows, n) True where the cam turns back within it: β' = 1
    periods   turns of the input that are averaged
    """

    eta: np.ndarray
    q: np.ndarray
    wind_up: np.ndarray
    slope: np.ndarray
    lost: np.ndarray | None
    turned: np.ndarray
    periods: float


def etas(eta_max: float = ETA_MAX) -> np.ndarray:
    """0.5, 0.55, ... up to eta_max (n,); where that is far, no more than Kim1990's range has."""
    count = max(1, min(round((eta_max - FIRST_ETA) / STEP), MOST) + 1)
    return FIRST_ETA + np.arange(count) * max(STEP, (eta_max - FIRST_ETA) / MOST)


def mean_wind_up(
    coefficients: Coefficients,
    q: Sequence[float] | np.ndarray,
    eta_max: float = ETA_MAX,
    damping: float = 0.0,
    contact: Contact | None = None,
    periods: float = 1.0,
) -> Averages:
    """The means of the rows q (rows,), over the first ``periods`` turns from rest."""
    eta, rows = etas(eta_max), np.atleast_1d(np.asarray(q, dtype=float))
    shape = (rows.size, eta.size)
    gone = histories(
        coefficients, np.tile(eta, rows.size), np.repeat(rows, eta.size), damping, periods, contact=contact
    )
    means = np.array([each.averages() if each.ended == periods else (np.nan, np.nan) for each in gone])
    lost = None if contact is None else np.array([each.loses_contact for each in gone]).reshape(shape)
    turned = np.array([each.turned_back is not None for each in gone]).reshape(shape)
    wind_up, slope = means.T.reshape(2, *shape)
    return Averages(eta, rows, wind_up, slope, lost, turned, periods)
