"""Tables and figures of a study as files: written whole or not at all, the same design giving the same bytes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from core.design import BALANCER, UNITS, Design
from core.design.fields import choice, number, whole
from core.errors import KindynaError
from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.output.channels import ANGLES, channels, existing
from core.output.summary import summary, to_json
from core.project.files import write_into
from core.requests import option
from core.study import Camshaft, Study
from core.study.camshaft import has_speed, is_complete
from core.study.quantities import DYNAMICS, KINEMATICS, LINKAGE, ORBIT, PROFILE, SERVO

if TYPE_CHECKING:
    from core.stability import Tongues


# -- tables and figures of a study as files ---------------------------------------------------------------------


TABLES = (PROFILE, KINEMATICS, LINKAGE, DYNAMICS, SERVO, ORBIT)
ANGLES_AT_ONCE = 32_768  # a larger study is computed and written in blocks: memory does not grow with its angles
LINES_AT_ONCE = 1_024  # their text stays in the processor's cache
TONGUES, SUMMARY, SHAFT = "tongues.csv", "summary.json", "shaft.csv"
MOTOR_COLUMNS = {
    f"servo_{each}": f"motor_{each}" for each in ("torque_nm", "force_n", "speed_rpm", "velocity_mm_s", "power_w")
}
"""What the motor's columns are called in its own table, where no motor of the shaft stands."""
OF_SHAFT = frozenset({"motor_torque", "linear_motor_torque"})
"""Quantities that belong to all drives of a shaft together, and stand in no table of one."""


def csv(names: Sequence[str], columns: Sequence[np.ndarray]) -> str:
    """A table with a header line; every number is the shortest text that reads back to the same bits."""
    return b"".join((csv_head(names), csv_lines(names, columns))).decode()


def csv_head(names: Sequence[str]) -> bytes:
    """The header of a CSV file: names between commas."""
    return ",".join(names).encode() + b"\n"


def csv_lines(names: Sequence[str], columns: Sequence[np.ndarray]) -> bytes:
    """The lines of columns (n,), without a header. Raises KindynaError where a number is not finite."""
    rows = np.column_stack(columns)
    if not np.isfinite(rows).all():
        row, column = np.argwhere(~np.isfinite(rows))[0]
        raise KindynaError(f"{names[column]}: not finite at {names[0]} {columns[0][row]:.6g}; no table can hold that")
    return b"".join(_lines(rows[first : first + LINES_AT_ONCE]) for first in range(0, len(rows), LINES_AT_ONCE))


def _lines(rows: np.ndarray) -> bytearray:
    import orjson

    text = bytearray(orjson.dumps(rows.ravel(), option=orjson.OPT_SERIALIZE_NUMPY))  # [1.0,2.0,3.0,4.0]
    marks = np.frombuffer(text, dtype=np.uint8)
    marks[np.flatnonzero(marks == ord(","))[rows.shape[1] - 1 :: rows.shape[1]]] = ord("\n")
    marks[-1] = ord("\n")
    del marks  # who looks at a bytearray keeps it from being shortened
    del text[0]
    return text


def bounded(study: Study) -> Study:
    """The study whose findings, figures and certificate stand for it: extremes are refined, so that more angles tell no more."""
    return study if study.samples <= ANGLES_AT_ONCE else Study(study.design, ANGLES_AT_ONCE)


def blocks(study: Study) -> Iterator[tuple[np.ndarray, Study]]:
    """Angles as in tables [deg] and the study at them, so many at once, which is emptied when the next is asked for; a study of no
    more angles comes as it is."""
    degrees = study.angle_degrees
    if degrees.size <= ANGLES_AT_ONCE:
        yield degrees, study
        return
    for begin in range(0, degrees.size, ANGLES_AT_ONCE):
        checkpoint()
        part = degrees[begin : begin + ANGLES_AT_ONCE]
        there = study.at(study.program.angles(np.deg2rad(part)))
        yield part, there
        vars(there).clear()  # its camshaft holds it in turn: what they hold would stay until garbage is searched for


def table(
    study: Study, name: str, stages: Sequence[str], without: frozenset[str] = frozenset()
) -> Iterator[bytes] | None:
    """One of ``TABLES`` with the columns of the named stages, block by block; None where no column is left, or no forces exist.
    without: quantities that are left out."""
    judged = bounded(study)
    rows = existing(
        judged, (row for row in channels(study.design, stages) if row.table == name and row.name not in without)
    )
    if not rows or (name in (DYNAMICS, SERVO) and judged.jam is not None):
        return None
    names = [ANGLES.get(name, study.angle_column), *(MOTOR_COLUMNS.get(row.slug, row.slug) for row in rows)]

    def made() -> Iterator[bytes]:
        yield csv_head(names)
        for degrees, part in blocks(study):
            yield csv_lines(names, [degrees, *(row.values(part) for row in rows)])

    return made()


def names(design: Design) -> tuple[str, ...]:
    """The files that a design can give; a quantity that does not exist may leave one out."""
    there = {row.table for row in channels(design)}
    tongues = design.shaft is not None and design.shaft.elastic is not None
    return (*(name for name in TABLES if name in there), *([TONGUES] if tongues else []), SUMMARY)


def tongues_table(rows_of_q: Sequence[Tongues]) -> str:
    """The instability tongues of some rows of Q, one a line, those that are open."""
    lines = ["model,q,n,eta_lo,eta_hi"]
    for each in sorted(rows_of_q, key=lambda t: t.equation):
        for q, edges in zip(each.q.tolist(), each.edges.tolist(), strict=True):
            lines += [f"{each.equation},{q!r},{n},{lo!r},{hi!r}" for n, (lo, hi) in enumerate(edges, 1) if hi > 0.0]
    return "\n".join(lines) + "\n"


def streams(
    study: Study, stages: Sequence[str] = (), without: frozenset[str] = frozenset()
) -> dict[str, str | Iterator[bytes]]:
    """File name -> text, or its parts as they are computed, of all that the named stages (all, where none is named) give; without:
    quantities that are left out of tables and figures. Drives that are listed have a folder each, beside what they do together."""
    for name in stages:
        study.require_stage(name)
    wanted = tuple(s for s in study.stages if s in stages) if stages else study.stages
    made = _of_camshaft(study, stages) if study.design.listed else _of_drive(study, wanted, without)
    made[SUMMARY] = to_json(summary(bounded(study), wanted, without))
    return made


def _of_drive(study: Study, wanted: Sequence[str], without: frozenset[str]) -> dict[str, str | Iterator[bytes]]:
    made = {name: table(study, name, wanted, without) for name in TABLES}
    texts: dict[str, str | Iterator[bytes]] = {name: parts for name, parts in made.items() if parts is not None}
    if "stability" in wanted and study.stability is not None:
        from core.stability import EQUATIONS  # no design without a flexible shaft loads it

        texts[TONGUES] = tongues_table([study.stability.tongues(equation) for equation in EQUATIONS])
    return texts


def files(study: Study, stages: Sequence[str] = ()) -> dict[str, str]:
    """The same as texts."""
    return texts(streams(study, stages))


def texts(made: Mapping[str, str | Iterator[bytes]]) -> dict[str, str]:
    """Tables that are computed part by part, as texts."""
    return {name: parts if isinstance(parts, str) else b"".join(parts).decode() for name, parts in made.items()}


def export(study: Study, folder: Path, stages: Sequence[str] = ()) -> list[Path]:
    """Write them all into the folder; the paths. Raises NoSolution, NoSuchStage, FileError, and then writes nothing."""
    made = streams(study, stages)
    write_into(folder, made)
    return [folder / name for name in made]


# -- several drives on a shaft ------------------------------------------------------------------------------

Column = tuple[str, Callable[[Camshaft[Study]], np.ndarray]]


def camshaft_columns(camshaft: Camshaft[Study]) -> list[Column]:
    """Those that exist: where a drive has no answer its own and the sums are left out, where the motor stalls motor and speed."""

    def torque_of(name: str) -> Callable[[Camshaft[Study]], np.ndarray]:
        return lambda there: there.drive_torque(name)

    rows: list[Column] = [("torque_nm", lambda there: there.torque)] if is_complete(camshaft) else []
    rows += [
        (f"{camshaft.slugs[name]}_torque_nm", torque_of(name))
        for name in camshaft.loading_drives
        if name not in camshaft.failures
    ]
    if is_complete(camshaft) and camshaft.design.balancer is not None:
        rows.append(("balancer_torque_nm", lambda there: there.balancer_torque))
    if has_speed(camshaft):
        rows.append(("motor_torque_nm", lambda there: there.motor_torque))
        rows.append(("speed_rpm", lambda there: there.speed / UNITS["rpm"].factor))
    return rows


def camshaft_table(study: Study) -> Iterator[bytes] | None:
    """``shaft.csv``, block by block; None where no drive has an answer."""
    camshaft = bounded(study).camshaft
    rows = camshaft_columns(camshaft)
    if not rows:
        return None

    def made() -> Iterator[bytes]:
        names = ["machine_angle_deg", *(name for name, _ in rows)]
        yield csv_head(names)
        angles = study.angle_degrees
        for begin in range(0, angles.size, ANGLES_AT_ONCE):
            checkpoint()
            part = angles[begin : begin + ANGLES_AT_ONCE]
            there = camshaft if angles.size <= ANGLES_AT_ONCE else camshaft.at_theta(np.deg2rad(part))
            yield csv_lines(names, [part, *(values(there) + 0.0 for _, values in rows)])

    return made()


def _of_camshaft(study: Study, stages: Sequence[str]) -> dict[str, str | Iterator[bytes]]:
    """``shaft.csv``, and the tables of each drive in a folder of its slug."""
    camshaft = bounded(study).camshaft
    made: dict[str, str | Iterator[bytes]] = {}
    parts = camshaft_table(study) if not stages or "dynamics" in stages else None
    if parts is not None:
        made[SHAFT] = parts
    folders = {slug: study.drives[name] for name, slug in camshaft.slugs.items() if name not in camshaft.failures}
    if study.design.balancer is not None and is_complete(camshaft) and camshaft.balancer is not None:
        folders[BALANCER] = study.with_design(camshaft.balancer.design)
    for folder, each in folders.items():
        own = tuple(stage for stage in each.stages if stage in stages)
        if own or not stages:
            made |= {f"{folder}/{file}": parts for file, parts in streams(each, own, OF_SHAFT).items()}
    return made


# -- what an animation of one turn shall be like ----------------------------------------------------------------


FORMATS: Mapping[str, str] = MappingProxyType(
    {
        ".gif": "GIF animation",
        ".webp": "WebP animation",
        ".mp4": "MP4 film, by ffmpeg",
        ".png": "PNG pictures in a folder",
    }
)
"""By the ending of the file's name; pictures go into a folder of that name without it."""
TICK = 10  # milliseconds: what a GIF counts in
LEAST_DELAY = 20  # a viewer plays what is shorter at a speed of its own


@frozen
class Film:
    """What is wanted: ``.gif`` or ``.webp``, frames of the turn, size in pixels, seconds of the turn."""

    ending: str = option(choice("Format", tuple(FORMATS), default=".gif"), None, words=FORMATS)
    frames: int = option(whole("Frames per turn", 2, 360, default=72), help="per turn")
    width: int = 800
    height: int = 600
    seconds: float = option(number("One turn takes, s", 0.2, 600.0, default=4.0), None)

    @property
    def delays(self) -> list[int]:
        """How long each frame stands [ms]: whole ticks that add up to the turn."""
        total = max(round(1000.0 * self.seconds / TICK), self.frames * LEAST_DELAY // TICK)
        marks = [total * i // self.frames for i in range(self.frames + 1)]
        return [(after - before) * TICK for before, after in pairwise(marks)]
