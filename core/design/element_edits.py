"""Rows of the loads added, removed and moved: masses and forces of a linkage, and the force elements of any design."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design.camshaft import only
from core.design.element_rules import link_names, link_points, pairs_of
from core.design.elements import Attachment, PairFriction, PointSpring, Process, TorsionSpring
from core.design.linkage import FRAME_LINK, LinkForce, LinkMass
from core.design.paths import all_paths, get, put
from core.design.whole import Design, Drive

_IN_DRIVE = re.compile(r"drives\[(\d+)\]\.")


def load_lists(drive: Drive) -> tuple[str, ...]:
    """The lists of the loads that a drive can have, each as its key in the table ``loads``."""
    return tuple(name for name in NEW_ROWS if hasattr(drive.loads, name))


def with_new_row(design: Design, path: str) -> Design:
    """One row more at the end of a list of the loads (``loads.springs``, ``drives[1].loads.process``), which acts at once on
    what is there; all of its values can be changed."""
    number = _IN_DRIVE.match(path)
    drive = (only(design, int(number[1])) if number else design).drive
    rows = get(design, path)
    return put(design, path, (*rows, NEW_ROWS[path.rpartition(".")[2]](drive, rows)))


def with_rows_in_order(design: Design, path: str, order: Sequence[int]) -> Design:
    """The rows of these numbers, in this order: one less, moved, or twice; marks of what is assumed go with them."""
    rows, marks = get(design, path), []
    for mark in design.assumed:
        match = re.match(rf"{re.escape(path)}\[(\d+)\]", mark)
        if match is None:
            marks.append(mark)
        else:
            marks += [f"{path}[{new}]{mark[match.end() :]}" for new, old in enumerate(order) if old == int(match[1])]
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
    return TorsionSpring(link=_moving(drive)[-1], on=FRAME_LINK, rate_nm_per_rad=1.0)


def _friction(drive: Drive, rows: Sequence[PairFriction]) -> PairFriction:
    """In the first pair without it."""
    pairs, having = pairs_of(drive), {row.pair for row in rows}
    if getattr(drive.loads, "friction", 0.0) > 0.0:
        having.add("guide")
    name = next((each for each in pairs if each not in having), next(iter(pairs)))
    pin, links = pairs[name]
    named = sorted(links)[:2] if len(links) > 2 else (None, None)
    return PairFriction(pair=name, link=named[0], other=named[1], coefficient=0.1, radius_mm=5.0 if pin else None)


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
