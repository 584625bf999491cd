"""File > New > Valve train, Compo > Valve train: a cam card, and what both valves do with it over the crank.

The card drives everything: what is typed changes one of its values, and all other boxes, curves and the timing diagram follow.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QSize, Qt
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
from core.requests import field_info
from core.units import NO_UNIT, Unit, conversion_factor
from core.valves import valve_pairs, valve_timings
from core.valves.crank_plots import crank_plots
from core.valves.new_trains import CARD_VALUES, TRAINS, TrainCard, new_train, with_card
from kindyna_gui.background import Background
from kindyna_gui.dialogs import accept_buttons, give_help
from kindyna_gui.forms.fields import fill_choices, in_tab_order
from kindyna_gui.forms.refusal import RefusalLine, judge_number
from kindyna_gui.forms.request_form import AROUND, RequestBox
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import bold_label, described
from kindyna_gui.pictures.painter import thumbnail
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.units import short
from kindyna_gui.rebuilt import STRETCH, call_soon, connect_all, fill, single_shot, widget_with
from kindyna_gui.settings import symbol_of
from kindyna_gui.valves.timing_diagram import TimingDiagram

VALVES = ("inlet", "exhaust")
FORM_WIDTH, TYPICAL_SIZE, LEAST_SIZE = 400, QSize(1240, 700), QSize(1000, 560)
THUMB, PLOT_HEIGHT = QSize(84, 60), 110
PAUSE_MS = 150  # from a refused value to the search for the nearest one that fits
LIFT_UNITS = ("mm", "in", "thou")

Place = tuple[str, str]
"""Valve of the card, and the name of its value in ``CARD_VALUES``."""

# -- the grid of both valves ------------------------------------------------------------------------------------


@frozen
class CardRow:
    """A row of the grid.

    Attributes
    ----------
    label : text at its left
    inlet, exhaust : value in ``CARD_VALUES``
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
CENTRES: Mapping[str, str] = MappingProxyType(
    {
        "Separation": "cam angle between both centres",
        "Advance": "crank angle by which both lobes are earlier than with equal centres",
    }
)


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

    def card_text(self, value: float | None) -> str:
        """Value of the card with the unit of the box."""
        return "empty" if value is None else self.with_unit(round(value / self._factor, 10))


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
        self._typed: Place = VALVES[0], "lift_mm"
        self.setWindowTitle("New valve train" if before is None else "Valve train")
        give_help(self, "camshaft#Valve trains on the crank")
        self._nearest = Background(self)
        self._pause = single_shot(self, self._search, PAUSE_MS)
        self.boxes: dict[Place, CardBox] = {}
        self.pictures: dict[str, QToolButton] = {}
        self.message = RefusalLine((0, 4, 0, 0))
        self.facts, self.diagram = QLabel(wordWrap=True), TimingDiagram()
        self.plots = [XYPlot("", "") for _ in range(3)]
        self.buttons, self.accept_button = accept_buttons(self, "Create" if before is None else "Change")
        self._lay_out()
        connect_all((self._nearest.result, self._offer), (self.finished, self._stop))
        self.show_unit()
        self.update_design()
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
        beside = fill(QVBoxLayout(), (self.diagram, 1), self.facts, margins=0)
        middle = fill(QHBoxLayout(), left, (curves, 5), (beside, 3), spacing=12)
        fill(QVBoxLayout(self), (middle, 1), self.buttons, margins=(12, 10, 12, 10))
        columns = [self.boxes[valve, getattr(row, valve)] for valve in VALVES for row in GRID]
        in_tab_order(self.of, self.unit, self.ratio, *columns, *self.centres, self.same)
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
        of, ratio = field_info(TrainCard, "of"), replace(field_info(TrainCard, "ratio"), optional=False)
        self.of = described(QComboBox(), name=of.label, tip=sentence(of.help))
        self.unit = described(
            QComboBox(), name="Lifts in", tip="Unit of the lifts; another one may follow a number: 1 mm"
        )
        fill_choices(self.of, {word: word for word in of.choices})
        fill_choices(self.unit, {symbol: symbol for symbol in LIFT_UNITS})
        self.of.setCurrentIndex(self.of.findData(self.card.of))
        self.unit.setCurrentIndex(max(0, self.unit.findData(symbol_of("mm"))))
        self.ratio = described(CardBox("ratio", ratio, NO_UNIT), name=ratio.label, tip=sentence(ratio.help))
        self.ratio_label = QLabel(ratio.label)
        connect_all(
            (self.of.currentIndexChanged, self._choose_of),
            (self.unit.currentIndexChanged, self.show_unit),
            (self.ratio.typed, self._ratio_typed),
        )
        words = QLabel(of.label), QLabel("in")
        return fill(
            QHBoxLayout(), words[0], self.of, words[1], self.unit, 8, self.ratio_label, self.ratio, STRETCH, margins=0
        )

    def _grid(self) -> QGridLayout:
        """Values of both valves, then separation and advance."""
        grid = fill(QGridLayout(), margins=0, spacing=(4, 2))
        self.same = QCheckBox("Exhaust as the inlet")
        self.same.setToolTip("The exhaust has the lift, lash, ramp and durations of the inlet")
        self.same.setChecked(self._has_same_lobe())
        self.same.toggled.connect(self._same_toggled)
        grid.addWidget(bold_label("Inlet"), 0, 1)
        grid.addWidget(bold_label("Exhaust"), 0, 3)
        self.units: list[QLabel] = []
        for number, row in enumerate(GRID, 1):
            grid.addWidget(QLabel(row.label), number, 0)
            for k, valve in enumerate(VALVES):
                name, words = getattr(row, valve), QLabel(row.words[k])
                self.boxes[valve, name] = box = self._box(valve, name, row)
                grid.addWidget(box, number, 1 + 2 * k)
                grid.addWidget(words, number, 2 + 2 * k)
                if box.is_length:
                    self.units.append(words)
        self.centres: list[CardBox] = []
        for k, (name, tip) in enumerate(CENTRES.items()):
            number = 1 + len(GRID) + k
            info = replace(CARD_VALUES["centre_deg"].info, label=name, low=-360.0, help=tip)
            box = described(CardBox(name, info, CARD_VALUES["centre_deg"].unit), name=name, tip=sentence(tip))
            box.typed.connect(self._centre_typed)
            grid.addWidget(QLabel(name), number, 0)
            grid.addWidget(box, number, 1)
            grid.addWidget(QLabel("°"), number, 2)
            self.centres.append(box)
        grid.addWidget(self.same, 1 + len(GRID), 3, 1, 2)
        return grid

    def _box(self, valve: str, name: str, row: CardRow) -> CardBox:
        value = CARD_VALUES[name]
        box = CardBox(name, value.info, value.unit)
        described(box, name=f"{valve.capitalize()}, {row.full_name}", tip=sentence(value.info.help))
        box.typed.connect(partial(self._value_typed, valve))
        return box

    # -- what is typed ------------------------------------------------------------------------------------------

    def _value_typed(self, valve: str, name: str) -> None:
        self._typed = valve, name
        box = self.boxes[valve, name]
        if self._is_allowed(box):
            self._take(self._with_value(self.card, box.card_value), box)

    def _with_value(self, card: TrainCard, number: float | None) -> TrainCard:
        """Return the card with another number in place of the value typed last."""
        valve, name = self._typed
        card = card.with_valve(valve, CARD_VALUES[name].write(getattr(card, valve), number))
        if self.same.isChecked() and valve == VALVES[0]:
            card = _with_same_lobe(card)
        return card

    def _centre_typed(self, _: str) -> None:
        if all(map(self._is_allowed, self.centres)):
            separation, advance = (box.number or 0.0 for box in self.centres)
            self._take(self.card.with_centres(separation, advance), *self.centres)

    def _ratio_typed(self, _: str) -> None:
        if self._is_allowed(self.ratio):
            self._take(replace(self.card, ratio=self.ratio.number), self.ratio)

    def _choose_train(self, word: str, *_: object) -> None:
        self._take(replace(self.card, train=word, ratio=None))

    def _choose_of(self, *_: object) -> None:
        self._take(replace(self.card, of=self.of.currentData()))

    def _same_toggled(self, on: bool) -> None:
        if on:
            self._take(_with_same_lobe(self.card))

    def _has_same_lobe(self) -> bool:
        return _with_same_lobe(self.card) == self.card

    def _is_allowed(self, box: CardBox) -> bool:
        """Whether the number of a box is in its range; else refuse it."""
        is_allowed = judge_number(self.message, box, box.accessibleName())
        if not is_allowed:
            self._drop()
        return is_allowed

    def _take(self, card: TrainCard, *typed: CardBox) -> None:
        """Show another card in all boxes but those that are typed into."""
        self.card = card
        self._show_values(*typed)
        self.update_design()

    def _show_values(self, *typed: CardBox) -> None:
        if not self._has_same_lobe():
            self.same.setChecked(False)
        for (valve, name), box in self.boxes.items():
            part = getattr(self.card, valve)
            if name == "ramp_mm":
                box.lineEdit().setPlaceholderText(box.card_text(self.card.ramp_mm(part)))
            if box not in typed:
                box.show_card_value(CARD_VALUES[name].read(part))
                box.set_refused(False)
        for box, number in zip(self.centres, self.card.centres, strict=True):
            if box not in typed:
                box.show_card_value(number)
        if self.ratio not in typed:
            self.ratio.show_card_value(self.card.rocker_ratio)
        for part in (self.ratio, self.ratio_label):
            part.setVisible(bool(self.card.row.arm))

    def show_unit(self, *_: object) -> None:
        """Show all lifts in the chosen unit."""
        symbol = self.unit.currentData()
        for label in self.units:
            label.setText(symbol)
        for box in self.boxes.values():
            if box.is_length:
                box.show_in(symbol)
        self._show_values()

    # -- the design ---------------------------------------------------------------------------------------------

    def build(self, card: TrainCard) -> Design:
        """Return the design with a card. Raises KindynaError."""
        return new_train(card) if self._before is None else with_card(self._before, card)

    def _drop(self) -> None:
        """Have no design: a value is refused."""
        self.design = None
        self.accept_button.setEnabled(False)
        self._nearest.stop()
        self._pause.stop()

    def update_design(self) -> None:
        """Build the design of the card and show it, or refuse the value typed last."""
        self._drop()
        box = self.boxes[self._typed]
        try:
            self.design = self.build(self.card)
        except KindynaError as error:
            box.set_refused(True)
            self._refuse(error)
            self._pause.start()
            return
        self._valid = self.card
        box.set_refused(False)
        self.message.show_refusal("")
        self.accept_button.setEnabled(True)
        self._show_design(self.design)

    def _show_design(self, design: Design) -> None:
        pair = valve_pairs(valve_timings(design))[0]
        for plot, shown in zip(self.plots, crank_plots(pair), strict=True):
            plot.show_plot(shown)
        self.diagram.show_card(self.card)
        lifts = {row: getattr(self.card.inlet, f"{row}_at_mm") for row in ("first", "second")}
        box = self.boxes[VALVES[0], "lift_mm"]
        overlaps = [f"{short(self.card.overlap_deg(row))}° at {box.card_text(at)}" for row, at in lifts.items()]
        area = "" if pair.overlap_area is None else f"; {short(pair.overlap_area)} mm·° of lift"
        self.facts.setText(f"Overlap {', '.join(overlaps)}{area}")

    def _refuse(self, error: KindynaError, nearest: float | None = None) -> None:
        """Say why the card makes no valve train; the value typed last can be the nearest that does, or what it was."""
        valve, name = self._typed
        box, valid = self.boxes[self._typed], CARD_VALUES[name].read(getattr(self._valid, valve))
        near = {} if nearest is None else {f"Use {box.card_text(nearest)}": partial(self._use, nearest)}
        back = {} if valid == box.card_value else {f"Back to {box.card_text(valid)}": partial(self._go_back)}
        first = DesignError(error.faults[:1]) if isinstance(error, DesignError) else error
        self.message.show_refusal(reason(self._before or new_train(TrainCard()), first), {**near, **back})

    def _use(self, number: float) -> None:
        self._take(self._with_value(self.card, number))

    def _go_back(self) -> None:
        self._take(self._valid)

    def _search(self) -> None:
        """Search for the nearest value of the box typed last that makes a valve train."""
        valve, name = self._typed
        card, value = self.card, CARD_VALUES[name]
        typed, valid = (value.read(getattr(each, valve)) for each in (card, self._valid))
        if typed is not None:
            self._nearest.start([(card, partial(nearest_fitting, typed, partial(self._fits, card), valid))])

    def _fits(self, card: TrainCard, number: float) -> bool:
        try:
            self.build(self._with_value(card, number))
        except KindynaError:
            return False
        return True

    def _offer(self, card: TrainCard, nearest: Any) -> None:
        if card is self.card and self.design is None and isinstance(nearest, float):
            try:
                self.build(card)
            except KindynaError as error:
                self._refuse(error, nearest)

    def _stop(self) -> None:
        self._pause.stop()
        self._nearest.close()


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
