"""The drawing of a cam: one sheet with the view, its dimensions, the tables and the title block."""

from __future__ import annotations

from core.output.drawing.figures import Figures, figures
from core.output.drawing.paper import PaperLayout, layout
from core.output.drawing.request import Request
from core.output.drawing.sheet import FRAME, DrawingSheet, Item, SheetLine, SheetText
from core.output.drawing.tables import GAP, PAD, SMALL, dimensions_table, points_table, title_block
from core.output.drawing.view import view
from core.output.letterhead import logo_of
from core.output.lines import printable
from core.output.profile.drawing import SENSES
from core.study import Study

USUAL = Request()

ENDINGS = (".pdf", ".svg")
"""Of the files that a drawing is painted to."""


def drawing(study: Study, request: Request = USUAL) -> DrawingSheet:
    """The sheet of one flank of the study's cam.

    Raises as ``core.output.profile.job_of`` does, and KindynaError for a paper that is not known.
    """
    room = layout(request.paper)
    values = figures(study, request.flank)
    (on_paper, real), seen = view(values, room)
    scale = f"{on_paper}:{real}"
    items: list[Item] = [
        SheetLine(room.frame.corners, FRAME),
        SheetLine((room.view.corners[1], room.view.corners[2]), FRAME),
        *seen,
    ]
    bottom, table = points_table(values, room)
    end, dimensions = dimensions_table(values, room, bottom - GAP * room.unit)
    logo, lacking = logo_of(request)
    title = title_block(values, room, scale, request, logo)
    items += [*table, *dimensions, *title, *_notes(values, room, end)]
    name = printable(study.design.name)
    about = f"Cam {name}, {request.flank} flank, scale {scale}, millimetres; the cam turns {SENSES[study.sense][1]}"
    return DrawingSheet(room.width, room.height, name, about, tuple(items), lacking)


def _notes(values: Figures, room: PaperLayout, top: float) -> list[Item]:
    """What the tables mean, below them."""
    unit, column = room.unit, room.column
    lines = (
        "Table of points: distance of the profile from the cam centre at the cam angle, and",
        "its polar angle, counter-clockwise from the zero mark. Drawn at cam angle 0;",
        f"the cam turns {SENSES[values.job.study.sense][1]}.",
    )
    width = column.width - 2.0 * PAD * unit
    first = complex(column.left + PAD * unit, top - 2.2 * SMALL * unit)
    return [SheetText(first - 1j * i * 1.8 * SMALL * unit, line, SMALL * unit, width) for i, line in enumerate(lines)]


__all__ = ["ENDINGS", "drawing"]
