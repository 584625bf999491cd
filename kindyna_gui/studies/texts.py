"""Names and units of what is varied and asked, as the dock shows them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from types import MappingProxyType

from core.design import Design, Info, Unit, drive_at, entries, row_at, split_unit
from core.study import TOTALS, quantity
from core.study.batches.asked import asked_of
from core.varying import Corner, Share
from kindyna_gui import labels
from kindyna_gui.labels import SECTION_NAMES, in_sentence, sentence
from kindyna_gui.look import WRONG
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short, with_unit
from kindyna_gui.studies.plots import Measured

OF: Mapping[str, str] = MappingProxyType(
    {"abs": "peak", "max": "greatest", "min": "least", "rms": "RMS", "mean": "mean", "range": "range"}
)
"""What can be asked of a quantity over the turn."""

_TOTALS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "flywheel_inertia_kg_m2": ("Flywheel needed", "torque"),
        "energy_j": ("Energy of the flywheel", "energy"),
        "life_hours": ("Life of the roller", "stress"),
    }
)
_STAGES: Mapping[str, str] = MappingProxyType(
    {"motion": "Motion", "linkage": "Mechanism", "cam": "Cam", "dynamics": "Forces", "stability": "Flexible shaft"}
)
WHOLE_TURN = "Whole turn"
_REASONS: Mapping[str, str] = MappingProxyType(
    {
        "no-assembly": "the links do not reach: it cannot be assembled over the whole turn",
        "undercut": "the profile is undercut",
        "out-of-range": "a number lies outside the range of its field",
        "no-value": "it has no such value",
        "no-cam": "no cam moves the follower so",
    }
)


def reason_text(code: str) -> str:
    """Why a design cannot be built, or has no value."""
    return sentence(_REASONS.get(code, code.replace("-", " ")))


def info_of(design: Design, path: str) -> tuple[Info, Unit]:
    """Range and unit of a number of the design."""
    for name in design.tables:
        for each in entries(design, name):
            if each.path == path:
                return each.info, each.unit
    raise KeyError(path)


def name_of(design: Design, path: str) -> str:
    """Of a number, with the drive that it is of."""
    _, number, inside = row_at(path, "drives")
    if inside == path or drive_at(path) is not None:
        return labels.name_of(design, path)
    return f"{design.drives[number].name}: {in_sentence(labels.name_of(design, path))}"


def span_title(design: Design, path: str) -> str:
    """Of an axis: ``Pivot x, mm``."""
    unit = split_unit(path)[1].symbol
    return f"{name_of(design, path)}, {unit}" if unit else name_of(design, path)


def section_of(design: Design, path: str) -> str:
    """Under which numbers are offered: the part of the design that they belong to."""
    own = drive_at(path)
    if own is not None and own[0] < len(design.drives):
        inside = SECTION_NAMES.get(own[1].partition(".")[0], "")
        return f"{design.drives[own[0]].name}{f': {in_sentence(inside)}' if inside else ''}"
    top = path.partition(".")[0]
    return SECTION_NAMES.get(top, sentence(top.partition("[")[0]))


def group_of(design: Design, slug: str) -> str:
    """Under which quantities are offered."""
    if slug in TOTALS:
        return WHOLE_TURN
    asked = asked_of(design, f"{slug}:max")
    if not asked.name:
        return WHOLE_TURN
    stage = _STAGES[quantity(asked.name).stage]
    return stage if asked.drive is None else f"{design.drives[asked.drive].name}: {in_sentence(stage)}"


def label_of(design: Design, slug: str) -> str:
    """A quantity without what is asked of it."""
    if slug in _TOTALS:
        return _TOTALS[slug][0]
    asked = asked_of(design, f"{slug}:max")
    label = quantity(asked.name).label if asked.name else "Torque of the shaft"
    return label if asked.drive is None else f"{design.drives[asked.drive].name}: {in_sentence(label)}"


def unit_of(key: str) -> Unit:
    """Of what is asked."""
    return split_unit(key.partition(":")[0])[1]


def measured(design: Design, key: str, least: float | None, most: float | None) -> Measured:
    """What is asked, as plots show it."""
    slug, _, of = key.partition(":")
    asked = asked_of(design, key)
    family = _TOTALS[slug][1] if slug in _TOTALS else quantity(asked.name).family if asked.name else "torque"
    name = label_of(design, slug) + (f", {OF[of]}" if of and of != "abs" else "")
    return Measured(key, name, unit_of(key).symbol, _visible(SCREEN.family(family)), least, most)


def _visible(colour: str) -> str:
    """A map in ink would hide its lines."""
    return SCREEN.quiet if colour == SCREEN.ink else colour


def value_text(key: str, value: float) -> str:
    """A value with its unit, none where there is none."""
    return with_unit(short(value, 5), unit_of(key).symbol) if value == value else "none"


def number_text(path: str, value: float) -> str:
    """A number of the design with its unit."""
    return with_unit(short(value, 6), split_unit(path)[1].symbol)


def share_html(design: Design, share: Share, corners: Sequence[Corner]) -> str:
    """How many machines keep the limits, and what each limit has in the worst case."""
    low, high = (100.0 * each for each in share.interval)
    count = f"{share.machines:,}".replace(",", "\u202f")
    lines = [f"<b>{100.0 * share.value:.2f} % of {count} machines keep the limits</b> ({low:.2f} … {high:.2f} %)"]
    for each in corners:
        slug = each.limit.key.partition(":")[0]
        text = "cannot be built" if each.value is None else value_text(each.limit.key, each.value)
        style = "" if each.within else f" style='color:{WRONG}'"
        lines.append(f"<span{style}>Worst case: {escape(in_sentence(label_of(design, slug)))} {escape(text)}</span>")
    return "<br>".join(lines)
