"""The command ``check``: findings and certificate of a design."""

from __future__ import annotations

from pathlib import Path

from core.commands import Painter
from core.commands.common import design_file, studied, verdict
from core.frozen import frozen
from core.output.lines import finding_line, printable
from core.project import load
from core.study import certificate_of, findings_of


@frozen(kw_only=True)
class Arguments:
    """The design."""

    design: Path = design_file()


def run(arguments: Arguments, painter: Painter | None) -> int:
    """Findings and certificate of a design."""
    study = studied(load(arguments.design))
    findings, proof = findings_of(study), certificate_of(study)
    for finding in findings:
        print(finding_line(finding, study.angle_name))
    for name, residual in proof.items():
        if not residual.kept:
            print(f"certificate: {name} = {residual.value:.3g} exceeds its bound {residual.bound:.3g}")
    kept = sum(residual.kept for residual in proof.values())
    print(
        f"{printable(study.design.name)}: {len(findings)} findings, {kept} of {len(proof)} residuals within their bounds"
    )
    return verdict(study)
