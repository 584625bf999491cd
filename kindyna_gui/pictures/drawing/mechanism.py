"""The scene, layers, framing."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import partial
from math import degrees
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
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.drawing.labels import Labels, TextBox
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
    from kindyna_gui.pictures.drawing.centre_parts import Construct


# -- framing ---------------------------------------------------------------------------------------------

FAR_CENTRES = 12.0  # sizes of the mechanism
MARGIN_UNITS = 4.5  # around all that moves, in units of the symbols
_STANDING = ("rails", "ground", "pedestal", "rim", "dimensions")


def full_extent(geometry: Geometry, parts: Iterable[DrawnPart]) -> QRectF:
    """The rectangle that holds the mechanism over the whole turn [mm]: all that moves, the ground it stands on, and
    the instant centre where it is near."""
    low, high = geometry.core_box
    rect = QRectF(low.real, low.imag, (high - low).real, (high - low).imag)
    for part in parts:
        if part.move is None and part.key.partition(".")[0] in _STANDING:
            rect = rect.united(part.item.boundingRect())
        if part.move is not None and part.key.startswith(("spring.", "load.")):
            for i in range(0, geometry.samples, max(1, geometry.samples // 8)):
                part.move(i)
                rect = rect.united(part.item.sceneBoundingRect())
        if part.move is not None and part.key.startswith("stem."):
            for i in (int(np.argmin(np.abs(geometry.reference))), int(np.argmax(np.abs(geometry.reference)))):
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
    """A rectangle [mm] that holds another one and the instant centres at a sample, all or the chosen ones, but those farther away than
    ``FAR_CENTRES`` of its size, beside which the mechanism would be a dot."""
    reach = FAR_CENTRES * max(rect.width(), rect.height())
    edge, middle = 0.03 * max(rect.width(), rect.height()), complex(rect.center().x(), rect.center().y())
    for key, centres in table.centres.items():
        if (only is not None and key not in only) or centres.is_far(table.size)[index]:
            continue
        place = MM * complex(centres.finite[index])
        if abs(place - middle) <= reach:
            rect = rect.united(QRectF(place.real - edge, place.imag - edge, 2.0 * edge, 2.0 * edge))
    return rect


def fitted(rect: QRectF, width: float, height: float, list_height: float = 0.0) -> tuple[QRectF, float]:
    """What a picture of so many pixels shows when a rectangle [mm] fills it between the strips that texts need:
    visible rectangle [mm] and scale [pixels per mm]. list_height: of a list at the top [pixels]."""
    top = sized(TOP_STRIP) + list_height
    room = max(height - top - sized(BOTTOM_STRIP), 0.3 * height)
    scale = min(width / rect.width(), room / rect.height())
    visible = _about(rect, width, height, scale)
    visible.translate(0.0, -0.5 * (sized(BOTTOM_STRIP) - top) / scale)
    return visible, scale


def filled(rect: QRectF, width: float, height: float) -> tuple[QRectF, float]:
    """The same without strips for texts."""
    scale = min(width / rect.width(), height / rect.height())
    return _about(rect, width, height, scale), scale


def _about(rect: QRectF, width: float, height: float, scale: float) -> QRectF:
    visible = QRectF(0.0, 0.0, width / scale, height / scale)
    visible.moveCenter(rect.center())
    return visible


# -- mechanism -------------------------------------------------------------------------------------------

USUAL_SIZE = (900.0, 675.0)  # of a picture whose size is not given, pixels


BUILDERS: tuple[Callable[[Geometry, Theme], Iterator[DrawnPart]], ...] = (
    cam_parts.cam,
    parts.roller,
    parts.wheels,
    parts.linkage,
    cam_parts.contact,
)
LAZY: Mapping[str, Callable[[Geometry, Theme], Iterator[DrawnPart]]] = MappingProxyType(
    {
        **{layer: partial(coloured_profile, layer) for layer in COLOURINGS},
        DIMENSIONS: dimensions,
        TWIST: shaft,
        "loads": load_parts.loads,
        "masses": load_parts.masses,
    }
)
"""Layers whose parts are made when first shown."""

DOT = 4.0  # of the place that is read, pixels
Z_DOT = 12.0


class MechanismScene(QGraphicsScene):
    """A study's mechanism in mm, y upwards: whoever shows it turns y over.

    ``set_index``, ``set_fraction`` and ``set_angle`` move it; ``show_region`` must be called with what is visible and at which
    scale, for all that is measured in pixels. Raises NoSolution where the linkage of the study has no position.

    closest: by how much the picture may be enlarged with its curves still smooth
    still: it will not move, so that labels need to suit one angle alone
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
        self.turn = 0  # that is drawn, where each begins an advance further on
        self._angle: float | None = None
        self.parts: dict[str, DrawnPart] = {}
        self._closest, self._still = closest, still
        self._lines: list[Loop] = []
        self._ribbons: list[ColouredLoop] = []
        self._whole = QRectF(-100.0, -100.0, 200.0, 200.0)
        self._shown = {name: layer.shown for name, layer in EVERY_LAYER.items()}
        self._region: tuple[QRectF, float] | None = None
        self._labels: Labels | None = None
        self._fields: dict[str, overlay.Field] = {}
        self.viewport = Viewport()
        self.construct: Construct | None = None
        self._step: int | None = None
        self.overlay: Overlay | None = None
        self._made: set[str] = set()
        self._mouse: tuple[complex, float] | None = None
        self._dot: Outline | None = None
        if study is not None:
            self.update_study(study)

    # -- what is drawn --------------------------------------------------------------------------------------

    def update_study(self, study: Study, keep_labels: bool = False, lay: bool = True) -> None:
        """Draw another study; cam angle, layers and what is visible stay as they are.

        keep_labels: labels stay on their sides, which is quick and does not flicker; ``lay_labels`` finds better ones,
        and so does the first ``show_region``. lay: False where ``show_region`` follows at once, so that nothing is laid twice.
        """
        geometry = Geometry(study)
        before, self.geometry = self.geometry, geometry
        if before is not None:
            self.index = round(self.index / before.samples * geometry.samples) % geometry.samples
        self._angle = None
        sides = self._labels.sides if self._labels is not None and keep_labels else {}
        drew = bool(self._fields)
        self._drop_vectors()
        by_forces = not self._made.isdisjoint((*FORCE_LAYERS, TWIST))  # what other loads change
        same = before is not None and geometry.has_same_positions(before) and not by_forces
        if not same:
            self._rebuild(geometry)
        elif before is not None and not load_parts.same_loads(geometry, before, self._shown["masses"]):
            self._renew_loads()
        if geometry.has_numbered_links:
            from kindyna_gui.pictures.drawing.centre_parts import Construct

            self.construct = Construct(geometry, self.theme, self.viewport, self._texts, self._step)
        for layer in FIELDS:
            self._need(layer)
        for layer in LINKAGE_LAYERS:
            self._need_more(layer)
        drew = drew or self._shown[DIMENSIONS]
        if self._fields or drew or geometry.elements or self._shown["masses"] or self._shown["coupler"]:
            self._make_room()
        self._show()
        if not lay or (self._region is None and keep_labels):
            self._move(self.index, None)  # nothing can be laid yet
        elif not same or self._fields or drew or not keep_labels:
            self._show_region(*(self._region or self.fit(*USUAL_SIZE)), sides)
        else:
            self._move(self.index, None)

    def _rebuild(self, geometry: Geometry) -> None:
        """Draw all parts anew; labels of the same names stay the items they are."""
        named = self._labels is not None and self._labels.renew(geometry)
        for key, part in self.parts.items():
            if not (named and key.startswith("label.")):
                self.removeItem(part.item)
        self.parts = {}
        self._made = set()
        if self.overlay is not None:
            self.overlay.drop_colours(self.removeItem)
        if self.overlay is None:
            self.overlay = Overlay(self.theme, self.addItem)
        self.overlay.angle_name = geometry.study.angle_name if geometry.has_numbered_links else "cam angle"
        for builder in BUILDERS:
            for part in builder(geometry, self.theme):
                self._take(part)
        if self._labels is None or not named:
            self._labels = Labels(geometry, self.theme)
        for part in self._labels.parts():
            self._take(part)
        self._lines = [part.item for part in self.parts.values() if isinstance(part.item, Loop)]
        self._ribbons = []
        for layer in LAZY:
            self._need_parts(layer)
        self._frame()

    def _renew_loads(self) -> None:
        """Draw what follows from the loads alone anew."""
        for key in [key for key, part in self.parts.items() if not set(LOAD_LAYERS).isdisjoint(part.layers)]:
            self.removeItem(self.parts.pop(key).item)
        self._made -= set(LOAD_LAYERS)
        for layer in LOAD_LAYERS:
            self._need_parts(layer)
        self._frame()

    def _frame(self) -> None:
        """Take in what the picture must hold of what is shown."""
        assert self.geometry is not None
        shown = (part for part in self.parts.values() if self._shown[DIMENSIONS] or DIMENSIONS not in part.layers)
        self._whole = full_extent(self.geometry, shown)
        self.setSceneRect(self._whole)

    def _drop_vectors(self) -> None:
        for key in [key for key in self.parts if key.partition(".")[0] in FIELDS]:
            self.removeItem(self.parts.pop(key).item)
        if self.overlay is not None:
            self.overlay.drop_scales(self.removeItem)
        self._fields = {}
        for key in [key for key in self.parts if key.partition(".")[0] in LINKAGE_LAYERS]:
            self.removeItem(self.parts.pop(key).item)
        self.construct = None

    def _take(self, part: DrawnPart) -> None:
        part.item.setZValue(part.z)
        if part.item.scene() is not self:
            self.addItem(part.item)
        self.parts[part.key] = part

    def _need(self, layer: str) -> None:
        """Vectors are computed when their layer is first shown."""
        if self.geometry is None or self.overlay is None or not self._shown[layer] or layer in self.overlay.vectors:
            return
        field = self._fields[layer] = FIELDS[layer](self.geometry)
        for part in overlay.arrows(field, layer, self.geometry, self.theme):
            self._take(part)
        self.overlay.add_scale(VectorUnit(layer, field.family, field.unit, field.mm_per_unit(self.geometry)))

    def _need_parts(self, layer: str) -> None:
        """Parts of a layer that is seldom shown, and their scale, are made when it is."""
        if self.geometry is None or self.overlay is None or not self._shown[layer] or layer in self._made:
            return
        self._made.add(layer)
        for part in LAZY[layer](self.geometry, self.theme):
            self._take(part)
            if isinstance(part.item, ColouredLoop):
                self._ribbons.append(part.item)
                part.item.look(self.viewport.scale)
        scale = colour_scale(layer, self.geometry, self.theme)
        if scale is not None:
            self.overlay.add_colours(layer, scale)

    def _need_more(self, layer: str) -> None:
        """What a linkage shows besides is read when its layer is first shown."""
        if self.construct is not None and self.layer_shown(layer):
            for part in self.construct.parts(layer):
                self._take(part)

    def _texts(self) -> list[QRectF]:
        if self._labels is None or self.overlay is None:
            return []
        return self._labels.boxes(self.viewport.scale) + self.overlay.boxes(self.viewport.visible, self.viewport.scale)

    def show_step(self, step: int | None, draw: bool = True) -> None:
        """Show one step of the circle diagram: the centres known by then, and the two lines that give the next one.
        None: no step, but the layers as they are chosen. draw: now, not with what is drawn next."""
        self._step = step
        if not draw:
            return
        for layer in STEP_LAYERS:
            self._need_more(layer)
        if self.construct is not None:
            self.construct.show_step(step)
        self._show()
        self._move(self.index, self._angle)

    def _make_room(self) -> None:
        """Labels keep clear of the vectors that are shown."""
        if self._labels is not None and self.geometry is not None:
            shown = [field for layer, field in self._fields.items() if self._shown[layer]]
            values = dimension_strokes(self.geometry) if self._shown[DIMENSIONS] else []
            values += load_parts.strokes(self.geometry, self._shown.__getitem__)
            curves = () if self.construct is None or not self._shown["coupler"] else self.construct.paths()
            drawn = (stroke for field in shown for stroke in overlay.arrow_strokes(field, self.geometry))
            self._labels.avoid([*drawn, *values], curves)

    def _written(self, samples: np.ndarray) -> Iterator[TextBox]:
        """The texts of the picture that are no names, at these samples."""
        if self.overlay is None:
            return
        scale = self.viewport.scale
        for box in self.overlay.boxes(self.viewport.visible, scale):
            middle = complex(box.center().x(), -box.center().y()) / scale
            yield np.full(samples.size, middle), complex(box.width(), box.height()) / 2
        for part in self.parts.values():
            own = part.key.startswith("label.") or not set(LINKAGE_LAYERS).isdisjoint(part.layers)
            if isinstance(part.item, Tag) and part.item.isVisible() and not own:
                middles = []
                for i in samples:
                    if part.move is not None:
                        part.move(int(i))
                    box, at = part.item.pixel_box(), part.item.pos()
                    middles.append(complex(at.x() + box.center().x() / scale, at.y() - box.center().y() / scale))
                yield np.array(middles), complex(box.width(), box.height()) / 2

    def item(self, key: str) -> QGraphicsItem:
        """The item of a part: ``cam``, ``roller``, ``body.arm``, ``pin.pivot`` ...; raises KeyError."""
        return self.parts[key].item

    # -- layers ---------------------------------------------------------------------------------------------

    def layer_shown(self, name: str) -> bool:
        """Whether a layer is shown: chosen, or needed by a step of the construction."""
        return self._shown[name] or (self._step is not None and name in STEP_LAYERS)

    def layer_wanted(self, name: str) -> bool:
        """Whether a layer was chosen."""
        return self._shown[name]

    def set_layer(self, name: str, shown: bool) -> None:
        """Show or hide one of ``LAYERS``."""
        self._shown[name] = shown
        if name in LINKAGE_LAYERS:
            self._need_more(name)
        if name in LAZY:
            self._need_parts(name)
        if name in FIELDS:
            self._need(name)
        self._show()  # before anything is laid: what is not seen takes no place
        if name in LAZY and self._region is not None and self.overlay is not None:
            self.overlay.lay(*self._region)
        if name == DIMENSIONS and self.geometry is not None:
            self._frame()
        if name in (*FIELDS, *LOAD_LAYERS, DIMENSIONS, "coupler"):
            self._make_room()
            if self._region is not None:
                self.show_region(*self._region)
        self._move(self.index, self._angle)

    def _show(self) -> None:
        for part in self.parts.values():
            part.item.setVisible(all(self.layer_shown(layer) for layer in part.layers))
        if self.overlay is not None:
            self.overlay.show_layers(self._shown)

    # -- motion ---------------------------------------------------------------------------------------------

    def set_index(self, index: int) -> None:
        """Move everything that is shown to the study's sample of this index."""
        self._move(index, None)

    def _move(self, index: int, angle: float | None) -> None:
        """To a sample; angle: the text's cam angle in place of the sample's [deg]."""
        if self.geometry is None or self.overlay is None:
            return
        self.index, self._angle = index % self.geometry.samples, angle
        if self.construct is not None:
            self.construct.begin(self.index)
        for part in self.parts.values():
            if part.move is not None and part.item.isVisible():
                part.move(self.index)
        self.overlay.show_angle(float(self.geometry.cam_angle[self.index]) if angle is None else angle, self.turn)
        if self._mouse is not None:
            self.read_profile(*self._mouse)

    def set_fraction(self, fraction: float) -> None:
        """Move to the sample nearest to this part of a turn."""
        if self.geometry is not None:
            n, whole = self.geometry.samples, self.geometry.is_full_turn
            # there and back where the mechanism cannot go round
            self.set_index(round(fraction * n) if whole else round((1.0 - abs(1.0 - 2.0 * fraction)) * (n - 1)))

    def set_angle(self, theta: float) -> None:
        """Move to the sample nearest to cam angle theta [rad]; the text in the corner shows theta itself."""
        if self.geometry is not None:
            self._move(self.geometry.nearest(theta), degrees(theta))

    # -- what is read ---------------------------------------------------------------------------------------

    def read_profile(self, at: complex | None, reach: float = 0.0) -> None:
        """Show the values at the place of the profile that is nearest to ``at`` [mm], no farther than ``reach`` [mm]; None: no
        values. What is read goes on with the cam below the place."""
        self._mouse = None if at is None else (at, reach)
        if self.geometry is None or self.overlay is None:
            return
        by_forces = any(self._shown[layer] for layer in FORCE_LAYERS)
        reading = None if at is None else reading_at(self.geometry, self.index, at, reach, by_forces)
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
        place = reading.point * np.exp(1j * np.deg2rad(self.geometry.cam_rotation[self.index]))
        self._dot.setPos(place.real, place.imag)
        self._dot.show()

    # -- sight ----------------------------------------------------------------------------------------------

    def fit_rect(self) -> QRectF:
        """The rectangle that holds the mechanism over the whole turn [mm]."""
        return QRectF(self._whole)

    def least_rect(self) -> QRectF:
        """What a picture must hold to be no worse than fitted: the same with half the margin."""
        half = 0.5 * MARGIN_UNITS * self.geometry.unit if self.geometry is not None else 0.0
        return self._whole.adjusted(half, half, -half, -half)

    def fit(self, width: float, height: float) -> tuple[QRectF, float]:
        """What a picture of so many pixels shows when the mechanism fills it between the strips that texts need:
        visible rectangle [mm] and scale [pixels per mm]."""
        return fitted(self._whole, width, height, self.construct.strip if self.construct is not None else 0.0)

    def fit_centres(self, width: float, height: float) -> tuple[QRectF, float]:
        """The same with the instant centres at the angle at hand, of the step of the circle diagram where one is shown."""
        rect, strip = self._whole, self.construct.strip if self.construct is not None else 0.0
        if self.geometry is not None:
            marks = self.construct.marks if self.construct is not None else None
            rect = with_centres(
                rect, self.geometry.study.centres, self.index, marks.only if marks is not None else None
            )
        return fitted(rect, width, height, strip)

    def fill(self, width: float, height: float) -> tuple[QRectF, float]:
        """The same without strips for texts."""
        return filled(self._whole, width, height)

    def show_region(self, visible: QRectF, scale: float, keep_labels: bool = False) -> None:
        """Lay labels, scale bar and texts for a view that shows ``visible`` [mm] at ``scale`` [pixels per mm]."""
        self._show_region(visible, scale, self._labels.sides if self._labels is not None and keep_labels else {})

    def lay_labels(self) -> None:
        """Find the best side for each label."""
        if self._region is not None:
            self.show_region(*self._region)

    def update_style(self) -> None:
        """Take over the current fonts."""
        for item in self.items():
            if isinstance(item, Tag):
                item.letter()
        self.lay_labels()

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
                texts = list(self._written(self._labels.samples))
                self._labels.arrange((low, low + complex(visible.width(), visible.height())), scale, texts)
            self._move(self.index, self._angle)
