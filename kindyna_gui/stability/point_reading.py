"""What is shown of the point under the mouse: at once what is quickly known, the rest where the mouse rests."""

from __future__ import annotations

from functools import partial
from typing import Any

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QLabel

from core.stability import EXACT, Stability, Verdict
from kindyna_gui.background import Background
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.stability.chart import StabilityChart
from kindyna_gui.stability.texts import point_text, tongue_of, waiting_text

UNSEEN = 1e-6  # of η: a tongue's edge may be off by that
EDGE, MARGIN = 6, 4  # between the text and the axes, and around it, pixels
REST_MS = 220  # the mouse rests, before what takes long is begun


class PointReading(QLabel):
    """Three lines: the place, its tongue and the linear models; the steady response; the history from rest.

    The latter two take a second and more: they are computed beside the window, and given up where the mouse moves on.
    It stands over the chart, in that half where the mouse is not, and lets the mouse through.

    changed   something that was still to come has come, or is given up
    """

    changed = Signal()

    def __init__(self, chart: StabilityChart) -> None:
        super().__init__(chart)
        self._chart = chart
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setWordWrap(True)
        self.setMargin(MARGIN)
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self.setAutoFillBackground(True)
        self.hide()
        coloured(self, SCREEN.quiet)
        self.background = Background(self)
        self.background.result.connect(self._answered)
        self._pause = QTimer(self, singleShot=True, interval=REST_MS)
        self._pause.timeout.connect(self._ask)
        self._found: Stability | None = None
        self.point: tuple[float, float] | None = None
        self.verdicts: tuple[Verdict, ...] = ()
        self._tongue: int | None = None

    @property
    def busy(self) -> bool:
        return self._pause.isActive() or self.background.busy

    def stop(self) -> None:
        """Give up what is being computed; what is shown stays."""
        self._pause.stop()
        self.background.stop()
        self.changed.emit()

    def show_text(self, text: str) -> None:
        """Something else than a point."""
        self.stop()
        self.point, self.verdicts = None, ()
        self._write(text)

    def _write(self, text: str) -> None:
        self.setText(text)
        self.setVisible(bool(text))
        if text:
            self._place(max(self.fontMetrics().horizontalAdvance(line) for line in text.splitlines()))

    def _place(self, width: int) -> None:
        """Below the upper edge of the chart, or above the lower one, away from the mouse."""
        box = self._chart.getViewBox().sceneBoundingRect().toRect()
        self.resize(min(width + 2 * MARGIN + 2, box.width() - 2 * EDGE), 1)
        self.resize(self.width(), self.heightForWidth(self.width()))
        low = self._chart.mouse_at.y() < box.center().y()
        self.move(box.left() + EDGE, box.bottom() - EDGE - self.height() if low else box.top() + EDGE)

    def show_point(self, found: Stability, point: tuple[float, float]) -> None:
        """Tell of a point (η, Q)."""
        self.stop()
        self._found, self.point = found, point
        eta, q = point
        self.verdicts = found.linear_at(eta, q)
        self._tongue = tongue_of(found.tongues(EXACT, max(eta + 0.5, 1.0), q, UNSEEN), eta)
        self._pause.start()
        self._show()

    def _ask(self) -> None:
        assert self._found is not None
        assert self.point is not None
        eta, q = self.point
        self.background.start(
            [
                (self.point, partial(self._found.rest_at, eta, q)),
                (self.point, partial(self._found.steady_at, eta, q)),
            ]
        )
        self._show()
        self.changed.emit()

    def _answered(self, point: tuple[float, float], verdict: Any) -> None:
        if point == self.point and isinstance(verdict, Verdict):
            self.verdicts = (*self.verdicts, verdict)
        self._show()
        self.changed.emit()

    def _show(self) -> None:
        assert self._found is not None
        if self.point is not None:
            first = point_text(*self.point, self._found.machine, self.verdicts, self._tongue)
            self._write(f"{first}\n{waiting_text(self.verdicts, self.busy)}")


__all__ = ["PointReading"]
