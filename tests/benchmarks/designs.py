"""Many designs at once: for one kind of follower each its formulas by hand, numpy over all designs and the nodes that
``core.study.many`` takes, extremes refined by parabolas. What ``make bench-check`` compares ``many`` with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.forces import LOADING, of_motion
from benchmarks.plain import HAND, L0, PHI0, PIVOT, law
from mechanisms import LIFT

from core.design import Design, LinkMass, Motion, NamedCurve, Segment, get, with_drive
from core.motion import TURN
from core.project import load
from core.study import Study, many

EXAMPLES = Path(__file__).parents[2] / "resources" / "examples"
COUNT, BLOCK = 1500, 500  # designs, and how many of them at once by hand
DENSE, SPARSE, LEAST = np.deg2rad(3.6), np.deg2rad(15.0), (5, 13)
Values = Callable[..., Sequence[np.ndarray]]


def nodes(program: Any) -> tuple[np.ndarray, ...]:
    """Clenshaw and Curtis' nodes of every piece; from where to where the extreme at a node is looked for."""
    parts = []
    for a, b, moves in zip(program.starts, program.ends, np.asarray(program.velocity_signs) != 0.0, strict=True):
        count = max(ceil((b - a) / (DENSE if moves else SPARSE)) | 1, LEAST[int(moves)])
        theta = a + (b - a) * np.sin(0.5 * np.pi * np.arange(count) / (count - 1)) ** 2
        parts.append(
            (theta, np.maximum(np.roll(theta, 1), a) * (theta > a) + a * (theta <= a), np.append(theta[1:], b))
        )
    return tuple(np.concatenate(rows) for rows in zip(*parts, strict=True))


@dataclass(frozen=True, eq=False)
class Designs:
    """One row: designs that differ at some paths, what is asked, and by hand the values of it.

    values  numbers of the designs, the cam angle's part of its segment, and the segment -> what is asked, in its unit, each (m, k)
    """

    name: str
    design: Design
    varied: Mapping[str, tuple[float, float]]
    asked: tuple[str, ...]
    values: Values
    numbers: Callable[[Design, Mapping[str, np.ndarray]], Any]
    count: int = COUNT

    @cached_property
    def columns(self) -> dict[str, np.ndarray]:
        rng = np.random.default_rng(5)
        return {path: rng.uniform(*ends, self.count) for path, ends in self.varied.items()}

    def ours(self) -> list[np.ndarray]:
        """In the units of what is asked."""
        found = many(self.design, self.columns, self.asked)
        return [found.value[key] for key in self.asked]

    def by_hand(self) -> list[np.ndarray]:
        parts = [
            self._block({path: row[i : i + BLOCK, None] for path, row in self.columns.items()})
            for i in range(0, self.count, BLOCK)
        ]
        return list(np.concatenate(parts, axis=1))

    def _block(self, columns: Mapping[str, np.ndarray]) -> np.ndarray:
        """The two highest nodes of each quantity, refined; by designs, quantities, and these two."""
        g = self.numbers(self.design, columns)
        signs = [-1.0 if key.endswith(":min") else 1.0 for key in self.asked]
        theta, low, high, segment, joins, spans = self._nodes
        rows = self.values(g, (theta - joins[segment]) / spans[segment], segment)
        tops = np.stack([_two_highest(sign * row) for sign, row in zip(signs, rows, strict=True)], axis=1)
        best = np.stack(
            [s * np.take_along_axis(r, k, 1) for s, r, k in zip(signs, rows, tops.swapaxes(0, 1), strict=True)], 1
        )
        at, low, high, step = theta[tops], low[tops], high[tops], 0.2 * (high[tops] - low[tops])
        which = np.repeat(segment[tops].reshape(len(best), -1), 3, axis=1)
        for _ in range(3):
            at = np.clip(at, low + step, high - step)
            there = (at[..., None] + step[..., None] * np.array((-1.0, 0.0, 1.0))).reshape(which.shape)
            found = self.values(g, (there - joins[which]) / spans[which], which)
            own = [s * r.reshape(*at.shape, 3)[:, i] for i, (s, r) in enumerate(zip(signs, found, strict=True))]
            a, b, c = np.moveaxis(np.stack(own, axis=1), -1, 0)
            best = np.maximum(best, np.maximum(a, np.maximum(b, c)))
            bend = a - 2.0 * b + c
            smooth = bend < 0.0
            at = at + step * np.clip(
                np.where(smooth, 0.5 * (a - c) / np.where(smooth, bend, 1.0), np.sign(c - a) * 2.0), -2.0, 2.0
            )
            step = 0.05 * step
        return best.max(axis=2).T * np.array(signs)[:, None]

    @cached_property
    def _nodes(self) -> tuple[np.ndarray, ...]:
        if self.design.drive.motion is None:  # a crank, which turns round
            step = TURN / 128
            theta = np.arange(128) * step
            return theta, theta - step, theta + step, np.zeros(128, dtype=int), np.zeros(1), np.ones(1)
        theta, low, high = nodes(Study(self.design).program)
        spans = np.deg2rad([s.span_deg for s in self.design.drive.motion.segments])
        joins = np.concatenate(((0.0,), np.cumsum(spans)))
        return theta, low, high, np.searchsorted(joins, 0.5 * (low + high)) - 1, joins, spans


def _two_highest(row: np.ndarray) -> np.ndarray:
    """Of values (m, n) the highest, and the highest of the other local maxima, (m, 2)."""
    first = row.argmax(axis=1)[:, None]
    local = (row >= np.roll(row, 1, axis=1)) & (row >= np.roll(row, -1, axis=1))
    np.put_along_axis(local, first, False, axis=1)
    return np.concatenate((first, np.where(local, row, -np.inf).argmax(axis=1)[:, None]), axis=1)


def moved(g: Any, u: np.ndarray, k: np.ndarray) -> Sequence[np.ndarray]:
    """y, y', y'' of dwells and modified sines: g.level and g.rise of each segment, g.spans (1 or m, segments) [rad]."""
    s, v, a = law(u)
    span = (
        g.spans[0, k] if g.spans.shape[0] == 1 else g.spans[:, k] if k.ndim == 1 else np.take_along_axis(g.spans, k, 1)
    )
    return g.level[k] + g.rise[k] * s, g.rise[k] * v / span, g.rise[k] * a / span**2


def _motion(design: Design, columns: Mapping[str, np.ndarray], unit: float) -> dict[str, Any]:
    segments = design.drive.motion.segments
    varied = [
        columns.get(f"motion.segments[{i}].span_deg", np.full((1, 1), s.span_deg)) for i, s in enumerate(segments)
    ]
    rises = unit * np.array([s.rise for s in segments])
    start = unit * design.drive.motion.start
    spans = np.deg2rad(np.concatenate(np.broadcast_arrays(*varied), axis=1))
    return {"spans": spans, "rise": rises, "level": start + np.cumsum(rises) - rises}


# -- a translating roller -------------------------------------------------------------------------------------


def _roller_numbers(design: Design, columns: Mapping[str, np.ndarray]) -> Any:
    of = lambda path: columns.get(path, get(design, path))  # noqa: E731
    offset, pitch = 1e-3 * of("follower.offset_mm"), 1e-3 * (of("cam.base_radius_mm") + of("cam.roller_radius_mm"))
    loads, omega = design.drive.loads, of("shaft.speed_rpm") * (TURN / 60.0)
    return SimpleNamespace(
        **_motion(design, columns, 1e-3),
        offset=offset,
        height=np.sqrt(pitch**2 - offset**2),
        mass=of("loads.follower_mass_kg"),
        square=omega * omega,
        weight=of("loads.follower_mass_kg") * loads.gravity_m_s2 + loads.preload_n,
        rate=1e3 * loads.spring_rate_n_per_mm,
    )


def translating_roller(g: Any, u: np.ndarray, k: np.ndarray) -> Sequence[np.ndarray]:
    """Pressure angle, contact force, torque: tan ψ = (y' + e)/s."""
    y, speed, push = moved(g, u, k)
    tangent = (speed + g.offset) / (g.height + y)
    along = g.mass * g.square * push + g.weight + g.rate * y
    return np.rad2deg(np.arctan(np.abs(tangent))), along * np.sqrt(1.0 + tangent * tangent), along * speed


# -- a rocker with a flat face ----------------------------------------------------------------------------------


def _rocker_numbers(design: Design, columns: Mapping[str, np.ndarray]) -> Any:
    of = lambda path: columns.get(path, get(design, path))  # noqa: E731
    follower, loads = design.drive.mechanism, design.drive.loads
    pivot, face = 1e-3 * complex(follower.pivot_x_mm, follower.pivot_y_mm), 1e-3 * of("follower.face_offset_mm")
    omega, mass, centre = of("shaft.speed_rpm") * (TURN / 60.0), of("loads.arm_mass_kg"), 1e-3 * loads.arm_centre_mm
    base = 1e-3 * of("cam.base_radius_mm")  # where the face touches the base circle
    return SimpleNamespace(
        **_motion(design, columns, np.pi / 180.0),
        pivot=pivot,
        face=face,
        start=np.angle(pivot) + np.arccos((base - face) / abs(pivot)),
        inertia=(loads.arm_inertia_kg_m2 + mass * centre**2) * omega * omega,
        weight=mass * loads.gravity_m_s2 * centre,
        preload=loads.preload_nm,
        rate=loads.spring_rate_nm_per_rad,
        friction=of("loads.contact_friction"),
    )


def flat_rocker(g: Any, u: np.ndarray, k: np.ndarray) -> Sequence[np.ndarray]:
    """Pressure angle, contact force, torque: n, upwards out of the cam, turns by -y; contact t from the pivot's foot along i n where
    no point of the cam goes through the face."""
    y, speed, push = moved(g, u, k)
    turn = g.start - y
    n = np.empty(turn.shape, dtype=complex)
    n.real, n.imag = np.cos(turn), np.sin(turn)
    pivot_n = n.real * g.pivot.real + n.imag * g.pivot.imag
    pivot_u = n.real * g.pivot.imag - n.imag * g.pivot.real
    t = -pivot_u / (1.0 + speed)
    grip = g.friction * np.sign(pivot_n + g.face * (1.0 + speed))
    pressed = g.preload + g.rate * y + g.weight * n.imag + g.inertia * push
    contact = pressed / (t - g.face * grip)
    torque = contact * ((pivot_n + g.face) * grip - (pivot_u + t))
    return np.rad2deg(np.arctan(np.abs(g.face / t))), contact, torque


# -- the lift: a cam-slider with friction -------------------------------------------------------------------------


def _lift_numbers(design: Design, columns: Mapping[str, np.ndarray]) -> Any:
    of = lambda path: columns.get(path, get(design, path))  # noqa: E731
    rod, pitch = 1e-3 * of("follower.rod_mm"), 1e-3 * (of("cam.base_radius_mm") + of("cam.roller_radius_mm"))
    away, arm = abs(PIVOT), HAND.roller_arm
    side = np.sign(np.angle(np.exp(1j * (PHI0 + HAND.fixed_angle)) / -PIVOT))
    swing = np.arccos((arm**2 + away**2 - pitch**2) / (2.0 * arm * away))
    phi = np.angle(-PIVOT) + side * swing - HAND.fixed_angle
    reach = HAND.slider_arm * np.exp(1j * phi)
    ahead = np.sign(L0 - HAND.slider_arm * np.cos(PHI0))
    base = reach.real + ahead * np.sqrt(rod**2 - (HAND.guide_height - reach.imag) ** 2)
    hand = {**vars(HAND), "rod": rod, "base": base}
    loading = SimpleNamespace(masses=LOADING.masses, friction=of("loads.friction"))
    return SimpleNamespace(
        **_motion(design, columns, 1e-3),
        g=SimpleNamespace(**hand),
        loading=loading,
        omega=of("shaft.speed_rpm") * (TURN / 60.0),
    )


def cam_slider(g: Any, u: np.ndarray, k: np.ndarray) -> Sequence[np.ndarray]:
    """Pressure angle, contact force, torque, as ``forces.of_motion``."""
    y = moved(g, u, k)
    there = SimpleNamespace(motion=SimpleNamespace(y=y))
    roller, normal, (contact, torque) = of_motion(there, g.loading, g.omega, np.sign(g.rise[k]), g.g)
    arm = roller - PIVOT  # it travels across
    across, along = arm.real * normal.imag - arm.imag * normal.real, arm.real * normal.real + arm.imag * normal.imag
    return np.rad2deg(np.arctan(np.abs(along / across))), contact, torque


# -- a four-bar with masses: reactions ----------------------------------------------------------------------------


def _bar_numbers(design: Design, columns: Mapping[str, np.ndarray]) -> Any:
    lengths = [1e-3 * columns.get(f"linkage.links[{i}].points.{p}.x_mm", np.array(x)) for i, p, x in BARS]
    omega = columns.get("linkage.driver.speed_rpm", 60.0) * (TURN / 60.0)
    return SimpleNamespace(lengths=lengths, square=omega * omega)


BARS = ((0, "O4", 100.0), (1, "A", 30.0), (2, "B", 90.0), (3, "B", 70.0))
MASSES = ((2, 0.5, 2e-4, 15.0), (3, 1.2, 1.5e-3, 45.0), (4, 0.9, 8e-4, 35.0))
"""Link, mass, inertia about its centre, which lies on the link so far from its first point [mm]."""


def _cross(a: Any, b: Any) -> Any:
    return a.real * b.imag - a.imag * b.real


def four_bar(g: Any, theta: np.ndarray, k: np.ndarray) -> Sequence[np.ndarray]:
    """Forces at A and O4, torque of the crank: coupler and rocker by their moments about A and O4."""
    ground, crank, coupler, rocker = g.lengths
    a = crank * np.exp(1j * theta)
    d = ground - a
    square = d.real * d.real + d.imag * d.imag
    along = (0.5 * (coupler**2 - rocker**2)) / square + 0.5
    b = d * (along + 1j * np.sqrt(coupler**2 / square - along * along))
    r = b - d
    across = _cross(b, r)
    speed_b, speed_r = -_cross(a, r) / across, _cross(b, a) / -across
    known = a - speed_r * speed_r * r + speed_b * speed_b * b
    gain_b, gain_r = (
        (known.real * r.real + known.imag * r.imag) / across,
        (known.real * b.real + known.imag * b.imag) / across,
    )
    (m2, _, c2), (m3, j3, c3), (m4, j4, c4) = [(m, j, 1e-3 * c) for _, m, j, c in MASSES]
    at2, at3, at4 = c2 / crank * a, c3 / coupler * b, c4 / rocker * r
    weight = -9.80665j
    lost2 = m2 * (weight + g.square * at2)
    lost3 = m3 * (weight - g.square * (-a + (1j * gain_b - speed_b**2) * at3))
    lost4 = m4 * (weight - g.square * (1j * gain_r - speed_r**2) * at4)
    moment3 = j3 * g.square * gain_b - _cross(at3, lost3)
    moment4 = _cross(at4, lost4) - j4 * g.square * gain_r
    at_b = (moment3 * r - moment4 * b) / across
    at_a = -at_b - lost3
    return np.abs(at_a), np.abs(at_b - lost4), _cross(a, at_a) - _cross(at2, lost2)


# -- rows ---------------------------------------------------------------------------------------------------------


def _example(name: str, *spans_and_rises: tuple[float, float]) -> Design:
    design = load(EXAMPLES / f"{name}.toml")
    sine = NamedCurve("modified-sine")
    segments = tuple(Segment(span, rise, sine) if rise else Segment(span, rise) for span, rise in spans_and_rises)
    return with_drive(design, motion=Motion(0.0, segments)) if segments else design


def _heavy() -> Design:
    design = _example("four_bar")
    masses = tuple(
        LinkMass(link=link, mass_kg=mass, inertia_kg_m2=inertia, centre_x_mm=centre, centre_y_mm=0.0)
        for link, mass, inertia, centre in MASSES
    )
    return with_drive(design, loads=replace(design.drive.loads, masses=masses))


ROLLER = _example("dwell_rise_dwell", (60.0, 0.0), (120.0, 20.0), (40.0, 0.0), (140.0, -20.0))
FORCES = ("pressure_angle_deg:max", "contact_force_n:max", "drive_torque_nm:max")
RADII = {"cam.base_radius_mm": (50.0, 70.0), "shaft.speed_rpm": (50.0, 150.0)}

ROWS = (
    Designs("translating roller", ROLLER, {**RADII, "follower.offset_mm": (0.0, 8.0)}, FORCES,
            translating_roller, _roller_numbers),
    Designs("varied spans", ROLLER, {**RADII, "motion.segments[1].span_deg": (110.0, 130.0),
            "motion.segments[3].span_deg": (130.0, 150.0)}, FORCES, translating_roller, _roller_numbers),
    Designs("flat rocker", _example("rocker_flat"), {"cam.base_radius_mm": (35.0, 45.0),
            "shaft.speed_rpm": (200.0, 300.0), "loads.contact_friction": (0.0, 0.15)}, FORCES, flat_rocker, _rocker_numbers),
    Designs("cam-slider with friction", LIFT, {"follower.rod_mm": (830.0, 870.0), "cam.base_radius_mm": (390.0, 420.0),
            "loads.friction": (0.0, 0.2), "shaft.speed_rpm": (10.0, 20.0)}, FORCES, cam_slider, _lift_numbers),
    Designs("four-bars with reactions", _heavy(), {"linkage.links[2].points.B.x_mm": (85.0, 95.0),
            "linkage.links[3].points.B.x_mm": (68.0, 75.0)}, ("A_n:max", "O4_n:max", "driver_torque_nm:max"),
            four_bar, _bar_numbers),
)  # fmt: skip


# -- totals of a turn, by one force of the same designs -----------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Totals:
    """One row: designs that differ at some paths, a total of them, and the figure of one force it is measured by."""

    name: str
    design: Design
    varied: Mapping[str, tuple[float, float]]
    total: str
    force: str = "drive_torque_nm:abs"
    count: int = COUNT

    @cached_property
    def columns(self) -> dict[str, np.ndarray]:
        rng = np.random.default_rng(5)
        return {path: rng.uniform(*ends, self.count) for path, ends in self.varied.items()}

    def ours(self) -> np.ndarray:
        return many(self.design, self.columns, [self.total]).value[self.total]

    def by_force(self) -> np.ndarray:
        return many(self.design, self.columns, [self.force]).value[self.force]


LEVELLED, UNIT = _example("transfer_lift"), _example("transfer_unit")
LIFTS = {"cam.base_radius_mm": (390.0, 420.0), "shaft.speed_rpm": (10.0, 20.0)}
OF_UNIT = {"drives[2].cam.base_radius_mm": (390.0, 420.0)}

TOTALS = (
    Totals("energy of a turn", LEVELLED, LIFTS, "energy_j"),
    Totals("flywheel", LEVELLED, LIFTS, "flywheel_inertia_kg_m2"),
    Totals("motor torque with a flywheel", LEVELLED, LIFTS, "motor_torque_nm:abs"),
    Totals("torque of a shaft with four drives", UNIT, OF_UNIT, "torque_nm:abs", "drives[2].drive_torque_nm:abs"),
)
