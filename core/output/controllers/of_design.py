"""The slave of a design, by the angle of its machine."""

from __future__ import annotations

from core.design import Design, only
from core.errors import KindynaError
from core.output.channels import channels
from core.output.controllers.request import Request
from core.output.controllers.slave import MOTION, Placing, Slave, positions, slave
from core.project import number_of
from core.study import Study


def slave_of(design: Design, drive: str, request: Request) -> tuple[Slave, str, float]:
    """What the slave does, what its table is called, and the speed of its master [rpm].

    Of a shaft with several drives the master is the shaft, one for all of them: each begins at its phase. Raises KindynaError.
    """
    number = number_of(design, drive)
    single = only(design, number)
    if request.segment is not None and request.shift_deg:
        raise KindynaError("--shift: a segment alone begins where it begins; allowed: --shift, or --segment")
    shift = request.shift_deg + design.drives[number].phase_deg
    placed = slave(Study(single), request.of, Placing(shift, request.reverse), request.segment)
    return placed, single.name, single.speed_rpm


def slaves_of(design: Design, drive: str) -> dict[str, str]:
    """What the slave may be -> in words: the motion, and every position of the linkage."""
    single = only(design, number_of(design, drive))
    moves = {MOTION: "the motion"} if single.drive.motion is not None else {}
    labels = {row.slug: row.label for row in channels(single, ("motion", "linkage"))}
    return moves | {name: labels[name] for name in positions(single) if name not in OF_MOTION}


OF_MOTION = ("displacement_mm", "displacement_deg")
"""The same as the motion."""


__all__ = ["slave_of", "slaves_of"]
