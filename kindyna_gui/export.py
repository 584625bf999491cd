"""What leaves the program besides the design itself: tables, report, pictures, animation, numbers of a plot.

Each opens a dialog first, writes whole or not at all, and reports what it has done or why it could not. What writes is imported
when something is to be written: the window need not wait for it.
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
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import waiting_text
from kindyna_gui.labels import reason
from kindyna_gui.pictures.drawing.parts import LAYERS
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_CAM
from kindyna_gui.saving import save_picture, written
from kindyna_gui.settings import Settings, in_file_units


def tables_of(design: Design, samples: int = SAMPLES) -> dict[str, str | Iterator[bytes]]:
    """File name -> text, or its parts, of tables and summary, of a shaft with those of each of its drives. Raises NoSolution."""
    from core.output.export import file_parts

    return file_parts(Study(design, samples))


def write_tables(design: Design, folder: Path, samples: int = SAMPLES) -> list[str]:
    """Write tables and summary into a folder; their names. Raises NoSolution, FileError, and then writes nothing."""
    made = tables_of(design, samples)
    checkpoint()  # the last at which it may be cancelled
    write_into(folder, made)
    return list(made)


def _into(folder: Path, files: Mapping[str, bytes]) -> list[Path]:
    write_into(folder, files)
    return [folder]


@frozen
class Export:
    """One row of the menu File > Export: its text and tip, what it does, and why this design has none of it, if it has not."""

    text: str
    tip: str
    act: Callable[[], None]
    why_not: str = ""


def _written(path: Path, content: bytes) -> list[Path]:
    write_all(path.parent, {path.name: content})
    return [path]


BALANCED = "The balance cam follows from the torque of the others"


class Exports(QObject):
    """What the menu File > Export offers and does.

    status_message (str): what has been done, for the status line
    """

    status_message = Signal(str)

    def __init__(self, session: Session, player: Player, window: QWidget) -> None:
        super().__init__(window)
        self._session, self._player, self._window = session, player, window
        self._settings = Settings()
        self.layers: Callable[[], dict[str, bool]] = lambda: {name: row.shown for name, row in LAYERS.items()}

        self.view: Callable[[str], Any] = lambda name: None

    def rows(self) -> tuple[Export, ...]:
        """All that can be written besides the design, in the menu's order."""
        session = self._session
        no_cam = "" if session.design.drive.cam is not None else NO_CAM
        moves = any(drive.motion is not None for drive in session.full_design.drives)
        return (
            Export(
                "&Tables...",
                "Write profile, kinematics, dynamics (CSV) and summary (JSON) into a folder",
                self.tables,
            ),
            Export(
                "Pro&file...",
                "Write the cam's profile, or the path of a cutter, as DXF, SVG, CSV or G-code, and how far that is from the exact curve",
                self.profile,
                no_cam,
            ),
            Export(
                "&Drawing...",
                "Write the cam as a drawing for the workshop, with dimensions, table of points and title block, as PDF or SVG",
                self.drawing,
                no_cam,
            ),
            Export(
                "&Controller...",
                "Write the motion as the table of a servo controller, with the error that the controller makes of it",
                self.controller,
                BALANCED if session.on_balancer else "",
            ),
            Export(
                "&Inspection table...",
                "Write the lift that a probe measures on the cam, with its tolerance band, as CSV",
                self.inspection,
                no_cam,
            ),
            Export(
                "Ti&ming chart...",
                "Write the motions of all drives over the machine angle as PDF, SVG or PNG, or their starts and ends as CSV",
                self.timing,
                "" if moves else "No drive of this design follows a motion",
            ),
            Export("&Report as text...", "Write the whole report as plain text", self.text_report),
            Export(
                "&Hand-over...",
                "All that workshop, controls and buyer ask for in one archive: profiles, drawings, tables, report, web page, design",
                self.handover,
            ),
            Export(
                "&Web page...",
                "Write one HTML file for who has no KINDYNA: the machine plays and is turned by hand, with curves, findings and inputs",
                self.web_page,
            ),
            *(self._of_linkage() if session.design.drive.links else ()),
            Export("&Picture of the mechanism...", "Write the drawing as PNG or SVG", self.picture),
            Export("&Animation...", "Write one turn of the mechanism as GIF or WebP", self.animation),
        )

    def _of_linkage(self) -> tuple[Export, ...]:
        """What is written of links alone."""
        return (
            Export(
                "P&ose of the links...", "The links as they stand now, a layer each, as DXF or SVG in mm", self.pose
            ),
            Export(
                "C&urves of points...",
                "What the points run through, as CSV, or a layer each as DXF or SVG",
                self.curves,
            ),
        )

    @property
    def _name(self) -> str:
        """A name for files: that of the design's own file, else of the design."""
        path = self._session.path
        stem = path.stem if path is not None else self._session.full_design.name
        return file_name("".join(c if c.isalnum() or c in "-_" else "_" for c in stem).strip("_")) or "design"

    @property
    def _drive_name(self) -> str:
        """The same for a file of the chosen drive."""
        return f"{self._name}_{slug(self._session.design.name)}" if self._session.several else self._name

    @property
    def _drive(self) -> Design:
        """The chosen drive, under a name that serves outside the window."""
        return in_machine(self._session.full_design, self._session.design)

    def tables(self) -> None:
        """Profile, kinematics, dynamics and summary, at as many cam angles as wanted."""
        from kindyna_gui import export_dialogs

        wanted = export_dialogs.tables_wanted(self._window, self._settings.folder, self._session.full_study)
        if wanted is None:
            return
        design = self._session.full_design
        try:
            made = background.beside(
                self._window, "Writing the tables", lambda: write_tables(design, wanted.folder, wanted.samples)
            )
        except KindynaError as error:
            dialogs.show_faults(self._window, "The tables cannot be exported.", [reason(design, error)])
            return
        if made is None:
            self.status_message.emit("The export of the tables was cancelled; nothing is written")
            return
        self._settings.folder = wanted.folder
        self._report(f"Wrote {', '.join(made)} into {wanted.folder}")

    def report(self) -> None:
        """The report to hand on, as PDF or HTML: its numbers are computed beside the window, then its pictures are painted."""
        from core.output.report.document import document
        from kindyna_gui import export_dialogs
        from kindyna_gui.pictures.paper.report import report_file

        wanted = export_dialogs.report_wanted(self._window)
        path = (
            None
            if wanted is None
            else dialogs.report_to_save(self._window, self._settings.folder / f"{self._name}{wanted.ending}")
        )
        if wanted is None or path is None:
            return
        design = self._session.full_design
        make = partial(document, Study(design), wanted.parts, wanted.cover)
        try:
            made = background.beside(self._window, f"Computing {path.name}", make)
            data, lacking = None, ""
            if made is not None:
                with (
                    background.progress(self._window, f"Painting {path.name}", len(made.pictures) + 1) as go_on,
                    in_file_units(),
                ):
                    data, lacking = report_file(made, path.suffix.lower(), go_on), made.lacking
        except KindynaError as error:
            dialogs.show_faults(self._window, "There is no report of this design.", [reason(design, error)])
            return
        if data is None:
            self._report(f"{path.name} was cancelled; nothing is written")
            return
        text = written(self._window, path, lambda: data, paints=True)
        self._report("; ".join(filter(None, (text, lacking))) if text else "")
        if text and wanted.opened:
            export_dialogs.open_outside(path)

    def text_report(self) -> None:
        """The report as plain text."""
        from core.output.report import report

        path = dialogs.report_to_save(self._window, self._settings.folder / f"{self._name}.txt")
        design = self._session.full_design
        self._report(written(self._window, path, lambda: report(Study(design))))

    def web_page(self) -> None:
        """The machine as a page that plays."""
        from core.output.handover import write_page

        path = dialogs.page_to_save(self._window, self._settings.folder / f"{self._name}.html")
        design = self._session.full_design
        self._write_beside(path, lambda path: write_page(Study(design), path))

    def handover(self) -> None:
        """All of a design in one archive: what is computed beside the window, then what is painted."""
        from core.output.handover import handover
        from kindyna_gui.export_dialogs import handover_wanted, painted

        request = handover_wanted(self._window)
        path = (
            None
            if request is None
            else dialogs.handover_to_save(self._window, self._settings.folder / f"{self._name}.zip")
        )
        if request is None or path is None:
            return
        design = self._session.full_design
        study = Study(design)
        try:
            made = background.beside(self._window, f"Computing {path.name}", lambda: handover(design, request))
            with background.progress(self._window, f"Painting {path.name}", 12) as go_on, in_file_units():
                more = painted(study, request, go_on) if made is not None else None
            if made is None or more is None:
                self._report(f"{path.name} was cancelled; nothing is written")
                return
            whole = made.with_files(*more)
            whole.write(path)
        except KindynaError as error:
            dialogs.show_faults(self._window, f"{path.name} cannot be written.", [reason(design, error)])
            return
        self._settings.folder = path.parent
        left = "".join(f"; left out: {what}: {why}" for what, why in whole.left_out)
        self._report(f"Wrote {len(whole.files)} files into {path}{left}")

    def profile(self) -> None:
        """The cam's profile, or the path of a cutter, for machines and drawings."""
        from core.output.files.files import write_profile
        from kindyna_gui import profile_dialogs

        if self._session.design.drive.cam is None:
            self.status_message.emit(NO_CAM)
            return
        wanted = profile_dialogs.profile_wanted(self._window, self._drive)
        if wanted is None:
            return
        job, ending = wanted
        path = dialogs.profile_to_save(self._window, self._settings.folder / f"{self._drive_name}{ending}")
        self._write_beside(path, lambda path: write_profile(job, path))

    def controller(self) -> None:
        """An electronic cam: the motion as a table for a servo controller."""
        from kindyna_gui.profile_dialogs import table_wanted

        session = self._session
        name = session.names[session.chosen] if session.several else ""
        made = table_wanted(self._window, session.full_design, name)
        if made is None:
            return
        path = dialogs.controller_table_to_save(
            self._window, self._settings.folder / f"{self._drive_name}{made.controller.extension}"
        )
        self._write_beside(path, lambda path: _written(path, made.content))

    def inspection(self) -> None:
        """The lift that a probe measures on the cam."""
        from core.output.files.inspection import write_inspection
        from kindyna_gui.inspection import inspection_wanted

        made = inspection_wanted(self._window, self._drive)
        if made is None:
            return
        path = dialogs.inspection_to_save(self._window, self._settings.folder / f"{self._drive_name}_lift.csv")
        self._write_beside(path, lambda path: write_inspection(made, path))

    def pose(self) -> None:
        """The links at the angle at hand."""
        from core.output.position import pose_file

        path = dialogs.links_to_save(self._window, self._settings.folder / f"{self._drive_name}_pose.dxf")
        study, theta = Study(self._drive), self._player.theta
        self._write_beside(path, lambda path: _written(path, pose_file(study, theta, path.suffix.lower())))

    def curves(self) -> None:
        """The curves of all points that move."""
        from core.output.position import curves_file, point_curves

        path = dialogs.links_to_save(self._window, self._settings.folder / f"{self._drive_name}_curves.csv", table=True)
        study = Study(self._drive)
        self._write_beside(
            path, lambda path: _written(path, curves_file(study, point_curves(study), path.suffix.lower()))
        )

    def _write_beside(self, path: Path | None, make: Callable[[Path], Sequence[Path]]) -> None:
        """Let files be written beside the window, and report which."""
        if path is None:
            return
        try:
            made = background.beside(self._window, f"Writing {path.name}", lambda: make(path))
        except KindynaError as error:
            dialogs.show_faults(
                self._window, f"{path.name} cannot be written.", [reason(self._session.full_design, error)]
            )
            return
        if made is None:
            self._report(f"{path.name} was cancelled; nothing is written")
            return
        self._settings.folder = path.parent
        self._report(f"Wrote {' and '.join(str(each) for each in made)}")

    def drawing(self) -> None:
        """The cam as a drawing for the workshop."""
        from kindyna_gui import profile_dialogs
        from kindyna_gui.pictures.paper.sheets import sheet_file

        sheet = profile_dialogs.drawing_wanted(self._window, self._drive)
        if sheet is None:
            return
        path = dialogs.drawing_to_save(self._window, self._settings.folder / f"{self._drive_name}.pdf")
        if path is not None:
            self._report(written(self._window, path, lambda: sheet_file(sheet, path.suffix.lower()), paints=True))

    def picture(self) -> None:
        """The mechanism as it is on the screen."""
        view = self.view("mechanism")
        if view is not None:
            save_picture(view, "mechanism")

    def timing(self) -> None:
        """The timing chart, or the table of its events; as the view of it has the axis and the shaded drives, where it is open."""
        from kindyna_gui.pictures.paper.timing_chart import timing_file

        view = self.view("timing")
        path = dialogs.timing_to_save(self._window, self._settings.folder / f"{self._name}_timing.pdf")
        shown = {} if view is None else {"unit": view.canvas.unit, "pair": view.canvas.pair}
        design = self._session.full_design
        if path is not None:
            self._report(
                written(self._window, path, lambda: timing_file(design, path.suffix.lower(), **shown), paints=True)
            )

    def animation(self) -> None:
        """One turn of the mechanism as GIF or WebP, with the layers that are on the screen."""
        from kindyna_gui import export_dialogs
        from kindyna_gui.pictures.film import pictures, shoot

        seconds = 2.0 * pi / (abs(self._player.omega) * self._player.speed)
        wanted = export_dialogs.film_wanted(self._window, self._settings.folder, self._name, seconds)
        if wanted is None:
            return
        path, film = wanted
        try:
            with (
                background.progress(self._window, f"Drawing {film.frames} frames", film.frames) as go_on,
                in_file_units(),
            ):
                take = pictures if film.ending == ".png" else shoot
                data = take(self._session.full_design, film, self.layers(), go_on)
        except KindynaError as error:
            dialogs.show_faults(
                self._window, "The mechanism cannot be drawn.", [reason(self._session.full_design, error)]
            )
            return
        if data is None:
            self.status_message.emit("The animation was cancelled; nothing is written")
        elif isinstance(data, dict):
            self._write_beside(path.with_suffix(""), lambda folder: _into(folder, data))
        else:
            self._report(written(self._window, path, lambda: data, paints=True))

    def _report(self, text: str) -> None:
        """Say what was written; with the values that are not in it, since they do not fit together yet."""
        if text:
            waits = waiting_text(self._session)
            self.status_message.emit(f"{text}; of the last design that fits. {waits}" if waits else text)
