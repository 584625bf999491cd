"""Blend wizard."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import QEvent, QObject, QRect, QSize, Qt, QTimer
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QButtonGroup, QFrame, QHBoxLayout, QLabel, QRadioButton, QTabWidget, QVBoxLayout, QWidget

from core.blend import BlendError, BlendResult, best, blend, feasible_ranges
from core.blend.best import with_blend_as_motion, with_blend_between
from core.design import UNITS, Design, faults, require_motion
from core.errors import DesignError, KindynaError
from core.find import blend_candidates
from core.laws import LAWS
from core.output.channels import channels
from core.output.lines import shortest
from core.requests import command_words
from core.study import Study
from kindyna_gui.background import Background, Job
from kindyna_gui.blend.questions import Questions, SuccessionPage
from kindyna_gui.blend.request import (
    HEADINGS,
    WizardRequest,
    effect,
    figures,
    first_request,
    has_both,
    plan,
    ranged,
    table,
    words_of,
)
from kindyna_gui.blend.settings import PrecisionPointRow, RangedRow, quiet
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import add_copy_of_line, command_text, session_options
from kindyna_gui.forms.request_form import PutDialog
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import law_label, reason
from kindyna_gui.look import bold_label
from kindyna_gui.motion.laws_plot import RankingPanel
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.style import SCREEN, TEXT, font
from kindyna_gui.settings import symbol_of

# -- answer ----------------------------------------------------------------------------------------------

QUANTITIES = ("displacement", "velocity", "acceleration")
SAMPLES = 720
"""Cam angles of the curves, which change with every keystroke."""
VEIL = 0.72  # of the paper over what no longer holds


class FadedCover(QWidget):
    """Paper over a widget, thin enough to read what is under it, with a text on it."""

    def __init__(self, over: QWidget) -> None:
        super().__init__(over)
        self._text, self._covered = "", over
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        over.installEventFilter(self)
        self.hide()

    @property
    def text(self) -> str:
        return self._text

    def draw(self, text: str) -> None:
        """Cover the widget with this text; an empty text uncovers it."""
        self._text = text
        self.setGeometry(self._covered.rect())
        self.setVisible(bool(text))
        self.raise_()
        self.update()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Resize:
            self.setGeometry(self._covered.rect())
        return super().eventFilter(watched, event)

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        paper = QColor(SCREEN.paper)
        paper.setAlphaF(VEIL)
        painter.fillRect(self.rect(), paper)
        painter.setFont(font(TEXT))
        width, height = text_size(self._text, TEXT)
        box = QRect(0, 0, round(width) + 24, round(height) + 12)
        box.moveCenter(self.rect().center())
        painter.fillRect(box, QColor(SCREEN.paper))
        painter.setPen(QColor(SCREEN.quiet))
        painter.drawRect(box)
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self._text)
        painter.end()


class AnswerPanel(QFrame):
    """The sequence, its figures, its table, and the curves over the whole turn with those of the design dashed."""

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
        # what names its unit is long: it takes the room it needs, the angles share the rest
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
        self.veil = FadedCover(self)
        self._keep_height()

    def show_answer(self, blended: BlendResult, design: Design | None, before: Study) -> None:
        """The curves, and the motion of a design that has them, over that of the design before; None: that has no
        place for them."""
        self.headline.setText("–".join(blended.curves))
        self.figures.setText("\n".join(figures(blended, before.design.speed_rpm)))
        rows = table(blended)
        self.table.show_rows([TableRow(cells) for cells in rows])
        self._keep_height()
        if design is None:
            for plot in self.plots:
                plot.show_message("")
            self.plots[0].show_message("These curves have no place in the motion as it is")
        else:
            self._draw(design, before)
        self.veil.draw("")

    def show_before(self, before: Study) -> None:
        """Show the motion of the design in place, before there is an answer."""
        self.headline.setText("No motion yet")
        self.figures.setText("The design's motion as it is")
        self._draw(before.design, None)

    def _draw(self, design: Design, before: Study | None) -> None:
        study = Study(design, SAMPLES)
        rows = {row.name: row for row in channels(design)}
        for quantity, plot in zip(QUANTITIES, self.plots, strict=True):
            plot.set_curves(study, [rows[quantity]], before)

    def _keep_height(self) -> None:
        """As many rows as there are, none of them scrolled."""
        rows = sum(self.table.rowHeight(i) for i in range(len(self.table.rows.rows)))
        self.table.setFixedHeight(self.table.horizontalHeader().sizeHint().height() + rows + 2)


# -- wizard ----------------------------------------------------------------------------------------------

PAUSE_MS = 250  # of typing, before the best is searched for
SLOW_MS = 150  # after which a range that is still being computed is no longer shown as it was
LAST = "The last motion that was feasible"
QUESTIONS_WIDTH, USUAL, LEAST = 500, QSize(1180, 740), QSize(1040, 560)
PLACES: Mapping[str, Callable[[Design, BlendResult], Design]] = MappingProxyType(
    {"turn": with_blend_as_motion, "here": with_blend_between}
)


class BlendDialog(PutDialog):
    """Asks for a blended motion and puts it into the design as one step.

    Every keystroke is answered at once; while there is no answer the last one stays, veiled.

    blended   the answer to the questions as they are; None while there is none
    design    the design with it; None where it cannot be put in place
    """

    help_page = "blending#What you may set"

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(session, "Blend a motion", parent)
        motion = require_motion(session.design)
        self.blended: BlendResult | None = None  # the answer to the questions as they are
        self.design: Design | None = None  # with it
        self.questions = Questions(motion.unit)
        self.panel = AnswerPanel(motion.unit)
        self.succession = SuccessionPage()
        self.ranking = RankingPanel()
        self.answers, self.ranges = Background(self), Background(self)
        self._soon = QTimer(self, singleShot=True, interval=0)
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._slow = QTimer(self, singleShot=True, interval=SLOW_MS)
        self._waiting: list[RangedRow] = []  # for their ranges
        self._requested_rows: tuple[RangedRow, ...] = ()
        self._lay_out()
        add_copy_of_line(self.buttons, self._as_command)
        self._connect()
        request = first_request(motion, min(session.segment, len(motion.segments) - 1))
        self.questions.answer(request)
        others = [s for s in motion.segments if s.rise]
        moving = sum(s.rise for s in others if s.rise > 0.0)
        alone = not others or (has_both(request.type) and moving <= request.stroke + 1e-9)
        self.places["turn" if alone else "here"].setChecked(True)
        self.panel.show_before(session.study)
        self.questions.kind.types[request.type].setFocus()
        self.answer_request()

    # -- building -------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        questions = QVBoxLayout()
        questions.addWidget(self.questions, 1)
        questions.addLayout(self._places())
        self.pages = QTabWidget(documentMode=True)
        self.pages.addTab(self.panel, "&Motion")
        self.pages.addTab(self.succession, "Which curve &follows")
        self.pages.addTab(self.ranking, "In this &design")
        self.frame(questions, QUESTIONS_WIDTH, self.pages, USUAL, LEAST)

    def _places(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.addWidget(bold_label("Place"))
        row.addSpacing(8)
        self.places = {"turn": QRadioButton("the whole turn"), "here": QRadioButton()}
        self.places["turn"].setToolTip("Dwell, these curves, dwell: nothing else is left of the motion")
        self.places["here"].setToolTip("What the motion does between these cam angles makes way, the rest stays")
        group = QButtonGroup(self)
        for button in self.places.values():
            group.addButton(button)
            row.addWidget(button)
            button.clicked.connect(self._place)
        row.addStretch(1)
        return row

    def _connect(self) -> None:
        self.questions.changed.connect(self._soon.start)
        self._soon.timeout.connect(self.answer_request)
        self._pause.timeout.connect(self._start_best)
        self._slow.timeout.connect(self._is_slow)
        self.answers.result.connect(self._answered)
        self.ranges.result.connect(self._ranged)
        self.ranking.chosen.connect(self._choose_ranked)

    def _choose_ranked(self, name: str) -> None:
        """A row of the ranking: another sequence is blended at once."""
        if name in LAWS:
            self.show_message(f"{law_label(name)} is a law, no blend: the table of laws puts it into the motion")
        elif name != "-".join(self.blended.curves if self.blended is not None else ()):
            self.questions.take_sequence(name)

    # -- requests -------------------------------------------------------------------------------------------

    def answer_request(self) -> None:
        """Begin to compute the answer to the questions as they are."""
        questions = self.questions
        self.stop()
        questions.show_request()
        request = questions.request()
        self._name_places(request)
        self.blended = self.design = None
        self.ranking.stop()
        self.put_button.setEnabled(False)
        target, missing = plan(request).target, plan(request).missing
        if target is not None:
            self.succession.show_sequence(request.type, target.sequence)
        if questions.find_faults():
            self._veil(LAST)
            return
        self._waiting = questions.settings.shown_rows()
        self._slow.start()
        if request.goal and not missing:
            self._pause.start()  # the ranges wait for it
            return
        self._start_ranges(request)
        if missing:
            self._veil(f"{missing} more to set" if missing > 0 else f"{-missing} too many set")
        else:
            self.answers.start([(request, partial(blend, request.solver_request))])

    @property
    def busy(self) -> bool:
        """Whether anything shown is still being computed."""
        return self.answering or self.ranges.busy

    @property
    def answering(self) -> bool:
        """Whether the motion is; ranges follow."""
        return self._soon.isActive() or self._pause.isActive() or self.answers.busy

    def stop(self) -> None:
        """Cancel what is being computed."""
        for timer in (self._soon, self._pause, self._slow):
            timer.stop()
        for each in (self.answers, self.ranges):
            each.stop()

    def _start_best(self) -> None:
        request = self.questions.request()
        self._veil(f"Looking for the least {request.goal}")
        self.answers.start([(request, partial(best, request.solver_request, request.goal))])

    def _start_ranges(self, request: WizardRequest) -> None:
        """Ranges of the focused field first; then, while a setting is missing, those of rows not ticked yet."""
        rows, solver_request = list(self._waiting), ranged(request)
        wanted = plan(request).missing == 0
        focused = self.focusWidget()
        rows = sorted(rows, key=lambda row: (focused not in row.boxes(), row.used != wanted))
        jobs: list[Job] = []
        for row in rows:
            at = (row.at.number or 0.0,) if isinstance(row, PrecisionPointRow) else ()
            jobs.append((self._waiting.index(row), partial(feasible_ranges, solver_request, row.name, *at)))
        self._requested_rows = tuple(self._waiting)
        self.ranges.start(jobs)

    # -- answers --------------------------------------------------------------------------------------------

    def _ranged(self, number: int, result: object) -> None:
        row = self._requested_rows[number]
        self._waiting.remove(row)
        if self.questions.settings.has(row):
            row.show_ranges(result if isinstance(result, list) else ())

    def _is_slow(self) -> None:
        """The ranges and the answer shown hold no longer, and the new ones are not computed yet."""
        for row in filter(self.questions.settings.has, self._waiting):
            row.show_ranges(None)
        if self.answers.busy:
            self._veil("Looking for it")

    def _answered(self, request: WizardRequest, result: BlendResult | KindynaError) -> None:
        if request.goal:
            self._start_ranges(request)
        if isinstance(result, BlendResult):
            self.blended = result
            self._place()
            return
        self._veil(LAST)
        if isinstance(result, BlendError):
            self.questions.show_error(result)
        else:
            self.questions.general.show_message(reason(self._session.design, result))

    def _veil(self, text: str) -> None:
        self.show_message("")
        self.panel.veil.draw(text)

    def _place(self, *_: object) -> None:
        """Put the answer into a design that is not in place yet, and show it."""
        self.design = None
        if self.blended is not None:
            try:
                design = PLACES[self._where](self._session.design, self.blended)
            except KindynaError as error:
                self.show_message(reason(self._session.design, error), wrong=True)
                self.panel.show_answer(self.blended, None, self._session.study)
            else:
                self._show(design, self.blended)
            own, place = "-".join(self.blended.curves), partial(PLACES[self._where], self._session.design)
            goal = self.questions.request().goal
            self.ranking.offer(self._session.design, blend_candidates(self.blended, place, goal), own, "this blend")
        self.put_button.setEnabled(self.design is not None)

    def _show(self, design: Design, blended: BlendResult) -> None:
        before = require_motion(self._session.design)
        wrong = reason(design, DesignError(faults(design)))
        self.show_message(wrong or effect(before, require_motion(design), blended), bool(wrong))
        self.panel.show_answer(blended, design, self._session.study)
        self.design = None if wrong else design

    @property
    def _where(self) -> str:
        return next(name for name, button in self.places.items() if button.isChecked())

    def _name_places(self, request: WizardRequest) -> None:
        """A rise or a return alone is no whole turn."""
        self.places["here"].setText(f"{shortest(request.start)}° … {shortest(request.end)}° only, the rest stays")
        self.places["turn"].setEnabled(has_both(request.type) and request.return_stroke in (0.0, request.stroke))
        if not self.places["turn"].isEnabled():
            self.places["here"].setChecked(True)

    # -- the end --------------------------------------------------------------------------------------------

    def _as_command(self) -> str:
        from core.commands.motions import BlendArguments

        return command_text(
            "blend",
            command_words(BlendArguments, {**words_of(self.questions.request()), **session_options(self._session)}),
        )

    def accept(self) -> None:
        """Put the motion into the design, where there is one."""
        if self.design is not None and self.blended is not None:
            self.put(self.design, f"Blend {'-'.join(self.blended.curves)}")

    def done(self, result: int) -> None:
        self.stop()
        for each in (self.answers, self.ranges):
            each.close()
        self.ranking.close_work()
        super().done(result)


def open_blend(session: Session, parent: QWidget) -> BlendDialog:
    """Open the wizard over a window; it is deleted once closed."""
    dialog = BlendDialog(session, parent)
    dialog.open_once()
    return dialog
