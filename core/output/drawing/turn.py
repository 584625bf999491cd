"""Curves over one turn for plots: segments of the motion, points of a curve, rounding noise, ranges of axes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from math import isfinite
from types import MappingProxyType

import numpy as np

from core.design import Motion
from core.dynamics import Forces
from core.frozen import frozen
from core.laws import named_law
from core.motion import Angles
from core.plot import Span
from core.study import Quantity, Study

# -- segments and samples ---------------------------------------------------------------------------------------


def spans(motion: Motion | None) -> list[Span]:
    """Segments of a motion in order; an empty list without a motion."""
    result, start = [], 0.0
    for segment in motion.segments if motion is not None else ():
        law = named_law(segment.curve.law)
        result.append(Span(start, start + segment.span_deg, law.label, law.short_name))
        start += segment.span_deg
    return result


@frozen(eq=False)
class TurnSamples:
    """Points of a curve over the turn.

    Attributes
    ----------
    angles : ndarray (m,) [deg]
    samples : ndarray (m,) of int, index of each point's sample; -1 in a gap
    """

    angles: np.ndarray
    samples: np.ndarray

    def of(self, values: np.ndarray, gain: float = 0.0) -> np.ndarray:
        """Values along the curve.

        Parameters
        ----------
        values : ndarray (n,) [any unit]
            Values of the samples.
        gain : float
            Their increase in one turn.

        Returns
        -------
        ndarray (m,) [unit of the values], NaN in gaps
        """
        along = np.where(self.samples < 0, np.nan, values[self.samples])
        return along + gain * (self.angles >= 360.0) if gain else along

    def alike(self, other: TurnSamples | None) -> bool:
        """Whether other samples have the same angles."""
        return other is self or (other is not None and np.array_equal(self.angles, other.angles))


def line_of(study: Study) -> TurnSamples:
    """Points of a study's curves, closed over the turn, with gaps where the mechanism has no position."""
    return _line_at(study.angles, study.samples)


@lru_cache(maxsize=8)  # most studies share their angles
def _line_at(at: Angles, samples_per_turn: int) -> TurnSamples:
    degrees, n = np.rad2deg(at.theta), at.theta.size
    if n == samples_per_turn:
        return TurnSamples(np.append(degrees, 360.0), np.append(np.arange(n), 0))
    cuts = np.flatnonzero(np.diff(degrees) > 1.5 * 360.0 / samples_per_turn) + 1
    angles, samples = degrees, np.arange(n)
    if n and degrees[0] == 0.0 and 360.0 - degrees[-1] < 1.5 * 360.0 / samples_per_turn:
        angles, samples = np.append(angles, 360.0), np.append(samples, 0)
    return TurnSamples(np.insert(angles, cuts, degrees[cuts]), np.insert(samples, cuts, -1))


def moving(study: Study) -> np.ndarray:
    """Samples at which the mechanism moves; all True where it is always at rest.

    Returns
    -------
    ndarray (n,) of bool, dimensionless
    """
    if "motion" not in study.stages:
        return np.ones(study.theta.size, dtype=bool)
    moves = study.motion.y[1] != 0.0
    return moves if moves.any() else ~moves


# -- size below which a value is zero ---------------------------------------------------------------------------

# In a dwell the contact normal passes through the cam's centre. The torque is then the difference of two equal
# products, and an axis fitted to it would show nothing but rounding noise.

ROUNDING = 256.0 * np.finfo(float).eps  # rounding error of a zero, in natural sizes
_ORDERS: Mapping[str, int] = MappingProxyType({"/s": 1, "/s²": 2, "/s³": 3})


def _reach(study: Study) -> float:
    """Length characteristic of the mechanism's size [m]."""
    return study.driver_ranges.plan.size if study.mechanism.ranged else study.reach


def _stroke(study: Study) -> float:
    """Greatest displacement of the motion [m or rad]."""
    return float(np.abs(study.motion.displacement[0]).max())


@lru_cache(maxsize=4)
def force_size(forces: Forces) -> float:
    """Largest finite force on any pair [N]."""
    rows = np.array(list(forces.pairs.values()))
    squares = rows.real**2 + rows.imag**2
    return float(np.sqrt(squares.max(where=np.isfinite(squares), initial=0.0)))


def torque_size(study: Study) -> float:
    """Torque of the largest force on the arm of the follower's reference point [N m]."""
    return force_size(study.dynamics) * _reach(study)


_SIZES: Mapping[str, Callable[[Study], float]] = MappingProxyType(
    {
        "mm": _reach,
        "1/mm": lambda study: 1.0 / _reach(study),
        "N": lambda study: force_size(study.dynamics),
        "N·m": torque_size,
    }
)
"""Unit of a channel, without the time of a rate -> natural size of the quantity [SI]; 1 for angles and ratios."""


def floor_of(study: Study, row: Quantity) -> float:
    """Size below which a channel's values count as zero, in the channel's unit.

    Raises
    ------
    NoSolution
        Where the channel's stage has no solution.
    """
    symbol, slash, rate = row.unit.symbol.partition("/s")
    order = _ORDERS.get(slash + rate, 0)
    natural_size = _stroke if row.stage == "motion" else _SIZES.get(symbol, lambda study: 1.0)
    return ROUNDING * natural_size(study) * abs(study.omega) ** order / row.unit.factor


def without_noise(values: np.ndarray, floor: float) -> np.ndarray:
    """Values, or zeros where none exceeds the floor.

    Parameters
    ----------
    values : ndarray (n,) [any unit]
    floor : float
        Size below which a value is rounding noise.

    Returns
    -------
    ndarray (n,) [unit of the values]
    """
    return values if bool((np.abs(values) > floor).any()) else np.where(np.isnan(values), values, 0.0)


# -- ranges of axes ---------------------------------------------------------------------------------------------

FREE = 0.07  # of the values' range, left free above and below
FAR_LIMIT = 3.0  # a limit is not shown where it exceeds so many times the largest value
SPIKE = 3.0  # a spike exceeds the range of the other values by so many times that range
REST, CORE = 0.02, 0.05  # share of the lowest and highest values left out of that range, and of the range then shown
FROM_ZERO = frozenset({"velocity", "acceleration", "jerk", "pressure-angle", "force", "torque", "curvature", "ratio"})
"""Families whose axis always shows 0; places, lengths and angles show it only where it is near."""


def typical_range(values: np.ndarray) -> tuple[float, float]:
    """Least and largest value; where some are infinite, without those that come close to infinity.

    Parameters
    ----------
    values : ndarray (n,) [any unit]

    Returns
    -------
    tuple of float
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        return 0.0, 0.0
    low, high = float(finite.min()), float(finite.max())
    if finite.size < values.size or not isfinite(high - low):
        inner = np.percentile(finite, (2.0, 98.0))
        spread = 0.5 * float(inner[1] - inner[0])
        return max(low, float(inner[0]) - spread), min(high, float(inner[1]) + spread)
    return low, high


def readable_range(values: np.ndarray, moving: np.ndarray) -> tuple[float, float]:
    """Range of the values without spikes, such as those of a torque near a dead centre.

    Parameters
    ----------
    values : ndarray (n,) [unit of the axis]
    moving : ndarray (n,) of bool, dimensionless
        Samples at which the mechanism moves. Dwells are shown, but do not decide which values are spikes.
    """
    low, high = typical_range(values)
    known = np.isfinite(values)
    ordered, resting = np.sort(values[known & moving]), values[known & ~moving]
    if not _exceeds(low, high, *_trimmed_range(ordered, REST)):
        return low, high
    inner = _trimmed_range(ordered, CORE)
    room = 0.5 * (inner[1] - inner[0])
    shown = (
        inner[0] - room if _exceeds(low, inner[1], *inner) else low,
        inner[1] + room if _exceeds(inner[0], high, *inner) else high,
    )
    return (min(shown[0], *resting), max(shown[1], *resting)) if resting.size else shown


def _trimmed_range(ordered: np.ndarray, share: float) -> tuple[float, float]:
    """Lowest and highest of sorted values (n,) without this share of either end."""
    cut = int(share * ordered.size)
    return (float(ordered[cut]), float(ordered[-1 - cut])) if ordered.size else (0.0, 0.0)


def _exceeds(low: float, high: float, inner_low: float, inner_high: float) -> bool:
    """Whether a range extends far beyond an inner one."""
    return 0.0 < SPIKE * (inner_high - inner_low) < max(inner_low - low, high - inner_high)


def peak(rows: Sequence[np.ndarray]) -> float:
    """Largest absolute value of the typical ranges of several curves.

    Parameters
    ----------
    rows : sequence of ndarray (n,) [any unit]

    Returns
    -------
    float
    """
    return max(max(abs(end) for end in typical_range(values)) for values in rows)


def shown_range(rows: Sequence[np.ndarray], families: Iterable[str], limits: Sequence[float]) -> tuple[float, float]:
    """Ends of the axis for curves and limits in one unit.

    Parameters
    ----------
    rows : sequence of ndarray (n,) [unit of the axis]
    families : iterable of str
        Families of the curves.
    limits : sequence of float

    Returns
    -------
    tuple of float
    """
    return axis_range([typical_range(values) for values in rows], families, limits)


def axis_range(
    ranges: Sequence[tuple[float, float]], families: Iterable[str], limits: Sequence[float], free: float = FREE
) -> tuple[float, float]:
    """Ends of the axis for curves with these ranges; ``free`` is the part of it left free above and below."""
    low, high = min(low for low, _ in ranges), max(high for _, high in ranges)
    near = 0.3 * (high - low)
    if FROM_ZERO.intersection(families) or 0.0 < low < near or -near < high < 0.0:
        low, high = min(low, 0.0), max(high, 0.0)
    for limit in limits:
        if abs(limit) <= FAR_LIMIT * max(abs(low), abs(high)):
            low, high = min(low, limit), max(high, limit)
    size = max(abs(low), abs(high))
    if high - low <= 1e-9 * size or high == low:
        half = 0.1 * size or 1.0
        low, high = low - half, high + half
    room = free * (high - low)
    return low - room, high + room
