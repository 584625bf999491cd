"""The numbers of Shin1995's velocities, instant centre and cam shape, of the example's lift."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from typing import Any

import numpy as np

from core.design import require_motion, si
from core.papers.examples import Examples
from core.papers.shin1995.geometry import LIFT
from core.study import Study, extremes_of

SMALL = 1e-9

Numbers = Mapping[str, Any]


def _off(value: np.ndarray, true: np.ndarray) -> float:
    """The largest difference as a part of the largest true value."""
    return float(np.abs(value - true).max() / np.abs(true).max())


def largest(study: Study, stage: str, name: str) -> float:
    """The refined greatest size of a quantity over the turn."""
    found = extremes_of(study, stage, (name,))[name]
    return max(abs(found.low.value), abs(found.high.value))


def velocities(examples: Examples) -> Numbers:
    """(11)-(14) as printed, evaluated at the angles and slider speeds of the study."""
    study = examples.study(LIFT)
    g = si(study.design.drive.follower)
    at, y = study.linkage.coordinates, study.motion.displacement
    (phi, phi1, phi2), (beta, beta1, beta2) = ([at[name][k] for k in range(3)] for name in ("phi", "beta"))
    d = phi - beta
    moving = np.abs(y[1]) > 0.0
    rod = y[1] * np.cos(phi) / (g.rod * np.sin(d))
    arm = y[1] * np.cos(beta) / (g.slider_arm * np.sin(-d))
    rod2 = (y[2] * np.cos(phi) + g.rod * beta1**2 * np.cos(d) + g.slider_arm * phi1**2) / (g.rod * np.sin(d))
    arm2 = (y[2] * np.cos(beta) + g.slider_arm * phi1**2 * np.cos(d) + g.rod * beta1**2) / (g.slider_arm * np.sin(-d))
    pairs = ((rod, beta1), (arm, phi1), (rod2, beta2), (arm2, phi2))
    return {"off": max(_off(a[moving], b[moving]) for a, b in pairs), "bound": SMALL}


def centre(examples: Examples) -> dict[str, np.ndarray]:
    """By cam angle (n,): Q on the line to the pivot [m], (18) as printed with φ' counter-clockwise, and with φ' against the
    cam's sense; the distances [m] by which the contact normal misses each; V_R by (16) and (17) per rad/s of the cam [m]."""
    study = examples.study(LIFT)
    g, shape = si(study.design.drive.follower), study.cam
    pivot = complex(g.pivot_x, g.pivot_y)
    zxy = abs(pivot)
    along = pivot / zxy
    turn = study.linkage.coordinates["phi"][1]
    against = -shape.sense * turn
    q = (shape.centre.finite * along.conjugate()).real
    with np.errstate(divide="ignore", invalid="ignore"):
        printed, corrected = zxy * turn / (1.0 + turn), zxy * against / (1.0 + against)

    def missed(place: np.ndarray) -> np.ndarray:
        return np.asarray(np.abs((shape.flank.normal.conjugate() * (place * along - shape.reference)).imag))

    return {
        "degrees": study.angle_degrees,
        "q": q,
        "printed": printed,
        "corrected": corrected,
        "missed printed": missed(printed),
        "missed corrected": missed(corrected),
        "roller": g.roller_arm * against,
        "by centre": q * g.roller_arm / (zxy - q),
    }


def roller_velocity(examples: Examples) -> Numbers:
    c, study = centre(examples), examples.study(LIFT)
    return {
        "off": _off(c["by centre"], c["roller"]),
        "bound": SMALL,
        "centre": largest(study, "cam", "instant_centre_velocity"),
        "roller": largest(study, "cam", "reference_velocity"),
    }


def centre_sign(examples: Examples) -> Numbers:
    c = centre(examples)
    printed, corrected = (float(np.abs(c[name] - c["q"]).max()) * 1e3 for name in ("printed", "corrected"))
    return {
        "printed": printed if np.isfinite(printed) else inf,
        "corrected": corrected,
        "bound": 1e-6,
        "missed": float(c["missed printed"].max()) * 1e3,
        "kept": float(c["missed corrected"].max()) * 1e3,
    }


def _contact(roller: np.ndarray, centre_at: np.ndarray, radius: float) -> np.ndarray:
    """(19), (20) in the frame whose x axis holds the centre (n,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        psi = np.arctan((centre_at - roller.real) / roller.imag)
    return np.asarray(roller + radius * (np.sin(psi) - 1j * np.cos(psi)))


def contact(examples: Examples) -> dict[str, np.ndarray]:
    """Contact points (n,) [m] in that frame: true, of the roller above the line and of its mirror image below; and by (19), (20)."""
    study = examples.study(LIFT)
    g, shape = si(study.design.drive.follower), study.cam
    along = complex(g.pivot_x, g.pivot_y)
    along /= abs(along)
    roller, true = (each * along.conjugate() for each in (shape.reference, shape.flank.contact))
    q = (shape.centre.finite * along.conjugate()).real
    radius = abs(shape.flank.radius)
    own = np.sign(roller.imag[0])
    as_if_above = (roller, true) if own > 0.0 else (roller.conjugate(), true.conjugate())
    below = tuple(each.conjugate() for each in as_if_above)
    found = {}
    for name, (place, touched) in (("above", as_if_above), ("below", below)):
        to_centre = (q - place) / np.abs(q - place)
        found[name], found[f"{name} printed"] = touched, _contact(place, q, radius)
        found[f"{name} corrected"] = place + radius * to_centre
    return found


def _in_global_axes(examples: Examples) -> float:
    """By how much (19), (20) miss the contact of the lift [mm] where R is not counted from the line to the pivot but from the axes."""
    study = examples.study(LIFT)
    g, shape = si(study.design.drive.follower), study.cam
    along = complex(g.pivot_x, g.pivot_y) / abs(complex(g.pivot_x, g.pivot_y))
    q = (shape.centre.finite * along.conjugate()).real
    return float(np.abs(_contact(shape.reference, q, abs(shape.flank.radius)) - shape.flank.contact).max()) * 1e3


def quadrant(examples: Examples) -> Numbers:
    """(19), (20) for the roller above the line to the pivot, as Fig. 4 draws it; for its mirror image below, and by the global axes [mm];
    corrected: along the relative velocity's normal, in both poses."""
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
    """Fig. 15: where the slider falls and rises [deg], and how far [mm]."""
    study = examples.study(LIFT)
    at, angles = 0.0, []
    for segment in require_motion(study.design).segments:
        if segment.rise:
            angles.append((at, at + segment.span_deg, segment.rise))
        at += segment.span_deg
    return {"strokes": tuple(angles)}


PRINTED_STROKES = ((35.0, 76.5, -150.0), (283.5, 325.0, 150.0))


def as_divided(strokes: tuple[tuple[float, float, float], ...]) -> tuple[str, str]:
    same = len(strokes) == len(PRINTED_STROKES) and np.allclose(strokes, PRINTED_STROKES, rtol=0.0, atol=1e-9)
    words = ", ".join(
        f"{'up' if rise > 0.0 else 'down'} {abs(rise):g} mm from {a:g}° to {b:g}°" for a, b, rise in strokes
    )
    return ("agrees" if same else "differs"), words


def joins(examples: Examples) -> Numbers:
    """Fig. 17: the largest jump of velocity and of acceleration at a join, as a part of its largest value."""
    study = examples.study(LIFT)
    y = study.motion.displacement
    jumps = [max(abs(float(join.jump[k])) for join in study.program.joins) for k in (1, 2)]
    sizes = [float(np.abs(y[k]).max()) for k in (1, 2)]
    ranges = extremes_of(study, "motion", ("velocity", "acceleration"))
    stroke = float(np.ptp(y[0]))
    span = np.deg2rad(max(s.span_deg for s in require_motion(study.design).segments if s.rise))
    largest = {name: max(abs(found.low.value), abs(found.high.value)) for name, found in ranges.items()}
    peaks = largest["velocity"] / study.omega, largest["acceleration"] / study.omega**2
    return {
        "off": max(jump / size for jump, size in zip(jumps, sizes, strict=True)),
        "bound": 1e-9,
        "velocity": peaks[0] * span / stroke,
        "acceleration": peaks[1] * span**2 / stroke,
    }


def shape(examples: Examples) -> Numbers:
    """Fig. 18: what the profile leaves of a closed curve without a cusp about the base circle [mm]."""
    study = examples.study(LIFT)
    flank = study.cam.flank
    found = extremes_of(study, "cam", ("radius", "pressure_angle"))
    base = si(study.design.drive.cam).base_radius
    sharpest = 1.0 - flank.radius * float(flank.pitch_curvature.max())
    reach = np.abs(study.cam.reference)
    low = float(found["radius"].low.value)
    return {
        "off": abs(low - base) * 1e3 if sharpest > 0.0 else inf,
        "bound": 1e-6,
        "least": low * 1e3,
        "near": float(reach.min()) * 1e3,
        "far": float(reach.max()) * 1e3,
        "angle": float(np.rad2deg(found["pressure_angle"].high.value)),
    }
