"""Planar linkages of links, pins and sliding pairs: decomposed into dyads, solved for all positions at once."""

from core.mechanism.checks import SINGULAR, findings
from core.mechanism.driver_ranges import ChangePoint, DriverRange, DriverRanges, driver_ranges_of, followed_ranges
from core.mechanism.drivers import CrankMotion, motion_extent
from core.mechanism.linkage import SolutionPlan, plan_of
from core.mechanism.mechanism import (
    ROLLER,
    LinkageSolution,
    Mechanism,
    Names,
    ReferencePoint,
    at_driver,
    body_name,
    link_number,
    mechanism_of,
    solve,
)
from core.mechanism.solving import driver_ranges_for, solve_mechanism, unit_speed_kinematics

__all__ = [
    "ROLLER",
    "SINGULAR",
    "ChangePoint",
    "CrankMotion",
    "DriverRange",
    "DriverRanges",
    "LinkageSolution",
    "Mechanism",
    "Names",
    "ReferencePoint",
    "SolutionPlan",
    "at_driver",
    "body_name",
    "driver_ranges_for",
    "driver_ranges_of",
    "findings",
    "followed_ranges",
    "link_number",
    "mechanism_of",
    "motion_extent",
    "plan_of",
    "solve",
    "solve_mechanism",
    "unit_speed_kinematics",
]  # fmt: skip
