"""Numbers for reading, in labels, tables, plots, sentences and reports; files have all digits and none of these signs.

A result has four significant digits, a value beside its limit five, and two values that are compared as many as tell them
apart, six at most. Five digits before the point and more are in groups of three. Numbers from 1e-4 to 1e9 have no exponent.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

RESULT_DIGITS, COMPARED_DIGITS, MOST_DIGITS = 4, 5, 6
MINUS, NARROW_SPACE = "\u2212", "\u202f"
LEAST_GROUPED = 5  # digits before the point
_SMALLEST, _LARGEST = 1e-4, 1e9  # without an exponent
_PLAIN_NUMBER = re.compile(r"(?<![\w/\\-])(?<!\w\.)-?\d+(?:\.\d+)?(?:e[-+]\d+)?(?![\w/\\]|\.\w|-\d)")
_PLAIN_FROM, _PLAIN_TO = 1e-7, 1e15  # of an input


def result_text(value: float | None, digits: int = RESULT_DIGITS, padded: bool = False) -> str:
    """Number rounded to significant digits; ``padded`` keeps zeros at its end, so that a column has equal digits."""
    if value is None or not math.isfinite(value):
        return "none" if value is None or value != value else _with_minus("∞", value)
    if value == 0.0:
        return "0"
    mantissa, _, power = f"{abs(value):.{digits - 1}e}".partition("e")
    if not _SMALLEST <= (rounded := float(f"{mantissa}e{power}")) <= _LARGEST:
        text = f"{_trimmed(mantissa, padded)}e{int(power)}".replace("-", MINUS)
    else:
        text = _grouped(_trimmed(f"{rounded:.{max(0, digits - 1 - int(power))}f}", padded))
    return _with_minus(text, value)


def rounded_up(value: float, digits: int) -> float:
    """Size rounded up to so many digits, so that it is large enough."""
    return _rounded(value, digits, 1.0)


def rounded_down(value: float, digits: int) -> float:
    """Size rounded down to so many digits, so that it is small enough."""
    return _rounded(value, digits, -1.0)


def _rounded(value: float, digits: int, side: float) -> float:
    near = float(f"{value:.{digits}g}")
    if side * near >= side * value:
        return near
    return float(f"{near + side * 10.0 ** (math.floor(math.log10(value)) + 1 - digits):.{digits}g}")


def fixed_text(value: float, decimals: int) -> str:
    """Number with fixed decimals, such as a tick or the angle of a playing machine; never minus zero."""
    text = f"{abs(value):.{max(0, decimals)}f}"
    return _with_minus(_grouped(text), value if text.strip("0.") else 0.0)


def typed_text(text: str) -> str:
    """Number as it was typed, with the signs of numbers for reading: ``-20000`` gives ``−20 000``."""
    number = text.removeprefix("-").replace("e-", f"e{MINUS}")
    return f"{MINUS if text.startswith('-') else ''}{_grouped(number)}"


def typeset(sentence: str) -> str:
    """Sentence with the plain numbers in it, such as ``-20000``, for reading; numbers in paths and names stay."""
    return _PLAIN_NUMBER.sub(lambda match: _typeset_number(match[0]), sentence.replace("+-", "±"))


def _typeset_number(text: str) -> str:
    return input_text(float(text)) if "e" in text else typed_text(text)


def count_text(count: int) -> str:
    """Whole number with all its digits."""
    return typed_text(str(count))


def distinct_texts(values: Sequence[float], digits: int = RESULT_DIGITS) -> list[str]:
    """Numbers with so many digits, or with more, six at most, where different ones would have equal texts."""
    most = digits_apart(values, digits)
    return [result_text(value, most) for value in values]


def digits_apart(values: Sequence[float], digits: int = RESULT_DIGITS) -> int:
    """Number of digits, at least so many and six at most, with which different numbers have different texts."""
    alike = len({result_text(value, digits) for value in values}) < len(set(values))
    return digits_apart(values, digits + 1) if alike and digits < MOST_DIGITS else digits


def compared_texts(values: Sequence[float]) -> list[str]:
    """A value and its limits in a sentence; *just above* or *just below* a limit from which six digits do not tell it apart."""
    texts = distinct_texts(values, COMPARED_DIGITS)
    for limit, text in zip(values[1:], texts[1:], strict=False):
        if text == texts[0] and limit != values[0]:
            texts[0] = f"just {'above' if values[0] > limit else 'below'} {text}"
    return texts


def input_text(value: float) -> str:
    """An input with all its digits."""
    return typed_text(shortest(value))


def signed_text(value: float, digits: int = RESULT_DIGITS) -> str:
    """Difference with its sign."""
    return f"{'+' if value > 0.0 else ''}{result_text(value, digits)}"


def shortest(value: float) -> str:
    """The shortest text of files that reads back to the same number, without an exponent where that is not longer."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value + 0.0:g}"
    text = repr(float(value))
    if "e" in text and _PLAIN_FROM <= abs(value) < _PLAIN_TO:
        from decimal import Decimal  # slow to import, and few numbers need it

        text = f"{Decimal(text):f}"
    return text.removesuffix(".0")


def _trimmed(text: str, padded: bool) -> str:
    return text if padded or "." not in text else text.rstrip("0").rstrip(".")


def _grouped(text: str) -> str:
    whole, point, decimals = text.partition(".")
    if len(whole) >= LEAST_GROUPED and whole.isdecimal():
        whole = f"{int(whole):,}".replace(",", NARROW_SPACE)
    return f"{whole}{point}{decimals}"


def _with_minus(text: str, value: float) -> str:
    return f"{MINUS}{text}" if value < 0.0 else text
