"""The drawing of a cam as one sheet for the workshop: everything on it in millimetres of paper, painted elsewhere."""

from core.output.drawing.page import ENDINGS, drawing
from core.output.drawing.paper import PAPERS
from core.output.drawing.request import Request
from core.output.drawing.sheet import (
    LINE_KINDS,
    ArrowHead,
    BezierLoop,
    DrawingSheet,
    SheetCircle,
    SheetLine,
    SheetLogo,
    SheetText,
)

__all__ = [
    "ENDINGS", "LINE_KINDS", "PAPERS", "ArrowHead", "BezierLoop", "DrawingSheet", "Request", "SheetCircle", "SheetLine",
    "SheetLogo", "SheetText", "drawing",
]  # fmt: skip
