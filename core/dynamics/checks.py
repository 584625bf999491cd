"""Limits of the forces: separation, jamming, nothing to move, elements that cannot act as they should."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from core.cam import CamShape, form_row
from core.dynamics.elements import Element, Friction, Load, Loading, OverMotion, Rate, ScheduledForce, Spring, Torsion
from core.dynamics.forces import Forces
from core.dynamics.walk import input_loads, input_of
from core.findings import ERROR, NOTE, WARNING, Finding
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics
from core.motion import TURN, Angles, CompiledMotion
from core.motion.extremes import Extreme, Extremes, Pieces, crossings, find_extremes, piecewise_angles
from core.numerics.derivatives import cross

# -- proof of the forces by laws they were not computed from ----------------------------------------------------


@np.errstate(invalid="ignore")  # inf - inf where friction jams, which counts as balanced
def power_residual(kinematics: Kinematics, shape: CamShape | None, forces: Forces, loading: Loading) -> np.ndarray:
    """What cam or driver give against the rates of kinetic and potential energy and what friction takes (n,), relative to
    the peak of its terms and of ω|R||F_c|, the product that T_c ω is taken from: where the cam only holds, nothing else is
    left.

    References
    ----------
    Balance of energy, T ω = dE_k/dt + dE_p/dt + P_f - P_e.
    """
    omega = forces.omega
    given = power_given(kinematics, forces)
    terms = power_terms(kinematics, forces, loading)
    sizes = list(terms)
    if shape is not None:
        sizes += [omega * np.abs(each.at) * each.force for each in forces.contacts]
    else:
        sizes.append(given)
    return _relative(given - sum(terms), sizes)


def peak_load(element: Element, kinematics: Kinematics, omega: float) -> tuple[float, str]:
    """The largest force of an element over the angles of the kinematics, at a steady speed [rad/s], and its unit; of what has no
    force its largest couple."""
    parts = list(element.loads(kinematics, Rate(omega)))
    force = max((float(np.abs(load.force).max()) for load in parts), default=0.0)
    couple = max((float(np.abs(load.couple).max()) for load in parts), default=0.0)
    return (force, "N") if force or not couple else (couple, "N·m")


def power_terms(kinematics: Kinematics, forces: Forces, loading: Loading) -> list[np.ndarray]:
    """Where the power given goes [W], each (n,): into kinetic energy, into friction, into each force element."""
    omega = forces.omega
    terms = [0.5 * omega**3 * loading.inertia(kinematics, 2)[1], forces.lost]
    for element in loading.elements:
        terms += [omega * element.potential(kinematics)[0], element.lost(kinematics, abs(omega))]
    return terms


def power_given(kinematics: Kinematics, forces: Forces) -> np.ndarray:
    """What cam or driver, and inputs with motions of their own, give the mechanism (n,) [W].

    References
    ----------
    Balance of energy.
    """
    given = forces.torque + forces.driver * kinematics.motion.displacement[1]
    for dyad in (each for each in kinematics.dyads if each.on and each.by_motion):
        body, on = (kinematics.bodies[name].turn[1] for name in (dyad.bodies[0], dyad.on))
        given = given + forces.couples[input_of(dyad.bodies[0])] * (body - on)
    return np.asarray(given * forces.omega)


def power_of_gravity(kinematics: Kinematics, loading: Loading, omega: float) -> np.ndarray:
    """What the weight of all bodies gives the mechanism (n,) [W]: > 0 while they sink.

    References
    ----------
    Balance of energy.
    """
    return np.asarray(sum(power_of(mass, kinematics, omega) for mass in loading.masses))


def power_of(element: Element, kinematics: Kinematics, omega: float) -> np.ndarray:
    """What a force element gives the mechanism (n,) [W]: < 0 where it takes, as a damper always does.

    References
    ----------
    Balance of energy.
    """
    return np.asarray(-omega * element.potential(kinematics)[0] - element.lost(kinematics, omega))


def kinetic_energy(kinematics: Kinematics, loading: Loading, omega: float, body: str | None = None) -> np.ndarray:
    """Of all bodies, or of one (n,) [J] at constant speed [rad/s]: J ω²/2, J as they are worth at the shaft.

    References
    ----------
    Balance of energy.
    """
    masses = tuple(mass for mass in loading.masses if body in (None, mass.body))
    return np.asarray(0.5 * omega * omega * replace(loading, masses=masses).inertia(kinematics, 1)[0])


@np.errstate(invalid="ignore")
def momentum_residual(kinematics: Kinematics, shape: CamShape | None, forces: Forces, loading: Loading) -> np.ndarray:
    """Sum of outer forces and inertia forces of all bodies, and of their moments about the origin (n,), each relative to
    the peak of its terms, of a moment |r||F|. Power alone cannot see an error in a pin, the pivot or a frictionless guide.

    Outer forces are those of the frame, of the cam, of the driver, and of all force elements.

    References
    ----------
    Balance of momentum; for the cam-driven slider Shin1995 (21), (22), (23), (24)-(26), corrected.
    """
    outer: list[Load] = [load for element in loading.elements for load in element.loads(kinematics, Rate(forces.omega))]
    for name, pair in kinematics.pairs.items():
        if FRAME in (pair.on, pair.body):
            sign = 1.0 if pair.on == FRAME else -1.0
            at = kinematics.bodies[pair.body if pair.on == FRAME else pair.on].place(pair.point)
            couple = sign * forces.couples.get(name, np.zeros(1))
            outer.append(Load("", at, sign * forces.pairs.get(name, np.zeros(1, dtype=complex)), couple))
            if name == kinematics.driver_name:
                turns = pair.kind == REVOLUTE
                push = np.zeros(1, dtype=complex) if turns else forces.driver * kinematics.line(pair)
                outer.append(Load("", at, push, forces.driver if turns else 0.0))
    for dyad in (each for each in kinematics.dyads if each.on):  # its wheels are held by the frame
        loads = (load for _, load in input_loads(kinematics, dyad, forces.couples[input_of(dyad.bodies[0])]))
        outer += [load for load in loads if load.body != FRAME]
    outer += [Load("", each.at, -each.force * each.pressing) for each in forces.contacts]
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
_MEET = 1e-6  # of the way of the links: ends that come so near meet
KEPT = 1e-9  # of the least contact force wanted: by which it may be missed
At = Callable[[Angles], Kinematics]


def findings(
    contact: Extremes | None,
    loading: Loading,
    noun: str,
    lift_off_rpm: Callable[[], float],
    wanted: float | None = None,
) -> list[Finding]:
    """What the refined extremes of the contact force [N] exceed; contact: None where no follower can leave a cam; noun: of a face that does
    not roll; lift_off_rpm: the speed from which the follower leaves the cam, asked for where it does; wanted: the least contact force
    that is to be kept."""
    if loading.empty:
        return [Finding("no-load", NOTE, "loads", None)]
    found = []
    face = {"face": noun} if noun else {}
    least = None if contact is None else contact.low
    if least is not None and math.isfinite(least.value) and least.value <= 0.0:  # an infinite one is the jam's
        lifted: dict[str, float | str] = {"force_n": least.value, "speed_rpm": lift_off_rpm(), **face}
        found.append(Finding("separation", ERROR, "loads", math.degrees(least.theta), lifted))
    elif least is not None and wanted and math.isfinite(least.value) and least.value < wanted * (1.0 - KEPT):
        values = {"value": least.value, "limit": wanted}
        found.append(
            Finding("contact-force-low", WARNING, "loads.least_contact_force_n", math.degrees(least.theta), values)
        )
    return found


def jam_finding(jam: Extreme, friction: Friction | None) -> Finding:
    """Where friction jams hardest, and what: the pair that has the largest part in it, None: the face on the cam."""
    at, values = math.degrees(jam.theta), {"factor": jam.value}
    if friction is None:
        return Finding("contact-jamming", ERROR, "loads.contact_friction", at, values)
    if friction.own:
        return Finding("jamming", ERROR, friction.field, at, values)
    return Finding("pair-jamming", ERROR, friction.field, at, {**values, "pair": friction.pair})


def element_findings(at: At, program: Pieces, loading: Loading) -> list[Finding]:
    """Springs that have nothing to pull with, no length, or ends that meet, so that their force has no direction; torsion springs
    that are wound up with every turn or whose links do not turn; dampers between which nothing moves; process forces that never work.
    ``at`` gives the kinematics at any cam angles."""
    every = [element for element in loading.others if isinstance(element, Spring | Torsion)]
    processes = [element for element in loading.others if isinstance(element, ScheduledForce)]
    found = [Finding("spring-idle", WARNING, row.field, None, {"name": _words(row)}) for row in every if not row.acts]
    rows = [row for row in every if row.acts]
    found += [
        Finding("process-idle", WARNING, each.field, None, {"name": _words(each)})
        for each in processes
        if not each.acts
    ]
    processes = [each for each in processes if each.acts]
    if not rows and not processes:
        return found
    angles = piecewise_angles(program)
    kinematics = at(angles)
    motion = kinematics.motion
    for each in processes:
        if not each.schedule.value(motion)[0].any():
            code = "process-never" if isinstance(each.schedule, OverMotion) else "process-idle"
            found.append(Finding(code, WARNING, each.field, None, {"name": _words(each)}))
    size = max(
        float(np.abs(pose.origin[0] - pose.origin[0][0]).max(initial=0.0)) for pose in kinematics.bodies.values()
    )
    for row in rows:
        if isinstance(row, Spring) and _coincide(row, kinematics, size):
            found.append(Finding("spring-no-length", ERROR, row.field, None, {"name": _words(row)}))
            continue
        if isinstance(row, Torsion) and _still(row, kinematics):
            found.append(Finding("torsion-still", WARNING, row.field, None, {"name": _words(row)}))
            continue
        if row.damping and _still(row, kinematics):
            found.append(
                Finding("damper-still", WARNING, f"{row.field}.{row.damping_key}", None, {"name": _words(row)})
            )
        if isinstance(row, Torsion):
            turns = round(float(row.angle(kinematics)[-1] - row.angle(kinematics)[0]) / TURN)
            if row.rate and turns:
                found.append(
                    Finding("spring-winds-up", ERROR, row.field, None, {"name": _words(row), "turns": float(turns)})
                )
        elif row.length or row.damping:
            least = find_extremes(lambda there, row=row: {"": np.abs(row.between(at(there)))}, program)[""].low  # type: ignore[misc]
            if least.value <= _MEET * max(size, row.length):
                found.append(
                    Finding("spring-ends-meet", ERROR, row.field, math.degrees(least.theta), {"name": _words(row)})
                )
    return found


def _words(row: Spring | Torsion | ScheduledForce) -> str:
    word = "process_force" if isinstance(row, ScheduledForce) else ""
    return re.sub(r"(?=\d)", " ", re.sub(r"^process", word, row.name), count=1).replace("_", " ")


def _coincide(row: Spring, kinematics: Kinematics, size: float) -> bool:
    """Whether both ends stand in one place at every angle, but for rounding."""
    return bool((np.abs(row.between(kinematics)) <= _MEET * max(size, row.length)).all())


def _still(row: Spring | Torsion, kinematics: Kinematics) -> bool:
    """Whether what a damper works on moves nowhere, but for rounding."""
    if isinstance(row, Torsion):
        return bool((np.abs(row.angle(kinematics, 1)) <= _STILL).all())
    return bool((np.abs(row.stretch(kinematics)) <= _STILL * np.abs(row.between(kinematics)).max(initial=0.0)).all())


# -- where the contact of a groove or of a conjugate pair goes over to the other flank --------------------------


NO_DIRECTION = 1e-11  # of the largest force: a force below it has no direction

ForcesAt = Callable[[Angles], tuple[Kinematics, Forces]]


@frozen
class FlankChange:
    """theta [rad]; to: number of the flank that carries from there on; impact [m/s]: speed of what strikes it across the
    play, along the normal; None without play, or where it comes back to the flank that it left: see ``with_impacts``."""

    theta: float
    to: int
    impact: float | None = None


def flank_changes(at: ForcesAt, program: CompiledMotion) -> tuple[FlankChange, ...]:
    """The cam angles at which F_c changes its sign, refined, in their order; jumps at joins of the motion included."""
    found = sign_changes(lambda there: at(there)[1].carrying, program)
    return tuple(FlankChange(theta, int(sign < 0.0)) for theta, sign in sorted(found) if sign != 0.0)


def sign_changes(force_at: Callable[[Angles], np.ndarray], program: CompiledMotion) -> list[tuple[float, float]]:
    """The cam angles [rad] at which a force (n,) changes its sign, refined, jumps included, each with the sign afterwards. A force that
    is nothing beside the largest has none."""
    angles = piecewise_angles(program)
    forces = force_at(angles)
    least = NO_DIRECTION * float(np.abs(forces).max(initial=0.0))

    def carrying(there: Angles) -> np.ndarray:
        force = force_at(there)
        return np.where(np.abs(force) > least, force, 0.0)  # nor has one that a jam leaves without a value

    value = np.where(np.abs(forces) > least, forces, 0.0)
    roots = crossings(carrying, angles, value)
    inner = list(zip(roots.theta.tolist(), roots.piece.tolist(), strict=True))
    found = [(theta, _sign_after(carrying, theta, piece, program)) for theta, piece in inner]
    found += _jumps(angles, value, inner)
    return found


def _sign_after(carrying: Callable[[Angles], np.ndarray], theta: float, piece: int, program: CompiledMotion) -> float:
    end = float(program.ends[piece])
    there = np.minimum(theta + 10.0 ** np.arange(-9.0, -2.0), end)
    signs = np.sign(carrying(Angles(there, np.full(there.size, piece))))
    return next((float(sign) for sign in signs if sign), 0.0)


def _jumps(angles: Angles, value: np.ndarray, inner: list[tuple[float, int]]) -> list[tuple[float, float]]:
    """Changes that are no root inside a piece: at joins, and after stretches without force; angle and sign afterwards."""
    loaded = np.flatnonzero(value)
    found = []
    for i, j in zip(np.roll(loaded, 1).tolist(), loaded.tolist(), strict=True):
        if value[i] * value[j] > 0.0 or (j == i + 1 and angles.piece[i] == angles.piece[j]):
            continue
        if any(angles.theta[i] <= theta <= angles.theta[j] and i < j for theta, _ in inner):
            continue
        before = j - 1 if j > i + 1 or i > j else j
        start = float(angles.theta[before if before >= 0 and angles.piece[before] == angles.piece[j] else j])
        found.append((start, float(np.sign(value[j]))))
    return found


def change_findings(changes: tuple[FlankChange, ...], form: Any) -> list[Finding]:
    """A note for each change."""
    found = []
    for change in changes:
        values: dict[str, float | str] = {"to": form_row(form).sides[change.to]}
        if change.impact is not None:
            values |= {"play_mm": form.play_mm, "impact_m_s": change.impact}
        found.append(Finding("flank-change", NOTE, "loads", math.degrees(change.theta), values))
    return found
