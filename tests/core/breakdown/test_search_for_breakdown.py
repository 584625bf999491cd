"""Searches for numerical breakdown: hypothesis draws designs and leads them towards trouble for as long as it may.

KINDYNA_STRESS_SECONDS is the time of all searches together (``make stress``); every run of the tests searches for a second
or two. What one finds becomes a named case (``stress_cases``).
"""

import os
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mechanisms import ANGLES, buildable, cam_sliders
from sampled import spread
from stress_cases import CASES, Sample, cam, forces, linkage, motion

from core.design import Design, with_drive
from core.errors import NoSolution
from core.study import Study

SECONDS = float(os.environ.get("KINDYNA_STRESS_SECONDS", "600"))
SEARCHES = 4
ROUND = 40  # examples of one run of hypothesis; then the clock is looked at
EVERY_RUN = 0.3  # [s] of each search in the ordinary tests
FEW = 4  # examples between two looks at the clock there

Check = Callable[..., None]


def search(
    check: Check, *drawn: st.SearchStrategy[Any], seconds: float = SECONDS / SEARCHES, round_: int = ROUND
) -> int:
    """Run after run, each with another seed, until the time is up; returns how many runs."""
    # nothing is slow, nothing too rarely drawn: there is a budget
    free = settings(max_examples=round_, derandomize=False, deadline=None, suppress_health_check=list(HealthCheck))
    run = free(given(*drawn)(check))
    end, runs = time.monotonic() + seconds, 0
    while runs == 0 or time.monotonic() < end:
        run()
        runs += 1
    return runs


def kept(sample: Sample) -> None:
    assert sample.ratio <= 1.0, sample


# -- what is searched ---------------------------------------------------------------------------------------


def any_case(number: int, depth: float) -> None:
    """Every case, at any depth."""
    case = CASES[number]
    first, last = case.values[0], case.values[-1] or case.values[-2]
    value = first * (last / first) ** depth
    if case.name == "Many segments":
        value = float(round(value))
    kept(case.look(value))


def any_linkage_and_cam(design: Design, theta: float) -> None:
    kept(motion(design, theta))
    kept(linkage(design, theta))
    kept(cam(design, theta))


def any_forces(design: Design, theta: float) -> None:
    there = Study(design).at_theta(np.array([theta]))
    if float(there.dynamics.guide.jam[0]) < 1.0 - 1e-6:
        kept(forces(design, theta))


def refusal(study: Study) -> NoSolution | None:
    try:
        _ = study.linkage
    except NoSolution as error:
        return error
    return None


def any_stroke(design: Design, theta: float, power: float) -> None:
    """Any cam-driven slider with its motion stretched until arm and rod are all but in line: an answer within its bound,
    or a refusal that names the cam angles."""
    drive = design.drive
    segments = tuple(replace(s, rise=s.rise * 10.0**power) for s in drive.motion.segments)
    longer = with_drive(design, motion=replace(drive.motion, segments=segments))
    study = Study(longer, 90)
    told = refusal(study)
    if told is None:
        kept(linkage(longer, theta))
    else:
        assert told.cam_angles


NUMBERS = [i for i, case in enumerate(CASES) if "forces" not in case.name and "Guide" not in case.name]
QUICK = [i for i in NUMBERS if CASES[i].few >= 4]
SEARCHED: dict[str, tuple[Check, tuple[st.SearchStrategy[Any], ...]]] = {
    "no way into trouble": (any_case, (st.sampled_from(NUMBERS), st.floats(0.0, 1.0))),
    "no design's linkage or cam": (any_linkage_and_cam, (buildable(), ANGLES)),
    "no design's forces": (any_forces, (buildable(), ANGLES)),
    "no stroke up to the dead centre": (any_stroke, (cam_sliders(), ANGLES, st.floats(0.0, 1.2))),
}
"""What leads nowhere beyond the bound."""
assert len(SEARCHED) == SEARCHES


@pytest.mark.stress
@pytest.mark.parametrize("name", SEARCHED)
def test_nothing_leads_beyond_the_bound(name: str) -> None:
    check, drawn = SEARCHED[name]
    assert search(check, *drawn) > 0


@pytest.mark.parametrize("name", spread(SEARCHED, 2))
def test_a_short_search_on_every_run_finds_nothing_beyond_the_bound(name: str) -> None:
    check, drawn = SEARCHED[name]
    if check is any_case:
        drawn = (st.sampled_from(QUICK), *drawn[1:])
    assert search(check, *drawn, seconds=EVERY_RUN, round_=FEW) > 0
