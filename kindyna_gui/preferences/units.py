"""Units and decimal sign in which the window shows and reads numbers, and the size of its letters. What is kept, computed and written
stays as files have it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from threading import current_thread, main_thread

from PySide6.QtCore import QObject, Signal

from core.output.lines import shortest
from core.units import Unit, unit_kind

DIGITS = 10  # of a number that is shown in another unit than it is kept in


class _Told(QObject):
    """changed: what is shown next is shown otherwise."""

    changed = Signal()


TOLD = _Told()
_units: dict[str, str] = {}
_comma = False
_letters = 1.0
_kept: ContextVar[bool] = ContextVar("kept", default=False)


def choose(units: Mapping[str, str], comma: bool) -> None:
    """Show quantities of these kinds in these units, and numbers with a decimal comma; a unit that a kind lacks is left out."""
    global _comma
    known = {kind: symbol for kind, symbol in units.items() if symbol in unit_kind(symbol).sizes}
    if (known, comma) != (_units, _comma):
        _units.clear()
        _units.update(known)
        _comma = comma
        TOLD.changed.emit()


def is_usual() -> bool:
    """Whether the window shows everything as files have it."""
    return not _units and not _comma and _letters == 1.0


@contextmanager
def as_kept() -> Iterator[None]:
    """Inside, everything is shown as files have it: what is written leaves the window."""
    before = _kept.set(True)
    try:
        yield
    finally:
        _kept.reset(before)


def follows() -> bool:
    """Whether the preferences count here: what is computed beside the window may be a file."""
    return not _kept.get() and current_thread() is main_thread()


def symbol_of(symbol: str) -> str:
    """The unit that values in this one are shown in."""
    return _units.get(unit_kind(symbol).name, symbol) if _units and symbol and follows() else symbol


def size_of(symbol: str) -> float:
    """How many of a unit one of those is that it is shown in."""
    shown = symbol_of(symbol)
    sizes = unit_kind(symbol).sizes
    return 1.0 if shown == symbol else (sizes[shown] / sizes[symbol]).factor


def choose_letters(size: float) -> bool:
    """Draw letters so many times as large as usual; whether that is another size than before."""
    global _letters
    before, _letters = _letters, size
    return size != before


def sized(pixels: float) -> float:
    """So many pixels at the usual size of letters, at that of the window: of letters, and of the room that is kept for them."""
    return pixels * _letters if _letters != 1.0 and follows() else pixels


def point() -> str:
    """The decimal sign."""
    return "," if _comma and follows() else "."


def typed(text: str) -> str:
    """A typed number with a decimal point."""
    return text.replace(",", ".") if _comma else text


def number_text(value: float, unit: Unit) -> str:
    """A number as it is shown and typed: every digit of it, or those that count of one in another unit."""
    size = size_of(unit.symbol)
    text = shortest(value) if size == 1.0 else shortest(float(f"{value / size:.{DIGITS}g}"))
    return text.replace(".", point())


_NUMBER = r"[-\u2212]?\d+(?:[\u202f\u2009]\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?"
_MEASURED = re.compile(rf"(?<![\w.])((?:{_NUMBER}\s?(?:\.\.\.|…|to)\s?)?{_NUMBER})\s?((?:1/)?[^\s\d,;:()]+)")


def in_units(text: str) -> str:
    """A sentence with the numbers in it, and their units, as they are shown: ``limit 30 mm`` -> ``limit 1.181 in``."""
    return _MEASURED.sub(_in_unit, text) if _units and follows() else text


def _in_unit(match: re.Match[str]) -> str:
    symbol = match[2].rstrip(".")
    shown, size = symbol_of(symbol), size_of(symbol)
    if shown == symbol:
        return match[0]
    numbers = re.sub(_NUMBER, lambda each: _scaled(each[0], size), match[1])
    return f"{numbers} {shown}{match[2][len(symbol) :]}"


def _scaled(text: str, size: float) -> str:
    plain = re.sub("[\u202f\u2009]", "", text).replace("\u2212", "-")
    figures = max(len(re.sub(r"\D", "", plain.partition("e")[0]).lstrip("0")), 4)
    scaled = shortest(float(f"{float(plain) / size:.{figures}g}"))
    return (scaled.replace("-", "\u2212") if "\u2212" in text else scaled).replace(".", point())


__all__ = [
    "DIGITS",
    "TOLD",
    "as_kept",
    "choose",
    "choose_letters",
    "follows",
    "in_units",
    "is_usual",
    "number_text",
    "point",
    "size_of",
    "sized",
    "symbol_of",
    "typed",
]
