"""Small results: columns of tables, extremes, findings."""

from __future__ import annotations

from dataclasses import dataclass

from core.findings import Finding as CoreFinding
from kindyna._checks import brief


@dataclass(frozen=True, repr=False)
class Channel:
    """A column of the tables of a design.

    Attributes
    ----------
    name : column, which ends with its unit
    label : quantity in words
    unit : symbol of the unit
    table : file that ``export`` writes it to
    stage : stage of the study that computes it
    equation, source : its equation as the report prints it, and where it is from; empty for an angle
    """

    name: str
    label: str
    unit: str
    table: str
    stage: str
    equation: str
    source: str

    def __repr__(self) -> str:
        return brief(f"<kindyna.Channel {self.name}: {self.label}, {self.table}>")


@dataclass(frozen=True)
class Extreme:
    """An extreme of a channel over the turn.

    Attributes
    ----------
    value : in the unit of the channel; infinite where the quantity grows without limit
    angle_deg : cam, driver or machine angle at which it is reached
    unit : symbol of the unit
    """

    value: float
    angle_deg: float
    unit: str

    def __float__(self) -> float:
        return self.value


@dataclass(frozen=True, repr=False)
class Finding:
    """A limit that a design exceeds.

    Attributes
    ----------
    code : name of the limit, the same in every language
    severity : ``error`` (the machine cannot work), ``warning`` or ``note``
    field : path of the input that remedies it
    angle_deg : angle of the worst value, None where it concerns the full turn
    message : subject, value, limit and remedy in one sentence
    """

    code: str
    severity: str
    field: str
    angle_deg: float | None
    message: str

    def __repr__(self) -> str:
        return brief(f"<kindyna.Finding {self.severity} {self.code}: {self.message}>")


def finding(row: CoreFinding) -> Finding:
    """Return a finding of the core."""
    return Finding(row.code, row.severity, row.field, row.cam_angle_deg, row.message)
