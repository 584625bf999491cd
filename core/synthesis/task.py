"""Task of a synthesis as a file, TASK.toml: poses, a path, pairs of angles, or a swing; all faults are reported at once."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import radians
from pathlib import Path
from types import MappingProxyType
from typing import Any

from core.design import part_faults
from core.design.fields import FileLayout, choice, coordinate, flag, length, number, placed, whole
from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen
from core.numerics.derivatives import vector
from core.project import dumps_table, parsed
from core.project.files import AnyPath, read_text, write
from core.project.reading import Reader

POSES, PATH, ANGLES, ROCKER = "poses", "path", "angles", "rocker"
KINDS = (POSES, PATH, ANGLES, ROCKER)
FIXED, MOVING = "fixed", "moving"
OUTPUTS = ROCKER_OUTPUT, SLIDER_OUTPUT = ("rocker", "slider")
MOST_POSES, FEWEST_POINTS, FEWEST_PAIRS = 5, 3, 3
MOST_POINTS = 2000
ROCKER_RATIO = 6.0
"""Largest ratio of the longest to the shortest link of a crank-rocker, where none is given."""
SAME = 1e-9  # of the task's size: poses that differ by less are equal

# -- parts ------------------------------------------------------------------------------------------------------


@frozen
class BodyPose:
    """Position of a body: its origin, and the angle of its x axis, in the frame."""

    x_mm: float = coordinate("x")
    y_mm: float = coordinate("y")
    angle_deg: float = number("Angle", -3600.0, 3600.0, default=0.0, step=1.0)

    @property
    def z(self) -> complex:
        """The origin [mm]."""
        return vector(self.x_mm, self.y_mm)


@frozen(kw_only=True)
class Pivot:
    """Condition on a pivot of a dyad: its position, or a line on which it lies.

    A fixed pivot is given in the frame, a moving one in the body's frame.
    """

    dyad: int | None = whole("Dyad", 1, 2, default=None, help="1 or 2; empty: both")
    of: str = choice("Pivot", (FIXED, MOVING), missing="fixed | moving")
    x_mm: float | None = coordinate("x", default=None)
    y_mm: float | None = coordinate("y", default=None)
    line: tuple[float, ...] = placed(FileLayout(each=float), ())

    @property
    def z(self) -> complex | None:
        """Its position [mm]; None where it is on a line."""
        return None if self.x_mm is None or self.y_mm is None else vector(self.x_mm, self.y_mm)

    @property
    def conditions(self) -> int:
        """Number of conditions on the dyad: 2 for a position, 1 for a line."""
        return 1 if self.line else 2


@frozen
class Area:
    """Rectangle for the fixed pivots."""

    low_x_mm: float = coordinate("Lowest x", pair="low")
    low_y_mm: float = coordinate("Lowest y", pair="low")
    high_x_mm: float = coordinate("Highest x", pair="high")
    high_y_mm: float = coordinate("Highest y", pair="high")


@frozen
class PathPoint:
    """A point of a path."""

    x_mm: float = coordinate("x")
    y_mm: float = coordinate("y")

    @property
    def z(self) -> complex:
        """The point [mm]."""
        return vector(self.x_mm, self.y_mm)


@frozen(kw_only=True)
class TracedPath:
    """Path of a point of the coupler, as points or as a file with one curve.

    Attributes
    ----------
    point : str
        Name of the point, where the file is a table with the columns of several.
    driver_deg : tuple of float
        Angles of the driver at the points, from an unknown first angle.
    weights : tuple of float
        Weights of the points in the least squares.
    """

    points: tuple[PathPoint, ...] = placed(FileLayout(PathPoint, rows=True), ())
    file: str = placed(FileLayout(brief=True), "")
    point: str = placed(FileLayout(brief=True), "")
    closed: bool = flag("Closed", help="the last point is joined to the first")
    driver_deg: tuple[float, ...] = placed(FileLayout(each=float), ())
    weights: tuple[float, ...] = placed(FileLayout(each=float), ())


@frozen
class AnglePair:
    """Angle of the driver, and angle or slide of the output."""

    driver_deg: float = number("Driver", -3600.0, 3600.0)
    output: float = number("Output")


@frozen(kw_only=True)
class AnglePairs:
    """Pairs of angles of driver and output, to be coordinated.

    Both angles are measured from the line driver pivot → follower pivot, counter-clockwise; with a slider, the second number is in
    mm along x from the crank's pivot, and the angles are measured from x.
    """

    pairs: tuple[AnglePair, ...] = placed(FileLayout(AnglePair, rows=True, missing="[[driver, output], ...]"), ())
    free: bool = flag("Only differences count", help="the first angle of both links is unknown")
    frame_mm: float | None = length("Frame", default=None, help="distance of the fixed pivots")
    output: str = choice("Output", OUTPUTS, default=ROCKER_OUTPUT)


@frozen(kw_only=True)
class Swing:
    """Swing of the rocker of a crank-rocker, and the ratio of the times forth and back."""

    swing_deg: float = number("Swing", 0.0, 180.0, open_low=True, open_high=True, step=1.0)
    time_ratio: float = number("Time ratio", 1.0, 3.0, open_high=True, default=1.0, step=0.1)
    frame_mm: float = length("Frame", help="distance of the fixed pivots")


@frozen(kw_only=True)
class AnswerLimits:
    """Limits of the answers."""

    transmission_deg_min: float | None = number(
        "Least transmission angle", 0.0, 90.0, default=None, help="over the range of the driver that contains the task"
    )
    length_ratio_max: float | None = number(
        "Longest to shortest link", 1.0, default=None, help="the frame is one of the links"
    )
    order: bool = flag("In this order", help="the poses are passed in the given order, in either direction")


NO_LIMITS = AnswerLimits()


@frozen(kw_only=True)
class Task:
    """A task as typed; ``folder`` is that of its file, to which the file of a path is relative."""

    kind: str = choice("Task", KINDS, missing=" | ".join(KINDS))
    poses: tuple[BodyPose, ...] = placed(FileLayout(BodyPose), ())
    pivots: tuple[Pivot, ...] = placed(FileLayout(Pivot), ())
    area: Area | None = placed(FileLayout(Area, single=True), None)
    path: TracedPath | None = placed(FileLayout(TracedPath, single=True), None)
    angles: AnglePairs | None = placed(FileLayout(AnglePairs, single=True), None)
    rocker: Swing | None = placed(FileLayout(Swing, single=True), None)
    limits: AnswerLimits = placed(FileLayout(AnswerLimits, single=True, brief=True), NO_LIMITS)
    folder: Path = placed(FileLayout(in_file=False), Path())

    @property
    def longest_to_shortest(self) -> float | None:
        """Largest allowed ratio of the longest to the shortest link; None where there is no limit."""
        limit = self.limits.length_ratio_max
        return ROCKER_RATIO if limit is None and self.kind == ROCKER else limit


# -- the file ---------------------------------------------------------------------------------------------------


def load_task(path: AnyPath) -> Task:
    """Task in a file.

    Raises
    ------
    FileError
        The file cannot be read.
    DesignError
        With all faults of the file.
    """
    return replace(task_of(parsed(read_text(path), str(path))), folder=Path(path).parent)


def task_of(table: Mapping[str, Any]) -> Task:
    """Task in the tables of a file. Raises DesignError with all faults."""
    reader = Reader("")
    task: Task = reader.part(Task, table, "")
    return _without_faults(task, reader.with_rules(part_faults(task, ""), {}))


def checked(task: Task) -> Task:
    """The task. Raises DesignError with all faults."""
    return _without_faults(task, part_faults(task, ""))


def _without_faults(task: Task, range_faults: Sequence[Fault]) -> Task:
    faults = [
        replace(fault, path=fault.path.removeprefix("."), allowed=fault.allowed.replace("[[.", "[["))
        for fault in range_faults
    ] or [*_rule_faults(task)]
    if faults:
        raise DesignError(faults)
    return task


def save_task(task: Task, path: AnyPath) -> str:
    """Write a task to a file, completely or not at all, and return the text. Raises DesignError and FileError."""
    text = dumps_table(task)
    task_of(parsed(text, str(path)))
    write(path, text)
    return text


# -- rules ------------------------------------------------------------------------------------------------------


_TABLES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {POSES: ("poses", "pivots", "area"), PATH: ("path",), ANGLES: ("angles",), ROCKER: ("rocker",)}
)
"""Kind of task -> its tables besides the limits; the first is required."""


def _rule_faults(task: Task) -> Iterator[Fault]:
    tables = _TABLES[task.kind]
    others = [name for names in _TABLES.values() for name in names if name not in tables]
    for name in others:
        if getattr(task, name):
            yield Fault(name, MISSING, f"is not used by a task of kind {task.kind}", " | ".join(tables))
    required = getattr(task, tables[0])
    if not required and task.kind != POSES:
        yield Fault(tables[0], MISSING, "missing", f"[{tables[0]}]")
    elif task.kind in _RULES:
        yield from _RULES[task.kind](task)


def _pose_faults(task: Task) -> Iterator[Fault]:
    poses, n = task.poses, len(task.poses)
    if not 2 <= n <= MOST_POSES:
        yield Fault("poses", MISSING, _count(n, "pose"), f"2 ... {MOST_POSES}")
        return
    size = task_size([pose.z for pose in poses])
    for i, pose in enumerate(poses):
        for k, earlier in enumerate(poses[:i]):
            turn = (pose.angle_deg - earlier.angle_deg + 180.0) % 360.0 - 180.0
            if abs(pose.z - earlier.z) <= SAME * size and abs(turn) <= 1e-7:
                yield Fault(f"poses[{i}]", MISSING, f"is equal to poses[{k}]", "different poses")
                return
    has_turn = any(abs((p.angle_deg - poses[0].angle_deg + 180.0) % 360.0 - 180.0) > 1e-7 for p in poses)
    if not has_turn and n > 2 and _are_on_one_line([pose.z for pose in poses], size):
        yield Fault("poses", MISSING, "are all on one line without a turn", "a turn, or a pose next to the line")
        return
    if n > 2 and (pole := _common_pole(poses, size)) is not None:
        at = f"({round(pole.real, 6) + 0.0:g}, {round(pole.imag, 6) + 0.0:g}) mm"
        problem = f"are turns about one point, where a single pivot guides the body: {at}"
        yield Fault("poses", MISSING, problem, "a shift of one pose")
        return
    for i, pivot in enumerate(task.pivots):
        yield from _pivot_faults(pivot, f"pivots[{i}]")
    if any(not (pivot.line or pivot.z is not None) or (pivot.line and pivot.x_mm is not None) for pivot in task.pivots):
        return
    yield from next(filter(None, (list(_freedom_faults(task, dyad)) for dyad in (1, 2))), _shared_pivot_faults(task))
    area = task.area
    if area is not None:
        for axis in "xy":
            low, high = getattr(area, f"low_{axis}_mm"), getattr(area, f"high_{axis}_mm")
            if not low < high:
                yield Fault("area.high", [area.high_x_mm, area.high_y_mm], "bounds are reversed", f"{axis} > {low:g}")
                return
            for i, pivot in enumerate(task.pivots):
                value = getattr(pivot, f"{axis}_mm")
                if pivot.of == FIXED and value is not None and not low <= value <= high:
                    allowed = f"{axis} = {low:g} ... {high:g} mm"
                    yield Fault(f"pivots[{i}]", MISSING, f"{axis} = {value:g} mm is outside of the area", allowed)


def _pivot_faults(pivot: Pivot, path: str) -> Iterator[Fault]:
    if pivot.line and (pivot.x_mm is not None or pivot.y_mm is not None):
        yield Fault(f"{path}.line", list(pivot.line), "cannot be combined with x_mm and y_mm", "line, or x_mm and y_mm")
    elif pivot.line and len(pivot.line) != 3:
        yield Fault(f"{path}.line", list(pivot.line), "must be three numbers", "[x, y, direction in degrees]")
    elif not pivot.line and pivot.z is None:
        yield Fault(path, MISSING, "has no position and no line", "x_mm and y_mm, or line")


def pivots_of(task: Task, dyad: int) -> tuple[Pivot, ...]:
    """Conditions on the pivots of a dyad, 1 or 2."""
    return tuple(pivot for pivot in task.pivots if pivot.dyad in (None, dyad))


def _freedom_faults(task: Task, dyad: int) -> Iterator[Fault]:
    """Pivots that contradict each other, or fix more than the poses leave free."""
    rows = [(at, row) for at, row in enumerate(task.pivots) if row.dyad in (None, dyad)]
    for of in (FIXED, MOVING):
        same = [at for at, row in rows if row.of == of]
        if len(same) > 1:
            at = same[1]
            yield Fault(f"pivots[{at}]", MISSING, f"the {of} pivot of dyad {dyad} is given twice", "once for a dyad")
            return
    free, given = MOST_POSES - len(task.poses), sum(row.conditions for _, row in rows)
    if given > free:
        at, _ = rows[-1]
        problem = f"the pivots of dyad {dyad} set {given} conditions, {len(task.poses)} poses leave {free}"
        yield Fault(f"pivots[{at}]", MISSING, problem, f"at most {free}: 2 for a position, 1 for a line")


def _shared_pivot_faults(task: Task) -> Iterator[Fault]:
    """Pivots at a position of both dyads, which would be one link, or turn about one point."""
    for i, pivot in enumerate(task.pivots):
        if pivot.dyad is None and not pivot.line:
            yield Fault(f"pivots[{i}]", MISSING, "a position belongs to one dyad, not to both", "dyad = 1 | 2")


def _path_faults(task: Task) -> Iterator[Fault]:
    path = task.path
    assert path is not None
    if bool(path.points) == bool(path.file):
        problem = "cannot be combined with file" if path.file else "missing"
        yield Fault("path.points", MISSING, problem, "points | file")
        return
    if path.points:
        if path.point:
            yield Fault("path.point", path.point, "is not used with points", "leave it out")
        yield from point_faults(task, [point.z for point in path.points])


def point_faults(task: Task, points: Sequence[complex]) -> Iterator[Fault]:
    """Faults of a path's points [mm], and of the lists with one number for each of them."""
    n, path = len(points), task.path
    assert path is not None
    if not FEWEST_POINTS <= n <= MOST_POINTS:
        yield Fault("path.points", MISSING, _count(n, "point"), f"{FEWEST_POINTS} ... {MOST_POINTS}")
    elif task_size(points) == 0.0:
        yield Fault("path.points", MISSING, "are all equal", "different points")
    for name in ("driver_deg", "weights"):
        numbers = getattr(path, name)
        if numbers and len(numbers) != n:
            yield Fault(f"path.{name}", MISSING, f"{len(numbers)} numbers for {n} points", "one for each point")
    if len(path.driver_deg) == n and (twice := _angle_of_two_points(path.driver_deg, points)) is not None:
        yield Fault("path.driver_deg", twice, "is the angle of two different points", "each angle of a turn once")
    if any(not weight > 0.0 for weight in path.weights):
        yield Fault("path.weights", MISSING, "has a weight that is not positive", "> 0")


def _angle_of_two_points(angles: Sequence[float], points: Sequence[complex]) -> float | None:
    """An angle [deg] that two points [mm] share, but for whole turns, though they differ; None where there is none."""
    order = sorted(range(len(angles)), key=lambda i: angles[i] % 360.0)
    for i, k in zip(order, (*order[1:], order[0]), strict=True):
        difference = (angles[k] - angles[i] + 180.0) % 360.0 - 180.0
        if abs(difference) < 1e-9 and abs(points[k] - points[i]) > SAME * task_size(points):
            return angles[k]
    return None


def _angle_faults(task: Task) -> Iterator[Fault]:
    angles = task.angles
    assert angles is not None
    if not FEWEST_PAIRS <= len(angles.pairs) <= MOST_POINTS:
        yield Fault("angles.pairs", MISSING, _count(len(angles.pairs), "pair"), f"{FEWEST_PAIRS} ... {MOST_POINTS}")
    seen: list[float] = []
    for i, pair in enumerate(angles.pairs):
        if any(abs((pair.driver_deg - other + 180.0) % 360.0 - 180.0) < 1e-9 for other in seen):
            yield Fault(f"angles.pairs[{i}]", pair.driver_deg, "the driver's angle is given twice", "each angle once")
        seen.append(pair.driver_deg)
    if angles.output == SLIDER_OUTPUT and angles.frame_mm is not None:
        yield Fault("angles.frame_mm", angles.frame_mm, "is not used with a slider", "leave it out")
    elif angles.output == ROCKER_OUTPUT and angles.frame_mm is None:
        yield Fault("angles.frame_mm", MISSING, "missing", "> 0 mm")


_RULES: Mapping[str, Callable[[Task], Iterator[Fault]]] = MappingProxyType(
    {POSES: _pose_faults, PATH: _path_faults, ANGLES: _angle_faults}
)
"""Kind of task -> its faults beyond the ranges of its values."""


def _count(n: int, noun: str) -> str:
    return f"{n} {noun}" if n == 1 else f"{n} {noun}s"


def task_size(points: Sequence[complex]) -> float:
    """Diagonal of the box of points [mm]."""
    x, y = [z.real for z in points], [z.imag for z in points]
    return abs(complex(max(x) - min(x), max(y) - min(y)))


def _common_pole(poses: Sequence[BodyPose], size: float) -> complex | None:
    """Point about which all poses are turned from the first one; None where there is none."""
    first, poles = poses[0], []
    for pose in poses[1:]:
        turn = cmath.exp(1j * radians(pose.angle_deg - first.angle_deg))
        if abs(turn - 1.0) <= 1e-9:
            return None
        poles.append((pose.z - turn * first.z) / (1.0 - turn))
    same = all(abs(pole - poles[0]) <= SAME * max(size, abs(poles[0])) for pole in poles)
    return poles[0] if same else None


def _are_on_one_line(points: Sequence[complex], size: float) -> bool:
    far = max(points, key=lambda z: abs(z - points[0])) - points[0]
    return all(abs((far.conjugate() * (z - points[0])).imag) <= SAME * size * abs(far) for z in points)
