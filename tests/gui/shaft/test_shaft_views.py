"""kindyna_gui.shaft: torque, flywheel and stability of a whole shaft in the window, by mouse."""

from dataclasses import replace
from functools import partial
from math import degrees
from pathlib import Path
from shutil import copyfile

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from window_user import Open, User, end_pauses, settle, wait_for

import core.varying
from core.design import Tolerance
from core.project import load
from core.study import Study, evaluations
from core.varying import motor_bands, shaft_bands
from kindyna_gui.dialogs import SaveAnswer
from kindyna_gui.graph.flywheel_view import FlywheelView
from kindyna_gui.places import example
from kindyna_gui.shaft import AgainstSpeedView, ShaftFiguresView, ShaftTorqueView
from kindyna_gui.stability_view import StabilityView

UNIT = example("transfer_unit")
FLYWHEEL = "shaft.flywheel_inertia_kg_m2"


@pytest.fixture
def unit(open_user: Open, tmp_path: Path) -> User:
    path = tmp_path / "unit.toml"
    copyfile(UNIT, path)
    return open_user(path)


def test_torque_flywheel_and_stability_are_those_of_all_drives(unit: User, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = Study(load(UNIT), 1800)
    torque = unit.see("shaft_torque")
    assert isinstance(torque, ShaftTorqueView)
    torque.settle()
    drives, sums = torque.drives.lines, torque.sums.lines
    assert len(drives) == 4
    kilo = torque.drives.display_unit.size
    assert np.allclose(kilo * sum(y[:-1] for _, y in drives), whole.camshaft.torque, atol=1e-9)
    assert np.allclose(sums[0][1][:-1] * torque.sums.display_unit.size, whole.camshaft.torque)
    assert np.allclose(sums[1][1][:-1] * torque.sums.display_unit.size, whole.camshaft.motor_torque)
    QTest.mouseClick(torque.sums.viewport(), Qt.MouseButton.LeftButton, pos=torque.sums.pixel_at(300.0).toPoint())
    settle()
    assert degrees(unit.window.player.machine) == pytest.approx(300.0, abs=1.5)
    beside = [float(text.split()[0].replace("\u2212", "-")) for text in torque.sums.readings()]
    at = round(degrees(unit.window.player.machine) / 360.0 * whole.camshaft.torque.size)
    known = [y[at] for _, y in sums]
    assert beside == pytest.approx(known, rel=2e-3), "shaft and motor, beside the cursor"

    assert [line.band for line in torque.drives.shown] == [None] * 4, "nobody has asked"
    unit.session.put_full_design(
        replace(unit.session.full_design, tolerances=(Tolerance("drives[2].cam.base_radius_mm", 5.0),)), "Tolerance"
    )
    for bands in (shaft_bands, motor_bands):
        monkeypatch.setattr(core.varying, bands.__name__, partial(bands, machines=20))
    torque.bands.set_shown(True)
    wait_for(lambda: any(line.band is not None for line in torque.drives.shown))

    def wide() -> list[float]:
        """How wide each band is at most [N m]."""
        rows = ((torque.drives, torque.drives.shown), (torque.sums, torque.sums.shown[:1]))
        each = [(plot.display_unit.size, line.band) for plot, lines in rows for line in lines]
        return [size * float(np.ptp(band[1], axis=0).max()) for size, band in each if band is not None]

    feed, clamp, lift, _, shaft = wide()
    assert (feed, clamp) == pytest.approx((0.0, 0.0))
    assert shaft == pytest.approx(lift, rel=1e-9), "the shaft varies with the lift alone"
    wait_for(lambda: [line.label for line in torque.sums.shown if line.band is not None] == ["Shaft", "Motor"])
    assert 0.0 < float(np.ptp(torque.sums.shown[-1].band[1], axis=0).max()) * torque.sums.display_unit.size < shaft
    wider = (Tolerance("drives[2].cam.base_radius_mm", 10.0),)
    unit.session.put_full_design(replace(unit.session.full_design, tolerances=wider), "Tolerance")
    assert not wide(), "those of other tolerances are gone"
    wait_for(lambda: len(wide()) == 5)
    assert wide()[4] == pytest.approx(2.0 * shaft, rel=0.2)
    figures = unit.see("shaft_figures")
    assert isinstance(figures, ShaftFiguresView)
    wait_for(lambda: bool(figures.speed.shown) and figures.speed.shown[0].band is not None)
    torque.bands.set_shown(False)
    figures.settle()
    rows = {row.cells[0]: row.cells for row in figures.table.rows.rows}
    assert list(rows) == ["Feed", "Clamp", "Lift", "Torque", "Shaft", "Motor"]
    assert rows["Shaft"][1:4] == ("13.54", "170.3", "483.9")

    chart = unit.see("stability")
    assert isinstance(chart, StabilityView)
    wait_for(lambda: chart.stability is not None)
    assert chart.stability is not None
    assert chart.stability.machine.q == whole.flexible_shaft().machine.q


@pytest.mark.stress
def test_against_speed_computes_nothing_while_it_cannot_be_seen(unit: User) -> None:
    before, window = evaluations["against speed"], unit.window
    unit.see("shaft_torque")
    unit.enter(FLYWHEEL, "3000")
    assert evaluations["against speed"] == before, "nobody has asked for it"
    view = unit.see("against_speed")
    assert isinstance(view, AgainstSpeedView)
    wait_for(lambda: view.curves is not None)
    assert evaluations["against speed"] == before + 1
    found, whole = view.curves, unit.session.shaft
    assert found is not None
    assert np.interp(whole.design.speed_rpm, found.rpm, found.peak) == pytest.approx(
        abs(whole.peak_torque.value), rel=0.02
    )
    for away in (lambda: window.docks["against_speed"].hide(), lambda: unit.see("torque")):  # closed; behind another
        unit.see("against_speed")
        wait_for(lambda: view.curves is not None)
        count = evaluations["against speed"]
        away()
        settle()
        unit.enter(FLYWHEEL, "3100" if count == before + 1 else "3200")
        view.settle()
        assert not view.busy
        assert evaluations["against speed"] == count


def test_the_first_words_of_the_flywheel_are_whether_it_suffices(unit: User) -> None:
    view = unit.see("flywheel")
    assert isinstance(view, FlywheelView)
    wait_for(lambda: view.answer.text().startswith("With 2250 kg·m² the speed varies by 1.974 %"))
    assert view.answer.text().endswith("the flywheel suffices, the least is 2212.4 kg·m².")
    unit.enter(FLYWHEEL, "1500")
    wait_for(lambda: "too much, 2212.4 kg·m² keep the speed within 2 %" in view.answer.text())
    QTest.mouseClick(view.use_button, Qt.MouseButton.LeftButton)
    wait_for(lambda: "the flywheel suffices" in view.answer.text())


def test_the_first_words_against_speed_are_the_torque_and_the_speeds_allowed(unit: User) -> None:
    view = unit.see("against_speed")
    assert isinstance(view, AgainstSpeedView)
    wait_for(lambda: view.curves is not None)
    assert view.answer.text().startswith("20 rpm: peak torque 483.9 N·m; the speed varies by at most 2 % from ")
    rpm = float(view.answer.text().rpartition("from ")[2].split()[0])
    assert view.curves is not None
    allowed = view.curves.rpm[view.curves.fluctuation <= 0.02]
    assert rpm == pytest.approx(allowed.min(), rel=0.01)


def test_figures_that_wait_for_a_pause_are_not_those_of_an_incomplete_drawing(unit: User) -> None:
    """A linkage is drawn before the pause after an edit is over: nothing of it is calculated for the table."""
    figures = unit.see("shaft_figures")
    unit.session.edit("shaft.speed_rpm", 31.0, "Change speed")
    wait_for(lambda: figures.busy)
    unit.answers(SaveAnswer.DISCARD)
    unit.choose("File", "New by type", "Linkage by drawing")
    end_pauses()
    assert unit.session.is_incomplete_linkage
    assert not figures.busy
