"""Edits of a linkage that ask something of their neighbours."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from core.design.edits import motion_edited
from core.design.linkage import LinkageDesign
from core.design.linkage_paths import linkage_put


def linkage_edited(design: LinkageDesign, path: str, value: Any) -> LinkageDesign:
    """The design with the value at a path changed and what goes with it. It may have faults: ask ``faults``."""
    motion = motion_edited(design.motion, path, value)
    return linkage_put(design, path, value) if motion is None else replace(design, motion=motion)
