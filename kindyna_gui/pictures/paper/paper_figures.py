"""Figures of the papers as pictures: tables, plots, charts, mechanisms with what is constructed on them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from math import radians
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QRectF
from PySide6.QtWidgets import QGridLayout, QLabel, QSizePolicy, QWidget

from core.instant_centres import CHAINS, ratio_arms, velocity_polygon
from core.mechanism import body_name
from core.papers import Drawing, FigureTable, MechanismPicture, MechanismRow, Polygon, ShaftPicture
from core.plot import Figure
from core.stability import Chart
from core.study import Study
from kindyna_gui.pictures.drawing import mechanism
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.centre_parts import CircleDiagram, construction_text
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.polygons import PolygonSheet, velocity_box, velocity_diagram
from kindyna_gui.pictures.painter import ENLARGED, MARGIN, RATIO, SHEET_OF_CHART, MechanismSheet, PaperSheet, png, svg
from kindyna_gui.pictures.paper.sheets import TableSheet, figure_file
from kindyna_gui.pictures.plots.stability_chart import ChartPlot
from kindyna_gui.pictures.style import LIGHT, SMALL, Theme

MECHANISM, BESIDE, POLYGON, SMALL_ONE = (900, 640), 300, (640, 560), (270, 250)  # pixels
WITHOUT = ("labels", "scale", "normal", "centre", "loads")  # what would make a thicket of a small drawing
NEAR = 6.0  # sizes of the mechanism: centres farther away are left out of the picture
ROOM = 0.06  # of the picture, around centres


class _Titled(PaperSheet):
    """A picture under its title; what stands beside it, and a line below."""

    def __init__(
        self, title: str, theme: Theme, picture: QWidget, beside: QWidget | None = None, below: str = ""
    ) -> None:
        super().__init__(theme)
        grid = QGridLayout(self)
        grid.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        grid.setSpacing(4)
        picture.setFixedSize(picture.size())
        columns = 1 if beside is None else 2
        grid.addWidget(_line(title, theme, SMALL + 2), 0, 0, 1, columns)
        grid.addWidget(picture, 1, 0)
        if beside is not None:
            grid.addWidget(beside, 1, 1)
        if below:
            grid.addWidget(_line(below, theme, SMALL + 1), 2, 0, 1, columns)
        self.adjustSize()


def _line(text: str, theme: Theme, height: int) -> QLabel:
    label = QLabel(text, wordWrap=True)
    label.setStyleSheet(f"color: {theme.ink}; font-size: {height}px")
    label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Minimum)
    return label


def _file(widget: QWidget, ending: str, title: str) -> bytes:
    return svg(widget, title) if ending == ".svg" else png(widget)


def _theme(ending: str) -> Theme:
    return LIGHT if ending == ".svg" else replace(LIGHT, ratio=RATIO)


def _table(table: FigureTable, ending: str) -> bytes:
    return _file(TableSheet(table), ending, table.title)


def _posed(posed: MechanismPicture, ending: str) -> bytes:
    """A mechanism at its angle; with a step of the construction the circle diagram beside it, and the step in words below."""
    theme = _theme(ending)
    scene = MechanismScene(None, theme, ENLARGED if ending == ".svg" else 1.0, still=True)
    for layer in posed.layers:
        scene.set_layer(layer, True)
    for layer in posed.without:
        scene.set_layer(layer, False)
    scene.update_study(posed.study)
    scene.set_angle(radians(posed.angle_deg))
    if posed.step is not None:
        scene.show_step(posed.step)
    rect = scene.fit_rect()
    there = posed.study.at_theta(np.array([radians(posed.angle_deg)]))
    if "centres" in posed.layers:
        rect = _with_centres(rect, there, posed.layers)
    sheet = MechanismSheet(scene, *MECHANISM, mechanism.fitted(rect, *MECHANISM))
    if posed.step is None:
        return _file(_Titled(posed.title, theme, sheet), ending, posed.title)
    plan = there.centres.construction
    diagram = CircleDiagram()
    diagram.setFixedSize(BESIDE, BESIDE)
    diagram.show_step(there.centres.bodies, plan, min(posed.step, len(plan.steps)))
    below = construction_text(plan, min(posed.step, len(plan.steps)))
    return _file(_Titled(posed.title, theme, sheet, diagram, below), ending, posed.title)


def _beside(beside: MechanismRow, ending: str) -> bytes:
    theme = _theme(ending)
    grid = QWidget()
    cells = QGridLayout(grid)
    cells.setContentsMargins(0, 0, 0, 0)
    for number, posed in enumerate(beside.mechanisms):
        scene = MechanismScene(None, theme, ENLARGED if ending == ".svg" else 1.0, still=True)
        for layer in WITHOUT:
            scene.set_layer(layer, False)
        scene.update_study(posed.study)
        scene.set_angle(radians(posed.angle_deg))
        if scene.overlay is not None:
            scene.overlay.angle.hide()
        sheet = MechanismSheet(scene, *SMALL_ONE, scene.fill(*SMALL_ONE))
        sheet.setFixedSize(*SMALL_ONE)
        row, column = divmod(number, beside.columns)
        cells.addWidget(_line(posed.title, theme, SMALL), 2 * row, column)
        cells.addWidget(sheet, 2 * row + 1, column)
    grid.adjustSize()
    return _file(_Titled(beside.title, theme, grid), ending, beside.title)


def _with_centres(rect: QRectF, there: Study, layers: Collection[str]) -> QRectF:
    """What holds the mechanism and every centre that is not too far away [mm]; where velocity ratios are drawn, those that they use."""
    size, table = max(rect.width(), rect.height()), there.centres
    driver = body_name(there.design.drive.linkage.driver.link)
    arms = [
        ratio_arms(table, *pair) for layer, pairs in CHAINS.items() if layer in layers for pair in pairs(table, driver)
    ]
    keys = {key for arm in arms for key in (arm.base_key, arm.body_key, arm.common_key)} or set(table.centres)
    places = [
        complex(table.centres[key].finite[0]) * 1e3 for key in keys if not table.centres[key].is_far(table.size)[0]
    ]
    middle = complex(rect.center().x(), rect.center().y())
    for z in places:
        if np.isfinite(abs(z)) and abs(z - middle) < NEAR * size:
            rect = rect.united(QRectF(z.real - ROOM * size, z.imag - ROOM * size, 2.0 * ROOM * size, 2.0 * ROOM * size))
    return rect


def _chart(chart: Chart, ending: str) -> bytes:
    theme = _theme(ending)
    plot = ChartPlot(theme=theme)
    plot.resize(*SHEET_OF_CHART)
    plot.show_chart(chart)
    plot.grab()  # the axes find their sizes
    plot.show_chart(chart)
    return _file(_Titled(chart.name, theme, plot), ending, chart.name)


def _polygon(polygon: Polygon, ending: str) -> bytes:
    study = polygon.study
    sheet = PolygonSheet()
    sheet.resize(*POLYGON)
    sheet.set_box(velocity_box(velocity_polygon(study.linkage), study.omega))
    there = study.at_theta(np.array([radians(polygon.angle_deg)]))
    words = f"{study.angle_name.capitalize()} {polygon.angle_deg:.1f}°"
    sheet.show_diagram(velocity_diagram(velocity_polygon(there.linkage), study.omega), words)
    return _file(_Titled(polygon.title, _theme(ending), sheet), ending, polygon.title)


def _arranged(arranged: ShaftPicture, ending: str) -> bytes:
    theme = _theme(ending)
    scene = Assembly(theme)
    scene.show_shaft(arranged.study, 0, False)
    scene.set_machine(radians(arranged.angle_deg))
    return _file(_Titled(arranged.title, theme, MechanismSheet(scene, *MECHANISM)), ending, arranged.title)


PAINTERS: Mapping[type, Callable[[Any, str], bytes]] = MappingProxyType(
    {
        FigureTable: _table,
        Figure: figure_file,
        Chart: _chart,
        MechanismPicture: _posed,
        MechanismRow: _beside,
        Polygon: _polygon,
        ShaftPicture: _arranged,
    }
)
"""What is painted -> what paints it as a file with this ending."""


def paper_file(drawing: Drawing, ending: str) -> bytes:
    """A figure or table of a paper as a file, ``.png`` or ``.svg``."""
    return PAINTERS[type(drawing)](drawing, ending)


__all__ = ["paper_file"]
