"""The stability of one machine: what a study keeps of it. Each part is computed when it is read."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, ClassVar

import numpy as np

from core.design import ElasticShaft, si
from core.errors import NoSolution, NoStability
from core.findings import ERROR, LEAST_BOUND, NOTE, WARNING, Finding, Residual
from core.frozen import frozen
from core.numerics.lazy import postpone
from core.stability.coefficients import APPROXIMATE, EQUATIONS, EXACT, Coefficients
from core.stability.critical_speeds import (
    CLEAR,
    NOTICEABLE,
    RPM,
    ForbiddenBand,
    Machine,
    Stiffness,
    bands,
    stiffness_for,
)
from core.stability.floquet import UNKNOWN, liouville, monodromy, refined, tongues
from core.stability.steady import TOLERANCE, Follower, SteadyTurn, steady_turn
from core.stability.tongues import EDGE_ERROR, ETA_MAX, Tongues, count_up_to, harmonic_tongues
from core.stability.windup import Averages, History, ShaftContacts, Touching, contact, etas, history, mean_wind_up

# -- what each model says of one point of the chart, side by side -----------------------------------------------


STEADY, FROM_REST = "steady", "from_rest"
LINEAR = (APPROXIMATE, EXACT)
SETTLED = 0.9  # of the time: what stands highest before it no longer grows
PERIODS = 30.0

STABLE, UNSTABLE, LOST, UNKNOWN_VERDICT = "stable", "unstable", "contact lost", "cannot say"
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
            return UNKNOWN_VERDICT
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


# -- the stability of one machine -------------------------------------------------------------------------------


TIMES = (1.0, 2.0, 4.0, 10.0, 20.0)  # rows of the means, in the machine's Q: 0.05 ... 1 of Kim1990 where that is 0.05
FARTHEST_ETA = 60.0  # the tongue next to the machine's own speed is computed up to here
FARTHEST_CHART, BEYOND = 20.0, 1.06  # of a chart: beyond, tongues stand too close to be distinguished
MOST_SWINGS = 1e4  # of the shaft in a turn, η
STEADY_ETA = FARTHEST_ETA  # and the machine's own steady response: a slow shaft in a hurry would take long


@dataclass(eq=False)
class Stability:
    """A flexible shaft and what it drives.

    coefficients, machine   dimensionless and in SI
    contact                 None where the design has no cam that could be lifted off
    followers_of            the followers it drives; none where they are not asked for
    turns                   of the input through which the shaft is followed from rest
    """

    coefficients: Coefficients
    machine: Machine
    contact_of: Callable[[], ShaftContacts | None]
    followers_of: Callable[[], Sequence[Follower]] = tuple
    turns: ClassVar[float] = PERIODS
    _last: tuple[tuple[float, float, float], History] | None = None
    _last_steady: tuple[tuple[float, float], SteadyTurn | None] | None = None

    @cached_property
    def contact(self) -> ShaftContacts | None:
        return self.contact_of()

    def tongues(
        self, equation: str = EXACT, eta_max: float = ETA_MAX, q: float | None = None, error: float = EDGE_ERROR
    ) -> Tongues:
        """The row of the machine, or of another Q, with its damping."""
        return tongues(
            self.coefficients,
            np.array([self.machine.q if q is None else q]),
            count_up_to(eta_max),
            equation,
            self.machine.damping,
            error,
        )

    @property
    def eta_max(self) -> float:
        """How far a chart goes that shows the machine: 5.6 as Kim1990's or, where it runs slower, a little beyond its η."""
        return max(ETA_MAX, min(BEYOND * self.machine.eta, FARTHEST_CHART))

    @cached_property
    def exact(self) -> Tongues:
        """The tongues of (21) up to η = 5.6 or, where the machine runs slower, next to its own speed."""
        wanted = self.machine.eta + 1.0 if self.machine.eta <= FARTHEST_ETA else ETA_MAX
        return self.tongues(EXACT, max(ETA_MAX, wanted))

    @cached_property
    def bands(self) -> tuple[ForbiddenBand, ...]:
        """The forbidden bands of speed, the fastest first."""
        return bands(self.coefficients, self.machine, self.exact)

    @cached_property
    def near_bands(self) -> tuple[ForbiddenBand, ...]:
        """Those of the bands that hold the machine's own speed or come near it: far fewer than all where the shaft swings
        often in a turn."""
        return bands(self.coefficients, self.machine, self.exact, within=CLEAR)

    @property
    def top_rpm(self) -> float:
        """Above this speed [1/min] everything is unstable; infinite where nothing is."""
        return self.machine.rpm(float(self.exact.bottom[0]))

    @cached_property
    def linear(self) -> tuple[Verdict, ...]:
        """What (22) and (21) say of the machine's own point."""
        return self.linear_at(self.machine.eta, self.machine.q)

    @cached_property
    def steady(self) -> Verdict:
        """What the true steady response says of the machine's own point."""
        return steady_verdict(self.steady_turn)

    @cached_property
    def steady_turn(self) -> SteadyTurn | None:
        """One turn of it; None where there is none, or where η is beyond reach."""
        return self.steady_turn_at(self.machine.eta, self.machine.q) if self.machine.eta <= STEADY_ETA else None

    @property
    def own_verdicts(self) -> tuple[Verdict, ...]:
        """The verdicts on the machine's own point, the steady response's where η is not beyond reach."""
        return (*self.linear, self.steady) if self.machine.eta <= STEADY_ETA else self.linear

    def history(self, periods: float | None = None, eta: float | None = None, q: float | None = None) -> History:
        """From rest at the machine's own point or at another one of the chart; the last one is kept."""
        m = self.machine
        periods = self.turns if periods is None else periods
        key = periods, m.eta if eta is None else eta, m.q if q is None else q
        last = self._last  # another thread may request another point meanwhile
        if last is None or last[0] != key:
            last = self._last = key, history(self.coefficients, *key[1:], m.damping, periods, contact=self.contact)
        return last[1]

    @cached_property
    def first_turn(self) -> Averages:
        """The means of the first turn from rest, for the machine's own Q and multiples of it."""
        return self.averages(eta_max=self.eta_max)

    def averages(self, q: Sequence[float] = (), eta_max: float = ETA_MAX) -> Averages:
        """Mean wind-up of the first turn from rest by η; rows of Q: those given, or the machine's own and multiples of it."""
        m = self.machine
        rows = q or [times * m.q for times in TIMES]
        return mean_wind_up(self.coefficients, rows, etas(eta_max), m.damping, self.contact)

    def linear_at(self, eta: float, q: float) -> tuple[Verdict, ...]:
        """What (22) and (21) say of any point of the chart."""
        return linear_verdicts(self.coefficients, eta, q, self.machine.damping)

    def rest_at(self, eta: float, q: float, periods: float | None = None) -> Verdict:
        """What a history from rest shows at any point of the chart: it takes a second."""
        return rest_verdict(self.history(periods, eta, q))

    def steady_at(self, eta: float, q: float) -> Verdict:
        """What the true steady response says at any point of the chart: it takes seconds near a resonance."""
        return steady_verdict(self.steady_turn_at(eta, q))

    def steady_turn_at(self, eta: float, q: float) -> SteadyTurn | None:
        """One turn of the true steady response at any point of the chart, None where there is none; the last one is kept. Raises
        ResultPending where it is left to another thread."""
        if self._last_steady is None or self._last_steady[0] != (eta, q):
            postpone("the steady response", ("steady", id(self), eta, q), partial(self.steady_turn_at, eta, q), "shaft")
        last = self._last_steady  # as of the histories
        if last is None or last[0] != (eta, q):
            m, followers = self.machine, self.followers_of()
            made = steady_turn(self.coefficients, eta, q, m.damping, self.contact, m.stiffness, followers)
            last = self._last_steady = (eta, q), made
        return last[1]

    def verdicts(self, eta: float, q: float, periods: float | None = None) -> tuple[Verdict, ...]:
        """What every model says of any point of the chart; periods: turns of the history from rest."""
        return (*self.linear_at(eta, q), self.steady_at(eta, q), self.rest_at(eta, q, periods))

    def stiffness_for(self, rpm: float) -> Stiffness:
        """How stiff the shaft must be for a speed [1/min]. Raises NoStability where η is so large there that the tongue next
        to it is not computed."""
        wanted = self.machine.natural / (rpm / RPM)
        if wanted > FARTHEST_ETA:
            raise NoStability(
                f"at {rpm:.6g} rpm the shaft swings {wanted:.6g} times a turn, and tongues are looked for up to {FARTHEST_ETA:g}",
                "shaft.speed_rpm",
                f"allowed: {self.machine.rpm(FARTHEST_ETA):.6g} rpm and more",
            )
        return stiffness_for(self.coefficients, self.machine, rpm, count_up_to(max(ETA_MAX, wanted + 1.0)))

    @cached_property
    def certificate(self) -> dict[str, Residual]:
        """Harmonic balance against monodromy matrices at the edges up to η = 5.6, and Liouville's determinant there.

        The tongues of (21) without damping come both ways; they may differ by what both say they may be wrong by. Empty where
        there are none.
        """
        try:
            harmonic = harmonic_tongues(self.coefficients, np.array([self.machine.q]), count_up_to(ETA_MAX), EXACT)
        except NoStability:
            return {}
        again = refined(self.coefficients, harmonic)
        known = harmonic.error[0] <= UNKNOWN
        room = np.maximum(harmonic.error + again.error, LEAST_BOUND)[0]
        apart = np.abs(harmonic.edges - again.edges).max(axis=2)[0]
        worst = int((np.where(known, apart, 0.0) / room).argmax())
        residual = Residual(float(apart[worst]), float(room[worst])) if known.any() else Residual(0.0, 0.0)
        zero, slack = liouville(self.coefficients, again.edges.ravel(), self.machine.q, EXACT, self.machine.damping)
        late = int((zero / np.maximum(slack, LEAST_BOUND)).argmax())
        return {
            "tongue_residual": replace(
                residual, left_out=int(np.count_nonzero(~known)), cases=f"{known.size} tongues (too few harmonics)"
            ),
            "tongue_error": Residual(float(np.nanmax(self.exact.error, initial=0.0)), 1e-8),
            "liouville": Residual(float(zero[late]), float(slack[late])),
        }


def stability(
    made: Coefficients,
    elastic: ElasticShaft,
    omega: float,
    contact_of: Callable[[], ShaftContacts | None] = lambda: None,
    followers_of: Callable[[], Sequence[Follower]] = tuple,
) -> Stability:
    """The stability of a machine of these coefficients at camshaft speed omega [rad/s]; contact_of: the contact forces of a follower
    that could be lifted off its cam; followers_of: its followers, whose errors are wanted. Raises NoStability where the shaft swings so
    often in a turn that it cannot be followed."""
    s = si(elastic)
    machine = Machine(s.camshaft_inertia, s.stiffness, omega, elastic.damping_ratio, made.q, made.sizes.inertia)
    if machine.eta > MOST_SWINGS:
        raise NoStability(
            f"the shaft swings {machine.eta:.3g} times a turn, more than the {MOST_SWINGS:g} that can be followed",
            "shaft.speed_rpm",
            "raise it, or take a softer shaft",
        )
    return Stability(made, machine, contact_of, followers_of)


def contact_forces(
    made: Coefficients, elastic: ElasticShaft, followers: Sequence[Touching], turn: Any
) -> ShaftContacts | None:
    """The contact forces of the followers of such a machine; None where there is none that could leave its cam. turn: as for
    ``contact``."""
    if not followers:
        return None
    try:
        return contact(
            followers,
            turn,
            made.sizes,
            elastic.spring,
            elastic.spring_factor,
            made.q,
            si(elastic).stiffness,
        )
    except NoSolution:
        return None


# -- limits: running in a forbidden band of speed, or near one ---------------------------------------------

FIELD = "shaft.stiffness_nm_per_rad"


def findings(shaft: Stability) -> list[Finding]:
    """Where the machine's own speed stands among the forbidden bands. In a band that grows noticeably: an error; in one that
    the slightest damping would close: a warning; near one: a note."""
    rpm = shaft.machine.omega * 30.0 / math.pi
    if rpm >= shaft.top_rpm:
        values = {"rpm": rpm, "top_rpm": shaft.top_rpm}
        return [Finding("above-all-speeds", ERROR, FIELD, None, values)]
    growth = shaft.linear[-1].growth
    inside = [b for b in shaft.near_bands if b.holds(rpm)]
    near = [b for b in shaft.near_bands if b.growth >= NOTICEABLE and b.distance(rpm) <= CLEAR]
    if inside:
        code, band = "unstable-speed", max(inside, key=lambda b: b.growth)
        severity = ERROR if band.growth >= NOTICEABLE else WARNING
    elif growth > TOLERANCE:  # beyond the bands computed
        severity = ERROR if growth >= NOTICEABLE else WARNING
        return [
            Finding("unstable-shaft", severity, FIELD, None, {"rpm": rpm, "growth_percent": 100.0 * math.expm1(growth)})
        ]
    elif near:
        code, band, severity = "near-unstable-speed", min(near, key=lambda b: b.distance(rpm)), NOTE
    else:
        return []
    values = {
        "rpm": rpm,
        "n": float(band.n),
        "rpm_lo": band.rpm_lo,
        "rpm_hi": band.rpm_hi,
        "growth_percent": 100.0 * math.expm1(band.growth),
    }
    return [Finding(code, severity, FIELD, None, values)]
