"""Metadata of the fields of a design: label, range and help of every number that can be typed, and its position in the file.

Forms, validation, paths and files all read these fields, so that each part is described once.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import field, replace
from functools import lru_cache
from typing import Any, cast

from core.frozen import frozen
from core.units import Unit, split_unit

LARGEST = 1e15  # in the unit of the field: squares and products of such numbers are still finite
LONGEST_MM = 1e9
NOTHING = dataclasses.MISSING
"""The default of a field without a default."""

SELDOM, USUAL, MAIN = range(3)
"""Weights of fields: folded until the value differs from the default; shown in the order of the file; shown first, never folded."""


@frozen
class Bounds:
    """Quantities that a field limits.

    Attributes
    ----------
    quantities : names in ``core.study.quantities``, of which a design may have some
    remedy : text of the remedy in the finding; empty: the limit has a separate check
    line : label of its line in plots of these quantities
    most : whether it is an upper limit of their magnitude, else a lower limit
    """

    quantities: tuple[str, ...]
    remedy: str = ""
    line: str = "limit {}"
    most: bool = True


PROPER_NAMES = ("Hertz", "Hill", "Kennedy", "Poisson", "Young")
"""Beginnings of names that keep their capital."""


def in_sentence(name: str) -> str:
    """Name within a sentence: ``rod L2``; a symbol, such as that of a point or an angle, and ``Young's modulus`` keep their case."""
    return f"{name[:1].lower()}{name[1:]}" if name[1:2].islower() and not name.startswith(PROPER_NAMES) else name


@frozen
class Info:
    """Metadata of one field.

    Attributes
    ----------
    label, help : texts of the form
    low, high : range of a number, ``LARGEST`` where there is no limit
    open_low, open_high : whether ``low``, ``high`` itself is excluded
    choices : the allowed words
    numbers : the allowed whole numbers, where not all from low to high are allowed
    step : step of a spin box, 0 = by magnitude
    optional : whether it may be None
    whole : whether it is a whole number
    flag : whether it is true or false
    of_motion : whether its unit is that of the motion, with which its key in the file ends: ``rise_mm``
    pair : key of the file that holds it together with the second coordinate, as [x, y]
    missing : text for the value that a file must give although Python has a default
    guessed : whether a file without it has its default, marked as assumed
    bounds : the quantities that it limits
    weight : how often a designer needs it, ``SELDOM`` to ``MAIN``
    order : among fields of equal weight; equal orders are as in the file
    usual : value of a ``SELDOM`` field in a machine that does not need it
    """

    label: str
    help: str = ""
    low: float = -LARGEST
    high: float = LARGEST
    open_low: bool = False
    open_high: bool = False
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
        """Whether a form folds the field while it has this value."""
        if self.weight == SELDOM and value == self.usual:
            return True
        return self.optional and value is None and self.weight < MAIN

    @property
    def in_sentence(self) -> str:
        """The label inside a sentence."""
        return in_sentence(self.label)

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
        low, high = ("above " if self.open_low else ""), ("below " if self.open_high else "")
        return f"{low}{self.low:g} ... {high}{self.high:g}{symbol}"

    def admits(self, value: Any) -> bool:
        """Whether a value is in the range or among the choices."""
        if value is None:
            return self.optional
        if self.choices or self.numbers:
            return value in (self.choices or self.numbers)
        if self.flag:
            return isinstance(value, bool)
        if self.whole and not isinstance(value, int):
            return False
        above = value > self.low if self.open_low else value >= self.low
        below = value < self.high if self.open_high else value <= self.high
        return bool(above and below and math.isfinite(value))

    def nearest(self, value: float) -> float | None:
        """The allowed number nearest to a value; None where there is none, as next to an excluded end of the range."""
        if self.numbers:
            return min(self.numbers, key=lambda number: abs(number - value))
        nearest = min(max(value, self.low), self.high)
        nearest = round(nearest) if self.whole else nearest
        return nearest if abs(nearest) < LARGEST and self.admits(nearest) else None

    @property
    def problem(self) -> str:
        """Why a value is not allowed."""
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
    open_high: bool = False,
    default: Any = NOTHING,
    help: str = "",
    step: float = 0.0,
    of_motion: bool = False,
    missing: str = "",
    guessed: bool = False,
    bounds: Bounds | None = None,
) -> Any:
    """Dataclass field for a number; its name ends with its unit."""
    info = Info(
        label,
        help,
        low,
        high,
        open_low,
        open_high,
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
    """Dataclass field for a whole number."""
    info = Info(label, help, low, high, step=1.0, whole=True, numbers=numbers, optional=default is None, pair=pair)
    return field(default=default, metadata={_KEY: info})


def flag(label: str, *, default: bool = False, help: str = "") -> Any:
    """Dataclass field that is true or false."""
    return field(default=default, metadata={_KEY: Info(label, help, flag=True)})


def length(label: str, *, help: str = "", default: Any = NOTHING) -> Any:
    """Dataclass field for a positive length."""
    return number(label, 0.0, LONGEST_MM, open_low=True, help=help, default=default)


def coordinate(label: str, *, help: str = "", default: Any = NOTHING, pair: str = "") -> Any:
    """Dataclass field for a signed distance."""
    info = Info(label, help, -LONGEST_MM, LONGEST_MM, pair=pair, optional=default is None)
    return field(default=default, metadata={_KEY: info})


def choice(label: str, choices: tuple[str, ...], *, default: Any = NOTHING, help: str = "", missing: str = "") -> Any:
    """Dataclass field for one of several words; None is allowed where it is the default."""
    info = Info(label, help, choices=choices, optional=default is None, missing=missing)
    return field(default=default, metadata={_KEY: info})


def _with_info(part: Any, **changes: Any) -> Any:
    info = replace(part.metadata[_KEY], **changes)
    return field(default=part.default, metadata={**part.metadata, _KEY: info})


def leading(part: Any, order: int = 0) -> Any:
    """Field at the top of its form, in ascending order, that is never folded."""
    return _with_info(part, weight=MAIN, order=order)


def early(part: Any) -> Any:
    """Field below the leading ones of its form, folded while it has no value."""
    return _with_info(part, order=-1)


def seldom(part: Any) -> Any:
    """Field that is folded until its value differs from the default."""
    return _with_info(part, weight=SELDOM, usual=part.default)


def info_of(field: dataclasses.Field[Any]) -> Info | None:
    """Metadata of a dataclass field; None for text, a part or a list."""
    return field.metadata.get(_KEY)


def unit_of(field: dataclasses.Field[Any]) -> Unit:
    """Unit at the end of a field's name."""
    return split_unit(field.name)[1]


# -- layout of the file -----------------------------------------------------------------------------------


@frozen
class FileLayout:
    """Layout in the file of text, a part, or a list of parts.

    Attributes
    ----------
    kind : class of the part, or of the rows of a list; None: text
    choose : class of the part from the table of its owner, which holds the part's keys too; None where it has none of them
    single : whether it is one part, not a list
    key : field that names the rows, as ``points.A``, which are one value or pair; empty: the rows are numbered
    rows : whether each row is a list of its numbers, without unknown ones at its end
    spread : whether named rows are in the table of their owner, under all keys that are not among its other entries
    whole : whether it can be marked as assumed in one entry
    brief : whether entries with their default are left out
    word : key of the word in the same table that chooses the part
    words : that word -> class
    label, help, weight : of the choice
    missing : text for what a file must give
    each : class of the items of a list of numbers or words
    in_file : whether the file contains it
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
    """Layout of a part whose class depends on a word in the same table, before the keys of the part.

    ``otherwise`` is the word where the table has none. Each class has its word in an attribute named ``word``.
    """

    def choose(table: Mapping[str, Any]) -> Any:
        value = table.get(word, otherwise)
        return words.get(value if isinstance(value, str) else otherwise, words[otherwise])

    return FileLayout(
        words[otherwise], choose, word=word, words=words, label=label, help=help, brief=brief, weight=weight
    )


_PLACING = "kindyna-placing"


def placed(placing: FileLayout, default: Any = NOTHING) -> Any:
    """Dataclass field for text, a part or a list of parts."""
    return field(default=default, metadata={_PLACING: placing})


def brief(part: Any) -> Any:
    """Field that the file leaves out where it has its default."""
    return field(default=part.default, metadata={**part.metadata, _PLACING: FileLayout(brief=True)})


@frozen
class FileEntry:
    """One entry of a part's table in the file.

    Attributes
    ----------
    key : as in the file
    names : its fields: two for a pair; none for a word that is the class of a part, as a law or a face
    infos : metadata of these fields; none for text, parts and lists
    placing, default : of the field, for a pair of the first
    within : field of the part to which the entry belongs, where the part's keys are in the table of its owner
    brief : whether the file leaves it out where it has its default
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
        """Metadata of its field, for a pair of the first; None for text, parts and lists."""
        return self.infos[0] if self.infos else None

    @property
    def missing(self) -> str | None:
        """Text for what the file must give; None where the entry is optional."""
        stated = self.info.missing if self.info else self.placing.missing
        return stated or (self.allowed if self.default is NOTHING and self.names else None)

    @property
    def allowed(self) -> str:
        """The allowed values as text."""
        return self.info.allowed(split_unit(self.key)[1]) if self.info else self.placing.missing


LAW = "law"
"""Key of a segment's law, which determines its further keys; the first of its table."""


@lru_cache(maxsize=256)
def _fields_in_order(kind: Any) -> tuple[dataclasses.Field[Any], ...]:
    """Fields of a class in the order of the file: its ``FILE_ORDER``, else its new fields before those of its bases."""
    by_name = {part.name: part for part in dataclasses.fields(kind)}
    order = getattr(
        kind, "FILE_ORDER", [name for base in kind.__mro__ for name in getattr(base, "__annotations__", ())]
    )
    return tuple(by_name[name] for name in dict.fromkeys(order) if name in by_name)


@lru_cache(maxsize=512)
def slots(kind: Any, unit: str = "", inside: tuple[tuple[str, Any], ...] = ()) -> tuple[FileEntry, ...]:
    """Entries of a class's table in the file, for a motion in ``unit``.

    ``inside`` lists fields with the classes of the parts whose keys are in this table.
    """
    entries: list[FileEntry] = [] if LAW not in vars(kind) else [FileEntry(LAW, (), (), FileLayout(), NOTHING)]
    for part in _fields_in_order(kind):
        info, placing = info_of(part), part.metadata.get(_PLACING, FileLayout())
        if placing.choose is not None:
            if placing.word:
                choices = Info(placing.label, placing.help, choices=tuple(placing.words), weight=placing.weight)
                layout = FileLayout(word=placing.word, words=placing.words)
                default = getattr(placing.kind, placing.word)
                entries.append(
                    FileEntry(placing.word, (), (choices,), layout, default, within=part.name, brief=placing.brief)
                )
            inner = (slot for name, class_ in inside if name == part.name for slot in slots(class_))
            entries += [replace(slot, within=part.name, brief=placing.brief) for slot in inner]
        elif info is not None and info.pair and (first := next((s for s in entries if s.key == info.pair), None)):
            pair = replace(first, names=(*first.names, part.name), infos=(*first.infos, info))
            entries[entries.index(first)] = pair
        elif placing.in_file:
            name = part.name.removesuffix("_")  # the field from_ has the key from
            key = name if info is None else info.pair or (f"{name}_{unit}" if info.of_motion and unit else name)
            infos = () if info is None else (info,)
            entries.append(FileEntry(key, (part.name,), infos, placing, part.default, brief=placing.brief))
    return tuple(entries)


@lru_cache(maxsize=256)
def _inline_parts(kind: Any) -> tuple[tuple[str, FileLayout], ...]:
    """Fields of a class whose parts have their keys in its table."""
    placings = ((part.name, part.metadata.get(_PLACING, FileLayout())) for part in dataclasses.fields(kind))
    return tuple((name, placing) for name, placing in placings if placing.choose is not None)


def words_of(kind: Any, key: str) -> Mapping[str, Any]:
    """Word -> class of a part, for the words that are allowed under a key."""
    return next(slot.placing.words for slot in slots(kind) if slot.key == key)


def inside_of(part: Any) -> tuple[tuple[str, Any], ...]:
    """Field -> class of those parts of a part that have their keys in its table."""
    parts = ((name, getattr(part, name)) for name, _ in _inline_parts(cast(Hashable, type(part))))
    return tuple((name, type(inner)) for name, inner in parts if inner is not None)


def inside_of_table(kind: Any, table: Mapping[str, Any], *, possible: bool = False) -> tuple[tuple[str, Any], ...]:
    """Field -> class of the parts with keys in a table of a file; with ``possible`` also of parts that the table could have."""
    chosen = (
        (name, (placing.choose and placing.choose(table)) or (possible and placing.kind))
        for name, placing in _inline_parts(kind)
    )
    return tuple((name, part) for name, part in chosen if part)


def slots_of(part: Any, unit: str = "") -> tuple[FileEntry, ...]:
    """Entries of a part's table in the file, with those of its parts in the same table; without fields that follow from others."""
    entries, derived = slots(cast(Hashable, type(part)), unit, inside_of(part)), getattr(part, "derived", ())
    return tuple(slot for slot in entries if slot.names[:1] != derived) if derived else entries
