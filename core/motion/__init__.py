"""Motion: segments compiled to one table of pieces; what the output does at every cam angle, with three derivatives."""

from core.motion.program import (
    EPS,
    SNAP,
    TURN,
    Angles,
    Join,
    MotionState,
    Program,
    at_turn,
    degrees,
    findings,
    going_on,
    program,
    steepest,
)

__all__ = [
    "EPS",
    "SNAP",
    "TURN",
    "Angles",
    "Join",
    "MotionState",
    "Program",
    "at_turn",
    "degrees",
    "findings",
    "going_on",
    "program",
    "steepest",
]
