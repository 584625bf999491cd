"""The motion of a follower as typed: curves of segments, lobe, and links to other files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from math import fsum
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from core.design.engine import Lobe
from core.design.fields import LAW, FileLayout, brief, choice, flag, number, placed, whole
from core.errors import DesignError
from core.frozen import frozen
from core.laws import LAWS, Piece, PieceTable, split
from core.laws.pieces import stretched
from core.numerics.lazy import map_columns, one_design
from core.units import UNITS

# -- curves and segments ----------------------------------------------------------------------------------------


@frozen
class NamedCurve:
    """A curve of the table of laws.

    Attributes
    ----------
    law : slug of the law
    crossover : change from acceleration to deceleration of a symmetric law, as a fraction of the span
    flat_fraction : fraction of the span with constant acceleration, for a half cycloid C1 ... C4
    """

    law: str = placed(FileLayout(missing=" | ".join(LAWS)))
    crossover: float = number("Crossover", 0.01, 0.99, default=0.5, step=0.05, help="0.5 = symmetric")
    flat_fraction: float = number(
        "Constant acceleration",
        0.0,
        1.0,
        default=0.0,
        step=0.05,
        help="fraction of the span, for the half cycloids C1 ... C4",
    )


@frozen
class SccaCurve:
    """Sine - constant - cosine acceleration (Norton ch. 3: b, c, d).

    Fractions of the span without its constant velocity are sine ramp and constant acceleration; the rest is cosine.
    """

    law: ClassVar[str] = "scca"
    cv_fraction: float = number("Constant velocity", 0.0, 0.99, default=0.0, step=0.05, help="fraction of the span")
    ramp_fraction: float = number(
        "Sine ramp", 0.0, 1.0, default=0.25, step=0.05, help="fraction of the span outside constant velocity"
    )
    flat_fraction: float = number(
        "Constant acceleration",
        0.0,
        1.0,
        default=0.0,
        step=0.05,
        help="fraction of the span outside constant velocity",
    )


@frozen
class PolynomialEnd:
    """Derivatives of a polynomial at one end, per degree of cam angle; without a jerk the jerk is free."""

    velocity: float = number("Velocity", default=0.0, help="per degree")
    acceleration: float = number("Acceleration", default=0.0, help="per degree squared")
    jerk: float | None = number("Jerk", default=None, help="per degree cubed; empty = free")


@frozen
class PolynomialCurve:
    """The polynomial of least degree with given derivatives at its ends."""

    law: ClassVar[str] = "polynomial"
    start: PolynomialEnd = placed(FileLayout(PolynomialEnd, single=True, whole=True), PolynomialEnd())
    end: PolynomialEnd = placed(FileLayout(PolynomialEnd, single=True, whole=True), PolynomialEnd())


@frozen
class SplinePoint:
    """Value, velocity and acceleration of a spline at an angle, as far as given; angle and value are from the segment's start."""

    at_deg: float = number("At", 0.0, 360.0)
    value: float | None = number("Value", default=None)
    velocity: float | None = number("Velocity", default=None)
    acceleration: float | None = number("Acceleration", default=None)


@frozen
class SplineCurve:
    """The curve of least mean-square jerk through points: periodic over a full turn, else at rest at its ends by default."""

    law: ClassVar[str] = "spline"
    points: tuple[SplinePoint, ...] = placed(FileLayout(SplinePoint, whole=True), ())


AT_REST, JOINED = "rest", "joined"
TABLE_ENDS = (AT_REST, "stop", "free", JOINED)


@frozen
class TableCurve(SplineCurve):
    """The curve of least jerk through rows of a table: cam angle, value, and velocity and acceleration where known.

    ``start`` and ``end`` determine velocity and acceleration that the first and the last row do not give: at rest, velocity
    0 only, free, or joined, equal to those of the neighbour whatever the row gives.
    """

    law: ClassVar[str] = "table"
    start: str = choice("Start", TABLE_ENDS, default=AT_REST, help="velocity and acceleration where it begins")
    end: str = choice("End", TABLE_ENDS, default=AT_REST, help="velocity and acceleration where it ends")
    points: tuple[SplinePoint, ...] = placed(FileLayout(SplinePoint, whole=True, rows=True), ())


ACCELERATION = "acceleration"
MINIMISED: Mapping[str, tuple[int, bool]] = MappingProxyType(
    {
        ACCELERATION: (2, False),
        "jerk": (3, False),
        "velocity": (1, False),
        "rms_acceleration": (2, True),
        "rms_jerk": (3, True),
        "torque": (2, False),
        "contact_force": (2, False),
        "motor_rms": (2, True),
    }
)
"""What an optimal law minimises -> order of the derivative, and whether its root mean square and not its peak.

Of what depends on the machine it is the order of the highest derivative on which it depends.
"""
OF_MACHINE = ("torque", "contact_force", "motor_rms")
"""What an optimal law minimises in its machine: torque and force that its segment causes, torque of the servo's motor."""
PLAIN = "rms_acceleration"
"""What is minimised in place of it where the machine has no solution."""


@frozen
class CurveLimits:
    """Largest absolute derivatives of an optimal law, normalised to span 1 and rise 1, in the order of the derivatives."""

    velocity: float | None = number("Velocity limit", 0.0, open_low=True, default=None, help="span 1, rise 1")
    acceleration: float | None = number("Acceleration limit", 0.0, open_low=True, default=None, help="span 1, rise 1")
    jerk: float | None = number("Jerk limit", 0.0, open_low=True, default=None, help="span 1, rise 1")


@frozen
class CurveBound:
    """Bound of an optimal law over a part of its span: an obstacle that it passes below or above."""

    start: float = number("From", 0.0, 1.0, step=0.05, help="fraction of the span")
    end: float = number("To", 0.0, 1.0, step=0.05, help="fraction of the span")
    rise: float = number("Rise", step=0.05, help="fraction of the rise")


@frozen
class OptimalCurve(SplineCurve):
    """The curve of the least peak or root mean square of a derivative, within limits on other derivatives.

    Attributes
    ----------
    minimise : derivative whose peak or root mean square is least
    start, end : velocity and acceleration at the ends, as of a table; 0 acceleration only where the jerk is controlled
    limits : largest other derivatives
    below, above : obstacles
    vibration_free : cycles a span of undamped followers that are at rest after it
    intervals : number of equal intervals of the law
    points : as of a spline
    machine : machine in which it is optimal, where it minimises an effect there; None elsewhere
    """

    FILE_ORDER: ClassVar[tuple[str, ...]] = (
        "minimise", "start", "end", "limits", "vibration_free", "below", "above", "intervals", "points",
    )  # fmt: skip
    law: ClassVar[str] = "optimal"
    minimise: str = choice("Minimise", tuple(MINIMISED), default=ACCELERATION, help="its peak or root mean square")
    start: str = choice("Start", TABLE_ENDS, default=AT_REST, help="velocity and acceleration where it begins")
    end: str = choice("End", TABLE_ENDS, default=AT_REST, help="velocity and acceleration where it ends")
    limits: CurveLimits = placed(FileLayout(CurveLimits, single=True, whole=True), CurveLimits())
    vibration_free: tuple[float, ...] = placed(FileLayout(each=float), ())
    below: tuple[CurveBound, ...] = placed(FileLayout(CurveBound, whole=True, rows=True), ())
    above: tuple[CurveBound, ...] = placed(FileLayout(CurveBound, whole=True, rows=True), ())
    intervals: int = whole("Intervals", 1, 400, default=60, help="more of them approach the true optimum")
    points: tuple[SplinePoint, ...] = placed(FileLayout(SplinePoint, whole=True), ())
    machine: Machine | None = placed(FileLayout(in_file=False), None)

    @property
    def needs_machine(self) -> bool:
        """Whether it minimises an effect in its machine."""
        return self.minimise in OF_MACHINE


@frozen
class Machine:
    """The machine of an optimal law.

    Attributes
    ----------
    design : design of one drive, whose laws of least effect are those of least ``PLAIN``
    segment : number of the segment with the law
    """

    design: Any
    segment: int


@frozen
class ComputedCurve:
    """A curve computed from other parts: pieces over the span 0 ... 1, in the unit of the motion, from the segment's start.

    ``law`` names it in tables, such as the parts of a lobe's side.
    """

    pieces: tuple[Piece, ...] = placed(FileLayout(in_file=False))
    law: str = placed(FileLayout(in_file=False), "computed")


OPENING_SIDE, CLOSING_SIDE = "run-up, ramp, flank, nose", "nose, flank, ramp, run-down"
"""Names of both sides of a lobe, by their parts in the order of the cam angle."""


Curve = NamedCurve | SccaCurve | PolynomialCurve | SplineCurve | TableCurve | OptimalCurve | ComputedCurve
CURVES: Mapping[str, type[SccaCurve | PolynomialCurve | SplineCurve]] = MappingProxyType(
    {c.law: c for c in (SccaCurve, PolynomialCurve, SplineCurve, TableCurve, OptimalCurve)}
)
"""Law with further keys -> class of its curve; the curves of other laws are ``NamedCurve``."""


def is_joined(curve: Curve, end: str) -> bool:
    """Whether velocity and acceleration at the ``start`` or ``end`` of a curve are those of the neighbour."""
    return isinstance(curve, TableCurve | OptimalCurve) and getattr(curve, end) == JOINED


def needs_machine(curve: Curve) -> bool:
    """Whether a curve is optimal in its machine."""
    return isinstance(curve, OptimalCurve) and curve.needs_machine


def curve_of(law: str) -> Curve:
    """Default curve of a law."""
    return CURVES[law]() if law in CURVES else NamedCurve(law)


def _curve_class(table: Mapping[str, Any]) -> type[Curve]:
    law = table.get(LAW)
    return CURVES.get(law, NamedCurve) if isinstance(law, str) else NamedCurve


@frozen
class Segment:
    """One segment of the motion: cam span, rise (end minus start, in the unit of the motion), and curve.

    ``fixed``: the segment is a process window, whose span and law studies leave as they are unless they vary it themselves.
    """

    span_deg: float = number("Span", 1e-6, 360.0, step=1.0, help="cam angle of this segment")
    rise: float = number("Rise", help="end minus start; negative for a return", step=1.0, of_motion=True)
    curve: Curve = placed(FileLayout(NamedCurve, choose=_curve_class, brief=True), NamedCurve("dwell"))
    fixed: bool = brief(flag("Process window", help="studies keep its span and law, unless they vary it"))


@frozen
class TableOrigin:
    """A motion that is read from a table together with the design."""

    table: str = placed(FileLayout(missing="a file"))
    column: str = placed(FileLayout(brief=True), "")
    angle_column: str = placed(FileLayout(brief=True), "")


@frozen
class InverseOrigin:
    """The motion of a linkage's driver that gives an output link the motion in the design."""

    linkage: str = placed(FileLayout(missing="a design file with [linkage]"))
    output: str = placed(FileLayout(missing="the number of a link"))


@frozen
class Origin:
    """Linked files of a motion, one of these kinds; paths are relative to the folder of the design."""

    from_: TableOrigin | None = placed(FileLayout(TableOrigin, single=True), None)
    sum: tuple[str, ...] = placed(FileLayout(each=str), ())
    inverse: InverseOrigin | None = placed(FileLayout(InverseOrigin, single=True), None)

    @property
    def key(self) -> str:
        """Key in the table [motion]."""
        return "from" if self.from_ is not None else "inverse" if self.inverse is not None else "sum"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the files, as typed."""
        single = (
            self.inverse.linkage if self.inverse is not None else self.from_.table if self.from_ is not None else ""
        )
        return (single,) if single else self.sum


@frozen
class Follows:
    """Origin of a motion from linked files.

    Attributes
    ----------
    origin : as typed in a file of ``folder``
    folder : folder of the design
    asked : motion of the output, for the inverse of a linkage
    files : all files that were read
    made : (start, segments, advance) that were computed from them
    """

    origin: Origin
    folder: str
    asked: Any
    files: tuple[str, ...]
    made: Any = None


class LobeSegments(tuple[Segment, ...]):
    """Segments that follow from a lobe; an edit of a segment makes a plain tuple of them.

    Attributes
    ----------
    level : lift at cam angle 0 [mm]
    """

    level = 0.0


@lru_cache(maxsize=64)
def lobe_segments(lobe: Lobe) -> LobeSegments:
    """Rise, return and dwell of a lobe from cam angle 0 on; a dwell over the turn where its values make no lobe."""
    from core.design.lobe import lobe_sides  # imported here to save start-up time

    try:
        opening, closing = lobe_sides(lobe)
    except DesignError:
        return LobeSegments((Segment(360.0, 0.0),))
    sides = (
        Segment(opening.span, lobe.lift_mm, ComputedCurve(opening.pieces(), OPENING_SIDE)),
        Segment(closing.span, -lobe.lift_mm, ComputedCurve(closing.pieces(closing=True), CLOSING_SIDE)),
    )
    segments, level = from_zero(sides, lobe.nose_at_deg - opening.span)
    result = LobeSegments(segments)
    result.level = level
    return result


NO_SPAN = 1e-9  # a cut this near to an end of a segment is there [deg]


def from_zero(segments: Sequence[Segment], begin: float) -> tuple[tuple[Segment, ...], float]:
    """Turn with segments from a cam angle on, and a dwell over the rest, as segments from cam angle 0 on.

    Parameters
    ----------
    segments : sequence of Segment
        Of computed curves and dwells, whose rises add up to 0.
    begin : float
        Cam angle at which the first one starts [deg].

    Returns
    -------
    segments : tuple of Segment
    level : float
        Position at cam angle 0 above that at the start of the first segment.
    """
    rest = 360.0 - fsum(segment.span_deg for segment in segments)
    rows = [*segments, *([Segment(rest, 0.0)] if rest > NO_SPAN else [])]
    left, level = -begin % 360.0, 0.0
    for i, segment in enumerate(rows):
        if left <= NO_SPAN:
            return (*rows[i:], *rows[:i]), level
        if left < segment.span_deg - NO_SPAN:
            before, after = _cut(segment, left)
            return (after, *rows[i + 1 :], *rows[:i], before), level + before.rise
        left, level = left - segment.span_deg, level + segment.rise
    return tuple(rows), 0.0


def _cut(segment: Segment, span: float) -> tuple[Segment, Segment]:
    """Both parts of a segment of a computed curve, or of a dwell, that is cut at a span from its start [deg]."""
    rest = segment.span_deg - span
    if not isinstance(segment.curve, ComputedCurve):
        return Segment(span, 0.0), Segment(rest, 0.0)
    u = span / segment.span_deg
    pieces = split(segment.curve.pieces, u)
    level = float(PieceTable(pieces).at(np.array([u]))[0][0])
    first = stretched([piece for piece in pieces if piece.start < u], 0.0, 1.0 / u, 0.0, 1.0, 0.0)
    second = stretched([piece for piece in pieces if piece.start >= u], u, 1.0 / (1.0 - u), 0.0, 1.0, -level)
    return (
        Segment(span, level, replace(segment.curve, pieces=tuple(first))),
        Segment(rest, segment.rise - level, replace(segment.curve, pieces=tuple(second))),
    )


@frozen
class Motion:
    """Motion of the follower over one turn.

    Attributes
    ----------
    start : position at cam angle 0; of a lobe, off the lobe
    segments : in the order of the turn
    unit : ``mm`` for a slide, ``deg`` for a swing
    advance : displacement per turn of a feed or an indexer; None where the motion returns
    follows : linked files; None where the motion is typed
    lobe : lobe of a valve train that the segments follow from; None where they are typed
    """

    FILE_ORDER: ClassVar[tuple[str, ...]] = ("start", "advance", "lobe", "segments")

    start: float = number("Start", help="position at cam angle 0", of_motion=True)
    segments: tuple[Segment, ...] = placed(FileLayout(Segment), ())
    unit: str = placed(FileLayout(in_file=False), "mm")
    advance: float | None = number(
        "Advance", default=None, help="per turn, where the motion does not return: the sum of the rises", of_motion=True
    )

    follows: Follows | None = placed(FileLayout(in_file=False), None)

    lobe: Lobe | None = placed(FileLayout(Lobe, single=True), None)

    def __post_init__(self) -> None:
        if self.lobe is not None and (not self.segments or isinstance(self.segments, LobeSegments)):
            vars(self)["segments"] = lobe_segments(map_columns(self.lobe, one_design(0)))

    @property
    def first(self) -> float:
        """Position at cam angle 0: the start, above which a lobe may extend there."""
        return self.start + self.segments.level if isinstance(self.segments, LobeSegments) else self.start

    @property
    def is_computed(self) -> bool:
        """Whether the segments follow from linked files or a lobe, and are not typed."""
        return self.follows is not None or self.lobe is not None

    @property
    def is_as_linked(self) -> bool:
        """Whether it is typed, or is unchanged since it was computed from linked files or its lobe."""
        if self.lobe is not None and not isinstance(self.segments, LobeSegments):
            return False
        return self.follows is None or self.follows.made == (self.start, self.segments, self.advance)

    @property
    def derived(self) -> tuple[str, ...]:
        """Fields that follow from others, and that a file does not contain."""
        return () if self.lobe is None else ("segments",)

    @property
    def needs_machine(self) -> bool:
        """Whether a segment has a law that is optimal in its machine; linked motions keep the machine of their file."""
        return not self.is_computed and any(needs_machine(segment.curve) for segment in self.segments)

    @property
    def typed(self) -> Motion:
        """The motion without the machines of its laws, which follow from the design."""
        return self.with_curves(lambda i, curve: replace(curve, machine=None)) if self.needs_machine else self

    def in_machine(self, machine: Callable[[Motion], Any]) -> Motion:
        """The motion in the machine that a function makes of it, where its laws need one."""
        if not self.needs_machine:
            return self
        design = machine(self.with_curves(lambda i, curve: replace(curve, minimise=PLAIN, machine=None)))
        return self.with_curves(lambda i, curve: replace(curve, machine=Machine(design, i)))

    def with_curves(self, change: Callable[[int, OptimalCurve], OptimalCurve]) -> Motion:
        """The motion with changed laws, of those that are optimal in its machine."""
        rows = enumerate(self.segments)
        segments = (replace(s, curve=change(i, s.curve)) if needs_machine(s.curve) else s for i, s in rows)  # type: ignore[arg-type]
        return replace(self, segments=tuple(segments))

    @property
    def gain(self) -> float:
        """Sum of the rises: the advance per turn, 0 where the motion returns."""
        return self.advance or 0.0

    @property
    def scale(self) -> float:
        """Factor from the unit of the motion to SI."""
        return UNITS[self.unit].factor
