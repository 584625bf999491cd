"""The designs of a study: the combinations of its grid, and at each of these the points of Sobol's sequence, told by their number."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from functools import cached_property
from math import prod
from typing import Any

import numpy as np

from core.design import Design, Info, edited, faults
from core.errors import KindynaError
from core.frozen import frozen
from core.study.batches.batch import FAULTY
from core.study.many import many
from core.varying.request import CURVE, GRID, POINTS, StudyOfMany, Vary

Column = np.ndarray
"""(m,) numbers of a field, or words (dtype object)."""


@frozen(eq=False)
class Axis:
    """One field with what it is given: count values of the grid, listed or even from low to high; count 0: it takes part in Sobol's
    sequence."""

    field: str
    info: Info
    count: int = 0
    listed: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0

    def at(self, place: np.ndarray) -> Column:
        """The values of the grid with these numbers (m,)."""
        if self.listed:
            kind = object if self.info.choices else float
            return np.array(self.listed, dtype=kind)[place]
        found = self.low + (self.high - self.low) * (place / (self.count - 1))
        found = np.where(place == self.count - 1, self.high, found)
        return np.rint(found) if self.info.whole else found

    def between(self, part: np.ndarray) -> np.ndarray:
        """Values (m,) at parts 0 ... 1 of the way from low to high; of a whole number each is as likely."""
        if self.info.whole:
            return np.minimum(np.floor(self.low + part * (self.high - self.low + 1.0)), self.high)
        return self.low + part * (self.high - self.low)


class Space:
    """All designs of a study, numbered: the first field changes slowest, Sobol's points fastest."""

    def __init__(self, study: StudyOfMany) -> None:
        rows = study.file.vary
        if not rows:
            raise KindynaError("vary: no field is varied; state at least one [[vary]]")
        bare = sum(row.low is not None and row.steps is None and row.points is None for row in rows)
        self.study = study
        self.axes = tuple(_axis(row, study.infos[row.field], bare) for row in rows)
        stated = [row.points for row in rows if row.points is not None]
        self.sobol = [axis for axis in self.axes if not axis.count]
        self.points = (stated[0] if stated else POINTS) if self.sobol else 1
        self.grid = [axis for axis in self.axes if axis.count]
        self.shape = tuple(axis.count for axis in self.grid)

    @cached_property
    def count(self) -> int:
        """How many designs there are."""
        return prod(self.shape) * self.points

    def columns(self, first: int, last: int) -> dict[str, Column]:
        """Field -> its values (m,), of the designs from ``first`` up to, but without, ``last``."""
        number = np.arange(first, last)
        places = np.unravel_index(number // self.points, self.shape) if self.shape else ()
        found = {axis.field: axis.at(place) for axis, place in zip(self.grid, places, strict=True)}
        if self.sobol:
            parts = self._parts(number)
            found |= {axis.field: axis.between(parts[:, i]) for i, axis in enumerate(self.sobol)}
        return {axis.field: found[axis.field] for axis in self.axes}

    def _parts(self, number: np.ndarray) -> np.ndarray:
        """Points of Sobol's sequence (m, d) of the designs of these numbers, which follow each other."""
        found = []
        while number.size:
            start = int(number[0] % self.points)
            now = min(number.size, self.points - start)
            found.append(sobol(len(self.sobol), self.study.file.seed, start, now))
            number = number[now:]
        return np.concatenate(found)


def sobol(dimensions: int, seed: int, start: int, count: int) -> np.ndarray:
    """Points (count, d) of a scrambled Sobol sequence from number ``start`` on, in 0 ... 1 (Joe and Kuo 2008, as scipy has it)."""
    from scipy.stats import qmc

    sequence = qmc.Sobol(dimensions, scramble=True, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that it is balanced only at powers of 2
        if start:
            sequence.fast_forward(start)
        return np.asarray(sequence.random(count))


def none_built(count: int, code: str, often: int) -> str:
    """That none of so many designs can be built, and the commonest reason."""
    return f"vary: none of the {count:,} designs can be built, most ({often:,}) for {code}; vary other fields, or other bounds"


def evaluated(
    study: StudyOfMany, columns: Mapping[str, Column], *, polish: bool = True, executor: Any = None
) -> tuple[np.ndarray, np.ndarray]:
    """What is asked (q, m) of designs with these values of fields, and why one has none (m,)."""
    keys = [row.key for row in study.asked]
    m = len(next(iter(columns.values())))
    value, reason = np.full((len(keys), m), np.nan), np.full(m, "", dtype=object)
    by_hand = {path: column for path, column in columns.items() if apart(study.infos[path])}
    numbers = {path: column for path, column in columns.items() if path not in by_hand}
    for words, which in _groups(by_hand, m):
        design = with_words(study.base, words)
        if design is None:
            reason[which] = FAULTY
            continue
        rows = {path: column[which] for path, column in numbers.items()} or as_it_is(design, len(which))
        found = many(design, rows, keys, polish=polish, executor=executor)
        value[:, which] = [found.value[key] for key in keys]
        reason[which] = found.reason
    return value, reason


def apart(info: Info) -> bool:
    """Whether a field is put into the design, rather than varied with it: a word, or a whole number."""
    return bool(info.choices) or info.whole


def with_words(design: Design, words: Mapping[str, Any]) -> Design | None:
    """The design with these words and whole numbers; None where they do not go together."""
    for path, value in words.items():
        try:
            design = edited(design, path, value)
        except KindynaError:
            return None
    return None if words and faults(design) else design


def _groups(columns: Mapping[str, Column], m: int) -> list[tuple[dict[str, Any], np.ndarray]]:
    """Words that go together -> which designs (n,) have them, in the order in which they come first."""
    found: dict[tuple[Any, ...], list[int]] = {}
    for i, row in enumerate(zip(*(_plain(column) for column in columns.values()), strict=True)):
        found.setdefault(row, []).append(i)
    if not columns:
        return [({}, np.arange(m))]
    return [(dict(zip(columns, row, strict=True)), np.array(which)) for row, which in found.items()]


def _plain(column: Column) -> Sequence[Any]:
    return [value if isinstance(value, str) else int(value) for value in column.tolist()]


def as_it_is(design: Design, m: int) -> dict[str, np.ndarray]:
    """A number of the design, m times: something is varied in ``many``."""
    from core.design.paths import entries

    for name in design.tables:
        for each in entries(design, name):
            info = each.info
            if not (info.choices or info.whole or info.flag) and type(each.value) in (int, float):
                return {each.path: np.full(m, float(each.value))}
    raise KindynaError("vary: this design has no number")


def _axis(row: Vary, info: Info, bare: int) -> Axis:
    if row.values or row.choices:
        listed = row.values or row.choices
        return Axis(row.field, info, len(listed), listed)
    assert row.low is not None, "a rule of the file"
    assert row.high is not None, "a rule of the file"
    steps = row.steps
    if steps is None and row.points is None and bare < 3:
        steps = max(2, int(row.high - row.low) + 1) if info.whole else (CURVE if bare == 1 else GRID)
    if steps is None:
        return Axis(row.field, info, low=row.low, high=row.high)
    return Axis(row.field, info, steps, low=row.low, high=row.high)
