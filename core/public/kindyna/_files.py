"""Files of a study: tables, profiles, reports, and tables for controllers, as the commands write them."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from importlib.util import find_spec
from json import loads as parsed
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from core.commands.cams import ProfileArguments
from core.commands.common import one_studied, require_cam, solved
from core.commands.designs import ReportArguments, requested_document
from core.commands.export import ExportArguments
from core.commands.surfaces import SurfaceArguments
from core.commands.tables import EcamArguments, controller_table
from core.errors import FileError, KindynaError
from core.output.controllers.deviation import facts
from core.output.export import export
from core.output.files.files import FORMATS, profile_job, write_profile
from core.output.report.document import ENDINGS, html
from core.output.solids.surface import SURFACE_FORMATS, surface_job, write_surface
from core.output.summary import to_json
from core.project import save
from core.project.files import write, write_all
from core.requests import command_words
from core.study.study import Study
from kindyna._options import requested

_PDF = ".pdf"


def export_study(
    study: Study, target: Path, options: Mapping[str, Any], without: frozenset[str] = frozenset()
) -> list[Path]:
    """Write tables into a folder, or a profile, surfaces or a report to a file; return the paths. Raises as ``StudyResults.export``.

    ``without`` lists quantities that the tables omit.
    """
    writers = {
        **dict.fromkeys(SURFACE_FORMATS, _surface),
        **dict.fromkeys(FORMATS, _profile),
        ".nc": _gcode,
        **dict.fromkeys(ENDINGS, _report),
    }
    ending = target.suffix.lower()
    if ending in writers:
        return writers[ending](study, target, options)
    if ending[1:].isalpha() and not target.is_dir():
        allowed = f"{', '.join(writers)}, or a folder, with such a name one that exists"
        raise KindynaError(f"{target}: no format has the ending {ending}; allowed: {allowed}")
    request = requested(ExportArguments, options, "samples", design=Path(), out=target)
    return export(solved(study), request.out, request.only, without)


def _profile(study: Study, target: Path, options: Mapping[str, Any]) -> list[Path]:
    request = requested(ProfileArguments, options, "json", design=Path(), out=target)
    drive = one_studied(study.design, request.drive)
    require_cam(drive, "export")
    return write_profile(profile_job(drive, target, request.request), target)


def _surface(study: Study, target: Path, options: Mapping[str, Any]) -> list[Path]:
    request = requested(SurfaceArguments, options, "json", design=Path(), out=target)
    surfaces = request.request
    if surfaces.of and request.drive:
        surfaces = replace(surfaces, of=f"{request.drive}.{surfaces.of}")
    subject = study if surfaces.of else one_studied(study.design, request.drive)
    return write_surface(surface_job(subject, target, surfaces), target)


def _gcode(study: Study, target: Path, options: Mapping[str, Any]) -> list[Path]:
    drive = one_studied(study.design, options.get("drive", ""))
    return (_surface if drive.has_surface else _profile)(study, target, options)


def _report(study: Study, target: Path, options: Mapping[str, Any]) -> list[Path]:
    request = requested(ReportArguments, options, "samples", design=Path(), out=target)
    if target.suffix.lower() == _PDF:
        _print_report(study, target, {**vars(request.cover), "without": request.without, "samples": study.samples})
        return [target]
    document = requested_document(solved(study), request)
    if document.lacking:
        raise KindynaError(document.lacking)
    write(target, html(document, {}).encode())
    return [target]


def _print_report(study: Study, target: Path, values: Mapping[str, Any]) -> None:
    """Print a report in a process of its own, since Qt needs an application, which a notebook may use otherwise."""
    if any(find_spec(package) is None for package in ("kindyna_gui", "PySide6")):
        raise KindynaError(f"{target}: a PDF needs the packages of the window, PySide6 and pyqtgraph; .html does not")
    with TemporaryDirectory() as folder:
        design = Path(folder, "design.toml")
        save(study.design, design)
        words = command_words(ReportArguments, {**values, "design": design, "out": target.absolute()})
        command = [sys.executable, "-P", "-m", "kindyna_gui", "--headless", "report", *words]
        done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", errors="replace")
    if done.returncode not in (0, 1) or not target.is_file():
        raise FileError(done.stderr.strip() or f"{target}: cannot be written")


def ecam_table(study: Study, controller: str, out: Path | None, options: Mapping[str, Any]) -> dict[str, Any]:
    """Write a table for a controller where a file is given; return its certificate. Raises as ``export_study``."""
    request = requested(EcamArguments, options, "json", design=Path(), out=out, controller=controller)
    table, files = controller_table(study.design, request)
    contents: dict[Path, str | bytes] = {**({} if out is None else {out: table.content}), **files}
    for path, content in contents.items():
        write_all(path.parent, {path.name: content})
    data: dict[str, Any] = parsed(to_json(facts(table)))
    return data
