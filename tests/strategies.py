"""Random designs for hypothesis, drawn from the metadata of the fields."""

import math
from dataclasses import fields, replace
from typing import Any

from hypothesis import strategies as st

from core.design import (
    FOLLOWER_KINDS,
    SECTIONS,
    CamSlider,
    Conjugate,
    ContactFriction,
    Curve,
    Design,
    Drive,
    ElasticShaft,
    FollowerKind,
    Info,
    Motion,
    NamedCurve,
    PolynomialCurve,
    PolynomialEnd,
    Pushrod,
    SccaCurve,
    SecondArm,
    SecondPlace,
    SecondRoller,
    Segment,
    Shaft,
    SplineCurve,
    SplinePoint,
    TableCurve,
    Translating,
    entries,
    info_of,
)
from core.design.fields import words_of
from core.design.followers import FORM, CamDetails
from core.laws import LAWS


def values(info: Info) -> st.SearchStrategy[Any]:
    """All that a field admits."""
    if info.choices:
        return st.sampled_from(info.choices)
    low = None if info.low == -math.inf else info.low
    high = None if info.high == math.inf else info.high
    numbers = st.floats(
        low, high, exclude_min=info.open_low, exclude_max=info.open_high, allow_nan=False, allow_infinity=False
    )
    return st.none() | numbers if info.optional else numbers


def parts(part: type) -> st.SearchStrategy[Any]:
    """A part of a design, each field within its range; a layout fits its pivot."""
    drawn = st.builds(part, **{f.name: values(info) for f in fields(part) if (info := info_of(f))})
    if part is CamSlider:
        return drawn.filter(lambda p: p.pivot_x_mm != 0.0).map(_fitting)
    return drawn.map(_bored) if issubclass(part, CamDetails) else drawn


def _bored(cam: Any) -> Any:
    """A hub wider than the bore, and a keyway narrower."""
    if cam.bore_mm is None:
        return cam
    return replace(
        cam,
        hub_mm=None if cam.hub_mm is None or cam.hub_mm <= cam.bore_mm else cam.hub_mm,
        keyway_width_mm=None
        if cam.keyway_width_mm is None or cam.keyway_width_mm >= cam.bore_mm
        else cam.keyway_width_mm,
    )


@st.composite
def formed(draw: st.DrawFn, drive: Drive) -> Drive:
    """The drive with a cam of any form that its face allows, and the second roller of a conjugate pair."""
    forms = words_of(type(drive.cam), FORM)
    kind = forms[draw(st.sampled_from(tuple(forms)))]
    roller = {"second": draw(parts(SecondRoller))} if kind is Conjugate else {}
    place = (
        {"second": draw(parts(SecondPlace if isinstance(drive.mechanism, Translating | Pushrod) else SecondArm))}
        if roller
        else {}
    )
    form = kind(play_mm=draw(st.floats(0.0, 1e9)), **roller) if roller else draw(parts(kind))
    thickness, depth = drive.cam.thickness_mm, getattr(form, "groove_depth_mm", None)
    if depth is not None and thickness is not None and depth >= thickness:
        form = replace(form, groove_depth_mm=None)
    return replace(drive, cam=replace(drive.cam, form=form), mechanism=replace(drive.mechanism, **place))


def _fitting(follower: CamSlider) -> CamSlider:
    x = abs(follower.pivot_x_mm)
    return replace(follower, pivot_x_mm=x if follower.layout in "abef" else -x)


def optional(low: float, high: float) -> st.SearchStrategy[float | None]:
    return st.one_of(st.none(), st.floats(low, high))


@st.composite
def curves(draw: st.DrawFn, span: float) -> Curve:
    """A curve of any kind that may rise as well as return."""
    kind = draw(st.sampled_from((NamedCurve, SccaCurve, PolynomialCurve, SplineCurve, TableCurve)))
    if kind is NamedCurve:
        law = LAWS[draw(st.sampled_from(EITHER_WAY))]
        return NamedCurve(law.slug, draw(values(info_of(CROSSOVER))) if law.is_symmetric else 0.5)
    if kind is SccaCurve:
        ramp = draw(st.floats(0.0, 1.0))
        return SccaCurve(draw(st.floats(0.0, 0.99)), ramp, draw(st.floats(0.0, 1.0 - ramp)))
    if kind is PolynomialCurve:
        ends = st.builds(PolynomialEnd, st.floats(-1e6, 1e6), st.floats(-1e6, 1e6), optional(-1e6, 1e6))
        return PolynomialCurve(draw(ends), draw(ends))
    places = draw(st.lists(st.floats(0.0, span), max_size=5, unique=True))
    if kind is TableCurve:
        rows = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=3)
        return TableCurve(tuple(SplinePoint(at, *draw(rows)) for at in places))
    wanted = st.tuples(*(optional(-1e6, 1e6) for _ in range(3))).filter(lambda w: any(v is not None for v in w))
    return SplineCurve(tuple(SplinePoint(at, *draw(wanted)) for at in places))


CROSSOVER = next(f for f in fields(NamedCurve) if f.name == "crossover")
EITHER_WAY = tuple(slug for slug, law in LAWS.items() if law.rises == 0)
"""Laws for a rise and for a return."""


@st.composite
def motions(draw: st.DrawFn, unit: str = "mm", named: bool = True) -> Motion:
    """One to eight segments that make one turn and come back; of named laws alone, or of any kind of curve."""
    weights = draw(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=8))
    spans = [360.0 * w / math.fsum(weights) for w in weights[1:]]
    spans.insert(0, 360.0 - math.fsum(spans))
    shapes = [NamedCurve(draw(st.sampled_from(EITHER_WAY))) if named else draw(curves(span)) for span in spans]
    still = [isinstance(shape, NamedCurve) and LAWS[shape.law].is_dwell for shape in shapes]
    rises = [0.0 if rests else draw(st.floats(-1e6, 1e6)) for rests in still]
    if any(rises):
        last = max(i for i, rests in enumerate(still) if not rests)
        rises[last] = -math.fsum(rises[:last] + rises[last + 1 :])
    segments = (Segment(*each) for each in zip(spans, rises, shapes, strict=True))
    return Motion(draw(st.floats(-1e9, 1e9)), tuple(segments), unit)


@st.composite
def designs(draw: st.DrawFn) -> Design:
    """A valid design of any kind, with any name and any of its entries assumed."""
    row: FollowerKind = draw(st.sampled_from(tuple(FOLLOWER_KINDS.values())))
    word = draw(st.sampled_from(tuple(row.faces)))
    follower, cam, loads = row.under(word)
    drive = Drive(
        draw(motions(row.motion_unit, named=False)),
        replace(draw(parts(follower)), face=draw(parts(row.faces[word]))),
        draw(parts(cam)),
        draw(parts(loads)),
    )
    if drive.face.slides:
        drive = replace(drive, loads=replace(drive.loads, contact=draw(parts(ContactFriction))))
    drive = draw(formed(drive))
    name = draw(st.text(st.characters(exclude_categories=["Cs"]), min_size=1).filter(str.strip))
    shaft = replace(draw(parts(Shaft)), elastic=draw(st.none() | parts(ElasticShaft)))
    design = Design(name, shaft, (drive,))
    paths = [entry.path for section in SECTIONS for entry in entries(design, section)]
    return replace(design, assumed=tuple(draw(st.lists(st.sampled_from(paths), unique=True, max_size=5))))
