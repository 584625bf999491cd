"""Contents of plots: curves with their limits, the quantities of each plot of the window, and icons of laws."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from math import isfinite, pi
from types import MappingProxyType
from weakref import WeakKeyDictionary

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainter, QPolygonF

from core.cam import PRESSURE_LIMITS
from core.design import Curve as DesignCurve
from core.design import (
    CurveLimits,
    Design,
    OptimalCurve,
    PolynomialCurve,
    PolynomialEnd,
    Segment,
    SplineCurve,
    SplinePoint,
    TableCurve,
    curve_of,
)
from core.design.curves import segment_shape
from core.design.fields import in_sentence
from core.errors import KindynaError
from core.frozen import frozen
from core.laws import PieceTable, find_law
from core.mechanism.kinematics import REVOLUTE
from core.motion.extremes import Extremes
from core.output.channels import channels, existing
from core.stress import RollerLife
from core.study import STAGES, Quantity, Study, extremes_of, quantities_of, quantity, roller_lives
from core.study.limits import USER_BOUNDS, bounded_quantities
from core.study.member_quantities import gain_per_turn
from core.study.quantities import OF_MEMBERS, OF_MOTOR, TRANSMISSION, member_of, names_of, shape_of
from core.study.quantity_requests import allowable_pressure
from core.units import split_unit
from kindyna_gui.labels import reason
from kindyna_gui.pictures.style import THIN, Theme, shade
from kindyna_gui.pictures.units import short
from kindyna_gui.requirements import LINKAGE_WITHOUT_CAM, why_no_pressure

SAMPLES = 49  # angles on each piece of a law
SPAN = 90.0  # of the segment that an icon shows, degrees
NO_TURN = 1e-9  # [rad] a link with less rotation is at rest
MOST = 4  # curves in one plot that can be distinguished
Pick = Callable[[tuple[str, ...]], list[str]]
"""Function that selects quantities by name."""

# -- limits and curves -----------------------------------------------------------------------------------


@frozen
class Limit:
    """A limit of a quantity.

    Attributes
    ----------
    value : in SI
    text : of its line, with {} for the value
    field : path of the design field that states the limit, or could state it
    name : what it limits, where the text says what happens there
    """

    value: float
    text: str
    field: str
    name: str = ""

    @property
    def short(self) -> str:
        """Text without the value."""
        return self.name or self.text.partition("{")[0].strip()


def _pressure_angle(study: Study) -> float:
    """Typical limit of the pressure angle [rad]: of a sliding or a swinging follower."""
    kinematics = study.linkage
    pair = kinematics.pairs[kinematics.ground].kind if kinematics.ground else REVOLUTE
    return PRESSURE_LIMITS[pair] * pi / 180.0


def _undercut(study: Study) -> float:
    """Pitch curvature whose radius is the roller's [1/m]; infinite for a knife edge."""
    radius: float = study.design.drive.face.radius_mm
    return 1e3 / radius if radius > 0.0 else np.inf


def _allowable_pressure(study: Study) -> float:
    """Least allowable pressure of the materials in contact [Pa]; infinite where none is known."""
    least = allowable_pressure(study)[0]
    return np.inf if least is None else least


REPLACED = ("limits.", "cam.material")
"""Beginnings of the fields of typical limits that stated limits replace."""
_TYPICAL: Mapping[str, tuple[str, str, str, Callable[[Study], float]]] = MappingProxyType(
    {
        "pressure_angle": ("typical limit {}", "", "limits.pressure_angle_rise_deg", _pressure_angle),
        "pitch_curvature": ("undercut from {}", "limit of undercut", "cam.base_radius_mm", _undercut),
        "contact_force": (
            "lifts off below {}",
            "limit of lift-off",
            "loads.least_contact_force_n",
            lambda study: np.inf if study.is_form_closed else 0.0,
        ),
        **dict.fromkeys(
            ("contact_pressure", "second_contact_pressure"), ("allowable {}", "", "cam.material", _allowable_pressure)
        ),
        "jam_factor": ("jams from {}", "limit of jamming", "loads.friction", lambda study: 1.0),
    }
)
"""Quantity -> text, name, field and value [SI] of its typical limit."""


def limits_on(study: Study, quantity: str) -> list[Limit]:
    """Limits of a quantity: the typical ones, then those of the design.

    Equal limits give one line, and two of the design share their text. Where the design states every limit of the quantity, these
    replace the typical ones.
    """
    user_limits: dict[float, Limit] = {}
    keys = [key for key in USER_BOUNDS if quantity in bounded_quantities(study.design, key)]
    for key in keys:
        bounds, stated = USER_BOUNDS[key][1], getattr(study.design.drive.limits, key)
        if stated is None:
            continue
        value = stated * split_unit(key)[1].factor
        if equal := user_limits.get(value):
            text = equal.text.removesuffix(" {}") + " and " + bounds.line.removeprefix("limit of ")
            user_limits[value] = Limit(value, text, equal.field)
        else:
            user_limits[value] = Limit(value, bounds.line, f"limits.{key}")
    are_stated = keys and all(getattr(study.design.drive.limits, key) is not None for key in keys)
    rows = list(user_limits.values())
    if quantity in _TYPICAL:
        text, name, field, value_of = _TYPICAL[quantity]
        typical = Limit(value_of(study), text, field, name)
        is_replaced = (are_stated and field.startswith(REPLACED)) or typical.value in user_limits
        rows = rows if is_replaced or not np.isfinite(typical.value) else [typical, *rows]
    return rows


@frozen(eq=False)
class Curve:
    """A curve of a plot.

    Attributes
    ----------
    channel : Quantity
    values : ndarray (n,), in the channel's unit
    colour : of its line
    floor : size below which a value counts as zero
    gain : increase of the values in one turn
    """

    channel: Quantity
    values: np.ndarray
    colour: str
    floor: float = 0.0
    gain: float = 0.0

    def shown(self, value: float, size: float) -> float:
        """Value on an axis whose unit is ``size`` of the channel's; zero below the floor."""
        return 0.0 if abs(value) <= self.floor else value / size

    def ends(self, extremes: Extremes) -> list[tuple[float, float]]:
        """Lowest and highest value, (cam angle [deg], value in the channel's unit), of extremes in SI."""
        return [
            (float(np.rad2deg(end.theta)), end.value / self.channel.unit.factor)
            for end in (extremes.low, extremes.high)
        ]


_VALUES: WeakKeyDictionary[Study, dict[str, np.ndarray]] = WeakKeyDictionary()


def values_of(study: Study, row: Quantity) -> np.ndarray:
    """Values of a channel (n,) [its unit], computed once for each study."""
    known = _VALUES.setdefault(study, {})
    if row.name not in known:
        known[row.name] = row.values(study)
    return known[row.name]


def read_curves(study: Study, channels: Sequence[Quantity], theme: Theme) -> list[Curve]:
    """Curves of these channels, those of one family in different shades.

    Raises
    ------
    NoSolution
        Where a quantity has no solution.
    """
    family_counts: dict[str, int] = {}
    curves: list[Curve] = []
    for row in channels:
        exact = next((curve for curve in curves if curve.channel.name == row.approximates), None)
        nth = family_counts[row.family] = family_counts.get(row.family, -1) + 1
        colour = theme.seen(shade(theme.family(row.family), nth)) if exact is None else exact.colour
        curves.append(_read_curve(study, row, colour))
    return curves


def counterparts(study: Study, rows: Iterable[Quantity]) -> dict[str, Quantity]:
    """Quantities of another study with the names and units of these, by name."""
    units = {row.name: row.unit.symbol for row in rows}
    return {row.name: row for row in existing(study, rows_of(study, units)) if row.unit.symbol == units[row.name]}


def reference_curves(study: Study | None, curves: Sequence[Curve]) -> list[Curve]:
    """Curves of another study in the colours of these curves; those that it lacks are omitted."""
    if study is None:
        return []
    rows = counterparts(study, [curve.channel for curve in curves])
    pairs = ((rows.get(curve.channel.name), curve.colour) for curve in curves)
    return [_read_curve(study, row, colour) for row, colour in pairs if row is not None]


def _read_curve(study: Study, row: Quantity, colour: str) -> Curve:
    from core.output.drawing.turn import ROUNDING, floor_of, without_noise  # imported here to save start-up time

    values = values_of(study, row)
    floor = max(floor_of(study, row), ROUNDING * float(np.abs(values).max(initial=0.0, where=np.isfinite(values))))
    gain = gain_per_turn(study, row.name) / row.unit.factor
    return Curve(row, without_noise(values, floor), colour, floor, gain)


def channel_extremes(study: Study, channels: Sequence[Quantity]) -> dict[str, Extremes]:
    """Refined extremes by quantity [SI], of the channels that have any."""
    extremes: dict[str, Extremes] = {}
    for stage in dict.fromkeys(row.stage for row in channels):
        names = tuple(row.name for row in channels if row.stage == stage and not row.approximates)
        with suppress(KindynaError):
            extremes |= extremes_of(study, stage, names) if names else {}
    return extremes


def limits_of(study: Study, channels: Sequence[Quantity]) -> list[tuple[float, tuple[str, str, str]]]:
    """Limits of several channels of one unit, each once.

    Returns
    -------
    list of (value, (text, short_text, field))
        The value is in the channels' unit. The texts name the channel where only one of several has the limit.
    """
    labels_by_limit: dict[tuple[float, Limit], list[str]] = {}
    for row in channels:
        for limit in limits_on(study, row.name):
            labels_by_limit.setdefault((limit.value / row.unit.factor, limit), []).append(row.label)
    result = []
    for (value, limit), labels in labels_by_limit.items():
        name = f"{labels[0]}: " if len(labels) == 1 and len(channels) > 1 else ""
        result.append((value, (name + limit.text, name + limit.short, limit.field)))
    return result


def drawn_alike(curves: Sequence[Curve], others: Sequence[Curve]) -> bool:
    """Whether two lists of curves look the same."""
    return len(curves) == len(others) and all(
        a.channel == b.channel and a.colour == b.colour and np.array_equal(a.values, b.values)
        for a, b in zip(curves, others, strict=True)
    )


def without_equal_curves(study: Study, rows: Sequence[Quantity]) -> list[Quantity]:
    """Channels without those that equal an earlier one, such as the motor's torque without a flywheel."""
    result: list[Quantity] = []
    for row in rows:
        if not any(np.array_equal(values_of(study, row), values_of(study, earlier)) for earlier in result):
            result.append(row)
    return result


# -- icons of laws ---------------------------------------------------------------------------------------

_EXAMPLES: Mapping[str, DesignCurve] = MappingProxyType(
    {
        "polynomial": PolynomialCurve(PolynomialEnd(), PolynomialEnd(velocity=0.02)),
        "table": TableCurve(
            tuple(SplinePoint(SPAN * u, u * u * (3.0 - 2.0 * u)) for u in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0))
        ),
        "optimal": OptimalCurve(limits=CurveLimits(jerk=48.0), intervals=24),
        "spline": SplineCurve((SplinePoint(22.0, 0.55), SplinePoint(48.0, 0.3), SplinePoint(70.0, 0.8))),
    }
)
"""Law -> example that its icon shows, for laws that have no curve without parameters."""


def _segment(slug: str) -> Segment:
    law = find_law(slug)
    rise = 0.0 if law is not None and law.is_dwell else -1.0 if law is not None and law.rises < 0 else 1.0
    return Segment(SPAN, rise, _EXAMPLES.get(slug) or curve_of(slug))


@lru_cache(maxsize=128)
def curves_of(slug: str) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Displacement and acceleration of a law over u = 0 ... 1.

    Returns
    -------
    displacement, acceleration : tuple of ndarray (n,), dimensionless
        u and the value, scaled to -1 ... 1. A rise starts at 0, a return ends there. Where the acceleration jumps,
        u occurs twice.
    """
    shape = segment_shape(_segment(slug), False, slug)
    table, starts = PieceTable(shape.pieces), [piece.start for piece in shape.pieces]
    u_parts, rows = [], []
    for i, (start, end) in enumerate(zip(starts, [*starts[1:], 1.0], strict=True)):
        w = np.linspace(0.0, end - start, SAMPLES)
        u_parts.append(start + w)
        row = table.rows(np.full(w.size, i), w)
        rows.append(shape.gain * np.array([row(0), row(2)]))
    u, (height, y2) = np.concatenate(u_parts), np.concatenate(rows, axis=1)
    height += 1.0 if shape.gain < 0.0 else 0.0
    largest = float(np.abs(y2).max())
    acceleration = y2 / largest if largest > 1e-9 else np.zeros_like(u)
    return (u, height), (u, acceleration)


def prescribed(slug: str) -> tuple[tuple[float, float], ...]:
    """Prescribed points of the icon's curve, (u, s)."""
    curve = _EXAMPLES.get(slug)
    points = curve.points if isinstance(curve, SplineCurve) else ()
    return tuple((p.at_deg / SPAN, p.value) for p in points if p.value is not None)


def paint_law(painter: QPainter, box: QRectF, slug: str, theme: Theme) -> None:
    """Paint the icon of a law into a box: displacement from bottom to top, acceleration about the middle."""
    displacement, acceleration = curves_of(slug)
    left, width, low, high, middle = box.left(), box.width(), box.bottom(), box.top(), box.center().y()
    painter.setPen(theme.pen(theme.faint))
    painter.drawLine(QPointF(left, middle), QPointF(box.right(), middle))
    painter.setPen(theme.pen(theme.family("acceleration"), 0.8))
    painter.setOpacity(0.7)
    # starts and ends on the axis, so that a jump at an end is seen
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


# -- quantities of the plots -----------------------------------------------------------------------------


def _first(*candidates: str) -> Pick:
    """Pick the first candidate that the design has."""
    return lambda names: [next((n for n in candidates if n in names), "")]


def _of(*shapes: str) -> Pick:
    """Pick all quantities of the first shape that the design has."""
    return lambda names: next(filter(None, ([n for n in names if shape_of(n) == shape] for shape in shapes)), [])


def _or(*picks: Pick) -> Pick:
    """Pick what the first pick gives that is not empty."""
    return lambda names: next(filter(None, ([n for n in pick(names) if n] for pick in picks)), [])


_PLOTS: Mapping[str, Pick] = MappingProxyType(
    {
        "displacement": _or(_first("displacement"), _of("link.{}", "slide.{}")),
        "velocity": _or(_first("velocity"), _of("link.{}_velocity", "slide.{}_velocity")),
        "acceleration": _or(_first("acceleration"), _of("link.{}_acceleration", "slide.{}_acceleration")),
        "pressure_angle": _or(_first("pressure_angle"), _of(TRANSMISSION)),
        "pitch_curvature": _first("pitch_curvature", "profile_curvature", "surface_curvature"),
        "contact_pressure": _first("contact_pressure", "roller_pv"),
        "drive_torque": _first("drive_torque", "driver_torque", "driver_force", "force", "output_torque"),
        "contact_force": _or(_first("contact_force"), _of("force.{}_size"), _first("output_power")),
    }
)
"""First quantity of a plot -> what it shows of a linkage: its links' rotation or, where none rotates, its slides."""


def quantities_for(study: Study, default: Sequence[str]) -> tuple[str, ...]:
    """Quantities of a plot: the default ones that the design has, or their replacements for a linkage."""
    possible = names_of(study.design)
    if default[0] in possible:
        return tuple(n for n in default if n in possible)
    pick = _PLOTS.get(default[0])
    selected = pick(_names(study)) if pick is not None else [n for n in default if n in possible]
    return tuple([n for n in selected if n][:MOST])


@lru_cache(maxsize=2)  # the current design and the one before, for all plots
def _names(study: Study) -> tuple[str, ...]:
    """Quantities of a linkage worth a curve: without angles that increase steadily, and links at rest."""
    try:
        rows = quantities_of(study)
        rotations = study.driver_ranges.angles
    except KindynaError:  # no mechanism yet, or none that can be assembled
        return ()
    at_rest = {str(n) for n, rotation in rotations.items() if np.ptp(rotation.angle) < NO_TURN}
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
        "roller_pv": "PV of the roller",
        "surface_curvature": "Curvature",
        "driver_torque": "Driver torque",
        "driver_force": "Driver force",
    }
)
"""Shape of a quantity's name -> title of its plot."""


def title_for(design: Design, default: str, title: str) -> str:
    """Title of a plot: ``title`` where it shows its default quantity, or nothing."""
    return _title(names_of(design), default, title)


@lru_cache(maxsize=256)
def _title(possible: tuple[str, ...], default: str, title: str) -> str:
    pick = _PLOTS.get(default)
    if default in possible or pick is None:
        return title
    selected = next((name for name in pick(possible) if name), "")
    return _TITLES.get(shape_of(selected), title)


def first_graph(study: Study) -> list[list[str]]:
    """Quantities of each plot in a new graph of a linkage."""
    rows = (quantities_for(study, [name]) for name in ("displacement", "velocity", "acceleration"))
    return [list(row) for row in rows if row]


def why_empty(study: Study, default: Sequence[str]) -> str:
    """Sentence that says why a plot is empty."""
    names = " nor ".join(name.replace("_", " ") for name in default)
    if default[0] in ("pressure_angle", "pitch_curvature"):
        return f"{LINKAGE_WITHOUT_CAM}there is no {default[0].replace('_', ' ')}."
    if default[0] == "contact_pressure":
        return why_no_pressure(study)
    if default[0] == "jerk":
        return "No motion drives this linkage. The graph shows the motion of its links and points."
    return f"This mechanism has no {names}."


def rows_of(study: Study, quantities: Iterable[str]) -> list[Quantity]:
    """Channels of these quantities that this kind of design can have, in the given order."""
    names = tuple(quantities)
    available = {row.name: row for row in channels(study.design)} if names else {}
    return [available[name] for name in names if name in available]


def stages_of(quantities: Iterable[str]) -> tuple[str, ...]:
    """Stages that these quantities need, in the order of a study."""
    needed = {quantity(name).stage for name in quantities}
    return tuple(stage for stage in STAGES if stage in needed)


def needs_flywheel(study: Study, quantities: Iterable[str]) -> bool:
    """Whether some of these quantities need the steady speed of the flywheel, which takes longer than any other result."""
    return study.levels_torque and not OF_MOTOR.isdisjoint(quantities)


def split(study: Study, rows: Sequence[Quantity]) -> tuple[list[Quantity], list[str]]:
    """Split channels into those to draw and reasons why the others are omitted.

    A channel that equals an earlier one is omitted too. An approximation for comparison is omitted without a reason.

    Raises
    ------
    NoSolution
        Where a stage that all channels need has no solution.
    """
    available = existing(study, rows)
    drawn = without_equal_curves(study, available)
    reasons = [why_missing(study, row) for row in rows if row not in available and not row.approximates]
    reasons += [
        f"{row.label} equals a curve that is shown" for row in available if row not in drawn and not row.approximates
    ]
    return drawn, reasons


def figures_of(study: Study, default: Sequence[str]) -> list[str]:
    """Lines of figures below a plot: for the contact pressure the life of the rollers."""
    lives = roller_lives(study) if default[0] == "contact_pressure" else ()
    return [_life(life, f"the {life.roller} roller" if len(lives) > 1 else "the roller") for life in lives]


def _life(life: RollerLife, roller: str) -> str:
    if not isfinite(life.hours):
        return f"Nothing loads {roller}"
    return f"Life of {roller}, L10: {short(life.million_turns)} million turns, {short(life.hours)} h at {short(life.rpm)} rpm"


def why_missing(study: Study, row: Quantity) -> str:
    """Sentence that says why this design has no such channel."""
    label = in_sentence(row.label)
    try:
        row.values(study)
    except KindynaError as error:
        return f"No {label}: {reason(study.design, error)}"
    return f"This design has no {label}"
