"""Linkages from dyads: a four-bar, a slider-crank or an inverted slider-crank, drawn at one position of its body."""

from __future__ import annotations

import cmath
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from math import degrees, pi
from types import MappingProxyType

import numpy as np

from core.design import (
    CRANK,
    Design,
    Drawn,
    Drive,
    Driver,
    Link,
    Linkage,
    LinkageLoads,
    LinkMass,
    LinkPoint,
    Slider,
    with_drive,
)
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.synthesis.dyads import GUIDE, PIN, TURNING_GUIDE, Dyad

FOUR_BAR, SLIDER_CRANK, INVERTED = "four-bar", "slider-crank", "inverted-slider-crank"
KINDS = MappingProxyType({PIN: FOUR_BAR, GUIDE: SLIDER_CRANK, TURNING_GUIDE: INVERTED})
"""Kind of the dyad next to the driver -> kind of the linkage; the driver's dyad has two pins."""
BAR = 1.57
"""Mass per length of a link [kg/m], where none is known: steel, 20 mm × 10 mm."""
SPEED = 60.0
"""Speed of the driver of a new linkage [rpm]."""
FRAME, CRANK_LINK, COUPLER, SIDE_LINK = 1, 2, 3, 4
CRANK_PIVOT, CRANK_PIN, SIDE_PIN, SIDE_PIVOT, TRACER = "O2", "A", "B", "O4", "P"

Errors = Callable[[Kinematics], tuple[np.ndarray, np.ndarray]]
"""Kinematics (n,) at the driver positions of the task -> errors (n,) [mm] and (n,) [deg]."""


@frozen(eq=False)
class Candidate:
    """A linkage proposed for a task.

    Attributes
    ----------
    linkage : Linkage
        Link 1 is the frame, 2 the driver, 3 the coupler; drawn at a position of the task.
    kind : str
        One of ``KINDS``.
    positions : ndarray (n,) [rad]
        Driver angles of the task's positions, in their order.
    errors : callable
        Deviations from the task at these angles.
    expected : float
        Largest error with which it was proposed [mm].
    cognates : tuple
        Other linkages with the same path, each with either side link as its driver.
    """

    linkage: Linkage
    kind: str
    positions: np.ndarray
    errors: Errors
    expected: float = 0.0
    cognates: tuple[tuple[Candidate, ...], ...] = ()

    @property
    def design(self) -> Design:
        """The linkage as a design, with the masses of steel bars."""
        drive = Drive(None, self.linkage, None, LinkageLoads())
        return with_bar_masses(Design(self.kind.capitalize(), None, (drive,)))


def linkage_of(first: Dyad, second: Dyad, z: complex, angle: float, *, tracer: bool = True) -> Linkage:
    """Linkage of two dyads, the first one with two pins and driving, drawn at a position of the body.

    Parameters
    ----------
    first, second : Dyad
    z : complex
        Origin of the body [mm].
    angle : float
        Angle of the body [rad]; link 3 has its frame.
    tracer : bool
        Give link 3 a point P at its origin.

    Returns
    -------
    Linkage
    """
    turn = cmath.rect(1.0, angle)
    crank_pin = z + first.moving * turn
    crank = crank_pin - first.fixed
    frame, coupler = {CRANK_PIVOT: first.fixed}, {CRANK_PIN: first.moving}
    side: dict[str, complex] = {}
    drawn = {CRANK_PIN: crank_pin}
    sliders: tuple[Slider, ...] = ()
    if second.kind == TURNING_GUIDE:
        frame[SIDE_PIVOT], side[SIDE_PIVOT] = second.fixed, 0j
        sliders = (_slider(COUPLER, second.moving, second.line),)
    else:
        coupler[SIDE_PIN] = second.moving
        drawn[SIDE_PIN] = z + second.moving * turn
        if second.kind == PIN:
            frame[SIDE_PIVOT], side[SIDE_PIVOT] = second.fixed, 0j
            side[SIDE_PIN] = complex(abs(drawn[SIDE_PIN] - second.fixed))
        else:
            side[SIDE_PIN] = 0j
            sliders = (_slider(FRAME, second.fixed, second.line),)
    if tracer:
        coupler[TRACER], drawn[TRACER] = 0j, z
    links = (
        link_with(FRAME, frame),
        link_with(CRANK_LINK, {CRANK_PIVOT: 0j, CRANK_PIN: complex(abs(crank))}),
        link_with(COUPLER, coupler),
        link_with(SIDE_LINK, side),
    )
    pose = Drawn(degrees(cmath.phase(crank)), None, _points(drawn))
    return Linkage(links, sliders, Driver(CRANK_LINK, CRANK, SPEED), drawn=pose)


def _slider(on: int, through: complex, direction: float) -> Slider:
    return Slider(
        link=SIDE_LINK, on=on, through_x_mm=through.real, through_y_mm=through.imag, angle_deg=degrees(direction)
    )


def link_with(number: int, places: dict[str, complex]) -> Link:
    """Link with named points in its frame [mm]."""
    return Link(number, _points(places))


def _points(places: dict[str, complex]) -> tuple[LinkPoint, ...]:
    return tuple(LinkPoint(name, z.real, z.imag) for name, z in places.items())


def driver_angles(first: Dyad, z: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Angles of the driver at positions of the body.

    Parameters
    ----------
    first : Dyad
        With two pins.
    z : ndarray (n,) complex [mm]
        Origins of the body.
    turn : ndarray (n,) complex, dimensionless
        Unit vectors of its x axis.

    Returns
    -------
    ndarray (n,) [rad]
    """
    return np.angle(z + first.moving * turn - first.fixed)


def is_in_order(angles: np.ndarray) -> bool:
    """Whether angles are in their order around the circle, in either direction.

    Parameters
    ----------
    angles : ndarray (n,) [rad]
    """
    steps = np.diff(np.append(angles, angles[0]))
    return any(round(float(np.mod(sign * steps, 2.0 * pi).sum() / (2.0 * pi))) == 1 for sign in (1.0, -1.0))


def shortest_arc(angles: np.ndarray) -> tuple[float, float]:
    """Ends [rad] of the shortest arc with all angles.

    Parameters
    ----------
    angles : ndarray (n,) [rad]
    """
    ordered = np.sort(np.mod(angles, 2.0 * pi))
    gaps = np.diff(np.append(ordered, ordered[0] + 2.0 * pi))
    widest = int(gaps.argmax())
    low = float(ordered[(widest + 1) % ordered.size])
    return low, low + 2.0 * pi - float(gaps[widest])


def with_bar_masses(design: Design) -> Design:
    """Design of a linkage with the masses of its links as steel bars from one point to the farthest other one, marked as assumed.

    A link with one point, such as the block of a slider, has the mass of the shortest bar.
    """
    linkage = design.drive.linkage
    bars = [_bar(link) for link in linkage.links if link.number != FRAME]
    shortest = min(bar.mass_kg for bar in bars if bar.mass_kg)
    masses = tuple(bar if bar.mass_kg else replace(bar, mass_kg=shortest) for bar in bars)
    loads = replace(design.drive.loads, masses=masses)
    rows = [i for i, bar in enumerate(bars) if bar.inertia_kg_m2]
    marks = [f"loads.masses[{i}].mass_kg" for i in range(len(masses))]
    marks += [f"loads.masses[{i}].{key}" for i in rows for key in ("inertia_kg_m2", "centre")]
    return replace(with_drive(design, loads=loads), assumed=(*design.assumed, *sorted(marks)))


def _bar(link: Link) -> LinkMass:
    """Mass of a link as a bar between its farthest points; without mass where it has only one."""
    points = list(link.places.values())
    first, second = max(product(points, points), key=lambda pair: abs(pair[0] - pair[1]))
    length, middle = 1e-3 * abs(second - first), 0.5 * (first + second)
    mass = BAR * length
    return LinkMass(
        link=link.number,
        mass_kg=_rounded(mass),
        inertia_kg_m2=_rounded(mass * length**2 / 12.0),
        centre_x_mm=_rounded(middle.real),
        centre_y_mm=_rounded(middle.imag),
    )


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")


def is_degenerate(first: Dyad, second: Dyad, size: float) -> bool:
    """Whether two dyads are one, or have a link without length."""
    tiny = 1e-6 * size
    if second.kind == PIN:
        return abs(first.fixed - second.fixed) <= tiny or abs(first.moving - second.moving) <= tiny
    if second.kind == GUIDE:
        return abs(first.moving - second.moving) <= tiny
    return abs(first.fixed - second.fixed) <= tiny
