"""Drawings as files: PNG and SVG bytes of a mechanism or of plots, without a window."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QFrame, QGraphicsView, QVBoxLayout

from core.output.channels import channels, existing
from core.study import Quantity, Study
from kindyna_gui.pictures.detail import UNSEEN
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.paper import ENLARGED, MARGIN, RATIO, PaperSheet, png, svg
from kindyna_gui.pictures.plots.curves import channel_extremes, different
from kindyna_gui.pictures.plots.extreme_marks import TEXT_ROOM
from kindyna_gui.pictures.plots.plot import NO_BANDS, CurvePlot
from kindyna_gui.pictures.plots.quantities import quantities_for
from kindyna_gui.pictures.style import LIGHT, Theme

if TYPE_CHECKING:
    from core.stability import Chart

SHEET = (960, 720)  # of a mechanism, pixels
SHEET_OF_CHART = (960, 560)
PLOT_WIDTH, PLOT_HEIGHT, PLOT_EDGES, LEAST_HEIGHT = 960, 210, 64, 340


class MechanismSheet(QGraphicsView):
    """A view on a mechanism that fills it, for files only: never shown, never scrolled."""

    def __init__(
        self, scene: MechanismScene | Assembly, width: int, height: int, region: tuple[QRectF, float] | None = None
    ) -> None:
        """region: what is visible [mm] and at how many pixels per mm; None: all of it."""
        super().__init__()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.TextAntialiasing)
        self.setBackgroundBrush(scene.backgroundBrush())
        self.setAutoFillBackground(False)
        self.resize(width, height)
        visible, scale = region or scene.fit(width, height)
        scene.show_region(visible, scale)
        self.setScene(scene)
        self.setSceneRect(visible)
        self.scale(scale, -scale)


class PlotStack(PaperSheet):
    """Plots one below the other on one cam-angle axis: segments named along the top, angles along the bottom.

    unseen: pixels by which curves may be off; 0 draws every point; marks: whether extremes are marked; bands: as ``set_curves``
    """

    def __init__(
        self,
        study: Study,
        rows: Sequence[Sequence[Quantity]],
        theme: Theme,
        unseen: float = 0.0,
        marks: bool = True,
        bands: Mapping[str, np.ndarray] = NO_BANDS,
    ) -> None:
        super().__init__(theme)
        column = QVBoxLayout(self)
        column.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        column.setSpacing(4)
        self.plots: list[CurvePlot] = []
        for number, row in enumerate(rows):
            plot = CurvePlot(self, names=number == 0, angles=number == len(rows) - 1, theme=theme)
            plot.unseen = unseen
            if marks:
                plot.text_room = TEXT_ROOM
            plot.set_curves(study, row, bands=bands)
            plot.show_extremes(channel_extremes(study, row) if marks else None)
            plot.show_cursor(False)
            column.addWidget(plot)
            self.plots.append(plot)
        self.resize(PLOT_WIDTH, max(PLOT_HEIGHT * len(rows), LEAST_HEIGHT) + PLOT_EDGES)


# -- the pictures of a report -----------------------------------------------------------------------------


def report_scene(study: Study, theme: Theme, closest: float = 1.0) -> MechanismScene:
    """The mechanism where the pressure angle is largest, so that normal and instant centre are seen at work."""
    scene = MechanismScene(study, theme, closest, still=True)
    at = int(np.argmax(study.cam.flank.pressure_angle)) if "cam" in study.stages else study.theta.size // 8
    scene.set_index(at)
    return scene


def _mechanism_png(study: Study) -> bytes:
    return png(MechanismSheet(report_scene(study, replace(LIGHT, ratio=RATIO)), *SHEET))


def _mechanism_svg(study: Study) -> bytes:
    return svg(MechanismSheet(report_scene(study, LIGHT, ENLARGED), *SHEET), study.design.name)


def plot_rows(study: Study, rows: Sequence[Sequence[str]]) -> list[list[Quantity]]:
    """What plots of these quantities show: what a design does not have is left out, and links stand for a follower."""
    available = {row.name: row for row in existing(study, channels(study.design))}
    rows_here = [quantities_for(study, names) for names in rows]
    shown = [different(study, [available[name] for name in names if name in available]) for names in rows_here]
    return [row for row in shown if row]


def _plots(*rows: tuple[str, ...]) -> Callable[[Study], bytes]:
    """Plots of these quantities, one row below the other."""
    return lambda study: curves_file(study, plot_rows(study, rows), ".png")


def curves_file(
    study: Study,
    rows: Sequence[Sequence[Quantity]],
    ending: str,
    marks: bool = True,
    bands: Mapping[str, np.ndarray] = NO_BANDS,
) -> bytes:
    """Plots one below the other as a file, ``.png`` or ``.svg``, their extremes marked, bands shaded. Raises NoSolution where one has no
    values."""
    if ending == ".svg":
        return svg(PlotStack(study, rows, LIGHT, marks=marks, bands=bands), study.design.name)
    return png(PlotStack(study, rows, replace(LIGHT, ratio=RATIO), UNSEEN / RATIO, marks, bands))


MOTION = (("displacement",), ("velocity",), ("acceleration",), ("jerk",))
CAM = (("pressure_angle",), ("pitch_curvature",), ("radius",))
FORCES = (("contact_force",), ("drive_torque", "motor_torque", "linear_motor_torque"), ("guide_force",))

PICTURES: Mapping[str, Callable[[Study], bytes]] = MappingProxyType(
    {
        "mechanism.png": _mechanism_png,
        "mechanism.svg": _mechanism_svg,
        "motion.png": _plots(*MOTION),
        "cam.png": _plots(*CAM),
        "forces.png": _plots(*FORCES),
    }
)


def chart_file(chart: Chart, ending: str) -> bytes:
    """A chart of stability as a file, ``.png`` or ``.svg``."""
    from kindyna_gui.pictures.plots.stability_chart import ChartPlot

    vector = ending == ".svg"
    plot = ChartPlot(theme=LIGHT if vector else replace(LIGHT, ratio=RATIO))
    plot.resize(*SHEET_OF_CHART)
    plot.show_chart(chart)
    plot.grab()  # the axes find their sizes
    plot.show_chart(chart)
    return svg(plot, chart.name) if vector else png(plot)
