"""Random designs with a cam in space: what is refused names its field, what is computed is a number, findings are those of brute force."""

from __future__ import annotations

import numpy as np
import pytest
from random_spatial import random_design

from core.errors import DesignError, NoSolution
from core.project import loads
from core.spatial import rollers_at
from core.study import Study, certificate_of, findings_of, many
from core.study.quantities import quantities_of

ABSENT = {"rib_wall"}  # NaN where fewer than two rollers are in the blank
IMPOSSIBLE = {"undercut", "rib-vanishes", "turret-free"}
DESIGNS = 200


def steepest(study: Study) -> np.ndarray:
    """Pressure angle by cam angle in closed form: the least of the rollers in the blank, each its largest along the roller."""
    machine, y, slope = study.machine, study.surface.motion.y, study.surface.motion.y_1
    u = np.linspace(machine.inner, machine.outer, 201)[:, None]
    result = np.full(y.size, np.inf)
    for roller in rollers_at(machine, y):
        phi = y + roller.offset
        if machine.kind == "globoidal":
            tan = u * np.abs(slope) / (machine.lever - u * np.cos(phi))
        elif machine.slides:
            tan = np.abs(slope) / u
        else:
            tan = np.abs((machine.lever * slope + study.sense * u * np.sin(phi)) / (u * np.cos(phi)))
        angle = np.arctan(tan).max(axis=0)
        result = np.where(roller.touches, np.minimum(result, angle), result)
    return result


@pytest.mark.stress
def test_random_designs_have_numbers_or_a_field() -> None:
    counts = {"refused": 0, "impossible": 0, "computed": 0, "undercut": 0, "rib": 0}
    refused, impossible = set[str](), set[str]()
    for seed in range(DESIGNS):
        text = random_design(np.random.default_rng(seed))
        try:
            design = loads(text, "random")
        except DesignError as error:
            refused |= {fault.path for fault in error.faults}
            counts["refused"] += 1
            continue
        study = Study(design, 180)
        try:
            findings, certificate = findings_of(study), certificate_of(study)
        except NoSolution as error:
            impossible |= {error.field}
            counts["impossible"] += 1
            continue
        counts["computed"] += 1
        codes = {finding.code for finding in findings}
        if seed % 4 == 0:  # tables of designs call the same designs impossible
            figures = many(
                design, {"cam.roller_radius_mm": [design.drive.cam.roller_radius_mm]}, ["pressure_angle_deg:max"]
            )
            assert (figures.reason[0] in IMPOSSIBLE) == bool(codes & IMPOSSIBLE), seed
        assert all(finding.message and finding.field for finding in findings), seed
        assert "undercut" in codes or all(residual.kept for residual in certificate.values()), seed
        for stage in (stage for stage in ("motion", "cam", "dynamics") if stage in study.stages):
            for name, row in quantities_of(study, stage).items():
                assert not np.isnan(row.value(study)).any() or name in ABSENT, (seed, name)
        if not study.machine.taper and study.machine.rollers == 1 and not study.machine.is_rib:
            assert study.surface.pressure_angle == pytest.approx(steepest(study), abs=1e-4), seed
        counts["undercut"] += "undercut" in codes
        counts["rib"] += "rib-vanishes" in codes
    assert all(path.startswith("cam.") for path in refused)
    assert impossible == {"cam.length_mm", "cam.roller_taper_deg"}
    assert min(counts.values()) > 3, counts
