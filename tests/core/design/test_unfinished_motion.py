"""core.design.unfinished: a motion that makes no turn, or does not come back, by how much, and how it is closed."""

import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from core.design import Motion, NamedCurve, Segment, closed, part_faults, rise_gap, span_gap

CYCLOID = NamedCurve("cycloidal")


def motion(*rows: tuple[float, float, str]) -> Motion:
    return Motion(0.0, tuple(Segment(span, rise, NamedCurve(law)) for span, rise, law in rows))


def rows(made: Motion | None) -> list[tuple[float, float, str]]:
    assert made is not None
    assert part_faults(made, "motion") == []
    return [(s.span_deg, s.rise, s.curve.law) for s in made.segments]


def test_by_how_much_it_misses() -> None:
    unfinished = motion((90, 0, "dwell"), (300, 40.25, "cycloidal"), (90, -0.25, "cycloidal"))
    assert span_gap(unfinished) == 120.0
    assert rise_gap(unfinished) == 40.0


def test_the_next_segment_that_moves_brings_it_back() -> None:
    unfinished = motion((90, 0, "dwell"), (90, 40, "cycloidal"), (90, 0, "dwell"), (90, -30, "cycloidal"))
    assert rows(closed(unfinished, 1))[3] == (90, -40, "cycloidal")


def test_a_dwell_behind_it_becomes_the_return() -> None:
    unfinished = motion((90, 0, "dwell"), (90, 40, "c5"), (60, 0, "dwell"), (80, 0, "dwell"), (40, 0, "dwell"))
    assert rows(closed(unfinished, 1)) == [
        (90, 0, "dwell"),
        (90, 40, "c5"),
        (60, 0, "dwell"),
        (80, -40, "c6"),
        (40, 0, "dwell"),
    ]


def test_the_only_dwell_behind_it_is_cut_for_the_return() -> None:
    unfinished = motion((90, 0, "dwell"), (90, 40, "cycloidal"), (180, 0, "dwell"))
    assert rows(closed(unfinished, 1))[2:] == [(90, 0, "dwell"), (90, -40, "cycloidal")]


def test_where_nothing_lies_behind_it_it_is_cut_itself() -> None:
    unfinished = motion((180, 0, "dwell"), (180, 40, "cycloidal"))
    assert rows(closed(unfinished, 1))[1:] == [(90, 40, "cycloidal"), (90, -40, "cycloidal")]


def test_what_is_left_of_the_turn_becomes_the_return() -> None:
    unfinished = motion((90, 0, "dwell"), (90, 40, "cycloidal"), (60, 0, "dwell"))
    assert rows(closed(unfinished, 1))[3:] == [(120, -40, "modified-sine")]
    assert rows(closed(motion((90, 20, "cycloidal"), (90, -20, "cycloidal")), 0))[2:] == [(180, 0, "dwell")]


def test_the_next_span_that_can_gives_what_is_too_much() -> None:
    unfinished = motion((90, 0, "dwell"), (150, 20, "cycloidal"), (40, 0, "dwell"), (140, -20, "cycloidal"))
    assert [span for span, *_ in rows(closed(unfinished, 1))] == [90, 150, 40, 80]


def test_else_all_others_give_in_proportion() -> None:
    unfinished = motion((90, 0, "dwell"), (300, 20, "cycloidal"), (60, 0, "dwell"), (90, -20, "cycloidal"))
    assert [span for span, *_ in rows(closed(unfinished, 1))] == [22.5, 300, 15, 22.5]


def test_a_law_that_only_returns_gives_way_last() -> None:
    waiting = motion((90, 0, "dwell"), (90, 40, "c5"), (90, 0, "dwell"), (90, 0, "c6"))
    assert rows(closed(waiting, 1))[3] == (90, -40, "c6")
    wrong = motion((90, 0, "dwell"), (90, 40, "c6"), (90, 0, "dwell"), (90, -40, "c6"))
    assert rows(closed(wrong, 1))[1] == (90, 40, "c5")


@given(strategies.motions(), st.data())
def test_whatever_is_typed_can_be_closed_and_stays(whole: Motion, data: st.DataObject) -> None:
    """A span and a rise typed over those of one segment: the motion is made whole, and they stay where they fit."""
    index = data.draw(st.integers(0, len(whole.segments) - 1))
    typed = data.draw(st.floats(1.0, 300.0))
    segments = list(whole.segments)
    segments[index] = Segment(typed, data.draw(st.floats(0.5, 90.0)), CYCLOID)
    made = closed(Motion(whole.start, tuple(segments), whole.unit), index)
    assert made is not None
    assert part_faults(made, "motion") == []
    assert made.start == whole.start


@pytest.mark.parametrize("span", [359.0, 360.0])
def test_one_segment_over_the_whole_turn(span: float) -> None:
    assert [rise for _, rise, _ in rows(closed(motion((span, 40, "cycloidal")), 0))] == [40, -40]
