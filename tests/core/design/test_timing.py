"""Timing of drives on one shaft: how far a drive or a join can be turned, what stays where it is, overlaps, the table of events."""

import csv
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.design import (
    Design,
    Motion,
    Segment,
    TimingRow,
    add_drive,
    as_list,
    contradiction,
    curve_of,
    distances,
    events,
    events_at,
    faults,
    join_room,
    machine_joins,
    milliseconds,
    moving,
    phase_room,
    remove_drive,
    rename_drive,
    reorder_timing,
    together,
    turn_drive,
    turn_join,
    with_assumed,
    with_phase,
    with_timing,
)
from core.output.timing import bands, events_csv
from core.project import load

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
UNIT = load(EXAMPLES / "transfer_unit.toml")
CYCLOID = curve_of("cycloidal")


def lifted(*spans: float) -> Motion:
    """Dwell, rise, dwell, return: 10 mm up and down."""
    dwell, up, high, down = spans
    return Motion(
        0.0, (Segment(dwell, 0.0), Segment(up, 10.0, CYCLOID), Segment(high, 0.0), Segment(down, -10.0, CYCLOID))
    )


@pytest.fixture(scope="module")
def pair() -> Design:
    """Two drives: A rises from 60 to 120 and returns from 300 to 360; B rises from 130 to 190 and returns from 10 to 100, turned by
    100."""
    alone = load(EXAMPLES / "tappet_knife.toml")
    both = add_drive(as_list(alone, "A"), alone, "B")
    a, b = both.drives
    drives = (
        replace(a, motion=lifted(60.0, 60.0, 180.0, 60.0)),
        replace(b, motion=lifted(30.0, 60.0, 180.0, 90.0), phase_deg=100.0),
    )
    rows = (TimingRow("A.rise.1.end", "B.rise.1.start", 4.0), TimingRow("B.return.1.end", "A.rise.1.end", 15.0))
    return replace(both, drives=drives, timing=rows, shaft=replace(both.shaft, speed_rpm=100.0))


def test_a_drive_turns_as_far_as_both_its_neighbours_leave_room(pair: Design) -> None:
    assert [(d.after_deg, d.spare_deg) for d in distances(pair)] == [(10.0, 6.0), (20.0, 5.0)]
    room = phase_room(pair, 1)  # B: back until it starts 4 after A's end, on until its return ends 15 before that
    assert (room.low, room.high) == (-6.0, 5.0)
    assert (room.low_row, room.high_row) == (0, 1)
    assert (room.within(9.0), room.stop(9.0), room.within(-2.0), room.stop(-2.0)) == (5.0, 1, -2.0, None)
    assert (phase_room(pair, 0).low, phase_room(pair, 0).high) == (-5.0, 6.0)
    for by in (room.low, room.high):
        there = turn_drive(pair, 1, 100.0 + by)
        assert all(row.kept for row in distances(there))
        beyond = turn_drive(pair, 1, 100.0 + 1.01 * by)
        assert not all(row.kept for row in distances(beyond))
    free = phase_room(replace(pair, timing=()), 1)
    assert (free.low, free.high) == (-np.inf, np.inf)


def test_a_row_that_is_broken_already_holds_nothing_back(pair: Design) -> None:
    broken = with_timing(pair, 0, TimingRow("A.rise.1.end", "B.rise.1.start", 12.0))
    assert not distances(broken)[0].kept
    assert phase_room(broken, 1).high == 5.0
    assert phase_room(broken, 1).low_row == 1, "the second counts from half a turn on as broken from the other side"
    both = replace(
        pair,
        timing=(TimingRow("A.rise.1.end", "B.rise.1.start", 12.0), TimingRow("B.rise.1.start", "A.rise.1.end", 12.0)),
    )
    assert sorted(contradiction(both)) == [0, 1]
    assert phase_room(both, 1).low == -np.inf, "nothing is kept, so that all can be sorted out"


@pytest.mark.parametrize("join", [0, 1, 2, 3])
def test_a_join_is_turned_alone_also_the_one_at_the_start_of_the_turn(pair: Design, join: int) -> None:
    before = machine_joins(pair, 1)
    moved = turn_join(pair, 1, join, 1.5)
    after = machine_joins(moved, 1)
    assert after == tuple((angle + 1.5 * (k == join)) % 360.0 for k, angle in enumerate(before))
    assert faults(moved) == []
    there, back = moved.drives[1].motion, turn_join(moved, 1, join, -1.5)
    assert there is not None
    assert (there.start, [s.rise for s in there.segments]) == (0.0, [0.0, 10.0, 0.0, -10.0])
    assert back == pair
    turned = {name for name, angle in events(moved).items() if angle != events(pair)[name]}
    assert turned == set(events_at(pair, 1, join)), "no other event has moved"


def test_a_join_stops_at_its_neighbours_and_at_what_must_be_kept(pair: Design) -> None:
    assert events_at(pair, 1, 1) == ("B.rise.1.start",)
    start = join_room(pair, 1, 1)
    assert (start.low, start.low_row) == (-6.0, 0)
    assert (start.high, start.high_row) == (59.5, None)
    end = join_room(pair, 1, 0)  # of B's return, at machine angle 100
    assert events_at(pair, 1, 0) == ("B.return.1.end",)
    assert (end.low, end.low_row, end.high, end.high_row) == (-89.5, None, 5.0, 1)
    alone = replace(pair, drives=(replace(pair.drives[0], name=None),), timing=())
    assert (join_room(alone, 0, 0).low, join_room(alone, 0, 0).high) == (0.0, 0.0), "a drive alone has no phase"


def test_where_two_drives_move_together_over_the_start_of_the_turn_too(pair: Design) -> None:
    assert moving(pair, 0) == ((60.0, 120.0), (300.0, 360.0))
    assert moving(pair, 1) == ((10.0, 100.0), (130.0, 190.0))
    assert together(pair, 0, 1) == together(pair, 1, 0) == ((60.0, 100.0),)
    over = turn_drive(pair, 1, 50.0)  # B: return from 320 to 50, rise from 80 to 140
    assert moving(over, 1) == ((80.0, 140.0), (320.0, 410.0))
    assert together(over, 0, 1) == ((80.0, 120.0), (320.0, 360.0))
    late = turn_drive(over, 0, 20.0)  # A: 80 to 140 and 320 to 380
    assert together(late, 0, 1) == ((80.0, 140.0), (320.0, 380.0))
    assert milliseconds(pair, 40.0) == pytest.approx(40.0 / 360.0 * 600.0)
    assert together(UNIT, 0, 1) == ()


def test_bands_hold_each_motion_by_the_machine_angle(pair: Design) -> None:
    a, b = bands(pair)
    assert (a.stroke, a.unit, b.joins) == (pytest.approx(10.0), "mm", (100.0, 130.0, 190.0, 10.0))

    def level(band: object, angle: float) -> float:
        return float(band.level[np.flatnonzero(band.angles == angle)[0]])  # type: ignore[attr-defined]

    u = 15.0 / 60.0
    assert level(a, 75.0) == pytest.approx(u - np.sin(2 * np.pi * u) / (2 * np.pi))
    assert level(b, 145.0) == pytest.approx(u - np.sin(2 * np.pi * u) / (2 * np.pi))
    assert [level(b, angle) for angle in (0.0, 10.0, 100.0, 130.0, 190.0, 360.0)] == pytest.approx(
        [1.0, 1.0, 0.0, 0.0, 1.0, 1.0]
    )


def test_events_as_a_table_with_angle_and_time() -> None:
    named = replace(UNIT, drives=(replace(UNIT.drives[0], name='Feed, "left"'), *UNIT.drives[1:]), timing=())
    rows = list(csv.reader(io.StringIO(events_csv(named))))
    assert rows[0] == ["event", "machine_angle_deg", "time_ms"]
    assert rows[1] == ['Feed, "left".rise.1.end', "32.0", repr(32.0 / 360.0 * 3000.0)]
    angles = [float(row[1]) for row in rows[1:]]
    assert angles == sorted(angles)
    assert len(angles) == 16
    assert {row[0]: float(row[1]) for row in rows[1:]} == events(named)


@pytest.mark.parametrize("name", ["=cmd|' /C calc'!A0", "+1", "-2", "@sum(a1)"])
def test_a_name_that_a_spreadsheet_would_compute_is_words(name: str) -> None:
    named = replace(UNIT, drives=(replace(UNIT.drives[0], name=name), *UNIT.drives[1:]), timing=())
    cells = [row[0] for row in csv.reader(io.StringIO(events_csv(named)))]
    assert not [cell for cell in cells if cell[0] in "=+-@"]
    assert f"'{name}.rise.1.end" in cells


def test_a_drive_that_rows_name_by_its_slug_is_renamed_and_removed_with_them() -> None:
    rows = tuple(TimingRow(row.first.lower(), row.second.lower(), row.least_deg) for row in UNIT.timing)
    design = replace(UNIT, timing=rows)
    assert distances(design) == distances(UNIT)
    renamed = rename_drive(design, 0, "Transport")
    assert faults(renamed) == []
    assert distances(renamed) == distances(UNIT)
    fewer = remove_drive(design, 0)
    assert faults(fewer) == []
    assert len(fewer.timing) == 2
    assert phase_room(design, 1) == phase_room(UNIT, 1)


def test_rows_of_the_timing_are_removed_copied_and_moved_with_their_marks() -> None:
    design = with_assumed(replace(UNIT, assumed=()), "timing[2].least_deg", True)
    fewer = reorder_timing(design, [0, 2, 3, 4, 5])
    assert fewer.timing == (*UNIT.timing[:1], *UNIT.timing[2:])
    assert fewer.assumed == ("timing[1].least_deg",)
    more = reorder_timing(design, [0, 1, 2, 2, 3, 4, 5])
    assert more.assumed == ("timing[2].least_deg", "timing[3].least_deg")
    added = with_timing(design, 6, TimingRow("Feed.rise.1.end", "Clamp.return.1.start", 1.0))
    assert len(added.timing) == 7
    assert faults(added) == []
    assert distances(with_phase(added, 1, 240.0))[6].after_deg == 55.0
