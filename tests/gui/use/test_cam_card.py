"""A printed cam card becomes two valves over the crank, its figures, a profile and a lift table, in at most 15 actions.

The card: lift 0.410 in, 276° at 0.006 in and 230° at 0.050 in, separation 108° advanced by 4°, lash 0.1 mm.
"""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from window_user import Open, User, answering, settle, wait_for

from core.valves import LIFTS, valve_data, valve_timings
from kindyna_gui.cam_dialogs.profile_dialogs import ProfileDialog
from kindyna_gui.export_dialogs import LiftTableDialog
from kindyna_gui.forms.tables import RowsTable
from kindyna_gui.timing_view import TimingView
from kindyna_gui.valves.figures import ValveFiguresView
from kindyna_gui.valves.train_dialog import CENTRES, ValveTrainDialog

MOST_ACTIONS = 15


class Actions:
    """Counts what a user does: a choice in a menu, a value typed, a button pressed, a file named."""

    def __init__(self, user: User) -> None:
        self.user, self.done = user, list[str]()

    def choose(self, *entry: str) -> None:
        self.done.append(" > ".join(entry))
        self.user.choose(*entry)

    def enter(self, dialog: ValveTrainDialog, place: tuple[str, str], text: str) -> None:
        self.done.append(f"{' '.join(place)} {text}")
        box = dialog.boxes[place]
        QTest.mouseClick(box.lineEdit(), Qt.MouseButton.LeftButton, pos=QPoint(5, 5))
        QTest.keyClick(box, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
        QTest.keyClicks(box, text)
        settle()

    def names_file(self, dialog: str, path: Path) -> list[Any]:
        self.done.append(f"file {path.name}")
        return self.user.picks(dialog, path)

    def accept(self, dialog: Any) -> None:
        self.done.append(f"accept {dialog.windowTitle()}")
        button = dialog.export if isinstance(dialog, ProfileDialog) else dialog.accept_button
        wait_for(button.isEnabled)
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)


def figures(table: RowsTable) -> dict[str, list[str]]:
    rows = table.rows
    return {
        str(rows.data(rows.index(k, 0))): [str(rows.data(rows.index(k, c))) for c in (1, 2)]
        for k in range(rows.rowCount())
    }


def crank_chart(user: User) -> TimingView:
    """Timing chart over the crank, chosen with the keys."""
    user.choose("Dyna", "Timing chart")
    view = user.see("timing")
    assert isinstance(view, TimingView)
    view.unit.setFocus()
    QTest.keyClick(view.unit, Qt.Key.Key_End)
    settle()
    assert view.unit.currentText() == "crank degrees"
    return view


def from_the_card(user: User) -> dict[str, Any]:
    return valve_data(valve_timings(user.session.full_design), LIFTS)


def test_a_printed_card_is_ready_for_the_grinder_in_fifteen_actions(same_window: Open, tmp_path: Path) -> None:
    user = same_window()
    actions = Actions(user)

    def type_card(dialog: ValveTrainDialog) -> None:
        for place, text in (
            (("inlet", "lift_mm"), "0.410 in"),
            (("inlet", "lash_mm"), "0.1"),
            (("inlet", "first_deg"), "276"),
            (("inlet", "second_deg"), "230"),
            (CENTRES[0], "108"),
            (CENTRES[1], "4"),
        ):
            actions.enter(dialog, place, text)
        wait_for(lambda: figures(dialog.figures).get("Duration, lobe, 0.050 in") == ["230.0°", "230.0°"])
        shown = figures(dialog.figures)
        assert {"Duration, valve, 1 mm", "Left to coil bind", "Float speed, engine", "Piston clearance"} <= set(shown)
        assert "Overlap 60° at 0.1524 mm, 14° at 1.27 mm" in dialog.facts.text()
        assert [plot.lines[0][0][[0, -1]].tolist() for plot in dialog.plots] == [[-360.0, 360.0]] * 3
        actions.accept(dialog)

    with answering(ValveTrainDialog, type_card):
        actions.choose("File", "New by type", "Valve train...")

    assert [timing.centre for timing in valve_timings(user.session.full_design)] == [104.0, -112.0]
    picked = actions.names_file("profile_to_save", tmp_path / "inlet.dxf")
    with answering(ProfileDialog, actions.accept):
        actions.choose("File", "Export", "Profile...")
    assert picked[0].name.startswith("Direct_valve_train_inlet")
    picked = actions.names_file("lift_table_to_save", tmp_path / "inlet_lobe.csv")
    with answering(LiftTableDialog, actions.accept):
        actions.choose("File", "Export", "Lift table...")
    assert len(actions.done) <= MOST_ACTIONS, actions.done

    assert (tmp_path / "inlet.dxf").stat().st_size > 1000
    with (tmp_path / "inlet_lobe.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    angles, lift = (np.array([float(row[name]) for row in rows]) for name in ("cam_deg_from_nose", "lift_mm"))
    assert (angles[0], angles[-1], angles.size) == (-180.0, 180.0, 361)
    assert lift.max() == lift[180] == pytest.approx(0.410 * 25.4, abs=1e-9)
    assert np.interp(57.5, angles, lift) == pytest.approx(1.27, abs=0.01), "230° of the crank are 57.5° on each side"


def test_two_degrees_of_separation_move_everything(same_window: Open) -> None:
    user = same_window()
    actions = Actions(user)
    with answering(ValveTrainDialog, actions.accept):
        actions.choose("File", "New by type", "Valve train...")
    chart = crank_chart(user)
    user.choose("Compo", "Valve figures")
    view = user.see("valve_figures")
    assert isinstance(view, ValveFiguresView)
    before = figures(view.table)
    assert before["Separation"][0] == "108.0°"

    def separate(dialog: ValveTrainDialog) -> None:
        actions.enter(dialog, CENTRES[0], "110")
        actions.accept(dialog)

    ((inlet, exhaust, pair),) = chart.canvas.chart.pairs
    assert (inlet.centre, exhaust.centre) == (108.0, -108.0)
    with answering(ValveTrainDialog, separate):
        actions.choose("Compo", "Valve train...")
    wait_for(lambda: view.up_to_date)
    after, data = figures(view.table), from_the_card(user)
    assert after["Separation"][0] == "110.0°"
    assert after["Overlap, lobe, 0.050 in"][0] == "−2.0°"
    assert before["Overlap, lobe, 0.050 in"][0] == "2.0°"
    assert after["Opens, lobe, 0.050 in"] == ["1.0° ATDC", "39.0° BBDC"]
    assert after["Duration, lobe, 0.050 in"] == before["Duration, lobe, 0.050 in"]
    for label in ("Piston clearance", "Valve lift at TDC", "Overlap area"):
        assert after[label] != before[label], label
    assert after["Piston clearance"][0] == f"{data['valves'][0]['clearance']['least_mm']:.3g} mm"
    assert view.answer.text().startswith("Clearance to the piston ")
    user.see("timing")
    ((inlet, exhaust, pair),) = chart.canvas.chart.pairs
    assert (inlet.centre, exhaust.centre) == (110.0, -110.0)
    assert pair.overlaps((1.27,))[0].deg == pytest.approx(-2.0, abs=1e-9)
