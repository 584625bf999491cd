"""The session: edits of the current design as undo steps, and its file.

A value that is impossible by itself is refused, and nothing changes. A value that does not fit the others is part of the
incomplete design, and the last valid design remains in place until the values fit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from core.design import (
    Design,
    blunders,
    differs_in_one_value,
    edited,
    faults,
    merged,
    require_motion,
    with_assumed,
    with_motion,
    with_only,
    with_value,
)
from core.design.camshaft import unsolved_motions
from core.errors import DesignError, Fault, KindynaError
from core.followers.cam_slider import LAYOUT, in_layout
from core.project import loads
from core.project.on_disk import DesignFiles, OnDisk
from core.study import Study
from kindyna_gui.documents.edits import (
    SAMPLES,
    IncompleteDesign,
    Refusal,
    Texts,
    UndoStep,
    fault_texts,
    refusal_reasons,
)
from kindyna_gui.documents.session_state import BALANCE_CAM, BALANCER, MOTION, SHAFT, SessionState, Work
from kindyna_gui.labels import reason


class Session(SessionState):
    """Edits of the design, each an undo step, and its file."""

    def __init__(self, design: Design, path: Path | None = None) -> None:
        super().__init__(design, path)
        self._files = DesignFiles()
        if path is not None:
            self._files.note(path, design)

    # -- edits of values -------------------------------------------------------------------------------

    def edit(self, path: str, value: Any, label: str) -> bool:
        """Change the value at a path, with what depends on it; label names the step: ``Change rod to 850 mm``.

        Returns False where the value is refused. A value that does not fit the others, or for which a stage on screen has no
        solution, becomes part of the incomplete design. Steps at the same path become one until ``end_gesture``.
        """
        if path.startswith(f"{MOTION}."):
            typed = self.typed
            if self.incomplete is not None and differs_in_one_value(self.design, typed, path):
                # a second entry at the same path: the others are as in the valid design
                typed = with_motion(typed, require_motion(self.design))
            changed = with_value(typed, path, value, [row for drive, row in self._typed_values if drive == self.chosen])
            self._typed_values.add((self.chosen, path))
            return self.lay_out(changed, label, path)
        if self._is_shared(path):
            return self.lay_out_full_design(with_value(self.typed_full_design, path, value), label, path)
        if path == LAYOUT and self.incomplete is None:
            return self._choose_layout(edited(self.design, path, value), value, label)
        return self.lay_out(edited(self.typed, path, value), label, path)

    def fits(self, path: str, value: Any) -> bool:
        """Whether the rules of the design admit a value at a path together with the other typed values."""
        try:
            return not faults(with_value(self.holder(path), path, value))
        except (KeyError, DesignError):  # the design has no such value
            return False

    def _choose_layout(self, plain: Design, letter: str, label: str) -> bool:
        """Change the layout of a cam slider, with guide and fixed angle where it cannot be assembled otherwise."""
        if not unsolved_motions(plain) and refusal_reasons(Study(plain, SAMPLES), ("linkage",)):
            adjusted = in_layout(self.design, letter)
            if not unsolved_motions(adjusted) and not refusal_reasons(Study(adjusted, SAMPLES), ("linkage",)):
                return self.lay_out(adjusted, f"{label}, with guide height and fixed angle", LAYOUT)
        return self.lay_out(plain, label, LAYOUT)

    def mark_assumed(self, path: str, on: bool, label: str) -> bool:
        """Mark a value as assumed, or as known, as one step."""
        if self._is_shared(path):
            return self.lay_out_full_design(with_assumed(self.typed_full_design, path, on), label, path)
        return self.lay_out(with_assumed(self.typed, path, on), label)

    def vary(self, path: str) -> None:
        """Ask the views to vary the number at a path of the selected drive."""
        self.vary_requested.emit(self._full_path(path))

    def choose_drive(self, index: int) -> bool:
        """Show another drive in forms and single plots, without an undo step; False where it cannot be shown."""
        if index == self.chosen:
            return True
        if index >= len(self.names):  # of a list that is not up to date yet
            return False
        try:
            self._drive_design(self.full_design, index)
        except KindynaError as error:
            self.refuse(BALANCER, reason(self.full_design, error))
            return False
        self._show((self.full_design, self.incomplete, index), restored=True)
        return True

    # -- other designs in place ------------------------------------------------------------------------

    def lay_out(self, design: Design, label: str, path: str = "") -> bool:
        """Put another design of the drive in place as one step, derived from ``typed``; its values need not fit together.

        While they do not fit, they become the incomplete design, and the last valid design takes the changes that fit it.
        Returns False where the design is refused, for a fault that no other value can correct.
        """
        if self.is_on_balancer:
            return self._refuse_balancer(path)
        return self.lay_out_full_design(with_only(self.typed_full_design, self.chosen, design), label, path)

    def lay_out_full_design(self, typed: Design, label: str, path: str = "") -> bool:
        """Put another full design in place as ``lay_out`` does, derived from ``typed_full_design``."""
        if typed == self.typed_full_design:
            self.clear_refusal(path)
            return True
        if self._waits_for_laws(typed):
            return self._change(self._waiting(typed, path), label, path)
        wrong = self._misfits(typed, self.full_design)
        if not wrong:
            return self._change((typed, None, self.chosen), label, path)
        if impossible := blunders(typed):
            return self._refuse(path, typed, fault_texts(typed, impossible))
        valid = self.full_design if self.incomplete is None else merged(self.typed_full_design, self.full_design, typed)
        if unsolved_motions(valid) or self._misfits(valid, self.full_design):
            valid = self.full_design
        return self._change((valid, IncompleteDesign(typed, self._full_path(path), wrong), self.chosen), label, path)

    def _waits_for_laws(self, design: Design) -> bool:
        """Whether it is not known yet if a design without faults fits, since its laws are being solved."""
        return bool(unsolved_motions(design)) and not faults(design) and bool(self._solve_laws(design))

    def _waiting(self, typed: Design, path: str) -> Work:
        """Return the state in which the last valid design is shown until the laws of the typed one are solved."""
        stands_for = None if self.incomplete is None else self.incomplete.stands_for
        waiting = IncompleteDesign(typed, self._full_path(path), waits=True, stands_for=stands_for)
        return self.full_design, waiting, self.chosen

    def close_motion(self) -> bool:
        """Close the motion with a return, as one step; False where no single return closes it."""
        closing = self.closing
        self.end_gesture()
        if closing is None:
            self.refuse(MOTION, "no single return closes it; change a span or a rise")
            return False
        return self.lay_out(closing, "Close the motion", MOTION)

    def drop_incomplete(self, motion_alone: bool = False) -> None:
        """Restore the last valid design, or only its motion, as one step."""
        self.end_gesture()
        if not self.has_laws:
            return
        if motion_alone and self.incomplete is not None:
            self.lay_out(with_motion(self.typed, require_motion(self.design)), "Back to the last valid motion", MOTION)
        else:
            self._change((self.full_design, None, self.chosen), "Back to the last valid values", "")

    def put(self, design: Design, label: str, path: str = "") -> bool:
        """Put another design of the drive in place as one step, derived from ``design``.

        Returns False where it is refused, for a fault or a stage on screen without a solution. An incomplete design remains
        incomplete, except for the values that this changes.
        """
        if self.is_on_balancer:
            return self._refuse_balancer(path)
        changed = with_only(self.full_design, self.chosen, design)
        if self._waits_for_laws(changed):
            typed = merged(self.full_design, self.typed_full_design, changed)
            return self._change(self._waiting(typed, path), label, path)
        return self._put(changed, self._misfits(changed, self.full_design), label, path, self.chosen)

    def put_full_design(self, design: Design, label: str, path: str = "", chosen: int | None = None) -> bool:
        """Put another full design in place as one step, and select the drive ``chosen``, if given.

        Returns False where it is refused. Several drives are refused for faults only, since one drive that cannot be
        assembled does not affect the others.
        """
        checks_faults = design.listed or self._waits_for_laws(design)
        wrong = fault_texts(design, faults(design)) if checks_faults else self._misfits(design, self.full_design)
        index = self.chosen if chosen is None else chosen
        return self._put(design, wrong, label, path, min(index, len(design.drives) - (design.balancer is None)))

    def _put(self, design: Design, wrong: Texts, label: str, path: str, chosen: int) -> bool:
        if wrong:
            return self._refuse(path, design, wrong)
        typed, incomplete = merged(self.full_design, self.typed_full_design, design), None
        if self.incomplete is not None and self._waits_for_laws(typed):
            incomplete = replace(self.incomplete, design=typed, waits=True)
        elif self.incomplete is not None and (reasons := self._misfits(typed, design)):
            incomplete = replace(self.incomplete, design=typed, reasons=reasons)
        return self._change((typed if incomplete is None else design, incomplete, chosen), label, path)

    def _refuse_balancer(self, path: str) -> bool:
        self.refuse(
            path or BALANCER,
            "the balance cam follows from the torque of the drives; its spring and radii can be changed",
        )
        return False

    # -- files -----------------------------------------------------------------------------------------

    def open(self, path: Path) -> None:
        """Open a file with an empty undo stack. Raises DesignError or FileError; then nothing changes."""
        self.start(self._files.read(path), path)

    def start(self, design: Design, path: Path | None = None) -> None:
        """Begin with a design and an empty undo stack; path None: it has no file yet."""
        self.document += 1
        self.stack.clear()
        self._unchanged = [(design, path)]
        self._begin(((design, None, 0), path))

    def begin(self, design: Design, text: str) -> None:
        """Begin with a design that has no file yet, as an undo step; text names it."""
        self._unchanged.append((design, None))
        self.stack.push(UndoStep(self._begin, (self.work, self.path), ((design, None, 0), None), text))

    def reload(self) -> None:
        """Read the design's file again, as an undo step. Raises DesignError or FileError; then nothing changes."""
        path = self._file()
        design = self._files.read(path)
        self._is_in_file(design, path)
        if (design, None) != (self.full_design, self.incomplete):
            self.stack.push(
                UndoStep(self._begin, (self.work, self.path), ((design, None, 0), path), f"Reload {path.name}")
            )
        self.stack.setClean()
        self.file_changed.emit()

    def save(self, path: Path | None = None, *, last_valid: bool = False) -> None:
        """Write the typed design to a file, by default its own; ``last_valid`` writes the last valid design instead.

        Then what is typed remains in the session, unsaved. Raises FileError; DesignError for values that no file can have.
        """
        target, design = path or self._file(), self.valid_full_design if last_valid else self.typed_full_design
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
        """Return the files that the motions of the design's file follow from."""
        return () if self.path is None else self._files.sources(self.path)

    def changed_sources(self) -> tuple[str, ...]:
        """Return the sources that have changed since the design was read."""
        return () if self.path is None else self._files.changed_sources(self.path)

    def on_disk(self) -> OnDisk:
        """Return whether the design's file is as it was last read or written."""
        return OnDisk.SAME if self.path is None else self._files.state(self.path)

    def _file(self) -> Path:
        if self.path is None:
            raise KindynaError("no file name; choose one")
        return self.path

    def _is_in_file(self, design: Design, path: Path) -> None:
        self._unchanged = [row for row in self._unchanged if row[1] != path] + [(design, path)]

    # -- recovery of unsaved work ----------------------------------------------------------------------

    def state(self) -> dict[str, Any]:
        """Return everything unsaved as a plain dictionary of text, numbers and lists.

        It changes only with ``design_changed``, ``incomplete_changed`` and ``file_changed``.
        """
        from core.project import dumps  # loaded when a design is first written

        return {
            "design": dumps(self.valid_full_design),
            "drive": self.chosen,
            "path": None if self.path is None else str(self.path),
            "modified": self.modified,
            "draft": None if self.incomplete is None else self.incomplete.state(),
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Begin with a state that ``state`` has returned, with an empty undo stack.

        Raises DesignError where it cannot be read; then nothing changes.
        """
        try:
            design, path, modified = loads(state["design"], unfinished=True), state["path"], bool(state["modified"])
            incomplete = None if state["draft"] is None else IncompleteDesign.from_state(state["draft"])
            file = None if path is None else Path(path)
            chosen = min(max(int(state.get("drive", 0)), 0), len(design.drives) - 1)
        except (KeyError, TypeError, ValueError) as error:
            raise DesignError([Fault("state", str(error), "cannot be read", "what Session.state() gives")]) from error
        self.document += 1
        self._unchanged = [] if modified else [(design if incomplete is None else incomplete.design, file)]
        if file is not None:
            self._files.note(file, design)
        self.stack.clear()
        self._begin(((design, incomplete, chosen), file))
        if modified:
            self.stack.resetClean()


__all__ = ["BALANCER", "BALANCE_CAM", "SAMPLES", "SHAFT", "Refusal", "Session", "Work"]
