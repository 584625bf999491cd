"""A task as numbers: poses with pivots and area, a path, pairs of angles, or a swing; with the limits of the answers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QFormLayout,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QMenu,
    QPushButton,
    QScrollArea,
    QStackedWidget,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import Info, split_unit
from core.requests import field_info
from core.synthesis import AnglePair, AnglePairs, AnswerLimits, Area, BodyPose, Pivot, Swing, Task, TracedPath
from core.synthesis.task import ANGLES, FIXED, MOST_POSES, MOVING, PATH, POSES, ROCKER, ROCKER_OUTPUT, SLIDER_OUTPUT
from core.synthesis.tasks import TASKS
from core.units import Unit
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import LiveBox, WordBox
from kindyna_gui.forms.refusal import RefusalLine
from kindyna_gui.labels import sentence
from kindyna_gui.look import bold_label, described, scrolled, text_button
from kindyna_gui.rebuilt import STRETCH, add_entry, clear_menu, connect_all, fill, widget_with
from kindyna_gui.settings import symbol_of
from kindyna_gui.synthesis import task_parts
from kindyna_gui.synthesis.task_parts import DEG, MM, PARTS, PIVOT, new_part

FIRST_POSES = (BodyPose(0.0, 0.0, 0.0), BodyPose(60.0, 20.0, 30.0), BodyPose(110.0, 10.0, 60.0))
FIRST_PAIRS = (AnglePair(45.0, 30.0), AnglePair(75.0, 55.0), AnglePair(105.0, 75.0))
BOUNDED = ("transmission_deg_min", "length_ratio_max")
"""Limits of the answers."""
SWING = ("swing_deg", "time_ratio", "frame_mm")
"""Values of a swing."""
DIRECTION = Info("Direction", "empty: the pivot is at this position; a number: it is on the line in this direction", -3600.0, 3600.0,
                 step=1.0, optional=True)  # fmt: skip
DYADS: Mapping[int, str] = {0: "both", 1: "dyad 1", 2: "dyad 2"}
OF: Mapping[str, str] = {FIXED: "fixed", MOVING: "moving"}
NO_PATH = "Draw the path on the drawing, or open a file with its points"
POINT_TIP = "Take the path of a point of the present linkage as the task"
INDENT = 14  # of the numbers of a pivot, pixels
Boxes = list[LiveBox]


class PivotRow(QWidget):
    """Boxes of a pivot: its dyad, fixed or moving, position, and the direction of its line. Signals: ``changed``, ``removed``."""

    changed = Signal()
    removed = Signal()

    def __init__(self, number: int) -> None:
        super().__init__()
        self.dyad = described(
            WordBox(), name=f"Dyad of pivot {number}", tip="The pivot belongs to this dyad, or to both"
        )
        self.of = described(
            WordBox(),
            name=f"Kind of pivot {number}",
            tip="Fixed: given in the frame; moving: given in the frame of the body",
        )
        fill_choices(self.dyad, DYADS)  # type: ignore[arg-type]
        fill_choices(self.of, OF)
        self.boxes = _boxes(Pivot, "x_mm", "y_mm", suffix=f" of pivot {number}")
        self.direction = LiveBox(DIRECTION, DEG, f"Direction of pivot {number}")
        for box, tip in zip(self.all_boxes, ("x of the pivot", "y of the pivot", DIRECTION.help), strict=True):
            box.setToolTip(sentence(tip))
            box.changed.connect(self.changed)
        cross = described(text_button("×", flat=True), name=f"Remove pivot {number}", tip="Remove this pivot")
        connect_all(
            (cross.clicked, lambda *_: self.removed.emit()),
            (self.dyad.activated, lambda *_: self.changed.emit()),
            (self.of.activated, lambda *_: self.changed.emit()),
        )
        words = fill(QHBoxLayout(), QLabel(str(number)), self.of, self.dyad, STRETCH, cross, margins=0, spacing=4)
        values = fill(QHBoxLayout(), *((box, 1) for box in self.all_boxes), margins=(INDENT, 0, 0, 0), spacing=4)
        fill(QVBoxLayout(self), words, values, margins=0, spacing=2)

    @property
    def all_boxes(self) -> Boxes:
        """x, y and direction."""
        return [*self.boxes, self.direction]

    def show_pivot(self, pivot: Pivot) -> None:
        """Show a pivot."""
        self.dyad.setCurrentIndex(self.dyad.findData(pivot.dyad or 0))
        self.of.setCurrentIndex(self.of.findData(pivot.of))
        x, y, direction = pivot.line if len(pivot.line) == 3 else (pivot.x_mm, pivot.y_mm, None)
        _show(self.all_boxes, (x, y, direction))

    @property
    def pivot(self) -> Pivot:
        """The pivot as it is typed."""
        x, y, direction = (box.number for box in self.all_boxes)
        dyad, of = self.dyad.currentData() or None, self.of.currentData()
        if direction is None:
            return Pivot(dyad=dyad, of=of, x_mm=x, y_mm=y)
        return Pivot(dyad=dyad, of=of, line=(x or 0.0, y or 0.0, direction))


class TaskForm(QWidget):
    """The numbers of a task.

    Signals: ``changed`` when the user has edited them; ``curve_requested`` and ``point_requested`` (name) for the points of a path
    from a file, or from a point of the present linkage.
    """

    changed = Signal()
    curve_requested = Signal()
    point_requested = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.kind, self.output = WordBox(), WordBox()
        self.pages: dict[str, QScrollArea] = {}
        self.stack = QStackedWidget()
        self.poses: list[Boxes] = []
        self.pairs: list[Boxes] = []
        self.pivots: list[PivotRow] = []
        self.area = _boxes(Area, "low_x_mm", "low_y_mm", "high_x_mm", "high_y_mm", suffix=" of the area")
        self.swing = _boxes(Swing, *SWING)
        self.frame_mm = _boxes(AnglePairs, "frame_mm")[0]
        self.limits = _boxes(AnswerLimits, *BOUNDED)
        self.closed, self.free, self.order = (
            QCheckBox("&Closed"),
            QCheckBox("Only &differences count"),
            QCheckBox("In this o&rder"),
        )
        self.about_path = QLabel(NO_PATH, wordWrap=True)
        self.message = RefusalLine((0, 2, 0, 2))
        self._pose_grid, self._pair_grid, self._pivot_column = QGridLayout(), QGridLayout(), QVBoxLayout()
        self._headings: list[tuple[QLabel, str, Unit]] = []
        self._labels: list[tuple[QLabel, str, Unit]] = []
        self._pivot_headings, self._area_form = (bold_label("Pivots"), QWidget()), QWidget()
        self._path = TracedPath()
        self._folder = Path()
        self._shows = False
        self._lay_out()
        connect_all(
            (self.kind.activated, self._emit_changed),
            (self.output.activated, self._emit_changed),
            (self.closed.toggled, self._emit_changed),
            (self.free.toggled, self._emit_changed),
            (self.order.toggled, self._emit_changed),
        )
        for box in (*self.swing, self.frame_mm, *self.limits, *self.area):
            box.changed.connect(self._emit_changed)

    # -- layout -------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self.kind.setAccessibleName("Task")
        fill_choices(self.kind, {name: row.title for name, row in TASKS.items()})
        fill_choices(self.output, {ROCKER_OUTPUT: "Rocker, degrees", SLIDER_OUTPUT: "Slider, mm"})
        self.output.setAccessibleName("Output")
        self.add_pose = _button("&Add a pose", self._add_pose)
        self.add_pivot = _button(
            "Add a pi&vot", self._add_pivot, "A pivot at a position or, with a direction, on a line"
        )
        self.add_area = _button("Add an a&rea", self._add_area, "A rectangle in which the fixed pivots lie")
        add_pair = _button("&Add a pair", self._add_pair)
        curve = _button("Points from a &file...", self.curve_requested.emit)
        self.point_button = described(QPushButton("Path of a poi&nt", autoDefault=False), tip=POINT_TIP)
        self.point_button.setMenu(QMenu(self.point_button))
        more = fill(QHBoxLayout(), self.add_pose, self.add_pivot, self.add_area, STRETCH, margins=0)
        pages = {
            POSES: (self._pose_grid, self._pivot_layout(), self._area_layout(), more),
            PATH: (self.about_path, self.closed, fill(QHBoxLayout(), curve, self.point_button, STRETCH, margins=0)),
            ANGLES: (self._angle_form(), self._pair_grid, fill(QHBoxLayout(), add_pair, STRETCH, margins=0), self.free),
            ROCKER: (self._form(*((Swing, name, box) for name, box in zip(SWING, self.swing, strict=True))),),
        }
        for name, parts in pages.items():
            page = widget_with(fill(QVBoxLayout(), *parts, STRETCH, margins=(0, 0, 4, 0), spacing=8))
            self.pages[name] = scrolled(page, sideways=False)
            self.stack.addWidget(self.pages[name])
        self.order.setToolTip("The poses are passed in the order of their numbers, in either direction")
        rows = (
            self.kind,
            (self.stack, 1),
            self.message,
            bold_label("Limits of the linkages"),
            self._form(*((AnswerLimits, name, box) for name, box in zip(BOUNDED, self.limits, strict=True))),
            self.order,
        )
        fill(QVBoxLayout(self), *rows, margins=0, spacing=6)

    def _pivot_layout(self) -> QVBoxLayout:
        row = fill(QHBoxLayout(self._pivot_headings[1]), margins=(INDENT, 0, 0, 0), spacing=4)
        for info in (field_info(Pivot, "x_mm"), field_info(Pivot, "y_mm"), DIRECTION):
            heading = described(QLabel(), tip=sentence(info.help))
            self._headings.append((heading, info.label, DEG if info is DIRECTION else MM))
            row.addWidget(heading, 1)
        return fill(self._pivot_column, *self._pivot_headings, spacing=4)

    def _area_layout(self) -> QWidget:
        grid = QGridLayout()
        grid.setContentsMargins(0, 0, 0, 0)
        grid.addWidget(QLabel("Area of the fixed pivots"), 0, 0, 1, 3)
        cross = described(text_button("×", flat=True), name="Remove the area", tip="Remove the area")
        cross.clicked.connect(lambda *_: self._set_area(None))
        grid.addWidget(cross, 0, 3)
        for k, name in enumerate(("from", "to")):
            grid.addWidget(QLabel(name), k + 1, 0)
            for column, box in enumerate(self.area[2 * k : 2 * k + 2], 1):
                grid.addWidget(box, k + 1, column)
        self._area_form.setLayout(grid)
        return self._area_form

    def _angle_form(self) -> QFormLayout:
        form = self._form((AnglePairs, "frame_mm", self.frame_mm))
        form.insertRow(0, "Output", self.output)
        return form

    def _form(self, *rows: tuple[Any, str, LiveBox]) -> QFormLayout:
        """Form with a row for each field of a part of a task, by its name, with its box."""
        form = QFormLayout()
        form.setVerticalSpacing(4)
        for kind, name, box in rows:
            info, label = field_info(kind, name), QLabel()
            self._labels.append((label, info.label, split_unit(name.removesuffix("_min"))[1]))
            label.setBuddy(box)
            box.setToolTip(sentence(info.help) if info.help else "")
            form.addRow(label, box)
        return form

    def _rows(
        self, grid: QGridLayout, kind: Any, names: tuple[str, ...], count: int, remove: Callable[[int], None]
    ) -> list[Boxes]:
        """Fill a grid with numbered rows of boxes, each with a button that removes it."""
        while item := grid.takeAt(0):
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        self._headings = [row for row in self._headings if row[0].parent() is not grid.parentWidget()]
        rows = []
        for k, name in enumerate(names, 1):
            heading = QLabel()
            self._headings.append((heading, field_info(kind, name).label, split_unit(name)[1]))
            grid.addWidget(heading, 0, k)
        for i in range(count):
            boxes = _boxes(kind, *names, suffix=f" {i + 1}")
            grid.addWidget(QLabel(str(i + 1)), i + 1, 0)
            for k, box in enumerate(boxes, 1):
                box.changed.connect(self._emit_changed)
                grid.addWidget(box, i + 1, k)
            cross: QToolButton = described(text_button("×", flat=True), name=f"Remove {i + 1}", tip="Remove this row")
            cross.clicked.connect(partial(lambda row, *_: remove(row), i))
            grid.addWidget(cross, i + 1, len(names) + 1)
            rows.append(boxes)
        self.show_units()
        return rows

    def show_units(self) -> None:
        """Name the units on display in the headings."""
        for label, text, unit in (*self._headings, *self._labels):
            symbol = symbol_of(unit.symbol)
            label.setText(f"{text}, {symbol}" if symbol else text)

    def offer_points(self, names: Sequence[str]) -> None:
        """Offer the paths of these points of the present linkage."""
        menu = self.point_button.menu()
        assert isinstance(menu, QMenu)
        clear_menu(menu)
        for name in names:
            add_entry(menu, name, partial(self.point_requested.emit, name), f"Take the path of {name} as the task")
        self.point_button.setEnabled(bool(names))

    # -- the task -----------------------------------------------------------------------------------------

    @property
    def current_kind(self) -> str:
        """The kind of the task."""
        kind: str = self.kind.currentData()
        return kind

    def show_task(self, task: Task) -> None:
        """Show a task; what it does not have stays for when its kind is chosen again."""
        self._shows = True
        self._folder = task.folder
        self.kind.setCurrentIndex(self.kind.findData(task.kind))
        if task.kind == POSES:
            self._show_poses(task)
        if task.kind == PATH or task.path is not None:
            self._path = task.path or TracedPath()
            self.closed.setChecked(self._path.closed)
        if task.angles is not None or not self.pairs:
            angles = task.angles or AnglePairs(pairs=FIRST_PAIRS, frame_mm=100.0)
            self._show_pairs(angles.pairs)
            self.frame_mm.set_number(angles.frame_mm)
            self.free.setChecked(angles.free)
            self.output.setCurrentIndex(self.output.findData(angles.output))
        if task.rocker is not None or not self.swing[0].number:
            swing = task.rocker or Swing(swing_deg=60.0, frame_mm=100.0)
            _show(self.swing, (swing.swing_deg, swing.time_ratio, swing.frame_mm))
        _show(self.limits, (task.limits.transmission_deg_min, task.limits.length_ratio_max))
        self.order.setChecked(task.limits.order)
        self._shows = False
        self._show_kind()

    def _show_poses(self, task: Task) -> None:
        if len(task.poses) != len(self.poses):
            names = ("x_mm", "y_mm", "angle_deg")
            self.poses = self._rows(self._pose_grid, BodyPose, names, len(task.poses), self._remove_pose)
        for boxes, pose in zip(self.poses, task.poses, strict=True):
            _show(boxes, (pose.x_mm, pose.y_mm, pose.angle_deg))
        while len(self.pivots) > len(task.pivots):
            row = self.pivots.pop()
            row.hide()
            row.deleteLater()
        while len(self.pivots) < len(task.pivots):
            row = PivotRow(len(self.pivots) + 1)
            row.changed.connect(self._emit_changed)
            row.removed.connect(partial(self._remove_pivot, len(self.pivots)))
            self.pivots.append(row)
            self._pivot_column.addWidget(row)
        for row, pivot in zip(self.pivots, task.pivots, strict=True):
            row.show_pivot(pivot)
        for heading in self._pivot_headings:
            heading.setVisible(bool(self.pivots))
        area = task.area
        self._area_form.setVisible(area is not None)
        self.add_area.setVisible(area is None)
        if area is not None:
            _show(self.area, (area.low_x_mm, area.low_y_mm, area.high_x_mm, area.high_y_mm))

    def _show_pairs(self, pairs: tuple[AnglePair, ...]) -> None:
        if len(pairs) != len(self.pairs):
            self.pairs = self._rows(self._pair_grid, AnglePair, ("driver_deg", "output"), len(pairs), self._remove_pair)
        for boxes, pair in zip(self.pairs, pairs, strict=True):
            _show(boxes, (pair.driver_deg, pair.output))

    def _show_kind(self) -> None:
        kind = self.current_kind
        self.stack.setCurrentIndex(list(self.pages).index(kind))
        self.order.setEnabled(kind == POSES)
        self.frame_mm.setEnabled(self.output.currentData() == ROCKER_OUTPUT)
        self.add_pose.setEnabled(len(self.poses) < MOST_POSES)
        count = len(self._path.points)
        self.about_path.setText(
            f"Points of {self._path.file}" if self._path.file else f"{count} points" if count else NO_PATH
        )

    def _emit_changed(self, *_: object) -> None:
        if not self._shows:
            self._show_kind()
            self.changed.emit()

    @property
    def task(self) -> Task:
        """The task as it is typed and drawn."""
        kind = self.current_kind
        transmission, ratio = (box.number for box in self.limits)
        order = kind == POSES and self.order.isChecked()
        limits = AnswerLimits(transmission_deg_min=transmission, length_ratio_max=ratio, order=order)
        task = Task(kind=kind, limits=limits, folder=self._folder)
        if kind == POSES:
            poses = tuple(BodyPose(*_numbers(boxes)) for boxes in self.poses)
            area = None if self._area_form.isHidden() else Area(*_numbers(self.area))
            return replace(task, poses=poses, pivots=tuple(row.pivot for row in self.pivots), area=area)
        if kind == PATH:
            return replace(task, path=replace(self._path, closed=self.closed.isChecked()))
        if kind == ANGLES:
            output = self.output.currentData()
            frame = self.frame_mm.number if output == ROCKER_OUTPUT else None
            pairs = tuple(AnglePair(*_numbers(boxes)) for boxes in self.pairs)
            return replace(
                task, angles=AnglePairs(pairs=pairs, free=self.free.isChecked(), frame_mm=frame, output=output)
            )
        swing, ratio, frame = _numbers(self.swing)
        return replace(task, rocker=Swing(swing_deg=swing, time_ratio=ratio, frame_mm=frame))

    # -- rows that are added and removed --------------------------------------------------------------------

    def _edit(self, task: Task) -> None:
        self.show_task(task)
        self.changed.emit()

    def _add_pose(self) -> None:
        task = self.task
        last = task.poses[-1] if task.poses else BodyPose(0.0, 0.0)
        self._edit(replace(task, poses=(*task.poses, BodyPose(last.x_mm + 40.0, last.y_mm, last.angle_deg + 15.0))))

    def _remove_pose(self, row: int) -> None:
        self._edit(PARTS[task_parts.POSE].remove(self.task, row))

    def _add_pivot(self) -> None:
        task = self.task
        part = new_part(task, PIVOT)
        assert part is not None
        first = task.poses[0] if task.poses else BodyPose(0.0, 0.0)
        self._edit(PARTS[PIVOT].put(task, part.index, (first.x_mm, first.y_mm - 40.0 * (1 + part.index))))

    def _remove_pivot(self, row: int) -> None:
        self._edit(PARTS[PIVOT].remove(self.task, row))

    def _add_area(self) -> None:
        x, y = [pose.x_mm for pose in self.task.poses] or [0.0], [pose.y_mm for pose in self.task.poses] or [0.0]
        size = max(max(x) - min(x), max(y) - min(y), 40.0)
        self._set_area(Area(min(x) - size, min(y) - size, max(x) + size, max(y) + size))

    def _set_area(self, area: Area | None) -> None:
        self._edit(replace(self.task, area=area))

    def _add_pair(self) -> None:
        task = self.task
        assert task.angles is not None
        pairs = task.angles.pairs
        last = pairs[-1] if pairs else AnglePair(0.0, 0.0)
        pairs = (*pairs, AnglePair(last.driver_deg + 20.0, last.output + 10.0))
        self._edit(replace(task, angles=replace(task.angles, pairs=pairs)))

    def _remove_pair(self, row: int) -> None:
        angles = self.task.angles
        assert angles is not None
        pairs = tuple(pair for i, pair in enumerate(angles.pairs) if i != row)
        self._edit(replace(self.task, angles=replace(angles, pairs=pairs)))

    # -- what is wrong --------------------------------------------------------------------------------------

    def _boxes_by_path(self) -> Iterator[tuple[str, Boxes]]:
        """Yield the boxes of the present kind of task by the paths of their fields in its file."""
        if self.current_kind == POSES:
            yield from ((f"poses[{i}]", boxes) for i, boxes in enumerate(self.poses))
            yield from ((f"pivots[{i}].line", [row.direction]) for i, row in enumerate(self.pivots))
            yield from ((f"pivots[{i}]", row.all_boxes) for i, row in enumerate(self.pivots))
            if not self._area_form.isHidden():
                yield from (("area.low", self.area[:2]), ("area.high", self.area[2:]), ("area", self.area))
        elif self.current_kind == ANGLES:
            yield from ((f"angles.pairs[{i}]", boxes) for i, boxes in enumerate(self.pairs))
            yield "angles.frame_mm", [self.frame_mm]
        elif self.current_kind == ROCKER:
            yield from ((f"rocker.{name}", [box]) for name, box in zip(SWING, self.swing, strict=True))
        yield from ((f"limits.{name}", [box]) for name, box in zip(BOUNDED, self.limits, strict=True))

    @property
    def visible_boxes(self) -> Boxes:
        """The boxes of the present kind of task."""
        return list(dict.fromkeys(box for _, boxes in self._boxes_by_path() for box in boxes))

    def judge(self) -> bool:
        """Frame the boxes whose texts are not allowed, and say why the first is not; return whether all are allowed."""
        for box in self.visible_boxes:
            box.set_refused(bool(box.fault()))
        wrong = next((box for box in self.visible_boxes if box.fault()), None)
        if wrong is None:
            self.message.show_refusal("")
            return True
        self.message.show_refusal(sentence(f"{wrong.accessibleName()}: {wrong.fault()}"))
        self._bring_in_sight(wrong)
        return False

    def refuse(self, path: str, text: str) -> None:
        """Say what is wrong with the task, and frame the boxes of a field by its path in the file."""
        self.message.show_refusal(text)
        boxes = next((boxes for name, boxes in self._boxes_by_path() if path.startswith(name)), None)
        for box in boxes or ():
            box.set_refused(True)
        if boxes:
            self._bring_in_sight(boxes[0])

    def _bring_in_sight(self, box: QWidget) -> None:
        page = self.pages[self.current_kind]
        if page.isAncestorOf(box):
            page.ensureWidgetVisible(box)


def _show(boxes: Boxes, values: Sequence[float | None]) -> None:
    """Show numbers in boxes."""
    for box, value in zip(boxes, values, strict=True):
        if box.number != value or box.fault():
            box.set_number(value)


def _numbers(boxes: Boxes) -> list[float]:
    return [box.number or 0.0 for box in boxes]


def _button(text: str, action: Callable[[], object], tip: str = "") -> QPushButton:
    button = described(QPushButton(text, autoDefault=False), tip=tip)
    button.clicked.connect(lambda: action())
    return button


def _boxes(kind: Any, *names: str, suffix: str = "") -> Boxes:
    """Boxes for fields of a part of a task; ``suffix`` follows their accessible names."""
    infos = ((field_info(kind, name), split_unit(name)[1]) for name in names)
    return [LiveBox(info, unit, f"{info.label}{suffix}") for info, unit in infos]
