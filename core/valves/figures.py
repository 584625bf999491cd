"""Figures of the valves of a design as data, as a text, and the lift table of a lobe for the grinder."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, pi
from typing import Any

import numpy as np

from core.design import Design, nose_deg
from core.design.fields import choice, number
from core.dynamics import HelicalSpring
from core.errors import KindynaError, NoSolution
from core.frozen import frozen
from core.motion import program
from core.number_text import fixed_text, result_text
from core.requests import option
from core.study import Study, extremes_of, quantities_of
from core.study.piston import crank_at
from core.study.valve_findings import greatest_lift, least_clearance
from core.study.valve_springs import springs_of
from core.valves.pairs import valve_pairs
from core.valves.spring_speeds import Resonance, float_rpm, resonances
from core.valves.timing import LOBE, MM, VALVE, ValveTiming

INTENSITY = (0.1016, 0.1524, 0.508)
"""Lifts whose durations less that at 1.27 mm are the intensity of a lobe [mm]: 0.004, 0.006 and 0.020 inch."""
REFERENCE = 1.27
SHOWN_HARMONICS = 20
INCH = 25.4


# -- data -------------------------------------------------------------------------------------------------------


def valve_data(timings: Sequence[ValveTiming], lifts: Sequence[float]) -> dict[str, Any]:
    """Figures of valves, and of their pairs; what a design lacks is absent.

    Parameters
    ----------
    timings : sequence of ValveTiming
    lifts : sequence of float
        Lifts of the events [mm].

    Returns
    -------
    dict
        As the command prints it.
    """
    pairs = [
        _present(
            intake=pair.inlet.name,
            exhaust=pair.exhaust.name,
            separation_deg=pair.separation,
            advance_deg=pair.advance,
            overlap=[{"of": row.of, "at_mm": row.at_mm, "deg": row.deg} for row in pair.overlaps(lifts)],
            overlap_area_mm_deg=pair.overlap_area,
        )
        for pair in valve_pairs(timings)
    ]
    return {"valves": [_valve(timing, lifts) for timing in timings], "pairs": pairs}


def _present(**values: Any) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value is not None}


def _valve(timing: ValveTiming, lifts: Sequence[float]) -> dict[str, Any]:
    events = [event for lift in lifts for of in (LOBE, VALVE) if (event := timing.event(of, lift)) is not None]
    reference, speeds = timing.duration(REFERENCE), timing.velocities_at_lash
    intensity = {
        f"{lift:g}": duration - reference
        for lift in INTENSITY
        if reference is not None and (duration := timing.duration(lift)) is not None
    }
    return _present(
        drive=timing.name,
        centre_deg=timing.centre,
        lash_mm=timing.valve.lash_mm,
        lobe_lift_mm=timing.greatest_lobe_lift if timing.has_lobe_lift else None,
        valve_lift_mm=timing.greatest_valve_lift if timing.has_valve_lift else None,
        events=[
            {
                "of": event.of,
                "at_mm": event.at_mm,
                "opens_deg": event.opens_deg,
                "closes_deg": event.closes_deg,
                "duration_deg": event.duration_deg,
            }
            for event in events
        ],
        lift_at_tdc_mm=float(timing.valve_lift(np.zeros(1))[0]) if timing.has_valve_lift else None,
        intensity_deg=intensity or None,
        **_study_figures(timing),
        opening_velocity_mm_s=speeds and speeds[0],
        seating_velocity_mm_s=speeds and speeds[1],
    )


def _study_figures(timing: ValveTiming) -> dict[str, Any]:
    """Velocity and acceleration by cam angle, radii of the profile, diameter of a flat tappet, float speed."""
    study = Study(timing.design)
    figures: dict[str, Any] = _motion_figures(study) if timing.has_lobe_lift else {}
    if not study.has_disk:
        return figures
    try:
        return figures | _profile_figures(timing, study) | _train_figures(study)
    except NoSolution:
        return figures


def _motion_figures(study: Study) -> dict[str, Any]:
    per_degree = np.deg2rad(1.0) / abs(study.omega)
    motion = extremes_of(study, "motion", ("velocity", "acceleration"))
    return {
        name: [end.value * MM * per_degree**order for end in (motion[quantity].low, motion[quantity].high)]
        for order, (name, quantity) in enumerate(
            (("velocity_mm_per_deg", "velocity"), ("acceleration_mm_per_deg2", "acceleration")), 1
        )
    }


def _profile_figures(timing: ValveTiming, study: Study) -> dict[str, Any]:
    cam = extremes_of(study, "cam")
    low, high = (end.value / MM for end in (cam["profile_curvature"].low, cam["profile_curvature"].high))
    face = cam.get("contact_on_face")
    width = timing.design.drive.cam.thickness_mm or 0.0
    reach = None if face is None else MM * max(abs(face.low.value), abs(face.high.value))
    return _present(
        least_tappet_diameter_mm=None if reach is None else 2.0 * hypot(reach, 0.5 * width),
        convex_radius_mm=1.0 / high if high > 0.0 else None,
        concave_radius_mm=-1.0 / low if low < 0.0 else None,
    )


def _train_figures(study: Study) -> dict[str, Any]:
    """Range of the rocker's ratio, engine speed at which the follower leaves the cam, and the valve springs."""
    figures: dict[str, Any] = {}
    if "rocker_ratio" in quantities_of(study, "linkage"):
        ratio = extremes_of(study, "linkage", ("rocker_ratio",))["rocker_ratio"]
        figures["rocker_ratio"] = [ratio.low.value, ratio.high.value]
    figures |= _present(float_rpm=float_rpm(study))
    if springs := springs_of(study.design):
        lift = greatest_lift(study)
        figures["springs"] = [_spring(*pair, lift) for pair in zip(springs, resonances(study), strict=True)]
    return figures | _present(clearance=_clearance(study))


def _clearance(study: Study) -> dict[str, float] | None:
    least = least_clearance(study)
    if least is None:
        return None
    return {
        "least_mm": MM * least.value,
        "crank_deg": float(crank_at(study, least.theta)),
    }


def _spring(spring: HelicalSpring, harmonics: Sequence[Resonance], lift: float) -> dict[str, Any]:
    """Figures of a spring up to the greatest lift [m] of the valve, with the harmonics of the lift that it meets."""
    return _present(
        rate_n_per_mm=1e-3 * spring.rate,
        seat_n=spring.force(0.0),
        open_n=spring.force(lift),
        bind_mm=MM * (spring.room - lift),
        stress_mpa=[1e-6 * spring.stress(0.0), 1e-6 * spring.stress(lift)],
        natural_hz=spring.natural / (2.0 * pi),
        goodman=spring.safety(lift),
        harmonics=[
            {"n": row.n, "lift_mm": row.lift_mm, "resonance_rpm": row.engine_rpm} for row in harmonics[:SHOWN_HARMONICS]
        ],
    )


# -- text -------------------------------------------------------------------------------------------------------


def crank_text(degrees: float) -> str:
    """Crank angle from TDC of overlap by its nearest dead centre: ``20 BTDC``, ``67 ABDC``."""
    if abs(degrees) <= 90.0:
        return f"{fixed_text(abs(degrees), 2)} {'BTDC' if degrees < 0.0 else 'ATDC'}"
    past = degrees - 180.0 if degrees > 0.0 else degrees + 180.0
    return f"{fixed_text(abs(past), 2)} {'BBDC' if past < 0.0 else 'ABDC'}"


FIGURES = (
    ("lift_at_tdc_mm", "valve lift at TDC", "mm"),
    ("velocity_mm_per_deg", "velocity", "mm/deg"),
    ("acceleration_mm_per_deg2", "acceleration", "mm/deg²"),
    ("least_tappet_diameter_mm", "least diameter of the tappet", "mm"),
    ("convex_radius_mm", "least convex radius", "mm"),
    ("concave_radius_mm", "least concave radius", "mm"),
    ("opening_velocity_mm_s", "opening velocity", "mm/s"),
    ("seating_velocity_mm_s", "seating velocity", "mm/s"),
    ("rocker_ratio", "rocker ratio", ""),
    ("float_rpm", "float speed of the engine", "rpm"),
)
"""Key of the data -> its words and unit."""


SPRING_FIGURES = (
    ("rate_n_per_mm", "rate", "N/mm"),
    ("seat_n", "force of the closed valve", "N"),
    ("open_n", "force at the greatest lift", "N"),
    ("bind_mm", "travel left to coil bind", "mm"),
    ("stress_mpa", "corrected stress", "MPa"),
    ("goodman", "safety against fatigue (Goodman)", ""),
    ("natural_hz", "natural frequency", "Hz"),
)


def _lines(figures: dict[str, Any], rows: Sequence[tuple[str, str, str]], indent: str) -> list[str]:
    lines = []
    for key, words, unit in rows:
        if key in figures:
            values = figures[key] if isinstance(figures[key], list) else [figures[key]]
            lines.append(f"{indent}{words}: {' ... '.join(result_text(v, 6) for v in values)} {unit}".rstrip())
    return lines


def valve_text(data: dict[str, Any]) -> str:
    """Figures of valves in lines."""
    lines: list[str] = []
    for valve in data["valves"]:
        lifts = [
            f"{words} {result_text(valve[key], 6)} mm"
            for key, words in (("lobe_lift_mm", "lobe lift"), ("valve_lift_mm", "valve lift"))
            if key in valve
        ]
        centre, lash = f"centre {result_text(valve['centre_deg'], 6)} deg", f"lash {valve['lash_mm']:g} mm"
        lines.append(f"{valve['drive']}: {', '.join((centre, *lifts, lash))}")
        for event in valve["events"]:
            opens, closes = crank_text(event["opens_deg"]), crank_text(event["closes_deg"])
            duration = fixed_text(event["duration_deg"], 2)
            lines.append(f"  {event['of']} at {event['at_mm']:g} mm: opens {opens}, closes {closes}, {duration} deg")
        for lift_mm, value in valve.get("intensity_deg", {}).items():
            lines.append(f"  intensity {lift_mm} to {REFERENCE:g} mm: {fixed_text(value, 2)} deg")
        lines += _lines(valve, FIGURES, "  ")
        if "clearance" in valve:
            least, crank = (valve["clearance"][key] for key in ("least_mm", "crank_deg"))
            lines.append(f"  least clearance to the piston: {result_text(least, 6)} mm at {crank_text(crank)}")
        for spring in valve.get("springs", ()):
            lines += ["  valve spring", *_lines(spring, SPRING_FIGURES, "    ")]
            lines += [
                f"    harmonic {row['n']}: {result_text(row['lift_mm'], 6)} mm, resonance at {result_text(row['resonance_rpm'], 6)} rpm"
                for row in spring["harmonics"]
            ]
    for pair in data["pairs"]:
        separation, advance = (result_text(pair[key], 6) for key in ("separation_deg", "advance_deg"))
        lines.append(f"{pair['intake']}, {pair['exhaust']}: separation {separation} deg, advance {advance} deg")
        lines += [
            f"  overlap of the {row['of']} at {row['at_mm']:g} mm: {fixed_text(row['deg'], 2)} deg"
            for row in pair["overlap"]
        ]
        if "overlap_area_mm_deg" in pair:
            lines.append(f"  overlap area: {result_text(pair['overlap_area_mm_deg'], 6)} mm·deg")
    return "\n".join(lines) + "\n"


# -- table for the grinder --------------------------------------------------------------------------------------


@frozen(kw_only=True)
class LiftTableRequest:
    """Step and unit of a lift table."""

    step: float = option(
        number("Step", 0.001, 360.0, default=1.0, help="of the table, in degrees; it divides 360"), "--step"
    )
    unit: str = option(choice("Unit", ("mm", "in"), default="mm", help="of the lift in the table"))


def lift_table(design: Design, step_deg: float = 1.0, unit: str = "mm") -> tuple[tuple[str, str], list[np.ndarray]]:
    """Lift of the motion of one drive by cam angle from its nose, -180 to 180 degrees with both ends.

    Parameters
    ----------
    design : Design
        With one drive.
    step_deg : float
        Step [deg], which divides 360.
    unit : "mm" or "in"

    Returns
    -------
    names : tuple of str
        Names of both columns.
    columns : list of ndarray (n,) [deg], [mm or in]

    Raises
    ------
    KindynaError
        For a step that does not divide the turn, or a drive without a motion in mm.
    """
    motion = design.drive.motion
    if motion is None or motion.unit != "mm":
        raise KindynaError("valve --table: this drive has no motion in mm; allowed: a lobe, or segments in mm")
    count = table_steps(step_deg)
    angles = 360.0 * np.arange(count + 1) / count - 180.0
    compiled = program(motion)
    theta = np.deg2rad(nose_deg(motion) + angles)
    lift = (compiled.state(compiled.angles(theta)).displacement[0] * MM) - motion.start
    return ("cam_deg_from_nose", f"lift_{unit}"), [angles, lift / (INCH if unit == "in" else 1.0) + 0.0]


def table_steps(step_deg: float) -> int:
    """Number of steps of a lift table over the turn. Raises KindynaError for a step [deg] that does not divide it."""
    count = round(360.0 / step_deg)
    if count < 1 or abs(count * step_deg - 360.0) > 1e-9 * 360.0:
        raise KindynaError(f"--step = {step_deg:g}: does not divide the turn; allowed: 360 deg over a whole number")
    return count
