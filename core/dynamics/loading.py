"""Loading of a mechanism: the loads that a design states, as force elements; one row per follower, one for linkages."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from operator import attrgetter
from types import MappingProxyType
from typing import Any

import numpy as np

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
    Pushrod,
    PushrodLoads,
    Rocker,
    RockerLoads,
    SlideLoads,
    Translating,
    TranslatingLoads,
    TurnLoads,
    row_at,
    si,
)
from core.design.parts import SIDES, ValveTrainLoads
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
from core.dynamics.schedules import AngleWindow, MotionWindow, Schedule, ScheduleTable
from core.errors import NoSolution
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, Kinematics
from core.mechanism.mechanism import Mechanism, body_name
from core.numerics.derivatives import heading, vector
from core.numerics.lazy import lazy, self_locking

LOAD = "load"
"""Name of the follower's spring and external force among the elements."""


def _gravity(loads: Loads | LinkageLoads) -> complex:
    s = si(loads)
    return s.gravity * heading(s.gravity_angle)


def _contact(loads: Loads | LinkageLoads) -> float:
    """Coefficient of friction between face and cam."""
    return 0.0 if loads.contact is None else loads.contact.contact_friction


def _guide_friction(coefficient: float) -> tuple[Friction, ...]:
    return (Friction("guide", coefficient),) if coefficient else ()


def cam_slider_loading(follower: CamSlider, loads: CamSliderLoads) -> Loading:
    """Loading of a cam-slider; its roller is fixed to the arm and turns with it, so that its inertia counts."""
    g, s, gravity = si(follower), si(loads), _gravity(loads)
    arm = Inertia(s.arm_mass, s.arm_centre * heading(s.arm_centre_angle), s.arm_inertia)
    roller = Inertia(s.roller_mass, g.roller_arm * heading(g.fixed_angle), s.roller_inertia)
    masses = (
        Mass("slider", Inertia(s.slider_mass), gravity),
        Mass("rod", Inertia(s.rod_mass, s.rod_centre * g.rod + 0j, s.rod_inertia), gravity),
        Mass("arm", combined_inertia([arm, roller]), gravity),
    )
    force = OutputForce(s.external_force, s.spring_rate, name=LOAD)
    return Loading(masses, (force,), _guide_friction(s.friction), "guide", _contact(loads))


def _closing_spring(loads: TranslatingLoads | ValveTrainLoads, pair: str = "") -> tuple[OutputForce, float]:
    """Spring that closes a valve: its force on the valve, and the mass [kg] of it that moves with the valve."""
    if not loads.valve_springs:
        s = si(loads)
        return OutputForce(-s.preload, s.spring_rate, name=LOAD, pair=pair), 0.0
    from core.dynamics.valve_springs import helical_springs  # few designs have them

    springs = helical_springs(loads)
    preload, rate, mass = (sum(getattr(row, name) for row in springs) for name in ("preload", "rate", "active_mass"))
    return OutputForce(-preload, rate, name=LOAD, pair=pair), mass / 3.0


def translating_loading(follower: Translating, loads: TranslatingLoads) -> Loading:
    """Loading of a translating follower; the closing spring presses it towards the cam, against the rise."""
    s, (spring, of_spring) = si(loads), _closing_spring(loads)
    mass = s.follower_mass + of_spring + (0.0 if loads.valve_mass_kg is None else s.valve_mass)
    masses = (Mass("follower", Inertia(mass), _gravity(loads)),)
    return Loading(
        masses,
        (spring,),
        _guide_friction(s.friction),
        "guide",
        _contact(loads),
    )


def oscillating_loading(follower: Oscillating, loads: OscillatingLoads) -> Loading:
    """Loading of an oscillating follower with a spring towards the cam; the roller is fixed to the arm."""
    g, s = si(follower), si(loads)
    arm = Inertia(s.arm_mass, s.arm_centre * heading(s.arm_centre_angle), s.arm_inertia)
    roller = Inertia(s.roller_mass, g.arm + 0j, s.roller_inertia)
    masses = (Mass("arm", combined_inertia([arm, roller]), _gravity(loads)),)
    spring = OutputForce(-s.preload, s.spring_rate, SIDES[follower.side], LOAD)
    return Loading(masses, (spring,), contact_friction=_contact(loads))


def oscillating_flat_loading(follower: OscillatingFlat, loads: OscillatingFlatLoads) -> Loading:
    """Loading of an oscillating flat-faced follower, whose body has the x axis m.

    The angle of its centre of mass is measured from the direction along the face towards the contact: -i m on the left,
    i m on the right.
    """
    s, side = si(loads), SIDES[follower.side]
    centre = -1j * side * s.arm_centre * heading(s.arm_centre_angle)
    masses = (Mass("arm", Inertia(s.arm_mass, centre, s.arm_inertia), _gravity(loads)),)
    spring = OutputForce(-s.preload, s.spring_rate, side, LOAD)
    return Loading(masses, (spring,), contact_friction=_contact(loads))


def rocker_loading(follower: Rocker, loads: RockerLoads) -> Loading:
    """Loading of a rocker and its valve; the roller is fixed to the rocker, and the spring closes the valve."""
    g, s, gravity = si(follower), si(loads), _gravity(loads)
    spring, of_spring = _closing_spring(loads)
    rocker = Inertia(0.0, 0j, s.rocker_inertia)
    roller = Inertia(s.roller_mass, g.arm + 0j, s.roller_inertia)
    masses = (
        Mass("valve", Inertia(s.valve_mass + of_spring), gravity),
        Mass("rocker", combined_inertia([rocker, roller]), gravity),
    )
    return Loading(masses, (spring,), contact_friction=_contact(loads))


def pushrod_loading(follower: Pushrod, loads: PushrodLoads) -> Loading:
    """Loading of a pushrod train; half of the pushrod's mass is at each of its balls, and the spring closes the valve."""
    g, s, gravity = si(follower), si(loads), _gravity(loads)
    spring, of_spring = _closing_spring(loads, "valve_guide")
    half = 0.5 * s.pushrod_mass
    tappet = (Inertia(s.tappet_mass), Inertia(half, vector(g.seat_x, g.seat_y)))
    rocker = (Inertia(0.0, 0j, s.rocker_inertia), Inertia(half, g.push_arm + 0j))
    masses = (
        Mass("tappet", combined_inertia(tappet), gravity),
        Mass("rocker", combined_inertia(rocker), gravity),
        Mass("valve", Inertia(s.valve_mass + of_spring), gravity),
    )
    return Loading(masses, (spring,), contact_friction=_contact(loads))


def slide_loading(output: Output, loads: SlideLoads) -> Loading:
    """Loading of a mass on a slide; gravity acts along it only as far as the stated force contains it."""
    return _on_output(Inertia(loads.mass_kg), loads.force_n, loads.friction_n)


def turn_loading(output: Output, loads: TurnLoads) -> Loading:
    """Loading of an inertia about the pivot."""
    return _on_output(Inertia(0.0, 0j, loads.inertia_kg_m2), loads.torque_nm, loads.friction_nm)


def _on_output(inertia: Inertia, force: float, friction: float) -> Loading:
    return Loading((Mass("output", inertia),), (OutputForce(force, name=LOAD), OutputFriction(friction)))


LOADINGS: Mapping[type, Callable[[Any, Any], Loading]] = MappingProxyType(
    {
        CamSliderLoads: cam_slider_loading,
        TranslatingLoads: translating_loading,
        OscillatingLoads: oscillating_loading,
        OscillatingFlatLoads: oscillating_flat_loading,
        RockerLoads: rocker_loading,
        PushrodLoads: pushrod_loading,
        SlideLoads: slide_loading,
        TurnLoads: turn_loading,
        LinkageLoads: lambda linkage, loads: link_loading(loads),
    }
)


_element_lists = attrgetter(*ELEMENT_LISTS)


def loading_of(mechanism: Any, loads: Any, built: Mechanism | None = None, lash: Lash | None = None) -> Loading:
    """Loading of a drive; ``built`` is its linkage, whose links the springs, pairs and process forces name.

    Raises NoSolution where the linkage does not have a pair that has friction.
    """
    follower: Loading = LOADINGS[type(loads)](mechanism, loads)
    if lash is not None:
        follower = _with_lash(follower, lash)
    if built is None or not any(_element_lists(loads)):
        return follower
    elements: tuple[Element, ...] = (
        *_springs(loads, built),
        *_torsion_springs(loads, built),
        *_process(loads, built, follower),
    )
    return replace(
        follower, others=(*follower.others, *elements), frictions=(*follower.frictions, *_frictions(loads, built))
    )


def _with_lash(loading: Loading, lash: Lash) -> Loading:
    """The loading of a valve train with lash; its spring begins to yield where the lash is taken up."""
    others = tuple(
        replace(element, force=element.force + element.rate * lash.at_valve)
        if isinstance(element, OutputForce) and element.name == LOAD
        else element
        for element in loading.others
    )
    return replace(loading, others=others, contact_window=MotionWindow(lash.at_motion, math.inf))


# -- elements of any design --------------------------------------------------------------------------------


def attachment_point(at: Attachment, built: Mechanism) -> BodyPoint:
    """Point in the frame of a body that an attachment names; the origin of a link alone. Raises KeyError."""
    if at.point is not None:
        return BodyPoint(*built.body_point(at.link, at.point))
    s = si(at)
    return BodyPoint(built.bodies.get(at.link, FRAME), vector(s.x or 0.0, s.y or 0.0))


def _springs(loads: ForceElements, built: Mechanism) -> Iterator[Spring]:
    for i, row in enumerate(loads.springs, 1):
        s, ends = si(row), (attachment_point(row.from_, built), attachment_point(row.to, built))
        yield Spring(*ends, s.rate, s.free_length, s.damping, f"spring{i}", f"loads.springs[{i - 1}]")


def _torsion_springs(loads: ForceElements, built: Mechanism) -> Iterator[Torsion]:
    """Torsion springs between links; their angles are those in the global frame, as their points are."""
    for i, row in enumerate(loads.torsion_springs, 1):
        s, body, on = si(row), built.bodies.get(row.link, FRAME), built.bodies.get(row.on, FRAME)
        yield Torsion(
            body, on, s.rate, s.free_angle, s.damping, f"torsion_spring{i}", f"loads.torsion_springs[{i - 1}]"
        )


def pairs_named(pair: str, links: Collection[int], built: Mechanism) -> list[str]:
    """Names of the pairs that a design calls ``pair``, between these links where they are given."""
    return [
        name
        for joint, name in built.pair_names.items()
        if pair in (name, joint.name) and set(links) <= {joint.first.link, joint.second.link}
    ]


def _frictions(loads: ForceElements, built: Mechanism) -> Iterator[Friction]:
    for i, row in enumerate(loads.pair_friction):
        s, links = si(row), {n for n in (row.link, row.other) if n is not None}
        pairs = pairs_named(row.pair, links, built)
        if not pairs:
            candidates = [sorted((j.first.link, j.second.link)) for j in built.pair_names if j.name == row.pair]
            path = f"loads.pair_friction[{i}].links"
            raise NoSolution(
                f"no pair of {row.pair} joins links {sorted(links)}", path, " or ".join(map(str, candidates))
            )
        radius = 1.0 if row.radius_mm is None else s.radius
        yield Friction(pairs[0], s.coefficient, radius, s.length or 0.0, f"loads.pair_friction[{i}].coefficient")


def _schedule(row: Process) -> Schedule:
    """Schedule of a process force; a table contains the values of the force."""
    s = si(row)
    if row.points:
        return ScheduleTable(tuple(math.radians(p.deg) for p in row.points), tuple(p.value for p in row.points))
    if row.cam_from_deg is not None:
        return AngleWindow(s.cam_from, s.cam_to)
    if row.position_from_mm is not None and row.position_to_mm is not None:
        unit = UNITS["mm"].factor
        return MotionWindow(row.position_from_mm * unit, row.position_to_mm * unit)
    assert row.position_from_deg is not None, "no part of the turn and none of the motion"
    assert row.position_to_deg is not None, "a part of the motion without its end"
    return MotionWindow(math.radians(row.position_from_deg), math.radians(row.position_to_deg))


def _process(loads: ForceElements, built: Mechanism, follower: Loading) -> Iterator[ScheduledForce]:
    for i, row in enumerate(loads.process, 1):
        s, schedule, name, field = si(row), _schedule(row), f"process{i}", f"loads.process[{i - 1}]"
        table = bool(row.points)
        if row.link is None:
            size = 1.0 if table else row.force_n + row.torque_nm
            yield ScheduledForce(schedule, size, built.driver_sign, name=name, field=field)
            continue
        body, origin = built.bodies[row.link], 0j
        point = BodyPoint(body, origin) if row.point is None else BodyPoint(*built.body_point(row.link, row.point))
        is_force = row.direction_deg is not None
        force = (1.0 if table else row.force_n) * heading(s.direction) if is_force else 0j
        torque = 1.0 if table and not is_force else row.torque_nm
        yield ScheduledForce(schedule, point=point, force=force, torque=torque, name=name, field=field)


NAMES: Mapping[str, str] = MappingProxyType(
    {"springs": "spring", "torsion_springs": "torsion_spring", "process": "process", "forces": "force"}
)
"""List of the loads -> prefix of its elements' names, before their numbers from 1."""


def row_of_element(name: str) -> str:
    """Path of the row of an element: ``spring1`` -> ``loads.springs[0]``; empty for a name without a row."""
    match = re.fullmatch(r"(\w*?)(\d+)", name)
    lists = [key for key, word in NAMES.items() if match is not None and word == match[1]]
    return f"loads.{lists[0]}[{int(match[2]) - 1}]" if match is not None and lists else ""


def element_at(loading: Loading, path: str) -> Element | None:
    """Force element of a row of the loads, by its path, as ``loads.springs[0]``; None for friction."""
    name, number, _ = row_at(path)
    if name == "loads.masses":
        return loading.masses[number] if number < len(loading.masses) else None
    return loading.named.get(f"{NAMES.get(name.removeprefix('loads.'), '')}{number + 1}") if name else None


def link_loading(loads: LinkageLoads) -> Loading:
    """Loading of a linkage."""
    gravity, masses = _gravity(loads), []
    for mass in loads.masses:
        m = si(mass)
        masses.append(Mass(body_name(mass.link), Inertia(m.mass, vector(m.centre_x, m.centre_y), m.inertia), gravity))
    forces = (
        PointForce(body_name(f.link), f.point, vector(f.x_n, f.y_n), f.torque_nm, f"force{i}")
        for i, f in enumerate(loads.forces, 1)
    )
    return Loading(tuple(masses), tuple(forces), contact_friction=_contact(loads))


# -- loading of a mechanism -------------------------------------------------------------------------------------


@frozen
class Friction:
    """Coulomb friction of a pair: μ|N| along the line of a sliding pair, the moment μ r |R| in a pin of radius r [m].

    Attributes
    ----------
    length : length of a sliding pair [m], whose edges transmit N/2 ± M/length, M its couple; 0: N acts at one point
    field : path of its row in the file
    """

    pair: str
    coefficient: float
    radius: float = 1.0
    length: float = 0.0
    field: str = "loads.friction"

    @property
    def is_guide(self) -> bool:
        """Whether it is the friction of the follower's guide."""
        return self.field == "loads.friction"


@frozen
class Lash:
    """Lash of a valve train: its size at the valve's tip [m], and the motion [m or rad] at which it is taken up."""

    at_valve: float
    at_motion: float


@self_locking
@frozen
class Loading:
    """Forces on a mechanism: masses, other force elements, and friction of pairs.

    Attributes
    ----------
    guide : name of the pair whose friction is the design's guide friction; empty without a guide
    contact_friction : coefficient of a face that slides on the cam
    contact_window : motion in which the follower touches the cam; elsewhere a valve train is loose, and nothing loads it
    """

    masses: tuple[Mass, ...] = ()
    others: tuple[Element, ...] = ()
    frictions: tuple[Friction, ...] = ()
    guide: str = ""
    contact_friction: float = 0.0
    contact_window: MotionWindow | None = None

    @property
    def named(self) -> Mapping[str, Element]:
        """Name -> element whose power is a channel."""
        return MappingProxyType({element.name: element for element in self.others if element.name})

    @property
    def switches(self) -> tuple[Schedule, ...]:
        """Schedules of its process forces, and the motion in which the follower touches the cam."""
        schedules = tuple(element.schedule for element in self.others if isinstance(element, ScheduledForce))
        return schedules if self.contact_window is None else (*schedules, self.contact_window)

    def cuts(self, program: Any) -> np.ndarray:
        """Cam angles at which a force switches.

        Parameters
        ----------
        program : CompiledMotion

        Returns
        -------
        ndarray (m,) [rad]
        """
        angles = [schedule.cuts(program) for schedule in self.switches]
        return np.concatenate(angles) if angles else np.zeros(0)

    def acting(self, kinematics: Kinematics) -> np.ndarray | float:
        """Factor of all loads: 1, and 0 where a valve train is loose.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.

        Returns
        -------
        ndarray (n,) or 1.0, dimensionless
        """
        return 1.0 if self.contact_window is None else self.contact_window.value(kinematics.motion)[0]

    def loads(self, kinematics: Kinematics, rate: Rate) -> list[Load]:
        """Loads of all active elements on the bodies, inertia forces included.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.
        rate : Rate

        Returns
        -------
        list of Load
        """
        loads = [load for element in self.elements for load in element.loads(kinematics, rate)]
        if self.contact_window is None:
            return loads
        factor = self.acting(kinematics)
        return [load._replace(force=load.force * factor, couple=load.couple * factor) for load in loads]

    @property
    def has_friction(self) -> bool:
        """Whether pairs or the cam's face have friction, so that something might jam."""
        return bool(self.frictions or self.contact_friction)

    @lazy
    def elements(self) -> tuple[Element, ...]:
        """All active elements."""
        return tuple([element for element in (*self.masses, *self.others) if element.is_active])

    @property
    def is_empty(self) -> bool:
        """Whether no element is active."""
        return not self.elements

    @property
    def friction(self) -> float:
        """Coefficient of the guide."""
        return next((f.coefficient for f in self.frictions if f.pair == self.guide), 0.0)

    @property
    def frictionless(self) -> Loading:
        """The same loading without friction."""
        return Loading(self.masses, self.others, (), self.guide, contact_window=self.contact_window)

    @property
    def inertial(self) -> Loading:
        """The masses alone, without their weight."""
        masses = tuple(Mass(m.body, m.inertia) for m in self.masses)
        return Loading(masses, (), (), self.guide, contact_window=self.contact_window)

    @property
    def inertial_with_contact(self) -> Loading:
        """The masses alone, with the friction of a face that slides on the cam."""
        return replace(self.inertial, contact_friction=self.contact_friction)

    def inertia(self, kinematics: Kinematics, orders: int = 3) -> np.ndarray:
        """Inertia J(θ) of all bodies reduced to the camshaft, and J', J'': the kinetic energy is J θ̇²/2.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.
        orders : int
            Number of rows, 1 to 3.

        Returns
        -------
        ndarray (orders, n) [kg m²]
        """
        zero = np.zeros((orders, kinematics.count))
        return sum((mass.reduced_inertia(kinematics, orders) for mass in self.masses), zero)

    def potential(self, kinematics: Kinematics) -> np.ndarray:
        """V'(θ) and V'' of all elements: V' is the torque at standstill that they require from the cam.

        Parameters
        ----------
        kinematics : Kinematics
            At n cam angles.

        Returns
        -------
        ndarray (2, n) [N m]
        """
        zero = np.zeros((2, kinematics.count))
        return self.acting(kinematics) * sum((element.potential(kinematics) for element in self.elements), zero)
