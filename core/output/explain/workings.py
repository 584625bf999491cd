"""How each quantity is worked out at one angle: its equation in letters that have a value there. One row a quantity, by room."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.output.explain import of_cam, of_forces, of_links, of_motion, of_servo
from core.output.explain.letters import Maker, Working
from core.study import Study

WORKINGS: Mapping[str, Maker] = MappingProxyType(
    {**of_motion.ROWS, **of_cam.ROWS, **of_forces.ROWS, **of_links.ROWS, **of_servo.ROWS}
)


def working_of(study: Study, shape: str, member: str) -> Working:
    """Of a quantity's row, for one member where it has any, of a study at one angle."""
    return WORKINGS[shape](study, member)


__all__ = ["working_of"]
