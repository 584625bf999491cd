"""Units of the columns of a graph by the columns' names."""

from __future__ import annotations

import re

from core.measured.units import unit_in
from core.units import split_unit, unit_called


def unit_of_column(name: str) -> str:
    """The unit that a column's name ends in: as in our own tables (``force_n``), in brackets, behind a comma, or as measured
    tables have it; what stands in brackets and is no known unit is taken as it is; empty where there is none."""
    inside = re.findall(r"[\[(]([^\])]*)[\])]\s*$", name)
    if inside:
        return unit_called(inside[-1]) or inside[-1].strip()
    own = split_unit(name.strip())[1].symbol
    if own:
        return own
    tail = re.split(r",\s*|_", name.strip())
    return unit_called(unit_in(name)) or (unit_called(tail[-1]) if len(tail) > 1 else "")


def without_unit(name: str) -> str:
    """A column's name in words: ``contact_force_n`` -> ``contact force``."""
    text = re.sub(r"\s*[\[(][^\])]*[\])]\s*$", "", name.strip())
    short, unit = split_unit(text)
    if not unit.symbol and unit_of_column(text):
        short = re.sub(r"(_|,\s*)[^_,]*$", "", text)
        words = re.fullmatch(r"(.*\S)\s+(\S+)", short)  # "Hub mm", "Hub in mm"
        short = re.sub(r"\s+in$", "", words[1]) if short == text and words and unit_called(words[2]) else short
    return short.replace("_", " ").strip()


__all__ = ["unit_of_column", "without_unit"]
