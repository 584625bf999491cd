"""What a plot reads from a study: the values of its channels, their colours, and the limits drawn as thin lines."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from math import pi
from types import MappingProxyType

import numpy as np

from core.cam import PRESSURE_LIMITS
from core.errors import KindynaError
from core.frozen import frozen
from core.mechanism.kinematics import REVOLUTE
from core.motion.extremes import Extremes
from core.study import Quantity, Study, extremes_of
from core.study.limits import USER_BOUNDS, bounded_quantities
from core.study.member_quantities import gain_per_turn
from core.study.quantity_requests import allowable_pressure
from core.units import split_unit
from kindyna_gui.pictures.sizes import floor_of, without_noise
from kindyna_gui.pictures.style import Theme, shade


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
