"""Faults of keys and words in a design file, limits of its size, and the examples with the reasons of their values."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, lru_cache
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, get_args

from core.bounds import DIGITS, FIELD, NESTING
from core.design import (
    CURVES,
    FOLLOWER_KINDS,
    MOTION,
    OUTPUT_LOADS,
    Design,
    Engine,
    FollowerKind,
    Limits,
    Linkage,
    LinkageCam,
    LinkageLoads,
    Motion,
    NamedCurve,
    RollerCam,
    Servo,
    Shaft,
    Valve,
    all_paths,
    drive_at,
    get,
    only,
    row_at,
    split_unit,
)
from core.design.fields import slots
from core.design.followers import FACE, FORM, Face, Form, Rolling
from core.design.rules import MOST_KEYS, count_fault
from core.design.spatial import SPATIAL_CAMS, BarrelCam, GloboidalCam, SpatialCam, SpatialForm
from core.design.topology import driver_pair, is_pin
from core.errors import MISSING, DesignError, Fault, KindynaError
from core.frozen import frozen
from core.process import resources

if TYPE_CHECKING:
    pass

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
    yield from (
        (f"a key of more than {MOST_KEY_PARTS} parts", key.start(), f"at most {MOST_KEY_PARTS}")
        for key in re.finditer(r"[^\n{},\[\]=]++", bare)
        if key[0].count(".") > MOST_KEY_PARTS
    )


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


# -- kind of the design -----------------------------------------------------------------------------------------

FORMAT = 1
Tables = Mapping[str, Any]
KINDS = ("follower", "linkage", "drives")  # one of these tables defines the kind
_ONE_KIND = "exactly one of [follower] | [linkage] | [[drives]], or [motion] alone"


def is_alone(table: Tables) -> bool:
    """Whether the file has a motion, and no cam but one in space."""
    return "motion" in table and ("cam" not in table or is_in_space(table))


def is_in_space(table: Tables) -> bool:
    """Whether the file states a kind of cam, or the inner end of its roller, which only a cam in space has."""
    return isinstance(table.get("cam"), Mapping) and bool({"kind", "roller_inner_mm"} & table["cam"].keys())


def spatial_cam(table: Tables) -> tuple[type[SpatialCam] | None, list[Fault]]:
    """Class of a cam in space, or of the most similar kind where it is misspelled; None where it is unknown."""
    cam, kinds = table["cam"], " | ".join(SPATIAL_CAMS)
    if "kind" not in cam:
        meant = GloboidalCam if "centre_distance_mm" in cam else BarrelCam
        return meant, [missing("cam.kind", kinds)]
    word = cam["kind"]
    if isinstance(word, str) and word in SPATIAL_CAMS:
        return SPATIAL_CAMS[word], []
    nearly = nearest(word, tuple(SPATIAL_CAMS)) if isinstance(word, str) else None
    problem = "unknown word" if isinstance(word, str) else "must be text"
    return SPATIAL_CAMS[nearly] if nearly else None, [hinted(Fault("cam.kind", word, problem, kinds))]


def _choosing(word: str, kinds: Iterable[Any]) -> dict[str, str]:
    """Words that allow a key, by the keys of some classes of parts."""
    words: dict[str, dict[str, None]] = {}
    for kind in kinds:
        for slot in slots(kind):
            words.setdefault(slot.key, {})[f'"{getattr(kind, word)}"'] = None
    return {key: f"{word} = {' or '.join(choices)}" for key, choices in words.items()}


CHOSEN_KEYS = _choosing(FACE, get_args(Face)) | _choosing(FORM, get_args(Form))
"""Words that allow a key of a face or a form."""

SPATIAL_KEYS = _choosing(FORM, get_args(SpatialForm))
"""Words that allow a key of a form of a cam in space."""


def face_word(table: Tables, row: FollowerKind | None) -> str | None:
    """Word of a follower's face; None where it is unknown."""
    follower = table.get("follower")
    word = follower.get(FACE, Rolling.face) if isinstance(follower, Mapping) else Rolling.face
    return word if row is not None and isinstance(word, str) and word in row.faces else None


ENGINE: Mapping[str, type] = MappingProxyType({"engine": Engine, "valve": Valve})
"""Tables of valve trains -> class."""


def table_classes(
    kind: str, row: FollowerKind | None, face: str | None, unit: str, in_space: tuple[type | None, ...] = ()
) -> dict[str, type | None]:
    """Class of each table of the file; None where the kind of follower or its face is unknown.

    unit: that of a motion without a mechanism; in_space: class of its cam, where it has one.
    """
    if kind == MOTION:
        cams: dict[str, type | None] = {"cam": in_space[0]} if in_space else {}
        limits: dict[str, type | None] = {"limits": Limits} if in_space else {}
        return {
            "motion": Motion,
            **cams,
            "shaft": Shaft,
            **ENGINE,
            "loads": OUTPUT_LOADS[unit],
            **limits,
            "servo": Servo,
        }
    if kind == "linkage":
        return {
            "motion": Motion,
            "motions": Motion,
            "linkage": Linkage,
            "cam": LinkageCam,
            "shaft": Shaft,
            **ENGINE,
            "loads": LinkageLoads,
            "limits": Limits,
            "servo": Servo,
        }

    follower, cam, loads = row.under(face or Rolling.face) if row else (None, RollerCam, None)
    cam_class = cam if face or not row else None
    return {
        "motion": Motion,
        "follower": follower,
        "cam": cam_class,
        "shaft": Shaft,
        **ENGINE,
        "loads": loads,
        "limits": Limits,
        "servo": Servo,
    }


def under_other_faces(row: FollowerKind, face: str) -> dict[str, str]:
    """Words of the faces that allow an entry, by the paths of entries that a follower has with other faces only."""
    words_by_path: dict[str, list[str]] = {}
    current_kinds: tuple[Any, ...] = row.under(face)
    for word in (word for word in row.faces if word != face):
        kinds: tuple[Any, ...] = row.under(word)
        for name, kind, current in zip(("follower", "cam", "loads"), kinds, current_kinds, strict=True):
            for key in {slot.key for slot in slots(kind)} - {slot.key for slot in slots(current)}:
                words_by_path.setdefault(f"{name}.{key}", []).append(f'"{word}"')
    return {path: f"{FACE} = {' or '.join(words)}" for path, words in words_by_path.items()}


def follower_kind(table: Tables) -> tuple[FollowerKind | None, list[Fault]]:
    """Row of the follower's kind, or of the most similar one where it is misspelled."""
    follower = table.get("follower")
    if not isinstance(follower, Mapping):
        return None, []  # a fault of the table itself
    kinds = " | ".join(FOLLOWER_KINDS)
    if "kind" not in follower:
        return None, [missing("follower.kind", kinds)]
    kind = follower["kind"]
    if not isinstance(kind, str):
        return None, [Fault("follower.kind", kind, "must be text", kinds)]
    if kind in FOLLOWER_KINDS:
        return FOLLOWER_KINDS[kind], []
    meant = nearest(kind, tuple(FOLLOWER_KINDS))
    return FOLLOWER_KINDS[meant] if meant else None, [hinted(Fault("follower.kind", kind, "unknown word", kinds))]


def likely_unit(table: Tables) -> str:
    """Unit of the motion where the follower does not define it."""
    motion = table.get("motion")
    return "deg" if isinstance(motion, Mapping) and {"start_deg", "advance_deg"} & motion.keys() else "mm"


def driver_unit(linkage: Linkage, motion: Any) -> str:
    """Unit deg of a rotating driver, mm of a sliding one; that of the motion where the pair is unknown."""
    pair = driver_pair(linkage) if linkage.driver.link in linkage.by_number else None
    if pair is None:
        return "mm" if isinstance(motion, Mapping) and "start_mm" in motion else "deg"
    return "deg" if is_pin(pair) else "mm"


# -- header of the file -----------------------------------------------------------------------------------------


def format_faults(table: Tables) -> Iterator[Fault]:
    """Faults of the format number."""
    if "format" not in table:
        yield missing("format", str(FORMAT))
    elif type(table["format"]) is not int or table["format"] != FORMAT:
        yield Fault("format", table["format"], "unknown format", str(FORMAT))


def name_faults(table: Tables) -> Iterator[Fault]:
    """Faults of the name."""
    if "name" not in table:
        yield missing("name", "any text")
    elif not isinstance(table["name"], str):
        yield Fault("name", table["name"], "must be text", "any text")
    elif not table["name"].strip():
        yield Fault("name", table["name"], "empty", "any text")


def kind_faults(table: Tables) -> Iterator[Fault]:
    """Faults of the tables that define the kind of the design."""
    kinds = [kind for kind in KINDS if kind in table]
    if not kinds and not is_alone(table):
        yield missing("follower", _ONE_KIND)
    yield from (
        Fault(key, table[key], f"cannot be combined with {kinds[0]}: a design is of one kind", _ONE_KIND)
        for key in kinds[1:]
    )


def assumed_faults(table: Tables, design: Design, unsure: Sequence[str]) -> Iterator[Fault]:
    """Faults of assumed paths that lead to no entry.

    Allowed are entries of other laws of a segment, which an edit may have left, and paths in tables of unknown class (`unsure`).
    """
    assumed = table.get("assumed", ())
    if not isinstance(assumed, list | tuple):
        yield Fault("assumed", assumed, "must be a list of field paths")
        return
    known = dict.fromkeys(all_paths(design)) if assumed else {}
    for i, path in enumerate(assumed):
        if not isinstance(path, str):
            yield Fault(f"assumed[{i}]", path, "must be a field path, as text")
        elif path not in known and not path.startswith(tuple(unsure)) and not _of_another_law(design, path):
            remedy = "; leave it out here too" if _exists(table, path) else did_you_mean(path, known)
            yield Fault(f"assumed[{i}]", path, f"no such entry in this design{remedy}")


def _exists(table: Any, path: str) -> bool:
    """Whether the file has an entry at a path, valid or not."""
    for step in path.split("."):
        if not isinstance(table, Mapping) or step not in table:
            return False
        table = table[step]
    return True


def _of_another_law(design: Design, path: str) -> bool:
    if design.listed:
        drive = drive_at(path)
        return drive is not None and drive[0] < len(design.drives) and _of_another_law(only(design, drive[0]), drive[1])
    name, number, inside = row_at(path, "motion.segments")
    if not name or design.drive.motion is None or number >= len(design.drive.motion.segments):
        return False
    return re.sub(r"\[\d+\]", "", inside) in _curve_entries()


@cache
def _curve_entries() -> frozenset[str]:
    """Entries of all kinds of curves: `crossover`, `start`, `start.velocity`, `points.value`."""
    kinds: tuple[Any, ...] = (NamedCurve, *CURVES.values())
    entries = [slot for kind in kinds for slot in slots(kind)]
    inner = (f"{slot.key}.{part.key}" for slot in entries if slot.placing.kind for part in slots(slot.placing.kind))
    return frozenset((*(slot.key for slot in entries), *inner))
