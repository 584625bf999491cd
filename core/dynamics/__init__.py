"""Forces and torque of a train at constant speed, with their proof."""

from core.dynamics.balance import kinetic_energy, momentum_residual, power_residual, reduced_inertia
from core.dynamics.forces import DYADS, GROUNDS, Forces, newton_euler
from core.dynamics.friction import GuideReaction, guide_reaction, limitless
from core.dynamics.limits import JAMS, findings
from core.dynamics.linkage import (
    STATICS,
    LinkageForces,
    LinkLoading,
    link_loading,
    linkage_forces,
)
from core.dynamics.linkage_balance import linkage_momentum_residual, linkage_power_residual
from core.dynamics.loading import LOADINGS, Inertia, Loading, combined, loading_of

__all__ = [
    "DYADS", "GROUNDS", "JAMS", "LOADINGS", "STATICS", "Forces", "GuideReaction", "Inertia", "LinkLoading", "LinkageForces", "Loading",
    "combined", "findings", "guide_reaction", "kinetic_energy", "limitless", "link_loading", "linkage_forces",
    "linkage_momentum_residual", "linkage_power_residual", "loading_of", "momentum_residual", "newton_euler", "power_residual",
    "reduced_inertia",
]  # fmt: skip
