"""Laws and blends ranked in a design: their figures against closed forms and the study of each; who cannot be taken says why."""

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mechanisms import with_loads

from core.__main__ import main
from core.blend import Request, blend
from core.blend.best import with_blend
from core.design import Design, edited
from core.find import (
    FIGURES,
    blend_candidates,
    law_candidates,
    moving_segments,
    ranking,
    ranking_columns,
    ranking_row,
    sorted_rows,
)
from core.project import load
from core.study import Study, extremes_of, undercut_on

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
TWO_PI = 2.0 * math.pi
TEXTBOOK: dict[str, Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]] = {
    "simple-harmonic": lambda u: (
        (1 - np.cos(math.pi * u)) / 2, math.pi * np.sin(math.pi * u) / 2, math.pi**2 * np.cos(math.pi * u) / 2
    ),
    "cycloidal": lambda u: (u - np.sin(TWO_PI * u) / TWO_PI, 1 - np.cos(TWO_PI * u), TWO_PI * np.sin(TWO_PI * u)),
    "3-4-5": lambda u: (
        10 * u**3 - 15 * u**4 + 6 * u**5, 30 * u**2 - 60 * u**3 + 30 * u**4, 60 * u - 180 * u**2 + 120 * u**3
    ),
}  # fmt: skip


def elastic_rocker() -> Design:
    design = load(EXAMPLES / "rocker_cam.toml")
    rows = {"loads.follower_stiffness_n_per_mm": 60.0, "loads.follower_damping_ratio": 0.03, "cam.thickness_mm": 15.0,
            "cam.youngs_modulus_gpa": 206.0, "cam.poisson_ratio": 0.3, "cam.roller_youngs_modulus_gpa": 206.0,
            "cam.roller_poisson_ratio": 0.3}  # fmt: skip
    for path, value in rows.items():
        design = edited(design, path, value)
    return design


def test_torque_and_contact_force_of_laws_are_those_of_their_closed_forms() -> None:
    """A centred follower of 2 kg with a roller: F = P + k s + m ω² s'', T = F s', and F/cos α along the normal, tan α = s'/(R + s)."""
    mass, rate, preload = 2.0, 15e3, 40.0
    design = load(EXAMPLES / "kim_1990.toml")
    design = with_loads(
        design,
        follower_mass_kg=mass,
        spring_rate_n_per_mm=1e-3 * rate,
        preload_n=preload,
        friction=0.0,
        gravity_m_s2=0.0,
    )
    omega, motion = Study(design).omega, design.drive.motion
    assert motion is not None
    reach = 1e-3 * (design.drive.cam.base_radius_mm + design.drive.cam.roller_radius_mm)
    numbers = moving_segments(design)
    figures = [
        figure for figure in ranking_columns(design) if figure.key in ("peak_torque_nm", "least_contact_force_n")
    ]
    candidates = law_candidates(design, numbers)
    for slug, textbook in TEXTBOOK.items():
        u, torques, forces, low = np.linspace(0.0, 1.0, 20001), [], [preload], 0.0
        for number in numbers:
            segment = motion.segments[number]
            span, rise = math.radians(segment.span_deg), 1e-3 * segment.rise
            low = -rise if rise < 0.0 else 0.0
            s, v, a = textbook(u)
            lift, speed = low + rise * s, rise * v / span
            force = preload + rate * lift + mass * omega**2 * rise * a / span**2
            forces.append((force * np.hypot(1.0, speed / (reach + lift))).min())
            torques.append(np.abs(force * speed).max())
        row = ranking_row(slug, candidates[slug], figures)
        assert row.figures == pytest.approx((max(torques), min(forces)), rel=1e-6), slug
        assert row.problem == ""


def test_every_column_is_read_of_the_design_with_the_law() -> None:
    design = elastic_rocker()
    figures = ranking_columns(design)
    assert [figure.key for figure in figures] == [
        "peak_torque_nm",
        "residual_mm",
        "least_contact_force_n",
        "contact_pressure_mpa",
    ]
    candidates = law_candidates(design, [1])
    assert "dwell" not in candidates
    rows = {row.name: row for row in ranking({slug: candidates[slug] for slug in ("cycloidal", "c3", "c1")}, figures)}
    study = Study(edited(design, "motion.segments[1].law", "cycloidal"))
    found = extremes_of(study, "dynamics")
    torque, force = found["drive_torque"], found["elastic_contact_force"]
    residual = max(each.from_rest for each in study.follower_response.residuals) * 90.0
    pressure = found["contact_pressure"].high.value
    wanted = (max(-torque.low.value, torque.high.value), residual, force.low.value, 1e-6 * pressure)
    assert rows["cycloidal"].figures == pytest.approx(wanted, rel=1e-9)
    assert rows["c3"].figures == (None,) * 4
    assert rows["c3"].problem == "c3 is a return"
    assert rows["c1"].problem.startswith("velocity jumps by ")
    assert [row.name for row in sorted_rows(list(rows.values()), 0)] == ["cycloidal", "c3", "c1"]


def test_a_law_whose_cam_would_be_undercut_says_so() -> None:
    design = edited(load(EXAMPLES / "tappet_flat.toml"), "cam.base_radius_mm", 10.0)
    candidates = law_candidates(design, moving_segments(design))
    rows = list(
        ranking({slug: candidates[slug] for slug in ("cycloidal", "double-harmonic", "mcv66")}, ranking_columns(design))
    )
    taken = {row.name for row in rows if not row.problem}
    for row in rows:
        undercut = undercut_on(Study(candidates[row.name]()), "inner")
        assert undercut == (row.name not in taken)
        assert undercut == (None in row.figures)
        assert not undercut or "undercut" in row.problem
    assert 0 < len(taken) < 3


def test_an_elastic_shaft_winds_up_and_the_laws_are_sorted_by_it() -> None:
    design = load(EXAMPLES / "kim_1990.toml")
    figures = ranking_columns(design)
    candidates = law_candidates(design, moving_segments(design))
    rows = [ranking_row(slug, candidates[slug], figures) for slug in ("cycloidal", "simple-harmonic", "cv2")]
    column = [figure.key for figure in figures].index("wind_up_deg")
    assert [row.name for row in sorted_rows(rows, column)] == ["simple-harmonic", "cycloidal", "cv2"]
    assert [row.name for row in sorted_rows(rows, column, downwards=True)] == ["cycloidal", "simple-harmonic", "cv2"]
    wind_up = extremes_of(Study(candidates["cycloidal"]()), "stability")["wind_up"]
    largest = max(abs(wind_up.low.value), abs(wind_up.high.value))
    assert rows[0].figures[column] == pytest.approx(math.degrees(largest), rel=1e-9)


def test_blends_stand_beside_other_sequences_and_laws_for_their_strokes() -> None:
    design = load(EXAMPLES / "card_picker.toml")
    blended = blend(Request("DRRD", 30.0, 60.0, 260.0, settings={"h1": 10.0, "h4": 12.0}))
    candidates = blend_candidates(blended, lambda other: with_blend(design, other))
    assert next(iter(candidates)) == "-".join(blended.curves)
    figures = ranking_columns(design)
    wanted = ("-".join(blended.curves), "P1-P2", "cycloidal")
    rows = {name: ranking_row(name, candidates[name], figures) for name in wanted}
    assert "settings" in rows["P1-P2"].problem
    instead = candidates["cycloidal"]().drive.motion
    assert instead is not None
    strokes = [segment for segment in instead.segments if segment.rise]
    spans = [math.fsum(s.span_deg for s in blended.segments if s.rise * sign > 0.0) for sign in (1.0, -1.0)]
    assert [segment.curve.law for segment in strokes] == ["cycloidal", "cycloidal"]
    assert [segment.rise for segment in strokes] == pytest.approx([30.0, -30.0])
    assert [segment.span_deg for segment in strokes] == pytest.approx(spans)
    torque = extremes_of(Study(with_blend(design, blended)), "dynamics", ("drive_torque",))["drive_torque"]
    assert rows[wanted[0]].figures[0] == pytest.approx(max(-torque.low.value, torque.high.value), rel=1e-9)


def test_the_commands_rank_in_a_design(capsys: pytest.CaptureFixture[str]) -> None:
    rocker = str(EXAMPLES / "rocker_cam.toml")
    assert main(["laws", rocker, "--segment", "2", "--by", "least_contact_force_n", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert list(rows[0]) == ["law", "cv", "ca", "cj", "cm", "peak_torque_nm", "least_contact_force_n", "problem"]
    forces = [row["least_contact_force_n"] for row in rows if not row["problem"]]
    assert forces == sorted(forces)
    assert all(row["peak_torque_nm"] is None for row in rows if row["problem"])
    assert main(["laws", rocker, "--segment", "1"]) == 2
    assert capsys.readouterr().err == "--segment 1: no segment with a rise; allowed: 2 | 4\n"
    assert main(["laws", rocker, "--by", "wind_up_deg"]) == 2
    assert "allowed: peak_torque_nm | least_contact_force_n" in capsys.readouterr().err
    words = ["blend", "--type", "DRRD", "--stroke", "20", "--start", "30", "--end", "330", "--best", "acceleration"]
    assert main([*words, "--rank", str(EXAMPLES / "card_picker.toml")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("sequence ")
    at = next(i for i, line in enumerate(lines) if line.startswith("motion "))
    assert lines[0].split()[1] in {line.split()[0] for line in lines[at:]}
    assert lines[at].split()[1:3] == ["Peak", "torque"]


def test_a_column_is_named_with_its_unit() -> None:
    assert [(figure.key, figure.symbol) for figure in FIGURES] == [
        ("peak_torque_nm", "N·m"),
        ("wind_up_deg", "°"),
        ("residual_mm", "mm"),
        ("least_contact_force_n", "N"),
        ("contact_pressure_mpa", "MPa"),
        ("motor_rms_nm", "N·m"),
        ("peak_power_w", "W"),
        ("energy_j", "J"),
    ]


def test_an_optimal_law_is_ranked_with_its_settings() -> None:
    """The least rms jerk between rests is the 3-4-5; another law gets the optimal one of least acceleration."""
    design = load(EXAMPLES / "rocker_cam.toml")
    rows = {
        row.name: row.figures[0]
        for row in ranking(law_candidates(design, [1]), ranking_columns(design))
        if row.name in ("optimal", "parabolic", "3-4-5")
    }
    parabolic = rows["parabolic"]
    assert parabolic is not None
    assert 0.9 * parabolic < rows["optimal"] < parabolic, "its acceleration does not jump in the middle"
    typed = edited(edited(design, "motion.segments[1].law", "optimal"), "motion.segments[1].minimise", "rms_jerk")
    candidate = law_candidates(typed, [1])["optimal"]
    assert candidate() == typed
    assert ranking_row("optimal", candidate, ranking_columns(typed)).figures[0] == pytest.approx(
        rows["3-4-5"], rel=1e-9
    )
