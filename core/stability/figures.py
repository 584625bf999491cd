"""What is drawn of a flexible shaft, its chart and other plots, as plain data that a painter needs nothing beside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.design import UNITS
from core.frozen import frozen
from core.plot import Plot, PlotCurve
from core.stability.critical_speeds import Machine
from core.stability.floquet import tongues
from core.stability.hill.coefficients import APPROXIMATE, EXACT, LOAD_SLOPE, Coefficients
from core.stability.hill.edges import EDGE_ERROR, ETA_MAX, Tongues, count_up_to, harmonic_tongues
from core.stability.steady_turn import SteadyTurn, sum_of
from core.stability.windup import Averages, History

DEGREES = np.linspace(0.0, 360.0, 721)
CAM_ANGLE = "Cam angle, °"
ROUNDING = 1e-9  # of a torque's amplitude: a mean below it is rounding
PER_TURN = 100  # samples of a history that is drawn
TERMS = (
    ("d", "inertia d"),
    ("C", "C"),
    ("U", "load U"),
    ("κ", "κ = C'"),
    ("ψ", "ψ = U'"),
)
"""Rows of ``Coefficients.panels`` as they are called in plots."""


def coefficients_plot(coefficients: Coefficients, only: Sequence[str] = ("ψ", "d", "C", "U")) -> Plot:
    """What the equation is made of by cam angle (Kim1990 Fig. 5 is ψ)."""
    values = coefficients.panels.at(np.deg2rad(DEGREES[:-1]), len(TERMS))
    rows = {short: (name, row) for (short, name), row in zip(TERMS, values, strict=True)}
    curves = tuple(
        PlotCurve(DEGREES, np.append(rows[short][1], rows[short][1][0]), rows[short][0], i)
        for i, short in enumerate(only)
    )
    return Plot(CAM_ANGLE, "Terms", curves)


def averages_plots(averages: Averages) -> tuple[Plot, Plot]:
    """Mean |β| and mean |β'| by η (Kim1990 Figs. 6, 7); dashed where the follower leaves the cam meanwhile."""
    note = "dashed: leaves the cam" if averages.lost is not None and averages.lost.any() else ""
    return (
        Plot("Frequency ratio η", "Mean |β|, turns", _by_contact(averages, averages.wind_up), note=note),
        Plot("Frequency ratio η", "Mean |dβ/dy|", _by_contact(averages, averages.slope), note=note),
    )


def _by_contact(averages: Averages, means: np.ndarray) -> tuple[PlotCurve, ...]:
    """Each row of Q solid where contact is kept, dashed where it is lost; the two meet halfway."""
    curves = []
    for number, (q, row) in enumerate(zip(averages.q, means, strict=True)):
        lost = np.zeros(row.size, dtype=bool) if averages.lost is None else averages.lost[number]
        label = f"{q:.3g}" if number else f"Q = {q:.3g}"
        curves.append(PlotCurve(averages.eta, np.where(lost, np.nan, row), label, number))
        if lost.any():
            # with the neighbours, so that no piece of the curve is missing
            near = lost | np.append(lost[1:], False) | np.append(False, lost[:-1])
            curves.append(PlotCurve(averages.eta, np.where(near, row, np.nan), "", number, dashed=True))
    return tuple(curves)


def history_plot(run: History) -> Plot:
    """The wind-up in time (Kim1990 Figs. 9 to 12); a mark where the follower leaves the cam."""
    y = np.linspace(0.0, run.ended, round(run.ended * PER_TURN) + 1)
    curve = PlotCurve(y, run.at(y)[0], f"η = {run.eta:.4g}, Q = {run.q:.4g}")
    return Plot("Turns of the input", "Twist β, turns", (curve,), contact_marks(run))


INPUT_ANGLE = "Input angle, °"
MODELS = (
    ("steady", "true steady response", 0, False),
    (EXACT, "linear, exact (21)", 1, True),
    (APPROXIMATE, "linear, approximate (22), (27)", 2, True),
)


def steady_plots(turn: SteadyTurn) -> tuple[Plot, ...]:
    """The steady response over a turn of the input: wind-up beside that of the linear forced responses, with the torque in the shaft;
    and each unit's followers' errors."""
    theta = np.deg2rad(DEGREES)
    made = {"steady": np.rad2deg(turn.wind_up(theta))} | {n: 360.0 * sum_of(c, theta) for n, c in turn.linear().items()}
    curves = tuple(
        PlotCurve(DEGREES, made[n], label, row, dashed)
        for n, label, row, dashed in MODELS
        if np.isfinite(made[n]).all()
    )
    mean = 0.0 if abs(turn.mean_torque) < ROUNDING * turn.torque_amplitude else turn.mean_torque
    note = f"torque in the shaft {mean:.3g} ± {turn.torque_amplitude:.3g} N·m"
    plots = [Plot(INPUT_ANGLE, "Wind-up, °", curves, note=note)]
    for unit in dict.fromkeys(each.unit for each in turn.followers):
        rows = [(i, each) for i, each in enumerate(turn.followers) if each.unit == unit]
        errors = tuple(PlotCurve(DEGREES, turn.error(theta, i) / UNITS[unit].factor, each.name, i) for i, each in rows)
        plots.append(Plot(INPUT_ANGLE, f"Follower's error, {UNITS[unit].symbol}", errors))
    return tuple(plots)


def harmonics_plot(turn: SteadyTurn) -> Plot:
    """Amplitudes of the wind-up's harmonics, the true ones as bars, beside those of the linear forced responses (Kim1990 (27), γ = 0)."""
    numbers = np.arange(1, turn.highest + 1)
    made = {"steady": turn.harmonics()} | dict(turn.linear())
    curves = []
    for name, label, row, _ in MODELS:
        size = 720.0 * np.abs(made[name][1:])
        if np.isfinite(size).all():
            place = numbers + 0.24 * (row - 1)  # beside each other
            x, y = np.repeat(place, 3), np.column_stack((0.0 * size, size, np.full(size.size, np.nan))).ravel()
            x, y = (
                np.append(x, (0.4, turn.highest + 0.6)),
                np.append(y, (np.nan, np.nan)),
            )  # room at both ends of the axis
            curves.append(PlotCurve(x, y, label, row, False))
    return Plot("Harmonic, × shaft speed", "Wind-up, °", tuple(curves))


def contact_marks(run: History) -> tuple[tuple[float, str], ...]:
    """Where a follower leaves its cam [turns], with a text; empty where none does."""
    if run.contact_lost is None:
        return ()
    who = f"{run.leaving} leaves its cam" if run.leaving else "leaves the cam"
    return ((run.contact_lost, f"{who} at {run.contact_lost:.4g}"),)


# -- the chart ---------------------------------------------------------------------------------------------

ROWS = 64
COARSE_ORDER = 32  # harmonics of a first picture
MOST_Q = 0.12  # of the chart of a machine of small Q (Kim1990 Fig. 8 goes to 0.1)
ROOM = 1.6  # above the machine's own Q


@frozen(eq=False)
class Chart:
    """Tongues over a range of Q, as edges.

    name         of the design
    q            (rows,) rising
    tongues      equation -> its tongues in all rows; edges (rows, n, 2), nan where damping has closed them
    eta_max      the η axis goes from 0 to here
    machine      None where the chart belongs to no machine; else its operating point is (``machine.eta``, ``machine.q``)
                 and it runs up along Q = ``machine.q`` from η = ∞
    marked       rows of Q that were requested
    """

    name: str
    q: np.ndarray
    tongues: dict[str, Tongues]
    eta_max: float
    machine: Machine | None
    marked: tuple[float, ...] = ()

    def outline(self, n: int, equation: str = EXACT) -> list[np.ndarray]:
        """Tongue n as closed polygons (k, 2) of (η, Q), one for each stretch of Q in which it is open; without damping the
        first starts at its tip, η = n/2 at Q = 0."""
        edges = self.tongues[equation].edges[:, n - 1]
        open_rows = np.isfinite(edges).all(axis=1)
        runs = np.split(np.arange(self.q.size), np.flatnonzero(np.diff(open_rows.astype(int))) + 1)
        drawn = []
        for run in runs:
            if not open_rows[run[0]]:
                continue
            left = np.column_stack((edges[run, 0], self.q[run]))
            right = np.column_stack((edges[run, 1], self.q[run]))[::-1]
            parts = [left, right]
            if run[0] == 0 and self.tongues[equation].damping == 0.0:
                parts.insert(0, np.array([[0.5 * n, 0.0]]))
            drawn.append(np.concatenate(parts))
        return drawn


def _top(coefficients: Coefficients, machine: Machine | None, marked: Sequence[float]) -> float:
    """How far the chart goes in Q: above the machine and the marked rows, but no farther than these where a fixed load
    would be stiffer than the shaft, 1 + Qψ1 < 0."""
    own = (machine.q,) if machine is not None else ()
    top = max((MOST_Q, *(ROOM * q for q in own), *(1.1 * q for q in marked)))
    softest = -float(coefficients.panels.values[LOAD_SLOPE].min()) if coefficients.fixed else 0.0
    return min(top, max((1.0 / softest, *own, *marked))) if softest > 0.0 else top


def chart(
    coefficients: Coefficients,
    machine: Machine | None,
    name: str = "",
    eta_max: float = ETA_MAX,
    rows: int = ROWS,
    damping: float = 0.0,
    marked: Sequence[float] = (),
    error: float = EDGE_ERROR,
    coarse: bool = False,
) -> Chart:
    """The chart of a machine: ``rows`` of Q from 0 to well above the machine's own.

    coarse: without damping and with few harmonics, however far from ``error`` that is: a first picture, at once.
    """
    q = _top(coefficients, machine, marked) * np.arange(1, rows + 1) / rows
    count = count_up_to(eta_max)
    if coarse:
        by_equation = {
            e: harmonic_tongues(coefficients, q, count, e, error, COARSE_ORDER) for e in (EXACT, APPROXIMATE)
        }
    else:
        by_equation = {e: tongues(coefficients, q, count, e, damping, error) for e in (EXACT, APPROXIMATE)}
    return Chart(name, q, by_equation, eta_max, machine, tuple(marked))
