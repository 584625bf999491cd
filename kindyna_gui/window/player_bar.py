"""The player bar below the drawing: play, step, angle and speed."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees, inf, radians
from types import MappingProxyType

from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, QSignalBlocker, QSize, Qt
from PySide6.QtGui import (
    QColor,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QResizeEvent,
    QShowEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import (
    QAbstractSlider,
    QApplication,
    QComboBox,
    QDoubleSpinBox,
    QHBoxLayout,
    QSizePolicy,
    QToolButton,
)

from core.errors import KindynaError
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import TextKeys
from kindyna_gui.look import described, icon
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import digits
from kindyna_gui.player import KEYS_HELP, TURN, Player, Speed, initial_speed, obey, speeds, step_of
from kindyna_gui.rebuilt import connect_all, fill
from kindyna_gui.view import View

FINE = 100  # steps of the slider in a degree
LEAST = 330  # least width of the bar [pixels]
EDGES = 24  # sum of the gaps at the ends of the bar and between its parts [pixels]
HANDY = 72  # width of the slider below which buttons are hidden [pixels]
NEAR = 1e-9  # distance of a join from the current angle that counts as none [rad]
JOIN_KEYS: Mapping[int, int] = MappingProxyType({Qt.Key.Key_PageUp: -1, Qt.Key.Key_PageDown: 1})


def speed_text(speed: Speed) -> str:
    """Return the speed as a multiple of the true speed, and the time of one turn."""
    named = "true" if speed.part == 1 else f"{speed.part} \u00d7"
    return f"{named}, {digits(speed.seconds, 2)} s"


class AngleSlider(QAbstractSlider):
    """A strip of one turn with a handle at the cam angle; a click moves the cam there.

    Every other segment is shaded as in the plots; a tick is at every 30 degrees.
    """

    GROOVE, HANDLE, EDGE = 12.0, 9.0, 7.0

    def __init__(self) -> None:
        super().__init__(orientation=Qt.Orientation.Horizontal, singleStep=FINE, pageStep=10 * FINE)
        self.setRange(0, 360 * FINE)
        self.setAccessibleName("Cam angle")
        self.setToolTip(f"Cam angle; drag or click. {KEYS_HELP}")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self._joins: tuple[float, ...] = ()

    def show_joins(self, angles_deg: tuple[float, ...]) -> None:
        """Show the cam angles where segments meet [deg]."""
        joins = tuple(sorted({0.0, 360.0, *angles_deg}))
        if joins != self._joins:
            self._joins = joins
            self.update()

    def sizeHint(self) -> QSize:
        return QSize(240, 30)

    def minimumSizeHint(self) -> QSize:
        return QSize(32, 30)  # leaves room for a large font next to it

    def position_of(self, angle: float) -> float:
        """Return the position of an angle [deg] on the strip [pixels]."""
        return self.EDGE + angle / 360.0 * (self.width() - 2.0 * self.EDGE)

    def _go(self, x: float) -> None:
        part = (x - self.EDGE) / max(1.0, self.width() - 2.0 * self.EDGE)
        self.setSliderPosition(round(min(max(part, 0.0), 1.0) * self.maximum()))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self.setSliderDown(True)
            self._go(event.position().x())

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self.isSliderDown():
            self._go(event.position().x())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        self.setSliderDown(False)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        event.ignore()  # the arrow keys belong to the player

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        top = (self.height() - self.GROOVE) / 2.0 - 3.0
        bottom = top + self.GROOVE
        strip = QRectF(QPointF(self.position_of(0.0), top), QPointF(self.position_of(360.0), bottom))
        painter.fillRect(strip, QColor(SCREEN.paper))
        for start, end in zip(self._joins[1::2], self._joins[2::2], strict=False):
            band = QRectF(QPointF(self.position_of(start), top), QPointF(self.position_of(end), bottom))
            painter.fillRect(band, QColor(SCREEN.dwell))
        painter.setPen(QPen(QColor(SCREEN.line), 1.0))
        painter.drawRect(strip)
        painter.setPen(QPen(QColor(SCREEN.quiet), 1.0))
        for angle in range(0, 361, 30):
            x = self.position_of(float(angle))
            painter.drawLine(QPointF(x, bottom + 1.5), QPointF(x, bottom + (5.5 if angle % 90 == 0 else 4.0)))
        x = self.position_of(self.sliderPosition() / FINE)
        colour = QColor(SCREEN.chosen) if self.isEnabled() else self.palette().color(QPalette.ColorRole.Mid)
        painter.setPen(QPen(QColor(SCREEN.paper), 1.0))
        painter.setBrush(colour)
        handle = QRectF(x - self.HANDLE / 2.0, top - 4.0, self.HANDLE, self.GROOVE + 8.0)
        painter.drawRoundedRect(handle, 3.0, 3.0)
        painter.end()


class AngleBox(TextKeys, QDoubleSpinBox):
    """The cam angle as a number."""


class PlayerBar(View):
    """Buttons, slider and angle that move the cam; with several drives, the angle of the machine."""

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self._joins: tuple[float, ...] = ()
        self._chosen = False  # whether the user has chosen the speed
        self._watched: QObject | None = None
        self.join_back = self._button("join_back", "Previous join of segments (Page Up)")
        self.back = self._button("step_back", "1° back (Left; with Shift 0.1°, with Ctrl 10°)")
        self.play = self._button("play", "Play (Space)")
        self.forward = self._button("step_forward", "1° forward (Right; with Shift 0.1°, with Ctrl 10°)")
        self.join_forward = self._button("join_forward", "Next join of segments (Page Down)")
        self.reverse = self._button("reverse", "Play backwards (F8)")
        self.reverse.setCheckable(True)
        self.slider = AngleSlider()
        self.angle = self._angle_box()
        self.speed = described(
            QComboBox(sizeAdjustPolicy=QComboBox.SizeAdjustPolicy.AdjustToContents),
            name="Speed of playing",
            tip="Playback speed, as a multiple of the shaft's speed, and the duration of one turn",
        )
        self.speed.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        row = fill(
            QHBoxLayout(),
            self.join_back,
            self.back,
            self.play,
            self.forward,
            self.join_forward,
            self.reverse,
            4,
            (self.slider, 1),
            4,
            self.angle,
            4,
            self.speed,
            margins=(6, 3, 6, 3),
            spacing=0,
        )
        self.set_content_layout(row)
        self.setFixedHeight(self.content.sizeHint().height())
        self.setMinimumWidth(LEAST)
        self._connect()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit_buttons()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            self._fit_buttons()

    def _fit_buttons(self) -> None:
        """Show angle and speed in full, the slider, and the buttons for which there is room."""
        self.speed.setMinimumWidth(self.speed.sizeHint().width())  # else a narrow bar would cut the seconds
        room = self.width() - EDGES - self.angle.sizeHint().width() - self.speed.sizeHint().width() - HANDY
        room -= self.play.sizeHint().width()
        for buttons in ((self.back, self.forward), (self.join_back, self.join_forward, self.reverse)):
            room -= sum(button.sizeHint().width() for button in buttons)
            for button in buttons:
                button.setVisible(room >= 0)

    def _button(self, name: str, tip: str) -> QToolButton:
        button = described(QToolButton(autoRaise=True), name=tip.partition(" (")[0], tip=tip)
        button.setIcon(icon(name))
        button.setIconSize(QSize(18, 18))
        button.setStatusTip(tip)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def _angle_box(self) -> QDoubleSpinBox:
        box = described(
            AngleBox(decimals=2, minimum=0.0, maximum=360.0, singleStep=1.0),
            name="Cam angle",
            tip="Cam angle of all views",
        )
        box.setWrapping(True)
        box.setSuffix("°")
        box.setAlignment(Qt.AlignmentFlag.AlignRight)
        box.setKeyboardTracking(False)
        box.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        return box

    def _connect(self) -> None:
        player = self.player
        connect_all(
            (self.session.started, self._forget_speed),
            (self.play.clicked, lambda: player.play(not player.playing)),
            (self.back.clicked, lambda: self._step(-1.0)),
            (self.forward.clicked, lambda: self._step(1.0)),
            (self.join_back.clicked, lambda: self.go_to_join(-1)),
            (self.join_forward.clicked, lambda: self.go_to_join(1)),
            (self.reverse.toggled, lambda on: player.set_forward(not on)),
            (self.slider.sliderMoved, lambda value: self._go(value / FINE)),
            (self.angle.valueChanged, self._go),
            (self.angle.lineEdit().textEdited, lambda _: player.play(False)),
            (self.speed.activated, self._choose_speed),
            (player.playing_changed, self._show_playing),
            (player.forward_changed, lambda forward: self.reverse.setChecked(not forward)),
            (player.speed_changed, lambda _: self._show_speed()),
        )

    # -- from the session and the player ------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        self._joins = tuple(join.theta for join in study.program.joins)
        name = self.session.angle_name.capitalize()
        if self.angle.accessibleName() != name:
            for widget, tip in (
                (self.angle, f"{name} of all views"),
                (self.slider, f"{name}; drag or click. {KEYS_HELP}"),
            ):
                widget.setAccessibleName(name)
                widget.setToolTip(tip)
        self.slider.show_joins(tuple(degrees(self.player.machine_of(theta)) for theta in self._joins))
        rows = speeds(study.omega)
        if [self.speed.itemData(i) for i in range(self.speed.count())] != list(rows):
            self.speed.clear()
            for row in rows:
                self.speed.addItem(speed_text(row), row)
            self._fit_buttons()
            self.speed.view().setMinimumWidth(self.speed.view().sizeHintForColumn(0) + 24)
        if not self._chosen:
            self.player.set_speed(float(initial_speed(study.omega).part))
        self._show_speed()

    def show_reason(self, error: KindynaError) -> None:
        """Show a short reason; the bar has one line, and the drawing gives the full reason."""
        is_incomplete = self.session.is_incomplete_linkage
        why = (
            "the linkage is not complete; the drawing shows what is missing"
            if is_incomplete
            else "the drawing shows why"
        )
        super().show_reason(KindynaError(f"Cannot play: {why}."))

    def follow(self, theta: float) -> None:
        angle = degrees(self.player.machine)
        with QSignalBlocker(self.slider), QSignalBlocker(self.angle):
            self.slider.setSliderPosition(round(angle * FINE))
            if self.angle.value() != round(angle, self.angle.decimals()):  # else Qt would paint it again
                self.angle.setValue(angle)

    def _show_playing(self, playing: bool) -> None:
        self.play.setIcon(icon("pause" if playing else "play"))
        self.play.setToolTip("Pause (Space)" if playing else "Play (Space)")

    def _show_speed(self) -> None:
        rows = [self.speed.itemData(i) for i in range(self.speed.count())]
        if rows:
            near = min(range(len(rows)), key=lambda i: abs(float(rows[i].part) / self.player.speed - 1.0))
            self.speed.setCurrentIndex(near)

    # -- to the player ------------------------------------------------------------------------------------

    def _go(self, angle: float) -> None:
        self.player.play(False)
        self.player.set_machine(radians(angle))

    def _step(self, direction: float) -> None:
        self.player.step(direction * (step_of(QApplication.keyboardModifiers()) or 1.0))

    def _choose_speed(self, index: int) -> None:
        self._chosen = True
        self.player.set_speed(float(self.speed.itemData(index).part))

    def _forget_speed(self) -> None:
        """Use the default speed of a new design's shaft."""
        self._chosen = False

    def go_to_join(self, direction: int) -> None:
        """Move to the next join of segments, with -1 to the previous one."""
        current = self.player.theta
        gaps = [(direction * (theta - current)) % TURN for theta in self._joins]
        ahead = [gap if NEAR < gap < TURN - NEAR else inf for gap in gaps]
        if ahead and min(ahead) < inf:
            self.player.play(False)
            self.player.set_theta(self._joins[ahead.index(min(ahead))])

    # -- keys ---------------------------------------------------------------------------------------------

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if self._watched is None and self.window() is not self:
            self._watched = self.window()
            self._watched.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Handle keys that no widget of the window has used."""
        if watched is self._watched and isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            return self._obey(event)
        return super().eventFilter(watched, event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not self._obey(event):
            super().keyPressEvent(event)

    def _obey(self, event: QKeyEvent) -> bool:
        if event.key() in JOIN_KEYS and not event.modifiers():
            self.go_to_join(JOIN_KEYS[event.key()])
            return True
        return obey(self.player, event)


__all__ = ["AngleSlider", "PlayerBar"]
