"""All of a design that its workshop, its controls engineer and its buyer ask for: one folder or archive with a list of contents."""

from __future__ import annotations

import hashlib
import io
import json
import os
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from core.design import Design
from core.design.fields import number
from core.errors import KindynaError
from core.findings import ERROR
from core.frozen import frozen
from core.output import inspection, profile
from core.output.controllers.facts import facts
from core.output.controllers.made import ecam
from core.output.controllers.of_design import slave_of
from core.output.controllers.request import Request as EcamRequest
from core.output.controllers.row import controller
from core.output.inspection.files import files as inspection_files
from core.output.profile.drawing import facts as profile_facts
from core.output.report.document import Cover
from core.output.summary import to_json
from core.output.web import web_page
from core.project import dumps
from core.project.files import is_folder, read_own, remove_listed, write, write_into
from core.project.origins import with_own_motions
from core.requests import asked, typed
from core.study import Study

CONTENTS, ARCHIVE = "contents.json", ".zip"
EARLIEST = (1980, 1, 1, 0, 0, 0)  # that an archive can hold: the same design gives the same bytes


@frozen
class Request(Cover):
    """What else is wanted: what stands on report and drawings, for which controller, G-code, and how exact curves are."""

    controller: str = typed("row of the table of controllers: a table of each drive", default="", metavar="SLUG")
    error_mm: float = asked(
        number("Largest error", 0.0, 1.0, open_low=True, default=1e-3, help="of profiles, and of a controller's table"),
        "--error",
        metavar="MM",
    )
    gcode: bool = typed("also G-code of every cam", default=False, action="store_true")


@frozen(eq=False)
class HandoverFile:
    """name: with its folder; what: in words; deviation: largest from the exact curve, with its unit; None where nothing is fitted."""

    name: str
    what: str
    data: bytes
    deviation: tuple[float, str] | None = None


@frozen(eq=False)
class Handover:
    """The files, and what could not be made of this design: what and why."""

    files: tuple[HandoverFile, ...]
    left_out: tuple[tuple[str, str], ...]

    def with_files(self, more: Iterable[HandoverFile], left_out: Iterable[tuple[str, str]] = ()) -> Handover:
        """Beside these others, such as what only a program with fonts paints; in order of their names."""
        files = sorted((*self.files, *more), key=lambda each: each.name)
        return Handover(tuple(files), (*self.left_out, *left_out))

    @property
    def contents(self) -> dict[str, Any]:
        """As ``contents.json`` lists them: name, what, deviation, sha256; and what was left out."""
        rows = [
            {
                "name": each.name,
                "what": each.what,
                "deviation": None if each.deviation is None else each.deviation[0],
                "unit": None if each.deviation is None else each.deviation[1],
                "sha256": hashlib.sha256(each.data).hexdigest(),
            }
            for each in self.files
        ]
        return {"files": rows, "left_out": [{"what": what, "why": why} for what, why in self.left_out]}

    def write(self, out: Path) -> None:
        """As a folder that is empty or new, or as a zip archive; a hand-over in that place is replaced where it is as it was written.
        Raises KindynaError, FileError, and then nothing has changed."""
        made: dict[str, str | bytes] = {each.name: each.data for each in self.files}
        made[CONTENTS] = to_json(self.contents)
        archive = out.suffix.lower() == ARCHIVE
        there = os.path.lexists(out) if archive else out.is_dir() and any(out.iterdir())
        before = (_names_in_archive if archive else _names_in_folder)(out) if there else []
        if before is None:
            what = "file is there already" if archive else "folder is not empty"
            other = "another name" if archive else "an empty or new one, or NAME.zip"
            raise KindynaError(f"{out}: this {what} and it, or a part of it, is no hand-over; allowed: {other}")
        if archive:
            write(out, _packed(made))
        else:
            write_into(out, made)
            remove_listed(out, set(before) - made.keys())


# -- a hand-over that is replaced ---------------------------------------------------------------------------

MOST_UNPACKED = 1 << 28
"""Bytes; no hand-over is as large."""


def _names_in_archive(path: Path) -> list[str] | None:
    """The files of a hand-over, which is as it was written; None for any other archive: with a comment, a folder, a file twice."""
    with suppress(Exception):  # archives from anywhere fail in many ways
        data = read_own(path)
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            rows = archive.infolist()
            size = 22 + sum(76 + 2 * len(row.filename.encode()) + row.compress_size for row in rows)
            if size == len(data) and sum(row.file_size for row in rows) <= MOST_UNPACKED:
                return _own([row.filename for row in rows], archive.read)
    return None


def _names_in_folder(path: Path) -> list[str] | None:
    """The files of a hand-over, which is as it was written; None for any other folder, and for a link to one."""
    with suppress(Exception):  # as lists of contents from anywhere do
        if is_folder(path):
            return _own(_files_in(path), lambda name: read_own(path / name))
    return None


def _files_in(path: Path) -> Iterator[str]:
    """Names of files, links among them, and with a stroke behind those of links to folders and of empty folders."""
    for place, folders, names in os.walk(path):
        inside = Path(place).relative_to(path)
        yield from ((inside / name).as_posix() for name in names)
        yield from (f"{inside / name}/" for name in folders if not is_folder(Path(place, name)))
        if not folders and not names:
            yield f"{inside}/"


def _own(names: Iterable[str], read: Callable[[str], bytes]) -> list[str] | None:
    """The names, where the list of contents has each of them, but itself, with the sha256 of what is read."""
    hashes = {row["name"]: row["sha256"] for row in json.loads(read(CONTENTS))["files"]}
    same = sorted(names) == sorted([*hashes, CONTENTS]) and all(
        hashlib.sha256(read(name)).hexdigest() == value for name, value in hashes.items()
    )
    return [*hashes] if same else None


def _packed(files: dict[str, str | bytes]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            archive.writestr(zipfile.ZipInfo(name, EARLIEST), files[name], zipfile.ZIP_DEFLATED)
    return target.getvalue()


def handover(design: Design, request: Request) -> Handover:
    """What needs no fonts: profiles, inspection tables, tables of a controller, web page, the design itself.

    Raises KindynaError for a controller that is not known, NoAnswer where the whole has none.
    """
    if request.controller:
        controller(request.controller)
    files = [
        HandoverFile("design.toml", "the design itself, to be opened again", dumps(with_own_motions(design)).encode())
    ]
    left_out: list[tuple[str, str]] = []
    study = Study(design)
    for folder, name, each in drives_of(study):
        for what, made in _makers(design, folder, name, each, request):
            try:
                files += made()
            except KindynaError as error:
                left_out.append((f"{what}, {name}" if name else what, str(error)))
    files.append(HandoverFile("machine.html", "a page that plays the machine in any browser", web_page(study).encode()))
    return Handover((), tuple(left_out)).with_files(files)


def drives_of(study: Study) -> Iterator[tuple[str, str, Study]]:
    """Folder with its stroke, name, and study of each drive; of a single one both are empty."""
    if not study.design.listed:
        yield "", "", study
        return
    camshaft = study.camshaft
    for name, each in study.drives.items():
        yield f"{camshaft.slugs[name]}/", name, each


def _makers(
    design: Design, folder: str, name: str, study: Study, request: Request
) -> Iterator[tuple[str, Callable[[], Sequence[HandoverFile]]]]:
    of = f" of {name}" if name else ""
    if "cam" in study.stages:
        yield "profile", lambda: _profile(study, folder, of, request, ".dxf")
        if request.gcode:
            yield "G-code", lambda: _profile(study, folder, of, request, ".nc")
        yield "inspection table", lambda: _inspection(study, folder, of)
    if request.controller:
        yield "table of the controller", lambda: _controller(design, folder, name, request)


def _profile(study: Study, folder: str, of: str, request: Request, ending: str) -> list[HandoverFile]:
    path = Path(f"profile{ending}")
    fit = "arcs" if ending == ".nc" else ""
    job = profile.job_of(study, path, profile.Request(tolerance_mm=request.error_mm, fit=fit))
    deviation = float(profile_facts(job)["deviation_mm"]), "mm"
    return [
        HandoverFile(
            folder + name,
            f"profile of the cam{of}" if name == path.name else f"what {path.name} is, as JSON",
            data,
            deviation if name == path.name else None,
        )
        for name, data in profile.files(job, path).items()
    ]


def _inspection(study: Study, folder: str, of: str) -> list[HandoverFile]:
    made = inspection.inspection(study, inspection.Request())
    if wrong := [each.message for each in made.probing.findings if each.severity == ERROR]:
        raise KindynaError(wrong[0])
    texts = inspection_files(made, Path("inspection.csv"))
    words = {"inspection.csv": f"lift that a probe measures on the cam{of}, with its tolerance"}
    facts = "which probe and tolerance inspection.csv is for, as JSON"
    return [HandoverFile(folder + name, words.get(name, facts), data) for name, data in texts.items()]


def _controller(design: Design, folder: str, name: str, request: Request) -> list[HandoverFile]:
    row, wanted = controller(request.controller), EcamRequest(error=request.error_mm)
    slave, title, speed = slave_of(design, name, wanted)
    made = ecam(slave, row, wanted, title, speed)
    deviation = None if made.deviation is None else (float(made.deviation.values[0]), slave.unit)
    of = f" of {name}" if name else ""
    return [
        HandoverFile(f"{folder}controller{row.extension}", f"table for {row.label}{of}", made.content, deviation),
        HandoverFile(f"{folder}controller.json", "its certificate, as JSON", to_json(facts(made)).encode()),
    ]


__all__ = ["Handover", "HandoverFile", "Request", "drives_of", "handover"]
