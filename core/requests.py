"""Requests of commands: dataclasses whose fields have a label, range, help and default, as those of designs.

The options of the command line are built from these fields here, the form of the dialog in the window.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import Field, field, fields, is_dataclass
from typing import Any, TypeVar

from core.design.fields import NOTHING, Info, info_of, unit_of
from core.errors import KindynaError
from core.frozen import frozen
from core.units import Unit, split_unit

Kind = TypeVar("Kind")

_KEY = "kindyna-option"


@frozen
class OptionInfo:
    """The command-line option and the form entry of a field, in addition to its ``Info``.

    Attributes
    ----------
    option : on the command line: ``--cutter``; a word in capitals is a positional argument; empty: named after the field;
        None: the field is on the form only
    help : of a field without ``Info``, and where the command line says more than the form
    default_text : the default in words; empty: the default as it is
    words : word of a choice -> its label on the form; empty: as it is spelled
    one_of : name of a group of exclusive fields, and the label of this choice on the form
    how : further keyword arguments of ``add_argument``
    """

    option: str | None = ""
    help: str = ""
    default_text: str = ""
    words: Mapping[str, str] = field(default_factory=dict)
    one_of: tuple[str, str] = ("", "")
    how: Mapping[str, Any] = field(default_factory=dict)

    @property
    def is_positional(self) -> bool:
        """Whether the option is a positional argument."""
        return bool(self.option) and not str(self.option).startswith("-")


def option(
    known: Any,
    option: str | None = "",
    *,
    help: str = "",
    default_text: str = "",
    words: Mapping[str, str] | None = None,
    one_of: tuple[str, str] = ("", ""),
    **how: Any,
) -> Any:
    """Add an option to a field that ``number``, ``choice`` or ``flag`` of ``core.design.fields`` built."""
    row = OptionInfo(option, help, default_text, words or {}, one_of, how)
    return field(default=known.default, metadata={**known.metadata, _KEY: row})


def text_option(
    help: str, option_word: str | None = "", *, default: Any = NOTHING, default_text: str = "", **how: Any
) -> Any:
    """Field that is text on the command line, converted by ``type``: a file, a pair, a list of them."""
    return option(field(default=default), option_word, help=help, default_text=default_text, **how)


def option_info(part: Field[Any]) -> OptionInfo:
    """Option of a field; the default where it states none."""
    return part.metadata.get(_KEY, OptionInfo())


def request_fields(kind: Any) -> Iterator[Field[Any]]:
    """Fields of a request that have an ``Info`` or an option, with those of nested requests in their place."""
    for part in fields(kind):
        if is_dataclass(part.default):
            yield from request_fields(part.default)
        elif info_of(part) is not None or _KEY in part.metadata:
            yield part


def field_info(kind: Any, name: str) -> Info:
    """Label, range and help of a request's field."""
    info = next(info_of(part) for part in request_fields(kind) if part.name == name)
    assert info is not None, f"{name} is text, or a file"
    return info


def build_request(kind: type[Kind], values: Mapping[str, Any]) -> Kind:
    """Request from values by field name, which may include fields of nested requests; defaults elsewhere."""
    arguments: dict[str, Any] = {}
    request: Any = kind
    for part in fields(request):
        if is_dataclass(part.default):
            arguments[part.name] = build_request(type(part.default), values)
        elif part.name in values:
            value = values[part.name]
            arguments[part.name] = tuple(value) if isinstance(value, list) else value
    return kind(**arguments)


def require_in_range(request: Any) -> None:
    """Check every number and word of a request.

    Raises
    ------
    KindynaError
        For a value outside of its range.
    """
    for part in fields(request):
        value, info = getattr(request, part.name), info_of(part)
        if info is not None and not info.admits(value):
            raise KindynaError(f"{info.in_sentence} = {value}: {info.problem}; allowed: {info.allowed(unit_of(part))}")


# -- the command line -----------------------------------------------------------------------------------------


def add_options(parser: argparse.ArgumentParser, kind: Any) -> None:
    """Add the options of a request, in the order of its fields."""
    groups: dict[str, Any] = {"": parser}
    for part in request_fields(kind):
        how = option_info(part)
        if how.option is not None:
            group, _ = how.one_of
            if group not in groups:
                groups[group] = parser.add_mutually_exclusive_group()
            _add_option(groups[group], part, how)


_CONTINUES = frozenset({"at", "between", "from", "if", "in", "of", "per", "where"})
"""First words of a help that continues the label of its field."""


def _add_option(parser: Any, part: Field[Any], how: OptionInfo) -> None:
    info = info_of(part) or Info("")
    has_default = part.default is not NOTHING
    words: dict[str, Any] = {"default": part.default if has_default else None}
    default = how.default_text or (_default_text(part.default) if has_default else "")
    text = how.help or info.help
    first = text.partition(" ")[0]
    if info.label and first in _CONTINUES and not info.flag:  # a form shows the label next to the help
        text = f"{info.in_sentence}{'' if first in ('of', 'per') else ','} {text}"
    if info.flag:
        words["action"] = "store_false" if part.default else "store_true"
    elif info.choices:
        words["choices"] = info.choices
    elif info.label:
        unit = unit_of(part)
        words |= {"type": number_reader(info, unit), "metavar": _metavar(info, unit)}
    words["help"] = (f"{text} ({default})" if default and not info.flag else text).replace("%", "%%")
    words |= how.how
    if words.get("action") == "append":
        words["default"] = []
    if how.is_positional:
        parser.add_argument(part.name, **words | {"metavar": how.option})
    else:
        parser.add_argument(option_word(part, how), dest=part.name, required=not has_default, **words)


def option_word(part: Field[Any], how: OptionInfo) -> str:
    """Option of a field on the command line: ``--cutter``."""
    return how.option or "--" + split_unit(part.name)[0].replace("_", "-")


def command_words(kind: Any, values: Mapping[str, Any]) -> list[str]:
    """Words of the command line that give these values, by field name: positional arguments, then values that differ from defaults."""
    positional: list[str] = []
    words: list[str] = []
    for part in request_fields(kind):
        how, info = option_info(part), info_of(part) or Info("")
        value = values.get(part.name, part.default)
        if how.option is None or value is NOTHING or value is None:
            continue
        texts = [str(item) for item in (value if isinstance(value, tuple | list) else (value,))]
        if how.is_positional:
            positional += texts
        elif how.how.get("action") == "append":
            words += [word for text in texts for word in (option_word(part, how), text)]
        elif value != part.default:
            words += [option_word(part, how), *(() if info.flag or "action" in how.how else texts)]
    return positional + words


def number_reader(info: Info, unit: Unit) -> Callable[[str], float]:
    """Function for ``type`` of ``add_argument`` that reads a number in a field's range; its error states the allowed range."""

    def read(text: str) -> float:
        try:
            value: float = float(text)
        except ValueError:
            value = math.nan
        if info.whole and value == math.floor(value if math.isfinite(value) else 0.5):
            value = int(value)
        if not info.admits(value):
            point = " (with a decimal point, no comma)" if "," in text else ""
            raise argparse.ArgumentTypeError(f"{text!r}: {info.in_sentence}; allowed: {info.allowed(unit)}{point}")
        return value

    return read


def _metavar(info: Info, unit: Unit) -> str:
    return "N" if info.whole else "DEG" if unit.symbol == "°" else unit.symbol.upper() or "X"


def _default_text(default: Any) -> str:
    """A default in the help; empty for None, a tuple or an empty text."""
    if isinstance(default, tuple) or not default:
        return ""
    return f"{default:g}" if isinstance(default, int | float) else str(default)


__all__ = [
    "OptionInfo",
    "add_options",
    "build_request",
    "command_words",
    "field_info",
    "number_reader",
    "option",
    "option_info",
    "option_word",
    "request_fields",
    "require_in_range",
    "text_option",
]
