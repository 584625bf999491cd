"""Motions that do not come back, as files."""

DEFAULT_CAM = """
format = 1
name = "Default cam of controllers"

[motion]
start_deg = 0.0
advance_deg = 360.0

[[motion.segments]]
law = "polynomial"
span_deg = 120.0
rise_deg = 120.0
end = { velocity = 1.0, acceleration = 0.0 }

[[motion.segments]]
law = "constant-velocity"
span_deg = 120.0
rise_deg = 120.0

[[motion.segments]]
law = "polynomial"
span_deg = 120.0
rise_deg = 120.0
start = { velocity = 1.0, acceleration = 0.0 }
"""
"""Of CODESYS's cam editor: (0, 0, 0, 0) (120, 120, 1, 0) (240, 240, 1, 0) (360, 360, 0, 0), quintics between."""

FOUR_BAR = """
[linkage]
driver = { link = 2, kind = "motion" }

[[linkage.links]]
number = 1
points = { O = [0.0, 0.0], D = [100.0, 0.0] }

[[linkage.links]]
number = 2
points = { O = [0.0, 0.0], A = [20.0, 0.0] }

[[linkage.links]]
number = 3
points = { A = [0.0, 0.0], B = [90.0, 0.0] }

[[linkage.links]]
number = 4
points = { D = [0.0, 0.0], B = [60.0, 0.0] }
"""


FEED = """
format = 1
name = "Feed"

[motion]
start_mm = 10.0
advance_mm = 300.0

[[motion.segments]]
law = "3-4-5"
span_deg = 120.0
rise_mm = 150.0

[[motion.segments]]
law = "dwell"
span_deg = 60.0

[[motion.segments]]
law = "cycloidal"
span_deg = 120.0
rise_mm = 150.0

[[motion.segments]]
law = "dwell"
span_deg = 60.0

[shaft]
rotation = "ccw"
speed_rpm = 60.0

[loads]
mass_kg = 12.0
force_n = -20.0
friction_n = 15.0
"""
