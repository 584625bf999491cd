"""What the menus do to the design: segments, blends, measured tables, the flexible shaft, another mechanism, another
size."""

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
from core.output.lines import shortest
from core.project import load, load_linked, save
from core.requests import command_words
from kindyna_gui import dialogs
from kindyna_gui.background import beside
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.texts import command_text, misfit_sentences, session_options
from kindyna_gui.drives import replace_chosen
from kindyna_gui.labels import reason
from kindyna_gui.requirements import NO_CAM, NO_MOTION, NO_SHAFT, turned_shaft
from kindyna_gui.settings import Settings
from kindyna_gui.window.base import Window


class DesignActions(QObject):
    """Edits that begin in a menu. Dialogs are imported when they are opened.

    status_message (str): what has been done, or why not, for the status line
    """

    status_message = Signal(str)

    def __init__(self, window: Window) -> None:
        super().__init__(window)
        self._window, self._session = window, window.session

    # -- the motion ---------------------------------------------------------------------------------------

    def segment(self, name: str) -> None:
        """One of ``motion_actions.ACTIONS`` on the chosen segment."""
        view: Any = self._window.show_view("motion")
        if self._moves():
            view.act(name)

    def blend(self) -> None:
        """Ask for a blended motion."""
        from kindyna_gui.blend.wizard import open_blend

        if self._moves():
            open_blend(self._session, self._window)

    def blend_sequence(self) -> None:
        """Ask for curves in a row."""
        from kindyna_gui.blend.sequence_dialog import open_sequence

        if self._moves():
            open_sequence(self._session, self._window)

    def import_measured(self) -> None:
        """Ask for a measured table and for how it shall become the motion."""
        from kindyna_gui.measured.dialog import import_measured

        if self._moves():
            import_measured(self._session, self._window)

    def import_linkage(self) -> None:
        """Begin with a linkage of another program."""
        from kindyna_gui.files.beginnings import linkage_wanted

        if self._window.documents.may_leave():
            made = linkage_wanted(self._window)
            if made is not None:
                self._window.documents.begin(made.design, made.design.name)

    def import_controller(self) -> None:
        """Ask for a controller's table, which becomes the motion as the controller runs it."""
        from kindyna_gui.measured.sheet import import_controller

        if self._moves():
            import_controller(self._session, self._window)

    def inspect_measured(self) -> None:
        """Ask for a measured table of lift and lay it on the profile."""
        from kindyna_gui.inspection import inspect_measured

        self._window.documents.settle()
        if self._session.design.drive.cam is None:
            self.status_message.emit(NO_CAM)
        else:
            inspect_measured(self._window, self._session.design)

    def motion_from_curve(self) -> None:
        """Ask for a drawing of a cam, over which the follower is rolled."""
        from kindyna_gui.contour import motion_from_curve

        if self._moves():
            motion_from_curve(self._session, self._window)

    def shift_motion(self) -> None:
        """Ask by how much, and let the motion do the same so much later."""
        from core.motion.split import shift_motion

        by = dialogs.shift_wanted(self._window, lambda by: self._taking(shift_deg=by)) if self._moves() else None
        if by is not None:
            self.change(lambda: shift_motion(self._session.design, by), f"Shift the motion by {shortest(by)}°")

    def save_motion(self) -> None:
        """Ask for a file, and write the motion by itself."""
        if not self._moves():
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
        """Ask for a file, whose motion comes in place of this one."""
        path = dialogs.design_to_open(self._window, Settings().folder) if self._moves() else None
        if path is None:
            return
        try:
            whole = load(path)
        except KindynaError as error:
            dialogs.show_faults(self._window, f"{path.name} cannot be read.", str(error).splitlines())
            return
        spell = partial(self._taking, path)
        number = dialogs.drive_wanted(self._window, drive_names(whole), spell) if whole.listed else 0
        if number is not None:
            other = only(whole, number)
            self.change(lambda: with_motion_of(self._session.design, other), f"Take the motion of {other.name}")

    def _taking(self, path: Path | None = None, drive: str = "", shift_deg: float = 0.0) -> str:
        """The command that takes a motion into the design: of a file's drive, else its own."""
        from core.commands.motions import MotionArguments

        here = session_options(self._session)
        whose = {"design": here["into"], "drive": here["drive"]} if path is None else {"design": path, "drive": drive}
        taken = {**whose, "shift_deg": shift_deg, "into": here["into"], "into_drive": here["drive"]}
        return command_text("motion", command_words(MotionArguments, taken))

    def follow_files(self) -> None:
        """Ask for a table or designs, from which the motion follows from now on."""
        from core.project.origins import output_units, with_linked_motion

        session = self._session
        paths = dialogs.motion_files_to_open(self._window, Settings().folder) if self._moves() else []
        if not paths:
            return
        output: str | None = ""
        if len(paths) == 1 and paths[0].suffix.lower() == ".toml":
            try:
                other = load(paths[0])
            except KindynaError as error:
                dialogs.show_faults(self._window, f"{paths[0].name} cannot be read.", str(error).splitlines())
                return
            if outputs := output_units(other):
                unit = require_motion(session.design).unit
                output = dialogs.output_wanted(self._window, {n: each for n, each in outputs.items() if each == unit})
        if output is not None:
            home = str(session.path) if session.path is not None else None
            link, files = output, [str(path) for path in paths]
            told = ", ".join(path.name for path in paths)
            self.change(lambda: with_linked_motion(session.design, files, home, load_linked, link), f"Follow {told}")

    def segment_from_table(self) -> None:
        """Ask for a table that becomes the chosen segment."""
        opened = (
            dialogs.opened_file(self._window, "Segment from table", "Tables (*.csv *.txt *.dat *.tsv)")
            if self._moves()
            else None
        )
        if opened is not None:
            self._segment_from(opened[1], opened[0].name, opened[0])

    def segment_from_clipboard(self) -> None:
        """The same of what was copied from a spreadsheet."""
        if self._moves():
            self._segment_from(QApplication.clipboard().text().encode(), "clipboard")

    def _segment_from(self, data: bytes, name: str, path: Path | None = None) -> None:
        from core.measured.segment_table import segment_from_table
        from core.measured.sheet import read_sheet

        session = self._session
        try:
            sheet = read_sheet(data, name)
        except KindynaError as error:
            dialogs.show_faults(self._window, f"{name} is no table.", str(error).splitlines())
            return
        index = session.segment

        def command(taken: tuple[bool, bool]) -> str:
            from core.commands.tables import MeasuredArguments

            how = {"as_is": taken[0], "joined": taken[1], "segment": index + 1}
            return command_text(
                "measured", command_words(MeasuredArguments, {"table": path, **how, **session_options(session)})
            )

        wanted = dialogs.segment_wanted(self._window, command if path is not None else None)
        if wanted is not None:
            as_is, joined = wanted
            make = partial(segment_from_table, session.typed, index, sheet, as_is=as_is, joined=joined)
            self.lay_out(make, f"Segment {index + 1} from {name}")

    def _moves(self) -> bool:
        """Whether there is a motion to be edited; else the status line tells how to get one."""
        self._window.documents.settle()
        if motion_of(self._session.design) is None:
            self.status_message.emit(NO_MOTION)
            return False
        return True

    # -- the mechanism ------------------------------------------------------------------------------------

    def new_by_picture(self) -> None:
        """Begin with a mechanism chosen by its picture, and with its own motion."""
        self._choose_mechanism(keeps_motion=False)

    def choose_mechanism(self) -> None:
        """Begin with a mechanism chosen by its picture; the motion that is there goes on where it suits."""
        self._choose_mechanism(keeps_motion=True)

    def _choose_mechanism(self, keeps_motion: bool) -> None:
        from kindyna_gui.window import gallery

        replaces = keeps_motion and self._session.several  # one drive, which Undo brings back
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
                        self._window.focus_field("motion.stroke")  # what a designer says first

    def save_as_signs(self) -> None:
        """The linkage is assembled by signs, as it is drawn."""
        from core.mechanism.drivers import with_signs

        design = self._session.design
        if not design.drive.links or design.drive.linkage.drawn is None:
            self.status_message.emit("Only a linkage that is told as it is drawn can be told by signs instead")
        else:
            self.change(lambda: with_signs(design), "Save as signs")

    def choose_circuit(self) -> None:
        """Ask which of its circuits the linkage is in."""
        from core.mechanism.drivers import circuits
        from kindyna_gui.window.gallery import ask_circuit

        self._window.documents.settle()
        design = self._session.design
        if not design.drive.links:
            self.status_message.emit("Only a linkage is put together in one of several ways")
            return
        try:
            found = beside(self._window, "Looking how the links can be put together", lambda: circuits(design))
        except KindynaError as error:
            self.status_message.emit(reason(design, error))
            return
        wanted = None if found is None else ask_circuit(self._window, found)
        if wanted is not None:
            self.change(lambda: wanted, "Choose another circuit")

    def change(self, make: Callable[[], Design], text: str) -> None:
        """Another design in one step, made from the one in place; where it cannot be made or is refused, the status line shows why."""
        self._take(self._session.put, make, text)

    def lay_out(self, make: Callable[[], Design], text: str) -> None:
        """The same, made from what is typed; it need not fit together."""
        self._take(self._session.lay_out, make, text)

    def _take(self, take: Callable[[Design, str], bool], make: Callable[[], Design], text: str) -> None:
        session = self._session
        self._window.documents.settle()
        session.end_gesture()
        reasons: list[str] = []

        def listen(refusal: Refusal) -> None:
            reasons.extend(f"{name}: {why}" for _, name, why in refusal.reasons)

        session.refused.connect(listen)
        try:
            done = take(make(), text)
        except KindynaError as error:
            done = False
            reasons.append(reason(session.design, error))
        finally:
            session.refused.disconnect(listen)
        session.end_gesture()
        self.status_message.emit(
            "; ".join((text, *misfit_sentences(session))) if done else f"Refused: {'; '.join(reasons)}"
        )

    def scale(self) -> None:
        """Ask for a factor, and scale all lengths of all that the file has."""
        from kindyna_gui.forms.request_form import ask_scale

        self._window.documents.settle()
        wanted = ask_scale(self._window)
        if wanted is not None:
            factor, masses = wanted
            made = partial(rescaled, self._session.typed_full_design, factor, masses=masses)
            self._take(
                self._session.lay_out_full_design,
                made,
                f"Scale the design by {shortest(factor)}{'' if masses else ', masses kept'}",
            )

    # -- the shaft ----------------------------------------------------------------------------------------

    def give_shaft(self) -> None:
        """A linkage gets a shaft that turns as its driver does; where there is one, its fields come before the reader."""
        design = self._session.design
        if design.shaft is None:
            self._session.put(give_shaft(design), "Add a shaft")
            self._session.end_gesture()
        self._window.focus_field("shaft.flywheel_inertia_kg_m2")

    def give_servo(self) -> None:
        """A motor makes the motion in place of the cam; where there is one, its fields come before the reader."""
        design = self._session.design
        if design.drive.motion is None:
            self.status_message.emit("A crank turns at constant speed: there is no motion for a servo to make")
            return
        if design.drive.servo is None:
            self._session.put(with_servo(design), "Add a servo")
            self._session.end_gesture()
        self._window.focus_field("servo.gear_ratio")

    def take_servo(self) -> None:
        """The servo is taken away."""
        if self._session.design.drive.servo is not None:
            self._session.put(without_servo(self._session.design), "Remove the servo")
            self._session.end_gesture()

    def make_flexible(self) -> None:
        """Give the shaft an elasticity to begin with, all of it assumed; where it has one, bring it before the reader."""
        from core.stability import with_flexible_shaft

        if self._elastic is None:
            try:
                turned_shaft(self._session.full_study, NO_SHAFT)
                design, study = self._session.design, self._session.study
                changed = with_flexible_shaft(design, study.linkage, study.loading, study.omega)
            except KindynaError as error:
                self.status_message.emit(reason(self._session.design, error))
                return
            whole = self._session.full_design
            marks = tuple(path for path in changed.assumed if path.startswith("shaft.") and path not in whole.assumed)
            made = replace(with_elastic(whole, changed.camshaft.elastic), assumed=(*whole.assumed, *marks))
            self._session.put_full_design(made, "Make the shaft flexible")
            self._session.end_gesture()
        self._window.show_view("stability")
        self._window.focus_field("shaft.stiffness_nm_per_rad")

    @property
    def _elastic(self) -> ElasticShaft | None:
        design = self._session.full_design
        return design.shaft.elastic if design.shaft is not None else None

    def make_rigid(self) -> None:
        """Take the elasticity out of the design."""
        if self._elastic is not None:
            self._session.put_full_design(with_elastic(self._session.full_design, None), "Make the shaft rigid")
            self._session.end_gesture()


__all__ = ["DesignActions"]
