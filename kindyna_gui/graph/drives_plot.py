"""One quantity of all drives on a shaft, by their colours, over the machine angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.errors import KindynaError
from core.study import Camshaft, Study
from kindyna_gui.pictures.plots.quantities import quantities_for, rows_of, split
from kindyna_gui.pictures.plots.xy import Line
from kindyna_gui.pictures.style import SCREEN, drive_colour
from kindyna_gui.pictures.units import readable

TORQUE = "drive_torque"
"""The quantity of which the drives on a shaft have a sum."""


def curves_of_all(shaft: Camshaft[Study], usual: Sequence[str]) -> tuple[list[Line], str, list[str]]:
    """The first of these quantities of each drive over the machine angle [deg], of torques their sum too; the title of the axis; and
    a line for each drive that is left out."""
    found, missing, first = [], [], None
    for number, (name, study) in enumerate(shaft.drives.items()):
        try:
            rows, _ = split(study, rows_of(study, quantities_for(study, usual)))
            values = rows[0].values(study) if rows else np.zeros(0)
        except KindynaError as error:
            missing.append(f"{name}: {error}")
            continue
        first = first or (rows[0] if rows else None)
        if not rows or first is None or rows[0].unit.symbol != first.unit.symbol:
            what = f"in {rows[0].unit.symbol}, not in {first.unit.symbol}" if rows and first else "none"
            missing.append(f"{name}: {what}")
            continue
        machine = np.degrees(shaft.places[name].machine(study.theta))
        order = np.argsort(machine)
        found.append((machine[order], values[order], drive_colour(number), name))
    if first is None:
        return [], "", missing
    if first.name == TORQUE and len(found) > 1 and not missing:
        found.append((shaft.angle_degrees, shaft.torque, SCREEN.ink, "Shaft"))
    rung = readable(first.unit.symbol, max(float(np.nanmax(np.abs(values))) for _, values, _, _ in found))
    lines = [_closed(x, values / rung.size, colour, name) for x, values, colour, name in found]
    return lines, f"{first.label}, {rung.symbol}", missing


def _closed(x: np.ndarray, y: np.ndarray, colour: str, name: str) -> Line:
    """From 0 to 360 degrees."""
    edge = np.interp(360.0, np.append(x, x[0] + 360.0), np.append(y, y[0]))
    return Line(np.concatenate(([0.0], x, [360.0])), np.concatenate(([edge], y, [edge])), colour, name)


__all__ = ["curves_of_all"]
