"""Valves of an engine in the window: fields of engine and valve, and a timing whose drag changes the centre."""

from pathlib import Path

import pytest
from window_user import Open, User, settle

from core.design import phase_path
from core.project import load

HEAD = """format = 1
name = "Head"
[shaft]
rotation = "ccw"
speed_rpm = 1000.0
[engine]
stroke_mm = 84.0
rod_mm = 138.0
"""
DRIVE = """[[drives]]
name = "{}"
[drives.motion]
start_mm = 0.0
[drives.motion.lobe]
lift_mm = 9.0
duration = [[0.15, 270.0], [1.27, 210.0]]
[drives.follower]
kind = "translating"
face = "flat"
[drives.cam]
base_radius_mm = 18.0
[drives.valve]
centre_deg = {}
"""


@pytest.fixture
def user(same_window: Open, tmp_path: Path) -> User:
    text = HEAD + DRIVE.format("Inlet", 108.0) + DRIVE.format("Exhaust", -108.0)
    (tmp_path / "head.toml").write_text(text, encoding="utf-8")
    return same_window(tmp_path / "head.toml")


def test_engine_and_valve_are_edited_and_saved(user: User, tmp_path: Path) -> None:
    tabs = user.window.show_view("parameters").tabs
    names = [tabs.tabText(i).replace("&", "") for i in range(tabs.count())]
    assert {"Engine", "Valve"} <= set(names)
    assert user.session.edit("engine.rod_mm", 140.0, "Change rod")
    user.session.end_gesture()
    assert user.session.edit("valve.centre_deg", 104.0, "Change centre")
    settle()
    user.choose("File", "Save")
    saved = load(tmp_path / "head.toml")
    assert saved.engine is not None
    assert saved.engine.rod_mm == 140.0
    assert [drive.valve.centre_deg for drive in saved.drives if drive.valve is not None] == [104.0, -108.0]
    assert user.steps == ["Change rod", "Change centre"]
    assert phase_path(saved, 0) == "drives[0].valve.centre_deg"
    user.choose("Edit", "Undo Change centre")
    assert user.session.full_design.drives[0].phase == 234.0
