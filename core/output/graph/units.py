"""Units of the columns of a graph by the columns' names."""

from __future__ import annotations

import re
from functools import lru_cache

from core.measured.units import LONGEST, unit_in
from core.units import split_unit, unit_called

_AT_END = re.compile(r"[\[(]([^\[(\])]*)[\])]$")


@lru_cache(maxsize=64)
def unit_of_column(name: str) -> str:
    """The unit that a column's name ends in: as in our own tables (``force_n``), in brackets, behind a comma, or as measured
    tables have it; what stands in brackets and is no known unit is taken as it is; empty where there is none."""
    name = name.strip()[-LONGEST:]
    inside = _AT_END.search(name)
    if inside:
        return unit_called(inside[1]) or inside[1].strip()
    own = split_unit(name)[1].symbol
    if own:
        return own
    tail = re.split(r",\s*|_", name)
    return unit_called(unit_in(name)) or (unit_called(tail[-1]) if len(tail) > 1 else "")


def without_unit(name: str) -> str:
    """A column's name in words: ``contact_force_n`` -> ``contact force``."""
    text = _AT_END.sub("", name.strip()).rstrip()
    short, unit = split_unit(text)
    if not unit.symbol and unit_of_column(text):
        short = re.sub(r"(_|,\s*+)[^_,]*+$", "", text)
        words = short.rsplit(None, 1)  # "Hub mm", "Hub in mm"
        if short == text and len(words) == 2 and unit_called(words[1]):
            short = re.sub(r"\s+in$", "", words[0][-LONGEST:])
    return short.replace("_", " ").strip()


__all__ = ["unit_of_column", "without_unit"]
