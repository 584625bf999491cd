"""Valve trains from a printed cam card: its values, its events in their three forms, and the design with both valves.

Card angles are crank degrees, centres are counted from TDC of overlap, positive for both valves: the inlet's after it, the
exhaust's before it. An event near TDC is the opening of the inlet before TDC, or the closing of the exhaust after it; one near
BDC is the closing of the inlet after BDC, or the opening of the exhaust before it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, replace
from math import ceil
from types import MappingProxyType
from typing import Any

from core.design import Design, faults
from core.design.camshaft import with_drives
from core.design.design import Drive
from core.design.engine import CRANK_PER_CAM, Lobe, LobeRow
from core.design.fields import Info, choice, info_of, length, number, unit_of
from core.design.lobe import lobe_sides
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.number_text import result_text
from core.project import from_table
from core.units import NO_UNIT, UNITS, Unit
from core.valves.pairs import valve_pairs
from core.valves.timing import LOBE, VALVE, valve_timings

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
        return _rounded((lift_mm + self._lash_mm(valve.lash_mm)) * self.motion_per_lift)

    def card_mm(self, lash_mm: float, motion_mm: float) -> float:
        """Lift of the card at a height of the motion, the inverse of ``motion_mm``."""
        return _rounded(motion_mm / self.motion_per_lift - self._lash_mm(lash_mm))

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


def _ramp_velocity(ramp_mm: float) -> float:
    """Velocity of a proposed ramp [mm/deg]."""
    return _rounded(DEFAULT_VELOCITY * ramp_mm / DEFAULT_RAMP)


def _rounded(value: float) -> float:
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


_SPRING = {
    "wire_mm": 3.8,
    "coil_mm": 24.0,
    "active_coils": 5.0,
    "total_coils": 7.0,
    "free_mm": 51.5,
    "installed_mm": 41.0,
}
_SPRINGS = {"valve_springs": [_SPRING]}
_CLOSED = {"angle_deg": 15.0, "clearance_mm": 6.0}  # position of the closed valve against the piston
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

# -- design from the card, and back -----------------------------------------------------------------------------

INLET, EXHAUST = "Inlet", "Exhaust"
_SPEED_RPM = 1000.0


def new_train(card: TrainCard) -> Design:
    """New design with the inlet and the exhaust of a card on one camshaft; its dimensions are marked as assumed.

    Raises
    ------
    DesignError
        With the faults of the values of the card.
    """
    row = card.row
    tables = {"follower": {"kind": row.kind, **row.follower}, "cam": row.cam, "loads": row.loads}
    lobe = {"lift_mm": 9.0, "duration": [[0.1524, 268.0], [1.27, 218.0]]}
    drive = {"motion": {"start_mm": 0.0, "lobe": lobe}, **tables}
    centres = {INLET: 108.0, EXHAUST: -108.0}
    engine = {"stroke_mm": 84.0, "rod_mm": 138.0}
    marks = [f"engine.{key}" for key in engine] + ["shaft.rotation", "shaft.speed_rpm"]
    assumed = {**tables, "valve": _CLOSED, "loads.valve_springs[0]": _SPRING}
    marks += [
        f"drives[{i}].{table}.{key}"
        for i in range(2)
        for table, values in assumed.items()
        for key, value in values.items()
        if isinstance(value, float)
    ]
    design = from_table(
        {
            "format": 1,
            "name": f"{row.label} valve train",
            "assumed": marks,
            "shaft": {"rotation": "ccw", "speed_rpm": _SPEED_RPM},
            "engine": engine,
            "drives": [
                {"name": name, **drive, "valve": {"centre_deg": centre, **_CLOSED}} for name, centre in centres.items()
            ],
        }
    )
    return with_card(design, card)


def with_card(design: Design, card: TrainCard) -> Design:
    """Design whose pair of valves has the values of a card: lobes, centres, lash, and the rocker ratio.

    Raises
    ------
    DesignError
        With the faults of the values.
    KindynaError
        Where the design has no such pair, see ``card_of``.
    """
    require_values(card)
    drives = list(design.drives)
    for index, valve, sense in zip(_pair_of(design), (card.inlet, card.exhaust), (1.0, -1.0), strict=True):
        drives[index] = _with_valve(drives[index], card, valve, sense)
    changed = with_drives(design, drives)
    if rows := faults(changed):
        raise DesignError(rows)
    return changed


def _with_valve(drive: Drive, card: TrainCard, valve: ValveCard, sense: float) -> Drive:
    assert drive.valve is not None
    assert drive.motion is not None
    lobe = card_lobe(card, valve, drive.motion.lobe or Lobe(lift_mm=1.0))
    follower: Any = drive.follower
    if (arm := card.row.arm) and abs(card.rocker_ratio - _ratio(drive, arm)) > 1e-9:
        follower = replace(follower, pad_mm=round(card.rocker_ratio * getattr(follower, arm), 6))
    return replace(
        drive,
        motion=replace(drive.motion, lobe=lobe),
        valve=replace(drive.valve, centre_deg=sense * valve.centre_deg, lash_mm=valve.lash_mm),
        mechanism=follower,
    )


def card_lobe(card: TrainCard, valve: ValveCard, before: Lobe) -> Lobe:
    """Lobe of a valve of a card, with the run-up, the flats and the position of another one."""
    ramp = card.ramp_mm(valve)
    velocity = _ramp_velocity(ramp) if valve.ramp_mm is None else before.ramp_mm_per_deg
    lobe = replace(
        valve.base or before,
        lift_mm=card.motion_mm(valve, valve.lift_mm),
        ramp_mm=ramp,
        ramp_mm_per_deg=velocity,
    )
    if valve.is_fixed:
        return lobe
    rows = tuple(
        LobeRow(card.motion_mm(valve, getattr(valve, f"{row}_at_mm")), valve.duration(row))
        for row in ROWS
        if f"{row}_deg" in valve.typed
    )
    scalars: dict[str, Any] = {
        name: _rounded(getattr(valve, name) * card.motion_per_lift) if name in valve.typed else None for name in SCALARS
    }
    return replace(lobe, duration=rows, to_nose=(), closing=None, **scalars)


def followed(card: TrainCard, design: Design | None = None) -> TrainCard:
    """The card with the values of its lobes that are not typed: durations, events, velocity and accelerations.

    A valve without a lobe keeps its values. ``design``: the one whose run-up and flats the lobes have.
    """
    befores: list[Lobe | None] = [None, None]
    if design is not None:
        motions = (design.drives[index].motion for index in _pair_of(design))
        befores = [motion.lobe if motion is not None else None for motion in motions]
    inlet, exhaust = (
        _followed(card, valve, before or Lobe(lift_mm=1.0), is_inlet=is_inlet)
        for valve, before, is_inlet in zip((card.inlet, card.exhaust), befores, (True, False), strict=True)
    )
    return replace(card, inlet=inlet, exhaust=exhaust)


def _followed(card: TrainCard, valve: ValveCard, before: Lobe, is_inlet: bool) -> ValveCard:
    try:
        opening, closing = lobe_sides(card_lobe(card, valve, before))
        near, far = (opening, closing) if is_inlet else (closing, opening)
        heights = [card.motion_mm(valve, getattr(valve, f"{row}_at_mm")) for row in ROWS]
        spans = [
            (CRANK_PER_CAM * near.distance(height), CRANK_PER_CAM * far.distance(height))
            if height > 0.0
            else (0.0, 0.0)
            for height in heights
        ]
    except (KindynaError, ValueError, ZeroDivisionError):
        return valve
    values: dict[str, Any] = {
        name: round(sum(span), 9)
        for name, span, height in zip(DURATIONS, spans, heights, strict=True)
        if 0.0 < height < opening.form.lift
    }
    scalars = (opening.velocity, opening.acceleration, opening.nose_acceleration)
    values |= {name: value / card.motion_per_lift for name, value in zip(SCALARS, scalars, strict=True)}
    values = {name: value for name, value in values.items() if valve.is_fixed or name not in valve.typed}
    first, second = (round(0.5 * (a - b), 9) if valve.is_fixed else 0.0 for a, b in spans)
    return replace(valve, skews_deg=(first, second), **values)


def require_values(card: TrainCard) -> None:
    """Check every number of a card. Raises DesignError with those that are outside their ranges."""
    rows = []
    for name, part in (("", card), ("inlet.", card.inlet), ("exhaust.", card.exhaust)):
        for field in fields(part):
            info, value = info_of(field), getattr(part, field.name)
            if info is not None and not info.admits(value):
                rows.append(Fault(f"{name}{field.name}", value, info.problem, info.allowed(unit_of(field))))
    if rows := rows or list(duration_faults(card)):
        raise DesignError(rows)


def duration_faults(
    card: TrainCard, lift_text: Callable[[float], str] = lambda lift_mm: f"{lift_mm:g} mm"
) -> Iterator[Fault]:
    """Faults of typed durations of which the one at the higher lift is not the shorter one; ``lift_text`` writes a lift."""
    for name, valve in (("inlet", card.inlet), ("exhaust", card.exhaust)):
        low, high = sorted(ROWS, key=lambda row: float(getattr(valve, f"{row}_at_mm")))
        lift, most = getattr(valve, f"{low}_at_mm"), valve.duration(low)
        is_typed = {*valve.typed} == {*DURATIONS} and not valve.is_fixed
        if is_typed and lift != getattr(valve, f"{high}_at_mm") and not valve.duration(high) < most:
            problem, allowed = f"not less than at {lift_text(lift)}", f"< {result_text(most)} deg"
            yield Fault(f"{name}.{high}_deg", valve.duration(high), problem, allowed)


def _ratio(drive: Drive, arm: str) -> float:
    follower: Any = drive.follower
    return float(follower.pad_mm / getattr(follower, arm))


def _pair_of(design: Design) -> tuple[int, int]:
    """Numbers of the drives of the first pair of valves. Raises KindynaError."""
    for pair in valve_pairs(valve_timings(design)) if design.has_valves else ():
        return pair.inlet.number, pair.exhaust.number
    raise KindynaError(
        "the design has no inlet and exhaust valve; allowed: two drives with [valve], centres > 0 and < 0"
    )


def card_of(design: Design) -> TrainCard:
    """Card of the first pair of valves of a design: lifts of the lobe, or of the valve where a rocker's motion is the valve's.

    Raises
    ------
    KindynaError
        Where the design has no such pair, or their lobes have no two durations.
    """
    indices = _pair_of(design)
    drives = [design.drives[index] for index in indices]
    trains = [_train_of(drive) for drive in drives]
    if trains[0] is None or trains[0] != trains[1]:
        raise KindynaError(
            "the valves are moved by no valve train that a card describes; allowed: two followers of a kind"
        )
    row = TRAINS[trains[0]]
    card = TrainCard(
        train=trains[0],
        of=row.of if all(map(_opens_at_rows, drives)) else LOBE,
        ratio=_rounded(_ratio(drives[0], row.arm)) if row.arm else None,
    )
    inlet, exhaust = (_valve_of(drive, card, sense) for drive, sense in zip(drives, (1.0, -1.0), strict=True))
    return replace(card, inlet=inlet, exhaust=exhaust)


def _opens_at_rows(drive: Drive) -> bool:
    """Whether the lash is taken up below all typed lifts of a lobe, so that they are lifts of the valve too."""
    lobe = drive.motion.lobe if drive.motion is not None else None
    return lobe is None or drive.valve is None or all(row.at_mm > drive.valve.lash_mm for row in lobe.duration)


def _train_of(drive: Drive) -> str | None:
    """Word of a drive's valve train, the one with most of its dimensions; None where it is none of these."""
    dimensions = {field.name for field in fields(drive.mechanism)}
    words = [word for word, row in TRAINS.items() if set(row.follower) <= dimensions]
    return max(words, key=lambda word: len(TRAINS[word].follower), default=None)


def _valve_of(drive: Drive, card: TrainCard, sense: float) -> ValveCard:
    assert drive.valve is not None
    assert drive.motion is not None
    lobe = drive.motion.lobe
    if lobe is None:
        raise KindynaError("a card needs lobes: both drives with [motion.lobe] in place of segments")
    lash, plain = drive.valve.lash_mm, ValveCard()
    is_fixed = bool(lobe.to_nose) or not lobe.is_symmetric
    rows = _rows_of(lobe.duration or lobe.to_nose)
    values: dict[str, Any] = {name: _card_scalar(card, getattr(lobe, name)) for name in SCALARS}
    for name, row in rows.items():
        values |= {f"{name}_at_mm": card.card_mm(lash, row.at_mm), f"{name}_deg": row.crank_deg}
    typed = [*(f"{name}_deg" for name in rows), *(name for name in SCALARS if values[name] is not None)]
    valve = replace(
        plain,
        lift_mm=card.card_mm(lash, lobe.lift_mm),
        lash_mm=lash,
        centre_deg=sense * drive.valve.centre_deg,
        base=lobe if is_fixed else None,
        typed=DURATIONS if is_fixed else (typed[0], typed[1]),
        **values,
    )
    ramp = card.ramp_mm(valve)
    is_proposed = (ramp, _ramp_velocity(ramp)) == (lobe.ramp_mm, lobe.ramp_mm_per_deg)
    valve = valve if is_proposed else replace(valve, ramp_mm=lobe.ramp_mm)
    return valve if valve.typed == DURATIONS and not is_fixed else _followed(card, valve, lobe, is_inlet=sense > 0.0)


def _card_scalar(card: TrainCard, value: float | None) -> float | None:
    """Velocity or acceleration of the card of that of a motion; None where none is typed."""
    return None if value is None else value / card.motion_per_lift


def _rows_of(typed: Sequence[LobeRow]) -> dict[str, LobeRow]:
    """Typed rows of a lobe by the rows of a card, the lower lift first; a single one is in the row with the nearer lift."""
    rows = sorted(typed, key=lambda row: row.at_mm)
    if len(rows) != 1:
        return dict(zip(ROWS, rows, strict=True)) if rows else {}
    return {ROWS[rows[0].at_mm > SINGLE_ROW]: rows[0]}
