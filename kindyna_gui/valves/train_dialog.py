"""File > New > Valve train, Compo > Valve train: a cam card, and what both valves do with it over the crank.

The card drives everything: what is typed changes one of its values, and all other boxes, curves and the timing diagram follow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from PySide6.QtCore import QSignalBlocker, QSize, Qt
from PySide6.QtGui import QIcon, QPixmap
from PySide6.QtWidgets import (
    QButtonGroup,
    QCheckBox,
    QComboBox,
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import Design, only
from core.errors import DesignError, KindynaError
from core.find.fitting import nearest_fitting
from core.frozen import frozen
from core.plot import Plot
from core.requests import field_info
from core.units import Unit, conversion_factor
from core.valves import ValvePair, valve_pairs, valve_timings
from core.valves.cam_card import DURATIONS, ROWS, SCALARS, TRAIN_VALUES, TRAINS, VALVE_VALUES, CardValue, TrainCard
from core.valves.crank_plots import crank_plots
from core.valves.new_trains import duration_faults, followed, new_train, with_card
from kindyna_gui.background import Background
from kindyna_gui.dialogs import accept_buttons, give_help
from kindyna_gui.forms.faded_cover import FadedCover
from kindyna_gui.forms.fields import fill_choices, in_tab_order
from kindyna_gui.forms.refusal import RefusalLine, value_remedies
from kindyna_gui.forms.request_form import AROUND, RequestBox
from kindyna_gui.forms.tables import RowsTable
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import bold_label, described
from kindyna_gui.pictures.painter import thumbnail
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.units import short
from kindyna_gui.rebuilt import STRETCH, call_soon, connect_all, fill, single_shot, widget_with
from kindyna_gui.settings import symbol_of
from kindyna_gui.valves.figures import HEADINGS, figure_rows, shown_figures
from kindyna_gui.valves.timing_diagram import TimingDiagram

VALVES = ("inlet", "exhaust")
FORM_WIDTH, TYPICAL_SIZE, LEAST_SIZE = 400, QSize(1240, 700), QSize(1000, 620)
THUMB, PLOT_HEIGHT, FIGURES_HEIGHT, FIGURES_WIDTH = QSize(84, 60), 110, 236, 304
PAUSE_MS = 150  # from a value to the figures of the valves, or to the search for the nearest one that fits
LIFT_UNITS = ("mm", "in", "thou")

ValueKey = tuple[str, str]
"""Valve of the card, empty for both, and the name of its value."""
RATIO: ValueKey = ("", "ratio")
CENTRES: tuple[ValueKey, ...] = (("", "separation"), ("", "advance"))
LAST = "The last valve train that was possible"

# -- the grid of both valves ------------------------------------------------------------------------------------


@frozen
class CardRow:
    """A row of the grid.

    Attributes
    ----------
    label : text at its left
    inlet, exhaust : value in ``VALVE_VALUES``
    words : texts after the boxes of both valves
    suffix : of its name for screen readers, where the label is not unique
    """

    label: str
    inlet: str
    exhaust: str
    words: tuple[str, str] = ("", "")
    suffix: str = ""

    @property
    def full_name(self) -> str:
        """Name in messages and for screen readers."""
        return f"{self.label[:1].lower()}{self.label[1:]}{self.suffix}"


def _timing(row: str) -> tuple[CardRow, ...]:
    near, far, suffix = f"{row}_near_tdc", f"{row}_near_bdc", f", {row} lift"
    lift, duration = f"{row}_at_mm", f"{row}_deg"
    return (
        CardRow("At lift", lift, lift, suffix=f", {row}"),
        CardRow("Duration", duration, duration, ("°", "°"), suffix),
        CardRow("Opens", near, far, ("° BTDC", "° BBDC"), suffix),
        CardRow("Closes", far, near, ("° ABDC", "° ATDC"), suffix),
    )


GRID = (
    CardRow("Greatest lift", "lift_mm", "lift_mm"),
    CardRow("Lash", "lash_mm", "lash_mm"),
    CardRow("Ramp", "ramp_mm", "ramp_mm"),
    *_timing("first"),
    *_timing("second"),
    CardRow("Centre", "centre_deg", "centre_deg", ("° ATDC", "° BTDC")),
)
LOBE_ROWS = (
    CardRow("Velocity", "velocity_mm_per_deg", "velocity_mm_per_deg", ("mm/°", "mm/°"), ", greatest"),
    CardRow("Flank acc.", "acceleration_mm_per_deg2", "acceleration_mm_per_deg2", ("mm/°²", "mm/°²")),
    CardRow("Nose dec.", "nose_acceleration_mm_per_deg2", "nose_acceleration_mm_per_deg2", ("mm/°²", "mm/°²")),
)
"""Rows below the grid: values that follow from the durations, or drive the lobe once they are typed."""
OF_SIDES = (*DURATIONS, *SCALARS, *(f"{row}_near_{centre}" for row in ROWS for centre in ("tdc", "bdc")))
"""Values of a valve that its card only shows where the sides of the lobe are fixed."""
FIXED_SIDES = "The sides of this lobe differ, or are given from the nose: edit them on the page Motion of Parameters"


class CardBox(RequestBox):
    """Number of the card; a length is in the unit of the card, whatever the preferences say."""

    in_file_units = True

    @property
    def is_length(self) -> bool:
        """Whether the number is a length."""
        return self._unit.symbol in LIFT_UNITS

    def show_in(self, symbol: str) -> None:
        """Set the unit of a length."""
        self._unit = Unit(symbol, conversion_factor(symbol, "mm") * 1e-3)

    @property
    def _factor(self) -> float:
        """Unit of the box, in that of the card."""
        return conversion_factor(self._unit.symbol, "mm") if self.is_length else 1.0

    def show_card_value(self, value: float | None) -> None:
        """Show a value of the card."""
        self.set_number(None if value is None else round(value / self._factor, 10) + 0.0)

    @property
    def card_value(self) -> float | None:
        """The number, as a value of the card."""
        return None if self.number is None else round(self.number * self._factor, 12)

    @property
    def nearest_card_value(self) -> float | None:
        """The value of the card in the range of the box that is nearest to a number outside it."""
        nearest = None if self.number is None else self.info.nearest(self.number)
        return None if nearest in (None, self.number) else round(nearest * self._factor, 12)

    def card_text(self, value: float) -> str:
        """Value of the card with the unit of the box."""
        return self.with_unit(round(value / self._factor, 10))


# -- the dialog -------------------------------------------------------------------------------------------------


class ValveTrainDialog(QDialog):
    """A cam card on the left; lift, velocity, acceleration and the timing diagram of both valves on the right.

    Attributes
    ----------
    card : the card as typed
    design : the design with the card; None while there is none
    """

    def __init__(self, parent: QWidget, card: TrainCard, before: Design | None = None) -> None:
        super().__init__(parent)
        self.card, self.design = card, before
        self._before, self._valid = before, card
        self._back = card  # the last possible card before the typing in the present box
        self._typed: ValueKey = VALVES[0], "lift_mm"  # what was typed last
        self._why = ""  # the card makes no valve train
        self.setWindowTitle("New valve train" if before is None else "Valve train")
        give_help(self, "camshaft#Valve trains on the crank")
        self._nearest = Background(self)
        self._pause = single_shot(self, self._search, PAUSE_MS)
        self._later = single_shot(self, self.show_figures, PAUSE_MS)
        self.boxes: dict[ValueKey, CardBox] = {}
        self.pictures: dict[str, QToolButton] = {}
        self.message = RefusalLine((0, 4, 0, 0))
        self.facts, self.diagram, self.figures = QLabel(wordWrap=True), TimingDiagram(), RowsTable(HEADINGS)
        self.plots = [XYPlot("", "") for _ in range(3)]
        self.buttons, self.accept_button = accept_buttons(self, "Create" if before is None else "Change")
        self._lay_out()
        connect_all((self._nearest.result, self._offer), (self.finished, self._stop))
        self.show_unit()
        first = self.boxes[VALVES[0], "lift_mm"]
        first.setFocus()
        first.selectAll()

    # -- layout -------------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        column = fill(QVBoxLayout(), self._choices(), self._grid(), self.message, STRETCH, margins=0, spacing=8)
        if self._before is None:
            column.insertLayout(0, self._train_row())
        left = widget_with(column)
        left.setFixedWidth(FORM_WIDTH)
        for plot in self.plots:
            plot.setMinimumHeight(PLOT_HEIGHT)
        for plot in self.plots[:-1]:
            plot.show_numbers(False)
        curves = fill(QVBoxLayout(), *((plot, 1) for plot in self.plots), margins=0, spacing=2)
        self.figures.setFixedHeight(FIGURES_HEIGHT)
        self.figures.setMinimumWidth(FIGURES_WIDTH)
        right = fill(QVBoxLayout(), (self.diagram, 1), self.facts, self.figures, margins=0)
        shown = widget_with(fill(QHBoxLayout(), (curves, 4), (right, 3), margins=0, spacing=8))
        self.cover = FadedCover(shown)
        middle = fill(QHBoxLayout(), left, (shown, 1), spacing=8)
        fill(QVBoxLayout(self), (middle, 1), self.buttons, margins=(8, 10, 8, 10))
        rows, of_lobe = (
            [(valve, getattr(row, valve)) for valve in VALVES for row in part] for part in (GRID, LOBE_ROWS)
        )
        in_tab_order(self.of, self.unit, *(self.boxes[key] for key in (RATIO, *rows, *CENTRES)), self.same)
        in_tab_order(self.same, *(self.boxes[key] for key in of_lobe))
        self.setMinimumSize(LEAST_SIZE)
        self.resize(TYPICAL_SIZE.boundedTo(self.screen().availableGeometry().size() - AROUND))

    def _train_row(self) -> QHBoxLayout:
        """Kinds of valve trains as pictures, painted once the dialog is open."""
        group = QButtonGroup(self)
        for word, train in TRAINS.items():
            button = QToolButton()
            button.setText(train.label)
            button.setCheckable(True)
            button.setChecked(word == self.card.train)
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
            button.setIconSize(THUMB)
            button.setIcon(QIcon(QPixmap(THUMB)))
            described(button, name=train.label, tip=f"{train.label} valve train")
            button.clicked.connect(partial(self._choose_train, word))
            group.addButton(button)
            self.pictures[word] = button
            call_soon(button, partial(self._paint, word))
        return fill(QHBoxLayout(), *self.pictures.values(), STRETCH, margins=0)

    def _paint(self, word: str) -> None:
        """Paint the picture of a kind of valve train."""
        design = only(new_train(TrainCard(train=word)), 0)
        image = thumbnail(design, THUMB.width(), THUMB.height(), self.devicePixelRatioF())
        self.pictures[word].setIcon(QIcon(QPixmap.fromImage(image)))

    def _choices(self) -> QHBoxLayout:
        """What the lifts of the card are, their unit, and the rocker ratio."""
        of = field_info(TrainCard, "of")
        self.of = described(QComboBox(), name=of.label, tip=sentence(of.help))
        self.unit = described(
            QComboBox(), name="Lifts in", tip="Unit of the lifts; another one may follow a number: 1 mm"
        )
        fill_choices(self.of, {word: word for word in of.choices})
        fill_choices(self.unit, {symbol: symbol for symbol in LIFT_UNITS})
        self.of.setCurrentIndex(self.of.findData(self.card.of))
        self.unit.setCurrentIndex(max(0, self.unit.findData(symbol_of("mm"))))
        ratio = self._box(RATIO, TRAIN_VALUES["ratio"].info.label)
        self.ratio_label = QLabel(ratio.accessibleName())
        connect_all((self.of.currentIndexChanged, self._choose_of), (self.unit.currentIndexChanged, self.show_unit))
        words = QLabel(of.label), QLabel("in")
        return fill(
            QHBoxLayout(), words[0], self.of, words[1], self.unit, 8, self.ratio_label, ratio, STRETCH, margins=0
        )

    def _grid(self) -> QGridLayout:
        """Values of both valves, then separation and advance, then what follows from them."""
        grid = fill(QGridLayout(), margins=0, spacing=(4, 2))
        self.same = QCheckBox("Exhaust as the inlet")
        self.same.setToolTip("The exhaust has the lift, lash, ramp and durations of the inlet")
        self.same.setChecked(self._has_same_lobe())
        self.same.toggled.connect(self._same_toggled)
        grid.addWidget(bold_label("Inlet"), 0, 1)
        grid.addWidget(bold_label("Exhaust"), 0, 3)
        self.units: list[QLabel] = []
        first_of_lobe = 1 + len(GRID) + len(CENTRES)
        for number, row in (*enumerate(GRID, 1), *enumerate(LOBE_ROWS, first_of_lobe)):
            grid.addWidget(QLabel(row.label), number, 0)
            for k, valve in enumerate(VALVES):
                box = self._box((valve, getattr(row, valve)), f"{valve.capitalize()}, {row.full_name}")
                words = QLabel(row.words[k])
                grid.addWidget(box, number, 1 + 2 * k)
                grid.addWidget(words, number, 2 + 2 * k)
                if box.is_length:
                    self.units.append(words)
        for number, key in enumerate(CENTRES, 1 + len(GRID)):
            label = _value_at(key).info.label
            grid.addWidget(QLabel(label), number, 0)
            grid.addWidget(self._box(key, label), number, 1)
            grid.addWidget(QLabel("°"), number, 2)
        grid.addWidget(self.same, 1 + len(GRID), 3, 1, 2)
        return grid

    def _box(self, key: ValueKey, name: str) -> CardBox:
        value = _value_at(key)
        box = described(CardBox(key[1], value.info, value.unit), name=name, tip=sentence(value.info.help))
        box.typed.connect(lambda _: self._value_typed(key))
        self.boxes[key] = box
        return box

    # -- what is typed ------------------------------------------------------------------------------------------

    def _value_typed(self, key: ValueKey) -> None:
        if key != self._typed:
            self._back = self._valid
        self._typed, box = key, self.boxes[key]
        if why := box.fault():
            self._drop()
            self._refuse(f"{box.accessibleName()}: {why}", box.nearest_card_value)
        else:
            self._take(self._with_typed(box.card_value), box)

    def _with_typed(self, number: float | None) -> TrainCard:
        """Return the card with this number in place of the value typed last."""
        return _with_value(self.card, self._typed, self.same.isChecked(), number)

    def _choose_train(self, word: str, *_: object) -> None:
        with QSignalBlocker(self.of):
            self.of.setCurrentIndex(self.of.findData(TRAINS[word].of))
        self._take(replace(self.card, train=word, ratio=None, of=TRAINS[word].of))

    def _choose_of(self, *_: object) -> None:
        self._take(replace(self.card, of=self.of.currentData()))

    def _same_toggled(self, on: bool) -> None:
        if on:
            self._take(_with_same_lobe(self.card))

    def _has_same_lobe(self) -> bool:
        return _with_same_lobe(self.card) == self.card

    def _take(self, card: TrainCard, *typed: CardBox) -> None:
        """Show another card in all boxes but those that are typed into; values that are not typed follow."""
        self.card = card = followed(card, self._before)
        self._show_values(*typed)
        self.update_design()
        if not typed:
            self._back = self._valid

    def _show_values(self, *typed: CardBox) -> None:
        if not self._has_same_lobe():
            self.same.setChecked(False)
        for valve in VALVES:
            ramp = self.boxes[valve, "ramp_mm"]
            ramp.lineEdit().setPlaceholderText(ramp.card_text(self.card.ramp_mm(getattr(self.card, valve))))
        for key, box in self.boxes.items():
            if box not in typed:
                box.show_card_value(_read(self.card, key))
                box.set_refused(False)
            if key[0] and key[1] in OF_SIDES:
                is_fixed = getattr(self.card, key[0]).is_fixed
                box.setEnabled(not is_fixed)
                box.setToolTip(FIXED_SIDES if is_fixed else sentence(_value_at(key).info.help))
        for part in (self.boxes[RATIO], self.ratio_label):
            part.setVisible(bool(self.card.row.arm))

    def show_unit(self, *_: object) -> None:
        """Show all lifts in the chosen unit."""
        symbol = self.unit.currentData()
        for label in self.units:
            label.setText(symbol)
        for box in self.boxes.values():
            if box.is_length:
                box.show_in(symbol)
        self._take(self.card)

    # -- the design ---------------------------------------------------------------------------------------------

    def _drop(self) -> None:
        """Have no design: a value is refused."""
        self.design = None
        self.accept_button.setEnabled(False)
        self.cover.show_text(LAST)
        self._nearest.stop()
        self._pause.stop()

    def update_design(self) -> None:
        """Build the design of the card and show it, or refuse the value typed last."""
        self._drop()
        try:
            self.design, pair, plots = _shown(self._before, self.card)
        except KindynaError as error:
            self._why = self._reason(error)
            self._refuse(self._why)
            self._pause.start()
            return
        self._valid = self.card
        self.boxes[self._typed].set_refused(False)
        self.message.show_refusal("")
        self.accept_button.setEnabled(True)
        self.cover.show_text("")
        for plot, shown in zip(self.plots, plots, strict=True):
            plot.show_plot(shown)
        self.diagram.show_card(self.card)
        self.facts.setText(self._overlap_text(pair))
        self._later.start()

    def show_figures(self) -> None:
        """Show the figures of both valves in the table."""
        if self.design is not None:
            valves, _ = shown_figures(self.design)
            self.figures.show_rows(figure_rows(valves, is_card=True))

    def _overlap_text(self, pair: ValvePair) -> str:
        overlaps = []
        for row in ROWS:
            box, lift = self.boxes[VALVES[0], f"{row}_at_mm"], getattr(self.card.inlet, f"{row}_at_mm")
            overlaps.append(f"{short(self.card.overlap_deg(row))}° at {box.card_text(lift)}")
        area = "" if pair.overlap_area is None else f"\nOverlap area {short(pair.overlap_area)} mm·°"
        return f"Overlap {', '.join(overlaps)}{area}"

    def _refuse(self, why: str, nearest: float | None = None) -> None:
        """Refuse the value typed last; it can be the nearest possible one, or what it was."""
        box, valid = self.boxes[self._typed], _read(self._back, self._typed)
        box.set_refused(True)
        back = partial(self._take, self._back)
        self.message.show_refusal(why, value_remedies(box.card_text, nearest, valid, self._use, back))

    def _reason(self, error: KindynaError) -> str:
        """First reason why the card makes no valve train, in the numbers of its boxes."""
        lift_box = self.boxes[VALVES[0], "first_at_mm"]
        for fault in duration_faults(self.card, lift_box.card_text):
            valve, _, name = fault.path.partition(".")
            box = self.boxes[valve, name]
            return sentence(
                f"{box.accessibleName()} {box.card_text(fault.value)}: {fault.problem}; allowed: {fault.allowed}"
            )
        first = DesignError(error.faults[:1]) if isinstance(error, DesignError) else error
        return reason(self._before or new_train(TrainCard()), first)

    def _use(self, number: float) -> None:
        self._take(self._with_typed(number))

    def _search(self) -> None:
        """Search for the nearest number that makes a valve train, in place of the one typed last."""
        typed, valid = (_read(card, self._typed) for card in (self.card, self._valid))
        if typed is not None:
            fits = partial(_fits, self._before, partial(_with_value, self.card, self._typed, self.same.isChecked()))
            self._nearest.start([(self.card, partial(nearest_fitting, typed, fits, valid))])

    def _offer(self, card: TrainCard, nearest: Any) -> None:
        """Offer the nearest number, unless another card has been typed since."""
        if card is self.card and self.design is None and isinstance(nearest, float):
            self._refuse(self._why, nearest)

    def _stop(self) -> None:
        self._pause.stop()
        self._later.stop()
        self._nearest.close()


def _value_at(key: ValueKey) -> CardValue:
    valve, name = key
    return (VALVE_VALUES if valve else TRAIN_VALUES)[name]


def _read(card: TrainCard, key: ValueKey) -> float | None:
    """Value of a card."""
    return _value_at(key).read(getattr(card, key[0]) if key[0] else card)


def _with_value(card: TrainCard, key: ValueKey, is_same: bool, number: float | None) -> TrainCard:
    """Return a card with another number; with ``is_same`` the exhaust has the lobe of the inlet."""
    (valve, _), value = key, _value_at(key)
    if not valve:
        changed: TrainCard = value.write(card, number)
        return changed
    card = card.with_valve(valve, value.write(getattr(card, valve), number))
    return _with_same_lobe(card) if is_same and valve == VALVES[0] else card


def _shown(before: Design | None, card: TrainCard) -> tuple[Design, ValvePair, tuple[Plot, ...]]:
    """Return the design with a card, new or in place of that before, its valves and their curves. Raises KindynaError."""
    design = new_train(card) if before is None else with_card(before, card)
    pair = valve_pairs(valve_timings(design))[0]
    return design, pair, crank_plots(pair)


def _fits(before: Design | None, with_number: Callable[[float], TrainCard], number: float) -> bool:
    """Whether a card with a number makes a valve train."""
    try:
        _shown(before, with_number(number))
    except KindynaError:
        return False
    return True


def _with_same_lobe(card: TrainCard) -> TrainCard:
    """Return the card with the lobe of the inlet for the exhaust."""
    return replace(card, exhaust=replace(card.inlet, centre_deg=card.exhaust.centre_deg))


def ask_valve_train(parent: QWidget, card: TrainCard, before: Design | None = None) -> Design | None:
    """Ask for a card, of a new design or in place of that of a design; None where the user cancels."""
    dialog = ValveTrainDialog(parent, card, before)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    design = dialog.design if accepted else None
    dialog.deleteLater()
    return design
