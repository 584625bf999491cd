"""Synthesis of linkages: tasks, the linkages proposed for them, and the designs of these."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from core.commands.synthesis import design_in
from core.synthesis import Answer, Dyad, Task, load_task, task_of
from core.synthesis import synthesise as synthesised
from core.synthesis.chosen import answer_of_dyads, driven_by_other_link
from core.synthesis.results import dyad_data
from kindyna._cards import MOST_ROWS, card, escaped, table, value_text
from kindyna._checks import brief, path_of, text, whole
from kindyna._design import Design

__all__ = ["LinkageAnswer", "SynthesisResult", "synthesise"]


@dataclass(frozen=True, eq=False, repr=False)
class LinkageAnswer:
    """A linkage proposed for a task, judged by its solved kinematics.

    Attributes
    ----------
    kind : ``four-bar``, ``slider-crank`` or ``inverted-slider-crank``
    error_mm, error_deg : largest errors over the poses, points or pairs of the task; infinite where one is not reached
    defects : of ``branch``, ``circuit``, ``order``
    violated : limits of the task that it exceeds
    transmission_deg : least transmission angle over the driver's range that contains the task
    grashof : whether a side link can turn fully
    length_ratio : longest to shortest link
    size_mm : diagonal of the box of all joints over the same range
    cognates : the other four-bars with the same path

    Examples
    --------
    >>> import kindyna as kd
    >>> swing = {"swing_deg": 60.0, "time_ratio": 1.2, "frame_mm": 100.0}
    >>> best = kd.synthesise({"kind": "rocker", "rocker": swing}).answers[0]
    >>> best
    <kindyna.LinkageAnswer four-bar: transmission angle 40.315 deg>
    >>> rocker = best.design.study(samples=720)["link4_deg"]
    >>> print(round(rocker.max() - rocker.min(), 2))
    60.0
    """

    kind: str
    error_mm: float
    error_deg: float
    defects: tuple[str, ...]
    violated: tuple[str, ...]
    transmission_deg: float
    grashof: bool
    length_ratio: float
    size_mm: float
    cognates: tuple[LinkageAnswer, ...]
    _answer: Answer
    _task: Task

    @property
    def design(self) -> Design:
        """The linkage as a design: link 1 is the frame, 2 the driver, 3 the coupler with the point P of poses and paths."""
        return Design(self._answer.candidate.design)

    def driven_by_other_link(self) -> LinkageAnswer:
        """Return the four-bar with its other side link as the driver, judged again.

        Raises
        ------
        KindynaError
            The other link slides, the task states the angles of the driver, or the linkage cannot be assembled.

        Examples
        --------
        >>> import kindyna as kd
        >>> poses = [{"x_mm": x, "y_mm": 0.2 * x, "angle_deg": x} for x in (0.0, 30.0, 60.0)]
        >>> best = kd.synthesise({"kind": "poses", "poses": poses}).answers[0]
        >>> best.driven_by_other_link().length_ratio == best.length_ratio
        True
        """
        return _public(driven_by_other_link(self._answer, self._task), self._task)

    def taken_over(self, design: Design, *, drive: str = "", under_motion: bool = False) -> Design:
        """Return a design with this linkage in place of its mechanism; speed, shaft and loads stay, as far as they fit.

        Parameters
        ----------
        design : Design
            Present design.
        drive : str
            Name of the drive whose mechanism is replaced; needed of a shaft with several.
        under_motion : bool
            Let the motion of the present design drive the linkage, over the range of its driver that contains the task.

        Raises
        ------
        KindynaError
            The linkage cannot be driven by the motion, or does not fit the other drives.

        Examples
        --------
        >>> import kindyna as kd
        >>> swing = {"swing_deg": 40.0, "frame_mm": 100.0}
        >>> best = kd.synthesise({"kind": "rocker", "rocker": swing}).answers[0]
        >>> bar = kd.example("four_bar")
        >>> best.taken_over(bar)["linkage.driver.speed_rpm"] == bar["linkage.driver.speed_rpm"]
        True
        """
        if not isinstance(design, Design):
            raise TypeError(f"design = {design!r}: a Design is needed, not {type(design).__name__}")
        result, _ = design_in(design._design, text("drive", drive), self._answer, self._task, by_motion=under_motion)
        return Design(result)

    def __repr__(self) -> str:
        return brief(f"<kindyna.LinkageAnswer {self.kind}: {_figures(self)}>")


@dataclass(frozen=True, eq=False, repr=False)
class SynthesisResult:
    """Linkages for a task.

    Attributes
    ----------
    answers : those without defects and within the limits of the task, the best first
    hidden : those with defects or beyond limits
    dyads : of poses, each with ``kind``, ``fixed`` and ``moving`` pivot, of a guide ``line_deg``, as ``synthesise --json`` lists them
    complete : whether these are all linkages of the task, not the best ones of a sweep

    Examples
    --------
    >>> import kindyna as kd
    >>> pairs = [[50.0, 10.0], [75.0, 35.0], [100.0, 55.0]]
    >>> r = kd.synthesise({"kind": "angles", "angles": {"pairs": pairs, "frame_mm": 100.0}})
    >>> r
    <kindyna.SynthesisResult 1 linkage, 0 hidden>
    >>> r.complete, r.answers[0].error_deg < 1e-9
    (True, True)
    """

    answers: tuple[LinkageAnswer, ...]
    hidden: tuple[LinkageAnswer, ...]
    dyads: tuple[Mapping[str, Any], ...]
    complete: bool
    _dyads: tuple[Dyad, ...]
    _task: Task

    def of_dyads(self, first: int, second: int) -> LinkageAnswer:
        """Return the linkage of two dyads, judged like all others, as ``synthesise --dyads``.

        Parameters
        ----------
        first, second : int
            Indices in ``dyads``, from 0 on.

        Raises
        ------
        IndexError
            There is no such dyad.
        KindynaError
            The two dyads make no linkage.

        Examples
        --------
        >>> import kindyna as kd
        >>> poses = [{"x_mm": x, "y_mm": 0.2 * x, "angle_deg": x} for x in (0.0, 30.0, 60.0)]
        >>> r = kd.synthesise({"kind": "poses", "poses": poses})
        >>> r.of_dyads(0, len(r.dyads) - 1).error_mm < 1e-9
        True
        """
        chosen = []
        for name, value in (("first", first), ("second", second)):
            index = whole(name, value)
            if not 0 <= index < len(self._dyads):
                raise IndexError(f"{name} = {index}: no such dyad; allowed: 0 ... {len(self._dyads) - 1}")
            chosen.append(self._dyads[index])
        return _public(answer_of_dyads(self._task, *chosen), self._task)

    def _repr_html_(self) -> str:
        rows = [
            (
                str(rank),
                escaped(row.kind),
                *map(value_text, (row.error_mm, row.error_deg, row.transmission_deg, row.size_mm)),
            )
            for rank, row in enumerate(self.answers[:MOST_ROWS], 1)
        ]
        heads = ("Rank", "linkage", "error, mm", "error, °", "transmission angle, °", "size, mm")
        return card("Linkages for a task", self._count(), table(heads, rows, left=(0, 1)))

    def _count(self) -> str:
        return f"{len(self.answers)} {'linkage' if len(self.answers) == 1 else 'linkages'}, {len(self.hidden)} hidden"

    def __repr__(self) -> str:
        return f"<kindyna.SynthesisResult {self._count()}>"


def synthesise(task: Mapping[str, Any] | str | os.PathLike[str]) -> SynthesisResult:
    """Return linkages for a task: four-bars, slider-cranks and inverted slider-cranks, as the command ``synthesise``.

    Parameters
    ----------
    task : mapping, str or path
        Tables as nested mappings with the keys of a task file, or a task file (``.toml``).

    Raises
    ------
    KindynaError
        The task cannot be read, ``faults`` lists all wrong entries, or it has no linkage; the text says what would give one.

    Examples
    --------
    >>> import kindyna as kd
    >>> import numpy as np
    >>> q = np.radians(np.arange(0, 360, 15))
    >>> curve = np.column_stack((90 * np.cos(q), 30 * np.sin(q)))  # an ellipse
    >>> r = kd.synthesise({"kind": "path", "path": {"points": curve.tolist(), "closed": True}})
    >>> best = r.answers[0]
    >>> best.kind, best.error_mm < 0.5, best.defects
    ('four-bar', True, ())
    >>> best.design.study(samples=360).point(3, "P").shape
    (360, 2)
    """
    typed = task_of(task) if isinstance(task, Mapping) else load_task(path_of("task", task))
    result = synthesised(typed)
    answers = [_public(answer, typed) for answer in result.answers]
    dyads = tuple(map(dyad_data, result.dyads))
    return SynthesisResult(
        tuple(answers[: result.shown]), tuple(answers[result.shown :]), dyads, result.complete, result.dyads, typed
    )


def _public(answer: Answer, task: Task) -> LinkageAnswer:
    return LinkageAnswer(
        answer.candidate.kind,
        answer.error_mm,
        answer.error_deg,
        answer.defects,
        answer.violated,
        answer.transmission_deg,
        answer.grashof,
        answer.length_ratio,
        answer.size_mm,
        tuple(_public(cognate, task) for cognate in answer.cognates),
        answer,
        task,
    )


def _figures(answer: LinkageAnswer) -> str:
    words = ", ".join((*answer.defects, *answer.violated))
    return f"transmission angle {answer.transmission_deg:.6g} deg" + (f", {words}" if words else "")
