"""Flanks of cams in space against envelopes of the roller's surface with forty digits, and against the roller over the turn."""

from __future__ import annotations

import itertools
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from core.spatial import AHEAD, BEHIND, SIDES, Machine, MotionRows, flank, roller_axis, turned

MACHINES = {
    "barrel": Machine("barrel", "mm", 0.008, 0.0, 0.04, 0.052, 1, 0.0, 0.0, 0.0, None, False),
    "arm": Machine("barrel", "deg", 0.008, 0.0, 0.04, 0.052, 1, 0.07, 0.0, 0.0, None, False),
    "globoid": Machine("globoidal", "deg", 0.008, 0.0, 0.03, 0.042, 6, 0.08, 0.0, 0.0, None, False),
}
TAPERS = (0.0, 0.12, -0.09)
HEIGHT = {"barrel": 0.015, "arm": 0.3, "globoid": 0.35}


def motion(name: str, theta: np.ndarray) -> MotionRows:
    """A smooth periodic motion, y = h (sin θ + 0.2 sin 2θ)."""
    h, y, y_1, y_2 = HEIGHT[name], np.sin(theta), np.cos(theta), -np.sin(theta)
    y, y_1, y_2 = y + 0.2 * np.sin(2.0 * theta), y_1 + 0.4 * np.cos(2.0 * theta), y_2 - 0.8 * np.sin(2.0 * theta)
    return MotionRows(theta, h * y, h * y_1, h * y_2)


def slope(value, x, step="1e-12"):
    """Derivative of a vector by a central difference, whose error is 1e-24 with forty digits."""
    h = mp.mpf(step)
    return [(high - low) / (2 * h) for high, low in zip(value(x + h), value(x - h), strict=True)]


class Envelope:
    """Envelope of the roller's surface X(θ, u, β) in the cam's frame, by its definition det(X_θ, X_u, X_β) = 0."""

    def __init__(self, name: str, machine: Machine, sense: int) -> None:
        self.name, self.machine, self.sense = name, machine, sense

    def y(self, theta):
        return mp.mpf(HEIGHT[self.name]) * (mp.sin(theta) + mp.mpf("0.2") * mp.sin(2 * theta))

    def axis(self, theta, u):
        """Point of the axis, direction of the motion, and two directions across the axis."""
        y, lever = self.y(theta), mp.mpf(self.machine.lever)
        if self.name == "barrel":
            return [u, 0, y], [0, 0, 1], [0, 1, 0], [0, 0, 1]
        if self.name == "arm":
            return [u, lever * (mp.cos(y) - 1), lever * mp.sin(y)], [0, -mp.sin(y), mp.cos(y)], [0, 1, 0], [0, 0, 1]
        across = [mp.sin(y), 0, mp.cos(y)]
        return [lever - u * mp.cos(y), 0, u * mp.sin(y)], across, [0, 1, 0], across

    def in_cam(self, theta, v):
        angle = -self.sense * theta
        return [mp.cos(angle) * v[0] - mp.sin(angle) * v[1], mp.sin(angle) * v[0] + mp.cos(angle) * v[1], v[2]]

    def surface(self, theta, u, beta):
        p, _, first, second = self.axis(theta, u)
        r = mp.mpf(self.machine.radius) - (u - mp.mpf(self.machine.inner)) * mp.tan(mp.mpf(self.machine.taper))
        x = [p[i] + r * (mp.cos(beta) * first[i] + mp.sin(beta) * second[i]) for i in range(3)]
        return self.in_cam(theta, x)

    def _columns(self, theta, u, beta):
        return (
            slope(lambda x: self.surface(x, u, beta), theta),
            slope(lambda x: self.surface(theta, x, beta), u),
            slope(lambda x: self.surface(theta, u, x), beta),
        )

    def meshing(self, theta, u, beta):
        a, b, c = self._columns(theta, u, beta)
        return sum(a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3]) for i in range(3))

    def normal(self, theta, u, beta):
        """Unit normal of the roller's surface out of the roller, in the cam's frame."""
        _, b, c = self._columns(theta, u, beta)
        n = [b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3] for i in range(3)]
        p, _, _, _ = self.axis(theta, u)
        x, foot = self.surface(theta, u, beta), self.in_cam(theta, p)
        outwards = mp.sign(sum(n[i] * (x[i] - foot[i]) for i in range(3)))
        size = mp.sqrt(sum(v * v for v in n)) * outwards
        return [v / size for v in n]

    def contact(self, theta, u, side):
        """Angle β of the line of contact on a side: n · ∂p/∂y > 0 ahead."""
        for start in np.linspace(0.0, 2.0 * np.pi, 9)[:-1] + 0.1:
            try:
                beta = mp.findroot(lambda b: self.meshing(theta, u, b), mp.mpf(float(start)))
            except ValueError:
                continue
            n, moving = self.normal(theta, u, beta), self.in_cam(theta, self.axis(theta, u)[1])
            if (sum(n[i] * moving[i] for i in range(3)) > 0) == (side == AHEAD):
                return beta
        raise AssertionError("no line of contact")

    def near(self, theta, u, beta):
        """β next to a known one, at neighbouring θ and u."""
        return mp.findroot(lambda b: self.meshing(theta, u, b), beta)

    def curvature(self, theta, u, beta):
        """Normal curvature across the line of contact, by the two fundamental forms."""

        def rows(value):
            by_theta = slope(lambda t: value(t, u, self.near(t, u, beta)), theta)
            return by_theta, slope(lambda v: value(theta, v, self.near(theta, v, beta)), u)

        (s_t, s_u), (n_t, n_u) = rows(self.surface), rows(self.normal)
        dot = lambda a, b: sum(x * y for x, y in zip(a, b, strict=True))  # noqa: E731
        # T = s_t + k s_u with T · s_u = 0
        k = -dot(s_t, s_u) / dot(s_u, s_u)
        t, turning = ([a + k * b for a, b in zip(*rows, strict=True)] for rows in ((s_t, s_u), (n_t, n_u)))
        return -dot(t, turning) / dot(t, t)


CASES = [
    (name, taper, sense, side)
    for name, taper, sense, side in itertools.product(MACHINES, TAPERS[:2], (1, -1), SIDES)
    if not (taper and sense == -1 and side == BEHIND)  # a mirror image of another case
]
SOME = (("barrel", 0.12, 1, BEHIND), ("arm", 0.12, -1, AHEAD), ("globoid", 0.0, 1, AHEAD), ("globoid", 0.12, 1, BEHIND))


@pytest.mark.parametrize(
    ("name", "taper", "sense", "side"),
    [pytest.param(*case, marks=() if case in SOME else pytest.mark.stress) for case in CASES],
)
def test_flank_normal_pressure_angle_and_curvature_are_those_of_the_envelope(name, taper, sense, side):
    machine, theta, u = replace(MACHINES[name], taper=taper), 0.7, MACHINES[name].inner + 0.004
    envelope = Envelope(name, machine, sense)
    known = flank(machine, motion(name, np.array([theta])), np.array([[u]]), float(sense), side)
    with mp.workdps(40):
        at = mp.mpf(theta), mp.mpf(u)
        beta = envelope.contact(*at, side)
        point, normal = envelope.surface(*at, beta), envelope.normal(*at, beta)
        _, moving, _, _ = envelope.axis(*at)
        slope = abs(sum(n * v for n, v in zip(normal, envelope.in_cam(at[0], moving), strict=True)))
        curvature = float(envelope.curvature(*at, beta))
    assert known.in_cam(known.point)[:, 0, 0] == pytest.approx([float(x) for x in point], abs=1e-14)
    assert known.in_cam(known.normal)[:, 0, 0] == pytest.approx([float(x) for x in normal], abs=1e-12)
    assert known.pressure_angle[0, 0] == pytest.approx(float(mp.acos(slope)), abs=1e-12)
    assert known.curvature[0, 0] == pytest.approx(curvature, rel=1e-9, abs=1e-9)
    assert known.margin[0, 0] > 0.0


@pytest.mark.parametrize(("name", "side", "sense"), list(itertools.product(MACHINES, SIDES, (1.0, -1.0))))
@pytest.mark.parametrize("taper", TAPERS)
def test_no_point_of_a_flank_is_nearer_to_the_roller_than_its_radius(name, taper, side, sense):
    machine = replace(MACHINES[name], taper=taper)
    theta = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
    rows, u = motion(name, theta), np.linspace(machine.inner, machine.outer, 5)[:, None]
    known = flank(machine, rows, u, sense, side)
    assert known.margin.min() > 0.1  # not undercut
    points = known.in_cam(known.point)[:, :, ::24].reshape(3, -1)
    line = roller_axis(machine, rows.y)
    c, a = turned(line.c, -sense * theta), turned(line.a, -sense * theta)
    away = points[:, :, None] - c[:, None]
    along = np.einsum("ipt,it->pt", away, a)
    distance = np.sqrt(np.maximum(np.einsum("ipt,ipt->pt", away, away) - along**2, 0.0))
    gap = (distance - machine.roller_radius(along)) * np.cos(taper)
    gap[(along < machine.inner - 1e-12) | (along > machine.outer + 1e-12)] = np.inf  # beyond the ends of the roller
    least = gap.min(axis=1)
    assert least.min() > -1e-9
    assert np.abs(least).max() < 1e-9  # each point touches the roller once


@pytest.mark.parametrize("side", SIDES)
def test_a_barrel_of_infinite_radius_is_a_plane_cam(side):
    """Pitch curve (s, f(s)) with s = R θ: the flank is its parallel curve at the roller's radius."""
    s, r = np.linspace(0.0, 0.05, 11), 0.008
    k = 60.0
    f, f_1, f_2 = 0.01 * np.sin(k * s), 0.01 * k * np.cos(k * s), -0.01 * k * k * np.sin(k * s)
    pitch = -f_2 / (1.0 + f_1**2) ** 1.5  # positive where the curve is convex upwards
    ahead = pitch / (1.0 + r * pitch) if side == AHEAD else -pitch / (1.0 - r * pitch)
    errors = []
    for radius in (1e3, 1e4):
        machine = replace(MACHINES["barrel"], inner=radius, outer=radius + 0.012)
        known = flank(
            machine, MotionRows(s / radius, f, radius * f_1, radius**2 * f_2), np.array([[radius]]), 1.0, side
        )
        assert known.pressure_angle[0] == pytest.approx(np.arctan(np.abs(f_1)), abs=1e-12)
        errors.append(np.abs(known.curvature[0] + ahead).max())
    assert errors[1] < 1e-2
    assert errors[1] < 0.2 * errors[0]


def test_pressure_angle_of_a_barrel_in_closed_form():
    """Barrel with a sliding roller: tan ψ = |s'|/u, at every distance."""
    theta = np.linspace(0.0, 6.0, 50)
    machine, rows = MACHINES["barrel"], motion("barrel", theta)
    u = np.linspace(machine.inner, machine.outer, 7)[:, None]
    for side in SIDES:
        angle = flank(machine, rows, u, 1.0, side).pressure_angle
        assert angle == pytest.approx(np.arctan(np.abs(rows.y_1) / u), abs=1e-14)


def test_pressure_angle_of_a_globoidal_cam_in_closed_form():
    """Globoidal cam: tan ψ = u |φ'|/(D - u cos φ)."""
    theta = np.linspace(0.0, 6.0, 50)
    machine, rows = MACHINES["globoid"], motion("globoid", theta)
    u = np.linspace(machine.inner, machine.outer, 7)[:, None]
    angle = flank(machine, rows, u, -1.0, AHEAD).pressure_angle
    assert angle == pytest.approx(np.arctan(u * np.abs(rows.y_1) / (machine.lever - u * np.cos(rows.y))), abs=1e-14)


@pytest.mark.parametrize(("name", "side", "sense"), list(itertools.product(MACHINES, SIDES, (1.0, -1.0))))
def test_derivatives_of_point_and_normal_are_those_of_differences(name, side, sense):
    """Central differences of fourth order in the frame of the cam."""
    machine, theta, u = (
        replace(MACHINES[name], taper=0.12),
        np.linspace(0.1, 6.0, 9),
        np.array([[MACHINES[name].middle]]),
    )
    known, h = flank(machine, motion(name, theta), u, sense, side), 1e-3

    def vectors(theta, u):
        there = flank(machine, motion(name, theta), u, sense, side)
        return np.array([there.cam_point, there.in_cam(there.normal)])

    def difference(at):
        return (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)

    by_theta, by_u = (
        difference(lambda x: vectors(theta + x, u)),
        difference(lambda x: vectors(theta, u + 1e-2 * x)) * 1e2,
    )
    for ours, theirs in zip(
        (known.by_theta, known.normal_by_theta, known.by_u, known.normal_by_u), (*by_theta, *by_u), strict=True
    ):
        assert known.in_cam(ours) == pytest.approx(theirs, abs=1e-8)
