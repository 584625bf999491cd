"""What stands on a sheet of paper: lines, circles, curves, arrows and texts [mm], without anything that paints them.

Places are complex, from the lower left corner of the sheet, y upwards.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from core.frozen import frozen
from core.output.letterhead import Logo

OUTLINE, THIN, CENTRE, DASHED, FRAME = "outline", "thin", "centre", "dashed", "frame"


@frozen
class LineKind:
    """Width [mm]; dashes [mm], drawn and left out in turn."""

    width: float
    dashes: tuple[float, ...] = ()


LINE_KINDS: Mapping[str, LineKind] = MappingProxyType(
    {
        OUTLINE: LineKind(0.5),
        THIN: LineKind(0.18),
        CENTRE: LineKind(0.18, (6.0, 1.2, 0.6, 1.2)),
        DASHED: LineKind(0.18, (2.0, 1.0)),
        FRAME: LineKind(0.35),
    }
)
"""Lines of ISO 128: visible edges, dimensions, axes, circles that are no edges, frames."""


@frozen
class SheetLine:
    """From point to point, through all of them; ``kind`` is a row of ``LINE_KINDS``."""

    points: tuple[complex, ...]
    kind: str = THIN


@frozen
class SheetCircle:
    """All of a circle, or the arc of so many degrees counter-clockwise from ``start_deg``."""

    centre: complex
    radius: float
    kind: str = THIN
    start_deg: float = 0.0
    span_deg: float = 360.0


@frozen(eq=False)
class BezierLoop:
    """A closed chain of cubics: their Bézier points (n, 4)."""

    points: np.ndarray
    kind: str = OUTLINE


@frozen
class ArrowHead:
    """A filled arrowhead: its tip, the unit vector in which it points, its length."""

    tip: complex
    direction: complex
    length: float


@frozen
class SheetText:
    """One line: where it stands on its baseline, height of its capitals, the width that it has at most: what is longer is
    condensed; align: 0 begins there, 0.5 has its middle there, 1 ends there."""

    at: complex
    text: str
    height: float
    room: float
    align: float = 0.0


@frozen(eq=False)
class SheetLogo:
    """A picture as large as it fits between two corners, lower left and upper right."""

    low: complex
    high: complex
    logo: Logo


Item: TypeAlias = "SheetLine | SheetCircle | BezierLoop | ArrowHead | SheetText | SheetLogo"


@frozen(eq=False)
class DrawingSheet:
    """A sheet of paper: its size [mm], a title, sentences that say what it is, and what stands on it; lacking: what should and does not,
    in a line."""

    width: float
    height: float
    title: str
    about: str
    items: tuple[Item, ...]
    lacking: str = ""


__all__ = [
    "CENTRE", "DASHED", "FRAME", "LINE_KINDS", "OUTLINE", "THIN", "ArrowHead", "BezierLoop", "DrawingSheet", "Item",
    "LineKind", "SheetCircle", "SheetLine", "SheetLogo", "SheetText",
]  # fmt: skip
