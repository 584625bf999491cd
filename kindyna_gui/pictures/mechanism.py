"""The drawing of a mechanism: a scene in mm, y upwards, that moves by moving what it holds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from math import degrees, pi
from types import MappingProxyType

from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QGraphicsItem, QGraphicsScene

from core.study import Study
from kindyna_gui.pictures import cam_parts, parts, vectors
from kindyna_gui.pictures.items import Part
from kindyna_gui.pictures.labels import Labels
from kindyna_gui.pictures.overlay import BOTTOM_STRIP, TOP_STRIP, Overlay, Scale
from kindyna_gui.pictures.reading import Reading
from kindyna_gui.pictures.style import LIGHT, Theme

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
    """

    def __init__(self, study: Study | None = None, theme: Theme = LIGHT) -> None:
        super().__init__()
        self.setItemIndexMethod(QGraphicsScene.ItemIndexMethod.NoIndex)
        self.setBackgroundBrush(QColor(theme.paper))
        self.theme = theme
        self.reading: Reading | None = None
        self.index = 0
        self._told: float | None = None
        self.parts: dict[str, Part] = {}
        self._shown = {name: layer.shown for name, layer in LAYERS.items()}
        self._look: tuple[QRectF, float] | None = None
        self._labels: Labels | None = None
        self._fields: dict[str, vectors.Field] = {}
        self.overlay: Overlay | None = None
        if study is not None:
            self.update_study(study)

    # -- what is drawn --------------------------------------------------------------------------------------

    def update_study(self, study: Study, keep_labels: bool = False) -> None:
        """Draw another study; cam angle, layers and what is visible stay as they are.

        keep_labels: labels stay on their sides, which is quick and does not flicker; ``lay_labels`` finds better ones.
        """
        reading = Reading(study)
        fraction = self.index / self.reading.samples if self.reading is not None else 0.0
        self.reading, self.parts = reading, {}
        self.clear()
        self.overlay = Overlay(self.theme, self.addItem)
        for builder in BUILDERS:
            for part in builder(reading, self.theme):
                self._take(part)
        sides = self._labels.sides if self._labels is not None and keep_labels else {}
        self._labels = Labels(reading, self.theme)
        for part in self._labels.parts():
            self._take(part)
        self._fields = {}
        for layer in FIELDS:
            self._need(layer)
        if self._fields:
            self._make_room()
        self.setSceneRect(self.fit_rect())
        self._look_at(*(self._look or self.fit(*USUAL_SIZE)), sides)
        self._show()
        self.set_fraction(fraction)

    def _take(self, part: Part) -> None:
        part.item.setZValue(part.z)
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
        return self._shown[name]

    def set_layer(self, name: str, shown: bool) -> None:
        """Show or hide one of ``LAYERS``."""
        self._shown[name] = shown
        if name in FIELDS:
            self._need(name)
            self._make_room()
            if self._look is not None:
                self.look_at(*self._look)
        self._show()
        self._move(self.index, self._told)

    def _show(self) -> None:
        for part in self.parts.values():
            part.item.setVisible(all(self._shown[layer] for layer in part.layers))
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
            self.set_index(round(fraction * self.reading.samples))

    def set_angle(self, theta: float) -> None:
        """Move to the sample nearest to cam angle theta [rad]; theta itself is told in the corner."""
        if self.reading is not None:
            self._move(round(theta / (2.0 * pi) * self.reading.samples), degrees(theta))

    # -- sight ----------------------------------------------------------------------------------------------

    def fit_rect(self) -> QRectF:
        """The rectangle that holds the mechanism over the whole turn [mm]."""
        if self.reading is None:
            return QRectF(-100.0, -100.0, 200.0, 200.0)
        low, high = self.reading.core_box
        rect = QRectF(low.real, low.imag, (high - low).real, (high - low).imag)
        for part in self.parts.values():
            if part.move is None and part.key.partition(".")[0] in ("rails", "ground", "pedestal"):
                rect = rect.united(part.item.boundingRect())
        for q in self.reading.near_centres[:: max(1, self.reading.near_centres.size // 100)]:
            rect = rect.united(QRectF(q.real, q.imag, 1e-9, 1e-9))
        room = MARGIN_UNITS * self.reading.unit
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

    def look_at(self, visible: QRectF, scale: float, keep_labels: bool = False) -> None:
        """Lay labels, scale bar and texts for a view that shows ``visible`` [mm] at ``scale`` [pixels per mm]."""
        self._look_at(visible, scale, self._labels.sides if self._labels is not None and keep_labels else {})

    def lay_labels(self) -> None:
        """Find the best side for each label."""
        if self._look is not None:
            self.look_at(*self._look)

    def _look_at(self, visible: QRectF, scale: float, sides: Mapping[str, int]) -> None:
        self._look = (visible, scale)
        if self._labels is not None and self.overlay is not None:
            low = complex(visible.left(), visible.top())
            if not self._labels.keep(sides, scale):
                self._labels.arrange((low, low + complex(visible.width(), visible.height())), scale)
            self.overlay.lay(visible, scale)
            self._move(self.index, self._told)
