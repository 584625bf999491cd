"""The session: the design being worked on, its undo stack and its file. Views pull from it; nothing else owns these."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoStack

from core.design import (
    Design,
    blunders,
    closed_design,
    differs_in_one_value,
    drive_names,
    edited,
    faults,
    merged,
    missing_of_motion,
    motion_of,
    only,
    path_of,
    require_motion,
    row_at,
    with_assumed,
    with_motion,
    with_only,
    with_value,
)
from core.design.linkage_rules import only_incomplete
from core.errors import DesignError, Fault, KindynaError
from core.followers.cam_slider import LAYOUT, in_layout
from core.mechanism.unfinished import is_overconstrained
from core.motion.program import ShaftPosition
from core.project import dumps, loads
from core.project.on_disk import DesignFiles, OnDisk
from core.study import Camshaft, Study
from kindyna_gui.background import PendingResult
from kindyna_gui.documents.edits import (
    SAMPLES,
    IncompleteDesign,
    Refusal,
    Texts,
    UndoStep,
    fault_texts,
    refusal_reasons,
)
from kindyna_gui.labels import name_of, reason, segment_of

Work = tuple[Design, IncompleteDesign | None, int]
"""A whole design, what has been typed of a motion that is not finished, and the number of the drive that it was typed in; one step
of the undo stack changes all, so that undo shows the drive that it changes."""

MOTION, SHAFT, BALANCER = "motion", "shaft", "balancer"
OF_WHOLE = (SHAFT, "drives", "timing", BALANCER)
BALANCE_CAM = "Balance cam"


class Session(QObject):
    """Owns the design and the undo stack.

    whole    the design as its file has it, of one drive or of several on one shaft; files hold it
    chosen   number of the drive that forms and single plots show, from 0
    design   that drive as a design of its own; where the file is of one drive, the file's
    draft    all that is typed where it does not fit together, while ``whole`` is the last that did; None where it fits. ``typed`` is
             the chosen drive as typed, ``typed_full_design`` all drives

    design_changed   another design is in place, or another drive is chosen
    full_design_changed    another whole is in place, or another drive is chosen; the design of the drive may be the same
    incomplete_changed    another draft is in place, or none any more; the design may be the same
    started          another design begins; what was chosen or zoomed for the one before is void
    drive_chosen     forms and single plots show another drive from now on, by the user's choice or by undo
    restored         it was not typed: undo, redo, or another file; what was typed and refused is void
    refused          (Refusal): what was entered cannot be, whatever else is typed, or is no value; nothing changes
    mended           what was refused last has been put right, or taken back, by hand
    accepted         (path): nothing is wrong any longer with what was typed there
    file_changed     path or saved state changed
    segment_chosen   another segment of the motion is the chosen one
    load_chosen      another row of the loads is the chosen one, or none
    step_changed     another step of the circle diagram is shown
    vary_requested      (path in the whole file): the user wants to see what a number changes
    """

    design_changed = Signal()
    full_design_changed = Signal()
    incomplete_changed = Signal()
    started = Signal()
    drive_chosen = Signal()
    restored = Signal()
    refused = Signal(Refusal)
    mended = Signal()
    accepted = Signal(str)
    file_changed = Signal()
    segment_chosen = Signal()
    load_chosen = Signal()
    step_changed = Signal()
    vary_requested = Signal(str)

    def __init__(self, design: Design, path: Path | None = None) -> None:
        super().__init__()
        self.stack = QUndoStack(self)
        self.full_design: Any = design
        self.chosen = 0
        self.design: Any = only(design, 0)
        self.incomplete: IncompleteDesign | None = None
        self.path = path
        self.document = 0  # its number: opening or beginning anew counts, a step of the undo stack does not
        self._gesture = 0
        self._any_refused = False  # since something was taken back last
        self.drag_source: object = None  # where something is drawn with the mouse: each of its moves is a design
        self.stages_of_drag: tuple[str, ...] | None = (
            None  # what was on the screen when it was taken hold of, once it is known
        )
        self._segment = 0
        self._load = ""
        self._running = ("", -1)  # path and gesture of the last step
        self._cells: set[tuple[int, str]] = (
            set()
        )  # drive and path of the values of a motion typed since it had other segments
        self._before: Design | None = None
        self.step: int | None = None
        self._study: Study | None = None
        self._full_study: Study | None = None
        self._at: tuple[float, Study] | None = None
        self.pending = PendingResult(self)
        self.stages_on_screen: Callable[[], Iterable[str]] = tuple
        self._unchanged: list[tuple[Design, Path | None]] = [(design, path)]
        self._files = DesignFiles()
        if path is not None:
            self._files.note(path, design)
        self.stack.cleanChanged.connect(self.file_changed)
        self.stack.indexChanged.connect(self._step_taken)

    # -- what views pull ----------------------------------------------------------------------------------

    @property
    def study(self) -> Study:
        """The study of the design in place; its stages are computed when they are read."""
        if self._study is None:
            self._study = Study(self.design, SAMPLES)
        return self._study

    @property
    def work(self) -> Work:
        """All that a step of the undo stack changes."""
        return self.full_design, self.incomplete, self.chosen

    @property
    def several(self) -> bool:
        """Whether the design lists its drives."""
        listed: bool = self.full_design.listed
        return listed

    @property
    def angle_name(self) -> str:
        """What all drives turn by together: ``machine angle``; of one drive its own angle."""
        return "machine angle" if self.several else self.study.angle_name

    @property
    def place(self) -> ShaftPosition:
        """Where the chosen drive stands on its shaft; one alone is shown by its own angle."""
        if not self.several:
            return ShaftPosition()
        return self.shaft.balancer_position if self.on_balancer else self.shaft.positions[self.names[self.chosen]]

    @property
    def shaft(self) -> Camshaft[Study]:
        """What all drives do together on their shaft."""
        return self.full_study.camshaft

    @property
    def names(self) -> tuple[str, ...]:
        """The drives by name, the balance cam behind them where there is one."""
        return (*drive_names(self.full_design), *(() if self.full_design.balancer is None else (BALANCE_CAM,)))

    @property
    def on_balancer(self) -> bool:
        """Whether the balance cam is the one that is shown: it follows from the drives, and cannot be edited as one."""
        return self.chosen == len(self.full_design.drives)

    def _alone(self, whole: Design, index: int) -> Design:
        """A drive, or the balance cam, as a design of its own. Raises NoSolution where nothing can balance the torque."""
        if index < len(whole.drives):
            return only(whole, index)
        cam = Study(whole, SAMPLES).camshaft.balancer
        assert cam is not None, "a design without [balancer]"
        return cam.design

    @property
    def full_study(self) -> Study:
        """The study of all that the file has; that of the design in place, where that lists no drives."""
        if not self.several:
            return self.study
        if self._full_study is None:
            self._full_study = Study(self.full_design, SAMPLES)
        return self._full_study

    def at(self, theta: float) -> Study:
        """That of the drive at one cam angle [rad], for exact readings there; views that follow the cam share it."""
        if self._at is None or self._at[0] != theta:
            self._at = (theta, self.study.at_theta(np.array([theta])))
        return self._at[1]

    def choose_step(self, step: int | None) -> None:
        """The step of the circle diagram that views show: 0 what is known at sight, then a centre each; None: none."""
        if step != self.step:
            self.step = step
            self.step_changed.emit()

    @property
    def before(self) -> Design | None:
        """The design before the last step, or before the gesture that runs; None after undo, redo, another drive or another file."""
        return self._before

    @property
    def segment(self) -> int:
        """The number of the chosen segment, from 0: the one that the user works on, whichever view it was chosen in."""
        motion = motion_of(self.typed)
        return min(self._segment, len(motion.segments) - 1) if motion is not None else 0

    def choose_segment(self, number: int) -> None:
        """Choose a segment by its number, from 0."""
        if number != self._segment:
            self._segment = number
            self.segment_chosen.emit()

    @property
    def load(self) -> str:
        """The chosen row of the loads: ``loads.springs[0]``; empty where none is."""
        name, number, _ = row_at(self._load)
        rows = getattr(self.typed.drive.loads, name.removeprefix("loads."), ())
        return self._load if 0 <= number < len(rows) else ""

    def choose_load(self, path: str) -> None:
        """Choose a row of the loads by its path; empty: none."""
        if path != self._load:
            self._load = path
            self.load_chosen.emit()

    @property
    def modified(self) -> bool:
        """Whether something has changed since the file was read or written."""
        return not self.stack.isClean()

    def choose_drive(self, index: int) -> bool:
        """Let forms and single plots show the drive of this number; no step of the undo stack. False where it cannot be shown."""
        if index == self.chosen:
            return True
        try:
            self._alone(self.full_design, index)
        except KindynaError as error:
            self.refuse(BALANCER, reason(self.full_design, error))
            return False
        self._show((self.full_design, self.incomplete, index), restored=True)
        return True

    # -- what does not fit together yet ----------------------------------------------------------------------

    @property
    def typed_full_design(self) -> Any:
        """All drives as typed; they may have faults."""
        return self.full_design if self.incomplete is None else self.incomplete.design

    @property
    def typed(self) -> Any:
        """The chosen drive as typed, as a design of its own. It may have faults."""
        return self.design if self.incomplete is None or self.on_balancer else only(self.incomplete.design, self.chosen)

    @property
    def is_incomplete_linkage(self) -> bool:
        """Whether what is typed is a linkage that is being drawn, and lacks no more than to be a mechanism."""
        whole = self.typed_full_design
        if whole.listed or not whole.drive.links:
            return False
        if wrong := faults(whole):
            return only_incomplete(whole.drive, wrong)
        return is_overconstrained(whole.drive.linkage)

    @property
    def misfit(self) -> Refusal:
        """What does not fit together, as the forms of the chosen drive name it; without reasons where all does."""
        return Refusal("", ()) if self.incomplete is None else self.incomplete.refusal(self.chosen)

    @property
    def closing(self) -> Any:
        """The design as typed with its motion made whole; None where that is whole, or nothing simple helps."""
        if self.incomplete is None or not missing_of_motion(self.typed):
            return None
        at = segment_of(self.misfit.path)
        return closed_design(self.typed, -1 if at is None else at)

    def close_motion(self) -> bool:
        """Make the unfinished motion whole with a return, as one step; False where that has no answer."""
        closing = self.closing
        self.end_gesture()
        if closing is None:
            self.refuse(MOTION, "no single return makes it whole; change a span or a rise")
            return False
        return self.lay_out(closing, "Close the motion", MOTION)

    def drop_incomplete(self, motion_alone: bool = False) -> None:
        """Back to the last design that fitted together, or to its motion alone, as one step."""
        self.end_gesture()
        if motion_alone and self.incomplete is not None:
            self.lay_out(with_motion(self.typed, require_motion(self.design)), "Drop the unfinished motion", MOTION)
        else:
            self._change((self.full_design, None, self.chosen), "Drop what does not fit", "")

    def lay_out(self, design: Design, label: str, path: str = "") -> bool:
        """Put another design of the drive in place as one step, made from ``typed``, whose values need not fit together: while they
        do not, all of them become the draft, and the last that fitted stays, with what of the step suits it.

        False where it is refused: for a fault that no other value can mend.
        """
        if self.on_balancer:
            return self._refuse_balancer(path)
        return self.lay_out_full_design(with_only(self.typed_full_design, self.chosen, design), label, path)

    def lay_out_full_design(self, typed: Design, label: str, path: str = "") -> bool:
        """The same of all drives, made from ``typed_full_design``."""
        if typed == self.typed_full_design:
            self.take_back(path)
            return True
        wrong = self._misfits(typed, self.full_design)
        if not wrong:
            return self._change((typed, None, self.chosen), label, path)
        if impossible := blunders(typed):
            return self._refuse(path, typed, fault_texts(typed, impossible))
        good = self.full_design if self.incomplete is None else merged(self.typed_full_design, self.full_design, typed)
        if self._misfits(good, self.full_design):
            good = self.full_design
        return self._change((good, IncompleteDesign(typed, self._in_whole(path), wrong), self.chosen), label, path)

    def state(self) -> dict[str, Any]:
        """Everything that would be lost with the window, as a plain dictionary of text, numbers and lists.

        It is another one after ``design_changed``, ``incomplete_changed`` and ``file_changed``, and only then.
        """
        return {
            "design": dumps(self.full_design),
            "drive": self.chosen,
            "path": None if self.path is None else str(self.path),
            "modified": self.modified,
            "draft": None if self.incomplete is None else self.incomplete.state(),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Begin with what ``state`` has given; the undo stack starts anew, and what was unsaved is unsaved.

        Raises DesignError where it cannot be read; then nothing changes.
        """
        try:
            design, path, modified = loads(state["design"], unfinished=True), state["path"], bool(state["modified"])
            draft = None if state["draft"] is None else IncompleteDesign.from_state(state["draft"])
            own = None if path is None else Path(path)
            chosen = min(max(int(state.get("drive", 0)), 0), len(design.drives) - 1)
        except (KeyError, TypeError, ValueError) as error:
            raise DesignError([Fault("state", str(error), "cannot be read", "what Session.state() gives")]) from error
        self.document += 1
        self._unchanged = [] if modified else [(design if draft is None else draft.design, own)]
        if own is not None:
            self._files.note(own, design)
        self.stack.clear()
        self._begin(((design, draft, chosen), own))
        if modified:
            self.stack.resetClean()

    # -- editing ------------------------------------------------------------------------------------------

    def edit(self, path: str, value: Any, label: str) -> bool:
        """Change the value at a path, with what goes with it; label names the step: ``Change rod to 850 mm``.

        A value that is impossible by itself is refused and nothing changes. One that does not fit to the others, or for which a
        stage on screen has no answer, stays in the draft. Steps at the same path become one until ``end_gesture``.
        """
        if path.startswith(f"{MOTION}."):
            typed = self.typed
            if self.incomplete is not None and differs_in_one_value(
                self.design, typed, path
            ):  # typed anew: in balance with the others again
                typed = with_motion(typed, require_motion(self.design))
            made = with_value(typed, path, value, [each for drive, each in self._cells if drive == self.chosen])
            self._cells.add((self.chosen, path))
            return self.lay_out(made, label, path)
        if self._is_of_whole(path):
            return self.lay_out_full_design(with_value(self.typed_full_design, path, value), label, path)
        if path == LAYOUT and self.incomplete is None:
            return self._choose_layout(edited(self.design, path, value), value, label)
        return self.lay_out(edited(self.typed, path, value), label, path)

    def _choose_layout(self, plain: Design, letter: str, label: str) -> bool:
        """Another layout of a cam slider: guide and fixed angle go along where it cannot be put together else."""
        if refusal_reasons(plain, ("linkage",)):
            made = in_layout(self.design, letter)
            if not refusal_reasons(made, ("linkage",)):
                return self.lay_out(made, f"{label}, with guide height and fixed angle", LAYOUT)
        return self.lay_out(plain, label, LAYOUT)

    def mark_assumed(self, path: str, on: bool, label: str) -> bool:
        """Mark a value as assumed, or no longer, as one step."""
        if self._is_of_whole(path):
            return self.lay_out_full_design(with_assumed(self.typed_full_design, path, on), label, path)
        return self.lay_out(with_assumed(self.typed, path, on), label)

    def holder(self, path: str) -> Any:
        """The design that a path leads into, as typed: the drive, or the whole for what its drives share, and for a path of the
        whole file."""
        return self.typed_full_design if self._is_of_whole(path) else self.typed

    def waits(self, path: str, read: Callable[[Design], Any]) -> bool:
        """Whether what is typed at a path, as read from a design, is not in place, since it does not fit to the rest yet."""
        if self.incomplete is None:
            return False
        try:
            return bool(read(self.full_design if self._is_of_whole(path) else self.design) != read(self.holder(path)))
        except (KeyError, DesignError):  # there only as typed
            return True

    def _is_of_whole(self, path: str) -> bool:
        """Whether a path leads to what drives that are listed share, or is one of the whole file: ``drives[1].phase_deg``."""
        return self.several and path.partition(".")[0].partition("[")[0] in OF_WHOLE

    def _in_whole(self, path: str) -> str:
        """The path in the whole file of one that the forms of the chosen drive have."""
        alone = self.several and not self.on_balancer and path.partition(".")[0] in (*self.design.tables, "name")
        return path_of(self.chosen, path) if alone and not self._is_of_whole(path) else path

    def vary(self, path: str) -> None:
        """The user wants to see what the number at a path of the chosen drive changes."""
        self.vary_requested.emit(self._in_whole(path))

    def put(self, design: Design, label: str, path: str = "") -> bool:
        """Put another design of the drive in place as one step, made from ``design``; False where it is refused, for its faults or
        since a stage on screen has no answer. What is unfinished beside it stays so, but for the values that this changes."""
        if self.on_balancer:
            return self._refuse_balancer(path)
        whole = with_only(self.full_design, self.chosen, design)
        return self._put(whole, self._misfits(whole, self.full_design), label, path, self.chosen)

    def put_full_design(self, whole: Design, label: str, path: str = "", chosen: int | None = None) -> bool:
        """Put another whole in place as one step, of which this drive is chosen then, the same one where none is named; False
        where it is refused: of drives that are listed for its faults alone, since one that cannot be assembled takes no other with
        it."""
        wrong = fault_texts(whole, faults(whole)) if whole.listed else self._misfits(whole, self.full_design)
        index = self.chosen if chosen is None else chosen
        return self._put(whole, wrong, label, path, min(index, len(whole.drives) - (whole.balancer is None)))

    def _put(self, whole: Design, wrong: Texts, label: str, path: str, chosen: int) -> bool:
        if wrong:
            return self._refuse(path, whole, wrong)
        typed, draft = merged(self.full_design, self.typed_full_design, whole), None
        if self.incomplete is not None and (left := self._misfits(typed, whole)):
            draft = replace(self.incomplete, design=typed, reasons=left)
        return self._change((typed if draft is None else whole, draft, chosen), label, path)

    def _change(self, after: Work, label: str, path: str) -> bool:
        """One step, unless nothing changes."""
        if after != self.work:
            if not path or (path, self._gesture) != self._running:
                self._before = self.design
            self._running = (path, self._gesture)
            self.stack.push(UndoStep(self._show, self.work, after, label, path, self._gesture))
        self.take_back(path)
        return True

    def step_to(self, work: Work, text: str) -> None:
        """Work that was in place before, as a step of its own."""
        self.stack.push(UndoStep(self._show, self.work, work, text))

    def _refuse(self, path: str, whole: Design, wrong: Texts) -> bool:
        refusal, self._any_refused = IncompleteDesign(whole, path, wrong).refusal(self.chosen), True
        self.refused.emit(replace(refusal, path=path or refusal.reasons[0][0]))
        return False

    def _refuse_balancer(self, path: str) -> bool:
        self.refuse(
            path or BALANCER,
            "the balance cam follows from the torque of the drives; its spring and radii can be changed",
        )
        return False

    def refuse(self, path: str, why: str) -> None:
        """Something was typed at a path that cannot even be tried."""
        self._any_refused = True
        self.refused.emit(Refusal(path, ((path, name_of(self.typed, path), why),)))

    def withdraw(self, path: str) -> None:
        """What was refused at a path is void, for no field holds it; the reader may still want to know why."""
        self.accepted.emit(path)

    def take_back(self, path: str) -> None:
        """What was typed at a path and refused is mended, or taken back, by hand."""
        if self.drag_source and not self._any_refused:  # nothing was typed
            return
        self._any_refused = False
        self.mended.emit()
        self.accepted.emit(path)

    def end_gesture(self) -> None:
        """What comes next is a step of its own."""
        self._gesture += 1

    def begin_drag(self, where: object) -> None:
        """The mouse has taken hold of something in this widget: what it does next is one step, until ``release``."""
        self.end_gesture()
        self.drag_source, self.stages_of_drag = where, None

    def end_drag(self) -> None:
        """It has let go."""
        if self.drag_source:
            self.drag_source = None
            self.end_gesture()

    def end_field_drag(self, path: str, back_to: object = None) -> None:
        """The mouse has let go of the field of a path; back_to: ``work`` as it was when that was taken hold of, to which it goes back."""
        self.end_drag()
        self.withdraw(path)
        if back_to is not None and self.work != back_to:
            self.stack.undo()

    def _misfits(self, whole: Design, good: Design) -> Texts:
        """What does not fit together, path in the whole file and sentence: faults, else stages on screen of a drive that is another
        one than in a design that fits."""
        if whole == good:
            return ()
        if not whole.listed:
            return tuple((path, text) for path, _, text in refusal_reasons(whole, self.stages_on_screen()))
        if _shared(whole) != _shared(good) and (wrong := fault_texts(whole, faults(whole))):
            return wrong
        return tuple(
            (path if path.startswith(SHAFT) else path_of(i, path), text)
            for i, drive in enumerate(whole.drives)
            if drive not in good.drives
            for path, _, text in refusal_reasons(only(whole, i), self.stages_on_screen())
        )

    def _show(self, work: Work, *, restored: bool, begun: bool = False) -> None:
        whole, draft, chosen = work
        rewhole = begun or whole is not self.full_design or chosen != self.chosen
        redrafted = draft != self.incomplete
        try:
            design = self._alone(whole, chosen) if rewhole else self.design
        except KindynaError:  # nothing can balance this torque
            chosen, design = 0, only(whole, 0)
        stepped = restored and (whole is not self.full_design or redrafted)
        if begun or stepped or _segments(self.typed_full_design) != _segments(whole if draft is None else draft.design):
            self._cells.clear()
        rechosen = begun or chosen != self.chosen or whole.listed != self.full_design.listed
        recounted = len(whole.drives) != len(self.full_design.drives)
        if not rechosen and design == self.design:
            design = self.design  # what is of this drive stays as it is
        another = rechosen or design is not self.design
        if rechosen and not begun:
            self.choose_step(None)
            self.choose_load("")
            self.drive_chosen.emit()
        self.full_design, self.chosen, self.design, self.incomplete = whole, chosen, design, draft
        if rewhole:
            self._full_study = None
        if another:
            self._study = self._at = None
            self.pending.drop()
        if restored or rechosen or recounted:
            self._before = None
        if restored:
            self.end_gesture()
            self.restored.emit()
        if redrafted:
            self.incomplete_changed.emit()
        if another:
            self.design_changed.emit()
        if rewhole:
            self.full_design_changed.emit()

    # -- files --------------------------------------------------------------------------------------------

    def open(self, path: Path) -> None:
        """Open a file; the undo stack starts anew. Raises DesignError, FileError; then nothing changes."""
        self.start(self._files.read(path), path)

    def start(self, design: Design, path: Path | None = None) -> None:
        """Begin with a design; path None: it has no file yet."""
        self.document += 1
        self.stack.clear()
        self._unchanged = [(design, path)]
        self._begin(((design, None, 0), path))

    def begin(self, design: Design, text: str) -> None:
        """Begin with a design that has no file yet, as a step that can be undone; text names it."""
        self._unchanged.append((design, None))
        self.stack.push(UndoStep(self._begin, (self.work, self.path), ((design, None, 0), None), text))

    def reload(self) -> None:
        """Read the design's file again, as a step that can be undone. Raises DesignError, FileError; then nothing
        changes."""
        path = self._file()
        design = self._files.read(path)
        self._is_in_file(design, path)
        if (design, None) != (self.full_design, self.incomplete):
            self.stack.push(
                UndoStep(self._begin, (self.work, self.path), ((design, None, 0), path), f"Reload {path.name}")
            )
        self.stack.setClean()
        self.file_changed.emit()

    def _begin(self, state: tuple[Work, Path | None], *, restored: bool = True) -> None:
        work, self.path = state
        self.choose_step(None)
        self.choose_load("")
        self.started.emit()
        self._show(work, restored=True, begun=True)
        self.file_changed.emit()

    def _step_taken(self, *_: object) -> None:
        """What is typed and equal to its file, or to the design begun with, needs no saving, however it was reached."""
        if (self.typed_full_design, self.path) in self._unchanged:
            self.stack.setClean()

    def _is_in_file(self, design: Design, path: Path) -> None:
        self._unchanged = [each for each in self._unchanged if each[1] != path] + [(design, path)]

    def _file(self) -> Path:
        if self.path is None:
            raise KindynaError("no file name; choose one")
        return self.path

    def save(self, path: Path | None = None, *, last_fitting: bool = False) -> None:
        """Write what is typed, to its own file where none is named; last_fitting: the last design that fitted together, and what is
        typed stays beside it, unsaved.

        Raises FileError; DesignError where values contradict each other, which no file holds.
        """
        target, design = path or self._file(), self.full_design if last_fitting else self.typed_full_design
        self._files.write(design, target)
        self.path = target
        self._is_in_file(design, target)
        if design == self.typed_full_design:
            self.stack.setClean()
        else:
            self.stack.resetClean()
        self.end_gesture()
        self.file_changed.emit()

    def sources(self) -> tuple[str, ...]:
        """The files that the motions of the design's file follow from."""
        return () if self.path is None else self._files.sources(self.path)

    def changed_sources(self) -> tuple[str, ...]:
        """Those of them that hold something else than when the design was read."""
        return () if self.path is None else self._files.changed_sources(self.path)

    def on_disk(self) -> OnDisk:
        """Whether the design's file is as it was read or written last."""
        return OnDisk.SAME if self.path is None else self._files.state(self.path)


def _segments(whole: Design) -> list[int]:
    """How many each drive's motion has."""
    return [0 if drive.motion is None else len(drive.motion.segments) for drive in whole.drives]


def _shared(whole: Design) -> tuple[object, ...]:
    """What of a design of several drives can contradict in more than one of them."""
    return whole.shaft, whole.timing, whole.balancer, [(drive.name, drive.motion) for drive in whole.drives]


__all__ = ["SAMPLES", "Refusal", "Session", "Work"]
