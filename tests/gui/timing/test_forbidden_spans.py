"""Fields of the timing chart: the machine angles in which bodies of two drives meet or are nearer than they must be."""

from pathlib import Path

import pytest
from outlined import clearance, slides
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor
from window_user import Open, wait_for

from core.design import rename_drive, with_phase
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
