"""Motion: segments compiled to one table of pieces; what the output does at every cam angle, with three derivatives."""

from core.motion.program import (
    EPS,
    SNAP,
    TURN,
    Angles,
    CompiledMotion,
    Join,
    MotionState,
    connected_segments,
    degrees,
    findings,
    largest_rate,
    motion_at,
    program,
)

__all__ = [
    "EPS",
    "SNAP",
    "TURN",
    "Angles",
    "CompiledMotion",
    "Join",
    "MotionState",
    "connected_segments",
    "degrees",
    "findings",
    "largest_rate",
    "motion_at",
    "program",
]
