"""Counts of a design file, bounded before it is read: what is larger than any design is refused in one line."""

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

# -- the designs that come with the program ---------------------------------------------------------------------


@frozen
class Example:
    """file: its name without the ending; name, as menus show it; text: what it shows, in a sentence; paper: slug of the paper that
    it belongs to, empty where there is none."""

    file: str
    name: str
    text: str
    paper: str = ""

    @property
    def path(self) -> Path:
        """The example's file."""
        return resources() / "examples" / f"{self.file}.toml"


@lru_cache(maxsize=1)
def subjects() -> tuple[tuple[str, tuple[Example, ...]], ...]:
    """Title of each subject with its examples, in the order in which they are offered."""
    table = tomllib.loads((resources() / "examples.toml").read_text("utf-8"))
    return tuple(
        (subject["title"], tuple(Example(**row) for row in subject["example"])) for subject in table["subject"]
    )


# -- messages for keys and words of a file that are not right ---------------------------------------------------


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


# -- counts of a design file, bounded before it is read ---------------------------------------------------------


MARKS: Mapping[str, tuple[str, int]] = MappingProxyType(
    {"=": ("entries", 30_000), "{": ("tables", 15_000), ",": ("values", 100_000), "\n[": ("headers", 15_000)}
)
"""Mark of TOML -> what it stands before or between, and how many of them a file may have. 3,600 segments take a third."""

DEEPEST = 12  # tables and lists in each other
MOST_DIGITS = 4300  # of a whole number that Python reads, and says that it is too large
MOST_KEY_PARTS = 50  # a.b.c = ... : tomllib's time grows with the square of the parts
_TEXT = re.compile(
    r'''"""(?:[^"\\]++|\\.|"(?!""))*+(?:"{3,5}|\Z)|"(?:[^"\\\n]++|\\[^\n])*+"?|#[^\n]*+'''
    r"""|'{3}(?:[^']++|'(?!''))*+(?:'{3,5}|\Z)|'[^'\n]*+'?""",
    re.DOTALL,
)
"""A text or a comment of TOML, to its end or that of the file."""


def require_few_marks(text: str, source: str) -> None:
    """Raises DesignError for a text that would take long to parse: by its headers, then by its marks."""
    headers = Counter(name.strip() for name in re.findall(r"(?m)^[ \t]*\[\[([^\[\]\n]*)\]\]", text))
    for name, count in headers.items():
        if fault := count_fault(name, count):
            raise DesignError([fault])
    for mark, (what, most) in MARKS.items():
        if (count := text.count(mark)) > most:
            problem = f"{count} {what} ({mark.strip()}) are too many for a design"
            raise DesignError([Fault(source, MISSING, problem, f"at most {most}")])
    bare = _TEXT.sub(_emptied, text)
    for problem, at, allowed in _beyond(bare):
        line = bare.count("\n", 0, at) + 1
        raise DesignError([Fault(source, MISSING, f"not TOML: {problem} (at line {line})", allowed)])


def _emptied(text: re.Match[str]) -> str:
    """A text without what it holds, in as many lines; one that is too long as a word that is."""
    if text[0][0] != "#" and len(text[0]) > FIELD:
        return "_" * (FIELD + 1)
    return f'""{chr(10) * text[0].count(chr(10))}' if text[0][0] != "#" else ""


def _beyond(bare: str) -> Iterator[tuple[str, int, str]]:
    """Problem, place and what is allowed, of a file without its texts and comments."""
    deep = 0
    for mark in re.finditer(r"[\[\]{}]", bare):
        deep += 1 if mark[0] in "[{" else -1
        if deep > NESTING:
            yield "nested too deeply", mark.start(), f"at most {NESTING} tables and lists in each other"
    for word in re.finditer(r"[\w+.-]++", bare):
        if (length := word.end() - word.start()) > FIELD:
            yield "a text too long", word.start(), f"at most {FIELD} characters"
        if length > MOST_DIGITS and word[0].lstrip("+-")[:1].isdigit():
            yield "a number of too many digits", word.start(), f"at most {DIGITS}"
    for key in re.finditer(r"[^\n{},\[\]=]++", bare):
        if key[0].count(".") > MOST_KEY_PARTS:
            yield f"a key of more than {MOST_KEY_PARTS} parts", key.start(), f"at most {MOST_KEY_PARTS}"


def require_few_entries(table: Mapping[str, Any]) -> None:
    """Raises DesignError for the first table of too many keys, or list of too many entries."""
    for fault in _faults(table, "", DEEPEST):
        raise DesignError([fault])


def _faults(value: Any, path: str, deeper: int) -> Iterator[Fault]:
    if not deeper:
        return  # nothing of a design stands there
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


# -- why a value of an example is what it is --------------------------------------------------------------------


@frozen
class Reason:
    """designs: names of designs, or of drives on a shaft; path of the value, or of what holds assumed values; value that it holds for,
    None: whatever it is."""

    designs: tuple[str, ...]
    path: str
    text: str
    value: float | None = None


@lru_cache(maxsize=1)
def reasons() -> tuple[Reason, ...]:
    """All rows."""
    table = tomllib.loads((resources() / "reasons.toml").read_text("utf-8"))
    return tuple(Reason(tuple(row.pop("designs")), **row) for row in table["reason"])


def reason(design: Design, path: str) -> str:
    """Why the value at a path is what it is; empty where nothing is said, or another value stands there now."""
    own = drive_at(path)
    name, inside = (design.name, path) if own is None else (design.drives[own[0]].name or "", own[1])
    for row in reasons():
        there = row.path == inside or (inside.startswith((f"{row.path}.", f"{row.path}[")) and path in design.assumed)
        if there and name in row.designs and (row.value is None or _is(design, path, row.value)):
            return row.text
    return ""


def _is(design: Design, path: str, value: float) -> bool:
    try:
        return bool(get(design, path) == value)
    except KindynaError:
        return False


def reasons_of(design: Design) -> Iterator[tuple[str, str]]:
    """Path and reason of every value of a design for which there is one, in the order of its file."""
    for path in all_paths(design):
        text = reason(design, path)
        if text:
            yield path, text
