"""Every single field of the examples, edited by itself: computed again is what depends on it, and nothing else."""

from collections import Counter
from pathlib import Path

import pytest

from core.design import Entry, SingleCam, edited, entries, faults, get
from core.project import load
from core.study import Study, evaluations

EXAMPLES = Path(__file__).parents[2] / "resources" / "examples"
DESIGNS = {name: load(EXAMPLES / f"{name}.toml") for name in ("transfer_lift", "card_picker")}
STAGES = ("motion", "linkage", "cam", "dynamics")

# path, or the beginning of it: the stages that depend on what stands there; the longest that fits counts
DEPENDS: dict[str, tuple[str, ...]] = {
    "name": (),
    "motion": STAGES,
    "follower": ("linkage", "cam", "dynamics"),
    "cam": ("linkage", "cam", "dynamics"),  # a radius moves the base position
    "shaft.rotation": ("cam", "dynamics"),
    "shaft.speed_rpm": ("dynamics",),
    "shaft.flywheel_inertia_kg_m2": (),
    "shaft.speed_fluctuation": (),
    "shaft.motor_slope_nm_s_per_rad": (),
    "loads": ("dynamics",),
}


def other_value(entry: Entry) -> object:
    """Another one that is allowed, None where there is no other."""
    info, value = entry.info, entry.value
    if info.choices:
        return next((choice for choice in info.choices if choice != value), None)
    tried = [value * 1.001, value + 0.01, value - 0.01]
    return next(t for t in tried if t != value and info.admits(t))


def edits() -> list[object]:
    """Example, path, and the design with another value there; what a field alone cannot change is left out."""
    found = []
    for name, design in DESIGNS.items():
        for section in ("motion", "follower", "cam", "shaft", "loads"):
            for entry in entries(design, section):
                value = other_value(entry)
                if value is None:
                    continue
                changed = edited(design, entry.path, value)
                if faults(changed):
                    # a dwell neither rises nor turns, and a law for rises keeps its sign
                    assert entry.path.startswith("motion.segments"), entry.path
                    continue
                found.append(pytest.param(design, changed, entry.path, id=f"{name}: {entry.path}"))
    return found


def needed(path: str) -> tuple[str, ...]:
    return DEPENDS[max((key for key in DEPENDS if path == key or path.startswith(f"{key}.")), key=len)]


def asked(design: SingleCam) -> dict[str, int]:
    before = Counter(evaluations)
    study = Study(design, 72)
    for stage in STAGES:
        getattr(study, stage)
    return dict(Counter(evaluations) - before)


@pytest.mark.parametrize(("design", "changed", "path"), edits())
def test_a_fields_edit_computes_its_stages_again_and_going_back_none(design: SingleCam, changed: SingleCam, path: str) -> None:
    assert get(design, path) != get(changed, path)
    assert asked(design) == dict.fromkeys(STAGES, 1)
    assert asked(changed) == dict.fromkeys(needed(path), 1)
    assert asked(design) == {}, "back to the design from before"
    assert asked(changed) == {}, "and forth again"


def test_no_field_is_without_a_row_and_no_row_without_a_field() -> None:
    paths = {e.path for design in DESIGNS.values() for s in ("motion", "follower", "cam", "shaft", "loads") for e in entries(design, s)}
    assert all(needed(path) is not None for path in paths)
    for key in DEPENDS:
        assert key == "name" or any(path == key or path.startswith(f"{key}.") for path in paths), key
    tried = {parameter.values[2] for parameter in edits()}
    left_out = {path for path in paths - tried if not path.startswith("motion.segments")}
    assert left_out == {"cam.form", "follower.face"}, "of which there is one choice"
    assert {"motion.segments[1].span_deg", "motion.segments[1].rise_mm", "motion.segments[1].crossover", "motion.start_mm"} <= tried


def test_another_name_computes_nothing() -> None:
    for design in DESIGNS.values():
        asked(design)
        assert asked(edited(design, "name", "Another")) == {}
