"""How large the wind-up is on the whole: its means over the first turn from rest by η, for some rows of Q (Kim1990 Figs. 6, 7)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from core.stability.chart import ETA_MAX
from core.stability.coefficients import Coefficients
from core.stability.contact import Contact
from core.stability.following import follow
from core.stability.looks import look
from core.stability.nonlinear import Points
from core.stability.swing import Swing
from core.stability.windup import History, errors, histories

FIRST_ETA, STEP, MOST = 0.5, 0.05, 102
DRAWN = 1e-8  # wanted error of what is drawn
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
    gone      follows the same points again and gives their histories, row by row
    """

    eta: np.ndarray
    q: np.ndarray
    wind_up: np.ndarray
    slope: np.ndarray
    lost: np.ndarray | None
    turned: np.ndarray
    periods: float
    gone: Callable[[], Sequence[History]]

    @cached_property
    def error(self) -> np.ndarray:
        """What ``wind_up`` and ``slope`` may be wrong by (2, rows, n), computed when it is asked for.

        A mean of |β| is wrong by no more than β is anywhere, one of |β'| by no more than the pointer β' + (a + iω) β and
        aβ are; between looks nothing is left out that comes near to that.
        """
        gone = self.gone()
        swing = Swing.of(np.array([each.eta for each in gone]), gone[0].damping)
        wrong = errors(gone) * np.array([each.largest[0] for each in gone])
        return np.array([wrong, (swing.omega + swing.decay) * wrong]).reshape(2, *self.wind_up.shape)


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
    error: float = DRAWN,
) -> Averages:
    """The means of the rows q (rows,), over the first ``periods`` from rest.

    error  wanted, of each β relative to its largest value; ``Averages.error`` says what the means may be wrong by
    """
    eta, rows = etas(eta_max), np.atleast_1d(np.asarray(q, dtype=float))
    points = Points(np.tile(eta, rows.size), np.repeat(rows, eta.size), damping)
    steps, ended = follow(coefficients, points, None, periods, error)
    lane, lanes = steps.lane, ended.size
    looks = look(steps, Swing.of(points.eta, damping).only(lane))

    def by_point(step: np.typing.ArrayLike) -> np.ndarray:
        return np.bincount(lane, weights=step, minlength=lanes).reshape(rows.size, eta.size)

    whole = np.where(ended == periods, periods, np.nan).reshape(rows.size, eta.size)
    wind_up, slope = (by_point(sizes) / whole for sizes in looks.sizes())
    lost = None if contact is None else by_point(looks.losing(contact, points.eta[lane])[1].any(axis=1)) > 0.0
    turned = by_point((looks.rate >= 1.0).any(axis=1)) > 0.0
    gone = partial(histories, coefficients, points.eta, points.q, damping, periods, error=error)
    return Averages(eta, rows, wind_up, slope, lost, turned, periods, gone)
