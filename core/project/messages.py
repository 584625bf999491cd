"""Messages for keys and words of a file that are not right: how they are spelled, and what was probably meant."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from itertools import islice
from typing import Any

from core.design import split_unit
from core.errors import MISSING, Fault

_LONGEST = 60  # of a key or word that is no use in full
_MOST_WORDS = 500  # comparing takes time


def unknown_key(path: str, key: Any, value: Any, known: Iterable[str]) -> Fault:
    """A key that its table does not have, or one of a wrong unit."""
    known = list(known)
    for right in known:
        if stem(right) == stem(key):
            return Fault(path, value, "wrong unit", right)
    return Fault(path, value, f"unknown key{did_you_mean(str(key), known)}", " | ".join(known))


def missing(path: str, allowed: str) -> Fault:
    """An entry or a table that must be there."""
    return Fault(path, MISSING, "missing", allowed)


def stem(key: Any) -> str:
    """A key without its unit."""
    return split_unit(str(key))[0]


def spelled(key: Any) -> str:
    """A key as in the file, on one line."""
    text = str(key)
    text = text if len(text) <= _LONGEST else text[:_LONGEST] + "..."
    return text if re.fullmatch(r"[A-Za-z0-9_.-]+", text) else repr(text)


def hinted(fault: Fault) -> Fault:
    """The fault, of an unknown word or law with the one that was probably meant."""
    if not isinstance(fault.value, str) or not fault.problem.startswith("unknown"):
        return fault
    return replace(fault, problem=fault.problem + did_you_mean(fault.value, fault.allowed.split(" | ")))


def did_you_mean(word: str, words: Iterable[str]) -> str:
    """``(did you mean 'dwell'?)``, nothing where no word is like this one."""
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
