"""What is known of a flexible shaft as tables and sentences: tongues, histories, means, coefficients, the paper's claims."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from textwrap import wrap

import numpy as np

from core.output.export import TONGUES, csv, tongues_table
from core.stability import (
    EQUATIONS,
    Averages,
    Claim,
    Curve,
    History,
    Plot,
    Stability,
    Stiffness,
    count_up_to,
    tongues,
)
from core.stability.figures import CAM_ANGLE
from core.study import Study

SAMPLES_PER_TURN = 100
COEFFICIENT_ROWS = 720
LINE = 108  # characters of a claim's line
HARD_SPACE = "\N{NO-BREAK SPACE}"


def tables(
    found: Stability, q: np.ndarray, gone: Sequence[History], means: Averages, eta_max: float
) -> dict[str, str | bytes]:
    """File name -> text of the tables of a flexible shaft: tongues of the rows q, histories, means, coefficients."""
    count, damping = count_up_to(eta_max), found.machine.damping
    return {
        TONGUES: tongues_table([tongues(found.coefficients, q, count, e, damping, error=1e-11) for e in EQUATIONS]),
        "windup.csv": windup_table(gone),
        "windup_averages.csv": averages_table(means),
        "coefficients.csv": coefficients_table(found),
    }


def windup_table(gone: Sequence[History]) -> str:
    """Histories from rest, one below the other: time in turns of the input, wind-up β and its slope β', contact force as a
    multiple of M X''m ω² where there is a cam."""
    parts = []
    for each in gone:
        y = np.arange(int(each.ended * SAMPLES_PER_TURN) + 1) / SAMPLES_PER_TURN
        beta, slope = each.at(y)
        parts.append([np.full(y.size, each.eta), np.full(y.size, each.q), y, beta, slope, each.force(y)])
    names = ["eta", "q", "input_turns", "wind_up", "wind_up_slope", "contact_force_ratio"]
    table = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return csv(*((names[:-1], table[:-1]) if gone[0].contact is None else (names, table)))


def averages_table(means: Averages) -> str:
    """Means of |β| and |β'| by η (Kim1990 Figs. 6, 7), and 1 where the follower leaves the cam within the turn; what cannot
    be followed is left out."""
    there = np.isfinite(means.wind_up).ravel()
    columns = [
        np.repeat(means.q, means.eta.size),
        np.tile(means.eta, means.q.size),
        means.wind_up.ravel(),
        means.slope.ravel(),
    ]
    names = ["q", "eta", "mean_wind_up", "mean_wind_up_slope"]
    if means.lost is not None:
        names.append("leaves_cam")
        columns.append(means.lost.ravel().astype(float))
    return csv(names, [column[there] for column in columns])


def coefficients_table(found: Stability) -> str:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ): inertia share d, C, U, κ, ψ."""
    degrees = 360.0 * np.arange(COEFFICIENT_ROWS) / COEFFICIENT_ROWS
    rows = found.coefficients.panels.at(np.deg2rad(degrees), 5)
    return csv(["cam_angle_deg", "inertia", "centripetal", "load", "curvature", "psi"], [degrees, *rows])


def claims_text(told: Sequence[Claim]) -> str:
    """Kim1990's claims against ours, and how many agree."""
    head = "Kim, Jeon, Lee and Park 1990: what the paper says, and what comes out here"
    lines = [head, "=" * len(head)]
    for claim in told:
        lines += ["", f"{claim.where}: {claim.verdict}"]
        for who, said in (("the paper", claim.paper), ("here", claim.here)):
            start = f"    {who + ':':<11}"
            kept = said.replace(" = ", f"{HARD_SPACE}={HARD_SPACE}")
            rows = wrap(kept, LINE, initial_indent=start, subsequent_indent=" " * len(start))
            lines += [row.replace(HARD_SPACE, " ") for row in rows]
    counts = Counter(claim.verdict for claim in told)
    return "\n".join([*lines, "", ", ".join(f"{verdict}: {counts[verdict]}" for verdict in sorted(counts))]) + "\n"


def profile_plot(study: Study, found: Stability) -> Plot:
    """Displacement, velocity and acceleration by cam angle, each relative to its largest (Kim1990 Fig. 4)."""
    degrees, *rows = _profile(study, found)
    names = ("displacement X", "velocity X'", "acceleration X''")
    return Plot(CAM_ANGLE, "Relative to the largest", tuple(
        Curve(degrees, row, name, i) for i, (row, name) in enumerate(zip(rows, names, strict=True))
    ))  # fmt: skip


def profile_table(study: Study, found: Stability) -> str:
    return csv(["cam_angle_deg", "displacement", "velocity", "acceleration"], _profile(study, found))


def _profile(study: Study, found: Stability) -> list[np.ndarray]:
    sizes, y = found.coefficients.sizes, study.motion.y
    parts = (y[0] - sizes.lowest) / sizes.stroke, y[1] / sizes.slope, y[2] / sizes.curvature
    return [study.angle_degrees, *parts]


def needed_text(needed: Stiffness) -> str:
    """What a wanted speed asks of the shaft, in one line."""
    if needed.allowed:
        return f"At {needed.rpm:.6g} rpm the present {needed.now:.6g} N·m/rad keeps clear of every forbidden band."
    softer = "" if needed.softer is None else f" or at most {needed.softer:.6g}"
    where = "in" if needed.inside else "too near"
    return (
        f"At {needed.rpm:.6g} rpm the shaft needs at least {needed.stiffer:.6g} N·m/rad{softer}; "
        f"the present {needed.now:.6g} stands {where} a forbidden band."
    )
