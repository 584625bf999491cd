"""Kim1990's Figs. 2 to 12 as numbers and as what is painted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.papers.examples import Examples
from core.papers.kim1990.chart import EXAMPLE, FIGURES, ROWS, averages, eleven, run_of, shaft_of
from core.papers.kim1990.equations import forces
from core.papers.sheet import FigureTable, PaperFigure, plotted, table_by_column
from core.plot import Plot, PlotCurve
from core.stability import (
    EQUATIONS,
    ETA_MAX,
    Chart,
    averages_plots,
    chart,
    coefficients_plot,
    count_up_to,
    history_plot,
    tongues,
)
from core.stability.figures import CAM_ANGLE
from core.stability.tables import Columns, averages_columns, coefficients_columns, windup_columns

UNSEEN = 1e-5  # of η: an edge that is off by less is not seen in a picture
PROFILE = {"displacement": "displacement X", "velocity": "velocity X'", "acceleration": "acceleration X''"}


def _table(columns: Columns) -> FigureTable:
    return FigureTable(tuple(columns[0]), tuple(columns[1]))


def _sheet(
    number: int, title: str, table: Callable[[Examples], FigureTable], plots: Callable[[Examples], tuple[Plot, ...]]
) -> PaperFigure:
    full = f"Kim1990 Fig. {number}: {title}"
    return plotted(f"figure_{number}", full, table, plots)


# -- Figs. 2 to 5 -------------------------------------------------------------------------------------------


def _forces_table(examples: Examples) -> FigureTable:
    f = forces(examples)
    names = ("force", "force printed", "torque", "torque printed")
    columns = ("contact_force_n", "contact_force_as_printed_n", "cam_torque_nm", "cam_torque_as_printed_nm")
    return FigureTable(("cam_angle_deg", *columns), (np.rad2deg(f["theta"]), *(f[name] for name in names)))


def _forces(examples: Examples) -> tuple[Plot, ...]:
    f = forces(examples)
    degrees = np.concatenate(([0.0], np.rad2deg(f["theta"]), [360.0]))

    def whole(name: str) -> np.ndarray:
        return np.concatenate((f[name][:1], f[name], f[name][-1:]))

    axes = (("force", "Contact force Fc, N"), ("torque", "Torque Tc on the cam, N·m"))
    return tuple(
        Plot(
            CAM_ANGLE,
            axis,
            (
                PlotCurve(degrees, whole(what), "here"),
                PlotCurve(degrees, whole(f"{what} printed"), "as printed", 1, True),
            ),
        )
        for what, axis in axes
    )


def _angles(examples: Examples) -> tuple[np.ndarray, np.ndarray]:
    """Input and cam angle (n,) [deg] through the first turn of Fig. 12."""
    y = np.arange(721) / 720.0
    return 360.0 * y, 360.0 * (y - run_of(examples, 12).at(y)[0])


def _angles_table(examples: Examples) -> FigureTable:
    wanted, true = _angles(examples)
    return FigureTable(("input_angle_deg", "cam_angle_deg", "twist_deg"), (wanted, true, wanted - true))


def _linearisation(examples: Examples) -> tuple[Plot, ...]:
    wanted, true = _angles(examples)
    both = (PlotCurve(wanted, wanted, "θi, about which it is linearised", 1, True), PlotCurve(wanted, true, "θc"))
    return Plot("Input angle θi, °", "Angle, °", both), Plot(
        "Input angle θi, °", "2πβ = θi - θc, °", (PlotCurve(wanted, wanted - true),)
    )


def _profile(examples: Examples) -> dict[str, np.ndarray]:
    """X, X', X'' relative to their largest (n,) by cam angle [deg]."""
    study, sizes = examples.study(EXAMPLE), shaft_of(examples).coefficients.sizes
    y = study.motion.displacement
    parts = (y[0] - sizes.lowest) / sizes.stroke, y[1] / sizes.slope, y[2] / sizes.curvature
    return {"cam_angle_deg": study.angle_degrees, **dict(zip(PROFILE, parts, strict=True))}


def _profile_plots(examples: Examples) -> tuple[Plot, ...]:
    """To the dwell's end: where the next turn begins X'' jumps."""
    degrees, *rows = _profile(examples).values()
    around = np.append(degrees, 360.0)
    curves = tuple(
        PlotCurve(around, np.append(row, row[-1:]), label, i, family=name)
        for i, (row, (name, label)) in enumerate(zip(rows, PROFILE.items(), strict=True))
    )
    return (Plot(CAM_ANGLE, "Relative to the largest", curves),)


def _psi(examples: Examples) -> tuple[Plot, ...]:
    return (coefficients_plot(shaft_of(examples).coefficients, ("ψ",)),)


def _psi_table(examples: Examples) -> FigureTable:
    return _table(coefficients_columns(shaft_of(examples).coefficients))


# -- Figs. 6 to 12 ------------------------------------------------------------------------------------------


def _averages_table(examples: Examples) -> FigureTable:
    return _table(averages_columns(averages(examples, ROWS)))


def _chart(examples: Examples) -> Chart:
    return chart(shaft_of(examples).coefficients, None, CHART.title, eta_max=ETA_MAX, error=UNSEEN)


def _tongues(examples: Examples) -> FigureTable:
    """Edges by Q: those of (21) and of (22)."""
    shaft, q = shaft_of(examples), np.arange(1, 25) / 200.0
    count = count_up_to(ETA_MAX)
    columns: list[list[float]] = [[], [], [], [], []]
    for number, equation in enumerate(EQUATIONS):
        edges = tongues(shaft.coefficients, q, count, equation, error=1e-9).edges
        for i, each in enumerate(q.tolist()):
            for n in range(count):
                for column, value in zip(
                    columns, (float(number == 0), each, n + 1.0, *edges[i, n].tolist()), strict=True
                ):
                    column.append(value)
    words = tuple(EQUATIONS[list(EQUATIONS)[0 if is_first else 1]] for is_first in columns[0])
    return FigureTable(
        ("equation", "q", "n", "eta_low", "eta_high"), (words, *(np.array(column) for column in columns[1:]))
    )


def _eleven(examples: Examples) -> FigureTable:
    """How far the edges of the 11 x 11 matrix stand from those of (22), beside the widths of the tongues."""
    found = eleven(examples)
    n = np.arange(1, found["off"].size + 1)

    def where_it_is(values: np.ndarray) -> tuple[str, ...]:
        return tuple(f"{value:.6g}" if np.isfinite(value) else "one edge only" for value in values.tolist())

    off, widths = found["off"], found["widths"]
    columns = (n.astype(float), 0.5 * n, where_it_is(off), widths, where_it_is(off / widths))
    return FigureTable(
        ("n", "eta", "edge_off_by", "width", "part_of_width"),
        columns,
        f"Edges of the 11 x 11 matrix, Q = {found['q']:g}",
    )


def _history(number: int) -> PaperFigure:
    at = [figure[0] for figure in FIGURES].index(number)
    _, eta, q, _ = FIGURES[at]
    return _sheet(
        number,
        f"wind-up from rest at η = {eta:.2f}, Q = {q:.2f}",
        lambda examples: _table(windup_columns([run_of(examples, number)])),
        lambda examples: (history_plot(run_of(examples, number)),),
    )


FORCES = _sheet(2, "contact force and torque on the cam", _forces_table, _forces)
LINEARISATION = _sheet(3, "the angle about which it is linearised", _angles_table, _linearisation)
DISPLACEMENT = _sheet(4, "profile of the single harmonic cam", lambda e: table_by_column(_profile(e)), _profile_plots)
PSI = _sheet(5, "the periodic function ψ, a = 1.5", _psi_table, _psi)
MEAN = _sheet(6, "mean of |β| through the first turn", _averages_table, lambda e: averages_plots(averages(e, ROWS))[:1])
MEAN_SLOPE = _sheet(
    7, "mean of |dβ/dy| through the first turn", _averages_table, lambda e: averages_plots(averages(e, ROWS))[1:]
)
CHART = PaperFigure("figure_8", "Kim1990 Fig. 8: regions of instability", _tongues, _chart)
ELEVEN = PaperFigure("section_6_2", "Kim1990 §6 (2): edges of the 11 x 11 matrix", _eleven)
HISTORIES = {figure[0]: _history(figure[0]) for figure in FIGURES}
