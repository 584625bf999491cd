"""Which number a finding, or a residual of the certificate, is about."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.findings import Finding
from core.output.explain import explainable
from core.study import Study

OF_FINDINGS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "pressure-angle": ("pressure_angle_deg",),
        "roller-pressure-angle": ("pressure_angle_deg",),
        "second-pressure-angle": ("second_pressure_angle_deg",),
        "undercut": ("pitch_curvature_per_mm", "profile_curvature_per_mm"),
        "outer-undercut": ("outer_curvature_per_mm",),
        "second-undercut": ("second_pitch_curvature_per_mm",),
        "convex-radius": ("profile_curvature_per_mm",),
        "concave-radius": ("profile_curvature_per_mm",),
        "cutter-too-large": ("profile_curvature_per_mm",),
        "polar-radius": ("radius_mm",),
        "profile-meets": ("radius_mm",),
        "face-too-narrow": ("contact_on_face_mm",),
        "contact-pressure": ("contact_pressure_mpa",),
        "material-pressure": ("contact_pressure_mpa",),
        "separation": ("contact_force_n",),
        "contact-force-low": ("contact_force_n",),
        "flank-change": ("contact_force_n",),
        "elastic-separation": ("elastic_contact_force_n",),
        "jamming": ("jam_factor",),
        "pair-jamming": ("jam_factor",),
        "jump-displacement": ("displacement_mm", "displacement_deg"),
        "jump-velocity": ("velocity_mm_s", "velocity_deg_s"),
        "jump-acceleration": ("acceleration_mm_s2", "acceleration_deg_s2"),
        "flywheel": ("fluctuation", "needed_inertia_kg_m2"),
    }
)
"""Code of a finding, or what it begins with -> columns or figures, the first that the design has."""

OF_RESIDUALS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "motion_closure": ("displacement_mm", "displacement_deg"),
        "loop_closure": ("phi_deg", "link3_deg", "link2_deg", "pivot_x_n", "displacement_mm"),
        "instant_centre": ("instant_centre_mm", "instant_centre_x_mm"),
        "three_centres": ("link3_rad_s",),
        "tangency": ("x_mm",),
        "second_centre": ("second_pitch_x_mm",),
        "power_balance": ("drive_torque_nm", "driver_torque_nm", "driver_force_n"),
        "momentum_balance": ("contact_force_n", "driver_torque_nm", "driver_force_n"),
    }
)
"""Name of a residual, or what it ends with, likewise."""


def number_of_finding(study: Study, finding: Finding) -> str:
    """Empty where it is about none that can be explained."""
    return _first(study, next((names for code, names in OF_FINDINGS.items() if finding.code.startswith(code)), ()))


def number_of_residual(study: Study, name: str) -> str:
    """Likewise; name: with the drive's before it, of several."""
    own = name.rpartition(".")[2]
    return _first(study, next((names for end, names in OF_RESIDUALS.items() if own.endswith(end)), ()))


def _first(study: Study, names: tuple[str, ...]) -> str:
    there = set(explainable(study)) if names else set()
    return next((name for name in names if name in there), "")


__all__ = ["number_of_finding", "number_of_residual"]
