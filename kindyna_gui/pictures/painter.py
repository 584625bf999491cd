"""Pictures as files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from math import radians
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QPoint, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QImage, QImageWriter, QPaintDevice, QPainter, QPalette
from PySide6.QtSvg import QSvgGenerator
from PySide6.QtWidgets import QFrame, QGraphicsView, QVBoxLayout, QWidget

from core.design import Design
from core.errors import KindynaError
from core.instant_centres import velocity_polygon
from core.output.channels import channels, existing
from core.output.position import Snapshot
from core.study import Quantity, Study
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.parts import EVERY_LAYER
from kindyna_gui.pictures.drawing.polygons import PolygonSheet, velocity_box, velocity_diagram
from kindyna_gui.pictures.plots.curves import NO_BANDS, CurvePlot
from kindyna_gui.pictures.plots.marks import TEXT_ROOM
from kindyna_gui.pictures.plots.quantities import channel_extremes, quantities_for, without_equal_curves
from kindyna_gui.pictures.style import LIGHT, Theme
from kindyna_gui.pictures.units import UNSEEN

if TYPE_CHECKING:
    from core.stability import Chart


# -- paper -----------------------------------------------------------------------------------------------

MARGIN = 8  # around the plots, pixels
RATIO = 2.0  # dots per pixel of a PNG
LIGHTLY = 70  # of Qt's 0 ... 100 of a PNG: zlib's level 3, where 6 is usual
ENLARGED = 64.0  # how far a reader may zoom into an SVG before its curves show corners


class PaperSheet(QWidget):
    """A widget in the colour of a theme's paper; subclasses lay out their plots ``MARGIN`` from its edges."""

    def __init__(self, theme: Theme) -> None:
        super().__init__()
        paper = QPalette(self.palette())
        paper.setColor(QPalette.ColorRole.Window, QColor(theme.paper))
        self.setPalette(paper)
        self.setAutoFillBackground(True)


def png(widget: QWidget, ratio: float = RATIO) -> bytes:
    """A widget as PNG, ``ratio`` dots per pixel; draw with a theme of the same ratio."""
    image = QImage(widget.size() * ratio, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(ratio)
    image.fill(QColor("white"))
    _draw(widget, image)
    return png_bytes(image)


def png_bytes(image: QImage) -> bytes:
    """An image as PNG: a fifth larger than Qt would make it, in two thirds of the time."""
    data = QByteArray()
    buffer = QBuffer(data)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    writer = QImageWriter(buffer, b"PNG")
    writer.setQuality(LIGHTLY)
    writer.write(image)
    return bytes(data.data())


def svg(widget: QWidget, title: str = "") -> bytes:
    """A widget as SVG."""
    data = QByteArray()
    buffer = QBuffer(data)
    generator = QSvgGenerator()
    generator.setOutputDevice(buffer)
    generator.setResolution(widget.logicalDpiX())
    generator.setSize(QSize(widget.width(), widget.height()))
    generator.setViewBox(QRect(0, 0, widget.width(), widget.height()))
    generator.setTitle(title)
    generator.setDescription("")
    _draw(widget, generator)
    return bytes(data.data())


def _draw(widget: QWidget, device: QPaintDevice) -> None:
    """As the screen would show it: a graphics view's own ``render`` would leave out what is measured in pixels."""
    widget.grab(QRect(0, 0, 1, 1))  # sizes of all that is inside are settled by drawing once
    painter = QPainter(device)
    try:
        QWidget.render(widget, painter, QPoint())
    finally:
        painter.end()


# -- files -----------------------------------------------------------------------------------------------

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
    shown = [
        without_equal_curves(study, [available[name] for name in names if name in available]) for names in rows_here
    ]
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


# -- snapshots -------------------------------------------------------------------------------------------

SHEET_OF_POLYGON = (640, 560)  # pixels


def _centres_file(snapshot: Snapshot, ending: str) -> bytes:
    """The mechanism with all centres, the lines that find them and the velocity ratios from link to link."""
    vector = ending == ".svg"
    theme, closest = (LIGHT, ENLARGED) if vector else (replace(LIGHT, ratio=RATIO), 1.0)
    scene = MechanismScene(None, theme, closest, still=True)
    for layer in ("centres", "kennedy", "velocities", "chain"):
        scene.set_layer(layer, True)
    scene.update_study(snapshot.study)
    scene.set_angle(radians(snapshot.angle_deg))
    sheet = MechanismSheet(scene, *SHEET)
    return svg(sheet, snapshot.study.design.name) if vector else png(sheet)


def _polygon_file(snapshot: Snapshot, ending: str) -> bytes:
    """The velocity polygon."""
    study = snapshot.study
    sheet = PolygonSheet()
    sheet.resize(*SHEET_OF_POLYGON)
    sheet.set_box(velocity_box(velocity_polygon(study.linkage), study.omega))
    at_angle = study.at_theta(np.array([radians(snapshot.angle_deg)]))
    name = study.angle_name.capitalize()
    sheet.show_diagram(
        velocity_diagram(velocity_polygon(at_angle.linkage), study.omega), f"{name} {snapshot.angle_deg:.1f}°"
    )
    return svg(sheet, study.design.name) if ending == ".svg" else png(sheet)


SNAPSHOTS: Mapping[str, Callable[[Snapshot, str], bytes]] = MappingProxyType(
    {"centres": _centres_file, "velocity_polygon": _polygon_file}
)


# -- small pictures of designs, without texts, by which they are chosen ----------------------------------

SAMPLES = 180  # of a turn
TURNED = 0.125  # of a turn, at which the mechanism stands
_LEFT_OUT = ("labels", "scale", "pitch", "base", "normal", "centre", "loads")


def _mechanism(design: Design, width: int, height: int) -> MechanismSheet:
    scene = MechanismScene()
    for layer in EVERY_LAYER:
        scene.set_layer(layer, layer not in _LEFT_OUT and EVERY_LAYER[layer].shown)
    scene.update_study(Study(design, SAMPLES))
    assert scene.overlay is not None
    scene.overlay.angle.hide()
    scene.set_fraction(TURNED)
    return MechanismSheet(scene, width, height, scene.fill(width, height))


def _drives(design: Design, width: int, height: int) -> MechanismSheet:
    scene = Assembly()
    scene.show_shaft(Study(design, SAMPLES).camshaft, 0, about_shaft=False, layers=())
    for part in (scene.overlay.angle, scene.overlay.bar, *(figure.tag for figure in scene.figures.values())):
        part.hide()
    scene.set_fraction(TURNED)
    scene.fit(width, height)  # as many drives in a row as suit the picture
    whole = scene.fit_rect()
    scale = min(width / whole.width(), height / whole.height())
    room = QRectF(0.0, 0.0, width / scale, height / scale)
    room.moveCenter(whole.center())
    return MechanismSheet(scene, width, height, (room, scale))


@lru_cache(maxsize=128)
def thumbnail(design: Design, width: int, height: int, ratio: float = 1.0) -> QImage:
    """A small picture of the mechanism, or of all drives; empty where it has no position."""
    picture = QImage(QSize(width, height) * ratio, QImage.Format.Format_RGB32)
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.white)
    try:
        sheet = (_drives if design.listed else _mechanism)(design, width, height)
    except KindynaError:
        return picture
    sheet.grab(QRect(0, 0, 1, 1))  # sizes are settled by drawing once
    painter = QPainter(picture)
    QWidget.render(sheet, painter, QPoint())
    painter.end()
    sheet.deleteLater()
    return picture
