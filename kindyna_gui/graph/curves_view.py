"""Curves: columns of any tables and designs on one graph, its rows and axes beside it; pictures, numbers and clipboard out."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import degrees, isfinite
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, QMimeData, QObject, Qt
from PySide6.QtGui import QAction, QDragEnterEvent, QDropEvent, QHideEvent, QKeyEvent, QKeySequence, QUndoStack
from PySide6.QtWidgets import (
    QApplication,
    QFrame,
    QHBoxLayout,
    QLabel,
    QMenu,
    QProgressBar,
    QScrollArea,
    QSplitter,
    QTabWidget,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.bounds import bounded_json
from core.errors import KindynaError
from core.output.channels import channels
from core.output.graph import (
    ALL,
    MACHINE,
    DesignSource,
    Graph,
    GraphCurve,
    GraphData,
    GraphPoint,
    Series,
    add_curve,
    angle_at,
    copy_curve,
    from_data,
    graph_data,
    move_curve,
    numbers_csv,
    path_values,
    point_distance,
    quantity_kind,
    ready_graphs,
    remove_curve,
    to_data,
    with_curve,
)
from core.output.graph.curves import GraphImage
from core.output.graph.model import ENDING, load_setup, save_setup, with_relative_paths
from core.study import STAGES, Quantity, Study, quantity
from core.study.member_quantities import gain_per_turn
from core.units import conversion_factor
from kindyna_gui import dialogs
from kindyna_gui.documents.edits import UndoStep
from kindyna_gui.documents.pins import Bands
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.load_rows import TwoGroups, list_button
from kindyna_gui.graph.curve_form import AXES, EMPTY, AxesForm, AxisSays, CurveForm, CurveRow, CurveRows, name_of_row
from kindyna_gui.graph.graph_choice import GraphSources
from kindyna_gui.graph.live_graph import LiveGraph
from kindyna_gui.look import SteadyText, text_button
from kindyna_gui.pictures.plots.graph import LETTERS
from kindyna_gui.pictures.plots.graph import Bands as Shaded
from kindyna_gui.pictures.plots.lines import closed_band
from kindyna_gui.pictures.units import readable, short, with_unit
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import clear_menu
from kindyna_gui.saving import save_picture, written
from kindyna_gui.settings import Settings
from kindyna_gui.view import View

SIDE_WIDTH, MOST_STEPS = 330, 200
LEAST_SIDE, LEAST_HEIGHT = 180, 60  # pixels of a form before it scrolls
FIRST = "displacement"
"""The channel of a graph that has just been begun, where the design has it."""


class CurvesView(View):
    """The page. Its graph belongs to the window, not to the design: it is kept from run to run."""

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self._kept_part: dict[str, Any] = {}  # of the last run: shown once all files are read
        self.graph, self.row = self._kept(), 0
        self.found = GraphData((), (), "", "", {}, {}, {})
        self.sources = GraphSources(self)
        self.stack = QUndoStack(self)
        self.stack.setUndoLimit(MOST_STEPS)
        self._gesture = 0  # steps of one kind in one of them are one
        self._drawn_rows: list[GraphCurve] = []
        self.plot = LiveGraph()
        self.bands = Bands.of(session)
        self.bands.changed.connect(self.invalidate)
        slots: dict[str, Callable[[], object]] = {
            "copy": self.copy, "remove": self.remove, "up": lambda: self._move_row(-1), "down": lambda: self._move_row(1),
            "undo": self.undo, "redo": self.redo,
        }  # fmt: skip
        additions: tuple[tuple[str, str, Callable[[], object]], ...] = (
            ("Channel of this design", "A curve of the design at hand; choose its channel below", self.add_channel),
            ("Curves of a file …", "Of a table (CSV, text) or of another design (.toml)", self.open_files),
            ("Difference", "The chosen curve less another one; choose which below", self.add_difference),
        )
        self.rows = CurveRows(slots, additions)
        self.stack.canUndoChanged.connect(self.rows.buttons["undo"].setEnabled)
        self.stack.canRedoChanged.connect(self.rows.buttons["redo"].setEnabled)
        self.form, self.axes = CurveForm(), AxesForm()
        self.readout = SteadyText()
        self._part_done, self._strip = QProgressBar(textVisible=True), QWidget()
        self._read_text = QLabel()
        self.cancel_button = text_button("Cancel")
        self.set_column(self._parts(), grows=self._parted)
        self.setAcceptDrops(True)
        self.rows.list.installEventFilter(self)
        self._connect()

    def _connect(self) -> None:
        self.rows.chosen.connect(self._choose)
        self.rows.ticked.connect(self._tick)
        self.form.changed.connect(self._form_changed)
        self.form.file_wanted.connect(self._other_file)
        self.axes.changed.connect(lambda graph, what: self._change(graph, f"axes {what}"))
        self.sources.changed.connect(self._come)
        self.sources.progress.connect(self._show_progress)
        self.cancel_button.clicked.connect(self.sources.cancel)
        self.plot.points_changed.connect(self._show_readout)
        self.plot.part_changed.connect(lambda: self.back_button.setEnabled(self.plot.can_go_back))

    # -- layout ---------------------------------------------------------------------------------------------

    def _parts(self) -> QSplitter:
        self._parted = QSplitter(Qt.Orientation.Horizontal, childrenCollapsible=False)
        side = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False)
        side.addWidget(self.rows)
        self.tabs = QTabWidget(documentMode=True)
        for form, text in ((self.form, "Curve"), (self.axes, "Axes and title")):
            area = QScrollArea(widgetResizable=True)
            area.setFrameShape(QFrame.Shape.NoFrame)
            area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            area.setWidget(form)
            area.setMinimumSize(LEAST_SIDE, LEAST_HEIGHT)
            self.tabs.addTab(area, text)
        side.addWidget(self.tabs)
        side.setStretchFactor(1, 1)
        self._parted.addWidget(side)
        right = QWidget()
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        tools = self._tools()
        tools.setMinimumWidth(1)  # beside wide docks what is on the right is cut off rather than the docks pushed away
        column.addWidget(tools)
        column.addWidget(self._strip)
        column.addWidget(self.plot, 1)
        strip = QHBoxLayout()
        strip.setContentsMargins(8, 3, 8, 4)
        strip.addWidget(self.readout, 1)
        column.addLayout(strip)
        self._parted.addWidget(right)
        self._parted.setStretchFactor(1, 1)
        self._parted.setSizes([SIDE_WIDTH, 3 * SIDE_WIDTH])
        line = QHBoxLayout(self._strip)
        line.setContentsMargins(6, 2, 6, 2)
        self._part_done.setRange(0, 100)
        self._part_done.setFixedHeight(14)
        line.addWidget(self._read_text)
        line.addWidget(self._part_done, 1)
        line.addWidget(self.cancel_button)
        self._strip.hide()
        return self._parted

    def _tools(self) -> TwoGroups:
        self.open_button = list_button(
            "Files …", "open", "Draw tables (CSV, text) and other designs, too", self.open_files
        )
        self.back_button = list_button("Back", "undo", "The part that was shown before (Backspace)", self.plot.back)
        self.all_button = list_button("All", "fit", "Show all of the graph (double click)", self.plot.show_all)
        self.back_button.setEnabled(False)
        tip = "Graphs that this design has ready: paths of points, and of what several drives carry"
        self.ready_button = list_button("Ready graphs", "graph", tip, None)
        self.ready_button.setMenu(QMenu(self))
        self.ready_button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        writing = (
            ("Picture …", "export", "Write the graph as PNG, SVG or PDF", self.export_picture),
            ("Numbers …", "export", "Write the curves as a CSV table", self.export_numbers),
            ("Copy", "duplicate", "Picture and numbers to the clipboard", self.copy_to_clipboard),
        )
        again = ("Read files again", "Also those whose reading was cancelled", self.sources.read_again)
        more = ("Save graph …", "Its curves and axes, to be opened again or drawn by the command line", self.save_graph)
        for text, tip, slot in (again, more, ("Open graph …", "One that was saved", self._open_graph)):
            action = QAction(text, self)
            action.setStatusTip(tip)
            action.triggered.connect(lambda _=False, slot=slot: slot())
            self.open_button.addAction(action)
        self.open_button.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
        seeing = (self.open_button, self.ready_button, self.all_button, self.back_button)
        return TwoGroups(seeing, (list_button(*row) for row in writing), 3)

    # -- what is shown --------------------------------------------------------------------------------------

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those that the curves of the design at hand need, and no others."""
        rows = self._channels()
        wanted = {
            rows[name].stage
            for curve in self.graph.curves
            if curve.shown and not curve.source
            for name in (curve.x, curve.y)
            if name in rows
        }
        return tuple(stage for stage in STAGES if stage in wanted)

    def refresh(self, study: Study) -> None:
        session = self.session
        self.sources.design = DesignSource(session.full_design, "", session.names[session.chosen])
        self._offer_ready()
        self.sources.want(curve.source for curve in self.graph.curves)
        self.found = graph_data(self.graph, self.sources)
        self._draw()

    def _offer_ready(self) -> None:
        """The menu of graphs that the design at hand has ready; each takes the place of the graph, which undo brings back."""
        assert self.sources.design is not None
        rows, menu = ready_graphs(self.sources.design), self.ready_button.menu()
        self.ready_button.setEnabled(bool(rows))
        if [(action.text(), action.statusTip()) for action in menu.actions()] == [(row.text, row.tip) for row in rows]:
            return
        clear_menu(menu)
        for row in rows:
            action = menu.addAction(row.text)
            action.setToolTip(row.tip)
            action.setStatusTip(row.tip)
            action.triggered.connect(partial(self._show_ready, row.name))

    def _show_ready(self, name: str) -> None:
        assert self.sources.design is not None
        graph = next((row.graph for row in ready_graphs(self.sources.design) if row.name == name), None)
        if graph is not None:
            self.row = 0
            self._change(graph)

    def follow(self, theta: float) -> None:
        """A line at the cam angle, where the first curve is drawn over an angle of the design at hand."""
        first = self.graph.curve(self.found.series[0].key) if self.found.series else None
        own = first is not None and not first.source and self.found.x_unit == "°"
        over = first.x if first is not None else ""
        angle = {
            "": theta,
            f"{self.session.design.drive.angle_name}_deg".replace(" ", "_"): theta,
            MACHINE: self.player.machine,
        }.get(over)
        self.plot.show_angle(degrees(angle) % 360.0 if own and angle is not None else None)

    def _come(self) -> None:
        """Something of a file is new."""
        self._stale = True
        self._pull_if_seen()

    def _draw(self) -> None:
        waits = " ".join(dict.fromkeys(({**self.found.faults, **self.found.missing}).values()))
        drawn = [
            replace(curve, name="", colour="", width=1.0, dash="solid", mark="none")
            for curve in self.graph.curves
            if curve.shown
        ]
        keep, self._drawn_rows = drawn == self._drawn_rows, drawn
        self.plot.show_graph(self.graph, self.found, keep, waits or "Add a curve, or drop a table here", self._made())
        if self._kept_part and not self.sources.reading:
            part, self._kept_part = self._kept_part, {}
            self.plot.take_part(part)
        self.row = min(max(self.row, 0), len(self.graph.curves) - 1)
        self._show_rows()
        own = {"x": AxisSays(self.found.x_title, self.found.x_unit)}
        for side in ("left", "right"):
            at = next((i for i, axis in enumerate(self.found.axes) if axis.side == side), None)
            if at is not None:
                rung = self.plot.rungs[at]
                own[side] = AxisSays(self.found.axes[at].title, rung.symbol, rung.size)
        self.axes.show_graph(self.graph, {axis: own.get(axis, AxisSays()) for axis in AXES})
        self._show_readout()
        self.back_button.setEnabled(self.plot.can_go_back)

    def _made(self) -> Shaded:
        """Between which values machines lie, of the curves over the cam angle of the drive at hand."""
        session, rows = self.session, self._channels()
        own = {session.names[session.chosen], ""}
        angles = {"", session.study.angle_column}
        wanted = {
            i: rows[curve.y]
            for i, each in enumerate(self.found.series)
            if (curve := self.graph.curve(each.key)) is not None
            and not (curve.source or curve.minus)
            and curve.drive in own
            and curve.x in angles
            and curve.y in rows
        }
        found, made = self.bands.read(list(wanted.values())), {}
        for i, row in wanted.items():
            if row.slug in found:
                x, band = closed_band(found[row.slug], gain_per_turn(self.session.study, row.name) / row.unit.factor)
                each = self.found.series[i]
                made[i] = (
                    x * conversion_factor("°", each.x_unit),
                    band * conversion_factor(row.unit.symbol, each.y_unit),
                )
        return made

    def _channels(self) -> dict[str, Quantity]:
        """Those of the design at hand, by column and by name."""
        return {name: row for row in channels(self.session.design) for name in (row.slug, row.name)}

    def _show_rows(self) -> None:
        by_key: dict[str, tuple[int, Series]] = {}
        for i, each in enumerate(self.found.series):
            by_key.setdefault(each.key, (i, each))
        rows = []
        for number, curve in enumerate(self.graph.curves, 1):
            drawn = by_key.get(curve.key)
            name = drawn[1].name if drawn and not curve.name else name_of_row(curve)
            if first := self._first_of_all(curve):
                name = name.replace(f", {first}", ", all drives", 1)
            colour = self.plot.colour(drawn[0]) if drawn else ""
            fault, lacking = (texts.get(curve.key, "") for texts in (self.found.faults, self.found.missing))
            note = lacking or self._note(curve)
            rows.append(
                CurveRow(f"{number}  {name}", colour, curve.shown, "" if lacking else fault, note, bool(lacking))
            )
        self.rows.show_rows(rows, self.row)
        there = 0 <= self.row < len(rows)
        self.form.setEnabled(there)
        curve = self.graph.curves[self.row] if there else GraphCurve(y=FIRST)
        fault, note = (rows[self.row].fault, rows[self.row].note) if there else ("", EMPTY)
        self.form.show_curve(self.graph, curve, self.sources.names, self.sources, fault, note)

    def _first_of_all(self, curve: GraphCurve) -> str:
        """The drive that comes first, where a curve stands for all; else empty."""
        design = None if curve.source or curve.drive != ALL else self.sources.design
        return design.drives[0] if design is not None and design.drives else ""

    def _note(self, curve: GraphCurve) -> str:
        """What was left out of it, and why it may be out of date."""
        lines = (self.sources.note(curve.source), *self.found.notes.get(curve.key, ()))
        return "\n".join(line for line in lines if line)

    def _show_progress(self, name: str, part: float) -> None:
        self._strip.setVisible(bool(name))
        self._read_text.setText(f"Reading {name}")
        self._part_done.setValue(round(100.0 * part))

    def _show_readout(self) -> None:
        """The points of the data cursor, and what lies between them."""
        points, found = self.plot.points, self.found
        parts = []
        for letter, point in zip(LETTERS, points, strict=False):
            axis = self.plot.axis_of(point.series)
            rung = self.plot.rungs[axis]
            y = with_unit(short(point.y / rung.size, 6), rung.symbol) if isfinite(point.y) else "no value"
            turned = angle_at(found, point)
            at = f" at {short(turned, 6)}°{self._on_path(point, turned)}" if isfinite(turned) else ""
            parts.append(
                f"{letter}: {with_unit(short(point.x, 6), found.x_unit)}, {y} ({found.series[point.series].name}){at}"
            )
        if len(points) == 2:
            apart = point_distance(found, *points)
            parts.append(f"Δx {with_unit(short(apart.x, 6), found.x_unit)}")
            if isfinite(apart.y):
                rung = self.plot.rungs[self.plot.axis_of(points[0].series)]
                parts.append(f"Δy {with_unit(short(apart.y / rung.size, 6), rung.symbol)}")
                per = f"{rung.symbol}/{found.x_unit}" if found.x_unit else rung.symbol
                parts += [f"slope {short(apart.slope / rung.size, 6)} {per}".strip()] if isfinite(apart.slope) else []
            else:
                parts.append("Δy: the curves are in different units")
        self.readout.show_text(
            "     ".join(parts) or "Click on a curve for its value, on a second place for the difference; drag to zoom"
        )

    def _on_path(self, point: GraphPoint, angle: float) -> str:
        """Speed and acceleration there, where the curve is a path."""
        curve = self.graph.curve(self.found.series[point.series].key)
        rows = path_values(self.sources(curve.source), curve, angle) if curve is not None else ()
        found = [(row.name, row.value, readable(row.unit, abs(row.value))) for row in rows]
        return "".join(f", {name} {with_unit(short(value / rung.size, 6), rung.symbol)}" for name, value, rung in found)

    @property
    def busy(self) -> bool:
        return super().busy or self.sources.busy

    def leave(self) -> None:
        self._keep()
        self.sources.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._keep()

    # -- changes --------------------------------------------------------------------------------------------

    def _change(self, graph: Graph, what: str = "") -> None:
        """Another graph, as a step that can be taken back; steps of the same kind one after the other are one."""
        if graph != self.graph:
            self.stack.push(UndoStep(self._put, self.graph, graph, what, what, self._gesture))

    def _put(self, graph: Graph, *, restored: bool) -> None:
        self.graph = graph
        self._keep()
        self._stale = True
        self.pull()

    def undo(self) -> None:
        """The graph before its last change."""
        self._gesture += 1
        self.stack.undo()

    def redo(self) -> None:
        self._gesture += 1
        self.stack.redo()

    def add_channel(self) -> None:
        """One more of the design at hand."""
        self._add(GraphCurve(y=self._first_channel()))

    def show_channel(self, name: str) -> None:
        """Choose the curve of this channel of the design at hand; where none is drawn, one more."""
        self.pull()
        slug = quantity(name).slug
        row = next(
            (i for i, curve in enumerate(self.graph.curves) if curve.y in (name, slug) and not curve.source), None
        )
        if row is None:
            self._add(GraphCurve(y=slug))
        else:
            self._choose(row)

    def _first_channel(self) -> str:
        names = {name for row in channels(self.session.design) for name in (row.slug, row.name)}
        taken = {curve.y for curve in self.graph.curves if not curve.source}
        usual = [name for name in (FIRST, "velocity", "acceleration", "jerk") if name in names]
        return next(
            (name for name in usual if name not in taken), (usual or [channels(self.session.design)[0].slug])[0]
        )

    def add_difference(self) -> None:
        """The chosen curve less the one before it, or behind it."""
        if len(self.graph.curves) < 2:
            self.status_message.emit("A difference wants two curves: add another one first")
            return
        kinds = {each.key: quantity_kind(each.y_unit) for each in self.found.series}
        others = [curve for curve in self.graph.curves if curve is not self.graph.curves[self.row]]
        alike = [curve for curve in others if kinds.get(curve.key) == kinds.get(self.graph.curves[self.row].key)]
        other = (alike or others)[0]
        self._add(replace(self.graph.curves[self.row], minus=other.key, name="", colour=""))

    def _add(self, curve: GraphCurve) -> None:
        self.row = len(self.graph.curves)
        self._change(add_curve(self.graph, curve))

    def add_files(self, paths: list[Path]) -> None:
        """The second column of tables, the displacement or the first channel of designs; the others are chosen in the form."""
        graph = self.graph
        for path in paths:
            if path.name.endswith(ENDING):
                self._change(self._opened(path))
                return
            graph = add_curve(graph, GraphCurve(source=str(path.absolute())))
        self.row = len(graph.curves) - 1
        self._change(graph)

    def open_files(self) -> None:
        """Ask for tables and designs to be drawn."""
        paths = dialogs.graph_files_to_open(self, Settings().folder)
        if paths:
            Settings().folder = paths[0].parent
            self.add_files(paths)

    def _other_file(self) -> None:
        """Another file for the chosen row."""
        paths = dialogs.graph_files_to_open(self, Settings().folder)
        if paths:
            curve = self.graph.curves[self.row]
            self._form_changed(
                replace(curve, source=str(paths[0].absolute()), x="", y="", x_unit="", y_unit="", drive=""), "source"
            )

    def copy(self) -> None:
        """The chosen row once more."""
        if self.graph.curves:
            row, self.row = self.row, self.row + 1
            self._change(copy_curve(self.graph, row))

    def remove(self) -> None:
        if self.graph.curves:
            self._change(remove_curve(self.graph, self.row))

    def _move_row(self, step: int) -> None:
        to = self.row + step
        if 0 <= to < len(self.graph.curves):
            row, self.row = self.row, to
            self._change(move_curve(self.graph, row, to))

    def _choose(self, row: int) -> None:
        if row != self.row and row >= 0:
            self.row = row
            self._gesture += 1
            self._show_rows()

    def _tick(self, row: int, on: bool) -> None:
        self.row = row
        self._change(with_curve(self.graph, row, replace(self.graph.curves[row], shown=on)))

    def _form_changed(self, curve: GraphCurve, what: str) -> None:
        try:
            self._change(with_curve(self.graph, self.row, curve), f"{curve.key} {what}" if what == "width" else "")
        except KindynaError as error:
            self._show_rows()
            self.form.fault.show_message(str(error))

    # -- from run to run ------------------------------------------------------------------------------------

    def _folder(self) -> Path | None:
        return self.session.path.absolute().parent if self.session.path is not None else None

    def _keep(self) -> None:
        folder = self._folder()
        part = self._kept_part or self.plot.part
        data = {"folder": str(folder or ""), "graph": to_data(with_relative_paths(self.graph, folder)), "part": part}
        Settings().graph = json.dumps(data)

    def _kept(self) -> Graph:
        """The graph of the last run; its files beside the design at hand where they are there, else where they were."""
        usual = add_curve(Graph(), GraphCurve(y=self._begin_with()))
        try:
            data = bounded_json(Settings().graph or "{}")
        except ValueError:
            return usual
        if not isinstance(data, dict) or "graph" not in data:
            return usual
        part = data.get("part")
        self._kept_part = part if isinstance(part, dict) else {}
        graph, before = from_data(data["graph"]), Path(str(data.get("folder") or "."))
        here = self._folder()
        curves = []
        for curve in graph.curves:
            places = [folder / curve.source for folder in (here, before) if folder is not None and curve.source]
            found = next((place for place in places if place.exists()), places[-1] if places else None)
            curves.append(replace(curve, source=str(found.absolute()) if found is not None else ""))
        return replace(graph, curves=tuple(curves))

    def _begin_with(self) -> str:
        rows = channels(self.session.design)
        return FIRST if any(row.name == FIRST for row in rows) else rows[0].slug

    def save_graph(self) -> None:
        """Its rows and axes as a file."""
        path = dialogs.graph_to_save(self, Settings().folder / f"graph{ENDING}")
        if path is None:
            return
        try:
            save_setup(self.graph, path)
        except KindynaError as error:
            dialogs.show_faults(self, f"{path.name} cannot be written.", str(error).splitlines())
            return
        self.status_message.emit(f"Wrote {path}")

    def _open_graph(self) -> None:
        path = dialogs.graph_to_open(self, Settings().folder)
        if path is not None:
            self._change(self._opened(path))

    def _opened(self, path: Path) -> Graph:
        try:
            return load_setup(path)
        except KindynaError as error:
            dialogs.show_faults(self, f"{path.name} cannot be opened.", str(error).splitlines())
            return self.graph

    # -- out ------------------------------------------------------------------------------------------------

    @property
    def no_picture(self) -> str:
        return super().no_picture or ("" if self.found.series else "No curve is drawn; add one first.")

    def picture(self, ending: str) -> bytes:
        """What is shown of the graph, without its points."""
        from kindyna_gui.pictures.paper.sheets import graph_file

        width, height = max(self.plot.width(), 480), max(self.plot.height(), 320)
        name = self.graph.title or self.session.full_design.name
        return graph_file(
            GraphImage(self.graph, self.found, ending, width, height, name), self.plot.shown, self.plot.bands
        )

    def export_picture(self) -> None:
        """Ask for a file, and write the graph into it as a picture."""
        save_picture(self, "graph", dialogs.graph_picture_to_save)

    def export_numbers(self) -> None:
        """Ask for a file, and write the curves into it as a table."""
        if not self.found.series:
            dialogs.show_faults(self, "There are no numbers to export.", [self.no_picture])
            return
        found = self.found
        path = dialogs.table_to_save(self, Settings().folder / "graph.csv")
        text = written(self, path, lambda: numbers_csv(found))
        if text:
            self.status_message.emit(text)

    def copy_to_clipboard(self) -> None:
        """The picture for documents, the numbers for tables."""
        if not self.found.series:
            self.status_message.emit(self.no_picture)
            return
        from kindyna_gui.background import in_background

        found, picture = self.found, self.plot.grab().toImage()
        numbers = in_background(self, "Copying the numbers", lambda: numbers_csv(found, "\t"))
        if numbers is None:
            self.status_message.emit("Cancelled; the clipboard is as it was")
            return
        data = QMimeData()
        data.setImageData(picture)
        data.setText(numbers)
        QApplication.clipboard().setMimeData(data)
        self.status_message.emit("Picture and numbers of the graph are in the clipboard")

    # -- files that are dropped, keys -----------------------------------------------------------------------

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            event.acceptProposedAction()
            self.add_files(paths)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Undo and redo in the list are those of the graph."""
        if watched is self.rows.list and isinstance(event, QKeyEvent):
            for keys, slot in ((QKeySequence.StandardKey.Undo, self.undo), (QKeySequence.StandardKey.Redo, self.redo)):
                if event.matches(keys):
                    event.accept()
                    if event.type() == QEvent.Type.KeyPress:
                        slot()
                    return True
        return super().eventFilter(watched, event)


__all__ = ["CurvesView"]
