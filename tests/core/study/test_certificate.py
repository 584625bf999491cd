"""The certificate says *not kept* of what is wrong, and of nothing else: long motions, links that do not move against each
other, undercut cams, shafts that run away."""

import re
from dataclasses import replace
from functools import partial
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from counting import calls
from large_designs import short_fall
from linkages import chain, four_bar, link, sides
from mechanisms import PUSHER, levels, with_cam, with_drive, with_follower

from core.__main__ import main
from core.cam import tangency
from core.design import Design, Drive, Driver, Linkage, LinkageLoads
from core.findings import Residual
from core.instant_centres import all_centres, collinearity, moving_collinearity
from core.mechanism import driver_ranges_of, unit_speed_kinematics
from core.project import save
from core.study import Study, certificate_of, findings_of

EPS = float(np.finfo(float).eps)

RIGID = Design(
    "three links pinned to each other in a triangle, and a dyad on one of them",
    None,
    (
        Drive(
            None,
            Linkage(
                (
                    link(1, O2=(0, 0), O4=(100, 0), O6=(180, 60)),
                    link(2, O2=(0, 0), A=(30, 0)),
                    link(3, A=(0, 0), B=(90, 0), C=(45, 40)),
                    link(4, B=(70, 0), O2=(0, 0)),
                    link(5, C=(0, 0), D=(140, 0)),
                    link(6, O6=(0, 0), D=(100, 0)),
                ),
                (),
                Driver(2),
                sides(B=1, D=1),
            ),
            None,
            LinkageLoads(),
        ),
    ),
)


# -- what counts as kept ----------------------------------------------------------------------------------


def test_a_residual_is_kept_within_its_derived_bound_or_the_promised_accuracy() -> None:
    assert Residual(9e-13, 1e-16).kept
    assert not Residual(2e-12, 1e-16).kept
    assert Residual(2e-9, 3e-9).kept
    assert not Residual(4e-9, 3e-9).kept
    assert Residual(0.0, 1e-16).bound == 1e-12


def test_a_motion_long_against_the_base_circle_closes_within_a_few_roundings() -> None:
    """The follower's place is rounded as far out as it is, not as far as the base circle."""
    motion = replace(levels(0.0, (180.0, 900.0, "cycloidal"), (180.0, 0.0, "cycloidal")), start=836.8)
    design = with_drive(with_follower(PUSHER, offset_mm=0.0, direction_deg=344.5), motion=motion)
    loop = certificate_of(Study(with_cam(design, base_radius_mm=22.0, roller_radius_mm=0.8)), ("linkage",))[
        "loop_closure"
    ]
    assert loop.value <= loop.derived <= 4.0 * EPS


# -- three centres ----------------------------------------------------------------------------------------


def test_links_that_do_not_move_against_each_other_have_no_centres_to_prove() -> None:
    """Three pins of a rigid triangle are not on one line, and need not be: the theorem is about relative motion."""
    study = Study(RIGID)
    proof = certificate_of(study, ("linkage",))["three_centres"]
    assert proof.kept
    assert proof.value <= 1e-14
    found, total = re.fullmatch(r"(\d+) of (\d+) triples left out", proof.note).groups()  # type: ignore[union-attr]
    assert 0 < int(found) == proof.left_out < int(total) / 10


def test_what_was_left_out_stands_in_the_report_and_in_the_summary(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "rigid.toml"
    save(RIGID, path)
    main(["check", str(path)])
    assert "4 of 4 residuals within their bounds" in capsys.readouterr().out
    main(["report", str(path)])
    assert re.search(r"three centres .* kept +\d+ of \d+ triples left out\n", capsys.readouterr().out)


@pytest.mark.parametrize("design", [four_bar(100.0, 30.0, 90.0, 70.0), chain(8)], ids=["four-bar", "chain"])
def test_every_centre_stands_in_a_triple_that_is_proven(design: Design) -> None:
    """Whichever centre is moved off its place, the proof sees it."""
    kinematics = unit_speed_kinematics(
        design.drive.mechanism, np.linspace(0.1, 6.0, 7), driver_ranges_of(design.drive.mechanism)
    )
    size = 0.1
    table = all_centres(kinematics, size)
    assert collinearity(table).max() <= 1e-12
    triples = moving_collinearity(kinematics, size).triples
    for key, centre in table.centres.items():
        assert any(set(key) <= set(triple) for triple in triples), key
        shifted = replace(centre, point=centre.point + 1e-6 * (1.0 + 2.0j), weight=centre.weight + 3e-6).scaled(size)
        moved = replace(table, centres={**table.centres, key: shifted})
        assert collinearity(moved).max() > 1e-9, key


def test_of_a_long_linkage_every_centre_on_the_frame_and_of_a_pair_is_proven() -> None:
    mechanism = chain(20).drive.mechanism
    kinematics = unit_speed_kinematics(mechanism, np.linspace(0.1, 6.0, 7), driver_ranges_of(mechanism))
    table, proof = all_centres(kinematics, 0.1), moving_collinearity(kinematics, 0.1)
    looked_at = {key for triple in proof.triples for key in combinations(triple, 2)}
    assert looked_at == {key for key in table.centres if key in table.primary or "frame" in key}
    assert np.abs(proof.zero).max() <= 1e-12


def test_the_proof_of_centres_grows_as_the_links_do() -> None:
    """34 links have 5,984 triples of bodies, 60 have 34,220: those that are looked at grow like the number of links."""
    few, many = (Study(chain(n)) for n in (34, 60))
    counts = []
    for study in (few, many):
        assert study.design.drive.is_linkage
        _ = study.linkage, study.dynamics
        counts.append(calls(partial(certificate_of, study)))
        proof = certificate_of(study)["three_centres"]
        assert proof.kept
        assert proof.left_out < 0.1 * int(proof.cases.split()[0])
    assert counts[1] <= 1.1 * (60 / 34) * counts[0]


# -- the roller on the profile ----------------------------------------------------------------------------


def test_a_corner_of_the_pitch_curve_is_sharper_than_any_roller() -> None:
    design = with_drive(
        PUSHER, motion=levels(0.0, (180.0, 60.0, "constant-velocity"), (180.0, 0.0, "constant-velocity"))
    )
    study = Study(with_cam(design, roller_radius_mm=40.0))
    assert {"jump-velocity"} <= {f.code for f in findings_of(study, ("motion",))}
    proof = certificate_of(study, ("cam",))["roller_tangency"]
    assert proof.kept
    assert 0 < proof.left_out < 30


def test_an_undercut_is_a_finding_and_not_a_figure_that_is_wrong() -> None:
    design = with_cam(PUSHER, base_radius_mm=7.0, roller_radius_mm=50.0)
    study = Study(with_drive(design, motion=levels(0.0, (40.0, 20.0, "cycloidal"), (320.0, 0.0, "cycloidal"))))
    assert "undercut" in {f.code for f in findings_of(study)}
    proof = certificate_of(study, ("cam",))["roller_tangency"]
    assert proof.kept
    assert re.fullmatch(r"\d+ of 120 positions \(undercut\) left out", proof.note)


def test_what_enters_the_roller_without_an_undercut_is_wrong() -> None:
    study = Study(PUSHER, 360)
    flank, radius, reach = study.cam.flank, 0.012, study.reach
    dented = flank.profile.copy()
    dented[100] += 1e-6 * (flank.pitch[100] - flank.profile[100]) / radius
    wrong = replace(study.cam, flanks=(replace(flank, profile=dented),))
    for undercut in (True, False):  # the profile's own point is off even where others may be cut away
        found = tangency(wrong, study.design.drive.face, reach, 64.0 * EPS, lambda undercut=undercut: undercut)
        assert not found.kept
        assert found.value == pytest.approx(1e-6 / reach, rel=1e-3)
    entered = flank.profile.copy()
    entered[90] = flank.pitch[105] - 0.9 * (flank.pitch[105] - flank.profile[105])
    wrong = replace(study.cam, flanks=(replace(flank, profile=entered),))
    assert not tangency(wrong, study.design.drive.face, reach, 64.0 * EPS, lambda: False).kept


# -- a fall of hundredths of a degree ---------------------------------------------------------------------


@pytest.mark.parametrize("span", [0.09, 0.01])
def test_a_fall_of_hundredths_of_a_degree_keeps_its_residuals(
    span: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "short.toml"
    path.write_text(short_fall(span), encoding="utf-8")
    with np.errstate(all="raise", under="ignore"):
        assert main(["check", str(path)]) == 1
    printed = capsys.readouterr().out
    assert "certificate:" not in printed
    assert "error: undercut" in printed
    assert "the shaft" in printed


@pytest.mark.parametrize("command", [["check"], ["report"], ["export", "--out", "."]])
def test_a_residual_that_is_not_kept_is_no_success(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Here the balance of power is made wrong, which no design may do."""
    monkeypatch.chdir(tmp_path)
    save(four_bar(100.0, 30.0, 90.0, 70.0), "design.toml")
    run = [command[0], "design.toml", *command[1:]]
    assert main(run) == 0
    monkeypatch.setattr("core.dynamics.power_residual", lambda *_: np.full(3600, 1.19))
    assert main(run) == 1
    said = capsys.readouterr().out
    assert {"check": "power_balance = 1.19 exceeds its bound", "report": "NOT KEPT", "export": "summary.json"}[
        command[0]
    ] in said
