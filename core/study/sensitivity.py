"""How fast what is asked of a quantity changes with numbers of the design."""

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

HELD = 3e-5  # of a number, or of one in its unit where it is 0: the step
COMPARED = 3e-4  # the same, where extremes are searched anew, which have fewer digits
AT_JOIN = 1e-9  # [rad] an extreme so near an end of a piece stands there
BESIDE = 1e-4  # [rad] where it is looked whether an extreme is smooth
SMOOTH = 1e-6  # of the extreme: what a smooth one falls beside it


def sensitivity(study: Study, paths: Sequence[str], quantities: Sequence[str]) -> np.ndarray:
    """The derivatives (k, q) of what is asked by the numbers at k paths, in the units of both; keys as in ``many``.

    By the envelope theorem an extreme changes as the quantity does where it stands, at the same part of the same piece of the motion:
    in the middle of a piece the quantity does not change with the angle, and at its end the extreme goes with the end. So one batch
    of designs beside this one is evaluated there. Of means, totals, extremes at kinks and what cannot be computed at once the answers
    of these designs are compared. NaN where there is no such quantity, or it is infinite. Raises ValueError as ``many``, NoSolution as
    the stages do.
    """
    from core.study.batch import block

    design, infos = study.design, number_fields(study.design, paths)
    asked = [quantity_request(design, key) for key in quantities]
    for path in paths:
        if type(get(design, path)) not in (int, float):
            raise ValueError(f"{path}: has no value in this design")
    if design.listed:
        found, rest = _of_drives(study, list(paths), asked), [i for i, each in enumerate(asked) if each.drive is None]
    else:
        steps, rows = _beside(study, infos, HELD)
        values = _at_extremes(study, tuple(paths), rows, asked)
        found, rest = _slopes(values, steps), [i for i, row in enumerate(values) if row is None]
    if rest:
        steps, rows = _beside(study, infos, COMPARED)
        found[:, rest] = _slopes(block(design, infos, tuple(asked[i] for i in rest), True, rows).value, steps)
    return np.asarray(found / [each.unit for each in asked])


def _of_drives(study: Study, paths: list[str], asked: Sequence[QuantityRequest]) -> np.ndarray:
    """Of the quantities of each of several drives, in SI; 0 by what a drive does not depend on."""
    from core.study.batch import paths_inside

    found = np.zeros((len(paths), len(asked)))
    for number, drive in enumerate(study.drives.values()):
        mine = [i for i, each in enumerate(asked) if each.drive == number]
        inside = paths_inside(study.design, paths, number)
        if mine and inside:
            by = [paths.index(path) for path in inside.values()]
            keys = [asked[i].key.partition(".")[2] for i in mine]
            found[np.ix_(by, mine)] = sensitivity(drive, list(inside), keys) * [asked[i].unit for i in mine]
    return found


def _beside(study: Study, infos: Mapping[str, Any], part: float) -> tuple[np.ndarray, np.ndarray]:
    """Two steps for each number (k, 2), one on either side or both on that which its range leaves; and the numbers (k, 1 + 2 k) of the
    design itself and of those beside it."""
    own = np.array([float(get(study.design, path)) for path in infos])
    steps = np.array([part * (abs(value) or 1.0) for value in own])[:, None] * np.array([-1.0, 1.0])
    for i, info in enumerate(infos.values()):
        if not info.low <= own[i] + steps[i, 0]:
            steps[i] = steps[i, 1] * np.array([1.0, 2.0])
        elif not own[i] + steps[i, 1] <= info.high:
            steps[i] = steps[i, 0] * np.array([1.0, 2.0])
    rows = np.tile(own[:, None], 1 + 2 * own.size)
    for i, both in enumerate(steps):
        rows[i, 1 + 2 * i : 3 + 2 * i] += both
    return steps, rows


def _slopes(values: Sequence[np.ndarray | None] | np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Of the parabolas through the values (1 + 2 k,) of each thing asked, (k, q); NaN where there are none."""
    found = np.full((len(steps), len(values)), np.nan)
    first, second = steps.T
    for i, row in enumerate(values):
        if row is not None:
            change = (row[1:] - row[0]).reshape(-1, 2)
            found[:, i] = (change[:, 0] * second / first - change[:, 1] * first / second) / (second - first)
    return found


def _at_extremes(
    study: Study, paths: tuple[str, ...], rows: np.ndarray, asked: Sequence[QuantityRequest]
) -> list[np.ndarray | None]:
    """What is asked, (m,) each, of the designs with these numbers (k, m), where the extremes of the first one stand; None of what is to be
    compared instead."""
    from core.study.batch import at_once, together

    result: list[np.ndarray | None] = [None] * len(asked)
    chosen = [i for i, a in enumerate(asked) if a.statistic in _ENDS and together(study.design, paths, a)]
    if not chosen:
        return result
    one = at_once(study.design, paths, rows)
    if one.program.starts.size != study.program.starts.size:  # of designs beside this one a law has a piece more
        return result
    places: dict[tuple[str, float], tuple[float, int] | None] = {}
    ends: dict[int, list[tuple[str, float]]] = {}
    for i in chosen:
        row = quantity(asked[i].name)
        there = has_quantity(study, row) and not (row.stage == "dynamics" and study.jam is not None)
        sides = _ENDS[asked[i].statistic](extremes_of(study, row.stage, (row.name,))[row.name]) if there else []
        if any(not np.isfinite(side.value) for side in sides):
            sides = []
        ends[i] = [(row.name, side.theta) for side in sides]
        places |= {key: _place(study, one.program, row.name, side) for key, side in zip(ends[i], sides, strict=True)}
    held = {key: place for key, place in places.items() if place is not None}
    if held:
        theta, piece = (np.array(each) for each in zip(*held.values(), strict=True))
        owner, names = np.repeat(np.arange(one.count), theta.size), list(dict.fromkeys(name for name, _ in held))
        state = one.state(np.tile(theta, one.count), np.tile(piece, one.count), owner)
        found = {name: row.reshape(one.count, -1) for name, row in one.values(names, state, owner).items()}
        if one.apart.any():  # then the turn of each design is cut at angles of its own
            return result
    at = {key: i for i, key in enumerate(held)}
    for i, keys in ends.items():
        if all(key in held for key in keys):
            columns = [found[key[0]][:, at[key]] for key in keys]
            result[i] = _value(asked[i].statistic, columns) if columns else np.full(one.count, np.nan)
    return result


_ENDS = {
    "max": lambda found: [found.high], "min": lambda found: [found.low], "range": lambda found: [found.high, found.low],
    "abs": lambda found: [max(found.high, found.low, key=lambda end: abs(end.value))],
}  # fmt: skip
"""What is asked -> the extremes that it is taken from."""


def _value(of: str, columns: Sequence[np.ndarray]) -> np.ndarray:
    if of == "range":
        return columns[0] - columns[1]
    return columns[0] * (np.sign(columns[0][0]) if of == "abs" else 1.0)


def _place(study: Study, program: Any, name: str, extreme: Extreme) -> tuple[float, int] | None:
    """Cam angle and piece of an extreme; at a join that on the side where it stands; None at a kink, whose angle changes with the
    design."""
    theta, last = extreme.theta, program.starts.size - 1
    piece = int(program.angles(np.array([theta])).piece[0])
    value = quantity(name).value
    places = [(theta, piece)]
    if theta - program.starts[piece] < AT_JOIN:
        before = piece - 1 if piece else last
        places.append((float(program.ends[before]), before))
    elif program.ends[piece] - theta < AT_JOIN:
        after = piece + 1 if piece < last else 0
        places.append((float(program.starts[after]), after))
    else:
        near = theta + BESIDE * np.array([0.0, -1.0, 1.0, -2.0, 2.0])
        inside = np.clip(near, program.starts[piece], program.ends[piece])
        fall = value(study.at(Angles(inside, np.full(5, piece))))
        fall = np.abs(fall[1:] - fall[0])
        kink = (inside == near).all() and (fall[2:] < 3.0 * fall[:2]).any() and fall.max() > SMOOTH * abs(extreme.value)
        return None if kink else places[0]
    at, pieces = (np.array(row) for row in zip(*places, strict=True))
    values = value(study.at(Angles(at, pieces)))
    return places[int(np.argmin(np.abs(values - extreme.value)))]
