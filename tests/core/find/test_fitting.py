"""The nearest value of a field with which a design fits together."""

import math
from pathlib import Path

import pytest

from core.design import Design, edited, faults, get
from core.errors import KindynaError
from core.find.fitting import nearest_fitting_value
from core.project import load
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"


def fits(design: Design) -> bool:
    try:
        return not faults(design) and Study(design).linkage is not None
    except KindynaError:
        return False


@pytest.mark.parametrize(
    ("name", "path", "typed", "edge"),
    [
        ("transfer_lift", "follower.roller_arm_mm", 100.0, math.hypot(873.746, 65.0) - 550.0),
        ("transfer_lift", "follower.roller_arm_mm", 5000.0, math.hypot(873.746, 65.0) + 550.0),
        ("rocker_cam", "follower.arm_mm", 1.0, math.hypot(95.0, 30.0) - 57.0),
        ("kim_1990", "follower.offset_mm", 500.0, 40.0),
        ("kim_1990", "follower.offset_mm", -500.0, -40.0),
    ],
)
def test_the_nearest_value_is_at_the_edge_of_those_that_fit(name: str, path: str, typed: float, edge: float) -> None:
    """Four digits, on the side that fits: the sides of the triangle pivot, roller, cam centre, or an offset below the reach."""
    design = edited(load(EXAMPLES / f"{name}.toml"), path, typed)
    assert not fits(design)
    value = nearest_fitting_value(design, path, fits)
    assert value is not None
    assert fits(edited(design, path, value))
    assert abs(value - edge) <= 10.0 ** (math.floor(math.log10(abs(edge))) - 3)
    assert not fits(edited(design, path, edge + math.copysign(1e-3, edge - value)))


def test_a_value_that_fitted_is_found_where_the_search_passes_it() -> None:
    """Rod and arm must reach the slider at 1300 mm: values on a narrow range far from the typed one."""
    design = load(EXAMPLES / "transfer_lift.toml")
    rod = get(design, "follower.rod_mm")

    def is_near(trial: Design) -> bool:
        return abs(get(trial, "follower.rod_mm") - rod) < 0.01

    typed = edited(design, "follower.rod_mm", 3.0)
    assert nearest_fitting_value(typed, "follower.rod_mm", is_near) is None
    assert nearest_fitting_value(typed, "follower.rod_mm", is_near, rod) == pytest.approx(rod - 0.01, abs=0.01)


def test_what_is_no_number_has_no_nearest_value() -> None:
    design = load(EXAMPLES / "transfer_lift.toml")
    for path in ("follower.layout", "cam.hub_mm", "motion"):
        assert nearest_fitting_value(design, path, fits) is None
