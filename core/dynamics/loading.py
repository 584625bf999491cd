"""The loads that a design states, as force elements of its mechanism: one row per follower, one for linkages."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design import (
    ELEMENT_LISTS,
    UNITS,
    Attachment,
    CamSlider,
    CamSliderLoads,
    ForceElements,
    LinkageLoads,
    Loads,
    Oscillating,
    OscillatingFlat,
    OscillatingFlatLoads,
    OscillatingLoads,
    Output,
    Process,
    SlideLoads,
    Translating,
    TranslatingLoads,
    TurnLoads,
    row_at,
    si,
)
from core.design.parts import SIDES
from core.dynamics.elements import (
    BodyPoint,
    ByTable,
    Element,
    Friction,
    Inertia,
    Loading,
    Mass,
    OutputForce,
    OutputFriction,
    OverMotion,
    OverTurn,
    PointForce,
    Schedule,
    ScheduledForce,
    Spring,
    Torsion,
    combined,
)
from core.errors import NoSolution
from core.mechanism.kinematics import FRAME
from core.mechanism.mechanism import Mechanism, body_name
from core.numerics.derivatives import heading, vector

LOAD = "load"
"""Name of a follower's own spring and external force among the elements."""


def _gravity(loads: Loads | LinkageLoads) -> complex:
    s = si(loads)
    return s.gravity * heading(s.gravity_angle)


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
        Mass("rod", Inertia(s.rod_mass, s.rod_centre * g.rod + 0j, s.rod_inertia), gravity),
        Mass("arm", combined([arm, roller]), gravity),
    )
    force = OutputForce(s.external_force, s.spring_rate, name=LOAD)
    return Loading(masses, (force,), _guide_friction(s.friction), "guide", _contact(loads))


def translating_loading(follower: Translating, loads: TranslatingLoads) -> Loading:
    """The closing spring presses towards the cam, against the rise."""
    s = si(loads)
    masses = (Mass("follower", Inertia(s.follower_mass), _gravity(loads)),)
    return Loading(
        masses,
        (OutputForce(-s.preload, s.spring_rate, name=LOAD),),
        _guide_friction(s.friction),
        "guide",
        _contact(loads),
    )


def oscillating_loading(follower: Oscillating, loads: OscillatingLoads) -> Loading:
    """The closing spring turns the arm towards the cam; the roller is fixed to the arm and turns with it."""
    g, s = si(follower), si(loads)
    arm = Inertia(s.arm_mass, s.arm_centre * heading(s.arm_centre_angle), s.arm_inertia)
    roller = Inertia(s.roller_mass, g.arm + 0j, s.roller_inertia)
    masses = (Mass("arm", combined([arm, roller]), _gravity(loads)),)
    spring = OutputForce(-s.preload, s.spring_rate, SIDES[follower.side], LOAD)
    return Loading(masses, (spring,), contact_friction=_contact(loads))


def oscillating_flat_loading(follower: OscillatingFlat, loads: OscillatingFlatLoads) -> Loading:
    """The arm's centre of mass is counted from the direction along the face towards the contact, -i m on the left, i m on the
    right; the body's x axis is m."""
    s, side = si(loads), SIDES[follower.side]
    centre = -1j * side * s.arm_centre * heading(s.arm_centre_angle)
    masses = (Mass("arm", Inertia(s.arm_mass, centre, s.arm_inertia), _gravity(loads)),)
    spring = OutputForce(-s.preload, s.spring_rate, side, LOAD)
    return Loading(masses, (spring,), contact_friction=_contact(loads))


def slide_loading(output: Output, loads: SlideLoads) -> Loading:
    """A mass on a slide; no weight acts along it but as the force that is stated."""
    return _on_output(Inertia(loads.mass_kg), loads.force_n, loads.friction_n)


def turn_loading(output: Output, loads: TurnLoads) -> Loading:
    """An inertia about the pivot."""
    return _on_output(Inertia(0.0, 0j, loads.inertia_kg_m2), loads.torque_nm, loads.friction_nm)


def _on_output(inertia: Inertia, force: float, friction: float) -> Loading:
    return Loading((Mass("output", inertia),), (OutputForce(force, name=LOAD), OutputFriction(friction)))


LOADINGS: Mapping[type, Callable[[Any, Any], Loading]] = MappingProxyType(
    {
        CamSliderLoads: cam_slider_loading,
        TranslatingLoads: translating_loading,
        OscillatingLoads: oscillating_loading,
        OscillatingFlatLoads: oscillating_flat_loading,
        SlideLoads: slide_loading,
        TurnLoads: turn_loading,
        LinkageLoads: lambda linkage, loads: link_loading(loads),
    }
)


def loading_of(mechanism: Any, loads: Any, built: Mechanism | None = None) -> Loading:
    """The force elements of a drive; built: its linkage, whose links springs, pairs and process forces name. Raises NoSolution where
    a pair that rubs is none of its pairs."""
    own: Loading = LOADINGS[type(loads)](mechanism, loads)
    if built is None or not any(getattr(loads, name) for name in ELEMENT_LISTS):
        return own
    more: tuple[Element, ...] = (*_springs(loads, built), *_torsion_springs(loads, built), *_process(loads, built, own))
    return replace(own, others=(*own.others, *more), frictions=(*own.frictions, *_frictions(loads, built)))


# -- elements that any design can have ---------------------------------------------------------------------


def place_at(at: Attachment, built: Mechanism) -> BodyPoint:
    """The place in the frame of a body that an attachment names; of a link alone its origin. Raises KeyError."""
    if at.point is not None:
        return BodyPoint(*built.body_point(at.link, at.point))
    s = si(at)
    return BodyPoint(built.bodies.get(at.link, FRAME), vector(s.x or 0.0, s.y or 0.0))


def _springs(loads: ForceElements, built: Mechanism) -> Iterator[Spring]:
    for i, row in enumerate(loads.springs, 1):
        s, ends = si(row), (place_at(row.from_, built), place_at(row.to, built))
        yield Spring(*ends, s.rate, s.free_length, s.damping, f"spring{i}", f"loads.springs[{i - 1}]")


def _torsion_springs(loads: ForceElements, built: Mechanism) -> Iterator[Torsion]:
    """Angles of links are those in the global frame, as their places are."""
    for i, row in enumerate(loads.torsion_springs, 1):
        s, body, on = si(row), built.bodies.get(row.link, FRAME), built.bodies.get(row.on, FRAME)
        yield Torsion(
            body, on, s.rate, s.free_angle, s.damping, f"torsion_spring{i}", f"loads.torsion_springs[{i - 1}]"
        )


def pairs_named(pair: str, links: Collection[int], built: Mechanism) -> list[str]:
    """The pairs of a mechanism that a design calls so, between these links where they are given."""
    return [
        name
        for joint, name in built.pair_names.items()
        if pair in (name, joint.name) and set(links) <= {joint.first.link, joint.second.link}
    ]


def _frictions(loads: ForceElements, built: Mechanism) -> Iterator[Friction]:
    for i, row in enumerate(loads.pair_friction):
        s, links = si(row), {n for n in (row.link, row.other) if n is not None}
        found = pairs_named(row.pair, links, built)
        if not found:
            others = [sorted((j.first.link, j.second.link)) for j in built.pair_names if j.name == row.pair]
            path = f"loads.pair_friction[{i}].links"
            raise NoSolution(f"no pair of {row.pair} joins links {sorted(links)}", path, " or ".join(map(str, others)))
        radius = 1.0 if row.radius_mm is None else s.radius
        yield Friction(found[0], s.coefficient, radius, s.length or 0.0, f"loads.pair_friction[{i}].coefficient")


def _schedule(row: Process) -> Schedule:
    """When a process force works; of a table the values are those of the force."""
    s = si(row)
    if row.points:
        return ByTable(tuple(math.radians(p.deg) for p in row.points), tuple(p.value for p in row.points))
    if row.cam_from_deg is not None:
        return OverTurn(s.cam_from, s.cam_to)
    if row.position_from_mm is not None and row.position_to_mm is not None:
        unit = UNITS["mm"].factor
        return OverMotion(row.position_from_mm * unit, row.position_to_mm * unit)
    assert row.position_from_deg is not None, "no part of the turn and none of the motion"
    assert row.position_to_deg is not None, "a part of the motion without its end"
    return OverMotion(math.radians(row.position_from_deg), math.radians(row.position_to_deg))


def _process(loads: ForceElements, built: Mechanism, own: Loading) -> Iterator[ScheduledForce]:
    for i, row in enumerate(loads.process, 1):
        s, schedule, name, field = si(row), _schedule(row), f"process{i}", f"loads.process[{i - 1}]"
        table = bool(row.points)
        if row.link is None:
            size = 1.0 if table else row.force_n + row.torque_nm
            yield ScheduledForce(schedule, along=size, sense=built.driver_sign, name=name, field=field)
            continue
        at = (
            BodyPoint(built.bodies[row.link], 0j)
            if row.point is None
            else BodyPoint(*built.body_point(row.link, row.point))
        )
        directed = row.direction_deg is not None
        force = (1.0 if table else row.force_n) * heading(s.direction) if directed else 0j
        torque = 1.0 if table and not directed else row.torque_nm
        yield ScheduledForce(schedule, place=at, force=force, torque=torque, name=name, field=field)


NAMES: Mapping[str, str] = MappingProxyType(
    {"springs": "spring", "torsion_springs": "torsion_spring", "process": "process", "forces": "force"}
)
"""List of the loads -> what its elements are called, with their numbers from 1."""


def row_of_element(name: str) -> str:
    """The row of the loads that an element comes from, by its path: ``spring1`` -> ``loads.springs[0]``; empty where it has none of
    its own."""
    match = re.fullmatch(r"(\w*?)(\d+)", name)
    lists = [key for key, word in NAMES.items() if match is not None and word == match[1]]
    return f"loads.{lists[0]}[{int(match[2]) - 1}]" if match is not None and lists else ""


def element_at(loading: Loading, path: str) -> Element | None:
    """The force element of a row of the loads, by its path: ``loads.springs[0]``; None where it is friction."""
    name, number, _ = row_at(path)
    if name == "loads.masses":
        return loading.masses[number] if number < len(loading.masses) else None
    return loading.named.get(f"{NAMES.get(name.removeprefix('loads.'), '')}{number + 1}") if name else None


def link_loading(loads: LinkageLoads) -> Loading:
    """The force elements of a linkage."""
    gravity, masses = _gravity(loads), []
    for mass in loads.masses:
        m = si(mass)
        masses.append(Mass(body_name(mass.link), Inertia(m.mass, vector(m.centre_x, m.centre_y), m.inertia), gravity))
    forces = (
        PointForce(body_name(f.link), f.point, vector(f.x_n, f.y_n), f.torque_nm, f"force{i}")
        for i, f in enumerate(loads.forces, 1)
    )
    return Loading(tuple(masses), tuple(forces), contact_friction=_contact(loads))
