"""Motion view."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from math import degrees, radians
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPoint, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QBoxLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLayout,
    QMenu,
    QScrollArea,
    QSplitter,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import (
    Design,
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
from kindyna_gui.documents.texts import closing_text, joins_of, misfit_sentences, motion_waits, waiting_paths
from kindyna_gui.forms.fields import Field, add_vary, in_tab_order
from kindyna_gui.forms.form import IncompleteBar
from kindyna_gui.graph.marked_view import MarkedView
from kindyna_gui.labels import reason, segment_of
from kindyna_gui.look import coloured, icon
from kindyna_gui.motion.curve_fields import SegmentCurveForm
from kindyna_gui.motion.diagram import ANGLE_STEP, snapped, snapped_angle
from kindyna_gui.motion.editor import DerivativePlots, MotionEditor
from kindyna_gui.motion.head import NO_STROKE, MotionHead
from kindyna_gui.motion.segments_table import LAW, RISE, SPAN, SegmentsModel, SegmentsTable
from kindyna_gui.pictures.plots.quantities import rows_of
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import call_soon
from kindyna_gui.requirements import require_motion as require_motion_of_view
from kindyna_gui.view import ViewHost

# -- actions ---------------------------------------------------------------------------------------------

Change = Callable[[Design, int, float | None], Design]
"""The design with a segment changed; a cam angle [deg] where that matters."""


@frozen
class SegmentAction:
    """One row.

    text    of a button; entry: of a menu
    step    name of the step of the undo stack; {n} is the segment's number
    able    whether it makes sense for a segment
    after   which segment is chosen then: so many further on
    whole   it takes a motion that is whole
    button  it has one below the table; else it stands in menus only
    """

    text: str
    entry: str
    tip: str
    icon: str
    step: str
    change: Change
    able: Callable[[Design, int], bool]
    after: int = 0
    whole: bool = False
    button: bool = True

    def makes_sense(self, design: Design, index: int) -> bool:
        """Whether it can be done with a segment of a design, whose motion need not be whole."""
        motion = motion_of(design)
        if motion is None or motion.follows is not None or index >= len(motion.segments):
            return False  # none, or one that is changed in other files
        return not (self.whole and missing_of_motion(design)) and self.able(design, index)


def _span(design: Design, index: int) -> float:
    return require_motion(design).segments[index].span_deg


def _has_room(design: Design, index: int) -> bool:
    return _span(design, index) > 2.0 * LEAST_CUT


ACTIONS: Mapping[str, SegmentAction] = MappingProxyType(
    {
        "insert": SegmentAction(
            "Insert",
            "Insert segment",
            "A dwell behind the chosen segment, of half its span (Ins)",
            "insert",
            "Insert segment behind segment {n}",
            lambda design, index, _: insert_segment(design, index),
            _has_room,
            after=1,
        ),
        "insert_before": SegmentAction(
            "Insert before",
            "Insert before",
            "A dwell before the chosen segment, of half its span",
            "insert",
            "Insert segment before segment {n}",
            lambda design, index, _: insert_segment(design, index, before=True),
            _has_room,
            button=False,
        ),
        "split": SegmentAction(
            "Split",
            "Split segment",
            "Cut the chosen segment where the cam stands, or in its middle. A dwell, constant velocity, a polynomial "
            "and a spline go on as before; of any other law both parts run from rest to rest, and the follower stands "
            "at the cut where it stood before",
            "split",
            "Split segment {n}",
            split_segment,
            _has_room,
            whole=True,
        ),
        "duplicate": SegmentAction(
            "Duplicate",
            "Duplicate segment",
            "A copy behind the chosen segment: both take half of its span and half of its rise, so no other join moves",
            "duplicate",
            "Duplicate segment {n}",
            lambda design, index, _: copy_segment(design, index),
            _has_room,
            after=1,
            whole=True,
        ),
        "mirror": SegmentAction(
            "Mirror",
            "Mirror stroke",
            "The next stroke the other way becomes the mirror image of this one: its curves backwards, its spans, its "
            "rises turned round. The dwells give or take the difference",
            "mirror",
            "Mirror the stroke of segment {n}",
            lambda design, index, _: mirror_stroke(design, index),
            lambda design, index: mirror_stroke(design, index) is not design,
            whole=True,
        ),
        "delete": SegmentAction(
            "Delete",
            "Delete segment",
            "Take the chosen segment away; the one before it gets its span (Del)",
            "delete",
            "Delete segment {n}",
            lambda design, index, _: remove_from_incomplete(design, index),
            lambda design, _: len(require_motion(design).segments) > 1,
        ),
    }
)


PATH = "motion.segments"
"""At which edits of whole segments are made, and refused."""


def perform(session: Session, name: str, index: int, theta: float) -> int | None:
    """Do one of ``ACTIONS`` with a segment as one step, at a cam angle [rad]; the number of the segment that is to be chosen then, None
    where it makes no sense or is refused."""
    action, design = ACTIONS[name], session.typed
    if not action.makes_sense(design, index):
        return None
    session.end_gesture()
    try:
        changed = action.change(design, index, snapped_angle(degrees(theta)))
    except KindynaError as error:
        session.refuse(PATH, reason(design, error))
        return None
    done = session.lay_out(changed, action.step.format(n=index + 1), PATH)
    session.end_gesture()
    return index + action.after if done else None


# -- a row of buttons for what can be done with the chosen segment ---------------------------------------


class SegmentBar(QWidget):
    """The rows of ``ACTIONS`` as buttons; without their texts where there is no room for these.

    wanted             (name, cam angle [deg] or None): a button was clicked, or an entry of ``menu``
    abilities_changed  (dict: name -> whether it makes sense now)
    """

    wanted = Signal(str, object)
    abilities_changed = Signal(dict)

    def __init__(self) -> None:
        super().__init__()
        self._able: dict[str, bool] = {}
        self.buttons = {name: self._button(name) for name, row in ACTIONS.items() if row.button}
        row = QHBoxLayout(self)
        row.setContentsMargins(4, 1, 4, 3)
        row.setSpacing(0)
        for button in self.buttons.values():
            row.addWidget(button)
        row.addStretch(1)
        row.setSizeConstraint(QLayout.SizeConstraint.SetNoConstraint)
        self._text_width = sum(button.sizeHint().width() for button in self.buttons.values()) + 8

    def _button(self, name: str) -> QToolButton:
        row = ACTIONS[name]
        button = QToolButton(autoRaise=True)
        button.setText(row.text)
        button.setIcon(icon(row.icon))
        button.setToolTip(row.tip)
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.setIconSize(QSize(16, 16))
        button.clicked.connect(lambda: self.wanted.emit(name, None))
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
        """Grey what makes no sense for a segment."""
        able = {name: action.makes_sense(design, index) for name, action in ACTIONS.items()}
        if able != self._able:
            self._able = able
            for name, button in self.buttons.items():
                button.setEnabled(able[name])
            self.abilities_changed.emit(able)

    def menu(self, parent: QWidget, angle: float | None = None) -> QMenu:
        """The same as a menu, which goes when it closes; angle: the cam angle that was pointed at [deg]."""
        made = QMenu(parent)
        made.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        for name, row in ACTIONS.items():
            entry = made.addAction(icon(row.icon), row.entry, partial(self.wanted.emit, name, angle))
            entry.setEnabled(self._able.get(name, False))
        return made


# -- segments view ---------------------------------------------------------------------------------------

_KEYS = {"law": LAW, "span_deg": SPAN, "rise_mm": RISE, "rise_deg": RISE}
TABLE_WIDTH = 420  # pixels, of the table where the form of the chosen segment stands beside it
BESIDE = 700  # from this width on it does
BELOW = 0.2  # of the height, for the form where it stands below the table
LEAST_BELOW, MOST_BELOW = 66, 200  # pixels
FREE = 16777215  # pixels, Qt's own word for no limit


class SegmentForm(QScrollArea):
    """What stands below the table of segments, or beside it: the form of the chosen one, and what is missing or wrong.

    Its height is that of the view's alone, or of the table's, so that no text moves the rows above it, nor the buttons below.
    """

    def __init__(self, *parts: QWidget) -> None:
        super().__init__(widgetResizable=True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        paper = QWidget()
        column = QVBoxLayout(paper)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(1)
        for part in parts:
            column.addWidget(part)
        column.addStretch(1)
        self.setWidget(paper)

    def take_height(self, whole: int) -> None:
        """Its part of a view's height [pixels]; of none what there is."""
        height = round(min(max(BELOW * whole, LEAST_BELOW), MOST_BELOW))
        self.setMinimumHeight(height if whole else LEAST_BELOW)
        self.setMaximumHeight(height if whole else FREE)

    def bring(self, part: QWidget) -> None:
        """Scroll a text that has come into sight, once it has its place; not while the keys are in what would move."""
        call_soon(part, partial(self._bring, part))

    def _bring(self, part: QWidget) -> None:
        focused = self.focusWidget()
        if part.isVisible() and (focused is None or not focused.hasFocus()):
            self.ensureWidgetVisible(part, 0, 0)


class SegmentsView(MarkedView):
    """The motion editor.

    abilities_changed   (dict: name of an action -> whether it makes sense now)
    """

    abilities_changed = Signal(dict)
    stages = ("motion",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.model = SegmentsModel(session, self)
        self.table = SegmentsTable(session, self.model)
        self.diagram = MotionEditor(session, player)
        self.diagram.setMinimumSize(240, 90)
        self.derivatives = DerivativePlots(self.diagram)
        self.curve = SegmentCurveForm(session, player)
        self.head = MotionHead(session)
        self.incomplete_bar = IncompleteBar()
        self.message = QLabel(wordWrap=True)
        self.message.setMargin(6)
        coloured(self.message, SCREEN.limit)
        self.message.hide()
        self.bar = SegmentBar()
        self.below = SegmentForm(self.curve, self.incomplete_bar, self.head.troubles, self.message)
        self._parted = False  # by the user
        self._act_refused = False
        self._forgotten = False  # the motion before the last edit is not to be seen
        self._recalled: Design | None = None
        self._recalled_values: np.ndarray | None = None
        self._sharing = QTimer(self, singleShot=True, interval=0)  # once all has its place
        self._sharing.timeout.connect(self._share)
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        lower = QWidget()
        self._parts = QBoxLayout(QBoxLayout.Direction.TopToBottom, lower)
        self._parts.setContentsMargins(0, 0, 0, 0)
        self._parts.setSpacing(1)
        form = QWidget()
        column = QVBoxLayout(form)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(1)
        column.addWidget(self.below)
        column.addWidget(self.bar)
        self._parts.addWidget(self.table, 1)
        self._parts.addWidget(form)
        self.splitter = QSplitter(Qt.Orientation.Vertical)
        self.splitter.setChildrenCollapsible(False)
        self.splitter.addWidget(self.derivatives)
        self.splitter.addWidget(lower)
        self._lower = lower
        self.splitter.setStretchFactor(0, 1)
        self.splitter.setStretchFactor(1, 0)
        layout = QVBoxLayout()
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(1)
        layout.addWidget(self.head)
        layout.addWidget(self.splitter, 1)
        self.set_content_layout(layout)

    def _connect(self) -> None:
        self.model.error_changed.connect(self._show_text)
        self.curve.error_changed.connect(self._show_text)
        self.table.insert_requested.connect(partial(self.act, "insert"))
        self.table.delete_requested.connect(partial(self.act, "delete"))
        self.bar.wanted.connect(self.act)
        self.bar.abilities_changed.connect(self.abilities_changed)
        self.table.nudge_requested.connect(self.diagram.nudge)
        self.table.dropped.connect(self.diagram.escape)
        self.table.selectionModel().currentChanged.connect(self._row_chosen)
        self.table.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.table.customContextMenuRequested.connect(self._open_menu)
        self.diagram.segment_chosen.connect(self._choose_row)
        self.diagram.menu_requested.connect(self._open_diagram_menu)
        self.diagram.settled.connect(self._draw)
        self.diagram.released.connect(self._forget_before)
        self.derivatives.angle_moved.connect(self._turn)
        self.derivatives.room_changed.connect(self._draw_derivatives)
        self.splitter.splitterMoved.connect(self._part)
        self.incomplete_bar.close_requested.connect(self.session.close_motion)
        self.incomplete_bar.drop_requested.connect(partial(self.session.drop_incomplete, motion_alone=True))
        self.session.incomplete_changed.connect(self.invalidate)
        self.session.refused.connect(self._refused)
        self.session.accepted.connect(self._accepted)
        self.session.segment_chosen.connect(self._segment_chosen)

    @property
    def fields(self) -> dict[str, Field]:
        """Start and stroke, and what the curve of the chosen segment takes, by their paths."""
        return {**self.head.fields, **self.curve.fields}

    # -- showing ------------------------------------------------------------------------------------------

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.abilities_changed.connect(window.enable_segment_edits)
        for clicked in (self.table.clicked, self.diagram.segment_chosen):
            clicked.connect(lambda _: window.show_fields("motion"))

    def refresh(self, study: Study) -> None:
        require_motion_of_view(study.design)
        self._show_draft()
        if not self.head.fields:  # the first motion: only now it is known what its table needs
            self._sharing.start()
        if self.session.drag_source:
            self._draw_diagram(study)
            self.refresh_in_turn(self._show_tables)
            self.refresh_in_turn(self._draw_derivatives)
        else:
            self._show_tables()
            self._draw()

    def _show_tables(self) -> None:
        """Head, table and fields, unless something else is in place by now."""
        if not self.up_to_date:
            return
        study, typed = self.session.study, self.session.typed
        before = list(self.head.fields.values())
        self.head.show_motion(typed)
        if list(self.head.fields.values()) != before:
            heads = (field.editor for field in self.head.fields.values())
            in_tab_order(*heads, self.diagram, self.table, *self.bar.buttons.values())
        at, count = self.table.currentIndex(), self.model.rowCount()
        place = (at.row(), at.column())
        waits = motion_waits(self.session)
        joins = joins_of(require_motion_of_view(typed)) if waits else study.program.joins
        self.model.show(typed, joins, waiting_paths(self.session))
        if self.model.rowCount() != count or not self.table.currentIndex().isValid():
            self.choose(*place)
            self.table.updateGeometry()
            if not self._parted:
                self._sharing.start()
        self._show_chosen()
        if self._act_refused:  # something else has been done since
            self.session.withdraw(PATH)

    def _show_draft(self) -> None:
        """Show what is missing of a motion that does not fit; meanwhile the diagram shows the last that did, and cannot be drawn at."""
        waits = motion_waits(self.session)
        follows = require_motion_of_view(self.session.typed).follows is not None
        self.diagram.locked = waits or follows
        self.table.setEnabled(not follows)
        self.incomplete_bar.show_reasons(
            misfit_sentences(self.session) if waits else [], closing_text(self.session) if waits else ""
        )
        if waits:
            self.below.bring(self.incomplete_bar)

    def follow(self, theta: float) -> None:
        self.diagram.set_angle(theta)
        if self.derivatives.roomy:
            self.derivatives.set_angle(theta, self.session.at(theta))
            self.extremes.resume()

    def _draw_derivatives(self) -> None:
        """The plots below the diagram have come, and are to be what it is."""
        if self.up_to_date and not self.in_trouble:
            self._show_derivatives(self.session.study)
            self.follow(self.player.theta)

    def _turn(self, theta: float) -> None:
        self.player.play(False)
        self.player.set_theta(theta)

    def _draw(self) -> None:
        """The diagram, with the motion before the last edit where there is one to be seen."""
        study = self.session.study
        self._draw_diagram(study)
        self.head.show_cycle(study)
        self._show_derivatives(study)

    def _draw_diagram(self, study: Study) -> None:
        self.diagram.chosen = self.chosen
        channel = self._channel(study)
        self.diagram.show_motion(study, channel, self._values_before(study), self.bands.read([channel]))

    def _show_derivatives(self, study: Study) -> None:
        self.derivatives.show_study(study, self.bands)
        self.request_extremes(study)

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        return self.derivatives.lacking(study)

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        self.derivatives.show_extremes(found)

    @staticmethod
    def _channel(study: Study) -> Quantity:
        return rows_of(study, ("displacement",))[0]

    def _values_before(self, study: Study) -> np.ndarray | None:
        """The displacement before the last edit (n,), where the motion was another one and has not been let go."""
        before = self.session.before
        if before is not self._recalled:
            self._recalled, self._forgotten = before, False
            self._recalled_values = self._displacement(before)
        same = before is None or motion_of(before) == motion_of(study.design)
        return None if same or self._forgotten else self._recalled_values

    def _displacement(self, design: Design | None) -> np.ndarray | None:
        if design is None or motion_of(design) is None:
            return None
        study = Study(design, SAMPLES)
        try:
            return self._channel(study).values(study)
        except KindynaError:
            return None  # a spline whose points contradict each other

    def _forget_before(self) -> None:
        self._forgotten = True
        self._draw()

    def _show_text(self, text: str) -> None:
        self.message.setText(text)
        self.message.setVisible(bool(text))
        if text:
            self.below.bring(self.message)

    def _refused(self, refusal: Refusal) -> None:
        if refusal.path == PATH:
            self._act_refused = True
            self._show_text(refusal.at(PATH))

    def _accepted(self, path: str) -> None:
        if path == PATH and self._act_refused:
            self._act_refused = False
            self._show_text("")

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        wide = self.width() >= BESIDE
        direction = QBoxLayout.Direction.LeftToRight if wide else QBoxLayout.Direction.TopToBottom
        self.below.take_height(0 if wide else self.height())
        if direction != self._parts.direction():
            self._parts.setDirection(direction)
            self._parts.setStretch(1, int(wide))
            self.table.setMaximumWidth(TABLE_WIDTH if wide else FREE)
            self._parted = False
        if not self._parted:
            self._sharing.start()

    def _part(self, *_: object) -> None:
        """The user has drawn the line between diagram and table."""
        self._parted = True

    def _share(self) -> None:
        """The table gets what its rows need, the diagram the rest."""
        wanted = self._lower.sizeHint().height()
        self.splitter.setSizes([max(self.splitter.height() - wanted, 1), wanted])

    # -- choosing -----------------------------------------------------------------------------------------

    @property
    def chosen(self) -> int:
        """The chosen segment; the last one where none is."""
        row = self.table.currentIndex().row()
        return row if row >= 0 else self.model.rowCount() - 1

    def choose(self, row: int, column: int = LAW) -> None:
        """Choose a cell."""
        row = max(0, min(row, self.model.rowCount() - 1))
        self.table.setCurrentIndex(self.model.index(row, max(0, column)))

    def _choose_row(self, row: int) -> None:
        if row != self.chosen:
            self.choose(row, self.table.currentIndex().column())

    def _segment_chosen(self) -> None:
        """In another view."""
        self._choose_row(self.session.segment)

    def _row_chosen(self, *_: object) -> None:
        if self.up_to_date and self.table.currentIndex().isValid():
            self.diagram.chosen = self.chosen
            self.diagram.point_out()
            self._show_chosen()

    def _show_chosen(self) -> None:
        """What belongs to the chosen segment: its curve, and what can be done with it."""
        design, row = self.session.typed, self.chosen
        self.session.choose_segment(row)
        self.curve.show_segment(design, row)
        self.bar.show_segment(design, row)

    # -- changing -----------------------------------------------------------------------------------------

    def act(self, name: str, angle: float | None = None) -> None:
        """One of ``ACTIONS`` on the chosen segment; angle: a cam angle [deg], where the cam stands if None."""
        self.pull()
        chosen = perform(self.session, name, self.chosen, self.player.theta if angle is None else radians(angle))
        if chosen is not None:
            self.pull()
            self.choose(chosen, self.table.currentIndex().column())

    def focus_field(self, path: str) -> bool:
        """Bring the field or cell of a path before the reader; ``motion.start`` will do for ``motion.start_mm``.
        False where there is none."""
        self.pull()
        if self.in_trouble:  # there is no motion, as the view shows
            return False
        if self.head.focus_field(path):
            if path.startswith("motion.stroke") and not self.head.moves:
                self.status_message.emit(NO_STROKE)
            return True
        self.choose(segment_of(path) or 0, _KEYS.get(path.rpartition(".")[2], LAW))
        if not self.curve.focus_field(path):
            self.table.setFocus(Qt.FocusReason.OtherFocusReason)
        return path.startswith("motion")

    # -- menus --------------------------------------------------------------------------------------------

    def _open_menu(self, place: QPoint) -> None:
        index = self.table.indexAt(place)
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
        menu.popup(self.table.viewport().mapToGlobal(place))

    def _open_diagram_menu(self, place: QPoint, angle: float) -> None:
        self.bar.menu(self.diagram, snapped(angle, ANGLE_STEP)).popup(place)

    def _assume(self, path: str, on: bool) -> None:
        key, number = path.rpartition(".")[2].partition("_")[0], segment_of(path) or 0
        text = f"Mark {key} of segment {number + 1} as {'assumed' if on else 'known'}"
        self.session.mark_assumed(path, on, text)
