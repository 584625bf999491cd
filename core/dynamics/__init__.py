"""Forces and torque of a mechanism at constant speed, with their proof."""

from typing import TYPE_CHECKING

from core.dynamics.checks import (
    FlankChange,
    change_findings,
    element_findings,
    element_power,
    findings,
    flank_changes,
    gravity_power,
    input_power,
    jam_finding,
    kinetic_energy,
    momentum_residual,
    peak_load,
    power_residual,
    power_terms,
)
from core.dynamics.elements import (
    BodyPoint,
    Element,
    Inertia,
    Load,
    Mass,
    OutputForce,
    OutputFriction,
    PointForce,
    Rate,
    ScheduledForce,
    Spring,
    Torsion,
    combined_inertia,
)
from core.dynamics.forces import BEARING, CAM_FACE, Forces, edge_forces, newton_euler, with_cam_in_space
from core.dynamics.friction import JAMS, GuideReaction, guide_reaction, with_infinities
from core.dynamics.loading import (
    LOADINGS,
    Friction,
    Lash,
    Loading,
    attachment_point,
    element_at,
    link_loading,
    loading_of,
    pairs_named,
    row_of_element,
)
from core.dynamics.unit_loads import UnitLoads, unit_loads
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
        MASS_KINDS,
        REACTION,
        SPRING,
        WEIGHT,
        ForceOnBody,
        body_inertias,
        element_forces,
        free_bodies,
        imbalance,
    )
    from core.dynamics.valve_springs import HARMONICS, HelicalSpring, helical_springs, periodic_sum, surge_harmonics
else:
    __getattr__ = lazy_attributes(__name__, "free_body", "contact_force", "flight", "valve_springs")

__all__ = [
    "BEARING", "CAM_FACE", "CONTACT", "DRIVE", "FRICTION", "HARMONICS", "INERTIA", "JAMS", "KINDS", "LOAD", "LOADINGS",
    "MASS_KINDS", "REACTION", "SPRING", "WEIGHT", "BodyPoint", "ContactForce", "ContactMap", "Element", "FlankChange",
    "Flight", "Flights", "ForceOnBody", "Forces", "Friction", "GuideReaction", "HelicalSpring", "Inertia", "Lash",
    "LeastForce", "LiftOff", "Load", "Loading", "Mass", "OutputForce", "OutputFriction", "PointForce", "Rate",
    "ScheduledForce", "Spring", "Torsion", "UnitLoads", "attachment_point", "body_inertias", "change_findings",
    "combined_inertia", "contact_map", "edge_forces", "element_at", "element_findings", "element_forces",
    "element_power", "findings", "flank_changes", "flights", "free_bodies", "gravity_power", "guide_reaction",
    "helical_springs", "imbalance", "input_power", "jam_finding", "kinetic_energy", "link_loading", "loading_of",
    "momentum_residual", "newton_euler", "pairs_named", "peak_load", "periodic_sum", "power_residual", "power_terms",
    "row_of_element", "surge_harmonics", "unit_loads", "with_cam_in_space", "with_impacts", "with_infinities",
]  # fmt: skip
