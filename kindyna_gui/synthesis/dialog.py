"""Compo > Find a linkage: a task as numbers and on a sheet, and cards of the linkages found for it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtWidgets import (
    QCheckBox,
    QFileDialog,
    QFormLayout,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QListWidgetItem,
    QPushButton,
    QScrollArea,
    QStackedWidget,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import split_unit
from core.errors import KindynaError
from core.numerics.lazy import Cancelled
from core.requests import field_info
from core.synthesis import (
    AnglePair,
    AnglePairs,
    Answer,
    AnswerLimits,
    BodyPose,
    PathPoint,
    Pivot,
    Swing,
    Synthesis,
    Task,
    TracedPath,
    load_task,
    save_task,
    synthesise,
)
from core.synthesis.judge import joint_positions
from core.synthesis.task import ANGLES, FIXED, MOST_POSES, PATH, POSES, ROCKER, ROCKER_OUTPUT, SLIDER_OUTPUT, checked
from core.synthesis.tasks import TASKS
from kindyna_gui.background import Background
from kindyna_gui.documents.session import Session
from kindyna_gui.drives import replace_chosen
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import LiveBox, WordBox
from kindyna_gui.forms.request_form import PutDialog
from kindyna_gui.labels import sentence
from kindyna_gui.look import described, text_button
from kindyna_gui.pictures.units import brief, readable_text, short
from kindyna_gui.rebuilt import STRETCH, connect_all, fill, single_shot, widget_with
from kindyna_gui.studies.board import Board, Card
from kindyna_gui.synthesis.sheet import TaskSheet

LEFT_WIDTH, DEFAULT_SIZE, LEAST_SIZE = 344, QSize(1180, 780), QSize(960, 620)
PAUSE_MS, FRAME_MS, STEPS = 150, 40, 120
TASK_FILES, CURVES = "Tasks (*.toml)", "Curves (*.csv *.dxf)"
FIRST_POSES = (BodyPose(0.0, 0.0, 0.0), BodyPose(60.0, 20.0, 30.0), BodyPose(110.0, 10.0, 60.0))
FIRST_PAIRS = (AnglePair(45.0, 30.0), AnglePair(75.0, 55.0), AnglePair(105.0, 75.0))
BOUNDED = ("transmission_deg_min", "length_ratio_max")
"""Limits of the answers."""
HINTS: Mapping[str, str] = {
    POSES: "Press and drag: puts a frame of the body and turns it, two to five of them; with Shift: a fixed pivot",
    PATH: "Draw the path in one stroke; near its start it closes",
}
FIELD_NAMES: Mapping[str, str] = {
    "poses": "pose",
    "pivots": "pivot",
    "path.points": "points of the path",
    "angles.pairs": "pair",
    "angles.frame_mm": "frame",
    "rocker.swing_deg": "swing",
    "rocker.time_ratio": "time ratio",
    "rocker.frame_mm": "frame",
}
"""Key of a task's file -> its name in a sentence."""
Boxes = list[LiveBox]


class FindLinkageDialog(PutDialog):
    """A task on the left, its sheet and the cards of its answers on the right; *Take over* puts an answer into the design."""

    help_page = "linkages#Finding a linkage"

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(session, "Find a linkage", parent)
        self.put_button.setText("&Take over")
        self.kind, self.output, self.sheet, self.board = WordBox(), WordBox(), TaskSheet(), Board("the best first")
        self.pages: dict[str, QWidget] = {}
        self.stack = QStackedWidget()
        self.poses: list[Boxes] = []
        self.pairs: list[Boxes] = []
        self.swing = _boxes(Swing, "swing_deg", "time_ratio", "frame_mm")
        self.pivots = [_boxes(Pivot, "x_mm", "y_mm", suffix=f" of fixed pivot {k}") for k in (1, 2)]
        self.frame_mm = _boxes(AnglePairs, "frame_mm")[0]
        self.limits = _boxes(AnswerLimits, *BOUNDED)
        self.closed, self.free, self.order = (
            QCheckBox("&Closed"),
            QCheckBox("Only &differences count"),
            QCheckBox("In this o&rder"),
        )
        self.about_path = QLabel(wordWrap=True)
        self.found = QLabel(wordWrap=True)
        self._pose_grid, self._pair_grid = QGridLayout(), QGridLayout()
        self._path = TracedPath()
        self._folder = Path()
        self._kept = Task(kind=POSES)  # pivots and area of an opened task
        self._answers: tuple[Answer, ...] = ()
        self._shows = False
        self._step, self._is_fitted = 0, False
        self._search = Background(self)
        self._pause = single_shot(self, self._start, PAUSE_MS)
        self._clock = QTimer(self, interval=FRAME_MS)
        self._lay_out()
        connect_all(
            (self.kind.activated, self._kind_chosen),
            (self.output.activated, self._changed),
            (self.sheet.poses_changed, self._sheet_poses),
            (self.sheet.pivots_changed, self._sheet_pivots),
            (self.sheet.path_changed, self._sheet_path),
            (self.closed.toggled, self._changed),
            (self.free.toggled, self._changed),
            (self.order.toggled, self._changed),
            (self._search.result, self._show_result),
            (self._clock.timeout, self._turn),
            (self.board.list.currentItemChanged, self._show_card),
            (self.board.reopened, self._take),
        )
        for box in (*self.swing, self.frame_mm, *self.limits, *self.pivots[0], *self.pivots[1]):
            box.changed.connect(self._changed)
        self.finished.connect(self._close)
        self.show_task(replace(Task(kind=POSES), poses=FIRST_POSES))
        self.sheet.fit()

    # -- layout -------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        self.kind.setAccessibleName("Task")
        fill_choices(self.kind, {name: row.title for name, row in TASKS.items()})
        fill_choices(self.output, {ROCKER_OUTPUT: "Rocker, degrees", SLIDER_OUTPUT: "Slider, mm"})
        self.output.setAccessibleName("Output")
        self.add_pose = add_pose = self._button("&Add a pose", lambda: self._add_pose())
        add_pair = self._button("&Add a pair", lambda: self._add_pair())
        curve = self._button("Points from a &file...", self._open_curve)
        pages = {
            POSES: fill(QVBoxLayout(), self._pose_grid, add_pose, 8, self._pivot_form(), STRETCH, margins=0),
            PATH: fill(QVBoxLayout(), self.about_path, self.closed, curve, STRETCH, margins=0),
            ANGLES: fill(QVBoxLayout(), self._angle_form(), self._pair_grid, add_pair, self.free, STRETCH, margins=0),
            ROCKER: fill(QVBoxLayout(), _form(self.swing), STRETCH, margins=0),
        }
        for name, layout in pages.items():
            self.pages[name] = widget_with(layout)
            area = QScrollArea(widgetResizable=True)
            area.setFrameShape(QScrollArea.Shape.NoFrame)
            area.setWidget(self.pages[name])
            self.stack.addWidget(area)
        files = fill(
            QHBoxLayout(),
            self._button("&Open a task...", self._open_task),
            self._button("&Save the task...", self._save_task),
        )
        limits = _form(self.limits)
        self.order.setToolTip("The poses are passed in the order of their numbers, in either direction")
        left = fill(
            QVBoxLayout(), self.kind, (self.stack, 1), QLabel("Limits of the answers"), limits, self.order, files
        )
        self.board.keep.hide()
        self.board.sort.setSizeAdjustPolicy(WordBox.SizeAdjustPolicy.AdjustToContents)
        self.board.list.setToolTip("Click a card to see it move over the task; double-click to take it over")
        right = fill(QVBoxLayout(), (self.sheet, 1), self.found, self.board, margins=0)
        self.frame(left, LEFT_WIDTH, right, DEFAULT_SIZE, LEAST_SIZE)

    def _pivot_form(self) -> QGridLayout:
        """Positions of the fixed pivots; an empty one is free."""
        grid = QGridLayout()
        for k, boxes in enumerate(self.pivots):
            grid.addWidget(QLabel(f"Fixed pivot {k + 1}"), k, 0)
            for column, box in enumerate(boxes, 1):
                box.setToolTip("Empty: anywhere. Shift and a press on the sheet put it")
                grid.addWidget(box, k, column)
        return grid

    def _angle_form(self) -> QFormLayout:
        form = QFormLayout()
        form.addRow("Output", self.output)
        form.addRow("Frame", self.frame_mm)
        return form

    def _button(self, text: str, action: Callable[[], object]) -> QPushButton:
        button = QPushButton(text, autoDefault=False)
        button.clicked.connect(lambda: action())
        return button

    # -- the task -----------------------------------------------------------------------------------------

    def show_task(self, task: Task) -> None:
        """Show a task, and search for it."""
        self._shows = True
        self._kept, self._folder = task, task.folder
        self.kind.setCurrentIndex(self.kind.findData(task.kind))
        if task.poses:
            self._show_poses(task.poses)
        self._show_pivots([next((p.z for p in task.pivots if _is_placed(p, dyad)), None) for dyad in (1, 2)])
        angles = task.angles or AnglePairs(pairs=FIRST_PAIRS, frame_mm=100.0)
        self._show_pairs(angles.pairs)
        self.frame_mm.set_number(angles.frame_mm)
        self.free.setChecked(angles.free)
        self.output.setCurrentIndex(self.output.findData(angles.output))
        swing = task.rocker or Swing(swing_deg=60.0, frame_mm=100.0)
        for box, value in zip(self.swing, (swing.swing_deg, swing.time_ratio, swing.frame_mm), strict=True):
            box.set_number(value)
        if task.path is not None:
            self._path = task.path
            self.closed.setChecked(task.path.closed)
        limits = task.limits
        for box, limit in zip(self.limits, (limits.transmission_deg_min, limits.length_ratio_max), strict=True):
            box.set_number(limit)
        self.order.setChecked(limits.order)
        self._shows = False
        self._show_kind()
        self._changed()

    def _kind_chosen(self, _: int) -> None:
        self._is_fitted = False
        self._show_kind()
        self._changed()
        self.sheet.fit()

    def _show_kind(self) -> None:
        kind = self.kind.currentData()
        self.stack.setCurrentIndex(list(self.pages).index(kind))
        self.order.setEnabled(kind == POSES)
        self.sheet.draws_path, self.sheet.is_passive = kind == PATH, kind not in HINTS
        self.sheet.hint = HINTS.get(kind, "")

    def _show_poses(self, poses: tuple[BodyPose, ...] | list[BodyPose]) -> None:
        """Boxes of the frames: those that there are, with their numbers, or as many as are needed."""
        if len(poses) != len(self.poses):
            names = ("x_mm", "y_mm", "angle_deg")
            self.poses = self._rows(self._pose_grid, BodyPose, names, len(poses), self._remove_pose)
        for boxes, pose in zip(self.poses, poses, strict=True):
            for box, value in zip(boxes, (pose.x_mm, pose.y_mm, pose.angle_deg), strict=True):
                if not box.is_refused and box.number != value:
                    box.set_number(value)

    def _show_pivots(self, pivots: Sequence[complex | None]) -> None:
        for boxes, z in zip(self.pivots, pivots, strict=True):
            for box, value in zip(boxes, (None, None) if z is None else (z.real, z.imag), strict=True):
                box.set_number(value)

    def _sheet_pivots(self) -> None:
        self._show_pivots(self.sheet.pivots)
        self._changed()

    def _typed_pivots(self) -> list[complex | None]:
        """Positions of the fixed pivots of both dyads [mm]; None where they are free, or not complete."""
        rows = [(x.number, y.number) for x, y in self.pivots]
        return [None if x is None or y is None else complex(x, y) for x, y in rows]

    def _show_pairs(self, pairs: tuple[AnglePair, ...]) -> None:
        if len(pairs) != len(self.pairs):
            self.pairs = self._rows(self._pair_grid, AnglePair, ("driver_deg", "output"), len(pairs), self._remove_pair)
        for boxes, pair in zip(self.pairs, pairs, strict=True):
            boxes[0].set_number(pair.driver_deg)
            boxes[1].set_number(pair.output)

    def _rows(
        self, grid: QGridLayout, kind: Any, names: tuple[str, ...], count: int, remove: Callable[[int], None]
    ) -> list[Boxes]:
        """Fill a grid with numbered rows of boxes, each with a button that removes it."""
        while item := grid.takeAt(0):
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        rows = []
        for k, name in enumerate(names, 1):
            info, unit = field_info(kind, name), split_unit(name)[1]
            grid.addWidget(QLabel(f"{info.label}, {unit.symbol}" if unit.symbol else info.label), 0, k)
        for i in range(count):
            boxes = _boxes(kind, *names, suffix=f" {i + 1}")
            grid.addWidget(QLabel(str(i + 1)), i + 1, 0)
            for k, box in enumerate(boxes, 1):
                box.changed.connect(self._changed)
                grid.addWidget(box, i + 1, k)
            cross: QToolButton = described(text_button("×", flat=True), name=f"Remove {i + 1}", tip="Remove this row")
            cross.clicked.connect(partial(lambda row, *_: remove(row), i))
            grid.addWidget(cross, i + 1, len(names) + 1)
            rows.append(boxes)
        return rows

    def _add_pose(self) -> None:
        poses = self._typed_poses()
        last = poses[-1] if poses else BodyPose(0.0, 0.0)
        self._set_poses([*poses, BodyPose(last.x_mm + 40.0, last.y_mm, last.angle_deg + 15.0)])

    def _remove_pose(self, row: int) -> None:
        self._set_poses([pose for i, pose in enumerate(self._typed_poses()) if i != row])

    def _set_poses(self, poses: list[BodyPose]) -> None:
        self._show_poses(poses)
        self._changed()

    def _add_pair(self) -> None:
        pairs = self._typed_pairs()
        last = pairs[-1] if pairs else AnglePair(0.0, 0.0)
        self._show_pairs((*pairs, AnglePair(last.driver_deg + 20.0, last.output + 10.0)))
        self._changed()

    def _remove_pair(self, row: int) -> None:
        self._show_pairs(tuple(pair for i, pair in enumerate(self._typed_pairs()) if i != row))
        self._changed()

    def _sheet_poses(self) -> None:
        self._show_poses(self.sheet.poses)
        self._changed()

    def _sheet_path(self, closed: bool) -> None:
        self._path = TracedPath(points=tuple(self.sheet.points), closed=closed)
        self._shows = True
        self.closed.setChecked(closed)
        self._shows = False
        self._changed()

    def _typed_poses(self) -> list[BodyPose]:
        return [BodyPose(*(box.number or 0.0 for box in boxes)) for boxes in self.poses]

    def _typed_pairs(self) -> tuple[AnglePair, ...]:
        return tuple(AnglePair(*(box.number or 0.0 for box in boxes)) for boxes in self.pairs)

    @property
    def task(self) -> Task:
        """The task as it is typed and drawn; lines of pivots, and the area, are those of the opened file."""
        kind = self.kind.currentData()
        transmission, ratio = (box.number for box in self.limits)
        limits = AnswerLimits(
            transmission_deg_min=transmission, length_ratio_max=ratio, order=kind == POSES and self.order.isChecked()
        )
        task = Task(kind=kind, limits=limits, folder=self._folder)
        if kind == POSES:
            others = [pivot for pivot in self._kept.pivots if not any(_is_placed(pivot, dyad) for dyad in (1, 2))]
            placed = enumerate(self._typed_pivots(), 1)
            typed = [Pivot(dyad=k, of=FIXED, x_mm=z.real, y_mm=z.imag) for k, z in placed if z is not None]
            return replace(task, poses=tuple(self._typed_poses()), pivots=(*others, *typed), area=self._kept.area)
        if kind == PATH:
            return replace(task, path=replace(self._path, closed=self.closed.isChecked()))
        if kind == ANGLES:
            output = self.output.currentData()
            frame = self.frame_mm.number if output == ROCKER_OUTPUT else None
            pairs = AnglePairs(pairs=self._typed_pairs(), free=self.free.isChecked(), frame_mm=frame, output=output)
            return replace(task, angles=pairs)
        swing, ratio, frame = (box.number or 0.0 for box in self.swing)
        return replace(task, rocker=Swing(swing_deg=swing, time_ratio=ratio, frame_mm=frame))

    @property
    def _visible_boxes(self) -> Boxes:
        kind = self.kind.currentData()
        by_kind = {
            POSES: [box for row in (*self.poses, *self.pivots) for box in row],
            PATH: [],
            ANGLES: [self.frame_mm, *(box for row in self.pairs for box in row)],
            ROCKER: list(self.swing),
        }
        return [*by_kind[kind], *self.limits]

    # -- the search ---------------------------------------------------------------------------------------

    def _changed(self, *_: object) -> None:
        """Show the task on the sheet, and search again after a pause."""
        if self._shows:
            return
        kind = self.kind.currentData()
        self.frame_mm.setEnabled(self.output.currentData() == ROCKER_OUTPUT)
        points = list(self._path.points) if kind == PATH else []
        self.add_pose.setEnabled(len(self.poses) < MOST_POSES)
        self.sheet.pivots = self._typed_pivots()
        self.sheet.show_task(self._typed_poses() if kind == POSES else [], points, self.closed.isChecked())
        count = len(self._path.points)
        self.about_path.setText(
            f"Points of {self._path.file}" if self._path.file else f"{count} points" if count else HINTS[PATH]
        )
        self._search.stop()
        self.put_button.setEnabled(False)
        self._pause.start()

    @property
    def _is_empty(self) -> bool:
        """Whether nothing has been drawn of a path yet."""
        return self.kind.currentData() == PATH and not (self._path.points or self._path.file)

    def _start(self) -> None:
        """Search for the present task, unless an entry is refused."""
        for box in self._visible_boxes:
            box.set_refused(bool(box.fault()))
        wrong = next((box for box in self._visible_boxes if box.fault()), None)
        if wrong is not None:
            self._show_none(f"{wrong.accessibleName()}: {wrong.fault()}")
            return
        if self._is_empty:
            self._show_none("")
            return
        try:
            task = checked(self.task)
        except KindynaError as error:
            self._show_none(_reason(error))
            return
        self.show_message("")
        self.found.setText("Searching ...")
        self._search.start([(None, partial(synthesise, task))])

    def _show_none(self, why: str) -> None:
        """Show why there is no answer."""
        self._answers = ()
        self._show_cards()
        self.found.setText("")
        self.show_message(sentence(why) if why else "", wrong=True)

    def _show_result(self, _: object, result: Synthesis | KindynaError | Cancelled) -> None:
        if isinstance(result, Cancelled):
            return
        if isinstance(result, KindynaError):
            self._show_none(_reason(result))
            return
        self.show_message("")
        self._answers = result.answers[: result.shown] or result.answers
        extent = "all that there are" if result.complete else "the best of a sweep"
        count = len(self._answers)
        text = f"{count} {'linkage' if count == 1 else 'linkages'}, {extent}"
        if not result.shown:
            text = f"Only with defects or beyond limits: {text}"
        elif result.hidden:
            text = f"{text}; {result.hidden} with defects or beyond limits are hidden"
        self.found.setText(text)
        self._show_cards()
        if not self._is_fitted:
            self._is_fitted = True
            self.sheet.fit()

    def _show_cards(self) -> None:
        """Show the answers as cards, the first one over the task."""
        self.board.show_cards([Card(answer.candidate.design, _values(answer)) for answer in self._answers])
        self.put_button.setEnabled(bool(self._answers))
        self._clock.stop()
        self.sheet.show_answer({})
        if self._answers:
            self.board.list.setCurrentRow(0)

    @property
    def answer(self) -> Answer | None:
        """The answer whose card is selected."""
        item = self.board.list.currentItem()
        index = None if item is None else item.data(Qt.ItemDataRole.UserRole)
        return self._answers[index] if index is not None and index < len(self._answers) else None

    def _show_card(self, item: QListWidgetItem | None, *_: object) -> None:
        answer = self.answer if item is not None else None
        if answer is None:
            return
        positions = joint_positions(answer, STEPS)
        if not answer.turns_fully:  # there and back
            positions = {name: _back_and_forth(z) for name, z in positions.items()}
        self.sheet.show_answer(positions)
        self._clock.start()

    def _turn(self) -> None:
        self._step += 1
        self.sheet.show_step(self._step)

    # -- taking over, and files ---------------------------------------------------------------------------

    def accept(self) -> None:
        answer = self.answer
        if answer is not None and self.put_button.isEnabled():
            self._take(answer.candidate.design)

    def _take(self, design: Any) -> None:
        if self._session.has_several_drives:
            if replace_chosen(self._session, design, "Take over a linkage"):
                super(PutDialog, self).accept()
        else:
            self.put(design, "Take over a linkage")

    def _close(self, *_: object) -> None:
        self._clock.stop()
        self._pause.stop()
        self._search.close()

    def _open_task(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, "Open a task", "", f"{TASK_FILES};;All files (*)")
        if name:
            self._is_fitted = False
            self._read(lambda: self.show_task(load_task(name)))

    def _save_task(self) -> None:
        name, _ = QFileDialog.getSaveFileName(self, "Save the task", "task.toml", TASK_FILES)
        if name:
            self._read(lambda: save_task(self.task, name))

    def _open_curve(self) -> None:
        from core.synthesis.path_file import read_path

        name, _ = QFileDialog.getOpenFileName(self, "Points of a path", "", f"{CURVES};;All files (*)")
        if not name:
            return

        def read() -> None:
            points = tuple(PathPoint(z.real, z.imag) for z in read_path(Path(name)).tolist())
            self._path = TracedPath(points=points, closed=self.closed.isChecked() or name.lower().endswith(".dxf"))
            self.closed.setChecked(self._path.closed)
            self._changed()
            self.sheet.fit()

        self._read(read)

    def _read(self, action: Callable[[], object]) -> None:
        """Do something with a file; show why it cannot be done."""
        try:
            action()
        except KindynaError as error:
            self.show_message(sentence(_reason(error)), wrong=True)


def _reason(error: KindynaError) -> str:
    """The first fault of a task, with the names of the dialog for its fields."""
    text = str(error).splitlines()[0]
    for key, name in FIELD_NAMES.items():
        text = re.sub(rf"\b{re.escape(key)}(\[(\d+)\])?", partial(_numbered, name), text)
    return text


def _numbered(name: str, match: re.Match[str]) -> str:
    """Name of a field, with the number of its row, which counts from 1."""
    return f"{name} {int(match[2]) + 1}" if match[2] else name


def _is_placed(pivot: Pivot, dyad: int) -> bool:
    """Whether a condition is the position of the fixed pivot of one dyad."""
    return pivot.of == FIXED and pivot.dyad == dyad and pivot.z is not None


def _back_and_forth(z: np.ndarray) -> np.ndarray:
    return np.concatenate((z, z[-2:0:-1]))


def _boxes(kind: Any, *names: str, suffix: str = "") -> Boxes:
    """Boxes for fields of a part of a task; ``suffix`` follows their accessible names."""
    infos = ((field_info(kind, name), split_unit(name)[1]) for name in names)
    return [LiveBox(info, unit, f"{info.label}{suffix}") for info, unit in infos]


def _form(boxes: Boxes) -> QFormLayout:
    form = QFormLayout()
    form.setVerticalSpacing(4)
    for box in boxes:
        box.setToolTip(sentence(box.info.help) if box.info.help else "")
        form.addRow(box.info.label, box)
    return form


def _values(answer: Answer) -> dict[str, tuple[float, str]]:
    """Name -> value and text of the figures on a card."""
    error = max(answer.error_mm / answer.size_mm, answer.error_deg)
    exact = answer.error_mm <= 1e-9 * answer.size_mm and answer.error_deg <= 1e-9
    texts = [brief(answer.error_mm, "mm", 3)] if answer.error_mm > 0.0 else []
    texts += [f"{short(answer.error_deg, 3)}°"] if answer.error_deg > 1e-9 else []
    transmission, ratio = (", beyond its limit" if name in answer.violated else "" for name in BOUNDED)
    kind = ", ".join([answer.candidate.kind.capitalize(), *(f"{defect} defect" for defect in answer.defects)])
    return {
        answer.candidate.kind: (0.0, kind),
        "error": (error, "exact" if exact else f"error {', '.join(texts)}"),
        "transmission angle": (
            answer.transmission_deg,
            f"transmission angle {short(answer.transmission_deg, 4)}°{transmission}",
        ),
        "longest to shortest": (
            answer.length_ratio,
            f"longest to shortest link {short(answer.length_ratio, 3)}{ratio}",
        ),
        "size": (answer.size_mm, f"size {readable_text(answer.size_mm, 'mm', 4)}"),
    }
