"""Tables and figures of a study as files: complete or not written at all, the same bytes for the same design."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from core.design import BALANCER, UNITS, Design
from core.design.fields import choice, number, whole
from core.design.outline_bodies import Body
from core.errors import KindynaError
from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.output.channels import ANGLES, channels, existing
from core.output.summary import summary, to_json
from core.project.files import write_into
from core.requests import option
from core.study import Camshaft, Quantity, Study
from core.study.camshaft import has_speed, is_complete
from core.study.quantities import CLEARANCES, DYNAMICS, KINEMATICS, LINKAGE, ORBIT, PROFILE, SERVO

if TYPE_CHECKING:
    from core.stability import Tongues


# -- tables -----------------------------------------------------------------------------------------------------


TABLES = (PROFILE, KINEMATICS, LINKAGE, CLEARANCES, DYNAMICS, SERVO, ORBIT)
ANGLES_AT_ONCE = 32_768  # a larger study is computed and written in blocks, which limits memory
MM = 1e3  # mm in a metre
LINES_AT_ONCE = 1_024  # their text fits into the processor's cache
TONGUES, SUMMARY, SHAFT = "tongues.csv", "summary.json", "shaft.csv"
SHAFT_QUANTITIES = frozenset({"motor_torque", "linear_motor_torque"})
"""Quantities of all drives of a shaft together, which no table of a single drive holds."""


def csv(names: Sequence[str], columns: Sequence[np.ndarray]) -> str:
    """A table with a header line; each number is the shortest text that reads back to the same bits.

    Parameters
    ----------
    names : sequence of str
    columns : sequence of ndarray (n,) [units in the names]
    """
    return b"".join((csv_header(names), csv_lines(names, columns))).decode()


def csv_header(names: Sequence[str]) -> bytes:
    """Header line of a CSV file."""
    return ",".join(names).encode() + b"\n"


def csv_lines(names: Sequence[str], columns: Sequence[np.ndarray]) -> bytes:
    """Lines of a CSV file, without a header.

    Parameters
    ----------
    names : sequence of str
    columns : sequence of ndarray (n,) [units in the names]

    Raises
    ------
    KindynaError
        A number is not finite.
    """
    rows = np.column_stack(columns)
    if not np.isfinite(rows).all():
        row, column = np.argwhere(~np.isfinite(rows))[0]
        raise KindynaError(
            f"{names[column]}: not finite at {names[0]} {columns[0][row]:.6g}; a table holds finite numbers only"
        )
    return b"".join(_lines(rows[first : first + LINES_AT_ONCE]) for first in range(0, len(rows), LINES_AT_ONCE))


def _lines(rows: np.ndarray) -> bytearray:
    import orjson

    text = bytearray(orjson.dumps(rows.ravel(), option=orjson.OPT_SERIALIZE_NUMPY))  # [1.0,2.0,3.0,4.0]
    marks = np.frombuffer(text, dtype=np.uint8)
    marks[np.flatnonzero(marks == ord(","))[rows.shape[1] - 1 :: rows.shape[1]]] = ord("\n")
    marks[-1] = ord("\n")
    del marks  # a bytearray with a view cannot be shortened
    del text[0]
    return text


def bounded_study(study: Study) -> Study:
    """Study with a limited number of angles for findings, figures and certificate, whose extremes are refined."""
    return study if study.samples <= ANGLES_AT_ONCE else Study(study.design, ANGLES_AT_ONCE)


def study_blocks(study: Study) -> Iterator[tuple[np.ndarray, Study]]:
    """Blocks of a study with many angles, each released when the next is requested; a smaller study is a single block.

    Returns
    -------
    iterator of ndarray (n,) [deg] and Study
        Angles as in tables, and the study at these angles.
    """
    degrees = study.angle_degrees
    if degrees.size <= ANGLES_AT_ONCE:
        yield degrees, study
        return
    for begin in range(0, degrees.size, ANGLES_AT_ONCE):
        checkpoint()
        part = degrees[begin : begin + ANGLES_AT_ONCE]
        block = study.at(study.program.angles(np.deg2rad(part)))
        yield part, block
        vars(block).clear()  # reference cycle with its camshaft: memory would wait for the garbage collector


def table_rows(
    study: Study, name: str, stages: Sequence[str] = (), without: frozenset[str] = frozenset()
) -> list[tuple[str, Quantity]]:
    """Columns of one of ``TABLES`` after its angle, with their quantities; none where a guide jams in a table of forces.

    ``without`` lists quantities to omit.
    """
    bounded = bounded_study(study)
    rows = existing(
        bounded, (row for row in channels(study.design, stages) if row.table == name and row.name not in without)
    )
    if not rows or (name in (DYNAMICS, SERVO) and bounded.jam is not None):
        return []
    return [(row.column, row) for row in rows]


def angle_of_table(study: Study, name: str) -> str:
    """First column of one of ``TABLES``."""
    return ANGLES.get(name, study.angle_column)


def table(
    study: Study, name: str, stages: Sequence[str], without: frozenset[str] = frozenset()
) -> Iterator[bytes] | None:
    """One of ``TABLES`` with columns of the named stages, in blocks of lines; None without columns."""
    rows = table_rows(study, name, stages, without)
    if not rows:
        return None
    columns = [angle_of_table(study, name), *(column for column, _ in rows)]

    def lines() -> Iterator[bytes]:
        yield csv_header(columns)
        yield from (
            csv_lines(columns, [degrees, *(row.values(part) for _, row in rows)])
            for degrees, part in study_blocks(study)
        )

    return lines()


def file_names(design: Design) -> tuple[str, ...]:
    """Names of the files of a design; a missing quantity may omit one."""
    tables = {row.table for row in channels(design)}
    tongues = design.shaft is not None and design.shaft.elastic is not None
    return (*(name for name in TABLES if name in tables), *([TONGUES] if tongues else []), SUMMARY)


def tongues_csv(tongues: Sequence[Tongues]) -> str:
    """Open instability tongues for values of Q as CSV, one a line."""
    lines = ["model,q,n,eta_lo,eta_hi"]
    for row in sorted(tongues, key=lambda row: row.equation):
        for q, edges in zip(row.q.tolist(), row.edges.tolist(), strict=True):
            lines += [f"{row.equation},{q!r},{n},{lo!r},{hi!r}" for n, (lo, hi) in enumerate(edges, 1) if hi > 0.0]
    return "\n".join(lines) + "\n"


def file_parts(
    study: Study, stages: Sequence[str] = (), without: frozenset[str] = frozenset()
) -> dict[str, str | Iterator[bytes]]:
    """File name -> its text, or the parts of it as they are computed, for the named stages or for all.

    Listed drives have a folder each; ``without`` lists quantities to omit in tables and figures.
    """
    for name in stages:
        study.require_stage(name)
    selected = tuple(s for s in study.stages if s in stages) if stages else study.stages
    parts = _shaft_files(study, stages) if study.design.listed else _drive_files(study, selected, without)
    parts[SUMMARY] = to_json(summary(bounded_study(study), selected, without))
    return parts


def _drive_files(study: Study, stages: Sequence[str], without: frozenset[str]) -> dict[str, str | Iterator[bytes]]:
    tables = {name: table(study, name, stages, without) for name in TABLES}
    contents: dict[str, str | Iterator[bytes]] = {name: parts for name, parts in tables.items() if parts is not None}
    if "stability" in stages and study.stability is not None:
        from core.stability import EQUATIONS  # no design without a flexible shaft loads it

        contents[TONGUES] = tongues_csv([study.stability.tongues(equation) for equation in EQUATIONS])
    return contents


def files(study: Study, stages: Sequence[str] = ()) -> dict[str, str]:
    """File name -> text of all files."""
    return as_texts(file_parts(study, stages))


def as_texts(contents: Mapping[str, str | Iterator[bytes]]) -> dict[str, str]:
    """File name -> text, for contents that may be computed in parts."""
    return {name: parts if isinstance(parts, str) else b"".join(parts).decode() for name, parts in contents.items()}


def export(study: Study, folder: Path, stages: Sequence[str] = (), without: frozenset[str] = frozenset()) -> list[Path]:
    """Write all files into the folder and return their paths. Raises NoSolution, NoSuchStage, FileError; then nothing is written.

    ``without`` lists quantities to omit.
    """
    contents = file_parts(study, stages, without)
    write_into(folder, contents)
    return [folder / name for name in contents]


# -- several drives on a shaft ------------------------------------------------------------------------------

Column = tuple[str, Callable[[Camshaft[Study]], np.ndarray]]


def camshaft_columns(camshaft: Camshaft[Study]) -> list[Column]:
    """Columns of the shaft: torques, without sums where a drive fails; motor and speed, where the motor does not stall."""

    def torque_of(name: str) -> Callable[[Camshaft[Study]], np.ndarray]:
        return lambda shaft: shaft.drive_torque(name)

    rows: list[Column] = [("torque_nm", lambda shaft: shaft.torque)] if is_complete(camshaft) else []
    rows += [
        (f"{camshaft.slugs[name]}_torque_nm", torque_of(name))
        for name in camshaft.loading_drives
        if name not in camshaft.failures
    ]
    if is_complete(camshaft) and camshaft.design.balancer is not None:
        rows.append(("balancer_torque_nm", lambda shaft: shaft.balancer_torque))
    if has_speed(camshaft):
        rows.append(("motor_torque_nm", lambda shaft: shaft.motor_torque))
        rows.append(("speed_rpm", lambda shaft: shaft.speed / UNITS["rpm"].factor))
    return rows


def camshaft_table(study: Study) -> Iterator[bytes] | None:
    """``shaft.csv`` in blocks; None where every drive fails."""
    camshaft = bounded_study(study).camshaft
    rows = camshaft_columns(camshaft)
    if not rows:
        return None

    def lines() -> Iterator[bytes]:
        columns = ["machine_angle_deg", *(name for name, _ in rows)]
        yield csv_header(columns)
        angles = study.angle_degrees
        for begin in range(0, angles.size, ANGLES_AT_ONCE):
            checkpoint()
            part = angles[begin : begin + ANGLES_AT_ONCE]
            block = camshaft if angles.size <= ANGLES_AT_ONCE else camshaft.at_theta(np.deg2rad(part))
            yield csv_lines(columns, [part, *(values(block) + 0.0 for _, values in rows)])

    return lines()


def clearance_table(study: Study, pairs: Sequence[tuple[Body, Body]]) -> Iterator[bytes]:
    """Distances of bodies over the turn in blocks of lines: angle of cam, driver or machine, then one column a pair."""
    clearances = study.clearances
    angle = "machine_angle_deg" if study.design.listed else study.angle_column
    columns = [angle, *map(clearances.column, pairs)]
    yield csv_header(columns)
    angles = study.angle_degrees
    for begin in range(0, angles.size, ANGLES_AT_ONCE):
        checkpoint()
        part = angles[begin : begin + ANGLES_AT_ONCE]
        pose = clearances.at(clearances.angles(np.deg2rad(part)))
        yield csv_lines(columns, [part, *(clearances.distance(pair, pose) * MM for pair in pairs)])


def _shaft_files(study: Study, stages: Sequence[str]) -> dict[str, str | Iterator[bytes]]:
    """``shaft.csv``, and the tables of each drive in a folder named by its slug."""
    camshaft = bounded_study(study).camshaft
    contents: dict[str, str | Iterator[bytes]] = {}
    parts = camshaft_table(study) if not stages or "dynamics" in stages else None
    if parts is not None:
        contents[SHAFT] = parts
    has_pairs = study.design.outlines and not camshaft.failures and (not stages or "linkage" in stages)
    if has_pairs and (pairs := study.clearances.pairs):
        contents[CLEARANCES] = clearance_table(study, pairs)
    folders = {slug: study.drives[name] for name, slug in camshaft.slugs.items() if name not in camshaft.failures}
    if (balancer := balancer_study(study)) is not None:
        folders[BALANCER] = balancer
    for folder, drive in folders.items():
        drive_stages = tuple(stage for stage in drive.stages if stage in stages)
        if drive_stages or not stages:
            contents |= {
                f"{folder}/{file}": parts for file, parts in file_parts(drive, drive_stages, SHAFT_QUANTITIES).items()
            }
    return contents


def balancer_study(study: Study) -> Study | None:
    """Study of the balance cam by its own angle; None without one, or where a drive fails."""
    camshaft = bounded_study(study).camshaft
    if study.design.balancer is None or not is_complete(camshaft) or camshaft.balancer is None:
        return None
    return study.with_design(camshaft.balancer.design)


# -- request for an animation of one turn -----------------------------------------------------------------------


FORMATS: Mapping[str, str] = MappingProxyType(
    {
        ".gif": "GIF animation",
        ".webp": "WebP animation",
        ".mp4": "MP4 film, by ffmpeg",
        ".png": "PNG pictures in a folder",
    }
)
"""Ending of the file -> its format; images are written into a folder of that name without the ending."""
TICK = 10  # milliseconds, the unit of time in a GIF
LEAST_DELAY = 20  # milliseconds: viewers replace shorter delays


@frozen
class Film:
    """An animation: ending of the file, frames of the turn, size [pixels], duration of the turn [s]."""

    ending: str = option(choice("Format", tuple(FORMATS), default=".gif"), None, words=FORMATS)
    frames: int = option(whole("Frames per turn", 2, 360, default=72), help="per turn")
    width: int = 800
    height: int = 600
    seconds: float = option(number("One turn takes, s", 0.2, 600.0, default=4.0), None)

    @property
    def delays(self) -> list[int]:
        """Duration of each frame [ms]: whole ticks with the sum of the turn."""
        total = max(round(1000.0 * self.seconds / TICK), self.frames * LEAST_DELAY // TICK)
        marks = [total * i // self.frames for i in range(self.frames + 1)]
        return [(after - before) * TICK for before, after in pairwise(marks)]
