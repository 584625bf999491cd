"""Valve trains on the crank: events, overlap, and the figures of a lobe. Crank degrees count from TDC of overlap."""

from core.valves.edges import LobeEdge, lobe_edges
from core.valves.figures import crank_text, lift_table, valve_data
from core.valves.pairs import ValvePair, valve_pairs
from core.valves.timing import LIFTS, Event, ValveTiming, require_opening, valve_timings

__all__ = [
    "LIFTS",
    "Event",
    "LobeEdge",
    "ValvePair",
    "ValveTiming",
    "crank_text",
    "lift_table",
    "lobe_edges",
    "require_opening",
    "valve_data",
    "valve_pairs",
    "valve_timings",
]
