"""A mechanism over one turn as data: positions of its bodies, its slides and supports, and its cam with the follower's face.

Lengths are in mm. Web page, drawings and files are made from this data.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import numpy as np

from core.cam import CamShape, keyway_corners, row_of
from core.errors import NoSolution
from core.frozen import frozen
from core.mechanism.kinematics import FRAME, SLIDING, Kinematics, Pose
from core.study import Study

MM = 1e3


@frozen(eq=False)
class SceneBody:
    """One body over the turn.

    Attributes
    ----------
    name : name of the body
    pose : its position
    count : number n of angles
    """

    name: str
    pose: Pose
    count: int

    @cached_property
    def z(self) -> np.ndarray:
        """Origin (n,) complex [mm]."""
        return np.broadcast_to(self.pose.origin[0] * MM, self.count)

    @cached_property
    def angle(self) -> np.ndarray:
        """Angle of its x axis (n,) [rad]."""
        return np.broadcast_to(self.pose.turn[0], self.count)

    @cached_property
    def unit(self) -> np.ndarray:
        """Unit vector of its x axis (n,)."""
        return np.broadcast_to(self.pose.unit, self.count)

    @cached_property
    def points(self) -> dict[str, complex]:
        """Points in its frame [mm]."""
        return {name: local * MM for name, local in self.pose.points.items()}

    def track(self, name: str) -> np.ndarray:
        """Path of a point.

        Returns
        -------
        ndarray (n,) complex [mm]
        """
        return np.broadcast_to(self.pose.position(name) * MM, self.count)

    def placed(self, points: np.ndarray) -> np.ndarray:
        """Points of its frame at the first angle, in the global frame.

        Parameters
        ----------
        points : ndarray (m,) complex [mm]

        Returns
        -------
        ndarray (m,) complex [mm]
        """
        return np.asarray(self.z[0] + points * self.unit[0])

    @cached_property
    def nodes(self) -> dict[str, complex]:
        """Distinct points of the body by name [mm]; of points that coincide the first."""
        size = max((abs(p) for p in self.points.values()), default=0.0)
        nodes: dict[str, complex] = {}
        for name, place in self.points.items():
            if all(abs(place - node) > 1e-9 * size for node in nodes.values()):
                nodes[name] = place
        return nodes


@frozen(eq=False)
class Slide:
    """A sliding pair: a block on a guide.

    Attributes
    ----------
    name : name of the pair
    body, on : names of the body that is the block, and of the body with the guide
    z : middle of the block (n,) complex [mm]
    line : unit vector of the guide (n,)
    low, high : range of the travel along the guide over the turn [mm], from the first position
    """

    name: str
    body: str
    on: str
    z: np.ndarray
    line: np.ndarray
    low: float
    high: float

    @property
    def outwards(self) -> float:
        """Sign of the direction along the guide that points away from the origin, where a camshaft is."""
        return 1.0 if (self.z[0] * self.line[0].conjugate()).real >= 0.0 else -1.0


@frozen(eq=False)
class Face:
    """The follower's face.

    Attributes
    ----------
    outline : closed outline in its own frame (m,) complex [mm]
    radius : of a round face [mm], else 0
    rolls : whether it is a roller
    attachment : point where the follower's body ends, in the frame of the face [mm]
    """

    outline: np.ndarray
    radius: float
    rolls: bool
    attachment: complex


class Scene:
    """The mechanism of a study. Raises NoSolution where it cannot be assembled."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.kinematics: Kinematics = study.linkage
        self.sense: float = study.sense

    @property
    def theta(self) -> np.ndarray:
        """Angles (n,) [rad] of cam or driver."""
        return np.asarray(self.study.theta)

    @cached_property
    def bodies(self) -> dict[str, SceneBody]:
        """Bodies by name, the frame first."""
        return {name: SceneBody(name, pose, self.theta.size) for name, pose in self.kinematics.bodies.items()}

    @cached_property
    def slides(self) -> tuple[Slide, ...]:
        """Sliding pairs in order."""
        return tuple(self._slides())

    def _slides(self) -> Iterator[Slide]:
        for name, pair in self.kinematics.pairs.items():
            if pair.kind != SLIDING:
                continue
            is_swapped = pair.on == f"link{pair.point}"  # the link that the point is named after is the block
            body, on = (pair.on, pair.body) if is_swapped else (pair.body, pair.on)
            block, guide = self.bodies[body], self.bodies.get(on)
            z = block.track(pair.point)
            line = np.broadcast_to(self.kinematics.line(pair), z.shape)
            path = z if guide is None else (z - guide.z) * guide.unit.conj()
            local = line[0] if guide is None else line[0] * guide.unit[0].conjugate()
            along = ((path - path[0]) * local.conjugate()).real
            yield Slide(name, body, on, z, line, float(along.min()), float(along.max()))

    @cached_property
    def pivots(self) -> dict[str, complex]:
        """Pairs on the frame that turn: name -> position [mm]."""
        return {
            name: complex(self.bodies[pair.body].track(pair.point)[0])
            for name, pair in self.kinematics.pairs.items()
            if pair.on == FRAME and pair.kind != SLIDING
        }

    @property
    def stem(self) -> Slide | None:
        """The guide of a follower that consists of a stem with the face; None for other mechanisms."""
        is_stem = len(self.kinematics.pairs) == 1 and len(self.slides) == 1 and self.has_cam
        return self.slides[0] if is_stem and self.slides[0].body == self.kinematics.carrier else None

    # -- cam -------------------------------------------------------------------------------------------

    @property
    def has_cam(self) -> bool:
        """Whether the design has a cam, which may have no solution."""
        return self.study.has_disk

    @cached_property
    def shape(self) -> CamShape | None:
        """Shape of the cam; None without a cam, or where it has no solution."""
        if not self.has_cam:
            return None
        try:
            shape: CamShape = self.study.cam
        except NoSolution:
            return None
        return shape

    @property
    def flanks(self) -> dict[str, np.ndarray]:
        """Profiles (n,) complex [mm] in the frame of the cam by the name of their flank."""
        return {} if self.shape is None else {flank.name: flank.profile * MM for flank in self.shape.flanks}

    @property
    def pitch(self) -> np.ndarray:
        """Pitch curve (n,) complex [mm] in the frame of the cam; empty where there is none."""
        return np.zeros(0, dtype=complex) if self.shape is None else self.shape.flank.pitch * MM

    @property
    def circles(self) -> dict[str, float]:
        """Radii of hub and bore [mm], where given."""
        cam: Any = self.study.design.drive.cam
        known = ((name, getattr(cam, f"{name}_mm", None)) for name in ("hub", "bore"))
        return {name: 0.5 * diameter for name, diameter in known if diameter}

    @property
    def keyway(self) -> tuple[complex, ...]:
        """Corners of the keyway in the frame of the cam [mm]; empty where it is not given."""
        return keyway_corners(self.study.design.drive.cam) if self.has_cam else ()

    @property
    def cam_angle(self) -> np.ndarray:
        """Angle of the cam's x axis (n,) [rad]."""
        return np.asarray(self.sense * self.theta)

    @cached_property
    def face(self) -> Face | None:
        """The follower's face; None without a cam."""
        if self.shape is None:
            return None
        face: Any = self.study.design.drive.face
        row = row_of(face)
        known = row.outline(self.shape, face, self.kinematics)
        reach = float(np.abs(self.shape.reference[0])) * MM
        radius = float(face.radius_mm or 0.0)
        radius = radius if radius > 1e-9 * reach else 0.0
        return Face(known.points * MM, radius, row.rolls, 0j if radius else known.attachment * MM)

    @property
    def face_body(self) -> SceneBody:
        """The body in whose frame the face is given."""
        return self.bodies[self.kinematics.follower_body]

    @property
    def further_rollers(self) -> tuple[tuple[float, np.ndarray], ...]:
        """Rollers on the other flanks: radius [mm] and centre (n,) complex [mm]."""
        if self.shape is None:
            return ()
        flanks = (flank for flank in self.shape.flanks[1:] if flank.reference is not self.shape.reference)
        return tuple((flank.radius * MM, flank.reference * MM) for flank in flanks)


def edge_radius(profile: np.ndarray) -> float:
    """Radius at which the cam's x axis leaves the profile.

    Parameters
    ----------
    profile : ndarray (n,) complex [mm]
        Closed curve in the frame of the cam.

    Returns
    -------
    float [mm]
    """
    following = np.roll(profile, -1)
    cut = np.flatnonzero((profile.imag <= 0.0) != (following.imag <= 0.0))
    start, end = profile[cut], following[cut]
    return float((start.real - start.imag * (end.real - start.real) / (end.imag - start.imag)).max())
