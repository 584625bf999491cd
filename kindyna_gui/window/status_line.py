"""The status line: messages, number of findings, saved or not, assumed values, values that wait, and the current angle."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from functools import partial
from math import pi

from PySide6.QtCore import Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QMenu, QStatusBar, QToolButton

from core.design import row_at
from core.errors import KindynaError
from core.findings import ERROR, NOTE, WARNING, Finding
from core.project.reading_faults import reason as why
from core.study import Study, findings_of
from kindyna_gui.background import Background, PendingResult, attempt
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import misfit_sentences, waiting_text
from kindyna_gui.labels import named_value, reason, sentence
from kindyna_gui.look import coloured, sign, text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import number
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import add_entry, call_soon, clear_menu, connect_all, single_shot
from kindyna_gui.requirements import suggestions_for
from kindyna_gui.view import AFTER_DRAG_MS

PAUSE_MS = 150  # after a change, before the findings are counted
STAY_MS = 6000  # how long a message is shown
NOT_CHECKED = "limits not checked"
MARGIN = 12  # around a message [pixels]


class StatusLine(QStatusBar):
    """Shows the state of session and player; findings are counted only for the stages that views on screen compute."""

    def __init__(
        self,
        session: Session,
        player: Player,
        show_findings: Callable[[], object],
        show_log: Callable[[], object],
        focus_field: Callable[[str], object],
        do: Callable[[str], object],
    ) -> None:
        super().__init__()
        self._session, self._player = session, player
        self._refusal = self._question = self._entry = ""
        self.findings = QToolButton(autoRaise=True, toolButtonStyle=Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.findings.clicked.connect(lambda: show_findings())
        self.faults = text_button("Log", flat=True)
        self.faults.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.faults.setIcon(sign(ERROR))
        self.faults.clicked.connect(lambda: show_log())
        self.faults.hide()
        self.suggestion = text_button("", flat=True)
        self.suggestion.clicked.connect(lambda: do(self._entry))
        self.suggestion.hide()
        self.misfit = QToolButton(autoRaise=True, toolButtonStyle=Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.misfit.setIcon(sign(ERROR))
        self.misfit.clicked.connect(lambda: focus_field(session.misfit.reasons[0][0]))
        self.misfit.hide()
        self.saved, self.assumed, self.angle = QLabel(), QToolButton(autoRaise=True), QLabel()
        self.pending = QToolButton(autoRaise=True)
        self.pending.clicked.connect(self._stop_or_restart)
        self.pending.hide()
        self.angle.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.update_style()
        self.angle.setToolTip("Angle of all views")
        self.assumed.setToolTip("Assumed values: click to list them")
        self.assumed.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.assumed.setStyleSheet("QToolButton::menu-indicator { image: none; }")
        self._focus_field = focus_field
        self._drive_menus: dict[str, QMenu] = {}
        self._assumed_rows = QMenu(self.assumed, toolTipsVisible=True)
        self._assumed_rows.aboutToShow.connect(self._list_assumed)
        self.assumed.setMenu(self._assumed_rows)
        coloured(self.saved, SCREEN.quiet)
        self.saved.setContentsMargins(6, 0, 6, 0)
        for widget in (
            self.suggestion,
            self.pending,
            self.faults,
            self.misfit,
            self.findings,
            self.saved,
            self.assumed,
            self.angle,
        ):
            self.addPermanentWidget(widget)
        self._long = QLabel(self, wordWrap=True, margin=3)
        self._long.setFrameShape(QLabel.Shape.StyledPanel)
        self._long.setAutoFillBackground(True)
        self._long.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._soon = single_shot(self, self._begin_count)
        self._search = Background(self)
        self._search.result.connect(self._show_count)
        self._is_counted = True
        self._document = -1  # number of the document whose findings are shown
        self._checked: tuple[Study | None, tuple[str, ...]] = (None, ())  # a design, and its stages that were checked
        connect_all(
            (self.messageChanged, self._ask_again),
            (self.messageChanged, self._offer),
            (self.messageChanged, self._show_long),
            (session.pending.changed, self._show_pending),
            (session.laws.changed, self._show_pending),
            (session.corrected, self._edit_corrected),
            (session.restored, self._edit_corrected),
            (session.incomplete_changed, self._misfits_changed),
            (session.restored, self._misfits_changed),  # names of values depend on the drive
            (session.full_design_changed, self._design_changed),
            (session.drag_ended, self._drag_ended),
            (session.file_changed, self._file_changed),
            (player.angle_changed, self._angle_changed),
        )
        self._design_changed()
        self._file_changed()
        self._angle_changed(player.theta)

    def update_style(self) -> None:
        """Fix the size of the angle to the font: else each new angle would lay out the line again."""
        metrics = self.fontMetrics()
        self.angle.setFixedSize(metrics.horizontalAdvance("driver angle 359.9°  "), metrics.height())

    def show_message(self, text: str) -> None:
        """Show a message for a while."""
        self.showMessage(text, STAY_MS)

    def ask(self, text: str) -> None:
        """Show what to do next, until ``answered``; messages interrupt it."""
        self._question = text
        self.showMessage(text)

    def answered(self, how: str) -> None:
        """End the request that ``ask`` shows, and show the result, if any, as a message."""
        question, self._question = self._question, ""
        if self.currentMessage() == question:
            self.clearMessage()
        if how:
            self.show_message(how)

    def _ask_again(self, text: str) -> None:
        if not text and self._question:
            call_soon(self, self._show_question)

    def _offer(self, text: str) -> None:
        """Show the remedy of a message, if any, as a button next to it."""
        remedy = next(iter(suggestions_for(text)), None)
        self._entry = "" if remedy is None else remedy.entry
        self.suggestion.setText("" if remedy is None else remedy.text)
        self.suggestion.setVisible(remedy is not None)

    def _show_long(self, text: str) -> None:
        """Show a message too long for the line in a label that grows upwards over the window."""
        window = self.window()
        buttons = (self.suggestion, self.pending, self.faults, self.findings)
        room = min((button.x() for button in buttons if button.isVisible()), default=self.width()) - 4
        self._long.setVisible(self.isVisible() and self.fontMetrics().horizontalAdvance(text) > room - MARGIN)
        if not self._long.isHidden():
            self._long.setParent(window)
            self._long.setText(text)
            height = max(self._long.heightForWidth(room), self.height())
            corner = self.mapTo(window, self.rect().bottomLeft())
            self._long.setGeometry(corner.x(), corner.y() + 1 - height, room, height)
            self._long.show()
            self._long.raise_()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._show_long(self.currentMessage())

    def _show_question(self) -> None:
        if self._question and not self.currentMessage():
            self.showMessage(self._question)

    def refuse(self, text: str) -> None:
        """Show that an edit was refused, for a while or until the value is corrected or undone."""
        self._refusal = f"Refused: {sentence(text)}"
        self.show_message(self._refusal)

    def show_fault(self, text: str) -> None:
        """Show that the program has failed, until the next message; the button to the log stays."""
        self.faults.setToolTip(f"{text} Click to read the log.")
        self.faults.show()
        self.showMessage(text)

    def _show_pending(self) -> None:
        """Show the button that stops a long calculation, or starts it again."""
        pending = self._pending_result
        self.pending.setText("Calculate again" if pending.is_cancelled else f"Stop calculating {pending.what}")
        self.pending.setToolTip(pending.tip)
        self.pending.setVisible(pending.busy or pending.is_cancelled)

    @property
    def _pending_result(self) -> PendingResult:
        """The result that is not known; that of the laws first, from which all others follow."""
        laws = self._session.laws
        return laws if laws.busy or laws.is_cancelled else self._session.pending

    def _stop_or_restart(self) -> None:
        pending = self._pending_result
        if pending.is_cancelled:
            pending.again()
        else:
            pending.cancel()

    def _edit_corrected(self, *_: object) -> None:
        if self._refusal and self.currentMessage() == self._refusal:
            self.clearMessage()

    def recount(self) -> None:
        """Count the findings after a pause, once the mouse drags nothing."""
        self._is_counted = False
        self._search.stop()
        self._soon.start(PAUSE_MS)

    def _drag_ended(self) -> None:
        if not self._is_counted:
            self._soon.start(AFTER_DRAG_MS)

    def _begin_count(self) -> None:
        """Search the findings of the stages on screen in the background, unless the mouse drags something."""
        if self._session.drag_source is not None:
            return
        study, stages = self._session.full_study, self._checked_stages()
        if stages:
            self._search.start([(study, partial(attempt, partial(findings_of, study, stages)))])
        else:
            self.count_findings()

    def _checked_stages(self) -> tuple[str, ...]:
        """Stages on screen and, of the same design, those that were on screen before: their findings are known."""
        study, on_screen = self._session.full_study, self._session.stages_on_screen()
        if not on_screen or not self._session.has_laws:
            return ()
        before = self._checked[1] if self._checked[0] is study else ()
        self._checked = study, tuple(dict.fromkeys((*before, *on_screen)))
        return self._checked[1]

    def _show_count(self, study: Study, _: object) -> None:
        if study is self._session.full_study:
            self.count_findings()

    def leave(self) -> None:
        """Stop the search, because the window closes."""
        self._soon.stop()
        self._search.close()

    def count_findings(self) -> None:
        """Show how many limits are exceeded."""
        self._soon.stop()
        self._search.stop()
        self._is_counted = True
        stages = self._checked_stages()
        try:
            findings = findings_of(self._session.full_study, stages) if stages else ()
            text, severity = counted(findings) if stages else (NOT_CHECKED, NOTE)
            checked = f"Checked: {', '.join(stages)}" if stages else "No view is open, so no limit has been checked"
            tip = f"{checked}. Click to show all findings."
        except KindynaError as error:
            text, severity, tip = "cannot be calculated", ERROR, reason(self._session.design, error)
        self.findings.setText(text)
        self.findings.setIcon(sign(severity))
        self.findings.setToolTip(tip)
        call_soon(self, lambda: self._show_long(self.currentMessage()))  # the buttons next to it may have become wider

    def _design_changed(self) -> None:
        if self._session.document != self._document:  # the findings of another file are no findings of this one
            self._document = self._session.document
            self.findings.setText(NOT_CHECKED)
            self.findings.setIcon(sign(NOTE))
            self.findings.setToolTip("Click to show all findings.")
        number = len(self._session.full_design.assumed)
        self.assumed.setText(f"{number} assumed")
        self.assumed.setVisible(number > 0)
        self.recount()
        self._angle_changed(self._player.theta)

    def _misfits_changed(self) -> None:
        """Show the typed values that do not fit the others."""
        rows = [] if self._session.waits_for.reasons else misfit_sentences(self._session)
        self.misfit.setText(waiting_text(self._session))
        self.misfit.setToolTip("\n".join((*rows, "Click to show the field.")))
        self.misfit.setVisible(bool(rows))

    def _list_assumed(self) -> None:
        """Add an entry for each assumed value, which shows its field; values of a drive are in its submenu."""
        design, menus = self._session.full_design, {"": self._assumed_rows}
        self._drive_menus = menus  # else Python would delete them
        clear_menu(self._assumed_rows)
        for path in design.assumed:
            _, number, inside = row_at(path, "drives")
            name = "" if inside == path else design.drives[number].name
            if name not in menus:
                menus[name] = self._assumed_rows.addMenu(name)
                menus[name].setToolTipsVisible(True)
            text = named_value(design, path).removeprefix(f"{name}: ")
            add_entry(menus[name], text, partial(self._focus_field, path)).setToolTip(why(design, path))

    def _file_changed(self) -> None:
        named = "saved" if self._session.path is not None else "not saved to a file"
        self.saved.setText("unsaved changes" if self._session.modified else named)

    def _angle_changed(self, theta: float) -> None:
        self.angle.setText(f"{self._session.study.angle_name} {number(theta * 180.0 / pi, 1)}°")


def counted(findings: Iterable[Finding]) -> tuple[str, str]:
    """Return a text such as ``1 error, 2 warnings``, and the worst severity, ``none`` without findings."""
    numbers = Counter(finding.severity for finding in findings)
    counts = [f"{n} {s}{'s' if n > 1 else ''}" for s in (ERROR, WARNING, NOTE) if (n := numbers[s])]
    worst = next((s for s in (ERROR, WARNING, NOTE) if numbers[s]), "none")
    return ", ".join(counts) or "no findings", worst
