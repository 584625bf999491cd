"""Texts of design files of valve trains: the lobe and the tappet that several tests share."""

LOBE_A = """[motion]
start_mm = 0.0
[motion.lobe]
lift_mm = 9.0
duration = [[0.15, 270.0], [1.27, 210.0]]
ramp_mm = 0.2
ramp_runup_deg = 8.0
"""
FLAT_TAPPET = """[follower]
kind = "translating"
face = "flat"
[cam]
base_radius_mm = 18.0
"""
