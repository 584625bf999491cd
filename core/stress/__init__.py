"""Stress where the follower touches the cam, and the life of its roller."""

from core.stress.checks import missing_findings, pressure_findings, unfit_finding
from core.stress.hertz import ContactStress, contact_stresses, half_width, pressure, relative_curvature, shear_depth
from core.stress.life import RollerLife, life_of, lives_of, roller_speed, turn_nodes
from core.stress.pairing import Pairing, Surface, asked_for, has_width, missing, pairings, ratings

__all__ = [
    "ContactStress", "Pairing", "RollerLife", "Surface", "asked_for", "contact_stresses", "half_width", "has_width",
    "life_of",
    "lives_of",
    "missing", "missing_findings", "pairings", "pressure", "pressure_findings", "ratings", "relative_curvature", "roller_speed",
    "shear_depth", "turn_nodes", "unfit_finding",
]  # fmt: skip
