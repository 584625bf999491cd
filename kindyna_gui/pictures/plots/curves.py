"""What a plot reads from a study: the values of its channels, their colours and their limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.output.channels import Channel
from core.study import Study
from kindyna_gui.pictures.plots.limits import limit_of
from kindyna_gui.pictures.sizes import floor_of, without_noise
from kindyna_gui.pictures.style import Theme, shade


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve: its channel, its values in the channel's unit (n,), its colour, the size below which values are zero."""

    channel: Channel
    values: np.ndarray
    colour: str
    floor: float = 0.0

    def is_drawn_as(self, other: Curve) -> bool:
        return (
            self.channel == other.channel and self.colour == other.colour and np.array_equal(self.values, other.values)
        )


def read_curves(study: Study, channels: Sequence[Channel], theme: Theme) -> list[Curve]:
    """The curves of these channels, those of one family in different shades. Raises NoAnswer where one has none."""
    seen: dict[str, int] = {}
    curves = []
    for row in channels:
        beside = next((curve for curve in curves if curve.channel.quantity == row.beside), None)
        nth = seen[row.family] = seen.get(row.family, -1) + 1
        floor = floor_of(study, row)
        values = without_noise(row.values(study), floor)
        colour = shade(theme.family(row.family), nth) if beside is None else beside.colour
        curves.append(Curve(row, values, colour, floor))
    return curves


def limits_of(study: Study, channels: Sequence[Channel]) -> list[tuple[float, str, str]]:
    """Value, in the channels' unit, words and short words of each limit; with the channel's name where there are
    several channels."""
    limits = [(row, limit_of(study, row.quantity)) for row in channels]
    made = []
    for row, limit in limits:
        if limit is not None:
            name = "" if len(channels) == 1 else f"{row.label}: "
            short = limit.words.partition("{")[0].removesuffix("from ").removesuffix("below ").strip()
            made.append((limit.value / row.unit.factor, name + limit.words, name + short))
    return made


def drawn_alike(curves: Sequence[Curve], others: Sequence[Curve]) -> bool:
    return len(curves) == len(others) and all(a.is_drawn_as(b) for a, b in zip(curves, others, strict=True))


def different(study: Study, rows: Sequence[Channel]) -> list[Channel]:
    """Those channels that no other before them equals, such as the motor's torque without a flywheel."""
    kept: list[Channel] = []
    for row in rows:
        if not any(np.array_equal(row.values(study), other.values(study)) for other in kept):
            kept.append(row)
    return kept
