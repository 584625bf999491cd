"""Two cams on a free shaft with a flywheel, and a slider-crank with a spring and a damper, against Exudyn, a program for bodies and
joints that knows no cams.

An eccentric disk under a roller keeps the roller's centre at one distance from its own: in Exudyn that is a rigid rod between a point
of the shaft and a mass on a guide; here it is a motion, as a table of rows of the same function.
"""

from math import cos, hypot, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.design import Design, Drive, Motion, Point, RollerCam, Segment, Shaft, Table, Translating, TranslatingLoads
from core.project import loads
from core.study import ShaftStudy, Study

EXAMPLES = Path(__file__).parents[2] / "resources" / "examples"
MM = 1e3
RPM, FLYWHEEL = 120.0, 0.4
# eccentricity [m], mass [kg], spring rate [N/m], phase [deg]
DISKS = ((0.03, 6.0, 4000.0, 0.0), (0.02, 9.0, 9000.0, 70.0))
ROD, ROLLER, PRELOAD = 0.12, 0.02, 300.0


def lift(eccentric: float, degrees: float) -> tuple[float, float, float]:
    """Of the roller above its lowest place [mm], with two derivatives per degree."""
    c, s = cos(np.deg2rad(degrees)), sin(np.deg2rad(degrees))
    root = sqrt(ROD**2 - (eccentric * s) ** 2)
    first = -(eccentric**2) * s * c / root
    second = -(eccentric**2) * (c * c - s * s) / root - first**2 / root
    value = -eccentric * c + root - ROD + eccentric
    return MM * value, MM * (eccentric * s + first) * pi / 180.0, MM * (eccentric * c + second) * (pi / 180.0) ** 2


def drive(number: int, eccentric: float, mass: float, rate: float, phase: float) -> Drive:
    rows = tuple(Point(float(degrees), *lift(eccentric, degrees)) for degrees in range(361))
    return Drive(
        Motion(0.0, (Segment(360.0, 0.0, Table(rows)),)),
        Translating(direction_deg=0.0),
        RollerCam(base_radius_mm=MM * (ROD - eccentric - ROLLER), roller_radius_mm=MM * ROLLER),
        TranslatingLoads(follower_mass_kg=mass, spring_rate_n_per_mm=rate / MM, preload_n=PRELOAD, gravity_m_s2=0.0),
        name=f"Disk {number}",
        phase_deg=phase,
        mirrored=number == 1,
    )


def turned(exudyn: Any, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Angle and speed of the shaft over one turn [rad, rad/s], from this speed at angle 0 on."""
    from exudyn import itemInterface as items

    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(items.ObjectGround())
    node = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0.0, 0.0, 0.0], initialVelocities=[0.0, 0.0, speed]))
    shaft = system.AddObject(items.RigidBody2D(mass=1.0, inertia=FLYWHEEL, nodeNumber=node))
    centre = system.AddMarker(items.MarkerBodyPosition(bodyNumber=ground))
    system.AddObject(items.RevoluteJoint2D(markerNumbers=[centre, system.AddMarker(items.MarkerBodyPosition(bodyNumber=shaft))]))
    zero = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=system.AddNode(items.NodePointGround()), coordinate=0))
    for eccentric, mass, rate, phase in DISKS:
        x, y = -eccentric * cos(np.deg2rad(phase)), eccentric * sin(np.deg2rad(phase))  # where the disk's centre stands at 0
        place, lowest = x + sqrt(ROD**2 - y**2), ROD - eccentric
        moves = -y * speed - y * x * speed / sqrt(ROD**2 - y**2)
        follower = system.AddNode(items.NodePoint2D(referenceCoordinates=[place, 0.0], initialVelocities=[moves, 0.0]))
        body = system.AddObject(items.MassPoint2D(mass=mass, nodeNumber=follower))
        disk = system.AddMarker(items.MarkerBodyPosition(bodyNumber=shaft, localPosition=[x, y, 0.0]))
        roller = system.AddMarker(items.MarkerBodyPosition(bodyNumber=body))
        assert hypot(place - x, y) == pytest.approx(ROD)
        system.AddObject(items.DistanceConstraint(markerNumbers=[disk, roller], distance=ROD))
        along, across = (system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=follower, coordinate=i)) for i in (0, 1))
        system.AddObject(items.CoordinateConstraint(markerNumbers=[zero, across]))
        rest = lowest - PRELOAD / rate - place  # of the spring's free end, from where the follower stands
        system.AddObject(items.CoordinateSpringDamper(markerNumbers=[zero, along], stiffness=rate, offset=rest))
    angle, rate_of = (
        system.AddSensor(items.SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind))
        for kind in (exudyn.OutputVariableType.Rotation, exudyn.OutputVariableType.AngularVelocity)
    )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.endTime = 1.1 * 60.0 / RPM
    settings.timeIntegration.numberOfSteps = 4000
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = True
    settings.timeIntegration.newton.relativeTolerance = 1e-10
    settings.solution.sensors.writePeriod = 1e-9
    settings.solution.file.write = False
    system.SolveDynamic(settings)
    return system.GetSensorStoredData(angle)[:, -1], system.GetSensorStoredData(rate_of)[:, -1]


def test_two_cams_on_a_free_shaft_speed_up_and_slow_down_as_the_bodies_do() -> None:
    exudyn = pytest.importorskip("exudyn")
    shaft = Shaft("ccw", RPM, flywheel_inertia_kg_m2=FLYWHEEL, motor_slope_nm_s_per_rad=1e-9)  # a motor that hardly helps
    design = Design("Two disks", shaft, tuple(drive(i, *disk) for i, disk in enumerate(DISKS)))
    study = ShaftStudy(design, 720)
    assert np.abs(study.load.mean) <= 1e-9 * study.rms_torque
    angle, speed = turned(exudyn, float(study.speed[0]))
    assert angle[-1] >= 2.0 * pi
    there = np.interp(study.theta, angle, speed)
    swing = np.ptp(study.speed)
    assert swing >= 0.5 * study.omega
    assert np.abs(there - study.speed).max() <= 2e-6 * swing


# -- slider-crank ------------------------------------------------------------------------------------------

CRANK, LENGTH, CENTRE, INERTIA = 0.04, 0.14, 0.045, 0.05  # [m, kg m²] of the crank, which runs evenly
SPRING = ((0.3, 0.08), 2000.0, 0.15, 50.0)  # its place on the frame [m], rate [N/m], free length [m], damping [N s/m]
SPRING_ROW = """
[[loads.springs]]
from = { link = 1, at = [300.0, 80.0] }
to = { link = 4, point = "B" }
rate_n_per_mm = 2.0
free_length_mm = 150.0
damping_n_s_per_mm = 0.05
"""


def driven(exudyn: Any, omega: float, torque: Any) -> tuple[np.ndarray, np.ndarray]:
    """Angle and speed of the crank over a turn [rad, rad/s], begun at this speed and driven by a torque by its angle [N m]."""
    from exudyn import itemInterface as items

    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(items.ObjectGround())

    def at(body: int, x: float, y: float = 0.0) -> int:
        return int(system.AddMarker(items.MarkerBodyPosition(bodyNumber=body, localPosition=[x, y, 0.0])))

    turning = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0.0, 0.0, 0.0], initialVelocities=[0.0, 0.0, omega]))
    crank = system.AddObject(items.RigidBody2D(mass=1.0, inertia=INERTIA, nodeNumber=turning))
    up = CRANK * omega  # of A; B stands at its dead centre
    moves = [0.0, up * (LENGTH - CENTRE) / LENGTH, -up / LENGTH]
    swinging = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[CRANK + CENTRE, 0.0, 0.0], initialVelocities=moves))
    rod = system.AddObject(items.RigidBody2D(mass=0.6, inertia=0.0013, nodeNumber=swinging))
    sliding = system.AddNode(items.NodePoint2D(referenceCoordinates=[CRANK + LENGTH, 0.0]))
    slider = system.AddObject(items.MassPoint2D(mass=0.5, nodeNumber=sliding))
    pins = [(at(ground, 0.0), at(crank, 0.0)), (at(crank, CRANK), at(rod, -CENTRE)), (at(rod, LENGTH - CENTRE), at(slider, 0.0))]
    for one, other in pins:
        system.AddObject(items.RevoluteJoint2D(markerNumbers=[one, other]))
    zero = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=system.AddNode(items.NodePointGround()), coordinate=0))
    across = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=sliding, coordinate=1))
    system.AddObject(items.CoordinateConstraint(markerNumbers=[zero, across]))
    place, rate, length, damping = SPRING
    ends = [at(ground, *place), at(slider, 0.0)]
    system.AddObject(items.SpringDamper(markerNumbers=ends, referenceLength=length, stiffness=rate, damping=damping))
    system.AddLoad(items.Force(markerNumber=at(rod, 0.0), loadVector=[0.0, -0.6 * 9.80665, 0.0]))
    system.AddLoad(items.Force(markerNumber=at(slider, 0.0), loadVector=[-200.0, 0.0, 0.0]))
    drive = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=turning, coordinate=2))
    system.AddLoad(items.LoadCoordinate(markerNumber=drive, load=0.0, loadUserFunction=lambda mbs, t, load: torque(omega * t)))
    angle, rate_of = (
        system.AddSensor(items.SensorNode(nodeNumber=turning, storeInternal=True, outputVariableType=kind))
        for kind in (exudyn.OutputVariableType.Rotation, exudyn.OutputVariableType.AngularVelocity)
    )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.endTime = 2.0 * pi / omega
    settings.timeIntegration.numberOfSteps = 4000
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = True
    settings.timeIntegration.newton.relativeTolerance = 1e-10
    settings.solution.sensors.writePeriod = 1e-9
    settings.solution.file.write = False
    system.SolveDynamic(settings)
    return system.GetSensorStoredData(angle)[:, -1], system.GetSensorStoredData(rate_of)[:, -1]


def test_the_torque_found_for_a_slider_crank_with_spring_and_damper_keeps_its_crank_at_speed() -> None:
    exudyn = pytest.importorskip("exudyn")
    design = loads((EXAMPLES / "slider_crank.toml").read_text("utf-8") + SPRING_ROW)
    study = Study(design, 3600)
    theta, found = np.append(study.theta, 2.0 * pi), np.append(study.dynamics.driver, study.dynamics.driver[0])
    angle, speed = driven(exudyn, study.omega, lambda at: float(np.interp(at, theta, found)))
    assert angle[-1] == pytest.approx(2.0 * pi, rel=1e-5)
    swing = np.abs(np.cumsum(found)).max() * (theta[1] / (INERTIA * study.omega))  # of the speed without that torque
    assert swing > 0.01 * study.omega
    assert np.abs(speed - study.omega).max() <= 1e-3 * swing
