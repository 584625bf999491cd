"""Trial designs whose samples are looked at together reach what each reaches by itself."""

from pathlib import Path

import numpy as np
import pytest
from sampled import stressed

from core.find.goals import CAM_SEARCHES, trial_values
from core.find.offer import search_request
from core.find.trial import Outcome, TrialDesigns
from core.project import load
from core.study.stages import clear_caches, evaluations

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
FORCES = {"contact_force_n": 5000.0}


def _trials(name: str, what: str, stated: dict[str, float]) -> tuple[TrialDesigns, list[tuple[float, ...]]]:
    design, row = load(EXAMPLES / f"{name}.toml"), CAM_SEARCHES[what]
    wish = search_request(design, what, stated)
    paths = row.fields(design, wish.bounds)
    axes = [trial_values(row.values(design, path), None, None)[:: 3 * len(paths)] for path in paths]
    tried = [tuple(each) for each in np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, len(paths)).tolist()]
    return TrialDesigns(design, paths, wish.limits, put=row.put), tried


def _same(one: Outcome, other: Outcome, slack: float) -> bool:
    """Whether they keep or break the same limits by as much."""
    if not other.readings:
        return not one.readings
    left = [{reading.key: reading.margin for reading in each.readings} for each in (one, other)]
    return left[0].keys() == left[1].keys() and all(
        left[0][key] == pytest.approx(left[1][key], rel=slack, abs=slack) for key in left[1]
    )


@pytest.mark.parametrize(
    ("name", "what", "stated", "slack"),
    [
        ("transfer_lift", "base-radius", {}, 1e-12),  # a slider, some of whose rods do not reach
        ("transfer_lift", "base-radius", FORCES, 1e-12),
        stressed("tappet_flat", "base-radius", {}, 1e-12),
        stressed("card_picker", "roller-radius", {}, 1e-12),
        stressed("groove", "offset", {}, 1e-12),
        stressed("conjugate", "pivot", {}, 1e-12),
        stressed("cam_slider_linkage", "roller-radius", {}, 1e-12),  # a linkage of dyads
        stressed("rocker_cam", "span", {}, 2e-3),  # samples go with the span
    ],
)
def test_samples_looked_at_together_are_those_of_each_by_itself(
    name: str, what: str, stated: dict[str, float], slack: float
) -> None:
    trials, tried = _trials(name, what, stated)
    clear_caches()
    trials.scan(tried)
    together = [trials.at(*values, refined=False) for values in tried]
    assert evaluations["cam"] == 1  # of all at once
    alone, _ = _trials(name, what, stated)
    apart = [alone.at(*values, refined=False) for values in tried]
    assert sum(bool(outcome.readings) for outcome in apart) >= 5
    assert all(_same(*pair, slack) for pair in zip(together, apart, strict=True))
