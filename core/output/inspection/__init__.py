"""The inspection of a cut cam: what a probe measures on the exact profile, and how far a measured table is from it."""

from core.output.inspection.comparison import ProfileComparison, compare, measured_lift
from core.output.inspection.files import facts, require_name, verdict_facts, write
from core.output.inspection.lift import Inspection, LiftTable, Probing, inspection, own_direction, own_probe, probing
from core.output.inspection.probe import PROBES
from core.output.inspection.request import Request

__all__ = [
    "PROBES", "Inspection", "LiftTable", "Probing", "ProfileComparison", "Request", "compare", "facts", "inspection",
    "measured_lift", "own_direction", "own_probe", "probing", "require_name", "verdict_facts", "write",
]  # fmt: skip
