"""Design of a valve train from a cam card, and the card of a design."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from typing import Any

from core.design import Design, faults
from core.design.camshaft import with_drives
from core.design.design import Drive
from core.design.engine import CRANK_PER_CAM, Lobe, LobeRow
from core.design.fields import info_of, unit_of
from core.design.lobe import lobe_sides
from core.errors import DesignError, Fault, KindynaError
from core.number_text import result_text
from core.project import from_table
from core.valves.cam_card import (
    CLOSED_VALVE,
    DURATIONS,
    ROWS,
    SCALARS,
    SINGLE_ROW,
    SPRING,
    TRAINS,
    TrainCard,
    ValveCard,
    ramp_velocity,
    rounded,
)
from core.valves.pairs import valve_pairs
from core.valves.timing import LOBE, valve_timings

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
    assumed = {**tables, "valve": CLOSED_VALVE, "loads.valve_springs[0]": SPRING}
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
                {"name": name, **drive, "valve": {"centre_deg": centre, **CLOSED_VALVE}}
                for name, centre in centres.items()
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
    velocity = ramp_velocity(ramp) if valve.ramp_mm is None else before.ramp_mm_per_deg
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
        name: rounded(getattr(valve, name) * card.motion_per_lift) if name in valve.typed else None for name in SCALARS
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


# -- card of a design ---------------------------------------------------------------------------------------------


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
        ratio=rounded(_ratio(drives[0], row.arm)) if row.arm else None,
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
    is_proposed = (ramp, ramp_velocity(ramp)) == (lobe.ramp_mm, lobe.ramp_mm_per_deg)
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
