"""What the centres tell: velocity ratios with directed distances, mechanical advantage; velocity differences."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from core.instant_centres.linkage import CentreTable
from core.train import FRAME, Train


def angular_ratio(table: CentreTable, body: str, driver: str) -> np.ndarray:
    """ω_body/ω_driver = I_1d I_db / I_1b I_db, distances directed along the line of the three centres (n,).

    A centre of the body on the frame at infinity gives 0: it does not turn. NaN where the three coincide.
    """
    common, own, other = table.of(driver, body), table.of(FRAME, body), table.of(FRAME, driver)
    to_driver = common.point * other.weight - other.point * common.weight
    to_body = common.point * own.weight - own.point * common.weight
    # the three lie on one line: along the longer of the two arms
    along = np.where(np.abs(to_driver) > np.abs(to_body), to_driver, to_body)
    with np.errstate(divide="ignore", invalid="ignore"):
        above, below = (to_driver * along.conjugate()).real, (to_body * along.conjugate()).real
        return np.asarray(own.weight * above / (other.weight * below))


def mechanical_advantage(table: CentreTable, output: str, driver: str) -> np.ndarray:
    """Torque at the output for a torque of 1 at the driver, without losses: ω_driver/ω_output (n,)."""
    with np.errstate(divide="ignore"):
        return 1.0 / angular_ratio(table, output, driver)


@dataclass(frozen=True, eq=False)
class Difference:
    """One triangle of the velocity polygon, V_P = V_A + V_PA: A and P are points of one body; at A it hangs on another
    body or the frame. at_a, at_p (n,) [m]; velocities (n,) complex, by the train's angle."""

    body: str
    a: str
    p: str
    at_a: np.ndarray
    at_p: np.ndarray
    v_a: np.ndarray
    v_pa: np.ndarray

    @property
    def v_p(self) -> np.ndarray:
        return self.v_a + self.v_pa


def velocity_differences(train: Train) -> Iterator[Difference]:
    """The triangles of every moving body, from the point by which it is reached first (towards the driver) to each of
    its others: V_PA = iω(P - A)."""
    for name, body in train.bodies.items():
        named = [point for point in body.points if not point.isdecimal()]
        if name == FRAME or len(named) < 2:
            continue
        joined = [pair.point for pair in train.pairs.values() if pair.body == name and pair.point in named]
        a = joined[0] if joined else named[0]
        start = body.point(a)
        for p in named:
            if p != a:
                end = body.point(p)
                yield Difference(name, a, p, start[0], end[0], start[1], 1j * body.angle[1] * (end[0] - start[0]))
