"""How large a quantity naturally is in a design: below the rounding of that it is zero, whatever its digits are.

In a dwell the contact normal passes through the cam's centre, so that the torque is the difference of two equal
products; drawn to its own scale it would be a storm of noise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from core.dynamics import Forces
from core.study import Quantity, Study

ROUNDING = 256.0 * np.finfo(float).eps  # of the natural size: what rounding leaves of a zero
_ORDERS: Mapping[str, int] = MappingProxyType({"/s": 1, "/s²": 2, "/s³": 3})


def _reach(study: Study) -> float:
    """A length characteristic of the mechanism's size [m]."""
    return study.driver_ranges.plan.size if study.mechanism.ranged else study.reach


def _motion(study: Study) -> float:
    return float(np.abs(study.motion.displacement[0]).max())


def _one(study: Study) -> float:
    return 1.0


def _force(study: Study) -> float:
    return force_size(study.dynamics)


_SIZES: Mapping[str, Callable[[Study], float]] = MappingProxyType(
    {
        "mm": _reach,
        "1/mm": lambda study: 1.0 / _reach(study),
        "N": _force,
        "N·m": lambda study: torque_size(study),
    }
)
"""Unit of a channel, without what makes it a rate -> the natural size of what it counts [SI]; angles and ratios: 1."""


@lru_cache(maxsize=4)
def force_size(forces: Forces) -> float:
    """The largest finite force on any pair [N]."""
    sizes = np.abs(np.array(list(forces.pairs.values())))
    return float(sizes.max(where=np.isfinite(sizes), initial=0.0))


def torque_size(study: Study) -> float:
    """What the largest force would give at the arm of the follower's reference point [N m]."""
    return _force(study) * _reach(study)


def floor_of(study: Study, row: Quantity) -> float:
    """Size below which values of a channel are zero, in its own unit. Raises NoSolution where its stage has none."""
    symbol, slash, rate = row.unit.symbol.partition("/s")
    order = _ORDERS.get(slash + rate, 0)
    natural = _motion if row.stage == "motion" else _SIZES.get(symbol, _one)
    return ROUNDING * natural(study) * abs(study.omega) ** order / row.unit.factor


def without_noise(values: np.ndarray, floor: float) -> np.ndarray:
    """The values (n,); all zero where none stands above the floor."""
    return values if bool((np.abs(values) > floor).any()) else np.where(np.isnan(values), values, 0.0)
