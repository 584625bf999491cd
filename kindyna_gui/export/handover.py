"""What of a hand-over is painted: the report, and the drawing of every cam for the workshop."""

from __future__ import annotations

from core.errors import KindynaError
from core.output.files.cam_drawing import drawing
from core.output.files.sheet import DrawingRequest
from core.output.handover import HandoverFile, HandoverRequest, drives_of
from core.output.report.document import document
from core.study import Study
from kindyna_gui.pictures.report.files import GoOn, report_file
from kindyna_gui.pictures.sheet_file import sheet_file


def painted(
    study: Study, request: HandoverRequest, go_on: GoOn = lambda done: True
) -> tuple[list[HandoverFile], list[tuple[str, str]]] | None:
    """The files, and what there is none of with the reason; None where it was not to go on. Raises NoSolution where there is no report."""
    made = document(study, cover=request)
    report = report_file(made, ".pdf", go_on)
    if report is None:
        return None
    files = [HandoverFile("report.pdf", "the whole report", report)]
    left_out = [("logo", made.lacking)] if made.lacking else []
    title = {name: getattr(request, name) for name in ("author", "company", "logo", "date")}
    for folder, name, each in drives_of(study):
        if "cam" not in each.stages:
            continue
        of = f" of {name}" if name else ""
        try:
            files.append(
                HandoverFile(
                    f"{folder}drawing.pdf",
                    f"drawing of the cam{of} for the workshop",
                    sheet_file(drawing(each, DrawingRequest(**title)), ".pdf"),
                )
            )
        except KindynaError as error:
            left_out.append((f"drawing{of}", str(error)))
    return files, left_out


__all__ = ["painted"]
