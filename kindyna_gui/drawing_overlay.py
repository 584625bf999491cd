"""What covers the drawing of the mechanism while a task is drawn on it, and what it may ask of the drawing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QWidget


class DrawingOverlay(Protocol):
    """What is drawn with the mouse over the drawing of the mechanism, which is faint below it and leaves the mouse to it."""

    def start(self, canvas: Any) -> None:
        """Take the mouse and the keys of the canvas of the drawing."""

    def stop(self) -> None:
        """Give them back."""

    def leave(self) -> None:
        """Ask to be removed: the drawing is needed for something else."""

    def fit(self) -> None:
        """Zoom to all that is drawn."""

    def paint(self, painter: QPainter) -> None:
        """Paint over the drawing, in pixels."""


class MechanismDrawing(Protocol):
    """The drawing of the mechanism, which a sheet can cover."""

    def cover(self, sheet: DrawingOverlay, above: QWidget, below: QWidget) -> None:
        """Lay a sheet over the drawing, with a bar above it and a strip below, until it is uncovered."""

    def uncover(self, sheet: DrawingOverlay) -> None:
        """Remove this sheet from the drawing."""

    def joints(self) -> Mapping[str, complex]:
        """Names of the joints, and their present positions [mm]."""
