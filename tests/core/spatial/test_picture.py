"""Facets of a cam in space bound its body: volumes in closed form, and flanks whose points touch their rollers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.spatial import AHEAD, Machine, MotionRows, flank_patches, roller_tracks
from core.spatial.picture import Blank, Facets, cam_facets, roller_facets

GROOVE = Machine("barrel", "mm", 0.008, 0.0, 0.04, 0.052, 1, 0.0, 0.0002, 0.0, 0.08, False)
RIB = replace(GROOVE, distance=0.03, play=0.0, is_rib=True)
ANGLES, OUTER, BORE = 720, 0.05, 0.015


def still(theta: np.ndarray) -> MotionRows:
    return MotionRows(theta, 0.0 * theta, 0.0 * theta, 0.0 * theta)


def volume(facets: Facets) -> float:
    """Volume inside the facets, by the divergence theorem on both triangles of each: ∫ p · n dA/3."""
    total = 0.0
    for a, b, c in ((0, 1, 2), (0, 2, 3)):
        p, q, r = (facets.corners[:, k] for k in (a, b, c))
        area = np.cross(q - p, r - p)
        outwards = np.sign((area * facets.normals).sum(axis=1))
        total += float((outwards * ((p + q + r) / 3.0 * area).sum(axis=1)).sum()) / 6.0
    return total


@pytest.mark.parametrize(("machine", "between", "width"), [(GROOVE, 0.04, 0.0162), (RIB, OUTER, 0.014)])
def test_a_blank_has_the_volume_of_its_rings(machine: Machine, between: float, width: float) -> None:
    """Of a dwell: a ring of the width of groove or rib, and the rest of the length with the other radius."""
    facets = cam_facets(machine, still, 1.0, Blank(OUTER, BORE, 0.0), ANGLES)
    outside = OUTER if machine is GROOVE else machine.inner
    polygon = np.sin(2.0 * np.pi / ANGLES) / (2.0 * np.pi / ANGLES)  # area of a polygon over that of its circle
    ring = np.pi * polygon * ((0.08 - width) * (outside**2 - BORE**2) + width * (between**2 - BORE**2))
    assert volume(facets) == pytest.approx(ring, rel=2e-4)


def test_rollers_have_the_volume_of_their_cylinders() -> None:
    facets = roller_facets(RIB, 0.01)
    polygon = np.sin(2.0 * np.pi / 20) / (2.0 * np.pi / 20)
    assert volume(facets) == pytest.approx(2.0 * np.pi * polygon * 0.008**2 * 0.012, rel=1e-9)
    assert sorted({round(z, 9) for z in (facets.corners[..., 2].min(), facets.corners[..., 2].max())}) == [
        -0.013,
        0.033,
    ]


def test_every_roller_of_a_turret_has_its_flanks_while_it_is_in_the_blank() -> None:
    turret = Machine("globoidal", "deg", 0.016, 0.0, 0.048, 0.064, 6, 0.12, 0.0, 0.0, 0.1, True)

    def even(theta: np.ndarray) -> MotionRows:
        return MotionRows(theta, theta / 6.0, np.full(theta.size, 1.0 / 6.0), 0.0 * theta)

    assert [track.number for track in roller_tracks(turret)] == [1, 2, 3, 4, 5, 6]
    assert [round(np.rad2deg(track.offset)) for track in roller_tracks(turret)] == [0, 60, 120, 180, 240, 300]
    limit = np.arcsin(0.05 / 0.056)
    patches = list(flank_patches(turret, even, 1.0, 360, 3))
    for patch in patches:
        phi = patch.theta / 6.0 + (patch.number - 1) * np.pi / 3.0
        assert (np.abs(np.mod(phi + np.pi, 2.0 * np.pi) - np.pi) <= limit + 1e-9).all()
    # one turn moves the turret by a pitch: over it each position of a roller occurs once
    steps = sum(patch.theta.size - 1 for patch in patches if patch.side == AHEAD)
    assert steps == pytest.approx(2.0 * limit / (np.pi / 3.0) * 360, abs=4)
