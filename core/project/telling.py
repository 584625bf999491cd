"""cattrs' errors as faults: where, what, and what would be right."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import islice
from typing import Any

from cattrs import ClassValidationError, ForbiddenExtraKeysError, IterableValidationError

from core.design import Elastic, split_unit
from core.errors import MISSING, Fault
from core.project.hooks import Wrong, allowed_in, curve_type, keys_of

_LONGEST = 60  # of a key or word that is no use in full
_MOST_WORDS = 500  # comparing takes time


def faults_of(error: Exception, path: str, at: Any, unit: str) -> Iterator[Fault]:
    """Every fault in an error of a strict converter; ``at`` is what the file has at ``path``."""
    if isinstance(error, Wrong):
        yield Fault(path, error.value, error.problem, error.allowed.replace("{path}", path))
    elif isinstance(error, IterableValidationError):
        for inner, place in error.group_exceptions()[0]:
            yield from faults_of(inner, f"{path}[{place.index}]", at[place.index], unit)
    elif isinstance(error, ClassValidationError):
        yield from _faults_of_part(error, path, at, unit)
    else:
        raise error


def _faults_of_part(error: ClassValidationError, path: str, at: Any, unit: str) -> Iterator[Fault]:
    keys = keys_of(error.cl, unit)
    with_place, others = error.group_exceptions()
    for inner, place in with_place:
        key = keys[place.name]
        if place.name in ("curve", "elastic"):  # its keys stand in the table of the whole
            yield from faults_of(inner, path, at, unit)
        elif not isinstance(inner, KeyError):
            yield from faults_of(inner, f"{path}.{key}", at[key], unit)
        elif not any(_stem(other) == _stem(key) for other in at):  # else told as a wrong unit
            yield missing(f"{path}.{key}", allowed_in(error.cl, place.name, key))
    known = list(keys.values())
    if "elastic" in keys:
        known += [f.name for f in dataclasses.fields(Elastic) if f.name not in known]
    if "curve" in keys:
        known += [f.name for f in dataclasses.fields(curve_type(at.get("law"))) if f.name not in known]
    for inner in others:
        if not isinstance(inner, ForbiddenExtraKeysError):
            raise inner
        for extra in sorted(inner.extra_fields, key=str):
            yield unknown_key(f"{path}.{spelled(extra)}", extra, at[extra], known)


def unknown_key(path: str, key: Any, value: Any, known: Iterable[str]) -> Fault:
    known = list(known)
    for right in known:
        if _stem(right) == _stem(key):
            return Fault(path, value, "wrong unit", right)
    return Fault(path, value, f"unknown key{did_you_mean(str(key), known)}", " | ".join(known))


def missing(path: str, allowed: str) -> Fault:
    return Fault(path, MISSING, "missing", allowed)


def spelled(key: Any) -> str:
    """A key as in the file, on one line."""
    text = str(key)
    text = text if len(text) <= _LONGEST else text[:_LONGEST] + "..."
    return text if re.fullmatch(r"[A-Za-z0-9_.-]+", text) else repr(text)


def hinted(fault: Fault) -> Fault:
    """The fault with the word that was probably meant."""
    if not isinstance(fault.value, str):
        return fault
    words = [word for word in fault.allowed.split(" | ") if " " not in word]  # the rest describes, and is not meant
    hint = did_you_mean(fault.value, words)
    return dataclasses.replace(fault, problem=fault.problem + hint)


def did_you_mean(word: str, words: Iterable[str]) -> str:
    near = nearest(word[:_LONGEST], tuple(islice(words, _MOST_WORDS)))
    return f" (did you mean {near!r}?)" if near is not None and near != word else ""


@lru_cache(maxsize=256)  # the same slip is often made many times
def nearest(word: str, words: tuple[str, ...]) -> str | None:
    """The word most like this one, None where none is."""
    from difflib import get_close_matches  # only a file with a fault needs it

    by_plain = {_plain(w): w for w in words}
    close = get_close_matches(_plain(word), by_plain, n=1)
    return by_plain[close[0]] if close else None


def _plain(word: str) -> str:
    return re.sub(r"[\s_]+", "-", word.strip().lower())


def _stem(key: Any) -> str:
    return split_unit(str(key))[0]
