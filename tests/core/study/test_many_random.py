"""Random designs: many at once against the study of each, by value, angle and reason; and the same bits in whatever order and block."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from face_cases import CASES, random_design
from linkages import KINDS, assembly

from core.design import Design, entries, get
from core.errors import NoSolution
from core.motion.extremes import piecewise_angles
from core.output.channels import channels
from core.study import Quantity, Study, extremes_of, findings_of, many
from core.varying import with_values

OF_CAMS = ("pressure_angle", "contact_force", "drive_torque", "acceleration", "profile_curvature", "contact_x")
FULL_BUDGET_S = 600
BUDGET_S = float(os.environ.get("KINDYNA_FUZZ_SECONDS", FULL_BUDGET_S))


def seeds(ordinary: int, fuzz: int) -> list[Any]:
    """So many in every run; up to ``fuzz`` by ``make fuzz``, of a smaller budget as small a part."""
    last = ordinary + round((fuzz - ordinary) * min(BUDGET_S / FULL_BUDGET_S, 1.0))
    return [*range(ordinary), *(pytest.param(seed, marks=pytest.mark.fuzz) for seed in range(ordinary, last))]


SEEDS = seeds(5, 1000)
OF_MOTIONS = seeds(2, 100)


def varied(design: Design, rng: np.random.Generator, by: float) -> dict[str, np.ndarray]:
    """Four of its numbers, of three designs within so many parts of the first; one of them mostly far off."""
    paths = [
        entry.path
        for table in ("follower", "linkage", "cam", "loads", "shaft")
        for entry in (entries(design, table) if table in design.tables else ())
        if type(entry.value) is float and entry.value and not entry.info.choices
    ]
    chosen = rng.choice(paths, min(4, len(paths)), replace=False).tolist()
    found = {path: get(design, path) * (1.0 + by * rng.uniform(-1.0, 1.0, 3)) for path in chosen}
    found[chosen[0]][2] *= rng.choice([0.4, 1.0, 2.5])
    return found


def one_of(design: Design, values: Mapping[str, np.ndarray], k: int) -> Design:
    return with_values(design, {path: float(row[k]) for path, row in values.items()})


@np.errstate(invalid="ignore", over="ignore", divide="ignore")  # infinite rates at dead centres
def assert_each_is_that_of_its_study(design: Design, values: Mapping[str, np.ndarray], names: tuple[str, ...]) -> None:
    rows = [row for row in channels(design, Study(design).stages) if row.name in names]
    found = many(design, values, [f"{row.slug}:{of}" for row in rows for of in ("min", "max")])
    for k in np.flatnonzero(found.reason != "out-of-range").tolist():
        study = Study(one_of(design, values, k))
        for row in rows:
            ends = [found.value[f"{row.slug}:{of}"][k] * row.unit.factor for of in ("min", "max")]
            try:
                own = extremes_of(study, row.stage, (row.name,))[row.name]
            except NoSolution as none:
                lost = none.code
            except KeyError:  # a link that goes round in this design, and not in the first
                lost = "no-value"
            else:
                lost = "jamming" if row.stage == "dynamics" and study.jam is not None else ""
            if lost:
                assert np.isnan(ends).all(), (row.name, k)
                assert found.reason[k].endswith(lost)
                continue
            sampled = np.abs(row.value(study.at(piecewise_angles(study.program))))
            size = max(abs(own.low.value), abs(own.high.value))
            near = (1e-4 if "curvature" in row.name else 1e-6) * size + 1e-9 * np.nanmax(sampled) + 1e-15
            assert ends == pytest.approx([own.low.value, own.high.value], rel=1e-12, abs=near), (row.name, k)
            steady = 1e4 * np.nanmedian(sampled)  # beside a dead centre a rate has the angle's rounding
            for of, end in (("min", own.low), ("max", own.high)) if size < steady else ():
                assert_stands_there(study, row, found.angle_deg[f"{row.slug}:{of}"][k], end.value, 10.0 * near)
        if not found.reason[k] or found.reason[k] == "undercut":
            errors = {each.code for stage in study.stages for each in findings_of(study, (stage,))}
            assert (found.reason[k] == "undercut") == any("undercut" in code for code in errors)


def assert_stands_there(study: Study, row: Quantity, angle_deg: float, value: float, near: float) -> None:
    """On either side of a join, for which an angle has two values."""
    if not np.isfinite(value):
        return
    values = []
    for beside in np.mod(np.deg2rad(angle_deg) + np.array([-1e-10, 0.0, 1e-10]), 2.0 * np.pi):
        with suppress(NoSolution):  # beyond a dead centre
            values.append(float(np.ravel(row.value(study.at_theta(np.array([beside]))))[0]))
    if len(values) < 3 or np.isnan(values).any():  # at a dead centre rounding decides
        return
    assert np.abs(np.array(values) - value).min() <= near + 1e-6 * abs(value), (row.name, angle_deg)


@pytest.mark.parametrize("seed", SEEDS)
def test_random_designs_are_those_of_their_studies(seed: int) -> None:
    rng = np.random.default_rng([seed, 28])
    if seed % 5 == 4:
        design, _ = assembly(seed, tuple(rng.choice(KINDS, rng.integers(1, 3)).tolist()))
        names = [name for stage in ("linkage", "dynamics") for name in extremes_of(Study(design), stage)]
        chosen = tuple(rng.choice(names, 6, replace=False).tolist())
        assert_each_is_that_of_its_study(design, varied(design, rng, 0.02), chosen)
    else:
        design = random_design(rng, *CASES[int(rng.integers(len(CASES)))])
        assert_each_is_that_of_its_study(design, varied(design, rng, 0.08), OF_CAMS)


@pytest.mark.parametrize("seed", OF_MOTIONS)
def test_random_motions_are_those_of_their_studies(seed: int) -> None:
    """Each span that moves by itself, and a rise."""
    rng = np.random.default_rng([seed, 29])
    design = random_design(rng, *CASES[int(rng.integers(len(CASES) - 6))])
    motion = design.drive.motion
    moving = [i for i, segment in enumerate(motion.segments) if segment.rise]
    values = {
        f"motion.segments[{i}].span_deg": motion.segments[i].span_deg * rng.uniform(0.8, 1.1, 3) for i in moving[:2]
    }
    values[f"motion.segments[{moving[0]}].rise_{motion.unit}"] = motion.segments[moving[0]].rise * rng.uniform(
        0.9, 1, 3
    )
    assert_each_is_that_of_its_study(design, values, OF_CAMS)


@pytest.mark.parametrize("seed", seeds(1, 30))
def test_no_order_and_no_block_changes_a_bit(seed: int) -> None:
    """Shuffled and split into blocks of other sizes."""
    rng = np.random.default_rng([seed, 30])
    design = random_design(rng, *CASES[int(rng.integers(len(CASES)))])
    values = {
        path: np.repeat(row, 60) * rng.uniform(0.99, 1.01, 180) for path, row in varied(design, rng, 0.05).items()
    }
    rows = [row for row in channels(design, Study(design).stages) if row.name in OF_CAMS]
    keys = [f"{row.slug}:{of}" for row in rows for of in ("max", "rms")]
    whole, order = many(design, values, keys), rng.permutation(180)
    cut = int(rng.integers(1, 179))
    parts = [
        many(design, {path: row[order][part] for path, row in values.items()}, keys)
        for part in (slice(0, cut), slice(cut, None))
    ]
    for key in keys:
        found = np.concatenate([part.value[key] for part in parts])
        assert found.tobytes() == whole.value[key][order].tobytes(), key
    assert np.concatenate([part.reason for part in parts]).tolist() == whole.reason[order].tolist()
