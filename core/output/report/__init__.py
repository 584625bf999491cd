"""The report of a study: one model of it, written as plain text, as HTML, or painted."""

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
    """The report's section on the flexible shaft alone."""
    return "\n".join(list(lines(sections.shaft_stability(study)))[1:]) + "\n"


def point_text(shaft: Stability, eta: float, q: float, verdicts: Sequence[Verdict]) -> str:
    """What every model says of any point of the chart."""
    head = f"At η = {digits(eta)}, Q = {digits(q)}, {digits(shaft.machine.rpm(eta))} rpm"
    return "\n".join(block_lines(sections.verdicts(head, verdict_rows(verdicts)))) + "\n"


def report(study: Study) -> str:
    """The whole report as plain text; of drives that are listed what they do together, then what is each drive's own. Raises NoSolution
    where the design has none."""
    whole = subject_of(study)
    of_each = (whole, *whole.drives(SHAFT_QUANTITIES | _TORQUE))
    return "\n\n".join(text(each.study.design.name, sections_of(TEXT, each)) for each in of_each)


_TORQUE = frozenset({"drive_torque"})  # stands beside the drives


__all__ = ["point_text", "report", "stability_text"]
