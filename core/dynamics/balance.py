"""Proof of the forces by laws they were not computed from: power, and linear and angular momentum of all bodies."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from core.cam import CamShape
from core.dynamics.forces import Forces
from core.dynamics.loading import Inertia, Loading
from core.train import FRAME, Train
from core.vectors import cross, dot


def _motions(train: Train, loading: Loading, omega: float) -> list[tuple[float, float, np.ndarray, np.ndarray]]:
    """mass, inertia, centre (4, n) by time, angle (4, n) by time of every body that has mass."""
    rates = omega ** np.arange(4)[:, None]
    found = []
    for name, inertia in loading.inertias.items():
        pose = train.bodies[name]
        found.append((inertia.mass, inertia.about_centre, pose.at(inertia.centre) * rates, pose.angle * rates))
    return found


def reduced_inertia(train: Train, inertias: Mapping[str, Inertia]) -> np.ndarray:
    """J_e = Σ m |z'|² + I α'² (n,) [kg m²]: what the moved bodies are worth at the camshaft, KE = ½ J_e ω²."""
    total = np.zeros(train.theta.size)
    for name, inertia in inertias.items():
        pose = train.bodies[name]
        total += inertia.mass * np.abs(pose.derivative(inertia.centre, 1)) ** 2 + inertia.about_centre * pose.turn[1] ** 2
    return total


def kinetic_energy(train: Train, loading: Loading, omega: float) -> np.ndarray:
    """KE (n,) [J] of all moved bodies."""
    return 0.5 * omega * omega * reduced_inertia(train, loading.inertias)


@np.errstate(invalid="ignore")  # inf - inf where the guide jams, which counts as balanced
def power_residual(train: Train, shape: CamShape, forces: Forces, loading: Loading) -> np.ndarray:
    """T_c ω - [d(KE)/dt + d(PE)/dt - F L̇ + μ|N||L̇|] (n,), relative to the peak of its terms and of ω|R||F_c|, the
    product that T_c ω is taken from: where the cam only holds, nothing else is left."""
    omega = forces.omega
    drive = forces.torque * omega
    speed = train.motion.y[1] * omega
    output = -loading.along_guide(train.motion.y[0]) * speed
    lost = -forces.guide.friction * speed
    kinetic, potential = np.zeros_like(drive), np.zeros_like(drive)
    for mass, about, z, a in _motions(train, loading, omega):
        kinetic = kinetic + mass * dot(z[1], z[2]) + about * a[1] * a[2]
        potential = potential - mass * dot(z[1], np.asarray(loading.gravity))
    product = omega * np.abs(shape.reference) * forces.contact
    return _relative(drive - kinetic - potential - output - lost, (product, kinetic, potential, output, lost))


@np.errstate(invalid="ignore")
def momentum_residual(train: Train, shape: CamShape, forces: Forces, loading: Loading) -> np.ndarray:
    """Sum of outer forces, and of their moments about the cam centre, against the rates of linear and angular
    momentum (n,), each relative to the peak of its terms, of a moment |r||F|. Power alone cannot see an error in a pin, the pivot or a
    frictionless guide.

    Outer forces are those of the frame, of the cam, gravity and the force along the guide.
    """
    body = train.bodies[train.output]
    line = train.pairs[_guide_of(train)]
    push = loading.along_guide(train.motion.y[0]) * line.axis
    outer: list[tuple[np.ndarray, np.ndarray]] = [(push, body.origin[0])]
    for name, pair in train.pairs.items():
        if pair.on == FRAME:
            outer.append((forces.pairs[name], train.bodies[pair.body].place(pair.point)))
    outer.append((-forces.contact * shape.flank.normal, shape.reference))
    change: list[np.ndarray] = []
    turn: list[np.ndarray] = []
    for mass, about, z, a in _motions(train, loading, forces.omega):
        outer.append((np.full_like(z[0], mass * loading.gravity), z[0]))
        change.append(mass * z[2])
        turn.append(mass * cross(z[0], z[2]) + about * a[2])
    moments = [cross(r, f) for f, r in outer]
    linear = np.asarray(sum(f for f, _ in outer) - sum(change))
    angular = np.asarray(sum(moments) - sum(turn))
    products = [np.abs(r) * np.abs(f) for f, r in outer]
    return np.maximum(_relative(np.abs(linear), [f for f, _ in outer] + change), _relative(angular, products + turn))


def _guide_of(train: Train) -> str:
    return next(name for name, pair in train.pairs.items() if pair.body == train.output and pair.on == FRAME)


def _relative(residual: np.ndarray, terms: tuple[np.ndarray, ...] | list[np.ndarray]) -> np.ndarray:
    finite = np.isfinite(residual)
    peak = max((float(np.abs(t[np.isfinite(t)]).max(initial=0.0)) for t in terms), default=0.0)
    return np.where(finite, np.abs(residual), 0.0) / (peak or 1.0)
