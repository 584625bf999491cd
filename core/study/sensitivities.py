"""Sensitivities: derivatives of figures of a design by its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from core.design import get
from core.motion import Angles
from core.motion.extremes import Extreme
from core.study.extremes import extremes_of, has_quantity
from core.study.quantities import quantity
from core.study.quantity_requests import QuantityRequest, number_fields, quantity_request
from core.study.study import Study

STEP = 3e-5  # of a number, or of 1 in its unit where it is 0
SEARCH_STEP = 3e-4  # the same where extremes are searched again, which have fewer digits
AT_JOIN = 1e-9  # [rad] from an end of a piece: an extreme so near is at the end
NEIGHBOUR = 1e-4  # [rad] from an extreme: where its neighbourhood is sampled, to see a kink
SMOOTH = 1e-6  # of the extreme: by how much a smooth one may fall within that distance


def sensitivity(study: Study, paths: Sequence[str], quantities: Sequence[str]) -> np.ndarray:
    """Derivatives of figures of a design by its numbers, from finite differences.

    By the envelope theorem an extreme changes as the quantity does at a fixed part of a fixed piece of the motion: within a
    piece the quantity is stationary there, and at the end of a piece the extreme moves with the end. So neighbouring designs
    are evaluated at the extremes of this one, in one batch. Of means, totals, extremes at kinks, and designs that cannot be
    computed in a batch, the figures of the neighbouring designs are compared.

    Parameters
    ----------
    study : Study
    paths : sequence of str
        Paths of k numbers.
    quantities : sequence of str
        Keys of q figures, as for ``many``.

    Returns
    -------
    ndarray (k, q) [unit of the figure by unit of the number]
        NaN where the design lacks the quantity, or the extreme is infinite.

    Raises
    ------
    ValueError
        Where the design lacks a path or a quantity.
    NoSolution
        Where a stage has no solution.
    """
    from core.study.batch import block_results

    design, infos = study.design, number_fields(study.design, paths)
    requests = [quantity_request(design, key) for key in quantities]
    for path in paths:
        if type(get(design, path)) not in (int, float):
            raise ValueError(f"{path}: has no value in this design")
    if design.listed:
        result = _drive_sensitivities(study, list(paths), requests)
        rest = [i for i, request in enumerate(requests) if request.drive is None]
    else:
        steps, rows = _neighbours(study, infos, STEP)
        values = _values_at_extremes(study, tuple(paths), rows, requests)
        result, rest = _slopes(values, steps), [i for i, row in enumerate(values) if row is None]
    if rest:
        steps, rows = _neighbours(study, infos, SEARCH_STEP)
        compared = block_results(design, infos, tuple(requests[i] for i in rest), True, rows)
        result[:, rest] = _slopes(compared.value, steps)
    return np.asarray(result / [request.unit for request in requests])


def _drive_sensitivities(study: Study, paths: list[str], requests: Sequence[QuantityRequest]) -> np.ndarray:
    """Derivatives (k, q) in SI units of the figures of single drives, of several; 0 by numbers of other drives."""
    from core.study.batch import paths_inside

    result = np.zeros((len(paths), len(requests)))
    for number, drive in enumerate(study.drives.values()):
        columns = [i for i, request in enumerate(requests) if request.drive == number]
        inside = paths_inside(study.design, paths, number)
        if columns and inside:
            rows = [paths.index(path) for path in inside.values()]
            keys = [requests[i].key.partition(".")[2] for i in columns]
            slopes = sensitivity(drive, list(inside), keys)
            result[np.ix_(rows, columns)] = slopes * [requests[i].unit for i in columns]
    return result


def _neighbours(study: Study, infos: Mapping[str, Any], part: float) -> tuple[np.ndarray, np.ndarray]:
    """Two steps of every number (k, 2), and the numbers (k, 1 + 2 k) of the design and of its neighbours.

    The steps go to both sides, or both to one side where the range of the field ends.
    """
    numbers = np.array([float(get(study.design, path)) for path in infos])
    steps = np.array([part * (abs(value) or 1.0) for value in numbers])[:, None] * np.array([-1.0, 1.0])
    for i, info in enumerate(infos.values()):
        if not info.low <= numbers[i] + steps[i, 0]:
            steps[i] = steps[i, 1] * np.array([1.0, 2.0])
        elif not numbers[i] + steps[i, 1] <= info.high:
            steps[i] = steps[i, 0] * np.array([1.0, 2.0])
    rows = np.tile(numbers[:, None], 1 + 2 * numbers.size)
    for i, both in enumerate(steps):
        rows[i, 1 + 2 * i : 3 + 2 * i] += both
    return steps, rows


def _slopes(values: Sequence[np.ndarray | None] | np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Slopes (k, q) of the parabolas through the values (1 + 2 k,) of every figure; NaN where it has none."""
    slopes = np.full((len(steps), len(values)), np.nan)
    first, second = steps.T
    for i, row in enumerate(values):
        if row is not None:
            change = (row[1:] - row[0]).reshape(-1, 2)
            slopes[:, i] = (change[:, 0] * second / first - change[:, 1] * first / second) / (second - first)
    return slopes


def _values_at_extremes(
    study: Study, paths: tuple[str, ...], rows: np.ndarray, requests: Sequence[QuantityRequest]
) -> list[np.ndarray | None]:
    """Figures (m,) of the designs with numbers (k, m) at the extremes of the first one; None where they must be compared."""
    from core.study.batch import design_block, is_batchable

    result: list[np.ndarray | None] = [None] * len(requests)
    chosen = [i for i, r in enumerate(requests) if r.statistic in _SIDES and is_batchable(study.design, paths, r)]
    if not chosen:
        return result
    designs = design_block(study.design, paths, rows)
    if designs.program.starts.size != study.program.starts.size:  # a law of a neighbour has one more piece
        return result
    positions: dict[tuple[str, float], tuple[float, int] | None] = {}
    keys: dict[int, list[tuple[str, float]]] = {}
    for i in chosen:
        row = quantity(requests[i].name)
        has_value = has_quantity(study, row) and not (row.stage == "dynamics" and study.jam is not None)
        extremes = extremes_of(study, row.stage, (row.name,))[row.name] if has_value else None
        sides = [] if extremes is None else _SIDES[requests[i].statistic](extremes)
        if any(not np.isfinite(side.value) for side in sides):
            sides = []
        keys[i] = [(row.name, side.theta) for side in sides]
        positions |= {
            key: _position(study, designs.program, row.name, side) for key, side in zip(keys[i], sides, strict=True)
        }
    smooth = {key: position for key, position in positions.items() if position is not None}
    if smooth:
        theta, piece = (np.array(part) for part in zip(*smooth.values(), strict=True))
        owner, names = np.repeat(np.arange(designs.count), theta.size), list(dict.fromkeys(name for name, _ in smooth))
        state = designs.state(np.tile(theta, designs.count), np.tile(piece, designs.count), owner)
        values = {name: v.reshape(designs.count, -1) for name, v in designs.values(names, state, owner).items()}
        if designs.separate.any():  # then every design has its own cuts of the turn
            return result
    column = {key: i for i, key in enumerate(smooth)}
    for i, ends in keys.items():
        if all(key in smooth for key in ends):
            columns = [values[key[0]][:, column[key]] for key in ends]
            result[i] = _figure(requests[i].statistic, columns) if columns else np.full(designs.count, np.nan)
    return result


_SIDES = {
    "max": lambda extremes: [extremes.high],
    "min": lambda extremes: [extremes.low],
    "range": lambda extremes: [extremes.high, extremes.low],
    "abs": lambda extremes: [max(extremes.high, extremes.low, key=lambda side: abs(side.value))],
}
"""Statistic -> extremes from which it follows."""


def _figure(statistic: str, columns: Sequence[np.ndarray]) -> np.ndarray:
    """Statistic (m,) from the values (m,) at its extremes; "abs" keeps the sign of the first design."""
    if statistic == "range":
        return columns[0] - columns[1]
    return columns[0] * (np.sign(columns[0][0]) if statistic == "abs" else 1.0)


def _position(study: Study, program: Any, name: str, extreme: Extreme) -> tuple[float, int] | None:
    """Cam angle and piece of an extreme, at a join on its side of the join; None at a kink, which moves with the design."""
    theta, last = extreme.theta, program.starts.size - 1
    piece = int(program.angles(np.array([theta])).piece[0])
    value = quantity(name).value
    positions = [(theta, piece)]
    if theta - program.starts[piece] < AT_JOIN:
        before = piece - 1 if piece else last
        positions.append((float(program.ends[before]), before))
    elif program.ends[piece] - theta < AT_JOIN:
        after = piece + 1 if piece < last else 0
        positions.append((float(program.starts[after]), after))
    else:
        near = theta + NEIGHBOUR * np.array([0.0, -1.0, 1.0, -2.0, 2.0])
        inside = np.clip(near, program.starts[piece], program.ends[piece])
        fall = value(study.at(Angles(inside, np.full(5, piece))))
        fall = np.abs(fall[1:] - fall[0])
        kink = (inside == near).all() and (fall[2:] < 3.0 * fall[:2]).any() and fall.max() > SMOOTH * abs(extreme.value)
        return None if kink else positions[0]
    at, pieces = (np.array(row) for row in zip(*positions, strict=True))
    values = value(study.at(Angles(at, pieces)))
    return positions[int(np.argmin(np.abs(values - extreme.value)))]
