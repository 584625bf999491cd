"""Which reactions statics does not fix: those of links that more pairs hold than need be."""

from __future__ import annotations

import numpy as np

from core.dynamics.walk import input_loads
from core.mechanism.kinematics import FRAME, REVOLUTE, Kinematics

_RANK = 1e-9  # of the largest singular value
_SHARE = 1e-7  # of the largest share in what may be added to the reactions


def undetermined_pairs(kinematics: Kinematics) -> frozenset[str]:
    """The pairs whose forces could be others in the same equilibrium: those with a share in the null space of the equations of
    balance of all bodies, A R + loads = 0, at the angle where that is smallest (at a dead centre it is larger). The columns of A are
    the two components of each pair, what drives, and what each second driver gives."""
    if not any(dyad.redundant for dyad in kinematics.dyads):
        return frozenset()
    matrices = _balance(kinematics)
    _, s, vh = np.linalg.svd(matrices[np.isfinite(matrices).all(axis=(1, 2))])
    ranks = (s > _RANK * s[:, :1]).sum(axis=1)
    best = int(ranks.argmax())
    free = np.abs(vh[best, ranks[best] :])
    shares = free.max(axis=0, initial=0.0)
    moved = shares > _SHARE * max(float(shares.max(initial=0.0)), 1e-300)
    return frozenset(name for i, name in enumerate(kinematics.pairs) if moved[2 * i : 2 * i + 2].any())


def _balance(kinematics: Kinematics) -> np.ndarray:
    """A (n, 3 bodies, columns), moments in parts of the size of the mechanism."""
    n = kinematics.theta.size
    bodies = [name for name in kinematics.bodies if name != FRAME]
    inputs = [dyad for dyad in kinematics.dyads if dyad.on]
    matrix = np.zeros((n, 3 * len(bodies), 2 * len(kinematics.pairs) + 1 + len(inputs)))
    places = {name: kinematics.bodies[pair.body].place(pair.point) for name, pair in kinematics.pairs.items()}
    size = max((float(np.abs(at - next(iter(places.values()))).max()) for at in places.values()), default=1.0) or 1.0

    def put(column: int, name: str, force: np.ndarray, couple: float) -> None:
        pair, at = kinematics.pairs[name], places[name]
        for body, sign in ((pair.body, 1.0), (pair.on, -1.0)):
            if body in bodies:
                row = 3 * bodies.index(body)
                matrix[:, row, column] += sign * force.real
                matrix[:, row + 1, column] += sign * force.imag
                matrix[:, row + 2, column] += sign * ((np.conj(at) * force).imag / size + couple)

    for i, (name, pair) in enumerate(kinematics.pairs.items()):
        one = np.ones(1, dtype=complex)
        turns = pair.kind == REVOLUTE
        put(2 * i, name, one if turns else 1j * kinematics.line(pair), 0.0)
        put(2 * i + 1, name, 1j * one if turns else 0.0 * one, 0.0 if turns else 1.0)
    driving, drives = kinematics.driver_pair, 2 * len(kinematics.pairs)
    turns = driving.kind == REVOLUTE
    put(drives, kinematics.driver_name, np.zeros(1, dtype=complex) if turns else kinematics.line(driving), float(turns))
    for i, dyad in enumerate(inputs, 1):
        for _, load in input_loads(kinematics, dyad, np.ones(1)):
            if load.body in bodies:
                row = 3 * bodies.index(load.body)
                matrix[:, row, drives + i] += load.force.real
                matrix[:, row + 1, drives + i] += load.force.imag
                matrix[:, row + 2, drives + i] += (np.conj(load.at) * load.force).imag / size + load.couple
    return matrix
