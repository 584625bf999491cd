"""Names, units and result texts of the study dock."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from types import MappingProxyType

from core.design import Design, Info, Unit, drive_at, entry_at, get, split_unit
from core.design.fields import in_sentence
from core.laws import LAWS
from core.number_text import COMPARED_DIGITS, MOST_DIGITS, count_text
from core.study import TOTALS, quantity
from core.study.quantity_requests import quantity_request
from core.varying import Optimum, StudyOfMany, ToleranceResult
from core.varying.tolerances import SHARE
from kindyna_gui import labels
from kindyna_gui.documents.figures import TOTAL_TEXTS, column_text, figure_label, is_field, label_of, name_of
from kindyna_gui.labels import SECTION_NAMES, sentence
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import brief, number, short, signed, with_unit
from kindyna_gui.studies.plots import SurveyQuantity

_STAGES: Mapping[str, str] = MappingProxyType(
    {"motion": "Motion", "linkage": "Mechanism", "cam": "Cam", "dynamics": "Forces", "stability": "Flexible shaft"}
)
FULL_TURN = "Full turn"
_REASONS: Mapping[str, str] = MappingProxyType(
    {
        "no-assembly": "the design cannot be assembled over the full turn: the links are too short or too long",
        "undercut": "the profile is undercut",
        "out-of-range": "a number is outside the range of its field",
        "spans": "the varied spans leave nothing to the other segments",
        "design-fault": "these values cannot be combined in a design",
        "no-value": "this quantity has no value",
        "no-cam": "no cam can produce this motion",
    }
)


def reason_text(code: str) -> str:
    """Return the reason why a design cannot be built, or has no value."""
    return sentence(_REASONS.get(code, code.replace("-", " ")))


def info_of(design: Design, path: str) -> tuple[Info, Unit]:
    """Return range and unit of a number of the design."""
    entry = entry_at(design, path)
    if entry is None:
        raise KeyError(path)
    return entry.info, entry.unit


def span_title(design: Design, path: str) -> str:
    """Return the title of an axis: ``Pivot x, mm``."""
    unit = split_unit(path)[1].symbol
    return f"{name_of(design, path)}, {unit}" if unit else name_of(design, path)


def section_of(design: Design, path: str) -> str:
    """Return the submenu of a number: the section of the design that it belongs to."""
    position = drive_at(path)
    if position is not None and position[0] < len(design.drives):
        inside = SECTION_NAMES.get(position[1].partition(".")[0], "")
        return f"{design.drives[position[0]].name}{f': {in_sentence(inside)}' if inside else ''}"
    top = path.partition(".")[0]
    return SECTION_NAMES.get(top, sentence(top.partition("[")[0]))


def group_of(design: Design, slug: str) -> str:
    """Return the submenu of a quantity."""
    if slug in TOTALS:
        return FULL_TURN
    request = quantity_request(design, f"{slug}:max")
    if not request.name:
        return FULL_TURN
    stage = _STAGES[quantity(request.name).stage]
    return stage if request.drive is None else f"{design.drives[request.drive].name}: {in_sentence(stage)}"


def unit_of(key: str) -> Unit:
    """Return the unit of a figure."""
    return split_unit(key.partition(":")[0])[1]


def survey_quantity(design: Design, key: str, least: float | None, most: float | None) -> SurveyQuantity:
    """Return a figure, or a number that is a goal, with its limits as plots show it."""
    slug = key.partition(":")[0]
    if is_field(key):
        return SurveyQuantity(key, figure_label(design, key), unit_of(key).symbol, SCREEN.quiet, least, most)
    name = quantity_request(design, key).name
    family = TOTAL_TEXTS[slug][1] if slug in TOTAL_TEXTS else quantity(name).family if name else "torque"
    colour = SCREEN.family(family)
    if colour == SCREEN.ink:  # would hide the lines of a map
        colour = SCREEN.quiet
    return SurveyQuantity(key, figure_label(design, key), unit_of(key).symbol, colour, least, most)


def value_text(key: str, value: float) -> str:
    """Return a value with its unit, or "none"."""
    return brief(value, unit_of(key).symbol, COMPARED_DIGITS) if value == value else "none"


def number_text(path: str, value: float) -> str:
    """Return a number of the design with its unit."""
    return brief(value, split_unit(path)[1].symbol, MOST_DIGITS)


def word_text(word: str) -> str:
    """Return the name of a law, or of another choice, as forms show it."""
    return labels.law_label(word) if word in LAWS else labels.choice_text(word)


def share_html(design: Design, result: ToleranceResult) -> str:
    """Return the share of machines that keep the limits, and the worst case of each limit."""
    share = result.share
    assert share is not None, "there are limits"
    low, high = (100.0 * bound for bound in share.interval)
    lines = [
        f"<b>{number(100.0 * share.value, 2)} % of {count_text(share.machines)} machines keep the limits</b> "
        f"({number(low, 2)} … {number(high, 2)} %)"
    ]
    for corner in result.corners:
        slug = corner.limit.key.partition(":")[0]
        text = "cannot be built" if corner.value is None else value_text(corner.limit.key, corner.value)
        style = "" if corner.within else f" style='color:{SCREEN.limit}'"
        lines.append(f"<span{style}>Worst case: {escape(in_sentence(label_of(design, slug)))} {escape(text)}</span>")
    return "<br>".join(lines)


def tighter_html(design: Design, result: ToleranceResult) -> str:
    """Return which tolerances to tighten."""
    tighter = result.tighter
    if tighter is None:
        return f"Halving tolerances twice does not bring {number(100.0 * SHARE, 2)} % of machines within the limits."
    names = [f"{escape(name_of(design, path))} to 1/{2**times}" for path, times in tighter.halved.items()]
    cost = f", cost {short(tighter.cost, 3)}" if any(row.cost is not None for row in design.tolerances) else ""
    return f"<b>Tighten {', '.join(names)}</b>: {number(100.0 * tighter.share.value, 2)} % keep the limits{cost}"


def parts_html(design: Design, result: ToleranceResult) -> str:
    """Return a table: part of the variance of each figure that a number causes, and change of the figure per unit."""
    rows = []
    for key, fields in result.parts.items():
        rows.append(f"<tr><td colspan=3><b>{escape(figure_label(design, key))}</b></td></tr>")
        for path, (slope, part) in fields.items():
            figure_unit, unit = unit_of(key).symbol, split_unit(path)[1].symbol
            slope_unit = f"{figure_unit}/{unit}" if unit else figure_unit
            slope_text = with_unit(short(slope, 3), slope_unit) if slope == slope else "none"
            rows.append(
                f"<tr><td>{escape(name_of(design, path))}</td><td align=right>{number(100.0 * part, 1)} %</td>"
                f"<td align=right>{escape(slope_text)}</td></tr>"
            )
    return f"<table width='100%' cellspacing=1>{''.join(rows)}</table>"


def numbers_html(design: Design, optimum: Optimum) -> str:
    """Return a table of the varied numbers: before, found, taken over, and the limits that hold each of them."""
    numbers = {path: value for path, value in optimum.answer.items() if not isinstance(value, str)}
    if not numbers:
        return ""
    titles = ("", "before", "found", "taken", "held by")
    rows = ["".join(f"<th align={'left' if title in ('', titles[-1]) else 'right'}>{title}</th>" for title in titles)]
    for path, value in numbers.items():
        texts = (number_text(path, float(x)) for x in (get(design, path), optimum.exact.get(path, value), value))
        cells = "".join(f"<td align=right>{escape(text)}</td>" for text in texts)
        limits = [
            "its bound" if row.limit == path else in_sentence(column_text(design, row.limit))
            for row in optimum.binding
            if path in row.fields
        ]
        held = escape(", ".join(limits) or "no limit")
        rows.append(f"<td>{escape(name_of(design, path))}</td>{cells}<td>{held}</td>")
    return f"<table cellspacing=6>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


def optimum_html(design: Design, study: StudyOfMany, optimum: Optimum) -> str:
    """Return the result of a search: goals before and after, what limits them, and how many starts agree."""
    lines = []
    for goal in study.file.goals:
        now, before = optimum.goals[goal.key], optimum.before[goal.key]
        change = f" ({signed(100.0 * (now / before - 1.0), 3)} %)" if before and before == before and now == now else ""
        name = escape(label_of(design, goal.field or goal.quantity))
        lines.append(
            f"<b>{name} {escape(value_text(goal.key, now))}</b>, before {escape(value_text(goal.key, before))}{change}"
        )
    if not optimum.is_feasible:
        lines.insert(0, f"<span style='color:{SCREEN.limit}'>No design meets the limits; this one is closest.</span>")
    elif not optimum.is_better:
        lines.insert(0, "No better design was found: the design does not change.")
    first = study.file.goals[0]
    unit = unit_of(first.key).symbol
    lines += [
        f"Limited by {escape(in_sentence(column_text(design, row.limit)))}: 1 % more changes the goal by "
        f"{escape(with_unit(short(row.per_percent, 3), unit))}"
        for row in optimum.binding
    ]
    lines += [
        f"{escape(name_of(design, path))} {escape(word_text(value))}"
        for path, value in optimum.answer.items()
        if isinstance(value, str)
    ]
    lines += [
        f"{escape(name_of(design, path))} becomes {escape(number_text(path, value))}"
        for path, value in optimum.also_set.items()
    ]
    if optimum.share is not None:
        low = 100.0 * optimum.share.interval[0]
        lines.append(
            f"{number(100.0 * optimum.share.value, 2)} % of {count_text(optimum.share.machines)} machines keep "
            f"the limits, {number(low, 2)} % at least"
        )
    if optimum.is_better and optimum.starts > 1:
        lines.append(f"{optimum.agreeing} of {optimum.starts} starts lead to this design.")
    if optimum.front:
        lines.append(
            f"Front of {len(optimum.front)} designs, none of which is worse in both goals: click one to apply it."
        )
    if optimum.rejection:
        lines.append(f"A better design was rejected: {escape(optimum.rejection)}")
    return "<br>".join(lines)
