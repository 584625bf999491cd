"""Make > Blend a sequence: any curves of the table in a row, what may be set of them, and the motion, with every keystroke."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from core.blend import (
    ELEMENTS,
    BlendError,
    BlendResult,
    SequenceRequest,
    SettingRange,
    best_of_sequence,
    blend_sequence,
    sequence_ranges,
)
from core.blend.best import with_blend
from core.blend.request import KINDS
from core.blend.sequences import sequence_error
from core.design import UNITS, Design, Unit, faults, require_motion
from core.design.fields import Info
from core.errors import DesignError, KindynaError
from core.find import blend_candidates
from core.requests import command_words
from kindyna_gui.background import Background, Job
from kindyna_gui.blend.kind import curve_icon
from kindyna_gui.blend.questions import GOAL_TEXTS
from kindyna_gui.blend.request import Setting, effect, reason
from kindyna_gui.blend.settings import LiveBox, SettingRow, quiet
from kindyna_gui.blend.wizard import AnswerPanel
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import add_copy_of_line, command_text, session_options
from kindyna_gui.forms.number_box import NameBox, WordBox
from kindyna_gui.forms.request_form import PutDialog
from kindyna_gui.labels import reason as why
from kindyna_gui.look import coloured, text_button
from kindyna_gui.motion.laws_plot import RankingPanel
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import Rebuilt

PAUSE_MS, LATER_MS = 150, 400  # of typing, before it is solved, and before ranges are looked for
WIDTH, USUAL, LEAST = 500, QSize(1180, 740), QSize(1040, 560)
FIRST = ("C1", "C2", "C3", "C4")  # before the user has typed any
SHARES = {"h": 0.3, "span": 0.3}  # of its range, at which a setting begins
ADD = "Add a curve …"


class SequenceDialog(PutDialog):
    """Asks for curves in a row and puts the motion that they make into the design as one step.

    blended   the answer as all is typed; None while there is none
    design    the design with it
    rows      setting -> its row
    """

    help_page = "blending#Any number of curves"

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(session, "Blend a sequence of curves", parent)
        self.blended: BlendResult | None = None
        self.design: Design | None = None
        self.rows: dict[str, SettingRow] = {}
        self._unit = require_motion(session.design).unit
        self._kept: dict[str, float] = {}  # settings that are ticked, also while their curves are typed anew
        self._shown: tuple[str, ...] = ()
        self._unknown: list[Job] = []  # ranges that are to be looked for
        self.answers, self.ranges = Background(self), Background(self)
        self._soon = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._later = QTimer(self, singleShot=True, interval=LATER_MS)
        self.panel, self.ranking = AnswerPanel(self._unit), RankingPanel()
        self._lay_out()
        add_copy_of_line(self.buttons, self._as_command)
        for signal in (self.curves.textEdited, self.start.changed, self.end.changed, self.goal.activated):
            signal.connect(self._typed)
        self.add.activated.connect(self._append)
        self.shorter.clicked.connect(self._shorten)
        self._soon.timeout.connect(self.answer)
        self._later.timeout.connect(self._start_ranges)
        self.answers.result.connect(self._answered)
        self.ranges.result.connect(self._ranged)
        self.panel.show_before(session.study)
        self.curves.setText("-".join(FIRST))
        self.curves.setFocus()
        self.curves.selectAll()
        self.answer()

    # -- building -------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self.curves, self.add, self.goal = NameBox(), WordBox(), WordBox()
        self.shorter = text_button("Take the last away")
        degree = UNITS["deg"]
        self.start = LiveBox(Info("From", "cam angle where the motion starts", 0.0, 360.0), degree)
        self.end = LiveBox(Info("To", "cam angle where the motion ends", 0.0, 360.0), degree)
        self.start.set_number(0.0)
        self.end.set_number(360.0)
        for key, text in GOAL_TEXTS.items():
            self.goal.addItem(text, key)
        self.curves.setAccessibleName("Curves")
        self.add.setAccessibleName("Add a curve")
        self.goal.setAccessibleName("What is left open")
        self.curves.setPlaceholderText("C1-H2-H3-C4-P1-P2")
        form = QGridLayout()
        form.setVerticalSpacing(6)
        form.setColumnStretch(1, 1)
        lines: list[tuple[str, Sequence[QWidget]]] = [
            ("Curves", (self.curves,)),
            ("", (self.add, self.shorter)),
            ("Cam angle", (self.start, quiet("°  to"), self.end, quiet("°"))),
            ("What is left open", (self.goal,)),
        ]
        for i, (label, widgets) in enumerate(lines):
            form.addWidget(QLabel(label), i, 0)
            line = QHBoxLayout()
            for widget in widgets:
                line.addWidget(widget, 1 if widget in (self.curves, self.add, self.goal) else 0)
            if len(widgets) == 4:
                line.addStretch(1)
            form.addLayout(line, i, 1)
        self.count = quiet()
        self.count.setWordWrap(True)
        self._place = Rebuilt()
        area = QScrollArea(widgetResizable=True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setWidget(self._place)
        column = QVBoxLayout()
        column.addLayout(form)
        column.addWidget(self.count)
        column.addWidget(area, 1)
        pages = QTabWidget(documentMode=True)
        pages.addTab(self.panel, "&Motion")
        pages.addTab(self.ranking, "In this &design")
        self.frame(column, WIDTH, pages, USUAL, LEAST)

    def _show_rows(self, request: SequenceRequest) -> None:
        """A row for each setting of these curves; those that were ticked stay so."""
        if request.names == self._shown:
            return
        self._shown, self.rows = request.names, {}
        paper = QWidget()
        paper.setBackgroundRole(QPalette.ColorRole.Base)
        paper.setAutoFillBackground(True)
        grid = QGridLayout(paper)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(2)
        grid.setColumnStretch(4, 1)
        for i, name in enumerate(request.names):
            kind = name.rstrip("0123456789")
            unit = request.unit_of(name).replace("deg", "°").replace("^2", "²")
            setting = Setting(name, name, name, unit, SHARES.get(kind, 0.5), KINDS[kind][1].capitalize())
            row = SettingRow(setting, Unit(setting.per, 1.0))
            row.setParent(paper)
            row.add_to(grid, 2 * i)
            row.show(True, _of(request, name))
            if name in self._kept:
                row.give(self._kept[name])
            row.changed.connect(self._set)
            self.rows[name] = row
        grid.setRowStretch(2 * len(request.names), 1)
        self._place.replace(paper)

    # -- what is typed --------------------------------------------------------------------------------------

    def request(self) -> SequenceRequest:
        """As typed; raises BlendError where curves do not join."""
        curves = tuple(name for name in self.curves.text().upper().replace(" ", "").split("-") if name)
        if broken := sequence_error("-".join(curves)):
            raise BlendError(f"{'-'.join(curves) or 'no curve'}: {broken}")
        given = {name: row.value for name, row in self.rows.items() if row.used and row.value is not None}
        given |= {name: value for name, value in self._kept.items() if name not in self.rows}
        start, end = self.start.number, self.end.number
        if start is None or end is None:
            raise BlendError("a cam angle is no number; allowed: 0 <= start < end <= 360 deg")
        request = SequenceRequest(curves, start, end, {}, self._unit)
        return replace(request, settings={k: v for k, v in given.items() if k in request.names})

    def _typed(self, *_: object) -> None:
        self._soon.start()

    def _set(self) -> None:
        self._kept = {name: row.value for name, row in self.rows.items() if row.used and row.value is not None}
        self._soon.start()

    def _append(self, index: int) -> None:
        name = self.add.itemData(index)
        if name:
            self.curves.setText("-".join((*self._curves, name)))
            self.answer()

    def _shorten(self) -> None:
        self.curves.setText("-".join(self._curves[:-1]))
        self.answer()

    @property
    def _curves(self) -> list[str]:
        return [name for name in self.curves.text().upper().replace(" ", "").split("-") if name]

    def _offer(self) -> None:
        """The curves that may follow the last."""
        self.add.clear()
        self.add.addItem(ADD, "")
        for name in ELEMENTS:
            if not sequence_error("-".join((*self._curves, name))):
                self.add.addItem(curve_icon(name), name, name)

    # -- the answer -----------------------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Whether anything shown is still being computed."""
        return self.answering or self._later.isActive() or self.ranges.busy

    @property
    def answering(self) -> bool:
        """Whether the motion is."""
        return self._soon.isActive() or self.answers.busy

    def answer(self) -> None:
        """Solve what is typed."""
        self._soon.stop()
        self._later.stop()
        self.answers.stop()
        self.ranges.stop()
        self.ranking.stop()
        self.blended = self.design = None
        self.put_button.setEnabled(False)
        self._offer()
        try:
            request = self.request()
            request.validate()
        except BlendError as error:
            self._refuse(error)
            return
        self.curves.set_refused(False)
        self._show_rows(request)
        missing = request.freedom - len(request.settings)
        goal = self.goal.currentData()
        if missing < 0:
            self._count(request, f"{-missing} too many set: untick {'one' if missing == -1 else 'some'}", wrong=True)
        elif missing and not goal:
            self._count(request, f"{missing} more to set, or say what is to be least")
        else:
            self._count(request, "")
            solve = partial(best_of_sequence, request, goal) if missing else partial(blend_sequence, request)
            self.answers.start([(request, solve)])
            self.panel.veil.draw("Looking for it")
        names = [name for name, row in self.rows.items() if row.used or missing > 0]
        names.sort(key=lambda name: not self.rows[name].used)
        for name, row in self.rows.items():
            row.show_ranges(None if name in names else ())
        self._unknown = [(name, partial(sequence_ranges, request, name)) for name in names]
        self._later.start()

    def _start_ranges(self) -> None:
        self.ranges.start(self._unknown)

    def _count(self, request: SequenceRequest, text: str, wrong: bool = False) -> None:
        self.count.setText(f"{request.sequence} requires {request.freedom} settings" + (f": {text}" if text else ""))
        self.show_message("")
        if text:
            self.panel.veil.draw(text)
        coloured(self.count, SCREEN.limit if wrong else SCREEN.quiet)

    def _refuse(self, error: KindynaError) -> None:
        """In one line, the field that it is about marked; the last motion stays, veiled."""
        name = getattr(error, "setting", "")
        self.curves.set_refused(not name and "deg" not in str(error))
        self.show_message(reason(error), wrong=True)
        self.panel.veil.draw("The last motion that was feasible")

    def _answered(self, request: SequenceRequest, result: BlendResult | KindynaError) -> None:
        if not isinstance(result, BlendResult):
            self._refuse(result)
            return
        self.blended = result
        before = self._session.design
        try:
            design = with_blend(before, result)
        except KindynaError as error:
            self.show_message(why(before, error), wrong=True)
            self.panel.show_answer(result, None, self._session.study)
            return
        wrong = why(design, DesignError(faults(design)))
        self.show_message(wrong or effect(require_motion(before), require_motion(design), result), bool(wrong))
        self.panel.show_answer(result, design, self._session.study)
        self.design = None if wrong else design
        place = partial(with_blend, before)
        candidates = blend_candidates(result, place, self.goal.currentData() or "")
        self.ranking.offer(before, candidates, request.sequence, "this blend")
        self.put_button.setEnabled(self.design is not None)

    def _ranged(self, name: str, result: list[SettingRange] | KindynaError) -> None:
        if name in self.rows:
            self.rows[name].show_ranges(result if isinstance(result, list) else ())

    # -- the end --------------------------------------------------------------------------------------------

    def _as_command(self) -> str:
        from core.commands.motions import BlendArguments

        given = {name: row.value for name, row in self.rows.items() if row.used and row.value is not None}
        asked = {
            "sequence": "-".join(self._curves),
            "start": self.start.number,
            "end": self.end.number,
            "set": [f"{name}={value!r}" for name, value in given.items()],
            "best": self.goal.currentData() or None,
            "unit": self._unit,
        }
        return command_text("blend", command_words(BlendArguments, {**asked, **session_options(self._session)}))

    def accept(self) -> None:
        """Put the motion into the design, where there is one."""
        if self.design is not None and self.blended is not None:
            self.put(self.design, f"Blend {'-'.join(self.blended.curves)}")

    def done(self, result: int) -> None:
        self._soon.stop()
        self._later.stop()
        for each in (self.answers, self.ranges):
            each.close()
        self.ranking.close_work()
        super().done(result)


def _of(request: SequenceRequest, name: str) -> str:
    """Which curves a setting is of."""
    if name in request.strokes:
        return " ".join(request.curves[i] for i in request.strokes[name])
    return request.curves[int(name.lstrip("abcdefghijklmnopqrstuvwxyz")) - 1]


def open_sequence(session: Session, parent: QWidget) -> SequenceDialog:
    """Open the dialog over a window; it is deleted once closed."""
    dialog = SequenceDialog(session, parent)
    dialog.open_once()
    return dialog


__all__ = ["SequenceDialog", "open_sequence"]
