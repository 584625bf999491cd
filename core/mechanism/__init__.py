"""Planar linkages of links, pins and sliding pairs: decomposed into dyads, solved for all positions at once."""

from core.mechanism.assembly import course_for, solve_mechanism, unit_speed_kinematics
from core.mechanism.checks import SINGULAR, findings
from core.mechanism.driver_ranges import Change, Course, Range, course_of
from core.mechanism.driving import CrankProgram, swept
from core.mechanism.mechanism import ROLLER, Mechanism, Reference, body_name, link_number, mechanism_of
from core.mechanism.plan import Plan, plan_of
from core.mechanism.solving import Solved, at_driver, solve

__all__ = [
    "ROLLER", "SINGULAR", "Change", "Course", "CrankProgram", "Mechanism", "Plan", "Range", "Reference", "Solved", "at_driver",
    "body_name", "course_for", "course_of", "findings", "link_number", "mechanism_of", "plan_of", "solve", "solve_mechanism",
    "swept", "unit_speed_kinematics",
]  # fmt: skip
