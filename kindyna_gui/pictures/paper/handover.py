"""Painted files of a hand-over: the report and the workshop drawings, as PDF."""

from __future__ import annotations

from core.errors import KindynaError
from core.output.files.cam_drawing import drawing
from core.output.files.sheet import DrawingRequest
from core.output.handover import HandoverFile, HandoverRequest, drive_folders
from core.output.report.document import document
from core.study import Study
from kindyna_gui.pictures.paper.report import GoOn, report_file
from kindyna_gui.pictures.paper.sheets import sheet_file


def paint_handover(
    study: Study, request: HandoverRequest, go_on: GoOn = lambda done: True
) -> tuple[list[HandoverFile], list[tuple[str, str]]] | None:
    """Return the painted files, and the missing ones with the reason; None where cancelled.

    Raises NoSolution where the report cannot be calculated.
    """
    content = document(study, cover=request)
    report = report_file(content, ".pdf", go_on)
    if report is None:
        return None
    files = [HandoverFile("report.pdf", "the report", report)]
    left_out = [("logo", content.lacking)] if content.lacking else []
    title = {name: getattr(request, name) for name in ("author", "company", "logo", "date")}
    for folder, name, drive in drive_folders(study):
        if not drive.has_disk:
            continue
        of_drive = f" of {name}" if name else ""
        try:
            files.append(
                HandoverFile(
                    f"{folder}drawing.pdf",
                    f"workshop drawing of the cam{of_drive}",
                    sheet_file(drawing(drive, DrawingRequest(**title)), ".pdf"),
                )
            )
        except KindynaError as error:
            left_out.append((f"drawing{of_drive}", str(error)))
    return files, left_out
