"""The form of a graph's axes: its title, and of each axis title, range and logarithmic scale."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QCheckBox, QGridLayout, QHBoxLayout, QLabel, QLineEdit, QWidget

from core.design import Info
from core.frozen import frozen
from core.output.graph import Graph, GraphAxis
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.labels import no_number
from kindyna_gui.look import coloured
from kindyna_gui.note import MessageLabel, bold_label
from kindyna_gui.pictures.style import SCREEN

AXES = {"x": "Along the bottom", "left": "On the left", "right": "On the right"}
RANGE = Info("Range", "empty: as far as the curves go", optional=True)


@frozen
class AxisSays:
    """What an axis shows by itself: its title, the unit it is read in, how many of the curves' unit that is."""

    title: str = ""
    symbol: str = ""
    size: float = 1.0


class AxesForm(QWidget):
    """changed (Graph, str): the graph as it is to be, and what was changed."""

    changed = Signal(object, str)

    def __init__(self) -> None:
        super().__init__()
        self._graph, self._says = Graph(), dict.fromkeys(AXES, AxisSays())
        self.title = QLineEdit()
        self.title.setAccessibleName("Title of the graph")
        self.title.editingFinished.connect(self._entitle)
        self.titles: dict[str, QLineEdit] = {}
        self.logs: dict[str, QCheckBox] = {}
        self.ends: dict[tuple[str, str], NumberBox] = {}
        self._units: dict[str, QLabel] = {}
        self.message = MessageLabel(SCREEN.limit)
        grid = QGridLayout(self)
        grid.setContentsMargins(6, 4, 6, 4)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(1, 1)
        label = QLabel("Title")
        label.setBuddy(self.title)
        grid.addWidget(label, 0, 0)
        grid.addWidget(self.title, 0, 1)
        for number, (axis, text) in enumerate(AXES.items()):
            self._add(grid, 1 + 4 * number, axis, text)
        grid.addWidget(self.message, 13, 0, 1, 2)
        grid.setRowStretch(14, 1)

    def _add(self, grid: QGridLayout, row: int, axis: str, text: str) -> None:
        head, title, log, unit = bold_label(text), QLineEdit(), QCheckBox("Logarithmic"), QLabel()
        title.setAccessibleName(f"Title, {text.lower()}")
        log.setAccessibleName(f"Logarithmic, {text.lower()}")
        coloured(unit, SCREEN.quiet)
        grid.addWidget(head, row, 0, 1, 2)
        named = QLabel("Title")
        named.setBuddy(title)
        grid.addWidget(named, row + 1, 0)
        grid.addWidget(title, row + 1, 1)
        grid.addWidget(QLabel("from"), row + 2, 0)
        line = QHBoxLayout()
        line.setSpacing(4)
        for end, between in (("low", "to"), ("high", "")):
            box = NumberBox(RANGE)
            box.setAccessibleName(f"{'From' if end == 'low' else 'To'}, {text.lower()}")
            box.setToolTip("Empty: as far as the curves go")
            box.entered.connect(lambda value, axis=axis, end=end: self._limit(axis, end, value))
            box.unreadable.connect(lambda axis=axis, end=end: self._refuse(axis, end))
            box.withdrawn.connect(lambda: self.message.show_message(""))
            line.addWidget(box, 1)
            if between:
                line.addWidget(QLabel(between))
            self.ends[axis, end] = box
        line.addWidget(unit)
        grid.addLayout(line, row + 2, 1)
        grid.addWidget(log, row + 3, 1)
        title.editingFinished.connect(lambda axis=axis: self._name(axis))
        log.toggled.connect(lambda on, axis=axis: self._to_powers(axis, on))
        self.titles[axis], self.logs[axis], self._units[axis] = title, log, unit

    def show_graph(self, graph: Graph, says: Mapping[str, AxisSays]) -> None:
        """What is typed, and what stands there where nothing is."""
        self._graph, self._says = graph, dict(says)
        _show(self.title, graph.title, "none")
        for axis in AXES:
            scale, own = getattr(graph, axis), self._says.get(axis, AxisSays())
            _show(self.titles[axis], scale.title, own.title or "by what is drawn")
            self._units[axis].setText(own.symbol)
            with QSignalBlocker(self.logs[axis]):
                self.logs[axis].setChecked(scale.log)
            for end in ("low", "high"):
                box, value = self.ends[axis, end], getattr(scale, end)
                if not box.pending and not (box.hasFocus() and box.refused):
                    box.show_value(None if value is None else value / own.size)

    # -- what the user does ---------------------------------------------------------------------------------

    def _entitle(self) -> None:
        if self.title.text().strip() != self._graph.title:
            self.title.setModified(False)
            self.changed.emit(replace(self._graph, title=self.title.text().strip()), "title")

    def _name(self, axis: str) -> None:
        text = self.titles[axis].text().strip()
        if text != getattr(self._graph, axis).title:
            self.titles[axis].setModified(False)
            self._scale(axis, "title", title=text)

    def _limit(self, axis: str, end: str, value: float | None) -> None:
        own, scale = self._says.get(axis, AxisSays()), getattr(self._graph, axis)
        wanted: GraphAxis = replace(scale, **{end: None if value is None else value * own.size})
        if wanted.low is not None and wanted.high is not None and wanted.low >= wanted.high:
            other = (wanted.high if end == "low" else wanted.low) / own.size
            self._wrong(axis, end, f"{'less' if end == 'low' else 'more'} than {other:g}")
        elif wanted.log and value is not None and value <= 0.0:
            self._wrong(axis, end, "above 0 on a logarithmic axis")
        else:
            self.message.show_message("")
            self.ends[axis, end].show_value(value)  # no longer being typed: what is undone is seen there
            self._scale(axis, end, **{end: getattr(wanted, end)})

    def _to_powers(self, axis: str, on: bool) -> None:
        """Powers of ten, or not; an end that has no place among them stays typed, and does not count."""
        scale = getattr(self._graph, axis)
        lost = on and any(end is not None and end <= 0.0 for end in (scale.low, scale.high))
        text = f"{AXES[axis]}: 0 and less is not on a logarithmic axis; what is typed does not count there"
        self.message.show_message(text if lost else "")
        self._scale(axis, "log", log=on)

    def _wrong(self, axis: str, end: str, allowed: str) -> None:
        self.ends[axis, end].set_refused(True)
        self.message.show_message(
            f"{AXES[axis]}, {'from' if end == 'low' else 'to'}: outside its range; allowed: {allowed}"
        )

    def _refuse(self, axis: str, end: str) -> None:
        self.ends[axis, end].set_refused(True)
        self.message.show_message(f"{AXES[axis]}: {no_number(self.ends[axis, end].text())}")

    def _scale(self, axis: str, what: str, **changes: object) -> None:
        self.changed.emit(
            replace(self._graph, **{axis: replace(getattr(self._graph, axis), **changes)}), f"{axis} {what}"
        )


def _show(box: QLineEdit, text: str, usual: str) -> None:
    box.setPlaceholderText(usual)
    if box.text() != text and not (box.hasFocus() and box.isModified()):
        box.setText(text)


__all__ = ["AxesForm", "AxisSays"]
