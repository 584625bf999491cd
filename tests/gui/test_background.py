"""kindyna_gui.background: what takes long is computed beside the window, and not to its end where it is no longer wanted."""

import gc
import sys
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from PySide6.QtWidgets import QApplication
from window_user import settle, wait_for

from core.blend import Request, best, blend, feasible_ranges
from core.errors import KindynaError
from core.numerics.lazy import Cancelled, cancellable, checkpoint
from core.project import load
from core.stability import chart
from core.study import Study
from kindyna_gui.background import Background
from kindyna_gui.places import example


@pytest.fixture
def background(app: QApplication) -> Iterator[tuple[Background, list[tuple[Any, Any]]]]:
    made, heard = Background(), []
    made.result.connect(lambda key, found: heard.append((key, found)))
    yield made, heard
    made.close()


def _for_ever() -> None:
    while True:
        checkpoint()
        time.sleep(0.001)


def test_answers_come_in_order(background: tuple[Background, list[tuple[Any, Any]]]) -> None:
    made, heard = background
    made.start([(i, lambda i=i: i * i) for i in range(5)])
    assert made.busy
    wait_for(lambda: not made.busy)
    assert heard == [(i, i * i) for i in range(5)]


def test_a_refusal_is_an_answer(background: tuple[Background, list[tuple[Any, Any]]]) -> None:
    made, heard = background
    made.start([("a", lambda: blend(Request("DRD", -1.0, 0.0, 90.0))), ("b", lambda: 1)])
    wait_for(lambda: not made.busy)
    assert isinstance(heard[0][1], KindynaError)
    assert heard[1] == ("b", 1)


def test_a_mistake_is_heard(
    background: tuple[Background, list[tuple[Any, Any]]], nothing_unheard: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the window's thread, as every other one."""
    made, heard = background
    raised: list[BaseException] = []
    monkeypatch.setattr(sys, "excepthook", lambda kind, error, trace: raised.append(error))
    made.start([("a", lambda: 1 // 0)])
    wait_for(lambda: bool(raised))
    assert isinstance(raised[0], ZeroDivisionError)
    assert heard == []
    assert not made.busy


def test_what_is_no_longer_wanted_is_not_computed_to_its_end(
    background: tuple[Background, list[tuple[Any, Any]]],
) -> None:
    made, heard = background
    before = threading.active_count()
    for _ in range(3):
        made.start([("endless", _for_ever), ("never", lambda: 0)])
        wait_for(lambda: threading.active_count() > before)
    made.start([("short", lambda: 1)])
    wait_for(lambda: not made.busy)
    assert heard == [("short", 1)]
    wait_for(lambda: threading.active_count() == before)


def test_a_job_is_given_up_between_its_steps_and_never_within_one(
    background: tuple[Background, list[tuple[Any, Any]]],
) -> None:
    """What a step has begun it ends: a file is closed, a module whole."""
    made, heard = background
    begun, go_on, ended = threading.Event(), threading.Event(), threading.Event()

    def step() -> int:
        begun.set()
        go_on.wait()
        ended.set()
        checkpoint()
        return 1

    made.start([("step", step)])
    begun.wait()
    made.stop()
    time.sleep(0.02)
    assert not ended.is_set()
    go_on.set()
    wait_for(ended.is_set)
    made.close()
    assert heard == []


def test_what_is_cancelled_says_so_once_it_has_ended(background: tuple[Background, list[tuple[Any, Any]]]) -> None:
    made, heard = background
    made.start([("endless", _for_ever), ("never", lambda: 0)])
    assert not made.wait(0.02)
    made.cancel()
    assert made.busy, "until it has come to a checkpoint"
    wait_for(lambda: not made.busy)
    ((key, result),) = heard
    assert key == "endless"
    assert isinstance(result, Cancelled)
    made.start([("short", lambda: 1)])
    assert made.wait(5.0)
    assert heard[1:] == [("short", 1)]


@pytest.mark.parametrize("name", ["history", "steady_at", "chart", "best", "feasible_ranges"])
def test_what_takes_long_looks_often_whether_it_is_still_wanted(name: str) -> None:
    """Each computation that the window starts beside itself, given up at its third look."""

    class Third(threading.Event):
        looks = 0

        def is_set(self) -> bool:
            self.looks += 1
            return self.looks >= 3

    found = Study(load(example("kim_1990"))).flexible_shaft()
    request = Request(
        "DRRD", 20.0, 30.0, 330.0, constant="rise", settings={"acceleration": 0.006}, points=((100.0, 8.0),)
    )
    rows: dict[str, Callable[[], object]] = {
        "history": lambda: found.history(eta=2.7, q=0.05),
        "steady_at": lambda: found.steady_at(2.7, 0.05),
        "chart": lambda: chart(found.coefficients, found.machine, rows=64),
        "best": lambda: best(request, "jerk"),
        "feasible_ranges": lambda: feasible_ranges(request, "point", 150.0),
    }
    flag = Third()
    with cancellable(flag), pytest.raises(Cancelled):
        rows[name]()
    assert flag.looks == 3


def test_an_answer_that_comes_too_late_is_not_heard(background: tuple[Background, list[tuple[Any, Any]]]) -> None:
    made, heard = background
    made.start([("old", lambda: 1)])
    time.sleep(0.05)  # it waits to be heard
    made.start([("new", lambda: 2)])
    wait_for(lambda: not made.busy)
    settle()
    assert heard == [("new", 2)]


class Rubbish:
    """Something that only Python's garbage collector takes away."""

    def __init__(self) -> None:
        self.itself = self


def test_no_other_thread_tidies_up(background: tuple[Background, list[tuple[Any, Any]]]) -> None:
    """What Python's garbage collector takes away may be a widget, which only the window's thread may do."""
    made, heard = background
    threads: set[Any] = set()

    def watch(phase: str, told: dict[str, int]) -> None:
        threads.add(threading.current_thread())

    gc.callbacks.append(watch)
    try:
        made.start([("a", lambda: weakref.ref([Rubbish() for _ in range(5000)][-1]))])
        wait_for(lambda: bool(heard))
        wait_for(lambda: heard[0][1]() is None)
    finally:
        gc.callbacks.remove(watch)
    assert threads == {threading.main_thread()}
