"""Searches for numerical breakdown: hypothesis draws designs and leads them towards trouble for as long as it may.

KINDYNA_STRESS_SECONDS is the time of all searches together. What one finds becomes a named case (``stress_cases``).
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
from stress_cases import CASES, Sample, cam, forces, linkage, motion

from core.design import SingleCam
from core.errors import NoAnswer
from core.study import Study

SECONDS = float(os.environ.get("KINDYNA_STRESS_SECONDS", "600"))
SEARCHES = 4
ROUND = 40  # examples of one run of hypothesis; then the clock is looked at


def search(check: Callable[..., None], *drawn: st.SearchStrategy[Any]) -> int:
    """Run after run, each with another seed, until the time is up; returns how many runs."""
    # nothing is slow, nothing too rarely drawn: there is a budget
    free = settings(max_examples=ROUND, derandomize=False, deadline=None, suppress_health_check=list(HealthCheck))
    run = free(given(*drawn)(check))
    end, runs = time.monotonic() + SECONDS / SEARCHES, 0
    while runs == 0 or time.monotonic() < end:
        run()
        runs += 1
    return runs


def kept(sample: Sample) -> None:
    assert sample.ratio <= 1.0, sample


@pytest.mark.stress
def test_no_way_into_trouble_leads_beyond_the_bound() -> None:
    """Every case, at any depth."""

    def check(number: int, depth: float) -> None:
        case = CASES[number]
        first, last = case.values[0], case.values[-1] or case.values[-2]
        value = first * (last / first) ** depth
        if case.name == "Many segments":
            value = float(round(value))
        kept(case.look(value))

    cases = [i for i, case in enumerate(CASES) if "forces" not in case.name and "Guide" not in case.name]
    assert search(check, st.sampled_from(cases), st.floats(0.0, 1.0)) > 0


@pytest.mark.stress
def test_no_design_leads_linkage_or_cam_beyond_the_bound() -> None:
    def check(design: SingleCam, theta: float) -> None:
        kept(motion(design, theta))
        kept(linkage(design, theta))
        kept(cam(design, theta))

    assert search(check, buildable(), ANGLES) > 0


@pytest.mark.stress
def test_no_design_leads_the_forces_beyond_the_bound() -> None:
    def check(design: SingleCam, theta: float) -> None:
        there = Study(design).at_theta(np.array([theta]))
        if float(there.dynamics.guide.jam[0]) < 1.0 - 1e-6:
            kept(forces(design, theta))

    assert search(check, buildable(), ANGLES) > 0


def refusal(study: Study) -> NoAnswer | None:
    try:
        _ = study.linkage
    except NoAnswer as error:
        return error
    return None


@pytest.mark.stress
def test_no_stroke_up_to_the_dead_centre_leads_beyond_the_bound() -> None:
    """Any cam-driven slider with its motion stretched until arm and rod are all but in line: an answer within its bound,
    or a refusal that names the cam angles."""

    def check(design: SingleCam, theta: float, power: float) -> None:
        drive = design.drive
        segments = tuple(replace(s, rise=s.rise * 10.0**power) for s in drive.motion.segments)
        longer = replace(design, drive=replace(drive, motion=replace(drive.motion, segments=segments)))
        study = Study(longer, 90)
        told = refusal(study)
        if told is None:
            kept(linkage(longer, theta))
        else:
            assert told.cam_angles

    assert search(check, cam_sliders(), ANGLES, st.floats(0.0, 1.2)) > 0
