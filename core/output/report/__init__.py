"""The report of a study: one model, written as plain text, HTML or PDF."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from core.output.export import SHAFT_QUANTITIES
from core.output.lines import digits
from core.output.report import sections
from core.output.report.chapters import TEXT, sections_of, subject_of
from core.output.report.parts import block_lines, lines, text
from core.output.summary import verdict_rows
from core.study import Study

if TYPE_CHECKING:  # no design without a flexible shaft loads it
    from core.stability import Stability, Verdict


def stability_text(study: Study) -> str:
    """The section of the report on the flexible shaft."""
    return "\n".join(list(lines(sections.shaft_stability(study)))[1:]) + "\n"


def point_text(shaft: Stability, eta: float, q: float, verdicts: Sequence[Verdict]) -> str:
    """Verdicts of every model at a point of the chart."""
    header = f"At η = {digits(eta)}, Q = {digits(q)}, {digits(shaft.machine.rpm(eta))} rpm"
    return "\n".join(block_lines(sections.verdicts(header, verdict_rows(verdicts)))) + "\n"


def report(study: Study) -> str:
    """The report as plain text; of several drives first the shaft, then every drive. Raises NoSolution where the design has none."""
    subject = subject_of(study)
    subjects = (subject, *subject.drives(SHAFT_QUANTITIES | _TORQUE))
    return "\n\n".join(text(part.study.design.name, sections_of(TEXT, part)) for part in subjects)


_TORQUE = frozenset({"drive_torque"})  # is in the table of drives


__all__ = ["point_text", "report", "stability_text"]
