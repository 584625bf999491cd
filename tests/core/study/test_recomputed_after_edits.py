"""Every single field of the examples, edited by itself: computed again is what depends on it, and nothing else."""

from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from sampled import spread

from core.design import Design, Entry, edited, entries, faults, get
from core.project import load
from core.study import Study, certificate_of, evaluations, extremes_of, findings_of
from core.study.stages import memory

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
NAMES = ("transfer_lift", "card_picker", "kim_1990", "four_bar_coupler_cam", "slider_crank")
DESIGNS = {name: load(EXAMPLES / f"{name}.toml") for name in NAMES}
CAM, LINKAGE = "cam", "linkage"
SECTIONS = {CAM: ("motion", "follower", "cam", "shaft", "loads"), LINKAGE: ("motion", "linkage", "cam", "loads")}
ALL = ("motion", "linkage", "cam", "dynamics", "stability")

STATED = ("kim_1990", "four_bar_coupler_cam")  # in which fields are tried that no example states
BLANK = (
    "thickness_mm", "bore_mm", "hub_mm", "keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg", "cutter_radius_mm", "material",
    "roller_material", "youngs_modulus_gpa", "poisson_ratio", "roller_youngs_modulus_gpa", "roller_poisson_ratio",
    "roller_load_rating_n",
)  # fmt: skip

# path, or the beginning of it: the stages that depend on what stands there; the longest that fits counts
DEPENDS: dict[str, dict[str, tuple[str, ...]]] = {
    CAM: {
        "name": (),
        "motion": ALL,
        "follower": ("linkage", "cam", "dynamics", "stability"),
        "cam": ("linkage", "cam", "dynamics", "stability"),  # a radius moves the base position
        "cam.form": ("cam", "dynamics", "stability"),
        **{f"cam.{name}": () for name in BLANK},
        "shaft": ("stability",),
        "shaft.rotation": ("cam", "dynamics", "stability"),
        "shaft.speed_rpm": ("dynamics", "stability"),
        "shaft.flywheel_inertia_kg_m2": (),
        "shaft.speed_fluctuation": (),
        "shaft.motor_slope_nm_s_per_rad": (),
        "shaft.motor_inertia_kg_m2": (),
        "shaft.gear_ratio": (),
        "loads": ("dynamics", "stability"),
        "loads.least_contact_force_n": (),
        "loads.restitution": (),
        "loads.follower_stiffness_n_per_mm": (),
        "loads.follower_damping_ratio": (),
    },
    LINKAGE: {
        "name": (),
        "motion": ALL,
        "linkage": ("linkage", "cam", "dynamics"),
        "linkage.driver.speed_rpm": ("dynamics",),
        "cam": ("cam", "dynamics"),  # the linkage has its size by itself
        "cam.form": ("cam", "dynamics"),
        **{f"cam.{name}": () for name in BLANK},
        "loads": ("dynamics",),
        "loads.follower_stiffness_n_per_mm": (),
        "loads.follower_damping_ratio": (),
    },
}


def kind(design: Design) -> str:
    return LINKAGE if design.drive.is_linkage else CAM


def stages(design: Design) -> tuple[str, ...]:
    """Those that this design has something to compute for."""
    rigid = design.shaft is not None and design.shaft.elastic is None
    return tuple(stage for stage in Study(design).stages if not (rigid and stage == "stability"))


def other_value(entry: Entry) -> object:
    """Another one that is allowed, None where there is no other."""
    info, value = entry.info, entry.value
    if info.choices:
        return next((choice for choice in info.choices if choice != value), None)
    if isinstance(value, int):  # the number of a link
        return None
    if value is None:
        return 12.0 if info.admits(12.0) else 0.25
    tried = [value * 1.001, value + 0.01, value - 0.01]
    return next(t for t in tried if t != value and info.admits(t))


def edits() -> list[Any]:
    """Example, path, and the design with another value there; what a field alone cannot change is left out."""
    found = []
    for name, design in DESIGNS.items():
        for section in SECTIONS[kind(design)]:
            for entry in entries(design, section):
                value = other_value(entry)
                if value is None or (entry.value is None and name not in STATED):
                    continue
                changed = edited(design, entry.path, value)
                if faults(changed):
                    # a dwell neither rises nor turns, a law for rises keeps its sign, no crank has a motion, no cam an advance
                    assert entry.path.startswith(("motion.segments", "motion.advance", "linkage.driver.kind")), (
                        entry.path
                    )
                    continue
                found.append(pytest.param(design, changed, entry.path, id=f"{name}: {entry.path}"))
    return found


def needed(design: Design, path: str) -> tuple[str, ...]:
    rows = DEPENDS[kind(design)]
    row = rows[max((key for key in rows if path == key or path.startswith(f"{key}.")), key=len)]
    return tuple(stage for stage in stages(design) if stage in row)


def asked(design: Design) -> dict[str, int]:
    before = Counter(evaluations)
    study = Study(design, 72)
    for stage in study.stages:
        getattr(study, stage)
    return dict(Counter(evaluations) - before)


@pytest.mark.parametrize(("design", "changed", "path"), spread(list(edits()), 70))
def test_a_fields_edit_computes_its_stages_again_and_going_back_none(
    design: Design, changed: Design, path: str
) -> None:
    assert get(design, path) != get(changed, path)
    assert asked(design) == dict.fromkeys(stages(design), 1)
    # what changes no force element, such as the angle of a centre of mass that lies in its pivot, asks nothing
    assert asked(changed) in (
        dict.fromkeys(needed(design, path), 1),
        {} if path == "loads.arm_centre_angle_deg" else None,
    )
    assert asked(design) == {}, "back to the design from before"
    assert asked(changed) == {}, "and forth again"


def test_no_field_is_without_a_row_and_no_row_without_a_field() -> None:
    tried = {(parameter.values[0], parameter.values[2]) for parameter in edits()}
    for of in (CAM, LINKAGE):
        designs = [design for design in DESIGNS.values() if kind(design) == of]
        there = {e.path: e.value for design in designs for s in SECTIONS[of] for e in entries(design, s)}
        for key in DEPENDS[of]:
            assert key == "name" or any(path == key or path.startswith(f"{key}.") for path in there), key
        numbers = {path for path, value in there.items() if not isinstance(value, int)}
        left_out = {
            path for path in numbers - {path for design, path in tried if design in designs} if "segments" not in path
        }
        assert left_out == {CAM: {"motion.advance_mm"}, LINKAGE: {"motion.advance_deg", "linkage.driver.kind"}}[of]
    paths = {path for _, path in tried}
    assert {
        "motion.segments[1].span_deg",
        "motion.segments[1].rise_mm",
        "motion.segments[1].crossover",
        "motion.start_mm",
    } <= paths


@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_another_name_computes_nothing(design: Design) -> None:
    """Nor do its findings and its certificate."""

    def all_of(design: Design) -> dict[str, int]:
        told = asked(design)
        study = Study(design, 72)
        _ = findings_of(study), certificate_of(study)
        return told

    all_of(design)
    before = Counter(evaluations)
    all_of(edited(design, "name", "Another"))
    assert Counter(evaluations) - before == {}


LOADS = {
    "transfer_lift": "loads.arm_mass_kg",
    "kim_1990": "loads.preload_n",
    "four_bar_coupler_cam": "loads.forces[0].y_n",
}


@pytest.mark.parametrize("name", LOADS)
def test_other_loads_leave_the_extremes_of_what_moves_as_they_are(name: str) -> None:
    design = DESIGNS[name]
    heavier = edited(design, LOADS[name], get(design, LOADS[name]) * 1.01)
    for stage in ("motion", "linkage", "cam"):
        _ = extremes_of(Study(design, 72), stage), findings_of(Study(design, 72), (stage,))
        before = Counter(evaluations)
        _ = extremes_of(Study(heavier, 72), stage), findings_of(Study(heavier, 72), (stage,))
        assert Counter(evaluations) - before == {}, stage


UNIT_LOADS = {
    "shaft.speed_rpm": 0,
    "loads.arm_mass_kg": 0,
    "loads.external_force_n": 0,
    "loads.friction": 0,  # its coefficient; which pairs rub stays the same
    "follower.rod_mm": 1,
    "cam.base_radius_mm": 1,
    "motion.start_mm": 1,
}


@pytest.mark.parametrize("path", UNIT_LOADS)
def test_reactions_to_unit_loads_are_computed_again_where_positions_change(path: str) -> None:
    design = DESIGNS["transfer_lift"]
    _ = Study(design, 72).dynamics
    changed = edited(design, path, get(design, path) * 1.003 + 0.001)
    before = memory.computed["unit loads"]
    again = Study(changed, 72).dynamics
    assert memory.computed["unit loads"] - before == UNIT_LOADS[path]
    there = Study(changed, 72)
    fresh = there.at_theta(there.theta).dynamics  # nothing of it is cached
    assert (again.contact.tobytes(), again.torque.tobytes()) == (fresh.contact.tobytes(), fresh.torque.tobytes())
