"""Hertz pressure, shear below the surface and rolling life, against handbooks and cases computed by hand.

ISO 6336-2: elasticity factor Z_E = p/√(F κ_rel/b) of two materials. Roark, Formulas for Stress and Strain, contact of cylinders:
K_D = D1 D2/(D1 ± D2), on a flat D2; of equal moduli E and ν = 0.3 the pressure is 0.591 √(F E/(b K_D)), the whole width of the
contact 2.15 √(F K_D/(b E)). Johnson, Contact Mechanics, 4.2: the largest shear is 0.30 p, 0.78 half widths deep.
"""

import json
import tomllib
from math import inf, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from core.design import Design, edited
from core.errors import DesignError
from core.findings import NOTE, WARNING, Finding
from core.output.channels import channel
from core.output.export import files
from core.output.report import report
from core.project import dumps, load, loads
from core.study import Study, extremes_of, findings_of, roller_lives
from core.study.stages import evaluations

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "resources" / "examples"
FORCE, WIDTH = 1000.0, 12.5  # N, mm

# A disk of radius 30 turns under a follower that a cylinder presses on it with 1000 N.
ROUND: dict[str, Any] = {
    "format": 1,
    "name": "Round disk",
    "motion": {"start_mm": 0.0, "segments": [{"law": "dwell", "span_deg": 360.0}]},
    "follower": {"kind": "translating"},
    "cam": {"base_radius_mm": 30.0, "roller_radius_mm": 10.0, "thickness_mm": WIDTH},
    "shaft": {"rotation": "ccw", "speed_rpm": 200.0},
    "loads": {"preload_n": FORCE, "gravity_m_s2": 0.0},
}
STEEL = {"youngs_modulus_gpa": 206.0, "roller_youngs_modulus_gpa": 206.0}


def disk(face: str = "roller", **cam: Any) -> Design:
    """The disk with other entries of [cam]; None takes one away. A shoe has the roller's radius."""
    table = {name: dict(part) if isinstance(part, dict) else part for name, part in ROUND.items()}
    table["cam"] |= cam if face == "roller" else {**cam, "roller_radius_mm": None}
    table["cam"] = {key: value for key, value in table["cam"].items() if value is not None}
    table["follower"] |= {"face": face, **({"shoe_radius_mm": 10.0} if face == "shoe" else {})}
    return loads(tomli_w.dumps(table))


def with_values(design: Design, **values: Any) -> Design:
    for path, value in values.items():
        design = edited(design, path.replace("__", "."), value)
    return design


def values(study: Study, slug: str) -> np.ndarray:
    return channel(study.design, slug).values(study)


def found(design: Design) -> dict[str, Finding]:
    every = findings_of(Study(design, 72), ("dynamics",))
    return {each.code: each for each in every if "pressure" in each.code}


def example(name: str, **cam: Any) -> Design:
    given = {"material": "16mncr5", "roller_material": "100cr6", **cam}
    return with_values(load(EXAMPLES / f"{name}.toml"), **{f"cam__{key}": value for key, value in given.items()})


# -- against handbooks -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("modulus", "factor"), [(206.0, 189.8), (173.0, 181.4), (118.0, 162.0), (113.0, 159.8), (103.0, 155.0)]
)
def test_the_elasticity_factor_of_steel_on_iron_and_bronze_is_that_of_the_standard(
    modulus: float, factor: float
) -> None:
    study = Study(disk(**{**STEEL, "youngs_modulus_gpa": modulus}), 8)
    relative = 1.0 / 30.0 + 1.0 / 10.0
    assert values(study, "contact_pressure_mpa") / sqrt(FORCE / WIDTH * relative) == pytest.approx(factor, abs=0.05)


@pytest.mark.parametrize(
    ("face", "diameter"),
    [("roller", 60.0 * 20.0 / (60.0 + 20.0)), ("shoe", 60.0 * 20.0 / (60.0 + 20.0)), ("flat", 60.0)],
)
def test_cylinder_on_cylinder_and_on_a_flat_are_roarks(face: str, diameter: float) -> None:
    study = Study(disk(face, **STEEL), 8)
    pressure, half = values(study, "contact_pressure_mpa"), values(study, "contact_half_width_mm")
    assert pressure == pytest.approx(0.591 * sqrt(FORCE * 206e3 / (WIDTH * diameter)), rel=1e-3)
    assert 2.0 * half == pytest.approx(2.15 * sqrt(FORCE * diameter / (WIDTH * 206e3)), rel=2e-3)
    assert values(study, "subsurface_shear_mpa") == pytest.approx(0.300283 * pressure, rel=1e-6)
    assert values(study, "subsurface_shear_depth_mm") == pytest.approx(0.786151 * half, rel=1e-6)
    assert 0.5 * pi * pressure * half == pytest.approx(FORCE / WIDTH), "the ellipse of pressure carries the force"


def test_each_flank_of_a_groove_counts_its_own_way() -> None:
    """The roller touches the inner flank as a cylinder a cylinder, the outer one as a cylinder its socket."""
    study = Study(example("groove", **STEEL, thickness_mm=20.0), 720)
    force, roller = values(study, "contact_force_n"), 32.0
    inner, outer = (2.0 / values(study, slug) for slug in ("profile_curvature_per_mm", "outer_curvature_per_mm"))
    diameter = np.where(force > 0.0, inner * roller / (inner + roller), outer * roller / (outer - roller))
    assert (force > 0.0).any()
    assert (force < 0.0).any()
    wanted = 0.591 * np.sqrt(np.abs(force) * 206e3 / (20.0 * diameter))
    assert values(study, "contact_pressure_mpa") == pytest.approx(wanted, rel=1e-3)


def test_a_hollow_profile_is_a_socket_too() -> None:
    study = Study(with_values(example("rocker_cam", **STEEL, thickness_mm=10.0), motion__stroke=45.0), 720)
    bend, force = values(study, "profile_curvature_per_mm"), values(study, "contact_force_n")
    hollow = (bend < -1e-3) & (force > 0.0)
    assert hollow.any()
    roller = 2.0 * study.design.drive.cam.roller_radius_mm
    diameter = -2.0 / bend[hollow] * roller / (-2.0 / bend[hollow] - roller)
    wanted = 0.591 * np.sqrt(force[hollow] * 206e3 / (10.0 * diameter))
    assert values(study, "contact_pressure_mpa")[hollow] == pytest.approx(wanted, rel=1e-3)


# -- where there is none -----------------------------------------------------------------------------------


def test_what_is_not_pressed_has_no_stress_and_columns_stand_in_the_table() -> None:
    """A conjugate pair: one roller carries, the other has 0; the second cam may be of another width and material."""
    pair = example("conjugate")
    study = Study(pair, 360)
    head, *lines = files(study, ("dynamics",))["dynamics.csv"].splitlines()
    table = dict(zip(head.split(","), np.array([line.split(",") for line in lines], dtype=float).T, strict=True))
    for key in ("", "second_"):
        force, pressure = table[f"{key}contact_force_n"], table[f"{key}contact_pressure_mpa"]
        assert (force == 0.0).any()
        assert ((pressure > 0.0) == (force > 0.0)).all()
        assert table[f"{key}subsurface_shear_mpa"] == pytest.approx(0.300283 * pressure, rel=1e-6)
    wide = with_values(pair, cam__second__thickness_mm=100.0, cam__second__roller_material="42crmo4")
    assert loads(dumps(wide)) == wide
    other = Study(wide, 360)
    assert values(other, "contact_pressure_mpa") == pytest.approx(table["contact_pressure_mpa"])
    assert values(other, "second_contact_pressure_mpa") == pytest.approx(
        0.5 * table["second_contact_pressure_mpa"], rel=2e-3
    )


def test_a_follower_that_is_off_the_cam_has_no_stress() -> None:
    light = with_values(example("rocker_cam", thickness_mm=10.0), shaft__speed_rpm=2500.0)
    force, pressure = (values(Study(light, 360), slug) for slug in ("contact_force_n", "contact_pressure_mpa"))
    assert (force < 0.0).any()
    assert ((pressure > 0.0) == (force > 0.0)).all()


def test_an_undercut_profile_has_no_pressure_and_a_finding_says_so() -> None:
    small = with_values(
        example("rocker_cam", thickness_mm=10.0),
        motion__stroke=90.0,
        cam__base_radius_mm=30.0,
        cam__roller_radius_mm=60.0,
    )
    study = Study(small, 90)
    assert {each.code for each in findings_of(study, ("cam",))} >= {"undercut"}
    assert set(found(small)) == {"no-contact-pressure-undercut"}
    assert "contact_pressure_mpa" not in files(study, ("dynamics",))["dynamics.csv"].splitlines()[0]


def test_what_is_missing_is_named_where_a_stress_is_asked_for() -> None:
    bare = load(EXAMPLES / "rocker_cam.toml")
    assert found(bare) == {}, "nobody asks"
    assert found(with_values(bare, cam__thickness_mm=10.0)) == {}
    said = found(with_values(bare, cam__material="16mncr5"))["no-contact-pressure"]
    assert (said.severity, said.values["fields"]) == (NOTE, "cam.thickness_mm, cam.roller_material")
    assert (
        said.message
        == "no contact pressure: give the thickness of the cam, and the material of the roller, or its Young's modulus"
    )
    limited = with_values(bare, cam__thickness_mm=10.0, limits__contact_pressure_mpa=500.0)
    said = found(limited)["no-contact-pressure"]
    assert (said.severity, said.field) == (WARNING, "cam.material"), "a limit that nothing keeps"
    edge = found(disk("knife", material="steel", roller_material="steel"))
    assert "knife edge touches in a line without width" in edge["no-contact-pressure-edge"].message


@pytest.mark.parametrize(
    ("cam", "path"),
    [({"material": "butter"}, "cam.material"), ({"youngs_modulus_gpa": 0.0}, "cam.youngs_modulus_gpa"),
     ({"roller_poisson_ratio": 0.6}, "cam.roller_poisson_ratio"), ({"roller_load_rating_n": "big"}, "cam.roller_load_rating_n")],
)  # fmt: skip
def test_a_wrong_entry_is_a_fault(cam: dict[str, Any], path: str) -> None:
    with pytest.raises(DesignError) as refused:
        disk(**cam)
    assert [fault.path for fault in refused.value.faults] == [path]


# -- materials and limits ----------------------------------------------------------------------------------


def test_every_material_has_its_sources_and_a_typed_modulus_stands_before_its_own() -> None:
    rows = tomllib.loads((ROOT / "resources" / "materials.toml").read_text("utf-8"))["material"]
    assert len({row["slug"] for row in rows}) == len(rows) >= 8
    for row in rows:
        assert row["source"]
        assert ("contact_pressure_mpa" in row) == bool(row.get("pressure_source"))
        study = Study(disk(material=row["slug"], roller_material=row["slug"]), 4)
        same = {f"{key}youngs_modulus_gpa": row["youngs_modulus_gpa"] for key in ("", "roller_")}
        same |= {f"{key}poisson_ratio": row["poisson_ratio"] for key in ("", "roller_")}
        typed = Study(disk(material="steel", roller_material="pom", **same), 4)
        assert values(study, "contact_pressure_mpa") == pytest.approx(values(typed, "contact_pressure_mpa"), rel=1e-14)


def test_a_pressure_beyond_the_users_limit_or_what_a_material_bears_is_a_finding() -> None:
    pressed = disk(material="16mncr5", roller_material="steel")
    (pressure,) = set(values(Study(pressed, 1), "contact_pressure_mpa"))
    assert found(with_values(pressed, limits__contact_pressure_mpa=pressure)) == {}
    over = found(with_values(pressed, limits__contact_pressure_mpa=0.99 * pressure))
    assert list(over) == ["contact-pressure"]
    assert over["contact-pressure"].values == {"value": pytest.approx(pressure), "limit": 0.99 * pressure}
    load = FORCE * (1500.0 / pressure) ** 2
    assert found(with_values(pressed, loads__preload_n=0.999 * load)) == {}
    heavy = with_values(pressed, loads__preload_n=1.001 * load)
    said = found(heavy)["material-pressure"]
    assert (said.field, said.severity, said.values["limit"]) == ("cam.material", WARNING, 1500.0)
    assert "the cam's 16MnCr5, case-hardened allows 1500 MPa (ISO 6336-5" in said.message
    stated = with_values(heavy, limits__contact_pressure_mpa=1400.0)
    assert list(found(stated)) == ["contact-pressure"], "one limit is in force, the stated one"
    assert found(with_values(heavy, limits__contact_pressure_mpa=1600.0)) == {}
    (row,) = [
        row
        for row in json.loads(files(Study(heavy, 8))["summary.json"])["limits"]
        if row["name"] == "contact_pressure_mpa"
    ]
    assert (row["limit"], row["value"]) == (1500.0, pytest.approx(1500.0 * sqrt(1.001), rel=1e-9))


def test_another_material_computes_no_forces_anew() -> None:
    study = Study(example("groove", thickness_mm=20.0, roller_load_rating_n=8000.0))
    _ = findings_of(study), extremes_of(study, "dynamics"), roller_lives(study), study.stress
    before = dict(evaluations)
    other = Study(with_values(study.design, cam__material="en-gjl-250"))
    assert values(other, "contact_pressure_mpa").max() < values(study, "contact_pressure_mpa").max()
    assert {key: count - before[key] for key, count in evaluations.items() if count != before[key]} == {"stress": 1}
    high = extremes_of(other, "dynamics", ("contact_pressure",))["contact_pressure"].high
    assert high.value < extremes_of(study, "dynamics", ("contact_pressure",))["contact_pressure"].high.value


# -- rolling life ------------------------------------------------------------------------------------------


def test_the_life_under_a_constant_force_is_the_standards() -> None:
    """The roller turns 30/10 times as fast as the shaft, 600 rpm; (10 000/1000)^(10/3) = 2154.43 million turns; L10h =
    10^6 L10/(60 n) = 59 845 h (ISO 281)."""
    design = disk(roller_load_rating_n=10_000.0)
    (row,) = json.loads(files(Study(design, 8))["summary.json"])["rolling_life"]
    assert (row["roller"], row["mean_rpm"], row["load_n"]) == ("first", pytest.approx(600.0), pytest.approx(FORCE))
    assert row["million_turns"] == pytest.approx(2154.4346900318847, rel=1e-12)
    assert row["hours"] == pytest.approx(59_845.408, rel=1e-8)
    assert "Rolling life L10, ISO 281" in report(Study(design, 8))
    assert "rolling_life" not in json.loads(files(Study(disk(), 8))["summary.json"])
    assert roller_lives(Study(with_values(design, loads__preload_n=-5.0), 8))[0].hours == inf, "nothing presses it"


@pytest.mark.parametrize("name", ["rocker_cam", "groove", "conjugate"])
def test_the_roller_rolls_without_slip_and_its_life_is_that_of_its_force_and_speed(name: str) -> None:
    """Where it touches it moves as the cam does; the life by plain sums over many angles."""
    design = with_values(load(EXAMPLES / f"{name}.toml"), cam__roller_load_rating_n=6000.0)
    study = Study(design, 7200)
    shape, kinematics = study.cam, study.linkage
    for i, life in enumerate(roller_lives(study)):
        key = "second_" if i else ""
        speed = values(study, f"{key}roller_speed_rpm") * pi / 30.0 / study.omega
        flanks = [f for f in shape.flanks if (f.name == "second") == bool(i)]
        carries = [c.force > 0.0 for f, c in zip(shape.flanks, study.dynamics.contacts, strict=True) if f in flanks]
        turn = kinematics.bodies[flanks[0].body].turn[1]
        velocity = flanks[0].relative_velocity + 1j * study.sense * flanks[0].reference
        for flank, there in zip(flanks, carries, strict=True):
            radius = shape.flank.radius if not i else flank.radius
            at = flank.reference - radius * (
                -1.0 if flank.name == "outer" else 1.0
            ) * 1j * study.sense * flank.relative_velocity / np.abs(flank.relative_velocity)
            slip = velocity + 1j * (speed + turn) * (at - flank.reference) - 1j * study.sense * at
            assert np.abs(slip[there]).max() < 1e-12 * np.abs(at).max()
        force = sum(
            np.maximum(c.force, 0.0) for f, c in zip(shape.flanks, study.dynamics.contacts, strict=True) if f in flanks
        )
        mean = np.sum(force ** (10.0 / 3.0) * np.abs(speed)) / np.sum(np.abs(speed))
        assert life.load == pytest.approx(mean**0.3, rel=1e-3)
        assert life.million_turns == pytest.approx((6000.0 / mean**0.3) ** (10.0 / 3.0), rel=3e-3)
        assert life.hours == pytest.approx(life.million_turns * 1e6 / (60.0 * life.rpm), rel=1e-12)
    assert len(roller_lives(study)) == (2 if name == "conjugate" else 1)
