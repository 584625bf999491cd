"""Values of the rows of ``core.study.quantities``, as functions of a study in SI units; and the members of a linkage with rows."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType

import numpy as np

from core.cam import SECOND, forward_push
from core.design import FOLLOWER_KINDS, FRAME_LINK, Design, si
from core.design.topology import GROUP, INPUT, driver_pair, input_slides, is_pin, solving_order
from core.dynamics import CAM_FACE, GuideReaction, loading_of
from core.errors import DesignError, NoSolution
from core.mechanism import mechanism_of
from core.mechanism.kinematics import SLIDING
from core.motion import Angles
from core.numerics.derivatives import Derivatives, spread
from core.shaft import Flywheel
from core.study.study import Study

Part = Callable[[np.ndarray], np.ndarray]
POINT_COMPONENTS: Mapping[str, tuple[int, Part]] = MappingProxyType(
    {"x": (0, np.real), "y": (0, np.imag), "vx": (1, np.real), "vy": (1, np.imag), "ax": (2, np.real), "ay": (2, np.imag),
     "speed": (1, np.abs)}
)  # fmt: skip
"""Component of a point's motion -> order of the derivative by time, and part of the complex number."""


def _direction(force: np.ndarray) -> np.ndarray:
    """Angle of a force; 0 where there is none, whatever the signs of its zeros."""
    return np.angle(force + 0.0)


FORCE_COMPONENTS: Mapping[str, Part] = MappingProxyType(
    {"x": np.real, "y": np.imag, "size": np.abs, "direction": _direction}
)
"""Component of a force -> part of the complex number."""


SLIDER, PUSHROD = frozenset({"cam-slider"}), frozenset({"pushrod"})
TRAINS = frozenset({"rocker"}) | PUSHROD
"""Kinds of followers that contain a valve."""
TRAIN_PAIRS = (
    ("pad", "Pad on the valve", "F_p", TRAINS), ("valve_guide", "Valve guide", "V", TRAINS),
    ("lower_ball", "Lower ball", "S", PUSHROD), ("upper_ball", "Upper ball", "U", PUSHROD),
)  # fmt: skip
"""Pairs of valve trains with their labels, symbols and kinds."""
SINGULAR_OF: Mapping[str, frozenset[str]] = MappingProxyType(
    {"dead-centre": SLIDER, "rod-across-guide": SLIDER, "pad-in-line": TRAINS, "pushrod-in-line": PUSHROD}
)
"""Code of a finding on a follower's linkage -> kinds of followers that have it."""
TRAIN_NAMES = tuple(name for name, *_ in TRAIN_PAIRS)
"""Names of these pairs."""


# -- whether a study has a quantity ---------------------------------------------------------------------------


def has_any(study: Study) -> bool:
    """Whether a study has a quantity that every study of its design has: True."""
    return True


def has_motor_torque(study: Study) -> bool:
    """Whether the shaft has a motor's torque: no guide jams, and the motor does not stall."""
    return study.jam is None and (not study.levels_torque or study.flywheel.runs)


def has_variable_speed(study: Study) -> bool:
    """Whether a flywheel levels the torque, and the motor does not stall."""
    return study.levels_torque and has_motor_torque(study)


def has_steady_vibration(study: Study) -> bool:
    """Whether an elastic follower has a steady response."""
    return study.vibrates


def has_steady_turn(study: Study) -> bool:
    """Whether a flexible shaft has a steady response."""
    return study.stability is not None and study.stability.steady_turn is not None


# -- motion and links -----------------------------------------------------------------------------------------


def motion_by_time(study: Study, order: int) -> np.ndarray:
    """Displacement of the output, y = y_0 + h s(u), or its derivative by time: ẏ = ω y′, ÿ = ω² y″, y⃛ = ω³ y‴.

    Parameters
    ----------
    study : Study
    order : int
        Order of the derivative, 0 to 3.

    Returns
    -------
    ndarray (n,) [m or rad, per s^order]

    References
    ----------
    Definition of a motion law; constant speed ω.
    """
    return study.motion.displacement[order] * study.omega**order


def gain_per_turn(study: Study, name: str) -> float:
    """What a quantity gains in a turn [SI]: the displacement gains the advance of the motion, others nothing."""
    motion = study.design.drive.motion
    return motion.gain * motion.scale if name == "displacement" and motion is not None else 0.0


def position_modulo(study: Study) -> np.ndarray:
    """Displacement modulo the advance, m = y - k a, 0 … a; without an advance the displacement itself.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [m or rad]
    """
    motion, y = study.program.motion, study.motion.displacement[0]
    advance = abs(motion.gain) * motion.scale
    return np.asarray(np.mod(y, advance) if advance else y)


def coordinate(study: Study, name: str, order: int = 0) -> np.ndarray:
    """Angle of a link or position of a slide, or its derivative by time: θ̇ = ω θ′, θ̈ = ω² θ″, ṡ = ω s′, s̈ = ω² s″.

    Parameters
    ----------
    study : Study
    name : str
        Name of the coordinate, as ``link3``, ``slide6``, ``phi``.
    order : int
        Order of the derivative, 0 to 2.

    Returns
    -------
    ndarray (n,) [rad or m, per s^order]

    References
    ----------
    Closed loops, dyad by dyad, Σ r_k e^(i θ_k) = 0; for the triangle of arm and rod Shin1995 (8)-(14).
    """
    return study.linkage.coordinates[name][order] * study.omega**order


def singular_value(study: Study, code: str) -> np.ndarray:
    """Value that must not vanish in a follower's linkage.

    Parameters
    ----------
    study : Study
    code : str
        Row of ``SINGULAR``.

    Returns
    -------
    ndarray (n,), dimensionless
    """
    return np.asarray(study.linkage.singular[code])


def transmission_angle(study: Study, joint: str) -> np.ndarray:
    """Transmission angle μ = atan2(|c₁ × c₂|, |c₁ · c₂|) at the joint of a dyad, 0 … π/2.

    Parameters
    ----------
    study : Study
    joint : str

    Returns
    -------
    ndarray (n,) [rad]
    """
    return np.asarray(study.linkage.transmission[joint])


def point_component(study: Study, point: str, component: str) -> np.ndarray:
    """Component of a point's position r_P = o + (a + i b) e^(i θ), of its velocity or acceleration, or its speed V = √(ẋ² + ẏ²).

    Velocities are V_P = V_A + V_PA, accelerations a_P = a_A + (i α_k - ω_k²)(r_P - r_A), with A and P on link k.

    Parameters
    ----------
    study : Study
    point : str
    component : str
        Row of ``POINT_COMPONENTS``.

    Returns
    -------
    ndarray (n,) [m, m/s or m/s²]
    """
    order, part = POINT_COMPONENTS[component]
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    return part(pose.position(point, order) * study.omega**order)


# -- valve trains ---------------------------------------------------------------------------------------------


def lash(design: Design) -> float:
    """Lash at the valve's tip [m], 0 without a table [valve]; with many designs a column."""
    valve = design.drive.valve
    return 0.0 if valve is None else si(valve).lash


def valve_motion(study: Study) -> Derivatives:
    """Motion of the valve by cam angle, with the lash not taken off; 0 where the train holds the valve closed.

    It is a coordinate of a pushrod train, a slide of a linkage, and of any other train the motion of the drive.

    Parameters
    ----------
    study : Study

    Returns
    -------
    Derivatives
        (n,) [m] and its derivatives by cam angle.
    """
    position, valve = study.valve.position(study.linkage), study.design.drive.valve
    if valve is None or valve.link is None:
        return position
    return Derivatives.of((position[0] - study.valve.closed, *(position[order] for order in (1, 2, 3))))


def valve_lift(study: Study, order: int = 0) -> np.ndarray:
    """Lift of the valve, y_v = max(y_o - λ, 0) with the lash λ, or its derivative by time: ẏ_v = ω y′_v, ÿ_v = ω² y″_v.

    Parameters
    ----------
    study : Study
    order : int
        Order of the derivative, 0 to 2.

    Returns
    -------
    ndarray (n,) [m, per s^order]
    """
    motion, free = valve_motion(study), lash(study.design)
    if not order:
        return np.maximum(motion[0] - free, 0.0)
    rate = motion[order] * study.omega**order
    return np.where(motion[0] > free, rate, 0.0) if np.any(free) else rate


def levers(study: Study) -> tuple[np.ndarray, np.ndarray]:
    """Levers of a rocker: ∂y_v/∂φ of the valve at the pad, and the arm; of a pushrod train ∂y/∂φ of the tappet in place of the arm.

    Parameters
    ----------
    study : Study

    Returns
    -------
    valve, cam : ndarray (n,) [m]
    """
    turn = np.abs(study.linkage.slip("pivot"))
    arm = getattr(si(study.design.drive.follower), "arm", 1.0 / turn)
    return np.abs(study.linkage.slip("valve_guide")) / turn, np.broadcast_to(arm, turn.shape)


def rocker_ratio(study: Study) -> np.ndarray:
    """Ratio of a rocker, i = h/l: lever of the pad across the valve over the arm, or of valve over tappet, dy_v/dy.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,), dimensionless
    """
    valve, cam = levers(study)
    return valve / cam


def pad_angle(study: Study) -> np.ndarray:
    """Angle β of the pad's arm from the direction in which the valve opens.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [rad]
    """
    follower, rocker = si(study.design.drive.follower), study.linkage.bodies["rocker"]
    return np.angle(rocker.unit * np.exp(1j * (follower.pad_angle - follower.valve_direction)))


def closed_pad_angle(study: Study) -> float:
    """Angle β0 of the pad's arm from the direction of the valve [rad], with the valve closed."""
    follower = si(study.design.drive.follower)
    return float(study.linkage.base["rocker"][0] + follower.pad_angle - follower.valve_direction)


# -- forces and torques ---------------------------------------------------------------------------------------


def force_component(study: Study, pair: str, component: str) -> np.ndarray:
    """Component of the force in a pair, its size F = √(F_x² + F_y²) or its direction ε = atan2(F_y, F_x) in the global frame.

    Parameters
    ----------
    study : Study
    pair : str
    component : str
        Row of ``FORCE_COMPONENTS``.

    Returns
    -------
    ndarray (n,) [N or rad]
    """
    return FORCE_COMPONENTS[component](study.dynamics.pairs[pair])


def guide_reaction(study: Study) -> GuideReaction:
    """Reactions of the follower's guide, N = e × G. The mechanism must have a guide."""
    guide = study.dynamics.guide
    assert guide is not None, "the mechanism has no guide"
    return guide


def output_power(study: Study) -> np.ndarray:
    """Power of the force or torque that makes the motion, P = T ẏ.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [W]
    """
    return study.dynamics.driver * motion_by_time(study, 1)


def motor_quantity(torque: Callable[[Flywheel, Angles], np.ndarray]) -> Callable[[Study], np.ndarray]:
    """Function of a study for a torque of the motor; without a flywheel the torque of the shaft.

    The function raises NoSolution where a guide jams or the motor stalls.

    Parameters
    ----------
    torque : callable
        Flywheel and angles (n,) -> torque, ndarray (n,) [N m].

    Returns
    -------
    callable
        Study -> torque, ndarray (n,) [N m].
    """
    return lambda s: torque(s.flywheel, s.angles) if s.levels_torque or s.jam is not None else s.shaft_torque


def shaft_speed(study: Study) -> np.ndarray:
    """Angular velocity of the camshaft; constant without a flywheel.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [rad/s]

    Raises
    ------
    NoSolution
        Where a guide jams or the motor stalls.
    """
    if study.levels_torque or study.jam is not None:
        return study.flywheel.speed(study.angles)
    return spread(np.atleast_1d(study.omega), study.theta.shape[-1])


def contact_stress_part(study: Study, part: str, second: bool = False) -> np.ndarray:
    """Stress under the first roller or face, in a groove on the flank in contact; or under the second roller.

    Parameters
    ----------
    study : Study
    part : str
        Attribute of ``ContactStress``.
    second : bool
        Whether the second roller is meant.

    Returns
    -------
    ndarray (n,) [Pa or m]
    """
    parts = [getattr(stress, part) for name, stress in study.stress.items() if (name == SECOND) == second]
    return np.asarray(sum(parts[1:], parts[0]))


# -- the cam --------------------------------------------------------------------------------------------------


def profile_radius(study: Study) -> np.ndarray:
    """Radius of the profile from the cam centre, r = |p|.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [m]
    """
    return np.abs(study.cam.flank.profile)


def polar_angle(study: Study) -> np.ndarray:
    """Polar angle of the profile, ϑ = arg(p), 0 … 2π without 2π.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [rad]
    """
    angle = np.mod(np.angle(study.cam.flank.profile), 2.0 * np.pi)
    return np.where(angle >= 2.0 * np.pi, 0.0, angle)


def push_product(study: Study) -> np.ndarray:
    """Product of the forces on the driver by one newton on the first and on the second roller.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,), dimensionless
        Negative where the rollers push in opposite directions.
    """
    shape = study.cam
    return forward_push(study.linkage, shape.flank) * forward_push(study.linkage, shape.only(SECOND).flank)


def second_roller_distance(study: Study) -> np.ndarray:
    """Least distance of the second roller from the cam centre.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [m]
    """
    flank = study.cam.only(SECOND).flank
    return np.asarray(np.abs(flank.reference) - flank.radius)


def line_of_centres(study: Study) -> np.ndarray:
    """Unit vector e from the cam centre along which Q is counted: to the follower's pivot; across a guide so that Q = y′.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (1,) complex, dimensionless
    """
    kinematics = study.linkage
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return -1j * study.sense * kinematics.line(pair)
    pivot = kinematics.bodies[pair.body].position(pair.point)[:1]
    return np.asarray(pivot / np.abs(pivot))


def centre_distance(study: Study) -> np.ndarray:
    """Distance of the instant centre along the line of centres, Q = e · q.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [m]
        Infinite where the follower turns as fast as the cam.

    References
    ----------
    Kennedy; Shin1995 (18), φ′ against the cam.
    """
    centre = study.cam.flank.centre
    with np.errstate(divide="ignore"):
        return np.asarray((np.conj(line_of_centres(study)) * centre.point).real / centre.weight)


def centre_velocity(study: Study) -> np.ndarray:
    """Velocity of the instant centre, V_Q = ω Q; its size under a linkage, where Q is on no fixed line.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [m/s]

    References
    ----------
    Shin1995 (15), for any pose.
    """
    has_fixed_line = study.kind in FOLLOWER_KINDS
    return study.omega * (centre_distance(study) if has_fixed_line else np.abs(study.cam.flank.centre.finite))


def reference_velocity(study: Study) -> np.ndarray:
    """Velocity of the roller's centre, V_R = σ ω |R′|: positive in the direction of V_Q; its size under a linkage.

    Parameters
    ----------
    study : Study

    Returns
    -------
    ndarray (n,) [m/s]

    References
    ----------
    Shin1995 (16), (17), for any pose.
    """
    kinematics = study.linkage
    velocity = study.omega * kinematics.follower.origin[1]
    if study.kind not in FOLLOWER_KINDS:
        return np.asarray(np.abs(velocity))
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return np.asarray((np.conj(kinematics.line(pair)) * velocity).real)
    arm = kinematics.follower.origin[0] - kinematics.bodies[pair.body].position(pair.point)
    return np.asarray((np.conj(-1j * study.sense * arm / np.abs(arm)) * velocity).real)


# -- members of a linkage -------------------------------------------------------------------------------------


def members(design: Design) -> Iterator[tuple[str, str]]:
    """Sort and name of every member of a design that has quantities of its own."""
    if design.drive.links:
        yield from _links(design)
        yield from _pairs(design)
    yield from _energies(design)
    if design.outlines and not design.drive.is_alone:
        from core.study.clearances import pair_members  # few designs have outlines

        yield from ((CLEARANCE, member) for member in pair_members(Study(design)))


CLEARANCE = "clearance"
"""Sort of the pairs of bodies with outlines."""


def _links(design: Design) -> Iterator[tuple[str, str]]:
    """Moving links, slides, points and dyads."""
    linkage = design.drive.linkage
    if design.by_crank:
        yield "swing", ""
    for number in sorted(linkage.by_number):
        if number != FRAME_LINK and not (
            design.by_crank and number == linkage.driver.link and linkage.driver.on == FRAME_LINK
        ):
            yield "link", str(number)
    yield from (("slide", str(slider.link)) for slider in linkage.sliders)
    fixed = linkage.by_number[FRAME_LINK].places
    for point in dict.fromkeys(p.name for link in linkage.links for p in link.points if p.name not in fixed):
        yield "point", point
    yield from (("dyad", step.joint) for step in solving_order(linkage).steps if step.kind not in (GROUP, INPUT))


def _energies(design: Design) -> Iterator[tuple[str, str]]:
    """Bodies together, and one by one where there are several; drive, gravity, force elements and pairs with friction."""
    loads = design.drive.loads
    if not design.drive.loaded:
        return
    loading = loading_of(design.drive.mechanism, loads)
    moving = [mass.body for mass in loading.masses if mass.is_active]
    if moving:
        yield "bodies", ""
    yield from (("body", body) for body in moving if len(moving) > 1)
    if not design.drive.is_alone:
        yield "drive", ""
    if any(mass.inertia.mass and mass.gravity for mass in loading.masses):
        yield "gravity", ""
    yield from (
        ("load" if element.name == "load" else "element", element.name) for element in loading.elements if element.name
    )
    for list_name, name in (("springs", "spring"), ("torsion_springs", "torsion_spring"), ("process", "process")):
        yield from (("element", f"{name}{i}") for i, _ in enumerate(getattr(loads, list_name), 1))
    yield from (("friction", friction.pair) for friction in loading.frictions)
    yield from (("friction", CAM_FACE) for _ in range(loading.contact_friction > 0.0))
    yield from (("friction", name) for name in _rubbing(design))


def _rubbing(design: Design) -> Iterator[str]:
    """Pairs with friction by a row of the loads, as the forces name them."""
    rows = design.drive.loads.pair_friction
    if not design.drive.links:
        yield from (row.pair for row in rows)
        return
    for row in rows:
        named, links = mechanism_of(design.drive.linkage).pair_names, {row.link, row.other} - {None}
        joined = (name for j, name in named.items() if j.name == row.pair and links <= {j.first.link, j.second.link})
        yield from list(joined)[:1]


def _pairs(design: Design) -> Iterator[tuple[str, str]]:
    """The driver, where no cam moves it, and every pair."""
    linkage = design.drive.linkage
    pair = driver_pair(linkage)
    if not design.drive.has_disk:
        yield "driving pin" if pair is not None and is_pin(pair) else "driving slide", ""
    for each in linkage.drivers:
        yield "second slide" if input_slides(linkage, each) else "second driver", str(each.link)
    try:
        mechanism = mechanism_of(linkage)
        names, redundant = mechanism.pair_names, mechanism.plan.redundant
    except DesignError:  # no mechanism yet
        return
    without = _undetermined(design) if redundant else frozenset()
    for joint, name in names.items():
        if name not in without:
            yield "pin" if joint.revolute else "guide", name


def _undetermined(design: Design) -> frozenset[str]:
    """Pairs of redundant links whose forces statics does not determine."""
    try:
        return Study(design).undetermined
    except NoSolution:
        return frozenset()
