"""All that can be sought, in one drive or in a whole shaft."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design import Design
from core.errors import KindynaError
from core.find import solution
from core.find.checked import Put, alone, uneven
from core.find.holding import find_holding
from core.find.offer import Stated
from core.find.on_shaft import ON_SHAFT, find_on_shaft, with_least_flywheel
from core.find.solution import Solution
from core.find.wanted import WANTED

SEARCHES: Mapping[str, str] = MappingProxyType(
    {what: row.help for what, row in WANTED.items()} | {what: row.help for what, row in ON_SHAFT.items()}
)
"""What is sought -> in words."""


def find(design: Design, what: str, stated: Stated, *, aim: str = "peak", machine: Put = alone, **how: Any) -> Solution:
    """The answer of a row of ``WANTED``, by ``find_holding`` or by ``solution.find`` with ``how`` it says, or of ``ON_SHAFT``; machine: the
    design -> the whole that it belongs to. Raises KindynaError."""
    if what not in SEARCHES:
        raise KindynaError(f"find {what!r}: unknown; allowed: {' | '.join(SEARCHES)}")
    if what in ON_SHAFT:
        found = find_on_shaft(design, what, stated, aim)
    elif WANTED[what].holding:
        found = find_holding(design, what, stated, machine)
    else:
        found = solution.find(design, what, stated, machine=machine, **how)
    return found if what == FLYWHEEL_GOAL else _with_flywheel(found, machine(design), machine(found.design))


FLYWHEEL_GOAL = "flywheel"


def _with_flywheel(found: Solution, before: Design, made: Design) -> Solution:
    """The machine with the answer; where the load of its shaft has grown so that the speed fluctuates more than it may, which it did not
    before, with the flywheel that this takes."""
    if found.serves and not found.besides and uneven(made) and not uneven(before):
        whole, wheel = with_least_flywheel(made)
        design = whole if made == found.design else found.design
        return replace(found, design=design, whole=whole, taken={**found.taken, **wheel})
    return replace(found, whole=made)
