"""The lazy chain of stages over one design."""

from typing import TYPE_CHECKING, Any

from core.study.base import SAMPLES, Study
from core.study.linkage_quantities import quantity
from core.study.quantities import QUANTITIES, Quantity, quantities_of
from core.study.stages import clear_caches, evaluations
from core.study.study import CamStudy

if TYPE_CHECKING:
    from core.study.linkage import LinkageStudy

__all__ = [
    "QUANTITIES", "SAMPLES", "CamStudy", "LinkageStudy", "Quantity", "Study", "clear_caches", "evaluations", "quantities_of",
    "quantity",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Linkages are loaded by those who name them."""
    if name == "LinkageStudy":
        from core.study.linkage import LinkageStudy

        return LinkageStudy
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
