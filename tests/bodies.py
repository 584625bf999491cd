"""Plane bodies, joints and forces in Exudyn, a program for bodies and joints that knows no cams: what the tests against it share."""

from __future__ import annotations

import cmath
from collections.abc import Callable
from math import pi, tanh
from typing import Any, NamedTuple

import numpy as np

ACROSS, TURN = 1, 2  # coordinates of a body, after that along x


class Body(NamedTuple):
    """The node of its coordinates, and the object."""

    node: int
    item: int


class World:
    """A system that is built, run once, and read. Places are complex [m], in the frame of their body or the global one."""

    def __init__(self, exudyn: Any, gravity: complex = 0j) -> None:
        from exudyn import itemInterface

        self.items, self.kinds, self._exudyn, self._gravity = itemInterface, exudyn.OutputVariableType, exudyn, gravity
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        self.frame = Body(
            self.system.AddNode(itemInterface.NodePointGround()), self.system.AddObject(itemInterface.ObjectGround())
        )

    # -- building ------------------------------------------------------------------------------------------

    def body(
        self,
        mass: float,
        inertia: float,
        at: complex = 0j,
        turned: float = 0.0,
        velocity: complex = 0j,
        turning: float = 0.0,
    ) -> Body:
        """With its weight; at: its centre of mass, from which its own places are counted."""
        place, moves = [at.real, at.imag, turned], [velocity.real, velocity.imag, turning]
        node = self.system.AddNode(self.items.NodeRigidBody2D(referenceCoordinates=place, initialVelocities=moves))
        body = Body(node, self.system.AddObject(self.items.RigidBody2D(mass=mass, inertia=inertia, nodeNumber=node)))
        self.push(body, mass * self._gravity)
        return body

    def mass(self, mass: float, at: float = 0.0) -> Body:
        """On a line, away from its place by ``at``; its only coordinate is 0."""
        node = self.system.AddNode(self.items.Node1D(initialCoordinates=[at]))
        return Body(node, self.system.AddObject(self.items.Mass1D(mass=mass, nodeNumber=node)))

    def place(self, body: Body, at: complex = 0j) -> int:
        """A marker at a place."""
        return int(
            self.system.AddMarker(
                self.items.MarkerBodyPosition(bodyNumber=body.item, localPosition=[at.real, at.imag, 0.0])
            )
        )

    def coordinate(self, body: Body, number: int = 0) -> int:
        """A marker on a coordinate; those of the frame are 0."""
        return int(self.system.AddMarker(self.items.MarkerNodeCoordinate(nodeNumber=body.node, coordinate=number)))

    def pin(self, one: Body, one_at: complex, other: Body, other_at: complex) -> int:
        """A pin between places of two bodies."""
        markers = [self.place(one, one_at), self.place(other, other_at)]
        return int(self.system.AddObject(self.items.RevoluteJoint2D(markerNumbers=markers)))

    def hold(
        self, body: Body, number: int = 0, way: Callable[[float], float] | None = None, by: Body | None = None
    ) -> int:
        """A coordinate that stands still, goes a way by time, or goes with that of another body."""
        markers = [self.coordinate(by or self.frame, number if by else 0), self.coordinate(body, number)]
        given = {} if way is None else {"offsetUserFunction": lambda system, t, item, offset: way(t)}
        return int(self.system.AddObject(self.items.CoordinateConstraint(markerNumbers=markers, **given)))

    def rod(self, one: Body, one_at: complex, other: Body, other_at: complex, length: float) -> None:
        """Two places stay at one distance."""
        markers = [self.place(one, one_at), self.place(other, other_at)]
        self.system.AddObject(self.items.DistanceConstraint(markerNumbers=markers, distance=length))

    def spring(
        self, one: Body, one_at: complex, other: Body, other_at: complex, rate: float, length: float, damping: float
    ) -> None:
        """A spring with a damper between two places."""
        markers = [self.place(one, one_at), self.place(other, other_at)]
        given = {"referenceLength": length, "stiffness": rate, "damping": damping}
        self.system.AddObject(self.items.SpringDamper(markerNumbers=markers, **given))

    def spring_on(self, body: Body, number: int, rate: float, free: float) -> None:
        """A spring on a coordinate, without force where that is ``free``."""
        markers = [self.coordinate(self.frame), self.coordinate(body, number)]
        self.system.AddObject(self.items.CoordinateSpringDamper(markerNumbers=markers, stiffness=rate, offset=free))

    def contact(self, below: Body, above: Body, stiffness: float, damping: float, gap: float) -> None:
        """Of two masses on a line, elastic where they would overlap; gap: at the start."""
        state = self.system.AddNode(self.items.NodeGenericData(numberOfDataCoordinates=1, initialCoordinates=[gap]))
        markers, given = (
            [self.coordinate(below), self.coordinate(above)],
            {"contactStiffness": stiffness, "contactDamping": damping},
        )
        self.system.AddObject(self.items.ObjectContactCoordinate(markerNumbers=markers, nodeNumber=state, **given))

    def push(self, body: Body, force: complex) -> None:
        """A constant force at the centre of mass."""
        self.system.AddLoad(self.items.Force(markerNumber=self.place(body), loadVector=[force.real, force.imag, 0.0]))

    def drive(self, body: Body, number: int, force: Callable[[float], float]) -> None:
        """A force or torque by time along a coordinate, of whatever the system has then."""
        given = {"loadUserFunction": lambda system, t, load: force(t)}
        self.system.AddLoad(self.items.LoadCoordinate(markerNumber=self.coordinate(body, number), load=0.0, **given))

    def carried(self, joint: int) -> list[float]:
        """What a joint carries at this moment: force, or the one thing that a held coordinate takes."""
        return np.atleast_1d(self.system.GetObjectOutput(joint, self.kinds.Force)).tolist()

    def rub_in_pin(self, joint: int, one: Body, other: Body, moment: float, turning: float) -> None:
        """Coulomb friction in a pin between two bodies: moment [m] times what it carries; below ``turning`` [rad/s] it fades."""

        def torque(t: float) -> float:
            slip = self._speed(other, TURN) - self._speed(one, TURN)
            return -moment * abs(complex(*self.carried(joint)[:2])) * tanh(slip / turning)

        self.drive(other, TURN, torque)
        if one != self.frame:
            self.drive(one, TURN, lambda t: -torque(t))

    def rub_on_guide(self, body: Body, carries: Callable[[], float], coefficient: float, speed: float) -> None:
        """Coulomb friction of a body that slides along x, of what its guide carries; below ``speed`` [m/s] it fades."""
        self.drive(body, 0, lambda t: -coefficient * carries() * tanh(self._speed(body, 0) / speed))

    def _speed(self, body: Body, number: int) -> float:
        if body == self.frame:
            return 0.0
        return float(self.system.GetNodeOutput(body.node, self.kinds.Coordinates_t)[number])

    # -- running and reading -------------------------------------------------------------------------------

    def watch(self, body: Body, *kinds: str) -> list[int]:
        """Sensors of a body's coordinates: ``Coordinates``, with ``_t`` their velocities, with ``_tt`` their accelerations."""
        make = self.items.SensorNode
        return [
            int(
                self.system.AddSensor(
                    make(nodeNumber=body.node, storeInternal=True, outputVariableType=getattr(self.kinds, kind))
                )
            )
            for kind in kinds
        ]

    def watch_joint(self, joint: int) -> int:
        """A sensor of what a joint carries."""
        sensor = self.items.SensorObject(objectNumber=joint, storeInternal=True, outputVariableType=self.kinds.Force)
        return int(self.system.AddSensor(sensor))

    def run(
        self, end: float, steps: int, *, spectral_radius: float = 0.9, relative: float = 1e-10, absolute: float = 1e-10
    ) -> None:
        """Through so many seconds; a smaller spectral radius damps what a jump leaves in the reactions."""
        self.system.Assemble()
        settings = self._exudyn.SimulationSettings()
        integration = settings.timeIntegration
        integration.endTime, integration.numberOfSteps, integration.verboseMode = end, steps, 0
        integration.generalizedAlpha.computeInitialAccelerations = True
        integration.generalizedAlpha.spectralRadius = spectral_radius
        integration.newton.relativeTolerance, integration.newton.absoluteTolerance = relative, absolute
        integration.minimumStepSize, integration.adaptiveStepRecoveryIterations = (
            1e-12,
            100,
        )  # a step cut for a contact grows again
        settings.solution.sensors.writePeriod = 1e-12
        settings.solution.file.write = False
        self.system.SolveDynamic(settings)

    def read(self, sensor: int) -> np.ndarray:
        """What a sensor saw (n, k), one row a step from t = 0 on."""
        return np.asarray(self.system.GetSensorStoredData(sensor)[:, 1:])

    def times(self, sensor: int) -> np.ndarray:
        """The times of these rows (n,) [s]."""
        return np.asarray(self.system.GetSensorStoredData(sensor)[:, 0])

    def force(self, sensor: int) -> np.ndarray:
        """By the first body of a pin on the second (n,), complex [N]."""
        rows = self.read(sensor)
        return -(rows[:, 0] + 1j * rows[:, 1])

    def held(self, sensor: int) -> np.ndarray:
        """By what holds a coordinate on its body (n,) [N or N m]."""
        return -self.read(sensor)[:, 0]


def direction(degrees: float) -> complex:
    """The unit vector at an angle."""
    return cmath.exp(1j * degrees * pi / 180.0)
