"""Pictures of the report as vector graphics, which can be painted on any device at any size."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPoint, QRect, QSize
from PySide6.QtGui import QColor, QPainter, QPalette
from PySide6.QtWidgets import QGraphicsView, QVBoxLayout, QWidget

from core.design import UNITS
from core.frozen import frozen
from core.output.drawing.palette import FAMILIES
from core.output.report.parts import ReportPicture
from core.study import Study
from core.study.camshaft import has_speed
from core.study.quantities import member_of
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.painter import (
    CAM,
    FORCES,
    MARGIN,
    MOTION,
    MechanismSheet,
    PaperSheet,
    PlotStack,
    chart_plot,
    plot_rows,
    report_scene,
    svg_bytes,
)
from kindyna_gui.pictures.paper.crank_chart import CrankChart
from kindyna_gui.pictures.paper.timing_chart import CRANK, DEGREES, ChartHighlights, TimingChart
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import BALANCE, LIGHT, Theme

WIDTH = 680  # width of all pictures, pixels
PLOT, EDGES, LEAST = 121, 66, 230  # heights of a plot, of the margins of a stack, and least height of a stack, pixels
MECHANISM, CHART = 390, 380  # heights of a mechanism and of a stability chart, pixels
BAND, PANEL, AXIS = 78, 240, 48  # heights of a drive, a cylinder's valves, and the axis in a timing chart, pixels
GLANCE = 300  # height of the picture on the first page, pixels
ENLARGED = 16.0  # magnification up to which the curves of a mechanism are smooth
SPEED = "Speed, rpm"
UNSEEN = 0.04  # allowed deviation of a drawn curve, pixels
_ROLE = QPalette.ColorRole
COLOURS = {
    **dict.fromkeys((_ROLE.WindowText, _ROLE.Text, _ROLE.ButtonText), LIGHT.ink),
    **dict.fromkeys((_ROLE.Window, _ROLE.Base), LIGHT.paper),
}
FALLBACK = ('font-family="DejaVu Sans"', 'font-family="DejaVu Sans, Verdana, sans-serif"')  # fonts of the same widths


@frozen(eq=False)
class Vector:
    """A picture with its size in pixels, and the function that paints it."""

    width: int
    height: int
    paint: Callable[[QPainter], None]


def vector(picture: ReportPicture, scale: float = 1.0, part: float = 1.0) -> Vector:
    """Picture of a report.

    Parameters
    ----------
    picture : ReportPicture
    scale : float
        Dots of the device per pixel.
    part : float
        Height as a fraction of the full height; texts keep their size.

    Raises
    ------
    NoSolution
        Where the design has none.
    """
    return VECTORS[picture.name](picture.study, replace(LIGHT, ratio=scale), part)


def svg(drawn: Vector, title: str) -> str:
    """Write a picture as SVG."""
    size = QSize(drawn.width, drawn.height)
    return svg_bytes(size, 96, title, "", drawn.paint).decode().replace(*FALLBACK)


def _widget_vector(widget: QWidget) -> Vector:
    """Picture of a widget as on the screen, in the light theme."""
    for child in (widget, *widget.findChildren(QWidget)):
        colours = child.palette()
        for role, colour in COLOURS.items():
            colours.setColor(role, QColor(colour))
        child.setPalette(colours)
        if isinstance(child, QGraphicsView):
            child.setAutoFillBackground(False)
            child.viewport().setAutoFillBackground(False)
    widget.grab(QRect(0, 0, 1, 1))  # drawing once sets the sizes of all children
    return Vector(widget.width(), widget.height(), lambda painter: QWidget.render(widget, painter, QPoint()))


def _plots(*rows: tuple[str, ...]) -> Callable[[Study, Theme, float], Vector]:
    def drawn(study: Study, theme: Theme, part: float) -> Vector:
        return _stack(study, plot_rows(study, rows), theme, part)

    return drawn


def _stack(study: Study, rows: Sequence[Any], theme: Theme, part: float) -> Vector:
    stack = PlotStack(study, rows, theme, UNSEEN)
    stack.resize(WIDTH, int(part * max(PLOT * len(rows) + EDGES, LEAST)))
    return _widget_vector(stack)


def _links(study: Study, theme: Theme, part: float) -> Vector:
    """Plots of the links of a linkage without a cam; the motion has its plots elsewhere."""
    rows = plot_rows(study, (*MOTION[:3], ("pressure_angle",)))
    link_rows = [row for row in rows if member_of(row[0].name)]
    return _stack(study, link_rows or rows, theme, part)


def _mechanism(study: Study, theme: Theme, part: float) -> Vector:
    return _widget_vector(MechanismSheet(report_scene(study, theme, ENLARGED), WIDTH, int(part * MECHANISM)))


def _glance(study: Study, theme: Theme, part: float) -> Vector:
    """Mechanism for the first page; a shaft with all its drives side by side."""
    if not study.design.listed:
        return _widget_vector(MechanismSheet(report_scene(study, theme, ENLARGED), WIDTH, int(part * GLANCE)))
    scene = Assembly(theme)
    scene.show_shaft(study.camshaft, 0, about_shaft=False)
    return _widget_vector(MechanismSheet(scene, WIDTH, int(part * GLANCE)))


def _chart(study: Study, theme: Theme, part: float) -> Vector:
    from core.output.stability_files import machine_chart  # slow to load, and only needed for a flexible shaft

    chart = machine_chart(study.flexible_shaft(), study.design.name)
    return _widget_vector(chart_plot(chart, theme, WIDTH, int(part * CHART)))


def _timing(study: Study, theme: Theme, part: float) -> Vector:
    height = int(part * (BAND * len(study.design.drives) + AXIS))
    chart = TimingChart(study.design, WIDTH, height, DEGREES, replace(theme, ratio=1.0))  # its pens scale with the page
    return Vector(WIDTH, height, lambda painter: chart.paint(painter, ChartHighlights()))


def _valves(study: Study, theme: Theme, part: float) -> Vector:
    height = int(part * (PANEL * CrankChart.panel_count(study.design) + AXIS))
    chart = CrankChart(study.design, WIDTH, height, CRANK, replace(theme, ratio=1.0))
    return Vector(WIDTH, height, lambda painter: chart.paint(painter, ChartHighlights()))


def _torque(study: Study, theme: Theme, part: float) -> Vector:
    """Torques of the drives and of the shaft, and the speed of a shaft with a flywheel."""
    shaft = study.camshaft
    names = [name for name in shaft.loading_drives if name not in shaft.failures]
    drives = [(name, shaft.drive_torque(name), LIGHT.drive(shaft.drive_number(name))) for name in names]
    sums = [("Shaft", shaft.torque, theme.ink)]
    if shaft.design.balancer is not None:
        drives.append(("Balance cam", shaft.balancer_torque, BALANCE))
    running = shaft.levels_torque and has_speed(shaft)
    if running:
        sums.append(("Motor", shaft.motor_torque, FAMILIES["torque"]))
    plots = [("Drives, N·m", drives), ("Shaft, N·m", sums)]
    if running:
        plots.append((SPEED, [("", shaft.speed / UNITS["rpm"].factor, FAMILIES["speed"])]))
    sheet = PaperSheet(theme)
    column = QVBoxLayout(sheet)
    column.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
    for number, (upwards, curves) in enumerate(plots):
        plot = XYPlot("Machine angle, °" if number == len(plots) - 1 else "", upwards, theme=theme)
        closed = np.append(shaft.angle_degrees, 360.0)
        plot.show_lines([Line(closed, np.append(values, values[0]), colour, name) for name, values, colour in curves])
        if upwards == SPEED:  # its range does not include 0
            low, high = float(curves[0][1].min()), float(curves[0][1].max())
            room = 0.1 * (high - low) or 1e-3 * high
            plot.getViewBox().setRange(yRange=(low - room, high + room), padding=0.0)
        column.addWidget(plot)
    sheet.resize(WIDTH, int(part * ((PLOT + 40) * len(plots) + 30)))
    return _widget_vector(sheet)


VECTORS: Mapping[str, Callable[[Any, Theme, float], Vector]] = MappingProxyType(
    {
        "glance": _glance,
        "mechanism": _mechanism,
        "motion": _plots(*MOTION),
        "cam": _plots(*CAM),
        "links": _links,
        "forces": _plots(*FORCES),
        "stability": _chart,
        "timing": _timing,
        "torque": _torque,
        "valves": _valves,
    }
)
"""Functions that draw the pictures of a report, by name."""

__all__ = ["VECTORS", "Vector", "svg", "vector"]
