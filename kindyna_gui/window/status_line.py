"""The status line: what does not fit together, how many limits are exceeded, what was done last, what is assumed, where the cam
stands."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from functools import partial
from math import pi

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QMenu, QStatusBar, QToolButton

from core.design import row_at
from core.errors import KindynaError
from core.findings import ERROR, NOTE, WARNING, Finding
from core.project.reading_faults import reason as why
from core.study import findings_of
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import misses, waiting_text
from kindyna_gui.labels import named_value, reason
from kindyna_gui.look import coloured, sign, text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import clear_menu, soon
from kindyna_gui.requirements import suggestions_for

PAUSE_MS = 150
STAY_MS = 6000  # of a message
MARGIN = 12  # pixels around it


class StatusLine(QStatusBar):
    """Shows the state of session and player; the findings are those of the stages on screen, no other is computed."""

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
        self.findings = QToolButton(autoRaise=True)
        self.findings.setText("limits not checked")
        self.findings.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.findings.clicked.connect(lambda: show_findings())
        self.faults = text_button("Log", flat=True)
        self.faults.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.faults.setIcon(sign(ERROR))
        self.faults.clicked.connect(lambda: show_log())
        self.faults.hide()
        self.way = text_button("", flat=True)
        self.way.clicked.connect(lambda: do(self._entry))
        self.way.hide()
        self.unfit = QToolButton(autoRaise=True)
        self.unfit.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.unfit.setIcon(sign(ERROR))
        self.unfit.clicked.connect(lambda: focus_field(session.misfit.reasons[0][0]))
        self.unfit.hide()
        self.saved, self.assumed, self.angle = QLabel(), QToolButton(autoRaise=True), QLabel()
        self.awaited = QToolButton(autoRaise=True)
        self.awaited.clicked.connect(self._end_or_begin)
        self.awaited.hide()
        self.angle.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.update_style()
        self.angle.setToolTip("Angle of all views")
        self.assumed.setToolTip("Values that are not taken from a source: click to see them, and to go to one")
        self.assumed.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.assumed.setStyleSheet("QToolButton::menu-indicator { image: none; }")
        self._focus_field = focus_field
        self._of_drives: dict[str, QMenu] = {}
        self._assumed_rows = QMenu(self.assumed, toolTipsVisible=True)
        self._assumed_rows.aboutToShow.connect(self._list_assumed)
        self.assumed.setMenu(self._assumed_rows)
        coloured(self.saved, SCREEN.quiet)
        self.saved.setContentsMargins(6, 0, 6, 0)
        for widget in (
            self.way,
            self.awaited,
            self.faults,
            self.unfit,
            self.findings,
            self.saved,
            self.assumed,
            self.angle,
        ):
            self.addPermanentWidget(widget)
        self._whole = QLabel(self, wordWrap=True, margin=3)
        self._whole.setFrameShape(QLabel.Shape.StyledPanel)
        self._whole.setAutoFillBackground(True)
        self._whole.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._soon = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._soon.timeout.connect(self.count_findings)
        self.messageChanged.connect(self._ask_again)
        self.messageChanged.connect(self._offer)
        self.messageChanged.connect(self._show_whole)
        session.pending.changed.connect(self._show_awaited)
        session.mended.connect(self._mended)
        session.restored.connect(self._mended)
        session.incomplete_changed.connect(self._draft_changed)
        session.restored.connect(self._draft_changed)  # another drive names it otherwise
        session.full_design_changed.connect(self._design_changed)
        session.file_changed.connect(self._file_changed)
        player.angle_changed.connect(self._angle_changed)
        self._design_changed()
        self._file_changed()
        self._angle_changed(player.theta)

    def update_style(self) -> None:
        """The angle has a fixed size: else each new one would lay out the whole line anew."""
        letters = self.fontMetrics()
        self.angle.setFixedSize(letters.horizontalAdvance("driver angle 359.9°  "), letters.height())

    def show_message(self, text: str) -> None:
        """Show what has been done, for a while."""
        self.showMessage(text, STAY_MS)

    def ask(self, text: str) -> None:
        """Show what is to be done next, until it is ``answered``; what is shown for a while in between passes."""
        self._question = text
        self.showMessage(text)

    def answered(self, how: str) -> None:
        """It has been done, or not, as the text says."""
        asked, self._question = self._question, ""
        if self.currentMessage() == asked:
            self.clearMessage()
        if how:
            self.show_message(how)

    def _ask_again(self, text: str) -> None:
        if not text and self._question:
            soon(self, self._show_question)

    def _offer(self, text: str) -> None:
        """What can be done about a message is a button beside it."""
        way = next(iter(suggestions_for(text)), None)
        self._entry = "" if way is None else way.entry
        self.way.setText("" if way is None else way.text)
        self.way.setVisible(way is not None)

    def _show_whole(self, text: str) -> None:
        """A message that is longer than its room grows upwards over what stands there; nothing is moved by it."""
        window = self.window()
        room = (
            min(
                (each.x() for each in (self.way, self.awaited, self.faults, self.findings) if each.isVisible()),
                default=self.width(),
            )
            - 4
        )
        self._whole.setVisible(self.isVisible() and self.fontMetrics().horizontalAdvance(text) > room - MARGIN)
        if not self._whole.isHidden():
            self._whole.setParent(window)
            self._whole.setText(text)
            height = max(self._whole.heightForWidth(room), self.height())
            corner = self.mapTo(window, self.rect().bottomLeft())
            self._whole.setGeometry(corner.x(), corner.y() + 1 - height, room, height)
            self._whole.show()
            self._whole.raise_()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._lay_message()

    def _lay_message(self) -> None:
        self._show_whole(self.currentMessage())

    def _show_question(self) -> None:
        if self._question and not self.currentMessage():
            self.showMessage(self._question)

    def refuse(self, text: str) -> None:
        """Show that an edit was refused, until it is mended or taken back, or for a while."""
        self._refusal = f"Refused: {text}"
        self.show_message(self._refusal)

    def show_fault(self, text: str) -> None:
        """Show that the program has failed, until there is another message; the button to the log stays."""
        self.faults.setToolTip(f"{text} Click to read the log.")
        self.faults.show()
        self.showMessage(text)

    def _show_awaited(self) -> None:
        """A way out of what takes long, and back."""
        awaited = self._session.pending
        self.awaited.setText("Search again" if awaited.given_up else "Cancel the search")
        self.awaited.setToolTip("For the steady response of the flexible shaft, which a view shows")
        self.awaited.setVisible(awaited.busy or awaited.given_up)

    def _end_or_begin(self) -> None:
        awaited = self._session.pending
        if awaited.given_up:
            awaited.again()
        else:
            awaited.give_up()

    def _mended(self, *_: object) -> None:
        if self._refusal and self.currentMessage() == self._refusal:
            self.clearMessage()

    def recount(self) -> None:
        """Count the findings once things are at rest."""
        self._soon.start()

    def count_findings(self) -> None:
        """Show how many limits are exceeded."""
        self._soon.stop()
        stages = tuple(self._session.stages_on_screen())
        try:
            findings = findings_of(self._session.full_study, stages) if stages else ()
            text, severity = counted(findings) if stages else ("limits not checked", NOTE)
            tip = f"Looked at: {', '.join(stages) or 'nothing, no view is on screen'}. Click to see all findings."
        except KindynaError as error:
            text, severity, tip = "no answer", ERROR, reason(self._session.design, error)
        self.findings.setText(text)
        self.findings.setIcon(sign(severity))
        self.findings.setToolTip(tip)
        soon(self, self._lay_message)  # what stands beside it may have become wider

    def _design_changed(self) -> None:
        number = len(self._session.full_design.assumed)
        self.assumed.setText(f"{number} assumed")
        self.assumed.setVisible(number > 0)
        self.recount()
        self._angle_changed(self._player.theta)

    def _draft_changed(self) -> None:
        """What is typed fits together, or does not."""
        rows = misses(self._session)
        self.unfit.setText(waiting_text(self._session))
        self.unfit.setToolTip("\n".join((*rows, "Click to go there.")))
        self.unfit.setVisible(bool(rows))

    def _list_assumed(self) -> None:
        """One entry for each assumed value, which leads to its field; those of a drive in a menu of their own."""
        design, menus = self._session.full_design, {"": self._assumed_rows}
        self._of_drives = menus  # which Python must not forget
        clear_menu(self._assumed_rows)
        for path in design.assumed:
            _, number, inside = row_at(path, "drives")
            name = "" if inside == path else design.drives[number].name
            if name not in menus:
                menus[name] = self._assumed_rows.addMenu(name)
                menus[name].setToolTipsVisible(True)
            action = menus[name].addAction(named_value(design, path).removeprefix(f"{name}: "))
            action.setToolTip(why(design, path))
            action.triggered.connect(partial(self._focus_field, path))

    def _file_changed(self) -> None:
        named = "saved" if self._session.path is not None else "not saved to a file"
        self.saved.setText("unsaved changes" if self._session.modified else named)

    def _angle_changed(self, theta: float) -> None:
        self.angle.setText(f"{self._session.study.angle_name} {theta * 180.0 / pi:.1f}°")


def counted(findings: Iterable[Finding]) -> tuple[str, str]:
    """``1 error, 2 warnings`` and the gravest severity; ``none`` where nothing is found."""
    numbers = Counter(f.severity for f in findings)
    counts = [f"{n} {s}{'s' if n > 1 else ''}" for s in (ERROR, WARNING, NOTE) if (n := numbers[s])]
    gravest = next((s for s in (ERROR, WARNING, NOTE) if numbers[s]), "none")
    return ", ".join(counts) or "no findings", gravest
