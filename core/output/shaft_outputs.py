"""The outputs of all drives of a shaft at one machine angle, and the path on which the first of them lead what they carry, as columns."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from core.frozen import frozen
from core.output.channels import channels
from core.study import Camshaft, Quantity, Study
from core.study.transfer_path import OUTPUTS, along, leads, lever, swings, travel

TRAVEL, SPEED, ACCELERATION = "{}_travel_mm", "path_speed_mm_s", "path_acceleration_mm_s2"
MM = 1e3


@frozen(eq=False)
class Output:
    """One column: its name, whose ending is its unit, in words, the family that sets its colour, and its values (n,) in its unit."""

    name: str
    label: str
    family: str
    values: Callable[[Camshaft[Study]], np.ndarray]


def outputs(camshaft: Camshaft[Study]) -> tuple[Output, ...]:
    """Displacement, velocity and acceleration of every drive; of one that swings an arm also its travel; then speed and acceleration
    along the path, where the first drives that lead it are measured in lengths."""
    rows: list[Output] = []
    for name, drive in camshaft.drives.items():
        own = {row.name: row for row in channels(drive.design, ("motion",))}
        slug = camshaft.slugs[name]
        rows += [
            Output(
                f"{slug}_{own[key].slug}",
                f"{name}, {own[key].label.lower()}",
                own[key].family,
                partial(_own, name, own[key]),
            )
            for key in OUTPUTS
            if key in own
        ]
        if swings(drive) and lever(drive) is not None:
            rows.append(Output(TRAVEL.format(slug), f"{name}, travel", "displacement", partial(_travel, name)))
    leading = leads(camshaft)
    if leading:
        by = " and ".join((", ".join(leading[:-1]), leading[-1]))
        rows.append(Output(SPEED, f"Speed along the path by {by}", "velocity", partial(_along, 1)))
        rows.append(Output(ACCELERATION, f"Acceleration on the path by {by}", "acceleration", partial(_along, 2)))
    return tuple(rows)


def travel_column(camshaft: Camshaft[Study], name: str) -> str:
    """The column with the output of a drive as a length."""
    return (
        TRAVEL.format(camshaft.slugs[name])
        if swings(camshaft.drives[name])
        else f"{camshaft.slugs[name]}_displacement_mm"
    )


def _own(name: str, row: Quantity, camshaft: Camshaft[Study]) -> np.ndarray:
    return row.values(camshaft.there(name))


def _travel(name: str, camshaft: Camshaft[Study]) -> np.ndarray:
    return travel(camshaft, name)[0] * MM + 0.0


def _along(order: int, camshaft: Camshaft[Study]) -> np.ndarray:
    return along(camshaft, order) * MM


__all__ = ["ACCELERATION", "SPEED", "Output", "outputs", "travel_column"]
