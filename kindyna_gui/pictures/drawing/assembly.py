"""Several drives on one shaft drawn together: beside each other, or about their common shaft; at one machine angle."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import degrees
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainterPath, QTransform
from PySide6.QtWidgets import QGraphicsEllipseItem, QGraphicsItem, QGraphicsPathItem, QGraphicsScene

from core.errors import KindynaError, NoSolution
from core.motion import TURN
from core.motion.program import ShaftPosition
from core.numerics.derivatives import ISOMETRIC, seen_from
from core.study import Camshaft, Study
from kindyna_gui.pictures.drawing import cam_parts, load_parts, mechanism, parts
from kindyna_gui.pictures.drawing.cam_parts import COLOURINGS, ColouredLoop, coloured, on_cam, reading_at, scale_of
from kindyna_gui.pictures.drawing.geometry import Geometry
from kindyna_gui.pictures.drawing.mechanism import MARGIN_UNITS
from kindyna_gui.pictures.drawing.overlay import FIELDS, Overlay, VectorUnit, arrows
from kindyna_gui.pictures.items import DrawnPart, Loop, Tag
from kindyna_gui.pictures.shapes import outline
from kindyna_gui.pictures.style import BALANCE, BLUE, SCREEN, TEXT, Theme, rgb

BUILDERS = (cam_parts.cam, parts.roller, parts.linkage)


def vectors_of(layer: str, geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    """The arrows of a layer of vectors."""
    yield from arrows(FIELDS[layer](geometry), layer, geometry, theme)


OF_EACH: Mapping[str, Callable[[Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {"loads": load_parts.loads, "masses": load_parts.masses}
)
"""Layers that each drive shows."""
OF_CHOSEN: Mapping[str, Callable[[Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {
        **{layer: partial(coloured, layer) for layer in COLOURINGS},
        **{layer: partial(vectors_of, layer) for layer in FIELDS},
    }
)
"""Layers that the chosen drive shows: its scales are the only ones."""
LEFT_OUT = frozenset({"labels", "pitch", "base", "normal", "centre"})
"""Layers that would make a thicket of several mechanisms."""
TINT = 0.22  # of a drive's colour in the fill of its cam
ASPECT = 1.4  # of a picture whose size is not known yet: width to height
GAP = 14.0  # pixels between names in a row
SEEN_THROUGH = 0.75  # opacity of drives behind the chosen one, about the common shaft
BALANCER = "Balance cam"
CARRIED = "carried part"
AXIS_PART = 0.15  # of the largest extent of a path: the length of an axis along which it does not go


class _Root(QGraphicsItem):
    """Holds what is drawn of one drive."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number
        self.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents)

    def boundingRect(self) -> QRectF:
        return QRectF()

    def paint(self, *_: object) -> None:
        """Nothing of its own."""


class DriveFigure:
    """One drive as it is drawn: its parts under one item, which a mirrored one turns over, for it is seen from this end."""

    def __init__(
        self,
        number: int,
        name: str,
        study: Study,
        place: ShaftPosition,
        mirrored: bool,
        colour: str,
        theme: Theme,
        layers: tuple[str, ...],
    ) -> None:
        self.name, self.study, self.place, self.mirrored, self.layers = name, study, place, mirrored, layers
        self.geometry = Geometry(study)
        self.root = _Root(number)
        own = replace(theme, cam=_tinted(colour, theme), cam_line=colour, second_line=colour)
        builders = (*BUILDERS, *({**OF_EACH, **OF_CHOSEN}[layer] for layer in layers))
        built = (
            part for builder in builders for part in builder(self.geometry, own) if not LEFT_OUT & set(part.layers)
        )
        self.parts: list[DrawnPart] = []
        for part in built:
            part.item.setZValue(part.z)
            part.item.setParentItem(self.root)
            self.parts.append(part)
        self.loops = [part.item for part in self.parts if isinstance(part.item, Loop)]
        self.ribbons = [part.item for part in self.parts if isinstance(part.item, ColouredLoop)]
        self._whole = mechanism.whole(self.geometry, self.parts)
        self.tag = Tag(name, theme.letters(colour), theme, TEXT, lean=(0.5, 0.3), backing=True)
        self.tag.setZValue(15.0)
        self.corner, self.index = 0j, 0

    def local(self, at: complex) -> complex:
        """A place of the scene in its own frame, as it is seen from its own end [mm]."""
        own = at - self.corner
        return -own.conjugate() if self.mirrored else own

    def on_cam(self, at: complex) -> bool:
        """Whether a place of the scene lies on its cam."""
        return on_cam(self.geometry, self.index, self.local(at))

    @property
    def rect(self) -> QRectF:
        """What it takes about its shaft [mm], as seen from this end."""
        whole = self._whole
        return QRectF(-whole.right(), whole.top(), whole.width(), whole.height()) if self.mirrored else QRectF(whole)

    def put(self, corner: complex) -> None:
        """Its shaft at a place of the scene [mm]."""
        self.corner = corner
        side = -1.0 if self.mirrored else 1.0
        self.root.setTransform(QTransform(side, 0.0, 0.0, 1.0, corner.real, corner.imag))
        box = self.rect
        self.tag.setPos(QPointF(corner.real + box.center().x(), corner.imag + box.top()))

    def move(self, machine: float) -> None:
        """To the sample nearest to where it stands at a machine angle [rad]."""
        self.index = self.geometry.nearest(float(self.place.drive_angle(np.array([machine]))[0]))
        for part in self.parts:
            if part.move is not None:
                part.move(self.index)

    def shows(self, study: Study, mirrored: bool, name: str, layers: tuple[str, ...]) -> bool:
        """Whether this is what is drawn already, wherever on the shaft it stands."""
        if (mirrored, name, layers) != (self.mirrored, self.name, self.layers):
            return False
        if study is self.study:
            return True
        same = not layers or (set(layers) <= set(OF_EACH) and study.design.drive.loads == self.study.design.drive.loads)
        return same and Geometry(study).same_places(self.geometry)


class CarriedFigure:
    """The path in space of the part that the drives carry together, from above and aside, to the scale of the drives; and the part."""

    def __init__(self, path: np.ndarray, theme: Theme) -> None:
        self.path = path
        low = path.min(axis=0)
        self._seen = seen_from(path - low, *ISOMETRIC)
        reach = np.maximum(np.ptp(path, axis=0), AXIS_PART * float(np.ptp(path, axis=0).max()))
        ends = seen_from(np.diag(reach), *ISOMETRIC)
        axes, floor = QPainterPath(), path - low
        for end in ends.tolist():
            axes.moveTo(0.0, 0.0)
            axes.lineTo(end.real, end.imag)
        floor[:, 2] = 0.0
        self.root = QGraphicsPathItem(outline(self._seen))
        self.root.setPen(theme.pen(theme.seen(BLUE)))
        for shape, colour in ((axes, theme.quiet), (outline(seen_from(floor, *ISOMETRIC)), theme.quiet)):
            item = QGraphicsPathItem(shape, self.root)
            item.setPen(theme.pen(colour))
            item.setFlag(QGraphicsItem.GraphicsItemFlag.ItemStacksBehindParent)
        for end, name in zip(ends.tolist(), "xyz", strict=True):
            letter = Tag(name, theme.quiet, theme, lean=(0.5, 0.5) if name == "z" else (0.5, 0.0))
            letter.setParentItem(self.root)
            letter.setPos(QPointF(end.real, end.imag))
        self.part = QGraphicsEllipseItem(-4.0, -4.0, 8.0, 8.0, self.root)
        self.part.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
        self.part.setBrush(QColor(theme.letters(BLUE)))
        self.part.setPen(theme.pen(theme.ink))
        self.tag = Tag(CARRIED, theme.letters(BLUE), theme, TEXT, lean=(0.5, 0.3), backing=True)
        self.tag.setZValue(15.0)
        box = self.root.path().boundingRect().united(axes.boundingRect())
        room = 0.15 * max(box.width(), box.height())
        self.rect = box.adjusted(-room, -room, room, room)
        self.corner = 0j

    def put(self, corner: complex) -> None:
        """Its lowest corner at a place of the scene [mm]."""
        self.corner = corner
        self.root.setPos(corner.real, corner.imag)
        self.tag.setPos(QPointF(corner.real + self.rect.center().x(), corner.imag + self.rect.top()))

    def move(self, machine: float) -> None:
        """The part to where it is at a machine angle [rad]."""
        at = complex(self._seen[round(machine / TURN * self._seen.size) % self._seen.size])
        self.part.setPos(at.real, at.imag)


def _tinted(colour: str, theme: Theme) -> str:
    """Paper with some of a colour."""
    mixed = (round(p + TINT * (i - p)) for p, i in zip(rgb(theme.paper), rgb(colour), strict=True))
    return QColor(*mixed).name()


class Assembly(QGraphicsScene):
    """The drives of a shaft in mm, y upwards; those without an answer are left out, and named in ``missing``.

    It is shown as a ``MechanismScene`` is; no joint of it can be dragged (``geometry`` is None).
    """

    geometry: Geometry | None = None
    index = 0

    def __init__(self, theme: Theme = SCREEN, about_shaft: bool = False) -> None:
        super().__init__()
        self.setItemIndexMethod(QGraphicsScene.ItemIndexMethod.NoIndex)
        self.setBackgroundBrush(QColor(theme.paper))
        self.theme, self.about_shaft = theme, about_shaft
        self.figures: dict[int, DriveFigure] = {}
        self.carried: CarriedFigure | None = None
        self.missing: tuple[str, ...] = ()
        self._whole = QRectF(-100.0, -100.0, 200.0, 200.0)
        self._region: tuple[QRectF, float] | None = None
        self._machine = 0.0
        self._mouse: tuple[complex, float] | None = None
        self._chosen = 0
        self._aspect = ASPECT
        self.overlay = Overlay(theme, self.addItem)
        self.overlay.angle_name = "machine angle"

    # -- what is drawn --------------------------------------------------------------------------------------

    def show_shaft(
        self, shaft: Camshaft[Study], chosen: int, about_shaft: bool, layers: Collection[str] = ("loads",)
    ) -> None:
        """Draw these drives with these layers, rows of ``OF_EACH`` and ``OF_CHOSEN``; what stands as it did is left alone."""
        of_each = tuple(layer for layer in OF_EACH if layer in layers)
        of_chosen = tuple(layer for layer in OF_CHOSEN if layer in layers)
        rows = list(_rows(shaft, self.theme))
        self.missing = tuple(name for _, name, study, _, _, _ in rows if study is None)
        kept: dict[int, DriveFigure] = {}
        for number, name, study, place, mirrored, colour in rows:
            if study is None:
                continue
            figure, own = self.figures.get(number), of_each + of_chosen * (number == chosen)
            if figure is None or not figure.shows(study, mirrored, name, own):
                figure = DriveFigure(number, name, study, place, mirrored, colour, self.theme, own)
                self.addItem(figure.root)
                self.addItem(figure.tag)
            figure.place = place
            kept[number] = figure
        for number, figure in self.figures.items():
            if kept.get(number) is not figure:
                self.removeItem(figure.root)
                self.removeItem(figure.tag)
        self.figures, self.about_shaft, self._chosen = kept, about_shaft, chosen
        self._show_carried(shaft)
        self._place()
        self._lay_scales(of_chosen)
        if self._region is not None:
            self.show_region(*self._region)
        self.set_machine(self._machine)

    def _show_carried(self, shaft: Camshaft[Study]) -> None:
        """What the drives carry together stands beside them; about their common shaft there is no room for it."""
        try:
            path = shaft.transfer_path * 1e3 if shaft.has_transfer_path and not self.about_shaft else None
        except KindynaError:
            path = None
        if path is not None and self.carried is not None and np.array_equal(path, self.carried.path):
            return
        if self.carried is not None:
            self.removeItem(self.carried.root)
            self.removeItem(self.carried.tag)
        self.carried = None if path is None else CarriedFigure(path, self.theme)
        if self.carried is not None:
            self.addItem(self.carried.root)
            self.addItem(self.carried.tag)

    @property
    def _cells(self) -> list[DriveFigure | CarriedFigure]:
        """What stands beside each other."""
        return [*self.figures.values(), *([] if self.carried is None else [self.carried])]

    def _lay_scales(self, layers: tuple[str, ...]) -> None:
        """The scales of the chosen drive's colours and vectors in the corner; layers of one quantity have one."""
        self.overlay.drop_colours(self.removeItem)
        self.overlay.drop_scales(self.removeItem)
        figure = self.figures.get(self._chosen)
        if figure is None:
            return
        for layer in layers:
            scale = scale_of(layer, figure.geometry, self.theme)
            if scale is not None:
                self.overlay.add_colours(layer, scale)
            field = FIELDS[layer](figure.geometry) if layer in FIELDS else None
            if field is not None and field.family not in {arrow.family for arrow in self.overlay.vectors.values()}:
                length = field.mm_per_unit(figure.geometry)
                self.overlay.add_scale(VectorUnit(layer, field.family, field.unit, length))

    def _place(self) -> None:
        for number, figure in self.figures.items():
            front = number == self._chosen
            figure.root.setZValue(1.0 if front else 0.0)
            figure.root.setOpacity(SEEN_THROUGH if self.about_shaft and not front else 1.0)
        for cell, corner in zip(self._cells, self._corners(), strict=True):
            cell.put(corner)
        self._name()
        boxes = [cell.rect.translated(cell.corner.real, cell.corner.imag) for cell in self._cells]
        if boxes:
            whole = boxes[0]
            for box in boxes[1:]:
                whole = whole.united(box)
            self._whole = whole
        self.setSceneRect(self._whole)

    def _name(self) -> None:
        """Each name below its drive; about a common shaft, where one cam hides another, all in a row below the lowest."""
        figures = list(self.figures.values())
        widths = [figure.tag.size[0] + GAP for figure in figures]
        lowest, middle = min((f.rect.top() for f in figures), default=0.0), 0.0
        x = -0.5 * sum(widths)
        for figure, width in zip(figures, widths, strict=True):
            if self.about_shaft:
                figure.tag.setPos(QPointF(middle, lowest))
            figure.tag.shift(x + 0.5 * width if self.about_shaft else 0.0, 0.0)
            x += width

    def _corners(self) -> list[complex]:
        """Where the shafts stand [mm]: all at one place, or in as many rows as make the picture largest."""
        cells = self._cells
        if self.about_shaft or not cells:
            return [0j] * len(cells)
        layouts = [_grid([cell.rect for cell in cells], columns) for columns in range(1, len(cells) + 1)]
        return min(layouts, key=lambda each: max(each[1].real / self._aspect, each[1].imag))[0]

    # -- motion ---------------------------------------------------------------------------------------------

    def set_machine(self, machine: float) -> None:
        """Move all to where they stand at a machine angle [rad]."""
        self._machine = machine
        for cell in self._cells:
            cell.move(machine)
        self.overlay.show_angle(degrees(machine))
        if self._mouse is not None:
            self.read_profile(*self._mouse)

    def set_fraction(self, fraction: float) -> None:
        """Move to this part of a turn of the machine."""
        self.set_machine(fraction * TURN)

    def number_at(self, place: QPointF) -> int | None:
        """The drive whose parts are at a place [mm], or in whose room it lies; None where there is none."""
        for item in self.items(place):
            root = item.topLevelItem()
            if isinstance(root, _Root):
                return root.number
        inside = [n for n, f in self.figures.items() if f.rect.translated(f.corner.real, f.corner.imag).contains(place)]
        return inside[0] if inside else None

    @property
    def _front(self) -> list[int]:
        """The drives, the chosen one first, which lies before the others about the common shaft."""
        return sorted(self.figures, key=lambda number: number != self._chosen)

    def cam_at(self, at: complex) -> int | None:
        """The drive on whose cam a place lies [mm]; None where there is none."""
        return next((number for number in self._front if self.figures[number].on_cam(at)), None)

    def read_profile(self, at: complex | None, reach: float = 0.0) -> None:
        """Show the values at the place of a profile that lies nearest to ``at`` [mm], no farther than ``reach`` [mm]; None: no values."""
        self._mouse, text = None if at is None else (at, reach), ""
        for number in self._front if at is not None else ():
            figure = self.figures[number]
            reading = reading_at(figure.geometry, figure.index, figure.local(at or 0j), reach)
            if reading is not None:
                text = f"{figure.name}: {reading.text}"
                break
        self.overlay.show_reading(text)

    # -- sight ----------------------------------------------------------------------------------------------

    def fit_rect(self) -> QRectF:
        """The rectangle that holds all over the whole turn [mm]."""
        return QRectF(self._whole)

    def least_rect(self) -> QRectF:
        """What a picture must hold to be no worse than fitted."""
        half = 0.5 * MARGIN_UNITS * min((f.geometry.unit for f in self.figures.values()), default=0.0)
        return self._whole.adjusted(half, half, -half, -half)

    def fit(self, width: float, height: float) -> tuple[QRectF, float]:
        """What a picture of so many pixels shows of all: visible rectangle [mm] and scale [pixels per mm]."""
        aspect = width / max(height, 1.0)
        if aspect != self._aspect and not self.about_shaft:  # as many in a row as make the picture largest
            self._aspect = aspect
            self._place()
        return mechanism.fitted(self._whole, width, height)

    def show_region(self, visible: QRectF, scale: float, keep_labels: bool = False) -> None:
        """Lay scale bar and texts for a view that shows ``visible`` [mm] at ``scale`` [pixels per mm]."""
        self._region = (visible, scale)
        for figure in self.figures.values():
            for loop in figure.loops:
                loop.look(scale * self.theme.ratio)
            for ribbon in figure.ribbons:
                ribbon.look(scale)
        self.overlay.lay(visible, scale)
        self.overlay.show_angle(degrees(self._machine))

    def update_style(self) -> None:
        """Theme or letters have changed: the drives are to be drawn anew."""
        for item in self.items():
            if isinstance(item, Tag):
                item.update_font()
        cells = self._cells
        self.figures, self.carried = {}, None
        for cell in cells:
            self.removeItem(cell.root)
            self.removeItem(cell.tag)

    def lay_labels(self) -> None:
        """The names of the drives stand where they are."""


def _grid(boxes: Sequence[QRectF], columns: int) -> tuple[list[complex], complex]:
    """Corners of boxes in rows of so many, the shafts of a row at one height; and the size of the whole."""
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
    """Number, name, study (None without an answer), place, side and colour of each drive, the balance cam behind them."""
    for number, ((name, study), drive) in enumerate(zip(shaft.drives.items(), shaft.design.drives, strict=True)):
        there: Study | None = study
        try:
            _ = study.linkage
        except NoSolution:
            there = None
        yield number, name, there, shaft.positions[name], drive.mirrored, theme.drive(number)
    if shaft.design.balancer is None:
        return
    try:
        cam = shaft.balancer
        yield len(shaft.drives), BALANCER, cam, shaft.balancer_position, False, theme.seen(BALANCE)
    except NoSolution:
        yield len(shaft.drives), BALANCER, None, ShaftPosition(), False, theme.seen(BALANCE)


__all__ = ["OF_CHOSEN", "OF_EACH", "Assembly", "DriveFigure"]
