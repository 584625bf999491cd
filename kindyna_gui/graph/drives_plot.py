"""One quantity of all drives on a shaft, by their colours, over the machine angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.errors import KindynaError
from core.motion import degrees
from core.study import Camshaft, Study
from kindyna_gui.documents.bands import Bands
from kindyna_gui.pictures.plots.quantities import quantities_for, rows_of, split
from kindyna_gui.pictures.plots.xy import Line
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import readable

TORQUE = "drive_torque"
"""The quantity of which the drives on a shaft have a sum."""


def curves_of_all(shaft: Camshaft[Study], usual: Sequence[str], bands: Bands) -> tuple[list[Line], str, list[str]]:
    """The first of these quantities of each drive over the machine angle [deg] with its band, of torques their sum too; the title of
    the axis; and a line for each drive that is left out."""
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
        band = bands.read(rows[:1], number).get(rows[0].slug)
        place = shaft.positions[name]
        shade = None if band is None else (place.machine_angle(np.deg2rad(degrees(band.shape[1]))), band)
        found.append((place.machine_angle(study.theta), values, SCREEN.drive(number), name, shade))
    if first is None:
        return [], "", missing
    if first.name == TORQUE and len(found) > 1 and not missing:
        sum_band = bands.of_shaft().get("")
        shade = None if sum_band is None else (np.deg2rad(degrees(sum_band.shape[1])), sum_band)
        found.append((shaft.theta, shaft.torque, SCREEN.ink, "Shaft", shade))
    rung = readable(first.unit.symbol, max(float(np.nanmax(np.abs(values))) for _, values, *_ in found))
    lines = [
        Line(*_closed(x, values / rung.size), colour, name, band=shade and _closed(shade[0], shade[1] / rung.size))
        for x, values, colour, name, shade in found
    ]
    return lines, f"{first.label}, {rung.symbol}", missing


def _closed(machine: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Machine angles (n,) [rad] and values (..., n) there as angles (n + 2,) [deg] in their order, from 0 to 360, and values."""
    order = np.argsort(machine)
    x, y = np.degrees(machine[order]), y[..., order]
    part = (360.0 - x[-1]) / (x[0] + 360.0 - x[-1])
    edge = y[..., -1:] + part * (y[..., :1] - y[..., -1:])
    return np.concatenate(([0.0], x, [360.0])), np.concatenate((edge, y, edge), axis=-1)


__all__ = ["curves_of_all"]
