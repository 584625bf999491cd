"""The drawing of a mechanism: a scene in mm, y upwards, that moves by moving what it holds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import degrees
from types import MappingProxyType

from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QGraphicsItem, QGraphicsScene

from core.study import Study
from kindyna_gui.pictures import cam_parts, parts, vectors
from kindyna_gui.pictures.centre_parts import Z_CENTRES, Z_LINES, CentreMarks, KennedyLines, coupler_curves
from kindyna_gui.pictures.items import Loop, Part, Tag
from kindyna_gui.pictures.labels import Labels
from kindyna_gui.pictures.overlay import BOTTOM_STRIP, TOP_STRIP, Overlay, Scale
from kindyna_gui.pictures.reading import Reading
from kindyna_gui.pictures.sight import Sight
from kindyna_gui.pictures.style import LIGHT, Theme
from kindyna_gui.shown_kinds import has_cam, is_linkage

MARGIN_UNITS = 4.5  # around all that moves, in units of the symbols
USUAL_SIZE = (900.0, 675.0)  # of a picture nobody has asked a size for, pixels


@dataclass(frozen=True)
class Layer:
    """One row of what can be shown: its name for the user, and whether it is shown at first."""

    label: str
    shown: bool = True


LAYERS: Mapping[str, Layer] = MappingProxyType(
    {
        "ground": Layer("Ground"),
        "guide": Layer("Guide"),
        "cam": Layer("Cam"),
        "pitch": Layer("Pitch curve"),
        "base": Layer("Base circle"),
        "roller": Layer("Roller"),
        "linkage": Layer("Linkage"),
        "normal": Layer("Contact normal"),
        "centre": Layer("Instant centre"),
        "velocities": Layer("Velocities", shown=False),
        "forces": Layer("Forces", shown=False),
        "labels": Layer("Labels"),
        "scale": Layer("Scale bar"),
    }
)

LINKAGE_LAYERS: Mapping[str, Layer] = MappingProxyType(
    {
        "centres": Layer("Instant centres of all links", shown=False),
        "kennedy": Layer("Kennedy's construction", shown=False),
        "coupler": Layer("Coupler curves", shown=False),
    }
)
"""What the drawing of a general linkage can show besides."""

_OF_CAMS = ("cam", "pitch", "base", "roller", "normal", "centre")
EVERY_LAYER: Mapping[str, Layer] = MappingProxyType({**LAYERS, **LINKAGE_LAYERS})


def layers_of(study: Study) -> tuple[str, ...]:
    """The layers that have something to show of this kind of design."""
    if not is_linkage(study.design):
        return tuple(LAYERS)
    return tuple(name for name in EVERY_LAYER if has_cam(study) or name not in _OF_CAMS)


BUILDERS: tuple[Callable[[Reading, Theme], Iterator[Part]], ...] = (
    cam_parts.cam,
    parts.roller,
    parts.linkage,
    cam_parts.contact,
)
FIELDS: Mapping[str, Callable[[Reading], vectors.Field]] = MappingProxyType(
    {"velocities": vectors.velocities, "forces": vectors.forces}
)
"""Layers of vectors, computed when first shown."""


class MechanismScene(QGraphicsScene):
    """A study's mechanism in mm, y upwards: whoever shows it turns y over.

    ``set_index``, ``set_fraction`` and ``set_angle`` move it; ``look_at`` must be told what is visible and at which
    scale, for all that is measured in pixels. Raises NoAnswer where the linkage of the study has no position.

    closest: by how much a reader may enlarge the picture and still find its curves smooth
    """

    def __init__(self, study: Study | None = None, theme: Theme = LIGHT, closest: float = 1.0) -> None:
        super().__init__()
        self.setItemIndexMethod(QGraphicsScene.ItemIndexMethod.NoIndex)
        self.setBackgroundBrush(QColor(theme.paper))
        self.theme = theme
        self.reading: Reading | None = None
        self.index = 0
        self._told: float | None = None
        self.parts: dict[str, Part] = {}
        self._closest = closest
        self._lines: list[Loop] = []
        self._whole = QRectF(-100.0, -100.0, 200.0, 200.0)
        self._shown = {name: layer.shown for name, layer in EVERY_LAYER.items()}
        self._look: tuple[QRectF, float] | None = None
        self._labels: Labels | None = None
        self._fields: dict[str, vectors.Field] = {}
        self.sight = Sight()
        self._marks: CentreMarks | None = None
        self._kennedy: KennedyLines | None = None
        self._step: int | None = None
        self.overlay: Overlay | None = None
        if study is not None:
            self.update_study(study)

    # -- what is drawn --------------------------------------------------------------------------------------

    def update_study(self, study: Study, keep_labels: bool = False) -> None:
        """Draw another study; cam angle, layers and what is visible stay as they are.

        keep_labels: labels stay on their sides, which is quick and does not flicker; ``lay_labels`` finds better ones,
        and so does the first ``look_at``.
        """
        reading = Reading(study)
        before, self.reading = self.reading, reading
        if before is not None:
            self.index = round(self.index / before.samples * reading.samples) % reading.samples
        self._told = None
        sides = self._labels.sides if self._labels is not None and keep_labels else {}
        drew = bool(self._fields)
        self._drop_vectors()
        stands = before is not None and reading.stands_as(before)
        if not stands:
            self._rebuild(reading)
        for layer in FIELDS:
            self._need(layer)
        for layer in LINKAGE_LAYERS:
            self._need_more(layer)
        if self._fields or drew:
            self._make_room()
        self._show()
        if self._look is None and keep_labels:
            self._move(self.index, None)  # nothing can be laid yet
        elif not stands or self._fields or drew or not keep_labels:
            self._look_at(*(self._look or self.fit(*USUAL_SIZE)), sides)
        else:
            self._move(self.index, None)

    def _rebuild(self, reading: Reading) -> None:
        """Draw all parts anew; labels of the same names stay the items they are."""
        named = self._labels is not None and self._labels.renew(reading)
        for key, part in self.parts.items():
            if not (named and key.startswith("label.")):
                self.removeItem(part.item)
        self.parts = {}
        if self.overlay is None:
            self.overlay = Overlay(self.theme, self.addItem)
        self.overlay.angle_name = reading.study.angle_name if reading.linkage else "cam angle"
        for builder in BUILDERS:
            for part in builder(reading, self.theme):
                self._take(part)
        if self._labels is None or not named:
            self._labels = Labels(reading, self.theme)
        for part in self._labels.parts():
            self._take(part)
        self._lines = [part.item for part in self.parts.values() if isinstance(part.item, Loop)]
        self._whole = self._box(reading)
        self.setSceneRect(self._whole)

    def _drop_vectors(self) -> None:
        for key in [key for key in self.parts if key.partition(".")[0] in FIELDS]:
            self.removeItem(self.parts.pop(key).item)
        if self.overlay is not None:
            self.overlay.drop_scales(self.removeItem)
        self._fields = {}
        for key in [key for key in self.parts if key.partition(".")[0] in LINKAGE_LAYERS]:
            self.removeItem(self.parts.pop(key).item)
        self._marks = self._kennedy = None

    def _take(self, part: Part) -> None:
        part.item.setZValue(part.z)
        if part.item.scene() is not self:
            self.addItem(part.item)
        self.parts[part.key] = part

    def _need(self, layer: str) -> None:
        """Vectors are computed when their layer is first shown."""
        if self.reading is None or self.overlay is None or not self._shown[layer] or layer in self.overlay.vectors:
            return
        field = self._fields[layer] = FIELDS[layer](self.reading)
        for part in vectors.arrows(field, layer, self.reading, self.theme):
            self._take(part)
        self.overlay.add_scale(Scale(layer, field.family, field.unit, field.mm_per_unit(self.reading)))

    def _need_more(self, layer: str) -> None:
        """Centres, their lines and the ways of points are read when their layer is first shown."""
        reading = self.reading
        if reading is None or not reading.linkage or not self.layer_shown(layer):
            return
        if any(key.partition(".")[0] == layer for key in self.parts):
            return
        if layer == "coupler":
            for part in coupler_curves(reading, self.theme):
                self._take(part)
            return
        table = reading.study.centres
        if layer == "centres":
            self._marks = CentreMarks(table, self.theme, self.sight, self._texts)
            self._take(Part("centres.all", self._marks.item, ("centres",), Z_CENTRES, self._marks.move))
        else:
            self._kennedy = KennedyLines(table, table.construction.steps, self.theme, self.sight)
            self._take(Part("kennedy.all", self._kennedy.item, ("kennedy",), Z_LINES, self._kennedy.move))
        self._mark_step()

    def _texts(self) -> list[QRectF]:
        """Boxes of the labels that are shown, in pixels of the whole scene."""
        boxes = []
        for key, part in self.parts.items():
            if key.startswith("label.") and part.item.isVisible() and isinstance(part.item, Tag):
                place = part.item.pos() * self.sight.scale
                boxes.append(part.item.pixel_box().translated(place.x(), -place.y()))
        return boxes

    def show_step(self, step: int | None, draw: bool = True) -> None:
        """Show one step of the circle diagram: the centres known by then, and the two lines that give the next one.
        None: no step, but the layers as they are chosen. draw: now, not with what is drawn next."""
        self._step = step
        if not draw:
            return
        for layer in ("centres", "kennedy"):
            self._need_more(layer)
        self._mark_step()
        self._show()
        self._move(self.index, self._told)

    def _mark_step(self) -> None:
        if self._marks is None and self._kennedy is None:
            return
        assert self.reading is not None
        plan, step = self.reading.study.centres.construction, self._step
        found = None if step is None else frozenset((*plan.known, *(w.key for w in plan.steps[:step])))
        wanted = plan.steps[step - 1].key if step and step <= len(plan.steps) else None
        if self._marks is not None:
            self._marks.only = found
        if self._kennedy is not None:
            self._kennedy.emphasise(wanted if step is not None else None)
            self._kennedy.hidden = step == 0

    def _make_room(self) -> None:
        """Labels keep clear of the vectors that are shown."""
        if self._labels is not None and self.reading is not None:
            shown = [field for layer, field in self._fields.items() if self._shown[layer]]
            self._labels.avoid([stroke for field in shown for stroke in vectors.strokes(field, self.reading)])

    def item(self, key: str) -> QGraphicsItem:
        """The item of a part: ``cam``, ``roller``, ``body.arm``, ``pin.pivot`` ...; raises KeyError."""
        return self.parts[key].item

    # -- layers ---------------------------------------------------------------------------------------------

    def layer_shown(self, name: str) -> bool:
        """Whether it was asked for, or a step of the construction needs it."""
        return self._shown[name] or (self._step is not None and name in ("centres", "kennedy"))

    def layer_wanted(self, name: str) -> bool:
        """Whether it was asked for."""
        return self._shown[name]

    def set_layer(self, name: str, shown: bool) -> None:
        """Show or hide one of ``LAYERS``."""
        self._shown[name] = shown
        if name in LINKAGE_LAYERS:
            self._need_more(name)
        if name in FIELDS:
            self._need(name)
            self._make_room()
            if self._look is not None:
                self.look_at(*self._look)
        self._show()
        self._move(self.index, self._told)

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
        """To a sample; angle: what is told in place of its own cam angle [deg]."""
        if self.reading is None or self.overlay is None:
            return
        self.index, self._told = index % self.reading.samples, angle
        for part in self.parts.values():
            if part.move is not None and part.item.isVisible():
                part.move(self.index)
        self.overlay.show_angle(float(self.reading.cam_angle[self.index]) if angle is None else angle)

    def set_fraction(self, fraction: float) -> None:
        """Move to the sample nearest to this part of a turn."""
        if self.reading is not None:
            n, whole = self.reading.samples, self.reading.whole_turn
            # there and back where the mechanism cannot go round
            self.set_index(round(fraction * n) if whole else round((1.0 - abs(1.0 - 2.0 * fraction)) * (n - 1)))

    def set_angle(self, theta: float) -> None:
        """Move to the sample nearest to cam angle theta [rad]; theta itself is told in the corner."""
        if self.reading is not None:
            self._move(self.reading.nearest(theta), degrees(theta))

    # -- sight ----------------------------------------------------------------------------------------------

    def fit_rect(self) -> QRectF:
        """The rectangle that holds the mechanism over the whole turn [mm]."""
        return QRectF(self._whole)

    def least_rect(self) -> QRectF:
        """What a picture must hold to be no worse than fitted: the same with half the margin."""
        half = 0.5 * MARGIN_UNITS * self.reading.unit if self.reading is not None else 0.0
        return self._whole.adjusted(half, half, -half, -half)

    def _box(self, reading: Reading) -> QRectF:
        low, high = reading.core_box
        rect = QRectF(low.real, low.imag, (high - low).real, (high - low).imag)
        for part in self.parts.values():
            if part.move is None and part.key.partition(".")[0] in ("rails", "ground", "pedestal"):
                rect = rect.united(part.item.boundingRect())
        q = reading.near_centres
        if q.size:
            x, y = q.real, q.imag
            left, below = float(x.min()), float(y.min())
            rect = rect.united(QRectF(left, below, float(x.max()) - left + 1e-9, float(y.max()) - below + 1e-9))
        room = MARGIN_UNITS * reading.unit
        return rect.adjusted(-room, -room, room, room)

    def fit(self, width: float, height: float) -> tuple[QRectF, float]:
        """What a picture of so many pixels shows when the mechanism fills it between the strips that texts need:
        visible rectangle [mm] and scale [pixels per mm]."""
        rect = self.fit_rect()
        room = max(height - TOP_STRIP - BOTTOM_STRIP, 0.3 * height)
        scale = min(width / rect.width(), room / rect.height())
        centre, below = rect.center(), BOTTOM_STRIP - TOP_STRIP
        visible = QRectF(0.0, 0.0, width / scale, height / scale)
        visible.moveCenter(centre)
        visible.translate(0.0, -0.5 * below / scale)
        return visible, scale

    def fill(self, width: float, height: float) -> tuple[QRectF, float]:
        """The same without strips for texts."""
        rect = self.fit_rect()
        scale = min(width / rect.width(), height / rect.height())
        visible = QRectF(0.0, 0.0, width / scale, height / scale)
        visible.moveCenter(rect.center())
        return visible, scale

    def look_at(self, visible: QRectF, scale: float, keep_labels: bool = False) -> None:
        """Lay labels, scale bar and texts for a view that shows ``visible`` [mm] at ``scale`` [pixels per mm]."""
        self._look_at(visible, scale, self._labels.sides if self._labels is not None and keep_labels else {})

    def lay_labels(self) -> None:
        """Find the best side for each label."""
        if self._look is not None:
            self.look_at(*self._look)

    def _look_at(self, visible: QRectF, scale: float, sides: Mapping[str, int]) -> None:
        self._look = (visible, scale)
        self.sight.visible, self.sight.scale = QRectF(visible), scale
        for line in self._lines:
            line.look(scale * self.theme.ratio * self._closest)
        if self._labels is not None and self.overlay is not None:
            low = complex(visible.left(), visible.top())
            if not self._labels.keep(sides, scale):
                self._labels.arrange((low, low + complex(visible.width(), visible.height())), scale)
            self.overlay.lay(visible, scale)
            self._move(self.index, self._told)
