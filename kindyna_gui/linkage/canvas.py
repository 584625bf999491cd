"""Zoom, pan, hit tests."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, QRectF, Qt, QTimer, Signal
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
from kindyna_gui.pictures.drawing.mechanism import MechanismScene
from kindyna_gui.pictures.shapes import joined, outline
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import nearest

# -- canvas ----------------------------------------------------------------------------------------------

NOTCH, STEP = 120.0, 1.25  # of a wheel: its angle, and the factor by which it zooms
FURTHEST, CLOSEST = 0.05, 400.0  # zoom, in parts of the scale at which the mechanism fits
HALF_EMPTY = 0.45  # a fitted picture is fitted anew once the mechanism fills less than this part of it
REACH = 9.0  # pixels from a joint within which it is taken
RIM = 4.0  # pixels from a circle within which it is taken
MASSES = "masses"  # a layer, and a list of the loads
REST_MS = 250  # after an edit or a move, before labels look for better sides
_GRIPS = (Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton)


def joints_now(scene: MechanismScene | Assembly) -> dict[str, complex]:
    """Where the joints that can be drawn elsewhere stand, by the names of their points [mm]; none while nothing is drawn."""
    from core.followers.dragging import joints_of  # which takes longer to load than the picture to draw

    geometry = scene.geometry
    if geometry is None:
        return {}
    wanted = joints_of(geometry.study.design)
    if isinstance(scene, MechanismScene) and not scene.layer_selected(MASSES):  # what is not seen is not taken
        wanted = {name: drag for name, drag in wanted.items() if not name.startswith(f"loads.{MASSES}")}
    return {name: place for name, place in geometry.handles(scene.index).items() if name in wanted}


def rims_now(scene: MechanismScene | Assembly) -> dict[str, tuple[complex, float]]:
    """The circles that can be drawn larger and smaller, by the paths of their fields: centre and radius [mm]."""
    from core.followers.dragging import rims_of

    geometry = scene.geometry
    if geometry is None or isinstance(scene, Assembly):
        return {}
    wanted = rims_of(geometry.study.design)
    return {path: rim for path, rim in geometry.rims(scene.index).items() if path in wanted}


class Canvas(QGraphicsView):
    """A window on a scene in mm, y upwards: wheel zooms about the mouse, drag pans, double click fits.

    Qt's own scroll bars and transformation anchors are left aside: what is visible is a centre and a scale, so that
    neither an edit nor a change of size can move it.

    taken     (name): a joint was pressed
    dragged   (name, place [mm]): it was drawn to a place
    dropped   (name): it was let go
    clicked   (place [mm]): it was pressed and let go there
    asked     (place [mm], on the screen): a context menu is wanted there
    hovered   (place [mm]): the mouse is there and holds nothing; None: it is elsewhere, or holds something

    fitted   the whole mechanism is shown, and will be at another size, too; False once zoomed or moved by hand
    picking  something is to be chosen with the next click: joints stay where they are
    over     what is painted over the scene, in pixels
    under    what is painted under it, likewise, and
    marks    its places [mm] that are meant when the mouse is near one
    runs     place pressed [mm] -> what the mouse does from there on, at each place; None: it moves the drawing
    ran      it was let go
    """

    taken, dragged, dropped, hovered = Signal(str), Signal(str, complex), Signal(str), Signal(object)
    clicked = Signal(QPointF)
    asked = Signal(QPointF, QPoint)
    ran = Signal()

    def __init__(self, scene: MechanismScene | Assembly) -> None:
        super().__init__(scene)
        self._joint = ""
        self._scene = scene
        self.setAccessibleName("Drawing of the mechanism")
        self.fitted = True
        self._picking = self._moved = False
        self.over: Callable[[QPainter], object] | None = None
        self.under: Callable[[QPainter], object] | None = None
        self.marks: Sequence[complex] = ()
        self.runs: Callable[[complex], Callable[[complex], object] | None] | None = None
        self._run: Callable[[complex], object] | None = None
        self._centre, self._scale = QPointF(), 1.0
        self._grip: QPointF | None = None
        self._pressed = QPointF()
        self.rest = QTimer(self, singleShot=True, interval=REST_MS)
        self.rest.timeout.connect(scene.lay_labels)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.TextAntialiasing)
        # nearly everything moves in every frame, and lines of constant width reach beyond what Qt takes for their bounds
        self.setViewportUpdateMode(QGraphicsView.ViewportUpdateMode.FullViewportUpdate)
        self.setTransformationAnchor(QGraphicsView.ViewportAnchor.NoAnchor)
        self.setResizeAnchor(QGraphicsView.ViewportAnchor.NoAnchor)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.ArrowCursor)
        self.viewport().setMouseTracking(True)

    # -- what is visible ----------------------------------------------------------------------------------

    @property
    def drawn(self) -> MechanismScene | Assembly:
        """What is shown."""
        return self._scene

    @property
    def picking(self) -> bool:
        """Whether something is to be chosen with the next click."""
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
        """What is visible [mm]."""
        rect = QRectF(0.0, 0.0, self.viewport().width() / self._scale, self.viewport().height() / self._scale)
        rect.moveCenter(self._centre)
        return rect

    def show_region(self, centre: QPointF, scale: float, keep_labels: bool = False) -> None:
        """Show what is around a point, at so many pixels per mm; labels may find better sides once all is at rest."""
        self._centre, self._scale = centre, scale
        self.setTransform(QTransform.fromScale(scale, -scale))
        visible = self.visible
        self.setSceneRect(visible)
        self._scene.show_region(visible, scale, keep_labels)
        if keep_labels:
            self.rest.start()

    def fit(self, keep_labels: bool = False) -> None:
        """Show the whole mechanism."""
        visible, scale = self._scene.fit(self.viewport().width(), self.viewport().height())
        self.show_region(visible.center(), scale, keep_labels)
        self.fitted = True

    def update_style(self) -> None:
        """Theme or letters have changed; what is zoomed stays."""
        self._scene.update_style()
        if self.fitted:
            self.fit()

    def show_again(self) -> None:
        """Show what was visible again, after an edit: it stays, unless a fitted mechanism has outgrown its picture or shrunk in it."""
        if self.fitted and not self._joint:  # under the hand the picture stays
            wanted, scale = self._scene.fit(self.viewport().width(), self.viewport().height())
            if not self.visible.contains(self._scene.least_rect()) or self._scale < HALF_EMPTY * scale:
                self.show_region(wanted.center(), scale, keep_labels=True)

    def zoom(self, factor: float, about: QPointF) -> None:
        """Zoom by a factor; what stands at a place of the viewport [pixels] stays there."""
        _, usual = self._scene.fit(self.viewport().width(), self.viewport().height())
        scale = min(max(self._scale * factor, FURTHEST * usual), CLOSEST * usual)
        kept = self._place(about)
        offset = (self._centre - kept) * (self._scale / scale)
        self.show_region(kept + offset, scale, keep_labels=True)
        self.fitted = False

    def _place(self, pixel: QPointF) -> QPointF:
        """The place of the scene [mm] at a place of the viewport [pixels]."""
        x = pixel.x() - self.viewport().width() / 2.0
        y = pixel.y() - self.viewport().height() / 2.0
        return self._centre + QPointF(x / self._scale, -y / self._scale)

    def _drawn_at(self, pixel: QPointF) -> QPointF:
        """The same of what Qt has drawn there: it puts the scene on whole pixels."""
        inverse, _ = self.viewportTransform().inverted()
        return inverse.map(pixel)

    def joint_at(self, pixel: QPointF, rims: bool = True) -> str:
        """The name of the joint, or with ``rims`` the path of the circle, under a place of the viewport that can be drawn elsewhere;
        empty where there is none."""
        if self._picking:
            return ""
        at = self._drawn_at(pixel)
        joints = joints_now(self._scene)
        near = {name: abs(place - complex(at.x(), at.y())) * self._scale for name, place in joints.items()}
        best = min(near, key=lambda name: near[name], default="")
        if best and near[best] <= REACH:
            return best
        here = complex(at.x(), at.y())
        off = {
            path: abs(abs(here - centre) - radius) * self._scale
            for path, (centre, radius) in (rims_now(self._scene) if rims else {}).items()
        }
        best = min(off, key=lambda path: off[path], default="")
        return best if best and off[best] <= RIM else ""

    @property
    def _rest_cursor(self) -> Qt.CursorShape:
        return Qt.CursorShape.CrossCursor if self._picking else Qt.CursorShape.ArrowCursor

    def paint_under(self, painter: QPainter) -> None:
        """What lies under the scene."""
        if self.under is not None:
            painter.save()
            painter.resetTransform()
            self.under(painter)
            painter.restore()

    def drawBackground(self, painter: QPainter, rect: QRectF | QRect) -> None:
        super().drawBackground(painter, rect)
        self.paint_under(painter)

    def drawForeground(self, painter: QPainter, rect: QRectF | QRect) -> None:
        super().drawForeground(painter, rect)
        if self.over is not None:
            painter.save()
            painter.resetTransform()
            self.over(painter)
            painter.restore()

    # -- events -------------------------------------------------------------------------------------------

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        if not self._joint and not self._picking:
            self.asked.emit(self._drawn_at(QPointF(self.viewport().mapFrom(self, event.pos()))), event.globalPos())

    def let_go(self) -> None:
        """What is held is held no longer; the mouse may still be down."""
        self._joint = ""
        if self._run is not None:
            self._run = lambda _: None

    @property
    def pressed_place(self) -> complex:
        """Where the mouse was pressed last [mm]."""
        at = self._drawn_at(self._pressed)
        return complex(at.x(), at.y())

    def wheelEvent(self, event: QWheelEvent) -> None:
        turned = event.angleDelta().y() or event.pixelDelta().y()
        if turned:
            self.zoom(STEP ** (turned / NOTCH), event.position())
        event.accept()

    def leaveEvent(self, event: QEvent) -> None:
        self.hovered.emit(None)
        super().leaveEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self.hovered.emit(None)
        joint = self.joint_at(event.position()) if event.button() == Qt.MouseButton.LeftButton else ""
        self._moved = False
        if joint:
            self._joint, self._pressed = joint, event.position()
            self.taken.emit(joint)
        elif event.button() in _GRIPS:
            if event.button() == Qt.MouseButton.LeftButton and self.runs is not None and not self._picking:
                at = self._drawn_at(event.position())
                self._run = self.runs(complex(at.x(), at.y()))
            self._grip = self._pressed = event.position()
            self.setCursor(Qt.CursorShape.ClosedHandCursor)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._joint:
            at, self._moved = self._drawn_at(event.position()), True
            self.dragged.emit(self._joint, complex(at.x(), at.y()))
            return
        if self._grip is None:
            over = self.joint_at(event.position())
            self.setCursor(Qt.CursorShape.SizeAllCursor if over else self._rest_cursor)
            at = self._drawn_at(event.position())
            self.hovered.emit(complex(at.x(), at.y()))
            return
        if event.position() == self._grip:
            return
        if self._run is not None:
            at = self._drawn_at(event.position())
            self._run(complex(at.x(), at.y()))
            return
        moved = event.position() - self._grip
        self._grip = event.position()
        self.show_region(
            self._centre - QPointF(moved.x() / self._scale, -moved.y() / self._scale), self._scale, keep_labels=True
        )
        self.fitted = False

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._joint and event.button() == Qt.MouseButton.LeftButton:
            name, self._joint = self._joint, ""
            self.dropped.emit(name)
            self.show_again()
            if not self._moved:
                self.clicked.emit(self._drawn_at(event.position()))
        elif event.button() in _GRIPS:
            ran, self._grip, self._run = self._run, None, None
            if ran is not None:
                self.ran.emit()
            self.setCursor(self._rest_cursor)
            if event.position() == self._pressed and event.button() == Qt.MouseButton.LeftButton:
                self.clicked.emit(self._drawn_at(event.position()))

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self.fit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        event.ignore()  # the arrow keys would scroll; they belong to the player

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if self.fitted:
            self.fit(keep_labels=True)
        else:
            self.show_region(self._centre, self._scale, keep_labels=True)


# -- ghost -----------------------------------------------------------------------------------------------

MM = 1e3
WIDTH = 1.0  # pixels; Qt takes many times as long for wider lines


class Ghost:
    """Made of one study; lines at an angle in mm, y upwards."""

    def __init__(self, study: Study) -> None:
        self.study = study

    @cached_property
    def _outline(self) -> QPainterPath:
        """Of the cam in its own frame."""
        assert self.study.shape is not None
        return joined(*(outline(MM * flank.profile) for flank in self.study.shape.flanks))

    def path(self, theta: float) -> QPainterPath:
        """Outline of the cam, what touches it, links as lines between their points; empty where there is no position."""
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
        if shape is not None:
            turned = QTransform().rotate(self.study.sense * float(np.rad2deg(self.study.theta[at])))
            path.addPath(turned.map(self._outline))
            if radius := MM * shape.flank.radius:
                centre = MM * complex(shape.reference[at])
                path.addEllipse(QPointF(centre.real, centre.imag), radius, radius)
        return path


def _polygon(points: list[complex]) -> QPolygonF:
    return QPolygonF([QPointF(MM * p.real, MM * p.imag) for p in points])


def paint_ghost(painter: QPainter, ghost: Ghost, theta: float, view: QTransform) -> None:
    """In pixels of a view whose scene is in mm."""
    colour = QColor(SCREEN.quiet)
    colour.setAlpha(150)
    painter.setPen(QPen(colour, WIDTH))
    painter.setBrush(QColor(0, 0, 0, 0))
    painter.drawPath(view.map(ghost.path(theta)))
