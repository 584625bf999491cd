"""Instant velocity centres, in homogeneous coordinates: a centre at infinity is a value, not a division by zero."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from core.train import REVOLUTE, SLIDING, Train


@dataclass(frozen=True, eq=False)
class Centres:
    """point (n,) complex and weight (n,): the centre is point/weight; weight 0 = at infinity in direction point."""

    point: np.ndarray
    weight: np.ndarray

    @property
    def finite(self) -> np.ndarray:
        """(n,) complex [m], inf where at infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.weight == 0.0, complex(np.inf, np.inf), self.point / self.weight)


def _through_pivot(train: Train, sense: float) -> Centres:
    """Kennedy: on the line cam centre - pivot P; q = Zxy φ'/(φ'-d) (Shin1995 (18) counts φ' against the cam)."""
    pair = train.pairs[train.ground]
    pivot, turn = train.bodies[pair.body].point(pair.point)[0], train.bodies[pair.body].angle[1]
    return Centres(pivot * turn, turn - sense)


def _across_guide(train: Train, sense: float) -> Centres:
    """Kennedy: the follower turns about infinity across its guide e, so Q = -i d s' e."""
    pair = train.pairs[train.ground]
    speed = (train.bodies[pair.body].z[1] / pair.axis).real
    return Centres(-1j * sense * speed * pair.axis, np.ones_like(speed))


CAM_CENTRES: Mapping[str, Callable[[Train, float], Centres]] = MappingProxyType(
    {REVOLUTE: _through_pivot, SLIDING: _across_guide}
)


def cam_follower_centre(train: Train, sense: float) -> Centres:
    """Centre of the follower body relative to the cam (Shin1995 §3), by the three-centres theorem from the pair
    that holds the follower on the frame; sense: d = +1 for a cam turning counter-clockwise, -1 clockwise."""
    return CAM_CENTRES[train.pairs[train.ground].kind](train, sense)
