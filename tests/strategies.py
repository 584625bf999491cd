"""Random designs for hypothesis, drawn from the metadata of the fields."""

import math
from dataclasses import fields, replace
from typing import Any

from hypothesis import strategies as st

from core.design import (
    FOLLOWER_KINDS,
    CamSlider,
    Design,
    Drive,
    FollowerKind,
    Info,
    Motion,
    Named,
    Segment,
    Shaft,
    SingleCam,
    entries,
    info_of,
)
from core.design.paths import SECTIONS
from core.laws import LAWS


def values(info: Info) -> st.SearchStrategy[Any]:
    """All that a field admits."""
    if info.choices:
        return st.sampled_from(info.choices)
    low = None if info.low == -math.inf else info.low
    high = None if info.high == math.inf else info.high
    return st.floats(low, high, exclude_min=info.open_low, allow_nan=False, allow_infinity=False)


def parts(part: type) -> st.SearchStrategy[Any]:
    """A part of a design, each field within its range; a layout fits its pivot."""
    drawn = st.builds(part, **{f.name: values(info) for f in fields(part) if (info := info_of(f))})
    return drawn.filter(lambda p: p.pivot_x_mm != 0.0).map(_fitting) if part is CamSlider else drawn


def _fitting(follower: CamSlider) -> CamSlider:
    x = abs(follower.pivot_x_mm)
    return replace(follower, pivot_x_mm=x if follower.layout in "abef" else -x)


EITHER_WAY = tuple(slug for slug, law in LAWS.items() if law.rises == 0)
"""Laws for a rise and for a return."""


@st.composite
def motions(draw: st.DrawFn, unit: str = "mm") -> Motion:
    """One to eight segments that make one turn and come back."""
    weights = draw(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=8))
    spans = [360.0 * w / math.fsum(weights) for w in weights[1:]]
    spans.insert(0, 360.0 - math.fsum(spans))
    laws = [draw(st.sampled_from(EITHER_WAY)) for _ in spans]
    rises = [0.0 if LAWS[law].still else draw(st.floats(-1e6, 1e6)) for law in laws]
    if rises and any(rises):
        last = max(i for i, law in enumerate(laws) if not LAWS[law].still)
        rises[last] = -math.fsum(rises[:last] + rises[last + 1 :])
    segments = (Segment(*each[:2], Named(each[2])) for each in zip(spans, rises, laws, strict=True))
    return Motion(draw(st.floats(-1e9, 1e9)), tuple(segments), unit)


@st.composite
def designs(draw: st.DrawFn) -> Design:
    """A valid design of any kind, with any name and any of its entries assumed."""
    row: FollowerKind = draw(st.sampled_from(tuple(FOLLOWER_KINDS.values())))
    drive = Drive(
        draw(motions(row.motion_unit)),
        draw(parts(row.follower)),
        draw(parts(row.cam)),
        draw(parts(row.loads)),
    )
    name = draw(st.text(st.characters(exclude_categories=["Cs"]), min_size=1).filter(str.strip))
    design = SingleCam(name, draw(parts(Shaft)), drive)
    paths = [entry.path for section in SECTIONS for entry in entries(design, section)]
    return replace(design, assumed=tuple(draw(st.lists(st.sampled_from(paths), unique=True, max_size=5))))
