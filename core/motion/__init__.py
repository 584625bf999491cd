"""Motion: segments compiled to one table of pieces; what the output does at every cam angle, with three derivatives."""

from core.motion.program import (
    EPS,
    SNAP,
    TURN,
    Angles,
    Join,
    MotionState,
    Program,
    degrees,
    findings,
    going_on,
    program,
)

__all__ = [
    "EPS",
    "SNAP",
    "TURN",
    "Angles",
    "Join",
    "MotionState",
    "Program",
    "degrees",
    "findings",
    "going_on",
    "program",
]
