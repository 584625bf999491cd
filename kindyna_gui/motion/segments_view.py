"""Motion view: diagram, table of the segments, and the actions on a segment."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from functools import cached_property, partial
from math import degrees, radians
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPoint, QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QBoxLayout,
    QFrame,
    QHBoxLayout,
    QLayout,
    QMenu,
    QScrollArea,
    QSplitter,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import (
    Curve,
    Design,
    OptimalCurve,
    insert_segment,
    is_assumed,
    mirror_stroke,
    missing_of_motion,
    motion_of,
    remove_from_incomplete,
    require_motion,
)
from core.errors import KindynaError
from core.frozen import frozen
from core.motion.extremes import Extremes
from core.motion.split import LEAST_CUT, copy_segment, split_segment
from core.study import Quantity, Study
from kindyna_gui.documents.edits import SAMPLES, Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import back_text, closing_text, joins_of, misfit_sentences, motion_waits, waiting_paths
from kindyna_gui.forms.fields import Field, add_vary, in_tab_order
from kindyna_gui.forms.form import EDIT_CARD, IncompleteBar
from kindyna_gui.graph.marked_view import MarkedView
from kindyna_gui.labels import reason, segment_of
from kindyna_gui.look import described, icon
from kindyna_gui.motion.curve_fields import SegmentCurveForm
from kindyna_gui.motion.diagram import ANGLE_STEP, snap, snap_angle
from kindyna_gui.motion.editor import DerivativePlots, MotionEditor
from kindyna_gui.motion.header import NO_STROKE, MotionHeader
from kindyna_gui.motion.segments_table import LAW, RISE, SPAN, SegmentsModel, SegmentsTable
from kindyna_gui.pictures.plots.quantities import rows_of
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import STRETCH, call_soon, connect_all, fill, single_shot, widget_with
from kindyna_gui.requirements import require_motion as require_motion_of_view
from kindyna_gui.view import ViewHost

if TYPE_CHECKING:
    from kindyna_gui.forms.refusal import RefusalLine, Remedies

PATH = "motion.segments"
"""Path of the edits of whole segments."""
COLUMN_OF_KEY = {"law": LAW, "span_deg": SPAN, "rise_mm": RISE, "rise_deg": RISE}
TABLE_WIDTH = 420  # pixels, of the table with the form next to it
WIDE = 700  # pixels: from this width on the form is next to the table, else below it
FORM_SHARE = 0.2  # of the height, for the form below the table
LEAST_FORM_HEIGHT, MOST_FORM_HEIGHT = 66, 200  # pixels
UNLIMITED = 16777215  # pixels, Qt's value for no limit

Change = Callable[[Design, int, float | None], Design]
"""Function that changes a segment of a design, at a cam angle [deg] if needed."""

# -- actions ---------------------------------------------------------------------------------------------


@frozen
class SegmentAction:
    """An action on a segment.

    Attributes
    ----------
    text, entry : texts of the button and of the menu entry
    step : name of the undo step; {n} is the number of the segment
    is_possible : whether the action is possible for a segment
    after : how many segments further on the selection is then
    needs_complete : whether the motion must be complete
    has_button : whether the action has a button below the table; else it is in menus only
    """

    text: str
    entry: str
    tip: str
    icon: str
    step: str
    change: Change
    is_possible: Callable[[Design, int], bool]
    after: int = 0
    needs_complete: bool = False
    has_button: bool = True

    def is_enabled(self, design: Design, index: int) -> bool:
        """Whether the action can be done with a segment of a design."""
        motion = motion_of(design)
        if motion is None or motion.is_computed or index >= len(motion.segments):
            return False  # no segment, or a motion that follows from other files or a lobe
        return not (self.needs_complete and missing_of_motion(design)) and self.is_possible(design, index)


def _can_be_divided(design: Design, index: int) -> bool:
    return require_motion(design).segments[index].span_deg > 2.0 * LEAST_CUT


ACTIONS: Mapping[str, SegmentAction] = MappingProxyType(
    {
        "insert": SegmentAction(
            "Insert",
            "Insert segment",
            "Insert a dwell after the selected segment, with half of its span (Ins)",
            "insert",
            "Insert segment after segment {n}",
            lambda design, index, _: insert_segment(design, index),
            _can_be_divided,
            after=1,
        ),
        "insert_before": SegmentAction(
            "Insert before",
            "Insert before",
            "Insert a dwell before the selected segment, with half of its span",
            "insert",
            "Insert segment before segment {n}",
            lambda design, index, _: insert_segment(design, index, before=True),
            _can_be_divided,
            has_button=False,
        ),
        "split": SegmentAction(
            "Split",
            "Split segment",
            "Split the selected segment at the current cam angle, or in its middle. A dwell, constant velocity, a polynomial "
            "and a spline keep their motion; with any other law both parts run from rest to rest, and the level at the "
            "split does not change",
            "split",
            "Split segment {n}",
            split_segment,
            _can_be_divided,
            needs_complete=True,
        ),
        "duplicate": SegmentAction(
            "Duplicate",
            "Duplicate segment",
            "Insert a copy after the selected segment; both have half of its span and rise, so that no other join moves",
            "duplicate",
            "Duplicate segment {n}",
            lambda design, index, _: copy_segment(design, index),
            _can_be_divided,
            after=1,
            needs_complete=True,
        ),
        "mirror": SegmentAction(
            "Mirror",
            "Mirror stroke",
            "Make the next stroke in the opposite direction the mirror image of this one: curves in reverse order, the "
            "same spans, opposite rises. The dwells compensate for the difference",
            "mirror",
            "Mirror the stroke of segment {n}",
            lambda design, index, _: mirror_stroke(design, index),
            lambda design, index: mirror_stroke(design, index) is not design,
            needs_complete=True,
        ),
        "delete": SegmentAction(
            "Delete",
            "Delete segment",
            "Delete the selected segment; the previous one gets its span (Del)",
            "delete",
            "Delete segment {n}",
            lambda design, index, _: remove_from_incomplete(design, index),
            lambda design, _: len(require_motion(design).segments) > 1,
        ),
    }
)


def perform(session: Session, name: str, index: int, theta: float) -> int | None:
    """Do one of ``ACTIONS`` with a segment at a cam angle [rad], as one undo step.

    Returns the segment to select then; None if the action is not possible or refused.
    """
    action, design = ACTIONS[name], session.typed
    if not action.is_enabled(design, index):
        return None
    session.end_gesture()
    try:
        changed = action.change(design, index, snap_angle(degrees(theta)))
    except KindynaError as error:
        session.refuse(PATH, reason(design, error))
        return None
    done = session.lay_out(changed, action.step.format(n=index + 1), PATH)
    session.end_gesture()
    return index + action.after if done else None


# -- buttons ---------------------------------------------------------------------------------------------


class SegmentBar(QWidget):
    """Buttons for ``ACTIONS``, without texts in a narrow dock.

    Signals: ``action_requested`` (name, cam angle [deg] or None) at a click of a button or an entry of ``menu``;
    ``abilities_changed`` (dict: name -> whether it is possible).
    """

    action_requested = Signal(str, object)
    abilities_changed = Signal(dict)

    def __init__(self) -> None:
        super().__init__()
        self._enabled: dict[str, bool] = {}
        self.buttons = {name: self._button(name) for name, row in ACTIONS.items() if row.has_button}
        row = fill(QHBoxLayout(self), *self.buttons.values(), STRETCH, margins=(4, 1, 4, 3), spacing=0)
        row.setSizeConstraint(QLayout.SizeConstraint.SetNoConstraint)
        self._text_width = sum(button.sizeHint().width() for button in self.buttons.values()) + 8

    def _button(self, name: str) -> QToolButton:
        row = ACTIONS[name]
        button = described(
            QToolButton(autoRaise=True, toolButtonStyle=Qt.ToolButtonStyle.ToolButtonTextBesideIcon), tip=row.tip
        )
        button.setText(row.text)
        button.setIcon(icon(row.icon))
        button.setIconSize(QSize(16, 16))
        button.clicked.connect(lambda: self.action_requested.emit(name, None))
        return button

    def minimumSizeHint(self) -> QSize:
        height = max(button.sizeHint().height() for button in self.buttons.values()) + 4
        return QSize(len(self.buttons) * (height + 4), height)

    def sizeHint(self) -> QSize:
        return QSize(self._text_width, self.minimumSizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        with_text = self.width() >= self._text_width
        style = Qt.ToolButtonStyle.ToolButtonTextBesideIcon if with_text else Qt.ToolButtonStyle.ToolButtonIconOnly
        for button in self.buttons.values():
            button.setToolButtonStyle(style)

    def show_segment(self, design: Design, index: int) -> None:
        """Enable the buttons of the actions that are possible for a segment."""
        enabled = {name: action.is_enabled(design, index) for name, action in ACTIONS.items()}
        if enabled != self._enabled:
            self._enabled = enabled
            for name, button in self.buttons.items():
                button.setEnabled(enabled[name])
            self.abilities_changed.emit(enabled)

    def menu(self, parent: QWidget, angle: float | None = None) -> QMenu:
        """Return the actions as a menu; angle: cam angle under the mouse [deg]."""
        menu = QMenu(parent)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        for name, row in ACTIONS.items():
            entry = menu.addAction(icon(row.icon), row.entry, partial(self.action_requested.emit, name, angle))
            entry.setEnabled(self._enabled.get(name, False))
        return menu


# -- view ------------------------------------------------------------------------------------------------


class SegmentForm(QScrollArea):
    """Area below or next to the table: form of the selected segment, and error texts.

    Its height depends on the view alone, so that no text moves the table or the buttons.
    """

    def __init__(self, *parts: QWidget) -> None:
        super().__init__(widgetResizable=True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._column = fill(QVBoxLayout(), *parts, STRETCH, margins=0, spacing=1)
        self.setWidget(widget_with(self._column))

    def add(self, part: QWidget) -> None:
        """Add a part below the others."""
        self._column.insertWidget(self._column.count() - 1, part)

    def set_view_height(self, view_height: int) -> None:
        """Take a share of the height of the view [pixels]; 0: no limit."""
        height = round(min(max(FORM_SHARE * view_height, LEAST_FORM_HEIGHT), MOST_FORM_HEIGHT))
        self.setMinimumHeight(height if view_height else LEAST_FORM_HEIGHT)
        self.setMaximumHeight(height if view_height else UNLIMITED)

    def reveal(self, part: QWidget) -> None:
        """Scroll to a text once it is laid out, unless the keyboard focus is in the form."""
        call_soon(part, partial(self._reveal, part))

    def _reveal(self, part: QWidget) -> None:
        focused = self.focusWidget()
        if part.isVisible() and (focused is None or not focused.hasFocus()):
            self.ensureWidgetVisible(part, 0, 0)


class SegmentsView(MarkedView):
    """View that edits the motion.

    ``abilities_changed`` (dict) gives for each action whether it is possible.
    """

    abilities_changed = Signal(dict)
    stages = ("motion",)
    arranges_itself = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.model = SegmentsModel(session, self)
        self.table = SegmentsTable(session, self.model)
        self.diagram = MotionEditor(session, player)
        self.derivatives = DerivativePlots(self.diagram, session)
        self.curve = SegmentCurveForm(session, player)
        self.header = MotionHeader(session)
        self.incomplete_bar = IncompleteBar()
        self.bar = SegmentBar()
        self.form = SegmentForm(self.curve, self.incomplete_bar)
        self._is_divided = False  # by the user
        self._action_refused = False
        self._has_derivatives = True  # the plots below the diagram show the current study
        self._hides_before = False  # the motion before the last edit
        self._before: Design | None = None
        self._displacement_before: np.ndarray | None = None
        self._sharing = single_shot(self, self._divide_height)  # after the layout
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        lower = QWidget()
        lower_form = widget_with(fill(QVBoxLayout(), self.form, self.bar, margins=0, spacing=1))
        self._parts = fill(
            QBoxLayout(QBoxLayout.Direction.TopToBottom, lower), (self.table, 1), lower_form, margins=0, spacing=1
        )
        self.splitter = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False)
        self.splitter.addWidget(self.derivatives)
        self.splitter.addWidget(lower)
        self._lower = lower
        self.splitter.setStretchFactor(0, 1)
        self.splitter.setStretchFactor(1, 0)
        layout = fill(QVBoxLayout(), self.header, (self.splitter, 1), margins=0, spacing=1)
        self.set_content_layout(layout)

    def _connect(self) -> None:
        connect_all(
            (self.model.error_changed, self._show_text),
            (self.table.insert_requested, partial(self.act, "insert")),
            (self.table.delete_requested, partial(self.act, "delete")),
            (self.bar.action_requested, self.act),
            (self.bar.abilities_changed, self.abilities_changed),
            (self.table.nudge_requested, self.diagram.nudge),
            (self.table.dropped, self.diagram.escape),
            (self.table.selectionModel().currentChanged, self._row_chosen),
        )
        self.table.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        connect_all(
            (self.table.customContextMenuRequested, self._open_menu),
            (self.diagram.segment_chosen, self._choose_row),
            (self.diagram.menu_requested, self._open_diagram_menu),
            (self.diagram.settled, self._draw),
            (self.diagram.released, self._hide_before),
            (self.derivatives.angle_moved, self._turn),
            (self.derivatives.visibility_changed, self._draw_derivatives),
            (self.splitter.splitterMoved, self._splitter_moved),
            (self.incomplete_bar.close_requested, self.session.close_motion),
            (self.incomplete_bar.drop_requested, partial(self.session.drop_incomplete, motion_alone=True)),
            (self.session.incomplete_changed, self.invalidate),
            (self.session.refused, self._refused),
            (self.session.accepted, self._accepted),
            (self.session.segment_chosen, self._segment_chosen),
        )

    @property
    def fields(self) -> dict[str, Field]:
        """Fields of start and stroke and of the curve of the selected segment, by path."""
        return {**self.header.fields, **self.curve.fields}

    # -- display -----------------------------------------------------------------------------------------

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.abilities_changed.connect(window.enable_segment_edits)
        self.header.card_requested.connect(partial(window.do, EDIT_CARD))
        for clicked in (self.table.clicked, self.diagram.segment_chosen):
            clicked.connect(lambda _: window.show_fields("motion"))

    def refresh(self, study: Study) -> None:
        require_motion_of_view(study.design)
        self._show_incomplete()
        if not self.header.fields:  # the first motion: the height of its table was unknown
            self._sharing.start()
        if self.session.drag_source:
            self._draw_diagram(study)
            self._has_derivatives = False
            self.refresh_in_turn(self._show_tables)
            self.refresh_in_turn(self._draw_derivatives)
        else:
            self._show_tables()
            self._draw()

    def shown_parts(self, study: Study) -> Hashable:
        session = self.session
        if session.incomplete is not None or self._action_refused or self.bands.is_shown or not study.has_disk:
            return None  # without a cam the figures of a turn depend on the loads
        design, before = study.design, None if session.before is None else motion_of(session.before)
        hidden = before is None or before == motion_of(design)
        return (
            session.chosen,
            study.depends_on("motion"),
            design.drive.limits,
            design.assumed,
            None if hidden else before,
        )

    def _show_tables(self) -> None:
        """Show header, table and fields, unless the design has changed again."""
        if not self.up_to_date:
            return
        study, typed = self.session.study, self.session.typed
        before = list(self.header.fields.values())
        self.header.show_motion(typed)
        if list(self.header.fields.values()) != before:
            editors = (field.editor for field in self.header.fields.values())
            in_tab_order(*editors, self.diagram, self.table, *self.bar.buttons.values())
        current, count = self.table.currentIndex(), self.model.rowCount()
        cell = (current.row(), current.column())
        waits = motion_waits(self.session)
        joins = joins_of(require_motion_of_view(typed)) if waits else study.program.joins
        self.model.show(typed, joins, waiting_paths(self.session))
        if self.model.rowCount() != count or not self.table.currentIndex().isValid():
            self.choose(*cell)
            self.table.updateGeometry()
            if not self._is_divided:
                self._sharing.start()
        self._show_chosen()
        if self._action_refused:  # another edit was made since
            self.session.withdraw(PATH)

    def _show_incomplete(self) -> None:
        """Show what an incomplete motion misses; the diagram then shows the last complete one and cannot be edited."""
        waits = motion_waits(self.session)
        is_computed = require_motion_of_view(self.session.typed).is_computed
        self.diagram.locked = waits or is_computed
        self.table.setEnabled(not is_computed)
        misfits = waits and not self.session.waits_for.reasons
        self.incomplete_bar.show_reasons(
            misfit_sentences(self.session) if misfits else [],
            back_text(self.session),
            closing_text(self.session) if misfits else "",
        )
        if misfits:
            self.form.reveal(self.incomplete_bar)

    def follow(self, theta: float) -> None:
        self.diagram.set_angle(theta)
        if self._has_derivatives:
            self._follow_in_derivatives(theta)

    def _follow_in_derivatives(self, theta: float) -> None:
        if self.derivatives.shown:
            self.derivatives.set_angle(theta, self.session.at(theta))
            self.extremes.resume()

    def _draw_derivatives(self) -> None:
        """Draw the plots below the diagram once they are shown."""
        if self.up_to_date and not self.in_trouble:
            self._show_derivatives(self.session.study)
            self._follow_in_derivatives(self.player.theta)

    def _draw(self) -> None:
        """Draw diagram, figures of the turn and derivatives."""
        study = self.session.study
        self._draw_diagram(study)
        self.header.show_cycle(study)
        self._show_derivatives(study)

    def _draw_diagram(self, study: Study) -> None:
        self.diagram.chosen = self.chosen
        channel = self._channel(study)
        companions = self.companions([channel])
        before = self._values_before(study) if companions["reference"] is None else None
        self.diagram.show_motion(study, channel, before, **companions)

    def _show_derivatives(self, study: Study) -> None:
        self._has_derivatives = True
        self.derivatives.show_study(study, self.companions)
        self.request_extremes(study)

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        return self.derivatives.lacking(study)

    def show_extremes(self, extremes: Mapping[str, Extremes] | None) -> None:
        self.derivatives.show_extremes(extremes)

    @staticmethod
    def _channel(study: Study) -> Quantity:
        return rows_of(study, ("displacement",))[0]

    def _values_before(self, study: Study) -> np.ndarray | None:
        """Return the displacement before the last edit (n,); None if the motion is the same or the curve is hidden."""
        before = self.session.before
        if before is not self._before:
            self._before, self._hides_before = before, False
            self._displacement_before = self._displacement(before)
        is_same = before is None or motion_of(before) == motion_of(study.design)
        return None if is_same or self._hides_before else self._displacement_before

    def _displacement(self, design: Design | None) -> np.ndarray | None:
        if design is None or motion_of(design) is None:
            return None
        study = Study(design, SAMPLES)
        try:
            return self._channel(study).values(study)
        except KindynaError:
            return None  # a spline whose points contradict each other

    def _hide_before(self) -> None:
        self._hides_before = True
        self._draw()

    @cached_property
    def message(self) -> RefusalLine:
        """The line about a refused entry or action, created with the first one."""
        from kindyna_gui.forms.refusal import RefusalLine  # imported here to save start-up time

        line = RefusalLine()
        self.form.add(line)
        return line

    def _show_text(self, text: str, remedies: Remedies = MappingProxyType({})) -> None:
        if text or "message" in vars(self):
            self.message.show_refusal(text, remedies)
        if text:
            self.form.reveal(self.message)

    def _refused(self, refusal: Refusal) -> None:
        if refusal.path == PATH:
            self._action_refused = True
            self._show_text(refusal.at(PATH))

    def _accepted(self, path: str) -> None:
        if path == PATH and self._action_refused:
            self._action_refused = False
            self._show_text("")

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        wide = self.width() >= WIDE
        direction = QBoxLayout.Direction.LeftToRight if wide else QBoxLayout.Direction.TopToBottom
        self.form.set_view_height(0 if wide else self.height())
        if direction != self._parts.direction():
            self._parts.setDirection(direction)
            self._parts.setStretch(1, int(wide))
            self.table.setMaximumWidth(TABLE_WIDTH if wide else UNLIMITED)
            self._is_divided = False
        if not self._is_divided:
            self._sharing.start()

    def _splitter_moved(self, *_: object) -> None:
        self._is_divided = True

    def _divide_height(self) -> None:
        """Give the table the height of its rows, and the rest to the diagram."""
        needed = self._lower.sizeHint().height()
        self.splitter.setSizes([max(self.splitter.height() - needed, 1), needed])

    # -- selection ---------------------------------------------------------------------------------------

    @property
    def chosen(self) -> int:
        """Number of the selected segment; the last one if none is selected."""
        row = self.table.currentIndex().row()
        return row if row >= 0 else self.model.rowCount() - 1

    def choose(self, row: int, column: int = LAW) -> None:
        """Select a cell."""
        row = max(0, min(row, self.model.rowCount() - 1))
        self.table.setCurrentIndex(self.model.index(row, max(0, column)))

    def _choose_row(self, row: int) -> None:
        if row != self.chosen:
            self.choose(row, self.table.currentIndex().column())

    def _segment_chosen(self) -> None:
        """Follow the selection of another view."""
        self._choose_row(self.session.segment)

    def _row_chosen(self, *_: object) -> None:
        if self.up_to_date and self.table.currentIndex().isValid():
            self.diagram.chosen = self.chosen
            self.diagram.update_highlight()
            self._show_chosen()
            if self._has_derivatives and not self.in_trouble:
                self.derivatives.show_limits(self.session.study)

    def _show_chosen(self) -> None:
        """Show the curve of the selected segment, and enable its actions."""
        design, row = self.session.typed, self.chosen
        self.session.choose_segment(row)
        self.curve.show_segment(design, row)
        self.bar.show_segment(design, row)

    # -- edits -------------------------------------------------------------------------------------------

    def act(self, name: str, angle: float | None = None) -> None:
        """Do one of ``ACTIONS`` with the selected segment at a cam angle [deg], by default the current one."""
        self.pull()
        chosen = perform(self.session, name, self.chosen, self.player.theta if angle is None else radians(angle))
        if chosen is not None:
            self.pull()
            self.choose(chosen, self.table.currentIndex().column())

    def focus_field(self, path: str) -> bool:
        """Show and focus the field or cell of a path; False if there is none.

        ``motion.start`` is enough for ``motion.start_mm``.
        """
        self.pull()
        if self.in_trouble:  # without a motion
            return False
        if self.header.focus_field(path):
            if path.startswith("motion.stroke") and not self.header.has_stroke:
                self.status_message.emit(NO_STROKE)
            return True
        self.choose(segment_of(path) or 0, COLUMN_OF_KEY.get(path.rpartition(".")[2], LAW))
        if not self.curve.focus_field(path):
            self.table.setFocus(Qt.FocusReason.OtherFocusReason)
        return path.startswith("motion")

    # -- menus -------------------------------------------------------------------------------------------

    def _open_menu(self, position: QPoint) -> None:
        index = self.table.indexAt(position)
        path = self.model.path(index.row(), index.column()) if index.isValid() else ""
        menu = self.bar.menu(self.table)
        if path and index.column() in (LAW, SPAN, RISE):
            on = is_assumed(self.session.typed, path)
            first = menu.actions()[0]
            assumed = menu.addAction("Assumed, not taken from a source", lambda: self._assume(path, not on))
            menu.insertAction(first, assumed)
            menu.insertSeparator(first)
            assumed.setCheckable(True)
            assumed.setChecked(on)
        if path:
            add_vary(menu, self.session, path)
        menu.popup(self.table.viewport().mapToGlobal(position))

    def _open_diagram_menu(self, position: QPoint, angle: float) -> None:
        menu, at = self.bar.menu(self.diagram, snap(angle, ANGLE_STEP)), snap(angle, ANGLE_STEP)
        if self.curve.points is not None and isinstance(self._curve(), OptimalCurve):
            menu.addSeparator()
            for key in ("below", "above"):
                entry = f"Add obstacle {key}"
                menu.addAction(icon("add"), entry, partial(self._add_obstacle, key, at))
        menu.popup(position)

    def _curve(self) -> Curve:
        """Return the curve of the selected segment."""
        return require_motion(self.session.typed).segments[self.chosen].curve

    def _add_obstacle(self, key: str, angle: float) -> None:
        """Add an obstacle of the optimal law of the selected segment at a cam angle [deg], and show its list."""
        if self.curve.points is not None and self.curve.points.choose(key):
            self.curve.points.add(angle)

    def _assume(self, path: str, on: bool) -> None:
        key, number = path.rpartition(".")[2].partition("_")[0], segment_of(path) or 0
        text = f"Mark {key} of segment {number + 1} as {'assumed' if on else 'known'}"
        self.session.mark_assumed(path, on, text)
