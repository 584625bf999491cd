"""What a claim of Kim1990 is worth, by numbers alone: each row a verdict and a sentence, a plain function of these numbers.

Arrays over tongues have the shape (11,) or (11, 2): n = 1 ... 11, which stand at η ≈ n/2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import exp

import numpy as np

from core.papers.claim import AGREES, METHOD, MISPRINT, Judgement, agreement, parted
from core.stability.hill.coefficients import APPROXIMATE, EXACT
from core.stability.model_comparison import FROM_REST, STABLE, STEADY, UNSTABLE, Verdict

ROUNDING = 1e-12
NEAR = 0.1  # of a tongue's own width: an edge that is off by no more is drawn where it stands
SMALL_ERROR = 0.01  # of the stroke: more than that spoils a motion
SMALL_Q, SMALL_WIND_UP = 0.1, 0.02
"""Kim1990 §6 (1): up to this Q the mean wind-up stays within so much, and the follower on the cam."""

Loss = tuple[float, float, float | None]
"""η, Q, and y at which the follower leaves the cam, None where it stays on it."""


def _eta(n: int) -> str:
    return f"{0.5 * n:g}"


def spring_sign(eta: float, printed: float, corrected: float) -> Judgement:
    """(13): growth of ln β a turn with the spring's term as printed and with its sign changed."""
    return parted(MISPRINT, printed > ROUNDING, corrected > ROUNDING), (
        f"+4π²η²β: as printed any shaft would run away, by {exp(printed):.3g} a turn at η = {eta:g}, "
        f"and by {exp(corrected):.3g} with the other sign"
    )


def load_slope(printed: float, corrected: float, trace_as_printed: float, trace: float) -> Judgement:
    """(22): mean of ψ over the turn as printed and with X''X for X''X'', and the traces of a turn at the point of Fig. 12."""
    words = {True: STABLE, False: UNSTABLE}
    return parted(MISPRINT, abs(printed) > ROUNDING, abs(corrected) > ROUNDING), (
        f"X''X + X'²: ψ is the slope of a periodic torque, so its mean is 0; as printed it is {printed:.3g}, and at the "
        f"point of Fig. 12 (22) is {words[abs(trace_as_printed) <= 2.0]}, trace {trace_as_printed:.4f}; corrected it is "
        f"{words[abs(trace) <= 2.0]}, {trace:.4f}"
    )


def approximation(q: float, approximate: np.ndarray, exact: np.ndarray) -> Judgement:
    """(21) → (22): edges (11, 2) of both; whether each two tongues have an η in common. If not, it is dropping D and C that parts them."""
    apart = 1 + np.flatnonzero((exact[:, 0] > approximate[:, 1]) | (approximate[:, 0] > exact[:, 1]))
    fixed, shift = ((edges.mean(axis=1) - 0.5 * np.arange(1, 12)) / q for edges in (approximate, exact))
    return AGREES if apart.size == 0 else METHOD, (
        f"D → 1 and C → 0 are not right to the first order in Q: the tongues of the exact form (21) move with it by "
        f"{shift[3]:.3f} Q for n = 4 and "
        f"{shift[10]:.3f} Q for n = 11, those of the approximation (22) stand still (n = 4: {fixed[3]:.3f} Q); "
        f"at Q = {q:g} they have nothing in common "
        f"for n = {', '.join(map(str, apart)) or 'none'}"
    )


def whole_numbers_only(q: float, widths: np.ndarray, errors: np.ndarray) -> Judgement:
    """Fig. 8: widths of the tongues, and what these may be wrong by (11,)."""
    open_ones = widths > errors
    between = [n for n in range(1, 12, 2) if open_ones[n - 1]]
    sizes = ", ".join(f"{widths[n - 1]:.4f} at {_eta(n)}" for n in between[:3]) or "none open between them"
    return agreement(open_ones[1::2].all() and not between), (
        f"at 2/N, η ≈ n/2: the dwell gives ψ odd harmonics; by the approximation (22), of which Fig. 8 is made, "
        f"widths at Q = {q:g}: {sizes}"
    )


def widest(q: float, widths: np.ndarray) -> Judgement:
    """Fig. 8: at η ≈ 1 and 2 stand n = 2 and 4: both must be wider than every other; widths (11,)."""
    order = np.argsort(-widths, kind="stable")[:4] + 1
    sizes = ", ".join(f"{_eta(n)} ({widths[n - 1]:.4f})" for n in order)
    named = ", ".join(f"{widths[n - 1]:.2g} at {_eta(n)}" for n in range(2, 9, 2))
    return agreement(widths[[1, 3]].min() > np.delete(widths, [1, 3]).max()), (
        f"by the approximation (22), of which Fig. 8 is made, the widest at Q = {q:g} stand at η ≈ {sizes}; "
        f"at the whole η alone, which the paper names, "
        f"{named}"
    )


def widen_with_q(q: np.ndarray, small: np.ndarray, large: np.ndarray) -> Judgement:
    """Fig. 8: widths (11,) at the smaller and the larger of two Q."""
    wider = large > small
    return agreement(wider.all()), (
        f"by the approximation (22), of which Fig. 8 is made, {int(wider.sum())} of {small.size} are wider at Q = {q[1]:g} than at {q[0]:g}"
    )


def widen_with_speed(q: float, widths: np.ndarray, exact: np.ndarray) -> Judgement:
    """Fig. 8: of the tongues at whole η, which the claim is about, each must be wider than the next; widths (11,) of (22) and of (21)."""
    whole = range(2, 11, 2)
    sizes, others = (", ".join(f"{each[n - 1]:.2e} at η ≈ {_eta(n)}" for n in whole) for each in (widths, exact))
    return agreement((np.diff(widths[1::2]) < 0.0).all()), (
        f"by the approximation (22), of which Fig. 8 is made, widths at Q = {q:g}: {sizes} (by the exact form (21): {others})"
    )


def eleven(q: float, off: np.ndarray, widths: np.ndarray) -> Judgement:
    """§6 (2): how far the edges of the 11 x 11 matrix are off, and the widths (11,); inf where it has no such edge."""
    good = off <= NEAR * widths
    poor = [int(i) for i in np.flatnonzero(~good)]
    far = [f"{off[i] / widths[i]:.2g} of it at {_eta(i + 1)}" for i in poor if np.isfinite(off[i])]
    lacking = [_eta(i + 1) for i in poor if np.isinf(off[i])]
    return agreement(good.all()), "; ".join(
        [f"at Q = {q:g} within {NEAR:g} of their own width for n = {', '.join(map(str, 1 + np.flatnonzero(good)))}"]
        + ([f"the edges of the approximation (22) are off by {', '.join(far)} (η)"] if far else [])
        + ([f"at η ≈ {', '.join(lacking)} the matrix has one edge only"] if lacking else [])
    )


def wind_up(q: np.ndarray, means: np.ndarray, slopes: np.ndarray) -> Judgement:
    """Figs. 6, 7: means of the first turn from rest (rows of Q, η)."""
    rising = (np.diff(means, axis=0) > 0.0).all() and (np.diff(slopes[:3], axis=0) > 0.0).all()
    largest = means[q <= SMALL_Q].max()
    return agreement(rising and largest <= SMALL_WIND_UP), (
        f"the mean of the first turn from rest is at most {largest:.4f} for η = 0.5 ... 5; later turns reach more (Figs. 9-12)"
    )


def contact(q: np.ndarray, lost: np.ndarray, later: Sequence[Loss]) -> Judgement:
    """Figs. 6, 7: q (rows,) in rising order, lost (rows,) in the first turn; later: through the turns of Figs. 9-12."""
    small = q <= SMALL_Q
    stays = not lost[small].any() and all(y is None for _, each, y in later if each <= SMALL_Q)
    points = [f"(η = {eta:.2f}, Q = {each:.2f}) from y = {y:.4f}" for eta, each, y in later if y is not None]
    least = f"Q = {q[lost][0]:g}" if lost.any() else "none of these Q"
    return agreement(stays and lost[~small].all()), (
        f"in the first turn, which these figures average, it leaves it from {least} on; later it does at "
        f"{' and at '.join(points) or 'none of the points of Figs. 9-12'} (its flight is not reckoned with the wind-up)"
    )


_SHORT: Mapping[str, str] = {
    APPROXIMATE: "approximate (22)",
    EXACT: "exact (21)",
    STEADY: "steady response",
    FROM_REST: "from rest",
}


def figure(stable: bool, models: Sequence[Verdict], rest: Verdict, readings: Mapping[str, bool]) -> Judgement:
    """Figs. 9-12, a point of the chart in every model; stable: in the paper; the last of models, the steady response, decides. Where no
    model says what the paper says, also whether a reading of its print does."""
    says = STABLE if stable else UNSTABLE
    each = "; ".join(
        f"{_SHORT[v.model]} {v.state}{_grown(v)}{_lost(v, 'it leaves the cam at', ' of each turn')}" for v in models
    )
    tried = ""
    if all(v.state != says for v in models):
        found = [name for name, kept in readings.items() if kept == stable]
        so = f"{' and '.join(found)} {'make' if len(found) > 1 else 'makes'} it so" if found else "makes it so"
        tried = f"; of {len(readings)} readings of the print {'' if found else 'none '}{so}: {', '.join(readings)}"
    return agreement(models[-1].state == says), (
        f"{each}; from rest max|β| = {rest.largest:.6f} in 30 turns{_lost(rest, 'follower off the cam from')}{tried}"
    )


def _grown(verdict: Verdict) -> str:
    return f", e^{verdict.growth:.3f} a turn" if verdict.state == UNSTABLE else ""


def _lost(verdict: Verdict, words: str, after: str = "") -> str:
    return "" if verdict.lost is None else f", {words} y = {verdict.lost:.4f}{after}"


def follower_error(stroke: float, twist: float, torque: float) -> Judgement:
    """§1: what the wind-up does to the follower (a part of its stroke) and to the shaft [N m]."""
    return agreement(stroke > SMALL_ERROR and torque > 0.0), (
        f"at the point of Fig. 9 the follower is off by {stroke:.3f} of its stroke, and the shaft bears up to "
        f"±{torque:.3g} N·m (twist {twist:.4f} turns)"
    )


def later_turns(points: Sequence[tuple[float, float, float]]) -> Judgement:
    """§6 (1): whether the wind-up of later turns stays as small as the mean of the first one."""
    words = ", ".join(f"{largest:.4f} at ({eta:.2f}, {q:.2f})" for eta, q, largest in points)
    return agreement(all(largest <= SMALL_WIND_UP for *_, largest in points)), (
        f"so small it is in the mean of the first turn alone; in 30 turns it reaches {words} (η, Q)"
    )


def histories_and_chart(found: Sequence[tuple[int, str, str]]) -> Judgement:
    """§6: whether histories from rest and the chart of (22) say the same of each point."""
    each = "; ".join(
        f"Fig. {number}: {chart} by the approximation (22), from rest {rest}" for number, chart, rest in found
    )
    return agreement(all(chart == rest for _, chart, rest in found)), each
