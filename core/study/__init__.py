"""The lazy chain of stages over one design."""

from core.study.base import SAMPLES, Study
from core.study.linkage import LinkageStudy
from core.study.linkage_quantities import quantity
from core.study.quantities import QUANTITIES, Quantity, quantities_of
from core.study.stages import clear_caches, evaluations
from core.study.study import CamStudy

__all__ = [
    "QUANTITIES", "SAMPLES", "CamStudy", "LinkageStudy", "Quantity", "Study", "clear_caches", "evaluations", "quantities_of",
    "quantity",
]  # fmt: skip
