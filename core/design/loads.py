"""Balance cam and force elements."""

from __future__ import annotations

from typing import Any

from core.design.fields import FileLayout, coordinate, flag, length, number, placed, whole
from core.frozen import frozen

# -- balance cam ------------------------------------------------------------------------------------------------


@frozen(kw_only=True)
class Balancer:
    """Balance cam: a translating roller follower whose spring compensates the torque of the shaft at its speed.

    The motion begins at 0, where the spring has its preload; the follower's weight counts as preload.
    """

    spring_rate_n_per_mm: float = number("Spring rate", 0.0, help="a softer spring makes a longer stroke")
    preload_n: float = number(
        "Spring preload", 0.0, open_low=True, help="where the motion is 0; without it the cam would have a kink there"
    )
    follower_mass_kg: float = number("Follower mass", 0.0, default=0.0, help="with its roller")
    phase_deg: float = number("Phase", -360.0, 360.0, default=0.0, help="machine angle at the cam's zero mark")
    base_radius_mm: float = length("Base radius Br", help="smallest radius of the cam where the motion is 0")
    roller_radius_mm: float = length("Roller radius Rr")


# -- force elements ---------------------------------------------------------------------------------------------


_POINT = "the name of a point, or at = [x, y]"


@frozen(kw_only=True)
class Attachment:
    """Attachment of a force element to a link: a point by name, or coordinates in the frame of the link."""

    link: int = whole("Link", 1, 999, help="1 = frame")
    point: str | None = placed(FileLayout(), None)
    x_mm: float | None = coordinate(
        "Point x", pair="at", default=None, help="in the link's frame; on the frame in the global one"
    )
    y_mm: float | None = coordinate("Point y", pair="at", default=None)


def _end() -> Attachment:
    field: Attachment = placed(FileLayout(Attachment, single=True, missing='{ link = 1, point = "S" }'))
    return field


@frozen(kw_only=True)
class PointSpring:
    """A spring between two points, and a damper along the same line: F = k (l - l0) + c l̇ pulls them together."""

    from_: Attachment = _end()
    to: Attachment = _end()
    rate_n_per_mm: float = number("Spring rate", 0.0, default=0.0)
    free_length_mm: float = number("Free length", 0.0, 1e9, default=0.0, help="without force")
    damping_n_s_per_mm: float = number("Damping", 0.0, default=0.0, help="of the parallel damper")


@frozen(kw_only=True)
class TorsionSpring:
    """A torsion spring, and a damper, between two links: M = k (φ - φ0) + c φ̇ turns ``link`` back, φ its angle against ``on``."""

    link: int = whole("Link", 1, 999)
    on: int = whole("On", 1, 999, help="1 = frame")
    rate_nm_per_rad: float = number("Spring rate", 0.0, default=0.0)
    free_angle_deg: float = number(
        "Free angle",
        -3600.0,
        3600.0,
        default=0.0,
        help="angle of link minus angle of on without torque, in the global frame",
    )
    damping_nm_s_per_rad: float = number("Damping", 0.0, default=0.0)


@frozen(kw_only=True)
class PairFriction:
    """Coulomb friction of a pair: μ|R| at the radius of a pin; μ|N| along a slide, of a long one by both of its edges."""

    pair: str = placed(FileLayout(missing="the name of a pin, or the number of the link that slides, as text"))
    link: int | None = whole("Links, first", 1, 999, pair="links", default=None, help="where a pin joins more than two")
    other: int | None = whole("Links, second", 1, 999, pair="links", default=None)
    coefficient: float = number("Coefficient", 0.0, 10.0, step=0.01)
    radius_mm: float | None = length("Radius", help="of a pin", default=None)
    length_mm: float | None = length(
        "Length", help="of a slide: both edges carry half the normal force, ± moment/length", default=None
    )


@frozen
class LoadPoint:
    """A row of a force table over the turn."""

    deg: float = number("Cam angle", 0.0, 360.0)
    value: float = number("Force", help="torque, where it turns")


@frozen(kw_only=True)
class Process:
    """A force or torque over a part of the turn, at a part of the motion, or as a table over the turn.

    Without a link it acts on the output along its motion: N where that slides, N m where it swings. At a point of a link it is a
    force in a direction of the global frame, and a torque on the link.
    """

    cam_from_deg: float | None = number("From cam angle", 0.0, 360.0, default=None, step=1.0, help="of the drive")
    cam_to_deg: float | None = number(
        "To cam angle", 0.0, 360.0, default=None, step=1.0, help="if less than the start, the range passes 360°"
    )
    position_from_mm: float | None = coordinate("From position", default=None, help="of the motion")
    position_to_mm: float | None = coordinate("To position", default=None, help="of the motion")
    position_from_deg: float | None = number("From position", -3600.0, 3600.0, default=None, help="of the motion")
    position_to_deg: float | None = number("To position", -3600.0, 3600.0, default=None, help="of the motion")
    force_n: float = number("Force", default=0.0, help="along +guide or direction")
    torque_nm: float = number("Torque", default=0.0, help="along the motion; on a link counter-clockwise")
    link: int | None = whole("Link", 2, 999, default=None, help="on which it acts; empty = the output")
    point: str | None = placed(FileLayout(), None)
    direction_deg: float | None = number(
        "Direction", -360.0, 360.0, default=None, help="of the force, in the global frame"
    )
    points: tuple[LoadPoint, ...] = placed(FileLayout(LoadPoint, rows=True, whole=True), ())


# -- valve springs ----------------------------------------------------------------------------------------------


@frozen(kw_only=True)
class ValveSpring:
    """Helical compression spring that closes a valve; nested springs are several."""

    wire_mm: float = length("Wire", help="diameter")
    coil_mm: float = length("Coil", help="mean diameter, of the wire's centre")
    active_coils: float = number("Active coils", 0.0, 1000.0, open_low=True, step=0.5)
    total_coils: float = number("Total coils", 0.0, 1000.0, open_low=True, step=0.5, help="solid length over wire")
    free_mm: float = length("Free length")
    installed_mm: float = length("Installed length", help="valve closed")
    shear_modulus_gpa: float = number("Shear modulus", 0.0, open_low=True, default=79.3)
    density_kg_m3: float = number("Density", 0.0, open_low=True, default=7850.0, help="of the wire")
    damping_ratio: float = number(
        "Damping ratio", 0.0, 0.99, default=0.02, step=0.01, help="of the first mode of surge"
    )
    tensile_mpa: float | None = number(
        "Tensile strength", 0.0, open_low=True, default=None, help="of the wire; empty = no check of its fatigue"
    )
    peened: bool = flag("Shot-peened", default=True)


def valve_springs() -> Any:
    """Dataclass field for the springs that close a valve."""
    return placed(FileLayout(ValveSpring), ())


@frozen(kw_only=True)
class ForceElements:
    """Force elements of any loads, and the elasticity of the follower between its mass and the cam."""

    follower_stiffness_n_per_mm: float | None = number(
        "Follower stiffness",
        0.0,
        default=None,
        help="at the roller's centre, or the contact, along its path; empty or 0 = rigid",
    )
    follower_damping_ratio: float | None = number(
        "Follower damping ratio", 0.0, 0.99, default=None, step=0.01, help="of critical damping; empty = 0"
    )
    springs: tuple[PointSpring, ...] = placed(FileLayout(PointSpring), ())
    torsion_springs: tuple[TorsionSpring, ...] = placed(FileLayout(TorsionSpring), ())
    pair_friction: tuple[PairFriction, ...] = placed(FileLayout(PairFriction), ())
    process: tuple[Process, ...] = placed(FileLayout(Process), ())


ELEMENT_LISTS = ("springs", "torsion_springs", "pair_friction", "process")
"""The lists of force elements in the table ``loads``."""
