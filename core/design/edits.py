"""Edits that keep a design consistent: neighbouring values that must follow a change are changed in the same step.

The spans must add up to one turn and the rises to 0, so that none of them can change alone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from math import acos, degrees, floor, fsum, hypot, log10, nan, sqrt
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from core.design.camshaft import drive_at, only, rename_drive, turning_together, with_only
from core.design.design import Design, Drive, with_drive
from core.design.fields import unit_of, words_of
from core.design.follower_kinds import FOLLOWER_KINDS
from core.design.followers import (
    FACE,
    FORM,
    Conjugate,
    ContactFriction,
    LinkageConjugate,
    Open,
    SecondLinkRoller,
    SecondRoller,
)
from core.design.linkage import LinkageCam
from core.design.motions import (
    Curve,
    Motion,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplineCurve,
    SplinePoint,
    curve_of,
)
from core.design.parts import (
    SIDES,
    CamSlider,
    ElasticShaft,
    Oscillating,
    Pushrod,
    Rocker,
    SecondArm,
    SecondPlace,
    Shaft,
    Translating,
)
from core.design.paths import all_paths, of_class, put, row_at, with_assumed, with_guesses_marked
from core.design.spatial import Rib
from core.errors import DesignError, Fault
from core.laws import find_law
from core.number_text import result_text
from core.numerics.lazy import Column, column
from core.numerics.roots import two_sum
from core.units import UNITS, Unit

if TYPE_CHECKING:
    from decimal import Decimal

_EPS = float(np.finfo(float).eps)
_DECIMALS = 10  # of a difference: 283.3, not 283.29999999999995; far below the tolerance of closing


def balance(total: float, given: Iterable[float]) -> float:
    """Difference of a total and numbers, rounded to decimals; NaN where infinities cancel. With many designs a column."""
    given = list(given)
    if any(isinstance(number, Column) for number in (total, *given)):
        return _column_balance(total, given)
    try:
        return round(fsum([total, *(-number for number in given)]), _DECIMALS) + 0.0  # no minus zero
    except (OverflowError, ValueError):
        return nan


def _column_balance(total: Any, given: list[Any]) -> Any:
    """``balance`` of many designs, equal to the last bit; designs near a rounding tie are computed one by one."""
    high: Any = column(total)
    low: Any = 0.0
    for number in given:
        high, error = two_sum(high, column(-number))
        low = low + error
    scaled = (high + low) * 10.0**_DECIMALS
    rounded = np.rint(scaled)
    left = np.asarray(rounded / 10.0**_DECIMALS + 0.0)
    clear = (0.5 - np.abs(scaled - rounded) > 4.0 * _EPS * np.abs(scaled)) & (np.abs(scaled) < 2.0**50)
    for k in np.flatnonzero(~clear).tolist():
        total_k, *given_k = (float(np.broadcast_to(number, left.shape)[k]) for number in (total, *given))
        left[k] = balance(total_k, given_k)
    return column(left)


Typed = Collection[int]
"""Numbers of segments whose value was typed, so that other segments take a difference first."""


def _others(motion: Motion, index: int, typed: Typed) -> list[int]:
    """The other segments from the next one on (cyclic), typed ones last."""
    count = len(motion.segments)
    return sorted(((index + k) % count for k in range(1, count)), key=lambda i: i in typed)


def with_span(motion: Motion, index: int, span_deg: float, typed: Typed = ()) -> Motion:
    """Motion with another span of a segment [deg]; the next segment (cyclic) takes the difference."""
    others = _others(motion, index, typed)
    return with_spans(motion, {index: span_deg}, others[0] if others else index)


def with_spans(motion: Motion, spans: Mapping[int, float], taker: int) -> Motion:
    """Motion with other spans of some segments [deg]; the segment ``taker``, unless among them, takes the difference."""
    segments = [replace(s, span_deg=spans.get(i, s.span_deg)) for i, s in enumerate(motion.segments)]
    if taker not in spans:
        left = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i != taker))
        segments[taker] = replace(segments[taker], span_deg=left)
    return replace(motion, segments=tuple(segments))


def with_shared_spans(motion: Motion, spans: Mapping[int, float]) -> Motion:
    """Motion with other spans of some segments [deg]; the segments neither among them nor ``fixed`` share what is left in proportion.

    The spans make no turn where no segment is left to share, and those that share are not positive where nothing is left.
    """
    sharing = [i for i, s in enumerate(motion.segments) if i not in spans and not s.fixed]
    segments = [replace(s, span_deg=spans.get(i, s.span_deg)) for i, s in enumerate(motion.segments)]
    if sharing:
        present = balance(0.0, (-segments[i].span_deg for i in sharing))
        left = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i not in sharing))
        for i in sharing[:-1]:
            segments[i] = replace(segments[i], span_deg=balance(segments[i].span_deg * (left / present), ()))
        rest = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i != sharing[-1]))
        segments[sharing[-1]] = replace(segments[sharing[-1]], span_deg=rest)
    return replace(motion, segments=tuple(segments))


def with_rise(motion: Motion, index: int, rise: float, typed: Typed = ()) -> Motion:
    """Motion with another rise of a segment; the next moving segment (cyclic) takes the difference."""
    segments = list(motion.segments)
    segments[index] = replace(segments[index], rise=rise)
    return replace(motion, segments=back_at_start(segments, _others(motion, index, typed), motion.gain))


def back_at_start(segments: list[Segment], order: Iterable[int], gain: float = 0.0) -> tuple[Segment, ...]:
    """Segments whose rises add up to ``gain``; the first moving segment in ``order`` takes the difference."""
    for i in order:
        if not is_dwell(segments[i]):
            left = balance(gain, (s.rise for k, s in enumerate(segments) if k != i))
            segments[i] = replace(segments[i], rise=left)
            break
    return tuple(segments)


def stroke(motion: Motion) -> float:
    """Stroke: highest minus lowest level at the ends of segments [mm or deg]."""
    levels = [fsum(s.rise for s in motion.segments[:i]) for i in range(len(motion.segments) + 1)]  # above the start
    return max(levels) - min(levels)


def with_stroke(motion: Motion, target: float, current: float | None = None) -> Motion:
    """Motion with all levels scaled to another stroke [mm or deg]: start, rises, and values of curves.

    The level 0 stays. ``current`` is the present stroke where curves go beyond the levels at their ends. A lobe gets another
    lift, and keeps its durations.
    """
    if motion.lobe is not None:
        return replace(motion, lobe=replace(motion.lobe, lift_mm=target))
    current = stroke(motion) if current is None else current
    if current == 0.0:
        return motion

    def level(value: float) -> float:
        # multiplied first: 150 of a stroke of 150 becomes 160 of 160, not 160.00000000000003
        return value * target / current

    return with_levels(motion, level)


def with_levels(motion: Motion, level: Scale) -> Motion:
    """Motion with all levels scaled by a linear function: start, rises, values of curves, and lengths of a lobe."""
    if motion.lobe is not None:
        return replace(motion, start=level(motion.start), lobe=_with_lengths(motion.lobe, level))
    segments = tuple(replace(s, rise=level(s.rise), curve=scaled(s.curve, 1.0, level)) for s in motion.segments)
    advance = None if motion.advance is None else level(motion.advance)
    return replace(motion, start=level(motion.start), segments=segments, advance=advance)


def _with_lengths(part: Any, level: Scale) -> Any:
    """A lobe, or a part of it, with its lengths, velocities and accelerations scaled."""
    if isinstance(part, tuple):
        return tuple(_with_lengths(row, level) for row in part)
    if not is_dataclass(part):
        return part
    values: dict[str, Any] = {}
    for field in fields(part):
        value = getattr(part, field.name)
        is_length = value is not None and unit_of(field).symbol.startswith("mm")
        values[field.name] = level(value) if is_length else _with_lengths(value, level)
    return replace(part, **values)  # type: ignore[type-var]


def with_advance(motion: Motion, advance: float | None) -> Motion:
    """Motion with another advance per turn; the last moving segment takes the difference."""
    segments = back_at_start(list(motion.segments), range(len(motion.segments) - 1, -1, -1), advance or 0.0)
    return replace(motion, segments=segments, advance=advance)


def with_law(motion: Motion, index: int, law: str, typed: Typed = ()) -> Motion:
    """Motion with another law of a segment; the next moving segment takes the rise of a new dwell."""
    segments = list(motion.segments)
    segments[index] = replace(segments[index], curve=curve_of(law))
    changed = replace(motion, segments=tuple(segments))
    row = find_law(law)
    return with_rise(changed, index, 0.0, typed) if row is not None and row.is_dwell else changed


def with_segment_inserted(motion: Motion, index: int, *, before: bool = False) -> Motion:
    """Motion with a dwell after a segment, or before it, over half its span; no other join moves."""
    segments = list(motion.segments)
    span = segments[index].span_deg
    segments[index] = replace(segments[index], span_deg=span / 2.0)
    segments.insert(index if before else index + 1, Segment(span - span / 2.0, 0.0))
    return replace(motion, segments=tuple(segments))


def without_segment(motion: Motion, index: int, *, balanced: bool = True) -> Motion:
    """Motion without a segment; the only segment stays.

    The previous segment takes its span (the second one that of the first), so that no other join moves. With ``balanced``
    the next moving segment takes its rise.
    """
    segments = list(motion.segments)
    if len(segments) == 1:
        return motion
    removed = segments.pop(index)
    previous = max(index - 1, 0)
    span = balance(segments[previous].span_deg, (-removed.span_deg,))
    segments[previous] = replace(segments[previous], span_deg=span)
    order = [(index + k) % len(segments) for k in range(len(segments))] if removed.rise and balanced else []
    return replace(motion, segments=back_at_start(segments, order, motion.gain))


def with_layout(follower: CamSlider, layout: str) -> CamSlider:
    """Follower with another layout; the pivot changes its side of the cam where the layout requires it."""
    left = layout in "abef"
    side = abs(follower.pivot_x_mm) if left else -abs(follower.pivot_x_mm)
    return replace(follower, layout=layout, pivot_x_mm=side)


def is_dwell(segment: Segment) -> bool:
    """Whether a segment is a dwell, with equal levels at both ends."""
    law = find_law(segment.curve.law)
    return law is not None and law.is_dwell


# -- scaling of curves --------------------------------------------------------------------------------------

Scale = Callable[[float], float]


def stretched(curve: Curve, span: float, height: float) -> Curve:
    """Curve of the same shape for a segment with its span and rise multiplied by factors."""
    return scaled(curve, span, lambda value: value * height)


def scaled(curve: Curve, span: float, level: Scale) -> Curve:
    """Curve of the same shape for a segment with its span multiplied by a factor and its levels scaled by a linear function."""
    if isinstance(curve, PolynomialCurve):
        return PolynomialCurve(_end(curve.start, span, level), _end(curve.end, span, level))
    if isinstance(curve, SplineCurve):
        return replace(curve, points=tuple(_point(point, span, level) for point in curve.points))
    return curve


def times(value: float | None, factor: float) -> float | None:
    """Product of a value and a factor; None where there is no value."""
    return None if value is None else value * factor


def _scaled_derivative(value: float | None, level: Scale, span: float) -> float | None:
    return None if value is None else level(value) / span


def _end(end: PolynomialEnd, span: float, level: Scale) -> PolynomialEnd:
    return PolynomialEnd(
        level(end.velocity) / span, level(end.acceleration) / span**2, _scaled_derivative(end.jerk, level, span**3)
    )


def _point(point: SplinePoint, span: float, level: Scale) -> SplinePoint:
    return SplinePoint(
        point.at_deg * span,
        _scaled_derivative(point.value, level, 1.0),
        _scaled_derivative(point.velocity, level, span),
        _scaled_derivative(point.acceleration, level, span**2),
    )


# -- edits by path ------------------------------------------------------------------------------------------

MOTION_EDITS: Mapping[str, Callable[[Motion, int, Any, Typed], Motion]] = MappingProxyType(
    {
        r"motion\.segments\[(\d+)\]\.span_deg": with_span,
        r"motion\.segments\[(\d+)\]\.rise(?:_mm|_deg)?": with_rise,
        r"motion\.segments\[(\d+)\]\.law": with_law,
        r"motion\.advance(?:_mm|_deg)?()": lambda motion, _, value, __: with_advance(motion, value),
        r"motion\.stroke(?:_mm|_deg)?()": lambda motion, _, value, __: with_stroke(motion, value),
    }
)
"""Pattern of a path -> edit of a motion that changes neighbouring values too; other paths are put directly."""


def motion_edited(motion: Motion | None, path: str, value: Any, typed: Typed = ()) -> Motion | None:
    """Motion with the value at a path of ``MOTION_EDITS`` changed; None for other paths, or without a motion."""
    for pattern, change in MOTION_EDITS.items():
        match = re.fullmatch(pattern, path)
        if match and motion is not None:
            return change(motion, int(match[1] or 0), value, typed)
    return None


def edited(design: Design, path: str, value: Any, typed: Typed = ()) -> Design:
    """Design with the value at a path changed, and the values that must follow; it may have faults, see ``faults``."""
    if design.listed:
        return _edited_list(design, path, value)
    motion = motion_edited(design.drive.motion, path, value, typed)
    if motion is not None:
        return with_drive(design, motion=motion)
    if path == "follower.layout" and isinstance(design.drive.mechanism, CamSlider):
        return with_drive(design, mechanism=with_layout(design.drive.mechanism, value))
    if design.drive.has_disk and path == design.drive.face_path:
        return with_face(design, value)
    if design.drive.has_disk and path == f"cam.{FORM}":
        return with_form(design, value)
    changed = put(design, path, value)
    if design.drive.has_surface and path == f"cam.{FORM}":
        return _with_rollers_apart(changed)
    if changed.drive.is_linkage and changed.shaft is not None:
        return _at_one_speed(changed, path)
    return changed


_SPAN = re.compile(r"motion\.segments\[(\d+)\]\.span_deg")


def varied(design: Design, values: Mapping[str, Any], change: Callable[[Design, str, Any], Design] = edited) -> Design:
    """Design with other numbers at several paths, as a study varies them, and the values that must follow.

    Spans are made up for by ``with_shared_spans``, rises by a moving segment none of whose numbers is varied. ``change`` sets
    the other numbers.
    """
    if design.listed:
        of_drives: dict[int, dict[str, Any]] = {}
        for path, value in values.items():
            index, inside = drive_at(path) or (-1, path)
            of_drives.setdefault(index, {})[inside] = value
        for path, value in of_drives.pop(-1, {}).items():
            design = change(design, path, value)
        for index in sorted(of_drives):
            design = with_only(design, index, varied(only(design, index), of_drives[index], change))
        return design
    spans = {int(match[1]): value for path, value in values.items() if (match := _SPAN.fullmatch(path))}
    if spans and design.drive.motion is not None:
        design = with_drive(design, motion=with_shared_spans(design.drive.motion, spans))
    typed = {row_at(path)[1] for path in values if path.startswith("motion.")}
    for path, value in values.items():
        motion = None if _SPAN.fullmatch(path) else motion_edited(design.drive.motion, path, value, typed)
        if motion is not None:
            design = with_drive(design, motion=motion)
        elif not _SPAN.fullmatch(path):
            design = change(design, path, value)
    return design


def _edited_list(design: Design, path: str, value: Any) -> Design:
    """``edited`` in a design with a list of drives; a name changes in the sequence conditions too."""
    in_drive = drive_at(path)
    if in_drive is not None and in_drive[0] < len(design.drives):
        index, rest = in_drive
        return with_only(design, index, edited(only(design, index), rest, value))
    _, number, inside = row_at(path, "drives")
    if inside == "name" != path:
        return rename_drive(design, number, value)
    changed = put(design, path, value)
    return turning_together(changed) if path in ("shaft.speed_rpm", "shaft.rotation") else changed


FIRST_RADIUS = 0.2  # default radius of a new roller or shoe, relative to the base radius


def with_face(design: Design, word: str) -> Design:
    """Design with another face on the cam; follower, cam and loads retain their common fields, a radius is shared by roller and shoe.

    New values are marked as assumed; the friction of a sliding face is 0 by default.

    Raises
    ------
    DesignError
        For a face that the follower cannot have.
    """
    drive, old = design.drive, design.drive.face
    words = words_of(type(drive.cam if drive.is_linkage else drive.mechanism), FACE)
    if word not in words:
        raise DesignError([Fault(drive.face_path, word, "unknown word", " | ".join(words))])
    if word == old.face:
        return design
    size = old.radius_mm or _first_radius(drive)
    new_drive = (_linkage_with_face if drive.is_linkage else _follower_with_face)(drive, word, size)
    friction = (drive.loads.contact or ContactFriction()) if new_drive.face.slides else None
    loads = replace(new_drive.loads, contact=friction)
    changed = with_drive(design, mechanism=new_drive.mechanism, cam=new_drive.cam, loads=loads)
    before, after = set(all_paths(design)), list(all_paths(changed))
    new = [path for path in after if path not in before and path.endswith("_mm") and ".face_" not in path]
    assumed = [*new, *(path for path in design.assumed if path in after)]
    return replace(changed, assumed=tuple(sorted(assumed, key=after.index)))


def _with_rollers_apart(design: Design) -> Design:
    """Design whose rib of a slide has a distance of its rollers, by default three radii, marked as assumed."""
    cam, path = design.drive.cam, "cam.roller_distance_mm"
    motion = design.drive.motion
    if (
        not isinstance(cam.form, Rib)
        or cam.form.roller_distance_mm is not None
        or motion is None
        or motion.unit != "mm"
    ):
        return design
    return with_assumed(put(design, path, 3.0 * cam.roller_radius_mm), path, True)


def with_form(design: Design, word: str) -> Design:
    """Design with a cam of another form; new values are marked as assumed.

    The second roller of a conjugate pair has the radius of the first, and a position where it pushes in the opposite direction.
    """
    drive = design.drive
    if word == drive.cam.form.form:
        return design
    kind = words_of(type(drive.cam), FORM)[word]
    paired = kind in (Conjugate, LinkageConjugate)
    values: dict[str, Any] = (
        {"second": (_second_on_link if drive.is_linkage else _second_roller)(drive)} if paired else {}
    )
    changed = with_drive(design, cam=replace(drive.cam, form=of_class(kind, drive.cam.form, **values)))
    if not drive.is_linkage:
        follower: Any = drive.follower
        second = SECOND_PLACES[type(follower)](drive) if paired else None
        changed = with_drive(changed, mechanism=of_class(type(follower), follower, second=second))
    before, after = set(all_paths(design)), list(all_paths(changed))
    new = (path for path in after if path not in before and ".second." in path)
    return replace(changed, assumed=(*(path for path in design.assumed if path in after), *new))


def _second_roller(drive: Drive) -> SecondRoller:
    return SecondRoller(roller_radius_mm=drive.cam.roller_radius_mm)


def _second_on_link(drive: Drive) -> SecondLinkRoller:
    """Second roller at another point of the link with the first roller, where there is one."""
    cam: LinkageCam = drive.cam
    points = drive.linkage.by_number[cam.link].places if cam.link in drive.linkage.by_number else {}
    point = next((name for name in points if name != cam.point), cam.point)
    return SecondLinkRoller(link=cam.link, point=point, roller_radius_mm=cam.face.radius_mm)


def _angle_to_cam(drive: Drive, arm: float) -> float:
    """Angle between the arm and the line from pivot to cam centre, on the base circle [deg]; NaN without a triangle."""
    follower: Any = drive.follower
    reach, pivot = (
        drive.cam.base_radius_mm + drive.cam.roller_radius_mm,
        hypot(follower.pivot_x_mm, follower.pivot_y_mm),
    )
    cosine = (arm * arm + pivot * pivot - reach * reach) / (2.0 * arm * pivot or nan)
    return degrees(acos(cosine)) if -1.0 <= cosine <= 1.0 else nan


def _swing(drive: Drive) -> float:
    """Swing of the arm [deg]; for a cam-driven slider a default value."""
    return stroke(drive.motion) if drive.motion is not None and drive.motion.unit == "deg" else SOME_SWING


def _second_arm(drive: Drive, arm: float, side: float) -> SecondArm:
    """Second arm on the opposite side of the line to the cam centre, symmetric to the first over the stroke."""
    angle = round(-side * (2.0 * _angle_to_cam(drive, arm) + _swing(drive)), 2)
    return SecondArm(arm_mm=arm, angle_deg=angle if abs(angle) <= 360.0 else -side * 90.0)


def _second_arm_of_slider(drive: Drive) -> SecondArm:
    follower = drive.follower
    assert isinstance(follower, CamSlider)
    left = (follower.layout in "abef") == (follower.layout in "abcd")  # the arm is clockwise from the line to the cam
    return _second_arm(drive, follower.roller_arm_mm, -1.0 if left else 1.0)


def _second_arm_of_rocker(drive: Drive) -> SecondArm:
    follower = drive.follower
    assert isinstance(follower, Oscillating | Rocker)
    return _second_arm(drive, follower.arm_mm, SIDES[follower.side])


def _second_of_translating(drive: Drive) -> SecondPlace:
    """Second roller behind the cam centre, at the end of the stroke as far as the first is before it at the start."""
    follower = drive.follower
    assert isinstance(follower, Translating | Pushrod)
    reach = drive.cam.base_radius_mm + drive.cam.roller_radius_mm
    start = sqrt(max(reach * reach - follower.offset_mm * follower.offset_mm, 0.0))
    return SecondPlace(distance_mm=round(2.0 * start + (stroke(drive.motion) if drive.motion else 0.0), 3))


SOME_SWING = 20.0
SECOND_PLACES: Mapping[type, Callable[[Drive], SecondArm | SecondPlace]] = MappingProxyType(
    {
        CamSlider: _second_arm_of_slider,
        Oscillating: _second_arm_of_rocker,
        Translating: _second_of_translating,
        Rocker: _second_arm_of_rocker,
        Pushrod: _second_of_translating,
    }
)
"""Follower -> default position of the second roller of a conjugate pair."""


def _linkage_with_face(drive: Drive, word: str, radius: float) -> Drive:
    face = of_class(words_of(type(drive.cam), FACE)[word], roller_radius_mm=radius, shoe_radius_mm=radius)
    return replace(drive, cam=replace(drive.cam, face=face, form=Open()))


def _follower_with_face(drive: Drive, word: str, radius: float) -> Drive:
    row, old = FOLLOWER_KINDS[drive.kind], drive.follower
    follower, cam, loads = row.under(word)
    face: Any = of_class(row.faces[word], shoe_radius_mm=radius)
    base = drive.cam.base_radius_mm
    arm = max(
        hypot(getattr(old, "pivot_x_mm", 0.0), getattr(old, "pivot_y_mm", 0.0)), base + radius
    )  # reaches the base circle
    values = {"face": face, "second": None, **({} if hasattr(old, "arm_mm") else {"arm_mm": round(arm, 3)})}
    return replace(
        drive,
        mechanism=of_class(follower, old, **values),
        cam=of_class(cam, drive.cam, roller_radius_mm=radius, form=Open()),
        loads=of_class(loads, drive.loads),
    )


def _first_radius(drive: Drive) -> float:
    """Radius of a new roller or shoe [mm], rounded down to one digit."""
    extent = getattr(drive.cam, "base_radius_mm", 0.0)
    extent = max([extent, *(hypot(p.x_mm, p.y_mm) for link in drive.links for p in link.points)])
    size = FIRST_RADIUS * extent or 1.0
    unit = 10.0 ** floor(log10(size))
    return floor(size / unit) * unit


def _at_one_speed(design: Design, path: str) -> Design:
    """Linkage in which the shaft takes the edited speed of the driver, or the driver that of the shaft."""
    driver, shaft = design.drive.linkage.driver, design.camshaft
    if path == "linkage.driver.speed_rpm":
        rotation = "cw" if driver.speed_rpm < 0.0 else "ccw"
        return replace(design, shaft=replace(shaft, speed_rpm=abs(driver.speed_rpm), rotation=rotation))
    if path in ("shaft.speed_rpm", "shaft.rotation"):
        new_driver = replace(driver, speed_rpm=shaft.signed_rpm)
        return with_drive(design, mechanism=replace(design.drive.linkage, driver=new_driver))
    return design


def with_shaft(design: Design) -> Design:
    """Design of a linkage with a rigid shaft at the speed of its driver, without flywheel; its motor is assumed."""
    if design.shaft is not None:
        return design
    return with_guesses_marked(replace(design, shaft=Shaft("ccw" if design.sense > 0.0 else "cw", design.speed_rpm)))


def with_elastic(design: Design, elastic: ElasticShaft | None) -> Design:
    """Design with a flexible or a rigid shaft; a rigid one has no assumed elasticity."""
    assert design.shaft is not None
    removed = {f"shaft.{field.name}" for field in fields(ElasticShaft)} if elastic is None else set()
    assumed = tuple(path for path in design.assumed if path not in removed)
    return replace(design, shaft=replace(design.shaft, elastic=elastic), assumed=assumed)


# -- scaling of a machine -------------------------------------------------------------------------------------

LENGTHS: Mapping[Unit, int] = MappingProxyType({UNITS["mm"]: 1})
MASSES: Mapping[Unit, int] = MappingProxyType({UNITS["kg"]: 3, UNITS["kg_m2"]: 5})
"""Unit of a field -> power of the factor: lengths, and masses and inertias of similar parts of the same material."""


def rescaled(design: Design, factor: float, *, masses: bool = True) -> Design:
    """Design with every length multiplied by a factor, also in a motion in mm; angles stay.

    With ``masses`` the masses grow with the third power and the moments of inertia with the fifth, as for similar parts of
    the same material. Forces, torques, springs, stiffnesses, dampings, speeds and gravity stay; valve springs follow their
    dimensions. The products are those of the decimal numbers, rounded once: 1302.162 times 0.1 is 130.2162.

    Raises
    ------
    DesignError
        For a factor that is not positive.
    """
    if not factor > 0.0:
        raise DesignError([Fault("factor", factor, "cannot scale a machine", "> 0")])
    powers = {**LENGTHS, **(MASSES if masses else {})}
    from decimal import Decimal  # slow to import, and only needed here

    scaled: Design = _rescaled(design, Decimal(repr(float(factor))), powers)
    return scaled


def scale_text(design: Design, factor: float, masses: bool) -> str:
    """Effect of a scale on the values of a design, in two sentences, or three with valve springs."""
    weights = (
        f"masses × {result_text(factor**3)}, moments of inertia × {result_text(factor**5)}"
        if masses
        else "masses and moments of inertia stay"
    )
    stay = "Angles, speeds, forces, torques, springs (rates and preloads), stiffnesses and dampings stay as they are."
    text = f"Lengths × {result_text(factor)}, {weights}. {stay}"
    if any(getattr(drive.loads, "valve_springs", ()) for drive in design.drives):
        forces = f"rates × {result_text(factor)}, forces × {result_text(factor**2)}"
        text += f" Valve springs follow their dimensions: {forces}, and stresses stay."
    return text


def _rescaled(part: Any, factor: Decimal, powers: Mapping[Unit, int]) -> Any:
    if isinstance(part, tuple):
        return tuple(_rescaled(item, factor, powers) for item in part)
    if not is_dataclass(part):
        return part
    if isinstance(part, Motion):
        power = powers.get(UNITS[part.unit], 0)
        return with_levels(part, lambda level: _product(level, factor**power))
    values: dict[str, Any] = {}
    for item in fields(part):
        value, power = getattr(part, item.name), powers.get(unit_of(item), 0)
        values[item.name] = (
            _product(value, factor**power) if power and value is not None else _rescaled(value, factor, powers)
        )
    return replace(part, **values)  # type: ignore[type-var]


def _product(value: float, factor: Decimal) -> float:
    return float(type(factor)(repr(float(value))) * factor)
