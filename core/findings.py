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
        "roller-pressure-angle": "pressure angle {value:.4g} deg exceeds the usual {limit:.4g} deg; carry the roller at another "
        "point, or move the cam's centre",
        "undercut": "undercut: the smallest radius of the pitch curve, {pitch_radius_mm:.5g} mm, "
        "is below the roller radius {roller_radius_mm:.5g} mm",
        "separation": "the roller leaves the cam: contact force {force_n:.5g} N; add closing force or lower the speed",
        "jamming": "friction jams the guide: friction times the slope of what pushes is {factor:.4g}, must stay below 1",
        "dead-centre": "rod and arm come close to one line (dead centre): sine of the angle between them {value:.3g}",
        "rod-across-guide": "the rod comes close to standing across the guide, where the arm cannot drive the slider: "
        "cosine of its angle {value:.3g}",
        "crank-cannot-turn": "the crank cannot turn fully: the linkage can be assembled with it within {ranges} only, and "
        "locks at {joints}",
        "not-periodic": "after one turn of the driver the linkage stands otherwise than before",
        "change-point": "the links at {joint} come to lie in one line, where both ways to assemble them meet (change point); "
        "the motion goes on smoothly, but play decides",
        "linkage-dead-centre": "dead centre: the links at {joint} come to lie in one line, transmission angle {value:.3g} deg",
        "transmission-angle": "transmission angle at {joint} falls to {value:.4g} deg, usual are {limit:.4g} deg and more",
        "unstable-speed": "{rpm:.6g} rpm lies in a forbidden band of speed, {rpm_lo:.6g} ... {rpm_hi:.6g} rpm (tongue {n:.0f}): "
        "twist of the shaft grows by up to {growth_percent:.3g} % a turn; change its stiffness or the speed",
        "unstable-shaft": "at {rpm:.6g} rpm twist of the shaft grows by {growth_percent:.3g} % a turn; change its stiffness or the "
        "speed",
        "near-unstable-speed": "{rpm:.6g} rpm is near a forbidden band of speed, {rpm_lo:.6g} ... {rpm_hi:.6g} rpm (tongue {n:.0f}), "
        "in which twist of the shaft grows by up to {growth_percent:.3g} % a turn",
        "above-all-speeds": "{rpm:.6g} rpm is above {top_rpm:.6g} rpm, from where on the shaft does not hold the cam",
        "no-stability": "no word on the stability of the shaft: {why}; {hint}",
        "motor-stalls": "the motor stalls: a flywheel of {inertia_kg_m2:.6g} kg m^2 does not carry the load over its peak, "
        "{least_kg_m2:.3g} kg m^2 and more do; a steeper motor slope needs less",
        "no-load": "no masses and no forces are given: contact force and torque are zero",
    }
)


LEAST_BOUND = 1e-12
"""Accuracy that every channel promises, relative to its size: a residual within it is kept whatever rounding would allow."""


@dataclass(frozen=True)
class Residual:
    """One line of the certificate: a figure that exact arithmetic would make zero, relative to the size of its channel.

    derived   what rounding may make of it
    left_out  how many of the cases it says nothing of, and of which ones: ``cases`` is ``1984 triples``
    """

    value: float
    derived: float
    left_out: int = 0
    cases: str = ""

    @property
    def bound(self) -> float:
        """What it must keep: the larger of the derived bound and the promised accuracy."""
        return max(self.derived, LEAST_BOUND)

    @property
    def kept(self) -> bool:
        return self.value <= self.bound

    @property
    def note(self) -> str:
        """What was left out, in words."""
        return f"{self.left_out} of {self.cases} left out" if self.left_out else ""
