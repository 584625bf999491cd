"""Texts with places: ``{name}`` of the listed names and nothing else, ``{{`` and ``}}`` for braces."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache

_PART = re.compile(r"(\{\{|\}\}|[^{}]+)|\{([A-Za-z_]+)\}|[{}]")


@lru_cache(maxsize=512)
def places(template: str) -> tuple[tuple[str, str], ...]:
    """The template in parts: a text before each place, and the place's name; empty behind the last. Raises ValueError for any other
    brace."""
    parts, text = list[tuple[str, str]](), ""
    for match in _PART.finditer(template):
        literal, name = match.groups()
        if name is not None:
            parts.append((text, name))
            text = ""
        elif literal is None:
            raise ValueError(f"{template[match.start() : match.start() + 20]!r} is no place")
        else:
            text += literal[0] if literal in ("{{", "}}") else literal
    return (*parts, (text, ""))


def names(template: str) -> frozenset[str]:
    """The names of its places. Raises ValueError as ``places``."""
    return frozenset(name for _, name in places(template) if name)


def filled(template: str, values: Mapping[str, str]) -> str:
    """The text with a value at each place; ``...`` where there is none."""
    return "".join(text + (values.get(name, "...") if name else "") for text, name in places(template))


def rows(template: str, values: Mapping[str, str], columns: Mapping[str, list[str]], count: int) -> Iterator[str]:
    """The text so many times, with the values of each row at the places of columns."""
    parts: list[list[str]] = []
    for text, name in places(template):
        parts += [[text] * count] if text else []
        parts += [columns[name] if name in columns else [values.get(name, "...")] * count] if name else []
    return map("".join, zip(*parts, strict=True))


__all__ = ["filled", "names", "places", "rows"]
