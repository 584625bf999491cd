"""Controllers of electronic cams: their interpolations, the rows of ``controllers.toml``, and text templates.

A template holds placeholders ``{name}`` of listed names only, and ``{{`` and ``}}`` for braces.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, field, fields
from functools import lru_cache
from itertools import chain, cycle
from types import MappingProxyType
from typing import Any

import numpy as np

from core.errors import MISSING as ABSENT
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.process import resources, user_folder
from core.project import parsed
from core.project.files import read_text
from core.project.reading_faults import did_you_mean

# -- templates --------------------------------------------------------------------------------------------------


_PART = re.compile(r"(\{\{|\}\}|[^{}]+)|\{([A-Za-z_]+)\}|[{}]")


@lru_cache(maxsize=512)
def placeholders(template: str) -> tuple[tuple[str, str], ...]:
    """Parts of a template: a text and the placeholder behind it; the last placeholder is empty.

    Raises ValueError for any other brace.
    """
    parts, text = list[tuple[str, str]](), ""
    for match in _PART.finditer(template):
        literal, name = match.groups()
        if name is not None:
            parts.append((text, name))
            text = ""
        elif literal is None:
            raise ValueError(f"{template[match.start() : match.start() + 20]!r} is no placeholder")
        else:
            text += literal[0] if literal in ("{{", "}}") else literal
    return (*parts, (text, ""))


def placeholder_names(template: str) -> frozenset[str]:
    """Names of the placeholders of a template. Raises ValueError as `placeholders`."""
    return frozenset(name for _, name in placeholders(template) if name)


def fill(template: str, values: Mapping[str, str]) -> str:
    """A template with its values; ``...`` where there is none."""
    return "".join(text + (values.get(name, "...") if name else "") for text, name in placeholders(template))


def fill_rows(template: str, values: Mapping[str, str], columns: Mapping[str, list[str]], count: int) -> Iterator[str]:
    """The template ``count`` times, with the values of a row at the placeholders of ``columns``."""
    parts: list[list[str]] = []
    for text, name in placeholders(template):
        parts += [[text] * count] if text else []
        parts += [columns[name] if name in columns else [values.get(name, "...")] * count] if name else []
    return map("".join, zip(*parts, strict=True))


# -- interpolation between the rows of a table ------------------------------------------------------------------


REACH = 14  # rows: a disturbance of a spline decreases by 2 - √3 from row to row, here to 1e-8


@frozen(eq=False)
class Table:
    """Rows of one turn, including both ends.

    Attributes
    ----------
    x : (n,) master angles [deg]
    states : (3, n) value, velocity and acceleration [unit, per degree]; arbitrary where the interpolation does not use them
    slopes : slopes of a clamped spline at both ends [unit/deg]
    """

    x: np.ndarray
    states: np.ndarray
    slopes: tuple[float, float] = (0.0, 0.0)


def linear(table: Table) -> np.ndarray:
    """Straight lines between the rows.

    Returns
    -------
    ndarray (2, n - 1) [unit/degᵏ]
        Coefficients of the powers k of the angle from the start of a piece.
    """
    s = table.states[0]
    return np.array([s[:-1], np.diff(s) / np.diff(table.x)])


def cubic_hermite(table: Table) -> np.ndarray:
    """Cubics through value and velocity at both ends of a piece.

    Returns
    -------
    ndarray (4, n - 1) [unit/degᵏ]
        Coefficients of the powers k of the angle from the start of a piece.
    """
    h, (s, v) = np.diff(table.x), table.states[:2]
    rise, v0, v1 = np.diff(s) / h, v[:-1], v[1:]
    return np.array([s[:-1], v0, (3.0 * rise - 2.0 * v0 - v1) / h, (v0 + v1 - 2.0 * rise) / h**2])


def quintic_hermite(table: Table) -> np.ndarray:
    """Quintics through value, velocity and acceleration at both ends of a piece.

    Returns
    -------
    ndarray (6, n - 1) [unit/degᵏ]
        Coefficients of the powers k of the angle from the start of a piece.
    """
    h, (s, v, a) = np.diff(table.x), table.states
    # remainders of value, velocity and acceleration at the end, multiplied by powers of h to the unit of the value
    d0 = np.diff(s) - h * (v[:-1] + 0.5 * h * a[:-1])
    d1 = h * (np.diff(v) - h * a[:-1])
    d2 = h**2 * np.diff(a)
    return np.array(
        [s[:-1], v[:-1], 0.5 * a[:-1],
         (10.0 * d0 - 4.0 * d1 + 0.5 * d2) / h**3, (-15.0 * d0 + 7.0 * d1 - d2) / h**4, (6.0 * d0 - 3.0 * d1 + 0.5 * d2) / h**5]
    )  # fmt: skip


def clamped_spline(table: Table) -> np.ndarray:
    """Cubic spline with given slopes at both ends: velocity and acceleration are continuous.

    Returns
    -------
    ndarray (4, n - 1) [unit/degᵏ]
        Coefficients of the powers k of the angle from the start of a piece.
    """
    from scipy.interpolate import CubicSpline

    ends = ((1, table.slopes[0]), (1, table.slopes[1]))
    return np.asarray(CubicSpline(table.x, table.states[0], bc_type=ends).c[::-1])


def equal_step_splines(h: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Clamped splines of many tables with equal steps; the slopes at both ends are those of the table.

    Parameters
    ----------
    h : ndarray (k,) [deg]
        Steps of the tables.
    states : ndarray (2, n, k) [unit, unit/deg]
        Value and velocity of the rows.

    Returns
    -------
    ndarray (4, n - 1, k) [unit/degʲ]
        Coefficients of the powers j of the angle from the start of a piece.
    """
    from scipy.interpolate import CubicSpline

    s, v = states[:2]
    spline = CubicSpline(np.arange(s.shape[0]), s, bc_type=((1, v[0] * h), (1, v[-1] * h)))
    return np.asarray(spline.c[::-1] / h ** np.arange(4)[:, None, None])


def zebra(table: Table) -> np.ndarray:
    """Quintic and straight segments in turn, the last one straight.

    A quintic has the slopes of its straight neighbours, and no acceleration at its ends (ISG kernel; inferred).

    Returns
    -------
    ndarray (6, n - 1) [unit/degᵏ]
        Coefficients of the powers k of the angle from the start of a piece.
    """
    slope = np.diff(table.states[0]) / np.diff(table.x)
    is_straight = np.arange(slope.size) % 2 == 1
    v = np.empty(table.x.size)
    v[1:][is_straight] = slope[is_straight]
    v[:-1][is_straight] = slope[is_straight]
    v[0], v[-1] = v[-1], v[-1]
    quintic = quintic_hermite(Table(table.x, np.array([table.states[0], v, np.zeros(v.size)])))
    return np.where(is_straight, np.concatenate([linear(table), np.zeros((4, slope.size))]), quintic)


@frozen
class Interpolation:
    """One row of ``KINDS``.

    Attributes
    ----------
    coefficients : coefficients of the pieces of a table
    order : the error of the value decreases as this power of the step
    through : number of derivatives (value, velocity, acceleration) that it interpolates
    needs : number of derivatives that it uses
    derivatives : number of derivatives that it has
    jump : error of the value by one row at a jump of velocity or acceleration, relative to h|Δv| and h²|Δa|
    reach : number of rows on either side that influence a piece, where all rows do
    of_equal_steps : coefficients of many tables with equal steps
    """

    coefficients: Callable[[Table], np.ndarray]
    order: int
    through: int
    needs: int
    derivatives: int = 3
    jump: tuple[float, float] = (0.0, 0.0)
    reach: int = 0
    of_equal_steps: Callable[[np.ndarray, np.ndarray], np.ndarray] = equal_step_splines


KINDS: Mapping[str, Interpolation] = MappingProxyType(
    {
        "linear": Interpolation(linear, 2, 1, 1, 2, (0.25, 0.125)),
        "cubic-hermite": Interpolation(cubic_hermite, 4, 2, 2, 3, (4.0 / 27.0, 0.01615)),
        "clamped-spline": Interpolation(clamped_spline, 4, 1, 2, 3, (0.25, 0.125), REACH),
        "quintic-hermite": Interpolation(quintic_hermite, 6, 3, 3, 3, (16.0 / 81.0, 0.01728)),
        "zebra": Interpolation(zebra, 2, 1, 1, 3, (0.25, 0.125)),
    }
)
"""Interpolation of a controller's row -> its equations; none for ``unknown``."""


def evaluate(coefficients: np.ndarray, w: np.ndarray, orders: int = 3) -> np.ndarray:
    """Value and derivatives of polynomials, by Horner's scheme.

    Parameters
    ----------
    coefficients : ndarray (k, ...) [unit/degʲ]
        Coefficients of the powers j, lowest first.
    w : ndarray (...) [deg]
        Angles from the start of a piece; both arrays broadcast.
    orders : int
        Number of derivatives, the value included.

    Returns
    -------
    ndarray (orders, ...) [unit, per degree]
    """
    derivatives = []
    for _ in range(orders):
        value = np.zeros(np.broadcast_shapes(coefficients.shape[1:], w.shape))
        for row in coefficients[::-1]:
            value = value * w + row
        derivatives.append(value)
        k = np.arange(1, coefficients.shape[0]).reshape(-1, *([1] * (coefficients.ndim - 1)))
        coefficients = coefficients[1:] * k if coefficients.shape[0] > 1 else np.zeros_like(coefficients)
    return np.array(derivatives)


# -- controllers of electronic cams -----------------------------------------------------------------------------


INTERPOLATIONS = ("linear", "cubic-hermite", "clamped-spline", "quintic-hermite", "zebra", "unknown")
"""Interpolations between two rows; ``unknown``: no source states it."""
UNKNOWN = "unknown"
COLUMNS = ("index", "master", "slave", "velocity", "acceleration", "jerk")
REQUIRED_COLUMNS = {"linear": (), "cubic-hermite": ("velocity",), "clamped-spline": (), "zebra": (), UNKNOWN: (),
          "quintic-hermite": ("velocity", "acceleration")}  # fmt: skip
"""Interpolation -> the columns that it requires in addition to the slave."""
_TABLE_NAMES = frozenset(
    {"rows", "last", "name", "Name", "sep", "interpolation", "master_start", "master_end", "slave_start", "slave_end",
     "master_factor", "master_offset", "slave_factor", "slave_offset", "start_slope", "end_slope"}
)  # fmt: skip
_ROW_NAMES = frozenset({*COLUMNS, "sep", "last", "interpolation"})
FILE = "controllers.toml"
MOST_ROWS, LARGEST_ROWS = 100_000, 10_000_000
"""Default of the largest number of rows in a table, and its upper limit."""
LONGEST, MOST_TEXTS = 10_000, 100
"""Largest number of characters in a text, and of texts in a list."""
ENCODINGS = ("utf-8", "ascii", "latin-1", "cp1252", "utf-16")
_EXTENSION = re.compile(r"\.[A-Za-z0-9._-]{0,15}[A-Za-z0-9_-]")


@frozen
class Controller:
    """One row of ``controllers.toml``.

    Attributes
    ----------
    interpolation : possible settings between two rows, the default first
    interpolation_asked : whether there is no default
    words : interpolation -> its word for {interpolation} in the file
    columns : columns of a row; tables of equal steps have no master
    header, row, footer : templates
    between : texts between two rows, used in turn; first_between : text between the first two, where it differs
    comment : beginning of a comment, which readers skip
    decimal : decimal mark; point : whether a whole number has it too, as in 12.0
    digits : digits of the largest number of a column, whose decimals hold for all; integer : no decimals
    unit : value of 1 in the file, of master and slave
    equal_steps : the master advances by equal steps; step_units : steps that are allowed
    closes : the last row of a periodic table is the end of the turn and repeats its start
    first_row, last_row : "start" or "one-step" after it; "end" or "before-end" by one step
    open : facts that no source states
    normalised : master and slave from 0 to 1; last_is_one : scaled so that the last row is 1, 1
    rows : least and largest number of rows; least_step : least step of the master [deg]
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
    def has_both_ends(self) -> bool:
        """Whether both ends of the turn have a row."""
        return self.closes and self.first_row == "start" and self.last_row == "end"

    def separators(self) -> Iterator[str]:
        """Texts between a row and the next, without end."""
        return chain(() if self.first_between is None else (self.first_between,), cycle(self.between))

    def select_interpolation(self, interpolation: str | None) -> str:
        """Interpolation between two rows. Raises KindynaError where it is not available, or is missing and has no default."""
        if interpolation is None and not self.interpolation_asked:
            return self.interpolation[0]
        if interpolation not in self.interpolation:
            problem = "is required" if interpolation is None else f"{interpolation}: {self.slug} does not support it"
            raise KindynaError(f"--interpolation {problem}; allowed: {' | '.join(self.interpolation)}")
        return interpolation


def _is_text_list(value: Any) -> bool:
    return isinstance(value, list) and len(value) <= MOST_TEXTS and all(map(_is_text, value))


def _is_count_list(value: Any) -> bool:
    return isinstance(value, list) and all(type(count) is int and 0 < count <= LARGEST_ROWS for count in value)


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST


def _has_placeholders(text: Any, known: frozenset[str]) -> bool:
    try:
        return _is_text(text) and placeholder_names(text) <= known
    except ValueError:
        return False


_TEXT = (_is_text, f"text of at most {LONGEST} characters")
_FLAG = (lambda value: isinstance(value, bool), "true | false")
_POSITIVE = (lambda value: type(value) in (int, float) and 0.0 < value < 1e9, "> 0, < 1e9")


def _template(known: frozenset[str]) -> tuple[Callable[[Any], bool], str]:
    listed = "} {".join(sorted(known))
    text = f"text with no other placeholders than {{{listed}}}; {{{{ and }}}} for braces"
    return lambda value: _has_placeholders(value, known), text


def _one_of(*words: str) -> tuple[Callable[[Any], bool], str]:
    return lambda value: value in words, " | ".join(map(repr, words))


def _some_of(words: tuple[str, ...]) -> tuple[Callable[[Any], bool], str]:
    return (
        lambda value: _is_text_list(value) and bool(value) and set(value) <= {*words},
        f"a list of {', '.join(words)}",
    )


_ALLOWED: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "slug": (lambda value: _is_text(value) and value != "" and value.replace("-", "").isalnum(), "letters, digits and -"),
    "label": _TEXT, "source": _TEXT, "header": _template(_TABLE_NAMES), "footer": _template(_TABLE_NAMES),
    "row": _template(_ROW_NAMES),
    "between": (lambda value: _is_text(value) or (_is_text_list(value) and bool(value)), "text, or a list of texts"),
    "first_between": _TEXT, "unit": _POSITIVE, "least_step": _POSITIVE,
    "words": (lambda value: isinstance(value, dict) and set(value) <= {*INTERPOLATIONS} and all(map(_is_text, value.values())),
              "words of interpolations"),
    "interpolation": _some_of(INTERPOLATIONS), "interpolation_asked": _FLAG, "columns": _some_of(COLUMNS),
    "comment": _TEXT, "separator": _TEXT, "decimal": _one_of(".", ","), "newline": _one_of("\n", "\r\n", "\r"),
    "encoding": _one_of(*ENCODINGS),
    "digits": (lambda value: type(value) is int and 1 <= value <= 17, "1 ... 17"), "integer": _FLAG, "point": _FLAG,
    "equal_steps": _FLAG, "step_units": (_is_count_list, "a list of whole numbers > 0"), "closes": _FLAG,
    "first_row": _one_of("start", "one-step"), "last_row": _one_of("end", "before-end"),
    "open": (_is_text_list, "a list of texts"), "normalised": _FLAG, "last_is_one": _FLAG,
    "rows": (lambda value: _is_count_list(value) and len(value) == 2 and 2 <= value[0] <= value[1] <= LARGEST_ROWS,
             f"[least, most], from 2 on, to {LARGEST_ROWS}"),
    "extension": (lambda value: isinstance(value, str) and bool(_EXTENSION.fullmatch(value)),
                  "a dot, then 1 ... 16 letters, digits, dots, _ or -, no dot at the end, such as .txt"),
}  # fmt: skip


def _controller_row(table: Any, path: str) -> Controller:
    """The row of a table. Raises DesignError with all its faults."""
    if not isinstance(table, dict):
        raise DesignError([Fault(path, table, "no table", "[[controllers]]")])
    known = {entry.name: entry for entry in fields(Controller)}
    faults = [
        Fault(f"{path}.{key}", value, "unknown key", ", ".join(known))
        for key, value in table.items()
        if key not in known
    ]
    faults += [
        Fault(f"{path}.{name}", ABSENT, "is missing", _ALLOWED[name][1])
        for name, entry in known.items()
        if entry.default is MISSING and entry.default_factory is MISSING and name not in table
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
    _require_consistent(row, table, path)
    return row


def _require_consistent(row: Controller, table: Mapping[str, Any], path: str) -> None:
    """Raises DesignError where keys of a row contradict each other."""
    faults = []
    listed = placeholder_names(row.row)
    if "slave" not in row.columns:
        faults.append(Fault(f"{path}.columns", table["columns"], "no slave", "a list with slave"))
    faults.extend(
        Fault(
            f"{path}.row",
            row.row,
            f"lacks {{{name}}}, which is one of the columns",
            "a placeholder for each column",
        )
        for name in row.columns
        if name not in listed
    )
    faults.extend(
        Fault(f"{path}.columns", table["columns"], f"lacks {name}, which is in row", "a column for each placeholder")
        for name in sorted(listed & {*COLUMNS} - {*row.columns})
    )
    for method in row.interpolation:
        missing = [name for name in REQUIRED_COLUMNS[method] if name not in row.columns]
        if missing:
            problem = f"requires the column {missing[0]}"
            faults.append(Fault(f"{path}.interpolation", method, problem, "an interpolation of its columns"))
    if "master" not in row.columns and not row.equal_steps:
        faults.append(Fault(f"{path}.equal_steps", row.equal_steps, "rows without a master need equal steps", "true"))
    if faults:
        raise DesignError(faults)


# -- rows of the program and of the user ------------------------------------------------------------------


def parse_rows(text: str, source: str) -> dict[str, Controller]:
    """Slug -> row of a file's text. Raises KindynaError with a line for each fault, which names the field."""
    table = parsed(text, source)
    listed = table.get("controllers", [])
    if set(table) - {"controllers"} or not isinstance(listed, list):
        raise KindynaError(f"{source}: holds [[controllers]] and nothing else")
    result: dict[str, Controller] = {}
    for number, entry in enumerate(listed):
        path = f"controllers[{number}]"
        try:
            row = _controller_row(entry, path)
        except DesignError as error:
            slug = entry.get("slug") if isinstance(entry, dict) else None
            named = f"{source}: {slug[:60]}" if isinstance(slug, str) and slug.isprintable() else source
            raise KindynaError("\n".join(f"{named}: {line}" for line in str(error).splitlines())) from error
        if row.slug in result:
            raise KindynaError(f"{source}: {path}.slug = {row.slug!r}: is given twice; allowed: one row of each name")
        result[row.slug] = row
    return result


def shipped_controllers() -> dict[str, Controller]:
    """Slug -> row of the resources."""
    return parse_rows((resources() / FILE).read_text("utf-8"), FILE)


def controllers() -> dict[str, Controller]:
    """Slug -> row of all controllers; a row of the user replaces the one with the same name.

    Raises KindynaError where a row of the user is wrong, FileError where the file cannot be read.
    """
    result = shipped_controllers()
    user_file = user_folder("settings") / FILE
    if user_file.exists():
        result |= parse_rows(read_text(user_file), str(user_file))
    return result


def controller(slug: str) -> Controller:
    """The row of a controller. Raises KindynaError, and as `controllers`."""
    available = controllers()
    if slug not in available:
        near = did_you_mean(slug, available)
        raise KindynaError(f"--controller {slug}: no row of that name{near}; allowed: {' | '.join(available)}")
    return available[slug]
