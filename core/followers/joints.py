"""The joints that can be drawn elsewhere, of designs of every kind: what they are called, and what follows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from core.design import Design
from core.followers.dragging import drags_of, with_joint_at
from core.mechanism.dragging import movable, with_point_at
from core.mechanism.kinematics import Kinematics


@dataclass(frozen=True)
class Joint:
    """label: its name for the reader; field: the path of the value that is edited by it above all."""

    label: str
    field: str


def _of_cam(design: Design) -> Mapping[str, Joint]:
    return {name: Joint(drag.label, drag.field) for name, drag in drags_of(design).items()}


def _of_linkage(design: Design) -> Mapping[str, Joint]:
    first = {name: link.number for link in reversed(design.drive.linkage.links) for name in link.places}
    return {
        name: Joint(f"joint {name}", _path_of(design, link, name))
        for name, link in first.items()
        if movable(design, name)
    }


def _path_of(design: Design, link: int, name: str) -> str:
    i = next(i for i, each in enumerate(design.drive.linkage.links) if each.number == link)
    return f"linkage.links[{i}].points.{name}"


def joints_of(design: Design) -> Mapping[str, Joint]:
    """The joints of a design that can be drawn elsewhere, by the names of their points."""
    return _of_linkage(design) if design.drive.is_linkage else _of_cam(design)


def move_joint(design: Design, kinematics: Kinematics, name: str, to: complex, decimals: int = 6) -> Design:
    """The design with a joint at ``to`` [m] in the position that ``kinematics`` shows (n = 1), rounded to so many decimals
    [mm]. It may have faults. Raises KeyError for a joint there is none of, NoAssembly where nothing fits."""
    put = with_point_at if design.drive.is_linkage else with_joint_at
    return put(design, kinematics, name, to, decimals)
