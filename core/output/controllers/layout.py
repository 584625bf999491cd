"""Files of controllers: one writer and one reader, both driven by the keys of a controller's row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import field
from itertools import chain, islice

import numpy as np

from core.bounds import BYTES, ROWS
from core.errors import KindynaError
from core.frozen import frozen
from core.number_text import result_text
from core.output.controllers.rows import Controller, fill, fill_rows, placeholders

LARGEST_COUNT = 2**31 - 1
_BLANKS, _SPACE = re.compile(r"[ \t]{2,}+"), re.compile(r"\s*+")
_IDENTIFIER = re.compile(r"\W+", re.ASCII)


@frozen(eq=False)
class FileTable:
    """Contents of a file.

    Attributes
    ----------
    master, slave : (n,) columns in the units of the file, normalised values multiplied out
    velocity, acceleration : (n,) derivatives of the slave by the master [file units]; None without such a column
    end_slopes : slopes of a clamped spline; the first and last velocity where the file states none [file units]
    word : word of the interpolation, where the file states it
    name : name of the table
    range : first and last master value of the turn
    """

    master: np.ndarray
    slave: np.ndarray
    velocity: np.ndarray | None = None
    acceleration: np.ndarray | None = None
    end_slopes: tuple[float, float] = (0.0, 0.0)
    word: str = ""
    name: str = ""
    range: tuple[float, float] | None = field(default=None)


# -- numbers -----------------------------------------------------------------------------------------------


def column_decimals(row: Controller, values: np.ndarray) -> int:
    """Decimals of a column in a file: its largest number has ``digits`` digits in all.

    Parameters
    ----------
    row : Controller
    values : ndarray (n,) [file units]
    """
    if row.integer:
        return 0
    largest = float(np.abs(values).max(initial=0.0))
    before = int(np.floor(np.log10(largest))) + 1 if largest > 0.0 else 1
    return max(row.digits - before, 0)


def rounding_error(row: Controller, values: np.ndarray) -> float:
    """Largest error of a column by rounding in a file.

    Parameters
    ----------
    row : Controller
    values : ndarray (n,) [unit of the table]

    Returns
    -------
    float [unit of the table]
    """
    return 0.5 * row.unit * 10.0 ** -column_decimals(row, values / row.unit)


def round_column(row: Controller, values: np.ndarray) -> np.ndarray:
    """A column as it will be read from a file.

    Parameters
    ----------
    row : Controller
    values : ndarray (n,) [unit of the table]

    Returns
    -------
    ndarray (n,) [unit of the table]
    """
    counts = values / row.unit
    return np.asarray(np.round(counts, column_decimals(row, counts)) * row.unit)


def _text(row: Controller, value: float, decimals: int, mark: str) -> str:
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0")
        text = text + "0" if row.point and text.endswith(".") else text.rstrip(".")
    elif row.point and not row.integer:
        text += ".0"
    if not text.strip("-0."):
        text = text.removeprefix("-")
    return text.replace(".", mark)


# -- writing -----------------------------------------------------------------------------------------------


def file_bytes(row: Controller, table: FileTable, name: str, interpolation: str) -> bytes:
    """The file of a table.

    Raises KindynaError where a number exceeds the controller's integers, the file its largest size, or the name its encoding.
    """
    columns, header = _columns(row, table)
    texts = {key: _texts(row, key, column) for key, column in columns.items()}
    word, count = row.words.get(interpolation, ""), table.slave.size
    values = {
        key: _text(row, value, column_decimals(row, np.array([value])), row.decimal) for key, value in header.items()
    }
    identifier = _IDENTIFIER.sub("_", name).strip("_") or "cam"
    identifier = f"cam_{identifier}" if identifier[0].isdigit() else identifier
    shared = {"sep": row.separator, "interpolation": word, "last": str(count - 1)}
    values |= {
        "rows": str(count), "name": identifier, "Name": identifier[:1].upper() + identifier[1:], **shared,
    }  # fmt: skip
    lines = fill_rows(row.row, shared, texts, count)
    first = next(lines)
    if count * (len(first) + len(row.between[0])) > BYTES:
        raise KindynaError(f"{row.slug}: {count} rows make more than {BYTES / 1e6:g} MB; allow fewer rows")
    between = islice(row.separators(), count - 1)
    body = "".join(chain.from_iterable(zip(chain([first], lines), chain(between, [""]), strict=True)))
    text = fill(row.header, values) + body + fill(row.footer, values)
    try:
        return text.replace("\n", row.newline).encode(row.encoding)
    except UnicodeEncodeError as error:
        raise KindynaError(f"{row.slug}: encoding {row.encoding!r} has no {text[error.start]!r}") from error


def _columns(row: Controller, table: FileTable) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """Columns in the units of the file, and the numbers of header and footer."""
    master, slave = table.master, table.slave
    start, end = table.range or (float(master[0]), float(master[-1]))
    x0, x1, y0, y1 = 0.0, row.unit, 0.0, row.unit
    if row.normalised:
        x0, x1 = start, end - start
        y0, y1 = float(slave.min()), float(np.ptp(slave)) or 1.0
        if row.last_is_one:
            y0, y1 = float(slave[0]), float(slave[-1] - slave[0])
            if abs(y1) <= 1e-9 * float(np.ptp(slave)):
                raise KindynaError(
                    f"{row.slug}: its last row is 1, 1, so the slave must not end where it starts; allowed: a slave that advances, "
                    "or --segment N, one that rises or falls"
                )
            reversals = np.flatnonzero(np.diff(slave) / y1 < -1e-12)
            if reversals.size:
                raise KindynaError(
                    f"{row.slug}: its rows ascend from 0 to 1, and the slave reverses at "
                    f"{result_text(master[reversals[0]] / (end - start))} of the master; allowed: --segment N, "
                    "one that rises or falls throughout"
                )
    columns = {
        "index": np.arange(1, slave.size + 1),
        "master": (master - x0) / x1,
        "slave": (slave - y0) / y1,
        "velocity": None if table.velocity is None else table.velocity * x1 / y1,
        "acceleration": None if table.acceleration is None else table.acceleration * x1**2 / y1,
        "jerk": np.zeros(slave.size),
    }
    header = {
        "master_start": start, "master_end": end, "slave_start": float(slave[0]), "slave_end": float(slave[-1]),
        "master_factor": x1, "master_offset": x0, "slave_factor": y1, "slave_offset": y0,
        "start_slope": table.end_slopes[0] * x1 / y1, "end_slope": table.end_slopes[1] * x1 / y1,
    }  # fmt: skip
    result = {key: values for key, values in columns.items() if key in row.columns and values is not None}
    for key, values in result.items():
        if row.integer and float(np.abs(values).max()) > LARGEST_COUNT:
            raise KindynaError(
                f"{row.slug}: {key} reaches {result_text(float(np.abs(values).max()), 5)}; allowed: integers of "
                f"32 bits, up to +-{LARGEST_COUNT}: "
                f"choose a smaller {'--master-per-turn' if key == 'master' else '--slave-scale'}"
            )
    return result, header


def _texts(row: Controller, key: str, values: np.ndarray) -> list[str]:
    if key == "index":
        return [str(i) for i in values.tolist()]
    decimals = column_decimals(row, values)
    return [_text(row, value, decimals, row.decimal) for value in values.tolist()]


def rounded_table(row: Controller, table: FileTable, turn: float) -> FileTable:
    """The table that `read_file` reads from a file of `file_bytes`, without making the file.

    Parameters
    ----------
    row : Controller
    table : FileTable
    turn : float
        Master units in a turn.
    """
    columns, header = _columns(row, table)
    rounded_columns = {key: np.round(values, column_decimals(row, values)) for key, values in columns.items()}
    stated = {key: repr(value) for key, value in header.items() if f"{{{key}}}" in row.header + row.footer}
    return _table(row, rounded_columns, stated, turn)


# -- reading -----------------------------------------------------------------------------------------------


def read_file(row: Controller, data: bytes, turn: float = 360.0) -> FileTable:
    """Contents of a file of this controller.

    Decimal marks, blanks, blank lines, line ends and comments may differ from those of the writer, where they do not separate
    columns. Raises KindynaError, which names the line.

    Parameters
    ----------
    row : Controller
    data : bytes
    turn : float
        Master units in a turn, where the file does not state them.
    """
    try:
        text = data.decode(row.encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        raise KindynaError(f"{row.slug}: byte {error.start + 1} is not {row.encoding}; choose another file") from error
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if row.comment:
        text = re.sub(re.escape(row.comment) + r"[^\n]*", "", text)
    text = _BLANKS.sub(lambda blanks: "\t" if "\t" in blanks[0] else " ", text)
    begin, end = _body(row, text)
    values = _placeholder_values(row, text[:begin], row.header) | _placeholder_values(row, text[end:], row.footer)
    columns = _rows(row, text, begin, end, values)
    count = len(columns["slave"])
    row_count = values.get("rows") or (str(int(values["last"]) + 1) if "last" in values else "")
    if row_count and int(row_count) != count:
        raise KindynaError(
            f"{row.slug}: the file states {row_count} rows and holds {count}; allowed: the stated number"
        )
    if count < 2:
        raise KindynaError(f"{row.slug}: {count} rows; allowed: at least 2")
    return _table(row, columns, values, turn)


def _table(row: Controller, columns: Mapping[str, np.ndarray], values: Mapping[str, str], turn: float) -> FileTable:
    def stated(key: str, default: float) -> float:
        return _value(values[key]) if key in values else default

    x0, x1 = stated("master_offset", 0.0), stated("master_factor", turn if row.normalised else row.unit)
    y0, y1 = stated("slave_offset", 0.0), stated("slave_factor", 1.0 if row.normalised else row.unit)
    count = columns["slave"].size
    if "master" in columns:
        master = x0 + x1 * columns["master"]
        start, end = stated("master_start", float(master[0])), stated("master_end", float(master[-1]))
    else:
        start = stated("master_start", x0)
        end = stated("master_end", x0 + x1 if row.normalised else start + turn)
        master = start + (end - start) * row_positions(row, count)
    if not (np.diff(master) > 0.0).all():
        number = int(np.argmin(np.diff(master) > 0.0)) + 2
        raise KindynaError(
            f"{row.slug}: row {number}: the master does not rise, {master[number - 1]:g}; allowed: more than the row before"
        )
    v, a = columns.get("velocity"), columns.get("acceleration")
    first, last = (0.0, 0.0) if v is None else (float(v[0]), float(v[-1]))
    slopes = stated("start_slope", first) * y1 / x1, stated("end_slope", last) * y1 / x1
    return FileTable(
        master, y0 + y1 * columns["slave"],
        None if v is None else v * y1 / x1, None if a is None else a * y1 / x1**2,
        slopes, values.get("interpolation", ""), values.get("name") or values.get("Name", ""), (start, end),
    )  # fmt: skip


def row_positions(row: Controller, count: int) -> np.ndarray:
    """Positions of rows at equal steps, as parts of the turn.

    Parameters
    ----------
    row : Controller
    count : int
        Number of rows.

    Returns
    -------
    ndarray (count,), dimensionless
    """
    if row.first_row == "one-step":
        return np.arange(1, count + 1) / count
    return np.arange(count) / (count - 1 if row.has_both_ends else count)


def _value(text: str) -> float:
    return float(text.replace(",", ".").translate(str.maketrans("dD", "ee")))


_COUNT_PATTERNS = {"rows": r"\d{1,18}+", "last": r"-?\d{1,18}+", "index": r"\d{1,18}+"}
_WORD_NAMES = ("name", "Name", "interpolation")


def _pattern(row: Controller, text: str) -> str:
    """A template as a regular expression.

    Blanks match any number of blanks, numbers either decimal mark; the first placeholder of a name is a named group. Groups are
    possessive, so that a line is read in linear time.
    """
    parts, seen = [], set()
    separator = row.separator.replace("{", "{{").replace("}", "}}")
    template = placeholders(text.replace("{sep}", separator))
    for (literal, name), (following, _) in zip(template, [*template[1:], ("", "")], strict=True):
        parts.append(_literal(literal.split(row.comment)[0] if row.comment else literal))
        if name:
            is_word = following[:1].isalnum() or following[:1] == "_"  # an identifier may run into this text
            word = r"\w{0,60}" if is_word else r"\w{0,400}+"
            kind = _COUNT_PATTERNS.get(name) or (word if name in _WORD_NAMES else _number(row, following))
            parts.append(kind if name in seen else f"(?P<{name}>{kind})")
            seen.add(name)
    return "".join(parts)


def _number(row: Controller, following: str) -> str:
    """A number in front of a text.

    A decimal mark at the start of that text belongs to the number only where digits follow, and never where it is not the
    controller's decimal mark.
    """
    mark = following[:1] if following[:1] in (".", ",") else ""
    marks = "." if "," in row.separator or mark == "," != row.decimal else "," if mark == "." != row.decimal else ".,"
    digits = "{1,400}" if mark else "{0,400}"
    return rf"(?>[-+]?(?:\d{{1,400}}(?:[{marks}]\d{digits})?|[{marks}]\d{{1,400}})(?:[eEdD][-+]?\d{{1,4}})?)"


def _literal(text: str) -> str:
    """A text in which blanks and tabs are equal, and optional next to marks."""
    parts = re.split(r"([ \t]+)", text)
    result = []
    for i, part in enumerate(parts):
        if not part.strip(" \t"):
            neighbours = parts[i - 1][-1:] + parts[i + 1][:1] if 0 < i < len(parts) - 1 else ""
            is_optional = any(not (c.isalnum() or c == "_") for c in neighbours)
            result.append("" if not part else r"[ \t]*" if is_optional else r"[ \t]+")
        else:
            result.append(re.sub(r"(?:\\[ \t])*=(?:\\[ \t])*", "[ \\\\t]*=[ \\\\t]*", re.escape(part)))
    return "".join(result)


def _template_lines(text: str) -> list[str]:
    return [line for line in text.split("\n") if line.strip()]


def _line(row: Controller, line: str) -> str:
    """A line of a header; between key and value a blank or tab may replace the mark."""
    pattern = _pattern(row, line).strip()
    if row.comment == "#":  # keys and values of the ISG kernel
        pattern = re.sub(r"\[ \\t\]\*=\[ \\t\]\*", r"[ \\t]*[= \\t][ \\t]*", pattern, count=1)
        pattern = re.sub(r"(\[ \\t\]\*)+", r"[ \\t]*", pattern)
    return r"[ \t]*" + pattern


def _body(row: Controller, text: str) -> tuple[int, int]:
    """Start and end of the rows in the text."""
    begin = 0
    if lines := _template_lines(row.header):
        last = lines[-1]
        anchored = last + ("$" if row.header.endswith("\n") else "")
        match = re.search(r"^" + _line(row, last) + (r"[ \t]*$" if anchored != last else ""), text, re.MULTILINE)
        if match is None:
            raise KindynaError(f"{row.slug}: no line like {fill(last, {})!r}; choose a file of this controller")
        begin = match.end()
    end = len(text)
    if lines := _template_lines(row.footer):
        match = re.compile(_line(row, lines[0])).search(text, begin)
        if match is None:
            raise KindynaError(f"{row.slug}: no end like {fill(lines[0], {})!r}; choose a complete file")
        end = match.start()
    return begin, end


def _placeholder_values(row: Controller, text: str, lines: str) -> dict[str, str]:
    """Placeholder -> its text in header or footer, where present."""
    values: dict[str, str] = {}
    for line in _template_lines(lines):
        match = re.search(_line(row, line), text)
        if match is not None:
            values |= match.groupdict()
    return values


def _rows(row: Controller, text: str, begin: int, end: int, values: dict[str, str]) -> dict[str, np.ndarray]:
    """Columns of the rows; texts of other placeholders go to ``values``. Raises KindynaError for text that is not a row."""
    body = text[begin:end]
    pattern = re.compile(r"\s*" + _pattern(row, row.row) + r"[ \t]*")
    if row.separator.strip() == "":
        pattern = re.compile(pattern.pattern.replace(r"\	", r"[ \t]+"))
    columns: dict[str, list[float]] = {name: [] for name in row.columns}
    for match in _matches(row, pattern, body, text.count("\n", 0, begin) + 1):
        for name, column in columns.items():
            column.append(_value(match[name]))
        values |= {name: text for name, text in match.groupdict().items() if name not in columns}
    return {name: np.array(column) for name, column in columns.items()}


def _matches(row: Controller, pattern: re.Pattern[str], body: str, line: int) -> Iterator[re.Match[str]]:
    mark = _separator(row)
    position, end, count, between = 0, len(body.rstrip()), 0, re.compile(rf"\s*+(?:{mark})")
    while position < end:
        match = pattern.match(body, position)
        start = _end_of_match(_SPACE, body, position)
        if match is None:
            text = body[start : start + 60].split("\n", 1)[0]
            raise KindynaError(
                f"{row.slug}: line {line + body.count(chr(10), 0, start)}: {text!r} is no row; allowed: {row.row!r}"
            )
        yield match
        count += 1
        if count > ROWS:
            raise KindynaError(f"{row.slug}: more than {ROWS} rows; allowed: at most {ROWS}")
        position, start = match.end(), _end_of_match(_SPACE, body, match.end())
        if mark:
            position = _end_of_match(between, body, position)
        elif position < end and "\n" not in body[position:start]:
            text = body[position : position + 60].split("\n", 1)[0]
            raise KindynaError(
                f"{row.slug}: line {line + body.count(chr(10), 0, position)}: {text!r} follows the row; allowed: {row.row!r}"
            )


def _separator(row: Controller) -> str:
    """Text between two rows, without blanks, as a regular expression; empty for a new line."""
    texts = dict.fromkeys(text.strip() for text in (row.first_between or "", *row.between))
    return "|".join(r"\s*+".join(map(re.escape, text.split())) for text in sorted(texts, key=len, reverse=True) if text)


def _end_of_match(pattern: re.Pattern[str], text: str, position: int) -> int:
    """End of a pattern at this position; the position itself where it does not match."""
    match = pattern.match(text, position)
    return position if match is None else match.end()
