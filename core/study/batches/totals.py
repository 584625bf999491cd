"""Totals of a turn of many designs: what they ask of their shaft, energy, flywheel, and the life of their rollers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import inf

import numpy as np

from core import stress
from core.design import Shaft
from core.mechanism.kinematics import SLIDING
from core.motion import Angles
from core.motion.roots import crossings
from core.motion.turn import ShaftPosition
from core.shaft import Flywheel, LoadCurve, combined, panel_angles, peaks, rms
from core.shaft.curve import NODES, fitted, nodes
from core.shaft.energy import energy_ranges
from core.shaft.several import value
from core.study.batches.asked import ENERGY, Asked, of_range
from core.study.batches.together import Together
from core.study.fitted_load import Switch, switches_of
from core.study.study import Study
from core.study.touching import pressing, ratings, roller_speed

WIDE, FEW = (
    np.deg2rad(9.0),
    2,
)  # longest panel of a load, and the least of a piece: where these do not hold it, those of a study are taken
RESOLVED = 1e-8  # of the largest torque: what the last two coefficients of a panel may hold
LIFE_PANEL = np.deg2rad(6.0)
POINTS = 60_000  # cam angles at a time

Places = tuple[np.ndarray, np.ndarray, Angles]
"""Panels (start, width) and the angles of their nodes."""


# -- what a design asks of its shaft -----------------------------------------------------------------------


def loads(one: Together) -> list[LoadCurve | None]:
    """The load of each design by its cam's angle, as ``fitted_load`` has it; None where it is not finite."""
    slides = [f for f in one.loading.frictions if one.mechanism.joined[f.pair].kind == SLIDING]
    switches = [
        one.reader(f"switch {i}", partial(_switch, switch))
        for i, switch in enumerate(switches_of(one.loading, slides, one.holds))
    ]
    rows = [
        one.reader("torque of the shaft", lambda there: there.shaft_torque),
        one.reader("inertia at the shaft", lambda there: there.loading.inertia(there.linkage, 1)[0]),
    ]
    wide = panel_angles(one.program, None, WIDE, FEW)
    sampled = _values(one, [*rows, *switches], [(k, wide[2]) for k in range(one.count)])
    cuts = _cuts(one, switches, wide[2], np.array([each[2:] for each in sampled])) if switches else {}
    places = [panel_angles(one.program, cuts[k], WIDE, FEW) if k in cuts else wide for k in range(one.count)]
    for k, found in zip(cuts, _values(one, rows, [(k, places[k][2]) for k in cuts]), strict=True):
        sampled[k] = found
    rough = [k for k in range(one.count) if np.isfinite(sampled[k]).all() and not _resolved(sampled[k][0])]
    for k in rough:
        places[k] = panel_angles(one.program, cuts.get(k))
    for k, found in zip(rough, _values(one, rows, [(k, places[k][2]) for k in rough]), strict=True):
        sampled[k] = found
    return [_curve(one, k, places[k], sampled[k][:2]) for k in range(one.count)]


def _switch(switch: Switch, there: Study) -> np.ndarray:
    return switch(there.linkage, there.dynamics)


def _values(one: Together, names: Sequence[str], places: Sequence[tuple[int, Angles]]) -> list[np.ndarray]:
    """What is read (k, n) of designs, each at angles of its own."""
    found: list[np.ndarray] = []
    for part in _parts(places):
        sizes = [angles.theta.size for _, angles in part]
        theta, piece = (np.concatenate([getattr(angles, name) for _, angles in part]) for name in ("theta", "piece"))
        owner = np.repeat([k for k, _ in part], sizes)
        values = one.values(names, one.state(theta, piece, owner), owner)
        found += np.split(np.array([values[name] for name in names]), np.cumsum(sizes)[:-1], axis=1)
    return found


def _parts(places: Sequence[tuple[int, Angles]]) -> Iterator[Sequence[tuple[int, Angles]]]:
    """As many of these as are computed at a time."""
    first, count = 0, 0
    for i, (_, angles) in enumerate(places):
        if count and count + angles.theta.size > POINTS:
            yield places[first:i]
            first, count = i, 0
        count += angles.theta.size
    if count:
        yield places[first:]


def _cuts(one: Together, names: Sequence[str], angles: Angles, values: np.ndarray) -> dict[int, Angles]:
    """Designs -> the angles in their pieces where one of these quantities (m, k, n) changes its sign, of those where one does."""
    pieces, count = one.program.starts.size, one.count
    every = Angles(np.tile(angles.theta, count), (np.arange(count)[:, None] * pieces + angles.piece).ravel())

    def there(at: Angles) -> np.ndarray:
        owner = at.piece // pieces
        found = one.values(names, one.state(at.theta, at.piece % pieces, owner), owner)
        return np.array([found[name] for name in names])

    found = crossings(there, every, values.transpose(1, 0, 2).reshape(len(names), -1))
    owner, piece = found.piece // pieces, found.piece % pieces
    return {int(k): Angles(found.theta[owner == k], piece[owner == k]) for k in np.unique(owner)}


def _resolved(torque: np.ndarray) -> bool:
    _, to_chebyshev = nodes()
    c = np.abs(to_chebyshev @ torque.reshape(-1, NODES).T)
    return not c[-2:].max() > RESOLVED * c.max()


def _curve(one: Together, k: int, place: Places, values: np.ndarray) -> LoadCurve | None:
    if not np.isfinite(values).all():
        return None
    start, width, angles = place
    if one.motions is not None:
        owner, piece = np.full(start.size, k), angles.piece[::NODES]
        ends = one.motions.own(start + width, piece, owner)
        start = one.motions.own(start, piece, owner)
        width = ends - start
    torque, inertia = (row.reshape(-1, NODES) for row in values)
    curve = fitted(start, width, torque, inertia)
    turning = Study(one.plain).turning
    return curve if turning > 0.0 else combined([(curve, ShaftPosition(0.0, turning))])


# -- what is asked of it -----------------------------------------------------------------------------------


def asked_of_loads(
    asked: Sequence[Asked], curves: Sequence[LoadCurve | None], shafts: Sequence[Shaft]
) -> tuple[np.ndarray, np.ndarray]:
    """What is asked of m loads on their shafts, and its angle [rad], both (k, m)."""
    value_, theta = np.full((2, len(asked), len(curves)), np.nan)
    good = [k for k, curve in enumerate(curves) if curve is not None]
    there = [(k, curve, shafts[k]) for k, curve in enumerate(curves) if curve is not None]
    for i, each in enumerate(asked):
        if each.of == ENERGY and good:
            low, high = energy_ranges([curve for _, curve, _ in there])
            value_[i, good] = high - low
        for k, curve, shaft in there if each.of in OF_LOAD else ():
            value_[i, k], theta[i, k] = OF_LOAD[each.of](curve, shaft)
    return value_, theta


def _end(of: str, curve: LoadCurve, shaft: Shaft) -> tuple[float, float]:
    found = peaks(curve)
    return of_range(of, *((end.value, end.theta) for end in (found.low, found.high)))


def _flywheel(curve: LoadCurve, shaft: Shaft) -> tuple[float, float]:
    wheel = Flywheel(lambda angles: value(curve, angles.theta), curve, shaft)
    return wheel.needed_inertia, np.nan


OF_LOAD: dict[str, Callable[[LoadCurve, Shaft], tuple[float, float]]] = {
    "flywheel_inertia_kg_m2": _flywheel,
    "mean": lambda curve, shaft: (curve.mean, np.nan),
    "rms": lambda curve, shaft: (rms(curve), np.nan),
    **{of: partial(_end, of) for of in ("max", "min", "abs", "range")},
}


# -- rollers -----------------------------------------------------------------------------------------------


def lives(one: Together) -> np.ndarray:
    """L10 [h] of the shortest-lived roller of each design (m,), as ``roller_lives`` has them, of an open cam; NaN where none is rated."""
    rated = {} if one.loading.empty else ratings(Study(one.design))
    if not rated:
        return np.full(one.count, np.nan)

    names = []
    for roller in rated:
        names.append(one.reader(f"force {roller}", partial(pressing, roller=roller)))
        names.append(one.reader(f"speed {roller}", partial(_speed, roller)))
    angles, weight = stress.turn_nodes(one.program, (), LIFE_PANEL)
    values = np.array(_values(one, names, [(k, angles) for k in range(one.count)]))
    if one.motions is not None:
        weight = weight * one.motions.stretched()[:, angles.piece]
    omega = np.broadcast_to(np.asarray(Study(one.design).omega), one.count)
    least = np.full(one.count, inf)
    for i, rating in enumerate(rated.values()):
        *_, hours = stress.lives_of(np.asarray(rating), values[:, 2 * i], values[:, 2 * i + 1], weight, omega)
        least = np.minimum(least, hours)
    return least


def _speed(roller: str, there: Study) -> np.ndarray:
    """Of a roller by cam angle (n,)."""
    return roller_speed(there, roller) / there.omega
