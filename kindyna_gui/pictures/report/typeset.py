"""Equations typeset from the MathML that the report in HTML has, as vectors for the PDF."""

from __future__ import annotations

import warnings
from functools import cache

from PySide6.QtCore import QByteArray, QRectF
from PySide6.QtGui import QPainter
from PySide6.QtSvg import QSvgRenderer

from core.frozen import frozen

SIZE = 24.0  # of the letters, in which widths and heights are counted


@frozen(eq=False)
class Typeset:
    """An equation: its width and height as parts of the size of its letters, and what paints it into a box."""

    width: float
    height: float
    renderer: QSvgRenderer

    def paint(self, painter: QPainter, box: QRectF) -> None:
        """It fills the box."""
        self.renderer.render(painter, box)


@cache
def typeset(mathml: str) -> Typeset:
    """The equation of a MathML element."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # it finds its fonts the old way
        import ziamath  # loading it takes as long as a small report

    ziamath.config.svg2 = False  # Qt draws no symbols that are defined elsewhere
    made = ziamath.Math(mathml, size=SIZE)
    width, height = made.getsize()
    return Typeset(width / SIZE, height / SIZE, QSvgRenderer(QByteArray(made.svg().encode())))


__all__ = ["Typeset", "typeset"]
