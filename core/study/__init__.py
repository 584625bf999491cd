"""The lazy chain of stages over one design."""

from core.study.quantities import QUANTITIES, Quantity, names_of, quantity
from core.study.shaft_study import BALANCER, ShaftStudy
from core.study.speeds import at_speeds
from core.study.stages import clear_caches, evaluations
from core.study.study import SAMPLES, STAGES, Study

__all__ = [
    "BALANCER", "QUANTITIES", "SAMPLES", "STAGES", "Quantity", "ShaftStudy", "Study", "at_speeds", "clear_caches", "evaluations",
    "names_of", "quantity",
]  # fmt: skip
