"""Fifty-digit references, written from the geometry: circles that intersect, bodies that turn, curves that are
differentiated. No formula of ``core`` stands here.

Whatever depends on the cam angle is a power series in it (``Series``), so every derivative follows from the geometry
alone by the rules of arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import mpmath
import numpy as np

from core.design import CamSlider, Design, Motion, Translating, entries, get, put

MP = mpmath.mp.clone()
MP.dps = 50
EPS = float(np.finfo(float).eps)
ORDER = 3  # derivatives that a series carries

DEG = MP.pi / 180
MM = MP.mpf(1) / 1000


# -- power series -----------------------------------------------------------------------------------------


class Series:
    """c0 + c1 t + c2 t^2 + ..., real or complex, cut off behind its last coefficient."""

    def __init__(self, coefficients: Sequence[Any]) -> None:
        self.c = [MP.convert(c) for c in coefficients]

    @classmethod
    def variable(cls, value: Any, order: int = ORDER) -> Series:
        return cls([value, 1] + [0] * (order - 1))

    def derivative(self, k: int) -> Any:
        """The k-th derivative at t = 0."""
        return self.c[k] * MP.factorial(k)

    @property
    def derivatives(self) -> list[Any]:
        return [self.derivative(k) for k in range(len(self.c))]

    def slope(self) -> Series:
        """d/dt, one term shorter."""
        return Series([k * c for k, c in enumerate(self.c)][1:])

    def __add__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series([self.c[0] + MP.convert(other), *self.c[1:]])
        return Series([a + b for a, b in zip(self.c, other.c, strict=False)])

    def __neg__(self) -> Series:
        return Series([-c for c in self.c])

    def __sub__(self, other: Any) -> Series:
        return self + -(other if isinstance(other, Series) else MP.convert(other))

    def __rsub__(self, other: Any) -> Series:
        return -self + other

    def __mul__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            factor = MP.convert(other)
            return Series([a * factor for a in self.c])
        a, b = self.c, other.c
        n = min(len(a), len(b))
        return Series([MP.fdot(a[: k + 1], b[k::-1]) for k in range(n)])

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            divisor = MP.convert(other)
            return Series([a / divisor for a in self.c])
        a, b = self.c, other.c
        q: list[Any] = []
        for k in range(min(len(a), len(b))):
            q.append((a[k] - MP.fsum(b[j] * q[k - j] for j in range(1, k + 1))) / b[0])
        return Series(q)

    def __rtruediv__(self, other: Any) -> Series:
        return Series([other] + [0] * (len(self.c) - 1)) / self

    def __pow__(self, n: int) -> Series:
        out = self
        for _ in range(n - 1):
            out = out * self
        return out

    @property
    def real(self) -> Series:
        return Series([MP.re(c) for c in self.c])

    @property
    def imag(self) -> Series:
        return Series([MP.im(c) for c in self.c])

    def conjugate(self) -> Series:
        return Series([MP.conj(c) for c in self.c])

    def __abs__(self) -> Series:
        return sqrt((self * self.conjugate()).real)


def sqrt(x: Any) -> Any:
    if not isinstance(x, Series):
        return MP.sqrt(x)
    s = [MP.sqrt(x.c[0])]
    for k in range(1, len(x.c)):
        s.append((x.c[k] - MP.fsum(s[j] * s[k - j] for j in range(1, k))) / (2 * s[0]))
    return Series(s)


def exp(x: Any) -> Any:
    if not isinstance(x, Series):
        return MP.exp(x)
    e = [MP.exp(x.c[0])]
    for k in range(1, len(x.c)):
        e.append(MP.fsum(j * x.c[j] * e[k - j] for j in range(1, k + 1)) / k)
    return Series(e)


def turn(angle: Any) -> Any:
    """The unit vector at an angle."""
    return exp(1j * angle) if isinstance(angle, Series) else MP.expj(angle)


def cos(x: Any) -> Any:
    return turn(x).real


def sin(x: Any) -> Any:
    return turn(x).imag


def direction(z: Any) -> Any:
    """The angle of a vector, -π ... π, with its derivatives."""
    if not isinstance(z, Series):
        return MP.arg(z)
    logarithm = [MP.log(z.c[0])]
    for k in range(1, len(z.c)):
        rest = MP.fsum(j * logarithm[j] * z.c[k - j] for j in range(1, k)) / k
        logarithm.append((z.c[k] - rest) / z.c[0])
    return Series(logarithm).imag


def crossing(a: Any, b: Any) -> Any:
    """a × b."""
    return (a.conjugate() * b).imag


def leaning(a: Any, b: Any) -> Any:
    """a · b."""
    return (a.conjugate() * b).real


# -- motion laws ------------------------------------------------------------------------------------------

# By their acceleration, up to its size: (width of the piece, acceleration by u). The stroke of 1 fixes the size.
_QUARTER = MP.mpf(1) / 8
BY_ACCELERATION: Mapping[str, tuple[tuple[Any, Callable[[Any], Any]], ...]] = {
    "modified-sine": (
        (_QUARTER, lambda u: sin(4 * MP.pi * u)),
        (6 * _QUARTER, lambda u: sin(4 * MP.pi * u / 3 + MP.pi / 3)),
        (_QUARTER, lambda u: sin(4 * MP.pi * u)),
    ),
    "modified-trapezoid": (
        (_QUARTER, lambda u: sin(4 * MP.pi * u)),
        (2 * _QUARTER, lambda u: u * 0 + 1),
        (2 * _QUARTER, lambda u: cos(4 * MP.pi * (u - 3 * _QUARTER))),
        (2 * _QUARTER, lambda u: u * 0 - 1),
        (_QUARTER, lambda u: -cos(4 * MP.pi * (u - 7 * _QUARTER))),
    ),
}
# By their displacement. The simple harmonic is the shadow of a point on a circle, the cycloidal that of a point on a
# circle that rolls; the polynomials are those with 2 (3) vanishing derivatives at both ends: the regularised incomplete
# beta functions, as integrals of u^n (1-u)^n.
BY_DISPLACEMENT: Mapping[str, Callable[[Any], Any]] = {
    "dwell": lambda u: u * 0,
    "constant-velocity": lambda u: u,
    "simple-harmonic": lambda u: sin(MP.pi * u / 2) ** 2,
    "cycloidal": lambda u: (2 * MP.pi * u - sin(2 * MP.pi * u)) / (2 * MP.pi),
    "3-4-5": lambda u: 30 * (u**3 / 3 - u**4 / 2 + u**5 / 5),
    "4-5-6-7": lambda u: 140 * (u**4 / 4 - 3 * u**5 / 5 + u**6 / 2 - u**7 / 7),
}
LAW_SLUGS = (*BY_DISPLACEMENT, *BY_ACCELERATION)


def law_joins(slug: str) -> list[Any]:
    """Where the pieces of a law start, and 1."""
    joins = [MP.zero]
    for width, _ in BY_ACCELERATION.get(slug, ((MP.one, None),)):
        joins.append(joins[-1] + width)
    return joins


@cache
def _law_size(slug: str) -> Any:
    """The factor that makes the double integral 1 at u = 1."""
    joins = law_joins(slug)
    pieces = [row[1] for row in BY_ACCELERATION[slug]]
    return 1 / MP.fsum(
        MP.quad(lambda x, a=a: (1 - x) * a(x), joins[i : i + 2], method="gauss-legendre") for i, a in enumerate(pieces)
    )


@cache
def _law_start(slug: str, piece: int) -> tuple[Any, Any]:
    """Displacement and velocity where a piece starts."""
    s = v = MP.zero
    joins = law_joins(slug)
    for i in range(piece):
        s, v = _carried(slug, i, s, v, joins[i + 1])
    return s, v


def _carried(slug: str, piece: int, s: Any, v: Any, u: Any) -> tuple[Any, Any]:
    """Displacement and velocity at u, from those at the start of its piece: quadrature of the acceleration."""
    begin, accelerate = law_joins(slug)[piece], BY_ACCELERATION[slug][piece][1]
    size = _law_size(slug)
    gained = size * MP.quad(accelerate, [begin, u], method="gauss-legendre")
    moved = size * MP.quad(lambda x: (u - x) * accelerate(x), [begin, u], method="gauss-legendre")
    return s + v * (u - begin) + moved, v + gained


def law(slug: str, u: Any, piece: int | None = None) -> list[Any]:
    """s, s', s'', s''' at u; on a join of pieces the right-hand limit unless the piece is named."""
    u = MP.convert(u)
    if slug in BY_DISPLACEMENT:
        return BY_DISPLACEMENT[slug](Series.variable(u)).derivatives
    joins = law_joins(slug)
    if piece is None:
        piece = max(i for i, j in enumerate(joins[:-1]) if u >= j or i == 0)
    s, v = _carried(slug, piece, *_law_start(slug, piece), u)
    a = BY_ACCELERATION[slug][piece][1](Series.variable(u)) * _law_size(slug)
    return [s, v, a.derivative(0), a.derivative(1)]


def _wave(amplitude: float, frequency: float, largest: float) -> tuple[float, ...]:
    """A sine and its derivatives: its size, and what a rounding of its angle (at most ``largest``) makes of it."""
    return tuple(amplitude * frequency**k * (1.0 + largest) for k in range(ORDER + 2))


def _powers(*coefficients: float) -> tuple[float, ...]:
    """A polynomial at 1 with every term positive, and its derivatives."""
    return tuple(
        math.fsum(math.perm(power, k) * abs(c) for power, c in enumerate(coefficients)) for k in range(ORDER + 2)
    )


def _sums(*rows: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(map(math.fsum, zip(*rows, strict=True)))


_SINE, _TRAPEZOID = 1 / (4 + math.pi), 8 * math.pi / (2 + math.pi)
LAW_TERMS: Mapping[str, tuple[float, ...]] = {
    "dwell": (0.0,) * (ORDER + 2),
    "constant-velocity": _powers(0, 1),
    "simple-harmonic": _sums(_powers(0.5), _wave(0.5, math.pi, 1.5 * math.pi)),
    "cycloidal": _sums(_powers(0, 1), _wave(1 / math.tau, math.tau, math.tau)),
    "modified-sine": _sums(_powers(4 * _SINE, math.pi * _SINE), _wave(2.25 * _SINE, 4 * math.pi / 3, 1.5 * math.pi),
                           _wave(_SINE / 4, 4 * math.pi, math.pi)),
    "modified-trapezoid": _sums(_powers(1, 2, _TRAPEZOID / 2), _wave(_TRAPEZOID / (4 * math.pi) ** 2, 4 * math.pi, math.pi)),
    "3-4-5": _powers(0, 0, 0, 10, -15, 6),
    "4-5-6-7": _powers(0, 0, 0, 0, 35, -84, 70, -20),
}  # fmt: skip
"""For s and four derivatives the sizes of the terms of the textbook's formula, added up: what one rounding of each term
costs, in eps, at worst. Cancellation between the terms makes none of it better."""


# -- motion -----------------------------------------------------------------------------------------------


def joins_of(motion: Motion) -> list[Any]:
    """Cam angles [rad] where segments start, and 2π."""
    sums = [MP.zero]
    for segment in motion.segments:
        sums.append(sums[-1] + MP.convert(segment.span_deg))
    return [s * DEG for s in sums]


def segment_at(motion: Motion, theta: Any) -> int:
    """The segment right of a cam angle [rad]."""
    joins = joins_of(motion)
    return max(i for i in range(len(motion.segments)) if MP.convert(theta) >= joins[i])


def motion_series(motion: Motion, theta: Any, segment: int, piece: int | None = None) -> Series:
    """y [m] about the cam angle theta [rad], as this segment has it, beyond its ends too."""
    part = motion.segments[segment]
    begin, span = joins_of(motion)[segment], MP.convert(part.span_deg) * DEG
    level = MP.convert(motion.start) + MP.fsum(MP.convert(s.rise) for s in motion.segments[:segment])
    told = law(part.curve.law, (MP.convert(theta) - begin) / span, piece)
    unit = MM if motion.unit == "mm" else DEG
    y = [MP.convert(part.rise) * told[k] / span**k / MP.factorial(k) for k in range(ORDER + 1)]
    return (Series(y) + level) * unit


# -- mechanisms -------------------------------------------------------------------------------------------


def two_circles(c1: Any, r1: Any, c2: Any, r2: Any, side: int) -> Any:
    """Where two circles meet, left (side 1) or right (-1) of the line from c1 to c2."""
    line = c2 - c1
    square = (line * line.conjugate()).real
    along = (square + r1 * r1 - r2 * r2) / (2 * square)
    across = sqrt(r1 * r1 / square - along * along)
    return c1 + line * (along + 1j * side * across)


def circle_and_line(centre: Any, radius: Any, through: Any, along: Any, ahead: int) -> Any:
    """Where a circle meets a line, the point further ahead (1) or further back (-1) along it."""
    local = (centre - through) * MP.conj(along)
    return through + along * (MP.re(local) + ahead * sqrt(radius**2 - MP.im(local) ** 2))


@dataclass
class Solved:
    """A mechanism about one cam angle: points and angles as series in it; ``guide`` the direction of the guide."""

    theta: Any
    y: Series
    roller: Series
    guide: Any
    points: Mapping[str, Series]
    angles: Mapping[str, Series]
    base: Mapping[str, Any]


def reach_of(design: Design) -> Any:
    cam = design.drive.cam
    return (MP.convert(cam.base_radius_mm) + MP.convert(cam.roller_radius_mm)) * MM


def _cam_slider(design: Design, theta: Any, y: Series) -> Solved:
    g: CamSlider = design.drive.mechanism
    l1, l2, height, arm = (MP.convert(x) * MM for x in (g.slider_arm_mm, g.rod_mm, g.guide_height_mm, g.roller_arm_mm))
    pivot = MP.mpc(g.pivot_x_mm, g.pivot_y_mm) * MM
    guide = MP.expj(MP.convert(g.guide_angle_deg) * DEG)
    fixed = MP.expj(MP.convert(g.fixed_angle_deg) * DEG)
    cam_left, above, slider_right = g.layout in "abef", g.layout in "abcd", g.layout in "aceg"
    # above = left of the line from the cam centre to the pivot where the cam stands left of the pivot, else right of it
    roller0 = two_circles(MP.mpc(0), reach_of(design), pivot, arm, 1 if above == cam_left else -1)
    pin_b0 = pivot + (roller0 - pivot) / arm * l1 / fixed
    pin_a0 = circle_and_line(pin_b0, l2, pivot + 1j * height * guide, guide, 1 if slider_right else -1)
    side = 1 if MP.im(MP.conj(pin_a0 - pivot) * (pin_b0 - pivot)) > 0 else -1  # of the arm's pin, kept over the cycle
    pin_a = pin_a0 + y * guide
    pin_b = two_circles(Series([pivot] + [0] * ORDER), l1, pin_a, l2, side)
    roller = pivot + (pin_b - pivot) * (fixed * arm / l1)
    slider = ((pin_a - pivot) * MP.conj(guide)).real
    phi, beta = direction((pin_b - pivot) * MP.conj(guide)), direction((pin_a - pin_b) * MP.conj(guide))
    return Solved(
        theta,
        y,
        roller,
        guide,
        {"pivot": Series([pivot] + [0] * ORDER), "arm_pin": pin_b, "slider_pin": pin_a, "roller": roller},
        {"slider_position": slider, "phi": phi, "beta": beta},
        {
            "slider": MP.re((pin_a0 - pivot) * MP.conj(guide)),
            "phi": MP.arg((pin_b0 - pivot) * MP.conj(guide)),
            "alpha": MP.arg(roller0 - pivot),
            "beta": MP.arg((pin_a0 - pin_b0) * MP.conj(guide)),
        },
    )


def _translating(design: Design, theta: Any, y: Series) -> Solved:
    g: Translating = design.drive.mechanism
    guide = MP.expj(MP.convert(g.direction_deg) * DEG)
    roller0 = circle_and_line(MP.mpc(0), reach_of(design), 1j * MP.convert(g.offset_mm) * MM * guide, guide, 1)
    roller = roller0 + y * guide
    place = (roller * MP.conj(guide)).real
    return Solved(
        theta, y, roller, guide, {"roller": roller}, {"follower_position": place}, {"follower": place.c[0] - y.c[0]}
    )


def solved(design: Design, theta: Any, segment: int | None = None, piece: int | None = None) -> Solved:
    """The mechanism about a cam angle [rad], as one segment of the motion drives it."""
    motion = design.drive.motion
    segment = segment_at(motion, theta) if segment is None else segment
    return placed(design, theta, motion_series(motion, theta, segment, piece))


def placed(design: Design, theta: Any, y: Series) -> Solved:
    """The mechanism where its output stands at y."""
    kinds = {CamSlider: _cam_slider, Translating: _translating}
    return kinds[type(design.drive.mechanism)](design, MP.convert(theta), y)


# -- the cam ----------------------------------------------------------------------------------------------


@dataclass
class Shape:
    """The cam about one cam angle, in its own frame: pitch curve and profile, signed distances by geometry."""

    pitch: Series
    normal: Any
    profile: Any
    pressure_angle: Any
    curvature: Series
    profile_curvature: Any


def sense_of(design: Design) -> int:
    return 1 if design.shaft.rotation == "ccw" else -1


def cam_shape(design: Design, there: Solved) -> Shape:
    """Seen from the cam, the world turns the other way: the pitch curve is where the roller centre goes.

    The cam is the body that the curve encloses: counter-clockwise round the centre where the world goes so (a cam
    that turns clockwise), so the material lies left of the curve there, and right of it for a cam that turns
    counter-clockwise.
    """
    d = sense_of(design)
    back = turn(-d * Series.variable(there.theta))
    pitch = there.roller * back
    tangent = pitch.slope()
    unit = tangent.c[0] / abs(tangent.c[0])
    inwards = unit * (1j if d < 0 else -1j)
    radius = MP.convert(design.drive.cam.roller_radius_mm) * MM
    # a curve that turns towards its material is convex there
    speed = abs(tangent)
    bend = crossing(tangent, tangent.slope()) / (speed * speed * speed) * (1 if d < 0 else -1)
    # pressure angle: between the line along which the cam pushes and the line along which the roller centre can go
    travel = there.guide
    if "arm_pin" in there.points:
        arm = there.roller.c[0] - there.points["pivot"].c[0]
        travel = 1j * arm / abs(arm)
    travel_on_cam = travel * back.c[0]
    cosine, sine = MP.re(MP.conj(inwards) * travel_on_cam), MP.im(MP.conj(inwards) * travel_on_cam)
    return Shape(
        pitch,
        inwards / back.c[0],
        pitch.c[0] + radius * inwards,
        MP.atan2(abs(sine), abs(cosine)),
        bend,
        1 / (1 / bend.c[0] - radius) if bend.c[0] else MP.zero,
    )


# -- forces -----------------------------------------------------------------------------------------------


@dataclass
class Mass:
    """One body: its mass and inertia, its centre of mass and its angle as series in the cam angle."""

    mass: Any
    inertia: Any
    centre: Series
    angle: Series


def masses(design: Design, there: Solved) -> dict[str, Mass]:
    """All bodies that move; arm and roller apart though they turn as one."""
    loads: Any = design.drive.loads
    still = Series([0] * (ORDER + 1))
    if "slider_pin" not in there.points:
        return {"follower": Mass(MP.convert(loads.follower_mass_kg), MP.zero, there.roller, still)}
    pivot, pin_b, pin_a = (there.points[name] for name in ("pivot", "arm_pin", "slider_pin"))
    along_arm = (pin_b - pivot) / abs(pin_b.c[0] - pivot.c[0])
    centre = pivot + along_arm * MP.convert(loads.arm_centre_mm) * MM * MP.expj(loads.arm_centre_angle_deg * DEG)
    phi, beta = direction(pin_b - pivot), direction(pin_a - pin_b)
    return {
        "slider": Mass(MP.convert(loads.slider_mass_kg), MP.zero, pin_a, still),
        "rod": Mass(
            MP.convert(loads.rod_mass_kg),
            MP.convert(loads.rod_inertia_kg_m2),
            pin_b + (pin_a - pin_b) * MP.convert(loads.rod_centre),
            beta,
        ),
        "arm": Mass(MP.convert(loads.arm_mass_kg), MP.convert(loads.arm_inertia_kg_m2), centre, phi),
        "roller": Mass(MP.convert(loads.roller_mass_kg), MP.convert(loads.roller_inertia_kg_m2), there.roller, phi),
    }


def push_on_output(design: Design, y: Any) -> Any:
    """The given force along the guide."""
    loads: Any = design.drive.loads
    given = loads.external_force_n if hasattr(loads, "external_force_n") else -MP.convert(loads.preload_n)
    return MP.convert(given) - MP.convert(loads.spring_rate_n_per_mm) / MM * y


def speed_of(design: Design) -> Any:
    return MP.convert(design.shaft.speed_rpm) * 2 * MP.pi / 60


def gravity_of(design: Design) -> Any:
    loads = design.drive.loads
    return MP.convert(loads.gravity_m_s2) * MP.expj(loads.gravity_angle_deg * DEG)


class Jammed(Exception):
    """No direction of the guide's force agrees with the friction that it makes."""


def free_bodies(design: Design, there: Solved, way: int) -> dict[str, Any]:
    """Every reaction by cutting all bodies free: one linear system of forces and moments about the cam centre.

    Unknown: force of the frame on the arm, of rod on arm, of rod on slider, normal force of the guide, contact force,
    force of the frame on the camshaft and the motor's torque on it. Friction, against the slider's way, is that of the
    normal force's size: both signs are tried. Plain names as in ``core.dynamics.Forces``.
    """
    normal, parts = cam_shape(design, there).normal, masses(design, there)
    for sign in (1, -1):
        forces = _free_bodies(design, there, normal, parts, way * sign)
        if forces["normal"] * sign >= 0:
            return forces
    raise Jammed


def solution_of(matrix: list[list[Any]], right: list[Any]) -> list[Any]:
    """Of linear equations, by elimination with the largest pivot of each column."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for k in range(len(rows)):
        largest = max(range(k, len(rows)), key=lambda i: abs(rows[i][k]))
        rows[k], rows[largest] = rows[largest], rows[k]
        for row in rows[k + 1 :]:
            if row[k]:
                factor = row[k] / rows[k][k]
                row[k + 1 :] = [a - factor * b if b else a for a, b in zip(row[k + 1 :], rows[k][k + 1 :], strict=True)]
    found: list[Any] = []
    for k in reversed(range(len(rows))):
        known = MP.fsum(a * x for a, x in zip(rows[k][k + 1 : -1], found, strict=True) if a)
        found.insert(0, (rows[k][-1] - known) / rows[k][k])
    return found


def _free_bodies(
    design: Design, there: Solved, normal: Any, parts: dict[str, Mass], friction_sign: int
) -> dict[str, Any]:
    d, w2, g = sense_of(design), speed_of(design) ** 2, gravity_of(design)
    has_arm = "arm" in parts
    names = [*(("pivot", "arm_pin", "slider_pin") if has_arm else ()), "normal", "contact", "bearing", "torque"]
    columns = {}
    for name in names:
        wide = 1 if name in ("normal", "contact", "torque") else 2
        columns[name] = list(range(sum(map(len, columns.values())), sum(map(len, columns.values())) + wide))
    size = sum(map(len, columns.values()))
    matrix, right = [[MP.zero] * size for _ in range(size)], [MP.zero] * size
    row = 0

    def body(acting: list[tuple[str, Any, Any]], given: Any, given_moment: Any, moments: bool = True) -> None:
        """Forces (name, factor or direction, place) plus what is given: zero, and so their moments."""
        nonlocal row
        for axis in range(3 if moments else 2):
            for name, direction_, place in acting:
                for k, column in enumerate(columns[name]):
                    force = direction_ * ((1, 1j)[k] if len(columns[name]) == 2 else 1)
                    part = (MP.re(force), MP.im(force), MP.im(MP.conj(place) * force))[axis]
                    matrix[row][column] += part
            right[row] = -(MP.re(given), MP.im(given), given_moment)[axis]
            row += 1

    def lost(*of: str) -> tuple[Any, Any]:
        """Weight and inertia forces of bodies, and their moments about the cam centre."""
        force = moment = MP.zero
        for name in of:
            m = parts[name]
            pull = m.mass * (g - w2 * m.centre.derivative(2))
            force += pull
            moment += MP.im(MP.conj(m.centre.c[0]) * pull) - m.inertia * w2 * m.angle.derivative(2)
        return force, moment

    friction = MP.convert(design.drive.loads.friction)
    guide = there.guide * 1j - there.guide * friction * friction_sign  # of one newton across the guide
    push = push_on_output(design, there.y.c[0]) * there.guide
    roller = there.roller.c[0]
    if has_arm:
        pivot, pin_b, pin_a = (there.points[name].c[0] for name in ("pivot", "arm_pin", "slider_pin"))
        arm = [("pivot", 1, pivot), ("arm_pin", 1, pin_b), ("contact", -normal, roller)]
        body(arm, *lost("arm", "roller"))
        body([("arm_pin", -1, pin_b), ("slider_pin", -1, pin_a)], *lost("rod"))
        force, _ = lost("slider")
        body([("slider_pin", 1, pin_a), ("normal", guide, pin_a)], force + push, 0, moments=False)
    else:
        force, _ = lost("follower")
        body([("normal", guide, roller), ("contact", -normal, roller)], force + push, 0, moments=False)
    body([("bearing", 1, MP.zero), ("contact", normal, roller)], 0, 0, moments=False)
    matrix[row][columns["torque"][0]] = MP.convert(d)
    matrix[row][columns["contact"][0]] = MP.im(MP.conj(roller) * normal)
    solution = solution_of(matrix, right)
    told: dict[str, Any] = {}
    for name, at in columns.items():
        told[name] = solution[at[0]] + (1j * solution[at[1]] if len(at) == 2 else 0)
    told["guide"] = told["normal"] * guide
    told["follower_torque"] = (
        told["contact"] * MP.im(MP.conj(roller - there.points["pivot"].c[0]) * -normal)
        if has_arm
        else told["contact"] * MP.re(MP.conj(there.guide) * -normal)
    )
    return told


def torque_by_energy(design: Design, there: Solved, normal_force: Any) -> Any:
    """The torque that the change of kinetic and potential energy, the given force and friction ask for."""
    w2, g = speed_of(design) ** 2, gravity_of(design)
    total = MP.zero
    for m in masses(design, there).values():
        speed = m.centre.slope()
        kinetic = ((speed * speed.conjugate()).real * m.mass + m.angle.slope() ** 2 * m.inertia) * (w2 / 2)
        height = (m.centre * MP.conj(g)).real
        total += kinetic.derivative(1) - m.mass * height.derivative(1)
    rate = there.y.derivative(1)
    total -= push_on_output(design, there.y.c[0]) * rate
    return total + MP.convert(design.drive.loads.friction) * abs(normal_force) * abs(rate)


# -- conditions -------------------------------------------------------------------------------------------


def conditioned(
    function: Callable[[list[Any]], Sequence[Any]], numbers: Sequence[Any]
) -> tuple[list[Any], list[float]]:
    """The values of a function of numbers, and for each the sum of |p df/dp|: how far it moves where every number
    moves by the fraction 1 of itself, to first order. Times eps it is what one rounding of each number does.
    """
    step = MP.mpf(10) ** -20
    exact = [MP.convert(p) for p in numbers]
    value = list(function(exact))
    moved = []
    for i, p in enumerate(exact):
        if p:
            moved.append(list(function([*exact[:i], p * (1 + step), *exact[i + 1 :]])))
    return value, [float(MP.fsum(abs(m[i] - v) for m in moved) / step) for i, v in enumerate(value)]


def sensitivity(
    function: Callable[[Design, Solved], Sequence[Any]],
    design: Design,
    theta: float,
    y: np.ndarray,
    sections: Sequence[str] = ("follower", "cam"),
) -> tuple[list[Any], list[float]]:
    """What a function of the placed mechanism gives for a motion y with three derivatives (4,), and how far that moves
    by the cam angle, the motion and all numbers of these sections of the design (``conditioned``)."""
    numbers = (e for section in sections for e in entries(design, section) if not e.info.choices)
    paths = [e.path for e in numbers if e.value is not None]

    def of(numbers: list[Any]) -> Sequence[Any]:
        moved = design
        for path, number in zip(paths, numbers[5:], strict=True):
            moved = put(moved, path, number)
        series = Series([d / MP.factorial(k) for k, d in enumerate(numbers[1:5])])
        return function(moved, placed(moved, numbers[0], series))

    return conditioned(of, [theta, *map(float, y), *(get(design, path) for path in paths)])


def apart(angle: float, reference: Any) -> float:
    """Difference of two angles [rad], whole turns apart being the same."""
    return float(abs(MP.arg(MP.expj(MP.convert(angle) - reference))))


def off(value: float | complex, reference: Any) -> float:
    """|value - reference|, the value taken exactly."""
    return float(abs(MP.convert(complex(value) if isinstance(value, complex) else float(value)) - reference))


def rounding(size: float, times: int) -> float:
    """What ``times`` roundings do to a result of this condition size, the first order and a hair."""
    return times * EPS * size * (1.0 + 1e-3) + math.ulp(0.0)
