"""The table of settings of the blend wizard: heights, velocities, lengths and precision points, each with its range."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QGridLayout, QScrollArea, QToolButton, QVBoxLayout, QWidget

from core.blend import FLATS, LENGTHS, SIZES, BlendError
from core.design import UNITS, Unit
from core.design.fields import LARGEST
from kindyna_gui.blend.fields import PrecisionPointRow, RangedRow, SettingRow
from kindyna_gui.blend.request import POINT, SETTINGS, WizardRequest, plan, shown_names
from kindyna_gui.blend.texts import reason
from kindyna_gui.look import icon, text_button
from kindyna_gui.pictures.units import nice_below
from kindyna_gui.rebuilt import take_away

STEPS = 150.0  # of an arrow, from nothing to what is usual
ANGLES = (*LENGTHS, "peak", *FLATS)


class SettingsArea(QScrollArea):
    """Rows to tick and to fill in.

    changed   another value, or a row was ticked or unticked
    """

    changed = Signal()

    def __init__(self, unit: str) -> None:
        super().__init__(widgetResizable=True)
        self.unit = unit
        self.rows: dict[str, SettingRow] = {}
        self.points: list[PrecisionPointRow] = []
        self._order: list[str] = []  # settings in the order of ticking
        self._frame = (0.0, 360.0, 1.0)  # start, end, stroke: where a point begins
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
            symbol = setting.per.format(u=UNITS[self.unit].symbol)
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
        button.setToolTip("A level that the follower passes at a cam angle; each counts as a setting")
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        button.clicked.connect(self._add)
        return button

    # -- what is answered -----------------------------------------------------------------------------------

    @property
    def given(self) -> tuple[tuple[str, float], ...]:
        """Settings that are ticked and can be read, in the order of ticking."""
        values = [(name, self.rows[name].value) for name in self._order]
        return tuple((name, value) for name, value in values if value is not None)

    @property
    def passed(self) -> tuple[tuple[float, float], ...]:
        """The points that can be read: cam angle [deg], level."""
        values = [(row.at.number, row.level.number) for row in self.points]
        return tuple((at, level) for at, level in values if at is not None and level is not None)

    def answer(self, request: WizardRequest) -> None:
        """Show the settings of a request, without emitting ``changed``."""
        for row in self.rows.values():
            row.drop()
        for point in list(self.points):
            self._remove_point(point, quietly=True)
        self._order = [name for name, _ in request.given]
        for name, value in request.given:
            self.rows[name].give(value)
        for at, value in request.points:
            self.put_point(at, value, quietly=True)

    def show_request(self, request: WizardRequest) -> None:
        """Show the rows that apply to a request, and untick those that no longer do."""
        names, target = shown_names(request), plan(request).target
        rise, back = (target.sequence.rise, target.sequence.back) if target is not None else ((), ())
        for row in self.rows.values():
            if row.name not in names and row.used:
                row.drop()
                self._order.remove(row.name)
            row.show(row.name in names, curve_of(row.name, rise, back))
        self.add_point.setVisible(POINT in names)
        if POINT not in names:
            for point in list(self.points):
                self._remove_point(point, quietly=True)
        if all(1.0 / LARGEST <= size <= LARGEST for size in (request.stroke, request.end - request.start)):
            self._set_steps(request)

    def _set_steps(self, request: WizardRequest) -> None:
        """Arrows go in round steps of about a hundredth of what is usual; and where to begin while no range is known."""
        self._frame = request.start, request.end, request.stroke
        stroke, span = request.stroke, request.end - request.start
        usual = {"vcv": 1.5 * stroke / span, "vcv2": 1.5 * stroke / span, "acceleration": 12.0 * stroke / span**2,
                 **dict.fromkeys(LENGTHS, 0.5 * span), "peak": request.start + 0.5 * span,
                 **dict.fromkeys(FLATS, 0.1 * span), **dict.fromkeys(SIZES, 12.0 * stroke / span**2)}  # fmt: skip
        for row in self.rows.values():
            size = usual.get(row.name, stroke)
            row.box.set_step(1.0 if row.name in ANGLES else nice_below(size / STEPS))
            row.usual = round(size) if row.name in ANGLES else nice_below(size * row.share)
        for point in self.points:
            point.level.set_step(nice_below(stroke / STEPS))

    # -- ranges and faults ----------------------------------------------------------------------------------

    def used_rows(self) -> list[RangedRow]:
        """Settings that are ticked, and points."""
        return [*(self.rows[name] for name in self._order), *self.points]

    def shown_rows(self) -> list[RangedRow]:
        """Settings that can be ticked, and points."""
        return [*(row for row in self.rows.values() if row.shown), *self.points]

    def find_faults(self) -> bool:
        """Show beside each field why its number is not allowed; True where one is not."""
        texts = [next((text for box in row.boxes() if (text := box.fault())), "") for row in self.used_rows()]
        for row, text in zip(self.used_rows(), texts, strict=True):
            row.show_fault(text)
        return any(texts)

    def blame(self, error: BlendError) -> bool:
        """Show why there is no such motion beside the setting at fault; False where no row is at fault."""
        row = self._blamed(error)
        if row is None:
            return False
        row.show_fault(reason(error))
        self.ensureWidgetVisible(row.message, 0, 8)
        return True

    def _blamed(self, error: BlendError) -> RangedRow | None:
        if error.setting == POINT:
            angles = [(f"point at {row.at.number:.9g} deg", row) for row in self.points if row.at.number is not None]
            return next((row for text, row in angles if str(error).startswith(text)), None)
        row = self.rows.get(error.setting)
        return row if row is not None and row.used else None

    # -- what the user does ---------------------------------------------------------------------------------

    def _setting_changed(self, row: SettingRow) -> None:
        if row.used and row.name not in self._order:
            self._order.append(row.name)
        elif not row.used and row.name in self._order:
            self._order.remove(row.name)
        self.changed.emit()

    def _add(self, *_: object) -> None:
        self.put_point()

    def put_point(self, at: float | None = None, value: float | None = None, quietly: bool = False) -> None:
        """Add a precision point, in the middle where no place is given; quietly: without emitting ``changed``."""
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
        """Whether a row is still there: points come and go."""
        return row in self.points or self.rows.get(row.name) is row

    def _remove_point(self, row: PrecisionPointRow, quietly: bool = False) -> None:
        self.points.remove(row)
        take_away(row.paper)
        if not quietly:
            self.changed.emit()


def curve_of(name: str, rise: Sequence[str], back: Sequence[str]) -> str:
    """Which curve of a sequence a setting is of; empty where it is of several, or of none."""
    if not rise:  # a return alone counts from 1
        rise, back = back, ()
    places = {"h1": (rise, 0), "h2": (rise, 1), "h3": (rise, -1), "h4": (back, 0), "h5": (back, 1), "h6": (back, -1)}
    if name in places:
        curves, at = places[name]
        return curves[at] if len(curves) >= (3 if at == 1 else 2) else ""
    if name.startswith(("flat", "a")) and name[-1].isdigit():
        return curve_of(f"h{name[-1]}", rise, back)
    return {"vcv": "rise", "vcv2": "return"}.get(name, "") if rise and back else ""


__all__ = ["SettingsArea", "curve_of"]
