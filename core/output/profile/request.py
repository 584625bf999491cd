"""What a profile file shall hold, and how."""

from __future__ import annotations

from core.cam import INNER, OUTER, SECOND
from core.frozen import frozen

ALL_FLANKS = (INNER, OUTER, SECOND)


@frozen
class Machining:
    """How a path is cut, fields of ``MACHINING``.

    depth_mm       0: the cam's thickness
    step_mm        0: all in one pass
    conventional   instead of climb milling
    """

    feed_mm_min: float = 200.0
    plunge_mm_min: float = 50.0
    safe_mm: float = 10.0
    depth_mm: float = 0.0
    step_mm: float = 0.0
    conventional: bool = False


@frozen
class Setting:
    """A number of ``Machining``: its field, what it is called, unit, range, and what 0 stands for, where it stands for something."""

    name: str
    label: str
    unit: str
    low: float
    high: float
    help: str
    zero: str = ""


MACHINING = (
    Setting("feed_mm_min", "Feed", "mm/min", 0.1, 1e5, "along the path"),
    Setting("plunge_mm_min", "Plunge", "mm/min", 0.1, 1e5, "feed on the way down"),
    Setting("safe_mm", "Safe height", "mm", 0.1, 1e4, "of rapid moves above the face of the blank"),
    Setting("depth_mm", "Depth", "mm", 0.0, 1e4, "below the face of the blank", "the cam's thickness, or 10 mm"),
    Setting("step_mm", "Depth of a pass", "mm", 0.0, 1e4, "at most", "all in one pass"),
)


@frozen
class Request:
    """One curve.

    sampling   row of ``SAMPLINGS``, and its value: how many points, or [mm]
    fit        row of ``FITS``: what runs from point to point
    flank      name of one of the cam's flanks
    cutter_mm  radius of a cutter or grinding wheel, the path of whose centre is wanted; 0 where the profile is
    machining  of a path that a machine is to follow
    """

    sampling: str
    value: float
    fit: str
    flank: str = "inner"
    cutter_mm: float = 0.0
    machining: Machining = Machining()


__all__ = ["ALL_FLANKS", "MACHINING", "Machining", "Request", "Setting"]
