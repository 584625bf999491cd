"""Rows of settings in the blend wizard: number, feasible range and message of each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import (
    QCheckBox,
    QGridLayout,
    QLabel,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.blend import FLATS, LENGTHS, MAY_VANISH, SIZES, BlendError, Request, SettingRange, nearest_feasible
from core.design import UNITS, Info, Unit
from core.design.fields import LARGEST
from core.output.drawing.scales import nice_below
from kindyna_gui.blend.request import (
    PENDING,
    POINT,
    SETTINGS,
    Setting,
    initial_value,
    plan,
    range_text,
    reason,
    shown_names,
)
from kindyna_gui.forms.number_box import LiveBox
from kindyna_gui.forms.refusal import FloatingRefusal, Remedies
from kindyna_gui.look import coloured, icon, text_button
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.rebuilt import remove_part
from kindyna_gui.settings import size_of, symbol_of

CHECK, CURVE, BOX, UNIT, RANGE = range(5)  # columns of a row
STEPS = 150.0  # of an arrow, from 0 to a typical value
ANGLES = (*LENGTHS, "peak", *FLATS)

# -- fields ----------------------------------------------------------------------------------------------


def quiet(text: str = "") -> QLabel:
    """Label in the quiet colour, readable on any background."""
    label = QLabel(text)
    coloured(label, SCREEN.quiet)
    label.setForegroundRole(QPalette.ColorRole.WindowText)
    return label


class RangedRow(QObject):
    """Row with number boxes, their feasible range and a message.

    ``changed`` is emitted when a number changes, or the row is ticked or unticked.
    """

    changed = Signal()

    def __init__(self, name: str, symbol: str, unit: Unit) -> None:
        super().__init__()
        self.name, self.symbol, self.range_unit = name, symbol, unit
        self.ranges: Sequence[SettingRange] | None = None
        self.range = quiet()
        self.range.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.range.setWordWrap(True)
        self.range.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._fault = ""
        self._feasible: tuple[float | None, ...] = ()

    def boxes(self) -> tuple[LiveBox, ...]:
        """Number boxes of the row."""
        raise NotImplementedError

    @property
    def is_used(self) -> bool:
        """Whether the row counts as a setting."""
        return True

    @cached_property
    def message(self) -> FloatingRefusal:
        """Why the value is refused, at its box."""
        return FloatingRefusal(self.boxes()[-1])

    def show_ranges(self, ranges: Sequence[SettingRange] | None) -> None:
        """Show the feasible ranges of the value; None while they are computed."""
        self.ranges = ranges
        if ranges is None:
            text = PENDING
        else:
            text = range_text(ranges, self.symbol, size_of(self.range_unit.symbol)) if ranges or self.is_used else ""
        self.range.setText(text)
        self.range.setToolTip(text if ranges else "")
        if self._fault:
            self._show_fault()

    def show_fault(self, text: str) -> None:
        """Show an error at the box; an empty text hides it."""
        self._fault = text
        for box in self.boxes():
            box.set_refused(bool(text) and box is self._wrong_box)
        self._show_fault()

    def note_feasible(self) -> None:
        """Note the numbers of a feasible motion, to which a remedy goes back."""
        self._feasible = tuple(box.number for box in self.boxes())

    @property
    def _wrong_box(self) -> LiveBox:
        """The box with a text that is not allowed, else the last one."""
        return next((box for box in self.boxes() if box.fault()), self.boxes()[-1])

    def _show_fault(self) -> None:
        if not self._fault and "message" not in vars(self):
            return
        box = self._wrong_box
        feasible = dict(zip(self.boxes(), self._feasible, strict=False)).get(box)
        nearest = None
        if box.number is not None and box is self.boxes()[-1]:
            nearest = nearest_feasible(self.ranges or (), box.number)
        elif box.number is not None:
            nearest = box.info.nearest(box.number)
        texts = {f"Use {box.with_unit(nearest)}": nearest} if nearest is not None else {}
        if feasible not in (None, nearest, box.number):
            texts[f"Back to {box.with_unit(feasible)}"] = feasible
        uses = {text: partial(self._use, box, value) for text, value in texts.items()}
        self.message.show_refusal(
            self._fault[:1].upper() + self._fault[1:] if box.fault() else self._fault, {**uses, **self.remedies()}
        )

    def remedies(self) -> Remedies:
        """Return further remedies of a refused value."""
        return {}

    def _use(self, box: LiveBox, value: float) -> None:
        box.set_number(value)
        self.changed.emit()


class SettingRow(RangedRow):
    """Row of one setting, which counts while it is ticked."""

    def __init__(self, setting: Setting, unit: Unit) -> None:
        super().__init__(setting.name, setting.symbol, unit)
        info = Info(setting.label, setting.help, 0.0, open_low=setting.name not in MAY_VANISH)
        self.share, self.typical, self.shown = setting.share, 1.0, False
        self.check = QCheckBox(setting.label)
        self.check.setToolTip(setting.help)
        self.curve = quiet()
        self.box = LiveBox(info, unit)
        self.unit = quiet(symbol_of(unit.symbol))
        self.box.setEnabled(False)
        self.box.lineEdit().clear()
        self._has_value = False
        self.check.toggled.connect(self._toggled)
        self.box.changed.connect(self.changed)

    def boxes(self) -> tuple[LiveBox, ...]:
        return (self.box,)

    @property
    def is_used(self) -> bool:
        return self.check.isChecked()

    @property
    def value(self) -> float | None:
        """The number of the setting; None if its text is not a number."""
        return self.box.number

    def remedies(self) -> Remedies:
        return {"Leave it open": partial(self.check.setChecked, False)}

    def add_to(self, grid: QGridLayout, row: int) -> None:
        """Fill a row of a grid."""
        for column, widget in enumerate((self.check, self.curve, self.box, self.unit, self.range)):
            grid.addWidget(widget, row, column)

    def show(self, on: bool, curve: str) -> None:
        """Show or hide the row of a setting of this curve."""
        self.shown = on
        self.curve.setText(curve)
        for widget in (self.check, self.curve, self.box, self.unit, self.range):
            widget.setVisible(on)
        if not on:
            self.show_fault("")

    def give(self, value: float) -> None:
        """Tick the row with a value, without emitting ``changed``."""
        self._has_value = True
        self.box.set_number(value)
        blocked = self.check.blockSignals(True)
        self.check.setChecked(True)
        self.check.blockSignals(blocked)
        self.box.setEnabled(True)

    def untick(self) -> None:
        """Untick the row, without emitting ``changed``."""
        blocked = self.check.blockSignals(True)
        self.check.setChecked(False)
        self.check.blockSignals(blocked)
        self._clear()

    def _clear(self) -> None:
        """Hide the value; it comes back when the row is ticked again."""
        if self.box.number is not None:
            self.box.set_number(self.box.number)
        self.box.setEnabled(False)
        self.show_fault("")
        self.box.lineEdit().clear()

    def _toggled(self, on: bool) -> None:
        if on:
            value = self.box.value if self._has_value else None
            if value is None:
                value = initial_value(self.ranges or (), self.share)
            self.give(self.typical if value is None else value)
            self.box.setFocus(Qt.FocusReason.OtherFocusReason)
            self.box.selectAll()
        else:
            self._clear()
        self.changed.emit()


class PrecisionPointRow(RangedRow):
    """Row of a precision point: a cam angle, and the level above the lowest there.

    ``removed`` is emitted when the user removes the point; ``paper`` is the widget that contains the row.
    """

    removed = Signal()

    def __init__(self, unit: Unit) -> None:
        super().__init__(POINT, "level", unit)
        self.at = LiveBox(Info("Angle", "cam angle of the point", 0.0, 360.0, step=1.0), UNITS["deg"])
        self.at.in_file_units = True  # as the texts about cam angles
        self.level = LiveBox(Info("Level", "displacement above the lowest level"), unit)
        self.texts = (quiet("At"), quiet("°  at the level"), quiet(symbol_of(unit.symbol)))
        self.close = QToolButton(autoRaise=True)
        self.close.setIcon(icon("close"))
        self.close.setToolTip("Remove this point")
        self.close.setAccessibleName("Remove this point")
        self.close.clicked.connect(self.removed)
        for box in self.boxes():
            box.changed.connect(self.changed)
        self.paper = QWidget()
        self.setParent(self.paper)  # deleted together
        grid = QGridLayout(self.paper)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(2)
        for column, widget in enumerate(self.widgets()):
            grid.addWidget(widget, 0, column)
        grid.setColumnStretch(self.widgets().index(self.range), 1)

    def boxes(self) -> tuple[LiveBox, ...]:
        return self.at, self.level

    def widgets(self) -> tuple[QWidget, ...]:
        """Widgets of the row from left to right, above its message."""
        first, second, third = self.texts
        return first, self.at, second, self.level, third, self.range, self.close


# -- all settings ----------------------------------------------------------------------------------------


class SettingsArea(QScrollArea):
    """Rows of all settings and precision points.

    ``changed`` is emitted when a value changes, or a row is ticked or unticked.
    """

    changed = Signal()

    def __init__(self, unit: str) -> None:
        super().__init__(widgetResizable=True)
        self.unit = unit
        self.rows: dict[str, SettingRow] = {}
        self.points: list[PrecisionPointRow] = []
        self._order: list[str] = []  # settings in the order of ticking
        self._frame = (0.0, 360.0, 1.0)  # start, end, stroke: for the initial values of a point
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        paper = QWidget()
        paper.setBackgroundRole(QPalette.ColorRole.Base)
        paper.setAutoFillBackground(True)
        column = QVBoxLayout(paper)
        column.setContentsMargins(8, 6, 6, 6)
        column.setSpacing(2)
        column.addLayout(self._settings())
        self._points = QVBoxLayout()
        self._points.setSpacing(2)
        column.addLayout(self._points)
        self.add_point = self._add_button()
        column.addWidget(self.add_point, 0, Qt.AlignmentFlag.AlignLeft)
        column.addStretch(1)
        self.setWidget(paper)

    def _settings(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(2)
        grid.setColumnStretch(4, 1)
        for i, setting in enumerate(SETTINGS.values()):
            symbol = setting.unit.format(u=UNITS[self.unit].symbol)
            row = SettingRow(setting, Unit(symbol, 1.0))
            row.setParent(self)
            row.add_to(grid, 2 * i)
            row.changed.connect(partial(self._setting_changed, row))
            self.rows[setting.name] = row
        return grid

    def _add_button(self) -> QToolButton:
        button = text_button("Precision point", flat=True)
        button.setIcon(icon("add"))
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.setToolTip("Add a level that the follower passes at a cam angle; each point counts as a setting")
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        button.clicked.connect(self._add)
        return button

    # -- values ------------------------------------------------------------------------------------------

    @property
    def given(self) -> tuple[tuple[str, float], ...]:
        """Ticked settings whose text is a number, in the order of ticking."""
        values = [(name, self.rows[name].value) for name in self._order]
        return tuple((name, value) for name, value in values if value is not None)

    @property
    def precision_points(self) -> tuple[tuple[float, float], ...]:
        """Cam angle [deg] and level of each point whose texts are numbers."""
        values = [(row.at.number, row.level.number) for row in self.points]
        return tuple((at, level) for at, level in values if at is not None and level is not None)

    def set_request(self, request: Request) -> None:
        """Show the settings of a request, without emitting ``changed``."""
        for row in self.rows.values():
            row.untick()
        for point in list(self.points):
            self._remove_point(point, quietly=True)
        self._order = list(request.settings)
        for name, value in request.settings.items():
            self.rows[name].give(value)
        for at, value in request.points:
            self.put_point(at, value, quietly=True)

    def show_request(self, request: Request) -> None:
        """Show the rows that apply to a request, and untick the others."""
        names, target = shown_names(request), plan(request).target
        rise, back = (target.sequence.rise, target.sequence.back) if target is not None else ((), ())
        for row in self.rows.values():
            if row.name not in names and row.is_used:
                row.untick()
                self._order.remove(row.name)
            row.show(row.name in names, curve_of(row.name, rise, back))
        self.add_point.setVisible(POINT in names)
        if POINT not in names:
            for point in list(self.points):
                self._remove_point(point, quietly=True)
        if all(1.0 / LARGEST <= size <= LARGEST for size in (request.stroke, request.end - request.start)):
            self._set_steps(request)

    def _set_steps(self, request: Request) -> None:
        """Set round steps of the arrows, about a hundredth of a typical value, and the initial values without a range."""
        self._frame = request.start, request.end, request.stroke
        stroke, span = request.stroke, request.end - request.start
        typical = {"vcv": 1.5 * stroke / span, "vcv2": 1.5 * stroke / span, "acceleration": 12.0 * stroke / span**2,
                 **dict.fromkeys(LENGTHS, 0.5 * span), "peak": request.start + 0.5 * span,
                 **dict.fromkeys(FLATS, 0.1 * span), **dict.fromkeys(SIZES, 12.0 * stroke / span**2)}  # fmt: skip
        for row in self.rows.values():
            size = typical.get(row.name, stroke)
            row.box.set_step(1.0 if row.name in ANGLES else nice_below(size / STEPS))
            row.typical = round(size) if row.name in ANGLES else nice_below(size * row.share)
        for point in self.points:
            point.level.set_step(nice_below(stroke / STEPS))

    # -- ranges and faults -------------------------------------------------------------------------------

    def used_rows(self) -> list[RangedRow]:
        """Rows of the ticked settings, and of the points."""
        return [*(self.rows[name] for name in self._order), *self.points]

    def shown_rows(self) -> list[RangedRow]:
        """Rows of the settings that can be ticked, and of the points."""
        return [*(row for row in self.rows.values() if row.shown), *self.points]

    def find_faults(self) -> bool:
        """Show below each field why its number is not allowed; True if there is such a field."""
        texts = [next((text for box in row.boxes() if (text := box.fault())), "") for row in self.used_rows()]
        for row, text in zip(self.used_rows(), texts, strict=True):
            row.show_fault(text)
        return any(texts)

    def note_feasible(self) -> None:
        """Note the settings of a feasible motion."""
        for row in self.used_rows():
            row.note_feasible()

    def show_error(self, error: BlendError) -> bool:
        """Show why there is no such motion, below the setting that causes it; False if no row does."""
        row = self._row_with_error(error)
        if row is None:
            return False
        row.show_fault(reason(error))
        self.ensureWidgetVisible(row.boxes()[-1], 0, 8)
        return True

    def _row_with_error(self, error: BlendError) -> RangedRow | None:
        if error.setting == POINT:
            angles = [
                (f"point at {short(row.at.number, 6)} deg", row) for row in self.points if row.at.number is not None
            ]
            return next((row for text, row in angles if str(error).startswith(text)), None)
        row = self.rows.get(error.setting)
        return row if row is not None and row.is_used else None

    # -- actions of the user -----------------------------------------------------------------------------

    def _setting_changed(self, row: SettingRow) -> None:
        if row.is_used and row.name not in self._order:
            self._order.append(row.name)
        elif not row.is_used and row.name in self._order:
            self._order.remove(row.name)
        self.changed.emit()

    def _add(self, *_: object) -> None:
        self.put_point()

    def put_point(self, at: float | None = None, value: float | None = None, quietly: bool = False) -> None:
        """Add a precision point, in the middle by default; quietly: without emitting ``changed``."""
        start, end, stroke = self._frame
        row = PrecisionPointRow(UNITS[self.unit])
        row.at.set_number(round(0.5 * (start + end)) if at is None else at)
        row.level.set_number(nice_below(0.5 * stroke) if value is None else value)
        row.changed.connect(self.changed)
        row.removed.connect(partial(self._remove_point, row))
        self.points.append(row)
        self._points.addWidget(row.paper)
        if not quietly:
            row.at.setFocus(Qt.FocusReason.OtherFocusReason)
            row.at.selectAll()
            self.changed.emit()

    def has(self, row: RangedRow) -> bool:
        """Whether a row still exists; points can be removed."""
        return row in self.points or self.rows.get(row.name) is row

    def _remove_point(self, row: PrecisionPointRow, quietly: bool = False) -> None:
        self.points.remove(row)
        remove_part(row.paper)
        if not quietly:
            self.changed.emit()


def curve_of(name: str, rise: Sequence[str], back: Sequence[str]) -> str:
    """Name of the curve that a setting belongs to; empty if it belongs to several, or to none."""
    if not rise:  # a return alone counts from 1
        rise, back = back, ()
    curve_of_height = {
        "h1": (rise, 0),
        "h2": (rise, 1),
        "h3": (rise, -1),
        "h4": (back, 0),
        "h5": (back, 1),
        "h6": (back, -1),
    }
    if name in curve_of_height:
        curves, index = curve_of_height[name]
        return curves[index] if len(curves) >= (3 if index == 1 else 2) else ""
    if name.startswith(("flat", "a")) and name[-1].isdigit():
        return curve_of(f"h{name[-1]}", rise, back)
    return {"vcv": "rise", "vcv2": "return"}.get(name, "") if rise and back else ""
