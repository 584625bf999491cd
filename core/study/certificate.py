"""The certificate of a study: each residual that exact arithmetic would make zero, with its bound."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np

from core import cam, dynamics, shaft
from core.errors import NoStability
from core.findings import LEAST_BOUND, Residual
from core.instant_centres import moving_collinearity
from core.mechanism import unit_speed_kinematics
from core.mechanism.groups import CONSISTENT
from core.motion import EPS
from core.study.camshaft import Camshaft
from core.study.extremes import undercut_on
from core.study.study import Study

_POSITIONS = 120  # at which the centres are proven
_MEANINGLESS = 1e-6  # a bound above it, of unit vectors, would pass lines that plainly miss each other


def certificate_of(study: Study, stages: Sequence[str] = ()) -> dict[str, Residual]:
    """What proves the figures: name -> residual with its bound, of the named stages or of all. Of a design that lists its drives: those of
    each drive by its slug, and the power balance of the sum."""
    wanted, proof = stages or study.stages, dict[str, Residual]()
    for slug, each in study.solved_drives.items():
        found = _of_drive(each, [stage for stage in wanted if stage in each.stages])
        proof |= {f"{slug}.{name}".removeprefix("."): residual for name, residual in found.items()}
    if len(study.solved_drives) < len(study.drives):
        return proof
    if "dynamics" in wanted and "power_balance" not in proof and study.camshaft.loading_drives:
        proof["power_balance"] = _power_balance(study.camshaft, proof)
    if "stability" in wanted and "stability" in study.stages:
        with suppress(NoStability):
            proof |= study.flexible_shaft().certificate
    return proof


def _of_drive(study: Study, stages: Sequence[str]) -> dict[str, Residual]:
    proof: dict[str, Residual] = {}
    if "motion" in stages:
        last = study.program.joins[-1]
        stroke = float(np.ptp(study.motion.displacement[0])) or 1.0
        proof["motion_closure"] = Residual(abs(float(last.jump[0])) / stroke, 1e-9 * max(1.0, 1.0 / stroke))
    if "linkage" in stages:
        agrees = CONSISTENT if study.mechanism.plan.redundant else 0.0  # what pairs that are too many may be open
        proof["loop_closure"] = _worst(study.linkage.residual, np.maximum(agrees, EPS * study.linkage.condition))
        if study.mechanism.ranged:
            proof["three_centres"] = _three_centres(study)
    if "cam" in stages:
        proof.update(_of_flanks(study))
    if "dynamics" in stages:
        bound = np.maximum(1e-13, 64.0 * EPS * study.linkage.condition * _over_lever(study))
        parts = (study.linkage, study.shape, study.dynamics, study.loading)
        proof["power_balance"] = _worst(dynamics.power_residual(*parts), bound)
        proof["momentum_balance"] = _worst(dynamics.momentum_residual(*parts), bound)
        if study.vibrates:
            proof["elastic_follower_energy"] = study.follower_response.energy_residual
    return proof


def _of_flanks(study: Study) -> Iterator[tuple[str, Residual]]:
    """Instant centre and tangency of every flank: a groove's two share their centre."""
    shape, faces = study.cam, cam.faces_of(study.design.drive.face, study.design.drive.cam)
    # rounding grows with the distance, which a motion long against the base circle carries beyond it
    farthest = max(1.0, shape.extent / study.reach)
    for flank in shape.flanks:
        only, face, first = shape.only(flank.name), faces[flank.name], flank is shape.flank
        if first or flank.reference is not shape.reference:
            bound = 16.0 * EPS * study.linkage.condition * flank.centre.error_bound
            yield "instant_centre" if first else f"{flank.name}_centre", _worst(cam.centre_residual(only), bound)
        name = cam.row_of(face).proof if first else f"{flank.name}_tangency"
        undercut = partial(undercut_on, study, flank.name)
        yield name, cam.tangency(only, face, study.reach, 64.0 * EPS * farthest, undercut)


def _worst(residual: np.ndarray, bound: np.ndarray) -> Residual:
    """Of residuals with their own bounds (n,) the one that comes nearest to its bound, or lies farthest beyond."""
    i = int(np.argmax(residual / np.maximum(bound, LEAST_BOUND)))
    return Residual(float(residual[i]), float(np.broadcast_to(bound, residual.shape)[i]))


def _three_centres(study: Study) -> Residual:
    """Kennedy's theorem at some of the angles, for enough triples of bodies to hold every centre (``proving_triples``), of a long linkage
    every one on the frame and of a pair (``joining_triples``); a triple whose bound would be meaningless is left out where it is so."""
    step = max(1, study.theta.size // _POSITIONS)
    kinematics = unit_speed_kinematics(
        study.mechanism.linkage, study.drive.displacement[0][::step], study.driver_ranges
    )
    found = moving_collinearity(kinematics, study.driver_ranges.plan.size)
    bound = 16.0 * EPS * study.linkage.condition[::step] * found.error_bound
    well = bound <= _MEANINGLESS
    worst = _worst(found.zero[well], bound[well]) if well.any() else Residual(0.0, 0.0)
    return replace(worst, left_out=well.size - int(np.count_nonzero(well)), cases=f"{well.size} triples")


def _over_lever(study: Study) -> np.ndarray:
    """How many times longer the linkage is than the contact force's lever on the driver (n,), 1 at least: the force
    is as uncertain."""
    size = study.driver_ranges.plan.size if study.driver_ranges.plan.driver.revolute else 1.0
    with np.errstate(divide="ignore"):
        return np.fmax(1.0, size / np.abs(study.dynamics.lever))


# -- of several drives on a shaft --------------------------------------------------------------------------


def _power_balance(camshaft: Camshaft[Study], proof: Mapping[str, Residual]) -> Residual:
    """What the curve of the sum gives at these angles against where each drive, by its own angle, takes it: into kinetic and
    potential energy and friction; relative to the peak of these terms."""
    terms, derived = [], 0.0
    for name in camshaft.loading_drives:
        there, own = camshaft.drive_study(name), proof.get(f"{camshaft.slugs[name]}.power_balance")
        terms += dynamics.power_terms(there.linkage, there.dynamics, there.loading)
        derived += 0.0 if own is None else own.derived
    given = shaft.value(camshaft.cams_load, camshaft.theta) * camshaft.omega
    peak = max(float(np.abs(term).max(initial=0.0)) for term in [*terms, given]) or 1.0
    return Residual(float(np.abs(given - sum(terms)).max()) / peak, derived)
