"""Forces and torque of a mechanism at constant speed, with their proof."""

from core.dynamics.balance import momentum_residual, power_residual, power_terms
from core.dynamics.elements import (
    Element,
    Friction,
    Inertia,
    Load,
    Loading,
    Mass,
    OutputForce,
    PointForce,
    Rate,
    combined,
)
from core.dynamics.flank_changes import FlankChange, change_findings, flank_changes
from core.dynamics.forces import JAMS, Forces, newton_euler
from core.dynamics.friction import GuideReaction, guide_reaction, limitless
from core.dynamics.limits import findings
from core.dynamics.loading import LOADINGS, link_loading, loading_of

__all__ = [
    "JAMS", "LOADINGS", "Element", "FlankChange", "Forces", "Friction", "GuideReaction", "Inertia", "Load", "Loading", "Mass",
    "OutputForce", "PointForce", "Rate", "change_findings", "combined", "findings", "flank_changes", "guide_reaction", "limitless",
    "link_loading", "loading_of", "momentum_residual", "newton_euler", "power_residual", "power_terms",
]  # fmt: skip
