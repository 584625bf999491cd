"""What Kim1990 says of its cam against what comes out here, one row each; where they differ, why."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp, pi

import numpy as np

from core.errors import NoStability
from core.stability import paper
from core.stability.coefficients import INERTIA, LOAD_SLOPE, RETUNED, Coefficients
from core.stability.edges import tongues
from core.stability.equations import APPROXIMATE, EXACT
from core.stability.means import Averages, mean_wind_up
from core.stability.stage import Stability
from core.stability.tongues import Tongues
from core.stability.verdicts import FROM_REST, STEADY, Verdict, linear_verdicts, rest_verdict, steady_verdict
from core.stability.windup import History, histories

AGREES, DIFFERS, MISPRINT = "agrees", "differs", "misprint"
FACTOR = 1.5
SHAPE = 1e-9
Q, TWICE = 0.05, 0.1
FIRST_TURN = (Q, TWICE, 0.2, 0.3, 0.4, 0.5)  # rows of Q in which the follower is watched through its first turn
ROWS = (0.05, 0.1, 0.2, 0.5, 1.0)
"""Kim1990 Figs. 6, 7: Q of their curves."""
FIGURES = ((9, 0.85, 0.10, True), (10, 0.90, 0.10, False), (11, 2.10, 0.05, True), (12, 2.00, 0.05, False))
"""Kim1990 Figs. 9-12: figure, η, Q, whether the paper calls it stable."""


@dataclass(frozen=True)
class Claim:
    """where it stands, what the paper says, what comes out here, and whether that is the same."""

    where: str
    paper: str
    here: str
    verdict: str


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


def claims(found: Stability) -> tuple[Claim, ...]:
    """The table. Raises NoStability where the design is not Kim1990's."""
    require_kim(found.coefficients)
    rows: list[Callable[[Stability], Claim]] = [
        _spring_sign, _second_derivative, _approximation, _halves, _widest, _grows, _eleven,
    ]  # fmt: skip
    told = [row(found) for row in rows]
    eta, q = (np.array([figure[i] for figure in FIGURES]) for i in (1, 2))
    gone = histories(found.coefficients, eta, q, contact=found.contact)
    first = mean_wind_up(found.coefficients, FIRST_TURN, 5.0, contact=found.contact)
    return (
        *told,
        _wind_up(first),
        _contact(first, gone),
        *(_figure(found, *row) for row in zip(FIGURES, gone, strict=True)),
    )


def _row(found: Stability, q: float, equation: str = EXACT, count: int = 11) -> Tongues:
    return tongues(found.coefficients, np.array([q]), count, equation)


def _widths(row: Tongues) -> np.ndarray:
    return row.edges[0, :, 1] - row.edges[0, :, 0]


def _spring_sign(found: Stability) -> Claim:
    eta = FIGURES[0][1]
    return Claim(
        "(13)",
        "the spring's term is -4π²η²β",
        f"+4π²η²β: as printed any shaft would run away, by {exp(2.0 * pi * eta):.3g} a turn at η = {eta:g}",
        MISPRINT,
    )


def _second_derivative(found: Stability) -> Claim:
    theta = np.linspace(0.0, pi, 2001)[:-1]
    c = np.cos(2.0 * theta)
    printed = FACTOR * 2.0 * (4.0 * c * c + np.sin(2.0 * theta) ** 2)  # with X''X''
    return Claim(
        "(22)",
        "ψ holds X''X'' + X'²",
        f"X''X + X'²: ψ is the slope of a periodic torque, so its mean is 0; as printed it is {0.5 * printed.mean():.3g}",
        MISPRINT,
    )


def _approximation(found: Stability) -> Claim:
    edges = [_row(found, Q, e).edges[0] for e in (APPROXIMATE, EXACT)]
    still, shift = ((e.mean(axis=1) - 0.5 * np.arange(1, 12)) / Q for e in edges)
    apart = 1 + int((edges[1][:, 0] > edges[0][:, 1]).argmax())
    return Claim(
        "(21) → (22)",
        "(22) stands for (21) where Q ≪ 1",
        f"the tongues of (21) move with Q in the first order, by {shift[3]:.3f} Q for n = 4 and {shift[10]:.3f} Q for n = 11; "
        f"those of (22) stand still (n = 4: {still[3]:.3f} Q); at Q = {Q} they have nothing in common from n = {apart} on",
        DIFFERS,
    )


def _halves(found: Stability) -> Claim:
    widths = _widths(_row(found, Q))
    told = ", ".join(f"{widths[n - 1]:.4f} at {0.5 * n:g}" for n in (1, 3, 5))
    return Claim(
        "Fig. 8, §7",
        "parametric resonance at 1/N of the shaft's frequency: η ≈ 1, 2, 3, 4, 5",
        f"at 2/N, η ≈ n/2: the dwell gives ψ odd harmonics; widths at Q = {Q}: {told}",
        DIFFERS,
    )


def _widest(found: Stability) -> Claim:
    both = {e: _widths(_row(found, Q, e)) for e in (APPROXIMATE, EXACT)}
    order = np.argsort(-both[EXACT])[:4]
    told = ", ".join(f"{0.5 * (n + 1):g} ({both[EXACT][n]:.4f})" for n in order)
    return Claim(
        "Fig. 8",
        "the tongues at η ≈ 1 and 2 are much wider than the others",
        f"of whole η, yes; of all, the widest in (21) stand at η ≈ {told}",
        AGREES,
    )


def _grows(found: Stability) -> Claim:
    small, large = _widths(_row(found, Q)), _widths(_row(found, TWICE))
    growing = int((large > small).sum())
    return Claim(
        "Fig. 8, §7",
        "tongues widen with Q, and towards the natural frequency (small η)",
        f"{growing} of 11 are wider at Q = {TWICE} than at {Q}; widths at {Q} fall from {small[1]:.4f} (η ≈ 1) to "
        f"{small[9]:.0e} (η ≈ 5)",
        AGREES if growing == 11 else DIFFERS,
    )


def _eleven(found: Stability) -> Claim:
    exact = tongues(found.coefficients, np.array([Q]), 5, APPROXIMATE, error=1e-12)
    off = float(np.abs(paper.edges(found.coefficients, Q, 5) - exact.edges[0]).max())
    return Claim(
        "§6 (2)",
        "ten harmonics, an 11 x 11 matrix, give the edges",
        f"to {off:.0e} for the tongues up to η ≈ 2.5",
        AGREES,
    )


def _wind_up(first: Averages) -> Claim:
    small = first.wind_up[first.q <= TWICE]
    rising = bool((np.diff(first.wind_up[:3], axis=0) > 0.0).all() and (np.diff(first.slope[:3], axis=0) > 0.0).all())
    return Claim(
        "Figs. 6, 7",
        "for Q up to 0.1 the mean wind-up stays within 0.02; it grows with Q",
        f"the mean of the first turn from rest is at most {small.max():.4f} for η = 0.5 ... 5; later turns reach more "
        "(Figs. 9-12)",
        AGREES if small.max() <= 0.02 and rising else DIFFERS,
    )


def _contact(first: Averages, gone: Sequence[History]) -> Claim:
    """first: rows of Q, from the paper's on upwards."""
    told = [
        f"(η = {h.eta:.2f}, Q = {h.q:.2f}) from y = {h.contact_lost:.4f}" for h in gone if h.contact_lost is not None
    ]
    leaves = first.q[first.lost.any(axis=1)] if first.lost is not None else first.q[:0]
    least = f"Q = {leaves[0]:g}" if leaves.size else "no Q looked at"
    return Claim(
        "Figs. 6, 7",
        "the follower stays on the cam for Q below 0.1 and leaves it above",
        f"in the first turn, which these figures average, it leaves it from {least} on; later it does at "
        f"{' and at '.join(told) or 'none of the points of Figs. 9-12'}",
        DIFFERS if told or leaves.min(initial=np.inf) > 1.5 * TWICE else AGREES,
    )


def _figure(found: Stability, figure: tuple[int, float, float, bool], gone: History) -> Claim:
    number, eta, q, stable = figure
    verdicts = [
        *linear_verdicts(found.coefficients, eta, q),
        steady_verdict(found.coefficients, eta, q, contact=found.contact)[0],
    ]
    rest = rest_verdict(gone)
    told = "; ".join(_told(v) for v in verdicts)
    lost = "" if rest.lost is None else f", follower off the cam from y = {rest.lost:.4f}"
    return Claim(
        f"Fig. {number}",
        f"η = {eta:.2f}, Q = {q:.2f} is {'stable' if stable else 'unstable'}",
        f"{told}; from rest max|β| = {rest.largest:.6f} in 30 turns{lost}",
        AGREES if verdicts[-1].stable == stable else DIFFERS,
    )


_SHORT = {APPROXIMATE: "(22)", EXACT: "(21)", STEADY: "steady response", FROM_REST: "from rest"}


def _told(verdict: Verdict) -> str:
    said = {True: "stable", False: f"unstable, e^{verdict.growth:.3f} a turn", None: "cannot say"}[verdict.stable]
    return f"{_SHORT[verdict.model]} {said}"
