"""How forces, torques, stresses and vibrations are worked out at one angle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from core.cam import SECOND
from core.design import UNITS
from core.dynamics.free_body import CONTACT, DRIVE, FRICTION, INERTIA, REACTION, WEIGHT, ForceOnBody
from core.dynamics.walk import input_of
from core.mechanism import body_name
from core.mechanism.kinematics import REVOLUTE
from core.numerics.derivatives import cross, dot
from core.output.explain.letters import (
    CAM,
    DYNAMICS,
    LINKAGE,
    LOADS,
    MOTION,
    STABILITY,
    Letter,
    Maker,
    Working,
    first,
    known,
    letter,
    motion_unit,
    other,
    speed_field,
)
from core.stress import pairings, relative_curvature
from core.study import Study, quantity
from core.study.study import roller_speed


def named_force(row: ForceOnBody) -> str:
    """What acts, in words."""
    body = row.body.replace("_", " ")
    words = {WEIGHT: "weight of", INERTIA: "inertia force of", REACTION: "force at", FRICTION: "friction at",
             CONTACT: "force of the cam, flank",
             DRIVE: "drive at"}  # fmt: skip
    name = (row.name or "load").replace("_", " ")
    return f"{words[row.kind]} {name}" if row.kind in words else f"{row.kind} {name} on the {body}"


def _moved(study: Study, row: ForceOnBody) -> float:
    """Virtual power of a force: F · ∂r/∂q + M ∂α/∂q."""
    pose = study.linkage.by_driver.get(row.body)
    if pose is None:
        return 0.0
    turn = np.broadcast_to(pose.turn[1], 1)
    speed = pose.origin[1] + 1j * turn * (row.at - study.linkage.bodies[row.body].origin[0])
    return first(dot(row.force, speed) + row.couple * turn)


def _virtual(study: Study) -> list[tuple[str, str, float]]:
    """Virtual power of everything but reactions, the cam and the driver: kind, in words, value; friction on both bodies as one.

    A second input is included where its own motion leads it; by a ratio it gives what it requires of the driver.
    """
    motors = {input_of(dyad.bodies[0]) for dyad in study.linkage.dyads if dyad.by_motion}
    found: dict[tuple[str, str], float] = {}
    for rows in study.free_bodies.values():
        for row in rows:
            if (
                row.kind in (REACTION, CONTACT)
                or (row.kind == DRIVE and row.name not in motors)
                or "cam" in (row.body, row.by)
            ):
                continue
            key = row.kind, named_force(row)
            found[key] = found.get(key, 0.0) + _moved(study, row)
    return [(kind, words, value) for (kind, words), value in found.items()]


def _powers(study: Study) -> tuple[str, list[Letter]]:
    """The sum of virtual powers as letters Q_1 + Q_2 + ..., and them."""
    turns = study.linkage.driver_pair.kind == REVOLUTE
    shown = "N·m" if turns else "N"
    rows = [
        letter(f"Q_{i}", f"{words}, on the driver by virtual power", value, "", LOADS if kind in (WEIGHT, INERTIA) else DYNAMICS, shown)
        for i, (kind, words, value) in enumerate(_virtual(study), 1)
    ]  # fmt: skip
    if not rows:
        rows = [letter("Q", "virtual power on the driver: no mass, spring or load acts", 0.0, "", LOADS, shown)]
    return " + ".join(row.symbol for row in rows), rows


def _contact_force(study: Study, _: str) -> Working:
    contacts = study.dynamics.contacts
    sums, rows = _powers(study)
    lever = first(contacts[0].lever)
    symbol = "F_c"
    if (
        first(study.dynamics.contact) < 0.0 and study.holds and len(contacts) > 1
    ):  # of a groove the other flank, drawn negative
        lever = -first(contacts[1].lever)
    pair = any(flank.name == SECOND for flank in study.cam.flanks)
    return _pushed(study, f"max(({sums})/l, 0)" if pair else f"({sums})/l", symbol, rows, lever)


def _second_contact(study: Study, _: str) -> Working:
    sums, rows = _powers(study)
    return _pushed(study, f"max(({sums})/l, 0)", "F_c2", rows, first(study.dynamics.contacts[1].lever))


def _pushed(study: Study, line: str, symbol: str, rows: list[Letter], lever: float) -> Working:
    """A contact force by its lever l; of a conjugate pair the roller that would have to pull is idle."""
    turns = study.linkage.driver_pair.kind == REVOLUTE
    meaning = "force or torque that one newton of contact force requires of the driver"
    return Working((f"{symbol} = {line}",), (*rows, letter("l", meaning, lever, "mm" if turns else "", CAM)))


def _driver(study: Study, _: str, symbol: str) -> Working:
    sums, rows = _powers(study)
    return Working((f"{symbol} = -({sums})",), tuple(rows))


def _input(study: Study, number: str) -> Working:
    """The torque of a second input about its pin, or its force along its line, by the balance of its link."""
    body = body_name(int(number))
    (name,) = next(dyad.pairs for dyad in study.linkage.dyads if dyad.on and dyad.bodies == (body,))
    rows = [
        row
        for row in study.free_bodies.get(body, ())
        if (row.kind, row.name) not in ((REACTION, name), (DRIVE, input_of(body)))
    ]
    if study.linkage.pairs[name].kind == REVOLUTE:
        sums, letters = _moments(study, name, rows)
        return Working((f"T = -({sums})",), letters)
    line = complex(np.atleast_1d(study.linkage.line(study.linkage.pairs[name]))[0])
    sums, letters = _terms(rows, "K_{}", "{}, along the line", lambda row: dot(row.force, np.array([line])), "n")
    return Working((f"F = -({sums})",), letters)


def _output_power(study: Study, _: str) -> Working:
    turns = motion_unit(study) == "deg"
    symbol, name = ("T", "output_torque") if turns else ("F", "force")
    speed = first(study.motion.displacement[1]) * study.omega
    return Working(
        (f"P = {symbol} ẏ",),
        (other(study, name, symbol), letter("ẏ", "velocity", speed, "rad_s" if turns else "mm_s", MOTION)),
    )


def _drive_torque(study: Study, _: str) -> Working:
    return Working(("T_c = -d (C_x p_y - C_y p_x) F",), known(study, "d C_x C_y p_x p_y F"))


def _follower_torque(study: Study, _: str) -> Working:
    kinematics = study.linkage
    pair = kinematics.pairs[kinematics.ground]
    force = known(study, "F p_x p_y")
    if pair.kind != REVOLUTE:
        line = complex(np.atleast_1d(kinematics.line(pair))[0])
        e = tuple(
            letter(f"e_{p}", f"direction of the guide, {p}", v, "", LINKAGE)
            for p, v in (("x", line.real), ("y", line.imag))
        )
        return Working(("T_L = -F (p_x e_x + p_y e_y)",), (*force, *e))
    pivot = complex(np.atleast_1d(kinematics.bodies[pair.body].position(pair.point))[0])
    parts = tuple(letter(f"P_{p}", f"pivot, {p}", v, "mm", LINKAGE) for p, v in (("x", pivot.real), ("y", pivot.imag)))
    return Working(("T_L = -F ((C_x - P_x) p_y - (C_y - P_y) p_x)",), (*force, *known(study, "C_x C_y"), *parts))


def _side(study: Study, name: str) -> tuple[float, list[ForceOnBody]]:
    """The sign of a pair's force on one of its bodies that move, and the other forces on that, what drives there included."""
    pair = study.linkage.pairs[name]
    body, sign = (pair.body, 1.0) if pair.body in study.free_bodies else (pair.on, -1.0)
    own = (REACTION, FRICTION)
    rows = [row for row in study.free_bodies.get(body, ()) if not (row.name == name and row.kind in own)]
    return sign, rows


def _terms(
    rows: list[ForceOnBody], symbol: str, meaning: str, value: Callable[[ForceOnBody], np.ndarray], unit: str
) -> tuple[str, tuple[Letter, ...]]:
    """A sum over forces on a body, and its letters."""
    letters = tuple(
        letter(symbol.format(i), meaning.format(named_force(row)), first(value(row)), unit,
               LOADS if row.kind in (WEIGHT, INERTIA) else DYNAMICS)
        for i, row in enumerate(rows, 1)
    )  # fmt: skip
    return " + ".join(each.symbol for each in letters), letters


def _moments(study: Study, pair: str, rows: list[ForceOnBody]) -> tuple[str, tuple[Letter, ...]]:
    """The sum of moments about a pair's point."""
    joined = study.linkage.pairs[pair]
    bodies = study.linkage.bodies
    at = bodies[joined.body if joined.body in bodies else joined.on].position(joined.point)
    meaning = "moment of {} about the pair's point"
    return _terms(rows, "M_{}", meaning, lambda row: cross(row.at - at, row.force) + row.couple, "nm")


def _bearing(study: Study, _: str, axis: str) -> Working:
    parts = []
    for i, (flank, each) in enumerate(zip(study.cam.flanks, study.dynamics.contacts, strict=True), 1):
        push = complex(np.atleast_1d(each.pressing)[0])
        value = push.real if axis == "x" else push.imag
        parts += [letter(f"F_{i}", f"contact force, flank {flank.name}", first(each.force), "n", DYNAMICS),
                  letter(f"p_{i}{axis}", f"its direction on the cam, {axis}", value, "", CAM)]  # fmt: skip
    sums = " + ".join(f"F_{i} p_{i}{axis}" for i in range(1, len(parts) // 2 + 1))
    return Working((f"O_{axis} = -({sums})",), tuple(parts))


def _reaction(study: Study, pair: str, axis: str, symbol: str = "F") -> Working:
    """A component of a pair's force by the balance of one body."""
    if pair == "bearing":
        return _bearing(study, "", axis)
    sign, rows = _side(study, pair)
    sums, letters = _terms(
        rows, f"K_{{}}{axis}", f"{{}}, {axis}", lambda row: row.force.real if axis == "x" else row.force.imag, "n"
    )
    minus = "-" if sign > 0.0 else ""
    return Working((f"{symbol}_{axis} = {minus}({sums})",), letters)


def _couple(study: Study, pair: str) -> Working:
    """The couple of a pair by the moments about its point."""
    sign, rows = _side(study, pair)
    sums, letters = _moments(study, pair, rows)
    return Working((f"M = {'-' if sign > 0.0 else ''}({sums})",), letters)


def _guide_force(study: Study, _: str) -> Working:
    pair = study.loading.guide
    line = complex(np.atleast_1d(study.linkage.line(study.linkage.pairs[pair]))[0])
    x, y = (other(study, f"guide_{axis}", f"G_{axis}") for axis in "xy")
    e = tuple(
        letter(f"e_{p}", f"direction of the guide, {p}", v, "", LINKAGE)
        for p, v in (("x", line.real), ("y", line.imag))
    )
    return Working(("N = e_x G_y - e_y G_x",), (x, y, *e))


def _size_of(pair: str) -> Maker:
    """Of a follower's pair: its two components."""
    return lambda study, _: _size(study, pair)


def _size(study: Study, pair: str) -> Working:
    force = complex(np.atleast_1d(study.dynamics.pairs[pair])[0])
    return Working(("F = √(F_x² + F_y²)",), _components(force))


def _direction(study: Study, pair: str) -> Working:
    force = complex(np.atleast_1d(study.dynamics.pairs[pair])[0])
    return Working(("ε = atan2(F_y, F_x)",), _components(force))


def _components(force: complex) -> tuple[Letter, ...]:
    return (letter("F_x", "component x", force.real, "n"), letter("F_y", "component y", force.imag, "n"))


def _jam(study: Study, _: str) -> Working:
    frictions = study.loading.frictions
    jam = first(study.dynamics.jam)
    if len(frictions) == 1 and frictions[0].coefficient:
        mu = float(np.atleast_1d(frictions[0].coefficient)[0])
        gain = letter("g", "how much one newton of friction adds to the normal force", jam / mu, "", LINKAGE)
        return Working(("j = μ g",), (letter("μ", "coefficient of friction", mu, "", frictions[0].field), gain))
    return Working(("j = λ",), (letter("λ", "spectral radius of μ ∂N/∂f over all pairs that rub", jam, "", DYNAMICS),))


def _hertz(study: Study, _: str, second: bool, part: str) -> Working:
    there = pairings(study.design.drive.face, study.design.drive.cam)
    flanks = [f for f in study.cam.flanks if (f.name == SECOND) == second]
    at = max(flanks, key=lambda f: first(study.stress[f.name].pressure))
    pairing, bend = there[at.name], first(relative_curvature(at))
    contact = study.dynamics.contacts[[f.name for f in study.cam.flanks].index(at.name)]
    index = "₂" if second else ""
    p = f"p{index}"
    pressure = letter(p, "contact pressure", first(study.stress[at.name].pressure), "mpa", DYNAMICS)
    modulus = letter("E", "effective modulus E*, 1/E* = Σ (1 - ν²)/E", float(pairing.modulus), "mpa", "cam.material")
    curvature = letter("κ_r", "sum of the curvatures of cam and what touches it", bend, "per_mm", CAM)
    half = letter(f"a{index}", "half width of the contact", first(study.stress[at.name].half_width), "mm", DYNAMICS)
    force = max(first(contact.force), 0.0)
    lines = {
        "pressure": (f"{p} = √(F E κ_r/(π b))", (letter("F", "force on the flank", force, "n", DYNAMICS), modulus, curvature,
                     letter("b", "length of the line of contact", float(pairing.width), "mm", "cam.thickness_mm"))),
        "shear": (f"τ{index} = 0.3002831 {p}", (pressure,)),
        "depth": (f"z{index} = 0.7861514 a{index}", (half,)),
        "half_width": (f"a{index} = 2 {p}/(E κ_r)", (pressure, modulus, curvature)),
    }  # fmt: skip
    line, letters = lines[part]
    return Working((line,), letters)


def _roller(study: Study, _: str, roller: str) -> Working:
    speed = first(roller_speed(study, roller))
    ratio = letter("u", "turns of the roller about its own axis for one of the shaft", speed / study.omega, "", CAM)
    return Working(("n_r = ω u",), (*known(study, "ω"), ratio))


def _motor_torque(study: Study, _: str) -> Working:
    if not study.levelled:
        row = "drive_torque" if "cam" in study.stages else "driver_torque"
        sign = study.sense if study.by_crank else 1.0
        return Working(
            ("T_m = σ T",),
            (letter("σ", "-1 of a crank that turns clockwise", sign, "", "shaft.rotation"), other(study, row, "T")),
        )
    wheel = study.flywheel
    return motor_torque(study, wheel.mean_torque, first(wheel.speed(study.angles)))


def _speed(study: Study, _: str) -> Working:
    if not study.levelled:
        return shaft_speed(study, first(quantity("camshaft_speed").value(study)), None)
    wheel = study.flywheel
    return shaft_speed(
        study, first(wheel.speed(study.angles)), (wheel.mean_torque, first(wheel.motor_torque(study.angles)))
    )


def _slope(study: Study) -> Letter:
    k = float(study.design.camshaft.motor_slope_nm_s_per_rad)
    return letter("k", "slope of the motor", k, "nm_s_per_rad", "shaft.motor_slope_nm_s_per_rad")


def motor_torque(study: Study, mean: float, speed: float) -> Working:
    """The motor's line at a speed [rad/s]; mean: torque of the turn [N m]."""
    letters = (
        letter("T̄", "mean torque of the turn", mean, "nm", DYNAMICS),
        _slope(study),
        letter("ω̄", "mean speed", study.omega, "rad_s", speed_field(study)),
        letter("ω", "speed there", speed, "rad_s", DYNAMICS),
    )
    return Working(("T_m = T̄ + k (ω̄ - ω)",), letters)


def shaft_speed(study: Study, speed: float, torques: tuple[float, float] | None) -> Working:
    """The speed [rad/s] by the motor's line, from the mean torque and the motor's [N m]; by the energy of the turn where the motor has no
    slope, or no flywheel levels the speed."""
    mean = letter("n̄", "mean speed", study.omega, "rpm", speed_field(study))
    slope = _slope(study)
    if torques is None or not slope.value:
        change = letter("δ", "change of speed by the energy of the turn", speed - study.omega, "rpm", DYNAMICS)
        return Working(("n = n̄ + δ",), (mean, change))
    rows = zip(("T̄", "T_m"), ("mean torque of the turn", "torque of the motor"), torques, strict=True)
    letters = (letter(symbol, meaning, value, "nm", DYNAMICS) for symbol, meaning, value in rows)
    return Working(("n = n̄ + (T̄ - T_m)/k",), (mean, *letters, slope))


def _linear(study: Study, _: str) -> Working:
    value = first(quantity("linear_motor_torque").value(study))
    mean = study.flywheel.mean_torque
    return Working(
        ("T_m = T̄ + H",),
        (letter("T̄", "mean torque of the turn", mean, "nm", DYNAMICS),
         letter("H", "its harmonics, each over 1 + i n I ω̄/k", value - mean, "nm", DYNAMICS)),
    )  # fmt: skip


def _elastic(study: Study, _: str, what: str) -> Working:
    unit = motion_unit(study)
    second = "mm_s2" if unit == "mm" else "deg_s2"
    rates = {order: first(study.elastic_error(order)) for order in (0, 2)}
    s = letter("s", "motion of the cam", first(study.motion.displacement[0]), unit, MOTION)
    e = letter("e", "deviation of the mass from it, of the response that repeats", rates[0], unit, DYNAMICS)
    lines = {
        "displacement": ("z = s + e", (s, e)),
        "error": ("e = z - s", (letter("z", "place of the mass", s.value * UNITS[unit].factor + rates[0], unit, DYNAMICS), s)),
        "acceleration": ("z̈ = ω² s″ + ë", (*known(study, "ω"),
                         letter("s″", "second derivative of the motion by cam angle", first(study.motion.displacement[2]), unit, MOTION),
                         letter("ë", "deviation's acceleration", rates[2], second, DYNAMICS))),
    }  # fmt: skip
    line, letters = lines[what]
    return Working((line,), letters)


def _elastic_contact(study: Study, _: str) -> Working:
    rigid = first(study.dynamics.contact)
    whole = first(study.elastic_contact_force)
    return Working(
        ("F_e = F_c + Δ",),
        (
            letter("F_c", "contact force of a rigid follower", rigid, "n", DYNAMICS),
            letter(
                "Δ", "m ë + c ė + k_s e of the deviation e, by the lever of the contact", whole - rigid, "n", DYNAMICS
            ),
        ),
    )


def _wind_up(study: Study, _: str) -> Working:
    turn = study.steady_turn
    torque = first(turn.torque(study.theta))
    return Working(
        ("ϕ = T_s/K_s",),
        (letter("T_s", "torque in the shaft", torque, "nm", STABILITY),
         letter("K_s", "stiffness of the shaft", float(turn.stiffness), "nm_per_rad", "shaft.stiffness_nm_per_rad")),
    )  # fmt: skip


def _shaft_torque(study: Study, _: str) -> Working:
    turn = study.steady_turn
    return Working(
        ("T_s = K_s ϕ",),
        (letter("K_s", "stiffness of the shaft", float(turn.stiffness), "nm_per_rad", "shaft.stiffness_nm_per_rad"),
         letter("ϕ", "wind-up θ_i - θ_c", first(turn.wind_up(study.theta)), "deg", STABILITY)),
    )  # fmt: skip


def _follower_error(study: Study, _: str) -> Working:
    unit = motion_unit(study)
    wind = first(study.steady_turn.wind_up(study.theta))
    here = first(study.at_theta(study.theta % (2.0 * np.pi)).motion.displacement[0])
    behind = first(study.at_theta((study.theta - wind) % (2.0 * np.pi)).motion.displacement[0])
    return Working(
        ("Δ = X_c - X_i",),
        (letter("X_c", "motion at the angle of the cam, θ_i - wind-up", behind, unit, MOTION),
         letter("X_i", "motion at the angle of the input", here, unit, MOTION)),
    )  # fmt: skip


_PAIRS = ("slider_pin", "arm_pin", "pivot", "guide")
FORCE_ROWS: Mapping[str, Maker] = MappingProxyType(
    {
        "contact_force": _contact_force,
        "second_contact_force": _second_contact,
        "drive_torque": _drive_torque,
        "follower_torque": _follower_torque,
        "motor_torque": _motor_torque,
        "linear_motor_torque": _linear,
        "camshaft_speed": _speed,
        "guide_force": _guide_force,
        **{f"{pair}_{axis}": partial(lambda s, _, pair, axis: _reaction(s, pair, axis), pair=pair, axis=axis)
           for pair in (*_PAIRS, "bearing") for axis in "xy"},
        **{pair: _size_of(pair) for pair in (*_PAIRS, "bearing")},
        **{f"{pair}_direction": partial(lambda s, _, pair: _direction(s, pair), pair=pair) for pair in (*_PAIRS, "bearing")},
        "guide_couple": lambda s, _: _couple(s, "guide"),
        "jam_factor": _jam,
        **{f"{key}{name}": partial(_hertz, second=bool(key), part=part) for key in ("", "second_")
           for name, part in (("contact_pressure", "pressure"), ("subsurface_shear", "shear"),
         ("subsurface_shear_depth", "depth"), ("contact_half_width", "half_width"))},
        "roller_speed": partial(_roller, roller="first"),
        "second_roller_speed": partial(_roller, roller="second"),
        "elastic_displacement": partial(_elastic, what="displacement"),
        "elastic_error": partial(_elastic, what="error"),
        "elastic_acceleration": partial(_elastic, what="acceleration"),
        "elastic_contact_force": _elastic_contact,
        "wind_up": _wind_up,
        "shaft_torque": _shaft_torque,
        "follower_error": _follower_error,
        "force.{}_x": partial(_reaction, axis="x"),
        "force.{}_y": partial(_reaction, axis="y"),
        "force.{}_size": _size,
        "force.{}_direction": _direction,
        "couple.{}": _couple,
        "driver_torque": partial(_driver, symbol="T"),
        "driver_force": partial(_driver, symbol="F_d"),
        "link{}_input_torque": _input,
        "link{}_input_force": _input,
        "force": partial(_driver, symbol="F"),
        "output_torque": partial(_driver, symbol="T"),
        "output_power": _output_power,
    }
)  # fmt: skip
"""Quantity, or row of the members of a linkage -> how it is worked out."""
