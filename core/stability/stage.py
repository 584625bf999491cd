"""The stability of one machine as a study contains it. Each part is computed at its first access."""

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
from core.number_text import COMPARED_DIGITS, distinct_texts, result_text
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
from core.stability.windup import (
    Averages,
    FollowerContact,
    History,
    ShaftContacts,
    contact,
    etas,
    history,
    mean_wind_up,
)

# -- verdicts of the models at one point of the chart -----------------------------------------------------------

STEADY, FROM_REST = "steady", "from_rest"
LINEAR = (APPROXIMATE, EXACT)
SETTLED = 0.9  # of the time: a wind-up whose maximum is before it no longer grows
PERIODS = 30.0

STABLE, UNSTABLE, LOST, UNKNOWN_VERDICT = "stable", "unstable", "contact lost", "cannot say"
"""States of a verdict. LOST: a response that would be stable if the follower stayed on the cam."""

LABELS = {**EQUATIONS, STEADY: "About the true steady response", FROM_REST: "Nonlinear, from rest (13)"}


@frozen
class Verdict:
    """Result of one model at one point of the chart.

    Attributes
    ----------
    model : str
        Key of `LABELS`.
    stable : bool or None
        None where the model cannot say: the steady response does not exist, or the history is too short.
    growth : float
        Logarithm of the growth per turn, NaN where the model has none.
    trace : float
        Trace of its monodromy matrix, NaN where the model has none.
    largest : float
        Largest |β| of the response [turns], NaN where the model has none.
    contact_lost : float or None
        First y [turns] at which the follower leaves the cam; None where it stays on it or no contact is known.
    leaving : str
        Name of the drive whose follower leaves its cam, in a design of several drives.
    """

    model: str
    stable: bool | None
    growth: float = float("nan")
    trace: float = float("nan")
    largest: float = float("nan")
    contact_lost: float | None = None
    leaving: str = ""

    @property
    def label(self) -> str:
        """Title of the model."""
        return LABELS[self.model]

    @property
    def state(self) -> str:
        """`STABLE`, `UNSTABLE`, `LOST` or `UNKNOWN_VERDICT`; the equations only hold with the follower on the cam."""
        if self.stable is None:
            return UNKNOWN_VERDICT
        if not self.stable:
            return UNSTABLE
        return STABLE if self.contact_lost is None else LOST


def linear_verdicts(
    coefficients: Coefficients, eta: float, q: float, damping: float = 0.0, models: Sequence[str] = LINEAR
) -> tuple[Verdict, ...]:
    """Verdicts of the linear equations (22) and (21)."""
    verdicts = []
    for model in models:
        turn = monodromy(coefficients, np.array([eta]), np.array([q]), model, damping)
        rate = float(turn.growth[0])
        verdicts.append(Verdict(model, rate <= TOLERANCE, rate, float(turn.trace[0])))
    return tuple(verdicts)


def steady_verdict(turn: SteadyTurn | None) -> Verdict:
    """Stability of the true steady response, with the largest wind-up of one turn; the decisive verdict."""
    if turn is None:
        return Verdict(STEADY, None)
    response, run = turn.response, turn.history
    return Verdict(
        STEADY, response.stable, response.growth, response.trace, run.largest[0], run.contact_lost, run.leaving
    )


def rest_verdict(run: History) -> Verdict:
    """Verdict of a history from rest: stable where the wind-up has stopped growing."""
    largest, y = run.largest
    settled = y <= SETTLED * run.periods and run.ended == run.periods
    return Verdict(
        FROM_REST, True if settled else None, largest=largest, contact_lost=run.contact_lost, leaving=run.leaving
    )


# -- the stability of one machine -------------------------------------------------------------------------------

TIMES = (1.0, 2.0, 4.0, 10.0, 20.0)  # rows of the means, in the machine's Q; 0.05 ... 1 of Kim1990 where Q is 0.05
FARTHEST_ETA = 60.0  # greatest η up to which the tongue next to the machine's own speed is computed
FARTHEST_CHART, BEYOND = 20.0, 1.06  # greatest η of a chart, above which tongues cannot be distinguished; margin
MOST_SWINGS = 1e4  # greatest η, oscillations of the shaft in a turn
STEADY_ETA = FARTHEST_ETA  # greatest η of the machine's own steady response, which takes long for a soft shaft


@dataclass(eq=False)
class Stability:
    """A flexible shaft and the mechanisms it drives.

    Attributes
    ----------
    coefficients : Coefficients
        Dimensionless.
    machine : Machine
        In SI units.
    contact : ShaftContacts or None
        None where no follower can leave its cam.
    followers_of : callable
        The followers it drives; none by default.
    turns : float
        Turns of the input of a history from rest.
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
        """Contact forces of the followers; None where no follower can leave its cam."""
        return self.contact_of()

    def tongues(
        self, equation: str = EXACT, eta_max: float = ETA_MAX, q: float | None = None, error: float = EDGE_ERROR
    ) -> Tongues:
        """Tongues of the machine's Q, or of a given Q, with its damping."""
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
        """Upper end of a chart with the machine: 5.6 as in Kim1990 or, for a slower machine, a little above its η."""
        return max(ETA_MAX, min(BEYOND * self.machine.eta, FARTHEST_CHART))

    @cached_property
    def exact(self) -> Tongues:
        """Tongues of (21) up to η = 5.6 or, for a slower machine, up to the one above its own η."""
        highest = self.machine.eta + 1.0 if self.machine.eta <= FARTHEST_ETA else ETA_MAX
        return self.tongues(EXACT, max(ETA_MAX, highest))

    @cached_property
    def bands(self) -> tuple[ForbiddenBand, ...]:
        """Forbidden bands of speed, the fastest first."""
        return bands(self.coefficients, self.machine, self.exact)

    @cached_property
    def near_bands(self) -> tuple[ForbiddenBand, ...]:
        """Forbidden bands that contain the machine's own speed or are near it."""
        return bands(self.coefficients, self.machine, self.exact, within=CLEAR)

    @property
    def top_rpm(self) -> float:
        """Speed [1/min] above which everything is unstable; infinite where no speed is."""
        return self.machine.rpm(float(self.exact.bottom[0]))

    @cached_property
    def linear(self) -> tuple[Verdict, ...]:
        """Verdicts of (22) and (21) at the machine's own point."""
        return self.linear_at(self.machine.eta, self.machine.q)

    @cached_property
    def steady(self) -> Verdict:
        """Verdict of the true steady response at the machine's own point."""
        return steady_verdict(self.steady_turn)

    @cached_property
    def steady_turn(self) -> SteadyTurn | None:
        """One turn of the steady response; None where it does not exist, or above ``STEADY_ETA``."""
        return self.steady_turn_at(self.machine.eta, self.machine.q) if self.machine.eta <= STEADY_ETA else None

    @property
    def own_verdicts(self) -> tuple[Verdict, ...]:
        """Verdicts at the machine's own point, with that of the steady response up to ``STEADY_ETA``."""
        return (*self.linear, self.steady) if self.machine.eta <= STEADY_ETA else self.linear

    def history(self, periods: float | None = None, eta: float | None = None, q: float | None = None) -> History:
        """History from rest at the machine's own point or at a given one; the last one is cached."""
        m = self.machine
        periods = self.turns if periods is None else periods
        key = periods, m.eta if eta is None else eta, m.q if q is None else q
        last = self._last  # another thread may request another point meanwhile
        if last is None or last[0] != key:
            last = self._last = key, history(self.coefficients, *key[1:], m.damping, periods, contact=self.contact)
        return last[1]

    @cached_property
    def first_turn(self) -> Averages:
        """Means of the first turn from rest, for the machine's own Q and multiples of it."""
        return self.averages(eta_max=self.eta_max)

    def averages(self, q: Sequence[float] = (), eta_max: float = ETA_MAX) -> Averages:
        """Mean wind-up of the first turn from rest by η, by default for the machine's own Q and multiples of it."""
        m = self.machine
        rows = q or [times * m.q for times in TIMES]
        return mean_wind_up(self.coefficients, rows, etas(eta_max), m.damping, self.contact)

    def linear_at(self, eta: float, q: float) -> tuple[Verdict, ...]:
        """Verdicts of (22) and (21) at a point of the chart."""
        return linear_verdicts(self.coefficients, eta, q, self.machine.damping)

    def rest_at(self, eta: float, q: float, periods: float | None = None) -> Verdict:
        """Verdict of a history from rest at a point of the chart; takes a second."""
        return rest_verdict(self.history(periods, eta, q))

    def steady_at(self, eta: float, q: float) -> Verdict:
        """Verdict of the true steady response at a point of the chart; takes seconds near a resonance."""
        return steady_verdict(self.steady_turn_at(eta, q))

    def steady_turn_at(self, eta: float, q: float) -> SteadyTurn | None:
        """One turn of the true steady response at a point of the chart, None where it does not exist.

        Raises
        ------
        ResultPending
            Where another thread computes it.
        """
        if self._last_steady is None or self._last_steady[0] != (eta, q):
            postpone("the steady response", ("steady", id(self), eta, q), partial(self.steady_turn_at, eta, q), "shaft")
        last = self._last_steady  # another thread may request another point meanwhile
        if last is None or last[0] != (eta, q):
            m, followers = self.machine, self.followers_of()
            turn = steady_turn(self.coefficients, eta, q, m.damping, self.contact, m.stiffness, followers)
            last = self._last_steady = (eta, q), turn
        return last[1]

    def verdicts(self, eta: float, q: float, periods: float | None = None) -> tuple[Verdict, ...]:
        """Verdicts of every model at a point of the chart; periods: turns of the history from rest."""
        return (*self.linear_at(eta, q), self.steady_at(eta, q), self.rest_at(eta, q, periods))

    def stiffness_for(self, rpm: float) -> Stiffness:
        """Stiffness of the shaft for a speed [1/min].

        Raises
        ------
        NoStability
            Where η at that speed exceeds ``FARTHEST_ETA``.
        """
        eta = self.machine.natural / (rpm / RPM)
        if eta > FARTHEST_ETA:
            raise NoStability(
                f"at {result_text(rpm)} rpm the shaft swings {result_text(eta)} times a turn; the tongues end at {FARTHEST_ETA:g}",
                "shaft.speed_rpm",
                f"allowed: {result_text(self.machine.rpm(FARTHEST_ETA), 5)} rpm and more",
            )
        return stiffness_for(self.coefficients, self.machine, rpm, count_up_to(max(ETA_MAX, eta + 1.0)))

    @cached_property
    def certificate(self) -> dict[str, Residual]:
        """Residuals of the tongues' edges up to η = 5.6, by two methods, and of Liouville's determinant.

        The tongues of (21) without damping follow from harmonic balance and from monodromy matrices; they may differ by
        the sum of both error bounds. Empty where there are no tongues.
        """
        try:
            harmonic = harmonic_tongues(self.coefficients, np.array([self.machine.q]), count_up_to(ETA_MAX), EXACT)
        except NoStability:
            return {}
        again = refined(self.coefficients, harmonic)
        known = harmonic.error[0] <= UNKNOWN
        room = np.maximum(harmonic.error + again.error, LEAST_BOUND)[0]
        difference = np.abs(harmonic.edges - again.edges).max(axis=2)[0]
        worst = int((np.where(known, difference, 0.0) / room).argmax())
        residual = Residual(float(difference[worst]), float(room[worst])) if known.any() else Residual(0.0, 0.0)
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
    coefficients: Coefficients,
    elastic: ElasticShaft,
    omega: float,
    contact_of: Callable[[], ShaftContacts | None] = lambda: None,
    followers_of: Callable[[], Sequence[Follower]] = tuple,
) -> Stability:
    """Stability of a machine with these coefficients at camshaft speed omega [rad/s].

    Parameters
    ----------
    coefficients : Coefficients
    elastic : ElasticShaft
    omega : float
        Speed [rad/s].
    contact_of : callable
        Contact forces of the followers, None where no follower can leave its cam.
    followers_of : callable
        Followers whose errors the steady response contains.

    Returns
    -------
    Stability

    Raises
    ------
    NoStability
        Where η exceeds ``MOST_SWINGS``.
    """
    s = si(elastic)
    machine = Machine(
        s.camshaft_inertia, s.stiffness, omega, elastic.damping_ratio, coefficients.q, coefficients.sizes.inertia
    )
    if machine.eta > MOST_SWINGS:
        raise NoStability(
            f"the shaft swings {result_text(machine.eta, 3)} times a turn, more than the {MOST_SWINGS:g} that can be computed",
            "shaft.speed_rpm",
            "increase it, or use a softer shaft",
        )
    return Stability(coefficients, machine, contact_of, followers_of)


def contact_forces(
    coefficients: Coefficients, elastic: ElasticShaft, followers: Sequence[FollowerContact], turn: Any
) -> ShaftContacts | None:
    """Contact forces of the followers on their cams; None without followers, or where no contact force can be computed.

    The turn has the pieces of the shaft's turn, inside which no follower has a join.
    """
    if not followers:
        return None
    try:
        return contact(
            followers,
            turn,
            coefficients.sizes,
            elastic.spring,
            elastic.spring_factor,
            coefficients.q,
            si(elastic).stiffness,
        )
    except NoSolution:
        return None


# -- limits: running in a forbidden band of speed, or near one ---------------------------------------------

FIELD = "shaft.stiffness_nm_per_rad"
SPEED_DIGITS = COMPARED_DIGITS
FAR = 1.0  # relative distance, or growth, from which on it is a factor instead of a percentage


def speed_sentence(shaft: Stability) -> str:
    """Whether the machine's speed is clear of the forbidden bands, and the nearest one, as a sentence.

    The nearest band is one with noticeable growth where there is such a band: the smallest damping closes the others.
    """
    rpm = shaft.machine.omega * RPM
    if rpm >= shaft.top_rpm:
        speed, top = distinct_texts((rpm, shaft.top_rpm), SPEED_DIGITS)
        return f"{speed} rpm is inside the unstable range: above {top} rpm no speed is stable."
    inside = [band for band in shaft.bands if band.contains(rpm)]
    if inside:
        band = max(inside, key=lambda b: b.growth)
        closed = "" if band.growth >= NOTICEABLE else ", which the smallest damping prevents"
        where, speed = speed_range(band, rpm)
        return (
            f"{speed} rpm is inside a forbidden band, {where} rpm: the twist of the shaft grows by up to "
            f"{growth_text(band.growth)} a turn{closed}."
        )
    if shaft.linear[-1].growth > TOLERANCE:  # above the computed bands
        grows = growth_text(shaft.linear[-1].growth)
        return f"{result_text(rpm, SPEED_DIGITS)} rpm is inside an unstable range: the twist of the shaft grows by {grows} a turn."
    nearest = min(shaft.bands, key=lambda b: (b.growth < NOTICEABLE, b.distance(rpm)), default=None)
    if nearest is None:
        return f"{result_text(rpm, SPEED_DIGITS)} rpm is clear: the shaft has no forbidden speeds."
    where, speed = speed_range(nearest, rpm)
    clear = "keeps clear of every band" if nearest.distance(rpm) > CLEAR else "is clear of every band, but close to one"
    return f"{speed} rpm {clear}; the nearest is {where} rpm, {margin_text(nearest, rpm)}."


def speed_range(band: ForbiddenBand, rpm: float) -> tuple[str, str]:
    """The speeds [1/min] of a band, and another speed, with enough digits to tell them apart."""
    if math.isinf(band.rpm_hi):
        low, speed = distinct_texts((band.rpm_lo, rpm), SPEED_DIGITS)
        return f"{low} … ∞", speed
    *ends, speed = distinct_texts((band.rpm_lo, band.rpm_hi, rpm), SPEED_DIGITS)
    return " … ".join(dict.fromkeys(ends)), speed


def margin_text(band: ForbiddenBand, rpm: float) -> str:
    """Distance of a band from a speed [1/min]: `4.7 % above`, `inside`."""
    if band.contains(rpm):
        return "inside"
    part = band.distance(rpm)
    side = "above" if band.rpm_lo > rpm else "below"
    return f"{result_text(100.0 * part, 2)} % {side}" if part < FAR else f"{result_text(1.0 + part, 3)} times as fast"


def growth_text(growth: float) -> str:
    """Growth per turn from its logarithm: `2.3 %`, `a factor of 12`."""
    part = math.expm1(growth)
    return f"{result_text(100.0 * part, 2)} %" if part < FAR else f"a factor of {result_text(1.0 + part, 3)}"


def nearest_bands(shaft: Stability, count: int) -> tuple[ForbiddenBand, ...]:
    """The forbidden bands nearest to the machine's own speed, the nearest first."""
    rpm = shaft.machine.omega * RPM
    return tuple(sorted(shaft.bands, key=lambda band: band.distance(rpm))[:count])


def findings(shaft: Stability) -> list[Finding]:
    """Position of the machine's own speed among the forbidden bands.

    In a band with noticeable growth: an error; in one that the smallest damping closes: a warning; near one: a note.
    """
    rpm = shaft.machine.omega * 30.0 / math.pi
    if rpm >= shaft.top_rpm:
        values = {"rpm": rpm, "top_rpm": shaft.top_rpm}
        return [Finding("above-all-speeds", ERROR, FIELD, None, values)]
    growth = shaft.linear[-1].growth
    inside = [b for b in shaft.near_bands if b.contains(rpm)]
    near = [b for b in shaft.near_bands if b.growth >= NOTICEABLE and b.distance(rpm) <= CLEAR]
    if inside:
        code, band = "unstable-speed", max(inside, key=lambda b: b.growth)
        severity = ERROR if band.growth >= NOTICEABLE else WARNING
    elif growth > TOLERANCE:  # above the computed bands
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
