"""Terms of a search, a figure or a linear value with its bound each, and the questions that searches ask about them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from core.frozen import frozen
from core.study.quantities import quantity
from core.study.quantity_requests import QuantityRequest
from core.varying.request import Goal, StudyQuantity


@frozen(eq=False)
class Term:
    """A figure with an upper bound, ``side`` times a quantity over the turn: a limit, or the goal, whose bound is t.

    Attributes
    ----------
    row : StudyQuantity
    request : QuantityRequest
        Of a value with a ``line`` only its name.
    side : float
        +1 for an upper limit or a minimised goal, else -1.
    bound : float or None
        None for the goal.
    peaks : tuple of float
        Signs of the quantity whose peaks over the turn are all constrained; empty where a single value is.
    radius : float [mm]
        Roller radius r, for the curvature of a profile; else 0.
    line : (float, ndarray (k,)) or None
        Constant and slopes of a value that is linear in the coordinates; None for a figure.
    """

    row: StudyQuantity
    request: QuantityRequest
    side: float
    bound: float | None
    peaks: tuple[float, ...] = ()
    radius: float = 0.0
    line: tuple[float, np.ndarray] | None = None

    def smoothed(self, value: Any) -> Any:
        """A value in a form without poles: of a profile's curvature κ that of the pitch curve, κ/(1 + κ r), 1/r at a cusp."""
        if not self.radius:
            return value
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(np.isinf(value), 1.0 / self.radius, value / (1.0 + value * self.radius))

    def on_line(self, u: np.ndarray) -> np.ndarray:
        """``side`` times a linear value.

        Parameters
        ----------
        u : ndarray (k, m), dimensionless
            Coordinates of m designs.

        Returns
        -------
        ndarray (m,) [unit of the value]
        """
        assert self.line is not None, "a linear value"
        constant, slopes = self.line
        return np.asarray(self.side * (constant + slopes @ u))

    def original(self, value: Any) -> Any:
        """The value of which ``smoothed`` returns this one."""
        return value / (1.0 - value * self.radius) if value * self.radius < 1.0 else np.inf


Peaks = dict[int, list[tuple[float, int, float]]]
"""Number of a term with peaks -> its peaks: cam angle [rad], piece, sign."""


@frozen(eq=False)
class Samples:
    """Question: quantities of terms, each at its own angles, of some designs.

    Attributes
    ----------
    u : ndarray (k, m), dimensionless
        Coordinates of the designs.
    angles : sequence of (theta, piece)
        Cam angles (n,) [rad] and pieces (n,) of every term.
    terms : sequence of Term
    """

    u: np.ndarray
    angles: Sequence[tuple[np.ndarray, np.ndarray]]
    terms: Sequence[Term]


@frozen(eq=False)
class Figures:
    """Question: figures of terms over the turn, of designs u (k, m)."""

    u: np.ndarray
    terms: Sequence[Term]


@frozen(eq=False)
class Arrival:
    """Question: whether another search was at the coordinates u (k,) before this one, ``goal`` being the value there."""

    number: int
    u: np.ndarray
    goal: float


class PeakSearch:
    """Brackets (b,) of the peaks of a term with one sign: cam angles from ``low`` to ``high`` [rad] in a piece.

    Every pass narrows them to a quarter; a kink, where friction reverses, has a peak on both sides.
    """

    def __init__(self, term: int, sign: float, low: np.ndarray, high: np.ndarray, piece: np.ndarray) -> None:
        self.term, self.sign, self.low, self.high, self.piece = term, sign, low, high, piece
        self._height, self._theta = np.empty(0), np.empty(0)

    def samples(self) -> np.ndarray:
        """Cam angles at which the term is evaluated.

        Returns
        -------
        ndarray (b, 9) [rad]
        """
        return np.asarray(self.low[:, None] + (self.high - self.low)[:, None] * np.linspace(0.0, 1.0, 9))

    def narrow(self, samples: np.ndarray, values: np.ndarray) -> None:
        """Narrow the brackets to the neighbours of the peaks among the values at the samples.

        Parameters
        ----------
        samples : ndarray (b, 9) [rad]
        values : ndarray (b, 9) [unit of the term]
        """
        g = np.pad(self.sign * values, ((0, 0), (1, 1)), constant_values=-np.inf)
        rows, top = np.nonzero((g[:, 1:-1] > g[:, :-2]) & (g[:, 1:-1] >= g[:, 2:]))
        self.low, self.high = samples[rows, np.maximum(top - 1, 0)], samples[rows, np.minimum(top + 1, 8)]
        self._height, self._theta, self.piece = g[rows, top + 1], samples[rows, top], self.piece[rows]

    def peaks(self) -> list[tuple[float, float, int, float]]:
        """Height, cam angle [rad], piece and sign of every peak."""
        rows = zip(self._height.tolist(), self._theta.tolist(), self.piece.tolist(), strict=True)
        return [(height, theta, piece, self.sign) for height, theta, piece in rows]


def goal_sign(goal: Goal) -> float:
    """1 for a goal to be minimised, -1 for one to be maximised."""
    return 1.0 if goal.minimise else -1.0


def needs_forces(term: Term) -> bool:
    """Whether the quantity of a figure needs the forces."""
    return quantity(term.request.name).stage == "dynamics"
