"""How many of each thing a design may have: what takes any number is counted before anything else is done with it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

from core.errors import MISSING, Fault

MOST: Mapping[str, int] = MappingProxyType(
    {
        "motion.segments": 3600,
        "linkage.links": 100,
        "linkage.sliders": 100,
        "loads.masses": 100,
        "loads.forces": 1000,
    }
)
"""List -> its most entries."""
MOST_OF_LIST = 4000  # of any other list
MOST_KEYS = 500  # of any table


def count_fault(path: str, count: int) -> Fault | None:
    """What is wrong with a list of so many entries, None where it may have them; path as in the file."""
    name = path.rsplit(".", 1)[-1]
    most = MOST.get(re.sub(r"\[\d+\]", "", path), MOST_OF_LIST)
    return Fault(path, MISSING, f"{count} {name} are too many", f"at most {most}") if count > most else None
