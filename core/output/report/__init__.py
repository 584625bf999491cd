"""The report of a study: one model of it, written as plain text, as HTML, or painted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from core.output.channels import channels
from core.output.export import OF_SHAFT
from core.output.lines import digits
from core.output.report import of_camshaft, of_stability, of_study
from core.output.report.parts import Section
from core.output.report.text import block_lines, lines, text
from core.output.summary import flywheel, verdict_rows
from core.study import Study

if TYPE_CHECKING:  # no design without a flexible shaft loads it
    from core.stability import Stability, Verdict


def stability_text(study: Study) -> str:
    """The report's section on the flexible shaft alone."""
    return "\n".join(list(lines(of_stability.shaft_stability(study)))[1:]) + "\n"


def point_text(shaft: Stability, eta: float, q: float, verdicts: Sequence[Verdict]) -> str:
    """What every model says of any point of the chart."""
    head = f"At η = {digits(eta)}, Q = {digits(q)}, {digits(shaft.machine.rpm(eta))} rpm"
    return "\n".join(block_lines(of_stability.verdicts(head, verdict_rows(verdicts)))) + "\n"


def report(study: Study) -> str:
    """The whole report as plain text; of drives that are listed what they do together, then what is each drive's own. Raises NoAnswer
    where the design has none."""
    findings, proof = of_study.findings(study), of_study.certificate(study)
    wheel, shaft = of_study.flywheel(study, flywheel(study)), of_stability.shaft_stability(study)
    if not study.design.listed:
        return text(study.design.name, [*_of_drive(study), *wheel, *shaft, *findings, *proof])
    camshaft = study.camshaft
    tables = [name for name in ("shaft", "balancer") if name in study.design.tables]
    sections = [
        *of_camshaft.drives(camshaft),
        *_with_note(study, of_study.table_sections(study.design, tables)),
        *of_camshaft.timing(study.design),
        *of_camshaft.torque(camshaft),
    ]
    own = [(name, each) for name, each in study.drives.items() if name not in camshaft.failures]
    texts = [text(name, _of_drive(each, ("shaft",), OF_SHAFT | _TORQUE)) for name, each in own]
    return "\n\n".join([text(study.design.name, [*sections, *wheel, *shaft, *findings, *proof]), *texts])


def _of_drive(study: Study, without: tuple[str, ...] = (), less: frozenset[str] = frozenset()) -> list[Section]:
    """Inputs but the tables named, motion, extremes but of some quantities, and limits."""
    rows = (row for row in channels(study.design) if row.name not in less)
    return [
        *of_study.linkage_inputs(study),
        *_with_note(study, of_study.inputs(study, (*of_study.APART, *without))),
        *of_study.motion(study),
        *of_study.base(study),
        *of_study.extreme_values(study, rows, study.stages),
        *of_study.limits(study, study.stages),
        *of_study.contact(study),
        *of_study.vibration(study),
        *of_study.life(study),
    ]


def _with_note(study: Study, sections: list[Section]) -> list[Section]:
    """The mark of what is assumed is explained below the last table."""
    note = of_study.assumed_note(study, lambda path: study.design.listed and path.startswith("drives["))
    if note is None or not sections:
        return sections
    return [*sections[:-1], replace(sections[-1], blocks=(*sections[-1].blocks, note))]


_TORQUE = frozenset({"drive_torque"})  # stands beside the drives


__all__ = ["point_text", "report", "stability_text"]
