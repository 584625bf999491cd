"""A table as the curve of one segment: stretched or as it is, from rest or joined to its neighbours."""

from pathlib import Path

import numpy as np
import pytest
from large_designs import EXAMPLES

from core.__main__ import main
from core.design import join_angles, missing_of_motion
from core.measured import TableError, read_sheet
from core.measured.segment_table import segment_from_table
from core.motion import findings, program
from core.project import load

LIFT = load(EXAMPLES / "transfer_lift.toml")
U = np.linspace(0.0, 1.0, 61)
CYCLOID = "deg;mm\n" + "\n".join(f"{100 + 60 * u};{5 + 30 * (u - np.sin(2 * np.pi * u) / (2 * np.pi))}" for u in U)


def sheet(text: str) -> object:
    return read_sheet(text.encode(), "t.csv")


def test_a_table_is_stretched_to_span_and_rise_of_its_segment() -> None:
    motion = segment_from_table(LIFT, 1, sheet(CYCLOID)).drive.motion
    assert (motion.segments[1].span_deg, motion.segments[1].rise, motion.segments[1].curve.law) == (
        41.5,
        -150.0,
        "table",
    )
    at = 35.0 + 41.5 * np.array([0.25, 0.5, 0.8])
    compiled = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad(at))).y[0]
    u = np.array([0.25, 0.5, 0.8])
    assert 1e3 * y == pytest.approx(150.0 - 150.0 * (u - np.sin(2 * np.pi * u) / (2 * np.pi)), abs=1e-5)
    assert findings(compiled) == []


def test_as_it_is_its_neighbours_give_or_take(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made = segment_from_table(LIFT, 3, sheet(CYCLOID), as_is=True)
    motion = made.drive.motion
    assert (motion.segments[3].span_deg, motion.segments[3].rise) == (60.0, 30.0)
    assert [s.span_deg for s in motion.segments] == [35.0, 41.5, 207.0, 60.0, 16.5]
    assert missing_of_motion(made) == []
    file, table = tmp_path / "lift.toml", tmp_path / "t.csv"
    file.write_text((EXAMPLES / "transfer_lift.toml").read_text(encoding="utf-8"), encoding="utf-8")
    table.write_text(CYCLOID, encoding="utf-8")
    assert main(["measured", str(table), "--segment", "4", "--as-is", "--into", str(file)]) == 0
    assert load(file).drive.motion == motion
    assert "61 rows, span 60 deg, rise 30 mm" in capsys.readouterr().out
    assert main(["measured", str(table), "--segment", "6", "--into", str(file)]) == 2
    assert "allowed: 1 ... 5" in capsys.readouterr().err


def test_its_ends_take_velocity_and_acceleration_of_its_neighbours() -> None:
    """The second half of a harmonic, cut in two, from a table of its values: joined it goes on as before."""
    from dataclasses import replace

    from core.design import NamedCurve, Segment, with_motion

    rows = ((90.0, 20.0, "h1"), (90.0, 20.0, "h2"), (180.0, -40.0, "simple-harmonic"))
    motion = replace(LIFT.drive.motion, start=0.0, segments=tuple(Segment(a, b, NamedCurve(c)) for a, b, c in rows))
    design = with_motion(LIFT, motion)
    text = "\n".join(f"{90 * u:.6f} {20 * np.sin(np.pi / 2 * u):.9f}" for u in np.linspace(0.0, 1.0, 31))
    joined = segment_from_table(design, 1, sheet(text), joined=True).drive.motion
    first, last = joined.segments[1].curve.points[0], joined.segments[1].curve.points[-1]
    assert (first.velocity, first.acceleration) == pytest.approx((20.0 * np.pi / 180.0, 0.0), abs=1e-9)
    assert (last.velocity, last.acceleration) == pytest.approx((0.0, -20.0 * (np.pi / 180.0) ** 2), abs=1e-9)
    assert not any(j.jumps[1:3].any() for j in program(joined).joins[:2])
    at_rest = segment_from_table(design, 1, sheet(text)).drive.motion
    assert program(at_rest).joins[0].jumps[1]
    assert join_angles(at_rest) == join_angles(motion)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0 1\n1 ERR\n2 3", "line 2: '1 ERR'"),
        ("0 1\n2 3\n1 4", "line 3: angle 1 after 2"),
        ("0 1\n1 2\n2 1", "ends where it starts"),
        ("0 0.001\n120 9.998\n240 10.002\n355 0.004", "full turn as a measured motion"),
    ],
)
def test_bad_rows_are_named(text: str, said: str) -> None:
    with pytest.raises(TableError, match=said):
        segment_from_table(LIFT, 1, sheet(text))
