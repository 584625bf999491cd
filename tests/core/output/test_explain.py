"""Where a number comes from: each equation that is shown, worked out with the letters that are shown, gives the value that is shown."""

import csv
import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import four_bar
from mechanisms import LAYOUT_DESIGNS
from random_linkages import DRIVES, random_linkage
from sampled import spread, stressed
from typeset_lines import Evaluator

from core.__main__ import main
from core.design import Balancer, put
from core.output.channels import channels, existing
from core.output.explain import Explanation, as_text, explainable, explained, number_of_finding, number_of_residual
from core.output.export import files
from core.output.summary import summary
from core.project import load, loads
from core.study import Study, certificate_of, findings_of
from core.study.formulas import FORMULAS
from core.units import UNITS

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
NAMES = [path.stem for path in sorted(EXAMPLES.glob("*.toml"))]
OF_ONE_DRIVE = [name for name in NAMES if "[[drives]]" not in (EXAMPLES / f"{name}.toml").read_text("utf-8")]
FACTORS = {unit.symbol: unit.factor for unit in UNITS.values()} | {"": 1.0}


def check(made: Explanation, size: float, turns: bool = False) -> None:
    """size: of the quantity over the turn, in its unit."""
    letters = {each.symbol: each.value * FACTORS[each.unit] for each in made.letters}
    worked, shown = Evaluator(letters).value(made.lines[0]), made.value * FACTORS[made.unit]
    if turns:
        worked += 2.0 * math.pi * round((shown - worked) / (2.0 * math.pi))
    largest = max(map(abs, letters.values()), default=0.0)
    close = 1e-9 * size * FACTORS[made.unit] + 1e-14 * largest + 1e-12
    assert worked == pytest.approx(shown, rel=1e-9, abs=close), (made.quantity, made.at_deg, made.lines)
    assert made.source
    assert made.letters, made.quantity
    assert all(each.meaning and each.origin for each in made.letters)


def rows_of(study: Study) -> Iterator[tuple[str, float, bool]]:
    """Column, size over the turn, and whether it may be whole turns apart."""
    for row in existing(study, channels(study.design)):
        values = row.value(study)
        yield row.slug, float(np.abs(values[np.isfinite(values)]).max(initial=0.0)), row.unit.symbol == "°"


@pytest.mark.parametrize("name", spread(OF_ONE_DRIVE, 1))
def test_every_equation_shown_gives_the_largest_value_shown(name: str) -> None:
    study = Study(load(EXAMPLES / f"{name}.toml"))
    extremes = summary(study)["extremes"]
    for slug, size, turns in rows_of(study):
        check(explained(study, slug), size, turns)
        if slug in extremes:  # on that side of a jump where it stands
            largest = max((extremes[slug][side]["value"] for side in ("min", "max")), key=abs)
            assert explained(study, slug).value == pytest.approx(largest, rel=1e-7, abs=1e-12 * size)
    for figure in set(explainable(study)) - {slug for slug, _, _ in rows_of(study)}:
        check(explained(study, figure), 0.0)


@pytest.mark.parametrize("seed", [seed if seed in (1, 5) else stressed(seed) for seed in range(55)])
def test_every_number_of_a_random_linkage_is_explained(seed: int) -> None:
    """Cranks that turn, swing and stop; second inputs by ratios, on arms, racks and motors; slides, pins and cylinders that drive."""
    study = Study(random_linkage(seed, DRIVES[seed % len(DRIVES)]), 36)
    angles = study.angle_degrees
    for slug, size, turns in rows_of(study):
        for angle in (None, float(angles[angles.size // 3])):
            made = explained(study, slug, angle)
            locked = study.swings and made.at_deg in (0.0, 180.0)  # where the crank stops a force is lost in rounding
            if not made.why and not locked:
                check(made, size, turns)


@pytest.mark.stress
def test_the_equations_hold_for_guides_of_any_direction() -> None:
    """The examples' guides are level; of these no two point alike."""
    for letter in "aceg":
        study = Study(LAYOUT_DESIGNS[letter])
        for slug, size, turns in rows_of(study):
            check(explained(study, slug, 100.0), size, turns)


SERVO = 'kind = "{}"\nefficiency = 0.9\nfriction_{} = 2.0\n{}'
ROTARY = "gear_ratio = 3.0\ntravel_mm_per_turn = 20.0\nrotor_inertia_kg_m2 = 0.0001\ninertia_kg_m2 = 0.0005\n"


@pytest.mark.parametrize(
    "servo", [SERVO.format("rotary", "nm", ROTARY), SERVO.format("linear", "n", "mass_kg = 3.0\n")]
)
def test_what_a_servo_gives_is_explained(servo: str) -> None:
    segments = "".join(
        f'[[motion.segments]]\nlaw = "modified-sine"\nspan_deg = 180.0\nrise_mm = {h}\n' for h in (60.0, -60.0)
    )
    rest = f'[shaft]\nrotation = "ccw"\nspeed_rpm = 60.0\n[loads]\nmass_kg = 5.0\nforce_n = 10.0\n[servo]\n{servo}'
    study = Study(loads(f'format = 1\nname = "Axis"\n[motion]\nstart_mm = 0.0\n{segments}{rest}'))
    named = [row for row in rows_of(study) if row[0].startswith("servo")]
    assert len(named) == 3
    for slug, size, turns in named:
        for angle in (None, 50.0, 160.0, 300.0):
            check(explained(study, slug, angle), size, turns)


def test_a_linkage_without_loads_and_one_that_locks_are_explained(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A double crank, whose links go round; a crank that swings, whose rates have no limit where it turns back."""
    assert as_text(explained(Study(four_bar(60.0, 90.0, 95.0, 100.0)), "link3_deg")).startswith("Link 3")
    text = (EXAMPLES / "four_bar.toml").read_text("utf-8")
    (tmp_path / "locks.toml").write_text(text.replace("A = [30.0, 0.0]", "A = [90.0, 0.0]"), "utf-8")
    assert main(["explain", str(tmp_path / "locks.toml"), "driver_torque_nm", "--at", "60"]) == 0
    assert "no mass, spring or load acts" in capsys.readouterr().out
    assert main(["explain", str(tmp_path / "locks.toml"), "link3_rad_s"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert "infinite: the crank locks at B" in said[0]
    assert "θ̇ = ω θ′" in said[1]
    assert main(["explain", str(tmp_path / "locks.toml"), "link3_rad_s", "--json"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert row["value"] is None
    assert row["symbols"] == []
    assert "locks at B" in row["why"]


def test_the_torque_of_a_shaft_is_the_sum_of_its_drives() -> None:
    study = Study(load(EXAMPLES / "transfer_unit.toml"))
    made = explained(study, "torque_nm")
    assert made.at_deg == pytest.approx(math.degrees(study.camshaft.peak_torque.theta))
    assert made.value == pytest.approx(study.camshaft.peak_torque.value, rel=1e-9)
    assert {"torque_nm", "rms_nm", "peak_power_w", "needed_inertia_kg_m2", "eta", "natural_rpm"} <= set(
        explainable(study)
    )
    for name in explainable(study):
        check(explained(study, name), 0.0)
    assert [explained(study, name).label for name in ("torque_nm", "lift_torque_nm")] == [
        "Torque of the shaft",
        "Torque of Lift",
    ]


@pytest.mark.parametrize("wheel", [200.0, stressed(0.0)])
def test_every_column_of_a_shaft_is_explained(wheel: float) -> None:
    """Motor and speed as shaft.csv has them, with and without a flywheel; the balance cam too."""
    unit = load(EXAMPLES / "transfer_unit.toml")
    balancer = Balancer(spring_rate_n_per_mm=20.0, preload_n=20000.0, base_radius_mm=250.0, roller_radius_mm=60.0)
    design = replace(unit, drives=unit.drives[1:3], timing=(), balancer=balancer, assumed=())
    study = Study(put(design, "shaft.flywheel_inertia_kg_m2", wheel))
    header, _, *rows = csv.reader(files(study)["shaft.csv"].splitlines())
    for name, cell in zip(header[1:], rows[36][1:], strict=True):
        made = explained(study, name, float(rows[36][0]))
        check(made, abs(float(cell)))
        assert made.value == pytest.approx(float(cell), rel=1e-9, abs=1e-9)
        check(explained(study, name), abs(float(cell)))


def test_the_largest_torque_leads_to_what_was_typed() -> None:
    """From the torque to the contact force, from there to loads and lever, each a letter that names where it comes from."""
    study = Study(load(EXAMPLES / "transfer_lift.toml"))
    torque = explained(study, "drive_torque_nm")
    assert torque.source == "Shin1995 (27)"
    ends = summary(study)["extremes"]["drive_torque_nm"].values()
    assert abs(torque.value) == pytest.approx(max(abs(end["value"]) for end in ends), rel=1e-12)
    force = next(each for each in torque.letters if each.symbol == "F")
    contact = explained(study, "contact_force_n", torque.at_deg)
    assert contact.value == pytest.approx(force.value, rel=1e-12)
    assert {each.origin for each in contact.letters} >= {"loads", "cam"}
    assert torque.residual is not None
    assert torque.residual[1].kept


def test_the_command_says_it_as_text_and_json(capsys: pytest.CaptureFixture[str]) -> None:
    lift = str(EXAMPLES / "transfer_lift.toml")
    assert main(["explain", lift, "pressure_angle_deg", "--at", "58.5", "--json"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert row["at_deg"] == 58.5
    assert [each["symbol"] for each in row["symbols"]] == ["n_x", "n_y", "v_x", "v_y"]
    assert {"quantity", "value", "law", "equation", "source", "residual", "bound"} <= set(row)
    assert row["law"] == list(FORMULAS["pressure_angle"].lines)
    assert main(["explain", lift, "phi_rad_s"]) == 0
    assert "φ̇ = L̇ cos β/(L₁ sin(β - φ))" in capsys.readouterr().out
    unit = str(EXAMPLES / "transfer_unit.toml")
    assert main(["explain", unit, "radius_mm", "--drive", "Lift"]) == 0


@pytest.mark.parametrize(("words", "said"), [
    (["gear_mm"], "no such quantity; allowed: displacement_mm, velocity_mm_s"),
    (["displacement_mm", "--at", "400"], "allowed: 0 to 360"),
])  # fmt: skip
def test_what_cannot_be_explained_is_refused_in_one_line(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["explain", str(EXAMPLES / "transfer_lift.toml"), *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("name", spread(["transfer_lift", "lecture_six_bar", "conjugate", "tappet_flat"], 2))
def test_a_finding_and_a_residual_lead_to_a_number_that_can_be_explained(name: str) -> None:
    study = Study(load(EXAMPLES / f"{name}.toml"))
    residuals = [number_of_residual(study, each) for each in certificate_of(study)]
    assert all(residuals)
    sharp = Study(put(study.design, "cam.base_radius_mm", 10.0)) if name == "tappet_flat" else study
    found = {each.code: number_of_finding(sharp, each) for each in findings_of(sharp)}
    assert name != "tappet_flat" or "profile_curvature_per_mm" in found.values()
    for slug in {*residuals, *found.values()} - {""}:
        assert explained(sharp, slug, 10.0).quantity == slug
