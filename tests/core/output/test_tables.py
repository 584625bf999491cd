"""core.output.channels, core.output.export, core.output.summary: the tables, column by column, against values derived from the geometry."""

import csv
import gc
import io
import json
import math
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from counting import peak
from mechanisms import LAYOUT_DESIGNS, LIFT, PUSHER, levels, with_drive, with_follower, with_loads, with_shaft
from references import MP, Solved, cam_shape, free_bodies, sense_of, solved, speed_of
from sampled import spread, stressed

from core.design import FOLLOWER_KINDS, UNITS, Design, kind_of
from core.errors import KindynaError, NoSuchStage
from core.findings import ERROR
from core.output.channels import channel, channels
from core.output.export import csv as table_text
from core.output.export import export, files
from core.project import load
from core.study import QUANTITIES, Study, extremes_of, names_of

# As the contract names them, in its order; further columns may follow.
PROFILE = ["cam_angle_deg", "x_mm", "y_mm", "pitch_x_mm", "pitch_y_mm", "pressure_angle_deg", "pitch_curvature_per_mm",
           "radius_mm", "polar_angle_deg"]  # fmt: skip
KINEMATICS = ["cam_angle_deg", "displacement_mm", "velocity_mm_s", "acceleration_mm_s2", "jerk_mm_s3"]
SLIDER = ["slider_position_mm", "phi_deg", "phi_rad_s", "phi_rad_s2", "beta_deg", "beta_rad_s", "beta_rad_s2"]
DYNAMICS = ["cam_angle_deg", "contact_force_n", "drive_torque_nm", "motor_torque_nm", "guide_force_n"]
SLIDER_FORCES = ["slider_pin_x_n", "slider_pin_y_n", "arm_pin_x_n", "arm_pin_y_n", "pivot_x_n", "pivot_y_n"]
BEARING = ["bearing_x_n", "bearing_y_n"]
TABLES = {
    "cam-slider": {"profile.csv": PROFILE, "kinematics.csv": [*KINEMATICS, *SLIDER],
                   "dynamics.csv": [*DYNAMICS, *SLIDER_FORCES, *BEARING]},
    "translating": {"profile.csv": PROFILE, "kinematics.csv": KINEMATICS, "dynamics.csv": [*DYNAMICS, *BEARING]},
}  # fmt: skip
EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
ROCKER = load(EXAMPLES / "rocker_cam.toml")
FINGER, TRAIN = (load(EXAMPLES / f"{name}.toml") for name in ("finger_follower", "pushrod_train"))
OF_KIND = {"cam-slider": LIFT, "translating": PUSHER, "oscillating": ROCKER, "rocker": FINGER, "pushrod": TRAIN}
SINGULAR = {
    "cam-slider": {"dead-centre", "rod-across-guide"},
    "rocker": {"pad-in-line"},
    "pushrod": {"pad-in-line", "pushrod-in-line"},
}
DESIGNS = {"lift": LIFT, "pusher": PUSHER, "c": LAYOUT_DESIGNS["c"], "g": LAYOUT_DESIGNS["g"]}


def tables(design: Design, samples: int = 36, stages: tuple[str, ...] = ()) -> dict[str, tuple[list[str], np.ndarray]]:
    """Read as any program reads them: names and numbers (rows, columns)."""
    told = {}
    for name, text in files(Study(design, samples), stages).items():
        if name.endswith(".csv"):
            head, *rows = list(csv.reader(io.StringIO(text, newline="")))
            told[name] = (head, np.array([[float(x) for x in row] for row in rows]))
    return told


# -- the rows of the table --------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", FOLLOWER_KINDS)
def test_every_channel_says_what_it_is_in_which_unit_and_where_it_comes_from(kind: str) -> None:
    rows = channels(OF_KIND[kind])
    assert len({row.slug for row in rows}) == len(rows)
    for row in rows:
        assert row.equation.strip(), row.slug
        assert row.source.strip(), row.slug
        assert row.label.strip(), row.slug
        assert row.symbol.strip(), row.slug
        assert row.name not in QUANTITIES or kind in QUANTITIES[row.name].kinds
        assert row.slug in ("jam_factor", "rocker_ratio") or row.unit.symbol, "a unit, told by the column's name"
        assert "{" not in row.slug
        assert channel(OF_KIND[kind], row.slug) is row


@pytest.mark.parametrize("kind", FOLLOWER_KINDS)
def test_every_quantity_of_a_kind_can_be_tabled_but_the_singularities(kind: str) -> None:
    told = {row.name for row in channels(OF_KIND[kind])}
    assert set(names_of(OF_KIND[kind])) - told - {"profile_radius"} == SINGULAR.get(kind, set())


def test_an_unknown_channel_is_told_with_those_there_are() -> None:
    with pytest.raises(KeyError, match="no such channel; allowed: displacement_mm"):
        channel(PUSHER, "phi_deg")


# -- the files --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", spread(DESIGNS, 3))
@pytest.mark.parametrize("samples", [4, 7])
def test_tables_have_the_contracts_columns_and_one_row_for_each_cam_angle(name: str, samples: int) -> None:
    kind = kind_of(DESIGNS[name].drive.mechanism)
    told = tables(DESIGNS[name], samples)
    assert list(told) == ["profile.csv", "kinematics.csv", "dynamics.csv"]
    for table, (head, rows) in told.items():
        wanted = TABLES[kind][table]
        assert head[: len(wanted)] == wanted
        assert rows.shape == (samples, len(head))
        assert rows[:, 0].tolist() == [float(Fraction(360 * i, samples)) for i in range(samples)]
        assert len(set(head)) == len(head)


@pytest.mark.parametrize("name", spread(DESIGNS, 2))
def test_a_quantity_that_does_not_exist_is_an_absent_column(name: str) -> None:
    names = {column for head, _ in tables(DESIGNS[name], 4).values() for column in head}
    has_slider = kind_of(DESIGNS[name].drive.mechanism) == "cam-slider"
    assert ("phi_deg" in names) == has_slider
    assert ("pivot_x_n" in names) == has_slider
    assert ("slider_torque_nm" in names) == has_slider


def test_the_text_is_plain_and_reads_back_to_the_last_bit() -> None:
    study = Study(LIFT, 36)
    for name, text in files(study).items():
        assert text.isascii() or name == "summary.json"
        assert text.endswith("\n")
        assert "\r" not in text
        assert "-0.0," not in text
        assert "-0.0\n" not in text
        assert "nan" not in text
        assert "inf" not in text.lower().replace("infinite", "")
    for name, (head, rows) in tables(LIFT).items():
        for i, column in enumerate(head[1:], start=1):
            values = channel(LIFT, column).values(study)
            assert rows[:, i].tolist() == values.tolist(), (name, column)


def test_a_large_table_is_made_in_blocks_that_fit_together(tmp_path: Path) -> None:
    samples, every = 66_000, 4125
    export(Study(LIFT, samples), tmp_path, ["motion", "linkage", "cam"])
    picked = Study(LIFT).at_theta(np.deg2rad(np.arange(0, samples, every) * 360.0 / samples))
    for name in ("profile.csv", "kinematics.csv"):
        lines = (tmp_path / name).read_text("utf-8").splitlines()
        assert len(lines) == samples + 1
        for slug, texts in zip(
            lines[0].split(",")[1:], zip(*(line.split(",")[1:] for line in lines[1::every]), strict=True), strict=True
        ):
            there = [float(text) for text in texts]
            wanted = channel(LIFT, slug).values(picked)
            assert there == pytest.approx(wanted, rel=1e-12, abs=1e-12 * np.abs(wanted).max()), slug
    assert json.loads((tmp_path / "summary.json").read_text("utf-8"))


@pytest.mark.stress
@pytest.mark.parametrize("name", ["transfer_lift", stressed("transfer_unit")])
def test_twice_as_many_angles_hold_no_more_memory(name: str, tmp_path: Path) -> None:
    design = load(EXAMPLES / f"{name}.toml")

    def run(samples: int) -> None:
        export(Study(design, samples), tmp_path, ["dynamics"])

    run(66_000)  # what is kept for the next question is kept from now on
    gc.collect()  # what comes now stays: during a test, as beside the window, nothing is searched for
    few, many = (peak(partial(run, samples)) for samples in (66_000, 132_000))
    assert many < 1.3 * few


def test_what_is_not_finite_is_refused_with_its_column() -> None:
    with pytest.raises(KindynaError, match=r"force_n: not finite at cam_angle_deg 90"):
        table_text(["cam_angle_deg", "x", "force_n"], [np.array([0.0, 90.0]), np.zeros(2), np.array([1.0, np.inf])])


def test_a_smaller_question_writes_only_its_tables() -> None:
    assert set(files(Study(LIFT, 8), ("motion",))) == {"kinematics.csv", "summary.json"}
    head, _ = tables(LIFT, 8, ("motion",))["kinematics.csv"]
    assert head == KINEMATICS
    head, _ = tables(LIFT, 8, ("motion", "linkage"))["kinematics.csv"]
    assert head == [*KINEMATICS, *SLIDER]
    assert set(tables(LIFT, 8, ("cam",))) == {"profile.csv"}
    assert set(tables(LIFT, 8, ("dynamics", "cam"))) == {"profile.csv", "dynamics.csv"}
    assert set(tables(PUSHER, 8, ("linkage",))) == set()
    assert set(files(Study(LIFT, 8), ("stability",))) == {"summary.json"}, "a rigid shaft has no tongues"
    with pytest.raises(NoSuchStage):
        files(Study(LIFT, 8), ("strength",))


# -- the values -------------------------------------------------------------------------------------------

GRAD = 180 / MP.pi


def _exact(design: Design, here: Solved, way: int) -> dict[str, Any]:
    """Every column of the contract from the geometry, in its own unit; what the motor gives without a flywheel."""
    w = speed_of(design)
    y, shape, forces = here.y, cam_shape(design, here), free_bodies(design, here, way)
    profile, pitch = shape.profile * 1000, shape.pitch.c[0] * 1000
    told = {
        "x_mm": MP.re(profile), "y_mm": MP.im(profile), "pitch_x_mm": MP.re(pitch), "pitch_y_mm": MP.im(pitch),
        "pressure_angle_deg": shape.pressure_angle * GRAD, "pitch_curvature_per_mm": shape.curvature.c[0] / 1000,
        "radius_mm": abs(profile), "polar_angle_deg": (MP.arg(profile) * GRAD) % 360,
        "profile_curvature_per_mm": shape.profile_curvature / 1000,
        "displacement_mm": y.c[0] * 1000, "velocity_mm_s": y.derivative(1) * w * 1000,
        "acceleration_mm_s2": y.derivative(2) * w**2 * 1000, "jerk_mm_s3": y.derivative(3) * w**3 * 1000,
        "contact_force_n": forces["contact"], "drive_torque_nm": forces["torque"], "motor_torque_nm": forces["torque"],
        "speed_rpm": design.shaft.speed_rpm,
        "guide_force_n": forces["normal"], "bearing_x_n": MP.re(forces["bearing"]), "bearing_y_n": MP.im(forces["bearing"]),
        "bearing_n": abs(forces["bearing"]),
    }  # fmt: skip
    friction = design.drive.loads.friction
    guide = here.guide * (1j * forces["normal"] - MP.convert(friction) * abs(forces["normal"]) * way)
    told |= {
        "guide_x_n": MP.re(guide),
        "guide_y_n": MP.im(guide),
        "guide_n": abs(guide),
        "guide_direction_deg": MP.arg(guide) * GRAD,
    }
    told["bearing_direction_deg"] = MP.arg(forces["bearing"]) * GRAD
    d, at = sense_of(design), here.roller.c[0]
    if "phi" in here.angles:  # the arm turns about its pivot, the cam about its own centre: where both move alike
        pivot, rate = here.points["pivot"].c[0], here.angles["phi"].derivative(1)
        centre, along, v_r = pivot * rate / (rate - d), abs(pivot) * rate / (rate - d), -d * rate * w * abs(at - pivot)
    else:
        centre, along, v_r = -1j * d * y.derivative(1) * here.guide, y.derivative(1), y.derivative(1) * w
    told |= {
        "instant_centre_mm": along * 1000,
        "instant_centre_x_mm": MP.re(centre) * 1000,
        "instant_centre_y_mm": MP.im(centre) * 1000,
        "instant_centre_velocity_mm_s": along * w * 1000,
        "roller_centre_velocity_mm_s": v_r * 1000,
    }
    if "phi" in here.angles:
        for name in ("phi", "beta"):
            angle = here.angles[name]
            told |= {
                f"{name}_deg": angle.c[0] * GRAD,
                f"{name}_rad_s": angle.derivative(1) * w,
                f"{name}_rad_s2": angle.derivative(2) * w**2,
            }
        told["slider_position_mm"] = here.angles["slider_position"].c[0] * 1000
        told["slider_torque_nm"] = forces["follower_torque"]
        told["jam_factor"] = friction * abs(MP.tan(here.angles["beta"].c[0]))
        for name in ("slider_pin", "arm_pin", "pivot"):
            told |= {
                f"{name}_x_n": MP.re(forces[name]),
                f"{name}_y_n": MP.im(forces[name]),
                f"{name}_n": abs(forces[name]),
                f"{name}_direction_deg": MP.arg(forces[name]) * GRAD,
            }
    else:
        told["jam_factor"] = friction * MP.tan(shape.pressure_angle)
    return told


@pytest.mark.parametrize("name", spread(DESIGNS, 2))
def test_every_column_holds_what_its_name_says(name: str) -> None:
    """In its own unit, to 1e-11 of the column's largest value: rates by time, forces by the body that the contract
    names, angles 0 ... 360 or modulo 360."""
    design = DESIGNS[name]
    study = Study(design, 36)
    seen = set()
    read = tables(design)
    for i in (1, 7, 13, 20, 31):
        exact = _exact(design, solved(design, MP.mpf(study.theta[i])), int(study.motion.velocity_sign[i]))
        for head, rows in read.values():
            for column, values in zip(head[1:], rows.T[1:], strict=True):
                if column.endswith(("_j", "_w", "_couple_nm")):
                    continue  # energies, powers and couples are held against each other in test_force_elements
                error = float(abs(MP.mpf(values[i]) - exact[column]))
                if column in ("phi_deg", "beta_deg", "polar_angle_deg") or column.endswith("_direction_deg"):
                    error = abs(math.remainder(error, 360.0))
                assert error <= 1e-11 * max(np.abs(values).max(), float(abs(exact[column]))), column
                seen.add(column)
    assert seen == set(exact), "every column has a value of its own to be held against"


def test_the_polar_angle_goes_once_round() -> None:
    for design in (LIFT, PUSHER, with_shaft(PUSHER, rotation="cw")):
        head, rows = tables(design, 3600)["profile.csv"]
        angle = rows[:, head.index("polar_angle_deg")]
        assert angle.min() >= 0.0
        assert angle.max() < 360.0
        steps = np.diff(np.concatenate((angle, angle[:1])))
        # the profile is run through against the cam's sense, but for one step across 0
        assert np.count_nonzero(np.abs(steps) > 180.0) == 1


def test_a_jump_is_tabled_by_its_right_hand_limit() -> None:
    motion = levels(
        0.0,
        (90.0, 0.0, "dwell"),
        (90.0, 20.0, "constant-velocity"),
        (90.0, 20.0, "dwell"),
        (90.0, 0.0, "constant-velocity"),
    )
    head, rows = tables(with_drive(PUSHER, motion=motion), 4)["kinematics.csv"]
    speed = 20.0 / (math.pi / 2) * (300.0 * math.pi / 30)
    assert rows[:, head.index("velocity_mm_s")] == pytest.approx([0.0, speed, 0.0, -speed], rel=1e-14)
    assert rows[:, head.index("displacement_mm")] == pytest.approx([0.0, 0.0, 20.0, 20.0], abs=1e-13)
    harmonic = levels(0.0, (180.0, 20.0, "simple-harmonic"), (90.0, 20.0, "dwell"), (90.0, 0.0, "3-4-5"))
    head, rows = tables(with_drive(PUSHER, motion=harmonic), 4)["kinematics.csv"]
    assert rows[0, head.index("acceleration_mm_s2")] == pytest.approx(20.0 / 2 * (300.0 * math.pi / 30) ** 2, rel=1e-13)
    assert rows[2, head.index("acceleration_mm_s2")] == 0.0


def test_the_motor_torque_with_a_flywheel_is_another_column_of_the_same_mean() -> None:
    head, rows = tables(with_shaft(LIFT, flywheel_inertia_kg_m2=1000.0), 720)["dynamics.csv"]
    torque, motor = (rows[:, head.index(name)] for name in ("drive_torque_nm", "motor_torque_nm"))
    assert np.ptp(motor) < 0.9 * np.ptp(torque)
    assert motor.mean() == pytest.approx(torque.mean(), abs=1e-3 * np.ptp(torque))
    without_head, without = tables(LIFT, 720)["dynamics.csv"]
    assert without[:, without_head.index("motor_torque_nm")].tolist() == torque.tolist()


# -- the summary ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", spread(DESIGNS, 2))
def test_the_summary_has_the_contracts_entries(name: str) -> None:
    design = DESIGNS[name]
    study = Study(design, 36)
    told = json.loads(files(study)["summary.json"])
    assert told["name"] == design.name
    assert told["kind"] == "cam"
    if name == "pusher":
        assert set(told["base"]) == {"follower_mm"}
        assert told["base"]["follower_mm"] == pytest.approx(math.sqrt(57.0**2 - 7.0**2), rel=1e-14)
    else:
        base = solved(design, 0.0).base
        for key in ("phi", "alpha", "beta"):
            assert math.remainder(told["base"][f"{key}_deg"] - float(base[key] * GRAD), 360.0) == pytest.approx(
                0.0, abs=1e-11
            )
        assert told["base"]["slider_mm"] == pytest.approx(float(base["slider"]) * 1e3, rel=1e-13)
    slugs = {row.slug for row in channels(design) if not row.slug.endswith("_direction_deg")}  # which goes round
    slugs -= {"polar_angle_deg", "linear_motor_torque_nm"}  # no flywheel, no linear answer
    assert set(told["extremes"]) == slugs
    for slug, sides in told["extremes"].items():
        row = channel(study.design, slug)
        stage = extremes_of(study, row.stage)[row.name]
        for side, extreme in (("min", stage.low), ("max", stage.high)):
            assert sides[side]["value"] == pytest.approx(extreme.value / row.unit.factor, rel=1e-15)
            assert sides[side]["cam_angle_deg"] == pytest.approx(math.degrees(extreme.theta), rel=1e-15)
        assert sides["min"]["value"] <= sides["max"]["value"]
    for proof in told["certificate"].values():
        assert proof["value"] <= proof["bound"]
    assert set(told["certificate"]) >= {
        "loop_closure",
        "roller_tangency",
        "instant_centre",
        "power_balance",
        "momentum_balance",
    }


def test_findings_stand_in_the_summary_with_all_that_a_program_needs() -> None:
    design = with_loads(with_follower(PUSHER, offset_mm=0.0), friction=3.5)
    told = json.loads(files(Study(design, 36))["summary.json"])
    codes = [f["code"] for f in told["findings"]]
    assert "jamming" in codes
    for finding in told["findings"]:
        assert set(finding) >= {"code", "severity", "field", "cam_angle_deg", "values", "message"}
    assert told["findings"][0]["severity"] == ERROR, "the gravest first"
    assert {"pressure_angle_deg", "velocity_mm_s"} <= set(told["extremes"])
    assert not {"contact_force_n", "motor_torque_nm", "speed_rpm"} & set(told["extremes"]), "there are no forces"
    assert set(tables(design)) == {"profile.csv", "kinematics.csv"}
    assert told["flywheel"] == {}


def test_the_joins_stand_in_the_summary_with_their_jumps() -> None:
    told = json.loads(files(Study(LIFT, 8), ("motion",))["summary.json"])["joins"]
    assert [j["cam_angle_deg"] for j in told] == pytest.approx([35.0, 76.5, 283.5, 325.0, 0.0], rel=1e-15)
    assert all(j["s"] == j["v"] == j["a"] == 0.0 for j in told)
    jerk = 16 * math.pi**3 / (4 + math.pi) * 150.0 / math.radians(41.5) ** 3
    assert [j["j"] for j in told] == pytest.approx([-jerk, jerk, jerk, -jerk, 0.0], rel=1e-12)


def test_units_of_columns_are_those_of_their_endings() -> None:
    factors = {"mm": 1e-3, "deg": math.pi / 180, "rpm": math.pi / 30, "n_per_mm": 1e3, "n_s_per_mm": 1e3, "mm_s": 1e-3, "mm_s2": 1e-3,
               "mm_s3": 1e-3, "deg_s": math.pi / 180, "deg_s2": math.pi / 180, "deg_s3": math.pi / 180, "per_mm": 1e3,
               "mpa": 1e6, "mpa_m_s": 1e6, "gpa": 1e9, "mm_min": 1e-3 / 60.0, "mm_per_turn": 1e-3, "mm_per_deg": 0.18 / math.pi,
               "mm_per_deg2": 32.4 / math.pi**2}  # fmt: skip
    for slug, unit in UNITS.items():
        assert unit.factor == factors.get(slug, 1.0), slug


# -- zeros by construction --------------------------------------------------------------------------------

QUARTERS, HALVES = (90.0, 270.0), (0.0, 180.0)


@pytest.mark.parametrize(("name", "table", "columns", "at"), spread([
    ("four_bar", "linkage.csv", ("A_x_mm", "A_vy_mm_s", "A_ax_mm_s2"), QUARTERS),
    ("four_bar", "linkage.csv", ("A_y_mm", "A_vx_mm_s", "A_ay_mm_s2"), HALVES),
    ("slider_crank", "linkage.csv", ("link3_deg", "link4_slide_mm_s", "B_vx_mm_s"), HALVES),
    ("slider_crank", "dynamics.csv", ("link4_guide_x_n", "link4_couple_nm"), ()),
    ("card_picker", "profile.csv", ("x_mm", "pitch_x_mm", "pressure_angle_deg"), (0.0,)),
    ("kim_1990", "kinematics.csv", ("velocity_mm_s", "jerk_mm_s3"), (0.0, 90.0)),
    ("kim_1990", "dynamics.csv", ("drive_torque_nm", "guide_force_n", "bearing_x_n"), (0.0, 90.0)),
], 3))  # fmt: skip
def test_what_is_zero_by_construction_is_exported_as_zero(
    name: str, table: str, columns: tuple[str, ...], at: tuple[float, ...]
) -> None:
    """Cranks at quarter turns, guides straight up or along x, cosines where they begin: no 6.49e-15 for the reader to ask
    about. Everywhere where no angles are named."""
    design = load(Path(__file__).parents[3] / "resources" / "examples" / f"{name}.toml")
    head, rows = tables(design, 360, ("motion", "linkage", "cam", "dynamics") if design.drive.cam else ())[table]
    for column in columns:
        values = rows[:, head.index(column)]
        assert not (values[np.isin(rows[:, 0], at)] if at else values).any(), column
        assert at == () or values.any(), f"{column} moves"


@pytest.mark.parametrize("name", ["transfer_lift", "card_picker", "kim_1990", "rocker_cam", "four_bar_coupler_cam"])
def test_in_a_dwell_nothing_moves_and_no_torque_is_asked_for(name: str) -> None:
    design = load(Path(__file__).parents[3] / "resources" / "examples" / f"{name}.toml")
    told, rests = tables(design, 360, ("motion", "dynamics")), Study(design, 360).motion.velocity_sign == 0.0
    assert rests.any()
    head, rows = told["kinematics.csv"]
    assert not rows[rests][:, [head.index(c) for c in head if c.startswith(("velocity", "acceleration", "jerk"))]].any()
    head, rows = told["dynamics.csv"]
    assert not rows[rests, head.index("drive_torque_nm")].any()
    assert np.abs(rows[:, head.index("contact_force_n")]).max() > 0.0
