"""Loads on the shafts of the designs of a block, and their figures: totals, torque, motor."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import inf
from typing import Any, NamedTuple

import numpy as np

from core import stress
from core.design import Shaft, si
from core.mechanism.kinematics import SLIDING
from core.motion import TURN, Angles
from core.motion.extremes import crossings, turn_quadrature
from core.motion.program import CLOSEST
from core.numerics.lazy import once
from core.shaft import LoadCurve, SteadyTurns, inertias_for, load_extremes, motor_inertia, panel_angles, rms
from core.shaft.curve import EVEN, NODES, PanelSize, by_panel, fitted_loads, nodes
from core.shaft.flywheel import by_panels, energy_ranges
from core.study.drive_forces import load_ratings, roller_force, roller_speed
from core.study.highest import clenshaw_curtis_nodes
from core.study.quantity_requests import ENERGY, INERTIA, QuantityRequest, extreme_statistic, mean_statistic
from core.study.stages import Switch, friction_switches
from core.study.stages_of_many import JAM, DesignBlock
from core.study.study import Study

COARSE = PanelSize(np.deg2rad(9.0), 2, TURN, 1)
"""Panels of a load; one that they do not resolve takes those of a study."""
RESOLVED = 1e-8  # of the largest torque: the last two coefficients of a panel that resolves it
LIFE_PANEL = np.deg2rad(6.0)
PANELS_AT_A_TIME = 6_000  # panels evaluated together

MOTOR_TORQUE, MOTOR_SPEED = "motor_torque", "camshaft_speed"
OF_STEADY_SPEED = frozenset({MOTOR_TORQUE, MOTOR_SPEED})
"""Quantities that follow from the speed of a shaft with flywheel and motor."""


# -- load of every design ---------------------------------------------------------------------------------------


class _Panels(NamedTuple):
    """Panels (n,) of all designs, one design after the other, by angles of the plain design.

    Attributes
    ----------
    owner, piece : ndarray (n,), dimensionless
        Numbers of the design and of the piece of its turn.
    start, end : ndarray (n,) [rad]
    values : ndarray (k, n, NODES)
        Torque [N m], inertia [kg m²] and further quantities at the nodes.
    """

    owner: np.ndarray
    piece: np.ndarray
    start: np.ndarray
    end: np.ndarray
    values: np.ndarray

    def at(self, which: np.ndarray) -> _Panels:
        """Some of the panels."""
        return _Panels(self.owner[which], self.piece[which], self.start[which], self.end[which], self.values[:, which])

    def theta(self) -> np.ndarray:
        """Angles of the nodes (n, NODES) [rad]."""
        return np.asarray(self.start[:, None] + (self.end - self.start)[:, None] * nodes()[0])


def load_curves(block: DesignBlock, polish: bool, marks_jams: bool = True) -> list[LoadCurve | None]:
    """Load of every design by its cam angle, as by ``fit_load_curve``; None where it is not finite, or a guide jams.

    With ``marks_jams`` the designs that jam are marked, unless the figures of the block did so; polish: refine the jam.
    """
    slides = [f for f in block.loading.frictions if block.mechanism.pairs_by_name[f.pair].kind == SLIDING]
    switches = [
        block.add_reader(f"switch {i}", partial(_switch, switch))
        for i, switch in enumerate(friction_switches(block.loading, slides, block.is_form_closed))
    ]
    rows = [
        block.add_reader("torque of the shaft", lambda study: study.shaft_torque),
        block.add_reader("inertia at the shaft", lambda study: study.loading.inertia(study.linkage, 1)[0]),
    ]
    every = np.arange(block.count)
    jams = [JAM] if marks_jams and block.loading.has_friction else []
    panels, (*jam, angles) = _divided(block, rows, switches, every, COARSE, jams)
    if jams:
        block.mark_jams(jam[0], angles, polish)
    count = np.bincount(panels.owner, minlength=block.count)
    first = np.cumsum(count) - count
    finite = np.logical_and.reduceat(np.isfinite(panels.values).all(axis=(0, 2)), first)
    finite &= ~block.failed_at("dynamics")
    _, to_chebyshev = nodes()
    coefficients = np.abs(by_panel(to_chebyshev, panels.values[0].T))
    last, largest = (np.maximum.reduceat(c.max(axis=0), first) for c in (coefficients[-2:], coefficients))
    rough = finite & (last > RESOLVED * largest)
    if rough.any():
        finer, _ = _divided(block, rows, switches, every[rough], EVEN)
        parts = [panels.at(~rough[panels.owner]), finer]
        panels = _Panels(*(np.concatenate(rows, axis=min(1, rows[0].ndim - 1)) for rows in zip(*parts, strict=True)))
        panels = panels.at(np.argsort(panels.owner, kind="stable"))
    curves = iter(_fitted(block, panels.at(finite[panels.owner])))
    return [next(curves) if has_load else None for has_load in finite.tolist()]


def _switch(switch: Switch, study: Study) -> np.ndarray:
    return switch(study.linkage, study.dynamics)


def _divided(
    block: DesignBlock,
    rows: Sequence[str],
    switches: Sequence[str],
    designs: np.ndarray,
    size: PanelSize,
    further: Sequence[str] = (),
) -> tuple[_Panels, tuple[Any, ...]]:
    """Panels of some designs (m,), ended where a switch changes its sign too, with the values of the rows.

    Further quantities are returned as they are at the nodes (m, n), before their angles.
    """
    start, width, angles = panel_angles(block.program, None, size)
    m, names = designs.size, [*rows, *switches]
    values = block.at_nodes([*names, *further], angles, designs)
    at_nodes = (*(values[name] for name in further), angles)
    panels = _Panels(
        np.repeat(designs, start.size),
        np.tile(angles.piece[::NODES], m),
        np.tile(start, m),
        np.tile(start + width, m),
        np.array([values[name] for name in names]).reshape(len(names), -1, NODES),
    )
    kept = panels._replace(values=panels.values[: len(rows)])
    if not switches:
        return kept, at_nodes
    changes = _sign_changes(block, switches, panels.owner, panels.piece, panels)
    return (_cut(block, rows, kept, *changes) if changes[0].size else kept), at_nodes


def _sign_changes(
    block: DesignBlock, names: Sequence[str], owner: np.ndarray, piece: np.ndarray, panels: _Panels
) -> tuple[np.ndarray, Angles]:
    """Design, angle and piece at which one of the quantities changes its sign, the last of the values of the panels."""
    pieces = block.program.starts.size

    def values_at(at: Angles) -> np.ndarray:
        owner = at.piece // pieces
        rows = block.values(names, block.state(at.theta, at.piece % pieces, owner), owner)
        return np.array([rows[name] for name in names])

    every = Angles(panels.theta().ravel(), np.repeat(owner * pieces + piece, NODES))
    changes = crossings(values_at, every, panels.values[-len(names) :].reshape(len(names), -1))
    return changes.piece // pieces, Angles(changes.theta, changes.piece % pieces)


def _cut(block: DesignBlock, rows: Sequence[str], panels: _Panels, owner: np.ndarray, cuts: Angles) -> _Panels:
    """The panels, those of the owners (k,) ended at further angles (k,) too."""
    is_panel = np.arange(panels.owner.size + owner.size) < panels.owner.size
    starts = np.concatenate((panels.start, cuts.theta))
    order = np.lexsort((starts, np.concatenate((panels.piece, cuts.piece)), np.concatenate((panels.owner, owner))))
    parent = np.cumsum(is_panel[order]) - 1  # of a cut too
    starts, is_cut = starts[order], ~is_panel[order]
    inside = (np.diff(starts, prepend=-inf) > CLOSEST) & (panels.end[parent] - starts > CLOSEST)
    keep = ~is_cut | inside
    parent, starts = parent[keep], starts[keep]
    ends = np.where(np.diff(parent, append=-1) == 0, np.roll(starts, -1), panels.end[parent])
    result = panels.at(parent)._replace(start=starts, end=ends)
    new = np.flatnonzero((starts != panels.start[parent]) | (ends != panels.end[parent]))
    result.values[:, new] = _values(block, rows, result.at(new))
    return result


def _values(block: DesignBlock, names: Sequence[str], panels: _Panels) -> np.ndarray:
    """Values (k, n, NODES) of k quantities at the nodes of the panels."""
    parts = [np.zeros((len(names), 0, NODES))]
    for first in range(0, panels.owner.size, PANELS_AT_A_TIME):
        part = panels.at(np.arange(first, min(first + PANELS_AT_A_TIME, panels.owner.size)))
        owner, piece = (np.repeat(row, NODES) for row in (part.owner, part.piece))
        values = block.values(names, block.state(part.theta().ravel(), piece, owner), owner)
        parts.append(np.array([values[name] for name in names]).reshape(len(names), -1, NODES))
    return np.concatenate(parts, axis=1)


def _fitted(block: DesignBlock, panels: _Panels) -> list[LoadCurve]:
    """Loads by the rotation of the shaft, of the designs that have panels."""
    owner, piece, start, end, values = panels
    if block.motions is not None:
        start, end = (block.motions.cam_angles(theta, piece, owner) for theta in (start, end))
    if Study(block.plain).turn_sign < 0.0:
        start, end, values = TURN - end, TURN - start, values[:, :, ::-1]
        order = np.lexsort((start, owner))
        owner, start, end, values = owner[order], start[order], end[order], values[:, order]
    counts = np.bincount(owner, minlength=block.count)
    return fitted_loads(counts[counts > 0], start, end - start, values[0], values[1])


# -- figures of loads -------------------------------------------------------------------------------------------


class _Shafts(NamedTuple):
    """Numbers (m,) of the shafts in SI units: inertias of flywheel and motor, slope of the motor, speed, limit of its fluctuation."""

    flywheel: np.ndarray
    motor: np.ndarray
    slope: np.ndarray
    speed: np.ndarray
    fluctuation: np.ndarray

    @classmethod
    def of(cls, shaft: Shaft, which: np.ndarray, count: int) -> _Shafts:
        """Numbers of some of the shafts (m,), of a shaft whose numbers may be columns (count,)."""
        s = si(shaft)
        numbers = s.flywheel_inertia, motor_inertia(shaft), s.motor_slope, s.speed, s.speed_fluctuation
        return cls(*(np.broadcast_to(np.asarray(number), count)[which] for number in numbers))

    def at(self, which: np.ndarray) -> _Shafts:
        """Numbers of some of these shafts."""
        return _Shafts(*(row[which] for row in self))


def load_figures(
    requests: Sequence[QuantityRequest], curves: Sequence[LoadCurve | None], shaft: Shaft
) -> tuple[np.ndarray, np.ndarray]:
    """Figures of m loads on their shafts.

    Parameters
    ----------
    requests : sequence of QuantityRequest
        k totals, or statistics of the shaft's torque.
    curves : sequence of LoadCurve or None
        The loads; None where a design has none.
    shaft : Shaft
        With a column (m,) for each varied number.

    Returns
    -------
    value : ndarray (k, m) [SI unit of the figure]
        NaN where a design has no load.
    theta : ndarray (k, m) [rad]
        Cam angles of extremes, else NaN.
    """
    values, thetas = np.full((2, len(requests), len(curves)), np.nan)
    which = np.array([k for k, curve in enumerate(curves) if curve is not None], dtype=int)
    loads = [curve for curve in curves if curve is not None]
    extremes = once(lambda: load_extremes(loads))
    for i, statistic in enumerate(request.statistic for request in requests if loads):
        theta: Any = np.nan
        if statistic == ENERGY:
            low, high = energy_ranges(loads)
            value: Any = high - low
        elif statistic == INERTIA:
            s = _Shafts.of(shaft, which, len(curves))
            value = np.maximum(inertias_for(loads, s.slope, s.speed, s.fluctuation) - s.motor, 0.0)
        elif statistic == "mean":
            value = [load.mean for load in loads]
        elif statistic == "rms":
            value = [rms(load) for load in loads]
        elif statistic in EXTREMES:
            low, high, low_at, high_at = extremes()
            value, theta = extreme_statistic(statistic, (low, low_at), (high, high_at))
        else:
            continue
        values[i, which], thetas[i, which] = value, theta
    return values, thetas


EXTREMES = ("max", "min", "abs", "range")


def motor_figures(
    block: DesignBlock, requests: Sequence[QuantityRequest], curves: Sequence[LoadCurve | None]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Figures of motor torque and speed in the designs of a block whose flywheel or motor has an inertia.

    Parameters
    ----------
    block : DesignBlock
        Of m designs.
    requests : sequence of QuantityRequest
        k statistics of ``OF_STEADY_SPEED``.
    curves : sequence of LoadCurve or None
        The m loads.

    Returns
    -------
    value : ndarray (k, m) [N m or rad/s]
        NaN where the motor stalls.
    theta : ndarray (k, m) [rad]
        Cam angles of extremes, else NaN.
    has_inertia : ndarray (m,), dimensionless
        Mask of the designs to which they apply.
    """
    shaft = block.design.camshaft
    every = _Shafts.of(shaft, np.arange(block.count), block.count)
    has_inertia = (every.flywheel + every.motor) * every.speed > 0.0
    values, thetas = np.full((2, len(requests), block.count), np.nan)
    which = np.array([k for k, curve in enumerate(curves) if curve is not None and has_inertia[k]], dtype=int)
    loads: list[Any] = [curves[k] for k in which.tolist()]
    for part in by_panels(loads):
        designs, s = which[part], every.at(which[part])
        turns = SteadyTurns(loads[part], s.slope, s.speed)
        runs = turns.solve(s.flywheel + s.motor)
        if not runs.any():
            continue
        designs, s, mean = designs[runs], s.at(runs), np.array([load.mean for load in loads[part]])[runs]
        extremes = turns.extremes(runs)
        at_nodes = once(partial(_deviations, block, turns, designs, runs))
        for i, request in enumerate(requests):
            if request.name == MOTOR_TORQUE:
                level, factor = mean, -s.slope
            else:
                level, factor = s.speed, np.ones(mean.size)
            if request.statistic in EXTREMES:
                ends = [
                    (level + factor * value, _cam_angle(block, theta))
                    for value, theta in ((extremes.low, extremes.low_at), (extremes.high, extremes.high_at))
                ]
                low, high = ends if request.name == MOTOR_SPEED else ends[::-1]
                values[i, designs], thetas[i, designs] = extreme_statistic(request.statistic, low, high)
            else:
                deviation, weight = at_nodes()
                row = level[:, None] + factor[:, None] * deviation
                values[i, designs] = mean_statistic(row, weight, request.statistic)
    return values, thetas, has_inertia


def _cam_angle(block: DesignBlock, theta: np.ndarray) -> np.ndarray:
    """Cam angles of rotations of the shaft, and the other way round."""
    return theta if Study(block.plain).turn_sign > 0.0 else np.mod(-theta, TURN)


def _deviations(
    block: DesignBlock, turns: SteadyTurns, designs: np.ndarray, runs: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Deviation of the speed from its mean at the nodes (m, n) of some designs [rad/s], and the weights of the nodes."""
    angles, weight = clenshaw_curtis_nodes(block.program)
    theta = np.broadcast_to(angles.theta, (designs.size, angles.theta.size))
    if block.motions is not None:
        theta = block.motions.cam_angles(angles.theta, angles.piece, designs[:, None])
        weight = weight * block.motions.span_ratios()[designs][:, angles.piece]
    theta = _cam_angle(block, theta)
    return turns.deviations(runs, theta), weight


# -- life of the rollers ----------------------------------------------------------------------------------------


def shortest_lives(block: DesignBlock) -> np.ndarray:
    """Life of the roller with the shortest life, of designs with an open cam, as by ``roller_lives``.

    Returns
    -------
    ndarray (m,) [h]
        NaN where no roller has a load rating.
    """
    ratings = {} if block.loading.is_empty else load_ratings(Study(block.design))
    if not ratings:
        return np.full(block.count, np.nan)

    names = []
    for roller in ratings:
        names.append(block.add_reader(f"force {roller}", partial(roller_force, roller=roller)))
        names.append(block.add_reader(f"speed {roller}", partial(_speed_ratio, roller)))
    angles, weight = turn_quadrature(block.program, (), LIFE_PANEL)
    values = block.at_nodes(names, angles, np.arange(block.count))
    if block.motions is not None:
        weight = weight * block.motions.span_ratios()[:, angles.piece]
    omega = np.broadcast_to(np.asarray(Study(block.design).omega), block.count)
    shortest = np.full(block.count, inf)
    for i, rating in enumerate(ratings.values()):
        *_, hours = stress.rolling_life(
            np.asarray(rating), values[names[2 * i]], values[names[2 * i + 1]], weight, omega
        )
        shortest = np.minimum(shortest, hours)
    return shortest


def _speed_ratio(roller: str, study: Study) -> np.ndarray:
    """Speed ω_r/ω (n,) of a roller about its own axis."""
    return roller_speed(study, roller) / study.omega
