"""The values at a place of the profile, under the mouse."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from core.cam import INNER, OUTER, SECOND
from core.frozen import frozen
from kindyna_gui.pictures.drawing.geometry import MM, Geometry
from kindyna_gui.pictures.units import short

PROFILES: Mapping[str, str] = MappingProxyType({INNER: "Profile", OUTER: "Outer flank", SECOND: "Second cam"})
STRAIGHT = 1e4  # a radius of curvature above so many sizes of the cam is none


@frozen
class ProfileReading:
    """place: of the profile [mm] in the cam's own frame; cam_angle [deg] at which it is touched; radius from the cam centre
    [mm]; pressure_angle [deg]; curvature [1/mm], positive where the cam is convex; flank: its name."""

    flank: str
    place: complex
    cam_angle: float
    radius: float
    pressure_angle: float
    curvature: float

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
            f"{self.pressure_angle:.1f}°, {curved}"
        )


def reading_at(geometry: Geometry, index: int, at: complex, reach: float) -> ProfileReading | None:
    """The sample of the profile that is nearest to a place [mm] of the global frame while the drawing stands at a sample, no
    farther than ``reach`` [mm]; None where none is."""
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
        flank.name, place, float(geometry.cam_angle[i]), abs(place), float(np.rad2deg(flank.pressure_angle[i])),
        float(flank.profile_curvature[i] / MM),
    )  # fmt: skip
