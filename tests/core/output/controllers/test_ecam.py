"""The command ``ecam``: its files read by a reader of the test's own, and their errors found by brute force."""

import json
from random import Random

import numpy as np
import pytest
from controller_reader import CUBIC, LAWS, LINES, QUINTIC, brute, exact_motion, example, path, rows_of
from sampled import spread, stressed

from core.__main__ import main
from core.output.controllers.placing import RowPlacer
from core.process import user_folder
from core.project import load
from core.study import Study


def exported(tmp_path, capsys, name, *options):
    """The certificate as JSON, and the file's text."""
    design = name if str(name).endswith(".toml") else str(example(name))
    out = tmp_path / "table.out"
    code = main(["ecam", str(design), "--out", str(out), "--json", *options])
    printed = capsys.readouterr()
    assert code == 0, printed.err
    return json.loads(printed.out), out.read_bytes().decode()


def of_a_knife():
    """What a design holds beside its motion."""
    text = example("tappet_knife").read_text("utf-8")
    return text[text.index("[follower]") :]


@pytest.mark.parametrize(
    ("name", "slug", "options", "kind", "most"),
    spread(
        [
            ("transfer_lift", "codesys-xyva", (), QUINTIC, 14),
            ("card_picker", "codesys-xyva", (), QUINTIC, 11),
            ("transfer_lift", "general", ("--interpolation", CUBIC), CUBIC, 34),
            ("card_picker", "general", ("--interpolation", CUBIC), CUBIC, 17),
            ("transfer_lift", "sew-tab", (), LINES, 496 * 1.01),
            ("card_picker", "codesys-xy", (), LINES, 125),
            ("card_picker", "schneider-asc", (), "clamped-spline", 90),
            ("card_picker", "beckhoff-zebra", ("--error", "0.02"), "zebra", 60),
            ("transfer_lift", "beckhoff-ascii", ("--error", "0.01"), LINES, 1000),
        ],
        3,
    ),
)
def test_few_rows_keep_the_error_and_the_certificate_is_the_true_one(tmp_path, capsys, name, slug, options, kind, most):
    facts, text = exported(tmp_path, capsys, name, "--controller", slug, *options)
    wanted = float(options[1]) if "--error" in options else 1e-3
    assert facts["certified"] is True
    assert facts["rows"] <= most
    assert facts["deviation_mm"] <= wanted
    found = brute(slug, kind, text, exact_motion(name))
    stated = [facts["deviation_mm"], facts["velocity_deviation"], facts["acceleration_deviation"]]
    for value, certificate in zip(found, stated, strict=True):
        if certificate is not None:
            assert 0.95 * certificate <= value <= certificate * (1.0 + 1e-6) + 1e-11


@pytest.mark.parametrize(
    ("name", "kind", "steps"),
    [("transfer_lift", QUINTIC, 147), ("card_picker", QUINTIC, 39), ("card_picker", CUBIC, 58)],
)
def test_equal_steps_are_the_fewest_that_keep_the_error(tmp_path, capsys, name, kind, steps):
    facts, text = exported(tmp_path, capsys, name, "--controller", "general", "--interpolation", kind, "--as", "equal")
    assert facts["rows"] == steps + 1
    x = rows_of("general", text, 360.0)["x"]
    assert np.abs(np.diff(x) - 1.0 / steps).max() < 1e-12
    assert brute("general", kind, text, exact_motion(name))[0] <= 1e-3
    facts, _ = exported(
        tmp_path,
        capsys,
        name,
        "--controller",
        "general",
        "--interpolation",
        kind,
        "--as",
        "equal",
        "--points",
        str(steps),
    )
    assert facts["deviation_mm"] > 1e-3


def test_counts_scale_offset_shift_and_reverse_belong_to_the_certificate(tmp_path, capsys):
    options = ("--controller", "codesys-xyva", "--master", "counts", "--master-per-turn", "4096", "--slave-scale", "-250",
               "--slave-offset", "12.5", "--shift", "77", "--reverse", "--error", "0.002")  # fmt: skip
    facts, text = exported(tmp_path, capsys, "card_picker", *options)
    found = brute("codesys-xyva", QUINTIC, text, exact_motion("card_picker", 77.0, True), 4096.0, -250.0, 12.5)
    assert found[0] <= facts["deviation_mm"] * (1.0 + 1e-6) <= 0.002
    assert found[0] >= 0.95 * facts["deviation_mm"]
    assert "xEnd := 4096.0" in text


def test_the_rounding_of_integers_belongs_to_the_error(tmp_path, capsys):
    options = ("--controller", "technosoft", "--master", "counts", "--master-per-turn", "4096", "--slave-scale", "100")
    facts, text = exported(tmp_path, capsys, "card_picker", *options, "--error", "0.02")
    found = brute("technosoft", LINES, text, exact_motion("card_picker"), 4096.0, 100.0)
    assert 0.95 * facts["deviation_mm"] <= found[0] <= facts["deviation_mm"] * (1.0 + 1e-6) <= 0.02
    assert facts["rows"] - 1 in [4096 // step for step in (1, 2, 4, 8, 16, 32, 64, 128)]
    code = main(["ecam", str(example("card_picker")), "--out", str(tmp_path / "no"), *options, "--error", "0.004"])
    says = capsys.readouterr().err
    assert code == 2
    assert (
        "the least error of the position is 0.004965 mm, at 307.27 deg, limited by the digits of its numbers: choose a larger"
        in says
    )
    assert not (tmp_path / "no").exists()


@pytest.mark.parametrize("wanted", [stressed("1e-15"), "2e-13"])
def test_the_search_ends_where_errors_are_noise(tmp_path, capsys, monkeypatch, wanted):
    """Below the rounding of doubles no number of rows is better than another: few are tried."""
    design, tried, steps_root = tmp_path / "there_and_back.toml", [], RowPlacer.steps_root
    rows = ("modified-sine", 120.0, 30.0), ("dwell", 60.0, None), ("cycloidal", 180.0, -30.0)
    segments = "".join(
        f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = {span}\n' + ("" if rise is None else f"rise_mm = {rise}\n")
        for law, span, rise in rows
    )
    design.write_text(f'format = 1\nname = "there and back"\n[motion]\nstart_mm = 12.5\n{segments}', "utf-8")
    monkeypatch.setattr(RowPlacer, "steps_root", lambda self, steps: tried.append(steps) or steps_root(self, steps))
    words = "--controller", "schneider-asc", "--error", wanted
    assert main(["ecam", str(design), "--out", str(tmp_path / "table.asc"), *words]) == 2
    assert "the least error of the position is 2." in capsys.readouterr().err
    assert len(tried) <= 16


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--controller", "sew-tab", "--error", "1e-5"), "cannot keep it; the least error of the position is 0.0002351 mm, at"),
        (("--controller", "sew-tab", "--error", "1e-15"), "limited by its 1024 rows; allowed: at least 0.0002351 mm"),
        (("--controller", "codesys-xyva", "--master-per-turn", "0"), "allowed: > 0"),
        (("--controller", "codesys-xyva", "--master", "counts"), "needs --master-per-turn, the counts in a turn"),
        (("--controller", "technosoft", "--slave-scale", "1e9"), "integers of 32 bits"),
        (("--controller", "technosoft", "--master", "counts", "--master-per-turn", "1.5", "--slave-scale", "1e5"), "no whole number of"),
        (("--controller", "general"), "--interpolation is required; allowed: linear | cubic-hermite"),
        (("--controller", "sew-tab", "--interpolation", "zebra"), "sew-tab does not support it; allowed: linear | unknown"),
        (("--controller", "kollmorgen-csv", "--error", "1"), "not certified: how this controller interpolates is not published"),
        (("--controller", "codesys-x", "--as", "placed"), "requires equal steps"),
        (("--controller", "sew-tab", "--acceleration-error", "1"), "straight lines have no acceleration"),
        (("--controller", "codesys-xyva", "--of", "torque"), "no position of that name; allowed: motion | displacement_mm"),
        (("--controller", "codesys-xyva", "--points", "3"), "the joins of this motion need"),
        (("--controller", "codesys-xyva", "--slave-scale", "0"), "all rows would be equal"),
        (("--controller", "inventor",), "the slave must not end where it starts"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_one_line_and_writes_nothing(tmp_path, capsys, options, says):
    out = tmp_path / "table.txt"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", "400")
        code = main(["ecam", str(example("transfer_lift")), "--out", str(out), *options])
    error = capsys.readouterr().err
    assert code == 2
    assert says in error
    assert not out.exists()


def test_a_master_too_coarse_for_its_rows_is_refused(tmp_path, capsys):
    rows = user_folder("settings") / "controllers.toml"
    rows.parent.mkdir(parents=True)
    rows.write_text(
        '[[controllers]]\nslug = "counts"\nlabel = "Counts"\ninterpolation = ["linear"]\ncolumns = ["master", "slave"]\n'
        'row = "{master}{sep}{slave}"\ninteger = true\n',
        "utf-8",
    )
    out = tmp_path / "t.txt"
    options = ["--controller", "counts", "--points", "100", "--master", "counts", "--master-per-turn"]
    assert main(["ecam", str(example("transfer_lift")), "--out", str(out), *options, "60"]) == 2
    said = capsys.readouterr().err
    assert "--master-per-turn 60: too coarse, the master would not rise from row to row; choose a larger one" in said
    assert not out.exists()
    facts, text = exported(tmp_path, capsys, "transfer_lift", *options, "4000", "--slave-scale", "1000")
    assert facts["rows"] == len(text.split()) // 2 == 100


def test_unknown_interpolations_have_no_number(tmp_path, capsys):
    facts, _ = exported(tmp_path, capsys, "card_picker", "--controller", "kollmorgen-csv", "--points", "50")
    assert facts["certified"] is False
    assert facts["rows"] == 50
    assert facts["deviation_mm"] is facts["velocity_deviation"] is facts["acceleration_deviation"] is None
    assert facts["reason"] == "not certified: how this controller interpolates is not published"


def test_a_jump_is_told_by_two_rows_a_hair_apart_or_named_with_its_bound(tmp_path, capsys):
    design = tmp_path / "parabolic.toml"
    design.write_text(
        'format = 1\nname = "Jumps"\n[motion]\nstart_mm = 0.0\n'
        + "".join(
            f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = {span}\nrise_mm = {rise}\n'
            for law, span, rise in (("parabolic", 100.0, 20.0), ("simple-harmonic", 120.0, -20.0))
        )
        + '[[motion.segments]]\nlaw = "dwell"\nspan_deg = 140.0\n'
        + of_a_knife(),
        "utf-8",
    )
    facts, text = exported(tmp_path, capsys, str(design), "--controller", "codesys-xyva")
    x = rows_of("codesys-xyva", text, 360.0)["x"] * 360.0
    assert {round(j["at_deg"], 9) for j in facts["jumps"]} == {0.0, 50.0, 100.0, 220.0}
    assert all(j["of"] == "acceleration" and j["rows"] == 2 for j in facts["jumps"])
    assert np.abs(x[:, None] - [49.9995, 50.0005, 99.9995, 100.0005]).min(axis=0).max() < 1e-9
    assert facts["rows"] <= 14
    found = brute("codesys-xyva", QUINTIC, text, exact_motion(str(design)))
    assert 0.95 * facts["deviation_mm"] <= found[0] <= facts["deviation_mm"] * (1.0 + 1e-6) <= 1e-3
    facts, text = exported(
        tmp_path, capsys, str(design), "--controller", "general", "--interpolation", QUINTIC, "--as", "equal"
    )
    found = brute("general", QUINTIC, text, exact_motion(str(design)))
    assert 0.95 * facts["deviation_mm"] <= found[0] <= facts["deviation_mm"] * (1.0 + 1e-6) <= 1e-3
    assert [j["rows"] for j in facts["jumps"]] == [2, 1, 1, 1]
    assert all(j["bound_mm"] > 0.0 for j in facts["jumps"][1:])


def test_four_drives_of_a_shaft_have_one_master(tmp_path, capsys):
    out = tmp_path / "t.st"
    assert main(["ecam", str(example("transfer_unit")), "--out", str(out), "--controller", "codesys-xyva"]) == 2
    assert "choose one with --drive" in capsys.readouterr().err
    assert not out.exists()
    design = load(example("transfer_unit"))
    for drive in design.drives:
        facts, text = exported(
            tmp_path, capsys, "transfer_unit", "--controller", "codesys-xyva", "--drive", drive.name, *(
                () if drive.motion is not None else ("--of", "link4_deg"))
        )  # fmt: skip
        rows = rows_of("codesys-xyva", text, 360.0)
        assert facts["certified"]
        assert rows["x"][0] == 0.0
        assert rows["x"][-1] == 1.0
        if drive.motion is not None:
            study = Study(load(example("transfer_unit"))).drives[drive.name]
            u = rows["x"][1:-1]
            own = np.mod(2.0 * np.pi * (u - drive.phase_deg / 360.0), 2.0 * np.pi)
            y = study.at_theta(own).motion.y[0] / drive.motion.scale
            assert np.abs(y - rows["y"][1:-1]).max() <= 1e-9


def test_a_link_is_a_slave_too(tmp_path, capsys):
    facts, text = exported(
        tmp_path, capsys, "four_bar", "--controller", "codesys-xyva", "--of", "link4_deg", "--error", "0.01"
    )
    assert facts["deviation_deg"] <= 0.01
    study, rows = Study(load(example("four_bar"))), rows_of("codesys-xyva", text, 360.0)
    y = np.rad2deg(study.at_theta(2.0 * np.pi * rows["x"][:-1]).linkage.coordinates["link4"][0])
    assert np.abs(y - rows["y"][:-1]).max() <= 1e-9


def test_cycles_of_the_controller(tmp_path, capsys):
    """Against the path sampled at many phases: a cycle of 4 ms at the lift's 20 rpm is 0.48°."""
    facts, _text = exported(tmp_path, capsys, "transfer_lift", "--controller", "codesys-xyva", "--cycle", "4")
    found, h = facts["cycle"], 0.48 / 360.0
    exact = exact_motion("transfer_lift")
    x = np.arange(0.0, 1.0, 1.0 / 90000.0)[:, None]
    p = [exact(x + k * h)[0] for k in range(4)]
    step = np.abs(p[3] - 3.0 * p[2] + 3.0 * p[1] - p[0]).max() / 0.004**2 / 1e3
    assert found["acceleration_step"] == pytest.approx(step, rel=0.02)
    bend = np.abs(exact(x)[2]).max() / 360.0**2
    assert found["dominates_above_rpm"] == pytest.approx(
        np.sqrt(8.0 * facts["deviation_mm"] / bend) / (6.0 * 0.004), rel=1e-3
    )
    assert facts["at_speed"]["velocity_deviation_mm_s"] == pytest.approx(facts["velocity_deviation"] * 120.0)
    assert facts["at_speed"]["acceleration_deviation_m_s2"] == pytest.approx(
        facts["acceleration_deviation"] * 120.0**2 / 1e3
    )


def test_the_error_curve_is_that_of_tables_with_so_many_rows(tmp_path, capsys):
    curve = tmp_path / "curve.csv"
    facts, _ = exported(tmp_path, capsys, "transfer_lift", "--controller", "codesys-xyva", "--curve", str(curve))
    table = np.genfromtxt(curve, delimiter=",", names=True)
    assert table.dtype.names == ("rows", "deviation", "velocity_deviation", "acceleration_deviation")
    assert table["rows"][-1] == 5000
    assert 50 <= table.size <= 60
    at = int(np.searchsorted(table["rows"], facts["rows"]))
    for i in (1, at, at + 4):
        made, _ = exported(
            tmp_path, capsys, "transfer_lift", "--controller", "codesys-xyva", "--points", str(int(table["rows"][i]))
        )
        assert made["deviation_mm"] == pytest.approx(table["deviation"][i], rel=0.15)


CASES = (
    ("codesys-xyva", QUINTIC), ("twincat-points", QUINTIC), ("codesys-xy", LINES), ("codesys-x", LINES), ("beckhoff-ascii", LINES),
    ("codesys-cambuilder", QUINTIC), ("twincat-table", LINES),
    ("beckhoff-zebra", "zebra"), ("sew-tab", LINES), ("sew-semicolon", LINES), ("lenze-loader", LINES),
    ("schneider-asc", "clamped-spline"), ("general", CUBIC), ("general", QUINTIC),
)  # fmt: skip


def random_motion(rng: Random) -> str:
    """A design of a motion only: rises, returns and dwells of any laws, jumps among them."""
    count = rng.choice((1, 2, 2, 3))
    rises = [round(rng.uniform(1.0, 80.0), rng.choice((0, 3))) for _ in range(count)]
    spans = np.array([rng.uniform(8.0, 60.0) for _ in range(3 * count)])
    spans = np.round(spans / spans.sum() * 360.0, rng.choice((0, 2, 9)))
    spans[-1] = 360.0 - spans[:-1].sum()
    rows = []
    for rise in rises:
        rows += [(rng.choice(LAWS), rise), (rng.choice(LAWS), -rise), ("dwell", 0.0)]
    text = f'format = 1\nname = "Random"\n[motion]\nstart_mm = {round(rng.uniform(-50.0, 50.0), 3)}\n'
    for (law, rise), span in zip(rows, spans.tolist(), strict=True):
        text += f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = {span!r}\n' + (f"rise_mm = {rise}\n" if rise else "")
    return text + of_a_knife()


def check_random(tmp_path, capsys, seed, slug, kind):
    rng = Random(f"{seed} {slug} {kind}")
    design = tmp_path / f"random{seed}.toml"
    design.write_text(random_motion(rng), "utf-8")
    options = ["--controller", slug] + (["--interpolation", kind] if slug == "general" else [])
    options += rng.choice((["--error", "0.05"], ["--error", "0.5"], ["--points", "200"]))
    facts, text = exported(tmp_path, capsys, str(design), *options)
    found = brute(slug, kind, text, exact_motion(str(design)))
    stated = [facts["deviation_mm"], facts["velocity_deviation"], facts["acceleration_deviation"]]
    if "--error" in options:
        assert facts["deviation_mm"] <= float(options[-1])
    for value, certificate in zip(found, stated, strict=True):
        if certificate is not None:
            assert value <= certificate * (1.0 + 1e-6) + 1e-9, (seed, slug, kind)
            assert value >= 0.95 * certificate - 1e-9, (seed, slug, kind)


@pytest.mark.parametrize(("slug", "kind"), spread(CASES, 2))
def test_of_random_motions_the_certificate_is_the_true_error(tmp_path, capsys, slug, kind):
    for seed in range(3):
        check_random(tmp_path, capsys, seed, slug, kind)


@pytest.mark.fuzz
@pytest.mark.parametrize(("slug", "kind"), CASES)
def test_of_300_random_motions_the_certificate_is_the_true_error(tmp_path, capsys, slug, kind):
    for seed in range(3, 303):
        check_random(tmp_path, capsys, seed, slug, kind)


@pytest.mark.parametrize(
    ("slug", "options", "law"),
    spread(
        [
            ("codesys-xyva", (), "polynomial"),
            ("codesys-xyva", ("--master", "rad"), "polynomial"),
            ("twincat-points", (), "polynomial"),
            ("beckhoff-zebra", ("--error", "0.02"), "polynomial"),
            ("sew-tab", ("--points", "80"), "table"),
            ("codesys-x", ("--points", "80"), "table"),
            ("beckhoff-ascii", ("--points", "80"), "table"),
            ("schneider-asc", ("--points", "80"), "table"),
            ("technosoft", ("--points", "91", "--slave-scale", "1"), "table"),
        ],
        3,
    ),
)
def test_what_is_written_is_read_again_as_a_motion(tmp_path, capsys, slug, options, law):
    """The motion read runs as the controller runs the file; through values alone it runs through these."""
    facts, text = exported(tmp_path, capsys, "card_picker", "--controller", slug, *options)
    design = tmp_path / "read.toml"
    design.write_bytes(example("card_picker").read_bytes())
    assert main(["measured", str(tmp_path / "table.out"), "--controller", slug, "--into", str(design), "--json"]) == 0
    read = json.loads(capsys.readouterr().out)
    assert {each["law"] for each in read["segments"]} == {law}
    assert read["rows"] == facts["rows"]
    rows, values = rows_of(slug, text, 2.0 * np.pi if "rad" in options else 360.0), exact_motion(str(design))
    if law == "polynomial":
        u, made = path("zebra" if slug == "beckhoff-zebra" else QUINTIC, rows, 9)
        assert np.abs(values(u) - made)[0].max() <= 1e-10
        assert np.abs(values(u) - made)[1].max() <= 1e-7
    assert np.abs(values(rows["x"][None, :-1])[0, 0] - rows["y"][:-1]).max() <= 1e-9
