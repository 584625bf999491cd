"""Make > Blend: choose type, settings and goal; the blended motion follows every keystroke."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QButtonGroup, QFrame, QHBoxLayout, QLabel, QRadioButton, QTabWidget, QVBoxLayout, QWidget

from core.blend import BlendError, BlendResult, Request, best, blend, feasible_ranges, has_room
from core.blend.best import SplitSegment, split_segment, with_blend_as_motion, with_blend_between
from core.design import UNITS, Design, Segment, faults, require_motion, with_motion
from core.errors import DesignError, KindynaError
from core.find import blend_candidates
from core.laws import LAWS
from core.number_text import shortest
from core.output.channels import channels
from core.requests import command_words
from core.study import Study
from kindyna_gui.background import Background, Job
from kindyna_gui.blend.questions import Questions, SuccessionPage
from kindyna_gui.blend.request import (
    HEADINGS,
    command_options,
    effect,
    figures,
    first_request,
    has_both,
    plan,
    range_request,
    table,
)
from kindyna_gui.blend.settings import PrecisionPointRow, RangedRow, quiet
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import add_copy_of_line, command_text, session_options
from kindyna_gui.forms.faded_cover import FadedCover
from kindyna_gui.forms.number_box import LiveBox
from kindyna_gui.forms.refusal import NO_REMEDIES, Remedies
from kindyna_gui.forms.request_form import PutDialog
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import law_label, reason
from kindyna_gui.look import bold_label
from kindyna_gui.motion.laws_plot import RankingPanel
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.settings import symbol_of

QUANTITIES = ("displacement", "velocity", "acceleration")
SAMPLES = 720
"""Cam angles of the plotted curves, few enough to draw them with every keystroke."""
PAUSE_MS = 250  # after a keystroke, before the optimum is searched for
SLOW_MS = 150  # after which a range that is still being computed is no longer shown
LAST = "The last feasible motion"
SEARCHING = "Calculating …"
ALONE = "Not in the design: the plots show these curves with a return of their own"
FORM_WIDTH, TYPICAL_SIZE, LEAST_SIZE = 560, QSize(1180, 740), QSize(1100, 560)
REPLACEMENTS: Mapping[str, Callable[[Design, BlendResult], Design]] = MappingProxyType(
    {"turn": with_blend_as_motion, "range": with_blend_between}
)
"""Part of the motion that the blend replaces -> function that replaces it."""

# -- result ----------------------------------------------------------------------------------------------


class BlendPanel(QFrame):
    """Blended motion: sequence, figures, table, and curves over the full turn, with the current design dashed."""

    def __init__(self, unit: str) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self.setAutoFillBackground(True)
        symbol = symbol_of(UNITS[unit].symbol)
        self.headline = QLabel()
        big = self.headline.font()
        big.setBold(True)
        big.setPixelSize(round(self.headline.fontInfo().pixelSize() * 1.2))
        self.headline.setFont(big)
        self.figures = quiet()
        self.figures.setWordWrap(True)
        for label in (self.headline, self.figures):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        columns = [(i > 0, heading) for i, heading in enumerate(HEADINGS)]
        # headings with a unit are long: they get the width they need, the angles share the rest
        self.table = RowsTable(
            [TableHeading(text.format(u=symbol), number=n, wide=n and "{u}" not in text) for n, text in columns]
        )
        self.table.setFrameShape(QFrame.Shape.NoFrame)
        self.table.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.plots = [CurvePlot(names=i == 0, angles=i == len(QUANTITIES) - 1) for i in range(len(QUANTITIES))]
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 8, 6)
        column.setSpacing(4)
        column.addWidget(self.headline)
        column.addWidget(self.figures)
        column.addWidget(self.table)
        for plot in self.plots:
            plot.setMinimumHeight(84)
            plot.show_cursor(False)
            column.addWidget(plot, 1)
        self.cover = FadedCover(self)
        self._keep_height()

    def show_blend(self, blended: BlendResult, design: Design | None, before: Study, why: str = "") -> None:
        """Show a blend, and the motion of the design with it over that of the design before.

        ``why`` is not empty where the blend cannot replace that part of the motion; the design then moves by the blend
        alone, or is None.
        """
        self.headline.setText("–".join(blended.curves))
        alone = [ALONE] if why and design is not None else []
        self.figures.setText("\n".join((*figures(blended, before.design.speed_rpm), *alone)))
        rows = table(blended)
        self.table.show_rows([TableRow(cells) for cells in rows])
        self._keep_height()
        if design is None:
            for plot in self.plots:
                plot.show_message("")
            self.plots[0].show_message(why)
        else:
            self._draw(design, before)
        self.cover.show_text("")

    def show_current(self, before: Study) -> None:
        """Show the motion of the current design, before there is a blend."""
        self.headline.setText("No motion yet")
        self.figures.setText("Showing the motion of the current design")
        self._draw(before.design, None)

    def _draw(self, design: Design, before: Study | None) -> None:
        study = Study(design, SAMPLES)
        rows = {row.name: row for row in channels(design)}
        for quantity, plot in zip(QUANTITIES, self.plots, strict=True):
            plot.set_curves(study, [rows[quantity]], before, reference_name="current design")

    def _keep_height(self) -> None:
        """Make the table as high as its rows, without scrolling."""
        rows = sum(self.table.rowHeight(i) for i in range(len(self.table.rows.rows)))
        self.table.setFixedHeight(self.table.horizontalHeader().sizeHint().height() + rows + 2)


def _degrees(angle: float) -> str:
    return f"{shortest(angle)}°"


def _alone(design: Design, blended: BlendResult) -> Design | None:
    """Return the design moved by a blend alone, with a return of its own; None where the turn has no room for that."""
    still = with_motion(design, replace(require_motion(design), segments=(Segment(360.0, 0.0),)))
    try:
        return with_blend_between(still, blended)
    except KindynaError:
        return None


def _closes(request: Request) -> bool:
    """Whether the curves of a request return to their start, so that they can be the motion of a full turn."""
    return has_both(request.type) and request.return_stroke in (0.0, request.stroke)


def _split_text(split: SplitSegment, remedy: str) -> str:
    """Sentence about a cam angle inside a moving segment, and its remedy."""
    inside = f"{_degrees(split.angle_deg)} lies inside the moving segment {split.number + 1}"
    return f"{inside} ({shortest(split.start_deg)} … {_degrees(split.end_deg)}). {remedy}."


def place_of(session: Session) -> tuple[float, float]:
    """Cam angles [deg] of the stroke at the selected segment, or of the next stroke."""
    motion = require_motion(session.design)
    request = first_request(motion, min(session.segment, len(motion.segments) - 1))
    return request.start, request.end


# -- dialogs ---------------------------------------------------------------------------------------------


class BlendPutDialog(PutDialog):
    """Dialog that shows a blended motion in the design and puts it there as one step.

    The motion follows every keystroke; while there is none, the last one stays visible under a cover.

    Attributes
    ----------
    blended : motion that follows from the form; None while there is none
    design : the design with that motion; None if the motion cannot be put into it
    timers : those after which a calculation starts
    """

    def __init__(self, session: Session, title: str, parent: QWidget | None) -> None:
        super().__init__(session, title, parent)
        self.blended: BlendResult | None = None
        self.design: Design | None = None
        self.panel, self.ranking = BlendPanel(require_motion(session.design).unit), RankingPanel()
        self.solver, self.ranges = Background(self), Background(self)
        self.timers: tuple[QTimer, ...] = ()

    def show_in_design(self, blended: BlendResult, replace_motion: Callable[[BlendResult], Design]) -> bool:
        """Show the design with a blend, without changing the current design; False where the blend cannot be put into it."""
        session = self._session
        self.design = None
        try:
            design = replace_motion(blended)
        except KindynaError as error:
            why, remedies = self.refusal(blended.request, reason(session.design, error))
            self.show_message(why, True, remedies)
            self.panel.show_blend(blended, _alone(session.design, blended), session.study, why)
            return False
        fault = reason(design, DesignError(faults(design)))
        fault, remedies = self.refusal(blended.request, fault) if fault else ("", NO_REMEDIES)
        said = fault or effect(require_motion(session.design), require_motion(design), blended)
        self.show_message(said, bool(fault), remedies)
        self.panel.show_blend(blended, design, session.study)
        self.design = None if fault else design
        return True

    def refusal(self, request: Request, why: str) -> tuple[str, Remedies]:
        """Return why the design does not accept the blend, and the remedies: other cam angles, such as its own."""
        motion, start, end = require_motion(self._session.design), request.start, request.end
        if self.blended is None or not self.replaces_range(self.blended):
            return why, NO_REMEDIES
        if (split := split_segment(motion, start, end)) is None:
            own = place_of(self._session)
            text = f"Use {shortest(own[0])} … {_degrees(own[1])}"
            return why, NO_REMEDIES if own == (start, end) else {text: partial(self._set_angles, *own)}
        is_start = split.angle_deg == start
        ends = [(angle, end) if is_start else (start, angle) for angle in (split.start_deg, split.end_deg)]
        valid = {_degrees(row[0 if is_start else 1]): row for row in ends if has_room(*row)}
        verb = "Start" if is_start else "End"
        remedies = {f"{verb} at {angle}": partial(self._set_angles, *row) for angle, row in valid.items()}
        return _split_text(split, f"{verb} at {' or '.join(valid) or 'another angle'}"), remedies

    def replaces_range(self, blended: BlendResult) -> bool:
        """Whether the blend replaces the motion between its cam angles only."""
        raise NotImplementedError

    def angle_boxes(self) -> tuple[LiveBox, LiveBox]:
        """Boxes of the first and the last cam angle."""
        raise NotImplementedError

    def _set_angles(self, start: float, end: float) -> None:
        """Enter both cam angles, as a remedy."""
        first, last = self.angle_boxes()
        first.set_number(start)
        last.set_number(end)
        first.changed.emit()

    def command_line(self, request: Request, goal: str) -> str:
        """Command ``blend`` for a request."""
        from core.commands.motions import BlendArguments

        options = command_options(request, goal) | session_options(self._session)
        return command_text("blend", command_words(BlendArguments, options))

    def stop(self) -> None:
        """Cancel all running calculations."""
        for timer in self.timers:
            timer.stop()
        for calculation in (self.solver, self.ranges):
            calculation.stop()

    def accept(self) -> None:
        """Put the motion into the design, if there is one."""
        if self.design is not None and self.blended is not None:
            self.put(self.design, f"Blend {'-'.join(self.blended.curves)}")

    def done(self, result: int) -> None:
        self.stop()
        for calculation in (self.solver, self.ranges):
            calculation.close()
        self.ranking.close_work()
        super().done(result)


class BlendDialog(BlendPutDialog):
    """Dialog that blends a motion from its type, its settings and a goal."""

    help_page = "blending#What you may set"

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(session, "Blend a motion", parent)
        motion = require_motion(session.design)
        self.questions, self.succession = Questions(motion.unit), SuccessionPage()
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._slow = QTimer(self, singleShot=True, interval=SLOW_MS)
        self.timers = self._soon, self._pause, self._slow
        self._chooses_part = True  # the next result chooses the part that it replaces, if the current one is refused
        self._waiting: list[RangedRow] = []  # rows without their range
        self._requested_rows: tuple[RangedRow, ...] = ()
        self._lay_out()
        self.copy = add_copy_of_line(self.buttons, self._as_command)
        self._connect()
        request = first_request(motion, min(session.segment, len(motion.segments) - 1))
        self.questions.set_request(request)
        strokes = [s.rise for s in motion.segments if s.rise]
        total_rise = sum(rise for rise in strokes if rise > 0.0)
        is_all = not strokes or (_closes(request) and total_rise <= request.stroke + 1e-9)
        self.replaced["turn" if is_all else "range"].setChecked(True)
        self.panel.show_current(session.study)
        self.questions.kind.types[request.type].setFocus()
        self.solve_request()

    # -- layout ------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        questions = QVBoxLayout()
        questions.addWidget(self.questions, 1)
        questions.addLayout(self._replacement_row())
        self.pages = QTabWidget(documentMode=True)
        self.pages.addTab(self.panel, "&Motion")
        self.pages.addTab(self.succession, "Which curve &follows")
        self.pages.addTab(self.ranking, "In this &design")
        self.frame(questions, FORM_WIDTH, self.pages, TYPICAL_SIZE, LEAST_SIZE)

    def _replacement_row(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.addWidget(bold_label("Replace"))
        row.addSpacing(8)
        self.replaced = {"turn": QRadioButton("the full turn"), "range": QRadioButton()}
        self.replaced["turn"].setToolTip("Replace the full motion: a dwell, these curves, a dwell")
        self.replaced["range"].setToolTip("Replace the motion between these cam angles; the rest does not change")
        group = QButtonGroup(self)
        for button in self.replaced.values():
            group.addButton(button)
            row.addWidget(button)
            button.clicked.connect(self._put_into_design)
        row.addStretch(1)
        return row

    def _connect(self) -> None:
        self.questions.kind.type_chosen.connect(self._type_chosen)
        self.questions.changed.connect(self._soon.start)
        self._soon.timeout.connect(self.solve_request)
        self._pause.timeout.connect(self._start_best)
        self._slow.timeout.connect(self._cover_old_results)
        self.solver.result.connect(self._show_result)
        self.ranges.result.connect(self._show_range)
        self.ranking.chosen.connect(self._choose_ranked)

    def _type_chosen(self) -> None:
        self._chooses_part = True

    def _choose_ranked(self, name: str) -> None:
        """Blend the sequence of a row of the ranking."""
        if name in LAWS:
            self.show_message(f"{law_label(name)} is a motion law, not a blend: use it from the table of laws")
        elif name != "-".join(self.blended.curves if self.blended is not None else ()):
            self.questions.take_sequence(name)

    # -- calculation -------------------------------------------------------------------------------------

    def solve_request(self) -> None:
        """Begin to compute the motion that follows from the form."""
        questions = self.questions
        self.stop()
        questions.show_request()
        request = questions.request()
        self._show_replaced(request)
        self.blended = self.design = None
        self.ranking.stop()
        self.put_button.setEnabled(False)
        goal = questions.chosen_goal
        planned = plan(request, goal)
        missing = planned.missing
        if planned.target is not None:
            self.succession.show_sequence(request.type, planned.target.sequence)
        is_refused = questions.find_faults()
        self.copy.setEnabled(not is_refused)
        if is_refused:
            self._cover(LAST)
            return
        self._waiting = questions.settings.shown_rows()
        self._slow.start()
        if goal and not missing:
            self._pause.start()  # the ranges follow the optimum
            return
        self._start_ranges(request)
        if missing:
            self._cover(f"{missing} more to set" if missing > 0 else f"{-missing} too many set")
        else:
            self.solver.start([(request, partial(blend, request))])

    @property
    def busy(self) -> bool:
        """Whether anything shown is still being computed."""
        return self.is_solving or self.ranges.busy

    @property
    def is_solving(self) -> bool:
        """Whether the motion is still being computed; the ranges follow later."""
        return self._soon.isActive() or self._pause.isActive() or self.solver.busy

    def _start_best(self) -> None:
        request, goal = self.questions.request(), self.questions.chosen_goal
        self._cover(f"Calculating the least {goal} …")
        self.solver.start([(request, partial(best, request, goal))])

    def _start_ranges(self, request: Request) -> None:
        """Compute ranges: first of the focused row; then of the ticked rows, or of the others while a setting is missing."""
        goal = self.questions.chosen_goal
        ranged, is_complete = range_request(request, goal), plan(request, goal).missing == 0
        focused = self.focusWidget()
        rows = sorted(self._waiting, key=lambda row: (focused not in row.boxes(), row.is_used != is_complete))
        jobs: list[Job] = []
        for row in rows:
            at = (row.at.number or 0.0,) if isinstance(row, PrecisionPointRow) else ()
            jobs.append((self._waiting.index(row), partial(feasible_ranges, ranged, row.name, *at)))
        self._requested_rows = tuple(self._waiting)
        self.ranges.start(jobs)

    # -- results -----------------------------------------------------------------------------------------

    def _show_range(self, number: int, result: object) -> None:
        row = self._requested_rows[number]
        self._waiting.remove(row)
        if self.questions.settings.has(row):
            row.show_ranges(result if isinstance(result, list) else ())

    def _cover_old_results(self) -> None:
        """Mark ranges and motion that are still being computed."""
        for row in filter(self.questions.settings.has, self._waiting):
            row.show_ranges(None)
        if self.solver.busy:
            self._cover(SEARCHING)

    def _show_result(self, request: Request, result: BlendResult | KindynaError) -> None:
        if self.questions.chosen_goal:
            self._start_ranges(request)
        if isinstance(result, BlendResult):
            self.blended = result
            self.questions.settings.note_feasible()
            self._put_into_design()
            return
        self.copy.setEnabled(False)
        self._cover(LAST)
        if isinstance(result, BlendError):
            self.questions.show_error(result)
        else:
            self.questions.general.show_message(reason(self._session.design, result))

    def _cover(self, text: str) -> None:
        self.show_message("")
        self.panel.cover.show_text(text)

    def _put_into_design(self, *_: object) -> None:
        """Show the design with the blended motion, and rank the alternatives."""
        if self.blended is not None:
            if self._chooses_part:
                self._chooses_part = False
                if not self._is_accepted(self._replaced_part):
                    part = next(filter(self._is_accepted, self.replaced), self._replaced_part)
                    self.replaced[part].setChecked(True)
            replace_motion = partial(REPLACEMENTS[self._replaced_part], self._session.design)
            self.show_in_design(self.blended, replace_motion)
            compared = blend_candidates(self.blended, replace_motion, self.questions.chosen_goal)
            self.ranking.offer(self._session.design, compared, "-".join(self.blended.curves), "this blend")
        self.put_button.setEnabled(self.design is not None)

    def _is_accepted(self, part: str) -> bool:
        """Whether the design accepts the blend as this part of its motion."""
        if self.blended is None or not self.replaced[part].isEnabled():
            return False
        try:
            return not faults(REPLACEMENTS[part](self._session.design, self.blended))
        except KindynaError:
            return False

    def refusal(self, request: Request, why: str) -> tuple[str, Remedies]:
        why, remedies = super().refusal(request, why)
        parts = {"turn": "Whole turn", "range": self.replaced["range"].text().capitalize()}
        others = [part for part in parts if part != self._replaced_part and self._is_accepted(part)]
        if "turn" in others:
            why = f"{why.removesuffix('.')}, or replace the whole turn."
        return why, {**remedies, **{parts[part]: partial(self.replaced[part].click) for part in others}}

    def replaces_range(self, blended: BlendResult) -> bool:
        return self._replaced_part == "range"

    def angle_boxes(self) -> tuple[LiveBox, LiveBox]:
        return self.questions.start, self.questions.end

    @property
    def _replaced_part(self) -> str:
        return next(name for name, button in self.replaced.items() if button.isChecked())

    def _show_replaced(self, request: Request) -> None:
        """Name the cam angles; a motion that does not return to its start cannot replace the full turn."""
        self.replaced["range"].setText(f"only {shortest(request.start)}° … {shortest(request.end)}°")
        self.replaced["turn"].setEnabled(_closes(request))
        if not self.replaced["turn"].isEnabled():
            self.replaced["range"].setChecked(True)

    def _as_command(self) -> str:
        return self.command_line(self.questions.request(), self.questions.chosen_goal)


def open_blend(session: Session, parent: QWidget) -> BlendDialog:
    """Open the wizard over a window."""
    dialog = BlendDialog(session, parent)
    dialog.open_once()
    return dialog
