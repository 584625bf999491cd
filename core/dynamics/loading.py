"""Loads as every train needs them: inertia by body, force along the guide, friction, gravity."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import CamSlider, CamSliderLoads, Follower, Loads, Translating, TranslatingLoads, si


@dataclass(frozen=True)
class Inertia:
    """mass [kg], centre of mass in the body's frame [m], inertia about that centre [kg m²]."""

    mass: float
    centre: complex = 0j
    about_centre: float = 0.0


def combined(parts: Sequence[Inertia]) -> Inertia:
    """Several masses fixed to one body as one (parallel axes)."""
    mass = sum(p.mass for p in parts)
    centre = sum((p.mass * p.centre for p in parts), 0j) / mass if mass else 0j
    about = sum(p.about_centre + p.mass * abs(p.centre - centre) ** 2 for p in parts)
    return Inertia(mass, centre, about)


@dataclass(frozen=True, eq=False)
class Loading:
    """What acts on a train.

    inertias  body name -> Inertia
    force     on the output body along the guide, F(y) = force - rate·y [N, N/m], y the motion
    friction  coefficient of the pair on the guide
    gravity   complex [m/s²], global frame
    """

    inertias: Mapping[str, Inertia]
    force: float
    rate: float
    friction: float
    gravity: complex

    def along_guide(self, y: np.ndarray) -> np.ndarray:
        """The force on the output body along the guide (n,) [N] at motion y (n,) [m]."""
        return self.force - self.rate * y

    @property
    def empty(self) -> bool:
        """True where nothing has mass and nothing pushes."""
        return (
            self.force == 0.0 and self.rate == 0.0 and not any(i.mass or i.about_centre for i in self.inertias.values())
        )


def _gravity(loads: Loads) -> complex:
    s = si(loads)
    return complex(cmath.rect(s.gravity, s.gravity_angle))


def cam_slider_loading(follower: CamSlider, loads: CamSliderLoads) -> Loading:
    """The roller is fixed to the arm and turns with it; a roller that turns freely would leave out its inertia."""
    g, s = si(follower), si(loads)
    arm = Inertia(s.arm_mass, cmath.rect(s.arm_centre, s.arm_centre_angle), s.arm_inertia)
    roller = Inertia(s.roller_mass, cmath.rect(g.roller_arm, g.fixed_angle), s.roller_inertia)
    inertias = {
        "slider": Inertia(s.slider_mass),
        "rod": Inertia(s.rod_mass, complex(s.rod_centre * g.rod), s.rod_inertia),
        "arm": combined([arm, roller]),
    }
    return Loading(inertias, s.external_force, s.spring_rate, s.friction, _gravity(loads))


def translating_loading(follower: Translating, loads: TranslatingLoads) -> Loading:
    """The closing spring presses towards the cam, against the rise."""
    s = si(loads)
    inertias = {"follower": Inertia(s.follower_mass)}
    return Loading(inertias, -s.preload, s.spring_rate, s.friction, _gravity(loads))


LOADINGS: Mapping[type, Callable[[Any, Any], Loading]] = MappingProxyType(
    {CamSliderLoads: cam_slider_loading, TranslatingLoads: translating_loading}
)


def loading_of(follower: Follower, loads: Loads) -> Loading:
    """The loads of a design in the form the trains take."""
    return LOADINGS[type(loads)](follower, loads)
