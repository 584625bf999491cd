"""What each model says of one point of the chart, side by side: a point may be stable in one and not in another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.frozen import frozen
from core.stability.floquet import monodromy
from core.stability.hill.coefficients import APPROXIMATE, EQUATIONS, EXACT, Coefficients
from core.stability.steady_response import TOLERANCE
from core.stability.steady_turn import SteadyTurn
from core.stability.windup import History

STEADY, FROM_REST = "steady", "from_rest"
LINEAR = (APPROXIMATE, EXACT)
SETTLED = 0.9  # of the time: what stands highest before it no longer grows
PERIODS = 30.0

STABLE, UNSTABLE, LOST, UNKNOWN = "stable", "unstable", "contact lost", "cannot say"
"""What a model says in a word. LOST: of a response that would be stable, had the follower stayed on the cam."""

LABELS = {**EQUATIONS, STEADY: "About the true steady response", FROM_REST: "Nonlinear, from rest (13)"}


@frozen
class Verdict:
    """What one model says.

    model    row of ``LABELS``
    stable   None where it cannot say: there is no steady response, or the history is too short
    growth   ln of the growth per turn, nan where the model has none
    trace    of its monodromy matrix, nan where it has none
    largest  largest |β| of the response [turns], nan where the model has none
    lost     y at which the follower first leaves the cam [turns], None where it stays on it or no contact is known
    leaving  of several drives the one whose follower that is
    """

    model: str
    stable: bool | None
    growth: float = float("nan")
    trace: float = float("nan")
    largest: float = float("nan")
    lost: float | None = None
    leaving: str = ""

    @property
    def label(self) -> str:
        """What the model is called."""
        return LABELS[self.model]

    @property
    def state(self) -> str:
        """In a word, the same wherever it is shown: each equation holds only while the follower stays on the cam."""
        if self.stable is None:
            return UNKNOWN
        if not self.stable:
            return UNSTABLE
        return STABLE if self.lost is None else LOST


def linear_verdicts(
    coefficients: Coefficients, eta: float, q: float, damping: float = 0.0, models: Sequence[str] = LINEAR
) -> tuple[Verdict, ...]:
    """(22) and (21): quick."""
    made = []
    for model in models:
        turn = monodromy(coefficients, np.array([eta]), np.array([q]), model, damping)
        rate = float(turn.growth[0])
        made.append(Verdict(model, rate <= TOLERANCE, rate, float(turn.trace[0])))
    return tuple(made)


def steady_verdict(turn: SteadyTurn | None) -> Verdict:
    """The last word: stability of the true steady response, with the largest wind-up of one turn of it."""
    if turn is None:
        return Verdict(STEADY, None)
    response, run = turn.response, turn.history
    return Verdict(
        STEADY, response.stable, response.growth, response.trace, run.largest[0], run.contact_lost, run.leaving
    )


def rest_verdict(run: History) -> Verdict:
    """What a history from rest shows: whether the wind-up has stopped growing."""
    largest, y = run.largest
    settled = y <= SETTLED * run.periods and run.ended == run.periods
    return Verdict(FROM_REST, True if settled else None, largest=largest, lost=run.contact_lost, leaving=run.leaving)
