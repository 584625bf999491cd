"""One edit, each stage once: findings and certificate share the solutions of a design."""

from pathlib import Path

import numpy as np
import pytest
from counting import calls

from core.design import edited, get
from core.output.channels import channels, existing
from core.project import load
from core.study import Study, certificate_of, clear_caches, evaluations, extremes_of, findings_of, quantities_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
SIX_BARS = dict.fromkeys(("lecture_six_bar", "watt_six_bar", "stephenson_six_bar"), 3)
SOLUTIONS = {"transfer_lift": 2, "tappet_flat": 2, **SIX_BARS, "transfer_unit": 8}
"""Example -> solutions of the linkage for its findings and its certificate: of all angles of the turn, and one per pass."""
MIXED = ("transfer_lift", "lecture_six_bar", "groove", "conjugate", "rocker_flat", "four_bar_coupler_cam")


def solutions(stage: str = "linkage") -> int:
    return evaluations[stage]


@pytest.mark.parametrize(("name", "most"), SOLUTIONS.items(), ids=SOLUTIONS)
def test_findings_and_certificate_share_the_solutions_of_the_linkage(name: str, most: int) -> None:
    study = Study(load(EXAMPLES / f"{name}.toml"))
    clear_caches()
    _ = findings_of(study), certificate_of(study)
    assert 0 < solutions() <= most


def test_a_further_quantity_is_refined_at_nodes_that_are_solved() -> None:
    study = Study(load(EXAMPLES / "transfer_lift.toml"))
    clear_caches()
    findings_of(study)
    solved = solutions()
    low = extremes_of(study, "cam", ("pressure_angle",))["pressure_angle"].low  # read by the findings already
    assert solutions() == solved
    further = extremes_of(study, "cam", ("pressure_angle", "instant_centre"))
    assert solutions() == solved + 1, "one pass, at the tops of the further quantity alone"
    assert further["pressure_angle"].low == low


def test_findings_of_another_length_call_few_functions() -> None:
    """What follows from the kind of design alone is built once; the force of the guide needs no other reaction."""
    design = load(EXAMPLES / "transfer_lift.toml")
    rod = get(design, "follower.rod_mm")
    findings_of(Study(edited(design, "follower.rod_mm", rod + 0.001)))
    study = Study(edited(design, "follower.rod_mm", rod + 0.002))
    assert calls(lambda: findings_of(study)) <= 9_500


def test_other_loads_solve_the_linkage_at_the_tops_of_the_forces_alone() -> None:
    design = load(EXAMPLES / "transfer_lift.toml")
    clear_caches()
    _ = findings_of(Study(design)), certificate_of(Study(design))
    solved = solutions()
    study = Study(edited(design, "loads.arm_mass_kg", 1.01 * get(design, "loads.arm_mass_kg")))
    _ = findings_of(study), certificate_of(study)
    assert solutions() == solved + 1


@pytest.mark.parametrize(("name", "most"), [("tappet_flat", 1), ("rocker_cam", 2)])
def test_which_channels_exist_is_asked_once_for_a_design(name: str, most: int) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    study = Study(design)
    clear_caches()
    _ = study.dynamics
    assert solutions() == 1
    rows = existing(study, channels(design))
    assert solutions() - 1 <= most, "the nodes of the turn; where the contact presses, tops of the curvature too"
    before = dict(evaluations)
    assert existing(study, channels(design)) == existing(Study(design), channels(design)) == rows
    findings_of(study)
    assert dict(evaluations)["linkage"] <= before["linkage"] + 1, "the tops of what the findings read besides"


@pytest.mark.parametrize("name", MIXED)
def test_solutions_that_findings_share_give_the_values_of_each_stage_alone(name: str) -> None:
    design = load(EXAMPLES / f"{name}.toml")
    clear_caches()
    alone = Study(design, 72)
    expected = {name: row.value(alone) for name, row in quantities_of(alone).items() if row.exists(alone)}
    clear_caches()
    shared = Study(design, 72)
    findings_of(shared)
    for name, values in expected.items():
        size = np.abs(values).max(where=np.isfinite(values), initial=1e-300)
        np.testing.assert_allclose(quantities_of(shared)[name].value(shared), values, rtol=0, atol=1e-12 * size)
    assert solutions() <= 50
    assert findings_of(alone) == findings_of(shared)
    proof = certificate_of(shared)
    clear_caches()
    for key, residual in certificate_of(Study(design, 72)).items():
        assert proof[key].bound == pytest.approx(residual.bound, rel=1e-6), key
        assert proof[key].value == pytest.approx(residual.value, rel=1e-3, abs=1e-13), key
