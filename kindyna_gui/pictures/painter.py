"""Drawings and plots as PNG and SVG files: those of a report, of a snapshot at one angle, and thumbnails of designs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from math import radians
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QPoint, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QImage, QImageWriter, QPaintDevice, QPainter, QPalette
from PySide6.QtSvg import QSvgGenerator
from PySide6.QtWidgets import QFrame, QGraphicsView, QVBoxLayout, QWidget

from core.design import Design
from core.errors import KindynaError
from core.instant_centres import velocity_polygon
from core.output.channels import channels, existing
from core.output.drawing.scales import UNSEEN
from core.output.position import Snapshot
from core.study import Quantity, Study
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.drawing.parts import EVERY_LAYER, OUTLINE_LAYER
from kindyna_gui.pictures.drawing.polygons import PolygonSheet, velocity_box, velocity_diagram
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.plots.marks import TEXT_ROOM
from kindyna_gui.pictures.plots.quantities import channel_extremes, quantities_for, without_equal_curves
from kindyna_gui.pictures.style import LIGHT, Theme
from kindyna_gui.pictures.units import number
from kindyna_gui.rebuilt import fill

if TYPE_CHECKING:
    from core.stability import Chart
    from kindyna_gui.pictures.plots.polar import PolarPlot
    from kindyna_gui.pictures.plots.stability_chart import ChartPlot


Paint = Callable[[QPainter], None]
Companions = Callable[[Sequence[Quantity]], Mapping[str, Any]]
"""Quantities of a plot -> bands and pinned variant, as arguments of ``set_curves``."""
MARGIN = 8  # around the plots, pixels
RATIO = 2.0  # dots per pixel of a PNG
PNG_QUALITY = 70  # of Qt's 0 ... 100: zlib's level 3 instead of the default 6
ENLARGED = 64.0  # magnification of an SVG at which its curves begin to show corners
SHEET = (960, 720)  # of a mechanism, pixels
SHEET_OF_CHART = (960, 560)
SHEET_OF_POLYGON = (640, 560)
PLOT_WIDTH, PLOT_HEIGHT, PLOT_EDGES, LEAST_HEIGHT = 960, 210, 64, 340
SAMPLES = 180  # of a turn, for a thumbnail
FRACTION = 0.125  # of a turn, position of the mechanism in a thumbnail
_OMITTED_LAYERS = ("labels", "scale", "pitch", "base", "normal", "centre", "loads")  # in a thumbnail

# -- files of a widget -----------------------------------------------------------------------------------


class PaperSheet(QWidget):
    """Widget in the colour of a theme's paper; subclasses lay out their plots ``MARGIN`` from its edges."""

    def __init__(self, theme: Theme) -> None:
        super().__init__()
        paper = QPalette(self.palette())
        paper.setColor(QPalette.ColorRole.Window, QColor(theme.paper))
        self.setPalette(paper)
        self.setAutoFillBackground(True)


def paper_theme(ending: str) -> Theme:
    """Theme of a file with this ending."""
    return replace(LIGHT, ratio=RATIO) if ending == ".png" else LIGHT


def widget_file(widget: QWidget, ending: str, title: str) -> bytes:
    """Widget in the theme of ``paper_theme`` as a file, ``.png`` or ``.svg``."""
    return svg(widget, title) if ending == ".svg" else png(widget)


def png(widget: QWidget, ratio: float = RATIO) -> bytes:
    """Widget as PNG with ``ratio`` dots per pixel; its theme must have the same ratio."""
    image = QImage(widget.size() * ratio, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(ratio)
    image.fill(QColor("white"))
    paint_on(image, _painting(widget))
    return png_bytes(image)


def png_bytes(image: QImage) -> bytes:
    """Image as PNG, a fifth larger than Qt's default, in two thirds of the time."""
    return image_bytes(image, "PNG", PNG_QUALITY)


def image_bytes(image: QImage, kind: str, quality: int) -> bytes:
    """Image as a file of a kind that Qt writes, with its quality of 0 ... 100."""
    data = QByteArray()
    buffer = QBuffer(data)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    writer = QImageWriter(buffer, kind.encode())
    writer.setQuality(quality)
    writer.write(image)
    return bytes(data.data())


def svg(widget: QWidget, title: str = "") -> bytes:
    """Widget as SVG."""
    return svg_bytes(widget.size(), widget.logicalDpiX(), title, "", _painting(widget))


def svg_bytes(size: QSize, resolution: int, title: str, about: str, paint: Paint) -> bytes:
    """Write what a function paints as SVG, in dots of a resolution [1/in]."""
    data = QByteArray()
    buffer = QBuffer(data)
    generator = QSvgGenerator()
    generator.setOutputDevice(buffer)
    generator.setResolution(resolution)
    generator.setSize(size)
    generator.setViewBox(QRect(QPoint(), size))
    generator.setTitle(title)
    generator.setDescription(about)
    paint_on(generator, paint)
    return bytes(data.data())


def paint_on(device: QPaintDevice, paint: Paint) -> None:
    """Call a function with a painter on a device."""
    painter = QPainter(device)
    try:
        paint(painter)
    finally:
        painter.end()


def _painting(widget: QWidget) -> Paint:
    """Function that paints a widget as on the screen; a graphics view's own ``render`` would omit items measured in pixels."""
    widget.grab(QRect(0, 0, 1, 1))  # drawing once determines the sizes of its contents
    return lambda painter: QWidget.render(widget, painter, QPoint())


class MechanismSheet(QGraphicsView):
    """View of a mechanism for files.

    Parameters
    ----------
    scene : MechanismScene or Assembly
    width, height : int
        Size [pixels].
    region : (QRectF, float), optional
        Visible rectangle [mm] and scale [pixels per mm]; by default the full mechanism.
    """

    def __init__(
        self, scene: MechanismScene | Assembly, width: int, height: int, region: tuple[QRectF, float] | None = None
    ) -> None:
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


def no_companions(rows: Sequence[Quantity]) -> Mapping[str, Any]:
    """Return nothing: the plot shows the design alone."""
    return {}


class PlotStack(PaperSheet):
    """Stack of plots over one cam angle, with names of segments along the top and angles along the bottom.

    Parameters
    ----------
    study : Study
    rows : sequence of sequence of Quantity
        Quantities of each plot.
    theme : Theme
    unseen : float
        Error of the curves that is allowed [pixels]; 0 draws every point.
    marks : bool
        Mark the extremes.
    companions : callable
        Quantities of a plot -> what is drawn next to them, as arguments of ``set_curves``.
    """

    def __init__(
        self,
        study: Study,
        rows: Sequence[Sequence[Quantity]],
        theme: Theme,
        unseen: float = 0.0,
        marks: bool = True,
        companions: Companions = no_companions,
    ) -> None:
        super().__init__(theme)
        column = fill(QVBoxLayout(self), margins=MARGIN, spacing=4)
        self.plots: list[CurvePlot] = []
        for index, row in enumerate(rows):
            plot = CurvePlot(self, names=index == 0, angles=index == len(rows) - 1, theme=theme)
            if marks:
                plot.text_room = TEXT_ROOM
            fill_plot(plot, study, row, unseen, marks, companions)
            column.addWidget(plot)
            self.plots.append(plot)
        self.resize(PLOT_WIDTH, max(PLOT_HEIGHT * len(rows), LEAST_HEIGHT) + PLOT_EDGES)


def fill_plot(
    plot: CurvePlot | PolarPlot,
    study: Study,
    row: Sequence[Quantity],
    unseen: float,
    marks: bool,
    companions: Companions,
) -> None:
    """Draw the quantities of one plot for a file; parameters as for `PlotStack`."""
    plot.unseen = unseen
    plot.set_curves(study, row, **companions(row))
    plot.show_extremes(channel_extremes(study, row) if marks else None)
    plot.show_cursor(False)


# -- images of a report ----------------------------------------------------------------------------------


def report_scene(study: Study, theme: Theme, closest: float = 1.0) -> MechanismScene:
    """Mechanism at its largest pressure angle, where normal and instant centre are clearly visible."""
    scene = MechanismScene(study, theme, closest, still=True)
    scene.set_index(_steepest(scene, study))
    return scene


def _steepest(scene: MechanismScene, study: Study) -> int:
    """Sample with the largest pressure angle; an eighth of a turn without a cam."""
    if study.has_disk:
        return int(np.argmax(study.cam.flank.pressure_angle))
    surface = None if scene.geometry is None else scene.geometry.surface
    return study.theta.size // 8 if surface is None else int(np.argmax(surface.pressure_angle))


def _mechanism_file(ending: str, study: Study) -> bytes:
    scene = report_scene(study, paper_theme(ending), ENLARGED if ending == ".svg" else 1.0)
    return widget_file(MechanismSheet(scene, *SHEET), ending, study.design.name)


def plot_rows(study: Study, rows: Sequence[Sequence[str]]) -> list[list[Quantity]]:
    """Channels of plots of these quantities: those that the design has, or the links' for a linkage without follower."""
    available = {row.name: row for row in existing(study, channels(study.design))}
    shown = [
        without_equal_curves(study, [available[name] for name in quantities_for(study, names) if name in available])
        for names in rows
    ]
    return [row for row in shown if row]


def _plots(*rows: tuple[str, ...]) -> Callable[[Study], bytes]:
    """Function that draws a stack of plots of these quantities as PNG."""
    return lambda study: curves_file(study, plot_rows(study, rows), ".png")


def curves_file(
    study: Study,
    rows: Sequence[Sequence[Quantity]],
    ending: str,
    marks: bool = True,
    companions: Companions = no_companions,
    sheet: Callable[..., PaperSheet] = PlotStack,
) -> bytes:
    """Plots over one turn as a file, ``.png`` or ``.svg``; parameters as for `PlotStack`.

    Raises
    ------
    NoSolution
        Where a quantity has no solution.
    """
    unseen = 0.0 if ending == ".svg" else UNSEEN / RATIO
    return widget_file(sheet(study, rows, paper_theme(ending), unseen, marks, companions), ending, study.design.name)


MOTION = (("displacement",), ("velocity",), ("acceleration",), ("jerk",))
CAM = (("pressure_angle",), ("pitch_curvature",), ("radius",), ("surface_curvature",), ("sliding",))
FORCES = (("contact_force",), ("drive_torque", "motor_torque", "linear_motor_torque"), ("guide_force",))

PICTURES: Mapping[str, Callable[[Study], bytes]] = MappingProxyType(
    {
        "mechanism.png": partial(_mechanism_file, ".png"),
        "mechanism.svg": partial(_mechanism_file, ".svg"),
        "motion.png": _plots(*MOTION),
        "cam.png": _plots(*CAM),
        "forces.png": _plots(*FORCES),
    }
)


def chart_file(chart: Chart, ending: str) -> bytes:
    """Stability chart as a file, ``.png`` or ``.svg``."""
    return widget_file(chart_plot(chart, paper_theme(ending), *SHEET_OF_CHART), ending, chart.name)


def chart_plot(chart: Chart, theme: Theme, width: int, height: int) -> ChartPlot:
    """Plot of a stability chart for files, of a size in pixels."""
    from kindyna_gui.pictures.plots.stability_chart import ChartPlot  # slow to load, and needed for charts only

    plot = ChartPlot(theme=theme)
    plot.resize(width, height)
    plot.show_chart(chart)
    plot.grab()  # drawing once determines the sizes of the axes
    plot.show_chart(chart)
    return plot


# -- images of a snapshot --------------------------------------------------------------------------------


def _centres_file(snapshot: Snapshot, ending: str) -> bytes:
    """Mechanism with all instant centres, their construction lines, and the velocity ratios from link to link."""
    scene = MechanismScene(None, paper_theme(ending), ENLARGED if ending == ".svg" else 1.0, still=True)
    for layer in ("centres", "kennedy", "velocities", "chain"):
        scene.set_layer(layer, True)
    scene.update_study(snapshot.study)
    scene.set_angle(radians(snapshot.angle_deg))
    return widget_file(MechanismSheet(scene, *SHEET), ending, snapshot.study.design.name)


def _polygon_file(snapshot: Snapshot, ending: str) -> bytes:
    """Velocity polygon."""
    sheet = polygon_sheet(snapshot.study, snapshot.angle_deg)
    return widget_file(sheet, ending, snapshot.study.design.name)


def polygon_sheet(study: Study, angle_deg: float) -> PolygonSheet:
    """Velocity polygon at an angle, with its scale for the full turn."""
    sheet = PolygonSheet()
    sheet.resize(*SHEET_OF_POLYGON)
    sheet.set_box(velocity_box(velocity_polygon(study.linkage), study.omega))
    at_angle = study.at_theta(np.array([radians(angle_deg)]))
    name = f"{study.angle_name.capitalize()} {number(angle_deg, 1)}°"
    sheet.show_diagram(velocity_diagram(velocity_polygon(at_angle.linkage), study.omega), name)
    return sheet


SNAPSHOTS: Mapping[str, Callable[[Snapshot, str], bytes]] = MappingProxyType(
    {"centres": _centres_file, "velocity_polygon": _polygon_file}
)


# -- thumbnails ------------------------------------------------------------------------------------------


def _mechanism(design: Design, width: int, height: int) -> MechanismSheet:
    scene = MechanismScene()
    for layer in EVERY_LAYER:
        scene.set_layer(layer, layer not in _OMITTED_LAYERS and EVERY_LAYER[layer].shown)
    scene.update_study(Study(design, SAMPLES))
    assert scene.overlay is not None
    scene.overlay.angle.hide()
    scene.set_fraction(FRACTION)
    return MechanismSheet(scene, width, height, scene.fill(width, height))


def _drives(design: Design, width: int, height: int) -> MechanismSheet:
    scene = Assembly()
    scene.show_shaft(Study(design, SAMPLES).camshaft, 0, about_shaft=False, layers=OUTLINE_LAYER)
    for part in (scene.overlay.angle, scene.overlay.bar, *(figure.tag for figure in scene.figures.values())):
        part.hide()
    scene.set_fraction(FRACTION)
    scene.fit(width, height)  # chooses the number of drives in a row
    drives = scene.fit_rect()
    scale = min(width / drives.width(), height / drives.height())
    room = QRectF(0.0, 0.0, width / scale, height / scale)
    room.moveCenter(drives.center())
    return MechanismSheet(scene, width, height, (room, scale))


@lru_cache(maxsize=128)
def thumbnail(design: Design, width: int, height: int, ratio: float = 1.0) -> QImage:
    """Small image of the mechanism, or of all drives, without texts; empty where it has no position."""
    image = QImage(QSize(width, height) * ratio, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(ratio)
    image.fill(Qt.GlobalColor.white)
    try:
        sheet = (_drives if design.listed else _mechanism)(design, width, height)
    except KindynaError:
        return image
    paint_on(image, _painting(sheet))
    sheet.deleteLater()
    return image
