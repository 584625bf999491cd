"""A printed cam card: its values, its events in their three forms, and the kinds of valve trains.

Card angles are crank degrees, centres are counted from TDC of overlap, positive for both valves: the inlet's after it, the
exhaust's before it. An event near TDC is the opening of the inlet before TDC, or the closing of the exhaust after it; one near
BDC is the closing of the inlet after BDC, or the opening of the exhaust before it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from math import ceil
from types import MappingProxyType
from typing import Any

from core.design.engine import Lobe
from core.design.fields import Info, choice, info_of, length, number, unit_of
from core.frozen import frozen
from core.units import NO_UNIT, UNITS, Unit
from core.valves.timing import LOBE, VALVE

# -- events, in their three forms -------------------------------------------------------------------------------


def card_events(duration_deg: float, centre_deg: float) -> tuple[float, float]:
    """Events near TDC and near BDC [crank deg] of a duration about a centre: 270° at 112° is 23/67."""
    return 0.5 * duration_deg - centre_deg, 0.5 * duration_deg + centre_deg - 180.0


def duration_and_centre(near_tdc_deg: float, near_bdc_deg: float) -> tuple[float, float]:
    """Duration and centre [crank deg] of two events, the inverse of ``card_events``: 23/67 is 270° at 112°."""
    return near_tdc_deg + near_bdc_deg + 180.0, 0.5 * (near_bdc_deg - near_tdc_deg + 180.0)


def card_centres(separation_deg: float, advance_deg: float) -> tuple[float, float]:
    """Centres of inlet and exhaust [crank deg] of a lobe separation: 102° advanced by 4° is 98° and 106°."""
    return separation_deg - advance_deg, separation_deg + advance_deg


def separation_and_advance(inlet_deg: float, exhaust_deg: float) -> tuple[float, float]:
    """Lobe separation [cam deg] and advance [crank deg] of two centres, the inverse of ``card_centres``."""
    return 0.5 * (inlet_deg + exhaust_deg), 0.5 * (exhaust_deg - inlet_deg)


# -- the card ---------------------------------------------------------------------------------------------------


def _duration(default: float) -> Any:
    return number("Duration", 0.0, 720.0, open_low=True, default=default, step=1.0, help="in crank degrees")


def _of_lobe(label: str, step: float) -> Any:
    text = "by cam angle, of the lobe or the valve as the lifts; typed: it drives"
    return number(label, 0.0, open_low=True, default=None, step=step, help=text)


ROWS = ("first", "second")
DURATIONS = ("first_deg", "second_deg")
SCALARS = ("velocity_mm_per_deg", "acceleration_mm_per_deg2", "nose_acceleration_mm_per_deg2")
"""Names of the values of which two drive a lobe: its durations, its greatest velocity, and its accelerations."""


@frozen(kw_only=True)
class ValveCard:
    """What a card prints of one valve; lifts are those of the lobe or the valve, as the card counts.

    ``typed`` names the two values that drive the lobe, the last one typed behind; the others follow. ``base`` is the lobe of a
    design whose sides the card shows and keeps, because they differ or are given from the nose; ``skews_deg`` are then the
    differences of its sides, see ``skew``.
    """

    lift_mm: float = length("Lift", default=9.0, help="the greatest")
    lash_mm: float = number("Lash", 0.0, default=0.0, step=0.01, help="at the valve's tip")
    first_at_mm: float = length("At lift", default=0.1524, help="at which the first duration is measured")
    first_deg: float = _duration(268.0)
    second_at_mm: float = length("And at lift", default=1.27, help="at which the second duration is measured")
    second_deg: float = _duration(218.0)
    centre_deg: float = number(
        "Centre",
        0.0,
        360.0,
        open_low=True,
        default=108.0,
        step=1.0,
        help="crank angle from TDC of overlap to the greatest lift",
    )
    ramp_mm: float | None = length(
        "Ramp", default=None, help="height of the motion, with the lash, at which it ends; empty: from the lash"
    )
    velocity_mm_per_deg: float | None = _of_lobe("Greatest velocity", 0.01)
    acceleration_mm_per_deg2: float | None = _of_lobe("Flank acceleration", 0.001)
    nose_acceleration_mm_per_deg2: float | None = _of_lobe("Nose deceleration", 0.001)
    typed: tuple[str, str] = DURATIONS
    base: Lobe | None = None
    skews_deg: tuple[float, float] = (0.0, 0.0)

    @property
    def is_fixed(self) -> bool:
        """Whether the sides of the lobe are as in the design: they differ, or are given from the nose."""
        return self.base is not None

    def driven(self, name: str, value: float | None) -> ValveCard:
        """The card with a value that drives the lobe, together with the one of both that was typed last before."""
        values: dict[str, Any] = {name: value}
        if value is None:
            return replace(self, typed=DURATIONS, **values)
        others = [other for other in self.typed if other != name]
        return replace(self, typed=(others[-1], name), **values)

    def duration(self, row: str) -> float:
        """Duration of a row, ``first`` or ``second`` [crank deg]."""
        return float(getattr(self, f"{row}_deg"))

    def events(self, row: str) -> tuple[float, float]:
        """Events near TDC and near BDC at the lift of a row [crank deg]."""
        near, far = card_events(self.duration(row), self.centre_deg)
        skew = self.skew(row)
        return near + skew, far - skew

    def skew(self, row: str) -> float:
        """Half of what the side near TDC is longer than the other one, at the lift of a row [crank deg]."""
        return self.skews_deg[ROWS.index(row)]

    def with_events(self, row: str, near_tdc_deg: float, near_bdc_deg: float) -> ValveCard:
        """The card with both events of a row; the duration of the other row remains."""
        duration, centre = duration_and_centre(near_tdc_deg, near_bdc_deg)
        return replace(self, centre_deg=centre).driven(f"{row}_deg", duration)


@frozen(kw_only=True)
class TrainCard:
    """A cam card: kind of valve train, what its lifts are, and both valves."""

    train: str = choice("Valve train", ("direct", "finger", "rocker", "pushrod"), default="direct")
    of: str = choice("Lifts of", (LOBE, VALVE), default=LOBE, help="lash is taken off the lift of the valve")
    ratio: float | None = number("Rocker ratio", 0.0, 20.0, open_low=True, default=None)
    inlet: ValveCard = ValveCard()
    exhaust: ValveCard = ValveCard()

    @property
    def row(self) -> TrainRow:
        """Kind of the valve train."""
        return TRAINS[self.train]

    @property
    def rocker_ratio(self) -> float:
        """Rocker ratio: as on the card, else that of the kind."""
        return self.ratio or self.row.ratio

    @property
    def centres(self) -> tuple[float, float]:
        """Lobe separation and advance."""
        return separation_and_advance(self.inlet.centre_deg, self.exhaust.centre_deg)

    def with_centres(self, separation_deg: float, advance_deg: float) -> TrainCard:
        """The card with another separation and advance."""
        inlet, exhaust = card_centres(separation_deg, advance_deg)
        return replace(
            self,
            inlet=replace(self.inlet, centre_deg=inlet),
            exhaust=replace(self.exhaust, centre_deg=exhaust),
        )

    def with_valve(self, name: str, valve: ValveCard) -> TrainCard:
        """The card with another ``inlet`` or ``exhaust``."""
        return replace(self, inlet=valve) if name == "inlet" else replace(self, exhaust=valve)

    def overlap_deg(self, row: str) -> float:
        """Overlap of both valves at the lift of a row, ``first`` or ``second`` [crank deg]; negative: none."""
        return self.inlet.events(row)[0] + self.exhaust.events(row)[0]

    def motion_mm(self, valve: ValveCard, lift_mm: float) -> float:
        """Height of the motion at a lift of the card: of the valve where the motion is the valve's, else of the tappet."""
        return rounded((lift_mm + self._lash_mm(valve.lash_mm)) * self.motion_per_lift)

    def card_mm(self, lash_mm: float, motion_mm: float) -> float:
        """Lift of the card at a height of the motion, the inverse of ``motion_mm``."""
        return rounded(motion_mm / self.motion_per_lift - self._lash_mm(lash_mm))

    def _lash_mm(self, lash_mm: float) -> float:
        """Lash below the lifts of the card: none of those of the lobe."""
        return lash_mm if self.of == VALVE else 0.0

    @property
    def motion_per_lift(self) -> float:
        """Growth of the motion over that of the card's lift; velocities and accelerations of the card have it too."""
        if self.of == LOBE:
            return self.rocker_ratio if self.row.moves_valve else 1.0
        return 1.0 if self.row.moves_valve else 1.0 / self.rocker_ratio

    def ramp_mm(self, valve: ValveCard) -> float:
        """Height of the motion at which the ramp ends: as typed, else above the lash, so that the valve seats on the ramp."""
        if valve.ramp_mm is not None:
            return valve.ramp_mm
        lash = valve.lash_mm if self.row.moves_valve else valve.lash_mm / self.rocker_ratio
        return max(DEFAULT_RAMP, ceil(round(100.0 * (lash + ABOVE_LASH), 6)) / 100.0) if lash else DEFAULT_RAMP


DEFAULT_RAMP, DEFAULT_VELOCITY = 0.1, 0.01
"""Height [mm] and velocity [mm/deg] of the ramp without lash; a proposed ramp is as long, its velocity in proportion."""
SINGLE_ROW = 0.5
"""Lift above which a single duration is in the second row of a card [mm]."""
ABOVE_LASH = 0.02
"""Height of the proposed ramp above the lash, at least [mm]."""


def ramp_velocity(ramp_mm: float) -> float:
    """Velocity of a proposed ramp [mm/deg]."""
    return rounded(DEFAULT_VELOCITY * ramp_mm / DEFAULT_RAMP)


def rounded(value: float) -> float:
    """Value without the rounding of a conversion."""
    return round(value, 12)


# -- values of a valve on the card ------------------------------------------------------------------------------


@frozen
class CardValue:
    """A value of a card, or of a valve on it: its name and range, and the functions that read it and put it in."""

    info: Info
    unit: Unit
    read: Callable[[Any], float | None]
    write: Callable[[Any, Any], Any]


def _plain(name: str, info: Info, unit: Unit) -> CardValue:
    return CardValue(
        info, unit, lambda valve: getattr(valve, name), lambda valve, value: replace(valve, **{name: value})
    )


def _event(row: str, end: int, label: str) -> CardValue:
    """An event of a row; the other event remains, so that duration and centre follow."""

    def write(valve: ValveCard, value: float) -> ValveCard:
        ends = list(valve.events(row))
        ends[end] = value
        return valve.with_events(row, *ends)

    info = Info(label, "in crank degrees; negative: on the other side of it", -540.0, 540.0, step=1.0)
    return CardValue(info, UNITS["deg"], lambda valve: valve.events(row)[end], write)


def _driving(name: str, info: Info, unit: Unit) -> CardValue:
    """A value that drives the lobe once it is typed."""
    return CardValue(info, unit, lambda valve: getattr(valve, name), lambda valve, value: valve.driven(name, value))


VALVE_VALUES: Mapping[str, CardValue] = MappingProxyType(
    {
        part.name: (_driving if part.name in (*DURATIONS, *SCALARS) else _plain)(part.name, info, unit_of(part))
        for part in fields(ValveCard)
        if (info := info_of(part))
    }
    | {
        f"{row}_{end}": _event(row, i, label)
        for row in ROWS
        for i, (end, label) in enumerate((("near_tdc", "Event near TDC"), ("near_bdc", "Event near BDC")))
    }
)
"""Name -> value of a ValveCard: its fields, and the events ``first_near_tdc`` ... ``second_near_bdc``."""

TRAIN_VALUES: Mapping[str, CardValue] = MappingProxyType(
    {
        "ratio": CardValue(
            Info("Rocker ratio", "lift of the valve by that of the lobe", 0.0, 20.0, open_low=True, step=0.05),
            NO_UNIT,
            lambda card: card.rocker_ratio,
            lambda card, value: replace(card, ratio=value),
        ),
        "separation": CardValue(
            Info("Separation", "cam angle between both centres", 0.0, 360.0, open_low=True, step=1.0),
            UNITS["deg"],
            lambda card: card.centres[0],
            lambda card, value: card.with_centres(value, card.centres[1]),
        ),
        "advance": CardValue(
            Info(
                "Advance",
                "crank angle by which both lobes are earlier than with equal centres",
                -360.0,
                360.0,
                step=1.0,
            ),
            UNITS["deg"],
            lambda card: card.centres[1],
            lambda card, value: card.with_centres(card.centres[0], value),
        ),
    }
)
"""Name -> value of a TrainCard that concerns both valves."""

# -- kinds of valve trains --------------------------------------------------------------------------------------


@frozen(kw_only=True)
class TrainRow:
    """A kind of valve train.

    Attributes
    ----------
    label : its name
    kind : kind of follower
    follower, cam, loads : values of a new design, by the keys of its tables
    moves_valve : whether the motion is that of the valve, not of the tappet
    arm : key of the arm on the side of the cam; the pad's is in proportion to it by the rocker ratio. Empty: no rocker
    """

    label: str
    kind: str
    follower: Mapping[str, Any]
    cam: Mapping[str, float]
    loads: Mapping[str, Any]
    moves_valve: bool = True
    arm: str = ""

    @property
    def of(self) -> str:
        """What the lifts of its cards usually are: of the lobe, or of the valve where a rocker's motion is the valve's."""
        return VALVE if self.arm and self.moves_valve else LOBE

    @property
    def ratio(self) -> float:
        """Rocker ratio of a new design."""
        return float(self.follower["pad_mm"] / self.follower[self.arm]) if self.arm else 1.0


SPRING = {
    "wire_mm": 3.8,
    "coil_mm": 24.0,
    "active_coils": 5.0,
    "total_coils": 7.0,
    "free_mm": 51.5,
    "installed_mm": 41.0,
}
_SPRINGS = {"valve_springs": [SPRING]}
CLOSED_VALVE = {"angle_deg": 15.0, "clearance_mm": 6.0}
"""Position of the closed valve of a new design against the piston."""
_ROLLER = {"roller_mass_kg": 0.02, "roller_inertia_kg_m2": 8e-7}

TRAINS: Mapping[str, TrainRow] = MappingProxyType(
    {
        "direct": TrainRow(
            label="Direct", kind="translating", follower={"face": "flat"}, cam={"base_radius_mm": 18.0},
            loads={"follower_mass_kg": 0.14, **_SPRINGS},
        ),
        "finger": TrainRow(
            label="Finger", kind="rocker", arm="arm_mm",
            follower={"face": "roller", "arm_mm": 21.0, "pivot_x_mm": -18.0, "pivot_y_mm": -36.0, "side": "right",
                      "pad_mm": 39.9, "pad_angle_deg": -20.0, "pad_radius_mm": 12.0, "valve_direction_deg": -90.0},
            cam={"base_radius_mm": 17.0, "roller_radius_mm": 9.0},
            loads={"valve_mass_kg": 0.09, "rocker_inertia_kg_m2": 1.5e-5, **_ROLLER, **_SPRINGS},
        ),
        "rocker": TrainRow(
            label="Rocker", kind="rocker", arm="arm_mm",
            follower={"face": "roller", "arm_mm": 25.0, "pivot_x_mm": 25.0, "pivot_y_mm": 27.0, "side": "right",
                      "pad_mm": 37.5, "pad_angle_deg": 187.0, "pad_radius_mm": 12.0, "valve_direction_deg": -90.0},
            cam={"base_radius_mm": 18.0, "roller_radius_mm": 9.0},
            loads={"valve_mass_kg": 0.09, "rocker_inertia_kg_m2": 4e-5, **_ROLLER, **_SPRINGS},
        ),
        "pushrod": TrainRow(
            label="Pushrod", kind="pushrod", moves_valve=False, arm="push_arm_mm",
            follower={"face": "flat", "seat_x_mm": 8.0, "seat_y_mm": 0.0, "pushrod_mm": 208.0, "pivot_x_mm": 25.0,
                      "pivot_y_mm": 237.5, "push_arm_mm": 25.0, "side": "left", "pad_mm": 37.5, "pad_angle_deg": 180.0,
                      "pad_radius_mm": 12.0, "valve_direction_deg": -90.0},
            cam={"base_radius_mm": 18.0},
            loads={"valve_mass_kg": 0.1, "rocker_inertia_kg_m2": 6e-5, "tappet_mass_kg": 0.09, "pushrod_mass_kg": 0.06,
                   **_SPRINGS},
        ),
    }
)  # fmt: skip
"""Word of the card -> kind of valve train."""
