"""Kinds of cams in space: how the axis of a roller moves with the motion, one row each.

The cam turns about the z axis. The axis of the roller is the line c(y) + u a(y), u measured along it from the cam's axis, of a globoidal
cam from the turret's axis; y is the motion, a length [m] or an angle [rad].
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.design.spatial import BarrelCam, GloboidalCam, Rib, SpatialCam
from core.frozen import frozen

MM = 1e-3  # [m]


@frozen
class Machine:
    """Dimensions of a cam in space in SI units, with the unit of its motion.

    Attributes
    ----------
    kind, unit : word of the kind; mm or deg
    radius, taper : of the roller at its inner end [m], half angle τ of its cone [rad]
    inner, outer : distances u of the roller's ends [m]
    rollers : on the turret
    lever : arm of a barrel's turret, or centre distance of a globoidal cam [m]; 0 where the roller slides
    play : of a groove [m]
    distance : between the two rollers on the rib of a motion in mm [m]; 0 otherwise
    length : of the blank [m]; None where it is not known
    is_rib : whether a rib is between two rollers, in place of a groove around each
    """

    kind: str
    unit: str
    radius: float
    taper: float
    inner: float
    outer: float
    rollers: int
    lever: float
    play: float
    distance: float
    length: float | None
    is_rib: bool

    @property
    def is_turret(self) -> bool:
        """Whether several rollers are on a turret, and follow each other on the cam."""
        return self.rollers > 1

    @property
    def pitch(self) -> float:
        """Angle between neighbours on the turret [rad]."""
        return 2.0 * pi / self.rollers

    @property
    def middle(self) -> float:
        """Distance u of the roller's middle [m]."""
        return 0.5 * (self.inner + self.outer)

    @property
    def slides(self) -> bool:
        """Whether the motion is a length."""
        return self.unit == "mm"

    @property
    def is_cylindrical(self) -> bool:
        """Whether the blank is a cylinder; else it is a torus about the axis of the turret."""
        return KINDS[self.kind].is_cylindrical

    def roller_radius(self, u: np.ndarray | float) -> np.ndarray | float:
        """Radius of the roller, r(u) = r - (u - u_0) tan τ.

        Parameters
        ----------
        u : ndarray (...) [m]
            Distance along the axis.

        Returns
        -------
        ndarray (...) [m]
        """
        return self.radius - (u - self.inner) * float(np.tan(self.taper))


def machine_of(cam: SpatialCam, unit: str) -> Machine:
    """Dimensions of a design's cam, with a motion in ``unit``."""
    lever = cam.centre_distance_mm if isinstance(cam, GloboidalCam) else getattr(cam, "arm_mm", None) or 0.0
    distance = cam.form.roller_distance_mm if isinstance(cam.form, Rib) else None
    return Machine(
        kind=cam.kind,
        unit=unit,
        radius=MM * cam.roller_radius_mm,
        taper=cam.taper,
        inner=MM * cam.roller_inner_mm,
        outer=MM * cam.outer_mm,
        rollers=cam.rollers,
        lever=MM * lever,
        play=MM * getattr(cam.form, "play_mm", 0.0),
        distance=MM * (distance or 0.0),
        length=None if cam.length_mm is None else MM * cam.length_mm,
        is_rib=isinstance(cam.form, Rib),
    )


class RollerAxis(NamedTuple):
    """Axis c + u a of a roller with its derivatives by the motion y, in the global frame.

    Attributes
    ----------
    c, a, t : ndarray (3, n) [m], dimensionless
        Point at u = 0, unit direction of the axis, and unit direction ∂p/∂y/|∂p/∂y| in which it moves, at right angles to a.
    c_y, c_yy : ndarray (3, n) [1 or m], by y
        Derivatives of c.
    turn : ndarray (3, 1), dimensionless
        Angular velocity of the roller's carrier per unit of y; 0 where it slides.
    reach, reach_u : float [1 or m], dimensionless
        |∂p/∂y| = reach + u reach_u.
    """

    c: np.ndarray
    a: np.ndarray
    t: np.ndarray
    c_y: np.ndarray
    c_yy: np.ndarray
    turn: np.ndarray
    reach: float
    reach_u: float


def _rows(x: np.ndarray | float, y: np.ndarray | float, z: np.ndarray | float) -> np.ndarray:
    return np.stack(np.broadcast_arrays(x, y, z)).astype(float)


def sliding_axis(machine: Machine, y: np.ndarray) -> RollerAxis:
    """Axis of a roller along +x that slides along the cam's axis: p = (u, 0, y).

    Parameters
    ----------
    machine : Machine
    y : ndarray (n,) [m]
        Motion.

    Returns
    -------
    RollerAxis
    """
    zero = np.zeros_like(y)
    along = _rows(zero, zero, zero + 1.0)
    return RollerAxis(
        c=_rows(zero, zero, y), a=_rows(zero + 1.0, zero, zero), t=along, c_y=along, c_yy=_rows(zero, zero, zero),
        turn=np.zeros((3, 1)), reach=1.0, reach_u=0.0,
    )  # fmt: skip


def parallel_axis(machine: Machine, y: np.ndarray) -> RollerAxis:
    """Axis of a roller on an arm A about a parallel axis: p = (u, -A + A cos φ, A sin φ).

    Parameters
    ----------
    machine : Machine
    y : ndarray (n,) [rad]
        Angle φ of the arm.

    Returns
    -------
    RollerAxis
    """
    arm, cos, sin, zero = machine.lever, np.cos(y), np.sin(y), np.zeros_like(y)
    across = _rows(zero, -sin, cos)
    return RollerAxis(
        c=_rows(zero, arm * (cos - 1.0), arm * sin), a=_rows(zero + 1.0, zero, zero), t=across, c_y=arm * across,
        c_yy=-arm * _rows(zero, cos, sin), turn=np.array([[1.0], [0.0], [0.0]]), reach=arm, reach_u=0.0,
    )  # fmt: skip


def radial_axis(machine: Machine, y: np.ndarray) -> RollerAxis:
    """Axis of a roller that points from the turret at the cam: p = (D - u cos φ, 0, u sin φ).

    Parameters
    ----------
    machine : Machine
    y : ndarray (n,) [rad]
        Angle φ of the turret, about +y.

    Returns
    -------
    RollerAxis
    """
    cos, sin, zero = np.cos(y), np.sin(y), np.zeros_like(y)
    nothing = _rows(zero, zero, zero)
    return RollerAxis(
        c=_rows(machine.lever + zero, zero, zero), a=_rows(-cos, zero, sin), t=_rows(sin, zero, cos), c_y=nothing, c_yy=nothing,
        turn=np.array([[0.0], [1.0], [0.0]]), reach=0.0, reach_u=1.0,
    )  # fmt: skip


class SpatialKind(NamedTuple):
    """Kind of cam in space: its table, the axis of its roller by the unit of the motion, and its drawing in words.

    Attributes
    ----------
    cam : class of its table ``[cam]``
    axes : unit of the motion -> axis of a roller, of dimensions and motion
    gentler : what reduces its pressure angle, in a sentence
    size : field that mainly sets its size
    is_cylindrical : whether its blank is a cylinder; else a torus about the axis of the turret
    """

    cam: type[SpatialCam]
    axes: Mapping[str, Callable[[Machine, np.ndarray], RollerAxis]]
    gentler: str
    size: str
    is_cylindrical: bool


KINDS: Mapping[str, SpatialKind] = MappingProxyType(
    {
        BarrelCam.kind: SpatialKind(
            BarrelCam,
            {"mm": sliding_axis, "deg": parallel_axis},
            "enlarge the inner distance",
            "cam.roller_inner_mm",
            True,
        ),
        GloboidalCam.kind: SpatialKind(
            GloboidalCam,
            {"deg": radial_axis},
            "enlarge the centre distance",
            "cam.centre_distance_mm",
            False,
        ),
    }
)
"""Word of ``cam.kind`` -> row."""


def roller_axis(machine: Machine, y: np.ndarray) -> RollerAxis:
    """Axis of a roller of the machine's kind.

    Parameters
    ----------
    machine : Machine
    y : ndarray (n,) [m or rad]
        Motion of this roller.

    Returns
    -------
    RollerAxis
    """
    return KINDS[machine.kind].axes[machine.unit](machine, y)


def lever_arm(machine: Machine, u: float) -> float:
    """Distance |∂p/∂φ| [m] of a point of the roller's axis, at u [m], from the axis of its arm or turret."""
    line = roller_axis(machine, np.zeros(1))
    return line.reach + u * line.reach_u
