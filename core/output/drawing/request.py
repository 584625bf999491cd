"""What a drawing of a cam shall be like."""

from __future__ import annotations

from core.design.fields import choice
from core.frozen import frozen
from core.output.drawing.paper import PAPERS
from core.output.letterhead import Letterhead
from core.output.profile import flank_choice
from core.requests import typed


@frozen
class Request(Letterhead):
    """flank: name of one of the cam's; paper: row of ``PAPERS``; author, company, logo, date: what stands in the title block."""

    paper: str = choice("Paper", tuple(PAPERS), default="A4", help="size of the sheet, lying")
    flank: str = flank_choice()
    date: str = typed("for the field of the title block, empty without it", default="", metavar="TEXT")


__all__ = ["Request"]
