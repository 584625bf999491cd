"""Findings: limits that a design exceeds. The sentence comes from a table, so that it can be translated."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

ERROR, WARNING, NOTE = "error", "warning", "note"


@dataclass(frozen=True)
class Finding:
    """One limit reached.

    code           key of ``SENTENCES``
    severity       ``error`` (the machine will not work so), ``warning`` or ``note``
    field          path of the input that mends it
    cam_angle_deg  where it is worst, None where it holds for the whole cycle
    values         numbers of the sentence, in the units the sentence states
    """

    code: str
    severity: str
    field: str
    cam_angle_deg: float | None
    values: Mapping[str, float | str] = dataclasses.field(default_factory=lambda: MappingProxyType({}))

    @property
    def message(self) -> str:
        return SENTENCES[self.code].format(**self.values)


SENTENCES: Mapping[str, str] = MappingProxyType(
    {
        "jump-displacement": "displacement jumps by {jump:.6g} {unit_name} at a join: no cam can do that",
        "jump-velocity": "velocity jumps by {jump:.6g} {unit_name}/rad at a join: infinite acceleration",
        "jump-acceleration": "acceleration jumps by {jump:.6g} {unit_name}/rad^2 at a join: infinite jerk",
        "pressure-angle": "pressure angle {value:.4g} deg exceeds the usual {limit:.4g} deg; a larger base radius lowers it",
        "undercut": "undercut: the smallest radius of the pitch curve, {pitch_radius_mm:.5g} mm, "
        "is below the roller radius {roller_radius_mm:.5g} mm",
        "separation": "the roller leaves the cam: contact force {force_n:.5g} N; add closing force or lower the speed",
        "jamming": "friction jams the guide: friction times the slope of what pushes is {factor:.4g}, must stay below 1",
        "dead-centre": "rod and arm come close to one line (dead centre): sine of the angle between them {value:.3g}",
        "rod-across-guide": "the rod comes close to standing across the guide, where the arm cannot drive the slider: "
        "cosine of its angle {value:.3g}",
        "no-load": "no masses and no forces are given: contact force and torque are zero",
    }
)


@dataclass(frozen=True)
class Residual:
    """One line of the certificate: a figure that exact arithmetic would make zero, and the bound it must keep."""

    value: float
    bound: float

    @property
    def kept(self) -> bool:
        return self.value <= self.bound
