"""Files of controllers: one writer and one reader, both walk the keys of a controller's row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import field
from itertools import chain, islice

import numpy as np

from core.bounds import BYTES, ROWS
from core.errors import KindynaError
from core.frozen import frozen
from core.output.controllers import rows
from core.output.controllers.rows import Controller

LARGEST_COUNT = 2**31 - 1
_BLANKS, _SPACE = re.compile(r"[ \t]{2,}+"), re.compile(r"\s*+")
_IDENTIFIER = re.compile(r"\W+", re.ASCII)


@frozen(eq=False)
class FileTable:
    """What a file says.

    master, slave, velocity, acceleration  (n,) of its rows, in the units of the file, what is normalised multiplied out; None where
               it has no such column. Velocity and acceleration are by the master
    end_slopes  of a clamped spline, likewise; the first and the last velocity where the file states none
    word       the interpolation, where the file says it
    name       what the file calls the table
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


def decimals_of(row: Controller, values: np.ndarray) -> int:
    """Digits after the mark with which a column (n,) is written: the largest number has ``digits`` of them in all."""
    if row.integer:
        return 0
    largest = float(np.abs(values).max(initial=0.0))
    before = int(np.floor(np.log10(largest))) + 1 if largest > 0.0 else 1
    return max(row.digits - before, 0)


def rounding_of(row: Controller, values: np.ndarray) -> float:
    """By how much a column (n,) is off, at most, when it is written."""
    return 0.5 * row.unit * 10.0 ** -decimals_of(row, values / row.unit)


def rounded(row: Controller, values: np.ndarray) -> np.ndarray:
    """A column (n,) as it will be read."""
    counts = values / row.unit
    return np.asarray(np.round(counts, decimals_of(row, counts)) * row.unit)


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


def written(row: Controller, table: FileTable, name: str, interpolation: str) -> bytes:
    """The file. Raises KindynaError where a number is beyond what the controller's integers hold, or the name beyond its encoding."""
    columns, header = _columns(row, table)
    texts = {key: _texts(row, key, values) for key, values in columns.items()}
    word, count = row.words.get(interpolation, ""), table.slave.size
    places = {key: _text(row, value, decimals_of(row, np.array([value])), row.decimal) for key, value in header.items()}
    plain = _IDENTIFIER.sub("_", name).strip("_") or "cam"
    plain = f"cam_{plain}" if plain[0].isdigit() else plain
    places |= {
        "rows": str(count), "last": str(count - 1), "name": plain, "Name": plain[:1].upper() + plain[1:], "sep": row.separator,
        "interpolation": word,
    }  # fmt: skip
    shared = {"sep": row.separator, "interpolation": word, "last": str(count - 1)}
    lines = rows.rows(row.row, shared, texts, count)
    first = next(lines)
    if count * (len(first) + len(row.between[0])) > BYTES:
        raise KindynaError(f"{row.slug}: {count} rows make more than {BYTES / 1e6:g} MB; allow fewer rows")
    between = islice(row.gaps(), count - 1)
    body = "".join(chain.from_iterable(zip(chain([first], lines), chain(between, [""]), strict=True)))
    text = rows.filled(row.header, places) + body + rows.filled(row.footer, places)
    try:
        return text.replace("\n", row.newline).encode(row.encoding)
    except UnicodeEncodeError as error:
        raise KindynaError(f"{row.slug}: encoding {row.encoding!r} has no {text[error.start]!r}") from error


def _columns(row: Controller, table: FileTable) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """The columns as written, and the numbers of header and footer."""
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
            back = np.flatnonzero(np.diff(slave) / y1 < -1e-12)
            if back.size:
                raise KindynaError(
                    f"{row.slug}: its rows ascend from 0 to 1, and the slave goes back at "
                    f"{master[back[0]] / (end - start):.4g} of the master; allowed: --segment N, one that rises or falls throughout"
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
    made = {key: values for key, values in columns.items() if key in row.columns and values is not None}
    for key, values in made.items():
        if row.integer and float(np.abs(values).max()) > LARGEST_COUNT:
            raise KindynaError(
                f"{row.slug}: {key} reaches {float(np.abs(values).max()):.6g}; allowed: integers of 32 bits, up to +-{LARGEST_COUNT}: "
                f"choose a smaller {'--master-per-turn' if key == 'master' else '--slave-scale'}"
            )
    return made, header


def _texts(row: Controller, key: str, values: np.ndarray) -> list[str]:
    if key == "index":
        return [str(i) for i in values.tolist()]
    decimals = decimals_of(row, values)
    return [_text(row, value, decimals, row.decimal) for value in values.tolist()]


def as_read(row: Controller, table: FileTable, turn: float) -> FileTable:
    """What ``read`` finds in the file that ``written`` makes, without it."""
    columns, header = _columns(row, table)
    rounded_columns = {key: np.round(values, decimals_of(row, values)) for key, values in columns.items()}
    stated = {key: repr(value) for key, value in header.items() if f"{{{key}}}" in row.header + row.footer}
    return _table(row, rounded_columns, stated, turn)


# -- reading -----------------------------------------------------------------------------------------------


def read(row: Controller, data: bytes, turn: float = 360.0) -> FileTable:
    """What a file of this controller says; turn: of its master, where the file itself does not say it.

    Decimal marks, blanks, blank lines, line ends and comments may be others than the writer's, where they are not what separates the
    columns. Raises KindynaError, which names the line.
    """
    try:
        text = data.decode(row.encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        raise KindynaError(f"{row.slug}: no {row.encoding} at byte {error.start + 1}; name another file") from error
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if row.comment:
        text = re.sub(re.escape(row.comment) + r"[^\n]*", "", text)
    text = _BLANKS.sub(lambda blanks: "\t" if "\t" in blanks[0] else " ", text)
    begin, end = _body(row, text)
    places = _places(row, text[:begin], row.header) | _places(row, text[end:], row.footer)
    columns = _rows(row, text, begin, end, places)
    count = len(columns["slave"])
    stated = places.get("rows") or (str(int(places["last"]) + 1) if "last" in places else "")
    if stated and int(stated) != count:
        raise KindynaError(
            f"{row.slug}: the file states {stated} rows and holds {count}; allowed: as many as it states"
        )
    if count < 2:
        raise KindynaError(f"{row.slug}: {count} rows; allowed: at least 2")
    return _table(row, columns, places, turn)


def _table(row: Controller, columns: Mapping[str, np.ndarray], places: Mapping[str, str], turn: float) -> FileTable:
    def stated(key: str, usual: float) -> float:
        return _value(places[key]) if key in places else usual

    x0, x1 = stated("master_offset", 0.0), stated("master_factor", turn if row.normalised else row.unit)
    y0, y1 = stated("slave_offset", 0.0), stated("slave_factor", 1.0 if row.normalised else row.unit)
    count = columns["slave"].size
    if "master" in columns:
        master = x0 + x1 * columns["master"]
        start, end = stated("master_start", float(master[0])), stated("master_end", float(master[-1]))
    else:
        start = stated("master_start", x0)
        end = stated("master_end", x0 + x1 if row.normalised else start + turn)
        master = start + (end - start) * steps(row, count)
    if not (np.diff(master) > 0.0).all():
        place = int(np.argmin(np.diff(master) > 0.0)) + 2
        raise KindynaError(
            f"{row.slug}: row {place}: the master does not rise, {master[place - 1]:g}; allowed: more than the row before"
        )
    v, a = columns.get("velocity"), columns.get("acceleration")
    first, last = (0.0, 0.0) if v is None else (float(v[0]), float(v[-1]))
    slopes = stated("start_slope", first) * y1 / x1, stated("end_slope", last) * y1 / x1
    return FileTable(
        master, y0 + y1 * columns["slave"],
        None if v is None else v * y1 / x1, None if a is None else a * y1 / x1**2,
        slopes, places.get("interpolation", ""), places.get("name") or places.get("Name", ""), (start, end),
    )  # fmt: skip


def steps(row: Controller, count: int) -> np.ndarray:
    """Where equal rows stand (n,), as parts of the turn."""
    if row.first_row == "one-step":
        return np.arange(1, count + 1) / count
    return np.arange(count) / (count - 1 if row.closing else count)


def _value(text: str) -> float:
    return float(text.replace(",", ".").translate(str.maketrans("dD", "ee")))


_COUNTS = {"rows": r"\d{1,18}+", "last": r"-?\d{1,18}+", "index": r"\d{1,18}+"}
_WORDS = ("name", "Name", "interpolation")


def _pattern(row: Controller, text: str) -> str:
    """A template as a regular expression: blanks as many as there are, a place once by its name, numbers with either mark. What a place
    has taken it does not give back, so that a line is read in one go."""
    parts, seen = [], set()
    separator = row.separator.replace("{", "{{").replace("}", "}}")
    places = rows.places(text.replace("{sep}", separator))
    for (literal, name), (behind, _) in zip(places, [*places[1:], ("", "")], strict=True):
        parts.append(_literal(literal.split(row.comment)[0] if row.comment else literal))
        if name:
            kind = _COUNTS.get(name) or (_word(behind) if name in _WORDS else _number(row, behind))
            parts.append(kind if name in seen else f"(?P<{name}>{kind})")
            seen.add(name)
    return "".join(parts)


def _word(behind: str) -> str:
    """An identifier before a text, which it may run into."""
    return r"\w{0,60}" if behind[:1].isalnum() or behind[:1] == "_" else r"\w{0,400}+"


def _number(row: Controller, behind: str) -> str:
    """A number before a text: a mark with which that begins belongs to the number only where digits follow it, or not at all where it
    is not the controller's decimal mark."""
    mark = behind[:1] if behind[:1] in (".", ",") else ""
    marks = "." if "," in row.separator or mark == "," != row.decimal else "," if mark == "." != row.decimal else ".,"
    some = "{1,400}" if mark else "{0,400}"
    return rf"(?>[-+]?(?:\d{{1,400}}(?:[{marks}]\d{some})?|[{marks}]\d{{1,400}})(?:[eEdD][-+]?\d{{1,4}})?)"


def _literal(text: str) -> str:
    """Blanks and tabs alike; around marks they may be or not."""
    parts = re.split(r"([ \t]+)", text)
    made = []
    for i, part in enumerate(parts):
        if not part.strip(" \t"):
            beside = parts[i - 1][-1:] + parts[i + 1][:1] if 0 < i < len(parts) - 1 else ""
            loose = any(not (c.isalnum() or c == "_") for c in beside)
            made.append("" if not part else r"[ \t]*" if loose else r"[ \t]+")
        else:
            made.append(re.sub(r"(?:\\[ \t])*=(?:\\[ \t])*", "[ \\\\t]*=[ \\\\t]*", re.escape(part)))
    return "".join(made)


def _template_lines(text: str) -> list[str]:
    return [line for line in text.split("\n") if line.strip()]


def _line(row: Controller, line: str) -> str:
    """A line of a header; where it is a key and its value, a blank or a tab may stand for the mark between them."""
    pattern = _pattern(row, line).strip()
    if row.comment == "#":  # keys and values of the ISG kernel
        pattern = re.sub(r"\[ \\t\]\*=\[ \\t\]\*", r"[ \\t]*[= \\t][ \\t]*", pattern, count=1)
        pattern = re.sub(r"(\[ \\t\]\*)+", r"[ \\t]*", pattern)
    return r"[ \t]*" + pattern


def _body(row: Controller, text: str) -> tuple[int, int]:
    """Where the rows begin and end."""
    begin = 0
    if lines := _template_lines(row.header):
        last = lines[-1]
        whole = last + ("$" if row.header.endswith("\n") else "")
        found = re.search(r"^" + _line(row, last) + (r"[ \t]*$" if whole != last else ""), text, re.MULTILINE)
        if found is None:
            raise KindynaError(f"{row.slug}: no line as {rows.filled(last, {})!r}; name a file of this controller")
        begin = found.end()
    end = len(text)
    if lines := _template_lines(row.footer):
        found = re.compile(_line(row, lines[0])).search(text, begin)
        if found is None:
            raise KindynaError(f"{row.slug}: no end as {rows.filled(lines[0], {})!r}; name a whole file")
        end = found.start()
    return begin, end


def _places(row: Controller, text: str, lines: str) -> dict[str, str]:
    """What stands at the places of header or footer, as far as it is there."""
    found: dict[str, str] = {}
    for line in _template_lines(lines):
        match = re.search(_line(row, line), text)
        if match is not None:
            found |= match.groupdict()
    return found


def _rows(row: Controller, text: str, begin: int, end: int, places: dict[str, str]) -> dict[str, np.ndarray]:
    """The columns; what else a row says goes to the places. Raises KindynaError where something else stands among the rows."""
    body = text[begin:end]
    pattern = re.compile(r"\s*" + _pattern(row, row.row) + r"[ \t]*")
    if row.separator.strip() == "":
        pattern = re.compile(pattern.pattern.replace(r"\	", r"[ \t]+"))
    found: dict[str, list[float]] = {name: [] for name in row.columns}
    for match in _matches(row, pattern, body, text.count("\n", 0, begin) + 1):
        for name, values in found.items():
            values.append(_value(match[name]))
        places |= {name: text for name, text in match.groupdict().items() if name not in found}
    return {name: np.array(values) for name, values in found.items()}


def _matches(row: Controller, pattern: re.Pattern[str], body: str, line: int) -> Iterator[re.Match[str]]:
    mark = _between(row)
    place, end, count, between = 0, len(body.rstrip()), 0, re.compile(rf"\s*+(?:{mark})")
    while place < end:
        match = pattern.match(body, place)
        at = _behind(_SPACE, body, place)
        if match is None:
            text = body[at : at + 60].split("\n", 1)[0]
            raise KindynaError(
                f"{row.slug}: line {line + body.count(chr(10), 0, at)}: {text!r} is no row; allowed: as in {row.row!r}"
            )
        yield match
        count += 1
        if count > ROWS:
            raise KindynaError(f"{row.slug}: more than {ROWS} rows; allowed: at most {ROWS}")
        place, at = match.end(), _behind(_SPACE, body, match.end())
        if mark:
            place = _behind(between, body, place)
        elif place < end and "\n" not in body[place:at]:
            text = body[place : place + 60].split("\n", 1)[0]
            raise KindynaError(
                f"{row.slug}: line {line + body.count(chr(10), 0, place)}: {text!r} is too much; allowed: as in {row.row!r}"
            )


def _between(row: Controller) -> str:
    """What stands between two rows, but for blanks, as a regular expression; empty where it is a new line."""
    texts = dict.fromkeys(text.strip() for text in (row.first_between or "", *row.between))
    return "|".join(r"\s*+".join(map(re.escape, text.split())) for text in sorted(texts, key=len, reverse=True) if text)


def _behind(pattern: re.Pattern[str], text: str, at: int) -> int:
    """Where a pattern that stands at a place ends; that place where it does not."""
    match = pattern.match(text, at)
    return at if match is None else match.end()


__all__ = ["FileTable", "as_read", "decimals_of", "read", "rounded", "rounding_of", "steps", "written"]
