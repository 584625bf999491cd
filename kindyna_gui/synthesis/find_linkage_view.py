"""Compo > Find a linkage: a task as numbers in a dock and as a sheet over the drawing, and cards of the linkages found for it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QFileDialog, QHBoxLayout, QMenu, QPushButton, QVBoxLayout

from core.design import Design
from core.errors import DesignError, KindynaError
from core.numerics.lazy import Cancelled
from core.output.load_text import part_names
from core.project.files import AnyPath
from core.study import Study
from core.synthesis import Answer, Dyad, Task, load_task, save_task
from core.synthesis.chosen import answer_of_dyads, driven_by_other_link
from core.synthesis.path import with_points
from core.synthesis.path_points import read_path, stroke_path
from core.synthesis.takeover import Takeover, taken_over, under_motion
from core.synthesis.task import PATH, POSES, checked
from kindyna_gui.background import Background
from kindyna_gui.documents.session import Session
from kindyna_gui.drives import replace_chosen
from kindyna_gui.labels import sentence
from kindyna_gui.linkage.point_paths import path_of, path_points
from kindyna_gui.look import described
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import ready_tasks
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import STRETCH, add_entry, connect_all, fill, single_shot
from kindyna_gui.settings import point, symbol_of
from kindyna_gui.synthesis.answer_strip import AnswerStrip, Proposals, propose
from kindyna_gui.synthesis.sheet import TaskSheet
from kindyna_gui.synthesis.task_form import FIRST_POSES, TaskForm
from kindyna_gui.view import View, ViewHost

PAUSE_MS, DRAG_PAUSE_MS = 150, 30  # from an edit to the search, and from a move of the mouse
MOST_UNDONE = 100
TASK_FILES, CURVES = "Tasks (*.toml)", "Curves (*.csv *.dxf)"
NAME = "find_linkage"
STEP, MOTION_STEP = "Take over a linkage", "Take over a linkage under the motion"
NO_MOTION = "The present design has no motion: its crank turns at constant speed"
FIELD_NAMES: Mapping[str, str] = {
    "poses": "pose",
    "pivots": "pivot",
    "path.points": "points of the path",
    "angles.pairs": "pair",
    "angles.frame_mm": "frame",
    "rocker.swing_deg": "swing",
    "rocker.time_ratio": "time ratio",
    "rocker.frame_mm": "frame",
    "limits.transmission_deg_min": "least transmission angle",
    "limits.length_ratio_max": "longest to shortest link",
    "linkage.driver.link": "driver",
}
"""Key of a task's file -> its name in a sentence."""


class FindLinkageView(View):
    """The dock *Find a linkage*: numbers of a task; its sheet is over the drawing, its cards below, while the dock is open.

    Attributes
    ----------
    form : TaskForm
    sheet : TaskSheet
    strip : AnswerStrip
    """

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.form, self.sheet, self.strip = TaskForm(), TaskSheet(self), AnswerStrip()
        self._is_fitted = self._is_awaited = False
        self._look: tuple[object, ...] = ()  # unit, colour and font of the cards
        self._tasks: list[Task] = []  # the present one, and before it those that *Undo* restores
        self._search = Background(self)
        self._soon_search = single_shot(self, self._start, PAUSE_MS)
        files = fill(
            QHBoxLayout(),
            _button("&Open a task...", self._open_task),
            _button("&Save the task...", self._save_task),
            self._ready_button(),
            STRETCH,
        )
        self.set_content_layout(fill(QVBoxLayout(), (self.form, 1), files, margins=(8, 6, 6, 6), spacing=6))
        self.setFocusProxy(self.form.kind)
        self.sheet.marks = self._joints
        connect_all(
            (self.form.changed, self._form_changed),
            (self.form.curve_requested, self._open_curve),
            (self.form.point_requested, self._use_path),
            (self.sheet.changed, self._sheet_changed),
            (self.sheet.released, self._start_now),
            (self.sheet.undone, self._undo),
            (self.sheet.left, self._leave_sheet),
            (self._search.result, self._show_result),
            (self.strip.shown, self.sheet.show_answer),
            (self.strip.stepped, self.sheet.show_step),
            (self.strip.taken, self._take_over),
            (self.strip.taken_under_motion, self._take_under_motion),
            (self.strip.changed_over, self._change_over),
            (self.sheet.dyads.paired, self._pair),
            (self.strip.stopped, self._search.cancel),
        )
        self.form.show_task(replace(Task(kind=POSES), poses=FIRST_POSES))
        self._form_changed()

    # -- on the drawing -----------------------------------------------------------------------------------

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.strip.board.pinned.connect(window.pin)

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if self._host is not None and not event.spontaneous():
            self._host.drawing(in_front=True).cover(self.sheet, self.sheet.bar, self.strip)
            self.strip.run(True)
            if not self._is_fitted:
                self.sheet.fit()
            if not self.strip.put_button.isEnabled():  # the search was stopped with the dock
                self._soon_search.start()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if self._host is not None and not event.spontaneous():
            self._soon_search.stop()
            self._search.stop()
            self.strip.end()
            self.strip.run(False)
            self._host.drawing().uncover(self.sheet)

    def _leave_sheet(self) -> None:
        if self._host is not None:
            self._host.close_view(NAME)

    def _joints(self) -> Mapping[str, complex]:
        """Joints of the present mechanism [mm], to which the mouse snaps."""
        return self._host.drawing().joints() if self._host is not None else {}

    def refresh(self, study: Study) -> None:
        self.form.show_units()
        if self._look != (look := (symbol_of("mm"), point(), SCREEN.paper, self.fontMetrics().lineSpacing())):
            self._look = look
            self.strip.show_again()
        drive = self.session.design.drive
        self.form.offer_points(path_points(drive.linkage) if drive.links else ())
        self.strip.show_motion("" if drive.motion is not None else NO_MOTION)

    @property
    def busy(self) -> bool:
        return self._soon_search.isActive() or self._search.busy

    def leave(self) -> None:
        super().leave()
        self._soon_search.stop()
        self._search.close()

    # -- the task -----------------------------------------------------------------------------------------

    @property
    def task(self) -> Task:
        """The task as it is typed and drawn."""
        return self.form.task

    def show_task(self, task: Task) -> None:
        """Show a task, and search for it."""
        self.form.show_task(task)
        self._form_changed()
        self._refit()

    def _refit(self) -> None:
        self._is_fitted = False

    def _form_changed(self) -> None:
        """Show on the sheet what has been typed, and search after a pause."""
        task = self.task
        with suppress(KindynaError):  # a file that cannot be read, as the search says
            task = with_points(task)
        if task.kind != self.sheet.task.kind and task.kind not in (POSES, PATH):  # the mouse draws nothing of it
            self._refit()
        self.sheet.show_task(task)
        self._request(PAUSE_MS)

    def _sheet_changed(self, task: Task) -> None:
        """Show in the form what has been drawn, and search; while the mouse drags, after each result."""
        self.form.show_task(replace(task, folder=self.task.folder))
        self._request(DRAG_PAUSE_MS if self.sheet.is_dragging else PAUSE_MS)

    def _request(self, pause_ms: int) -> None:
        self.strip.set_ready(False)
        if self.sheet.adds_points or (self._search.busy and self.sheet.is_dragging):
            self._is_awaited = True  # the present cards are shown, then the next search starts
            return
        self._search.stop()
        self._is_awaited = False
        if (self._host is not None and not self._soon_search.isActive()) or pause_ms == PAUSE_MS:
            self._soon_search.start(pause_ms)

    def _note(self) -> None:
        """Note the present task for *Undo*, unless the mouse is dragging."""
        if not self.sheet.is_dragging and self._tasks[-1:] != [self.task]:
            self._tasks = [*self._tasks[-MOST_UNDONE:], self.task]

    def _undo(self) -> None:
        """Return to the task before the last edit."""
        if len(self._tasks) > 1:
            self._tasks.pop()
            self.form.show_task(self._tasks[-1])
            self._form_changed()

    def _start_now(self) -> None:
        """Search now for what has been drawn."""
        self._note()
        if not self.sheet.adds_points and (self._soon_search.isActive() or self._is_awaited):
            self._soon_search.stop()
            self._start()

    @property
    def _is_empty(self) -> bool:
        """Whether nothing of the task has been drawn yet."""
        task = self.task
        if task.kind == PATH:
            return task.path is None or not (task.path.points or task.path.file)
        return task.kind == POSES and not task.poses

    def _start(self) -> None:
        """Search for the present task, unless an entry is refused."""
        self._is_awaited = False
        self._note()
        if not self.form.judge() or self._is_empty:
            self._search.stop()
            self.strip.show_none()
            return
        try:
            task = checked(self.task)
        except DesignError as error:
            self._refuse(error)
            return
        self.strip.begin()
        self._search.start([(None, partial(propose, task))])

    def _refuse(self, error: KindynaError) -> None:
        """Show at its field what is wrong with the task."""
        faults = error.faults if isinstance(error, DesignError) else ()
        self.form.refuse(faults[0].path if faults else "", sentence(_reason(error)))
        self.strip.show_none()

    def _show_result(self, _: object, result: Proposals | KindynaError | Cancelled) -> None:
        if isinstance(result, Cancelled):
            self.strip.end("Stopped; the cards are those of an earlier task")
        elif isinstance(result, KindynaError):
            self._refuse(result)
        else:
            self.strip.show_proposals(result)
            self.sheet.dyads.show_dyads(result.synthesis.dyads, next(iter(result.task.poses), None))
            self.strip.set_ready(not self._is_awaited)
            if not self._is_fitted and not self.sheet.is_dragging:
                self._is_fitted = True
                self.sheet.fit()
        if self._is_awaited and not self.sheet.adds_points:
            self._start()

    # -- taking over ---------------------------------------------------------------------------

    def _take_over(self, answer: Answer) -> None:
        self._take(STEP, lambda: taken_over(answer, self.session.design))

    def _take_under_motion(self, answer: Answer) -> None:
        self._take(MOTION_STEP, lambda: under_motion(answer, self.task, self.session.design))

    def _take(self, step: str, takeover: Callable[[], Takeover]) -> None:
        """Make a linkage the design; say which parts of the present design do not fit it."""
        present = self.session.design
        try:
            result = takeover()
        except KindynaError as error:
            self._tell(error)
            return
        if self._put(result.design, step):
            left_out = ", ".join(part_names(present, result.left_out))
            left_out = f" Left out: {left_out}." if left_out else ""
            self.status_message.emit(
                f"The linkage is the design now.{left_out} Compo > Find a linkage shows its task again"
            )
            self._leave_sheet()

    def _put(self, design: Design, step: str) -> bool:
        """Put a design in place as one undo step; where the session refuses it, show why."""
        if self.session.has_several_drives:
            return replace_chosen(self.session, design, step)
        with self.session.one_step() as refusals:
            is_done = self.session.put(design, step)
        if not is_done:
            self.session.withdraw("")
            reasons = [f"{name}: {text}" for refusal in refusals for _, name, text in refusal.reasons]
            self.form.message.show_refusal(sentence("; ".join(reasons)))
        return bool(is_done)

    def _tell(self, error: KindynaError) -> None:
        self.form.message.show_refusal(sentence(_reason(error)))

    # -- composed linkages --------------------------------------------------------------------------------

    def _pair(self, first: Dyad, second: Dyad) -> None:
        """Show the linkage of two dyads that were clicked as the first card, unless the task has changed since."""
        if self.busy:
            return
        try:
            answer = answer_of_dyads(self.task, first, second)
        except KindynaError as error:
            self._tell(error)
        else:
            self.form.message.show_refusal("")
            self.strip.add_chosen(answer)

    def _change_over(self, answer: Answer) -> None:
        """Drive the selected linkage by its other side link, and judge it again."""
        try:
            changed = driven_by_other_link(answer, with_points(self.task))
        except KindynaError as error:
            self._tell(error)
        else:
            self.form.message.show_refusal("")
            self.strip.replace_selected(changed)

    # -- files --------------------------------------------------------------------------------------------

    def _ready_button(self) -> QPushButton:
        button = described(
            QPushButton("Ready tas&ks", autoDefault=False), tip="Straight lines, a dwell, a quick return"
        )
        menu = QMenu(button)
        menu.setToolTipsVisible(True)
        for name, description, path in ready_tasks():
            entry = add_entry(menu, name, partial(self._open, path), description)
            entry.setToolTip(description)
        button.setMenu(menu)
        return button

    def _open(self, path: AnyPath) -> None:
        self._read(lambda: self.show_task(load_task(path)))

    def _open_task(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, "Open a task", "", f"{TASK_FILES};;All files (*)")
        if name:
            self._open(name)

    def _save_task(self) -> None:
        name, _ = QFileDialog.getSaveFileName(self, "Save the task", "task.toml", TASK_FILES)
        if name:
            self._read(lambda: save_task(self.task, name))

    def _open_curve(self) -> None:
        name, _ = QFileDialog.getOpenFileName(self, "Points of a path", "", f"{CURVES};;All files (*)")
        if not name:
            return

        def read() -> None:
            self.show_task(replace(self.task, path=read_path(Path(name), closed=self.form.closed.isChecked())))
            self.sheet.fit()

        self._read(read)

    def _use_path(self, name: str) -> None:
        """Make the path of a point of the present linkage the task."""

        def use() -> None:
            study = self.session.study
            points = path_of(study, name)
            path = stroke_path(points[: points.size // 2 + 1] if study.swings else points)
            if path is not None:
                self.show_task(replace(self.task, path=path))
                self.sheet.fit()

        self._read(use)

    def _read(self, action: Callable[[], object]) -> None:
        """Do something with a file or a path; show why it cannot be done."""
        try:
            action()
        except KindynaError as error:
            self._tell(error)


def _button(text: str, action: Callable[[], object]) -> QPushButton:
    button = QPushButton(text, autoDefault=False)
    button.clicked.connect(lambda: action())
    return button


def _reason(error: KindynaError) -> str:
    """The first fault of a task, with the names of the form for its fields."""
    text = str(error).splitlines()[0]
    for key, name in FIELD_NAMES.items():
        text = re.sub(rf"\b{re.escape(key)}\[(\d+)\]", partial(_numbered, name), text)
        text = text.replace(key, name) if "." in key else text
    return text


def _numbered(name: str, match: re.Match[str]) -> str:
    """Name of a field with the number of its row, which counts from 1."""
    return f"{name} {int(match[1]) + 1}"
