"""Rows of the study dock: varied numbers and words, figures with limits, tolerances, waves of the profile."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QMenu, QPushButton, QRadioButton, QToolButton, QVBoxLayout, QWidget

from core.design import Design, Info, Tolerance
from core.design.fields import info_of as field_info_of
from core.design.limits import NORMAL, UNIFORM, WORST, Waviness
from core.study import TOTALS
from core.varying import Limits, Span
from kindyna_gui.documents.figures import STATISTICS, label_of, name_of
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import NumberBox, WordBox
from kindyna_gui.forms.refusal import Misfit, RefusalLine, accept_in_range
from kindyna_gui.look import bold_label, coloured, described, icon
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import ContentArea, add_entry, clear_menu, fill, widget_with
from kindyna_gui.studies.texts import (
    info_of,
    unit_of,
    value_text,
    word_text,
)

BOX_WIDTH = 78  # pixels
WIDTH = "width"  # key of the box for a tolerance ±
DISTRIBUTIONS: Mapping[str, str] = {NORMAL: "normal, 3σ", UNIFORM: "uniform", WORST: "at either end"}
_TIPS: Mapping[str, str] = {
    "plus": "Tolerance: upper deviation",
    "minus": "Tolerance: lower deviation, as a positive number; empty: same as the upper one",
    "cost": "Cost of halving the tolerance, in any currency; empty: 1",
}


class _Rows(QWidget):
    """A heading, rows, a message about invalid input, and a button that adds a row.

    Signals: ``add_requested`` (str), key of the row to add; ``removed`` (str), key of the row to remove.
    """

    add_requested = Signal(str)
    removed = Signal(str)

    def __init__(self, title: str, add: str) -> None:
        super().__init__()
        self.boxes: dict[tuple[str, str], NumberBox] = {}
        self.removers: dict[str, QToolButton] = {}
        self._area, self._keys = ContentArea(), ()
        self.message = RefusalLine((0, 0, 0, 0))
        self.add, self.menu = QPushButton(add), QMenu(self)
        self.add.setAutoDefault(False)
        self.add.setMenu(self.menu)
        self._offered: Callable[[], Mapping[str, Mapping[str, str]]] | None = None  # of a menu that is not filled yet
        self.menu.aboutToShow.connect(self._fill_menu)
        fill(
            QVBoxLayout(self),
            bold_label(title),
            self._area,
            self.message,
            (self.add, 0, Qt.AlignmentFlag.AlignLeft),
            margins=0,
            spacing=2,
        )

    def offer(self, groups: Callable[[], Mapping[str, Mapping[str, str]]], *, is_empty: bool) -> None:
        """Offer rows that can be added: group -> key -> name, computed when their menu opens; ``is_empty``: there are none."""
        clear_menu(self.menu)
        self._offered = groups
        self.add.setEnabled(not is_empty)

    def _fill_menu(self) -> None:
        offered, self._offered = self._offered, None
        for group, rows in {} if offered is None else offered().items():
            submenu = self.menu.addMenu(group)
            for key, name in rows.items():
                add_entry(submenu, name, partial(self.add_requested.emit, key))

    def _grid(self, rows: Sequence[Any]) -> QGridLayout | None:
        """Return an empty layout for these rows; None if they are on display already."""
        if self._keys == tuple(rows) and self._area.content is not None:
            return None
        self._keys = tuple(rows)
        self.boxes, self.removers = {}, {}
        self.message.show_refusal("")
        grid = fill(QGridLayout(), margins=0, spacing=(4, 2))
        return grid

    def _put(self, grid: QGridLayout) -> None:
        content = widget_with(grid)
        self._area.replace(content)

    def _remover(self, key: str, name: str) -> QToolButton:
        button = described(QToolButton(autoRaise=True), tip=f"Remove {name}")
        button.setIcon(icon("close"))
        button.setAccessibleName(button.toolTip())
        button.clicked.connect(lambda: self.removed.emit(key))
        self.removers[key] = button
        return button

    def _box(self, key: str, end: str, name: str, info: Info, enter: Any) -> NumberBox:
        box = described(NumberBox(info, unit_of(key)), name=name, tip=name)
        box.in_file_units = True  # shows the value as plots do
        box.setFixedWidth(BOX_WIDTH)
        accept_in_range(box, self.message, enter, name)
        self.boxes[key, end] = box
        return box


class SpanRows(_Rows):
    """Varied numbers with their bounds and tolerance, and varied words.

    Signals: ``changed`` (Span), new bounds; ``tolerance_changed`` (path, float or None), the
    tolerance ± of a number; ``words_changed`` (path, words), the words to try.
    """

    changed = Signal(object)
    tolerance_changed = Signal(str, object)
    words_changed = Signal(str, tuple)

    def __init__(self) -> None:
        super().__init__("Varied", "Vary a number …")
        self._spans: dict[str, Span] = {}
        self.words: dict[str, QPushButton] = {}

    def show_varied(
        self,
        design: Design,
        spans: Mapping[str, Span],
        words: Mapping[str, tuple[str, ...]],
        possible: Mapping[str, tuple[str, ...]],
    ) -> None:
        """Show the varied numbers with their bounds, and the words to try among the possible ones."""
        self._spans = dict(spans)
        grid = self._grid(
            [*((path, name_of(design, path)) for path in spans), *((path, *possible[path]) for path in words)]
        )
        if grid is not None:
            self.words = {}
            for row, path in enumerate(spans):
                self._add_row(grid, 2 * row, design, path)
            for row, path in enumerate(words, len(spans)):
                self._add_words(grid, 2 * row, design, path, possible[path])
            grid.setColumnStretch(6, 1)
            self._put(grid)
        widths = {row.field: row.plus if row.minus in (None, row.plus) else None for row in design.tolerances}
        for (path, end), box in self.boxes.items():
            if not box.pending:
                box.show_value(widths.get(path) if end == WIDTH else getattr(spans[path], end))
        for path, button in self.words.items():
            for action in button.menu().actions():
                action.setChecked(action.data() in words[path])
            button.setText(
                ", ".join(word_text(word) for word in words[path][:2])
                + (f" + {len(words[path]) - 2}" if len(words[path]) > 2 else "")
            )

    def _add_words(self, grid: QGridLayout, row: int, design: Design, path: str, possible: tuple[str, ...]) -> None:
        name = name_of(design, path)
        button, remover = QPushButton(), self._remover(path, name)
        button.setAutoDefault(False)
        button.setAccessibleName(name)
        button.setToolTip("Words to try in the search for the best design")
        menu = QMenu(button)
        for word in possible:
            action = menu.addAction(word_text(word))
            action.setData(word)
            action.setCheckable(True)
            action.triggered.connect(partial(self._choose_word, path))
        button.setMenu(menu)
        self.words[path] = button
        grid.addWidget(QLabel(name), row, 0, 1, 6)
        grid.addWidget(remover, row, 6, Qt.AlignmentFlag.AlignRight)
        grid.addWidget(button, row + 1, 0, 1, 6)

    def _choose_word(self, path: str, _: bool = False) -> None:
        actions = self.words[path].menu().actions()
        self.words_changed.emit(path, tuple(action.data() for action in actions if action.isChecked()))

    def _add_row(self, grid: QGridLayout, row: int, design: Design, path: str) -> None:
        name, (info, unit) = name_of(design, path), info_of(design, path)
        label, symbol, remover = QLabel(name), QLabel(unit.symbol), self._remover(path, name)
        coloured(symbol, SCREEN.quiet)
        low, high = (
            self._box(path, end, f"{name}: {title}", info, partial(self._enter, design, path, end))
            for end, title in (("low", "lowest"), ("high", "highest"))
        )
        grid.addWidget(label, row, 0, 1, 6)
        grid.addWidget(remover, row, 6, Qt.AlignmentFlag.AlignRight)
        tolerance = () if info.whole else (QLabel("±"), self._width_box(path, name))
        for column, part in enumerate((low, QLabel("…"), high, symbol, *tolerance)):
            grid.addWidget(part, row + 1, column)

    def _width_box(self, path: str, name: str) -> NumberBox:
        plus = Info(f"{name}: tolerance ±", low=0.0, open_low=True, optional=True)
        box = self._box(path, WIDTH, plus.label, plus, partial(self.tolerance_changed.emit, path))
        box.setToolTip(
            "Manufacturing tolerance ±, saved with the design; empty: none, or unequal deviations under Tolerances"
        )
        return box

    def _enter(self, design: Design, path: str, end: str, value: float) -> Misfit | None:
        span, box = self._spans[path], self.boxes[path, end]
        changed = Span(path, value, span.high) if end == "low" else Span(path, span.low, value)
        if not changed.low < changed.high:
            limit = f"below {box.with_unit(span.high)}" if end == "low" else f"above {box.with_unit(span.low)}"
            return f"bounds are reversed; allowed: {limit}, not {box.with_unit(value)}", box.info
        self.changed.emit(changed)
        return None


class FigureRows(_Rows):
    """Figures with their statistic, limits and current value.

    Signals: ``changed`` (key before, key, limits); ``shown`` (key), colour the plots by this figure.
    """

    changed = Signal(str, str, object)
    shown = Signal(str)

    def __init__(self) -> None:
        super().__init__("Computed for each design", "Add a quantity …")
        self._limits: dict[str, Limits] = {}
        self.buttons: dict[str, QRadioButton] = {}
        self.words: dict[str, WordBox] = {}
        self.values: dict[str, QLabel] = {}

    def show_figures(self, design: Design, figures: Mapping[str, Limits], shown: str) -> None:
        """Show figures with their limits; shown: key of the figure that colours the plots."""
        self._limits = dict(figures)
        grid = self._grid([(key, label_of(design, key.partition(":")[0])) for key in figures])
        if grid is not None:
            self.buttons, self.words, self.values = {}, {}, {}
            for row, key in enumerate(figures):
                self._add_row(grid, 2 * row, design, key)
            grid.setColumnStretch(5, 1)
            self._put(grid)
        for key, button in self.buttons.items():
            button.setChecked(key == shown)
        for (key, end), box in self.boxes.items():
            if not box.pending:
                box.show_value(figures[key][end == "most"])

    def _add_row(self, grid: QGridLayout, row: int, design: Design, key: str) -> None:
        slug, _, statistic = key.partition(":")
        name = label_of(design, slug)
        button, current, remover = QRadioButton(name), QLabel(), self._remover(key, name)
        button.setToolTip("Colour the plots by this quantity")
        button.clicked.connect(lambda: self.shown.emit(key))
        self.buttons[key], self.values[key] = button, current
        grid.addWidget(button, row, 0, 1, 4)
        grid.addWidget(current, row, 4, 1, 2, Qt.AlignmentFlag.AlignRight)
        grid.addWidget(remover, row, 6)
        if slug not in TOTALS:
            word = described(WordBox(), name=f"{name}: statistic over the turn")
            word.setMinimumContentsLength(4)
            fill_choices(word, STATISTICS)
            word.setCurrentIndex(word.findData(statistic))
            word.activated.connect(partial(self._choose, key))
            self.words[key] = word
            grid.addWidget(word, row + 1, 0)
        info = Info(name, optional=True)
        for column, end, sign in ((1, "least", "≥"), (3, "most", "≤")):
            box = self._box(key, end, f"{name} {sign}", info, partial(self._enter, key, end))
            grid.addWidget(QLabel(sign), row + 1, column, Qt.AlignmentFlag.AlignRight)
            grid.addWidget(box, row + 1, column + 1)
        symbol = coloured(QLabel(unit_of(key).symbol), SCREEN.quiet)
        grid.addWidget(symbol, row + 1, 5)

    def show_values(self, values: Mapping[str, float]) -> None:
        """Show the values of the current design, in red beyond a limit."""
        for key, label in self.values.items():
            value = values.get(key, float("nan"))
            least, most = self._limits[key]
            is_beyond = (least is not None and value < least) or (most is not None and value > most)
            text = value_text(key, value)
            label.setText(f"<b style='color:{SCREEN.limit}'>{text}</b>" if is_beyond else text)
            label.setToolTip(f"Value of the current design{', beyond its limit' if is_beyond else ''}")

    def _choose(self, key: str, _: int) -> None:
        slug = key.partition(":")[0]
        self.changed.emit(key, f"{slug}:{self.words[key].currentData()}", self._limits[key])

    def _enter(self, key: str, end: str, value: float | None) -> Misfit | None:
        least, most = self._limits[key]
        least, most = (value, most) if end == "least" else (least, value)
        if least is not None and most is not None and least > most:
            box = self.boxes[key, end]
            limit, typed = (
                (f"≤ {box.with_unit(most)}", least) if end == "least" else (f"≥ {box.with_unit(least)}", most)
            )
            allowed = replace(box.info, high=most) if end == "least" else replace(box.info, low=least)
            return f"limits are reversed; allowed: {limit}, not {box.with_unit(typed)}", allowed
        self.changed.emit(key, key, (least, most))
        return None


class ToleranceRows(_Rows):
    """Tolerances of the design. Signal ``changed`` (Tolerance)."""

    changed = Signal(object)
    ENDS = (("plus", "+"), ("minus", "−"), ("cost", "cost"))

    def __init__(self) -> None:
        super().__init__("Manufacturing tolerances", "Add a tolerance …")
        self._rows: dict[str, Tolerance] = {}
        self.words: dict[str, WordBox] = {}

    def show_rows(self, design: Design) -> None:
        """Show the tolerances of a design."""
        self._rows = {row.field: row for row in design.tolerances}
        grid = self._grid([(path, name_of(design, path)) for path in self._rows])
        if grid is not None:
            self.words = {}
            for row, path in enumerate(self._rows):
                self._add_row(grid, 3 * row, design, path)
            grid.setColumnStretch(6, 1)
            self._put(grid)
        for (path, end), box in self.boxes.items():
            if not box.pending:
                box.show_value(getattr(self._rows[path], end))
        for path, word in self.words.items():
            word.setCurrentIndex(word.findData(self._rows[path].distribution))

    def _add_row(self, grid: QGridLayout, row: int, design: Design, path: str) -> None:
        name, (_, unit) = name_of(design, path), info_of(design, path)
        remover, word, symbol = self._remover(path, f"the tolerance of {name}"), WordBox(), QLabel(unit.symbol)
        coloured(symbol, SCREEN.quiet)
        fill_choices(word, DISTRIBUTIONS)
        word.setAccessibleName(f"{name}: distribution")
        word.activated.connect(partial(self._choose_distribution, path))
        self.words[path] = word
        grid.addWidget(QLabel(name), row, 0, 1, 6)
        grid.addWidget(remover, row, 6, Qt.AlignmentFlag.AlignRight)
        cells = ((row + 1, 0), (row + 1, 2), (row + 2, 2))
        for (end, sign), (cell_row, column) in zip(self.ENDS, cells, strict=True):
            info = Info(f"{name}: {sign}", low=0.0, optional=end != "plus")
            box = self._box(path, end, info.label, info, partial(self._enter, path, end))
            box.setToolTip(_TIPS[end])
            grid.addWidget(QLabel(sign), cell_row, column, Qt.AlignmentFlag.AlignRight)
            grid.addWidget(box, cell_row, column + 1)
        grid.addWidget(symbol, row + 1, 4)
        grid.addWidget(word, row + 2, 0, 1, 2)

    def _choose_distribution(self, path: str, _: int) -> None:
        self.changed.emit(replace(self._rows[path], distribution=self.words[path].currentData()))

    def _enter(self, path: str, end: str, value: float | None) -> None:
        self.changed.emit(replace(self._rows[path], **{end: value}))  # type: ignore[arg-type]


class WaveRow(_Rows):
    """Waves of the profile. Signal ``changed`` (Waviness, or None for no waves)."""

    changed = Signal(object)
    ENDS = (("amplitude_mm", "Amplitude"), ("lobes_from", "Lobes"), ("lobes_to", "…"))
    FIRST_LOBES = (10, 40)

    def __init__(self) -> None:
        super().__init__("Waves of the profile", "")
        self.add.hide()
        self._waves: Waviness | None = None
        grid = self._grid(["waves"])
        assert grid is not None, "shown for the first time"
        infos = {row.name: field_info_of(row) for row in fields(Waviness)}
        for i, (end, sign) in enumerate(self.ENDS):
            info = infos[end]
            assert info is not None, "a number"
            field = replace(info, optional=True) if end == "amplitude_mm" else info
            box = self._box(end, "", info.label, field, partial(self._enter, end))
            box.setToolTip(
                f"{info.label}{'; empty: no waves' if field.optional else ': waves around the cam, all equally likely'}"
            )
            row, column = (0, 0) if not i else (1, 2 * i - 2)
            grid.addWidget(QLabel(sign), row, column)
            grid.addWidget(box, row, column + 1)
        symbol = coloured(QLabel(unit_of("amplitude_mm").symbol), SCREEN.quiet)
        grid.addWidget(symbol, 0, 2)
        grid.setColumnStretch(4, 1)
        self._put(grid)

    def show_waves(self, waves: Waviness | None) -> None:
        """Show the waves of a design, None if it has none."""
        self._waves = waves
        for (end, _), box in self.boxes.items():
            box.setEnabled(end == "amplitude_mm" or waves is not None)
            if not box.pending:
                box.show_value(None if waves is None else getattr(waves, end))

    def _enter(self, end: str, value: float | None) -> Misfit | None:
        if value is None:
            changed = None
        elif self._waves is None:
            changed = Waviness(value, *self.FIRST_LOBES)
        else:
            changed = replace(self._waves, **{end: value})  # type: ignore[arg-type]
            if changed.lobes_from > changed.lobes_to:
                info = self.boxes[end, ""].info
                allowed, fits = (
                    (f"from {changed.lobes_from}", replace(info, low=changed.lobes_from))
                    if end == "lobes_to"
                    else (f"up to {changed.lobes_to}", replace(info, high=changed.lobes_to))
                )
                return f"bounds are reversed; allowed: {allowed}, not {value}", fits
        self.changed.emit(changed)
        return None
