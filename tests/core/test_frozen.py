"""Frozen classes that share their methods behave as the frozen dataclasses of the standard library do."""

import copy
import dataclasses
import inspect
import math
import pickle
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from core.frozen import frozen
from core.project import load

LIFT = Path(__file__).parents[2] / "resources" / "examples" / "transfer_lift.toml"


def classes(decorator, **options):
    """The same four classes, by this decorator."""

    @decorator
    class Part:
        name: str
        size: float = 2.0
        tags: dict[str, int] = field(default_factory=dict, compare=False)
        note: str = field(default="", repr=False)

    @decorator
    class Longer(Part):
        parts: tuple[object, ...] = ()

    @decorator
    class Single:
        value: object

    @decorator
    class Empty:
        pass

    return {kind.__name__: kind for kind in (Part, Longer, Single, Empty)}


PLAIN, OURS = classes(dataclass(frozen=True)), classes(frozen)


@pytest.mark.parametrize("use", [
    lambda kinds: repr(kinds["Longer"]("a", parts=(kinds["Part"]("b", note="unseen"), kinds["Empty"]()))),
    lambda kinds: dataclasses.asdict(kinds["Longer"]("a", 3.0, {"x": 1}, parts=(kinds["Single"](1),))),
    lambda kinds: [f.name for f in dataclasses.fields(kinds["Longer"])],
    lambda kinds: repr(replace(kinds["Longer"]("a"), size=math.inf)),
    lambda kinds: list(inspect.signature(kinds["Longer"]).parameters),
    lambda kinds: kinds["Part"]("a", tags={"x": 1}) == kinds["Part"]("a", tags={"x": 2}),
    lambda kinds: kinds["Part"]("a") == kinds["Part"]("b"),
    lambda kinds: kinds["Part"]("a") == kinds["Longer"]("a"),
    lambda kinds: kinds["Single"](math.nan) == kinds["Single"](math.nan),
    lambda kinds: hash(kinds["Longer"]("a")) == hash(kinds["Longer"]("a", 2.0)),
    lambda kinds: len({kinds["Single"](1), kinds["Single"](1.0), kinds["Single"](2), kinds["Empty"]()}),
    lambda kinds: copy.deepcopy(kinds["Longer"]("a", parts=([1],))) == kinds["Longer"]("a", parts=([1],)),
    lambda kinds: kinds["Part"]("a").tags is kinds["Part"]("a").tags,
    lambda kinds: kinds["Longer"]("a").__match_args__,
])  # fmt: skip
def test_frozen_class_does_what_a_dataclass_does(use):
    assert use(OURS) == use(PLAIN)


@pytest.mark.parametrize("misuse", [
    lambda kinds: setattr(kinds["Part"]("a"), "size", 1.0),
    lambda kinds: delattr(kinds["Part"]("a"), "size"),
    lambda kinds: kinds["Part"](),
    lambda kinds: kinds["Part"]("a", colour="red"),
    lambda kinds: replace(kinds["Part"]("a"), colour="red"),
    lambda kinds: hash(kinds["Single"]([])),
])  # fmt: skip
def test_frozen_class_refuses_what_a_dataclass_refuses(misuse):
    for kinds in (PLAIN, OURS):
        with pytest.raises((dataclasses.FrozenInstanceError, TypeError)) as error:
            misuse(kinds)
        kinds["seen"] = type(error.value)
    assert PLAIN["seen"] is OURS["seen"]


def test_results_are_equal_only_to_themselves_and_keywords_stay_keywords():
    @frozen(eq=False, kw_only=True)
    class Result:
        value: float
        bound: float = 0.0

    one, other = Result(value=1.0), Result(value=1.0)
    assert len({one, other}) == 2
    with pytest.raises(TypeError):
        Result(1.0)


def test_a_design_survives_pickling():
    design = load(LIFT)
    assert pickle.loads(pickle.dumps(design)) == design
