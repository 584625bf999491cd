"""Links that more pairs hold than need be: accepted where they agree, reactions that statics does not fix left out; else refused."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from linkages import link
from sampled import spread

from core.__main__ import main
from core.design import Design, Drive, Driver, Linkage, LinkageLoads, LinkForce, LinkMass, Slider, faults, put
from core.errors import NoPosition, NoSolution
from core.project import loads, save
from core.project.writing import dumps
from core.study import Study, certificate_of, extremes_of, findings_of, many

G = 9.80665


def three_cranks(third: float = 20.0) -> Design:
    """A coupling rod on three cranks of 20 mm."""
    links = (
        link(1, O2=(0, 0), O4=(60, 0), O6=(30, 0)),
        link(2, O2=(0, 0), A=(20, 0)),
        link(3, A=(0, 0), B=(60, 0), C=(30, 0)),
        link(4, O4=(0, 0), B=(20, 0)),
        link(5, O6=(0, 0), C=(third, 0), T=(40, 0)),
    )
    masses = tuple(LinkMass(link=n, mass_kg=0.1 * n, inertia_kg_m2=1e-4, centre_x_mm=10.0) for n in (2, 3, 4, 5))
    rows = LinkageLoads(masses=masses, forces=(LinkForce(link=5, point="T", x_n=3.0, torque_nm=0.2),))
    return Design("three cranks", None, (Drive(None, Linkage(links, (), Driver(2)), None, rows),))


def test_a_rod_on_three_cranks_runs_and_its_torque_is_that_of_virtual_work(tmp_path: Path) -> None:
    design = three_cranks()
    assert faults(design) == []
    study = Study(design, 360)
    bodies, theta = study.linkage.bodies, study.theta
    for name, pivot in (("link4", 60.0), ("link5", 30.0)):
        pin = bodies[name].position("B" if name == "link4" else "C")
        assert np.abs(pin - 1e-3 * (pivot + 20.0 * np.exp(1j * theta))).max() < 1e-12 * 0.06
    weights = G * np.cos(theta) * (0.01 * (0.2 + 0.4 + 0.5) + 0.02 * 0.3)
    torque = weights + 3.0 * 0.04 * np.sin(theta) - 0.2
    assert np.abs(study.dynamics.driver - torque).max() < 1e-11 * np.abs(torque).max()
    proof = certificate_of(study)
    assert proof["power_balance"].value < 1e-12
    assert all(residual.kept for residual in proof.values()), proof
    save(design, tmp_path / "rod.toml")
    assert main(["export", str(tmp_path / "rod.toml"), "--out", str(tmp_path), "--samples", "72"]) == 0
    with (tmp_path / "dynamics.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["driver_torque_nm"]) for row in rows] == pytest.approx(torque[::5], abs=1e-11)
    assert [name for name in rows[0] if name.endswith(("_x_n", "_y_n"))] == []
    found = {f["code"]: f for f in json.loads((tmp_path / "summary.json").read_text("utf-8"))["findings"]}
    assert found["redundant-links"]["severity"] == found["undetermined-reactions"]["severity"] == "note"
    assert found["redundant-links"]["values"]["links"] == "2, 3, 4 and 5"
    assert "O2" in found["undetermined-reactions"]["values"]["pairs"]


def test_many_rods_on_three_cranks_are_as_each_alone() -> None:
    """The torque of those that agree; the one whose third crank is longer is refused, as alone."""
    design = three_cranks()
    third, forces = np.array([20.0, 20.0, 20.5]), np.array([3.0, -8.0, 3.0])
    paths = {"linkage.links[4].points.C.x_mm": third, "loads.forces[0].x_n": forces}
    found = many(design, paths, ["driver_torque_nm:max", "driver_torque_nm:rms"])
    for i in (0, 1):
        alone = Study(put(design, "loads.forces[0].x_n", float(forces[i])), 720)
        highest = extremes_of(alone, "dynamics", ("driver_torque",))["driver_torque"].high.value
        assert found.value["driver_torque_nm:max"][i] == pytest.approx(highest, rel=1e-9)
        rms = math.sqrt((alone.dynamics.driver**2).mean())
        assert found.value["driver_torque_nm:rms"][i] == pytest.approx(rms, rel=1e-9)
    assert [bool(reason) for reason in found.reason] == [False, False, True]
    with pytest.raises(NoPosition):
        _ = Study(put(design, "linkage.links[4].points.C.x_mm", 20.5), 72).linkage


def test_reactions_beside_the_redundant_links_are_given() -> None:
    """A pendulum hung on the rod's crank: its pin is fixed by statics, and stands in the tables."""
    design = three_cranks()
    linkage = design.drive.linkage
    links = (*linkage.links, link(6, T=(0, 0), E=(25, 0)), link(7, E=(0, 0)))
    rows = LinkageLoads(masses=(LinkMass(link=7, mass_kg=1.0),))
    more = Linkage(links, (Slider(link=7, on=1, through_y_mm=-30.0),), Driver(2))
    made = Design("with a slide", None, (Drive(None, more, None, rows),))
    study = Study(made, 72)
    assert "7" not in study.undetermined
    assert {"T", "E"}.isdisjoint(study.undetermined)
    assert {"A", "B", "C", "O2", "O4", "O6"} == study.undetermined
    assert set(study.free_bodies) == {"link6", "link7"}
    slide = study.linkage.bodies["link7"].z[2].real * study.omega**2
    assert study.dynamics.pairs["E"].real * (
        1.0 if study.linkage.pairs["E"].body == "link7" else -1.0
    ) == pytest.approx(slide, abs=1e-9 * np.abs(slide).max())


def test_two_bars_between_parallel_guides() -> None:
    """Two carriages on parallel guides, with two equal bars between them."""
    links = (
        link(1, O=(0, 0)),
        link(2, O=(0, 0), A=(15, 0)),
        link(3, A=(0, 0), P=(50, 0)),
        link(4, P=(0, 0), Q=(30, 0)),
        link(5, R=(0, 0), S=(30, 0)),
        link(6, P=(0, 0), R=(25, 0)),
        link(7, Q=(0, 0), S=(25, 0)),
    )
    sliders = (Slider(link=4, on=1), Slider(link=5, on=1, through_y_mm=20.0))
    masses = LinkageLoads(masses=(LinkMass(link=5, mass_kg=2.0),))
    design = Design("guides", None, (Drive(None, Linkage(links, sliders, Driver(2)), None, masses),))
    assert faults(design) == []
    study = Study(design, 120)
    first, second = (study.linkage.bodies[f"link{n}"].z for n in (4, 5))
    assert np.abs(second[0] - first[0] - (15e-3 + 20e-3j)).max() < 1e-12 * 0.05
    speed = first[1].real * study.omega
    power = 2.0 * first[2].real * study.omega**2 * speed
    assert study.dynamics.driver * study.omega == pytest.approx(power, abs=1e-12 * np.abs(power).max())


@pytest.mark.parametrize("third", spread([20.0 + 1e-9, 20.0 - 5e-8 / 2], 1))
def test_lengths_that_differ_by_rounding_agree(third: float) -> None:
    assert all(residual.kept for residual in certificate_of(Study(three_cranks(third), 90)).values())


@pytest.mark.parametrize("third", spread([20.0 + 1e-6, 22.0], 1))
def test_lengths_that_do_not_agree_are_refused_in_one_line(
    third: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(NoPosition):
        _ = Study(three_cranks(third)).linkage
    (tmp_path / "rod.toml").write_text(dumps(three_cranks(third)), "utf-8")
    assert main(["check", str(tmp_path / "rod.toml")]) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    if third == 22.0:
        assert said.startswith("linkage: 1 too many: links 2, 3, 4 and 5 overconstrain each other")
    else:
        assert "do not agree" in said


def test_friction_in_a_pin_that_statics_does_not_fix_is_refused() -> None:
    text = dumps(three_cranks()) + '\n[[loads.pair_friction]]\npair = "B"\ncoefficient = 0.1\nradius_mm = 5.0\n'
    rubs = loads(text)
    with pytest.raises(NoSolution, match="statics does not determine"):
        _ = Study(rubs, 36).dynamics
    assert math.isfinite(float(np.abs(Study(put(rubs, "loads.pair_friction", ()), 36).dynamics.driver).max()))
    assert findings_of(Study(three_cranks(), 36))
