"""Drawing of all drives of a shaft at one machine angle, next to each other or about their common shaft."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import degrees
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainterPath, QTransform
from PySide6.QtWidgets import QGraphicsEllipseItem, QGraphicsItem, QGraphicsPathItem, QGraphicsScene

from core.design import Outline as OutlineRow
from core.errors import KindynaError, NoSolution
from core.motion import TURN
from core.motion.program import ShaftPosition
from core.numerics.derivatives import ISOMETRIC, seen_from
from core.output.drawing.palette import BLUE
from core.study import Camshaft, Study
from kindyna_gui.pictures.drawing import cam_parts, load_parts, mechanism, parts
from kindyna_gui.pictures.drawing.cam_parts import (
    COLOURINGS,
    ColouredLoop,
    colour_scale,
    coloured_profile,
    on_cam,
    reading_at,
)
from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.drawing.mechanism import MARGIN_UNITS
from kindyna_gui.pictures.drawing.overlay import FIELDS, Group, Overlay, VectorUnit, arrows
from kindyna_gui.pictures.items import DrawnPart, Loop, Tag
from kindyna_gui.pictures.shapes import outline
from kindyna_gui.pictures.style import BALANCE, SCREEN, TEXT, Theme, rgb

if TYPE_CHECKING:
    from core.study.clearances import Clearances

BUILDERS = (cam_parts.cam, parts.roller, parts.linkage, cam_parts.in_space)


def vector_parts(layer: str, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """Arrows of a vector layer."""
    yield from arrows(FIELDS[layer](geometry), layer, geometry, theme)


DRIVE_LAYERS: Mapping[str, Callable[[Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {"loads": load_parts.loads, "masses": load_parts.masses}
)
"""Layers that every drive shows."""
SELECTED_LAYERS: Mapping[str, Callable[[Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {
        **{layer: partial(coloured_profile, layer) for layer in COLOURINGS},
        **{layer: partial(vector_parts, layer) for layer in FIELDS},
    }
)
"""Layers that only the selected drive shows, because the drawing has one set of scales."""
OMITTED_LAYERS = frozenset({"labels", "pitch", "base", "normal", "centre"})
"""Layers that are omitted because they would clutter a drawing of several mechanisms."""
TINT = 0.22  # fraction of a drive's colour in the fill of its cam
ASPECT = 1.4  # width to height of the view before its size is known
GAP = 14.0  # pixels between names in a row
BACK_OPACITY = 0.75  # opacity of the drives behind the selected one, about the common shaft
BALANCER = "Balance cam"
TRANSFERRED = "transferred part"
AXIS_PART = 0.15  # length of an axis along which a path does not extend, by the path's largest extent


class _Root(Group):
    """Parent item of all parts of one drive."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


class DriveFigure:
    """One drive of the drawing: its parts under one item, mirrored for a drive seen from its other end."""

    def __init__(
        self,
        number: int,
        name: str,
        study: Study,
        shaft_position: ShaftPosition,
        mirrored: bool,
        colour: str,
        theme: Theme,
        layers: tuple[str, ...],
        clearances: Clearances | None = None,
    ) -> None:
        self.name, self.study, self.shaft_position = name, study, shaft_position
        self.mirrored, self.layers = mirrored, layers
        self.geometry = Geometry(study)
        self.root = _Root(number)
        mixed = (round(p + TINT * (i - p)) for p, i in zip(rgb(theme.paper), rgb(colour), strict=True))
        drive_theme = replace(theme, cam=QColor(*mixed).name(), cam_line=colour, second_line=colour)
        builders = (*BUILDERS, *({**DRIVE_LAYERS, **SELECTED_LAYERS}[layer] for layer in layers))
        built = (part for builder in builders for part in builder(self.geometry, drive_theme))
        self.parts = [part for part in built if not OMITTED_LAYERS & set(part.layers)]
        self.outlines = () if clearances is None else clearances.design.outlines
        if clearances is not None:
            from kindyna_gui.pictures.drawing import outline_parts  # few designs have outlines

            self.parts += outline_parts.body_outlines(clearances, number, self.geometry, theme)
        for part in self.parts:
            part.item.setZValue(part.z)
            part.item.setParentItem(self.root)
        self.loops = [part.item for part in self.parts if isinstance(part.item, Loop)]
        self.ribbons = [part.item for part in self.parts if isinstance(part.item, ColouredLoop)]
        self._extent = mechanism.full_extent(self.geometry, self.parts)
        self.tag = Tag(name, theme.text_colour(colour), theme, TEXT, lean=(0.5, 0.3), backing=True)
        self.tag.setZValue(15.0)
        self.corner, self.index = 0j, 0

    def local(self, point: complex) -> complex:
        """Transform a point of the scene [mm] into the drive's frame, seen from the drive's end."""
        offset = point - self.corner
        return -offset.conjugate() if self.mirrored else offset

    def on_cam(self, point: complex) -> bool:
        """Whether a point of the scene [mm] is on the drive's cam."""
        return on_cam(self.geometry, self.index, self.local(point))

    def scene_point(self, point: complex) -> complex:
        """Transform a point of the drive's frame [mm] into the scene."""
        return self.corner + (-point.conjugate() if self.mirrored else point)

    @property
    def axis(self) -> complex:
        """Axis of the drive's cam in the scene [mm]."""
        return self.scene_point(self.geometry.axis)

    @property
    def rect(self) -> QRectF:
        """Extent of the drive about its shaft [mm], seen from this end."""
        box = self._extent
        return QRectF(-box.right(), box.top(), box.width(), box.height()) if self.mirrored else QRectF(box)

    def put(self, corner: complex) -> None:
        """Place the shaft at a point of the scene [mm]."""
        self.corner = corner
        side = -1.0 if self.mirrored else 1.0
        self.root.setTransform(QTransform(side, 0.0, 0.0, 1.0, corner.real, corner.imag))
        box = self.rect
        self.tag.setPos(QPointF(corner.real + box.center().x(), corner.imag + box.top()))

    def move(self, machine: float) -> None:
        """Move to the sample nearest to a machine angle [rad]."""
        self.index = self.geometry.nearest(float(self.shaft_position.drive_angle(np.array([machine]))[0]))
        for part in self.parts:
            if part.move is not None:
                part.move(self.index)

    def shows(
        self, study: Study, mirrored: bool, name: str, layers: tuple[str, ...], outlines: tuple[OutlineRow, ...]
    ) -> bool:
        """Whether the figure already shows this drive; the position on the shaft does not matter."""
        if (mirrored, name, layers, outlines) != (self.mirrored, self.name, self.layers, self.outlines):
            return False
        if study is self.study:
            return True
        same = not layers or (
            set(layers) <= set(DRIVE_LAYERS) and study.design.drive.loads == self.study.design.drive.loads
        )
        return same and Geometry(study).has_same_positions(self.geometry)


class TransferFigure:
    """Isometric drawing of the path along which the drives move a part, and of the part, to the scale of the drives."""

    def __init__(self, path: np.ndarray, theme: Theme) -> None:
        self.path = path
        low = path.min(axis=0)
        self._projected = seen_from(path - low, *ISOMETRIC)
        reach = np.maximum(np.ptp(path, axis=0), AXIS_PART * float(np.ptp(path, axis=0).max()))
        ends = seen_from(np.diag(reach), *ISOMETRIC)
        axes, floor = QPainterPath(), path - low
        for end in ends.tolist():
            axes.moveTo(0.0, 0.0)
            axes.lineTo(end.real, end.imag)
        floor[:, 2] = 0.0
        self.root = QGraphicsPathItem(outline(self._projected))
        self.root.setPen(theme.pen(theme.seen(BLUE)))
        for shape, colour in ((axes, theme.quiet), (outline(seen_from(floor, *ISOMETRIC)), theme.quiet)):
            item = QGraphicsPathItem(shape, self.root)
            item.setPen(theme.pen(colour))
            item.setFlag(QGraphicsItem.GraphicsItemFlag.ItemStacksBehindParent)
        for end, name in zip(ends.tolist(), "xyz", strict=True):
            axis_name = Tag(name, theme.quiet, theme, lean=(0.5, 0.5) if name == "z" else (0.5, 0.0))
            axis_name.setParentItem(self.root)
            axis_name.setPos(QPointF(end.real, end.imag))
        self.part = QGraphicsEllipseItem(-4.0, -4.0, 8.0, 8.0, self.root)
        self.part.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
        self.part.setBrush(QColor(theme.text_colour(BLUE)))
        self.part.setPen(theme.pen(theme.ink))
        self.tag = Tag(TRANSFERRED, theme.text_colour(BLUE), theme, TEXT, lean=(0.5, 0.3), backing=True)
        self.tag.setZValue(15.0)
        box = self.root.path().boundingRect().united(axes.boundingRect())
        room = 0.15 * max(box.width(), box.height())
        self.rect = box.adjusted(-room, -room, room, room)
        self.corner = 0j

    def put(self, corner: complex) -> None:
        """Place the lower left corner at a point of the scene [mm]."""
        self.corner = corner
        self.root.setPos(corner.real, corner.imag)
        self.tag.setPos(QPointF(corner.real + self.rect.center().x(), corner.imag + self.rect.top()))

    def move(self, machine: float) -> None:
        """Move the part to its position at a machine angle [rad]."""
        position = complex(self._projected[round(machine / TURN * self._projected.size) % self._projected.size])
        self.part.setPos(position.real, position.imag)


class Assembly(QGraphicsScene):
    """The drives of a shaft in mm, y upwards; ``missing`` names the drives without a solution, which are not drawn.

    The scene has the interface of a ``MechanismScene``; its joints cannot be dragged (``geometry`` is None).
    """

    geometry: Geometry | None = None
    index = 0

    def __init__(self, theme: Theme = SCREEN, about_shaft: bool = False) -> None:
        super().__init__()
        self.setItemIndexMethod(QGraphicsScene.ItemIndexMethod.NoIndex)
        self.setBackgroundBrush(QColor(theme.paper))
        self.theme, self.about_shaft = theme, about_shaft
        self.figures: dict[int, DriveFigure] = {}
        self.transfer: TransferFigure | None = None
        self._machine_parts: list[DrawnPart] = []
        self.missing: tuple[str, ...] = ()
        self._extent = QRectF(-100.0, -100.0, 200.0, 200.0)
        self._region: tuple[QRectF, float] | None = None
        self._machine = 0.0
        self._mouse: tuple[complex, float] | None = None
        self._selected = 0
        self._aspect = ASPECT
        self.overlay = Overlay(theme, self.addItem)
        self.overlay.angle_name = "machine angle"

    # -- drives and layers -----------------------------------------------------------------------------

    def show_shaft(
        self,
        shaft: Camshaft[Study],
        selected: int,
        about_shaft: bool,
        layers: Collection[str] = ("loads", *parts.OUTLINE_LAYER),
    ) -> None:
        """Draw the drives with layers of ``DRIVE_LAYERS`` and ``SELECTED_LAYERS``; unchanged figures are reused."""
        drive_layers = tuple(layer for layer in DRIVE_LAYERS if layer in layers)
        selected_layers = tuple(layer for layer in SELECTED_LAYERS if layer in layers)
        rows = list(_rows(shaft, self.theme))
        has_outlines = bool(shaft.design.outlines) and parts.OUTLINE_LAYER[0] in layers and not shaft.failures
        clearances = _clearances(shaft) if has_outlines else None
        outlines = shaft.design.outlines if has_outlines else ()
        self.missing = tuple(name for _, name, study, _, _, _ in rows if study is None)
        figures: dict[int, DriveFigure] = {}
        for number, name, study, position, mirrored, colour in rows:
            if study is None:
                continue
            figure, shown = self.figures.get(number), drive_layers + selected_layers * (number == selected)
            if figure is None or not figure.shows(study, mirrored, name, shown, outlines):
                own = clearances if number < len(shaft.drives) else None
                figure = DriveFigure(number, name, study, position, mirrored, colour, self.theme, shown, own)
                self.addItem(figure.root)
                self.addItem(figure.tag)
            figure.shaft_position = position
            figures[number] = figure
        for number, figure in self.figures.items():
            if figures.get(number) is not figure:
                self.removeItem(figure.root)
                self.removeItem(figure.tag)
        self.figures, self.about_shaft, self._selected = figures, about_shaft, selected
        self._show_transfer(shaft)
        self._show_nearest(clearances)
        self._place()
        self._lay_scales(selected_layers)
        if self._region is not None:
            self.show_region(*self._region)
        self.set_machine(self._machine)

    def _show_nearest(self, clearances: Clearances | None) -> None:
        """Draw the frame's outlines and the line between the nearest bodies, which have their positions about the common shaft."""
        for part in self._machine_parts:
            self.removeItem(part.item)
        self._machine_parts = []
        if clearances is not None and self.about_shaft:
            from kindyna_gui.pictures.drawing import outline_parts  # few designs have outlines

            nearest = outline_parts.NearestPart(clearances, self.theme)
            new_parts = (*outline_parts.frame_outlines(clearances, self.theme), *nearest.parts(lambda _: self._machine))
            self._machine_parts = list(new_parts)
        for part in self._machine_parts:
            part.item.setZValue(part.z)
            self.addItem(part.item)

    def _show_transfer(self, shaft: Camshaft[Study]) -> None:
        """Draw the transfer path next to the drives; about the common shaft it has no room."""
        try:
            path = shaft.transfer_path * 1e3 if shaft.has_transfer_path and not self.about_shaft else None
        except KindynaError:
            path = None
        if path is not None and self.transfer is not None and np.array_equal(path, self.transfer.path):
            return
        if self.transfer is not None:
            self.removeItem(self.transfer.root)
            self.removeItem(self.transfer.tag)
        self.transfer = None if path is None else TransferFigure(path, self.theme)
        if self.transfer is not None:
            self.addItem(self.transfer.root)
            self.addItem(self.transfer.tag)

    @property
    def _cells(self) -> list[DriveFigure | TransferFigure]:
        """The figures that are placed next to each other."""
        return [*self.figures.values(), *([] if self.transfer is None else [self.transfer])]

    def _lay_scales(self, layers: tuple[str, ...]) -> None:
        """Lay the scales of the selected drive's colours and vectors in the corner, one for each quantity."""
        self.overlay.drop_colours(self.removeItem)
        self.overlay.drop_scales(self.removeItem)
        figure = self.figures.get(self._selected)
        if figure is None:
            return
        for layer in layers:
            scale = colour_scale(layer, figure.geometry, self.theme)
            if scale is not None:
                self.overlay.add_colours(layer, scale)
            field = FIELDS[layer](figure.geometry) if layer in FIELDS else None
            if field is not None and field.family not in {arrow.family for arrow in self.overlay.vectors.values()}:
                length = field.mm_per_unit(figure.geometry)
                self.overlay.add_scale(VectorUnit(layer, field.family, field.unit, length))

    def _place(self) -> None:
        for number, figure in self.figures.items():
            front = number == self._selected
            figure.root.setZValue(1.0 if front else 0.0)
            figure.root.setOpacity(BACK_OPACITY if self.about_shaft and not front else 1.0)
        for cell, corner in zip(self._cells, self._corners(), strict=True):
            cell.put(corner)
        self._name()
        boxes = [cell.rect.translated(cell.corner.real, cell.corner.imag) for cell in self._cells]
        if boxes:
            extent = boxes[0]
            for box in boxes[1:]:
                extent = extent.united(box)
            self._extent = extent
        self.setSceneRect(self._extent)

    def _name(self) -> None:
        """Place each name below its drive; about a common shaft all names are in a row below the lowest drive."""
        figures = list(self.figures.values())
        widths = [figure.tag.size[0] + GAP for figure in figures]
        lowest, middle = min((f.rect.top() + f.corner.imag for f in figures), default=0.0), 0.0
        x = -0.5 * sum(widths)
        for figure, width in zip(figures, widths, strict=True):
            if self.about_shaft:
                figure.tag.setPos(QPointF(middle, lowest))
            figure.tag.shift(x + 0.5 * width if self.about_shaft else 0.0, 0.0)
            x += width

    def _corners(self) -> list[complex]:
        """Positions of the drives [mm]: all axes at the origin, or in as many rows as make the drawing largest."""
        cells = self._cells
        if self.about_shaft or not cells:
            return [figure.corner - figure.axis for figure in self.figures.values()]
        layouts = [_grid([cell.rect for cell in cells], columns) for columns in range(1, len(cells) + 1)]
        return min(layouts, key=lambda layout: max(layout[1].real / self._aspect, layout[1].imag))[0]

    # -- motion ----------------------------------------------------------------------------------------

    def set_machine(self, machine: float) -> None:
        """Move all drives to a machine angle [rad]."""
        self._machine = machine
        for cell in self._cells:
            cell.move(machine)
        for part in self._machine_parts:
            if part.move is not None:
                part.move(0)
        self.overlay.show_angle(degrees(machine))
        if self._mouse is not None:
            self.read_profile(*self._mouse)

    def set_fraction(self, fraction: float) -> None:
        """Move to a fraction of a turn of the machine."""
        self.set_machine(fraction * TURN)

    def number_at(self, point: QPointF) -> int | None:
        """Number of the drive with a part at a point [mm], else of the drive whose extent contains it, else None."""
        for item in self.items(point):
            root = item.topLevelItem()
            if isinstance(root, _Root):
                return root.number
        inside = [n for n, f in self.figures.items() if f.rect.translated(f.corner.real, f.corner.imag).contains(point)]
        return inside[0] if inside else None

    @property
    def _front(self) -> list[int]:
        """Numbers of the drives, the selected one first, because it covers the others about the common shaft."""
        return sorted(self.figures, key=lambda number: number != self._selected)

    def cam_at(self, point: complex) -> int | None:
        """Number of the drive whose cam contains a point [mm]; None where no cam does."""
        return next((number for number in self._front if self.figures[number].on_cam(point)), None)

    def read_profile(self, point: complex | None, reach: float = 0.0) -> None:
        """Show the values of the nearest profile point within ``reach`` [mm] of a point [mm]; None shows no values."""
        self._mouse, text = None if point is None else (point, reach), ""
        for number in self._front if point is not None else ():
            figure = self.figures[number]
            reading = reading_at(figure.geometry, figure.index, figure.local(point or 0j), reach)
            if reading is not None:
                text = f"{figure.name}: {reading.text}"
                break
        self.overlay.show_reading(text)

    # -- view ------------------------------------------------------------------------------------------

    def fit_rect(self) -> QRectF:
        """Rectangle that contains all drives over the turn [mm]."""
        return QRectF(self._extent)

    def least_rect(self) -> QRectF:
        """Rectangle that a well fitted view must contain [mm]."""
        half = 0.5 * MARGIN_UNITS * min((f.geometry.unit for f in self.figures.values()), default=0.0)
        return self._extent.adjusted(half, half, -half, -half)

    def fit(self, width: float, height: float) -> tuple[QRectF, float]:
        """Visible rectangle [mm] and scale [pixels per mm] at which all drives fit a view of this size [pixels]."""
        aspect = width / max(height, 1.0)
        if aspect != self._aspect and not self.about_shaft:  # the rows follow the shape of the view
            self._aspect = aspect
            self._place()
        return mechanism.fitted(self._extent, width, height)

    def show_region(self, visible: QRectF, scale: float, keep_labels: bool = False) -> None:
        """Lay the scale bar and the texts for a view of ``visible`` [mm] at ``scale`` [pixels per mm]."""
        self._region = (visible, scale)
        for figure in self.figures.values():
            for loop in figure.loops:
                loop.look(scale * self.theme.ratio)
            for ribbon in figure.ribbons:
                ribbon.look(scale)
        self.overlay.lay(visible, scale)
        self.overlay.show_angle(degrees(self._machine))

    def update_style(self) -> bool:
        """Take over the current fonts and remove all figures, so that they are drawn again in the current theme."""
        for item in self.items():
            if isinstance(item, Tag):
                item.update_font()
        cells = self._cells
        self.figures, self.transfer = {}, None
        self._show_nearest(None)
        for cell in cells:
            self.removeItem(cell.root)
            self.removeItem(cell.tag)
        return True

    def lay_labels(self) -> None:
        """Do nothing: the names of the drives keep their positions."""


def _clearances(shaft: Camshaft[Study]) -> Clearances:
    from core.study.clearances import Clearances  # few designs have outlines

    return Clearances(shaft)


def _grid(boxes: Sequence[QRectF], columns: int) -> tuple[list[complex], complex]:
    """Corners of boxes in rows of ``columns``, with the shafts of a row at one height; and the size of the grid."""
    corners: list[complex] = []
    top = width = 0.0
    for start in range(0, len(boxes), columns):
        row = boxes[start : start + columns]
        above, below = max(box.bottom() for box in row), max(-box.top() for box in row)
        x = 0.0
        for box in row:
            corners.append(complex(x - box.left(), top - above))
            x += box.width()
        width = max(width, x)
        top -= above + below
    return corners, complex(width, -top)


def _rows(shaft: Camshaft[Study], theme: Theme) -> Iterator[tuple[int, str, Study | None, ShaftPosition, bool, str]]:
    """Number, name, study (None without a solution), position, mirroring, colour of each drive and the balance cam."""
    for number, ((name, study), drive) in enumerate(zip(shaft.drives.items(), shaft.design.drives, strict=True)):
        solved: Study | None = study
        try:
            _ = study.linkage
        except NoSolution:
            solved = None
        yield number, name, solved, shaft.positions[name], drive.mirrored, theme.drive(number)
    if shaft.design.balancer is None:
        return
    try:
        cam = shaft.balancer
        yield len(shaft.drives), BALANCER, cam, shaft.balancer_position, False, theme.seen(BALANCE)
    except NoSolution:
        yield len(shaft.drives), BALANCER, None, ShaftPosition(), False, theme.seen(BALANCE)


__all__ = ["DRIVE_LAYERS", "SELECTED_LAYERS", "Assembly", "DriveFigure"]
