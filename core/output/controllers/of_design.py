"""The slave of a design, by the angle of its machine."""

from __future__ import annotations

from core.design import Design, only
from core.output.controllers.request import Request
from core.output.controllers.slave import Placing, Slave, slave
from core.project import number_of
from core.study import Study


def slave_of(design: Design, drive: str, request: Request) -> tuple[Slave, str, float]:
    """What the slave does, what its table is called, and the speed of its master [rpm].

    Of a shaft with several drives the master is the shaft, one for all of them: each begins at its phase. Raises KindynaError.
    """
    number = number_of(design, drive)
    single = only(design, number)
    shift = request.shift_deg + design.drives[number].phase_deg
    return slave(Study(single), request.of, Placing(shift, request.reverse)), single.name, single.speed_rpm


__all__ = ["slave_of"]
