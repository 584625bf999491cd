"""What is known of the fields of a design's parts: label, range and help of every number a user can type, and where a part
stands in the file. Forms, validation, paths and files walk over these fields; nothing about a part is written twice."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import field, replace
from functools import lru_cache
from typing import Any, cast

from core.frozen import frozen
from core.units import Unit, split_unit

LARGEST = 1e15  # in the field's own unit: squares and products of such numbers still are numbers
LONGEST_MM = 1e9
NOTHING = dataclasses.MISSING
"""The default of a field that has none."""

SELDOM, USUAL, MAIN = range(3)
"""Weights of fields: what is folded away until it has another value than usual; what stands there in the order of the file; what
comes first, and is never folded."""


@frozen
class Bounds:
    """Of what a number is a limit.

    quantities  rows of ``core.study.quantities``, none of which may pass it; those that a design has
    remedy      what to do where one does: the whole check follows from this row. Empty: the limit has a check of its own
    line        text of its line in plots of these quantities
    most        an upper limit, of their size; else a lower one
    """

    quantities: tuple[str, ...]
    remedy: str = ""
    line: str = "limit {}"
    most: bool = True


@frozen
class Info:
    """What is known of one field.

    low, high  bounds of a number (``open_low``: low itself is excluded); no bound stated means ``LARGEST``
    choices    bounds words
    numbers    bounds a number without a fraction, where not all from low to high are allowed
    step       a sensible step of a spin box, 0 = by magnitude
    optional   may be None
    whole      a number without a fraction
    flag       true or false
    of_motion  counts in the motion's unit, which its key in the file ends with: ``rise_mm``
    pair       key of the file under which it stands with the other coordinate, as [x, y]
    missing    what a file must say, where Python has a default; that as text
    guessed    of a number of the machine with a default: assumed where nobody gives it
    bounds     of a limit: what it is a limit of
    weight     how often a designer needs it, ``SELDOM`` to ``MAIN``; order: among those of one weight, as in the file where both are
               the same
    usual      of what is needed seldom: the value that a machine has which does without
    """

    label: str
    help: str = ""
    low: float = -LARGEST
    high: float = LARGEST
    open_low: bool = False
    choices: tuple[str, ...] = ()
    numbers: tuple[int, ...] = ()
    step: float = 0.0
    optional: bool = False
    whole: bool = False
    flag: bool = False
    of_motion: bool = False
    pair: str = ""
    missing: str = ""
    guessed: bool = False
    bounds: Bounds | None = None
    weight: int = USUAL
    order: int = 0
    usual: Any = None

    def folds(self, value: Any) -> bool:
        """Whether a form folds the field away while this stands there: nobody has needed it yet."""
        if self.weight == SELDOM and value == self.usual:
            return True
        return self.optional and value is None and self.weight < MAIN

    @property
    def in_sentence(self) -> str:
        """The label as it stands inside a sentence."""
        return self.label[:1].lower() + self.label[1:]

    def allowed(self, unit: Unit) -> str:
        """The allowed range as text: ``> 0 mm``, ``0 ... 1``, ``ccw | cw``."""
        if self.choices or self.numbers:
            return " | ".join(map(str, self.choices or self.numbers))
        if self.flag:
            return "true | false"
        symbol = f" {unit.symbol}" if unit.symbol else ""
        if self.low == -LARGEST and self.high == LARGEST:
            return f"any number{' of' + symbol if symbol else ''} up to +-{LARGEST:g}"
        if self.high == LARGEST:
            return f"{'>' if self.open_low else '>='} {self.low:g}{symbol}"
        if self.whole:
            return f"{self.low} ... {self.high}{symbol}"
        return f"{'above ' if self.open_low else ''}{self.low:g} ... {self.high:g}{symbol}"

    def admits(self, value: Any) -> bool:
        """Whether a value is within the bounds or among the choices."""
        if value is None:
            return self.optional
        if self.choices or self.numbers:
            return value in (self.choices or self.numbers)
        if self.flag:
            return isinstance(value, bool)
        if self.whole and not isinstance(value, int):
            return False
        above = value > self.low if self.open_low else value >= self.low
        return bool(above and value <= self.high and math.isfinite(value))

    @property
    def problem(self) -> str:
        """What is wrong with a value that is not admitted."""
        if self.numbers:
            return f"no {self.label.lower()}"
        return "unknown word" if self.choices else "outside its range"


_KEY = "kindyna"


def number(
    label: str,
    low: float = -LARGEST,
    high: float = LARGEST,
    *,
    open_low: bool = False,
    default: Any = NOTHING,
    help: str = "",
    step: float = 0.0,
    of_motion: bool = False,
    missing: str = "",
    guessed: bool = False,
    bounds: Bounds | None = None,
) -> Any:
    """A dataclass field for a number; its name ends with its unit."""
    info = Info(
        label,
        help,
        low,
        high,
        open_low,
        step=step,
        optional=default is None,
        of_motion=of_motion,
        missing=missing,
        guessed=guessed,
        bounds=bounds,
    )
    return field(default=default, metadata={_KEY: info})


def whole(
    label: str,
    low: int,
    high: int,
    *,
    default: Any = NOTHING,
    help: str = "",
    numbers: tuple[int, ...] = (),
    pair: str = "",
) -> Any:
    """A dataclass field for a number without a fraction."""
    info = Info(label, help, low, high, step=1.0, whole=True, numbers=numbers, optional=default is None, pair=pair)
    return field(default=default, metadata={_KEY: info})


def flag(label: str, *, default: bool = False, help: str = "") -> Any:
    """A dataclass field that is true or false."""
    return field(default=default, metadata={_KEY: Info(label, help, flag=True)})


def length(label: str, *, help: str = "", default: Any = NOTHING) -> Any:
    """A dataclass field for a length that must be positive."""
    return number(label, 0.0, LONGEST_MM, open_low=True, help=help, default=default)


def coordinate(label: str, *, help: str = "", default: Any = NOTHING, pair: str = "") -> Any:
    """A dataclass field for a signed distance."""
    info = Info(label, help, -LONGEST_MM, LONGEST_MM, pair=pair, optional=default is None)
    return field(default=default, metadata={_KEY: info})


def choice(label: str, choices: tuple[str, ...], *, default: Any = NOTHING, help: str = "", missing: str = "") -> Any:
    """A dataclass field for one word of several; None where that is its default."""
    info = Info(label, help, choices=choices, optional=default is None, missing=missing)
    return field(default=default, metadata={_KEY: info})


def _weighed(made: Any, **changes: Any) -> Any:
    info = replace(made.metadata[_KEY], **changes)
    return field(default=made.default, metadata={**made.metadata, _KEY: info})


def leading(made: Any, order: int = 0) -> Any:
    """A field that comes first in its form, the lower the order the sooner, and is never folded away."""
    return _weighed(made, weight=MAIN, order=order)


def seldom(made: Any) -> Any:
    """A field that is folded away until it has another value than its default."""
    return _weighed(made, weight=SELDOM, usual=made.default)


def info_of(field: dataclasses.Field[Any]) -> Info | None:
    """The metadata of a dataclass field, None where it holds no entry of its own (a part, a list)."""
    return field.metadata.get(_KEY)


def unit_of(field: dataclasses.Field[Any]) -> Unit:
    """The unit that a field's name ends with."""
    return split_unit(field.name)[1]


# -- where a part stands in the file ----------------------------------------------------------------------


@frozen
class FileLayout:
    """How the file holds what is no entry of its own: text, a part, a list of parts.

    kind     class of the part, or of the rows of a list; None: text
    choose   class of the part by the table of the whole, which holds the part's keys too; None where it has none of them
    single   one part, no list of them
    key      rows are named by this field of theirs, as ``points.A``, and are one value or pair each; else numbered
    rows     of a list, each is a list of its numbers, in their order; those at its end that are not known are left out
    spread   rows named by a key stand in the table of the whole, under all keys that are none of its other entries
    whole    may be assumed as a whole
    brief    the part's entries that are as they would be anyway are left out
    word     key of the word in the same table that chooses the part; words: that word -> class; label, help, weight: of the choice
    missing  what a file must say, as text
    each     a list of plain numbers or words: of which class
    in_file  False: it follows from something else
    """

    kind: Any = None
    choose: Callable[[Mapping[str, Any]], Any] | None = None
    single: bool = False
    key: str = ""
    rows: bool = False
    spread: bool = False
    whole: bool = False
    brief: bool = False
    missing: str = ""
    each: type[float] | type[str] | None = None
    in_file: bool = True
    word: str = ""
    words: Mapping[str, Any] = field(default_factory=dict)
    label: str = ""
    help: str = ""
    weight: int = USUAL


def chosen_by_word(
    word: str,
    words: Mapping[str, Any],
    label: str,
    *,
    otherwise: str,
    brief: bool = False,
    help: str = "",
    weight: int = USUAL,
) -> FileLayout:
    """A part whose class is chosen by a word of the same table, which stands there before its own keys; ``otherwise``: the
    word where the table has none. Each class says its word in an attribute of that name."""

    def choose(table: Mapping[str, Any]) -> Any:
        value = table.get(word, otherwise)
        return words.get(value if isinstance(value, str) else otherwise, words[otherwise])

    return FileLayout(
        words[otherwise], choose, word=word, words=words, label=label, help=help, brief=brief, weight=weight
    )


_PLACING = "kindyna-placing"


def placed(placing: FileLayout, default: Any = NOTHING) -> Any:
    """A dataclass field for text, a part or a list of parts."""
    return field(default=default, metadata={_PLACING: placing})


def brief(made: Any) -> Any:
    """A field that the file leaves out where it has its default."""
    return field(default=made.default, metadata={**made.metadata, _PLACING: FileLayout(brief=True)})


@frozen
class FileEntry:
    """One entry of a part's table in the file.

    key      as the file spells it
    names    the fields that hold it: two of a pair; none of a word that the class of a part stands for: a law, a face
    infos    of these fields; none of text, parts and lists
    placing, default   of the field, of a pair's first
    within   field of the part whose own fields these are, where its keys stand in the table of the whole
    brief    left out of the file where it is as it would be anyway
    """

    key: str
    names: tuple[str, ...]
    infos: tuple[Info, ...]
    placing: FileLayout
    default: Any
    within: str = ""
    brief: bool = False

    @property
    def info(self) -> Info | None:
        """Of its field, of a pair's first; None of text, parts and lists."""
        return self.infos[0] if self.infos else None

    @property
    def missing(self) -> str | None:
        """What the file must say, as text; None where it need not."""
        stated = self.info.missing if self.info else self.placing.missing
        return stated or (self.allowed if self.default is NOTHING and self.names else None)

    @property
    def allowed(self) -> str:
        """The allowed values as text."""
        return self.info.allowed(split_unit(self.key)[1]) if self.info else self.placing.missing


LAW = "law"
"""Key of a segment's curve, which tells what other keys it has; the first of its table."""


@lru_cache(maxsize=256)
def _fields_in_order(kind: Any) -> tuple[dataclasses.Field[Any], ...]:
    """The fields of a class as they follow each other in the file: as the class says, else its own before those that it
    shares."""
    own = {each.name: each for each in dataclasses.fields(kind)}
    order = getattr(
        kind, "FILE_ORDER", [name for each in kind.__mro__ for name in getattr(each, "__annotations__", ())]
    )
    return tuple(own[name] for name in dict.fromkeys(order) if name in own)


@lru_cache(maxsize=512)
def slots(kind: Any, unit: str = "", inside: tuple[tuple[str, Any], ...] = ()) -> tuple[FileEntry, ...]:
    """The entries of a class's table in the file, for a motion in ``unit``; inside: field -> class of the parts whose keys
    stand in this table."""
    found: list[FileEntry] = [] if LAW not in vars(kind) else [FileEntry(LAW, (), (), FileLayout(), NOTHING)]
    for each in _fields_in_order(kind):
        info, placing = info_of(each), each.metadata.get(_PLACING, FileLayout())
        if placing.choose is not None:
            if placing.word:
                choices = Info(placing.label, placing.help, choices=tuple(placing.words), weight=placing.weight)
                here = FileLayout(word=placing.word, words=placing.words)
                default = getattr(placing.kind, placing.word)
                found.append(
                    FileEntry(placing.word, (), (choices,), here, default, within=each.name, brief=placing.brief)
                )
            own = (slot for name, part in inside if name == each.name for slot in slots(part))
            found += [replace(slot, within=each.name, brief=placing.brief) for slot in own]
        elif info is not None and info.pair and (first := next((s for s in found if s.key == info.pair), None)):
            both = replace(first, names=(*first.names, each.name), infos=(*first.infos, info))
            found[found.index(first)] = both
        elif placing.in_file:
            name = each.name.removesuffix("_")  # a word of Python's, as from, is a key without its mark
            key = name if info is None else info.pair or (f"{name}_{unit}" if info.of_motion and unit else name)
            found.append(
                FileEntry(
                    key, (each.name,), () if info is None else (info,), placing, each.default, brief=placing.brief
                )
            )
    return tuple(found)


@lru_cache(maxsize=256)
def _choosing(kind: Any) -> tuple[tuple[str, FileLayout], ...]:
    """The fields of a class whose parts' keys stand in its table."""
    placings = ((each.name, each.metadata.get(_PLACING, FileLayout())) for each in dataclasses.fields(kind))
    return tuple((name, placing) for name, placing in placings if placing.choose is not None)


def words_of(kind: Any, key: str) -> Mapping[str, Any]:
    """Word -> class of the parts that a class may have by the word that stands under this key."""
    return next(slot.placing.words for slot in slots(kind) if slot.key == key)


def inside_of(part: Any) -> tuple[tuple[str, Any], ...]:
    """Field -> class of the parts of a part whose keys stand in its own table."""
    parts = ((name, getattr(part, name)) for name, _ in _choosing(cast(Hashable, type(part))))
    return tuple((name, type(inner)) for name, inner in parts if inner is not None)


def inside_of_table(kind: Any, table: Mapping[str, Any], *, possible: bool = False) -> tuple[tuple[str, Any], ...]:
    """The same by the table of a file; possible: also of parts that it does not have, but could have."""
    chosen = (
        (name, (placing.choose and placing.choose(table)) or (possible and placing.kind))
        for name, placing in _choosing(kind)
    )
    return tuple((name, part) for name, part in chosen if part)


def slots_of(part: Any, unit: str = "") -> tuple[FileEntry, ...]:
    """The entries of a part's table in the file, those of parts in it that stand in the same table included."""
    return slots(cast(Hashable, type(part)), unit, inside_of(part))
