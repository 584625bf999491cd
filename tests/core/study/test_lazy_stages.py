"""What a stage only makes when it is asked for: each question makes its own answer, once, and no other."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from mechanisms import LIFT

from core.cam import shape
from core.study import Study, clear_caches, evaluations, findings_of

FLANK = ("pitch", "profile", "pressure_angle", "pitch_curvature", "pitch_curvature_slope", "profile_curvature")
TRAIN = ("travel", "coordinates", "residual", "condition", "singular")


def made(part: Any, names: tuple[str, ...]) -> set[str]:
    return {name for name in names if not callable(vars(part)[name])}


@pytest.fixture
def study() -> Iterator[Study]:
    clear_caches()
    yield Study(LIFT, 36)
    clear_caches()


def test_a_stage_makes_what_it_reads_of_those_before_it_and_nothing_else(study: Study) -> None:
    flank = study.cam.flank
    assert made(flank, FLANK) == set()
    _ = study.dynamics
    assert made(flank, FLANK) == made(study.linkage, TRAIN) == set()
    assert not made(study.cam.flank, ("centre",))


ANSWERS: dict[str, tuple[Callable[[Study], object], set[str]]] = {
    "profile": (lambda s: s.cam.flank.profile, {"profile"}),
    "pitch": (lambda s: s.cam.flank.pitch, {"pitch"}),
    "pressure angle": (lambda s: s.cam.flank.pressure_angle, {"pressure_angle"}),
    "curvature": (lambda s: s.cam.flank.profile_curvature, {"profile_curvature"}),
}


@pytest.mark.parametrize("name", ANSWERS)
def test_of_a_flank_only_what_is_asked_for_is_made(study: Study, name: str) -> None:
    ask, there = ANSWERS[name]
    ask(study)
    assert made(study.cam.flank, FLANK) == there
    assert not made(study.cam.flank, ("centre",))
    assert made(study.linkage, TRAIN) == ({"travel"} if name == "pressure angle" else set())


def test_the_curvatures_are_made_together_and_once(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    usual = shape.curvature
    monkeypatch.setattr(shape, "curvature", lambda *parts: asked.append(1) or usual(*parts))
    flank = study.cam.flank
    assert asked == []
    for _ in range(2):
        _ = flank.pitch_curvature, flank.pitch_curvature_slope, flank.profile_curvature
    assert asked == [1]


def test_the_searches_of_the_findings_solve_the_samples_of_a_turn_once(study: Study) -> None:
    """Linkage, cam and contact force are each sampled and each refined, and the shaft has angles of its own; no others are solved."""
    findings_of(study)
    most = {"linkage": 5, "cam": 4, "dynamics": 2}
    assert {name: evaluations[name] for name, count in most.items() if evaluations[name] > count} == {}
