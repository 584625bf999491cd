"""What a plot shows; law icons."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache, partial
from math import isfinite, pi
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainter, QPolygonF

from core.cam import PRESSURE_LIMITS
from core.design import Curve as DesignCurve
from core.design import Design, PolynomialCurve, PolynomialEnd, Segment, SplineCurve, SplinePoint, TableCurve, curve_of
from core.errors import KindynaError
from core.frozen import frozen
from core.laws import PieceTable, find_law
from core.mechanism.kinematics import REVOLUTE
from core.motion.curves import segment_shape
from core.motion.extremes import Extremes
from core.output.channels import channels, existing
from core.stress import RollerLife
from core.study import STAGES, Quantity, Study, extremes_of, quantities_of, quantity, roller_lives
from core.study.limits import USER_BOUNDS, bounded_quantities
from core.study.member_quantities import gain_per_turn
from core.study.quantities import OF_MEMBERS, TRANSMISSION, member_of, names_of, shape_of
from core.study.quantity_requests import allowable_pressure
from core.units import split_unit
from kindyna_gui.labels import grouped, reason
from kindyna_gui.pictures.style import THIN, Theme, floor_of, shade, without_noise
from kindyna_gui.requirements import LED_BY_NO_CAM, why_no_pressure

# -- curves ----------------------------------------------------------------------------------------------


@frozen
class Limit:
    """A value not to be passed [SI], the text of its line, and the path where it is stated, or can be."""

    value: float
    text: str
    field: str


def _pressure_angle(study: Study) -> float:
    kinematics = study.linkage
    held = kinematics.pairs[kinematics.ground].kind if kinematics.ground else REVOLUTE
    return PRESSURE_LIMITS[held] * pi / 180.0


def _undercut(study: Study) -> float:
    """The pitch curvature whose radius is that of the roller; infinite for an edge."""
    radius: float = study.design.drive.face.radius_mm
    return 1e3 / radius if radius > 0.0 else np.inf


def _own(study: Study, quantity: str) -> Iterator[Limit]:
    """The user's own limits of a quantity, as far as stated."""
    for key, (_, bounds) in USER_BOUNDS.items():
        stated = getattr(study.design.drive.limits, key)
        if stated is not None and quantity in bounded_quantities(study.design, key):
            yield Limit(stated * split_unit(key)[1].factor, bounds.line, f"limits.{key}")


def _borne(study: Study) -> float:
    """The least pressure that a material of the contact bears [Pa]; infinite where none is known."""
    least = allowable_pressure(study)[0]
    return np.inf if least is None else least


_USUAL: Mapping[str, tuple[tuple[str, str, Callable[[Study], float]], ...]] = MappingProxyType(
    {
        "pressure_angle": (("usual limit {}", "limits.pressure_angle_rise_deg", _pressure_angle),),
        "pitch_curvature": (("undercut from {}", "cam.base_radius_mm", _undercut),),
        "contact_force": (
            (
                "lifts off below {}",
                "loads.least_contact_force_n",
                lambda study: np.inf if study.is_form_closed else 0.0,
            ),
        ),
        **dict.fromkeys(
            ("contact_pressure", "second_contact_pressure"), (("material bears {}", "cam.material", _borne),)
        ),
        "jam_factor": (("jams from {}", "loads.friction", lambda study: 1.0),),
    }
)


def limits_on(study: Study, quantity: str) -> list[Limit]:
    """The limits of a quantity of ``core.study``, the user's own after the usual ones. Where one is as large as another they are one
    line: of an own limit and a usual one the own, of two own ones both."""
    own: dict[float, Limit] = {}
    for limit in _own(study, quantity):
        other = own.get(limit.value)
        text = other.text.removesuffix(" {}") + " and " + limit.text.removeprefix("limit of ") if other else limit.text
        own[limit.value] = Limit(limit.value, text, other.field if other else limit.field)
    usual = (Limit(value(study), text, field) for text, field, value in _USUAL.get(quantity, ()))
    return [*(limit for limit in usual if np.isfinite(limit.value) and limit.value not in own), *own.values()]


@frozen(eq=False)
class Curve:
    """One curve: its channel, its values in the channel's unit (n,), its colour, the size below which values are zero, and what they
    grow by in a turn."""

    channel: Quantity
    values: np.ndarray
    colour: str
    floor: float = 0.0
    gain: float = 0.0

    def ends(self, found: Extremes) -> list[tuple[float, float]]:
        """Lowest and highest value of the channel, each as (cam angle [deg], value in its unit), of extremes in SI."""
        return [(float(np.rad2deg(end.theta)), end.value / self.channel.unit.factor) for end in (found.low, found.high)]

    def is_drawn_as(self, other: Curve) -> bool:
        return (
            self.channel == other.channel and self.colour == other.colour and np.array_equal(self.values, other.values)
        )


def read_curves(study: Study, channels: Sequence[Quantity], theme: Theme) -> list[Curve]:
    """The curves of these channels, those of one family in different shades. Raises NoSolution where one has none."""
    seen: dict[str, int] = {}
    curves: list[Curve] = []
    for row in channels:
        beside = next((curve for curve in curves if curve.channel.name == row.approximates), None)
        nth = seen[row.family] = seen.get(row.family, -1) + 1
        floor = floor_of(study, row)
        values = without_noise(row.values(study), floor)
        colour = theme.seen(shade(theme.family(row.family), nth)) if beside is None else beside.colour
        gain = gain_per_turn(study, row.name) / row.unit.factor
        curves.append(Curve(row, values, colour, floor, gain))
    return curves


def moving(study: Study) -> np.ndarray:
    """(n,) at which samples the mechanism moves: a dwell says nothing of what is usual for a curve; all where it always rests."""
    if "motion" not in study.stages:
        return np.ones(study.theta.size, dtype=bool)
    moves = study.motion.y[1] != 0.0
    return moves if moves.any() else ~moves


def channel_extremes(study: Study, channels: Sequence[Quantity]) -> dict[str, Extremes]:
    """Refined extremes of these channels by quantity, of those that have any; in SI."""
    found: dict[str, Extremes] = {}
    for stage in dict.fromkeys(row.stage for row in channels):
        names = tuple(row.name for row in channels if row.stage == stage and not row.approximates)
        with suppress(KindynaError):
            found |= extremes_of(study, stage, names) if names else {}
    return found


def limits_of(study: Study, channels: Sequence[Quantity]) -> list[tuple[float, tuple[str, str, str]]]:
    """Value, in the channels' unit, and text, short text and field of each limit, once where several channels have it; with the channel's
    name where only one of several has."""
    having: dict[tuple[float, str, str], list[str]] = {}
    for row in channels:
        for limit in limits_on(study, row.name):
            having.setdefault((limit.value / row.unit.factor, limit.text, limit.field), []).append(row.label)
    made = []
    for (value, text, field), labels in having.items():
        name = f"{labels[0]}: " if len(labels) == 1 and len(channels) > 1 else ""
        short = text.partition("{")[0].removesuffix("from ").removesuffix("below ").strip()
        made.append((value, (name + text, name + short, field)))
    return made


def drawn_alike(curves: Sequence[Curve], others: Sequence[Curve]) -> bool:
    """Whether two rows of curves give the same picture."""
    return len(curves) == len(others) and all(a.is_drawn_as(b) for a, b in zip(curves, others, strict=True))


def different(study: Study, rows: Sequence[Quantity]) -> list[Quantity]:
    """Those channels that no other before them equals, such as the motor's torque without a flywheel."""
    kept: list[Quantity] = []
    for row in rows:
        if not any(np.array_equal(row.values(study), other.values(study)) for other in kept):
            kept.append(row)
    return kept


# -- law icon --------------------------------------------------------------------------------------------

SAMPLES = 49  # angles on each piece of a law
SPAN = 90.0  # of the segment that is drawn, degrees
_EXAMPLES: Mapping[str, DesignCurve] = MappingProxyType(
    {
        "polynomial": PolynomialCurve(PolynomialEnd(), PolynomialEnd(velocity=0.02)),
        "table": TableCurve(
            tuple(SplinePoint(SPAN * u, u * u * (3.0 - 2.0 * u)) for u in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0))
        ),
        "spline": SplineCurve((SplinePoint(22.0, 0.55), SplinePoint(48.0, 0.3), SplinePoint(70.0, 0.8))),
    }
)
"""Examples drawn for the laws whose curve follows from their parameters alone."""


def _segment(slug: str) -> Segment:
    law = find_law(slug)
    rise = 0.0 if law is not None and law.is_dwell else -1.0 if law is not None and law.rises < 0 else 1.0
    return Segment(SPAN, rise, _EXAMPLES.get(slug) or curve_of(slug))


@lru_cache(maxsize=128)
def curves_of(slug: str) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Displacement and acceleration of a law over u = 0 ... 1, each (n,) places and (n,) values scaled to -1 ... 1:
    the displacement begins at 0, or ends there where the law is a return; the acceleration breaks where it jumps."""
    shape = segment_shape(_segment(slug), False, slug)
    table, starts = PieceTable(shape.pieces), [piece.start for piece in shape.pieces]
    places, rows = [], []
    for i, (start, end) in enumerate(zip(starts, [*starts[1:], 1.0], strict=True)):
        w = np.linspace(0.0, end - start, SAMPLES)
        places.append(start + w)
        row = table.rows(np.full(w.size, i), w)
        rows.append(shape.gain * np.array([row(0), row(2)]))
    u, (height, y2) = np.concatenate(places), np.concatenate(rows, axis=1)
    height += 1.0 if shape.gain < 0.0 else 0.0
    largest = float(np.abs(y2).max())
    acceleration = y2 / largest if largest > 1e-9 else np.zeros_like(u)
    return (u, height), (u, acceleration)


def prescribed(slug: str) -> tuple[tuple[float, float], ...]:
    """Points that the picture's curve is made to pass, (u, s) each."""
    curve = _EXAMPLES.get(slug)
    points = curve.points if isinstance(curve, SplineCurve) else ()
    return tuple((p.at_deg / SPAN, p.value) for p in points if p.value is not None)


def paint_law(painter: QPainter, box: QRectF, slug: str, theme: Theme) -> None:
    """Paint a law into a box: s from bottom to top, a about the middle."""
    displacement, acceleration = curves_of(slug)
    left, width, low, high, middle = box.left(), box.width(), box.bottom(), box.top(), box.center().y()
    painter.setPen(theme.pen(theme.faint))
    painter.drawLine(QPointF(left, middle), QPointF(box.right(), middle))
    painter.setPen(theme.pen(theme.family("acceleration"), 0.8))
    painter.setOpacity(0.7)
    # from the axis and back to it: a jump at an end is part of the law
    painter.drawPolyline(
        _polygon(
            np.concatenate(([0.0], acceleration[0], [1.0])),
            np.concatenate(([0.0], acceleration[1], [0.0])),
            left,
            width,
            middle,
            middle - high,
        )
    )
    painter.setOpacity(1.0)
    painter.setPen(theme.pen(theme.family("displacement"), 1.6))
    painter.drawPolyline(_polygon(*displacement, left, width, low, low - high))
    painter.setPen(theme.pen(theme.family("displacement"), THIN))
    painter.setBrush(theme.paper)
    for u, s in prescribed(slug):
        painter.drawRect(QRectF(left + u * width - 2.0, low - s * (low - high) - 2.0, 4.0, 4.0))


def _polygon(u: np.ndarray, v: np.ndarray, left: float, width: float, zero: float, height: float) -> QPolygonF:
    return QPolygonF([QPointF(x, y) for x, y in zip(left + u * width, zero - v * height, strict=True)])


# -- quantities ------------------------------------------------------------------------------------------

NO_TURN = 1e-9  # [rad] a link that turns less than this does not turn
MOST = 4  # curves in one plot that can still be told apart
Pick = Callable[[tuple[str, ...]], list[str]]


def _first(*wanted: str) -> Pick:
    return lambda names: [next((n for n in wanted if n in names), "")]


def _of(*shapes: str) -> Pick:
    """The names of the first of these shapes that has any."""
    return _or(*(partial(_shaped, shape) for shape in shapes))


def _shaped(shape: str, names: tuple[str, ...]) -> list[str]:
    return [n for n in names if shape_of(n) == shape]


def _or(*picks: Pick) -> Pick:
    """The names of the first pick that has any."""

    def pick(names: tuple[str, ...]) -> list[str]:
        chosen: list[str] = []
        for each in picks:
            chosen = chosen or [n for n in each(names) if n]
        return chosen

    return pick


_PLOTS: Mapping[str, Pick] = MappingProxyType(
    {
        "displacement": _or(_first("displacement"), _of("link.{}", "slide.{}")),
        "velocity": _or(_first("velocity"), _of("link.{}_velocity", "slide.{}_velocity")),
        "acceleration": _or(_first("acceleration"), _of("link.{}_acceleration", "slide.{}_acceleration")),
        "pressure_angle": _or(_first("pressure_angle"), _of(TRANSMISSION)),
        "pitch_curvature": _first("pitch_curvature", "profile_curvature"),
        "drive_torque": _first("drive_torque", "driver_torque", "driver_force", "force", "output_torque"),
        "contact_force": _or(_first("contact_force"), _of("force.{}_size"), _first("output_power")),
    }
)
"""First quantity of a plot of the window -> what it shows of a linkage: of those that turn, or where none does, of those that slide."""


def quantities_for(study: Study, usual: Sequence[str]) -> tuple[str, ...]:
    """The quantities of a plot: the usual ones that the design can have, or those that stand in their place."""
    possible = names_of(study.design)
    if usual[0] in possible:
        return tuple(n for n in usual if n in possible)
    pick = _PLOTS.get(usual[0])
    chosen = pick(_names(study)) if pick is not None else [n for n in usual if n in possible]
    return tuple([n for n in chosen if n][:MOST])


@lru_cache(maxsize=2)  # of the design in place and the one before: all plots ask
def _names(study: Study) -> tuple[str, ...]:
    """The quantities of a linkage worth a curve: without angles that go round, and links that never turn."""
    try:
        rows = quantities_of(study)
        turning = study.driver_ranges.angles
    except KindynaError:  # no mechanism yet, or none that can be assembled
        return ()
    at_rest = {str(n) for n, turn in turning.items() if np.ptp(turn.angle) < NO_TURN}
    links = {row.name for row in OF_MEMBERS["link"]}
    return tuple(
        n for n, row in rows.items() if not row.is_periodic and not (shape_of(n) in links and member_of(n) in at_rest)
    )


_TITLES: Mapping[str, str] = MappingProxyType(
    {
        "link.{}": "Angle",
        "link.{}_velocity": "Angular velocity",
        "link.{}_acceleration": "Angular accel.",
        "slide.{}": "Slide",
        "slide.{}_velocity": "Slide velocity",
        "slide.{}_acceleration": "Slide accel.",
        TRANSMISSION: "Transmission angle",
        "force.{}_size": "Joint forces",
        "force": "Force",
        "output_torque": "Torque",
        "output_power": "Power",
        "driver_torque": "Driver torque",
        "driver_force": "Driver force",
    }
)
"""Shape of a quantity's name -> what a plot of it is called."""


def title_for(design: Design, usual: str, title: str) -> str:
    """What a plot of the window is called: ``title`` where it shows its usual quantity, or nothing."""
    return _title(names_of(design), usual, title)


@lru_cache(maxsize=256)
def _title(possible: tuple[str, ...], usual: str, title: str) -> str:
    pick = _PLOTS.get(usual)
    if usual in possible or pick is None:
        return title
    chosen = next((name for name in pick(possible) if name), "")
    return _TITLES.get(shape_of(chosen), title)


def first_graph(study: Study) -> list[list[str]]:
    """The plots a new graph of a linkage begins with."""
    rows = (quantities_for(study, [name]) for name in ("displacement", "velocity", "acceleration"))
    return [list(row) for row in rows if row]


def why_empty(study: Study, usual: Sequence[str]) -> str:
    """Why a plot of the window is empty, in a sentence."""
    names = " nor ".join(name.replace("_", " ") for name in usual)
    name = usual[0].replace("_", " ")
    if usual[0] in ("pressure_angle", "pitch_curvature"):
        return f"{LED_BY_NO_CAM}there is no {name}."
    if usual[0] == "contact_pressure":
        return why_no_pressure(study)
    if usual[0] == "jerk":
        return "No motion drives this linkage: the graph shows what its links and points do."
    return f"This mechanism has no {names}."


def rows_of(study: Study, quantities: Iterable[str]) -> list[Quantity]:
    """The channels of these quantities that this kind of design can have, in the given order."""
    available = {row.name: row for row in channels(study.design)}
    return [available[name] for name in quantities if name in available]


def stages_of(quantities: Iterable[str]) -> tuple[str, ...]:
    """The stages that these quantities need, each once, in the order of a study."""
    wanted = {quantity(name).stage for name in quantities}
    return tuple(stage for stage in STAGES if stage in wanted)


def split(study: Study, rows: Sequence[Quantity]) -> tuple[list[Quantity], list[str]]:
    """Those rows that can be drawn, without any that equals one before it; and a line for each that is left out, but for
    what only stands beside another for comparison.

    Raises NoSolution where a stage that all of them need has none.
    """
    available = existing(study, rows)
    drawn = different(study, available)
    reasons = [why_missing(study, row) for row in rows if row not in available and not row.approximates]
    reasons += [f"{row.label} is the same curve" for row in available if row not in drawn and not row.approximates]
    return drawn, reasons


def figures_of(study: Study, usual: Sequence[str]) -> list[str]:
    """Lines of figures that belong to a plot of the window: below the contact pressure the life of the rollers."""
    return (
        [_life(each, len(roller_lives(study))) for each in roller_lives(study)]
        if usual[0] == "contact_pressure"
        else []
    )


def _life(life: RollerLife, of: int) -> str:
    which = f"the {life.roller} roller" if of > 1 else "the roller"
    if not isfinite(life.hours):
        return f"Nothing loads {which}"
    return f"Life of {which}, L10: {grouped(life.million_turns)} million turns, {grouped(life.hours)} h at {grouped(life.rpm)} rpm"


def why_missing(study: Study, row: Quantity) -> str:
    """Why this design has no such channel."""
    try:
        row.values(study)
    except KindynaError as error:
        return f"No {row.label[:1].lower()}{row.label[1:]}: {reason(study.design, error)}"
    return f"No {row.label[:1].lower()}{row.label[1:]} exists here"
