"""Numbers of Shin1995's velocities, instant centre, cam shape, forces and torques, computed from the example's lift."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np

from core.design import Shaft, put, require_motion, si
from core.numerics.derivatives import cross
from core.papers.claim import Examples, relative_error
from core.papers.shin1995_geometry import LIFT, UNIT
from core.study import Study, extremes_of
from core.study.quantity_requests import output_travel, path_drives, path_rate

# -- velocities, instant centre and contact ---------------------------------------------------------------------

SMALL = 1e-9

Numbers = Mapping[str, Any]


def largest(study: Study, stage: str, name: str) -> float:
    """Refined greatest absolute value of a quantity over the turn."""
    extremes = extremes_of(study, stage, (name,))[name]
    return max(abs(extremes.low.value), abs(extremes.high.value))


def velocities(examples: Examples) -> Numbers:
    """Errors of (11)-(14) as printed, evaluated at the angles and slider speeds of the study.

    References
    ----------
    Shin, Kim and Ha (1995), eqs. (11)-(14).
    """
    study = examples.study(LIFT)
    g = si(study.design.drive.follower)
    at, y = study.linkage.coordinates, study.motion.displacement
    (phi, phi1, phi2), (beta, beta1, beta2) = ([at[name][k] for k in range(3)] for name in ("phi", "beta"))
    d = phi - beta
    is_moving = np.abs(y[1]) > 0.0
    rod = y[1] * np.cos(phi) / (g.rod * np.sin(d))
    arm = y[1] * np.cos(beta) / (g.slider_arm * np.sin(-d))
    rod2 = (y[2] * np.cos(phi) + g.rod * beta1**2 * np.cos(d) + g.slider_arm * phi1**2) / (g.rod * np.sin(d))
    arm2 = (y[2] * np.cos(beta) + g.slider_arm * phi1**2 * np.cos(d) + g.rod * beta1**2) / (g.slider_arm * np.sin(-d))
    pairs = ((rod, beta1), (arm, phi1), (rod2, beta2), (arm2, phi2))
    return {"off": max(relative_error(a[is_moving], b[is_moving]) for a, b in pairs), "bound": SMALL}


def centre(examples: Examples) -> dict[str, np.ndarray]:
    """Instant centre Q on the line to the pivot, (18) as printed, and (18) with φ' against the cam's sense.

    Returns
    -------
    dict of ndarray (n,) [m] or [deg]
        By cam angle `degrees`: `q`, `printed`, `corrected`; the distances by which the contact normal misses each; V_R
        by (16)
        and (17) per rad/s of the cam.

    References
    ----------
    Shin, Kim and Ha (1995), eqs. (15)-(18).
    """
    study = examples.study(LIFT)
    g, shape = si(study.design.drive.follower), study.cam
    pivot = complex(g.pivot_x, g.pivot_y)
    zxy = abs(pivot)
    along = pivot / zxy
    turn = study.linkage.coordinates["phi"][1]
    against = -shape.rotation_sign * turn
    q = (shape.centre.finite * along.conjugate()).real
    with np.errstate(divide="ignore", invalid="ignore"):
        printed, corrected = zxy * turn / (1.0 + turn), zxy * against / (1.0 + against)

    def normal_distance(position: np.ndarray) -> np.ndarray:
        return np.asarray(np.abs((shape.flank.normal.conjugate() * (position * along - shape.reference)).imag))

    return {
        "degrees": study.angle_degrees,
        "q": q,
        "printed": printed,
        "corrected": corrected,
        "missed printed": normal_distance(printed),
        "missed corrected": normal_distance(corrected),
        "roller": g.roller_arm * against,
        "by centre": q * g.roller_arm / (zxy - q),
    }


def roller_velocity(examples: Examples) -> Numbers:
    """Error of V_R by the instant centre relative to V_R by the arm, and the largest velocities.

    References
    ----------
    Shin, Kim and Ha (1995), eqs. (15)-(17).
    """
    c, study = centre(examples), examples.study(LIFT)
    return {
        "off": relative_error(c["by centre"], c["roller"]),
        "bound": SMALL,
        "centre": largest(study, "cam", "instant_centre_velocity"),
        "roller": largest(study, "cam", "reference_velocity"),
    }


def centre_sign(examples: Examples) -> Numbers:
    """Errors [mm] of (18) as printed and with φ' against the cam's sense, and distances of the contact normal.

    References
    ----------
    Shin, Kim and Ha (1995), eq. (18).
    """
    c = centre(examples)
    printed, corrected = (float(np.abs(c[name] - c["q"]).max()) * 1e3 for name in ("printed", "corrected"))
    return {
        "printed": printed if np.isfinite(printed) else inf,
        "corrected": corrected,
        "bound": 1e-6,
        "missed": float(c["missed printed"].max()) * 1e3,
        "missed_corrected": float(c["missed corrected"].max()) * 1e3,
    }


def _contact(roller: np.ndarray, centre_at: np.ndarray, radius: float) -> np.ndarray:
    """Contact points by (19), (20) in the frame whose x axis contains the centre (n,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        psi = np.arctan((centre_at - roller.real) / roller.imag)
    return np.asarray(roller + radius * (np.sin(psi) - 1j * np.cos(psi)))


def contact(examples: Examples) -> dict[str, np.ndarray]:
    """Contact points in the frame of the line to the pivot: true, and by (19), (20), for two poses.

    The poses are the roller above the line and its mirror image below.

    Returns
    -------
    dict of ndarray (n,) complex [m]

    References
    ----------
    Shin, Kim and Ha (1995), eqs. (19), (20).
    """
    study = examples.study(LIFT)
    g, shape = si(study.design.drive.follower), study.cam
    along = complex(g.pivot_x, g.pivot_y)
    along /= abs(along)
    roller, true = (z * along.conjugate() for z in (shape.reference, shape.flank.contact))
    q = (shape.centre.finite * along.conjugate()).real
    radius = abs(shape.flank.radius)
    is_above = np.sign(roller.imag[0]) > 0.0
    above = (roller, true) if is_above else (roller.conjugate(), true.conjugate())
    below = tuple(z.conjugate() for z in above)
    points = {}
    for name, (position, contact_point) in (("above", above), ("below", below)):
        to_centre = (q - position) / np.abs(q - position)
        points[name], points[f"{name} printed"] = contact_point, _contact(position, q, radius)
        points[f"{name} corrected"] = position + radius * to_centre
    return points


def _in_global_axes(examples: Examples) -> float:
    """Error [mm] of (19), (20) for the lift where R is counted from the axes instead of the line to the pivot."""
    study = examples.study(LIFT)
    g, shape = si(study.design.drive.follower), study.cam
    along = complex(g.pivot_x, g.pivot_y) / abs(complex(g.pivot_x, g.pivot_y))
    q = (shape.centre.finite * along.conjugate()).real
    return float(np.abs(_contact(shape.reference, q, abs(shape.flank.radius)) - shape.flank.contact).max()) * 1e3


def quadrant(examples: Examples) -> Numbers:
    """Errors [mm] of (19), (20) with the roller above the line to the pivot (Fig. 4), below it, and by global axes.

    The corrected point is along the relative velocity's normal, in both poses.

    References
    ----------
    Shin, Kim and Ha (1995), eqs. (19), (20).
    """
    c = contact(examples)
    off = {name: float(np.abs(c[name] - c[name.split()[0]]).max()) * 1e3 for name in c}
    below, axes = off["below printed"], _in_global_axes(examples)
    return {
        "used": off["above printed"],
        "elsewhere": max(below, axes),
        "bound": 1e-6,
        "below": below,
        "axes": axes,
        "corrected": max(off["above corrected"], off["below corrected"]),
    }


# -- motion and shape --------------------------------------------------------------------------------------


def divisions(examples: Examples) -> Numbers:
    """Strokes of the slider: where it falls and rises [deg], and its rise [mm] (Fig. 15)."""
    study = examples.study(LIFT)
    angle, strokes = 0.0, []
    for segment in require_motion(study.design).segments:
        if segment.rise:
            strokes.append((angle, angle + segment.span_deg, segment.rise))
        angle += segment.span_deg
    return {"strokes": tuple(strokes)}


PRINTED_STROKES = ((35.0, 76.5, -150.0), (283.5, 325.0, 150.0))


def as_divided(strokes: tuple[tuple[float, float, float], ...]) -> tuple[str, str]:
    """Judge Fig. 15: whether the strokes are the printed ones."""
    same = len(strokes) == len(PRINTED_STROKES) and np.allclose(strokes, PRINTED_STROKES, rtol=0.0, atol=1e-9)
    words = ", ".join(
        f"{'up' if rise > 0.0 else 'down'} {abs(rise):g} mm from {a:g}° to {b:g}°" for a, b, rise in strokes
    )
    return ("agrees" if same else "differs"), words


def joins(examples: Examples) -> Numbers:
    """Largest jump of velocity and of acceleration at a join relative to its largest value (Fig. 17)."""
    study = examples.study(LIFT)
    y = study.motion.displacement
    jumps = [max(abs(float(join.jump[k])) for join in study.program.joins) for k in (1, 2)]
    sizes = [float(np.abs(y[k]).max()) for k in (1, 2)]
    ranges = extremes_of(study, "motion", ("velocity", "acceleration"))
    stroke = float(np.ptp(y[0]))
    span = np.deg2rad(max(s.span_deg for s in require_motion(study.design).segments if s.rise))
    largest = {name: max(abs(extremes.low.value), abs(extremes.high.value)) for name, extremes in ranges.items()}
    peaks = largest["velocity"] / study.omega, largest["acceleration"] / study.omega**2
    return {
        "off": max(jump / size for jump, size in zip(jumps, sizes, strict=True)),
        "bound": 1e-9,
        "velocity": peaks[0] * span / stroke,
        "acceleration": peaks[1] * span**2 / stroke,
    }


def shape(examples: Examples) -> Numbers:
    """Deviation of the profile from a closed curve without a cusp about the base circle [mm] (Fig. 18)."""
    study = examples.study(LIFT)
    flank = study.cam.flank
    extremes = extremes_of(study, "cam", ("radius", "pressure_angle"))
    base = si(study.design.drive.cam).base_radius
    sharpest = 1.0 - flank.radius * float(flank.pitch_curvature.max())
    reach = np.abs(study.cam.reference)
    low = float(extremes["radius"].low.value)
    return {
        "off": abs(low - base) * 1e3 if sharpest > 0.0 else inf,
        "bound": 1e-6,
        "least": low * 1e3,
        "near": float(reach.min()) * 1e3,
        "far": float(reach.max()) * 1e3,
        "angle": float(np.rad2deg(extremes["pressure_angle"].high.value)),
    }


# -- forces and torques -----------------------------------------------------------------------------------------

MUCH = 0.5  # of the cam's peak: greatest torque that is "much less"


def weightless(examples: Examples) -> Study:
    """The lift without weights, which (22)-(24) of the paper leave out."""
    design = put(examples.design(LIFT), "loads.gravity_m_s2", 0.0)
    return examples.once("lift without weights", lambda: Study(design, examples.study(LIFT).samples))


def pin_force(examples: Examples) -> dict[str, np.ndarray]:
    """Force B_y by the arm on the rod: of Newton-Euler, (23) as printed, evaluated in m and in mm, and corrected.

    The corrected line has its bracket over (L3 + L4) cos β, and β from the arm's pin as in (10).

    Returns
    -------
    dict of ndarray (n,) [N]

    References
    ----------
    Shin, Kim and Ha (1995), eq. (23).
    """
    study = weightless(examples)
    g, loads = si(study.design.drive.follower), study.design.drive.loads
    rod, beta = study.linkage.bodies["rod"], study.linkage.coordinates["beta"]
    mass, inertia = loads.rod_mass_kg, loads.rod_inertia_kg_m2
    l3, l4 = loads.rod_centre * g.rod, (1.0 - loads.rod_centre) * g.rod
    a = rod.fixed_point(complex(l3, 0.0))[2] * study.omega**2
    slider = -study.dynamics.pairs["slider_pin"]
    x = mass * a.real - slider.real
    s, c, turning = np.sin(beta[0]), np.cos(beta[0]), inertia * beta[2] * study.omega**2
    inertial = mass * l4 * (a.imag * c - a.real * s)

    def printed(unit: float) -> np.ndarray:
        """(23) as printed with lengths in a unit of this many metres."""
        length = (l3 + l4) / unit
        return np.asarray(x * s * length + inertial / unit + turning / unit**2 / (length * c))

    true = -study.dynamics.pairs["arm_pin"].imag
    corrected = (x * s * (l3 + l4) + inertial - turning) / ((l3 + l4) * c)
    return {"true": true, "in m": printed(1.0), "in mm": printed(1e-3), "corrected": corrected}


def bracket(examples: Examples) -> Numbers:
    """Errors of (23) as printed, in m, and corrected, and the largest forces [N].

    References
    ----------
    Shin, Kim and Ha (1995), eq. (23).
    """
    f = pin_force(examples)
    return {
        "printed": relative_error(f["in m"], f["true"]),
        "corrected": relative_error(f["corrected"], f["true"]),
        "bound": SMALL,
        "largest": float(np.abs(f["true"]).max()),
        "metres": float(np.abs(f["in m"]).max()),
        "millimetres": float(np.abs(f["in mm"]).max()),
    }


def arm_torque(examples: Examples) -> dict[str, np.ndarray]:
    """Torque T_L: of Newton-Euler, by (24) with inertias about the pivot as printed, and about the mass centres.

    Returns
    -------
    dict of ndarray (n,) [N m]

    References
    ----------
    Shin, Kim and Ha (1995), eq. (24).
    """
    study = weightless(examples)
    g, loads = si(study.design.drive.follower), study.design.drive.loads
    arm, at = study.linkage.bodies["arm"], study.linkage.coordinates["phi"]
    pivot = arm.position("pivot")
    phi2 = at[2] * study.omega**2
    pin = arm.position("arm_pin") - pivot
    force = -study.dynamics.pairs["arm_pin"]
    centre = loads.arm_centre_mm * 1e-3 * np.exp(1j * np.deg2rad(loads.arm_centre_angle_deg))
    moments = cross(pin, -force)
    about_pivot = about_centres = (loads.arm_inertia_kg_m2 + loads.roller_inertia_kg_m2) * phi2
    for mass, position, distance in (
        (loads.arm_mass_kg, arm.fixed_point(centre), abs(centre)),
        (loads.roller_mass_kg, arm.fixed_point(arm.points["roller"]), g.roller_arm),
    ):
        moments = moments + cross(position[0] - pivot, -mass * position[2] * study.omega**2)
        about_pivot = about_pivot + mass * distance**2 * phi2
    return {
        "true": study.dynamics.follower_torque,
        "printed": about_pivot - moments,
        "corrected": about_centres - moments,
    }


def counted_twice(examples: Examples) -> Numbers:
    """Errors of (24) with inertias about the pivot and about the mass centres, and the largest torque [N m].

    References
    ----------
    Shin, Kim and Ha (1995), eq. (24).
    """
    t = arm_torque(examples)
    return {
        "printed": relative_error(t["printed"], t["true"]),
        "corrected": relative_error(t["corrected"], t["true"]),
        "bound": SMALL,
        "largest": float(np.abs(t["true"]).max()),
        "difference": float(np.abs(t["printed"] - t["true"]).max()),
    }


def drive_torque(examples: Examples) -> Numbers:
    """Errors of (27), R x F_c, and of the follower's power T_L φ̇/ω against the drive torque.

    References
    ----------
    Shin, Kim and Ha (1995), eqs. (25)-(27).
    """
    study = examples.study(LIFT)
    force = study.dynamics.contact * study.cam.flank.normal
    crossed = -study.cam.rotation_sign * cross(study.cam.reference, force)
    power = study.dynamics.follower_torque * study.linkage.coordinates["phi"][1]
    return {
        "off": max(relative_error(crossed, study.dynamics.torque), relative_error(power, study.dynamics.torque)),
        "bound": 1e-8,
        "largest": largest(study, "dynamics", "drive_torque"),
    }


def guide_friction(examples: Examples) -> Numbers:
    """Friction μW of (21) against the friction of the guide, μ|N| [N].

    References
    ----------
    Shin, Kim and Ha (1995), eq. (21).
    """
    study = examples.study(LIFT)
    loads, guide = study.design.drive.loads, study.dynamics.guide
    assert guide is not None, "the lift has a guide"
    weight = loads.friction * loads.slider_mass_kg * loads.gravity_m_s2
    is_moving = study.motion.velocity_sign != 0.0
    friction = loads.friction * np.abs(guide.normal[is_moving])
    off = float(np.abs(friction - weight).max()) / max(weight, 1e-300)
    return {"off": off, "bound": 0.1, "weight": weight, "friction": float(friction.max())}


# -- the flywheel ------------------------------------------------------------------------------------------


def shaft_of(study: Study) -> Shaft:
    """Shaft of a study."""
    shaft = study.design.shaft
    assert shaft is not None, "the lift's cam is on a shaft"
    return shaft


def with_flywheel(examples: Examples) -> Study:
    """The lift with its flywheel; of the required inertia where it has none."""

    def compute() -> Study:
        study = examples.study(LIFT)
        if study.levels_torque:
            return study
        needed = study.flywheel.needed_inertia
        shaft = replace(shaft_of(study), flywheel_inertia_kg_m2=needed)
        return Study(replace(study.design, shaft=shaft), study.samples)

    return examples.once("lift with a flywheel", compute)


def flywheel(examples: Examples) -> Numbers:
    """Largest torques [N m] of the cam and, with a flywheel, of the motor, and the relative speed (Figs. 19, 20).

    NaN where the motor stalls.
    """
    study = with_flywheel(examples)
    runs = study.flywheel.runs
    ranges = extremes_of(study, "dynamics", ("drive_torque", *(("motor_torque", "camshaft_speed") if runs else ())))

    def swing(name: str) -> float:
        return ranges[name].high.value - ranges[name].low.value if name in ranges else float("nan")

    speed = ranges.get("camshaft_speed")
    return {
        "runs": runs,
        "inertia": float(shaft_of(study).flywheel_inertia_kg_m2),
        "cam": largest(study, "dynamics", "drive_torque"),
        "motor": largest(study, "dynamics", "motor_torque") if runs else float("nan"),
        "cam_swing": swing("drive_torque"),
        "motor_swing": swing("motor_torque"),
        "slowest": speed.low.value / study.omega if speed else float("nan"),
        "fastest": speed.high.value / study.omega if speed else float("nan"),
    }


def stabilised(
    runs: bool, inertia: float, cam_swing: float, motor_swing: float, slowest: float, fastest: float, **_: Any
) -> tuple[str, str]:
    """Judge Fig. 19: whether the motor's torque swings much less than the cam's."""
    if not runs:
        return "differs", f"with {inertia:.4g} kg·m² the motor stalls before the cam's peak has passed"
    return ("agrees" if motor_swing <= MUCH * cam_swing else "differs"), (
        f"with {inertia:.5g} kg·m² the motor's torque swings by {motor_swing:.4g} N·m where the cam's swings by {cam_swing:.4g}; "
        f"speed {slowest:.4f} … {fastest:.4f} of the mean"
    )


def much_less(runs: bool, inertia: float, cam: float, motor: float, **_: Any) -> tuple[str, str]:
    """Judge Fig. 20: whether the motor's largest torque is much less than the cam's."""
    if not runs:
        return "differs", f"with {inertia:.4g} kg·m² the motor stalls: no torque carries the cam over its peak"
    return ("agrees" if motor <= MUCH * cam else "differs"), (
        f"at most {motor:.4g} N·m with a flywheel of {inertia:.5g} kg·m², {cam:.4g} N·m without one: {100.0 * motor / cam:.2g} % of it"
    )


# -- the complete unit -------------------------------------------------------------------------------------

PRINTED_CAMS = ("feed", "clamp", "lift", "torque")


def cams(examples: Examples) -> Numbers:
    """Names of the cams on the shaft (Fig. 14); a balance cam is the one for torque."""
    shaft = examples.shaft(UNIT)
    balancer = () if shaft.design.balancer is None else ("torque",)
    return {"names": (*(name.lower() for name in shaft.drives), *balancer)}


def four_cams(names: tuple[str, ...]) -> tuple[str, str]:
    """Judge Fig. 14: whether the shaft has the four printed cams."""
    is_complete = all(any(cam in name for name in names) for cam in PRINTED_CAMS)
    verdict = "agrees" if is_complete and len(names) == len(PRINTED_CAMS) else "differs"
    return verdict, f"{len(names)} cams on one shaft: {', '.join(names)}"


def directions(examples: Examples) -> Numbers:
    """Stroke of each drive's output and the angle [deg] in which it moves in a turn (§6.1)."""
    shaft = examples.shaft(UNIT)
    strokes = {}
    for name, study in shaft.drives.items():
        motion = require_motion(study.design)
        unit = motion.unit
        stroke = float(np.ptp(study.motion.displacement[0])) * (1e3 if unit == "mm" else 180.0 / np.pi)
        strokes[name] = (stroke, unit, sum(s.span_deg for s in motion.segments if s.rise))
    return {"strokes": strokes}


def transferred(examples: Examples) -> Numbers:
    """Travel [mm] of the transfer in each direction, by the names of the first drives, and its speed [mm/s] (§6.1).

    `sides` are the positions [mm], least and most, of the other directions while the first one goes forwards and back.
    """
    shaft = examples.shaft(UNIT)
    names = path_drives(shaft)
    path = {name: output_travel(shaft, name) for name in names}
    travel = {name: float(np.ptp(displacement[0])) * 1e3 for name, displacement in path.items()}
    first = path[names[0]][1]
    least = 0.01 * np.abs(first).max()
    sides = {
        name: tuple(
            (float(displacement[0][going].min()) * 1e3, float(displacement[0][going].max()) * 1e3)
            for going in (first > least, first < -least)
        )
        for name, displacement in list(path.items())[1:]
    }
    return {"travel": travel, "sides": sides, "speed": float(path_rate(shaft, 1).max()) * 1e3}


def in_three(
    travel: Mapping[str, float], sides: Mapping[str, tuple[tuple[float, float], tuple[float, float]]], speed: float
) -> tuple[str, str]:
    """Judge §6.1: whether the transfer moves in three directions, and back on another path."""
    separate = [name for name, (forwards, back) in sides.items() if forwards[0] > back[1] or back[0] > forwards[1]]
    lengths = ", ".join(f"{name} {length:.4g} mm" for name, length in travel.items())
    positions = " and ".join(
        f"{name} at {_range(ahead)} (back at {_range(back)})" for name, (ahead, back) in sides.items()
    )
    words = (
        f"{lengths}, at right angles in the order of the list of drives, since a drive does not state its direction; "
        f"forwards with {positions}; at most {speed:.4g} mm/s; shown as {len(travel) - 1} plane projections, without "
        "carrier or workpiece"
    )
    return ("agrees" if len(travel) == 3 and min(travel.values()) > 0.0 and separate else "differs"), words


def _range(ends: tuple[float, float]) -> str:
    low, high = (f"{end + 0.0:.4g}" for end in ends)
    return f"{low} mm" if low == high else f"{low} … {high} mm"
