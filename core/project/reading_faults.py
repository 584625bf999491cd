"""Faults of keys and words in a design file, limits of its size, and the examples with the reasons of their values."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Any

from core.bounds import DIGITS, FIELD, NESTING
from core.design import Design, all_paths, drive_at, get, split_unit
from core.design.rules import MOST_KEYS, count_fault
from core.errors import MISSING, DesignError, Fault, KindynaError
from core.frozen import frozen
from core.process import resources

# -- examples ---------------------------------------------------------------------------------------------------


@frozen
class Example:
    """An example design.

    Attributes
    ----------
    file : str
        File name without its ending.
    name : str
        Name in menus.
    text : str
        Description in one sentence.
    paper : str
        Slug of its paper, empty where there is none.
    """

    file: str
    name: str
    text: str
    paper: str = ""

    @property
    def path(self) -> Path:
        """Path of the example's file."""
        return resources() / "examples" / f"{self.file}.toml"


@lru_cache(maxsize=1)
def subjects() -> tuple[tuple[str, tuple[Example, ...]], ...]:
    """Titles of the subjects with their examples, in the order of the menu."""
    table = tomllib.loads((resources() / "examples.toml").read_text("utf-8"))
    return tuple(
        (subject["title"], tuple(Example(**row) for row in subject["example"])) for subject in table["subject"]
    )


# -- faults of keys and words -----------------------------------------------------------------------------------


_LONGEST = 60  # characters of a key or word in a message
_MOST_WORDS = 500  # compared with a misspelled word


def unknown_key(path: str, key: Any, value: Any, known: Iterable[str]) -> Fault:
    """Fault of a key that its table does not have, or that has a wrong unit."""
    known = list(known)
    for known_key in known:
        if stem(known_key) == stem(key):
            return Fault(path, value, "wrong unit", known_key)
    return Fault(path, value, f"unknown key{did_you_mean(str(key), known)}", " | ".join(known))


def missing(path: str, allowed: str) -> Fault:
    """Fault of a required entry or table that is missing."""
    return Fault(path, MISSING, "missing", allowed)


def stem(key: Any) -> str:
    """Key without its unit."""
    return split_unit(str(key))[0]


def spelled(key: Any) -> str:
    """Key as in the file, on one line."""
    text = str(key)
    text = text if len(text) <= _LONGEST else text[:_LONGEST] + "..."
    return text if re.fullmatch(r"[A-Za-z0-9_.-]+", text) else repr(text)


def hinted(fault: Fault) -> Fault:
    """The fault, with a suggestion where it is an unknown word or law."""
    if not isinstance(fault.value, str) or not fault.problem.startswith("unknown"):
        return fault
    return replace(fault, problem=fault.problem + did_you_mean(fault.value, fault.allowed.split(" | ")))


def did_you_mean(word: str, words: Iterable[str]) -> str:
    """Suggestion `(did you mean 'dwell'?)`, empty where no word is similar."""
    near = nearest(word[:_LONGEST], tuple(islice(words, _MOST_WORDS)))
    return f" (did you mean {near!r}?)" if near is not None and near != word else ""


@lru_cache(maxsize=256)  # the same misspelling often occurs many times
def nearest(word: str, words: tuple[str, ...]) -> str | None:
    """Most similar word, None where none is similar."""
    from difflib import get_close_matches  # late: needed only for a file with a fault

    by_plain = {_plain(w): w for w in words}
    close = get_close_matches(_plain(word), by_plain, n=1)
    return by_plain[close[0]] if close else None


def _plain(word: str) -> str:
    return re.sub(r"[\s_]+", "-", word.strip().lower())


# -- limits of the size of a file -------------------------------------------------------------------------------


MARKS: Mapping[str, tuple[str, int]] = MappingProxyType(
    {"=": ("entries", 30_000), "{": ("tables", 15_000), ",": ("values", 100_000), "\n[": ("headers", 15_000)}
)
"""Mark of TOML -> the counted items, and their largest number in a file. 3,600 segments need a third of it."""

DEEPEST = 12  # levels of nested tables and lists
MOST_DIGITS = 4300  # of an integer that Python can read
MOST_KEY_PARTS = 50  # a.b.c = ... : the time of tomllib grows with the square of the parts
_TEXT = re.compile(
    r'''"""(?:[^"\\]++|\\.|"(?!""))*+(?:"{3,5}|\Z)|"(?:[^"\\\n]++|\\[^\n])*+"?|#[^\n]*+'''
    r"""|'{3}(?:[^']++|'(?!''))*+(?:'{3,5}|\Z)|'[^'\n]*+'?""",
    re.DOTALL,
)
"""A string or a comment of TOML, up to its end or that of the file."""


def require_few_marks(text: str, source: str) -> None:
    """Raise DesignError for a text that would take long to parse, by the number of its headers and marks."""
    headers = Counter(name.strip() for name in re.findall(r"(?m)^[ \t]*\[\[([^\[\]\n]*)\]\]", text))
    for name, count in headers.items():
        if fault := count_fault(name, count):
            raise DesignError([fault])
    for mark, (what, most) in MARKS.items():
        if (count := text.count(mark)) > most:
            problem = f"{count} {what} ({mark.strip()}) are too many for a design"
            raise DesignError([Fault(source, MISSING, problem, f"at most {most}")])
    bare = _TEXT.sub(_emptied, text)
    for problem, at, allowed in _size_problems(bare):
        line = bare.count("\n", 0, at) + 1
        raise DesignError([Fault(source, MISSING, f"not TOML: {problem} (at line {line})", allowed)])


def _emptied(text: re.Match[str]) -> str:
    """An empty string with the same number of lines, or a word too long where the string is too long."""
    if text[0][0] != "#" and len(text[0]) > FIELD:
        return "_" * (FIELD + 1)
    return f'""{chr(10) * text[0].count(chr(10))}' if text[0][0] != "#" else ""


def _size_problems(bare: str) -> Iterator[tuple[str, int, str]]:
    """Problem, position and allowed size, of a file without its strings and comments."""
    depth = 0
    for mark in re.finditer(r"[\[\]{}]", bare):
        depth += 1 if mark[0] in "[{" else -1
        if depth > NESTING:
            yield "nested too deeply", mark.start(), f"at most {NESTING} levels of tables and lists"
    for word in re.finditer(r"[\w+.-]++", bare):
        if (length := word.end() - word.start()) > FIELD:
            yield "a text too long", word.start(), f"at most {FIELD} characters"
        if length > MOST_DIGITS and word[0].lstrip("+-")[:1].isdigit():
            yield "a number of too many digits", word.start(), f"at most {DIGITS}"
    for key in re.finditer(r"[^\n{},\[\]=]++", bare):
        if key[0].count(".") > MOST_KEY_PARTS:
            yield f"a key of more than {MOST_KEY_PARTS} parts", key.start(), f"at most {MOST_KEY_PARTS}"


def require_few_entries(table: Mapping[str, Any]) -> None:
    """Raise DesignError for the first table with too many keys, or list with too many entries."""
    for fault in _faults(table, "", DEEPEST):
        raise DesignError([fault])


def _faults(value: Any, path: str, deeper: int) -> Iterator[Fault]:
    if not deeper:
        return  # a design has nothing at this level
    if isinstance(value, Mapping):
        if len(value) > MOST_KEYS:
            yield Fault(path, MISSING, f"{len(value)} keys are too many for a table", f"at most {MOST_KEYS}")
            return
        for key, inner in value.items():
            yield from _faults(inner, f"{path}.{spelled(key)}" if path else spelled(key), deeper - 1)
    elif isinstance(value, list | tuple):
        if fault := count_fault(path, len(value)):
            yield fault
            return
        for i, inner in enumerate(value):
            if isinstance(inner, Mapping | list | tuple):
                yield from _faults(inner, f"{path}[{i}]", deeper - 1)


# -- reasons of the values in examples --------------------------------------------------------------------------


@frozen
class Reason:
    """Reason of a value in an example.

    Attributes
    ----------
    designs : tuple of str
        Names of designs, or of drives on a shaft.
    path : str
        Path of the value, or of a table with assumed values.
    text : str
    value : float or None
        Value for which the reason holds; None for any value.
    """

    designs: tuple[str, ...]
    path: str
    text: str
    value: float | None = None


@lru_cache(maxsize=1)
def reasons() -> tuple[Reason, ...]:
    """Reasons of all examples."""
    table = tomllib.loads((resources() / "reasons.toml").read_text("utf-8"))
    return tuple(Reason(tuple(row.pop("designs")), **row) for row in table["reason"])


def reason(design: Design, path: str) -> str:
    """Reason of the value at a path; empty where there is none, or the value has changed."""
    drive = drive_at(path)
    name, inside = (design.name, path) if drive is None else (design.drives[drive[0]].name or "", drive[1])
    for row in reasons():
        matches = row.path == inside or (inside.startswith((f"{row.path}.", f"{row.path}[")) and path in design.assumed)
        if matches and name in row.designs and (row.value is None or _has_value(design, path, row.value)):
            return row.text
    return ""


def _has_value(design: Design, path: str, value: float) -> bool:
    try:
        return bool(get(design, path) == value)
    except KindynaError:
        return False


def reasons_of(design: Design) -> Iterator[tuple[str, str]]:
    """Path and reason of every value of a design that has one, in the order of its file."""
    for path in all_paths(design):
        text = reason(design, path)
        if text:
            yield path, text
