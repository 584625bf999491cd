"""Calculations that branch with the angle: the flank in contact, sums over the bodies and forces of a mechanism.

All other quantities are calculated by the form that their row of ``FORMULAS`` gives.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType

import numpy as np

from core.cam import SECOND
from core.design import UNITS
from core.design.fields import in_sentence
from core.dynamics import CAM_FACE
from core.dynamics.free_body import CONTACT, DRIVE, FRICTION, INERTIA, REACTION, WEIGHT, ForceOnBody, element_forces
from core.dynamics.walk import input_of
from core.frozen import frozen
from core.mechanism import body_name, link_number
from core.mechanism.kinematics import REVOLUTE
from core.numerics.derivatives import cross, dot
from core.study import Quantity, Study, quantity
from core.study.letters import keys_of, letters_of
from core.study.member_quantities import TRAIN_NAMES
from core.study.quantities import member_of
from core.study.symbols import (
    CAM,
    DYNAMICS,
    LINKAGE,
    LOADS,
    MOTION,
    Letter,
    first,
    letter,
    motion_unit,
    segment_of,
    speed_field,
)


@frozen
class Calculation:
    """The evaluated form of a formula, and its symbols with their values at one angle."""

    lines: tuple[str, ...]
    letters: tuple[Letter, ...]


CalculationFunction = Callable[[Study, str], Calculation]
"""Calculation of a study at one angle, and of a member of its linkage, empty where the quantity has none."""


def calculation_of(study: Study, row: Quantity) -> Calculation:
    """The calculation of a quantity of a study at one angle."""
    formula, member = row.formula, member_of(row.name)
    assert formula is not None, row.name
    branching = CALCULATIONS.get(formula.name)
    if branching is not None:
        return branching(study, formula.member or member)
    return Calculation((formula.evaluated,), letters_of(study, keys_of(formula), formula.member or member))


def quantity_letter(study: Study, name: str, symbol: str) -> Letter:
    """Another quantity as a symbol."""
    row = quantity(name)
    key = next((key for key in sorted(UNITS, key=len, reverse=True) if UNITS[key] == row.unit), "")
    return letter(symbol, in_sentence(row.label), first(row.value(study)), key, row.stage, row.unit.symbol, row.slug)


# -- motion and links -------------------------------------------------------------------------------------------


def _displacement(study: Study, _: str) -> Calculation:
    number, start, rise = segment_of(study)
    unit, path = motion_unit(study), f"motion.segments[{number}]"
    y = first(study.motion.displacement[0])
    law = study.program.motion.segments[number].curve.law
    begin = letter("y_0", "displacement at the start of the segment", start, unit, MOTION)
    if not rise:
        return Calculation(("y = y_0 + Δ",), (begin, letter("Δ", f"what the law {law} adds", y - start, unit, path)))
    share = letter("s", f"share of the rise by the law {law}", (y - start) / rise, "", f"{path}.law")
    return Calculation(
        ("y = y_0 + h s",), (begin, letter("h", "rise of the segment", rise, unit, f"{path}.rise_{unit}"), share)
    )


def _link_angle(study: Study, number: str) -> Calculation:
    pose = study.linkage.bodies[f"link{number}"]
    positions = list(dict.fromkeys(pose.points.values()))
    turn = first(np.broadcast_to(pose.turn[0], 1))
    if len(positions) < 2:
        return Calculation(
            ("θ = θ_s",),
            (letter("θ_s", "angle of the link that it slides on, plus its fixed angle to that", turn, "deg", LINKAGE),),
        )
    a, b = [name for name, at in pose.points.items() if at in positions[:2]][:2]
    at_a, at_b = (complex(np.atleast_1d(pose.position(name))[0]) for name in (a, b))
    inside = turn - np.angle(at_b - at_a)
    rows = [letter(f"{axis}_{mark}", f"{name}, {axis}", getattr(at, part), "mm", LINKAGE)
            for mark, name, at in (("A", a, at_a), ("B", b, at_b)) for axis, part in (("x", "real"), ("y", "imag"))]  # fmt: skip
    return Calculation(
        ("θ = atan2(y_B - y_A, x_B - x_A) - ζ",),
        (*rows, letter("ζ", "angle of AB in the frame of the link, modulo 360°", -inside, "deg", "linkage.links")),
    )


# -- energy and power -------------------------------------------------------------------------------------------


def _masses(study: Study, bodies: Iterable[str]) -> list[tuple[str, float, float, float, float]]:
    """Body, mass, speed of its centre of mass, inertia and angular velocity of every mass on these bodies."""
    rows = []
    for mass in study.loading.masses:
        if mass.is_active and mass.body in bodies:
            pose, part = study.linkage.bodies[mass.body], mass.inertia
            speed = abs(complex(np.atleast_1d(pose.fixed_point(part.centre)[1])[0])) * study.omega
            rows.append(
                (mass.body, part.mass, speed, part.about_centre, first(np.broadcast_to(pose.turn[1], 1)) * study.omega)
            )
    return rows


def _energy(study: Study, body: str) -> Calculation:
    rows = _masses(study, [body] if body else list(study.linkage.bodies))
    letters, parts = [], []
    for i, (name, mass, speed, inertia, turning) in enumerate(rows, 1):
        of = name.replace("_", " ")
        letters += [letter(f"m_{i}", f"mass of the {of}", mass, "kg", LOADS),
                    letter(f"v_{i}", "speed of the centre of mass", speed, "mm_s", LINKAGE),
                    letter(f"I_{i}", "inertia about the centre of mass", inertia, "kg_m2", LOADS),
                    letter(f"ω_{i}", "angular velocity", turning, "rad_s", LINKAGE)]  # fmt: skip
        parts.append(f"½ (m_{i} v_{i}² + I_{i} ω_{i}²)")
    return Calculation((f"E = {' + '.join(parts) or '0'}",), tuple(letters))


def _velocity(study: Study, row: ForceOnBody) -> tuple[complex, float]:
    """Velocity of the point at which a force acts, and angular velocity of its body."""
    if row.body == "cam":
        turn = study.sense * study.omega
        return 1j * turn * complex(row.at[0]), turn
    pose = study.linkage.bodies.get(row.body)
    if pose is None:
        return 0j, 0.0
    turn = first(np.broadcast_to(pose.turn[1], 1)) * study.omega
    origin = complex(np.atleast_1d(pose.origin[0])[0])
    return complex(np.atleast_1d(pose.origin[1])[0]) * study.omega + 1j * turn * (complex(row.at[0]) - origin), turn


def _acting(study: Study, chosen: Callable[[ForceOnBody], bool]) -> list[ForceOnBody]:
    return [row for rows in study.free_bodies.values() for row in rows if chosen(row)]


def _power(study: Study, rows: list[ForceOnBody]) -> Calculation:
    """Power of forces and couples on their bodies."""
    parts, letters = [], []
    for i, row in enumerate(rows, 1):
        (v, turn), force, couple = _velocity(study, row), complex(row.force[0]), float(row.couple[0])
        words = f"{force_words(row)} on the {row.body.replace('_', ' ')}"
        origin = LOADS if row.kind == WEIGHT else DYNAMICS
        if force or not couple:
            parts.append(f"F_{i}x v_{i}x + F_{i}y v_{i}y")
            for axis, of in (("x", "real"), ("y", "imag")):
                letters += [letter(f"F_{i}{axis}", f"{words}, {axis}", getattr(force, of), "n", origin),
                            letter(f"v_{i}{axis}", f"velocity of its point, {axis}", getattr(v, of), "mm_s", LINKAGE)]  # fmt: skip
        if couple:
            parts.append(f"M_{i} ω_{i}")
            letters += [letter(f"M_{i}", f"{words}, couple", couple, "nm", origin),
                        letter(f"ω_{i}", "angular velocity of the body", turn, "rad_s", LINKAGE)]  # fmt: skip
    if not parts:
        parts, letters = ["P_0"], [letter("P_0", "no force acts", 0.0, "w", LOADS)]
    return Calculation((f"P = {' + '.join(parts)}",), tuple(letters))


def _friction_power(study: Study, pair: str) -> Calculation:
    if pair == CAM_FACE:
        return _power(study, _acting(study, lambda row: row.kind == FRICTION and "cam" in (row.body, row.partner)))
    return _power(study, _acting(study, lambda row: row.kind == FRICTION and row.name == pair))


def _element_power(study: Study, name: str) -> Calculation:
    element, acting = study.loading.named[name], study.loading.acting(study.linkage)
    rows = element_forces(element, study.linkage, study.omega)
    return _power(study, [replace(row, force=acting * row.force, couple=acting * row.couple) for row in rows])


def _drive_power(study: Study, _: str) -> Calculation:
    if "cam" in study.stages:
        return Calculation(("P = T ω",), (quantity_letter(study, "drive_torque", "T"), *letters_of(study, "ω")))
    linkage, omega = study.linkage, study.omega
    driver = (
        first(linkage.slip(linkage.driver_name)) * linkage.driver_sign * first(linkage.motion.displacement[1]) * omega
    )
    if linkage.driver_pair.kind == REVOLUTE:
        parts = ["T ω_d"]
        letters = [quantity_letter(study, "driver_torque", "T"),
                   letter("ω_d", "angular velocity of the driver", driver, "rad_s", LINKAGE)]  # fmt: skip
    else:
        parts = ["F_d v_d"]
        letters = [
            quantity_letter(study, "driver_force", "F_d"),
            letter("v_d", "velocity of the driver", driver, "mm_s", LINKAGE),
        ]
    for i, dyad in enumerate((dyad for dyad in linkage.dyads if dyad.by_motion), 1):
        body, on = (linkage.bodies[name].turn[1] for name in (dyad.bodies[0], dyad.on))
        link = link_number(dyad.bodies[0])
        parts.append(f"T_{i} ω_{i}")
        letters += [quantity_letter(study, f"link{link}_input_torque", f"T_{i}"),
                    letter(f"ω_{i}", f"angular velocity of link {link} against the link of its motor",
                           first(np.atleast_1d(body - on)) * omega, "rad_s", LINKAGE)]  # fmt: skip
    return Calculation((f"P = {' + '.join(parts)}",), tuple(letters))


# -- forces by virtual power --------------------------------------------------------------------------------------


def force_words(row: ForceOnBody) -> str:
    """A force in words."""
    body = row.body.replace("_", " ")
    words = {WEIGHT: "weight of", INERTIA: "inertia force of", REACTION: "force at", FRICTION: "friction at",
             CONTACT: "force of the cam, flank",
             DRIVE: "drive at"}  # fmt: skip
    name = (row.name or "load").replace("_", " ")
    return f"{words[row.kind]} {name}" if row.kind in words else f"{row.kind} {name} on the {body}"


def _virtual_power(study: Study, row: ForceOnBody) -> float:
    """Virtual power of a force: F · ∂r/∂q + M ∂α/∂q."""
    pose = study.linkage.by_driver.get(row.body)
    if pose is None:
        return 0.0
    turn = np.broadcast_to(pose.turn[1], 1)
    speed = pose.origin[1] + 1j * turn * (row.at - study.linkage.bodies[row.body].origin[0])
    return first(dot(row.force, speed) + row.couple * turn)


def _virtual(study: Study) -> list[tuple[str, str, float]]:
    """Virtual power of all forces but those of reactions, cam and driver: kind, words and value; friction on both bodies is one row.

    A second input is included where a motion leads it; an input by a ratio acts on the driver through its loads.
    """
    motors = {input_of(dyad.bodies[0]) for dyad in study.linkage.dyads if dyad.by_motion}
    powers: dict[tuple[str, str], float] = {}
    for rows in study.free_bodies.values():
        for row in rows:
            if (
                row.kind in (REACTION, CONTACT)
                or (row.kind == DRIVE and row.name not in motors)
                or "cam" in (row.body, row.partner)
            ):
                continue
            key = row.kind, force_words(row)
            powers[key] = powers.get(key, 0.0) + _virtual_power(study, row)
    return [(kind, words, value) for (kind, words), value in powers.items()]


def _powers(study: Study) -> tuple[str, list[Letter]]:
    """The sum of virtual powers Q_1 + Q_2 + …, and its symbols."""
    turns = study.linkage.driver_pair.kind == REVOLUTE
    shown = "N·m" if turns else "N"
    rows = [
        letter(f"Q_{i}", f"{words}, on the driver by virtual power", value, "", LOADS if kind in (WEIGHT, INERTIA) else DYNAMICS, shown)
        for i, (kind, words, value) in enumerate(_virtual(study), 1)
    ]  # fmt: skip
    if not rows:
        rows = [letter("Q", "virtual power on the driver: no mass, spring or load acts", 0.0, "", LOADS, shown)]
    return " + ".join(row.symbol for row in rows), rows


def _contact_force(study: Study, _: str) -> Calculation:
    contacts = study.dynamics.contacts
    sums, rows = _powers(study)
    lever = first(contacts[0].lever)
    symbol = "F_c"
    if (
        first(study.dynamics.contact) < 0.0 and study.is_form_closed and len(contacts) > 1
    ):  # of a groove the other flank, drawn negative
        lever = -first(contacts[1].lever)
    pair = any(flank.name == SECOND for flank in study.cam.flanks)
    return _by_lever(study, f"max(({sums})/l, 0)" if pair else f"({sums})/l", symbol, rows, lever)


def _second_contact(study: Study, _: str) -> Calculation:
    sums, rows = _powers(study)
    return _by_lever(study, f"max(({sums})/l, 0)", "F_c2", rows, first(study.dynamics.contacts[1].lever))


def _by_lever(study: Study, line: str, symbol: str, rows: list[Letter], lever: float) -> Calculation:
    """A contact force by its lever l; a roller of a conjugate pair that would have to pull has none."""
    turns = study.linkage.driver_pair.kind == REVOLUTE
    meaning = "lever: force or torque on the driver by one newton of contact force"
    return Calculation((f"{symbol} = {line}",), (*rows, letter("l", meaning, lever, "mm" if turns else "", CAM)))


def _driver(study: Study, _: str, symbol: str) -> Calculation:
    sums, rows = _powers(study)
    return Calculation((f"{symbol} = -({sums})",), tuple(rows))


def _input(study: Study, number: str) -> Calculation:
    """Torque of a second input about its pin, or its force along its line, by the balance of its link."""
    body = body_name(int(number))
    (name,) = next(dyad.pairs for dyad in study.linkage.dyads if dyad.on and dyad.bodies == (body,))
    rows = [
        row
        for row in study.free_bodies.get(body, ())
        if (row.kind, row.name) not in ((REACTION, name), (DRIVE, input_of(body)))
    ]
    if study.linkage.pairs[name].kind == REVOLUTE:
        sums, letters = _moments(study, name, rows)
        return Calculation((f"T = -({sums})",), letters)
    line = complex(np.atleast_1d(study.linkage.line(study.linkage.pairs[name]))[0])
    sums, letters = _terms(rows, "K_{}", "{}, along the line", lambda row: dot(row.force, np.array([line])), "n")
    return Calculation((f"F = -({sums})",), letters)


# -- forces in pairs ----------------------------------------------------------------------------------------------


def _side(study: Study, name: str) -> tuple[float, list[ForceOnBody]]:
    """Sign of a pair's force on one of its moving bodies, and all other forces on that body."""
    pair = study.linkage.pairs[name]
    body, sign = (pair.body, 1.0) if pair.body in study.free_bodies else (pair.on, -1.0)
    in_pair = (REACTION, FRICTION)
    rows = [row for row in study.free_bodies.get(body, ()) if not (row.name == name and row.kind in in_pair)]
    return sign, rows


def _terms(
    rows: list[ForceOnBody], symbol: str, meaning: str, value: Callable[[ForceOnBody], np.ndarray], unit: str
) -> tuple[str, tuple[Letter, ...]]:
    """A sum over forces on a body, and its symbols."""
    letters = tuple(
        letter(symbol.format(i), meaning.format(force_words(row)), first(value(row)), unit,
               LOADS if row.kind in (WEIGHT, INERTIA) else DYNAMICS)
        for i, row in enumerate(rows, 1)
    )  # fmt: skip
    return " + ".join(letter.symbol for letter in letters), letters


def _moments(study: Study, pair: str, rows: list[ForceOnBody]) -> tuple[str, tuple[Letter, ...]]:
    """Sum of moments about a pair's point."""
    joined = study.linkage.pairs[pair]
    bodies = study.linkage.bodies
    at = bodies[joined.body if joined.body in bodies else joined.on].position(joined.point)
    meaning = "moment of {} about the pair's point"
    return _terms(rows, "M_{}", meaning, lambda row: cross(row.at - at, row.force) + row.couple, "nm")


def _bearing(study: Study, _: str, axis: str) -> Calculation:
    parts = []
    for i, (flank, contact) in enumerate(zip(study.cam.flanks, study.dynamics.contacts, strict=True), 1):
        push = complex(np.atleast_1d(contact.direction)[0])
        value = push.real if axis == "x" else push.imag
        parts += [letter(f"F_{i}", f"contact force, flank {flank.name}", first(contact.force), "n", DYNAMICS),
                  letter(f"p_{i}{axis}", f"its direction on the cam, {axis}", value, "", CAM)]  # fmt: skip
    sums = " + ".join(f"F_{i} p_{i}{axis}" for i in range(1, len(parts) // 2 + 1))
    return Calculation((f"O_{axis} = -({sums})",), tuple(parts))


def _reaction(study: Study, pair: str, axis: str) -> Calculation:
    """A component of a pair's force by the balance of one body."""
    sign, rows = _side(study, pair)
    sums, letters = _terms(
        rows, f"K_{{}}{axis}", f"{{}}, {axis}", lambda row: row.force.real if axis == "x" else row.force.imag, "n"
    )
    minus = "-" if sign > 0.0 else ""
    return Calculation((f"F_{axis} = {minus}({sums})",), letters)


def _couple(study: Study, pair: str) -> Calculation:
    """The couple of a pair by the moments about its point."""
    sign, rows = _side(study, pair)
    sums, letters = _moments(study, pair, rows)
    return Calculation((f"M = {'-' if sign > 0.0 else ''}({sums})",), letters)


def _jam(study: Study, _: str) -> Calculation:
    frictions = study.loading.frictions
    jam = first(study.dynamics.jam)
    if len(frictions) == 1 and frictions[0].coefficient:
        mu = float(np.atleast_1d(frictions[0].coefficient)[0])
        gain = letter("g", "increase of the normal force by one newton of friction", jam / mu, "", LINKAGE)
        return Calculation(("j = μ g",), (letter("μ", "coefficient of friction", mu, "", frictions[0].field), gain))
    return Calculation(
        ("j = λ",), (letter("λ", "spectral radius of μ ∂N/∂f over all pairs with friction", jam, "", DYNAMICS),)
    )


# -- shaft --------------------------------------------------------------------------------------------------------


def _motor_torque(study: Study, _: str) -> Calculation:
    if not study.levels_torque:
        row = "driver_torque" if study.by_crank else "drive_torque"
        sign = study.sense if study.by_crank else 1.0
        return Calculation(
            ("T_m = σ T",),
            (
                letter("σ", "-1 of a crank that turns clockwise", sign, "", "shaft.rotation"),
                quantity_letter(study, row, "T"),
            ),
        )
    wheel = study.flywheel
    return motor_torque(study, wheel.mean_torque, first(wheel.speed(study.angles)))


def _speed(study: Study, _: str) -> Calculation:
    if not study.levels_torque:
        return shaft_speed(study, first(quantity("camshaft_speed").value(study)), None)
    wheel = study.flywheel
    return shaft_speed(
        study, first(wheel.speed(study.angles)), (wheel.mean_torque, first(wheel.motor_torque(study.angles)))
    )


def _slope(study: Study) -> Letter:
    k = float(study.design.camshaft.motor_slope_nm_s_per_rad)
    return letter("k", "slope of the motor", k, "nm_s_per_rad", "shaft.motor_slope_nm_s_per_rad")


def motor_torque(study: Study, mean: float, speed: float) -> Calculation:
    """Torque of the motor's line at a speed [rad/s], with the mean torque of the turn [N m]."""
    letters = (
        letter("T̄", "mean torque of the turn", mean, "nm", DYNAMICS),
        _slope(study),
        letter("ω̄", "mean speed", study.omega, "rad_s", speed_field(study)),
        letter("ω", "speed of the shaft", speed, "rad_s", DYNAMICS),
    )
    return Calculation(("T_m = T̄ + k (ω̄ - ω)",), letters)


def shaft_speed(study: Study, speed: float, torques: tuple[float, float] | None) -> Calculation:
    """Speed [rad/s] by the motor's line, from mean torque and motor torque [N m]; by energy without slope or flywheel."""
    mean = letter("n̄", "mean speed", study.omega, "rpm", speed_field(study))
    slope = _slope(study)
    if torques is None or not slope.value:
        change = letter("δ", "change of speed by the energy of the turn", speed - study.omega, "rpm", DYNAMICS)
        return Calculation(("n = n̄ + δ",), (mean, change))
    rows = zip(("T̄", "T_m"), ("mean torque of the turn", "torque of the motor"), torques, strict=True)
    letters = (letter(symbol, meaning, value, "nm", DYNAMICS) for symbol, meaning, value in rows)
    return Calculation(("n = n̄ + (T̄ - T_m)/k",), (mean, *letters, slope))


_PAIRS = ("slider_pin", "arm_pin", "pivot", "guide", *TRAIN_NAMES)
CALCULATIONS: Mapping[str, CalculationFunction] = MappingProxyType(
    {
        "displacement": _displacement,
        "link.{}": _link_angle,
        "kinetic_energy": _energy,
        "kinetic_energy.{}": _energy,
        "power.load": lambda s, _: _element_power(s, "load"),
        "power.drive": _drive_power,
        "power.gravity": lambda s, _: _power(s, _acting(s, lambda row: row.kind == WEIGHT)),
        "power.friction_{}": _friction_power,
        "power.{}": _element_power,
        "contact_force": _contact_force,
        "second_contact_force": _second_contact,
        "driver_torque": partial(_driver, symbol="T"),
        "driver_force": partial(_driver, symbol="F_d"),
        "force": partial(_driver, symbol="F"),
        "output_torque": partial(_driver, symbol="T"),
        "link{}_input_torque": _input,
        "link{}_input_force": _input,
        **{f"{pair}_{axis}": partial(_reaction, axis=axis) for pair in (*_PAIRS, "force.{}") for axis in "xy"},
        "bearing_x": partial(_bearing, axis="x"),
        "bearing_y": partial(_bearing, axis="y"),
        "guide_couple": _couple,
        "couple.{}": _couple,
        "jam_factor": _jam,
        "motor_torque": _motor_torque,
        "camshaft_speed": _speed,
    }
)
"""Name of a row of ``FORMULAS`` -> its calculation."""
