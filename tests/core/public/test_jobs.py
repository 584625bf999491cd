"""Five jobs as a user writes them, their results against formulas that are written here."""

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from drawing_readers import along_dxf

import kindyna as kd

OFFSET, ROLLER, STROKE, RISE, RETURN = 6.0, 10.0, 24.0, 80.0, 150.0
"""Offset to the right, which lowers the pressure angle of the rise on a cam that turns counter-clockwise; lengths [mm], spans [deg]."""
TAPPET = {
    "format": 1,
    "name": "Tappet",
    "motion": {
        "start_mm": 0.0,
        "segments": [
            {"law": "dwell", "span_deg": 70.0},
            {"law": "3-4-5", "span_deg": RISE, "rise_mm": STROKE},
            {"law": "dwell", "span_deg": 60.0},
            {"law": "3-4-5", "span_deg": RETURN, "rise_mm": -STROKE},
        ],
    },
    "follower": {"kind": "translating", "face": "roller", "offset_mm": -OFFSET},
    "cam": {"base_radius_mm": 40.0, "roller_radius_mm": ROLLER},
    "shaft": {"rotation": "ccw", "speed_rpm": 300.0},
}


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder of a user."""
    monkeypatch.chdir(tmp_path)


def lift(degrees: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Motion of the tappet, 3-4-5 polynomials, and its derivative by the cam angle [mm, mm/rad]."""
    y, slope = np.zeros(degrees.size), np.zeros(degrees.size)
    for start, span, low, rise in (
        (70.0, RISE, 0.0, STROKE),
        (150.0, 60.0, STROKE, 0.0),
        (210.0, RETURN, STROKE, -STROKE),
    ):
        inside = (degrees >= start) & (degrees < start + span)
        x = (degrees[inside] - start) / span
        y[inside] = low + rise * (10.0 * x**3 - 15.0 * x**4 + 6.0 * x**5)
        slope[inside] = rise * (30.0 * x**2 - 60.0 * x**3 + 30.0 * x**4) / math.radians(span)
    return y, slope


def circle_points(a: complex, r: float, b: complex, s: float, side: int) -> complex:
    """Intersection of two circles to the left of the line between their centres where side is 1."""
    d = abs(b - a)
    along = (d * d + r * r - s * s) / (2.0 * d)
    return a + (b - a) / d * complex(along, side * math.sqrt(r * r - along * along))


def test_a_tappet_from_nothing_to_a_file_for_the_mill() -> None:
    d = kd.design(TAPPET)
    f = d.find("base-radius", limits={"pressure_angle_rise_deg": 25})
    paths = f.design.study().export("cam.dxf", tolerance=0.002, as_="arcs")

    degrees = np.linspace(0.0, 360.0, 180_000, endpoint=False)
    y, slope = lift(degrees)
    a = math.sqrt((f.answer["cam.base_radius_mm"] + ROLLER) ** 2 - OFFSET**2)
    angle = np.rad2deg(np.arctan(np.abs(slope - OFFSET) / (a + y)))
    assert angle[(degrees > 70.0) & (degrees < 150.0)].max() == pytest.approx(25.0, abs=1e-7)
    np.testing.assert_allclose(f.design.study(360)["pressure_angle_deg"], angle[::500], atol=1e-9)

    assert [path.name for path in paths] == ["cam.dxf", "cam.dxf.json"]
    pitch = (OFFSET + 1j * (a + y)) * np.exp(-1j * np.deg2rad(degrees))
    points = along_dxf(Path("cam.dxf"), "PROFILE", 3)
    distance = np.array([np.abs(pitch - point).min() for point in points])
    assert np.abs(distance - ROLLER).max() < 0.002 + 1e-5


def modified_sine(degrees: np.ndarray, start: float, span: float) -> tuple[np.ndarray, np.ndarray]:
    """Modified sine of span and rise 1, and its derivative by the cam angle [1/rad] (Neklutin)."""
    x = (degrees - start) / span
    k = 4.0 + math.pi
    inner = np.where(x < 0.5, x, 1.0 - x)
    ends = inner < 0.125
    s = np.where(
        ends,
        math.pi * inner / k - np.sin(4.0 * math.pi * inner) / (4.0 * k),
        2.0 / k + math.pi * inner / k - 9.0 * np.sin(4.0 * math.pi * inner / 3.0 + math.pi / 3.0) / (4.0 * k),
    )
    v = np.where(
        ends,
        math.pi / k * (1.0 - np.cos(4.0 * math.pi * inner)),
        math.pi / k * (1.0 - 3.0 * np.cos(4.0 * math.pi * inner / 3.0 + math.pi / 3.0)),
    )
    return np.where(x < 0.5, s, 1.0 - s), v / math.radians(span)


def rocker_pressure_angle(base: np.ndarray) -> np.ndarray:
    """Largest pressure angle [deg] of the example ``rocker_cam`` over its base radius [mm], by the instant centre of cam and arm."""
    arm, pivot, reach = 90.0, 95.0 + 30.0j, base[:, None] + 12.0
    distance = abs(pivot)
    degrees = np.concatenate((np.linspace(60.0, 170.0, 4001), np.linspace(230.0, 360.0, 4001)))
    rise, fall = modified_sine(degrees[:4001], 60.0, 110.0), modified_sine(degrees[4001:], 230.0, 130.0)
    turn = np.deg2rad(18.0) * np.concatenate((rise[0], 1.0 - fall[0]))
    rate = np.deg2rad(18.0) * np.concatenate((rise[1], -fall[1]))
    at_rest = np.arccos((distance**2 + arm**2 - reach**2) / (2.0 * distance * arm))  # between arm and line of centres
    to_cam = np.angle(-pivot)
    direction = np.exp(1j * (to_cam - (at_rest + turn)))  # on the right the arm turns clockwise
    roller = pivot + arm * direction
    centre = pivot * -rate / (-rate - 1.0)
    normal = (roller - centre) / np.abs(roller - centre)
    angle = np.rad2deg(np.arccos(np.clip(np.abs((normal * np.conj(1j * direction)).real), 0.0, 1.0)))
    return np.asarray(angle.max(axis=1))


def test_ten_thousand_machines_at_once() -> None:
    d = kd.example("rocker_cam")
    m = d.many({"cam.base_radius_mm": np.linspace(44, 70, 10_000)}, ["pressure_angle_deg:max", "drive_torque_nm:abs"])
    best = m.inputs["cam.base_radius_mm"][m.value["pressure_angle_deg:max"] < 35].min()

    chosen = np.arange(0, 10_000, 700)
    angle = rocker_pressure_angle(m.inputs["cam.base_radius_mm"][chosen])
    np.testing.assert_allclose(m.value["pressure_angle_deg:max"][chosen], angle, rtol=1e-6)
    assert len(m) == 10_000
    assert best == 44.0


def test_a_measured_lift_in_a_data_frame() -> None:
    degrees = np.arange(0.0, 360.0, 1.0)
    y, _ = lift(degrees)
    np.savetxt(
        "lift.csv", np.column_stack((degrees, y.round(4))), delimiter=",", header="cam_angle_deg,lift_mm", comments=""
    )
    pytest.importorskip("pandas")

    s = kd.measured("lift.csv", speed=300).study()
    largest = s.to_frame()["acceleration_mm_s2"].abs().nlargest(5)
    picture = s.plot("acceleration_mm_s2")

    peak = 10.0 / math.sqrt(3.0) * STROKE / math.radians(RISE) ** 2 * (300.0 * math.tau / 60.0) ** 2
    assert largest.iloc[0] == pytest.approx(peak, rel=2e-3)
    assert largest.index.name == "cam_angle_deg"
    texts = [
        element.text or "" for element in ElementTree.fromstring(picture.svg).iter() if element.tag.endswith("}text")
    ]
    assert "Acceleration, m/s²" in texts
    assert np.abs(s["displacement_mm"] - y).max() < 1e-3


def test_a_coupler_point_a_bearing_and_where_a_number_comes_from() -> None:
    kd.example("four_bar").save("four_bar.toml")
    s = kd.open("four_bar.toml").study(samples=720)
    C, T = s.point(3, "C"), s["driver_torque_nm"]
    explanation = s.explain("driver_torque_nm", at_deg=40)

    for i, angle in enumerate(np.arange(720) / 2.0):
        a = 30.0 * np.exp(1j * math.radians(angle))
        b = circle_points(a, 90.0, 100.0 + 0.0j, 70.0, 1)
        c = a + (b - a) / 90.0 * (45.0 + 40.0j)
        assert abs(complex(*C[i]) - c) < 1e-10
    assert (T.shape, explanation.value) == ((720,), T[80])
    assert str(explanation).startswith("Driver torque at 40°")


def test_the_best_compared_and_to_the_servo() -> None:
    d = kd.example("rocker_cam")
    o = d.optimise(
        vary={"cam.base_radius_mm": (40, 90)},
        minimise="drive_torque_nm:abs",
        limits={"pressure_angle_deg:max": {"max": 35}},
    )
    comparison = d.compare(o.design)
    facts = o.design.study().ecam("sew-tab", out="sew.txt")

    radii = np.linspace(40.0, 90.0, 2001)
    scan = d.many({"cam.base_radius_mm": radii}, ["drive_torque_nm:abs", "pressure_angle_deg:max"])
    torque = np.where(scan.value["pressure_angle_deg:max"] <= 35.0, scan.value["drive_torque_nm:abs"], np.inf)
    assert o.goal <= torque.min() * (1.0 + 1e-9)
    assert o.goal == pytest.approx(torque.min(), rel=1e-4)
    assert o.answer["cam.base_radius_mm"] == pytest.approx(radii[torque.argmin()], abs=50.0 / 2000.0)
    assert o.design == d.edit(o.answer)
    (row,) = [row for row in comparison["inputs"] if row["path"] == "cam.base_radius_mm"]
    assert (row["a"], row["b"]) == (45.0, o.answer["cam.base_radius_mm"])

    master, slave = np.loadtxt("sew.txt", skiprows=1).T
    degrees = np.linspace(0.0, 360.0, 36_001)[:-1]
    error = np.abs(np.interp(degrees, master, slave) - o.design.study().at(degrees)["displacement_deg"]).max()
    assert len(master) == facts["rows"]
    assert error == pytest.approx(facts["deviation_deg"], rel=1e-3)
