"""Searches that advance in step: the values for which all of them wait are computed together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from queue import SimpleQueue
from typing import Any, TypeVar

R = TypeVar("R")

Ask = Callable[[Any], Any]
"""Function that returns the answer to a question of a search."""


class _Stopped(Exception):
    """The searches are stopped."""


def in_step(
    searches: Sequence[Callable[[Ask], R]], answers: Callable[[Mapping[int, Any]], Mapping[int, Any]]
) -> list[R]:
    """Results of searches that run in threads and wait for answers; all answers are computed in the calling thread.

    Parameters
    ----------
    searches : sequence of callable
        Every search is called with the function that returns the answers to its questions.
    answers : callable
        Called when all searches wait: number of a search -> its question, in the order of the numbers. It returns the answers
        to one or more of them. An exception stops all searches.

    Returns
    -------
    list
    """
    if len(searches) == 1:
        return [searches[0](lambda question: answers({0: question})[0])]
    events: SimpleQueue[tuple[int, bool, Any]] = SimpleQueue()
    inboxes: list[SimpleQueue[tuple[bool, Any]]] = [SimpleQueue() for _ in searches]

    def ask(number: int, question: Any) -> Any:
        events.put((number, True, question))
        is_answer, answer = inboxes[number].get()
        if not is_answer:
            raise _Stopped
        return answer

    def run(number: int) -> R:
        try:
            return searches[number](partial(ask, number))
        finally:
            events.put((number, False, None))

    with ThreadPoolExecutor(len(searches)) as pool:
        futures = [pool.submit(run, number) for number in range(len(searches))]
        running, waiting = len(searches), dict[int, Any]()
        try:
            while running:
                number, asks, question = events.get()
                if asks:
                    waiting[number] = question
                else:
                    running -= 1
                if running and len(waiting) == running:
                    for number, answer in answers(dict(sorted(waiting.items()))).items():
                        del waiting[number]
                        inboxes[number].put((True, answer))
        except BaseException:
            for inbox in inboxes:
                inbox.put((False, None))
            raise
        return [future.result() for future in futures]
