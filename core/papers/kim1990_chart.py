"""The numbers of Kim1990's claims on its chart, its figures and its linearisation, each of the example's shaft."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np

from core.errors import NoStability
from core.papers.claim import Examples
from core.stability import ETA_MAX, Stability, monodromy, tongues
from core.stability.coefficients import (
    APPROXIMATE,
    CENTRIPETAL,
    CURVATURE,
    EXACT,
    INERTIA,
    LOAD_SLOPE,
    RETUNED,
    Coefficients,
    kim_edges,
)
from core.stability.stage import linear_verdicts, rest_verdict, steady_verdict
from core.stability.steady import TOLERANCE, steady_turn
from core.stability.tongues import Tongues
from core.stability.windup import Averages, History, etas, histories, history, mean_wind_up

EXAMPLE = "kim_1990"
FACTOR = 1.5
SHAPE = 1e-9
SHARP = 1e-12  # wanted error of an edge: the narrowest tongue that is judged is 3e-7 wide
COUNT = 11
Q, TWICE = 0.05, 0.1
FIRST_TURN = (Q, TWICE, 0.2, 0.3, 0.4, 0.5)  # rows of Q in which the follower is watched through its first turn
ROWS = (0.05, 0.1, 0.2, 0.5, 1.0)
"""Kim1990 Figs. 6, 7: Q of their curves."""
TURNS = 30.0  # of a history
FIGURES = ((9, 0.85, 0.10, True), (10, 0.90, 0.10, False), (11, 2.10, 0.05, True), (12, 2.00, 0.05, False))
"""Kim1990 Figs. 9-12: figure, η, Q, whether the paper calls it stable."""

Numbers = Mapping[str, Any]


def require_kim(coefficients: Coefficients) -> None:
    """Raises NoStability unless this is Kim1990's cam: X = (X_m/2)(1 - cos 2θ) on 0 ... π, then a dwell, a = 1.5."""
    theta = coefficients.panels.theta
    moving = theta < pi
    inertia = np.where(moving, np.sin(2.0 * theta) ** 2, 0.0)
    slope = np.where(moving, 2.0 * FACTOR * (np.cos(2.0 * theta) - np.cos(4.0 * theta)), 0.0)
    rows = coefficients.panels.values
    off = max(float(np.abs(rows[INERTIA] - inertia).max()), float(np.abs(rows[LOAD_SLOPE] - slope).max()))
    if coefficients.spring != RETUNED or off > SHAPE:
        raise NoStability(
            "the claims of Kim1990 are about its own cam, and this is another",
            "motion.segments",
            "take the example kim_1990.toml",
        )


# -- what several claims and figures share -----------------------------------------------------------------


def shaft_of(examples: Examples) -> Stability:
    shaft: Stability = examples.once("shaft of Kim", lambda: examples.study(EXAMPLE).flexible_shaft())
    return shaft


def row(examples: Examples, q: float, equation: str) -> Tongues:
    """The tongues 1 ... 11 at one Q."""
    coefficients = shaft_of(examples).coefficients
    made: Tongues = examples.once(
        ("tongues", q, equation), lambda: tongues(coefficients, np.array([q]), COUNT, equation, error=SHARP)
    )
    return made


def run_of(examples: Examples, number: int) -> History:
    """The history of one of the Figs. 9-12, from all of them where these have been made."""
    shaft, at = shaft_of(examples), [figure[0] for figure in FIGURES].index(number)
    if _together(TURNS, 0.0) in examples.made:
        return runs(examples)[at]
    _, eta, q, _ = FIGURES[at]
    made: History = examples.once(
        ("history", number), lambda: history(shaft.coefficients, eta, q, contact=shaft.contact)
    )
    return made


def runs(examples: Examples, periods: float = TURNS, damping: float = 0.0) -> tuple[History, ...]:
    """Figs. 9-12, side by side."""
    shaft = shaft_of(examples)
    eta, q = (np.array([figure[i] for figure in FIGURES]) for i in (1, 2))
    made: tuple[History, ...] = examples.once(
        _together(periods, damping),
        lambda: histories(shaft.coefficients, eta, q, damping, periods, contact=shaft.contact),
    )
    return made


def _together(periods: float, damping: float) -> Hashable:
    """The key of what ``runs`` has made."""
    return "histories", periods, damping


def averages(examples: Examples, q: tuple[float, ...], eta_max: float = ETA_MAX, damping: float = 0.0) -> Averages:
    """The means of the first turn from rest in these rows of Q, of ``FIRST_TURN`` and ``ROWS``, which are computed together."""
    shaft, every, top = shaft_of(examples), sorted({*FIRST_TURN, *ROWS}), max(eta_max, ETA_MAX)
    made: Averages = examples.once(
        ("averages", top, damping), lambda: mean_wind_up(shaft.coefficients, every, etas(top), damping, shaft.contact)
    )
    rows, columns = np.isin(made.q, q), np.arange(etas(eta_max).size)
    here = np.ix_(rows, columns)
    lost = None if made.is_contact_lost is None else made.is_contact_lost[here]
    return replace(
        made,
        q=made.q[rows],
        eta=made.eta[columns],
        wind_up=made.wind_up[here],
        slope=made.slope[here],
        is_contact_lost=lost,
    )


def first_turn(examples: Examples) -> Averages:
    return averages(examples, FIRST_TURN, 5.0)


def widths(found: Tongues) -> np.ndarray:
    return np.asarray(found.edges[0, :, 1] - found.edges[0, :, 0])


# -- the numbers of the claims -----------------------------------------------------------------------------


def spring_growth(examples: Examples) -> Numbers:
    """ln of the growth a turn of β'' = ∓4π²η²β, the cam at rest: the real part of its root 2πη √∓1."""
    eta = FIGURES[0][1]
    as_printed, corrected = (float(np.real(2.0 * pi * eta * np.emath.sqrt(sign))) for sign in (1.0, -1.0))
    return {"eta": eta, "printed": as_printed, "corrected": corrected}


def _with_psi(coefficients: Coefficients, psi: np.ndarray) -> Coefficients:
    """With another slope of the load at the nodes of the panels."""
    values = coefficients.panels.values.copy()
    values[LOAD_SLOPE] = psi
    return replace(coefficients, panels=replace(coefficients.panels, values=values))


def _printed_psi(coefficients: Coefficients) -> np.ndarray:
    """ψ with X''X'' for X''X, X in units of X_m, as (22) is printed."""
    theta = coefficients.panels.theta
    sizes = 4.0 * np.cos(2.0 * theta) ** 2 + np.sin(2.0 * theta) ** 2
    return np.asarray(np.where(theta < pi, 2.0 * FACTOR * sizes, 0.0))


def readings(coefficients: Coefficients, eta: float, q: float) -> Mapping[str, bool]:
    """Whether a point of the chart is stable where the print is taken at its word, misprint by misprint, each in the linear equation
    that it stands in; and by the paper's 11 x 11 matrix. The sign of (13) is not among them: with it every point runs away."""
    rows = coefficients.panels.values
    psi = rows[LOAD_SLOPE]
    printed: Mapping[str, tuple[np.ndarray, float, str]] = {
        "(4) without its minus": (psi, -q, EXACT),
        "(13) without X'm²": (psi * coefficients.sizes.slope**2, q, EXACT),
        "(17) with -Me": (-psi, q, EXACT),
        "(19) with Ce": (psi + rows[CENTRIPETAL] - rows[CURVATURE], q, EXACT),
        "(22) with X''X''": (_printed_psi(coefficients), q, APPROXIMATE),
    }
    growth = {
        name: float(monodromy(_with_psi(coefficients, slope), np.array([eta]), np.array([each]), equation).growth[0])
        for name, (slope, each, equation) in printed.items()
    }
    tongue = (kim_edges(coefficients, q)[:, 0] < eta) & (eta < kim_edges(coefficients, q)[:, 1])
    return {**{name: rate <= TOLERANCE for name, rate in growth.items()}, "(27) with 11 x 11 terms": not tongue.any()}


def load_means(examples: Examples) -> Numbers:
    """The mean over the turn of ψ, with X''X'' in it (X in units of X_m, as in (22)) and of the ψ that is used; and the traces that (22)
    has with either at the point of Fig. 12."""
    coefficients = shaft_of(examples).coefficients
    made = (_with_psi(coefficients, _printed_psi(coefficients)), coefficients)
    _, eta, q, _ = FIGURES[-1]
    traces = [float(monodromy(each, np.array([eta]), np.array([q]), APPROXIMATE).trace[0]) for each in made]
    means = [float((each.panels.weights * each.panels.values[LOAD_SLOPE]).sum()) for each in made]
    return {
        "printed": means[0],
        "corrected": means[1],
        "trace_as_printed": traces[0],
        "trace": traces[1],
    }


def approximation(examples: Examples) -> Numbers:
    approximate, exact = (row(examples, Q, each).edges[0] for each in (APPROXIMATE, EXACT))
    return {"q": Q, "approximate": approximate, "exact": exact}


def at_q(examples: Examples) -> Numbers:
    """Of (22), of which Fig. 8 is made."""
    return {"q": Q, "widths": widths(row(examples, Q, APPROXIMATE))}


def at_q_in_both(examples: Examples) -> Numbers:
    return {**at_q(examples), "exact": widths(row(examples, Q, EXACT))}


def at_q_with_errors(examples: Examples) -> Numbers:
    return {**at_q(examples), "errors": 2.0 * row(examples, Q, APPROXIMATE).error[0]}


def growing(examples: Examples) -> Numbers:
    small, large = (widths(row(examples, q, APPROXIMATE)) for q in (Q, TWICE))
    return {"q": np.array([Q, TWICE]), "small": small, "large": large}


def eleven(examples: Examples) -> Numbers:
    """The farther of each tongue's two edges (11,) in the paper's own matrix; inf where it has no second edge."""
    approximate = row(examples, Q, APPROXIMATE)
    off = np.abs(kim_edges(shaft_of(examples).coefficients, Q, COUNT) - approximate.edges[0]).max(axis=1)
    return {"q": Q, "off": np.where(np.isnan(off), np.inf, off), "widths": widths(approximate)}


def means(examples: Examples) -> Numbers:
    first = first_turn(examples)
    return {"q": first.q, "means": first.wind_up, "slopes": first.slope}


def losses(examples: Examples) -> Numbers:
    first = first_turn(examples)
    lost = np.zeros(first.q.size, dtype=bool) if first.is_contact_lost is None else first.is_contact_lost.any(axis=1)
    return {"q": first.q, "lost": lost, "later": [(h.eta, h.q, h.contact_lost) for h in runs(examples)]}


def point(number: int) -> Callable[[Examples], Numbers]:
    """Of one of the Figs. 9-12."""
    at = [figure[0] for figure in FIGURES].index(number)
    _, eta, q, stable = FIGURES[at]

    def numbers(examples: Examples) -> Numbers:
        shaft, run = shaft_of(examples), run_of(examples, number)
        models = (
            *linear_verdicts(shaft.coefficients, eta, q),
            steady_verdict(steady_turn(shaft.coefficients, eta, q, contact=shaft.contact)),
        )
        return {
            "stable": stable,
            "models": models,
            "rest": rest_verdict(run),
            "readings": readings(shaft.coefficients, eta, q),
        }

    return numbers


def follower_error(examples: Examples) -> Numbers:
    """X(θ_c) - X(θ_i) of Fig. 9 as a part of the stroke, and the amplitude of the shaft's torque K_s 2πβ over its mean one's
    size, from rest."""
    study, run = examples.study(EXAMPLE), runs(examples)[0]  # Fig. 12 is drawn beside it
    y = np.arange(3000) / 100.0
    beta = run.at(y)[0]
    true, wanted = (
        study.at_theta(np.mod(2.0 * pi * turns, 2.0 * pi)).motion.displacement[0] for turns in (y - beta, y)
    )
    machine = shaft_of(examples).machine
    return {
        "stroke": float(np.abs(true - wanted).max()) / shaft_of(examples).coefficients.sizes.stroke,
        "twist": float(np.abs(beta).max()),
        "torque": 2.0 * pi * machine.stiffness * float(np.abs(beta).max()),
    }


def later_turns(examples: Examples) -> Numbers:
    """The largest |β| of the histories of Figs. 9-12 through 30 turns, by their η and Q."""
    return {"points": tuple((run.eta, run.q, run.largest[0]) for run in runs(examples))}


def histories_and_chart(examples: Examples) -> Numbers:
    """Figs. 9-12 against Fig. 8: of each what (22), of which the chart is made, says, and what the history from rest shows."""
    coefficients = shaft_of(examples).coefficients
    found = []
    for (number, eta, q, _), run in zip(FIGURES, runs(examples), strict=True):
        verdict = linear_verdicts(coefficients, eta, q, models=(APPROXIMATE,))[0]
        found.append((number, verdict.state, rest_verdict(run).state))
    return {"found": tuple(found)}
