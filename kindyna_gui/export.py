"""The menu File > Export: tables, profiles, drawings, report, pictures, animation.

Each entry opens a dialog, writes all its files or none, and reports the files or the reason. Modules that write are
imported when a file is written, so that the window starts sooner.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from math import pi
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from core.design import Design, in_machine, slug
from core.errors import KindynaError
from core.file_names import file_name
from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.project.files import write_all, write_into
from core.study import SAMPLES, Study
from kindyna_gui import background, dialogs
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import waiting_text
from kindyna_gui.labels import reason
from kindyna_gui.pictures.drawing.parts import LAYERS
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_CAM, why_no_disk
from kindyna_gui.settings import Settings, in_file_units


def tables_of(design: Design, samples: int = SAMPLES) -> dict[str, str | Iterator[bytes]]:
    """Return tables and summary by file name, as text or in parts, with those of all drives. Raises NoSolution."""
    from core.output.export import file_parts

    return file_parts(Study(design, samples))


def write_tables(design: Design, folder: Path, samples: int = SAMPLES) -> list[str]:
    """Write tables and summary into a folder and return their names.

    Raises NoSolution or FileError, and then writes nothing.
    """
    files = tables_of(design, samples)
    checkpoint()  # the last one at which the user can cancel
    write_into(folder, files)
    return list(files)


def _into(folder: Path, files: Mapping[str, bytes]) -> list[Path]:
    write_into(folder, files)
    return [folder]


@frozen
class Export:
    """Entry of the menu File > Export; ``why_not``: why it is disabled for this design, empty where it is not."""

    text: str
    tip: str
    act: Callable[[], None]
    why_not: str = ""


def _written(path: Path, content: bytes) -> list[Path]:
    write_all(path.parent, {path.name: content})
    return [path]


BALANCED = "The motion of the balance cam follows from the torque of the other drives"


class Exports(QObject):
    """Entries of the menu File > Export and their actions.

    - status_message (str): what has been done, for the status line
    """

    status_message = Signal(str)

    def __init__(self, session: Session, player: Player, window: QWidget) -> None:
        super().__init__(window)
        self._session, self._player, self._window = session, player, window
        self._settings = Settings()
        self.layers: Callable[[], dict[str, bool]] = lambda: {name: row.shown for name, row in LAYERS.items()}
        self.view: Callable[[str], Any] = lambda name: None

    def rows(self) -> tuple[Export, ...]:
        """Return the entries in the order of the menu."""
        session = self._session
        no_cam = why_no_disk(session.design)
        motion = session.design.drive.motion
        has_motion = any(drive.motion is not None for drive in session.full_design.drives)
        return (
            Export(
                "&Tables...",
                "Write profile, kinematics, dynamics (CSV) and summary (JSON) into a folder",
                self.tables,
            ),
            Export(
                "Pro&file...",
                "Write the cam profile, or the path of a cutter, as DXF, SVG, CSV or G-code, with its deviation from the exact curve",
                self.profile,
                no_cam,
            ),
            Export(
                "&Solid and surfaces...",
                "Write the solid cam with bore, keyway and hub, or its flanks, as STEP, STL or CSV for CAD and CAM",
                self.surfaces,
                "" if session.design.drive.cam is not None else NO_CAM,
            ),
            Export(
                "&Drawing...",
                "Write a workshop drawing of the cam with dimensions, table of points and title block, as PDF or SVG",
                self.drawing,
                no_cam,
            ),
            Export(
                "&Controller...",
                "Write the motion as a table for a servo controller, and show the error of its interpolation",
                self.controller,
                BALANCED if session.is_on_balancer else "",
            ),
            Export(
                "&Inspection table...",
                "Write the lift that a probe measures on the cam, with its tolerance band, as CSV",
                self.inspection,
                no_cam,
            ),
            Export(
                "&Lift table...",
                "Write the lift of the drive's motion by cam degree from the nose, in mm or inches, as CSV for the grinder",
                self.lift_table,
                "" if motion is not None and motion.unit == "mm" else "This drive has no motion in mm",
            ),
            Export(
                "Ti&ming chart...",
                "Write the motions of all drives over the machine angle as PDF, SVG or PNG, or their starts and ends as CSV",
                self.timing,
                "" if has_motion else "No drive of this design follows a motion",
            ),
            Export("&Report as text...", "Write the report as plain text", self.text_report),
            Export(
                "&Hand-over...",
                "Write one archive for workshop, controls and customer: profiles, drawings, tables, report, web page, design",
                self.handover,
            ),
            Export(
                "&Web page...",
                "Web page: an animated model with curves, findings and inputs that opens in any browser",
                self.web_page,
            ),
            *(self._linkage_rows() if session.design.drive.links else ()),
            Export("&Picture of the mechanism...", "Write the drawing as PNG or SVG", self.picture),
            Export("&Animation...", "Write one turn of the mechanism as GIF or WebP", self.animation),
            Export(
                "P&ose of the links...",
                "Write links and cam at the current angle, a layer each, as DXF or SVG in mm",
                self.pose,
            ),
        )

    def _linkage_rows(self) -> tuple[Export, ...]:
        """Entries for designs with a linkage."""
        return (
            Export(
                "C&urves of points...",
                "Write the paths of the points as CSV, or a layer each as DXF or SVG",
                self.curves,
            ),
        )

    @property
    def _name(self) -> str:
        """Name for files: that of the design file, else of the design."""
        path = self._session.path
        stem = path.stem if path is not None else self._session.full_design.name
        return file_name("".join(c if c.isalnum() or c in "-_" else "_" for c in stem).strip("_")) or "design"

    @property
    def _drive_name(self) -> str:
        """Name for files of the selected drive."""
        return f"{self._name}_{slug(self._session.design.name)}" if self._session.has_several_drives else self._name

    @property
    def _drive(self) -> Design:
        """The selected drive, under a name that is valid outside the window."""
        return in_machine(self._session.full_design, self._session.design)

    def tables(self) -> None:
        """Write profile, kinematics, dynamics and summary into a folder."""
        from kindyna_gui import export_dialogs

        request = export_dialogs.ask_tables(self._window, self._settings.folder, self._session.full_study)
        if request is None:
            return
        design = self._session.full_design
        try:
            names = background.in_background(
                self._window, "Writing the tables", lambda: write_tables(design, request.folder, request.samples)
            )
        except KindynaError as error:
            dialogs.show_faults(self._window, "The tables cannot be exported.", [reason(design, error)])
            return
        if names is None:
            self.status_message.emit("The export of the tables was cancelled; nothing is written")
            return
        self._settings.folder = request.folder
        self._report(f"Wrote {', '.join(names)} into {request.folder}")

    def report(self) -> None:
        """Write the report as PDF or HTML; its numbers are calculated in the background."""
        from core.output.report.document import document
        from kindyna_gui import export_dialogs
        from kindyna_gui.pictures.paper.report import report_file

        request = export_dialogs.ask_report(self._window)
        if request is None:
            return
        path = dialogs.report_to_save(self._window, self._settings.folder / f"{self._name}{request.ending}")
        if path is None:
            return
        design = self._session.full_design
        compute = partial(document, Study(design), request.parts, request.cover)
        try:
            report = background.in_background(self._window, f"Computing {path.name}", compute)
            data, lacking = None, ""
            if report is not None:
                with (
                    background.progress(self._window, f"Painting {path.name}", len(report.pictures) + 1) as go_on,
                    in_file_units(),
                ):
                    data, lacking = report_file(report, path.suffix.lower(), go_on), report.lacking
        except KindynaError as error:
            dialogs.show_faults(self._window, "The report of this design cannot be written.", [reason(design, error)])
            return
        if data is None:
            self._report(f"{path.name} was cancelled; nothing is written")
            return
        text = self._write(path, lambda: data, paints=True)
        self._report("; ".join(filter(None, (text, lacking))) if text else "")
        if text and request.opened:
            export_dialogs.open_outside(path)

    def text_report(self) -> None:
        """Write the report as plain text."""
        from core.output.report import report

        path = dialogs.report_to_save(self._window, self._settings.folder / f"{self._name}.txt")
        design = self._session.full_design
        self._report(self._write(path, lambda: report(Study(design))))

    def web_page(self) -> None:
        """Write the machine as an animated web page."""
        from core.output.handover import write_page

        path = dialogs.page_to_save(self._window, self._settings.folder / f"{self._name}.html")
        design = self._session.full_design
        self._write_in_background(path, lambda path: write_page(Study(design), path))

    def handover(self) -> None:
        """Write all files of a design into one archive."""
        from core.output.handover import handover
        from kindyna_gui.export_dialogs import ask_handover
        from kindyna_gui.pictures.paper.handover import paint_handover

        request = ask_handover(self._window)
        if request is None:
            return
        path = dialogs.handover_to_save(self._window, self._settings.folder / f"{self._name}.zip")
        if path is None:
            return
        design = self._session.full_design
        study = Study(design)
        try:
            archive = background.in_background(self._window, f"Computing {path.name}", lambda: handover(study, request))
            with background.progress(self._window, f"Painting {path.name}", 12) as go_on, in_file_units():
                painted = paint_handover(study, request, go_on) if archive is not None else None
            if archive is None or painted is None:
                self._report(f"{path.name} was cancelled; nothing is written")
                return
            archive = archive.with_files(*painted)
            archive.write(path)
        except KindynaError as error:
            dialogs.show_faults(self._window, f"{path.name} cannot be written.", [reason(design, error)])
            return
        self._settings.folder = path.parent
        left = "".join(f"; left out: {what}: {why}" for what, why in archive.left_out)
        self._report(f"Wrote {len(archive.files)} files into {path}{left}")

    def profile(self) -> None:
        """Write the cam profile, or the path of a cutter."""
        from core.output.files.files import write_profile
        from kindyna_gui.cam_dialogs import profile_dialogs

        if reason := why_no_disk(self._session.design):
            self.status_message.emit(reason)
            return
        choice = profile_dialogs.ask_profile(self._window, self._drive)
        if choice is None:
            return
        job, ending = choice
        path = dialogs.profile_to_save(self._window, self._settings.folder / f"{self._drive_name}{ending}")
        self._write_in_background(path, lambda path: write_profile(job, path))

    def surfaces(self) -> None:
        """Write the solid cam, or its flanks."""
        from core.output.solids.surface import write_surface
        from kindyna_gui.cam_dialogs.surface_dialog import ask_surface

        if self._session.design.drive.cam is None:
            self.status_message.emit(NO_CAM)
            return
        choice = ask_surface(self._window, self._drive)
        if choice is None:
            return
        job, ending = choice
        path = dialogs.surfaces_to_save(self._window, self._settings.folder / f"{self._drive_name}{ending}")
        self._write_in_background(path, lambda path: write_surface(job, path))

    def controller(self) -> None:
        """Write an electronic cam: the motion as a table for a servo controller."""
        from kindyna_gui.cam_dialogs.profile_dialogs import ask_controller_table

        session = self._session
        name = session.names[session.chosen] if session.has_several_drives else ""
        table = ask_controller_table(self._window, session.full_design, name)
        if table is None:
            return
        path = dialogs.controller_table_to_save(
            self._window, self._settings.folder / f"{self._drive_name}{table.controller.extension}"
        )
        self._write_in_background(path, lambda path: _written(path, table.content))

    def inspection(self) -> None:
        """Write the lift that a probe measures on the cam."""
        from core.output.files.inspection import write_inspection
        from kindyna_gui.inspection import ask_inspection

        inspection = ask_inspection(self._window, self._drive)
        if inspection is None:
            return
        path = dialogs.inspection_to_save(self._window, self._settings.folder / f"{self._drive_name}_lift.csv")
        self._write_in_background(path, lambda path: write_inspection(inspection, path))

    def lift_table(self) -> None:
        """Write the lift of the motion by cam degree from the nose."""
        from core.output.export import csv
        from core.valves import lift_table
        from kindyna_gui.export_dialogs import ask_lift_table

        request = ask_lift_table(self._window, self._drive)
        if request is None:
            return
        path = dialogs.lift_table_to_save(self._window, self._settings.folder / f"{self._drive_name}_lobe.csv")
        if path is not None:
            table = csv(*lift_table(self._drive, request.step, request.unit))
            self._report(self._write(path, lambda: table))

    def pose(self) -> None:
        """Write links and cam at the current angle."""
        from core.output.drawing.mechanism import pose_file

        path = dialogs.links_to_save(self._window, self._settings.folder / f"{self._drive_name}_pose.dxf")
        study, theta = Study(self._drive), self._player.theta
        self._write_in_background(path, lambda path: _written(path, pose_file(study, theta, path.suffix.lower())))

    def curves(self) -> None:
        """Write the paths of all moving points."""
        from core.output.drawing.curves import curves_file, point_curves

        path = dialogs.links_to_save(self._window, self._settings.folder / f"{self._drive_name}_curves.csv", table=True)
        study = Study(self._drive)
        self._write_in_background(
            path, lambda path: _written(path, curves_file(study, point_curves(study), path.suffix.lower()))
        )

    def _write_in_background(self, path: Path | None, make: Callable[[Path], Sequence[Path]]) -> None:
        """Write files in the background, and report their names."""
        if path is None:
            return
        try:
            paths = background.in_background(self._window, f"Writing {path.name}", lambda: make(path))
        except KindynaError as error:
            dialogs.show_faults(
                self._window, f"{path.name} cannot be written.", [reason(self._session.full_design, error)]
            )
            return
        if paths is None:
            self._report(f"{path.name} was cancelled; nothing is written")
            return
        self._settings.folder = path.parent
        self._report(f"Wrote {' and '.join(map(str, paths))}")

    def drawing(self) -> None:
        """Write a workshop drawing of the cam."""
        from kindyna_gui.cam_dialogs import profile_dialogs
        from kindyna_gui.pictures.paper.sheets import sheet_file

        sheet = profile_dialogs.ask_drawing(self._window, self._drive)
        if sheet is None:
            return
        path = dialogs.drawing_to_save(self._window, self._settings.folder / f"{self._drive_name}.pdf")
        if path is not None:
            self._report(self._write(path, lambda: sheet_file(sheet, path.suffix.lower()), paints=True))

    def picture(self) -> None:
        """Write the drawing of the mechanism as shown."""
        view = self.view("mechanism")
        if view is not None:
            from kindyna_gui.saving import save_picture

            save_picture(view, "mechanism")

    def timing(self) -> None:
        """Write the timing chart, or the table of its events, with the axis and overlap of an open timing view."""
        from kindyna_gui.pictures.paper.timing_page import timing_file

        view = self.view("timing")
        path = dialogs.timing_to_save(self._window, self._settings.folder / f"{self._name}_timing.pdf")
        design, reference = self._session.full_design, Pins.of(self._session).named_design
        if path is not None:
            make = view.picture if view is not None else partial(timing_file, design, reference=reference)
            self._report(self._write(path, lambda: make(path.suffix.lower()), paints=True))

    def animation(self) -> None:
        """Write one turn of the mechanism as GIF or WebP, with the visible layers."""
        from kindyna_gui import export_dialogs
        from kindyna_gui.pictures.film import pictures, shoot

        seconds = 2.0 * pi / (abs(self._player.omega) * self._player.speed)
        choice = export_dialogs.ask_animation(self._window, self._settings.folder, self._name, seconds)
        if choice is None:
            return
        path, film = choice
        try:
            with (
                background.progress(self._window, f"Drawing {film.frames} frames", film.frames) as go_on,
                in_file_units(),
            ):
                draw = pictures if film.ending == ".png" else shoot
                data = draw(self._session.full_design, film, self.layers(), go_on)
        except KindynaError as error:
            dialogs.show_faults(
                self._window, "The mechanism cannot be drawn.", [reason(self._session.full_design, error)]
            )
            return
        if data is None:
            self.status_message.emit("The animation was cancelled; nothing is written")
        elif isinstance(data, dict):
            self._write_in_background(path.with_suffix(""), lambda folder: _into(folder, data))
        else:
            self._report(self._write(path, lambda: data, paints=True))

    def _write(self, path: Path | None, content: Callable[[], bytes | str], *, paints: bool = False) -> str:
        """Write one file, as `saving.written`."""
        from kindyna_gui.saving import written

        return written(self._window, path, content, paints=paints)

    def _report(self, text: str) -> None:
        """Report what was written, and which typed values are not in it because they are not valid yet."""
        if text:
            waits = waiting_text(self._session)
            self.status_message.emit(f"{text}, from the last valid values. {waits}" if waits else text)
