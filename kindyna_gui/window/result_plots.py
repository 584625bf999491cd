"""Where a result is plotted: the view that is brought to the front for a quantity, a column or a figure."""

from __future__ import annotations

import re
from typing import Any

from core.output.channels import channels
from kindyna_gui.pictures.plots.quantities import quantities_for
from kindyna_gui.window.base import Window
from kindyna_gui.window.docks import VIEWS

FIGURES = (
    ("eta|natural_rpm", "stability"),
    (".*life_hours", "contact_pressure"),
    ("(?!mean_)(.*_)?torque_nm", "shaft_torque"),
    ("speed_rpm|torque_.*", "shaft_figures"),
    (".*", "flywheel"),
)
"""Pattern of a figure, or of a column of the shaft -> its view; the first that matches."""


def show_quantity(window: Window, name: str) -> None:
    """Bring the plot of a quantity of the selected drive to the front, or else add it to the graph."""
    study, plots = window.session.study, ((view, row.quantities) for view, row in VIEWS.items() if row.quantities)
    if view := next((view for view, quantities in plots if name in quantities_for(study, quantities)), ""):
        window.show_view(view)
    else:
        window.show_task("graph")
        curves: Any = window.show_view("curves")
        curves.show_channel(name)


def show_result(window: Window, result: str) -> None:
    """Bring the curve of a result to the front: of a column, with the slug of its drive before a dot, or of a figure."""
    slug, _, column = result.rpartition(".")
    session = window.session
    if slug and not session.choose_drive([*session.shaft.slugs.values()].index(slug)):
        return
    is_shared = session.has_several_drives and not slug
    columns = () if is_shared else channels(session.design)
    if name := next((row.name for row in columns if row.slug == column), ""):
        show_quantity(window, name)
    else:
        window.show_view(next(view for pattern, view in FIGURES if re.fullmatch(pattern, column)))
