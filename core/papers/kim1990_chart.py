"""Numbers of Kim1990's claims on its chart, its figures and its linearisation, computed from the example's shaft."""

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
SHARP = 1e-12  # target error of an edge: the narrowest tongue in a claim has a width of 3e-7
COUNT = 11
Q, TWICE = 0.05, 0.1
FIRST_TURN = (Q, TWICE, 0.2, 0.3, 0.4, 0.5)  # rows of Q whose contact is evaluated over the first turn
ROWS = (0.05, 0.1, 0.2, 0.5, 1.0)
"""Kim1990 Figs. 6, 7: Q of their curves."""
TURNS = 30.0  # of a history
FIGURES = ((9, 0.85, 0.10, True), (10, 0.90, 0.10, False), (11, 2.10, 0.05, True), (12, 2.00, 0.05, False))
"""Kim1990 Figs. 9-12: figure, η, Q, whether the paper calls it stable."""

Numbers = Mapping[str, Any]


def require_kim(coefficients: Coefficients) -> None:
    """Require Kim1990's cam: X = (X_m/2)(1 - cos 2θ) on 0 ... π, then a dwell, a = 1.5.

    Raises
    ------
    NoStability
        For any other cam.
    """
    theta = coefficients.panels.theta
    moving = theta < pi
    inertia = np.where(moving, np.sin(2.0 * theta) ** 2, 0.0)
    slope = np.where(moving, 2.0 * FACTOR * (np.cos(2.0 * theta) - np.cos(4.0 * theta)), 0.0)
    rows = coefficients.panels.values
    off = max(float(np.abs(rows[INERTIA] - inertia).max()), float(np.abs(rows[LOAD_SLOPE] - slope).max()))
    if coefficients.spring != RETUNED or off > SHAPE:
        raise NoStability(
            "the claims of Kim1990 are about its own cam, which this is not",
            "motion.segments",
            "use the example kim_1990.toml",
        )


# -- shared results ----------------------------------------------------------------------------------------


def shaft_of(examples: Examples) -> Stability:
    """Flexible shaft of the example."""
    return examples.once("shaft of Kim", lambda: examples.study(EXAMPLE).flexible_shaft())


def row(examples: Examples, q: float, equation: str) -> Tongues:
    """Tongues 1 ... 11 at one Q."""
    coefficients = shaft_of(examples).coefficients
    return examples.once(
        ("tongues", q, equation), lambda: tongues(coefficients, np.array([q]), COUNT, equation, error=SHARP)
    )


def run_of(examples: Examples, number: int) -> History:
    """History of one of Figs. 9-12, from all of them where these are already computed."""
    shaft, index = shaft_of(examples), [figure[0] for figure in FIGURES].index(number)
    if _runs_key(TURNS, 0.0) in examples.cached_keys:
        return runs(examples)[index]
    _, eta, q, _ = FIGURES[index]
    return examples.once(("history", number), lambda: history(shaft.coefficients, eta, q, contact=shaft.contact))


def runs(examples: Examples, periods: float = TURNS, damping: float = 0.0) -> tuple[History, ...]:
    """Histories of Figs. 9-12, integrated together."""
    shaft = shaft_of(examples)
    eta, q = (np.array([figure[i] for figure in FIGURES]) for i in (1, 2))
    return examples.once(
        _runs_key(periods, damping),
        lambda: histories(shaft.coefficients, eta, q, damping, periods, contact=shaft.contact),
    )


def _runs_key(periods: float, damping: float) -> Hashable:
    """Key of the result of ``runs``."""
    return "histories", periods, damping


def averages(examples: Examples, q: tuple[float, ...], eta_max: float = ETA_MAX, damping: float = 0.0) -> Averages:
    """Means of the first turn from rest in some rows of ``FIRST_TURN`` and ``ROWS``, which are computed together."""
    shaft, every, top = shaft_of(examples), sorted({*FIRST_TURN, *ROWS}), max(eta_max, ETA_MAX)
    result: Averages = examples.once(
        ("averages", top, damping), lambda: mean_wind_up(shaft.coefficients, every, etas(top), damping, shaft.contact)
    )
    rows, columns = np.isin(result.q, q), np.arange(etas(eta_max).size)
    selected = np.ix_(rows, columns)
    is_lost = None if result.is_contact_lost is None else result.is_contact_lost[selected]
    return replace(
        result,
        q=result.q[rows],
        eta=result.eta[columns],
        wind_up=result.wind_up[selected],
        slope=result.slope[selected],
        is_contact_lost=is_lost,
    )


def first_turn(examples: Examples) -> Averages:
    """Means of the first turn from rest up to η = 5."""
    return averages(examples, FIRST_TURN, 5.0)


def widths(tongues_of_row: Tongues) -> np.ndarray:
    """Widths of the tongues of the first row.

    Returns
    -------
    ndarray (n,), dimensionless
        Differences of η.
    """
    return np.asarray(tongues_of_row.edges[0, :, 1] - tongues_of_row.edges[0, :, 0])


# -- numbers of the claims ---------------------------------------------------------------------------------


def spring_growth(examples: Examples) -> Numbers:
    """Logarithm of the growth in a turn of β'' = ∓4π²η²β, the cam at rest: the real part of its root 2πη √∓1.

    References
    ----------
    Kim (1990), eq. (13).
    """
    eta = FIGURES[0][1]
    printed, corrected = (float(np.real(2.0 * pi * eta * np.emath.sqrt(sign))) for sign in (1.0, -1.0))
    return {"eta": eta, "printed": printed, "corrected": corrected}


def _with_psi(coefficients: Coefficients, psi: np.ndarray) -> Coefficients:
    """Coefficients with a given slope ψ of the load at the nodes of the panels."""
    values = coefficients.panels.values.copy()
    values[LOAD_SLOPE] = psi
    return replace(coefficients, panels=replace(coefficients.panels, values=values))


def _printed_psi(coefficients: Coefficients) -> np.ndarray:
    """ψ with X''X'' for X''X, X in units of X_m, as (22) is printed."""
    theta = coefficients.panels.theta
    sizes = 4.0 * np.cos(2.0 * theta) ** 2 + np.sin(2.0 * theta) ** 2
    return np.asarray(np.where(theta < pi, 2.0 * FACTOR * sizes, 0.0))


def readings(coefficients: Coefficients, eta: float, q: float) -> Mapping[str, bool]:
    """Whether a point of the chart is stable by each misprint, in the linear equation that contains it.

    The paper's 11 x 11 matrix is a further reading. The sign of (13) is not: with it every point is unstable.

    References
    ----------
    Kim (1990), eqs. (4), (13), (17), (19), (22), (27).
    """
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
        name: float(monodromy(_with_psi(coefficients, slope), np.array([eta]), np.array([value]), equation).growth[0])
        for name, (slope, value, equation) in printed.items()
    }
    tongue = (kim_edges(coefficients, q)[:, 0] < eta) & (eta < kim_edges(coefficients, q)[:, 1])
    return {**{name: rate <= TOLERANCE for name, rate in growth.items()}, "(27) with 11 x 11 terms": not tongue.any()}


def load_means(examples: Examples) -> Numbers:
    """Means of ψ with the printed X''X'' and corrected, and the traces of (22) with either at the point of Fig. 12.

    References
    ----------
    Kim (1990), eq. (22).
    """
    coefficients = shaft_of(examples).coefficients
    both = (_with_psi(coefficients, _printed_psi(coefficients)), coefficients)
    _, eta, q, _ = FIGURES[-1]
    traces = [float(monodromy(variant, np.array([eta]), np.array([q]), APPROXIMATE).trace[0]) for variant in both]
    means = [float((variant.panels.weights * variant.panels.values[LOAD_SLOPE]).sum()) for variant in both]
    return {
        "printed": means[0],
        "corrected": means[1],
        "trace_as_printed": traces[0],
        "trace": traces[1],
    }


def approximation(examples: Examples) -> Numbers:
    """Edges of the tongues by (22) and by (21).

    References
    ----------
    Kim (1990), eqs. (21), (22).
    """
    approximate, exact = (row(examples, Q, equation).edges[0] for equation in (APPROXIMATE, EXACT))
    return {"q": Q, "approximate": approximate, "exact": exact}


def at_q(examples: Examples) -> Numbers:
    """Widths of the tongues by (22), the equation of Fig. 8."""
    return {"q": Q, "widths": widths(row(examples, Q, APPROXIMATE))}


def at_q_in_both(examples: Examples) -> Numbers:
    """Widths of the tongues by (22) and by (21)."""
    return {**at_q(examples), "exact": widths(row(examples, Q, EXACT))}


def at_q_with_errors(examples: Examples) -> Numbers:
    """Widths of the tongues by (22), and the bounds of their errors."""
    return {**at_q(examples), "errors": 2.0 * row(examples, Q, APPROXIMATE).error[0]}


def growing(examples: Examples) -> Numbers:
    """Widths of the tongues by (22) at two values of Q."""
    small, large = (widths(row(examples, q, APPROXIMATE)) for q in (Q, TWICE))
    return {"q": np.array([Q, TWICE]), "small": small, "large": large}


def eleven(examples: Examples) -> Numbers:
    """Greater error of each tongue's two edges (11,) by the paper's matrix; infinite where it has no second edge.

    References
    ----------
    Kim (1990), §6 (2), eqs. (27), (32).
    """
    approximate = row(examples, Q, APPROXIMATE)
    off = np.abs(kim_edges(shaft_of(examples).coefficients, Q, COUNT) - approximate.edges[0]).max(axis=1)
    return {"q": Q, "off": np.where(np.isnan(off), np.inf, off), "widths": widths(approximate)}


def means(examples: Examples) -> Numbers:
    """Means of |β| and |β'| over the first turn (Figs. 6, 7)."""
    first = first_turn(examples)
    return {"q": first.q, "means": first.wind_up, "slopes": first.slope}


def losses(examples: Examples) -> Numbers:
    """Rows of Q in which the follower leaves the cam in the first turn, and its loss of contact in Figs. 9-12."""
    first = first_turn(examples)
    is_lost = np.zeros(first.q.size, dtype=bool) if first.is_contact_lost is None else first.is_contact_lost.any(axis=1)
    return {"q": first.q, "is_lost": is_lost, "later": [(h.eta, h.q, h.contact_lost) for h in runs(examples)]}


def point(number: int) -> Callable[[Examples], Numbers]:
    """Function that gives the verdicts at the point of one of Figs. 9-12."""
    index = [figure[0] for figure in FIGURES].index(number)
    _, eta, q, stable = FIGURES[index]

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
    """Error X(θ_c) - X(θ_i) of Fig. 9 relative to the stroke, and twist and torque K_s 2πβ of the shaft, from rest.

    References
    ----------
    Kim (1990), §1 and Fig. 9.
    """
    study, run = examples.study(EXAMPLE), runs(examples)[0]  # Fig. 12 is drawn together with it
    y = np.arange(3000) / 100.0
    beta = run.at(y)[0]
    actual, ideal = (
        study.at_theta(np.mod(2.0 * pi * turns, 2.0 * pi)).motion.displacement[0] for turns in (y - beta, y)
    )
    machine = shaft_of(examples).machine
    return {
        "stroke": float(np.abs(actual - ideal).max()) / shaft_of(examples).coefficients.sizes.stroke,
        "twist": float(np.abs(beta).max()),
        "torque": 2.0 * pi * machine.stiffness * float(np.abs(beta).max()),
    }


def later_turns(examples: Examples) -> Numbers:
    """Largest |β| of the histories of Figs. 9-12 over 30 turns, with their η and Q."""
    return {"points": tuple((run.eta, run.q, run.largest[0]) for run in runs(examples))}


def histories_and_chart(examples: Examples) -> Numbers:
    """State at the points of Figs. 9-12 by (22), the equation of the chart of Fig. 8, and by the history from rest."""
    coefficients = shaft_of(examples).coefficients
    points = []
    for (number, eta, q, _), run in zip(FIGURES, runs(examples), strict=True):
        verdict = linear_verdicts(coefficients, eta, q, models=(APPROXIMATE,))[0]
        points.append((number, verdict.state, rest_verdict(run).state))
    return {"points": tuple(points)}
