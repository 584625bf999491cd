"""Tables and figures of a study as files: written whole or not at all, the same design giving the same bytes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from core.design import Design
from core.numerics.cancellation import checkpoint
from core.output.channels import ANGLES, DYNAMICS, KINEMATICS, LINKAGE, PROFILE, channels, existing
from core.output.summary import summary, to_json
from core.project.files import write_all
from core.study import Study

if TYPE_CHECKING:
    from core.stability import Tongues

TABLES = (PROFILE, KINEMATICS, LINKAGE, DYNAMICS)
ROWS_AT_ONCE = 4096
TONGUES, SUMMARY = "tongues.csv", "summary.json"


def csv(names: Sequence[str], columns: Sequence[np.ndarray]) -> str:
    """A table with a header line; every number is the shortest text that reads back to the same bits."""
    lines, rows = [",".join(names)], np.column_stack(columns)
    for begin in range(0, len(rows), ROWS_AT_ONCE):
        checkpoint()
        lines += [",".join(map(repr, row)) for row in rows[begin : begin + ROWS_AT_ONCE].tolist()]
    return "\n".join(lines) + "\n"


def table(study: Study, name: str, stages: Sequence[str]) -> str | None:
    """One of ``TABLES`` with the columns of the named stages; None where no column is left, or no forces exist."""
    rows = existing(study, (row for row in channels(study.design, stages) if row.table == name))
    if not rows or (name == DYNAMICS and study.jam is not None):
        return None
    names = [ANGLES.get(name, study.angle_column), *(row.slug for row in rows)]
    return csv(names, [study.angle_degrees, *(row.values(study) for row in rows)])


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


def files(study: Study, stages: Sequence[str] = ()) -> dict[str, str]:
    """File name -> text of all that the named stages (all, where none is named) give."""
    wanted = tuple(s for s in study.stages if s in stages) if stages else study.stages
    for name in stages:
        study.require_stage(name)
    tables = {name: table(study, name, wanted) for name in TABLES}
    texts = {name: text for name, text in tables.items() if text is not None}
    if "stability" in wanted and study.stability is not None:
        from core.stability import EQUATIONS  # no design without a flexible shaft loads it

        texts[TONGUES] = tongues_table([study.stability.tongues(equation) for equation in EQUATIONS])
    texts[SUMMARY] = to_json(summary(study, wanted))
    return texts


def export(study: Study, folder: Path, stages: Sequence[str] = ()) -> list[Path]:
    """Write them all into the folder; the paths. Raises NoAnswer, NoSuchStage, FileError, and then writes nothing."""
    texts = files(study, stages)
    write_all(folder, texts)
    return [folder / name for name in texts]
