"""Profile files: read again by other readers than their writers and measured against the exact curve."""

import contextlib
import io
import json
import math
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import drawing_readers as drawings
import ezdxf
import numpy as np
import pytest
from mechanisms import LIFT, PUSHER, levels, with_cam, with_drive, with_shaft
from sampled import spread, stressed
from scipy.spatial import cKDTree

from core import project
from core.__main__ import main
from core.design import Design
from core.study import Study, extremes_of

ROOT = Path(__file__).parents[3]
FOUR_BAR, COUPLER = (ROOT / "resources/examples" / f"{name}.toml" for name in ("four_bar", "four_bar_coupler_cam"))
EXACT = 36_000  # angles at which files are measured

# a rise so steep that the cam is hollow there
HOLLOW = with_cam(with_drive(PUSHER, motion=levels(0.0, (40.0, 0.0, "dwell"), (80.0, 40.0, "cycloidal"), (130.0, 40.0, "dwell"),
                                                   (110.0, 0.0, "3-4-5"))), base_radius_mm=30.0)  # fmt: skip
TURNED = with_shaft(HOLLOW, rotation="cw")


def circle(eccentric: float = 10.0) -> str:
    """A design file whose cam is an eccentric disk, under a flat face."""
    rises = "".join(
        f'[[motion.segments]]\nlaw = "simple-harmonic"\nspan_deg = 180.0\nrise_mm = {rise}\n'
        for rise in (2.0 * eccentric, -2.0 * eccentric)
    )
    return (
        f'format = 1\nname = "Eccentric -- disk"\n[motion]\nstart_mm = 0.0\n{rises}[follower]\nkind = "translating"\nface = "flat"\n'
        '[cam]\nbase_radius_mm = 40.0\n[shaft]\nrotation = "cw"\nspeed_rpm = 60.0\n[loads]\n'
    )


def run(*words: object) -> tuple[int, str, str]:
    """The command in this process: exit code, what it printed, its faults."""
    said, faults = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(faults):
        code = main(["profile", *map(str, words)])
    return code, said.getvalue(), faults.getvalue()


def saved(folder: Path, design: Design) -> Path:
    path = folder / "design.toml"
    project.save(design, path)
    return path


def written(design: Path, out: Path, *words: object) -> dict[str, float]:
    """What the command says of the file that it wrote."""
    code, said, faults = run(design, "--out", out, "--json", *words)
    assert (code, faults) == (0, ""), faults
    return json.loads(said)


def exact(design: Path, beside: float = 0.0, count: int = EXACT) -> np.ndarray:
    """The profile [mm] at so many angles, or what runs beside it on the follower's side."""
    study = Study(project.load(design), count)
    back = np.exp(-1j * study.sense * study.theta)
    return 1e3 * study.cam.flank.profile - beside * study.cam.flank.normal * back


def off(points: np.ndarray, closed: np.ndarray) -> np.ndarray:
    """Distance (n,) of points from a closed polyline through very many: of its lines at the nearest of them."""
    nearest = cKDTree(np.column_stack((closed.real, closed.imag))).query(np.column_stack((points.real, points.imag)))[1]
    best = np.abs(points - closed[nearest])
    for side in (-1, 1):
        a, b = closed[nearest], closed[(nearest + side) % closed.size]
        along = np.clip(((points - a) / np.where(a == b, 1.0, b - a)).real, 0.0, 1.0)
        best = np.minimum(best, np.abs(points - a - along * (b - a)))
    return best


READERS = {
    ".csv": lambda path, layer, count: drawings.along_csv(path, count),
    ".dxf": drawings.along_dxf,
    ".svg": drawings.along_svg,
}


def check_deviation(
    path: Path, stated: dict[str, float], curve: np.ndarray, chords: bool, layer: str = "PROFILE"
) -> None:
    """The file is never farther from the curve than it states, and states no more than a tenth above that."""
    each = max(2, (6_000 if chords else 40_000) // int(stated["points"]))
    described = READERS[path.suffix](path, layer, each)
    farthest = float(off(curve, described).max())
    # how far the chords between these points may be from what is described
    inside = (
        0.0
        if chords
        else float(np.abs(np.diff(described[: described.size // each * each].reshape(-1, each), 2)).max()) / 8.0
    )
    assert farthest <= stated["deviation_mm"] + inside + 1e-9
    assert stated["deviation_mm"] <= 1.1 * farthest + 1e-9
    assert float(off(described[::7], curve).max()) <= stated["deviation_mm"] * 1.001 + 5e-6, (
        "all of the file lies on the curve"
    )
    length = np.abs(np.diff(np.append(curve, curve[0]))).sum()
    assert stated["length_mm"] == pytest.approx(length, rel=1e-7)


# -- files measured ---------------------------------------------------------------------------------------

FITS = ("spline", "polyline", "arcs")
WISHES = [
    (".csv", ("--samples", 7)), (".csv", ("--spacing", 1.5)), (".csv", ("--tolerance", 0.01)),
    *((".dxf", ("--as", fit, "--tolerance", 0.002)) for fit in FITS),
    (".svg", ("--as", "arcs", "--tolerance", 0.01)),
    (".dxf", ("--as", "arcs", "--samples", 36)), (".dxf", ("--as", "spline", "--spacing", 5)),
]  # fmt: skip


@pytest.mark.parametrize(("ending", "words"), spread(WISHES, 2), ids=str)
def test_a_file_deviates_as_it_states(tmp_path: Path, ending: str, words: tuple[object, ...]) -> None:
    design = saved(tmp_path, TURNED)
    stated = written(design, tmp_path / f"cam{ending}", *words)
    check_deviation(tmp_path / f"cam{ending}", stated, exact(design), ending == ".csv" or "polyline" in words)
    if "--tolerance" in words:
        assert stated["deviation_mm"] <= words[words.index("--tolerance") + 1]


@pytest.mark.parametrize(("fit", "face"), spread([("spline", "knife"), ("arcs", "roller")], 1))
def test_other_followers_files_deviate_as_they_state(tmp_path: Path, fit: str, face: str) -> None:
    path = saved(tmp_path, LIFT if face == "roller" else HOLLOW)
    text = path.read_text("utf-8")
    if face == "knife":
        path.write_text(
            text.replace('face = "roller"', 'face = "knife"').replace("roller_radius_mm = 12.0\n", ""), "utf-8"
        )
    stated = written(path, tmp_path / "cam.dxf", "--as", fit, "--tolerance", 0.02)
    check_deviation(tmp_path / "cam.dxf", stated, exact(path), False)


FORMS = {
    "outer": ("groove", 'form = "groove"\nplay_mm = 0.2'),
    "second": ("conjugate", 'form = "conjugate"\n[cam.second]\nroller_radius_mm = 10.0'),
}


@pytest.mark.parametrize("flank", spread(list(FORMS), 1))
@pytest.mark.stress
def test_other_flanks_have_files(tmp_path: Path, flank: str) -> None:
    """The outer flank of a groove, and the path of a cutter that fills it, halfway between the flanks; the second cam of a pair. A
    drawing holds both, whichever is chosen, and says how far each is off."""
    form, words = FORMS[flank]
    design = saved(tmp_path, PUSHER)
    text = design.read_text("utf-8").replace('form = "open"', words)
    text = (
        text.replace("offset_mm = 7.0", "offset_mm = 7.0\nsecond = { distance_mm = 160.0 }")
        if form == "conjugate"
        else text
    )
    design.write_text(text, "utf-8")
    flanks = {each.name: each for each in Study(project.load(design), EXACT).cam.flanks}
    there, layers = (
        flanks[flank],
        {"inner": "PROFILE_INNER" if form == "groove" else "PROFILE", flank: f"PROFILE_{flank.upper()}"},
    )
    for chosen in flanks:
        stated = written(design, tmp_path / "cam.dxf", "--flank", chosen, "--as", "arcs", "--tolerance", 0.01)
        beside = {"PITCH", "BASE", "ZERO"} | ({"PITCH_SECOND"} if form == "conjugate" else set())
        assert {each.layer for each in drawings.entities(tmp_path / "cam.dxf")} == set(layers.values()) | beside
        own = {name: stated[name] for name in ("points", "length_mm", "deviation_mm")}
        assert stated["layers"][layers[chosen]] == {"flank": chosen, **own}
        for name, layer in layers.items():
            check_deviation(tmp_path / "cam.dxf", stated["layers"][layer], 1e3 * flanks[name].profile, False, layer)
    if form == "groove":
        stated = written(design, tmp_path / "path.csv", "--flank", flank, "--cutter", 12.1, "--tolerance", 0.01)
        between = Study(
            project.load(design), EXACT
        ).cam.flank  # the inner flank is 12 mm from the pitch curve, the outer 12.2
        path = 1e3 * between.pitch + 0.1 * (1e3 * there.profile - 1e3 * between.pitch) / 12.2
        check_deviation(tmp_path / "path.csv", stated, path, True)
        check_refused(
            tmp_path,
            "cutter: a radius of 12.2 mm does not go into the groove, which is 24.2 mm wide",
            design,
            "--out",
            tmp_path / "no.csv",
            "--flank",
            flank,
            "--cutter",
            12.2,
        )


@pytest.mark.stress
def test_a_cam_under_a_linkage_and_the_path_of_a_cutter(tmp_path: Path) -> None:
    """Beside the profile by its radius, where the roller runs."""
    stated = written(COUPLER, tmp_path / "cam.dxf", "--cutter", 8, "--as", "arcs", "--tolerance", 0.01)
    check_deviation(tmp_path / "cam.dxf", stated, exact(COUPLER, 8.0), False, "CUTTER")
    profile = drawings.arc_chain(drawings.on_layer(tmp_path / "cam.dxf", "PROFILE"))
    assert off(exact(COUPLER), drawings.along_arcs(*profile, 5000)).max() <= 0.01
    stated = written(COUPLER, tmp_path / "cam.csv", "--cutter", 8)
    check_deviation(tmp_path / "cam.csv", stated, exact(COUPLER, 8.0), True)


def test_points_at_equal_arc_lengths(tmp_path: Path) -> None:
    design = saved(tmp_path, TURNED)
    stated = written(design, tmp_path / "cam.csv", "--spacing", 2)
    rows = np.genfromtxt(tmp_path / "cam.csv", delimiter=",", names=True)
    assert rows.size == stated["points"] == math.ceil(stated["length_mm"] / 2.0)
    fine = Study(TURNED, 400 * 360)
    curve = fine.cam.flank.profile * 1e3
    lengths = np.append(0.0, np.cumsum(np.abs(np.diff(np.append(curve, curve[0])))))
    at = np.interp(rows["cam_angle_deg"], np.append(fine.angle_degrees, 360.0), lengths)
    assert np.diff(at) == pytest.approx(stated["length_mm"] / rows.size, abs=1e-6)


def test_the_table_holds_the_profile_of_the_export(tmp_path: Path) -> None:
    written(saved(tmp_path, TURNED), tmp_path / "cam.csv", "--samples", 90)
    rows = np.genfromtxt(tmp_path / "cam.csv", delimiter=",", names=True)
    study = Study(TURNED, 90)
    z = study.cam.flank.profile * 1e3
    assert rows["cam_angle_deg"].tolist() == study.angle_degrees.tolist()
    assert np.abs(rows["x_mm"] + 1j * rows["y_mm"] - z).max() < 1e-12
    assert np.abs(rows["radius_mm"] * np.exp(1j * np.deg2rad(rows["polar_angle_deg"])) - z).max() < 1e-12


# -- the fewest -------------------------------------------------------------------------------------------

PLACES = 240  # on the curve, among which all choices are tried


def least_count(deviates: np.ndarray, tolerance: float) -> int:
    """Fewest spans round the curve from its first place, of all choices: deviates[i, j] over j + 1 steps from place i."""
    fewest = np.full(PLACES + 1, np.inf)
    fewest[0] = 0
    for i in range(PLACES):
        for j in range(min(deviates.shape[1], PLACES - i)):
            if deviates[i, j] <= tolerance:
                fewest[i + j + 1] = min(fewest[i + j + 1], fewest[i] + 1)
    return int(fewest[-1])


@pytest.mark.stress
def test_no_choice_of_points_takes_fewer(tmp_path: Path) -> None:
    """No choice among 240 places, by brute force, needs fewer chords, or pairs of tangent arcs; and with as much more tolerance as
    makes up for the distance of these places none needs fewer by more than one."""
    tolerance, inside, most = 0.8, 12, 90
    design = saved(tmp_path, HOLLOW)
    fine = exact(design, count=PLACES * inside)
    rounds = np.concatenate((fine, fine))
    tangent = np.gradient(rounds)
    tangent /= np.abs(tangent)
    chords, arcs = np.full((PLACES, most), np.inf), np.full((PLACES, most), np.inf)
    for i in range(PLACES):
        for j in range(1, most):
            piece = slice(i * inside, (i + j) * inside + 1)
            p, q, z = rounds[piece][0], rounds[piece][-1], rounds[piece][:: max(1, j // 2)]
            chords[i, j - 1] = np.abs(((z - p) * (q - p).conjugate()).imag).max() / abs(q - p)
            arcs[i, j - 1] = pair_deviation(p, q, tangent[piece][0], tangent[piece][-1], z)
    for fit, deviates in (("polyline", chords), ("arcs", arcs)):
        stated = written(design, tmp_path / "cam.dxf", "--as", fit, "--tolerance", tolerance)
        spans = stated["points"] if fit == "polyline" else math.ceil(stated["points"] / 2)
        assert spans <= least_count(deviates, tolerance)
        assert spans >= least_count(deviates, 1.2 * tolerance) - 1


def pair_deviation(p: complex, q: complex, start: complex, end: complex, z: np.ndarray) -> float:
    """How far points are from the two tangent arcs from p to q with equally long tangents: both circles by their centres."""
    v, t = q - p, start + end
    a, b, c = 2.0 * (1.0 - (start.conjugate() * end).real), 2.0 * (v.conjugate() * t).real, -(abs(v) ** 2)
    length = -c / b if abs(a) < 1e-12 else (-b + math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
    joint = 0.5 * (p + q + length * (start - end))
    best = np.full(z.size, np.inf)
    for here, there, direction in ((p, joint, start), (q, joint, -end)):
        chord = there - here
        bend = 2.0 * (direction.conjugate() * chord).imag / abs(chord) ** 2
        if abs(bend) < 1e-9:
            distance = np.abs(((z - here) * chord.conjugate()).imag) / abs(chord)
        else:
            centre = here + 1j * direction / bend
            distance = np.abs(np.abs(z - centre) - 1.0 / abs(bend))
        side = ((z - joint) * (chord / abs(chord)).conjugate()).real <= 1e-9
        best = np.where(side, np.minimum(best, distance), best)
    return float(best.max())


# -- tangent arcs -----------------------------------------------------------------------------------------


@pytest.mark.stress
def test_tangent_arcs_have_no_break_anywhere(tmp_path: Path) -> None:
    """The closure included; and turn about once in all."""
    for words in (("--tolerance", 0.01), ("--samples", 24)):
        written(saved(tmp_path, HOLLOW), tmp_path / "cam.dxf", "--as", "arcs", *words)
        p, b = drawings.arc_chain(drawings.on_layer(tmp_path / "cam.dxf", "PROFILE"))
        starts, ends = drawings.tangents(p, b)
        assert np.abs(np.angle(np.exp(1j * (np.roll(starts, -1) - ends)))).max() < 1e-9
        assert abs(4.0 * np.arctan(b).sum()) == pytest.approx(2.0 * np.pi)
        assert np.abs(b).max() <= 1.0 + 1e-8


def test_an_eccentric_disk_is_two_arcs(tmp_path: Path) -> None:
    (tmp_path / "disk.toml").write_text(circle(), "utf-8")
    stated = written(tmp_path / "disk.toml", tmp_path / "disk.dxf", "--as", "arcs", "--tolerance", 1e-6)
    assert stated["points"] == 2
    assert stated["length_mm"] == pytest.approx(100.0 * np.pi, rel=1e-12)
    assert stated["deviation_mm"] < 1e-10
    p, b = drawings.arc_chain(drawings.on_layer(tmp_path / "disk.dxf", "PROFILE"))
    assert np.abs(np.abs(drawings.along_arcs(p, b, 100) + 10j) - 50.0).max() < 1e-10
    assert b == pytest.approx([-1.0, -1.0] if b[0] < 0.0 else [1.0, 1.0])


# -- what the files say -----------------------------------------------------------------------------------


def test_a_dxf_drawing_is_sound_and_says_what_it_is(tmp_path: Path) -> None:
    design = saved(tmp_path, replace(TURNED, name="Kran 7, gedreht é"))
    for fit in ("spline", "arcs"):
        stated = written(design, tmp_path / "cam.dxf", "--as", fit, "--tolerance", 0.02)
        read = ezdxf.readfile(tmp_path / "cam.dxf")
        audit = read.audit()
        assert (audit.errors, audit.fixes) == ([], [])
        assert {e.dxf.layer for e in read.modelspace()} == {"PROFILE", "PITCH", "BASE", "ZERO"}
    assert drawings.header(tmp_path / "cam.dxf", "$INSUNITS") == [4.0]
    assert drawings.header(tmp_path / "cam.dxf", "$INSBASE") == [0.0, 0.0, 0.0]
    assert drawings.on_layer(tmp_path / "cam.dxf", "BASE").all(40).tolist() == [30.0]
    pitch = drawings.along_dxf(tmp_path / "cam.dxf", "PITCH", 4000)
    assert off(exact(design, 12.0), pitch).max() <= 0.02
    mark = drawings.on_layer(tmp_path / "cam.dxf", "ZERO")
    assert (mark.all(20).item(), mark.all(21).item()) == (0.0, 0.0)
    z = exact(design)
    edge = float(z.real[np.abs(np.angle(z)) < 1e-3].mean())
    ends = mark.all(10).item(), mark.all(11).item()
    assert ends == pytest.approx((0.75 * edge, 0.95 * edge), rel=1e-4), "short of the profile: CAD would chain them"
    text = "\n".join(drawings.comments(tmp_path / "cam.dxf"))
    for words in ("Kran 7, gedreht é", "clockwise (cw)", "mm", "tolerance 0.02 mm", f"{stated['points']}"):
        assert words in text


def test_bore_and_keyway_are_drawn_where_they_are_known(tmp_path: Path) -> None:
    """Sides and bottom of the keyway by their corners: from the bore to its depth, half its width beside its angle."""
    design = saved(tmp_path, with_cam(PUSHER, bore_mm=20.0, keyway_width_mm=6.0, keyway_depth_mm=2.8))
    written(design, tmp_path / "cam.dxf", "--samples", 36)
    assert "KEYWAY" not in {entity.layer for entity in drawings.entities(tmp_path / "cam.dxf")}, "nobody knows where"
    assert "Keyway: not drawn, not given: cam.keyway_angle_deg" in drawings.comments(tmp_path / "cam.dxf")
    design = saved(
        tmp_path, with_cam(PUSHER, bore_mm=20.0, keyway_width_mm=6.0, keyway_depth_mm=2.8, keyway_angle_deg=90.0)
    )
    written(design, tmp_path / "cam.dxf", "--samples", 36)
    assert drawings.on_layer(tmp_path / "cam.dxf", "BORE").all(40).tolist() == [10.0]
    lines = [entity for entity in drawings.entities(tmp_path / "cam.dxf") if entity.layer == "KEYWAY"]
    corners = [(line.all(10).item(), line.all(20).item(), line.all(11).item(), line.all(21).item()) for line in lines]
    rim = math.sqrt(100.0 - 9.0)
    assert corners == [
        pytest.approx(sides) for sides in ((3.0, rim, 3.0, 12.8), (3.0, 12.8, -3.0, 12.8), (-3.0, 12.8, -3.0, rim))
    ]


def test_an_svg_drawing_is_to_scale_and_says_what_it_is(tmp_path: Path) -> None:
    from PySide6.QtSvg import QSvgRenderer

    (tmp_path / "disk.toml").write_text(circle(), "utf-8")
    written(tmp_path / "disk.toml", tmp_path / "disk.svg", "--as", "arcs")
    text = (tmp_path / "disk.svg").read_text("utf-8")
    drawn = QSvgRenderer(str(tmp_path / "disk.svg"))
    assert drawn.isValid()
    box = drawn.boundsOnElement("PROFILE")  # in units of the view box, whose y axis points down
    assert (box.center().x(), box.center().y()) == pytest.approx((0.0, 10.0), abs=0.01)
    assert (box.width(), box.height()) == pytest.approx((100.0, 100.0), abs=0.5)
    assert f'width="{drawn.viewBoxF().width():g}mm"' in text
    comment = text[text.index("<!--") + 4 : text.index("-->")]
    assert "--" not in comment
    for words in ("Eccentric - - disk", "clockwise (cw)", "mm", "tolerance 0.001 mm"):
        assert words in comment


def test_a_file_that_is_called_as_the_facts_would_be_stays(tmp_path: Path) -> None:
    design = saved(tmp_path, TURNED)
    for data in ('{"file": "cam.csv", "author": "me"}', "mine", "[]", "[" * 10_000):
        (tmp_path / "cam.csv.json").write_text(data, "utf-8")
        says = check_refused(
            tmp_path,
            "cam.csv.json: cannot be written: it belongs to another program",
            design,
            "--out",
            tmp_path / "cam.csv",
        )
        assert "choose another folder or name" in says
        assert (tmp_path / "cam.csv.json").read_text("utf-8") == data


def test_the_facts_stand_beside_the_file_under_its_name(tmp_path: Path) -> None:
    """Those that are printed; two files in one folder keep theirs, and those of an export stay as they are."""
    design, folder = saved(tmp_path, TURNED), tmp_path / "out"
    assert main(["export", str(design), "--out", str(folder), "--samples", "36"]) == 0
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    tolerances = {"cam.csv": 0.01, "cam.dxf": 0.02}
    printed = {name: written(design, folder / name, "--tolerance", value) for name, value in tolerances.items()}
    after = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert set(after) - set(before) == {"cam.csv", "cam.csv.json", "cam.dxf", "cam.dxf.json"}
    assert {name: after[name] for name in before} == before
    for name, tolerance in tolerances.items():
        facts = json.loads(after[f"{name}.json"])
        assert facts == printed[name]
        assert [facts[key] for key in ("design", "rotation", "file", "tolerance_mm")] == [
            "pusher",
            "cw",
            name,
            tolerance,
        ]


@pytest.mark.parametrize("name", spread(["cam.csv", "cam.dxf", "cam.svg", "cam.nc"], 1))
def test_a_file_of_one_drive_of_several_names_machine_and_drive(tmp_path: Path, name: str) -> None:
    stated = written(
        ROOT / "resources/examples/transfer_unit.toml",
        tmp_path / name,
        "--drive",
        "lift",
        "--cutter",
        5,
        "--samples",
        90,
    )
    assert stated["design"] == "Transfer unit, drive Lift"
    if name != "cam.csv":
        assert "Design: Transfer unit, drive Lift" in (tmp_path / name).read_text("utf-8")


@pytest.mark.stress
def test_the_same_design_gives_the_same_bytes(tmp_path: Path) -> None:
    """In another process, too, which says so in words."""
    design = saved(tmp_path, PUSHER)
    for name in ("one.dxf", "one.svg", "two.svg"):
        run(design, "--out", tmp_path / name, "--samples", 90)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": "7", "TZ": "Asia/Seoul"}
    out = tmp_path / "elsewhere/one.dxf"
    command = [sys.executable, "-m", "core", "profile", str(design), "--out", str(out), "--samples", "90"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, encoding="utf-8")
    assert "from the exact curve" in done.stdout
    assert done.stderr == ""
    assert out.read_bytes() == (tmp_path / "one.dxf").read_bytes()
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()


# -- bad input --------------------------------------------------------------------------------------------


def check_refused(folder: Path, says: str, *words: object) -> str:
    """Exit code 2, one clear line, nothing written or changed."""
    before = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    code, said, faults = run(*words)
    assert (code, said) == (2, "")
    assert len(faults.splitlines()) == 1
    assert says in faults
    assert {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()} == before
    return faults


CORNER = with_drive(PUSHER, motion=levels(0.0, (180.0, 20.0, "constant-velocity"), (180.0, 0.0, "constant-velocity")))
CUSP = with_drive(
    PUSHER, motion=levels(0.0, (25.0, 20.0, "cycloidal"), (25.0, 0.0, "cycloidal"), (310.0, 0.0, "dwell"))
)


@pytest.mark.parametrize(
    ("design", "words", "says"),
    [
        (PUSHER, ("cam.dxf", "--tolerance", 1e-12), "tolerance 1e-12 mm: below the accuracy"),
        (PUSHER, ("cam.svg", "--tolerance", 1e-8), "allowed: 1e-06 mm and more"),
        (PUSHER, ("cam.csv", "--tolerance", 1e-9), "choose a larger tolerance"),
        (PUSHER, ("cam.csv", "--as", "arcs"), "allowed: polyline"),
        (PUSHER, ("cam.stp",), "allowed: .csv, .dxf, .svg"),
        (PUSHER, ("cam.csv", "--flank", "outer"), "flank 'outer': this cam has none of that name; allowed: inner"),
        (PUSHER, ("cam.csv", "--drive", "feed"), "drive 'feed': this design has one drive"),
        (PUSHER, ("cam.csv", "--spacing", 500), "spacing 500 mm: the curve is"),
        (PUSHER, ("cam.csv", "--cutter", -3), "'-3': cutter radius; allowed: above 0"),
        (PUSHER, ("cam.csv", "--samples", 2), "allowed: 3 ... 1000000"),
        (PUSHER, ("cam.csv", "--samples", 20, "--spacing", 3), "not allowed with"),
        (CORNER, ("cam.csv",), "the velocity jumps, so the profile has a corner at cam angle 180 deg"),
        (CUSP, ("cam.csv",), "the profile is undercut"),
        (None, ("cam.csv",), "stage 'cam': this kind of design has none of that name"),
    ],
    ids=str,
)  # fmt: skip
def test_bad_input_is_named_and_nothing_written(
    tmp_path: Path, design: Design | None, words: tuple[object, ...], says: str
) -> None:
    path = FOUR_BAR if design is None else saved(tmp_path, design)
    with contextlib.suppress(SystemExit):
        check_refused(tmp_path, says, path, "--out", tmp_path / str(words[0]), *words[1:])


def test_a_cutter_too_large_for_a_hollow_is_refused_with_what_it_leaves(tmp_path: Path) -> None:
    """Brute force: the profile's distance from all discs of the cutter that enter it nowhere."""
    design = saved(tmp_path, HOLLOW)
    concave = -1e3 / extremes_of(Study(HOLLOW), "cam", ("profile_curvature",))["profile_curvature"].low.value
    written(design, tmp_path / "fits.csv", "--cutter", 0.999 * concave)
    radius = round(2.0 * concave)
    line = check_refused(
        tmp_path, f"cutter: a radius of {radius} mm", design, "--out", tmp_path / "cam.csv", "--cutter", radius
    )
    assert f"{concave:.4g} mm" in line
    profile, centres = exact(design, count=7200), exact(design, radius, 7200)
    places = cKDTree(np.column_stack((profile.real, profile.imag)))
    free = centres[places.query(np.column_stack((centres.real, centres.imag)))[0] >= radius - 1e-5]
    left = cKDTree(np.column_stack((free.real, free.imag))).query(places.data)[0] - radius
    stated = float(line.split("leaves ")[1].split()[0])
    assert stated == pytest.approx(left.max(), rel=0.03)
    low, high = line.split("cam angle ")[1].split(" deg")[0].split("...")
    worst = 0.05 * float(np.argmax(left))
    assert float(low) < worst < float(high)


# -- G-code -----------------------------------------------------------------------------------------------


def paths(design: Path, tmp_path: Path, radius: float, *words: object) -> tuple[list[drawings.Move], list[str], float]:
    """What the machine does; checked are its modes, its rapid moves and that it ends where it is safe."""
    out = tmp_path / "cam.nc"
    stated = written(design, out, "--cutter", radius, *words)["deviation_mm"]
    moves, remarks, others = drawings.gcode(out)
    assert (others[:4], others[-1], others.count("M0")) == (["G21", "G17", "G90", "G94"], "M30", 2)
    assert {m.z for m in moves if m.rapid} == {moves[0].z}
    assert moves[0].z > 0.0, "rapid moves above the blank alone"
    assert (moves[0].rapid, moves[-1].rapid) == (True, True)
    assert all(m.rapid for m in moves if m.z > 0.0)
    return moves, remarks, stated


def around(moves: list[drawings.Move], z: float) -> np.ndarray:
    """The places at a depth, in order."""
    return np.array([m.place for m in moves if m.z == z])


CUTS = {
    "lift": (LIFT, 20.0, 0.01),
    "hollow": (HOLLOW, 8.0, 0.05),
    "clockwise": (TURNED, 8.0, 0.005),
    "disk": (None, 6.0, 0.002),
}


ARCS = ("--as", "arcs")


@pytest.mark.parametrize(
    ("cut", "words"),
    [
        stressed("lift", ()),
        ("lift", ARCS),
        stressed("hollow", ARCS),
        stressed("clockwise", (*ARCS, "--conventional")),
        stressed("disk", ()),
        stressed("disk", ARCS),
    ],
    ids=str,
)
def test_a_program_read_back_is_the_cutters_path(tmp_path: Path, cut: str, words: tuple[str, ...]) -> None:
    """Straight moves, or G2 and G3, interpolated from what is written: in both ways in which machines take ends that are not equally
    far from a rounded centre."""
    design, radius, tolerance = CUTS[cut]
    (tmp_path / "design.toml").write_text(circle(), "utf-8")
    file = tmp_path / "design.toml" if design is None else saved(tmp_path, design)
    feeds = ("--depth", 12, "--feed", 310, "--safe", 4)
    moves, remarks, stated = paths(file, tmp_path, radius, "--tolerance", tolerance, *feeds, *words)
    cutting = [m for m in moves if m.z == -12.0]
    ring = cutting[1:-1]
    assert {m.feed for m in moves if m.z < 0.0} == {50.0, 310.0}
    assert (cutting[0].place, ring[0].place) == (cutting[-1].place, ring[-1].place), (
        "closed, from and to a place beside it"
    )
    assert any(m.centre is not None for m in ring) == bool(words)
    curve, profile, count = exact(file, radius), exact(file), max(12, 20_000 // len(ring))
    found = 0.0
    for late in (False, True):
        way = drawings.along_moves(ring, count, late)[:-1]
        found = max(found, float(off(curve, way).max()), float(off(way, curve).max()))
        nearest = cKDTree(np.column_stack((profile.real, profile.imag)))
        whole = drawings.along_moves(cutting, count, late)
        least = nearest.query(np.column_stack((whole.real, whole.imag)))[0].min()
        assert least >= radius - tolerance, "the cutter never enters the profile, its way in included"
    assert found <= stated * (1.0 + 1e-6) + 5e-6
    assert stated <= tolerance
    assert stated - found < 0.25 * stated or stated < 3e-4, "and no better than needed, but for its four decimals"
    around, sign = ("counter-clockwise", 1.0) if "--conventional" in words else ("clockwise", -1.0)
    area = abs(float(np.sum((np.conj(curve) * np.roll(curve, -1)).imag)))
    assert float(np.sum((np.conj(way) * np.roll(way, -1)).imag)) == pytest.approx(sign * area, rel=1e-3), (
        "once around, with M3"
    )
    milling = "conventional" if "--conventional" in words else "climb"
    assert any(f"Direction: {around} around the cam seen from above, {milling} milling" in line for line in remarks)
    assert any("X0 Y0 the cam centre" in line for line in remarks)
    assert any(f"radius {radius!r} mm" in line for line in remarks)
    assert any(f"tolerance {tolerance!r} mm" in line for line in remarks)


@pytest.mark.stress
def test_an_arc_too_flat_for_machines_is_cut_by_chords(tmp_path: Path) -> None:
    """A cam of a radius of 15 m."""
    flat = with_cam(
        with_drive(PUSHER, motion=levels(0.0, (180.0, 0.02, "cycloidal"), (180.0, 0.0, "cycloidal"))),
        base_radius_mm=15000.0,
    )
    file = saved(tmp_path, flat)
    moves, _, stated = paths(file, tmp_path, 8.0, "--tolerance", 0.05, "--as", "arcs", "--depth", 12)
    ring = [m for m in moves if m.z == -12.0][1:-1]
    assert all(m.centre is None for m in ring)
    assert float(off(exact(file, 8.0), drawings.along_moves(ring, 12)[:-1]).max()) <= stated * (1.0 + 1e-6)


NAMES = {
    "Lift; 50 % (new)": "Lift, 50  percent [new]", "고속 캠 1": "GOSOG KAEM 1", "Kran é ø 80° – Ж!": "Kran e O 80 deg - ZHE_",
    "工件（2）％": "5DE54EF6[2] percent",
}  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_comments_of_a_program_hold_what_every_machine_reads(tmp_path: Path, name: str) -> None:
    _, remarks, _ = paths(saved(tmp_path, replace(PUSHER, name=name)), tmp_path, 5.0, "--samples", 36)
    assert remarks[0] == f"Design: {NAMES[name]}"


@pytest.mark.stress
def test_passes_go_down_in_equal_steps_and_conventional_milling_goes_the_other_way(tmp_path: Path) -> None:
    file = saved(tmp_path, with_cam(HOLLOW, thickness_mm=14.0))
    moves, remarks, _ = paths(file, tmp_path, 8.0, "--tolerance", 0.05, "--step", 5, "--conventional")
    levels = sorted({m.z for m in moves if m.z < 0.0}, reverse=True)
    assert levels == pytest.approx([-14.0 / 3.0, -28.0 / 3.0, -14.0], abs=1e-4), "of the cam's thickness"
    rings = [around(moves, z) for z in levels]
    assert all(np.array_equal(ring, rings[0]) for ring in rings)
    assert float(np.sum((np.conj(rings[0][:-1]) * rings[0][1:]).imag)) > 0.0
    assert any("conventional" in line and "counter-clockwise around" in line for line in remarks)


def test_in_a_groove_the_cutter_goes_down_on_its_path(tmp_path: Path) -> None:
    moves, remarks, _ = paths(ROOT / "resources/examples/groove.toml", tmp_path, 5.0, "--flank", "outer")
    ring = around(moves, min(m.z for m in moves))
    assert ring[0] == ring[-1]
    assert any("on the path" in line for line in remarks)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((), "cutter: G-code needs the radius of a cutter, and none is given; allowed: above 0 mm"),
        (("--cutter", 200), "cutter: a radius of 200 mm does not reach all of the profile"),
        (("--cutter", 5, "--tolerance", 1e-5), "below the accuracy of such a file"),
        (("--cutter", 5, "--as", "spline"), "allowed: polyline, arcs"),
        (("--cutter", 5, "--as", "arcs", "--tolerance", 3e-4), "allowed: 0.0005 mm and more"),
    ],
    ids=str,
)  # fmt: skip
def test_what_cannot_be_cut_is_refused(tmp_path: Path, words: tuple[object, ...], says: str) -> None:
    check_refused(tmp_path, says, saved(tmp_path, HOLLOW), "--out", tmp_path / "cam.nc", *words)
