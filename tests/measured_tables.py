"""Measured lift tables with wrong runs of rows, each made from a seed; and tables in workbooks."""

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from math import log10, sqrt
from pathlib import Path

import numpy as np
from mechanisms import levels

from core.design import Motion
from core.motion import program

LAWS = (
    "parabolic", "simple-harmonic", "cycloidal", "modified-sine", "modified-trapezoid", "3-4-5", "4-5-6-7", "mcv50", "gutman-1-3",
)  # fmt: skip
SHAPES = ("zeros", "shifted", "held", "spikes", "decimal point")
LEAST_ERRORS, LEAST_SHARE = 10.0, 0.02  # how far off the worst row of a run is at least: in errors, of the stroke
APART = 3  # right rows between two runs, at least


@dataclass(frozen=True)
class WrongTable:
    """A table of ``rows`` rows over one turn, cam angles [deg], values [mm].

    motion  that was measured, ``turn`` degrees before
    right   (n,) as measured; values: as they stand in the table
    error   standard deviation of right
    runs    numbers of the rows of each wrong run, some of which may be right by chance
    """

    motion: Motion
    turn: float
    right: np.ndarray
    values: np.ndarray
    error: float
    shapes: tuple[str, ...]
    runs: tuple[np.ndarray, ...]

    @property
    def angles(self) -> np.ndarray:
        return 360.0 * np.arange(self.right.size) / self.right.size

    @property
    def wrong(self) -> np.ndarray:
        return self.values != self.right

    def text(self, values: np.ndarray) -> str:
        rows = zip(self.angles.tolist(), values.tolist(), strict=True)
        return "angle [deg],lift [mm]\n" + "".join(f"{a!r},{v!r}\n" for a, v in rows)

    def beyond_doubt(self) -> np.ndarray:
        """Rows (n,) that are off by more than a curve from the last right row, g rows away, may be: by ten errors, by
        two more for each row, as no slope is known better, and by what an acceleration between -A and A, the largest of
        the motion, can make: 2 A g (g + 1)/2."""
        n = self.right.size
        gone = np.abs(np.arange(n)[:, None] - np.flatnonzero(~self.wrong))
        rows = np.minimum(gone, n - gone).min(axis=1)
        fine = position(self.motion, self.turn + np.arange(0.0, 360.0, 0.25))
        largest = np.abs(np.diff(fine, 2)).max() * (4.0 * 360.0 / n) ** 2
        off = np.abs(self.values - self.right)
        return off > (LEAST_ERRORS + 2.0 * rows) * self.error + largest * rows * (rows + 1)


def position(motion: Motion, angles: np.ndarray) -> np.ndarray:
    """Of a motion at cam angles [deg], in its own unit."""
    compiled = program(motion)
    return compiled.state(compiled.angles(np.deg2rad(np.mod(angles, 360.0)))).y[0] / motion.scale


def wrong_table(seed: int, count: int = 360) -> WrongTable:
    """A lift of 3 ... 50 mm with dwells, laws of every kind, an error of 0.001 ... 0.02 mm, and one or two wrong runs."""
    chance = np.random.default_rng(seed)
    motion = _lift(chance)
    turn = float(chance.uniform(0.0, 360.0))
    right = position(motion, turn + 360.0 * np.arange(count) / count) + chance.choice([0.0, 5.0])
    error = float(10.0 ** chance.uniform(-3.0, log10(0.02)))
    if chance.random() < 0.3:  # rounding alone
        right = np.round(right / (error * sqrt(12.0))) * error * sqrt(12.0)
    else:
        right = right + error * chance.normal(size=count)
    made = WrongTable(motion, turn, right, right, error, (), ())
    values, runs, shapes = spoiled(chance, made, [(1, 16)] * int(chance.integers(1, 3)))
    return WrongTable(motion, turn, right, values, error, tuple(shapes), tuple(runs))


def spoiled(
    chance: np.random.Generator, table: WrongTable, lengths: Sequence[tuple[int, int]]
) -> tuple[np.ndarray, list[np.ndarray], list[str]]:
    """The values of a table with a run of wrong rows for each length, from the first on and below the second; its rows, and its shape."""
    right, count = table.right, table.right.size
    values, runs, shapes = right.copy(), [], []
    ends = np.cumsum([s.span_deg for s in table.motion.segments]) - table.turn
    stroke = float(np.ptp(right))
    least = max(LEAST_ERRORS * table.error, LEAST_SHARE * stroke)
    while len(runs) < len(lengths):
        rows = np.mod(_first(chance, ends, count) + np.arange(chance.integers(*lengths[len(runs)])), count)
        beside = np.mod(np.arange(rows[0] - APART, rows[0] + rows.size + APART), count)
        shape = str(chance.choice(SHAPES))
        made = _made(chance, shape, values[rows], values[rows[0] - 1], least, stroke)
        if (values != right)[beside].any() or np.abs(made - right[rows]).max() < least:
            continue
        values[rows] = made
        runs.append(rows)
        shapes.append(shape)
    return values, runs, shapes


def _lift(chance: np.random.Generator) -> Motion:
    """Dwell, rise, dwell, return, half of them in two steps."""
    while True:
        spans = chance.uniform([20.0, 40.0, 10.0, 40.0, 10.0], [120.0, 120.0, 110.0, 120.0, 60.0])
        spans *= 360.0 / spans.sum()
        if min(spans[1], spans[3] / 2.0) >= 35.0:
            break
    stroke = chance.uniform(3.0, 50.0)
    between = stroke * chance.uniform(0.3, 0.7) if chance.random() < 0.5 else 0.0
    first, rise, high, back, low = spans.tolist()
    laws = [str(chance.choice(LAWS)) for _ in range(3)]
    if between:
        fall = [(back / 2.0, between, laws[1]), (low, between, "dwell"), (back / 2.0, 0.0, laws[2])]
    else:
        fall = [(back, 0.0, laws[1]), (low, 0.0, "dwell")]
    return levels(0.0, (first, 0.0, "dwell"), (rise, stroke, laws[0]), (high, stroke, "dwell"), *fall)


def _first(chance: np.random.Generator, ends: np.ndarray, count: int) -> int:
    """The first row of a run: near the end of a segment, across 0/360, or anywhere."""
    place = chance.random()
    if place < 0.3:
        return round(float(chance.choice(ends)) * count / 360.0) - int(chance.integers(0, 16))
    return -int(chance.integers(0, 16)) if place < 0.4 else int(chance.integers(0, count))


def _made(
    chance: np.random.Generator, shape: str, values: np.ndarray, before: float, least: float, stroke: float
) -> np.ndarray:
    """Wrong values in place of those of a run."""
    size = float(10.0 ** chance.uniform(log10(least), log10(stroke)))
    if shape == "zeros":
        return np.zeros(values.size)
    if shape == "shifted":
        return values + size * chance.choice([-1.0, 1.0])
    if shape == "held":
        return np.full(values.size, before)
    if shape == "spikes":
        return values + size * chance.choice([-1.0, 1.0], values.size) * chance.uniform(0.5, 1.5, values.size)
    return values * chance.choice([0.1, 10.0])


MAIN = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"


def workbook(path: Path, sheets: dict[str, list[list[object]]]) -> None:
    """The least .xlsx: texts in their cells, no styles."""

    def cell(column: int, row: int, value: object) -> str:
        place = f"{chr(65 + column)}{row}"
        if isinstance(value, float):
            return f'<c r="{place}"><v>{value!r}</v></c>'
        return f'<c r="{place}" t="inlineStr"><is><t>{value}</t></is></c>'

    def link(key: str, kind: str, target: str) -> str:
        return f'<Relationship Id="{key}" Type="{OFFICE}/{kind}" Target="{target}"/>'

    def links(*inside: str) -> str:
        return f'<Relationships xmlns="{PACKAGE}/relationships">{"".join(inside)}</Relationships>'

    with zipfile.ZipFile(path, "w") as book:
        types = '<Default Extension="xml" ContentType="application/xml"/>'
        book.writestr("[Content_Types].xml", f'<Types xmlns="{PACKAGE}/content-types">{types}</Types>')
        book.writestr("_rels/.rels", links(link("r", "officeDocument", "xl/workbook.xml")))
        names = "".join(f'<sheet name="{name}" sheetId="{i}" r:id="s{i}"/>' for i, name in enumerate(sheets, 1))
        book.writestr("xl/workbook.xml", f'<workbook {MAIN} xmlns:r="{OFFICE}"><sheets>{names}</sheets></workbook>')
        parts = (link(f"s{i}", "worksheet", f"worksheets/s{i}.xml") for i in range(1, len(sheets) + 1))
        book.writestr("xl/_rels/workbook.xml.rels", links(*parts))
        for i, rows in enumerate(sheets.values(), 1):
            cells = (
                f'<row r="{n}">{"".join(cell(k, n, v) for k, v in enumerate(row))}</row>'
                for n, row in enumerate(rows, 1)
            )
            content = f"<worksheet {MAIN}><sheetData>{''.join(cells)}</sheetData></worksheet>"
            book.writestr(f"xl/worksheets/s{i}.xml", content)
