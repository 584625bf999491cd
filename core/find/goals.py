"""What a design reaches of a limit, and how far that is from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.design import Design, edited, get, with_drive, with_spans
from core.findings import distinct_texts
from core.frozen import frozen
from core.motion import connected_segments
from core.study.limits import CONVEX, FORCE, LIMITS, SPEEDS
from core.units import split_unit

# -- what a design reaches of a limit, and how far that is from it ----------------------------------------------


@frozen
class LimitReading:
    """A limit and what is reached: value in the unit of the limit, infinite where there is no such figure; margin as a part of the
    limit; cam angle [rad]; reason: of the limit, empty where it was stated; whose: of which flank."""

    key: str
    limit: float
    reached: float
    margin: float
    theta: float
    reason: str = ""
    whose: str = ""

    @property
    def kept(self) -> bool:
        """A limit of 0 must not be reached itself."""
        return self.margin >= 0.0 if self.limit else self.margin > 0.0

    @property
    def text(self) -> str:
        """The reading in a line: value, cam angle, limit and why it holds."""
        unit = LIMITS[self.key].unit if self.key in LIMITS else "N"
        name = split_unit(self.key.rpartition(".")[2])[0].replace("_", " ")
        if not self.limit and self.key == CONVEX:
            return f"undercut at {math.degrees(self.theta):.5g} deg"
        reached, limit = distinct_texts([self.reached, self.limit], 6)
        why = f" ({self.reason})" if self.reason else ""
        return f"{name}{self.whose} {reached} {unit} at {math.degrees(self.theta):.5g} deg, limit {limit} {unit}{why}"


# -- what can be sought -----------------------------------------------------------------------------------------


Box = Mapping[str, tuple[float | None, float | None]]
"""Path -> bounds of the value that the user states."""

SMALLEST, LARGEST, LEAST_PRESSURE, NARROWEST = "smallest", "largest", "least pressure angle", "narrowest"
LEAST_PRELOAD, LEAST_RATE, LIFT_OFF = "least preload", "least rate", "lift-off speed"
PRELOADS = ("loads.preload_n", "loads.preload_nm")
SPRING_RATES = ("loads.spring_rate_n_per_mm", "loads.spring_rate_nm_per_rad")
ENDS = ("_min", "_max")
NEAR = np.linspace(-0.4, 0.4, 25)  # of the logarithm: where values near the present one are tried
FAR = np.linspace(-4.6, 4.6, 36)


def _nothing(design: Design, path: str) -> Mapping[str, float]:
    return {}


def _no_choice(design: Design) -> tuple[str, ...]:
    return ()


class SearchRow(NamedTuple):
    """title    as a heading
    fields   design, the paths that the user bounds -> the fields that are varied
    wanted   which of the values that keep the limits
    values   design, path -> the values tried first, rising: those between which there may be an answer
    limits   keys that apply
    places   design -> the fields of which one is varied, where the user may choose
    holding  it seeks what keeps the follower on an open cam
    contact  that the follower is kept on an open cam is a limit, too
    bounded  whether the fields may be bounded
    put      design, one of the fields, value -> the design with it
    beside   design with an answer, the field -> what else was changed with it, path -> value
    """

    title: str
    fields: Callable[[Design, Box], tuple[str, ...]]
    wanted: str
    values: Callable[[Design, str], np.ndarray]
    limits: tuple[str, ...] = tuple(LIMITS)
    help: str = ""
    places: Callable[[Design], tuple[str, ...]] = _no_choice
    holding: bool = False
    contact: bool = True
    bounded: bool = True
    put: Callable[[Design, str, float], Design] = edited
    beside: Callable[[Design, str], Mapping[str, float]] = _nothing

    def keys(self, design: Design, paths: Sequence[str]) -> tuple[str, ...]:
        """Everything that may be limited when these fields are varied."""
        return (
            *self.limits,
            *self.keeping(design),
            *(f"{path}{end}" for path in paths for end in ENDS if self.bounded),
        )

    def keeping(self, design: Design) -> tuple[str, ...]:
        """The keys of what keeps the follower on an open cam: the least force, and the speed up to which where none is sought."""
        if not self.contact or design.drive.cam is None or design.drive.cam.form.holds:
            return ()
        return (f"{FORCE}_min",) if self.wanted == LIFT_OFF else (f"{FORCE}_min", f"{speed_path(design)}_max")


def _always(*paths: str) -> Callable[[Design, Box], tuple[str, ...]]:
    return lambda design, box: paths


def _untried(design: Design, path: str) -> np.ndarray:
    """None: the value follows from an equation."""
    return np.zeros(0)


def _around(design: Design, path: str) -> np.ndarray:
    """From a hundredth of the present value to a hundred times, closer near it."""
    return np.sort(get(design, path) * np.exp(np.concatenate((NEAR, FAR))))


def _up_to_base(design: Design, path: str) -> np.ndarray:
    """Rollers up to the size of the base circle."""
    base = get(design, "cam.base_radius_mm") if has(design, "cam.base_radius_mm") else 10.0 * get(design, path)
    return base * np.exp(np.linspace(math.log(1e-3), 0.0, 49))


def _within_reach(design: Design, path: str) -> np.ndarray:
    """Offsets up to the distance of the follower from the cam centre on the base circle."""
    reach = get(design, "cam.base_radius_mm") + design.drive.face.radius_mm
    return reach * np.linspace(-0.999, 0.999, 49)


def _spans(design: Design, path: str) -> np.ndarray:
    """Spans that leave something to the segment that gives and takes."""
    segments = design.drive.motion.segments if design.drive.motion else ()
    index = segment_of(path)
    together, other = _stretch(design, index)
    own, whole = segments[index].span_deg, sum(segments[i].span_deg for i in together)
    room = own * (1.0 + (segments[other].span_deg / whole if other not in together else 0.0))
    return np.union1d(np.linspace(0.0, room, 62)[1:-1], [own])


def _stretch(design: Design, index: int) -> tuple[tuple[int, ...], int]:
    """The segments that go on into each other without rest, of which a segment is one, and the one behind them, which gives and takes."""
    together = connected_segments(design.drive.motion, index) if design.drive.motion else (index,)
    return together, (together[-1] + 1) % len(design.drive.motion.segments if design.drive.motion else together)


def with_stretch(design: Design, path: str, span_deg: float) -> Design:
    """A segment's span changed, and in proportion those of the segments that it goes on into without rest: one alone would make the
    velocity or the acceleration jump where it meets them."""
    motion, index = design.drive.motion, segment_of(path)
    assert motion is not None
    together, other = _stretch(design, index)
    part = span_deg / motion.segments[index].span_deg
    spans = {i: motion.segments[i].span_deg * part for i in together} | {index: span_deg}
    return with_drive(design, motion=with_spans(motion, spans, other))


def _others_of_stretch(design: Design, path: str) -> Mapping[str, float]:
    segments = design.drive.motion.segments if design.drive.motion else ()
    index = segment_of(path)
    return {f"motion.segments[{i}].span_deg": segments[i].span_deg for i in _stretch(design, index)[0] if i != index}


def segment_of(path: str) -> int:
    """Number of the segment in a path, from 0."""
    return int(path.partition("[")[2].partition("]")[0])


def _rises(design: Design) -> tuple[str, ...]:
    """The spans of the segments that rise."""
    segments = design.drive.motion.segments if design.drive.motion else ()
    return tuple(f"motion.segments[{i}].span_deg" for i, segment in enumerate(segments) if segment.rise > 0.0)


def _rise(design: Design, box: Box) -> tuple[str, ...]:
    """The span of the segment that the user names or bounds, else of the first that rises."""
    named = (path for path in box if path.startswith("motion.segments["))
    return ((*named, *_rises(design), "motion.segments[0].span_deg")[0],)


def _beside(design: Design, path: str) -> np.ndarray:
    """Places of a pivot beside the present one: up to a quarter of its distance from the cam centre."""
    far = math.hypot(get(design, "follower.pivot_x_mm"), get(design, "follower.pivot_y_mm"))
    return get(design, path) + far * np.linspace(-0.25, 0.25, 9)


def _half_to_double(design: Design, path: str) -> np.ndarray:
    return get(design, path) * np.linspace(0.5, 2.0, 49)


def _arm(design: Design, box: Box) -> tuple[str, ...]:
    """The arm that carries what touches the cam."""
    return next(
        ((path,) for path in ("follower.arm_mm", "follower.roller_arm_mm") if has(design, path)), ("follower.arm_mm",)
    )


def _first(paths: tuple[str, ...]) -> Callable[[Design, Box], tuple[str, ...]]:
    """The one of these fields that the design has."""
    return lambda design, box: (next((path for path in paths if has(design, path)), paths[0]),)


def speed_path(design: Design) -> str:
    """The field of the shaft's speed."""
    return next((path for path in SPEEDS if has(design, path)), SPEEDS[0])


def has(design: Design, path: str) -> bool:
    """Whether the design has such an entry."""
    try:
        get(design, path)
    except (KeyError, IndexError):
        return False
    return True


WANTED: Mapping[str, SearchRow] = MappingProxyType(
    {
        "base-radius": SearchRow(
            "Smallest base radius", _always("cam.base_radius_mm"), SMALLEST, _around, help="the smallest base radius",
        ),
        "offset": SearchRow(
            "Offset of least pressure angle", _always("follower.offset_mm"), LEAST_PRESSURE, _within_reach,
            help="the offset of least pressure angle",
        ),
        "roller-radius": SearchRow("Largest roller", _always("cam.roller_radius_mm"), LARGEST, _up_to_base, help="the largest roller"),
        "span": SearchRow(
            "Shortest span of a rise", _rise, SMALLEST, _spans, help="the shortest span of a rise, the first or the one that is bounded",
            places=_rises, put=with_stretch, beside=_others_of_stretch,
        ),
        "face-width": SearchRow(
            "Narrowest flat face", _always("follower.face_half_width_mm", "follower.face_centre_mm"), NARROWEST,
            _untried, (), "the narrowest flat face, and its centre", contact=False,
        ),
        "pivot": SearchRow(
            "Pivot of least pressure angle", _always("follower.pivot_x_mm", "follower.pivot_y_mm"), LEAST_PRESSURE, _beside,
            help="the pivot of least pressure angle in a box",
        ),
        "arm": SearchRow(
            "Arm of least pressure angle", _arm, LEAST_PRESSURE, _half_to_double,
            help="the arm length of least pressure angle in a box",
        ),
        "preload": SearchRow(
            "Least preload", _first(PRELOADS), LEAST_PRELOAD, _untried, (),
            "the least preload of the closing spring that keeps loads.least_contact_force_n_min up to shaft.speed_rpm_max",
            holding=True,
        ),
        "spring": SearchRow(
            "Least spring rate", _first(SPRING_RATES), LEAST_RATE, _untried, (),
            "the least rate of the closing spring that does, with the present preload",
            holding=True,
        ),
        "lift-off-speed": SearchRow(
            "Lift-off speed", lambda design, box: (speed_path(design),), LIFT_OFF, _untried, (),
            "the speed from which the follower leaves the cam, or is pressed less than loads.least_contact_force_n_min",
            holding=True, bounded=False,
        ),
    }
)  # fmt: skip


def bounded(values: np.ndarray, low: float | None, high: float | None, counts: Sequence[int] = (25,)) -> np.ndarray:
    """The values between the bounds that are stated, and these themselves; values anew where none lies between."""
    low = float(values[0]) if low is None else low
    high = float(values[-1]) if high is None else high
    inside = values[(values > low) & (values < high)]
    if inside.size < counts[0]:
        inside = np.linspace(low, high, max(counts[0], inside.size))[1:-1]
    return np.unique(np.concatenate(([low], inside, [high])))
