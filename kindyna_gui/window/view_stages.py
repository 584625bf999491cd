"""Which stages of a study each view reads: one table, by the names of ``docks.VIEWS``.

What no view on screen reads is not computed. The plots and the graph read what the quantities they show need, which
is in ``core.study.QUANTITIES``; their stages are derived from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.study import STAGES

NONE: tuple[str, ...] = ()

STAGES_OF_VIEWS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "mechanism": ("linkage", "cam"),
        "mechanism with forces": ("linkage", "cam", "dynamics"),
        "mechanism with shaft": ("linkage", "cam", "stability"),
        "parameters": NONE,
        "motion": ("motion",),
        "laws": NONE,
        "drives": ("linkage", "dynamics"),
        "find": ("linkage", "cam"),
        "findings": STAGES,
        "certificate": STAGES,
        "timing": NONE,
        "contact": ("linkage", "cam", "dynamics"),
        "vibration": NONE,
        "flywheel": ("dynamics",),
        "shaft_torque": ("dynamics",),
        "shaft_figures": ("dynamics",),
        "against_speed": ("dynamics",),
        "stability": ("stability",),
        "centres": ("linkage",),
        "circle": ("linkage",),
        "polygon": ("linkage",),
        "polygon of forces": ("linkage", "cam", "dynamics"),
        "log": NONE,
        "player": NONE,
    }
)
