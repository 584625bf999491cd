"""The lift with force elements: ten of all kinds that do not rub, and friction in every pin and in the guide."""

from __future__ import annotations

from pathlib import Path

from core.project import loads

LIFT = (Path(__file__).parents[2] / "resources" / "examples" / "transfer_lift.toml").read_text(encoding="utf-8")
ELEMENTS = """
[[loads.springs]]
from = { link = 1, point = "pivot" }
to = { link = 4, point = "slider_pin" }
rate_n_per_mm = 3.0
free_length_mm = 35.0
[[loads.springs]]
from = { link = 1, at = [1500.0, 1000.0] }
to = { link = 3, at = [300.0, 20.0] }
rate_n_per_mm = 2.0
free_length_mm = 100.0
damping_n_s_per_mm = 0.04
[[loads.springs]]
from = { link = 1, at = [900.0, 900.0] }
to = { link = 2, at = [500.0, 0.0] }
damping_n_s_per_mm = 0.05
[[loads.springs]]
from = { link = 2, at = [300.0, 0.0] }
to = { link = 3, at = [400.0, 0.0] }
damping_n_s_per_mm = 0.02
[[loads.torsion_springs]]
link = 3
on = 2
rate_nm_per_rad = 12.0
damping_nm_s_per_rad = 0.1
[[loads.torsion_springs]]
link = 2
on = 1
rate_nm_per_rad = 15.0
[[loads.process]]
force_n = -4000.0
position_from_mm = 20.0
position_to_mm = 90.0
[[loads.process]]
force_n = -1000.0
cam_from_deg = 35.0
cam_to_deg = 76.5
[[loads.springs]]
from = { link = 1, at = [200.0, 900.0] }
to = { link = 2, at = [600.0, 50.0] }
rate_n_per_mm = 1.5
free_length_mm = 80.0
[[loads.process]]
points = [[0.0, -100.0], [120.0, -400.0], [240.0, -200.0]]
"""
TWO_PINS = """
[[loads.pair_friction]]
pair = "pivot"
coefficient = 0.05
radius_mm = 40.0
[[loads.pair_friction]]
pair = "slider_pin"
coefficient = 0.05
radius_mm = 30.0
"""
THIRD_PIN = """
[[loads.pair_friction]]
pair = "arm_pin"
coefficient = 0.05
radius_mm = 30.0
"""

TEN = loads(LIFT + ELEMENTS)
"""Springs, dampers, torsion springs and process forces, ten rows; none rubs."""
FOUR = loads(LIFT + TWO_PINS + THIRD_PIN)
"""Four pairs that rub."""
