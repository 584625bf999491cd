"""kindyna_gui.stability_pages: verdicts, speeds and plots of the point that is looked at; the same as files."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from stability_page import KIM, LEFT, TURNS, page, pixel, unhurried
from window_user import Open, User, settle, wait_for

from core.stability import Figure, History, Plot, PlotCurve, Stability, mean_wind_up
from kindyna_gui.__main__ import main
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.pictures.paper.sheets import figure_file
from kindyna_gui.stability_view import StabilityView

FEW = np.arange(0.5, 5.6, 0.85)


@pytest.fixture
def kim(open_user: Open, monkeypatch: pytest.MonkeyPatch) -> User:
    """The window with Kim1990's cam, whose shaft is followed through few turns only: how many is no matter of the window."""
    monkeypatch.setattr(Stability, "turns", TURNS)
    return open_user(KIM, size=(1440, 900))


@pytest.mark.stress
def test_a_click_shows_verdicts_and_history_there(kim: User) -> None:
    view = page(kim)
    own = shown(view)
    assert view.stability is not None
    assert (own.eta, own.q) == (view.stability.machine.eta, view.stability.machine.q)
    QTest.mouseClick(view.chart.viewport(), LEFT, pos=pixel(view, 1.5, 0.1))
    assert view.picked is not None
    wait_for(lambda: not view.busy)
    gone = shown(view)
    assert (gone.eta, gone.q) == view.picked
    assert view.chosen is not None
    assert len(view.chosen.verdicts) == 4
    text = view.pages.verdicts.text()
    assert text.count("<tr>") == 5
    assert "unstable" in text
    for name in ("Wind-up", "Phase", "Spectrum", "Contact"):
        view.pages.show_page(name)
        settle()
        (x, y), *_ = view.pages.plots[name][0].lines
        assert x.size == y.size > 30
        assert np.ptp(y[np.isfinite(y)]) > 0.0
    y, twist = view.pages.plots["Wind-up"][0].lines[0]
    assert twist == pytest.approx(360.0 * gone.at(y)[0])


def shown(view: StabilityView) -> History:
    assert view.chosen is not None
    assert view.chosen.history is not None
    return view.chosen.history


@pytest.mark.stress
def test_averages_are_followed_when_their_page_comes_to_the_front(kim: User, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kim1990 Figs. 6 and 7: mean wind-up and mean rate of the first turn by η, a row for each Q."""
    monkeypatch.setattr("core.stability.stage.etas", lambda eta_max: FEW)
    view = page(kim)
    found = view.stability
    assert found is not None
    assert "first_turn" not in vars(found)
    view.pages.show_page("Averages")
    settle()
    assert "many speeds" in view.pages.plots["Averages"][0].message
    assert view.progress.isVisible()
    wait_for(lambda: not view.busy)
    means = mean_wind_up(found.coefficients, (0.05, 0.1, 0.2, 0.5, 1.0), FEW, contact=found.contact)
    for plot, rows in zip(view.pages.plots["Averages"], (means.wind_up, means.slope), strict=True):
        assert not plot.message
        solid = [line for line in plot.lines if np.isfinite(line[1]).any()]
        assert np.array_equal(solid[0][0], means.eta)
        assert solid[0][1] == pytest.approx(rows[0], rel=1e-9)
        assert max(np.nanmax(y) for _, y in solid) == pytest.approx(rows.max(), rel=1e-9)
    with unhurried(view):
        kim.session.edit("shaft.stiffness_nm_per_rad", 80.0, "Change stiffness")
        settle()
        assert view.shaft_jobs.busy is False, "not before editing pauses"
    view.settle()
    wait_for(lambda: not view.busy)
    assert view.stability is not found
    assert "first_turn" in vars(view.stability)


def test_the_terms_of_the_equation_are_drawn_by_cam_angle(kim: User) -> None:
    """Kim1990 Fig. 5."""
    view = page(kim, rest=False)
    view.pages.show_page("Terms")
    settle()
    degrees, psi = view.pages.plots["Terms"][0].lines[0]
    theta = np.deg2rad(degrees)
    kims = np.where(degrees < 180.0, 3.0 * (np.cos(2.0 * theta) - np.cos(4.0 * theta)), 0.0)
    assert np.abs(psi - kims).max() < 1e-12


@pytest.mark.stress
def test_only_the_page_in_front_has_its_plots_and_is_drawn(kim: User) -> None:
    view = page(kim)
    assert not view.pages.plots
    view.pages.show_page("Spectrum")
    settle()
    assert {name: bool(plots[0].lines) for name, plots in view.pages.plots.items()} == {"Spectrum": True}


@pytest.mark.stress
def test_the_forbidden_speeds_and_the_shaft_for_a_speed(kim: User) -> None:
    view = page(kim)
    view.pages.show_page("Speeds")
    settle()
    found = kim.session.study.stability
    assert found is not None
    assert view.pages.speeds.text().count("<tr>") == 1 + len(found.bands)
    band = found.bands[1]
    view.pages.speed.setFocus()
    view.pages.speed.selectAll()
    kim.type(f"{0.5 * (band.rpm_lo + band.rpm_hi):.1f}")
    kim.press(Qt.Key.Key_Return)
    assert "at least" in view.pages.needed.text()


@pytest.mark.stress
def test_the_chart_and_the_other_figures_as_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--q", "0.05", "--eta-max", "2.2", "--periods", "2"]
    assert main(["--headless", "stability", str(KIM), "--out", str(tmp_path), *words]) == 0
    names = ("stability", "windup_averages", "windup", "coefficients")
    assert {f"{name}{ending}" for name in names for ending in (".svg", ".png")} <= {p.name for p in tmp_path.iterdir()}
    for name in names:
        drawn = (tmp_path / f"{name}.svg").read_text("utf-8")
        assert drawn.count("<path") + drawn.count("<polyline") > 5
        image = QImage(str(tmp_path / f"{name}.png"))
        row = image.height() // 3
        colours = {image.pixelColor(x, row).name() for x in range(image.width())}
        assert len(colours) > 4, f"{name}: curves are crossed at this height"


@pytest.mark.parametrize("ending", [".svg", ".png"])
@pytest.mark.usefixtures("app")
def test_a_figure_of_the_core_as_a_file(ending: str) -> None:
    """Its title, its legend, broken and dashed curves; one plot below the other."""
    x = np.linspace(0.0, 1.0, 9)
    broken = np.where(x > 0.5, np.nan, x)
    one = Plot(
        "Turns",
        "Twist",
        (PlotCurve(x, x, "first"), PlotCurve(x, broken, "second", 1, dashed=True)),
        ((0.4, "here"),),
        "a note",
    )
    data = figure_file(Figure("name", "Title of it", (one, one)), ending)
    if ending == ".svg":
        text = data.decode()
        for word in ("Title of it", "first", "second", "a note", "Turns", "Twist", "here"):
            assert word in text, word
    else:
        image = QImage.fromData(data)
        assert (image.width(), image.height()) == (1920, 1280)


def typed(box: NumberBox, text: str) -> None:
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, text)
    QTest.keyClick(box, Qt.Key.Key_Return)
    settle()


def test_a_typed_point_is_reached_exactly_and_its_steady_response_is_drawn(kim: User) -> None:
    """Kim1990 Fig. 9 by its η and Q; a speed in place of η; and back to the machine's own point."""
    view = page(kim)
    fields, found = view.fields, view.stability
    assert found is not None
    assert (fields.eta.value, fields.q.value, fields.rpm.value) == pytest.approx(
        (found.machine.eta, found.machine.q, 1500.0), rel=1e-6
    )
    assert not fields.back.isEnabled()
    typed(fields.eta, "0.85")
    typed(fields.q, "0.10")
    assert view.picked == (0.85, 0.1)
    assert fields.rpm.value == pytest.approx(found.machine.rpm(0.85), rel=1e-6)
    view.pages.show_page("Steady")
    settle()
    wait_for(lambda: not view.busy)
    turn = found.steady_turn_at(0.85, 0.1)
    assert turn is not None
    twist, error, other = view.pages.plots["Steady"]
    assert not other.isVisible(), "all followers slide"
    (angle, true), (_, linear), (_, kims) = twist.lines
    assert true == pytest.approx(np.rad2deg(turn.wind_up(np.deg2rad(angle))))
    assert 0.0 < np.abs(true - linear).max() < np.abs(true - kims).max()
    ((angle, missed),) = error.lines
    assert missed == pytest.approx(1e3 * turn.error(np.deg2rad(angle)), abs=1e-9)
    view.pages.show_page("Verdicts")
    settle()
    assert "η = 0.85, Q = 0.1<" in view.pages.verdicts.text()
    text = view.pages.steady.text()
    assert f"torque in the shaft 0 ± {turn.torque_amplitude:.3g} N·m" in text
    assert f"follower's error {np.abs(missed).max():.3g} mm" in text
    view.pages.show_page("Harmonics")
    settle()
    (_, bars), *_ = view.pages.plots["Harmonics"][0].lines
    assert bars[1:-2:3] == pytest.approx(720.0 * np.abs(turn.harmonics())[1:])
    typed(fields.rpm, "3000")
    assert view.picked == (pytest.approx(found.machine.eta_at(3000.0)), 0.1)
    typed(fields.eta, "-1")
    assert fields.eta.is_refused
    assert view.picked == (pytest.approx(found.machine.eta_at(3000.0)), 0.1), "the point stays"
    QTest.mouseClick(fields.back, LEFT)
    assert view.picked is None
    assert not fields.eta.is_refused
    assert fields.rpm.value == pytest.approx(1500.0)
    wait_for(lambda: not view.busy)
