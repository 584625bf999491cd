"""Tables of motions that do not come back, and errors that no table keeps: each file read by the test's own reader."""

import json
import re
from random import Random

import numpy as np
import pytest
from controller_reader import CUBIC, LAWS, LINES, QUINTIC, brute, exact_motion, path, rows_of
from feeds import FEED
from sampled import spread, stressed

from core.__main__ import main
from core.process import user_folder
from core.project import load

SPLINE = "clamped-spline"
RUNS = (
    ("codesys-xyva", QUINTIC), ("codesys-x", LINES), ("beckhoff-zebra", "zebra"), ("codesys-cambuilder", QUINTIC),
    ("beckhoff-ascii", LINES), ("codesys-xy", LINES), ("twincat-points", QUINTIC), ("twincat-table", LINES), ("sew-tab", LINES),
    ("sew-semicolon", LINES), ("lenze-loader", LINES), ("schneider-asc", SPLINE), ("technosoft", LINES), ("general", LINES),
    ("general", CUBIC), ("general", QUINTIC), ("general", SPLINE),
)  # fmt: skip
KINKED = """format = 1
name = "Kinked"
[motion]
start_mm = 3.0
segments = [
    { law = "constant-velocity", span_deg = 83.7, rise_mm = 20.0 },
    { law = "dwell", span_deg = 101.9 },
    { law = "modified-sine", span_deg = 174.4, rise_mm = -20.0 },
]
"""


def advancing(rng: Random) -> str:
    """Any laws and dwells, forwards and back, that end elsewhere."""
    count = rng.choice((2, 3, 4, 5))
    spans = np.array([rng.uniform(8.0, 60.0) for _ in range(count)])
    spans = np.round(spans / spans.sum() * 360.0, rng.choice((0, 2, 9)))
    spans[-1] = 360.0 - spans[:-1].sum()
    rises = [
        rng.choice((0.0, round(rng.uniform(-20.0, 60.0), 3), round(rng.uniform(5.0, 60.0), 3))) for _ in range(count)
    ]
    rises[0] = rises[0] or 12.5
    text = f'format = 1\nname = "Advancing"\n[motion]\nstart_mm = {round(rng.uniform(-50.0, 50.0), 3)}\nadvance_mm = {sum(rises)!r}\n'
    for span, rise in zip(spans.tolist(), rises, strict=True):
        law = rng.choice(LAWS) if rise else "dwell"
        text += f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = {span!r}\n' + (f"rise_mm = {rise!r}\n" if rise else "")
    return text


def ecam(tmp_path, capsys, design, *options):
    """Exit code, what is said, and the file's text."""
    out = tmp_path / "table.out"
    out.unlink(missing_ok=True)
    code = main(["ecam", str(design), "--out", str(out), "--json", *map(str, options)])
    printed = capsys.readouterr()
    return (
        code,
        json.loads(printed.out) if code == 0 else printed.err,
        out.read_bytes().decode() if out.exists() else "",
    )


def check(tmp_path, capsys, seed, slug, kind):
    rng = Random(f"{seed} {slug} {kind}")
    design = tmp_path / f"advancing{seed}.toml"
    design.write_text(advancing(rng), "utf-8")
    options = ["--controller", slug, *(["--interpolation", kind] if slug == "general" else [])]
    turn, scale, offset, shift, reverse = 360.0, 1.0, 0.0, rng.choice((0.0, 0.0, 77.0, -401.5)), rng.random() < 0.6
    if slug == "technosoft":
        turn, scale = 4096.0, 1e4
        options += ["--master", "counts", "--master-per-turn", "4096", "--slave-scale", "1e4"]
    elif rng.random() < 0.4:
        scale, offset = -2.5, 12.5
        options += ["--slave-scale", scale, "--slave-offset", offset]
    options += [*(["--reverse"] if reverse else []), *(["--shift", shift] if shift else [])]
    wanted = rng.choice((0.05, 0.5))
    limit = (
        ["--points", "200"]
        if slug == "beckhoff-zebra" or (slug != "technosoft" and rng.random() < 0.3)
        else ["--error", wanted]
    )
    code, said, text = ecam(tmp_path, capsys, design, *options, *limit)
    sense = -1.0 if reverse else 1.0
    if code:  # a jump that no row can tell: never more than its least, which is kept
        assert "the least error of the position is" in said, (seed, slug, said)
        least = float(re.search(r"allowed: at least (\S+) mm", said)[1])
        assert least > wanted
        code, said, text = ecam(tmp_path, capsys, design, *options, "--error", least)
        assert code == 0, (seed, slug, said)
    motion = load(design).drive.motion
    gain = sense * motion.advance
    rows = rows_of(slug, text, turn, gain * scale)
    ends = (rows["y"][[0, -1]] - offset) / scale
    tolerance = (
        0.51
        * (1e-4 if slug in ("beckhoff-zebra", "technosoft") else 1e-6)
        / abs(scale if slug != "technosoft" else 1.0)
    )
    assert abs(ends[1] - ends[0] - gain) <= 2.0 * tolerance, (seed, slug)
    if not shift:
        assert abs(ends[0] - motion.start) <= tolerance, (seed, slug)
        assert abs(ends[1] - motion.start - gain) <= 2.0 * tolerance, (seed, slug)
    exact = exact_motion(str(design), shift, reverse)
    found = brute(slug, kind, text, exact, turn, scale, offset, advance=gain * scale)
    stated = [said["deviation_mm"], said["velocity_deviation"], said["acceleration_deviation"]]
    for value, certificate in zip(found, stated, strict=True):
        if certificate is not None:
            assert value <= certificate * (1.0 + 1e-6) + 1e-9, (seed, slug, kind)
            assert value >= 0.95 * certificate - 1e-9, (seed, slug, kind)


@pytest.mark.parametrize(("slug", "kind"), RUNS[:5])
def test_of_a_motion_that_advances_the_certificate_is_the_true_error(tmp_path, capsys, slug, kind):
    check(tmp_path, capsys, 1, slug, kind)


@pytest.mark.stress
@pytest.mark.parametrize(("slug", "kind"), RUNS)
def test_of_100_motions_that_advance_the_certificate_is_the_true_error(tmp_path, capsys, slug, kind):
    for seed in range(2, 102):
        check(tmp_path, capsys, seed, slug, kind)


@pytest.mark.parametrize(("slug", "end"), [("codesys-x", -290.0), ("codesys-xyva", -290.0), ("sew-tab", -290.0)])
def test_run_backwards_a_feed_ends_its_advance_below_its_start(tmp_path, capsys, slug, end):
    design = tmp_path / "feed.toml"
    design.write_text(FEED, "utf-8")
    code, _, text = ecam(tmp_path, capsys, design, "--controller", slug, "--reverse", "--error", "0.1")
    assert code == 0
    assert rows_of(slug, text, 360.0)["y"][[0, -1]].tolist() == [10.0, end]


def equal_errors(design, kind, counts):
    """The largest error of so many equal steps, at 200 points of every piece, a row at a jump holding the mean of both sides."""
    exact, made = exact_motion(design), []
    for steps in counts:
        x = np.arange(steps + 1) / steps
        left, right = (exact(at[None])[:, 0] for at in (np.maximum(x - 1e-10, 0.0), np.minimum(x + 1e-10, 1.0 - 1e-10)))
        left[:, 0], right[:, -1] = right[:, 0], left[:, -1]
        y, v, a = 0.5 * (left + right)
        u, curve = path(kind, {"x": x, "y": y, "v": v, "a": a})
        made.append(float(np.abs(curve[0] - exact(u)[0]).max()))
    return np.array(made)


@pytest.mark.parametrize("kind", spread([QUINTIC, LINES, CUBIC], 1))
def test_the_least_error_of_equal_steps_is_the_least_of_all_their_numbers(tmp_path, capsys, kind):
    rows = user_folder("settings") / "controllers.toml"
    rows.parent.mkdir(parents=True)
    rows.write_text(
        '[[controllers]]\nslug = "small"\nlabel = "Small"\n'
        f'interpolation = ["{kind}"]\ncolumns = ["master", "slave", "velocity", "acceleration"]\n'
        'row = "{master}{sep}{slave}{sep}{velocity}{sep}{acceleration}"\ndigits = 15\nrows = [2, 90]\n',
        "utf-8",
    )
    design = tmp_path / "kinked.toml"
    design.write_text(KINKED, "utf-8")
    options = ["--controller", "small", "--as", "equal", "--error"]
    code, said, _ = ecam(tmp_path, capsys, design, *options, "1e-6")
    assert code == 2
    found = re.fullmatch(
        r"--error 1e-06: small cannot keep it; the least error of the position is (\S+) mm, at \S+ deg, limited by (.+); "
        r"allowed: at least \1 mm\n",
        said,
    )
    assert found, said
    jump = r"the jump of the velocity by 0\.2389 mm/deg at \S+ deg, which at the step \S+ deg causes up to about \S+ h\|Δv\|"
    assert found[2] == "its 90 rows" if kind == LINES else re.fullmatch(jump, found[2])
    counts = np.arange(1, 90)
    errors = equal_errors(str(design), kind, counts)
    least = float(found[1])
    assert least == pytest.approx(errors.min(), rel=2e-3)
    code, said, _ = ecam(tmp_path, capsys, design, *options, least)
    assert (code, said["rows"]) == (0, 1 + counts[errors.argmin()])
    for wanted in np.geomspace(1.05 * least, 3.0, 9).tolist():  # and the fewest are the first that keep an error
        code, said, _ = ecam(tmp_path, capsys, design, *options, wanted)
        assert (code, said["rows"]) == (0, 1 + counts[np.argmax(errors <= wanted)])
    assert ecam(tmp_path, capsys, design, *options, 0.98 * least)[0] == 2


@pytest.mark.parametrize(
    ("options", "unit"),
    [
        (("--velocity-error", "0.01"), "mm/deg"),
        stressed(("--error", "1e-6", "--velocity-error", "10"), "mm"),
        stressed(("--acceleration-error", "1"), "mm/deg²"),
    ],
)
def test_what_a_jump_holds_is_said_with_the_least_and_its_unit(tmp_path, capsys, options, unit):
    design = tmp_path / "kinked.toml"
    design.write_text(KINKED, "utf-8")
    code, said, text = ecam(tmp_path, capsys, design, "--controller", "codesys-xyva", *options)
    assert (code, text) == (2, "")
    assert len(said.splitlines()) == 1
    assert "limited by the jump of the velocity by 0.2389 mm/deg" in said
    least = float(re.search(rf"allowed: at least (\S+) {re.escape(unit)}\n", said)[1])
    if unit == "mm/deg":  # a path without a jump is half of it off on one side at least
        assert 0.5 <= least / (20.0 / 83.7) <= 0.6
    last = [options[0], str(least), *options[2:]]
    assert ecam(tmp_path, capsys, design, "--controller", "codesys-xyva", *last)[0] == 0


def test_a_controller_of_few_rows_names_the_least_that_they_reach(tmp_path, capsys):
    design = tmp_path / "feed.toml"
    design.write_text(FEED, "utf-8")
    for slug, rows in (("sew-tab", 1024), ("beckhoff-zebra", 360)):
        code, said, _ = ecam(tmp_path, capsys, design, "--controller", slug, "--error", "1e-4")
        assert code == 2
        assert f"limited by its {rows} rows" in said
        least = float(re.search(r"allowed: at least (\S+) mm\n", said)[1])
        assert ecam(tmp_path, capsys, design, "--controller", slug, "--error", least)[0] == 0
        assert ecam(tmp_path, capsys, design, "--controller", slug, "--error", 0.75 * least)[0] == 2


# -- a segment alone ---------------------------------------------------------------------------------------


def segment_rows(text):
    return np.array([[float(n) for n in line.split(";")] for line in text.split()])


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("number", [1, 3])
def test_a_segment_alone_rises_from_0_to_1(tmp_path, capsys, number, reverse):
    design = tmp_path / "up_and_down.toml"
    laws = '{ law = "3-4-5", span_deg = 100.0, rise_mm = 20.0 }', '{ law = "3-4-5", span_deg = 110.0, rise_mm = -20.0 }'
    design.write_text(
        'format = 1\nname = "Up and down"\n[motion]\nstart_mm = 7.0\nsegments = ['
        f'{laws[0]}, {{ law = "dwell", span_deg = 50.0 }}, {laws[1]}, {{ law = "dwell", span_deg = 100.0 }}]\n',
        "utf-8",
    )
    options = ["--controller", "inventor", "--points", "21", *(["--reverse"] if reverse else [])]
    code, said, text = ecam(tmp_path, capsys, design, *options, "--segment", number)
    assert (code, said["rows"]) == (0, 21)
    u, s = segment_rows(text).T
    assert np.abs(u - np.arange(21) / 20.0).max() < 1e-11
    assert np.abs(s - (10.0 * u**3 - 15.0 * u**4 + 6.0 * u**5)).max() < 2e-11
    for wrong, says in (
        (2, "the slave must not end where it starts"),
        (5, "--segment 5: no such segment; allowed: 1 ... 4"),
        (0, "0"),
    ):
        code, said, _ = ecam(tmp_path, capsys, design, *options, "--segment", wrong)
        assert code == 2
        assert says in said
    code, said, _ = ecam(tmp_path, capsys, design, "--controller", "codesys-x", "--segment", number)
    assert code == 2
    assert f"--segment {number}: codesys-x requires the full turn" in said


def test_a_segment_that_overshoots_is_no_inventor_file(tmp_path, capsys):
    design = tmp_path / "over.toml"
    design.write_text(
        'format = 1\nname = "Over"\n[motion]\nstart_mm = 0.0\nsegments = [\n'
        '{ law = "polynomial", span_deg = 180.0, rise_mm = 1.0, start = { velocity = -1.0 }, end = { velocity = 0.0 } },\n'
        '{ law = "polynomial", span_deg = 180.0, rise_mm = -1.0, end = { velocity = -1.0 } } ]\n',
        "utf-8",
    )
    code, said, text = ecam(tmp_path, capsys, design, "--controller", "inventor", "--segment", "1", "--points", "50")
    assert (code, text) == (2, "")
    assert "its rows ascend from 0 to 1, and the slave reverses" in said


# -- read again --------------------------------------------------------------------------------------------


CLOSING = [slug for slug, _ in RUNS if slug not in ("general", "beckhoff-ascii", "beckhoff-zebra")]


@pytest.mark.parametrize("slug", spread(CLOSING, 3))
@pytest.mark.parametrize("asked", [(), ("--as", "motion")])
def test_a_table_that_advances_is_made_into_a_file_of_its_own(tmp_path, capsys, slug, asked):
    design, read = tmp_path / "feed.toml", tmp_path / "read.toml"
    design.write_text(FEED, "utf-8")
    code, _, text = ecam(
        tmp_path, capsys, design, "--controller", slug, "--points", 181 if slug == "technosoft" else 60
    )
    assert code == 0
    assert main(["measured", str(tmp_path / "table.out"), "--controller", slug, "--into", str(read), *asked]) == 0
    motion = load(read).drive.motion
    assert motion.advance == pytest.approx(300.0, abs=1e-6)
    assert motion.start == pytest.approx(10.0, abs=1e-6)
    rows = rows_of(slug, text, 360.0)
    at = exact_motion(str(read))(rows["x"][None, :-1])[0, 0]
    assert np.abs(at - rows["y"][:-1]).max() <= 1e-9
    assert main(["check", str(read)]) in (0, 1)
    capsys.readouterr()


def test_a_zebra_of_another_kind_or_an_odd_number_is_refused(tmp_path, capsys):
    design, table = tmp_path / "feed.toml", tmp_path / "table.out"
    design.write_text(FEED, "utf-8")
    code, _, text = ecam(tmp_path, capsys, design, "--controller", "beckhoff-zebra", "--points", "20")
    assert code == 0
    assert "Tabletype = 7" in text
    assert "Functiontype = 4" in text
    assert re.search(r"^0 100000$", text, re.MULTILINE)
    lines = text.split("\n")
    odd = "\n".join(lines[:-3] + lines[-2:]).replace("Lines = 20", "Lines = 19")
    for changed, says in (
        (text.replace("Functiontype = 4", "Functiontype = 5"), "allowed: 4"),
        (odd, "an even number"),
    ):
        table.write_text(changed, "utf-8")
        assert main(["measured", str(table), "--controller", "beckhoff-zebra"]) == 2
        assert says in capsys.readouterr().err
