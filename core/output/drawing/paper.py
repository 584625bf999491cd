"""Papers, the standard scales, and the fields into which a sheet is divided."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.errors import KindynaError
from core.frozen import frozen

PAPERS: Mapping[str, tuple[float, float]] = MappingProxyType({"A4": (297.0, 210.0), "A3": (420.0, 297.0)})
"""Width and height [mm], lying."""

FILING, EDGE = 20.0, 10.0  # mm: edges of ISO 5457, the wide one for filing
USUAL = 190.0  # mm inside the frame of an A4: on larger paper texts and tables grow alike
COLUMN = 96.0  # of tables and title block, on A4

STEPS, DECADES = (1, 2, 5), range(5)
SCALES: tuple[tuple[int, int], ...] = tuple(
    sorted(
        {pair for step in STEPS for decade in DECADES for pair in ((step * 10**decade, 1), (1, step * 10**decade))},
        key=lambda pair: -pair[0] / pair[1],
    )
)
"""Of ISO 5455, paper : cam, from the largest."""


@frozen
class Box:
    """A rectangle on the sheet [mm]."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def width(self) -> float:
        """Width [mm]."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Height [mm]."""
        return self.top - self.bottom

    @property
    def middle(self) -> complex:
        """Its middle [mm]."""
        return 0.5 * complex(self.left + self.right, self.bottom + self.top)

    @property
    def corners(self) -> tuple[complex, ...]:
        """All round and back to the first."""
        low, high = complex(self.left, self.bottom), complex(self.right, self.top)
        return low, complex(self.right, self.bottom), high, complex(self.left, self.top), low


@frozen
class PaperLayout:
    """A paper: its size, the frame, the field of the view and that of the tables; ``unit`` is how much larger than on A4 texts
    and tables are."""

    width: float
    height: float
    frame: Box
    view: Box
    column: Box
    unit: float


def layout(paper: str) -> PaperLayout:
    """The fields of a row of ``PAPERS``. Raises KindynaError for any other paper."""
    size = PAPERS.get(paper)
    if size is None:
        raise KindynaError(f"paper {paper!r}: not known; allowed: {', '.join(PAPERS)}")
    width, height = size
    frame = Box(FILING, EDGE, width - EDGE, height - EDGE)
    unit = frame.height / USUAL
    divide = frame.right - COLUMN * unit
    return PaperLayout(
        width,
        height,
        frame,
        Box(frame.left, frame.bottom, divide, frame.top),
        Box(divide, frame.bottom, frame.right, frame.top),
        unit,
    )


def scale_for(width: float, height: float, room: tuple[float, float]) -> tuple[int, int]:
    """The largest standard scale at which width and height [mm] have room [mm]. Raises KindynaError where none is small enough."""
    for on_paper, real in SCALES:
        if width * on_paper <= room[0] * real and height * on_paper <= room[1] * real:
            return on_paper, real
    least = f"{SCALES[-1][0]}:{SCALES[-1][1]}"
    raise KindynaError(
        f"a cam of {max(width, height):.6g} mm has no room on the sheet at {least}, the smallest scale; take larger paper"
    )


__all__ = ["PAPERS", "SCALES", "Box", "PaperLayout", "layout", "scale_for"]
