"""Pictures of mechanisms and plots of channels, as SVG text."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

from core.design import motion_of
from core.errors import KindynaError
from core.output.drawing.picture import mechanism_picture
from core.output.drawing.plots import TurnCurve, figure_picture, turn_figure
from core.output.drawing.turn import floor_of, moving, spans
from core.project.files import write
from core.study.member_quantities import gain_per_turn
from core.study.quantities import Quantity
from core.units import split_unit
from kindyna._checks import brief, path_to_write
from kindyna._columns import Columns

_ENDING = ".svg"
_OF_SHAFT = {"N·m": "torque", "rpm": "speed"}
HEADLINES = (
    "displacement", "velocity", "acceleration", "pressure_angle", "contact_force", "contact_pressure", "drive_torque",
    "driver_torque", "torque",
)  # fmt: skip
"""Quantities that are shown where none is named; those that a design lacks are left out."""
FEWEST, MOST = 3, 10


@dataclass(frozen=True, repr=False)
class Picture:
    """A drawing or a plot; notebooks show it, on light and on dark paper.

    Attributes
    ----------
    svg : the picture as SVG

    Examples
    --------
    >>> import kindyna as kd
    >>> s = kd.example("transfer_lift").study()
    >>> s.picture(at_deg=60).save("lift.svg")
    >>> s.plot("pressure_angle_deg", "contact_force_n").save("plots.svg")
    """

    svg: str

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture to a file.

        Parameters
        ----------
        path : str or path
            Its name ends with ``.svg``.

        Raises
        ------
        ValueError
            The name has another ending.
        KindynaError
            The file cannot be written.

        Examples
        --------
        >>> import kindyna as kd
        >>> kd.example("rocker_cam").study().picture(at_deg=120).save("rocker.svg")
        """
        target = path_to_write("path", path)
        if target.suffix.lower() != _ENDING:
            raise ValueError(f"path = {str(path)!r}: the name of a picture ends with {_ENDING}")
        write(target, self.svg.encode())

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return brief(f"<kindyna.Picture {len(self.svg)} characters of SVG>")


def machine(columns: Columns, at_deg: float) -> Picture:
    """Return the mechanism at an angle [deg]. Raises KindynaError where it cannot be assembled."""
    return Picture(mechanism_picture(columns.full, at_deg))


def plot(columns: Columns, names: Sequence[str]) -> Picture:
    """Return the plots of channels, of the headlines where none is named. Raises KeyError, KindynaError."""
    chosen = tuple(names) or tuple(headlines(columns))[:4]
    curves = [_curve(columns, name) for name in chosen]
    listed = columns.full.design.listed
    across = f"{_words(columns.angle)}, °"
    segments = () if listed or columns.full.swings else spans(motion_of(columns.full.design))
    return Picture(figure_picture(turn_figure(columns.full.design.name, across, curves, segments)))


def headlines(columns: Columns) -> list[str]:
    """Return the channels that say most about a design: those of ``HEADLINES``; with few of them, others too."""
    known = columns.channels
    result = [name for head in HEADLINES for name in known if split_unit(name)[0] == head]
    if len(result) < FEWEST or not any(columns.values(name).any() for name in result):
        result += [name for name in known if name not in result and not name.endswith("angle_deg")]
    return result[:MOST]


def largest(columns: Columns, name: str) -> tuple[float, float] | None:
    """Return the value of the largest size of a channel and its angle [deg]; None where it has none, or is 0 throughout."""
    try:
        ends = [columns.extreme(name, of) for of in ("max", "min")]
    except (KindynaError, KeyError):
        return None
    end = max(ends, key=lambda end: abs(end.value))
    return None if abs(end.value) <= _floor(columns, name) else (end.value, end.angle_deg)


def _words(name: str) -> str:
    return split_unit(name)[0].replace("_", " ").capitalize()


def _floor(columns: Columns, name: str) -> float:
    row = columns.row(name)
    return floor_of(columns.full, row) if isinstance(row, Quantity) else 0.0


def _curve(columns: Columns, name: str) -> TurnCurve:
    row, values = columns.row(name), columns.values(name)
    if row is None:
        return TurnCurve(_words(name), split_unit(name)[1].symbol, "angle", columns.angle_deg, values)
    extremes: list[tuple[float, float]] = []
    if columns.given is None:
        try:
            ends = [columns.extreme(name, of) for of in ("min", "max")]
            extremes = [(end.angle_deg, end.value) for end in ends]
        except KindynaError:  # an angle that wraps
            pass
    if not isinstance(row, Quantity):
        family = _OF_SHAFT.get(row.unit.symbol, "")
        return TurnCurve(row.label, row.unit.symbol, family, columns.angle_deg, values, tuple(extremes))
    study = columns.core
    return TurnCurve(
        row.label,
        row.unit.symbol,
        row.family,
        columns.angle_deg,
        values,
        tuple(extremes),
        moving(study),
        gain_per_turn(study, row.name) / row.unit.factor,
        floor_of(study, row),
    )
