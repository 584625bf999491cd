"""The number that a typed text means: digits, simple arithmetic, and other units of the same kind."""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from types import MappingProxyType

from core.units import Unit, accepted_units
from kindyna_gui.preferences.units import symbol_of, typed

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d{1,3})?", re.ASCII)
_SIGNS = str.maketrans({"\u2212": "-", "×": "*", "÷": "/", "\u00a0": " "})
_LONGEST = 100  # characters of a calculation

_OPERATIONS: Mapping[type, Callable[[Fraction, Fraction], Fraction]] = MappingProxyType(
    {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}
)


def parsed(text: str, unit: Unit, *, kept: bool = False) -> float | None:
    """The number that a text means in the field's own unit; None where it is none.

    ``12.5``, ``12.5 mm``, ``3*12``, ``(86 + 2)/4``, ``1 in``, ``0.5 rad``: + - * / and parentheses are calculated exactly, as
    a reader would, and rounded once; a unit of the same kind may stand behind all. Without one the number counts in the unit that
    the field is shown in; kept: in its own.
    """
    rest, factor = _without_unit(typed(text).translate(_SIGNS).strip(), unit)
    if kept and rest == typed(text).translate(_SIGNS).strip():
        factor = Fraction(1)
    if _NUMBER.fullmatch(rest) and factor == 1:
        value = float(rest)
    else:
        exact = _calculated(rest)
        if exact is None:
            return None
        try:
            value = float(exact * factor)
        except OverflowError:
            return None
    return value + 0.0 if math.isfinite(value) else None


def _without_unit(text: str, unit: Unit) -> tuple[str, Fraction | float]:
    """The text before a unit, and how many of the field's own it is."""
    for symbol, factor in accepted_units(unit.symbol).items():
        rest = text.removesuffix(symbol)
        if rest != text and rest.strip() and not (rest[-1].isalpha() or rest[-1] in "/·^"):
            return rest.strip(), factor
    return text, accepted_units(unit.symbol).get(symbol_of(unit.symbol), Fraction(1))


def _calculated(text: str) -> Fraction | None:
    """The exact value of a calculation; None where it is none, or has none."""
    if len(text) > _LONGEST or re.search(r"[^-+*/().0-9eE\s]|\*\*|//", text):
        return None
    try:
        return _value(ast.parse(text.strip(), mode="eval").body, text.strip())
    except (SyntaxError, ValueError, ZeroDivisionError, RecursionError, MemoryError):
        return None


def _value(node: ast.AST, text: str) -> Fraction:
    match node:
        case ast.Constant(value=int() | float()):
            digits = ast.get_source_segment(text, node) or ""
            if not _NUMBER.fullmatch(digits):
                raise ValueError(digits)
            return Fraction(digits)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand, text)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _value(operand, text)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
            return _OPERATIONS[type(op)](_value(left, text), _value(right, text))
    raise ValueError(text)


__all__ = ["parsed"]
