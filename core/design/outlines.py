"""Outlines of bodies, and the clearances that pairs of bodies must keep.

Several outlines of one body count together. A body is named by its word, ``link 3`` or ``arm``, on a shaft of several drives
after the slug of its drive: ``feed.arm``; the frame, and the part that the drives transfer together, have no drive.
"""

from __future__ import annotations

from core.design.fields import LONGEST_MM, FileLayout, choice, coordinate, number, placed, seldom
from core.frozen import frozen

FRAME, CARRIED, CAM, ROLLER = "frame", "carried", "cam", "roller"
"""Bodies of designs of any kind: the frame, the transferred part, the cam of a drive and its roller."""
FREE = (FRAME, CARRIED)
"""Bodies that belong to no drive."""
PLANES = ("xy", "xz", "yz")
"""Planes in which the transferred part is compared with the frame: horizontal and vertical axis."""


@frozen
class OutlinePoint:
    """A corner of an outline, in the frame of its body."""

    x_mm: float = coordinate("x")
    y_mm: float = coordinate("y")


@frozen(kw_only=True)
class Outline:
    """Outline of a body: corners, a drawing, or the circle of a roller, the profile of a cam, the points of a link.

    ``folder`` is that of the design's file, to which ``file`` is relative.
    """

    of: str = placed(FileLayout(missing='the name of a body, as "link 3", "arm", "cam" or "frame"'))
    drive: str | None = placed(FileLayout(), None)
    plane: str | None = seldom(
        choice("Plane", PLANES, default=None, help="of the transferred part, and of the frame next to it")
    )
    points: tuple[OutlinePoint, ...] = placed(FileLayout(OutlinePoint, rows=True, whole=True), ())
    file: str | None = placed(FileLayout(), None)
    round_mm: float | None = number(
        "Grown by", 0.0, LONGEST_MM, default=None, help="one point is a circle, two a bar, more their rounded polygon"
    )
    layer_from_mm: float | None = coordinate("Layer from", help="across the plane; empty = no end", default=None)
    layer_to_mm: float | None = coordinate("Layer to", help="across the plane; empty = no end", default=None)
    folder: str = placed(FileLayout(in_file=False), "")

    @property
    def layer(self) -> tuple[float, float]:
        """Begin and end of its layer [mm]; infinite where there is no end."""
        low, high = self.layer_from_mm, self.layer_to_mm
        return (-LONGEST_MM if low is None else low), (LONGEST_MM if high is None else high)


@frozen
class ClearanceRow:
    """Clearance that two bodies must keep over the turn."""

    between: tuple[str, ...] = placed(FileLayout(each=str, missing='the names of two bodies, ["link 3", "frame"]'))
    least_mm: float = number("Least clearance", 0.0, LONGEST_MM, default=0.0)
