"""Findings of a valve train: its lash against the ramps of the lobe, and its springs and its piston."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees, pi

from core.dynamics import HelicalSpring
from core.findings import ERROR, WARNING, Finding
from core.motion.extremes import Extreme, find_extremes
from core.study.extremes import extremes_beyond_lash, extremes_of
from core.study.piston import crank_at
from core.study.stages import memory
from core.study.study import Study, has_piston
from core.study.valve_springs import springs_of, surging_contact_force

MM = 1e3
ROUNDING = 1e-9  # of a ramp: a smaller excess of the lash is rounding


def lash_findings(study: Study) -> Iterator[Finding]:
    """A lash that a ramp of the lobe does not take up, so that the valve opens or seats on the flank.

    Raises NoAssembly where the train does not open the valve.
    """
    motion, lash = study.design.drive.motion, study.lash
    if lash is None:
        study.valve.closed  # noqa: B018
    if lash is None or motion is None or motion.lobe is None:
        return
    lobe = motion.lobe
    closing = lobe.closing.ramp_mm if lobe.closing is not None else None
    lift = MM * lash.at_motion - motion.start
    sides = (("opens", "ramp_mm", lobe.ramp_mm), ("seats", "closing.ramp_mm", closing))
    too_low = [(verb, key, ramp) for verb, key, ramp in sides if ramp is not None and lift > ramp * (1.0 + ROUNDING)]
    for verb, key, ramp in too_low[:1]:
        verb = "opens and seats" if closing is None or len(too_low) == 2 else verb
        values: dict[str, float | str] = {"verb": verb, "lash_mm": lift, "ramp_mm": ramp}
        yield Finding("lash-beyond-ramp", WARNING, f"motion.lobe.{key}", None, values)


def least_clearance(study: Study) -> Extreme | None:
    """Refined least clearance [m] of valve and piston, with its cam angle; None without a piston."""
    if not has_piston(study.design):
        return None
    return extremes_of(study, "linkage", ("piston_clearance",))["piston_clearance"].low


def piston_findings(study: Study) -> Iterator[Finding]:
    """A valve that hits the piston."""
    least = least_clearance(study)
    if least is not None and least.value <= 0.0:
        crank = float(crank_at(study, least.theta))
        values: dict[str, float | str] = {"clearance_mm": MM * least.value, "crank_deg": crank}
        yield Finding("piston-valve", ERROR, "valve.clearance_mm", degrees(least.theta), values)


def greatest_lift(study: Study) -> float:
    """Greatest lift of the valve [m]."""
    stage, name = ("linkage", "valve_lift") if study.design.drive.has_valve else ("motion", "displacement")
    return extremes_of(study, stage, (name,))[name].high.value


def spring_findings(study: Study) -> Iterator[Finding]:
    """Valve springs that bind, that fatigue, or whose surge takes the follower off the cam."""
    springs = springs_of(study.design)
    if not springs:
        return
    lift = greatest_lift(study)
    for i, spring in enumerate(springs):
        path, stress = f"loads.valve_springs[{i}]", spring.stress(lift)
        values: dict[str, float | str] = {"spring": f"valve spring {i + 1}" if len(springs) > 1 else "valve spring"}
        if (bind := spring.room - lift) <= 0.0:
            yield Finding(
                "coil-bind", ERROR, f"{path}.installed_mm", None, values | {"bind_mm": MM * bind, "lift_mm": MM * lift}
            )
        if (safety := spring.safety(lift)) is not None and safety < 1.0 - ROUNDING:
            fatigue = values | {"safety": safety, "value": 1e-6 * stress, "seat_mpa": 1e-6 * spring.stress(0.0)}
            yield Finding("spring-stress", WARNING, f"{path}.wire_mm", None, fatigue)
    yield from _surge_findings(study, springs)


def least_surging_contact(study: Study) -> Extreme | None:
    """Refined least contact force of an open valve with the surge of its springs [N].

    None where that cannot be calculated, or where the static springs do not hold the follower on the cam either.
    """
    if not study.has_disk or study.is_form_closed or study.jam is not None:
        return None
    if extremes_beyond_lash(study, "contact_force").low.value <= 0.0:
        return None

    def compute() -> Extreme:
        return find_extremes(lambda angles: {"": surging_contact_force(study.at(angles))}, study.program)[""].low

    least: Extreme = memory.get("surge", study.depends_on("dynamics"), compute)
    return least


def _surge_findings(study: Study, springs: Sequence[HelicalSpring]) -> Iterator[Finding]:
    """The true force of the springs leaves the follower where the static one holds it on the cam."""
    least = least_surging_contact(study)
    if least is not None and least.value <= 0.0:
        slowest = min(range(len(springs)), key=lambda i: springs[i].natural)
        values = {"force_n": least.value, "natural_hz": springs[slowest].natural / (2.0 * pi)}
        yield Finding(
            "spring-surge", WARNING, f"loads.valve_springs[{slowest}].active_coils", degrees(least.theta), values
        )
