"""Numbers of the lecture's centres, constructions and velocities, computed from the example linkages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import cos, inf, pi, radians, sin
from typing import Any

import numpy as np

from core.design import put
from core.instant_centres import CentreTable, angular_ratio, collinearity, kennedy, ratio_arms, velocity_differences
from core.instant_centres.velocities import link_by_link
from core.mechanism import body_name, link_number
from core.papers.claim import ComparedNumber, Examples
from core.study import Study, quantity

FOUR_BAR, SLIDER_CRANK, SIX_BAR, SUSPENSION = "four_bar", "slider_crank", "lecture_six_bar", "rear_suspension"
ANGLES = {FOUR_BAR: 60.0, SLIDER_CRANK: 60.0, SIX_BAR: 45.0, SUSPENSION: 0.0}
"""Driver angle [deg] of each drawing; the lecture's crank is at 45°."""
MOVING = {SIX_BAR: "six-bar", SLIDER_CRANK: "slider-crank", SUSPENSION: "suspension"}
"""Examples with masses, in words."""
CM, RPM = 0.01, pi / 30.0
DIGIT = 0.01  # last printed digit, which the lecture's rounding of intermediate results changes
SMALL = 1e-9

Numbers = Mapping[str, Any]


def posed(examples: Examples, name: str) -> Study:
    """Study of an example at its angle."""
    return examples.once(("posed", name), lambda: examples.study(name).at_theta(np.array([radians(ANGLES[name])])))


def centre(table: CentreTable, a: int, b: int) -> complex:
    """Position of the instant centre of two links."""
    return complex(table.centre(body_name(a), body_name(b)).finite[0])


def label(key: tuple[str, str]) -> str:
    """Name of an instant centre, for example ``I13``."""
    return "I" + "".join(str(link_number(body)) for body in key)


# -- pp. 1 to 5: definitions -------------------------------------------------------------------------------


def stored(examples: Examples) -> Mapping[str, np.ndarray]:
    """Kinetic energy of the examples with masses over their turn, by name.

    Returns
    -------
    dict of ndarray (n,) [J]
    """
    return {name: quantity("kinetic_energy").value(examples.study(name)) for name in MOVING}


def energy(examples: Examples) -> Numbers:
    """Least and largest kinetic energy [J] of each example with masses (p. 1), and its error for links about their I1n.

    The energy of a rotating link about its centre I1n is ½(I + m |c - I1n|²)ω²; its error relative to the largest
    ½m v² + ½Iω² is `off`.
    """
    off = 0.0
    for name in MOVING:
        study = examples.study(name)
        speeds = study.angular_velocities()
        for mass in study.design.drive.loads.masses:
            body = study.linkage.bodies[body_name(mass.link)]
            omega = np.asarray(speeds[mass.link])
            rotates = np.abs(omega) > 1e-3 * max(float(np.abs(speed).max()) for speed in speeds.values())
            if not rotates.any():
                continue
            of_link = quantity(f"kinetic_energy.{body_name(mass.link)}").value(study)
            position = body.fixed_point(complex(mass.centre_x_mm, mass.centre_y_mm) * 1e-3)[0]
            pole = study.centres.centre("frame", body_name(mass.link)).finite
            inertia = mass.inertia_kg_m2 + mass.mass_kg * np.abs(position - pole)[rotates] ** 2
            about = 0.5 * inertia * omega[rotates] ** 2
            off = max(off, float(np.abs(about - of_link[rotates]).max() / of_link.max()))
    return {"stored": {name: (float(e.min()), float(e.max())) for name, e in stored(examples).items()}, "off": off}


def as_stored(stored: Mapping[str, tuple[float, float]], off: float) -> tuple[str, str]:
    """Judge p. 1: whether the examples store energy, and it is that about the centres."""
    ranges = ", ".join(f"the {MOVING[name]} {low + 0.0:.4g} … {high:.4g} J" for name, (low, high) in stored.items())
    words = f"stored over the turn: {ranges} (masses assumed); a link's about its centre I1n is the same to {off:.1g}"
    return ("agrees" if all(0.0 <= low < high for low, high in stored.values()) and off < 1e-6 else "differs"), words


def crank_velocity(examples: Examples) -> Numbers:
    """Error of jωR as the velocity of the six-bar's crank pin over the turn (p. 2)."""
    study = examples.study(SIX_BAR)
    position, velocity = study.points()["A"]
    expected = 1j * study.omega * position
    off = float(np.abs(velocity - expected).max() / np.abs(expected).max())
    return {"off": off, "bound": SMALL, "crank_pin": float(np.abs(velocity[0])) / CM}


def differences(examples: Examples) -> Numbers:
    """Error of V_P = V_A + V_PA for every pair of points of the six-bar over the turn (p. 3)."""
    study = examples.study(SIX_BAR)
    rows = list(velocity_differences(study.linkage))
    size = max(float(np.abs(row.v_p).max()) for row in rows)
    return {
        "off": max(float(np.abs(row.v_a + row.v_pa - row.v_p).max()) for row in rows) / size,
        "bound": SMALL,
        "count": len(rows),
    }


def count(name: str) -> Callable[[Examples], Numbers]:
    """Function that returns the number of centres, of centres known at sight, and n(n - 1)/2."""

    def numbers(examples: Examples) -> Numbers:
        table = posed(examples, name).centres
        n = len(table.bodies)
        return {
            "count": len(table.centres),
            "formula": n * (n - 1) // 2,
            "links": n,
            "sight": len(table.construction.known),
        }

    return numbers


def as_counted(printed: int) -> Callable[..., tuple[str, str]]:
    """Judge of a number of centres: whether it is the printed one and that of the formula."""

    def judge(count: int, formula: int, links: int, sight: int) -> tuple[str, str]:
        words = f"{links} links have {count} centres, {sight} of them at sight"
        return ("agrees" if count == formula == printed else "differs"), words

    return judge


def on_one_line(examples: Examples) -> Numbers:
    """Deviation of the three centres of any three links of the six-bar from a line, as unit vectors (p. 5).

    `outside` is the distance of I13 beyond the ends of link 3, relative to its length.
    """
    study = examples.study(SIX_BAR)
    at_angle = posed(examples, SIX_BAR)
    ends = [complex(at_angle.points()[name][0][0]) for name in ("A", "B")]
    along = (centre(at_angle.centres, 1, 3) - ends[0]) / (ends[1] - ends[0])
    return {"off": float(collinearity(study.centres).max()), "bound": 1e-7, "outside": abs(along - 0.5) - 0.5}


# -- pp. 6 to 8: constructions -----------------------------------------------------------------------------


def step(name: str, number: int) -> Callable[[Examples], Numbers]:
    """Function that returns a step of the circle diagram: the centre, its lines, and their intersection [mm].

    `off` is the error of the intersection relative to the centre by velocities.
    """

    def numbers(examples: Examples) -> Numbers:
        table = posed(examples, name).centres
        steps = table.construction.steps
        if number > len(steps):
            return {"name": "", "lines": (), "position": complex(inf), "off": inf, "bound": SMALL, "far": False}
        construction_step = steps[number - 1]
        crossing, by_velocity = (
            kennedy(table.centres, construction_step, table.size).scaled(table.size),
            table.centres[construction_step.key],
        )
        far = bool(by_velocity.is_far(table.size)[0])
        a, b = (
            np.array([c.point[0].real / table.size, c.point[0].imag / table.size, c.weight[0]])
            for c in (crossing, by_velocity)
        )
        return {
            "name": label(construction_step.key),
            "lines": tuple(f"{label(t.first)}-{label(t.second)}" for t in construction_step.triangles[:2]),
            "position": complex(by_velocity.finite[0]) * 1e3 if not far else complex(inf),
            "far": far,
            "off": float(np.linalg.norm(np.cross(a, b))),
            "bound": 1e-7,
        }

    return numbers


def judge_step(
    name: str, lines: tuple[str, ...], position: complex, off: float, bound: float, far: bool
) -> tuple[str, str]:
    """Judge a step of pp. 6-8: whether two lines intersect at the centre by velocities."""
    if not name:
        return "differs", "the construction has no such step"
    where = "at infinity" if far else f"({round(position.real, 4) + 0.0:.4f}, {round(position.imag, 4) + 0.0:.4f}) mm"
    words = f"{name} where {' and '.join(lines)} cross: {where}, {off:.1g} off the one by velocities"
    return ("agrees" if off <= bound and len(lines) == 2 else "differs"), words


# -- pp. 9 to 12: velocities -------------------------------------------------------------------------------


def ratios(name: str) -> Callable[[Examples], Numbers]:
    """Function that returns the error of ω_j/ω_i by the distances between centres, for all rotating links (p. 9)."""

    def numbers(examples: Examples) -> Numbers:
        study = posed(examples, name)
        table, speeds = study.centres, study.angular_velocities()
        driver = study.design.drive.linkage.driver.link
        ratio_by_name, worst = {}, 0.0
        for number, omega in speeds.items():
            if number not in (1, driver):
                by_centres = float(angular_ratio(table, body_name(number), body_name(driver))[0])
                true = float(omega[0]) / float(speeds[driver][0])
                ratio_by_name[f"ω{number}/ω{driver}"] = by_centres
                worst = max(worst, abs(by_centres - true))
        return {
            "off": worst,
            "bound": SMALL,
            "ratios": ", ".join(f"{key} = {value:.6f}" for key, value in ratio_by_name.items()),
        }

    return numbers


def slider_velocity(examples: Examples) -> Numbers:
    """Error of I12I24 ω2 as the slider's velocity, with both values in cm/s (p. 10)."""
    study = posed(examples, SLIDER_CRANK)
    arms = ratio_arms(study.centres, "link4", "link2")
    omega = float(study.angular_velocities()[2][0])
    by_centre = abs(float(arms.base_arm[0]) * omega)
    true = abs(complex(study.linkage.bodies["link4"].origin[1][0])) * abs(study.omega)
    return {
        "off": abs(by_centre - true) / max(true, 1e-300),
        "bound": SMALL,
        "speed": by_centre / CM,
        "arm": float(arms.base_arm[0]) / CM,
    }


def six_bar(part: str) -> Callable[[Examples], Numbers]:
    """Function that compares p. 11, step A, B, C or D: distances [cm], speeds [rpm] and v6 [cm/s], absolute values."""

    def numbers(examples: Examples) -> Numbers:
        study = posed(examples, SIX_BAR)
        table = study.centres
        rpm = {n: abs(float(w[0])) / RPM for n, w in study.angular_velocities().items()}
        slider = abs(complex(study.points()["D"][1][0])) / CM
        rows: Mapping[str, Mapping[str, tuple[float, float, str]]] = {
            "A": {
                "I12I13": (20.07, abs(centre(table, 1, 2) - centre(table, 1, 3)) / CM, "cm"),
                "ω3": (6.64, rpm[3], "rpm"),
            },
            "B": {
                "I14I13": (16.39, abs(centre(table, 1, 4) - centre(table, 1, 3)) / CM, "cm"),
                "ω4": (20.57, rpm[4], "rpm"),
            },
            "C": {
                "I14I45": (6.0, abs(centre(table, 1, 4) - centre(table, 4, 5)) / CM, "cm"),
                "ω5": (20.57, rpm[5], "rpm"),
            },
            "D": {"v6": (22.39, slider, "cm/s")},
        }
        return {
            name: ComparedNumber(printed, computed, 0.5 * DIGIT, unit, DIGIT)
            for name, (printed, computed, unit) in rows[part].items()
        }

    return numbers


def link_chain(examples: Examples) -> list[tuple[str, str, float, float, float]]:
    """The lecture's sequence of links of the six-bar: body, base, their directed distances [cm] and the ratio."""
    table = posed(examples, SIX_BAR).centres
    rows = []
    for body, base in link_by_link(table, "link2"):
        arms = ratio_arms(table, body, base)
        lengths = float(arms.base_arm[0]) / CM, float(arms.body_arm[0]) / CM
        rows.append((f"ω{link_number(body)}", f"ω{link_number(base)}", *lengths, float(arms.ratio[0])))
    return rows


PRINTED_COUPLER = 69.0  # mm
ROCKER = 60.0  # [deg] of the lecture's triangle with the angles 45°, 120°, 15°


def coupler(examples: Examples) -> Numbers:
    """Deviation of the rocker from the lecture's 60° [deg], with the printed coupler and the example's (p. 11).

    The example's coupler must be the printed one to its last digit.
    """
    design = examples.design(SIX_BAR)
    path = "linkage.links[2].points.B"

    def rocker(study: Study) -> float:
        return float(np.rad2deg(study.linkage.bodies["link4"].turn[0][0])) % 360.0

    def at_45(changed: Any) -> Study:
        return Study(changed, 8).at_theta(np.array([radians(ANGLES[SIX_BAR])]))

    example_length = next(
        p for link in design.drive.linkage.links if link.number == 3 for p in link.points if p.name == "B"
    ).x_mm
    ends = (
        20.0 * complex(cos(radians(45.0)), sin(radians(45.0))),
        60.0 + 40.0 * complex(cos(radians(ROCKER)), sin(radians(ROCKER))),
    )
    printed = at_45(put(design, path, (PRINTED_COUPLER, 0.0)))
    speeds = [abs(float(study.angular_velocities()[3][0])) / RPM for study in (printed, at_45(design))]
    off = abs(rocker(at_45(design)) - ROCKER) if round(example_length) == PRINTED_COUPLER else inf
    return {
        "printed": abs(rocker(printed) - ROCKER),
        "corrected": off,
        "bound": 1e-6,
        "own": example_length / 10.0,
        "required": abs(ends[1] - ends[0]) / 10.0,
        "rocker": rocker(printed),
        "omega_3": speeds[0],
        "own_omega_3": speeds[1],
    }


TRACK = 1.45  # [m] between the wheels of an axle: assumed, typical of a car of 1970; the lecture has no number


def axle(examples: Examples) -> Mapping[str, np.ndarray]:
    """Position of the wheel along the car and its height, rotation of its link, and steer angle of the axle (p. 12).

    The steer angle is atan(Δx/track), Δx between the wheels along the car, with the other wheel fixed at the start of
    the turn
    (`standing`), and in opposite bump (`opposite`), as in the example's motion run backwards.

    Returns
    -------
    dict of ndarray (n,) [mm] or [deg]
        By driver angle.
    """
    study = examples.study(SUSPENSION)
    wheel = study.linkage.bodies["link3"]
    position = wheel.point("W")[0]
    along = position.real
    across = {"standing": along - along[0], "opposite": along - np.roll(along[::-1], 1)}
    steer = {name: np.rad2deg(np.arctan(gap / TRACK)) for name, gap in across.items()}
    return {"along": along * 1e3, "up": position.imag * 1e3, "rotation": np.rad2deg(wheel.turn[0]), **steer}


def steering(examples: Examples) -> Numbers:
    """Travel of the wheel up and along the car over a bump [mm], and the largest steer angles [deg] (p. 12).

    `off` is the deviation of its velocity from the circle about I13.
    """
    study = examples.study(SUSPENSION)
    wheel = study.linkage.bodies["link3"].point("W")
    pole = study.centres.centre("frame", "link3").finite
    arm = wheel[0] - pole
    is_moving = np.abs(wheel[1]) > 1e-9 * np.abs(wheel[1]).max()
    across = np.abs((wheel[1] * arm.conjugate()).real[is_moving]) / (np.abs(wheel[1]) * np.abs(arm))[is_moving]
    steer = axle(examples)
    return {
        "up": float(np.ptp(wheel[0].imag)) * 1e3,
        "along": float(np.ptp(wheel[0].real)) * 1e3,
        "off": float(across.max()),
        **{name: float(np.abs(steer[name]).max()) for name in ("standing", "opposite")},
        "track": TRACK * 1e3,
    }


def steers(up: float, along: float, off: float, standing: float, opposite: float, track: float) -> tuple[str, str]:
    """Judge p. 12: whether the wheel moves along the car, so that the axle steers."""
    words = (
        f"over a bump of {up:.4g} mm the wheel moves {along:.4g} mm along the car, across its line to I13 to {off:.1g}: the axle steers "
        f"by atan(Δx/track), Δx from wheel to wheel along the car: up to {standing:.3f}° with the other wheel fixed, {opposite:.3f}° "
        f"with it in opposite bump (track {track:g} mm, assumed; the lecture has none)"
    )
    return ("agrees" if along > 1.0 and off < 1e-6 and min(standing, opposite) > 0.0 else "differs"), words
