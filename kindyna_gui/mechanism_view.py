"""The mechanism to scale, as it moves: fit, zoom, pan, layers."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import ceil, log10

from PySide6.QtCore import QPointF, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QKeyEvent, QMouseEvent, QPainter, QResizeEvent, QTransform, QWheelEvent
from PySide6.QtWidgets import QFrame, QGraphicsView, QLabel, QVBoxLayout

from core.design import LinkageDesign
from core.design.linkage_paths import place_of
from core.errors import NoAnswer
from core.instant_centres import CHAINS
from core.mechanism import with_point_at
from core.study import Study
from kindyna_gui.look import WRONG, coloured
from kindyna_gui.pictures.mechanism import EVERY_LAYER, MechanismScene, layers_of
from kindyna_gui.pictures.reading import MM
from kindyna_gui.pictures.style import LIGHT
from kindyna_gui.player import Player
from kindyna_gui.player_keys import obey
from kindyna_gui.reads import READS
from kindyna_gui.session import Session
from kindyna_gui.shown_kinds import has_cam, is_linkage
from kindyna_gui.view import View
from kindyna_gui.wording import reason

NOTCH, STEP = 120.0, 1.25  # of a wheel: its angle, and the factor by which it zooms
FURTHEST, CLOSEST = 0.05, 400.0  # zoom, in parts of the scale at which the mechanism fits
HALF_EMPTY = 0.45  # a fitted picture is fitted anew once the mechanism fills less than this part of it
REACH = 9.0  # pixels from a joint within which it is taken
REST_MS = 250  # after an edit or a move, before labels look for better sides
_GRIPS = (Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton)


class Canvas(QGraphicsView):
    """A window on a scene in mm, y upwards: wheel zooms about the mouse, drag pans, double click fits.

    Qt's own scroll bars and transformation anchors are left aside: what is visible is a centre and a scale, so that
    neither an edit nor a change of size can move it.

    taken, dragged, dropped   a joint was taken by its name, drawn to a place [mm], let go

    fitted   the whole mechanism is shown, and will be at another size, too; False once zoomed or moved by hand
    """

    taken, dragged, dropped = Signal(str), Signal(str, complex), Signal(str)

    def __init__(self, scene: MechanismScene) -> None:
        super().__init__(scene)
        self._joint = ""
        self._scene = scene
        self.fitted = True
        self._centre, self._scale = QPointF(), 1.0
        self._grip: QPointF | None = None
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
    def scale_now(self) -> float:
        """Pixels per mm."""
        return self._scale

    @property
    def visible(self) -> QRectF:
        """What is visible [mm]."""
        rect = QRectF(0.0, 0.0, self.viewport().width() / self._scale, self.viewport().height() / self._scale)
        rect.moveCenter(self._centre)
        return rect

    def look_at(self, centre: QPointF, scale: float, keep_labels: bool = False) -> None:
        """Show what is around a point, at so many pixels per mm; labels may find better sides once all is at rest."""
        self._centre, self._scale = centre, scale
        self.setTransform(QTransform.fromScale(scale, -scale))
        visible = self.visible
        self.setSceneRect(visible)
        self._scene.look_at(visible, scale, keep_labels)
        if keep_labels:
            self.rest.start()

    def fit(self, keep_labels: bool = False) -> None:
        """Show the whole mechanism."""
        visible, scale = self._scene.fit(self.viewport().width(), self.viewport().height())
        self.look_at(visible.center(), scale, keep_labels)
        self.fitted = True

    def look_again(self) -> None:
        """After an edit: what was visible stays, unless a fitted mechanism has outgrown its picture or shrunk in it."""
        if self.fitted:
            wanted, scale = self._scene.fit(self.viewport().width(), self.viewport().height())
            if not self.visible.contains(self._scene.least_rect()) or self._scale < HALF_EMPTY * scale:
                self.look_at(wanted.center(), scale, keep_labels=True)

    def zoom(self, factor: float, about: QPointF) -> None:
        """Zoom by a factor; what stands at a place of the viewport [pixels] stays there."""
        _, usual = self._scene.fit(self.viewport().width(), self.viewport().height())
        scale = min(max(self._scale * factor, FURTHEST * usual), CLOSEST * usual)
        kept = self._place(about)
        offset = (self._centre - kept) * (self._scale / scale)
        self.look_at(kept + offset, scale, keep_labels=True)
        self.fitted = False

    def _place(self, pixel: QPointF) -> QPointF:
        """The place of the scene [mm] at a place of the viewport [pixels]."""
        x = pixel.x() - self.viewport().width() / 2.0
        y = pixel.y() - self.viewport().height() / 2.0
        return self._centre + QPointF(x / self._scale, -y / self._scale)

    def joint_at(self, pixel: QPointF) -> str:
        """The name of the joint under a place of the viewport that can be drawn elsewhere; empty where there is none."""
        at = self._place(pixel)
        found = self._scene.joints_now()
        near = {name: abs(place - complex(at.x(), at.y())) * self._scale for name, place in found.items()}
        best = min(near, key=lambda name: near[name], default="")
        return best if best and near[best] <= REACH else ""

    # -- events -------------------------------------------------------------------------------------------

    def wheelEvent(self, event: QWheelEvent) -> None:
        turned = event.angleDelta().y() or event.pixelDelta().y()
        if turned:
            self.zoom(STEP ** (turned / NOTCH), event.position())
        event.accept()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        joint = self.joint_at(event.position()) if event.button() == Qt.MouseButton.LeftButton else ""
        if joint:
            self._joint = joint
            self.taken.emit(joint)
        elif event.button() in _GRIPS:
            self._grip = event.position()
            self.setCursor(Qt.CursorShape.ClosedHandCursor)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._joint:
            at = self._place(event.position())
            self.dragged.emit(self._joint, complex(at.x(), at.y()))
            return
        if self._grip is None:
            over = self.joint_at(event.position())
            self.setCursor(Qt.CursorShape.SizeAllCursor if over else Qt.CursorShape.ArrowCursor)
            return
        if event.position() == self._grip:
            return
        moved = event.position() - self._grip
        self._grip = event.position()
        self.look_at(
            self._centre - QPointF(moved.x() / self._scale, -moved.y() / self._scale), self._scale, keep_labels=True
        )
        self.fitted = False

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._joint and event.button() == Qt.MouseButton.LeftButton:
            name, self._joint = self._joint, ""
            self.dropped.emit(name)
        elif event.button() in _GRIPS:
            self._grip = None
            self.setCursor(Qt.CursorShape.ArrowCursor)

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
            self.look_at(self._centre, self._scale, keep_labels=True)


def joint_path(design: LinkageDesign, name: str) -> str:
    """The path of a point, of the first link that has it."""
    number = next(link.number for link in design.linkage.links if name in link.places)
    return place_of(design, number, name)


class MechanismView(View):
    """The drawing in the middle of the window."""

    def __init__(self, session: Session, player: Player) -> None:
        self.scene = MechanismScene()
        self.canvas = Canvas(self.scene)
        super().__init__(session, player)
        self.note = QLabel(wordWrap=True, margin=6)
        self.note.setMinimumSize(1, 1)
        self.note.hide()
        coloured(self.note, WRONG)
        column = QVBoxLayout()
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.canvas, 1)
        column.addWidget(self.note)
        self.set_content_layout(column)
        self.setFocusProxy(self.canvas)
        self._fit_wanted = True
        self._layers_wanted = {name: layer.shown for name, layer in EVERY_LAYER.items()}
        self._actions = {name: self._action(name, layer.label) for name, layer in EVERY_LAYER.items()}
        session.started.connect(self._another_design)
        session.step_changed.connect(self._show_step)
        self.canvas.taken.connect(self._take_joint)
        self.canvas.dragged.connect(self._drag_joint)
        self.canvas.dropped.connect(self._drop_joint)

    def _action(self, name: str, label: str) -> QAction:
        action = QAction(label, self, checkable=True, checked=self._layers_wanted[name])
        action.setObjectName(f"layer:{name}")
        action.setStatusTip(f"Show or hide in the drawing: {label.lower()}")
        action.toggled.connect(partial(self.show_layer, name))
        return action

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Forces are computed only while they are drawn."""
        return READS["mechanism with forces" if self._layers_wanted["forces"] else "mechanism"]

    # -- what is drawn ------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        self._take_layers()
        self._say_what_lacks(study)
        self.scene.show_step(self.session.step if is_linkage(study.design) else None, draw=False)
        self.scene.update_study(study, keep_labels=True)
        self.canvas.rest.start()
        if self._fit_wanted:
            self.canvas.fit()
            self._fit_wanted = False
        else:
            self.canvas.look_again()

    def _say_what_lacks(self, study: Study) -> None:
        """A linkage without a cam is still drawn, with the reason below it."""
        told = ""
        try:
            _ = study.cam if has_cam(study) else None
        except NoAnswer as error:
            told = f"No cam: {reason(study.design, error)}"
        self.note.setText(told)
        self.note.setVisible(bool(told))

    def follow(self, theta: float) -> None:
        self._take_layers()
        self.scene.set_angle(theta)

    def fit(self) -> None:
        if self.up_to_date and not self.in_trouble:
            self.canvas.fit()
        else:
            self._fit_wanted = True

    # -- joints -------------------------------------------------------------------------------------------

    def _take_joint(self, name: str) -> None:
        self.player.play(False)
        self.session.end_gesture()

    def _drag_joint(self, name: str, place: complex) -> None:
        """Put a joint where the mouse is at this angle; what cannot be is refused, and the last good design stays."""
        design, theta = self.session.design, self.player.theta
        train = self.session.at(theta).linkage
        decimals = max(0, ceil(log10(self.canvas.scale_now)) + 1)
        moved = with_point_at(design, train, name, place / MM, decimals)
        self.session.put(moved, f"Move joint {name}", joint_path(design, name))

    def _drop_joint(self, name: str) -> None:
        self.session.end_gesture()
        self.session.withdraw(joint_path(self.session.design, name))

    def _another_design(self) -> None:
        self._fit_wanted = True

    def _show_step(self) -> None:
        if self.up_to_date and not self.in_trouble:
            self.scene.show_step(self.session.step)

    # -- layers -------------------------------------------------------------------------------------------

    def layer_actions(self) -> list[QAction]:
        return [self._actions[name] for name in layers_of(self.session.study)]

    def show_layer(self, name: str, shown: bool) -> None:
        """Show or hide one of ``EVERY_LAYER``."""
        self._layers_wanted[name] = shown
        self.wake()

    def _take_layers(self) -> None:
        for name, shown in self._layers_wanted.items():
            if self.scene.layer_wanted(name) != shown:
                self.scene.set_layer(name, shown)
                if self.canvas.fitted and name in CHAINS:  # their list stands above the mechanism
                    self.canvas.fit(keep_labels=True)

    # -- as a file ----------------------------------------------------------------------------------------

    def settle(self) -> None:
        """Do now what waits until all is at rest."""
        if self.canvas.rest.isActive():
            self.canvas.rest.stop()
            self.scene.lay_labels()

    def picture(self, ending: str) -> bytes:
        """What is visible, in the size it has on the screen; a PNG has twice the dots."""
        from kindyna_gui.pictures.files import ENLARGED, RATIO, Sheet, png, svg

        self.pull()
        vector = ending == ".svg"
        scene = MechanismScene(None, LIGHT, ENLARGED) if vector else MechanismScene(None, replace(LIGHT, ratio=RATIO))
        for name, shown in self._layers_wanted.items():
            scene.set_layer(name, shown)
        scene.update_study(self.session.study)
        scene.set_angle(self.player.theta)
        look = None if self.canvas.fitted else (self.canvas.visible, self.canvas.scale_now)
        sheet = Sheet(scene, self.canvas.viewport().width(), self.canvas.viewport().height(), look)
        return svg(sheet, self.session.design.name) if vector else png(sheet)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_F and not event.modifiers():
            self.fit()
        elif not obey(self.player, event):
            super().keyPressEvent(event)


__all__ = ["Canvas", "MechanismView"]
