"""tests/benchmarks/window.py measures what it says: every plot on screen, each edit painted, a bare repaint beside it."""

import pytest
from benchmarks import window
from PySide6.QtWidgets import QApplication


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
        ("drag to paint", [window.DRAG, "bare repaint"]),
    )
    tables = [("tables to paint, after a pause", method, 12) for method in (window.TABLES, "bare repaint")]
    methods = (("edit to paint", "edit of a link"), ("drag to paint", "a joint"), ("animation", "frame"))
    six_bar = [(f"{kernel}, six-bar", name, 3) for kernel, own in methods for name in (own, "bare repaint")]
    beyond = (window.WIDE_KERNEL, window.DRIVES_KERNEL)
    more = [(kernel, name, 3) for kernel in beyond for name in ("frame", "bare repaint")]
    lift = [(kernel, method, plots) for plots in layouts for kernel, methods in kernels for method in methods]
    assert [(row.kernel, row.method, row.n) for row in rows] == [*lift, *tables, *six_bar, *more]
    assert all(row.seconds > 0.0 for row in rows)
    told = {f"{row.kernel}: {row.method}" for row in rows if row.method != window.BARE and row.kernel not in beyond}
    assert told == set(window.names())
