"""Scene of one mechanism: its layers, its motion, and the view that it fills.

Parts of layers that are rarely shown are drawn when the layer is first shown.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial
from math import degrees, radians
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QGraphicsItem, QGraphicsScene

from core.instant_centres import CentreTable
from core.instant_centres.construction import Key
from core.study import Study
from kindyna_gui.pictures.drawing import cam_parts, load_parts, overlay, parts
from kindyna_gui.pictures.drawing.cam_parts import COLOURINGS, ColouredLoop, colour_scale, coloured_profile, reading_at
from kindyna_gui.pictures.drawing.geometry import MM, Geometry, OutlinedDrive
from kindyna_gui.pictures.drawing.labels import Labels, Strokes, TextBox
from kindyna_gui.pictures.drawing.overlay import (
    BOTTOM_STRIP,
    FIELDS,
    TOP_STRIP,
    Overlay,
    VectorUnit,
    dimension_strokes,
    dimensions,
)
from kindyna_gui.pictures.drawing.parts import (
    COUPLER,
    DIMENSIONS,
    EVERY_LAYER,
    FORCE_LAYERS,
    LINKAGE_LAYERS,
    LOAD_LAYERS,
    STEP_LAYERS,
    TWIST,
    shaft,
)
from kindyna_gui.pictures.items import DrawnPart, Loop, Outline, Tag, Viewport
from kindyna_gui.pictures.shapes import circle
from kindyna_gui.pictures.style import OUTLINE, SCREEN, Theme, brush
from kindyna_gui.settings import sized

if TYPE_CHECKING:
    from kindyna_gui.pictures.drawing.centre_parts import LinkageLayers


# -- view ----------------------------------------------------------------------------------------------

FAR_CENTRES = 12.0  # instant centres farther away than this many sizes of the mechanism are not in the view
MARGIN_UNITS = 4.5  # around the moving parts, in units of the symbols
_FIXED_PARTS = ("rails", "ground", "pedestal", "rim", "dimensions", "outline")


def full_extent(geometry: Geometry, parts: Iterable[DrawnPart]) -> QRectF:
    """Rectangle that contains the moving parts, the ground and near instant centres over the turn [mm]."""
    low, high = geometry.core_box
    rect = QRectF(low.real, low.imag, (high - low).real, (high - low).imag)
    distance, spread = np.abs(geometry.reference), range(0, geometry.samples, max(1, geometry.samples // 8))
    samples = {
        "spring": spread,
        "load": spread,
        "outline": spread,
        "stem": (int(np.argmin(distance)), int(np.argmax(distance))),
    }
    for part in parts:
        kind = part.key.partition(".")[0]
        if part.move is None:
            rect = rect.united(part.item.boundingRect()) if kind in _FIXED_PARTS else rect
            continue
        for i in samples.get(kind, ()):
            part.move(i)
            rect = rect.united(part.item.sceneBoundingRect())
    q = geometry.near_centres
    if q.size:
        x, y = q.real, q.imag
        left, below = float(x.min()), float(y.min())
        rect = rect.united(QRectF(left, below, float(x.max()) - left + 1e-9, float(y.max()) - below + 1e-9))
    room = MARGIN_UNITS * geometry.unit
    return rect.adjusted(-room, -room, room, room)


def with_centres(rect: QRectF, table: CentreTable, index: int, only: Collection[Key] | None = None) -> QRectF:
    """Extend a rectangle [mm] by the instant centres at a sample, all or those of ``only``.

    Centres farther away than ``FAR_CENTRES`` sizes are left out, because the mechanism would shrink to a dot.
    """
    reach = FAR_CENTRES * max(rect.width(), rect.height())
    edge, middle = 0.03 * max(rect.width(), rect.height()), complex(rect.center().x(), rect.center().y())
    for key, centres in table.centres.items():
        if (only is not None and key not in only) or centres.is_far(table.size)[index]:
            continue
        centre = MM * complex(centres.finite[index])
        if abs(centre - middle) <= reach:
            rect = rect.united(QRectF(centre.real - edge, centre.imag - edge, 2.0 * edge, 2.0 * edge))
    return rect


def fitted(rect: QRectF, width: float, height: float, list_height: float = 0.0) -> tuple[QRectF, float]:
    """Visible rectangle [mm] and scale [pixels per mm] at which a rectangle fits a view between its strips of text.

    Parameters
    ----------
    rect : QRectF [mm]
    width, height : float [pixels]
        Size of the view.
    list_height : float [pixels]
        Height of a list at the top of the view.
    """
    top = sized(TOP_STRIP) + list_height
    room = max(height - top - sized(BOTTOM_STRIP), 0.3 * height)
    scale = min(width / rect.width(), room / rect.height())
    visible = _about(rect, width, height, scale)
    visible.translate(0.0, -0.5 * (sized(BOTTOM_STRIP) - top) / scale)
    return visible, scale


def filled(rect: QRectF, width: float, height: float) -> tuple[QRectF, float]:
    """Visible rectangle [mm] and scale [pixels per mm] at which a rectangle fits a view without strips of text."""
    scale = min(width / rect.width(), height / rect.height())
    return _about(rect, width, height, scale), scale


def _about(rect: QRectF, width: float, height: float, scale: float) -> QRectF:
    visible = QRectF(0.0, 0.0, width / scale, height / scale)
    visible.moveCenter(rect.center())
    return visible


# -- scene ---------------------------------------------------------------------------------------------

DEFAULT_SIZE = (900.0, 675.0)  # size of a view that is not given, pixels
DOT = 4.0  # radius of the mark at the profile point whose values are shown, pixels
Z_DOT = 12.0

BUILDERS: tuple[Callable[[Geometry, Theme], Iterator[DrawnPart]], ...] = (
    cam_parts.cam,
    parts.roller,
    parts.wheels,
    parts.linkage,
    cam_parts.contact,
    cam_parts.in_space,
)


def _outlines(geometry: Geometry, theme: Theme) -> Iterator[DrawnPart]:
    if geometry.study.design.outlines or geometry.outlined is not None:
        from kindyna_gui.pictures.drawing.outline_parts import outlines  # few designs have outlines

        yield from outlines(geometry, theme)


LAZY: Mapping[str, Callable[[Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {
        **{layer: partial(coloured_profile, layer) for layer in COLOURINGS},
        DIMENSIONS: dimensions,
        TWIST: shaft,
        "outlines": _outlines,
        "loads": load_parts.loads,
        "masses": load_parts.masses,
    }
)
"""Layers whose parts are drawn when the layer is first shown."""


class MechanismScene(QGraphicsScene):
    """The mechanism of a study in mm, y upwards; a view must invert y.

    ``set_index``, ``set_fraction`` and ``set_angle`` move the mechanism. ``show_region`` must be called with the
    visible rectangle and the scale, because texts and symbols have a size in pixels.

    Parameters
    ----------
    study : Study or None
    theme : Theme
    closest : float
        Magnification up to which curves are smooth.
    still : bool
        Place the labels for one angle only, because the mechanism will not move.

    Raises
    ------
    NoSolution
        Where the linkage of the study has no position.
    """

    def __init__(
        self, study: Study | None = None, theme: Theme = SCREEN, closest: float = 1.0, still: bool = False
    ) -> None:
        super().__init__()
        self.setItemIndexMethod(QGraphicsScene.ItemIndexMethod.NoIndex)
        self.setBackgroundBrush(QColor(theme.paper))
        self.theme = theme
        self.geometry: Geometry | None = None
        self.index = 0
        self.turn = 0  # number of the turn; with an advance each turn begins further on
        self._angle: float | None = None
        self.parts: dict[str, DrawnPart] = {}
        self._closest, self._still = closest, still
        self._lines: list[Loop] = []
        self._ribbons: list[ColouredLoop] = []
        self._extent = QRectF(-100.0, -100.0, 200.0, 200.0)
        self._shown = {name: layer.shown for name, layer in EVERY_LAYER.items()}
        self.outlined: OutlinedDrive | None = None  # of a drive of several, where their design has outlines
        self.paths: frozenset[str] = frozenset()  # points whose path is shown without its layer
        self._region: tuple[QRectF, float] | None = None
        self._labels: Labels | None = None
        self._fields: dict[str, overlay.Field] = {}
        self.viewport = Viewport()
        self.linkage_layers: LinkageLayers | None = None
        self._step: int | None = None
        self.overlay: Overlay | None = None
        self._drawn_layers: set[str] = set()
        self._mouse: tuple[complex, float] | None = None
        self._dot: Outline | None = None
        if study is not None:
            self.update_study(study)

    # -- study -----------------------------------------------------------------------------------------

    def update_study(self, study: Study, keep_labels: bool = False, lay: bool = True) -> None:
        """Draw another study at the same cam angle, with the same layers and view.

        Parameters
        ----------
        study : Study
        keep_labels : bool
            Leave labels on their sides, which is fast and does not flicker; ``lay_labels`` improves them later.
        lay : bool
            False where ``show_region`` follows immediately, so that texts are not placed twice.
        """
        geometry = Geometry(study, self.outlined)
        before, self.geometry = self.geometry, geometry
        if self._angle is not None:
            self.index = geometry.nearest(radians(self._angle))
        elif before is not None:
            self.index = round(self.index / before.samples * geometry.samples) % geometry.samples
        sides = self._labels.sides if self._labels is not None and keep_labels else {}
        had_vectors = bool(self._fields)
        self._drop_vectors()
        shows_forces = not self._drawn_layers.isdisjoint((*FORCE_LAYERS, TWIST))
        same = before is not None and geometry.has_same_positions(before) and not shows_forces
        if not same:
            self._rebuild(geometry)
        elif before is not None and not load_parts.has_same_loads(geometry, before, self._shown["masses"]):
            self._renew_loads()
        if geometry.has_numbered_links:
            from kindyna_gui.pictures.drawing.centre_parts import LinkageLayers

            self.linkage_layers = LinkageLayers(geometry, self.theme, self.viewport, self._texts, self._step)
        for layer in FIELDS:
            self._draw_vectors(layer)
        for layer in LINKAGE_LAYERS:
            self._draw_construction(layer)
        with_values = had_vectors or self._shown[DIMENSIONS]
        if self._fields or with_values or geometry.elements or self._shown["masses"] or self._shows_paths:
            self._make_room()
        self._show()
        if not lay or (self._region is None and keep_labels):
            self._move(self.index, self._angle)  # the view is not known yet
        elif not same or self._fields or with_values or not keep_labels:
            self._show_region(*(self._region or self.fit(*DEFAULT_SIZE)), sides)
        else:
            self._move(self.index, self._angle)

    def _rebuild(self, geometry: Geometry) -> None:
        """Draw all parts again; labels with unchanged texts keep their items."""
        same_labels = self._labels is not None and self._labels.renew(geometry)
        for key, part in self.parts.items():
            if not (same_labels and key.startswith("label.")):
                self.removeItem(part.item)
        self.parts = {}
        self._drawn_layers = set()
        if self.overlay is None:
            self.overlay = Overlay(self.theme, self.addItem)
        self.overlay.drop_colours(self.removeItem)
        self.overlay.angle_name = geometry.study.angle_name if geometry.has_numbered_links else "cam angle"
        for builder in BUILDERS:
            for part in builder(geometry, self.theme):
                self._add_part(part)
        if self._labels is None or not same_labels:
            self._labels = Labels(geometry, self.theme)
        for part in self._labels.parts():
            self._add_part(part)
        self._lines = [part.item for part in self.parts.values() if isinstance(part.item, Loop)]
        self._ribbons = []
        for layer in LAZY:
            self._draw_parts(layer)
        self._frame()

    def _renew_loads(self) -> None:
        """Draw the layers that depend on the loads only again."""
        for key in [key for key, part in self.parts.items() if not set(LOAD_LAYERS).isdisjoint(part.layers)]:
            self.removeItem(self.parts.pop(key).item)
        self._drawn_layers -= set(LOAD_LAYERS)
        for layer in LOAD_LAYERS:
            self._draw_parts(layer)
        self._frame()

    def _frame(self) -> None:
        """Update the extent for the layers that are shown."""
        assert self.geometry is not None
        shown = (part for part in self.parts.values() if self._shown[DIMENSIONS] or DIMENSIONS not in part.layers)
        self._extent = full_extent(self.geometry, shown)
        self.setSceneRect(self._extent)

    def _drop_vectors(self) -> None:
        for key in [key for key in self.parts if key.partition(".")[0] in FIELDS]:
            self.removeItem(self.parts.pop(key).item)
        if self.overlay is not None:
            self.overlay.drop_scales(self.removeItem)
        self._fields = {}
        for key in [key for key in self.parts if key.partition(".")[0] in LINKAGE_LAYERS]:
            self.removeItem(self.parts.pop(key).item)
        self.linkage_layers = None

    def _add_part(self, part: DrawnPart) -> None:
        part.item.setZValue(part.z)
        if part.item.scene() is not self:
            self.addItem(part.item)
        self.parts[part.key] = part

    def _draw_vectors(self, layer: str) -> None:
        """Compute the vectors of a layer when it is first shown."""
        if self.geometry is None or self.overlay is None or not self._shown[layer] or layer in self.overlay.vectors:
            return
        field = self._fields[layer] = FIELDS[layer](self.geometry)
        for part in overlay.arrows(field, layer, self.geometry, self.theme):
            self._add_part(part)
        self.overlay.add_scale(VectorUnit(layer, field.family, field.unit, field.mm_per_unit(self.geometry)))

    def _draw_parts(self, layer: str) -> None:
        """Draw the parts and the scale of a layer of ``LAZY`` when it is first shown."""
        if self.geometry is None or self.overlay is None or not self._shown[layer] or layer in self._drawn_layers:
            return
        self._drawn_layers.add(layer)
        for part in LAZY[layer](self.geometry, self.theme):
            self._add_part(part)
            if isinstance(part.item, ColouredLoop):
                self._ribbons.append(part.item)
                part.item.look(self.viewport.scale)
        scale = colour_scale(layer, self.geometry, self.theme)
        if scale is not None:
            self.overlay.add_colours(layer, scale)

    def _draw_construction(self, layer: str) -> None:
        """Draw a layer of a general linkage when it is first shown."""
        if self.linkage_layers is not None and (self.layer_shown(layer) or (layer == COUPLER and self.paths)):
            for part in self.linkage_layers.parts(layer):
                self._add_part(part)

    def _texts(self) -> list[QRectF]:
        if self._labels is None or self.overlay is None:
            return []
        return self._labels.boxes(self.viewport.scale) + self.overlay.boxes(self.viewport.visible, self.viewport.scale)

    def show_step(self, step: int | None, draw: bool = True) -> None:
        """Show one step of the circle diagram: the known centres, and the two lines that give the next one.

        ``None`` shows the selected layers without a step. With ``draw`` False the change appears with the next drawing.
        """
        self._step = step
        if not draw:
            return
        for layer in STEP_LAYERS:
            self._draw_construction(layer)
        if self.linkage_layers is not None:
            self.linkage_layers.show_step(step)
        self._show()
        self._move(self.index, self._angle)

    def _make_room(self) -> None:
        """Keep the labels clear of the vectors, dimensions, loads and curves that are shown."""
        if self._labels is not None:
            self._labels.avoid(self._obstacles)

    def _obstacles(self) -> tuple[Strokes, Sequence[np.ndarray]]:
        """Strokes and curves that the labels avoid."""
        assert self.geometry is not None
        shown = [field for layer, field in self._fields.items() if self._shown[layer]]
        values = dimension_strokes(self.geometry) if self._shown[DIMENSIONS] else []
        values += load_parts.load_strokes(self.geometry, self._shown.__getitem__)
        names = None if self._shown[COUPLER] else self.paths
        curves = () if self.linkage_layers is None or not self._shows_paths else self.linkage_layers.paths(names)
        drawn = (stroke for field in shown for stroke in overlay.arrow_strokes(field, self.geometry))
        return [*drawn, *values], curves

    def _other_texts(self, samples: np.ndarray) -> Iterator[TextBox]:
        """All texts of the view but the labels, at the given samples."""
        if self.overlay is None:
            return
        scale = self.viewport.scale
        for box in self.overlay.boxes(self.viewport.visible, scale):
            middle = complex(box.center().x(), -box.center().y()) / scale
            yield np.full(samples.size, middle), complex(box.width(), box.height()) / 2
        for part in self.parts.values():
            placed = part.key.startswith("label.") or not set(LINKAGE_LAYERS).isdisjoint(part.layers)
            if isinstance(part.item, Tag) and part.item.isVisible() and not placed:
                middles = []
                for i in samples:
                    if part.move is not None:
                        part.move(int(i))
                    box, at = part.item.pixel_box(), part.item.pos()
                    middles.append(complex(at.x() + box.center().x() / scale, at.y() - box.center().y() / scale))
                yield np.array(middles), complex(box.width(), box.height()) / 2

    def item(self, key: str) -> QGraphicsItem:
        """Item of a part, such as ``cam``, ``roller``, ``body.arm`` or ``pin.pivot``; raises KeyError."""
        return self.parts[key].item

    # -- layers ----------------------------------------------------------------------------------------

    def layer_shown(self, name: str) -> bool:
        """Whether a layer is shown, because it is selected or a step of the construction needs it."""
        return self._shown[name] or (self._step is not None and name in STEP_LAYERS)

    def layer_selected(self, name: str) -> bool:
        """Whether a layer is selected."""
        return self._shown[name]

    def set_layer(self, name: str, shown: bool) -> None:
        """Show or hide a layer."""
        self._shown[name] = shown
        if name in LINKAGE_LAYERS:
            self._draw_construction(name)
        if name in LAZY:
            self._draw_parts(name)
        if name in FIELDS:
            self._draw_vectors(name)
        self._show()  # before the texts are placed, so that hidden parts need no space
        if name in LAZY and self._region is not None and self.overlay is not None:
            self.overlay.lay(*self._region)
        if name == DIMENSIONS and self.geometry is not None:
            self._frame()
        if name in (*FIELDS, *LOAD_LAYERS, DIMENSIONS, COUPLER):
            self._make_room()
            if self._region is not None:
                self.show_region(*self._region)
        self._move(self.index, self._angle)

    @property
    def _shows_paths(self) -> bool:
        """Whether the path of a point is shown."""
        return self._shown[COUPLER] or bool(self.paths)

    def show_paths(self, names: Collection[str]) -> None:
        """Show the paths of these points, whether their layer is shown or not."""
        if self.paths != (paths := frozenset(names)):
            self.paths = paths
            self._draw_construction(COUPLER)
            self._show()
            self._make_room()

    def _show(self) -> None:
        for part in self.parts.values():
            is_path = part.layers == (COUPLER,) and part.key.partition(".")[2] in self.paths
            part.item.setVisible(is_path or all(self.layer_shown(layer) for layer in part.layers))
        if self.overlay is not None:
            self.overlay.show_layers(self._shown)

    # -- motion ----------------------------------------------------------------------------------------

    def set_index(self, index: int) -> None:
        """Move all visible parts to the sample of this index."""
        self._move(index, None)

    def _move(self, index: int, angle: float | None) -> None:
        """Move to a sample; ``angle`` [deg] is shown in place of the sample's cam angle."""
        if self.geometry is None or self.overlay is None:
            return
        self.index, self._angle = index % self.geometry.samples, angle
        if self.linkage_layers is not None:
            self.linkage_layers.begin(self.index)
        for part in self.parts.values():
            if part.move is not None and part.item.isVisible():
                part.move(self.index)
        self.overlay.show_angle(float(self.geometry.cam_angle[self.index]) if angle is None else angle, self.turn)
        if self._mouse is not None:
            self.read_profile(*self._mouse)

    def set_fraction(self, fraction: float) -> None:
        """Move to the sample nearest to a fraction of a turn."""
        if self.geometry is not None:
            n = self.geometry.samples
            if not self.geometry.is_full_turn:  # in both directions where the mechanism cannot rotate continuously
                fraction, n = 1.0 - abs(1.0 - 2.0 * fraction), n - 1
            self.set_index(round(fraction * n))

    def set_angle(self, theta: float) -> None:
        """Move to the sample nearest to cam angle theta [rad]; the text in the corner shows theta."""
        if self.geometry is not None and degrees(theta) != self._angle:
            self._move(self.geometry.nearest(theta), degrees(theta))

    # -- values of the profile -------------------------------------------------------------------------

    def read_profile(self, point: complex | None, reach: float = 0.0) -> None:
        """Show the values of the nearest profile point within ``reach`` [mm] of a point [mm]; None shows no values.

        The values are updated while the cam moves under the point.
        """
        self._mouse = None if point is None else (point, reach)
        if self.geometry is None or self.overlay is None:
            return
        with_forces = any(self._shown[layer] for layer in FORCE_LAYERS)
        reading = None if point is None else reading_at(self.geometry, self.index, point, reach, with_forces)
        self.overlay.show_reading("" if reading is None else reading.text)
        if reading is None:
            if self._dot is not None:
                self._dot.hide()
            return
        if self._dot is None:
            self._dot = Outline(circle(DOT), self.theme.pen(self.theme.ink, OUTLINE), brush(self.theme.paper))
            self._dot.setFlag(QGraphicsItem.GraphicsItemFlag.ItemIgnoresTransformations)
            self._dot.setZValue(Z_DOT)
            self.addItem(self._dot)
        position = reading.position(self.geometry.cam_turn(self.index))
        self._dot.setPos(position.real, position.imag)
        self._dot.show()

    # -- view of the scene -----------------------------------------------------------------------------

    def fit_rect(self) -> QRectF:
        """Rectangle that contains the mechanism over the turn [mm]."""
        return QRectF(self._extent)

    def least_rect(self) -> QRectF:
        """Rectangle that a well fitted view must contain [mm]: the extent with half the margin."""
        half = 0.5 * MARGIN_UNITS * self.geometry.unit if self.geometry is not None else 0.0
        return self._extent.adjusted(half, half, -half, -half)

    @property
    def _list_height(self) -> float:
        """Height of the lists at the top of the view [pixels]."""
        return self.linkage_layers.strip if self.linkage_layers is not None else 0.0

    def fit(self, width: float, height: float) -> tuple[QRectF, float]:
        """Visible rectangle [mm] and scale [pixels per mm] at which the mechanism fits a view of this size [pixels]."""
        return fitted(self._extent, width, height, self._list_height)

    def fit_centres(self, width: float, height: float) -> tuple[QRectF, float]:
        """Visible rectangle [mm] and scale [pixels per mm] with the instant centres shown at the current angle."""
        rect = self._extent
        if self.geometry is not None:
            marks = self.linkage_layers.marks if self.linkage_layers is not None else None
            rect = with_centres(
                rect, self.geometry.study.centres, self.index, marks.only if marks is not None else None
            )
        return fitted(rect, width, height, self._list_height)

    def fill(self, width: float, height: float) -> tuple[QRectF, float]:
        """Visible rectangle [mm] and scale [pixels per mm] that fit the mechanism to a view without strips of text."""
        return filled(self._extent, width, height)

    def show_region(self, visible: QRectF, scale: float, keep_labels: bool = False) -> None:
        """Place labels, scale bar and texts for a view of ``visible`` [mm] at ``scale`` [pixels per mm]."""
        self._show_region(visible, scale, self._labels.sides if self._labels is not None and keep_labels else {})

    def lay_labels(self) -> None:
        """Find the best side for each label."""
        if self._region is not None:
            self.show_region(*self._region)

    def update_style(self) -> bool:
        """Take over the current fonts; returns whether the labels must be placed again."""
        changes = [item.update_font() for item in self.items() if isinstance(item, Tag)]
        return any(changes)

    def _show_region(self, visible: QRectF, scale: float, sides: Mapping[str, int]) -> None:
        self._region = (visible, scale)
        self.viewport.visible, self.viewport.scale = QRectF(visible), scale
        for line in self._lines:
            line.look(scale * self.theme.ratio * self._closest)
        for ribbon in self._ribbons:
            ribbon.look(scale)
        if self._labels is not None and self.overlay is not None:
            self.overlay.lay(visible, scale)
            low = complex(visible.left(), visible.top())
            if self._still:
                self._labels.use_sample(self.index)
            if not self._labels.reuse_sides(sides, scale):
                texts = list(self._other_texts(self._labels.samples))
                self._labels.arrange((low, low + complex(visible.width(), visible.height())), scale, texts)
            self._move(self.index, self._angle)
