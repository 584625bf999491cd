"""A flexible camshaft as files: its tables and report, its chart and other figures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.design import UNITS
from core.output.export import TONGUES, csv, table, texts, tongues_table
from core.output.report import report
from core.output.summary import summary, to_json
from core.stability import (
    EQUATIONS,
    ETA_MAX,
    Averages,
    Chart,
    Figure,
    History,
    Stability,
    SteadyTurn,
    Stiffness,
    averages_plots,
    chart,
    coefficients_plot,
    count_up_to,
    harmonics_plot,
    histories,
    history_plot,
    steady_plots,
    tongues,
)
from core.stability.tables import averages_columns, coefficients_columns, windup_columns
from core.study import Camshaft, Study
from core.study.quantities import ORBIT

UNSEEN = 1e-5  # of η: an edge that is off by less is not seen in a picture


def stability_files(
    study: Study,
    shaft: Stability,
    q: Sequence[float] = (),
    at: Sequence[tuple[float, float]] = (),
    periods: float = 30.0,
    eta_max: float | None = None,
) -> tuple[dict[str, str | bytes], tuple[Chart | Figure, ...]]:
    """File name -> content of the tables and texts of a flexible shaft, and what is to be painted beside them.

    q        rows of the tables; empty: the machine's own
    at       points (η, Q) of the histories from rest, through ``periods`` turns; empty: the machine's own
    eta_max  of the tables and the chart; None: 5.6, of the chart as far as shows the machine
    """
    machine, title = shaft.machine, study.design.name
    runs = followed(shaft, at or [(machine.eta, machine.q)], periods)
    means = shaft.averages(q, eta_max or ETA_MAX)
    made: dict[str, str | bytes] = {
        **tables(shaft, np.array(q or [machine.q]), runs, means, eta_max or ETA_MAX),
        **steady_tables(study, shaft),
        "report.txt": report(study),
        "summary.json": to_json(summary(study)),
    }
    return made, (
        machine_chart(shaft, title, q, eta_max),
        Figure("coefficients", title, (coefficients_plot(shaft.coefficients),)),
        Figure("windup_averages", title, averages_plots(means)),
        Figure("windup", title, tuple(history_plot(each) for each in runs)),
        *_steady_figures(title, shaft.steady_turn),
    )


def machine_chart(shaft: Stability, title: str, q: Sequence[float] = (), eta_max: float | None = None) -> Chart:
    """The chart with the machine's place; q: rows to be marked; eta_max: None as far as shows the machine."""
    top = eta_max or shaft.eta_max
    return chart(
        shaft.coefficients, shaft.machine, title, eta_max=top, damping=shaft.machine.damping, marked=q, error=UNSEEN
    )


def followed(shaft: Stability, points: Sequence[tuple[float, float]], periods: float) -> tuple[History, ...]:
    """The wind-up from rest at points (η, Q) of the chart, over so many periods."""
    eta, q = np.array(points).T
    return histories(shaft.coefficients, eta, q, shaft.machine.damping, periods, contact=shaft.contact)


# -- the steady response -----------------------------------------------------------------------------------


def steady_tables(study: Study, shaft: Stability) -> dict[str, str | bytes]:
    """File name -> text of the machine's own steady response; none where there is none."""
    turn = shaft.steady_turn
    if turn is None:
        return {}
    if study.design.listed:
        made = {ORBIT: orbit_table(study.camshaft, turn)}
    else:
        parts = table(study, ORBIT, ("stability",))
        made = {} if parts is None else texts({ORBIT: parts})
    return {**made, "harmonics.csv": harmonics_table(turn)}


def _steady_figures(title: str, turn: SteadyTurn | None) -> tuple[Figure, ...]:
    return () if turn is None else (Figure("steady", title, (*steady_plots(turn), harmonics_plot(turn))),)


def orbit_table(camshaft: Camshaft[Study], turn: SteadyTurn) -> str:
    """Wind-up and torque of a shaft of several drives by the angle of its input, which is the machine's, and each follower's error."""
    degrees = camshaft.angle_degrees
    theta = np.deg2rad(degrees)
    names = [f"{camshaft.slugs[each.name]}_follower_error_{each.unit}" for each in turn.followers]
    errors = [turn.error(theta, i) / UNITS[each.unit].factor + 0.0 for i, each in enumerate(turn.followers)]
    wind_up = turn.wind_up(theta)
    return csv(
        ["input_angle_deg", "wind_up_deg", *names, "shaft_torque_nm"],
        [degrees, np.rad2deg(wind_up), *errors, turn.torque(theta)],
    )


def harmonics_table(turn: SteadyTurn) -> str:
    """Amplitudes and phases of the wind-up's harmonics by the angle of the input, a cos(kθ + φ): of the true steady response, and of the
    linear forced response by (21) and by (22), Kim1990's (27) with γ = 0, where there is one."""
    columns: list[tuple[str, np.ndarray]] = [("harmonic", np.arange(turn.highest + 1.0))]
    for name, found in {"steady": turn.harmonics(), **turn.linear()}.items():
        if np.isfinite(found).all():
            size = np.where(np.arange(found.size) == 0, 360.0, 720.0) * np.abs(found)
            columns += [(f"{name}_amplitude_deg", size), (f"{name}_phase_deg", np.rad2deg(np.angle(found)))]
    return csv(*zip(*columns, strict=True))


# -- tables and sentences ----------------------------------------------------------------------------------


def tables(
    shaft: Stability, q: np.ndarray, runs: Sequence[History], means: Averages, eta_max: float
) -> dict[str, str | bytes]:
    """File name -> text of the tables of a flexible shaft: tongues of the rows q, histories, means, coefficients."""
    count, damping = count_up_to(eta_max), shaft.machine.damping
    return {
        TONGUES: tongues_table([tongues(shaft.coefficients, q, count, e, damping, error=1e-11) for e in EQUATIONS]),
        "windup.csv": csv(*windup_columns(runs)),
        "windup_averages.csv": csv(*averages_columns(means)),
        "coefficients.csv": csv(*coefficients_columns(shaft.coefficients)),
    }


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
