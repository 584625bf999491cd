"""Driver ranges that follow those of a similar linkage, as while a joint is dragged, beside those that are searched."""

from __future__ import annotations

import numpy as np
import pytest
from linkages import chain

from core.design import Design
from core.followers.dragging import move_joint
from core.project import load
from core.study import Study, extremes_of
from kindyna_gui.places import example

SAMPLES = 360


def dragged(design: Design, joint: str, to: complex) -> Design:
    """The design with a joint shifted [m] at the first angle."""
    kinematics = Study(design, SAMPLES).at_theta(np.zeros(1)).linkage
    at = next(body.position(joint)[0] for body in kinematics.bodies.values() if joint in body.points)
    return move_joint(design, kinematics, joint, complex(at) + to, 9)


@pytest.mark.parametrize(
    ("name", "joint"), [("lecture_six_bar", "O1"), ("lecture_six_bar", "A"), ("lecture_six_bar", "B"), ("eight", "O4")]
)
def test_a_followed_branch_is_that_of_the_search(name: str, joint: str) -> None:
    """Change points that move, their bridges, the links' positions and angles."""
    design = chain(8) if name == "eight" else load(example(name))
    last = Study(design, SAMPLES)
    assert last.linkage.bodies
    for step in range(1, 5):
        design = dragged(design, joint, 1e-4 * step * (1.0 + 0.7j))
        followed, searched = Study(design, SAMPLES).follow(last), Study(design, SAMPLES)
        assert followed.linkage is not searched.linkage
        assert followed.follows
        assert followed.driver_ranges.ranges == searched.driver_ranges.ranges
        changes = [study.driver_ranges.changes for study in (followed, searched)]
        assert [c.joint for c in changes[0]] == [c.joint for c in changes[1]]
        assert [c.at for c in changes[0]] == pytest.approx([c.at for c in changes[1]], abs=1e-7)
        for body, pose in searched.linkage.bodies.items():
            other = followed.linkage.bodies[body]
            assert np.abs(other.origin[0] - pose.origin[0]).max() < 1e-7 * last.driver_ranges.plan.size
            assert np.abs(other.turn[0] - pose.turn[0]).max() < 1e-6
        last = followed


def test_where_a_dragged_linkage_locks_its_ranges_are_searched() -> None:
    design = load(example("lecture_six_bar"))
    last = Study(design, SAMPLES)
    assert last.linkage.bodies
    design = dragged(design, "O2", 0.002j)
    followed, searched = Study(design, SAMPLES).follow(last), Study(design, SAMPLES)
    assert followed.linkage is searched.linkage
    assert followed.driver_ranges is searched.driver_ranges
    assert not searched.driver_ranges.ranges[0].is_free
    assert not followed.follows


def test_dead_centres_are_followed_until_the_linkage_is_free_again() -> None:
    """The links have the positions of a search up to both ends of the crank's range."""
    design = dragged(load(example("lecture_six_bar")), "O2", 0.002j)
    last, ends = Study(design, SAMPLES), []
    assert last.linkage.bodies
    for _ in range(4):
        design = dragged(design, "O2", 2e-4 - 1e-4j)
        followed, searched = Study(design, SAMPLES).follow(last), Study(design, SAMPLES)
        assert followed.linkage is not searched.linkage
        assert followed.follows
        near, wanted = (study.driver_ranges.ranges for study in (followed, searched))
        assert [(r.low_joint, r.high_joint) for r in near] == [("", "D"), ("D", "D"), ("D", "")]
        assert [(r.low_joint, r.high_joint) for r in wanted] == [("", "D"), ("D", "D"), ("D", "")]
        assert [r.low for r in near] == pytest.approx([r.low for r in wanted], abs=1e-9)
        assert [r.high for r in near] == pytest.approx([r.high for r in wanted], abs=1e-9)
        ends.append(near[0].high)
        for body, pose in searched.linkage.bodies.items():
            error = np.abs(followed.linkage.bodies[body].origin[0] - pose.origin[0]).max()
            assert error < 1e-6 * last.driver_ranges.plan.size
        last = followed
    assert len(set(ends)) == 4
    design = dragged(design, "O2", -2.8e-3j)
    followed, searched = Study(design, SAMPLES).follow(last), Study(design, SAMPLES)
    assert searched.driver_ranges.ranges[0].is_free
    assert followed.driver_ranges is searched.driver_ranges


def test_what_is_computed_on_a_followed_branch_is_not_kept_for_the_typed_design() -> None:
    design = load(example("lecture_six_bar"))
    last = Study(design, SAMPLES)
    assert last.linkage.bodies
    design = dragged(design, "O1", 1e-4)
    followed, searched = Study(design, SAMPLES).follow(last), Study(design, SAMPLES)
    for name, extremes in extremes_of(searched, "linkage").items():
        assert extremes_of(followed, "linkage")[name] is not extremes
