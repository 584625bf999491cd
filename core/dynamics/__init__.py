"""Forces and torque of a mechanism at constant speed, with their proof."""

from typing import TYPE_CHECKING

from core.dynamics.checks import (
    FlankChange,
    change_findings,
    element_findings,
    findings,
    flank_changes,
    jam_finding,
    kinetic_energy,
    momentum_residual,
    peak_load,
    power_given,
    power_of,
    power_of_gravity,
    power_residual,
    power_terms,
)
from core.dynamics.elements import (
    BodyPoint,
    Element,
    Friction,
    Inertia,
    Load,
    Loading,
    Mass,
    OutputForce,
    OutputFriction,
    PointForce,
    Rate,
    ScheduledForce,
    Spring,
    Torsion,
    combined,
)
from core.dynamics.forces import BEARING, CAM_FACE, JAMS, Forces, carried, newton_euler
from core.dynamics.friction import GuideReaction, guide_reaction, limitless
from core.dynamics.loading import LOADINGS, element_at, link_loading, loading_of, pairs_named, place_at, row_of_element
from core.process import lazy_attributes

if TYPE_CHECKING:
    from core.dynamics.contact_force import ContactForce, ContactMap, LeastForce, LiftOff, contact_map
    from core.dynamics.flight import Flight, Flights, flights, with_impacts
    from core.dynamics.free_body import (
        CONTACT,
        DRIVE,
        FRICTION,
        INERTIA,
        KINDS,
        LOAD,
        OF_MASSES,
        REACTION,
        SPRING,
        WEIGHT,
        ForceOnBody,
        acting_of,
        free_bodies,
        masses_of,
        unbalanced,
    )
else:
    __getattr__ = lazy_attributes(__name__, "free_body", "contact_force", "flight")

__all__ = [
    "BEARING", "CAM_FACE", "CONTACT", "DRIVE", "FRICTION", "INERTIA", "JAMS", "KINDS", "LOAD", "LOADINGS", "OF_MASSES", "REACTION",
    "SPRING", "WEIGHT", "BodyPoint", "ContactForce", "ContactMap", "Element", "FlankChange", "Flight", "Flights", "ForceOnBody",
    "Forces", "Friction", "GuideReaction", "Inertia", "LeastForce", "LiftOff", "Load", "Loading", "Mass", "OutputForce", "OutputFriction",
    "PointForce", "Rate", "ScheduledForce", "Spring", "Torsion", "acting_of", "carried", "change_findings", "combined",
    "contact_map", "element_at", "element_findings", "findings", "flank_changes", "flights", "free_bodies", "guide_reaction",
    "jam_finding", "kinetic_energy", "limitless", "link_loading", "loading_of", "masses_of", "momentum_residual", "newton_euler",
    "pairs_named", "peak_load", "place_at", "power_given", "power_of", "power_of_gravity", "power_residual", "power_terms",
    "row_of_element", "unbalanced", "with_impacts",
]  # fmt: skip
