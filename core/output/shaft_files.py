"""A shaft with several drives as files: ``shaft.csv``, the tables of each drive in a folder of its slug, the summary of the whole."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from core.design import UNITS
from core.errors import NoSuchStage
from core.motion import degrees
from core.numerics.cancellation import checkpoint
from core.output.export import ANGLES_AT_ONCE, SUMMARY, csv_head, csv_lines, streams
from core.output.shaft_summary import answers, runs, shaft_summary
from core.output.summary import to_json
from core.study import ShaftStudy

SHAFT = "shaft.csv"
OF_SHAFT = frozenset({"motor_torque", "linear_motor_torque"})
"""Quantities that belong to the whole, and stand in no table of a drive."""

Column = tuple[str, Callable[[ShaftStudy], np.ndarray]]


def shaft_bounded(study: ShaftStudy) -> ShaftStudy:
    """The study whose findings and figures stand for it: more angles tell no more."""
    return study if study.samples <= ANGLES_AT_ONCE else ShaftStudy(study.design, ANGLES_AT_ONCE)


def shaft_columns(study: ShaftStudy) -> list[Column]:
    """Those that exist: where a drive has no answer its own and the sums are left out, where the motor stalls motor and speed."""

    def torque_of(name: str) -> Callable[[ShaftStudy], np.ndarray]:
        return lambda there: there.drive_torque(name)

    rows: list[Column] = [("torque_nm", lambda there: there.torque)] if answers(study) else []
    rows += [
        (f"{study.slugs[name]}_torque_nm", torque_of(name)) for name in study.carried if name not in study.failures
    ]
    if answers(study) and study.design.balancer is not None:
        rows.append(("balancer_torque_nm", lambda there: there.balancer_torque))
    if runs(study):
        rows.append(("motor_torque_nm", lambda there: there.motor_torque))
        rows.append(("speed_rpm", lambda there: there.speed / UNITS["rpm"].factor))
    return rows


def shaft_table(study: ShaftStudy) -> Iterator[bytes] | None:
    """``shaft.csv``, block by block; None where no drive has an answer."""
    rows = shaft_columns(study)
    if not rows:
        return None

    def made() -> Iterator[bytes]:
        names = ["machine_angle_deg", *(name for name, _ in rows)]
        yield csv_head(names)
        angles = degrees(study.samples)
        for begin in range(0, angles.size, ANGLES_AT_ONCE):
            checkpoint()
            part = angles[begin : begin + ANGLES_AT_ONCE]
            there = study if angles.size <= ANGLES_AT_ONCE else study.at_theta(np.deg2rad(part))
            yield csv_lines(names, [part, *(values(there) + 0.0 for _, values in rows)])

    return made()


def shaft_streams(study: ShaftStudy, stages: Sequence[str] = ()) -> dict[str, str | Iterator[bytes]]:
    """Path in the folder -> text, or its parts as they are computed, of all that the named stages (all, where none is named) give.

    Raises NoSuchStage for one that no drive has.
    """
    for name in stages:
        if name not in study.stages:
            raise NoSuchStage(name, study.stages)
    made: dict[str, str | Iterator[bytes]] = {}
    table = shaft_table(study) if not stages or "dynamics" in stages else None
    if table is not None:
        made[SHAFT] = table
    for name, each in study.drives.items():
        own = tuple(stage for stage in each.stages if stage in stages) if stages else ()
        if name not in study.failures and (own or not stages):
            made |= {f"{study.slugs[name]}/{file}": parts for file, parts in streams(each, own, OF_SHAFT).items()}
    balancer = study.balancer if study.design.balancer is not None and answers(study) else None
    if balancer is not None:
        own = tuple(stage for stage in balancer.stages if stage in stages)
        made |= (
            {f"balancer/{file}": parts for file, parts in streams(balancer, own, OF_SHAFT).items()}
            if own or not stages
            else {}
        )
    made[SUMMARY] = to_json(shaft_summary(shaft_bounded(study), stages))
    return made
