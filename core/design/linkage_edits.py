"""Edits of a linkage that ask something of their neighbours."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design.edits import with_law, with_rise, with_span, with_stroke
from core.design.linkage import LinkageDesign
from core.design.linkage_paths import linkage_put
from core.design.parts import Motion

MOTION_EDITS: Mapping[str, Callable[[Motion, int, Any], Motion]] = MappingProxyType(
    {
        r"motion\.segments\[(\d+)\]\.span_deg": with_span,
        r"motion\.segments\[(\d+)\]\.rise(?:_mm|_deg)?": with_rise,
        r"motion\.segments\[(\d+)\]\.law": with_law,
        r"motion\.stroke(?:_mm|_deg)?()": lambda motion, _, value: with_stroke(motion, value),
    }
)
"""Paths of a motion (as patterns) that ask something of their neighbours."""


def linkage_edited(design: LinkageDesign, path: str, value: Any) -> LinkageDesign:
    """The design with the value at a path changed and what goes with it. It may have faults: ask ``faults``."""
    for pattern, change in MOTION_EDITS.items():
        match = re.fullmatch(pattern, path)
        if match and design.motion is not None:
            return replace(design, motion=change(design.motion, int(match[1] or 0), value))
    return linkage_put(design, path, value)
