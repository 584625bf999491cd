"""Page Curves: columns of tables and designs on one graph, with the list of curves, forms, and export."""

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
from core.design import drive_names
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
from kindyna_gui.documents.pins import Bands, Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.load_rows import TwoGroups, list_button
from kindyna_gui.graph.curve_form import (
    AXES,
    EMPTY,
    AxesForm,
    AxisDefaults,
    CurveForm,
    CurveRow,
    CurveRows,
    name_of_row,
)
from kindyna_gui.graph.graph_choice import GraphSources
from kindyna_gui.graph.live_graph import LiveGraph
from kindyna_gui.look import SteadyText, text_button
from kindyna_gui.pictures.plots.graph import POINT_NAMES, Dashed
from kindyna_gui.pictures.plots.graph import Bands as CurveBands
from kindyna_gui.pictures.plots.lines import closed_band
from kindyna_gui.pictures.units import readable, short, with_unit
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import clear_menu
from kindyna_gui.saving import save_picture, written
from kindyna_gui.settings import Settings
from kindyna_gui.view import View

SIDE_WIDTH = 330  # pixels
MOST_STEPS = 200  # of undo
LEAST_SIDE, LEAST_HEIGHT = 309, 60  # pixels of a form before it scrolls
LEAST_TOOLS = 335  # width of the buttons in two rows [pixels]
FIRST = "displacement"  # channel of a new graph, if the design has it


class CurvesView(View):
    """The page Curves. Its graph belongs to the window, not to the design, and is restored at the next start."""

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self._saved_part: dict[str, Any] = {}  # visible part of the last run, restored once all files are read
        self.graph, self.row = self._saved_graph(), 0
        self.data = GraphData((), (), "", "", {}, {}, {})
        self.sources = GraphSources(self)
        self.stack = QUndoStack(self)
        self.stack.setUndoLimit(MOST_STEPS)
        self._gesture = 0  # steps of the same kind within a gesture are one
        self._drawn_rows: list[GraphCurve] = []
        self.plot = LiveGraph()
        self.bands, self.pins = Bands.of(session), Pins.of(session)
        for others in (self.bands, self.pins):
            others.changed.connect(self.invalidate)
        slots: dict[str, Callable[[], object]] = {
            "copy": self.copy, "remove": self.remove, "up": lambda: self._move_row(-1), "down": lambda: self._move_row(1),
            "undo": self.undo, "redo": self.redo,
        }  # fmt: skip
        additions: tuple[tuple[str, str, Callable[[], object]], ...] = (
            ("Channel of this design", "Add a curve of the current design; choose its channel below", self.add_channel),
            ("Curves of a file …", "Add curves of a table (CSV, text) or of another design (.toml)", self.open_files),
            ("Difference", "Subtract another curve from the selected one; choose it below", self.add_difference),
        )
        self.rows = CurveRows(slots, additions)
        self.stack.canUndoChanged.connect(self.rows.buttons["undo"].setEnabled)
        self.stack.canRedoChanged.connect(self.rows.buttons["redo"].setEnabled)
        self.form, self.axes = CurveForm(), AxesForm()
        self.readout = SteadyText()
        self._progress_bar, self._progress_row = QProgressBar(textVisible=True), QWidget()
        self._progress_text = QLabel()
        self.cancel_button = text_button("Cancel")
        self._lay_out()
        self.setAcceptDrops(True)
        self.rows.list.installEventFilter(self)
        self._connect()

    def _connect(self) -> None:
        self.rows.selected.connect(self._choose)
        self.rows.ticked.connect(self._tick)
        self.form.changed.connect(self._form_changed)
        self.form.file_requested.connect(self._replace_file)
        self.axes.changed.connect(lambda graph, what: self._change(graph, f"axes {what}"))
        self.sources.changed.connect(self._update)
        self.sources.progress.connect(self._show_progress)
        self.cancel_button.clicked.connect(self.sources.cancel)
        self.plot.points_changed.connect(self._show_readout)
        self.plot.part_changed.connect(lambda: self.back_button.setEnabled(self.plot.can_go_back))

    # -- layout ---------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        """Lay out the page from outside in: a widget that is put into another one takes its style again, with all inside."""
        self._splitter = QSplitter(Qt.Orientation.Horizontal, childrenCollapsible=False)
        self.set_column(self._splitter, grows=self._splitter)
        side, right = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False), QWidget()
        self._splitter.addWidget(side)
        self._splitter.addWidget(right)
        self._splitter.setStretchFactor(1, 1)
        self._splitter.setSizes([SIDE_WIDTH, 3 * SIDE_WIDTH])
        self.tabs = QTabWidget(documentMode=True)
        side.addWidget(self.rows)
        side.addWidget(self.tabs)
        side.setStretchFactor(1, 1)
        for form, text in ((self.form, "Curve"), (self.axes, "Axes and title")):
            area = QScrollArea(widgetResizable=True)
            area.setFrameShape(QFrame.Shape.NoFrame)
            area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            area.setMinimumSize(LEAST_SIDE, LEAST_HEIGHT)
            self.tabs.addTab(area, text)
            area.setWidget(form)
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        tools = self._tools()
        tools.setMinimumWidth(LEAST_TOOLS)
        column.addWidget(tools)
        column.addWidget(self._progress_row)
        column.addWidget(self.plot, 1)
        bottom = QHBoxLayout()
        bottom.setContentsMargins(8, 3, 8, 4)
        bottom.addWidget(self.readout, 1)
        column.addLayout(bottom)
        line = QHBoxLayout(self._progress_row)
        line.setContentsMargins(6, 2, 6, 2)
        self._progress_bar.setRange(0, 100)
        self._progress_bar.setFixedHeight(14)
        line.addWidget(self._progress_text)
        line.addWidget(self._progress_bar, 1)
        line.addWidget(self.cancel_button)
        self._progress_row.hide()

    def _tools(self) -> TwoGroups:
        self.open_button = list_button(
            "Files …", "open", "Add curves of tables (CSV, text) and of other designs", self.open_files
        )
        self.back_button = list_button("Back", "undo", "Undo one step of zooming (Backspace)", self.plot.back)
        self.all_button = list_button("All", "fit", "Show the complete graph (double click)", self.plot.show_all)
        self.back_button.setEnabled(False)
        tip = "Graphs prepared for this design: paths of points, and of a part moved by several drives"
        self.ready_button = list_button("Ready graphs", "graph", tip, None)
        self.ready_button.setMenu(QMenu(self))
        self.ready_button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        export = (
            ("Picture …", "export", "Write the graph as PNG, SVG or PDF", self.export_picture),
            ("Numbers …", "export", "Write the curves as a CSV table", self.export_numbers),
            ("Copy", "duplicate", "Copy image and numbers to the clipboard", self.copy_to_clipboard),
        )
        entries: tuple[tuple[str, str, Callable[[], object]], ...] = (
            ("Read files again", "Read all files again, also those that were cancelled", self.sources.read_again),
            ("Save graph …", "Save curves and axes as a file, also for the command graph", self.save_graph),
            ("Open graph …", "Open a saved graph", self._open_graph),
        )
        for text, tip, slot in entries:
            action = QAction(text, self)
            action.setStatusTip(tip)
            action.triggered.connect(lambda _=False, slot=slot: slot())
            self.open_button.addAction(action)
        self.open_button.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
        display = (self.open_button, self.ready_button, self.all_button, self.back_button)
        return TwoGroups(display, (list_button(*row) for row in export), 3)

    # -- display --------------------------------------------------------------------------------------------

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Stages that the curves of the current design need."""
        rows = self._channels()
        needed = {
            rows[name].stage
            for curve in self.graph.curves
            if curve.shown and not curve.source
            for name in (curve.x, curve.y)
            if name in rows
        }
        return tuple(stage for stage in STAGES if stage in needed)

    def refresh(self, study: Study) -> None:
        session = self.session
        self.sources.design = DesignSource(session.full_design, "", session.names[session.chosen])
        self._fill_ready_menu()
        self.sources.request(curve.source for curve in self.graph.curves)
        self.data = graph_data(self.graph, self.sources)
        self._draw()

    def _fill_ready_menu(self) -> None:
        """Fill the menu of graphs prepared for the current design."""
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
        """Mark the cam angle if the first curve is drawn over an angle of the current design."""
        curve = self.graph.curve(self.data.series[0].key) if self.data.series else None
        angle = None
        if curve is not None and not curve.source and self.data.x_unit == "°":
            cam_column = f"{self.session.design.drive.angle_name}_deg".replace(" ", "_")
            angle = {"": theta, cam_column: theta, MACHINE: self.player.machine}.get(curve.x)
        self.plot.show_angle(None if angle is None else degrees(angle) % 360.0)

    def _update(self) -> None:
        """Refresh with what is new of the files."""
        self._stale = True
        self._pull_if_seen()

    def _draw(self) -> None:
        faults = " ".join(dict.fromkeys(({**self.data.faults, **self.data.missing}).values()))
        drawn = [
            replace(curve, name="", colour="", width=1.0, dash="solid", mark="none")
            for curve in self.graph.curves
            if curve.shown
        ]
        keep_range, self._drawn_rows = drawn == self._drawn_rows, drawn
        message = faults or "Add a curve, or drop a table here"
        bands, pinned = self._tolerance_bands(), self._pinned_curves()
        self.plot.show_graph(self.graph, self.data, keep_range, message, bands, pinned)
        if self._saved_part and not self.sources.reading:
            part, self._saved_part = self._saved_part, {}
            self.plot.restore_part(part)
        self.row = min(max(self.row, 0), len(self.graph.curves) - 1)
        self._show_rows()
        defaults = {"x": AxisDefaults(self.data.x_title, self.data.x_unit)}
        for axis, display_unit in zip(self.data.axes, self.plot.display_units, strict=False):
            defaults.setdefault(axis.side, AxisDefaults(axis.title, display_unit.symbol, display_unit.size))
        self.axes.show_graph(self.graph, {name: defaults.get(name, AxisDefaults()) for name in AXES})
        self._show_readout()
        self.back_button.setEnabled(self.plot.can_go_back)

    def _pinned_curves(self) -> Dashed | None:
        """Curves of the pinned variant, those of channels of the current design alone."""
        front = self.pins.front
        rows = tuple(curve for curve in self.graph.curves if not curve.source and not curve.minus)
        if front is None or not rows:
            return None
        names = drive_names(front.design)
        chosen = self.session.names[self.session.chosen]
        source = DesignSource(front.design, "", chosen if chosen in names else names[0])
        return graph_data(replace(self.graph, curves=rows), lambda _: source), front.name

    def _tolerance_bands(self) -> CurveBands:
        """Bands of machines for the curves of the selected drive over the cam angle."""
        session, rows = self.session, self._channels()
        drives = {session.names[session.chosen], ""}
        angles = {"", session.study.angle_column}
        quantities = {
            i: rows[curve.y]
            for i, series in enumerate(self.data.series)
            if (curve := self.graph.curve(series.key)) is not None
            and not (curve.source or curve.minus)
            and curve.drive in drives
            and curve.x in angles
            and curve.y in rows
        }
        bands, result = self.bands.read(list(quantities.values())), {}
        for i, row in quantities.items():
            if row.slug in bands:
                x, band = closed_band(bands[row.slug], gain_per_turn(self.session.study, row.name) / row.unit.factor)
                series = self.data.series[i]
                result[i] = (
                    x * conversion_factor("°", series.x_unit),
                    band * conversion_factor(row.unit.symbol, series.y_unit),
                )
        return result

    def _channels(self) -> dict[str, Quantity]:
        """Channels of the current design, by column and by name."""
        return {name: row for row in channels(self.session.design) for name in (row.slug, row.name)}

    def _show_rows(self) -> None:
        by_key: dict[str, tuple[int, Series]] = {}
        for i, series in enumerate(self.data.series):
            by_key.setdefault(series.key, (i, series))
        rows = []
        for number, curve in enumerate(self.graph.curves, 1):
            drawn = by_key.get(curve.key)
            name = drawn[1].name if drawn and not curve.name else name_of_row(curve)
            design = None if curve.source or curve.drive != ALL else self.sources.design
            if design is not None and design.drives:
                name = name.replace(f", {design.drives[0]}", ", all drives", 1)
            colour = self.plot.colour(drawn[0]) if drawn else ""
            fault, missing = (texts.get(curve.key, "") for texts in (self.data.faults, self.data.missing))
            notes = (self.sources.note(curve.source), *self.data.notes.get(curve.key, ()))
            note = missing or "\n".join(filter(None, notes))
            rows.append(
                CurveRow(f"{number}  {name}", colour, curve.shown, "" if missing else fault, note, bool(missing))
            )
        self.rows.show_rows(rows, self.row)
        is_selected = 0 <= self.row < len(rows)
        self.form.setEnabled(is_selected)
        curve = self.graph.curves[self.row] if is_selected else GraphCurve(y=FIRST)
        fault, note = (rows[self.row].fault, rows[self.row].note) if is_selected else ("", EMPTY)
        self.form.show_curve(self.graph, curve, self.sources.names, self.sources, fault, note)

    def _show_progress(self, name: str, part: float) -> None:
        self._progress_row.setVisible(bool(name))
        self._progress_text.setText(f"Reading {name}")
        self._progress_bar.setValue(round(100.0 * part))

    def _show_readout(self) -> None:
        """Show the values of points A and B, and their differences."""
        points, data = self.plot.points, self.data
        parts = []
        for letter, point in zip(POINT_NAMES, points, strict=False):
            axis = self.plot.axis_of(point.series)
            display_unit = self.plot.display_units[axis]
            y = (
                with_unit(short(point.y / display_unit.size, 6), display_unit.symbol)
                if isfinite(point.y)
                else "no value"
            )
            angle = angle_at(data, point)
            at = f" at {short(angle, 6)}°{self._path_text(point, angle)}" if isfinite(angle) else ""
            parts.append(
                f"{letter}: {with_unit(short(point.x, 6), data.x_unit)}, {y} ({data.series[point.series].name}){at}"
            )
        if len(points) == 2:
            distance = point_distance(data, *points)
            parts.append(f"Δx {with_unit(short(distance.x, 6), data.x_unit)}")
            if isfinite(distance.y):
                display_unit = self.plot.display_units[self.plot.axis_of(points[0].series)]
                parts.append(f"Δy {with_unit(short(distance.y / display_unit.size, 6), display_unit.symbol)}")
                unit = f"{display_unit.symbol}/{data.x_unit}" if data.x_unit else display_unit.symbol
                if isfinite(distance.slope):
                    parts.append(f"slope {short(distance.slope / display_unit.size, 6)} {unit}".strip())
            else:
                parts.append("Δy: the curves are in different units")
        self.readout.show_text(
            "     ".join(parts) or "Click on a curve for its value, on a second point for the difference; drag to zoom"
        )

    def _path_text(self, point: GraphPoint, angle: float) -> str:
        """Speed and acceleration at a point of a path; empty for other curves."""
        curve = self.graph.curve(self.data.series[point.series].key)
        rows = path_values(self.sources(curve.source), curve, angle) if curve is not None else ()
        display_units = [readable(row.unit, abs(row.value)) for row in rows]
        return "".join(
            f", {row.name} {with_unit(short(row.value / display_unit.size, 6), display_unit.symbol)}"
            for row, display_unit in zip(rows, display_units, strict=True)
        )

    @property
    def busy(self) -> bool:
        return super().busy or self.sources.busy

    def leave(self) -> None:
        self._save_state()
        self.sources.close()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._save_state()

    # -- changes --------------------------------------------------------------------------------------------

    def _change(self, graph: Graph, what: str = "") -> None:
        """Change the graph, as a step of undo; successive steps of the same kind are one."""
        if graph != self.graph:
            self.stack.push(UndoStep(self._put, self.graph, graph, what, what, self._gesture))

    def _put(self, graph: Graph, *, restored: bool) -> None:
        self.graph = graph
        self._save_state()
        self._stale = True
        self.pull()

    def undo(self) -> None:
        """Undo the last change of the graph."""
        self._gesture += 1
        self.stack.undo()

    def redo(self) -> None:
        """Redo the change that was undone last."""
        self._gesture += 1
        self.stack.redo()

    def add_channel(self) -> None:
        """Add a curve of the current design."""
        self._add(GraphCurve(y=self._next_channel()))

    def show_channel(self, name: str) -> None:
        """Select the curve of a channel of the current design; add it if there is none."""
        self.pull()
        slug = quantity(name).slug
        row = next(
            (i for i, curve in enumerate(self.graph.curves) if curve.y in (name, slug) and not curve.source), None
        )
        if row is None:
            self._add(GraphCurve(y=slug))
        else:
            self._choose(row)

    def _next_channel(self) -> str:
        """First of the typical channels that is not drawn yet."""
        drawn = {curve.y for curve in self.graph.curves if not curve.source}
        known = self._channels()
        typical = [name for name in (FIRST, "velocity", "acceleration", "jerk") if name in known]
        return next((name for name in typical if name not in drawn), (typical or list(known))[0])

    def add_difference(self) -> None:
        """Add the difference between the selected curve and the first other one, of the same kind if possible."""
        if len(self.graph.curves) < 2:
            self.status_message.emit("A difference needs two curves: add another one first")
            return
        kinds = {series.key: quantity_kind(series.y_unit) for series in self.data.series}
        selected = self.graph.curves[self.row]
        candidates = [curve for curve in self.graph.curves if curve is not selected]
        same_kind = [curve for curve in candidates if kinds.get(curve.key) == kinds.get(selected.key)]
        self._add(replace(selected, minus=(same_kind or candidates)[0].key, name="", colour=""))

    def _add(self, curve: GraphCurve) -> None:
        self.row = len(self.graph.curves)
        self._change(add_curve(self.graph, curve))

    def add_files(self, paths: list[Path]) -> None:
        """Add the second column of tables, and the displacement or the first channel of designs."""
        graph = self.graph
        for path in paths:
            if path.name.endswith(ENDING):
                self._change(self._load(path))
                return
            graph = add_curve(graph, GraphCurve(source=str(path.absolute())))
        self.row = len(graph.curves) - 1
        self._change(graph)

    def open_files(self) -> None:
        """Ask for tables and designs, and add their curves."""
        paths = dialogs.graph_files_to_open(self, Settings().folder)
        if paths:
            Settings().folder = paths[0].parent
            self.add_files(paths)

    def _replace_file(self) -> None:
        """Ask for another file for the selected curve."""
        paths = dialogs.graph_files_to_open(self, Settings().folder)
        if paths:
            curve = self.graph.curves[self.row]
            self._form_changed(
                replace(curve, source=str(paths[0].absolute()), x="", y="", x_unit="", y_unit="", drive=""), "source"
            )

    def copy(self) -> None:
        """Duplicate the selected curve."""
        if self.graph.curves:
            row, self.row = self.row, self.row + 1
            self._change(copy_curve(self.graph, row))

    def remove(self) -> None:
        """Remove the selected curve."""
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

    # -- saved graphs ---------------------------------------------------------------------------------------

    def _folder(self) -> Path | None:
        return self.session.path.absolute().parent if self.session.path is not None else None

    def _save_state(self) -> None:
        folder = self._folder()
        part = self._saved_part or self.plot.part
        data = {"folder": str(folder or ""), "graph": to_data(with_relative_paths(self.graph, folder)), "part": part}
        Settings().graph = json.dumps(data)

    def _saved_graph(self) -> Graph:
        """Graph of the last run; its files next to the current design if they exist there, else at their old path."""
        known = self._channels()
        default = add_curve(Graph(), GraphCurve(y=FIRST if FIRST in known else next(iter(known))))
        try:
            data = bounded_json(Settings().graph or "{}")
        except ValueError:
            return default
        if not isinstance(data, dict) or "graph" not in data:
            return default
        part = data.get("part")
        self._saved_part = part if isinstance(part, dict) else {}
        graph, old_folder = from_data(data["graph"]), Path(str(data.get("folder") or "."))
        folders = [folder for folder in (self._folder(), old_folder) if folder is not None]
        curves = []
        for curve in graph.curves:
            paths = [folder / curve.source for folder in folders] if curve.source else []
            path = next((path for path in paths if path.exists()), paths[-1] if paths else None)
            curves.append(replace(curve, source=str(path.absolute()) if path is not None else ""))
        return replace(graph, curves=tuple(curves))

    def save_graph(self) -> None:
        """Ask for a file, and save curves and axes in it."""
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
            self._change(self._load(path))

    def _load(self, path: Path) -> Graph:
        try:
            return load_setup(path)
        except KindynaError as error:
            dialogs.show_faults(self, f"{path.name} cannot be opened.", str(error).splitlines())
            return self.graph

    # -- export ---------------------------------------------------------------------------------------------

    @property
    def no_picture(self) -> str:
        return super().no_picture or ("" if self.data.series else "No curve is drawn: add one first.")

    def picture(self, ending: str) -> bytes:
        """Return the visible part of the graph, without the points, as the content of a file."""
        from kindyna_gui.pictures.paper.sheets import graph_file

        width, height = max(self.plot.width(), 480), max(self.plot.height(), 320)
        name = self.graph.title or self.session.full_design.name
        image = GraphImage(self.graph, self.data, ending, width, height, name)
        return graph_file(image, self.plot.shown, self.plot.bands, self.plot.reference)

    def export_picture(self) -> None:
        """Ask for a file, and write the graph to it as an image."""
        save_picture(self, "graph", dialogs.graph_picture_to_save)

    def export_numbers(self) -> None:
        """Ask for a file, and write the curves to it as a table."""
        if not self.data.series:
            dialogs.show_faults(self, "There are no numbers to export.", [self.no_picture])
            return
        data = self.data
        path = dialogs.table_to_save(self, Settings().folder / "graph.csv")
        text = written(self, path, lambda: numbers_csv(data))
        if text:
            self.status_message.emit(text)

    def copy_to_clipboard(self) -> None:
        """Copy the graph as an image for documents, and its numbers for tables."""
        if not self.data.series:
            self.status_message.emit(self.no_picture)
            return
        from kindyna_gui.background import in_background

        data, image = self.data, self.plot.grab().toImage()
        numbers = in_background(self, "Copying the numbers", lambda: numbers_csv(data, "\t"))
        if numbers is None:
            self.status_message.emit("Cancelled; the clipboard has not changed")
            return
        content = QMimeData()
        content.setImageData(image)
        content.setText(numbers)
        QApplication.clipboard().setMimeData(content)
        self.status_message.emit("Image and numbers of the graph are in the clipboard")

    # -- dropped files, keys --------------------------------------------------------------------------------

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            event.acceptProposedAction()
            self.add_files(paths)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Undo and redo the graph with the keys in the list."""
        if watched is self.rows.list and isinstance(event, QKeyEvent):
            for keys, slot in ((QKeySequence.StandardKey.Undo, self.undo), (QKeySequence.StandardKey.Redo, self.redo)):
                if event.matches(keys):
                    event.accept()
                    if event.type() == QEvent.Type.KeyPress:
                        slot()
                    return True
        return super().eventFilter(watched, event)


__all__ = ["CurvesView"]
