"""Names and units of what is varied and asked, as the dock shows them."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from types import MappingProxyType

from core.design import Design, Info, Unit, drive_at, entry_at, row_at, split_unit
from core.laws import LAWS
from core.study import TOTALS, quantity
from core.study.quantity_requests import quantity_request
from core.varying import Optimum, StudyOfMany, ToleranceResult
from core.varying.tolerances import SHARE
from kindyna_gui import labels
from kindyna_gui.labels import SECTION_NAMES, in_sentence, sentence, thousands
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
        "design-fault": "these values do not go together in a design",
        "no-value": "it has no such value",
        "no-cam": "no cam moves the follower so",
    }
)


def reason_text(code: str) -> str:
    """Why a design cannot be built, or has no value."""
    return sentence(_REASONS.get(code, code.replace("-", " ")))


def info_of(design: Design, path: str) -> tuple[Info, Unit]:
    """Range and unit of a number of the design."""
    entry = entry_at(design, path)
    if entry is None:
        raise KeyError(path)
    return entry.info, entry.unit


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
    asked = quantity_request(design, f"{slug}:max")
    if not asked.name:
        return WHOLE_TURN
    stage = _STAGES[quantity(asked.name).stage]
    return stage if asked.drive is None else f"{design.drives[asked.drive].name}: {in_sentence(stage)}"


def label_of(design: Design, slug: str) -> str:
    """A quantity without what is asked of it."""
    if slug in _TOTALS:
        return _TOTALS[slug][0]
    asked = quantity_request(design, f"{slug}:max")
    label = quantity(asked.name).label if asked.name else "Torque of the shaft"
    return label if asked.drive is None else f"{design.drives[asked.drive].name}: {in_sentence(label)}"


def unit_of(key: str) -> Unit:
    """Of what is asked."""
    return split_unit(key.partition(":")[0])[1]


def measured(design: Design, key: str, least: float | None, most: float | None) -> Measured:
    """What is asked, as plots show it."""
    slug, _, of = key.partition(":")
    asked = quantity_request(design, key)
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


def word_text(word: str) -> str:
    """A law, or another word of a choice, as forms show it."""
    return labels.law_label(word) if word in LAWS else labels.choice_text(word)


def column_text(design: Design, column: str) -> str:
    """Of what holds an answer: a field, or a quantity with what is asked of it, as columns of tables name it."""
    slug, _, of = column.rpartition("_")
    if of in OF and slug and not column.endswith(("_kg_m2", "_j", "_hours")):
        return label_of(design, slug) + (f", {OF[of]}" if of != "abs" else "")
    return label_of(design, column) if column in TOTALS else name_of(design, column)


def share_html(design: Design, made: ToleranceResult) -> str:
    """How many machines keep the limits, and what each limit has in the worst case."""
    share = made.share
    assert share is not None, "of limits"
    low, high = (100.0 * each for each in share.interval)
    lines = [
        f"<b>{100.0 * share.value:.2f} % of {thousands(share.machines)} machines keep the limits</b> ({low:.2f} … {high:.2f} %)"
    ]
    for each in made.corners:
        slug = each.limit.key.partition(":")[0]
        text = "cannot be built" if each.value is None else value_text(each.limit.key, each.value)
        style = "" if each.within else f" style='color:{SCREEN.limit}'"
        lines.append(f"<span{style}>Worst case: {escape(in_sentence(label_of(design, slug)))} {escape(text)}</span>")
    return "<br>".join(lines)


def tighter_html(design: Design, made: ToleranceResult) -> str:
    """Which tolerances to tighten."""
    if made.tighter is None:
        return f"No tolerances that are halved twice at most bring {100.0 * SHARE:.2f} % of machines within the limits."
    names = [f"{escape(name_of(design, path))} to 1/{2**times}" for path, times in made.tighter.halved.items()]
    cost = f", cost {short(made.tighter.cost, 3)}" if any(row.cost is not None for row in design.tolerances) else ""
    return f"<b>Tighten {', '.join(names)}</b>: {100.0 * made.tighter.share.value:.2f} % keep the limits{cost}"


def parts_html(design: Design, made: ToleranceResult) -> str:
    """How much of what each quantity scatters comes from which number, and how the quantity depends on that."""
    rows = []
    for key, fields in made.parts.items():
        slug, _, of = key.partition(":")
        name = label_of(design, slug) + (f", {OF[of]}" if of and of != "abs" else "")
        rows.append(f"<tr><td colspan=3><b>{escape(name)}</b></td></tr>")
        for path, (slope, part) in fields.items():
            own, unit = unit_of(key).symbol, split_unit(path)[1].symbol
            each = with_unit(short(slope, 3), f"{own}/{unit}" if unit else own) if slope == slope else "none"
            rows.append(
                f"<tr><td>{escape(name_of(design, path))}</td><td align=right>{100.0 * part:.1f} %</td>"
                f"<td align=right>{escape(each)}</td></tr>"
            )
    return f"<table width='100%' cellspacing=1>{''.join(rows)}</table>"


def answer_html(design: Design, study: StudyOfMany, found: Optimum) -> str:
    """What a search for the best design has found, what holds it there, and how far that can be trusted."""
    lines = []
    for goal in study.file.goals:
        now, before = found.goals[goal.key], found.before[goal.key]
        change = (
            f" ({100.0 * (now / before - 1.0):+.1f} %)".replace("-", "−")
            if before and before == before and now == now
            else ""
        )
        name = escape(label_of(design, goal.quantity))
        lines.append(
            f"<b>{name} {escape(value_text(goal.key, now))}</b>, before {escape(value_text(goal.key, before))}{change}"
        )
    if not found.is_feasible:
        lines.insert(
            0, f"<span style='color:{SCREEN.limit}'>No design keeps the limits; this one misses them least.</span>"
        )
    elif not found.is_better:
        lines.insert(0, "Nothing better was found: the design stays as it is.")
    first = study.file.goals[0]
    unit = unit_of(first.key).symbol
    lines += [
        f"Held by {escape(in_sentence(column_text(design, each.limit)))}: 1 % more changes it by "
        f"{escape(with_unit(short(each.per_percent, 3), unit))}"
        for each in found.binding
    ]
    lines += [
        f"{escape(name_of(design, path))} {escape(word_text(value))}"
        for path, value in found.answer.items()
        if isinstance(value, str)
    ]
    lines += [
        f"{escape(name_of(design, path))} becomes {escape(number_text(path, value))}"
        for path, value in found.also_set.items()
    ]
    if found.share is not None:
        low = 100.0 * found.share.interval[0]
        lines.append(
            f"{100.0 * found.share.value:.2f} % of {thousands(found.share.machines)} machines keep the limits, {low:.2f} % at least"
        )
    if found.is_better and found.starts > 1:
        lines.append(f"{found.agreeing} of {found.starts} starts met there.")
    if found.front:
        lines.append(f"{len(found.front)} designs none of which is worse in both goals: a click on one takes it over.")
    if found.rejection:
        lines.append(f"A better one was refused: {escape(found.rejection)}")
    return "<br>".join(lines)
