"""The searches for one drive, the fields they vary, and the readings of their limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.design import Design, edited, get, with_drive, with_spans
from core.frozen import frozen
from core.motion import connected_segments
from core.number_text import compared_texts, result_text
from core.study.limits import CONVEX, FORCE, LIMITS, SPEEDS
from core.units import split_unit

# -- readings of limits -----------------------------------------------------------------------------------------


@frozen
class LimitReading:
    """A limit and the value that a design reaches.

    Attributes
    ----------
    key : str
        Key of the limit.
    limit, reached : float
        In the unit of the limit; infinite where the figure does not exist.
    margin : float
        Distance from the limit as a part of it, negative where it is violated.
    theta : float
        Cam angle [rad].
    reason : str
        Reason of the limit, empty where the user stated it.
    flank : str
        Flank on which it is reached.
    """

    key: str
    limit: float
    reached: float
    margin: float
    theta: float
    reason: str = ""
    flank: str = ""

    @property
    def is_satisfied(self) -> bool:
        """Whether the limit is satisfied; a limit of 0 must not be reached itself."""
        return self.margin >= 0.0 if self.limit else self.margin > 0.0

    @property
    def text(self) -> str:
        """The reading in a line: value, cam angle, limit and its reason."""
        unit = LIMITS[self.key].unit if self.key in LIMITS else "N"
        name = split_unit(self.key.rpartition(".")[2])[0].replace("_", " ")
        if not self.limit and self.key == CONVEX:
            return f"undercut at {result_text(math.degrees(self.theta))} deg"
        reached, limit = compared_texts([self.reached, self.limit])
        why = f" ({self.reason})" if self.reason else ""
        return f"{name}{self.flank} {reached} {unit} at {result_text(math.degrees(self.theta))} deg, limit {limit} {unit}{why}"


# -- searches ---------------------------------------------------------------------------------------------------

Box = Mapping[str, tuple[float | None, float | None]]
"""Path -> bounds of the value stated by the user."""

SMALLEST, LARGEST, LEAST_PRESSURE, NARROWEST = "smallest", "largest", "least pressure angle", "narrowest"
MOST = "most"
LEAST_PRELOAD, LEAST_RATE, LIFT_OFF = "least preload", "least rate", "lift-off speed"
PRELOADS = ("loads.preload_n", "loads.preload_nm")
SPRING_RATES = ("loads.spring_rate_n_per_mm", "loads.spring_rate_nm_per_rad")
VALVE_SPRING = "loads.valve_springs[0]"
INSTALLED, WIRE = f"{VALVE_SPRING}.installed_mm", f"{VALVE_SPRING}.wire_mm"
"""Fields of the first valve spring that set its preload and its rate."""
ENDS = ("_min", "_max")
NEAR = np.linspace(-0.4, 0.4, 25)  # of the logarithm: trial values near the present one, and far from it
FAR = np.linspace(-4.6, 4.6, 36)


class SearchRow(NamedTuple):
    """A search for the value of one or two fields of a drive.

    Attributes
    ----------
    title : str
        Heading.
    fields : callable
        Design, the paths that the user bounds -> paths of the varied fields.
    target : str
        Which of the values within the limits is the result.
    values : callable
        Design, path -> rising trial values, between which a solution may be.
    limits : tuple of str
        Keys of the limits that apply.
    choices : callable
        Design -> paths of the fields one of which is varied, where the user may choose.
    seeks_contact : bool
        Whether the search is for what keeps the follower on an open cam.
    limits_contact : bool
        Whether contact of the follower with an open cam is also a limit.
    bounded : bool
        Whether the user may bound the fields.
    put : callable
        Design, path of a field, value -> the design with the value.
    also_changed : callable
        Design with a solution, path -> values of other fields that change with it.
    """

    title: str
    fields: Callable[[Design, Box], tuple[str, ...]]
    target: str
    values: Callable[[Design, str], np.ndarray]
    limits: tuple[str, ...] = tuple(LIMITS)
    help: str = ""
    choices: Callable[[Design], tuple[str, ...]] = lambda design: ()
    seeks_contact: bool = False
    limits_contact: bool = True
    bounded: bool = True
    put: Callable[[Design, str, float], Design] = edited
    also_changed: Callable[[Design, str], Mapping[str, float]] = lambda design, path: {}

    def keys(self, design: Design, paths: Sequence[str]) -> tuple[str, ...]:
        """Keys of all limits that the user may state when these fields are varied."""
        return (
            *self.limits,
            *self.contact_limits(design),
            *(f"{path}{end}" for path in paths for end in ENDS if self.bounded),
        )

    def contact_limits(self, design: Design) -> tuple[str, ...]:
        """Keys of the contact with an open cam: the least force and, unless the search is for it, the highest speed."""
        if not self.limits_contact or not design.drive.has_disk or design.drive.cam.form.holds:
            return ()
        return (f"{FORCE}_min",) if self.target == LIFT_OFF else (f"{FORCE}_min", f"{speed_path(design)}_max")


def _always(*paths: str) -> Callable[[Design, Box], tuple[str, ...]]:
    return lambda design, box: paths


def _no_trials(design: Design, path: str) -> np.ndarray:
    """No trial values: the result follows from an equation."""
    return np.zeros(0)


def _around(design: Design, path: str) -> np.ndarray:
    """Values from a hundredth of the present value to a hundred times, closer near it."""
    return np.sort(get(design, path) * np.exp(np.concatenate((NEAR, FAR))))


def _counts(design: Design, path: str) -> np.ndarray:
    """Numbers of rollers with which the advance is a multiple of their pitch."""
    motion, counts = design.drive.motion, np.arange(1.0, 101.0)
    steps = (motion.gain if motion else 0.0) * counts / 360.0
    return counts[np.abs(steps - np.round(steps)) < 1e-9 * np.maximum(1.0, np.abs(steps))]


def _with_count(design: Design, path: str, value: float) -> Design:
    return edited(design, path, round(value))


def _up_to_base(design: Design, path: str) -> np.ndarray:
    """Roller radii up to that of the base circle."""
    base = get(design, "cam.base_radius_mm") if has(design, "cam.base_radius_mm") else 10.0 * get(design, path)
    return base * np.exp(np.linspace(math.log(1e-3), 0.0, 49))


def _within_reach(design: Design, path: str) -> np.ndarray:
    """Offsets up to the distance of the follower from the cam centre on the base circle."""
    reach = get(design, "cam.base_radius_mm") + design.drive.face.radius_mm
    return reach * np.linspace(-0.999, 0.999, 49)


def _spans(design: Design, path: str) -> np.ndarray:
    """Spans of a segment that leave a part to the segment whose span changes in return."""
    segments = design.drive.motion.segments if design.drive.motion else ()
    index = segment_of(path)
    stretch, compensating = _stretch(design, index)
    span, total = segments[index].span_deg, sum(segments[i].span_deg for i in stretch)
    greatest = span * (1.0 + (segments[compensating].span_deg / total if compensating not in stretch else 0.0))
    return np.union1d(np.linspace(0.0, greatest, 62)[1:-1], [span])


def _stretch(design: Design, index: int) -> tuple[tuple[int, ...], int]:
    """Segments that join a given one without rest, with it, and the next one, whose span compensates theirs."""
    stretch = connected_segments(design.drive.motion, index) if design.drive.motion else (index,)
    return stretch, (stretch[-1] + 1) % len(design.drive.motion.segments if design.drive.motion else stretch)


def with_stretch(design: Design, path: str, span_deg: float) -> Design:
    """Change a segment's span, and in proportion those of the segments it joins without rest.

    A changed span of one segment alone would make the velocity or the acceleration jump at the join.
    """
    motion, index = design.drive.motion, segment_of(path)
    assert motion is not None
    stretch, compensating = _stretch(design, index)
    factor = span_deg / motion.segments[index].span_deg
    spans = {i: motion.segments[i].span_deg * factor for i in stretch} | {index: span_deg}
    return with_drive(design, motion=with_spans(motion, spans, compensating))


def _others_of_stretch(design: Design, path: str) -> Mapping[str, float]:
    """Spans of the other segments of the stretch, by path."""
    segments = design.drive.motion.segments if design.drive.motion else ()
    index = segment_of(path)
    return {f"motion.segments[{i}].span_deg": segments[i].span_deg for i in _stretch(design, index)[0] if i != index}


def segment_of(path: str) -> int:
    """Index of the segment in a path."""
    return int(path.partition("[")[2].partition("]")[0])


def _rises(design: Design) -> tuple[str, ...]:
    """Paths of the spans of the rising segments."""
    segments = design.drive.motion.segments if design.drive.motion else ()
    return tuple(f"motion.segments[{i}].span_deg" for i, segment in enumerate(segments) if segment.rise > 0.0)


def _rise(design: Design, box: Box) -> tuple[str, ...]:
    """Path of the span of the segment that the user names or bounds, else of the first rising segment."""
    named = (path for path in box if path.startswith("motion.segments["))
    return ((*named, *_rises(design), "motion.segments[0].span_deg")[0],)


def _near_pivot(design: Design, path: str) -> np.ndarray:
    """Coordinates of a pivot up to a quarter of its distance from the cam centre away from the present one."""
    far = math.hypot(get(design, "follower.pivot_x_mm"), get(design, "follower.pivot_y_mm"))
    return get(design, path) + far * np.linspace(-0.25, 0.25, 9)


def _first(paths: tuple[str, ...]) -> Callable[[Design, Box], tuple[str, ...]]:
    """Function that returns the first of these fields that the design has."""
    return lambda design, box: (next((path for path in paths if has(design, path)), paths[0]),)


def _closing_spring(of_valve: str, paths: tuple[str, ...]) -> Callable[[Design, Box], tuple[str, ...]]:
    """The field of a typed valve spring, else the first of these fields that the design has."""
    plain = _first(paths)
    return lambda design, box: (of_valve,) if has(design, of_valve) else plain(design, box)


def speed_path(design: Design) -> str:
    """Path of the shaft's speed."""
    return next((path for path in SPEEDS if has(design, path)), SPEEDS[0])


def has(design: Design, path: str) -> bool:
    """Whether the design has such an entry."""
    try:
        get(design, path)
    except (KeyError, IndexError):
        return False
    return True


CAM_SEARCHES: Mapping[str, SearchRow] = MappingProxyType(
    {
        "base-radius": SearchRow(
            "Smallest base radius", _always("cam.base_radius_mm"), SMALLEST, _around, help="the smallest base radius",
        ),
        "offset": SearchRow(
            "Offset of least pressure angle", _always("follower.offset_mm"), LEAST_PRESSURE, _within_reach,
            help="the offset of least pressure angle",
        ),
        "roller-radius": SearchRow(
            "Largest roller", _always("cam.roller_radius_mm"), LARGEST, _up_to_base, help="the largest roller",
        ),
        "inner-distance": SearchRow(
            "Smallest inner distance", _always("cam.roller_inner_mm"), SMALLEST, _around,
            help="the smallest inner distance of the roller of a cam in space",
        ),
        "centre-distance": SearchRow(
            "Smallest centre distance", _always("cam.centre_distance_mm"), SMALLEST, _around,
            help="the smallest centre distance of a globoidal cam",
        ),
        "rollers": SearchRow(
            "Most rollers", _always("cam.rollers"), MOST, _counts, help="the greatest number of rollers on the turret",
            bounded=False, put=_with_count,
        ),
        "span": SearchRow(
            "Shortest span of a rise", _rise, SMALLEST, _spans,
            help="the shortest span of a rise: of the first, or of the one whose span has a bound",
            choices=_rises, put=with_stretch, also_changed=_others_of_stretch,
        ),
        "face-width": SearchRow(
            "Narrowest flat face", _always("follower.face_half_width_mm", "follower.face_centre_mm"), NARROWEST,
            _no_trials, (), "the narrowest flat face, and its centre", limits_contact=False,
        ),
        "pivot": SearchRow(
            "Pivot of least pressure angle", _always("follower.pivot_x_mm", "follower.pivot_y_mm"), LEAST_PRESSURE,
            _near_pivot, help="the pivot of least pressure angle within its bounds",
        ),
        "arm": SearchRow(
            "Arm of least pressure angle", _first(("follower.arm_mm", "follower.roller_arm_mm")), LEAST_PRESSURE,
            lambda design, path: get(design, path) * np.linspace(0.5, 2.0, 49),
            help="the arm length of least pressure angle within its bounds",
        ),
        "preload": SearchRow(
            "Least preload", _closing_spring(INSTALLED, PRELOADS), LEAST_PRELOAD, _no_trials, (),
            "the least preload of the closing spring that keeps loads.least_contact_force_n_min up to "
            "shaft.speed_rpm_max; of a typed valve spring its greatest installed length",
            seeks_contact=True,
        ),
        "spring": SearchRow(
            "Least spring rate", _closing_spring(WIRE, SPRING_RATES), LEAST_RATE, _no_trials, (),
            "the least rate of the closing spring that keeps this force, with the current preload; of a typed valve "
            "spring its thinnest wire, with the current lengths",
            seeks_contact=True,
        ),
        "lift-off-speed": SearchRow(
            "Lift-off speed", lambda design, box: (speed_path(design),), LIFT_OFF, _no_trials, (),
            "the speed above which the follower leaves the cam, or its contact force falls below "
            "loads.least_contact_force_n_min",
            seeks_contact=True, bounded=False,
        ),
    }
)  # fmt: skip


def trial_values(
    values: np.ndarray, low: float | None, high: float | None, counts: Sequence[int] = (25,)
) -> np.ndarray:
    """Trial values between the bounds, and the bounds themselves.

    Parameters
    ----------
    values : ndarray (n,) [mm or deg]
        Rising.
    low, high : float or None
        Bounds [mm or deg]; None: the first and the last value.
    counts : sequence of int
        Where fewer values than the first of these are between the bounds, they are replaced by equally spaced ones.

    Returns
    -------
    ndarray (m,) [mm or deg]
    """
    low = float(values[0]) if low is None else low
    high = float(values[-1]) if high is None else high
    inside = values[(values > low) & (values < high)]
    if inside.size < counts[0]:
        inside = np.linspace(low, high, max(counts[0], inside.size))[1:-1]
    return np.unique(np.concatenate(([low], inside, [high])))
