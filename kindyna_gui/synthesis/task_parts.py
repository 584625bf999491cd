"""Parts of a task that are drawn on its sheet: poses, pivots, lines of pivots, the area, points; what moves, types and removes them."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import degrees, radians
from types import MappingProxyType
from typing import Any

from core.design import UNITS
from core.frozen import frozen
from core.synthesis import Area, BodyPose, PathPoint, Pivot, Task, TracedPath
from core.synthesis.task import FIXED, MOST_POSES, MOVING, PATH, POSES
from kindyna_gui.linkage.typed_values import Box

MM, DEG = UNITS["mm"], UNITS["deg"]
POSE, PIVOT, LINE, AREA, POINT = "pose", "pivot", "line", "area", "point"
MOVE, TURN = "move", "turn"
CORNERS: Mapping[str, tuple[int, int]] = MappingProxyType(
    {"low left": (0, 1), "low right": (2, 1), "high right": (2, 3), "high left": (0, 3)}
)
"""Corner of an area -> indices of its x and y among lowest x, lowest y, highest x, highest y."""
DECIMALS = 9  # of numbers that are carried over from one frame to another

Values = Sequence[float]


@frozen
class Part:
    """A part of a task: its kind, a row of ``PARTS``, and its index in its list."""

    kind: str
    index: int = 0


@frozen
class Grip:
    """What can be dragged of a part: ``MOVE``, ``TURN`` or a corner, and its position [mm]."""

    part: Part
    action: str
    at: complex


@frozen
class PartKind:
    """A kind of part.

    Attributes
    ----------
    boxes : tuple of Box
        Labels and units of its values, in the units of files.
    values : callable
        Values of the part with an index.
    put : callable
        The task with other values of that part; of a new one where the index is that after the last.
    remove : callable
        The task without that part.
    """

    boxes: tuple[Box, ...]
    values: Callable[[Task, int], Values]
    put: Callable[[Task, int, Values], Task]
    remove: Callable[[Task, int], Task]


_XY = Box("x", MM), Box("y", MM)


def _with(rows: Sequence[object], index: int, row: object) -> tuple[Any, ...]:
    """The rows with another one at an index, or one more."""
    return (*rows[:index], row, *rows[index + 1 :])


def _without(rows: Sequence[object], index: int) -> tuple[Any, ...]:
    return (*rows[:index], *rows[index + 1 :])


def _pivot_of(task: Task, index: int) -> Pivot:
    """The pivot with an index; a new one is fixed and belongs to the first dyad that has no fixed pivot."""
    if index < len(task.pivots):
        return task.pivots[index]
    given = {pivot.dyad for pivot in task.pivots if pivot.of == FIXED}
    return Pivot(of=FIXED, dyad=next((dyad for dyad in (1, 2) if dyad not in given), None))


def _put_pivot(task: Task, index: int, values: Values) -> Task:
    x, y = values
    pivot = replace(_pivot_of(task, index), x_mm=x, y_mm=y, line=())
    return replace(task, pivots=_with(task.pivots, index, pivot))


def _put_line(task: Task, index: int, values: Values) -> Task:
    pivot = replace(_pivot_of(task, index), x_mm=None, y_mm=None, line=tuple(values))
    return replace(task, pivots=_with(task.pivots, index, pivot))


def _remove_pivot(task: Task, index: int) -> Task:
    return replace(task, pivots=_without(task.pivots, index))


def _place(task: Task, index: int) -> Values:
    z = task.pivots[index].z
    assert z is not None
    return z.real, z.imag


def _area_values(task: Task, _: int) -> Values:
    area = task.area
    assert area is not None
    return area.low_x_mm, area.low_y_mm, area.high_x_mm, area.high_y_mm


def _path(task: Task) -> TracedPath:
    return task.path or TracedPath()


def _put_point(task: Task, index: int, values: Values) -> Task:
    path = _path(task)
    lists = path if index < len(path.points) else replace(path, driver_deg=(), weights=())
    return replace(task, path=replace(lists, points=_with(path.points, index, PathPoint(*values)), file=""))


def _remove_point(task: Task, index: int) -> Task:
    path = _path(task)
    driver_deg, weights = (_without(row, index) if row else () for row in (path.driver_deg, path.weights))
    points = _without(path.points, index)
    return replace(task, path=replace(path, points=points, driver_deg=driver_deg, weights=weights, file=""))


PARTS: Mapping[str, PartKind] = MappingProxyType(
    {
        POSE: PartKind(
            (*_XY, Box("angle", DEG)),
            lambda task, i: (task.poses[i].x_mm, task.poses[i].y_mm, task.poses[i].angle_deg),
            lambda task, i, values: replace(task, poses=_with(task.poses, i, BodyPose(*values))),
            lambda task, i: replace(task, poses=_without(task.poses, i)),
        ),
        PIVOT: PartKind(_XY, _place, _put_pivot, _remove_pivot),
        LINE: PartKind(
            (*_XY, Box("direction", DEG)), lambda task, i: task.pivots[i].line, _put_line, _remove_pivot
        ),
        AREA: PartKind(
            (Box("lowest x", MM), Box("lowest y", MM), Box("highest x", MM), Box("highest y", MM)),
            _area_values,
            lambda task, _, values: replace(task, area=Area(*values)),
            lambda task, _: replace(task, area=None),
        ),
        POINT: PartKind(
            _XY,
            lambda task, i: (_path(task).points[i].x_mm, _path(task).points[i].y_mm),
            _put_point,
            _remove_point,
        ),
    }
)  # fmt: skip
"""Kind of a part -> what it has."""

# -- parts of a task -------------------------------------------------------------------------------------------------


def parts_of(task: Task) -> Iterator[Part]:
    """Yield the parts of a task that are drawn, those in front first."""
    if task.kind == POSES:
        yield from (Part(POSE, i) for i in range(len(task.poses)))
        for i, pivot in enumerate(task.pivots):
            if len(pivot.line) == 3 or pivot.z is not None:
                yield Part(LINE if pivot.line else PIVOT, i)
        if task.area is not None:
            yield Part(AREA)
    elif task.kind == PATH:
        yield from (Part(POINT, i) for i in range(len(_path(task).points)))


def new_part(task: Task, kind: str) -> Part | None:
    """The part of a kind that is added next; None where there is no room for another."""
    counts = {POSE: len(task.poses), PIVOT: len(task.pivots), LINE: len(task.pivots), POINT: len(_path(task).points)}
    index = counts.get(kind, 0)
    return None if kind == POSE and index >= MOST_POSES else Part(kind, index)


def _frame(task: Task, part: Part) -> tuple[complex, complex]:
    """Origin [mm] and x axis of the frame in which a part is given: for a moving pivot the body in its first pose."""
    is_pivot = part.kind in (PIVOT, LINE) and part.index < len(task.pivots)
    if is_pivot and task.pivots[part.index].of == MOVING and task.poses:
        first = task.poses[0]
        return first.z, cmath.rect(1.0, radians(first.angle_deg))
    return 0j, 1.0 + 0j


def position(task: Task, part: Part) -> complex:
    """Position of a part on the sheet [mm]; of an area its lower left corner."""
    origin, axis = _frame(task, part)
    return origin + axis * complex(*PARTS[part.kind].values(task, part.index)[:2])


def direction(task: Task, part: Part) -> complex:
    """Unit vector of the x axis of a pose, or of the line of a pivot."""
    _, axis = _frame(task, part)
    return axis * cmath.rect(1.0, radians(PARTS[part.kind].values(task, part.index)[2]))


def has_direction(part: Part) -> bool:
    """Whether a part has a direction that is turned by its arm."""
    return part.kind in (POSE, LINE)


def corners(area: Area) -> dict[str, complex]:
    """Corners of an area [mm]."""
    values = area.low_x_mm, area.low_y_mm, area.high_x_mm, area.high_y_mm
    return {name: complex(values[x], values[y]) for name, (x, y) in CORNERS.items()}


def grips(task: Task, arm: float) -> Iterator[Grip]:
    """Yield what can be dragged, that in front first; ``arm`` is the length of an arm [mm]."""
    for part in parts_of(task):
        if part.kind == AREA:
            assert task.area is not None
            yield from (Grip(part, name, at) for name, at in corners(task.area).items())
            continue
        at = position(task, part)
        if has_direction(part):
            yield Grip(part, TURN, at + arm * direction(task, part))
        yield Grip(part, MOVE, at)


def dragged(task: Task, grip: Grip, at: complex, angle_deg: float = 0.0) -> Task:
    """The task with a part moved, so that its grip is at a position [mm], or turned to an angle on the sheet."""
    part, kind = grip.part, PARTS[grip.part.kind]
    values = [*kind.values(task, part.index)]
    origin, axis = _frame(task, part)
    if grip.action in CORNERS:
        for k, value in zip(CORNERS[grip.action], (at.real, at.imag), strict=True):
            values[k] = value
    elif grip.action == TURN:
        angle = angle_deg - degrees(cmath.phase(axis))
        near = values[2]  # the turn nearest to the one before: 350 stays 350, and not -10
        values[2] = round(near + (angle - near + 180.0) % 360.0 - 180.0, DECIMALS) + 0.0
    elif part.kind == AREA:
        shift = at - position(task, part)
        values = [value + (shift.imag if k % 2 else shift.real) for k, value in enumerate(values)]
    else:
        local = (at - origin) / axis
        values[:2] = [round(local.real, DECIMALS) + 0.0, round(local.imag, DECIMALS) + 0.0]
    return kind.put(task, part.index, values)


def upright(task: Task) -> Task:
    """The task with the bounds of its area in order, which a drag of a corner past another one reverses."""
    if task.area is None:
        return task
    x = sorted((task.area.low_x_mm, task.area.high_x_mm))
    y = sorted((task.area.low_y_mm, task.area.high_y_mm))
    return replace(task, area=Area(x[0], y[0], x[1], y[1]))


# -- pivots --------------------------------------------------------------------------------------------------------


def with_pivot(task: Task, index: int, *, dyad: int | None, of: str) -> Task:
    """The task with a pivot of another dyad (None: of both), or in another frame, where it keeps its position on the sheet."""
    pivot = task.pivots[index]
    moved = replace(task, pivots=_with(task.pivots, index, replace(pivot, dyad=dyad, of=of)))
    if of == pivot.of:
        return moved
    part = Part(LINE if pivot.line else PIVOT, index)
    at = position(task, part)
    if part.kind == LINE:
        angle = degrees(cmath.phase(direction(task, part)))
        moved = dragged(moved, Grip(part, TURN, at), at, angle)
    return dragged(moved, Grip(part, MOVE, at), at)


PIVOT_CHANGES: Mapping[str, Callable[[Task, int], Task]] = MappingProxyType(
    {
        "For both dyads": lambda task, i: with_pivot(task, i, dyad=None, of=task.pivots[i].of),
        "For dyad 1": lambda task, i: with_pivot(task, i, dyad=1, of=task.pivots[i].of),
        "For dyad 2": lambda task, i: with_pivot(task, i, dyad=2, of=task.pivots[i].of),
        "Fixed pivot": lambda task, i: with_pivot(task, i, dyad=task.pivots[i].dyad, of=FIXED),
        "Moving pivot, on the body": lambda task, i: with_pivot(task, i, dyad=task.pivots[i].dyad, of=MOVING),
    }
)
"""Text of a menu -> the task with a pivot changed."""
