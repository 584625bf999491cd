"""The certificate of a study: residuals that are zero in exact arithmetic, with their bounds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from math import inf

import numpy as np

from core import cam, dynamics, shaft
from core.design import Motion, OptimalCurve, Segment
from core.design.curves import optimal_task, segment_shape, with_joined_ends
from core.errors import NoStability
from core.findings import LEAST_BOUND, Residual
from core.instant_centres import moving_collinearity
from core.laws import PieceTable
from core.mechanism import unit_speed_kinematics
from core.mechanism.groups import CONSISTENT
from core.motion import EPS
from core.motion.extremes import find_extremes
from core.numerics.roots import gauss
from core.study.camshaft import Camshaft
from core.study.extremes import undercut_on
from core.study.study import Study

OPTIMUM_GAP = 1e-3  # bound of the gap between a law and the best one
NO_OPTIMUM = 1e-9  # a least peak below it is 0: the law is straight
_CONTACTS = 24  # points of a flank in space that are compared with the roller at all angles
_POSITIONS = 120  # of the mechanism, at which Kennedy's theorem is checked
_MAX_BOUND = 1e-6  # of unit vectors: a greater bound would accept lines that clearly miss each other


def certificate_of(study: Study, stages: Sequence[str] = ()) -> dict[str, Residual]:
    """Name -> residual with its bound, of the named stages, or of all where none is named.

    Of a design that lists its drives: the residuals of every drive, with its slug before the name, and the power balance of
    the shaft.
    """
    stages, proof = stages or study.stages, dict[str, Residual]()
    for slug, drive in study.solved_drives.items():
        residuals = _drive_certificate(drive, [stage for stage in stages if stage in drive.stages])
        proof |= {f"{slug}.{name}".removeprefix("."): residual for name, residual in residuals.items()}
    if len(study.solved_drives) < len(study.drives):
        return proof
    if "dynamics" in stages and "power_balance" not in proof and study.camshaft.loading_drives:
        proof["power_balance"] = _power_balance(study.camshaft, proof)
    if "stability" in stages and "stability" in study.stages:
        with suppress(NoStability):
            proof |= study.flexible_shaft().certificate
    return proof


def _drive_certificate(study: Study, stages: Sequence[str]) -> dict[str, Residual]:
    proof: dict[str, Residual] = {}
    if "motion" in stages:
        last = study.program.joins[-1]
        stroke = float(np.ptp(study.motion.displacement[0])) or 1.0
        proof["motion_closure"] = Residual(abs(float(last.jump[0])) / stroke, 1e-9 * max(1.0, 1.0 / stroke))
        proof.update(_optimum_gaps(study.program.motion))
    if "linkage" in stages:
        agrees = CONSISTENT if study.mechanism.plan.redundant else 0.0  # by which redundant pairs may be open
        proof["loop_closure"] = _worst(study.linkage.residual, np.maximum(agrees, EPS * study.linkage.condition))
        if study.mechanism.ranged:
            proof["three_centres"] = _three_centres(study)
    if "cam" in stages:
        proof.update(_surface_residuals(study) if study.has_surface else _flank_residuals(study))
    if "dynamics" in stages:
        bound = np.maximum(1e-13, 64.0 * EPS * study.linkage.condition * _lever_ratio(study))
        parts = (study.linkage, study.shape, study.dynamics, study.loading)
        proof["power_balance"] = _worst(dynamics.power_residual(*parts), bound)
        proof["momentum_balance"] = _worst(dynamics.momentum_residual(*parts), bound)
        if study.vibrates:
            proof["elastic_follower_energy"] = study.follower_response.energy_residual
    return proof


def _local_gap(segment: Segment, whole_turn: bool) -> Residual:
    """Effect of a law in its machine over the least one of the linearised effect near it, less 1."""
    from core.study.machine_laws import law_in_machine  # imported here to save start-up time

    law = law_in_machine(segment, whole_turn)
    gap = law.value / law.least - 1.0 if 0.0 < law.value < inf else 0.0
    assert isinstance(segment.curve, OptimalCurve)
    remark = f"local: best of {len(law.starts)} starts, {segment.curve.intervals} intervals"
    return Residual(max(gap, 0.0), OPTIMUM_GAP, remark=remark)


class _SpanPieces:
    """Pieces of a law over its span 0 ... 1, whose extremes are searched in place of those of a turn."""

    def __init__(self, table: PieceTable) -> None:
        self.starts, self.ends = table.starts, np.append(table.starts[1:], 1.0)


def _optimum_gaps(motion: Motion) -> Iterator[tuple[str, Residual]]:
    """True peak or root mean square of every optimal law over the least one for its knots, less 1."""
    whole_turn = len(motion.segments) == 1
    for i in range(len(motion.segments)):
        segment = with_joined_ends(motion, i)
        if isinstance(segment.curve, OptimalCurve):
            from core.laws.optimal import optimal_law  # imported here to save start-up time

            if segment.curve.needs_machine:
                yield f"optimum_gap_{i + 1}", _local_gap(segment, whole_turn)
                continue
            task = optimal_task(segment.curve, segment, whole_turn)
            table = PieceTable(segment_shape(segment, whole_turn, f"motion.segments[{i}]").pieces)
            reached = (_root_mean_square if task.rms else _peak)(table, task.order)
            least = optimal_law(task).least
            gap = reached / least - 1.0 if least > NO_OPTIMUM else reached
            yield f"optimum_gap_{i + 1}", Residual(max(gap, 0.0), OPTIMUM_GAP)


def _peak(table: PieceTable, order: int) -> float:
    """Largest absolute derivative of a law."""
    extremes = find_extremes(
        lambda angles: {"": table.rows(angles.piece, angles.theta - table.starts[angles.piece])(order)},
        _SpanPieces(table),
    )[""]
    return max(-extremes.low.value, extremes.high.value)


def _root_mean_square(table: PieceTable, order: int) -> float:
    """Root mean square of a derivative of a law."""
    pieces = _SpanPieces(table)
    width, (nodes, weight) = pieces.ends - pieces.starts, gauss(table.derivatives[0].shape[0])
    rows = table.rows(np.repeat(np.arange(width.size), nodes.size), np.outer(width, nodes).ravel())
    return float(np.sqrt(np.outer(width, weight).ravel() @ rows(order) ** 2))


def _flank_residuals(study: Study) -> Iterator[tuple[str, Residual]]:
    """Instant centre and tangency of every flank; the two flanks of a groove have one centre."""
    shape, faces = study.cam, cam.faces_of(study.design.drive.face, study.design.drive.cam)
    # rounding grows with the distance from the cam centre, which a long motion makes greater than the base radius
    farthest = max(1.0, shape.extent / study.reach)
    for flank in shape.flanks:
        only, face, first = shape.only(flank.name), faces[flank.name], flank is shape.flank
        if first or flank.reference is not shape.reference:
            bound = 16.0 * EPS * study.linkage.condition * flank.centre.error_bound
            yield "instant_centre" if first else f"{flank.name}_centre", _worst(cam.centre_residual(only), bound)
        name = cam.row_of(face).proof if first else f"{flank.name}_tangency"
        undercut = partial(undercut_on, study, flank.name)
        yield name, cam.tangency(only, face, study.reach, 64.0 * EPS * farthest, undercut)


def _surface_residuals(study: Study) -> Iterator[tuple[str, Residual]]:
    """Both flanks of a cam in space: n · w = 0 where the normal meets the roller's axis; no point is inside the turning roller."""
    from core import spatial  # imported here to save start-up time

    shape = study.surface
    for side, motion in shape.tracks:
        surface = spatial.flank(shape.machine, motion, np.array([[shape.machine.middle]]), shape.sense, side)
        yield f"meshing_{side}", _worst(spatial.meshing(surface)[0], np.full(motion.theta.size, 64.0 * EPS))
        if not shape.machine.is_turret and shape.margin.min() > 0.0:
            step = max(1, motion.theta.size // _CONTACTS)
            reach = max(
                shape.machine.outer,
                float(np.abs(shape.motion.y).max()) if shape.machine.slides else shape.machine.lever,
            )
            bound = 64.0 * EPS * (1.0 + reach / shape.machine.radius)
            yield f"tangency_{side}", _worst(spatial.intrusion(shape.machine, surface, step), np.array([bound]))


def _worst(residual: np.ndarray, bound: np.ndarray) -> Residual:
    """The residual that is greatest relative to its bound, of residuals (n,) with bounds (n,)."""
    i = int(np.argmax(residual / np.maximum(bound, LEAST_BOUND)))
    return Residual(float(residual[i]), float(np.broadcast_to(bound, residual.shape)[i]))


def _three_centres(study: Study) -> Residual:
    """Kennedy's theorem at some of the angles, for enough triples of bodies to include every centre.

    Of a long linkage the triples include every centre on the frame and of a pair. Triples whose bound exceeds ``_MAX_BOUND``
    are left out.
    """
    step = max(1, study.theta.size // _POSITIONS)
    kinematics = unit_speed_kinematics(
        study.mechanism.linkage, study.drive.displacement[0][::step], study.driver_ranges
    )
    collinearity = moving_collinearity(kinematics, study.driver_ranges.plan.size)
    bound = 16.0 * EPS * study.linkage.condition[::step] * collinearity.error_bound
    valid = bound <= _MAX_BOUND
    worst = _worst(collinearity.zero[valid], bound[valid]) if valid.any() else Residual(0.0, 0.0)
    return replace(worst, left_out=valid.size - int(np.count_nonzero(valid)), cases=f"{valid.size} triples")


def _lever_ratio(study: Study) -> np.ndarray:
    """Size of the linkage over the lever of the contact force on the driver (n,), at least 1: the force's error grows with it."""
    size = study.driver_ranges.plan.size if study.driver_ranges.plan.driver.revolute else 1.0
    with np.errstate(divide="ignore"):
        return np.fmax(1.0, size / np.abs(study.dynamics.lever))


# -- several drives on a shaft -----------------------------------------------------------------------------


def _power_balance(camshaft: Camshaft[Study], proof: Mapping[str, Residual]) -> Residual:
    """Power of the shaft by its load curve less the power into kinetic energy, potential energy and friction of all drives.

    Relative to the peak of these terms.
    """
    terms, derived = [], 0.0
    for name in camshaft.loading_drives:
        study, residual = camshaft.drive_study(name), proof.get(f"{camshaft.slugs[name]}.power_balance")
        terms += dynamics.power_terms(study.linkage, study.dynamics, study.loading)
        derived += 0.0 if residual is None else residual.derived
    shaft_power = shaft.torque_at(camshaft.cams_load, camshaft.theta) * camshaft.omega
    peak = max(float(np.abs(term).max(initial=0.0)) for term in [*terms, shaft_power]) or 1.0
    return Residual(float(np.abs(shaft_power - sum(terms)).max()) / peak, derived)
