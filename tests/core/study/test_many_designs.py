"""Many designs at once against each of them by itself."""

from __future__ import annotations

import multiprocessing
import tracemalloc
from collections.abc import Mapping
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sampled import spread, stressed

from core.design import ELEMENT_LISTS, FOLLOWER_KINDS, Design, entries, get, put
from core.design.edits import with_face, with_form
from core.design.load_edits import load_lists, with_new_row
from core.errors import NoSolution
from core.output.channels import channels
from core.project import load
from core.study import Study, extremes_of, findings_of, many
from core.study.batch import is_batchable
from core.study.quantity_requests import quantity_request
from core.varying import with_values

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
EXAMPLE = {
    "cam-slider": "transfer_lift", "translating": "dwell_rise_dwell", "oscillating": "rocker_cam",
    "rocker": "finger_follower", "pushrod": "pushrod_train",
}  # fmt: skip
STAGES = ("motion", "linkage", "cam", "dynamics")
CASES = [
    *((kind, face, "open") for kind, row in FOLLOWER_KINDS.items() for face in row.faces),
    *((kind, "roller", form) for kind, row in FOLLOWER_KINDS.items() for form in row.forms if form != "open"),
]
ASKED = ("pressure_angle_deg:max", "contact_force_n:min", "drive_torque_nm:abs", "drive_torque_nm:rms")


def example(name: str) -> Design:
    return load(EXAMPLES / f"{name}.toml")


def varied(design: Design, count: int, by: float, seed: int) -> dict[str, np.ndarray]:
    """Every number of mechanism, cam, loads and shaft that is not 0, each within ± so many parts of it."""
    rng, found = np.random.default_rng(seed), {}
    for table in ("follower", "linkage", "cam", "loads", "shaft"):
        for entry in entries(design, table) if table in design.tables else ():
            if type(entry.value) is float and entry.value:
                found[entry.path] = entry.value * (1.0 + by * rng.uniform(-1.0, 1.0, count))
    return found


def one_of(design: Design, values: Mapping[str, np.ndarray], k: int) -> Design:
    return with_values(design, {path: float(row[k]) for path, row in values.items()})


@pytest.mark.parametrize(("kind", "face", "form"), spread(CASES, 2))
def test_every_quantity_of_every_follower_is_that_of_each_design(kind: str, face: str, form: str) -> None:
    """Whatever stands in the tables of followers, faces and forms is computed at once, and as one by one."""
    design = with_form(with_face(example(EXAMPLE[kind]), face), form)
    assert_as_one_by_one(design, varied(design, 3, 0.02, 7))


@pytest.mark.parametrize("kind", spread(EXAMPLE, 1))
def test_every_force_element_is_taken_with_its_numbers(kind: str) -> None:
    """Springs, friction in pairs and process forces, of which each number is varied."""
    design = example(EXAMPLE[kind])
    for name in load_lists(design.drive):
        if name in ELEMENT_LISTS:
            design = with_new_row(design, f"loads.{name}")
    values = varied(design, 3, 0.02, 11)
    assert_as_one_by_one(design, {path: row for path, row in values.items() if "].cam_" not in path})


@pytest.mark.parametrize(
    "name", [stressed("inverted_slider_crank"), stressed("lecture_six_bar"), "four_bar_coupler_cam", "rear_suspension"]
)
def test_every_quantity_of_linkages_of_dyads_is_that_of_each_design(name: str) -> None:
    """Cranks, those that cannot turn fully too, coupler cams, and a motion without a cam: reactions, points, angles of links."""
    design = example(name)
    values = varied(design, 3, 0.005, 7)
    keys = ("linkage.links[1].points.A.x_mm", "linkage.driver.speed_rpm")
    assert all(
        is_batchable(design, list(values), quantity_request(design, f"{row.slug}:max"))
        for row in channels(design, ("dynamics",))[:3]
    )
    assert set(keys) <= values.keys()
    assert_as_one_by_one(design, values)


def test_cranks_that_turn_fully_lock_or_turn_the_other_way_stand_side_by_side() -> None:
    """The second crank meets dead centres, the third linkage cannot be put together, the last crank turns clockwise."""
    design = example("four_bar")
    values = {
        "linkage.links[1].points.A.x_mm": [40.0, 120.0, 1000.0, 40.0],
        "linkage.driver.speed_rpm": [60.0, 60.0, 60.0, -60.0],
    }
    keys = ["B_n:max", "link4_deg:max", "link4_rad_s:min", "driver_torque_nm:abs"]
    found = many(design, values, keys)
    assert found.reason.tolist() == ["", "", "no-assembly", ""]
    for k in (0, 1, 3):
        study = Study(one_of(design, {path: np.array(row) for path, row in values.items()}, k))
        ends = {**extremes_of(study, "linkage"), **extremes_of(study, "dynamics")}
        torque = ends["driver_torque"]
        expected = [
            ends["force.B_size"].high.value, np.rad2deg(ends["link.4"].high.value), ends["link.4_velocity"].low.value,
            max(abs(torque.low.value), abs(torque.high.value)),
        ]  # fmt: skip
        assert [found.value[key][k] for key in keys] == pytest.approx(expected, rel=1e-6)
    assert np.isnan([found.value[key][2] for key in keys]).all()
    alone = many(design, {path: row[3:] for path, row in values.items()}, keys)
    assert all(alone.value[key][0] == found.value[key][3] for key in keys)


def assert_as_one_by_one(design: Design, values: Mapping[str, np.ndarray]) -> None:
    stages = tuple(stage for stage in STAGES if stage in Study(design).stages)
    rows = [row for row in channels(design, stages) if row.name in extremes_of(Study(design), row.stage)]
    found = many(design, values, [f"{row.slug}:{of}" for row in rows for of in ("min", "max")])
    for k in range(3):
        study = Study(one_of(design, values, k))
        expected = {name: each for stage in stages for name, each in extremes_of(study, stage).items()}
        errors = {each.code for stage in stages[-2:] for each in findings_of(study, (stage,))}
        assert bool(found.reason[k]) == any("undercut" in code or "jamming" in code for code in errors)
        for row in () if found.reason[k] else rows:
            name = row.name
            own = [found.value[f"{row.slug}:{of}"][k] * row.unit.factor for of in ("min", "max")]
            low, high = expected[name].low, expected[name].high
            size = max(abs(low.value), abs(high.value))
            near = 1e-4 if "curvature" in name else 1e-6
            assert own == pytest.approx([low.value, high.value], rel=1e-12, abs=near * size + 1e-15), name


def test_lengths_speeds_masses_and_friction_of_a_follower_are_taken_at_once() -> None:
    design = example("transfer_lift")
    paths = list(varied(design, 1, 0.0, 0))
    assert all(is_batchable(design, paths, quantity_request(design, key)) for key in ASKED)


@pytest.mark.parametrize("name", spread(["transfer_lift", "tappet_flat", "groove", "four_bar_coupler_cam"], 2))
def test_no_design_depends_on_the_others(name: str) -> None:
    """Shuffled, split, and by any executor: the same bits; of friction in pairs, of spans, and of linkages too."""
    design, rng = example(name), np.random.default_rng(3)
    linkage, count = name == "four_bar_coupler_cam", 300
    path = "cam.roller_radius_mm" if linkage else "cam.base_radius_mm"
    values = {path: rng.uniform(0.9, 1.6, count) * next(e.value for e in entries(design, "cam") if e.path == path)}
    values["linkage.driver.speed_rpm" if linkage else "shaft.speed_rpm"] = rng.uniform(50.0, 400.0, count)
    if name == "transfer_lift":
        design = with_new_row(with_new_row(put(design, "loads.friction", 0.1), "loads.pair_friction"), "loads.springs")
        values["loads.friction"] = rng.uniform(0.0, 0.3, count)
    if name == "tappet_flat":
        values["motion.segments[1].span_deg"] = rng.uniform(0.9, 1.1, count) * design.drive.motion.segments[1].span_deg
    keys = ASKED
    whole = many(design, values, keys)
    order = rng.permutation(count)
    shuffled = many(design, {path: row[order] for path, row in values.items()}, keys)
    last = many(design, {path: row[-1:] for path, row in values.items()}, keys)
    with ThreadPoolExecutor(2) as threads:
        threaded = many(design, values, keys, executor=threads)
    for key in keys:
        assert np.isfinite(whole.value[key]).any()
        assert whole.value[key][order].tobytes() == shuffled.value[key].tobytes()
        assert whole.angle_deg[key][order].tobytes() == shuffled.angle_deg[key].tobytes()
        assert whole.value[key][-1:].tobytes() == last.value[key].tobytes()
        assert whole.value[key].tobytes() == threaded.value[key].tobytes()


@pytest.mark.stress
def test_a_block_takes_little_memory() -> None:
    """At most 256 MiB, of the dearest followers and all that is asked."""
    design = put(example("transfer_lift"), "loads.friction", 0.05)
    radius = get(design, "cam.base_radius_mm")
    tracemalloc.start()
    many(
        design,
        {"cam.base_radius_mm": radius * np.linspace(0.9, 1.5, 900)},
        [*ASKED, "slider_torque_nm:max", "energy_j"],
    )
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 256 * 2**20


def test_nothing_of_a_batch_stays_in_memory() -> None:
    """Of four-bars whose pins in the frame stand elsewhere in each."""
    design, left = example("four_bar"), []
    tracemalloc.start()
    for _ in range(3):
        many(design, {"linkage.links[0].points.O4.x_mm": np.linspace(95.0, 105.0, 800)}, ["A_n:max"])
        left.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    assert left[2] - left[1] < 2**17


def test_another_process_gives_the_same_bits() -> None:
    design = example("dwell_rise_dwell")
    values = {"cam.base_radius_mm": np.linspace(30.0, 60.0, 50)}
    spawn: Executor = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
    with spawn:
        other = many(design, values, ASKED, executor=spawn)
    here = many(design, values, ASKED)
    assert all(here.value[key].tobytes() == other.value[key].tobytes() for key in ASKED)


def test_a_design_without_an_answer_leaves_the_others_theirs() -> None:
    design = example("dwell_rise_dwell")
    rows = {  # path -> what is typed in designs 1 ... 5 in place of the design's own
        "follower.offset_mm": {1: 100.0},
        "loads.friction": {2: 9.0},
        "cam.base_radius_mm": {3: 2.0, 4: -5.0},
        "cam.roller_radius_mm": {3: 50.0},
        "loads.gravity_angle_deg": {5: np.nan},
    }
    own = {entry.path: entry.value for table in ("follower", "loads", "cam") for entry in entries(design, table)}
    values = {path: np.array([given.get(k, own[path]) for k in range(6)]) for path, given in rows.items()}
    found = many(design, values, ASKED)
    single = many(design, {path: row[:1] for path, row in values.items()}, ASKED)
    assert all(found.value[key][0] == single.value[key][0] for key in ASKED)
    assert found.reason.tolist() == ["", "no-assembly", "jamming", "undercut", "out-of-range", "out-of-range"]
    assert np.isfinite(found.value["pressure_angle_deg:max"]).tolist() == [True, False, True, True, False, False]
    assert np.isfinite(found.value["drive_torque_nm:abs"]).tolist() == [True, False, False, True, False, False]
    with pytest.raises(NoSolution):
        _ = Study(one_of(design, values, 1)).cam
    assert "jamming" in {each.code for each in findings_of(Study(one_of(design, values, 2)), ("dynamics",))}
    assert "undercut" in {each.code for each in findings_of(Study(one_of(design, values, 3)), ("cam",))}


def test_without_polish_extremes_are_near_and_means_the_same() -> None:
    design = example("rocker_cam")
    values = varied(design, 20, 0.05, 1)
    fine, coarse = many(design, values, ASKED), many(design, values, ASKED, polish=False)
    for key in ASKED:
        assert coarse.value[key] == pytest.approx(fine.value[key], rel=1e-3)
    study = Study(one_of(design, values, 4))
    torque = study.at_theta(np.deg2rad(np.arange(0.005, 360.0, 0.01))).dynamics.torque
    assert fine.value["drive_torque_nm:rms"][4] == pytest.approx(np.sqrt(np.mean(torque**2)), rel=1e-4)


@pytest.mark.parametrize(
    ("values", "asked", "words"),
    [
        ({"cam.no_such_mm": [1.0]}, ["radius_mm:max"], "cam.no_such_mm: no such number"),
        ({"cam.base_radius_mm": [1.0]}, ["no_such:max"], "no_such:max: this design has no such column"),
        ({"cam.base_radius_mm": [1.0]}, ["radius_mm:largest"], "radius_mm:largest: allowed are"),
        ({"cam.base_radius_mm": [1.0, 2.0], "shaft.speed_rpm": [1.0]}, ["radius_mm:max"], "shaft.speed_rpm: 1 values"),
        ({"cam.base_radius_mm": []}, ["radius_mm:max"], "cam.base_radius_mm: a list of numbers"),
        ({"cam.base_radius_mm": ["wide"]}, ["radius_mm:max"], "cam.base_radius_mm: numbers are needed"),
        ({"shaft.rotation": [1.0]}, ["radius_mm:max"], "shaft.rotation: only a number"),
        ({"cam.base_radius_mm": [50.0]}, [], "quantities: give at least one"),
        ({}, ["radius_mm:max"], "values: no path"),
    ],
)
def test_what_cannot_be_asked_is_named_in_one_line(values: Any, asked: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words) as error:
        many(example("transfer_lift"), values, asked)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "name", ["transfer_lift", stressed("tappet_knife"), stressed("tappet_flat"), stressed("rocker_cam")]
)
def test_spans_and_rises_are_varied_as_they_are_typed(name: str) -> None:
    """Each with its own pieces; what a segment gains is taken from those that are not varied."""
    design, rng = example(name), np.random.default_rng(5)
    segments = [i for i, each in enumerate(design.drive.motion.segments) if each.rise > 0.0]
    unit = design.drive.motion.unit
    values = {
        f"motion.segments[{i}].span_deg": rng.uniform(0.9, 1.1, 3) * design.drive.motion.segments[i].span_deg
        for i in segments
    }
    path = f"motion.segments[{segments[0]}].rise_{unit}"
    values[path] = rng.uniform(0.9, 1.0, 3) * design.drive.motion.segments[segments[0]].rise
    values["shaft.speed_rpm"] = rng.uniform(60.0, 90.0, 3)
    assert all(is_batchable(design, list(values), quantity_request(design, key)) for key in ASKED)
    assert_as_one_by_one(design, values)
    found = many(design, values, ASKED)
    for k in range(3):
        own = many(one_of(design, values, k), {"shaft.speed_rpm": values["shaft.speed_rpm"][k : k + 1]}, ASKED)
        assert [found.value[key][k] for key in ASKED] == pytest.approx([own.value[key][0] for key in ASKED], rel=1e-6)
        assert [found.angle_deg[key][k] for key in ASKED[:2]] == pytest.approx(
            [own.angle_deg[key][0] for key in ASKED[:2]], abs=1e-3
        )


def test_spans_that_leave_nothing_have_a_reason_of_their_own() -> None:
    """Dwells make up for both strokes; none has anything left beyond 360 deg, and fixed ones make up for nothing."""
    design = example("transfer_lift")
    rise, back = (f"motion.segments[{i}].span_deg" for i in (1, 3))
    values = {rise: [50.0, 180.0, 200.0, 400.0], back: [60.0, 179.9, 200.0, 60.0]}
    keys = ["acceleration_mm_s2:max"]
    assert many(design, values, keys).reason.tolist() == ["", "", "spans", "out-of-range"]
    for i in (0, 2, 4):
        design = put(design, f"motion.segments[{i}].fixed", True)
    fixed = many(design, {rise: [41.5, 50.0, 40.0], back: [41.5, 50.0, 43.0]}, keys)
    assert fixed.reason.tolist() == ["", "spans", ""]
    assert np.isfinite(fixed.value[keys[0]]).tolist() == [True, False, True]


@pytest.mark.parametrize(
    ("name", "field", "numbers"),
    [("transfer_lift", "crossover", [0.35, 0.5, 0.6]), ("dwell_rise_dwell", "flat_fraction", [0.0, 0.1, 0.4])],
)
def test_numbers_of_a_law_are_varied_though_they_cut_it_elsewhere(name: str, field: str, numbers: list[float]) -> None:
    design = example(name)
    moving = next(i for i, each in enumerate(design.drive.motion.segments) if each.rise > 0.0)
    values = {f"motion.segments[{moving}].{field}": np.array(numbers)}
    keys = ["acceleration_mm_s2:max", "pressure_angle_deg:max"]
    found, last = many(design, values, keys), many(design, {path: row[2:] for path, row in values.items()}, keys)
    for k in range(3):
        study = Study(one_of(design, values, k))
        own = [
            extremes_of(study, "motion", ("acceleration",))["acceleration"].high.value * 1e3,
            np.rad2deg(extremes_of(study, "cam", ("pressure_angle",))["pressure_angle"].high.value),
        ]
        assert [found.value[key][k] for key in keys] == pytest.approx(own, rel=1e-6)
    assert [last.value[key][0] for key in keys] == [found.value[key][2] for key in keys]


@pytest.mark.parametrize("field", ["rise_mm", "crossover", "flat_fraction"])
def test_what_a_dwell_cannot_have_has_no_value(field: str) -> None:
    path = f"motion.segments[0].{field}"
    design = example("dwell_rise_dwell")
    found = many(design, {path: [get(design, path), 0.3]}, ["acceleration_mm_s2:max"])
    assert found.reason.tolist() == ["", "design-fault"]
    assert np.isfinite(found.value["acceleration_mm_s2:max"]).tolist() == [True, False]


def test_energy_stays_with_the_designs_that_have_a_cam() -> None:
    """The second lift of the groove has no cam, which is met where friction turns round: at a single angle of it."""
    design, path = example("groove"), "motion.segments[3].rise_mm"
    found = many(design, {path: [-40.0, 92.0]}, ["energy_j"])
    alone = many(design, {path: [-40.0]}, ["energy_j"])
    assert found.reason.tolist() == ["", "no-cam"]
    assert found.value["energy_j"][0] == alone.value["energy_j"][0] > 0.0
