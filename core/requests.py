"""What a command asks for, said once: the fields of a dataclass with label, range, help and default, as those of designs are. The
options of the command line follow from them here, the form of the dialog in the window."""

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

_KEY = "kindyna-asked"


@frozen
class Asked:
    """How a field is asked for, beside what its ``Info`` says.

    option  on the command line: ``--cutter``; a word of capitals is a place in the line instead; empty: after the field's name;
            None: it is asked for in the window only
    help    of a field without ``Info``, and where the command line says more than the form
    usual   what stands where nothing is given, as text; empty: the default as it is
    words   word of a choice -> what the form calls it; empty: as it is spelled
    one_of  name of the group of which one field is given at most, and what the form calls the choice of this one
    how     what else ``add_argument`` of argparse takes
    """

    option: str | None = ""
    help: str = ""
    usual: str = ""
    words: Mapping[str, str] = field(default_factory=dict)
    one_of: tuple[str, str] = ("", "")
    how: Mapping[str, Any] = field(default_factory=dict)


def asked(
    known: Any,
    option: str | None = "",
    *,
    help: str = "",
    usual: str = "",
    words: Mapping[str, str] | None = None,
    one_of: tuple[str, str] = ("", ""),
    **how: Any,
) -> Any:
    """A field as ``number``, ``choice`` or ``flag`` of ``core.design.fields`` makes it, with how it is asked for."""
    row = Asked(option, help, usual, words or {}, one_of, how)
    return field(default=known.default, metadata={**known.metadata, _KEY: row})


def typed(help: str, option: str | None = "", *, default: Any = NOTHING, usual: str = "", **how: Any) -> Any:
    """A field that is text on the command line, and what ``type`` makes of it: a file, a pair, a list of them."""
    return asked(field(default=default), option, help=help, usual=usual, **how)


def asked_of(each: Field[Any]) -> Asked:
    """How a field is asked for; the default where it states nothing."""
    return each.metadata.get(_KEY, Asked())


def questions(kind: Any) -> Iterator[Field[Any]]:
    """The fields that are asked for, those of parts in their place. A field of neither metadata is not asked for."""
    for each in fields(kind):
        if is_dataclass(each.default):
            yield from questions(each.default)
        elif info_of(each) is not None or _KEY in each.metadata:
            yield each


def known(kind: Any, name: str) -> Info:
    """What is known of a request's field."""
    info = next(info_of(each) for each in questions(kind) if each.name == name)
    assert info is not None, f"{name} is text, or a file"
    return info


def filled(kind: type[Kind], values: Mapping[str, Any]) -> Kind:
    """The request with these values by the names of fields, those of its parts among them; defaults elsewhere."""
    made: dict[str, Any] = {}
    own: Any = kind
    for each in fields(own):
        if is_dataclass(each.default):
            made[each.name] = filled(type(each.default), values)
        elif each.name in values:
            value = values[each.name]
            made[each.name] = tuple(value) if isinstance(value, list) else value
    return kind(**made)


def require(request: Any) -> None:
    """Raises KindynaError for a number or word of a request that is outside its range."""
    for each in fields(request):
        value, info = getattr(request, each.name), info_of(each)
        if info is not None and not info.admits(value):
            raise KindynaError(f"{info.in_sentence} = {value}: {info.problem}; allowed: {info.allowed(unit_of(each))}")


# -- the command line -------------------------------------------------------------------------------------


def add_options(parser: argparse.ArgumentParser, kind: Any) -> None:
    """The options of a request, in the order of its fields."""
    groups: dict[str, Any] = {"": parser}
    for each in questions(kind):
        how = asked_of(each)
        if how.option is not None:
            group, _ = how.one_of
            if group not in groups:
                groups[group] = parser.add_mutually_exclusive_group()
            _add(groups[group], each, how)


def _add(parser: Any, each: Field[Any], how: Asked) -> None:
    info = info_of(each) or Info("")
    there = each.default is not NOTHING
    words: dict[str, Any] = {"default": each.default if there else None}
    usual = how.usual or (_text(each.default) if there else "")
    text = how.help or info.help
    if info.flag:
        words["action"] = "store_false" if each.default else "store_true"
    elif info.choices:
        words["choices"] = info.choices
    elif info.label:
        unit = unit_of(each)
        words |= {"type": number_reader(info, unit), "metavar": _metavar(info, unit)}
    words["help"] = (f"{text} ({usual})" if usual and not info.flag else text).replace("%", "%%")
    words |= how.how
    if words.get("action") == "append":
        words["default"] = []
    if how.option and not how.option.startswith("-"):
        parser.add_argument(each.name, **words | {"metavar": how.option})
    else:
        parser.add_argument(_spelled(each, how), dest=each.name, required=not there, **words)


def _spelled(each: Field[Any], how: Asked) -> str:
    """The option of a field."""
    return how.option or "--" + split_unit(each.name)[0].replace("_", "-")


def options(kind: Any, values: Mapping[str, Any]) -> list[str]:
    """The words of the command line that ask for these values, by the names of fields; places in the line first, then what is not as
    usual."""
    places: list[str] = []
    words: list[str] = []
    for each in questions(kind):
        how, info = asked_of(each), info_of(each) or Info("")
        value = values.get(each.name, each.default)
        if how.option is None or value is NOTHING or value is None:
            continue
        texts = [str(one) for one in (value if isinstance(value, tuple | list) else (value,))]
        if how.option and not how.option.startswith("-"):
            places += texts
        elif how.how.get("action") == "append":
            words += [word for text in texts for word in (_spelled(each, how), text)]
        elif value != each.default:
            words += [_spelled(each, how), *(() if info.flag or "action" in how.how else texts)]
    return places + words


def number_reader(info: Info, unit: Unit) -> Callable[[str], float]:
    """Reads a number of a field; where it is none, or outside its range, argparse says so in the words of a design's field."""

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


def _text(default: Any) -> str:
    """A default as the help shows it; '' of what is nothing."""
    if isinstance(default, tuple) or not default:
        return ""
    return f"{default:g}" if isinstance(default, int | float) else str(default)


__all__ = [
    "Asked",
    "add_options",
    "asked",
    "asked_of",
    "filled",
    "known",
    "number_reader",
    "options",
    "questions",
    "require",
    "typed",
]
