"""Plots of the derivatives in the motion editor: limits of optimal laws are lines that the mouse drags."""

from __future__ import annotations

import math
from functools import cached_property
from math import radians
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter

from core.design import OptimalCurve, join_angles, put, require_motion
from core.design.curves import ORDERS_LIMITED
from core.design.motions import MINIMISED
from core.frozen import frozen
from core.output.drawing.scales import nice_below
from core.study import Quantity, Study
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.live_plot import TIP, LivePlot
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.style import DASHED, SCREEN, SMALL, THIN, brush, font
from kindyna_gui.pictures.units import short, with_unit

if TYPE_CHECKING:
    from kindyna_gui.forms.refusal import FloatingRefusal

REACH = 5.0  # pixels from a line within which the mouse grabs it
STEP_PIXELS = 2.5  # largest height of a step of a dragged limit
GAP = 2.0  # pixels between a line and its text


@frozen
class LimitLine:
    """Limit of a derivative of an optimal law, over its segment.

    Attributes
    ----------
    segment : number of the segment
    order : order of the derivative
    begin, end : cam angles [deg]
    limit : the limit, normalised to span 1 and rise 1; None where the law has none
    value : the limit, or the largest value where the law has none, in the channel's unit
    unit : value in the channel's unit of the normalised derivative 1
    """

    segment: int
    order: int
    begin: float
    end: float
    limit: float | None
    value: float
    unit: float

    @property
    def path(self) -> str:
        """Path of the limit."""
        return f"motion.segments[{self.segment}].limits.{ORDERS_LIMITED[self.order - 1]}"


def limit_lines(study: Study, channel: Quantity, order: int, chosen: int) -> list[LimitLine]:
    """Limits of a derivative of all optimal laws; of the selected segment also the offer of one that it does not have.

    A derivative whose peak is minimised is offered no limit.
    """
    motion, theta = require_motion(study.design), np.rad2deg(study.theta)
    values = np.abs(channel.values(study))
    lines = []
    for i, (begin, segment) in enumerate(zip(join_angles(motion), motion.segments, strict=True)):
        curve = segment.curve
        if not isinstance(curve, OptimalCurve):
            continue
        limit = getattr(curve.limits, ORDERS_LIMITED[order - 1])
        unit = abs(segment.rise) * motion.scale * (abs(study.omega) / radians(segment.span_deg)) ** order
        unit /= channel.unit.factor
        end = begin + segment.span_deg
        if limit is not None:
            lines.append(LimitLine(i, order, begin, end, limit, limit * unit, unit))
        elif i == chosen and not motion.is_computed and _can_be_limited(curve, order):
            peak = float(values[(theta > begin) & (theta < end)].max(initial=0.0))
            lines.append(LimitLine(i, order, begin, end, None, peak, unit))
    return lines


def _can_be_limited(curve: OptimalCurve, order: int) -> bool:
    minimised, rms = MINIMISED[curve.minimise]
    return rms or curve.needs_machine or minimised != order


def _tip(line: LimitLine) -> str:
    name = f"{ORDERS_LIMITED[line.order - 1]} limit of segment {line.segment + 1}"
    done = "set a" if line.limit is None else "change the"
    return f"Drag to {done} {name}; the law follows. Esc cancels the drag"


class LimitPlot(LivePlot):
    """Plot of a derivative; the limits of optimal laws are dragged, and the law follows.

    Attributes
    ----------
    order : order of the derivative
    locked : whether the plot shows another motion than the form, so that no limit can be dragged
    """

    def __init__(self, session: Session, order: int) -> None:
        self._lines: list[LimitLine] = []
        super().__init__(names=False)
        self._session, self.order = session, order
        self._hovered: LimitLine | None = None
        self._dragged: LimitLine | None = None
        self._refused: float | None = None  # the last value of the drag, where no law keeps it
        self._work: object = None
        self.locked = False
        session.design_changed.connect(self._clear_refusal)

    # -- lines ----------------------------------------------------------------------------------------------

    def show_limits(self, lines: list[LimitLine]) -> None:
        """Show these limits."""
        if lines != self._lines:
            self._lines = lines
            if self._dragged is not None:
                self._dragged = next((line for line in lines if line.path == self._dragged.path), self._dragged)
            self._lay()
            self.scene().update()

    @property
    def limit_lines(self) -> list[LimitLine]:
        """Limits that are shown."""
        return self._lines

    def _reach(self, core: tuple[float, float]) -> tuple[float, float]:
        """Range of the axis, with the limits in it."""
        values = [line.value / self.display_unit.size for line in self._lines if line.limit is not None]
        highest = max(values, default=0.0)
        return super()._reach((min(core[0], -highest), max(core[1], highest)))

    def position_of_limit(self, line: LimitLine) -> QPointF:
        """Middle of the upper line of a limit in the widget [pixels]."""
        return self.to_pixel(QPointF(0.5 * (line.begin + line.end), line.value / self.display_unit.size))

    def line_at(self, pixel: QPointF) -> LimitLine | None:
        """Limit whose upper or lower line is at a position in the widget [pixels]."""
        if self.locked or not self._curves:
            return None
        near: list[tuple[float, int, LimitLine | None]] = []
        for line in self._lines:
            for sign in (1.0, -1.0):
                begin, end = (
                    self.to_pixel(QPointF(at, sign * line.value / self.display_unit.size))
                    for at in (line.begin, line.end)
                )
                if begin.x() <= pixel.x() <= end.x():
                    near.append((abs(pixel.y() - begin.y()), -line.segment, line))
        distance, _, nearest = min(near, default=(math.inf, 0, None), key=lambda row: row[:2])
        return nearest if distance <= REACH else None

    def drawForeground(self, painter: QPainter, rect: QRectF) -> None:
        """Paint the limits; a unit of the scene is a pixel."""
        super().drawForeground(painter, rect)
        if not self._curves:
            return
        painter.save()
        painter.setClipRect(self.getViewBox().sceneBoundingRect())
        for line in self._lines:
            self._paint_line(painter, line)
        painter.restore()

    def _paint_line(self, painter: QPainter, line: LimitLine) -> None:
        active = self._dragged or self._hovered
        is_active = active is not None and active.path == line.path
        is_refused = is_active and self._refused is not None
        value = self._refused * line.unit if is_refused and self._refused is not None else line.value
        colour = SCREEN.chosen if is_active and not is_refused else SCREEN.quiet if line.limit is None else SCREEN.limit
        painter.setPen(self._theme.pen(colour, 2.0 if is_active else THIN, DASHED if line.limit is None else ()))
        view, size = self.getViewBox(), self.display_unit.size
        ends = [view.mapViewToScene(QPointF(at, value / size)) for at in (line.begin, line.end)]
        for sign in (1.0, -1.0):
            left, right = (view.mapViewToScene(QPointF(at, sign * value / size)) for at in (line.begin, line.end))
            painter.drawLine(left, right)
        if line.limit is None and not is_active:
            return
        text = self._text(line, value)
        width, height = text_size(text)
        box = view.sceneBoundingRect()
        above = ends[0].y() - GAP - height
        top = above if above > box.top() else ends[0].y() + GAP
        left = min(max(0.5 * (ends[0].x() + ends[1].x() - width), box.left() + GAP), box.right() - GAP - width)
        text_box = QRectF(left, top, width, height)
        painter.fillRect(text_box, brush(self._theme.paper, 0.85))
        painter.setFont(font(SMALL))
        painter.setPen(QColor(SCREEN.limit if is_refused or not is_active else SCREEN.chosen))
        painter.drawText(text_box, Qt.AlignmentFlag.AlignCenter, text)

    def _text(self, line: LimitLine, value: float) -> str:
        """Value of a limit in the motion's unit, and normalised."""
        shown = with_unit(short(value / self.display_unit.size, 4), self.display_unit.symbol)
        if self._refused is not None and self._dragged is not None and self._dragged.path == line.path:
            return f"{shown}: no law"
        if line.limit is None and self._dragged is None:
            return f"drag to limit, {shown}"
        return f"{shown} ({short(value / line.unit, 4)})"

    # -- mouse ----------------------------------------------------------------------------------------------

    def press(self, event: QMouseEvent) -> bool:
        line = self.line_at(event.position()) if event.button() == Qt.MouseButton.LeftButton else None
        if line is None:
            return super().press(event)
        self._clear_refusal()
        self._session.choose_segment(line.segment)
        self._session.begin_drag(self)
        self._dragged, self._work, self._refused = line, self._session.work, None
        self.scene().update()
        return True

    def drag(self, event: QMouseEvent) -> None:
        if self._dragged is None:
            super().drag(event)
            return
        low, high = self.getViewBox().viewRange()[1]
        step = nice_below(
            STEP_PIXELS * (high - low) / self.getViewBox().height() * self.display_unit.size / self._dragged.unit
        )
        value = abs(self.to_axes(event.position()).y()) * self.display_unit.size / self._dragged.unit
        self._set_limit(max(round(value / step) * step, step))

    def _set_limit(self, limit: float) -> None:
        assert self._dragged is not None
        path, limit = self._dragged.path, float(f"{limit:.6g}")
        changed = put(self._session.design, path, limit)
        from kindyna_gui.motion.optimal_form import limit_step  # imported here to save start-up time

        text = limit_step(path, limit)
        self._refused = None if self._session.put(changed, text, path) else limit
        self.scene().update()

    def hover(self, event: QMouseEvent | None) -> None:
        line = None if event is None or event.buttons() else self.line_at(event.position())
        if line != self._hovered:
            self._hovered = line
            self.setToolTip(TIP if line is None else _tip(line))
            self.scene().update()
        super().hover(event)
        if line is not None:
            self.viewport().setCursor(Qt.CursorShape.SizeVerCursor)

    def drop(self, event: QMouseEvent) -> None:
        if self._dragged is None:
            super().drop(event)
        else:
            self._end()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if self._dragged is not None and event.key() == Qt.Key.Key_Escape:
            self._refused = None
            self._end(cancel=True)
        else:
            super().keyPressEvent(event)

    def _end(self, cancel: bool = False) -> None:
        line, refused = self._dragged, self._refused
        assert line is not None
        self._dragged = self._refused = None
        self.let_go()
        self._session.end_field_drag(line.path, self._work if cancel else None)
        self.draw_again()
        if refused is not None:
            self._refuse(line.path, refused)

    # -- refusal ---------------------------------------------------------------------------------------------

    @cached_property
    def refusal(self) -> FloatingRefusal:
        """The refusal of a limit that was dragged too far, created with the first one."""
        from kindyna_gui.forms.refusal import FloatingRefusal  # imported here to save start-up time

        return FloatingRefusal(self.viewport())

    def _refuse(self, path: str, limit: float) -> None:
        """Say which least limit a law keeps, with a button that takes it."""
        from kindyna_gui.motion.optimal_form import refusal_of_limit  # imported here to save start-up time

        self.refusal.show_refusal(*refusal_of_limit(self._session, put(self._session.design, path, limit), path))

    def _clear_refusal(self) -> None:
        if "refusal" in vars(self):
            self.refusal.show_refusal("")
