"""Make > Blend a sequence: any number of curves, each with its own settings; the motion follows every keystroke."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QScrollArea, QTabWidget, QVBoxLayout, QWidget

from core.blend import (
    ELEMENTS,
    KINDS,
    BlendError,
    BlendResult,
    Request,
    SettingRange,
    best,
    blend,
    feasible_ranges,
)
from core.blend.best import with_blend
from core.blend.sequences import sequence_error
from core.design import UNITS, Unit, require_motion
from core.design.fields import Info
from core.design.rules import CLOSING
from core.errors import KindynaError
from core.find import blend_candidates
from core.requests import command_words
from kindyna_gui.background import Job
from kindyna_gui.blend.kind import curve_icon
from kindyna_gui.blend.questions import GOAL_TEXTS
from kindyna_gui.blend.request import Setting, reason
from kindyna_gui.blend.settings import SettingRow, quiet
from kindyna_gui.blend.wizard import FORM_WIDTH, LAST, LEAST_SIZE, SEARCHING, TYPICAL_SIZE, BlendPutDialog, place_of
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import add_copy_of_line, command_text, session_options
from kindyna_gui.forms.number_box import LiveBox, NameBox, WordBox
from kindyna_gui.forms.refusal import NO_REMEDIES, Remedies, refuse_number
from kindyna_gui.labels import no_number
from kindyna_gui.look import coloured, text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import ContentArea

PAUSE_MS, RANGES_MS = 150, 400  # after a keystroke, before the motion and the ranges are computed
FIRST_CURVES = ("C1", "C2", "C3", "C4")  # before the user has typed any
SHARES = {"h": 0.3, "span": 0.3}  # initial value of a setting as a share of its range
LABELS = {
    "h": "Height",
    "span": "Span",
    "v": "Speed",
    "a": "Acceleration",
    "end": "End",
    "rise": "Rise",
    "return": "Return",
}
"""Kind of a setting -> its name in the form."""
ADD = "Add a curve …"


class SequenceDialog(BlendPutDialog):
    """Dialog that blends any sequence of curves; ``rows`` has the row of each setting."""

    help_page = "blending#Any number of curves"

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(session, "Blend a sequence of curves", parent)
        self.rows: dict[str, SettingRow] = {}
        self._unit = require_motion(session.design).unit
        self._ticked: dict[str, float] = {}  # ticked settings, also while the curves are typed again
        self._shown: tuple[str, ...] = ()
        self._last: tuple[str, ...] = ()  # curves that join
        self._range_jobs: list[Job] = []
        self._soon = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._later = QTimer(self, singleShot=True, interval=RANGES_MS)
        self.timers = self._soon, self._later
        self._lay_out()
        self.copy = add_copy_of_line(self.buttons, self._as_command)
        for signal in (self.curves.textEdited, self.start.changed, self.end.changed, self.goal.activated):
            signal.connect(self._solve_soon)
        self.add.activated.connect(self._append)
        self.shorter.clicked.connect(self._remove_last)
        self._soon.timeout.connect(self.solve)
        self._later.timeout.connect(self._start_ranges)
        self.solver.result.connect(self._show_result)
        self.ranges.result.connect(self._show_range)
        self.panel.show_current(session.study)
        self.curves.setText("-".join(FIRST_CURVES))
        self.curves.setFocus()
        self.curves.selectAll()
        self.solve()

    # -- layout ------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self.curves, self.add, self.goal = NameBox(), WordBox(), WordBox()
        self.shorter = text_button("Remove the last")
        degree = UNITS["deg"]
        self.start = LiveBox(Info("From", "cam angle where the motion starts", 0.0, 360.0), degree)
        self.end = LiveBox(Info("To", "cam angle where the motion ends", 0.0, 360.0), degree)
        self.start.in_file_units = self.end.in_file_units = True  # as the texts about cam angles
        for box, angle in zip((self.start, self.end), place_of(self._session), strict=True):
            box.set_number(angle)
        for key, text in GOAL_TEXTS.items():
            self.goal.addItem(text, key)
        self.curves.setAccessibleName("Curves")
        self.add.setAccessibleName("Add a curve")
        self.goal.setAccessibleName("Optimise")
        self.curves.setPlaceholderText("C1-H2-H3-C4-P1-P2")
        form = QGridLayout()
        form.setVerticalSpacing(6)
        form.setColumnStretch(1, 1)
        lines: list[tuple[str, Sequence[QWidget]]] = [
            ("Curves", (self.curves,)),
            ("", (self.add, self.shorter)),
            ("Cam angle", (self.start, quiet("°  to"), self.end, quiet("°"))),
            ("Optimise", (self.goal,)),
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
        self._settings_area = ContentArea()
        area = QScrollArea(widgetResizable=True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setWidget(self._settings_area)
        column = QVBoxLayout()
        column.addLayout(form)
        column.addWidget(self.count)
        column.addWidget(area, 1)
        pages = QTabWidget(documentMode=True)
        pages.addTab(self.panel, "&Motion")
        pages.addTab(self.ranking, "In this &design")
        self.frame(column, FORM_WIDTH, pages, TYPICAL_SIZE, LEAST_SIZE)

    def _show_rows(self, request: Request) -> None:
        """Show a row for each setting of these curves; ticked settings stay ticked."""
        if request.chain.names == self._shown:
            return
        self._shown, self.rows = request.chain.names, {}
        paper = QWidget()
        paper.setBackgroundRole(QPalette.ColorRole.Base)
        paper.setAutoFillBackground(True)
        grid = QGridLayout(paper)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(2)
        grid.setColumnStretch(4, 1)
        for i, name in enumerate(request.chain.names):
            kind = name.rstrip("0123456789")
            unit = request.unit_of(name).replace("deg", "°").replace("^2", "²")
            label = f"{LABELS[kind]} ({name})"
            setting = Setting(name, label, name, unit, SHARES.get(kind, 0.5), KINDS[kind].meaning.capitalize())
            row = SettingRow(setting, Unit(unit, 1.0))
            row.setParent(paper)
            row.add_to(grid, 2 * i)
            indices = request.chain.indices_of(name)
            row.show(True, " ".join(request.chain.curves[i] for i in (indices[-1:] if kind == "end" else indices)))
            if name in self._ticked:
                row.give(self._ticked[name])
            row.changed.connect(self._setting_changed)
            self.rows[name] = row
        grid.setRowStretch(2 * len(request.chain.names), 1)
        self._settings_area.replace(paper)

    # -- request -----------------------------------------------------------------------------------------

    def request(self) -> Request:
        """Return the request as typed; raises BlendError if the curves do not join or an angle is not a number."""
        curves = self._curves
        if fault := sequence_error("-".join(curves)):
            raise BlendError(f"{'-'.join(curves) or 'no curve'}: {fault}")
        given = {**self._given, **{name: value for name, value in self._ticked.items() if name not in self.rows}}
        start, end = self.start.number, self.end.number
        if start is None or end is None:
            raise BlendError("a cam angle is not a number; allowed: 0 <= start < end <= 360 deg")
        request = Request("", 0.0, start, end, sequence="-".join(curves), unit=self._unit)
        return replace(request, settings={k: v for k, v in given.items() if k in request.names})

    @property
    def _given(self) -> dict[str, float]:
        """Ticked settings whose text is a number."""
        return {name: row.value for name, row in self.rows.items() if row.is_used and row.value is not None}

    def _solve_soon(self, *_: object) -> None:
        self._soon.start()

    def _setting_changed(self) -> None:
        self._ticked = self._given
        self._soon.start()

    def _append(self, index: int) -> None:
        name = self.add.itemData(index)
        if name:
            self.curves.setText("-".join((*self._curves, name)))
            self.solve()

    def _remove_last(self) -> None:
        self.curves.setText("-".join(self._curves[:-1]))
        self.solve()

    @property
    def _curves(self) -> list[str]:
        return [name for name in self.curves.text().upper().replace(" ", "").split("-") if name]

    def _list_followers(self) -> None:
        """List the curves that may follow the last."""
        self.add.clear()
        self.add.addItem(ADD, "")
        for name in ELEMENTS:
            if not sequence_error("-".join((*self._curves, name))):
                self.add.addItem(curve_icon(name), name, name)

    # -- calculation -------------------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Whether anything shown is still being computed."""
        return self.is_solving or self._later.isActive() or self.ranges.busy

    @property
    def is_solving(self) -> bool:
        """Whether the motion is still being computed; the ranges follow later."""
        return self._soon.isActive() or self.solver.busy

    def solve(self) -> None:
        """Begin to compute the motion that follows from the form."""
        self.stop()
        self.ranking.stop()
        self.blended = self.design = None
        self.put_button.setEnabled(False)
        self._list_followers()
        for part in (self.curves, self.start, self.end):
            part.set_refused(False)
        for row in self.rows.values():
            row.show_fault(no_number(row.box.text()) if row.is_used and row.value is None else "")
        try:
            request = self.request()
            request.validate()
        except BlendError as error:
            self._show_error(error)
            return
        self._last = tuple(self._curves)
        self._show_rows(request)
        if any(row.box.is_refused for row in self.rows.values()):
            self.copy.setEnabled(False)
            self.show_message("")
            self.panel.cover.show_text(LAST)
            return
        self.copy.setEnabled(True)
        missing = request.chain.freedom - len(request.given)
        goal = self.goal.currentData()
        if missing < 0:
            self._show_count(
                request, f"{-missing} too many set: untick {'one' if missing == -1 else 'some'}", wrong=True
            )
        elif missing and not goal:
            self._show_count(request, f"{missing} more to set, or select what to optimise")
        else:
            self._show_count(request, "")
            solve = partial(best, request, goal) if missing else partial(blend, request)
            self.solver.start([(request, solve)])
            self.panel.cover.show_text(SEARCHING)
        names = [name for name, row in self.rows.items() if row.is_used or missing > 0]
        names.sort(key=lambda name: not self.rows[name].is_used)
        for name, row in self.rows.items():
            row.show_ranges(None if name in names else ())
        self._range_jobs = [(name, partial(feasible_ranges, request, name)) for name in names]
        self._later.start()

    def _start_ranges(self) -> None:
        self.ranges.start(self._range_jobs)

    def _show_count(self, request: Request, text: str, wrong: bool = False) -> None:
        self.count.setText(f"{request.chain} requires {request.chain.freedom} settings" + (f": {text}" if text else ""))
        self.show_message("")
        if text:
            self.panel.cover.show_text(text)
        coloured(self.count, SCREEN.limit if wrong else SCREEN.quiet)

    def _show_error(self, error: KindynaError) -> None:
        """Show the error and mark its field; the last motion stays visible under a cover."""
        name = getattr(error, "setting", "")
        self.copy.setEnabled(False)
        self.curves.set_refused(not name and "deg" not in str(error))
        if name in self.rows:
            self.rows[name].show_fault(reason(error))
            self.show_message("")
        elif wrong := next((box for box in (self.start, self.end) if box.fault()), None):
            refuse_number(self.message, wrong, name=wrong.info.label)
        else:
            self.show_message(reason(error), wrong=True, remedies=self._back_remedies())
        self.panel.cover.show_text(LAST)

    def _back_remedies(self) -> Remedies:
        """Remedy of curves that do not join: those of the last motion."""
        last = "-".join(self._last)
        return {f"Back to {last}": self._go_back} if last and self._last != tuple(self._curves) else NO_REMEDIES

    def _go_back(self) -> None:
        self.curves.setText("-".join(self._last))
        self.solve()

    def _show_result(self, request: Request, result: BlendResult | KindynaError) -> None:
        if not isinstance(result, BlendResult):
            self._show_error(result)
            return
        self.blended = result
        for row in self.rows.values():
            row.note_feasible()
        current = self._session.design
        replace_motion = partial(with_blend, current)
        if self.show_in_design(result, replace_motion):
            candidates = blend_candidates(result, replace_motion, self.goal.currentData() or "")
            self.ranking.offer(current, candidates, request.sequence, "this blend")
        self.put_button.setEnabled(self.design is not None)

    def _show_range(self, name: str, result: list[SettingRange] | KindynaError) -> None:
        if name in self.rows:
            self.rows[name].show_ranges(result if isinstance(result, list) else ())

    def replaces_range(self, blended: BlendResult) -> bool:
        return abs(blended.gain - require_motion(self._session.design).gain) > CLOSING

    def angle_boxes(self) -> tuple[LiveBox, LiveBox]:
        return self.start, self.end

    def _as_command(self) -> str:
        from core.commands.motions import BlendArguments

        options = {
            "sequence": "-".join(self._curves),
            "start": self.start.number,
            "end": self.end.number,
            "set": [f"{name}={value!r}" for name, value in self._given.items()],
            "best": self.goal.currentData() or None,
            "unit": self._unit,
        }
        return command_text("blend", command_words(BlendArguments, {**options, **session_options(self._session)}))


def open_sequence(session: Session, parent: QWidget) -> SequenceDialog:
    """Open the dialog over a window."""
    dialog = SequenceDialog(session, parent)
    dialog.open_once()
    return dialog


__all__ = ["SequenceDialog", "open_sequence"]
