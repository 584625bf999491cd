"""The numbers of the lecture's centres, constructions and velocities, of the example linkages."""

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
"""Driver angle [deg] at which each is drawn; the lecture's crank stands at 45°."""
MOVING = {SIX_BAR: "six-bar", SLIDER_CRANK: "slider-crank", SUSPENSION: "suspension"}
"""Examples with masses, in words."""
CM, RPM = 0.01, pi / 30.0
DIGIT = 0.01  # the last one that is printed: what the lecture's rounding of intermediates moves
SMALL = 1e-9

Numbers = Mapping[str, Any]


def posed(examples: Examples, name: str) -> Study:
    """An example at its angle."""
    study: Study = examples.once(
        ("posed", name), lambda: examples.study(name).at_theta(np.array([radians(ANGLES[name])]))
    )
    return study


def centre(table: CentreTable, a: int, b: int) -> complex:
    return complex(table.of(body_name(a), body_name(b)).finite[0])


def label(key: tuple[str, str]) -> str:
    """``I13``."""
    return "I" + "".join(str(link_number(body)) for body in key)


# -- pp. 1 to 5: definitions -------------------------------------------------------------------------------


def stored(examples: Examples) -> Mapping[str, np.ndarray]:
    """Kinetic energy [J] of the examples with masses over their turn, by name."""
    return {name: quantity("kinetic_energy").value(examples.study(name)) for name in MOVING}


def energy(examples: Examples) -> Numbers:
    """p. 1: least and largest kinetic energy [J] of each example with masses; and by how much that of a link that turns, about its
    centre of velocity I1n, ½(I + m |c - I1n|²)ω², is off ½m v² + ½Iω² [of the largest]."""
    off = 0.0
    for name in MOVING:
        study = examples.study(name)
        speeds = study.angular_velocities()
        for mass in study.design.drive.loads.masses:
            body = study.linkage.bodies[body_name(mass.link)]
            omega = np.asarray(speeds[mass.link])
            turns = np.abs(omega) > 1e-3 * max(float(np.abs(each).max()) for each in speeds.values())
            if not turns.any():
                continue
            own = quantity(f"kinetic_energy.{body_name(mass.link)}").value(study)
            place = body.fixed_point(complex(mass.centre_x_mm, mass.centre_y_mm) * 1e-3)[0]
            pole = study.centres.of("frame", body_name(mass.link)).finite
            about = 0.5 * (mass.inertia_kg_m2 + mass.mass_kg * np.abs(place - pole)[turns] ** 2) * omega[turns] ** 2
            off = max(off, float(np.abs(about - own[turns]).max() / own.max()))
    return {"stored": {name: (float(e.min()), float(e.max())) for name, e in stored(examples).items()}, "off": off}


def as_stored(stored: Mapping[str, tuple[float, float]], off: float) -> tuple[str, str]:
    each = ", ".join(f"the {MOVING[name]} {low + 0.0:.4g} … {high:.4g} J" for name, (low, high) in stored.items())
    words = f"stored over the turn: {each} (masses assumed); a link's about its centre I1n is the same to {off:.1g}"
    return ("agrees" if all(0.0 <= low < high for low, high in stored.values()) and off < 1e-6 else "differs"), words


def crank_velocity(examples: Examples) -> Numbers:
    """Of the crank pin of the six-bar over the turn, against jωR."""
    study = examples.study(SIX_BAR)
    place, velocity = study.points()["A"]
    turned = 1j * study.omega * place
    off = float(np.abs(velocity - turned).max() / np.abs(turned).max())
    return {"off": off, "bound": SMALL, "crank_pin": float(np.abs(velocity[0])) / CM}


def differences(examples: Examples) -> Numbers:
    """V_P - V_A - V_PA of every pair of points of the six-bar over the turn, and V_PA along P - A of those of one link."""
    study = examples.study(SIX_BAR)
    rows = list(velocity_differences(study.linkage))
    size = max(float(np.abs(row.v_p).max()) for row in rows)
    return {
        "off": max(float(np.abs(row.v_a + row.v_pa - row.v_p).max()) for row in rows) / size,
        "bound": SMALL,
        "count": len(rows),
    }


def count(name: str) -> Callable[[Examples], Numbers]:
    """How many centres, how many of them at sight, and n(n - 1)/2."""

    def numbers(examples: Examples) -> Numbers:
        table = posed(examples, name).centres
        n = len(table.bodies)
        return {
            "found": len(table.centres),
            "formula": n * (n - 1) // 2,
            "links": n,
            "sight": len(table.construction.known),
        }

    return numbers


def as_counted(printed: int) -> Callable[..., tuple[str, str]]:
    def judge(found: int, formula: int, links: int, sight: int) -> tuple[str, str]:
        words = f"{links} links have {found} centres, {sight} of them at sight"
        return ("agrees" if found == formula == printed else "differs"), words

    return judge


def on_one_line(examples: Examples) -> Numbers:
    """By how much the three centres of any three links of the six-bar miss a line, as unit vectors, over the turn; and where I13 is
    beyond the ends of link 3 [of its length]."""
    study = examples.study(SIX_BAR)
    there = posed(examples, SIX_BAR)
    ends = [complex(there.points()[name][0][0]) for name in ("A", "B")]
    along = (centre(there.centres, 1, 3) - ends[0]) / (ends[1] - ends[0])
    return {"off": float(collinearity(study.centres).max()), "bound": 1e-7, "outside": abs(along - 0.5) - 0.5}


# -- pp. 6 to 8: constructions -----------------------------------------------------------------------------


def step(name: str, number: int) -> Callable[[Examples], Numbers]:
    """One step of the circle diagram: the centre wanted, its lines, where they cross [mm] and where the velocities put it."""

    def numbers(examples: Examples) -> Numbers:
        table = posed(examples, name).centres
        steps = table.construction.steps
        if number > len(steps):
            return {"name": "", "lines": (), "place": complex(inf), "off": inf, "bound": SMALL, "far": False}
        wanted = steps[number - 1]
        crossing, by_velocity = kennedy(table.centres, wanted, table.size).scaled(table.size), table.centres[wanted.key]
        far = bool(by_velocity.far(table.size)[0])
        a, b = (
            np.array([c.point[0].real / table.size, c.point[0].imag / table.size, c.weight[0]])
            for c in (crossing, by_velocity)
        )
        return {
            "name": label(wanted.key),
            "lines": tuple(f"{label(t.first)}-{label(t.second)}" for t in wanted.triangles[:2]),
            "place": complex(by_velocity.finite[0]) * 1e3 if not far else complex(inf),
            "far": far,
            "off": float(np.linalg.norm(np.cross(a, b))),
            "bound": 1e-7,
        }

    return numbers


def crossed(name: str, lines: tuple[str, ...], place: complex, off: float, bound: float, far: bool) -> tuple[str, str]:
    if not name:
        return "differs", "there is no such step"
    where = "at infinity" if far else f"({round(place.real, 4) + 0.0:.4f}, {round(place.imag, 4) + 0.0:.4f}) mm"
    words = f"{name} where {' and '.join(lines)} cross: {where}, {off:.1g} off the one by velocities"
    return ("agrees" if off <= bound and len(lines) == 2 else "differs"), words


# -- pp. 9 to 12: velocities -------------------------------------------------------------------------------


def ratios(name: str) -> Callable[[Examples], Numbers]:
    """ω_j/ω_i by the distances between centres against that of the links, of all that turn."""

    def numbers(examples: Examples) -> Numbers:
        study = posed(examples, name)
        table, speeds = study.centres, study.angular_velocities()
        driver = study.design.drive.linkage.driver.link
        found, worst = {}, 0.0
        for number, omega in speeds.items():
            if number not in (1, driver):
                by_centres = float(angular_ratio(table, body_name(number), body_name(driver))[0])
                true = float(omega[0]) / float(speeds[driver][0])
                found[f"ω{number}/ω{driver}"] = by_centres
                worst = max(worst, abs(by_centres - true))
        return {
            "off": worst,
            "bound": SMALL,
            "found": ", ".join(f"{key} = {value:.6f}" for key, value in found.items()),
        }

    return numbers


def slider_velocity(examples: Examples) -> Numbers:
    """p. 10: the slider's velocity against I12I24 ω2 [cm/s]."""
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
    """p. 11, step A, B, C or D: distances [cm], speeds [rpm] and v6 [cm/s] as printed and here, sizes alone."""

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
            name: ComparedNumber(printed, here, 0.5 * DIGIT, unit, DIGIT)
            for name, (printed, here, unit) in rows[part].items()
        }

    return numbers


def link_chain(examples: Examples) -> list[tuple[str, str, float, float, float]]:
    """The lecture's way through the six-bar: body, base, the two directed distances [cm] and the ratio."""
    table = posed(examples, SIX_BAR).centres
    found = []
    for body, base in link_by_link(table, "link2"):
        arms = ratio_arms(table, body, base)
        lengths = float(arms.base_arm[0]) / CM, float(arms.body_arm[0]) / CM
        found.append((f"ω{link_number(body)}", f"ω{link_number(base)}", *lengths, float(arms.ratio[0])))
    return found


PRINTED_COUPLER = 69.0  # mm
ROCKER = 60.0  # deg, of the triangle whose angles the lecture takes: 45°, 120°, 15°


def coupler(examples: Examples) -> Numbers:
    """p. 11: by how many degrees the rocker misses the 60° of the lecture's triangle, with the printed coupler and the example's, which
    must be the printed one to the digit that is printed."""
    design = examples.design(SIX_BAR)
    path = "linkage.links[2].points.B"

    def rocker(study: Study) -> float:
        return float(np.rad2deg(study.linkage.bodies["link4"].turn[0][0])) % 360.0

    def at_45(changed: Any) -> Study:
        return Study(changed, 8).at_theta(np.array([radians(ANGLES[SIX_BAR])]))

    own = next(p for link in design.drive.linkage.links if link.number == 3 for p in link.points if p.name == "B").x_mm
    ends = (
        20.0 * complex(cos(radians(45.0)), sin(radians(45.0))),
        60.0 + 40.0 * complex(cos(radians(ROCKER)), sin(radians(ROCKER))),
    )
    printed = at_45(put(design, path, (PRINTED_COUPLER, 0.0)))
    speeds = [abs(float(each.angular_velocities()[3][0])) / RPM for each in (printed, at_45(design))]
    off = abs(rocker(at_45(design)) - ROCKER) if round(own) == PRINTED_COUPLER else inf
    return {
        "printed": abs(rocker(printed) - ROCKER),
        "corrected": off,
        "bound": 1e-6,
        "own": own / 10.0,
        "asked": abs(ends[1] - ends[0]) / 10.0,
        "rocker": rocker(printed),
        "omega_3": speeds[0],
        "own_omega_3": speeds[1],
    }


TRACK = 1.45  # m, between the wheels of an axle: assumed, as usual for a car of 1970; the lecture has no number


def axle(examples: Examples) -> Mapping[str, np.ndarray]:
    """p. 12: the wheel's place along the car and its height [mm] and the turn of its link [deg], by driver angle; and the steer angle
    of the axle [deg], atan(Δx/track), Δx from wheel to wheel along the car: with the other wheel standing where the turn begins, and
    with it in opposite bump: its arm as far the other way, as in the example's motion run backwards."""
    study = examples.study(SUSPENSION)
    wheel = study.linkage.bodies["link3"]
    place = wheel.point("W")[0]
    along = place.real
    across = {"standing": along - along[0], "opposite": along - np.roll(along[::-1], 1)}
    steer = {name: np.rad2deg(np.arctan(gap / TRACK)) for name, gap in across.items()}
    return {"along": along * 1e3, "up": place.imag * 1e3, "turned": np.rad2deg(wheel.turn[0]), **steer}


def steering(examples: Examples) -> Numbers:
    """p. 12: how far the wheel moves up and along the car over a bump [mm], how far that is off the circle about I13 [part], and the
    largest steer angle of the axle [deg] with the other wheel standing and in opposite bump."""
    study = examples.study(SUSPENSION)
    wheel = study.linkage.bodies["link3"].point("W")
    pole = study.centres.of("frame", "link3").finite
    arm = wheel[0] - pole
    moving = np.abs(wheel[1]) > 1e-9 * np.abs(wheel[1]).max()
    across = np.abs((wheel[1] * arm.conjugate()).real[moving]) / (np.abs(wheel[1]) * np.abs(arm))[moving]
    steer = axle(examples)
    return {
        "up": float(np.ptp(wheel[0].imag)) * 1e3,
        "along": float(np.ptp(wheel[0].real)) * 1e3,
        "off": float(across.max()),
        **{name: float(np.abs(steer[name]).max()) for name in ("standing", "opposite")},
        "track": TRACK * 1e3,
    }


def steers(up: float, along: float, off: float, standing: float, opposite: float, track: float) -> tuple[str, str]:
    words = (
        f"over a bump of {up:.4g} mm the wheel moves {along:.4g} mm along the car, across its line to I13 to {off:.1g}: the axle steers "
        f"by atan(Δx/track), Δx from wheel to wheel along the car: up to {standing:.3f}° with the other wheel standing, {opposite:.3f}° "
        f"with it in opposite bump (track {track:g} mm, assumed; the lecture has none)"
    )
    return ("agrees" if along > 1.0 and off < 1e-6 and min(standing, opposite) > 0.0 else "differs"), words
