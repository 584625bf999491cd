"""The symbols of all formulas: what each means, its unit, its value at one angle of a study, and what it comes from.

A key of ``LETTERS`` is the symbol itself; where one symbol has several meanings, a dot and the subject follow: ``h.rise``, ``h.support``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import floor
from types import MappingProxyType

import numpy as np

from core.cam import SECOND, Flank
from core.design import UNITS
from core.design.parts import LINEAR
from core.dynamics.forces import Contact
from core.mechanism.kinematics import REVOLUTE
from core.motion import TURN
from core.numerics.derivatives import cross
from core.shaft.flywheel import Flywheel, energy_range, motor_inertia
from core.shaft.servo import lever, moved_mass
from core.stress import Pairing, RollerLife, pairings, relative_curvature
from core.study.drive_forces import load_ratings, roller_lives, roller_speed, servo_load, servo_part, servo_torque
from core.study.member_quantities import (
    centre_distance,
    centre_velocity,
    closed_pad_angle,
    coordinate,
    lash,
    levers,
    line_of_centres,
    motor_quantity,
    pad_angle,
    reference_velocity,
    valve_lift,
    valve_motion,
)
from core.study.piston import clearance_parts
from core.study.spatial_symbols import SPATIAL_LETTERS
from core.study.study import Study
from core.study.symbols import (
    CAM,
    DYNAMICS,
    LINKAGE,
    MOTION,
    STABILITY,
    Formula,
    Letter,
    Point,
    SymbolSource,
    Text,
    field_symbol,
    first,
    first_complex,
    motion_unit,
    quantity_symbol,
    segment_of,
    speed_field,
    symbol_of,
    vector_symbols,
)
from core.study.valve_springs import springs_of, static_spring_force, stressed_spring, valve_spring_force

# -- values -----------------------------------------------------------------------------------------------------


def _segment_path(study: Study) -> str:
    return f"motion.segments[{segment_of(study)[0]}]"


def _by(linear: str, rotary: str) -> Callable[[Study], str]:
    """Unit of a quantity of the motion: where it slides, where it turns."""
    return lambda study: linear if motion_unit(study) == "mm" else rotary


def _real(value: Callable[[Study], float]) -> Callable[[Study, str], float]:
    """A value that no member of a linkage has a part in."""
    return lambda study, _: value(study)


def _flank(study: Study, second: bool = False) -> Flank:
    return study.cam.only(SECOND).flank if second else study.cam.flank


def _of_flank(read: Callable[[Flank], np.ndarray | complex], second: bool = False) -> Point:
    return lambda study, _: first_complex(read(_flank(study, second)))


def _nearest_point(number: int) -> Point:
    """Nearest point of the first or the second body of a pair with outlines."""

    def value(study: Study, pair: str) -> complex:
        from core.study.clearances import nearest_points_of  # few designs have outlines

        return nearest_points_of(study, pair)[number]

    return value


def _face_normal(study: Study, _: str = "") -> complex:
    """Normal m of a straight face, from the cam to the face."""
    return -first_complex(_flank(study).normal)


def _support_slope(study: Study) -> float:
    """h_ν = x_f + m × R."""
    flank = _flank(study)
    return first(flank.on_face) + first(cross(np.array([_face_normal(study)]), np.atleast_1d(flank.reference)))


def _travel(second: bool) -> Point:
    """Unit vector along which the point in contact, or the centre of the roller, travels."""

    def value(study: Study, _: str) -> complex:
        kinematics, flank = study.linkage, _flank(study, second)
        if not flank.straight and not second:
            return first_complex(kinematics.travel)
        pair = kinematics.pairs[kinematics.ground]
        if pair.kind != REVOLUTE:
            return first_complex(kinematics.line(pair))
        at = flank.contact if flank.straight else flank.reference
        arm = first_complex(at - kinematics.bodies[pair.body].position(pair.point))
        return 1j * arm / abs(arm)

    return value


def _second_curve(study: Study, _: str) -> complex:
    """Part of w₂ = R₂″ - 2 i d R₂′ - R₂ across t₂."""
    flank = _flank(study, second=True)
    t = first_complex(flank.relative_velocity)
    return -study.sense * 1j * t / abs(t) * first(flank.pitch_curvature) * abs(t) * abs(t)


def _first_curve(study: Study, _: str) -> complex:
    """Vector w = R″ - 2 i d R′ - R."""
    r, d = study.linkage.follower.origin, study.sense
    return first_complex(r[2] - 2j * d * r[1] - r[0])


def _contact(study: Study) -> Contact:
    """The flank in contact."""
    contacts = study.dynamics.contacts
    return contacts[int(np.argmax([abs(first(contact.force)) for contact in contacts]))]


def _stressed(study: Study, member: str) -> tuple[Flank, Pairing, Contact]:
    """The flank with the greatest contact pressure, of the first or the second roller, with its contact."""
    flanks = [flank for flank in study.cam.flanks if (flank.name == SECOND) == (member == "second")]
    flank = max(flanks, key=lambda flank: first(study.stress[flank.name].pressure))
    contact = study.dynamics.contacts[[each.name for each in study.cam.flanks].index(flank.name)]
    return flank, pairings(study.design.drive.face, study.design.drive.cam)[flank.name], contact


def _stress(part: str) -> Callable[[Study, str], float]:
    return lambda study, member: first(getattr(study.stress[_stressed(study, member)[0].name], part))


def _triangle_side(study: Study) -> complex:
    """From the pivot to the slider's pin."""
    bodies = study.linkage.bodies
    return first_complex(bodies["slider"].position("slider_pin")) - first_complex(bodies["arm"].position("pivot"))


def _layout_sign(study: Study) -> float:
    bodies = study.linkage.bodies
    joint = first_complex(bodies["arm"].position("arm_pin")) - first_complex(bodies["arm"].position("pivot"))
    return float(np.sign(cross(np.array([_triangle_side(study)]), np.array([joint]))[0]))


def _ground_line(study: Study, _: str) -> complex:
    """Unit vector along the follower's guide."""
    return first_complex(study.linkage.line(study.linkage.pairs[study.loading.guide]))


def _ground_pivot(study: Study, _: str) -> complex:
    pair = study.linkage.pairs[study.linkage.ground]
    return first_complex(study.linkage.bodies[pair.body].position(pair.point))


def _centre_sign(study: Study) -> float:
    slope = first(reference_velocity(study)) / study.omega
    return float(np.sign(slope)) if slope else 1.0


def _point(order: int) -> Point:
    """Position of a point of a link, or its derivative by the angle of cam or crank [m]."""
    return lambda study, point: first_complex(study.linkage.bodies[study.linkage.body_of(point)].position(point, order))


def _in_link(study: Study, point: str) -> complex:
    return complex(study.linkage.bodies[study.linkage.body_of(point)].points[point])


def _link_origin(study: Study, point: str) -> complex:
    return first_complex(study.linkage.bodies[study.linkage.body_of(point)].origin[0])


def _link_turn(study: Study, point: str) -> float:
    return first(np.broadcast_to(study.linkage.bodies[study.linkage.body_of(point)].turn[0], 1))


def _coordinate(name: str, order: int) -> Callable[[Study, str], float]:
    return lambda study, number: first(study.linkage.coordinates[f"{name}{number}"][order])


def _driver_cycle(study: Study) -> tuple[float, float, float]:
    """Driver angle at which a part of the cycle begins, rate of the driver, and the cycle's angle there [rad]."""
    rate, swing = first(study.drive.displacement[1]), study.driver_ranges.ranges[0]
    if not study.swings:
        return 0.0, rate, 0.0
    return (swing.high, rate, np.pi) if rate < 0.0 else (swing.low, rate, 0.0)


def _pair_force(study: Study, pair: str) -> complex:
    return first_complex(study.dynamics.pairs[pair])


def _shortest_life(study: Study) -> RollerLife:
    return min(roller_lives(study), key=lambda life: life.hours)


def _advance(study: Study) -> float:
    motion = study.program.motion
    return abs(motion.gain) * motion.scale


def _advances(study: Study) -> float:
    """Number of whole advances in the displacement."""
    return float(floor(first(study.motion.displacement[0]) / _advance(study))) if _advance(study) else 0.0


def _displacement_at(study: Study, theta: np.ndarray) -> float:
    return first(study.at_theta(theta % TURN).motion.displacement[0])


def _turn(value: Callable[[Study], float], meaning: str, unit: str = "", origin: Text = DYNAMICS) -> SymbolSource:
    """A symbol of the whole turn of a shaft."""
    return SymbolSource(meaning, unit, _real(value), origin)


def _machine(name: str) -> Callable[[Study, str], float]:
    def value(study: Study, _: str) -> float:
        assert study.stability is not None
        return float(getattr(study.stability.machine, name))

    return value


# -- symbols of motion, linkage and cam ---------------------------------------------------------------------------

_MOTION: Mapping[str, SymbolSource] = {
    "ω": SymbolSource("angular velocity of the shaft or crank", "rad_s", lambda s, _: s.omega, speed_field),
    "d": SymbolSource("sense of rotation: +1 counter-clockwise, -1 clockwise", "", lambda s, _: s.sense, "shaft.rotation"),
    "θ": SymbolSource("cam angle", "deg", lambda s, _: first(s.theta), "--at"),
    "y": SymbolSource("displacement", motion_unit, lambda s, _: first(s.motion.displacement[0]), MOTION),
    "y′": SymbolSource("first derivative of the motion by cam angle", motion_unit,
                       lambda s, _: first(s.motion.displacement[1]), _segment_path),
    "y″": SymbolSource("second derivative of the motion by cam angle", motion_unit,
                       lambda s, _: first(s.motion.displacement[2]), _segment_path),
    "y‴": SymbolSource("third derivative of the motion by cam angle", motion_unit,
                       lambda s, _: first(s.motion.displacement[3]), _segment_path),
    "ẏ": SymbolSource("velocity of the motion", _by("mm_s", "rad_s"),
                      lambda s, _: first(s.motion.displacement[1]) * s.omega, MOTION),
    "ÿ": SymbolSource("acceleration of the motion", _by("mm_s2", "rad_s2"),
                      lambda s, _: first(s.motion.displacement[2] * s.omega**2), MOTION),
    **{"y⃛": SymbolSource("jerk of the motion"), "y_0": SymbolSource("displacement at the start of the segment")},
    **{"h.rise": SymbolSource("rise of the segment"), "s.law": SymbolSource("motion law"),
       "u.law": SymbolSource("fraction of the segment's span"), "θ_0": SymbolSource("cam angle at the start of the segment"),
       "β.span": SymbolSource("span of the segment")},
    "m.modulo": SymbolSource("position modulo the advance"),
    "k.advance": SymbolSource("whole advances in it", "", _real(_advances), MOTION),
    "a.advance": SymbolSource("advance of a turn", motion_unit, _real(_advance), lambda s: f"motion.advance_{motion_unit(s)}"),
    "L": quantity_symbol("slider position", "slider_position_mm", lambda s: coordinate(s, "slider_position"), LINKAGE),
    "L_0": SymbolSource("slider position at motion 0", "mm",
                        lambda s, _: first(s.linkage.coordinates["slider_position"][0] - s.motion.displacement[0]), "follower"),
    "φ": quantity_symbol("arm angle", "phi_deg", lambda s: coordinate(s, "phi"), LINKAGE),
    "β": quantity_symbol("rod angle", "beta_deg", lambda s: coordinate(s, "beta"), LINKAGE),
    "φ̇": quantity_symbol("arm velocity", "phi_rad_s", lambda s: coordinate(s, "phi", 1), LINKAGE),
    "β̇": quantity_symbol("rod velocity", "beta_rad_s", lambda s: coordinate(s, "beta", 1), LINKAGE),
    "φ̈": SymbolSource("arm acceleration"),
    "β̈": SymbolSource("rod acceleration"),
    "L̇": quantity_symbol("velocity of the slider", "velocity_mm_s", lambda s: s.motion.displacement[1] * s.omega, MOTION),
    "L̈": quantity_symbol("acceleration of the slider", "acceleration_mm_s2", lambda s: s.motion.displacement[2] * s.omega**2, MOTION),
    "L₁": field_symbol("follower.slider_arm_mm", "slider arm", "mm"),
    "L₂": field_symbol("follower.rod_mm", "rod", "mm"),
    "H": field_symbol("follower.guide_height_mm", "height of the guide over the pivot", "mm"),
    "σ": SymbolSource("side on which the arm pin lies, by the layout", "", _real(_layout_sign), "follower.layout"),
    "r.triangle": SymbolSource("distance of the slider pin from the pivot", "mm", lambda s, _: abs(_triangle_side(s)), LINKAGE),
    **{"K.triangle": SymbolSource("four times the triangle's area"), "A.side": SymbolSource("longest of the sides r, L₁, L₂"),
       "B.side": SymbolSource("middle side"), "C.side": SymbolSource("shortest side")},
    **{"P": SymbolSource("pivot"), "Z_l": SymbolSource("roller arm"), "α": SymbolSource("angle of the roller arm"),
       "α′": SymbolSource("derivative of α by cam angle"), "e.guide": SymbolSource("direction of the guide"),
       "S": SymbolSource("position along the guide"), "ε": SymbolSource("offset"), "R_b": SymbolSource("base radius")},
}  # fmt: skip
_TRAIN: Mapping[str, SymbolSource] = {
    "y_v": SymbolSource("lift of the valve"),
    "ẏ_v": SymbolSource("velocity of the valve"),
    "ÿ_v": SymbolSource("acceleration of the valve"),
    "y_o": SymbolSource("motion of the valve, the lash not taken off", "mm", lambda s, _: first(valve_motion(s)[0]), LINKAGE),
    "λ.lash": SymbolSource("lash", "mm", lambda s, _: lash(s.design), "valve.lash_mm"),
    "y′_v": SymbolSource("derivative of the valve's lift by cam angle", "mm", lambda s, _: first(valve_lift(s, 1)) / s.omega, LINKAGE),
    "y″_v": SymbolSource("second derivative of the valve's lift by cam angle", "mm",
                         lambda s, _: first(valve_lift(s, 2)) / s.omega**2, LINKAGE),
    "c.piston": SymbolSource("clearance of valve and piston"),
    "c_0.piston": field_symbol("valve.clearance_mm", "clearance of the closed valve at TDC", "mm"),
    "x_p": SymbolSource("travel of the piston in the direction of the clearance", "mm",
                        lambda s, _: first(clearance_parts(s)[0]), "engine.stroke_mm"),
    "y_p": SymbolSource("lift of the valve in the direction of the clearance", "mm", lambda s, _: first(clearance_parts(s)[1]), LINKAGE),
    "x.piston": SymbolSource("travel of the piston from its highest position"), "R.throw": SymbolSource("throw of the crank"),
    "l.rod": SymbolSource("connecting rod"), "e.pin": SymbolSource("pin offset"),
    "θ.throw": SymbolSource("angle of the throw from the cylinder's axis"),
    "F_s": SymbolSource("force of the valve springs"),
    "F_0.valve": SymbolSource("force of the closed valve", "n", _real(lambda s: sum(each.preload for each in springs_of(s.design))),
                              "loads.valve_springs"),
    "k.valve": SymbolSource("rate of the valve springs", "n_per_mm", _real(lambda s: sum(each.rate for each in springs_of(s.design))),
                            "loads.valve_springs"),
    "y_v.spring": SymbolSource("lift of the valve", "mm", lambda s, _: first(valve_lift(s)), LINKAGE, "valve_lift_mm"),
    "F_w": SymbolSource("force of the wave in the springs", "n",
                        lambda s, _: first(valve_spring_force(s)) - first(static_spring_force(s)), DYNAMICS),
    "τ_s": SymbolSource("shear stress of the most stressed valve spring"),
    "K.coil": SymbolSource("factor of the coil's curvature", "", _real(lambda s: stressed_spring(s).curvature_factor),
                           "loads.valve_springs"),
    "F.spring": SymbolSource("static force of this spring", "n", lambda s, _: stressed_spring(s).force(first(valve_lift(s))), DYNAMICS),
    "D.coil": SymbolSource("mean diameter of the coil", "mm", _real(lambda s: stressed_spring(s).coil), "loads.valve_springs"),
    "d.wire": SymbolSource("diameter of the wire", "mm", _real(lambda s: stressed_spring(s).wire), "loads.valve_springs"),
    "C.coil": SymbolSource("coil over wire"),
    "c_n": SymbolSource("harmonic of the lift"), "z_n": SymbolSource("phase of the wave over the spring"),
    "ω_1": SymbolSource("first natural frequency of the spring"), "ζ.surge": SymbolSource("damping ratio of the first mode"),
    "n.harmonic": SymbolSource("number of the harmonic"),
    "i.ratio": SymbolSource("rocker ratio"),
    "h.pad": SymbolSource("lever of the pad across the valve", "mm", lambda s, _: first(levers(s)[0]), LINKAGE),
    "l.arm": SymbolSource("arm of the rocker; under a pushrod, motion of the tappet by the rocker's angle", "mm",
                          lambda s, _: first(levers(s)[1]), LINKAGE),
    "x_t": SymbolSource("place of the pad on the tip of the valve"),
    "p.pad": field_symbol("follower.pad_mm", "arm of the pad", "mm"),
    "β.pad": SymbolSource("angle of the pad's arm from the direction of the valve", "deg", lambda s, _: first(pad_angle(s)), LINKAGE),
    "β_0.pad": SymbolSource("the same angle with the valve closed", "deg", lambda s, _: closed_pad_angle(s), LINKAGE),
}  # fmt: skip
_CAM: Mapping[str, SymbolSource] = {
    "R_r": SymbolSource("radius of roller, shoe or edge", "mm", lambda s, _: s.cam.flank.radius, "cam.roller_radius_mm"),
    "R_r2": SymbolSource("radius of the second roller", "mm", lambda s, _: _flank(s, second=True).radius, "cam.second.roller_radius_mm"),
    "s_p": SymbolSource("play", "mm", lambda s, _: 1e-3 * float(getattr(s.design.drive.cam.form, "play_mm", 0.0)), "cam.form"),
    **vector_symbols("R", "centre of the roller, or the face's reference point", "mm", _of_flank(lambda f: f.reference)),
    **vector_symbols("R_2", "centre of the second roller", "mm", _of_flank(lambda f: f.reference, second=True)),
    **vector_symbols("R′", "velocity of the reference point, by cam angle", "mm",
              lambda s, _: first_complex(s.linkage.follower.origin[1]), LINKAGE),
    "R″": SymbolSource("acceleration of the reference point, by cam angle"),
    **vector_symbols("t", "velocity of the roller's centre against the cam, by cam angle", "mm", _of_flank(lambda f: f.relative_velocity)),
    **vector_symbols("t_2", "velocity of the second roller's centre against the cam, by cam angle", "mm",
              _of_flank(lambda f: f.relative_velocity, second=True)),
    **vector_symbols("w", "R″ - 2 i d R′ - R, by cam angle", "mm", _first_curve),
    **vector_symbols("w_2", "R₂″ - 2 i d R₂′ - R₂ across t₂", "mm", _second_curve, LINKAGE),
    **vector_symbols("n", "unit normal of the pitch curve, into the cam", "", _of_flank(lambda f: f.normal)),
    **vector_symbols("n_2", "unit normal of the second pitch curve, into the cam", "", _of_flank(lambda f: f.normal, second=True)),
    **vector_symbols("v", "unit vector along the travel of the follower's point", "", _travel(second=False)),
    **vector_symbols("v_2", "unit vector along the travel of the second roller's centre", "", _travel(second=True)),
    **vector_symbols("m", "unit normal of the face, away from the cam", "", _face_normal),
    "h.support": SymbolSource("distance of the face from the cam centre", "mm", lambda s, _: first(s.cam.flank.support), CAM),
    "h_ν": SymbolSource("derivative of h by the angle of the normal", "mm", _real(_support_slope), CAM),
    "h_νν": SymbolSource("second derivative of h by the angle of the normal"),
    "ρ": SymbolSource("radius of curvature, h + h_νν", "mm", lambda s, _: first(s.cam.flank.profile_radius), CAM),
    "c": SymbolSource("point of the pitch curve, in the frame of the cam"),
    "p.profile": SymbolSource("point of the profile, in the frame of the cam"),
    "p_o": SymbolSource("point of the outer flank, in the frame of the cam"),
    "p_2": SymbolSource("point of the second profile, in the frame of its cam"),
    "c_2": SymbolSource("point of the second pitch curve, in the frame of its cam"),
    "x.profile": quantity_symbol("profile x", "x_mm", lambda s: s.cam.flank.profile.real, CAM),
    "y.profile": quantity_symbol("profile y", "y_mm", lambda s: s.cam.flank.profile.imag, CAM),
    "r": SymbolSource("radius of the profile"),
    "ϑ": SymbolSource("polar angle"),
    "k.turn": SymbolSource("1 where atan2 is negative, else 0", "", lambda s, _: float(first(s.cam.flank.profile.imag) < 0.0), CAM),
    "ψ": SymbolSource("pressure angle"),
    "ψ₂": SymbolSource("pressure angle of the second roller"),
    "κ_p": quantity_symbol("pitch curvature", "pitch_curvature_per_mm", lambda s: s.cam.flank.pitch_curvature, CAM),
    "κ_p2": quantity_symbol("second pitch curvature", "second_pitch_curvature_per_mm",
                             lambda s: _flank(s, second=True).pitch_curvature, CAM),
    "κ": SymbolSource("curvature of the profile"),
    "κ_o": SymbolSource("curvature of the outer flank"),
    "κ₂": SymbolSource("curvature of the second profile"),
    "x_f": SymbolSource("contact on the face, from the reference point"),
    "φ′": SymbolSource("turning of the follower, by cam angle", "",
                       lambda s, _: first(np.broadcast_to(s.linkage.follower.turn[1], 1)), LINKAGE),
    "Q": quantity_symbol("instant centre Q", "instant_centre_mm", centre_distance, CAM),
    "q.centre": SymbolSource("instant centre of cam and follower"),
    **vector_symbols("e.centres", "direction in which Q is counted", "", lambda s, _: first_complex(line_of_centres(s)), LINKAGE),
    "V_Q": SymbolSource("velocity of Q"),
    "Q.velocity": SymbolSource("distance of the instant centre from the cam centre", "mm",
                               lambda s, _: first(centre_velocity(s)) / s.omega, CAM, "instant_centre_mm"),
    "V_R": SymbolSource("velocity of the roller's centre"),
    "σ.centre": SymbolSource("+1 where V_R has the direction of V_Q, else -1", "", _real(_centre_sign), LINKAGE),
}  # fmt: skip
_LINKS: Mapping[str, SymbolSource] = {
    "r_k": SymbolSource("sides of the loop"),
    "θ_k": SymbolSource("angles of the sides"),
    "θ̇": SymbolSource("angular velocity of the link"),
    "θ̈": SymbolSource("angular acceleration of the link"),
    "θ′": SymbolSource("derivative by the angle of cam or crank", "", _coordinate("link", 1), LINKAGE),
    "θ″": SymbolSource("derivative by the angle of cam or crank", "", _coordinate("link", 2), LINKAGE),
    "s_0": SymbolSource("position along its line, from the loops", "mm", _coordinate("slide", 0), LINKAGE),
    "ṡ": SymbolSource("velocity along the line"),
    "s̈": SymbolSource("acceleration along the line"),
    "s′": SymbolSource("derivative by the angle of cam or crank", "mm", _coordinate("slide", 1), LINKAGE),
    "s″": SymbolSource("derivative by the angle of cam or crank", "mm", _coordinate("slide", 2), LINKAGE),
    "φ.driver": SymbolSource("driver angle"),
    "φ_0": SymbolSource("driver angle at the start of this part of the cycle", "deg", lambda s, _: _driver_cycle(s)[0], LINKAGE),
    "r.cycle": SymbolSource("turning of the driver by the angle of the cycle", "", lambda s, _: _driver_cycle(s)[1], LINKAGE),
    "θ.cycle": SymbolSource("angle of the cycle", "deg", lambda s, _: first(s.theta), "--at"),
    "θ_0.cycle": SymbolSource("angle of the cycle at the start of this part", "deg", lambda s, _: _driver_cycle(s)[2], LINKAGE),
    "r_P": SymbolSource("position of the point"),
    "r_A": SymbolSource("position of another point A of its link"),
    "V_P": SymbolSource("velocity of the point"),
    "V_A": SymbolSource("velocity of A"),
    "V_PA": SymbolSource("velocity of the point relative to A"),
    "a_P": SymbolSource("acceleration of the point"),
    "a_A": SymbolSource("acceleration of A"),
    "ω_k": SymbolSource("angular velocity of the link"),
    "α_k": SymbolSource("angular acceleration of the link"),
    **vector_symbols("o", "origin of its link", "mm", _link_origin, LINKAGE),
    "a.point": SymbolSource("x of the point in the frame of its link", "mm", lambda s, p: _in_link(s, p).real, "linkage.links"),
    "b.point": SymbolSource("y of the point in the frame of its link", "mm", lambda s, p: _in_link(s, p).imag, "linkage.links"),
    "θ.link": SymbolSource("angle of its link", "deg", _link_turn, LINKAGE),
    "x′": SymbolSource("derivative by the angle of cam or crank", "mm", lambda s, p: _point(1)(s, p).real, LINKAGE),
    "y′.point": SymbolSource("derivative by the angle of cam or crank", "mm", lambda s, p: _point(1)(s, p).imag, LINKAGE),
    "x″": SymbolSource("derivative by the angle of cam or crank", "mm", lambda s, p: _point(2)(s, p).real, LINKAGE),
    "y″.point": SymbolSource("derivative by the angle of cam or crank", "mm", lambda s, p: _point(2)(s, p).imag, LINKAGE),
    "V.point": SymbolSource("speed of the point"),
    "ẋ": SymbolSource("velocity, x", "mm_s", lambda s, p: _point(1)(s, p).real * s.omega, LINKAGE),
    "ẏ.point": SymbolSource("velocity, y", "mm_s", lambda s, p: _point(1)(s, p).imag * s.omega, LINKAGE),
    "μ.transmission": SymbolSource("transmission angle"),
    "c₁": SymbolSource("first link, from the joint"),
    "c₂": SymbolSource("second link, from the joint"),
    "s.sine": SymbolSource("|c₁ × c₂|/(|c₁||c₂|) of the two links there", "", lambda s, j: first(s.linkage.singular[j]), LINKAGE),
    "c.cosine": SymbolSource("|c₁ · c₂|/(|c₁||c₂|)", "", lambda s, j: first(np.cos(s.linkage.transmission[j])), LINKAGE),
    "d.clearance": SymbolSource("clearance"),
    "p.outline": SymbolSource("point of the first outline"),
    "q.outline": SymbolSource("point of the second outline"),
    **vector_symbols("p", "nearest point of the first body", "mm", _nearest_point(0), LINKAGE),
    **vector_symbols("q", "nearest point of the second body", "mm", _nearest_point(1), LINKAGE),
}  # fmt: skip

# -- symbols of forces, shaft and stability -------------------------------------------------------------------------

_BODIES: Mapping[str, SymbolSource] = {
    key: SymbolSource(meaning) for key, meaning in {
        "Q.power": "force or torque on the driver, by virtual power",
        "l": "lever: force or torque on the driver by one newton of contact force", "l_2": "lever of the second roller",
        "F.body": "force on a body", "M.body": "couple on a body", "r.body": "point where the force acts",
        "α.body": "angle of the body", "q.driver": "position of the driver", "m.body": "mass",
        "a_G": "acceleration of the centre of mass", "I.body": "inertia about the centre of mass", "α̇": "angular acceleration",
        "r_G": "centre of mass", "a.body": "acceleration", "m_s": "mass of the slider",
        "A_x": "force of the rod on the slider, along the guide", "A_y": "force of the rod on the slider, across the guide",
        "F.slider": "external force along the guide", "g_x": "gravity along the guide", "g_y": "gravity across the guide",
        "N": "guide force", "N_0": "guide force without friction", "τ.friction": "part of friction",
        "μ": "coefficient of friction", "m_A": "mass of the rod", "B": "force of the arm on the rod",
        "A": "force of the rod on the slider", "g": "gravity", "I_A": "inertia of the rod about its centre of mass",
        "r_B": "arm pin", "r_A.pin": "slider pin", "J": "inertia about the pivot", "m_L": "mass of the arm",
        "m_R": "mass of the roller", "r_R": "roller's centre from the pivot",
        "I_L": "inertia of the arm about its centre of mass", "r_L": "distance of the arm's centre of mass from the pivot",
        "I_R": "inertia of the roller", "M.arm": "moment of weight, spring and loads about the pivot",
        "r_C": "point of contact from the pivot", "m.follower": "mass of the follower", "k.spring": "spring rate",
        "F_0": "preload", "F.loads": "loads along the motion", "T.driver": "torque of the driver", "F_d": "force of the driver",
        "T.input": "torque of the input", "F.input": "force of the input", "F_k": "forces on the link",
        "F_k.flank": "force on a flank of the cam", "M_k": "moments on the link about the pin", "F.motion": "force of the motion",
        "T.motion": "torque of the motion", "m.motion": "mass that moves", "I.motion": "inertia that turns",
        "F_e": "external force", "T_e": "external torque", "F_r": "friction force", "T_r.friction": "friction torque",
        "E.kinetic": "kinetic energy", "v.body": "speed of the centre of mass", "ω.body": "angular velocity of the body",
        "P.power": "power", "v.point": "velocity of the point", "O": "force of the frame on the camshaft",
        "p_k": "direction of a flank's force on the cam", "j": "jamming factor", "f": "friction",
        "T.shaft": "torque on the shaft", "F.element": "force of the element", "l.spring": "distance between its ends",
        "l_0": "free length", "c.damper": "damping", "l̇": "rate of the distance", "E_k": "kinetic energy",
        "E_p": "energy of weight and springs", "t.time": "time", "P_f": "power lost in friction and dampers",
        "P_e": "power of external forces",
    }.items()
}  # fmt: skip
_FORCES: Mapping[str, SymbolSource] = {
    "F_c": quantity_symbol("contact force", "contact_force_n", lambda s: s.dynamics.contact, DYNAMICS),
    "F_c2": SymbolSource("contact force of the second roller"),
    "F.flank": SymbolSource("force on the flank in contact", "n", lambda s, _: first(_contact(s).force), DYNAMICS, "contact_force_n"),
    **vector_symbols("C", "point of contact", "mm", lambda s, _: first_complex(_contact(s).at)),
    **vector_symbols("p.direction", "force on the cam for one newton, friction of the face included (a unit vector without)", "",
              lambda s, _: first_complex(_contact(s).direction)),
    "μ.contact": SymbolSource("friction of face and cam"),
    "v̂": SymbolSource("direction in which the face slides on the cam"),
    "T_c": SymbolSource("cam torque"),
    "T_L": SymbolSource("torque on the arm"),
    **vector_symbols("P.pivot", "pivot", "mm", _ground_pivot, LINKAGE),
    **vector_symbols("e.line", "direction of the guide", "", _ground_line, LINKAGE),
    **vector_symbols("G", "force of the guide, friction included", "n", lambda s, _: _pair_force(s, "guide"), DYNAMICS),
    "F.pair": SymbolSource("size of the force"),
    "F_x": SymbolSource("component x", "n", lambda s, pair: _pair_force(s, pair).real, DYNAMICS),
    "F_y": SymbolSource("component y", "n", lambda s, pair: _pair_force(s, pair).imag, DYNAMICS),
    "ε.direction": SymbolSource("direction of the force"),
    "F_c.flank": SymbolSource("force on the flank", "n", lambda s, m: max(first(_stressed(s, m)[2].force), 0.0), DYNAMICS),
    "E*": SymbolSource("contact modulus", "mpa", lambda s, m: float(_stressed(s, m)[1].modulus), "cam.material"),
    "κ_rel": SymbolSource("sum of the curvatures of cam and what touches it", "per_mm",
                          lambda s, m: first(relative_curvature(_stressed(s, m)[0])), CAM),
    "b.width": SymbolSource("length of the line of contact", "mm", lambda s, m: float(_stressed(s, m)[1].width), "cam.thickness_mm"),
    "ν": SymbolSource("Poisson's ratio of cam, of roller"),
    "E.young": SymbolSource("Young's modulus of cam, of roller"),
    **{symbol: SymbolSource("contact pressure", "mpa", _stress("pressure"), DYNAMICS) for symbol in ("p.stress", "p₂")},
    **{symbol: SymbolSource("half width of the contact", "mm", _stress("half_width"), DYNAMICS) for symbol in ("a.contact", "a₂")},
    **{symbol: SymbolSource("largest shear below the surface") for symbol in ("τ.shear", "τ₂")},
    **{symbol: SymbolSource("depth of the largest shear") for symbol in ("z.depth", "z₂")},
    "ω_r": SymbolSource("speed of the roller about its axis"),
    "u.roller": SymbolSource("turns of the roller about its axis per turn of the shaft", "",
                             lambda s, roller: first(roller_speed(s, roller)) / s.omega, CAM),
    "L_10": SymbolSource("life in million turns of the roller"),
    "C.rating": SymbolSource("load rating of the roller", "n", lambda s, _: load_ratings(s)[_shortest_life(s).roller],
                             "cam.roller_load_rating_n"),
    "P.equivalent": SymbolSource("equivalent load", "n", lambda s, _: _shortest_life(s).load, DYNAMICS),
    "n_r": SymbolSource("mean speed of the roller about its axis", "rpm",
                        lambda s, _: _shortest_life(s).rpm * UNITS["rpm"].factor, DYNAMICS),
    "T.output": SymbolSource("torque or force of the motion", _by("n", "nm"), lambda s, _: first(s.dynamics.driver), DYNAMICS,
                             _by("force_n", "torque_nm")),
}  # fmt: skip
_ELASTIC: Mapping[str, SymbolSource] = {
    **{"m.elastic": SymbolSource("mass of the follower"), "z̈": SymbolSource("acceleration of the mass"),
       "c.elastic": SymbolSource("damping of the follower"), "ż": SymbolSource("velocity of the mass"),
       "k.elastic": SymbolSource("stiffness of the follower"), "k_s": SymbolSource("rate of its closing spring")},
    "z.mass": SymbolSource("position of the mass", motion_unit, lambda s, _: first(s.motion.displacement[0] + s.elastic_error(0)),
                           DYNAMICS),
    "s.cam": SymbolSource("motion of the cam", motion_unit, lambda s, _: first(s.motion.displacement[0]), MOTION),
    "s″.cam": SymbolSource("second derivative of the motion by cam angle", motion_unit,
                           lambda s, _: first(s.motion.displacement[2]), MOTION),
    "e.deviation": SymbolSource("deviation z - s of the mass, in the steady response", motion_unit,
                                lambda s, _: first(s.elastic_error(0)), DYNAMICS),
    "ë": SymbolSource("acceleration of the deviation", _by("mm_s2", "deg_s2"), lambda s, _: first(s.elastic_error(2)), DYNAMICS),
    "F_e.elastic": SymbolSource("contact force of an elastic follower"),
    "F_c.rigid": SymbolSource("contact force of a rigid follower", "n", lambda s, _: first(s.dynamics.contact), DYNAMICS),
    "Δ.elastic": SymbolSource("m ë + c ė + k_s e of the deviation e, by the lever of the contact", "n",
                              lambda s, _: first(s.elastic_contact_force) - first(s.dynamics.contact), DYNAMICS),
}  # fmt: skip
_SHAFT: Mapping[str, SymbolSource] = {
    "ω̄": _turn(lambda s: s.omega, "mean speed", "rad_s", speed_field),
    "T_m": SymbolSource("torque of the motor"),
    "T̄": _turn(lambda s: s.flywheel.mean_torque, "mean torque of the turn", "nm"),
    "H.harmonics": _turn(lambda s: first(motor_quantity(Flywheel.linear_motor_torque)(s)) - s.flywheel.mean_torque,
                         "harmonics of the torque, each over 1 + i n I ω̄/k", "nm"),
    **{"T_n": SymbolSource("harmonics of the shaft's torque"), "n.order": SymbolSource("order"),
       "k.motor": SymbolSource("slope of the motor"), "I.shaft": SymbolSource("inertia of flywheel and motor"),
       "J_e": SymbolSource("inertia of the mechanism at the shaft"), "ω.shaft": SymbolSource("speed of the shaft"),
       "T_s.loads": SymbolSource("torque of springs, weight, loads and friction"), "W.angle": SymbolSource("work by the angle"),
       "T_k": SymbolSource("torque of drive k"), "θ_k.phase": SymbolSource("phase of drive k"), "θ.machine": SymbolSource("machine angle"),
       "T.all": SymbolSource("torque of all drives")},
    "W.turn": _turn(lambda s: s.flywheel.mean_torque * TURN, "work of the turn", "j"),
    "ΔE": _turn(lambda s: s.flywheel.energy_swing, "swing of energy", "j"),
    "W_M": _turn(lambda s: energy_range(s.flywheel.load)[1], "greatest of the work of T - T̄ over the turn, ∫(T - T̄) dθ", "j"),
    "W_m": _turn(lambda s: energy_range(s.flywheel.load)[0], "least of the work of T - T̄ over the turn, ∫(T - T̄) dθ", "j"),
    "I.flywheel": SymbolSource("inertia of the flywheel"),
    "I_C": _turn(lambda s: s.flywheel.needed_inertia + motor_inertia(s.flywheel.shaft),
                 "least inertia with which (ω_M - ω_m)/ω̄ of the true speed is C_s", "kg_m2"),
    "I_m": _turn(lambda s: motor_inertia(s.flywheel.shaft), "inertia of the motor at the shaft", "kg_m2", "shaft.motor_inertia_kg_m2"),
    "C_s": _turn(lambda s: float(s.design.camshaft.speed_fluctuation), "target of the fluctuation of speed", "", "shaft.speed_fluctuation"),
    "C.fluctuation": SymbolSource("fluctuation of speed"),
    "ω_M": _turn(lambda s: s.flywheel.speed_range[1], "highest speed", "rad_s"),
    "ω_m": _turn(lambda s: s.flywheel.speed_range[0], "lowest speed", "rad_s"),
    "n.speed": SymbolSource("speed"),
    "T_r": SymbolSource("root mean square of the torque"),
    "M.square": _turn(lambda s: s.camshaft.rms_torque**2, "mean of T² over the turn, N²·m²"),
    "T.peak": _turn(lambda s: s.camshaft.peaks.high.value, "largest torque of the shaft", "nm"),
    **{"x.balance": SymbolSource("motion of the balance cam"), "x′.balance": SymbolSource("derivative of x by the machine angle"),
       "E_0": SymbolSource("energy of the spring at its start"), "K.spring": SymbolSource("rate of the spring"),
       "F_0.balance": SymbolSource("preload")},
}  # fmt: skip
_SERVO: Mapping[str, SymbolSource] = {
    "i": SymbolSource("turning of the motor by the motion", lambda s: "per_mm" if motion_unit(s) == "mm" and not _is_linear(s) else "",
                      lambda s, _: lever(servo_part(s)), "servo.gear_ratio"),
    "T_s.servo": SymbolSource("torque of the servo, force of a linear one", lambda s: "n" if _is_linear(s) else "nm",
                              lambda s, _: first(servo_torque(s)), DYNAMICS,
                              lambda s: "servo_force_n" if _is_linear(s) else "servo_torque_nm"),
    "F_s": SymbolSource("force of the servo"),
    "F.load": SymbolSource("force or torque of loads and masses on the motion", _by("n", "nm"), lambda s, _: first(servo_load(s).load),
                           DYNAMICS),
    "m.servo": SymbolSource("mass or inertia that the servo moves besides", _by("kg", "kg_m2"),
                            lambda s, _: moved_mass(servo_part(s)), "servo"),
    "F_r.servo": SymbolSource("friction of the servo", _by("n", "nm"), lambda s, _: first(servo_load(s).friction), "servo"),
    "k.losses": SymbolSource("losses of the gear: 1/η where it drives the load, η where the load drives it", "",
                             lambda s, _: first(servo_load(s).losses), "servo.efficiency"),
    "J_r": SymbolSource("inertia of the rotor", "kg_m2", lambda s, _: servo_part(s).rotor_inertia_kg_m2 or 0.0,
                        "servo.rotor_inertia_kg_m2"),
    "n_s.servo": SymbolSource("speed of the servo"),
    "v_s": SymbolSource("velocity of a linear servo"),
    "P_s": SymbolSource("power of the servo"),
}  # fmt: skip
_STABILITY: Mapping[str, SymbolSource] = {
    "K_s": SymbolSource("stiffness of the shaft", "nm_per_rad", _machine("stiffness"), "shaft.stiffness_nm_per_rad"),
    "I_c": SymbolSource("inertia of the camshaft", "kg_m2", _machine("camshaft_inertia"), "shaft.camshaft_inertia_kg_m2"),
    "n_s": SymbolSource("natural frequency of the shaft"),
    "ϕ": SymbolSource("wind-up θ_i - θ_c", "deg", lambda s, _: first(s.steady_turn.wind_up(s.theta)), STABILITY),
    "T_s": SymbolSource("torque in the shaft", "nm", lambda s, _: first(s.steady_turn.torque(s.theta)), STABILITY),
    "Δ.follower": SymbolSource("follower's error"),
    "X_c": SymbolSource("motion at the angle of the cam, θ_i - wind-up", motion_unit,
                        lambda s, _: _displacement_at(s, s.theta - first(s.steady_turn.wind_up(s.theta))), MOTION),
    "X_i": SymbolSource("motion at the angle of the input", motion_unit, lambda s, _: _displacement_at(s, s.theta), MOTION),
    **{key: SymbolSource(meaning) for key, meaning in {
        "η": "frequency ratio", "Q.inertia": "inertia ratio", "M_v": "mass of the follower", "X′_m": "greatest slope of the motion",
        "ζ": "√D β", "ζ″": "second derivative of ζ by the angle in turns", "ψ.load": "slope of the load, U_θ", "D": "inertia J/I_c",
        "C.hill": "D_θ/(2 Q)", "U": "load of the cam by the cam angle", "β.windup": "wind-up in turns", "a.harmonics": "harmonics of ζ",
        "R.orders": "orders r or r + ½", "ψ_1": "ψ/η²", "κ.slope": "slope C_θ", "ζ.damping": "damping ratio",
        "T.toeplitz": "Toeplitz matrix of Fourier coefficients",
    }.items()},
}  # fmt: skip


def _is_linear(study: Study) -> bool:
    return servo_part(study).kind == LINEAR


LETTERS: Mapping[str, SymbolSource] = MappingProxyType(
    {
        **_MOTION, **_TRAIN, **_CAM, **_LINKS, **_BODIES, **_FORCES, **_ELASTIC, **_SHAFT, **_SERVO, **_STABILITY, **SPATIAL_LETTERS,
    }
)  # fmt: skip
"""Key -> symbol: meaning, unit, value and origin, once for every formula."""


def keys_of(formula: Formula) -> tuple[str, ...]:
    """Keys of the symbols on the right side of the form that is evaluated."""
    if formula.values:
        return tuple(formula.values.split())
    left = formula.evaluated.partition(" = ")[0].split()
    return tuple(key for key in formula.letters.split() if symbol_of(key) not in left and LETTERS[key].value)


def letters_of(study: Study, keys: str | tuple[str, ...], member: str = "") -> tuple[Letter, ...]:
    """Symbols of ``LETTERS`` with their values at the study's angle."""
    row = keys.split() if isinstance(keys, str) else keys
    return tuple(LETTERS[key].read(study, symbol_of(key), member) for key in row)
