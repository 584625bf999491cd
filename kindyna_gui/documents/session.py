"""The session: the design being worked on, its undo stack and its file. Views pull from it; nothing else owns these."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoStack

from core.design import (
    Design,
    blunders,
    closed_design,
    drive_at,
    drive_names,
    edited,
    faults,
    lacks,
    laid_out,
    motion_of,
    one_value_apart,
    only,
    with_assumed,
    with_only,
)
from core.errors import DesignError, Fault, KindynaError
from core.project import dumps, loads
from core.project.on_disk import DesignFiles, OnDisk
from core.study import ShaftStudy, Study
from kindyna_gui.documents.draft import Draft
from kindyna_gui.documents.refusal import SAMPLES, Reasons, Refusal, fault_reasons, refusal_reasons
from kindyna_gui.documents.undo_steps import BeginDesign, ChangeDesign, Work
from kindyna_gui.labels import name_of, segment_of

MOTION, SHAFT, BALANCER = "motion", "shaft", "balancer"
OF_WHOLE = (SHAFT, "drives", "timing", BALANCER)
BALANCE_CAM = "Balance cam"


class Session(QObject):
    """Owns the design and the undo stack.

    whole    the design as its file has it, of one drive or of several on one shaft; files hold it
    chosen   number of the drive that forms and single plots show, from 0
    design   that drive as a design of its own, the last one whose motion is whole; where the file is of one drive, the file's
    draft    a motion of it that is not finished, None where there is none; ``typed`` is the design with it

    design_changed   another design is in place, or another drive is chosen
    whole_changed    another whole is in place, or another drive is chosen; the design of the drive may be the same
    draft_changed    another draft is in place, or none any more; the design may be the same
    started          another design begins; what was chosen or zoomed for the one before is void
    drive_chosen     forms and single plots show another drive from now on, by the user's choice or by undo
    restored         it was not typed: undo, redo, or another file; what was typed and refused is void
    refused          (Refusal): an edit was wrong; the last good design stays
    mended           what was refused last has been put right, or taken back, by hand
    accepted         (path): nothing is wrong any longer with what was typed there
    file_changed     path or saved state changed
    segment_chosen   another segment of the motion is the chosen one
    load_chosen      another row of the loads is the chosen one, or none
    step_changed     another step of the circle diagram is shown
    let_go           what was drawn with the mouse is let go
    """

    design_changed = Signal()
    whole_changed = Signal()
    draft_changed = Signal()
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
    let_go = Signal()

    def __init__(self, design: Design, path: Path | None = None) -> None:
        super().__init__()
        self.stack = QUndoStack(self)
        self.whole: Any = design
        self.chosen = 0
        self.design: Any = only(design, 0)
        self.draft: Draft | None = None
        self.path = path
        self.document = 0  # its number: opening or beginning anew counts, a step of the undo stack does not
        self._gesture = 0
        self.held = False  # something is drawn with the mouse: each of its moves is a design
        self._segment = 0
        self._load = ""
        self._running = ("", -1)  # path and gesture of the last step
        self._before: Design | None = None
        self.step: int | None = None
        self._study: Study | None = None
        self._shaft: ShaftStudy | None = None
        self._at: tuple[float, Study] | None = None
        self.stages_on_screen: Callable[[], Iterable[str]] = tuple
        self._unchanged: list[tuple[Design, Path | None]] = [(design, path)]
        self._files = DesignFiles()
        if path is not None:
            self._files.note(path)
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
    def several(self) -> bool:
        """Whether the design lists its drives."""
        listed: bool = self.whole.listed
        return listed

    @property
    def shaft(self) -> ShaftStudy:
        """The study of all drives together, of a design that lists them."""
        if self._shaft is None:
            self._shaft = ShaftStudy(self.whole, SAMPLES)
        return self._shaft

    @property
    def names(self) -> tuple[str, ...]:
        """The drives by name, the balance cam behind them where there is one."""
        balanced = self.several and self.whole.balancer is not None
        return (*drive_names(self.whole), *((BALANCE_CAM,) if balanced else ()))

    @property
    def on_balancer(self) -> bool:
        """Whether the balance cam is the one that is shown: it follows from the drives, and cannot be edited as one."""
        return self.chosen == len(self.whole.drives)

    def _alone(self, whole: Design, index: int) -> Design:
        """A drive, or the balance cam, as a design of its own. Raises NoAnswer where nothing can balance the torque."""
        if index < len(whole.drives):
            return only(whole, index)
        cam = ShaftStudy(whole, SAMPLES).balancer
        assert cam is not None, "a design without [balancer]"
        return cam.design

    @property
    def whole_study(self) -> Study | ShaftStudy:
        """The study of all that the file has: of the shaft with its drives, or of the only one."""
        return self.shaft if self.several else self.study

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
        """The design before the last step, or before the gesture that runs; None after undo, redo or another file."""
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
        match = re.fullmatch(r"loads\.(\w+)\[(\d+)\]", self._load)
        return self._load if match and int(match[2]) < len(getattr(self.design.drive.loads, match[1], ())) else ""

    def choose_load(self, path: str) -> None:
        """Choose a row of the loads by its path; empty: none."""
        if path != self._load:
            self._load = path
            self.load_chosen.emit()

    @property
    def modified(self) -> bool:
        return not self.stack.isClean() or self.draft is not None

    def choose_drive(self, index: int) -> bool:
        """Let forms and single plots show the drive of this number; no step of the undo stack. False where the one that they
        show has a motion that is not finished."""
        if index == self.chosen:
            return True
        if not self._may_leave_drive():
            return False
        try:
            self._alone(self.whole, index)
        except KindynaError as error:
            self.refuse(BALANCER, str(error))
            return False
        self._show(self.whole, None, index, restored=True)
        return True

    def _may_leave_drive(self) -> bool:
        """An unfinished motion belongs to the drive that is shown."""
        if self.draft is not None:
            self.refuse(MOTION, f"the motion of {self.design.name} is not finished; close it or drop it first")
        return self.draft is None

    # -- a motion that is not finished ----------------------------------------------------------------------

    @property
    def typed(self) -> Any:
        """The design as typed: with the unfinished motion where there is one. It may have faults."""
        return self.design if self.draft is None else self.draft.applied(self.design)

    @property
    def closing(self) -> Any:
        """The design as typed with its motion made whole; None where nothing is unfinished, or nothing simple helps."""
        if self.draft is None:
            return None
        at = segment_of(self.draft.path)
        return closed_design(self.typed, -1 if at is None else at)

    def close_draft(self) -> bool:
        """Make the unfinished motion whole with a return, as one step; False where that has no answer."""
        closing = self.closing
        self.end_gesture()
        if closing is None:
            self.refuse(MOTION, "no single return makes it whole; change a span or a rise")
            return False
        wrong = self._why_not(closing)
        if wrong:
            self.refused.emit(Refusal(wrong[0][0], wrong))
            return False
        return self._step(closing, None, "Close the motion", MOTION)

    def drop_draft(self) -> None:
        """Back to the last whole motion, as one step."""
        self.end_gesture()
        self._step(self.design, None, "Drop the unfinished motion", MOTION)

    def lay_out(self, design: Design, label: str, path: str = "") -> bool:
        """Put another motion in place as one step, which need not be whole: made from ``typed``, it differs in nothing
        but its motion and the marks of that. While it is not whole it becomes the draft, and the design stays.

        False where it is refused: for a fault that nothing typed later can mend, or as ``put`` does.
        """
        wrong = fault_reasons(design, blunders(design))
        if wrong:
            self.refused.emit(Refusal(path or wrong[0][0], wrong))
            return False
        if lacks(design):
            return self._step(self.design, Draft.of(design, path), label, path)
        wrong = () if self.draft is None else self._why_not(design)
        if wrong:  # whole now, but without an answer: what was typed stays all the same
            reason = f"{wrong[0][1]}: {wrong[0][2]}"
            return self._step(self.design, Draft.of(design, path, reason), label, path)
        return self._step(design, None, label, path)

    def state(self) -> dict[str, Any]:
        """Everything that would be lost with the window, as a plain dictionary of text, numbers and lists.

        It is another one after ``design_changed``, ``draft_changed`` and ``file_changed``, and only then.
        """
        return {
            "design": dumps(self.whole),
            "drive": self.chosen,
            "path": None if self.path is None else str(self.path),
            "modified": self.modified,
            "draft": None if self.draft is None else self.draft.state(),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Begin with what ``state`` has given; the undo stack starts anew, and what was unsaved is unsaved.

        Raises DesignError where it cannot be read; then nothing changes.
        """
        try:
            design, path, modified = loads(state["design"]), state["path"], bool(state["modified"])
            draft = None if state["draft"] is None else Draft.from_state(state["draft"])
            own = None if path is None else Path(path)
            chosen = min(max(int(state.get("drive", 0)), 0), len(design.drives) - 1)
        except (KeyError, TypeError, ValueError) as error:
            raise DesignError([Fault("state", str(error), "cannot be read", "what Session.state() gives")]) from error
        self.document += 1
        self._unchanged = [] if modified else [(design, own)]
        if own is not None:
            self._files.note(own)
        self.stack.clear()
        self._begin(design, own, draft, chosen)
        if modified:
            self.stack.resetClean()

    # -- editing ------------------------------------------------------------------------------------------

    def edit(self, path: str, value: Any, label: str) -> bool:
        """Change the value at a path, with what goes with it; label names the step: ``Change rod to 850 mm``.

        A wrong value, or one for which a stage on screen has no answer, is refused and nothing changes. A motion that
        is not whole then becomes the draft. Steps at the same path become one until ``end_gesture``.
        """
        if path.startswith(f"{MOTION}."):
            again = self.draft is not None and one_value_apart(self.design, self.typed, path)
            return self.lay_out(laid_out(self.design if again else self.typed, path, value), label, path)
        if self._is_of_whole(path):
            return self.put_whole(edited(self.whole, path, value), label, path)
        return self.put(edited(self.design, path, value), label, path)

    def mark_assumed(self, path: str, on: bool, label: str) -> bool:
        """Mark a value as assumed, or no longer, as one step."""
        if path.startswith(f"{MOTION}."):
            return self.lay_out(with_assumed(self.typed, path, on), label)
        if self._is_of_whole(path):
            return self.put_whole(with_assumed(self.whole, path, on), label)
        return self.put(with_assumed(self.design, path, on), label)

    def holder(self, path: str) -> Any:
        """The design that a path leads into: the drive as typed, or the whole for what its drives share, and for a path of the
        whole file."""
        return self.whole if self._is_of_whole(path) else self.typed

    def _is_of_whole(self, path: str) -> bool:
        """Whether a path leads to what drives that are listed share, or is one of the whole file: ``drives[1].phase_deg``."""
        return self.several and path.partition(".")[0].partition("[")[0] in OF_WHOLE

    def put(self, design: Design, label: str, path: str = "") -> bool:
        """Put another design of the drive in place as one step; False where it is refused.

        An unfinished motion stays, unless the design brings another motion than the last whole one.
        """
        kept = self.draft is not None and motion_of(design) == motion_of(self.design)
        return self._step(design, self.draft if kept else None, label, path)

    def put_whole(self, whole: Design, label: str, path: str = "", chosen: int | None = None) -> bool:
        """Put another whole in place as one step, of which this drive is chosen then, the same one where none is named; False
        where it is refused: for its faults alone, since a drive that cannot be assembled takes no other with it."""
        index = self.chosen if chosen is None else chosen
        index = min(index, len(whole.drives) - (whole.balancer is None))
        kept = self.draft is not None and motion_of(self._alone(whole, index)) == motion_of(self.design)
        if not kept and not self._may_leave_drive():
            return False
        return self._change((whole, self.draft, index), self._faults(whole), label, path)

    def put_file(self, design: Design, label: str, path: str = "") -> bool:
        """Put another design of all that the file has in place as one step; False where it is refused."""
        return self.put_whole(design, label, path) if self.several else self.put(design, label, path)

    def _step(self, design: Design, draft: Draft | None, label: str, path: str) -> bool:
        """Put design and draft of the drive in place together; False where the design is refused."""
        if draft is not None and draft.reason:  # another length may have given it an answer
            finished = draft.applied(design)
            if not self._why_not(finished):
                design, draft = finished, None
        same = design == self.design
        if self.on_balancer and not (same and draft is None):
            self.refuse(path or BALANCER, "the balance cam follows from the torque of the drives; its spring and radii can be changed")
            return False
        whole = self.whole if same else with_only(self.whole, self.chosen, design)
        return self._change((whole, draft, self.chosen), () if same else self._why_not(design), label, path)

    def _change(self, after: Work, wrong: Reasons, label: str, path: str) -> bool:
        """One step, unless something is wrong with it or nothing changes."""
        if after == (self.whole, self.draft, self.chosen):
            self.take_back(path)
            return True
        if wrong:
            self.refused.emit(Refusal(path or wrong[0][0], wrong))
            return False
        if not path or (path, self._gesture) != self._running:
            self._before = self.design
        self._running = (path, self._gesture)
        self.stack.push(ChangeDesign(self, after, label, path, self._gesture))
        self.take_back(path)
        return True

    def refuse(self, path: str, why: str) -> None:
        """Something was typed at a path that cannot even be tried."""
        self.refused.emit(Refusal(path, ((path, name_of(self.design, path), why),)))

    def withdraw(self, path: str) -> None:
        """What was refused at a path is void, for no field holds it; the reader may still want to know why."""
        self.accepted.emit(path)

    def take_back(self, path: str) -> None:
        """What was typed at a path and refused is mended, or taken back, by hand."""
        self.mended.emit()
        self.accepted.emit(path)

    def end_gesture(self) -> None:
        """What comes next is a step of its own."""
        self._gesture += 1

    def take_hold(self) -> None:
        """The mouse has taken hold of something: what it does next is one step, until ``release``."""
        self.end_gesture()
        self.held = True

    def release(self) -> None:
        """It has let go."""
        if self.held:
            self.held = False
            self.end_gesture()
            self.let_go.emit()

    def _why_not(self, design: Design) -> Reasons:
        """Of a design of the drive: faults of the whole with it, else a stage of this drive that has no answer."""
        was = self.design
        shared = (design.name, design.shaft, motion_of(design)) != (was.name, was.shaft, motion_of(was))  # names, speed, timing
        wrong = self._faults(with_only(self.whole, self.chosen, design)) if self.several and shared else ()
        return wrong or refusal_reasons(design, self.stages_on_screen())

    def _faults(self, whole: Design) -> Reasons:
        """Faults of the whole; of the chosen drive by the paths that its forms have."""
        rows = []
        for path, name, text in fault_reasons(whole, faults(whole)):
            own = drive_at(path)
            if own is not None and own[0] == self.chosen:
                path, name = own[1], name_of(only(whole, self.chosen), own[1])
            rows.append((path, name, text))
        return tuple(rows)

    def _show(self, whole: Design, draft: Draft | None, chosen: int, restored: bool, begun: bool = False) -> None:
        rewhole = begun or whole is not self.whole or chosen != self.chosen
        redrafted = draft != self.draft
        try:
            design = self._alone(whole, chosen) if rewhole else self.design
        except KindynaError:  # nothing can balance this torque
            chosen, design = 0, only(whole, 0)
        rechosen = begun or chosen != self.chosen or whole.listed != self.whole.listed
        if not rechosen and design == self.design:
            design = self.design  # what is of this drive stays as it is
        another = rechosen or design is not self.design
        if rechosen and not begun:
            self.choose_step(None)
            self.choose_load("")
            self.drive_chosen.emit()
        self.whole, self.chosen, self.design, self.draft = whole, chosen, design, draft
        if rewhole:
            self._shaft = None
        if another:
            self._study = self._at = None
        if restored:
            self._before = None
            self.end_gesture()
            self.restored.emit()
        if redrafted:
            self.draft_changed.emit()
        if another:
            self.design_changed.emit()
        if rewhole:
            self.whole_changed.emit()

    # -- files --------------------------------------------------------------------------------------------

    def open(self, path: Path) -> None:
        """Open a file; the undo stack starts anew. Raises DesignError, FileError; then nothing changes."""
        self.start(self._files.read(path), path)

    def start(self, design: Design, path: Path | None = None) -> None:
        """Begin with a design; path None: it has no file yet."""
        self.document += 1
        self.stack.clear()
        self._unchanged = [(design, path)]
        self._begin(design, path)

    def begin(self, design: Design, text: str) -> None:
        """Begin with a design that has no file yet, as a step that can be undone; text names it."""
        self._unchanged.append((design, None))
        self.stack.push(BeginDesign(self, design, None, text))

    def reload(self) -> None:
        """Read the design's file again, as a step that can be undone. Raises DesignError, FileError; then nothing
        changes."""
        path = self._file()
        design = self._files.read(path)
        self._is_in_file(design, path)
        if (design, None) != (self.whole, self.draft):
            self.stack.push(BeginDesign(self, design, path, f"Reload {path.name}"))
        self.stack.setClean()
        self.file_changed.emit()

    def _begin(self, design: Design, path: Path | None, draft: Draft | None = None, chosen: int = 0) -> None:
        self.path = path
        self.choose_step(None)
        self.choose_load("")
        self.started.emit()
        self._show(design, draft, chosen, restored=True, begun=True)
        self.file_changed.emit()

    def _step_taken(self, *_: object) -> None:
        """A design equal to its file, or to the one begun with, needs no saving, however it was reached."""
        if self.draft is None and (self.whole, self.path) in self._unchanged:
            self.stack.setClean()

    def _is_in_file(self, design: Design, path: Path) -> None:
        self._unchanged = [each for each in self._unchanged if each[1] != path] + [(design, path)]

    def _file(self) -> Path:
        if self.path is None:
            raise KindynaError("no file name; choose one")
        return self.path

    def save(self, path: Path | None = None) -> None:
        """Write the design, to its own file where none is named; an unfinished motion stays beside it, unsaved.

        Raises FileError, DesignError.
        """
        target = path or self._file()
        self._files.write(self.whole, target)
        self.path = target
        self._is_in_file(self.whole, target)
        self.stack.setClean()
        self.end_gesture()
        self.file_changed.emit()

    def on_disk(self) -> OnDisk:
        """Whether the design's file is as it was read or written last."""
        return OnDisk.SAME if self.path is None else self._files.state(self.path)


__all__ = ["SAMPLES", "ChangeDesign", "Refusal", "Session"]
