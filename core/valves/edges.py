"""Edges of a lobe on the crank: where it passes the lifts of its typed rows, and the rows that move with an edge."""

from __future__ import annotations

from core.design import Design
from core.design.engine import CRANK_PER_CAM, Lobe, LobeClosing
from core.design.lobe import TypedValue, typed_values
from core.frozen import frozen
from core.laws.lobe import HEIGHT
from core.valves.timing import ValveTiming, valve_timings


@frozen
class LobeEdge:
    """An edge of a lobe at the lift of a typed row.

    Attributes
    ----------
    path : of the row's angle, in the drive
    at_mm : lobe lift [mm]
    factor : change of the row per change of the edge towards later angles, 2 or 1, negative for the opening edge
    crank_deg : crank angle from TDC of overlap of the cylinder [deg]
    """

    path: str
    at_mm: float
    factor: float
    crank_deg: float

    @property
    def is_duration(self) -> bool:
        """Whether the row is a duration; else it is the angle from one side to the nose."""
        return abs(self.factor) > 1.0


def lobe_edges(timing: ValveTiming) -> tuple[LobeEdge, ...]:
    """Edges at all typed rows of a lobe, those of the opening side first; empty for a motion of segments."""
    lobe = timing.motion.lobe
    if lobe is None:
        return ()
    edges = []
    for values, sense in ((_rows(lobe), -1.0), (_closing_rows(lobe), 1.0)):
        for value in values:
            lift = value.condition.height
            ends = timing.passes(lift)
            if ends is not None:
                factor = sense * value.factor / CRANK_PER_CAM
                crank = ends[0] if sense < 0.0 else ends[1]
                edges.append(LobeEdge(f"motion.lobe.{value.path}.crank_deg", lift, factor, crank))
    return tuple(edges)


def machine_edges(design: Design) -> dict[int, tuple[tuple[LobeEdge, float], ...]]:
    """Edges of the lobes of all valves with their machine angles 0 ... 360 [deg], by the numbers of their drives."""
    return {
        timing.number: tuple(
            (edge, (edge.crank_deg + timing.valve.cylinder_deg) / CRANK_PER_CAM % 360.0) for edge in lobe_edges(timing)
        )
        for timing in (valve_timings(design) if design.has_valves else ())
    }


def _rows(part: Lobe | LobeClosing, prefix: str = "") -> list[TypedValue]:
    return [value for value in typed_values(part, prefix) if value.condition.kind == HEIGHT]


def _closing_rows(lobe: Lobe) -> list[TypedValue]:
    """Rows that determine the closing side: its own, else those of the opening side, of which another ramp keeps the highest."""
    if lobe.closing is None or lobe.is_symmetric:
        return _rows(lobe)
    return _rows(lobe.closing, "closing.") or _rows(lobe)[-1:]
