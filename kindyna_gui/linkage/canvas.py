"""Canvas of a mechanism: zoom, pan, hit tests and mouse events; and the outline of the pinned variant."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPen,
    QPolygonF,
    QResizeEvent,
    QTransform,
    QWheelEvent,
)
from PySide6.QtWidgets import QFrame, QGraphicsView

from core.errors import KindynaError
from core.mechanism.kinematics import FRAME
from core.study import Study
from kindyna_gui.pictures.drawing.assembly import Assembly
from kindyna_gui.pictures.drawing.geometry import space_views
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.shapes import curve, joined, outline
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import nearest
from kindyna_gui.rebuilt import single_shot

if TYPE_CHECKING:
    from core.spatial.views import CamViews

NOTCH, STEP = 120.0, 1.25  # angle of a notch of the wheel, and its zoom factor
FURTHEST, CLOSEST = 0.05, 400.0  # zoom limits relative to the scale that fits the mechanism
HALF_EMPTY = 0.45  # the mechanism is fitted again if it fills less than this part of the canvas
REACH = 9.0  # distance within which a joint is hit, pixels
RIM = 4.0  # distance within which a circle is hit, pixels
MASSES = "masses"  # a layer, and a list of the loads
REST_MS = 250  # delay after an edit or a move before labels are placed again
MM = 1e3  # per metre
OUTLINE_WIDTH = 1.0  # pixels; Qt takes many times as long for wider lines
_GRIPS = (Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton)

# -- canvas ----------------------------------------------------------------------------------------------


def draggable_joints(scene: MechanismScene | Assembly) -> dict[str, complex]:
    """Positions [mm] of the joints that can be dragged, by the names of their points."""
    from core.followers.dragging import joints_of  # its import takes longer than drawing the mechanism

    geometry = scene.geometry
    if geometry is None:
        return {}
    joints = joints_of(geometry.study.design)
    for layer, prefix in ((MASSES, f"loads.{MASSES}"), ("outlines", "outlines[")):  # hidden ones are not dragged
        if isinstance(scene, MechanismScene) and not scene.layer_selected(layer):
            joints = {name: drag for name, drag in joints.items() if not name.startswith(prefix)}
    return {name: position for name, position in geometry.handles(scene.index).items() if name in joints}


def draggable_circles(scene: MechanismScene | Assembly) -> dict[str, tuple[complex, float]]:
    """Centre and radius [mm] of the circles that can be dragged, by the paths of their fields."""
    from core.followers.dragging import rims_of

    geometry = scene.geometry
    if geometry is None or isinstance(scene, Assembly):
        return {}
    paths = rims_of(geometry.study.design)
    return {path: rim for path, rim in geometry.rims(scene.index).items() if path in paths}


class Canvas(QGraphicsView):
    """View of a scene in mm, y upwards: the wheel zooms about the mouse, a drag pans, a double click fits.

    The visible region is a centre and a scale, without Qt's scroll bars and transformation anchors, so that neither an
    edit nor a change of size moves it.

    joint_pressed   (name): a joint was pressed
    joint_dragged   (name, position [mm]): the joint was dragged to a position
    joint_released  (name): the joint was released
    clicked         (position [mm]): a click
    menu_requested  (position [mm], position on the screen): request of a context menu
    hovered         (position [mm]): the mouse without a drag; None outside the canvas or during a drag
    run_ended       the drag begun by ``start_run`` has ended

    fitted          the mechanism fits the canvas at every size; False after zoom and pan
    picking         the next click picks something, so joints are not dragged
    over, under     functions that paint over and under the scene, in pixels
    marks           snap positions [mm] of what is painted under the scene
    start_run       (position pressed [mm]) -> function of the mouse position during the drag; None pans
    """

    joint_pressed, joint_dragged, joint_released = Signal(str), Signal(str, complex), Signal(str)
    hovered = Signal(object)
    clicked = Signal(complex)
    menu_requested = Signal(complex, QPoint)
    run_ended = Signal()

    def __init__(self, scene: MechanismScene | Assembly) -> None:
        super().__init__(scene)
        self._joint = ""
        self._scene = scene
        self.setAccessibleName("Drawing of the mechanism")
        self.fitted = True
        self._picking = self._has_moved = False
        self.over: Callable[[QPainter], object] | None = None
        self.under: Callable[[QPainter], object] | None = None
        self.marks: Sequence[complex] = ()
        self.start_run: Callable[[complex], Callable[[complex], object] | None] | None = None
        self._run: Callable[[complex], object] | None = None
        self._centre, self._scale = QPointF(), 1.0
        self._grip: QPointF | None = None
        self._pressed = QPointF()
        self.rest = single_shot(self, scene.lay_labels, REST_MS)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.TextAntialiasing)
        # nearly all items move in every frame, and lines of constant width extend beyond the bounds that Qt computes
        self.setViewportUpdateMode(QGraphicsView.ViewportUpdateMode.FullViewportUpdate)
        self.setTransformationAnchor(QGraphicsView.ViewportAnchor.NoAnchor)
        self.setResizeAnchor(QGraphicsView.ViewportAnchor.NoAnchor)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.ArrowCursor)
        self.viewport().setMouseTracking(True)

    # -- visible region -----------------------------------------------------------------------------------

    @property
    def drawn(self) -> MechanismScene | Assembly:
        """The scene."""
        return self._scene

    @property
    def picking(self) -> bool:
        """Whether the next click picks something."""
        return self._picking

    @picking.setter
    def picking(self, on: bool) -> None:
        self._picking = on
        self.setCursor(Qt.CursorShape.CrossCursor if on else Qt.CursorShape.ArrowCursor)

    @property
    def scale_now(self) -> float:
        """Pixels per mm."""
        return self._scale

    @property
    def visible(self) -> QRectF:
        """Visible region [mm]."""
        rect = QRectF(0.0, 0.0, self.viewport().width() / self._scale, self.viewport().height() / self._scale)
        rect.moveCenter(self._centre)
        return rect

    def show_region(self, centre: QPointF, scale: float, keep_labels: bool = False) -> None:
        """Show the region around a point at a scale [pixels/mm]; ``keep_labels`` places labels after a delay."""
        self._centre, self._scale = centre, scale
        self.setTransform(QTransform.fromScale(scale, -scale))
        visible = self.visible
        self.setSceneRect(visible)
        self._scene.show_region(visible, scale, keep_labels)
        if keep_labels:
            self.rest.start()
        else:  # they have just been placed
            self.rest.stop()

    def fit(self, keep_labels: bool = False) -> None:
        """Show the whole mechanism."""
        visible, scale = self._scene.fit(self.viewport().width(), self.viewport().height())
        self.show_region(visible.center(), scale, keep_labels)
        self.fitted = True

    def update_style(self) -> None:
        """Apply a change of theme or font; the zoom does not change."""
        if not self._scene.update_style():
            return
        if self.fitted:
            self.fit()
        else:
            self._scene.lay_labels()

    def show_again(self) -> None:
        """Keep the visible region after an edit, unless a fitted mechanism no longer fits, or has become small."""
        if self.fitted and not self._joint:  # the region does not change during a drag
            region, scale = self._scene.fit(self.viewport().width(), self.viewport().height())
            if not self.visible.contains(self._scene.least_rect()) or self._scale < HALF_EMPTY * scale:
                self.show_region(region.center(), scale, keep_labels=True)

    def zoom(self, factor: float, about: QPointF) -> None:
        """Zoom by a factor about a fixed pixel of the viewport."""
        _, fit_scale = self._scene.fit(self.viewport().width(), self.viewport().height())
        scale = min(max(self._scale * factor, FURTHEST * fit_scale), CLOSEST * fit_scale)
        fixed = self._position(about)
        offset = (self._centre - fixed) * (self._scale / scale)
        self.show_region(fixed + offset, scale, keep_labels=True)
        self.fitted = False

    def _position(self, pixel: QPointF) -> QPointF:
        """Position [mm] at a pixel of the viewport."""
        x = pixel.x() - self.viewport().width() / 2.0
        y = pixel.y() - self.viewport().height() / 2.0
        return self._centre + QPointF(x / self._scale, -y / self._scale)

    def position_at(self, pixel: QPointF) -> complex:
        """Position [mm] at a pixel as Qt has drawn it, which moves the scene to whole pixels."""
        inverse, _ = self.viewportTransform().inverted()
        at = inverse.map(pixel)
        return complex(at.x(), at.y())

    def pixel_at(self, position: complex) -> QPointF:
        """Pixel of the viewport at a position [mm]."""
        return self.viewportTransform().map(QPointF(position.real, position.imag))

    def joint_at(self, pixel: QPointF, rims: bool = True) -> str:
        """Name of the draggable joint, or with ``rims`` path of the circle, under a pixel; empty if there is none."""
        if self._picking:
            return ""
        position = self.position_at(pixel)
        joints = draggable_joints(self._scene)
        distances = {name: abs(at - position) * self._scale for name, at in joints.items()}
        if joint := _nearest_key(distances, REACH):
            return joint
        distances = {
            path: abs(abs(position - centre) - radius) * self._scale
            for path, (centre, radius) in (draggable_circles(self._scene) if rims else {}).items()
        }
        return _nearest_key(distances, RIM)

    @property
    def _rest_cursor(self) -> Qt.CursorShape:
        return Qt.CursorShape.CrossCursor if self._picking else Qt.CursorShape.ArrowCursor

    def paint_under(self, painter: QPainter) -> None:
        """Paint what is under the scene."""
        _paint_in_pixels(painter, self.under)

    def drawBackground(self, painter: QPainter, rect: QRectF | QRect) -> None:
        super().drawBackground(painter, rect)
        self.paint_under(painter)

    def drawForeground(self, painter: QPainter, rect: QRectF | QRect) -> None:
        super().drawForeground(painter, rect)
        _paint_in_pixels(painter, self.over)

    # -- mouse events -------------------------------------------------------------------------------------

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        if not self._joint and not self._picking:
            self.menu_requested.emit(
                self.position_at(QPointF(self.viewport().mapFrom(self, event.pos()))), event.globalPos()
            )

    def end_drag(self) -> None:
        """End the drag, even if the button is still pressed."""
        self._joint = ""
        if self._run is not None:
            self._run = lambda _: None

    @property
    def pressed_position(self) -> complex:
        """Position of the last press [mm]."""
        return self.position_at(self._pressed)

    def wheelEvent(self, event: QWheelEvent) -> None:
        if angle := event.angleDelta().y() or event.pixelDelta().y():
            self.zoom(STEP ** (angle / NOTCH), event.position())
        event.accept()

    def leaveEvent(self, event: QEvent) -> None:
        self.hovered.emit(None)
        super().leaveEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self.hovered.emit(None)
        joint = self.joint_at(event.position()) if event.button() == Qt.MouseButton.LeftButton else ""
        self._has_moved = False
        if joint:
            self._joint, self._pressed = joint, event.position()
            self.joint_pressed.emit(joint)
        elif event.button() in _GRIPS:
            if event.button() == Qt.MouseButton.LeftButton and self.start_run is not None and not self._picking:
                self._run = self.start_run(self.position_at(event.position()))
            self._grip = self._pressed = event.position()
            self.setCursor(Qt.CursorShape.ClosedHandCursor)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._joint:
            self._has_moved = True
            self.joint_dragged.emit(self._joint, self.position_at(event.position()))
            return
        if self._grip is None:
            over = self.joint_at(event.position())
            self.setCursor(Qt.CursorShape.SizeAllCursor if over else self._rest_cursor)
            self.hovered.emit(self.position_at(event.position()))
            return
        if event.position() == self._grip:
            return
        if self._run is not None:
            self._run(self.position_at(event.position()))
            return
        shift = event.position() - self._grip
        self._grip = event.position()
        self.show_region(
            self._centre - QPointF(shift.x() / self._scale, -shift.y() / self._scale), self._scale, keep_labels=True
        )
        self.fitted = False

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._joint and event.button() == Qt.MouseButton.LeftButton:
            name, self._joint = self._joint, ""
            self.joint_released.emit(name)
            self.show_again()
            if not self._has_moved:
                self.clicked.emit(self.position_at(event.position()))
        elif event.button() in _GRIPS:
            run, self._grip, self._run = self._run, None, None
            if run is not None:
                self.run_ended.emit()
            self.setCursor(self._rest_cursor)
            if event.position() == self._pressed and event.button() == Qt.MouseButton.LeftButton:
                self.clicked.emit(self.position_at(event.position()))

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self.fit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        event.ignore()  # the arrow keys move the player, and do not scroll

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if self.fitted:
            self.fit(keep_labels=True)
        else:
            self.show_region(self._centre, self._scale, keep_labels=True)


def _nearest_key(distances: Mapping[str, float], reach: float) -> str:
    """Key of the smallest distance; empty if none is within reach."""
    key = min(distances, key=lambda name: distances[name], default="")
    return key if key and distances[key] <= reach else ""


def _paint_in_pixels(painter: QPainter, paint: Callable[[QPainter], object] | None) -> None:
    if paint is not None:
        painter.save()
        painter.resetTransform()
        paint(painter)
        painter.restore()


# -- pinned variant --------------------------------------------------------------------------------------


class PinnedOutline:
    """Outline of the pinned variant, in mm, y upwards."""

    def __init__(self, study: Study) -> None:
        self.study = study

    @cached_property
    def _outline(self) -> QPainterPath:
        """Outline of the cam in its frame."""
        assert self.study.shape is not None
        return joined(*(outline(MM * flank.profile) for flank in self.study.shape.flanks))

    @cached_property
    def _views(self) -> CamViews | None:
        """Views of a cam in space."""
        try:
            return space_views(self.study) if self.study.has_surface else None
        except KindynaError:
            return None

    def path(self, theta: float) -> QPainterPath:
        """Outline of cam and follower face, links as lines between their points; empty if there is no solution."""
        path = QPainterPath()
        try:
            kinematics, shape = self.study.linkage, self.study.shape
        except KindynaError:
            return path
        at = nearest(self.study.theta, theta)
        for name, pose in kinematics.bodies.items():
            points = [
                complex(np.broadcast_to(pose.position(point), self.study.theta.shape)[at]) for point in pose.points
            ]
            if name != FRAME and len(points) > 1:
                path.addPolygon(_polygon(points + points[:1]))
        if self._views is not None:
            angle = self.study.sense * float(self.study.theta[at])
            centre, radius = MM * self._views.end_origin, MM * self._views.radii[0]
            path.addEllipse(QPointF(centre.real, centre.imag), radius, radius)
            lines = [
                self._views.outline(angle),
                *(edge for is_visible, edge in self._views.edges_at(angle) if is_visible),
            ]
            lines += [
                np.append(roller.side, roller.side[:1])
                for roller in self._views.rollers(float(self.study.surface.motion.y[at]))
            ]
            for line in lines:
                path.addPath(curve(MM * line))
        if shape is not None:
            rotation = QTransform().rotate(self.study.sense * float(np.rad2deg(self.study.theta[at])))
            path.addPath(rotation.map(self._outline))
            if radius := MM * shape.flank.radius:
                centre = MM * complex(shape.reference[at])
                path.addEllipse(QPointF(centre.real, centre.imag), radius, radius)
        return path


def _polygon(points: list[complex]) -> QPolygonF:
    return QPolygonF([QPointF(MM * p.real, MM * p.imag) for p in points])


def paint_pinned(painter: QPainter, pinned: PinnedOutline, theta: float, view: QTransform) -> None:
    """Paint the pinned variant through the transformation of a view, mm to pixels."""
    colour = QColor(SCREEN.quiet)
    colour.setAlpha(150)
    painter.setPen(QPen(colour, OUTLINE_WIDTH))
    painter.setBrush(QColor(0, 0, 0, 0))
    painter.drawPath(view.map(pinned.path(theta)))
