"""Edits that keep a design whole: what one change asks of its neighbours is done in the same step.

Spans must make a turn and rises must come back to the start, so no single one of them can change alone.
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
from core.design.parts import (
    FOLLOWER_KINDS,
    SIDES,
    CamSlider,
    Curve,
    ElasticShaft,
    Motion,
    Oscillating,
    PolynomialCurve,
    PolynomialEnd,
    SecondArm,
    SecondPlace,
    Segment,
    Shaft,
    SplineCurve,
    SplinePoint,
    Translating,
    curve_of,
)
from core.design.paths import all_paths, of_class, put, row_at, with_guesses_marked
from core.errors import DesignError, Fault
from core.laws import find_law
from core.numerics.lazy import Column, column
from core.numerics.roots import two_sum
from core.units import UNITS, Unit

if TYPE_CHECKING:
    from decimal import Decimal

_EPS = float(np.finfo(float).eps)
_DECIMALS = 10  # a difference is kept to these: 283.3, not 283.29999999999995; far below what closing asks


def balance(total: float, given: Iterable[float]) -> float:
    """What is left of a total, without the last bits that binary numbers leave; nan where infinities meet. Of many designs a column."""
    given = list(given)
    if any(isinstance(number, Column) for number in (total, *given)):
        return _balances(total, given)
    try:
        return round(fsum([total, *(-number for number in given)]), _DECIMALS) + 0.0  # no minus zero
    except (OverflowError, ValueError):
        return nan


def _balances(total: Any, given: list[Any]) -> Any:
    """The same of many designs, to the last bit: where the decimals are a tie but for rounding, one by one."""
    high: Any = column(total)
    low: Any = 0.0
    for number in given:
        high, lost = two_sum(high, column(-number))
        low = low + lost
    scaled = (high + low) * 10.0**_DECIMALS
    rounded = np.rint(scaled)
    left = np.asarray(rounded / 10.0**_DECIMALS + 0.0)
    clear = (0.5 - np.abs(scaled - rounded) > 4.0 * _EPS * np.abs(scaled)) & (np.abs(scaled) < 2.0**50)
    for k in np.flatnonzero(~clear).tolist():
        own, *others = (float(np.broadcast_to(number, left.shape)[k]) for number in (total, *given))
        left[k] = balance(own, others)
    return column(left)


Kept = Collection[int]
"""Numbers of segments whose own value was typed, so that others come first to give or take a difference."""


def _others(motion: Motion, index: int, kept: Kept) -> list[int]:
    """The other segments from the next one on (cyclic), those that are kept behind the rest."""
    count = len(motion.segments)
    return sorted(((index + k) % count for k in range(1, count)), key=lambda i: i in kept)


def with_span(motion: Motion, index: int, span_deg: float, kept: Kept = ()) -> Motion:
    """One segment's span [deg] changed; the next segment (cyclic) gives or takes the difference."""
    others = _others(motion, index, kept)
    return with_spans(motion, {index: span_deg}, others[0] if others else index)


def with_spans(motion: Motion, spans: Mapping[int, float], other: int) -> Motion:
    """The spans [deg] of some segments changed; another one, where it is none of them, gives or takes the difference."""
    segments = [replace(s, span_deg=spans.get(i, s.span_deg)) for i, s in enumerate(motion.segments)]
    if other not in spans:
        left = balance(360.0, (s.span_deg for i, s in enumerate(segments) if i != other))
        segments[other] = replace(segments[other], span_deg=left)
    return replace(motion, segments=tuple(segments))


def with_rise(motion: Motion, index: int, rise: float, kept: Kept = ()) -> Motion:
    """One segment's rise changed; the next segment that moves (cyclic) brings the follower back."""
    segments = list(motion.segments)
    segments[index] = replace(segments[index], rise=rise)
    return replace(motion, segments=back_at_start(segments, _others(motion, index, kept), motion.gain))


def back_at_start(segments: list[Segment], order: Iterable[int], gain: float = 0.0) -> tuple[Segment, ...]:
    """The segments, closed: the first segment that moves, of those in ``order``, brings the follower back, or to what it gains
    in a turn."""
    for other in order:
        if not is_dwell(segments[other]):
            left = balance(gain, (s.rise for i, s in enumerate(segments) if i != other))
            segments[other] = replace(segments[other], rise=left)
            break
    return tuple(segments)


def stroke(motion: Motion) -> float:
    """Highest minus lowest level at the ends of segments, in the motion's unit."""
    levels = [fsum(s.rise for s in motion.segments[:i]) for i in range(len(motion.segments) + 1)]  # above the start
    return max(levels) - min(levels)


def with_stroke(motion: Motion, wanted: float, now: float | None = None) -> Motion:
    """All levels scaled so that the stroke becomes ``wanted``: start, rises, and what curves state of themselves. The
    level 0 stays where it is; now: the stroke of a motion whose curves leave the levels at their ends."""
    now = stroke(motion) if now is None else now
    if now == 0.0:
        return motion

    def level(value: float) -> float:
        # multiplied first: 150 of a stroke of 150 becomes 160 of 160, not 160.00000000000003
        return value * wanted / now

    return with_levels(motion, level)


def with_levels(motion: Motion, level: Scale) -> Motion:
    """All levels scaled by a linear function: start, rises, and what curves state of themselves."""
    segments = tuple(replace(s, rise=level(s.rise), curve=scaled(s.curve, 1.0, level)) for s in motion.segments)
    advance = None if motion.advance is None else level(motion.advance)
    return replace(motion, start=level(motion.start), segments=segments, advance=advance)


def with_advance(motion: Motion, advance: float | None) -> Motion:
    """Another advance of a turn; the last segment that moves takes the difference."""
    segments = back_at_start(list(motion.segments), range(len(motion.segments) - 1, -1, -1), advance or 0.0)
    return replace(motion, segments=segments, advance=advance)


def with_law(motion: Motion, index: int, law: str, kept: Kept = ()) -> Motion:
    """One segment's law changed; what becomes a dwell loses its rise to the next segment that moves."""
    segments = list(motion.segments)
    segments[index] = replace(segments[index], curve=curve_of(law))
    changed = replace(motion, segments=tuple(segments))
    row = find_law(law)
    return with_rise(changed, index, 0.0, kept) if row is not None and row.is_dwell else changed


def with_segment_inserted(motion: Motion, index: int, *, before: bool = False) -> Motion:
    """A dwell behind a segment, or before it, of half its span; no other join moves."""
    segments = list(motion.segments)
    whole = segments[index].span_deg
    segments[index] = replace(segments[index], span_deg=whole / 2.0)
    segments.insert(index if before else index + 1, Segment(whole - whole / 2.0, 0.0))
    return replace(motion, segments=tuple(segments))


def without_segment(motion: Motion, index: int, *, balanced: bool = True) -> Motion:
    """One segment less. Its span goes to the one before it (the first one's to the second), so that no other join moves;
    its rise goes to the next that moves, where the motion shall stay ``balanced``. The only segment stays."""
    segments = list(motion.segments)
    if len(segments) == 1:
        return motion
    removed = segments.pop(index)
    heir = max(index - 1, 0)
    segments[heir] = replace(segments[heir], span_deg=balance(segments[heir].span_deg, (-removed.span_deg,)))
    order = [(index + k) % len(segments) for k in range(len(segments))] if removed.rise and balanced else []
    return replace(motion, segments=back_at_start(segments, order, motion.gain))


def with_layout(follower: CamSlider, layout: str) -> CamSlider:
    """The layout changed; the pivot goes to the other side of the cam where the letter asks for it."""
    left = layout in "abef"
    side = abs(follower.pivot_x_mm) if left else -abs(follower.pivot_x_mm)
    return replace(follower, layout=layout, pivot_x_mm=side)


def is_dwell(segment: Segment) -> bool:
    """A dwell, whose levels at both ends are one."""
    law = find_law(segment.curve.law)
    return law is not None and law.is_dwell


# -- a curve made longer or higher: the same shape over another span, between other levels ------------------

Scale = Callable[[float], float]


def stretched(curve: Curve, span: float, height: float) -> Curve:
    """The curve of a segment whose span and rise are multiplied by these: the same shape, larger or smaller."""
    return scaled(curve, span, lambda value: value * height)


def scaled(curve: Curve, span: float, level: Scale) -> Curve:
    """The curve of a segment whose span is multiplied by ``span`` and whose levels are scaled by a linear function."""
    if isinstance(curve, PolynomialCurve):
        return PolynomialCurve(_end(curve.start, span, level), _end(curve.end, span, level))
    if isinstance(curve, SplineCurve):
        return replace(curve, points=tuple(_point(point, span, level) for point in curve.points))
    return curve


def times(value: float | None, by: float) -> float | None:
    """The product, where there is a value."""
    return None if value is None else value * by


def _over(value: float | None, level: Scale, span: float) -> float | None:
    return None if value is None else level(value) / span


def _end(end: PolynomialEnd, span: float, level: Scale) -> PolynomialEnd:
    return PolynomialEnd(level(end.velocity) / span, level(end.acceleration) / span**2, _over(end.jerk, level, span**3))


def _point(point: SplinePoint, span: float, level: Scale) -> SplinePoint:
    return SplinePoint(
        point.at_deg * span,
        _over(point.value, level, 1.0),
        _over(point.velocity, level, span),
        _over(point.acceleration, level, span**2),
    )


# -- edits by path ------------------------------------------------------------------------------------------

MOTION_EDITS: Mapping[str, Callable[[Motion, int, Any, Kept], Motion]] = MappingProxyType(
    {
        r"motion\.segments\[(\d+)\]\.span_deg": with_span,
        r"motion\.segments\[(\d+)\]\.rise(?:_mm|_deg)?": with_rise,
        r"motion\.segments\[(\d+)\]\.law": with_law,
        r"motion\.advance(?:_mm|_deg)?()": lambda motion, _, value, __: with_advance(motion, value),
        r"motion\.stroke(?:_mm|_deg)?()": lambda motion, _, value, __: with_stroke(motion, value),
    }
)
"""Paths of a motion (as patterns) that ask something of their neighbours; every other path is simply put."""


def motion_edited(motion: Motion | None, path: str, value: Any, kept: Kept = ()) -> Motion | None:
    """The motion with such a path changed; None where there is no motion, or the path is none of these."""
    for pattern, change in MOTION_EDITS.items():
        match = re.fullmatch(pattern, path)
        if match and motion is not None:
            return change(motion, int(match[1] or 0), value, kept)
    return None


def edited(design: Design, path: str, value: Any, kept: Kept = ()) -> Design:
    """The design with the value at a path changed and what goes with it. It may have faults: ask ``faults``."""
    if design.listed:
        return _edited_of_several(design, path, value)
    motion = motion_edited(design.drive.motion, path, value, kept)
    if motion is not None:
        return with_drive(design, motion=motion)
    if path == "follower.layout" and isinstance(design.drive.mechanism, CamSlider):
        return with_drive(design, mechanism=with_layout(design.drive.mechanism, value))
    if design.drive.cam is not None and path == design.drive.face_path:
        return with_face(design, value)
    if design.drive.cam is not None and path == f"cam.{FORM}":
        return with_form(design, value)
    changed = put(design, path, value)
    if changed.drive.is_linkage and changed.shaft is not None:
        return _at_one_speed(changed, path)
    return changed


def _edited_of_several(design: Design, path: str, value: Any) -> Design:
    """The same where the drives are listed: in a drive as in a design of it alone; a name changes in the timing too."""
    own = drive_at(path)
    if own is not None and own[0] < len(design.drives):
        return with_only(design, own[0], edited(only(design, own[0]), own[1], value))
    _, number, inside = row_at(path, "drives")
    if inside == "name" != path:
        return rename_drive(design, number, value)
    changed = put(design, path, value)
    return turning_together(changed) if path in ("shaft.speed_rpm", "shaft.rotation") else changed


FIRST_RADIUS = 0.2  # of a roller or a shoe that was none before: parts of the base radius


def with_face(design: Design, word: str) -> Design:
    """The design with another face on the cam: follower, cam and loads keep what they share with it; a radius goes from roller
    to shoe and back, and what is new is assumed. A face that slides has a friction, which is 0 to begin with. Raises DesignError for
    a face that it cannot have."""
    drive, old = design.drive, design.drive.face
    words = words_of(type(drive.cam if drive.is_linkage else drive.mechanism), FACE)
    if word not in words:
        raise DesignError([Fault(drive.face_path, word, "unknown word", " | ".join(words))])
    if word == old.face:
        return design
    size = old.radius_mm or _first_radius(drive)
    made = (_linkage_under if drive.is_linkage else _follower_under)(drive, word, size)
    rubbing = (drive.loads.contact or ContactFriction()) if made.face.slides else None
    changed = with_drive(design, mechanism=made.mechanism, cam=made.cam, loads=replace(made.loads, contact=rubbing))
    before, after = set(all_paths(design)), list(all_paths(changed))
    new = [path for path in after if path not in before and path.endswith("_mm") and ".face_" not in path]
    assumed = [*new, *(path for path in design.assumed if path in after)]
    return replace(changed, assumed=tuple(sorted(assumed, key=after.index)))


def with_form(design: Design, word: str) -> Design:
    """The design with a cam of another form; the second roller of a conjugate pair is as large as the first and stands where it
    pushes the other way, and what is new is assumed."""
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
        place = SECOND_PLACES[type(follower)](drive) if paired else None
        changed = with_drive(changed, mechanism=of_class(type(follower), follower, second=place))
    before, after = set(all_paths(design)), list(all_paths(changed))
    new = (path for path in after if path not in before and ".second." in path)
    return replace(changed, assumed=(*(path for path in design.assumed if path in after), *new))


def _second_roller(drive: Drive) -> SecondRoller:
    return SecondRoller(roller_radius_mm=drive.cam.roller_radius_mm)


def _second_on_link(drive: Drive) -> SecondLinkRoller:
    """At another point of the link that carries the first, where there is one."""
    cam: LinkageCam = drive.cam
    places = drive.linkage.by_number[cam.link].places if cam.link in drive.linkage.by_number else {}
    point = next((name for name in places if name != cam.point), cam.point)
    return SecondLinkRoller(link=cam.link, point=point, roller_radius_mm=cam.face.radius_mm)


def _angle_to_cam(drive: Drive, arm: float) -> float:
    """Of the arm from the ray to the cam centre, on the base circle [deg]; nan where arm, pivot and cam make no triangle."""
    follower: Any = drive.follower
    reach, pivot = (
        drive.cam.base_radius_mm + drive.cam.roller_radius_mm,
        hypot(follower.pivot_x_mm, follower.pivot_y_mm),
    )
    cosine = (arm * arm + pivot * pivot - reach * reach) / (2.0 * arm * pivot or nan)
    return degrees(acos(cosine)) if -1.0 <= cosine <= 1.0 else nan


def _swing(drive: Drive) -> float:
    """How far the arm swings [deg]; of a cam-slider, which its rod swings, a guess."""
    return stroke(drive.motion) if drive.motion is not None and drive.motion.unit == "deg" else SOME_SWING


def _second_arm(drive: Drive, arm: float, side: float) -> SecondArm:
    """On the other side of the ray to the cam centre, as near to the cam at the end of the stroke as the first is before it."""
    angle = round(-side * (2.0 * _angle_to_cam(drive, arm) + _swing(drive)), 2)
    return SecondArm(arm_mm=arm, angle_deg=angle if abs(angle) <= 360.0 else -side * 90.0)


def _beside_slider(drive: Drive) -> SecondArm:
    follower = drive.follower
    assert isinstance(follower, CamSlider)
    left = (follower.layout in "abef") == (
        follower.layout in "abcd"
    )  # the arm is turned clockwise from the ray to the cam
    return _second_arm(drive, follower.roller_arm_mm, -1.0 if left else 1.0)


def _beside_arm(drive: Drive) -> SecondArm:
    follower = drive.follower
    assert isinstance(follower, Oscillating)
    return _second_arm(drive, follower.arm_mm, SIDES[follower.side])


def _behind(drive: Drive) -> SecondPlace:
    """As far behind the cam centre at the end of the stroke as the first is before it at its start."""
    follower = drive.follower
    assert isinstance(follower, Translating)
    reach = drive.cam.base_radius_mm + drive.cam.roller_radius_mm
    start = sqrt(max(reach * reach - follower.offset_mm * follower.offset_mm, 0.0))
    return SecondPlace(distance_mm=round(2.0 * start + (stroke(drive.motion) if drive.motion else 0.0), 3))


SOME_SWING = 20.0
SECOND_PLACES: Mapping[type, Callable[[Drive], SecondArm | SecondPlace]] = MappingProxyType(
    {CamSlider: _beside_slider, Oscillating: _beside_arm, Translating: _behind}
)
"""Follower -> where the second roller of a conjugate pair stands to begin with."""


def _linkage_under(drive: Drive, word: str, radius: float) -> Drive:
    face = of_class(words_of(type(drive.cam), FACE)[word], roller_radius_mm=radius, shoe_radius_mm=radius)
    return replace(drive, cam=replace(drive.cam, face=face, form=Open()))


def _follower_under(drive: Drive, word: str, radius: float) -> Drive:
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
    """Of a roller or a shoe where there was none [mm], of one digit."""
    extent = getattr(drive.cam, "base_radius_mm", 0.0)
    extent = max([extent, *(hypot(p.x_mm, p.y_mm) for link in drive.links for p in link.points)])
    size = FIRST_RADIUS * extent or 1.0
    unit = 10.0 ** floor(log10(size))
    return floor(size / unit) * unit


def _at_one_speed(design: Design, path: str) -> Design:
    """A linkage whose shaft and driver turn alike, as the one of them says that has been edited."""
    driver, shaft = design.drive.linkage.driver, design.camshaft
    if path == "linkage.driver.speed_rpm":
        rotation = "cw" if driver.speed_rpm < 0.0 else "ccw"
        return replace(design, shaft=replace(shaft, speed_rpm=abs(driver.speed_rpm), rotation=rotation))
    if path in ("shaft.speed_rpm", "shaft.rotation"):
        turning = replace(driver, speed_rpm=shaft.signed_rpm)
        return with_drive(design, mechanism=replace(design.drive.linkage, driver=turning))
    return design


def with_shaft(design: Design) -> Design:
    """The design of a linkage with a shaft that turns as its driver does, without flywheel and rigid; its motor is a guess."""
    if design.shaft is not None:
        return design
    return with_guesses_marked(replace(design, shaft=Shaft("ccw" if design.sense > 0.0 else "cw", design.speed_rpm)))


def with_elastic(design: Design, elastic: ElasticShaft | None) -> Design:
    """The design with a flexible shaft, or with a rigid one: then nothing is assumed of its elasticity any more."""
    assert design.shaft is not None
    dropped = {f"shaft.{field.name}" for field in fields(ElasticShaft)} if elastic is None else set()
    assumed = tuple(path for path in design.assumed if path not in dropped)
    return replace(design, shaft=replace(design.shaft, elastic=elastic), assumed=assumed)


# -- a machine of another size --------------------------------------------------------------------------------

LENGTHS: Mapping[Unit, int] = MappingProxyType({UNITS["mm"]: 1})
MASSES: Mapping[Unit, int] = MappingProxyType({UNITS["kg"]: 3, UNITS["kg_m2"]: 5})
"""Unit of a field -> the power of the factor by which it grows: lengths, and what parts of the same shape and material weigh."""


def rescaled(design: Design, factor: float, *, masses: bool = True) -> Design:
    """The design with every length times ``factor``, those of a motion that counts in mm among them; angles stay.

    masses: masses grow by the third power, moments of inertia by the fifth, as those of similar parts of the same material do; else
    they stay. What is chosen from a catalogue or given by the process stays in any case: forces and torques, rates and preloads of
    springs, stiffnesses, dampings, speeds, gravity. The products are those of the decimal numbers, rounded once: 1302.162 by 0.1 is
    130.2162. Raises DesignError for a factor that is not above 0.
    """
    if not factor > 0.0:
        raise DesignError([Fault("factor", factor, "cannot scale a machine", "> 0")])
    powers = {**LENGTHS, **(MASSES if masses else {})}
    from decimal import Decimal  # slow to import, and only this asks for it

    scaled: Design = _rescaled(design, Decimal(repr(float(factor))), powers)
    return scaled


def scale_text(factor: float, masses: bool) -> str:
    """What such a scale does to the values of a design, in two sentences."""
    weights = (
        f"masses × {factor**3:.6g}, moments of inertia × {factor**5:.6g}"
        if masses
        else "masses and moments of inertia stay"
    )
    stay = "Angles, speeds, forces, torques, springs (rates and preloads), stiffnesses and dampings stay as they are."
    return f"Lengths × {factor:.6g}, {weights}. {stay}"


def _rescaled(part: Any, factor: Decimal, powers: Mapping[Unit, int]) -> Any:
    if isinstance(part, tuple):
        return tuple(_rescaled(each, factor, powers) for each in part)
    if not is_dataclass(part):
        return part
    if isinstance(part, Motion):
        power = powers.get(UNITS[part.unit], 0)
        return with_levels(part, lambda level: _product(level, factor**power))
    values: dict[str, Any] = {}
    for each in fields(part):
        value, power = getattr(part, each.name), powers.get(unit_of(each), 0)
        values[each.name] = (
            _product(value, factor**power) if power and value is not None else _rescaled(value, factor, powers)
        )
    return replace(part, **values)  # type: ignore[type-var]


def _product(value: float, factor: Decimal) -> float:
    return float(type(factor)(repr(float(value))) * factor)
