"""Names of figures: quantities with a statistic over the turn, totals, and the numbers of a design."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.design import Design, drive_at, entry_at, row_at
from core.design.fields import in_sentence
from core.study import TOTALS, quantity
from core.study.quantity_requests import quantity_request
from core.varying.linear import SPANS
from kindyna_gui import labels
from kindyna_gui.pictures.paper.timing_chart import event_text

STATISTICS: Mapping[str, str] = MappingProxyType(
    {"abs": "peak", "max": "greatest", "min": "least", "rms": "RMS", "mean": "mean", "range": "range"}
)
"""Statistic of a quantity over the turn -> its name."""

TOTAL_TEXTS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "flywheel_inertia_kg_m2": ("Flywheel needed", "torque"),
        "energy_j": ("Energy of the flywheel", "energy"),
        "life_hours": ("Life of the roller", "stress"),
    }
)


def name_of(design: Design, path: str) -> str:
    """Return the name of a number, with its drive where the design has several."""
    _, number, inside = row_at(path, "drives")
    if inside == path or drive_at(path) is not None:
        return labels.name_of(design, path)
    return f"{design.drives[number].name}: {in_sentence(labels.name_of(design, path))}"


def is_field(key: str) -> bool:
    """Whether the key of a goal is the path of a varied number, not that of a figure."""
    return "." in key and ":" not in key


def label_of(design: Design, slug: str) -> str:
    """Return the name of a quantity without its statistic, or of a number."""
    if is_field(slug) and entry_at(design, slug) is not None:
        return name_of(design, slug)
    if slug in TOTAL_TEXTS:
        return TOTAL_TEXTS[slug][0]
    request = quantity_request(design, f"{slug}:max")
    label = quantity(request.name).label if request.name else "Torque of the shaft"
    return label if request.drive is None else f"{design.drives[request.drive].name}: {in_sentence(label)}"


def figure_label(design: Design, key: str) -> str:
    """Return the name of a figure: a total, or a quantity with its statistic unless that is the peak."""
    slug, _, statistic = key.partition(":")
    return label_of(design, slug) + (f", {STATISTICS[statistic]}" if statistic and statistic != "abs" else "")


def column_text(design: Design, column: str) -> str:
    """Return the name of a column of a study's table: a field, a total, or a quantity with its statistic."""
    slug, _, statistic = column.rpartition("_")
    if statistic in STATISTICS and slug and not column.endswith(("_kg_m2", "_j", "_hours")):
        return figure_label(design, f"{slug}:{statistic}")
    _, number, inside = row_at(column, "timing")
    if inside != column:
        row = design.timing[number]
        return f"Distance from {event_text(row.first)} to {event_text(row.second)}"
    if column.endswith(SPANS):
        return "the rest of the turn for other segments"
    return label_of(design, column) if column in TOTALS else name_of(design, column)
