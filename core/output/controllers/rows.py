"""Texts with places: ``{name}`` of the listed names and nothing else, ``{{`` and ``}}`` for braces."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, field, fields
from functools import lru_cache
from itertools import chain, cycle
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from core.errors import MISSING as ABSENT
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.process import resources
from core.project import parsed
from core.project.files import read_text

# -- texts with places ------------------------------------------------------------------------------------------


_PART = re.compile(r"(\{\{|\}\}|[^{}]+)|\{([A-Za-z_]+)\}|[{}]")


@lru_cache(maxsize=512)
def places(template: str) -> tuple[tuple[str, str], ...]:
    """The template in parts: a text before each place, and the place's name; empty behind the last. Raises ValueError for any other
    brace."""
    parts, text = list[tuple[str, str]](), ""
    for match in _PART.finditer(template):
        literal, name = match.groups()
        if name is not None:
            parts.append((text, name))
            text = ""
        elif literal is None:
            raise ValueError(f"{template[match.start() : match.start() + 20]!r} is no place")
        else:
            text += literal[0] if literal in ("{{", "}}") else literal
    return (*parts, (text, ""))


def names(template: str) -> frozenset[str]:
    """The names of its places. Raises ValueError as ``places``."""
    return frozenset(name for _, name in places(template) if name)


def filled(template: str, values: Mapping[str, str]) -> str:
    """The text with a value at each place; ``...`` where there is none."""
    return "".join(text + (values.get(name, "...") if name else "") for text, name in places(template))


def rows(template: str, values: Mapping[str, str], columns: Mapping[str, list[str]], count: int) -> Iterator[str]:
    """The text so many times, with the values of each row at the places of columns."""
    parts: list[list[str]] = []
    for text, name in places(template):
        parts += [[text] * count] if text else []
        parts += [columns[name] if name in columns else [values.get(name, "...")] * count] if name else []
    return map("".join, zip(*parts, strict=True))


# -- what controllers run between the rows of a table -----------------------------------------------------------


REACH = 14  # rows: what shakes a spline falls by 2 - √3 from one to the next, to 1e-8


@frozen(eq=False)
class Table:
    """The rows of one turn, both ends of it among them.

    x       (n,) angles of the master [deg]
    states  (3, n) value, velocity and acceleration [unit, per degree]; of what the interpolation does not run through: anything
    slopes  of a clamped spline at both ends
    """

    x: np.ndarray
    states: np.ndarray
    slopes: tuple[float, float] = (0.0, 0.0)


def linear(table: Table) -> np.ndarray:
    """Straight lines: (2, n - 1) coefficients of the powers of the angle from the start of each piece."""
    s = table.states[0]
    return np.array([s[:-1], np.diff(s) / np.diff(table.x)])


def cubic_hermite(table: Table) -> np.ndarray:
    """Cubics through value and velocity of both ends."""
    h, (s, v) = np.diff(table.x), table.states[:2]
    rise, v0, v1 = np.diff(s) / h, v[:-1], v[1:]
    return np.array([s[:-1], v0, (3.0 * rise - 2.0 * v0 - v1) / h, (v0 + v1 - 2.0 * rise) / h**2])


def quintic_hermite(table: Table) -> np.ndarray:
    """Quintics through value, velocity and acceleration of both ends."""
    h, (s, v, a) = np.diff(table.x), table.states
    # what value, velocity and acceleration at the end lack, times the powers of h that give all of them the unit of the value
    d0 = np.diff(s) - h * (v[:-1] + 0.5 * h * a[:-1])
    d1 = h * (np.diff(v) - h * a[:-1])
    d2 = h**2 * np.diff(a)
    return np.array(
        [s[:-1], v[:-1], 0.5 * a[:-1],
         (10.0 * d0 - 4.0 * d1 + 0.5 * d2) / h**3, (-15.0 * d0 + 7.0 * d1 - d2) / h**4, (6.0 * d0 - 3.0 * d1 + 0.5 * d2) / h**5]
    )  # fmt: skip


def clamped_spline(table: Table) -> np.ndarray:
    """The cubic spline of these slopes at both ends: velocity and acceleration are continuous."""
    from scipy.interpolate import CubicSpline

    ends = ((1, table.slopes[0]), (1, table.slopes[1]))
    return np.asarray(CubicSpline(table.x, table.states[0], bc_type=ends).c[::-1])


def spline_of_equal(h: np.ndarray, states: np.ndarray) -> np.ndarray:
    """The same of many tables (2, n, k) of equal steps (k,), of each with its own slopes at both ends: (4, n - 1, k)."""
    from scipy.interpolate import CubicSpline

    s, v = states[:2]
    made = CubicSpline(np.arange(s.shape[0]), s, bc_type=((1, v[0] * h), (1, v[-1] * h)))
    return np.asarray(made.c[::-1] / h ** np.arange(4)[:, None, None])


def zebra(table: Table) -> np.ndarray:
    """Quintic and straight segments in turn, the last one straight; a quintic has the slopes of its straight neighbours, and no
    acceleration at its ends (ISG kernel; that is inferred)."""
    slope = np.diff(table.states[0]) / np.diff(table.x)
    straight = np.arange(slope.size) % 2 == 1
    v = np.empty(table.x.size)
    v[1:][straight] = slope[straight]
    v[:-1][straight] = slope[straight]
    v[0], v[-1] = v[-1], v[-1]
    quintic = quintic_hermite(Table(table.x, np.array([table.states[0], v, np.zeros(v.size)])))
    return np.where(straight, np.concatenate([linear(table), np.zeros((4, slope.size))]), quintic)


@frozen
class Interpolation:
    """One row.

    coefficients  of a table's pieces
    order     the error of the value falls as this power of the step
    through   how many of value, velocity and acceleration it runs through; needs: how many of them it is made of
    derivatives  how many of them it has
    jump      largest error of the value that one row at a jump of velocity or of acceleration leaves, by h|Δv| and h²|Δa|
    reach     of what runs through all rows: beyond so many of them on either side a piece takes no notice; of_equal: the coefficients of
              tables of so many rows
    """

    coefficients: Callable[[Table], np.ndarray]
    order: int
    through: int
    needs: int
    derivatives: int = 3
    jump: tuple[float, float] = (0.0, 0.0)
    reach: int = 0
    of_equal: Callable[[np.ndarray, np.ndarray], np.ndarray] = spline_of_equal


KINDS: Mapping[str, Interpolation] = MappingProxyType(
    {
        "linear": Interpolation(linear, 2, 1, 1, 2, (0.25, 0.125)),
        "cubic-hermite": Interpolation(cubic_hermite, 4, 2, 2, 3, (4.0 / 27.0, 0.01615)),
        "clamped-spline": Interpolation(clamped_spline, 4, 1, 2, 3, (0.25, 0.125), REACH),
        "quintic-hermite": Interpolation(quintic_hermite, 6, 3, 3, 3, (16.0 / 81.0, 0.01728)),
        "zebra": Interpolation(zebra, 2, 1, 1, 3, (0.25, 0.125)),
    }
)
"""By the name in a controller's row; of ``unknown`` there is none."""


def evaluated(coefficients: np.ndarray, w: np.ndarray, orders: int = 3) -> np.ndarray:
    """Value and derivatives (orders, ...) of polynomials (k, ...) at w from their starts, by Horner's scheme."""
    made = []
    for _ in range(orders):
        value = np.zeros(np.broadcast_shapes(coefficients.shape[1:], w.shape))
        for row in coefficients[::-1]:
            value = value * w + row
        made.append(value)
        k = np.arange(1, coefficients.shape[0]).reshape(-1, *([1] * (coefficients.ndim - 1)))
        coefficients = coefficients[1:] * k if coefficients.shape[0] > 1 else np.zeros_like(coefficients)
    return np.array(made)


# -- controllers of electronic cams -----------------------------------------------------------------------------


INTERPOLATIONS = ("linear", "cubic-hermite", "clamped-spline", "quintic-hermite", "zebra", "unknown")
"""What a controller runs between two rows; ``unknown``: no source states it."""
UNKNOWN = "unknown"
COLUMNS = ("index", "master", "slave", "velocity", "acceleration", "jerk")
NEEDED = {"linear": (), "cubic-hermite": ("velocity",), "clamped-spline": (), "zebra": (), UNKNOWN: (),
          "quintic-hermite": ("velocity", "acceleration")}  # fmt: skip
"""Interpolation -> the columns beside the slave's that it runs through."""
_OF_TABLE = frozenset(
    {"rows", "last", "name", "Name", "sep", "interpolation", "master_start", "master_end", "slave_start", "slave_end",
     "master_factor", "master_offset", "slave_factor", "slave_offset", "start_slope", "end_slope"}
)  # fmt: skip
_OF_ROW = frozenset({*COLUMNS, "sep", "last", "interpolation"})
FILE = "controllers.toml"
MOST_ROWS, LARGEST_ROWS = 100_000, 10_000_000
"""Rows of a table where a controller's row does not say it, and the most that it may say."""
LONGEST, MOST_TEXTS = 10_000, 100
"""Characters of a text, and texts of a list."""
ENCODINGS = ("utf-8", "ascii", "latin-1", "cp1252", "utf-16")
_EXTENSION = re.compile(r"\.[A-Za-z0-9._-]{0,15}[A-Za-z0-9_-]")


@frozen
class Controller:
    """One row.

    interpolation  what it can be set to run between two rows, the usual first; interpolation_asked: none is usual
    words          interpolation -> the word that stands for {interpolation} in the file
    columns        of a row; equidistant tables have no master
    header, row, footer  texts with places in braces; between: what stands between two rows, of several one after the other;
                   first_between: between the first two, where that is something else
    comment        what begins a comment that its reader skips
    decimal        mark; point: a whole number has it too, as in 12.0
    digits         of the largest number of a column, all others to as many decimals; integer: none after the mark; unit: what 1 counts, of
                   the master and of the slave
    equal_steps    the master advances by equal steps; step_units: whole steps that are allowed
    closes         the last row of a periodic table is the end of the turn, which is its start again
    first_row, last_row  where they stand: "start" | "one-step" after it, "end" | "before-end" by one step
    open           what no source states
    normalised     master and slave 0...1; last_is_one: so divided that the last row is 1, 1
    rows           least and most; least_step: the master advances by as much at least [deg]
    """

    slug: str
    label: str
    interpolation: tuple[str, ...]
    columns: tuple[str, ...]
    row: str
    source: str = ""
    header: str = ""
    between: tuple[str, ...] = ("\n",)
    first_between: str | None = None
    footer: str = ""
    words: Mapping[str, str] = field(default_factory=dict, compare=False)
    interpolation_asked: bool = False
    comment: str = ""
    separator: str = "\t"
    decimal: str = "."
    newline: str = "\n"
    encoding: str = "utf-8"
    digits: int = 9
    integer: bool = False
    unit: float = 1.0
    point: bool = False
    equal_steps: bool = False
    step_units: tuple[int, ...] = ()
    closes: bool = True
    first_row: str = "start"
    last_row: str = "end"
    open: tuple[str, ...] = ()
    normalised: bool = False
    last_is_one: bool = False
    rows: tuple[int, int] = (2, MOST_ROWS)
    least_step: float = 0.0
    extension: str = ".txt"

    @property
    def closing(self) -> bool:
        """Whether both ends of the turn have a row."""
        return self.closes and self.first_row == "start" and self.last_row == "end"

    def gaps(self) -> Iterator[str]:
        """What stands between one row and the next, without end."""
        return chain(() if self.first_between is None else (self.first_between,), cycle(self.between))

    def chosen(self, interpolation: str | None) -> str:
        """What it runs between two rows. Raises KindynaError where it cannot be set so, or it is not said how it is set."""
        if interpolation is None and not self.interpolation_asked:
            return self.interpolation[0]
        if interpolation not in self.interpolation:
            given = "is needed" if interpolation is None else f"{interpolation}: {self.slug} does not run it"
            raise KindynaError(f"--interpolation {given}; allowed: {' | '.join(self.interpolation)}")
        return interpolation


def _is_texts(value: Any) -> bool:
    return isinstance(value, list) and len(value) <= MOST_TEXTS and all(map(_is_text, value))


def _is_counts(value: Any) -> bool:
    return isinstance(value, list) and all(type(each) is int and 0 < each <= LARGEST_ROWS for each in value)


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST


def _has_places(text: Any, known: frozenset[str]) -> bool:
    try:
        return _is_text(text) and names(text) <= known
    except ValueError:
        return False


_TEXT = (_is_text, f"text of at most {LONGEST} characters")
_FLAG = (lambda value: isinstance(value, bool), "true | false")
_POSITIVE = (lambda value: type(value) in (int, float) and 0.0 < value < 1e9, "> 0, < 1e9")


def _with_places(known: frozenset[str]) -> tuple[Callable[[Any], bool], str]:
    names_of = "} {".join(sorted(known))
    return lambda value: _has_places(
        value, known
    ), f"text with no other places than {{{names_of}}}; {{{{ and }}}} for braces"


def _one_of(*words: str) -> tuple[Callable[[Any], bool], str]:
    return lambda value: value in words, " | ".join(map(repr, words))


def _some_of(words: tuple[str, ...]) -> tuple[Callable[[Any], bool], str]:
    return lambda value: _is_texts(value) and bool(value) and set(value) <= {*words}, f"a list of {', '.join(words)}"


_ALLOWED: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "slug": (lambda value: _is_text(value) and value != "" and value.replace("-", "").isalnum(), "letters, digits and -"),
    "label": _TEXT, "source": _TEXT, "header": _with_places(_OF_TABLE), "footer": _with_places(_OF_TABLE),
    "row": _with_places(_OF_ROW),
    "between": (lambda value: _is_text(value) or (_is_texts(value) and bool(value)), "text, or a list of texts"),
    "first_between": _TEXT, "unit": _POSITIVE, "least_step": _POSITIVE,
    "words": (lambda value: isinstance(value, dict) and set(value) <= {*INTERPOLATIONS} and all(map(_is_text, value.values())),
              "words of interpolations"),
    "interpolation": _some_of(INTERPOLATIONS), "interpolation_asked": _FLAG, "columns": _some_of(COLUMNS),
    "comment": _TEXT, "separator": _TEXT, "decimal": _one_of(".", ","), "newline": _one_of("\n", "\r\n", "\r"),
    "encoding": _one_of(*ENCODINGS),
    "digits": (lambda value: type(value) is int and 1 <= value <= 17, "1 ... 17"), "integer": _FLAG, "point": _FLAG,
    "equal_steps": _FLAG, "step_units": (_is_counts, "a list of whole numbers > 0"), "closes": _FLAG,
    "first_row": _one_of("start", "one-step"), "last_row": _one_of("end", "before-end"),
    "open": (_is_texts, "a list of texts"), "normalised": _FLAG, "last_is_one": _FLAG,
    "rows": (lambda value: _is_counts(value) and len(value) == 2 and 2 <= value[0] <= value[1] <= LARGEST_ROWS,
             f"[least, most], from 2 on, to {LARGEST_ROWS}"),
    "extension": (lambda value: isinstance(value, str) and bool(_EXTENSION.fullmatch(value)),
                  "a dot, then 1 ... 16 letters, digits, dots, _ or -, no dot at the end, such as .txt"),
}  # fmt: skip


def _made(table: Any, path: str) -> Controller:
    """A row. Raises DesignError with all its faults."""
    if not isinstance(table, dict):
        raise DesignError([Fault(path, table, "no table", "[[controllers]]")])
    known = {each.name: each for each in fields(Controller)}
    faults = [
        Fault(f"{path}.{key}", value, "unknown key", ", ".join(known))
        for key, value in table.items()
        if key not in known
    ]
    faults += [
        Fault(f"{path}.{name}", ABSENT, "is missing", _ALLOWED[name][1])
        for name, each in known.items()
        if each.default is MISSING and each.default_factory is MISSING and name not in table
    ]
    faults += [
        Fault(f"{path}.{name}", table[name], "not allowed", allowed)
        for name, (admits, allowed) in _ALLOWED.items()
        if name in table and not admits(table[name])
    ]
    if faults:
        raise DesignError(faults)
    values: dict[str, Any] = {key: tuple(value) if isinstance(value, list) else value for key, value in table.items()}
    if isinstance(values.get("between"), str):
        values["between"] = (values["between"],)
    row = Controller(**values)
    _require_whole(row, table, path)
    return row


def _require_whole(row: Controller, table: Mapping[str, Any], path: str) -> None:
    """Raises DesignError where its keys contradict each other."""
    faults = []
    places = names(row.row)
    if "slave" not in row.columns:
        faults.append(Fault(f"{path}.columns", table["columns"], "no slave", "a list with slave"))
    for name in row.columns:
        if name not in places:
            faults.append(
                Fault(
                    f"{path}.row", row.row, f"lacks {{{name}}}, which is one of the columns", "a place for each column"
                )
            )
    for name in sorted(places & {*COLUMNS} - {*row.columns}):
        faults.append(
            Fault(f"{path}.columns", table["columns"], f"lacks {name}, which stands in row", "a column for each place")
        )
    for method in row.interpolation:
        lacking = [name for name in NEEDED[method] if name not in row.columns]
        if lacking:
            faults.append(
                Fault(f"{path}.interpolation", method, f"needs the column {lacking[0]}", "what its columns tell")
            )
    if "master" not in row.columns and not row.equal_steps:
        faults.append(
            Fault(f"{path}.equal_steps", row.equal_steps, "rows without a master stand at equal steps", "true")
        )
    if faults:
        raise DesignError(faults)


# -- the rows there are ------------------------------------------------------------------------------------


def settings_folder() -> Path:
    """Where the settings are: of KINDYNA in the folder that the desktop names."""
    if sys.platform == "win32":
        return Path(os.environ.get("APPDATA") or Path.home()) / "KINDYNA"
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "KINDYNA"


def rows_of(text: str, source: str) -> dict[str, Controller]:
    """Slug -> row of a file's text. Raises KindynaError with a line for each fault, which names the field."""
    table = parsed(text, source)
    listed = table.get("controllers", [])
    if set(table) - {"controllers"} or not isinstance(listed, list):
        raise KindynaError(f"{source}: holds [[controllers]] and nothing else")
    rows: dict[str, Controller] = {}
    for number, each in enumerate(listed):
        path = f"controllers[{number}]"
        try:
            row = _made(each, path)
        except DesignError as error:
            slug = each.get("slug") if isinstance(each, dict) else None
            named = f"{source}: {slug[:60]}" if isinstance(slug, str) and slug.isprintable() else source
            raise KindynaError("\n".join(f"{named}: {line}" for line in str(error).splitlines())) from error
        if row.slug in rows:
            raise KindynaError(
                f"{source}: {path}.slug = {row.slug!r}: stands there twice; allowed: one row of each name"
            )
        rows[row.slug] = row
    return rows


def shipped() -> dict[str, Controller]:
    """Slug -> row of the resources."""
    return rows_of((resources() / FILE).read_text("utf-8"), FILE)


def controllers() -> dict[str, Controller]:
    """Slug -> row of all that there are; one of the user's own takes the place of that of the same name.

    Raises KindynaError where a row of the user's is wrong, FileError where that file cannot be read.
    """
    made = shipped()
    own = settings_folder() / FILE
    if own.exists():
        made |= rows_of(read_text(own), str(own))
    return made


def controller(slug: str) -> Controller:
    """One row. Raises KindynaError, and as ``controllers``."""
    there = controllers()
    if slug not in there:
        raise KindynaError(f"--controller {slug}: no row of that name; allowed: {' | '.join(there)}")
    return there[slug]
