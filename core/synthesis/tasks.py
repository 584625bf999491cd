"""Tasks of synthesis: from a task to linkages proposed for it, judged and ranked."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

from core.errors import MISSING, DesignError, Fault
from core.frozen import frozen
from core.numerics.lazy import checkpoint
from core.synthesis import angles, path, poses, rocker
from core.synthesis.candidates import Candidate
from core.synthesis.dyads import Dyad
from core.synthesis.judge import Answer, best_driven, is_same, ranked
from core.synthesis.task import ANGLES, PATH, POSES, ROCKER, Task, task_size


@frozen(eq=False)
class TaskKind:
    """How a kind of task is solved.

    Attributes
    ----------
    title : str
    candidates : callable
        Linkages proposed for a task, each with either side link as its driver.
    size : callable
        Size of a task [mm].
    complete : callable
        Whether the candidates are all that there are, not those of a sweep.
    remedy : str
        What else a task without answer can state.
    """

    title: str
    candidates: Callable[[Task], Iterator[tuple[Candidate, ...]]]
    size: Callable[[Task], float]
    complete: Callable[[Task], bool]
    remedy: str


def _pose_size(task: Task) -> float:
    return task_size([pose.z for pose in task.poses]) or 1.0


def _frame(task: Task) -> float:
    assert task.rocker is not None
    return task.rocker.frame_mm


TASKS: Mapping[str, TaskKind] = MappingProxyType(
    {
        POSES: TaskKind(
            "Poses of a body", poses.candidates, _pose_size, lambda task: poses.pose_dyads(task).complete, "other poses"
        ),
        PATH: TaskKind("Path of a point", path.candidates, path.size, lambda task: False, "another path"),
        ANGLES: TaskKind(
            "Pairs of angles", angles.candidates, angles.size, angles.are_all, "other pairs, or free = true"
        ),
        ROCKER: TaskKind(
            "Swing and time ratio",
            rocker.candidates,
            _frame,
            lambda task: True,
            "a smaller swing, or a time ratio nearer to 1",
        ),
    }
)
"""Kind of task -> how it is solved."""


@frozen(eq=False)
class Synthesis:
    """Result of a task.

    Attributes
    ----------
    answers : tuple of Answer
        Without defects and within the limits of the task, the best first; then the hidden ones.
    shown : int
        Number of the former.
    dyads : tuple of Dyad
        Of a task of poses.
    complete : bool
        Whether these are all answers, not those of a sweep.
    """

    answers: tuple[Answer, ...]
    shown: int
    dyads: tuple[Dyad, ...]
    complete: bool

    @property
    def hidden(self) -> int:
        """Number of answers with defects or beyond limits."""
        return len(self.answers) - self.shown


def synthesise(task: Task) -> Synthesis:
    """Linkages for a task, judged by their solved kinematics.

    Raises
    ------
    DesignError
        The task has no answer; the message says what would give one.
    FileError
        The file of a path cannot be read.
    """
    task = path.with_points(task)
    kind = TASKS[task.kind]
    answers: list[Answer] = []
    for driven in kind.candidates(task):
        checkpoint()
        answer = best_driven(driven, task)
        if answer is not None and not any(is_same(answer, other) for other in answers):
            answers.append(answer)
    if not answers:
        raise DesignError([Fault(task.kind, MISSING, "no linkage can be assembled for the task", kind.remedy)])
    answers = ranked(answers, kind.size(task))
    answers = [replace(answer, cognates=_cognates(answer, task)) for answer in answers]
    dyads = poses.pose_dyads(task).all if task.kind == POSES else ()
    return Synthesis(tuple(answers), sum(answer.is_good for answer in answers), dyads, kind.complete(task))


def _cognates(answer: Answer, task: Task) -> tuple[Answer, ...]:
    """Other linkages with the path of an answer, without itself and repetitions."""
    cognates = [answer]
    for driven in answer.candidate.cognates:
        checkpoint()
        cognate = best_driven(driven, task)
        if cognate is not None and not any(is_same(cognate, other) for other in cognates):
            cognates.append(cognate)
    return tuple(cognates[1:])
