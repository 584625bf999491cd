"""Image or DXF under the drawing of a linkage: placed by mouse or numbers, saved next to the design's file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QImageReader, QMouseEvent, QPainter, QPainterPath, QPen, QTransform
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSlider,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.bounds import PIXELS
from core.contour.underlay import DXF, ENDINGS, Underlay, read_lines, read_underlay, save_underlay
from core.design import NO_UNIT, UNITS, Info, Unit
from core.errors import FileError, KindynaError
from core.frozen import frozen
from kindyna_gui import dialogs
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.refusal import FloatingRefusal, accept_in_range
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.snapping import nearest_mark
from kindyna_gui.linkage.typed_values import Box, Typed, TypedBoxes
from kindyna_gui.look import described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import typed
from kindyna_gui.rebuilt import STRETCH, fill
from kindyna_gui.settings import Settings

MM, DEG = UNITS["mm"], UNITS["deg"]
SVG_MM = 25.4 / 96.0  # mm per pixel of an SVG
SVG_DOTS = 2400  # pixels of the longer side of an SVG as painted
SHARE = 0.8  # part of the visible region that a new image fills
LINE_OPACITY = 0.8  # initial opacity of the lines of a DXF


@frozen(eq=False)
class UnderlayContent:
    """Content of an underlay in its units: an image with width and height, or the lines and snap positions of a DXF."""

    image: QImage | None = None
    wide: float = 0.0
    high: float = 0.0
    lines: QPainterPath | None = None
    marks: Sequence[complex] = ()
    unit_mm: float = 0.0
    notes: Sequence[str] = ()

    def paint(self, painter: QPainter, underlay: Underlay, view: QTransform) -> None:
        """Paint at the position of the underlay, through the transformation of a view, mm to pixels."""
        origin, unit = underlay.to_plane(0.0), underlay.to_plane(1.0) - underlay.to_plane(0.0)
        painter.setOpacity(underlay.opacity)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        placed = QTransform(unit.real, unit.imag, -unit.imag, unit.real, origin.real, origin.imag) * view
        if self.image is not None:  # the y axis of an image points down
            painter.setTransform(QTransform(1.0, 0.0, 0.0, -1.0, 0.0, self.high) * placed)
            painter.drawImage(QRectF(0.0, 0.0, self.wide, self.high), self.image)
        elif self.lines is not None:
            painter.setPen(QPen(QColor(SCREEN.cam_line), 1.0))
            painter.drawPath(placed.map(self.lines))


def read_content(path: Path) -> UnderlayContent:
    """Read an image, an SVG or a DXF; raises KindynaError if it is missing or cannot be read."""
    ending = path.suffix.lower()
    if ending == DXF:
        drawn = read_lines(path)
        lines = QPainterPath()
        for z in drawn.lines:
            lines.moveTo(QPointF(z[0].real, z[0].imag))
            for at in z[1:].tolist():
                lines.lineTo(QPointF(at.real, at.imag))
        marks = [*drawn.corners.tolist(), *drawn.centres.tolist()]
        return UnderlayContent(lines=lines, marks=marks, unit_mm=drawn.unit_mm, notes=drawn.notes)
    if not path.is_file():
        raise FileError(f"{path}: no such file; choose another file, or restore this one")
    if ending == ".svg":
        from PySide6.QtSvg import QSvgRenderer

        renderer = QSvgRenderer(str(path))
        if renderer.isValid() and not renderer.defaultSize().isEmpty():
            size = renderer.defaultSize()
            image = QImage(
                size.scaled(SVG_DOTS, SVG_DOTS, Qt.AspectRatioMode.KeepAspectRatio), QImage.Format.Format_ARGB32
            )
            image.fill(Qt.GlobalColor.transparent)
            painter = QPainter(image)
            renderer.render(painter)
            painter.end()
            return UnderlayContent(image, size.width(), size.height(), unit_mm=SVG_MM)
    else:
        reader = QImageReader(str(path))
        reader.setAutoTransform(False)
        size = reader.size()
        if size.width() * size.height() > PIXELS:
            at_most = f"{typed(PIXELS / 1e6)} megapixels"
            raise FileError(f"{path}: {size.width()} x {size.height()} pixels; allowed: at most {at_most}")
        image = reader.read()
        if not image.isNull():
            return UnderlayContent(image, image.width(), image.height())
    raise FileError(f"{path}: cannot be read as an image; allowed: {' | '.join(ENDINGS)}")


@frozen
class PlacementMethod:
    """Placement with the mouse: by a drag, or by two clicks and a typed number."""

    text: str
    tip: str
    box: Box | None = None
    make: Callable[[Underlay, complex, complex, float], Underlay] | None = None


METHODS = {
    "move": PlacementMethod("&Move", "Drag the underlay to its position"),
    "scale": PlacementMethod("&Scale", "Click two points of the underlay, then type their distance", Box("distance", MM),
                             Underlay.scaled),
    "turn": PlacementMethod("&Turn", "Click two points on a line of the underlay, then type its angle", Box("angle", DEG),
                            Underlay.rotated),
}  # fmt: skip
FIELDS: Sequence[tuple[str, str, Unit | None]] = (
    ("&x", "x_mm", MM),
    ("&y", "y_mm", MM),
    ("mm of a &unit", "scale_mm_per_unit", None),
    ("&Angle", "angle_deg", DEG),
)


class UnderlayDesk(QObject):
    """Underlay of the current design: painted under the canvas, placed with the mouse, saved next to its file.

    message  (text): what to click, or why an image cannot be shown
    missing  why the underlay is not shown, or empty
    method   current placement with the mouse, one of ``METHODS``, or empty
    """

    message = Signal(str)

    def __init__(self, canvas: Canvas, session: Session, owner: QWidget) -> None:
        super().__init__(owner)
        self.canvas, self._session, self._owner = canvas, session, owner
        self.underlay: Underlay | None = None
        self.missing = ""
        self._content: UnderlayContent | None = None
        self._path: Path | None = None
        self._is_new = True
        self._panel: UnderlayPanel | None = None
        self.method = ""
        self._clicks: list[complex] = []
        self._grip: complex | None = None
        self._boxes = TypedBoxes(canvas.viewport(), canvas)
        self._boxes.message.connect(self.message)
        session.started.connect(self._mark_new)
        self.follow_file()

    # -- file of the design -------------------------------------------------------------------------------------

    def _mark_new(self) -> None:
        self._is_new = True

    def follow_file(self) -> None:
        """Load the underlay of a new design; copy it if the design was saved under another name."""
        if self._is_new:
            self._is_new, self._path = False, self._session.path
            try:
                self._show(read_underlay(self._path) if self._path is not None else None)
            except FileError as error:
                self._show(None)
                self._show_missing(str(error))
        elif self._path != self._session.path:
            self._path = self._session.path
            self._save()

    def _show_missing(self, text: str) -> None:
        self.missing = f"Underlay: {text}" if text else ""
        if text:
            self.message.emit(self.missing)

    def _show(self, underlay: Underlay | None) -> None:
        """Show another underlay, or none."""
        self.underlay, self._content = underlay, None
        self._show_missing("")
        if underlay is not None:
            try:
                self._content = read_content(underlay.file)
            except KindynaError as error:
                self._show_missing(str(error))
        self._update()
        if self._content is not None and self._content.notes:
            self.message.emit(f"Underlay: {'; '.join(self._content.notes)}")

    def _update(self) -> None:
        content, underlay = self._content, self.underlay
        shown = content is not None and underlay is not None
        self.canvas.under = self._paint if shown else None
        self.canvas.marks = [underlay.to_plane(z) for z in content.marks] if shown and content and underlay else ()
        if underlay is None or underlay.locked or not shown:
            self.choose_method("")
        if self._panel is not None:
            self._panel.show_underlay()
        self.canvas.viewport().update()

    def put(self, underlay: Underlay | None, save: bool = True) -> None:
        """Move, replace or remove the underlay; with ``save`` also in its file."""
        if underlay is None or self.underlay is None or underlay.file != self.underlay.file:
            self._show(underlay)
        else:
            self.underlay = underlay
            self._update()
        if save:
            self._save()

    def _save(self) -> None:
        if self._path is not None:
            try:
                save_underlay(self._path, self.underlay)
            except (FileError, OSError) as error:
                self.message.emit(f"The underlay is not saved: {error}")

    def choose_file(self) -> None:
        """Ask for a file and show it: image or SVG in the middle of the visible region, DXF at its coordinates."""
        kinds = f"Pictures and drawings ({' '.join(f'*{ending}' for ending in ENDINGS)})"
        path = dialogs.file_to_open(self._panel or self._owner, "Underlay", kinds)
        if path is None:
            return
        Settings().folder = path.parent
        try:
            content = read_content(path)
        except KindynaError as error:
            dialogs.show_faults(self._panel or self._owner, f"{path.name} cannot be shown.", str(error).splitlines())
            return
        visible = self.canvas.visible
        if content.lines is not None:
            self.put(Underlay(path, scale_mm_per_unit=content.unit_mm, opacity=LINE_OPACITY))
            return
        scale = content.unit_mm or SHARE * min(visible.width() / content.wide, visible.height() / content.high)
        middle = visible.center()
        self.put(
            Underlay(path, middle.x() - 0.5 * scale * content.wide, middle.y() - 0.5 * scale * content.high, scale)
        )

    def _paint(self, painter: QPainter) -> None:
        if self._content is None or self.underlay is None:
            return
        self._content.paint(painter, self.underlay, self.canvas.viewportTransform())
        painter.resetTransform()
        painter.setOpacity(1.0)
        painter.setPen(QPen(QColor(SCREEN.chosen), 2.0))
        for at in self._clicks:
            painter.drawEllipse(self.canvas.pixel_at(at), 6.0, 6.0)

    # -- placement with the mouse -------------------------------------------------------------------------------

    def show_panel(self) -> None:
        """Open the panel; ask for a file if there is no underlay yet."""
        if self._panel is None:
            self._panel = UnderlayPanel(self, self._owner)
        self._panel.show_underlay()
        self._panel.show()
        self._panel.raise_()
        if self.underlay is None:
            self.choose_file()

    def choose_method(self, method: str) -> None:
        """Place with the mouse by one of ``METHODS``; empty ends placing."""
        self._boxes.close_all()
        self._clicks, self._grip = [], None
        viewport = self.canvas.viewport()
        viewport.removeEventFilter(self)
        if method:
            viewport.installEventFilter(self)
            self.message.emit(METHODS[method].tip)
        if method != self.method:
            self.method = method
            if self._panel is not None:
                self._panel.show_method(method)
        viewport.update()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if not isinstance(event, QMouseEvent) or self.underlay is None:
            return False
        kind, left = event.type(), Qt.MouseButton.LeftButton
        at = self.canvas.position_at(event.position())
        if self.method == "move":
            if kind == QEvent.Type.MouseButtonPress and event.button() == left:
                self._grip = at
            elif kind == QEvent.Type.MouseMove and self._grip is not None:
                self.put(self.underlay.shifted(at - self._grip), save=False)
                self._grip = at
            elif kind == QEvent.Type.MouseButtonRelease and event.button() == left:
                self._grip = None
                self._save()
            else:
                return bool(event.buttons() & left)
            return True
        if kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonDblClick) and event.button() == left:
            self._click(at, event.position())
        return event.button() == left or bool(event.buttons() & left)

    def _click(self, at: complex, pixel: QPointF) -> None:
        mark = nearest_mark(self.canvas.marks, at, self.canvas.scale_now)
        box = METHODS[self.method].box
        before = self._clicks if len(self._clicks) < 2 else []
        self._clicks = [*before, at if mark is None else mark]
        if len(self._clicks) == 2 and box is not None:
            self.canvas.activateWindow()  # keys go to the panel before
            self._boxes.ask(pixel.toPoint(), (box,), self._accept)
        self.canvas.viewport().update()

    def _accept(self, values: Sequence[Typed]) -> str:
        make, (value,) = METHODS[self.method].make, values
        if make is None or self.underlay is None or not isinstance(value, float):
            return "type a number"
        try:
            placed = make(self.underlay, self._clicks[0], self._clicks[1], value)
        except KindynaError as error:
            return str(error)
        self.choose_method("")
        self.put(placed)
        return ""


class UnderlayPanel(QDialog):
    """Position, scale, angle and opacity of the underlay as numbers, and the placements with the mouse."""

    def __init__(self, desk: UnderlayDesk, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Tool)
        self.setWindowTitle("Underlay")
        # keys of a tool window go to the main window
        self.setProperty(dialogs.HELP, "linkages#An image under the drawing")
        self._desk = desk
        self.name = QLabel()
        choose = QPushButton("&Choose...")
        choose.clicked.connect(lambda *_: desk.choose_file())
        self.remove = QPushButton("&Remove")
        self.remove.clicked.connect(lambda *_: desk.put(None))
        self.boxes: dict[str, NumberBox] = {}
        self.refusals: dict[str, FloatingRefusal] = {}
        form = fill(QFormLayout(), self.name, _row(choose, self.remove))
        for label, name, unit in FIELDS:
            plain = label.replace("&", "")
            info = Info(plain) if unit is not None else Info(plain, low=0.0, open_low=True)
            box = NumberBox(info, unit or NO_UNIT)
            self.refusals[name] = FloatingRefusal(box)
            accept_in_range(box, self.refusals[name], partial(self._put, name))
            self.boxes[name] = box
            form.addRow(f"{label}, {unit.symbol}" if unit is not None else label, box)
        self.opacity = described(QSlider(Qt.Orientation.Horizontal), name="Opacity")
        self.opacity.setRange(0, 100)
        self.opacity.valueChanged.connect(lambda value: self._put("opacity", value / 100.0))
        form.addRow("&Opacity", self.opacity)
        self.locked = described(QCheckBox("&Locked"), tip="Fixes the position of the underlay")
        self.locked.toggled.connect(partial(self._put, "locked"))
        form.addRow(self.locked)
        self.method_buttons: dict[str, QToolButton] = {}
        for name, method in METHODS.items():
            button = described(QToolButton(), tip=method.tip)
            button.setText(method.text)
            button.setCheckable(True)
            button.clicked.connect(lambda on, name=name: desk.choose_method(name if on else ""))
            self.method_buttons[name] = button
        form.addRow(_row(*self.method_buttons.values()))
        fill(QVBoxLayout(self), form)
        self.finished.connect(lambda *_: desk.choose_method(""))

    def sizeHint(self) -> QSize:
        return super().sizeHint().expandedTo(QSize(250, 0))

    def show_method(self, method: str) -> None:
        """Press the button of the current placement."""
        for name, button in self.method_buttons.items():
            button.setChecked(name == method)

    def show_underlay(self) -> None:
        """Show the values of the underlay."""
        underlay = self._desk.underlay
        self.name.setText(underlay.file.name if underlay is not None else "No image")
        self.name.setToolTip(str(underlay.file) if underlay is not None else "")
        free = underlay is not None and not underlay.locked
        for name, box in self.boxes.items():
            self.refusals[name].show_refusal("")
            box.show_value(None if underlay is None else getattr(underlay, name))
            box.setEnabled(free)
        for widget in (self.opacity, self.locked):
            widget.blockSignals(True)
            widget.setEnabled(underlay is not None)
        self.opacity.setValue(round(100.0 * underlay.opacity) if underlay is not None else 50)
        self.locked.setChecked(underlay is not None and underlay.locked)
        for widget in (self.opacity, self.locked):
            widget.blockSignals(False)
        for button in self.method_buttons.values():
            button.setEnabled(free and not self._desk.missing)
        self.remove.setEnabled(underlay is not None)

    def _put(self, name: str, value: Any) -> None:
        if self._desk.underlay is not None:
            self._desk.put(replace(self._desk.underlay, **{name: value}))


def _row(*widgets: QWidget) -> QHBoxLayout:
    row = fill(QHBoxLayout(), *widgets, STRETCH, margins=0)
    return row
