"""Judgement of proposed linkages by their solved kinematics: errors, defects, transmission angle, and sizes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import degrees, inf, pi, radians
from types import MappingProxyType

import numpy as np

from core.design import Linkage, Side
from core.design.linkage_rules import sided_joints
from core.errors import NoPosition, collecting_failures
from core.frozen import frozen
from core.mechanism.branches import Branch, four_bar
from core.mechanism.driver_ranges import TURN, DriverRange, DriverRanges, driver_ranges_of
from core.mechanism.kinematics import Kinematics
from core.mechanism.linkage import plan_of
from core.mechanism.mechanism import body_name
from core.mechanism.solving import unit_speed_kinematics
from core.synthesis.candidates import (
    COUPLER,
    CRANK_LINK,
    CRANK_PIN,
    CRANK_PIVOT,
    FRAME,
    SIDE_LINK,
    SIDE_PIN,
    SIDE_PIVOT,
    Candidate,
    Errors,
    is_in_order,
    shortest_arc,
)
from core.synthesis.task import Task

BRANCH, CIRCUIT, ORDER = "branch", "circuit", "order"
"""Defects: the task needs another assembly; it leaves a range of the driver; its positions are passed in another order."""
SAMPLES = 181  # driver positions for the box of all joints
AT_END = 1e-9  # [rad]: a position this far outside of a range is at its end
SAME_ERROR = 1e-9  # of the size: errors that differ by less are equal
OTHER_ASSEMBLY = 0.5  # of the error: another assembly with a smaller one fits the task
EXACT = 1e-6  # of the size, beyond the error with which it was proposed: a smaller error needs no other assembly
TURNS_FREELY = 1e-9
SAME_LINKAGE = 1e-4  # of the size: linkages that differ by less are one


@frozen(eq=False)
class Answer:
    """A judged linkage.

    Attributes
    ----------
    candidate : Candidate
    error_mm, error_deg : float
        Largest errors at the positions of the task.
    defects : tuple of str
        Of ``branch``, ``circuit``, ``order``.
    transmission_deg : float
        Least transmission angle over the driver's range that contains the task: a full turn, else from the first position to the last.
    grashof : bool
        A side link can turn fully; of a four-bar, Grashof's condition.
    length_ratio : float
        Longest to shortest link.
    size_mm : float
        Diagonal of the box of all joints and of P over the same range.
    violated : tuple of str
        Limits of the task that the linkage exceeds.
    cognates : tuple of Answer
        Other four-bars with the same path.
    """

    candidate: Candidate
    error_mm: float
    error_deg: float
    defects: tuple[str, ...]
    transmission_deg: float
    grashof: bool
    length_ratio: float
    size_mm: float
    turns_fully: bool
    violated: tuple[str, ...] = ()
    cognates: tuple[Answer, ...] = ()

    @property
    def is_good(self) -> bool:
        """Whether it has no defect and exceeds no limit."""
        return not self.defects and not self.violated


def ranked(answers: Sequence[Answer], size: float) -> list[Answer]:
    """Answers without defects first, then by error, equal ones by transmission angle; ``size`` is that of the task [mm]."""

    def rank(answer: Answer) -> tuple[bool, int, float, float]:
        error = answer.error_mm / size + radians(answer.error_deg)
        step = round(error / SAME_ERROR) if error < inf else 2**62
        return not answer.is_good, len(answer.defects), step, -answer.transmission_deg

    return sorted(answers, key=rank)


def is_same(answer: Answer, other: Answer) -> bool:
    """Whether two answers are one linkage, up to the names of its links."""
    if answer.candidate.kind != other.candidate.kind:
        return False
    (mine, lines), (theirs, other_lines) = (_sides(row.candidate.linkage) for row in (answer, other))
    near = SAME_LINKAGE * answer.size_mm
    has_same_sides = any(np.abs(mine - sides).max() <= near for sides in (theirs, theirs[::-1]))
    return has_same_sides and bool(np.abs(lines - other_lines).max(initial=0.0) <= near)


def _sides(linkage: Linkage) -> tuple[np.ndarray, np.ndarray]:
    """Fixed pivot, distance of the pin from the tracer, and length of both side links (2, 3), 0 of a slider; points of lines [mm]."""
    frame, coupler = linkage.by_number[FRAME].places, linkage.by_number[COUPLER].places
    sides = [
        (frame.get(pivot, 0j), abs(coupler.get(pin, 0j)), abs(linkage.by_number[link].places.get(pin, 0j)))
        for link, pivot, pin in ((CRANK_LINK, CRANK_PIVOT, CRANK_PIN), (SIDE_LINK, SIDE_PIVOT, SIDE_PIN))
    ]
    lines = [complex(slider.through_x_mm, slider.through_y_mm) for slider in linkage.sliders]
    return np.array(sides), np.array(lines)


def best_driven(driven: Sequence[Candidate], task: Task) -> Answer | None:
    """Judge a linkage driven by either side link: without defects, then with a full turn, then by transmission angle.

    The second driver is not judged where the first one turns fully without a defect; None where neither can be assembled.
    """
    answers: list[Answer] = []
    for candidate in driven:
        answer = judge(candidate, task)
        if answer is not None:
            answers.append(answer)
            if answer.turns_fully and not answer.defects:
                break
    return min(answers, key=lambda a: (len(a.defects), not a.turns_fully, -a.transmission_deg), default=None)


def judge(candidate: Candidate, task: Task) -> Answer | None:
    """Judge a proposed linkage; None where it cannot be assembled at any position of the task."""
    linkage = candidate.linkage
    size = plan_of(linkage).size * 1e3
    try:
        ranges = driver_ranges_of(linkage)
    except NoPosition:
        return None
    if not ranges.ranges:
        return None
    driver_range, turns_fully = _task_range(candidate, ranges)
    positions = _in_range(candidate.positions, driver_range, turns_fully)
    error_mm, error_deg = _errors(candidate, linkage, ranges, positions)
    positions = np.where(np.isfinite(error_mm), positions, np.nan)
    inside = np.isfinite(positions)
    error = error_mm / size + np.deg2rad(error_deg)
    other_mm, other_deg = np.full(error.size, np.nan), np.full(error.size, np.nan)
    allowed = EXACT + candidate.expected / size
    if not (inside & (error <= allowed)).all():
        other_mm, other_deg = _other_errors(candidate)
    defects = []
    with np.errstate(invalid="ignore"):
        other = other_mm / size + np.deg2rad(other_deg)
        changes = inside & (error > allowed) & (other < OTHER_ASSEMBLY * error)
    if changes.any():
        defects.append(BRANCH)
    if not inside.all():
        defects.append(CIRCUIT)
    elif task.limits.order and not _in_order(positions, turns_fully):
        defects.append(ORDER)
    use_other = changes | ~inside
    error_mm, error_deg = np.where(use_other, other_mm, error_mm), np.where(use_other, other_deg, error_deg)
    if turns_fully:
        low, high = driver_range.low, driver_range.low + TURN
    elif inside.any():
        low, high = float(np.nanmin(positions)), float(np.nanmax(positions))
    else:
        return None
    transmission, box = _over_range(linkage, ranges, low, high)
    answer = Answer(
        candidate,
        _largest(error_mm),
        _largest(error_deg),
        tuple(defects),
        transmission,
        _is_grashof(linkage, turns_fully),
        _length_ratio(candidate),
        box,
        turns_fully,
    )
    return replace(answer, violated=tuple(_violated(answer, task)))


def _task_range(candidate: Candidate, ranges: DriverRanges) -> tuple[DriverRange, bool]:
    """Range of the driver that contains the task, and whether it is a full turn.

    A linkage that can be folded into one line, such as a parallelogram, only turns fully where the task needs it: else its range ends at
    the change points, where play decides which assembly follows.
    """
    driver_range = ranges.ranges[0]
    if ranges.is_swinging or not driver_range.is_free:
        return driver_range, False
    low, high = shortest_arc(candidate.positions)
    changes = ranges.changes
    if not changes or any((change.at - low) % TURN <= high - low for change in changes):
        return driver_range, True
    before = max(low - (low - change.at) % TURN for change in changes)
    after = min(high + (change.at - high) % TURN for change in changes)
    return DriverRange(before, after, changes[0].joint, changes[0].joint), False


def _largest(errors: np.ndarray) -> float:
    """Largest error; infinite where the linkage does not reach a position."""
    return float(np.where(np.isfinite(errors), errors, inf).max(initial=0.0))


def _in_range(positions: np.ndarray, driver_range: DriverRange, turns_fully: bool) -> np.ndarray:
    """Positions (n,) [rad] with the turns that bring them into the range; NaN where they are outside."""
    low, high = driver_range.low, driver_range.high
    if turns_fully:
        return low + np.mod(positions - low, TURN)
    moved = low + np.mod(positions - low, TURN)
    moved = np.where(moved > low + TURN - AT_END, low, moved)
    moved = np.where((moved > high) & (moved <= high + AT_END), high, moved)
    return np.where(moved <= high, moved, np.nan)


def _in_order(positions: np.ndarray, turns_fully: bool) -> bool:
    """Whether positions (n,) [rad] are passed in their order, in either direction."""
    if turns_fully:
        return is_in_order(positions)
    steps = np.diff(positions)
    return bool((steps > 0.0).all() or (steps < 0.0).all())


def _errors(
    candidate: Candidate, linkage: Linkage, ranges: DriverRanges, positions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Errors at driver positions (n,) [rad] of the task, [mm] and [deg]; NaN where these are NaN, or the links do not meet."""
    error_mm, error_deg = np.full(positions.size, np.nan), np.full(positions.size, np.nan)
    usable = np.isfinite(positions)
    if usable.any():
        at = np.where(usable, positions, positions[usable][0])
        with collecting_failures(lambda code, failed: None):
            mm, deg = candidate.errors(unit_speed_kinematics(linkage, at, ranges))
        error_mm[usable], error_deg[usable] = mm[usable], deg[usable]
    return error_mm, error_deg


def _other_errors(candidate: Candidate) -> tuple[np.ndarray, np.ndarray]:
    """Least errors over both assemblies, [mm] and [deg]; NaN where neither reaches a position."""
    plain = replace(candidate.linkage, drawn=None)
    n = candidate.positions.size
    best_mm, best_deg = np.full(n, np.nan), np.full(n, np.nan)
    everywhere = (DriverRange(-inf, inf),)
    for joint in sided_joints(plain):
        for sign in (1, -1):
            signed = replace(plain, branch=(Side(joint, sign),))
            ranges = DriverRanges(plan_of(signed), everywhere, (), Branch(), MappingProxyType({}))
            with collecting_failures(lambda code, failed: None):  # NaN where the links do not meet
                mm, deg = candidate.errors(unit_speed_kinematics(signed, candidate.positions, ranges))
            is_better = ~(mm + deg >= best_mm + best_deg) & np.isfinite(mm + deg)
            best_mm, best_deg = np.where(is_better, mm, best_mm), np.where(is_better, deg, best_deg)
    return best_mm, best_deg


def _over_range(linkage: Linkage, ranges: DriverRanges, low: float, high: float) -> tuple[float, float]:
    """Least transmission angle [deg], and the diagonal [mm] of the box of all joints, for the driver at low ... high [rad]."""
    at = np.unique(np.concatenate((np.linspace(low, high, SAMPLES), list(_in_line(linkage, low, high)))))
    kinematics = unit_speed_kinematics(linkage, at, ranges)
    transmission = min(degrees(float(np.min(angle))) for angle in kinematics.transmission.values())
    return transmission, _box(linkage, kinematics)


def _in_line(linkage: Linkage, low: float, high: float) -> Iterator[float]:
    """Driver positions [rad] at which the transmission angle is extreme: the crank is along the frame, or across the guide."""
    if SIDE_PIVOT in (frame := linkage.by_number[FRAME].places):
        line = float(np.angle(frame[SIDE_PIVOT] - frame[CRANK_PIVOT]))
    else:
        line = radians(linkage.sliders[0].angle_deg) + 0.5 * pi
    for angle in (line, line + pi):
        at = low + (angle - low) % TURN
        if at <= high:
            yield at


def _box(linkage: Linkage, kinematics: Kinematics) -> float:
    points = []
    for link in linkage.links:
        body = kinematics.bodies["frame" if link.number == FRAME else body_name(link.number)]
        for point in link.places.values():
            points.append(np.atleast_1d(body.fixed_point(1e-3 * point)[0]))
    z = np.concatenate(points)
    return 1e3 * float(np.hypot(np.ptp(z.real), np.ptp(z.imag)))


def _lengths(candidate: Candidate) -> Iterator[float]:
    """Lengths of the links [mm] between two pins."""
    links: Mapping[int, Mapping[str, complex]] = {
        number: link.places for number, link in candidate.linkage.by_number.items()
    }
    for number, names in (
        (FRAME, (CRANK_PIVOT, SIDE_PIVOT)),
        (CRANK_LINK, (CRANK_PIVOT, CRANK_PIN)),
        (COUPLER, (CRANK_PIN, SIDE_PIN)),
        (SIDE_LINK, (SIDE_PIN, SIDE_PIVOT)),
    ):
        places = links[number]
        if all(name in places for name in names):
            yield abs(places[names[0]] - places[names[1]])


def _length_ratio(candidate: Candidate) -> float:
    lengths = list(_lengths(candidate))
    return max(lengths) / min(lengths) if min(lengths) > 0.0 else inf


def _is_grashof(linkage: Linkage, turns_fully: bool) -> bool:
    bar = four_bar(plan_of(linkage))
    return turns_fully if bar is None else bar.kind != "triple rocker"


def task_positions(answer: Answer) -> np.ndarray:
    """Angles of the driver at the positions of the task, within its range.

    Parameters
    ----------
    answer : Answer

    Returns
    -------
    ndarray (n,) [rad]
        NaN for positions outside of the range.
    """
    candidate = answer.candidate
    driver_range, turns_fully = _task_range(candidate, driver_ranges_of(candidate.linkage))
    return _in_range(candidate.positions, driver_range, turns_fully)


def joint_positions(answer: Answer, count: int) -> Mapping[str, np.ndarray]:
    """Positions of all points of an answer while its driver passes its full turn, or its range.

    Parameters
    ----------
    answer : Answer
    count : int
        Number n of driver positions, evenly spaced.

    Returns
    -------
    mapping of str to ndarray (n,) complex [mm]
        By the name of the point.
    """
    linkage = answer.candidate.linkage
    ranges = driver_ranges_of(linkage)
    driver_range, _ = _task_range(answer.candidate, ranges)
    low, high = driver_range.low, driver_range.high
    inset = 0.0 if answer.turns_fully else 1e-6 * (high - low)
    at = np.linspace(low + inset, high - inset, count)
    kinematics = unit_speed_kinematics(linkage, at, ranges)
    positions: dict[str, np.ndarray] = {}
    for link in linkage.links:
        body = kinematics.bodies["frame" if link.number == FRAME else body_name(link.number)]
        for name, point in link.places.items():
            if name not in positions:
                positions[name] = np.broadcast_to(1e3 * body.fixed_point(1e-3 * point)[0], (count,))
    return positions


def _violated(answer: Answer, task: Task) -> Iterator[str]:
    least, most = task.limits.transmission_deg_min, task.longest_to_shortest
    if least is not None and not answer.transmission_deg >= least - TURNS_FREELY:
        yield "transmission_deg_min"
    if most is not None and not answer.length_ratio <= most * (1.0 + TURNS_FREELY):
        yield "length_ratio_max"


def position_errors(z: np.ndarray, angles: np.ndarray | None) -> Errors:
    """Errors of the coupler against positions of its point P, and against its angles.

    Parameters
    ----------
    z : ndarray (n,) complex [mm]
        Positions of P.
    angles : ndarray (n,) [rad], or None
        Angles of the coupler; None where they do not count.

    Returns
    -------
    callable
        As ``Candidate.errors``.
    """

    def errors(kinematics: Kinematics) -> tuple[np.ndarray, np.ndarray]:
        body = kinematics.bodies[body_name(COUPLER)]
        point = 1e3 * body.fixed_point(0j)[0]
        distance = np.abs(point - z)
        if angles is None:
            return distance, np.zeros(z.size)
        turn = np.angle(np.exp(1j * (body.angle[0] - angles)))
        return distance, np.abs(np.rad2deg(turn))

    return errors
