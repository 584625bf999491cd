"""core.study: what is asked for is computed once, from only the parts it needs, and nothing else is."""

import copy
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mechanisms import (
    LAYOUT_DESIGNS,
    LIFT,
    PUSHER,
    levels,
    with_cam,
    with_drive,
    with_follower,
    with_loads,
    with_shaft,
)

from core.design import Design, NamedCurve, Segment
from core.errors import NoSuchStage
from core.motion import Angles
from core.study import Study, certificate_of, clear_caches, evaluations, extremes_of, findings_of, quantities_of
from core.study.stages import memory

ROOT = Path(__file__).parents[3]
STAGES = ("motion", "linkage", "cam", "dynamics")


def asked(design: Design, *names: str) -> Counter[str]:
    """What is really computed when these stages are asked for."""
    before = Counter(evaluations)
    study = Study(design, 72)
    for name in names:
        getattr(study, name)
    return Counter(evaluations) - before


# -- only what is needed ----------------------------------------------------------------------------------


@pytest.mark.parametrize("design", [LIFT, PUSHER], ids=["lift", "pusher"])
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_a_stage_computes_those_before_it_once_and_none_after_it(design: Design, count: int) -> None:
    assert asked(design, STAGES[count - 1]) == dict.fromkeys(STAGES[:count], 1)
    assert asked(design, *STAGES[:count]) == {}, "all of it is kept"


def test_findings_and_figures_of_the_motion_solve_no_linkage() -> None:
    study = Study(LIFT, 72)
    findings_of(study, ("motion",))
    certificate_of(study, ("motion",))
    extremes_of(study, "motion")
    assert set(evaluations) == {"motion"}
    findings_of(study, ("linkage",))
    certificate_of(study, ("linkage",))
    assert set(evaluations) == {"motion", "linkage"}
    findings_of(study, ("cam",))
    assert set(evaluations) == {"motion", "linkage", "cam"}


EDITS: dict[str, tuple[Callable[[Design], Design], tuple[str, ...]]] = {
    "name": (lambda d: replace(d, name="another"), ()),
    "assumed": (lambda d: replace(d, assumed=("loads.friction",)), ()),
    "flywheel": (lambda d: with_shaft(d, flywheel_inertia_kg_m2=7.0), ()),
    "motor": (lambda d: with_shaft(d, motor_slope_nm_s_per_rad=7.0), ()),
    "fluctuation": (lambda d: with_shaft(d, speed_fluctuation=0.1), ()),
    "speed": (lambda d: with_shaft(d, speed_rpm=33.0), ("dynamics",)),
    "friction": (lambda d: with_loads(d, friction=0.05), ("dynamics",)),
    "rotation": (lambda d: with_shaft(d, rotation="cw"), ("cam", "dynamics")),
    "roller for base radius": (
        lambda d: with_cam(d, base_radius_mm=450.0, roller_radius_mm=100.0),
        ("cam", "dynamics"),
    ),
    "base radius": (lambda d: with_cam(d, base_radius_mm=410.0), ("linkage", "cam", "dynamics")),
    "rod": (lambda d: with_follower(d, rod_mm=846.0), ("linkage", "cam", "dynamics")),
    "law": (
        lambda d: with_drive(
            d,
            motion=replace(
                d.drive.motion,
                segments=(
                    *d.drive.motion.segments[:1],
                    Segment(41.5, -150.0, NamedCurve("cycloidal")),
                    *d.drive.motion.segments[2:],
                ),
            ),
        ),
        STAGES,
    ),
}


@pytest.mark.parametrize("edit", ["assumed", "roller for base radius", "law"])
def test_an_edit_of_more_than_a_field_computes_again_only_what_depends_on_it(edit: str) -> None:
    """Single fields: test_study_edits."""
    change, needed = EDITS[edit]
    assert asked(LIFT, *STAGES) == dict.fromkeys(STAGES, 1)
    assert asked(change(LIFT), *STAGES) == dict.fromkeys(needed, 1)
    assert asked(LIFT, *STAGES) == {}, "undo computes nothing"
    assert asked(change(LIFT), *STAGES) == {}, "and redo does not either"


def test_what_an_edit_leaves_alone_is_the_same_object_and_what_it_touches_changes() -> None:
    """Nothing stale: a fresh computation of the edited design gives the same figures."""
    before = Study(LIFT, 72)
    for stage in STAGES:
        extremes_of(before, stage)  # what could be stale
    after = {edit: Study(change(LIFT), 72) for edit, (change, _) in EDITS.items()}
    for edit, (_, needed) in EDITS.items():
        same = {stage for stage in STAGES if getattr(before, stage) is getattr(after[edit], stage)}
        assert same == set(STAGES) - set(needed), edit
    figures = {edit: {stage: dict(extremes_of(study, stage)) for stage in STAGES} for edit, study in after.items()}
    for edit, (change, needed) in EDITS.items():
        clear_caches()
        fresh = Study(change(LIFT), 72)
        assert {stage: dict(extremes_of(fresh, stage)) for stage in needed} == {
            stage: figures[edit][stage] for stage in needed
        }, edit


@pytest.mark.parametrize(("edit", "wheels"), [("name", 0), ("flywheel", 1), ("motor", 1), ("fluctuation", 1)])
def test_another_flywheel_needs_no_forces(edit: str, wheels: int) -> None:
    """Neither stages nor the torque's fine curve are computed again, nor are undone flywheels."""
    assert asked(LIFT, *STAGES, "flywheel")["flywheel"] == 1
    expected = {"flywheel": wheels} if wheels else {}
    assert asked(EDITS[edit][0](LIFT), *STAGES, "flywheel") == expected
    assert asked(LIFT, "flywheel") == {}


def test_extremes_are_kept_too_and_another_flywheel_does_not_touch_those_of_the_cam() -> None:
    study = Study(LIFT, 72)
    for stage in STAGES:
        extremes_of(study, stage)
    before = Counter(evaluations)
    for stage in STAGES:
        extremes_of(Study(LIFT, 360), stage)
    assert Counter(evaluations) == before, "they do not depend on the samples"
    for stage in STAGES[:3]:
        extremes_of(Study(EDITS["flywheel"][0](LIFT), 72), stage)
        extremes_of(Study(EDITS["friction"][0](LIFT), 72), stage)
    assert Counter(evaluations) == before
    one, other = (extremes_of(Study(d, 72), "motion") for d in (LIFT, EDITS["speed"][0](LIFT)))
    assert other["velocity"].high.value == pytest.approx(one["velocity"].high.value * 33.0 / 20.0, rel=1e-14)


def test_more_samples_are_another_question() -> None:
    assert asked(LIFT, "cam") == {"motion": 1, "linkage": 1, "cam": 1}
    before = Counter(evaluations)
    assert Study(LIFT, 73).cam.reference.size == 73
    assert Counter(evaluations) - before == {"motion": 1, "linkage": 1, "cam": 1}


def test_passing_cam_angles_are_not_kept() -> None:
    study = Study(LIFT, 72)
    kept = study.dynamics
    before, made = Counter(evaluations), memory.computed.copy()
    there = study.at_theta(study.theta)
    _ = there.dynamics, there.dynamics
    assert Counter(evaluations) - before == dict.fromkeys(STAGES, 1), "once for one study"
    assert memory.computed == made
    for name in ("contact", "torque"):
        assert np.array_equal(getattr(there.dynamics, name), getattr(kept, name))
    _ = study.at_theta(study.theta).motion
    assert Counter(evaluations)["motion"] == before["motion"] + 2
    assert study.dynamics is kept


def test_nobody_can_spoil_what_others_share() -> None:
    study = Study(LIFT, 72)
    arrays = [
        study.theta, study.motion.y, study.motion.velocity_sign, study.linkage.follower.z, study.linkage.coordinates["phi"].all,
        study.linkage.singular["dead-centre"], study.cam.flank.profile, study.cam.centre.point, study.dynamics.contact,
        study.dynamics.pairs["pivot"], study.dynamics.guide.normal,
    ]  # fmt: skip
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0
    assert study.motion.y[0, 0] == pytest.approx(0.150, rel=1e-15)


# -- stages that do not exist -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["strength", "shaft", "Motion", "cams"])
def test_a_stage_that_this_kind_lacks_is_named_with_those_there_are(name: str) -> None:
    study = Study(LIFT, 8)
    for ask in (lambda: getattr(study, name), lambda: study.require_stage(name), lambda: extremes_of(study, name)):
        with pytest.raises(NoSuchStage) as caught:
            ask()
        assert caught.value.stage == name
        assert repr(name) in str(caught.value)
        assert "motion, linkage, cam, dynamics" in str(caught.value)
    assert evaluations == {}


def test_stages_are_named_in_the_order_they_need_each_other() -> None:
    assert Study(LIFT).stages == (*STAGES, "stability")
    for stage in Study(LIFT).stages:
        Study(LIFT).require_stage(stage)


def test_a_study_may_be_copied() -> None:
    """Python looks for names of its own that no stage has."""
    assert copy.deepcopy(Study(LIFT, 8)).design == LIFT


def test_every_quantity_has_one_value_for_each_cam_angle() -> None:
    for design in (LIFT, PUSHER):
        study = Study(design, 24)
        for name, row in quantities_of(study).items():
            values = row.value(study)
            assert values.shape == (24,), name
            assert values.dtype == np.float64, name
            assert row.stage in STAGES


def test_the_right_hand_limit_is_taken_unless_the_left_is_asked_for() -> None:
    design = with_drive(
        PUSHER, motion=levels(0.0, (90.0, 20.0, "constant-velocity"), (90.0, 20.0, "dwell"), (180.0, 0.0, "3-4-5"))
    )
    study = Study(design, 4)
    join = study.theta[[1]]
    assert study.motion.y[1, 1] == 0.0
    left = study.at(Angles(join, np.array([0])))
    assert left.motion.y[1, 0] == pytest.approx(0.020 / (np.pi / 2), rel=1e-15)
    assert left.motion.y[0, 0] == pytest.approx(study.motion.y[0, 1], rel=1e-15)


def test_eight_designs_in_turn_stay_in_memory() -> None:
    for design in LAYOUT_DESIGNS.values():
        asked(design, *STAGES)
    for design in LAYOUT_DESIGNS.values():
        assert asked(design, *STAGES) == {}
    clear_caches()
    assert evaluations == {}
    assert asked(LIFT, "motion") == {"motion": 1}


# -- nothing is loaded that is not needed -----------------------------------------------------------------

HEADLESS = """
import sys
from core.__main__ import main

for example in ("transfer_lift", "four_bar_coupler_cam"):
    code = main(["export", f"resources/examples/{example}.toml", "--out", sys.argv[1], "--samples", "36"])
    assert code == 0, example
print("LOADED", *sorted({".".join(name.split(".")[:2 if name.startswith("core.") else 1]) for name in sys.modules}))
"""


def test_exporting_loads_neither_scipy_nor_a_window(tmp_path: Path) -> None:
    """Neither for a cam nor for a linkage."""
    done = subprocess.run(
        [sys.executable, "-c", HEADLESS, str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        encoding="utf-8",
    )
    loaded = set(done.stdout.splitlines()[-1].split()[1:])
    assert "core" in loaded
    assert not {"scipy", "PySide6", "shiboken6", "pyqtgraph", "PIL", "kindyna_gui", "matplotlib"} & loaded
    others = {"blend", "measured", "stability", "output.texts", "output.position", "output.stability_files"}
    assert not {f"core.{name}" for name in others} & loaded, "of other commands"


REPORTED = """
import sys
from core.__main__ import main

assert main(["report", "resources/examples/transfer_lift.toml", "--out", sys.argv[1]]) == 0
print("LOADED", *sorted({name.split(".")[0] for name in sys.modules}))
"""


def test_the_claims_of_a_paper_in_a_report_load_no_scipy(tmp_path: Path) -> None:
    """One of them reads the lift's motion from a table of its values, and searches that for wrong rows."""
    words = [sys.executable, "-c", REPORTED, str(tmp_path / "lift.html")]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True, encoding="utf-8")
    assert "FILEIO.C" in (tmp_path / "lift.html").read_text("utf-8")
    assert "scipy" not in done.stdout.splitlines()[-1].split()


CHECKED = """
import gc
collected = []
gc.callbacks.append(lambda phase, info: collected.append(info["generation"]))
from core.__main__ import main

assert main(["check", "resources/examples/transfer_lift.toml"]) == 0
print("SEARCHED", collected.count(2), gc.isenabled(), gc.get_freeze_count() > 10_000)
"""


def test_checking_searches_no_module_for_garbage() -> None:
    """What is imported stays as long as the process: it is not gone through, neither then nor later."""
    done = subprocess.run(
        [sys.executable, "-c", CHECKED], cwd=ROOT, capture_output=True, text=True, check=True, encoding="utf-8"
    )
    assert done.stdout.splitlines()[-1] == "SEARCHED 0 True True"


NEEDED = """
import sys
from core.__main__ import main

assert main(["check", "resources/examples/transfer_lift.toml"]) == 0
print("LOADED", *sorted(sys.modules))
"""


def test_checking_a_lift_loads_nothing_of_other_questions() -> None:
    """Nor do rooms that offer them, until one is read."""
    done = subprocess.run(
        [sys.executable, "-c", NEEDED], cwd=ROOT, capture_output=True, text=True, check=True, encoding="utf-8"
    )
    loaded = set(done.stdout.splitlines()[-1].split()[1:])
    other = {
        "core.design": "load_edits unfinished motion_edits",
        "core.dynamics": "contact_force flight free_body",
        "core.instant_centres": "velocities",
        "core.shaft": "balancer phases",
        "core.study": "batch stages_of_many highest speeds",
    }
    assert "core.study.findings" in loaded
    assert not {f"{room}.{name}" for room, names in other.items() for name in names.split()} & loaded
    assert not {"scipy", "shutil", "fractions", "decimal", "subprocess"} & loaded
    from core import design, dynamics

    assert callable(dynamics.flights)
    assert callable(design.with_join_moved)
    with pytest.raises(AttributeError, match="no attribute 'flight_of_fancy'"):
        _ = dynamics.flight_of_fancy  # type: ignore[attr-defined]
