"""The joints that can be drawn elsewhere, of designs of every kind: what they are called, and what follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from core.design import Design, LinkageDesign, SingleCam
from core.design.linkage_paths import place_of
from core.followers.dragging import drags_of, with_joint_at
from core.mechanism.dragging import movable, with_point_at
from core.train import Train


@dataclass(frozen=True)
class Joint:
    """label: its name for the reader; field: the path of the value that is edited by it above all."""

    label: str
    field: str


@dataclass(frozen=True)
class Row:
    """The joints of a design by the names of their points, and how one is put elsewhere."""

    joints: Callable[[Any], Mapping[str, Joint]]
    put: Callable[[Any, Train, str, complex, int], Design]


def _of_cam(design: SingleCam) -> Mapping[str, Joint]:
    return {name: Joint(drag.label, drag.field) for name, drag in drags_of(design).items()}


def _of_linkage(design: LinkageDesign) -> Mapping[str, Joint]:
    first = {name: link.number for link in reversed(design.linkage.links) for name in link.places}
    return {
        name: Joint(f"joint {name}", place_of(design, link, name))
        for name, link in first.items()
        if movable(design, name)
    }


_ROWS: Mapping[type, Row] = MappingProxyType(
    {SingleCam: Row(_of_cam, with_joint_at), LinkageDesign: Row(_of_linkage, with_point_at)}
)


def joints_of(design: Design) -> Mapping[str, Joint]:
    """The joints of a design that can be drawn elsewhere, by the names of their points."""
    return _ROWS[type(design)].joints(design)


def move_joint(design: Design, train: Train, name: str, to: complex, decimals: int = 6) -> Design:
    """The design with a joint at ``to`` [m] in the position that ``train`` shows (n = 1), rounded to so many decimals
    [mm]. It may have faults. Raises KeyError for a joint there is none of, NoAssembly where nothing fits."""
    return _ROWS[type(design)].put(design, train, name, to, decimals)
