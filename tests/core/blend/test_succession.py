"""Which curve may follow which, against Yang's Table 1 as printed, and the pictures of a blend, as the command gives them."""

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.__main__ import main
from core.plot import Figure

PRINTED = {
    "C1": ("0, +", "0, +", "0, 0", "C2 H2 CV1"), "C2": ("0, +", "+, 0", "0, 0", "C1 C3 C5 C6 P1"),
    "C3": ("+, 0", "0, -", "0, 0", "C4 H4 CV2"), "C4": ("+, 0", "-, 0", "0, 0", "C1 C3 C5 C6 P1"),
    "C5": ("0, +", "0, 0", "0, 0", "C1 C3 C6 P1"), "C6": ("+, 0", "0, 0", "0, 0", "C1 C3 C5 P1"),
    "H1": ("0, +", "0, +", "+, 0", "C2 H2 CV1"), "H2": ("0, +", "+, 0", "0, -", "H3 H6 P2"),
    "H3": ("+, 0", "0, -", "-, 0", "C4 H4 CV2"), "H4": ("+, 0", "-, 0", "0, +", "H1 H5"),
    "H5": ("0, +", "0, 0", "+, -", "H3 H6 P2"), "H6": ("+, 0", "0, 0", "-, +", "H1 H5"),
    "P1": ("0, +", "0, 0", "0, -", "H3 H6 P2"), "P2": ("+, 0", "0, 0", "-, 0", "C1 C3 C5 C6 P1"),
    "CV1": ("0, +", "+, +", "0, 0", "C2 H2"), "CV2": ("+, 0", "-, -", "0, 0", "C4 H4"),
}  # fmt: skip
"""Table 1; the displacement of CV2 as that of every other return, not as it is misprinted."""
PICKER = (
    "blend", "--type", "DRRD", "--stroke", "20", "--start", "30", "--end", "330", "--constant-velocity", "--set", "h1=1", "--set", "h3=1",
)  # fmt: skip


def text(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert main(["blend", "--table", *words]) == 0
    return capsys.readouterr().out


def test_the_table_is_the_printed_one(capsys: pytest.CaptureFixture[str]) -> None:
    rows = json.loads(text(capsys, "--json"))["curves"]
    assert [row["curve"] for row in rows] == list(PRINTED)
    for row in rows:
        signs = PRINTED[row["curve"]]
        assert (row["displacement"], row["velocity"], row["acceleration"]) == signs[:3]
        assert sorted(row["usable_next"]) == sorted(signs[3].split())
    lines = text(capsys).splitlines()
    assert lines[0].split() == ["curve", "s", "v", "a", "usable", "next"]
    assert len(lines) == 1 + len(PRINTED)


def test_why_another_curve_may_not_follow(capsys: pytest.CaptureFixture[str]) -> None:
    rows = json.loads(text(capsys, "h2", "--json"))["may_follow"]
    assert {name for name, words in rows.items() if words == "yes"} == {"H3", "H6", "P2"}
    assert rows["C4"] == "velocity would jump from rest to falling"
    assert rows["C1"] == "acceleration would jump from downwards to none"
    assert "  P2   may follow\n" in text(capsys, "H2")
    assert json.loads(text(capsys, "CV1", "--json"))["may_follow"]["CV1"].startswith(
        "a second CV1 extends the same curve"
    )


def test_the_states_along_a_motion(capsys: pytest.CaptureFixture[str]) -> None:
    """Fig. 1."""
    rows = json.loads(text(capsys, "--type", "RRR", "--json"))["sequences"]
    assert rows["H1-CV1-H2-H6"] == ["v 0, a +", "v +, a 0", "v +, a 0", "v 0, a -", "v 0, a +"]
    assert len(rows) == 9
    assert "(v 0, a 0) C1 (v +, a 0) C2 (v 0, a 0)" in text(capsys, "--type", "DRD")


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("blend", "--type", "DRD", "--stroke", "20"), "--start, --end: required for a motion"),
        (("blend", "--table", "X7"), "'X7': unknown curve; allowed: C1 | C2"),
        ((*PICKER, "--out", "picker.pdf"), "'picker.pdf': file of a picture; allowed endings: .png, .svg"),
    ],
)
def test_what_is_missing_or_unknown(words: tuple[str, ...], line: str, capsys: pytest.CaptureFixture[str]) -> None:
    with suppress(SystemExit):  # where the words themselves are wrong
        assert main(list(words)) == 2
    told = capsys.readouterr()
    assert line in told.err
    assert told.out == ""


def test_a_blend_is_painted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Displacement, velocity and acceleration on one axis, from where the motion starts to where it ends."""
    seen: list[Any] = []

    def painter(drawn: Any) -> Mapping[str, bytes]:
        seen.append(drawn)
        return {f"{drawn.name}.svg": b"svg", f"{drawn.name}.png": b"png"}

    assert main([*PICKER, "--out", str(tmp_path / "card picker.png")], painter=painter) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["card picker.png"]
    assert (tmp_path / "card picker.png").read_bytes() == b"png"
    (figure,) = seen
    assert isinstance(figure, Figure)
    assert [plot.upwards for plot in figure.plots] == ["Displacement, mm", "Velocity, mm/°", "Acceleration, mm/°²"]
    assert [plot.curves[0].family for plot in figure.plots] == ["displacement", "velocity", "acceleration"], (
        "each in its colour"
    )
    s, v, a = (plot.curves[0] for plot in figure.plots)
    assert (s.x[0], s.x[-1]) == (30.0, pytest.approx(330.0, abs=1e-9))
    assert (s.y.min(), s.y.max()) == (pytest.approx(0.0, abs=1e-12), pytest.approx(20.0, abs=1e-12))
    for curve, slope in ((s, v), (v, a)):
        grown = np.concatenate([[0.0], np.cumsum(0.5 * (slope.y[1:] + slope.y[:-1]) * np.diff(slope.x))])
        np.testing.assert_allclose(curve.y - curve.y[0], grown, atol=2e-4 * np.abs(curve.y).max())
    assert v.y.max() == pytest.approx(0.106118611333, abs=1e-12)
    assert [name for _, name in figure.plots[0].marks] == ["C1", "CV1", "H2", "P2"]
    capsys.readouterr()
    assert main([*PICKER, "--out", str(tmp_path / "none.svg")]) == 0
    assert "pictures left out" in capsys.readouterr().err
    assert not (tmp_path / "none.svg").exists()
