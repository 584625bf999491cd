"""Slots of the menus that change the design: motion, mechanism, size, shaft, servo.

Dialogs are imported when they are opened, to keep the start short.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QApplication

from core.design import (
    Design,
    ElasticShaft,
    alone,
    drive_names,
    motion_of,
    only,
    require_motion,
    rescaled,
    with_elastic,
    with_motion_of,
)
from core.design import with_shaft as give_shaft
from core.design.design import with_servo, without_servo
from core.errors import KindynaError
from core.number_text import shortest
from core.project import load, load_linked, save
from kindyna_gui import dialogs
from kindyna_gui.background import in_background
from kindyna_gui.documents.texts import command_text, misfit_sentences, session_options
from kindyna_gui.drives import replace_chosen
from kindyna_gui.labels import reason
from kindyna_gui.requirements import NO_MOTION, NO_SHAFT, turned_shaft, why_no_disk
from kindyna_gui.settings import Settings
from kindyna_gui.window.base import Window


class DesignActions(QObject):
    """Edits of the design that begin in a menu.

    Signal ``status_message``: what was done, or why not, for the status line.
    """

    status_message = Signal(str)

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._session = window, window.session

    # -- the motion ---------------------------------------------------------------------------------------

    def segment(self, name: str) -> None:
        """Apply one of the Motion view's edits to the selected segment."""
        view: Any = self._window.show_view("motion")
        if self._has_motion():
            view.act(name)

    def blend(self) -> None:
        """Open the dialog of blended motions."""
        from kindyna_gui.blend.wizard import open_blend

        if self._has_motion():
            open_blend(self._session, self._window)

    def blend_sequence(self) -> None:
        """Open the dialog that joins any curves."""
        from kindyna_gui.blend.sequence_dialog import open_sequence

        if self._has_motion():
            open_sequence(self._session, self._window)

    def import_measured(self) -> None:
        """Open the dialog that fits a motion to a measured table."""
        from kindyna_gui.measured.dialog import import_measured

        if self._has_motion():
            import_measured(self._session, self._window)

    def import_linkage(self) -> None:
        """Begin with a linkage imported from another program."""
        from kindyna_gui.files.beginnings import ask_linkage

        if self._window.documents.may_leave():
            linkage = ask_linkage(self._window)
            if linkage is not None:
                self._window.documents.begin(linkage.design, linkage.design.name)

    def import_controller(self) -> None:
        """Open the dialog that imports a controller's table as the motion that the controller interpolates from it."""
        from kindyna_gui.measured.sheet import import_controller

        if self._has_motion():
            import_controller(self._session, self._window)

    def inspect_measured(self) -> None:
        """Open the dialog that compares a measured table of lift with the profile."""
        from kindyna_gui.inspection import inspect_measured

        self._window.documents.settle()
        if reason := why_no_disk(self._session.design):
            self.status_message.emit(reason)
        else:
            inspect_measured(self._window, self._session.design)

    def motion_from_curve(self) -> None:
        """Open the dialog that calculates the motion of a follower on a drawn cam."""
        from kindyna_gui.contour import motion_from_curve

        if self._has_motion():
            motion_from_curve(self._session, self._window)

    def shift_motion(self) -> None:
        """Ask for an angle and shift the motion by it."""
        from core.motion.split import shift_motion

        angle = (
            dialogs.ask_shift(self._window, lambda deg: self._command(shift_deg=deg)) if self._has_motion() else None
        )
        if angle is not None:
            self.change(lambda: shift_motion(self._session.design, angle), f"Shift the motion by {shortest(angle)}°")

    def save_motion(self) -> None:
        """Ask for a file and save the motion in it."""
        if not self._has_motion():
            return
        design = self._session.design
        path = dialogs.design_to_save(self._window, Path(f"{design.name} motion.toml"))
        if path is not None:
            try:
                save(alone(design), path)
            except KindynaError as error:
                dialogs.show_faults(self._window, f"{path.name} cannot be written.", str(error).splitlines())
            else:
                self.status_message.emit(f"Saved the motion to {path}")

    def take_motion(self) -> None:
        """Ask for a file and replace the motion by that of the file."""
        path = dialogs.design_to_open(self._window, Settings().folder) if self._has_motion() else None
        if path is None:
            return
        try:
            design = load(path)
        except KindynaError as error:
            dialogs.show_faults(self._window, f"{path.name} cannot be read.", str(error).splitlines())
            return
        command = partial(self._command, path)
        number = dialogs.ask_drive(self._window, drive_names(design), command) if design.listed else 0
        if number is not None:
            source = only(design, number)
            self.change(
                lambda: with_motion_of(self._session.design, source), f"Replace the motion by that of {source.name}"
            )

    def _command(self, path: Path | None = None, drive: str = "", shift_deg: float = 0.0) -> str:
        """The command that copies the motion of a file's drive, or shifts that of the design."""
        from core.commands.motions import MotionArguments
        from core.requests import command_words

        target = session_options(self._session)
        into, into_drive = target["into"], target["drive"]
        source = {"design": into, "drive": into_drive} if path is None else {"design": path, "drive": drive}
        options = {**source, "shift_deg": shift_deg, "into": into, "into_drive": into_drive}
        return command_text("motion", command_words(MotionArguments, options))

    def follow_files(self) -> None:
        """Ask for a table or designs and link the motion to them."""
        from core.project.origins import output_units, with_linked_motion

        session = self._session
        paths = dialogs.motion_files_to_open(self._window, Settings().folder) if self._has_motion() else []
        if not paths:
            return
        output: str | None = ""
        if len(paths) == 1 and paths[0].suffix.lower() == ".toml":
            try:
                source = load(paths[0])
            except KindynaError as error:
                dialogs.show_faults(self._window, f"{paths[0].name} cannot be read.", str(error).splitlines())
                return
            if outputs := output_units(source):
                unit = require_motion(session.design).unit
                output = dialogs.ask_output(self._window, {n: u for n, u in outputs.items() if u == unit})
        if output is not None:
            home = str(session.path) if session.path is not None else None
            link, files = output, [str(path) for path in paths]
            names = ", ".join(path.name for path in paths)
            self.change(lambda: with_linked_motion(session.design, files, home, load_linked, link), f"Follow {names}")

    def lobe_to_segments(self) -> None:
        """Replace the lobe of the motion by its segments."""
        from core.motion.tables import lobe_to_segments

        if self._has_motion():
            self.change(lambda: lobe_to_segments(self._session.design), "Lobe to segments")

    def segment_from_table(self) -> None:
        """Ask for a table and replace the selected segment by it."""
        opened = (
            dialogs.opened_file(self._window, "Segment from table", "Tables (*.csv *.txt *.dat *.tsv)")
            if self._has_motion()
            else None
        )
        if opened is not None:
            self._segment_from(opened[1], opened[0].name, opened[0])

    def segment_from_clipboard(self) -> None:
        """Replace the selected segment by a table copied from a spreadsheet."""
        if self._has_motion():
            self._segment_from(QApplication.clipboard().text().encode(), "clipboard")

    def _segment_from(self, data: bytes, name: str, path: Path | None = None) -> None:
        from core.measured.segment_table import segment_from_table
        from core.measured.sheet import read_sheet

        session = self._session
        try:
            sheet = read_sheet(data, name)
        except KindynaError as error:
            dialogs.show_faults(self._window, f"{name} cannot be read as a table.", str(error).splitlines())
            return
        index = session.segment

        def command(choice: tuple[bool, bool]) -> str:
            from core.commands.tables import MeasuredArguments
            from core.requests import command_words

            options = {"as_is": choice[0], "joined": choice[1], "segment": index + 1}
            return command_text(
                "measured", command_words(MeasuredArguments, {"table": path, **options, **session_options(session)})
            )

        choice = dialogs.ask_segment(self._window, command if path is not None else None)
        if choice is not None:
            as_is, joined = choice
            make = partial(segment_from_table, session.typed, index, sheet, as_is=as_is, joined=joined)
            self.lay_out(make, f"Segment {index + 1} from {name}")

    def _has_motion(self) -> bool:
        """Whether the design has a motion to edit; if not, the status line says how to add one."""
        self._window.documents.settle()
        if motion_of(self._session.design) is None:
            self.status_message.emit(NO_MOTION)
            return False
        return True

    # -- the mechanism ------------------------------------------------------------------------------------

    def new_by_picture(self) -> None:
        """Begin with a mechanism chosen from images, and with its motion."""
        self._choose_mechanism(keeps_motion=False)

    def new_valve_train(self) -> None:
        """Begin with the inlet and exhaust valve of a cam card."""
        from core.valves.cam_card import TrainCard
        from kindyna_gui.valves.train_dialog import ask_valve_train

        if self._window.documents.may_leave():
            design = ask_valve_train(self._window, TrainCard())
            if design is not None:
                self._window.documents.begin(design, "Valve train")

    def edit_valve_train(self) -> None:
        """Edit the inlet and exhaust valve of the design by their cam card."""
        from core.valves.new_trains import card_of
        from kindyna_gui.valves.train_dialog import ask_valve_train

        self._window.documents.settle()
        design = self._session.full_design
        try:
            card = card_of(design)
        except KindynaError as error:
            self.status_message.emit(reason(design, error))
            return
        changed = ask_valve_train(self._window, card, design)
        if changed is not None:
            self._apply(self._session.put_full_design, lambda: changed, "Change the valve train")

    def choose_mechanism(self) -> None:
        """Begin with a mechanism chosen from images, and keep the current motion where possible."""
        self._choose_mechanism(keeps_motion=True)

    def _choose_mechanism(self, keeps_motion: bool) -> None:
        from kindyna_gui.window import gallery

        replaces = keeps_motion and self._session.has_several_drives  # replaces one drive, as an undo step
        if replaces or self._window.documents.may_leave():
            ask = gallery.ask_mechanism if keeps_motion else gallery.ask_new_mechanism
            choice = ask(self._window)
            if choice is not None:
                motion = motion_of(self._session.design) if keeps_motion else None
                if replaces:
                    replace_chosen(self._session, choice.with_motion(motion), f"Choose {choice.step_name}")
                else:
                    self._window.documents.begin(choice.with_motion(motion), choice.step_name)
                    if not keeps_motion and motion_of(self._session.design) is not None:
                        self._window.focus_field("motion.stroke")  # the value a designer types first

    def save_as_signs(self) -> None:
        """Store the assembly of the linkage as branch signs."""
        from core.mechanism.drivers import with_signs

        design = self._session.design
        if not design.drive.links or design.drive.linkage.drawn is None:
            links = bool(design.drive.links)
            self.status_message.emit(
                "This linkage already stores branch signs" if links else "Only a linkage is assembled by branch signs"
            )
        else:
            self.change(lambda: with_signs(design), "Save as signs")

    def choose_circuit(self) -> None:
        """Ask for the circuit in which the linkage is assembled."""
        from core.mechanism.drivers import circuits
        from kindyna_gui.window.gallery import ask_circuit

        self._window.documents.settle()
        design = self._session.design
        if not design.drive.links:
            self.status_message.emit("Only a linkage has circuits")
            return
        try:
            rows = in_background(self._window, "Calculating the circuits of the linkage", lambda: circuits(design))
        except KindynaError as error:
            self.status_message.emit(reason(design, error))
            return
        chosen = None if rows is None else ask_circuit(self._window, rows)
        if chosen is not None:
            self.change(lambda: chosen, "Choose another circuit")

    def change(self, make: Callable[[], Design], text: str) -> None:
        """Replace the design in one undo step; if it cannot be built or is refused, the status line shows why."""
        self._apply(self._session.put, make, text)

    def lay_out(self, make: Callable[[], Design], text: str) -> None:
        """Replace the typed design in one undo step; the new one may be incomplete."""
        self._apply(self._session.lay_out, make, text)

    def _apply(self, put: Callable[[Design, str], bool], make: Callable[[], Design], text: str) -> None:
        session = self._session
        self._window.documents.settle()
        with session.one_step() as refusals:
            try:
                done, reasons = put(make(), text), []
            except KindynaError as error:
                done, reasons = False, [reason(session.design, error)]
        reasons += [f"{name}: {why}" for refusal in refusals for _, name, why in refusal.reasons]
        self.status_message.emit(
            "; ".join((text, *misfit_sentences(session))) if done else f"Refused: {'; '.join(reasons)}"
        )

    def scale(self) -> None:
        """Ask for a factor and scale all lengths of the design."""
        from kindyna_gui.forms.request_form import ask_scale

        self._window.documents.settle()
        choice = ask_scale(self._window, self._session.typed_full_design)
        if choice is not None:
            factor, masses = choice
            text = f"Scale the design by {shortest(factor)}{'' if masses else ', masses kept'}"
            make = partial(rescaled, self._session.typed_full_design, factor, masses=masses)
            self._apply(self._session.lay_out_full_design, make, text)

    # -- the shaft ----------------------------------------------------------------------------------------

    def give_shaft(self) -> None:
        """Add a shaft that turns with the linkage's driver, if there is none, and show its fields."""
        design = self._session.design
        if design.shaft is None:
            self._session.put(give_shaft(design), "Add a shaft")
            self._session.end_gesture()
        self._window.focus_field("shaft.flywheel_inertia_kg_m2")

    def give_servo(self) -> None:
        """Add a motor that drives the motion instead of the cam, if there is none, and show its fields."""
        design = self._session.design
        if design.drive.motion is None:
            self.status_message.emit("The crank turns at constant speed: a servo needs a motion")
            return
        if design.drive.servo is None:
            self._session.put(with_servo(design), "Add a servo")
            self._session.end_gesture()
        self._window.focus_field("servo.gear_ratio")

    def take_servo(self) -> None:
        """Remove the servo."""
        if self._session.design.drive.servo is not None:
            self._session.put(without_servo(self._session.design), "Remove the servo")
            self._session.end_gesture()

    def make_flexible(self) -> None:
        """Give the shaft an assumed elasticity, if it has none, and show its fields."""
        from core.stability import with_flexible_shaft

        if self._elastic is None:
            try:
                turned_shaft(self._session.full_study, NO_SHAFT)
                design, study = self._session.design, self._session.study
                changed = with_flexible_shaft(design, study.linkage, study.loading, study.omega)
            except KindynaError as error:
                self.status_message.emit(reason(self._session.design, error))
                return
            full = self._session.full_design
            marks = tuple(path for path in changed.assumed if path.startswith("shaft.") and path not in full.assumed)
            elastic = replace(with_elastic(full, changed.camshaft.elastic), assumed=(*full.assumed, *marks))
            self._session.put_full_design(elastic, "Make the shaft flexible")
            self._session.end_gesture()
        self._window.show_view("stability")
        self._window.focus_field("shaft.stiffness_nm_per_rad")

    @property
    def _elastic(self) -> ElasticShaft | None:
        design = self._session.full_design
        return design.shaft.elastic if design.shaft is not None else None

    def make_rigid(self) -> None:
        """Remove the elasticity of the shaft."""
        if self._elastic is not None:
            self._session.put_full_design(with_elastic(self._session.full_design, None), "Make the shaft rigid")
            self._session.end_gesture()


__all__ = ["DesignActions"]
