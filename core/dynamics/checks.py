"""Checks of the forces: balance of power and momentum, and findings of separation, jamming and ineffective elements."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from core.cam import CamShape, form_row
from core.dynamics.elements import Element, Load, Rate, ScheduledForce, Spring, Torsion
from core.dynamics.forces import Forces
from core.dynamics.loading import Friction, Loading
from core.dynamics.schedules import MotionWindow
from core.dynamics.walk import input_loads, input_of
from core.findings import ERROR, NOTE, WARNING, Finding
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics
from core.motion import TURN, Angles, CompiledMotion
from core.motion.extremes import Extreme, Extremes, Pieces, crossings, find_extremes, piecewise_angles
from core.numerics.derivatives import cross

# -- independent balances of power and momentum -----------------------------------------------------------------


@np.errstate(invalid="ignore")  # inf - inf where friction jams, which counts as balanced
def power_residual(kinematics: Kinematics, shape: CamShape | None, forces: Forces, loading: Loading) -> np.ndarray:
    """Power of cam or driver less the rates of kinetic and potential energy and the power of friction.

    It is relative to the peak of its terms and of ω|R||F_c|, the product from which T_c ω is computed: in a position
    where the cam only holds the follower the terms vanish.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    shape : CamShape or None
    forces : Forces
    loading : Loading

    Returns
    -------
    ndarray (n,), dimensionless

    References
    ----------
    Balance of energy, T ω = dE_k/dt + dE_p/dt + P_f - P_e.
    """
    omega = forces.omega
    power = input_power(kinematics, forces)
    terms = power_terms(kinematics, forces, loading)
    sizes = list(terms)
    if shape is not None:
        sizes += [omega * np.abs(contact.at) * contact.force for contact in forces.contacts]
    else:
        sizes.append(power)
    return _relative(power - sum(terms), sizes)


def peak_load(element: Element, kinematics: Kinematics, omega: float) -> tuple[float, str]:
    """Largest force of an element at a steady speed [rad/s] and its unit, or the largest couple without a force."""
    loads = list(element.loads(kinematics, Rate(omega)))
    force = max((float(np.abs(load.force).max()) for load in loads), default=0.0)
    couple = max((float(np.abs(load.couple).max()) for load in loads), default=0.0)
    return (force, "N") if force or not couple else (couple, "N·m")


def power_terms(kinematics: Kinematics, forces: Forces, loading: Loading) -> list[np.ndarray]:
    """Terms of the balance of power: into kinetic energy, into friction, and into each force element.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    forces : Forces
    loading : Loading

    Returns
    -------
    list of ndarray (n,) [W]
    """
    omega, acting = forces.omega, loading.acting(kinematics)
    terms = [0.5 * omega**3 * acting * loading.inertia(kinematics, 2)[1], forces.friction_power]
    for element in loading.elements:
        terms += [
            acting * omega * element.potential(kinematics)[0],
            acting * element.dissipation(kinematics, abs(omega)),
        ]
    return terms


def input_power(kinematics: Kinematics, forces: Forces) -> np.ndarray:
    """Power of cam or driver, and of second drivers with motions, into the mechanism.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    forces : Forces

    Returns
    -------
    ndarray (n,) [W]

    References
    ----------
    Balance of energy.
    """
    work = forces.torque
    if not forces.in_space:  # whose torque is that of the driver
        work = work + forces.driver * kinematics.motion.displacement[1]
    for dyad in (dyad for dyad in kinematics.dyads if dyad.on and dyad.by_motion):
        body, on = (kinematics.bodies[name].turn[1] for name in (dyad.bodies[0], dyad.on))
        work = work + forces.couples[input_of(dyad.bodies[0])] * (body - on)
    return np.asarray(work * forces.omega)


def gravity_power(kinematics: Kinematics, loading: Loading, omega: float) -> np.ndarray:
    """Power of the weight of all bodies into the mechanism, positive while they sink.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    loading : Loading
    omega : float
        Speed [rad/s].

    Returns
    -------
    ndarray (n,) [W]

    References
    ----------
    Balance of energy.
    """
    return np.asarray(
        loading.acting(kinematics) * sum(element_power(mass, kinematics, omega) for mass in loading.masses)
    )


def element_power(element: Element, kinematics: Kinematics, omega: float) -> np.ndarray:
    """Power of a force element into the mechanism, negative for a damper.

    Parameters
    ----------
    element : Element
    kinematics : Kinematics
        At n cam angles.
    omega : float
        Speed [rad/s].

    Returns
    -------
    ndarray (n,) [W]

    References
    ----------
    Balance of energy.
    """
    return np.asarray(-omega * element.potential(kinematics)[0] - element.dissipation(kinematics, omega))


def kinetic_energy(kinematics: Kinematics, loading: Loading, omega: float, body: str | None = None) -> np.ndarray:
    """Kinetic energy J ω²/2 of all bodies, or of one, at constant speed; J is the inertia reduced to the shaft.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    loading : Loading
    omega : float
        Speed [rad/s].
    body : str, optional

    Returns
    -------
    ndarray (n,) [J]

    References
    ----------
    Balance of energy.
    """
    masses = tuple(mass for mass in loading.masses if body in (None, mass.body))
    return np.asarray(0.5 * omega * omega * replace(loading, masses=masses).inertia(kinematics, 1)[0])


@np.errstate(invalid="ignore")
def momentum_residual(kinematics: Kinematics, shape: CamShape | None, forces: Forces, loading: Loading) -> np.ndarray:
    """Sum of outer forces and inertia forces of all bodies, and of their moments about the origin.

    Each is relative to the peak of its terms, of a moment |r||F|. Outer forces are those of the frame, the cam, the
    driver and all force elements. The balance of power is blind to an error in a pin, the pivot or a frictionless
    guide.

    Parameters
    ----------
    kinematics : Kinematics
        At n cam angles.
    shape : CamShape or None
    forces : Forces
    loading : Loading

    Returns
    -------
    ndarray (n,), dimensionless
        The larger of both.

    References
    ----------
    Balance of momentum; for the cam-driven slider Shin, Kim and Ha 1995, eqs. (21), (22), (23), (24) to (26), corrected.
    """
    outer = loading.loads(kinematics, Rate(forces.omega))
    for name, pair in kinematics.pairs.items():
        if FRAME in (pair.on, pair.body):
            sign = 1.0 if pair.on == FRAME else -1.0
            at = kinematics.bodies[pair.body if pair.on == FRAME else pair.on].position(pair.point)
            couple = sign * forces.couples.get(name, np.zeros(1))
            outer.append(Load("", at, sign * forces.pairs.get(name, np.zeros(1, dtype=complex)), couple))
            if name == kinematics.driver_name:
                is_pin = pair.kind == REVOLUTE
                force = np.zeros(1, dtype=complex) if is_pin else forces.driver * kinematics.line(pair)
                outer.append(Load("", at, force, forces.driver if is_pin else 0.0))
    for dyad in (dyad for dyad in kinematics.dyads if dyad.on):  # the frame carries its wheels
        loads = (load for _, load in input_loads(kinematics, dyad, forces.couples[input_of(dyad.bodies[0])]))
        outer += [load for load in loads if load.body != FRAME]
    outer += [Load("", contact.at, -contact.force * contact.direction) for contact in forces.contacts]
    linear = [load.force for load in outer]
    moments = [cross(load.at, load.force) + load.couple for load in outer]
    products = [np.abs(load.at) * np.abs(load.force) + np.abs(load.couple) for load in outer]
    return np.maximum(_relative(np.abs(sum(linear)), linear), _relative(np.asarray(sum(moments)), products))


def _relative(residual: np.ndarray, terms: Sequence[np.ndarray]) -> np.ndarray:
    finite = np.isfinite(residual)
    peak = max((float(np.abs(t[np.isfinite(t)]).max(initial=0.0)) for t in map(np.asarray, terms)), default=0.0)
    return np.where(finite, np.abs(residual), 0.0) / (peak or 1.0)


# -- limits of the forces ---------------------------------------------------------------------------------------


_STILL = 1e-9  # of a length, or [rad], per radian of the turn: less is rounding
_MEET = 1e-6  # of the links' largest displacement: ends at this distance meet
LIMIT_TOLERANCE = 1e-9  # of the limit on the least contact force
At = Callable[[Angles], Kinematics]


def findings(
    contact: Extremes | None,
    loading: Loading,
    noun: str,
    lift_off_rpm: Callable[[], float],
    least_force: float | None = None,
) -> list[Finding]:
    """Findings of the refined extremes of the contact force [N].

    contact: None where no follower can leave a cam; noun: of a face that does not roll; lift_off_rpm: function of the
    speed from which the follower leaves the cam; least_force: the limit on the least contact force [N].
    """
    if loading.is_empty:
        return [Finding("no-load", NOTE, "loads", None)]
    result = []
    face = {"face": noun} if noun else {}
    least = None if contact is None else contact.low
    if least is not None and math.isfinite(least.value) and least.value <= 0.0:  # infinite where friction jams
        separation: dict[str, float | str] = {"force_n": least.value, "speed_rpm": lift_off_rpm(), **face}
        result.append(Finding("separation", ERROR, "loads", math.degrees(least.theta), separation))
    elif (
        least is not None
        and least_force
        and math.isfinite(least.value)
        and least.value < least_force * (1.0 - LIMIT_TOLERANCE)
    ):
        values = {"value": least.value, "limit": least_force}
        result.append(
            Finding("contact-force-low", WARNING, "loads.least_contact_force_n", math.degrees(least.theta), values)
        )
    return result


def jam_finding(jam: Extreme, friction: Friction | None) -> Finding:
    """Finding of the pair with the largest part in the jam factor; None: the face on the cam."""
    at, values = math.degrees(jam.theta), {"factor": jam.value}
    if friction is None:
        return Finding("contact-jamming", ERROR, "loads.contact_friction", at, values)
    if friction.is_guide:
        return Finding("jamming", ERROR, friction.field, at, values)
    return Finding("pair-jamming", ERROR, friction.field, at, {**values, "pair": friction.pair})


def element_findings(at: At, program: Pieces, loading: Loading) -> list[Finding]:
    """Findings of springs, dampers and process forces that cannot act as they should; ``at``: cam angles -> kinematics.

    Springs without a rate, without length, or whose ends meet, so that their force has no direction; torsion springs
    that every turn winds up, or whose links do not rotate; dampers without relative motion; process forces that never
    act.
    """

    def finding(code: str, severity: str, element: Spring | Torsion | ScheduledForce, **values: float) -> Finding:
        word = "process_force" if isinstance(element, ScheduledForce) else ""
        name = re.sub(r"(?=\d)", " ", re.sub(r"^process", word, element.name), count=1).replace("_", " ")
        return Finding(code, severity, element.field, None, {"name": name, **values})

    springs = [element for element in loading.others if isinstance(element, Spring | Torsion)]
    processes = [element for element in loading.others if isinstance(element, ScheduledForce)]
    result = [finding("spring-idle", WARNING, spring) for spring in springs if not spring.is_active]
    result += [finding("process-idle", WARNING, process) for process in processes if not process.is_active]
    springs = [spring for spring in springs if spring.is_active]
    processes = [process for process in processes if process.is_active]
    if not springs and not processes:
        return result
    kinematics = at(piecewise_angles(program))
    for process in processes:
        if not process.schedule.value(kinematics.motion)[0].any():
            code = "process-never" if isinstance(process.schedule, MotionWindow) else "process-idle"
            result.append(finding(code, WARNING, process))
    size = max(
        float(np.abs(pose.origin[0] - pose.origin[0][0]).max(initial=0.0)) for pose in kinematics.bodies.values()
    )
    for spring in springs:
        if isinstance(spring, Spring) and _coincide(spring, kinematics, size):
            result.append(finding("spring-no-length", ERROR, spring))
            continue
        if isinstance(spring, Torsion) and _is_still(spring, kinematics):
            result.append(finding("torsion-still", WARNING, spring))
            continue
        if spring.damping and _is_still(spring, kinematics):
            result.append(
                replace(finding("damper-still", WARNING, spring), field=f"{spring.field}.{spring.damping_key}")
            )
        if isinstance(spring, Torsion):
            turns = round(float(spring.angle(kinematics)[-1] - spring.angle(kinematics)[0]) / TURN)
            if spring.rate and turns:
                result.append(finding("spring-winds-up", ERROR, spring, turns=float(turns)))
        elif spring.length or spring.damping:
            distance = partial(_distance, spring, at)
            least = find_extremes(distance, program)[""].low
            if least.value <= _MEET * max(size, spring.length):
                meeting = finding("spring-ends-meet", ERROR, spring)
                result.append(replace(meeting, cam_angle_deg=math.degrees(least.theta)))
    return result


def _distance(spring: Spring, at: At, angles: Angles) -> dict[str, np.ndarray]:
    return {"": np.abs(spring.between(at(angles)))}


def _coincide(spring: Spring, kinematics: Kinematics, size: float) -> bool:
    """Whether both ends coincide at every angle, but for rounding."""
    return bool((np.abs(spring.between(kinematics)) <= _MEET * max(size, spring.length)).all())


def _is_still(spring: Spring | Torsion, kinematics: Kinematics) -> bool:
    """Whether the ends of a spring have no relative motion, but for rounding."""
    length = np.abs(spring.between(kinematics)).max(initial=0.0) if isinstance(spring, Spring) else 1.0
    return bool((np.abs(spring.elongation_rate(kinematics)) <= _STILL * length).all())


# -- change of the flank in contact, of a groove or a conjugate pair --------------------------------------------


NO_DIRECTION = 1e-11  # of the largest force: a smaller force has no direction

ForcesAt = Callable[[Angles], tuple[Kinematics, Forces]]


@frozen
class FlankChange:
    """Change of the flank in contact.

    Attributes
    ----------
    theta : cam angle [rad]
    to : index of the flank in contact from there on
    impact : speed [m/s] of the impact across the play, along the normal; None without play, or where the follower
        returns to the flank that it left
    """

    theta: float
    to: int
    impact: float | None = None


def flank_changes(at: ForcesAt, program: CompiledMotion) -> tuple[FlankChange, ...]:
    """Changes of the flank in contact, in the order of cam angle: sign changes of F_c, jumps at joins included."""
    changes = sign_changes(lambda angles: at(angles)[1].signed_contact, program)
    return tuple(FlankChange(theta, int(sign < 0.0)) for theta, sign in sorted(changes) if sign != 0.0)


def sign_changes(force_at: Callable[[Angles], np.ndarray], program: CompiledMotion) -> list[tuple[float, float]]:
    """Cam angles at which a force changes its sign, refined, jumps included, each with the sign afterwards.

    A force that is negligible relative to the largest one has no sign.

    Parameters
    ----------
    force_at : function Angles (n,) -> ndarray (n,) [N]
    program : CompiledMotion

    Returns
    -------
    list of (float, float)
        Cam angle [rad] and sign ±1 or 0.
    """
    angles = piecewise_angles(program)
    forces = force_at(angles)
    least = NO_DIRECTION * float(np.abs(forces).max(initial=0.0))

    def significant(at: Angles) -> np.ndarray:
        force = force_at(at)
        return np.where(np.abs(force) > least, force, 0.0)  # 0 too where a jam leaves no value

    value = np.where(np.abs(forces) > least, forces, 0.0)
    roots = crossings(significant, angles, value)
    inner = list(zip(roots.theta.tolist(), roots.piece.tolist(), strict=True))
    changes = list(zip(roots.theta.tolist(), _signs_after(significant, roots, program), strict=True)) if inner else []
    return changes + _jumps(angles, value, inner)


def _signs_after(force_at: Callable[[Angles], np.ndarray], roots: Angles, program: CompiledMotion) -> list[float]:
    """Sign of a force after each root, at the nearest of a few angles where it has one; else 0."""
    theta = np.minimum(roots.theta[:, None] + 10.0 ** np.arange(-9.0, -2.0), program.ends[roots.piece, None])
    forces = force_at(Angles(theta.ravel(), np.repeat(roots.piece, theta.shape[1])))
    signs = np.sign(forces).reshape(theta.shape)
    return [next((sign for sign in row if sign), 0.0) for row in signs.tolist()]


def _jumps(angles: Angles, value: np.ndarray, inner: list[tuple[float, int]]) -> list[tuple[float, float]]:
    """Sign changes at joins and after stretches without force, as no root inside a piece; angle and sign afterwards."""
    loaded = np.flatnonzero(value)
    changes = []
    for i, j in zip(np.roll(loaded, 1).tolist(), loaded.tolist(), strict=True):
        if value[i] * value[j] > 0.0 or (j == i + 1 and angles.piece[i] == angles.piece[j]):
            continue
        if any(angles.theta[i] <= theta <= angles.theta[j] and i < j for theta, _ in inner):
            continue
        before = j - 1 if j > i + 1 or i > j else j
        start = float(angles.theta[before if before >= 0 and angles.piece[before] == angles.piece[j] else j])
        changes.append((start, float(np.sign(value[j]))))
    return changes


def change_findings(changes: tuple[FlankChange, ...], form: Any) -> list[Finding]:
    """A note for each change of the flank in contact."""
    findings = []
    for change in changes:
        values: dict[str, float | str] = {"to": form_row(form).sides[change.to]}
        if change.impact is not None:
            values |= {"play_mm": form.play_mm, "impact_m_s": change.impact}
        findings.append(Finding("flank-change", NOTE, "loads", math.degrees(change.theta), values))
    return findings
