"""What mends a finding of a design: a search, or the field where it is typed."""

from __future__ import annotations

from core.design import Design, drive_in, only, path_in
from core.find.offer import offered
from core.find.on_shaft import offered_on_shaft
from core.findings import Finding, Remedy


def remedy_of(design: Design, finding: Finding) -> Remedy:
    """The remedy of the finding's row with the field where it leads; without a search that the design has nothing for."""
    row, own = finding.remedy, drive_in(design, finding.field)
    inside = finding.field if own is None else own[1]
    if row.find and not (row.of in ("", inside) and row.find in _searches(design, own)):
        row = Remedy()
    field = row.field if own is None or not row.field else path_in(design, own[0], row.field)
    return row._replace(field=field or finding.field)


def _searches(design: Design, own: tuple[int, str] | None) -> tuple[str, ...]:
    """Those of the shaft, and of the drive that a finding is of."""
    return (*offered_on_shaft(design), *(() if own is None else offered(only(design, own[0]))))
