"""Columns of a study: names, values and extremes, as the command ``export`` writes them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from core.commands.common import solved
from core.errors import KindynaError
from core.output.channels import ANGLES, channels
from core.output.export import SHAFT, TABLES, angle_of_table, bounded_study, table_rows
from core.output.summary import extremes, shaft_extremes
from core.study.extremes import has_quantity
from core.study.formulas import FORMULAS
from core.study.quantities import DYNAMICS, SERVO, Quantity, why_absent
from core.study.study import Study as CoreStudy
from core.units import split_unit
from kindyna._checks import Array, read_only, text, unknown
from kindyna._results import Channel, Extreme

if TYPE_CHECKING:
    from core.output.explain.shaft import ShaftColumn

_OF = ("max", "min", "abs")
_MACHINE = "machine_angle_deg"


class Columns:
    """Columns of a study, by the angle of cam, driver or machine.

    Attributes
    ----------
    full : study over the full turn
    given : its other angles (n,) [deg], None for those of ``full``
    without : names of quantities that its tables omit
    """

    def __init__(self, full: CoreStudy, given: Array | None, without: frozenset[str] = frozenset()) -> None:
        self.full, self.given, self.without = full, given, without
        self._cache: dict[str, Array] = {}

    def at(self, angles_deg: Array) -> Columns:
        """Return the columns at other angles (n,) [deg]."""
        return Columns(self.full, angles_deg, self.without)

    @property
    def solved(self) -> CoreStudy:
        """The study over the full turn. Raises NoSolution where none of several drives has a solution."""
        return solved(self.full)

    @cached_property
    def core(self) -> CoreStudy:
        """The study of a drive at its angles."""
        return self.full if self.given is None else self.full.at_theta(np.deg2rad(self.given))

    @cached_property
    def angle_deg(self) -> Array:
        """Angles (n,) [deg]."""
        return read_only(self.full.angle_degrees) if self.given is None else self.given

    @property
    def angle(self) -> str:
        """Column of the angles."""
        return _MACHINE if self.full.design.listed else self.full.angle_column

    @cached_property
    def channels(self) -> Mapping[str, Channel]:
        """Name -> channel."""
        return self._of_shaft() if self.full.design.listed else self._of_drive()

    def values(self, name: str) -> Array:
        """Return the values (n,) of a channel, in the unit of its name. Raises KeyError."""
        if name not in self._cache:
            row = self.row(name)
            self._cache[name] = self.angle_deg if row is None else read_only(self._computed(row))
        return self._cache[name]

    def extreme(self, name: str, of: str) -> Extreme:
        """Return an extreme over the full turn. Raises KeyError, ValueError, and KindynaError for an angle that wraps."""
        row = self.row(name)
        if of not in _OF:
            raise ValueError(f"of = {of!r}: extreme of {name}; allowed: {', '.join(_OF)}")
        ends = None
        if isinstance(row, Quantity):
            ends = extremes(self.full, (row.stage,)).get(row.slug)
        elif row is not None:
            ends = shaft_extremes(self.solved.camshaft).get(name)
        if row is None or ends is None:
            raise KindynaError(
                f"{name}: has no extremes in summary.json, as no angle that wraps or counts the rows has"
            )
        end = max(ends["max"], ends["min"], key=lambda end: abs(end["value"])) if of == "abs" else ends[of]
        value = abs(end["value"]) if of == "abs" else end["value"]
        return Extreme(float(value), float(end["cam_angle_deg"]), row.unit.symbol)

    def quantity_of(self, name: str) -> str:
        """Return the name under which ``explain`` knows a channel, or the name itself."""
        row = None if self.full.design.listed else self._quantity(name)
        return name if row is None else row.slug

    def row(self, name: str) -> Quantity | ShaftColumn | None:
        """Return what gives the values of a channel, None for an angle of the rows; computes only what the channel depends on.

        Raises KeyError.
        """
        row: Quantity | ShaftColumn | None
        if text("channel", name) == self.angle:
            return None
        if self.full.design.listed:
            from core.output.explain.shaft import shaft_column  # only several drives need it

            row = shaft_column(self.solved, name)
        else:
            row = self._quantity(name)
        if row is None and (name not in ANGLES.values() or name not in self.channels):
            raise self._unknown(name)
        return row

    @cached_property
    def _bounded(self) -> CoreStudy:
        """The study in which columns are searched, as ``export`` searches them."""
        return bounded_study(self.full)

    def _quantity(self, name: str) -> Quantity | None:
        """Return the quantity of a column of a drive; the servo's motor after that of the shaft, which has the same column."""
        rows = (row for row in channels(self.full.design) if name in (row.slug, row.column))
        study = self._bounded
        for row in sorted(rows, key=lambda row: TABLES.index(row.table)):
            if (
                row.name not in self.without
                and has_quantity(study, row)
                and (row.table not in (DYNAMICS, SERVO) or study.jam is None)
            ):
                return row
        return None

    def _unknown(self, name: str) -> KeyError:
        design = self.full.design
        if design.listed and any(name in Columns(study, None).channels for study in self.full.solved_drives.values()):
            return KeyError(
                f"{name}: is a channel of one drive; choose it with drives[NAME]: {', '.join(self.full.drives)}"
            )
        return unknown("channel of this design", name, self.channels, "" if design.listed else why_absent(design, name))

    @cached_property
    def _quantities(self) -> dict[str, Quantity | ShaftColumn]:
        """Name -> quantity, of all channels but the angles of the rows."""
        if self.full.design.listed:
            from core.output.explain.shaft import shaft_columns  # only several drives need it

            return dict(shaft_columns(self.solved))
        result: dict[str, Quantity | ShaftColumn] = {}
        for table in TABLES:
            for column, row in table_rows(self.full, table, (), self.without):
                result[row.slug if column in result else column] = row  # the servo's motor next to that of the shaft
        return result

    def _computed(self, row: Quantity | ShaftColumn) -> Any:
        if isinstance(row, Quantity):
            return row.values(self.core)
        camshaft = self.full.camshaft
        at_angles = camshaft if self.given is None else camshaft.at_theta(np.deg2rad(self.given))
        return row.values(at_angles) / row.unit.factor + 0.0

    def _of_drive(self) -> dict[str, Channel]:
        result: dict[str, Channel] = {}
        for name, row in self._quantities.items():
            assert isinstance(row, Quantity), "a column of a shaft"
            angle = angle_of_table(self.full, row.table)
            result.setdefault(angle, _angle_channel(angle, row.table, row.stage))
            result[name] = Channel(name, row.label, row.unit.symbol, row.table, row.stage, row.equation, row.source)
        return result

    def _of_shaft(self) -> dict[str, Channel]:
        result = {_MACHINE: _angle_channel(_MACHINE, SHAFT, "dynamics")}
        for name, row in self._quantities.items():
            formula = FORMULAS.get(name)
            equation, source = ("", "") if formula is None else (formula.lines[0], formula.source)
            result[name] = Channel(name, row.label, row.unit.symbol, SHAFT, "dynamics", equation, source)
        return result


def _angle_channel(name: str, table: str, stage: str) -> Channel:
    label, unit = split_unit(name)
    return Channel(name, label.replace("_", " ").capitalize(), unit.symbol, table, stage, "", "")
