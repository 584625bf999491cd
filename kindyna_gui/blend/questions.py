"""Form of the blend wizard, and its page *Which curve follows*."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtGui import QPalette, QShowEvent
from PySide6.QtWidgets import (
    QButtonGroup,
    QCheckBox,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.blend import (
    ELEMENTS,
    GOALS,
    LEAST_SPAN,
    MOTION_TYPES,
    SIGNS,
    TABLE,
    BlendError,
    CurveSequence,
    Request,
    has_room,
    state_text,
    state_words,
    states,
)
from core.design import UNITS, Info
from core.design.fields import LONGEST_MM
from core.number_text import MINUS
from core.output.drawing.scales import nice_below
from core.output.texts import succession_verdict
from kindyna_gui.blend.kind import CURVE_SIZE, KindChoice, curve_icon
from kindyna_gui.blend.request import AUTOMATIC, count_text, default_request, has_both, open_candidates, plan, reason
from kindyna_gui.blend.settings import SettingsArea, quiet
from kindyna_gui.forms.number_box import LiveBox, WordBox
from kindyna_gui.forms.refusal import RefusalLine, refuse_number
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.look import MessageLabel, bold_label, coloured, text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import typed
from kindyna_gui.rebuilt import ContentArea
from kindyna_gui.settings import symbol_of

# -- form of the request ---------------------------------------------------------------------------------

ANY_SEQUENCE = "selected by the settings"
GOAL_TEXTS: Mapping[str, str] = MappingProxyType(
    {
        "": "nothing",
        "acceleration": "least peak acceleration",
        "jerk": "least peak jerk",
        "torque": "least inertia torque on the camshaft",
    }
)
assert set(GOAL_TEXTS) == {"", *GOALS}


class Questions(QWidget):
    """Form of a request; ``changed`` is emitted with every change, also while the user types."""

    changed = Signal()

    def __init__(self, unit: str) -> None:
        super().__init__()
        self.unit = unit
        default = default_request(unit)
        self._angles = default.start, default.end
        self._sequences: list[tuple[str, bool | None]] = [(AUTOMATIC, None)]
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        self.kind = KindChoice()
        self.kind.changed.connect(self._emit_changed)
        self.kind.type_chosen.connect(self._type_chosen)
        column.addWidget(self.kind)
        column.addLayout(self._size_rows())
        column.addLayout(self._settings_header())
        self.settings = SettingsArea(unit)
        self.settings.changed.connect(self._emit_changed)
        column.addWidget(self.settings, 1)
        column.addLayout(self._choice_rows())
        self.general = MessageLabel(SCREEN.limit)
        column.addWidget(self.general)

    # -- layout ------------------------------------------------------------------------------------------

    def _size_rows(self) -> QGridLayout:
        length = Info("Stroke", "highest minus lowest position", 0.0, LONGEST_MM, open_low=True, step=1.0)
        angle = partial(Info, low=0.0, high=360.0, step=1.0)
        unit, degree = UNITS[self.unit], UNITS["deg"]
        self.stroke = LiveBox(length, unit)
        self.unequal = QCheckBox("Return stroke")
        self.unequal.setToolTip("Give the return another stroke than the rise")
        self.back = LiveBox(replace(length, label="Return stroke"), unit)
        self.start = LiveBox(angle("From", "cam angle where the motion starts"), degree)
        self.end = LiveBox(angle("To", "cam angle where the motion ends"), degree)
        self._back_unit = quiet(symbol_of(unit.symbol))
        grid = QGridLayout()
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        grid.setColumnStretch(1, 1)
        rows: tuple[tuple[str, tuple[QWidget, ...]], ...] = (
            ("Stroke", (self.stroke, quiet(symbol_of(unit.symbol)), self.unequal, self.back, self._back_unit)),
            ("Cam angle", (self.start, quiet("°  to"), self.end, quiet("°"))),
        )
        for box in (self.start, self.end):
            box.in_file_units = True  # as the texts about cam angles
        self.size_faults = (RefusalLine((0, 0, 0, 0)), RefusalLine((0, 0, 0, 0)))
        for i, (name, widgets) in enumerate(rows):
            row = QHBoxLayout()
            row.setSpacing(6)
            for widget in widgets:
                row.addWidget(widget)
            row.addStretch(1)
            grid.addWidget(bold_label(name), 2 * i, 0)
            grid.addLayout(row, 2 * i, 1)
            grid.addWidget(self.size_faults[i], 2 * i + 1, 1)
        for box in (self.stroke, self.back, self.start, self.end):
            box.changed.connect(self._emit_changed)
        self.unequal.toggled.connect(self._unequal_toggled)
        return grid

    def _settings_header(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.addWidget(bold_label("Settings"), 0, Qt.AlignmentFlag.AlignTop)
        row.addSpacing(8)
        self.count = QLabel(wordWrap=True)
        self.count.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.count.setFixedHeight(
            2 * self.count.fontMetrics().lineSpacing()
        )  # room for two lines: the form keeps its layout
        row.addWidget(self.count, 1)
        return row

    def _choice_rows(self) -> QGridLayout:
        self.sequence, self.goal = WordBox(), WordBox()
        self.sequence.setToolTip("Sequence of curves, and the number of settings it requires")
        self.goal.setToolTip("If settings are left open, minimise this")
        for goal, text in GOAL_TEXTS.items():
            self.goal.addItem(text, goal)
        for box in (self.sequence, self.goal):
            box.activated.connect(self._emit_changed)
        grid = QGridLayout()
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        grid.setColumnStretch(1, 1)
        for i, (text, box) in enumerate((("Curves", self.sequence), ("Optimise", self.goal))):
            label = bold_label(text)
            label.setBuddy(box)
            grid.addWidget(label, i, 0)
            grid.addWidget(box, i, 1)
        return grid

    # -- request -----------------------------------------------------------------------------------------

    def request(self) -> Request:
        """Return the request as typed; fields without a number are left out, so call ``find_faults`` first.

        While start and end leave no room for curves, the last valid ones are used: they decide which sequences are possible.
        """
        start, end = self.start.number, self.end.number
        if start is not None and end is not None and has_room(start, end):
            self._angles = start, end
        sequence, mirrored = self.chosen_sequence
        unequal = self.unequal.isChecked() and has_both(self.kind.type)
        return Request(
            type=self.kind.type,
            constant=self.kind.constant,
            stroke=self.stroke.number or 0.0,
            return_stroke=(self.back.number or 0.0) if unequal else 0.0,
            start=self._angles[0],
            end=self._angles[1],
            settings=dict(self.settings.given),
            points=self.settings.precision_points,
            sequence=sequence,
            mirrored=mirrored,
            unit=self.unit,
        )

    @property
    def chosen_goal(self) -> str:
        """Quantity to minimise if settings are left open; empty for none."""
        return str(self.goal.currentData())

    def set_request(self, request: Request, goal: str = "") -> None:
        """Fill the form with a request and a goal, without emitting ``changed``."""
        self.kind.set_choice(request.type, request.constant)
        for box, value in (
            (self.stroke, request.stroke),
            (self.back, request.return_stroke or request.stroke),
            (self.start, request.start),
            (self.end, request.end),
        ):
            box.set_number(value)
        blocked = self.unequal.blockSignals(True)
        self.unequal.setChecked(bool(request.return_stroke))
        self.unequal.blockSignals(blocked)
        self.settings.set_request(request)
        self._show_type()
        self._fill_sequences(request)
        self.choose_sequence(request.sequence, request.mirrored)
        self.goal.setCurrentIndex(self.goal.findData(goal))
        self.show_request()

    # -- sequences ---------------------------------------------------------------------------------------

    def show_request(self) -> None:
        """Show the sequences and settings that are possible, and how many settings are missing."""
        self._fill_sequences(self.request())
        self.settings.show_request(self.request())
        request = self.request()
        self.count.setText(count_text(request, self.chosen_goal))
        coloured(self.count, SCREEN.limit if plan(request).missing < 0 else SCREEN.quiet)
        if request.stroke > 0.0:
            self.stroke.set_step(min(nice_below(request.stroke / 20.0), 1.0))

    def _fill_sequences(self, request: Request) -> None:
        """List the sequences of the motion; the selected one stays selected if it is still possible."""
        rows = open_candidates(request)
        symmetric = {str(row.sequence) for row in rows if row.family.mirrored}
        named = [(str(row.sequence), row.family.mirrored if str(row.sequence) in symmetric else None) for row in rows]
        texts = [ANY_SEQUENCE]
        for (name, mirrored), row in zip(named, rows, strict=True):
            required = f"{row.freedom or 'no'} setting{'' if row.freedom == 1 else 's'}"
            texts.append(f"{name}{', return mirrored' if mirrored else ''}   {required}")
        if texts == [self.sequence.itemText(i) for i in range(self.sequence.count())]:
            return
        previous = self.chosen_sequence
        self._sequences = [(AUTOMATIC, None), *named]
        self.sequence.clear()
        self.sequence.addItems(texts)
        self.choose_sequence(*previous)

    @property
    def chosen_sequence(self) -> tuple[str, bool | None]:
        """Selected sequence, and whether its return is mirrored (None where it has only one form)."""
        return self._sequences[max(self.sequence.currentIndex(), 0)]

    def take_sequence(self, name: str) -> None:
        """Select a sequence by its name, as the user does in the list."""
        self.choose_sequence(name, next((mirrored for row, mirrored in self._sequences if row == name), None))
        self.changed.emit()

    def choose_sequence(self, name: str, mirrored: bool | None) -> None:
        """Select a sequence; for one that the motion does not have, the settings select."""
        row = (name, mirrored)
        self.sequence.setCurrentIndex(self._sequences.index(row) if row in self._sequences else 0)

    # -- faults ------------------------------------------------------------------------------------------

    def find_faults(self) -> bool:
        """Show below each field why its number is not allowed; True if there is such a field."""
        self.general.show_message("")
        has_back = self.unequal.isChecked() and has_both(self.kind.type)
        rows = ((self.stroke, *((self.back,) if has_back else ())), (self.start, self.end))
        for line, boxes in zip(self.size_faults, rows, strict=True):
            for box in (self.stroke, self.back) if self.stroke in boxes else boxes:
                box.set_refused(False)
            line.show_refusal("")
            if (wrong := next((box for box in boxes if box.fault()), None)) is not None:
                refuse_number(line, wrong)
        if not self.size_faults[1].text():
            self._refuse_crossed_angles()
        return bool(self.settings.find_faults() or any(line.text() for line in self.size_faults))

    def _refuse_crossed_angles(self) -> None:
        """Refuse an end that leaves no room for curves after the start."""
        start, end = self.start.number or 0.0, self.end.number or 0.0
        if start > end - LEAST_SPAN:
            why = f"The end must be at least {typed(LEAST_SPAN)}° after the start, not at {self.end.with_unit(end)}"
            refuse_number(self.size_faults[1], self.end, why, replace(self.end.info, low=start + LEAST_SPAN))

    def show_error(self, error: BlendError) -> None:
        """Show why there is no such motion, next to the field that causes it if it is known."""
        if not self.settings.show_error(error):
            self.general.show_message(reason(error))

    # -- actions of the user -----------------------------------------------------------------------------

    def _emit_changed(self, *_: object) -> None:
        self.changed.emit()

    def _type_chosen(self) -> None:
        self._show_type()
        if self.kind.type == "RRR":  # a motion without dwells takes the full turn
            self.start.set_number(0.0)
            self.end.set_number(360.0)
        self._emit_changed()

    def _show_type(self) -> None:
        for widget in (self.unequal, self.back, self._back_unit):
            widget.setVisible(has_both(self.kind.type))
        self.back.setEnabled(self.unequal.isChecked())

    def _unequal_toggled(self, on: bool) -> None:
        self.back.setEnabled(on)
        if on and self.stroke.number is not None:
            self.back.set_number(self.stroke.number)
        self._emit_changed()


# -- which curve follows ---------------------------------------------------------------------------------

HEADINGS = ("Curve", "s", "v", "a")
HINT = "Select a step of the sequence, or a curve of the table: green curves may follow it."


def _signs(text: str) -> str:
    return text.replace("-", MINUS)


def _ends(signs: tuple[int, int]) -> str:
    return _signs(", ".join(SIGNS[sign] for sign in signs))


class SuccessionPage(QFrame):
    """The curves of the planned sequence as buttons between their end states, and a table of all curves.

    The table shows which curves may follow ``curve``.
    """

    def __init__(self) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self.setAutoFillBackground(True)
        self._type, self._sequence = "", CurveSequence((), ())
        self._stale = False
        self.chosen: tuple[str, ...] = ()
        """First curves of the sequence up to the selected step, or the one curve selected in the table."""
        self.steps: list[QToolButton] = []
        self.motion = quiet()
        self._sequence_area = ContentArea()
        self.verdict = QLabel(wordWrap=True)
        self.verdict.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.table = RowsTable([*(TableHeading(text) for text in HEADINGS), TableHeading("May it follow?", wide=True)])
        self.table.setFrameShape(QFrame.Shape.NoFrame)
        self.table.setIconSize(CURVE_SIZE)
        self.table.setSelectionMode(RowsTable.SelectionMode.NoSelection)
        self.table.clicked.connect(self._clicked)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 8, 6)
        column.setSpacing(4)
        column.addWidget(self.motion)
        column.addWidget(self._sequence_area)
        column.addWidget(self.verdict)
        hint = quiet(HINT)
        hint.setWordWrap(True)
        column.addWidget(hint)
        column.addWidget(self.table, 1)

    @property
    def curve(self) -> str:
        """The last selected curve; empty if none is selected."""
        return self.chosen[-1] if self.chosen else ""

    def show_sequence(self, motion_type: str, sequence: CurveSequence) -> None:
        """Show the curves of a motion; the selected step stays selected if the motion begins with the same curves."""
        if (motion_type, sequence) == (self._type, self._sequence):
            return
        self._type, self._sequence, self._stale = motion_type, sequence, True
        if sequence.curves[: len(self.chosen)] != self.chosen or not self.chosen:
            self.chosen = sequence.curves[:1]
        self._refresh()

    def choose(self, curves: tuple[str, ...]) -> None:
        """Show which curves may follow the last of these, and why the others may not."""
        self.chosen = curves
        self._refresh()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._refresh()

    def _refresh(self) -> None:
        """Rebuild the page, once it is visible."""
        if not self.isVisible() or not self.chosen:
            return
        if self._stale:
            self._stale = False
            self.motion.setText(
                f"{MOTION_TYPES[self._type].label}: signs of velocity and acceleration where curves meet"
            )
            self._sequence_area.replace(self._sequence_row())
        step = len(self.chosen) - 1 if self._is_in_sequence else -1
        for i, button in enumerate(self.steps):
            button.setChecked(i == step)
        self._show_table()

    @property
    def _is_in_sequence(self) -> bool:
        return self._sequence.curves[: len(self.chosen)] == self.chosen

    def _sequence_row(self) -> QWidget:
        paper = QWidget()
        row = QHBoxLayout(paper)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        group = QButtonGroup(paper)
        group.setExclusive(False)
        self.steps = []
        first, *others = states(self._sequence)
        row.addWidget(self._state(first))
        for i, (name, state) in enumerate(zip(self._sequence.curves, others, strict=True), 1):
            button = text_button(name, checks=True)
            button.setIcon(curve_icon(name))
            button.setIconSize(CURVE_SIZE * 0.8)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.setToolTip(f"Show which curves may follow {name}, which ends {state_words(state)}")
            button.clicked.connect(partial(self._step, i))
            group.addButton(button)
            self.steps.append(button)
            row.addWidget(button)
            row.addWidget(self._state(state))
        row.addStretch(1)
        return paper

    def _state(self, state: tuple[int, int]) -> QLabel:
        label = quiet(_signs(state_text(state)).replace(", ", "\n"))
        label.setToolTip(state_words(state).capitalize())
        return label

    def _step(self, count: int, *_: object) -> None:
        self.choose(self._sequence.curves[:count])

    def _clicked(self, index: QModelIndex) -> None:
        self.choose((TABLE[index.row()].curve,))

    def _show_table(self) -> None:
        kind = self._type if self._is_in_sequence else ""
        rows, followers = [], []
        for row in TABLE:
            verdict = succession_verdict(self.chosen, row.curve, kind)
            followers += [row.curve] if verdict.may_follow else []
            cells = (row.curve, _ends(row.displacement), _ends(row.velocity), _ends(row.acceleration))
            colour = SCREEN.good if verdict.is_possible else SCREEN.ink if verdict.may_follow else SCREEN.quiet
            words = verdict.reason[0].upper() + verdict.reason[1:]
            rows.append(TableRow((*cells, words), icon=curve_icon(row.curve), tip=words, colour=colour))
        end = ELEMENTS[self.curve].end
        ends = f"<b>{self.curve}</b> ends {state_words(end)} ({_signs(state_text(end))})"
        self.verdict.setText(f"{ends}. May follow: <b>{', '.join(followers)}</b>")
        self.table.show_rows(rows)
