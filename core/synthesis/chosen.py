"""Linkages that a user composes, judged like all others: of two chosen dyads, or with the other side link as the driver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.errors import MISSING, DesignError, Fault
from core.mechanism.driver_ranges import driver_ranges_of
from core.mechanism.mechanism import body_name
from core.mechanism.solving import unit_speed_kinematics
from core.synthesis.candidates import (
    COUPLER,
    CRANK_PIN,
    CRANK_PIVOT,
    FOUR_BAR,
    FRAME,
    SIDE_PIN,
    SIDE_PIVOT,
    driver_angles,
    linkage_of,
)
from core.synthesis.dyads import PIN, Dyad
from core.synthesis.judge import CIRCUIT, Answer, best_driven, judge
from core.synthesis.poses import body_positions, is_degenerate_pair, linkages_of, pose_dyads
from core.synthesis.task import PATH, POSES, Task

NOT_ASSEMBLED = "the links cannot be assembled at any position of the task"


def answer_of_dyads(task: Task, first: Dyad, second: Dyad) -> Answer:
    """The linkage of two dyads of a task of poses, judged; driven by the better one of its side links.

    Raises
    ------
    DesignError
        The two dyads make no linkage.
    """
    if first.kind != PIN:
        first, second = second, first
    if first.kind != PIN:
        raise _refused("dyads", "no link between two pins, which could be the crank", "at least one dyad with two pins")
    if first == second or is_degenerate_pair(first, second, task):
        raise _refused("dyads", "they are one dyad, or have a pivot in common", "two dyads with different pivots")
    if not pose_dyads(task).are_pair(first, second):
        raise _refused("dyads", "both fit the pivots of the same dyad", "one of dyad 1 and one of dyad 2")
    answer = best_driven(linkages_of(first, second, task), task)
    if answer is None:
        raise _refused("dyads", NOT_ASSEMBLED, "other dyads")
    return answer


def driven_by_other_link(answer: Answer, task: Task) -> Answer:
    """A four-bar with its other side link as the driver, judged again.

    Raises
    ------
    DesignError
        Where the other link slides, the task states the angles of the driver, or the linkage cannot be assembled.
    """
    problem = why_not_changed_over(answer, task)
    if problem:
        raise _refused("linkage.driver.link", problem, "a four-bar for poses, or for a path without driver_deg")
    candidate = answer.candidate
    frame, coupler = (candidate.linkage.by_number[number].places for number in (FRAME, COUPLER))
    first = Dyad(PIN, frame[CRANK_PIVOT], coupler[CRANK_PIN])
    second = Dyad(PIN, frame[SIDE_PIVOT], coupler[SIDE_PIN])
    z, angles = body_positions(task) if task.kind == POSES else _traced_positions(answer)
    changed = replace(
        candidate,
        linkage=linkage_of(second, first, complex(z[0]), float(angles[0])),
        positions=driver_angles(second, z, np.exp(1j * angles)),
    )
    judged = judge(changed, task)
    if judged is None:
        raise _refused("linkage.driver.link", NOT_ASSEMBLED, "the present driver")
    return replace(judged, cognates=answer.cognates)


def why_not_changed_over(answer: Answer, task: Task) -> str:
    """Why a linkage cannot be driven by its other side link; empty where it can."""
    if task.kind not in (POSES, PATH) or (task.path is not None and task.path.driver_deg):
        return "the task states the motion of the driver"
    if answer.candidate.kind != FOUR_BAR:
        return f"the other side link of a {answer.candidate.kind} has a sliding pair, and only a pinned link can be a crank"
    if task.kind == PATH and CIRCUIT in answer.defects:
        return "its driver does not reach all points of the path"
    return ""


def _traced_positions(answer: Answer) -> tuple[np.ndarray, np.ndarray]:
    """Origins (n,) [mm] and angles (n,) [rad] of the coupler at the points of a path."""
    linkage = answer.candidate.linkage
    kinematics = unit_speed_kinematics(linkage, answer.candidate.positions, driver_ranges_of(linkage))
    body = kinematics.bodies[body_name(COUPLER)]
    return 1e3 * body.fixed_point(0j)[0], body.angle[0]


def _refused(field: str, problem: str, allowed: str) -> DesignError:
    return DesignError([Fault(field, MISSING, problem, allowed)])
