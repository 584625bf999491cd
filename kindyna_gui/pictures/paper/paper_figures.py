"""Figures of the papers as files: tables, plots, charts, and mechanisms with constructions on them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from math import radians
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QRectF
from PySide6.QtWidgets import QGridLayout, QLabel, QSizePolicy, QWidget

from core.instant_centres import CHAINS, ratio_arms
from core.mechanism import body_name
from core.papers import Drawing, FigureTable, MechanismPicture, MechanismRow, Polygon, ShaftPicture
from core.plot import Figure
from core.stability import Chart
from core.study import Study
from kindyna_gui.pictures.drawing import mechanism
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.centre_parts import CircleDiagram, construction_text
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.painter import (
    ENLARGED,
    MARGIN,
    SHEET_OF_CHART,
    MechanismSheet,
    PaperSheet,
    chart_plot,
    paper_theme,
    polygon_sheet,
    widget_file,
)
from kindyna_gui.pictures.paper.sheets import TableSheet, figure_file
from kindyna_gui.pictures.style import SMALL, Theme

MECHANISM, SMALL_MECHANISM = (900, 640), (270, 250)  # sizes, pixels
CIRCLE_DIAGRAM = 300  # width and height, pixels
OMITTED_LAYERS = ("labels", "scale", "normal", "centre", "loads")  # layers that would clutter a small drawing
NEAR = 6.0  # centres farther away than this many sizes of the mechanism are not in the view
ROOM = 0.06  # margin around centres, by the size of the mechanism


class _Titled(PaperSheet):
    """A picture with its title, and optionally a second widget to its right and a line below."""

    def __init__(
        self, title: str, theme: Theme, picture: QWidget, right: QWidget | None = None, below: str = ""
    ) -> None:
        super().__init__(theme)
        grid = QGridLayout(self)
        grid.setContentsMargins(MARGIN, MARGIN, MARGIN, MARGIN)
        grid.setSpacing(4)
        picture.setFixedSize(picture.size())
        columns = 1 if right is None else 2
        grid.addWidget(_line(title, theme, SMALL + 2), 0, 0, 1, columns)
        grid.addWidget(picture, 1, 0)
        if right is not None:
            grid.addWidget(right, 1, 1)
        if below:
            grid.addWidget(_line(below, theme, SMALL + 1), 2, 0, 1, columns)
        self.adjustSize()


def _line(text: str, theme: Theme, height: int) -> QLabel:
    label = QLabel(text, wordWrap=True)
    label.setStyleSheet(f"color: {theme.ink}; font-size: {height}px")
    label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Minimum)
    return label


def _table(table: FigureTable, ending: str) -> bytes:
    return widget_file(TableSheet(table), ending, table.title)


def _mechanism(picture: MechanismPicture, ending: str) -> bytes:
    """Mechanism at an angle; a step of the construction adds the circle diagram and a sentence."""
    theme = paper_theme(ending)
    scene = MechanismScene(None, theme, ENLARGED if ending == ".svg" else 1.0, still=True)
    for layer in picture.layers:
        scene.set_layer(layer, True)
    for layer in picture.without:
        scene.set_layer(layer, False)
    scene.update_study(picture.study)
    scene.set_angle(radians(picture.angle_deg))
    if picture.step is not None:
        scene.show_step(picture.step)
    rect = scene.fit_rect()
    study = picture.study.at_theta(np.array([radians(picture.angle_deg)]))
    if "centres" in picture.layers:
        rect = _with_centres(rect, study, picture.layers)
    sheet = MechanismSheet(scene, *MECHANISM, mechanism.fitted(rect, *MECHANISM))
    if picture.step is None:
        return widget_file(_Titled(picture.title, theme, sheet), ending, picture.title)
    plan = study.centres.construction
    diagram = CircleDiagram()
    diagram.setFixedSize(CIRCLE_DIAGRAM, CIRCLE_DIAGRAM)
    diagram.show_step(study.centres.bodies, plan, min(picture.step, len(plan.steps)))
    below = construction_text(plan, min(picture.step, len(plan.steps)))
    return widget_file(_Titled(picture.title, theme, sheet, diagram, below), ending, picture.title)


def _mechanism_grid(row: MechanismRow, ending: str) -> bytes:
    theme = paper_theme(ending)
    grid = QWidget()
    cells = QGridLayout(grid)
    cells.setContentsMargins(0, 0, 0, 0)
    for number, picture in enumerate(row.mechanisms):
        scene = MechanismScene(None, theme, ENLARGED if ending == ".svg" else 1.0, still=True)
        for layer in OMITTED_LAYERS:
            scene.set_layer(layer, False)
        scene.update_study(picture.study)
        scene.set_angle(radians(picture.angle_deg))
        if scene.overlay is not None:
            scene.overlay.angle.hide()
        sheet = MechanismSheet(scene, *SMALL_MECHANISM, scene.fill(*SMALL_MECHANISM))
        sheet.setFixedSize(*SMALL_MECHANISM)
        line, column = divmod(number, row.columns)
        cells.addWidget(_line(picture.title, theme, SMALL), 2 * line, column)
        cells.addWidget(sheet, 2 * line + 1, column)
    grid.adjustSize()
    return widget_file(_Titled(row.title, theme, grid), ending, row.title)


def _with_centres(rect: QRectF, study: Study, layers: Collection[str]) -> QRectF:
    """Extend a rectangle [mm] by the near centres of a study, with velocity ratios only by their centres."""
    size, table = max(rect.width(), rect.height()), study.centres
    driver = body_name(study.design.drive.linkage.driver.link)
    arms = [
        ratio_arms(table, *pair) for layer, pairs in CHAINS.items() if layer in layers for pair in pairs(table, driver)
    ]
    keys = {key for arm in arms for key in (arm.base_key, arm.body_key, arm.common_key)} or set(table.centres)
    centres = [
        complex(table.centres[key].finite[0]) * 1e3 for key in keys if not table.centres[key].is_far(table.size)[0]
    ]
    middle = complex(rect.center().x(), rect.center().y())
    for z in centres:
        if np.isfinite(abs(z)) and abs(z - middle) < NEAR * size:
            rect = rect.united(QRectF(z.real - ROOM * size, z.imag - ROOM * size, 2.0 * ROOM * size, 2.0 * ROOM * size))
    return rect


def _chart(chart: Chart, ending: str) -> bytes:
    theme = paper_theme(ending)
    plot = chart_plot(chart, theme, *SHEET_OF_CHART)
    return widget_file(_Titled(chart.name, theme, plot), ending, chart.name)


def _polygon(polygon: Polygon, ending: str) -> bytes:
    sheet = polygon_sheet(polygon.study, polygon.angle_deg)
    return widget_file(_Titled(polygon.title, paper_theme(ending), sheet), ending, polygon.title)


def _shaft(picture: ShaftPicture, ending: str) -> bytes:
    theme = paper_theme(ending)
    scene = Assembly(theme)
    scene.show_shaft(picture.study, 0, False)
    scene.set_machine(radians(picture.angle_deg))
    return widget_file(_Titled(picture.title, theme, MechanismSheet(scene, *MECHANISM)), ending, picture.title)


PAINTERS: Mapping[type, Callable[[Any, str], bytes]] = MappingProxyType(
    {
        FigureTable: _table,
        Figure: figure_file,
        Chart: _chart,
        MechanismPicture: _mechanism,
        MechanismRow: _mechanism_grid,
        Polygon: _polygon,
        ShaftPicture: _shaft,
    }
)
"""Functions that write each kind of figure as a file."""


def paper_file(drawing: Drawing, ending: str) -> bytes:
    """Write a figure or table of a paper as a file, ``.png`` or ``.svg``."""
    return PAINTERS[type(drawing)](drawing, ending)


__all__ = ["paper_file"]
