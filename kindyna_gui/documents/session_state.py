"""State of the session: the current design, its undo stack, the selection, and what is computed from it.

The session owns these alone, and views read them. A step of the undo stack changes a ``Work``: the full design, the
incomplete design and the selected drive, so that undo shows the drive that it changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoStack

from core.design import (
    Design,
    closed_design,
    drive_names,
    faults,
    missing_of_motion,
    motion_of,
    only,
    path_of,
    row_at,
)
from core.design.camshaft import unsolved_motions, with_plain_laws
from core.design.curves import solve_laws, unsolved_segment
from core.design.linkage_rules import only_incomplete
from core.errors import DesignError, KindynaError, NoSolution
from core.motion.program import ShaftPosition
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
from kindyna_gui.labels import name_of, segment_of
from kindyna_gui.rebuilt import single_shot

Work = tuple[Design, IncompleteDesign | None, int]
"""The full design, what is typed while it does not fit together, and the number of the selected drive."""

MOTION, SHAFT, BALANCER = "motion", "shaft", "balancer"
SHARED = (SHAFT, "engine", "drives", "timing", "outlines", "clearances", BALANCER)
"""Tables that the drives of a design share."""
BALANCE_CAM = "Balance cam"
KEYS_REST_MS = 100  # from the last step by a key until the steps have ended


class SessionState(QObject):
    """The current design with its undo stack, the selection, and what is computed from it.

    Attributes
    ----------
    full_design : Design
        The design as its file has it: one drive, or several on one shaft.
    chosen : int
        Number of the selected drive, which forms and single plots show, from 0.
    design : Design
        The selected drive as a design by itself; where the file has one drive, the same as ``full_design``.
    incomplete : IncompleteDesign or None
        Everything typed, while it does not fit together and ``full_design`` is the last valid design; else None.
        Also while optimal laws of what is typed are being solved. Those of an opened design are not known then, and
        ``full_design`` is the same design with other laws, of which no view shows results. ``typed`` is the selected drive
        as typed, ``typed_full_design`` all drives.

    Signals
    -------
    design_changed
        The design has changed, or another drive is selected.
    full_design_changed
        The full design has changed, or another drive is selected; the design of the drive may be the same.
    incomplete_changed
        The incomplete design has changed; the design may be the same.
    started
        Another design is opened; selection and zoom of the last one are void.
    drive_chosen
        Forms and single plots show another drive from now on, by the user's choice or by undo.
    restored
        Undo, redo or another file has changed the design; refused texts are void.
    refused : Refusal
        An entry was refused, whatever else is typed; nothing changes.
    corrected
        The last refused entry was corrected or withdrawn by the user.
    accepted : str
        Nothing is wrong any longer with the entry at this path.
    file_changed
        The path or the saved state has changed.
    segment_chosen, load_chosen
        Another segment of the motion, or another load, is selected.
    step_changed
        Another step of the circle diagram is shown.
    drag_ended
        The mouse has released what it dragged.
    steps_ended
        The keys rest that stepped a number.
    vary_requested : str
        The user wants to vary the number at this path of the full design.
    """

    design_changed = Signal()
    full_design_changed = Signal()
    incomplete_changed = Signal()
    started = Signal()
    drive_chosen = Signal()
    restored = Signal()
    refused = Signal(Refusal)
    corrected = Signal()
    accepted = Signal(str)
    file_changed = Signal()
    segment_chosen = Signal()
    load_chosen = Signal()
    step_changed = Signal()
    drag_ended = Signal()
    steps_ended = Signal()
    vary_requested = Signal(str)

    def __init__(self, design: Design, path: Path | None = None) -> None:
        super().__init__()
        self.stack = QUndoStack(self)
        self.drag_source: object = None  # the widget in which something is dragged; each of its moves is a design
        self.laws = PendingResult(self, "the laws of the motion", "Calculating the optimal laws of the motion")
        self.laws.known.connect(self._laws_known)
        self.full_design: Any
        self.incomplete: IncompleteDesign | None
        self.full_design, self.incomplete, self.chosen = self._current_state((design, None, 0))
        self.design: Any = only(self.full_design, 0)
        self.path = path
        self.document = 0  # number of the opened design; a step of the undo stack does not change it
        self._gesture = 0
        self._has_refused = False  # since the last call of ``clear_refusal``
        self.stages_of_drag: tuple[str, ...] | None = None  # stages on screen at the start of a drag, once known
        self._segment = 0
        self._load = ""
        self._running = ("", -1)  # path and gesture of the last step
        self._typed_values: set[tuple[int, str]] = set()  # drive and path of motion values typed with these segments
        # before the last step or gesture; None after undo, redo, another drive or another file
        self.before: Design | None = None
        self.step: int | None = None
        self._study: Study | None = None
        self._tried: Study | None = None  # of the design that was last checked
        self._full_study: Study | None = None
        self._at: tuple[float, Study] | None = None
        self.pending = PendingResult(
            self, "the steady response", "Calculating the shaft's steady response for an open view"
        )
        self._steps = single_shot(self, self.steps_ended.emit, KEYS_REST_MS)
        self.stages_on_screen: Callable[[], Iterable[str]] = tuple
        self._unchanged: list[tuple[Design, Path | None]] = [(design, path)]
        self.stack.cleanChanged.connect(self.file_changed)
        self.stack.indexChanged.connect(self._step_taken)

    # -- the study and the drives ----------------------------------------------------------------------

    @property
    def study(self) -> Study:
        """The study of the selected drive; its stages are computed when they are read."""
        if self._study is None:
            tried, self._tried = self._tried, None
            if tried is None or tried.design != self.design:
                tried = Study(self.design, SAMPLES)
            self._study = tried
        return self._study

    def _try(self, design: Design) -> Study:
        """Return a study to check a design of the drive; while the mouse drags something, it follows the branch of the current one."""
        self._tried = Study(design, SAMPLES)
        return self._tried if self.drag_source is None else self._tried.follow(self.study)

    @property
    def full_study(self) -> Study:
        """The study of the full design; that of the drive, where there is only one."""
        if not self.has_several_drives:
            return self.study
        if self._full_study is None:
            self._full_study = Study(self.full_design, SAMPLES)
        return self._full_study

    @property
    def shaft(self) -> Camshaft[Study]:
        """All drives together on their shaft."""
        return self.full_study.camshaft

    def at(self, theta: float) -> Study:
        """Return the study of the drive at one cam angle [rad], for exact readings; views share it."""
        if self._at is None or self._at[0] != theta:
            self._at = (theta, self.study.at_theta(np.array([theta])))
        return self._at[1]

    @property
    def work(self) -> Work:
        """Everything that a step of the undo stack changes."""
        return self.full_design, self.incomplete, self.chosen

    @property
    def has_several_drives(self) -> bool:
        """Whether the design is a list of drives."""
        listed: bool = self.full_design.listed
        return listed

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the drives, then of the balance cam, where there is one."""
        return (*drive_names(self.full_design), *(() if self.full_design.balancer is None else (BALANCE_CAM,)))

    @property
    def is_on_balancer(self) -> bool:
        """Whether the balance cam is selected: it follows from the drives, and cannot be edited as one."""
        return self.chosen == len(self.full_design.drives)

    @property
    def angle_name(self) -> str:
        """The angle of all drives, ``machine angle``, or the angle of a single drive."""
        return "machine angle" if self.has_several_drives else self.study.angle_name

    @property
    def shaft_position(self) -> ShaftPosition:
        """Position of the selected drive on its shaft; a single drive is shown by its own angle."""
        if not self.has_several_drives:
            return ShaftPosition()
        return self.shaft.balancer_position if self.is_on_balancer else self.shaft.positions[self.names[self.chosen]]

    def _drive_design(self, design: Design, index: int) -> Design:
        """Return a drive, or the balance cam, as a design. Raises NoSolution where no cam balances the torque."""
        if index < len(design.drives):
            return only(design, index)
        cam = Study(design, SAMPLES).camshaft.balancer
        assert cam is not None, "a design without [balancer]"
        return cam.design

    # -- optimal laws, which are solved in the background ------------------------------------------------

    @property
    def has_laws(self) -> bool:
        """Whether the laws of the design are solved; until then no result is known, and ``full_design`` has other laws."""
        return self.incomplete is None or self.incomplete.stands_for is None

    @property
    def valid_full_design(self) -> Any:
        """The full design, with its own laws while they are being solved."""
        stands_for = None if self.incomplete is None else self.incomplete.stands_for
        return self.full_design if stands_for is None else stands_for

    def require_laws(self) -> None:
        """Raise NoSolution while the laws of the design are not solved."""
        if not self.has_laws:
            assert self.incomplete is not None, "it names the laws"
            ((path, text),) = self.incomplete.reasons
            raise NoSolution(text, path, "the button in the status line stops or restarts the calculation")

    def _solve_laws(self, *designs: Design) -> Texts:
        """Solve the laws of designs in the background; return path and state of the first that is not solved yet."""
        rows = [(design, motion) for design in designs for motion in unsolved_motions(design)]
        motions = tuple(dict.fromkeys(motion for _, motion in rows))
        if not motions:
            self.laws.drop()
            return ()
        state = self.laws.later(motions, partial(solve_laws, motions))
        if not state:
            return ()
        design, motion = rows[0]
        number = next(i for i, drive in enumerate(design.drives) if drive.motion == motion)
        path = f"motion.segments[{unsolved_segment(motion)}]"
        return ((path_of(number, path) if design.listed else path, f"its law {state}"),)

    def _current_state(self, work: Work) -> Work:
        """Return what is shown of a state: the state itself where its laws are solved."""
        full_design, incomplete, chosen = work
        if incomplete is None:
            incomplete = IncompleteDesign(full_design)
        valid = full_design if incomplete.stands_for is None else incomplete.stands_for
        waits = incomplete.waits or work[1] is None
        if unsolved := self._solve_laws(valid, *((incomplete.design,) if waits else ())):
            if unsolved_motions(valid):
                waiting = replace(incomplete, reasons=unsolved, waits=True, stands_for=valid)
                return _with_plain_laws(valid), waiting, chosen
            return valid, replace(incomplete, reasons=unsolved, waits=True, stands_for=None), chosen
        if not waits:
            return work
        if incomplete.design == valid:
            return valid, None, chosen
        if reasons := self._misfits(incomplete.design, valid):
            return valid, IncompleteDesign(incomplete.design, incomplete.path, reasons), chosen
        return incomplete.design, None, chosen

    def _laws_known(self) -> None:
        """Show the state whose laws are solved now, or that is no longer calculated."""
        work = self._current_state(self.work)
        if work != self.work:
            self._show(work, restored=False)

    # -- the selection ---------------------------------------------------------------------------------

    def choose_step(self, step: int | None) -> None:
        """Select the step of the circle diagram: 0 the centres known from the start, then one centre a step; None: none."""
        if step != self.step:
            self.step = step
            self.step_changed.emit()

    @property
    def segment(self) -> int:
        """Number of the selected segment, from 0, the same in all views."""
        motion = motion_of(self.typed)
        return min(self._segment, len(motion.segments) - 1) if motion is not None else 0

    def choose_segment(self, number: int) -> None:
        """Select a segment by its number, from 0."""
        if number != self._segment:
            self._segment = number
            self.segment_chosen.emit()

    @property
    def load(self) -> str:
        """Path of the selected load, such as ``loads.springs[0]``; empty where none is selected."""
        name, number, _ = row_at(self._load)
        rows = getattr(self.typed.drive.loads, name.removeprefix("loads."), ())
        return self._load if 0 <= number < len(rows) else ""

    def choose_load(self, path: str) -> None:
        """Select a load by its path; with an empty path none."""
        if path != self._load:
            self._load = path
            self.load_chosen.emit()

    @property
    def modified(self) -> bool:
        """Whether the design has changed since its file was read or written."""
        return not self.stack.isClean()

    # -- values that do not fit together yet -----------------------------------------------------------

    @property
    def typed_full_design(self) -> Any:
        """The full design as typed; it may have faults."""
        return self.full_design if self.incomplete is None else self.incomplete.design

    @property
    def typed(self) -> Any:
        """The selected drive as typed, as a design by itself; it may have faults."""
        return (
            self.design if self.incomplete is None or self.is_on_balancer else only(self.incomplete.design, self.chosen)
        )

    @property
    def is_incomplete_linkage(self) -> bool:
        """Whether a linkage is being drawn that is not yet a mechanism, and has no other fault."""
        return _is_incomplete_linkage(self.typed_full_design)

    @property
    def misfit(self) -> Refusal:
        """What does not fit together, as the forms of the selected drive name it; without reasons where all fits, or may fit."""
        if self.incomplete is None or self.incomplete.waits:
            return Refusal("", ())
        return self.incomplete.refusal(self.chosen)

    @property
    def waits_for(self) -> Refusal:
        """What is being solved before it is known whether what is typed fits; without reasons where that is known."""
        if self.incomplete is None or not self.incomplete.waits:
            return Refusal("", ())
        return self.incomplete.refusal(self.chosen)

    @property
    def closing(self) -> Any:
        """The typed design with its motion closed; None where it is closed already, or no single change closes it."""
        if self.incomplete is None or not missing_of_motion(self.typed):
            return None
        segment = segment_of(self.misfit.path)
        return closed_design(self.typed, -1 if segment is None else segment)

    def holder(self, path: str) -> Any:
        """Return the typed design that a path belongs to: the drive, or the full design for what its drives share."""
        return self.typed_full_design if self._is_shared(path) else self.typed

    def valid_holder(self, path: str) -> Any:
        """Return the last valid design that a path belongs to: the drive, or the full design for what its drives share."""
        return self.full_design if self._is_shared(path) else self.design

    def is_waiting(self, path: str, read: Callable[[Design], Any]) -> bool:
        """Whether the value typed at a path is not applied yet, because it does not fit the others.

        A drawing that only lacks something has no such value.
        """
        if self.incomplete is None or self.is_incomplete_linkage:
            return False
        try:
            return bool(read(self.valid_holder(path)) != read(self.holder(path)))
        except (KeyError, DesignError):  # only the typed design has it
            return True

    def _is_shared(self, path: str) -> bool:
        """Whether a path belongs to what several drives share, or to the full design, such as ``drives[1].phase_deg``."""
        return self.has_several_drives and path.partition(".")[0].partition("[")[0] in SHARED

    def _full_path(self, path: str) -> str:
        """Return the path in the full design of a path in the forms of the selected drive."""
        is_of_drive = (
            self.has_several_drives
            and not self.is_on_balancer
            and path.partition(".")[0] in (*self.design.tables, "name")
        )
        return path_of(self.chosen, path) if is_of_drive and not self._is_shared(path) else path

    def _misfits(self, design: Design, valid: Design) -> Texts:
        """Return path and sentence of what does not fit together: faults, else stages on screen without a solution.

        Of several drives only those are checked that differ from the valid design.
        """
        if design == valid:
            return ()
        if not design.listed:
            return tuple((path, text) for path, _, text in refusal_reasons(self._try(design), self.stages_on_screen()))
        if _shared(design) != _shared(valid) and (wrong := fault_texts(design, faults(design))):
            return wrong
        return tuple(
            (path if path.startswith(SHAFT) else path_of(i, path), text)
            for i, drive in enumerate(design.drives)
            if drive not in valid.drives
            for path, _, text in refusal_reasons(Study(only(design, i), SAMPLES), self.stages_on_screen())
        )

    # -- refused entries -------------------------------------------------------------------------------

    def _refuse(self, path: str, design: Design, wrong: Texts) -> bool:
        refusal, self._has_refused = IncompleteDesign(design, path, wrong).refusal(self.chosen), True
        self.refused.emit(replace(refusal, path=path or refusal.reasons[0][0]))
        return False

    def refuse(self, path: str, why: str) -> None:
        """Refuse what was typed at a path, with a reason, without trying it."""
        self._has_refused = True
        self.refused.emit(Refusal(path, ((path, name_of(self.typed, path), why),)))

    def withdraw(self, path: str) -> None:
        """Withdraw what was refused at a path, where no field shows it; the status line keeps the reason."""
        self.accepted.emit(path)

    def clear_refusal(self, path: str) -> None:
        """Clear the refusal at a path, after the user has corrected or withdrawn the entry."""
        if self.drag_source and not self._has_refused:  # nothing was typed
            return
        self._has_refused = False
        self.corrected.emit()
        self.accepted.emit(path)

    # -- undo steps and gestures -----------------------------------------------------------------------

    def _change(self, after: Work, label: str, path: str) -> bool:
        """Push a step on the undo stack, unless nothing changes."""
        if after != self.work:
            if not path or (path, self._gesture) != self._running:
                self.before = self.design if self.has_laws else None
            self._running = (path, self._gesture)
            self.stack.push(UndoStep(self._show, self.work, after, label, path, self._gesture))
        self.clear_refusal(path)
        return True

    def step_to(self, work: Work, text: str) -> None:
        """Restore an earlier state as a step of the undo stack."""
        self.stack.push(UndoStep(self._show, self.work, work, text))

    def _show(self, work: Work, *, restored: bool, begun: bool = False) -> None:
        full_design, incomplete, chosen = self._current_state(work)
        is_new = begun or full_design is not self.full_design or chosen != self.chosen
        is_incomplete_new = incomplete != self.incomplete
        try:
            design = self._drive_design(full_design, chosen) if is_new else self.design
        except KindynaError:  # no cam balances this torque
            chosen, design = 0, only(full_design, 0)
        typed = full_design if incomplete is None else incomplete.design
        is_stepped = restored and (full_design is not self.full_design or is_incomplete_new)
        if begun or is_stepped or _segments(self.typed_full_design) != _segments(typed):
            self._typed_values.clear()
        is_drive_new = begun or chosen != self.chosen or full_design.listed != self.full_design.listed
        is_count_new = len(full_design.drives) != len(self.full_design.drives)
        if not is_drive_new and design == self.design:
            design = self.design  # keep what is computed from this drive
        is_design_new = is_drive_new or design is not self.design
        if is_drive_new and not begun:
            self.choose_step(None)
            self.choose_load("")
            self.drive_chosen.emit()
        self.full_design, self.chosen, self.design, self.incomplete = full_design, chosen, design, incomplete
        if is_new:
            self._full_study = None
        if is_design_new:
            self._study = self._at = None
            self.pending.drop()
        if restored or is_drive_new or is_count_new:
            self.before = None
        if restored:
            self.end_gesture()
            self.restored.emit()
        if is_incomplete_new:
            self.incomplete_changed.emit()
        if is_design_new:
            self.design_changed.emit()
        if is_new:
            self.full_design_changed.emit()
        if self.is_stepping:  # the rest begins once the step is shown
            self._steps.start()

    def _begin(self, state: tuple[Work, Path | None], *, restored: bool = True) -> None:
        work, self.path = state
        self.choose_step(None)
        self.choose_load("")
        self.started.emit()
        self._show(work, restored=True, begun=True)
        self.file_changed.emit()

    def _step_taken(self, *_: object) -> None:
        """Mark the design as saved where it equals its file, or the design it began with."""
        if (self.typed_full_design, self.path) in self._unchanged:
            self.stack.setClean()

    def end_gesture(self) -> None:
        """End the gesture: the next edit is another undo step."""
        self._gesture += 1

    @contextmanager
    def one_step(self) -> Iterator[list[Refusal]]:
        """Make the edits inside one undo step by themselves; yields a list that collects their refusals."""
        refusals: list[Refusal] = []

        def listen(refusal: Refusal) -> None:
            refusals.append(refusal)

        self.end_gesture()
        self.refused.connect(listen)
        try:
            yield refusals
        finally:
            self.refused.disconnect(listen)
            self.end_gesture()

    def begin_step(self) -> None:
        """Begin a step of a number by key, wheel or arrow; views of slow results follow once the keys rest."""
        self._steps.start()

    @property
    def is_stepping(self) -> bool:
        """Whether keys step a number, and do not rest yet."""
        return self._steps.isActive()

    def begin_drag(self, widget: object) -> None:
        """Begin a drag in a widget; all of it is one undo step, until ``end_drag``."""
        self.end_gesture()
        self.drag_source, self.stages_of_drag = widget, None

    def end_drag(self) -> None:
        """End a drag."""
        if self.drag_source:
            if self.study.follows:  # what it has not searched is searched now; the other views follow in turn
                self._study = self._at = None
                self.design_changed.emit()
                self.full_design_changed.emit()
            self.drag_source = None
            self.end_gesture()
            self.drag_ended.emit()

    def end_field_drag(self, path: str, back_to: object = None) -> None:
        """End a drag of the field of a path; with ``back_to``, the ``work`` at its start, cancel it."""
        self.end_drag()
        self.withdraw(path)
        if back_to is not None and self.work != back_to:
            self.stack.undo()


_with_plain_laws = lru_cache(maxsize=4)(with_plain_laws)  # the same object each time


@lru_cache(maxsize=1)  # every field asks
def _is_incomplete_linkage(design: Design) -> bool:
    if design.listed or not design.drive.links:
        return False
    if wrong := faults(design):
        return only_incomplete(design.drive, wrong)
    from core.mechanism.unfinished import is_overconstrained  # only while a linkage is drawn

    return is_overconstrained(design.drive.linkage)


def _segments(design: Design) -> list[int]:
    """Return the number of segments of each drive's motion."""
    return [0 if drive.motion is None else len(drive.motion.segments) for drive in design.drives]


def _shared(design: Design) -> tuple[object, ...]:
    """Return the parts of a design that can cause contradictions between drives."""
    return design.shaft, design.timing, design.balancer, [(drive.name, drive.motion) for drive in design.drives]
