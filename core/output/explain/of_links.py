"""How angles, places, powers of a linkage's members are worked out at one angle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from core.dynamics import CAM_FACE
from core.dynamics.free_body import FRICTION, WEIGHT, ForceOnBody, acting_of
from core.mechanism import link_number
from core.mechanism.kinematics import REVOLUTE
from core.output.explain.letters import (
    DYNAMICS,
    LINKAGE,
    LOADS,
    Maker,
    Working,
    first,
    known,
    letter,
    other,
)
from core.output.explain.of_forces import named_force
from core.study import Study


def _link_angle(study: Study, number: str) -> Working:
    pose = study.linkage.bodies[f"link{number}"]
    places = list(dict.fromkeys(pose.points.values()))
    turn = first(np.broadcast_to(pose.turn[0], 1))
    if len(places) < 2:
        return Working(("θ = θ_s",), (letter("θ_s", "angle of what it slides on, with its own", turn, "deg", LINKAGE),))
    a, b = [name for name, at in pose.points.items() if at in places[:2]][:2]
    one, other = (complex(np.atleast_1d(pose.place(name))[0]) for name in (a, b))
    own = turn - np.angle(other - one)
    rows = [letter(f"{axis}_{mark}", f"{name}, {axis}", getattr(at, part), "mm", LINKAGE)
            for mark, name, at in (("A", a, one), ("B", b, other)) for axis, part in (("x", "real"), ("y", "imag"))]  # fmt: skip
    return Working(
        ("θ = atan2(y_B - y_A, x_B - x_A) - ζ",),
        (*rows, letter("ζ", "angle of AB in the link's own frame, less whole turns", -own, "deg", "linkage.links")),
    )


def _derived(study: Study, symbol: str, key: str, order: int, unit: str) -> Working:
    mark = {1: "′", 2: "″"}[order]
    slope = first(study.linkage.coordinates[key][order])
    power = "ω" if order == 1 else "ω²"
    shown = letter(f"{symbol}{mark}", "derivative by the angle of cam or crank", slope, unit, LINKAGE)
    dot_ = {1: "\u0307", 2: "\u0308"}[order]
    return Working((f"{symbol}{dot_} = {power} {symbol}{mark}",), (*known(study, "ω"), shown))


def _driver_angle(study: Study, _: str) -> Working:
    """The crank's angle in its cycle: to one end and back, or several turns."""
    rate, theta = first(study.drive.displacement[1]), first(study.theta)
    swing = study.driver_ranges.ranges[0]
    back = study.swings and rate < 0.0
    start, begin = (swing.high, np.pi) if back else (swing.low, 0.0) if study.swings else (0.0, 0.0)
    return Working(
        ("φ = φ_0 + r (θ - θ_0)",),
        (letter("φ_0", "driver angle from which it goes", start, "deg", LINKAGE),
         letter("r", "turning of the driver by the angle of the cycle", rate, "", LINKAGE),
         letter("θ", "angle of the cycle", theta, "deg", "--at"),
         letter("θ_0", "angle of the cycle there", begin, "deg", LINKAGE)),
    )  # fmt: skip


def _slide(study: Study, number: str) -> Working:
    value = first(study.linkage.coordinates[f"slide{number}"][0])
    return Working(("s = s_0",), (letter("s_0", "place along its line, from the loops", value, "mm", LINKAGE),))


def _point(study: Study, point: str, axis: str) -> Working:
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    local, origin, turn = (
        pose.points[point],
        complex(np.atleast_1d(pose.origin[0])[0]),
        first(np.broadcast_to(pose.turn[0], 1)),
    )
    o = letter(f"o_{axis}", f"origin of its link, {axis}", origin.real if axis == "x" else origin.imag, "mm", LINKAGE)
    a, b = (
        letter("a", "its place in the link's frame, along", local.real, "mm", "linkage.links"),
        letter("b", "across", local.imag, "mm", "linkage.links"),
    )
    line = f"x = o_{axis} + a cos θ - b sin θ" if axis == "x" else f"y = o_{axis} + a sin θ + b cos θ"
    return Working((line,), (o, a, b, letter("θ", "angle of its link", turn, "deg", LINKAGE)))


def _point_rate(study: Study, point: str, axis: str, order: int) -> Working:
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    at = complex(np.atleast_1d(pose.place(point, order))[0])
    mark = {1: "′", 2: "″"}[order]
    value = letter(
        f"{axis}{mark}", "derivative by the angle of cam or crank", at.real if axis == "x" else at.imag, "mm", LINKAGE
    )
    dot_ = {1: "\u0307", 2: "\u0308"}[order]
    return Working((f"{axis}{dot_} = {'ω' if order == 1 else 'ω²'} {axis}{mark}",), (*known(study, "ω"), value))


def _point_speed(study: Study, point: str) -> Working:
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    speed = complex(np.atleast_1d(pose.place(point, 1))[0]) * study.omega
    return Working(
        ("V = √(ẋ² + ẏ²)",),
        (
            letter("ẋ", "velocity, x", speed.real, "mm_s", LINKAGE),
            letter("ẏ", "velocity, y", speed.imag, "mm_s", LINKAGE),
        ),
    )


def _transmission(study: Study, joint: str) -> Working:
    sine = first(study.linkage.singular[joint])
    cosine = first(np.cos(study.linkage.transmission[joint]))
    return Working(
        ("μ = atan2(s, c)",),
        (letter("s", "|c₁ × c₂|/(|c₁||c₂|) of the two links there", sine, "", LINKAGE),
         letter("c", "|c₁ · c₂|/(|c₁||c₂|)", cosine, "", LINKAGE)),
    )  # fmt: skip


def _masses(study: Study, bodies: Iterable[str]) -> list[tuple[str, float, float, float, float]]:
    """Body, mass, speed of its centre, inertia, angular velocity of all that moves on these bodies."""
    rows = []
    for mass in study.loading.masses:
        if mass.acts and mass.body in bodies:
            pose, part = study.linkage.bodies[mass.body], mass.inertia
            speed = abs(complex(np.atleast_1d(pose.carried(part.centre)[1])[0])) * study.omega
            rows.append(
                (mass.body, part.mass, speed, part.about_centre, first(np.broadcast_to(pose.turn[1], 1)) * study.omega)
            )
    return rows


def _energy(study: Study, body: str) -> Working:
    rows = _masses(study, [body] if body else list(study.linkage.bodies))
    letters, parts = [], []
    for i, (name, mass, speed, inertia, turning) in enumerate(rows, 1):
        of = name.replace("_", " ")
        letters += [letter(f"m_{i}", f"mass of the {of}", mass, "kg", LOADS),
                    letter(f"v_{i}", "speed of its centre of mass", speed, "mm_s", LINKAGE),
                    letter(f"I_{i}", "inertia about that", inertia, "kg_m2", LOADS),
                    letter(f"ω_{i}", "its angular velocity", turning, "rad_s", LINKAGE)]  # fmt: skip
        parts.append(f"½ (m_{i} v_{i}² + I_{i} ω_{i}²)")
    return Working((f"E = {' + '.join(parts) or '0'}",), tuple(letters))


def _velocity(study: Study, row: ForceOnBody) -> tuple[complex, float]:
    """Of the body's point at which a force acts, and the body's angular velocity."""
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


def _work_rate(study: Study, rows: list[ForceOnBody]) -> Working:
    """Power of forces and couples on the bodies that they act on."""
    parts, letters = [], []
    for i, row in enumerate(rows, 1):
        (v, turn), force, couple = _velocity(study, row), complex(row.force[0]), float(row.couple[0])
        words = f"{named_force(row)} on the {row.body.replace('_', ' ')}"
        origin = LOADS if row.kind == WEIGHT else DYNAMICS
        if force or not couple:
            parts.append(f"F_{i}x v_{i}x + F_{i}y v_{i}y")
            for axis, of in (("x", "real"), ("y", "imag")):
                letters += [letter(f"F_{i}{axis}", f"{words}, {axis}", getattr(force, of), "n", origin),
                            letter(f"v_{i}{axis}", f"velocity where it acts, {axis}", getattr(v, of), "mm_s", LINKAGE)]  # fmt: skip
        if couple:
            parts.append(f"M_{i} ω_{i}")
            letters += [letter(f"M_{i}", f"{words}, couple", couple, "nm", origin),
                        letter(f"ω_{i}", "angular velocity there", turn, "rad_s", LINKAGE)]  # fmt: skip
    if not parts:
        parts, letters = ["P_0"], [letter("P_0", "nothing acts here", 0.0, "w", LOADS)]
    return Working((f"P = {' + '.join(parts)}",), tuple(letters))


def _of_friction(study: Study, pair: str) -> Working:
    if pair == CAM_FACE:
        return _work_rate(study, _acting(study, lambda row: row.kind == FRICTION and "cam" in (row.body, row.by)))
    return _work_rate(study, _acting(study, lambda row: row.kind == FRICTION and row.name == pair))


def _of_element(study: Study, name: str) -> Working:
    element = study.loading.named[name]
    return _work_rate(study, list(acting_of(element, study.linkage, study.omega)))


def _of_drive(study: Study, _: str) -> Working:
    if "cam" in study.stages:
        return Working(("P = T ω",), (other(study, "drive_torque", "T"), *known(study, "ω")))
    linkage, omega = study.linkage, study.omega
    driver = first(linkage.slip(linkage.driver_name)) * linkage.sense * first(linkage.motion.displacement[1]) * omega
    if linkage.driver_pair.kind == REVOLUTE:
        parts = ["T ω_d"]
        letters = [other(study, "driver_torque", "T"),
                   letter("ω_d", "angular velocity of the driver", driver, "rad_s", LINKAGE)]  # fmt: skip
    else:
        parts = ["F_d v_d"]
        letters = [
            other(study, "driver_force", "F_d"),
            letter("v_d", "velocity of the driver", driver, "mm_s", LINKAGE),
        ]
    for i, dyad in enumerate((each for each in linkage.dyads if each.by_motion), 1):
        body, on = (linkage.bodies[name].turn[1] for name in (dyad.bodies[0], dyad.on))
        link = link_number(dyad.bodies[0])
        parts.append(f"T_{i} ω_{i}")
        letters += [other(study, f"link{link}_input_torque", f"T_{i}"),
                    letter(f"ω_{i}", f"angular velocity of link {link} against what carries its motor",
                           first(np.atleast_1d(body - on)) * omega, "rad_s", LINKAGE)]  # fmt: skip
    return Working((f"P = {' + '.join(parts)}",), tuple(letters))


ROWS: Mapping[str, Maker] = MappingProxyType(
    {
        "link.{}": _link_angle,
        "link.{}_velocity": lambda s, n: _derived(s, "θ", f"link{n}", 1, ""),
        "link.{}_acceleration": lambda s, n: _derived(s, "θ", f"link{n}", 2, ""),
        "driver_angle": _driver_angle,
        "slide.{}": _slide,
        "slide.{}_velocity": lambda s, n: _derived(s, "s", f"slide{n}", 1, "mm"),
        "slide.{}_acceleration": lambda s, n: _derived(s, "s", f"slide{n}", 2, "mm"),
        "point.{}_x": partial(_point, axis="x"),
        "point.{}_y": partial(_point, axis="y"),
        "point.{}_vx": partial(_point_rate, axis="x", order=1),
        "point.{}_vy": partial(_point_rate, axis="y", order=1),
        "point.{}_ax": partial(_point_rate, axis="x", order=2),
        "point.{}_ay": partial(_point_rate, axis="y", order=2),
        "point.{}_speed": _point_speed,
        "transmission.{}": _transmission,
        "kinetic_energy": _energy,
        "kinetic_energy.{}": _energy,
        "power.load": lambda s, _: _of_element(s, "load"),
        "power.drive": _of_drive,
        "power.gravity": lambda s, _: _work_rate(s, _acting(s, lambda row: row.kind == WEIGHT)),
        "power.friction_{}": _of_friction,
        "power.{}": _of_element,
    }
)  # fmt: skip
"""Quantity, or row of the members of a linkage -> how it is worked out."""

__all__ = ["ROWS"]
