"""Findings, certificate, flywheel, and the count in the status line."""

from math import degrees, pi

import pytest
from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QPushButton
from sampled import stressed
from window_user import Open, User, settle, wait_for

from core.design import Motion, NamedCurve, Segment, edited, with_drive
from core.materials import MATERIALS
from core.project import load
from core.study import Study, certificate_of, extremes_of, findings_of
from kindyna_gui.find import FindView
from kindyna_gui.findings import PROVES, CertificateView, FindingsView
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.tables import RowsTable
from kindyna_gui.graph.flywheel_view import FlywheelView
from kindyna_gui.graph.plots_view import PlotView
from kindyna_gui.pictures.units import digits
from kindyna_gui.places import example
from kindyna_gui.screenshots import rest


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


@pytest.fixture
def user(same_window: Open) -> User:
    """Without plots, for which no test here has eyes."""
    return same_window()


def findings(user: User) -> FindingsView:
    view = user.window.show_view("findings")
    assert isinstance(view, FindingsView)
    wait_for(lambda: view.up_to_date)
    return view


def click(table: RowsTable, row: int) -> None:
    QTest.mouseClick(
        table.viewport(), Qt.MouseButton.LeftButton, pos=table.visualRect(table.rows.index(row, 0)).center()
    )
    settle()


def cells(table: RowsTable) -> list[tuple[str, ...]]:
    return [row.cells for row in table.rows.rows]


def test_no_finding_says_so(user: User) -> None:
    view = findings(user)
    assert view.findings == ()
    assert view.empty.isVisible()
    assert not view.table.isVisible()


def test_findings_are_listed_the_gravest_first(user: User) -> None:
    user.enter("cam.base_radius_mm", "200")
    view = findings(user)
    assert [f.code for f in view.findings] == ["undercut", "pressure-angle", "speed-fluctuates"]
    assert view.findings == findings_of(Study(user.design, user.session.study.samples))
    first, second, _ = cells(view.table)
    assert first[0].startswith("Undercut: ")
    assert first[1:] == ("Find base radius", "317.16")
    assert second[1] == "Find base radius"
    assert all(row.icon is not None for row in view.table.rows.rows)


def remedy(user: User, code: str) -> QPushButton:
    """The button beside a finding."""
    view = findings(user)
    number = [f.code for f in view.findings].index(code)
    button = view.table.indexWidget(view.table.rows.index(number, 1))
    assert isinstance(button, QPushButton)
    return button


def press(button: QAbstractButton) -> None:
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    settle()


def found_by(user: User, what: str) -> FindView:
    """Find is open and has this answer."""
    view = user.window.view("find")
    assert isinstance(view, FindView)
    wait_for(lambda: view.up_to_date and not view.busy)
    assert view.on_screen()
    assert view.what.currentData() == what
    return view


@pytest.mark.parametrize(
    ("name", "path", "value", "code", "label", "what"),
    [
        ("rocker_cam", "shaft.speed_rpm", "1400", "separation", "Find spring", "spring"),
        stressed("card_picker", "cam.base_radius_mm", "12", "pressure-angle", "Find base radius", "base-radius"),
        stressed("rocker_cam", "shaft.flywheel_inertia_kg_m2", "0.2", "speed-fluctuates", "Find flywheel", "flywheel"),
        stressed("transfer_lift", "shaft.flywheel_inertia_kg_m2", "500", "motor-stalls", "Find flywheel", "flywheel"),
        stressed("tappet_flat", "follower.face_half_width_mm", "8", "face-too-narrow", "Find face width", "face-width"),
    ],
)
def test_the_button_of_a_finding_seeks_what_mends_it_and_taken_over_it_is_mended(
    open_user: Open, name: str, path: str, value: str, code: str, label: str, what: str
) -> None:
    user = open_user(example(name))
    user.enter(path, value)
    button = remedy(user, code)
    assert button.text() == label
    press(button)
    press(found_by(user, what).take)
    assert code not in [f.code for f in findings(user).findings]


@pytest.mark.stress
def test_the_search_of_a_finding_forgets_limits_typed_before(open_user: Open) -> None:
    user = open_user(example("card_picker"))
    user.window.show_search("base-radius")
    view = found_by(user, "base-radius")
    view.limits.changed.emit("pressure_angle_deg", 45.0)
    wait_for(lambda: not view.busy)
    user.enter("cam.base_radius_mm", "12")
    press(remedy(user, "pressure-angle"))
    assert found_by(user, "base-radius").solution.limits["pressure_angle_rise_deg"] == 30.0


def test_the_button_of_a_finding_leads_to_what_is_missing(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    user.enter("limits.contact_pressure_mpa", "600")
    for path, label, text in (("cam.thickness_mm", "Add thickness", "2"), ("cam.material", "Add material", "")):
        button = remedy(user, "no-contact-pressure")
        assert button.text() == label
        press(button)
        editor = user.parameters().forms["cam"].fields[path].editor
        assert QApplication.focusWidget() is editor
        if text:
            user.enter(path, text)
    for path in ("cam.material", "cam.roller_material"):
        user.session.edit(path, next(iter(MATERIALS)), "Give a material")
    button = remedy(user, "contact-pressure")
    assert button.text() == "Thickness"
    press(button)
    assert QApplication.focusWidget() is user.parameters().forms["cam"].fields["cam.thickness_mm"].editor


@pytest.mark.stress
def test_the_button_of_a_drive_s_finding_seeks_in_that_drive(open_user: Open) -> None:
    user = open_user(example("transfer_unit"))
    user.session.put_full_design(edited(user.session.full_design, "drives[1].cam.base_radius_mm", 80.0), "Small")
    assert user.session.design.name != "Clamp"
    press(remedy(user, "pressure-angle"))
    found_by(user, "base-radius")
    assert user.session.chosen == 1


def test_what_is_assumed_is_listed_and_leads_to_its_field(open_user: Open) -> None:
    user = open_user(example("transfer_unit"))
    menu = user.window.status.assumed.menu()
    menu.aboutToShow.emit()
    rows = menu.actions()
    assert [row.text() for row in rows][::2][:2] == ["Flywheel inertia: 2250 kg·m²", "Motor slope: 400 N·m·s/rad"]
    assert rows[-1].text() == "Clamp.rise.1.end to Lift.rise.1.start: 5°"
    (lift,) = (row.menu() for row in rows if row.text() == "Lift")
    (row,) = (row for row in lift.actions() if row.text() == "Slider mass: 200 kg")
    assert row.toolTip() == "Shin1995 gives no mass of the slider."
    row.trigger()
    settle()
    assert QApplication.focusWidget() is user.parameters().forms["loads"].fields["loads.slider_mass_kg"].editor
    assert user.session.chosen == 2, "the lift"


def test_a_click_turns_the_cam_and_leads_to_the_field(user: User) -> None:
    user.enter("cam.base_radius_mm", "200")
    view = findings(user)
    user.window.player.play()
    click(view.table, 1)
    assert not user.window.player.playing
    assert degrees(user.window.player.theta) == pytest.approx(view.findings[1].cam_angle_deg)
    focused = QApplication.focusWidget()
    assert isinstance(focused, NumberBox)
    assert focused is user.parameters().forms["cam"].fields["cam.base_radius_mm"].editor


def test_enter_does_what_a_click_does(user: User) -> None:
    user.enter("cam.base_radius_mm", "200")
    view = findings(user)
    view.table.setFocus()
    view.table.selectRow(0)
    user.press(Qt.Key.Key_Return)
    assert QApplication.focusWidget() is user.parameters().forms["cam"].fields["cam.roller_radius_mm"].editor


def test_a_finding_of_a_segment_leads_to_its_row(user: User) -> None:
    user.session.edit("motion.segments[1].law", "constant-velocity", "a")
    view = findings(user)
    assert [f.code for f in view.findings] == ["jump-velocity"] * 2
    click(view.table, 1)
    assert user.motion().chosen == 2
    assert degrees(user.window.player.theta) == pytest.approx(76.5)


def test_a_finding_of_all_loads_leads_to_their_form(user: User) -> None:
    user.enter("loads.external_force_n", "200000")
    user.parameters().tabs.setCurrentIndex(0)
    click(findings(user).table, 0)
    shown = user.parameters()
    assert shown.tabs.currentWidget() is shown.pages["loads"]


def test_a_click_on_a_finding_of_the_design_before_does_no_harm(user: User) -> None:
    """Its rows stay until those of the other design are known."""
    user.session.edit("limits.contact_pressure_mpa", 10.0, "Limit the pressure")
    view = findings(user)
    wait_for(lambda: bool(view.findings))
    user.session.start(load(example("tappet_flat")))
    click(view.table, 0)
    wait_for(lambda: view.up_to_date)
    assert not view.in_trouble


def test_the_list_waits_for_a_pause(user: User) -> None:
    view = findings(user)
    box = user.number("cam.base_radius_mm")
    for _ in range(3):
        QTest.keyClick(box, Qt.Key.Key_Down)
    assert not view.up_to_date
    wait_for(lambda: view.up_to_date)


def test_a_finding_that_was_counted_stays_counted_in_another_task(open_user: Open) -> None:
    user = open_user(example("transfer_unit"), (1440, 900), whole=True)
    status = user.window.status
    user.enter("motion.stroke_deg", "26")
    user.see("findings")
    wait_for(lambda: status.findings.text() == "1 note")
    user.choose("View", "Graph")
    assert "cam" not in user.window.stages_on_screen()
    status.count_findings()
    assert status.findings.text() == "1 note"


def test_the_status_line_counts(user: User) -> None:
    status = user.window.status
    wait_for(lambda: status.findings.text() == "no findings")
    user.enter("cam.base_radius_mm", "200")
    wait_for(lambda: status.findings.text() == "1 error, 1 warning")
    user.window.docks["findings"].close()
    assert not user.window.docks["findings"].isVisible()
    QTest.mouseClick(status.findings, Qt.MouseButton.LeftButton)
    settle()
    view = user.window.view("findings")
    assert view is not None
    assert view.on_screen()


def test_the_count_of_one_file_is_not_shown_for_another(user: User) -> None:
    status = user.window.status
    user.enter("cam.base_radius_mm", "200")
    wait_for(lambda: status.findings.text() == "1 error, 1 warning")
    user.session.open(example("rocker_cam"))
    assert status.findings.text() == "limits not checked"
    wait_for(lambda: status.findings.text() == "no findings")


def test_the_status_line_counts_only_what_is_on_screen(open_user: Open) -> None:
    user = open_user()
    user.enter("cam.base_radius_mm", "200")
    for dock in user.window.docks.values():
        dock.hide()
    user.window.centralWidget().hide()
    settle()
    assert user.window.stages_on_screen() == ()
    button = user.window.status.findings
    wait_for(lambda: "No view is open" in button.toolTip())
    assert button.text() == "limits not checked", "nobody has looked at any"


def test_the_status_line_shows_angle_and_state(user: User) -> None:
    status = user.window.status
    assert status.assumed.text() == "11 assumed"
    assert status.saved.text() == "not saved to a file"
    user.window.player.set_theta(1.0)
    assert status.angle.text() == "cam angle 57.3°"
    user.enter("follower.rod_mm", "850")
    assert status.saved.text() == "unsaved changes"


def test_the_certificate_says_what_it_proves(user: User) -> None:
    view = user.window.show_view("certificate")
    assert isinstance(view, CertificateView)
    wait_for(lambda: view.up_to_date)
    proof = certificate_of(user.session.study)
    rows = cells(view.table)
    assert len(rows) == len(proof)
    for row, (name, residual) in zip(rows, proof.items(), strict=True):
        assert row[0].lower().replace(" ", "_") == name
        shown = [float(text.replace("\u2212", "-")) for text in row[1:3]]
        assert (shown, row[3]) == ([float(f"{value:.1e}") for value in (residual.value, residual.bound)], "kept")
        assert row[4].lower() == PROVES[name][0].lower()
    tips = [
        str(view.table.rows.data(view.table.rows.index(i, 4), Qt.ItemDataRole.ToolTipRole)) for i in range(len(rows))
    ]
    assert [tip.lower() for tip in tips] == [PROVES[name][1].lower() for name in proof]


def test_the_flywheel_has_its_figures(user: User) -> None:
    user.choose("Dyna", "Flywheel")
    view = user.window.view("flywheel")
    assert isinstance(view, FlywheelView)
    wait_for(lambda: view.up_to_date)
    wheel = user.session.study.flywheel
    told = {row[0]: row[1:] for row in cells(view.table)}
    assert told["Inertia for 2 % fluctuation of speed"] == (digits(wheel.needed_inertia, 5), "kg·m²")
    assert told["Estimate from the energy"] == (digits(34820.0), "kg·m²")
    assert told["Motor slope, assumed"] == ("50", "N·m·s/rad")
    assert told["Inertia of this design"] == told["Inertia for 2 % fluctuation of speed"]
    assert told["Speed fluctuation"] == ("2.000", "%")
    user.enter("shaft.flywheel_inertia_kg_m2", "5000")
    wait_for(lambda: view.up_to_date)
    told = {row[0]: row[1:] for row in cells(view.table)}
    assert told["Inertia of this design"] == ("5000", "kg·m²")
    found = extremes_of(user.session.study, "dynamics", ("camshaft_speed",))["camshaft_speed"]
    assert told["Speed, lowest"] == (digits(found.low.value * 30 / pi), "rpm")
    assert float(told["Speed fluctuation"][0]) == pytest.approx(
        100 * (found.high.value - found.low.value) * 30 / pi / 20, rel=1e-3
    )


def test_a_flywheel_that_does_not_carry_the_load_is_said_to_stall(same_window: Open) -> None:
    user = same_window()
    user.enter("shaft.flywheel_inertia_kg_m2", "500")
    user.choose("Dyna", "Flywheel")
    view = user.window.view("flywheel")
    assert isinstance(view, FlywheelView)
    wait_for(lambda: view.up_to_date)
    told = {row[0]: row[1:] for row in cells(view.table)}
    assert "The motor stalls" in told
    assert told["Least inertia that prevents it"] == ("787.0", "kg·m²")
    assert not any(name.startswith(("Motor torque", "Speed", "Fluctuation")) for name in told)
    user.choose("Dyna", "Torque")
    plot = user.window.view("torque")
    assert isinstance(plot, PlotView)
    wait_for(lambda: plot.up_to_date)
    assert [row.name for row in plot.rows] == ["drive_torque"]
    assert "stalls" in plot.note.text()


def test_the_flywheel_that_the_sizing_asks_for_is_fitted_by_one_click_and_taken_back_by_one_undo(user: User) -> None:
    user.choose("Dyna", "Flywheel")
    view = user.window.view("flywheel")
    assert isinstance(view, FlywheelView)
    wait_for(lambda: view.up_to_date)
    assert not view.use_button.isEnabled(), "it is fitted"
    user.enter("shaft.speed_fluctuation", "0.05")
    wait_for(lambda: view.up_to_date)
    before = user.design
    QTest.mouseClick(view.use_button, Qt.MouseButton.LeftButton)
    assert user.design.shaft.flywheel_inertia_kg_m2 == 14055.0
    wait_for(lambda: view.up_to_date)
    assert not view.use_button.isEnabled()
    told = {row[0]: row[1:] for row in cells(view.table)}
    assert float(told["Speed fluctuation"][0]) == pytest.approx(5.0, abs=1e-3)
    user.session.stack.undo()
    assert user.design == before


def test_the_torque_of_the_lift_is_seen_with_and_without_its_flywheel(same_window: Open) -> None:
    """Shin1995 Figs. 19, 20: both torques, and dashed what the paper's linear equation gives."""
    user = same_window()
    user.choose("Dyna", "Torque")
    plot = user.window.view("torque")
    assert isinstance(plot, PlotView)
    wait_for(lambda: plot.up_to_date)
    assert [row.name for row in plot.rows] == ["drive_torque", "motor_torque", "linear_motor_torque"]
    user.choose("Dyna", "Camshaft speed")
    speed = user.window.view("camshaft_speed")
    assert isinstance(speed, PlotView)
    wait_for(lambda: speed.up_to_date)
    assert [row.name for row in speed.rows] == ["camshaft_speed"]


def test_a_table_goes_to_the_clipboard(user: User) -> None:
    view = user.window.show_view("certificate")
    assert isinstance(view, CertificateView)
    wait_for(lambda: view.up_to_date)
    view.table.setFocus()
    user.press(Qt.Key.Key_C, modifier=Qt.KeyboardModifier.ControlModifier)
    lines = QApplication.clipboard().text().splitlines()
    assert lines[0].startswith("Check\tResidual")
    assert len(lines) == 1 + len(cells(view.table))


def test_the_certificate_can_be_read_in_a_small_window(open_user: Open) -> None:
    """No sentence is cut off, none takes a second line."""
    user = open_user(size=(1280, 720))
    view = user.window.show_view("certificate")
    assert isinstance(view, CertificateView)
    wait_for(lambda: view.up_to_date)
    settle()
    table = view.table
    for row in range(table.model().rowCount()):
        index = table.model().index(row, 4)
        assert table.sizeHintForIndex(index).width() <= table.columnWidth(4), index.data()
        assert table.rowHeight(row) < 2 * table.fontMetrics().height() + 6


@pytest.mark.stress
def test_where_there_is_no_shaft_no_flywheel_can_be_fitted(user: User) -> None:
    user.choose("View", "Kine")
    user.choose("Dyna", "Flywheel")
    view = user.window.view("flywheel")
    assert isinstance(view, FlywheelView)
    user.enter("shaft.speed_fluctuation", "0.05")
    wait_for(lambda: view.up_to_date and view.use_button.isEnabled())
    user.session.start(load(example("four_bar")))
    wait_for(lambda: view.up_to_date)
    assert not view.use_button.isEnabled()


def test_the_torque_of_a_dwell_has_no_figures(user: User) -> None:
    """A dwell all round needs no flywheel."""
    still = Motion(150.0, (Segment(360.0, 0.0, NamedCurve("dwell")),))
    lift = user.design
    user.session.put(with_drive(lift, motion=still), "Stand still")
    user.choose("Dyna", "Flywheel")
    view = user.window.view("flywheel")
    assert isinstance(view, FlywheelView)
    wait_for(lambda: view.up_to_date)
    told = {row[0]: row[1:] for row in cells(view.table)}
    assert {told.pop(name) for name in ("Speed, lowest", "Speed, highest")} == {("20.00", "rpm")}
    assert told.pop("Inertia of this design")[1] == "kg·m²"
    assert "Motor slope, assumed" in told
    del told["Motor slope, assumed"]
    assert {row[0] for row in told.values()} == {"0"}
    assert not view.use_button.isEnabled()


def test_the_angle_is_told_without_laying_out_the_line(user: User) -> None:
    asked: list[int] = []

    class Watch(QObject):
        def eventFilter(self, watched: QObject, event: QEvent) -> bool:
            if event.type() == QEvent.Type.LayoutRequest:
                asked.append(1)
            return False

    rest(user.window)  # the findings are counted after a pause
    watch = Watch()
    user.window.status.installEventFilter(watch)
    for theta in (0.1, 1.0, 6.0):
        user.window.player.set_theta(theta)
        settle()
    assert user.window.status.angle.text() == "cam angle 343.8°"
    assert asked == []


def test_units_are_written_as_everywhere_in_the_window(same_window: Open) -> None:
    user = same_window(example("kim_1990"))
    table = findings(user).table
    texts = [str(table.rows.index(row, 0).data()) for row in range(table.rows.rowCount())]
    assert "Acceleration jumps by \u221218 mm/rad² at a join: infinite jerk" in texts
