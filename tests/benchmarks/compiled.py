"""The lift's law, forces and whole chain as loops over cam angles, compiled by numba where that is there."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from benchmarks.plain import GAIN, HAND, JOINS, LEVEL, SENSE, SIDE, SPANS, K


def _numbers(loading: Any, omega: float) -> tuple[Any, ...]:
    """Of arm, rod and slider mass, weight, and centre by the length of the link; force of the output; inertias by the square of the
    length; friction, ω²."""
    arm, rod, slider = ({mass.body: mass for mass in loading.masses}[name] for name in ("arm", "rod", "slider"))
    return (
        (arm.inertia.mass, complex(arm.gravity), complex(arm.inertia.centre) / HAND.slider_arm),
        (rod.inertia.mass, complex(rod.gravity), rod.inertia.centre.real / HAND.rod),
        (slider.inertia.mass, complex(slider.gravity), complex(loading.others[0].force)),
        (arm.inertia.about_centre / HAND.slider_arm**2, rod.inertia.about_centre / HAND.rod**2),
        (loading.friction, omega * omega),
    )


@cache
def _compiled() -> Any:
    """Law, forces and chain: the same formulas as by hand, of one cam angle after the other."""
    from numba import njit

    pi, k, side, sense, joins, spans, gains, levels = np.pi, K, SIDE, SENSE, JOINS, SPANS, GAIN, LEVEL
    l1, l2, height, pivot, base = HAND.slider_arm, HAND.rod, HAND.guide_height, HAND.pivot, HAND.base
    ahead = HAND.roller_arm / l1 * np.exp(1j * HAND.fixed_angle)

    @njit
    def law(u):  # type: ignore[no-untyped-def]
        start, size, wave, shift = 0.0, 0.25 * k, 4.0 * pi, 0.0
        if u > 0.875:
            start = 4.0 * k
        elif u > 0.125:
            start, size, wave, shift = 2.0 * k, 2.25 * k, 4.0 * pi / 3.0, pi / 3.0
        sine, cosine = np.sin(wave * u + shift), np.cos(wave * u + shift)
        return start + pi * k * u - size * sine, pi * k - wave * size * cosine, wave * wave * size * sine

    @njit
    def laws(u):  # type: ignore[no-untyped-def]
        found = np.empty((3, u.size))
        for i in range(u.size):
            found[0, i], found[1, i], found[2, i] = law(u[i])
        return found

    @njit
    def cross(a, b):  # type: ignore[no-untyped-def]
        return a.real * b.imag - a.imag * b.real

    @njit
    def statics(pin, pin_a, roller, gain, gain_a, normal, way, numbers):  # type: ignore[no-untyped-def]
        arm, rod, slider, inertia, (friction, square) = numbers
        along, turned = pin_a - pin, gain_a - gain
        lost_arm = arm[0] * (arm[1] - square * arm[2] * gain)
        lost_rod = rod[0] * (rod[1] - square * (gain + rod[2] * turned))
        carried = slider[0] * (slider[1] - square * gain_a) + slider[2]
        moment = inertia[1] * square * cross(along, turned) - rod[2] * cross(along, lost_rod) - cross(along, carried)
        grip = friction * way * np.sign(moment / along.real)
        guide = moment / (along.real + grip * along.imag)
        held = cross(pin - pivot, lost_rod + carried + guide * (1j - grip)) + cross(arm[2] * (pin - pivot), lost_arm)
        held -= inertia[0] * square * cross(pin - pivot, gain)
        contact = held / cross(roller - pivot, normal)
        return contact, -sense * contact * cross(roller, normal)

    @njit
    def forces(pin, pin_a, roller, gain, gain_a, normal, way, numbers):  # type: ignore[no-untyped-def]
        found = np.empty((2, pin.size))
        for i in range(pin.size):
            told = statics(pin[i], pin_a[i], roller[i], gain[i], gain_a[i], normal[i], way[i], numbers)
            found[0, i], found[1, i] = told
        return found

    @njit
    def chain(theta, numbers):  # type: ignore[no-untyped-def]
        found = np.empty((2, theta.size))
        for i in range(theta.size):
            part = min(max(np.searchsorted(joins, theta[i], side="right") - 1, 0), 4)
            y, v, a = levels[part], 0.0, 0.0
            if gains[part] != 0.0:
                s, ds, dds = law((theta[i] - joins[part]) / spans[part])
                y, v, a = y + gains[part] * s, gains[part] * ds / spans[part], gains[part] * dds / spans[part] ** 2
            to = complex(base + y, height)
            square = to.real * to.real + height * height
            along = 0.5 * (l1 * l1 - l2 * l2) / square + 0.5
            pin = to * complex(along, side * np.sqrt(l1 * l1 / square - along * along))
            rod = (to - pin) / l2
            across = rod.real * pin.imag - rod.imag * pin.real
            p, b = -v * rod.real / across, v * pin.real / (l2 * across)
            push = a * rod.real + p * p * (rod.real * pin.real + rod.imag * pin.imag) + l2 * b * b
            gain, roller = complex(-p * p, -push / across) * pin, pivot + ahead * pin
            normal = (ahead * 1j * p * pin - 1j * sense * roller) * (-1j * sense)
            normal /= abs(normal)
            told = statics(pivot + pin, pivot + to, roller, gain, a + 0j, normal, np.sign(v), numbers)
            found[0, i], found[1, i] = told
        return found

    return laws, forces, chain


def law(u: np.ndarray, setting: None) -> Any:
    return _compiled()[0](u)


def forces(there: Any, setting: None) -> Any:
    rod, slider = there.kinematics.bodies["rod"].origin, there.kinematics.bodies["slider"].origin
    way = np.broadcast_to(there.motion.velocity_sign, there.theta.shape).astype(float)
    rows = (rod[0], slider[0], there.kinematics.follower.origin[0], rod[2], slider[2] + 0j, there.shape.flank.normal)
    return _compiled()[1](*rows, way, _numbers(there.loading, there.omega))


def chain(there: Any, setting: None) -> Any:
    return _compiled()[2](there.theta, _numbers(there.loading, there.omega))
