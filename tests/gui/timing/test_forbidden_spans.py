"""Fields of the timing chart: the machine angles in which bodies of two drives meet or are nearer than they must be."""

from pathlib import Path

import pytest
from outlined import clearance, slides
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor
from window_user import Open, wait_for

from core.design import add_drive, move_drive, only, rename_drive, with_phase
from core.project import load
from kindyna_gui.timing_view import TimingView


def test_a_field_covers_both_bands_where_their_bodies_are_too_near(same_window: Open, tmp_path: Path) -> None:
    path = tmp_path / "slides.toml"
    path.write_text(slides(0.0, 100.0, 40.0) + clearance("left.follower", "right.follower", 15.0), "utf-8")
    user = same_window(path)
    view = user.see("timing")
    assert isinstance(view, TimingView)
    wait_for(lambda: not view.busy)
    (span,) = view.canvas.forbidden
    (pair,) = user.session.full_study.clearances.pairs
    assert span.drives == (0, 1)
    assert (span.begin, span.end) == pytest.approx(
        [a * 57.29577951 for a in user.session.full_study.clearances.too_near(pair)[0]]
    )
    chart, image = view.canvas.chart, view.canvas.grab().toImage()

    def colour(angle: float, drive: int) -> QColor:
        box = chart.box(drive)
        return QColor(
            image.pixel(QPointF(chart.x(angle) * image.devicePixelRatio(), box.bottom() - 0.2 * box.height()).toPoint())
        )

    inside = 0.5 * (span.begin + span.end)
    assert all(colour(inside, drive).red() > colour(inside, drive).blue() + 20 for drive in (0, 1))
    # without the phase they rise together, and the field is gone
    user.session.put_full_design(with_phase(user.session.full_design, 1, 0.0), "Together")
    wait_for(lambda: view.up_to_date and not view.busy)
    assert view.canvas.forbidden == ()


def test_a_renamed_drive_keeps_its_outline_and_clearance(same_window: Open, tmp_path: Path) -> None:
    path = tmp_path / "slides.toml"
    path.write_text(slides(0.0, 100.0, 40.0) + clearance("left.follower", "right.follower", 15.0), "utf-8")
    user = same_window(path)
    view = user.see("timing")
    assert isinstance(view, TimingView)
    user.session.put_full_design(rename_drive(user.session.full_design, 0, "Pusher"), "Rename")
    wait_for(lambda: view.up_to_date and not view.busy)
    assert [span.names for span in view.canvas.forbidden] == ["pusher.follower – right.follower"]


def test_the_band_between_two_drives_that_are_too_near_stays_clear(same_window: Open, tmp_path: Path) -> None:
    path = tmp_path / "slides.toml"
    path.write_text(slides(0.0, 100.0, 40.0) + clearance("left.follower", "right.follower", 15.0), "utf-8")
    design = load(path)
    design = move_drive(add_drive(design, only(design, 0), "between"), 2, 1)
    user = same_window()
    user.session.start(design)
    view = user.see("timing")
    assert isinstance(view, TimingView)
    wait_for(lambda: not view.busy)
    (span,) = view.canvas.forbidden
    assert span.drives == (0, 2)
    chart, image = view.canvas.chart, view.canvas.grab().toImage()

    def reddened(drive: int) -> bool:
        """Whether the field colours a band, where the drives but the last one stand still."""
        box, x = chart.box(drive), chart.x(130.0)
        colours = [
            QColor(image.pixel((QPointF(x, box.top() + part * box.height()) * image.devicePixelRatio()).toPoint()))
            for part in (0.1, 0.4)
        ]
        return any(colour.red() > colour.blue() + 20 for colour in colours)

    assert [reddened(drive) for drive in range(3)] == [True, False, True]
