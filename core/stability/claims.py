"""What Kim1990 says of its cam against what comes out here, one row each, its numbers beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi
from typing import Any

import numpy as np

from core.errors import NoStability
from core.frozen import frozen
from core.stability import judgements
from core.stability.floquet import tongues
from core.stability.hill.coefficients import APPROXIMATE, EXACT, INERTIA, LOAD_SLOPE, RETUNED, Coefficients
from core.stability.hill.edges import Tongues
from core.stability.hill.matrices import kim_edges
from core.stability.judgements import AGREES, DIFFERS, MISPRINT
from core.stability.model_comparison import linear_verdicts, rest_verdict, steady_verdict
from core.stability.stage import Stability
from core.stability.steady_turn import steady_turn
from core.stability.windup import History, etas, histories, mean_wind_up

__all__ = ["AGREES", "DIFFERS", "FIGURES", "MISPRINT", "ROWS", "Claim", "claims", "require_kim"]

FACTOR = 1.5
SHAPE = 1e-9
SHARP = 1e-12  # wanted error of an edge: the narrowest tongue that is judged is 3e-7 wide
COUNT = 11
Q, TWICE = 0.05, 0.1
FIRST_TURN = (Q, TWICE, 0.2, 0.3, 0.4, 0.5)  # rows of Q in which the follower is watched through its first turn
ROWS = (0.05, 0.1, 0.2, 0.5, 1.0)
"""Kim1990 Figs. 6, 7: Q of their curves."""
FIGURES = ((9, 0.85, 0.10, True), (10, 0.90, 0.10, False), (11, 2.10, 0.05, True), (12, 2.00, 0.05, False))
"""Kim1990 Figs. 9-12: figure, η, Q, whether the paper calls it stable."""

Numbers = Mapping[str, Any]


@frozen(eq=False)
class Claim:
    """One statement of the paper.

    where, paper  the place and what stands there
    numbers       what was computed here: all that verdict and sentence depend on
    judge         plain function of these numbers
    """

    where: str
    paper: str
    numbers: Numbers
    judge: Callable[..., tuple[str, str]]

    @property
    def verdict(self) -> str:
        """Whether that is the same."""
        return self.judge(**self.numbers)[0]

    @property
    def here(self) -> str:
        """What comes out here, in words."""
        return self.judge(**self.numbers)[1]


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


def claims(shaft: Stability) -> tuple[Claim, ...]:
    """The table. Raises NoStability where the design is not Kim1990's."""
    require_kim(shaft.coefficients)
    exact, twice, approximate = _row(shaft, Q, EXACT), _row(shaft, TWICE, EXACT), _row(shaft, Q, APPROXIMATE)
    widths = _widths(exact)
    eta, q = (np.array([figure[i] for figure in FIGURES]) for i in (1, 2))
    later = histories(shaft.coefficients, eta, q, contact=shaft.contact)
    first = mean_wind_up(shaft.coefficients, FIRST_TURN, etas(5.0), contact=shaft.contact)
    lost = np.zeros(first.q.size, dtype=bool) if first.lost is None else first.lost.any(axis=1)
    edges = {"q": Q, "approximate": approximate.edges[0], "exact": exact.edges[0]}
    at_q = {"q": Q, "widths": widths}
    growing = {"q": np.array([Q, TWICE]), "small": widths, "large": _widths(twice)}
    off = {"q": Q, "off": _off(shaft, approximate), "widths": _widths(approximate)}
    means = {"q": first.q, "means": first.wind_up, "slopes": first.slope}
    losses = {"q": first.q, "lost": lost, "later": [(h.eta, h.q, h.contact_lost) for h in later]}
    whole = "parametric resonance at 1/N of the shaft's frequency: η ≈ 1, 2, 3, 4, 5"
    small = "for Q up to 0.1 the mean wind-up stays within 0.02; it grows with Q"
    j = judgements
    return (
        Claim("(13)", "the spring's term is -4π²η²β", _spring_growth(FIGURES[0][1]), j.spring_sign),
        Claim("(22)", "ψ holds X''X'' + X'²", _load_means(shaft), j.load_slope),
        Claim("(21) → (22)", "(22) stands for (21) where Q ≪ 1", edges, j.approximation),
        Claim("Fig. 8, §7", whole, {**at_q, "errors": 2.0 * exact.error[0]}, j.whole_numbers_only),
        Claim("Fig. 8", "the tongues at η ≈ 1 and 2 are much wider than the others", at_q, j.widest),
        Claim("Fig. 8, §7", "tongues widen with Q", growing, j.widen_with_q),
        Claim("Fig. 8, §7", "tongues widen towards the natural frequency (small η)", at_q, j.widen_with_speed),
        Claim("§6 (2)", "ten harmonics, an 11 x 11 matrix, give the edges", off, j.eleven),
        Claim("Figs. 6, 7", small, means, j.wind_up),
        Claim("Figs. 6, 7", "the follower stays on the cam for Q below 0.1 and leaves it above", losses, j.contact),
        *(_figure(shaft, *row) for row in zip(FIGURES, later, strict=True)),
    )


def _row(shaft: Stability, q: float, equation: str) -> Tongues:
    return tongues(shaft.coefficients, np.array([q]), COUNT, equation, error=SHARP)


def _widths(row: Tongues) -> np.ndarray:
    return np.asarray(row.edges[0, :, 1] - row.edges[0, :, 0])


def _spring_growth(eta: float) -> Numbers:
    """ln of the growth a turn of β'' = ∓4π²η²β, the cam at rest: the real part of its root 2πη √∓1."""
    as_printed, corrected = (float(np.real(2.0 * pi * eta * np.emath.sqrt(sign))) for sign in (1.0, -1.0))
    return {"eta": eta, "printed": as_printed, "corrected": corrected}


def _load_means(shaft: Stability) -> Numbers:
    """The mean over the turn of ψ, with X''X'' in it (X in units of X_m, as in (22)) and of the ψ that is used."""
    panels = shaft.coefficients.panels
    theta = panels.theta
    c = np.cos(2.0 * theta)
    as_printed = np.where(theta < pi, 2.0 * FACTOR * (4.0 * c * c + np.sin(2.0 * theta) ** 2), 0.0)
    return {
        "printed": float((panels.weights * as_printed).sum()),
        "corrected": float((panels.weights * panels.values[LOAD_SLOPE]).sum()),
    }


def _off(shaft: Stability, approximate: Tongues) -> np.ndarray:
    """The farther of each tongue's two edges (11,) in the paper's own matrix; inf where it has no second edge."""
    off = np.abs(kim_edges(shaft.coefficients, Q, COUNT) - approximate.edges[0]).max(axis=1)
    return np.where(np.isnan(off), np.inf, off)


def _figure(shaft: Stability, figure: tuple[int, float, float, bool], run: History) -> Claim:
    number, eta, q, stable = figure
    models = (
        *linear_verdicts(shaft.coefficients, eta, q),
        steady_verdict(steady_turn(shaft.coefficients, eta, q, contact=shaft.contact)),
    )
    return Claim(
        f"Fig. {number}",
        f"η = {eta:.2f}, Q = {q:.2f} is {'stable' if stable else 'unstable'}",
        {"stable": stable, "models": models, "rest": rest_verdict(run)},
        judgements.figure,
    )
