"""The lazy chain of stages over one design."""

from core.study.quantities import QUANTITIES, Quantity, quantities_of
from core.study.stages import clear_caches, evaluations
from core.study.study import SAMPLES, Study

__all__ = ["QUANTITIES", "SAMPLES", "Quantity", "Study", "clear_caches", "evaluations", "quantities_of"]
