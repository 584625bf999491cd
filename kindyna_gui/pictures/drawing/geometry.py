"""Geometry of a study for the drawing: positions of bodies, points, pairs and the cam over one turn, in mm.

This module only changes units and frames; it contains no case for a particular follower.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from core.cam import CamShape, FaceOutline, Flank, keyway_corners, row_of
from core.dynamics import Element, Inertia, OutputForce, Spring, body_inertias
from core.errors import NoSolution
from core.followers import FACE_PLACE
from core.frozen import frozen
from core.mechanism import body_name
from core.mechanism.drivers import Wheel, WheelPair, wheel_pairs
from core.mechanism.kinematics import FRAME, SLIDING, Kinematics, Pair
from core.motion.program import ShaftPosition
from core.study import Study
from kindyna_gui.pictures.units import nearest
from kindyna_gui.requirements import lists_links

if TYPE_CHECKING:
    from core.spatial.shape import SpatialShape
    from core.spatial.views import CamViews
    from core.study.clearances import Clearances

MM = 1e3  # mm in a metre
UNITS_ACROSS = 110.0  # size of a mechanism in units of its symbols
UNIT_STEPS = 60  # sizes that symbols may have, per factor of ten
BEARING = 8.0  # units from the centre of a cam that cannot be drawn, for its bearing
EXTERNAL_KEYS = ("external_force_n", "force_n", "torque_nm")
TEXT_ROOM = 0.25  # of a force's value next to a cam in space, by the cam's extent
FAR = 0.15  # an instant centre farther outside than this fraction of the mechanism's size does not widen the view


@frozen(eq=False)
class Body:
    """One body over the turn.

    Attributes
    ----------
    z : origin (n,) [mm]
    turn : unit vector of its x axis (n,)
    points : points in the frame of the body [mm]
    rotation : function that returns the angle of its x axis without jumps (n,) [rad]
    """

    name: str
    z: np.ndarray
    turn: np.ndarray
    points: Mapping[str, complex]
    rotation: Callable[[], np.ndarray]

    @cached_property
    def angle(self) -> np.ndarray:
        """Rotation without jumps (n,) [deg], counter-clockwise; few parts need it."""
        return np.rad2deg(self.rotation())

    @cached_property
    def swing(self) -> float:
        """Angle that the body sweeps over the turn [deg]; where it is above 180, only that it is."""
        return float(np.ptp(np.rad2deg(np.angle(self.turn * self.turn[0].conjugate()))))

    def track(self, local: complex) -> np.ndarray:
        """Path (n,) [mm] of a point that is given in the frame of the body."""
        return self.z if local == 0 else self.z + local * self.turn

    @cached_property
    def nodes(self) -> dict[str, complex]:
        """Distinct points of the body by name [mm]; of points that coincide the first."""
        size = max((abs(p) for p in self.points.values()), default=0.0)
        nodes: dict[str, complex] = {}
        for name, point in self.points.items():
            if all(abs(point - node) > 1e-9 * size for node in nodes.values()):
                nodes[name] = point
        return nodes


@frozen(eq=False)
class Joint:
    """One pair over the turn; the last five attributes apply to a sliding pair.

    Attributes
    ----------
    track : path of its point (n,) [mm]
    line, root : direction of the slide, and a point of it [mm], both in the frame of ``pair.on``
    low, high : range of the travel along the slide, from ``root`` [mm]
    body_line : direction of the slide in the frame of ``pair.body``
    """

    name: str
    pair: Pair
    track: np.ndarray
    line: complex = 0j
    root: complex = 0j
    low: float = 0.0
    high: float = 0.0
    body_line: complex = 0j

    @property
    def is_fixed(self) -> bool:
        """Whether the pair is on the frame."""
        return self.pair.on == FRAME

    @property
    def outward_sign(self) -> float:
        """Sign of the direction along the slide that points away from the cam centre: 1 or -1."""
        return 1.0 if (self.root * self.line.conjugate()).real >= 0.0 else -1.0

    @property
    def farthest(self) -> float:
        """Travel outwards from the root [mm]."""
        return self.high if self.outward_sign > 0 else -self.low


def _joint(name: str, pair: Pair, bodies: Mapping[str, Body]) -> Joint:
    body, n = bodies[pair.body], bodies[pair.body].z.size
    on = bodies.get(pair.on) or Body(
        FRAME, np.zeros(n, dtype=complex), np.ones(n, dtype=complex), {}, partial(np.zeros, n)
    )
    if pair.kind == SLIDING and pair.on == f"link{pair.point}":  # the sliding link is the block, in either order
        turn = on.turn[0] / body.turn[0]
        return _joint(name, Pair(SLIDING, pair.body, pair.on, pair.point, complex(pair.axis * turn)), bodies)
    track = body.track(body.points[pair.point])
    if pair.kind != SLIDING:
        return Joint(name, pair, track)
    path = (track - on.z) * on.turn.conj()
    along = ((path - path[0]) * pair.axis.conjugate()).real
    body_line = pair.axis * on.turn[0] / body.turn[0]
    return Joint(
        name, pair, track, pair.axis, complex(path[0]), float(along.min()), float(along.max()), complex(body_line)
    )


@frozen(eq=False)
class OutlinedDrive:
    """A drive among the outlines of all drives: their clearances, its number, and its position on the shaft."""

    clearances: Clearances
    number: int = 0
    position: ShaftPosition = ShaftPosition()

    @property
    def is_mirrored(self) -> bool:
        """Whether the drive is seen from the other end of the shaft."""
        mirrored: bool = self.clearances.design.drives[self.number].mirrored
        return mirrored

    def is_like(self, other: OutlinedDrive) -> bool:
        """Whether another one has the same drawing."""
        same = self.clearances is other.clearances and self.number == other.number
        return same and self.position == other.position


class Geometry:
    """A study's mechanism in mm at its n cam angles.

    ``shape`` is None where the cam has no solution; ``outlined`` is the drive among the outlines of several. Raises NoSolution
    where the linkage has none.
    """

    def __init__(self, study: Study, outlined: OutlinedDrive | None = None) -> None:
        self.study, self.outlined = study, outlined
        self.kinematics: Kinematics = study.linkage
        self.shape: CamShape | None = _shape(study)
        self.surface: SpatialShape | None = _surface(study)
        self.rotation_sign = study.sense
        self.has_numbered_links, self.has_cam = lists_links(study.design), study.has_disk
        self.cam_angle = np.rad2deg(study.theta)
        self.cam_rotation = self.rotation_sign * self.cam_angle
        self.bodies = {
            name: Body(
                name,
                pose.origin[0] * MM,
                pose.unit,
                {k: p * MM for k, p in pose.points.items()},
                partial(pose.turn.__getitem__, 0),
            )
            for name, pose in self.kinematics.bodies.items()
        }
        self.joints = tuple(_joint(name, pair, self.bodies) for name, pair in self.kinematics.pairs.items())
        self.reference = self.bodies[self.kinematics.follower_body].z
        self.base_radius = self._base_radius()

    def _base_radius(self) -> float:
        """Base radius of the design [mm]; where the design has none, the least radius of the profile."""
        typed: float | None = getattr(self.study.design.drive.cam, "base_radius_mm", None)
        if typed is not None:
            return typed
        return float(np.abs(self.profile).min()) if self.profile.size else 0.0

    @property
    def known_circles(self) -> tuple[tuple[str, float], ...]:
        """Name and radius [mm] of the hub and the bore, where given."""
        cam = self.study.design.drive.cam
        known = ((name, getattr(cam, f"{name}_mm", None)) for name in ("hub", "bore"))
        return tuple((name, 0.5 * diameter) for name, diameter in known if diameter)

    @property
    def keyway(self) -> tuple[complex, ...]:
        """Corners of the keyway in the cam's frame [mm]; empty where it is not given."""
        return keyway_corners(self.study.design.drive.cam) if self.has_cam or self.space is not None else ()

    def nearest(self, theta: float) -> int:
        """Index of the sample nearest to an angle [rad]."""
        return nearest(self.study.theta, theta)

    @property
    def is_full_turn(self) -> bool:
        """Whether the mechanism can be assembled at every angle of the turn."""
        return self.samples == self.study.samples

    @cached_property
    def moving(self) -> dict[str, Body]:
        """All bodies but the frame, by name."""
        return {name: body for name, body in self.bodies.items() if name != FRAME}

    @property
    def samples(self) -> int:
        """Number n of cam angles."""
        return int(self.cam_angle.size)

    @cached_property
    def profile(self) -> np.ndarray:
        """Cam profile in the cam's frame (n,) [mm]; empty without a cam."""
        return np.zeros(0, dtype=complex) if self.shape is None else self.shape.flank.profile * MM

    @cached_property
    def pitch(self) -> np.ndarray:
        """Pitch curve in the cam's frame (n,) [mm]; empty without a cam, or where the face has no centre."""
        return np.zeros(0, dtype=complex) if self.shape is None else self.shape.flank.pitch * MM

    @cached_property
    def face_radius(self) -> float:
        """Radius of the follower's face [mm]; 0 for a flat face, for an edge, and without a cam."""
        if self.shape is None:
            return 0.0
        radius: float = self.study.design.drive.face.radius_mm
        return radius if radius and radius > 1e-9 * abs(self.pitch[0]) else 0.0

    @property
    def face_turn(self) -> np.ndarray:
        """Unit vector of the x axis of the body that carries the face (n,)."""
        return self.bodies[self.kinematics.follower_body].turn

    @property
    def has_rolling_face(self) -> bool:
        """Whether the face is a roller."""
        return self.shape is not None and row_of(self.study.design.drive.face).rolls

    @cached_property
    def face_outline(self) -> np.ndarray:
        """Closed outline of the face in the frame of the follower's body (m,) [mm]; empty without a cam."""
        return np.zeros(0, dtype=complex) if self._face is None else self._face.points * MM

    @cached_property
    def _face(self) -> FaceOutline | None:
        if self.shape is None:
            return None
        face = self.study.design.drive.face
        return row_of(face).outline(self.shape, face, self.kinematics)

    @cached_property
    def face_attachment(self) -> complex:
        """Point where the face is attached, in the frame of the follower's body [mm].

        It is the reference point, or the middle of the back of a face that is not round.
        """
        return 0j if self._face is None or self.face_radius else self._face.attachment * MM

    def handles(self, index: int) -> dict[str, complex]:
        """Positions at a sample [mm] of everything that can be dragged.

        These are the points of bodies by name, the middle of a face that is not round, and the ends of springs and the
        centres of mass by field path.
        """
        positions = {
            name: complex(body.track(at)[index]) for body in self.bodies.values() for name, at in body.points.items()
        }
        if self.face_attachment:
            along = 1j * self.face_attachment.imag * self.face_turn[index]
            positions[FACE_PLACE] = complex(self.reference[index] + along)
        for spring, start, end in self.springs:
            positions |= {f"{spring.field}.from": complex(start[index]), f"{spring.field}.to": complex(end[index])}
        for i, row in enumerate(getattr(self.study.design.drive.loads, "masses", ())):
            body = self.bodies[self.study.mechanism.bodies[row.link]]
            track = body.track(complex(row.centre_x_mm, row.centre_y_mm))
            positions[f"loads.masses[{i}]"] = complex(track[index])
        return positions | self._corners(index)

    def _corners(self, index: int) -> dict[str, complex]:
        """Positions of the corners of outlines at a sample [mm], by their paths."""
        design, corners = self.study.design, dict[str, complex]()
        if not design.outlines:
            return corners
        from core.design.outline_bodies import body_of  # few designs have outlines
        from core.followers.outline_frames import outline_frame

        for i, outline in enumerate(design.outlines):
            body = body_of(design, outline)
            if body is not None and outline.plane is None:
                origin, axis = outline_frame(design, self.kinematics, body)
                for j, point in enumerate(outline.points):
                    local = complex(point.x_mm, point.y_mm)
                    corners[f"outlines[{i}].points[{j}]"] = complex(origin[index]) * MM + local * complex(axis[index])
        return corners

    @property
    def face_path(self) -> str:
        """Path of the field that gives the radius of the follower's face."""
        return "follower.shoe_radius_mm" if self.study.design.drive.face.slides else "cam.roller_radius_mm"

    def rims(self, index: int) -> dict[str, tuple[complex, float]]:
        """Circles whose radius can be dragged at a sample: centre and radius [mm] by field path."""
        if self.space is not None:
            return self._rims_in_space(index)
        round_face = {self.face_path: (complex(self.reference[index]), self.face_radius)} if self.face_radius else {}
        return {"cam.base_radius_mm": (0j, self.base_radius), **round_face}

    def _rims_in_space(self, index: int) -> dict[str, tuple[complex, float]]:
        """Circles of a barrel cam in its end view, and the roller of an arm, which is seen along its axis."""
        assert self.space is not None
        machine, (outer, inner) = self.space.machine, self.space.radii
        if machine.kind != "barrel":
            return {}
        circles = {"cam.outer_radius_mm": (self.axis, outer * MM), "cam.roller_inner_mm": (self.axis, inner * MM)}
        if machine.slides or machine.is_turret:
            return circles
        roller = self.space.roller_track(self.study.surface.motion.y[index : index + 1])
        return {**circles, "cam.roller_radius_mm": (complex(roller[0]) * MM, machine.radius * MM)}

    def nodes(self, body: Body) -> dict[str, complex]:
        """Points [mm] in a body's frame between which the body is drawn.

        A follower that does not slide has the point where its face is attached in place of the reference point.
        """
        slides = any(joint.pair.kind == SLIDING and joint.pair.body == body.name for joint in self.joints)
        if body.name != self.kinematics.carrier or slides or not self.face_attachment:
            return body.nodes
        turn = body.turn[0].conjugate()
        reference = complex((self.reference[0] - body.z[0]) * turn)
        near = 1e-9 * max(map(abs, (reference, self.face_attachment)))
        paired = {joint.pair.point for joint in self.joints}
        nodes = {name: node for name, node in body.nodes.items() if name in paired or abs(node - reference) > near}
        return {
            **nodes,
            "face": complex(reference + self.face_attachment * turn * self.face_turn[0]),
        }

    @cached_property
    def other_flanks(self) -> tuple[Flank, ...]:
        """All flanks of the cam but the first; empty without a cam."""
        return () if self.shape is None else self.shape.flanks[1:]

    @cached_property
    def other_rollers(self) -> tuple[tuple[str, np.ndarray, float], ...]:
        """Rollers on the other flanks, except the follower's face: name of the flank, centre (n,) [mm], radius [mm]."""
        return tuple(
            (flank.name, flank.reference * MM, flank.radius * MM)
            for flank in self.other_flanks
            if self.shape is not None and flank.reference is not self.shape.reference
        )

    @cached_property
    def space(self) -> CamViews | None:
        """Side view and end view of a cam in space; None without one, or where it has no solution."""
        return None if self.surface is None else space_views(self.study)

    @cached_property
    def view_boxes(self) -> tuple[tuple[complex, complex], ...]:
        """Lower left and upper right corner of a cam in space in the side view and the end view [mm]; empty without one."""
        return () if self.space is None else tuple((low * MM, high * MM) for low, high in self.space.boxes)

    @cached_property
    def axis(self) -> complex:
        """Axis of the cam where it is seen from its end [mm]; a disk cam turns about the origin."""
        return 0j if self.space is None else self.space.end_origin * MM

    def cam_turn(self, index: int) -> complex:
        """Unit vector of the cam's x axis at a sample."""
        return cmath.rect(1.0, math.radians(self.cam_rotation[index]))

    def contact(self, index: int) -> complex:
        """Contact point of cam and follower in the global frame at a sample [mm]."""
        return complex(self.profile[index]) * self.cam_turn(index)

    @cached_property
    def bearing_room(self) -> float:
        """Least distance of the cam profile from the cam centre [mm]; a few symbol sizes where it is unknown."""
        return float(np.abs(self.profile).min()) if self.profile.size else self.base_radius or BEARING * self.unit

    @cached_property
    def centre(self) -> np.ndarray:
        """Instant centre Q of follower and cam (n,) [mm]; infinite where it is at infinity or unknown."""
        if self.shape is None:
            return np.full(self.samples, complex(np.inf, np.inf))
        with np.errstate(invalid="ignore"):  # infinite times the 0 in x + iy
            return np.asarray(self.shape.centre.finite * MM)

    # -- sizes -----------------------------------------------------------------------------------------

    def tracks(self) -> Iterator[np.ndarray]:
        """Path over the turn (n,) [mm] of every point of every body."""
        for body in self.bodies.values():
            for node in body.nodes.values():
                yield body.track(node)

    @cached_property
    def core_box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of all moving parts over the turn [mm]."""
        widest = self.pitch if self.pitch.size else self.profile
        sweep = float(np.abs(widest).max()) if widest.size else self.base_radius
        sweep = max([sweep, *(float(np.abs(flank.profile).max()) * MM for flank in self.other_flanks)])
        boxes = [(-sweep, -sweep, sweep, sweep)] if self.has_cam else []
        boxes += [(low.real, low.imag, high.real, high.imag) for low, high in self.view_boxes]
        if boxes and self.external and self.space is not None and self.space.machine.slides:
            room = TEXT_ROOM * boxes[0][2]  # for the value of a force at the end of the slide's travel
            boxes.append((boxes[0][0] - room, 0.0, boxes[0][2], 0.0))
        if self.space is not None and self.space.machine.is_turret:
            reach = self.space.turret_reach * MM
            boxes.append((-reach, -reach, reach, reach))
        corners = tuple(self.face_outline[:-1]) if self.face_outline.size and not self.face_radius else ()
        turn = self.face_turn
        rounds = (
            *((track, 0.0) for track in self.tracks()),
            *((self.reference + corner * turn, 0.0) for corner in corners),
            (self.reference, self.face_radius),
            *((track, radius) for _, track, radius in self.other_rollers),
            *((self.centre_of(wheel), wheel.radius) for pair in self.wheels for wheel in pair.circles),
        )
        for z, r in rounds:
            boxes.append((z.real.min() - r, z.imag.min() - r, z.real.max() + r, z.imag.max() + r))
        left, low, right, high = np.array(boxes).T
        return complex(left.min(), low.min()), complex(right.max(), high.max())

    @cached_property
    def wheels(self) -> tuple[WheelPair, ...]:
        """Wheel pairs of the second inputs, where their radii are known."""
        drive = self.study.design.drive
        return tuple(wheel_pairs(drive.linkage)) if self.has_numbered_links and drive.linkage.drivers else ()

    def centre_of(self, wheel: Wheel) -> np.ndarray:
        """Path of a wheel's centre (n,) [mm]."""
        body = self.bodies[body_name(wheel.link)]
        return body.track(body.points[wheel.point])

    @property
    def middle(self) -> complex:
        """Centre of the box around all moving parts [mm]."""
        low, high = self.core_box
        return 0.5 * (low + high)

    @cached_property
    def unit(self) -> float:
        """Size of the symbols [mm] for the mechanism's size, in steps, so that a small edit does not change it."""
        low, high = self.core_box
        size = abs(high - low) / UNITS_ACROSS
        return float(10.0 ** (np.round(UNIT_STEPS * np.log10(size)) / UNIT_STEPS))

    def has_same_positions(self, other: Geometry) -> bool:
        """Whether all positions agree with another geometry; only speed and loads may differ."""
        return (
            self.kinematics is other.kinematics
            and self.shape is other.shape
            and self.space is other.space
            and (self.rotation_sign, self.base_radius, self.known_circles)
            == (other.rotation_sign, other.base_radius, other.known_circles)
            and (self.keyway, self.has_spring) == (other.keyway, other.has_spring)
            and self.outlined is other.outlined
            and (self.study.design.outlines, self.study.design.clearances)
            == (other.study.design.outlines, other.study.design.clearances)
        )

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """Active force elements except the masses; empty where the loads have no solution."""
        try:
            return tuple(element for element in self.study.loading.others if element.is_active)
        except NoSolution:
            return ()

    @cached_property
    def inertias(self) -> Mapping[str, Inertia]:
        """Body -> inertia of its masses; empty where the loads have no solution."""
        try:
            return body_inertias(self.study.loading)
        except NoSolution:
            return {}

    @cached_property
    def has_spring(self) -> bool:
        """Whether a spring holds the follower on the cam."""
        return any(isinstance(element, OutputForce) and self.is_closing_spring(element) for element in self.elements)

    def is_closing_spring(self, element: OutputForce) -> bool:
        """Whether a force on the output is a spring, not an external force only."""
        return not self.is_motion_only and (bool(element.rate) or not self.external)

    @property
    def is_motion_only(self) -> bool:
        """Whether the design is a motion without a mechanism."""
        return self.study.design.drive.is_alone

    @property
    def external(self) -> float:
        """External force or torque on the output along its motion, as given [N or N·m]."""
        loads = self.study.design.drive.loads
        return float(next((v for key in EXTERNAL_KEYS if (v := getattr(loads, key, 0.0))), 0.0))

    @cached_property
    def springs(self) -> tuple[tuple[Spring, np.ndarray, np.ndarray], ...]:
        """Springs and dampers with the paths of both ends (n,) [mm]; empty where the loads have no solution."""
        springs = [element for element in self.elements if isinstance(element, Spring)]
        ends = ((spring, spring.ends(self.kinematics)) for spring in springs)
        return tuple((spring, MM * start, MM * end) for spring, (start, end) in ends)

    @cached_property
    def near_centres(self) -> np.ndarray:
        """Positions of the instant centre near enough to be included in the view (m,) [mm]."""
        low, high = self.core_box
        room = FAR * abs(high - low)
        q = self.centre[np.isfinite(self.centre)]
        inside = (np.abs(q.real - (low + high).real / 2) < (high - low).real / 2 + room) & (
            np.abs(q.imag - (low + high).imag / 2) < (high - low).imag / 2 + room
        )
        return q[inside]


def space_views(study: Study) -> CamViews:
    """Side view and end view of a study with a cam in space. Raises NoCam where none is possible."""
    from core.study.spatial_views import spatial_views  # few designs have a cam in space

    return spatial_views(study)


def _surface(study: Study) -> SpatialShape | None:
    if not study.has_surface:
        return None
    try:
        return study.surface
    except NoSolution:
        return None


def _shape(study: Study) -> CamShape | None:
    if not study.has_disk:
        return None
    try:
        shape: CamShape = study.cam
    except NoSolution:
        return None
    return shape
