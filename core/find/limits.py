"""What limits a cam whose size is sought: each limit with the figure that it holds, refined, and how far that is from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.cam import OUTER, SECOND, CamShape, Flank, FlatFlank, RoundFlank
from core.cam.limits import ROUNDING
from core.design import Design
from core.frozen import frozen
from core.study import Study, contact_stress


class Curve(NamedTuple):
    """A figure of one flank: the higher, the worse.

    value   (n,) at the cam angles of a study; NaN where the limit does not count
    reached what that is in the unit of the limit
    margin  how much of the limit is left with the figure, as a part: negative where it is exceeded
    whose   of which flank it is, where that is not the first
    """

    value: np.ndarray
    reached: Callable[[float], float]
    margin: Callable[[float, float], float]
    whose: str = ""


def _known(design: Design) -> str:
    return ""


class Row(NamedTuple):
    """unit; most: the limit is an upper one; curves: study at some cam angles -> the figures of its flanks; lacking: what a design must
    be given before there is such a figure, empty where nothing is missing."""

    unit: str
    most: bool
    curves: Callable[[Study], Iterator[Curve]]
    lacking: Callable[[Design], str] = _known

    @property
    def of_forces(self) -> bool:
        """Whether it takes the dynamics; else the shape of the cam says it."""
        return self.lacking is not _known


def _pressure(study: Study, sign: float | None) -> Iterator[Curve]:
    """Pressure angle [deg] of every flank: over the whole turn, or where the motion rises (+1) or returns (-1)."""
    for flank in _flanks(study.cam):
        angle = np.rad2deg(flank.pressure_angle)
        if sign is not None:
            angle = np.where(study.drive.velocity_sign == sign, angle, np.nan)
        whose = " of the second roller" if flank.name == SECOND else ""
        yield Curve(angle, float, lambda angle, limit: (limit - angle) / limit, whose)


def _flanks(shape: CamShape) -> Iterator[Flank]:
    """The flanks; of a groove one, since both have the same normal."""
    return (flank for flank in shape.flanks if flank.name != OUTER)


def _radius(study: Study, hollow: bool) -> Iterator[Curve]:
    """Curvature of every flank where it is convex, or where its material is hollow.

    Beside a pitch curve of curvature κ, by the signed distance o (the roller's radius; outwards negative), lies a profile of the
    radius 1/κ - o. The material of a groove's outer flank lies on the other side.
    """
    for flank in study.cam.flanks:
        if isinstance(flank, FlatFlank):
            if not hollow:
                size = float(np.abs(flank.support).max())
                yield Curve(-flank.profile_radius, lambda less: -1e3 * less, partial(_left_of_radius, size))
            continue
        assert isinstance(flank, RoundFlank), "round or flat"
        side = -1.0 if hollow != (flank.name == OUTER) else 1.0
        yield Curve(side * flank.pitch_curvature, partial(_beside, side * flank.offset), partial(_left, side * flank.offset))


def _beside(offset: float, bend: float) -> float:
    """Radius [mm] of the profile beside a curvature; infinite where it bends the other way."""
    return 1e3 * (1.0 / bend - offset) if bend > 0.0 else math.inf


def _left(offset: float, bend: float, limit: float) -> float:
    """1 - κ (limit + o), which is negative where the profile's radius is below the limit [mm]."""
    room = 1e-3 * limit + offset
    return 1.0 - bend * room if room > 0.0 else 1.0


def _left_of_radius(size: float, less: float, limit: float) -> float:
    """How far a radius, given as its negative [m], is above the limit [mm], as a part of the cam's size [m]."""
    return (-less - 1e-3 * limit) / size


def _part_left(size: float, value: float, limit: float) -> float:
    """Of a limit, with a figure whose unit is so large."""
    return 1.0 - value / (size * limit)


def _contact_force(study: Study) -> Iterator[Curve]:
    """Force [N] on every flank, of whatever side."""
    for contact in study.dynamics.contacts:
        yield Curve(np.abs(contact.force), float, partial(_part_left, 1.0))


def _contact_pressure(study: Study) -> Iterator[Curve]:
    """Hertz pressure [Pa] on every flank."""
    for each in study.stress.values():
        yield Curve(each.pressure, lambda value: value / MPA, partial(_part_left, MPA))


def _lacks_loads(design: Design) -> str:
    return "masses or a spring in [loads]" if Study(design).loading.empty else ""


def _lacks_contact(design: Design) -> str:
    if lacking := _lacks_loads(design):
        return lacking
    return "" if contact_stress.pairings(Study(design)) else "the thickness of the cam and the materials of what touches"


MPA = 1e6  # [Pa]
ANY_PRESSURE, CONVEX = "pressure_angle_deg", "convex_radius_mm"

LIMITS: Mapping[str, Row] = MappingProxyType(
    {
        ANY_PRESSURE: Row("deg", True, partial(_pressure, sign=None)),
        "pressure_angle_rise_deg": Row("deg", True, partial(_pressure, sign=1.0)),
        "pressure_angle_return_deg": Row("deg", True, partial(_pressure, sign=-1.0)),
        CONVEX: Row("mm", False, partial(_radius, hollow=False)),
        "concave_radius_mm": Row("mm", False, partial(_radius, hollow=True)),
        "contact_force_n": Row("N", True, _contact_force, _lacks_loads),
        "contact_pressure_mpa": Row("MPa", True, _contact_pressure, _lacks_contact),
    }
)
"""Keys as in [limits], radii those of the profile; the pressure angle over the whole turn besides. A convex radius of 0 says that
the cam is not undercut."""


@frozen
class Reading:
    """A limit and what is reached: value in the unit of the limit, infinite where there is no such figure; margin as a part of the
    limit; cam angle [rad]; whose: of which flank."""

    key: str
    limit: float
    reached: float
    margin: float
    theta: float
    whose: str = ""

    @property
    def kept(self) -> bool:
        """To rounding; a limit of 0 must not be reached itself."""
        return self.margin >= -ROUNDING if self.limit else self.margin > 0.0

    @property
    def text(self) -> str:
        row = LIMITS[self.key]
        name = self.key.rpartition("_")[0].replace("_", " ")
        if not self.limit:
            return f"undercut at {math.degrees(self.theta):.5g} deg"
        return f"{name}{self.whose} {self.reached:.6g} {row.unit} at {math.degrees(self.theta):.5g} deg, limit {self.limit:g} {row.unit}"
