"""The command ``check``: findings and certificate of a design."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from core.commands import Painter
from core.commands.common import design_file, studied, verdict_on
from core.design import Design
from core.design.linkage_rules import only_incomplete
from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen
from core.number_text import result_text
from core.output.lines import finding_line, printable
from core.project import loads
from core.project.files import read_text
from core.study import certificate_of, findings_of

if TYPE_CHECKING:  # few designs lack anything
    from core.mechanism.unfinished import Mobility


@frozen(kw_only=True)
class CheckArguments:
    """Arguments of the command: the design."""

    design: Path = design_file()


def run_check(arguments: CheckArguments, painter: Painter | None) -> int:
    """Print findings and certificate of a design."""
    study = studied(_read_design(arguments.design))
    findings, proof = findings_of(study), certificate_of(study)
    for finding in findings:
        print(finding_line(finding, study.angle_name))
    for name, residual in proof.items():
        if not residual.kept:
            print(
                f"certificate: {name} = {result_text(residual.value, 3)} exceeds its bound {result_text(residual.bound, 3)}"
            )
    kept = sum(residual.kept for residual in proof.values())
    noun = "finding" if len(findings) == 1 else "findings"
    print(
        f"{printable(study.design.name)}: {len(findings)} {noun}, {kept} of {len(proof)} residuals within their bounds"
    )
    return verdict_on(findings, proof)


def _read_design(path: Path) -> Design:
    """Read the design of a file. Raises DesignError, for an incomplete linkage with what it lacks."""
    text = read_text(path)
    try:
        return loads(text, str(path))
    except DesignError as error:
        lack = _lack(text, str(path), error)
        if lack is None:
            raise
        raise DesignError([Fault("linkage", MISSING, sentence) for sentence in lack.sentences]) from None


def _lack(text: str, source: str, error: DesignError) -> Mobility | None:
    """Mobility of an incomplete linkage; None where the text has other faults or the linkage lacks nothing."""
    try:
        drawn = loads(text, source, unfinished=True)
    except DesignError:
        return None
    if drawn.listed or not only_incomplete(drawn.drive, error.faults) or not drawn.drive.links:
        return None
    from core.mechanism.unfinished import mobility

    lack = mobility(drawn.drive.linkage)
    return lack if lack.sentences else None
