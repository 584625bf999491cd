"""The values at a place of the profile, under the mouse."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QPolygonF

from core.cam import INNER, OUTER, SECOND
from core.errors import NoSolution
from core.frozen import frozen
from core.study.extremes import has_undercut
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.units import readable, short, with_unit

PROFILES: Mapping[str, str] = MappingProxyType({INNER: "Profile", OUTER: "Outer flank", SECOND: "Second cam"})
MPA = 1e6  # Pa in one
STRAIGHT = 1e4  # a radius of curvature above so many sizes of the cam is none


@frozen
class ProfileReading:
    """place: of the profile [mm] in the cam's own frame; cam_angle [deg] at which it is touched; radius from the cam centre
    [mm]; pressure_angle [deg]; curvature [1/mm], positive where the cam is convex; flank: its name. Where forces are drawn also
    force [N] on the flank and pressure [MPa] there, else None."""

    flank: str
    place: complex
    cam_angle: float
    radius: float
    pressure_angle: float
    curvature: float
    force: float | None = None
    pressure: float | None = None

    @property
    def text(self) -> str:
        """In one line."""
        bend = abs(self.curvature)
        if bend * self.radius * STRAIGHT < 1.0:
            curved = "straight"
        else:
            curved = f"{'convex' if self.curvature > 0.0 else 'concave'} R {short(1.0 / bend, 4)} mm"
        return (
            f"{PROFILES[self.flank]} at {self.cam_angle:.1f}°: radius {self.radius:.2f} mm, pressure angle "
            f"{self.pressure_angle:.1f}°, {curved}{self._loaded}"
        )

    @property
    def _loaded(self) -> str:
        """Force and pressure, as far as they are known."""
        text = ""
        if self.force is not None:
            rung = readable("N", abs(self.force))
            text = f", force {with_unit(short(self.force / rung.size, 4), rung.symbol)}"
        return text if self.pressure is None else f"{text}, contact pressure {short(self.pressure, 4)} MPa"


def on_cam(geometry: Geometry, index: int, at: complex) -> bool:
    """Whether a place [mm] of the global frame lies on the cam while the drawing stands at a sample."""
    if not geometry.profile.size:
        return False
    own = at * np.exp(-1j * np.deg2rad(geometry.turned[index]))
    outline = QPolygonF([QPointF(p.real, p.imag) for p in geometry.profile])
    return outline.containsPoint(QPointF(own.real, own.imag), Qt.FillRule.OddEvenFill)


def reading_at(
    geometry: Geometry, index: int, at: complex, reach: float, by_forces: bool = False
) -> ProfileReading | None:
    """The sample of the profile that is nearest to a place [mm] of the global frame while the drawing stands at a sample, no
    farther than ``reach`` [mm]; None where none is. by_forces: with force and contact pressure there."""
    if geometry.shape is None:
        return None
    local = at * np.exp(-1j * np.deg2rad(geometry.turned[index]))
    near = [(flank, np.abs(flank.profile * MM - local)) for flank in geometry.shape.flanks]
    flank, away = min(near, key=lambda each: float(each[1].min()))
    i = int(away.argmin())
    if away[i] > reach:
        return None
    place = complex(flank.profile[i] * MM)
    return ProfileReading(
        flank.name,
        place,
        float(geometry.cam_angle[i]),
        abs(place),
        float(np.rad2deg(flank.pressure_angle[i])),
        float(flank.profile_curvature[i] / MM),
        *(_loads_at(geometry, flank.name, i) if by_forces else ()),
    )


def _loads_at(geometry: Geometry, flank: str, i: int) -> tuple[float | None, float | None]:
    """Force [N] on a flank and contact pressure [MPa] at a sample, as far as they have an answer."""
    study, shape = geometry.study, geometry.shape
    assert shape is not None
    try:
        force = next(c.force[i] for f, c in zip(shape.flanks, study.dynamics.contacts, strict=True) if f.name == flank)
        stress = study.stress.get(flank) if study.jam is None and not has_undercut(study) else None
    except NoSolution:
        return None, None
    pressure = None if stress is None else float(stress.pressure[i]) / MPA
    return float(force) if np.isfinite(force) else None, pressure
