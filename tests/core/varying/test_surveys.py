"""core.varying.surveys: the designs between bounds, what is asked of each, and what is asked where nobody says."""

from dataclasses import replace

import numpy as np
import pytest
from linkages import geared

from core.design import Tolerance, edited, get, only, put
from core.design.limits import Waviness
from core.errors import KindynaError
from core.project import load
from core.shaft import first_balancer
from core.study import Study, extremes_of, many, quantity
from core.varying import (
    READY,
    Question,
    Scatter,
    Span,
    StudyFile,
    StudyLimit,
    StudyQuantity,
    VariedField,
    can_be_varied,
    current_figures,
    default_span,
    drive_bands,
    file_of_question,
    motor_bands,
    question_of_file,
    ready_study,
    refined_survey,
    request_keys,
    shaft_bands,
    study_of,
    suggested_figures,
    survey,
    tolerance_result,
    with_values,
)
from kindyna_gui.places import example

PRESSURE, TORQUE = "pressure_angle_deg:abs", "drive_torque_nm:abs"
TURNED = "transmission_C_deg:min"
X, Y, BASE = "follower.pivot_x_mm", "follower.pivot_y_mm", "cam.base_radius_mm"


@pytest.fixture
def lift():  # type: ignore[no-untyped-def]
    return load(example("transfer_lift"))


def test_a_map_has_the_first_number_along_its_rows_and_each_design_has_its_own_values(lift) -> None:  # type: ignore[no-untyped-def]
    spans = [Span(X, 300.0, 1600.0), Span(Y, -600.0, 600.0)]
    found = survey(lift, spans, [PRESSURE, TORQUE], 6)
    assert found.points.shape == (2, 36)
    x, y = (row.reshape(6, 6) for row in found.points)
    assert x[0] == pytest.approx(np.linspace(300.0, 1600.0, 6))
    assert y[:, 0] == pytest.approx(np.linspace(-600.0, 600.0, 6))
    assert {"", "no-assembly"} <= set(found.reason), "some of these pivots are out of reach"
    at = found.nearest((830.0, -130.0))
    assert found.points[:, at] == pytest.approx([820.0, -120.0])
    design = edited(edited(lift, X, 820.0), Y, -120.0)
    worst = extremes_of(Study(design), "cam", ("pressure_angle",))["pressure_angle"]
    exact = np.degrees(max(abs(worst.low.value), abs(worst.high.value)))
    assert found.value[PRESSURE][at] == pytest.approx(exact, rel=2e-3)
    values, reason = current_figures(Study(design), [PRESSURE, TORQUE])
    assert values[PRESSURE] == pytest.approx(exact, rel=1e-9)
    assert values[TORQUE] == pytest.approx(many(lift, {X: [820.0], Y: [-120.0]}, [TORQUE]).value[TORQUE][0], rel=1e-9)
    assert reason == ""


def test_more_than_two_numbers_fill_their_box_evenly_and_the_same_way_each_time(lift) -> None:  # type: ignore[no-untyped-def]
    spans = [Span(X, 800.0, 900.0), Span(Y, -100.0, 0.0), Span(BASE, 380.0, 420.0)]
    one, other = (survey(lift, spans, [PRESSURE], 8) for _ in range(2))
    assert one.points.shape == (3, 64)
    assert np.array_equal(one.points, other.points)
    for row, span in zip(one.points, spans, strict=True):
        assert span.low <= row.min() < row.max() <= span.high
        assert np.histogram(row, 8, (span.low, span.high))[0].tolist() == [8] * 8


def test_usual_bounds_keep_to_the_range_and_what_cannot_be_is_refused(lift) -> None:  # type: ignore[no-untyped-def]
    assert default_span(lift, BASE) == Span(BASE, 320.0, 480.0)
    around = default_span(lift, Y)
    assert (around.low, around.high) == (-130.0, 0.0), "a coordinate goes by the size of the machine"
    friction = default_span(edited(lift, "loads.friction", 0.0), "loads.friction")
    assert 0.0 <= friction.low < friction.high <= 1.0
    for wrong, path, says in (
        ([Span(BASE, 420.0, 380.0)], BASE, "bounds are reversed"),
        ([Span(BASE, -5.0, 380.0)], BASE, "outside the range"),
        ([Span("cam.form", 0.0, 1.0)], "cam.form", "only a number"),
    ):
        with pytest.raises(ValueError, match=says) as error:
            survey(lift, wrong, [PRESSURE], 4)
        assert str(error.value).startswith(path)


def test_what_is_asked_first_suits_the_design_and_its_drives(lift) -> None:  # type: ignore[no-untyped-def]
    assert suggested_figures(Study(lift), X) == {
        PRESSURE: (None, 45.0),
        TORQUE: (None, None),
        "contact_force_n:abs": (None, None),
    }
    stated = edited(lift, "limits.pressure_angle_rise_deg", 25.0)
    assert suggested_figures(Study(stated), X)[PRESSURE] == (None, 25.0)
    unit = load(example("transfer_unit"))
    keys = suggested_figures(Study(unit), "drives[1].cam.base_radius_mm")
    assert all(key.startswith("drives[1].") or key == "torque_nm:abs" for key in keys)
    assert "torque_nm:abs" in keys
    for design in (lift, unit, load(example("four_bar"))):
        key = next(iter(suggested_figures(Study(design), "")))
        assert key.partition(":")[0] in set(request_keys(design))
    assert key == "transmission_B_deg:min", "nothing loads this linkage"


def test_values_put_into_a_motion_take_from_what_is_not_varied(lift) -> None:  # type: ignore[no-untyped-def]
    spans = {"motion.segments[1].span_deg": 50.0, "motion.segments[3].span_deg": 45.0}
    made = with_values(lift, spans)
    assert [get(made, path) for path in spans] == [50.0, 45.0]
    assert sum(segment.span_deg for segment in made.drive.motion.segments) == pytest.approx(360.0, abs=1e-12)


def test_other_spans_make_up_for_varied_ones_in_proportion_but_fixed_ones() -> None:
    """Of what is neither varied nor fixed a tenth goes to the rise, 31.85 of 318.5 deg; of the two that are left a quarter."""
    lift = load(example("transfer_lift"))
    path = "motion.segments[1].span_deg"
    made = with_values(lift, {path: 41.5 + 31.85})
    assert [s.span_deg for s in made.drive.motion.segments] == [31.5, 73.35, 186.3, 37.35, 31.5]
    fixed = edited(edited(lift, "motion.segments[0].fixed", True), "motion.segments[3].fixed", True)
    made = with_values(fixed, {path: 41.5 + 242.0 / 4.0})
    assert [s.span_deg for s in made.drive.motion.segments] == [35.0, 102.0, 155.25, 41.5, 26.25]
    unit = load(example("transfer_unit"))
    at = {f"drives[{i}].motion.segments[0].span_deg": 50.0 for i in (0, 1)} | {"drives[1].phase_deg": 240.0}
    made = with_values(unit, at | {"shaft.speed_rpm": 22.0})
    assert [get(made, path) for path in at] == [50.0, 50.0, 240.0]
    assert [sum(s.span_deg for s in drive.motion.segments) for drive in made.drives] == [360.0] * 4
    assert made.shaft.speed_rpm == 22.0


def with_tolerances(design, **widths):  # type: ignore[no-untyped-def]
    paths = {"x": X, "y": Y, "base": BASE}
    return replace(design, tolerances=tuple(Tolerance(paths[name], width) for name, width in widths.items()))


def test_the_share_of_machines_within_limits_and_which_tolerance_counts_most(lift) -> None:  # type: ignore[no-untyped-def]
    values, _ = current_figures(Study(lift), [PRESSURE])
    at = edited(lift, X, 950.0)  # where the pressure angle grows with the pivot
    nominal = current_figures(Study(at), [PRESSURE])[0][PRESSURE]
    found = tolerance_result(with_tolerances(at, x=0.5, y=0.01), {PRESSURE: (None, nominal), TORQUE: (None, None)})
    assert found.share is not None
    assert abs(found.share.value - 0.5) < 4.0 * 0.5 / found.share.machines**0.5
    (corner,) = found.corners
    assert corner.at[X] == 950.5
    assert not corner.within
    assert list(found.parts) == [PRESSURE, TORQUE]
    assert list(found.parts[PRESSURE]) == [X, Y], "the largest part first"
    ahead = current_figures(Study(edited(at, X, 950.01)), [PRESSURE])[0][PRESSURE]
    slope, part = found.parts[PRESSURE][X]
    assert slope == pytest.approx((ahead - nominal) / 0.01, rel=1e-3)
    assert 0.99 < part < 1.0
    assert found.tighter is None, "no halving brings the middle off the limit"
    wide = tolerance_result(with_tolerances(lift, x=0.05, y=0.05), {PRESSURE: (None, values[PRESSURE] + 1.0)})
    assert wide.share is not None
    assert wide.share.value == 1.0
    assert wide.corners[0].within
    assert tolerance_result(with_tolerances(lift, x=0.05), {PRESSURE: (None, None)}).share is None, "nothing is limited"
    waved = tolerance_result(
        replace(lift, waviness=Waviness(0.02, 10, 40)), {"contact_force_n:max": (None, 45_800.0)}, machines=200
    )
    assert waved.share is not None
    assert 0.0 < waved.share.value < 1.0
    assert waved.tighter is None, "waves have no tolerance to tighten"
    with pytest.raises(KindynaError):
        tolerance_result(lift, {PRESSURE: (None, 30.0)})


def test_bands_of_machines_at_once_are_those_of_each_by_itself(lift) -> None:  # type: ignore[no-untyped-def]
    made = with_tolerances(lift, x=0.5, base=1.0)
    scatter = Scatter(study_of(StudyFile(design="", quantities=(StudyQuantity("contact_force_n", "max"),)), made))
    bands = scatter.bands(40, 3, samples=24)["contact_force_n"]
    curves = []
    for values in zip(*scatter.machines(40, 3).values(), strict=True):
        study = Study(with_values(lift, dict(zip(scatter.nominal, values, strict=True))))
        curves.append(quantity("contact_force").value(study.at(study.program.angles(np.deg2rad(np.arange(24) * 15.0)))))
    assert bands == pytest.approx(np.percentile(curves, [0.135, 5, 50, 95, 99.865], axis=0), rel=1e-12)


def test_a_question_is_the_same_after_its_file(lift) -> None:  # type: ignore[no-untyped-def]
    asked = Question(
        (Span(X, 800.0, 900.0),),
        {"motion.segments[1].law": ("cycloidal", "modified-sine")},
        {PRESSURE: (None, 30.0), TORQUE: (None, None), "energy_j": (1.0, 2.0)},
        {TORQUE: True, PRESSURE: False},
        0.99,
        seed=7,
    )
    assert question_of_file(file_of_question(asked)) == asked
    stepped = (
        VariedField(X, 800.0, 900.0, steps=5),
        VariedField(BASE, values=(400.0, 380.0, 410.0)),
        VariedField(Y, -80.0, -50.0, points=64),
    )
    opened = question_of_file(StudyFile(design="", vary=stepped))
    assert [(span.low, span.high) for span in opened.spans] == [(800.0, 900.0), (380.0, 410.0), (-80.0, -50.0)]
    assert file_of_question(opened).vary == stepped, "steps, points and lists are kept"
    wider = replace(opened, spans=(Span(X, 800.0, 950.0), *opened.spans[1:]))
    assert file_of_question(wider).vary == (VariedField(X, 800.0, 950.0), *stepped[1:]), "other bounds take their place"


def test_studies_are_ready_for_each_kind_of_design(lift) -> None:  # type: ignore[no-untyped-def]
    made = {name: ready_study(lift, name) for name in READY}
    assert [name for name, file in made.items() if file is None] == ["least-pressure"], "no width of the face is known"
    assert {row.field for row in made["smallest-cam"].vary} == {BASE, X}
    assert [(row.key, row.max) for row in made["smallest-cam"].limits] == [
        ("pressure_angle_deg:max", 45.0),
        ("profile_curvature_per_mm:max", 1.0 / 75.0),
    ]
    lengths = {row.field: (row.low, row.high) for row in made["all-lengths"].vary}
    assert lengths[Y] == (-78.0, -52.0)
    assert len(lengths) == 9
    assert [row.field for row in made["quietest-law"].vary] == ["motion.segments[1].law", "motion.segments[3].law"]
    unit = load(example("transfer_unit"))
    of_third = ready_study(unit, "smallest-cam", 2)
    assert {row.field for row in of_third.vary} == {f"drives[2].{BASE}", f"drives[2].{X}"}
    assert study_of(of_third, unit).quantities[0].key == "drives[2].drive_torque_nm:abs"
    assert ready_study(load(example("four_bar")), "least-torque") is not None


def test_a_map_is_finer_where_a_limit_runs_and_at_the_edge_of_what_can_be_built(lift) -> None:  # type: ignore[no-untyped-def]
    spans = [Span(X, 700.0, 1300.0), Span(Y, -300.0, 300.0)]
    plain = survey(lift, spans, [PRESSURE], 12)
    found = refined_survey(lift, plain, {PRESSURE: (None, 30.0)})
    assert 0 < found.finer.shape[1] < 0.5 * 45 * 45, "not everywhere"
    z = found.grid(np.where(found.reason == "", found.value[PRESSURE], np.nan), fine=True)
    x, y = found.axes(fine=True)
    assert z.shape == (45, 45)
    assert z[::4, ::4] == pytest.approx(
        plain.grid(np.where(plain.reason == "", plain.value[PRESSURE], np.nan)), nan_ok=True
    )
    below = z[:, :-1] < 30.0
    crossed = np.argwhere(np.isfinite(z[:, :-1]) & np.isfinite(z[:, 1:]) & (below != (z[:, 1:] < 30.0)))
    assert len(crossed) > 40
    paths = {X: x[[i for _, i in crossed]], Y: y[[j for j, _ in crossed]]}
    exact = many(lift, paths, [PRESSURE], polish=False).value[PRESSURE]
    assert z[tuple(crossed.T)] == pytest.approx(exact, rel=1e-9), "next to the limit each value is a design's own"
    edge = np.argwhere(np.isfinite(z[:, :-1]) & ~np.isfinite(z[:, 1:]))
    there = many(lift, {X: x[edge[:, 1]], Y: y[edge[:, 0]]}, [PRESSURE], polish=False).reason
    beyond = many(lift, {X: x[edge[:, 1] + 1], Y: y[edge[:, 0]]}, [PRESSURE], polish=False).reason
    assert (there == "").all()
    assert (beyond != "").all(), "the edge of what can be built is that of the finer cells"


def test_bands_of_a_shaft_are_those_of_its_machines_one_by_one() -> None:
    unit = load(example("transfer_unit"))
    path = f"drives[2].{BASE}"
    made = replace(
        unit,
        tolerances=(
            Tolerance(path, 3.0, distribution="worst"),
            Tolerance("drives[0].phase_deg", 2.0, distribution="worst"),
        ),
    )
    found = shaft_bands(made, samples=24, machines=12)
    theta = np.deg2rad(np.arange(24) * 15.0)
    own, phase = get(unit, path), "drives[0].phase_deg"
    machines = [put(put(unit, path, own + more), phase, 328.0 + late) for more in (-3.0, 3.0) for late in (-2.0, 2.0)]
    ends = [Study(each).camshaft.at_theta(theta) for each in machines]
    for name in ("Feed", "Lift", ""):
        known = [shaft.torque if not name else shaft.drive_torque(name) for shaft in ends]
        assert found[name][2] == pytest.approx(
            np.clip(found[name][2], np.min(known, axis=0), np.max(known, axis=0)), abs=1e-9
        )
        spread = np.ptp(known, axis=0)
        assert (np.ptp(found[name], axis=0) > 0.9 * spread - 1e-9).all(), "twelve machines reach all four corners"
    assert np.ptp(found["Clamp"], axis=0) == pytest.approx(0.0), "of this drive nothing varies"
    assert shaft_bands(unit) == {}


@pytest.mark.stress
def test_each_cam_of_a_shaft_has_waves_of_its_own() -> None:
    """Those of a drive are those of the drive alone; the variances of independent waves add up."""
    unit = replace(load(example("transfer_unit")), waviness=Waviness(amplitude_mm=0.01, lobes_from=20, lobes_to=20))
    found = shaft_bands(unit, samples=360, machines=400)
    width = {name: found[name][3] - found[name][1] for name in found}
    for number, (name, place) in enumerate(Study(unit).camshaft.positions.items()):
        own = drive_bands(unit, number, ["drive_torque_nm"], quick=True)["drive_torque_nm"]
        angles = np.rad2deg(place.drive_angle(np.deg2rad(np.arange(360.0)))) % 360.0
        alone = np.interp(angles, np.arange(361.0), np.append(*((own[3] - own[1]), own[3, 0] - own[1, 0])))
        assert width[name] == pytest.approx(alone, abs=0.2 * alone.max())
        assert alone.max() > 0.1
    expected = np.sqrt(sum(width[name] ** 2 for name in found if name))
    assert width[""] == pytest.approx(expected, abs=0.2 * expected.max())
    of_all, one = StudyQuantity("torque_nm", "range"), StudyQuantity("drives[2].drive_torque_nm", "rms")
    scatter = Scatter(study_of(StudyFile(design="", quantities=(of_all, one)), unit))
    values = scatter.values(400, 1)
    low, high = found[""][0], found[""][-1]
    assert np.ptp(values[0]) > 0.1
    assert (values[0] < np.max(high) - np.min(low) + 0.02 * np.ptp(low)).all()
    alone = replace(only(unit, 2), waviness=unit.waviness)
    by_itself = Scatter(study_of(StudyFile(design="", quantities=(StudyQuantity("drive_torque_nm", "rms"),)), alone))
    assert values[1] == pytest.approx(by_itself.values(400, 3)[0], rel=1e-9), "the third drive draws its own waves"
    limit = StudyLimit("torque_nm", "abs", max=1.0)
    (corner,) = Scatter(study_of(StudyFile(design="", limits=(limit,)), unit)).corners(np.zeros((0, 1)))
    assert corner.value >= np.abs(found[""]).max() > np.abs(Study(unit).camshaft.torque).max()


def test_bands_of_the_motor_behind_the_flywheel_of_a_shaft() -> None:
    """With a tolerance at one of its ends all machines are one of two."""
    unit = load(example("transfer_unit"))
    path, theta = f"drives[2].{BASE}", np.deg2rad(np.arange(24) * 15.0)
    made = replace(unit, tolerances=(Tolerance(path, 10.0, distribution="worst"),))
    found = motor_bands(made, samples=24, machines=6)
    ends = [Study(put(unit, path, get(unit, path) + side)).camshaft.at_theta(theta) for side in (-10.0, 10.0)]
    for name, rows in (
        ("motor_torque", [shaft.motor_torque for shaft in ends]),
        ("camshaft_speed", [shaft.speed for shaft in ends]),
    ):
        wide = np.ptp(rows, axis=0).max()
        assert wide > 1e-6 * np.max(rows)
        assert found[name][0] == pytest.approx(np.min(rows, axis=0), abs=0.02 * wide)
        assert found[name][-1] == pytest.approx(np.max(rows, axis=0), abs=0.02 * wide)
    balanced = replace(unit, balancer=first_balancer(Study(unit).camshaft.flywheel.energy_swing))
    own = Study(balanced).camshaft.at_theta(theta).motor_torque
    assert np.abs(own - Study(unit).camshaft.at_theta(theta).motor_torque).max() > 1.0
    balanced = replace(balanced, tolerances=(Tolerance(path, 1e-6),))
    assert motor_bands(balanced, samples=24, machines=2)["motor_torque"][2] == pytest.approx(own, abs=1e-3)
    assert motor_bands(unit) == {}


def test_whole_numbers_are_varied_in_steps() -> None:
    design, teeth, side = (
        geared(kind="gear", teeth_first=18, teeth_second=12, module_mm=4.0),
        "linkage.drivers[0].teeth_second",
        "linkage.branch.C",
    )
    assert default_span(design, teeth) == Span(teeth, 7, 17)
    assert default_span(design, side) == Span(side, -1, 1)
    assert {teeth, side} < set(can_be_varied(design))
    assert not [path for path in can_be_varied(design) if path.endswith(("link", "number"))], "what names a link stays"
    found = survey(design, [Span(teeth, 11, 13)], [TURNED], 9)
    assert found.points[0].tolist() == [11, 11, 12, 12, 12, 12, 12, 13, 13]
    for count, value in zip(found.points[0], found.value[TURNED], strict=True):
        alone = edited(design, teeth, int(count))
        assert value == pytest.approx(current_figures(Study(alone), [TURNED])[0][TURNED], abs=1e-2)
    both = survey(design, [Span(side, -1, 1), Span(teeth, 12, 14)], [TURNED], 4)
    assert sorted(set(both.points[0])) == [-1.0, 1.0], "no side 0"
    assert (both.reason == "").all()
    made = with_values(design, {teeth: 13.4, side: -0.7, "linkage.drivers[0].offset_deg": 5.0})
    assert [get(made, path) for path in (teeth, side, "linkage.drivers[0].offset_deg")] == [13, -1, 5.0]
    with pytest.raises(ValueError, match="only a number"):
        default_span(design, "linkage.links[1].number")
