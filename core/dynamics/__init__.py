"""Forces and torque of a train at constant speed, with their proof."""

from core.dynamics.balance import kinetic_energy, momentum_residual, power_residual
from core.dynamics.forces import DYADS, GROUNDS, Forces, newton_euler
from core.dynamics.friction import GuideReaction, guide_reaction, limitless
from core.dynamics.limits import findings
from core.dynamics.loading import LOADINGS, Inertia, Loading, combined, loading_of

__all__ = [
    "DYADS", "GROUNDS", "LOADINGS", "Forces", "GuideReaction", "Inertia", "Loading", "combined", "findings",
    "guide_reaction", "kinetic_energy", "limitless", "loading_of", "momentum_residual", "newton_euler", "power_residual",
]  # fmt: skip
