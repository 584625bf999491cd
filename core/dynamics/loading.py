"""The loads that a design states, as force elements of its mechanism: one row per follower, one for linkages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from core.design import (
    CamSlider,
    CamSliderLoads,
    LinkageLoads,
    Loads,
    Oscillating,
    OscillatingFlat,
    OscillatingFlatLoads,
    OscillatingLoads,
    Translating,
    TranslatingLoads,
    si,
)
from core.design.parts import SIDES
from core.dynamics.elements import Friction, Inertia, Loading, Mass, OutputForce, PointForce, combined
from core.mechanism.mechanism import body_name
from core.numerics.vectors import heading


def _gravity(loads: Loads | LinkageLoads) -> complex:
    s = si(loads)
    return complex(s.gravity * heading(s.gravity_angle))


def _contact(loads: Loads | LinkageLoads) -> float:
    """The coefficient between face and cam."""
    return 0.0 if loads.contact is None else loads.contact.contact_friction


def _guide_friction(coefficient: float) -> tuple[Friction, ...]:
    return (Friction("guide", coefficient),) if coefficient else ()


def cam_slider_loading(follower: CamSlider, loads: CamSliderLoads) -> Loading:
    """The roller is fixed to the arm and turns with it; a roller that turns freely would leave out its inertia."""
    g, s, gravity = si(follower), si(loads), _gravity(loads)
    arm = Inertia(s.arm_mass, s.arm_centre * heading(s.arm_centre_angle), s.arm_inertia)
    roller = Inertia(s.roller_mass, g.roller_arm * heading(g.fixed_angle), s.roller_inertia)
    masses = (
        Mass("slider", Inertia(s.slider_mass), gravity),
        Mass("rod", Inertia(s.rod_mass, complex(s.rod_centre * g.rod), s.rod_inertia), gravity),
        Mass("arm", combined([arm, roller]), gravity),
    )
    return Loading(masses, (OutputForce(s.external_force, s.spring_rate),), _guide_friction(s.friction), "guide", _contact(loads))


def translating_loading(follower: Translating, loads: TranslatingLoads) -> Loading:
    """The closing spring presses towards the cam, against the rise."""
    s = si(loads)
    masses = (Mass("follower", Inertia(s.follower_mass), _gravity(loads)),)
    return Loading(masses, (OutputForce(-s.preload, s.spring_rate),), _guide_friction(s.friction), "guide", _contact(loads))


def oscillating_loading(follower: Oscillating, loads: OscillatingLoads) -> Loading:
    """The closing spring turns the arm towards the cam; the roller is fixed to the arm and turns with it."""
    g, s = si(follower), si(loads)
    arm = Inertia(s.arm_mass, s.arm_centre * heading(s.arm_centre_angle), s.arm_inertia)
    roller = Inertia(s.roller_mass, complex(g.arm), s.roller_inertia)
    masses = (Mass("arm", combined([arm, roller]), _gravity(loads)),)
    spring = OutputForce(-s.preload, s.spring_rate, SIDES[follower.side])
    return Loading(masses, (spring,), contact_friction=_contact(loads))


def oscillating_flat_loading(follower: OscillatingFlat, loads: OscillatingFlatLoads) -> Loading:
    """The arm's centre of mass is counted from the direction along the face towards the contact, -i m on the left, i m on the
    right; the body's x axis is m."""
    s, side = si(loads), SIDES[follower.side]
    centre = -1j * side * s.arm_centre * heading(s.arm_centre_angle)
    masses = (Mass("arm", Inertia(s.arm_mass, centre, s.arm_inertia), _gravity(loads)),)
    spring = OutputForce(-s.preload, s.spring_rate, side)
    return Loading(masses, (spring,), contact_friction=_contact(loads))


LOADINGS: Mapping[type, Callable[[Any, Any], Loading]] = MappingProxyType(
    {
        CamSliderLoads: cam_slider_loading,
        TranslatingLoads: translating_loading,
        OscillatingLoads: oscillating_loading,
        OscillatingFlatLoads: oscillating_flat_loading,
        LinkageLoads: lambda linkage, loads: link_loading(loads),
    }
)


def loading_of(mechanism: Any, loads: Any) -> Loading:
    """The force elements of a drive."""
    return LOADINGS[type(loads)](mechanism, loads)


def link_loading(loads: LinkageLoads) -> Loading:
    """The force elements of a linkage."""
    gravity, masses = _gravity(loads), []
    for mass in loads.masses:
        m = si(mass)
        masses.append(Mass(body_name(mass.link), Inertia(m.mass, complex(m.centre_x, m.centre_y), m.inertia), gravity))
    forces = (PointForce(body_name(f.link), f.point, complex(f.x_n, f.y_n), float(f.torque_nm)) for f in loads.forces)
    return Loading(tuple(masses), tuple(forces), contact_friction=_contact(loads))
