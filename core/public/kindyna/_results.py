"""Results of designs and studies: channels, extremes, findings, explanations, searches, many designs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from core.findings import Finding as CoreFinding
from core.number_text import result_text
from kindyna._checks import Array, brief, read_only, words_column

if TYPE_CHECKING:
    from core.output.explain import Explanation as CoreExplanation
    from core.study.many import Many


@dataclass(frozen=True, repr=False)
class Channel:
    """A column of the tables of a design.

    Attributes
    ----------
    name : column, which ends with its unit
    label : quantity in words
    unit : symbol of the unit
    table : file that ``export`` writes it to
    stage : stage of the study that computes it
    equation : its equation as the report prints it; empty for an angle
    source : author, year and number of the equation, or the principle; empty for an angle

    Examples
    --------
    >>> import kindyna as kd
    >>> c = kd.example("transfer_lift").study().channels["drive_torque_nm"]
    >>> c.label, c.unit, c.table
    ('Cam torque', 'N·m', 'dynamics.csv')
    >>> c.equation, c.source
    ('T_c = -d (C × F_c (n + μ v̂))', 'Shin1995 (27)')
    """

    name: str
    label: str
    unit: str
    table: str
    stage: str
    equation: str
    source: str

    def __repr__(self) -> str:
        return brief(f"<kindyna.Channel {self.name}: {self.label}, {self.table}>")


@dataclass(frozen=True)
class Clearance:
    """Least clearance of two bodies over the turn, proven.

    Attributes
    ----------
    pair : names of both bodies
    least_mm : least distance, 0 where they meet
    at_least_mm : proven lower bound of it, never above the true least distance; 0 where they meet
    angle_deg : angle of cam, driver or machine; where they meet, that at which they begin to
    points_mm : nearest points of both bodies there, (x, y) in the global frame
    collides_deg : ranges of angles in which they meet

    Examples
    --------
    >>> import kindyna as kd
    >>> c = kd.example("transfer_unit_outlines").study().clearances()[0]
    >>> c.pair, round(c.least_mm, 3), c.at_least_mm > 40.76, c.collides_deg
    (('feed.arm', 'lift.arm'), 40.763, True, ())
    """

    pair: tuple[str, str]
    least_mm: float
    at_least_mm: float
    angle_deg: float
    points_mm: tuple[tuple[float, float], tuple[float, float]]
    collides_deg: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Extreme:
    """An extreme of a channel over the turn.

    Attributes
    ----------
    value : in the unit of the channel; infinite where the quantity grows without limit
    angle_deg : cam, driver or machine angle at which it is reached
    unit : symbol of the unit

    Examples
    --------
    >>> import kindyna as kd
    >>> kd.example("transfer_lift").study().extreme("drive_torque_nm", of="abs")
    Extreme(value=7510.8..., angle_deg=302.72..., unit='N·m')
    """

    value: float
    angle_deg: float
    unit: str

    def _repr_html_(self) -> str:
        from kindyna._cards import extreme_line

        return extreme_line(self.value, self.unit, self.angle_deg)

    def __float__(self) -> float:
        return self.value


@dataclass(frozen=True, repr=False)
class Finding:
    """A limit that a design exceeds.

    Attributes
    ----------
    code : name of the limit, the same in every language
    severity : ``error`` (the machine cannot work), ``warning`` or ``note``
    field : path of the input that remedies it
    angle_deg : angle of the worst value, None where it concerns the full turn
    message : subject, value, limit and remedy in one sentence

    Examples
    --------
    >>> import kindyna as kd
    >>> d = kd.example("transfer_lift").edit({"limits.pressure_angle_return_deg": 15.0})
    >>> finding = d.findings[0]
    >>> finding.severity, finding.code
    ('warning', 'pressure-angle-return')
    >>> print(finding.message)
    pressure angle 17.605 deg on the return at 58.48 deg, your limit 15 deg: enlarge the base radius, or lengthen the return
    """

    code: str
    severity: str
    field: str
    angle_deg: float | None
    message: str

    def _repr_html_(self) -> str:
        from kindyna._cards import message  # only notebooks need it

        return message(self.severity, self.message, self.field)

    def __repr__(self) -> str:
        return brief(f"<kindyna.Finding {self.severity} {self.code}: {self.message}>")


def clearance(data: Mapping[str, Any]) -> Clearance:
    """Return a clearance of its JSON."""
    (p, q), (first, second) = data["points"], data["pair"]
    collides = tuple((float(begin), float(end)) for begin, end in data["collides"])
    least, bound, angle = (float(data[key]) for key in ("least_mm", "at_least_mm", "cam_angle_deg"))
    return Clearance((first, second), least, bound, angle, ((p[0], p[1]), (q[0], q[1])), collides)


def finding(row: CoreFinding) -> Finding:
    """Return a finding of the core."""
    return Finding(row.code, row.severity, row.field, row.cam_angle_deg, row.message)


@dataclass(frozen=True, repr=False)
class Explanation:
    """A number with its equation and the values of its symbols; ``str()`` is the text of the command ``explain``.

    Attributes
    ----------
    quantity : channel, or a figure of ``summary.json``
    value : in the unit
    unit : symbol of the unit
    equation : lines that are evaluated with the symbols; the first gives the value
    source : author, year and number, or the principle
    symbols : each with ``symbol``, ``meaning``, ``value``, ``unit``, and ``from``: a field's path or a stage
    residual : residual of the certificate in its stage that is nearest to its bound; None where there is none
    bound : bound of this residual

    Examples
    --------
    >>> import kindyna as kd
    >>> e = kd.example("transfer_lift").study().explain("pressure_angle_deg", at_deg=58)
    >>> e.equation[0]
    'ψ = atan2(|n_x v_y - n_y v_x|, |n_x v_x + n_y v_y|)'
    >>> e.source, round(e.value, 4), e.symbols[0]["meaning"]
    ('Shin1995 (19), for any pose', 17.5903, 'unit normal of the pitch curve, into the cam, x')
    """

    quantity: str
    value: float
    unit: str
    equation: tuple[str, ...]
    source: str
    symbols: tuple[Mapping[str, Any], ...]
    residual: float | None
    bound: float | None
    _text: str

    def __str__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        from kindyna._cards import equation_card

        value = f"{result_text(self.value, 6)} {self.unit}"
        return equation_card(self.quantity, value, self.equation, self.source, self.symbols)

    def __repr__(self) -> str:
        return brief(f"<kindyna.Explanation {self.quantity} = {self.value:.6g} {self.unit}: {self.equation[0]}>")


def explanation(core: CoreExplanation) -> Explanation:
    """Return an explanation of the core."""
    from core.output.explain import as_row, as_text

    row = as_row(core)
    return Explanation(
        row["quantity"], float(row["value"]), row["unit"], tuple(row["equation"]), row["source"],
        tuple(row["symbols"]), row["residual"], row["bound"], as_text(core),
    )  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class ManyResult:
    """Figures of m designs.

    Attributes
    ----------
    inputs : path -> its numbers or words (m,)
    value : figure -> its values (m,), NaN where a design has no solution
    angle_deg : figure -> cam angles of extremes (m,), NaN for other figures
    reason : code (m,) of the error because of which a design has no values; else empty

    Examples
    --------
    >>> import kindyna as kd
    >>> m = kd.example("transfer_lift").many({"cam.base_radius_mm": [380.0, 400.0, 430.0]}, ["pressure_angle_deg:max"])
    >>> m.value["pressure_angle_deg:max"].round(2).tolist()
    [19.83, 17.6, 19.03]
    >>> len(m), m.reason.tolist()
    (3, ['', '', ''])
    """

    inputs: Mapping[str, NDArray[Any]]
    value: Mapping[str, Array]
    angle_deg: Mapping[str, Array]
    reason: NDArray[np.str_]

    def __len__(self) -> int:
        return int(self.reason.size)

    def to_frame(self) -> Any:
        """Return a pandas DataFrame: a row for each design, its columns the inputs, the figures and the reason.

        Raises
        ------
        ImportError
            pandas is not installed; the extra ``frames`` installs it.

        Examples
        --------
        >>> import kindyna as kd
        >>> d = kd.example("rocker_cam")
        >>> d.many({"cam.base_radius_mm": [45.0, 50.0]}, ["pressure_angle_deg:max"]).to_frame().columns.tolist()
        ['cam.base_radius_mm', 'pressure_angle_deg:max', 'reason']
        """
        return frame({**self.inputs, **self.value, "reason": self.reason})

    def _repr_html_(self) -> str:
        from kindyna._cards import designs_card

        return designs_card({**self.inputs, **self.value}, self.reason)

    def __repr__(self) -> str:
        return brief(f"<kindyna.ManyResult {len(self)} designs, {', '.join(self.value)}>")


def many_result(inputs: Mapping[str, NDArray[Any]], core: Many) -> ManyResult:
    """Return figures of the core."""
    value = {key: read_only(column) for key, column in core.value.items()}
    angle_deg = {key: read_only(column) for key, column in core.angle_deg.items()}
    return ManyResult(inputs, value, angle_deg, words_column(core.reason))


def frame(columns: Mapping[str, Any], index: Array | None = None, name: str = "") -> Any:
    """Return a pandas DataFrame, with an index where it is given. Raises ImportError, which names the extra."""
    try:
        from pandas import DataFrame, Index
    except ImportError as error:
        raise ImportError("to_frame needs pandas: install kindyna with its extra, kindyna[frames]") from error
    return DataFrame(dict(columns), index=None if index is None else Index(index, name=name))
