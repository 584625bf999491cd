"""What is drawn of a flexible shaft besides the chart, as plain data: whoever draws it needs nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.stability.coefficients import Coefficients
from core.stability.means import Averages
from core.stability.windup import History

DEGREES = np.linspace(0.0, 360.0, 721)
CAM_ANGLE = "Cam angle, °"
PER_TURN = 100  # samples of a history that is drawn
TERMS = (
    ("d", "inertia d"),
    ("C", "C"),
    ("U", "load U"),
    ("κ", "κ = C'"),
    ("ψ", "ψ = U'"),
)
"""Rows of ``Coefficients.panels`` as they are called in plots."""


@dataclass(frozen=True, eq=False)
class Curve:
    """y over x (n,), nan where there is nothing; curves of one ``row`` have one colour and one ``label`` in the legend."""

    x: np.ndarray
    y: np.ndarray
    label: str = ""
    row: int = 0
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Plot:
    """Curves with axes of their own; marks: places on the x axis with a text; note: what the legend adds."""

    across: str
    upwards: str
    curves: tuple[Curve, ...]
    marks: tuple[tuple[float, str], ...] = ()
    note: str = ""


@dataclass(frozen=True, eq=False)
class Figure:
    """Plots one below the other; ``name`` of its files, ``title`` above it."""

    name: str
    title: str
    plots: tuple[Plot, ...]


def coefficients_plot(coefficients: Coefficients, only: Sequence[str] = ("ψ", "d", "C", "U")) -> Plot:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ)."""
    values = coefficients.panels.at(np.deg2rad(DEGREES[:-1]), len(TERMS))
    rows = {short: (name, row) for (short, name), row in zip(TERMS, values, strict=True)}
    curves = tuple(
        Curve(DEGREES, np.append(rows[short][1], rows[short][1][0]), rows[short][0], i) for i, short in enumerate(only)
    )
    return Plot(CAM_ANGLE, "Terms", curves)


def averages_plots(found: Averages) -> tuple[Plot, Plot]:
    """Mean |β| and mean |β'| by η (Kim1990 Figs. 6, 7); dashed where the follower leaves the cam meanwhile."""
    note = "dashed: leaves the cam" if found.lost is not None and found.lost.any() else ""
    return (
        Plot("Frequency ratio η", "Mean |β|, turns", _by_contact(found, found.wind_up), note=note),
        Plot("Frequency ratio η", "Mean |dβ/dy|", _by_contact(found, found.slope), note=note),
    )


def _by_contact(found: Averages, means: np.ndarray) -> tuple[Curve, ...]:
    """Each row of Q solid where contact is kept, dashed where it is lost; the two meet halfway."""
    curves = []
    for number, (q, row) in enumerate(zip(found.q, means, strict=True)):
        lost = np.zeros(row.size, dtype=bool) if found.lost is None else found.lost[number]
        label = f"{q:.3g}" if number else f"Q = {q:.3g}"
        curves.append(Curve(found.eta, np.where(lost, np.nan, row), label, number))
        if lost.any():
            # with the neighbours, so that no piece of the curve is missing
            near = lost | np.append(lost[1:], False) | np.append(False, lost[:-1])
            curves.append(Curve(found.eta, np.where(near, row, np.nan), "", number, dashed=True))
    return tuple(curves)


def history_plot(gone: History) -> Plot:
    """The wind-up in time (Kim1990 Figs. 9 to 12); a mark where the follower leaves the cam."""
    y = np.linspace(0.0, gone.ended, round(gone.ended * PER_TURN) + 1)
    curve = Curve(y, gone.at(y)[0], f"η = {gone.eta:.4g}, Q = {gone.q:.4g}")
    return Plot("Turns of the input", "Twist β, turns", (curve,), contact_marks(gone))


def contact_marks(gone: History) -> tuple[tuple[float, str], ...]:
    return () if gone.contact_lost is None else ((gone.contact_lost, f"leaves the cam at {gone.contact_lost:.4g}"),)
