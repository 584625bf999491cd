"""core.numerics.lazy: results that others share are read-only, and what nobody asks for is not made."""

import ctypes
import gc
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from assembled import case
from linkages import KINDS, four_bar
from mechanisms import LIFT, PUSHER

from core.mechanism import at_driver, driver_ranges_of
from core.numerics.lazy import Lazy, locked
from core.process import keep_freed_memory
from core.study import Study, quantity

ROOT = Path(__file__).parents[3]
CASES = [case((kind,), 0) for kind in KINDS]

glibc = pytest.mark.skipif(sys.platform != "linux", reason="settings of glibc")


@dataclass(frozen=True)
class Part:
    name: str
    rows: Lazy[np.ndarray] = Lazy()
    size: Lazy[int] = Lazy(lambda part: part.rows.size)


def counted() -> tuple[list[int], Callable[[], np.ndarray]]:
    calls: list[int] = []

    def make() -> np.ndarray:
        calls.append(1)
        return np.arange(3.0)

    return calls, make


def test_a_field_given_as_a_function_is_made_once_when_it_is_read() -> None:
    calls, make = counted()
    part = Part("a", make)
    assert calls == []
    assert part.rows.tolist() == [0.0, 1.0, 2.0]
    assert part.rows is part.rows
    assert calls == [1]
    with pytest.raises(ValueError, match="read-only"):
        part.rows[0] = 1.0


def test_a_field_that_is_not_given_is_made_from_the_others() -> None:
    assert Part("a", np.zeros(7)).size == 7
    assert Part("a", np.zeros(7), 5).size == 5
    assert Part("a", np.zeros(7), lambda: 6).size == 6
    assert replace(Part("a", np.zeros(7)), rows=np.zeros(2)).size == 7, "a copy keeps what was made"
    with pytest.raises(TypeError, match="rows"):
        Part("a")  # type: ignore[call-arg]


def test_locking_reaches_every_array_and_makes_none() -> None:
    calls, make = counted()
    plain = np.zeros(2)
    cached = locked(Part("a", make))
    assert calls == []
    locked({"x": (plain, Part("b", plain))})
    with pytest.raises(ValueError, match="read-only"):
        plain[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        cached.rows[0] = 1.0


@pytest.mark.parametrize("design", [LIFT, PUSHER], ids=["lift", "pusher"])
def test_what_is_made_late_cannot_be_spoilt_either(design: object) -> None:
    study = Study(design, 24)
    arrays = [
        study.angles.unit, study.linkage.follower.z, study.linkage.follower.angle, study.linkage.follower.unit,
        study.linkage.travel, study.linkage.residual, study.linkage.condition, *(each[0] for each in study.linkage.coordinates.values()),
        *study.linkage.singular.values(), study.cam.flank.pitch, study.cam.flank.pitch_curvature_slope, study.cam.centre.point,
        *(pose.z for pose in study.linkage.bodies.values()),
    ]  # fmt: skip
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_a_curve_of_a_link_makes_no_derivative_that_it_does_not_show() -> None:
    study = Study(LIFT, 24)
    _ = quantity("phi_velocity").value(study)
    assert {name: each.computed_orders for name, each in study.linkage.coordinates.items() if each.computed_orders} == {
        "phi": (1,)
    }


def test_a_profile_makes_no_curvature_and_a_linkage_no_pose() -> None:
    study = Study(LIFT, 24)
    kinematics, shape = study.linkage, study.cam
    assert kinematics.bodies["rod"].origin.computed_orders == kinematics.bodies["rod"].turn.computed_orders == ()
    assert not isinstance(vars(kinematics)["residual"], np.ndarray)
    _ = shape.flank.profile
    assert isinstance(vars(shape.flank)["profile"], np.ndarray)
    assert not isinstance(vars(shape.flank)["pitch_curvature"], np.ndarray)
    assert kinematics.follower.origin.computed_orders == (0, 1)
    assert kinematics.follower.turn.computed_orders == ()  # the roller is carried by its arm, which turns as one
    _ = shape.flank.profile_curvature
    assert isinstance(vars(shape.flank)["profile_curvature"], np.ndarray)
    assert kinematics.follower.origin.computed_orders == (0, 1, 2)
    _ = shape.flank.pitch_curvature_slope
    assert kinematics.follower.origin.computed_orders == (0, 1, 2, 3)


def test_a_linkage_makes_no_derivative_that_nobody_reads() -> None:
    """Of a general linkage, too: where the links are, then velocities, then accelerations."""
    driver_ranges = driver_ranges_of(four_bar(100.0, 30.0, 90.0, 70.0).drive.linkage)
    rocker = driver_ranges.solve(at_driver(np.linspace(0.1, 6.0, 24))).poses[4]
    assert rocker.turn.computed_orders == ()
    for order in range(3):
        _ = rocker.fixed_point(0.07)[order]
        assert rocker.spin.computed_orders == tuple(range(order + 1))
        assert 0 not in rocker.turn.computed_orders, "the angle itself is not needed"


def test_forces_ask_for_no_jerk() -> None:
    there = Study(LIFT).at_theta(np.linspace(0.1, 6.0, 24))
    assert there.motion.displacement.computed_orders == ()
    _ = there.dynamics.torque
    assert there.motion.displacement.computed_orders == (0, 1, 2)
    assert there.linkage.follower.turn.computed_orders == (2,)
    assert there.linkage.follower.spin.computed_orders == (0, 1, 2)


@pytest.mark.parametrize("make", [
    lambda theta: Study(LIFT, 24).linkage.follower.z,
    lambda theta: Study(LIFT, 24).cam.flank.pitch_curvature_slope,
    lambda theta: Study(LIFT).at_theta(theta).dynamics.torque,
    *(lambda theta, case=case: case.driver_ranges.solve(at_driver(theta * 0.0 + case.q)).poses[3].z for case in CASES),
], ids=["linkage", "cam", "forces", *(case.name for case in CASES)])  # fmt: skip
def test_what_nobody_holds_any_more_is_freed_at_once(make: Callable[[np.ndarray], np.ndarray]) -> None:
    """Results in a circle with the functions that make them would stay in memory until Python looks for circles."""
    theta = np.linspace(0.1, 6.0, 24)
    gc.freeze()  # what other tests have left stays out of it
    make(theta)
    gc.collect()
    _ = make(theta)  # tests tidy up between each other only
    del _
    assert gc.collect() == 0


@glibc
def test_a_study_fetches_no_memory_anew() -> None:
    """Without, 66 pages of linkage and profile come anew from the system each time."""
    keep_freed_memory()  # as every command and every window does
    import resource

    angles = Study(LIFT, 3600).angles
    there = replace(angles, cached=False)

    def run() -> None:
        study = Study(LIFT, 3600, there)
        _ = study.linkage.residual, study.cam.flank.profile

    for _ in range(10):
        run()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(10):
        run()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before < 10 * 20


def test_freed_memory_is_kept_where_the_c_library_can_and_nothing_happens_elsewhere(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told: list[tuple[int, int]] = []

    class Library:
        def mallopt(self, what: int, value: int) -> int:
            told.append((what, value))
            return 1

    def without(name: object) -> Library:
        raise OSError(name)

    for platform, library, calls in (
        ("linux", lambda name: Library(), 3),
        ("linux", without, 0),
        ("linux", lambda name: object(), 0),
        ("darwin", without, 0),
        ("win32", without, 0),
    ):
        told.clear()
        monkeypatch.setattr(ctypes, "CDLL", library)
        monkeypatch.setattr(sys, "platform", platform)
        keep_freed_memory.__wrapped__()
        assert len(told) == calls, platform
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(ctypes, "CDLL", lambda name: Library())
    monkeypatch.setenv("KINDYNA_KEEP_MEMORY", "0")
    told.clear()
    keep_freed_memory.__wrapped__()
    assert told == []


SCRIPT = """
import ctypes, os, resource, sys
from core.design import get, put
from core.project import load
from core.study import Study

design, path = load(sys.argv[1]), "follower.rod_mm"
length, calls, library = get(design, path), [], ctypes.CDLL

class Library:
    def mallopt(self, what, value):
        calls.append(what)
        return library(None).mallopt(what, value)

ctypes.CDLL = lambda name: Library() if name is None else library(name)
for i in range(60):
    if i == 40:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    study = Study(put(design, path, length + 1e-3 * i), 3600)
    _ = study.dynamics.contact, study.dynamics.torque, study.cam.flank.profile
print(len(calls), (resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before) / 20)
"""


@glibc
@pytest.mark.parametrize(("switch", "settings"), [(None, 3), ("0", 0)])
def test_the_first_study_of_a_script_sets_the_memory_unless_the_environment_forbids(
    switch: str | None, settings: int
) -> None:
    environment = {name: value for name, value in os.environ.items() if name != "KINDYNA_KEEP_MEMORY"}
    environment |= {} if switch is None else {"KINDYNA_KEEP_MEMORY": switch}
    lift = ROOT / "resources" / "examples" / "transfer_lift.toml"
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(lift)],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        encoding="utf-8",
    )
    calls, pages = run.stdout.split()
    assert int(calls) == settings
    if settings:
        assert float(pages) <= 60.0, "pages taken anew per chain"
