"""Edits of the rows of loads, masses, forces and force elements: their order, attachments, and times of process forces."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design.camshaft import only
from core.design.design import Design, Drive
from core.design.linkage import FRAME_LINK, LinkForce, LinkMass
from core.design.load_rules import link_names, link_points, pairs_of, turning_links
from core.design.loads import Attachment, LoadPoint, PairFriction, PointSpring, Process, TorsionSpring, ValveSpring
from core.design.paths import all_paths, followed, get, put, row_at
from core.frozen import frozen

VALVE_SPRINGS = "valve_springs"


def load_lists(drive: Drive) -> tuple[str, ...]:
    """Keys of the lists in the table ``loads`` that a drive can have.

    Torsion springs need a link that turns, and valve springs a valve, where there are none yet.
    """
    names = tuple(name for name in NEW_ROWS if hasattr(drive.loads, name))
    if VALVE_SPRINGS in names and not (drive.has_valve or drive.loads.valve_springs):
        names = tuple(name for name in names if name != VALVE_SPRINGS)
    if "torsion_springs" not in names or drive.loads.torsion_springs or turning_links(drive):
        return names
    return tuple(name for name in names if name != "torsion_springs")


def with_new_row(design: Design, path: str, targets: Sequence[Target | None] = ()) -> Design:
    """Design with a default row at the end of a list of loads (``loads.springs``, ``drives[1].loads.process``).

    ``targets`` are its attachments in the order of ``HOLDS``; without them the row has default attachments.
    """
    _, number, inside = row_at(path, "drives")
    drive, name = (design if inside == path else only(design, number)).drive, path.rpartition(".")[2]
    rows = get(design, path)
    row = NEW_ROWS[name](drive, rows)
    for end, target in zip(HOLDS[name], targets, strict=False):
        row = end.put(row, target, drive)
    design = put(design, path, (*rows, row))
    if name == VALVE_SPRINGS and not rows:  # in place of rate and preload
        for key in ("spring_rate_n_per_mm", "preload_n"):
            design = put(design, f"{path.rpartition('.')[0]}.{key}", 0.0)
    return design


def with_rows_in_order(design: Design, path: str, order: Sequence[int]) -> Design:
    """Design with the rows of these numbers, in this order, and their assumed paths."""
    rows, marks = get(design, path), followed(design.assumed, path, order)
    changed = put(design, path, tuple(rows[i] for i in order))
    places = {mark: i for i, mark in enumerate(all_paths(changed))}
    return replace(changed, assumed=tuple(sorted(marks, key=lambda mark: places.get(mark, len(places)))))


# -- default rows --------------------------------------------------------------------------------------------


def _moving(drive: Drive) -> list[int]:
    return [n for n in link_names(drive) if n != FRAME_LINK]


def _free_point(drive: Drive) -> tuple[int, str]:
    """Last moving link with a point that the frame does not have, and the point."""
    points = link_points(drive)
    free = [(n, name) for n in _moving(drive) for name in points[n] if name not in points.get(FRAME_LINK, ())]
    return free[-1] if free else (_moving(drive)[-1], next(iter(points[_moving(drive)[-1]]), ""))


def _mass(drive: Drive, rows: Sequence[LinkMass]) -> LinkMass:
    """Mass of the first link without one."""
    used = {row.link for row in rows}
    return LinkMass(link=next((n for n in _moving(drive) if n not in used), _moving(drive)[0]), mass_kg=1.0)


def _force(drive: Drive, rows: Sequence[LinkForce]) -> LinkForce:
    link, point = _free_point(drive)
    return LinkForce(link=link, point=point, x_n=-100.0)


def _spring(drive: Drive, rows: Sequence[PointSpring]) -> PointSpring:
    """Spring from a point of the frame, outside of the links, to a moving point."""
    link, point = _free_point(drive)
    extent = max([100.0, *(abs(at) for row in drive.links for at in row.places.values())])
    fixed = Attachment(link=FRAME_LINK, x_mm=round(-0.5 * extent, 3), y_mm=round(-0.5 * extent, 3))
    return PointSpring(from_=fixed, to=Attachment(link=link, point=point), rate_n_per_mm=1.0)


def _friction(drive: Drive, rows: Sequence[PairFriction]) -> PairFriction:
    """Friction in the first pair without it."""
    pairs, used = pairs_of(drive), {row.pair for row in rows}
    if getattr(drive.loads, "friction", 0.0) > 0.0:
        used.add("guide")
    name = next((pair for pair in pairs if pair not in used), next(iter(pairs)))
    pin, links = pairs[name]
    named = sorted(links)[:2] if len(links) > 2 else (None, None)
    return PairFriction(pair=name, link=named[0], other=named[1], coefficient=0.1, radius_mm=_PIN_MM if pin else None)


def _process(drive: Drive, rows: Sequence[Process]) -> Process:
    """Process force over the first quarter of the turn."""
    if drive.is_linkage:
        link, point = _free_point(drive)
        return Process(cam_from_deg=0.0, cam_to_deg=90.0, link=link, point=point, direction_deg=0.0, force_n=-100.0)
    if drive.motion_unit == "deg":
        return Process(cam_from_deg=0.0, cam_to_deg=90.0, torque_nm=-1.0)
    return Process(cam_from_deg=0.0, cam_to_deg=90.0, force_n=-100.0)


NEW_ROWS: Mapping[str, Callable[[Drive, Any], Any]] = MappingProxyType(
    {
        "masses": _mass,
        "forces": _force,
        "springs": _spring,
        "torsion_springs": lambda drive, rows: TorsionSpring(
            link=(turning_links(drive) or _moving(drive))[-1], on=FRAME_LINK, rate_nm_per_rad=1.0
        ),
        "pair_friction": _friction,
        "process": _process,
        VALVE_SPRINGS: lambda drive, rows: ValveSpring(
            wire_mm=3.8, coil_mm=24.0, active_coils=5.0, total_coils=7.0, free_mm=51.5, installed_mm=41.0
        ),
    }
)
"""List of loads -> its default row, from the drive and the present rows."""

# -- attachments -----------------------------------------------------------------------------------------------

POINT, LINK, PAIR = "point", "link", "pair"
_PIN_MM = 5.0  # radius of a pin that gets friction


@frozen
class PairTarget:
    """A pair with friction: its name, and two links where its pin joins more than two."""

    pair: str
    link: int | None = None
    other: int | None = None


Target = Attachment | PairTarget
"""Attachment of a row of loads to the mechanism."""


@frozen
class AttachedEnd:
    """An end of a row of loads that is attached to the mechanism.

    Attributes
    ----------
    key : of the row's entry in the file
    label : on the form
    what : a point, a link or a pair
    frame : whether it may be attached to the frame
    free : whether it may be any point of a link, named or not; for a link: its point is retained
    output : whether it may be empty, so that the row acts on the output along its motion
    fields : (field of ``Attachment``, field of the row)
    """

    key: str
    label: str
    what: str
    frame: bool = False
    free: bool = False
    output: bool = False
    fields: tuple[tuple[str, str], ...] = ()

    def read(self, row: Any) -> Target | None:
        """Attachment of a row; None: the output."""
        if self.what == PAIR:
            return PairTarget(row.pair, row.link, row.other)
        if not self.fields:
            end: Attachment = getattr(row, f"{self.key}_" if hasattr(row, f"{self.key}_") else self.key)
            return end
        values = {name: getattr(row, field) for name, field in self.fields}
        return None if values["link"] is None else Attachment(**values)

    def put(self, row: Any, target: Target | None, drive: Drive) -> Any:
        """Row with another attachment; a force on a link gets a direction, friction in a pin a radius."""
        if isinstance(target, PairTarget):
            pin = pairs_of(drive)[target.pair][0]
            size = {"radius_mm": row.radius_mm or _PIN_MM, "length_mm": None} if pin else {"radius_mm": None}
            return replace(row, pair=target.pair, link=target.link, other=target.other, **size)
        if not self.fields:
            return replace(row, **{f"{self.key}_" if hasattr(row, f"{self.key}_") else self.key: target})
        values = {field: None if target is None else getattr(target, name) for name, field in self.fields}
        given = {field: value for field, value in values.items() if value is not None or self.what == POINT}
        result = replace(row, **given)
        if self.output and target is None:
            return replace(result, direction_deg=None)
        needs_direction = self.output and result.force_n and result.direction_deg is None
        return replace(result, direction_deg=0.0) if needs_direction else result


_AT_POINT = (("link", "link"), ("point", "point"))

HOLDS: Mapping[str, tuple[AttachedEnd, ...]] = MappingProxyType(
    {
        "masses": (AttachedEnd("link", "Link", LINK, free=True,
                        fields=(("link", "link"), ("x_mm", "centre_x_mm"), ("y_mm", "centre_y_mm"))),),
        "forces": (AttachedEnd("point", "Point", POINT, fields=_AT_POINT),),
        "springs": (AttachedEnd("from", "First end", POINT, frame=True, free=True),
                    AttachedEnd("to", "Second end", POINT, frame=True, free=True)),
        "torsion_springs": (AttachedEnd("link", "Link", LINK, frame=True, fields=(("link", "link"),)),
                            AttachedEnd("on", "On link", LINK, frame=True, fields=(("link", "on"),))),
        "pair_friction": (AttachedEnd("pair", "Pair", PAIR),),
        "process": (AttachedEnd("point", "Acts on", POINT, output=True, fields=_AT_POINT),),
        VALVE_SPRINGS: (),
    }
)  # fmt: skip
"""List of loads -> the attached ends of its rows."""


def holds_of(drive: Drive, name: str) -> tuple[AttachedEnd, ...]:
    """Attached ends of the rows of a list of loads in a drive; a linkage has no output."""
    return tuple(replace(end, output=end.output and not drive.is_linkage) for end in HOLDS[name])


def targets_for(drive: Drive, end: AttachedEnd) -> tuple[Target, ...]:
    """Named points, links or pairs to which an end can be attached, the frame first."""
    points = link_points(drive)
    links = [n for n in points if end.frame or n != FRAME_LINK]
    if end.what == LINK:
        return tuple(Attachment(link=n) for n in links)
    if end.what == PAIR:
        return tuple(_pair_targets(drive))
    return tuple(Attachment(link=n, point=name) for n in links for name in points[n])


def _pair_targets(drive: Drive) -> Iterator[PairTarget]:
    for name, (_, links) in pairs_of(drive).items():
        first, *rest = sorted(links)
        yield from (PairTarget(name, first, n) for n in rest) if len(links) > 2 else (PairTarget(name),)


def with_attachment(design: Design, path: str, key: str, target: Target | None) -> Design:
    """Design with another attachment of an end of a row of loads (``loads.springs[0]``)."""
    name = path.rpartition(".")[2].partition("[")[0]
    end = next(end for end in HOLDS[name] if end.key == key)
    return put(design, path, end.put(get(design, path), target, design.drive))


# -- times of a process force ----------------------------------------------------------------------------------

TURN_PART, MOTION_PART, TABLE = "turn", "motion", "table"
_POSITIONS = ("position_from_mm", "position_to_mm", "position_from_deg", "position_to_deg")
_NEVER: Mapping[str, Any] = MappingProxyType(
    {**dict.fromkeys(("cam_from_deg", "cam_to_deg", *_POSITIONS)), "points": ()}
)


def whens_of(drive: Drive) -> tuple[str, ...]:
    """Kinds of time at which a process force can act; a part of the motion only where there is a motion."""
    return (TURN_PART, *((MOTION_PART,) if drive.motion is not None else ()), TABLE)


def when_of(row: Process) -> str:
    """Kind of time at which a process force acts: a part of the turn, a part of the motion, or a table."""
    if row.points:
        return TABLE
    return MOTION_PART if any(getattr(row, key) is not None for key in _POSITIONS) else TURN_PART


def with_when(design: Design, path: str, when: str) -> Design:
    """Design with another kind of time of a process force (``loads.process[0]``), of the same size.

    It acts over the first quarter of the turn, in the upper half of the motion, or by a table over that quarter.
    """
    row: Process = get(design, path)
    size, changes = row.force_n or row.torque_nm, dict(_NEVER)
    if when == TABLE:
        changes |= {
            "points": tuple(
                LoadPoint(deg, value) for deg, value in ((0.0, size), (90.0, size), (91.0, 0.0), (359.0, 0.0))
            )
        }
        changes |= {"force_n": 0.0, "torque_nm": 0.0}
    elif when == MOTION_PART and design.drive.motion is not None:
        motion = design.drive.motion
        levels = [motion.first + sum(s.rise for s in motion.segments[:i]) for i in range(len(motion.segments) + 1)]
        low, high = min(levels), max(levels)
        changes |= {f"position_from_{motion.unit}": 0.5 * (low + high), f"position_to_{motion.unit}": high}
    else:
        changes |= {"cam_from_deg": 0.0, "cam_to_deg": 90.0}
    if row.points and when != TABLE:
        turns = row.direction_deg is None and (row.link is not None or design.drive.motion_unit == "deg")
        changes["torque_nm" if turns else "force_n"] = max((point.value for point in row.points), key=abs)
    return put(design, path, replace(row, **changes))


def with_table_row(design: Design, path: str, more: bool) -> Design:
    """Design with a row added to the table of a process force, in its widest gap, or without its last row; two rows remain."""
    row: Process = get(design, path)
    points = row.points
    if not points:
        return design
    if not more:
        return put(design, path, replace(row, points=points[:-1])) if len(points) > 2 else design
    ends = [point.deg for point in points[1:]] + [max(360.0, points[-1].deg)]
    gap = max(range(len(points)), key=lambda i: ends[i] - points[i].deg)
    after = points[(gap + 1) % len(points)].value
    middle = LoadPoint(0.5 * (points[gap].deg + ends[gap]), 0.5 * (points[gap].value + after))
    return put(design, path, replace(row, points=(*points[: gap + 1], middle, *points[gap + 1 :])))


def with_load_table(design: Design, path: str, points: tuple[LoadPoint, ...]) -> Design:
    """Design with another table of a process force, and no constant force or torque of it."""
    row: Process = get(design, path)
    return put(design, path, replace(row, points=points, force_n=0.0, torque_nm=0.0))
