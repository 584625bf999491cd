"""Rows of the loads added, removed and moved, and where each holds on: masses and forces of a linkage, and the force elements of any
design."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design.camshaft import only
from core.design.design import Design, Drive
from core.design.linkage import FRAME_LINK, LinkForce, LinkMass
from core.design.load_rules import link_names, link_points, pairs_of, turning_links
from core.design.loads import Attachment, LoadPoint, PairFriction, PointSpring, Process, TorsionSpring
from core.design.paths import all_paths, followed, get, put, row_at
from core.frozen import frozen


def load_lists(drive: Drive) -> tuple[str, ...]:
    """The lists of the loads that a drive can have, each as its key in the table ``loads``; torsion springs where a link turns, or
    where there are some."""
    found = tuple(name for name in NEW_ROWS if hasattr(drive.loads, name))
    if "torsion_springs" not in found or drive.loads.torsion_springs or turning_links(drive):
        return found
    return tuple(name for name in found if name != "torsion_springs")


def with_new_row(design: Design, path: str, held: Sequence[Held | None] = ()) -> Design:
    """One row more at the end of a list of the loads (``loads.springs``, ``drives[1].loads.process``), which acts at once on
    what is there; all of its values can be changed. held: where it holds on, in the order of ``HOLDS``; none: where it can."""
    _, number, inside = row_at(path, "drives")
    drive, name = (design if inside == path else only(design, number)).drive, path.rpartition(".")[2]
    rows = get(design, path)
    row = NEW_ROWS[name](drive, rows)
    for hold, at in zip(HOLDS[name], held, strict=False):
        row = hold.put(row, at, drive)
    return put(design, path, (*rows, row))


def with_rows_in_order(design: Design, path: str, order: Sequence[int]) -> Design:
    """The rows of these numbers, in this order: one less, moved, or twice; marks of what is assumed go with them."""
    rows, marks = get(design, path), followed(design.assumed, path, order)
    made = put(design, path, tuple(rows[i] for i in order))
    place = {each: i for i, each in enumerate(all_paths(made))}
    return replace(made, assumed=tuple(sorted(marks, key=lambda each: place.get(each, len(place)))))


# -- what a new row holds ------------------------------------------------------------------------------------


def _moving(drive: Drive) -> list[int]:
    return [n for n in link_names(drive) if n != FRAME_LINK]


def _free_point(drive: Drive) -> tuple[int, str]:
    """A moving link with a point that the frame does not have, the last one."""
    points = link_points(drive)
    found = [(n, name) for n in _moving(drive) for name in points[n] if name not in points.get(FRAME_LINK, ())]
    return found[-1] if found else (_moving(drive)[-1], next(iter(points[_moving(drive)[-1]]), ""))


def _mass(drive: Drive, rows: Sequence[LinkMass]) -> LinkMass:
    """On the first link without one."""
    having = {row.link for row in rows}
    return LinkMass(link=next((n for n in _moving(drive) if n not in having), _moving(drive)[0]), mass_kg=1.0)


def _force(drive: Drive, rows: Sequence[LinkForce]) -> LinkForce:
    link, point = _free_point(drive)
    return LinkForce(link=link, point=point, x_n=-100.0)


def _spring(drive: Drive, rows: Sequence[PointSpring]) -> PointSpring:
    """From beside the cam centre, or beside the frame's first point, to a point that moves."""
    link, point = _free_point(drive)
    beside = max([100.0, *(abs(at) for each in drive.links for at in each.places.values())])
    held = Attachment(link=FRAME_LINK, x_mm=round(-0.5 * beside, 3), y_mm=round(-0.5 * beside, 3))
    return PointSpring(from_=held, to=Attachment(link=link, point=point), rate_n_per_mm=1.0)


def _torsion(drive: Drive, rows: Sequence[TorsionSpring]) -> TorsionSpring:
    """Of the last link that turns, against the frame."""
    return TorsionSpring(link=(turning_links(drive) or _moving(drive))[-1], on=FRAME_LINK, rate_nm_per_rad=1.0)


def _friction(drive: Drive, rows: Sequence[PairFriction]) -> PairFriction:
    """In the first pair without it."""
    pairs, having = pairs_of(drive), {row.pair for row in rows}
    if getattr(drive.loads, "friction", 0.0) > 0.0:
        having.add("guide")
    name = next((each for each in pairs if each not in having), next(iter(pairs)))
    pin, links = pairs[name]
    named = sorted(links)[:2] if len(links) > 2 else (None, None)
    return PairFriction(pair=name, link=named[0], other=named[1], coefficient=0.1, radius_mm=_PIN_MM if pin else None)


def _process(drive: Drive, rows: Sequence[Process]) -> Process:
    """Over the first quarter of the turn."""
    if drive.is_linkage:
        link, point = _free_point(drive)
        return Process(cam_from_deg=0.0, cam_to_deg=90.0, link=link, point=point, direction_deg=0.0, force_n=-100.0)
    if drive.motion_unit == "deg":
        return Process(cam_from_deg=0.0, cam_to_deg=90.0, torque_nm=-1.0)
    return Process(cam_from_deg=0.0, cam_to_deg=90.0, force_n=-100.0)


NEW_ROWS: Mapping[str, Callable[[Drive, Any], Any]] = MappingProxyType(
    {
        "masses": _mass, "forces": _force, "springs": _spring, "torsion_springs": _torsion, "pair_friction": _friction,
        "process": _process,
    }
)  # fmt: skip
"""List of the loads -> its new row, from the drive and the rows that are there."""

# -- where a row holds on --------------------------------------------------------------------------------------

POINT, LINK, PAIR = "point", "link", "pair"
_PIN_MM = 5.0  # radius of a pin that gets friction


@frozen
class PairPlace:
    """A pair in which there may be friction: its name, and of a pin that joins more than two links the two of them."""

    pair: str
    link: int | None = None
    other: int | None = None


Held = Attachment | PairPlace


@frozen
class AttachedEnd:
    """A place at which a row of the loads holds on to the mechanism.

    key     of the row's entry in the file
    what    a point, a link or a pair
    frame   it may be on the frame
    free    it may be any place of a link, named or not; of a link: the place on it is kept
    output  it may be nowhere: then the row acts on the output along its motion
    fields  field of ``Attachment``, and the row's own
    """

    key: str
    label: str
    what: str
    frame: bool = False
    free: bool = False
    output: bool = False
    fields: tuple[tuple[str, str], ...] = ()

    def read(self, row: Any) -> Held | None:
        """Where a row holds on; None: on the output."""
        if self.what == PAIR:
            return PairPlace(row.pair, row.link, row.other)
        if not self.fields:
            end: Attachment = getattr(row, f"{self.key}_" if hasattr(row, f"{self.key}_") else self.key)
            return end
        values = {name: getattr(row, own) for name, own in self.fields}
        return None if values["link"] is None else Attachment(**values)

    def put(self, row: Any, held: Held | None, drive: Drive) -> Any:
        """The row that holds on there; a force that gets a link gets a direction, friction in a pin a radius."""
        if isinstance(held, PairPlace):
            pin = pairs_of(drive)[held.pair][0]
            size = {"radius_mm": row.radius_mm or _PIN_MM, "length_mm": None} if pin else {"radius_mm": None}
            return replace(row, pair=held.pair, link=held.link, other=held.other, **size)
        if not self.fields:
            return replace(row, **{f"{self.key}_" if hasattr(row, f"{self.key}_") else self.key: held})
        values = {own: None if held is None else getattr(held, name) for name, own in self.fields}
        made = replace(row, **{own: value for own, value in values.items() if value is not None or self.what == POINT})
        if self.output and held is None:
            return replace(made, direction_deg=None)
        return replace(made, direction_deg=0.0) if self.output and made.force_n and made.direction_deg is None else made


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
    }
)  # fmt: skip
"""List of the loads -> where its rows hold on."""


def holds_of(drive: Drive, name: str) -> tuple[AttachedEnd, ...]:
    """Where rows of a list of the loads hold on, in a drive: a linkage has no output along which a force could act."""
    return tuple(replace(hold, output=hold.output and not drive.is_linkage) for hold in HOLDS[name])


def places_for(drive: Drive, hold: AttachedEnd) -> tuple[Held, ...]:
    """All that has a name and where a row can hold on, frame first."""
    points = link_points(drive)
    links = [n for n in points if hold.frame or n != FRAME_LINK]
    if hold.what == LINK:
        return tuple(Attachment(link=n) for n in links)
    if hold.what == PAIR:
        return tuple(_pair_places(drive))
    return tuple(Attachment(link=n, point=name) for n in links for name in points[n])


def _pair_places(drive: Drive) -> Iterator[PairPlace]:
    for name, (_, links) in pairs_of(drive).items():
        first, *others = sorted(links)
        yield from (PairPlace(name, first, n) for n in others) if len(links) > 2 else (PairPlace(name),)


def with_held(design: Design, path: str, key: str, held: Held | None) -> Design:
    """The design in which a row of the loads (``loads.springs[0]``) holds on elsewhere at one of its places."""
    name = path.rpartition(".")[2].partition("[")[0]
    hold = next(hold for hold in HOLDS[name] if hold.key == key)
    return put(design, path, hold.put(get(design, path), held, design.drive))


# -- when a process force works --------------------------------------------------------------------------------

TURN_PART, MOTION_PART, TABLE = "turn", "motion", "table"
_POSITIONS = ("position_from_mm", "position_to_mm", "position_from_deg", "position_to_deg")
_NEVER: Mapping[str, Any] = MappingProxyType(
    {**dict.fromkeys(("cam_from_deg", "cam_to_deg", *_POSITIONS)), "points": ()}
)


def whens_of(drive: Drive) -> tuple[str, ...]:
    """When a process force can work: at a part of the motion only where there is one."""
    return (TURN_PART, *((MOTION_PART,) if drive.motion is not None else ()), TABLE)


def when_of(row: Process) -> str:
    """When it works: over a part of the turn, at a part of the motion, or as a table."""
    if row.points:
        return TABLE
    return MOTION_PART if any(getattr(row, key) is not None for key in _POSITIONS) else TURN_PART


def with_when(design: Design, path: str, when: str) -> Design:
    """The design in which a process force (``loads.process[0]``) works otherwise, as large as it was: over the first quarter of the
    turn, at the upper half of the motion, or by a table of its force over that quarter."""
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
        levels = [
            motion.start + sum(each.rise for each in motion.segments[:i]) for i in range(len(motion.segments) + 1)
        ]
        low, high = min(levels), max(levels)
        changes |= {f"position_from_{motion.unit}": 0.5 * (low + high), f"position_to_{motion.unit}": high}
    else:
        changes |= {"cam_from_deg": 0.0, "cam_to_deg": 90.0}
    if row.points and when != TABLE:
        turns = row.direction_deg is None and (row.link is not None or design.drive.motion_unit == "deg")
        changes["torque_nm" if turns else "force_n"] = max((point.value for point in row.points), key=abs)
    return put(design, path, replace(row, **changes))


def with_table_row(design: Design, path: str, more: bool) -> Design:
    """The design in which the table of a process force has one row more, in its widest gap, or without its last one; a table keeps
    two rows."""
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
    """The design in which a process force has this table, and no other force of its own."""
    row: Process = get(design, path)
    return put(design, path, replace(row, points=points, force_n=0.0, torque_nm=0.0))
