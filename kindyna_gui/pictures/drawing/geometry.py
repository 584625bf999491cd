"""What a drawing of a mechanism reads from a study: places over one turn in mm, by bodies, points and pairs.

Nothing is computed here that is not a change of unit or of frame; no follower is known by name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from core.cam import CamShape, FaceOutline, Flank, keyway_corners, row_of
from core.dynamics import Element, OutputForce, Spring
from core.errors import NoSolution
from core.followers import FACE_PLACE
from core.frozen import frozen
from core.mechanism import body_name
from core.mechanism.drivers import Wheel, WheelPair, wheel_pairs
from core.mechanism.kinematics import FRAME, SLIDING, Kinematics, Pair
from core.study import Study
from kindyna_gui.pictures.units import nearest
from kindyna_gui.requirements import lists_links

MM = 1e3  # mm in a metre
UNITS_ACROSS = 110.0  # size of a mechanism in units of its symbols
UNIT_STEPS = 60  # sizes that symbols may have, per factor of ten
BEARING = 8.0  # units from the centre of a cam that cannot be drawn, for its bearing
EXTERNAL = ("external_force_n", "force_n", "torque_nm")
FAR = 0.15  # an instant centre further outside than this part of the mechanism's size does not widen the picture


@frozen(eq=False)
class Body:
    """One body: origin (n,) [mm], angle (n,) [deg, counter-clockwise] and its x axis, a unit vector (n,), own points [mm] in its
    frame, of which those that coincide count once."""

    name: str
    z: np.ndarray
    angle: np.ndarray
    turn: np.ndarray
    points: Mapping[str, complex]

    def track(self, local: complex) -> np.ndarray:
        """Where a point of the body is (n,) [mm]."""
        return self.z if local == 0 else self.z + local * self.turn

    @cached_property
    def nodes(self) -> dict[str, complex]:
        """Name -> place [mm] in the frame of the body, of points at one place the first."""
        size = max((abs(p) for p in self.points.values()), default=0.0)
        kept: dict[str, complex] = {}
        for name, place in self.points.items():
            if all(abs(place - other) > 1e-9 * size for other in kept.values()):
                kept[name] = place
        return kept


@frozen(eq=False)
class Joint:
    """One pair: where its point is (n,) [mm].

    Of a sliding pair also: ``line``, its direction, and ``root``, a point of it [mm], in the frame of ``on``; ``low``
    and ``high``, how far the point travels along it [mm]; ``own``, its direction in the frame of ``body``.
    """

    name: str
    pair: Pair
    track: np.ndarray
    line: complex = 0j
    root: complex = 0j
    low: float = 0.0
    high: float = 0.0
    own: complex = 0j

    @property
    def fixed(self) -> bool:
        return self.pair.on == FRAME

    @property
    def outwards(self) -> float:
        """Along its line away from the cam centre: 1 or -1."""
        return 1.0 if (self.root * self.line.conjugate()).real >= 0.0 else -1.0

    @property
    def farthest(self) -> float:
        """How far the point travels outwards from the root [mm]."""
        return self.high if self.outwards > 0 else -self.low


def _at_rest(n: int) -> Body:
    return Body(FRAME, np.zeros(n, dtype=complex), np.zeros(n), np.ones(n, dtype=complex), {})


def _joint(name: str, pair: Pair, bodies: Mapping[str, Body]) -> Joint:
    body, n = bodies[pair.body], bodies[pair.body].z.size
    on = bodies.get(pair.on) or _at_rest(n)
    if pair.kind == SLIDING and pair.on == f"link{pair.point}":  # the link that slides is the block, whichever is first
        turn = on.turn[0] / body.turn[0]
        return _joint(name, Pair(SLIDING, pair.body, pair.on, pair.point, complex(pair.axis * turn)), bodies)
    track = body.track(body.points[pair.point])
    if pair.kind != SLIDING:
        return Joint(name, pair, track)
    path = (track - on.z) * on.turn.conj()
    along = ((path - path[0]) * pair.axis.conjugate()).real
    own = pair.axis * on.turn[0] / body.turn[0]
    return Joint(name, pair, track, pair.axis, complex(path[0]), float(along.min()), float(along.max()), complex(own))


class Geometry:
    """A study as places in mm at its n cam angles.

    Raises NoSolution where the linkage has none; where only the cam has none, ``shape`` is None.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.kinematics: Kinematics = study.linkage
        self.shape: CamShape | None = _shape(study)
        self.sense = study.sense
        self.numbered, self.with_cam = lists_links(study.design), "cam" in study.stages
        self.cam_angle = np.rad2deg(study.theta)
        self.turned = self.sense * self.cam_angle
        self.bodies = {
            name: Body(
                name,
                pose.origin[0] * MM,
                np.rad2deg(pose.turn[0]),
                pose.unit,
                {k: p * MM for k, p in pose.points.items()},
            )
            for name, pose in self.kinematics.bodies.items()
        }
        self.joints = tuple(_joint(name, pair, self.bodies) for name, pair in self.kinematics.pairs.items())
        self.reference = self.bodies[self.kinematics.follower_body].z
        self.base_radius = self._base_radius()

    def _base_radius(self) -> float:
        """As typed, or where the cam's size follows from where its roller runs, the least radius of its outline [mm]."""
        typed: float | None = getattr(self.study.design.drive.cam, "base_radius_mm", None)
        if typed is not None:
            return typed
        return float(np.abs(self.profile).min()) if self.profile.size else 0.0

    @property
    def bored(self) -> tuple[tuple[str, float], ...]:
        """The circles of hub and bore, as far as they are known: name, radius [mm]."""
        cam = self.study.design.drive.cam
        known = ((name, getattr(cam, f"{name}_mm", None)) for name in ("hub", "bore"))
        return tuple((name, 0.5 * diameter) for name, diameter in known if diameter)

    @property
    def keyway(self) -> tuple[complex, ...]:
        """Its corners in the cam's own frame [mm], none where it is not known."""
        return keyway_corners(self.study.design.drive.cam) if self.with_cam else ()

    def nearest(self, theta: float) -> int:
        """The sample nearest to an angle [rad]."""
        return nearest(self.study.theta, theta)

    @property
    def whole_turn(self) -> bool:
        """Whether the mechanism can stand at every angle of the turn."""
        return self.samples == self.study.samples

    @cached_property
    def moving(self) -> dict[str, Body]:
        """The bodies that are drawn as such: all but the frame."""
        return {name: body for name, body in self.bodies.items() if name != FRAME}

    @property
    def samples(self) -> int:
        return int(self.cam_angle.size)

    @cached_property
    def profile(self) -> np.ndarray:
        """The cam's outline in its own frame (n,) [mm]; empty where there is no cam."""
        return np.zeros(0, dtype=complex) if self.shape is None else self.shape.flank.profile * MM

    @cached_property
    def pitch(self) -> np.ndarray:
        """The pitch curve in the cam's own frame (n,) [mm]; empty where there is no cam, or the face has no centre."""
        return np.zeros(0, dtype=complex) if self.shape is None else self.shape.flank.pitch * MM

    @cached_property
    def face_radius(self) -> float:
        """Radius of the follower's face on the cam [mm], 0 where it is flat or an edge, or there is no cam."""
        if self.shape is None:
            return 0.0
        radius: float = self.study.design.drive.face.radius_mm
        return radius if radius and radius > 1e-9 * abs(self.pitch[0]) else 0.0

    @property
    def face_angle(self) -> np.ndarray:
        """Of the body that carries it (n,) [deg]."""
        return self.bodies[self.kinematics.follower_body].angle

    @property
    def face_rolls(self) -> bool:
        """Whether the face turns on its own axis."""
        return self.shape is not None and row_of(self.study.design.drive.face).rolls

    @cached_property
    def face_outline(self) -> np.ndarray:
        """The face in the frame of the follower's body (m,) [mm], closed; empty where there is no cam."""
        return np.zeros(0, dtype=complex) if self._face is None else self._face.points * MM

    @cached_property
    def _face(self) -> FaceOutline | None:
        if self.shape is None:
            return None
        face = self.study.design.drive.face
        return row_of(face).outline(self.shape, face, self.kinematics)

    @cached_property
    def face_held(self) -> complex:
        """From where the follower holds its face, in the frame of the follower's body [mm]: its reference point, of a face
        without a round the middle of its back."""
        return 0j if self._face is None or self.face_radius else self._face.attachment * MM

    def handles(self, index: int) -> dict[str, complex]:
        """Where what may be drawn elsewhere stands at a sample [mm]: the points of bodies by their names, the middle of a
        face that has no round, the ends of springs and the centres of mass by their paths."""
        found = {
            name: complex(body.track(at)[index]) for body in self.bodies.values() for name, at in body.points.items()
        }
        if self.face_held:
            along = 1j * self.face_held.imag * np.exp(1j * np.deg2rad(self.face_angle[index]))
            found[FACE_PLACE] = complex(self.reference[index] + along)
        for spring, one, other in self.springs:
            found |= {f"{spring.field}.from": complex(one[index]), f"{spring.field}.to": complex(other[index])}
        for i, row in enumerate(getattr(self.study.design.drive.loads, "masses", ())):
            found[f"loads.masses[{i}]"] = complex(
                self._of_link(row.link).track(complex(row.centre_x_mm, row.centre_y_mm))[index]
            )
        return found

    @property
    def face_path(self) -> str:
        """The field of the radius of the follower's face."""
        return "follower.shoe_radius_mm" if self.study.design.drive.face.slides else "cam.roller_radius_mm"

    def rims(self, index: int) -> dict[str, tuple[complex, float]]:
        """The circles whose radius may be drawn larger or smaller at a sample: centre and radius [mm] by the field's path."""
        round_face = {self.face_path: (complex(self.reference[index]), self.face_radius)} if self.face_radius else {}
        return {"cam.base_radius_mm": (0j, self.base_radius), **round_face}

    def _of_link(self, number: int) -> Body:
        return self.bodies[self.study.mechanism.bodies[number]]

    def nodes(self, body: Body) -> dict[str, complex]:
        """The places [mm] in a body's frame between which it is drawn: its points, with the face's hold for its reference
        where it does not slide there."""
        slides = any(joint.pair.kind == SLIDING and joint.pair.body == body.name for joint in self.joints)
        if body.name != self.kinematics.carrier or slides or not self.face_held:
            return body.nodes
        turn = np.exp(-1j * np.deg2rad(body.angle[0]))
        reference = complex((self.reference[0] - body.z[0]) * turn)
        near = 1e-9 * max(map(abs, (reference, self.face_held)))
        held = {joint.pair.point for joint in self.joints}
        kept = {name: place for name, place in body.nodes.items() if name in held or abs(place - reference) > near}
        return {
            **kept,
            "face": complex(reference + self.face_held * turn * np.exp(1j * np.deg2rad(self.face_angle[0]))),
        }

    @cached_property
    def further(self) -> tuple[Flank, ...]:
        """The flanks of the cam besides the first; none where there is no cam."""
        return () if self.shape is None else self.shape.flanks[1:]

    @cached_property
    def further_rollers(self) -> tuple[tuple[str, np.ndarray, float], ...]:
        """What touches those and is not the follower's face itself: name of the flank, centre (n,) [mm], radius [mm]."""
        return tuple(
            (flank.name, flank.reference * MM, flank.radius * MM)
            for flank in self.further
            if self.shape is not None and flank.reference is not self.shape.reference
        )

    @cached_property
    def contact(self) -> np.ndarray:
        """Where cam and follower touch, in the global frame (n,) [mm]."""
        return self.profile * np.exp(1j * np.deg2rad(self.turned))

    @cached_property
    def bearing_room(self) -> float:
        """Least distance of the cam's outline from its centre [mm]; of a cam of which nothing is known some symbols' size."""
        return float(np.abs(self.profile).min()) if self.profile.size else self.base_radius or BEARING * self.unit

    @cached_property
    def centre(self) -> np.ndarray:
        """The instant centre Q of follower and cam (n,) [mm]; infinite where it lies at infinity or is not known."""
        if self.shape is None:
            return np.full(self.samples, complex(np.inf, np.inf))
        return np.asarray(self.shape.centre.finite * MM)

    # -- sizes --------------------------------------------------------------------------------------------

    def tracks(self) -> Iterator[np.ndarray]:
        """The path of every point of every body over the turn (n,) [mm]."""
        for body in self.bodies.values():
            for place in body.nodes.values():
                yield body.track(place)

    @cached_property
    def core_box(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of all that moves, over the whole turn [mm]."""
        widest = self.pitch if self.pitch.size else self.profile
        sweep = float(np.abs(widest).max()) if widest.size else self.base_radius
        sweep = max([sweep, *(float(np.abs(flank.profile).max()) * MM for flank in self.further)])
        boxes = [(-sweep, -sweep, sweep, sweep)] if self.with_cam else []
        corners = self.face_outline[:-1] if self.face_outline.size and not self.face_radius else ()
        turn = np.exp(1j * np.deg2rad(self.face_angle))
        for track in (*self.tracks(), *(self.reference + corner * turn for corner in corners)):
            boxes.append((track.real.min(), track.imag.min(), track.real.max(), track.imag.max()))
        rounds = (
            (self.reference, self.face_radius),
            *((track, radius) for _, track, radius in self.further_rollers),
            *((self.centre_of(wheel), wheel.radius) for pair in self.wheels for wheel in pair.circles),
        )
        for z, r in rounds:
            boxes.append((z.real.min() - r, z.imag.min() - r, z.real.max() + r, z.imag.max() + r))
        left, low, right, high = np.array(boxes).T
        return complex(left.min(), low.min()), complex(right.max(), high.max())

    @cached_property
    def wheels(self) -> tuple[WheelPair, ...]:
        """The wheels of second inputs whose radii are known."""
        drive = self.study.design.drive
        return tuple(wheel_pairs(drive.linkage)) if self.numbered and drive.linkage.drivers else ()

    def centre_of(self, wheel: Wheel) -> np.ndarray:
        """Where a wheel's centre is (n,) [mm]."""
        body = self.bodies[body_name(wheel.link)]
        return body.track(body.points[wheel.point])

    @property
    def middle(self) -> complex:
        """Of all that moves [mm]."""
        low, high = self.core_box
        return 0.5 * (low + high)

    @cached_property
    def unit(self) -> float:
        """Size of the symbols [mm], in proportion to the mechanism; in steps, so that a small edit leaves them alone."""
        low, high = self.core_box
        size = abs(high - low) / UNITS_ACROSS
        return float(10.0 ** (np.round(UNIT_STEPS * np.log10(size)) / UNIT_STEPS))

    def same_places(self, other: Geometry) -> bool:
        """Whether every part stands where it does in another reading: no more than speed or loads may differ."""
        return (
            self.kinematics is other.kinematics
            and self.shape is other.shape
            and (self.sense, self.base_radius, self.bored) == (other.sense, other.base_radius, other.bored)
            and (self.keyway, self.sprung) == (other.keyway, other.sprung)
        )

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """The force elements besides the masses; none where the loads have no answer."""
        try:
            return tuple(element for element in self.study.loading.others if element.is_active)
        except NoSolution:
            return ()

    @cached_property
    def sprung(self) -> bool:
        """Whether a spring closes the follower."""
        return any(isinstance(element, OutputForce) and self.closes(element) for element in self.elements)

    def closes(self, element: OutputForce) -> bool:
        """Whether it is a spring, and no external force alone."""
        return not self.alone and (bool(element.rate) or not self.external)

    @property
    def alone(self) -> bool:
        """Whether a motion moves it, and no mechanism."""
        return self.study.design.drive.is_alone

    @property
    def external(self) -> float:
        """The external force on the output along its motion, as typed."""
        loads = self.study.design.drive.loads
        return float(next((v for key in EXTERNAL if (v := getattr(loads, key, 0.0))), 0.0))

    @cached_property
    def springs(self) -> tuple[tuple[Spring, np.ndarray, np.ndarray], ...]:
        """Springs and dampers between points, with both ends (n,) [mm]; none where the loads have no answer."""
        found = [element for element in self.elements if isinstance(element, Spring)]
        ends = ((spring, spring.ends(self.kinematics)) for spring in found)
        return tuple((spring, MM * start, MM * end) for spring, (start, end) in ends)

    @cached_property
    def near_centres(self) -> np.ndarray:
        """Those places of the instant centre that are near enough to be kept in the picture (m,) [mm]."""
        low, high = self.core_box
        room = FAR * abs(high - low)
        q = self.centre[np.isfinite(self.centre)]
        inside = (np.abs(q.real - (low + high).real / 2) < (high - low).real / 2 + room) & (
            np.abs(q.imag - (low + high).imag / 2) < (high - low).imag / 2 + room
        )
        return q[inside]


def _shape(study: Study) -> CamShape | None:
    if "cam" not in study.stages:
        return None
    try:
        shape: CamShape = study.cam
    except NoSolution:
        return None
    return shape
