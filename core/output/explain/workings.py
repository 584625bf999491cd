"""How each quantity is worked out at one angle: its equation in letters that have a value there. One row a quantity, by room."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from core.cam import SECOND
from core.dynamics import CAM_FACE
from core.dynamics.free_body import FRICTION, WEIGHT, ForceOnBody, acting_of
from core.mechanism import link_number
from core.mechanism.kinematics import REVOLUTE, SLIDING
from core.numerics.derivatives import cross
from core.output.explain import force_workings, shaft_workings
from core.output.explain.force_workings import named_force
from core.output.explain.letters import (
    CAM,
    DYNAMICS,
    LINKAGE,
    LOADS,
    MOTION,
    Letter,
    Maker,
    Working,
    by,
    either,
    first,
    known,
    letter,
    motion_unit,
    other,
    pin,
)
from core.study import Study, quantities_of, quantity
from core.study.member_quantities import line_of_centres

# -- how the cam's shape and its instant centre are worked out at one angle -------------------------------------


def _turned_back(axis: str, x: str, y: str) -> str:
    """A coordinate of a point of the global frame in the cam's own."""
    return f"({x}) cos(d θ) + ({y}) sin(d θ)" if axis == "x" else f"({y}) cos(d θ) - ({x}) sin(d θ)"


def _place(study: Study, _: str, symbol: str, axis: str, offset: str, letters: str, second: bool = False) -> Working:
    index = "2" if second else ""
    beside = f" + {offset} n_{index}" if offset else ""
    parts = (f"R_{index}{part}{beside}{part if offset else ''}" for part in "xy")
    line = _turned_back(axis, *parts)
    used = known(study, f"{'R_2x R_2y' if second else 'R_x R_y'} {letters} d θ".strip())
    normals: tuple[Letter, ...] = ()
    if offset:
        flank = study.cam.only(SECOND).flank if second else study.cam.flank
        t = complex(np.atleast_1d(flank.relative_velocity)[0])
        n = -1j * study.sense * t / abs(t)
        mark = "n_2" if second else "n_"
        normals = tuple(
            letter(f"{mark}{part}", f"unit normal of the pitch curve, {part}", value, "", CAM)
            for part, value in (("x", n.real), ("y", n.imag))
        )
    return Working((f"{symbol} = {line}",), (*used, *normals))


def _flat_place(symbol: str, axis: str) -> Maker:
    line = _turned_back(axis, "m_x h - m_y h_ν", "m_y h + m_x h_ν")
    return by(f"{symbol} = {line}", "m_x m_y h h_ν d θ")


def _pressure_angle(study: Study, _: str, second: bool = False) -> Working:
    flank = study.cam.only(SECOND).flank if second else study.cam.flank
    index = "₂" if second else ""
    way = _way(study, second)
    n = complex(np.atleast_1d(flank.normal)[0])
    rows = (("n_x", n.real, "normal of the cam, x"), ("n_y", n.imag, "normal of the cam, y"),
            ("v_x", way.real, "unit vector along the travel of the follower's point, x"),
            ("v_y", way.imag, "unit vector along the travel of the follower's point, y"))  # fmt: skip
    letters = tuple(letter(symbol, meaning, value, "", CAM) for symbol, value, meaning in rows)
    return Working((f"ψ{index} = atan2(|n_x v_y - n_y v_x|, |n_x v_x + n_y v_y|)",), letters)


def _way(study: Study, second: bool) -> complex:
    """Unit vector along which the point that touches, or the centre of the round, travels."""
    kinematics = study.linkage
    flank = study.cam.only(SECOND).flank if second else study.cam.flank
    if not flank.straight and not second:
        return complex(np.atleast_1d(kinematics.travel)[0])
    pair = kinematics.pairs[kinematics.ground]
    if pair.kind == SLIDING:
        return complex(np.atleast_1d(kinematics.line(pair))[0])
    at = flank.contact if flank.straight else flank.reference
    arm = complex(np.atleast_1d(at - kinematics.bodies[pair.body].position(pair.point))[0])
    return 1j * arm / abs(arm)


def _pitch_curvature(study: Study, _: str, second: bool = False) -> Working:
    flank = study.cam.only(SECOND).flank if second else study.cam.flank
    t = complex(np.atleast_1d(flank.relative_velocity)[0])
    bend = complex(1.0)
    speed = abs(t)
    # w from its own equation for the first roller; of the second one from what bends its pitch curve
    along = first(flank.pitch_curvature) * speed * speed
    index = "₂" if second else ""
    w = known(study, "w_x w_y") if not second else ()
    if second:
        bend = -study.sense * 1j * t / speed * along
        w = tuple(
            letter(f"w_{part}", f"R₂″ - 2 i d R₂′ - R₂ across t, {part}", value, "mm", LINKAGE)
            for part, value in (("x", bend.real), ("y", bend.imag))
        )
    parts = tuple(
        letter(f"t_{part}", f"velocity of the roller's centre against the cam, by cam angle, {part}", value, "mm", CAM)
        for part, value in (("x", t.real), ("y", t.imag))
    )
    symbol = "κ_p2" if index else "κ_p"
    return Working((f"{symbol} = -d (t_x w_y - t_y w_x)/(t_x² + t_y²)^(3/2)",), (*known(study, "d"), *parts, *w))


def _beside(study: Study, _: str, line: str, of: str, letters: str) -> Working:
    """The curvature of the curve beside another one."""
    return Working((line,), (other(study, of, "κ_p2" if "κ_p2" in line else "κ_p"), *known(study, letters)))


def _from(line: str, **others: str) -> Maker:
    """An equation in other quantities: letter -> name of the quantity."""
    return lambda study, _: Working((line,), tuple(other(study, name, symbol) for symbol, name in others.items()))


def _polar(study: Study, _: str) -> Working:
    x, y = (other(study, name, symbol) for name, symbol in (("profile_x", "x"), ("profile_y", "y")))
    whole = 1.0 if y.value < 0.0 else 0.0
    turns = letter("k", "1 where that is negative", whole, "", CAM)
    return Working(("ϑ = atan2(y, x) + 2 π k",), (y, x, turns))


def _on_face(study: Study, _: str) -> Working:
    return Working(("x_f = h_ν - (m_x R_y - m_y R_x)",), known(study, "h_ν m_x m_y R_x R_y"))


def _centre_distance(study: Study, _: str) -> Working:
    along = complex(line_of_centres(study)[0])
    rows = known(study, "R_x R_y R′_x R′_y φ′ d")
    unit = tuple(
        letter(f"e_{part}", f"direction in which Q is counted, {part}", value, "", LINKAGE)
        for part, value in (("x", along.real), ("y", along.imag))
    )
    return Working(("Q = (e_x (R′_y - φ′ R_x) - e_y (R′_x + φ′ R_y))/(d - φ′)",), (*rows, *unit))


def _centre_velocity(study: Study, _: str) -> Working:
    if "instant_centre" in quantities_of(study, "cam"):
        return Working(("V_Q = ω Q",), known(study, "ω Q"))
    q = complex(np.atleast_1d(study.cam.flank.centre.finite)[0])
    return Working(
        ("V_Q = ω Q",), (*known(study, "ω"), letter("Q", "distance of Q from the cam centre", abs(q), "mm", CAM))
    )


def _reference_velocity(study: Study, _: str) -> Working:
    slope = first(quantity("reference_velocity").value(study)) / study.omega
    there = complex(np.atleast_1d(study.linkage.follower.origin[1])[0])
    sign = letter("σ", "+1 where it goes as Q does", np.sign(slope) if slope else 1.0, "", LINKAGE)
    parts = tuple(
        letter(f"R′_{part}", f"velocity of the roller's centre by cam angle, {part}", value, "mm", LINKAGE)
        for part, value in (("x", there.real), ("y", there.imag))
    )
    return Working(("V_R = σ ω √(R′_x² + R′_y²)",), (sign, *known(study, "ω"), *parts))


CAM_ROWS: Mapping[str, Maker] = MappingProxyType(
    {
        "profile_x": either(_flat_place("x", "x"), partial(_place, symbol="x", axis="x", offset="R_r", letters="R_r")),
        "profile_y": either(_flat_place("y", "y"), partial(_place, symbol="y", axis="y", offset="R_r", letters="R_r")),
        "pitch_x": partial(_place, symbol="x_p", axis="x", offset="", letters=""),
        "pitch_y": partial(_place, symbol="y_p", axis="y", offset="", letters=""),
        "outer_x": partial(_place, symbol="x_o", axis="x", offset="(-R_r - s_p)", letters="R_r s_p"),
        "outer_y": partial(_place, symbol="y_o", axis="y", offset="(-R_r - s_p)", letters="R_r s_p"),
        "second_x": partial(_place, symbol="x₂", axis="x", offset="(R_r2 + s_p)", letters="R_r2 s_p", second=True),
        "second_y": partial(_place, symbol="y₂", axis="y", offset="(R_r2 + s_p)", letters="R_r2 s_p", second=True),
        "second_pitch_x": partial(_place, symbol="x_p2", axis="x", offset="", letters="", second=True),
        "second_pitch_y": partial(_place, symbol="y_p2", axis="y", offset="", letters="", second=True),
        "pressure_angle": _pressure_angle,
        "second_pressure_angle": partial(_pressure_angle, second=True),
        "pitch_curvature": _pitch_curvature,
        "second_pitch_curvature": partial(_pitch_curvature, second=True),
        "profile_curvature": either(by("κ = 1/ρ", "ρ"),
                                    partial(_beside, line="κ = κ_p/(1 - R_r κ_p)", of="pitch_curvature", letters="R_r")),
        "outer_curvature": partial(_beside, line="κ_o = κ_p/(1 + (R_r + s_p) κ_p)", of="pitch_curvature", letters="R_r s_p"),
        "second_profile_curvature": partial(_beside, line="κ₂ = κ_p2/(1 - (R_r2 + s_p) κ_p2)",
                                           of="second_pitch_curvature", letters="R_r2 s_p"),
        "radius": _from("r = √(x² + y²)", x="profile_x", y="profile_y"),
        "polar_angle": _polar,
        "contact_on_face": _on_face,
        "instant_centre": _centre_distance,
        "instant_centre_x": by("Q_x = (R′_y - φ′ R_x)/(d - φ′)", "R_x R′_y φ′ d"),
        "instant_centre_y": by("Q_y = -(R′_x + φ′ R_y)/(d - φ′)", "R_y R′_x φ′ d"),
        "instant_centre_velocity": _centre_velocity,
        "reference_velocity": _reference_velocity,
    }
)  # fmt: skip
"""Quantity, or row of the members of a linkage -> how it is worked out."""


# -- how angles, places, powers of a linkage's members are worked out at one angle ------------------------------


def _link_angle(study: Study, number: str) -> Working:
    pose = study.linkage.bodies[f"link{number}"]
    places = list(dict.fromkeys(pose.points.values()))
    turn = first(np.broadcast_to(pose.turn[0], 1))
    if len(places) < 2:
        return Working(("θ = θ_s",), (letter("θ_s", "angle of what it slides on, with its own", turn, "deg", LINKAGE),))
    a, b = [name for name, at in pose.points.items() if at in places[:2]][:2]
    one, other = (complex(np.atleast_1d(pose.position(name))[0]) for name in (a, b))
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
    at = complex(np.atleast_1d(pose.position(point, order))[0])
    mark = {1: "′", 2: "″"}[order]
    value = letter(
        f"{axis}{mark}", "derivative by the angle of cam or crank", at.real if axis == "x" else at.imag, "mm", LINKAGE
    )
    dot_ = {1: "\u0307", 2: "\u0308"}[order]
    return Working((f"{axis}{dot_} = {'ω' if order == 1 else 'ω²'} {axis}{mark}",), (*known(study, "ω"), value))


def _point_speed(study: Study, point: str) -> Working:
    pose = study.linkage.bodies[study.linkage.body_of(point)]
    speed = complex(np.atleast_1d(pose.position(point, 1))[0]) * study.omega
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
            speed = abs(complex(np.atleast_1d(pose.fixed_point(part.centre)[1])[0])) * study.omega
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
    driver = (
        first(linkage.slip(linkage.driver_name)) * linkage.driver_sign * first(linkage.motion.displacement[1]) * omega
    )
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


LINK_ROWS: Mapping[str, Maker] = MappingProxyType(
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


# -- how displacement, its rates and the triangle of a cam-driven slider are worked out at one angle ------------


def _segment(study: Study) -> tuple[int, float, float]:
    """Number of the segment at the angle, displacement at its start and rise [m or rad]."""
    typed = study.program.motion
    at, start, theta = 0.0, typed.start * typed.scale, float(np.rad2deg(study.theta[0]))
    for number, each in enumerate(typed.segments):
        rise = each.rise * typed.scale
        if theta < at + each.span_deg - 1e-9 or number == len(typed.segments) - 1:
            return number, start, rise
        at, start = at + each.span_deg, start + rise
    raise AssertionError("a motion has segments")


def _displacement(study: Study, _: str) -> Working:
    number, start, rise = _segment(study)
    unit, path = motion_unit(study), f"motion.segments[{number}]"
    y = first(study.motion.displacement[0])
    law = study.program.motion.segments[number].curve.law
    begin = letter("y_0", "displacement at the start of the segment", start, unit, MOTION)
    if not rise:
        return Working(("y = y_0 + Δ",), (begin, letter("Δ", f"what the law {law} adds", y - start, unit, path)))
    share = letter("s", f"share of the rise by the law {law}", (y - start) / rise, "", f"{path}.law")
    return Working(
        ("y = y_0 + h s",), (begin, letter("h", "rise of the segment", rise, unit, f"{path}.rise_{unit}"), share)
    )


def _modulo(study: Study, _: str) -> Working:
    motion, unit = study.program.motion, motion_unit(study)
    here = first(study.motion.displacement[0])
    y = letter("y", "position", here, unit, MOTION)
    advance = abs(motion.gain) * motion.scale
    if not advance:
        return Working(("m = y",), (y,))
    turns = letter("k", "whole advances in it", float(np.floor(here / advance)), "", MOTION)
    return Working(
        ("m = y - k a",), (y, turns, letter("a", "advance of a turn", advance, unit, f"motion.advance_{unit}"))
    )


def _rate(study: Study, _: str, line: str, order: int) -> Working:
    """ω to the order times the derivative by cam angle."""
    number = _segment(study)[0]
    mark = "′″‴"[order - 1]
    unit = motion_unit(study)
    name = f"derivative of the motion by cam angle, {mark}"
    slope = letter(f"y{mark}", name, first(study.motion.displacement[order]), unit, f"motion.segments[{number}]")
    return Working((line,), (*known(study, "ω"), slope))


def _triangle(study: Study, _: str, of: str) -> Working:
    """An angle of the triangle of pivot, arm pin and slider pin, by the cosine rule; as all angles of it in the frame of the guide."""
    pivot, joint, end = (pin(*each)(study) for each in (("arm", "pivot"), ("arm", "arm_pin"), ("slider", "slider_pin")))
    toward = end - pivot
    side = np.sign(cross(np.array([toward]), np.array([joint - pivot]))[0])
    sign, mine, opposite = (side, "₁", "₂") if of == "phi" else (-side, "₂", "₁")
    symbol = "φ" if of == "phi" else "β"
    return Working(
        (f"{symbol} = atan2(H, L) + σ arccos((r² + L{mine}² - L{opposite}²)/(2 r L{mine}))",),
        (
            *known(study, "H L"),
            letter("σ", "side on which the arm pin lies, by the layout", sign, "", "follower.layout"),
            letter("r", "distance of the slider pin from the pivot", abs(toward), "mm", LINKAGE),
            *known(study, "L₁ L₂"),
        ),
    )


def _base(study: Study) -> float:
    """Slider position at motion 0."""
    return first(study.linkage.coordinates["slider_position"][0] - study.motion.displacement[0])


MOTION_ROWS: Mapping[str, Maker] = MappingProxyType(
    {
        "displacement": _displacement,
        "velocity": partial(_rate, line="ẏ = ω y′", order=1),
        "acceleration": partial(_rate, line="ÿ = ω² y″", order=2),
        "position_modulo": _modulo,
        "jerk": partial(_rate, line="y⃛ = ω³ y‴", order=3),
        "slider_position": lambda s, _: Working(
            ("L = L_0 + y",),
            (letter("L_0", "slider position at motion 0", _base(s), "mm", "follower"),
             letter("y", "motion", first(s.motion.displacement[0]), "mm", MOTION)),
        ),
        "phi": partial(_triangle, of="phi"),
        "beta": partial(_triangle, of="beta"),
        "phi_velocity": by("φ̇ = L̇ cos β/(L₁ sin(β - φ))", "L̇ β φ L₁"),
        "beta_velocity": by("β̇ = L̇ cos φ/(L₂ sin(φ - β))", "L̇ β φ L₂"),
        "phi_acceleration": by("φ̈ = (L̈ cos β + L₁ φ̇² cos(φ - β) + L₂ β̇²)/(L₁ sin(β - φ))", "L̈ β φ L₁ L₂ φ̇ β̇"),
        "beta_acceleration": by("β̈ = (L̈ cos φ + L₂ β̇² cos(φ - β) + L₁ φ̇²)/(L₂ sin(φ - β))", "L̈ β φ L₁ L₂ φ̇ β̇"),
    }
)  # fmt: skip
"""Quantity, or row of the members of a linkage -> how it is worked out."""


# -- how each quantity is worked out at one angle ---------------------------------------------------------------


WORKINGS: Mapping[str, Maker] = MappingProxyType(
    {**MOTION_ROWS, **CAM_ROWS, **force_workings.FORCE_ROWS, **LINK_ROWS, **shaft_workings.SERVO_ROWS}
)


def working_of(study: Study, shape: str, member: str) -> Working:
    """Of a quantity's row, for one member where it has any, of a study at one angle."""
    return WORKINGS[shape](study, member)
