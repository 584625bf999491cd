"""Planar linkages of links, pins and sliding pairs: decomposed into dyads, solved for all positions at once."""

from core.mechanism.assembly import course_for, linkage_train, solve_mechanism, unit_speed_train
from core.mechanism.course import Change, Course, Range, course_of
from core.mechanism.dragging import movable, other_side, with_point_at
from core.mechanism.drivers import driver_place, drivers, roller_places, with_driver, with_roller, without_roller
from core.mechanism.driving import CrankProgram, swept
from core.mechanism.grashof import FourBar, four_bar
from core.mechanism.limits import findings
from core.mechanism.mechanism import ROLLER, Mechanism, Reference, body_name, link_number, mechanism_of
from core.mechanism.plan import Plan, plan_of
from core.mechanism.solving import Solved, at_driver, solve

__all__ = [
    "ROLLER", "Change", "Course", "CrankProgram", "FourBar", "Mechanism", "Plan", "Range", "Reference", "Solved", "at_driver", "body_name",
    "course_for", "course_of", "driver_place", "drivers", "findings", "four_bar", "link_number", "linkage_train", "mechanism_of", "movable",
    "other_side", "plan_of", "roller_places", "solve", "solve_mechanism", "swept", "unit_speed_train",
    "with_driver", "with_point_at", "with_roller", "without_roller",
]  # fmt: skip
