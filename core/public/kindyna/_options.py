"""Options of methods: those of the command of that name, without ``--``, ``_`` for ``-``, and ``as_`` for ``as``."""

from __future__ import annotations

import os
import re
from argparse import ArgumentTypeError
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import Field
from functools import wraps
from keyword import iskeyword
from typing import Any, ParamSpec, TypeVar

from core.design.fields import Info, info_of, unit_of
from core.errors import KindynaError
from core.project.reading_faults import did_you_mean
from core.requests import OptionInfo, build_request, option_info, option_word, request_fields
from kindyna._checks import number, text, unknown, whole

Request = TypeVar("Request")
Result = TypeVar("Result")
Parameters = ParamSpec("Parameters")
_OPTION = re.compile(r"(?<![\w-])--([a-z]+(?:-[a-z]+)*)")


def names_arguments(method: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Decorate a method of the library: errors name options as its arguments, without ``--``."""

    @wraps(method)
    def called(*args: Parameters.args, **kwargs: Parameters.kwargs) -> Result:
        try:
            return method(*args, **kwargs)
        except KindynaError as error:
            error.args = tuple(_OPTION.sub(_argument, part) if isinstance(part, str) else part for part in error.args)
            raise

    return called


def _argument(option: re.Match[str]) -> str:
    return _python_name(option[1])


def _python_name(option: str) -> str:
    name = option.replace("-", "_")
    return f"{name}_" if iskeyword(name) else name


def requested(kind: type[Request], given: Mapping[str, Any], *without: str, **fixed: Any) -> Request:
    """Return the request of a command.

    Parameters
    ----------
    kind : class of the arguments of the command
    given : mapping of str -> value
        Options of the method.
    *without : str
        Fields that are no options of the method.
    **fixed : value
        Further fields by their name.

    Raises
    ------
    KeyError
        There is no such option.
    TypeError, ValueError, KindynaError
        An option has a wrong value, or excludes another one.
    """
    rows = {name: (part, how) for name, part, how in _options(kind) if part.name not in (*without, *fixed)}
    values: dict[str, Any] = dict(fixed)
    groups: dict[str, str] = {}
    for name, value in given.items():
        if name not in rows:
            raise unknown("option", name, rows)
        part, how = rows[name]
        values[part.name] = _value(name, part, how, value)
        group, _ = how.one_of
        if group and value is not None and groups.setdefault(group, name) != name:
            raise ValueError(f"{groups[group]}, {name}: exclude each other; give one of them")
    return build_request(kind, values)


def _options(kind: Any) -> Iterator[tuple[str, Field[Any], OptionInfo]]:
    """Name of every option with its field."""
    for part in request_fields(kind):
        how = option_info(part)
        if how.option is not None and not how.is_positional:
            yield _python_name(option_word(part, how).lstrip("-")), part, how


def _value(name: str, part: Field[Any], how: OptionInfo, value: Any) -> Any:
    """Return the value of a field. Raises TypeError, ValueError, KindynaError."""
    info, words = info_of(part), how.how
    if value is None and part.default is None:
        return None
    if words.get("action") == "store_true" or (info is not None and info.flag):
        if not isinstance(value, bool):
            raise TypeError(f"{name} = {value!r}: True or False is needed, not {type(value).__name__}")
        return value != part.default
    if words.get("nargs") == "?" and value is True:
        return words["const"]
    if info is not None and info.choices:
        return _word(name, value, info.choices)
    if info is not None and info.label:
        return _number(name, part, info, value)
    if words.get("action") == "append":
        return tuple(_read(name, words, item) for item in _items(name, value))
    if words.get("nargs") == "+":
        items = tuple(_read(name, words, item) for item in _items(name, value))
        return tuple(_word(name, item, words["choices"]) for item in items) if "choices" in words else items
    return _read(name, words, value)


def _word(name: str, value: Any, words: Sequence[str]) -> str:
    if text(name, value) not in words:
        raise ValueError(f"{name} = {value!r}: unknown word{did_you_mean(value, words)}; allowed: {' | '.join(words)}")
    return str(value)


def _number(name: str, part: Field[Any], info: Info, value: Any) -> float:
    result = whole(name, value) if info.whole else number(name, value)
    if not info.admits(result):
        raise ValueError(f"{name} = {value!r}: {info.in_sentence}; allowed: {info.allowed(unit_of(part))}")
    return result


def _read(name: str, words: Mapping[str, Any], value: Any) -> Any:
    """Return a value that the command reads from text; numbers, lists and mappings are spelled as there."""
    spelled = _spelled(name, value)
    try:
        return words.get("type", str)(spelled)
    except (ArgumentTypeError, ValueError) as error:
        raise KindynaError(f"{name} = {value!r}: {error}") from None


def _spelled(name: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return str(value)
    if isinstance(value, Mapping):
        return ",".join(f"{key}={_spelled(name, item)}" for key, item in value.items())
    if isinstance(value, Sequence):
        return ",".join(_spelled(name, item) for item in value)
    result = number(name, value)
    return str(int(result)) if result.is_integer() else repr(result)


def _items(name: str, value: Any) -> Sequence[Any]:
    """Return the values of an option that can be repeated."""
    if isinstance(value, Mapping):
        return [{key: item} for key, item in value.items()]
    items = value if isinstance(value, Sequence) and not isinstance(value, str) else [value]
    if any(isinstance(item, Sequence) and not isinstance(item, str) for item in items):
        raise TypeError(f"{name} = {value!r}: a list is needed, not a list of lists")
    return items
