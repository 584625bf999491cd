"""Rocker and pushrod trains: against closed forms in complex vectors, against the same trains typed as linkages, and their files."""

import csv
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from face_cases import random_design

from core.__main__ import main
from core.design import Design, Engine, Translating, TranslatingLoads, Valve, get, put, with_drive
from core.errors import DesignError, NoAssembly
from core.project import dumps, loads
from core.study import Study, extremes_of, findings_of, many
from core.study.quantities import quantities_of

MM = 1e3
STEPS = """[[motion.segments]]
law = "dwell"
span_deg = 110.0
[[motion.segments]]
law = "{law}"
span_deg = 70.0
rise_mm = {rise}
[[motion.segments]]
law = "{law}"
span_deg = 70.0
rise_mm = -{rise}
[[motion.segments]]
law = "dwell"
span_deg = 110.0
"""
HEAD = 'format = 1\nname = "Train"\n[motion]\nstart_mm = 0.0\n'
SHAFT = '[shaft]\nrotation = "{sense}"\nspeed_rpm = 1500.0\n'
FINGER = """[follower]
kind = "rocker"
face = "roller"
arm_mm = {arm!r}
pivot_x_mm = -18.0
pivot_y_mm = -35.0
side = "right"
pad_mm = 40.0
pad_angle_deg = {angle!r}
pad_radius_mm = 12.0
valve_direction_deg = -90.0
[cam]
base_radius_mm = {base!r}
roller_radius_mm = 8.0
"""
FINGER_LOADS = """[loads]
valve_mass_kg = 0.1
rocker_inertia_kg_m2 = 2.1e-5
roller_mass_kg = 0.03
roller_inertia_kg_m2 = 1.3e-6
spring_rate_n_per_mm = 31.0
preload_n = 290.0
"""
FINGER_LINKAGE = """[linkage]
driver = { link = 4, kind = "motion" }
branch = { B = 1 }
links = [
  { number = 1, points = { P = [-18.0, -35.0] } },
  { number = 2, points = { P = [0.0, 0.0], B = [40.0, 0.0], R = [20.0, 8.0] } },
  { number = 3, points = { B = [0.0, 0.0] } },
  { number = 4, points = { T = [0.0, 0.0] } },
]
sliders = [
  { link = 4, on = 1, through = [21.0, -25.0], angle_deg = -90.0 },
  { link = 3, on = 4, through = [0.0, 0.0], angle_deg = 90.0 },
]
[cam]
link = 2
point = "R"
roller_radius_mm = 8.0
form = "open"
[[loads.masses]]
link = 4
mass_kg = 0.1
inertia_kg_m2 = 0.0
centre = [0.0, 0.0]
[[loads.masses]]
link = 2
mass_kg = 0.03
inertia_kg_m2 = 2.23e-5
centre = [20.0, 8.0]
[[loads.springs]]
from = { link = 1, at = [21.0, -225.0] }
to = { link = 4, point = "T" }
rate_n_per_mm = 31.0
free_length_mm = 209.35483870967742
"""
PUSHROD = """[follower]
kind = "pushrod"
face = "roller"
seat_x_mm = 8.0
seat_y_mm = 0.0
pushrod_mm = 208.0
pivot_x_mm = 25.0
pivot_y_mm = 240.0
push_arm_mm = 25.0
side = "left"
pad_mm = 38.0
pad_angle_deg = 180.0
pad_radius_mm = 12.0
valve_direction_deg = -90.0
[cam]
base_radius_mm = 14.0
roller_radius_mm = 8.0
"""
PUSHROD_LOADS = """[loads]
valve_mass_kg = 0.11
rocker_inertia_kg_m2 = 6.2e-5
tappet_mass_kg = 0.09
pushrod_mass_kg = 0.06
spring_rate_n_per_mm = 31.0
preload_n = 310.0
"""
RAY = complex(25.0, 210.0)  # from the lower ball to the pivot, with the tappet on the base circle
ALONG = (abs(RAY) ** 2 + 208.0**2 - 25.0**2) / (2.0 * abs(RAY))
UPPER = complex(ALONG, math.sqrt(208.0**2 - ALONG**2)) * RAY / abs(RAY)
CLOSED = 240.0 + 38.0 / 25.0 * (RAY - UPPER).imag  # height of the pad's centre
PUSHROD_LINKAGE = f"""[linkage]
driver = {{ link = 2, kind = "motion" }}
drawn = {{ S = [0.0, 238.0], B = [50.0, 238.0], driver_mm = 0.0 }}
links = [
  {{ number = 1, points = {{ P = [25.0, 240.0] }} }},
  {{ number = 2, points = {{ F = [0.0, 0.0], Q = [8.0, 0.0] }} }},
  {{ number = 3, points = {{ Q = [0.0, 0.0], S = [208.0, 0.0] }} }},
  {{ number = 4, points = {{ P = [0.0, 0.0], S = [-25.0, 0.0], B = [38.0, 0.0] }} }},
  {{ number = 5, points = {{ B = [0.0, 0.0] }} }},
  {{ number = 6, points = {{ T = [0.0, 0.0] }} }},
]
sliders = [
  {{ link = 2, on = 1, through = [0.0, 22.0], angle_deg = 90.0 }},
  {{ link = 6, on = 1, through = [62.0, 240.0], angle_deg = -90.0 }},
  {{ link = 5, on = 6, through = [0.0, 0.0], angle_deg = 90.0 }},
]
[cam]
link = 2
point = "F"
roller_radius_mm = 8.0
form = "open"
[[loads.masses]]
link = 2
mass_kg = 0.12
inertia_kg_m2 = 0.0
centre = [2.0, 0.0]
[[loads.masses]]
link = 4
mass_kg = 0.03
inertia_kg_m2 = 6.2e-5
centre = [-25.0, 0.0]
[[loads.masses]]
link = 6
mass_kg = 0.11
inertia_kg_m2 = 0.0
centre = [0.0, 0.0]
[[loads.springs]]
from = {{ link = 1, at = [62.0, 40.0] }}
to = {{ link = 6, point = "T" }}
rate_n_per_mm = 31.0
free_length_mm = {CLOSED - 40.0 + 10.0!r}
"""


def design(parts: str, rise: float, sense: str = "ccw", law: str = "3-4-5") -> Design:
    steps = STEPS.format(law=law, rise=rise)
    follower, _, rest = parts.partition("[loads]")
    loads_part = f"[loads]{rest}" if rest else ""
    return loads(f"{HEAD}{steps}{follower}{SHAFT.format(sense=sense)}{loads_part}")


def finger(sense: str = "ccw") -> Design:
    """The typed linkage's rocker: the pad's centre is 10 mm above the pivot while the valve is closed."""
    arm, angle = math.hypot(20.0, 8.0), math.atan2(8.0, 20.0)
    roller = complex(-18.0, -35.0) + arm * np.exp(1j * (math.asin(10.0 / 40.0) + angle))
    text = FINGER.format(arm=arm, angle=-math.degrees(angle), base=float(abs(roller)) - 8.0)
    return design(text + FINGER_LOADS, 10.0, sense)


def linkage(parts: str, rise: float, sense: str) -> Design:
    return design(parts.replace("[[loads", "[loads]\n[[loads", 1), rise, sense)


def pushrod(sense: str = "ccw") -> Design:
    return design(PUSHROD + PUSHROD_LOADS, 7.0, sense)


def close(value: np.ndarray, reference: np.ndarray) -> None:
    """The values agree within 1e-9 of the reference's peak."""
    np.testing.assert_allclose(value, reference, rtol=0.0, atol=1e-9 * float(np.abs(reference).max()))


def values(study: Study, name: str) -> np.ndarray:
    return quantities_of(study)[name].values(study)


# -- the same train, typed as a linkage -----------------------------------------------------------------------


@pytest.mark.parametrize("sense", ["ccw", "cw"])
@pytest.mark.parametrize("kind", ["rocker", "pushrod"])
def test_a_train_is_the_linkage_that_was_typed_for_it(kind: str, sense: str) -> None:
    """Positions to 1e-9 mm, forces to 1e-9 of their peak."""
    if kind == "rocker":
        train, typed = finger(sense), linkage(FINGER_LINKAGE, 10.0, sense)
        bodies = {"roller": "roller", "rocker": "link2", "pad": "link3"}
        pairs = {"pivot": "P", "pad": "3", "valve_guide": "4", "pad_centre": "B"}
    else:
        train, typed = pushrod(sense), linkage(PUSHROD_LINKAGE, 7.0, sense)
        bodies = {"tappet": "roller", "pushrod": "link3", "rocker": "link4", "pad": "link5"}
        pairs = {
            "guide": "2",
            "lower_ball": "Q",
            "upper_ball": "S",
            "pivot": "P",
            "pad_centre": "B",
            "pad": "5",
            "valve_guide": "6",
        }
    one, other = Study(train, 360), Study(typed, 360)
    for name, same in bodies.items():
        for order in range(3):
            reference = other.linkage.bodies[same].origin[order]
            tolerance = 1e-12 if not order else 1e-9 * float(np.abs(reference).max())
            np.testing.assert_allclose(one.linkage.bodies[name].origin[order], reference, rtol=0.0, atol=tolerance)
    close(one.dynamics.contact, other.dynamics.contact)
    close(one.shaft_torque, other.shaft_torque)
    for name, same in pairs.items():
        force = np.abs(other.dynamics.pairs[same])
        np.testing.assert_allclose(
            np.abs(one.dynamics.pairs[name]), force, rtol=0.0, atol=1e-9 * float(one.dynamics.contact.max())
        )
    np.testing.assert_allclose(one.cam.flank.profile, other.cam.flank.profile, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("kind", ["rocker", "pushrod"])
def test_the_valve_of_a_typed_linkage_lifts_like_that_of_the_train(kind: str) -> None:
    """Of the finger the valve is the driver's slider, of the pushrod train another one."""
    train, parts, rise, link = (
        (finger(), FINGER_LINKAGE, 10.0, 4) if kind == "rocker" else (pushrod(), PUSHROD_LINKAGE, 7.0, 6)
    )
    engine = Engine(stroke_mm=84.0, rod_mm=138.0)
    valve = Valve(centre_deg=108.0, lash_mm=0.3, angle_deg=12.0, clearance_mm=6.0)
    one = Study(with_drive(replace(train, engine=engine), valve=valve), 360)
    typed = replace(linkage(parts, rise, "ccw"), engine=engine)
    other = Study(with_drive(typed, valve=replace(valve, link=link)), 360)
    for name in ("valve_lift", "valve_velocity", "valve_acceleration", "piston_clearance"):
        close(values(other, name), values(one, name))
    is_loose = values(one, "valve_lift") == 0.0
    assert 0 < is_loose.sum() < 360
    assert not values(other, "contact_force")[is_loose].any()
    assert not values(other, "drive_torque")[is_loose].any()


# -- closed forms in complex vectors --------------------------------------------------------------------------


def unit(degrees: float) -> complex:
    return complex(np.exp(1j * math.radians(degrees)))


def turned(vector: np.ndarray, first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative of a vector that turns by an angle with these derivatives."""
    return 1j * first * vector, (1j * second - first**2) * vector


class Rocking:
    """A rocker by cos β = cos β0 + y/p, in mm: centre R of the roller with derivatives by cam angle, angle of the rocker."""

    def __init__(self, train: Design, y: np.ndarray) -> None:
        f, face = train.drive.follower, train.drive.face
        side, pivot = {"left": 1.0, "right": -1.0}[f.side], complex(f.pivot_x_mm, f.pivot_y_mm)
        reach, distance = train.drive.cam.base_radius_mm + face.radius_mm, abs(pivot)
        corner = math.acos((f.arm_mm**2 + distance**2 - reach**2) / (2.0 * f.arm_mm * distance))
        start = float(np.angle(-pivot * np.exp(1j * side * corner)))
        to_pad = math.radians(f.pad_angle_deg - f.valve_direction_deg)
        beta = np.arccos(math.cos(start + to_pad) + y[0] / f.pad_mm) * np.sign(math.sin(start + to_pad))
        sine, cosine = f.pad_mm * np.sin(beta), f.pad_mm * np.cos(beta)
        first = -y[1] / sine
        second = -(y[2] + cosine * first**2) / sine
        self.turn, self.beta = (first, second), beta
        arm = f.arm_mm * np.exp(1j * (beta - to_pad))
        self.arm, self.reference = arm, (pivot + arm, *turned(arm, first, second))
        self.slope = -1.0 / sine  # of the rocker by the valve [rad/mm]
        self.by_valve = 1j * self.slope * arm
        self.pad = f.pad_mm * (np.sin(beta) - math.sin(start + to_pad))
        self.valve, self.ratio = y, np.abs(sine) / f.arm_mm


class Pushing:
    """A pushrod train by the triangle of lower ball S, upper ball U and pivot P, in mm; y is the motion of the tappet."""

    def __init__(self, train: Design, y: np.ndarray) -> None:
        f, face, base = train.drive.follower, train.drive.face, train.drive.cam.base_radius_mm
        e, tilt = unit(f.direction_deg), math.radians(getattr(f.face, "face_tilt_deg", 0.0))
        reach = base + face.radius_mm
        flat = (base - f.offset_mm * math.sin(tilt)) / math.cos(tilt)
        start = flat if face.straight else math.sqrt(reach**2 - f.offset_mm**2)
        pivot, side = complex(f.pivot_x_mm, f.pivot_y_mm), {"left": 1.0, "right": -1.0}[f.side]
        seat, v = complex(f.seat_x_mm, f.seat_y_mm), unit(f.valve_direction_deg)

        def upper(lift: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            lower = e * (start + lift + 1j * f.offset_mm + seat)
            ray = pivot - lower
            r = np.abs(ray)
            along = (r**2 + f.pushrod_mm**2 - f.push_arm_mm**2) / (2.0 * r)
            height = np.sqrt(f.pushrod_mm**2 - along**2)
            return lower, lower + (along + 1j * side * height) * ray / r

        lower, ball = upper(y[0])
        arm, rod = ball - pivot, ball - lower

        def dot(a: Any, b: Any) -> np.ndarray:
            return np.asarray((np.conj(a) * b).real)

        # (U - S)·(U - S) = L²: rod·(i χ' arm - e y') = 0, and its derivative
        lever = dot(rod, 1j * arm)
        self.slope = dot(rod, e) / lever  # of the rocker by the tappet [rad/mm]
        first = self.slope * y[1]
        relative = 1j * first * arm - e * y[1]
        second = (dot(rod, e * y[2] + first**2 * arm) - dot(relative, relative)) / lever
        self.turn, self.arm = (first, second), arm
        pad = f.pad_mm / f.push_arm_mm * arm * unit(f.pad_angle_deg)
        closed = f.pad_mm / f.push_arm_mm * (upper(np.zeros(1))[1] - pivot) * unit(f.pad_angle_deg)
        self.valve = (dot(v, pad - closed), *(dot(v, part) for part in turned(pad, first, second)))
        self.pad = dot(1j * v, pad - closed)
        self.ratio = dot(v, 1j * pad) * self.slope
        self.reference = (e * (start + y[0] + 1j * f.offset_mm), e * y[1], e * y[2])
        self.e = e


def force_by_virtual_work(train: Design, study: Study, form: Any) -> np.ndarray:
    """Contact force [N] of one millimetre of the driver: n·δR F = the work of inertia, weight and spring."""
    f, s, w2 = train.drive.follower, train.drive.loads, study.omega**2
    gravity = s.gravity_m_s2 * unit(s.gravity_angle_deg)
    d = 1.0 if train.shaft.rotation == "ccw" else -1.0
    reference, first, _ = form.reference
    t = first - 1j * d * reference
    normal = -1j * d * t / np.abs(t)
    if train.drive.face.straight:
        normal = np.full(t.shape, -unit(f.direction_deg + f.face.face_tilt_deg))
    v = unit(f.valve_direction_deg)
    spring = s.preload_n + s.spring_rate_n_per_mm * form.valve[0]
    valve = s.valve_mass_kg * (1e-3 * w2 * form.valve[2] - (gravity * np.conj(v)).real) + spring
    turn = s.rocker_inertia_kg_m2 * w2 * form.turn[1] * MM  # [N mm] per rad
    if isinstance(form, Rocking):
        by_driver, valve_by = form.by_valve, 1.0
        roller = s.roller_mass_kg * (1e-3 * w2 * form.reference[2] - gravity)
        turn = turn + s.roller_inertia_kg_m2 * w2 * form.turn[1] * MM
        work = valve * valve_by + turn * form.slope + (np.conj(roller) * by_driver).real
    else:
        by_driver, half = form.e, 0.5 * s.pushrod_mass_kg
        tappet = (s.tappet_mass_kg + half) * (1e-3 * w2 * form.reference[2] - gravity)
        ball = half * (1e-3 * w2 * turned(form.arm, *form.turn)[1] - gravity)
        work = valve * form.ratio + turn * form.slope
        work = work + (np.conj(tappet) * form.e).real + (np.conj(ball) * 1j * form.slope * form.arm).real
    return np.asarray(-work / (np.conj(normal) * by_driver).real)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(
    ("kind", "face"),
    [
        ("rocker", "roller"),
        ("rocker", "shoe"),
        ("pushrod", "roller"),
        ("pushrod", "shoe"),
        ("pushrod", "flat"),
        ("pushrod", "knife"),
    ],
)
def test_a_train_agrees_with_its_closed_form(kind: str, face: str, seed: int) -> None:
    """Random lengths, either side, any direction of the valve; the contact force by virtual work."""
    rng = np.random.default_rng([seed, 53])
    train = random_design(rng, kind, face, ("ccw", "cw")[seed % 2])
    train = with_drive(put(train, "shaft.speed_rpm", 1500.0), loads=replace(train.drive.loads, contact=None))
    study = Study(train, 180)
    y = [study.motion.displacement[order] * MM for order in range(3)]
    form = (Rocking if kind == "rocker" else Pushing)(train, y)
    for order in range(3):
        reference = form.reference[order]
        tolerance = 1e-9 if not order else 1e-9 * float(np.abs(reference).max())
        np.testing.assert_allclose(study.linkage.follower.origin[order] * MM, reference, rtol=0.0, atol=tolerance)
        column = ("valve_lift", "valve_velocity", "valve_acceleration")[order]
        close(values(study, column), form.valve[order] * study.omega**order)
    np.testing.assert_allclose(values(study, "pad_position"), form.pad, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(values(study, "rocker_ratio"), form.ratio, rtol=1e-9)
    close(study.dynamics.contact, force_by_virtual_work(train, study, form))


# -- files, faults, columns -----------------------------------------------------------------------------------


@pytest.mark.parametrize("face", ["roller", "shoe", "flat", "knife"])
@pytest.mark.parametrize("kind", ["rocker", "pushrod"])
def test_a_train_is_read_and_written(kind: str, face: str) -> None:
    if (kind, face) in (("rocker", "flat"), ("rocker", "knife")):
        with pytest.raises(DesignError, match=r"follower.face = '?\"?" + face + r".*roller \| shoe"):
            loads(dumps(finger()).replace('face = "roller"', f'face = "{face}"'))
        return
    train = random_design(np.random.default_rng(7), kind, face, "cw")
    assert loads(dumps(train)) == train
    assert f'kind = "{kind}"' in dumps(train)
    assert "pad_radius_mm = 10.0" in dumps(train)


@pytest.mark.parametrize("face", ["roller", "flat", "knife", "shoe"])
def test_the_cam_of_a_pushrod_is_that_of_its_tappet(face: str) -> None:
    train = random_design(np.random.default_rng(11), "pushrod", face, "ccw")
    f = train.drive.follower
    tappet = Translating(face=f.face, offset_mm=f.offset_mm, direction_deg=f.direction_deg)
    alone = with_drive(train, mechanism=tappet, loads=TranslatingLoads())
    np.testing.assert_array_equal(Study(train, 90).cam.flank.profile, Study(alone, 90).cam.flank.profile)


@pytest.mark.parametrize("kind", ["rocker", "pushrod"])
def test_a_valve_that_opens_towards_the_cam_is_refused(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    train = finger() if kind == "rocker" else pushrod()
    file = tmp_path / "train.toml"
    file.write_text(dumps(put(train, "follower.valve_direction_deg", 90.0)), encoding="utf-8")
    assert main(["check", str(file)]) == 2
    said = capsys.readouterr().err
    assert "follower.valve_direction_deg" in said
    assert "towards the cam" in said
    assert len(said.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("train", "path", "value", "names"),
    [
        (finger, "follower.arm_mm", 5.0, "make no triangle"),
        (finger, "follower.pad_mm", 4.0, "cannot follow the valve"),
        (pushrod, "follower.pushrod_mm", 150.0, "do not meet"),
        (pushrod, "follower.push_arm_mm", 3.0, "do not meet"),
        (pushrod, "follower.offset_mm", 23.0, "must stay within"),
    ],
)
def test_lengths_that_do_not_fit_are_refused(train: Any, path: str, value: float, names: str) -> None:
    with pytest.raises(NoAssembly, match=names) as raised:
        Study(put(train(), path, value), 72).linkage.residual  # noqa: B018
    assert raised.value.field == (path if path != "follower.push_arm_mm" else "follower.pushrod_mm")


def test_values_out_of_range_are_faults_with_their_fields() -> None:
    wrong = (
        dumps(pushrod()).replace("pad_mm = 38.0", "pad_mm = -1.0").replace("push_arm_mm = 25.0", "push_arm_mm = 0.0")
    )
    with pytest.raises(DesignError) as raised:
        loads(wrong.replace("valve_mass_kg = 0.11", "valve_mass_kg = -0.11"))
    assert {fault.path for fault in raised.value.faults} == {
        "follower.pad_mm",
        "follower.push_arm_mm",
        "loads.valve_mass_kg",
    }


def test_a_pad_whose_arm_is_along_the_valve_is_a_finding() -> None:
    """At the greatest lift cos β = -0.25 + 10/p: of p = 8.003 mm the sine is 0.0307, of 9 mm 0.51."""
    for arm, sine in ((8.003, math.sqrt(1.0 - (10.0 / 8.003 - 0.25) ** 2)), (9.0, None)):
        findings = [
            row for row in findings_of(Study(put(finger(), "follower.pad_mm", arm), 360)) if row.code == "pad-in-line"
        ]
        assert [row.field for row in findings] == ["follower.pad_angle_deg"] * (sine is not None)
        assert [row.values["value"] for row in findings] == pytest.approx([sine] if sine else [], rel=1e-6)


@pytest.mark.parametrize("kind", ["rocker", "pushrod"])
def test_lash_is_taken_off_the_lift(kind: str, tmp_path: Path) -> None:
    """Columns of kinematics.csv, against the motion without lash."""
    train = finger() if kind == "rocker" else pushrod()
    engine = "[engine]\nstroke_mm = 84.0\nrod_mm = 138.0\n[valve]\ncentre_deg = 108.0\nlash_mm = 0.4\n"
    file = tmp_path / "train.toml"
    file.write_text(dumps(train) + engine, encoding="utf-8")
    assert main(["export", str(file), "--out", str(tmp_path), "--samples", "90"]) == 0
    with (tmp_path / "kinematics.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    free = Study(train, 90)
    lift, velocity = (values(free, name) for name in ("valve_lift", "valve_velocity"))
    acceleration = values(free, "valve_acceleration")
    is_open = lift > 0.4
    assert 0 < is_open.sum() < 90
    for name, expected in (
        ("valve_lift_mm", np.maximum(lift - 0.4, 0.0)),
        ("valve_velocity_mm_s", np.where(is_open, velocity, 0.0)),
        ("valve_acceleration_mm_s2", np.where(is_open, acceleration, 0.0)),
        ("rocker_ratio", values(free, "rocker_ratio")),
        ("pad_position_mm", values(free, "pad_position")),
    ):
        close(np.array([float(row[name]) for row in rows]), expected)


def test_many_designs_are_those_one_by_one() -> None:
    for train in (finger(), pushrod()):
        paths = ["follower.pivot_y_mm", "follower.pad_angle_deg", "loads.spring_rate_n_per_mm"]
        rows = [[get(train, path) * factor for path in paths] for factor in (0.99, 1.0, 1.01)]
        names = ["contact_force_n:max", "rocker_ratio:min", "valve_lift_mm:max", "pad_position_mm:max"]
        results = many(train, {path: [row[i] for row in rows] for i, path in enumerate(paths)}, names)
        for i, row in enumerate(rows):
            one = train
            for path, value in zip(paths, row, strict=True):
                one = put(one, path, value)
            study = Study(one, 360)
            found = {"contact_force": extremes_of(study, "dynamics")["contact_force"].high.value}
            found |= {
                name: extremes_of(study, "linkage")[name] for name in ("rocker_ratio", "valve_lift", "pad_position")
            }
            expected = [found["contact_force"], found["rocker_ratio"].low.value, found["valve_lift"].high.value * MM,
                        found["pad_position"].high.value * MM]  # fmt: skip
            assert [results.value[name][i] for name in names] == pytest.approx(expected, rel=1e-9, abs=1e-9)
