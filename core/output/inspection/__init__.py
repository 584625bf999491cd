"""The inspection of a cut cam: what a probe measures on the exact profile, and how far a measured table is from it."""

from core.output.inspection.comparison import Comparison, compare, measured_lift
from core.output.inspection.files import facts, require_name, verdict_facts, write
from core.output.inspection.lift import Inspection, Probing, Table, inspection, own_direction, own_probe, probing
from core.output.inspection.probe import PROBES
from core.output.inspection.request import Request

__all__ = [
    "PROBES", "Comparison", "Inspection", "Probing", "Request", "Table",
    "compare", "facts", "inspection", "measured_lift", "own_direction", "own_probe", "probing", "require_name", "verdict_facts",
    "write",
]  # fmt: skip
