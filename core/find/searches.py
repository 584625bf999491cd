"""All that can be sought, in one drive or in a whole shaft."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from core.design import Design
from core.errors import KindynaError
from core.find import solution
from core.find.holding import find_holding
from core.find.on_shaft import ON_SHAFT, find_on_shaft
from core.find.solution import Solution
from core.find.wanted import WANTED

SEARCHES: Mapping[str, str] = MappingProxyType(
    {what: row.help for what, row in WANTED.items()} | {what: row.help for what, row in ON_SHAFT.items()}
)
"""What is sought -> in words."""


def find(design: Design, what: str, stated: Mapping[str, float], *, aim: str = "peak", **how: Any) -> Solution:
    """The answer of a row of ``WANTED``, by ``find_holding`` or by ``solution.find`` with ``how`` it says, or of ``ON_SHAFT``. Raises
    KindynaError."""
    if what not in SEARCHES:
        raise KindynaError(f"find {what!r}: unknown; allowed: {' | '.join(SEARCHES)}")
    if what in ON_SHAFT:
        return find_on_shaft(design, what, stated, aim, how.get("alone", False))
    if WANTED[what].holding:
        return find_holding(design, what, stated, alone=how.get("alone", False))
    return solution.find(design, what, stated, **how)
