"""Nothing runs away: what is larger than any design is refused before it is read, and what is large grows like its size."""

from dataclasses import replace
from pathlib import Path

import large_designs
import pytest
from counting import calls, cost
from sampled import spread, stressed

from core import project
from core.design import NamedCurve, Segment, faults, with_drive
from core.errors import DesignError
from core.study import Study, extremes_of, findings_of

LIFT = Path(__file__).parents[3] / "resources" / "examples" / "transfer_lift.toml"
TEXT = LIFT.read_text(encoding="utf-8")
HEAD = TEXT.split("[[motion.segments]]")[0]


def segments(count: int) -> str:
    segment = f'[[motion.segments]]\nlaw = "dwell"\nspan_deg = {360.0 / count!r}\n'
    return HEAD + segment * count + TEXT[TEXT.index("[follower]") :]


LOTS = {
    "segments": (segments(100_000), "motion.segments: 100000 segments are too many; allowed: at most 3600"),
    "empty segments": (
        HEAD + "[[motion.segments]]\n" * 100_000,
        "motion.segments: 100000 segments are too many; allowed: at most 3600",
    ),
    "empty segments in one line": (
        HEAD + f"segments = [{'{}, ' * 10_000}]\n",
        "motion.segments: 10000 segments are too many; allowed: at most 3600",
    ),
    "unknown keys": (
        TEXT + "".join(f"key{i} = {i}\n" for i in range(60_000)),
        f"lift.toml: {TEXT.count('=') + 60_000} entries (=) are too many for a design; allowed: at most 30000",
    ),
    "unknown keys of one table": (
        TEXT + "".join(f"key{i} = {i}\n" for i in range(600)),
        "loads: 615 keys are too many for a table; allowed: at most 500",
    ),
    "links": (
        "".join(f"[[linkage.links]]\nnumber = {i}\n" for i in range(101)),
        "linkage.links: 101 links are too many; allowed: at most 100",
    ),
    "tables": (
        "x = [" + "{}, " * 20_000 + "]",
        "lift.toml: 20000 tables ({) are too many for a design; allowed: at most 15000",
    ),
}


@pytest.mark.parametrize("name", spread(LOTS, 1))
def test_what_is_larger_than_any_design_is_refused_in_one_line_before_it_is_read(name: str) -> None:
    text, line = LOTS[name]

    def run() -> None:
        with pytest.raises(DesignError) as caught:
            project.loads(text, source="lift.toml")
        assert str(caught.value) == line

    found = cost(lambda: run)
    assert found.calls < 500_000
    assert found.peak < 4 * len(text) + 4_000_000


def test_an_edit_makes_no_design_that_no_file_may_hold() -> None:
    design = project.load(LIFT)
    assert not design.drive.is_linkage
    many = replace(design.drive.motion, segments=(Segment(0.05, 0.0, NamedCurve("dwell")),) * 7_200)
    design = with_drive(design, motion=many)
    assert [str(fault) for fault in faults(design)] == [
        "motion.segments: 7200 segments are too many; allowed: at most 3600"
    ]


@pytest.mark.parametrize(
    "case",
    [stressed(each) if "0.09" in each.what else each for each in large_designs.cases(segments=1000)],
    ids=lambda case: case.what,
)
def test_what_is_large_or_odd_stays_within_its_counts(case: large_designs.Case) -> None:
    found = cost(case.fresh)
    assert found.calls <= case.calls
    assert found.peak <= case.peak


def test_extremes_of_many_segments_take_so_many_calls_for_each() -> None:
    study = Study(project.loads(large_designs.many_segments(3000)))
    _ = study.linkage
    for stage in ("motion", "linkage"):
        assert calls(lambda stage=stage: extremes_of(study, stage)) <= 120 * 3000, stage


def test_a_flexible_shaft_is_not_followed_through_thousands_of_panels() -> None:
    text = large_designs.many_segments(3000).replace(
        "[shaft]\n", "[shaft]\ncamshaft_inertia_kg_m2 = 10.0\nstiffness_nm_per_rad = 1e5\n"
    )
    (note,) = [f for f in findings_of(Study(project.loads(text)), ("stability",)) if f.code == "no-stability"]
    assert "short panels, more than the 4000" in note.message
