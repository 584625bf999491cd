"""tests/benchmarks/window.py measures what it says: every plot on screen, each edit painted, a bare repaint beside it."""

import pytest
from benchmarks import window
from PySide6.QtWidgets import QApplication


@pytest.mark.stress
def test_edits_and_frames_are_measured_beside_a_bare_repaint(
    app: QApplication, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(window, "WARM", 0)
    layouts = (window.MANY,)  # all docks open with their tables
    rows = window.measure(1, layouts)
    edits = [name for name, _, _ in window.EDITS]
    kernels = (
        ("edit to paint", [*edits, "bare repaint"]),
        ("animation", ["frame", "bare repaint"]),
        (window.PIN_KERNEL, [window.PINNED, "bare repaint"]),
    )
    tables = [("tables to paint, after a pause", method, 12) for method in (window.TABLES, "bare repaint")]
    theme, key = (
        [(kernel, method, 12) for method in (name, "bare repaint")]
        for kernel, name in ((window.THEME_KERNEL, window.THEME), (window.KEY_KERNEL, window.KEY))
    )
    drawn = [("drag to paint", method, 12) for method in (window.DRAG, "bare repaint")]
    joint = [("drag to paint, six-bar", method, 12) for method in (window.JOINT, "bare repaint")]
    eight_bar = [(window.EIGHT_BAR_KERNEL, method, 12) for method in (window.JOINT, "bare repaint")]
    pose = [(window.TASK_KERNEL, method, 0) for method in (window.POSE, "bare repaint")]
    methods = (("edit to paint", "edit of a link"), ("animation", "frame"))
    six_bar = [(f"{kernel}, six-bar", name, 3) for kernel, own in methods for name in (own, "bare repaint")]
    beyond = (window.WIDE_KERNEL, window.DRIVES_KERNEL)
    wide, drives = ([(kernel, name, 3) for name in ("frame", "bare repaint")] for kernel in beyond)
    lift = [(kernel, method, plots) for plots in layouts for kernel, methods in kernels for method in methods]
    assert [(row.kernel, row.method, row.n) for row in rows] == [
        *lift,
        *tables,
        *drawn,
        *theme,
        *key,
        *six_bar,
        *wide,
        *joint,
        *eight_bar,
        *pose,
        *drives,
    ]
    assert all(row.seconds > 0.0 for row in rows)
    told = {f"{row.kernel}: {row.method}" for row in rows if row.method != window.BARE and row.kernel not in beyond}
    assert told == set(window.names())
