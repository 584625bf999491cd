"""A picture under the drawing of a linkage: chosen, placed by the mouse or by numbers, and kept beside the design's file."""

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
from core.design import UNITS, Info, Unit
from core.errors import FileError, KindynaError
from core.frozen import frozen
from kindyna_gui import dialogs
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.draw_tools import nearest_mark
from kindyna_gui.linkage.typed_values import Box, Typed, TypedBoxes
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.settings import Settings

MM, DEG = UNITS["mm"], UNITS["deg"]
SVG_MM = 25.4 / 96.0  # of a pixel of an SVG
SVG_DOTS = 2400  # of the longer side of one, as it is painted
SHARE = 0.8  # of the width in sight that a new picture takes
LINES_SEEN = 0.8  # of a DXF's lines, in a colour that the grid does not have


@frozen(eq=False)
class Sheet:
    """What an underlay shows: a picture so many units wide and high, or lines; and places of a DXF that are snapped to, in its units."""

    image: QImage | None = None
    wide: float = 0.0
    high: float = 0.0
    lines: QPainterPath | None = None
    marks: Sequence[complex] = ()
    unit_mm: float = 0.0
    notes: Sequence[str] = ()

    def paint(self, painter: QPainter, underlay: Underlay, view: QTransform) -> None:
        """As it lies, seen through a view of the plane."""
        origin, unit = underlay.to_plane(0.0), underlay.to_plane(1.0) - underlay.to_plane(0.0)
        painter.setOpacity(underlay.opacity)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        placed = QTransform(unit.real, unit.imag, -unit.imag, unit.real, origin.real, origin.imag) * view
        if self.image is not None:  # its rows run downwards
            painter.setTransform(QTransform(1.0, 0.0, 0.0, -1.0, 0.0, self.high) * placed)
            painter.drawImage(QRectF(0.0, 0.0, self.wide, self.high), self.image)
        elif self.lines is not None:
            painter.setPen(QPen(QColor(SCREEN.cam_line), 1.0))
            painter.drawPath(placed.map(self.lines))


def read_sheet(path: Path) -> Sheet:
    """Raises KindynaError where it is missing, or no picture."""
    ending = path.suffix.lower()
    if ending == DXF:
        drawn = read_lines(path)
        lines = QPainterPath()
        for z in drawn.lines:
            lines.moveTo(QPointF(z[0].real, z[0].imag))
            for at in z[1:].tolist():
                lines.lineTo(QPointF(at.real, at.imag))
        marks = [*drawn.corners.tolist(), *drawn.centres.tolist()]
        return Sheet(lines=lines, marks=marks, unit_mm=drawn.unit_mm, notes=drawn.notes)
    if not path.is_file():
        raise FileError(f"{path}: no such file; choose another, or put it back")
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
            return Sheet(image, size.width(), size.height(), unit_mm=SVG_MM)
    else:
        reader = QImageReader(str(path))
        reader.setAutoTransform(False)
        size = reader.size()
        if size.width() * size.height() > PIXELS:
            at_most = f"{PIXELS / 1e6:g} megapixels"
            raise FileError(f"{path}: {size.width()} x {size.height()} pixels; allowed: at most {at_most}")
        image = reader.read()
        if not image.isNull():
            return Sheet(image, image.width(), image.height())
    raise FileError(f"{path}: no picture that can be read; allowed: {' | '.join(ENDINGS)}")


@frozen
class Way:
    """How the mouse places: by a drag, or by two places clicked and a number typed."""

    text: str
    tip: str
    box: Box | None = None
    make: Callable[[Underlay, complex, complex, float], Underlay] | None = None


WAYS = {
    "move": Way("&Move", "Drag the underlay to its place"),
    "scale": Way("&Scale", "Click two places of the underlay, then type how far they are apart", Box("distance", MM), Underlay.scaled),
    "turn": Way("&Turn", "Click two places on a line of the underlay, then type its angle", Box("angle", DEG), Underlay.rotated),
}  # fmt: skip
FIELDS: Sequence[tuple[str, str, Unit | None]] = (
    ("&x", "x_mm", MM),
    ("&y", "y_mm", MM),
    ("mm of a &unit", "scale_mm_per_unit", None),
    ("&Angle", "angle_deg", DEG),
)


class UnderlayDesk(QObject):
    """The underlay of the design in place: painted under the canvas, placed with the mouse, kept beside the design's file.

    told  (text): what is to be clicked, or why a picture cannot be shown
    """

    told = Signal(str)

    def __init__(self, canvas: Canvas, session: Session, owner: QWidget) -> None:
        super().__init__(owner)
        self.canvas, self._session, self._owner = canvas, session, owner
        self.underlay: Underlay | None = None
        self.missing = ""  # why the picture is not shown
        self._sheet: Sheet | None = None
        self._path: Path | None = None
        self._begun = True
        self._panel: UnderlayPanel | None = None
        self.way = ""
        self._places: list[complex] = []
        self._grip: complex | None = None
        self._boxes = TypedBoxes(canvas.viewport(), canvas)
        session.started.connect(self._begin)
        self.follow_file()

    # -- of the design in place ---------------------------------------------------------------------------------

    def _begin(self) -> None:
        self._begun = True

    def follow_file(self) -> None:
        """Another design brings its own underlay; one that is saved under another name takes its underlay with it."""
        if self._begun:
            self._begun, self._path = False, self._session.path
            try:
                self._show(read_underlay(self._path) if self._path is not None else None)
            except FileError as error:
                self._show(None)
                self._tell_missing(str(error))
        elif self._path != self._session.path:
            self._path = self._session.path
            self._keep()

    def _tell_missing(self, text: str) -> None:
        self.missing = f"Underlay: {text}" if text else ""
        if text:
            self.told.emit(self.missing)

    def _show(self, underlay: Underlay | None) -> None:
        """Another one, or none, is in place."""
        self.underlay, self._sheet = underlay, None
        self._tell_missing("")
        if underlay is not None:
            try:
                self._sheet = read_sheet(underlay.file)
            except KindynaError as error:
                self._tell_missing(str(error))
        self._placed()
        if self._sheet is not None and self._sheet.notes:
            self.told.emit(f"Underlay: {'; '.join(self._sheet.notes)}")

    def _placed(self) -> None:
        sheet, underlay = self._sheet, self.underlay
        shown = sheet is not None and underlay is not None
        self.canvas.under = self._paint if shown else None
        self.canvas.marks = [underlay.to_plane(z) for z in sheet.marks] if shown and sheet and underlay else ()
        if underlay is None or underlay.locked or not shown:
            self.take_way("")
        if self._panel is not None:
            self._panel.show_underlay()
        self.canvas.viewport().update()

    def put(self, underlay: Underlay | None, keep: bool = True) -> None:
        """Placed otherwise, or taken away; keep: in its file, too."""
        if underlay is None or self.underlay is None or underlay.file != self.underlay.file:
            self._show(underlay)
        else:
            self.underlay = underlay
            self._placed()
        if keep:
            self._keep()

    def _keep(self) -> None:
        if self._path is not None:
            try:
                save_underlay(self._path, self.underlay)
            except (FileError, OSError) as error:
                self.told.emit(f"The underlay is not kept: {error}")

    def choose_file(self) -> None:
        """Ask for another picture; it comes into the middle of what is seen, a DXF and an SVG in their own size."""
        kinds = f"Pictures and drawings ({' '.join(f'*{ending}' for ending in ENDINGS)})"
        path = dialogs.file_to_open(self._panel or self._owner, "Underlay", kinds)
        if path is None:
            return
        Settings().folder = path.parent
        try:
            sheet = read_sheet(path)
        except KindynaError as error:
            dialogs.show_faults(self._panel or self._owner, f"{path.name} cannot be shown.", str(error).splitlines())
            return
        seen = self.canvas.visible
        if sheet.lines is not None:
            self.put(Underlay(path, scale_mm_per_unit=sheet.unit_mm, opacity=LINES_SEEN))
            return
        scale = sheet.unit_mm or SHARE * min(seen.width() / sheet.wide, seen.height() / sheet.high)
        middle = seen.center()
        self.put(Underlay(path, middle.x() - 0.5 * scale * sheet.wide, middle.y() - 0.5 * scale * sheet.high, scale))

    def _paint(self, painter: QPainter) -> None:
        if self._sheet is None or self.underlay is None:
            return
        self._sheet.paint(painter, self.underlay, self.canvas.viewportTransform())
        painter.resetTransform()
        painter.setOpacity(1.0)
        painter.setPen(QPen(QColor(SCREEN.chosen), 2.0))
        for at in self._places:
            painter.drawEllipse(self._pixel(at), 6.0, 6.0)

    # -- by the mouse -------------------------------------------------------------------------------------------

    def show_panel(self) -> None:
        """Open its panel; where there is no picture yet, ask for one."""
        if self._panel is None:
            self._panel = UnderlayPanel(self, self._owner)
        self._panel.show_underlay()
        self._panel.show()
        self._panel.raise_()
        if self.underlay is None:
            self.choose_file()

    def take_way(self, way: str) -> None:
        """The mouse places by one of ``WAYS`` from now on; empty: it does what it does without."""
        self._boxes.close_all()
        self._places, self._grip = [], None
        viewport = self.canvas.viewport()
        viewport.removeEventFilter(self)
        if way:
            viewport.installEventFilter(self)
            self.told.emit(WAYS[way].tip)
        if way != self.way:
            self.way = way
            if self._panel is not None:
                self._panel.show_way(way)
        viewport.update()

    def _at(self, pixel: QPointF) -> complex:
        inverse, _ = self.canvas.viewportTransform().inverted()
        at = inverse.map(pixel)
        return complex(at.x(), at.y())

    def _pixel(self, at: complex) -> QPointF:
        return self.canvas.viewportTransform().map(QPointF(at.real, at.imag))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if not isinstance(event, QMouseEvent) or self.underlay is None:
            return False
        kind, left = event.type(), Qt.MouseButton.LeftButton
        at = self._at(event.position())
        if self.way == "move":
            if kind == QEvent.Type.MouseButtonPress and event.button() == left:
                self._grip = at
            elif kind == QEvent.Type.MouseMove and self._grip is not None:
                self.put(self.underlay.shifted(at - self._grip), keep=False)
                self._grip = at
            elif kind == QEvent.Type.MouseButtonRelease and event.button() == left:
                self._grip = None
                self._keep()
            else:
                return bool(event.buttons() & left)
            return True
        if kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonDblClick) and event.button() == left:
            self._click(at, event.position())
        return event.button() == left or bool(event.buttons() & left)

    def _click(self, at: complex, pixel: QPointF) -> None:
        mark = nearest_mark(self.canvas.marks, at, self.canvas.scale_now)
        box = WAYS[self.way].box
        before = self._places if len(self._places) < 2 else []
        self._places = [*before, at if mark is None else mark]
        if len(self._places) == 2 and box is not None:
            self.canvas.activateWindow()  # the panel has the keys until then
            self._boxes.ask(pixel.toPoint(), (box,), self._take)
        self.canvas.viewport().update()

    def _take(self, values: Sequence[Typed]) -> str:
        make, (value,) = WAYS[self.way].make, values
        if make is None or self.underlay is None or not isinstance(value, float):
            return "a number"
        try:
            placed = make(self.underlay, self._places[0], self._places[1], value)
        except KindynaError as error:
            return str(error)
        self.take_way("")
        self.put(placed)
        return ""


class UnderlayPanel(QDialog):
    """Where the underlay lies, in numbers, and what the mouse does with it."""

    def __init__(self, desk: UnderlayDesk, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Tool)
        self.setWindowTitle("Underlay")
        self.setProperty(dialogs.HELP, "linkages#A picture under it")  # a tool's keys are those of the window
        self._desk = desk
        self.name = QLabel()
        choose = QPushButton("&Choose...")
        choose.clicked.connect(lambda *_: desk.choose_file())
        self.remove = QPushButton("&Remove")
        self.remove.clicked.connect(lambda *_: desk.put(None))
        self.boxes: dict[str, NumberBox] = {}
        form = QFormLayout()
        form.addRow(self.name)
        form.addRow(_row(choose, self.remove))
        for label, name, unit in FIELDS:
            box = NumberBox(Info(label.replace("&", "")), unit) if unit is not None else NumberBox(Info("mm of a unit"))
            box.entered.connect(partial(self._enter, name))
            self.boxes[name] = box
            form.addRow(f"{label}, {unit.symbol}" if unit is not None else label, box)
        self.opacity = QSlider(Qt.Orientation.Horizontal)
        self.opacity.setRange(0, 100)
        self.opacity.setAccessibleName("Opacity")
        self.opacity.valueChanged.connect(lambda value: self._put("opacity", value / 100.0))
        form.addRow("&Opacity", self.opacity)
        self.locked = QCheckBox("&Locked")
        self.locked.setToolTip("Neither the mouse nor a number moves it")
        self.locked.toggled.connect(partial(self._put, "locked"))
        form.addRow(self.locked)
        self.ways: dict[str, QToolButton] = {}
        for name, way in WAYS.items():
            button = QToolButton()
            button.setText(way.text)
            button.setToolTip(way.tip)
            button.setCheckable(True)
            button.clicked.connect(lambda on, name=name: desk.take_way(name if on else ""))
            self.ways[name] = button
        form.addRow(_row(*self.ways.values()))
        column = QVBoxLayout(self)
        column.addLayout(form)
        self.finished.connect(lambda *_: desk.take_way(""))

    def sizeHint(self) -> QSize:
        return super().sizeHint().expandedTo(QSize(250, 0))

    def show_way(self, way: str) -> None:
        """The button of what the mouse does is down."""
        for name, button in self.ways.items():
            button.setChecked(name == way)

    def show_underlay(self) -> None:
        """What lies under the drawing now."""
        underlay = self._desk.underlay
        self.name.setText(underlay.file.name if underlay is not None else "No picture")
        self.name.setToolTip(str(underlay.file) if underlay is not None else "")
        free = underlay is not None and not underlay.locked
        for name, box in self.boxes.items():
            box.set_refused(False)
            box.show_value(None if underlay is None else getattr(underlay, name))
            box.setEnabled(free)
        for widget in (self.opacity, self.locked):
            widget.blockSignals(True)
            widget.setEnabled(underlay is not None)
        self.opacity.setValue(round(100.0 * underlay.opacity) if underlay is not None else 50)
        self.locked.setChecked(underlay is not None and underlay.locked)
        for widget in (self.opacity, self.locked):
            widget.blockSignals(False)
        for button in self.ways.values():
            button.setEnabled(free and not self._desk.missing)
        self.remove.setEnabled(underlay is not None)

    def _enter(self, name: str, value: float | None) -> None:
        if value is None or (name == "scale_mm_per_unit" and not value > 0.0):
            self.boxes[name].set_refused(True)
        else:
            self._put(name, value)

    def _put(self, name: str, value: Any) -> None:
        if self._desk.underlay is not None:
            self._desk.put(replace(self._desk.underlay, **{name: value}))


def _row(*widgets: QWidget) -> QHBoxLayout:
    row = QHBoxLayout()
    row.setContentsMargins(0, 0, 0, 0)
    for widget in widgets:
        row.addWidget(widget)
    row.addStretch(1)
    return row


__all__ = ["UnderlayDesk", "UnderlayPanel", "read_sheet"]
