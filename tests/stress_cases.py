"""Where formulas break: designs led by one number towards a place where something vanishes, and how far our error stays
below what the conditions of fifty-digit values allow. The tests assert it, the benchmark draws it.

A sample's ``bound`` is what one rounding of every number that goes in does at worst (``references.sensitivity``), times
the roundings on the way, as in the tests of each stage; near a singular place it grows as it must, and no faster.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from dyad_cases import DYAD_CASES, DYAD_ROUNDINGS, DyadCase
from kim_edges import edge
from mechanisms import (
    LAYOUT_DESIGNS,
    LIFT,
    PUSHER,
    levels,
    posed,
    with_cam,
    with_drive,
    with_follower,
    with_loads,
    with_shaft,
)
from references import (
    EPS,
    LAW_TERMS,
    MP,
    Series,
    Solved,
    apart,
    cam_shape,
    direction,
    free_bodies,
    motion_series,
    off,
    placed,
    sensitivity,
    two_circles,
)
from rods import arm_and_rod, metres
from shafts import KIM, coefficients

from core.cam import relative_motion
from core.design import Design, si
from core.motion import TURN, CompiledMotion
from core.stability import Coefficients, tongues
from core.study import Study

LINKAGE_ROUNDINGS, CAM_ROUNDINGS, FORCE_ROUNDINGS = 30, 56, 86  # as derived in the tests of these stages
MOTION_ROUNDINGS = 24
POWERS = tuple(10.0**-k for k in range(1, 16))


@dataclass(frozen=True)
class Sample:
    """Of the figure that comes nearest to its bound: its error and the bound, both relative to the figure's size; the
    error of the paper's printed formula at the same place, NaN where there is none to compare."""

    error: float
    bound: float
    printed: float = math.nan

    @property
    def ratio(self) -> float:
        return self.error / self.bound


def worst(samples: Sequence[Sample]) -> Sample:
    return max(samples, key=lambda s: s.ratio if math.isfinite(s.ratio) else math.inf)


@dataclass(frozen=True)
class Case:
    """One way into trouble.

    name, axis  as drawn; values of the number that leads there, the worst last; look at one of them
    few         how many of the values the ordinary tests look at
    part        of the bound, some four times what our error takes of it at these: a digit that is lost is seen, though
                a worst case is far above what comes
    """

    name: str
    axis: str
    values: tuple[float, ...]
    look: Callable[[float], Sample]
    few: int = 2
    part: float = 0.05

    @property
    def some(self) -> tuple[float, ...]:
        """Spread over the values, first and last among them."""
        picked = {round(i * (len(self.values) - 1) / (self.few - 1)) for i in range(self.few)}
        return tuple(self.values[i] for i in sorted(picked))


# -- a stage at one cam angle -----------------------------------------------------------------------------


def there_at(study: Study, theta: float) -> tuple[Study, Solved]:
    """The study at one cam angle, and the same by geometry for the motion that the study has there."""
    there = study.at_theta(np.array([theta]))
    y = map(float, there.motion.y[:, 0])
    return there, placed(study.design, theta, Series([v / math.factorial(k) for k, v in enumerate(y)]))


def _samples(got: Sequence[complex], exact: Sequence[Any], sizes: Sequence[float], roundings: int) -> Sample:
    found = []
    for value, reference, size in zip(got, exact, sizes, strict=True):
        scale = float(abs(reference)) or size or 1.0
        found.append(Sample(off(value, reference) / scale, (roundings * EPS * size + math.ulp(0.0)) / scale))
    return worst(found)


def linkage(design: Design, theta: float) -> Sample:
    """Points of the linkage with three derivatives."""
    there, _ = there_at(Study(design), theta)

    def figures(design: Design, at: Solved) -> list[Any]:
        return [d for p in at.points.values() for d in p.derivatives]

    exact, size = sensitivity(figures, design, theta, there.motion.y[:, 0])
    kinematics = there.linkage
    pins = {"arm_pin": "arm", "slider_pin": "slider", "pivot": "arm"}
    names = [
        n
        for n in ("pivot", "arm_pin", "slider_pin", "roller")
        if (n in pins and "arm" in kinematics.bodies) or n == "roller"
    ]
    got = [
        complex(v)
        for n in names
        for v in (kinematics.bodies[pins[n]].point(n) if n in pins else kinematics.follower.z)[:, 0]
    ]
    sizes = [s + 2.0 * float(abs(e)) for s, e in zip(size, exact, strict=True)]
    return _samples(got, exact, sizes, LINKAGE_ROUNDINGS)


FLANK = (
    "pitch",
    "profile",
    "normal",
    "pressure_angle",
    "pitch_curvature",
    "pitch_curvature_slope",
    "profile_curvature",
)


def cam(design: Design, theta: float) -> Sample:
    """Pitch curve, profile, normal, pressure angle and curvatures."""
    there, _ = there_at(Study(design), theta)

    def figures(design: Design, at: Solved) -> list[Any]:
        s = cam_shape(design, at)
        return [
            s.pitch.c[0],
            s.profile,
            s.normal,
            s.pressure_angle,
            s.curvature.derivative(0),
            s.curvature.derivative(1),
            s.profile_curvature,
        ]

    exact, size = sensitivity(figures, design, theta, there.motion.y[:, 0])
    t, w, x = (float(abs(c[0])) for c in relative_motion(there.linkage, design.shaft.sense).all[1:])
    # a pressure angle near 0 is as good as the normal; curvatures are sums of products of t, w, x
    # and 1/(1/κ - Rr) passes on what κ has, by the square of 1/(1 - Rr κ)
    beyond = float(abs(exact[6] / exact[4])) ** 2 if exact[4] else 1.0
    floors = {
        "pressure_angle": 1.0,
        "pitch_curvature": w / t**2,
        "pitch_curvature_slope": x / t**2 + 3.0 * w**2 / t**3,
        "profile_curvature": beyond * w / t**2,
    }
    sizes = [s + floors.get(n, float(abs(e))) for n, s, e in zip(FLANK, size, exact, strict=True)]
    got = [complex(getattr(there.cam.flank, n)[0]) for n in FLANK]
    return _samples(got, exact, sizes, CAM_ROUNDINGS)


def forces(design: Design, theta: float) -> Sample:
    """Contact force, guide force and drive torque."""
    there, _ = there_at(Study(design), theta)
    way = int(there.motion.velocity_sign[0])
    names = ("normal", "contact", "torque")

    def figures(design: Design, at: Solved) -> list[Any]:
        told = free_bodies(design, at, way)
        return [told[n] for n in names]

    exact, size = sensitivity(figures, design, theta, there.motion.y[:, 0], ("follower", "cam", "shaft", "loads"))
    sizes = [s + float(abs(e)) for s, e in zip(size, exact, strict=True)]
    sizes[0] += float(abs(exact[1]))  # a component of the contact force, which may vanish
    sizes[2] += float(abs(exact[1])) * abs(complex(there.cam.reference[0]))
    f = there.dynamics
    return _samples([f.guide.normal[0], f.contact[0], f.torque[0]], exact, sizes, FORCE_ROUNDINGS)


def motion(design: Design, theta: float) -> Sample:
    """Displacement and three derivatives."""
    program, drive = CompiledMotion(design.drive.motion), design.drive.motion
    state = program.state(program.angles(np.array([theta])))
    segment = int(program.segment[state.angles.piece[0]])
    part = drive.segments[segment]
    span, rise, terms = math.radians(part.span_deg), abs(part.rise) * drive.scale, LAW_TERMS[part.curve.law]
    sizes = [rise / span**k * (terms[k] + theta / span * terms[k + 1]) for k in range(4)]
    sizes[0] += drive.scale * (abs(drive.start) + sum(abs(s.rise) for s in drive.segments[: segment + 1]))
    exact = motion_series(drive, theta, segment).derivatives
    return _samples(list(state.y[:, 0]), exact, sizes, MOTION_ROUNDINGS)


# -- where something takes a value ------------------------------------------------------------------------


def angle_where(design: Design, quantity: Callable[[Study], np.ndarray], value: float, segment: int) -> float:
    """A cam angle within a segment at which the quantity has this value, by halving the interval."""
    study = Study(design)
    theta = np.linspace(*_inside(study, segment), 4000)

    def at(t: np.ndarray) -> np.ndarray:
        return quantity(study.at_theta(t)) - value

    values = at(theta)
    cell = int(np.flatnonzero(values[:-1] * values[1:] <= 0.0)[0])
    low, high, begin = float(theta[cell]), float(theta[cell + 1]), float(values[cell])
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return middle
        if float(at(np.array([middle]))[0]) * begin > 0.0:
            low = middle
        else:
            high = middle


def _inside(study: Study, segment: int) -> tuple[float, float]:
    """Beginning and end of a segment, a hair inside."""
    pieces = np.flatnonzero(study.program.segment == segment)
    begin, end = float(study.program.starts[pieces[0]]), float(study.program.ends[pieces[-1]])
    hair = 1e-6 * (end - begin)
    return begin + hair, end - hair


# -- the triangle -----------------------------------------------------------------------------------------


def _half_angle(p: float, q: float, r: float, goal: Any) -> float:
    """2 atan((-q ± √(p² + q² - r²))/(r - p)) as Shin1995 (9), (10) have it, with the better sign: its error."""
    with np.errstate(all="ignore"):
        root = np.sqrt(np.float64(p * p + q * q - r * r))
        told = [float(2.0 * np.arctan((-q + s * root) / np.float64(r - p))) for s in (1.0, -1.0)]
    errors = [apart(angle, goal) for angle in told if math.isfinite(angle)]
    return min(errors, default=math.inf)


def triangle(l1: float, l2: float, height: float, slider: float, sigma: float) -> Sample:
    """Both angles of arm and rod; the bound is 3 eps (1 + S/K), and half an ulp of an angle."""
    a, b, h = l1, l2, height
    l1, l2, height = map(metres, (l1, l2, height))
    pin_a = Series([slider + 1j * MP.mpf(height), 0, 0, 0])
    pin_b = two_circles(Series([0, 0, 0, 0]), MP.mpf(l1), pin_a, MP.mpf(l2), int(sigma))
    exact = [direction(pin_b).c[0], direction(pin_a - pin_b).c[0]]
    got = arm_and_rod(l1, l2, height, slider, sigma, float(exact[0]), float(exact[1]))
    r2 = slider**2 + height**2
    area = 2.0 * l1 * l2 * float(got.singular["pin"][0])
    bound = 3.0 * EPS * (1.0 + (r2 + l1**2 + l2**2) / area) + EPS * 0.5 * math.pi
    error = max(apart(got.coordinates[name][0][0], angle) for name, angle in zip(("phi", "beta"), exact, strict=True))
    poses = zip((got.bodies["arm"], got.bodies["rod"]), exact, strict=True)
    vectors = max(off(complex(pose.unit[0]), MP.expj(angle)) for pose, angle in poses)
    printed = max(
        _half_angle(2 * slider * a, 2 * h * a, b**2 - slider**2 - a**2 - h**2, exact[0]),
        _half_angle(2 * slider * b, 2 * h * b, a**2 - slider**2 - b**2 - h**2, exact[1]),
    )
    return Sample(max(error, vectors), bound, printed)


def rates(l1: float, l2: float, height: float, slider: float, sigma: float) -> Sample:
    """Three derivatives of both angles by the slider's place, for a slider as fast as its angle.

    The k-th falls like K^-(2k-1): of sides that are given K keeps 4 eps, what it is divided into some ten more.
    """
    l1, l2, height = map(metres, (l1, l2, height))
    pin_a = Series([slider + 1j * MP.mpf(height), 1, 0, 0])
    pin_b = two_circles(Series([0, 0, 0, 0]), MP.mpf(l1), pin_a, MP.mpf(l2), int(sigma))
    exact = [direction(pin_b).derivatives, direction(pin_a - pin_b).derivatives]
    got = arm_and_rod(l1, l2, height, slider, sigma, float(exact[0][0]), float(exact[1][0]))
    rows = zip((got.coordinates["phi"].all, got.coordinates["beta"].all), exact, strict=True)
    told = [(float(row[k, 0]), reference[k], k) for row, reference in rows for k in (1, 2, 3)]
    return worst(
        [Sample(off(value, right) / float(abs(right)), (10 + 4 * (2 * k - 1)) * EPS) for value, right, k in told]
    )


Sides = tuple[float, float, float, float, float]


def _stretched(distance: float) -> Sides:
    far = (1.3 + 0.8) * (1.0 - distance)
    return 1.3, 0.8, 0.3, math.sqrt((far - 0.3) * (far + 0.3)), 1.0


def _folded(distance: float) -> Sides:
    near = abs(0.31 - 0.94) * (1.0 + distance)
    return 0.31, 0.94, -0.2, -math.sqrt((near - 0.2) * (near + 0.2)), -1.0


def _alike(distance: float) -> Sides:
    """Arm and rod of all but one length, the slider near the pivot: a needle."""
    return 1.3, 1.3 * (1.0 + 0.5 * distance), 0.6 * 1.3 * distance, 0.8 * 1.3 * distance, 1.0


def _rod_backwards(short: float) -> Sample:
    """Rod at 180 degrees less a little: slider left of the arm's pin, level with it."""
    phi, beta = 1.6, math.pi - short
    height = 1.3 * math.sin(phi) + 0.8 * math.sin(beta) if short else 1.3 * math.sin(phi)
    slider = 1.3 * math.cos(phi) + 0.8 * (math.cos(beta) if short else -1.0)
    return triangle(1.3, 0.8, height, slider, math.copysign(1.0, math.sin(phi - beta)))


def _other_rod_backwards(short: float) -> Sample:
    """The same triangle on its other branch: the root that is not meant stands at 180 degrees."""
    phi, beta = 1.6, math.pi - short
    height = 1.3 * math.sin(phi) + 0.8 * math.sin(beta) if short else 1.3 * math.sin(phi)
    slider = 1.3 * math.cos(phi) + 0.8 * (math.cos(beta) if short else -1.0)
    return triangle(1.3, 0.8, height, slider, -math.copysign(1.0, math.sin(phi - beta)))


def _slider_over_pivot(away: float) -> Sample:
    return triangle(0.9, 0.8, 0.7, away, 1.0)


# -- dyads of any linkage ---------------------------------------------------------------------------------

_PUSHED = (0.0, 0.3 + 0.7j, -0.2 + 0.4j, 0.1 - 0.3j)
_STILL = (0.0, 0.0, 0.0, 0.0)
_UNIT = 1.0 + 0j


def _rod_across_slide(distance: float) -> Sample:
    """A rod of length 1 whose other end keeps to a line all but so far away: of sides that are given nothing is lost."""
    pins = ((0.0, _UNIT), (0.0, _UNIT), (1.0, _UNIT), (0.0, _UNIT), (1j * (1.0 - distance), _UNIT), (0.0, _UNIT))
    dyad = replace(DYAD_CASES["rrp"], pins=pins, numbers=(*_PUSHED, *_STILL, *_STILL, *_STILL))
    got, exact = dyad.solved(), dyad.exactly()
    rows = [(i, 2 * i + 1) for i in range(3)] + [
        (8, 1),
        (9, 1),
        (10, 3),
        (11, 5),
    ]  # and how often each is divided by the leg
    return worst([Sample(off(got[i], exact[i]) / float(abs(exact[i])), (10 + 4 * k) * EPS) for i, k in rows])


def _rods_in_line(distance: float) -> Sample:
    """Two rods between pins, all but stretched."""
    far = (1.3 + 0.8) * (1.0 - distance)
    pins = ((0.0, _UNIT), (0.0, _UNIT), (1.3, _UNIT), (0.8, _UNIT), (0.0, _UNIT), (0.0, _UNIT))
    return _of_dyad(replace(DYAD_CASES["rrr"], pins=pins, numbers=(*_PUSHED, *_STILL, far, *_PUSHED[:0:-1], *_STILL)))


def _guide_across(distance: float) -> Sample:
    """A guide that passes a pin at an offset that its distance from the other pin all but equals."""
    pins = ((0.0, _UNIT), (0.0, _UNIT), (0.4j, _UNIT), (0.0, _UNIT), (0.0, _UNIT), (0.0, _UNIT))
    return _of_dyad(
        replace(
            DYAD_CASES["rpr"], pins=pins, numbers=(*_PUSHED, *_STILL, 0.4 * (1.0 + distance), 0.0, 0.0, 0.0, *_STILL)
        )
    )


def _of_dyad(dyad: DyadCase) -> Sample:
    exact = dyad.exactly()
    sizes = [float(abs(e)) or 1.0 for e in exact]
    return worst([Sample(e / s, b / s) for (e, b), s in zip(dyad.errors(DYAD_ROUNDINGS), sizes, strict=True)])


# -- designs ----------------------------------------------------------------------------------------------

# Within ten degrees down and up again: the arm turns as fast as the cam, both ways.
STEEP = with_drive(LIFT, motion=levels(150.0, (170.0, 150.0, "dwell"), (10.0, 0.0, "cycloidal"), (10.0, 150.0, "cycloidal"),
                                       (170.0, 150.0, "dwell")))  # fmt: skip


def _as_fast_as_the_cam(by: float) -> Sample:
    """φ' - d = by: the instant centre goes to infinity; by Shin1995 (18)-(20) the profile with it."""
    theta = angle_where(STEEP, lambda s: s.linkage.follower.angle[1] - STEEP.shaft.sense, by, 1)
    sample = cam(STEEP, theta)
    there, here = there_at(Study(STEEP), theta)
    return replace(sample, printed=_printed_profile(there, here))


def _printed_profile(there: Study, here: Solved) -> float:
    """Error of the contact point by (18)-(20), relative to its distance, in the frame with the pivot on the x axis; on
    that side of the roller where it is less, for the arctangent tells one quadrant only."""
    d, kinematics = there.design.shaft.sense, there.linkage
    pivot = complex(kinematics.bodies["arm"].z[0, 0])
    along = pivot / abs(pivot)
    reference = complex(kinematics.follower.z[0, 0]) / along
    rate = -d * float(kinematics.follower.angle[1, 0])
    with np.errstate(all="ignore"):
        q = np.float64(abs(pivot) * rate) / np.float64(1.0 + rate)
        psi = float(np.arctan((q - reference.real) / np.float64(reference.imag)))
    radius = si(there.design.drive.cam).roller_radius
    exact = cam_shape(there.design, here).profile * MP.expj(d * here.theta)
    contacts = [(reference + side * radius * complex(math.sin(psi), -math.cos(psi))) * along for side in (1.0, -1.0)]
    return min(off(c, exact) for c in contacts) / float(abs(exact))


def swinging(spread: float) -> Design:
    """A long swing, from this angle between roller arm and line of centres on."""
    follower, cam_ = posed(
        "a",
        slider_arm=300.0,
        rod=420.0,
        arm_angle=2.2,
        rod_angle=-0.2,
        guide=0.3,
        pivot=complex(400.0, -30.0),
        roller_arm=110.0,
        spread=spread,
        roller_share=0.15,
    )
    motion_ = levels(0.0, (180.0, 440.0, "3-4-5"), (180.0, 0.0, "cycloidal"))
    return with_loads(with_drive(LAYOUT_DESIGNS["a"], mechanism=follower, cam=cam_, motion=motion_), friction=0.0)


# The roller passes from one side of the line of centres to the other, beyond the pivot; and at right angles to it.
SWING, UPRIGHT = swinging(1.9), swinging(1.2)


def _line_of_centres(s: Study) -> np.ndarray:
    """Sine between roller arm and line of centres: also the cosine of the pressure angle, up to a factor."""
    pivot = s.linkage.bodies["arm"].z[0]
    arm = s.linkage.follower.z[0] - pivot
    return (pivot.conj() * arm).imag / (np.abs(pivot) * np.abs(arm))


def _on_the_line(by: float) -> float:
    return angle_where(SWING, _line_of_centres, by, 0)


def _cam_on_the_line(by: float) -> Sample:
    return cam(SWING, _on_the_line(by))


def _cam_beyond_the_line(by: float) -> Sample:
    return cam(SWING, _on_the_line(-by))


def _forces_on_the_line(by: float) -> Sample:
    return forces(SWING, _on_the_line(by))


def _over_the_pivot(by: float) -> Sample:
    """Roller arm at right angles to the line of centres, less a little."""

    def cosine(s: Study) -> np.ndarray:
        pivot = s.linkage.bodies["arm"].z[0]
        arm = s.linkage.follower.z[0] - pivot
        return (pivot.conj() * arm).real / (np.abs(pivot) * np.abs(arm))

    return cam(UPRIGHT, angle_where(UPRIGHT, cosine, by, 0))


def _hardly_moves(after: float) -> Sample:
    """A follower that has hardly left its dwell: the normal all but along its guide."""
    central = with_follower(PUSHER, offset_mm=0.0)
    return cam(central, float(CompiledMotion(central.drive.motion).starts[1]) + after)


def _thin_tongue(q: float) -> Sample:
    """The second tongue of Kim1990's cam, whose width falls with Q, far below the step of any grid; the bound is what the
    tongues say of themselves."""
    found = tongues(kim_coefficients(), np.array([q]), 2)
    off_by = [abs(value - float(edge(2, value, MP.mpf(q), 30))) for value in found.edges[0, 1].tolist()]
    return Sample(max(off_by), float(found.error[0, 1]))


@cache
def kim_coefficients() -> Coefficients:
    return coefficients(KIM)


def _span(degrees: float) -> Sample:
    """A rise and a return within so many degrees each."""
    rest = (360.0 - 2.0 * degrees) / 2.0
    design = with_drive(
        PUSHER,
        motion=levels(
            0.0, (rest, 0.0, "dwell"), (degrees, 1.0, "cycloidal"), (rest, 1.0, "dwell"), (degrees, 0.0, "3-4-5")
        ),
    )
    theta = math.radians(rest + 0.37 * degrees)
    return worst([motion(design, theta), cam(design, theta)])


def _nearly_a_turn(short: float) -> Sample:
    """A rise that takes all of a turn but so many degrees, within which the follower comes back."""
    design = with_drive(PUSHER, motion=levels(0.0, (360.0 - short, 1.0, "cycloidal"), (short, 0.0, "3-4-5")))
    away = (0.37, 0.82), (360.0 - 0.63 * short, 360.0 - 0.3 * short)
    return worst([f(design, math.radians(degrees)) for degrees in away[0] + away[1] for f in (motion, cam)])


def _stroke(mm: float) -> Sample:
    motion_ = levels(0.0, (90.0, mm, "cycloidal"), (100.0, mm, "dwell"), (170.0, 0.0, "modified-sine"))
    design = with_drive(PUSHER, motion=motion_)
    return worst([f(design, t) for t in (0.7, 4.1) for f in (motion, cam)])


def many_segments(count: int) -> Design:
    """So many segments of one length, up and down in turn."""
    span, laws = 360.0 / count, ("cycloidal", "3-4-5", "modified-sine")
    steps = [(span, 1e-2 * ((7 * i) % 11) * (i < count - 1), laws[i % 3]) for i in range(count)]
    return with_drive(PUSHER, motion=levels(0.0, *steps))


def _segments(count: float) -> Sample:
    design = many_segments(int(count))
    return worst([motion(design, TURN * (i + 0.31) / count) for i in {0, int(count) // 3, int(count) - 1}])


PEAKED = with_drive(PUSHER, motion=levels(0.0, (60.0, 0.0, "dwell"), (60.0, 20.0, "cycloidal"), (60.0, 0.0, "cycloidal"),
                                          (180.0, 0.0, "dwell")))  # fmt: skip


def _undercut(by: float) -> Sample:
    """Roller radius times pitch curvature = 1 - by; negative: beyond the limit."""
    theta = 1.8
    curvature = float(cam_shape(PEAKED, there_at(Study(PEAKED), theta)[1]).curvature.c[0])
    radius = (1.0 - by) * 1e3 / curvature
    whole = PEAKED.drive.cam.base_radius_mm + PEAKED.drive.cam.roller_radius_mm
    return cam(with_cam(PEAKED, base_radius_mm=whole - radius, roller_radius_mm=radius), theta)


def _nearly_jammed(left: float) -> Sample:
    """Friction times the slope of the rod = 1 - left, on the way where friction feeds itself."""
    design = LAYOUT_DESIGNS["c"]
    theta = 1.5
    there, here = there_at(Study(with_loads(design, friction=0.0)), theta)
    slope = float(MP.tan(here.angles["beta"].c[0]))
    way = float(there.motion.velocity_sign[0])
    feeds = way * slope * math.copysign(1.0, float(there.dynamics.guide.normal[0])) < 0.0
    return forces(
        with_loads(design, friction=(1.0 - left) / abs(slope)) if feeds else _backwards(design, left, slope), theta
    )


def _backwards(design: Design, left: float, slope: float) -> Design:
    """With an outer force that turns the guide's force round."""
    return with_loads(
        design, friction=(1.0 - left) / abs(slope), external_force_n=-design.drive.loads.external_force_n * 20.0
    )


# The guide through the pivot: the rod stands across it where the slider is 223.6 mm away.
_LEVEL, _LEVEL_CAM = posed("a", slider_arm=300.0, rod=200.0, arm_angle=0.6, rod_angle=-math.asin(1.5 * math.sin(0.6)), guide=0.0,
                           pivot=complex(210.0, -40.0), roller_arm=180.0, spread=0.6, roller_share=0.2)  # fmt: skip
ACROSS = with_loads(
    with_drive(LAYOUT_DESIGNS["a"], mechanism=replace(_LEVEL, guide_height_mm=0.0), cam=_LEVEL_CAM,
               motion=levels(0.0, (180.0, -170.0, "cycloidal"), (180.0, 0.0, "3-4-5"))),
    friction=0.0,
)  # fmt: skip


def _rod_across(cosine: float) -> Sample:
    def of(s: Study) -> np.ndarray:
        return np.cos(s.linkage.coordinates["beta"][0])

    theta = angle_where(ACROSS, of, cosine, 0)
    return worst([linkage(ACROSS, theta), forces(ACROSS, theta)])


def _friction_turns(away: float) -> Sample:
    """The pusher's guide changes sides; so far from there [rad]."""
    theta = angle_where(PUSHER, lambda s: s.dynamics.guide.normal, 0.0, 3)
    return forces(PUSHER, theta + away)


def scaled(design: Design, by: float) -> Design:
    """The same machine so many times as large, of the same stuff at the same speed: masses by the cube, forces by the
    fourth power, so that every ratio stays."""
    drive = design.drive
    powers = {"_n_per_mm": 3, "_mm": 1, "mass_kg": 3, "_kg_m2": 5, "_n": 4, "gravity_m_s2": 1}  # the first that fits

    def larger(part: Any) -> Any:
        changed = {}
        for name, value in vars(part).items():
            power = next((p for ending, p in powers.items() if name.endswith(ending)), 0)
            if power and isinstance(value, float):
                changed[name] = value * by**power
        return replace(part, **changed)

    motion_ = replace(
        drive.motion,
        start=drive.motion.start * by,
        segments=tuple(replace(s, rise=s.rise * by) for s in drive.motion.segments),
    )
    parts = {
        "mechanism": larger(drive.mechanism),
        "cam": larger(drive.cam),
        "loads": larger(drive.loads),
        "motion": motion_,
    }
    return with_drive(with_shaft(design, flywheel_inertia_kg_m2=design.shaft.flywheel_inertia_kg_m2 * by**5), **parts)


def figures(design: Design, by: float, samples: int = 24) -> dict[str, np.ndarray]:
    """What a design gives, each divided by the power of the scale that it grows with."""
    study = Study(design, samples)
    kinematics, flank, force = study.linkage, study.cam.flank, study.dynamics
    told = {
        "y": study.motion.y / by, "roller": kinematics.follower.z / by, "profile": flank.profile / by,
        "pressure_angle": flank.pressure_angle, "pitch_curvature": flank.pitch_curvature * by,
        "profile_curvature": flank.profile_curvature * by, "contact": force.contact / by**4, "torque": force.torque / by**5,
        "guide": force.guide.normal / by**4, **{f"{n} {k}": c[k] for n, c in kinematics.coordinates.items() for k in range(4)
                                                if n in ("phi", "beta")},
    }  # fmt: skip
    return told


def _size(by: float) -> Sample:
    """Every figure of the lift, of another size, against the lift's own; both have the roundings of the forces."""
    one, other = figures(LIFT, 1.0), figures(scaled(LIFT, by), by)
    condition = float(Study(LIFT, 24).linkage.condition.max()) ** 2
    return worst(
        [
            Sample(float(np.abs(other[n] - one[n]).max() / np.abs(one[n]).max()), 2 * FORCE_ROUNDINGS * EPS * condition)
            for n in one
        ]
    )


CASES: tuple[Case, ...] = (
    Case(
        "Dead centre, stretched", "missing part of arm + rod", POWERS, lambda by: triangle(*_stretched(by)), part=0.45
    ),
    Case("Dead centre, folded", "excess over rod - arm", POWERS, lambda by: triangle(*_folded(by)), part=0.4),
    Case(
        "Dead centre, stretched: rates",
        "missing part of arm + rod",
        POWERS,
        lambda by: rates(*_stretched(by)),
        part=0.45,
    ),
    Case("Dead centre, folded: rates", "excess over rod - arm", POWERS, lambda by: rates(*_folded(by)), part=1.0),
    Case("Arm like rod, slider at the pivot", "distance / arm", POWERS, lambda by: triangle(*_alike(by)), part=0.13),
    Case("Rod at 180°", "180° - rod angle [rad]", (*POWERS, 0.0), _rod_backwards, part=0.7),
    Case("Other branch's rod at 180°", "180° - its rod angle [rad]", (*POWERS, 0.0), _other_rod_backwards, part=0.8),
    Case("Slider over the pivot", "distance along the guide / arm", (*POWERS, 0.0), _slider_over_pivot, part=1.0),
    Case("Slide across its rod", "missing part of the rod", POWERS, _rod_across_slide, part=0.5),
    Case("Rods of a dyad in line", "missing part of both", POWERS, _rods_in_line, 4, 0.17),
    Case("Guide of a dyad across", "excess over its offset", POWERS, _guide_across, 4, 0.17),
    Case("Follower as fast as the cam", "φ' - d", POWERS[:13], _as_fast_as_the_cam, 4, 0.04),
    Case("Roller over the pivot", "cosine to the line of centres", POWERS[:13], _over_the_pivot, 4, 0.05),
    Case("Pressure angle to 90°: profile", "sine to the line of centres", POWERS[:13], _cam_on_the_line, 4, 0.03),
    Case(
        "Pressure angle beyond 90°: profile",
        "- sine to the line of centres",
        POWERS[:13],
        _cam_beyond_the_line,
        4,
        0.045,
    ),
    Case("Pressure angle to 90°: forces", "sine to the line of centres", POWERS[:11], _forces_on_the_line, 3, 0.01),
    Case("Pressure angle to 0°", "cam angle after the dwell [rad]", POWERS[1:9], _hardly_moves, 3, 0.04),
    Case("Rod across the guide", "cosine of the rod angle", POWERS[:11], _rod_across, 3, 0.045),
    Case("Short spans", "span [°]", (*tuple(179.0 * 10.0 ** (-k) for k in range(8)), 1e-06), _span, 4, 0.035),
    Case("Spans up to a turn", "360° - span [°]", (90.0, *(10.0**-k for k in range(7))), _nearly_a_turn, 4, 0.08),
    Case("Small strokes", "stroke [mm]", tuple(10.0**k for k in range(3, -10, -1)), _stroke, 4, 0.08),
    Case("Many segments", "segments", (3.0, 10.0, 100.0, 1000.0, 3600.0), _segments, 3, 0.02),
    Case("Roller towards undercut", "1 - roller radius × curvature", POWERS[:13], _undercut, 4, 0.06),
    Case("Roller beyond undercut", "roller radius × curvature - 1", POWERS[:13], lambda by: _undercut(-by), 4, 0.06),
    Case("Guide nearly jammed", "1 - friction × slope", POWERS[:13], _nearly_jammed, 3, 0.017),
    Case("Friction turning round", "cam angle from there [rad]", POWERS[2:13], _friction_turns, 3, 0.024),
    Case("Thin tongues", "Q, a width of 0.74 Q in η", POWERS[1:9], _thin_tongue, 2, 0.45),
    Case("Larger and smaller", "scale", tuple(10.0**k for k in range(-6, 4)), _size, 6, 0.013),
)
