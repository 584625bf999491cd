"""The kinds of design, one row each: what tells them in a file, and how their values are found, put and judged."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, TypeVar

from core.design import edits
from core.design import paths as cam_paths
from core.design.linkage import LinkageDesign
from core.design.linkage_edits import linkage_edited
from core.design.linkage_paths import (
    LINKAGE_SECTIONS,
    assumed_in,
    linkage_assumed,
    linkage_entries,
    linkage_get,
    linkage_put,
    paths,
)
from core.design.linkage_rules import linkage_faults
from core.design.parts import Motion, SingleCam
from core.design.paths import Entry
from core.design.rules import single_cam_faults
from core.errors import DesignError, Fault

Design = SingleCam | LinkageDesign
D = TypeVar("D", bound=Design)


@dataclass(frozen=True)
class Kind:
    """slug as in ``summary.json``; table of the file that tells it; its tables in the order of the file, and those a
    report lists entry by entry; speed: the path of the shaft's."""

    slug: str
    table: str
    sections: tuple[str, ...]
    report_sections: tuple[str, ...]
    entries: Callable[[Any, str], Iterator[Entry]]
    get: Callable[[Any, str], Any]
    put: Callable[[Any, str, Any], Any]
    edited: Callable[[Any, str, Any], Any]
    faults: Callable[[Any], list[Fault]]
    assumed: Callable[[Any, str], bool]
    with_assumed: Callable[[Any, str, bool], Any]
    paths: Callable[[Any], Iterable[str]]
    speed: str
    motion: Callable[[Any], Motion | None]
    with_motion: Callable[[Any, Motion], Any]


KINDS: Mapping[type, Kind] = MappingProxyType(
    {
        SingleCam: Kind(
            "cam", "follower", cam_paths.SECTIONS, ("follower", "cam", "shaft", "loads"), cam_paths.entries, cam_paths.get,
            cam_paths.put, edits.edited, single_cam_faults, lambda design, path: path in design.assumed, edits.with_assumed,
            edits.all_paths, "shaft.speed_rpm", lambda design: design.drive.motion,
            lambda design, motion: cam_paths.with_section(design, "motion", motion),
        ),
        LinkageDesign: Kind(
            "linkage", "linkage", LINKAGE_SECTIONS, ("cam", "loads"), linkage_entries, linkage_get, linkage_put,
            linkage_edited, linkage_faults, assumed_in, linkage_assumed, paths,
            "linkage.driver.speed_rpm", lambda design: design.motion, lambda design, motion: replace(design, motion=motion),
        ),
    }
)  # fmt: skip


def kind_row(design: Design) -> Kind:
    """The row of a design's kind."""
    return KINDS[type(design)]


def require_single_cam(design: Design) -> SingleCam:
    """The design, where it is a cam on its shaft. Raises DesignError."""
    if isinstance(design, SingleCam):
        return design
    raise _another_kind(design, "follower")


def require_linkage(design: Design) -> LinkageDesign:
    """The design, where it is a linkage. Raises DesignError."""
    if isinstance(design, LinkageDesign):
        return design
    raise _another_kind(design, "linkage")


def _another_kind(design: Design, wanted: str) -> DesignError:
    table = kind_row(design).table
    return DesignError([Fault(table, f"[{table}]", "this kind of design does not take it", f"a design with [{wanted}]")])


def entries(design: Design, name: str) -> Iterator[Entry]:
    """The entries of one table of the design, in the order of the file."""
    return kind_row(design).entries(design, name)


def get(design: Design, path: str) -> Any:
    """The value at a path. Raises KeyError where the path leads nowhere."""
    return kind_row(design).get(design, path)


def put(design: D, path: str, value: Any) -> D:
    """The design with the value at a path replaced. Raises KeyError where the path leads nowhere."""
    changed: D = kind_row(design).put(design, path, value)
    return changed


def edited(design: D, path: str, value: Any) -> D:
    """The design with the value at a path changed and what goes with it. It may have faults: ask ``faults``."""
    changed: D = kind_row(design).edited(design, path, value)
    return changed


def is_assumed(design: Design, path: str) -> bool:
    """Whether the value at a path is marked as a guess."""
    return kind_row(design).assumed(design, path)


def with_assumed(design: D, path: str, on: bool) -> D:
    """A path marked as assumed, in the order of the file, or no longer."""
    changed: D = kind_row(design).with_assumed(design, path, on)
    return changed


def speed_rpm(design: Design) -> float:
    """How fast the shaft turns, either way round."""
    return abs(float(get(design, kind_row(design).speed)))


def faults(design: Design) -> list[Fault]:
    """Every fault of a design, in the order of the file."""
    return kind_row(design).faults(design)
